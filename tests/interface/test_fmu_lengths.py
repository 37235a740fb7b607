"""Lengths as fixed parameters: as if the scene had been exported with them, or refused."""

import contextlib
import copy
from pathlib import Path

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmu_tools import CABLE, Slave, python_outputs, states_of_two_orders, still_scene, unpacked

import cablemodel as cm
from cablemodel.solvers.finite_element.block import SIZES, Block
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header, Scalars
from cablemodel_fmu.export import block_of

SCENES = Path(__file__).parents[2] / "scenes"
STATIONS = 7


def body(**more):
    return {"body": {**still_scene().to_dict()["line"][1]["body"], **more}}


def cable(length):
    return {"cable": {"type": "K", "length": length}}


ANCHORED = {
    "title": "Anchored",
    "cable_types": {"K": CABLE},
    "line": [cable(60.0), body(submerged_weight=-60), cable(60.0)],
    "end": {"anchor": [80, 0, -40]},
    "run": {"duration": 20, "output_interval": 0.5},
}


def with_lengths(data: dict, line: list[float], drum: list[float]) -> cm.Scene:
    """The scene with these lengths of its cables, in its own order."""
    data = copy.deepcopy(data)
    for items, lengths in ((data["line"], line), (data.get("payout", {}).get("drum", []), drum)):
        cables = [item["cable"] for item in items if item.get("cable")]
        for item, length in zip(cables, lengths, strict=True):
            item["length"] = length
    return cm.load_scene(data)


def parameters(line: list[float], drum: list[float]) -> dict[str, float]:
    names = {f"line.cable[{n}].length": value for n, value in enumerate(line, start=1)}
    return names | {f"drum.cable[{n}].length": value for n, value in enumerate(drum, start=1)}


def difference(slave, model) -> tuple[float, float]:
    """Positions in units of tau L, tensions in units of 10 tau of the largest: 1 is the promise."""
    tau = model.scene.solver.tolerance
    position = tension = 0.0
    for name, expected in python_outputs(model, STATIONS).items():
        off = float(np.max(np.abs(slave.get(name) - expected)))
        if name.endswith("position"):
            position = max(position, off / (tau * model.line_length))
        elif "tension" in name or name == "force.top":
            tension = max(tension, off / (10 * tau * model.tension_max))
        elif name.endswith(".length"):
            np.testing.assert_allclose(slave.get(name), expected, rtol=1e-12)
    return position, tension


def assert_as_with_lengths(data, line, drum, tmp_path, drive, at_start, in_run) -> None:
    scene = cm.load_scene(data)
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        slave = Slave(place, description, **parameters(line, drum))
        model = cm.CableModel(with_lengths(scene.to_dict(), line, drum))
        assert max(difference(slave, model)) < at_start
        for n in range(40):
            velocity, rate = drive(0.5 * n)
            slave.set("vessel.velocity", velocity)
            slave.set("payout.rate", rate)
            slave.step(0.5)
            model.step(0.5, velocity, payout_rate=rate, current=(0, 0, 0))
            assert max(difference(slave, model)) < in_run
        assert model.line_length != scene.line_length
        slave.close()


def winch(t):
    return (0.4 * np.sin(0.3 * t), 0.0, 0.0), 0.3 * np.sin(0.2 * t)


def heave(t):
    return (0.3 * np.sin(0.5 * t), 0.0, 0.2 * np.cos(0.4 * t) - 0.2), 0.0


@pytest.mark.parametrize(
    ("line", "drum"),
    [([40.0, 20.0], [30.0]), ([10.0, 5.0], [30.0]), ([20.0, 10.0], [8.0]), ([16.0, 8.0], [15.0])],
)
def test_a_line_scaled_as_a_whole_is_the_same_to_rounding(line, drum, tmp_path):
    """Its elements lie where those of the scene with these lengths lie; a body and the drum too."""
    data = still_scene().to_dict()
    assert_as_with_lengths(data, line, drum, tmp_path, winch, at_start=1e-9, in_run=1e-5)


