"""Bodies (eqs. 28 to 31): point bodies at a joint, and rigid ones of finite length between nodes.

What eq. 38 needs of a body's past stands in its row: of a point its velocity in the fixed axes, of
a rigid body the velocity of its centre of gravity and its angular velocity in the local axes.

Drag is 1/2 rho |u| (CdA_n u_n + CdA_a u_a), as for the finite elements.
"""

import math

from cablemodel.solvers.shared.access import header, scalars

from .access import own_scalars, past_of, unknowns_of, water_of
from .compile import kernel
from .frame import to_fixed, to_local
from .layout import (
    F1,
    F2,
    F3,
    K1,
    K2,
    PHI,
    THETA,
    V1,
    V2,
    V3,
)


@kernel
def point_load(I, M, body, node, out):
    """Force that a point body takes out of the cable, M a - h - W (eq. 28), along e1, e2, e3.

    Its velocity and axis are those of `node`, at its vessel side.
    """
    run = own_scalars(M)
    head = header(I)
    state = scalars(M)
    y = unknowns_of(I, M, node)
    phi = y.phi
    theta = y.theta
    vx, vy, vz = to_fixed(phi, theta, y.v1, y.v2, y.v3)
    body.state[0] = vx
    body.state[1] = vy
    body.state[2] = vz
    ax = run.beta * vx - body.past[0]
    ay = run.beta * vy - body.past[1]
    az = run.beta * vz - body.past[2]
    water = water_of(I, M, node)
    # Along the local axes the third component is the axial one.
    u1, u2, u3 = to_local(phi, theta, vx - water.e1, vy - water.e2, vz - water.e3)
    a1, a2, a3 = to_local(phi, theta, ax, ay, az)
    speed = math.sqrt(u1 * u1 + u2 * u2 + u3 * u3)
    inertia = body.mass + body.added_mass
    axial = body.mass + body.added_mass_axial
    drag = body.drag * speed
    l1 = inertia * a1 + drag * u1
    l2 = inertia * a2 + drag * u2
    l3 = axial * a3 + body.drag_axial * speed * u3
    if head.surge != 0:
        surge = water_of(I, M, head.capacity + node)
        s1, s2, s3 = to_local(phi, theta, surge.e1, surge.e2, surge.e3)
        mass = body.buoyancy / state.gravity
        l1 -= (mass + body.added_mass) * s1
        l2 -= (mass + body.added_mass) * s2
        l3 -= (mass + body.added_mass_axial) * s3
    gx, gy, gz = to_fixed(phi, theta, l1, l2, l3)
    out[0] = gx - body.weight
    out[1] = gy
    out[2] = gz


@kernel
def rigid_rows(I, M, body, left, out):
    """Residual of a rigid body between node `left` and the next one: ten rows.

    Rows of the velocities: v_after = v_before + 2 R1 omega x a3; of the angles: equal; of the
    forces: eq. 28; of the curvatures, which are moments here: eq. 31 with omega x H.
    """
    run = own_scalars(M)
    head = header(I)
    state = scalars(M)
    a = unknowns_of(I, M, left)
    b = unknowns_of(I, M, left + 1)
    past = past_of(I, M, left)
    beta = run.beta
    phi = a.phi
    theta = a.theta
    w1 = beta * theta - past.theta
    phi_t = beta * phi - past.phi
    w2 = phi_t * math.sin(theta)
    w3 = phi_t * math.cos(theta)
    half = body.half
    offset = body.offset
    out[PHI] = b.phi - phi
    out[THETA] = b.theta - theta
    out[V1] = b.v1 - a.v1 - 2.0 * half * w2
    out[V2] = b.v2 - a.v2 + 2.0 * half * w1
    out[V3] = b.v3 - a.v3
    arm = (1.0 + offset) * half
    body.state[0] = a.v1 + arm * w2
    body.state[1] = a.v2 - arm * w1
    body.state[2] = a.v3
    body.state[3] = w1
    body.state[4] = w2
    c1 = body.state[0]
    c2 = body.state[1]
    c3 = body.state[2]
    a1 = beta * c1 - body.past[0] + w2 * c3 - w3 * c2
    a2 = beta * c2 - body.past[1] + w3 * c1 - w1 * c3
    a3 = beta * c3 - body.past[2] + w1 * c2 - w2 * c1
    before = water_of(I, M, left)
    after = water_of(I, M, left + 1)
    g1, g2, g3 = to_local(
        phi,
        theta,
        0.5 * (before.e1 + after.e1),
        0.5 * (before.e2 + after.e2),
        0.5 * (before.e3 + after.e3),
    )
    u1 = c1 - g1
    u2 = c2 - g2
    u3 = c3 - g3
    speed = math.sqrt(u1 * u1 + u2 * u2 + u3 * u3)
    # h: drag, added mass and what accelerated water does; W along e1.
    h1 = -body.drag * speed * u1 - body.added_mass * a1
    h2 = -body.drag * speed * u2 - body.added_mass * a2
    h3 = -body.drag_axial * speed * u3 - body.added_mass_axial * a3
    if head.surge != 0:
        before = water_of(I, M, head.capacity + left)
        after = water_of(I, M, head.capacity + left + 1)
        s1, s2, s3 = to_local(
            phi,
            theta,
            0.5 * (before.e1 + after.e1),
            0.5 * (before.e2 + after.e2),
            0.5 * (before.e3 + after.e3),
        )
        displaced = body.buoyancy / state.gravity
        h1 += (displaced + body.added_mass) * s1
        h2 += (displaced + body.added_mass) * s2
        h3 += (displaced + body.added_mass_axial) * s3
    down1, down2, down3 = to_local(phi, theta, 1.0, 0.0, 0.0)
    weight = body.weight
    mass = body.mass
    out[F1] = b.f1 - a.f1 + h1 + weight * down1 - mass * a1
    out[F2] = b.f2 - a.f2 + h2 + weight * down2 - mass * a2
    out[F3] = b.f3 - a.f3 + h3 + weight * down3 - mass * a3
    up = -body.buoyancy
    l1 = (1.0 + offset) * a.f1 + (1.0 - offset) * b.f1 - offset * (h1 + up * down1)
    l2 = (1.0 + offset) * a.f2 + (1.0 - offset) * b.f2 - offset * (h2 + up * down2)
    inertia = body.inertia
    rate1 = inertia * (beta * w1 - body.past[3] - w3 * w2)
    rate2 = inertia * (beta * w2 - body.past[4] + w3 * w1)
    out[K1] = b.k1 - a.k1 - half * l2 - rate1
    out[K2] = b.k2 - a.k2 + half * l1 - rate2
