"""Steps in time: sub-steps of at most the scene's time step, landing on kinks and on the end.

What a call of `step` means, inputs in, all or nothing, is as for the finite elements; the inputs
are read by the same kernels.
"""

import math

from cablemodel.kernels.environment import current_profile, find_piece, surge_jump, vessel_motion
from cablemodel.kernels.layout import (
    I_CLAMPED,
    I_CURRENT,
    I_ITERATIONS,
    I_LIVE,
    I_PIECE,
    I_PIECES,
    I_REJECTED,
    I_STEPS,
    I_TIMES,
    NOT_FINITE,
    O_MOTION,
    O_PIECES,
    O_TIMES,
    OK,
    P_ACCELERATION_JUMP,
    P_END,
    PIECE_WORDS,
    S_PAID,
    S_PAID_LEAST,
    S_PAID_MOST,
    S_TIME,
)
from cablemodel.kernels.stepping import possible, release_inputs, take_inputs
from cablemodel.kernels.winch import commanded_rate

from .axes import leave_plane, turn_axes
from .backup import give_back_image, give_back_start, keep_image, keep_start
from .compile import kernel
from .frame import from_earth
from .history import keep_past, set_rates
from .layout import (
    D_END,
    D_ITERATIONS_MOST,
    D_RESTART,
    END_TOUCHDOWN,
    X_ALPHA,
    X_BETA,
    X_DT,
    X_FLOW_END,
    X_LAID,
    X_MEMORY,
    X_PAID_IN_STEP,
    X_RATE,
    X_TIME_STEP,
    X_VESSEL,
)
from .limits import check_floor, check_state
from .newton import solve_level
from .regrid import make_room, regrid
from .touchdown import change_end, time_to_landing

SMALLEST_SHARE = 1.0 / 1024.0
"""Of the time step: below it a step that does not converge is given up."""
AT_ONCE = 1e-9
RESTART = 0.5
"""Of the water's acceleration: a change by the caller after which rates before it are of no use."""


@kernel
def set_vessel(I, M, t):
    """Tow point and its velocity at time t in the paper's axes."""
    vessel_motion(I, M, t)
    at = I[O_MOTION]
    g1, g2, g3 = from_earth(M, M[at], M[at + 1], M[at + 2])
    M[X_VESSEL] = g1
    M[X_VESSEL + 1] = g2
    M[X_VESSEL + 2] = g3
    g1, g2, g3 = from_earth(M, M[at + 3], M[at + 4], M[at + 5])
    M[X_VESSEL + 3] = g1
    M[X_VESSEL + 4] = g2
    M[X_VESSEL + 5] = g3


@kernel
def pay_out(I, M, t, dt):
    """Rate at the end of a step and cable paid out within it; clamped where the drum ends."""
    rate, slope, _until = commanded_rate(I, M, t)
    paid = (rate + 0.5 * slope * dt) * dt
    rate += slope * dt
    I[I_CLAMPED] = 0
    if M[S_PAID] + paid > M[S_PAID_MOST]:
        paid = M[S_PAID_MOST] - M[S_PAID]
        I[I_CLAMPED] = 1
    elif M[S_PAID] + paid < M[S_PAID_LEAST]:
        paid = M[S_PAID_LEAST] - M[S_PAID]
        I[I_CLAMPED] = -1
    if I[I_CLAMPED] != 0:
        rate = 0.0 if abs(paid) < 1e-12 else paid / dt
    M[X_RATE] = rate
    M[X_PAID_IN_STEP] = paid


