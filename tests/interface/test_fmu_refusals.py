"""What an FMU refuses: wrong calls, values and files; cleanly, and with the state as before."""

import struct
import time

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmpy.fmi2 import fmi2Discard, fmi2Error
from fmu_tools import CABLE, Slave, image_start, sealed, still_scene, unpacked

import cablemodel as cm
from cablemodel.solvers.finite_element.block import SIZES, Block
from cablemodel.solvers.shared.layout import Header, Summary
from cablemodel_fmu.export import ExportError, export_fmu

NAN = float("nan")


@pytest.fixture(scope="module")
def still(tmp_path_factory):
    with unpacked(still_scene(), tmp_path_factory.mktemp("fmu"), stations=3) as found:
        yield found


@pytest.fixture
def slave(still):
    slave = Slave(*still)
    slave.set("vessel.velocity", (0.3, 0, 0))
    slave.step(1.0)
    yield slave
    slave.close()


def assert_refused(slave, words, call, *args, status=fmi2Error, **kwargs):
    """The call fails with this status and one message with these words; nothing has changed."""
    before = slave.fmu.serializeFMUstate(slave.fmu.getFMUstate())
    slave.messages.clear()
    with pytest.raises(FMICallException) as caught:
        call(*args, **kwargs)
    assert caught.value.status == status
    assert [s for s, _ in slave.messages] == [status]
    assert words in slave.messages[0][1]
    assert slave.fmu.serializeFMUstate(slave.fmu.getFMUstate()) == before


@pytest.mark.parametrize("value", [NAN, float("inf"), 1e200])
def test_values_that_are_not_finite(slave, value):
    for name in ("vessel.velocity", "vessel.position", "current.velocity"):
        assert_refused(slave, "not finite", slave.set, name, (0.1, value, 0.0))
    assert_refused(slave, "not finite", slave.set, "payout.rate", value)
    assert_refused(slave, "out of range", slave.set, "cable_types.K.drag_normal", value)
    reference = slave.references["payout.rate"].valueReference
    assert_refused(
        slave, "not finite", slave.fmu.setRealInputDerivatives, [reference], [1], [value]
    )  # fmt: skip
    slave.step(0.5)


def test_messages_name_the_variable(slave):
    words = "fmi2SetReal: vessel.velocity[2] (value reference 1), value 1e+200: the value is not"
    assert_refused(slave, words, slave.set, "vessel.velocity", (0.1, 1e200, 0.0))
    words = "fmi2SetReal: cable_types.K.drag_normal (value reference 1"
    assert_refused(slave, words, slave.set, "cable_types.K.drag_normal", -0.1)
    words = "fmi2SetReal: value reference 1006, value 5: an output cannot be set"
    assert_refused(slave, words, slave.set, "tension.top", 5.0)


def test_a_long_name_is_said_as_far_as_it_fits(tmp_path):
    kind = "ö" * 60
    line = [{"cable": {"type": kind, "length": 20}}]
    scene = still_scene(cable_types={kind: CABLE}, line=line, payout={})
    with unpacked(scene, tmp_path, stations=3) as found:
        slave = Slave(*found)
        name = next(name for name in slave.references if name.endswith("drag_normal"))
        assert_refused(slave, f"{name[:40]}", slave.set, name, -0.1)
        assert "... (value reference 1" in slave.messages[0][1]
        slave.close()


def test_values_out_of_range(slave):
    assert_refused(slave, "out of range", slave.set, "cable_types.K.drag_normal", -0.1)


def test_a_step_that_no_run_needs_is_refused_at_once(slave):
    """Python says so, too; it would not come to an end."""
    begin = time.perf_counter()
    assert_refused(slave, "longer than any that is made", slave.step, 1e15)
    model = cm.CableModel(still_scene())
    with pytest.raises(cm.StepError, match="at most 1e\\+09 s"):
        model.step(1e15)
    assert time.perf_counter() - begin < 1.0
    assert model.time == 0.0
    slave.time = 1.0
    slave.step(0.5)


@pytest.mark.parametrize("dt", [0.0, -0.1, NAN, float("inf"), 1e-17])
def test_steps_that_do_not_go_forward(slave, dt):
    assert_refused(slave, "fmi2DoStep", slave.step, dt)
    slave.time = 1.0
    slave.step(0.5)


def test_a_step_from_another_time(slave):
    slave.time = 1.5
    assert_refused(slave, "the cable is at 1", slave.step, 0.5)


def test_a_step_beyond_the_stop_time(still):
    slave = Slave(*still, begin=False)
    slave.fmu.setupExperiment(stopTime=1.0)
    slave.fmu.enterInitializationMode()
    slave.fmu.exitInitializationMode()
    slave.step(1.0)
    assert_refused(slave, "stop time", slave.step, 0.1)
    slave.close()


