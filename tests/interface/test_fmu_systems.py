"""Systems in an FMU: the same bits as in Python, states, refusals."""

from __future__ import annotations

import copy
import math
import shutil
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy import read_model_description
from fmpy.fmi1 import FMICallException
from fmpy.validation import validate_fmu
from fmu_tools import Slave, sealed, unpacked
from typer.testing import CliRunner

import cablemodel as cm
from cablemodel.cli.app import app
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header
from cablemodel.systems import SystemModel
from cablemodel.variables import LINE_FLOOR, outputs_of
from cablemodel_fmu.export import ExportError, contents_of, export_fmu
from cablemodel_fmu.export import Options as ExportOptions
from cablemodel_fmu.file_records import FileHeader, Parameter

STATIONS = 5
JOBS = Path(__file__).parents[2] / "docs" / "jobs"
SCENES = sorted((Path(__file__).parents[2] / "scenes" / "systems").glob("*.yaml"))


def wire(length: float, **more: Any) -> dict[str, Any]:
    return {"cable": {"type": "wire", "length": length, **more}}


def tow() -> cm.SystemScene:
    """A plate with a foil and a tail behind a tug on a turning path, which the waves move, and a
    load on a crane's line, which is clamped to both and told from its lower end; what can be cut,
    and what comes off at its time."""
    data: dict[str, Any] = {
        "title": "Bridle",
        "cable_types": {
            "wire": {
                "diameter": 0.02, "mass": 1.6, "axial_stiffness": 2e7, "bending_stiffness": 50.0,
            }
        },
        "environment": {
            "current": {"table": [{"z": 0, "velocity": [0.1, 0.05, 0]}]},
            "waves": {"regular": {"height": 1.0, "period": 6.0}, "ramp": 3.0},
        },
        "vessels": {
            "tug": {
                "points": {"port": [-18, 5, 2]},
                "path": [{"straight": {"duration": 1, "speed": 2, "heading": 0}},
                         {"turn": {"angle": "30 deg", "radius": 30, "speed": 2}}],
                "raos": [{"heading_deg": 0, "period": 6, "heave": 0.5, "roll_deg": 2}],
            },
            "crane": {"points": {"tip": [0, 0, 0]}, "position": [0, 60, 3],
                      "velocity": [2, 0, 0]},
        },
        "bodies": {
            "plate": {
                "mass": 800, "submerged_weight": 6800, "inertia": [60, 200, 200],
                "drag_area": [0.3, 2, 2], "added_mass": 200.0,
                "drag_turning": 1.0,
                "points": {"left": [1.2, 0.4, 0.2], "stern": [-1.0, 0, 0]},
                "position": [-20, 5, -38],
                "foils": {"wing": {"area": 0.5, "position": [0.2, 0, 0]}},
            },
            "buoy": {"mass": 100, "submerged_weight": 500, "inertia": 20.0, "drag_area": 0.5,
                     "points": {"eye": [0, 0, 0.4]}, "position": [0, 60, -17]},
        },
        "lines": {
            "port": {"from": "tug.port", "to": "plate.left", "items": [wire(40)]},
            "tail": {"from": "plate.stern", "to": "free", "items": [wire(15, elements=3)]},
            "hoist": {
                "from": {"point": "buoy.eye", "clamped": [0, 0, 1]},
                "to": {"point": "crane.tip", "clamped": [0, 0, 1]},
                "items": [wire(20)],
            },
        },
        "cuts": {
            "knife": {"line": "port", "at": 25.0},
            "weak": {"line": "tail", "at": "start", "time": 3.0},
        },
        "run": {"duration": 10, "output_interval": 0.5},
    }  # fmt: skip
    return cm.load_system(data)


def still(**changes: Any) -> cm.SystemScene:
    """A body on a wire of a fixed mesh below a ship at rest, and what cuts it."""
    data = {
        "cable_types": {"wire": {"diameter": 0.01, "mass": 0.5, "axial_stiffness": 1e6}},
        "vessels": {"ship": {"points": {"hook": [1, 0, 0]}}},
        "bodies": {
            "load": {"mass": 200.0, "submerged_weight": 1500.0, "inertia": 50.0, "drag_area": 1.0,
                     "points": {"eye": [0, 0, 0.5]}}
        },
        "lines": {"wire": {"from": "ship.hook", "to": "load.eye", "items": [wire(20, elements=8)]}},
        "cuts": {"knife": {"line": "wire", "at": 7.0}},
        "run": {"duration": 5, "output_interval": 0.5},
    }  # fmt: skip
    data.update(changes)
    return cm.load_system(data)


@pytest.fixture(scope="module")
def towed(tmp_path_factory: pytest.TempPathFactory) -> Any:
    scene = tow()
    with unpacked(scene, tmp_path_factory.mktemp("tow"), stations=STATIONS) as (place, description):
        yield SystemModel(scene), place, description


@pytest.fixture(scope="module")
def hung(tmp_path_factory: pytest.TempPathFactory) -> Any:
    scene = still()
    with unpacked(scene, tmp_path_factory.mktemp("hung"), stations=STATIONS) as (place, about):
        yield SystemModel(scene), place, about


def expected(model: SystemModel) -> dict[str, float]:
    """Every output by its name in the FMU, as Python has it."""
    values = model.outputs()
    for name, line in model.lines.items():
        state = line.sample([line.length * k / (STATIONS - 1) for k in range(STATIONS)])
        values[f"{name}.state.position"] = state.position
        values[f"{name}.state.tension"] = state.tension
        values[f"{name}.state.curvature"] = state.curvature
    found: dict[str, float] = {}
    for row in outputs_of(model.scene):
        names = list(row.fmu_names(stations=STATIONS))
        if names:
            numbers = np.ravel(values[row.python])
            found.update(zip(names, numbers.tolist(), strict=True))
    return found


