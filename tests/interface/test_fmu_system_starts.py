"""Vessels of a system that begin elsewhere, and other coefficients: as in a scene that has them, or
refused."""

from __future__ import annotations

import copy
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmu_tools import Slave, unpacked
from test_fmu_systems import STATIONS, expected, numbers_of, still, tow

import cablemodel as cm
from cablemodel.systems import SystemModel
from cablemodel_fmu.recording import FmuLog

SCENES = Path(__file__).parents[2] / "scenes" / "systems"
FIRST = 400000000
"""Value reference of the first vessel's start."""


def two_ships(**changes: Any) -> cm.SystemScene:
    """A net's weight between two ships under way."""
    data: dict[str, Any] = {
        "cable_types": {"wire": {"diameter": 0.02, "mass": 1.6, "axial_stiffness": 2e7}},
        "vessels": {
            "a": {"points": {"p": [0, 0, 0]}, "velocity": [1, 0, 0]},
            "b": {"points": {"p": [0, 0, 0]}, "position": [0, 60, 0], "velocity": [1, 0, 0]},
        },
        "bodies": {
            "net": {"mass": 800, "submerged_weight": 4000, "inertia": [60, 200, 200],
                    "drag_area": 2.0, "drag_turning": 1.0,
                    "points": {"l": [0.5, -0.5, 0], "r": [0.5, 0.5, 0]}}
        },
        "lines": {
            "port": {"from": "a.p", "to": "net.l",
                     "items": [{"cable": {"type": "wire", "length": 60}}]},
            "star": {"from": "b.p", "to": "net.r",
                     "items": [{"cable": {"type": "wire", "length": 60}}]},
        },
        "run": {"duration": 10, "output_interval": 0.5},
    }  # fmt: skip
    data.update(changes)
    return cm.load_system(data)


def moored() -> cm.SystemScene:
    """A ship between two chains that lie on the sea floor."""
    ways = {"bow": 1.0, "aft": -1.0}
    return cm.load_system(
        {
            "cable_types": {"chain": {"diameter": 0.06, "mass": 80, "axial_stiffness": 3e8,
                                      "submerged_weight": 680}},
            "environment": {"floor": {"z": -60, "friction": 0.6}},
            "vessels": {"ship": {"points": {k: [20 * x, 0, 0] for k, x in ways.items()}}},
            "lines": {
                k: {"from": f"ship.{k}", "to": {"anchor": [220 * x, 0, -60]},
                    "items": [{"cable": {"type": "chain", "length": 230}}]}
                for k, x in ways.items()
            },
            "run": {"duration": 10, "output_interval": 0.5},
        }
    )  # fmt: skip


def bridle(start: dict[str, list[float]]) -> cm.SystemScene:
    """The tug's pontoon behind it, on its new course."""
    data = cm.load_system(SCENES / "bridle_tow.yaml").to_dict()
    yaw = math.atan2(start["velocity"][1], start["velocity"][0])
    data["vessels"]["tug"].pop("path")
    data["vessels"]["tug"].update(start)
    x, y, _ = start["position"]
    data["bodies"]["pontoon"].update(
        position=[x - 112 * math.cos(yaw), y - 112 * math.sin(yaw), 0.6], attitude=[0, 0, yaw]
    )
    data["bodies"]["plate"]["attitude"] = [0, 0, yaw]
    return cm.load_system(data)


def begun(scene: cm.SystemScene, starts: dict[str, dict[str, Any]]) -> cm.SystemScene:
    """The scene with these starts of its vessels."""
    data = copy.deepcopy(scene.to_dict())
    for name, start in starts.items():
        data["vessels"][name].update(start)
    return cm.load_system(data)


def named(starts: dict[str, dict[str, Any]]) -> dict[str, Any]:
    return {
        f"{name}.start_{key}": value
        for name, start in starts.items()
        for key, value in start.items()
    }


def promised(slave: Slave, model: SystemModel) -> tuple[float, float]:
    """Positions in units of tau L, tensions in units of 10 tau of the line's largest."""
    tau = model.scene.solver.tolerance
    place = tension = 0.0
    for name, wanted in expected(model).items():
        line, _, what = name.partition(".")
        if line not in model.lines or not what.startswith(("tension", "line.")):
            continue
        off = abs(slave.get(name) - wanted)
        if "position" in what:
            place = max(place, off / (tau * model.scene.lines[line].length))
        elif "tension" in what:
            most = max(abs(t) for t in model.lines[line].tension_range)
            tension = max(tension, off / (10 * tau * most))
    return place, tension


