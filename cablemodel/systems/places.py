"""Where a system's nodes are at first, and where its static shape needs more of them."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.finite_element.start.refinement import (
    LARGEST_STATIC_MESH,
    REFINEMENT_BENT,
    bends_of,
)
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header
from cablemodel.solvers.shared.numbers import NO_SIZE
from cablemodel.systems.built import Built, Shape
from cablemodel.systems.guess import Guess
from cablemodel.systems.motion import axes_of, first_angles
from cablemodel.systems.scene import SystemScene
from cablemodel.systems.tree import Tree

FloatArray = NDArray[np.float64]
CHORD_OF_SLOPE = 1e-3
"""Of a line's length, to either side of a node: the chord that gives its first slope."""


def place_nodes(scene: SystemScene, built: Built, guess: Guess, before: Built | None) -> None:
    """Nodes along the first guess, or along the shape on coarser nodes."""
    tree = built.tree
    count = len(tree.parent)
    q = built.block.array(Header.position, count, 6)
    tension = built.block.array(Header.tension, count, 2)
    bodies = {node: name for name, (node, _point) in tree.bodies.items()}
    for node, (name, arc) in enumerate(tree.arcs):
        if node in bodies:
            body = scene.bodies[name]
            point = tree.bodies[name][1]
            arm = guess.axes[name] @ np.array(body.place(point))
            q[node, :3] = guess.bodies[name] + arm
            continue
        length = scene.lines[name].length
        near = np.clip(
            np.array([arc - CHORD_OF_SLOPE * length, arc, arc + CHORD_OF_SLOPE * length]),
            0.0,
            length,
        )
        places = guess.at(name, near)
        slope = places[2] - places[0]
        q[node, :3] = places[1]
        q[node, 3:] = slope / max(float(np.linalg.norm(slope)), NO_SIZE)
    for node, element in tree.elements.items():
        if tree.segments[element.segment].backward:
            q[node, 3:] *= -1.0
            parent = tree.parent[node]
            if tree.joint[parent] != 0 or parent == 0:
                q[parent, 3:] *= -1.0
    rows = built.block.array(Header.constraints, len(tree.held), at.CONSTRAINT_WORDS)
    for row, held in zip(rows, tree.held, strict=True):
        if row[at.Constraint.clamped]:
            vessel = scene.vessels[held.end.owner]
            own = row[at.Constraint.own_direction.span]
            q[held.node, 3:] = axes_of(first_angles(vessel)) @ own
    for node, name, direction in tree.clamps:
        q[node, 3:] = guess.axes[name] @ direction
    if before is not None:
        shape = Shape(before)
        for node, (name, arc) in enumerate(tree.arcs):
            if node in bodies:
                q[node, :3] = shape.bodies[name]
                continue
            q[node] = shape.at(name, arc, forward=_forward(tree, node))
        for node, element in tree.elements.items():
            name = tree.segments[element.segment].line
            tension[node, 0] = shape.tension(name, element.start + 0.5 * element.length)
    # Steps move what shares a place alike, but do not bring it together.
    for node, joint in enumerate(tree.joint):
        if joint in (at.JOINT_HINGE, at.JOINT_FREE):
            q[node, :3] = q[tree.parent[node], :3]


def _forward(tree: Tree, node: int) -> bool:
    """Whether the slope at a node goes along its line from beginning to end."""
    element = tree.elements.get(node)
    if element is None:
        after = [k for k in tree.elements if tree.parent[k] == node]
        element = tree.elements[after[0]]
    return not tree.segments[element.segment].backward


def divided(nodes: FloatArray, parts: int) -> FloatArray:
    """Arc lengths of nodes (n,) [m], with each element divided into equal parts."""
    count = parts * (len(nodes) - 1) + 1
    return np.asarray(np.interp(np.arange(count) / parts, np.arange(len(nodes)), nodes))


def refined(
    scene: SystemScene, nodes: dict[str, list[FloatArray]], built: Built
) -> dict[str, list[FloatArray]] | None:
    """Nodes with those elements halved that bend too much (start/refinement.py); None: none."""
    found, tree = built.elements(), built.tree
    indicator = bends_of(built.block)[found.node]
    split: dict[str, set[float]] = {}
    for k in range(len(found.node)):
        segment = tree.segments[found.segment[k]]
        if indicator[k] > REFINEMENT_BENT and segment.cable.elements is None:
            split.setdefault(segment.line, set()).add(float(found.start[k] + 0.5 * found.length[k]))
    if not split or built.nodes > LARGEST_STATIC_MESH:
        return None
    finer = {}
    for name, cables in nodes.items():
        offset, new = 0.0, []
        for places in cables:
            last = float(places[-1])
            more = [m - offset for m in split.get(name, ()) if 0.0 < m - offset < last]
            new.append(np.unique(np.concatenate([places, more])))
            offset += last
        finer[name] = new
    return finer
