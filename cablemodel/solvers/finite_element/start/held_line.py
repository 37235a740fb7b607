"""The shape in which a line hangs between two held ends: a chain that pulls everywhere.

A parabola between the ends knows nothing of bodies. Where a heavy one hangs by one end, a shape
from there may rest with it aside, on a cable that pushes it there like a strut. A chain under given
loads has one shape in which it pulls everywhere: that of least energy. With n0 the force at its
first end and n(s) = n0 - Q(s), Q what loads it up to s, its far end is at the gradient of a convex
function,

    integral of |n| + |n|^2 / 2 EA ds,    r' = (1 + |n| / EA) n / |n|,

so that n0 is found by Newton's method from anywhere.
"""

from __future__ import annotations

import itertools
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.finite_element.mesh import halved_where
from cablemodel.solvers.finite_element.start import laid_loads
from cablemodel.solvers.finite_element.start.laid_shape import Guess
from cablemodel.solvers.finite_element.start.scales import is_flexible

if TYPE_CHECKING:
    from cablemodel.scene import Scene
from cablemodel.solvers.shared.numbers import NO_SIZE

FloatArray = NDArray[np.float64]

LINKS = 400
"""Of the chain in each cable and body."""
HELD_ROUNDS = 30
"""In which the drag follows the shape, by halves."""
HELD_STEPS = 60
"""Of Newton's method, at most."""
HELD_NEAR = 1e-9
"""Of the line's length: how near to its place the far end comes."""
HELD_WIDE = 2.0
"""Of a layer: half the length in which a turn of the chain is made."""
FLEXIBLE = 0.02
"""Of a cable's length: that of one without stiffness, which elements must turn with."""
HELD_TURN = 0.5
"""By which the chain turns within an element, at most [rad]."""
HELD_SHORTEST = 2e-3
"""Element, of the line's length, that is not made shorter for that."""
SMOOTH = 1e-6
"""Of all loads: a force that is none next to it has no direction."""
WIDEST_TURN = 0.1
"""Of a cable's length: along what a turn is spread at most."""
SMALLEST_PART_OF_STEP = 1e-9
"""Of Newton's step: what is tried at last."""
FALLS_ENOUGH = 1e-4, 1e-14
"""Of the energy's fall along a step, and of the energy for rounding: by which it must fall."""


def hung(scene: Scene, start: FloatArray) -> Guess | None:
    """Points, arc lengths and tensions of a line that hangs from a tow point (3,) to its anchor.

    None where that is not found, or reaches the floor.
    """
    end = np.asarray(scene.end.position, dtype=float)
    line = laid_loads.pieces(scene)
    whole = line[-1].end
    marks = np.unique([0.0, whole, *(p.start for p in line), *(p.end for p in line)])
    arcs = np.concatenate(
        [*(np.linspace(a, b, LINKS + 1)[:-1] for a, b in itertools.pairwise(marks)), [whole]]
    )
    middle, ds = 0.5 * (arcs[1:] + arcs[:-1]), np.diff(arcs)
    long = [piece for piece in line if piece.end > piece.start]
    of = np.searchsorted([piece.end for piece in long], middle)
    weight, normal, along = (
        np.array([getattr(piece, name) for piece in long])[of]
        for name in ("weight", "normal", "tangential")
    )
    compliance = np.array([piece.strain[0] if piece.strain else 0.0 for piece in long])[of]
    points = [piece for piece in line if piece.end == piece.start]
    behind = np.array([middle > piece.start for piece in points]).reshape(-1, len(middle))

    places = start + np.outer(arcs / whole, end - start)
    tangents = np.tile(np.array([0.0, 0.0, -1.0]), (len(ds), 1))
    drag = np.zeros((len(ds), 3))
    force = np.zeros(3)
    for round_ in range(HELD_ROUNDS):
        flow = laid_loads.water_velocity(scene, 0.5 * (places[1:, 2] + places[:-1, 2]))
        part = np.sum(flow * tangents, axis=1)[:, None] * tangents
        across = flow - part
        new = normal[:, None] * np.linalg.norm(across, axis=1)[:, None] * across
        new += along[:, None] * np.linalg.norm(part, axis=1)[:, None] * part
        drag = 0.5 * (drag + new) if round_ else new
        loads = drag.copy()
        loads[:, 2] -= weight
        loads *= ds[:, None]
        total = np.cumsum(loads, axis=0) - 0.5 * loads
        for piece, is_behind in zip(points, behind, strict=True):
            water = laid_loads.water_velocity(
                scene, np.array([np.interp(piece.start, arcs, places[:, 2])])
            )[0]
            load = piece.normal * float(np.linalg.norm(water)) * water
            load[2] -= piece.weight
            total[is_behind] += load
        least = SMOOTH * max(float(np.linalg.norm(total, axis=1).max()), NO_SIZE)
        found = _force_at_start(total, ds, compliance, end - start, least, force)
        if found is None:
            return None
        force = found
        internal = force - total
        size = np.sqrt(np.sum(internal**2, axis=1) + least**2)
        tangents = internal / size[:, None]
        steps = (ds * (1.0 + compliance * size))[:, None] * tangents
        places = start + np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])
        if scene.environment.current is None:
            break
    stretched = ds * (1.0 + compliance * size)
    bends = _bent(scene, arcs, tangents, drag, weight)
    places = start + np.vstack([np.zeros(3), np.cumsum(stretched[:, None] * bends, axis=0)])
    places += np.outer(arcs / whole, end - places[-1])
    floor = scene.environment.floor
    if floor is not None and any(z < floor.height(x, y) for x, y, z in places[1:-1].tolist()):
        return None
    return Guess(places, arcs, np.column_stack([middle, np.linalg.norm(force - total, axis=1)]))


