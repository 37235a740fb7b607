"""The field equations (eq. 27, corrected) of one interval by the implicit midpoint rule.

Unknowns at a node: material velocity V = v + c e a3 (c: cable that flows past the node, the
paper's v_p at the vessel), angles, force f and curvature k, all along the local axes. With them,
and Omega = omega + c k the material rate of rotation,

    V' + k x V = (e_t + c e') a3 + e Omega x a3                                     (12, 13)
    f' + k x f = (m + ma) A_n + m A_t a3 - w Lambda e1 + D - P                      (15, 22, 23)
    A          = V_t + omega x V + c (V' + k x V)                                   (16)
    phi' sin theta = k2,  theta' = k1                                               (9)
    EI (k1' - k2 k3) = e f2,  EI (k2' + k1 k3) = -e f1,  k3 = k2 cot theta          (19, 20, 26)

P is rho A (1 + Ca) on the normal part and rho A along the cable, times the acceleration of water
whose current changes in time. Written with V the terms in v_p of eq. 16 are all in c (V' + k x V),
and c may differ from node to node where the mesh moves along the cable. A flexible cable has f =
T a3 and k from its angles: its two normal rows of (15) replace (9), and the moment rows go.

The intermediate values are at the middle of the interval, and so is every rate.
"""

import math

from cablemodel.solvers.shared.access import header
from cablemodel.solvers.shared.compile import view
from cablemodel.solvers.shared.strain import strain_and_slope

from .access import own_header, own_scalars, past_of, strain_of, unknowns_of, water_of
from .compile import kernel
from .layout import (
    BLOCK,
    CABLE,
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
    WIDTH,
)

_ROOT = 1e-12
"""Keeps the derivative of |u_n| finite where there is no normal flow [m/s]."""


@kernel
def set_strain(M, at, material, tension):
    """Strain and its slope at a tension, at a node: a NodeStrain."""
    at.strain, at.slope = strain_and_slope(
        M,
        tension,
        material.low,
        material.high,
        int(material.offset),
        int(material.terms),
    )


