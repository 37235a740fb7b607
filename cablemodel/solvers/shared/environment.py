"""Motion of the prescribed points and velocity of the water, at any time."""

import math

from cablemodel.solvers.shared.access import (
    arc_at,
    constraint_of,
    element_points,
    header,
    motion_piece_at,
    motion_piece_of,
    polynomial_at,
    scalars,
    tow_point_of,
)
from cablemodel.solvers.shared.compile import (
    inlined,
    kernel,
    view,
)
from cablemodel.solvers.shared.layout import (
    BY_SPRING,
    HELD_BY_ANCHOR,
    PIECE_WORDS,
    POINT_WORDS,
    POLYNOMIAL,
)

TIME_ROUNDING = 4e-15  # times that differ by less of themselves are the same


@kernel
def evaluate_piece(M, row, t, out):
    """The Motion by one piece of it at time t."""
    tau = t - row.start
    if row.kind == POLYNOMIAL:
        law = polynomial_at(row.data, 0)
        for i in range(3):
            c1 = law.velocity[i]
            c2 = law.second[i]
            c3 = law.third[i]
            c4 = law.fourth[i]
            out.position[i] = law.position[i] + tau * (c1 + tau * (c2 + tau * (c3 + tau * c4)))
            out.velocity[i] = c1 + tau * (2.0 * c2 + tau * (3.0 * c3 + tau * 4.0 * c4))
            out.acceleration[i] = 2.0 * c2 + tau * (6.0 * c3 + tau * 12.0 * c4)
        return
    arc = arc_at(row.data, 0)
    radius = arc.radius
    spin = arc.spin
    angle = arc.angle + tau * (arc.rate + 0.5 * spin * tau)
    rate = arc.rate + spin * tau
    cx = math.cos(angle)
    sx = math.sin(angle)
    out.position[0] = arc.centre[0] + radius * cx
    out.position[1] = arc.centre[1] + radius * sx
    out.position[2] = arc.centre[2]
    out.velocity[0] = -radius * rate * sx
    out.velocity[1] = radius * rate * cx
    out.velocity[2] = 0.0
    out.acceleration[0] = radius * (-rate * rate * cx - spin * sx)
    out.acceleration[1] = radius * (-rate * rate * sx + spin * cx)
    out.acceleration[2] = 0.0


@kernel
def begin_cubic(piece, time, t_end):
    """Make a piece a motion by a cubic between two times; returns its law, still to be filled."""
    piece.start = time
    piece.end = t_end
    piece.kind = POLYNOMIAL
    law = polynomial_at(piece.data, 0)
    for i in range(3):
        law.fourth[i] = 0.0
    return law


@kernel
def find_piece(I, M, t):
    """Row of the scene's piece with start < t <= end: at a breakpoint, the one that ends there."""
    head = header(I)
    count = head.piece_count
    k = head.piece
    table = head.pieces
    while k < count - 1 and t > motion_piece_at(M, table + k * PIECE_WORDS).end:
        k += 1
    while k > 1 and t <= motion_piece_at(M, table + k * PIECE_WORDS).start:
        k -= 1
    return k


@kernel
def vessel_motion(I, M, t):
    """Tow point's position, velocity, acceleration at time t, earth frame, into the block."""
    head = header(I)
    state = scalars(M)
    out = tow_point_of(I, M, 0)
    if head.live == 1:
        evaluate_piece(M, motion_piece_of(I, M, 0), t, out)
    else:
        k = find_piece(I, M, t)
        evaluate_piece(M, motion_piece_of(I, M, k), t, out)
        for i in range(3):
            out.position[i] += state.shift[i]


@kernel
def add_layer_motion(I, M, t, out):
    """Add to the tow point's position, velocity and acceleration those of where elements begin.

    Beside a clamp past which cable runs: see `clamp_layer.py`.
    """
    head = header(I)
    dimension = head.dimension
    row = constraint_of(I, M, 0)
    rate = row.layer_rate
    tau = max(0.0, t - row.layer_time)
    fade = math.exp(-rate * tau)
    for i in range(dimension):
        second = 2.0 * row.drift_rate[i]
        first = row.drift[i] + second * tau
        away = row.away[i] + (first - 0.5 * second * tau) * tau
        out.position[i] += row.place[i] + away * fade
        out.velocity[i] += (first - rate * away) * fade
        out.acceleration[i] += (second - rate * (2.0 * first - rate * away)) * fade


