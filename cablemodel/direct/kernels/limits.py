"""What a state must be to be taken over, beyond solving the equations.

Where the formulation ends: slack in a flexible section, the singular angle, a drifting end, a line
that touches the floor before its end. And what a step that was too long brings about, whose
equations may well have a solution: an interval used up by the cable that flows out of it (of
negative length, it let Newton find an equilibrium with a fold that is none), and an end that has
gone through the floor. Steps that end there are halved.
"""

import math

from cablemodel.kernels.access import header
from cablemodel.kernels.layout import OK

from .compile import kernel
from .frame import from_earth
from .geometry import gap, last_node
from .layout import (
    BODY_ON_FLOOR,
    CABLE,
    D_END,
    D_FLOOR,
    D_SECTIONS,
    DRIFT,
    END_ANCHOR,
    END_CONTACT,
    END_FREE,
    F3,
    N_COUNT,
    N_FIRST,
    N_KIND,
    O_LENGTH,
    O_OLD_LENGTH,
    O_PLACE,
    O_SECTION,
    O_Y,
    OVERSHOT,
    RIGID,
    SECTION_WORDS,
    SINGULAR_ANGLE,
    SLACK,
    THETA,
    USED_UP,
    WIDTH,
    X_ANCHOR,
    X_DRIFT,
    X_FLOOR,
    X_LOWEST,
    X_SPACING,
)
from .touchdown import end_component

AT_POLE = 0.02
"""sin(theta) below which the equations are taken as singular."""
LEFT_OVER = 0.1
"""Of an interval: what a step must leave of it."""
DEEP = 0.05
"""Of the node spacing: how far a node may be below the floor."""
OVERSHOOT = 0.05
"""By how much the tangent of an end in contact may have turned upwards out of the floor [rad]."""


@kernel
def check_state(I, M):
    """OK, or why the state that has been found is none: the status, with the node at fault."""
    head = header(I)
    for index in range(I[D_SECTIONS]):
        section = I[O_SECTION] + SECTION_WORDS * index
        first = I[section + N_FIRST]
        for node in range(first, first + I[section + N_COUNT]):
            y = I[O_Y] + WIDTH * node
            if abs(math.sin(M[y + THETA])) < AT_POLE:
                I[head.failed] = node
                return SINGULAR_ANGLE
            if I[section + N_KIND] == CABLE and M[y + F3] < -M[X_LOWEST]:
                I[head.failed] = node
                return SLACK
            if node == first or I[section + N_KIND] == RIGID:
                continue
            if not M[I[O_LENGTH] + node] > LEFT_OVER * M[I[O_OLD_LENGTH] + node]:
                I[head.failed] = node
                return USED_UP
    if I[D_END] == END_ANCHOR:
        node = last_node(I)
        total = 0.0
        for i in range(3):
            total += (M[I[O_PLACE] + 3 * node + i] - M[X_ANCHOR + i]) ** 2
        if total > M[X_DRIFT] ** 2:
            I[head.failed] = node
            return DRIFT
    return OK


@kernel
def check_floor(I, M):
    """No node below the floor, and no end that should have been caught there. Returns a status."""
    head = header(I)
    if I[D_FLOOR] == 0:
        return OK
    deep = DEEP * M[X_SPACING]
    last = last_node(I)
    I[head.failed] = last
    if I[D_END] == END_FREE and gap(I, M) < -deep:
        return OVERSHOT
    if I[D_END] == END_CONTACT and end_component(I, M, 2, 1) > OVERSHOOT:
        return OVERSHOT
    for node in range(last):
        at = I[O_PLACE] + 3 * node
        g1, g2, g3 = from_earth(M, M[at], M[at + 1], M[at + 2])
        height = g1 * M[X_FLOOR] + g2 * M[X_FLOOR + 1] + g3 * M[X_FLOOR + 2] - M[X_FLOOR + 3]
        if height < -deep:
            I[head.failed] = node
            return BODY_ON_FLOOR
    return OK
