"""FMUs of scenes with direct integration: as those of the finite elements, by the same rules."""

import struct
from pathlib import Path

import numpy as np
import pytest
import test_fmu_refusals as files
from fmpy import extract, read_model_description
from fmpy.fmi1 import FMICallException
from fmu_tools import (
    Slave,
    assert_same_bits,
    image_start,
    sealed,
    step_alike,
    still_scene,
    unpacked,
)  # fmt: skip
from test_fmu_platforms import DT, STEPS, WINE, drive

import cablemodel as cm
from cablemodel.solvers.direct.block import SIZES, DirectBlock
from cablemodel.solvers.direct.kernels import layout as own
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header
from cablemodel_fmu.export import export_fmu

SCENES = Path(__file__).parents[2] / "scenes"
STATIONS = 7
SOLVER = {"method": "direct_integration", "time_step": 0.25, "node_spacing": 1.0}


def bending_scene() -> cm.Scene:
    data = still_scene(solver=SOLVER).to_dict()
    for item in (*data["line"], *data["payout"]["drum"]):
        if item.get("cable"):
            item["cable"]["model"] = "elastica"
    return cm.load_scene(data)


@pytest.fixture(scope="module")
def still(tmp_path_factory):
    scene = bending_scene()
    with unpacked(scene, tmp_path_factory.mktemp("fmu"), stations=STATIONS) as found:
        yield scene, *found


@pytest.mark.parametrize("name", ["example_1_deployment", "example_2_tow", "example_3_touchdown"])
def test_the_papers_examples_have_the_bits_of_python(name, tmp_path):
    """Bodies off the drum, axes that turn; a floor and the mesh that follows the touchdown."""
    scene = cm.load_scene(SCENES / f"{name}.yaml")
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        slave, model = Slave(place, description), cm.CableModel(scene)
        assert_same_bits(slave, model, STATIONS)
        while model.time < 120.0:
            slave.step(2.5)
            model.step(2.5)
            assert_same_bits(slave, model, STATIONS)
        if scene.environment.floor is not None:
            assert slave.get("floor.force")[2] == model.floor_force[2] > 0.0
        slave.close()


def test_inputs_of_a_master_and_variable_steps(still):
    """An elastica, for pulls like these make it slack; the plane is left."""
    scene, place, description = still
    slave, model = Slave(place, description), cm.CableModel(scene)
    rng = np.random.default_rng(2)
    for dt in (0.001, 0.3, 3.0, 0.01, 0.5, 1.0):
        step_alike(slave, model, rng, dt)
        assert_same_bits(slave, model, STATIONS)
    assert not model.planar
    slave.close()


def test_a_restored_state_goes_on_identically(still):
    _, place, description = still
    slave = Slave(place, description)

    def go_on():
        seen = []
        for n in range(20):
            slave.set("vessel.velocity", (0.4 * np.sin(0.3 * n), 0.1, 0))
            slave.step(0.3)
            seen.append((slave.get("tension.top"), *slave.get("body[1].position")))
        return seen

    go_on()
    state, time = slave.fmu.getFMUstate(), slave.time
    expected = go_on()
    slave.fmu.setFMUstate(state)
    slave.time = time
    assert go_on() == expected
    slave.fmu.freeFMUstate(state)
    slave.close()


def test_a_coefficient_that_is_set_before_the_start_settles(still, tmp_path):
    """The steady state is that of a scene with the coefficient; a hanging line has its weight."""
    _, place, description = still
    slave = Slave(place, description, **{"cable_types.K.submerged_weight": 4.0})
    data = bending_scene().to_dict()
    data["cable_types"]["K"]["submerged_weight"] = 4.0
    model = cm.CableModel(cm.load_scene(data))
    assert slave.get("tension.top") == pytest.approx(model.top_tension, rel=1e-7)
    assert slave.get("end.position") == pytest.approx(model.tip_position, abs=1e-5)
    slave.close()


def test_a_step_that_cannot_be_made_says_what_python_says(tmp_path):
    drop = [{"t": 0, "velocity": [0, 0, 0]}, {"t": 0.5, "velocity": [0, 0, -3]}]
    scene = still_scene(
        line=[{"cable": {"type": "K", "length": 30, "model": "cable"}}],
        vessel={"velocity": drop},
        solver={**SOLVER, "time_step": 0.1},
    )
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        slave, model = Slave(place, description), cm.CableModel(scene)
        before = model.top_tension
        with pytest.raises(cm.StepError) as error:
            model.step(3.0)
        with pytest.raises(FMICallException):
            slave.step(3.0)
        assert str(error.value) in slave.messages[-1][1]
        assert slave.get("tension.top") == before
        slave.close()