@kernel
def prescribed_motion(I, M, row, t, out):
    """Motion of a constrained node in the block's own coordinates.

    `row` is the constraint's row; for the vessel, `vessel_motion` has been called for this time.
    """
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    if row.kind == HELD_BY_ANCHOR:
        for i in range(dimension):
            out.position[i] = row.position[i]
            out.velocity[i] = 0.0
            out.acceleration[i] = 0.0
        return
    tow = tow_point_of(I, M, 0)
    if dimension == 3:
        for i in range(3):
            out.position[i] = tow.position[i] - state.origin[i]
            out.velocity[i] = tow.velocity[i]
            out.acceleration[i] = tow.acceleration[i]
    else:
        px = state.plane[0]
        py = state.plane[1]
        x = tow.position[0] - state.origin[0]
        y = tow.position[1] - state.origin[1]
        out.position[0] = px * x + py * y
        out.position[1] = tow.position[2] - state.origin[2]
        out.velocity[0] = px * tow.velocity[0] + py * tow.velocity[1]
        out.velocity[1] = tow.velocity[2]
        out.acceleration[0] = px * tow.acceleration[0] + py * tow.acceleration[1]
        out.acceleration[1] = tow.acceleration[2]
    if row.clamped == BY_SPRING:
        add_layer_motion(I, M, t, out)


@kernel
def current_profile(I, M, t):
    """Water velocity over depth at time t into the block; constant ones to the Gauss points too.

    The scene's table is bilinear over depth and time and constant beyond its ends; the live
    current of the caller, linear in time between two values, is added at every depth.
    """
    head = header(I)
    state = scalars(M)
    water = element_points(I, M, 0).water
    head.surge = 0
    if head.current_kind == 0:
        for k in range(3 * POINT_WORDS):
            water[k] = 0.0
        return
    depths = head.depth_count
    times = head.time_count
    table = head.current
    grid = head.times
    k = 0
    fraction = 0.0
    if times > 1:
        if t >= M[grid + times - 1]:
            k = times - 2
            fraction = 1.0
        elif t > M[grid]:
            while t > M[grid + k + 1]:
                k += 1
            fraction = (t - M[grid + k]) / (M[grid + k + 1] - M[grid + k])
    given = state.live_current
    live = 1.0
    if t < given.end:
        live = max(0.0, (t - given.begin) / (given.end - given.begin))
    planar = head.dimension == 2
    for j in range(depths):
        out = view(M, head.profile + 3 * j, 3)
        for i in range(3):
            at = table + (k * depths + j) * 3 + i
            value = M[at]
            if fraction > 0.0:
                value += fraction * (M[at + 3 * depths] - value)
            start = given.first[i]
            out[i] = value + start + live * (given.last[i] - start)
        if planar:
            out[0] = state.plane[0] * out[0] + state.plane[1] * out[1]
            out[1] = out[2]
    if depths == 1:
        for i in range(3):
            for g in range(POINT_WORDS):
                water[POINT_WORDS * i + g] = M[head.profile + i]
    current_rate(I, M, t, False)


@inlined
def holds(start, end, t, ahead):
    """Whether start < t <= end, or, ahead, start <= t < end; times that differ by rounding are
    the same."""
    same = TIME_ROUNDING * abs(t)
    if ahead:
        return t >= start - same and t < end - same
    return t > start + same and t <= end + same


@kernel
def changing(I, M, t, ahead):
    """What of the current changes at time t: the row of the scene's table before it, one over the
    time to the next row, and one over the time of the caller's (-1: as before that); 0: nothing.

    At a breakpoint it is the piece that ends there, or, ahead, the one that begins. Until t = 0
    nothing changes: static starts are in a current that stays as it is.
    """
    head = header(I)
    state = scalars(M)
    piece = 0
    slope = 0.0
    live = 0.0
    if t > 0.0 or ahead:
        grid = head.times
        for k in range(head.time_count - 1):
            if holds(M[grid + k], M[grid + k + 1], t, ahead):
                piece = k
                slope = 1.0 / (M[grid + k + 1] - M[grid + k])
        given = state.live_current
        if holds(given.begin, given.end, t, ahead):
            live = 1.0 / (given.end - given.begin)
        elif not ahead and abs(t - given.begin) <= TIME_ROUNDING * t:
            live = -1.0
    return piece, slope, live


