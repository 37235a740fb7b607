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
from cablemodel.solvers.shared.compile import inlined, own_numbers
from cablemodel.solvers.shared.environment import current_at

# Slots of four words in the Gauss workspace.
CX, CZ = 0, 4  # water velocity
G, TX, TZ = 12, 16, 20
FX, FZ = 28, 32  # conjugate to r, times h
PX, PZ = 40, 44  # conjugate to r'
QX, QZ = 52, 56  # conjugate to r'', over h
TT, TN, NT, NN = 0, 4, 8, 12  # components of a tangent matrix in (t, n)
JACOBIAN = 80  # 6 groups of 4 slots of 4: A00, A01, A11, A12, A21, A22
# Rows of four words: the pairs of components xx, xz, zx, zz.
ROWS = JACOBIAN + 96  # at each Gauss point: A11, A12, A21, A22, then A00, then A01
SUMS = ROWS + 72  # over the Gauss points: see element_pairs.py

PAIRS = pair_kernels(2, 4, TX, SUMS)
add_forces = force_kernel(2, FX, PX, QX)
with_damping = damping_kernel(2, TX)
slopes_at_points, second_at_points, values_at_points = cubic_kernels(2)
second_of_all = values_of_two((E0, E1, E2, E3))
by_places, by_slopes = values_of_two((H0, H2)), values_of_two((H1, H3))
four_numbers = own_numbers(4)
condense_planar, stretch_rate_planar = constraint_kernels(2)


@inlined
def element_current(I, M, W, x0, x1, h):
    """Water velocity at the Gauss points of an element, when it varies over depth."""
    flow = vector()
    for g in range(3):
        height = x0[1] * H0[g] + h * x0[3] * H1[g] + x1[1] * H2[g] + h * x1[3] * H3[g]
        current_at(I, M, height, flow)
        W[CX + g] = flow[0]
        W[CZ + g] = flow[1]


@inlined
def geometry(W, x0, x1, h):
    """Stretch g and tangent t at the Gauss points."""
    slope = eight_numbers()
    slopes_at_points(x0, x1, h, slope)
    for g in range(4):
        px = slope[g]
        pz = slope[4 + g]
        s = math.sqrt(px * px + pz * pz)
        inverse = 1.0 / s
        W[G + g] = s
        W[TX + g] = px * inverse
        W[TZ + g] = pz * inverse


constraints_planar = missed_kernel(2, geometry, G)
gradients_planar = gradient_kernel(2, geometry, PAIRS[0])


@inlined
def axial_forces(W, t0, t1, t2):
    """Forces T t at the Gauss points, with the third strain mode's tension along P2."""
    for g in range(4):
        tension = t0 + t1 * P1[g] + t2 * P2[g]
        W[PX + g] = tension * W[TX + g]
        W[PZ + g] = tension * W[TZ + g]


@inlined
def add_bending_forces(W, x0, x1, h, bending):
    """dW/dr' and dW/dr'' of the bending energy at the Gauss points."""
    ih = 1.0 / h
    second = eight_numbers()
    second_at_points(x0, x1, h, second)
    for g in range(4):
        yx = second[g]
        yz = second[4 + g]
        tx = W[TX + g]
        tz = W[TZ + g]
        ig = 1.0 / W[G + g]
        beta = (yx * tx + yz * tz) * ig
        k = (yz * tx - yx * tz) * ig
        c = bending * ig * k
        W[PX + g] -= c * (k * tx - beta * tz)
        W[PZ + g] -= c * (k * tz + beta * tx)
        W[QX + g] = -ih * (c * tz)
        W[QZ + g] = ih * (c * tx)


@inlined
def load_forces(W, v0, v1, a0, a1, h, cn, ct, added):
    """Minus the drag (eq. 23), minus the tangential part of the added mass, per unit length."""
    velocity = eight_numbers()
    acceleration = eight_numbers()
    values_at_points(v0, v1, h, velocity)
    values_at_points(a0, a1, h, acceleration)
    for g in range(4):
        tx = W[TX + g]
        tz = W[TZ + g]
        ux = W[CX + g] - velocity[g]
        uz = W[CZ + g] - velocity[4 + g]
        wx = acceleration[g]
        wz = acceleration[4 + g]
        root = math.sqrt(W[G + g])
        ut = ux * tx + uz * tz
        un = uz * tx - ux * tz
        along = root * ct * abs(ut) * ut + added * (wx * tx + wz * tz)
        across = root * cn * abs(un) * un
        W[FX + g] = h * (across * tz - along * tx)
        W[FZ + g] = -h * (across * tx + along * tz)


@inlined
def bending_matrices(W, x0, x1, h, tension0, tension1, t2, bending):
    """Jacobians of the forces along the cable and of its bending's, components along (t, n)."""
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
        ig = 1.0 / W[G + g]
        tx = W[TX + g]
        tz = W[TZ + g]
        tension = tension0 + tension1 * P1[g] + t2 * P2[g]
        yx = second[g]
        yz = second[4 + g]
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
    W, x0, x1, v0, v1, a0, a1, h, tension0, tension1, t2, bending, drag, cn, ct, added, ca, cv
):
    """Jacobians of the forces at the Gauss points, components along (t, n)."""
    ih = 1.0 / h
    if bending != 0.0:
        bending_matrices(W, x0, x1, h, tension0, tension1, t2, bending)
    else:
        for g in range(4):
            tension = tension0 + tension1 * P1[g] + t2 * P2[g]
            W[JACOBIAN + 32 + NN + g] = ih * tension * (1.0 / W[G + g])
    if drag == 0:
        return
    velocity = eight_numbers()
    acceleration = eight_numbers()
    motion_at_points(v0, v1, h, velocity)
    motion_at_points(a0, a1, h, acceleration)
    for g in range(4):
        ig = 1.0 / W[G + g]
        tx = W[TX + g]
        tz = W[TZ + g]
        ux = W[CX + g] - velocity[g]
        uz = W[CZ + g] - velocity[4 + g]
        wx = acceleration[g]
        wz = acceleration[4 + g]
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
def tangent_rows(
    W, x0, x1, v0, v1, a0, a1, h, tension0, tension1, t2, bending, drag, cn, ct, added, ca, cv
):
    """Jacobians of the forces at the Gauss points as rows of component pairs."""
    tangent_matrices(
        W, x0, x1, v0, v1, a0, a1, h, tension0, tension1, t2, bending, drag, cn, ct, added, ca, cv
    )
    spread_components(W, bending != 0.0, drag != 0)


residual_planar = residual_kernel(
    2,
    G,
    geometry,
    element_current,
    with_damping,
    axial_forces,
    add_bending_forces,
    load_forces,
    add_forces,
)
jacobian_planar = jacobian_kernel(
    2, 4, G, ROWS, SUMS, geometry, element_current, with_damping, tangent_rows, PAIRS
)
