"""Mixed cubic Hermite element in three dimensions: residual and Jacobian of a whole line.

Unknowns of a node: r, d = r' (6 words). Unknowns of an element: tension T0 + T1 P1(x). Weak form

    int (m a . dr + T t . dr' + bending - loads . dr) ds = 0,   int (|r'| - 1 - strain(T)) dT ds = 0

with t = r'/|r'|. Bending energy EI/2 |t'|^2 per unit of unstretched length, so that the internal
force along t is exactly T. Loads: Sun & Leonard 1998, eqs. 22 and 23, with u the velocity of the
water relative to the cable. In comments g = |r'|, y = r'', P = I - t t^T, k = P y / g, b = t . y.
"""

import math

from .compile import inlined, kernel, view
from .environment import current_at
from .layout import (
    E_ADDED,
    E_BENDING,
    E_COMPLIANCE,
    E_DRAG_NORMAL,
    E_DRAG_TANGENTIAL,
    E_LENGTH,
    E_MASS,
    E_STABILISATION,
    E_STRAIN_OFFSET,
    E_STRAIN_TERMS,
    E_TENSION_HIGH,
    E_TENSION_LOW,
    E_WEIGHT,
    EDGE_WORDS,
    I_DEPTHS,
    I_DRAG,
    I_NODES,
    I_PAYOUT,
    O_COMPLIANCE,
    O_DIAGONAL,
    O_EDGE,
    O_END_FORCE,
    O_GAUSS,
    O_GRADIENT,
    O_JOINT,
    O_LOWER,
    O_MOTION,
    O_PARENT,
    O_TOP,
    O_UPPER,
)
from .strain import strain_and_slope
from .tables import (
    D0,
    D1,
    D2,
    D3,
    E0,
    E1,
    E2,
    E3,
    H0,
    H1,
    H2,
    H3,
    LOAD,
    MASS,
    MASS_PAIRS,
    P1,
    P2,
    S00,
    S01,
    S11,
    S12,
    S21,
    S22,
    WD,
    WE,
    WEIGHT,
    WEIGHT_P1,
    WEIGHT_P2,
    WH,
)

TINY = 1e-30  # keeps |u_n| from dividing by zero

# Slots of four words in the Gauss workspace.
CX, CY, CZ = 0, 4, 8  # water velocity
G, TX, TY, TZ = 12, 16, 20, 24
FX, FY, FZ = 28, 32, 36  # conjugate to r
PX, PY, PZ = 40, 44, 48  # conjugate to r'
QX, QY, QZ = 52, 56, 60  # conjugate to r''
AX = 64  # element vector: 12 words
JACOBIAN = 80  # 6 groups of 9 slots of 4: A00, A01, A11, A12, A21, A22
BLOCK = JACOBIAN + 216  # 16 words, one pair of components


@inlined
def element_current(I, M, W, x0, x1, h):
    """Water velocity at the Gauss points of an element whose heights are x0.., when it varies."""
    motion = I[O_MOTION] + 9
    z = view(M, motion, 3)
    for g in range(3):
        height = x0[2] * H0[g] + h * x0[5] * H1[g] + x1[2] * H2[g] + h * x1[5] * H3[g]
        current_at(I, M, height, z)
        W[CX + g] = z[0]
        W[CY + g] = z[1]
        W[CZ + g] = z[2]


@inlined
def geometry(W, x0, x1, h):
    """Stretch g and tangent t at the Gauss points."""
    ih = 1.0 / h
    ax = x0[0] * ih
    ay = x0[1] * ih
    az = x0[2] * ih
    bx = x0[3]
    by = x0[4]
    bz = x0[5]
    cx = x1[0] * ih
    cy = x1[1] * ih
    cz = x1[2] * ih
    dx = x1[3]
    dy = x1[4]
    dz = x1[5]
    for g in range(4):
        px = ax * D0[g] + bx * D1[g] + cx * D2[g] + dx * D3[g]
        py = ay * D0[g] + by * D1[g] + cy * D2[g] + dy * D3[g]
        pz = az * D0[g] + bz * D1[g] + cz * D2[g] + dz * D3[g]
        s = math.sqrt(px * px + py * py + pz * pz)
        i = 1.0 / s
        W[G + g] = s
        W[TX + g] = px * i
        W[TY + g] = py * i
        W[TZ + g] = pz * i


