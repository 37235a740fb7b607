"""What a coupling may use of a system's FMU: sizes and limits, derivatives of forces and moments on
vessels by time and by their motion, a log of its run. (Masters: test_fmu_system_masters.py.)"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy import simulate_fmu
from fmpy.fmi1 import FMICallException
from fmu_tools import Slave, unpacked

import cablemodel as cm
from cablemodel.results.replay import replay
from cablemodel_fmu.export import ExportError, export_fmu
from cablemodel_fmu.recording import FmuLog

WIRE = {"wire": {"diameter": 0.02, "mass": 1.6, "axial_stiffness": 2e6, "bending_stiffness": 50.0}}
CAGE = Path(__file__).parents[2] / "scenes" / "systems" / "cage_and_vehicle.yaml"
MOTIONS = {1: ["velocity", "attitude_rate"], 2: ["position", "attitude"]}
"""Inputs of a vessel that are set, by what moves it."""


def wire(length: float) -> dict[str, Any]:
    return {"cable": {"type": "wire", "length": length}}


def moored(**changes: Any) -> cm.SystemScene:
    """A ship on a taut line from its bow to an anchor, and on another one to a barge: both lines
    pull beside the ship's origin."""
    data: dict[str, Any] = {
        "cable_types": WIRE,
        "vessels": {
            "ship": {"points": {"bow": [5, 1, 0], "stern": [-5, -1, 0]}},
            "barge": {"points": {"eye": [0, 0, 0]}, "position": [0, 40, 0]},
        },
        "lines": {
            "head": {"from": "ship.bow", "to": {"anchor": [104.9, 0, -1]}, "items": [wire(99.5)]},
            "side": {"from": "ship.stern", "to": "barge.eye", "items": [wire(41)]},
        },
        "run": {"duration": 20, "output_interval": 0.1},
    }  # fmt: skip
    data.update(changes)
    return cm.load_system(data)


def lifted() -> cm.SystemScene:
    """A load on the two legs of a bridle, which close a cycle, below a ship; a winch and a cut."""
    data: dict[str, Any] = {
        "cable_types": WIRE,
        "vessels": {"ship": {"points": {"hook": [1, 0, 0], "aft": [-8, 0, 0]}}},
        "bodies": {
            "load": {
                "mass": 2000, "submerged_weight": 15000, "inertia": 500, "drag_area": 1,
                "points": {"left": [1, 0, 0.5], "right": [-1, 0, 0.5]}, "position": [-3.5, 0, -25],
                "foils": {"wing": {"area": 0.5, "position": [0.2, 0, 0]}},
            },
        },
        "lines": {
            "left": {"from": "ship.hook", "to": "load.left", "items": [wire(24)]},
            "right": {"from": "ship.aft", "to": "load.right", "items": [wire(24)]},
        },
        "winches": {"drum": {"line": "left", "drum": 10}},
        "cuts": {"knife": {"line": "right", "at": 12.0}},
        "run": {"duration": 10, "output_interval": 0.5},
    }  # fmt: skip
    return cm.load_system(data)


def folder_in(folder: Path, name: str) -> Path:
    """A new folder in another one."""
    (folder / name).mkdir()
    return folder / name


@pytest.fixture(scope="module")
def taut(tmp_path_factory: pytest.TempPathFactory) -> Any:
    with unpacked(moored(), tmp_path_factory.mktemp("fmu"), stations=3) as found:
        yield found


@pytest.fixture(scope="module")
def bridle(tmp_path_factory: pytest.TempPathFactory) -> Any:
    with unpacked(lifted(), tmp_path_factory.mktemp("fmu"), stations=3) as found:
        yield found


# -- what the description says ---------------------------------------------------------------------


