"""A finer mesh where a static shape needs one, and the shape to start from on it."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import StaticsError
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.start import laid_loads, laid_shape
from cablemodel.solvers.finite_element.start.first_state import (
    count_from_zero,
    solve_static,
    steady_velocity,
)
from cablemodel.solvers.finite_element.start.frame import earth
from cablemodel.solvers.finite_element.start.scales import pays_out, start_conditions
from cablemodel.solvers.finite_element.start.strategies import Strategy
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import LIGHT_DAMPING, Header

if TYPE_CHECKING:
    from cablemodel.scene import Scene
from cablemodel.solvers.shared.numbers import (
    LARGEST_STATIC_MESH,
    REFINEMENT_BENT,
    REFINEMENT_ROUNDS,
    REFINEMENT_SPARE,
    SAME_PLACE,
)

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

FAR_TOO_BENT = 4.0
"""Times REFINEMENT_BENT, from where on halving elements once would not do: an FMU, whose elements
are as they are, warns of a start that it found anew."""
FALLING_SPARE = 200
"""Nodes for what is cut off and folds as it falls, beside those."""
WINCH = 2
"""Times that many where a winch runs: it needs some of its own when all others bend."""


def mesh_is_free(scene: Scene) -> bool:
    """Whether the mesh may change: one that the scene asks for stays as it is."""
    return all(cable.elements is None for cable in (*scene.cables, *scene.drum_cables))


def _may_follow_bending(scene: Scene, longest: float) -> bool:
    """Whether elements are halved where the line bends in free water (see
    kernels/element/scales.py), at lengths up to so many times its own."""
    start = start_conditions(scene)
    damped = start.damping * longest >= LIGHT_DAMPING
    return mesh_is_free(scene) and (
        damped or not (start.slack or scene.environment.floor is not None)
    )


def spare_nodes(scene: Scene, nodes: int, longest: float) -> int:
    """Nodes that halving elements in free water may need, of a line whose lengths may be set up to
    so many times its own."""
    if not _may_follow_bending(scene, longest):
        return 0
    spare = REFINEMENT_SPARE[0] + math.ceil(REFINEMENT_SPARE[1] * nodes)
    return WINCH * spare if pays_out(scene) or scene.payout.drum else spare


def bends_of(block: Block) -> FloatArray:
    """By how much each element of a static shape bends (nodes,), in tau times its line's length."""
    from cablemodel.solvers import library

    found = np.empty(int(block.header.nodes))
    library.measure_bends(block.ints, block.reals, found)
    return found


def refined(block: Block, scene: Scene, nodes: list[FloatArray]) -> list[FloatArray] | None:
    """Cables' nodes with those elements halved that a static shape bends too much; None: done."""
    count = int(block.header.nodes)
    joints = block.integers(Header.joint, count)
    split = bends_of(block) > REFINEMENT_BENT
    if not split.any() or count > LARGEST_STATIC_MESH:
        return None
    fixed = [cable.elements is not None for cable in scene.cables]
    finer = []
    node = 1
    changed = False
    for index, places in enumerate(nodes):
        while joints[node]:
            node += 1
        new = [float(places[0])]
        for left, right in itertools.pairwise(places):
            if split[node] and not fixed[index]:
                new.append(0.5 * (left + right))
                changed = True
            new.append(float(right))
            node += 1
        finer.append(np.array(new))
    return finer if changed else None


def halved(scene: Scene, nodes: list[FloatArray]) -> list[FloatArray]:
    """Cables' nodes with all elements halved but those that the scene asks for."""
    return [
        places
        if cable.elements is not None
        else np.sort(np.concatenate([places, 0.5 * (places[1:] + places[:-1])]))
        for cable, places in zip(scene.cables, nodes, strict=True)
    ]