@inlined
def axial_forces(W, t0, t1, stabilisation):
    """Forces T t at the Gauss points, with the stabilising mode along P2."""
    e2 = 0.0
    for g in range(3):
        e2 += WEIGHT_P2[g] * (W[G + g] - 1.0)
    t2 = 5.0 * stabilisation * e2
    for g in range(4):
        tension = t0 + t1 * P1[g] + t2 * P2[g]
        W[PX + g] = tension * W[TX + g]
        W[PY + g] = tension * W[TY + g]
        W[PZ + g] = tension * W[TZ + g]


@inlined
def add_bending_forces(W, x0, x1, h, bending):
    """dW/dr' and dW/dr'' of the bending energy at the Gauss points."""
    ih2 = 1.0 / (h * h)
    ih = 1.0 / h
    ax = x0[0] * ih2
    ay = x0[1] * ih2
    az = x0[2] * ih2
    bx = x0[3] * ih
    by = x0[4] * ih
    bz = x0[5] * ih
    cx = x1[0] * ih2
    cy = x1[1] * ih2
    cz = x1[2] * ih2
    dx = x1[3] * ih
    dy = x1[4] * ih
    dz = x1[5] * ih
    for g in range(4):
        yx = ax * E0[g] + bx * E1[g] + cx * E2[g] + dx * E3[g]
        yy = ay * E0[g] + by * E1[g] + cy * E2[g] + dy * E3[g]
        yz = az * E0[g] + bz * E1[g] + cz * E2[g] + dz * E3[g]
        tx = W[TX + g]
        ty = W[TY + g]
        tz = W[TZ + g]
        ig = 1.0 / W[G + g]
        b = yx * tx + yy * ty + yz * tz
        kx = (yx - b * tx) * ig
        ky = (yy - b * ty) * ig
        kz = (yz - b * tz) * ig
        kk = kx * kx + ky * ky + kz * kz
        c = bending * ig
        beta = b * ig
        W[PX + g] -= c * (kk * tx + beta * kx)
        W[PY + g] -= c * (kk * ty + beta * ky)
        W[PZ + g] -= c * (kk * tz + beta * kz)
        W[QX + g] = c * kx
        W[QY + g] = c * ky
        W[QZ + g] = c * kz


@inlined
def load_forces(W, v0, v1, a0, a1, h, cn, ct, added):
    """Minus the drag (eq. 23), minus the tangential part of the added mass, per unit length."""
    ax = v0[0]
    ay = v0[1]
    az = v0[2]
    bx = h * v0[3]
    by = h * v0[4]
    bz = h * v0[5]
    cx = v1[0]
    cy = v1[1]
    cz = v1[2]
    dx = h * v1[3]
    dy = h * v1[4]
    dz = h * v1[5]
    ex = a0[0]
    ey = a0[1]
    ez = a0[2]
    fx = h * a0[3]
    fy = h * a0[4]
    fz = h * a0[5]
    gx = a1[0]
    gy = a1[1]
    gz = a1[2]
    hx = h * a1[3]
    hy = h * a1[4]
    hz = h * a1[5]
    for g in range(4):
        tx = W[TX + g]
        ty = W[TY + g]
        tz = W[TZ + g]
        ux = W[CX + g] - (ax * H0[g] + bx * H1[g] + cx * H2[g] + dx * H3[g])
        uy = W[CY + g] - (ay * H0[g] + by * H1[g] + cy * H2[g] + dy * H3[g])
        uz = W[CZ + g] - (az * H0[g] + bz * H1[g] + cz * H2[g] + dz * H3[g])
        wx = ex * H0[g] + fx * H1[g] + gx * H2[g] + hx * H3[g]
        wy = ey * H0[g] + fy * H1[g] + gy * H2[g] + hy * H3[g]
        wz = ez * H0[g] + fz * H1[g] + gz * H2[g] + hz * H3[g]
        root = math.sqrt(W[G + g])
        ut = ux * tx + uy * ty + uz * tz
        nx = ux - ut * tx
        ny = uy - ut * ty
        nz = uz - ut * tz
        un = math.sqrt(nx * nx + ny * ny + nz * nz)
        fn = root * cn * un
        along = root * ct * abs(ut) * ut + added * (wx * tx + wy * ty + wz * tz)
        W[FX + g] = -(fn * nx + along * tx)
        W[FY + g] = -(fn * ny + along * ty)
        W[FZ + g] = -(fn * nz + along * tz)


