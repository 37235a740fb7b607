"""The far end meets the floor: free, in contact, touching down; friction that sticks or slips.

A free end that reaches the floor is carried by it (contact: reaction normal to the floor, no
moment) until its tangent lies in the floor; from then on cable is laid and the end of the mesh is
the touchdown point, which moves along the cable (eq. 34). What has been laid rests; it pulls with
its friction at most. An end in contact slides without friction: its landing is an impact, whose
friction would be another one along a stiff cable.
"""

import math

from .access import material_row, own_header, own_scalars, rates_of, section_of, unknowns_of
from .compile import kernel
from .frame import to_fixed
from .geometry import gap, last_node
from .layout import (
    END_CONTACT,
    END_FREE,
    END_TOUCHDOWN,
)

TOUCHES = 1e-4
"""Of the node spacing: a free end nearer to the floor than this is on it."""
CONTACT_FLAT = 0.01
"""Angle to the floor below which the tangent of an end in contact lies in it [rad]."""
STICKING_SPEED = 2e-3
"""Slip that is slower than this sticks [m/s]."""


@kernel
def end_component(I, M, which, along_normal):
    """Of the end's velocity (0), force (1) or tangent (2): the part along the floor's normal, or
    the size of the part in the floor."""
    run = own_scalars(M)
    y = unknowns_of(I, M, last_node(I))
    if which == 0:
        g1, g2, g3 = to_fixed(y.phi, y.theta, y.v1, y.v2, y.v3)
    elif which == 1:
        g1, g2, g3 = to_fixed(y.phi, y.theta, y.f1, y.f2, y.f3)
    else:
        g1, g2, g3 = to_fixed(y.phi, y.theta, 0.0, 0.0, 1.0)
    normal = g1 * run.floor[0] + g2 * run.floor[1] + g3 * run.floor[2]
    if along_normal != 0:
        return normal
    return math.sqrt(max(0.0, g1 * g1 + g2 * g2 + g3 * g3 - normal * normal))


@kernel
def time_to_landing(I, M, dt):
    """dt, or less where a free end would reach the floor before, or the tangent of an end in
    contact would come to lie in it."""
    own = own_header(I)
    end = own.end
    if own.floor == 0 or (end != END_FREE and end != END_CONTACT):
        return dt
    if end == END_FREE:
        height = gap(I, M)
        speed = -end_component(I, M, 0, 1)
    else:
        height = -end_component(I, M, 2, 1)
        speed = turning(I, M)
    if speed > 0.0 and height > 0.0 and height < speed * dt * 1.5:
        return min(dt, max(height / speed, TOUCHES * dt))
    return dt


@kernel
def turning(I, M):
    """How fast the end's tangent turns towards the floor's normal [1/s]."""
    run = own_scalars(M)
    node = last_node(I)
    y = unknowns_of(I, M, node)
    rates = rates_of(I, M, node)
    g1, g2, g3 = to_fixed(y.phi, y.theta, rates.phi * math.sin(y.theta), -rates.theta, 0.0)
    return g1 * run.floor[0] + g2 * run.floor[1] + g3 * run.floor[2]


@kernel
def change_end(I, M):
    """After a step: what holds the far end from now on."""
    own = own_header(I)
    run = own_scalars(M)
    if own.floor == 0:
        return
    end = own.end
    spacing = run.spacing
    if end == END_FREE:
        if gap(I, M) <= TOUCHES * spacing:
            own.end = END_CONTACT
            own.sticks = 0
            run.friction_force = 0.0
            run.reaction = 0.0
            own.restart = 1
    elif end == END_CONTACT:
        if run.reaction < 0.0:
            own.end = END_FREE
            own.restart = 1
        elif end_component(I, M, 2, 1) >= -CONTACT_FLAT:
            own.end = END_TOUCHDOWN
            run.flow_end = 0.0
            run.laid = 0.0
            own.restart = 1
    if own.end == END_TOUCHDOWN:
        run.reaction = end_component(I, M, 1, 1)
        if run.laid < 0.0:
            # All that was laid is off the floor again.
            M[own.length + last_node(I)] += run.laid
            run.laid = 0.0
            run.flow_end = 0.0
            own.end = END_CONTACT
            own.restart = 1
    if own.end == END_TOUCHDOWN and run.friction > 0.0:
        section = section_of(I, M, own.section_count - 1)
        weight = material_row(I, M, section.material).weight * run.laid + max(0.0, run.reaction)
        run.friction_force = run.friction * max(0.0, weight)
        if own.sticks != 0:
            if end_component(I, M, 1, 0) > run.friction_force:
                own.sticks = 0
        elif end_component(I, M, 0, 0) < STICKING_SPEED:
            own.sticks = 1
