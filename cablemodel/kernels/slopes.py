"""Directions of the slopes at nodes, and angles between them."""

import math

from .compile import kernel

LEAST_HALF_COSINE = 0.05


@kernel
def half_cosine(cosine):
    """cos(angle/2), not so small that the moment of a line turned right back has no direction."""
    return max(LEAST_HALF_COSINE, math.sqrt(max(0.0, 0.5 * (1.0 + cosine))))


@kernel
def slope_direction(dimension, q, at, w):
    """Unit vector along the slope at word `at` of q into w[3:6], its cosine with the axis w[0:3].

    Returns (length of the slope, cosine).
    """
    square = 0.0
    for i in range(dimension):
        square += q[at + i] * q[at + i]
    length = math.sqrt(square)
    cosine = 0.0
    for i in range(dimension):
        w[3 + i] = q[at + i] / length
        cosine += w[3 + i] * w[i]
    return length, cosine
