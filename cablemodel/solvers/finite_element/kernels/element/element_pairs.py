"""What the elements in a plane and in space do alike: sums over pairs, and the constraints.

The Jacobian's sums over the Gauss points stand in rows, one for each pair of shape functions or of
their slopes, with a word for every pair of components (see tables.py for the pairs), in the scratch
memory that is declared in layout.py: a PlanarElement or a SpatialElement, `work`, whose first part,
`points`, is at the Gauss points.
"""

from typing import Any

from cablemodel.solvers.finite_element.kernels.element.strain import (
    may_be_slack,
    moments_aside,
    strain_in,
)
from cablemodel.solvers.finite_element.kernels.element.stretch import take_rests
from cablemodel.solvers.finite_element.kernels.element.tables import (
    LOAD,
    MASS,
    MASS_WD,
    P1,
    P2,
    WD,
    WE,
    WEIGHT,
    WEIGHT_P1,
    WEIGHT_P2,
    WH,
)
from cablemodel.solvers.finite_element.kernels.line.products import (
    matrix_vector,
    scatter_pairs,
    sums_of_two,
    two_products,
)
from cablemodel.solvers.shared.access import (
    compliance_of,
    edge_of,
    element_points,
    header,
    planar_element,
    scalars,
    spatial_element,
)
from cablemodel.solvers.shared.compile import inlined, kernel, own_numbers, view
from cablemodel.solvers.shared.layout import PLANAR_PAIRS, POINT_WORDS, SPATIAL_PAIRS

ELEMENT_OF = {2: planar_element, 3: spatial_element}
"""By the dimension: ELEMENT_OF[dimension](I, M, 0) is the scratch memory of an element."""

PAIR_WORDS = {2: PLANAR_PAIRS, 3: SPATIAL_PAIRS}
"""By the dimension: words of a row."""


@inlined
def third_tension(points, edge):
    """Tension of an element's third strain mode [N], by |r'| at its Gauss points."""
    e2 = 0.0
    for g in range(3):
        e2 += WEIGHT_P2[g] * (points.stretch[g] - 1.0)
    return 5.0 * edge.stabilisation * e2 - edge.third_rest


@inlined
def strain_missed(M, points, edge, t0, t1):
    """Means over an element of |r'| - 1 - strain under the tension t0 + t1 P1, alone and times
    P1."""
    r0 = 0.0
    r1 = 0.0
    if edge.strain_terms == 1.0:
        for g in range(3):
            r0 += WEIGHT[g] * (points.stretch[g] - 1.0)
            r1 += WEIGHT_P1[g] * (points.stretch[g] - 1.0)
        c = edge.compliance
        r0 -= c * t0
        r1 -= c * t1 * (1.0 / 3.0)
    else:
        for g in range(3):
            strain, _slope = strain_in(M, edge, t0 + t1 * P1[g])
            r0 += WEIGHT[g] * (points.stretch[g] - 1.0 - strain)
            r1 += WEIGHT_P1[g] * (points.stretch[g] - 1.0 - strain)
    if may_be_slack(edge, t0, t1):
        aside0, aside1, _c00, _c01, _c11 = moments_aside(edge, t0, t1)
        r0 -= aside0
        r1 -= aside1
    return r0, r1


@inlined
def invert_compliance(M, edge, t0, t1, stored):
    """Inverse S of an element's compliance under the tension t0 + t1 P1: its three components,
    which are stored too (InverseCompliance)."""
    h = edge.length
    c00 = 0.0
    c01 = 0.0
    c11 = 0.0
    if edge.strain_terms == 1.0:
        c00 = h * edge.compliance
        c11 = c00 / 3.0
    else:
        for g in range(3):
            _strain, slope = strain_in(M, edge, t0 + t1 * P1[g])
            c00 += h * WEIGHT[g] * slope
            c01 += h * WEIGHT_P1[g] * slope
            c11 += h * WEIGHT_P1[g] * P1[g] * slope
    if may_be_slack(edge, t0, t1):
        _r0, _r1, d00, d01, d11 = moments_aside(edge, t0, t1)
        c00 += h * d00
        c01 += h * d01
        c11 += h * d11
    determinant = 1.0 / (c00 * c11 - c01 * c01)
    stored.s00 = c11 * determinant
    stored.s01 = -c01 * determinant
    stored.s11 = c00 * determinant
    return stored.s00, stored.s01, stored.s11