def _bent(
    scene: Scene, arcs: FloatArray, tangents: FloatArray, drag: FloatArray, weight: FloatArray
) -> FloatArray:
    """Tangents of the links (n, 3) with each turn of the chain spread as the cable's stiffness
    does, over layers (EI/w)^(1/3), w its load [N/m]; a kink at a body stays."""
    loads = np.linalg.norm(drag - np.outer(weight, [0.0, 0.0, 1.0]), axis=1)
    turns = np.cross(tangents[:-1], tangents[1:])
    sines = np.linalg.norm(turns, axis=1)
    angles = np.arctan2(sines, np.sum(tangents[:-1] * tangents[1:], axis=1))
    turns *= (angles / np.where(sines > 0.0, sines, 1.0))[:, None]
    found, arc = tangents.copy(), 0.0
    joints = arcs[1:-1]
    for item in scene.line:
        if item.cable is None:
            assert item.body is not None
            arc += 2.0 * item.body.half_length
            continue
        last = arc + item.cable.length
        links = np.flatnonzero((arcs[1:] > arc) & (arcs[:-1] < last))
        inside = links[:-1]  # joints between them
        if len(inside):
            width = FLEXIBLE * item.cable.length
            if not is_flexible(scene, item.cable):
                stiffness = scene.cable_types[item.cable.type].bending_stiffness
                load = max(float(loads[links].mean()), NO_SIZE)
                width = max(width, HELD_WIDE * (stiffness / load) ** (1.0 / 3.0))
            width = min(width, WIDEST_TURN * item.cable.length)
            away = (joints[inside][:, None] - joints[inside]) / width
            # Each turn as tanh spreads it, whole: what would go past an end stays inside.
            share = 1.0 / np.cosh(away) ** 2
            spread = (share / share.sum(axis=0)) @ turns[inside]
            way = found[links[0]]
            for link, turn in zip(links[1:], spread, strict=True):
                way = way + np.cross(turn, way)
                way /= np.linalg.norm(way)
                found[link] = way
        arc = last
    return found


def graded(scene: Scene, nodes: list[FloatArray], guess: Guess) -> list[FloatArray]:
    """Cables' nodes (arc lengths from 0 to each one's length [m]), closer where the chain turns."""
    assert guess.arcs is not None
    ways = np.diff(guess.points, axis=0)
    ways /= np.linalg.norm(ways, axis=1)[:, None]
    middle = 0.5 * (guess.arcs[1:] + guess.arcs[:-1])
    turns = np.linalg.norm(np.diff(ways, axis=0), axis=1)
    line = laid_loads.pieces(scene)
    joints = [piece.start for piece in line] + [piece.end for piece in line]
    inside = np.arange(1, len(middle))
    turns[np.isin(guess.arcs[inside], joints)] = 0.0  # at a body a line may have a kink
    turned = np.concatenate([[0.0], np.cumsum(turns)])
    passed = 0.0
    starts = []  # of cables, by their bodies' lengths further down the line than by cable alone
    for item in scene.line:
        if item.body is not None:
            passed += 2.0 * item.body.half_length
        else:
            starts.append(passed)
    offsets = dict(
        zip(np.cumsum([0.0, *(c.length for c in scene.cables)])[:-1], starts, strict=True)
    )
    shortest = HELD_SHORTEST * scene.line_length

    def is_too_long(start: float, a: float, b: float) -> bool:
        below = offsets[min(offsets, key=lambda place: abs(place - start))]
        first, last = np.interp([start + a + below, start + b + below], middle, turned)
        return b - a > shortest and last - first > HELD_TURN

    return halved_where(scene.cables, nodes, is_too_long)


def _force_at_start(
    total: FloatArray,
    ds: FloatArray,
    compliance: FloatArray,
    span: FloatArray,
    least: float,
    force: FloatArray,
) -> FloatArray | None:
    """The force (3,) [N] at the first end with which the chain spans a vector; None: not found.

    total: loads up to the middle of each link, (n, 3) [N].
    """

    def gap(force: FloatArray) -> tuple[FloatArray, FloatArray, float]:
        """What is left of the span, its derivative, and the convex function."""
        internal = force - total
        size = np.sqrt(np.sum(internal**2, axis=1) + least**2)
        stretch = ds * (1.0 / size + compliance)
        left = stretch @ internal - span
        slope = np.eye(3) * stretch.sum() - (internal * (ds / size**3)[:, None]).T @ internal
        return left, slope, float(ds @ (size + 0.5 * compliance * size**2)) - float(force @ span)

    length = float(ds.sum())
    left, slope, value = gap(force)
    for _step in range(HELD_STEPS):
        if float(np.linalg.norm(left)) < HELD_NEAR * length:
            return force
        way = -np.linalg.solve(slope, left)
        downhill = float(left @ way)
        share = 1.0
        while share > SMALLEST_PART_OF_STEP:
            tried = gap(force + share * way)
            if tried[2] <= value + FALLS_ENOUGH[0] * share * downhill + FALLS_ENOUGH[1] * abs(
                value
            ):
                break
            share *= 0.5
        force = force + share * way
        left, slope, value = tried
    return None
