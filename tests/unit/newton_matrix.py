"""The Newton matrix in a block's memory as a dense one, and the one that differences give."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.shared.layout import Header

FloatArray = NDArray[np.float64]


def blocks(memory: Block, nodes: int, size: int) -> list[FloatArray]:
    """Views of diagonal, upper and lower blocks, each (nodes, size, size)."""
    return [
        memory.array(place, nodes, size, size)
        for place in (Header.diagonal.word, Header.upper.word, Header.lower.word)
    ]


def clear(memory: Block, nodes: int, size: int) -> None:
    """Zero the matrix, before kernels add to it."""
    for block in blocks(memory, nodes, size):
        block[:] = 0.0


def dense(memory: Block, nodes: int, size: int) -> FloatArray:
    """The matrix of a chain, (nodes size, nodes size)."""
    diagonal, upper, lower = blocks(memory, nodes, size)
    matrix = np.zeros((nodes * size, nodes * size))
    for node in range(nodes):
        own = slice(size * node, size * (node + 1))
        above = slice(size * (node - 1), size * node)
        matrix[own, own] += diagonal[node]
        if node:
            matrix[above, own] += upper[node]
            matrix[own, above] += lower[node]
    return matrix


def differences(
    residual: Callable[[FloatArray], FloatArray], count: int, step: float
) -> FloatArray:
    """Central differences of a residual by each of `count` unknowns, (rows, count)."""
    return np.array(
        [(residual(step * e) - residual(-step * e)) / (2.0 * step) for e in np.eye(count)]
    ).T
