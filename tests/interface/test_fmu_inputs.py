"""Who drives: what is connected does, what is ignored is said, starts may be set."""

import copy
from pathlib import Path

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmu_tools import CABLE, Slave, assert_same_bits, python_outputs, still_scene, unpacked

import cablemodel as cm
from cablemodel_fmu.export import ExportError, export_fmu

ROOT = Path(__file__).parents[2]

STATIONS = 3
UNDER_WAY = {
    "velocity": [{"t": 0, "velocity": [0, 0, 0]}, {"t": 10, "velocity": [0.5, 0, 0]}],
    "position": [5, 3, 0],
}


def scheduled_scene():
    """The vessel gets under way and the winch runs: the scene drives both."""
    data = still_scene().to_dict()
    data["vessel"] = UNDER_WAY
    data["payout"]["rate"] = [{"t": 0, "rate": 0.0}, {"t": 5, "rate": 0.2}]
    return cm.load_scene(data)


@pytest.fixture(scope="module")
def scheduled(tmp_path_factory):
    with unpacked(scheduled_scene(), tmp_path_factory.mktemp("fmu"), stations=STATIONS) as found:
        yield found


def warnings(slave) -> list[str]:
    return [text for status, text in slave.messages if status == 1]


def test_value_references_are_unique_over_all_types(scheduled):
    """A container, for one, keeps them in one table."""
    references = [v.valueReference for v in scheduled[1].modelVariables]
    assert len(set(references)) == len(references)
    kinds = {v.name: (v.type, v.valueReference) for v in scheduled[1].modelVariables}
    assert kinds["use_scene_inputs"] == ("Boolean", 10)
    assert kinds["vessel.input"] == ("Enumeration", 11)
    assert kinds["input.timing"] == ("Enumeration", 12)


def test_the_scene_drives_what_is_not_connected(scheduled):
    slave, model = Slave(*scheduled), cm.CableModel(scheduled_scene())
    for _ in range(10):
        slave.step(0.5)
        model.step(0.5)
        assert_same_bits(slave, model, STATIONS)
    slave.close()


def test_what_is_connected_drives_and_the_scene_the_rest(scheduled):
    """A master that sets no Boolean: its vessel moves the line, from a start at rest on."""
    slave, model = Slave(*scheduled), cm.CableModel(scheduled_scene())
    for n in range(12):
        velocity = (0.0, 0.02 * n, 0.0)
        slave.set("vessel.velocity", velocity)
        slave.step(0.5)
        model.step(0.5, vessel_velocity=velocity)
        assert_same_bits(slave, model, STATIONS)
    assert slave.get("payout.applied") != 0.0
    assert warnings(slave) == []
    slave.close()


def test_a_value_before_the_start_connects_where_it_differs(scheduled):
    """A master that hands out start values connects nothing by that; with another value it does."""
    for value, driven in ((0.0, False), (0.3, True)):
        slave, model = Slave(*scheduled, begin=False), cm.CableModel(scheduled_scene())
        slave.fmu.setupExperiment()
        slave.fmu.enterInitializationMode()
        slave.set("vessel.velocity", (value, 0.0, 0.0))
        slave.fmu.exitInitializationMode()
        slave.step(0.5)
        model.step(0.5, vessel_velocity=(value, 0.0, 0.0) if driven else None)
        assert_same_bits(slave, model, STATIONS)
        slave.close()


def test_the_position_alone_moves_the_tow_point(scheduled):
    """A master that sets no Integer, either."""
    slave, model = Slave(*scheduled), cm.CableModel(scheduled_scene())
    for n in range(1, 8):
        place = (5.0, 3.0 + 0.01 * n * n, 0.0)
        slave.set("vessel.position", place)
        slave.step(0.5)
        model.step(0.5, vessel_position=place)
        assert_same_bits(slave, model, STATIONS)
    assert warnings(slave) == []
    slave.close()


