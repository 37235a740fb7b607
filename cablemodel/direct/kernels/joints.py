"""Conditions at the vessel, at joints and at the far end (sections 4.1 to 4.3 and 6).

Every condition stands in the row of an unknown, so that the planar form of a condition is the rows
of the planar unknowns: of vectors along e1, e2, e3 the rows 1, 3, 2.
"""

import math

from cablemodel.kernels.access import header
from cablemodel.kernels.strain import strain_and_slope

from .bodies import point_load
from .compile import kernel
from .frame import to_fixed, to_local
from .geometry import surge_word
from .layout import (
    BODY_WORDS,
    CABLE,
    D_CLAMPED,
    D_END,
    D_JOINT,
    D_SECTIONS,
    D_STICKS,
    END_ANCHOR,
    END_CONTACT,
    END_TOUCHDOWN,
    F1,
    F2,
    F3,
    K1,
    K2,
    MATERIAL_WORDS,
    N_COUNT,
    N_FIRST,
    N_HINGE,
    N_KIND,
    N_MATERIAL,
    N_POINT,
    O_BODY,
    O_CURRENTS,
    O_FLOW,
    O_MATERIAL,
    O_PAST,
    O_SECTION,
    O_Y,
    PAPER,
    PHI,
    RATES,
    RIGID,
    SECTION_WORDS,
    T_ADDED,
    T_BENDING,
    T_DISPLACED,
    T_HIGH,
    T_LOW,
    T_MASS,
    T_NORMAL,
    T_OFFSET,
    T_TERMS,
    T_WEIGHT,
    THETA,
    V1,
    V2,
    V3,
    WIDTH,
    X_BETA,
    X_CLAMP,
    X_FLOOR,
    X_FRICTION_FORCE,
    X_REACTION,
    X_VESSEL,
)

CREEP = 1e-3
"""Slip at which friction has half of its force [m/s]: Coulomb's law without its jump."""


@kernel
def material_of(I, section):
    """Word offset of the material row of a section (its word offset)."""
    return I[O_MATERIAL] + MATERIAL_WORDS * I[section + N_MATERIAL]


@kernel
def stretch_of(M, material, tension):
    """1 + strain at a tension."""
    strain, _slope = strain_and_slope(
        M,
        tension,
        M[material + T_LOW],
        M[material + T_HIGH],
        int(M[material + T_OFFSET]),
        int(M[material + T_TERMS]),
    )
    return 1.0 + strain


@kernel
def bending_of(I, M, section):
    """What turns a section's curvature into a moment: EI; 1 for a rigid body."""
    if I[section + N_KIND] == RIGID:
        return 1.0
    return M[material_of(I, section) + T_BENDING]


@kernel
def vessel_rows(I, M, out):
    """Eq. 32 with pay-out, V = Lambda V_vessel + v_p e a3, and eq. 33 or a clamp."""
    section = I[O_SECTION]
    y = I[O_Y]
    v1, v2, v3 = to_local(
        M[y + PHI], M[y + THETA], M[X_VESSEL + 3], M[X_VESSEL + 4], M[X_VESSEL + 5]
    )
    e = stretch_of(M, material_of(I, section), M[y + F3])
    out[V1] = M[y + V1] - v1
    out[V2] = M[y + V2] - v2
    out[V3] = M[y + V3] - v3 - M[I[O_FLOW]] * e
    if I[D_CLAMPED] & 1:
        out[K2] = M[y + PHI] - M[X_CLAMP]
        out[K1] = M[y + THETA] - M[X_CLAMP + 1]
    else:
        out[K1] = M[y + K1]
        out[K2] = M[y + K2]


