"""What a state must be to be taken over, beyond solving the equations.

Where the formulation ends: slack in a flexible section, the singular angle, a drifting end, a line
that touches the floor before its end. And what a step that was too long brings about, whose
equations may well have a solution: an interval used up by the cable that flows out of it (of
negative length, it let Newton find an equilibrium with a fold that is none), and an end that has
gone through the floor. Steps that end there are halved.
"""

import math

from cablemodel.solvers.shared.access import header
from cablemodel.solvers.shared.layout import OK

from .access import own_header, own_scalars, place_of, section_of, unknowns_of
from .compile import kernel
from .frame import from_earth
from .geometry import gap, last_node
from .layout import (
    BODY_ON_FLOOR,
    CABLE,
    DRIFT,
    END_ANCHOR,
    END_CONTACT,
    END_FREE,
    OVERSHOT,
    RIGID,
    SINGULAR_ANGLE,
    SLACK,
    USED_UP,
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
    own = own_header(I)
    run = own_scalars(M)
    head = header(I)
    for index in range(own.section_count):
        section = section_of(I, M, index)
        first = section.first
        for node in range(first, first + section.count):
            y = unknowns_of(I, M, node)
            if abs(math.sin(y.theta)) < AT_POLE:
                I[head.failed] = node
                return SINGULAR_ANGLE
            if section.kind == CABLE and y.f3 < -run.lowest:
                I[head.failed] = node
                return SLACK
            if node == first or section.kind == RIGID:
                continue
            if not M[own.length + node] > LEFT_OVER * M[own.old_length + node]:
                I[head.failed] = node
                return USED_UP
    if own.end == END_ANCHOR:
        node = last_node(I)
        place = place_of(I, M, node)
        total = (place.x - run.anchor[0]) ** 2
        total += (place.y - run.anchor[1]) ** 2
        total += (place.z - run.anchor[2]) ** 2
        if total > run.drift**2:
            I[head.failed] = node
            return DRIFT
    return OK


@kernel
def check_floor(I, M):
    """No node below the floor, and no end that should have been caught there. Returns a status."""
    own = own_header(I)
    run = own_scalars(M)
    head = header(I)
    if own.floor == 0:
        return OK
    deep = DEEP * run.spacing
    last = last_node(I)
    I[head.failed] = last
    if own.end == END_FREE and gap(I, M) < -deep:
        return OVERSHOT
    if own.end == END_CONTACT and end_component(I, M, 2, 1) > OVERSHOOT:
        return OVERSHOT
    for node in range(last):
        place = place_of(I, M, node)
        g1, g2, g3 = from_earth(M, place.x, place.y, place.z)
        height = g1 * run.floor[0] + g2 * run.floor[1] + g3 * run.floor[2] - run.floor[3]
        if height < -deep:
            I[head.failed] = node
            return BODY_ON_FLOOR
    return OK
