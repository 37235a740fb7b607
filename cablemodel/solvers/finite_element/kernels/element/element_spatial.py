"""Mixed cubic Hermite element in three dimensions: residual and Jacobian of a whole line.

Unknowns of a node: r, d = r' (6 words). Unknowns of an element: tension T0 + T1 P1(x). Weak form

    int (m a . dr + T t . dr' + bending - loads . dr) ds = 0,   int (|r'| - 1 - strain(T)) dT ds = 0

with t = r'/|r'|. Bending energy EI/2 |t'|^2 per unit of unstretched length, so that the internal
force along t is exactly T. Loads: Sun & Leonard 1998, eqs. 22 and 23, with u the velocity of the
water relative to the cable. In comments g = |r'|, y = r'', P = I - t t^T, k = P y / g, b = t . y.
"""

import math

from cablemodel.solvers.finite_element.kernels.element.assembly import (
    jacobian_kernel,
    residual_kernel,
)
from cablemodel.solvers.finite_element.kernels.element.cubic import cubic_kernels, eight_numbers
from cablemodel.solvers.finite_element.kernels.element.damping import damping_kernel
from cablemodel.solvers.finite_element.kernels.element.element_pairs import (
    constraint_kernels,
    force_kernel,
    gradient_kernel,
    missed_kernel,
    pair_kernels,
)
from cablemodel.solvers.finite_element.kernels.element.tables import (
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
    P1,
    P2,
)
from cablemodel.solvers.shared.access import vector
from cablemodel.solvers.shared.compile import inlined
from cablemodel.solvers.shared.environment import current_at

TINY = 1e-30  # keeps |u_n| from dividing by zero

# Slots of four words in the Gauss workspace.
CX, CY, CZ = 0, 4, 8  # water velocity
G, TX, TY, TZ = 12, 16, 20, 24
FX, FY, FZ = 28, 32, 36  # conjugate to r, times h
PX, PY, PZ = 40, 44, 48  # conjugate to r'
QX, QY, QZ = 52, 56, 60  # conjugate to r'', over h
# Rows of ten words: the nine pairs of components xx, xy, ... zz, and one unused.
ROWS = 80  # at each Gauss point: A11, A12, A21, A22, then A00, then A01
ROWS_12, ROWS_21, ROWS_22 = ROWS + 30, ROWS + 60, ROWS + 90
ROWS_00, ROWS_01 = ROWS + 120, ROWS + 150
SUMS = ROWS + 180  # over the Gauss points: see element_pairs.py

PAIRS = pair_kernels(3, 10, TX, SUMS)
add_forces = force_kernel(3, FX, PX, QX)
with_damping = damping_kernel(3, TX)
slopes_at_points, second_at_points, values_at_points = cubic_kernels(3)
condense_spatial, stretch_rate_spatial = constraint_kernels(3)


@inlined
def element_current(I, M, W, x0, x1, h):
    """Water velocity at the Gauss points of an element whose heights are x0.., when it varies."""
    flow = vector()
    for g in range(3):
        height = x0[2] * H0[g] + h * x0[5] * H1[g] + x1[2] * H2[g] + h * x1[5] * H3[g]
        current_at(I, M, height, flow)
        W[CX + g] = flow[0]
        W[CY + g] = flow[1]
        W[CZ + g] = flow[2]


@inlined
def geometry(W, x0, x1, h):
    """Stretch g and tangent t at the Gauss points."""
    slope = eight_numbers()
    slopes_at_points(x0, x1, h, slope)
    az = (x1[2] - x0[2]) * (1.0 / h)
    bz = x0[5]
    dz = x1[5]
    for g in range(4):
        px = slope[g]
        py = slope[4 + g]
        pz = az * D2[g] + bz * D1[g] + dz * D3[g]
        s = math.sqrt(px * px + py * py + pz * pz)
        inverse = 1.0 / s
        W[G + g] = s
        W[TX + g] = px * inverse
        W[TY + g] = py * inverse
        W[TZ + g] = pz * inverse


constraints_spatial = missed_kernel(3, geometry, G)
gradients_spatial = gradient_kernel(3, geometry, PAIRS[0])


@inlined
def axial_forces(W, t0, t1, t2):
    """Forces T t at the Gauss points, with the third strain mode's tension along P2."""
    for g in range(4):
        tension = t0 + t1 * P1[g] + t2 * P2[g]
        W[PX + g] = tension * W[TX + g]
        W[PY + g] = tension * W[TY + g]
        W[PZ + g] = tension * W[TZ + g]


@inlined
def add_bending_forces(W, x0, x1, h, bending):
    """dW/dr' and dW/dr'' of the bending energy at the Gauss points."""
    ih = 1.0 / h
    second = eight_numbers()
    second_at_points(x0, x1, h, second)
    az = (x1[2] - x0[2]) * (1.0 / (h * h))
    bz = x0[5] * ih
    dz = x1[5] * ih
    for g in range(4):
        yx = second[g]
        yy = second[4 + g]
        yz = az * E2[g] + bz * E1[g] + dz * E3[g]
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
        W[QX + g] = ih * (c * kx)
        W[QY + g] = ih * (c * ky)
        W[QZ + g] = ih * (c * kz)


