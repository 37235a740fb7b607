"""What both block eliminations do alike: LU of a node's block, and the elimination of a hinge.

A hinge is a second node with its parent's position r and a slope d of its own: of its block
[[rr, rd], [dr, dd]] only dd is factored, and the parent's r takes over the Schur complement.
Blocks are stored by rows. No pivoting; see block_solver.py.
"""

from typing import Any

from cablemodel.solvers.shared.compile import inlined


def lower_upper(size: int, first: int) -> tuple[Any, Any]:
    """factor(D) -> whether it could, and solve(D, y), for rows and columns from `first` on.

    After `factor` D holds the factors: L below its diagonal of ones, U above, 1 / diagonal of U.
    """

    @inlined
    def factor(D):
        for k in range(first, size):
            pivot = D[size * k + k]
            if pivot == 0.0 or pivot != pivot:
                return False
            inverse = 1.0 / pivot
            D[size * k + k] = inverse
            for i in range(k + 1, size):
                factor_ik = D[size * i + k] * inverse
                D[size * i + k] = factor_ik
                for j in range(k + 1, size):
                    D[size * i + j] -= factor_ik * D[size * k + j]
        return True

    @inlined
    def solve(D, y):
        for i in range(first, size):
            value = y[i]
            for k in range(first, i):
                value -= D[size * i + k] * y[k]
            y[i] = value
        for i in range(size - 1, first - 1, -1):
            value = y[i]
            for k in range(i + 1, size):
                value -= D[size * i + k] * y[k]
            y[i] = value * D[size * i + i]

    return factor, solve


def hinge_kernels(size: int) -> tuple[Any, Any, Any, Any]:
    """For a node at a hinge, with block D and right side y, and its parent with A, b and p.

    factor(D) -> whether it could; condense(D, Z, A): Z = dd^-1 dr, and A's r takes over rr - rd Z;
    reduce(D, y, b): dd^-1 y_d, and b's r takes over y_r - rd y_d; substitute(Z, p, y): r = p_r,
    d = y_d - Z p_r.
    """
    half = size // 2
    factor, solve = lower_upper(size, half)

    @inlined
    def condense(D, Z, A):
        for i in range(half):
            for j in range(half):
                value = D[size * (half + i) + j]
                for k in range(i):
                    value -= D[size * (half + i) + half + k] * Z[size * k + j]
                Z[size * i + j] = value
        for i in range(half - 1, -1, -1):
            for j in range(half):
                value = Z[size * i + j]
                for k in range(i + 1, half):
                    value -= D[size * (half + i) + half + k] * Z[size * k + j]
                Z[size * i + j] = value * D[size * (half + i) + half + i]
        for i in range(half):
            for j in range(half):
                value = D[size * i + j]
                for k in range(half):
                    value -= D[size * i + half + k] * Z[size * k + j]
                A[size * i + j] += value

    @inlined
    def reduce(D, y, b):
        solve(D, y)
        for i in range(half):
            value = y[i]
            for k in range(half, size):
                value -= D[size * i + k] * y[k]
            b[i] += value

    @inlined
    def substitute(Z, p, y):
        for i in range(half):
            y[i] = p[i]
        for i in range(half):
            value = y[half + i]
            for k in range(half):
                value -= Z[size * i + k] * p[k]
            y[half + i] = value

    return factor, condense, reduce, substitute
