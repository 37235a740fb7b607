"""One step of the model as its callers see it: inputs in, time reached or nothing changed.

An input is the value reached at the step's end; it varies linearly from its present value. A
position given with a velocity makes the motion the cubic that meets both; a position alone takes
the mean velocity of the step as the final one. Inputs that are not given follow the scene.
"""

import math

from .backup import give_back, keep_state
from .compile import kernel
from .consistency import state_residual
from .environment import ROUNDING, evaluate_piece, find_piece, vessel_motion
from .layout import (
    I_ASLEEP,
    I_CURRENT,
    I_DIMENSION,
    I_KEEP_MATRIX,
    I_KEEP_SLEEPERS,
    I_LIVE,
    I_NODES,
    I_PARTS,
    I_PAYOUT,
    I_RATE_LIVE,
    I_WAVES,
    NOT_FINITE,
    O_ACCELERATION,
    O_MOTION,
    O_PIECES,
    O_POSITION,
    O_VELOCITY,
    OK,
    P_DATA,
    P_END,
    P_KIND,
    P_START,
    PIECE_WORDS,
    S_CURRENT_SLOPE,
    S_HALVES,
    S_LENGTH,
    S_LIVE_CURRENT,
    S_LIVE_RATE,
    S_PLANE,
    S_SHIFT,
    S_TIME,
)
from .promote import promote
from .sleep import leave_out, rejoin
from .step_size import natural_step
from .system import set_time
from .time_stepping import advance_to
from .vessel_clamp import release_slope
from .winch import commanded_rate

# Words of the input vector: a flag (0: not given) before each group.
IN_VELOCITY, IN_POSITION, IN_CURRENT, IN_PAYOUT = 0, 4, 8, 12
INPUT_WORDS = 14


@kernel
def set_live_motion(I, M, t_end, inputs):
    """Make row 0 of the motion table the polynomial that the inputs ask for."""
    time = M[S_TIME]
    dt = t_end - time
    motion = I[O_MOTION]
    target = M[motion + 32 : motion + 41]
    if inputs[IN_VELOCITY] == 0.0 and inputs[IN_POSITION] == 0.0:
        # Back to the scene's motion: its velocity at the step's end, then its own course, shifted.
        k = find_piece(I, M, t_end)
        evaluate_piece(M, I[O_PIECES] + k * PIECE_WORDS, t_end, target)
    vessel_motion(I, M, time)
    row = I[O_PIECES]
    for i in range(3):
        p0 = M[motion + i]
        v0 = M[motion + 3 + i]
        c2 = 0.0
        c3 = 0.0
        if inputs[IN_POSITION] != 0.0:
            mean = (inputs[IN_POSITION + 1 + i] - p0) / dt
            v1 = mean
            if inputs[IN_VELOCITY] != 0.0:
                v1 = inputs[IN_VELOCITY + 1 + i]
            c2 = (3.0 * mean - 2.0 * v0 - v1) / dt
            c3 = (v0 + v1 - 2.0 * mean) / (dt * dt)
        elif inputs[IN_VELOCITY] != 0.0:
            c2 = 0.5 * (inputs[IN_VELOCITY + 1 + i] - v0) / dt
        else:
            c2 = 0.5 * (target[3 + i] - v0) / dt
            M[S_SHIFT + i] = p0 + 0.5 * (v0 + target[3 + i]) * dt - target[i]
        M[row + P_DATA + i] = p0
        M[row + P_DATA + 3 + i] = v0
        M[row + P_DATA + 6 + i] = c2
        M[row + P_DATA + 9 + i] = c3
        M[row + P_DATA + 12 + i] = 0.0
    M[row + P_START] = time
    M[row + P_END] = t_end
    M[row + P_KIND] = 0.0


@kernel
def set_live_current(I, M, t_end, inputs):
    """The caller's current, added to the scene's: linear from its present value."""
    at = S_LIVE_CURRENT
    time = M[S_TIME]
    span = M[at + 1] - M[at]
    fraction = 1.0
    if span > 0.0:
        fraction = min(1.0, max(0.0, (time - M[at]) / span))
    flows = False
    goes_on = span > 0.0 and time <= M[at + 1] + ROUNDING * time
    for i in range(3):
        change = M[at + 5 + i] - M[at + 2 + i]
        M[S_CURRENT_SLOPE + i] = change / span if goes_on else 0.0
        start = M[at + 2 + i] + fraction * (M[at + 5 + i] - M[at + 2 + i])
        end = inputs[IN_CURRENT + 1 + i] if inputs[IN_CURRENT] != 0.0 else 0.0
        M[at + 2 + i] = start
        M[at + 5 + i] = end
        if start != 0.0 or end != 0.0:
            flows = True
    M[at] = time
    M[at + 1] = t_end
    if flows and I[I_CURRENT] == 0:
        I[I_CURRENT] = 1


@kernel
def set_live_rate(I, M, t_end, inputs):
    """The caller's pay-out rate, or back to the scene's: linear from the present command."""
    present, _slope, _until = commanded_rate(I, M, M[S_TIME])
    target = inputs[IN_PAYOUT + 1]
    if inputs[IN_PAYOUT] == 0.0:
        I[I_RATE_LIVE] = 0
        target, _slope, _until = commanded_rate(I, M, t_end)
    I[I_RATE_LIVE] = 1
    M[S_LIVE_RATE] = M[S_TIME]
    M[S_LIVE_RATE + 1] = t_end
    M[S_LIVE_RATE + 2] = present
    M[S_LIVE_RATE + 3] = target
    if present != 0.0 or target != 0.0:
        I[I_PAYOUT] = 1
        release_slope(I, M)


