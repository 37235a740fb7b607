"""Other first places of a system with clamps: a body turns sooner than a line bends back."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.shared.numbers import NO_SIZE
from cablemodel.systems.guess import Guess, held_place, standing
from cablemodel.systems.lines import bends_at
from cablemodel.systems.motion import axes_of, first_angles
from cablemodel.systems.scene import SystemScene

FloatArray = NDArray[np.float64]

GIVEN = 1e-3
"""What the scene's attitude of a body weighs beside the direction of a line that is clamped to it:
it decides what those leave open."""


def turned_along_clamps(scene: SystemScene, guess: Guess) -> Guess | None:
    """Bodies turned by the least angles with which the lines that are clamped to them fit best,
    about the middle of the places where they are; None: no line is."""
    stands = standing(scene)
    fits: dict[str, list[tuple[FloatArray, FloatArray]]] = {}
    places: dict[str, list[FloatArray]] = {}
    for line_name, line in scene.lines.items():
        points = guess.lines[line_name]
        for end, way in ((line.start, points[1] - points[0]), (line.end, points[-1] - points[-2])):
            owner, point = end.owner, end.of_owner
            if bends_at(scene, line, end) and owner in scene.bodies and owner not in stands:
                along = way / max(float(np.linalg.norm(way)), NO_SIZE)
                fits.setdefault(owner, []).append((np.array(end.clamped), along))
                places.setdefault(owner, []).append(np.array(scene.bodies[owner].points[point]))
    if not fits:
        return None
    bodies, turned = dict(guess.bodies), dict(guess.axes)
    for name, pairs in fits.items():
        turned[name] = turned_to(guess.axes[name], pairs)
        middle = np.mean(places[name], axis=0)
        bodies[name] = bodies[name] + (guess.axes[name] - turned[name]) @ middle
    return replace(guess, bodies=bodies, axes=turned)


def turned_to(axes: FloatArray, pairs: list[tuple[FloatArray, FloatArray]]) -> FloatArray:
    """Axes (3, 3) turned by the least angle with which directions in them (3,) come as near as may
    be to directions in the earth's (G. Wahba, SIAM Review 7 (1965) 409)."""
    fit = GIVEN * axes + sum(np.outer(along, own) for own, along in pairs)
    left, _sizes, right = np.linalg.svd(fit)
    sign = np.linalg.det(left) * np.linalg.det(right)
    return np.asarray(left @ np.diag([1.0, 1.0, sign]) @ right)


def straight_from_clamps(scene: SystemScene, guess: Guess) -> Guess | None:
    """Lines straight out of what clamps them, from vessels on, with bodies at their ends and what
    is clamped to those: beams, where a hanging string is far from what they are like; None: a
    vessel clamps no line that goes to a body."""
    lines, bodies, axes = dict(guess.lines), dict(guess.bodies), dict(guess.axes)
    stands = standing(scene)
    todo = [
        (name, side)
        for name, line in scene.lines.items()
        for side, end in enumerate(line.ends)
        if bends_at(scene, line, end) and held_place(scene, end) is not None
    ]
    laid: set[str] = set()
    moved: set[str] = set()
    for name, side in todo:  # which becomes longer
        line = scene.lines[name]
        end, other = line.ends[side], line.ends[1 - side]
        owner, body = end.owner, other.owner
        if name in laid or body not in scene.bodies or body in moved | stands.keys():
            continue
        vessel = scene.vessels.get(owner)
        frame = axes[owner] if vessel is None else axes_of(first_angles(vessel))
        place = held_place(scene, end)
        if place is None:
            place = bodies[owner] + frame @ np.array(scene.bodies[owner].points[end.of_owner])
        along = frame @ np.array(end.clamped)
        from_here = guess.arcs[name] - (line.length if side else 0.0)
        lines[name] = place + from_here[:, None] * along
        laid.add(name)
        moved.add(body)
        if bends_at(scene, line, other):
            axes[body] = turned_to(axes[body], [(np.array(other.clamped), along)])
        there = lines[name][0 if side else -1]
        bodies[body] = there - axes[body] @ np.array(scene.bodies[body].points[other.of_owner])
        todo += [
            (more, k)
            for more, its in scene.lines.items()
            for k, one in enumerate(its.ends)
            if bends_at(scene, its, one) and one.owner == body
        ]
    if not moved:
        return None
    for name, line in scene.lines.items():  # the others go along with their ends
        for side, end in enumerate(line.ends):
            body = end.owner
            if name not in laid and body in moved:
                place = bodies[body] + axes[body] @ np.array(
                    scene.bodies[body].points[end.of_owner]
                )
                share = np.abs(guess.arcs[name] / line.length - (1.0 - side))
                off = place - lines[name][-1 if side else 0]
                lines[name] = lines[name] + share[:, None] * off
    return replace(guess, lines=lines, bodies=bodies, axes=axes)
