"""Mixed cubic Hermite element in a vertical plane: residual and Jacobian of a whole line.

The same formulas as in element_spatial.py, in the tangent t and the normal n = (-t_z, t_x): the
curvature k is a number and P = n n^T, which saves a root and most of the products. Node vector
(x, z, x', z').
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
from cablemodel.solvers.finite_element.kernels.line.products import values_of_two
from cablemodel.solvers.shared.access import vector
from cablemodel.solvers.shared.compile import inlined, own_numbers, view
from cablemodel.solvers.shared.environment import current_at
from cablemodel.solvers.shared.layout import PLANAR_PAIRS, POINT_WORDS

# Words of what stands at the Gauss points (ElementPoints) at which a component begins.
X, Z = 0, POINT_WORDS
TT, TN, NT, NN = (POINT_WORDS * n for n in range(4))  # of a tangent matrix in (t, n)
XX, XZ, ZX, ZZ = range(PLANAR_PAIRS)  # words of a row of component pairs

PAIRS = pair_kernels(2)
add_forces = force_kernel(2)
with_damping = damping_kernel(2)
slopes_at_points, second_at_points, values_at_points = cubic_kernels(2)
second_of_all = values_of_two((E0, E1, E2, E3))
by_places, by_slopes = values_of_two((H0, H2)), values_of_two((H1, H3))
four_numbers = own_numbers(4)
condense_planar, stretch_rate_planar = constraint_kernels(2)


@inlined
def element_current(I, M, points, x0, x1, h):
    """Water velocity at the Gauss points of an element, when it varies over depth."""
    water = points.water
    flow = vector()
    for g in range(3):
        height = x0[1] * H0[g] + h * x0[3] * H1[g] + x1[1] * H2[g] + h * x1[3] * H3[g]
        current_at(I, M, height, flow)
        water[X + g] = flow[0]
        water[Z + g] = flow[1]


@inlined
def geometry(points, x0, x1, h):
    """Stretch g and tangent t at the Gauss points."""
    stretch = points.stretch
    tangent = points.tangent
    slope = eight_numbers()
    slopes_at_points(x0, x1, h, slope)
    for g in range(4):
        px = slope[X + g]
        pz = slope[Z + g]
        s = math.sqrt(px * px + pz * pz)
        inverse = 1.0 / s
        stretch[g] = s
        tangent[X + g] = px * inverse
        tangent[Z + g] = pz * inverse


constraints_planar = missed_kernel(2, geometry)
gradients_planar = gradient_kernel(2, geometry, PAIRS[0])


@inlined
def axial_forces(points, t0, t1, t2):
    """Forces T t at the Gauss points, with the third strain mode's tension along P2."""
    tangent = points.tangent
    pull = points.pull
    for g in range(4):
        tension = t0 + t1 * P1[g] + t2 * P2[g]
        pull[X + g] = tension * tangent[X + g]
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
    for g in range(4):
        yx = second[X + g]
        yz = second[Z + g]
        tx = tangent[X + g]
        tz = tangent[Z + g]
        ig = 1.0 / stretch[g]
        beta = (yx * tx + yz * tz) * ig
        k = (yz * tx - yx * tz) * ig
        c = bending * ig * k
        pull[X + g] -= c * (k * tx - beta * tz)
        pull[Z + g] -= c * (k * tz + beta * tx)
        bend[X + g] = -ih * (c * tz)
        bend[Z + g] = ih * (c * tx)


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
    for g in range(4):
        tx = tangent[X + g]
        tz = tangent[Z + g]
        ux = water[X + g] - velocity[X + g]
        uz = water[Z + g] - velocity[Z + g]
        wx = acceleration[X + g]
        wz = acceleration[Z + g]
        root = math.sqrt(stretch[g])
        ut = ux * tx + uz * tz
        un = uz * tx - ux * tz
        along = root * ct * abs(ut) * ut + added * (wx * tx + wz * tz)
        across = root * cn * abs(un) * un
        force[X + g] = h * (across * tz - along * tx)
        force[Z + g] = -h * (across * tx + along * tz)


