"""For how long, and where, a line has carried no tension, by solutions of their own."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import cablemodel as cm
from tests.verification.direct_scenes import cable, direct
from tests.verification.scenes import CABLE_K, IDEAL, scene

WEIGHT, MASS, WATER = 4000.0, 500.0, 300.0
"""Of a load [N], [kg], and of the water that moves with it [kg]."""
DRAG = 0.5 * 1025.0 * 2.0
"""Of it [kg/m]."""
LENGTH, STIFFNESS, PERIOD = 20.0, 3e5, 6.0
WIRE = {
    **IDEAL, "diameter": 0.005, "mass": 0.05, "submerged_weight": 0.4,
    "axial_stiffness": STIFFNESS, "bending_stiffness": 1.0, "drag_normal": 1.2,
    "drag_tangential": 0.02, "added_mass": 1.0,
}  # fmt: skip


def heave(t: float, speed: float) -> float:
    """Of the upper end [m/s], from rest."""
    periods = t / PERIOD
    return speed * math.sin(2.0 * math.pi * periods) * (1.0 - math.exp(-((2.0 * periods) ** 4)))


def heaved(speed: float, tolerance: float = 1e-4, **load: float) -> cm.Scene:
    """A load on a wire below a crane tip that heaves for two periods."""
    body = {
        "mass": MASS, "submerged_weight": WEIGHT, "added_mass": WATER, "added_mass_axial": WATER,
        "drag_area": 2.0, "drag_area_axial": 2.0, "drag_coefficient": 1.0,
        "drag_coefficient_axial": 1.0, **load,
    }  # fmt: skip
    rows = [
        {"t": float(t), "velocity": [0.0, 0.0, heave(float(t), speed)]}
        for t in np.linspace(0.0, 2.0 * PERIOD, 121)
    ]
    motion = {"velocity": rows, "interpolation": "cubic"}
    return scene(LENGTH, WIRE, model="hybrid", body=body, tolerance=tolerance, vessel=motion)


def spells(speed: float) -> list[tuple[float, float]]:
    """When a spring that cannot push, without mass, is slack above that load [s]: until it pulls
    with 2 % of the load's weight, from which a line is taut."""
    stiffness = STIFFNESS / LENGTH

    def rates(t: float, y: np.ndarray) -> list[float]:
        pull = max(0.0, stiffness * (y[2] - y[0]))
        force = pull - WEIGHT - DRAG * abs(y[1]) * y[1]
        return [y[1], force / (MASS + WATER), heave(t, speed)]

    def stretch(t: float, y: np.ndarray) -> float:
        return float(y[2] - y[0])

    def pull(t: float, y: np.ndarray) -> float:
        return stiffness * stretch(t, y) - 0.02 * WEIGHT

    stretch.direction, pull.direction = -1.0, 1.0  # type: ignore[attr-defined]
    start = [-WEIGHT / stiffness, 0.0, 0.0]
    begins, ends = solve_ivp(
        rates, (0.0, 2.0 * PERIOD), start, events=(stretch, pull), rtol=1e-9, atol=1e-10,
        max_step=2e-3,
    ).t_events  # fmt: skip
    return list(zip(begins.tolist(), ends.tolist(), strict=True))


def at_the_end(of: cm.Scene, interval: float) -> cm.CableModel:
    """A model stepped by an interval to the end of its heave."""
    model = cm.CableModel(of)
    for k in range(round(2.0 * PERIOD / interval)):
        model.step_to((k + 1) * interval)
    return model


def test_a_load_in_heave_lets_its_wire_go_for_as_long_as_a_spring_without_mass() -> None:
    expected = spells(2.0)
    assert len(expected) == 2
    lasts = [end - begin for begin, end in expected]
    model = at_the_end(heaved(2.0), 0.1)
    assert model.slack_time == pytest.approx(sum(lasts), rel=0.01)
    assert model.slack_longest == pytest.approx(max(lasts), rel=0.01)
    assert model.slack_since == pytest.approx(expected[1][0], abs=2e-3)
    assert (model.slack_start, model.slack_end) == pytest.approx((0.0, LENGTH), abs=1e-9)


def test_a_load_that_its_crane_leaves_behind_flies_freely() -> None:
    """A crane that lowers at 2 m/s less than before within 2 / 2 g of the load: that flies up by
    itself, and meets its wire again where the crane has come to, after (1 + sqrt(1/2)) v / g."""
    fall = WEIGHT / MASS
    stop = 0.5 + 2.0 / (2.0 * fall)
    body = {"mass": MASS, "submerged_weight": WEIGHT, "added_mass": 0.0, "drag_area": 0.0}
    wire = {**WIRE, "diameter": 0.003, "mass": 0.01, "submerged_weight": 0.2,
            "axial_stiffness": 3e6, "bending_stiffness": 0.1}  # fmt: skip
    rows = [
        {"t": 0, "velocity": [0, 0, 2]}, {"t": 0.5, "velocity": [0, 0, 2]},
        {"t": stop, "velocity": [0, 0, 0]},
    ]  # fmt: skip
    thrown = scene(LENGTH, wire, model="hybrid", body=body, tolerance=1e-4,
                   vessel={"velocity": rows})  # fmt: skip
    model = cm.CableModel(thrown)
    model.step_to(1.0)
    expected = (1.0 + math.sqrt(0.5)) * 2.0 / fall
    assert model.slack_time == pytest.approx(expected, rel=0.03)


