"""Cycles of free bodies and lines: closures, against closed forms."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from cablemodel.systems import SystemModel

G = 9.81
STRING = {"diameter": 0.002, "mass": 0.002, "axial_stiffness": 2e6, "submerged_weight": 0.002 * G}
UPPER, LOWER = (20.0, 3.0), (12.0, 1.5)
"""Mass [kg] and moment of inertia about the vertical [kg m2] of two bars."""
HALF, HEIGHTS = 0.6, (5.0, 3.0)
"""Half distance of the strings, and their lengths [m]."""


def string(length: float, **more: Any) -> list[dict[str, Any]]:
    return [{"cable": {"type": "string", "length": length, "model": "cable", **more}}]


def bar(mass: float, inertia: float, **more: Any) -> dict[str, Any]:
    return {
        "mass": mass, "submerged_weight": mass * G, "inertia": [0.5 * inertia, inertia, inertia],
        "points": {"a": [HALF, 0, 0], "b": [-HALF, 0, 0]}, **more,
    }  # fmt: skip


def two_bars(**more: Any) -> dict[str, Any]:
    """A bar on two strings, and another bar on two strings below it: bars and strings between
    them are a cycle."""
    sides = (("a", HALF), ("b", -HALF))
    lines: dict[str, Any] = {
        f"upper_{side}": {
            "from": {"anchor": [x, 0, 0]}, "to": f"one.{side}", "items": string(HEIGHTS[0])
        }
        for side, x in sides
    }  # fmt: skip
    for side, _x in sides:
        lines[f"lower_{side}"] = {
            "from": f"one.{side}", "to": f"two.{side}", "items": string(HEIGHTS[1])
        }  # fmt: skip
    return {
        "environment": {"water_density": 0.0, "gravity": G},
        "cable_types": {"string": STRING},
        "bodies": {"one": bar(*UPPER), "two": bar(*LOWER, **more)},
        "lines": lines,
        "solver": {"tolerance": 1e-4},
    }


def test_strings_between_two_bars_share_the_weight_by_its_lever() -> None:
    away = 0.2
    model = SystemModel(two_bars(centre_of_gravity=[away, 0, -0.5]))
    model.step(1.0)
    near, far = (model.lines[f"lower_{side}"].end_tension for side in "ab")
    weight = LOWER[0] * G
    assert near + far == pytest.approx(weight, rel=1e-3)
    assert near / weight == pytest.approx(0.5 * (1.0 + away / HALF), abs=5e-3)
    assert model.lines["upper_a"].end_tension == pytest.approx(
        0.5 * UPPER[0] * G + near + STRING["mass"] * HEIGHTS[1] * G, rel=5e-3
    )


def test_two_bars_turn_as_two_bifilar_pendulums_that_are_coupled() -> None:
    """I1 y1'' = -k1 y1 - k2 (y1 - y2), I2 y2'' = -k2 (y2 - y1), k = weight below a^2 / h."""
    model = SystemModel(two_bars())
    stiff = (
        (UPPER[0] + LOWER[0]) * G * HALF**2 / HEIGHTS[0],
        LOWER[0] * G * HALF**2 / HEIGHTS[1],
    )
    matrix = np.array([[stiff[0] + stiff[1], -stiff[1]], [-stiff[1], stiff[1]]])
    inertia = np.array([UPPER[1], LOWER[1]])
    squares, shapes = np.linalg.eig(matrix / inertia[:, None])
    model.step(0.5, forces={"two": [0, 0, 0, 0, 0, 0.3]})
    model.step(0.5)
    times, yaws = [], []
    for _ in range(600):
        model.step(0.02)
        times.append(model.time)
        yaws.append([model.bodies[name].attitude[2] for name in ("one", "two")])
    assert 1e-3 < np.abs(yaws).max() < 0.1
    modes = np.linalg.solve(shapes, np.array(yaws).T)  # each swings by itself
    for square, mode in zip(squares, modes, strict=True):
        basis = np.column_stack([f(math.sqrt(square) * np.array(times)) for f in (np.cos, np.sin)])
        _amplitude, rest, _rank, _values = np.linalg.lstsq(basis, mode, rcond=None)
        assert math.sqrt(rest[0] / len(times)) < 0.02 * np.abs(mode).max()


def test_a_ladder_of_lines_hangs_evenly() -> None:
    """Two lines with a rung between them, which ends on a line that is there before."""
    scene = two_bars()
    del scene["bodies"]["two"], scene["lines"]["lower_a"], scene["lines"]["lower_b"]
    scene["lines"]["rung"] = {
        "from": {"line": "upper_a", "at": 2.5}, "to": {"line": "upper_b", "at": 2.5},
        "items": string(1.0),
    }  # fmt: skip
    model = SystemModel(scene)
    model.step(1.0)
    pull = [model.lines[f"upper_{side}"].end_tension for side in "ab"]
    assert pull[0] == pytest.approx(pull[1], rel=1e-4)
    ends = [model.lines[f"upper_{side}"].sample([2.5]).position[0] for side in "ab"]
    rung = model.lines["rung"].sample([0.0, 1.0]).position
    assert rung == pytest.approx(np.array(ends), abs=1e-6)
    # The rung is shorter than the bar: it draws both lines inwards by a triangle of forces.
    side = model.lines["rung"].start_tension
    gap = 0.5 * (2.0 * HALF - np.linalg.norm(rung[1] - rung[0]))
    upper, lower = (
        np.mean([model.lines[f"upper_{s}"].sample([x]).tension[0] for s in "ab"])
        for x in (1.0, 4.0)
    )
    expected = gap / 2.5 * (upper + lower)
    assert side == pytest.approx(expected, rel=2e-2)


def test_a_free_ring_of_two_bodies_keeps_its_momentum() -> None:
    """Two bars with two strings between them, which turn and swing, are let go: they fall with
    their common weight, and their angular momentum about their centre stays."""
    scene = two_bars()
    scene["cuts"] = {
        f"{side}_off": {"line": f"upper_{side}", "at": "end", "time": 1.0} for side in "ab"
    }
    model = SystemModel(scene)
    model.step(1.0, forces={"two": [10.0, 0, 0, 0, 0, 2.0]})
    masses = [UPPER[0], LOWER[0]]
    found = []
    for _ in range(40):
        model.step(0.05)
        motions = [model.bodies[name] for name in ("one", "two")]
        centre = np.average([m.position for m in motions], axis=0, weights=masses)
        speed = np.average([m.velocity for m in motions], axis=0, weights=masses)
        turning = np.zeros(3)
        for m, mass, name in zip(motions, masses, ("one", "two"), strict=True):
            own = m.axes @ np.diag(scene["bodies"][name]["inertia"]) @ m.axes.T
            turning += mass * np.cross(m.position - centre, m.velocity - speed)
            turning += own @ m.angular_velocity
        found.append([*speed, *turning])
    rows = np.array(found)
    assert np.diff(rows[:, 2]) == pytest.approx(-G * 0.05, rel=2e-3)
    assert np.abs(rows[:, :2] - rows[0, :2]).max() < 2e-3 * np.linalg.norm(rows[0, :2])
    size = np.linalg.norm(rows[0, 3:])
    assert size > 1.0
    assert np.abs(rows[:, 3:] - rows[0, 3:]).max() < 5e-3 * size  # strings have some of it


def test_a_line_that_closes_a_cycle_can_be_let_go() -> None:
    scene = two_bars()
    scene["cuts"] = {
        f"{side}_off": {"line": f"lower_{side}", "at": "end", "time": 0.5} for side in "ab"
    }
    model = SystemModel(scene)
    height = model.bodies["two"].position[2]
    model.step(0.5)
    model.step(0.5)
    assert model.bodies["two"].position[2] == pytest.approx(height - 0.5 * G * 0.25, abs=0.02)
    assert model.bodies["one"].position[2] == pytest.approx(-HEIGHTS[0], abs=0.01)