def test_what_cracks_in_air_gets_finer_elements_at_any_length(tmp_path):
    """As in water, but at a limit of its own: the mesh follows a line that is jerked to and fro."""
    data = still_scene().to_dict()
    data["environment"] = {"water_density": 1.2}
    data["payout"] = {}
    line = [26.0, 13.0]
    scene = cm.load_scene(data)
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        slave = Slave(place, description, **parameters(line, []))
        model = cm.CableModel(with_lengths(scene.to_dict(), line, []))
        first = model.statistics["elements"]
        # Later than 4 s the line cracks so hard that rounding grows a thousandfold a crack.
        for n in range(15):
            velocity = (6.0 * (-1.0) ** n, 0.0, 0.0)
            slave.set("vessel.velocity", velocity)
            slave.step(0.25)
            model.step(0.25, velocity, payout_rate=0.0, current=(0, 0, 0))
            assert max(difference(slave, model)) < 1e-5
        assert model.statistics["elements"] > 4 * first
        slave.close()


@pytest.mark.parametrize(("exported", "used"), [(30.0, 16.0), (16.0, 30.0)])
def test_what_is_let_go_may_become_a_whip_by_its_length_or_cease_to_be_one(
    exported, used, tmp_path
):
    """rho Cdn d L / m is 14 of the long line and 7.5 of the short one: 10 is the limit."""
    density = 14.0 * CABLE["mass"] / (1.2 * CABLE["diameter"] * 30.0)
    data = {
        "cable_types": {"K": {**CABLE, "drag_normal": 1.2}},
        "environment": {"water_density": density},
        "line": [cable(exported)],
        "initial": {"straight": [1.0, 0.0, 0.0]},
        "run": {"duration": 2, "output_interval": 0.5},
    }
    scene = cm.load_scene(data)
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        slave = Slave(place, description, **parameters([used], []))
        model = cm.CableModel(with_lengths(data, [used], []))
        for _ in range(10):
            slave.step(0.1)
            model.step(0.1)
            assert difference(slave, model)[0] < 1.0
        slave.close()


@pytest.mark.parametrize("line", [[10.0, 20.0], [30.0, 8.0], [40.0, 5.0]])
@pytest.mark.parametrize("half_length", [0.0, 0.5])
def test_other_proportions_are_the_same_within_the_tolerance(line, half_length, tmp_path):
    data = still_scene().to_dict()
    if half_length:
        data["line"][1] = body(half_length=half_length, centre_offset=0.2, rotary_inertia=0.6)
    assert_as_with_lengths(data, line, [15.0], tmp_path, winch, at_start=0.05, in_run=1.0)


@pytest.mark.parametrize("line", [[50.0, 65.0], [70.0, 60.0]])
def test_an_anchored_line_with_a_buoy(line, tmp_path):
    assert_as_with_lengths(ANCHORED, line, [], tmp_path, heave, at_start=1.0, in_run=1.0)


def test_a_line_in_waves(tmp_path):
    data = still_scene().to_dict()
    data["environment"]["waves"] = {"regular": {"height": 1.0, "period": 6}}
    data["vessel"]["position"] = [5, 3, -2]
    assert_as_with_lengths(data, [26.0, 13.0], [15.0], tmp_path, winch, at_start=0.05, in_run=1.0)


@pytest.mark.parametrize("factor", [0.5, 1.3, 2.0])
def test_a_straight_start_and_the_scenes_own_schedule(factor, tmp_path):
    scene = cm.load_scene(SCENES / "deployment.yaml")
    lengths = [factor * item.length for item in scene.cables]
    drum = [item.cable.length for item in scene.payout.drum if item.cable is not None]
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        slave = Slave(place, description, **parameters(lengths, drum))
        model = cm.CableModel(with_lengths(scene.to_dict(), lengths, drum))
        for _ in range(20):
            slave.step(scene.run.output_interval)
            model.step(scene.run.output_interval)
            assert max(difference(slave, model)) < 1e-2
        slave.close()


def test_the_description_says_what_may_be_set(tmp_path):
    scene = still_scene()
    with unpacked(scene, tmp_path, stations=3) as (_, description):
        found = {
            v.name: v for v in description.modelVariables if v.name.endswith("cable[1].length")
        }
        assert set(found) == {"line.cable[1].length", "drum.cable[1].length"}
        length = found["line.cable[1].length"]
        assert (length.causality, length.variability, length.unit) == ("parameter", "fixed", "m")
        assert [float(v) for v in (length.start, length.min, length.max)] == [20.0, 10.0, 40.0]