@pytest.mark.parametrize("speed", [2.0, 2.5])
def test_it_does_not_depend_on_when_anybody_looks(speed: float) -> None:
    """Steps of the caller from 10 ms to the whole run, and outputs at 10 ms and at 10 s."""
    of = heaved(speed, 1e-3)
    longest = at_the_end(of, 2.0 * PERIOD)
    for interval in (0.01, 0.3):
        model = at_the_end(of, interval)
        assert model.slack_time == pytest.approx(longest.slack_time, rel=0.01)
        assert model.slack_longest == pytest.approx(longest.slack_longest, rel=0.01)
        assert model.slack_since == pytest.approx(longest.slack_since, abs=5e-3)
    often, seldom = (
        cm.simulate(cm.load_scene(of.to_dict(), [f"run.output_interval={interval}"]), until=12.0)
        for interval in (0.01, 10.0)
    )
    assert len(seldom.time) < 4
    for name in ("slack_time", "slack_longest", "slack_start", "slack_end"):
        assert often[name][-1] == pytest.approx(seldom[name][-1], rel=0.01, abs=1e-9)


def test_it_converges_with_the_tolerance() -> None:
    found = [at_the_end(heaved(2.0, tau), 0.5).slack_time for tau in (1e-3, 3e-4, 1e-4)]
    assert abs(found[0] - found[2]) < 0.02 * found[2]
    assert abs(found[1] - found[2]) < 0.005 * found[2]


def test_a_line_that_stays_taut_says_so() -> None:
    model = at_the_end(heaved(1.0), 0.5)
    assert model.tension_min > 0.0
    assert (model.slack_time, model.slack_longest) == (0.0, 0.0)
    assert np.isnan([model.slack_since, model.slack_start, model.slack_end]).all()


def numbers(model: cm.CableModel) -> list[float]:
    return [getattr(model, f"slack_{key}") for key in ("time", "longest", "since", "start", "end")]


def test_it_is_part_of_the_state() -> None:
    """A snapshot within a spell goes on bit by bit; a step that fails gives it back."""
    model = cm.CableModel(heaved(2.0, 1e-3))
    model.step_to(4.6)
    within = numbers(model)
    kept = model.snapshot()
    assert 0.2 < model.slack_time < 0.4
    with pytest.raises(cm.StepError):
        model.step(0.05, vessel_position=[0.0, 0.0, 1e6])
    assert numbers(model) == within
    model.step_to(11.0)
    after = numbers(model)
    other = cm.CableModel(heaved(2.0, 1e-3))
    other.restore(kept)
    assert numbers(other) == within
    other.step_to(11.0)
    assert numbers(other) == after
    other.reset()
    assert other.slack_time == 0.0
    assert math.isnan(other.slack_since)


HEAVY = {
    **WIRE, "mass": 12.0, "submerged_weight": 100.0, "diameter": 0.03, "axial_stiffness": 1e6,
    "bending_stiffness": 50.0,
}  # fmt: skip


def loads_on_two_lines(second: float, **more: Any) -> cm.SystemModel:
    """Two loads below a ship that heaves as above, the second one with so much drag area [m2]; its
    line begins at it."""
    rows = [
        {"t": float(t), "velocity": [0.0, 0.0, heave(float(t), 2.0)]}
        for t in np.linspace(0.0, 2.0 * PERIOD, 121)
    ]

    def load(area: float) -> dict[str, Any]:
        return {
            "mass": MASS, "submerged_weight": WEIGHT, "inertia": [50.0] * 3,
            "added_mass": [WATER] * 3, "drag_area": [area] * 3, "points": {"top": [0, 0, 0]},
        }  # fmt: skip

    items = [{"cable": {"type": "W", "length": LENGTH, "model": "hybrid"}}]
    return cm.SystemModel(
        cm.load_system(
            {
                "cable_types": {"W": HEAVY},
                "vessels": {
                    "ship": {
                        "points": {"port": [0, 0, 0], "starboard": [0, 30, 0]},
                        "velocity": rows,
                        "interpolation": "cubic",
                    }
                },
                "bodies": {"plate": load(2.0), "other": load(second)},
                "lines": {
                    "down": {"from": "ship.port", "items": items, "to": "plate.top"},
                    "up": {"from": "other.top", "items": items, "to": "ship.starboard"},
                },
                "solver": {"tolerance": 1e-3},
                **more,
            }
        )
    )


