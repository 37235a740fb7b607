"""Winches of systems, at either end of a line, against closed forms and the scene of one line."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq

import cablemodel as cm
from cablemodel.errors import SceneError, StepError
from cablemodel.systems import SystemModel

G, TAU = 9.81, 1e-3
WIRE = {
    "diameter": 0.02, "mass": 1.6, "axial_stiffness": 20e6, "drag_normal": 1.2,
    "drag_tangential": 0.01, "added_mass": 1.0,
}  # fmt: skip
WEIGHT = {"mass": 400.0, "submerged_weight": 3000.0, "drag_area": 0.4, "drag_coefficient": 1.0}
DRUM, LENGTH, SPEED = 60.0, 80.0, 1.5


def rates(*rows: tuple[float, float]) -> list[dict[str, float]]:
    """A table of rates of pay-out."""
    return [{"t": time, "rate": rate} for time, rate in rows]


RATE = rates((0, 0), (5, 0), (15, 1.0), (25, 1.0), (45, -1.0), (50, -1.0), (58, 0))


def towed(way: str) -> dict[str, Any]:
    """A weight towed below a ship with a winch. way: the line goes `down` to it or `up` from it."""
    items: list[Any] = [{"cable": {"type": "wire", "length": LENGTH}}, {"body": WEIGHT}]
    line = {"from": "ship.sheave", "to": "free", "items": items}
    if way == "up":
        line = {"from": "free", "to": "ship.sheave", "items": items[::-1]}
    end = "start" if way == "down" else "end"
    return {
        "cable_types": {"wire": WIRE},
        "vessels": {"ship": {"points": {"sheave": [0, 0, 0]}, "velocity": [SPEED, 0, 0]}},
        "lines": {"tow": line},
        "winches": {"main": {"line": "tow", "at": end, "drum": DRUM, "rate": RATE}},
    }


def one_line() -> dict[str, Any]:
    """The same as a scene of one line, to a hundredth of the tolerance."""
    return {
        "solver": {"tolerance": 0.01 * TAU},
        "cable_types": {"wire": WIRE},
        "vessel": {"velocity": [SPEED, 0, 0]},
        "line": [{"cable": {"type": "wire", "length": LENGTH}}, {"body": WEIGHT}],
        "payout": {"rate": RATE, "drum": [{"cable": {"type": "wire", "length": DRUM}}]},
        "environment": {"water_density": 1025},
    }


@pytest.mark.parametrize("way", ["down", "up"])
def test_pay_out_as_in_the_scene_of_one_line(way: str) -> None:
    system, single = SystemModel(towed(way)), cm.CableModel(one_line())
    places, tensions = [], []
    for _ in range(60):
        system.step(1.0)
        single.step(1.0)
        line = system.lines["tow"]
        assert line.length == pytest.approx(single.line_length, abs=1e-9)
        state = line.sample()
        tip = 0 if way == "up" else -1
        places.append(np.linalg.norm(state.position[tip] - single.tip_position))
        top = line.start_tension if way == "down" else line.end_tension
        tensions.append(abs(top - single.top_tension) / single.top_tension)
        assert system.winches["main"].drum_length == pytest.approx(single.drum_length, abs=1e-9)
    assert max(places) < TAU * (LENGTH + DRUM)
    assert max(tensions) < 10.0 * TAU


def between(**more: Any) -> dict[str, Any]:
    """A wire between two places, in nothing that damps it."""
    kind = {"diameter": 0.02, "mass": 2.0, "submerged_weight": 2.0 * G, "axial_stiffness": 5e6}
    return {
        "environment": {"water_density": 0.0, "gravity": G},
        "cable_types": {"wire": kind},
        **more,
    }


@pytest.mark.parametrize("way", [1, -1], ids=["from the winch", "to the winch"])
def test_a_taut_wire_is_reeled_in(way: int) -> None:
    """T = EA (D - L) / L, and half of its weight more at the top, as L gets shorter."""
    ends = ["ship.sheave", {"anchor": [0, 0, -50]}][::way]
    scene = between(
        vessels={"ship": {"points": {"sheave": [0, 0, 0]}}},
        lines={
            "leg": {
                "from": ends[0], "to": ends[1],
                "items": [{"cable": {"type": "wire", "length": 49.99, "model": "cable"}}],
            }
        },
        winches={
            "hoist": {
                "line": "leg", "at": "start" if way > 0 else "end",
                "rate": rates((0, 0), (10, -0.02), (20, -0.02), (30, 0)),
            }
        },
    )  # fmt: skip
    model = SystemModel(scene)
    tops = []
    for time in np.arange(0.5, 60.5, 0.5):
        model.step_to(float(time))
        if time > 40.0:
            line = model.lines["leg"]
            tops.append(line.start_tension if way > 0 else line.end_tension)
    length = model.lines["leg"].length
    assert length == pytest.approx(49.99 - 0.4, abs=1e-9)
    expected = 5e6 * (50.0 - length) / length + 0.5 * 2.0 * G * length
    assert np.mean(tops) == pytest.approx(expected, rel=2e-3)


SPAN, RUNS = 50.0, 60.0
"""Of a wire from one winch to another: between them, and its length [m]."""


def running(speed: float, since: float, environment: dict[str, Any] | None = None) -> SystemModel:
    """A wire that is paid out by one winch as another hauls it in, at that speed [m/s] from a time
    on."""
    rate = rates((0, 0), (since, speed))
    scene = between(
        vessels={"ship": {"points": {"bow": [0, 0, 0], "stern": [-SPAN, 0, 0]}}},
        lines={
            "loop": {
                "from": "ship.bow", "to": "ship.stern",
                "items": [{"cable": {"type": "wire", "length": RUNS, "model": "cable"}}],
            }
        },
        winches={
            "fore": {"line": "loop", "at": "start", "drum": 2000, "rate": rate},
            "aft": {
                "line": "loop", "at": "end", "rate": rates((0, 0), (since, -speed)),
            },
        },
    )  # fmt: skip
    return SystemModel(scene | {"environment": environment or scene["environment"]})


@pytest.mark.parametrize("speed", [4.5, 5.0])
def test_a_wire_that_runs_from_one_winch_to_another_keeps_its_catenary(speed: float) -> None:
    """What runs along itself at V needs m V^2 more tension to go round its bends: the shape stays,
    the tension rises by m V^2 everywhere."""
    model = running(speed, 16.0)
    before = model.lines["loop"].sample(np.linspace(0.0, RUNS, 7))
    a = brentq(lambda a: 2.0 * a * np.sinh(0.5 * SPAN / a) - RUNS, 1.0, 1e3)
    assert before.tension[0] == pytest.approx(2.0 * G * np.hypot(a, 0.5 * RUNS), rel=1e-3)
    found = []
    for time in range(1, 33):
        model.step_to(float(time))
        if time > 18:
            assert model.winches["fore"].payout_rate == pytest.approx(speed)
            found.append(model.lines["loop"].sample(np.linspace(0.0, RUNS, 7)))
    rise = np.mean([state.tension for state in found], axis=0) - before.tension
    assert rise == pytest.approx(2.0 * speed**2, rel=0.05)
    moved = np.mean([state.position for state in found], axis=0) - before.position
    assert np.abs(moved).max() < 0.05


def test_a_wire_that_runs_on_in_water_does_not_begin_to_ring() -> None:
    model = running(5.0, 50.0, {"water_density": 1025.0, "gravity": G})
    found = []
    for time in range(2, 101, 2):
        model.step_to(float(time))
        if time > 80:
            found.append(model.lines["loop"].sample(np.linspace(0.0, RUNS, 7)).tension)
    assert np.ptp(found, axis=0).max() < 2.0 * 10.0 * 1e-3 * np.max(found)


def bridle(first: str = "left") -> dict[str, Any]:
    """A weight on two wires with a winch each; the tree begins at the first of both lines."""
    lines = {
        side: {
            "from": f"ship.{side}", "to": "weight.top",
            "items": [{"cable": {"type": "wire", "length": 30.0, "model": "cable"}}],
        }
        for side in sorted(("left", "right"), key=lambda side: side != first)
    }  # fmt: skip
    lowers = rates((0, 0), (10, 0.1), (30, 0.1), (40, 0))
    return between(
        vessels={"ship": {"points": {"left": [0, 10, 0], "right": [0, -10, 0]}}},
        bodies={
            "weight": {
                "mass": 500.0, "submerged_weight": 500.0 * G, "inertia": 50.0,
                "points": {"top": [0, 0, 0]},
            }
        },
        lines=lines,
        winches={
            f"{side}_hoist": {"line": side, "drum": 10.0, "rate": lowers}
            for side in ("left", "right")
        },
    )  # fmt: skip


@pytest.mark.parametrize("first", ["left", "right"])
def test_two_winches_lower_a_weight_evenly(first: str) -> None:
    """The tree goes out from one winch and comes to the other: both do the same."""
    model = SystemModel(bridle(first))
    places = []
    for _ in range(70):
        model.step(1.0)
        places.append(model.bodies["weight"].position)
        left, right = (model.lines[side] for side in ("left", "right"))
        assert left.start_tension == pytest.approx(right.start_tension, rel=10.0 * TAU)
        assert abs(places[-1][1]) < 30.0 * TAU
    length = model.lines["left"].length
    assert length == pytest.approx(33.0, abs=1e-9)
    depth = np.mean([-place[2] for place in places[45:]])
    pull = 0.5 * 500.0 * G * length / np.sqrt(length**2 - 100.0)  # each wire's, nearly straight
    stretched = length * (1.0 + pull / 5e6)
    assert depth == pytest.approx(np.sqrt(stretched**2 - 100.0), abs=2e-2)


def test_the_ends_of_drum_and_line() -> None:
    scene = towed("down")
    scene["winches"]["main"]["rate"] = 0.0
    model = SystemModel(scene)
    model.step(70.0, rates={"main": 2.0})
    assert model.winches["main"].limit == "drum empty"
    assert model.winches["main"].drum_length == pytest.approx(0.0, abs=1e-9)
    assert model.winches["main"].payout_rate == 0.0
    length = LENGTH + DRUM
    assert model.lines["tow"].length == pytest.approx(length, abs=1e-9)
    model.step(50.0, rates={"main": -2.0})
    model.step(50.0)  # back to the scene's rate
    assert model.winches["main"].limit == "free"
    assert model.lines["tow"].length == pytest.approx(length - 25.0 - 50.0, abs=1e-9)
    before = model.snapshot()
    with pytest.raises(StepError, match=r"rates is 'man'.*main"):
        model.step(1.0, rates={"man": 1.0})
    with pytest.raises(StepError, match=r"rates\.main is .*finite"):
        model.step(1.0, rates={"main": float("nan")})
    assert model.snapshot() == before


@pytest.mark.parametrize("way", ["down", "up"])
def test_a_line_is_let_go_at_its_winch(way: str) -> None:
    scene = towed(way)
    end = "start" if way == "down" else "end"
    scene["winches"]["main"]["rate"] = rates((0, 0), (5, 0), (8, 1.0))
    scene["cuts"] = {"brake": {"line": "tow", "at": end, "time": 12.0}}
    model = SystemModel(scene)
    model.step(11.0)
    out = model.lines["tow"].length
    model.step(1.5)
    lost = model.lines["tow"].length
    assert lost == pytest.approx(out + 1.0, abs=1e-6)  # what passed until 12 s
    model.step(3.0)
    assert model.lines["tow"].length == lost
    assert model.winches["main"].payout_rate == 0.0
    assert abs(model.lines["tow"].sample().tension).max() < 3500.0


def test_snapshots_and_copies_have_winches() -> None:
    model = SystemModel(bridle())
    model.step(15.0, rates={"left_hoist": 0.2})
    kept, other = model.snapshot(), copy.copy(model)
    model.step(10.0)
    other.step(10.0)
    assert other.snapshot() == model.snapshot()
    model.restore(kept)
    model.step(10.0)
    assert other.snapshot() == model.snapshot()


@pytest.mark.parametrize(
    ("change", "place", "words"),
    [
        ({"line": "two"}, "winches.main.line", "tow"),
        ({"at": "end"}, "winches.main.at", "an end at a vessel's point"),
        ({"drum": -1.0}, "winches.main.drum", "at least 0"),
    ],
)
def test_wrong_winches_are_named(change: dict[str, Any], place: str, words: str) -> None:
    scene = towed("down")
    scene["winches"]["main"] |= change
    with pytest.raises(SceneError) as caught:
        SystemModel(scene)
    assert place in str(caught.value)
    assert words in str(caught.value)


def hoisting(way: str, rate: float) -> dict[str, Any]:
    """A load with a weight on a wire below it, on a hoist that runs from the start, in a vacuum."""
    wire = {"diameter": 0.01, "mass": 0.5, "axial_stiffness": 1e6}
    eyes = {"top": [0, 0, 0.4], "below": [0, 0, -0.4]}
    load = {"mass": 300.0, "submerged_weight": 300.0 * G, "inertia": 30.0, "points": eyes}
    hoist = {"from": "ship.sheave", "to": "load.top"}
    if way == "up":
        hoist = {"from": "load.top", "to": "ship.sheave"}
    weight = {"body": {"mass": 50.0, "submerged_weight": 50.0 * G, "drag_area": 0.0}}
    cable = {"cable": {"type": "wire", "length": 40.0}}
    return {
        "environment": {"water_density": 0.0, "gravity": G},
        "cable_types": {"wire": wire},
        "vessels": {"ship": {"points": {"sheave": [0, 0, 0]}, "velocity": [0, 0, 0.2]}},
        "bodies": {"load": load},
        "lines": {
            "hoist": {**hoist, "items": [cable]},
            "sling": {"from": "load.below", "to": "free", "items": [cable, weight]},
        },
        "winches": {
            "main": {"line": "hoist", "at": "start" if way == "down" else "end", "drum": 10.0,
                     "rate": rate}
        },
    }  # fmt: skip


@pytest.mark.parametrize("way", ["down", "up"])
@pytest.mark.parametrize("rate", [0.3, -0.3])
def test_what_hangs_on_a_winch_that_runs_moves_along(way: str, rate: float) -> None:
    """Its weight is all that pulls; from rest, a jerk of rate sqrt(EA m), 212 N, would run down.
    All of the load's way is the stretched cable that has passed, on the ship that rises."""
    model = SystemModel(hoisting(way, rate))
    place = model.bodies["load"].position[2]
    assert model.winches["main"].payout_rate == rate
    for k in range(1, 51):
        t = 0.01 * k if k < 20 else 0.2 * (k - 18)
        model.step_to(t)
        line = model.lines["hoist"]
        top = line.start_tension if way == "down" else line.end_tension
        weight = (350.0 + 0.5 * (80.0 + rate * t)) * G
        assert top == pytest.approx(weight, abs=15.0)
        gone = rate * t * (1.0 + weight / 1e6)
        assert model.bodies["load"].position[2] - place == pytest.approx(0.2 * t - gone, abs=5e-3)
    tip = model.lines["sling"].sample([40.0]).velocity[0, 2]
    assert tip == pytest.approx(0.2 - rate * 1.0038, abs=5e-3)


