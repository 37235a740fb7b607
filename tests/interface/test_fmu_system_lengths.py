"""Lengths of a system's cables as fixed parameters: as if the scene had been exported with them, or
refused."""

from __future__ import annotations

import contextlib
import copy
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmu_tools import Slave, states_of_two_orders, unpacked
from test_fmu_system_starts import (
    SCENES,
    begun,
    moored,
    named,
    promised,
    refused,
    standing,
    two_ships,
    weighted,
)
from test_fmu_systems import STATIONS, numbers_of, still, tow, wire

import cablemodel as cm
from cablemodel.errors import UnstableStartWarning
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header, Scalars
from cablemodel.systems import SystemModel
from cablemodel_fmu.model_file import ModelFile
from tests.verification.test_system_small_motions import towed_wing

Lengths = dict[str, list[float]]


def with_lengths(scene: cm.SystemScene, lengths: Lengths) -> cm.SystemScene:
    """The scene with other lengths of the cables of lines, or on winches' drums, by name."""
    data = copy.deepcopy(scene.to_dict())
    for name, own in lengths.items():
        items = data["lines"][name]["items"] if name in data["lines"] else None
        items = data["winches"][name]["drum"] if items is None else items
        cables = [item["cable"] for item in items if item.get("cable")]
        for cable, length in zip(cables, own, strict=True):
            cable["length"] = length
    return cm.load_system(data)


def parameters(lengths: Lengths) -> dict[str, float]:
    return {
        f"{name}.cable[{n}].length": value
        for name, own in lengths.items()
        for n, value in enumerate(own, start=1)
    }


def scaled(scene: cm.SystemScene, **factors: float) -> Lengths:
    """All cables of lines and of winches' drums by a factor each."""
    found: Lengths = {}
    for name, factor in factors.items():
        cables = (
            [item.cable for item in scene.lines[name].items if item.cable is not None]
            if name in scene.lines
            else scene.winches[name].drum_cables
        )
        found[name] = [factor * cable.length for cable in cables]
    return found


def stored(name: str) -> cm.SystemScene:
    return cm.load_system(SCENES / f"{name}.yaml")


def job(name: str) -> cm.SystemScene:
    return cm.load_system(SCENES.parents[1] / "docs" / "jobs" / f"{name}.yaml")


def hoisted(rate: float = 0.5) -> cm.SystemScene:
    """A load on a line that is told from there, and ends at a winch with a weight and a rope on its
    drum, of counted elements."""
    data = still(cuts={}).to_dict()
    data["cable_types"]["rope"] = {"diameter": 0.02, "mass": 0.4, "axial_stiffness": 2e5}
    data["lines"]["wire"] = {
        "from": "load.eye", "to": "ship.hook", "items": [wire(12, elements=4), wire(8, elements=4)],
    }  # fmt: skip
    weight = {"mass": 20.0, "submerged_weight": 150.0, "drag_area": 0.1}
    rope = {"cable": {"type": "rope", "length": 3.0, "elements": 2}}
    drum = [{"cable": {"type": "wire", "length": 2.0}}, {"body": weight}, rope]
    data["winches"] = {"hoist": {"line": "wire", "at": "end", "drum": drum, "rate": rate}}
    return cm.load_system(data)


def between_winches() -> cm.SystemScene:
    """A rope between two ships, with a winch at each end."""
    data = two_ships().to_dict()
    data["bodies"] = {}
    data["lines"] = {"rope": {"from": "a.p", "to": "b.p", "items": [wire(80)]}}
    rate = [{"t": 0, "rate": 0}, {"t": 1, "rate": 0.3}]
    data["winches"] = {
        "left": {"line": "rope", "drum": 30.0, "rate": rate},
        "right": {"line": "rope", "at": "end", "drum": 20.0, "rate": rate},
    }
    return cm.load_system(data)


def branched() -> cm.SystemScene:
    """A line of two cables with a branch off the first one."""
    data = still(cuts={}).to_dict()
    data["lines"]["wire"]["items"] = [wire(20), wire(10)]
    data["lines"]["tail"] = {"from": {"line": "wire", "at": 8.0}, "to": {}, "items": [wire(5)]}
    return cm.load_system(data)


