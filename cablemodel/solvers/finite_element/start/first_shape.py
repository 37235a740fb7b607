"""Where the nodes are at first: along a polyline that the scene gives or that is a good guess."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import SceneError
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.mesh import halved_where
from cablemodel.solvers.finite_element.start import laid_loads, laid_shape
from cablemodel.solvers.finite_element.start.frame import local
from cablemodel.solvers.finite_element.start.line import Line
from cablemodel.solvers.finite_element.start.scales import (
    bodies_length,
    is_flexible,
    pays_out,
    sinks,
    tension_scale,
)
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.curves import crossing, hermite, way_along
from cablemodel.solvers.shared.layout import Header

if TYPE_CHECKING:
    from cablemodel.scene import Scene
from cablemodel.solvers.shared.numbers import (
    NO_DIRECTION,
    NO_SIZE,
    RELATIVE_ROUNDING,
    SAME_PLACE,
    TURNED_BACK,
)

FloatArray = NDArray[np.float64]

SHAPE_WIDE = 3.0
"""Of a layer: half the length of cable in which a line that hangs and floats turns back."""
TIGHT = 0.3
"""Of a layer: a bight whose catenary would have a smaller radius is a loop, as wide as that."""
CURVE_PARTS = 16
"""Places between two points of a shape that is given."""
LONG = 30.0
"""Of its bending layers: a clamped line that is longer hangs, a shorter one stands as a beam."""
SHAPE_PLACES, BEND_PLACES = 201, 241
"""Of a first shape: along all of it, and about where it bends."""
BEND_SEEN = 6.0
"""In half the length of a bend, to either side: places about it."""
CATENARY_SEEN = 20.0
"""The same of a catenary, in its least radius."""
SHORT_LOOP = 8.0
"""A loop's bend is at most the line over that."""
FLATTEST, BEYOND_STEEPEST = 1e-3, 4.0
"""Half span over the radius of a catenary that is looked for: least, and how far it goes beyond
twice the logarithm of its length over its span."""
CLAMP_LAYERS = 20.0
"""Bending layers behind a clamp along which a first shape turns."""
STRAIGHT_CHORD = 1e-6
"""Of the length: slack of what is drawn straight."""
UPRIGHT_CHORD = 0.999
"""Of a chord, along what a line sags: from there on it goes aside."""
SAG_WIDTH = 1e-15
"""Of the length: width of the sag that is looked for."""


def first_points(scene: Scene, start: FloatArray, *, swept: bool = False) -> FloatArray:
    """A polyline from the tow point outwards that the first shape follows, (n, 3).

    swept: an anchored line bows the way the current and its weight push it, not just down.
    """
    length = scene.line_length + bodies_length(scene)
    if scene.initial.kind == "straight":
        direction = np.asarray(scene.initial.direction, dtype=float)
        return np.array([start, start + length * direction / np.linalg.norm(direction)])
    if scene.initial.kind == "points":
        points = np.asarray(scene.initial.points, dtype=float)
        return smoothly(points, points)
    down = np.array([0.0, 0.0, -1.0 if sinks(scene) else 1.0])
    if scene.end.kind == "anchor":
        bow = _load(scene, start) if swept else down
        return _sagging(start, np.asarray(scene.end.position, dtype=float), length, bow)
    if scene.environment.waves is not None and not sinks(scene):
        return _afloat(scene, start, length)
    top = scene.cables[0]
    if scene.vessel.connection.kind == "clamped" and not is_flexible(scene, top):
        direction = np.asarray(scene.vessel.connection.direction, dtype=float)
        direction /= np.linalg.norm(direction)
        layer = math.sqrt(
            scene.cable_types[top.type].bending_stiffness / max(tension_scale(scene), NO_SIZE)
        )
        if length < LONG * layer:
            return np.array([start, start + length * direction])
        if not pays_out(scene):
            return start + _bent_at_the_clamp(direction, down, layer, length)
    return np.array([start, start + length * down])


@dataclass(frozen=True)
class Drawn:
    """A first shape that goes up and down."""

    points: FloatArray
    """From the tow point outwards (n, 3) [m]."""
    bends: list[float]
    """Arc lengths of the cable at which it turns back [m]."""
    layers: list[float]
    """(EI/w)^(1/3) there [m]."""


