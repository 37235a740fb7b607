"""What the elements in a plane and in space do alike: sums over pairs, and the constraints.

The Jacobian's sums over the Gauss points stand in rows, one for each pair of shape functions or of
their slopes, with a word for every pair of components (see tables.py for the pairs). The
constraints' gradient B of an element has a row of four shape functions for each component, first
against P0, then against P1.
"""

from typing import Any

from .compile import inlined, kernel, view
from .layout import (
    E_LENGTH,
    EDGE_WORDS,
    I_NODES,
    O_COMPLIANCE,
    O_EDGE,
    O_GRADIENT,
    O_JOINT,
    O_PARENT,
)


def pair_kernels(dimension: int, row: int, sums: int) -> tuple[Any, Any, Any]:
    """add_tension, combine and scatter for elements of this dimension.

    row: words of a row in the workspace W, at least dimension^2. sums: its word where the rows
    begin: 6 pairs of slopes, 10 of loads, 12 of loads and slopes, 3 spare, 16 of the result.
    """
    second = 4 * dimension
    size = 2 * dimension
    SUM_D = sums
    SUM_H = SUM_D + 6 * row
    SUM_HD = SUM_H + 10 * row
    TURNED = SUM_HD + 12 * row
    BLOCKS = TURNED + 3 * row

    @inlined
    def add_tension(W, B, B2, s00, s01, s11, s22):
        """Add what condensing T out leaves, and the stabilisation, to the six pairs of slopes."""
        for i in range(dimension):
            for a in range(1, 4):
                c = s00 * B[4 * i + a] + s01 * B[second + 4 * i + a]
                d = s01 * B[4 * i + a] + s11 * B[second + 4 * i + a]
                e = s22 * B2[4 * i + a]
                for j in range(dimension):
                    pair = SUM_D + dimension * i + j
                    at = 4 * j + a
                    W[pair + row * (a - 1)] += c * B[at] + d * B[second + at] + e * B2[at]
                    for b in range(a + 1, 4):
                        at = 4 * j + b
                        # Pairs (1, 2), (1, 3), (2, 3) are rows 3, 4, 5.
                        W[pair + row * (a + b)] += c * B[at] + d * B[second + at] + e * B2[at]

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

    @inlined
    def scatter(W, above, upper, lower, below):
        """The sixteen pairs into the blocks of the element's nodes."""
        for k in range(2):
            for i in range(dimension):
                for l in range(2):
                    for j in range(dimension):
                        at = size * (dimension * k + i) + dimension * l + j
                        pair = BLOCKS + row * (4 * k + l) + dimension * i + j
                        above[at] += W[pair]
                        upper[at] = W[pair + 2 * row]
                        lower[at] = W[pair + 8 * row]
                        below[at] += W[pair + 10 * row]

    return add_tension, combine, scatter


def constraint_kernels(dimension: int) -> tuple[Any, Any]:
    """condense and stretch_rate for elements of this dimension."""
    size = 2 * dimension
    second = 4 * dimension
    words = 8 * dimension

    @kernel
    def condense(I, M, out_constraint, out):
        """Add B^T S (constraint residual) of every element to the forces: T condensed out."""
        for node in range(1, I[I_NODES]):
            if I[I[O_JOINT] + node] != 0:
                continue
            parent = I[I[O_PARENT] + node]
            h = M[I[O_EDGE] + node * EDGE_WORDS + E_LENGTH]
            B = view(M, I[O_GRADIENT] + words * node, words)
            s = I[O_COMPLIANCE] + 3 * node
            r0 = out_constraint[2 * node]
            r1 = out_constraint[2 * node + 1]
            z0 = M[s] * r0 + M[s + 1] * r1
            z1 = M[s + 1] * r0 + M[s + 2] * r1
            above = size * parent
            below = size * node
            for i in range(dimension):
                b = 4 * i
                c = second + 4 * i
                out[above + i] += z0 * B[b] + z1 * B[c]
                out[above + dimension + i] += h * (z0 * B[b + 1] + z1 * B[c + 1])
                out[below + i] += z0 * B[b + 2] + z1 * B[c + 2]
                out[below + dimension + i] += h * (z0 * B[b + 3] + z1 * B[c + 3])

    @kernel
    def stretch_rate(I, M, x, out):
        """Gradient B of the constraints times a vector x (nodes, size): out (nodes, 2)."""
        for node in range(1, I[I_NODES]):
            out[2 * node] = 0.0
            out[2 * node + 1] = 0.0
            if I[I[O_JOINT] + node] != 0:
                continue
            parent = I[I[O_PARENT] + node]
            h = M[I[O_EDGE] + node * EDGE_WORDS + E_LENGTH]
            B = view(M, I[O_GRADIENT] + words * node, words)
            above = size * parent
            below = size * node
            r0 = 0.0
            r1 = 0.0
            for i in range(dimension):
                y0 = x[above + i]
                y1 = h * x[above + dimension + i]
                y2 = x[below + i]
                y3 = h * x[below + dimension + i]
                b = 4 * i
                c = second + 4 * i
                r0 += B[b] * y0 + B[b + 1] * y1 + B[b + 2] * y2 + B[b + 3] * y3
                r1 += B[c] * y0 + B[c + 1] * y1 + B[c + 2] * y2 + B[c + 3] * y3
            out[2 * node] = r0
            out[2 * node + 1] = r1

    return condense, stretch_rate
