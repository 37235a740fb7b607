"""The series of a sea in cells of space and time, against the sum over its components."""

import math

import numba
import numpy as np
import pytest

import cablemodel as cm
from cablemodel.scene.sea import sea
from cablemodel.solvers.finite_element.kernels.line.system import set_time
from cablemodel.solvers.finite_element.kernels.water.waves import water_at, wave_at
from cablemodel.solvers.finite_element.start import waves
from cablemodel.solvers.shared.compile import OPTIONS

CABLE = {"diameter": 0.03, "mass": 1.5, "axial_stiffness": 1e6, "bending_stiffness": 5.0}
ALL = -1
"""In place of a slot: the sum over the components."""


def scene(tolerance=1e-3, depth=35.0, tp=8.0, **jonswap):
    environment = {"waves": {"jonswap": {"hs": 0.5, "tp": tp, "seed": 3, **jonswap}}}
    if depth is not None:
        environment["floor"] = {"z": -depth}
    return cm.load_scene(
        {
            "environment": environment,
            "cable_types": {"C": CABLE},
            "line": [{"cable": {"type": "C", "length": 0.9 * (depth or 40.0)}}],
            "solver": {"tolerance": tolerance},
        }
    )


@numba.jit(**OPTIONS)
def water(ints, reals, t, x, y, z, reach, slot, velocity, acceleration):
    set_time(ints, reals, t)
    found = water_at()
    depth = wave_at(ints, reals, x, y, z, reach, slot, found)
    for i in range(3):
        velocity[i] = found.velocity[i]
        acceleration[i] = found.acceleration[i]
    return z + depth


def motion(model, place, slot, reach=1e3):
    """Velocity, acceleration and height of the surface at a place of (t, x, y, z)."""
    velocity, acceleration = np.zeros((2, 3))
    surface = water(model._ints, model._reals, *place, reach, slot, velocity, acceleration)
    return velocity, acceleration, surface


def rms(values):
    return float(np.sqrt(np.mean(np.square(values))))


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-5])
@pytest.mark.parametrize(("depth", "tp"), [(5.0, 8.0), (35.0, 8.0), (None, 14.0), (None, 3.0)])
def test_the_series_is_the_sum_within_what_is_allowed(tolerance, depth, tp):
    """Anywhere in the water and at any time, and at the corners of cells."""
    given = scene(tolerance, depth, tp)
    field = sea(given)
    model = cm.CableModel(given, planar=False)
    allowed = min(waves.CELL_ERROR[0] * tolerance, waves.CELL_ERROR[1])
    mirror = np.exp(-2.0 * field.number * field.depth)
    speed = field.amplitude * field.frequency / (1.0 - mirror)
    scale = math.sqrt(0.5 * np.sum((speed * field.frequency) ** 2))
    layers = waves.layers(field, tolerance)
    rng = np.random.default_rng(4)
    deepest = min(field.depth, 80.0)
    for at_corner in (False, True):
        errors = []
        for k in range(400):
            place = rng.uniform([9, -900, -900, -deepest], [2000, 900, 900, 0])
            if at_corner:  # a hair inside
                place[2] = 0.0
                cell = next(one for one in reversed(layers) if one.depth <= -place[3])
                place[[0, 1, 3]] = np.round(place[[0, 1, 3]] / [cell.time, cell.width, cell.width])
                place[[0, 1]] += 0.4999
                place[3] -= 0.4999
                place[[0, 1, 3]] *= [cell.time, cell.width, cell.width]
                if place[3] < -deepest:
                    continue
            for mine, exact in zip(
                motion(model, place, k % 9), motion(model, place, ALL), strict=True
            ):
                errors.append(np.linalg.norm(mine - exact))
        velocity, acceleration, surface = np.reshape(errors, (-1, 3)).T
        # Allowed at a corner, for a mean over places and over phases.
        share = 1.0 if at_corner else 0.25
        assert rms(acceleration) < share * allowed * scale
        assert rms(velocity) < 0.4 * share * allowed * rms(speed) * math.sqrt(len(speed))
        assert rms(surface) < 0.4 * share * allowed * math.sqrt(0.5 * np.sum(field.amplitude**2))
        if at_corner:
            assert rms(acceleration) > 1e-3 * allowed * scale, "cells are far too small"