def test_the_order_in_which_values_are_set_does_not_matter(tmp_path):
    """Nor that outputs are read in between; a reset forgets the lengths."""
    with unpacked(still_scene(), tmp_path, stations=3) as (place, description):
        first, second = (Slave(place, description, begin=False) for _ in range(2))
        length = ("line.cable[1].length", 25.0)
        weight = ("cable_types.K.submerged_weight", 3.0)
        states = states_of_two_orders(first, second, length, weight, 12.0, "tension.top")
        assert states[0] == states[1]
        assert first.get("line.length") == 35.0
        first.fmu.reset()
        assert first.get("line.length") == 30.0
        assert first.get("line.cable[1].length") == 20.0
        first.fmu.setFMUstate(first.fmu.deSerializeFMUstate(states[1]))
        first.step(1.0)
        second.step(1.0)
        assert first.get("end.position").tobytes() == second.get("end.position").tobytes()
        first.close()
        second.close()


def refusal(slave, name, value) -> str:
    slave.messages.clear()
    with pytest.raises(FMICallException):
        slave.set(name, value)
    return slave.messages[0][1]


def test_lengths_that_are_refused(tmp_path):
    with unpacked(still_scene(), tmp_path, stations=3) as (place, description):
        slave = Slave(place, description, begin=False)
        slave.fmu.setupExperiment()
        for value in (9.9, 40.1, -1.0, float("nan")):
            assert "10 to 40 are allowed" in refusal(slave, "line.cable[1].length", value)
        slave.fmu.enterInitializationMode()
        slave.set("line.cable[1].length", 11.0)
        slave.fmu.exitInitializationMode()
        assert "a length is fixed" in refusal(slave, "line.cable[1].length", 12.0)
        slave.close()


@pytest.mark.parametrize(
    "changes",
    [
        {"initial": {"points": [[5, 3, 0], [5, 3, -30]]}},
        {"environment": {"floor": {"z": -50}}},
    ],
)
def test_lines_whose_lengths_are_given_otherwise(changes, tmp_path):
    with unpacked(still_scene(**changes), tmp_path, stations=3) as (place, description):
        slave = Slave(place, description, begin=False)
        assert "export the scene with others" in refusal(slave, "line.cable[1].length", 21.0)
        slave.set("line.cable[1].length", 20.0)
        slave.close()


def test_an_anchor_out_of_reach(tmp_path):
    with unpacked(cm.load_scene(ANCHORED), tmp_path, stations=3) as (place, description):
        slave = Slave(place, description, begin=False)
        slave.fmu.setupExperiment()
        for n in (1, 2):
            slave.set(f"line.cable[{n}].length", 30.0)
        slave.fmu.enterInitializationMode()
        with pytest.raises(FMICallException):
            slave.fmu.exitInitializationMode()
        assert "89.4427 m from the vessel, out of reach of 60 m of line" in slave.messages[-1][1]
        slave.set("line.cable[1].length", 60.0)
        slave.fmu.exitInitializationMode()
        slave.step(0.5)
        slave.close()


SLACK = {
    "cable_types": {"K": {**CABLE, "bending_stiffness": 0.5}},
    "line": [cable(85.0)],
    "end": {"anchor": [80, 0, -20]},
}
CLAMPED = {
    "cable_types": {"K": {**CABLE, "bending_stiffness": 50.0, "submerged_weight": 0.5}},
    "line": [cable(60.0)],
    "vessel": {"connection": {"clamped": [1, 0, -0.2]}},
}

UPRIGHT = {
    "cable_types": {"K": {**CABLE, "bending_stiffness": 50.0, "submerged_weight": 2.0}},
    "line": [cable(4.0)],
    "vessel": {"connection": {"clamped": [0, 0, 1]}},
}
"""Bends over where it is longer than 5.8 m: q L^3 / EI = 7.84 (Greenhill)."""
ABOVE = {
    **SLACK,
    "line": [cable(30.0)],
    "vessel": {"position": [0, 0, -30]},
    "end": {"anchor": [2, 0, 0]},
}


