"""Cables and point bodies on drums of systems, beside the scene of one line and states at rest."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import cablemodel as cm
from cablemodel.cli.plausibility import system_warnings
from cablemodel.errors import SceneError
from cablemodel.systems import SystemModel

TAU = 1e-3
KINDS = {
    "wire": {"diameter": 0.02, "mass": 1.5, "axial_stiffness": 20e6},
    "hose": {"diameter": 0.06, "mass": 4.0, "axial_stiffness": 30e6, "bending_stiffness": 500.0},
}
CLUMP = {"mass": 60.0, "submerged_weight": 400.0, "drag_area": 0.1, "added_mass": 20.0}
FISH = {"mass": 200.0, "submerged_weight": 1500.0, "drag_area": 0.3, "added_mass": 50.0}
SPEED = 1.5

Item = dict[str, Any]


def cable(kind: str, length: float) -> Item:
    """A length of one kind."""
    return {"cable": {"type": kind, "length": length}}


DRUM = [{"body": CLUMP}, cable("wire", 50.0), cable("hose", 40.0)]


def rates(*rows: tuple[float, float]) -> list[dict[str, float]]:
    """A table of rates of pay-out."""
    return [{"t": time, "rate": rate} for time, rate in rows]


# Out past all joints of the drum, then in past all of them and two of the line.
RATE = rates((0, 0), (5, 1), (75, 1), (85, -1), (210, -1), (215, 0))
LINE = [cable("wire", 40.0), {"body": CLUMP}, cable("hose", 60.0), {"body": FISH}]
MOORED = [*LINE[:3], {"body": CLUMP}, cable("wire", 10.0)]
ANCHOR = {"anchor": [60.0, 0.0, -40.0]}


def pair(way: str, moored: bool, tolerance: float = TAU) -> tuple[SystemModel, cm.CableModel]:
    """A system, and its scene of one line at a tenth of the tolerance. way: its line goes `down`
    from the winch, or `up` to it; of what is moored so does the tree of the system."""
    items, far = (MOORED, ANCHOR) if moored else (LINE, "free")
    speed = [0.0 if moored else SPEED, 0.0, 0.0]
    current = {"current": [0.5, 0.2, 0.0]} if moored else {}
    common = {"cable_types": KINDS, "environment": {"water_density": 1025.0, **current}}
    ends = ["ship.sheave", far][:: 1 if way == "down" else -1]
    system = {
        **common,
        "solver": {"tolerance": tolerance},
        "vessels": {"ship": {"points": {"sheave": [0, 0, 0]}, "velocity": speed}},
        "lines": {
            "tow": {
                "from": ends[0], "to": ends[1],
                "items": items if way == "down" else items[::-1],
            }
        },
        "winches": {
            "main": {
                "line": "tow", "at": "start" if way == "down" else "end", "drum": DRUM,
                "rate": RATE,
            }
        },
    }  # fmt: skip
    single = {
        **common,
        "solver": {"tolerance": 0.1 * tolerance},
        "vessel": {"velocity": speed},
        "line": items,
        "end": ANCHOR if moored else "free",
        "payout": {"rate": RATE, "drum": DRUM},
    }
    return SystemModel(system), cm.CableModel(single)


@pytest.mark.parametrize("moored", [False, True], ids=["towed", "moored"])
@pytest.mark.parametrize("way", ["down", "up"])
def test_what_leaves_a_drum_does_as_in_the_scene_of_one_line(way: str, moored: bool) -> None:
    system, single = pair(way, moored)
    line, winch = system.lines["tow"], system.built.winch(0)
    assert winch.way == (-1.0 if way == "up" and moored else 1.0)
    cables, places, tensions, largest = set(), [], [], 0.0
    for time in range(2, 231, 2):
        system.step_to(time)
        single.step_to(time)
        cables.add(int(winch.cable))
        assert line.length == pytest.approx(single.line_length, abs=1e-9)
        x = np.linspace(0.0, line.length, 21)
        mine = line.sample(x if way == "down" else line.length - x)
        other = single.sample(np.minimum(x, single.line_length))
        places.append(np.linalg.norm(mine.position - other.position, axis=1).max())
        tensions.append(abs(mine.tension[0] - other.tension[0]))
        largest = max(largest, other.tension[0])
    # The clump on the drum, wire, hose; in the line the hose, and beyond it what the fish hangs on.
    assert len(cables) == 4
    assert system.winches["main"].drum_length == pytest.approx(single.drum_length, abs=1e-9)
    assert max(places) < TAU * line.length
    # Where a clump passes, the load rings: of that a system keeps the first motion only. Rounding
    # decides its phase: masses that differ by 1e-9 have it by 20 to 26 tau off.
    assert np.quantile(tensions, 0.95) < 10.0 * TAU * largest
    assert max(tensions) < 30.0 * TAU * largest


def test_joints_pass_from_one_drum_to_another_and_back() -> None:
    """At rest between, the line hangs as one that was always like that; in the end as at first."""
    ferried = rates((0, 0), (5, 0.5), (125, 0.5), (130, 0), (250, 0))
    ferried += rates((255, -0.5), (375, -0.5), (380, 0))
    back = [{**row, "rate": -row["rate"]} for row in ferried]
    clump = {"body": {**CLUMP, "drag_area": 2.0}}

    def system(items: list[Item], winches: dict[str, Any]) -> SystemModel:
        return SystemModel(
            {
                "cable_types": KINDS,
                "vessels": {
                    "one": {"points": {"sheave": [0, 0, 0]}},
                    "two": {"position": [80, 0, 0], "points": {"sheave": [0, 0, 0]}},
                },
                "lines": {"span": {"from": "one.sheave", "to": "two.sheave", "items": items}},
                "winches": winches,
            }
        )

    items = [cable("wire", 50.0), clump, cable("hose", 50.0)]
    drum = [cable("wire", 10.0), clump, cable("hose", 20.0), cable("wire", 60.0)]
    winches = {
        "giver": {"line": "span", "at": "start", "rate": ferried, "drum": drum},
        "taker": {"line": "span", "at": "end", "rate": back},
    }
    model = system(items, winches)
    line, places = model.lines["span"], np.linspace(0.0, 100.0, 21)
    before = line.sample(places)
    model.step_to(249.0)
    there = line.sample(places)
    # 62.5 m have gone over: all the hose with the clump, and a part of the wire.
    always = system([cable("wire", 32.5), cable("hose", 20.0), clump, cable("wire", 47.5)], {})
    expected = always.lines["span"].sample(places)
    assert model.winches["giver"].drum_length == pytest.approx(27.5, abs=1e-9)
    assert model.winches["taker"].drum_length == pytest.approx(62.5, abs=1e-9)
    assert np.abs(there.position - expected.position).max() < TAU * 100.0
    assert there.tension == pytest.approx(expected.tension, abs=10.0 * TAU * 1000.0)
    joints = line.sample()
    jumps = np.flatnonzero(np.diff(joints.s) == 0.0)
    assert joints.s[jumps] == pytest.approx([32.5, 52.5])  # of wire and hose, hose and wire
    model.step_to(480.0)
    after = line.sample(places)
    assert model.winches["taker"].drum_length == pytest.approx(0.0, abs=1e-9)
    assert np.abs(after.position - before.position).max() < TAU * 100.0
    assert after.tension == pytest.approx(before.tension, abs=10.0 * TAU * 1000.0)


def test_wall_tension_knows_what_has_come_off_a_drum() -> None:
    """Hose has nine times the wire's section for the water to press on."""
    system, _single = pair("up", moored=True)
    system.step_to(100.0)
    line = system.lines["tow"]
    assert line.length > 40.0 + 60.0 + 10.0 + 50.0 + 5.0
    near = line.length - 1.0
    state = line.sample([near - 20.0, near])  # of wire, of hose, off the drum
    off = state.tension - state.wall_tension
    depth = -state.position[:, 2]
    area = 0.25 * np.pi * np.array([0.02, 0.06]) ** 2
    assert off == pytest.approx(1025.0 * 9.81 * depth * area, rel=1e-3)