def missed_kernel(dimension: int, geometry: Any) -> Any:
    """constraints(I, M, q, tension, out): of all elements of this dimension, as their residuals
    have them."""
    size = 2 * dimension

    @kernel
    def constraints(I, M, q, tension, out):
        head = header(I)
        points = element_points(I, M, 0)
        for node in range(1, head.nodes):
            out[2 * node] = 0.0
            out[2 * node + 1] = 0.0
            if I[head.joint + node] != 0:
                continue
            edge = edge_of(I, M, node)
            h = edge.length
            parent = I[head.parent + node]
            geometry(points, view(q, size * parent, size), view(q, size * node, size), h)
            r0, r1 = strain_missed(M, points, edge, tension[2 * node], tension[2 * node + 1])
            out[2 * node] = h * r0
            out[2 * node + 1] = h * r1
        if scalars(M).stiffened != 0.0:
            take_rests(I, M, out)

    return constraints


def gradient_kernel(dimension: int, geometry: Any, constraint_gradient: Any) -> Any:
    """gradients(I, M, q, tension): those of the constraints, and S, as a Jacobian stores them."""
    size = 2 * dimension
    words = 4 * size
    element_of = ELEMENT_OF[dimension]

    @kernel
    def gradients(I, M, q, tension):
        head = header(I)
        work = element_of(I, M, 0)
        for node in range(1, head.nodes):
            if I[head.joint + node] != 0:
                continue
            edge = edge_of(I, M, node)
            h = edge.length
            parent = I[head.parent + node]
            geometry(work.points, view(q, size * parent, size), view(q, size * node, size), h)
            constraint_gradient(work, h, view(M, head.gradient + words * node, words))
            stiffness = compliance_of(I, M, node)
            invert_compliance(M, edge, tension[2 * node], tension[2 * node + 1], stiffness)

    return gradients