@pytest.mark.parametrize(
    ("data", "values", "said"),
    [
        (SLACK, {"line.cable[1].length": 100.0}, []),
        (SLACK, {"line.cable[1].length": 160.0}, ["bends"]),
        (SLACK, {"vessel.start_position[1]": 30.0}, ["bends"]),
        (CLAMPED, {"cable_types.K.submerged_weight": 50.0}, ["bends"]),
        (UPRIGHT, {"line.cable[1].length": 5.6}, ["presses"]),
        ({**SLACK, "end": "free"}, {"cable_types.K.submerged_weight": 2.0}, []),
    ],
)
def test_a_start_that_is_not_one_to_go_by_is_warned_of(data, values, said, tmp_path):
    """It bends more than the elements follow, or presses a line that would fall out of it."""
    with unpacked(cm.load_scene(data), tmp_path, stations=3) as (place, description):
        slave = Slave(place, description, **values)
        assert [status for status, _ in slave.messages] == [1] * len(said)
        for word, (_, text) in zip(said, slave.messages, strict=True):
            assert word in text
            assert "export the scene with these values" in text
        if said == ["presses"]:
            assert f"lowest tension {slave.get('tension.top'):g} N" in slave.messages[0][1]
            assert slave.get("tension.top") == pytest.approx(-2.0 * 5.6, rel=1e-6)
        slave.close()


JUMPER = {
    "cable_types": {
        "J": {"diameter": 0.03, "mass": 1.5, "axial_stiffness": 5e6, "bending_stiffness": 5,
              "drag_normal": 1.2, "drag_tangential": 0.01}
    },
    "line": [{"cable": {"type": "J", "length": 66}}],
    "end": {"anchor": [40, 0, -25]},
    "vessel": {"position": [0, 0, 3]},
}  # fmt: skip


@pytest.mark.parametrize(
    ("length", "at"),
    [*((length, 0.0) for length in (84.0, 88.0, 90.0, 110.0, 130.0)), (66.0, 30.0)],
)
def test_elements_follow_a_line_that_bends_more_than_the_scenes(length, at, tmp_path):
    """On the scene's elements it rang by a third of its tension, and far longer by all of it."""
    vessel = {"position": [at, 0, 3]}
    with unpacked(cm.load_scene(JUMPER), tmp_path, stations=STATIONS) as found:
        values = {"line.cable[1].length": length, "vessel.start_position[1]": at}
        slave = Slave(*found, **values)
        model = cm.CableModel(with_lengths({"title": "", **JUMPER, "vessel": vessel}, [length], []))
        for _ in range(40):
            assert max(difference(slave, model)) < 1.0
            slave.step(0.25)
            model.step(0.25)
        slave.close()


@pytest.mark.parametrize(
    ("data", "name", "value"),
    [
        (UPRIGHT, "line.cable[1].length", 6.0),
        (UPRIGHT, "cable_types.K.submerged_weight", 7.0),
        ({**SLACK, "end": "free"}, "cable_types.K.submerged_weight", -2.0),
        *((ABOVE, "line.cable[1].length", length) for length in (31.0, 36.0, 57.0)),
    ],
)
def test_a_start_that_falls_by_itself_is_refused(data, name, value, tmp_path):
    """The library looks for another one; the value set back begins as the scene."""
    with unpacked(cm.load_scene(data), tmp_path, stations=3) as (place, description):
        slave, plain = Slave(place, description, begin=False), Slave(place, description)
        slave.fmu.setupExperiment()
        slave.set(name, value)
        slave.fmu.enterInitializationMode()
        with pytest.raises(FMICallException):
            slave.fmu.exitInitializationMode()
        said = slave.messages[-1][1]
        assert f"{name} is not the scene's: the start that is found with it falls" in said
        assert "export the scene with this value" in said
        slave.set(name, plain.get(name))
        slave.fmu.exitInitializationMode()
        for one in (slave, plain):
            one.step(0.5)
        assert slave.get("line.position").tobytes() == plain.get("line.position").tobytes()
        slave.close()
        plain.close()


@pytest.mark.parametrize("factor", [0.98, 1.02, 1.05, 1.1, 1.3, 1.5, 1.9])
def test_a_line_below_its_anchor_starts_as_the_library_or_says_something(factor, tmp_path):
    """Straight above or aside, taut and with slack that hangs doubled: a start that is not the
    library's, within the promise, is warned of or refused."""
    for x in (0.0, 2.0):
        data = {**ABOVE, "end": {"anchor": [x, 0, 0]}}
        length = 30.0 * factor
        with unpacked(cm.load_scene(data), tmp_path, stations=STATIONS) as (place, description):
            slave = Slave(place, description, begin=False)
            with contextlib.suppress(FMICallException):
                slave._begin(**{"line.cable[1].length": length})
            model = cm.CableModel(with_lengths(cm.load_scene(data).to_dict(), [length], []))
            assert slave.messages or max(difference(slave, model)) < 1.0
            slave.close()


