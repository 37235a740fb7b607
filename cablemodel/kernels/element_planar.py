"""Mixed cubic Hermite element in a vertical plane: residual and Jacobian of a whole line.

The same formulas as in element_spatial.py, in the tangent t and the normal n = (-t_z, t_x): the
curvature k is a number and P = n n^T, which saves a root and most of the products. Node vector
(x, z, x', z').
"""

import math

from .compile import inlined, kernel, table_product, view
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
    I_WAVES,
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
    LINES_D,
    LINES_DE,
    LINES_H,
    LINES_HD,
    LOAD,
    MASS,
    MASS_PAIRS,
    P1,
    P2,
    WD,
    WE,
    WEIGHT,
    WEIGHT_P1,
    WEIGHT_P2,
    WH,
)
from .waves import element_water, wave_loads, wet_rows

# Slots of four words in the Gauss workspace.
CX, CZ = 0, 4  # water velocity
G, TX, TZ = 12, 16, 20
FX, FZ = 28, 32  # conjugate to r
PX, PZ = 40, 44  # conjugate to r'
QX, QZ = 52, 56  # conjugate to r''
R = 64  # element vector
TT, TN, NT, NN = 0, 4, 8, 12  # components of a tangent matrix in (t, n)
JACOBIAN = 80  # 6 groups of 4 slots of 4: A00, A01, A11, A12, A21, A22
# Rows of four words: the pairs of components xx, xz, zx, zz.
ROWS = JACOBIAN + 96  # at each Gauss point: A11, A12, A21, A22, then A00, then A01
ROWS_00, ROWS_01 = ROWS + 48, ROWS + 60
SUM_D = ROWS + 72  # sums over the Gauss points: the six pairs of PAIRS_D,
SUM_H = SUM_D + 24  # the ten of PAIRS_H,
SUM_HD = SUM_H + 40  # the twelve of PAIRS_HD
TURNED = SUM_HD + 48  # the last three of PAIRS_D with components exchanged
BLOCKS = TURNED + 12  # sums of all sixteen pairs of shape functions

_product_d = table_product(LINES_D)
_product_de = table_product(LINES_DE)
_product_h = table_product(LINES_H)
_product_hd = table_product(LINES_HD)


@inlined
def element_current(I, M, W, x0, x1, h):
    """Water velocity at the Gauss points of an element, when it varies over depth."""
    motion = I[O_MOTION] + 9
    z = view(M, motion, 3)
    for g in range(3):
        height = x0[1] * H0[g] + h * x0[3] * H1[g] + x1[1] * H2[g] + h * x1[3] * H3[g]
        current_at(I, M, height, z)
        W[CX + g] = z[0]
        W[CZ + g] = z[1]


@inlined
def geometry(W, x0, x1, h):
    """Stretch g and tangent t at the Gauss points."""
    ih = 1.0 / h
    ax = x0[0] * ih
    az = x0[1] * ih
    bx = x0[2]
    bz = x0[3]
    cx = x1[0] * ih
    cz = x1[1] * ih
    dx = x1[2]
    dz = x1[3]
    for g in range(4):
        px = ax * D0[g] + bx * D1[g] + cx * D2[g] + dx * D3[g]
        pz = az * D0[g] + bz * D1[g] + cz * D2[g] + dz * D3[g]
        s = math.sqrt(px * px + pz * pz)
        i = 1.0 / s
        W[G + g] = s
        W[TX + g] = px * i
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
        W[PZ + g] = tension * W[TZ + g]


@inlined
def add_bending_forces(W, x0, x1, h, bending):
    """dW/dr' and dW/dr'' of the bending energy at the Gauss points."""
    ih2 = 1.0 / (h * h)
    ih = 1.0 / h
    ax = x0[0] * ih2
    az = x0[1] * ih2
    bx = x0[2] * ih
    bz = x0[3] * ih
    cx = x1[0] * ih2
    cz = x1[1] * ih2
    dx = x1[2] * ih
    dz = x1[3] * ih
    for g in range(4):
        yx = ax * E0[g] + bx * E1[g] + cx * E2[g] + dx * E3[g]
        yz = az * E0[g] + bz * E1[g] + cz * E2[g] + dz * E3[g]
        tx = W[TX + g]
        tz = W[TZ + g]
        ig = 1.0 / W[G + g]
        beta = (yx * tx + yz * tz) * ig
        k = (yz * tx - yx * tz) * ig
        c = bending * ig * k
        W[PX + g] -= c * (k * tx - beta * tz)
        W[PZ + g] -= c * (k * tz + beta * tx)
        W[QX + g] = -c * tz
        W[QZ + g] = c * tx