@inlined
def bending_matrices(work, x0, x1, h, tension0, tension1, t2, bending):
    """Jacobians of the forces along the cable and of its bending's, components along (t, n)."""
    stretch = work.points.stretch
    tangent = work.points.tangent
    a11 = work.a11
    a12 = work.a12
    a22 = work.a22
    ih = 1.0 / h
    ih2 = ih * ih
    unknowns = eight_numbers()
    second = eight_numbers()
    for i in range(2):
        unknowns[i] = x0[i] * ih2
        unknowns[2 + i] = x0[2 + i] * ih
        unknowns[4 + i] = x1[i] * ih2
        unknowns[6 + i] = x1[2 + i] * ih
    second_of_all(unknowns, second)
    for g in range(4):
        ig = 1.0 / stretch[g]
        tx = tangent[X + g]
        tz = tangent[Z + g]
        tension = tension0 + tension1 * P1[g] + t2 * P2[g]
        yx = second[X + g]
        yz = second[Z + g]
        beta = (yx * tx + yz * tz) * ig
        k = (yz * tx - yx * tz) * ig
        c1 = bending * ig * ig * ih
        c2 = c1 * ih
        c3 = c2 * ih
        a11[TT + g] = 3.0 * c1 * k * k
        a11[TN + g] = 3.0 * c1 * beta * k
        a11[NN + g] = ih * tension * ig + c1 * (beta * beta - 2.0 * k * k)
        a12[TN + g] = -2.0 * c2 * k
        a12[NT + g] = -c2 * k
        a12[NN + g] = -c2 * beta
        a22[NN + g] = c3


@inlined
def motion_at_points(x0, x1, h, out):
    """Velocity or acceleration at the Gauss points: the first component, then the second."""
    unknowns = four_numbers()
    turned = eight_numbers()
    for i in range(2):
        unknowns[i] = x0[i]
        unknowns[2 + i] = x1[i]
    by_places(unknowns, out)
    for i in range(2):
        unknowns[i] = x0[2 + i]
        unknowns[2 + i] = x1[2 + i]
    by_slopes(unknowns, turned)
    for n in range(8):
        out[n] += h * turned[n]


@inlined
def tangent_matrices(
    work, x0, x1, v0, v1, a0, a1, h, tension0, tension1, t2, bending, drag, cn, ct, added, ca, cv
):
    """Jacobians of the forces at the Gauss points, components along (t, n)."""
    water = work.points.water
    stretch = work.points.stretch
    tangent = work.points.tangent
    a00 = work.a00
    a01 = work.a01
    ih = 1.0 / h
    if bending != 0.0:
        bending_matrices(work, x0, x1, h, tension0, tension1, t2, bending)
    else:
        for g in range(4):
            tension = tension0 + tension1 * P1[g] + t2 * P2[g]
            work.a11[NN + g] = ih * tension * (1.0 / stretch[g])
    if drag == 0:
        return
    velocity = eight_numbers()
    acceleration = eight_numbers()
    motion_at_points(v0, v1, h, velocity)
    motion_at_points(a0, a1, h, acceleration)
    for g in range(4):
        ig = 1.0 / stretch[g]
        tx = tangent[X + g]
        tz = tangent[Z + g]
        ux = water[X + g] - velocity[X + g]
        uz = water[Z + g] - velocity[Z + g]
        wx = acceleration[X + g]
        wz = acceleration[Z + g]
        root = math.sqrt(stretch[g])
        ut = ux * tx + uz * tz
        un = uz * tx - ux * tz
        at = wx * tx + wz * tz
        an = wz * tx - wx * tz
        fn = root * cn * abs(un)
        ft = root * ct * abs(ut)
        a00[TT + g] = h * (2.0 * cv * ft - ca * added)
        a00[NN + g] = h * (2.0 * cv * fn)
        a01[TT + g] = -0.5 * ig * ft * ut
        a01[TN + g] = -ig * ((2.0 * ft - fn) * un + added * an)
        a01[NT + g] = -0.5 * ig * fn * un
        a01[NN + g] = -ig * (ft * ut - 2.0 * fn * ut + added * at)


