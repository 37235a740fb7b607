"""The first shape of a line with a free end that reaches the floor: as a lay would leave it.

What hangs is in balance with its weight and the drag, and without tension where it lands (unless
what lies is pulled from there on); what lies is straight. Bending is left out.
"""

from __future__ import annotations

import functools
import itertools
import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.finite_element.start import laid_loads
from cablemodel.solvers.finite_element.start.frame import vertical_plane
from cablemodel.solvers.shared.curves import crossing

if TYPE_CHECKING:
    from cablemodel.scene import Scene
from cablemodel.solvers.shared.numbers import NO_DIRECTION

FloatArray = NDArray[np.float64]
Triple = tuple[float, float, float]
Shape = tuple[FloatArray, FloatArray, FloatArray]

HANGING_STEPS = 64
"""In which the hanging part is integrated."""
TURNS, WIDEST, NUDGE = 50, 0.5, 1e-7
"""Iterations for the direction of a step at most; the largest turn of one, that of a difference
[rad]."""
HANGING_NEAR = 1e-9
"""Of the line's length: from the floor, where it has landed."""
NARROW = 1e-7
"""Of the line's length: the piece that lands, where the drop of its end jumps (a body lands)."""
ROUNDS = 12
"""In which the depth is found at which it lands in a current on a slope, at most."""
AHEAD_FOUND = 1e-9
"""Of the force: what may be across the cable that it pulls."""


@dataclass(frozen=True)
class Hanging:
    """What hangs at first, and how it goes on.

    points: (n, 3) from the tow point down to where the line lands, or to its end [m]; arcs: how
    much line, unstretched, is above each, (n,) [m]; tension: there, (n,) [N]; arc: its
    length, bodies included [m]; line_length: of all of the line, bodies included [m]; way: unit
    vector along which the rest lies, (2,).
    """

    points: FloatArray
    arcs: FloatArray
    tension: FloatArray
    arc: float
    line_length: float
    way: FloatArray


def hang(scene: Scene, start: FloatArray, passed: float, *, drawn: bool = False) -> Hanging | None:
    """From a place at the arc length `passed` down to the floor; None: it ends above it.

    start: (3,) [m]; drawn: what no friction holds lies where it draws the rest by its own weight
    and the drag along it, not where the water pushes it broadside. Raises nothing.
    """
    floor = scene.environment.floor
    assert floor is not None
    line = laid_loads.pieces(scene)
    total = line[-1].end
    plane = vertical_plane(scene, [])
    way, tension = _lying(scene, line, start, plane, drawn=drawn)
    bottom = floor.height(float(start[0]), float(start[1]))
    sloped = floor.z is None or any(floor.slope)
    height = float(start[2]) - bottom
    straight_down = height > total - passed
    if straight_down and not sloped:
        return None  # nowhere does it come down further

    def above(shape: Shape) -> float:
        """Height of the lower end of what hangs above the floor [m]."""
        x, y, z = (float(value) for value in shape[0][-1])
        return z - floor.height(x, y)

    @functools.cache
    def landing(bottom: float) -> Hanging | None:
        """What hangs where the water below is so deep [m]."""
        water = _Water(scene, start, bottom)

        def shape_of(arc: float) -> Shape:
            points, arcs, tensions = _integrate(
                line, water, passed, arc, tension * (total - arc), way
            )
            if plane is not None:
                points[:, :2] = np.outer(points[:, :2] @ plane, plane)
            return points + start, arcs, tensions

        shape = shape_of(total)
        gap = above(shape)
        if gap > 0.0:
            return None if straight_down else Hanging(*shape, total, total, way)
        lands = crossing(
            lambda arc: above(shape_of(arc)),
            passed,
            total,
            at_low=height,
            at_high=gap,
            near=HANGING_NEAR * total,
            width=NARROW * total,
        )
        shape = shape_of(lands)
        points = shape[0]
        points[-1, 2] = floor.height(float(points[-1, 0]), float(points[-1, 1]))
        return Hanging(*shape, lands, total, way)

    hung = landing(bottom)
    if not sloped or scene.environment.current is None:
        return hung

    def off(bottom: float) -> float:
        """How much deeper it lands [m]."""
        nonlocal hung
        hung = landing(bottom)
        return 0.0 if hung is None else bottom - float(hung.points[-1, 2])

    if hung is not None:
        from scipy.optimize import newton

        lower = float(hung.points[-1, 2])
        newton(off, bottom, x1=lower, tol=NARROW * total, maxiter=ROUNDS, disp=False)
    return hung


def way_of_lying(scene: Scene, start: FloatArray) -> FloatArray:
    """Unit vector along which the rest of a line lies that hangs down to the floor, (2,)."""
    line = laid_loads.pieces(scene)
    return _lying(scene, line, start, vertical_plane(scene, []), drawn=False)[0]


