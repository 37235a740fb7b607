"""The scenes whose converged solutions are tabled: a tow, two releases from rest, a turn.

The tables are for a tolerance of zero. A run at tolerance tau must lie within tau L of them and,
in tension, within 10 tau of the largest tension; the digits of the tables come on top.
"""

import numpy as np
import pytest

import cablemodel as cm
from tests.verification import scenes
from tests.verification.references import static_cable, tables

CASES = {
    "towed": (scenes.towed, tables.TOWED),
    "released in water": (scenes.released_in_water, tables.RELEASED_IN_WATER),
    "released in air": (scenes.released_in_air, tables.RELEASED_IN_AIR),
    "turned": (scenes.turned, tables.TURNED),
}


def deviations(name, tolerance, **settings):
    """(distance of the free end [m], difference of the top tension [N]) at the table's times."""
    make, table = CASES[name]
    model = cm.CableModel(make(tolerance=tolerance, **settings))
    distance, tension = [], []
    for time, tip, top in zip(table.time, table.tip, table.tension, strict=True):
        model.step_to(time)
        distance.append(np.linalg.norm(model.tip_position - model.vessel_position - tip))
        tension.append(abs(model.top_tension - top))
    return np.array(distance), np.array(tension), table


@pytest.mark.parametrize(
    ("name", "elements", "tolerance"),
    [("towed", 60, 1e-8), ("released in water", 100, 1e-8), ("turned", 60, 1e-8)],
)
def test_converges_to_the_table(name, elements, tolerance):
    distance, tension, table = deviations(name, tolerance, elements=elements)
    assert (distance <= table.position_digits).all(), distance
    assert (tension <= table.tension_digits).all(), tension


def test_whip_converges_to_the_table():
    """Digits 1e-4 m; 1.5 s is 0.03 s after the crack of the whip, where errors are largest."""
    distance, _, table = deviations("released in air", 1e-8, elements=200)
    assert (distance <= table.position_digits).all(), distance


def test_largest_force_of_the_whip():
    """216.9 N at 1.4728 s. Axial waves of a few ms ride on it: 0.2 %, 1 ms."""
    model = cm.CableModel(scenes.released_in_air(tolerance=1e-7, elements=100))
    model.step_to(1.465)
    times, force = [], []
    while model.time < 1.48:
        model.step(1e-4)
        times.append(model.time)
        force.append(np.linalg.norm(model.top_force))
    assert max(force) == pytest.approx(tables.WHIP_FORCE, rel=2e-3)
    assert times[int(np.argmax(force))] == pytest.approx(tables.WHIP_TIME, abs=1e-3)


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4, 1e-5])
@pytest.mark.parametrize("name", ["towed", "released in water", "turned"])
def test_tolerance_means_the_error_of_a_run(name, tolerance):
    distance, tension, table = deviations(name, tolerance)
    reach = tolerance * table.length
    assert (distance <= reach + table.position_digits).all(), distance / reach
    reach = 10.0 * tolerance * table.largest_tension
    assert (tension <= reach + table.tension_digits).all(), tension / reach


def test_towed_cable_ends_steady_at_the_closed_form():
    """The angle of the tow with the stretch in its drag; what is left at 400 s is below 1e-7 m."""
    model = cm.CableModel(scenes.towed(tolerance=1e-6))
    model.step_to(400.0)
    cable = static_cable.CableProperties(
        30.0, 2.33333, static_cable.linear_strain(1e6), 0.01666, 1.0, 0.1586
    )
    shape = static_cable.steady_shape(cable, None, lambda z: np.array([-0.8, 0.0, 0.0]))
    tip = model.tip_position - model.vessel_position
    assert tip == pytest.approx(shape.end_position, abs=3e-6)
    assert model.top_tension == pytest.approx(shape.top_tension, abs=1e-5)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
def test_mesh_follows_a_tow_round_a_sharp_turn(tolerance):
    """100 m of cable towed straight at 2 m/s, then turned back on a radius of 5 m.

    It starts with 4 or 8 elements, all that a line under tension needs, and comes to bend sharply:
    with those it would be wrong by 65 and 90 tau L. Compared, as the random search compares, with
    a finer run once the turn is made; while the line begins to bend, its elements are halved a
    step late (up to 4 tau L).
    """
    runs = []
    for tau in (tolerance, 0.01 * tolerance):
        legs = [
            {"turn": {"angle": "180 deg", "radius": 5.0, "speed": 2.0}},
            {"straight": {"duration": 1000.0, "speed": 2.0}},
        ]
        model = cm.CableModel(
            scenes.scene(100.0, scenes.CABLE_K, vessel={"path": legs}, tolerance=tau)
        )
        shapes, pulls = [], []
        for time in (18.75, 25.0, 37.5, 50.0, 75.0):
            model.step_to(time)
            shapes.append(model.sample(np.linspace(0.0, 100.0, 17)).position)
            pulls.append(model.top_tension)
        runs.append((np.array(shapes), np.array(pulls)))
    (shapes, pulls), (finer, exact) = runs
    assert np.linalg.norm(shapes - finer, axis=2).max() <= 1.25 * tolerance * 100.0
    assert np.abs(pulls - exact).max() <= 10.0 * tolerance * exact.max()