def shape_of(block: Block) -> tuple[FloatArray, FloatArray]:
    """The block's present shape as a fine polyline, (n, 3), and the arc lengths of cables and
    bodies at its points, (n,): the guess on a finer mesh."""
    from cablemodel.solvers import library as entry

    count = int(block.header.nodes)
    edges = block.array(Header.edges, count, at.EDGE_WORDS)[1:]
    ends = np.concatenate([[0.0], edges[:, at.Edge.start] + edges[:, at.Edge.length]])
    stations = np.unique(np.interp(np.arange(8 * count - 7) / 8.0, np.arange(count), ends))
    out = np.empty(at.STATION_WORDS * len(stations))
    entry.sample(block.ints, block.reals, stations, out)
    points = out.reshape(-1, at.STATION_WORDS)[:, at.Station.position.span]
    bodies = np.flatnonzero(block.integers(Header.joint, count) == at.JOINT_BODY)
    passed = _passed(block)
    arcs = stations
    places = _node_places(block) if len(bodies) else points
    for node in reversed(bodies):
        # Both ends of a body have the same arc length: one station, or the line's last one.
        here = int(np.searchsorted(stations, ends[node] - SAME_PLACE * ends[-1]))
        points = np.vstack([points[:here], places[node - 1 : node + 1], points[here + 1 :]])
        length = passed[node] - passed[node - 1]
        body = [ends[node], ends[node] + length]
        arcs = np.concatenate([arcs[:here], body, arcs[here + 1 :] + length])
    return points.copy(), arcs


def _passed(block: Block) -> FloatArray:
    """Length of the bodies between the vessel and each node, (nodes,) [m]."""
    passed = np.zeros(int(block.header.nodes))
    for body in block.array(Header.bodies, int(block.header.body_count), at.BODY_WORDS):
        if body[at.Body.node] >= 0:
            passed[int(body[at.Body.node]) :] += body[at.Body.length]
    return passed


def guess_of(block: Block, scene: Scene) -> laid_shape.Guess:
    """The block's present shape; of cable that runs out, its stretch and its tensions too."""
    points, arcs = shape_of(block)
    if scene.rate_at_start <= 0.0:
        return laid_shape.Guess(points)
    count = int(block.header.nodes)
    edges = block.array(Header.edges, count, at.EDGE_WORDS)[1:]
    tension = block.array(Header.tension, count, 2)[1:]
    cables = block.integers(Header.joint, count)[1:] == 0
    starts = edges[:, at.Edge.start] + _passed(block)[1:]
    ends = np.stack([starts, starts + edges[:, at.Edge.length]], axis=-1)
    values = np.stack([tension[:, 0] - tension[:, 1], tension[:, 0] + tension[:, 1]], axis=-1)
    rows = np.column_stack([ends[cables].ravel(), values[cables].ravel()])
    return laid_shape.Guess(points, arcs, rows, at_rest=True)


def _node_places(block: Block) -> FloatArray:
    """Positions of the nodes in the earth frame, (n, 3) [m]."""
    count, dimension = int(block.header.nodes), int(block.header.dimension)
    return earth(block, block.array(Header.position, count, 2 * dimension)[:, :dimension])


def image_before(block: Block, change: Callable[[IntArray, FloatArray], int]) -> IntArray | None:
    """A block's image before a kernel changed its mesh, for which it grows as it must; None: it did
    not change."""
    before = block.image.copy()
    while (found := change(block.ints, block.reals)) == at.NO_CAPACITY:
        block.take(before)
        block.grow()
        before = block.image.copy()
    return before if found == at.CHANGED else None


def refine_touchdown(block: Block, scene: Scene, strategy: Strategy) -> None:
    """Refine a static shape where it meets the floor, and solve again from its own shape.

    Over ridges contact may come and go on a finer mesh without end: the start is then at rest on
    the mesh before it, which follows the floor as the run begins.
    """
    from cablemodel.solvers import library as entry

    frame = steady_velocity(block, scene)
    stays = strategy.as_laid and not laid_loads.is_dragged(scene)
    for turn in range(REFINEMENT_ROUNDS):
        at_rest = image_before(block, entry.refine_at_floor)
        if at_rest is None:
            break
        if block.header.hybrid:
            # Short elements bend where the long ones that they were did not; found out in the
            # first step instead, it set the line ringing.
            entry.choose_bending(block.ints, block.reals)
        try:
            anew = turn == 0 and scene.rate_at_start <= 0.0
            if anew or not (stays and _rests_where_it_lies(block, scene, frame, strategy)):
                solve_static(block, scene, frame, strategy)
        except StaticsError:
            if strategy.as_laid and scene.rate_at_start <= 0.0:
                raise  # without friction it may come to rest; a lay would be another one
            block.image[:] = at_rest
            break
    count_from_zero(block)


def _rests_where_it_lies(block: Block, scene: Scene, frame: FloatArray, strategy: Strategy) -> bool:
    """Whether a line that was laid before rests with what lies where it is; else nothing changes.

    Laid anew on every mesh it slides a little each time, and the mesh chases its contacts.
    """
    before = block.image.copy()
    try:
        solve_static(block, scene, frame, replace(strategy, lies=block))
    except StaticsError:
        block.image[:] = before
        return False
    return True