def block_of(slave: Slave, model: SystemModel) -> np.ndarray[Any, np.dtype[np.int64]]:
    """The image in a state of the FMU."""
    state = np.frombuffer(slave.fmu.serializeFMUstate(slave.fmu.getFMUstate()), dtype=np.int64)
    block = model.built.block
    for place in np.flatnonzero(state == block.ints[Header.magic.word]):
        image = state[place - Header.magic.word :]
        if block.fits(image):
            return image.copy()
    raise AssertionError("no block in the state")


def assert_same_numbers(slave: Slave, model: SystemModel) -> None:
    """All numbers of the system as a whole, and the tables of what runs past winches; for this the
    mesh has to be the same."""
    image, block = block_of(slave, model), model.built.block
    reals = image.view(np.float64)
    assert image[Header.nodes.word] == block.header.nodes
    for name, word_of in Scalars.FIELDS.items():
        first = at.HEADER_WORDS + word_of.word
        if name not in ("most_nodes", "joined"):
            own = slice(first, first + word_of.words)
            np.testing.assert_allclose(reals[own], block.reals[own], rtol=1e-9, err_msg=name)
    for place, count, words in (
        (Header.edges.word, int(block.header.nodes), at.EDGE_WORDS),
        (Header.cables.word, int(block.header.cable_count), at.CABLE_WORDS),
        (Header.winches.word, int(block.header.winch_count), at.WINCH_WORDS),
    ):
        own, other = int(image[place]), int(block.ints[place])
        np.testing.assert_allclose(
            reals[own : own + count * words].reshape(count, words),
            block.reals[other : other + count * words].reshape(count, words),
            rtol=1e-9,
            atol=1e-12,
        )


CASES: dict[str, Any] = {
    "one line between two": (two_ships, {"star": 1.3}),
    "lines between ships": (two_ships, {"star": 0.8, "port": 0.8}),
    "a load on a wire": (still, {"wire": 2.0}),
    "half of that": (lambda: still(cuts={}), {"wire": 0.5}),
    "clamps, foils and waves": (tow, {"port": 1.1, "tail": 0.7, "hoist": 1.1}),
    "chains on the floor": (moored, {"bow": 1.05}),
    "slack chains on the floor": (moored, {"bow": 1.13, "aft": 1.13}),
    "a slack leg of a bridle": (lambda: job("bridle"), {"port": 1.247, "starboard": 0.986}),
    "slack warps": (lambda: stored("otter_boards"), {"port_warp": 1.4, "starboard_warp": 1.4,
                                                     "rope": 1.4}),
    "friction on chains": (lambda: stored("buoy_on_three_legs"), {"a": 0.95}),
    "slack chains in waves": (lambda: stored("buoy_on_three_legs"), {"a": 1.5, "b": 1.5, "c": 1.5}),
    "a bridle": (lambda: stored("bridle_tow"), {"port": 1.05, "starboard": 1.05}),
    "otter boards": (lambda: stored("otter_boards"), {"port_warp": 0.95}),
    "a vehicle's tether": (lambda: stored("cage_and_vehicle"), {"tether": 1.1, "umbilical": 0.9}),
    "a cage and its drum": (lambda: stored("cage_on_its_winch"), {"umbilical": 1.05, "winch": 0.7}),
    "drums at both ends": (between_winches, {"rope": 1.1, "left": 1.5, "right": 0.6}),
    "a drum at the end": (hoisted, {"wire": 1.4, "hoist": 1.5}),
    "an array on its drum": (lambda: stored("array_from_its_drum"), {"array": 1.2, "winch": 0.6}),
}  # fmt: skip
SAME_MESH = ("a load on a wire", "half of that", "one line between two", "lines between ships",
             "a bridle", "a cage and its drum", "a drum at the end", "an array on its drum",
             "drums at both ends", "friction on chains", "slack chains in waves")  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_it_starts_as_the_scene_with_these_lengths(case: str, tmp_path: Path) -> None:
    """And goes on so, with what the scene schedules."""
    source, factors = CASES[case]
    scene = source()
    lengths = scaled(scene, **factors)
    model = SystemModel(with_lengths(scene, lengths))
    with unpacked(scene, tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, use_scene_inputs=True, **parameters(lengths))
        if case in SAME_MESH:
            assert_same_numbers(slave, model)
        for name, value in parameters(lengths).items():
            assert slave.get(name) == value
        for _ in range(6):
            assert max(promised(slave, model)) < 1.0
            slave.step(0.5)
            model.step(0.5)
        assert max(promised(slave, model)) < 1.0
        for name, winch in model.winches.items():
            assert slave.get(f"{name}.line.length") == pytest.approx(winch.line_length, rel=1e-9)
            assert slave.get(f"{name}.drum.length") == pytest.approx(winch.drum_length, rel=1e-9)
        assert slave.messages == []
        slave.close()