def numbers_of(slave: Slave, names: list[str]) -> list[float]:
    return slave.fmu.getReal([slave.references[name].valueReference for name in names])


def assert_same_bits(slave: Slave, model: SystemModel) -> None:
    assert slave.time == model.time
    wanted = expected(model)
    outputs = [v.name for v in slave.description.modelVariables if v.causality == "output"]
    assert outputs == list(wanted)
    found = numbers_of(slave, outputs)
    np.testing.assert_array_equal(found, list(wanted.values()), err_msg=str(outputs))


def test_it_is_a_valid_fmu_by_the_names_of_its_parts(tmp_path: Path) -> None:
    file = tmp_path / "bridle.yaml"
    file.write_text(still().to_yaml())
    target = tmp_path / "still.fmu"
    done = CliRunner().invoke(app, ["fmu", str(file), "-o", str(target), "--platform", "linux64",
                                    "--stations", "3"])  # fmt: skip
    assert done.exit_code == 0, done.output
    assert validate_fmu(str(target)) == []
    description = read_model_description(str(target), validate=True)
    by_name = {v.name: v for v in description.modelVariables}
    for name in (
        "use_scene_inputs", "input.timing", "ship.input", "ship.position_input[1]",
        "ship.attitude_rate_input[3]", "load.force_input[2]", "load.torque_input[3]", "knife.cut",
        "wire.tension.start", "wire.tension.max", "wire.line.position[3,3]",
        "wire.line.tension[2]", "load.angular_velocity[1]", "ship.force[1]", "ship.moment[3]",
        "knife.time",
    ):  # fmt: skip
        assert name in by_name
    assert not any(name.startswith(("vessel.", "payout", "line.")) for name in by_name)
    references = [v.valueReference for v in description.modelVariables]
    assert len(set(references)) == len(references)
    assert by_name["ship.position_input[1]"].declaredType is None
    assert by_name["load.attitude[1]"].unit == "rad"
    assert description.coSimulation.providesDirectionalDerivative
    assert description.coSimulation.maxOutputDerivativeOrder == 1
    with zipfile.ZipFile(target) as archive:
        page = archive.read("documentation/index.html").decode()
    assert "NAME.cut" in page
    ports = (tmp_path / "Cable_OspModelDescription.xml").read_text()
    assert 'ref="ship.velocity_input[1]"' in ports


def test_as_the_scene_says(towed: Any) -> None:
    """Nothing is set: path, cut at its time, and all outputs, with and without reading them."""
    start, place, description = towed
    slave, model = Slave(place, description), copy.copy(start)
    assert slave.fmu.getBoolean([10]) == [1]
    assert_same_bits(slave, model)
    for k in range(8):
        slave.step(0.5)
        model.step(0.5)
        if k % 3 == 2:
            assert_same_bits(slave, model)
    assert slave.get("weak.time") == 3.0
    slave.close()


def test_driven_with_a_cut(towed: Any) -> None:
    """Random motion of the crane, in all ways; forces, deflections, a cut; the tug keeps its path,
    then is taken over."""
    start, place, description = towed
    rng = np.random.default_rng(5)
    for by in (1, 2, 3):
        slave, model = Slave(place, description, **{"crane.input": by}), copy.copy(start)
        for k in range(6):
            inputs = {
                "velocity": np.array([2, 0, 0]) + rng.uniform(-0.3, 0.3, 3),
                "attitude_rate": rng.uniform(-0.1, 0.1, 3),
                "position": np.array([0.5 * 2 * (k + 1), 60, 3]) + rng.uniform(-0.1, 0.1, 3),
                "attitude": rng.uniform(-0.05, 0.05, 3),
            }
            names = {1: ["velocity", "attitude_rate"], 2: ["position", "attitude"], 3: [*inputs]}
            given = {name: inputs[name] for name in names[by]}
            wrench = rng.uniform(-200, 200, 6)
            angle = rng.uniform(-0.2, 0.2)
            for name, value in given.items():
                slave.set(f"crane.{name}_input", value)
            slave.set("plate.force_input", wrench[:3])
            slave.set("plate.torque_input", wrench[3:])
            slave.set("plate.wing.deflection", angle)
            slave.set("knife.cut", float(k >= 2))
            vessels = {"crane": cm.VesselInput(**given)}
            if k >= 4:
                slave.set("tug.velocity_input", [1.5, 0.4, 0.0])
                vessels["tug"] = cm.VesselInput(velocity=[1.5, 0.4, 0.0])
            slave.step(0.5)
            model.step(
                0.5, vessels=vessels, forces={"plate": wrench},
                deflections={"plate.wing": angle}, cuts=["knife"] if k == 2 else [],
            )  # fmt: skip
        assert_same_bits(slave, model)
        assert slave.get("knife.time") == 1.0
        slave.close()


