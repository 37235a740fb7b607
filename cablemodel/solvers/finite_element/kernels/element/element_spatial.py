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
from cablemodel.solvers.shared.compile import inlined, view
from cablemodel.solvers.shared.environment import current_at
from cablemodel.solvers.shared.layout import POINT_WORDS, SPATIAL_PAIRS

TINY = 1e-30  # keeps |u_n| from dividing by zero

# Words of what stands at the Gauss points (ElementPoints) at which a component begins.
X, Y, Z = (POINT_WORDS * n for n in range(3))
XX, XY, XZ, YX, YY, YZ, ZX, ZY, ZZ = range(9)  # words of a row of component pairs

PAIRS = pair_kernels(3)
add_forces = force_kernel(3)
with_damping = damping_kernel(3)
slopes_at_points, second_at_points, values_at_points = cubic_kernels(3)
condense_spatial, stretch_rate_spatial = constraint_kernels(3)


@inlined
def element_current(I, M, points, x0, x1, h):
    """Water velocity at the Gauss points of an element whose heights are x0.., when it varies."""
    water = points.water
    flow = vector()
    for g in range(3):
        height = x0[2] * H0[g] + h * x0[5] * H1[g] + x1[2] * H2[g] + h * x1[5] * H3[g]
        current_at(I, M, height, flow)
        water[X + g] = flow[0]
        water[Y + g] = flow[1]
        water[Z + g] = flow[2]


@inlined
def geometry(points, x0, x1, h):
    """Stretch g and tangent t at the Gauss points."""
    stretch = points.stretch
    tangent = points.tangent
    slope = eight_numbers()
    slopes_at_points(x0, x1, h, slope)
    az = (x1[2] - x0[2]) * (1.0 / h)
    bz = x0[5]
    dz = x1[5]
    for g in range(4):
        px = slope[X + g]
        py = slope[Y + g]
        pz = az * D2[g] + bz * D1[g] + dz * D3[g]
        s = math.sqrt(px * px + py * py + pz * pz)
        inverse = 1.0 / s
        stretch[g] = s
        tangent[X + g] = px * inverse
        tangent[Y + g] = py * inverse
        tangent[Z + g] = pz * inverse


constraints_spatial = missed_kernel(3, geometry)
gradients_spatial = gradient_kernel(3, geometry, PAIRS[0])


@inlined
def axial_forces(points, t0, t1, t2):
    """Forces T t at the Gauss points, with the third strain mode's tension along P2."""
    tangent = points.tangent
    pull = points.pull
    for g in range(4):
        tension = t0 + t1 * P1[g] + t2 * P2[g]
        pull[X + g] = tension * tangent[X + g]
        pull[Y + g] = tension * tangent[Y + g]
        pull[Z + g] = tension * tangent[Z + g]


@inlined
def add_bending_forces(points, x0, x1, h, bending):
    """dW/dr' and dW/dr'' of the bending energy at the Gauss points."""
    stretch = points.stretch
    tangent = points.tangent
    pull = points.pull
    bend = points.bend
    ih = 1.0 / h
    second = eight_numbers()
    second_at_points(x0, x1, h, second)
    az = (x1[2] - x0[2]) * (1.0 / (h * h))
    bz = x0[5] * ih
    dz = x1[5] * ih
    for g in range(4):
        yx = second[X + g]
        yy = second[Y + g]
        yz = az * E2[g] + bz * E1[g] + dz * E3[g]
        tx = tangent[X + g]
        ty = tangent[Y + g]
        tz = tangent[Z + g]
        ig = 1.0 / stretch[g]
        b = yx * tx + yy * ty + yz * tz
        kx = (yx - b * tx) * ig
        ky = (yy - b * ty) * ig
        kz = (yz - b * tz) * ig
        kk = kx * kx + ky * ky + kz * kz
        c = bending * ig
        beta = b * ig
        pull[X + g] -= c * (kk * tx + beta * kx)
        pull[Y + g] -= c * (kk * ty + beta * ky)
        pull[Z + g] -= c * (kk * tz + beta * kz)
        bend[X + g] = ih * (c * kx)
        bend[Y + g] = ih * (c * ky)
        bend[Z + g] = ih * (c * kz)


