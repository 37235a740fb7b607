"""One step of the model as its callers see it: inputs in, time reached or nothing changed.

An input is the value reached at the step's end; it varies linearly from its present value. A
position given with a velocity makes the motion the cubic that meets both; a position alone takes
the mean velocity of the step as the final one. Inputs that are not given follow the scene.
"""

import math

from .access import (
    header,
    motion_piece_of,
    new_motion,
    polynomial_at,
    scalars,
    step_inputs_at,
    tow_point_of,
)
from .backup import give_back, keep_state
from .compile import kernel
from .consistency import state_residual
from .environment import ROUNDING, begin_cubic, evaluate_piece, find_piece, vessel_motion
from .layout import (
    INPUT_WORDS,
    NOT_FINITE,
    OK,
)
from .promote import promote
from .sleep import leave_out, rejoin
from .step_size import natural_step
from .system import set_time
from .time_stepping import advance_to
from .vessel_clamp import release_slope
from .winch import drive_winch


@kernel
def set_live_motion(I, M, t_end, inputs):
    """Make row 0 of the motion table the polynomial that the inputs ask for."""
    state = scalars(M)
    time = state.time
    dt = t_end - time
    target = new_motion()
    if inputs.velocity_given == 0.0 and inputs.position_given == 0.0:
        # Back to the scene's motion: its velocity at the step's end, then its own course, shifted.
        k = find_piece(I, M, t_end)
        evaluate_piece(M, motion_piece_of(I, M, k), t_end, target)
    vessel_motion(I, M, time)
    now = tow_point_of(I, M, 0)
    law = begin_cubic(motion_piece_of(I, M, 0), time, t_end)
    for i in range(3):
        p0 = now.position[i]
        v0 = now.velocity[i]
        c2 = 0.0
        c3 = 0.0
        if inputs.position_given != 0.0:
            mean = (inputs.position[i] - p0) / dt
            v1 = mean
            if inputs.velocity_given != 0.0:
                v1 = inputs.velocity[i]
            c2 = (3.0 * mean - 2.0 * v0 - v1) / dt
            c3 = (v0 + v1 - 2.0 * mean) / (dt * dt)
        elif inputs.velocity_given != 0.0:
            c2 = 0.5 * (inputs.velocity[i] - v0) / dt
        else:
            v1 = target.velocity[i]
            c2 = 0.5 * (v1 - v0) / dt
            state.shift[i] = p0 + 0.5 * (v0 + v1) * dt - target.position[i]
        law.position[i] = p0
        law.velocity[i] = v0
        law.second[i] = c2
        law.third[i] = c3


@kernel
def set_live_current(I, M, t_end, inputs):
    """The caller's current, added to the scene's: linear from its present value."""
    head = header(I)
    state = scalars(M)
    live = state.live_current
    time = state.time
    span = live.end - live.begin
    fraction = 1.0
    if span > 0.0:
        fraction = min(1.0, max(0.0, (time - live.begin) / span))
    flows = False
    goes_on = span > 0.0 and time <= live.end + ROUNDING * time
    for i in range(3):
        change = live.last[i] - live.first[i]
        state.current_slope[i] = change / span if goes_on else 0.0
        start = live.first[i] + fraction * change
        end = inputs.current[i] if inputs.current_given != 0.0 else 0.0
        live.first[i] = start
        live.last[i] = end
        if start != 0.0 or end != 0.0:
            flows = True
    live.begin = time
    live.end = t_end
    if flows and head.current_kind == 0:
        head.current_kind = 1


@kernel
def out_of_plane(I, M, x, y):
    """Whether a horizontal vector leaves the plane of a planar model."""
    state = scalars(M)
    across = state.plane[0] * y - state.plane[1] * x
    return abs(across) > 1e-12 * (abs(x) + abs(y))


