"""Block elimination of a tree of nodes, leaves to root: a chain is block-tridiagonal LU.

Node i is tied to parent[i] < i by an element (blocks `upper`: parent's row, child's column;
`lower`: child's row, parent's column), by a body of finite length (the same blocks) or by a hinge:
same r, slopes of their own.
Storage after `factor`, by columns: diagonal holds the inverse of the node's Schur complement D,
upper W = upper D^-1 and lower Z = D^-1 lower, so that a solution is three products of a small
matrix with a vector a node: triangular solves have the same flops but wait for each other. At a
hinge: the LU factors of the slopes' block, by rows, and Z of that block. No pivoting: the diagonal
blocks are dominated by mass and by stiffness that is nearly symmetric and positive; a vanishing
pivot is reported and the caller takes a smaller step.
"""

from typing import Any

from .compile import block_kernels, copy_words, kernel, matrix_vector, view
from .layout import I_NODES, JOINT_HINGE, O_DIAGONAL, O_GAUSS, O_JOINT, O_LOWER, O_PARENT, O_UPPER


def make_block_solver(size: int) -> tuple[Any, Any]:
    """factor(I, M) -> status and solve(I, M, x) for nodes of `size` unknowns (4 or 6)."""
    half = size // 2
    area = size * size
    set_product = matrix_vector(size, 1.0, add=False)
    subtract_product = matrix_vector(size, -1.0, add=True)
    transpose, invert = block_kernels(size)

    @kernel
    def factor(I, M):
        nodes = I[I_NODES]
        for node in range(nodes - 1, -1, -1):
            at = I[O_DIAGONAL] + area * node
            D = view(M, at, area)
            hinge = I[I[O_JOINT] + node] == JOINT_HINGE
            if hinge:
                for k in range(half, size):
                    pivot = D[size * k + k]
                    if pivot == 0.0 or pivot != pivot:
                        return node + 1
                    inverse = 1.0 / pivot
                    D[size * k + k] = inverse
                    for i in range(k + 1, size):
                        factor_ik = D[size * i + k] * inverse
                        D[size * i + k] = factor_ik
                        for j in range(k + 1, size):
                            D[size * i + j] -= factor_ik * D[size * k + j]
            elif not invert(D, 0):
                return node + 1
            if node == 0:
                break
            parent = I[I[O_PARENT] + node]
            above = I[O_DIAGONAL] + area * parent
            A = view(M, above, area)
            Z = view(M, I[O_LOWER] + area * node, area)
            U = view(M, I[O_UPPER] + area * node, area)
            if hinge:
                # Z = dd^-1 dr; the parent's r takes over rr - rd Z.
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
            else:
                # Columns of Z = D^-1 L and of W = U D^-1, then the parent's rows: A -= W L.
                work = I[O_GAUSS] + 80
                columns = work + area
                copy_words(M, work, I[O_LOWER] + area * node, area)
                transpose(M, I[O_UPPER] + area * node, columns)
                for k in range(size):
                    set_product(D, 0, M, work + k, size, Z, size * k)
                    set_product(M, columns, D, size * k, 1, U, size * k)
                for k in range(size):
                    subtract_product(M, work, U, k, size, A, size * k)
        return 0

    @kernel
    def solve(I, M, x):
        nodes = I[I_NODES]
        for node in range(nodes - 1, -1, -1):
            at = I[O_DIAGONAL] + area * node
            D = view(M, at, area)
            y = view(x, size * node, size)
            hinge = I[I[O_JOINT] + node] == JOINT_HINGE
            if hinge:
                for i in range(half, size):
                    value = y[i]
                    for k in range(half, i):
                        value -= D[size * i + k] * y[k]
                    y[i] = value
                for i in range(size - 1, half - 1, -1):
                    value = y[i]
                    for k in range(i + 1, size):
                        value -= D[size * i + k] * y[k]
                    y[i] = value * D[size * i + i]
            if node == 0:
                break
            parent = I[I[O_PARENT] + node]
            b = view(x, size * parent, size)
            if hinge:
                for i in range(half):
                    value = y[i]
                    for k in range(half, size):
                        value -= D[size * i + k] * y[k]
                    b[i] += value
            else:
                U = view(M, I[O_UPPER] + area * node, area)
                subtract_product(U, 0, y, 0, 1, b, 0)
        set_product(M, I[O_DIAGONAL], x, 0, 1, x, 0)
        for node in range(1, nodes):
            parent = I[I[O_PARENT] + node]
            y = view(x, size * node, size)
            p = view(x, size * parent, size)
            Z = view(M, I[O_LOWER] + area * node, area)
            if I[I[O_JOINT] + node] == JOINT_HINGE:
                for i in range(half):
                    y[i] = p[i]
                for i in range(half):
                    value = y[half + i]
                    for k in range(half):
                        value -= Z[size * i + k] * p[k]
                    y[half + i] = value
            else:
                set_product(M, I[O_DIAGONAL] + area * node, y, 0, 1, y, 0)
                subtract_product(Z, 0, p, 0, 1, y, 0)

    return factor, solve


factor_planar, solve_planar = make_block_solver(4)
factor_spatial, solve_spatial = make_block_solver(6)