def drawn_by_weight(scene: Scene, start: FloatArray, way: FloatArray) -> Drawn | None:
    """A free line in still water, up or down by what hangs or floats beyond each place.

    It turns back in bends of a few layers (EI/w)^(1/3), towards a horizontal way (2,). None where
    it goes one way throughout, which is the first shape, or has no stiffness to turn back with.
    """
    if scene.end.kind != "free":
        return None
    force = 0.0  # of what is beyond, down
    pieces = laid_loads.pieces(scene)
    sections: list[tuple[float, bool]] = []  # where each begins, whether it goes down
    for piece in reversed(pieces):
        length = piece.end - piece.start
        before = force + piece.weight * (length or 1.0)
        if length > 0.0 and force * before < 0.0:
            sections += [
                (piece.end + force / piece.weight, force > 0.0),
                (piece.start, before > 0.0),
            ]
        elif length > 0.0:
            sections.append((piece.start, force + before > 0.0))
        force = before
    sections.reverse()
    turns = [place for (_, down), (place, other) in itertools.pairwise(sections) if down != other]
    line = [piece.end - piece.start for piece in pieces]
    layers, bends = [], []
    for place in turns:
        layer, passed = _layer_at(scene, place)
        if layer == 0.0:
            return None
        layers.append(layer)
        bends.append(place - passed)
    if not turns:
        return None
    length = math.fsum(line)
    near = [
        place + SHAPE_WIDE * layer * np.linspace(-BEND_SEEN, BEND_SEEN, BEND_PLACES)
        for place, layer in zip(turns, layers, strict=True)
    ]
    s = np.unique(
        np.clip(np.concatenate([np.linspace(0.0, length, SHAPE_PLACES), *near]), 0.0, length)
    )
    angle = np.full(len(s), 0.0 if sections[0][1] else math.pi)  # from straight down
    back = 1.0 if sections[0][1] else -1.0
    for place, layer in zip(turns, layers, strict=True):
        angle += back * 0.5 * math.pi * (1.0 + np.tanh((s - place) / (SHAPE_WIDE * layer)))
        back = -back
    middle, step = 0.5 * (angle[1:] + angle[:-1]), np.diff(s)
    aside, down = np.cumsum(step * np.sin(middle)), np.cumsum(step * np.cos(middle))
    points = np.column_stack([np.outer(aside, way), -down])
    return Drawn(start + np.vstack([np.zeros(3), points]), bends, layers)


def _layer_at(scene: Scene, place: float) -> tuple[float, float]:
    """(EI/w)^(1/3) at a place along the line [m], 0 of cable that does not bend; and what of the
    place is bodies [m]."""
    arc = passed = 0.0
    for item in scene.line:
        if item.body is not None:
            passed += 2.0 * item.body.half_length if place > arc + passed else 0.0
        elif item.cable is not None:
            arc += item.cable.length
            if place <= arc + passed * (1.0 + RELATIVE_ROUNDING):
                kind = scene.cable_types[item.cable.type]
                if is_flexible(scene, item.cable) or not kind.submerged_weight:
                    return 0.0, passed
                return (kind.bending_stiffness / abs(kind.submerged_weight)) ** (1.0 / 3.0), passed
    return 0.0, passed


def bight(scene: Scene, start: FloatArray) -> Drawn | None:
    """A line between two ends that are close to each other, graded to its bend.

    A parabola turns far too sharply there, and elements as they come cannot turn back. A catenary,
    or a loop as wide as its stiffness makes it. None where the line has no bend, or ends at one
    place and nothing says how wide it is.
    """
    end = np.asarray(scene.end.position, dtype=float)
    length = scene.line_length + bodies_length(scene)
    down = -1.0 if sinks(scene) else 1.0
    way = (end - start)[:2]
    span, rise = float(np.hypot(*way)), down * float(start[2] - end[2])
    if abs(rise) >= length:
        return None
    catenary = _catenary(span, rise, length) if span > 0.0 else None
    if span > 0.0 and catenary is None:
        return None
    lowest = 0.5 * (length - rise) if catenary is None else -catenary[1]
    layer, passed = _layer_at(scene, lowest)
    if catenary is None or catenary[0] < TIGHT * layer:
        if layer == 0.0:
            return None
        way = way / span if span > 0.0 else np.array([1.0, 0.0])
        points = _loop(start, end, lowest, length, min(layer, length / SHORT_LOOP), way, down)
        return Drawn(points, [lowest - passed], [layer])
    radius, first, last = catenary
    s = _places(first, last, radius * np.linspace(-CATENARY_SEEN, CATENARY_SEEN, BEND_PLACES))
    along = radius * (np.arcsinh(s / radius) - math.asinh(first / radius))
    up = radius * (np.hypot(1.0, s / radius) - math.hypot(1.0, first / radius))
    points = start + np.column_stack([np.outer(along, way / span), -down * up])
    return Drawn(points, [lowest - passed], [max(radius, layer)])


