"""The steady state by the same equations without time derivatives, by growing implicit steps."""

from cablemodel.kernels.access import scalars
from cablemodel.kernels.environment import current_profile
from cablemodel.kernels.layout import OK, STATICS_FAILED

from .backup import give_back_start, keep_start
from .compile import kernel
from .history import forget, keep_past, set_rates
from .layout import (
    D_RESTART,
    X_BETA,
    X_DT,
    X_MEMORY,
    X_PAID_IN_STEP,
    X_RATE,
    X_TOLERANCE,
)
from .limits import check_floor, check_state
from .newton import solve_level
from .stepping import set_vessel

FIRST_STEP, LAST_STEP = 0.5, 1e7
MOST_STEPS = 400
GROWTH = 2.0
STEADY_TOLERANCE = 1e-9


@kernel
def steady_level(I, M):
    """Newton on the steady equations; the iterate is put back where it fails."""
    M[X_BETA] = 0.0
    M[X_MEMORY] = 0.0
    M[X_DT] = 0.0
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
    state = scalars(M)
    set_vessel(I, M, state.time)
    current_profile(I, M, state.time)
    M[X_RATE] = 0.0
    M[X_PAID_IN_STEP] = 0.0
    asked = M[X_TOLERANCE]
    dt = FIRST_STEP
    status = STATICS_FAILED
    forget(I, M)
    for _step in range(MOST_STEPS):
        M[X_TOLERANCE] = min(asked, 1e-3)
        M[X_DT] = 0.0
        M[X_BETA] = 1.0 / dt
        M[X_MEMORY] = 0.0
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
        dt *= GROWTH
        if dt > LAST_STEP:
            break
    M[X_TOLERANCE] = min(asked, STEADY_TOLERANCE)
    if status == OK:
        status = steady_level(I, M)
    M[X_TOLERANCE] = asked
    if status == OK:
        set_rates(I, M)
        forget(I, M)
    I[D_RESTART] = 1
    return status