@kernel
def residual_spatial(I, M, q, v, a, tension, out, out_constraint):
    """Residual of all elements: forces conjugate to (r, d) and constraint residuals.

    out: (nodes, 6); out_constraint: (nodes, 2).

    out is set to zero first; residual = inertia + internal forces - loads, so the force that a
    support must exert is the residual at its node.
    """
    W = view(M, I[O_GAUSS], 512)
    nodes = I[I_NODES]
    drag = I[I_DRAG]
    payout = I[I_PAYOUT]
    sheared = I[I_DEPTHS] > 1
    ends = view(M, I[O_END_FORCE], 6 * nodes)
    out[0 : 6 * nodes] = 0.0
    for node in range(1, nodes):
        if I[I[O_JOINT] + node] != 0:
            out_constraint[2 * node] = 0.0
            out_constraint[2 * node + 1] = 0.0
            continue
        parent = I[I[O_PARENT] + node]
        e = I[O_EDGE] + node * EDGE_WORDS
        h = M[e + E_LENGTH]
        bending = M[e + E_BENDING]
        x0 = view(q, 6 * parent, 6)
        x1 = view(q, 6 * node, 6)
        v0 = view(v, 6 * parent, 6)
        v1 = view(v, 6 * node, 6)
        a0 = view(a, 6 * parent, 6)
        a1 = view(a, 6 * node, 6)
        if parent == 0 and payout != 0:
            v0 = view(M, I[O_TOP], 6)
            a0 = view(M, I[O_TOP] + 6, 6)
        geometry(W, x0, x1, h)
        t0 = tension[2 * node]
        t1 = tension[2 * node + 1]
        axial_forces(W, t0, t1, M[e + E_STABILISATION])

        if M[e + E_STRAIN_TERMS] == 1.0:
            r0 = 0.0
            r1 = 0.0
            for g in range(3):
                r0 += WEIGHT[g] * (W[G + g] - 1.0)
                r1 += WEIGHT_P1[g] * (W[G + g] - 1.0)
            c = M[e + E_COMPLIANCE]
            out_constraint[2 * node] = h * (r0 - c * t0)
            out_constraint[2 * node + 1] = h * (r1 - c * t1 / 3.0)
        else:
            r0 = 0.0
            r1 = 0.0
            for g in range(3):
                strain, _slope = strain_and_slope(
                    M,
                    t0 + t1 * P1[g],
                    M[e + E_TENSION_LOW],
                    M[e + E_TENSION_HIGH],
                    int(M[e + E_STRAIN_OFFSET]),
                    int(M[e + E_STRAIN_TERMS]),
                )
                r0 += WEIGHT[g] * (W[G + g] - 1.0 - strain)
                r1 += WEIGHT_P1[g] * (W[G + g] - 1.0 - strain)
            out_constraint[2 * node] = h * r0
            out_constraint[2 * node + 1] = h * r1

        if bending != 0.0:
            add_bending_forces(W, x0, x1, h, bending)
        if drag != 0:
            if sheared:
                element_current(I, M, W, x0, x1, h)
            load_forces(
                W,
                v0,
                v1,
                a0,
                a1,
                h,
                M[e + E_DRAG_NORMAL],
                M[e + E_DRAG_TANGENTIAL],
                M[e + E_ADDED],
            )

        mass = M[e + E_MASS] * h
        weight = M[e + E_WEIGHT] * h
        for i in range(3):
            p = view(W, PX + 4 * i, 4)
            a0i = a0[i] * mass
            a1i = a0[3 + i] * mass * h
            a2i = a1[i] * mass
            a3i = a1[3 + i] * mass * h
            R = view(W, AX, 4)
            for k in range(4):
                R[k] = (
                    a0i * MASS[0, k]
                    + a1i * MASS[1, k]
                    + a2i * MASS[2, k]
                    + a3i * MASS[3, k]
                    + p[0] * WD[0, k]
                    + p[1] * WD[1, k]
                    + p[2] * WD[2, k]
                )
            if drag != 0:
                f = view(W, FX + 4 * i, 4)
                f0 = h * f[0]
                f1 = h * f[1]
                f2 = h * f[2]
                for k in range(4):
                    R[k] += f0 * WH[0, k] + f1 * WH[1, k] + f2 * WH[2, k]
            if bending != 0.0:
                y = view(W, QX + 4 * i, 4)
                y0 = y[0] / h
                y1 = y[1] / h
                y2 = y[2] / h
                for k in range(4):
                    R[k] += y0 * WE[0, k] + y1 * WE[1, k] + y2 * WE[2, k]
            if i == 2:
                for k in range(4):
                    R[k] += weight * LOAD[k]
            out[6 * parent + i] += R[0]
            out[6 * parent + 3 + i] += h * R[1]
            out[6 * node + i] += R[2]
            out[6 * node + 3 + i] += h * R[3]
            ends[6 * node + i] = -R[0]
            ends[6 * node + 3 + i] = R[2]


