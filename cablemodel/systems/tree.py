"""The parts of a system as a tree of nodes: lines from where they are held, bodies between them.

Elimination runs from the leaves to the roots (kernels/line/block_solver.py). A line's end that is
held is a root or a leaf, so that lines between vessels and anchors close no cycle. A body takes its
place where the first line comes to it; all others begin at it. Where a line comes to what is in the
tree before, a closure ties both (kernels/line/closures.py).
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from cablemodel.scene.line import Body, Cable
from cablemodel.solvers.finite_element.start.line import hinged
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.numbers import ONE_PLACE
from cablemodel.systems.lines import bends_at, cable_of
from cablemodel.systems.scene import LineEnd, SystemScene, SystemWinch

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Held:
    """A node whose place is prescribed."""

    node: int
    line: str
    end: LineEnd
    outward: bool
    """The tree goes from this end along the line, not to it."""

    @property
    def top(self) -> int:
        """Node of the element there."""
        return self.node + 1 if self.outward else self.node


@dataclass
class Segment:
    """A stretch of cable of one kind without branches, within which elements may be joined; or
    cable on a drum, before or after what it follows in the line."""

    line: str
    cable: Cable
    backward: bool
    """The tree goes along it from the line's end towards its beginning."""
    chain: int
    """Segments of one number follow on each other without branches."""
    end: float = math.nan
    """Arc length [m] where the tree leaves it, negative where it goes backward along the line."""
    hinged: bool = False
    """Its slope at its beginning is its own."""
    mass: int = -1
    """Number of the point body there; -1: none."""


@dataclass(frozen=True)
class Mass:
    """A point body in a line or on a drum."""

    node: int
    """-1: on a drum."""
    body: Body
    owner: str
    """The line or the winch."""
    number: int
    """Which of its bodies, from 1: along the line, or in the order in which they leave."""


@dataclass(frozen=True)
class Element:
    """An element of a line."""

    segment: int
    start: float
    """Arc length along the line at which it begins [m]."""
    length: float


@dataclass
class Tree:
    """Nodes, each with what ties it to its parent."""

    nodes: dict[str, list[FloatArray]] = field(default_factory=dict)
    """Arc lengths of every line's nodes along each of its cables [m]."""
    parent: list[int] = field(default_factory=list)
    joint: list[int] = field(default_factory=list)
    segments: list[Segment] = field(default_factory=list)
    elements: dict[int, Element] = field(default_factory=dict)
    """By the node at the far end of each."""
    arcs: list[tuple[str, float]] = field(default_factory=list)
    """Line and arc length of every node; of a body its name and 0."""
    held: list[Held] = field(default_factory=list)
    bodies: dict[str, tuple[int, str]] = field(default_factory=dict)
    """Free bodies: node, and the point that is the reference (empty: the body's origin)."""
    arms: list[tuple[int, str, str]] = field(default_factory=list)
    """Nodes at bodies' points: node, body, point."""
    closures: list[tuple[int, str, str | float]] = field(default_factory=list)
    """Nodes at what is in the tree before: node, body and its point, or line and arc length."""
    clamps: list[tuple[int, str, FloatArray]] = field(default_factory=list)
    """Nodes whose slope a body turns: node, body, direction along the tree in its axes (3,)."""
    masses: list[Mass] = field(default_factory=list)
    wound: dict[str, list[Segment]] = field(default_factory=dict)
    """Of each winch, the segment of each cable on its drum, in the order in which they leave."""

    def held_at(self, scene: SystemScene, winch: SystemWinch) -> Held:
        """Where a winch is."""
        end = scene.lines[winch.line].end_at(winch.at)
        return next(held for held in self.held if held.line == winch.line and held.end is end)

    def add(self, parent: int, joint: int, place: tuple[str, float]) -> int:
        """A new node's number."""
        self.parent.append(max(parent, 0))
        self.joint.append(joint)
        self.arcs.append(place)
        return len(self.parent) - 1