@kernel
def rate_at(I, M, j, i, piece, slope, live):
    """Component i of the water's acceleration at depth j of the table, by what `changing` says."""
    head = header(I)
    state = scalars(M)
    if live < 0.0:
        rate = state.current_slope[i]
    else:
        rate = live * (state.live_current.last[i] - state.live_current.first[i])
    if slope != 0.0:
        depths = head.depth_count
        at = head.current + (piece * depths + j) * 3 + i
        rate += slope * (M[at + 3 * depths] - M[at])
    return rate


@kernel
def current_rate(I, M, t, ahead):
    """Acceleration of the water at fixed places into the profile; `surge` says if there is any."""
    head = header(I)
    state = scalars(M)
    head.surge = 0
    if head.current_kind == 0:
        return
    piece, slope, live = changing(I, M, t, ahead)
    if slope == 0.0 and live == 0.0:
        return
    planar = head.dimension == 2
    for j in range(head.depth_count):
        out = view(M, head.profile + 3 * (head.depth_count + j), 3)
        for i in range(3):
            out[i] = rate_at(I, M, j, i, piece, slope, live)
            if out[i] != 0.0:
                head.surge = 1
        if planar:
            out[0] = state.plane[0] * out[0] + state.plane[1] * out[1]
            out[1] = out[2]


@kernel
def surge_jump(I, M, t):
    """What the water's acceleration changes by at time t, and how large it is then or before, the
    most of all depths [m/s2]; 0, 0 where it does not change."""
    head = header(I)
    largest = 0.0
    most = 0.0
    if head.current_kind == 0:
        return largest, most
    piece, slope, live = changing(I, M, t, False)
    next_piece, next_slope, next_live = changing(I, M, t, True)
    if piece == next_piece and slope == next_slope and live == next_live:
        return largest, most
    for j in range(head.depth_count):
        square = 0.0
        before = 0.0
        after = 0.0
        for i in range(3):
            old = rate_at(I, M, j, i, piece, slope, live)
            new = rate_at(I, M, j, i, next_piece, next_slope, next_live)
            square += (new - old) ** 2
            before += old * old
            after += new * new
        largest = max(largest, square)
        most = max(most, before, after)
    return math.sqrt(largest), math.sqrt(most)


@kernel
def interval(M, grid, count, x):
    """The interval of an ascending grid that holds x, and the place in it (0 to 1)."""
    if x <= M[grid]:
        return 0, 0.0
    if x >= M[grid + count - 1]:
        return count - 2, 1.0
    low = 0
    high = count - 1
    while high - low > 1:
        middle = (low + high) // 2
        if x >= M[grid + middle]:
            low = middle
        else:
            high = middle
    return low, (x - M[grid + low]) / (M[grid + low + 1] - M[grid + low])


@kernel
def current_at(I, M, z, out):
    """Water velocity at height z (block coordinates) from the present profile; out: 3 words."""
    head = header(I)
    if head.current_kind == 0:
        for i in range(3):
            out[i] = 0.0
        return
    over_depth(I, M, head.profile, z, out)


@kernel
def surge_at(I, M, z, out):
    """The water's acceleration at height z, as `current_at`; only where `surge` is not 0."""
    head = header(I)
    over_depth(I, M, head.profile + 3 * head.depth_count, z, out)


@kernel
def shear_at(I, M, z, out):
    """By how much the water's velocity grows with height at height z [1/s], as `current_at`."""
    head = header(I)
    grid = head.depths
    low, fraction = interval(M, grid, head.depth_count, z + scalars(M).origin[2])
    over = 1.0 / (M[grid + low + 1] - M[grid + low])
    if fraction <= 0.0 or fraction >= 1.0:
        over = 0.0  # as at the table's end
    lower = view(M, head.profile + 3 * low, 3)
    upper = view(M, head.profile + 3 * (low + 1), 3)
    for i in range(3):
        out[i] = over * (upper[i] - lower[i])


@kernel
def over_depth(I, M, profile, z, out):
    """Between the depths of a profile, by its first word, at height z; out: 3 words."""
    head = header(I)
    state = scalars(M)
    depths = head.depth_count
    grid = head.depths
    height = z + state.origin[2]
    low = 0
    fraction = 0.0
    if depths > 1:
        low, fraction = interval(M, grid, depths, height)
    lower = view(M, profile + 3 * low, 3)
    upper = view(M, profile + 3 * (low + 1), 3)
    for i in range(3):
        value = lower[i]
        if fraction > 0.0:
            value += fraction * (upper[i] - value)
        out[i] = value
