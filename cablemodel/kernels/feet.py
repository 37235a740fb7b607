"""Free bodies on the sea floor: places of a body that touch it, its feet.

The law is that of the cable's contact (contact.py): each foot bears its part of the body's weight
at rest where it just touches, and friction holds it by a bristle.
"""

import math

from .compile import kernel, view
from .contact import contact_law
from .floor_surface import gap_at
from .layout import (
    FOOT_BODY,
    FOOT_LOAD,
    FOOT_PLACE,
    FOOT_REST,
    FOOT_SCRATCH,
    FOOT_WORDS,
    FREE_WORDS,
    I_FEET,
    M_PLACE,
    M_SPEED,
    M_SPIN,
    M_TURN,
    O_FEET,
    O_FREE,
    O_PARTS_WORK,
    S_BRISTLE,
    S_FLOOR_DAMPING,
    S_FLOOR_DEPTH,
    S_FRICTION,
    Y_MOTION,
    Y_SIZE,
)
from .rotation import cross, to_body_axes, to_earth_axes


@kernel
def place_foot(I, M, foot, w):
    """Place of a foot in the block's coordinates into w[0:3], the floor's normal into w[3:6], its
    velocity into w[6:9], at the motion in its body's row; returns its gap [m]."""
    row = I[O_FREE] + int(M[foot + FOOT_BODY]) * FREE_WORDS
    m = view(M, row + Y_MOTION, 33)
    place = view(M, foot + FOOT_PLACE, 3)
    turn = m[M_TURN : M_TURN + 9]
    cross(m[M_SPIN : M_SPIN + 3], place, w[9:12])
    to_earth_axes(turn, w[9:12], w[6:9])
    to_earth_axes(turn, place, w[0:3])
    for i in range(3):
        w[i] += m[M_PLACE + i]
        w[6 + i] += m[M_SPEED + i]
    return gap_at(I, M, w[0:3], w[3:6])


@kernel
def lowest_foot(I, M):
    """The least gap of all feet [m]; far above without any."""
    lowest = 1e300
    w = view(M, I[O_PARTS_WORK] + FOOT_SCRATCH, 12)
    for n in range(I[I_FEET]):
        lowest = min(lowest, place_foot(I, M, I[O_FEET] + n * FOOT_WORDS, w))
    return lowest


@kernel
def feet_are_near(I, M, depth, step, lengths):
    """Whether a foot is within so many sizes of its body of the floor, or comes there in a step."""
    w = view(M, I[O_PARTS_WORK] + FOOT_SCRATCH, 12)
    for n in range(I[I_FEET]):
        foot = I[O_FEET] + n * FOOT_WORDS
        gap = place_foot(I, M, foot, w)
        size = M[I[O_FREE] + int(M[foot + FOOT_BODY]) * FREE_WORDS + Y_SIZE]
        if gap < depth + lengths * size + step * max(0.0, -w[8]):
            return True
    return False


@kernel
def add_feet(I, M, body, f, w):
    """Subtract the floor's forces on a body's feet from f (6), body's axes. w: 18 words."""
    depth = M[S_FLOOR_DEPTH]
    turn = view(M, I[O_FREE] + body * FREE_WORDS + Y_MOTION + M_TURN, 9)
    for n in range(I[I_FEET]):
        foot = I[O_FEET] + n * FOOT_WORDS
        if int(M[foot + FOOT_BODY]) != body:
            continue
        gap = place_foot(I, M, foot, w)
        if gap >= depth:
            continue
        load = M[foot + FOOT_LOAD]
        share, _stiffness, _energy = contact_law(gap, depth)
        speed = 0.0
        along = 0.0
        for i in range(3):
            speed += w[6 + i] * w[3 + i]
            w[9 + i] = w[i] - M[foot + FOOT_REST + i]
            along += w[9 + i] * w[3 + i]
        press = load * share * max(0.0, 1.0 - M[S_FLOOR_DAMPING] * speed)
        length = 0.0
        for i in range(3):
            w[9 + i] -= along * w[3 + i]
            length += w[9 + i] ** 2
        length = math.sqrt(length)
        stiffness = M[S_FRICTION] * load / M[S_BRISTLE]
        if stiffness * length > M[S_FRICTION] * press:
            stiffness = M[S_FRICTION] * press / length
        for i in range(3):
            w[12 + i] = press * w[3 + i] - stiffness * w[9 + i]
        to_body_axes(turn, w[12:15], w[0:3])
        cross(view(M, foot + FOOT_PLACE, 3), w[0:3], w[15:18])
        for i in range(3):
            f[i] -= w[i]
            f[3 + i] -= w[15 + i]


@kernel
def settle_feet(I, M):
    """Draw the places of rest after feet that have slipped or left the floor (return mapping)."""
    w = view(M, I[O_PARTS_WORK] + FOOT_SCRATCH, 12)
    for n in range(I[I_FEET]):
        foot = I[O_FEET] + n * FOOT_WORDS
        gap = place_foot(I, M, foot, w)
        share, _stiffness, _energy = contact_law(gap, M[S_FLOOR_DEPTH])
        along = 0.0
        for i in range(3):
            w[6 + i] = w[i] - M[foot + FOOT_REST + i]
            along += w[6 + i] * w[3 + i]
        length = 0.0
        for i in range(3):
            w[6 + i] -= along * w[3 + i]
            length += w[6 + i] ** 2
        length = math.sqrt(length)
        limit = M[S_BRISTLE] * share
        kept = 1.0 if length <= limit else limit / length
        for i in range(3):
            M[foot + FOOT_REST + i] = w[i] - kept * w[6 + i]
