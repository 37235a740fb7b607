"""The sum of a sea's components at a place.

Sines, cosines and exponentials of all components are made at once, by Taylor's series of arguments
that are small enough, and formulas that double them: arithmetic alone, so that the compiler makes
vectors of it, with the same bits on every machine. Of values of 1 they are right to 1e-12.
"""

import math

from cablemodel.solvers.shared.access import header, scalars
from cablemodel.solvers.shared.compile import inlined, kernel, outlined, view
from cablemodel.solvers.shared.layout import (
    MOTION_WORDS,
    W_AMPLITUDE,
    W_FREQUENCY,
    W_MIRROR,
    W_NUMBER,
    W_PHASE,
    W_SPEED,
)

STILL = 16.0  # k |z| below which a component has died out: e^-16, 1e-7

# A phase is brought to an eighth of [-pi, pi]; 2 pi in two parts, of which the first has few bits.
PER_TURN = 0.5 / math.pi
TURN, TURN_REST = 6.28125, 2.0 * math.pi - 6.28125
ROUND = 1.5 * 2.0**52  # x + ROUND - ROUND is the whole number next to x
S1, S2, S3, S4, S5 = (float((-1) ** n / math.factorial(2 * n + 1)) for n in range(1, 6))
C1, C2, C3, C4, C5, C6 = (float((-1) ** n / math.factorial(2 * n)) for n in range(1, 7))

# An exponent of [-STILL, 0] is brought to a 64th of it, about the middle.
HALVED = 1.0 / 64.0
MIDDLE = 0.5 * STILL * HALVED
E0, E1, E2, E3, E4, E5, E6, E7, E8, E9 = (
    float(math.exp(-MIDDLE) / math.factorial(n)) for n in range(10)
)


@inlined
def column(I, which):
    """First word of a column of the waves' table: W_AMPLITUDE, ..."""
    head = header(I)
    return head.waves + which * head.wave_count


@kernel
def living(I, M, level):
    """How many components, in the order of their numbers, have not died out at a level z [m]."""
    head = header(I)
    count = head.wave_count
    k = view(M, column(I, W_NUMBER), count)
    while count > 0 and k[count - 1] * level < -STILL:
        count -= 1
    return count


@inlined
def columns(I, M, count):
    """Views of the columns that `follow_components` writes."""
    head = header(I)
    every = head.wave_count
    space = head.motion + MOTION_WORDS
    cosine = view(M, space, count)
    sine = view(M, space + every, count)
    along = view(M, space + 2 * every, count)
    upward = view(M, space + 3 * every, count)
    return cosine, sine, along, upward


@inlined
def sine_and_cosine(x):
    """Of a small argument: right to 1e-15 up to pi/8, to 3e-9 at 1.25."""
    q = x * x
    q2 = q * q
    q4 = q2 * q2
    sine = x * ((1.0 + q * S1) + q2 * (S2 + q * S3) + q4 * (S4 + q * S5))
    cosine = (1.0 + q * C1) + q2 * (C2 + q * C3) + q4 * ((C4 + q * C5) + q2 * C6)
    return sine, cosine


@outlined
def follow_components(I, M, count, way, level, t):
    """The first `count` components at a distance along their way, a level z <= 0 [m] and a time.

    Writes four columns: cosine and sine of their phase, amplitude of the velocity along their way
    and upwards.
    """
    frequency = view(M, column(I, W_FREQUENCY), count)
    number = view(M, column(I, W_NUMBER), count)
    phase = view(M, column(I, W_PHASE), count)
    speed = view(M, column(I, W_SPEED), count)
    mirror = view(M, column(I, W_MIRROR), count)
    cosine, sine, along, upward = columns(I, M, count)
    for n in range(count):
        theta = number[n] * way - frequency[n] * t + phase[n]
        turns = (theta * PER_TURN + ROUND) - ROUND
        x = 0.125 * ((theta - turns * TURN) - turns * TURN_REST)
        s, c = sine_and_cosine(x)
        s2 = 2.0 * s * c
        c2 = 1.0 - 2.0 * s * s
        s4 = 2.0 * s2 * c2
        c4 = 1.0 - 2.0 * s2 * s2
        sine[n] = 2.0 * s4 * c4
        cosine[n] = 1.0 - 2.0 * s4 * s4
        z = max(number[n] * level, -STILL) * HALVED + MIDDLE
        z2 = z * z
        z4 = z2 * z2
        up = (E0 + z * E1) + z2 * (E2 + z * E3)
        up += z4 * ((E4 + z * E5) + z2 * (E6 + z * E7) + z4 * (E8 + z * E9))
        up *= up
        up *= up
        up *= up
        up *= up
        up *= up
        up *= up
        down = mirror[n] / up
        along[n] = speed[n] * (up + down)
        upward[n] = speed[n] * (up - down)


@kernel
def sum_components(I, M, count, way, level):
    """The first `count` components at a distance along their way and a level z <= 0 [m].

    Returns elevation of the surface, velocity of the water along their way and upwards, and its
    acceleration, as from waves that have come up.
    """
    state = scalars(M)
    follow_components(I, M, count, way, level, state.wave_time)
    amplitude = view(M, column(I, W_AMPLITUDE), count)
    frequency = view(M, column(I, W_FREQUENCY), count)
    cosine, sine, along, upward = columns(I, M, count)
    surface = 0.0
    u = 0.0
    w = 0.0
    du = 0.0
    dw = 0.0
    for n in range(count):
        surface += amplitude[n] * cosine[n]
        u += along[n] * cosine[n]
        w += upward[n] * sine[n]
        du += frequency[n] * (along[n] * sine[n])
        dw -= frequency[n] * (upward[n] * cosine[n])
    return surface, u, w, du, dw
