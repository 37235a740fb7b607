"""Cable asleep on the sea floor: what it gains, what wakes it, and that nobody sees it sleep."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cablemodel as cm

SCENES = Path(__file__).parents[2] / "scenes"
KNOT = 1852.0 / 3600.0
CABLE = {
    "diameter": 0.02,
    "mass": 0.8,
    "submerged_weight": 5.0,
    "axial_stiffness": 1e6,
    "bending_stiffness": 1.0,
    "drag_normal": 1.2,
    "drag_tangential": 0.01,
    "added_mass": 1.0,
}
LENGTH = 95.0
TOLERANCE = 1e-3
INTERVAL = 0.1
PROBES = np.array([0.25, 0.5, 0.75, 1.0])


def laid(
    velocity: list[tuple[float, tuple[float, float, float]]],
    rate: list[tuple[float, float]],
    current: list[tuple[float, tuple[float, float, float]]] | None = None,
) -> cm.Scene:
    """A lay in 100 m of water, with friction: what vessel, winch and current do over time."""
    environment: dict[str, Any] = {"floor": {"z": -100.0, "friction": 0.5}}
    if current is not None:
        rows = [{"t": t, "z": 0.0, "velocity": list(v)} for t, v in current]
        environment["current"] = {"table": rows}
    return cm.load_scene(
        {
            "environment": environment,
            "cable_types": {"C": CABLE},
            "line": [{"cable": {"type": "C", "length": LENGTH}}],
            "vessel": {"velocity": [{"t": t, "velocity": list(v)} for t, v in velocity]},
            "payout": {
                "rate": [{"t": t, "rate": r} for t, r in rate],
                "drum": [{"cable": {"type": "C", "length": 600.0}}],
            },
            "solver": {"tolerance": TOLERANCE},
        }
    )


def run(scene: cm.Scene, until: float, *, sleep: bool | None) -> tuple[np.ndarray, np.ndarray]:
    """Positions of probes along the line (n, 4, 3) [m], and elements asleep (n,)."""
    model = cm.CableModel(scene, sleep=sleep)
    places, asleep = [], []
    while model.time < until - 1e-9:
        model.step(INTERVAL)
        places.append(model.sample(PROBES * model.line_length).position)
        asleep.append(model.statistics["asleep"])
    return np.array(places), np.array(asleep)


def lay(model: cm.CableModel, until: float) -> None:
    """Step to a time as a controller does."""
    while model.time < until - 1e-9:
        model.step(INTERVAL)


LAYING = [(0.0, (0.5, 0.0, 0.0))]
MOVES = {
    # name: vessel, pay-out, current, end [s], time from which all is awake [s]
    "picked up": (
        [(0.0, (0.5, 0.0, 0.0)), (350.0, (0.5, 0.0, 0.0)), (370.0, (-0.5, 0.0, 0.0))],
        [(0.0, 0.5), (350.0, 0.5), (370.0, -0.5)],
        None,
        530.0,
        500.0,
    ),
    "pulled sideways": (
        [(0.0, (0.5, 0.0, 0.0)), (350.0, (0.5, 0.0, 0.0)), (360.0, (0.0, 0.5, 0.0))],
        [(0.0, 0.5), (350.0, 0.5), (360.0, 0.0)],
        None,
        450.0,
        430.0,
    ),
    "swept by a current": (
        LAYING,
        [(0.0, 0.5)],
        [(0.0, (0.0, 0.0, 0.0)), (350.0, (0.0, 0.0, 0.0)), (370.0, (0.0, 0.8, 0.0))],
        430.0,
        375.0,
    ),
}


@pytest.mark.parametrize("name", MOVES)
def test_cable_asleep_wakes_and_moves_as_if_it_had_not_slept(name: str) -> None:
    velocity, rate, current, until, awake = MOVES[name]
    scene = laid(velocity, rate, current)
    slept, asleep = run(scene, until, sleep=None)
    watched, none = run(scene, until, sleep=False)
    times = INTERVAL * np.arange(1, len(asleep) + 1)
    assert asleep[times < 350.0].max() >= 8, "it slept while it lay"
    assert not asleep[times >= awake].any(), "nothing sleeps through this"
    assert not none.any()
    apart = np.linalg.norm(slept - watched, axis=2).max()
    assert apart < 0.5 * TOLERANCE * LENGTH, f"{apart / (TOLERANCE * LENGTH):.2f} tau L apart"


def test_a_snapshot_of_sleeping_cable_goes_on_bit_by_bit() -> None:
    scene = laid(LAYING, [(0.0, 0.5)])
    model = cm.CableModel(scene)
    lay(model, 340.0)
    assert model.statistics["asleep"] > 0
    snapshot = model.snapshot()
    lay(model, 345.0)
    expected = model.snapshot()
    other = cm.CableModel(scene)
    other.restore(snapshot)
    lay(other, 345.0)
    assert other.snapshot() == expected


def test_a_step_that_fails_gives_sleeping_cable_back() -> None:
    """Refused after ever more internal steps, that move what sleeps in memory and wake it."""
    velocity, rate, *_ = MOVES["picked up"]
    model, undisturbed = (cm.CableModel(laid(velocity, rate)) for _ in range(2))
    for one in (model, undisturbed):
        lay(one, 340.0)
    before = model.statistics
    shape = model.state().position
    assert before["asleep"] > 0
    most = int(model._header.maximum_steps)
    for steps in (2, 10, 30, 60):
        model._header.maximum_steps = steps
        with pytest.raises(cm.StepError):
            model.step_to(530.0)
        assert model.statistics == before
        np.testing.assert_array_equal(model.state().position, shape)
    model._header.maximum_steps = most
    for one in (model, undisturbed):
        one.step_to(530.0)
    np.testing.assert_array_equal(model.state().position, undisturbed.state().position)
    assert model.statistics == undisturbed.statistics
    assert model.statistics["asleep"] == 0, "it woke on the way"


def test_nothing_sleeps_without_friction() -> None:
    scene = laid(LAYING, [(0.0, 0.5)])
    scene = cm.load_scene({**scene.to_dict(), "environment": {"floor": {"z": -100.0}}})
    model = cm.CableModel(scene)
    lay(model, 300.0)
    assert model.floor_length > 30.0
    assert model.statistics["asleep"] == 0


def test_what_is_laid_with_slack_sleeps_as_the_ship_goes_on() -> None:
    """Cable that lies in bends falls asleep without a jolt: what is awake is what has just been
    laid, and not all that has been (290 elements, once)."""
    speed, duration = 2.0, 100.0
    light = {"diameter": 0.014, "mass": 0.5, "submerged_weight": 3.3, "axial_stiffness": 2.6e6}
    light = {**CABLE, **light, "bending_stiffness": 0.29}
    current = [(0.0, -60.0, (-0.02, 0.03, 0.0)), (0.0, 0.0, (0.0, 0.2, 0.0))]
    model = cm.CableModel(
        {
            "environment": {
                "floor": {"z": -60.0, "friction": 0.7, "slope": [0.0, 0.03]},
                "current": {
                    "table": [{"t": t, "z": z, "velocity": list(v)} for t, z, v in current]
                },
            },
            "cable_types": {"C": light},
            "line": [{"cable": {"type": "C", "length": 257.0, "model": "hybrid"}}],
            "vessel": {"velocity": [{"t": 0.0, "velocity": [0.0, speed, 0.0]}]},
            "payout": {
                "rate": [{"t": 0.0, "rate": 1.006 * speed}],
                "drum": [{"cable": {"type": "C", "length": 300.0, "model": "hybrid"}}],
            },
            "solver": {"tolerance": TOLERANCE},
        }
    )
    awake = []
    while model.time < duration:
        model.step(1.0)
        awake.append(model.statistics["elements"] - model.statistics["asleep"])
    assert max(awake[25:]) < 160


def test_slack_that_is_laid_straight_ahead_falls_over_and_sleeps() -> None:
    """A ship that lays 15 % too much straight ahead: in the plane every arch stood and swayed, and
    all that had been laid stayed awake (300 elements after a minute)."""
    speed = 2.0
    model = cm.CableModel(
        {
            "environment": {"floor": {"z": -100.0, "friction": 0.5}},
            "cable_types": {"C": {**CABLE, "bending_stiffness": 5.0, "mass": 0.64}},
            "line": [{"cable": {"type": "C", "length": 470.0}}],
            "vessel": {"velocity": [{"t": 0.0, "velocity": [speed, 0.0, 0.0]}]},
            "payout": {
                "rate": [{"t": 0.0, "rate": 1.15 * speed}],
                "drum": [{"cable": {"type": "C", "length": 400.0}}],
            },
            "solver": {"tolerance": TOLERANCE},
        }
    )
    assert model.planar
    model.step_to(60.0)
    statistics = model.statistics
    assert not model.planar
    assert model.line_length == pytest.approx(470.0 + 60.0 * 1.15 * speed)
    assert statistics["elements"] > 190
    assert statistics["elements"] - statistics["asleep"] < 100


def test_folds_on_a_soft_floor_come_to_rest_and_sleep() -> None:
    """In 4,000 m the contact layer is a metre deep: half a per cent of slack folds within it. The
    floor, which bears for long what presses it, pushed troughs up and crests down behind their
    motion: folds wandered for ever, by 12 mm/s."""
    scene = cm.load_scene(SCENES / "cable_lay_5_knots.yaml").to_dict()
    rate = [(0, 1.0), (140, 1.0), (154, 1.005)]
    scene["payout"]["rate"] = [{"t": t, "rate": factor * 5 * KNOT} for t, factor in rate]
    model = cm.CableModel(scene)
    model.step(550.0)
    laid = np.linspace(model.line_length - 400.0, model.line_length, 101)
    assert model.statistics["asleep"] > 0.5 * model.statistics["elements"]
    assert np.abs(model.sample(laid).velocity).max() < 1e-6
