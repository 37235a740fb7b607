"""Bodies (eqs. 28 to 31): point bodies at a joint, and rigid ones of finite length between nodes.

What eq. 38 needs of a body's past stands in its row: of a point its velocity in the fixed axes, of
a rigid body the velocity of its centre of gravity and its angular velocity in the local axes.

Drag is 1/2 rho |u| (CdA_n u_n + CdA_a u_a), as for the finite elements.
"""

import math

from cablemodel.solvers.shared.access import header, scalars

from .access import own_header, own_scalars
from .compile import kernel
from .frame import to_fixed, to_local
from .geometry import surge_word
from .layout import (
    F1,
    F2,
    F3,
    K1,
    K2,
    PHI,
    RATES,
    THETA,
    V1,
    V2,
    V3,
    WIDTH,
)


@kernel
def point_load(I, M, body, node, out):
    """Force that a point body takes out of the cable, M a - h - W (eq. 28), along e1, e2, e3.

    Its velocity and axis are those of `node`, at its vessel side.
    """
    own = own_header(I)
    run = own_scalars(M)
    head = header(I)
    state = scalars(M)
    y = own.unknowns + WIDTH * node
    phi = M[y + PHI]
    theta = M[y + THETA]
    vx, vy, vz = to_fixed(phi, theta, M[y + V1], M[y + V2], M[y + V3])
    body.state[0] = vx
    body.state[1] = vy
    body.state[2] = vz
    ax = run.beta * vx - body.past[0]
    ay = run.beta * vy - body.past[1]
    az = run.beta * vz - body.past[2]
    water = own.currents + 3 * node
    # Along the local axes the third component is the axial one.
    u1, u2, u3 = to_local(phi, theta, vx - M[water], vy - M[water + 1], vz - M[water + 2])
    a1, a2, a3 = to_local(phi, theta, ax, ay, az)
    speed = math.sqrt(u1 * u1 + u2 * u2 + u3 * u3)
    inertia = body.mass + body.added_mass
    axial = body.mass + body.added_mass_axial
    drag = body.drag * speed
    l1 = inertia * a1 + drag * u1
    l2 = inertia * a2 + drag * u2
    l3 = axial * a3 + body.drag_axial * speed * u3
    if head.surge != 0:
        at = surge_word(I, node)
        s1, s2, s3 = to_local(phi, theta, M[at], M[at + 1], M[at + 2])
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
    own = own_header(I)
    run = own_scalars(M)
    head = header(I)
    state = scalars(M)
    a = own.unknowns + WIDTH * left
    b = a + WIDTH
    past = own.past + RATES * left
    beta = run.beta
    phi = M[a + PHI]
    theta = M[a + THETA]
    w1 = beta * theta - M[past + 4]
    phi_t = beta * phi - M[past + 3]
    w2 = phi_t * math.sin(theta)
    w3 = phi_t * math.cos(theta)
    half = body.half
    offset = body.offset
    out[PHI] = M[b + PHI] - phi
    out[THETA] = M[b + THETA] - theta
    out[V1] = M[b + V1] - M[a + V1] - 2.0 * half * w2
    out[V2] = M[b + V2] - M[a + V2] + 2.0 * half * w1
    out[V3] = M[b + V3] - M[a + V3]
    arm = (1.0 + offset) * half
    body.state[0] = M[a + V1] + arm * w2
    body.state[1] = M[a + V2] - arm * w1
    body.state[2] = M[a + V3]
    body.state[3] = w1
    body.state[4] = w2
    c1 = body.state[0]
    c2 = body.state[1]
    c3 = body.state[2]
    a1 = beta * c1 - body.past[0] + w2 * c3 - w3 * c2
    a2 = beta * c2 - body.past[1] + w3 * c1 - w1 * c3
    a3 = beta * c3 - body.past[2] + w1 * c2 - w2 * c1
    water = own.currents + 3 * left
    g1, g2, g3 = to_local(
        phi,
        theta,
        0.5 * (M[water] + M[water + 3]),
        0.5 * (M[water + 1] + M[water + 4]),
        0.5 * (M[water + 2] + M[water + 5]),
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
        before = surge_word(I, left)
        s1, s2, s3 = to_local(
            phi,
            theta,
            0.5 * (M[before] + M[before + 3]),
            0.5 * (M[before + 1] + M[before + 4]),
            0.5 * (M[before + 2] + M[before + 5]),
        )
        displaced = body.buoyancy / state.gravity
        h1 += (displaced + body.added_mass) * s1
        h2 += (displaced + body.added_mass) * s2
        h3 += (displaced + body.added_mass_axial) * s3
    down1, down2, down3 = to_local(phi, theta, 1.0, 0.0, 0.0)
    weight = body.weight
    mass = body.mass
    out[F1] = M[b + F1] - M[a + F1] + h1 + weight * down1 - mass * a1
    out[F2] = M[b + F2] - M[a + F2] + h2 + weight * down2 - mass * a2
    out[F3] = M[b + F3] - M[a + F3] + h3 + weight * down3 - mass * a3
    up = -body.buoyancy
    l1 = (1.0 + offset) * M[a + F1] + (1.0 - offset) * M[b + F1] - offset * (h1 + up * down1)
    l2 = (1.0 + offset) * M[a + F2] + (1.0 - offset) * M[b + F2] - offset * (h2 + up * down2)
    inertia = body.inertia
    rate1 = inertia * (beta * w1 - body.past[3] - w3 * w2)
    rate2 = inertia * (beta * w2 - body.past[4] + w3 * w1)
    out[K1] = M[b + K1] - M[a + K1] - half * l2 - rate1
    out[K2] = M[b + K2] - M[a + K2] + half * l1 - rate2