def test_a_position_beside_a_velocity_is_said_to_be_ignored(scheduled):
    slave = Slave(*scheduled)
    for _ in range(3):
        slave.set("vessel.velocity", (0.1, 0.0, 0.0))
        slave.set("vessel.position", (5.0, 3.0, 0.0))
        slave.step(0.5)
    (said,) = warnings(slave)
    assert "vessel.position is set but ignored: vessel.input" in said
    slave.close()


@pytest.mark.parametrize(
    ("inputs", "said"),
    [
        ({"vessel.velocity": (0, 0, 0), "payout.rate": 0.0}, ["vessel.velocity", "payout.rate"]),
        ({"vessel.velocity": (0, 0, 0), "payout.rate": 0.2}, ["vessel.velocity"]),
        ({"vessel.velocity": (0, 0.1, 0)}, []),
        ({"current.velocity": (0, 0, 0)}, []),
    ],
)
def test_zeros_that_take_over_from_the_scene_are_asked_about(scheduled, inputs, said):
    """As masters hand them out for what is not connected; where inputs drive anyway, or are 0 at
    first, they are meant."""
    slave, told = Slave(*scheduled), Slave(*scheduled, use_scene_inputs=False)
    for _ in range(12):
        for one in (slave, told):
            for name, value in inputs.items():
                one.set(name, value)
            one.step(0.5)
    assert len(warnings(slave)) == len(said)
    for name, words in zip(said, warnings(slave), strict=True):
        assert f"{name} has been 0 for 10 steps, and takes the place of what the scene" in words
    assert warnings(told) == []
    slave.close()
    told.close()


@pytest.mark.parametrize("who", [{}, {"use_scene_inputs": False}])
@pytest.mark.parametrize("name", ["vessel.velocity", "vessel.position"])
def test_of_position_and_velocity_one_that_is_set_alone_drives_alone(scheduled, who, name):
    slave, model = Slave(*scheduled, vessel_input=3, **who), cm.CableModel(scheduled_scene())
    others = {"payout_rate": 0.0, "current": (0, 0, 0)} if who else {}
    for n in range(1, 5):
        value = (0.1, 0.02, 0.0) if name == "vessel.velocity" else (5.0 + 0.05 * n, 3.0, 0.0)
        slave.set(name, value)
        slave.step(0.5)
        model.step(0.5, **{name.replace(".", "_"): value}, **others)
        assert_same_bits(slave, model, STATIONS)
    assert warnings(slave) == []
    slave.close()


def test_what_moves_it_may_be_chosen_after_a_position_is_set(scheduled):
    """A position that drives is not said to be ignored; one that does nothing in the run is."""
    start = (5.0, 3.0, 0.1)
    for later, said in (({"vessel_input": 2}, []), ({}, ["vessel.position"])):
        slave = Slave(*scheduled, **{"vessel.position": start}, **later)
        assert warnings(slave) == []
        slave.step(0.5)
        assert [text.split()[0] for text in warnings(slave)] == said
        assert slave.get("line.position[1,3]") == pytest.approx(0.1 if later else 0.0, abs=1e-15)
        slave.close()


@pytest.mark.parametrize("before", [False, True])
@pytest.mark.parametrize("choice", [{}, {"vessel_input": 2}, {"vessel_input": 3}])
def test_a_first_step_to_another_start_is_warned_of(scheduled, choice, before):
    """Of a master that hands out positions, and begins elsewhere than the cable: tensions jump."""
    there = {"vessel.position": (8.0, 3.0, 0.0)}
    slave = Slave(*scheduled, **choice, **(there if before else {}))
    slave.set("vessel.position", there["vessel.position"])
    slave.step(0.1)
    slave.set("vessel.position", there["vessel.position"])
    slave.step(0.1)
    (said,) = warnings(slave)
    assert "vessel.position draws the tow point by " in said
    assert "of 0.1 s: the cable begins at (5, 3, 0); set vessel.start_position" in said
    slave.close()
    slave = Slave(*scheduled, **{"vessel.start_position": there["vessel.position"]}, **choice)
    for _ in range(2):
        slave.set("vessel.position", there["vessel.position"])
        slave.step(0.1)
    assert warnings(slave) == []
    slave.close()