# -- model.bin: whole by its checksum, but with a block that kernels must not get ------------------


@pytest.fixture(scope="module")
def model_file(still):
    """The FMU as the tests of refusals take it, its model file, and where its block begins."""
    data = files._model(still[1:])
    return still[1:], data, image_start(data)


def accepted(model_file, word: int, value: int | float) -> bool:
    """Whether an instance is made when a word of the block has another value."""
    fmu, data, start = model_file
    changed = bytearray(data)
    struct.pack_into("<q" if isinstance(value, int) else "<d", changed, start + 8 * word, value)
    return files._with_model(fmu, None, sealed(changed))


def word_of(model_file, word: int) -> int:
    _, data, start = model_file
    value: int = struct.unpack_from("<q", data, start + 8 * word)[0]
    return value


def test_every_size_and_offset_is_checked(model_file):
    rule = DirectBlock.arrays(**dict.fromkeys(SIZES, 0))
    offsets = [place for arrays in rule for place, _length in arrays]
    assert len(offsets) > 25
    for word in (*offsets, *SIZES.values(), Header.byte_count.word, Header.image_words.word):
        value = word_of(model_file, word)
        assert accepted(model_file, word, value)
        for change in (1, -1, 1 << 20, -(1 << 62)):
            assert not accepted(model_file, word, value + change), (word, change)


def test_what_kernels_follow_is_checked(model_file):
    """Sections, nodes, cables and bodies that are not there; lengths and steps that are none."""
    section, material = (
        word_of(model_file, word)
        for word in (own.OwnHeader.sections.place, own.OwnHeader.materials.place)
    )
    length, drum = (
        word_of(model_file, word) for word in (own.OwnHeader.length.place, own.OwnHeader.drum.place)
    )
    broken: list[tuple[int, int | float]] = [
        (Header.magic.word, at.MAGIC),
        (own.OwnHeader.section_count.place, 0),
        (own.OwnHeader.drum_used.place, 9),
        (own.OwnHeader.meeting.place, 3),
        (own.OwnHeader.end.place, 4),
        (Header.failed.word, 0),
        (section + own.Section.first.word, 1),
        (section + own.Section.count.word, 10**6),
        (section + own.Section.kind.word, own.RIGID),
        (section + own.Section.material.word, 1),
        (section + own.SECTION_WORDS + own.Section.point.word, 1),
        (drum + own.DrumRow.material.word, -1),
        (material + own.Material.offset.word, 1e9),
        (length + 1, -1.0),
        (own.OwnScalars.time_step.place, 0.0),
        (own.OwnScalars.alpha.place, float("nan")),
    ]
    for word, value in broken:
        assert not accepted(model_file, word, value), (word, value)


def test_sealed_nonsense_does_no_harm(model_file):
    """Random words anywhere, with a right checksum: refused, or harmless."""
    fmu, data, start = model_file
    rng = np.random.default_rng(5)
    values = [0, 1, -1, 3, 1 << 31, 1 << 62, -(1 << 63)]
    values += [struct.unpack("<q", struct.pack("<d", v))[0] for v in (np.nan, 1e300, 0.5, -7.0)]
    taken = 0
    for _ in range(200):
        changed = bytearray(data)
        for _ in range(int(rng.integers(1, 4))):
            word = int(rng.integers(start // 8, len(data) // 8))
            struct.pack_into("<q", changed, 8 * word, values[int(rng.integers(0, len(values)))])
        taken += files._with_model(fmu, None, sealed(changed))
    assert 0 < taken < 200


@pytest.mark.slow
@pytest.mark.skipif(WINE is None, reason="Wine is not installed")
def test_windows(tmp_path):
    """Pay-out and touchdown under Wine, to round-off."""
    scene = cm.load_scene(SCENES / "example_3_touchdown.yaml")
    # The program sets inputs, whatever drives.
    path = export_fmu(scene, tmp_path / "cable.fmu", platforms=("win64",), inputs="scene")
    fmu = {"guid": read_model_description(str(path)).guid}
    place = Path(extract(str(path), unzipdir=str(tmp_path / "unpacked")))
    rows = drive(fmu, place, "win64/cablemodel.dll", [WINE], "x86_64-windows-gnu", tmp_path)
    model = cm.CableModel(scene)
    expected = []
    for n in range(STEPS):
        model.step_to(n * DT + DT)
        expected.append([model.time, model.top_tension, *model.tip_position[[0, 2]]])
    np.testing.assert_allclose(rows, expected, rtol=1e-7, atol=1e-7)
