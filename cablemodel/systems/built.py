"""A system's block, with what tells its nodes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header, Line, Winch
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