def test_each_cable_of_a_line_by_itself_with_bodies_between_and_a_start(tmp_path: Path) -> None:
    scene = weighted()
    lengths = {"wire": [13.0, 8.0, 7.5]}
    starts = {"ship": {"position": [5.0, 0, 0], "velocity": [1.0, 0, 0]}}
    model = SystemModel(begun(with_lengths(scene, lengths), starts))
    with unpacked(scene, tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, use_scene_inputs=True, **parameters(lengths), **named(starts))
        for _ in range(6):
            assert max(promised(slave, model)) < 1e-6
            slave.step(0.5)
            model.step(0.5)
        slave.close()


@pytest.mark.parametrize("source", [between_winches, hoisted])
def test_winches_run_until_their_drums_of_other_lengths_are_empty(
    source: Any, tmp_path: Path
) -> None:
    """And in, as far as the line goes."""
    scene = source()
    drums = scaled(scene, **dict.fromkeys(scene.winches, 0.5))
    lengths = drums | scaled(scene, **dict.fromkeys(scene.lines, 1.2))
    model = SystemModel(with_lengths(scene, lengths))
    with unpacked(scene, tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, **parameters(lengths))
        for rate in [1.0] * 30 + [-1.0] * 30:
            for name in scene.winches:
                slave.set(f"{name}.rate", rate)
            slave.step(0.5)
            model.step(0.5, rates=dict.fromkeys(scene.winches, rate))
            for name, winch in model.winches.items():
                told = slave.get(f"{name}.line.length"), slave.get(f"{name}.drum.length")
                assert told == pytest.approx((winch.line_length, winch.drum_length), abs=1e-9)
        slave.close()


def test_the_order_does_not_matter_and_a_reset_forgets(tmp_path: Path) -> None:
    """Nor that outputs are read in between; a state holds the lengths."""
    with unpacked(two_ships(), tmp_path, stations=STATIONS) as found:
        names = [v.name for v in found[1].modelVariables if v.causality == "output"]
        plain, first, second = Slave(*found), *(Slave(*found, begin=False) for _ in range(2))
        length, start = ("port.cable[1].length", 70.0), ("b.start_position[2]", 50.0)
        states = states_of_two_orders(first, second, length, start, 45.0, "net.position")
        assert states[0] == states[1]
        other = Slave(*found)
        other.fmu.setFMUstate(other.fmu.deSerializeFMUstate(states[0]))
        for slave in (first, other):
            slave.step(0.5)
        assert other.get("port.cable[1].length") == 70.0
        np.testing.assert_array_equal(numbers_of(first, names), numbers_of(other, names))
        first.begin_again()
        np.testing.assert_array_equal(numbers_of(first, names), numbers_of(plain, names))
        for slave in (plain, first, second, other):
            slave.close()


def test_what_the_description_says(tmp_path: Path) -> None:
    """What is before a branch is the scene's: it stays where it is."""
    with unpacked(branched(), tmp_path, stations=STATIONS) as (place, about):
        rows = {v.name: v for v in about.modelVariables if v.name.endswith("].length")}
        limits = {name: (float(v.min), float(v.start), float(v.max)) for name, v in rows.items()}
        assert limits == {
            "wire.cable[1].length": (20.0, 20.0, 20.0),
            "wire.cable[2].length": (5.0, 10.0, 20.0),
            "tail.cable[1].length": (2.5, 5.0, 10.0),
        }
        tail = rows["tail.cable[1].length"]
        assert (tail.causality, tail.variability, tail.unit) == ("parameter", "fixed", "m")
        lengths = {"wire": [20.0, 14.0], "tail": [7.0]}
        model = SystemModel(with_lengths(branched(), lengths))
        slave = Slave(place, about, **parameters(lengths))
        for _ in range(4):
            assert max(promised(slave, model)) < 1.0
            slave.step(0.5)
            model.step(0.5)
        slave.close()


