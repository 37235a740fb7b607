"""The line as nodes and edges, before it goes into a block."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.finite_element.mesh import Span
from cablemodel.solvers.finite_element.start.scales import is_flexible, pays_out, sinks
from cablemodel.solvers.shared import layout as at

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.scene.common import CableScene
    from cablemodel.scene.line import Body, Cable

FloatArray = NDArray[np.float64]

SHARP = 0.25
"""Of a bending layer: what is resolved where a clamp turns the line back; elements that turn by
more than a right angle find no equilibrium."""
CLAMPED_UP = 0.1
"""Upward part of a clamp's direction that turns a line back which sinks."""


@dataclass
class Line:
    """The line as nodes and edges, before it goes into a block."""

    parent: list[int]
    joint: list[int]
    length: list[float]
    start: list[float]
    cable: list[int]
    passed: list[float]
    """Length of the bodies between the vessel and each node [m]: not cable, but in the way."""
    bodies: list[tuple[int, Body, int]]
    """Node (-1: on the drum), body, its place in the scene's line and drum.

    The node of a body of finite length is its outer attachment, its parent the inner one."""
    nominal: list[float]
    """Length of an element of every cable of the line [m]."""

    @property
    def nodes(self) -> int:
        return len(self.parent)


def spans_of(scene: Scene, scale: float) -> list[Span]:
    """The cables as the mesh sees them: bending layers at clamps, and at bodies of an elastica."""
    spans = []
    items = list(scene.line)
    clamped = scene.vessel.connection.kind == "clamped"
    for place, item in enumerate(items):
        if item.cable is None:
            clamped = item.body is not None
            continue
        cable = item.cable
        kind = scene.cable_types[cable.type]
        layer = math.inf
        if not is_flexible(scene, cable):
            layer = math.sqrt(kind.bending_stiffness / scale)
        last = place == len(items) - 1
        ends_clamped = scene.end.connection.kind == "clamped" if last else False
        body = None if last else items[place + 1].body
        # A point body at the end bends nothing.
        before_body = body is not None and (body.half_length > 0.0 or place + 2 < len(items))
        body_layer = cable.model == "elastica"
        # Where cable runs past a clamped tow point no mesh stays that resolves its layer.
        at_start = clamped and (body_layer if place > 0 else not pays_out(scene))
        thinner = SHARP if place == 0 and _bends_back(scene) else 1.0
        at_end = ends_clamped or (before_body and body_layer)
        spans.append(
            Span(
                cable.length,
                cable.elements,
                thinner * layer if at_start else math.inf,
                layer if at_end else math.inf,
            )
        )
        clamped = False
    return spans


def _bends_back(scene: Scene) -> bool:
    """Whether a clamp at the vessel turns the line away from where it hangs."""
    direction = scene.vessel.connection.direction
    return direction is not None and (direction[2] > CLAMPED_UP) == sinks(scene)


def lay_out(scene: Scene, spaced: list[FloatArray]) -> Line:
    """Joints and bodies of the scene's line on the nodes of its cables, vessel first."""
    items = list(scene.line)
    line = Line([-1], [0], [0.0], [0.0], [0], [0.0], [], [])
    arc = 0.0
    index = -1
    previous: Cable | None = None
    body: Body | None = None

    def add(joint: int, length: float, start: float, ahead: float = 0.0) -> None:
        line.parent.append(line.nodes - 1)
        line.joint.append(joint)
        line.length.append(length)
        line.start.append(start)
        line.cable.append(index)
        line.passed.append(line.passed[-1] + ahead)

    for place, item in enumerate(items):
        if item.body is not None:
            body = item.body
            if body.half_length > 0.0:
                add(at.JOINT_BODY, 0.0, arc, 2.0 * body.half_length)
            line.bodies.append((line.nodes - 1, body, place))
            continue
        cable = item.cable
        assert cable is not None
        index += 1
        rigid = body is not None and body.half_length > 0.0
        if previous is not None and not rigid and hinged(scene, previous, cable, body is not None):
            add(at.JOINT_HINGE, 0.0, arc)
        nodes = spaced[index]
        line.nominal.append(float(np.max(np.diff(nodes))))
        for left, right in itertools.pairwise(nodes):
            add(at.JOINT_NONE, float(right - left), arc + float(left))
        arc += cable.length
        previous = cable
        body = None
    return line


def hinged(scene: CableScene, lower: Cable, upper: Cable, body: bool) -> bool:
    """Whether a joint of two cables lets the slope jump.

    A flexible cable passes no moment, whatever its model: a slope that no stiffness holds would
    only be held by the elements. A hybrid is flexible at a body, where its tension jumps.
    """
    flexible = is_flexible(scene, lower) or is_flexible(scene, upper)
    return flexible or (body and "hybrid" in (lower.model, upper.model))