@inlined
def tangent_matrices(
    W, x0, x1, v0, v1, a0, a1, h, tension0, tension1, eas, bending, drag, cn, ct, added, ca, cv
):
    """Jacobians of the forces at the Gauss points into the groups A00, A01, A11, A12, A21, A22.

    With c = EI/g^2, beta = b/g (derivation in docs/theory.md):
      A22 = c P / ... ; d f1/d r'' = -c (k t^T + 2 t k^T + beta P);
      d f1/d r' = (T/g + c (beta^2 - k.k)) P + c (3 k.k t t^T + 3 beta (k t^T + t k^T) - k k^T).
    """
    e2 = 0.0
    for g in range(3):
        e2 += WEIGHT_P2[g] * (W[G + g] - 1.0)
    t2 = 5.0 * eas * e2
    ih = 1.0 / h
    ih2 = ih * ih
    for g in range(3):
        s = W[G + g]
        ig = 1.0 / s
        t = (W[TX + g], W[TY + g], W[TZ + g])
        tension = tension0 + tension1 * P1[g] + t2 * P2[g]
        y0 = 0.0
        y1 = 0.0
        y2 = 0.0
        if bending != 0.0:
            y0 = (x0[0] * E0[g] + x1[0] * E2[g]) * ih2 + (x0[3] * E1[g] + x1[3] * E3[g]) * ih
            y1 = (x0[1] * E0[g] + x1[1] * E2[g]) * ih2 + (x0[4] * E1[g] + x1[4] * E3[g]) * ih
            y2 = (x0[2] * E0[g] + x1[2] * E2[g]) * ih2 + (x0[5] * E1[g] + x1[5] * E3[g]) * ih
        b = y0 * t[0] + y1 * t[1] + y2 * t[2]
        k = ((y0 - b * t[0]) * ig, (y1 - b * t[1]) * ig, (y2 - b * t[2]) * ig)
        kk = k[0] * k[0] + k[1] * k[1] + k[2] * k[2]
        c = bending * ig * ig
        beta = b * ig
        p11 = tension * ig + c * (beta * beta - kk)
        n = (0.0, 0.0, 0.0)
        w = (0.0, 0.0, 0.0)
        f = (0.0, 0.0, 0.0)
        un = 0.0
        ut = 0.0
        at = 0.0
        root = 0.0
        iun = 0.0
        if drag != 0:
            ux = W[CX + g] - (v0[0] * H0[g] + v1[0] * H2[g] + h * (v0[3] * H1[g] + v1[3] * H3[g]))
            uy = W[CY + g] - (v0[1] * H0[g] + v1[1] * H2[g] + h * (v0[4] * H1[g] + v1[4] * H3[g]))
            uz = W[CZ + g] - (v0[2] * H0[g] + v1[2] * H2[g] + h * (v0[5] * H1[g] + v1[5] * H3[g]))
            wx = a0[0] * H0[g] + a1[0] * H2[g] + h * (a0[3] * H1[g] + a1[3] * H3[g])
            wy = a0[1] * H0[g] + a1[1] * H2[g] + h * (a0[4] * H1[g] + a1[4] * H3[g])
            wz = a0[2] * H0[g] + a1[2] * H2[g] + h * (a0[5] * H1[g] + a1[5] * H3[g])
            root = math.sqrt(s)
            ut = ux * t[0] + uy * t[1] + uz * t[2]
            n = (ux - ut * t[0], uy - ut * t[1], uz - ut * t[2])
            un = math.sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2])
            iun = 1.0 / max(un, TINY)
            at = wx * t[0] + wy * t[1] + wz * t[2]
            w = (wx - at * t[0], wy - at * t[1], wz - at * t[2])
            fn = root * cn * un
            ft = root * ct * abs(ut) * ut
            f = (fn * n[0] + ft * t[0], fn * n[1] + ft * t[1], fn * n[2] + ft * t[2])
        # d(-drag)/dv = + dF/du; its parts along P, n n^T and t t^T.
        d_p = cv * root * cn * un
        d_nn = cv * root * cn * iun
        d_tt = 2.0 * cv * root * ct * abs(ut) - ca * added
        # d(-drag - added)/dr': see load_forces; n is normal to t, so t n^T and P suffice.
        e_tn = -root * ig * (2.0 * ct * abs(ut) - cn * un)
        e_p = -root * ig * (ct * abs(ut) * ut - cn * un * ut) - added * at * ig
        e_nn = root * ig * cn * ut * iun
        half = -0.5 * ig
        slot = JACOBIAN + g
        for i in range(3):
            for j in range(3):
                tt = t[i] * t[j]
                p = -tt
                if i == j:
                    p += 1.0
                nn = n[i] * n[j]
                kt = k[i] * t[j]
                tk = t[i] * k[j]
                at_slot = slot + 4 * (3 * i + j)
                W[at_slot] = d_p * p + d_nn * nn + d_tt * tt
                W[at_slot + 36] = (
                    half * f[i] * t[j]
                    + e_tn * t[i] * n[j]
                    + e_p * p
                    + e_nn * nn
                    - added * ig * t[i] * w[j]
                )
                W[at_slot + 72] = p11 * p + c * (
                    3.0 * kk * tt + 3.0 * beta * (kt + tk) - k[i] * k[j]
                )
                W[at_slot + 108] = -c * (kt + 2.0 * tk + beta * p)
                W[at_slot + 144] = -c * (tk + 2.0 * kt + beta * p)
                W[at_slot + 180] = c * p


