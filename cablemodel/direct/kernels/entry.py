"""The direct solver's entry points, with the arguments and results of cablemodel/kernels/entry.py."""

from numba import float64, int64

from . import geometry, outputs, statics, stepping
from .assembly import fill_system, set_strains
from .compile import INTEGERS, REALS, entry_point
from .newton import solve_linear


@entry_point(int64(INTEGERS, REALS, float64, REALS))
def step(I, M, t_end, inputs):
    """Step to t_end [s] with 14 words of inputs. Returns the status; on failure nothing changes."""
    return stepping.take_step(I, M, t_end, inputs)


@entry_point(int64(INTEGERS, REALS))
def equilibrium(I, M):
    """The steady state for the vessel's velocity and the current at the block's time."""
    return statics.find_steady_state(I, M)


@entry_point(int64(INTEGERS, REALS, float64))
def place(I, M, time):
    """Strains and places of the nodes for the vessel's motion at `time`."""
    stepping.set_vessel(I, M, time)
    set_strains(I, M)
    geometry.set_places(I, M)
    return 0


@entry_point(int64(INTEGERS, REALS, REALS, REALS))
def sample(I, M, stations, out):
    """State at arc lengths [m]; out: rows of 12 words. Returns how many are on the line."""
    return outputs.sample_stations(I, M, stations, out)


@entry_point(int64(INTEGERS, REALS, REALS))
def summary(I, M, out):
    """The numbers of outputs.summarise (24 words)."""
    outputs.summarise(I, M, out)
    return 0


@entry_point(int64(INTEGERS, REALS))
def assemble(I, M):
    """The slots of the Newton system at the present state; returns their number."""
    return fill_system(I, M, 0)


@entry_point(int64(INTEGERS, REALS, int64))
def solve(I, M, slots):
    """Solve the assembled slots by the block's method. Returns the status."""
    return solve_linear(I, M, slots)


ENTRY_POINTS = {
    "step": step,
    "equilibrium": equilibrium,
    "place": place,
    "sample": sample,
    "summary": summary,
    "assemble": assemble,
    "solve": solve,
}