def test_sizes_units_and_limits(bridle: Any) -> None:
    """Every real variable has a nominal value, and every input limits that hold."""
    _, description = bridle
    variables = {v.name: v for v in description.modelVariables}
    reals = [v for v in variables.values() if v.type == "Real"]
    assert all(v.nominal and float(v.nominal) > 0.0 for v in reals if v.unit != "1")
    assert 1e3 < float(variables["ship.force[1]"].nominal) < 1e5
    arm = float(variables["ship.moment[1]"].nominal) / float(variables["ship.force[1]"].nominal)
    assert 4.0 < arm < 16.0  # one digit each of a tension, and of that at 8 m
    shown = {
        "ship.velocity_input[1]": "kn",
        "ship.attitude_input[3]": "deg",
        "ship.attitude_rate_input[1]": "deg/s",
        "load.wing.deflection": "deg",
        "load.attitude[1]": "deg",
        "ship.force[3]": "kN",
        "ship.moment[2]": "kN.m",
        "left.tension.start": "kN",
    }
    assert {name: variables[name].displayUnit for name in shown} == shown
    slave = Slave(*bridle)
    driven = [v for v in reals if v.causality == "input"]
    assert len(driven) == 12 + 6 + 1 + 1 + 1
    for variable in driven:
        for limit in (float(variable.min), float(variable.max)):
            slave.set(variable.name, limit)
            with pytest.raises(FMICallException):
                slave.set(variable.name, 1.001 * limit)
            assert slave.messages[-1][1].startswith(f"fmi2SetReal: {variable.name} (")
            assert "out of range" in slave.messages[-1][1]
        with pytest.raises(FMICallException):
            slave.set(variable.name, float("nan"))
        assert variable.name in slave.messages[-1][1]
    slave.close()


# -- derivatives -----------------------------------------------------------------------------------


def motion_at(t: float) -> dict[str, np.ndarray]:
    """The ship's motion from rest: place, attitude and their rates."""
    place, turn = np.array([1, 0.3, 0.5]), np.array([1, 0.5, 1])
    return {
        "position": 0.1 * (1 - np.cos(t)) * place,
        "velocity": 0.1 * np.sin(t) * place,
        "attitude": 0.03 * (1 - np.cos(0.7 * t)) * turn,
        "attitude_rate": 0.021 * np.sin(0.7 * t) * turn,
    }


def put(slave: Slave, names: list[str], t: float) -> None:
    motion = motion_at(t)
    for name in names:
        slave.set(f"ship.{name}_input", motion[name])


def wrench_references(slave: Slave) -> list[int]:
    """Of the ship's force and moment, and of the barge's force, where there is one."""
    names = [f"{part}[{i}]" for part in ("ship.force", "ship.moment", "barge.force")
             for i in (1, 2, 3)]  # fmt: skip
    return [slave.references[name].valueReference for name in names if name in slave.references]


def wrenches(slave: Slave) -> np.ndarray:
    return np.array(slave.fmu.getReal(wrench_references(slave)))


def rates(slave: Slave) -> np.ndarray:
    references = wrench_references(slave)
    return np.array(slave.fmu.getRealOutputDerivatives(references, [1] * len(references)))


def by_motion(slave: Slave, name: str) -> np.ndarray:
    """Rows: components of forces and moment, columns: components of an input of the ship."""
    unknown = wrench_references(slave)
    known = [slave.references[f"ship.{name}_input[{i}]"].valueReference for i in (1, 2, 3)]
    return np.array([slave.fmu.getDirectionalDerivative(unknown, [k], [1.0]) for k in known]).T


def assert_near(found: np.ndarray, expected: np.ndarray, share: float) -> None:
    """Forces within a share of the largest one, and moments."""
    for row in range(0, len(found), 3):
        part = expected[row : row + 3]
        np.testing.assert_allclose(found[row : row + 3], part, atol=share * np.abs(part).max())