HEADING = math.radians(90)
COURSE = {"position": [30.0, -10.0, 0.0], "attitude": [0.0, 0.0, HEADING],
          "velocity": [1.5 * math.cos(HEADING), 1.5 * math.sin(HEADING), 0.0]}  # fmt: skip
BACK = {"position": [0.0, 0.0, 0.0], "attitude": [0.0, 0.0, math.pi], "velocity": [-1.0, 0, 0]}
FASTER = {"a": {"velocity": [1.1, 0.1, 0]},
          "b": {"position": [3, 55, 0], "velocity": [1.1, 0.1, 0]}}  # fmt: skip
ASIDE = {"ship": {"position": [8, 3, 0], "attitude": [0, 0, 0.2]}}
CRAB = {"position": [0.0, 0, 0], "attitude": [0.0, 0, 0.35], "velocity": [2.0, 0, 0]}
CASES: dict[str, Any] = {
    "a ship 20 m farther": (two_ships, {"b": {"position": [0, 80, 0]}}, None),
    "both faster": (two_ships, FASTER, None),
    "a tug on another course": ("bridle_tow", {"tug": COURSE}, bridle(COURSE)),
    "a tug that goes back slowly": ("bridle_tow", {"tug": BACK}, bridle(BACK)),
    "a tug that crabs": ("bridle_tow", {"tug": {"attitude": [0, 0, 0.35]}}, bridle(CRAB)),
    "a ship aside of its cage": ("cage_and_vehicle", {"ship": {"position": [10, 20, 0]}}, None),
    "a vehicle farther out": ("cage_and_vehicle", {"vehicle": {"position": [30, 10, -290]}}, None),
    "a cage under a ship that turns": (
        "cage_on_its_winch", {"ship": {"attitude": [0, 0, 0.5]}}, None,
    ),
    "chains on the floor": (moored, ASIDE, None),
    "a path, foils and waves": (tow, {"tug": {"position": [4, -6, 0.5]}}, None),
    "a clamp whose line is moved along with it": (tow, {
        "tug": {"position": [3, 0, 0]}, "crane": {"position": [3, 60, 3]}
    }, None),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_it_starts_as_the_scene_that_begins_there(case: str, tmp_path: Path) -> None:
    """And goes on so, with what the scene schedules."""
    source, starts, wanted = CASES[case]
    scene = cm.load_system(SCENES / f"{source}.yaml") if isinstance(source, str) else source()
    model = SystemModel(wanted or begun(scene, starts))
    with unpacked(scene, tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, use_scene_inputs=True, **named(starts))
        for name, start in starts.items():
            for key, value in start.items():
                np.testing.assert_array_equal(slave.get(f"{name}.start_{key}"), value)
                np.testing.assert_allclose(slave.get(f"{name}.{key}_input"), value)
        for _ in range(6):
            assert max(promised(slave, model)) < 1.0
            slave.step(0.5)
            model.step(0.5)
        assert max(promised(slave, model)) < 1.0
        assert slave.messages == []
        slave.close()


def test_friction_takes_hold_of_what_lies_to_anchors_at_a_start_that_is_set(tmp_path: Path) -> None:
    """Of chains that pull at their anchors by more than 9 kN without it. The scene's own start is
    that of the library to the bit, and goes on so."""
    data = moored().to_dict()
    for name, x in ("bow", 1.0), ("aft", -1.0):
        data["lines"][name]["to"]["anchor"] = [300.0 * x, 0, -60]
        data["lines"][name]["items"][0]["cable"]["length"] = 312.0
    scene = cm.load_system(data)
    plain, model = SystemModel(scene), SystemModel(begun(scene, ASIDE))
    assert plain.built.friction_holds
    assert model.built.friction_holds
    with unpacked(scene, tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, use_scene_inputs=True)
        for _ in range(3):
            for name, wanted in expected(plain).items():
                if name.startswith(("bow.tension", "aft.tension")):
                    np.testing.assert_array_equal(slave.get(name), wanted)
            slave.step(0.5)
            plain.step(0.5)
        slave.close()
        slave = Slave(*found, **named(ASIDE))
        for name, line in model.lines.items():
            horizontal = line.start_tension - 680.0 * 60.0
            assert horizontal > 9e3
            promise = 10.0 * scene.solver.tolerance * line.start_tension
            assert abs(slave.get(f"{name}.tension.end") - line.end_tension) < 0.1 * promise
            assert abs(line.end_tension) < promise
        slave.close()


def test_all_vessels_moved_alike_move_what_hangs_there_to_the_bit(tmp_path: Path) -> None:
    way = np.array([64.0, -32.0, 0.0])  # added without rounding
    starts = {"a.start_position": way, "b.start_position": way + np.array([0.0, 60.0, 0.0])}
    with unpacked(two_ships(), tmp_path, stations=STATIONS) as found:
        slave, plain = Slave(*found, **starts), Slave(*found)
        for k in range(4):
            for name in ("port.line.position", "net.position", "a.position", "b.position"):
                moved = plain.get(name).reshape(-1, 3) + way
                off = np.abs(slave.get(name).reshape(-1, 3) - moved).max()
                assert off == 0.0 if k == 0 else off < 1e-9
            for name in ("port.line.tension", "net.attitude", "a.force", "b.moment"):
                first, other = slave.get(name), plain.get(name)
                np.testing.assert_allclose(first, other, rtol=1e-9, atol=1e-6 if k else 0.0)
            for one in (slave, plain):
                one.step(0.5)
        slave.close()
        plain.close()


def test_alike_is_to_rounding(tmp_path: Path) -> None:
    """60.1 - 60 is not 0.1; what hangs there still keeps its last bit."""
    starts = {"a.start_position": (0.1, 0.1, 0), "b.start_position": (0.1, 60.1, 0)}
    with unpacked(two_ships(), tmp_path, stations=STATIONS) as found:
        slave, plain = Slave(*found, **starts), Slave(*found)
        for name in ("port.line.tension", "star.line.tension", "net.attitude"):
            np.testing.assert_array_equal(slave.get(name), plain.get(name))
        slave.close()
        plain.close()


@pytest.mark.parametrize("drives", [True, False])
def test_at_another_velocity_a_vessel_leaves_its_path(drives: bool, tmp_path: Path) -> None:
    """It goes straight on, and does not turn, whether the scene drives it or inputs do."""
    ship = {"points": {"hook": [1, 0, 0]},
            "path": [{"turn": {"angle": "90 deg", "radius": 30, "speed": 1}}]}  # fmt: skip
    with unpacked(still(vessels={"ship": ship}), tmp_path, stations=STATIONS) as found:
        start = {"ship.start_velocity": (1.2, 0.3, 0.0)}
        slave = Slave(*found, use_scene_inputs=drives, **start)
        heading = slave.get("ship.attitude")
        np.testing.assert_array_equal(slave.get("ship.angular_velocity"), 0.0)
        np.testing.assert_array_equal(slave.get("ship.attitude_rate_input"), 0.0)
        for _ in range(4):
            slave.step(1.0)
        np.testing.assert_allclose(slave.get("ship.position"), [4.8, 1.2, 0.0], atol=1e-12)
        np.testing.assert_allclose(slave.get("ship.attitude"), heading, atol=1e-12)
        slave.close()


def test_the_scenes_own_start_changes_nothing(tmp_path: Path) -> None:
    """Set, or set to another one and back after that was looked at."""
    with unpacked(two_ships(), tmp_path, stations=STATIONS) as found:
        names = [v.name for v in found[1].modelVariables if v.causality == "output"]
        plain, same = Slave(*found), Slave(*found, **{"b.start_position": (0, 60, 0)})
        back = Slave(*found, begin=False)
        back.fmu.setupExperiment()
        back.set("b.start_position[2]", 70.0)
        assert back.get("b.position[2]") == 70.0
        assert back.get("port.tension.start") != plain.get("port.tension.start")
        back.set("b.start_position[2]", 60.0)
        back.fmu.enterInitializationMode()
        back.fmu.exitInitializationMode()
        for _ in range(2):
            for slave in (same, back):
                np.testing.assert_array_equal(numbers_of(slave, names), numbers_of(plain, names))
            for slave in (plain, same, back):
                slave.step(0.5)
        for slave in (plain, same, back):
            slave.close()


def test_nothing_is_set_where_there_are_no_vessels(tmp_path: Path) -> None:
    scene = cm.load_system(SCENES / "buoy_on_three_legs.yaml")
    with unpacked(scene, tmp_path, stations=STATIONS) as (_, about):
        assert not [v.name for v in about.modelVariables if ".start_" in v.name]


def test_what_the_description_says(tmp_path: Path) -> None:
    with unpacked(two_ships(), tmp_path, stations=STATIONS) as (_, about):
        rows = [v for v in about.modelVariables if ".start_" in v.name]
        assert [v.name for v in rows[9:]] == [
            f"b.start_{what}[{i}]"
            for what in ("position", "velocity", "attitude")
            for i in (1, 2, 3)
        ]
        assert [v.valueReference for v in rows] == list(range(FIRST, FIRST + 18))
        assert {(v.causality, v.variability, v.initial) for v in rows} == {
            ("parameter", "fixed", "exact")
        }
        assert [v.unit for v in rows[::3]] == ["m", "m/s", "rad"] * 2
        assert [float(v.start) for v in rows] == [0] * 3 + [1, 0, 0] + [0] * 3 + [0, 60, 0, 1] + [
            0
        ] * 5
        output = next(u for u in about.initialUnknowns if u.variable.name == "net.position[1]")
        assert {v.name for v in output.dependencies} >= {v.name for v in rows}


def refused(slave: Slave, words: str) -> None:
    with pytest.raises(FMICallException):
        slave.fmu.exitInitializationMode()
    assert slave.messages[-1][0] == 3
    assert words in slave.messages[-1][1]


def test_what_has_no_steady_state_is_refused_and_may_be_set_again(tmp_path: Path) -> None:
    scene = two_ships()
    with pytest.raises(cm.SceneError, match="there is no steady state"):
        SystemModel(begun(scene, {"a": {"velocity": [2, 0, 0]}}))
    with unpacked(scene, tmp_path, stations=STATIONS) as found:
        names = [v.name for v in found[1].modelVariables if v.causality == "output"]
        slave, plain = Slave(*found, begin=False), Slave(*found)
        slave.fmu.setupExperiment()
        slave.set("a.start_velocity[1]", 2.0)
        slave.fmu.enterInitializationMode()
        refused(slave, "b.start_velocity is not that of a: there is no steady state")
        slave.set("b.start_velocity[1]", 2.0)
        slave.set("b.start_position[2]", 9e6)
        refused(slave, "no static equilibrium was found at this start: export the scene with it")
        with pytest.raises(FMICallException):
            slave.set("b.start_position[2]", 2e7)
        assert "out of range" in slave.messages[-1][1]
        slave.set("b.start_position[2]", 70.0)
        slave.fmu.exitInitializationMode()
        np.testing.assert_array_equal(slave.get("a.velocity_input"), [2, 0, 0])
        with pytest.raises(FMICallException):
            slave.set("b.start_position[2]", 60.0)
        assert "a start is fixed" in slave.messages[-1][1]
        slave.step(0.5)
        slave.begin_again()
        np.testing.assert_array_equal(numbers_of(slave, names), numbers_of(plain, names))
        np.testing.assert_array_equal(slave.get("a.velocity_input"), [1, 0, 0])
        slave.close()
        plain.close()


def test_an_anchored_system_starts_at_rest(tmp_path: Path) -> None:
    with unpacked(moored(), tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, begin=False)
        slave.fmu.setupExperiment()
        slave.set("ship.start_velocity[1]", 0.5)
        slave.fmu.enterInitializationMode()
        refused(slave, "ship.start_velocity must be 0")
        slave.close()


def standing() -> cm.SystemScene:
    """A load on the sea floor, on a wire of a ship."""
    data = still(cuts={}).to_dict()
    data["environment"]["floor"] = {"z": -15.0, "friction": 0.5}
    data["bodies"]["load"].update(position=[5, 0, -15], feet=[[0, 0, 0]])
    return cm.load_system(data)


def test_where_friction_holds_a_body_the_start_is_the_scenes(tmp_path: Path) -> None:
    with unpacked(standing(), tmp_path, stations=STATIONS) as (place, about):
        variable = next(v for v in about.modelVariables if v.name == "ship.start_position[1]")
        assert float(variable.min) == float(variable.max) == 0.0
        slave = Slave(place, about, begin=False)
        slave.set("ship.start_position[1]", 0.0)
        with pytest.raises(FMICallException):
            slave.set("ship.start_position[1]", 1.0)
        assert "friction holds bodies" in slave.messages[-1][1]
        slave.close()


@pytest.mark.parametrize(("counted", "warned"), [(("tow", "port", "starboard"), 1), (("tow",), 0)])
def test_a_start_that_bends_more_than_elements_follow_is_warned_of(
    counted: tuple[str, ...], warned: int, tmp_path: Path
) -> None:
    """A tug that crabs by 20 degrees hangs on one leg of its bridle; the other one is slack. Where
    the scene counts a line's elements they stay."""
    data = cm.load_system(SCENES / "bridle_tow.yaml").to_dict()
    for name in counted:
        data["lines"][name]["items"][0]["cable"]["elements"] = 8
    with unpacked(cm.load_system(data), tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, **{"tug.start_attitude": (0, 0, 0.35)})
        assert [status for status, _ in slave.messages] == [1] * warned
        assert all("the line bends" in said for _, said in slave.messages)
        slave.close()


def test_a_start_that_stretches_lines_is_warned_of(tmp_path: Path) -> None:
    """Two lines of 60 m with a net of 1 m between them, from ship to ship."""
    with unpacked(two_ships(), tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, **{"b.start_position": (0, 121.5, 0)})
        assert slave.messages == []
        slave.close()
        slave = Slave(*found, **{"b.start_position": (0, 151, 0)})
        assert [status for status, _ in slave.messages] == [1]
        words = slave.messages[0][1].split("at this start a line is stretched by ")[1].split()
        assert float(words[0]) == pytest.approx(25.0, abs=0.5)
        assert words[1:3] == ["per", "cent:"]  # a percent sign would be a format to the logger
        slave.close()


def test_angles_of_a_start_that_look_like_degrees_are_asked_about(tmp_path: Path) -> None:
    with unpacked(two_ships(), tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, **{"b.start_attitude": (0, 0, -6.2)})
        assert slave.messages == []
        slave.close()
        slave = Slave(*found, **{"b.start_attitude": (0, 0, 90)})
        assert [status for status, _ in slave.messages] == [1]
        asked = "b.start_attitude[3] is 90 rad, more than a turn: was it meant in degrees?"
        assert asked in slave.messages[0][1]
        slave.close()


@pytest.mark.parametrize("by", [1, 2, 3])
def test_a_vessel_is_driven_from_where_it_begins(by: int, tmp_path: Path) -> None:
    """Without a jump, by velocity, place or both; one that nothing drives goes straight on."""
    scene = two_ships()
    model = SystemModel(begun(scene, FASTER))
    with unpacked(scene, tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, **{"b.input": by}, **named(FASTER))
        for k in range(1, 5):
            speed = np.array([1.1 + 0.05 * k, 0.1, 0.0])
            where = np.array([3, 55, 0]) + 0.5 * k * np.array([1.1 + 0.025 * k, 0.1, 0.0])
            given = {1: ["velocity"], 2: ["position"], 3: ["velocity", "position"]}[by]
            inputs = {name: {"velocity": speed, "position": where}[name] for name in given}
            for name, value in inputs.items():
                slave.set(f"b.{name}_input", value)
            slave.step(0.5)
            model.step(0.5, vessels={"b": cm.VesselInput(**inputs)})
            assert max(promised(slave, model)) < 1.0
        np.testing.assert_allclose(slave.get("a.position"), [2.2, 0.2, 0.0], atol=1e-12)
        np.testing.assert_allclose(slave.get("b.position"), model.vessels["b"].position, atol=1e-9)
        assert slave.messages == []
        slave.close()


def test_a_jump_is_told_from_the_start_that_was_set(tmp_path: Path) -> None:
    with unpacked(two_ships(), tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, **{"b.input": 2, "b.start_position": (0, 70, 0)})
        slave.set("b.position_input", [0, 60, 0])
        slave.step(0.5)
        assert "it begins at (0, 70, 0); set b.start_position" in slave.messages[0][1]
        slave.close()


def test_states_after_such_a_start_roll_back_and_travel(tmp_path: Path) -> None:
    """To an instance that began at the scene's own start, and to one that is not initialised."""
    starts = {"b.start_position": (3, 70, 0), "a.start_velocity": (1.1, 0, 0),
              "b.start_velocity": (1.1, 0, 0)}  # fmt: skip
    with unpacked(two_ships(), tmp_path, stations=STATIONS) as found:
        names = [v.name for v in found[1].modelVariables if v.causality == "output"]
        slave, other = Slave(*found, begin=False), Slave(*found)
        slave.fmu.setupExperiment()
        slave.fmu.enterInitializationMode()
        for name, value in starts.items():
            slave.set(name, value)
        early = slave.fmu.serializeFMUstate(slave.fmu.getFMUstate())
        slave.fmu.exitInitializationMode()

        def on(to: Slave) -> list[list[float]]:
            seen = [numbers_of(to, names)]
            for _ in range(3):
                to.step(0.5)
                seen.append(numbers_of(to, names))
            to.time -= 1.5
            return seen

        state = slave.fmu.serializeFMUstate(slave.fmu.getFMUstate())
        once = on(slave)
        other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(state))
        np.testing.assert_array_equal(on(other), once)
        np.testing.assert_array_equal(other.get("b.start_position"), [3, 70, 0])
        slave.fmu.setFMUstate(slave.fmu.deSerializeFMUstate(early))
        slave.fmu.exitInitializationMode()
        np.testing.assert_array_equal(on(slave), once)
        slave.close()
        other.close()


