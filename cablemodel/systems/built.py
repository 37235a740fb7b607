"""A system's block, with what tells its nodes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header, Line, Winch
from cablemodel.solvers.shared.numbers import ONE_PLACE
from cablemodel.systems.scene import SystemScene
from cablemodel.systems.tree import Tree

FloatArray = NDArray[np.float64]
Indices = NDArray[np.intp]


@dataclass(frozen=True)
class Elements:
    """Elements in the order of the tree, (n,) each."""

    node: Indices
    """At the far end of each, along the tree."""
    segment: Indices
    start: FloatArray
    """Arc length along its line at which it begins [m]."""
    length: FloatArray
    backward: NDArray[np.bool_]
    """The tree goes along it from the line's end to its beginning."""


@dataclass
class Built:
    """A block, and the tree on which it began; its mesh may have changed since."""

    scene: SystemScene
    block: Block
    tree: Tree
    unstable: bool = False
    """Its start is, which has been warned of."""
    friction_holds: bool = False
    """The floor's friction took hold of lines that lie to anchors at its start."""

    def __post_init__(self) -> None:
        segments = self.tree.segments
        self._backward = np.array([part.backward for part in segments], dtype=bool)
        self.lines = list(dict.fromkeys(part.line for part in segments))
        self._line = np.array([self.lines.index(part.line) for part in segments])
        self._winches = [(winch.line, winch.at) for winch in self.scene.winches.values()]

    def winch(self, number: int) -> Winch:
        """A winch by its number in the scene."""
        first = int(self.block.header.winches) + number * at.WINCH_WORDS
        return Winch(self.block.reals, first)

    @property
    def line_rows(self) -> dict[str, Line]:
        """The lines' rows of the table of lines, by name."""
        return {name: self.block.line(number) for number, name in enumerate(self.scene.lines)}

    def paid(self, line: str) -> tuple[float, float]:
        """What winches have paid out at the beginning and at the end of a line [m]."""
        paid = {"start": 0.0, "end": 0.0}
        for number, (of, end) in enumerate(self._winches):
            if of == line:
                paid[end] += self.winch(number).paid
        return paid["start"], paid["end"]

    @property
    def nodes(self) -> int:
        """How many there are."""
        return int(self.block.header.nodes)

    def elements(self, line: str | None = None) -> Elements:
        """All elements, or those of a line from its beginning to its end."""
        joints = self.block.integers(Header.joint, self.nodes)
        edges = self.block.array(Header.edges, self.nodes, at.EDGE_WORDS)
        node = np.flatnonzero(joints == 0)
        node = node[node > 0]
        segment = edges[node, at.Edge.segment].astype(np.intp)
        if line is not None:
            own = self._line[segment] == self.lines.index(line)
            node, segment = node[own], segment[own]
        length, backward = edges[node, at.Edge.length], self._backward[segment]
        start = edges[node, at.Edge.start]
        start = np.where(backward, -start - length, start)
        for number, (of, end) in enumerate(self._winches):
            if end == "start":
                start = start + self.winch(number).paid * (
                    self._line[segment] == self.lines.index(of)
                )
        if line is not None:
            order = np.argsort(start, kind="stable")
            node, segment, start = node[order], segment[order], start[order]
            length, backward = length[order], backward[order]
        return Elements(node, segment, start, length, backward)

    def body_nodes(self) -> Indices:
        """Nodes of the free bodies, in the scene's order: the tree has them in its own."""
        count = int(self.block.header.free_count)
        rows = self.block.array(Header.free_bodies, count, at.FREE_WORDS)
        return rows[:, at.FreeBody.node].astype(np.intp)

    def where(self, node: int) -> tuple[str, float]:
        """The part that a node is of, and its arc length there [m]; of a body 0."""
        bodies = self.body_nodes()
        if node in bodies:
            return list(self.scene.bodies)[int(np.flatnonzero(bodies == node)[0])], 0.0
        found = self.elements()
        place = min(int(np.searchsorted(found.node, node)), len(found.node) - 1)
        arc = found.start[place]
        if (found.node[place] == node) is not bool(found.backward[place]):
            arc += found.length[place]
        return self.tree.segments[found.segment[place]].line, float(arc)


class Shape:
    """Cubics of a block's elements, to start from on other nodes."""

    def __init__(self, built: Built) -> None:
        block, count = built.block, built.nodes
        self._q = block.array(Header.position, count, 6)
        self._t = block.array(Header.tension, count, 2)
        self._parents = block.integers(Header.parent, count)
        self.bodies = {
            name: self._q[node, :3]
            for name, node in zip(built.scene.bodies, built.body_nodes(), strict=True)
        }
        self._lines = {name: built.elements(name) for name in built.lines}

    def _element(self, name: str, arc: float) -> tuple[int, int]:
        """Number of the element at an arc length among those of its line, and its node."""
        elements = self._lines[name]
        place = int(np.searchsorted(elements.start, arc + ONE_PLACE, side="right")) - 1
        place = max(place, 0)
        return place, int(elements.node[place])

    def at(self, name: str, arc: float, *, forward: bool) -> FloatArray:
        """Place and slope (6,) at an arc length of a line."""
        place, node = self._element(name, arc)
        elements = self._lines[name]
        h, backward = float(elements.length[place]), bool(elements.backward[place])
        x = min(1.0, max(0.0, (arc - float(elements.start[place])) / h))
        x = 1.0 - x if backward else x
        p, q = self._q[self._parents[node]], self._q[node]
        y = 1.0 - x
        point = y * y * (1 + 2 * x) * p[:3] + h * x * y * y * p[3:]
        point = point + x * x * (3 - 2 * x) * q[:3] - h * x * x * y * q[3:]
        slope = 6 * x * y * (q[:3] - p[:3]) / h + y * (1 - 3 * x) * p[3:] + x * (3 * x - 2) * q[3:]
        if backward is forward:
            slope = -slope
        return np.concatenate([point, slope])

    def tension(self, name: str, arc: float) -> float:
        """Mean tension of the element there [N]."""
        return float(self._t[self._element(name, arc)[1], 0])