def pair_kernels(dimension: int) -> tuple[Any, Any, Any, Any]:
    """constraint_gradient, add_tension, combine and scatter for elements of this dimension."""
    second = 4 * dimension  # words of a gradient
    size = 2 * dimension
    row = PAIR_WORDS[dimension]

    @inlined
    def constraint_gradient(work, h, stored):
        """Gradients of the constraints and of the stabilising mode by shape function.

        The constraints' are stored by the unknowns too (4 size): rows 0 and 1 for the parent's,
        then for the child's.
        """
        tangent = work.points.tangent
        gradient = work.gradient
        for i in range(dimension):
            at = 4 * i
            for k in range(4):
                w0 = tangent[POINT_WORDS * i] * WD[0, k]
                w1 = tangent[POINT_WORDS * i + 1] * WD[1, k]
                w2 = tangent[POINT_WORDS * i + 2] * WD[2, k]
                gradient[at + k] = w0 + w1 + w2
                gradient[at + second + k] = w0 * P1[0] + w1 * P1[1] + w2 * P1[2]
                gradient[at + 2 * second + k] = w0 * P2[0] + w1 * P2[1] + w2 * P2[2]
            for c in range(2):
                to = size * c + i
                stored[to] = gradient[at + second * c]
                stored[to + dimension] = h * gradient[at + second * c + 1]
                stored[to + 2 * size] = gradient[at + second * c + 2]
                stored[to + 2 * size + dimension] = h * gradient[at + second * c + 3]

    @inlined
    def add_tension(work, s00, s01, s11, s22):
        """Add what condensing T out leaves, and the stabilisation, to the six pairs of slopes."""
        gradient = work.gradient
        sums = work.slope_sums
        for i in range(dimension):
            for a in range(1, 4):
                at = 4 * i + a
                c = s00 * gradient[at] + s01 * gradient[at + second]
                d = s01 * gradient[at] + s11 * gradient[at + second]
                e = s22 * gradient[at + 2 * second]
                for j in range(dimension):
                    pair = dimension * i + j
                    for b in range(a, 4):
                        # Pairs (1, 1), (2, 2), (3, 3) are rows 0, 1, 2; (1, 2), (1, 3), (2, 3)
                        # are rows 3, 4, 5.
                        to = pair + row * (a - 1 if a == b else a + b)
                        at = 4 * j + b
                        value = c * gradient[at] + d * gradient[at + second]
                        sums[to] += value + e * gradient[at + 2 * second]

    @inlined
    def combine(work, h):
        """All sixteen pairs of shape functions from the sums, for all pairs of components at once.

        Function 0 has minus the slope of function 2; slope unknowns are scaled by h.
        """
        slopes = work.slope_sums
        motions = work.motion_sums
        mixed = work.mixed_sums
        turned = work.turned
        blocks = work.blocks
        for i in range(dimension):
            for j in range(dimension):
                for k in range(3):
                    pair = slopes[row * (3 + k) + dimension * j + i]
                    turned[row * k + dimension * i + j] = pair
        h2 = h * h
        for p in range(row):
            k11 = slopes[p]
            k22 = slopes[row + p]
            k33 = slopes[2 * row + p]
            k12 = slopes[3 * row + p]
            k13 = slopes[4 * row + p]
            k23 = slopes[5 * row + p]
            k21 = turned[p]
            k31 = turned[row + p]
            k32 = turned[2 * row + p]
            blocks[p] = k22 + motions[p] - mixed[row + p]
            blocks[row + p] = h * (motions[4 * row + p] + mixed[p] - k21)
            blocks[2 * row + p] = motions[5 * row + p] + mixed[row + p] - k22
            blocks[3 * row + p] = h * (motions[6 * row + p] + mixed[2 * row + p] - k23)
            blocks[4 * row + p] = h * (motions[4 * row + p] - mixed[4 * row + p] - k12)
            blocks[5 * row + p] = h2 * (k11 + motions[row + p] + mixed[3 * row + p])
            blocks[6 * row + p] = h * (k12 + motions[7 * row + p] + mixed[4 * row + p])
            blocks[7 * row + p] = h2 * (k13 + motions[8 * row + p] + mixed[5 * row + p])
            blocks[8 * row + p] = motions[5 * row + p] - mixed[7 * row + p] - k22
            blocks[9 * row + p] = h * (k21 + motions[7 * row + p] + mixed[6 * row + p])
            blocks[10 * row + p] = k22 + motions[2 * row + p] + mixed[7 * row + p]
            blocks[11 * row + p] = h * (k23 + motions[9 * row + p] + mixed[8 * row + p])
            blocks[12 * row + p] = h * (motions[6 * row + p] - mixed[10 * row + p] - k32)
            blocks[13 * row + p] = h2 * (k31 + motions[8 * row + p] + mixed[9 * row + p])
            blocks[14 * row + p] = h * (k32 + motions[9 * row + p] + mixed[10 * row + p])
            blocks[15 * row + p] = h2 * (k33 + motions[3 * row + p] + mixed[11 * row + p])

    scatter_from = scatter_pairs(dimension, row)

    @inlined
    def scatter(work, above, upper, lower, below):
        """The sixteen pairs into the blocks of the element's nodes."""
        scatter_from(work.blocks, above, upper, lower, below)

    return constraint_gradient, add_tension, combine, scatter