@inlined
def load_forces(W, v0, v1, a0, a1, h, cn, ct, added):
    """Minus the drag (eq. 23), minus the tangential part of the added mass, per unit length."""
    velocity = eight_numbers()
    acceleration = eight_numbers()
    values_at_points(v0, v1, h, velocity)
    values_at_points(a0, a1, h, acceleration)
    az = v0[2]
    bz = h * v0[5]
    cz = v1[2]
    dz = h * v1[5]
    ez = a0[2]
    fz = h * a0[5]
    gz = a1[2]
    hz = h * a1[5]
    for g in range(4):
        tx = W[TX + g]
        ty = W[TY + g]
        tz = W[TZ + g]
        ux = W[CX + g] - velocity[g]
        uy = W[CY + g] - velocity[4 + g]
        uz = W[CZ + g] - (az * H0[g] + bz * H1[g] + cz * H2[g] + dz * H3[g])
        wx = acceleration[g]
        wy = acceleration[4 + g]
        wz = ez * H0[g] + fz * H1[g] + gz * H2[g] + hz * H3[g]
        root = math.sqrt(W[G + g])
        ut = ux * tx + uy * ty + uz * tz
        nx = ux - ut * tx
        ny = uy - ut * ty
        nz = uz - ut * tz
        un = math.sqrt(nx * nx + ny * ny + nz * nz)
        fn = root * cn * un
        along = root * ct * abs(ut) * ut + added * (wx * tx + wy * ty + wz * tz)
        W[FX + g] = -h * (fn * nx + along * tx)
        W[FY + g] = -h * (fn * ny + along * ty)
        W[FZ + g] = -h * (fn * nz + along * tz)


@inlined
def rank_two(W, row, diagonal, t0, t1, t2, a0, a1, a2, k0, k1, k2, b0, b1, b2):
    """Row of component pairs: diagonal 1 + t a^T + k b^T."""
    W[row] = diagonal + t0 * a0 + k0 * b0
    W[row + 1] = t0 * a1 + k0 * b1
    W[row + 2] = t0 * a2 + k0 * b2
    W[row + 3] = t1 * a0 + k1 * b0
    W[row + 4] = diagonal + t1 * a1 + k1 * b1
    W[row + 5] = t1 * a2 + k1 * b2
    W[row + 6] = t2 * a0 + k2 * b0
    W[row + 7] = t2 * a1 + k2 * b1
    W[row + 8] = diagonal + t2 * a2 + k2 * b2