@inlined
def spread_components(work, bends, drags):
    """Tangent matrices from (t, n) to rows of component pairs."""
    tangent = work.points.tangent
    a00 = work.a00
    a01 = work.a01
    a11 = work.a11
    a12 = work.a12
    a22 = work.a22
    for g in range(3):
        tx = tangent[X + g]
        tz = tangent[Z + g]
        xx = tx * tx
        xz = tx * tz
        zz = tz * tz
        nn = a11[NN + g]
        row = view(work.slope_rows, PLANAR_PAIRS * g, PLANAR_PAIRS)
        if bends:
            tt = a11[TT + g]
            tn = a11[TN + g]
            across = (tt - nn) * xz + tn * (xx - zz)
            row[XX] = tt * xx - 2.0 * tn * xz + nn * zz
            row[XZ] = across
            row[ZX] = across
            row[ZZ] = tt * zz + 2.0 * tn * xz + nn * xx
            tn = a12[TN + g]
            nt = a12[NT + g]
            nn = a12[NN + g]
            first = nn * zz - (tn + nt) * xz
            last = nn * xx + (tn + nt) * xz
            upper = tn * xx - nt * zz - nn * xz
            lower = nt * xx - tn * zz - nn * xz
            row = view(work.slope_rows, PLANAR_PAIRS * (3 + g), PLANAR_PAIRS)
            row[XX] = first
            row[XZ] = upper
            row[ZX] = lower
            row[ZZ] = last
            row = view(work.slope_rows, PLANAR_PAIRS * (6 + g), PLANAR_PAIRS)
            row[XX] = first
            row[XZ] = lower
            row[ZX] = upper
            row[ZZ] = last
            nn = a22[NN + g]
            row = view(work.slope_rows, PLANAR_PAIRS * (9 + g), PLANAR_PAIRS)
            row[XX] = nn * zz
            row[XZ] = -nn * xz
            row[ZX] = -nn * xz
            row[ZZ] = nn * xx
        else:
            row[XX] = nn * zz
            row[XZ] = -nn * xz
            row[ZX] = -nn * xz
            row[ZZ] = nn * xx
        if drags:
            tt = a00[TT + g]
            nn = a00[NN + g]
            across = (tt - nn) * xz
            row = view(work.motion_rows, PLANAR_PAIRS * g, PLANAR_PAIRS)
            row[XX] = tt * xx + nn * zz
            row[XZ] = across
            row[ZX] = across
            row[ZZ] = tt * zz + nn * xx
            tt = a01[TT + g]
            tn = a01[TN + g]
            nt = a01[NT + g]
            nn = a01[NN + g]
            row = view(work.mixed_rows, PLANAR_PAIRS * g, PLANAR_PAIRS)
            row[XX] = tt * xx - (tn + nt) * xz + nn * zz
            row[XZ] = (tt - nn) * xz + tn * xx - nt * zz
            row[ZX] = (tt - nn) * xz + nt * xx - tn * zz
            row[ZZ] = tt * zz + (tn + nt) * xz + nn * xx


@inlined
def tangent_rows(
    work, x0, x1, v0, v1, a0, a1, h, tension0, tension1, t2, bending, drag, cn, ct, added, ca, cv
):
    """Jacobians of the forces at the Gauss points as rows of component pairs."""
    tangent_matrices(
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
        t2,
        bending,
        drag,
        cn,
        ct,
        added,
        ca,
        cv,
    )
    spread_components(work, bending != 0.0, drag != 0)


residual_planar = residual_kernel(
    2,
    geometry,
    element_current,
    with_damping,
    axial_forces,
    add_bending_forces,
    load_forces,
    add_forces,
)
jacobian_planar = jacobian_kernel(2, geometry, element_current, with_damping, tangent_rows, PAIRS)