def test_a_position_alone_moves_the_vessel(towed: Any) -> None:
    start, place, description = towed
    slave, model = Slave(place, description), copy.copy(start)
    for k in range(3):
        where = [0.5 * 2.2 * (k + 1), 60.0, 3.0]
        slave.set("crane.position_input", where)
        slave.step(0.5)
        model.step(0.5, vessels={"crane": cm.VesselInput(position=where)})
    assert_same_bits(slave, model)
    np.testing.assert_allclose(slave.get("crane.position"), where)
    np.testing.assert_array_equal(slave.get("crane.attitude"), 0.0)
    slave.close()


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"ship.position_input": (3, 0, 0)}, "ship.position_input[1] draws it by 3 m"),
        ({"ship.attitude_input": (0, 0, 0.5)}, "ship.attitude_input[1] draws it by 0.5 rad"),
        ({"ship.position_input": (0.5, 0, 0), "ship.attitude_input": (0, 0, 0.05)}, ""),
    ],
)
@pytest.mark.parametrize("chosen", [False, True])
def test_a_first_step_to_another_start_is_warned_of(
    hung: Any, given: dict[str, Any], said: str, chosen: bool
) -> None:
    """And no input that moves the ship is said to be ignored."""
    _, place, description = hung
    slave = Slave(place, description, **given, **({"ship.input": 2} if chosen else {}))
    for _ in range(2):
        for name, value in given.items():
            slave.set(name, value)
        slave.step(0.1)
    messages = [text for _, text in slave.messages]
    assert len(messages) == bool(said)
    assert all(said in text and "it begins at (0, 0, 0)" in text for text in messages)
    slave.close()


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_scenes_to_copy_are_the_same_in_both(path: Path, tmp_path: Path) -> None:
    """All parts that scenes of systems have, with what the scene schedules and forces on bodies."""
    model = SystemModel(cm.load_system(path))
    with unpacked(model.scene, tmp_path, stations=STATIONS) as (place, description):
        slave = Slave(place, description)
        still = cm.VesselInput(velocity=[0, 0, 0], attitude_rate=[0, 0, 0])
        scheduled = slave.fmu.getBoolean([10]) == [1]
        vessels = {} if scheduled else dict.fromkeys(model.vessels, still)
        for k in range(1, 5):
            push = {name: np.array([30.0 * k, -20, 10, 0, 5, 0]) for name in model.bodies}
            for name, wrench in push.items():
                slave.set(f"{name}.force_input", wrench[:3])
                slave.set(f"{name}.torque_input", wrench[3:])
            rates = dict.fromkeys(model.winches, 0.2 * k - 0.3)
            for name, rate in rates.items():
                slave.set(f"{name}.rate", rate)
            slave.step(0.5)
            model.step(0.5, vessels=vessels, forces=push, rates=rates)
        assert_same_bits(slave, model)
        slave.close()


@pytest.mark.parametrize("name", ["cage_on_its_winch", "weak_link", "otter_boards"])
def test_errors_of_scenes_to_copy_are_those_of_python(name: str, tmp_path: Path) -> None:
    """With a winch, a wire that breaks, foils and branches."""
    path = next(scene for scene in SCENES if scene.stem == name)
    model = SystemModel(cm.load_system(path, ["solver.error_estimate=true"]))
    with unpacked(model.scene, tmp_path, stations=STATIONS) as (place, description):
        slave = Slave(place, description, use_scene_inputs=True)
        for dt in (0.5, 3.0, 0.1):
            slave.step(dt)
            model.step(dt)
            assert_same_bits(slave, model)
        assert max(errors.position for errors in model.errors.values()) > 0.0
        slave.close()


def test_a_winch_that_runs_from_the_start(tmp_path: Path) -> None:
    """The scene's rate is what the input begins as."""
    load = still().to_dict()["bodies"]["load"]
    winch = {"line": "wire", "drum": 5.0, "rate": 0.2}
    scene = still(cuts={}, bodies={"load": load}, winches={"hoist": winch})
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        slave, model = Slave(place, description), SystemModel(scene)
        assert slave.get("hoist.rate") == 0.2
        assert_same_bits(slave, model)
        for _step in range(4):
            slave.step(0.5)
            model.step(0.5)
            assert_same_bits(slave, model)
        assert slave.get("load.velocity[3]") == pytest.approx(-0.2, abs=0.02)
        slave.close()


def test_a_lay_from_an_anchor_beside_a_line_that_hangs(tmp_path: Path) -> None:
    """From the steady state of its line alone; its ship begins nowhere else."""
    scene = cm.load_system(JOBS / "lay_from_anchor.yaml")
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        start = next(v for v in description.modelVariables if v.name == "ship.start_position[1]")
        assert float(start.min) == float(start.max) == 0.0
        slave = Slave(place, description, use_scene_inputs=True)
        model = SystemModel(scene)
        assert_same_bits(slave, model)
        for dt in (0.1, 1.9, 8.0, 50.0):
            slave.step(dt)
            model.step(dt)
            assert_same_bits(slave, model)
        assert slave.get("engine.rate") == pytest.approx(2.02 * 1852.0 / 3600.0)
        slave.close()
        early = Slave(place, description, begin=False)
        with pytest.raises(FMICallException):
            early.set("ship.start_position[1]", 1.0)
        assert "what was laid" in early.messages[-1][1]
        early.close()


