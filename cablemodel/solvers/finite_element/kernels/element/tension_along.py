"""Tension along an element: at its ends the weak form's reactions, between them a parabola."""

import math

from cablemodel.solvers.finite_element.kernels.element.damping import carried
from cablemodel.solvers.shared.access import edge_of, header, vector
from cablemodel.solvers.shared.compile import kernel

PRESSED = 24.0  # of EI k^2: by how much the mean of T is off in an element that bends


@kernel
def bend_at(I, M, node, x, out):
    """dt/ds, the curvature as a vector, at a fraction of an element, (dimension,) [1/m]."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    h = edge_of(I, M, node).length
    p = head.position + size * I[head.parent + node]
    q = head.position + size * node
    y = 1.0 - x
    slope = vector()
    square = 0.0
    along = 0.0
    for i in range(dimension):
        chord = (M[q + i] - M[p + i]) / h
        a = M[p + dimension + i]
        b = M[q + dimension + i]
        slope[i] = 6.0 * x * y * chord + y * (1.0 - 3.0 * x) * a + x * (3.0 * x - 2.0) * b
        out[i] = ((6.0 - 12.0 * x) * chord + (6.0 * x - 4.0) * a + (6.0 * x - 2.0) * b) / h
        square += slope[i] * slope[i]
        along += out[i] * slope[i]
    for i in range(dimension):
        out[i] = (out[i] - along / square * slope[i]) / math.sqrt(square)


@kernel
def sharpest_bend(I, M, node):
    """Square of the larger curvature at an element's ends [1/m2]."""
    bend = vector()
    largest = 0.0
    for side in range(2):
        bend_at(I, M, node, float(side), bend)
        square = 0.0
        for i in range(header(I).dimension):
            square += bend[i] * bend[i]
        largest = max(largest, square)
    return largest


@kernel
def end_tension(I, M, element, side):
    """Tension at the parent (side 0) or child (1) end of an element: its end force along r'.

    The end forces are the weak form's own reactions, inertia and loads included: they are as
    accurate inside the line as the force at its top, where the element's T is only its mean.
    """
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    node = element if side == 1 else I[head.parent + element]
    q = head.position + size * node + dimension
    f = head.end_force + size * element + dimension * side
    norm = 0.0
    along = 0.0
    for i in range(dimension):
        norm += M[q + i] * M[q + i]
        along += M[q + i] * M[f + i]
    return along / math.sqrt(norm)


@kernel
def bow_of_tension(I, M, element, left, right):
    """By how much tension bows out between an element's ends, times 4 [N].

    The parabola through both end tensions has the element's mean; where it bends sharply, that mean
    is not that of the tension.
    """
    bending = edge_of(I, M, element).bending
    bow = 6.0 * carried(I, M, element) - 3.0 * (left + right)
    if bending > 0.0:
        off = PRESSED * bending * sharpest_bend(I, M, element)
        bow = math.copysign(max(0.0, abs(bow) - off), bow)
    return bow


@kernel
def tension_range(I, M, element):
    """Lowest and highest tension of an element, at its ends or between them.

    `end_forces` has been called.
    """
    left = end_tension(I, M, element, 0)
    right = end_tension(I, M, element, 1)
    lowest = min(left, right)
    highest = max(left, right)
    change = right - left
    if abs(6.0 * carried(I, M, element) - 3.0 * (left + right)) > abs(change):
        bow = bow_of_tension(I, M, element, left, right)
        if abs(bow) > abs(change):
            x = 0.5 + 0.5 * change / bow
            between = left + x * change + bow * x * (1.0 - x)
            lowest = min(lowest, between)
            highest = max(highest, between)
    return lowest, highest
