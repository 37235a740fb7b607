"""Where the nodes of a line lie: from the accuracy that is asked for, or an element count."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def uniform_nodes(length: float, elements: int) -> FloatArray:
    """Arc lengths of the nodes of one cable [m], (elements + 1,)."""
    return np.linspace(0.0, length, elements + 1)


def element_count(tolerance: float) -> int:
    """Elements of a line for an accuracy tau."""
    return max(4, math.ceil(4.0 * (1e-2 / tolerance) ** 0.25))


def line_nodes(
    lengths: Sequence[float], elements: Sequence[int | None], tolerance: float
) -> list[FloatArray]:
    """Nodes of every cable of a line, each from 0 to its length."""
    total = math.fsum(lengths)
    count = element_count(tolerance)
    nodes = []
    for length, wanted in zip(lengths, elements, strict=True):
        n = wanted if wanted is not None else max(2, round(count * length / total))
        nodes.append(uniform_nodes(length, n))
    return nodes