def test_cables_and_a_body_on_a_drum(tmp_path: Path) -> None:
    """They come out and go in again, with the same bits; the body's coefficients are parameters."""
    body = {"mass": 20.0, "submerged_weight": 150.0, "drag_area": 0.1}
    rate = [{"t": t, "rate": v} for t, v in ((0, 0), (1, 1), (16, 1), (18, -1), (36, -1))]

    def wound(weight: float) -> cm.SystemScene:
        drum = [wire(2), {"body": {**body, "submerged_weight": weight}}, wire(20)]
        winches = {"hoist": {"line": "wire", "drum": drum, "rate": rate}}
        return still(cuts={}, winches=winches)

    name = "hoist.body[1].submerged_weight"
    with unpacked(wound(150.0), tmp_path, stations=STATIONS) as found:
        slave, model = Slave(*found, use_scene_inputs=True), SystemModel(wound(150.0))
        heavy, heavier = (
            Slave(*found, use_scene_inputs=True, **{name: 450}),
            SystemModel(wound(450)),
        )
        assert slave.get(name) == 150.0
        assert heavy.get(name) == 450.0
        for _step in range(9):
            for one in (slave, heavy, model, heavier):
                one.step(4.0)
            assert_same_bits(slave, model)
            top = heavy.get("wire.tension.start")  # from a start that was found anew
            # The body that passes rings on: by 30 tau in either phase (test_system_drums.py).
            assert top == pytest.approx(heavier.lines["wire"].start_tension, rel=0.03)
            if slave.time == 16.0:
                assert top - slave.get("wire.tension.start") > 200.0
        assert model.winches["hoist"].limit == "free"
        slave.close()
        heavy.close()


def test_pay_out_without_cable_on_the_drum_is_warned_of(tmp_path: Path) -> None:
    """Of each winch by itself, once."""
    lines = still().to_dict()["lines"]
    lines["other"] = {"from": "ship.hook", "to": "free", "items": [wire(10)]}
    winches = {"hoist": {"line": "wire", "drum": 0.0}, "reel": {"line": "other", "drum": 1.0}}
    with unpacked(still(lines=lines, cuts={}, winches=winches), tmp_path, stations=2) as found:
        slave, said = Slave(*found), []
        for _ in range(6):
            slave.set("reel.rate", 0.3)
            slave.set("hoist.rate", 0.3 if slave.time > 0.5 else -0.1)
            slave.step(1.0)
            said.append([text.split()[0] for _, text in slave.messages])
        assert said[0] == []
        assert said[1] == ["hoist.rate"]
        assert said[5] == ["hoist.rate", "reel.rate"]
        assert "asks for cable, and there is none on the drum" in slave.messages[1][1]
        for _ in range(5):  # and of one that has taken in all that it can
            slave.set("reel.rate", -3.0)
            slave.step(1.0)
        assert "reel.rate asks for less line" in slave.messages[2][1]
        assert len(slave.messages) == 3
        slave.close()


HOISTED = [{"t": 0, "rate": 0.0}, {"t": 1, "rate": 0.3}, {"t": 3, "rate": -0.1}]


def test_zeros_that_take_over_from_the_scene_are_asked_about(towed: Any) -> None:
    """Of a vessel on its path; not of a crane that is moved."""
    slave = Slave(*towed[1:])
    for k in range(12):
        slave.set("tug.velocity_input", (0, 0, 0))
        slave.set("crane.velocity_input", (2.0 if k else 0.0, 0, 0))
        slave.step(0.25)
    asked = "tug.velocity_input[1] has been 0 for 10 steps, and takes the place of what the scene"
    assert [status for status, _ in slave.messages] == [1]
    assert asked in slave.messages[0][1]
    slave.close()


@pytest.mark.parametrize(
    ("changes", "scheduled"),
    [
        ({"cuts": {}, "winches": {"hoist": {"line": "wire", "drum": 5.0, "rate": HOISTED}}}, True),
        ({"cuts": {"knife": {"line": "wire", "at": 7.0, "time": 1.0}}}, False),
        (
            {
                "environment": {"waves": {"regular": {"height": 2.0, "period": 6.0}, "ramp": 1.0}},
                "vessels": {
                    "ship": {
                        "points": {"hook": [1, 0, 0]},
                        "raos": [{"heading_deg": 0, "period": 6, "heave": 0.8, "roll_deg": 2}],
                    }
                },
            },
            False,
        ),
    ],
    ids=["winch", "cut", "waves"],
)
def test_what_is_scheduled_beside_a_ship_at_rest_happens_untouched(
    changes: dict[str, Any], scheduled: bool, tmp_path: Path
) -> None:
    """As it is exported, with nothing set, it runs the scene."""
    scene = still(**changes)
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        slave, model = Slave(place, description), SystemModel(scene)
        assert slave.fmu.getBoolean([10]) == [scheduled]
        before = model.lines["wire"].start_tension
        for _ in range(8):
            slave.step(0.5)
            model.step(0.5)
            assert_same_bits(slave, model)
        assert abs(model.lines["wire"].start_tension / before - 1.0) > 0.01  # something happened
        slave.close()


def test_all_inputs_drive_a_system_at_rest(hung: Any) -> None:
    """Nothing is scheduled: the inputs hold from the start."""
    start, place, description = hung
    slave, model = Slave(place, description), copy.copy(start)
    assert slave.fmu.getBoolean([10]) == [0]
    at_rest = cm.VesselInput(velocity=[0, 0, 0], attitude_rate=[0, 0, 0])
    for _ in range(2):
        slave.step(0.5)
        model.step(0.5, vessels={"ship": at_rest})
    assert_same_bits(slave, model)
    slave.set("ship.attitude_rate_input", [0, 0, 0.2])
    slave.step(1.0)
    model.step(1.0, vessels={"ship": cm.VesselInput(velocity=[0, 0, 0], attitude_rate=[0, 0, 0.2])})
    assert_same_bits(slave, model)
    assert slave.get("ship.attitude[3]") == pytest.approx(0.1)
    slave.close()