class _Builder:
    def __init__(self, scene: SystemScene, nodes: dict[str, list[FloatArray]]) -> None:
        self.scene = scene
        self.nodes = nodes
        self.tree = Tree(nodes)
        self.placed: set[str] = set()
        self.chains = 0

    def build(self) -> Tree:
        """All parts, those that are held first."""
        lines = self.scene.lines
        for wanted in ("held", "free", "body"):
            for name, line in lines.items():
                for side, end in enumerate(line.ends):
                    if name in self.placed or self._kind(end) != wanted:
                        continue
                    if wanted == "body":
                        self._place_body(end.owner, -1, "")
                    else:
                        self._begin(name, side)
        self._wind_up()
        return self.tree

    def _kind(self, end: LineEnd) -> str:
        if end.anchor is not None:
            return "held"
        if end.line is not None:
            return "branch"
        if end.point is None:
            return "free"
        return "held" if end.owner in self.scene.vessels else "body"

    def _begin(self, name: str, side: int) -> None:
        """A root at an end of a line."""
        tree, line = self.tree, self.scene.lines[name]
        arc = line.length if side else 0.0
        joint = at.JOINT_ROOT if tree.parent else 0
        node = tree.add(0, joint, (name, arc))
        end = line.ends[side]
        if self._kind(end) == "held":
            tree.held.append(Held(node, name, end, outward=True))
        self.placed.add(name)
        self._run(name, node, arc, 0.0 if side else line.length)

    def _place_body(self, body: str, parent: int, point: str) -> None:
        """A body at the end of a line, or as a root, and all lines that begin at it."""
        tree = self.tree
        joint = at.JOINT_FREE if parent >= 0 else at.JOINT_ROOT_FREE
        node = tree.add(parent, joint, (body, 0.0))
        tree.bodies[body] = node, point
        for name, line in self.scene.lines.items():
            for side, end in enumerate(line.ends):
                if name in self.placed or end.point is None:
                    continue
                place = end.of_owner
                if end.owner == body:
                    arc = line.length if side else 0.0
                    arm = tree.add(node, at.JOINT_ARM, (name, arc))
                    tree.arms.append((arm, body, place))
                    self._clamp(name, side, arm, body, outward=True)
                    self.placed.add(name)
                    self._run(name, arm, arc, 0.0 if side else line.length)

    def _run(self, name: str, node: int, start: float, stop: float) -> None:
        """Elements of a line from a node at one arc length to another, and what is at its end."""
        tree, line = self.tree, self.scene.lines[name]
        backward = stop < start
        branches: list[tuple[int, str, int]] = []
        self.chains += 1
        before = -1
        parts = False
        for item, left, right, jumps, mass in self._pieces(name, start, stop):
            if parts or item != before:
                self.chains += parts
                cable = cable_of(self.scene, name, item)
                tree.segments.append(Segment(name, cable, backward, self.chains, hinged=jumps))
                before = item
            if jumps or (parts and self._hinged(name, item, item, body=True)):
                node = tree.add(node, at.JOINT_HINGE, (name, left))
            if mass is not None:
                tree.segments[-1].mass = len(tree.masses)
                tree.masses.append(self._mass(node, name, mass[0]))
            node = tree.add(node, at.JOINT_NONE, (name, right))
            index = len(tree.segments) - 1
            tree.segments[index].end = -right if backward else right
            tree.elements[node] = Element(index, min(left, right), abs(right - left))
            joined = [(node, *branch) for branch in self._branches(name, right)]
            branches += joined
            parts = len(joined) > 0
        last = line.items[0 if backward else -1]
        side = 0 if backward else 1
        if last.body is not None:
            index = 0 if backward else len(line.items) - 1
            tree.masses.append(self._mass(node, name, index))
        self._finish(name, side, node)
        for junction, other, other_side in branches:
            if other in self.placed:
                continue
            self.placed.add(other)
            arc = self.scene.lines[other].length if other_side else 0.0
            branch = tree.add(junction, at.JOINT_HINGE, (other, arc))
            self._run(other, branch, arc, 0.0 if other_side else self.scene.lines[other].length)

    def _mass(self, node: int, name: str, item: int) -> Mass:
        """The point body that is an item of a line, at a node."""
        items = self.scene.lines[name].items
        body = items[item].body
        assert body is not None
        return Mass(node, body, name, sum(other.body is not None for other in items[: item + 1]))

    def _wind_up(self) -> None:
        """Put what is on drums beside the segments from which it goes on."""
        tree = self.tree
        beside: dict[tuple[int, bool], list[Segment]] = {}
        for name, winch in self.scene.winches.items():
            held = tree.held_at(self.scene, winch)
            top = tree.elements[held.top].segment
            beside[top, held.outward] = self._wound(name, winch, top, held.outward)
        segments: list[Segment] = []
        numbers: list[int] = []
        for index, segment in enumerate(tree.segments):
            segments += reversed(beside.get((index, True), []))
            numbers.append(len(segments))
            segments += [segment, *beside.get((index, False), [])]
        tree.segments = segments
        for node, element in tree.elements.items():
            tree.elements[node] = replace(element, segment=numbers[element.segment])

    def _wound(self, name: str, winch: SystemWinch, top: int, outward: bool) -> list[Segment]:
        """Segments on a drum in the order in which they leave; what goes on as the segment at the
        winch did is a part of that.

        outward: the tree goes on from the winch, so that what follows comes before.
        """
        tree = self.tree
        last = tree.segments[top]
        own = tree.wound.setdefault(name, [])
        place = last.end
        if outward:
            place -= math.fsum(e.length for e in tree.elements.values() if e.segment == top)
        found: list[Segment] = []
        body: Body | None = None
        for item in winch.drum:
            cable = item.cable
            if cable is None:
                body = item.body
                continue
            kinds = (cable.type, cable.model), (last.cable.type, last.cable.model)
            alike = kinds[0] == kinds[1] and cable.elements is None
            if body is not None or not alike:
                new = Segment(last.line, cable, last.backward, last.chain, end=place)
                inner = last if outward else new
                inner.hinged = hinged(self.scene, last.cable, cable, body is not None)
                if body is not None:
                    inner.mass = len(tree.masses)
                    number = 1 + sum(mass.owner == name for mass in tree.masses)
                    tree.masses.append(Mass(-1, body, name, number))
                    body = None
                found.append(new)
                last = new
            own.append(last)
            place += -cable.length if outward else cable.length
            if not outward:
                last.end = place
        return found

    def _clamp(self, name: str, side: int, node: int, body: str, *, outward: bool) -> None:
        """The clamp of a line's end at a body, unless its cable passes no moment."""
        line = self.scene.lines[name]
        end = line.ends[side]
        if bends_at(self.scene, line, end):
            sign = 1.0 if outward is (side == 0) else -1.0
            self.tree.clamps.append((node, body, sign * np.array(end.clamped)))

    def _finish(self, name: str, side: int, node: int) -> None:
        """What a line comes to."""
        end = self.scene.lines[name].ends[side]
        kind = self._kind(end)
        if kind == "held":
            self.tree.held.append(Held(node, name, end, outward=False))
        elif kind == "body":
            body, point = end.owner, end.of_owner
            self._clamp(name, side, node, body, outward=False)
            if body in self.tree.bodies:
                self.tree.closures.append((node, body, point))
            else:
                self._place_body(body, node, point)
        elif kind == "branch":
            assert end.line is not None
            assert end.at is not None
            if end.line in self.placed:
                self.tree.closures.append((node, end.line, end.at))
                return
            self.placed.add(end.line)
            for stop in (self.scene.lines[end.line].length, 0.0):
                begin = self.tree.add(node, at.JOINT_HINGE, (end.line, end.at))
                self._run(end.line, begin, end.at, stop)

    def _branches(self, name: str, arc: float) -> list[tuple[str, int]]:
        """Lines, each with the end of it, that begin or end on a line at an arc length."""
        return [
            (other, side)
            for other, line in self.scene.lines.items()
            for side, end in enumerate(line.ends)
            if end.line == name and end.at is not None and abs(end.at - arc) <= ONE_PLACE
        ]

    def _pieces(
        self, name: str, start: float, stop: float
    ) -> list[tuple[int, float, float, bool, tuple[int, Body] | None]]:
        """Elements between two arc lengths in the order of the way: item, both ends, whether a
        hinge comes before it, and a body there."""
        line = self.scene.lines[name]
        backward = stop < start
        found = []
        offset = 0.0
        cables = [k for k, item in enumerate(line.items) if item.cable is not None]
        for index, places in zip(cables, self.nodes[name], strict=True):
            for left, right in itertools.pairwise(places + offset):
                found.append((index, float(left), float(right)))
            offset += float(places[-1])
        low, high = sorted((start, stop))
        low, high = low - ONE_PLACE, high + ONE_PLACE
        within = [piece for piece in found if piece[1] >= low and piece[2] <= high]
        if backward:
            within = [(index, right, left) for index, left, right in reversed(within)]
        pieces = []
        before: int | None = None
        for index, left, right in within:
            jumps, mass = False, None
            if before is not None and before != index:
                between = line.items[min(before, index) + 1]
                if between.body is not None:
                    mass = (min(before, index) + 1, between.body)
                jumps = self._hinged(name, before, index, body=mass is not None)
            elif before is None:
                first = line.items[-1 if backward else 0]
                if first.body is not None and start in (0.0, line.length):
                    mass = (len(line.items) - 1 if backward else 0, first.body)
            pieces.append((index, left, right, jumps, mass))
            before = index
        return pieces

    def _hinged(self, name: str, one: int, other: int, *, body: bool) -> bool:
        """Whether the slope may jump from one cable to the next. body: a force acts between."""
        cables = cable_of(self.scene, name, one), cable_of(self.scene, name, other)
        return hinged(self.scene, *cables, body)


def tree_of(scene: SystemScene, nodes: dict[str, list[FloatArray]]) -> Tree:
    """The tree of a system.

    nodes: for every line the arc lengths of the nodes of each of its cables, from 0 to the cable's
    length [m]; branches are at nodes.
    """
    return _Builder(scene, nodes).build()
