"""Whether what is at rest stays there: small motions of a line that grow without swinging.

About an equilibrium small motions q of the free unknowns obey M q'' + C q' + K q = 0, and one that
grows by exp(l t) is a root l > 0 of det A(l), A(l) = l^2 M + l C + K. Where drag, friction and
clamps make no difference between cause and effect (K and C symmetric, as at rest in still water)
each such l is where an eigenvalue of A passes through zero, and there are as many above l as A(l)
has negative ones: as many as the pivots of its elimination have (Sylvester's law of inertia;
W. H. Wittrick and F. W. Williams, Q. J. Mech. Appl. Math. 24 (1971) 263). In flowing water K is not
symmetric: an odd count still proves a root, since det A(l) > 0 for large l; an even one is a hint
that the motion itself, found by inverse iteration, confirms. In both the count was the number of
growing motions in all scenes that were looked at, by the eigenvalues of the dense matrices. Motions
that swing as they grow (flutter) are not looked for.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers import library as entry
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.linearisation import newton_blocks
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header

FloatArray = NDArray[np.float64]

SLOWEST = 0.03
"""Growth that matters, over sqrt(g/L): below it are motions that nothing drives nor holds back, as
of a line that may turn about its tow point."""
STABILITY_FASTEST = 1e6
"""The same, beyond which none is looked for."""
ACCURACY = 1e-4
"""Of a growth rate, relative."""
STRIDE = 1.03
"""From one rate to the next, where one is looked for by the sign of what resists it least."""
STABILITY_ITERATIONS = 6
"""For the shape of a growing motion, whose rate is known."""
FORCE_ASIDE = 1e-6
"""Of the forces along an axis, those along the next one, by which a motion is sought."""
MUCH = 0.3
"""Of a motion's largest, what its side is read from: where it is largest depends on the mesh."""
ACROSS = 1e-3
"""Of a motion's largest, what counts as a motion along an axis."""
SAME = 0.99
"""Cosine between two iterates of one that is found."""


@dataclass(frozen=True)
class GrowingMotion:
    """A motion that leaves an equilibrium by itself."""

    rate: float
    """It grows by exp(rate t) [1/s]."""
    motion: FloatArray
    """Of places and slopes of the nodes, (nodes, 2, dimension): 1 where it is largest."""
    arc: float
    """Where that is: unstretched arc length from the vessel at the start [m]."""


class _Elimination:
    """A(l) of a line, eliminated from its far end to the vessel, node by node."""

    def __init__(self, block: Block, rate: float) -> None:
        diagonal, upper, lower = newton_blocks(block, rate, rate * rate)
        nodes, size = diagonal.shape[:2]
        half = size // 2
        self._projectors = _hold(block, diagonal, upper, lower)
        self._hinged = (block.integers(Header.joint, nodes) == at.JOINT_HINGE).tolist()
        self._parents = block.integers(Header.parent, nodes).tolist()
        self._upper = upper
        self._back = np.zeros_like(lower)
        """What a node's parent moves it by, negative."""
        self.pivots = diagonal
        """(nodes, size, size); of a hinge's own node only the block of its slope is one."""
        for node in range(nodes - 1, 0, -1):
            own, above = diagonal[node], diagonal[self._parents[node]]
            if self._hinged[node]:  # its place is its parent's
                back = np.linalg.solve(own[half:, half:], own[half:, :half])
                above[:half, :half] += own[:half, :half] - own[:half, half:] @ back
                self._back[node, half:, :half] = back
                self._back[node, :half, :half] = -np.eye(half)
                self._upper[node, :half, half:] = own[:half, half:]
                own[:half, :half] = abs(np.trace(own[half:, half:])) * np.eye(half)
                own[:half, half:] = own[half:, :half] = 0.0
            else:
                self._back[node] = np.linalg.solve(own, lower[node])
                above -= upper[node] @ self._back[node]

    def solve(self, forces: FloatArray) -> FloatArray:
        """x of A x = forces, (nodes, size) each, where supports hold nothing back."""
        x = forces.copy()
        nodes, size = x.shape
        half = size // 2
        for projector, node in self._projectors:
            x[node] = projector @ x[node]
        for node in range(nodes - 1, 0, -1):
            above = x[self._parents[node]]
            if self._hinged[node]:
                above[:half] += x[node, :half]
                x[node, :half] = 0.0
            x[node] = np.linalg.solve(self.pivots[node], x[node])
            above -= self._upper[node] @ x[node]
        x[0] = np.linalg.solve(self.pivots[0], x[0])
        for node in range(1, nodes):
            x[node] -= self._back[node] @ x[self._parents[node]]
        return x


