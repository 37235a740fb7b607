"""The 1998 method against closed forms, the converged tables, and its own theory."""

import itertools
import math

import numpy as np
import pytest

import cablemodel as cm
from tests.verification import direct_scenes as scenes
from tests.verification.references import tables

MODELS = ("elastica", "hybrid", "cable")


def tip(model):
    return model.tip_position - model.vessel_position


@pytest.mark.parametrize("model", MODELS)
def test_example_2_of_the_paper(model):
    """70 N at rest and the analytic 36 degrees and 94.6 N, at the paper's 1 s and 1 m.

    The steady state is straight: what is left of the closed form is what is left of the tow's
    start at 200 s, 5e-4 N and 1e-3 degrees in the tables.
    """
    run = cm.CableModel(scenes.towed(model))
    assert run.top_tension == pytest.approx(70.0, abs=1e-3)
    run.step_to(200.0)
    along = tip(run)
    assert math.degrees(math.atan2(-along[2], -along[0])) == pytest.approx(36.0, abs=0.01)
    assert run.top_tension == pytest.approx(94.606, abs=0.01)
    # The paper: three to five iterations a step, at its own tolerance.
    assert 1 <= run.statistics["iterations"] / run.statistics["steps"] <= 5


def run_to(scene, times):
    run = cm.CableModel(scene)
    found = []
    for time in times:
        run.step_to(time)
        found.append([*tip(run), run.top_tension])
    return np.array(found)


def orders(values):
    """Observed orders from runs with halved steps."""
    changes = [np.linalg.norm((b - a)[:, :3]) for a, b in itertools.pairwise(values)]
    return np.log2(np.array(changes[:-1]) / np.array(changes[1:]))


@pytest.mark.parametrize(("alpha", "order"), [(1.0, 1.0), (0.5, 2.0)])
def test_order_in_time_is_that_of_eq_38(alpha, order):
    """Backward Euler and the trapezoidal rule on S1."""
    values = [
        run_to(
            scenes.towed("cable", alpha=alpha, time_step=dt, relative_tolerance=1e-9), (20.0, 50.0)
        )
        for dt in (0.5, 0.25, 0.125, 0.0625)
    ]
    assert orders(values)[-1] == pytest.approx(order, abs=0.15)


@pytest.mark.parametrize("model", ["cable", "elastica"])
def test_order_in_space_is_two(model):
    """The midpoint rule on S4, in three dimensions; time steps the same in all runs."""
    values = [
        run_to(
            scenes.turned(model, node_spacing=ds, time_step=1.0, relative_tolerance=1e-9),
            (20.0, 39.0),
        )
        for ds in (2.0, 1.0, 0.5, 0.25)
    ]
    assert orders(values)[-1] == pytest.approx(2.0, abs=0.2)


REFINED = {
    "towed": (scenes.towed, tables.TOWED, 0.55, 0.1, 0.25),
    "turned": (scenes.turned, tables.TURNED, 0.5, 0.125, 0.25),
}


@pytest.mark.parametrize("name", REFINED)
def test_agrees_with_the_tables_that_the_finite_elements_meet(name):
    """1e-4 of the length in the tip, of the largest tension at the top."""
    make, table, alpha, dt, ds = REFINED[name]
    settings = {"alpha": alpha, "time_step": dt, "node_spacing": ds, "relative_tolerance": 1e-6}
    found = run_to(make("elastica", **settings), table.time)
    distance = np.linalg.norm(found[:, :3] - table.tip, axis=1)
    assert (distance <= 1e-4 * table.length).all(), distance / table.length
    difference = np.abs(found[:, 3] - table.tension)
    assert (difference <= 1e-4 * table.largest_tension + table.tension_digits).all(), difference


def test_release_from_zero_tension_agrees_with_the_table():
    """S2w: backward Euler damps the axial waves that the trapezoidal rule keeps for ever; its
    first-order error is taken out by extrapolation from two time steps."""
    table = tables.RELEASED_IN_WATER
    coarse, fine = (
        run_to(
            scenes.released(time_step=dt, node_spacing=0.05, relative_tolerance=1e-6), table.time
        )
        for dt in (0.02, 0.01)
    )
    found = 2.0 * fine - coarse
    distance = np.linalg.norm(found[:, :3] - table.tip, axis=1)
    assert (distance <= 1e-4 * table.length).all(), distance / table.length
    difference = np.abs(found[:, 3] - table.tension)
    assert (difference <= 1e-4 * table.largest_tension + table.tension_digits).all(), difference


@pytest.mark.parametrize("make", [scenes.towed, scenes.turned])
def test_joints_of_the_hybrid_differ_little(make):
    """`paper` leaves the moment EI k unbalanced at C: 2e-3 of the length at most, and not zero."""
    paper, free = (
        run_to(make("hybrid", joint=joint, relative_tolerance=1e-8), (20.0, 40.0))
        for joint in ("paper", "moment_free")
    )
    change = np.abs(paper[:, :3] - free[:, :3]).max() / 30.0
    assert 1e-12 < change < 2e-3