@inlined
def load_forces(W, v0, v1, a0, a1, h, cn, ct, added):
    """Minus the drag (eq. 23), minus the tangential part of the added mass, per unit length."""
    ax = v0[0]
    az = v0[1]
    bx = h * v0[2]
    bz = h * v0[3]
    cx = v1[0]
    cz = v1[1]
    dx = h * v1[2]
    dz = h * v1[3]
    ex = a0[0]
    ez = a0[1]
    fx = h * a0[2]
    fz = h * a0[3]
    gx = a1[0]
    gz = a1[1]
    hx = h * a1[2]
    hz = h * a1[3]
    for g in range(4):
        tx = W[TX + g]
        tz = W[TZ + g]
        ux = W[CX + g] - (ax * H0[g] + bx * H1[g] + cx * H2[g] + dx * H3[g])
        uz = W[CZ + g] - (az * H0[g] + bz * H1[g] + cz * H2[g] + dz * H3[g])
        wx = ex * H0[g] + fx * H1[g] + gx * H2[g] + hx * H3[g]
        wz = ez * H0[g] + fz * H1[g] + gz * H2[g] + hz * H3[g]
        root = math.sqrt(W[G + g])
        ut = ux * tx + uz * tz
        un = uz * tx - ux * tz
        along = root * ct * abs(ut) * ut + added * (wx * tx + wz * tz)
        across = root * cn * abs(un) * un
        W[FX + g] = across * tz - along * tx
        W[FZ + g] = -across * tx - along * tz