@kernel
def joint_rows(I, M, index, out):
    """Conditions between section `index` and the one before it.

    The velocity of the place and the flow of momentum are continuous, but for what a point body
    takes (eq. 28); then moments and angles, as the two sides can carry them. `paper`: eqs. 40-42.
    """
    right = I[O_SECTION] + SECTION_WORDS * index
    left = right - SECTION_WORDS
    b = I[right + N_FIRST]
    a = b - 1
    y = I[O_Y] + WIDTH * a
    z = I[O_Y] + WIDTH * b
    flexible_left = I[left + N_KIND] == CABLE
    flexible_right = I[right + N_KIND] == CABLE
    c = M[I[O_FLOW] + b]
    mass = M[material_of(I, right) + T_MASS]
    force_left1 = 0.0 if flexible_left else M[y + F1]
    force_left2 = 0.0 if flexible_left else M[y + F2]
    force_right1 = 0.0 if flexible_right else M[z + F1]
    force_right2 = 0.0 if flexible_right else M[z + F2]
    along_left = 0.0
    along_right = 0.0
    if c != 0.0:
        along_left = c * stretch_of(M, material_of(I, left), M[y + F3])
        along_right = c * stretch_of(M, material_of(I, right), M[z + F3])
    vl1, vl2, vl3 = to_fixed(M[y + PHI], M[y + THETA], M[y + V1], M[y + V2], M[y + V3] - along_left)
    vr1, vr2, vr3 = to_fixed(
        M[z + PHI], M[z + THETA], M[z + V1], M[z + V2], M[z + V3] - along_right
    )
    out[V1] = vr1 - vl1
    out[V3] = vr2 - vl2
    out[V2] = vr3 - vl3
    if I[D_JOINT] == PAPER and flexible_left != flexible_right and I[right + N_POINT] < 0:
        if I[left + N_KIND] != RIGID and I[right + N_KIND] != RIGID:
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
    point = I[right + N_POINT]
    if point >= 0:
        load = out[WIDTH : WIDTH + 3]
        point_load(I, M, I[O_BODY] + BODY_WORDS * point, a, load)
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
    elif I[right + N_HINGE] != 0:
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
    head = header(I)
    y = I[O_Y] + WIDTH * node
    p = I[O_PAST] + RATES * node
    beta = M[X_BETA]
    phi = M[y + PHI]
    theta = M[y + THETA]
    phi_t = beta * phi - M[p + 3]
    w1 = beta * theta - M[p + 4]
    w2 = phi_t * math.sin(theta)
    w3 = phi_t * math.cos(theta)
    water = I[O_CURRENTS] + 3 * node
    g1, g2, _g3 = to_local(phi, theta, M[water], M[water + 1], M[water + 2])
    d1, d2, _d3 = to_local(phi, theta, 1.0, 0.0, 0.0)
    u1 = M[y + V1] - g1
    u2 = M[y + V2] - g2
    drag = M[material + T_NORMAL] * math.sqrt(u1 * u1 + u2 * u2)
    mass = M[material + T_MASS] + M[material + T_ADDED]
    a1 = beta * M[y + V1] - M[p] + w2 * M[y + V3] - w3 * M[y + V2]
    a2 = beta * M[y + V2] - M[p + 1] + w3 * M[y + V1] - w1 * M[y + V3]
    out[PHI] = mass * a1 - M[material + T_WEIGHT] * d1 + drag * u1
    out[THETA] = mass * a2 - M[material + T_WEIGHT] * d2 + drag * u2
    if head.surge != 0:
        at = surge_word(I, node)
        s1, s2, _s3 = to_local(phi, theta, M[at], M[at + 1], M[at + 2])
        push = M[material + T_DISPLACED] + M[material + T_ADDED]
        out[PHI] -= push * s1
        out[THETA] -= push * s2


@kernel
def end_rows(I, M, out):
    """The far end: free, with a point body, anchored, on the floor, or where cable is laid."""
    last = I[D_SECTIONS] - 1
    section = I[O_SECTION] + SECTION_WORDS * last
    node = I[section + N_FIRST] + I[section + N_COUNT] - 1
    y = I[O_Y] + WIDTH * node
    flexible = I[section + N_KIND] == CABLE
    end = I[D_END]
    out[K1] = M[y + K1]
    out[K2] = M[y + K2]
    if end == END_ANCHOR:
        out[V1] = M[y + V1]
        out[V2] = M[y + V2]
        out[V3] = M[y + V3]
        if I[D_CLAMPED] & 2:
            out[K2] = M[y + PHI] - M[X_CLAMP + 2]
            out[K1] = M[y + THETA] - M[X_CLAMP + 3]
        return
    f1 = 0.0 if flexible else M[y + F1]
    f2 = 0.0 if flexible else M[y + F2]
    # The row of the section after the last one names the body at the far end.
    point = I[section + SECTION_WORDS + N_POINT]
    if end == END_CONTACT or end == END_TOUCHDOWN:
        floor_rows(I, M, y, end, f1, f2, out)
        return
    if point < 0 and flexible:
        out[F3] = M[y + F3]
        normal_balance(I, M, material_of(I, section), node, out)
        return
    if point < 0:
        out[F1] = f1
        out[F2] = f2
        out[F3] = M[y + F3]
        return
    g1, g2, g3 = to_fixed(M[y + PHI], M[y + THETA], f1, f2, M[y + F3])
    load = out[WIDTH : WIDTH + 3]
    point_load(I, M, I[O_BODY] + BODY_WORDS * point, node, load)
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
    n1 = M[X_FLOOR]
    n2 = M[X_FLOOR + 1]
    n3 = M[X_FLOOR + 2]
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
    if I[D_STICKS] != 0:
        out[F3] = along
        out[F2] = aside
    else:
        speed = math.sqrt(along * along + aside * aside) + CREEP
        friction = M[X_FRICTION_FORCE]
        out[F3] = g1 * p1 + g2 * p2 + g3 * p3 + friction * along / speed
        out[F2] = g1 * b1 + g2 * b2 + g3 * b3 + friction * aside / speed
    if end == END_TOUCHDOWN:
        out[F1] = across
    else:
        out[F1] = g1 * n1 + g2 * n2 + g3 * n3 - M[X_REACTION]