def test_what_was_asked_before_changes_no_bit():
    """Slots that hold other cells, the same without its surface, or nothing."""
    model = cm.CableModel(scene(), planar=False)
    rng = np.random.default_rng(5)
    places = rng.uniform([9, -2, -2, -30], [11, 2, 2, 1], (60, 4))
    fresh = cm.CableModel(scene(), planar=False)
    expected = [motion(fresh, place, slot) for slot, place in enumerate(places)]
    for _ in range(3):
        for n in rng.permutation(len(places)):
            motion(model, places[n], n % 4, reach=rng.choice([0.0, 1e3]))
            got = motion(model, places[n], n % 4)
            assert all(np.array_equal(a, b) for a, b in zip(got, expected[n], strict=True))


def test_calm_and_dead_water():
    """Before the waves come up, and below all of them."""
    model = cm.CableModel(scene(depth=None), planar=False)
    for place in ([-1.0, 3.0, 4.0, -2.0], [50.0, 3.0, 4.0, -5000.0]):
        velocity, acceleration, _ = motion(model, place, 0, reach=0.0)
        assert not velocity.any()
        assert not acceleration.any()


def test_few_components_have_no_cells(monkeypatch):
    given = scene(components=waves.SEA_FEWEST - 1)
    model = cm.CableModel(given, planar=False)
    assert model._header.cell_terms == 0
    place = [30.0, 3.0, 4.0, -2.0]
    for mine, exact in zip(motion(model, place, 0), motion(model, place, ALL), strict=True):
        assert np.array_equal(mine, exact)
    assert cm.CableModel(scene(components=waves.SEA_FEWEST))._header.cell_terms > 0


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5])
def test_a_run_is_the_one_with_the_sum(tolerance, monkeypatch):
    """A line from above the surface to the bottom's waves, with bodies of both kinds on it."""
    data = {
        "environment": {
            "waves": {"jonswap": {"hs": 1.5, "tp": 7, "seed": 1}},
            "floor": {"z": -30},
        },
        "cable_types": {"C": CABLE},
        "line": [
            {"cable": {"type": "C", "length": 12}},
            {"body": {"mass": 20, "submerged_weight": 60, "drag_area": 0.1}},
            {"cable": {"type": "C", "length": 10}},
            {"body": {"mass": 30, "submerged_weight": 90, "drag_area": 0.1, "half_length": 0.4}},
        ],
        "vessel": {"position": [0, 0, 2], "velocity": [0.4, 0.2, 0]},
        "solver": {"tolerance": tolerance},
    }

    def run():
        model = cm.CableModel(cm.load_scene(data))
        shapes, pulls = [], []
        while model.time < 19.95:
            model.step(0.1)
            shapes.append(model.sample(np.linspace(0.0, model.line_length, 12)).position)
            pulls.append(model.top_tension)
        return np.array(shapes), np.array(pulls), model.statistics

    shapes, pulls, statistics = run()
    monkeypatch.setattr(waves, "SEA_FEWEST", 10**6)
    exact_shapes, exact_pulls, exact_statistics = run()
    assert np.linalg.norm(shapes - exact_shapes, axis=2).max() < 0.05 * tolerance * 22.0
    assert rms(pulls - exact_pulls) < 0.1 * 10.0 * tolerance * exact_pulls.max()
    assert statistics["steps"] <= 1.05 * exact_statistics["steps"]


def test_a_restored_state_goes_on_bit_by_bit():
    """The cells are no part of a snapshot, and whose they are makes no difference."""
    model, other = cm.CableModel(scene()), cm.CableModel(scene())
    model.step_to(11.0)
    kept = model.snapshot()
    other.step_to(17.0)
    other.restore(kept)
    for one in (model, other):
        one.step_to(14.0)
    assert np.array_equal(model.state().position, other.state().position)
    assert model.top_tension == other.top_tension