@inlined
def tangent_matrices(
    W,
    x0,
    x1,
    v0,
    v1,
    a0,
    a1,
    h,
    tension0,
    tension1,
    stabilising,
    bending,
    drag,
    cn,
    ct,
    added,
    ca,
    cv,
):
    """Jacobians of the forces at the Gauss points into the rows A11, A12, A21, A22, A00, A01.

    With c = EI/g^2, beta = b/g, P = 1 - t t^T (derivation in docs/theory.md):
      A22 = c P; A12 = -c (k t^T + 2 t k^T + beta P), A21 its transpose;
      A11 = (T/g + c (beta^2 - k.k)) P + c (3 k.k t t^T + 3 beta (k t^T + t k^T) - k k^T).
    All are a multiple of 1 and two dyads. They are scaled for slopes d h and a length h.
    """
    ih = 1.0 / h
    ih2 = ih * ih
    for g in range(3):
        ig = 1.0 / W[G + g]
        t0 = W[TX + g]
        t1 = W[TY + g]
        t2 = W[TZ + g]
        tension = tension0 + tension1 * P1[g] + stabilising * P2[g]
        row = ROWS + 10 * g
        p11 = ih * tension * ig
        if bending != 0.0:
            y0 = (x0[0] * E0[g] + x1[0] * E2[g]) * ih2 + (x0[3] * E1[g] + x1[3] * E3[g]) * ih
            y1 = (x0[1] * E0[g] + x1[1] * E2[g]) * ih2 + (x0[4] * E1[g] + x1[4] * E3[g]) * ih
            y2 = (x0[2] * E0[g] + x1[2] * E2[g]) * ih2 + (x0[5] * E1[g] + x1[5] * E3[g]) * ih
            b = y0 * t0 + y1 * t1 + y2 * t2
            k0 = (y0 - b * t0) * ig
            k1 = (y1 - b * t1) * ig
            k2 = (y2 - b * t2) * ig
            kk = k0 * k0 + k1 * k1 + k2 * k2
            c = bending * ig * ig * ih
            beta = b * ig
            p11 += c * (beta * beta - kk)
            f = 3.0 * c * kk - p11
            q = 3.0 * c * beta
            rank_two(
                W,
                row,
                p11,
                t0,
                t1,
                t2,
                f * t0 + q * k0,
                f * t1 + q * k1,
                f * t2 + q * k2,
                k0,
                k1,
                k2,
                q * t0 - c * k0,
                q * t1 - c * k1,
                q * t2 - c * k2,
            )
            c *= ih
            q = c * beta
            e0 = c * t0
            e1 = c * t1
            e2 = c * t2
            m0 = q * t0 - c * k0
            m1 = q * t1 - c * k1
            m2 = q * t2 - c * k2
            rank_two(
                W,
                row + ROWS_12 - ROWS,
                -q,
                t0,
                t1,
                t2,
                m0 - c * k0,
                m1 - c * k1,
                m2 - c * k2,
                k0,
                k1,
                k2,
                -e0,
                -e1,
                -e2,
            )
            rank_two(
                W,
                row + ROWS_21 - ROWS,
                -q,
                t0,
                t1,
                t2,
                m0,
                m1,
                m2,
                k0,
                k1,
                k2,
                -2.0 * e0,
                -2.0 * e1,
                -2.0 * e2,
            )
            c *= ih
            rank_one(W, row + ROWS_22 - ROWS, c, t0, t1, t2)
        else:
            rank_one(W, row, p11, t0, t1, t2)
        if drag != 0:
            ux = W[CX + g] - (v0[0] * H0[g] + v1[0] * H2[g] + h * (v0[3] * H1[g] + v1[3] * H3[g]))
            uy = W[CY + g] - (v0[1] * H0[g] + v1[1] * H2[g] + h * (v0[4] * H1[g] + v1[4] * H3[g]))
            uz = W[CZ + g] - (v0[2] * H0[g] + v1[2] * H2[g] + h * (v0[5] * H1[g] + v1[5] * H3[g]))
            wx = a0[0] * H0[g] + a1[0] * H2[g] + h * (a0[3] * H1[g] + a1[3] * H3[g])
            wy = a0[1] * H0[g] + a1[1] * H2[g] + h * (a0[4] * H1[g] + a1[4] * H3[g])
            wz = a0[2] * H0[g] + a1[2] * H2[g] + h * (a0[5] * H1[g] + a1[5] * H3[g])
            root = math.sqrt(W[G + g])
            ut = ux * t0 + uy * t1 + uz * t2
            n0 = ux - ut * t0
            n1 = uy - ut * t1
            n2 = uz - ut * t2
            un = math.sqrt(n0 * n0 + n1 * n1 + n2 * n2)
            iun = 1.0 / max(un, TINY)
            at = wx * t0 + wy * t1 + wz * t2
            fn = root * cn * un
            ft = root * ct * abs(ut)
            # d(-drag)/dv = + dF/du; its parts along 1, n n^T and t t^T.
            d_p = h * cv * fn
            d_nn = d_p * iun * iun
            d_tt = h * (2.0 * cv * ft - ca * added) - d_p
            rank_two(
                W,
                row + ROWS_00 - ROWS,
                d_p,
                t0,
                t1,
                t2,
                d_tt * t0,
                d_tt * t1,
                d_tt * t2,
                n0,
                n1,
                n2,
                d_nn * n0,
                d_nn * n1,
                d_nn * n2,
            )
            # d(-drag - added)/dr': see load_forces; n is normal to t, so t n^T and P suffice.
            e_p = -ig * (ft * ut - fn * ut + added * at)
            e_nn = ig * fn * ut * iun * iun
            e_tn = -ig * (2.0 * ft - fn)
            # The loads are per unit of unstretched length: root(g) is in fn and ft.
            along = added * ig
            e_tt = -0.5 * ig * ft * ut - e_p + along * at
            e_nt = -0.5 * ig * fn
            rank_two(
                W,
                row + ROWS_01 - ROWS,
                e_p,
                t0,
                t1,
                t2,
                e_tt * t0 + e_tn * n0 - along * wx,
                e_tt * t1 + e_tn * n1 - along * wy,
                e_tt * t2 + e_tn * n2 - along * wz,
                n0,
                n1,
                n2,
                e_nt * t0 + e_nn * n0,
                e_nt * t1 + e_nn * n1,
                e_nt * t2 + e_nn * n2,
            )


@inlined
def rank_one(W, row, c, t0, t1, t2):
    """Row of component pairs: c (1 - t t^T)."""
    c0 = -c * t0
    c1 = -c * t1
    c2 = -c * t2
    W[row] = c + c0 * t0
    W[row + 1] = c0 * t1
    W[row + 2] = c0 * t2
    W[row + 3] = c1 * t0
    W[row + 4] = c + c1 * t1
    W[row + 5] = c1 * t2
    W[row + 6] = c2 * t0
    W[row + 7] = c2 * t1
    W[row + 8] = c + c2 * t2


residual_spatial = residual_kernel(
    3,
    G,
    geometry,
    element_current,
    with_damping,
    axial_forces,
    add_bending_forces,
    load_forces,
    add_forces,
)
jacobian_spatial = jacobian_kernel(
    3, 10, G, ROWS, SUMS, geometry, element_current, with_damping, tangent_matrices, PAIRS
)