@pytest.mark.parametrize("fmu", ["taut", "bridle"])
@pytest.mark.parametrize("dt", [0.1, 0.5])
def test_the_rate_of_forces_and_moments(request: Any, fmu: str, dt: float) -> None:
    """Against the difference over a quarter of a step that goes on with the motion."""
    slave = Slave(*request.getfixturevalue(fmu))
    for n in range(1, 41):
        put(slave, MOTIONS[1], n * dt)
        slave.step(dt)
    state = slave.fmu.getFMUstate()
    rate, now = rates(slave), wrenches(slave)
    last, before = motion_at(40 * dt), motion_at(39 * dt)
    for name in MOTIONS[1]:
        slave.set(f"ship.{name}_input", last[name] + 0.25 * (last[name] - before[name]))
    slave.step(dt / 4)
    assert_near(rate, (wrenches(slave) - now) / (dt / 4), 1e-4)
    slave.fmu.setFMUstate(state)
    assert rates(slave).tobytes() == rate.tobytes()
    slave.close()


@pytest.mark.parametrize("dt", [0.1, 0.5])
def test_the_rate_where_a_line_is_slack(tmp_path: Path, dt: float) -> None:
    """Of a ship that the waves move and a driven end on a slack tether: to the bit."""
    with unpacked(cm.load_system(CAGE), tmp_path, stations=2) as found:
        slave = Slave(*found)
        for _ in range(30):
            slave.step(dt)
        references = [slave.references[f"{part}.force[{i}]"].valueReference
                      for part in ("ship", "vehicle") for i in (1, 2, 3)]  # fmt: skip
        rate = slave.fmu.getRealOutputDerivatives(references, [1] * len(references))
        now = np.array(slave.fmu.getReal(references))
        slave.step(dt / 4)
        later = np.array(slave.fmu.getReal(references))
        np.testing.assert_array_equal(rate, (later - now) / (dt / 4))
        assert np.abs(rate).max() > 100.0
        slave.close()


def test_the_rate_does_not_foresee_a_cut(tmp_path: Path) -> None:
    """One that comes within the time that is looked ahead."""
    cuts = {"weak": {"line": "side", "at": "start", "time": 1.01}}
    with (
        unpacked(moored(), folder_in(tmp_path, "whole"), stations=2) as whole,
        unpacked(moored(cuts=cuts), folder_in(tmp_path, "cut"), stations=2) as cut,
    ):
        found = []
        for place in (whole, cut):
            slave = Slave(*place)
            for n in range(1, 11):
                put(slave, MOTIONS[1], 0.1 * n)
                slave.step(0.1)
            found.append(rates(slave))
            slave.close()
    assert_near(found[1], found[0], 1e-2)


@pytest.mark.parametrize(("how", "dt"), [(1, 0.1), (1, 0.5), (2, 0.5)])
@pytest.mark.parametrize("timing", [1, 2])
def test_forces_and_moments_by_the_motion_of_the_last_step(
    taut: Any, how: int, dt: float, timing: int
) -> None:
    """Against steps that are made again with another value; of the barge, too, which the ship
    pulls at."""
    slave = Slave(*taut, **{"ship.input": how, "input.timing": timing})
    for n in range(1, 40):
        put(slave, MOTIONS[how], (n - timing + 1) * dt)
        state, begin = slave.fmu.getFMUstate(), slave.time
        slave.step(dt)
    found = [by_motion(slave, name) for name in MOTIONS[how]]
    small, value = 1e-4, motion_at((39 - timing + 1) * dt)
    for name, matrix in zip(MOTIONS[how], found, strict=True):
        again = []
        for axis in np.eye(3):
            sides = []
            for side in (-small, small):
                slave.fmu.setFMUstate(state)
                slave.time = begin
                put(slave, MOTIONS[how], (39 - timing + 1) * dt)
                slave.set(f"ship.{name}_input", value[name] + side * axis)
                slave.step(dt)
                sides.append(wrenches(slave))
            again.append((sides[1] - sides[0]) / (2 * small))
        assert_near(matrix, np.array(again).T, 0.25)
    told = [text for _, text in slave.messages if "elsewhere drive by velocity" in text]
    assert len(told) == (how != 1)  # once
    assert found[0][0, 0] < -400.0
    slave.close()