@pytest.mark.parametrize(
    "reference", [13, 26, 99, 901, 950, 1000 + Summary.WORDS, 9999, 10039, 20000013, 2**32 - 1]
)
def test_unknown_value_references(slave, reference):
    words = "unknown value reference"
    assert_refused(slave, words, slave.fmu.getReal, [reference])
    assert_refused(slave, words, slave.fmu.setReal, [0, reference], [9.0, 0.0])
    assert_refused(slave, words, slave.fmu.getInteger, [reference])
    assert_refused(slave, words, slave.fmu.getBoolean, [reference])
    assert_refused(slave, words, slave.fmu.getString, [reference])
    assert_refused(slave, words, slave.fmu.setRealInputDerivatives, [reference], [1], [0.0])


def test_outputs_cannot_be_set(slave):
    assert_refused(slave, "an output", slave.set, "tension.top", 5.0)


def test_fixed_parameters_cannot_be_set_after_the_start(slave):
    assert_refused(slave, "not allowed", slave.set, "vessel.input", 2)
    assert_refused(slave, "not allowed", slave.set, "use_scene_inputs", True)


def test_wrong_order_of_calls(still):
    slave = Slave(*still, begin=False)
    assert_refused(slave, "while instantiated", slave.step, 0.1)
    assert_refused(slave, "while instantiated", slave.fmu.exitInitializationMode)
    assert_refused(slave, "while instantiated", slave.fmu.terminate)
    assert_refused(slave, "not 1 to 3", slave.set, "vessel.input", 4)
    slave.fmu.setupExperiment()
    slave.fmu.enterInitializationMode()
    assert_refused(slave, "initialization mode", slave.step, 0.1)
    assert_refused(slave, "initialization mode", slave.fmu.setupExperiment)
    slave.fmu.exitInitializationMode()
    assert_refused(slave, "while initialized", slave.fmu.enterInitializationMode)
    slave.step(0.1)
    slave.fmu.terminate()
    assert_refused(slave, "while terminated", slave.step, 0.1)
    assert_refused(slave, "while terminated", slave.set, "payout.rate", 0.0)
    assert np.isfinite(slave.get("tension.top"))
    slave.close()


def test_reset_starts_again(slave):
    first = slave.fmu.getFMUstate()
    slave.set("vessel.velocity", (0, 0.4, 0))
    slave.step(2.0)
    slave.set("cable_types.K.drag_normal", 3.0)
    slave.begin_again()
    slave.time = 0.0
    assert slave.get("cable_types.K.drag_normal") == 1.0
    assert slave.get("vessel.velocity").tolist() == [0, 0, 0]
    slave.set("vessel.velocity", (0.3, 0, 0))
    slave.step(1.0)
    again = slave.fmu.serializeFMUstate(slave.fmu.getFMUstate())
    assert again == slave.fmu.serializeFMUstate(first)


def test_a_step_that_cannot_be_made_is_discarded(slave):
    """A velocity that no cable stands: the state is as before, and a reasonable step goes on."""
    before = slave.get("end.position").tobytes()
    slave.set("vessel.velocity", (900.0, 0, 0))
    assert_refused(slave, "m along the cable", slave.step, 0.1, status=fmi2Discard)
    assert slave.fmu.getRealStatus(2) == 1.0
    assert not slave.fmu.getBooleanStatus(3)
    assert slave.get("end.position").tobytes() == before
    slave.set("vessel.velocity", (0.3, 0, 0))
    slave.step(0.1)


def test_log_categories(still):
    quiet, loud = Slave(*still), Slave(*still, logging=True)
    assert quiet.messages == []
    assert [m.split(":")[0] for _, m in loud.messages] == ["instantiated", "initialized at t = 0 s"]
    quiet.fmu.setDebugLogging(True, ["logEvents"])
    with pytest.raises(FMICallException):
        quiet.step(-1)
    assert quiet.messages == []  # errors were not asked for
    quiet.fmu.setDebugLogging(True, ["logAll"])
    with pytest.raises(FMICallException):
        quiet.fmu.setDebugLogging(True, ["logNothing"])
    assert "unknown category" in quiet.messages[0][1]
    quiet.close()
    loud.close()


@pytest.mark.parametrize("change", ["guid", "type", "resources", "name"])
def test_instantiation_that_does_not_fit(still, change):
    place, description = still
    good = Slave(place, description, begin=False)
    arguments = {
        "name": b"cable",
        "type": 1,
        "guid": description.guid.encode(),
        "resources": (place / "resources").as_uri().encode(),
    }
    arguments[change] = {
        "guid": b"{00000000-0000-0000-0000-000000000000}",
        "type": 0,
        "resources": (place / "binaries").as_uri().encode(),
        "name": b"",
    }[change]
    import ctypes

    instantiate = good.fmu.dll.fmi2Instantiate
    instantiate.restype = ctypes.c_void_p
    assert instantiate(*arguments.values(), None, 0, 0) is None
    assert instantiate(arguments["name"], arguments["type"], None, None, None, 0, 0) is None
    good.close()