def _catenary(span: float, rise: float, length: float) -> tuple[float, float, float] | None:
    """Radius at the bend [m], and arc lengths of both ends from there; None without a bend."""
    # sinh(x) / x = ratio, x the half span in units of the radius.
    ratio = math.log(math.sqrt(length**2 - rise**2) / span)
    if ratio <= 0.0:
        return None

    def excess(x: float) -> float:
        return x + math.log(-math.expm1(-2.0 * x) / (2.0 * x)) - ratio

    low, high = FLATTEST, 2.0 * ratio + BEYOND_STEEPEST
    half = crossing(excess, low, high, at_low=excess(low), at_high=excess(high), near=0.0,
                    width=RELATIVE_ROUNDING)  # fmt: skip
    radius = 0.5 * span / half
    middle = math.atanh(rise / length)
    first, last = (radius * math.sinh(middle + sign * half) for sign in (-1.0, 1.0))
    return None if first >= 0.0 or last <= 0.0 else (radius, first, last)


def _loop(
    start: FloatArray,
    end: FloatArray,
    lowest: float,
    length: float,
    wide: float,
    way: FloatArray,
    down: float,
) -> FloatArray:
    """Down, round and up again, then sheared so that it ends where it should, (n, 3) [m].

    lowest: arc length at the bend; wide: half the length of its bend [m]; way: horizontal unit
    vector (2,) towards which it turns; down: -1, or 1 where the line floats.
    """
    s = _places(0.0, length, lowest + wide * np.linspace(-BEND_SEEN, BEND_SEEN, BEND_PLACES))
    angle = 0.5 * math.pi * (1.0 + np.tanh((s - lowest) / wide))  # from straight down
    middle, step = 0.5 * (angle[1:] + angle[:-1]), np.diff(s)
    aside, along = np.cumsum(step * np.sin(middle)), np.cumsum(step * np.cos(middle))
    points: FloatArray = start + np.vstack(
        [np.zeros(3), np.column_stack([np.outer(aside, way), down * along])]
    )
    shear: FloatArray = np.outer(s / length, end - points[-1])
    return points + shear


def _places(first: float, last: float, near: FloatArray) -> FloatArray:
    """Arc lengths of a first shape, from end to end and closer where it bends, none twice."""
    s = np.unique(
        np.concatenate([np.linspace(first, last, SHAPE_PLACES), np.clip(near, first, last)])
    )
    kept: FloatArray = s[np.diff(s, prepend=-math.inf) > SAME_PLACE * (last - first)]
    return kept


def graded(
    scene: Scene, nodes: list[FloatArray], bends: list[float], layers: list[float]
) -> list[FloatArray]:
    """Cables' nodes (arc lengths from 0 to each one's length [m]) graded towards bends."""

    def is_too_long(start: float, a: float, b: float) -> bool:
        return any(
            b - a > max(layer, laid_shape.GRADING * laid_shape.distance(start + a, start + b, bend))
            for bend, layer in zip(bends, layers, strict=True)
        )

    return halved_where(scene.cables, nodes, is_too_long)


def _afloat(scene: Scene, start: FloatArray, length: float) -> FloatArray:
    """A free line that floats: up or down to still water, then along it, as the water drifts.

    In a scene with waves there is air above the surface: straight up it would stand like a column.
    """
    height = float(start[2])
    if abs(height) >= length:
        return np.array([start, start - [0.0, 0.0, math.copysign(length, height)]])
    velocity = scene.motion().evaluate(0.0)[1]
    drift = (laid_loads.water_velocity(scene, np.zeros(1))[0] - velocity)[:2]
    speed = float(np.hypot(*drift))
    way = drift / speed if speed > 0.0 else laid_loads.behind(scene, np.zeros(2), np.zeros(2))
    surface = np.array([start[0], start[1], 0.0])
    end = surface + (length - abs(height)) * np.array([*way, 0.0])
    return np.array([surface, end] if height == 0.0 else [start, surface, end])


