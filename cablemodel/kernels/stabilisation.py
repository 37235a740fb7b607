"""The stiffness of each element's third strain mode follows the tension where that grows.

Nothing but this stiffness holds that mode, and it is that of a typical tension at the start. A line
that is drawn taut afterwards, by a winch or a vessel that leaves its anchor, may carry thousands of
times as much: what its tension differs by from one element to the next then stretched half of each
element by tenths and shortened the other.
"""

import math

from .compile import kernel
from .layout import (
    E_COMPLIANCE,
    E_LENGTH,
    E_STABILISATION,
    EDGE_WORDS,
    I_DIMENSION,
    I_FACTORED,
    I_HISTORY,
    I_NODES,
    O_EDGE,
    O_JOINT,
    O_PARENT,
    O_POSITION,
    O_TENSION,
    S_LARGEST_TENSION,
    S_TENSION_SCALE,
    S_TOLERANCE,
)
from .tables import D0, D1, D2, D3, WEIGHT_P2

STABILISATION = 3.0  # of the tension, as at the start: see instance/line_tables.py


@kernel
def third_strain(I, M, node):
    """Amplitude of the third strain mode in the element above a node [-]."""
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    h = M[I[O_EDGE] + node * EDGE_WORDS + E_LENGTH]
    q0 = I[O_POSITION] + size * I[I[O_PARENT] + node]
    q1 = I[O_POSITION] + size * node
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
    if M[S_LARGEST_TENSION] <= STABILISATION * M[S_TENSION_SCALE]:
        return  # all but the few lines that are drawn taut
    for node in range(1, I[I_NODES]):
        if I[I[O_JOINT] + node] != 0:
            continue
        edge = I[O_EDGE] + node * EDGE_WORDS
        tension = M[I[O_TENSION] + 2 * node]
        stiffness = M[edge + E_STABILISATION]
        if tension <= stiffness or stiffness * M[edge + E_COMPLIANCE] >= 1.0:
            continue
        strain = third_strain(I, M, node)
        # A tenth of the square of the strain, by the element's length and the stiffness, is held.
        more = 10.0 * share * M[S_TOLERANCE] * tension / max(strain * strain, 1e-20)
        wanted = min(STABILISATION * tension, stiffness + more)
        M[edge + E_STABILISATION] = min(wanted, 1.0 / M[edge + E_COMPLIANCE])
        I[I_FACTORED] = 0
        I[I_HISTORY] = 0
