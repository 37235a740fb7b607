"""Directions of the slopes at nodes, and angles between them."""

import math

from cablemodel.solvers.shared.compile import kernel

LEAST_HALF_COSINE = 0.05


@kernel
def half_cosine(cosine):
    """cos(angle/2), not so small that the moment of a line turned right back has no direction."""
    return max(LEAST_HALF_COSINE, math.sqrt(max(0.0, 0.5 * (1.0 + cosine))))


@kernel
def slope_direction(dimension, q, at, axis, along):
    """Unit vector along the slope at word `at` of q into `along`.

    Returns (length of the slope, cosine of its angle with the unit vector `axis`).
    """
    square = 0.0
    for i in range(dimension):
        square += q[at + i] * q[at + i]
    length = math.sqrt(square)
    cosine = 0.0
    for i in range(dimension):
        along[i] = q[at + i] / length
        cosine += along[i] * axis[i]
    return length, cosine
