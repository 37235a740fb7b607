"""Motion of the prescribed points and velocity of the water, at any time."""

import math

from .compile import kernel
from .layout import (
    BY_SPRING,
    C_ANCHOR,
    C_AWAY,
    C_CLAMPED,
    C_DRIFT,
    C_DRIFT_RATE,
    C_KIND,
    C_LAYER_RATE,
    C_LAYER_TIME,
    C_PLACE,
    C_POSITION,
    I_CURRENT,
    I_DEPTHS,
    I_DIMENSION,
    I_LIVE,
    I_PIECE,
    I_PIECES,
    I_TIMES,
    O_CONSTRAINT,
    O_CURRENT,
    O_DEPTHS,
    O_GAUSS,
    O_MOTION,
    O_PIECES,
    O_PROFILE,
    O_TIMES,
    P_DATA,
    P_END,
    P_KIND,
    P_START,
    PIECE_WORDS,
    S_BASE,
    S_LIVE_CURRENT,
    S_PLANE,
    S_SHIFT,
)


@kernel
def evaluate_piece(M, row, t, out):
    """Position, velocity, acceleration (out[0:9]) of one piece of vessel motion at time t."""
    tau = t - M[row + P_START]
    if M[row + P_KIND] == 0.0:
        for i in range(3):
            c = row + P_DATA + i
            c1 = M[c + 3]
            c2 = M[c + 6]
            c3 = M[c + 9]
            c4 = M[c + 12]
            out[i] = M[c] + tau * (c1 + tau * (c2 + tau * (c3 + tau * c4)))
            out[3 + i] = c1 + tau * (2.0 * c2 + tau * (3.0 * c3 + tau * 4.0 * c4))
            out[6 + i] = 2.0 * c2 + tau * (6.0 * c3 + tau * 12.0 * c4)
    else:
        c = row + P_DATA
        radius = M[c + 3]
        rate0 = M[c + 5]
        spin = M[c + 6]
        angle = M[c + 4] + tau * (rate0 + 0.5 * spin * tau)
        rate = rate0 + spin * tau
        cx = math.cos(angle)
        sx = math.sin(angle)
        out[0] = M[c] + radius * cx
        out[1] = M[c + 1] + radius * sx
        out[2] = M[c + 2]
        out[3] = -radius * rate * sx
        out[4] = radius * rate * cx
        out[5] = 0.0
        out[6] = radius * (-rate * rate * cx - spin * sx)
        out[7] = radius * (-rate * rate * sx + spin * cx)
        out[8] = 0.0


@kernel
def find_piece(I, M, t):
    """Row of the scene's piece with start < t <= end: at a breakpoint, the one that ends there."""
    count = I[I_PIECES]
    k = I[I_PIECE]
    table = I[O_PIECES]
    while k < count - 1 and t > M[table + k * PIECE_WORDS + P_END]:
        k += 1
    while k > 1 and t <= M[table + k * PIECE_WORDS + P_START]:
        k -= 1
    return k


@kernel
def vessel_motion(I, M, t):
    """Tow point's position, velocity, acceleration at time t, earth frame, into the block."""
    out = M[I[O_MOTION] : I[O_MOTION] + 9]
    if I[I_LIVE] == 1:
        evaluate_piece(M, I[O_PIECES], t, out)
    else:
        k = find_piece(I, M, t)
        evaluate_piece(M, I[O_PIECES] + k * PIECE_WORDS, t, out)
        for i in range(3):
            out[i] += M[S_SHIFT + i]


@kernel
def add_layer_motion(I, M, t, out):
    """Add to the tow point's position, velocity and acceleration those of where elements begin.

    Beside a clamp past which cable runs: see `clamp_layer.py`.
    """
    dimension = I[I_DIMENSION]
    row = I[O_CONSTRAINT]
    rate = M[row + C_LAYER_RATE]
    tau = max(0.0, t - M[row + C_LAYER_TIME])
    fade = math.exp(-rate * tau)
    for i in range(dimension):
        second = 2.0 * M[row + C_DRIFT_RATE + i]
        first = M[row + C_DRIFT + i] + second * tau
        away = M[row + C_AWAY + i] + (first - 0.5 * second * tau) * tau
        out[i] += M[row + C_PLACE + i] + away * fade
        out[dimension + i] += (first - rate * away) * fade
        out[2 * dimension + i] += (second - rate * (2.0 * first - rate * away)) * fade


