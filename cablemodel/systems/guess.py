"""Where the parts of a system are at first: strings of masses, with weight and steady drag.

Strings pull and do not push, so the energy is convex and has one lowest place, whatever the start.
Bodies keep the attitude that the scene gives them. From another one is sought, where lines are
clamped to them, if that leads to no start (clamped_guess.py).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.systems.motion import axes_of
from cablemodel.systems.scene import LineEnd, SystemScene

if TYPE_CHECKING:
    from scipy.sparse import csc_matrix
from cablemodel.solvers.shared.numbers import NO_DIRECTION

FloatArray = NDArray[np.float64]
Numbers = NDArray[np.intp]

PARTS = 12
"""Strings that a line without branches is made of."""
STRETCH = 0.3, 0.1, 0.03, 0.01, 0.004, 0.002
"""By which all forces together stretch one of them, one after the other: stiff strings let a step
turn them by little."""
ITERATIONS = 1000
"""For the lowest place of an energy, at most."""
BALANCED = 0.01
"""Of the least of all forces: what may be left of them at any place."""
SHARE_OF_DRAG = 0.3
"""Of a line's drag across, that it has on the average as it hangs."""
ASIDE_LOAD = 0.5
"""Load that draws lines aside, in units of their weight in water."""
AFLOAT = 0.02
"""Of a line's weight in air: what that is at least."""
STANDS_WITHIN = 0.05
"""Of the way from a body's origin to its farthest foot: gap below the lowest one, or depth of it in
the floor, with which the body is meant to stand there."""
LESS_DAMPED, MORE_DAMPED = 0.3, 4.0
"""Of the damping: the next one, after a step that lowers the energy, and after another one."""
MOST_DAMPED = 1e9
"""In force over length: damping at which no step is left."""
UPRIGHT_LINE = 0.1
"""Of a line's length: span across which it counts as upright."""
NO_WEIGHT = 1e-6
"""Of the weight in air: what is taken of cable that has none in water."""
NO_LOAD = 1e-9
"""Added to all loads together [N]: there may be none."""
SHAKEN = 1e-3
"""Of the shortest string: by what places are moved at random before the first step."""


def _lowest(
    energy: Callable[[FloatArray], tuple[float, FloatArray, csc_matrix]],
    x: FloatArray,
    force: float,
    least: float,
    length: float,
    adrift: list[Numbers],
) -> FloatArray:
    """The lowest place (n, 3) of a convex energy, by Newton's method with Levenberg's damping.

    force, least: all together, and the least of them at a place [N]; length: a typical one [m];
    adrift: rows of what only moves together, which nothing holds from moving sideways: rounding
    divided by the damping would.
    """
    from scipy.sparse import identity
    from scipy.sparse.linalg import spsolve

    damping = force / length
    value, slope, matrix = energy(x)
    unit = identity(x.size, format="csc")
    for _iteration in range(ITERATIONS):
        step = spsolve(matrix + damping * unit, -slope.reshape(-1)).reshape(x.shape)
        for rows in adrift:
            step[rows, :2] -= step[rows, :2].mean(axis=0)
        trial = energy(x + step)
        if trial[0] < value:
            x = x + step
            value, slope, matrix = trial
            damping *= LESS_DAMPED
            if float(np.abs(slope).max()) < BALANCED * least:
                break
        else:
            damping *= MORE_DAMPED
            if damping > MOST_DAMPED * force / length:
                break
    return x


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

    def at(self, line: str, arcs: FloatArray) -> FloatArray:
        """Places (n, 3) at arc lengths of a line (n,) [m]."""
        points, own = self.lines[line], self.arcs[line]
        return np.column_stack([np.interp(arcs, own, points[:, i]) for i in range(3)])


def arcs_of(scene: SystemScene, name: str) -> FloatArray:
    """Arc lengths of a line's masses (k,) [m]: at equal steps, with one where a branch is in the
    place of those within half a step of it."""
    length = scene.lines[name].length
    ends = (end for line in scene.lines.values() for end in line.ends)
    branches = np.unique([end.at for end in ends if end.line == name and end.at is not None])
    equal = np.linspace(0.0, length, PARTS + 1)
    near = np.abs(equal[:, None] - branches).min(axis=1, initial=np.inf)
    alone = near >= 0.5 * length / PARTS
    alone[[0, -1]] = True
    return np.union1d(equal[alone], branches)


def _nearest(arcs: FloatArray, arc: float) -> int:
    """Which mass is nearest to an arc length."""
    return int(np.argmin(np.abs(arcs - arc)))


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


