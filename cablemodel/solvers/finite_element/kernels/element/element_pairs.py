"""What the elements in a plane and in space do alike: sums over pairs, and the constraints.

The Jacobian's sums over the Gauss points stand in rows, one for each pair of shape functions or of
their slopes, with a word for every pair of components (see tables.py for the pairs).
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
from cablemodel.solvers.shared.access import edge_of, header, scalars
from cablemodel.solvers.shared.compile import inlined, kernel, own_numbers, view
from cablemodel.solvers.shared.layout import (
    ELEMENT_WORDS,
    GAUSS_WORDS,
)


@inlined
def third_tension(W, stretched, edge):
    """Tension of an element's third strain mode [N]; |r'| at its Gauss points begins at that word
    of W."""
    e2 = 0.0
    for g in range(3):
        e2 += WEIGHT_P2[g] * (W[stretched + g] - 1.0)
    return 5.0 * edge.stabilisation * e2 - edge.third_rest


@inlined
def strain_missed(M, W, stretched, edge, t0, t1):
    """Means over an element of |r'| - 1 - strain under the tension t0 + t1 P1, alone and times P1;
    |r'| at its Gauss points begins at the word `stretched` of W."""
    r0 = 0.0
    r1 = 0.0
    if edge.strain_terms == 1.0:
        for g in range(3):
            r0 += WEIGHT[g] * (W[stretched + g] - 1.0)
            r1 += WEIGHT_P1[g] * (W[stretched + g] - 1.0)
        c = edge.compliance
        r0 -= c * t0
        r1 -= c * t1 * (1.0 / 3.0)
    else:
        for g in range(3):
            strain, _slope = strain_in(M, edge, t0 + t1 * P1[g])
            r0 += WEIGHT[g] * (W[stretched + g] - 1.0 - strain)
            r1 += WEIGHT_P1[g] * (W[stretched + g] - 1.0 - strain)
    if may_be_slack(edge, t0, t1):
        aside0, aside1, _c00, _c01, _c11 = moments_aside(edge, t0, t1)
        r0 -= aside0
        r1 -= aside1
    return r0, r1


@inlined
def invert_compliance(M, edge, t0, t1, stored):
    """Inverse S of an element's compliance under the tension t0 + t1 P1: its three components,
    which are stored too."""
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
    stored[0] = c11 * determinant
    stored[1] = -c01 * determinant
    stored[2] = c00 * determinant
    return stored[0], stored[1], stored[2]


def missed_kernel(dimension: int, geometry: Any, stretched: int) -> Any:
    """constraints(I, M, q, tension, out): of all elements of this dimension, as their residuals
    have them."""
    size = 2 * dimension

    @kernel
    def constraints(I, M, q, tension, out):
        head = header(I)
        W = view(M, head.gauss, GAUSS_WORDS)
        for node in range(1, head.nodes):
            out[2 * node] = 0.0
            out[2 * node + 1] = 0.0
            if I[head.joint + node] != 0:
                continue
            edge = edge_of(I, M, node)
            h = edge.length
            geometry(W, view(q, size * I[head.parent + node], size), view(q, size * node, size), h)
            r0, r1 = strain_missed(M, W, stretched, edge, tension[2 * node], tension[2 * node + 1])
            out[2 * node] = h * r0
            out[2 * node + 1] = h * r1
        if scalars(M).stiffened != 0.0:
            take_rests(I, M, out)

    return constraints


def gradient_kernel(dimension: int, geometry: Any, constraint_gradient: Any) -> Any:
    """gradients(I, M, q, tension): those of the constraints, and S, as a Jacobian stores them."""
    size = 2 * dimension
    words = 4 * size

    @kernel
    def gradients(I, M, q, tension):
        head = header(I)
        W = view(M, head.gauss, GAUSS_WORDS)
        for node in range(1, head.nodes):
            if I[head.joint + node] != 0:
                continue
            edge = edge_of(I, M, node)
            h = edge.length
            geometry(W, view(q, size * I[head.parent + node], size), view(q, size * node, size), h)
            constraint_gradient(W, h, view(M, head.gradient + words * node, words))
            stiffness = view(M, head.compliance + 3 * node, 3)
            invert_compliance(M, edge, tension[2 * node], tension[2 * node + 1], stiffness)

    return gradients


