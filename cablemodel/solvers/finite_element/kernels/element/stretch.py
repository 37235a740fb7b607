"""How an element is stretched along itself, by modes, and what of that no tension says.

Where an element is split its third mode of strain becomes strain of both pieces. A number holds
that mode, not the cable (stabilisation.py): as strain of the pieces it would become tension that
nothing carries, and send waves along the line. What the pieces are strained by beyond the tension
that the element had there is their strain at rest: together it lengthens nothing, and it is
forgotten far more slowly than anything moves. So it is where waves are followed (waves.py), and at
a winch that pays out, where elements become longest: friction would keep what is forgotten.
"""

import math

from cablemodel.solvers.finite_element.kernels.element.strain import moments, promised_tension
from cablemodel.solvers.finite_element.kernels.element.tables import (
    D0,
    D1,
    D2,
    D3,
    WEIGHT,
    WEIGHT_P1,
    WEIGHT_P2,
)
from cablemodel.solvers.shared.access import (
    edge_of,
    header,
    scalars,
    tension_of,
)
from cablemodel.solvers.shared.compile import inlined, kernel, outlined

OF_A_HALF = 0.75  # of the third mode's amplitude: the linear part of it in each half


@outlined
def strains(I, M, node, p0, p1):
    """Strain of the element above a node, whose slopes are p0 and p1 times what they are: its mean,
    its mean times P1, and the amplitude of its third mode [-]."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    h = edge_of(I, M, node).length
    q0 = head.position + size * I[head.parent + node]
    q1 = head.position + size * node
    mean = 0.0
    moment = 0.0
    third = 0.0
    for p in range(3):
        square = 0.0
        for i in range(dimension):
            slope = (M[q0 + i] * D0[p] + M[q1 + i] * D2[p]) / h
            slope += p0 * M[q0 + dimension + i] * D1[p] + p1 * M[q1 + dimension + i] * D3[p]
            square += slope * slope
        strain = math.sqrt(square) - 1.0
        mean += WEIGHT[p] * strain
        moment += WEIGHT_P1[p] * strain
        third += WEIGHT_P2[p] * strain
    return mean, moment, 5.0 * third


@kernel
def third_strain(I, M, node):
    """Amplitude of the third strain mode in the element above a node [-]."""
    return strains(I, M, node, 1.0, 1.0)[2]


@kernel
def splitting_tears(I, M, node):
    """Whether the third mode of the taut element above a node would become more tension of its
    pieces than it has itself, by more than tensions may be wrong by; and what it has [N]."""
    edge = edge_of(I, M, node)
    promised = promised_tension(M)
    tension = tension_of(I, M, node)
    taut = tension.mean - abs(tension.slope) > promised
    strain = third_strain(I, M, node)
    third = edge.stabilisation * strain - edge.third_rest
    beyond = strain - edge.compliance * third
    return taut and OF_A_HALF * abs(beyond) > promised * edge.compliance, third


@kernel
def split_third(I, M, upper, lower, x, third):
    """Let two elements, pieces x and 1 - x of one whose third mode had a tension [N], carry that as
    it did: P2 along a piece has a mean and a slope."""
    y = 1.0 - x
    tension_of(I, M, upper).mean += third * y * (y - x)
    tension_of(I, M, lower).mean += third * x * (x - y)
    tension_of(I, M, upper).slope -= third * 3.0 * x * y
    tension_of(I, M, lower).slope += third * 3.0 * x * y


@kernel
def rest_as_stretched(I, M, node):
    """Let what an element is stretched by, and its tension does not say, be its strain at rest."""
    edge = edge_of(I, M, node)
    tension = tension_of(I, M, node)
    mean, moment, _third = strains(I, M, node, 1.0, 1.0)
    strain, slope, _c00, _c01, _c11, _bent = moments(M, edge, tension.mean, tension.slope)
    edge.stretch_rest = edge.length * (mean - strain)
    edge.moment_rest = edge.length * (moment - slope)
    scalars(M).stiffened = 1.0


@outlined
def take_rests(I, M, missed):
    """Take what elements are stretched by at rest off what constraints miss, (2 nodes,) [m]."""
    head = header(I)
    for node in range(1, head.nodes):
        if I[head.joint + node] == 0:
            edge = edge_of(I, M, node)
            missed[2 * node] -= edge.stretch_rest
            missed[2 * node + 1] -= edge.moment_rest


@inlined
def take_in_rest(edge, left):
    """Take the rest in with an element's cable, of which a share is left."""
    edge.stretch_rest *= left
    edge.moment_rest *= left


@kernel
def split_rests(I, M, upper, lower, x):
    """Let two elements, pieces x and 1 - x of one whose rest both have, rest as it does there."""
    above = edge_of(I, M, upper)
    below = edge_of(I, M, lower)
    y = 1.0 - x
    stretch = below.stretch_rest
    moment = below.moment_rest
    above.stretch_rest = x * (stretch - 3.0 * y * moment)
    above.moment_rest = x * x * moment
    below.stretch_rest = y * (stretch + 3.0 * x * moment)
    below.moment_rest = y * y * moment


@kernel
def join_rests(I, M, upper, lower):
    """Let the lower one of two elements, which is to take the place of both, rest as both do."""
    above = edge_of(I, M, upper)
    below = edge_of(I, M, lower)
    x = above.length / (above.length + below.length)
    y = 1.0 - x
    across = x * below.stretch_rest - y * above.stretch_rest
    below.stretch_rest += above.stretch_rest
    below.moment_rest = x * above.moment_rest + y * below.moment_rest + across