def ways_aside(guess: Guess) -> dict[str, FloatArray]:
    """Horizontal ways (3,) across each line, from its beginning to its end; of an upright one x."""
    found = {}
    for name, points in guess.lines.items():
        chord = points[-1] - points[0]
        across = np.array([-chord[1], chord[0], 0.0])
        size = float(np.linalg.norm(across))
        upright = size <= UPRIGHT_LINE * float(np.abs(guess.arcs[name][-1]))
        found[name] = np.array([1.0, 0.0, 0.0]) if upright else across / size
    return found


@dataclass(frozen=True)
class _Masses:
    """What has a place: bodies, then the masses of lines, by their numbers."""

    arcs: dict[str, FloatArray]
    """Arc lengths of each line's masses [m]."""
    bodies: dict[str, int]
    lines: dict[str, list[int]]
    count: int

    @property
    def strings(self) -> tuple[Numbers, Numbers, FloatArray]:
        """Numbers at both ends of each string, and its length [m]."""
        return (
            np.concatenate([nodes[:-1] for nodes in self.lines.values()]),
            np.concatenate([nodes[1:] for nodes in self.lines.values()]),
            np.concatenate([np.diff(own_arcs) for own_arcs in self.arcs.values()]),
        )


def _masses_of(scene: SystemScene) -> _Masses:
    bodies = {name: number for number, name in enumerate(scene.bodies)}
    count = len(bodies)
    arcs = {name: arcs_of(scene, name) for name in scene.lines}
    lines: dict[str, list[int]] = {}
    for name, own_arcs in arcs.items():
        lines[name] = list(range(count, count + len(own_arcs)))
        count += len(own_arcs)
    return _Masses(arcs, bodies, lines, count)


def _loads(
    scene: SystemScene,
    masses: _Masses,
    velocity: FloatArray,
    aside: dict[str, FloatArray] | None,
) -> FloatArray:
    """Weight in water and steady drag of each mass (count, 3) [N]; arguments: see first_guess."""
    rho, gravity = scene.environment.water_density, scene.environment.gravity
    current = scene.environment.current
    flow = -velocity
    if current is not None:
        flow = flow + current.velocity.reshape(-1, 3).mean(axis=0)
    speed = float(np.linalg.norm(flow))
    loads = np.zeros((masses.count, 3))
    for name, body in scene.bodies.items():
        loads[masses.bodies[name], 2] -= body.weight_in(scene.environment)
        loads[masses.bodies[name]] += 0.5 * rho * speed * np.mean(body.drag_area) * flow
    for name, line in scene.lines.items():
        edges, numbers = masses.arcs[name], masses.lines[name]
        along = 0.0
        for item in line.items:
            if item.body is not None:
                load = np.array([0.0, 0.0, -item.body.submerged_weight])
                area = item.body.drag_coefficient * item.body.drag_area
                loads[numbers[_nearest(edges, along)]] += load + 0.5 * rho * speed * area * flow
                continue
            assert item.cable is not None
            kind = scene.cable_types[item.cable.type]
            weight = kind.submerged_weight or NO_WEIGHT * kind.mass * gravity
            load = np.array([0.0, 0.0, -weight])
            load += SHARE_OF_DRAG * 0.5 * rho * kind.drag_normal * kind.diameter * speed * flow
            if aside is not None:
                load += ASIDE_LOAD * max(abs(weight), AFLOAT * kind.mass * gravity) * aside[name]
            low, high = along, along + item.cable.length
            for k in range(len(edges) - 1):
                part = max(0.0, min(high, edges[k + 1]) - max(low, edges[k]))
                for node in (k, k + 1):
                    loads[numbers[node]] += 0.5 * part * load
            along = high
    return loads


@dataclass(frozen=True)
class _Ties:
    """What holds masses: the place of each is that of its owner, or one that is fixed, and an
    offset."""

    fixed: dict[int, FloatArray]
    """Places (3,) of those that are [m]."""
    owner: Numbers
    """Of each mass whose place it has (count,)."""
    free: Numbers
    """Masses that nothing holds: the unknowns are their places."""
    unknown: Numbers
    """Of each mass the number of its owner among those, or -1 (count,)."""
    base: FloatArray
    """What is added to the unknown place (count, 3) [m]."""

    def places(self, x: FloatArray) -> FloatArray:
        """Of all masses (count, 3), from those of the free ones [m]."""
        if not len(self.free):
            return self.base
        moved = x[np.maximum(self.unknown, 0)]
        return np.asarray(self.base + np.where((self.unknown >= 0)[:, None], moved, 0.0))