def test_errors_are_estimated_from_the_same_start(tmp_path: Path) -> None:
    """Else the estimate would be how far it was moved."""
    scene = two_ships(solver={"error_estimate": True})
    starts = {"b": {"position": [0, 70, 0]}}
    model = SystemModel(begun(scene, starts))
    with unpacked(scene, tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, **named(starts))
        for _ in range(3):
            for name, errors in model.errors.items():
                told = slave.get(f"{name}.error.position")
                assert told == pytest.approx(errors.position, rel=0.02, abs=1e-6)
            slave.step(0.5)
            model.step(0.5)
        slave.close()


def test_a_winch_runs_from_such_a_start(tmp_path: Path) -> None:
    """All cable of its line runs, of whatever type."""
    data = still(cuts={}).to_dict()
    data["cable_types"]["rope"] = {"diameter": 0.02, "mass": 0.4, "axial_stiffness": 2e5}
    data["lines"]["wire"]["items"] = [
        {"cable": {"type": name, "length": 10, "elements": 4}} for name in ("wire", "rope")
    ]
    data["winches"] = {"hoist": {"line": "wire", "drum": 5.0, "rate": 0.2}}
    scene = cm.load_system(data)
    starts = {"ship": {"attitude": [0.0, 0.1, 0.3]}}
    model = SystemModel(begun(scene, starts))
    with unpacked(scene, tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, **named(starts))
        for _ in range(4):
            np.testing.assert_allclose(slave.get("load.velocity"), model.bodies["load"].velocity,
                                       atol=1e-3)  # fmt: skip
            assert max(promised(slave, model)) < 1.0
            slave.step(0.5)
            model.step(0.5)
        slave.close()