def force_kernel(dimension: int) -> Any:
    """add_forces for elements of this dimension."""
    last = 2 * POINT_WORDS  # where the last of three components begins
    mass_of_two, slopes_of_two = sums_of_two(MASS, "no"), sums_of_two(WD[:3], "each")
    loads_of_two, bends_of_two = sums_of_two(WH[:3], "sum"), sums_of_two(WE[:3], "sum")
    by_mass_and_slopes = matrix_vector(4, 1.0, add=False, columns=7)
    by_shapes = matrix_vector(4, 1.0, add=True, columns=3)
    eight_numbers, seven_numbers, four_numbers = own_numbers(8), own_numbers(7), own_numbers(4)

    @inlined
    def add_forces(points, edge, a0, a1, drag, above, below, end):
        """Add the forces of an element to those of its nodes, and write what its ends pull with.

        a0, a1: accelerations of its nodes; points: its ElementPoints, with the forces there. Two
        components are summed side by side, of three the last by itself.
        """
        h = edge.length
        mass = edge.mass * h
        weight = edge.weight * h
        x = eight_numbers()
        r = eight_numbers()
        for i in range(2):
            x[4 * i] = a0[i] * mass
            x[4 * i + 1] = a0[dimension + i] * mass * h
            x[4 * i + 2] = a1[i] * mass
            x[4 * i + 3] = a1[dimension + i] * mass * h
        mass_of_two(x, r)
        slopes_of_two(points.pull, r)
        if drag != 0:
            loads_of_two(points.force, r)
        if edge.bending != 0.0:
            bends_of_two(points.bend, r)
        if dimension == 2:
            for k in range(4):
                r[2 * k + 1] += weight * LOAD[k]
        for i in range(2):
            above[i] += r[i]
            above[dimension + i] += h * r[2 + i]
            below[i] += r[4 + i]
            below[dimension + i] += h * r[6 + i]
            end[i] = -r[i]
            end[dimension + i] = r[4 + i]
        if dimension == 3:
            y = seven_numbers()
            s = four_numbers()
            y[0] = a0[2] * mass
            y[1] = a0[5] * mass * h
            y[2] = a1[2] * mass
            y[3] = a1[5] * mass * h
            for g in range(3):
                y[4 + g] = points.pull[last + g]
            by_mass_and_slopes(MASS_WD, 0, y, 0, 1, s, 0)
            if drag != 0:
                by_shapes(WH, 0, points.force, last, 1, s, 0)
            if edge.bending != 0.0:
                by_shapes(WE, 0, points.bend, last, 1, s, 0)
            for k in range(4):
                s[k] += weight * LOAD[k]
            above[2] += s[0]
            above[5] += h * s[1]
            below[2] += s[2]
            below[5] += h * s[3]
            end[2] = -s[0]
            end[5] = s[2]

    return add_forces


def constraint_kernels(dimension: int) -> tuple[Any, Any]:
    """condense and stretch_rate for elements of this dimension."""
    size = 2 * dimension
    words = 4 * size
    add_columns = matrix_vector(size, 1.0, add=True, columns=2)
    set_products = two_products(size)
    two_numbers = own_numbers(2)

    @kernel
    def condense(I, M, out_constraint, out):
        """Add B^T S (constraint residual) of every element to the forces: T condensed out."""
        head = header(I)
        nodes = head.nodes
        joints = view(I, head.joint, nodes)
        parents = view(I, head.parent, nodes)
        gradients = view(M, head.gradient, words * nodes)
        z = two_numbers()
        for node in range(1, nodes):
            if joints[node] != 0:
                continue
            s = compliance_of(I, M, node)
            r0 = out_constraint[2 * node]
            r1 = out_constraint[2 * node + 1]
            z[0] = s.s00 * r0 + s.s01 * r1
            z[1] = s.s01 * r0 + s.s11 * r1
            add_columns(gradients, words * node, z, 0, 1, out, size * parents[node])
            add_columns(gradients, words * node + 2 * size, z, 0, 1, out, size * node)

    @kernel
    def stretch_rate(I, M, x, out):
        """Gradient B of the constraints times a vector x (nodes, size): out (nodes, 2)."""
        head = header(I)
        nodes = head.nodes
        joints = view(I, head.joint, nodes)
        parents = view(I, head.parent, nodes)
        for node in range(1, nodes):
            if joints[node] != 0:
                out[2 * node] = 0.0
                out[2 * node + 1] = 0.0
                continue
            B = view(M, head.gradient + words * node, words)
            set_products(B, x, size * parents[node], size * node, out, 2 * node)

    return condense, stretch_rate
