"""Conditions at the vessel, at joints and at the far end (sections 4.1 to 4.3 and 6).

Every condition stands in the row of an unknown, so that the planar form of a condition is the rows
of the planar unknowns: of vectors along e1, e2, e3 the rows 1, 3, 2.
"""

import math

from cablemodel.solvers.shared.access import header, vector
from cablemodel.solvers.shared.strain import strain_and_slope

from .access import (
    material_row,
    own_header,
    own_scalars,
    past_of,
    rigid_body_of,
    section_of,
    unknowns_of,
    water_of,
)
from .bodies import point_load
from .compile import kernel
from .frame import to_fixed, to_local
from .layout import (
    CABLE,
    END_ANCHOR,
    END_CONTACT,
    END_TOUCHDOWN,
    F1,
    F2,
    F3,
    K1,
    K2,
    PAPER,
    PHI,
    RIGID,
    THETA,
    V1,
    V2,
    V3,
)

CREEP = 1e-3
"""Slip at which friction has half of its force [m/s]: Coulomb's law without its jump."""


@kernel
def stretch_of(M, material, tension):
    """1 + strain at a tension."""
    strain, _slope = strain_and_slope(
        M,
        tension,
        material.low,
        material.high,
        int(material.offset),
        int(material.terms),
    )
    return 1.0 + strain


@kernel
def bending_of(I, M, section):
    """What turns a section's curvature into a moment: EI; 1 for a rigid body."""
    if section.kind == RIGID:
        return 1.0
    return material_row(I, M, section.material).bending


@kernel
def vessel_rows(I, M, out):
    """Eq. 32 with pay-out, V = Lambda V_vessel + v_p e a3, and eq. 33 or a clamp."""
    own = own_header(I)
    run = own_scalars(M)
    section = section_of(I, M, 0)
    y = unknowns_of(I, M, 0)
    v1, v2, v3 = to_local(y.phi, y.theta, run.vessel[3], run.vessel[4], run.vessel[5])
    e = stretch_of(M, material_row(I, M, section.material), y.f3)
    out[V1] = y.v1 - v1
    out[V2] = y.v2 - v2
    out[V3] = y.v3 - v3 - M[own.flow] * e
    if own.clamped & 1:
        out[K2] = y.phi - run.clamp[0]
        out[K1] = y.theta - run.clamp[1]
    else:
        out[K1] = y.k1
        out[K2] = y.k2


@kernel
def joint_rows(I, M, index, out):
    """Conditions between section `index` and the one before it.

    The velocity of the place and the flow of momentum are continuous, but for what a point body
    takes (eq. 28); then moments and angles, as the two sides can carry them. `paper`: eqs. 40-42.
    """
    own = own_header(I)
    right = section_of(I, M, index)
    left = section_of(I, M, index - 1)
    b = right.first
    a = b - 1
    y = unknowns_of(I, M, a)
    z = unknowns_of(I, M, b)
    flexible_left = left.kind == CABLE
    flexible_right = right.kind == CABLE
    c = M[own.flow + b]
    mass = material_row(I, M, right.material).mass
    force_left1 = 0.0 if flexible_left else y.f1
    force_left2 = 0.0 if flexible_left else y.f2
    force_right1 = 0.0 if flexible_right else z.f1
    force_right2 = 0.0 if flexible_right else z.f2
    along_left = 0.0
    along_right = 0.0
    if c != 0.0:
        along_left = c * stretch_of(M, material_row(I, M, left.material), y.f3)
        along_right = c * stretch_of(M, material_row(I, M, right.material), z.f3)
    vl1, vl2, vl3 = to_fixed(y.phi, y.theta, y.v1, y.v2, y.v3 - along_left)
    vr1, vr2, vr3 = to_fixed(z.phi, z.theta, z.v1, z.v2, z.v3 - along_right)
    out[V1] = vr1 - vl1
    out[V3] = vr2 - vl2
    out[V2] = vr3 - vl3
    if own.joint == PAPER and flexible_left != flexible_right and right.point < 0:
        if left.kind != RIGID and right.kind != RIGID:
            stiff = y if flexible_right else z
            out[F1] = stiff.f1
            out[F2] = stiff.f2
            out[F3] = z.f3 - y.f3
            out[K2] = z.phi - y.phi
            out[K1] = z.theta - y.theta
            return
    m = c * mass
    fl1, fl2, fl3 = to_fixed(
        y.phi,
        y.theta,
        force_left1 - m * y.v1,
        force_left2 - m * y.v2,
        y.f3 - m * y.v3,
    )
    fr1, fr2, fr3 = to_fixed(
        z.phi,
        z.theta,
        force_right1 - m * z.v1,
        force_right2 - m * z.v2,
        z.f3 - m * z.v3,
    )
    out[F1] = fr1 - fl1
    out[F3] = fr2 - fl2
    out[F2] = fr3 - fl3
    point = right.point
    if point >= 0:
        load = vector()
        point_load(I, M, rigid_body_of(I, M, point), a, load)
        out[F1] -= load[0]
        out[F3] -= load[1]
        out[F2] -= load[2]
    bending_left = bending_of(I, M, left)
    bending_right = bending_of(I, M, right)
    if flexible_left:
        out[K1] = bending_right * z.k1
        out[K2] = bending_right * z.k2
    elif flexible_right:
        out[K1] = bending_left * y.k1
        out[K2] = bending_left * y.k2
    elif right.hinge != 0:
        out[K1] = bending_right * z.k1
        out[K2] = bending_right * z.k2
        out[THETA] = bending_left * y.k1
        out[PHI] = bending_left * y.k2
    else:
        out[PHI] = z.phi - y.phi
        out[THETA] = z.theta - y.theta
        out[K1] = bending_right * z.k1 - bending_left * y.k1
        out[K2] = bending_right * z.k2 - bending_left * y.k2


