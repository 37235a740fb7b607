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

from cablemodel.solvers.finite_element.kernels.line.elimination import hinge_kernels
from cablemodel.solvers.finite_element.kernels.line.products import block_kernels, matrix_vector
from cablemodel.solvers.shared.access import header
from cablemodel.solvers.shared.compile import copy_words, kernel, own_numbers, view
from cablemodel.solvers.shared.layout import (
    JOINT_ARM,
    JOINT_FREE,
    JOINT_HINGE,
    JOINT_ROOT,
    NodeElimination,
)

WORK_LOWER = NodeElimination.lower.word
WORK_UPPER = NodeElimination.upper.word


def make_block_solver(size: int, parts: bool = False) -> tuple[Any, Any]:
    """factor(I, M) -> status and solve(I, M, x) for nodes of `size` unknowns (4 or 6).

    parts: with free bodies and several trees. The first node at an arm has its parent's place r and
    theta as r + A theta, with A as `free_jacobian` leaves it beside Z.
    """
    area = size * size
    half = size // 2
    set_product = matrix_vector(size, 1.0, add=False)
    subtract_product = matrix_vector(size, -1.0, add=True)
    transpose, invert = block_kernels(size)
    factor_hinge, condense_hinge, reduce_hinge, substitute_hinge = hinge_kernels(size)
    own_block, own_unknowns = own_numbers(area), own_numbers(size)

    @kernel
    def take_arm(S, Z, A):
        """A += [1, G]^T S [1, G], S the Schur complement of the place at an arm, G = dr/dtheta."""
        G = half * size
        for i in range(half):
            for j in range(half):
                value = S[size * i + j]
                A[size * i + j] += value
                right = 0.0
                left = 0.0
                for k in range(half):
                    right += S[size * i + k] * Z[G + half * k + j]
                    left += Z[G + half * k + i] * S[size * k + j]
                A[size * i + half + j] += right
                A[size * (half + i) + j] += left
                S[size * (half + i) + j] = left  # G^T S
        for i in range(half):
            for j in range(half):
                value = 0.0
                for k in range(half):
                    value += S[size * (half + i) + k] * Z[G + half * k + j]
                A[size * (half + i) + half + j] += value

    @kernel
    def factor(I, M):
        head = header(I)
        nodes = head.nodes
        for node in range(nodes - 1, -1, -1):
            at = head.diagonal + area * node
            D = view(M, at, area)
            joint = I[head.joint + node]
            hinge = joint == JOINT_HINGE
            if parts:
                hinge = hinge or joint == JOINT_ARM or joint == JOINT_FREE
            factored = factor_hinge(D) if hinge else invert(D, 0)
            if not factored:
                return node + 1
            if node == 0:
                break
            if parts and joint >= JOINT_ROOT:
                continue
            parent = I[head.parent + node]
            above = head.diagonal + area * parent
            A = view(M, above, area)
            Z = view(M, head.lower + area * node, area)
            U = view(M, head.upper + area * node, area)
            if parts and joint == JOINT_ARM:
                S = own_block()
                condense_hinge(D, Z, S)
                take_arm(S, Z, A)
            elif hinge:
                condense_hinge(D, Z, A)
            else:
                # Columns of Z = D^-1 L and of W = U D^-1, then the parent's rows: A -= W L.
                work = head.gauss + WORK_LOWER
                columns = head.gauss + WORK_UPPER
                copy_words(M, work, head.lower + area * node, area)
                transpose(M, head.upper + area * node, columns)
                for k in range(size):
                    set_product(D, 0, M, work + k, size, Z, size * k)
                    set_product(M, columns, D, size * k, 1, U, size * k)
                for k in range(size):
                    subtract_product(M, work, U, k, size, A, size * k)
        return 0

    @kernel
    def solve(I, M, x):
        head = header(I)
        nodes = head.nodes
        joints = view(I, head.joint, nodes)
        parents = view(I, head.parent, nodes)
        for node in range(nodes - 1, 0, -1):
            at = head.diagonal + area * node
            D = view(M, at, area)
            y = view(x, size * node, size)
            parent = parents[node]
            b = view(x, size * parent, size)
            if parts and joints[node] >= JOINT_ROOT:
                continue
            if parts and joints[node] == JOINT_ARM:
                w = own_unknowns()  # of a node at the arm's place
                reduce_hinge(D, y, w)
                Z = view(M, head.lower + area * node, area)
                for i in range(half):
                    b[i] += w[i]
                    for k in range(half):
                        b[half + i] += Z[half * size + half * k + i] * w[k]
            elif joints[node] == JOINT_HINGE or (parts and joints[node] == JOINT_FREE):
                reduce_hinge(D, y, b)
            else:
                U = view(M, head.upper + area * node, area)
                subtract_product(U, 0, y, 0, 1, b, 0)
        set_product(M, head.diagonal, x, 0, 1, x, 0)
        for node in range(1, nodes):
            parent = parents[node]
            y = view(x, size * node, size)
            p = view(x, size * parent, size)
            Z = view(M, head.lower + area * node, area)
            if parts and joints[node] >= JOINT_ROOT:
                set_product(M, head.diagonal + area * node, y, 0, 1, y, 0)
            elif parts and joints[node] == JOINT_ARM:
                w = own_unknowns()
                for i in range(half):
                    w[i] = p[i]
                    for k in range(half):
                        w[i] += Z[half * size + half * i + k] * p[half + k]
                substitute_hinge(Z, w, y)
            elif joints[node] == JOINT_HINGE or (parts and joints[node] == JOINT_FREE):
                substitute_hinge(Z, p, y)
            else:
                set_product(M, head.diagonal + area * node, y, 0, 1, y, 0)
                subtract_product(Z, 0, p, 0, 1, y, 0)

    return factor, solve


factor_planar, solve_planar = make_block_solver(4)
factor_spatial, solve_spatial = make_block_solver(6)
factor_parts, solve_parts = make_block_solver(6, parts=True)