def test_a_start_on_a_sea_floor_is_not_found_anew(tmp_path):
    """What lies rests as it came there; values set back leave the start as it was exported."""
    scene = still_scene(environment={"floor": {"z": -22}}, payout={})
    name = "cable_types.K.added_mass"
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        slave, plain = Slave(place, description, begin=False), Slave(place, description)
        slave.fmu.setupExperiment()
        slave.fmu.enterInitializationMode()
        slave.set(name, 1.0 + 1e-7)
        with pytest.raises(FMICallException):
            slave.fmu.exitInitializationMode()
        said = slave.messages[-1][1]
        assert f"{name} is not the scene's 1: of a line on a sea floor" in said
        assert "export the scene with this value" in said
        slave.set(name, 1.0)
        slave.fmu.exitInitializationMode()
        for one in (slave, plain):
            one.step(0.5)
        assert slave.get("line.position").tobytes() == plain.get("line.position").tobytes()
        assert slave.get("tension.top") == plain.get("tension.top")
        slave.set(name, 1.5)  # it may be, in the run
        slave.step(0.5)
        assert slave.get(name) == 1.5
        slave.close()
        plain.close()


@pytest.mark.parametrize(("weight", "refused"), [(3.0, False), (300.0, True)])
def test_above_a_sea_floor_it_is_but_not_down_to_it(weight, refused, tmp_path):
    data = still_scene(environment={"floor": {"z": -31}}, payout={}).to_dict()
    data["line"] = [cable(30.0)]
    data["cable_types"]["K"]["axial_stiffness"] = 1e4
    changed = copy.deepcopy(data)
    changed["cable_types"]["K"]["submerged_weight"] = weight
    with unpacked(cm.load_scene(data), tmp_path, stations=STATIONS) as (place, description):
        values = {"cable_types.K.submerged_weight": weight}
        if refused:
            with pytest.raises(FMICallException):
                Slave(place, description, **values)
            return
        slave = Slave(place, description, **values)
        assert max(difference(slave, cm.CableModel(cm.load_scene(changed)))) < 0.1
        slave.close()


# -- the block -------------------------------------------------------------------------------------

SIZES_OF_MEMORY = {Header.byte_count.word, Header.image_words.word, Header.capacity.word}
"""What an export with the lengths may have another room by."""


def blocks(data: dict, line: list[float], drum: list[float], tmp_path):
    """The block of an FMU with these lengths at its start, and that of an export with them."""
    scene = cm.load_scene(data)
    expected = block_of(with_lengths(scene.to_dict(), line, drum))
    with unpacked(scene, tmp_path, stations=3) as (place, description):
        slave = Slave(place, description, **parameters(line, drum))
        state = np.frombuffer(slave.fmu.serializeFMUstate(slave.fmu.getFMUstate()), dtype="<i8")
        slave.close()
    size = len(block_of(scene).image)
    return state[-size:].copy(), expected


def assert_same_scalars(found, expected) -> None:
    reals = found.view("<f8")
    placed = {place for arrays in Block.arrays(**dict.fromkeys(SIZES, 0)) for place, _ in arrays}
    for name, word_of in Header.FIELDS.items():
        if word_of.word not in SIZES_OF_MEMORY | placed:
            assert found[word_of.word] == expected.ints[word_of.word], name
    for name, word_of in Scalars.FIELDS.items():
        if name != "most_nodes":
            own = slice(
                at.HEADER_WORDS + word_of.word, at.HEADER_WORDS + word_of.word + word_of.words
            )
            assert reals[own] == pytest.approx(expected.reals[own], rel=1e-9), name