def test_a_log_holds_the_scenes_own_start(tmp_path: Path) -> None:
    with unpacked(two_ships(), tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, **{"b.start_position": (0, 70, 0)})
        with FmuLog(tmp_path / "cable.fmu", tmp_path / "cable.mcap") as log:
            recorder = type("Recorder", (), {"fmu": slave.fmu})
            with pytest.raises(cm.CableModelError, match=r"b\.start_position\[2\] is 70"):
                log(0.0, recorder)
        slave.close()


# -- coefficients ----------------------------------------------------------------------------------


def weighted() -> cm.SystemScene:
    """A load on a wire below a ship, with a weight and another body in the wire."""
    data = still(cuts={}).to_dict()
    bodies = [{"mass": mass, "submerged_weight": 0.8 * 9.81 * mass, "drag_area": 0.1,
               "drag_coefficient": 1.0} for mass in (20.0, 30.0)]  # fmt: skip
    data["environment"] = {"current": {"table": [{"z": 0, "velocity": [0.5, 0.1, 0]}]}}
    data["lines"]["wire"]["items"] = [
        {"cable": {"type": "wire", "length": 10}},
        {"body": bodies[0]},
        {"cable": {"type": "wire", "length": 10}},
        {"body": bodies[1]},
        {"cable": {"type": "wire", "length": 5}},
    ]
    return cm.load_system(data)