def test_what_is_cut_on_a_drum_parts_where_it_leaves_it() -> None:
    """A place in the line that has been wound up is there again later."""
    rate = rates((0, 0), (5, -1), (30, -1), (35, 0), (60, 0), (65, 1), (90, 1), (95, 0))
    scene = {
        "cable_types": KINDS,
        "vessels": {"ship": {"points": {"sheave": [0, 0, 0]}, "velocity": [SPEED, 0, 0]}},
        "lines": {"tow": {"from": "ship.sheave", "to": "free", "items": LINE}},
        "winches": {"main": {"line": "tow", "rate": rate, "drum": DRUM}},
        "cuts": {"weak": {"line": "tow", "at": 20.0, "time": 50.0}},
    }
    model = SystemModel(scene)
    model.step_to(55.0)
    assert model.cuts["weak"] is None
    assert model.lines["tow"].start_tension > 1000.0
    model.step_to(120.0)
    time = model.cuts["weak"]
    assert time is not None
    # 10 m are on the drum beyond it: in 2.5 s of growing rate, and 7.5 s at 1 m/s, they are out;
    # it is met like a joint, a hundredth of an element later.
    assert time == pytest.approx(72.5 + 0.2, abs=1e-6)
    assert model.lines["tow"].start_tension < 500.0