def assert_same_tables(found, expected) -> None:
    """Everything of nodes, cables, bodies and ends, to rounding."""
    reals, ints = found.view("<f8"), expected.ints
    head = Header(ints)
    nodes, size = int(head.nodes), 2 * int(head.dimension)
    length, tension = expected.scalars.length, expected.scalars.tension_scale
    for place, rows, words, scale in (
        (Header.edges.word, nodes, at.EDGE_WORDS, 0.0),
        (Header.cables.word, int(head.cable_count), at.CABLE_WORDS, 0.0),
        (Header.bodies.word, int(head.body_count), at.BODY_WORDS, 0.0),
        (Header.constraints.word, int(head.constraint_count), at.CONSTRAINT_WORDS, 0.0),
        (Header.position.word, nodes, size, length),
        (Header.velocity.word, nodes, size, 1.0),
        (Header.acceleration.word, nodes, size, 1.0),
        (Header.tension.word, nodes, 2, tension),
        (Header.tension_rate.word, nodes, 2, tension),
        (Header.rest.word, nodes, size, length),
        (Header.history.word, nodes, 2 * size, length),
    ):
        name = next(n for n, word_of in Header.FIELDS.items() if word_of.word == place)
        start, own = found[place], ints[place]
        np.testing.assert_allclose(
            reals[start : start + rows * words].reshape(rows, words),
            expected.reals[own : own + rows * words].reshape(rows, words),
            rtol=1e-8,
            atol=1e-8 * scale,
            err_msg=name,
        )
    for place in (Header.parent.word, Header.joint.word):
        start, own = found[place], ints[place]
        np.testing.assert_array_equal(found[start : start + nodes], ints[own : own + nodes])


FREE = still_scene().to_dict()
ALONE = {"cable_types": {"K": CABLE}, "run": {"duration": 2, "output_interval": 0.5}}
STRAIGHT = {**ALONE, "initial": {"straight": [1.0, 0.0, 0.0]}}
GETS_UNDER_WAY = [{"t": 0, "velocity": [0, 0, 0]}, {"t": 5, "velocity": [1, 0, 0]}]
ROPE = {**CABLE, "diameter": 0.02}
ON_DRUM = [{"cable": {"type": "R", "length": length}} for length in (6.0, 4.0)]
TWO_ON_DRUM = {
    **FREE, "cable_types": {**FREE["cable_types"], "R": ROPE}, "payout": {"drum": ON_DRUM},
}  # fmt: skip
RIGID = {**FREE, "line": [cable(20.0), body(half_length=0.5, rotary_inertia=0.6), cable(10.0)]}


@pytest.mark.parametrize(
    ("data", "line", "drum"),
    [
        (FREE, [40.0, 20.0], [30.0]),
        (FREE, [10.0, 5.0], [30.0]),
        (TWO_ON_DRUM, [30.0, 15.0], [9.0, 5.0]),
        ({**RIGID, "end": "free"}, [30.0, 15.0], [22.5]),
        ({**STRAIGHT, "line": [cable(4.0)]}, [8.0], []),
        ({**STRAIGHT, "line": [cable(8.0)]}, [4.0], []),
        ({**STRAIGHT, "line": [cable(6.0)]}, [7.0], []),
        ({**ALONE, "line": [cable(4.0)]}, [8.0], []),
        ({**ALONE, "line": [cable(8.0)]}, [4.0], []),
        ({**ALONE, "line": [cable(30.0)], "vessel": {"velocity": GETS_UNDER_WAY}}, [20.0], []),
    ],
)
def test_the_whole_block_is_that_of_an_export_with_the_lengths(data, line, drum, tmp_path):
    """All numbers, not the places alone: from the first step to what the mesh may bend."""
    found, expected = blocks(data, line, drum, tmp_path)
    assert_same_scalars(found, expected)
    assert_same_tables(found, expected)


@pytest.mark.parametrize(("exported", "used"), [(30.0, 16.0), (16.0, 30.0)])
def test_what_a_line_is_like_follows_its_length(exported, used, tmp_path):
    """Across the limit of light damping other numbers hold, of which the elements' is not one; and
    there is room for a mesh that follows bending, where the exported one did not."""
    density = 14.0 * CABLE["mass"] / (1.2 * CABLE["diameter"] * 30.0)
    kind = {**CABLE, "drag_normal": 1.2}
    data = {**STRAIGHT, "cable_types": {"K": kind}, "environment": {"water_density": density}}
    found, expected = blocks({**data, "line": [cable(exported)]}, [used], [], tmp_path)
    head = Header(found)
    reals = found.view("<f8")
    state = Scalars(reals)
    for name in ("bent", "step", "time_tolerance", "memory", "order_3", "undamped"):
        told = getattr(expected.scalars, name)
        assert getattr(Scalars(reals), name) == pytest.approx(told, rel=1e-9), name
    assert (state.bent > 0.0) == (used == 30.0)
    assert head.capacity > head.nodes + 20 or used == 16.0
