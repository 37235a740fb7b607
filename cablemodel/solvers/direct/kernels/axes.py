"""Leaving the vertical plane, and turning the axes away from the singularity of the angles."""

import math

from cablemodel.solvers.shared.access import header, motion_piece_of, polynomial_at, scalars

from .access import own_header, own_scalars, rigid_body_of, section_of, unknowns_of
from .compile import kernel
from .frame import to_fixed, to_local
from .geometry import last_node
from .layout import RIGID

NEAR_POLE = 0.25
"""sin(theta) below which the axes are turned about the vertical, if that helps."""
_ALIGNED = 1e-12


@kernel
def leave_plane(I, M):
    """Go on in three dimensions where the caller's motion or current leaves the plane."""
    own = own_header(I)
    head = header(I)
    state = scalars(M)
    if own.planar == 0:
        return
    px = state.plane[0]
    py = state.plane[1]
    if head.live == 1:
        law = polynomial_at(motion_piece_of(I, M, 0).data, 0)
        for rate in (law.velocity, law.second, law.third):
            x = rate[0]
            y = rate[1]
            if abs(px * y - py * x) > _ALIGNED * (abs(x) + abs(y)):
                own.planar = 0
    if head.current_kind != 0:
        for flow in (state.live_current.first, state.live_current.last):
            x = flow[0]
            y = flow[1]
            if abs(px * y - py * x) > _ALIGNED * (abs(x) + abs(y)):
                own.planar = 0


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
    own = own_header(I)
    run = own_scalars(M)
    state = scalars(M)
    if own.planar != 0:
        return
    count = last_node(I) + 1
    now = 1.0
    then = 1.0
    for node in range(count):
        y = unknowns_of(I, M, node)
        s = math.sin(y.theta)
        _t1, t2, _t3 = to_fixed(y.phi, y.theta, 0.0, 0.0, 1.0)
        now = min(now, abs(s))
        then = min(then, math.sqrt(max(0.0, 1.0 - t2 * t2)))
    if now > NEAR_POLE or then < 2.0 * now:
        return
    turn_bodies(I, M)
    near = 0.0
    for node in range(count):
        y = unknowns_of(I, M, node)
        phi = y.phi
        theta = y.theta
        new_phi, new_theta = turned(phi, theta, near)
        near = new_phi
        a, b, c = turn_vector(phi, theta, new_phi, new_theta, y.v1, y.v2, y.v3)
        y.v1 = a
        y.v2 = b
        y.v3 = c
        a, b, c = turn_vector(phi, theta, new_phi, new_theta, y.f1, y.f2, y.f3)
        y.f1 = a
        y.f2 = b
        y.f3 = c
        a, b, c = turn_vector(phi, theta, new_phi, new_theta, y.k1, y.k2, 0.0)
        y.k1 = a
        y.k2 = b
        y.phi = new_phi
        y.theta = new_theta
    px = state.plane[0]
    state.plane[0] = state.plane[1]
    state.plane[1] = -px
    # What is kept along e2 and e3: the floor's normal, the tow point and its velocity.
    for vector in range(3):
        turns = run.floor if vector == 2 else run.vessel[3 * vector : 3 * vector + 3]
        kept = turns[1]
        turns[1] = turns[2]
        turns[2] = -kept
    for end in range(2):
        if own.clamped & (1 << end):
            node = 0 if end == 0 else count - 1
            near = unknowns_of(I, M, node).phi
            new_phi, new_theta = turned(run.clamp[2 * end], run.clamp[2 * end + 1], near)
            run.clamp[2 * end] = new_phi
            run.clamp[2 * end + 1] = new_theta
    own.restart = 1
    own.turned += 1


@kernel
def turn_bodies(I, M):
    """The bodies' states in the turned axes, while the nodes still have the old angles.

    A point body keeps its velocity along the fixed axes, a rigid one its velocity and its angular
    velocity along the local axes of its first node.
    """
    own = own_header(I)
    for body in range(own.body_count):
        row = rigid_body_of(I, M, body)
        if row.half == 0.0:
            kept = row.state[1]
            row.state[1] = row.state[2]
            row.state[2] = -kept
    for index in range(own.section_count):
        section = section_of(I, M, index)
        if section.kind != RIGID:
            continue
        rigid = rigid_body_of(I, M, section.body)
        y = unknowns_of(I, M, section.first)
        phi = y.phi
        theta = y.theta
        new_phi, new_theta = turned(phi, theta, 0.0)
        a, b, c = turn_vector(
            phi, theta, new_phi, new_theta, rigid.state[0], rigid.state[1], rigid.state[2]
        )
        rigid.state[0] = a
        rigid.state[1] = b
        rigid.state[2] = c
        a, b, c = turn_vector(phi, theta, new_phi, new_theta, rigid.state[3], rigid.state[4], 0.0)
        rigid.state[3] = a
        rigid.state[4] = b
