"""Block elimination by triangular solves, for lines with bodies of finite length.

The same elimination as block_solver.py, which keeps inverses of the nodes' blocks. Next to a rigid
body those blocks hold stiffnesses ten million times apart, and an inverse loses the soft ones: a
depressor towed at 3 m/s found no equilibrium. Storage after `factor`: diagonal holds the LU factors
of the node's Schur complement, lower is replaced by Z = D^-1 lower.
"""

from typing import Any

from cablemodel.solvers.finite_element.kernels.line.elimination import hinge_kernels, lower_upper
from cablemodel.solvers.shared.access import header
from cablemodel.solvers.shared.compile import kernel
from cablemodel.solvers.shared.layout import JOINT_HINGE


def make_triangular_solver(size: int) -> tuple[Any, Any]:
    """factor(I, M) -> status and solve(I, M, x) for nodes of `size` unknowns (4 or 6)."""
    area = size * size
    factor_block, solve_block = lower_upper(size, 0)
    factor_hinge, condense_hinge, reduce_hinge, substitute_hinge = hinge_kernels(size)

    @kernel
    def factor(I, M):
        head = header(I)
        nodes = head.nodes
        for node in range(nodes - 1, -1, -1):
            at = head.diagonal + area * node
            D = M[at : at + area]
            hinge = I[head.joint + node] == JOINT_HINGE
            factored = factor_hinge(D) if hinge else factor_block(D)
            if not factored:
                return node + 1
            if node == 0:
                break
            parent = I[head.parent + node]
            above = head.diagonal + area * parent
            A = M[above : above + area]
            Z = M[head.lower + area * node : head.lower + area * node + area]
            U = M[head.upper + area * node : head.upper + area * node + area]
            if hinge:
                condense_hinge(D, Z, A)
            else:
                for i in range(size):
                    for k in range(i):
                        f = D[size * i + k]
                        for j in range(size):
                            Z[size * i + j] -= f * Z[size * k + j]
                for i in range(size - 1, -1, -1):
                    for k in range(i + 1, size):
                        f = D[size * i + k]
                        for j in range(size):
                            Z[size * i + j] -= f * Z[size * k + j]
                    f = D[size * i + i]
                    for j in range(size):
                        Z[size * i + j] *= f
                for i in range(size):
                    for k in range(size):
                        f = U[size * i + k]
                        for j in range(size):
                            A[size * i + j] -= f * Z[size * k + j]
        return 0

    @kernel
    def solve(I, M, x):
        head = header(I)
        nodes = head.nodes
        for node in range(nodes - 1, -1, -1):
            at = head.diagonal + area * node
            D = M[at : at + area]
            y = x[size * node : size * node + size]
            if I[head.joint + node] == JOINT_HINGE:
                parent = I[head.parent + node]
                reduce_hinge(D, y, x[size * parent : size * parent + size])
                continue
            solve_block(D, y)
            if node > 0:
                parent = I[head.parent + node]
                b = x[size * parent : size * parent + size]
                U = M[head.upper + area * node : head.upper + area * node + area]
                for i in range(size):
                    value = b[i]
                    for k in range(size):
                        value -= U[size * i + k] * y[k]
                    b[i] = value
        for node in range(1, nodes):
            parent = I[head.parent + node]
            y = x[size * node : size * node + size]
            p = x[size * parent : size * parent + size]
            Z = M[head.lower + area * node : head.lower + area * node + area]
            if I[head.joint + node] == JOINT_HINGE:
                substitute_hinge(Z, p, y)
            else:
                for i in range(size):
                    value = y[i]
                    for k in range(size):
                        value -= Z[size * i + k] * p[k]
                    y[i] = value

    return factor, solve


factor_planar_lu, solve_planar_lu = make_triangular_solver(4)
factor_spatial_lu, solve_spatial_lu = make_triangular_solver(6)