@kernel
def jacobian_spatial(I, M, q, v, a, tension, ca, cv):
    """Blocks of d residual/d q + cv d residual/d v + ca d residual/d a, with T condensed out.

    Fills, for every element, its share of the diagonal blocks of both nodes, the two off-diagonal
    blocks, the gradient B of its constraint (2, 12) and the inverse of the compliance (3).
    """
    W = view(M, I[O_GAUSS], 512)
    nodes = I[I_NODES]
    drag = I[I_DRAG]
    payout = I[I_PAYOUT]
    sheared = I[I_DEPTHS] > 1
    diagonal = view(M, I[O_DIAGONAL], 36 * nodes)
    upper = view(M, I[O_UPPER], 36 * nodes)
    lower = view(M, I[O_LOWER], 36 * nodes)
    diagonal[:] = 0.0
    for node in range(1, nodes):
        if I[I[O_JOINT] + node] != 0:
            continue
        parent = I[I[O_PARENT] + node]
        e = I[O_EDGE] + node * EDGE_WORDS
        h = M[e + E_LENGTH]
        bending = M[e + E_BENDING]
        x0 = view(q, 6 * parent, 6)
        x1 = view(q, 6 * node, 6)
        a0 = view(a, 6 * parent, 6)
        a1 = view(a, 6 * node, 6)
        v0 = view(v, 6 * parent, 6)
        v1 = view(v, 6 * node, 6)
        if parent == 0 and payout != 0:
            v0 = view(M, I[O_TOP], 6)
            a0 = view(M, I[O_TOP] + 6, 6)
        geometry(W, x0, x1, h)
        if drag != 0 and sheared:
            element_current(I, M, W, x0, x1, h)
        t0 = tension[2 * node]
        t1 = tension[2 * node + 1]
        eas = M[e + E_STABILISATION]
        tangent_matrices(
            W,
            x0,
            x1,
            v0,
            v1,
            a0,
            a1,
            h,
            t0,
            t1,
            eas,
            bending,
            drag,
            M[e + E_DRAG_NORMAL],
            M[e + E_DRAG_TANGENTIAL],
            M[e + E_ADDED],
            ca,
            cv,
        )

        # Gradient of the constraints, and the compliance.
        B = view(M, I[O_GRADIENT] + 24 * node, 24)
        B2 = view(W, AX, 12)
        for i in range(3):
            for k in range(4):
                w0 = W[TX + 4 * i] * WD[0, k]
                w1 = W[TX + 4 * i + 1] * WD[1, k]
                w2 = W[TX + 4 * i + 2] * WD[2, k]
                B[4 * i + k] = w0 + w1 + w2
                B[12 + 4 * i + k] = w0 * P1[0] + w1 * P1[1] + w2 * P1[2]
                B2[4 * i + k] = w0 * P2[0] + w1 * P2[1] + w2 * P2[2]
        c00 = 0.0
        c01 = 0.0
        c11 = 0.0
        if M[e + E_STRAIN_TERMS] == 1.0:
            c00 = h * M[e + E_COMPLIANCE]
            c11 = c00 / 3.0
        else:
            for g in range(3):
                _strain, slope = strain_and_slope(
                    M,
                    t0 + t1 * P1[g],
                    M[e + E_TENSION_LOW],
                    M[e + E_TENSION_HIGH],
                    int(M[e + E_STRAIN_OFFSET]),
                    int(M[e + E_STRAIN_TERMS]),
                )
                c00 += h * WEIGHT[g] * slope
                c01 += h * WEIGHT_P1[g] * slope
                c11 += h * WEIGHT_P1[g] * P1[g] * slope
        determinant = 1.0 / (c00 * c11 - c01 * c01)
        s00 = c11 * determinant
        s01 = -c01 * determinant
        s11 = c00 * determinant
        stiffness = I[O_COMPLIANCE] + 3 * node
        M[stiffness] = s00
        M[stiffness + 1] = s01
        M[stiffness + 2] = s11
        s22 = 5.0 * eas / h

        mass = ca * M[e + E_MASS] * h
        ih = 1.0 / h
        ih2 = ih * ih
        ih3 = ih * ih2
        R = view(W, BLOCK, 16)
        at = 36 * node
        above = 36 * parent
        for i in range(3):
            for j in range(3):
                slot = JACOBIAN + 4 * (3 * i + j)
                if i == j:
                    for n in range(16):
                        R[n] = mass * MASS_PAIRS[n]
                else:
                    for n in range(16):
                        R[n] = 0.0
                for g in range(3):
                    f00 = h * W[slot + g]
                    f01 = W[slot + 36 + g]
                    f11 = ih * W[slot + 72 + g]
                    f12 = ih2 * W[slot + 108 + g]
                    f21 = ih2 * W[slot + 144 + g]
                    f22 = ih3 * W[slot + 180 + g]
                    if bending != 0.0:
                        for n in range(16):
                            R[n] += (
                                f00 * S00[g, n]
                                + f01 * S01[g, n]
                                + f11 * S11[g, n]
                                + f12 * S12[g, n]
                                + f21 * S21[g, n]
                                + f22 * S22[g, n]
                            )
                    else:
                        for n in range(16):
                            R[n] += f00 * S00[g, n] + f01 * S01[g, n] + f11 * S11[g, n]
                for k in range(4):
                    b0 = s00 * B[4 * i + k] + s01 * B[12 + 4 * i + k]
                    b1 = s01 * B[4 * i + k] + s11 * B[12 + 4 * i + k]
                    b2 = s22 * B2[4 * i + k]
                    for l in range(4):
                        R[4 * k + l] += (
                            b0 * B[4 * j + l] + b1 * B[12 + 4 * j + l] + b2 * B2[4 * j + l]
                        )
                rr = 6 * i + j
                rd = 6 * i + 3 + j
                dr = 6 * (3 + i) + j
                dd = 6 * (3 + i) + 3 + j
                diagonal[above + rr] += R[0]
                diagonal[above + rd] += h * R[1]
                diagonal[above + dr] += h * R[4]
                diagonal[above + dd] += h * h * R[5]
                upper[at + rr] = R[2]
                upper[at + rd] = h * R[3]
                upper[at + dr] = h * R[6]
                upper[at + dd] = h * h * R[7]
                lower[at + rr] = R[8]
                lower[at + rd] = h * R[9]
                lower[at + dr] = h * R[12]
                lower[at + dd] = h * h * R[13]
                diagonal[at + rr] += R[10]
                diagonal[at + rd] += h * R[11]
                diagonal[at + dr] += h * R[14]
                diagonal[at + dd] += h * h * R[15]