def _ties_of(scene: SystemScene, masses: _Masses) -> _Ties:
    bodies, lines = masses.bodies, masses.lines
    fixed: dict[int, FloatArray] = {bodies[name]: at for name, at in standing(scene).items()}
    ties: list[tuple[int, int, FloatArray]] = []  # place = that of another one, and an offset
    for name, line in scene.lines.items():
        for side, end in enumerate(line.ends):
            node = lines[name][-1 if side else 0]
            place = held_place(scene, end)
            if place is not None:
                fixed[node] = place
            elif end.point is not None:
                body = scene.bodies[end.owner]
                arm = axes_of(body.attitude) @ np.array(body.points[end.of_owner])
                ties.append((node, bodies[end.owner], arm))
            elif end.line is not None:
                assert end.at is not None
                nearest = lines[end.line][_nearest(masses.arcs[end.line], end.at)]
                ties.append((node, nearest, np.zeros(3)))
    owner = np.arange(masses.count)
    base = np.zeros((masses.count, 3))
    for node, other, arm in ties:
        owner[node], base[node] = other, arm
    for node, other, _arm in ties:  # of a branch from a line's end at a body
        if owner[other] != other:
            base[node] += base[other]
            owner[node] = owner[other]
    free = np.array(
        [k for k in range(masses.count) if owner[k] == k and k not in fixed], dtype=np.intp
    )
    column = np.full(masses.count, -1)
    column[free] = np.arange(len(free))
    for node, place in fixed.items():
        base[owner == node] += place
    return _Ties(fixed, owner, free, column[owner], base)


class _Energy:
    """Of strings that pull and do not push, their loads, hulls that float and the floor."""

    def __init__(self, scene: SystemScene, masses: _Masses, ties: _Ties, loads: FloatArray) -> None:
        self.left, self.right, self.rest = masses.strings
        self.ties, self.loads = ties, loads
        self.total = float(np.abs(loads).sum()) + NO_LOAD
        self.floor = scene.environment.floor
        self.hard = self.total / (STRETCH[-1] * float(self.rest.min()))
        rho, gravity = scene.environment.water_density, scene.environment.gravity
        self.hulls = [
            (
                masses.bodies[name],
                body.hull.centre[2],
                0.5 * (body.hull.height or body.hull.diameter),
                rho * gravity * body.hull.volume,
            )
            for name, body in scene.bodies.items()
            if body.hull is not None
        ]

    def __call__(self, x: FloatArray, stretch: float) -> tuple[float, FloatArray, csc_matrix]:
        """Energy, its gradient over the free places (n, 3), and its Hessian (3 n, 3 n), where all
        forces together stretch a string by `stretch`."""
        left, right = self.left, self.right
        p = self.ties.places(x)
        stiff = self.total / (stretch * self.rest)
        d = p[right] - p[left]
        size = np.maximum(np.linalg.norm(d, axis=1), NO_DIRECTION)
        over = np.maximum(0.0, size - self.rest)
        value = float((0.5 * stiff * over**2).sum() - (self.loads * p).sum())
        unit = d / size[:, None]
        along = unit[:, :, None] * unit[:, None, :]
        share = over / size
        string = share[:, None, None] * np.eye(3) + (1.0 - share)[:, None, None] * along
        string *= (stiff * (over > 0.0))[:, None, None]
        own = np.zeros((len(p), 3, 3))
        slope = -self.loads.copy()
        value = self._add_hulls(p, value, slope, own)
        if self.floor is not None:
            sunk = np.array([self.floor.height(float(x), float(y)) - z for x, y, z in p])
            sunk = np.maximum(0.0, sunk)
            value += float(0.5 * self.hard * (sunk**2).sum())
            slope[:, 2] -= self.hard * sunk  # of a slope the rise alone: it need only come near
            own[:, 2, 2] += self.hard * (sunk > 0.0)
        force = (stiff * over)[:, None] * unit
        np.add.at(slope, right, force)
        np.add.at(slope, left, -force)
        return value, *self._of_unknowns(slope, string, own)

    def _add_hulls(self, p: FloatArray, value: float, slope: FloatArray, own: FloatArray) -> float:
        """What has left the water lifts no more: by as much as its middle is above the surface."""
        for index, middle, half, lift in self.hulls:
            high = 0.5 * (p[index, 2] + middle) / half + 0.5
            dry = min(1.0, max(0.0, high))
            above = max(0.0, p[index, 2] + middle - half)
            value += lift * (half * dry**2 + above)
            slope[index, 2] += lift * dry
            own[index, 2, 2] += 0.5 * lift / half if 0.0 < high < 1.0 else 0.0
        return value

    def _of_unknowns(
        self, slope: FloatArray, string: FloatArray, own: FloatArray
    ) -> tuple[FloatArray, csc_matrix]:
        """Gradient and Hessian of the free places, from those of all masses: blocks of strings and
        of masses."""
        from scipy.sparse import csc_matrix

        left, right, where = self.left, self.right, self.ties.unknown
        used = where >= 0
        out = np.zeros((len(self.ties.free), 3))
        np.add.at(out, where[used], slope[used])
        every = np.arange(len(slope))
        rows = np.concatenate([left, right, left, right, every])
        columns = np.concatenate([left, right, right, left, every])
        blocks = np.concatenate([string, string, -string, -string, own])
        keep = used[rows] & used[columns]
        i, j = where[rows[keep]], where[columns[keep]]
        axes = np.arange(3)
        at = (
            (3 * i[:, None, None] + axes[:, None] + 0 * axes).ravel(),
            (3 * j[:, None, None] + 0 * axes[:, None] + axes).ravel(),
        )
        return out, csc_matrix((blocks[keep].ravel(), at), shape=(out.size, out.size))