def test_states_roll_back_and_travel(towed: Any) -> None:
    """Before a cut and after it: the same steps give the same bits again, in another instance
    too."""
    _, place, description = towed
    slave = Slave(place, description)
    names = [v.name for v in description.modelVariables if v.causality == "output"]
    fmu = slave.fmu

    def on(to: Slave, first: int) -> list[list[float]]:
        found = []
        for k in range(first, first + 3):
            to.set("crane.velocity_input", [2.0, 0.1 * k, 0.05])
            to.set("knife.cut", 1.0 if k >= 1 else 0.0)
            to.step(0.4)
            found.append(numbers_of(to, names))
        return found

    slave.step(0.4)
    kept, time = fmu.getFMUstate(), slave.time
    once = on(slave, 0)
    assert slave.get("knife.time") == pytest.approx(0.8)
    fmu.setFMUstate(kept)
    slave.time = time
    assert math.isnan(slave.get("knife.time"))
    np.testing.assert_array_equal(on(slave, 0), once)
    after = fmu.serializeFMUstate(fmu.getFMUstate())
    further = on(slave, 3)
    other = Slave(place, description)
    other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(after))
    other.time = time + 1.2
    np.testing.assert_array_equal(on(other, 3), further)
    broken = bytearray(after)
    broken[-8 * 200] ^= 1
    with pytest.raises(Exception, match="DeSerialize"):
        other.fmu.deSerializeFMUstate(bytes(broken))
    assert "corrupted" in other.messages[-1][1]
    fmu.freeFMUstate(kept)
    other.close()
    slave.close()


def test_timing_and_derivatives(hung: Any) -> None:
    """A ramp is the same however it is told: by values at the end, at the start, by slopes."""
    _, place, description = hung
    ends, begins, slopes = (
        Slave(place, description, **{"input.timing": timing}) for timing in (1, 2, 1)
    )
    ramp, dt = 0.3, 0.25
    for k in range(5):
        ends.set("ship.velocity_input[2]", ramp * dt * (k + 1))
        begins.set("ship.velocity_input[2]", ramp * dt * k)
        slopes.set("ship.velocity_input[2]", ramp * dt * k)
        reference = slopes.references["ship.velocity_input[2]"].valueReference
        slopes.fmu.setRealInputDerivatives([reference], [1], [ramp])
        for slave in (ends, begins, slopes):
            slave.step(dt)
    np.testing.assert_allclose(
        slopes.get("load.position"), ends.get("load.position"), rtol=0, atol=1e-12
    )
    np.testing.assert_allclose(begins.get("ship.velocity[2]"), ends.get("ship.velocity[2]"))
    reference = slopes.references["knife.cut"].valueReference
    with pytest.raises(Exception, match="InputDerivatives"):
        slopes.fmu.setRealInputDerivatives([reference], [1], [1.0])
    assert "knife.cut" in slopes.messages[-1][1]
    for slave in (ends, begins, slopes):
        slave.close()


def test_velocities_and_rates_lead_as_far_as_their_derivatives_say(hung: Any) -> None:
    """v = t^2 / 4 and a yaw rate of t^2 / 9, by values at each step's start."""
    _, place, description = hung
    slave, dt = Slave(place, description), 0.25
    named = {"ship.velocity_input[2]": 0.25, "ship.attitude_rate_input[3]": 1.0 / 9.0}
    references = [slave.references[name].valueReference for name in named]
    for n in range(8):
        t = n * dt
        for name, factor in named.items():
            slave.set(name, factor * t * t)
        slopes = [order * factor for factor in named.values() for order in (t * 2.0, 2.0)]
        both = [r for r in references for _ in (1, 2)]
        slave.fmu.setRealInputDerivatives(both, [1, 2] * 2, slopes)
        slave.step(dt)
    assert slave.get("ship.position[2]") == pytest.approx(0.25 * 8.0 / 3.0, rel=1e-9)
    assert slave.get("ship.velocity[2]") == pytest.approx(1.0, rel=1e-9)
    assert slave.get("ship.attitude[3]") == pytest.approx(8.0 / 27.0, rel=1e-9)
    slave.close()


@pytest.mark.parametrize("first", [0, 4])
def test_a_place_that_takes_over_goes_on_as_fast_as_the_vessel_is(towed: Any, first: int) -> None:
    """A crane that goes straight on; a tug in a turn, whose course goes on, too."""
    start, place, description = towed
    begin = {"input.timing": 2, "crane.input": 2, "tug.input": 2}
    slave, model = Slave(place, description, **begin), copy.copy(start)
    model.step(0.5 * first) if first else None
    for n in range(first + 2):
        if n >= first:
            slave.set("crane.position_input", [2.0 * slave.time, 60.0, 3.0])
        if n == first and first:
            x, y, _ = slave.get("tug.position")
            yaw = slave.get("tug.attitude[3]")
            slave.set("tug.position_input", [x, y, 0.0])
            slave.set("tug.attitude_input", [0.0, 0.0, yaw])
            speed = slave.get("tug.velocity")
        slave.step(0.5)
        np.testing.assert_allclose(slave.get("crane.position"), [2.0 * slave.time, 60, 3])
        if n == first and first:
            went = slave.get("tug.position") - [x, y, 0.0]
            np.testing.assert_allclose(went[:2], 0.5 * speed[:2], atol=1e-6)
            assert slave.get("tug.attitude[3]") - yaw == pytest.approx(0.5 * 2.0 / 30.0)
    assert slave.messages == []
    slave.close()


