"""First shapes for a static start that lie on the sea floor, and meshes graded to them.

Every element of a first shape has nearly its own length: where the shape is shorter or longer, the
line answers with the forces of that stretch, and may fold before it comes to rest.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.finite_element.mesh import halved_where
from cablemodel.solvers.finite_element.start import free_hanging, laid_loads
from cablemodel.solvers.finite_element.start.laid_loads import lay_angle
from cablemodel.solvers.finite_element.start.sea_floor import (
    contact_depth,
    contact_weight,
    finest_element,
    momentum_of,
    thinnest_layer,
    touchdown_layer,
)
from cablemodel.solvers.shared.curves import crossing, way_along

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.scene.environment import Floor
from cablemodel.solvers.shared.numbers import LYING, NO_DIRECTION, RELATIVE_ROUNDING, TURNED_BACK

FloatArray = NDArray[np.float64]

LEVELS = 25
"""In which the way down through the contact layer is computed."""
BEND = 2.0
"""Radius with which a first shape turns on to the floor, in touchdown layers."""
SHAPE_TURN = 0.4
"""Length of elements in units of that in which a lay's bend dies out above the touchdown."""
CORNER = 2.0 - 0.5 * math.pi
"""Of the radius of an arc that turns by a right angle: what it is shorter than its corner by."""
DIED_OUT = 1e-8
"""What is left of that bend where elements may be longer."""
SHAPE_STEEP = math.radians(60.0)
"""A lay at larger angles needs no elements for that: it dies out as slowly as tension grows."""
GRADING = 0.5
"""Length of elements per distance from the touchdown of a first shape."""

BEYOND = 2.0
"""Touchdown layers behind that place in which a lay's elements are as short as above it."""
FLOOR_PLACES, ARC_PLACES = 65, 17
"""Along what lies in a first shape, and along an arc on to the floor."""
SETTLES_FROM, SETTLES_TO = 1e-3, 1.5
"""Angles to the floor from and up to which a lay sinks into the contact layer [rad]."""
MOST_IN_LAYER = 0.2
"""Of what hangs: what comes down within the contact layer at most."""
NEAR_FLOOR = 1e-3
"""Of the touchdown layer: gap of a first shape that counts as lying."""
RADIUS_FROM, RADIUS_TO = 1e-3, 1e6
"""Of the height: least radius of a catenary, from and up to which it is looked for."""
NO_CORNER = 1e-3
"""Angle at the floor that needs no arc [rad]."""
ROUNDED_AT_MOST = 0.4
"""Of what hangs, and of what lies: what an arc on to the floor takes of it."""
BEYOND_ARC = 1.1
"""Of the way from the corner to the arc's ends: places within are left out."""


@dataclass(frozen=True)
class Guess:
    """From what a start is sought.

    points: polyline from the tow point outwards, (n, 3) [m]; arcs: how much of cables and bodies,
    unstretched, is above each, (n,) [m], or None where the line is spread along it evenly; tension:
    rows of (such an arc length [m], tension [N]), or None where nothing is known of it.
    """

    points: FloatArray
    arcs: FloatArray | None = None
    tension: FloatArray | None = None
    at_rest: bool = False
    """It is an equilibrium's: what lies is within the floor's contact layer, not exactly on it."""


def on_floor(
    scene: Scene, points: FloatArray, *, drawn: bool = False, upright: bool = False
) -> Guess:
    """A first shape for a static start with what lies below the floor laid on it.

    drawn: what lies draws what hangs, see free_hanging.hang. upright: to an anchor, straight down
    and by an arc on to the floor.
    """
    floor = scene.environment.floor
    if floor is None or scene.initial.kind != "static":
        return Guess(points)
    start = points[0]
    if scene.end.kind == "anchor":
        end = np.asarray(scene.end.position, dtype=float)
        if np.array_equal(start, end):
            return Guess(points)
        length = scene.line_length
        if upright:
            return Guess(_upright(floor, start, end, length))
        shape = _laid_to(floor, start, end, length, points, BEND * thinnest_layer(scene))
        return Guess(shape)
    # A clamp's bend stays as it is.
    bend = points[:-2] if len(points) > 2 else points[:0]
    passed = 0.0
    if len(bend):
        start = points[-2]
        passed = float(np.linalg.norm(np.diff(points[:-1], axis=0), axis=1).sum())
    if not points[-1][2] < start[2]:
        return Guess(points)
    hung = free_hanging.hang(scene, start, passed, drawn=drawn)
    if hung is None:
        return Guess(points)
    laying = scene.rate_at_start > 0.0 and not drawn
    length = hung.line_length - hung.arc
    if length <= 0.0:
        shape = np.vstack([bend, hung.points])
        return _stretched(shape, bend, hung) if laying else Guess(shape)
    if laying:
        settled = _settled(scene, hung.points, hung.way, length)
        if settled is not None:
            return _stretched(np.vstack([bend, settled]), bend, hung)
    foot = hung.points[-1]
    laid = _places_on(floor, foot[:2] + np.outer(np.linspace(0.0, length, FLOOR_PLACES), hung.way))
    shape = np.vstack([bend, _rounded(hung.points, laid, BEND * thinnest_layer(scene))])
    return _stretched(shape, bend, hung) if laying else Guess(shape)