def pair_kernels(dimension: int, row: int, tangents: int, sums: int) -> tuple[Any, Any, Any, Any]:
    """constraint_gradient, add_tension, combine and scatter for elements of this dimension.

    row: words of a row in the workspace W, at least dimension^2. tangents: its word where the
    tangents at the Gauss points begin, four words a component. sums: its word where the rows
    begin: 6 pairs of slopes, 10 of loads, 12 of loads and slopes, 3 spare, 16 of the result. Three
    gradients of four words a component come after them.
    """
    second = 4 * dimension
    size = 2 * dimension
    SUM_D = sums
    SUM_H = SUM_D + 6 * row
    SUM_HD = SUM_H + 10 * row
    TURNED = SUM_HD + 12 * row
    BLOCKS = TURNED + 3 * row
    GRADIENT = BLOCKS + 16 * row
    if GRADIENT + 3 * second > ELEMENT_WORDS:
        raise ValueError(f"{GRADIENT + 3 * second} words of {ELEMENT_WORDS} in the workspace")

    @inlined
    def constraint_gradient(W, h, stored):
        """Gradients of the constraints and of the stabilising mode by shape function, into W.

        The constraints' are stored by the unknowns too (4 size): rows 0 and 1 for the parent's,
        then for the child's.
        """
        for i in range(dimension):
            at = GRADIENT + 4 * i
            for k in range(4):
                w0 = W[tangents + 4 * i] * WD[0, k]
                w1 = W[tangents + 4 * i + 1] * WD[1, k]
                w2 = W[tangents + 4 * i + 2] * WD[2, k]
                W[at + k] = w0 + w1 + w2
                W[at + second + k] = w0 * P1[0] + w1 * P1[1] + w2 * P1[2]
                W[at + 2 * second + k] = w0 * P2[0] + w1 * P2[1] + w2 * P2[2]
            for c in range(2):
                to = size * c + i
                stored[to] = W[at + second * c]
                stored[to + dimension] = h * W[at + second * c + 1]
                stored[to + 2 * size] = W[at + second * c + 2]
                stored[to + 2 * size + dimension] = h * W[at + second * c + 3]

    @inlined
    def add_tension(W, s00, s01, s11, s22):
        """Add what condensing T out leaves, and the stabilisation, to the six pairs of slopes."""
        for i in range(dimension):
            for a in range(1, 4):
                at = GRADIENT + 4 * i + a
                c = s00 * W[at] + s01 * W[at + second]
                d = s01 * W[at] + s11 * W[at + second]
                e = s22 * W[at + 2 * second]
                for j in range(dimension):
                    pair = SUM_D + dimension * i + j
                    for b in range(a, 4):
                        # Pairs (1, 1), (2, 2), (3, 3) are rows 0, 1, 2; (1, 2), (1, 3), (2, 3)
                        # are rows 3, 4, 5.
                        to = pair + row * (a - 1 if a == b else a + b)
                        at = GRADIENT + 4 * j + b
                        W[to] += c * W[at] + d * W[at + second] + e * W[at + 2 * second]

    @inlined
    def combine(W, h):
        """All sixteen pairs of shape functions from the sums, for all pairs of components at once.

        Function 0 has minus the slope of function 2; slope unknowns are scaled by h.
        """
        for i in range(dimension):
            for j in range(dimension):
                for k in range(3):
                    to = TURNED + row * k + dimension * i + j
                    W[to] = W[SUM_D + row * (3 + k) + dimension * j + i]
        h2 = h * h
        for p in range(row):
            k11 = W[SUM_D + p]
            k22 = W[SUM_D + row + p]
            k33 = W[SUM_D + 2 * row + p]
            k12 = W[SUM_D + 3 * row + p]
            k13 = W[SUM_D + 4 * row + p]
            k23 = W[SUM_D + 5 * row + p]
            k21 = W[TURNED + p]
            k31 = W[TURNED + row + p]
            k32 = W[TURNED + 2 * row + p]
            H = SUM_H + p
            X = SUM_HD + p
            to = BLOCKS + p
            W[to] = k22 + W[H] - W[X + row]
            W[to + row] = h * (W[H + 4 * row] + W[X] - k21)
            W[to + 2 * row] = W[H + 5 * row] + W[X + row] - k22
            W[to + 3 * row] = h * (W[H + 6 * row] + W[X + 2 * row] - k23)
            W[to + 4 * row] = h * (W[H + 4 * row] - W[X + 4 * row] - k12)
            W[to + 5 * row] = h2 * (k11 + W[H + row] + W[X + 3 * row])
            W[to + 6 * row] = h * (k12 + W[H + 7 * row] + W[X + 4 * row])
            W[to + 7 * row] = h2 * (k13 + W[H + 8 * row] + W[X + 5 * row])
            W[to + 8 * row] = W[H + 5 * row] - W[X + 7 * row] - k22
            W[to + 9 * row] = h * (k21 + W[H + 7 * row] + W[X + 6 * row])
            W[to + 10 * row] = k22 + W[H + 2 * row] + W[X + 7 * row]
            W[to + 11 * row] = h * (k23 + W[H + 9 * row] + W[X + 8 * row])
            W[to + 12 * row] = h * (W[H + 6 * row] - W[X + 10 * row] - k32)
            W[to + 13 * row] = h2 * (k31 + W[H + 8 * row] + W[X + 9 * row])
            W[to + 14 * row] = h * (k32 + W[H + 9 * row] + W[X + 10 * row])
            W[to + 15 * row] = h2 * (k33 + W[H + 3 * row] + W[X + 11 * row])

    scatter_from = scatter_pairs(dimension, row)

    @inlined
    def scatter(W, above, upper, lower, below):
        """The sixteen pairs into the blocks of the element's nodes."""
        scatter_from(W, BLOCKS, above, upper, lower, below)

    return constraint_gradient, add_tension, combine, scatter