WEIGHTED = {
    "cable_types.wire.drag_normal": 1.9, "cable_types.wire.submerged_weight": 6.0,
    "wire.body[1].submerged_weight": 90.0, "wire.body[2].drag_coefficient": 2.5,
    "load.submerged_weight": 1100.0, "load.drag_area": (1.5, 1.5, 1.0),
}  # fmt: skip


def reweighted() -> cm.SystemScene:
    data = weighted().to_dict()
    data["cable_types"]["wire"].update(drag_normal=1.9, submerged_weight=6.0)
    data["lines"]["wire"]["items"][1]["body"]["submerged_weight"] = 90.0
    data["lines"]["wire"]["items"][3]["body"]["drag_coefficient"] = 2.5
    data["bodies"]["load"].update(submerged_weight=1100.0, drag_area=[1.5, 1.5, 1.0])
    return cm.load_system(data)


def legs(**chain: float) -> cm.SystemScene:
    """A buoy on chains: no vessel."""
    data = cm.load_system(SCENES / "buoy_on_three_legs.yaml").to_dict()
    data["cable_types"]["chain"].update(chain)
    return cm.load_system(data)


@pytest.mark.parametrize(
    ("scene", "wanted", "values"),
    [
        (weighted, reweighted, WEIGHTED),
        (
            weighted,
            lambda: begun(reweighted(), {"ship": {"position": [5, 0, 0], "velocity": [1, 0, 0]}}),
            {**WEIGHTED, "ship.start_position": (5, 0, 0), "ship.start_velocity": (1, 0, 0)},
        ),
        (
            legs,
            lambda: legs(submerged_weight=250.0, drag_normal=1.5),
            {"cable_types.chain.submerged_weight": 250.0, "cable_types.chain.drag_normal": 1.5},
        ),
    ],
    ids=["bodies", "and a start", "chains on the floor"],
)
def test_coefficients_before_the_start_are_as_in_the_scene(
    scene: Any, wanted: Any, values: dict[str, Any], tmp_path: Path
) -> None:
    model = SystemModel(wanted())
    with unpacked(scene(), tmp_path, stations=STATIONS) as found:
        slave, plain = Slave(*found, use_scene_inputs=True, **values), Slave(*found)
        assert max(promised(plain, model)) > 1.0
        for _ in range(6):
            assert max(promised(slave, model)) < 1.0
            slave.step(0.5)
            model.step(0.5)
        for name, value in values.items():
            np.testing.assert_array_equal(slave.get(name), value)
        slave.fmu.reset()
        line = next(iter(model.lines))
        assert slave.get(f"{line}.tension.start") == plain.get(f"{line}.tension.start")
        slave.close()
        plain.close()