def test_angles_go_on_the_shorter_way(hung: Any) -> None:
    """Told with a turn more or less, in steps that vary."""
    _, place, description = hung
    slave = Slave(place, description, **{"input.timing": 2, "ship.input": 2})
    for n, dt in enumerate([0.2, 0.4, 0.1, 0.3]):
        slave.set("ship.attitude_input[3]", 0.1 * slave.time + 2 * math.pi * (n % 2))
        slave.step(dt)
        if n > 0:
            assert slave.get("ship.attitude[3]") == pytest.approx(0.1 * slave.time)
    slave.close()


@pytest.mark.parametrize("given", ["position", "velocity", "attitude", "attitude_rate"])
def test_of_place_and_rate_one_that_is_set_alone_drives_alone(hung: Any, given: str) -> None:
    start, place, description = hung
    slave, model = Slave(place, description, **{"ship.input": 3}), copy.copy(start)
    pairs = [("position", "velocity"), ("attitude", "attitude_rate")]
    others = {name: [0.0, 0.0, 0.0] for pair in pairs if given not in pair for name in pair}
    for n in range(1, 4):
        value = [0.0, 0.0, 0.02 * n]
        slave.set(f"ship.{given}_input", value)
        slave.step(0.5)
        model.step(0.5, vessels={"ship": cm.VesselInput(**others, **{given: value})})
        assert_same_bits(slave, model)
    assert slave.messages == []
    slave.close()


def test_rates_are_those_of_the_angles_and_named_so(hung: Any) -> None:
    """A ship that has pitched by 1 rad and rolls turns about an axis that points down."""
    _, place, description = hung
    slave = Slave(place, description)
    for rates in ([0, 0.5, 0], [0, 0.5, 0], [0.1, 0, 0], [0.1, 0, 0]):
        slave.set("ship.attitude_rate_input", rates)
        slave.step(1.0)
    assert slave.get("ship.attitude") == pytest.approx([0.15, 1.0, 0.0])
    turning = [0.1 * math.cos(1.0), 0.0, -0.1 * math.sin(1.0)]
    assert slave.get("ship.angular_velocity") == pytest.approx(turning, abs=1e-12)
    for i, angle in enumerate(("roll", "pitch", "yaw"), start=1):
        words = slave.references[f"ship.attitude_rate_input[{i}]"].description
        assert words.startswith("ship: rates of roll, pitch and yaw, ")
        assert words.endswith(f", {angle}")
    assert slave.references["ship.angular_velocity[1]"].description.endswith("x (east)")
    slave.close()


def test_time_begins_where_the_master_says(hung: Any) -> None:
    _, place, description = hung
    slave = Slave(place, description, start=100.0)
    slave.step(0.5)
    slave.set("knife.cut", 1.0)
    slave.step(0.5)
    assert slave.get("knife.time") == pytest.approx(100.5)
    slave.close()


def test_what_is_wrong_is_named(towed: Any) -> None:
    _, place, description = towed
    slave = Slave(place, description, use_scene_inputs=True)
    slave.set("crane.velocity_input", [1, 0, 0])
    assert "crane.velocity_input[1] is set but ignored" in slave.messages[-1][1]
    slave.set("crane.velocity_input", [1.1, 0, 0])
    assert len(slave.messages) == 1
    slave.close()
    slave = Slave(place, description)
    slave.set("tug.position_input", [0, 0, 0])
    slave.set("tug.velocity_input", [2, 0, 0])
    assert "tug.position_input[1]" not in "".join(text for _, text in slave.messages)
    slave.set("tug.position_input", [0, 1, 0])
    assert "tug.input says what moves it" in slave.messages[-1][1]
    for name, value, words in (
        ("tug.position_input[1]", 1e9, "out of range"),
        ("plate.force_input[1]", math.nan, "not finite"),
        ("plate.position[1]", 1.0, "output cannot be set"),
    ):
        with pytest.raises(Exception, match="SetReal"):
            slave.set(name, value)
        assert words in slave.messages[-1][1]
    with pytest.raises(Exception, match="SetInteger"):
        slave.set("tug.input", 2)  # the initialization is over
    slave.close()


def test_a_step_that_fails_changes_nothing(hung: Any) -> None:
    """What draws the hook away is given back, and the cut that was ordered with it."""
    _, place, description = hung
    slave, other = (Slave(place, description, **{"ship.input": 2}) for _ in range(2))
    slave.step(0.5)
    other.step(0.5)
    slave.set("ship.position_input", [1e6, 0.0, 0.0])
    slave.set("knife.cut", 1.0)
    with pytest.raises(Exception, match="DoStep"):
        slave.step(0.5)
    slave.time = 0.5
    text = slave.messages[-1][1]
    assert "at t = 0.5 s" in text
    slave.set("ship.position_input", [0.0, 0.0, 0.0])
    slave.set("knife.cut", 0.0)
    slave.step(0.5)
    other.step(0.5)
    names = [v.name for v in description.modelVariables if v.causality == "output"]
    np.testing.assert_array_equal(numbers_of(slave, names), numbers_of(other, names))
    slave.close()
    other.close()


