"""Conditions at the vessel, at joints and at the far end (sections 4.1 to 4.3 and 6).

Every condition stands in the row of an unknown, so that the planar form of a condition is the rows
of the planar unknowns: of vectors along e1, e2, e3 the rows 1, 3, 2.
"""

import math

from cablemodel.solvers.shared.access import header, word_of
from cablemodel.solvers.shared.strain import strain_and_slope

from .access import material_row, own_header, own_scalars, rigid_body_of, section_at, section_of
from .bodies import point_load
from .compile import kernel
from .frame import to_fixed, to_local
from .geometry import surge_word
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
    RATES,
    RIGID,
    SECTION_WORDS,
    THETA,
    V1,
    V2,
    V3,
    WIDTH,
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
    y = own.unknowns
    v1, v2, v3 = to_local(M[y + PHI], M[y + THETA], run.vessel[3], run.vessel[4], run.vessel[5])
    e = stretch_of(M, material_row(I, M, section.material), M[y + F3])
    out[V1] = M[y + V1] - v1
    out[V2] = M[y + V2] - v2
    out[V3] = M[y + V3] - v3 - M[own.flow] * e
    if own.clamped & 1:
        out[K2] = M[y + PHI] - run.clamp[0]
        out[K1] = M[y + THETA] - run.clamp[1]
    else:
        out[K1] = M[y + K1]
        out[K2] = M[y + K2]


@kernel
def joint_rows(I, M, index, out):
    """Conditions between section `index` and the one before it.

    The velocity of the place and the flow of momentum are continuous, but for what a point body
    takes (eq. 28); then moments and angles, as the two sides can carry them. `paper`: eqs. 40-42.
    """
    own = own_header(I)
    right = section_of(I, M, index)
    left = section_at(M, word_of(M, right) - SECTION_WORDS)
    b = right.first
    a = b - 1
    y = own.unknowns + WIDTH * a
    z = own.unknowns + WIDTH * b
    flexible_left = left.kind == CABLE
    flexible_right = right.kind == CABLE
    c = M[own.flow + b]
    mass = material_row(I, M, right.material).mass
    force_left1 = 0.0 if flexible_left else M[y + F1]
    force_left2 = 0.0 if flexible_left else M[y + F2]
    force_right1 = 0.0 if flexible_right else M[z + F1]
    force_right2 = 0.0 if flexible_right else M[z + F2]
    along_left = 0.0
    along_right = 0.0
    if c != 0.0:
        along_left = c * stretch_of(M, material_row(I, M, left.material), M[y + F3])
        along_right = c * stretch_of(M, material_row(I, M, right.material), M[z + F3])
    vl1, vl2, vl3 = to_fixed(M[y + PHI], M[y + THETA], M[y + V1], M[y + V2], M[y + V3] - along_left)
    vr1, vr2, vr3 = to_fixed(
        M[z + PHI], M[z + THETA], M[z + V1], M[z + V2], M[z + V3] - along_right
    )
    out[V1] = vr1 - vl1
    out[V3] = vr2 - vl2
    out[V2] = vr3 - vl3
    if own.joint == PAPER and flexible_left != flexible_right and right.point < 0:
        if left.kind != RIGID and right.kind != RIGID:
            stiff = y if flexible_right else z
            out[F1] = M[stiff + F1]
            out[F2] = M[stiff + F2]
            out[F3] = M[z + F3] - M[y + F3]
            out[K2] = M[z + PHI] - M[y + PHI]
            out[K1] = M[z + THETA] - M[y + THETA]
            return
    m = c * mass
    fl1, fl2, fl3 = to_fixed(
        M[y + PHI],
        M[y + THETA],
        force_left1 - m * M[y + V1],
        force_left2 - m * M[y + V2],
        M[y + F3] - m * M[y + V3],
    )
    fr1, fr2, fr3 = to_fixed(
        M[z + PHI],
        M[z + THETA],
        force_right1 - m * M[z + V1],
        force_right2 - m * M[z + V2],
        M[z + F3] - m * M[z + V3],
    )
    out[F1] = fr1 - fl1
    out[F3] = fr2 - fl2
    out[F2] = fr3 - fl3
    point = right.point
    if point >= 0:
        load = out[WIDTH : WIDTH + 3]
        point_load(I, M, rigid_body_of(I, M, point), a, load)
        out[F1] -= load[0]
        out[F3] -= load[1]
        out[F2] -= load[2]
    bending_left = bending_of(I, M, left)
    bending_right = bending_of(I, M, right)
    if flexible_left:
        out[K1] = bending_right * M[z + K1]
        out[K2] = bending_right * M[z + K2]
    elif flexible_right:
        out[K1] = bending_left * M[y + K1]
        out[K2] = bending_left * M[y + K2]
    elif right.hinge != 0:
        out[K1] = bending_right * M[z + K1]
        out[K2] = bending_right * M[z + K2]
        out[THETA] = bending_left * M[y + K1]
        out[PHI] = bending_left * M[y + K2]
    else:
        out[PHI] = M[z + PHI] - M[y + PHI]
        out[THETA] = M[z + THETA] - M[y + THETA]
        out[K1] = bending_right * M[z + K1] - bending_left * M[y + K1]
        out[K2] = bending_right * M[z + K2] - bending_left * M[y + K2]


