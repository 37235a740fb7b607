"""From an equilibrium that does not last to one that does.

A relaxation's long steps damp what grows, too, and may end where a column stands upright or a clamp
has turned a line back further than it stays. Such a start is pushed a little along the motion that
grows fastest, to the side behind the vessel, and followed (falling.py) on elements that become
shorter where it bends.
What falls too far for that, as a line that floats under a sinker, begins anew from where weights
draw it; or falls to the other side.
"""

from __future__ import annotations

import copy
import itertools
import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import StaticsError, UnstableStartWarning
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.stability import (
    GrowingMotion,
    growing_motion,
    is_held,
    slowest_growth,
)
from cablemodel.solvers.finite_element.start import search
from cablemodel.solvers.finite_element.start.falling import TIMES, fall
from cablemodel.solvers.finite_element.start.first_shape import drawn_by_weight, graded
from cablemodel.solvers.finite_element.start.first_state import count_from_zero, steady_velocity
from cablemodel.solvers.finite_element.start.frame import earth, local
from cablemodel.solvers.finite_element.start.laid_loads import behind, water_velocity
from cablemodel.solvers.finite_element.start.laid_shape import Guess
from cablemodel.solvers.finite_element.start.refinement import guess_of, refined
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header

if TYPE_CHECKING:
    from cablemodel.scene import Scene

FloatArray = NDArray[np.float64]
Nodes = list[FloatArray]
"""Arc lengths of the nodes of every cable [m], each from 0 to its length."""

LARGEST_MESH = 60, 4.0
"""Nodes on the way, at most: so many, and times those of the equilibrium that is left."""


@dataclass(frozen=True)
class Ways:
    """To blocks from nodes and a guess of the shape."""

    stand: Callable[[Nodes, Guess], Block]
    """At rest in that shape, in equilibrium or not."""
    start: Callable[[Nodes, Guess], Block]
    """At the equilibrium near it, on a mesh that this refines; may raise StaticsError."""
    in_place: bool
    """An equilibrium that a line has fallen to on its own mesh is not sought anew: what lies held
    by friction would be laid once more, as it was before it fell."""


def left(block: Block, scene: Scene, ways: Ways) -> Block:
    """The block, or where its equilibrium is unstable, one at an equilibrium that is not.

    Warns:
        UnstableStartWarning: no stable one was found; the block is as it was.
    """
    if stays(block, scene):
        return block  # as nearly all do
    way = _way(block, scene)
    first = growing_motion(_without_flow(block, scene), way)
    if first is None:
        return block
    strategies: list[Callable[[], Block | None]] = [
        partial(_fallen, block, scene, ways, first, 1.0),
        partial(_hung_by_weight, block, scene, ways),
        partial(_fallen, block, scene, ways, first, -1.0),
    ]
    for strategy in strategies:
        try:
            found = strategy()
            for _time in range(TIMES):
                if found is None:
                    break
                growing = growing_motion(_without_flow(found, scene), way)
                if growing is None:
                    return found
                found = _fallen(found, scene, ways, growing, 1.0)
        except StaticsError:
            continue
        except search.OutOfTimeError:
            break
    warnings.warn(UnstableStartWarning(first.rate, first.arc), stacklevel=2)
    return block


def stays(block: Block, scene: Scene) -> bool:
    """Whether no small motion about a block's start grows by a rate that matters."""
    still = _without_flow(block, scene)
    return is_held(still, slowest_growth(still))


def _without_flow(block: Block, scene: Scene) -> Block:
    """The block with cable that stands still in its shape, where a winch pays out."""
    from cablemodel.solvers import library as entry

    if scene.rate_at_start == 0.0:
        return block
    still = copy.deepcopy(block)
    entry.stop_flow(still.ints, still.reals, steady_velocity(block, scene))
    return still


def _way(block: Block, scene: Scene) -> FloatArray:
    """Behind the vessel, else downstream, in the block's coordinates, (dimension,): where a line
    goes that may go any way."""
    position, velocity = scene.motion().evaluate(0.0)[:2]
    current = water_velocity(scene, position[2:3])[0]
    way = local(block, np.array([*behind(scene, velocity[:2], current[:2]), 0.0]), point=False)
    if block.header.dimension == 2:
        way = np.array([math.copysign(1.0, float(way[0])), 0.0])
    return way


def _hung_by_weight(standing: Block, scene: Scene, ways: Ways) -> Block | None:
    """Start anew from where the line is drawn by what hangs or floats beyond each place."""
    way = earth(standing, _way(standing, scene)[None])[0] - standing.scalars.origin
    shape = drawn_by_weight(scene, scene.motion().evaluate(0.0)[0], way[:2])
    if shape is None:
        return None
    nodes = graded(scene, _nodes_of(standing, scene), shape.bends, shape.layers)
    return None if _is_too_fine(nodes, standing) else ways.start(nodes, Guess(shape.points))


def _is_too_fine(nodes: Nodes, standing: Block) -> bool:
    """Whether a mesh is finer than a way off an equilibrium is worth."""
    most = LARGEST_MESH[0] + LARGEST_MESH[1] * float(standing.header.nodes)
    return sum(map(len, nodes)) > most


def _fallen(
    standing: Block, scene: Scene, ways: Ways, growing: GrowingMotion, side: float
) -> Block | None:
    """A block at the equilibrium that a line falls to; None: it does not get there."""
    block = _fall(standing, scene, ways, growing, side)
    if block is None:
        return None
    if not ways.in_place or block.header.nodes != standing.header.nodes:
        return ways.start(_nodes_of(block, scene), guess_of(block, scene))
    status = search.equilibrium(block, steady_velocity(block, scene))
    count_from_zero(block)
    return block if status == at.OK else None


def _fall(
    standing: Block, scene: Scene, ways: Ways, growing: GrowingMotion, side: float
) -> Block | None:
    """Push a line off its equilibrium and follow it till it rests; None: it does not, or folds."""

    def finer(block: Block) -> Block | None:
        nodes = refined(block, scene, _nodes_of(block, scene))
        if nodes is None:
            return None
        if _is_too_fine(nodes, standing):
            raise StaticsError("its way off an equilibrium wants too fine a mesh")
        return ways.stand(nodes, guess_of(block, scene))

    frame = steady_velocity(standing, scene)
    fallen = fall(copy.deepcopy(standing), frame, growing.rate, side * growing.motion, finer)
    return fallen.block if fallen is not None and fallen.rests else None


def _nodes_of(block: Block, scene: Scene) -> Nodes:
    """The nodes on which a block stands."""
    count = int(block.header.nodes)
    edges = block.array(Header.edges, count, at.EDGE_WORDS)[1:]
    edges = edges[block.integers(Header.joint, count)[1:] == 0]
    groups = [
        list(rows) for _, rows in itertools.groupby(edges, key=lambda row: row[at.Edge.segment])
    ]
    nodes = []
    for cable, rows in zip(scene.cables, groups, strict=True):
        starts = np.array([row[at.Edge.start] - rows[0][at.Edge.start] for row in rows])
        nodes.append(np.array([*starts, cable.length]))
    return nodes