def force_kernel(dimension: int, loads: int, pulls: int, bends: int) -> Any:
    """add_forces for elements of this dimension.

    loads, pulls, bends: words of the workspace W where forces conjugate to r, r' and r'' at the
    Gauss points begin, times h, 1 and 1 / h, four words a component.
    """
    mass_of_two, slopes_of_two = sums_of_two(MASS, "no"), sums_of_two(WD[:3], "each")
    loads_of_two, bends_of_two = sums_of_two(WH[:3], "sum"), sums_of_two(WE[:3], "sum")
    by_mass_and_slopes = matrix_vector(4, 1.0, add=False, columns=7)
    by_shapes = matrix_vector(4, 1.0, add=True, columns=3)
    eight_numbers, seven_numbers, four_numbers = own_numbers(8), own_numbers(7), own_numbers(4)

    @inlined
    def add_forces(W, edge, a0, a1, drag, above, below, end):
        """Add the forces of an element to those of its nodes, and write what its ends pull with.

        a0, a1: accelerations of its nodes. Two components are summed side by side, of three the
        last by itself.
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
        mass_of_two(x, 0, r)
        slopes_of_two(W, pulls, r)
        if drag != 0:
            loads_of_two(W, loads, r)
        if edge.bending != 0.0:
            bends_of_two(W, bends, r)
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
                y[4 + g] = W[pulls + 8 + g]
            by_mass_and_slopes(MASS_WD, 0, y, 0, 1, s, 0)
            if drag != 0:
                by_shapes(WH, 0, W, loads + 8, 1, s, 0)
            if edge.bending != 0.0:
                by_shapes(WE, 0, W, bends + 8, 1, s, 0)
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
            s = view(M, head.compliance + 3 * node, 3)
            r0 = out_constraint[2 * node]
            r1 = out_constraint[2 * node + 1]
            z[0] = s[0] * r0 + s[1] * r1
            z[1] = s[1] * r0 + s[2] * r1
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