class _Water:
    """Velocity of the water past the line, over height above where it lands."""

    def __init__(self, scene: Scene, start: FloatArray, bottom: float) -> None:
        """start: (3,), bottom: height of the place where it lands [m]."""
        z = np.linspace(min(bottom, float(start[2])), float(start[2]), HANGING_STEPS + 1)
        past = laid_loads.water_velocity(scene, z) - scene.motion().evaluate(0.0)[1]
        self._rows = [tuple(row) for row in past.tolist()]
        self._level = max(float(z[1] - z[0]), 1e-300)
        self.rate = scene.rate_at_start
        """Of the pay-out: the cable runs along its own shape [m/s]."""

    def at(self, height: float) -> Triple:
        """At a height above the place where it lands [m]: (3,) [m/s]."""
        level = min(float(HANGING_STEPS), max(0.0, height / self._level))
        row = min(int(level), HANGING_STEPS - 1)
        low, high, part = self._rows[row], self._rows[row + 1], level - row
        return _between(low, high, part)


def _lying(
    scene: Scene,
    line: list[laid_loads.Piece],
    start: FloatArray,
    plane: FloatArray | None,
    *,
    drawn: bool,
) -> tuple[FloatArray, float]:
    """The way along which what lies goes, (2,), and what each metre of it pulls there [N/m].

    Where friction holds it, it lies behind the vessel, or downstream of one at rest, and pulls by
    nothing. What the vessel drags, and what friction does not hold, goes where the loads on it go.
    """
    floor = scene.environment.floor
    assert floor is not None
    velocity = np.asarray(scene.motion().evaluate(0.0)[1], dtype=float)
    bottom = floor.height(float(start[0]), float(start[1]))
    current = laid_loads.water_velocity(scene, np.array([bottom]))[0]
    behind = laid_loads.behind(scene, velocity[:2], current[:2])
    dragged = laid_loads.is_dragged(scene)
    rise = np.array(laid_loads.slopes(scene, float(start[0]), float(start[1])))
    flow = current[:2] - (velocity[:2] if dragged else 0.0)
    speed = float(np.hypot(*flow))
    total = max(line[-1].end, NO_DIRECTION)
    load, bears, along = np.zeros(2), 0.0, 0.0
    for piece in line:
        share = ((piece.end - piece.start) or 1.0) / total
        push = piece.tangential if drawn else piece.normal
        load += share * (push * speed * flow - piece.weight * rise)
        along += share * (push - piece.tangential)
        bears += share * piece.contact
    holds = floor.friction * bears
    if dragged:
        # Of a vessel at rest that reels in it comes along itself.
        goes = velocity[:2] if np.any(velocity[:2]) else -behind
        load -= holds * goes / float(np.hypot(*goes))
        holds = 0.0
    if np.hypot(*load) <= holds or not np.any(load):
        return behind, 0.0
    way = load / float(np.hypot(*load))
    if plane is not None:
        way = plane * math.copysign(1.0, float(way @ plane))
    # Along the flow the drag is that along the cable.
    return way, max(0.0, float(load @ way) - along * speed * abs(float(flow @ way)) - holds)


def _integrate(
    line: list[laid_loads.Piece],
    water: _Water,
    first: float,
    last: float,
    tension: float,
    way: FloatArray,
) -> Shape:
    """The shape of what hangs, from its upper end: places relative to that (n, 3) [m], arc lengths
    (n,) [m], tensions (n,) [N].

    Integrated from its lower end up, by backward differences of two steps (one where the cable
    changes); a line that is paid out stretches by its tension.

    first, last: arc lengths of its ends [m]; tension: of what lies beyond, along `way` [N].
    """
    knots = [first, last]
    knots += [k for p in line for k in (p.start, p.end) if first < k < last]
    arcs = sorted({*np.linspace(first, last, HANGING_STEPS + 1).tolist(), *knots})
    points = [p for p in line if p.start == p.end and first <= p.start < last]
    # The force of the cable above on what is below it, to begin with by its own loads.
    force = -tension * float(way[0]), -tension * float(way[1]), 0.0
    before, step = force, 0.0
    ahead = below = 0.0, 0.0, 1.0
    places = [(0.0, 0.0, 0.0)]
    sizes = [math.hypot(*force)]
    x = y = z = 0.0
    for upper, lower in itertools.pairwise(reversed(arcs)):
        # Reversed: `upper` is the larger arc length, further from the vessel.
        h = upper - lower
        middle = 0.5 * (upper + lower)
        piece = next((p for p in line if p.start <= middle < p.end), line[0])
        for body in points:
            if lower < body.start <= upper:
                force = _loaded(force, body, 1.0, water.at(z), ahead, water.rate)
                step = 0.0
        if upper in knots:
            step = 0.0
        ratio = h / step if step > 0.0 else 0.0
        weight = (1.0 + ratio) ** 2 / (1.0 + 2.0 * ratio)
        known = _between(before, force, weight)
        share = h * (1.0 + ratio) / (1.0 + 2.0 * ratio)
        flow = water.at(z + h * ahead[2])
        ahead = _balanced(known, piece, share, flow, ahead, water.rate)
        before, step = force, h
        force = _loaded(known, piece, share, flow, ahead, water.rate)
        if ratio == 0.0:
            below = ahead
        if water.rate > 0.0:
            h *= piece.stretch(math.hypot(*force))
        x += 0.5 * h * (below[0] + ahead[0])
        y += 0.5 * h * (below[1] + ahead[1])
        z += 0.5 * h * (below[2] + ahead[2])
        below = ahead
        places.append((x, y, z))
        sizes.append(math.hypot(*force))
    shape = np.array(places)
    return np.asarray(shape[::-1] - shape[-1]), np.array(arcs), np.array(sizes[::-1])