def growing_motion(block: Block, way: FloatArray | None = None) -> GrowingMotion | None:
    """The motion that grows fastest out of a block's state of rest; None: none was found.

    Costs one elimination, 25 us a node, where all is stable. The block stays as it is.

    Args:
        way: horizontal unit vector in the block's coordinates, (dimension,); None: along the first.
            What may go any way goes that way, and of both senses of a motion this is the one in
            which the last place that moves much does, a free end for one; if it moves across, to
            the left, then up.
    """
    slowest = slowest_growth(block)
    if is_held(block, slowest):
        return None
    low, high = slowest, 2.0 * slowest
    while not is_held(block, high):
        if high > STABILITY_FASTEST * slowest:
            return None
        low, high = high, 2.0 * high
    while high > (1.0 + ACCURACY) * low:
        middle = float(np.sqrt(low * high))
        if is_held(block, middle):
            high = middle
        else:
            low = middle
    axes = _axes(int(block.header.dimension), way)
    if not _changes_sign(block, low, high, axes):
        # Complex resistances have, of nodes alone: what does may be below.
        low, high = _bracket_below(block, low, slowest, axes)
        if not low < high:
            return None
    motion, _held = _motion(_Elimination(block, high), axes)
    sizes = np.linalg.norm(motion[:, 0], axis=1)
    furthest = int(np.argmax(sizes))
    motion /= sizes[furthest]
    much = np.flatnonzero(sizes > MUCH * sizes[furthest])
    components = axes @ motion[much[-1], 0]
    motion *= np.sign(components[np.abs(components) > ACROSS][0])
    edges = block.array(Header.edges, len(motion), at.EDGE_WORDS)
    arc = (
        float(edges[furthest, at.Edge.start] + edges[furthest, at.Edge.length]) if furthest else 0.0
    )
    return GrowingMotion(high, motion, arc)


def _changes_sign(block: Block, low: float, high: float, axes: FloatArray) -> bool:
    """Whether a single motion is helped just below a rate and held just above it [1/s]."""
    if _motion(_Elimination(block, high), axes)[1] < SAME:
        return False
    return _motion(_Elimination(block, low), axes)[1] <= -SAME


def _bracket_below(
    block: Block, high: float, slowest: float, axes: FloatArray
) -> tuple[float, float]:
    """The fastest rate below one at which the least resistance changes its sign, from both sides.

    Two equal ones: there is none [1/s].
    """
    held = _motion(_Elimination(block, high), axes)[1]
    while high > slowest:
        low, before = high / STRIDE, held
        held = _motion(_Elimination(block, low), axes)[1]
        if held < 0.0 < before:
            upper = high
            while upper > (1.0 + ACCURACY) * low:
                middle = float(np.sqrt(low * upper))
                if _motion(_Elimination(block, middle), axes)[1] > 0.0:
                    upper = middle
                else:
                    low = middle
            if _changes_sign(block, low, upper, axes):
                return low, upper
            low = high / STRIDE
        high = low
    return high, high


def slowest_growth(block: Block) -> float:
    """Growth that matters [1/s]."""
    return SLOWEST / float(block.scalars.period)


def is_held(block: Block, rate: float) -> bool:
    """Whether no small motion about a block's state grows faster than a rate [1/s].

    Of a state that is none of rest: whether an implicit step of the length 1 / rate leads on, and
    not back to what is at rest and unstable.
    """
    kept = block.image.copy()
    growing = entry.count_growing(block.ints, block.reals, rate)
    block.image[:] = kept
    return bool(growing == 0)


def _hold(
    block: Block, diagonal: FloatArray, upper: FloatArray, lower: FloatArray
) -> list[tuple[FloatArray, int]]:
    """Fix what supports hold, as `system.constrain_matrix` does; the projectors and their nodes."""
    dimension = int(block.header.dimension)
    table = block.array(Header.constraints, int(block.header.constraint_count), at.CONSTRAINT_WORDS)
    projectors = []
    for row in table:
        node = int(row[at.Constraint.node])
        free = np.zeros((2 * dimension, 2 * dimension))
        free[dimension:, dimension:] = np.eye(dimension)
        if row[at.Constraint.clamped] == at.EXACTLY:
            direction = row[at.Constraint.direction : at.Constraint.direction.word + dimension]
            free[dimension:, dimension:] = np.outer(direction, direction)
        fixed = np.eye(2 * dimension) - free
        size = max(1.0, abs(float(np.trace(diagonal[node]))))
        diagonal[node] = free @ diagonal[node] @ free + size * fixed
        lower[node], upper[node] = free @ lower[node], upper[node] @ free
        for child in np.flatnonzero(block.integers(Header.parent, len(diagonal)) == node):
            if child > node:
                upper[child], lower[child] = free @ upper[child], lower[child] @ free
        projectors.append((free, node))
    return projectors


def _axes(dimension: int, way: FloatArray | None) -> FloatArray:
    """A way, across it to the left, and up, (dimension, dimension)."""
    if way is None:
        return np.eye(dimension)
    if dimension == 2:
        return np.array([way, [0.0, 1.0]])
    return np.array([way, [-way[1], way[0], 0.0], [0.0, 0.0, 1.0]])


def _motion(matrix: _Elimination, axes: FloatArray) -> tuple[FloatArray, float]:
    """What A(l) resists least, by inverse iteration, and whether it does or helps.

    It begins with forces along the first axis that grow along the cable, and hardly any along the
    others. Returns (nodes, 2, dimension), and the cosine between motion and forces: near 1 where A
    resists, near -1 where it helps, something else where no single motion was found.
    """
    nodes, dimension = len(matrix.pivots), len(axes)
    x = np.zeros((nodes, 2 * dimension))
    x[:, :dimension] = np.outer(
        np.arange(1.0, nodes + 1.0), FORCE_ASIDE ** np.arange(dimension) @ axes
    )
    cosine = 0.0
    for _iteration in range(STABILITY_ITERATIONS):
        forces = x / np.linalg.norm(x)
        x = matrix.solve(forces)
        size = float(np.linalg.norm(x))
        if not 0.0 < size < np.inf:
            break
        cosine = float(np.sum(x * forces)) / size
    return x.reshape(nodes, 2, dimension), cosine
