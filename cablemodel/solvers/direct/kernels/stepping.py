"""Steps in time: sub-steps of at most the scene's time step, landing on breakpoints and on the end.

What a call of `step` means, inputs in, all or nothing, is as for the finite elements; the inputs
are read by the same kernels.
"""

import math

from cablemodel.solvers.shared.access import (
    header,
    motion_piece_of,
    scalars,
    tow_point_of,
    winch_of,
)
from cablemodel.solvers.shared.environment import (
    current_profile,
    find_piece,
    surge_jump,
    vessel_motion,
)
from cablemodel.solvers.shared.inputs import commanded_rate, possible, release_inputs, take_inputs
from cablemodel.solvers.shared.layout import (
    NOT_FINITE,
    OK,
)

from .access import own_header, own_scalars
from .axes import leave_plane, turn_axes
from .backup import give_back_image, give_back_start, keep_image, keep_start
from .compile import kernel
from .frame import from_earth
from .history import keep_past, set_rates
from .layout import (
    END_TOUCHDOWN,
)
from .limits import check_floor, check_state
from .newton import solve_level
from .regrid import make_room, regrid
from .slack import follow_slack
from .touchdown import change_end, time_to_landing

DIRECT_SMALLEST_SHARE = 1.0 / 1024.0
"""Of the time step: below it a step that does not converge is given up."""
DIRECT_AT_ONCE = 1e-9
RESTART = 0.5
"""Of the water's acceleration: a change by the caller after which rates before it are of no use."""


@kernel
def set_vessel(I, M, t):
    """Tow point and its velocity at time t in the paper's axes."""
    run = own_scalars(M)
    vessel_motion(I, M, t)
    tow = tow_point_of(I, M, 0)
    p = tow.position
    v = tow.velocity
    vessel = run.vessel
    vessel[0], vessel[1], vessel[2] = from_earth(M, p[0], p[1], p[2])
    vessel[3], vessel[4], vessel[5] = from_earth(M, v[0], v[1], v[2])


@kernel
def pay_out(I, M, t, dt):
    """Rate at the end of a step and cable paid out within it; clamped where the drum ends."""
    run = own_scalars(M)
    winch = winch_of(I, M, 0)
    rate, slope, _until = commanded_rate(I, M, 0, t)
    paid = (rate + 0.5 * slope * dt) * dt
    rate += slope * dt
    winch.at_limit = 0.0
    if winch.paid + paid > winch.paid_most:
        paid = winch.paid_most - winch.paid
        winch.at_limit = 1.0
    elif winch.paid + paid < winch.paid_least:
        paid = winch.paid_least - winch.paid
        winch.at_limit = -1.0
    if winch.at_limit != 0.0:
        rate = 0.0 if abs(paid) < 1e-12 else paid / dt
    run.rate = rate
    run.paid_in_step = paid


@kernel
def one_step(I, M, dt):
    """One implicit step of dt from `time`, for which `pay_out` has been called. On failure the
    state is that of the start."""
    own = own_header(I)
    run = own_scalars(M)
    head = header(I)
    state = scalars(M)
    t = state.time
    alpha = 1.0 if own.restart != 0 else run.alpha
    run.dt = dt
    run.beta = 1.0 / (alpha * dt)
    run.memory = (1.0 - alpha) / alpha
    keep_start(I, M)
    keep_past(I, M)
    set_vessel(I, M, t + dt)
    current_profile(I, M, t + dt)
    before = head.iterations
    status = solve_level(I, M)
    if status == OK:
        status = check_state(I, M)
    if status == OK:
        status = check_floor(I, M)
    if status != OK:
        set_vessel(I, M, t)
        give_back_start(I, M)
        return status
    taken = head.iterations - before
    if taken > own.most_iterations:
        own.most_iterations = taken
    set_rates(I, M)
    own.restart = 0
    winch_of(I, M, 0).paid += run.paid_in_step
    if own.end == END_TOUCHDOWN:
        run.laid += dt * run.flow_end
    run.paid_in_step = 0.0
    state.time = t + dt
    head.steps += 1
    return OK


@kernel
def next_breakpoint(I, M, t_end):
    """The first time after `time` where an input has a breakpoint, at most t_end; and whether the
    acceleration of vessel or water jumps there."""
    head = header(I)
    state = scalars(M)
    t = state.time
    least = t + DIRECT_AT_ONCE * max(1.0, abs(t))
    nearest = t_end
    jump = 0
    if head.live == 0:
        k = find_piece(I, M, t)
        while k < head.piece_count - 1:
            end = motion_piece_of(I, M, k).end
            if not end < nearest:
                break
            k += 1
            if end > least and motion_piece_of(I, M, k).acceleration_jump > 0.0:
                nearest = end
                jump = 1
                break
    _rate, _slope, until = commanded_rate(I, M, 0, t)
    if until > least and until < nearest:
        nearest = until
        jump = 1
    if head.current_kind != 0:
        for k in range(head.time_count):
            breakpoint_ = M[head.times + k]
            if breakpoint_ > least and breakpoint_ < nearest:
                nearest = breakpoint_
                jump = 1
    return nearest, jump


@kernel
def advance(I, M, t_end):
    """Step to t_end in equal sub-steps between breakpoints; halved where one does not converge."""
    own = own_header(I)
    run = own_scalars(M)
    head = header(I)
    state = scalars(M)
    share = 1.0
    while state.time < t_end:
        t = state.time
        stop, jump = next_breakpoint(I, M, t_end)
        count = max(1.0, math.ceil((stop - t) / (share * run.time_step) - 1e-9))
        dt = time_to_landing(I, M, (stop - t) / count)
        if dt < (stop - t) / count:
            count = 2.0
        pay_out(I, M, t, dt)
        make_room(I, M, dt)
        status = one_step(I, M, dt)
        if status == OK:
            follow_slack(I, M, t, dt)
            change_end(I, M)
            turn_axes(I, M)
            status = regrid(I, M)
            if status != OK:
                return status
            if count == 1.0:
                state.time = stop
                if jump != 0:
                    own.restart = 1
                if head.live == 0:
                    head.piece = find_piece(I, M, stop)
            share = min(1.0, 2.0 * share)
            continue
        head.rejected += 1
        share = 0.5 * min(share, dt / run.time_step)
        if share < DIRECT_SMALLEST_SHARE:
            return status
    return OK


@kernel
def take_step(I, M, t_end, inputs):
    """Step to t_end [s] with the given inputs (INPUT_WORDS); on failure nothing has changed."""
    own = own_header(I)
    state = scalars(M)
    if not possible(M, t_end, inputs):
        return NOT_FINITE
    keep_image(I)
    returning, _runs = take_inputs(I, M, t_end, inputs)
    jump, surge = surge_jump(I, M, state.time)
    if jump > RESTART * surge:
        own.restart = 1
    leave_plane(I, M)
    status = advance(I, M, t_end)
    if status != OK:
        give_back_image(I)
        return status
    release_inputs(I, returning)
    return status