def test_what_is_asked_changes_nothing(bridle: Any) -> None:
    """Derivatives work on a copy: the run goes on bit by bit; and they are those of the state, in
    another instance too."""
    asked, plain = Slave(*bridle), Slave(*bridle)
    for n in range(1, 6):
        found = []
        for slave in (asked, plain):
            put(slave, MOTIONS[1], 0.2 * n)
            slave.set("drum.rate", 0.1)
            slave.set("load.force_input", [50.0 * n, 0, 0])
            slave.step(0.2)
            if slave is asked:
                found = [rates(slave), *(by_motion(slave, name) for name in MOTIONS[1])]
    states = [s.fmu.serializeFMUstate(s.fmu.getFMUstate()) for s in (asked, plain)]
    np.testing.assert_array_equal(wrenches(asked), wrenches(plain))
    other = Slave(*bridle)
    other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(states[1]))
    again = [rates(other), *(by_motion(other, name) for name in MOTIONS[1])]
    for one, two in zip(found, again, strict=True):
        np.testing.assert_array_equal(one, two)
    for slave in (asked, plain):
        put(slave, MOTIONS[1], 1.3)
        slave.step(0.3)
    np.testing.assert_array_equal(wrenches(asked), wrenches(plain))
    for slave in (asked, plain, other):
        slave.close()


def test_directions_add_up(taut: Any) -> None:
    slave = Slave(*taut)
    for n in range(1, 11):
        put(slave, MOTIONS[1], 0.1 * n)
        slave.step(0.1)
    known = [slave.references[f"ship.{name}_input[{i}]"].valueReference
             for name in MOTIONS[1] for i in (1, 2, 3)]  # fmt: skip
    direction = [0.5, -1.0, 2.0, 0.1, -0.2, 0.05]
    both = slave.fmu.getDirectionalDerivative(wrench_references(slave), known, direction)
    matrix = np.hstack([by_motion(slave, name) for name in MOTIONS[1]])
    assert_near(np.array(both), matrix @ direction, 1e-5)
    slave.close()


def test_what_has_no_derivatives(taut: Any) -> None:
    slave = Slave(*taut)
    fmu, reference = slave.fmu, {n: v.valueReference for n, v in slave.references.items()}
    force, speed = [reference["ship.force[1]"]], [reference["ship.velocity_input[1]"]]
    tension = [reference["head.tension.start"]]
    assert not rates(slave).any()  # at rest
    for words, call, arguments in (
        ("before the first step", fmu.getDirectionalDerivative, (force, speed, [1.0])),
        ("order 2, not 1", fmu.getRealOutputDerivatives, (force, [2])),
        ("forces and moments on vessels", fmu.getRealOutputDerivatives, (tension, [1])),
        ("forces and moments on vessels", fmu.getDirectionalDerivative, (tension, speed, [1.0])),
        ("inputs that move vessels", fmu.getDirectionalDerivative, (force, tension, [1.0])),
        ("not finite", fmu.getDirectionalDerivative, (force, speed, [float("nan")])),
    ):
        slave.messages.clear()
        with pytest.raises(FMICallException):
            call(*arguments)
        assert words in slave.messages[0][1]
    slave.step(0.1)
    assert by_motion(slave, "velocity").any()
    assert not by_motion(slave, "position").any()  # it is moved by velocities
    slave.close()
    slave = Slave(*taut, use_scene_inputs=True)
    slave.step(0.1)
    assert not by_motion(slave, "velocity").any()  # the scene moves it
    slave.close()


def swing(slave: Slave, newton: bool) -> np.ndarray:
    """Speeds of a ship of 5 t at the end of a taut line of 1e4 N/m, coupled as in
    examples/taut_line.py: with the force of the step before, or solved for with that at its end."""
    mass, dt = 5000.0, 0.1
    known = [slave.references["ship.velocity_input[1]"].valueReference]
    unknown = [slave.references["ship.force[1]"].valueReference]
    force = slave.get("ship.force")[0]
    thrust, speed, gain, speeds = -force, 0.01, 0.0, []
    for _ in range(300):
        state, begin = slave.fmu.getFMUstate(), slave.time
        slave.set("ship.velocity_input", [speed + (gain if newton else 0.0), 0, 0])
        slave.step(dt)
        end = slave.get("ship.force")[0]
        new = speed + dt * (thrust + force) / mass
        if newton:
            (slope,) = slave.fmu.getDirectionalDerivative(unknown, known, [1.0])
            pull = thrust + 0.5 * (force + end - slope * (speed + gain))
            new = (mass * speed / dt + pull) / (mass / dt - 0.5 * slope)
            slave.fmu.setFMUstate(state)
            slave.time = begin
            slave.set("ship.velocity_input", [new, 0, 0])
            slave.step(dt)
            end = slave.get("ship.force")[0]
        slave.fmu.freeFMUstate(state)
        gain, speed, force = new - speed, new, end
        speeds.append(speed)
    return np.abs(speeds)