def _settled(scene: Scene, hung: FloatArray, way: FloatArray, length: float) -> FloatArray | None:
    """A lay that comes down through the contact layer, (n, 3) [m]; None: it turns by bending.

    Where the floor's layer is thick against the bend, the cable sinks more slowly the more the
    floor bears of its weight: it goes down at the local lay angle, w (1 - p) cos a = D sin^2 a.

    hung: from the vessel down to the floor; way: along which the rest lies, (2,); length: of that.
    """
    floor = scene.environment.floor
    assert floor is not None
    depth = contact_depth(scene)
    foot = hung[-1]
    down = (foot - hung[-2]) / np.linalg.norm(foot - hung[-2])
    rise = laid_loads.slopes(scene, float(foot[0]), float(foot[1]))
    along = np.array([*way, float(np.dot(rise, way))])
    along /= np.linalg.norm(along)
    angle = math.acos(max(-1.0, min(1.0, float(down @ along))))
    if not SETTLES_FROM < angle < SETTLES_TO:
        return None
    above = depth / math.sin(angle)
    arcs = way_along(hung)
    bend = BEND * thinnest_layer(scene) * math.tan(0.5 * angle)
    if bend > above or above > MOST_IN_LAYER * arcs[-1]:
        return None
    top = foot - above * down
    # From the layer's edge down: heights, local angles, way along the floor.
    heights = depth * np.linspace(1.0, 0.0, LEVELS) ** 2
    middle = 0.5 * (heights[1:] + heights[:-1])
    drag = math.cos(angle) / math.sin(angle) ** 2 / (1.0 - (1.0 - middle / depth) ** 2)
    angles = np.array([lay_angle(1.0, float(value)) for value in drag])
    drop = heights[:-1] - heights[1:]
    steps = np.concatenate([[0.0], np.cumsum(drop / np.tan(angles))])
    sinking = float((drop / np.sin(angles)).sum())
    rest = length + above - sinking
    if rest <= 0.0:
        return None
    flat = math.hypot(along[0], along[1])
    steps = np.concatenate([steps, steps[-1] + rest * np.linspace(0.0, 1.0, FLOOR_PLACES)[1:] ** 2])
    heights = np.concatenate([heights, np.zeros(FLOOR_PLACES - 1)])
    places = top[:2] + np.outer(steps, along[:2])
    settled = _places_on(floor, places)
    settled[:, 2] += heights / flat
    # Closer and closer to it, so that its slopes are not carried far up the line.
    last = float(arcs[-1]) - above
    near = last - np.geomspace(above, max(0.5 * last, above), 12)[::-1]
    upper = np.unique(np.concatenate([arcs[arcs < last - above], near[near > 0.0], [0.0]]))
    line = np.column_stack([np.interp(upper, arcs, hung[:, k]) for k in range(3)])
    return np.vstack([line, settled])


def _stretched(points: FloatArray, bend: FloatArray, hung: free_hanging.Hanging) -> Guess:
    """A guess whose line stretches along a polyline as what hangs does, with its tensions."""
    place = way_along(points)
    start = float(place[max(len(bend) - 1, 0)]) if len(bend) else 0.0
    own = start + way_along(hung.points)
    arcs = np.where(
        place < own[-1],
        np.interp(place, own, hung.arcs),
        hung.arcs[-1] + (place - own[-1]),
    )
    if len(bend):
        arcs[: len(bend)] = place[: len(bend)]
    # What a corner cut off lies at the far end: spread over the line it would stretch all of it.
    last = points[-1] - points[-2]
    size = float(np.linalg.norm(last))
    missing = max(hung.line_length - float(arcs[-1]), -0.5 * size)
    points = np.vstack([points[:-1], points[-1] + missing / size * last])
    arcs[-1] += missing
    arcs *= hung.line_length / arcs[-1]
    end = [[hung.line_length * (1.0 + RELATIVE_ROUNDING), 0.0]]
    return Guess(points, arcs, np.vstack([np.column_stack([hung.arcs, hung.tension]), end]))


def _places_on(floor: Floor, places: FloatArray) -> FloatArray:
    """Where the floor is at horizontal places (n, 2), (n, 3) [m]."""
    return np.column_stack([places, [floor.height(float(x), float(y)) for x, y in places]])


