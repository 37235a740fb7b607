"""Cable asleep on the sea floor: what it gains, what wakes it, and that nobody sees it sleep."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import cablemodel as cm
from cablemodel.kernels import layout as at

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
LENGTH = 19.0
TOLERANCE = 1e-3
PROBES = np.array([0.25, 0.5, 0.75, 1.0])


def laid(
    velocity: list[tuple[float, tuple[float, float, float]]],
    rate: list[tuple[float, float]],
    current: list[tuple[float, tuple[float, float, float]]] | None = None,
) -> cm.Scene:
    """A lay in 20 m of water, with friction: what vessel, winch and current do over time."""
    environment: dict[str, Any] = {"floor": {"z": -20.0, "friction": 0.5}}
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
                "drum": [{"cable": {"type": "C", "length": 300.0}}],
            },
            "solver": {"tolerance": TOLERANCE},
        }
    )


def run(
    scene: cm.Scene, until: float, *, sleep: bool | None, interval: float = 0.5
) -> tuple[np.ndarray, np.ndarray]:
    """Positions of probes along the line (n, 4, 3) [m], and elements asleep (n,)."""
    model = cm.CableModel(scene, sleep=sleep)
    places, asleep = [], []
    while model.time < until - 1e-9:
        model.step(interval)
        places.append(model.sample(PROBES * model.line_length).position)
        asleep.append(model.statistics["asleep"])
    return np.array(places), np.array(asleep)


LAYING = [(0.0, (0.5, 0.0, 0.0))]
MOVES = {
    # name: vessel, pay-out, current, end [s], time from which all is awake [s]
    "picked up": (
        [(0.0, (0.5, 0.0, 0.0)), (200.0, (0.5, 0.0, 0.0)), (220.0, (-0.5, 0.0, 0.0))],
        [(0.0, 0.5), (200.0, 0.5), (220.0, -0.5)],
        None,
        380.0,
        375.0,
    ),
    "pulled sideways": (
        [(0.0, (0.5, 0.0, 0.0)), (150.0, (0.5, 0.0, 0.0)), (160.0, (0.0, 0.5, 0.0))],
        [(0.0, 0.5), (150.0, 0.5), (160.0, 0.0)],
        None,
        300.0,
        250.0,
    ),
    "swept by a current": (
        LAYING,
        [(0.0, 0.5)],
        [(0.0, (0.0, 0.0, 0.0)), (150.0, (0.0, 0.0, 0.0)), (170.0, (0.0, 0.8, 0.0))],
        250.0,
        175.0,
    ),
}


@pytest.mark.parametrize("name", MOVES)
def test_cable_asleep_wakes_and_moves_as_if_it_had_not_slept(name: str) -> None:
    velocity, rate, current, until, awake = MOVES[name]
    scene = laid(velocity, rate, current)
    slept, asleep = run(scene, until, sleep=None)
    watched, none = run(scene, until, sleep=False)
    times = 0.5 * np.arange(1, len(asleep) + 1)
    assert asleep[times < 150.0].max() >= 8, "it slept while it lay"
    assert not asleep[times >= awake].any(), "nothing sleeps through this"
    assert not none.any()
    apart = np.linalg.norm(slept - watched, axis=2).max()
    assert apart < 0.5 * TOLERANCE * LENGTH, f"{apart / (TOLERANCE * LENGTH):.2f} tau L apart"


def test_a_snapshot_of_sleeping_cable_goes_on_bit_by_bit() -> None:
    scene = laid(LAYING, [(0.0, 0.5)])
    model = cm.CableModel(scene)
    model.step_to(150.0)
    assert model.statistics["asleep"] > 0
    snapshot = model.snapshot()
    model.step_to(200.0)
    expected = model.snapshot()
    other = cm.CableModel(scene)
    other.restore(snapshot)
    other.step_to(200.0)
    assert other.snapshot() == expected


def test_a_step_that_fails_gives_sleeping_cable_back() -> None:
    """The step that is refused had let cable fall asleep, moved what sleeps, and woken it."""
    velocity, rate, *_ = MOVES["picked up"]
    model, undisturbed = (cm.CableModel(laid(velocity, rate)) for _ in range(2))
    for one in (model, undisturbed):
        one.step_to(190.0)
    assert model.statistics["asleep"] > 0
    before = model.statistics, model.state()
    most = int(model._ints[at.I_MAXIMUM_STEPS])
    model._ints[at.I_MAXIMUM_STEPS] = 150
    with pytest.raises(cm.StepError):
        model.step_to(375.0)
    model._ints[at.I_MAXIMUM_STEPS] = most
    assert model.statistics == before[0]
    np.testing.assert_array_equal(model.state().position, before[1].position)
    for one in (model, undisturbed):
        one.step_to(260.0)
    np.testing.assert_array_equal(model.state().position, undisturbed.state().position)
    assert model.statistics == undisturbed.statistics


def test_nothing_sleeps_without_friction() -> None:
    scene = laid(LAYING, [(0.0, 0.5)])
    scene = cm.load_scene({**scene.to_dict(), "environment": {"floor": {"z": -20.0}}})
    model = cm.CableModel(scene)
    model.step_to(150.0)
    assert model.floor_length > 30.0
    assert model.statistics["asleep"] == 0
