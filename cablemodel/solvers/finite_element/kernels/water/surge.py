"""What a current that changes in time does to cable in water without waves.

Water that accelerates by a_w at fixed places pushes a cable, per unit length, P across, with

    rho A a_w + ma P a_w,

the Froude-Krylov force as a whole vector and the added mass's share (Sun & Leonard 1998, eqs. 22
and 23, where the water's velocity depends on time). Beside the residuals of the elements, and only
while there is such water; with waves waves.py has it among theirs. The Newton matrix leaves out
how it turns with the cable.
"""

from cablemodel.solvers.finite_element.kernels.element.tables import (
    D0,
    D1,
    D2,
    D3,
    H0,
    H1,
    H2,
    H3,
    WH,
)
from cablemodel.solvers.finite_element.kernels.water.waves import displaced
from cablemodel.solvers.shared.access import edge_of, header, vector
from cablemodel.solvers.shared.compile import outlined
from cablemodel.solvers.shared.environment import surge_at


@outlined
def push_elements(I, M, q, out):
    """Take the force of accelerated water on all elements from the residual and the end forces."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    slope = vector()
    push = vector()  # the water's acceleration
    for node in range(1, head.nodes):
        if I[head.joint + node] != 0:
            continue
        parent = I[head.parent + node]
        edge = edge_of(I, M, node)
        h = edge.length
        added = edge.added_mass
        mass = displaced(I, M, edge)
        above = size * parent
        below = size * node
        ends = head.end_force + size * node
        for g in range(3):
            height = 0.0
            square = 0.0
            for i in range(dimension):
                a = q[above + i]
                b = h * q[above + dimension + i]
                c = q[below + i]
                d = h * q[below + dimension + i]
                height = a * H0[g] + b * H1[g] + c * H2[g] + d * H3[g]
                slope[i] = a * D0[g] + b * D1[g] + c * D2[g] + d * D3[g]
                square += slope[i] * slope[i]
            surge_at(I, M, height, push)
            along = 0.0
            for i in range(dimension):
                along += slope[i] * push[i]
            along /= square
            for i in range(dimension):
                force = h * ((mass + added) * push[i] - added * along * slope[i])
                r0 = force * WH[g, 0]
                r2 = force * WH[g, 2]
                out[above + i] -= r0
                out[above + dimension + i] -= h * force * WH[g, 1]
                out[below + i] -= r2
                out[below + dimension + i] -= h * force * WH[g, 3]
                M[ends + i] += r0
                M[ends + dimension + i] -= r2
