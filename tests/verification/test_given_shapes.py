"""Starts from points on the cable: what they stretch it by, and what they do not."""

import math
from typing import Any

import numpy as np
import pytest

import cablemodel as cm

WEIGHT, STIFFNESS = 6.8, 2e7  # N/m, N


def scene(points: Any, length: float, tolerance: float = 1e-3, **more: Any) -> dict[str, Any]:
    return {
        "environment": {"water_density": 1025.0},
        "cable_types": {
            "K": {
                "diameter": 0.02, "mass": 1.0, "submerged_weight": WEIGHT,
                "axial_stiffness": STIFFNESS, "drag_normal": 1.2, "drag_tangential": 0.01,
            }
        },
        "line": [{"cable": {"type": "K", "length": length}}],
        "vessel": {"position": [float(x) for x in points[0]]},
        "initial": {"points": np.asarray(points, dtype=float).tolist()},
        "solver": {"tolerance": tolerance},
        "run": {"duration": 10.0, "output_interval": 0.5},
        **more,
    }  # fmt: skip


def model_of(*given: Any, **more: Any) -> cm.CableModel:
    return cm.CableModel(cm.load_scene(scene(*given, **more)))


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
def test_a_shape_with_corners_is_not_torn_apart(tolerance: float) -> None:
    """Two corners in a line that falls from rest: its tensions are parts of its weight."""
    points = [[0, 0, 0], [0, 0, -80], [60, 0, -80], [60, 60, -80]]
    model = model_of(points, 200.0, tolerance)
    weight = 200.0 * WEIGHT
    assert max(model.tension_max, -model.tension_min) < 0.05 * weight
    for time in np.arange(1, 21) * 0.05:
        model.step_to(float(time))
        assert max(model.tension_max, -model.tension_min) < 1.5 * weight


def catenary(parts: int) -> tuple[np.ndarray, float, float]:
    """Points on one between two ends at one height, its length [m] and largest tension [N]."""
    radius, half = 100.0, 80.0
    x = np.linspace(-half, half, parts + 1)
    z = radius * (np.cosh(x / radius) - math.cosh(half / radius))
    points = np.column_stack([x, np.zeros_like(x), z])
    return points, 2.0 * radius * math.sinh(half / radius), WEIGHT * radius * math.cosh(0.8)


@pytest.mark.parametrize("parts", [12, 100])
@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
def test_a_catenary_that_is_given_by_points_stays_as_it_is(parts: int, tolerance: float) -> None:
    points, length, top = catenary(parts)
    end = {"anchor": points[-1].tolist()}
    model = model_of(points, length, tolerance, end=end)
    # Of a curve a cubic leaves some, which its stabilisation holds.
    assert max(model.tension_max, -model.tension_min) < 3e-2 * top
    places = np.linspace(0.0, length, 9)
    start = model.sample(places).position
    pulls = []
    for time in np.arange(1, 41) * 0.05:
        model.step_to(float(time))
        pulls.append(model.top_tension)
    assert np.mean(pulls[20:]) == pytest.approx(top, rel=0.02)
    # Points that are far apart are on it, the curve between them is not quite.
    moved = np.linalg.norm(model.sample(places).position - start, axis=1).max()
    assert moved < (0.3 if parts == 12 else tolerance * length)


@pytest.mark.parametrize("longer", [0.0, 0.01])
def test_a_curve_that_is_longer_stretches_all_of_the_cable_alike(longer: float) -> None:
    """A half circle, by its chords: what fits between chords and arcs is not stretched."""
    angle = np.linspace(0.0, math.pi, 9)
    points = 50.0 * np.column_stack([1.0 - np.cos(angle), np.zeros(9), -np.sin(angle)])
    chords = 8.0 * 100.0 * math.sin(math.pi / 16.0)
    length = chords / (1.0 + longer) if longer else 50.0 * math.pi
    model = model_of(points, length, 1e-4, end={"anchor": points[-1].tolist()})
    pull = STIFFNESS * longer
    assert model.tension_min == pytest.approx(pull, rel=0.01, abs=1e-6 * STIFFNESS)
    assert model.tension_max == pytest.approx(pull, rel=0.01, abs=1e-6 * STIFFNESS)


def test_velocities_are_those_of_the_points() -> None:
    """A line in a plane turns out of it about its tow point, given by unequal pieces."""
    depth = -80.0 * np.linspace(0.0, 1.0, 25) ** 2
    points = np.column_stack([1e-3 * depth**2, np.zeros(25), depth])
    turn = np.array([0.0, 0.0, 0.2])
    given = np.cross(turn, points)
    length = float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum())
    initial = {"points": points.tolist(), "velocities": given.tolist()}
    model = model_of(points, length, initial=initial)
    found = model.sample(np.linspace(0.0, length, 21))
    assert found.velocity == pytest.approx(np.cross(turn, found.position), abs=1e-3)