def test_calls_without_an_instance(still):
    import ctypes

    dll = Slave(*still, begin=False).fmu.dll
    for name in ("fmi2Terminate", "fmi2Reset", "fmi2ExitInitializationMode"):
        assert getattr(dll, name)(ctypes.c_void_p(None)) == fmi2Error
    dll.fmi2FreeInstance(ctypes.c_void_p(None))


# -- model.bin -------------------------------------------------------------------------------------


def _with_model(still, tmp_path, data: bytes):
    """Try an instance with this model.bin; a few steps and outputs when it is accepted."""
    place, description = still
    resources = place / "resources"
    kept = (resources / "model.bin").read_bytes()
    try:
        (resources / "model.bin").write_bytes(data)
        try:
            slave = Slave(place, description)
        except Exception as error:  # fmpy raises nothing more special
            if "instantiate" in str(error) or "Initialization" in str(error):
                return False
            raise
        for dt in (0.01, 0.5):
            try:
                slave.step(dt)
                slave.get("line.position")
                slave.get("tension.min")
            except FMICallException:
                pass
        slave.close()
        return True
    finally:
        (resources / "model.bin").write_bytes(kept)


def _model(still) -> bytes:
    return (still[0] / "resources" / "model.bin").read_bytes()


def test_the_models_own_file_is_accepted(still, tmp_path):
    assert _with_model(still, tmp_path, _model(still))
    assert _with_model(still, tmp_path, sealed(bytearray(_model(still))))


def test_truncated_model_files(still, tmp_path):
    data = _model(still)
    for length in (0, 1, 8, 255, 256, 1000, len(data) // 2, len(data) - 8, len(data) - 1):
        assert not _with_model(still, tmp_path, data[:length])
        if length > 40:
            assert not _with_model(still, tmp_path, sealed(bytearray(data[:length])))
    assert not _with_model(still, tmp_path, data + bytes(8))


def test_any_changed_byte_of_a_model_file(still, tmp_path):
    data = _model(still)
    rng = np.random.default_rng(2)
    for position in rng.integers(0, len(data), 150):
        changed = bytearray(data)
        changed[position] ^= 1 << int(rng.integers(0, 8))
        if position in range(28, 32):
            continue  # the upper half of the checksum's word is not used
        assert not _with_model(still, tmp_path, bytes(changed)), position


def test_every_size_and_offset_of_a_model_file_is_checked(still, tmp_path):
    data = _model(still)
    start = image_start(data)
    rule = Block.arrays(**dict.fromkeys(SIZES, 0))
    used = [place for arrays in rule for place, _length in arrays]
    sizes = [
        Header.byte_count.word,
        Header.image_words.word,
        Header.capacity.word,
        Header.piece_count.word,
        Header.depth_count.word,
        Header.time_count.word,
    ]
    sizes += [
        Header.strain_words.word,
        Header.body_count.word,
        Header.constraint_count.word,
        Header.rate_count.word,
        Header.cable_count.word,
    ]
    assert len(used) > 30
    for word in (*used, *sizes):
        for change in (1, -1, 8, 1 << 20, 1 << 40, -(1 << 62)):
            changed = bytearray(data)
            (value,) = struct.unpack_from("<q", data, start + 8 * word)
            struct.pack_into("<q", changed, start + 8 * word, value + change)
            assert not _with_model(still, tmp_path, sealed(changed)), (word, change)
    for word in (2, 11, 12, 14):  # those of the file itself; 13 only says how many stations to give
        for change in (1, -1, 1 << 40):
            changed = bytearray(data)
            (value,) = struct.unpack_from("<q", data, 8 * word)
            struct.pack_into("<q", changed, 8 * word, value + change)
            assert not _with_model(still, tmp_path, sealed(changed)), (word, change)


def test_sealed_nonsense_does_no_harm(still, tmp_path):
    """Random words anywhere, with a right checksum: refused, or harmless."""
    data = _model(still)
    rng = np.random.default_rng(3)
    accepted = 0
    values = [0, 1, -1, 3, 1 << 31, 1 << 62, -(1 << 63)]
    values += [struct.unpack("<q", struct.pack("<d", v))[0] for v in (NAN, 1e300, -1e300, 0.5, 7)]
    for _ in range(400):
        changed = bytearray(data)
        for _ in range(int(rng.integers(1, 4))):
            word = int(rng.integers(4, len(data) // 8))
            struct.pack_into("<q", changed, 8 * word, values[int(rng.integers(0, len(values)))])
        accepted += _with_model(still, tmp_path, sealed(changed))
    assert 0 < accepted < 400


# -- export ----------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"platforms": ["linux32"]}, "linux32"),
        ({"platforms": []}, "none"),
        ({"platforms": ["linux64", "aarch64-linux"]}, "share a folder"),
        ({"stations": 1}, "stations is 1"),
    ],
)
def test_exports_that_are_refused(tmp_path, options, words):
    with pytest.raises(ExportError, match=words):
        export_fmu(still_scene(), tmp_path / "x.fmu", **options)
    assert list(tmp_path.iterdir()) == []
