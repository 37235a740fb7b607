"""The far end meets the floor: free, in contact, touching down; friction that sticks or slips.

A free end that reaches the floor is carried by it (contact: reaction normal to the floor, no
moment) until its tangent lies in the floor; from then on cable is laid and the end of the mesh is
the touchdown point, which moves along the cable (eq. 34). What has been laid rests; it pulls with
its friction at most. An end in contact slides without friction: its landing is a blow, whose
friction would be another one along a stiff cable.
"""

import math

from .compile import kernel
from .frame import to_fixed
from .geometry import gap, last_node
from .joints import material_of
from .layout import (
    D_END,
    D_FLOOR,
    D_RESTART,
    D_SECTIONS,
    D_STICKS,
    END_CONTACT,
    END_FREE,
    END_TOUCHDOWN,
    F1,
    F2,
    F3,
    O_LENGTH,
    O_RATE,
    O_SECTION,
    O_Y,
    PHI,
    RATES,
    SECTION_WORDS,
    T_WEIGHT,
    THETA,
    V1,
    V2,
    V3,
    WIDTH,
    X_FLOOR,
    X_FLOW_END,
    X_FRICTION,
    X_FRICTION_FORCE,
    X_LAID,
    X_REACTION,
    X_SPACING,
)

TOUCHES = 1e-4
"""Of the node spacing: a free end nearer to the floor than this is on it."""
FLAT = 0.01
"""Angle to the floor below which the tangent of an end in contact lies in it [rad]."""
STOPS = 2e-3
"""Slip that is slower than this sticks [m/s]."""


@kernel
def end_component(I, M, which, along_normal):
    """Of the end's velocity (0), force (1) or tangent (2): the part along the floor's normal, or
    the size of the part in the floor."""
    y = I[O_Y] + WIDTH * last_node(I)
    if which == 0:
        g1, g2, g3 = to_fixed(M[y + PHI], M[y + THETA], M[y + V1], M[y + V2], M[y + V3])
    elif which == 1:
        g1, g2, g3 = to_fixed(M[y + PHI], M[y + THETA], M[y + F1], M[y + F2], M[y + F3])
    else:
        g1, g2, g3 = to_fixed(M[y + PHI], M[y + THETA], 0.0, 0.0, 1.0)
    normal = g1 * M[X_FLOOR] + g2 * M[X_FLOOR + 1] + g3 * M[X_FLOOR + 2]
    if along_normal != 0:
        return normal
    return math.sqrt(max(0.0, g1 * g1 + g2 * g2 + g3 * g3 - normal * normal))


@kernel
def time_to_landing(I, M, dt):
    """dt, or less where a free end would reach the floor before, or the tangent of an end in
    contact would come to lie in it."""
    end = I[D_END]
    if I[D_FLOOR] == 0 or (end != END_FREE and end != END_CONTACT):
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
    node = last_node(I)
    y = I[O_Y] + WIDTH * node
    phi_t = M[I[O_RATE] + RATES * node + 3]
    theta_t = M[I[O_RATE] + RATES * node + 4]
    g1, g2, g3 = to_fixed(M[y + PHI], M[y + THETA], phi_t * math.sin(M[y + THETA]), -theta_t, 0.0)
    return g1 * M[X_FLOOR] + g2 * M[X_FLOOR + 1] + g3 * M[X_FLOOR + 2]


@kernel
def change_end(I, M):
    """After a step: what holds the far end from now on."""
    if I[D_FLOOR] == 0:
        return
    end = I[D_END]
    spacing = M[X_SPACING]
    if end == END_FREE:
        if gap(I, M) <= TOUCHES * spacing:
            I[D_END] = END_CONTACT
            I[D_STICKS] = 0
            M[X_FRICTION_FORCE] = 0.0
            M[X_REACTION] = 0.0
            I[D_RESTART] = 1
    elif end == END_CONTACT:
        if M[X_REACTION] < 0.0:
            I[D_END] = END_FREE
            I[D_RESTART] = 1
        elif end_component(I, M, 2, 1) >= -FLAT:
            I[D_END] = END_TOUCHDOWN
            M[X_FLOW_END] = 0.0
            M[X_LAID] = 0.0
            I[D_RESTART] = 1
    if I[D_END] == END_TOUCHDOWN:
        M[X_REACTION] = end_component(I, M, 1, 1)
        if M[X_LAID] < 0.0:
            # All that was laid is off the floor again.
            M[I[O_LENGTH] + last_node(I)] += M[X_LAID]
            M[X_LAID] = 0.0
            M[X_FLOW_END] = 0.0
            I[D_END] = END_CONTACT
            I[D_RESTART] = 1
    if I[D_END] == END_TOUCHDOWN and M[X_FRICTION] > 0.0:
        section = I[O_SECTION] + SECTION_WORDS * (I[D_SECTIONS] - 1)
        weight = M[material_of(I, section) + T_WEIGHT] * M[X_LAID] + max(0.0, M[X_REACTION])
        M[X_FRICTION_FORCE] = M[X_FRICTION] * max(0.0, weight)
        if I[D_STICKS] != 0:
            if end_component(I, M, 1, 0) > M[X_FRICTION_FORCE]:
                I[D_STICKS] = 0
        elif end_component(I, M, 0, 0) < STOPS:
            I[D_STICKS] = 1