@kernel
def normal_balance(I, M, material, node, out):
    """R1 and R2 of a flexible cable's end, where T = 0: they must vanish for k to be finite."""
    own = own_header(I)
    run = own_scalars(M)
    head = header(I)
    y = own.unknowns + WIDTH * node
    p = own.past + RATES * node
    beta = run.beta
    phi = M[y + PHI]
    theta = M[y + THETA]
    phi_t = beta * phi - M[p + 3]
    w1 = beta * theta - M[p + 4]
    w2 = phi_t * math.sin(theta)
    w3 = phi_t * math.cos(theta)
    water = own.currents + 3 * node
    g1, g2, _g3 = to_local(phi, theta, M[water], M[water + 1], M[water + 2])
    d1, d2, _d3 = to_local(phi, theta, 1.0, 0.0, 0.0)
    u1 = M[y + V1] - g1
    u2 = M[y + V2] - g2
    drag = material.normal * math.sqrt(u1 * u1 + u2 * u2)
    mass = material.mass + material.added_mass
    a1 = beta * M[y + V1] - M[p] + w2 * M[y + V3] - w3 * M[y + V2]
    a2 = beta * M[y + V2] - M[p + 1] + w3 * M[y + V1] - w1 * M[y + V3]
    out[PHI] = mass * a1 - material.weight * d1 + drag * u1
    out[THETA] = mass * a2 - material.weight * d2 + drag * u2
    if head.surge != 0:
        at = surge_word(I, node)
        s1, s2, _s3 = to_local(phi, theta, M[at], M[at + 1], M[at + 2])
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
    y = own.unknowns + WIDTH * node
    flexible = section.kind == CABLE
    end = own.end
    out[K1] = M[y + K1]
    out[K2] = M[y + K2]
    if end == END_ANCHOR:
        out[V1] = M[y + V1]
        out[V2] = M[y + V2]
        out[V3] = M[y + V3]
        if own.clamped & 2:
            out[K2] = M[y + PHI] - run.clamp[2]
            out[K1] = M[y + THETA] - run.clamp[3]
        return
    f1 = 0.0 if flexible else M[y + F1]
    f2 = 0.0 if flexible else M[y + F2]
    # The row of the section after the last one names the body at the far end.
    point = section_at(M, word_of(M, section) + SECTION_WORDS).point
    if end == END_CONTACT or end == END_TOUCHDOWN:
        floor_rows(I, M, y, end, f1, f2, out)
        return
    if point < 0 and flexible:
        out[F3] = M[y + F3]
        normal_balance(I, M, material_row(I, M, section.material), node, out)
        return
    if point < 0:
        out[F1] = f1
        out[F2] = f2
        out[F3] = M[y + F3]
        return
    g1, g2, g3 = to_fixed(M[y + PHI], M[y + THETA], f1, f2, M[y + F3])
    load = out[WIDTH : WIDTH + 3]
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
    phi = M[y + PHI]
    theta = M[y + THETA]
    g1, g2, g3 = to_fixed(phi, theta, f1, f2, M[y + F3])
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
    vx, vy, vz = to_fixed(phi, theta, M[y + V1], M[y + V2], M[y + V3])
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
