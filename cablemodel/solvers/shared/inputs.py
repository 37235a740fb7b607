"""What the caller of a step drives: motion, current and winches, in both solvers.

An input is the value reached at the step's end; it varies linearly from its present value. A
position given with a velocity makes the motion the cubic that meets both; a position alone takes
the mean velocity of the step as the final one. Inputs that are not given follow the scene.
"""

from cablemodel.solvers.shared.access import (
    header,
    motion_piece_of,
    new_motion,
    rate_of,
    scalars,
    step_inputs_at,
    tow_point_of,
    winch_of,
)
from cablemodel.solvers.shared.compile import kernel
from cablemodel.solvers.shared.environment import (
    TIME_ROUNDING,
    begin_cubic,
    evaluate_piece,
    find_piece,
    vessel_motion,
)
from cablemodel.solvers.shared.layout import INPUT_WORDS, LIVE, LIVE_NOT, LIVE_RETURNS


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
    goes_on = span > 0.0 and time <= live.end + TIME_ROUNDING * time
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
def commanded_rate(I, M, n, t):
    """Commanded rate of a winch just after t, its slope, and the time until which they hold."""
    winch = winch_of(I, M, n)
    if winch.live != LIVE_NOT:
        live = winch.live_rate
        if t < live.end:
            slope = (live.last - live.first) / (live.end - live.begin)
            return live.first + slope * (t - live.begin), slope, live.end
        return live.last, 0.0, 1e300
    first = int(winch.first_rate)
    count = int(winch.rates)
    if count == 0:
        return 0.0, 0.0, 1e300
    now = rate_of(I, M, first)
    if t < now.time:
        return now.rate, 0.0, now.time
    for k in range(first, first + count - 1):
        now = rate_of(I, M, k)
        then = rate_of(I, M, k + 1)
        if t < then.time:
            slope = (then.rate - now.rate) / (then.time - now.time)
            return now.rate + slope * (t - now.time), slope, then.time
    return rate_of(I, M, first + count - 1).rate, 0.0, 1e300


@kernel
def drive_winch(I, M, n, t_end, given, target):
    """The caller's rate for a step to t_end, or back to the scene's where none is given: linear
    from the present command. Returns whether cable may pass."""
    winch = winch_of(I, M, n)
    if not given and winch.live != LIVE:
        winch.live = LIVE_NOT
        return False
    time = scalars(M).time
    present, _slope, _until = commanded_rate(I, M, n, time)
    if not given:
        winch.live = LIVE_NOT
        target, _slope, _until = commanded_rate(I, M, n, t_end)
    winch.live = LIVE if given else LIVE_RETURNS
    live = winch.live_rate
    live.begin = time
    live.end = t_end
    live.first = present
    live.last = target
    if present == 0.0 and target == 0.0:
        return False
    header(I).payout = 1
    return True


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
    vessel goes back to the scene's own motion by it, for `release_inputs`, and whether cable may
    pass its winch."""
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
    runs = head.parts == 0 and drive_winch(
        I, M, 0, t_end, inputs.payout_given != 0.0, inputs.payout_rate
    )
    return returning, runs


@kernel
def release_inputs(I, returning):
    """After a step that was made: from its end on the scene drives what has gone back to it."""
    if returning:
        header(I).live = 0