def test_a_cut_makes_room_for_its_node(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, hung: Any
) -> None:
    monkeypatch.setattr(at, "NODES_OF_A_CUT", 0)
    with unpacked(still(), tmp_path, stations=STATIONS) as bare:
        seen = []
        for fmu in (bare, hung[1:]):
            slave = Slave(*fmu)
            names = [v.name for v in slave.description.modelVariables if v.causality == "output"]
            slave.step(0.5)
            slave.set("knife.cut", 1.0)
            slave.step(0.5)
            size = len(slave.fmu.serializeFMUstate(slave.fmu.getFMUstate()))
            seen.append((numbers_of(slave, names), size))
            slave.close()
    np.testing.assert_array_equal(seen[0][0], seen[1][0])
    assert seen[0][1] != seen[1][1], "there was no room at first"


def test_what_cannot_be_exported_is_refused_by_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cablemodel.systems.model._finer_model", lambda scene: None)
    estimated = still(solver={"error_estimate": True})
    with pytest.raises(ExportError, match=r"solver\.error_estimate.*no start"):
        export_fmu(estimated, tmp_path / "a.fmu")
    assert list(tmp_path.iterdir()) == []


@pytest.fixture(scope="module")
def estimated(tmp_path_factory: pytest.TempPathFactory) -> Any:
    scene = cm.load_system({**tow().to_dict(), "solver": {"error_estimate": True}})
    place = tmp_path_factory.mktemp("estimated")
    with unpacked(scene, place, stations=STATIONS) as (fmu, description):
        yield SystemModel(scene), fmu, description


def drive_both(slave: Slave, model: SystemModel, first: int, last: int) -> list[list[float]]:
    """Steps by number, of lengths that limit both runs and that do not; all outputs."""
    outputs = [v.name for v in slave.description.modelVariables if v.causality == "output"]
    found = []
    for k in range(first, last):
        dt = (0.3, 0.02, 0.5, 0.1)[k % 4]
        speed, wrench = [2.0, 0.2 * k % 0.5, 0.1], np.array([50.0 * k, -40, 20, 0, 3, 1])
        slave.set("crane.velocity_input", speed)
        slave.set("plate.force_input", wrench[:3])
        slave.set("plate.torque_input", wrench[3:])
        slave.set("plate.wing.deflection", 0.02 * k)
        slave.set("knife.cut", float(k >= 5))
        slave.step(dt)
        model.step(
            dt, vessels={"crane": cm.VesselInput(velocity=speed)}, forces={"plate": wrench},
            deflections={"plate.wing": 0.02 * k}, cuts=["knife"] if k == 5 else [],
        )  # fmt: skip
        assert_same_bits(slave, model)
        found.append(numbers_of(slave, outputs))
    return found


def test_errors_of_lines_and_bodies_are_those_of_python(estimated: Any) -> None:
    """Driven, with a cut; a state that is taken back, or elsewhere, has the finer run with it."""
    start, place, description = estimated
    slave, model = Slave(place, description), copy.copy(start)
    assert_same_bits(slave, model)
    drive_both(slave, model, 0, 4)
    kept, time = slave.fmu.getFMUstate(), slave.time
    bytes_kept = slave.fmu.serializeFMUstate(kept)
    before = copy.copy(model)
    once = drive_both(slave, model, 4, 10)
    assert slave.get("port.error.position") > 0.0
    assert slave.get("port.error.tension") > 0.0
    assert slave.get("plate.error.position") > 0.0
    slave.fmu.setFMUstate(kept)
    slave.time = time
    np.testing.assert_array_equal(drive_both(slave, copy.copy(before), 4, 10), once)
    other = Slave(place, description)
    other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(bytes_kept))
    other.time = time
    np.testing.assert_array_equal(drive_both(other, copy.copy(before), 4, 10), once)
    other.close()
    slave.fmu.freeFMUstate(kept)
    slave.close()


def test_results_are_those_without_an_estimate(estimated: Any, towed: Any) -> None:
    one, other = Slave(*estimated[1:]), Slave(*towed[1:])
    names = [v.name for v in towed[2].modelVariables if v.causality == "output"]
    more = {v.name for v in estimated[2].modelVariables} - set(other.references)
    parts = [*(f"{name}.error.tension" for name in estimated[0].lines)]
    parts += [f"{name}.error.position" for name in (*estimated[0].lines, *estimated[0].bodies)]
    assert more == set(parts)
    for _step in range(4):
        one.step(0.5)
        other.step(0.5)
    np.testing.assert_array_equal(numbers_of(one, names), numbers_of(other, names))
    one.close()
    other.close()


def test_a_finer_run_of_other_parts_is_refused(estimated: Any, hung: Any, tmp_path: Path) -> None:
    _start, place, description = estimated
    other = tmp_path / "fmu"
    shutil.copytree(place, other)
    whole = np.frombuffer((place / "resources" / "finer.bin").read_bytes(), dtype="<i8")
    strange = contents_of(hung[0].scene, ExportOptions(stations=STATIONS)).model
    words = np.frombuffer(strange, dtype="<i8").copy()
    words[5:10] = whole[5:10]  # its GUID
    (other / "resources" / "finer.bin").write_bytes(sealed(bytearray(words.tobytes())))
    with pytest.raises(Exception, match="instantiate"):
        Slave(other, description)