@dataclass(frozen=True)
class _Adrift:
    """What nothing holds, in groups that move together: each is where the scene puts its bodies,
    on the average; else at the middle of what is fixed."""

    middle: FloatArray
    groups: list[NDArray[np.bool_]]
    """Of all masses, which belong to each (count,)."""
    put: list[dict[int, FloatArray]]
    """Of each, where bodies of it are put (3,) [m]."""
    given: dict[int, FloatArray]
    """Of all free bodies, where the scene puts them [m]."""


def _adrift(scene: SystemScene, masses: _Masses, ties: _Ties) -> _Adrift:
    from scipy.sparse import csc_matrix
    from scipy.sparse.csgraph import connected_components

    bodies, fixed, count = masses.bodies, ties.fixed, masses.count
    left, right, _rest = masses.strings
    middle = np.mean(list(fixed.values()), axis=0) if fixed else np.zeros(3)
    is_free = set(ties.free.tolist())
    given = {
        bodies[name]: np.array(body.position)
        for name, body in scene.bodies.items()
        if body.position is not None and bodies[name] in is_free
    }
    ones = np.ones(len(left) + count)
    tied = np.concatenate([left, np.arange(count)]), np.concatenate([right, ties.owner])
    group = connected_components(csc_matrix((ones, tied), shape=(count, count)), False)[1]
    groups = [group == k for k in set(group.tolist()) - {group[k] for k in fixed}]
    put = [
        {k: near for k, near in given.items() if members[k]}
        or {k: middle for k in bodies.values() if members[k]}
        for members in groups
    ]
    return _Adrift(middle, groups, put, given)


def first_guess(
    scene: SystemScene, velocity: FloatArray, aside: dict[str, FloatArray] | None = None
) -> Guess:
    """The first places.

    velocity: of the frame in which the start is at rest (3,) [m/s]; aside: by line, a way in which
    it is drawn (3,): slack that would hang doubled below itself opens into a bight.
    """
    masses = _masses_of(scene)
    loads = _loads(scene, masses, velocity, aside)
    ties = _ties_of(scene, masses)
    energy = _Energy(scene, masses, ties, loads)
    adrift = _adrift(scene, masses, ties)
    start = np.tile(adrift.middle, (len(ties.free), 1))
    for members, wanted in zip(adrift.groups, adrift.put, strict=True):
        if wanted:
            start[ties.unknown[members]] = np.mean(list(wanted.values()), axis=0)
    for index, near in adrift.given.items():
        start[ties.unknown[index]] = near
    rng = np.random.default_rng(0)  # no string may have length 0
    start += SHAKEN * float(energy.rest.min()) * rng.standard_normal(start.shape)
    sizes = np.linalg.norm(loads, axis=1)
    least = float(sizes[sizes > 0.0].min(initial=energy.total))
    together = [np.unique(ties.unknown[members]) for members in adrift.groups]
    for stretch in STRETCH if len(ties.free) else ():
        mean = float(energy.rest.mean())
        so_stiff = partial(energy, stretch=stretch)
        start = _lowest(so_stiff, start, energy.total, least, mean, together)
    p = ties.places(start)
    for members, wanted in zip(adrift.groups, adrift.put, strict=True):
        if wanted:
            p[members, :2] += np.mean([at - p[k] for k, at in wanted.items()], axis=0)[:2]
    return Guess(
        masses.arcs,
        {name: p[nodes] for name, nodes in masses.lines.items()},
        {name: p[index] for name, index in masses.bodies.items()},
        {name: axes_of(body.attitude) for name, body in scene.bodies.items()},
    )
