"""Leaving the vertical plane, and turning the axes away from the singularity of the angles."""

import math

from cablemodel.kernels.access import header, scalars
from cablemodel.kernels.layout import (
    P_DATA,
)

from .compile import kernel
from .frame import to_fixed, to_local
from .geometry import last_node
from .layout import (
    B_HALF,
    B_STATE,
    BODY_WORDS,
    D_BODIES,
    D_CLAMPED,
    D_PLANAR,
    D_RESTART,
    D_SECTIONS,
    D_TURNED,
    F1,
    F2,
    F3,
    K1,
    K2,
    N_BODY,
    N_FIRST,
    N_KIND,
    O_BODY,
    O_SECTION,
    O_Y,
    PHI,
    RIGID,
    SECTION_WORDS,
    THETA,
    V1,
    V2,
    V3,
    WIDTH,
    X_CLAMP,
    X_FLOOR,
    X_VESSEL,
)

NEAR_POLE = 0.25
"""sin(theta) below which the axes are turned about the vertical, if that helps."""
_ALIGNED = 1e-12


@kernel
def leave_plane(I, M):
    """Go on in three dimensions where the caller's motion or current leaves the plane."""
    head = header(I)
    state = scalars(M)
    if I[D_PLANAR] == 0:
        return
    px = state.plane[0]
    py = state.plane[1]
    if head.live == 1:
        for k in range(1, 4):
            at = head.pieces + P_DATA + 3 * k
            if abs(px * M[at + 1] - py * M[at]) > _ALIGNED * (abs(M[at]) + abs(M[at + 1])):
                I[D_PLANAR] = 0
    if head.current_kind != 0:
        for k in range(2):
            x = state.live_current[2 + 3 * k]
            y = state.live_current[3 + 3 * k]
            if abs(px * y - py * x) > _ALIGNED * (abs(x) + abs(y)):
                I[D_PLANAR] = 0


@kernel
def turned(phi, theta, near):
    """Euler angles after a quarter turn of the axes, e2' = e3 and e3' = -e2, phi' near `near`."""
    t1, t2, t3 = to_fixed(phi, theta, 0.0, 0.0, 1.0)
    new_phi = math.atan2(t1, -t3)
    new_phi += 2.0 * math.pi * math.floor((near - new_phi) / (2.0 * math.pi) + 0.5)
    return new_phi, math.acos(max(-1.0, min(1.0, -t2)))


@kernel
def turn_vector(phi, theta, new_phi, new_theta, x1, x2, x3):
    """Local components of the same vector before and after the turn of the axes."""
    g1, g2, g3 = to_fixed(phi, theta, x1, x2, x3)
    return to_local(new_phi, new_theta, g1, g3, -g2)


@kernel
def turn_axes(I, M):
    """A quarter turn of e2 and e3 about the vertical where the cable comes near to e3.

    The paper's own way out of its singular angle (after eq. 10). The rates of eq. 38 are not
    carried over: the next step is backward Euler.
    """
    state = scalars(M)
    if I[D_PLANAR] != 0:
        return
    count = last_node(I) + 1
    now = 1.0
    then = 1.0
    for node in range(count):
        y = I[O_Y] + WIDTH * node
        s = math.sin(M[y + THETA])
        _t1, t2, _t3 = to_fixed(M[y + PHI], M[y + THETA], 0.0, 0.0, 1.0)
        now = min(now, abs(s))
        then = min(then, math.sqrt(max(0.0, 1.0 - t2 * t2)))
    if now > NEAR_POLE or then < 2.0 * now:
        return
    turn_bodies(I, M)
    near = 0.0
    for node in range(count):
        y = I[O_Y] + WIDTH * node
        phi = M[y + PHI]
        theta = M[y + THETA]
        new_phi, new_theta = turned(phi, theta, near)
        near = new_phi
        a, b, c = turn_vector(phi, theta, new_phi, new_theta, M[y + V1], M[y + V2], M[y + V3])
        M[y + V1] = a
        M[y + V2] = b
        M[y + V3] = c
        a, b, c = turn_vector(phi, theta, new_phi, new_theta, M[y + F1], M[y + F2], M[y + F3])
        M[y + F1] = a
        M[y + F2] = b
        M[y + F3] = c
        a, b, c = turn_vector(phi, theta, new_phi, new_theta, M[y + K1], M[y + K2], 0.0)
        M[y + K1] = a
        M[y + K2] = b
        M[y + PHI] = new_phi
        M[y + THETA] = new_theta
    px = state.plane[0]
    state.plane[0] = state.plane[1]
    state.plane[1] = -px
    # What is kept along e2 and e3: the floor's normal, the tow point and its velocity.
    for vector in range(3):
        at = X_FLOOR if vector == 2 else X_VESSEL + 3 * vector
        kept = M[at + 1]
        M[at + 1] = M[at + 2]
        M[at + 2] = -kept
    for end in range(2):
        if I[D_CLAMPED] & (1 << end):
            node = 0 if end == 0 else count - 1
            at = X_CLAMP + 2 * end
            near = M[I[O_Y] + WIDTH * node + PHI]
            new_phi, new_theta = turned(M[at], M[at + 1], near)
            M[at] = new_phi
            M[at + 1] = new_theta
    I[D_RESTART] = 1
    I[D_TURNED] += 1


@kernel
def turn_bodies(I, M):
    """The bodies' states in the turned axes, while the nodes still have the old angles.

    A point body keeps its velocity along the fixed axes, a rigid one its velocity and its angular
    velocity along the local axes of its first node.
    """
    for body in range(I[D_BODIES]):
        row = I[O_BODY] + BODY_WORDS * body
        if M[row + B_HALF] == 0.0:
            kept = M[row + B_STATE + 1]
            M[row + B_STATE + 1] = M[row + B_STATE + 2]
            M[row + B_STATE + 2] = -kept
    for index in range(I[D_SECTIONS]):
        section = I[O_SECTION] + SECTION_WORDS * index
        if I[section + N_KIND] != RIGID:
            continue
        at = I[O_BODY] + BODY_WORDS * I[section + N_BODY] + B_STATE
        y = I[O_Y] + WIDTH * I[section + N_FIRST]
        phi = M[y + PHI]
        theta = M[y + THETA]
        new_phi, new_theta = turned(phi, theta, 0.0)
        a, b, c = turn_vector(phi, theta, new_phi, new_theta, M[at], M[at + 1], M[at + 2])
        M[at] = a
        M[at + 1] = b
        M[at + 2] = c
        a, b, c = turn_vector(phi, theta, new_phi, new_theta, M[at + 3], M[at + 4], 0.0)
        M[at + 3] = a
        M[at + 4] = b