@kernel
def prescribed_motion(I, M, row, t, out):
    """Position, velocity, acceleration of a constrained node in the block's own coordinates.

    out: 3 * dimension words. `row` is the constraint's row; for the vessel, `vessel_motion` has
    been called for this time.
    """
    dimension = I[I_DIMENSION]
    if M[row + C_KIND] == C_ANCHOR:
        for i in range(3 * dimension):
            out[i] = 0.0
        for i in range(dimension):
            out[i] = M[row + C_POSITION + i]
        return
    motion = I[O_MOTION]
    if dimension == 3:
        for i in range(3):
            out[i] = M[motion + i] - M[S_BASE + i]
            out[3 + i] = M[motion + 3 + i]
            out[6 + i] = M[motion + 6 + i]
    else:
        px = M[S_PLANE]
        py = M[S_PLANE + 1]
        out[0] = px * (M[motion] - M[S_BASE]) + py * (M[motion + 1] - M[S_BASE + 1])
        out[1] = M[motion + 2] - M[S_BASE + 2]
        out[2] = px * M[motion + 3] + py * M[motion + 4]
        out[3] = M[motion + 5]
        out[4] = px * M[motion + 6] + py * M[motion + 7]
        out[5] = M[motion + 8]
    if M[row + C_CLAMPED] == BY_SPRING:
        add_layer_motion(I, M, t, out)


@kernel
def current_profile(I, M, t):
    """Water velocity over depth at time t into the block; constant ones into the Gauss slots too.

    The scene's table is bilinear over depth and time and constant beyond its ends; the live
    current of the caller, linear in time between two values, is added at every depth.
    """
    gauss = I[O_GAUSS]
    if I[I_CURRENT] == 0:
        for k in range(12):
            M[gauss + k] = 0.0
        return
    depths = I[I_DEPTHS]
    times = I[I_TIMES]
    table = I[O_CURRENT]
    grid = I[O_TIMES]
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
    t0 = M[S_LIVE_CURRENT]
    t1 = M[S_LIVE_CURRENT + 1]
    live = 1.0
    if t < t1:
        live = max(0.0, (t - t0) / (t1 - t0))
    planar = I[I_DIMENSION] == 2
    for j in range(depths):
        out = I[O_PROFILE] + 3 * j
        for i in range(3):
            at = table + (k * depths + j) * 3 + i
            value = M[at]
            if fraction > 0.0:
                value += fraction * (M[at + 3 * depths] - value)
            start = M[S_LIVE_CURRENT + 2 + i]
            M[out + i] = value + start + live * (M[S_LIVE_CURRENT + 5 + i] - start)
        if planar:
            M[out] = M[S_PLANE] * M[out] + M[S_PLANE + 1] * M[out + 1]
            M[out + 1] = M[out + 2]
    if depths == 1:
        for i in range(3):
            for g in range(4):
                M[gauss + 4 * i + g] = M[I[O_PROFILE] + i]


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
    profile = I[O_PROFILE]
    if I[I_CURRENT] == 0:
        for i in range(3):
            out[i] = 0.0
        return
    depths = I[I_DEPTHS]
    grid = I[O_DEPTHS]
    height = z + M[S_BASE + 2]
    low = 0
    fraction = 0.0
    if depths > 1:
        low, fraction = interval(M, grid, depths, height)
    for i in range(3):
        value = M[profile + 3 * low + i]
        if fraction > 0.0:
            value += fraction * (M[profile + 3 * low + 3 + i] - value)
        out[i] = value