def towing(drum: Any) -> dict[str, Any]:
    """A fish on a winch whose drum holds something."""
    return {
        "cable_types": KINDS,
        "vessels": {"ship": {"points": {"sheave": [0, 0, 0]}, "velocity": [SPEED, 0, 0]}},
        "lines": {"tow": {"from": "ship.sheave", "to": "free", "items": LINE}},
        "winches": {"main": {"line": "tow", "drum": drum}},
    }


LONG = {"body": {**CLUMP, "half_length": 0.5}}


@pytest.mark.parametrize(
    ("drum", "place", "words"),
    [
        ("much", "winches.main.drum", "not a number with a unit"),
        ([cable("rope", 5.0)], "winches.main.drum.0.cable.type", "wire, hose"),
        ([cable("wire", -5.0)], "winches.main.drum.0.cable.length", "above 0"),
        ([cable("wire", 5.0), {"body": CLUMP}], "winches.main.drum.1", "a cable last"),
        ([*DRUM[:1], *DRUM], "winches.main.drum.1", "two bodies in a row"),
        ([LONG, cable("wire", 5.0)], "winches.main.drum.0.body.half_length", "half_length: 0"),
        ([{"fish": CLUMP}], "winches.main.drum.0.fish", "cable, body"),
    ],
)
def test_wrong_drums_are_named(drum: Any, place: str, words: str) -> None:
    with pytest.raises(SceneError) as caught:
        cm.load_system(towing(drum))
    assert place in str(caught.value)
    assert words in str(caught.value)


def test_a_length_is_of_the_cable_at_that_end() -> None:
    """Written into a log it is that cable, and read again the same."""
    scene = cm.load_system(towing("30 m"))
    assert [wound.type for wound in scene.drum_cables] == ["wire"]
    assert scene.winches["main"].drum_length == 30.0
    assert cm.load_system(scene.model_dump(mode="json", by_alias=True)) == scene


def test_two_bodies_in_a_row_in_a_line() -> None:
    """One of them would be lost."""
    scene = towing(0)
    scene["lines"]["tow"]["items"] = [*LINE, {"body": CLUMP}]
    with pytest.raises(SceneError, match="two bodies in a row"):
        cm.load_system(scene)


def test_a_check_looks_on_drums() -> None:
    """What is there is used; and a pay-out may ask for more than that."""
    scene = towing(DRUM)
    scene["lines"]["tow"]["items"] = [LINE[0], {"body": FISH}]  # the hose is on the drum only
    assert system_warnings(cm.load_system(scene)) == []
    scene["winches"]["main"]["rate"] = rates((0, 0), (10, 2))
    scene["run"] = {"duration": 100, "output_interval": 1}
    (warning,) = system_warnings(cm.load_system(scene))
    assert "winches.main.drum holds 90 m" in warning
    assert "190 m within the run" in warning
    assert "empty at t = 50 s" in warning