@kernel
def condense_spatial(I, M, out_constraint, out):
    """Add B^T S (constraint residual) of every element to the forces: T condensed out."""
    for node in range(1, I[I_NODES]):
        if I[I[O_JOINT] + node] != 0:
            continue
        parent = I[I[O_PARENT] + node]
        h = M[I[O_EDGE] + node * EDGE_WORDS + E_LENGTH]
        B = view(M, I[O_GRADIENT] + 24 * node, 24)
        s = I[O_COMPLIANCE] + 3 * node
        r0 = out_constraint[2 * node]
        r1 = out_constraint[2 * node + 1]
        z0 = M[s] * r0 + M[s + 1] * r1
        z1 = M[s + 1] * r0 + M[s + 2] * r1
        for i in range(3):
            out[6 * parent + i] += z0 * B[4 * i] + z1 * B[12 + 4 * i]
            out[6 * parent + 3 + i] += h * (z0 * B[4 * i + 1] + z1 * B[12 + 4 * i + 1])
            out[6 * node + i] += z0 * B[4 * i + 2] + z1 * B[12 + 4 * i + 2]
            out[6 * node + 3 + i] += h * (z0 * B[4 * i + 3] + z1 * B[12 + 4 * i + 3])


@kernel
def stretch_rate_spatial(I, M, x, out):
    """Gradient B of the constraints times a vector x (nodes, 6): out (nodes, 2)."""
    for node in range(1, I[I_NODES]):
        out[2 * node] = 0.0
        out[2 * node + 1] = 0.0
        if I[I[O_JOINT] + node] != 0:
            continue
        parent = I[I[O_PARENT] + node]
        h = M[I[O_EDGE] + node * EDGE_WORDS + E_LENGTH]
        B = view(M, I[O_GRADIENT] + 24 * node, 24)
        r0 = 0.0
        r1 = 0.0
        for i in range(3):
            y0 = x[6 * parent + i]
            y1 = h * x[6 * parent + 3 + i]
            y2 = x[6 * node + i]
            y3 = h * x[6 * node + 3 + i]
            b = 4 * i
            c = 12 + 4 * i
            r0 += B[b] * y0 + B[b + 1] * y1 + B[b + 2] * y2 + B[b + 3] * y3
            r1 += B[c] * y0 + B[c + 1] * y1 + B[c + 2] * y2 + B[c + 3] * y3
        out[2 * node] = r0
        out[2 * node + 1] = r1