def test_a_start_that_cannot_be_set_is_to_be_exported(tmp_path):
    scene = still_scene(
        environment={"floor": {"z": -60, "slope": [0.1, 0.0]}},
        vessel={"position": [0, 0, 0]},
        payout={},
    )
    with unpacked(scene, tmp_path, stations=2) as found:
        slave = Slave(*found, vessel_input=2)
        slave.set("vessel.position", (3.0, 0.0, 0.0))
        slave.step(0.1)
        assert "export the scene with another start" in warnings(slave)[0]
        slave.close()


@pytest.mark.parametrize(("drum", "after"), [([], 1.0), ([2.0], 8.0)])
def test_pay_out_without_cable_on_the_drum_is_warned_of(tmp_path, drum, after):
    cables = [{"cable": {"type": "K", "length": length}} for length in drum]
    with unpacked(still_scene(payout={"drum": cables}), tmp_path, stations=2) as found:
        slave = Slave(*found)
        for _ in range(10):
            slave.set("payout.rate", 0.3)
            slave.step(1.0)
            said = ["payout.rate asks for cable, and there is none on the drum"]
            assert warnings(slave) == (said if slave.time >= after else [])
        slave.close()


def test_a_line_that_is_as_short_as_it_gets_is_warned_of(tmp_path):
    with unpacked(still_scene(), tmp_path, stations=2) as found:
        slave = Slave(*found)
        for _ in range(8):
            slave.set("payout.rate", -4.0)
            slave.step(1.0)
            stands = slave.get("line.length") < 0.4
            assert ["payout.rate asks for less line" in text for text in warnings(slave)] == (
                [True] if stands else []
            )  # fmt: skip
        assert stands
        slave.close()


def test_ignored_inputs_are_said_once_each(scheduled):
    """The master says that the scene drives, and sets inputs all the same."""
    slave, model = Slave(*scheduled, use_scene_inputs=True), cm.CableModel(scheduled_scene())
    for _ in range(4):
        slave.set("vessel.velocity", (0.0, 1.0, 0.0))
        slave.set("payout.rate", 1.0)
        slave.step(0.5)
        model.step(0.5)
        assert_same_bits(slave, model, STATIONS)
    said = warnings(slave)
    assert [text.split()[0] for text in said] == ["vessel.velocity", "payout.rate"]
    assert all("use_scene_inputs is true" in text for text in said)
    slave.close()


def test_exports_that_say_who_drives(tmp_path):
    for inputs, value in (("scene", True), ("master", False), ("connected", True)):
        folder = tmp_path / inputs
        folder.mkdir()
        with unpacked(scheduled_scene(), folder, inputs=inputs) as found:
            slave, model = Slave(*found), cm.CableModel(scheduled_scene())
            reference = slave.references["use_scene_inputs"].valueReference
            assert slave.fmu.getBoolean([reference]) == [value]
            slave.set("vessel.velocity", (0.0, 0.2, 0.0))
            slave.step(0.5)
            if inputs == "scene":
                model.step(0.5)
                assert "ignored" in warnings(slave)[0]
            elif inputs == "master":
                model.step(0.5, (0.0, 0.2, 0.0), payout_rate=0.0, current=(0, 0, 0))
            else:
                model.step(0.5, (0.0, 0.2, 0.0))
            np.testing.assert_array_equal(slave.get("force.top"), model.top_force)
            slave.close()


@pytest.mark.parametrize("option", ["inputs", "vessel_input", "timing"])
def test_options_that_there_are_not(tmp_path, option):
    with pytest.raises(ExportError, match=f"{option} is 'none'"):
        export_fmu(still_scene(), tmp_path / "x.fmu", **{option: "none"})
    assert list(tmp_path.iterdir()) == []


# -- the tow point's start -------------------------------------------------------------------------


