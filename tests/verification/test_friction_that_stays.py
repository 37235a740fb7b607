"""What friction keeps as cable on a floor comes to a stop: its tension, whatever the steps are."""

import numpy as np
import pytest

import cablemodel as cm
from tests.verification.references.moored import moored_catenary

WEIGHT, LENGTH, FRICTION, DEPTH = 15.0, 400.0, 0.5, 50.0
ROPE = {
    "diameter": 0.03, "mass": 2.3, "submerged_weight": WEIGHT, "axial_stiffness": 3e7,
    "bending_stiffness": 10.0, "drag_normal": 1.2, "drag_tangential": 0.01,
}  # fmt: skip


HEAVY_CHAIN = {"diameter": 0.09, "mass": 90.0, "submerged_weight": 770.0, "axial_stiffness": 3.5e8,
         "drag_normal": 1.2}  # fmt: skip


def dragged(tolerance: float, begins: float, stops: float) -> cm.CableModel:
    """A rope along the floor, dragged by its end, which comes to a stop."""
    speeds = [(0.0, 0.0), (20.0, 0.3), (begins, 0.3), (stops, 0.0)]
    return cm.CableModel(
        {
            "environment": {"floor": {"z": -DEPTH, "friction": FRICTION}},
            "cable_types": {"rope": ROPE},
            "line": [{"cable": {"type": "rope", "length": LENGTH}}],
            "initial": {"straight": [-1, 0, 0]},
            "vessel": {
                "position": [0, 0, -DEPTH],
                "velocity": [{"t": t, "velocity": [v, 0, 0]} for t, v in speeds],
            },
            "solver": {"tolerance": tolerance},
        }
    )


@pytest.mark.parametrize("tolerance", [2e-4, 1.1e-4, 1e-4, 9e-5, 5e-5])
@pytest.mark.parametrize("step", [1.0, 5.0, 20.0])
def test_what_is_dragged_to_a_stop_keeps_the_friction_that_it_had(
    tolerance: float, step: float
) -> None:
    """mu w L, but for the little that slowed it down (1 N): it was up to 4 % less, by the step."""
    model = dragged(tolerance, 120.0, 220.0)
    while model.time < 300.0:
        model.step(step)
    held = FRICTION * WEIGHT * LENGTH
    assert model.top_tension == pytest.approx(held, abs=10.0 * tolerance * held + 3.0)
    assert np.abs(model.state().velocity).max() < 1e-4  # m/s: what is left of a wave


def test_a_sudden_stop_keeps_it_too() -> None:
    """The stop is 20 times as quick: slowing it down takes 14 N of 3,000."""
    for tolerance in (1e-3, 1e-4):
        for step in (0.5, 5.0, 30.0):
            model = dragged(tolerance, 120.0, 140.0)
            while model.time < 200.0:
                model.step(step)
            held = FRICTION * WEIGHT * LENGTH
            assert model.top_tension == pytest.approx(held, abs=10.0 * tolerance * held + 14.0)


@pytest.mark.parametrize("step", [1.0, 5.0, 10.0, 50.0])
def test_a_winch_that_stops_keeps_what_the_floor_holds(step: float) -> None:
    """A winch takes in half of a rope, of which the rest lies, and slid. H = mu w of what lies, by
    the catenary: 2,887 N at the winch within ten tau (2,617 N by the step, before)."""
    rates = [(0.0, 0.0), (30.0, -0.4), (1000.0, -0.4), (1030.0, 0.0)]
    model = cm.CableModel(
        {
            "environment": {"floor": {"z": -100.0, "friction": 0.4}},
            "cable_types": {"rope": {**ROPE, "bending_stiffness": 50.0}},
            "line": [{"cable": {"type": "rope", "length": 800.0}}],
            "payout": {"rate": [{"t": t, "rate": rate} for t, rate in rates]},
        }
    )
    while model.time < 1200.0:
        model.step(step)
    pull = 0.0
    for _pass in range(60):  # contracts by a factor of three
        pull = 0.4 * WEIGHT * (400.0 - np.sqrt(100.0**2 + 200.0 * pull / WEIGHT))
    expected = pull + 100.0 * WEIGHT
    assert model.top_tension == pytest.approx(expected, rel=1e-2)


CHAIN = {
    "diameter": 0.108, "mass": 72.0, "submerged_weight": 614.0, "axial_stiffness": 3.1e8,
    "drag_normal": 2.4, "drag_tangential": 0.4,
}  # fmt: skip