@kernel
def residual_planar(I, M, q, v, a, tension, out, out_constraint):
    """Residual of all elements: out (nodes, 4), out_constraint (nodes, 2); see residual_spatial."""
    W = view(M, I[O_GAUSS], 768)
    nodes = I[I_NODES]
    drag = I[I_DRAG]
    payout = I[I_PAYOUT]
    sheared = I[I_DEPTHS] > 1
    waves = I[I_WAVES]
    ends = view(M, I[O_END_FORCE], 4 * nodes)
    out[0 : 4 * nodes] = 0.0
    for node in range(1, nodes):
        if I[I[O_JOINT] + node] != 0:
            out_constraint[2 * node] = 0.0
            out_constraint[2 * node + 1] = 0.0
            continue
        parent = I[I[O_PARENT] + node]
        e = I[O_EDGE] + node * EDGE_WORDS
        h = M[e + E_LENGTH]
        bending = M[e + E_BENDING]
        x0 = view(q, 4 * parent, 4)
        x1 = view(q, 4 * node, 4)
        v0 = view(v, 4 * parent, 4)
        v1 = view(v, 4 * node, 4)
        a0 = view(a, 4 * parent, 4)
        a1 = view(a, 4 * node, 4)
        if parent == 0 and payout != 0:
            v0 = view(M, I[O_TOP], 4)
            a0 = view(M, I[O_TOP] + 6, 4)
        geometry(W, x0, x1, h)
        t0 = tension[2 * node]
        t1 = tension[2 * node + 1]
        axial_forces(W, t0, t1, M[e + E_STABILISATION])

        r0 = 0.0
        r1 = 0.0
        if M[e + E_STRAIN_TERMS] == 1.0:
            for g in range(3):
                r0 += WEIGHT[g] * (W[G + g] - 1.0)
                r1 += WEIGHT_P1[g] * (W[G + g] - 1.0)
            c = M[e + E_COMPLIANCE]
            r0 -= c * t0
            r1 -= c * t1 * (1.0 / 3.0)
        else:
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
        if waves != 0:
            wave_loads(I, M, W, e, x0, x1, v0, v1, a0, a1)
        elif drag != 0:
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
        ih = 1.0 / h
        for i in range(2):
            p = view(W, PX + 4 * i, 4)
            a0i = a0[i] * mass
            a1i = a0[2 + i] * mass * h
            a2i = a1[i] * mass
            a3i = a1[2 + i] * mass * h
            r = view(W, R, 4)
            for k in range(4):
                r[k] = (
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
                    r[k] += f0 * WH[0, k] + f1 * WH[1, k] + f2 * WH[2, k]
            if bending != 0.0:
                y = view(W, QX + 4 * i, 4)
                y0 = y[0] * ih
                y1 = y[1] * ih
                y2 = y[2] * ih
                for k in range(4):
                    r[k] += y0 * WE[0, k] + y1 * WE[1, k] + y2 * WE[2, k]
            if i == 1:
                for k in range(4):
                    r[k] += weight * LOAD[k]
            out[4 * parent + i] += r[0]
            out[4 * parent + 2 + i] += h * r[1]
            out[4 * node + i] += r[2]
            out[4 * node + 2 + i] += h * r[3]
            ends[4 * node + i] = -r[0]
            ends[4 * node + 2 + i] = r[2]


@inlined
def tangent_matrices(
    W, x0, x1, v0, v1, a0, a1, h, tension0, tension1, eas, bending, drag, cn, ct, added, ca, cv
):
    """Jacobians of the forces at the Gauss points, components along (t, n)."""
    e2 = 0.0
    for g in range(3):
        e2 += WEIGHT_P2[g] * (W[G + g] - 1.0)
    t2 = 5.0 * eas * e2
    ih = 1.0 / h
    ih2 = ih * ih
    ax = x0[0] * ih2
    az = x0[1] * ih2
    bx = x0[2] * ih
    bz = x0[3] * ih
    cx = x1[0] * ih2
    cz = x1[1] * ih2
    dx = x1[2] * ih
    dz = x1[3] * ih
    for g in range(4):
        ig = 1.0 / W[G + g]
        tx = W[TX + g]
        tz = W[TZ + g]
        tension = tension0 + tension1 * P1[g] + t2 * P2[g]
        yx = ax * E0[g] + bx * E1[g] + cx * E2[g] + dx * E3[g]
        yz = az * E0[g] + bz * E1[g] + cz * E2[g] + dz * E3[g]
        beta = (yx * tx + yz * tz) * ig
        k = (yz * tx - yx * tz) * ig
        c1 = bending * ig * ig * ih
        c2 = c1 * ih
        c3 = c2 * ih
        j = JACOBIAN + 32 + g
        W[j + TT] = 3.0 * c1 * k * k
        W[j + TN] = 3.0 * c1 * beta * k
        W[j + NN] = ih * tension * ig + c1 * (beta * beta - 2.0 * k * k)
        W[j + 16 + TN] = -2.0 * c2 * k
        W[j + 16 + NT] = -c2 * k
        W[j + 16 + NN] = -c2 * beta
        W[j + 48 + NN] = c3
    if drag == 0:
        return
    for g in range(4):
        ig = 1.0 / W[G + g]
        tx = W[TX + g]
        tz = W[TZ + g]
        ux = W[CX + g] - (v0[0] * H0[g] + v1[0] * H2[g] + h * (v0[2] * H1[g] + v1[2] * H3[g]))
        uz = W[CZ + g] - (v0[1] * H0[g] + v1[1] * H2[g] + h * (v0[3] * H1[g] + v1[3] * H3[g]))
        wx = a0[0] * H0[g] + a1[0] * H2[g] + h * (a0[2] * H1[g] + a1[2] * H3[g])
        wz = a0[1] * H0[g] + a1[1] * H2[g] + h * (a0[3] * H1[g] + a1[3] * H3[g])
        root = math.sqrt(W[G + g])
        ut = ux * tx + uz * tz
        un = uz * tx - ux * tz
        at = wx * tx + wz * tz
        an = wz * tx - wx * tz
        fn = root * cn * abs(un)
        ft = root * ct * abs(ut)
        j = JACOBIAN + g
        W[j + TT] = h * (2.0 * cv * ft - ca * added)
        W[j + NN] = h * (2.0 * cv * fn)
        W[j + 16 + TT] = -0.5 * ig * ft * ut
        W[j + 16 + TN] = -ig * ((2.0 * ft - fn) * un + added * an)
        W[j + 16 + NT] = -0.5 * ig * fn * un
        W[j + 16 + NN] = -ig * (ft * ut - 2.0 * fn * ut + added * at)


@kernel
def jacobian_planar(I, M, q, v, a, tension, ca, cv):
    """Blocks of the effective Jacobian with T condensed out; see jacobian_spatial."""
    W = view(M, I[O_GAUSS], 768)
    nodes = I[I_NODES]
    drag = I[I_DRAG]
    payout = I[I_PAYOUT]
    sheared = I[I_DEPTHS] > 1
    waves = I[I_WAVES]
    diagonal = view(M, I[O_DIAGONAL], 16 * nodes)
    upper = view(M, I[O_UPPER], 16 * nodes)
    lower = view(M, I[O_LOWER], 16 * nodes)
    diagonal[:] = 0.0
    for node in range(1, nodes):
        if I[I[O_JOINT] + node] != 0:
            continue
        parent = I[I[O_PARENT] + node]
        e = I[O_EDGE] + node * EDGE_WORDS
        h = M[e + E_LENGTH]
        bending = M[e + E_BENDING]
        x0 = view(q, 4 * parent, 4)
        x1 = view(q, 4 * node, 4)
        a0 = view(a, 4 * parent, 4)
        a1 = view(a, 4 * node, 4)
        v0 = view(v, 4 * parent, 4)
        v1 = view(v, 4 * node, 4)
        if parent == 0 and payout != 0:
            v0 = view(M, I[O_TOP], 4)
            a0 = view(M, I[O_TOP] + 6, 4)
        geometry(W, x0, x1, h)
        if waves != 0:
            element_water(I, M, W, e, x0, x1)
        elif drag != 0 and sheared:
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

        B = view(M, I[O_GRADIENT] + 16 * node, 16)
        B2 = view(W, R, 8)
        for i in range(2):
            for k in range(4):
                w0 = W[TX + 4 * i] * WD[0, k]
                w1 = W[TX + 4 * i + 1] * WD[1, k]
                w2 = W[TX + 4 * i + 2] * WD[2, k]
                B[4 * i + k] = w0 + w1 + w2
                B[8 + 4 * i + k] = w0 * P1[0] + w1 * P1[1] + w2 * P1[2]
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

        spread_components(W, bending != 0.0, drag != 0)
        if waves != 0:
            wet_rows(I, M, W, e, ROWS_00, ROWS_01, 4, ca)
        if bending != 0.0:
            _product_de(W, SUM_D, ROWS, 4)
        else:
            _product_d(W, SUM_D, ROWS, 4)
        add_tension(W, B, B2, s00, s01, s11, s22)
        if drag != 0:
            _product_h(W, SUM_H, ROWS_00, 4)
            _product_hd(W, SUM_HD, ROWS_01, 4)
        else:
            for n in range(40):
                W[SUM_H + n] = 0.0
            for n in range(48):
                W[SUM_HD + n] = 0.0
        mass = ca * M[e + E_MASS] * h
        for n in range(10):
            W[SUM_H + 4 * n] += mass * MASS_PAIRS[n]
            W[SUM_H + 4 * n + 3] += mass * MASS_PAIRS[n]
        combine(W, h)
        scatter(
            W,
            view(diagonal, 16 * parent, 16),
            view(upper, 16 * node, 16),
            view(lower, 16 * node, 16),
            view(diagonal, 16 * node, 16),
        )


@inlined
def spread_components(W, bends, drags):
    """Tangent matrices from (t, n) to rows of component pairs."""
    for g in range(3):
        tx = W[TX + g]
        tz = W[TZ + g]
        xx = tx * tx
        xz = tx * tz
        zz = tz * tz
        s = JACOBIAN + g
        nn = W[s + 32 + NN]
        row = ROWS + 4 * g
        if bends:
            tt = W[s + 32 + TT]
            tn = W[s + 32 + TN]
            across = (tt - nn) * xz + tn * (xx - zz)
            W[row] = tt * xx - 2.0 * tn * xz + nn * zz
            W[row + 1] = across
            W[row + 2] = across
            W[row + 3] = tt * zz + 2.0 * tn * xz + nn * xx
            tn = W[s + 48 + TN]
            nt = W[s + 48 + NT]
            nn = W[s + 48 + NN]
            first = nn * zz - (tn + nt) * xz
            last = nn * xx + (tn + nt) * xz
            upper = tn * xx - nt * zz - nn * xz
            lower = nt * xx - tn * zz - nn * xz
            W[row + 12] = first
            W[row + 13] = upper
            W[row + 14] = lower
            W[row + 15] = last
            W[row + 24] = first
            W[row + 25] = lower
            W[row + 26] = upper
            W[row + 27] = last
            nn = W[s + 80 + NN]
            W[row + 36] = nn * zz
            W[row + 37] = -nn * xz
            W[row + 38] = -nn * xz
            W[row + 39] = nn * xx
        else:
            W[row] = nn * zz
            W[row + 1] = -nn * xz
            W[row + 2] = -nn * xz
            W[row + 3] = nn * xx
        if drags:
            tt = W[s + TT]
            nn = W[s + NN]
            across = (tt - nn) * xz
            W[row + 48] = tt * xx + nn * zz
            W[row + 49] = across
            W[row + 50] = across
            W[row + 51] = tt * zz + nn * xx
            tt = W[s + 16 + TT]
            tn = W[s + 16 + TN]
            nt = W[s + 16 + NT]
            nn = W[s + 16 + NN]
            W[row + 60] = tt * xx - (tn + nt) * xz + nn * zz
            W[row + 61] = (tt - nn) * xz + tn * xx - nt * zz
            W[row + 62] = (tt - nn) * xz + nt * xx - tn * zz
            W[row + 63] = tt * zz + (tn + nt) * xz + nn * xx


@inlined
def add_tension(W, B, B2, s00, s01, s11, s22):
    """Add what condensing T out leaves, and the stabilisation, to the six pairs of slopes."""
    for i in range(2):
        for a in range(1, 4):
            c = s00 * B[4 * i + a] + s01 * B[8 + 4 * i + a]
            d = s01 * B[4 * i + a] + s11 * B[8 + 4 * i + a]
            e = s22 * B2[4 * i + a]
            for j in range(2):
                pair = SUM_D + 2 * i + j
                at = 4 * j + a
                W[pair + 4 * (a - 1)] += c * B[at] + d * B[8 + at] + e * B2[at]
                for b in range(a + 1, 4):
                    at = 4 * j + b
                    # Pairs (1, 2), (1, 3), (2, 3) are rows 3, 4, 5.
                    W[pair + 4 * (a + b)] += c * B[at] + d * B[8 + at] + e * B2[at]


@inlined
def combine(W, h):
    """All sixteen pairs of shape functions from the sums, for all pairs of components at once.

    Function 0 has minus the slope of function 2; slope unknowns are scaled by h.
    """
    for i in range(2):
        for j in range(2):
            for row in range(3):
                W[TURNED + 4 * row + 2 * i + j] = W[SUM_D + 4 * (3 + row) + 2 * j + i]
    h2 = h * h
    for p in range(4):
        k11 = W[SUM_D + p]
        k22 = W[SUM_D + 4 + p]
        k33 = W[SUM_D + 8 + p]
        k12 = W[SUM_D + 12 + p]
        k13 = W[SUM_D + 16 + p]
        k23 = W[SUM_D + 20 + p]
        k21 = W[TURNED + p]
        k31 = W[TURNED + 4 + p]
        k32 = W[TURNED + 8 + p]
        H = SUM_H + p
        X = SUM_HD + p
        to = BLOCKS + p
        W[to] = k22 + W[H] - W[X + 4]
        W[to + 4] = h * (W[H + 16] + W[X] - k21)
        W[to + 8] = W[H + 20] + W[X + 4] - k22
        W[to + 12] = h * (W[H + 24] + W[X + 8] - k23)
        W[to + 16] = h * (W[H + 16] - W[X + 16] - k12)
        W[to + 20] = h2 * (k11 + W[H + 4] + W[X + 12])
        W[to + 24] = h * (k12 + W[H + 28] + W[X + 16])
        W[to + 28] = h2 * (k13 + W[H + 32] + W[X + 20])
        W[to + 32] = W[H + 20] - W[X + 28] - k22
        W[to + 36] = h * (k21 + W[H + 28] + W[X + 24])
        W[to + 40] = k22 + W[H + 8] + W[X + 28]
        W[to + 44] = h * (k23 + W[H + 36] + W[X + 32])
        W[to + 48] = h * (W[H + 24] - W[X + 40] - k32)
        W[to + 52] = h2 * (k31 + W[H + 32] + W[X + 36])
        W[to + 56] = h * (k32 + W[H + 36] + W[X + 40])
        W[to + 60] = h2 * (k33 + W[H + 12] + W[X + 44])


@inlined
def scatter(W, above, upper, lower, below):
    """The sixteen pairs into the blocks of the element's nodes."""
    for k in range(2):
        for i in range(2):
            for l in range(2):
                for j in range(2):
                    at = 4 * (2 * k + i) + 2 * l + j
                    pair = BLOCKS + 4 * (4 * k + l) + 2 * i + j
                    above[at] += W[pair]
                    upper[at] = W[pair + 8]
                    lower[at] = W[pair + 32]
                    below[at] += W[pair + 40]


@kernel
def condense_planar(I, M, out_constraint, out):
    """Add B^T S (constraint residual) of every element to the forces: T condensed out."""
    for node in range(1, I[I_NODES]):
        if I[I[O_JOINT] + node] != 0:
            continue
        parent = I[I[O_PARENT] + node]
        h = M[I[O_EDGE] + node * EDGE_WORDS + E_LENGTH]
        B = view(M, I[O_GRADIENT] + 16 * node, 16)
        s = I[O_COMPLIANCE] + 3 * node
        r0 = out_constraint[2 * node]
        r1 = out_constraint[2 * node + 1]
        z0 = M[s] * r0 + M[s + 1] * r1
        z1 = M[s + 1] * r0 + M[s + 2] * r1
        for i in range(2):
            out[4 * parent + i] += z0 * B[4 * i] + z1 * B[8 + 4 * i]
            out[4 * parent + 2 + i] += h * (z0 * B[4 * i + 1] + z1 * B[9 + 4 * i])
            out[4 * node + i] += z0 * B[4 * i + 2] + z1 * B[10 + 4 * i]
            out[4 * node + 2 + i] += h * (z0 * B[4 * i + 3] + z1 * B[11 + 4 * i])


@kernel
def stretch_rate_planar(I, M, x, out):
    """Gradient B of the constraints times a vector x (nodes, 4): out (nodes, 2)."""
    for node in range(1, I[I_NODES]):
        out[2 * node] = 0.0
        out[2 * node + 1] = 0.0
        if I[I[O_JOINT] + node] != 0:
            continue
        parent = I[I[O_PARENT] + node]
        h = M[I[O_EDGE] + node * EDGE_WORDS + E_LENGTH]
        B = view(M, I[O_GRADIENT] + 16 * node, 16)
        r0 = 0.0
        r1 = 0.0
        for i in range(2):
            y0 = x[4 * parent + i]
            y1 = h * x[4 * parent + 2 + i]
            y2 = x[4 * node + i]
            y3 = h * x[4 * node + 2 + i]
            b = 4 * i
            c = 8 + 4 * i
            r0 += B[b] * y0 + B[b + 1] * y1 + B[b + 2] * y2 + B[b + 3] * y3
            r1 += B[c] * y0 + B[c + 1] * y1 + B[c + 2] * y2 + B[c + 3] * y3
        out[2 * node] = r0
        out[2 * node + 1] = r1