def _balanced(
    force: Triple, piece: laid_loads.Piece, length: float, flow: Triple, ahead: Triple, rate: float
) -> Triple:
    """The direction of a length of cable along which the force above it points: a backward step.

    Where drag turns the cable sharply against what it is taut (at a small lay angle, near its lower
    end) any forward step is too long. Newton's method on the two angles, from `ahead`.
    """
    for _ in range(TURNS):
        first, second = _across(ahead)
        total = _loaded(force, piece, length, flow, ahead, rate)
        along = _dot(total, ahead)
        a, b = _dot(total, first), _dot(total, second)
        size = math.hypot(*total)
        if math.hypot(a, b) <= AHEAD_FOUND * size and along > 0.0:
            break
        by_first = _loaded(force, piece, length, flow, _turned(ahead, first, NUDGE), rate)
        by_second = _loaded(force, piece, length, flow, _turned(ahead, second, NUDGE), rate)
        aa = (_dot(by_first, first) - a) / NUDGE - along
        ba = (_dot(by_first, second) - b) / NUDGE
        ab = (_dot(by_second, first) - a) / NUDGE
        bb = (_dot(by_second, second) - b) / NUDGE - along
        determinant = aa * bb - ab * ba
        if determinant <= 0.0 or along <= 0.0:
            # Far from balance: towards the force.
            turn_first, turn_second = a / max(size, 1e-300), b / max(size, 1e-300)
        else:
            turn_first = (ab * b - bb * a) / determinant
            turn_second = (ba * a - aa * b) / determinant
        turn = math.hypot(turn_first, turn_second)
        if turn == 0.0:
            if along >= 0.0:
                break
            turn_first = turn = 1.0  # exactly against the force
        share = min(1.0, WIDEST / turn)
        ahead = _turned(ahead, first, share * turn_first)
        ahead = _turned(ahead, second, share * turn_second)
    return ahead


def _dot(a: Triple, b: Triple) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _between(a: Triple, b: Triple, share: float) -> Triple:
    """At a share of the way from one vector to another."""
    x, y, z = (p + share * (q - p) for p, q in zip(a, b, strict=True))
    return x, y, z


def _turned(ahead: Triple, aside: Triple, by: float) -> Triple:
    """A unit vector with `by` times another one added to it."""
    x, y, z = (p + by * q for p, q in zip(ahead, aside, strict=True))
    size = math.hypot(x, y, z)
    return x / size, y / size, z / size


def _across(ahead: Triple) -> tuple[Triple, Triple]:
    """Two unit vectors across a third and each other, the second one horizontal."""
    x, y, z = ahead
    flat = math.hypot(x, y)
    if flat < NO_DIRECTION:
        return (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)
    return (-z * x / flat, -z * y / flat, flat), (-y / flat, x / flat, 0.0)


def _loaded(
    force: Triple, piece: laid_loads.Piece, length: float, flow: Triple, ahead: Triple, rate: float
) -> Triple:
    """The force from above, and what bears the loads on a length of a piece [N].

    rate: at which the cable runs along itself, against `ahead` [m/s].
    """
    x, y, z = ahead
    along = flow[0] * x + flow[1] * y + flow[2] * z
    a, b, c = flow[0] - along * x, flow[1] - along * y, flow[2] - along * z
    along += rate
    normal = length * piece.normal * math.sqrt(a * a + b * b + c * c)
    tangential = length * piece.tangential * abs(along) * along
    return (
        force[0] - normal * a - tangential * x,
        force[1] - normal * b - tangential * y,
        force[2] - normal * c - tangential * z + length * piece.weight,
    )