def test_a_taut_line_does_not_drive_the_vessel(tmp_path: Path) -> None:
    """It does where both hold what they got, by 1.5 k H / 2 m; not with Newton's method."""
    rope = {"diameter": 0.02, "mass": 0.3, "axial_stiffness": 1e6, "bending_stiffness": 0.1}
    line = {
        "from": "ship.hook",
        "to": {"anchor": [101, 0, 0]},
        "items": [{"cable": {"type": "rope", "length": 100}}],
    }
    scene = moored(
        cable_types={"rope": rope},
        vessels={"ship": {"points": {"hook": [0, 0, 0]}}},
        lines={"tow": line},
    )
    with unpacked(scene, tmp_path, stations=2) as found:
        growth = []
        for newton in (False, True):
            slave = Slave(*found)
            speeds = swing(slave, newton)
            growth.append(np.log(speeds[-44:].max() / speeds[:44].max()) / 25.6)
            slave.close()
    assert growth[0] == pytest.approx(1.5 * 1e4 * 0.1 / (2 * 5000), rel=0.1)
    assert growth[1] < 1e-4


# -- a log --------------------------------------------------------------------


def test_a_system_without_vessels_has_none_to_connect(tmp_path: Path) -> None:
    line = {"from": {"anchor": [0, 0, 0]}, "to": {"anchor": [30, 0, 0]}, "items": [wire(31)]}
    scene = moored(vessels={}, lines={"span": line})
    with pytest.raises(ExportError, match="no vessels"):
        export_fmu(scene, tmp_path / "a.fmu", ssp=tmp_path / "a.ssp")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("driven", [False, True])
def test_a_log_replays_to_the_last_bit(tmp_path: Path, driven: bool) -> None:
    """Where nothing is connected, and where all that there is drives: vessel, body, foil, winch,
    cut."""
    fmu = export_fmu(lifted(), tmp_path / "a.fmu", platforms=["linux64"], stations=3)
    time = np.arange(0.0, 10.25, 0.5)
    columns = {
        "ship.velocity_input[1]": 0.2 * np.sin(0.5 * time),
        "ship.attitude_rate_input[3]": 0.01 * np.sin(0.4 * time),
        "load.force_input[2]": np.where(time < 6, 200.0, 0.0),
        "load.torque_input[3]": 20.0 * np.sin(time),
        "load.wing.deflection": 0.1 * np.sin(0.3 * time),
        "drum.rate": np.where(time < 4, 0.2, 0.0),
        "knife.cut": np.where(time < 7, 0.0, 1.0),
    }
    series = np.zeros(len(time), dtype=[("time", float), *((name, float) for name in columns)])
    series["time"] = time
    for name, values in columns.items():
        series[name] = values
    with FmuLog(fmu, tmp_path / "run.mcap") as log:
        result = simulate_fmu(
            str(fmu), stop_time=10, output_interval=0.5, step_finished=log,
            input=series if driven else None,
        )  # fmt: skip
    run = cm.open_run(tmp_path / "run.mcap")
    assert run.complete
    np.testing.assert_array_equal(run["ship.force"][:, 2], result["ship.force[3]"])
    np.testing.assert_array_equal(run["load.position"][:, 0], result["load.position[1]"])
    assert (run["knife.time"][-1] == 7.0) == driven
    found = replay(run)
    assert found.expected_exact
    assert found.exact, found.differences