def _bent_at_the_clamp(
    direction: FloatArray, down: FloatArray, layer: float, length: float
) -> FloatArray:
    """A long line that leaves in a direction and bends under its tension to hang, (n, 3).

    tan(angle / 4) falls as exp(-s / layer): the elastica under tension, layer = sqrt(EI/T).
    """
    angle = float(np.arccos(np.clip(direction @ down, -1.0, 1.0)))
    aside = direction - (direction @ down) * down
    if np.linalg.norm(aside) < TURNED_BACK:
        aside = np.array([1.0, 0.0, 0.0])
    aside /= np.linalg.norm(aside)
    s = np.concatenate([np.linspace(0.0, CLAMP_LAYERS * layer, SHAPE_PLACES), [length]])
    turned = 4.0 * np.arctan(math.tan(0.25 * angle) * np.exp(-s / layer))
    middle = 0.5 * (turned[1:] + turned[:-1])
    steps = np.diff(s)[:, None] * (np.cos(middle)[:, None] * down + np.sin(middle)[:, None] * aside)
    return np.vstack([np.zeros(3), np.cumsum(steps, axis=0)])


def _load(scene: Scene, start: FloatArray) -> FloatArray:
    """Unit vector along the line's weight and its drag across the current, (3,)."""
    flow = laid_loads.water_velocity(scene, start[2:3])[0]
    total = np.zeros(3)
    for piece in laid_loads.pieces(scene):
        share = (piece.end - piece.start) or 1.0
        total += share * piece.normal * float(np.linalg.norm(flow)) * flow
        total[2] -= share * piece.weight
    size = float(np.linalg.norm(total))
    return total / size if size > 0.0 else np.array([0.0, 0.0, -1.0])


def _sagging(start: FloatArray, end: FloatArray, length: float, bow: FloatArray) -> FloatArray:
    """A parabola of the given length between two points: the first guess of a hanging cable.

    bow: unit vector towards which it sags, (3,).
    """
    chord = float(np.linalg.norm(end - start))
    if chord >= length * (1.0 - STRAIGHT_CHORD):
        return np.array([start, end])
    x = np.linspace(0.0, 1.0, SHAPE_PLACES)
    if abs(float((end - start) @ bow)) > UPRIGHT_CHORD * max(chord, NO_DIRECTION):
        bow = np.array([1.0, 0.0, 0.0])  # one end above the other: the slack goes aside

    def curve(sag: float) -> FloatArray:
        return start + np.outer(x, end - start) + np.outer(4.0 * x * (1.0 - x) * sag, bow)

    def too_long(sag: float) -> float:
        return float(np.linalg.norm(np.diff(curve(sag), axis=0), axis=1).sum()) - length

    sag = crossing(
        too_long,
        0.0,
        length,
        at_low=chord - length,
        at_high=too_long(length),
        near=RELATIVE_ROUNDING * length,
        width=SAG_WIDTH * length,
    )
    return curve(sag)


def smoothly(points: FloatArray, values: FloatArray) -> FloatArray:
    """Values (n, k) at points (n, 3), at places (m, k) so close that chords are their way.

    By cubics between points that differ, with slopes from each one's neighbours. Those of parabolas
    would leave a long chord next to a short one by far.
    """
    others = np.append(True, np.any(np.diff(points, axis=0) != 0.0, axis=1))
    points, values = points[others], values[others]
    if len(points) < 3:
        return values
    arcs = way_along(points)
    places = np.interp(np.arange(CURVE_PARTS * (len(points) - 1) + 1) / CURVE_PARTS,
                       np.arange(len(points)), arcs)  # fmt: skip
    # Linear in the values, so that turned points give the turned curve (PCHIP does not).
    beside, there = np.pad(values, ((1, 1), (0, 0)), "edge"), np.pad(arcs, 1, "edge")
    slopes = (beside[2:] - beside[:-2]) / (there[2:] - there[:-2])[:, None]
    curve, _ = hermite(places, arcs, values.T, slopes.T)
    return curve.T


def along_curve(scene: Scene, nodes: list[FloatArray], curve: FloatArray) -> list[FloatArray]:
    """Cables' nodes (arc lengths from 0 to each one's length [m]) with elements halved whose cubics
    leave a curve (n, 3) by more than positions may be wrong by."""
    arcs = way_along(curve)
    arcs *= scene.line_length / arcs[-1]
    slopes = np.gradient(curve, arcs, axis=0)
    allowed = scene.solver.tolerance * scene.line_length

    def is_too_long(start: float, a: float, b: float) -> bool:
        ends = np.array([start + a, start + b])
        inner = ends[0] + (b - a) * np.array([0.25, 0.5, 0.75])
        places, _ = hermite(np.concatenate([ends, inner]), arcs, curve.T, slopes.T)
        way = np.array([[np.interp(s, arcs, part) for s in ends] for part in slopes.T])
        cubic, _ = hermite(inner, ends, places[:, :2], way)
        return float(np.linalg.norm(cubic - places[:, 2:], axis=0).max()) > allowed

    return halved_where(scene.cables, nodes, is_too_long)