@kernel
def one_step(I, M, dt):
    """One implicit step of dt from S_TIME, for which `pay_out` has been called. On failure the
    state is that of the start."""
    t = M[S_TIME]
    alpha = 1.0 if I[D_RESTART] != 0 else M[X_ALPHA]
    M[X_DT] = dt
    M[X_BETA] = 1.0 / (alpha * dt)
    M[X_MEMORY] = (1.0 - alpha) / alpha
    keep_start(I, M)
    keep_past(I, M)
    set_vessel(I, M, t + dt)
    current_profile(I, M, t + dt)
    before = I[I_ITERATIONS]
    status = solve_level(I, M)
    if status == OK:
        status = check_state(I, M)
    if status == OK:
        status = check_floor(I, M)
    if status != OK:
        set_vessel(I, M, t)
        give_back_start(I, M)
        return status
    taken = I[I_ITERATIONS] - before
    if taken > I[D_ITERATIONS_MOST]:
        I[D_ITERATIONS_MOST] = taken
    set_rates(I, M)
    I[D_RESTART] = 0
    M[S_PAID] += M[X_PAID_IN_STEP]
    if I[D_END] == END_TOUCHDOWN:
        M[X_LAID] += dt * M[X_FLOW_END]
    M[X_PAID_IN_STEP] = 0.0
    M[S_TIME] = t + dt
    I[I_STEPS] += 1
    return OK


@kernel
def next_kink(I, M, t_end):
    """The first time after S_TIME where an input has a kink, at most t_end; and whether the
    acceleration of vessel or water jumps there."""
    t = M[S_TIME]
    least = t + AT_ONCE * max(1.0, abs(t))
    nearest = t_end
    jump = 0
    if I[I_LIVE] == 0:
        k = find_piece(I, M, t)
        while k < I[I_PIECES] - 1:
            end = M[I[O_PIECES] + k * PIECE_WORDS + P_END]
            if not end < nearest:
                break
            k += 1
            if end > least and M[I[O_PIECES] + k * PIECE_WORDS + P_ACCELERATION_JUMP] > 0.0:
                nearest = end
                jump = 1
                break
    _rate, _slope, until = commanded_rate(I, M, t)
    if until > least and until < nearest:
        nearest = until
        jump = 1
    if I[I_CURRENT] != 0:
        for k in range(I[I_TIMES]):
            kink = M[I[O_TIMES] + k]
            if kink > least and kink < nearest:
                nearest = kink
                jump = 1
    return nearest, jump


@kernel
def advance(I, M, t_end):
    """Step to t_end in equal sub-steps between kinks; halved where one does not converge."""
    share = 1.0
    while M[S_TIME] < t_end:
        t = M[S_TIME]
        stop, jump = next_kink(I, M, t_end)
        count = max(1.0, math.ceil((stop - t) / (share * M[X_TIME_STEP]) - 1e-9))
        dt = time_to_landing(I, M, (stop - t) / count)
        if dt < (stop - t) / count:
            count = 2.0
        pay_out(I, M, t, dt)
        make_room(I, M, dt)
        status = one_step(I, M, dt)
        if status == OK:
            change_end(I, M)
            turn_axes(I, M)
            status = regrid(I, M)
            if status != OK:
                return status
            if count == 1.0:
                M[S_TIME] = stop
                if jump != 0:
                    I[D_RESTART] = 1
                if I[I_LIVE] == 0:
                    I[I_PIECE] = find_piece(I, M, stop)
            share = min(1.0, 2.0 * share)
            continue
        I[I_REJECTED] += 1
        share = 0.5 * min(share, dt / M[X_TIME_STEP])
        if share < SMALLEST_SHARE:
            return status
    return OK


@kernel
def take_step(I, M, t_end, inputs):
    """Step to t_end [s] with the given inputs (INPUT_WORDS); on failure nothing has changed."""
    if not possible(M, t_end, inputs):
        return NOT_FINITE
    keep_image(I)
    returning = take_inputs(I, M, t_end, inputs)
    jump, surge = surge_jump(I, M, M[S_TIME])
    if jump > RESTART * surge:
        I[D_RESTART] = 1
    leave_plane(I, M)
    status = advance(I, M, t_end)
    if status != OK:
        give_back_image(I)
        return status
    release_inputs(I, returning)
    return status
