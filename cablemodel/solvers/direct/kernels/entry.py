"""The direct solver's entry points.

Most of the time of compiling goes into what lies below a Newton iteration. All that needs it is
one entry point, `work`, with a task; cablemodel/solvers/direct/library.py gives the tasks names.
"""

from numba import float64, int64

from . import geometry, outputs, statics, stepping
from .access import own_header
from .assembly import fill_system, set_strains
from .compile import INTEGERS, REALS, entry_point
from .layout import TASK_ASSEMBLE, TASK_EQUILIBRIUM, TASK_STEP
from .newton import solve_linear


@entry_point(int64(INTEGERS, REALS, int64, float64, REALS))
def work(I, M, task, number, inputs):
    """Do a task; returns its status or count.

    TASK_STEP: to the time `number` [s] with 14 words of inputs; on failure nothing changes.
    TASK_EQUILIBRIUM: the steady state for vessel and current at the block's time.
    TASK_ASSEMBLE: the slots of the Newton system at the present state; their number.
    TASK_SOLVE: `number` assembled slots by the block's method.
    """
    if task == TASK_STEP:
        return stepping.take_step(I, M, number, inputs)
    if task == TASK_EQUILIBRIUM:
        return statics.find_steady_state(I, M)
    if task == TASK_ASSEMBLE:
        return fill_system(I, M, 0)
    return solve_linear(I, M, int(number))


@entry_point(int64(INTEGERS, REALS, float64))
def place(I, M, time):
    """Strains and places of the nodes for the vessel's motion at `time`."""
    stepping.set_vessel(I, M, time)
    set_strains(I, M)
    geometry.set_places(I, M)
    return 0


@entry_point(int64(INTEGERS, REALS, REALS, REALS))
def sample(I, M, stations, out):
    """State at arc lengths [m]; out: rows of STATION_WORDS. Returns how many are on the line."""
    return outputs.sample_stations(I, M, stations, out)


@entry_point(int64(INTEGERS, REALS, REALS))
def bodies(I, M, out):
    """Motion of the bodies; out: rows of STATION_WORDS, see outputs.body_stations."""
    own = own_header(I)
    outputs.body_stations(I, M, out)
    return own.body_count


@entry_point(int64(INTEGERS, REALS, REALS))
def summary(I, M, out):
    """The numbers of outputs.summarise."""
    outputs.summarise(I, M, out)
    return 0


ENTRY_POINTS = {
    "work": work,
    "place": place,
    "sample": sample,
    "bodies": bodies,
    "summary": summary,
}