@kernel
def leave_plane(I, M, x, y):
    """Turn the plane to (x, y) where the cable is vertical and still, else leave the plane."""
    head = header(I)
    state = scalars(M)
    nodes = head.nodes
    largest = 0.0
    for n in range(nodes):
        for k in range(2):
            at = 4 * n + 2 * k
            largest = max(
                largest,
                abs(M[head.position + at]) / state.length,
                abs(M[head.velocity + at]),
                abs(M[head.acceleration + at]),
            )
    if largest <= 1e-12 and head.current_kind == 0 and head.wave_count == 0:
        size = math.hypot(x, y)
        state.plane[0] = x / size
        state.plane[1] = y / size
    else:
        promote(I, M)


@kernel
def keep_plane(I, M):
    """Promote a planar model whose live inputs leave its plane."""
    head = header(I)
    state = scalars(M)
    if head.dimension == 3:
        return
    live = state.live_current
    law = polynomial_at(motion_piece_of(I, M, 0).data, 0)
    # A plane that was turned for one input must hold for all of them: a second time.
    for again in range(2):
        if head.live == 1:
            for rate in (law.velocity, law.second, law.third):
                if head.dimension == 2 and out_of_plane(I, M, rate[0], rate[1]):
                    if again == 0:
                        leave_plane(I, M, rate[0], rate[1])
                    else:
                        promote(I, M)
        for flow in (live.first, live.last):
            if head.dimension == 2 and out_of_plane(I, M, flow[0], flow[1]):
                if again == 0:
                    leave_plane(I, M, flow[0], flow[1])
                else:
                    promote(I, M)


@kernel
def possible(M, t_end, inputs):
    """Whether a step goes forward in time and all its inputs are finite."""
    state = scalars(M)
    if not abs(t_end) < 1e300 or not t_end > state.time:
        return False
    for n in range(INPUT_WORDS):
        if not abs(inputs[n]) < 1e100:
            return False
    return True


@kernel
def take_inputs(I, M, t_end, words):
    """Make the inputs of a step to t_end, StepInputs, what drives the block. Returns whether the
    vessel goes back to the scene's own motion by it, for `release_inputs`."""
    head = header(I)
    inputs = step_inputs_at(words, 0)
    returning = False
    given = inputs.velocity_given != 0.0 or inputs.position_given != 0.0
    if given or head.live == 1:
        set_live_motion(I, M, t_end, inputs)
        head.live = 1
        if not given:
            returning = True
    if inputs.current_given != 0.0 or head.current_kind != 0:
        set_live_current(I, M, t_end, inputs)
    if head.parts == 0 and drive_winch(
        I, M, 0, t_end, inputs.payout_given != 0.0, inputs.payout_rate
    ):
        release_slope(I, M)
    return returning


@kernel
def release_inputs(I, returning):
    """After a step that was made: from its end on the scene drives what has gone back to it."""
    if returning:
        header(I).live = 0


@kernel
def take_step(I, M, t_end, inputs):
    """Step to t_end [s] with the given inputs (INPUT_WORDS); on failure nothing has changed."""
    head = header(I)
    state = scalars(M)
    if not possible(M, t_end, inputs):
        return NOT_FINITE
    keep_state(I)
    returning = take_inputs(I, M, t_end, inputs)
    keep_plane(I, M)
    if head.parts != 0:
        # The matrix goes by what lines pulled bodies with at the last residual: that of the state,
        # whether its outputs have been read or not.
        set_time(I, M, state.time)
        state_residual(I, M)
    if head.asleep != 0:
        leave_out(I, M)
    status = OK
    span = t_end - state.time
    middle = state.time + 0.5 * span
    halves = 2 if state.halves != 0.0 and natural_step(I, M) > span else 1
    for half in range(halves):
        status = advance_to(I, M, t_end if half == halves - 1 else middle)
        if status != OK:
            give_back(I)
            return status
    if head.asleep != 0:
        rejoin(I, M)
    head.keep_matrix = 0
    head.keep_sleepers = 0
    release_inputs(I, returning)
    return status