@inlined
def load_forces(points, v0, v1, a0, a1, h, cn, ct, added):
    """Minus the drag (eq. 23), minus the tangential part of the added mass, per unit length."""
    water = points.water
    stretch = points.stretch
    tangent = points.tangent
    force = points.force
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
        tx = tangent[X + g]
        ty = tangent[Y + g]
        tz = tangent[Z + g]
        ux = water[X + g] - velocity[X + g]
        uy = water[Y + g] - velocity[Y + g]
        uz = water[Z + g] - (az * H0[g] + bz * H1[g] + cz * H2[g] + dz * H3[g])
        wx = acceleration[X + g]
        wy = acceleration[Y + g]
        wz = ez * H0[g] + fz * H1[g] + gz * H2[g] + hz * H3[g]
        root = math.sqrt(stretch[g])
        ut = ux * tx + uy * ty + uz * tz
        nx = ux - ut * tx
        ny = uy - ut * ty
        nz = uz - ut * tz
        un = math.sqrt(nx * nx + ny * ny + nz * nz)
        fn = root * cn * un
        along = root * ct * abs(ut) * ut + added * (wx * tx + wy * ty + wz * tz)
        force[X + g] = -h * (fn * nx + along * tx)
        force[Y + g] = -h * (fn * ny + along * ty)
        force[Z + g] = -h * (fn * nz + along * tz)


@inlined
def rank_two(row, diagonal, t0, t1, t2, a0, a1, a2, k0, k1, k2, b0, b1, b2):
    """Row of component pairs: diagonal 1 + t a^T + k b^T."""
    row[XX] = diagonal + t0 * a0 + k0 * b0
    row[XY] = t0 * a1 + k0 * b1
    row[XZ] = t0 * a2 + k0 * b2
    row[YX] = t1 * a0 + k1 * b0
    row[YY] = diagonal + t1 * a1 + k1 * b1
    row[YZ] = t1 * a2 + k1 * b2
    row[ZX] = t2 * a0 + k2 * b0
    row[ZY] = t2 * a1 + k2 * b1
    row[ZZ] = diagonal + t2 * a2 + k2 * b2


@inlined
def tangent_matrices(
    work,
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
    water = work.points.water
    stretch = work.points.stretch
    tangent = work.points.tangent
    ih = 1.0 / h
    ih2 = ih * ih
    for g in range(3):
        ig = 1.0 / stretch[g]
        t0 = tangent[X + g]
        t1 = tangent[Y + g]
        t2 = tangent[Z + g]
        tension = tension0 + tension1 * P1[g] + stabilising * P2[g]
        row = view(work.slope_rows, SPATIAL_PAIRS * g, SPATIAL_PAIRS)
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
                view(work.slope_rows, SPATIAL_PAIRS * (3 + g), SPATIAL_PAIRS),
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
                view(work.slope_rows, SPATIAL_PAIRS * (6 + g), SPATIAL_PAIRS),
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
            row = view(work.slope_rows, SPATIAL_PAIRS * (9 + g), SPATIAL_PAIRS)
            rank_one(row, c, t0, t1, t2)
        else:
            rank_one(row, p11, t0, t1, t2)
        if drag != 0:
            ux = water[X + g] - (
                v0[0] * H0[g] + v1[0] * H2[g] + h * (v0[3] * H1[g] + v1[3] * H3[g])
            )
            uy = water[Y + g] - (
                v0[1] * H0[g] + v1[1] * H2[g] + h * (v0[4] * H1[g] + v1[4] * H3[g])
            )
            uz = water[Z + g] - (
                v0[2] * H0[g] + v1[2] * H2[g] + h * (v0[5] * H1[g] + v1[5] * H3[g])
            )
            wx = a0[0] * H0[g] + a1[0] * H2[g] + h * (a0[3] * H1[g] + a1[3] * H3[g])
            wy = a0[1] * H0[g] + a1[1] * H2[g] + h * (a0[4] * H1[g] + a1[4] * H3[g])
            wz = a0[2] * H0[g] + a1[2] * H2[g] + h * (a0[5] * H1[g] + a1[5] * H3[g])
            root = math.sqrt(stretch[g])
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
                view(work.motion_rows, SPATIAL_PAIRS * g, SPATIAL_PAIRS),
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
                view(work.mixed_rows, SPATIAL_PAIRS * g, SPATIAL_PAIRS),
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
def rank_one(row, c, t0, t1, t2):
    """Row of component pairs: c (1 - t t^T)."""
    c0 = -c * t0
    c1 = -c * t1
    c2 = -c * t2
    row[XX] = c + c0 * t0
    row[XY] = c0 * t1
    row[XZ] = c0 * t2
    row[YX] = c1 * t0
    row[YY] = c + c1 * t1
    row[YZ] = c1 * t2
    row[ZX] = c2 * t0
    row[ZY] = c2 * t1
    row[ZZ] = c + c2 * t2


residual_spatial = residual_kernel(
    3,
    geometry,
    element_current,
    with_damping,
    axial_forces,
    add_bending_forces,
    load_forces,
    add_forces,
)
jacobian_spatial = jacobian_kernel(
    3, geometry, element_current, with_damping, tangent_matrices, PAIRS
)