def stretch_of_points(scene: Scene) -> float:
    """By what the points of a scene stretch its cable: 1 where that is as long as their chords, as
    arcs of circles that turn as the chords do, or between them."""
    ways = np.diff(np.asarray(scene.initial.points, dtype=float), axis=0)
    chords = np.linalg.norm(ways, axis=1)
    ways, chords = ways[chords > 0.0], chords[chords > 0.0]
    units = ways / chords[:, None]
    turns = np.arccos(np.clip((units[1:] * units[:-1]).sum(axis=1), -1.0, 1.0))
    turns = np.pad(turns, 1, "edge") if turns.size else np.zeros(2)
    arcs = chords / np.sinc(0.25 * (turns[1:] + turns[:-1]) / np.pi)
    bodies = bodies_length(scene)
    least, most = (float(way.sum() - bodies) / scene.line_length for way in (chords, arcs))
    return min(max(1.0, least), most)


def place_nodes(block: Block, line: Line, guess: laid_shape.Guess, length: float) -> None:
    """Nodes along the polyline, at their share of its length, with slopes along it.

    Bodies of finite length keep theirs: the cable takes what is left. Elements get the tensions
    that are guessed.
    """
    points = guess.points
    chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
    points = points[np.concatenate([[True], chords > 0.0])]
    arc = np.concatenate([[0.0], np.cumsum(chords[chords > 0.0])])
    if arc[-1] <= line.passed[-1]:
        problem = f"the shape is {arc[-1]:g} m long, no longer than its bodies"
        raise SceneError.at("initial.points", None, problem, f"more than {line.passed[-1]:g} m")
    stretch = (arc[-1] - line.passed[-1]) / length
    where = np.zeros(line.nodes)
    for node in range(1, line.nodes):
        where[node] = line.start[node] + line.length[node]
    if guess.arcs is not None:
        arc = guess.arcs[np.concatenate([[True], chords > 0.0])]
        stretch = 1.0
    where *= stretch
    where += line.passed
    where = np.minimum(where, arc[-1])
    if len(points) == 2:  # exactly straight
        direction = (points[1] - points[0]) / arc[-1]
        places = points[0] + np.outer(where, direction)
        slopes = np.tile(direction, (line.nodes, 1))
    else:
        # Linear in the points, so that a turned polyline gives the turned shape (PCHIP does not).
        along = np.gradient(points, arc, axis=0)
        places, slopes = (part.T.copy() for part in hermite(where, arc, points.T, along.T))
    sizes = np.linalg.norm(slopes, axis=1)  # 0 where a line turns back on itself
    if guess.arcs is None:
        slopes *= stretch / np.where(sizes > 0.0, sizes, 1.0)[:, None]
    for node, body, _place in line.bodies:
        if body.half_length > 0.0 and node >= 0:
            # Its ends lie on the shape; the chord between them is shorter than a curved shape.
            middle = 0.5 * (places[node - 1] + places[node])
            axis = places[node] - places[node - 1]
            axis /= np.linalg.norm(axis)
            places[node - 1] = middle - body.half_length * axis
            places[node] = middle + body.half_length * axis
            if node == line.nodes - 1:
                slopes[node] = axis
    dimension = int(block.header.dimension)
    q = block.array(Header.position, line.nodes, 2 * dimension)
    for node in range(line.nodes):
        q[node, :dimension] = local(block, places[node], point=True)
        q[node, dimension:] = local(block, slopes[node], point=False)
    table = block.array(Header.constraints, int(block.header.constraint_count), at.CONSTRAINT_WORDS)
    for row in table:
        if row[at.Constraint.clamped] == at.EXACTLY:
            node = int(row[at.Constraint.node])
            q[node, dimension:] = (
                stretch * row[at.Constraint.direction : at.Constraint.direction.word + dimension]
            )
    if guess.tension is not None:
        arcs, tensions = guess.tension.T
        starts = np.array([s + p for s, p in zip(line.start, line.passed, strict=True)])
        ends = np.interp([starts, starts + line.length], arcs, tensions)
        tension = block.array(Header.tension, line.nodes, 2)
        tension[:, 0] = 0.5 * (ends[0] + ends[1])
        tension[:, 1] = 0.5 * (ends[1] - ends[0])
        tension[0] = 0.0