def refusal(slave: Slave, name: str, value: float) -> str:
    slave.messages.clear()
    with pytest.raises(FMICallException):
        slave.set(name, value)
    return str(slave.messages[0][1])


def test_lengths_that_are_refused(tmp_path: Path) -> None:
    with unpacked(branched(), tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, begin=False)
        slave.fmu.setupExperiment()
        for value in (4.9, 20.1, -1.0, float("nan")):
            assert "5 to 20 are allowed" in refusal(slave, "wire.cable[2].length", value)
        said = refusal(slave, "wire.cable[1].length", 21.0)
        assert "wire.cable[1].length" in said
        assert "a line branches off beyond" in said
        slave.fmu.enterInitializationMode()
        slave.fmu.exitInitializationMode()
        assert "a length is fixed" in refusal(slave, "wire.cable[2].length", 12.0)
        slave.close()


def test_where_friction_holds_a_body_lengths_are_the_scenes(tmp_path: Path) -> None:
    with unpacked(standing(), tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, begin=False)
        assert "friction holds bodies" in refusal(slave, "wire.cable[1].length", 21.0)
        slave.set("wire.cable[1].length", 20.0)
        slave.close()


def test_a_line_that_is_cut_beyond_its_end(tmp_path: Path) -> None:
    """As the scene with that length would be refused; the next value is taken."""
    scene = stored("weak_link")
    at = scene.cuts["weak_link"].at
    with pytest.raises(cm.SceneError, match=r"cuts\.weak_link\.at"):
        with_lengths(scene, scaled(scene, wire=0.95))
    with unpacked(scene, tmp_path, stations=STATIONS) as found:
        slave, plain = Slave(*found, begin=False), Slave(*found)
        slave.fmu.setupExperiment()
        slave.fmu.enterInitializationMode()
        length = scene.lines["wire"].length
        slave.set("wire.cable[1].length", 0.95 * length)
        refused(slave, f"a cut at {at:g} m is beyond wire, which has {0.95 * length:g} m")
        slave.set("wire.cable[1].length", length)
        slave.fmu.exitInitializationMode()
        assert slave.get("wire.tension.start") == plain.get("wire.tension.start")
        slave.close()
        plain.close()


def test_a_line_whose_ends_are_out_of_reach(tmp_path: Path) -> None:
    with unpacked(moored(), tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, begin=False)
        slave.fmu.setupExperiment()
        slave.set("bow.cable[1].length", 150.0)
        slave.fmu.enterInitializationMode()
        refused(slave, "bow ends 208.806 m apart, out of reach of its 150 m")
        slave.set("bow.cable[1].length", 225.0)
        slave.fmu.exitInitializationMode()
        slave.step(0.5)
        slave.close()


def test_errors_are_estimated_at_the_same_lengths(tmp_path: Path) -> None:
    """Else the estimate would be how far the finer run is from there."""
    scene = two_ships(solver={"error_estimate": True})
    lengths = {"port": [75.0]}
    model = SystemModel(with_lengths(scene, lengths))
    with unpacked(scene, tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, **parameters(lengths))
        for _ in range(3):
            for name, errors in model.errors.items():
                told = slave.get(f"{name}.error.position")
                assert told == pytest.approx(errors.position, rel=0.02, abs=1e-6)
            slave.step(0.5)
            model.step(0.5)
        slave.close()