@kernel
def normal_balance(I, M, material, node, out):
    """R1 and R2 of a flexible cable's end, where T = 0: they must vanish for k to be finite."""
    run = own_scalars(M)
    head = header(I)
    y = unknowns_of(I, M, node)
    past = past_of(I, M, node)
    beta = run.beta
    phi = y.phi
    theta = y.theta
    phi_t = beta * phi - past.phi
    w1 = beta * theta - past.theta
    w2 = phi_t * math.sin(theta)
    w3 = phi_t * math.cos(theta)
    water = water_of(I, M, node)
    g1, g2, _g3 = to_local(phi, theta, water.e1, water.e2, water.e3)
    d1, d2, _d3 = to_local(phi, theta, 1.0, 0.0, 0.0)
    u1 = y.v1 - g1
    u2 = y.v2 - g2
    drag = material.normal * math.sqrt(u1 * u1 + u2 * u2)
    mass = material.mass + material.added_mass
    a1 = beta * y.v1 - past.v1 + w2 * y.v3 - w3 * y.v2
    a2 = beta * y.v2 - past.v2 + w3 * y.v1 - w1 * y.v3
    out[PHI] = mass * a1 - material.weight * d1 + drag * u1
    out[THETA] = mass * a2 - material.weight * d2 + drag * u2
    if head.surge != 0:
        surge = water_of(I, M, head.capacity + node)
        s1, s2, _s3 = to_local(phi, theta, surge.e1, surge.e2, surge.e3)
        push = material.displaced + material.added_mass
        out[PHI] -= push * s1
        out[THETA] -= push * s2


@kernel
def end_rows(I, M, out):
    """The far end: free, with a point body, anchored, on the floor, or where cable is laid."""
    own = own_header(I)
    run = own_scalars(M)
    last = own.section_count - 1
    section = section_of(I, M, last)
    node = section.first + section.count - 1
    y = unknowns_of(I, M, node)
    flexible = section.kind == CABLE
    end = own.end
    out[K1] = y.k1
    out[K2] = y.k2
    if end == END_ANCHOR:
        out[V1] = y.v1
        out[V2] = y.v2
        out[V3] = y.v3
        if own.clamped & 2:
            out[K2] = y.phi - run.clamp[2]
            out[K1] = y.theta - run.clamp[3]
        return
    f1 = 0.0 if flexible else y.f1
    f2 = 0.0 if flexible else y.f2
    # The row of the section after the last one names the body at the far end.
    point = section_of(I, M, last + 1).point
    if end == END_CONTACT or end == END_TOUCHDOWN:
        floor_rows(I, M, y, end, f1, f2, out)
        return
    if point < 0 and flexible:
        out[F3] = y.f3
        normal_balance(I, M, material_row(I, M, section.material), node, out)
        return
    if point < 0:
        out[F1] = f1
        out[F2] = f2
        out[F3] = y.f3
        return
    g1, g2, g3 = to_fixed(y.phi, y.theta, f1, f2, y.f3)
    load = vector()
    point_load(I, M, rigid_body_of(I, M, point), node, load)
    # Force after the body is zero: f_before + (M a - h - W) = 0.
    if flexible:
        out[PHI] = g1 + load[0]
        out[THETA] = g3 + load[2]
    else:
        out[F1] = g1 + load[0]
        out[F2] = g3 + load[2]
    out[F3] = g2 + load[1]


@kernel
def floor_rows(I, M, y, end, f1, f2, out):
    """The end on the floor: the force along it by friction, or held; the tangent or the reaction.

    The floor pushes the line's end with the reaction along its normal n (up) and friction in its
    plane: f = reaction n + friction, f being the force of what lies beyond on the cable. At the
    touchdown point the tangent lies in the floor and the curvature vanishes (section 4.3).
    """
    own = own_header(I)
    run = own_scalars(M)
    n1 = run.floor[0]
    n2 = run.floor[1]
    n3 = run.floor[2]
    phi = y.phi
    theta = y.theta
    g1, g2, g3 = to_fixed(phi, theta, f1, f2, y.f3)
    t1, t2, t3 = to_fixed(phi, theta, 0.0, 0.0, 1.0)
    across = t1 * n1 + t2 * n2 + t3 * n3
    # Directions in the floor: along the tangent's projection, and b = n x that.
    p1 = t1 - across * n1
    p2 = t2 - across * n2
    p3 = t3 - across * n3
    size = math.sqrt(p1 * p1 + p2 * p2 + p3 * p3) + 1e-300
    p1 /= size
    p2 /= size
    p3 /= size
    b1 = n2 * p3 - n3 * p2
    b2 = n3 * p1 - n1 * p3
    b3 = n1 * p2 - n2 * p1
    vx, vy, vz = to_fixed(phi, theta, y.v1, y.v2, y.v3)
    along = vx * p1 + vy * p2 + vz * p3
    aside = vx * b1 + vy * b2 + vz * b3
    if own.sticks != 0:
        out[F3] = along
        out[F2] = aside
    else:
        speed = math.sqrt(along * along + aside * aside) + CREEP
        friction = run.friction_force
        out[F3] = g1 * p1 + g2 * p2 + g3 * p3 + friction * along / speed
        out[F2] = g1 * b1 + g2 * b2 + g3 * b3 + friction * aside / speed
    if end == END_TOUCHDOWN:
        out[F1] = across
    else:
        out[F1] = g1 * n1 + g2 * n2 + g3 * n3 - run.reaction