@kernel
def out_of_plane(I, M, x, y):
    """Whether a horizontal vector leaves the plane of a planar model."""
    across = M[S_PLANE] * y - M[S_PLANE + 1] * x
    return abs(across) > 1e-12 * (abs(x) + abs(y))


@kernel
def leave_plane(I, M, x, y):
    """Turn the plane to (x, y) where the cable is vertical and still, else leave the plane."""
    nodes = I[I_NODES]
    largest = 0.0
    for n in range(nodes):
        for k in range(2):
            at = 4 * n + 2 * k
            largest = max(
                largest,
                abs(M[I[O_POSITION] + at]) / M[S_LENGTH],
                abs(M[I[O_VELOCITY] + at]),
                abs(M[I[O_ACCELERATION] + at]),
            )
    if largest <= 1e-12 and I[I_CURRENT] == 0 and I[I_WAVES] == 0:
        size = math.hypot(x, y)
        M[S_PLANE] = x / size
        M[S_PLANE + 1] = y / size
    else:
        promote(I, M)


@kernel
def keep_plane(I, M):
    """Promote a planar model whose live inputs leave its plane."""
    if I[I_DIMENSION] == 3:
        return
    if I[I_LIVE] == 1:
        for k in range(1, 4):
            at = I[O_PIECES] + P_DATA + 3 * k
            if I[I_DIMENSION] == 2 and out_of_plane(I, M, M[at], M[at + 1]):
                leave_plane(I, M, M[at], M[at + 1])
    for k in range(2):
        at = S_LIVE_CURRENT + 2 + 3 * k
        if I[I_DIMENSION] == 2 and out_of_plane(I, M, M[at], M[at + 1]):
            leave_plane(I, M, M[at], M[at + 1])
    if I[I_DIMENSION] == 2:
        # A plane that was turned for one input must hold for all of them.
        for k in range(1, 4):
            at = I[O_PIECES] + P_DATA + 3 * k
            if I[I_LIVE] == 1 and out_of_plane(I, M, M[at], M[at + 1]):
                promote(I, M)
                return
        for k in range(2):
            at = S_LIVE_CURRENT + 2 + 3 * k
            if out_of_plane(I, M, M[at], M[at + 1]):
                promote(I, M)
                return


@kernel
def possible(M, t_end, inputs):
    """Whether a step goes forward in time and all its inputs are finite."""
    if not abs(t_end) < 1e300 or not t_end > M[S_TIME]:
        return False
    for n in range(INPUT_WORDS):
        if not abs(inputs[n]) < 1e100:
            return False
    return True


@kernel
def take_inputs(I, M, t_end, inputs):
    """Make the inputs of a step to t_end what drives the block. Returns what goes back to the
    scene's own schedule by it, for `release_inputs`: 1 the vessel, 2 the pay-out, 3 both."""
    returning = 0
    given = inputs[IN_VELOCITY] != 0.0 or inputs[IN_POSITION] != 0.0
    if given or I[I_LIVE] == 1:
        set_live_motion(I, M, t_end, inputs)
        I[I_LIVE] = 1
        if not given:
            returning += 1
    if inputs[IN_CURRENT] != 0.0 or I[I_CURRENT] != 0:
        set_live_current(I, M, t_end, inputs)
    given_rate = inputs[IN_PAYOUT] != 0.0
    returning_rate = I[I_RATE_LIVE] == 1 and not given_rate
    if given_rate or returning_rate:
        set_live_rate(I, M, t_end, inputs)
    if returning_rate:
        returning += 2
    return returning


@kernel
def release_inputs(I, returning):
    """After a step that was made: from its end on the scene drives what has gone back to it."""
    if returning & 1:
        I[I_LIVE] = 0
    if returning & 2:
        I[I_RATE_LIVE] = 0


@kernel
def take_step(I, M, t_end, inputs):
    """Step to t_end [s] with the given inputs (INPUT_WORDS); on failure nothing has changed."""
    if not possible(M, t_end, inputs):
        return NOT_FINITE
    keep_state(I)
    returning = take_inputs(I, M, t_end, inputs)
    keep_plane(I, M)
    if I[I_PARTS] != 0:
        # The matrix goes by what lines pulled bodies with at the last residual: that of the state,
        # whether its outputs have been read or not.
        set_time(I, M, M[S_TIME])
        state_residual(I, M)
    if I[I_ASLEEP] != 0:
        leave_out(I, M)
    status = OK
    span = t_end - M[S_TIME]
    middle = M[S_TIME] + 0.5 * span
    halves = 2 if M[S_HALVES] != 0.0 and natural_step(I, M) > span else 1
    for half in range(halves):
        status = advance_to(I, M, t_end if half == halves - 1 else middle)
        if status != OK:
            give_back(I)
            return status
    if I[I_ASLEEP] != 0:
        rejoin(I, M)
    I[I_KEEP_MATRIX] = 0
    I[I_KEEP_SLEEPERS] = 0
    release_inputs(I, returning)
    return status
