"""Free bodies on the sea floor: places of a body that touch it, its feet.

The law is that of the cable's contact (contact.py): each foot bears its part of the body's weight
at rest where it just touches, and friction holds it by a bristle.
"""

import math

from .access import foot_of, free_body_of, header, scalars
from .compile import kernel, view
from .contact import contact_law
from .floor_surface import gap_at
from .layout import (
    FOOT_SCRATCH,
)
from .rotation import cross, to_body_axes, to_earth_axes


@kernel
def place_foot(I, M, foot, w):
    """Place of a foot in the block's coordinates into w[0:3], the floor's normal into w[3:6], its
    velocity into w[6:9], at the motion in its body's row; returns its gap [m]."""
    row = free_body_of(I, M, int(foot.body))
    m = row.motion
    place = foot.place
    turn = m.turn
    cross(m.spin, place, w[9:12])
    to_earth_axes(turn, w[9:12], w[6:9])
    to_earth_axes(turn, place, w[0:3])
    for i in range(3):
        w[i] += m.reference[i]
        w[6 + i] += m.reference[3 + i]
    return gap_at(I, M, w[0:3], w[3:6])


@kernel
def lowest_foot(I, M):
    """The least gap of all feet [m]; far above without any."""
    head = header(I)
    lowest = 1e300
    w = view(M, head.parts_work + FOOT_SCRATCH, 12)
    for n in range(head.foot_count):
        lowest = min(lowest, place_foot(I, M, foot_of(I, M, n), w))
    return lowest


@kernel
def feet_are_near(I, M, depth, step, lengths):
    """Whether a foot is within so many sizes of its body of the floor, or comes there in a step."""
    head = header(I)
    w = view(M, head.parts_work + FOOT_SCRATCH, 12)
    for n in range(head.foot_count):
        foot = foot_of(I, M, n)
        gap = place_foot(I, M, foot, w)
        size = free_body_of(I, M, int(foot.body)).size
        if gap < depth + lengths * size + step * max(0.0, -w[8]):
            return True
    return False


@kernel
def add_feet(I, M, body, f, w):
    """Subtract the floor's forces on a body's feet from f (6), body's axes. w: 18 words."""
    head = header(I)
    state = scalars(M)
    depth = state.floor_depth
    m = free_body_of(I, M, body).motion
    turn = m.turn
    for n in range(head.foot_count):
        foot = foot_of(I, M, n)
        if int(foot.body) != body:
            continue
        gap = place_foot(I, M, foot, w)
        if gap >= depth:
            continue
        load = foot.load
        share, _stiffness, _energy = contact_law(gap, depth)
        speed = 0.0
        along = 0.0
        for i in range(3):
            speed += w[6 + i] * w[3 + i]
            w[9 + i] = w[i] - foot.rest[i]
            along += w[9 + i] * w[3 + i]
        press = load * share * max(0.0, 1.0 - state.floor_damping * speed)
        length = 0.0
        for i in range(3):
            w[9 + i] -= along * w[3 + i]
            length += w[9 + i] ** 2
        length = math.sqrt(length)
        stiffness = foot.friction * load / state.bristle
        if stiffness * length > foot.friction * press:
            stiffness = foot.friction * press / length
        for i in range(3):
            w[12 + i] = press * w[3 + i] - stiffness * w[9 + i]
        to_body_axes(turn, w[12:15], w[0:3])
        cross(foot.place, w[0:3], w[15:18])
        for i in range(3):
            f[i] -= w[i]
            f[3 + i] -= w[15 + i]


@kernel
def settle_feet(I, M):
    """Draw the places of rest after feet that have slipped or left the floor (return mapping)."""
    head = header(I)
    state = scalars(M)
    w = view(M, head.parts_work + FOOT_SCRATCH, 12)
    for n in range(head.foot_count):
        foot = foot_of(I, M, n)
        gap = place_foot(I, M, foot, w)
        share, _stiffness, _energy = contact_law(gap, state.floor_depth)
        along = 0.0
        for i in range(3):
            w[6 + i] = w[i] - foot.rest[i]
            along += w[6 + i] * w[3 + i]
        length = 0.0
        for i in range(3):
            w[6 + i] -= along * w[3 + i]
            length += w[6 + i] ** 2
        length = math.sqrt(length)
        limit = state.bristle * share
        kept = 1.0 if length <= limit else limit / length
        for i in range(3):
            foot.rest[i] = w[i] - kept * w[6 + i]