def moved(data: dict, position, velocity) -> cm.Scene:
    data = copy.deepcopy(data)
    data["vessel"] = {"position": list(position), "velocity": [{"t": 0, "velocity": velocity}]}
    return cm.load_scene(data)


def assert_alike(slave, model, tolerance: float) -> None:
    for name, expected in python_outputs(model, STATIONS).items():
        if name in ("line.curvature", "moment.top") or name.startswith("payout"):
            continue
        scale = max(1.0, float(np.max(np.abs(expected))))
        np.testing.assert_allclose(
            slave.get(name), expected, atol=tolerance * scale, err_msg=name
        )  # fmt: skip


FREE = still_scene().to_dict()
HELD = {
    "cable_types": {"K": CABLE},
    "line": [{"cable": {"type": "K", "length": 60}}],
    "end": {"anchor": [30, 5, -40]},
    "vessel": {"position": [0, 0, 0]},
    "run": {"duration": 10, "output_interval": 0.5},
}
LET_GO = {**FREE, "initial": {"straight": [1, 0, -1]}, "payout": {}}


@pytest.mark.parametrize(
    ("data", "position", "velocity"),
    [
        (FREE, (-7.0, 3.0, 0.0), (0.0, 0.0, 0.0)),
        (FREE, (5.0, 3.0, -4.0), (0.4, 0.0, 0.0)),
        (FREE, (5.0, 3.0, 0.0), (0.3, -0.4, 0.0)),
        (HELD, (-4.0, 2.0, -1.0), (0.0, 0.0, 0.0)),
        (LET_GO, (8.0, 3.0, -1.0), (0.2, 0.0, 0.0)),
    ],
)
def test_a_start_that_is_set_is_that_of_a_scene_with_it(data, position, velocity, tmp_path):
    """At the start, and when the vessel then goes on and speeds up; after a reset it is the
    scene's own."""
    scene = cm.load_scene(data)
    with unpacked(scene, tmp_path, stations=STATIONS) as found:
        slave = Slave(
            *found, **{"vessel.start_position": position, "vessel.start_velocity": velocity}
        )
        model = cm.CableModel(moved(data, position, velocity))
        assert_alike(slave, model, 2e-3)
        np.testing.assert_array_equal(slave.get("line.position")[:3], position)
        speed = np.array(velocity)
        for n in range(10):
            speed = np.array(velocity) + 0.02 * (n + 1) * np.array([1.0, 1.0, 0.0])
            slave.set("vessel.velocity", speed)
            slave.step(0.5)
            model.step(0.5, speed, payout_rate=0.0, current=(0, 0, 0))
            assert_alike(slave, model, 2e-2)
        slave.fmu.reset()
        np.testing.assert_array_equal(slave.get("line.position")[:3], scene.vessel.position)
        slave.close()


def test_a_line_that_runs_out_starts_with_the_velocity_that_is_set(tmp_path):
    """Cable that a winch pays out from a shape that is given moves with the vessel, and along
    itself."""
    velocity = (1.0, 0.0, 0.0)
    drum = [{"cable": {"type": "K", "length": 50}}]
    data = {**LET_GO, "payout": {"rate": 0.4, "drum": drum}}
    with unpacked(cm.load_scene(data), tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, **{"vessel.start_velocity": velocity})
        model = cm.CableModel(moved(data, data["vessel"]["position"], velocity))
        assert slave.get("tension.top") == pytest.approx(model.top_tension, abs=1e-6)
        slave.set("vessel.velocity", velocity)
        slave.step(0.3)
        model.step(0.3, velocity)
        end = slave.get("line.position")[-3:]  # standing still it was 0.1 m away
        np.testing.assert_allclose(end, model.sample([model.line_length]).position[0], atol=1e-3)
        slave.close()


