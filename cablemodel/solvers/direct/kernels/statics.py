"""The steady state by the same equations without time derivatives, by growing implicit steps."""

from cablemodel.solvers.shared.access import scalars
from cablemodel.solvers.shared.environment import current_profile
from cablemodel.solvers.shared.layout import OK, STATICS_FAILED

from .access import own_header, own_scalars
from .backup import give_back_start, keep_start
from .compile import kernel
from .history import forget, keep_past, set_rates
from .limits import check_floor, check_state
from .newton import solve_level
from .stepping import set_vessel

FIRST_STEP, LAST_STEP = 0.5, 1e7
DIRECT_MOST_STEPS = 400
DIRECT_GROWTH = 2.0
STEADY_TOLERANCE = 1e-9


@kernel
def steady_level(I, M):
    """Newton on the steady equations; the iterate is put back where it fails."""
    run = own_scalars(M)
    run.beta = 0.0
    run.memory = 0.0
    run.dt = 0.0
    forget(I, M)
    keep_start(I, M)
    status = solve_level(I, M)
    if status == OK:
        status = check_state(I, M)
    if status == OK:
        status = check_floor(I, M)
    if status != OK:
        give_back_start(I, M)
    return status


@kernel
def find_steady_state(I, M):
    """From the block's state, with the vessel's velocity and the current at its time, to the steady
    one. A bare Newton first, then backward Euler steps that grow, then Newton again."""
    own = own_header(I)
    run = own_scalars(M)
    state = scalars(M)
    set_vessel(I, M, state.time)
    current_profile(I, M, state.time)
    run.rate = 0.0
    run.paid_in_step = 0.0
    asked = run.tolerance
    dt = FIRST_STEP
    status = STATICS_FAILED
    forget(I, M)
    for _step in range(DIRECT_MOST_STEPS):
        run.tolerance = min(asked, 1e-3)
        run.dt = 0.0
        run.beta = 1.0 / dt
        run.memory = 0.0
        keep_start(I, M)
        keep_past(I, M)
        status = solve_level(I, M)
        if status == OK:
            status = check_state(I, M)
        if status != OK:
            give_back_start(I, M)
            dt *= 0.25
            if dt < 1e-4:
                break
            continue
        set_rates(I, M)
        dt *= DIRECT_GROWTH
        if dt > LAST_STEP:
            break
    run.tolerance = min(asked, STEADY_TOLERANCE)
    if status == OK:
        status = steady_level(I, M)
    run.tolerance = asked
    if status == OK:
        set_rates(I, M)
        forget(I, M)
    own.restart = 1
    return status