@pytest.mark.parametrize(("weight", "bending"), [(2000.0, 100.0), (4000.0, 20.0)])
def test_slack_above_a_load_falls_to_one_side_at_every_tolerance(
    weight: float, bending: float
) -> None:
    """A load is put down in still water, and more is paid out: no side is better than the other,
    but a run and a finer one are to go the same way, not 5 m to either side."""
    length, diameter, mass = 120.0, 0.049, 1.3 * weight / 9.80665
    displaced = 1025.0 * math.pi / 4.0 * diameter**2
    wire = {
        "diameter": diameter, "mass": 68.9 / 9.80665 + displaced, "axial_stiffness": 1.16e8,
        "bending_stiffness": bending, "drag_normal": 1.2, "drag_tangential": 0.01,
    }  # fmt: skip
    load = {
        "mass": mass, "submerged_weight": weight, "added_mass": 0.1 * mass,
        "added_mass_axial": 0.1 * mass, "drag_area": 0.2, "drag_coefficient": 1.0,
    }  # fmt: skip
    sides = set()
    for tolerance in (1e-3, 3e-4, 1e-4):
        model = cm.CableModel(
            {
                "environment": {"floor": {"z": -length - 2.0, "friction": 0.3}},
                "cable_types": {"W": wire},
                "line": [{"cable": {"type": "W", "length": length}}, {"body": load}],
                "vessel": {"position": [0.0, 0.0, 0.0]},
                "payout": {
                    "rate": [{"t": 0.0, "rate": 0.0}, {"t": 2.0, "rate": 0.2}],
                    "drum": [{"cable": {"type": "W", "length": 50.0}}],
                },
                "solver": {"tolerance": tolerance},
            }
        )
        while model.time < 40.0:
            model.step(0.25)
        aside = model.sample(np.linspace(0.0, model.line_length, 60)).position[:, 0]
        furthest = aside[np.abs(aside).argmax()]
        assert abs(furthest) > 4.0
        sides.add(math.copysign(1.0, furthest))
    assert len(sides) == 1


def test_each_line_of_a_system_has_its_own() -> None:
    """A heavy wire is slack near its load only: places count from each line's beginning."""
    model = loads_on_two_lines(2.0)
    model.step_to(12.0)
    down, up = (model.lines[name].slack for name in ("down", "up"))
    assert 0.8 < down.time < 1.4
    assert down.time == pytest.approx(up.time, rel=0.05)
    assert down.since == pytest.approx(up.since, abs=0.05)
    assert 15.0 < down.start < 17.0
    assert down.end == pytest.approx(LENGTH)
    assert (up.start, up.end) == pytest.approx((LENGTH - down.end, LENGTH - down.start), abs=0.05)
    other = loads_on_two_lines(0.2)
    other.step_to(12.0)
    assert other.lines["up"].slack.time == 0.0
    assert math.isnan(other.lines["up"].slack.since)
    assert other.lines["down"].slack.time == pytest.approx(down.time, rel=0.03)


def test_a_line_that_is_cut_lets_go_then() -> None:
    cut = loads_on_two_lines(0.2, cuts={"knife": {"line": "up", "at": 10.0, "time": 0.5}})
    cut.step_to(0.5)
    assert cut.lines["up"].slack.time == 0.0
    cut.step_to(2.0)
    assert cut.cuts["knife"] == 0.5
    assert 1.2 < cut.lines["up"].slack.time <= 1.5
    assert (cut.lines["up"].slack.start, cut.lines["up"].slack.end) == pytest.approx((0.0, LENGTH))
    assert cut.lines["down"].slack.time == 0.0


@pytest.mark.parametrize("interval", [0.1, 1.0])
def test_the_direct_solver_counts_alike(interval: float) -> None:
    """A cable without anything at its end that moves up and down: its own weight, inertia and drag
    are in proportion to what hangs below, and it is pressed all along, or nowhere. While it is, it
    bends a little."""
    speed, period = 0.76, 10.0
    rows = [
        {"t": float(t), "velocity": [0.0, 0.0, -speed * math.sin(2.0 * math.pi * t / period) ** 2]}
        for t in np.linspace(0.0, period, 401)
    ]
    model = cm.CableModel(direct([cable(30.0)], vessel={"velocity": rows}, time_step=0.02))
    along = 0.5 * 1025.0 * CABLE_K["drag_tangential"] * math.pi * CABLE_K["diameter"]
    fine = np.linspace(0.0, period, 100001)
    phase = 2.0 * math.pi * fine / period
    down = speed * np.sin(phase) ** 2
    quicker = speed * math.pi * 2.0 / period * np.sin(2.0 * phase)
    pull = CABLE_K["submerged_weight"] - CABLE_K["mass"] * quicker - along * down**2
    pressed = pull < 0.0
    for k in range(round(period / interval)):
        model.step_to((k + 1) * interval)
    begins = fine[1:][pressed[1:] & ~pressed[:-1]]
    assert len(begins) == 2
    assert model.slack_time == pytest.approx(period * np.mean(pressed), rel=0.04)
    assert model.slack_longest == pytest.approx(0.5 * period * np.mean(pressed), rel=0.04)
    assert model.slack_since == pytest.approx(begins[1], abs=0.01)
    assert (model.slack_start, model.slack_end) == pytest.approx((0.0, 30.0), abs=1e-9)