def surplus(scene: Scene) -> float:
    """Cable beyond straight down and along the floor to the anchor [m]; 0 without an anchor."""
    floor = scene.environment.floor
    if floor is None or scene.end.kind != "anchor":
        return 0.0
    start = scene.motion().evaluate(0.0)[0]
    end = np.asarray(scene.end.position, dtype=float)
    down = float(start[2]) - floor.height(float(start[0]), float(start[1]))
    rise = floor.height(float(start[0]), float(start[1])) - float(end[2])
    along = math.hypot(float(start[0] - end[0]), float(start[1] - end[1]), rise)
    return max(0.0, scene.line_length - down - along)


def refine_guess(scene: Scene, nodes: list[FloatArray], guess: Guess) -> list[FloatArray]:
    """Nodes graded towards where a first shape comes to lie on the floor, for a static start.

    nodes: arc lengths of the nodes of every cable [m], each from 0 to its length. Elsewhere than
    at that kink a coarse mesh finds its shape from anywhere.
    """
    points = guess.points
    if scene.environment.floor is None or scene.initial.kind != "static" or len(points) < 4:
        return nodes
    floor = scene.environment.floor
    arcs = way_along(points) if guess.arcs is None else guess.arcs
    near = LYING * contact_depth(scene) if guess.at_rest else NEAR_FLOOR * thinnest_layer(scene)
    lies = [z < floor.height(float(x), float(y)) + near for x, y, z in points]
    if not any(lies):
        return nodes
    touchdown = float(arcs[lies.index(True)] / arcs[-1] * scene.line_length)
    smallest = finest_element(scene)
    heights, longest = _bend_of_lay(scene)
    beyond = BEYOND * thinnest_layer(scene)

    def is_too_long(arc: float, a: float, b: float) -> bool:
        near = distance(arc + a, arc + b, touchdown)
        if arc + a < touchdown + beyond and near < heights[-1]:
            above = near if arc + b <= touchdown else 0.0
            return b - a > float(np.interp(above, heights, longest))
        return b - a > max(2.0 * smallest, GRADING * near)

    return halved_where(scene.cables, nodes, is_too_long)


def _bend_of_lay(scene: Scene) -> tuple[FloatArray, FloatArray]:
    """Distances above the touchdown of a lay, and how long elements may be there [m].

    A turn b from the lay angle a obeys  EI d3b/ds3 = Te db/ds + k b  with the tension
    Te = w sin a s - (m + ma) V^2, and k = w (sin a + 2 cos^2 a / sin a) by which drag turns it
    back. At small angles k is large, and it dies out within a short way of the touchdown. On
    elements that are long against 1/|root|, of the slowest one, it swings from one to the next up
    the whole line instead, and Newton's method loses its way. Beyond, nothing turns.
    """
    rate = scene.rate_at_start
    velocity = scene.motion().evaluate(0.0)[1]
    speed = float(np.hypot(velocity[0], velocity[1]))
    cable = scene.cables[-1]
    kind = scene.cable_types[cable.type]
    if rate <= 0.0 or speed == 0.0 or kind.submerged_weight <= 0.0:
        return np.zeros(1), np.zeros(1)
    weight, density = kind.submerged_weight, scene.environment.water_density
    angle = lay_angle(weight, 0.5 * density * kind.drag_normal * kind.diameter * speed**2)
    if angle > SHAPE_STEEP:
        return np.zeros(1), np.zeros(1)
    layer = touchdown_layer(scene, cable)
    stiffness = contact_weight(kind, scene.environment.gravity) * layer**3
    momentum = momentum_of(kind, density, rate)
    turns_back = weight * (math.sin(angle) + 2.0 * math.cos(angle) ** 2 / math.sin(angle))
    heights: list[float] = [0.0]
    longest: list[float] = []
    left = 1.0
    while left > DIED_OUT and heights[-1] < scene.line_length:
        pull = weight * math.sin(angle) * heights[-1] - momentum
        roots = np.roots([stiffness, 0.0, -pull, turns_back])
        slowest = min((root for root in roots if root.real > 0.0), key=lambda root: root.real)
        longest.append(SHAPE_TURN / abs(slowest))
        heights.append(heights[-1] + longest[-1])
        left *= math.exp(-float(slowest.real) * longest[-1])
    return np.array(heights), np.array([*longest, longest[-1]])


def distance(start: float, end: float, place: float) -> float:
    """Of a place from an element along the line, arc lengths [m]."""
    return max(start - place, place - end, 0.0)