AWAY = [(0, 0.0), (20, 0.1), (200, 0.1), (220, 0.0), (520, 0.0), (540, -0.1), (720, -0.1)]
"""Of a vessel that drifts off by 20 m, stays, and comes back: time [s], speed [m/s]."""


@pytest.mark.parametrize(("tolerance", "within"), [(1e-3, 1.0), (1e-4, 2.5)])
def test_an_anchor_keeps_what_reached_it_as_its_vessel_comes_back(
    tolerance: float, within: float
) -> None:
    """The anchor feels what friction does not take up on the way, in closed form; and keeps it as
    the chain before it gets slack again. Swings on bristles took 1,700 N more there, and as many
    again as the vessel came back. At 1e-4 it is .3 to 3.1 promises too much, by chance."""
    depth, length, friction, out = 100.0, 600.0, 0.2, 540.0
    model = cm.CableModel(
        {
            "environment": {"floor": {"z": -depth, "friction": friction}},
            "cable_types": {"chain": CHAIN},
            "line": [{"cable": {"type": "chain", "length": length}}],
            "end": {"anchor": [-out, 0, -depth]},
            "vessel": {"velocity": [{"t": t, "velocity": [v, 0, 0]} for t, v in AWAY]},
            "solver": {"tolerance": tolerance},
        }
    )
    stiffness, weight = CHAIN["axial_stiffness"], CHAIN["submerged_weight"]
    line = moored_catenary(out + 20.0, depth, length, weight, stiffness, friction)
    expected = float(line.tension(np.zeros(1))[0])
    while model.time < 500.0:
        model.step(1.0)
    promised = 10.0 * tolerance * model.top_tension
    found = model.sample([length]).tension[0]
    assert found == pytest.approx(expected, abs=within * promised)
    while model.time < 700.0:
        model.step(1.0)
    assert model.sample([length]).tension[0] == pytest.approx(found, abs=promised)


def surging_chain(tolerance: float, friction: float = 0.6) -> cm.CableModel:
    """Chain on a floor to an anchor, whose fairlead surges by a metre: 60 to 70 m of the 211 that
    lie hold all that pulls, H / (mu w)."""
    times = np.arange(0.0, 40.25, 0.25)
    speeds = 0.2 * np.pi * np.minimum(0.1 * times, 1.0) * np.sin(0.2 * np.pi * times)
    return cm.CableModel(
        {
            "environment": {"floor": {"z": -60.0, "friction": friction}},
            "cable_types": {"chain": HEAVY_CHAIN},
            "line": [{"cable": {"type": "chain", "length": 300.0}}],
            "end": {"anchor": [-270.0, 0.0, -60.0]},
            "vessel": {
                "velocity": [
                    {"t": float(t), "velocity": [float(v), 0.0, 0.0]}
                    for t, v in zip(times, speeds, strict=True)
                ]
            },
            "solver": {"tolerance": tolerance},
        }
    )


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4, 5e-5])
def test_an_anchor_feels_nothing_of_what_the_floor_holds(tolerance: float) -> None:
    """Friction without a potential shook chain loose that nothing pulls at: 6 to 25 kN at 1e-4."""
    model = surging_chain(tolerance)
    before = float(model.sample([model.line_length]).tension[0])
    largest = 0.0
    for n in range(1, 81):
        model.step_to(0.5 * n)
        largest = max(largest, model.top_tension)
        anchor = float(model.sample([model.line_length]).tension[0])
        assert anchor == pytest.approx(before, abs=10.0 * tolerance * model.tension_max)
    assert largest == pytest.approx(75.5e3, rel=2e-3)


@pytest.mark.parametrize(("slope", "tolerance"), [(0.06, 1e-3), (0.03, 1e-3), (0.03, 3e-4)])
def test_chain_on_a_slope_does_not_press_its_anchor(slope: float, tolerance: float) -> None:
    """It lies above it, on friction of ten times what it slides by: it pressed with w b l, 2,290 N.
    Finer tolerances still may: cable of no stiffness is up from the floor there, and friction
    does not take hold."""
    model = cm.CableModel(
        {
            "environment": {
                "floor": {"z": -60.0, "slope": [slope, 0.0], "at": [-200.0, 0.0], "friction": 0.6}
            },
            "cable_types": {"chain": HEAVY_CHAIN},
            "line": [{"cable": {"type": "chain", "length": 230.0}}],
            "end": {"anchor": [-200.0, 0.0, -60.0]},
            "solver": {"tolerance": tolerance},
        }
    )
    anchor = float(model.sample([model.line_length]).tension[0])
    assert abs(anchor) < 0.5 * 10.0 * tolerance * model.tension_max
