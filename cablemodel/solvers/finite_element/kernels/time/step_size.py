"""How long the next step is: by the error, by Newton's method, by what must be landed on.

Two limits stand beside each other: the step that the error allows (`step`), and at a floor the one
that Newton's method is expected to manage (`tractable`).
"""

from cablemodel.solvers.finite_element.kernels.bodies.frames import is_a_stop, next_frame_stop
from cablemodel.solvers.finite_element.kernels.element.tables import STAGES
from cablemodel.solvers.shared.access import cut_of, header, motion_piece_of, scalars
from cablemodel.solvers.shared.compile import inlined, kernel
from cablemodel.solvers.shared.environment import find_piece
from cablemodel.solvers.shared.layout import (
    FLOOR_FAR,
    FLOOR_TOUCHED,
    OK,
)

STRUGGLE = 17, 7  # iterations of a step of order 4, and of order 3, in which Newton has trouble
AT_FLOOR = 22  # the same for order 4 near a floor
STEPS_OF_ORDER_3 = 16.0  # that follow such a step
ORDER_3_PAYS = 1e-4  # tau down to which they do
ORDER_3_STEP = 0.6  # of the step that the error of order 4 allows, as a first guess
FAILED_AT_FLOOR = 0.5  # of a step in which Newton's method failed at a floor: the next one
EASY = 2.4, 1.5  # iterations a stage up to which the longest tractable step grows, and by how much
FAIR = 3.2, 1.1  # the same for one that is near its limit
PROBED = 1.03  # and up to HARD: not all trouble is the step's, and no limit may stay for ever
HARD = 4.5  # iterations above which it stays; only a failure makes it shorter
STEP_LARGEST_GROWTH = 16.0  # of the step: the first is much shorter than any motion
ERROR_SAFETY = 0.9  # of the step that its error would allow: the next one
REFUSED = 0.9  # of a step that is refused: the next one at most
FAILED_ELSEWHERE = 0.4  # the same where Newton's method failed, off the floor
LARGEST_CUT = 0.3  # of a step: the next one at least, whatever its error
NO_ERROR = 1e-12  # of what is allowed: an error that says nothing of the next step
KEPT_FROM, KEPT_TO = 0.95, 1.3  # changes of the step that are not made: the matrix stays as it is
NEAR_LIMIT = 0.8  # of the longest tractable step: one that tells of that limit


@kernel
def natural_step(I, M):
    """The step that nothing but the line itself limits [s]: its error, its floor, its waves."""
    head = header(I)
    state = scalars(M)
    step = state.step
    if head.floor_state == FLOOR_TOUCHED and state.tractable > 0.0:
        step = min(step, state.tractable)
    if head.wave_count != 0:
        step = min(step, state.wave_step)
    return step


@kernel
def next_stop(I, M, t_end, dt):
    """The time to land on exactly: t_end, or an input's breakpoint before it that matters.

    See `is_a_stop`; so are the times at which the current changes, and cuts.
    """
    head = header(I)
    state = scalars(M)
    time = state.time
    stop = t_end
    if head.live == 0:
        count = head.piece_count
        for k in range(find_piece(I, M, time), count):
            row = motion_piece_of(I, M, k)
            start = row.start
            if start <= time:
                continue
            if start >= stop or start > time + dt:
                break
            if is_a_stop(M, row, dt):
                stop = start
                break
    times = head.time_count
    if times > 1:
        for k in range(times):
            start = M[head.times + k]
            if start > time and start < stop:
                stop = start
    if head.parts != 0:
        stop = next_frame_stop(I, M, stop, dt)
    for n in range(head.cut_count):
        cut = cut_of(I, M, n)
        if cut.done > 1e300 and time < cut.time < stop:
            stop = cut.time
    return stop


@inlined
def by_error(scheme, error):
    """The next step over the present one, by the local error of its scheme's order."""
    return ERROR_SAFETY * error ** (-0.25 if scheme == 1 else -1.0 / 3.0)


@kernel
def shorten(I, M, dt, scheme, status, error):
    """After a step that is refused: a shorter one; False where there is none."""
    head = header(I)
    state = scalars(M)
    head.rejected += 1
    head.growth_barred = max(head.growth_barred, 1)
    if status != OK:
        factor = FAILED_ELSEWHERE
        if head.floor_state == FLOOR_TOUCHED:
            factor = FAILED_AT_FLOOR
            state.tractable = FAILED_AT_FLOOR * dt
    else:
        factor = max(LARGEST_CUT, by_error(scheme, error))
        if not factor < REFUSED:
            factor = LARGEST_CUT if error != error else REFUSED
    state.step = factor * dt
    return not state.step < state.smallest_step


@kernel
def adapt_step(I, M, dt, scheme, error):
    """After a step that is accepted: the one that its error allows."""
    head = header(I)
    state = scalars(M)
    factor = STEP_LARGEST_GROWTH
    if error > NO_ERROR:
        factor = min(STEP_LARGEST_GROWTH, max(LARGEST_CUT, by_error(scheme, error)))
    if head.growth_barred > 0:
        factor = min(factor, 1.0)
        head.growth_barred -= 1
    if KEPT_FROM <= factor and factor <= KEPT_TO:
        factor = 1.0
    if factor >= 1.0:
        state.step = max(state.step, factor * dt)
    else:
        state.step = factor * dt


@kernel
def prefer_order_3(M):
    """Order 3 for some steps, unless the tolerance is too fine for it."""
    state = scalars(M)
    if state.tolerance < ORDER_3_PAYS:
        return
    if state.order_3 == 0.0:
        state.step *= ORDER_3_STEP
    state.order_3 = STEPS_OF_ORDER_3


@kernel
def choose_order(I, M, scheme, iterations, to_output):
    """After a step: order 3 for those in which Newton's method has trouble.

    In a whip the long steps of order 4 take four iterations a stage, and new matrices in between;
    the shorter ones of order 3, with three stages, half of the work for the same time. At a floor
    contact takes some, of any order; but above one, too, what order 4 does with a slack line in
    long steps gave it energy without end. A step that is read afterwards takes one more in each
    stage, without any trouble.
    """
    head = header(I)
    state = scalars(M)
    if to_output:
        iterations -= STAGES[scheme] - 1
    if scheme == 1:
        many = STRUGGLE[0] if head.floor_state == FLOOR_FAR else AT_FLOOR
        if iterations > many:
            prefer_order_3(M)
    elif state.order_3 > 0.0:
        if iterations > STRUGGLE[1]:
            state.order_3 = STEPS_OF_ORDER_3
        else:
            state.order_3 -= 1.0
            if state.order_3 == 0.0:
                state.step /= ORDER_3_STEP


@kernel
def follow_iterations(I, M, dt, iterations):
    """After a step at a floor of so many iterations a stage: which steps are tractable.

    What limits a step where cable lands and folds is Newton's method, not the error: a growth by
    the error alone fails every second time. So does one by the iterations alone where a failure
    has left cable that swings on its friction: that rings out first.
    """
    state = scalars(M)
    limit = state.tractable
    if limit == 0.0 or header(I).growth_barred > 0:
        return
    if iterations <= EASY[0]:
        # Of longer steps one that the caller limits tells little.
        state.tractable = limit * (EASY[1] if dt > NEAR_LIMIT * limit else FAIR[1])
    elif iterations <= HARD and dt > NEAR_LIMIT * limit:
        state.tractable = limit * (FAIR[1] if iterations <= FAIR[0] else PROBED)