def _laid_to(
    floor: Floor,
    start: FloatArray,
    end: FloatArray,
    length: float,
    hanging: FloatArray,
    radius: float,
) -> FloatArray:
    """A cable to an anchor: as it hangs where clear of the floor, else straight and laid."""
    if all(p[2] > floor.height(float(p[0]), float(p[1])) for p in hanging[1:-1]):
        return hanging
    across = float(np.hypot(*(start - end)[:2]))
    way = (end - start)[:2] / max(across, NO_DIRECTION)
    arc = _catenary(length - across, float(start[2] - end[2]), radius)
    hang = arc[0, 0] if len(arc) else 0.0
    if hang > across:
        return hanging
    laid = _places_on(floor, start[:2] + np.outer(np.linspace(hang, across, FLOOR_PLACES), way))
    laid[-1] = end
    if not len(arc):
        return _rounded(np.vstack([start, laid[0]]), laid, radius)
    hung = np.empty((len(arc) - 1, 3))
    hung[:, :2] = laid[0, :2] - np.outer(arc[:-1, 0], way)
    hung[:, 2] = start[2] + (arc[:-1, 1] - arc[0, 1]) * (start[2] - laid[0, 2]) / arc[0, 1]
    return np.vstack([hung, laid])


def _upright(floor: Floor, start: FloatArray, end: FloatArray, length: float) -> FloatArray:
    """A cable to an anchor that hangs straight down, and turns on to the floor, as if that were
    level, by an arc that makes it as long as it is, (n, 3) [m]."""
    laid = _places_on(
        floor, start[:2] + np.outer(np.linspace(0.0, 1.0, FLOOR_PLACES), (end - start)[:2])
    )
    laid[-1] = end
    cut = float(start[2] - laid[0, 2] + way_along(laid)[-1]) - length
    return _rounded(np.vstack([start, laid[0]]), laid, max(cut, 0.0) / CORNER)


def _catenary(slack: float, rise: float, smallest: float) -> FloatArray:
    """A catenary that leaves a level floor, from its top down to the touchdown, (n, 2) [m].

    slack: its length less its span; rise: its height; smallest: least radius at its foot [m].
    Columns: distance from the touchdown, height. Empty where the slack is all of the rise, or where
    there is no rise.
    """
    if rise <= 0.0:
        return np.empty((0, 2))

    def excess(log_radius: float) -> float:
        radius = math.exp(log_radius)
        span = radius * math.acosh(1.0 + rise / radius)
        return math.sqrt(rise * (rise + 2.0 * radius)) - span - slack

    low, high = math.log(RADIUS_FROM * rise), math.log(RADIUS_TO * rise)
    at_low, at_high = excess(low), excess(high)
    if at_low <= 0.0 or at_high >= 0.0:
        return np.empty((0, 2))
    log_radius = crossing(
        excess, low, high, at_low=at_low, at_high=at_high, near=0.0, width=RELATIVE_ROUNDING
    )
    radius = max(smallest, math.exp(log_radius))
    arcs = math.sqrt(rise * (rise + 2.0 * radius)) * np.linspace(1.0, 0.0, FLOOR_PLACES) ** 2
    turned = arcs / radius
    return np.stack([radius * np.arcsinh(turned), radius * (np.hypot(1.0, turned) - 1.0)], axis=-1)


def _rounded(hung: FloatArray, laid: FloatArray, radius: float) -> FloatArray:
    """A line from the vessel that turns by an arc into a polyline on the floor, (n, 3) [m].

    hung: from the vessel down to the floor; laid: from there on; radius: of the arc, which is
    smaller where one of them is short.
    """
    corner = laid[0]
    hangs, lies = float(np.linalg.norm(hung[0] - corner)), float(np.linalg.norm(laid[-1] - corner))
    if hangs == 0.0:
        return laid
    if len(hung) < 2 or lies == 0.0:
        return np.vstack([hung[:-1], laid])
    down = corner - hung[-2]
    along = laid[1] - corner
    if not np.any(along):  # the anchor is right below
        return np.vstack([hung[:-1], laid])
    down, along = down / np.linalg.norm(down), along / np.linalg.norm(along)
    angle = math.acos(max(-1.0, min(1.0, float(down @ along))))
    inward = along - float(along @ down) * down
    if angle < NO_CORNER or np.linalg.norm(inward) < TURNED_BACK:
        return np.vstack([hung[:-1], laid])
    reach = min(radius * math.tan(0.5 * angle), ROUNDED_AT_MOST * hangs, ROUNDED_AT_MOST * lies)
    radius = reach / math.tan(0.5 * angle)
    inward /= np.linalg.norm(inward)
    turned = np.linspace(0.0, angle, ARC_PLACES)[:, None]
    arc = corner - reach * down + radius * (np.sin(turned) * down + (1.0 - np.cos(turned)) * inward)
    above = np.linalg.norm(hung - corner, axis=1) > BEYOND_ARC * reach
    beyond = np.linalg.norm(laid - corner, axis=1) > BEYOND_ARC * reach
    return np.vstack([hung[above], arc, laid[beyond]])