def test_a_coefficient_may_change_in_a_run(tmp_path: Path) -> None:
    """It comes to where it would have begun; a state has the value, and a finer run."""
    with unpacked(two_ships(solver={"error_estimate": True}), tmp_path, stations=2) as found:
        slave, begun_so = Slave(*found), Slave(*found, **{"net.drag_area": (3, 3, 3)})
        slave.step(0.5)
        first = slave.get("net.position")
        slave.set("net.drag_area", (3, 3, 3))
        state = slave.fmu.serializeFMUstate(slave.fmu.getFMUstate())
        other = Slave(*found)
        other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(state))
        other.time = 0.5
        np.testing.assert_array_equal(other.get("net.drag_area"), 3.0)
        for one in (slave, other):
            one.step(299.5)
        wanted = begun_so.get("net.position") + np.array([300.0, 0, 0])
        assert np.linalg.norm(first + np.array([299.5, 0, 0]) - wanted) > 1.0
        assert np.linalg.norm(slave.get("net.position") - wanted) < 1e-3 * 60
        assert slave.get("net.error.position") < 1e-3 * 60
        np.testing.assert_array_equal(other.get("net.position"), slave.get("net.position"))
        with pytest.raises(FMICallException):
            slave.set("net.drag_area[1]", -1.0)
        assert "net.drag_area[1]" in slave.messages[-1][1]
        for one in (slave, other, begun_so):
            one.close()


def test_where_friction_holds_a_body_coefficients_change_after_the_start(tmp_path: Path) -> None:
    with unpacked(standing(), tmp_path, stations=STATIONS) as found:
        assert "load.submerged_weight" not in [v.name for v in found[1].modelVariables]
        slave = Slave(*found, begin=False)
        slave.fmu.setupExperiment()
        own = slave.get("cable_types.wire.drag_normal")
        slave.set("cable_types.wire.drag_normal", 2.0)
        slave.fmu.enterInitializationMode()
        refused(slave, "cable_types.wire.drag_normal is not the scene's")
        slave.set("cable_types.wire.drag_normal", own)
        slave.fmu.exitInitializationMode()
        slave.set("cable_types.wire.drag_normal", 2.0)
        slave.step(0.5)
        slave.close()