def test_line_that_lies_along_the_axis_of_the_angles_is_the_line_that_does_not():
    """A tow that turns through the singular angle: the axes are turned on the way. The same tow,
    seen from axes at 45 degrees, gives the reference."""
    light = {**scenes.CABLE_K, "submerged_weight": 0.05}
    results = []
    for heading in ("0 deg", "45 deg"):
        path = [
            {"straight": {"duration": 1.0, "speed": 0.8, "heading": heading}},
            {"turn": {"angle": "150 deg", "radius": 10.0, "speed": 0.8}},
            {"straight": {"duration": 100.0, "speed": 0.8}},
        ]
        scene = scenes.direct(
            [scenes.cable(20.0)],
            vessel={"path": path},
            types={"K": light},
            relative_tolerance=1e-8,
            time_step=0.25,
        )
        run = cm.CableModel(scene)
        run.step_to(60.0)
        x, y, z = tip(run)
        turn = math.radians(float(heading.split()[0]))
        results.append(
            [
                x * math.cos(turn) + y * math.sin(turn),
                y * math.cos(turn) - x * math.sin(turn),
                z,
                run.top_tension,
            ]
        )
    assert results[0] == pytest.approx(results[1], rel=1e-6)


def test_payout_pendulum():
    """A heavy bob in vacuum, paid out at 0.5 m/s: the closed form in Bessel functions; trapezoidal
    steps of 0.02 s leave 1e-3."""
    angle, weight = 1e-3, 1000.0 * 9.80665
    stretched = 10.0 * (1.0 + weight / 1e9)
    cord = {
        "diameter": 0.01,
        "mass": 1e-4,
        "submerged_weight": 0.0,
        "axial_stiffness": 1e9,
        "drag_normal": 0.0,
        "drag_tangential": 0.0,
    }
    end = [stretched * math.sin(angle), 0.0, -stretched * math.cos(angle)]
    for rate, expected in ((0.5, -0.0640678512), (-0.4, 0.6125181420)):
        scene = scenes.direct(
            [scenes.cable(10.0, "cable"), {"body": {"mass": 1000.0, "submerged_weight": weight}}],
            initial={"points": [[0, 0, 0], end]},
            environment={"water_density": 0.0},
            payout={"rate": [{"t": 0, "rate": rate}], "drum": [scenes.cable(20.0, "cable")]},
            types={"K": cord},
            alpha=0.5,
            time_step=0.02,
            relative_tolerance=1e-10,
        )
        run = cm.CableModel(scene)
        run.step_to(5.0)
        length = 10.0 + 5.0 * rate
        assert run.line_length == pytest.approx(length, abs=1e-9)
        assert tip(run)[0] / length / angle == pytest.approx(expected, abs=1e-3)


def test_rigid_body_is_a_very_stiff_cable():
    """Eqs. 28 to 31 against an elastica of the same mass that hardly bends, swung in vacuum.

    The elastica stretches: 2 m under 80 N at 1e6 N are 1.6e-4 m.
    """
    types = {
        "K": {**scenes.CABLE_K, "submerged_weight": scenes.CABLE_K["mass"] * 9.80665},
        "S": {
            **scenes.CABLE_K,
            "bending_stiffness": 1e5,
            "mass": 3.0,
            "submerged_weight": 3.0 * 9.80665,
        },
    }
    vessel = {
        "velocity": [
            {"t": 0, "velocity": [0, 0, 0]},
            {"t": 2, "velocity": [2.0, 0, 0]},
            {"t": 4, "velocity": [0, 0, 0]},
            {"t": 6, "velocity": [0, 1.0, 0]},
        ]
    }
    weight = 6.0 * 9.80665
    rod = {"body": {"mass": 6.0, "submerged_weight": weight, "half_length": 1.0}}
    rod["body"]["rotary_inertia"] = 6.0 * 2.0**2 / 12.0
    bob = {"body": {"mass": 2.0, "submerged_weight": 2.0 * 9.80665}}
    found = []
    for middle in (rod, scenes.cable(2.0, "elastica", "S")):
        scene = scenes.direct(
            [scenes.cable(5.0, "cable"), middle, scenes.cable(3.0, "cable"), bob],
            vessel=vessel,
            environment={"water_density": 0.0},
            types=types,
            alpha=0.55,
            time_step=0.05,
            node_spacing=0.25,
            relative_tolerance=1e-7,
        )
        found.append(run_to(scene, (3.0, 5.0, 8.0)))
    assert found[0][:, :3] == pytest.approx(found[1][:, :3], abs=4e-4)
    assert found[0][:, 3] == pytest.approx(found[1][:, 3], rel=2e-4)
