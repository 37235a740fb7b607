"""Where the parts of a system are at first: strings of masses, with weight and steady drag.

The kernels find their lowest place (kernels/start/strings.py). Bodies keep the attitude that the
scene gives them. From another one is sought, where lines are clamped to them, if that leads to no
start (clamped_guess.py).
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.start import sea_floor
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import FirstShape, StringLine
from cablemodel.systems.motion import axes_of
from cablemodel.systems.scene import LineEnd, SystemScene

FloatArray = NDArray[np.float64]

STANDS_WITHIN = 0.05
"""Of the way from a body's origin to its farthest foot: gap below the lowest one, or depth of it in
the floor, with which the body is meant to stand there."""


@dataclass
class Guess:
    """The first places of all parts."""

    arcs: dict[str, FloatArray]
    """Arc lengths of each line's masses, from 0 to its length (k,) [m]."""
    lines: dict[str, FloatArray]
    """Their places (k, 3) [m]."""
    bodies: dict[str, FloatArray]
    """Of bodies' origins (3,) [m]."""
    axes: dict[str, FloatArray]
    """Of bodies, in columns (3, 3)."""
    words: FloatArray = field(default_factory=lambda: np.zeros(0))
    """The table of the kernels: a FirstShape with what is behind it."""

    def table(self) -> FloatArray:
        """The kernels' table with these places."""
        words = self.words.copy()
        places = words[len(words) - 3 * _most(words) :].reshape(-1, 3)
        if self.bodies:
            places[: len(self.bodies)] = list(self.bodies.values())
        first = len(self.bodies)
        for points in self.lines.values():
            places[first : first + len(points)] = points
            first += len(points)
        return words


def _most(words: FloatArray) -> int:
    return int(FirstShape(words, 0).most)


def standing(scene: SystemScene) -> dict[str, FloatArray]:
    """Where bodies stand at first that the scene puts on the floor, and friction holds (3,) [m]."""
    floor = scene.environment.floor
    found: dict[str, FloatArray] = {}
    if floor is None or floor.friction == 0.0:
        return found
    for name, body in scene.bodies.items():
        feet = np.array(list(body.points.values()) if body.feet is None else body.feet)
        if body.position is None or body.weight_in(scene.environment) <= 0.0 or not len(feet):
            continue
        places = np.array(body.position) + feet @ axes_of(body.attitude).T
        gap = min(z - floor.height(float(x), float(y)) for x, y, z in places)
        if abs(gap) <= STANDS_WITHIN * float(np.linalg.norm(feet, axis=1).max()):
            found[name] = np.array(body.position) - [0.0, 0.0, gap]
    return found


def held_place(scene: SystemScene, end: LineEnd) -> FloatArray | None:
    """Where an end is held at t = 0 (3,) [m]; None where it is not."""
    if end.anchor is not None:
        return np.array(end.anchor)
    if end.point is None:
        return None
    vessel = scene.vessels.get(end.owner)
    if vessel is None:
        return None
    return vessel.places_at_start()[end.of_owner]


def shape_of(
    scene: SystemScene, velocity: FloatArray, held: dict[tuple[str, int], int] | None = None
) -> FloatArray:
    """What strings are made of, as the kernels know it: a FirstShape with what is behind it.

    velocity: of the frame in which the start is at rest (3,) [m/s]; held: by line and side, rows of
    the block's constraints.
    """
    items = [_items_of(scene, number, name) for number, name in enumerate(scene.lines)]
    bodies = [_body_of(scene, name) for name in scene.bodies]
    ends = [
        _end_of(scene, end, -1 if held is None else held.get((name, side), -1))
        for name, line in scene.lines.items()
        for side, end in enumerate(line.ends)
    ]
    branches = sum(end[at.StringEnd.kind] == at.STRING_ON_LINE for end in ends)
    most = len(bodies) + len(scene.lines) * (at.STRING_PARTS + 1) + branches
    head = np.zeros(at.SHAPE_WORDS)
    shape = FirstShape(head, 0)
    shape.lines, shape.items, shape.bodies = len(items), sum(map(len, items)), len(bodies)
    shape.most, shape.gravity = most, scene.environment.gravity
    current = scene.environment.current
    if current is not None:
        shape.flow = current.velocity.reshape(-1, 3).mean(axis=0)
    shape.velocity = velocity
    random = np.random.default_rng(0).standard_normal(3 * most)
    lines = np.zeros(at.STRING_LINE_WORDS * len(items))
    rows = [row for own in items for row in own]
    return np.concatenate([head, lines, *rows, *bodies, *ends, random, np.zeros(4 * most)])