def test_a_model_file_that_is_altered_is_refused(hung: Any, tmp_path: Path) -> None:
    """Sizes, the section of the parts, the first shape, and tables in the blocks."""
    start, place, description = hung
    other = tmp_path / "fmu"
    shutil.copytree(place, other)
    whole = contents_of(start.scene, ExportOptions(stations=STATIONS)).model
    model = other / "resources" / "model.bin"
    words = np.frombuffer(whole, dtype="<i8")
    parameters, section = int(words[14]), int(words[15])
    image = FileHeader.WORDS + Parameter.WORDS * parameters + section
    shape = image + int(words[FileHeader.image_words.word])
    first = shape + int(words[FileHeader.shape_words.word])
    assert shape < first < len(words) == first + int(words[FileHeader.first_words.word])
    places = [14, 15, FileHeader.shape_words.word, FileHeader.first_words.word]
    places += [image - section, image - 1]
    for begin in (image, first):
        head = Header(words[begin:])
        places += [begin + Header.frame_count.word]
        places += [begin + int(head.cuts) + at.Cut.segment.word]
        places += [begin + int(head.free_bodies) + at.FreeBody.node.word]
        places += [begin + int(head.constraints) + at.Constraint.frame.word]
    sizes = ("lines", "items", "bodies", "most")
    places += [shape + at.FirstShape.FIELDS[name].word for name in sizes]
    lines, items, bodies, _most = (
        int(words.view("<f8")[shape + at.FirstShape.FIELDS[name].word]) for name in sizes
    )
    item = shape + at.SHAPE_WORDS + at.STRING_LINE_WORDS * lines
    end = item + at.STRING_ITEM_WORDS * items + at.STRING_BODY_WORDS * bodies
    places += [item + at.StringItem.line.word]
    places += [end + at.StringEnd.kind.word, end + at.StringEnd.other.word]
    altering = [(place_of_word, 1e6) for place_of_word in places]
    altering += [(FileHeader.search.word, math.nan), (shape, math.nan)]
    for place_of_word, value in altering:
        altered = bytearray(whole)
        altered[8 * place_of_word : 8 * place_of_word + 8] = np.float64(value).tobytes()
        model.write_bytes(sealed(altered))
        with pytest.raises(Exception, match="instantiate"):
            Slave(other, description)
    model.write_bytes(whole)
    Slave(other, description).close()


def test_how_long_lines_have_been_slack(tmp_path: Path) -> None:
    """One line's load is left behind by a ship that heaves, the other one's is not."""
    load = {"mass": 500, "inertia": [50, 50, 50], "points": {"top": [0, 0, 0]}}
    rows = [{"t": t, "velocity": [0, 0, 2.0 if t % 4 == 1 else -2.0 * (t % 4 == 3)]}
            for t in range(9)]  # fmt: skip
    scene = cm.load_system(
        {
            "cable_types": {"W": {"diameter": 0.005, "mass": 0.1, "axial_stiffness": "300 kN",
                                  "bending_stiffness": 1}},
            "vessels": {"ship": {"points": {"port": [0, 0, 0], "starboard": [0, 30, 0]},
                                 "velocity": rows}},
            "bodies": {"plate": {**load, "submerged_weight": 1500, "drag_area": [2, 2, 2]},
                       "ball": {**load, "submerged_weight": 4000}},
            "lines": {
                "down": {"from": "ship.port", "to": "plate.top",
                         "items": [{"cable": {"type": "W", "length": 20}}]},
                "up": {"from": "ball.top", "to": "ship.starboard",
                       "items": [{"cable": {"type": "W", "length": 20}}]},
            },
        }
    )  # fmt: skip
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        slave, model = Slave(place, description), SystemModel(scene)
        assert_same_bits(slave, model)
        for _ in range(16):
            slave.step(0.5)
            model.step(0.5)
            assert_same_bits(slave, model)
        assert model.lines["down"].slack.time > 0.1
        assert model.lines["up"].slack.time == 0.0
        slave.close()


@pytest.mark.parametrize("from_anchor", [False, True])
def test_what_lines_do_on_the_floor_is_the_same_in_both(from_anchor: bool, tmp_path: Path) -> None:
    """In both directions of a line, while its ship moves, and after it has been cut; of a line
    that touches nowhere."""
    ends = [{"anchor": [70, 0, -20]}, "ship.hook"]
    one, other = ends if from_anchor else ends[::-1]
    scene = still(
        environment={"floor": {"z": -20, "friction": 0.4}},
        bodies={},
        lines={
            "leg": {"from": one, "to": other, "items": [wire(80)]},
            "tail": {"from": "ship.hook", "to": "free", "items": [wire(10)]},
        },
        cuts={"knife": {"line": "leg", "at": 62.0 if from_anchor else 18.0}},
    )
    names = [row.fmu for row in LINE_FLOOR]
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        slave, model = Slave(place, description), SystemModel(scene)
        known = {v.name.partition("[")[0] for v in description.modelVariables}
        for line in ("leg", "tail"):
            assert known.issuperset(n.replace("NAME", line).partition("[")[0] for n in names)
        assert_same_bits(slave, model)
        lay = slave.get("leg.floor.length")
        assert 20.0 < lay < 60.0
        for k in range(6):
            slave.set("ship.velocity_input", [0.5, 0.1, 0.0])
            slave.set("knife.cut", 1.0 * (k == 3))
            slave.step(0.5)
            model.step(0.5, vessels={"ship": cm.VesselInput(velocity=[0.5, 0.1, 0.0])},
                       cuts=["knife"] * (k == 3))  # fmt: skip
            assert_same_bits(slave, model)
        assert model.cuts["knife"] == 1.5
        assert slave.get("leg.floor.length") > lay
        assert slave.get("leg.touchdown.position[3]") == pytest.approx(-20.0, abs=0.05)
        assert math.isnan(slave.get("tail.touchdown.position[1]"))
        assert slave.get("tail.floor.length") == 0.0
        slave.close()
