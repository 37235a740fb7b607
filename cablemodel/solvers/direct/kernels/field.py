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
from cablemodel.solvers.shared.strain import strain_and_slope

from .access import own_header, own_scalars
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
    RATES,
    THETA,
    V1,
    V2,
    V3,
    WIDTH,
)

_ROOT = 1e-12
"""Keeps the derivative of |u_n| finite where there is no normal flow [m/s]."""


@kernel
def set_strain(M, out, node, material, tension):
    """Strain and its slope of a node at a tension, into the table of strains (2 words a node)."""
    strain, slope = strain_and_slope(
        M,
        tension,
        material.low,
        material.high,
        int(material.offset),
        int(material.terms),
    )
    M[out + 2 * node] = strain
    M[out + 2 * node + 1] = slope


@kernel
def field_rows(I, M, kind, material, left, h, F, at, mid, dif, both):
    """Residual of the interval from node `left` to the next one, and its derivatives.

    F: residual into F[at : at + WIDTH], a row for each unknown that it determines. mid, dif: word
    offsets of two WIDTH x WIDTH matrices, derivatives by the values at the middle (eq. 38
    included) and by the differences over h; both: offset of two columns, the same by the stretch.
    `set_strain` has been called for both nodes.
    """
    own = own_header(I)
    run = own_scalars(M)
    head = header(I)
    a = own.unknowns + WIDTH * left
    b = a + WIDTH
    p = own.past + RATES * left
    q = p + RATES
    beta = run.beta
    v1 = 0.5 * (M[a + V1] + M[b + V1])
    v2 = 0.5 * (M[a + V2] + M[b + V2])
    v3 = 0.5 * (M[a + V3] + M[b + V3])
    phi = 0.5 * (M[a + PHI] + M[b + PHI])
    theta = 0.5 * (M[a + THETA] + M[b + THETA])
    f3 = 0.5 * (M[a + F3] + M[b + F3])
    v1_t = beta * v1 - 0.5 * (M[p] + M[q])
    v2_t = beta * v2 - 0.5 * (M[p + 1] + M[q + 1])
    v3_t = beta * v3 - 0.5 * (M[p + 2] + M[q + 2])
    phi_t = beta * phi - 0.5 * (M[p + 3] + M[q + 3])
    w1 = beta * theta - 0.5 * (M[p + 4] + M[q + 4])
    strains = own.strains + 2 * left
    strain = 0.5 * (M[strains] + M[strains + 2])
    e = 1.0 + strain
    e_s = (M[strains + 2] - M[strains]) / h
    e_t = beta * strain - 0.5 * (M[p + 5] + M[q + 5])
    c = 0.5 * (M[own.flow + left] + M[own.flow + left + 1])
    phi_s = (M[b + PHI] - M[a + PHI]) / h
    theta_s = (M[b + THETA] - M[a + THETA]) / h
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
        f1 = 0.5 * (M[a + F1] + M[b + F1])
        f2 = 0.5 * (M[a + F2] + M[b + F2])
        f1_s = (M[b + F1] - M[a + F1]) / h
        f2_s = (M[b + F2] - M[a + F2]) / h
        k1 = 0.5 * (M[a + K1] + M[b + K1])
        k2 = 0.5 * (M[a + K2] + M[b + K2])
        k1_s = (M[b + K1] - M[a + K1]) / h
        k2_s = (M[b + K2] - M[a + K2]) / h
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

    water = own.currents + 3 * left
    g1 = 0.5 * (M[water] + M[water + 3])
    g2 = 0.5 * (M[water + 1] + M[water + 4])
    g3 = 0.5 * (M[water + 2] + M[water + 5])
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

    for n in range(BLOCK):
        M[mid + n] = 0.0
        M[dif + n] = 0.0
    for n in range(2 * WIDTH):
        M[both + n] = 0.0
    stretch = both
    stretch_s = both + WIDTH

    # Compatibility.
    F[at + V1] = (M[b + V1] - M[a + V1]) / h + k2 * v3 - k3 * v2 - e * turn2
    F[at + V2] = (M[b + V2] - M[a + V2]) / h + k3 * v1 - k1 * v3 + e * turn1
    F[at + V3] = (M[b + V3] - M[a + V3]) / h + k1 * v2 - k2 * v1 - stretching
    r = mid + WIDTH * V1
    M[dif + WIDTH * V1 + V1] = 1.0
    M[r + V2] = -k3
    M[r + V3] = k2
    M[r + PHI] = -e * beta * s
    M[r + THETA] = -k3_theta * v2 - e * phi_t * ct
    M[r + K2] = v3 - cot * v2 - e * c
    M[stretch + V1] = -turn2
    r = mid + WIDTH * V2
    M[dif + WIDTH * V2 + V2] = 1.0
    M[r + V1] = k3
    M[r + V3] = -k1
    M[r + THETA] = k3_theta * v1 + e * beta
    M[r + K1] = e * c - v3
    M[r + K2] = cot * v1
    M[stretch + V2] = turn1
    r = mid + WIDTH * V3
    M[dif + WIDTH * V3 + V3] = 1.0
    M[r + V1] = -k2
    M[r + V2] = k1
    M[r + K1] = v2
    M[r + K2] = -v1
    M[stretch + V3] = -beta
    M[stretch_s + V3] = -c

    # Forces: rows F1, F2, F3.
    F[at + F1] = f1_s + k2 * f3 - k3 * f2 - mn * a1 + w * cp - d1
    F[at + F2] = f2_s + k3 * f1 - k1 * f3 - mn * a2 - w * sp * ct - d2
    F[at + F3] = (M[b + F3] - M[a + F3]) / h + k1 * f2 - k2 * f1 - m * a3 + w * sp * s - d3
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
    r = mid + WIDTH * F1
    M[dif + WIDTH * F1 + F1] = 1.0
    M[r + F2] = -k3
    M[r + F3] = k2
    M[r + V1] = -mn * beta - d1_1
    M[r + V2] = mn * w3 - d1_2
    M[r + V3] = -mn * w2
    M[r + PHI] = -w * sp - mn * beta * (s * (v3 + c * e) - ct * v2) - d1_1 * u1_phi - d1_2 * u2_phi
    M[r + THETA] = -k3_theta * f2 - mn * phi_t * (ct * (v3 + c * e) + s * v2) - d1_2 * u2_theta
    M[r + K2] = f3 - cot * f2 - mn * c * c * e
    M[stretch + F1] = -mn * c * turn2 - 0.5 * d1 / e
    r = mid + WIDTH * F2
    M[dif + WIDTH * F2 + F2] = 1.0
    M[r + F1] = k3
    M[r + F3] = -k1
    M[r + V1] = -mn * w3 - d1_2
    M[r + V2] = -mn * beta - d2_2
    M[r + V3] = mn * w1
    M[r + PHI] = -w * cp * ct - mn * beta * ct * v1 - d1_2 * u1_phi - d2_2 * u2_phi
    M[r + THETA] = (
        k3_theta * f1 + w * sp * s + mn * (phi_t * s * v1 + beta * (v3 + c * e)) - d2_2 * u2_theta
    )
    M[r + K1] = -f3 + mn * c * c * e
    M[r + K2] = cot * f1
    M[stretch + F2] = mn * c * turn1 - 0.5 * d2 / e
    r = mid + WIDTH * F3
    M[dif + WIDTH * F3 + F3] = 1.0
    M[r + F1] = -k2
    M[r + F2] = k1
    M[r + V1] = m * w2
    M[r + V2] = -m * w1
    M[r + V3] = -m * beta - d3_3
    M[r + PHI] = w * cp * s + m * beta * s * v1 - d3_3 * u3_phi
    M[r + THETA] = w * sp * ct - m * (beta * v2 - phi_t * ct * v1) - d3_3 * u3_theta
    M[r + K1] = f2
    M[r + K2] = -f1
    M[stretch + F3] = -m * c * beta - 0.5 * d3 / e
    M[stretch_s + F3] = -m * c * c

    if head.surge != 0:
        water = own.currents + 3 * (head.capacity + left)
        g1 = 0.5 * (M[water] + M[water + 3])
        g2 = 0.5 * (M[water + 1] + M[water + 4])
        g3 = 0.5 * (M[water + 2] + M[water + 5])
        aside = cp * g1 + sp * g2
        across = cp * g2 - sp * g1
        s2 = ct * across + s * g3
        s3 = ct * g3 - s * across
        along = material.displaced
        push = along + material.added_mass
        F[at + F1] += push * aside
        F[at + F2] += push * s2
        F[at + F3] += along * s3
        M[mid + WIDTH * F1 + PHI] += push * across
        M[mid + WIDTH * F2 + PHI] -= push * ct * aside
        M[mid + WIDTH * F2 + THETA] += push * s3
        M[mid + WIDTH * F3 + PHI] += along * s * aside
        M[mid + WIDTH * F3 + THETA] -= along * s2

    if kind == CABLE:
        # The normal rows of (15) stand for the angles; curvatures are differences of angles.
        for j in range(WIDTH):
            M[mid + WIDTH * PHI + j] = M[mid + WIDTH * F1 + j]
            M[mid + WIDTH * THETA + j] = M[mid + WIDTH * F2 + j]
        M[stretch + PHI] = M[stretch + F1]
        M[stretch + THETA] = M[stretch + F2]
        F[at + PHI] = F[at + F1]
        F[at + THETA] = F[at + F2]
        for i in range(F3 + 1):
            by_k1 = M[mid + WIDTH * i + K1]
            by_k2 = M[mid + WIDTH * i + K2]
            M[dif + WIDTH * i + THETA] += by_k1
            M[dif + WIDTH * i + PHI] += s * by_k2
            M[mid + WIDTH * i + THETA] += phi_s * ct * by_k2
        return

    F[at + PHI] = phi_s * s - k2
    M[dif + WIDTH * PHI + PHI] = s
    M[mid + WIDTH * PHI + THETA] = phi_s * ct
    M[mid + WIDTH * PHI + K2] = -1.0
    F[at + THETA] = theta_s - k1
    M[dif + WIDTH * THETA + THETA] = 1.0
    M[mid + WIDTH * THETA + K1] = -1.0
    F[at + K1] = bending * (k1_s - k2 * k3) - e * f2
    r = mid + WIDTH * K1
    M[dif + WIDTH * K1 + K1] = bending
    M[r + K2] = -2.0 * bending * k3
    M[r + THETA] = -bending * k2 * k3_theta
    M[r + F2] = -e
    M[stretch + K1] = -f2
    F[at + K2] = bending * (k2_s + k1 * k3) + e * f1
    r = mid + WIDTH * K2
    M[dif + WIDTH * K2 + K2] = bending
    M[r + K1] = bending * k3
    M[r + K2] = bending * k1 * cot
    M[r + THETA] = bending * k1 * k3_theta
    M[r + F1] = e
    M[stretch + K2] = f1