def _items_of(scene: SystemScene, number: int, name: str) -> list[FloatArray]:
    """Rows of StringItem of a line."""
    rho, found = scene.environment.water_density, []
    for item in scene.lines[name].items:
        row = np.zeros(at.STRING_ITEM_WORDS)
        one = at.StringItem(row, 0)
        one.line = number
        if item.body is not None:
            one.body, one.weight = 1.0, item.body.submerged_weight
            one.drag = 0.5 * rho * item.body.drag_coefficient * item.body.drag_area
        else:
            assert item.cable is not None
            kind = scene.cable_types[item.cable.type]
            one.length, one.weight, one.mass = item.cable.length, kind.submerged_weight, kind.mass
            one.drag = 0.5 * rho * kind.drag_normal * kind.diameter
        found.append(row)
    return found


def _body_of(scene: SystemScene, name: str) -> FloatArray:
    """Row of StringBody."""
    row = np.zeros(at.STRING_BODY_WORDS)
    one, body = at.StringBody(row, 0), scene.bodies[name]
    rho, gravity = scene.environment.water_density, scene.environment.gravity
    one.weight = body.weight_in(scene.environment)
    one.drag = 0.5 * rho * float(np.mean(body.drag_area))
    if body.hull is not None:
        one.middle = body.hull.centre[2]
        one.half = 0.5 * (body.hull.height or body.hull.diameter)
        one.lift = rho * gravity * body.hull.volume
    stands = standing(scene).get(name)
    if stands is not None:
        one.given, one.place = 2.0, stands
    elif body.position is not None:
        one.given, one.place = 1.0, body.position
    return row


def _end_of(scene: SystemScene, end: LineEnd, held: int) -> FloatArray:
    """Row of StringEnd. held: of the block's constraints."""
    row = np.zeros(at.STRING_END_WORDS)
    one, place = at.StringEnd(row, 0), held_place(scene, end)
    if place is not None:
        one.kind, one.place, one.other = at.STRING_HELD, place, held
    elif end.point is not None:
        body = scene.bodies[end.owner]
        one.kind, one.other = at.STRING_AT_BODY, list(scene.bodies).index(end.owner)
        one.place = axes_of(body.attitude) @ np.array(body.points[end.of_owner])
    elif end.line is not None:
        assert end.at is not None
        one.kind, one.other = at.STRING_ON_LINE, list(scene.lines).index(end.line)
        one.arc = end.at
    return row


def first_guess(scene: SystemScene, velocity: FloatArray) -> Guess:
    """The first places. velocity: of the frame in which the start is at rest (3,) [m/s]."""
    return _found(scene, shape_of(scene, velocity))


def drawn_aside(scene: SystemScene, guess: Guess) -> Guess:
    """The first places where each line is drawn across itself: slack that would hang doubled below
    itself opens into a bight. guess: the plain ones."""
    words = guess.words.copy()
    FirstShape(words, 0).aside = 1.0
    return _found(scene, words)


def _found(scene: SystemScene, words: FloatArray) -> Guess:
    from cablemodel.solvers import library as entry

    ground = Block(
        capacity=2, pieces=2, depths=1, times=1, strain_words=0, bodies=0, constraints=1, rates=1,
        cables=1, floor_words=sea_floor.table_words(scene.environment.floor), waves=0, cell_terms=0,
    )  # fmt: skip
    ground.header.dimension = 3
    sea_floor.fill(ground, scene)
    work = np.zeros(0)
    while needed := entry.find_first_shape(ground.ints, ground.reals, words, work):
        work = np.zeros(needed)
    most = _most(words)
    places = words[len(words) - 3 * most :].reshape(-1, 3).copy()
    along = words[len(words) - 4 * most : len(words) - 3 * most]
    arcs, lines = {}, {}
    for number, name in enumerate(scene.lines):
        row = StringLine(words, at.SHAPE_WORDS + number * at.STRING_LINE_WORDS)
        own = slice(int(row.first), int(row.first + row.count))
        arcs[name], lines[name] = along[own].copy(), places[own]
    axes = {name: axes_of(body.attitude) for name, body in scene.bodies.items()}
    return Guess(arcs, lines, dict(zip(scene.bodies, places, strict=False)), axes, words)