def test_a_start_that_is_set_and_nothing_else_goes_on(tmp_path):
    """Inputs are then what the start is: nothing stops the vessel."""
    with unpacked(still_scene(payout={}), tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, **{"vessel.start_velocity": (0.5, 0.0, 0.0)})
        before = slave.get("tension.top")
        slave.step(2.0)
        np.testing.assert_allclose(slave.get("line.position")[:3], [6.0, 3.0, 0.0], atol=1e-12)
        np.testing.assert_allclose(slave.get("tension.top"), before, rtol=1e-4)
        slave.close()


@pytest.mark.parametrize("first", [0.01, 1.0, 8.0])
def test_a_start_velocity_of_its_own_leaves_the_scenes_schedule(scheduled, first):
    """The vessel goes straight on, whatever the first step, until it is driven."""
    slave = Slave(*scheduled, **{"vessel.start_velocity": (0.0, 0.8, 0.0)})
    for dt in (first, 10.0 - first):
        slave.step(dt)
    np.testing.assert_allclose(slave.get("line.position")[:3], [5.0, 11.0, 0.0], atol=1e-12)
    slave.set("vessel.velocity", (0.8, 0.0, 0.0))
    slave.step(0.5)
    slave.step(0.5)
    assert slave.get("line.position")[0] > 5.5
    assert slave.messages == []
    slave.close()


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"initial": {"points": [[5, 3, 0], [5, 3, -30]]}}, "export the scene with another"),
        (
            {"environment": {"floor": {"z": -50, "slope": [0.1, 0.0]}}},
            "export the scene with another",
        ),
    ],
)
def test_starts_that_are_given_otherwise(changes, words, tmp_path):
    with unpacked(still_scene(**changes), tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, begin=False)
        with pytest.raises(FMICallException):
            slave.set("vessel.start_position[1]", 6.0)
        assert words in slave.messages[0][1]
        slave.set("vessel.start_position[1]", 5.0)
        slave.close()


def test_a_start_is_moved_along_a_level_floor_with_what_lies(tmp_path):
    """A lay elsewhere is that lay; depth and speed are the scene's."""
    scene = cm.load_scene(ROOT / "scenes/cable_lay.yaml")
    there = {"vessel.start_position[1]": 250.0, "vessel.start_position[2]": -80.0}
    with unpacked(scene, tmp_path, stations=STATIONS) as found:
        slave, plain = Slave(*found, **there), Slave(*found)
        for _ in range(5):
            way = slave.get("line.position").reshape(-1, 3)
            way -= plain.get("line.position").reshape(-1, 3)
            np.testing.assert_allclose(way, np.tile([250.0, -80.0, 0.0], (STATIONS, 1)), atol=1e-9)
            np.testing.assert_allclose(
                slave.get("line.tension"), plain.get("line.tension"), rtol=1e-9, atol=1e-3
            )
            slave.step(2.0)
            plain.step(2.0)
        slave.close()
        plain.close()
        slave = Slave(*found, begin=False)
        for name in ("vessel.start_position[3]", "vessel.start_velocity[1]"):
            with pytest.raises(FMICallException):
                slave.set(name, 0.5)
        slave.close()


def test_an_anchored_line_starts_at_rest(tmp_path):
    with unpacked(cm.load_scene(HELD), tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, begin=False)
        slave.fmu.setupExperiment()
        slave.set("vessel.start_velocity[1]", 0.5)
        slave.fmu.enterInitializationMode()
        with pytest.raises(FMICallException):
            slave.fmu.exitInitializationMode()
        assert "no steady state while the vessel moves" in slave.messages[-1][1]
        slave.set("vessel.start_velocity[1]", 0.0)
        slave.set("vessel.start_position[1]", -400.0)
        with pytest.raises(FMICallException):
            slave.fmu.exitInitializationMode()
        assert "out of reach" in slave.messages[-1][1]
        slave.set("vessel.start_position[1]", 1.0)
        slave.fmu.exitInitializationMode()
        with pytest.raises(FMICallException):
            slave.set("vessel.start_position[1]", 2.0)
        assert "a start is fixed" in slave.messages[-1][1]
        slave.close()