def test_a_winch_does_not_run_from_the_start_where_what_hangs_is_held() -> None:
    """Through a body, or at a branch; by an empty drum neither, nor while a body at its end lies on
    the floor."""
    scene = hoisting("down", 0.3)
    scene["lines"]["sling"]["to"] = {"anchor": [5, 0, -75]}
    scene["lines"]["sling"]["items"] = scene["lines"]["sling"]["items"][:1]
    with pytest.raises(SceneError, match=r"hoist's beginning and sling's end") as caught:
        cm.load_system(scene)
    assert "winches.main.rate" in str(caught.value)
    branch = hoisting("down", 0.3)
    branch["lines"]["stay"] = {
        "from": {"line": "hoist", "at": 10}, "to": {"anchor": [20, 0, -20]},
        "items": [{"cable": {"type": "wire", "length": 30.0}}],
    }  # fmt: skip
    with pytest.raises(SceneError, match=r"stay's end"):
        cm.load_system(branch)
    empty = hoisting("down", 0.3)
    empty["winches"]["main"]["drum"] = 0.0
    assert cm.load_system(empty).winches["main"].rate_at_start == 0.0
    stands = hoisting("down", 0.3)
    stands["environment"]["floor"] = {"z": -75.0, "friction": 0.3}
    with pytest.raises(SceneError, match="touches the sea floor, and hoist is tied to more"):
        SystemModel(stands)


def test_two_winches_at_one_end() -> None:
    scene = towed("down")
    scene["winches"]["other"] = {"line": "tow"}
    with pytest.raises(SceneError, match="one winch at an end"):
        SystemModel(scene)