def test_a_search_ends_with_the_scenes_time_limit(tmp_path: Path) -> None:
    """By the work that it is on a slow machine, not by a clock: it is the same on all."""
    lengths = parameters(scaled(moored(), bow=1.25, aft=1.13))
    to_bytes = ModelFile.to_bytes
    for limit in (60.0, 0.6):
        with pytest.MonkeyPatch.context() as patch:

            def hasty(self: ModelFile, share: float = limit / 60.0) -> bytes:
                assert self.search == pytest.approx(60.0 / 6e-6)
                return to_bytes(replace(self, search=share * self.search))

            patch.setattr(ModelFile, "to_bytes", hasty)
            with unpacked(moored(), tmp_path, stations=STATIONS) as found:
                slave = Slave(*found, begin=False)
                if limit == 60.0:
                    slave._begin(**lengths)
                    slave.step(0.5)
                else:
                    with pytest.raises(FMICallException):
                        slave._begin(**lengths)
                    assert "ended with the scene's solver.start_time_limit" in slave.messages[-1][1]
                slave.close()


FACTORS = 0.7, 0.85, 1.0, 1.1, 1.2, 1.4, 1.5
READY: dict[str, tuple[float, ...]] = {
    "anchor_last": (),
    "array_from_its_drum": (),
    "bridle_tow": (),
    "cage_and_vehicle": (),
    "cage_on_its_winch": (),
    "depressor": (),
    "otter_boards": (1.2,),
    "streamer": (),
}
"""Ready scenes, and by how much longer all their lines are where they swing up by themselves."""
SWINGS_UP = "this start swings up by itself, as that of a scene with these values does"


@pytest.mark.parametrize("name", READY)
def test_all_lines_longer_or_shorter_start_as_in_the_library(name: str, tmp_path: Path) -> None:
    """And are warned of where that warns."""
    scene = stored(name)
    with unpacked(scene, tmp_path, stations=STATIONS) as found:
        for factor in FACTORS:
            lengths = scaled(scene, **dict.fromkeys(scene.lines, factor))
            slave = Slave(*found, begin=False)
            slave._begin(**parameters(lengths))
            swings = factor in READY[name]
            with pytest.warns(UnstableStartWarning) if swings else contextlib.nullcontext():
                model = SystemModel(with_lengths(scene, lengths))
            assert max(promised(slave, model)) < 1.0
            slow = [text for _, text in slave.messages if "stretched" not in text]
            assert slow == [f"fmi2ExitInitializationMode: {SWINGS_UP}"] * swings
            slave.close()


@pytest.mark.filterwarnings("ignore::cablemodel.errors.UnstableStartWarning")
def test_lengths_at_which_it_falls_are_refused(tmp_path: Path) -> None:
    """The library looks where it falls to."""
    scene = stored("otter_boards")
    lengths = parameters(scaled(scene, **dict.fromkeys(scene.lines, 1.35)))
    with unpacked(scene, tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, begin=False)
        with pytest.raises(FMICallException):
            slave._begin(**lengths)
        said = slave.messages[-1][1]
        assert f"{next(iter(lengths))} is not the scene's: the start that is found with it" in said
        assert "falls by itself; export the scene with this value" in said
        slave.close()


def test_a_speed_at_which_it_swings_up_is_warned_of(tmp_path: Path) -> None:
    """A wing without a tail, lowered at rest and exported so."""
    data = towed_wing(-0.05)
    scene = cm.load_system(data | {"vessels": {"ship": {"points": {"stern": [0, 0, 0]}}}})
    starts = {"ship": {"velocity": [2.0, 0.0, 0.0]}}
    with unpacked(scene, tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, **named(starts))
        with pytest.warns(UnstableStartWarning):
            model = SystemModel(begun(scene, starts))
        assert max(promised(slave, model)) < 1.0
        ((status, said),) = slave.messages
        assert (status, SWINGS_UP in said) == (1, True)
        slave.close()


@pytest.mark.filterwarnings("ignore::cablemodel.errors.UnstableStartWarning")
def test_what_the_scene_swings_up_from_is_warned_of(tmp_path: Path) -> None:
    """An exported start that the library warned of: others are begun with, and warned of."""
    scene = cm.load_system(towed_wing(-0.05))
    with unpacked(scene, tmp_path, stations=STATIONS) as found:
        slave = Slave(*found, **{"tow.cable[1].length": 66.0})
        ((status, said),) = slave.messages
        assert status == 1
        assert "this start may fall or swing up by itself, as the scene's own" in said
        slave.step(0.5)
        slave.close()
        plain = Slave(*found)
        assert plain.messages == []
        plain.close()
