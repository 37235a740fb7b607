"""The stiffness of each element's third strain mode follows the tension where that grows.

Nothing but this stiffness holds that mode, and it is that of a typical tension at the start. A line
that is drawn taut afterwards, by a winch or a vessel that leaves its anchor, may carry thousands of
times as much: what its tension differs by from one element to the next then stretched half of each
element by tenths and shortened the other.
"""

import math

from .access import edge_of, header, scalars
from .compile import kernel
from .tables import D0, D1, D2, D3, WEIGHT_P2

STABILISATION = 3.0  # of the tension, as at the start: see instance/line_tables.py


@kernel
def third_strain(I, M, node):
    """Amplitude of the third strain mode in the element above a node [-]."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    h = edge_of(I, M, node).length
    q0 = head.position + size * I[head.parent + node]
    q1 = head.position + size * node
    strain = 0.0
    for p in range(3):
        square = 0.0
        for i in range(dimension):
            slope = (M[q0 + i] * D0[p] + M[q1 + i] * D2[p]) / h
            slope += M[q0 + dimension + i] * D1[p] + M[q1 + dimension + i] * D3[p]
            square += slope * slope
        strain += WEIGHT_P2[p] * (math.sqrt(square) - 1.0)
    return 5.0 * strain


@kernel
def stiffen_third_mode(I, M, share):
    """After a step: make the mode stiffer in elements whose tension has outgrown its stiffness.

    What that adds to the energy that the mode holds is bounded by the tension over tau of the
    element's length in each sqrt(L/g), of which the step is `share`. The mode stays as stiff as it
    has become: elements that bend as much as they may hardly have any of it.
    """
    head = header(I)
    state = scalars(M)
    if state.largest_tension <= STABILISATION * state.tension_scale:
        return  # all but the few lines that are drawn taut
    for node in range(1, head.nodes):
        if I[head.joint + node] != 0:
            continue
        edge = edge_of(I, M, node)
        tension = M[head.tension + 2 * node]
        stiffness = edge.stabilisation
        if tension <= stiffness or stiffness * edge.compliance >= 1.0:
            continue
        strain = third_strain(I, M, node)
        # A tenth of the square of the strain, by the element's length and the stiffness, is held.
        more = 10.0 * share * state.tolerance * tension / max(strain * strain, 1e-20)
        wanted = min(STABILISATION * tension, stiffness + more)
        edge.stabilisation = min(wanted, 1.0 / edge.compliance)
        head.factored = 0
        head.has_history = 0