@kernel
def field_rows(I, M, kind, material, left, h, found):
    """Residual of the interval from node `left` to the next one, and its derivatives.

    found: an AssemblyWork. Into its `residual` come rows, one for each unknown that it determines;
    their derivatives by the values at the middle (eq. 38 included) and by the differences over h
    into two matrices by rows; the same by the stretch into two columns. `set_strain` has been
    called for both nodes.
    """
    own = own_header(I)
    run = own_scalars(M)
    head = header(I)
    a = unknowns_of(I, M, left)
    b = unknowns_of(I, M, left + 1)
    p = past_of(I, M, left)
    q = past_of(I, M, left + 1)
    beta = run.beta
    v1 = 0.5 * (a.v1 + b.v1)
    v2 = 0.5 * (a.v2 + b.v2)
    v3 = 0.5 * (a.v3 + b.v3)
    phi = 0.5 * (a.phi + b.phi)
    theta = 0.5 * (a.theta + b.theta)
    f3 = 0.5 * (a.f3 + b.f3)
    v1_t = beta * v1 - 0.5 * (p.v1 + q.v1)
    v2_t = beta * v2 - 0.5 * (p.v2 + q.v2)
    v3_t = beta * v3 - 0.5 * (p.v3 + q.v3)
    phi_t = beta * phi - 0.5 * (p.phi + q.phi)
    w1 = beta * theta - 0.5 * (p.theta + q.theta)
    before = strain_of(I, M, left).strain
    after = strain_of(I, M, left + 1).strain
    strain = 0.5 * (before + after)
    e = 1.0 + strain
    e_s = (after - before) / h
    e_t = beta * strain - 0.5 * (p.strain + q.strain)
    c = 0.5 * (M[own.flow + left] + M[own.flow + left + 1])
    phi_s = (b.phi - a.phi) / h
    theta_s = (b.theta - a.theta) / h
    sp = math.sin(phi)
    cp = math.cos(phi)
    s = math.sin(theta)
    ct = math.cos(theta)
    cot = ct / s
    if kind == CABLE:
        f1 = 0.0
        f2 = 0.0
        f1_s = 0.0
        f2_s = 0.0
        k1 = theta_s
        k2 = phi_s * s
        k1_s = 0.0
        k2_s = 0.0
    else:
        f1 = 0.5 * (a.f1 + b.f1)
        f2 = 0.5 * (a.f2 + b.f2)
        f1_s = (b.f1 - a.f1) / h
        f2_s = (b.f2 - a.f2) / h
        k1 = 0.5 * (a.k1 + b.k1)
        k2 = 0.5 * (a.k2 + b.k2)
        k1_s = (b.k1 - a.k1) / h
        k2_s = (b.k2 - a.k2) / h
    k3 = k2 * cot
    k3_theta = -k2 / (s * s)
    w2 = phi_t * s
    w3 = phi_t * ct
    turn1 = w1 + c * k1
    turn2 = w2 + c * k2
    stretching = e_t + c * e_s

    m = material.mass
    mn = m + material.added_mass
    w = material.weight
    bending = material.bending
    a1 = v1_t + w2 * v3 - w3 * v2 + c * e * turn2
    a2 = v2_t + w3 * v1 - w1 * v3 - c * e * turn1
    a3 = v3_t + w1 * v2 - w2 * v1 + c * stretching

    upper = water_of(I, M, left)
    lower = water_of(I, M, left + 1)
    g1 = 0.5 * (upper.e1 + lower.e1)
    g2 = 0.5 * (upper.e2 + lower.e2)
    g3 = 0.5 * (upper.e3 + lower.e3)
    water2 = -sp * ct * g1 + cp * ct * g2 + s * g3
    water3 = sp * s * g1 - cp * s * g2 + ct * g3
    u1 = v1 - cp * g1 - sp * g2
    u2 = v2 - water2
    u3 = v3 - water3
    root = math.sqrt(e)
    cn = root * material.normal
    cd = root * material.tangential
    un = math.sqrt(u1 * u1 + u2 * u2)
    d1 = cn * un * u1
    d2 = cn * un * u2
    d3 = cd * abs(u3) * u3

    F = found.residual
    mid = found.by_middle
    dif = found.by_difference
    stretch = found.by_stretch
    stretch_s = found.by_stretch_slope
    for n in range(BLOCK):
        mid[n] = 0.0
        dif[n] = 0.0
    for n in range(WIDTH):
        stretch[n] = 0.0
        stretch_s[n] = 0.0

    # Compatibility.
    F[V1] = (b.v1 - a.v1) / h + k2 * v3 - k3 * v2 - e * turn2
    F[V2] = (b.v2 - a.v2) / h + k3 * v1 - k1 * v3 + e * turn1
    F[V3] = (b.v3 - a.v3) / h + k1 * v2 - k2 * v1 - stretching
    row = view(mid, WIDTH * V1, WIDTH)
    dif[WIDTH * V1 + V1] = 1.0
    row[V2] = -k3
    row[V3] = k2
    row[PHI] = -e * beta * s
    row[THETA] = -k3_theta * v2 - e * phi_t * ct
    row[K2] = v3 - cot * v2 - e * c
    stretch[V1] = -turn2
    row = view(mid, WIDTH * V2, WIDTH)
    dif[WIDTH * V2 + V2] = 1.0
    row[V1] = k3
    row[V3] = -k1
    row[THETA] = k3_theta * v1 + e * beta
    row[K1] = e * c - v3
    row[K2] = cot * v1
    stretch[V2] = turn1
    row = view(mid, WIDTH * V3, WIDTH)
    dif[WIDTH * V3 + V3] = 1.0
    row[V1] = -k2
    row[V2] = k1
    row[K1] = v2
    row[K2] = -v1
    stretch[V3] = -beta
    stretch_s[V3] = -c

    # Forces: rows F1, F2, F3.
    F[F1] = f1_s + k2 * f3 - k3 * f2 - mn * a1 + w * cp - d1
    F[F2] = f2_s + k3 * f1 - k1 * f3 - mn * a2 - w * sp * ct - d2
    F[F3] = (b.f3 - a.f3) / h + k1 * f2 - k2 * f1 - m * a3 + w * sp * s - d3
    safe = un + _ROOT
    d1_1 = cn * (un + u1 * u1 / safe)
    d1_2 = cn * u1 * u2 / safe
    d2_2 = cn * (un + u2 * u2 / safe)
    d3_3 = 2.0 * cd * abs(u3)
    u1_phi = sp * g1 - cp * g2
    u2_phi = ct * (cp * g1 + sp * g2)
    u2_theta = -water3
    u3_phi = -s * (cp * g1 + sp * g2)
    u3_theta = water2
    row = view(mid, WIDTH * F1, WIDTH)
    dif[WIDTH * F1 + F1] = 1.0
    row[F2] = -k3
    row[F3] = k2
    row[V1] = -mn * beta - d1_1
    row[V2] = mn * w3 - d1_2
    row[V3] = -mn * w2
    row[PHI] = -w * sp - mn * beta * (s * (v3 + c * e) - ct * v2) - d1_1 * u1_phi - d1_2 * u2_phi
    row[THETA] = -k3_theta * f2 - mn * phi_t * (ct * (v3 + c * e) + s * v2) - d1_2 * u2_theta
    row[K2] = f3 - cot * f2 - mn * c * c * e
    stretch[F1] = -mn * c * turn2 - 0.5 * d1 / e
    row = view(mid, WIDTH * F2, WIDTH)
    dif[WIDTH * F2 + F2] = 1.0
    row[F1] = k3
    row[F3] = -k1
    row[V1] = -mn * w3 - d1_2
    row[V2] = -mn * beta - d2_2
    row[V3] = mn * w1
    row[PHI] = -w * cp * ct - mn * beta * ct * v1 - d1_2 * u1_phi - d2_2 * u2_phi
    row[THETA] = (
        k3_theta * f1 + w * sp * s + mn * (phi_t * s * v1 + beta * (v3 + c * e)) - d2_2 * u2_theta
    )
    row[K1] = -f3 + mn * c * c * e
    row[K2] = cot * f1
    stretch[F2] = mn * c * turn1 - 0.5 * d2 / e
    row = view(mid, WIDTH * F3, WIDTH)
    dif[WIDTH * F3 + F3] = 1.0
    row[F1] = -k2
    row[F2] = k1
    row[V1] = m * w2
    row[V2] = -m * w1
    row[V3] = -m * beta - d3_3
    row[PHI] = w * cp * s + m * beta * s * v1 - d3_3 * u3_phi
    row[THETA] = w * sp * ct - m * (beta * v2 - phi_t * ct * v1) - d3_3 * u3_theta
    row[K1] = f2
    row[K2] = -f1
    stretch[F3] = -m * c * beta - 0.5 * d3 / e
    stretch_s[F3] = -m * c * c

    if head.surge != 0:
        upper = water_of(I, M, head.capacity + left)
        lower = water_of(I, M, head.capacity + left + 1)
        g1 = 0.5 * (upper.e1 + lower.e1)
        g2 = 0.5 * (upper.e2 + lower.e2)
        g3 = 0.5 * (upper.e3 + lower.e3)
        aside = cp * g1 + sp * g2
        across = cp * g2 - sp * g1
        s2 = ct * across + s * g3
        s3 = ct * g3 - s * across
        along = material.displaced
        push = along + material.added_mass
        F[F1] += push * aside
        F[F2] += push * s2
        F[F3] += along * s3
        mid[WIDTH * F1 + PHI] += push * across
        mid[WIDTH * F2 + PHI] -= push * ct * aside
        mid[WIDTH * F2 + THETA] += push * s3
        mid[WIDTH * F3 + PHI] += along * s * aside
        mid[WIDTH * F3 + THETA] -= along * s2

    if kind == CABLE:
        # The normal rows of (15) stand for the angles; curvatures are differences of angles.
        for j in range(WIDTH):
            mid[WIDTH * PHI + j] = mid[WIDTH * F1 + j]
            mid[WIDTH * THETA + j] = mid[WIDTH * F2 + j]
        stretch[PHI] = stretch[F1]
        stretch[THETA] = stretch[F2]
        F[PHI] = F[F1]
        F[THETA] = F[F2]
        for i in range(F3 + 1):
            by_k1 = mid[WIDTH * i + K1]
            by_k2 = mid[WIDTH * i + K2]
            dif[WIDTH * i + THETA] += by_k1
            dif[WIDTH * i + PHI] += s * by_k2
            mid[WIDTH * i + THETA] += phi_s * ct * by_k2
        return

    F[PHI] = phi_s * s - k2
    dif[WIDTH * PHI + PHI] = s
    mid[WIDTH * PHI + THETA] = phi_s * ct
    mid[WIDTH * PHI + K2] = -1.0
    F[THETA] = theta_s - k1
    dif[WIDTH * THETA + THETA] = 1.0
    mid[WIDTH * THETA + K1] = -1.0
    F[K1] = bending * (k1_s - k2 * k3) - e * f2
    row = view(mid, WIDTH * K1, WIDTH)
    dif[WIDTH * K1 + K1] = bending
    row[K2] = -2.0 * bending * k3
    row[THETA] = -bending * k2 * k3_theta
    row[F2] = -e
    stretch[K1] = -f2
    F[K2] = bending * (k2_s + k1 * k3) + e * f1
    row = view(mid, WIDTH * K2, WIDTH)
    dif[WIDTH * K2 + K2] = bending
    row[K1] = bending * k3
    row[K2] = bending * k1 * cot
    row[THETA] = bending * k1 * k3_theta
    row[F1] = e
    stretch[K2] = f1
