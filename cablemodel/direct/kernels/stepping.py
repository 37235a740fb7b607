"""Steps in time: sub-steps of at most the scene's time step, landing on kinks and on the end.

What a call of `step` means, inputs in, all or nothing, is as for the finite elements; the inputs
are read by the same kernels.
"""

import math

from cablemodel.kernels.environment import current_profile, find_piece, vessel_motion
from cablemodel.kernels.layout import (
    I_CLAMPED,
    I_CURRENT,
    I_FAILED_NODE,
    I_IMAGE_WORDS,
    I_ITERATIONS,
    I_LIVE,
    I_PIECE,
    I_RATE_LIVE,
    I_REJECTED,
    I_STEPS,
    I_TIMES,
    NOT_FINITE,
    O_BACKUP,
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
from cablemodel.kernels.payout import commanded_rate
from cablemodel.kernels.stepping import (
    IN_CURRENT,
    IN_PAYOUT,
    IN_POSITION,
    IN_VELOCITY,
    INPUT_WORDS,
    set_live_current,
    set_live_motion,
    set_live_rate,
)

from .axes import leave_plane, turn_axes
from .compile import kernel, merged
from .frame import from_earth
from .geometry import last_node
from .history import keep_past, set_rates
from .layout import (
    D_END,
    D_ITERATIONS_MOST,
    D_RESTART,
    END_TOUCHDOWN,
    O_LENGTH,
    O_OLD_LENGTH,
    O_START,
    O_Y,
    WIDTH,
    X_ALPHA,
    X_BETA,
    X_DT,
    X_FLOW_END,
    X_LAID,
    X_MEMORY,
    X_PAID_IN_STEP,
    X_RATE,
    X_REACTION,
    X_TIME_STEP,
    X_VESSEL,
)
from .limits import check_state
from .newton import solve_level
from .regrid import regrid
from .touchdown import change_end, time_to_landing

SMALLEST_SHARE = 1.0 / 1024.0
"""Of the time step: below it a step that does not converge is given up."""
AT_ONCE = 1e-9


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


@merged
def one_step(I, M, dt):
    """One implicit step of dt from S_TIME. On failure the iterate is that of the start."""
    t = M[S_TIME]
    alpha = 1.0 if I[D_RESTART] != 0 else M[X_ALPHA]
    M[X_DT] = dt
    M[X_BETA] = 1.0 / (alpha * dt)
    M[X_MEMORY] = (1.0 - alpha) / alpha
    count = last_node(I) + 1
    for k in range(WIDTH * count):
        M[I[O_START] + k] = M[I[O_Y] + k]
    for k in range(count):
        M[I[O_OLD_LENGTH] + k] = M[I[O_LENGTH] + k]
    flow_end = M[X_FLOW_END]
    reaction = M[X_REACTION]
    keep_past(I, M)
    set_vessel(I, M, t + dt)
    current_profile(I, M, t + dt)
    pay_out(I, M, t, dt)
    before = I[I_ITERATIONS]
    status = solve_level(I, M)
    if status == OK:
        status = check_state(I, M)
    if status != OK:
        for k in range(WIDTH * count):
            M[I[O_Y] + k] = M[I[O_START] + k]
        for k in range(count):
            M[I[O_LENGTH] + k] = M[I[O_OLD_LENGTH] + k]
        M[X_FLOW_END] = flow_end
        M[X_REACTION] = reaction
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
    vessel's acceleration jumps there."""
    t = M[S_TIME]
    least = t + AT_ONCE * max(1.0, abs(t))
    nearest = t_end
    jump = 0
    if I[I_LIVE] == 0:
        k = find_piece(I, M, t)
        while True:
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
                jump = 0
    return nearest, jump


@merged
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
        status = one_step(I, M, dt)
        if status == OK:
            status = change_end(I, M)
            if status == OK:
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


@merged
def take_step(I, M, t_end, inputs):
    """Step to t_end [s] with the given inputs (INPUT_WORDS); on failure nothing has changed."""
    if not abs(t_end) < 1e300 or not t_end > M[S_TIME]:
        return NOT_FINITE
    for n in range(INPUT_WORDS):
        if not abs(inputs[n]) < 1e100:
            return NOT_FINITE
    words = I[I_IMAGE_WORDS]
    backup = I[O_BACKUP]
    for n in range(words):
        I[backup + n] = I[n]
    given = inputs[IN_VELOCITY] != 0.0 or inputs[IN_POSITION] != 0.0
    returning = False
    if given or I[I_LIVE] == 1:
        set_live_motion(I, M, t_end, inputs)
        I[I_LIVE] = 1
        returning = not given
    if inputs[IN_CURRENT] != 0.0 or I[I_CURRENT] != 0:
        set_live_current(I, M, t_end, inputs)
    given_rate = inputs[IN_PAYOUT] != 0.0
    returning_rate = I[I_RATE_LIVE] == 1 and not given_rate
    if given_rate or returning_rate:
        set_live_rate(I, M, t_end, inputs)
    leave_plane(I, M)
    status = advance(I, M, t_end)
    if status != OK:
        failed = I[I_FAILED_NODE]
        for n in range(words):
            I[n] = I[backup + n]
        I[I_FAILED_NODE] = failed
        return status
    if returning:
        I[I_LIVE] = 0
    if returning_rate:
        I[I_RATE_LIVE] = 0
    return status
