"""An FMU of a scene with an estimate of its errors: that of Python, and nothing else is changed."""

import contextlib
import copy
import struct
import threading
import zlib
from pathlib import Path

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmu_tools import (
    CABLE,
    Slave,
    assert_same_bits,
    driven_elsewhere,
    image_start,
    sealed,
    step_alike,
    still_scene,
    unpacked,
)

import cablemodel as cm
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header
from cablemodel_fmu.file_records import FileHeader, Parameter

SCENES = Path(__file__).parents[2] / "scenes"
STATIONS = 5
ERRORS = ("error.position", "error.tension")
CONTROLS = 192
"""Bytes of a state before its parameters."""
NAN = struct.unpack("<q", struct.pack("<d", float("nan")))[0]


def estimating(scene=None, **changes) -> cm.Scene:
    data = copy.deepcopy((scene or still_scene()).to_dict())
    data.update(changes)
    data["solver"] = {**data.get("solver", {}), "error_estimate": True}
    return cm.load_scene(data)


@pytest.fixture(scope="module")
def still(tmp_path_factory):
    with unpacked(estimating(), tmp_path_factory.mktemp("fmu"), stations=STATIONS) as found:
        yield found


def test_a_start_that_is_set_is_that_of_both_runs(still):
    """Else the estimate would be how far the start was moved."""
    start = {"position": [9.0, 3.0, -2.0], "velocity": [{"t": 0, "velocity": [0.4, 0, 0]}]}
    slave = Slave(
        *still,
        **{"vessel.start_position": (9.0, 3.0, -2.0), "vessel.start_velocity": (0.4, 0, 0)},
    )
    model = cm.CableModel(estimating(vessel=start))
    for _ in range(3):
        assert slave.get("error.position") == pytest.approx(model.position_error, rel=0.02)
        slave.step(0.5)
        model.step(0.5, (0.4, 0, 0), payout_rate=0.0, current=(0, 0, 0))
    slave.close()


def drive(slave, first: int, last: int, names=("tension.top", "end.position", *ERRORS)) -> bytes:
    """Steps number first to last; outputs after each one."""
    seen = b""
    for n in range(first, last):
        slave.set("vessel.velocity", (0.4 * np.sin(0.1 * n), 0.1 * np.cos(0.3 * n), 0))
        slave.set("payout.rate", 0.3 * np.sin(0.2 * n))
        slave.step(0.05 + 0.01 * (n % 7))
        seen += b"".join(np.asarray(slave.get(name)).tobytes() for name in names)
    return seen


def errors(slave) -> tuple[float, float]:
    return tuple(slave.get(name) for name in ERRORS)


def serialised(slave) -> bytes:
    return slave.fmu.serializeFMUstate(slave.fmu.getFMUstate())


def promise(model) -> np.ndarray:
    """What the tolerance allows positions and tensions to be wrong by."""
    tau = model.scene.solver.tolerance
    return tau * np.array([model.line_length, 10 * model.tension_max])


# -- the same as in Python -------------------------------------------------------------------------


def test_every_output_over_a_run_with_inputs(still):
    """Out of the plane, with the winch and a body, steps from 1 ms to 3 s."""
    slave, model = Slave(*still), cm.CableModel(estimating())
    assert_same_bits(slave, model, STATIONS)
    rng = np.random.default_rng(1)
    seen = []
    for dt in (0.001, 0.02, 0.3, 3.0, 0.01, 0.5, 1.0, 0.07):
        step_alike(slave, model, rng, dt)
        assert_same_bits(slave, model, STATIONS)
        seen.append(errors(slave))
    assert np.isfinite(seen).all()
    assert (np.max(seen, axis=0) > 1e-2 * promise(model)).all()
    slave.close()


@pytest.mark.filterwarnings("ignore::cablemodel.TautLayWarning")  # of the scene recovery
@pytest.mark.parametrize(
    ("name", "steps", "dt"),
    [("recovery", 20, 0.5), ("deployment", 30, 0.5), ("whip", 20, 0.05), ("touchdown", 30, 1.0)],
)
def test_the_scenes_own_schedule(name, steps, dt, tmp_path):
    """With floor, bodies and winch; static starts and given ones."""
    scene = estimating(cm.load_scene(SCENES / f"{name}.yaml"))
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        slave, model = Slave(place, description, use_scene_inputs=True), cm.CableModel(scene)
        for _ in range(steps):
            slave.step(dt)
            model.step(dt)
            assert_same_bits(slave, model, STATIONS)
        assert errors(slave)[0] > 0.0
        slave.close()


def test_the_results_are_those_without_an_estimate(still, tmp_path):
    """All outputs, and all that the cable keeps; and that file has no more in it than before."""
    with unpacked(still_scene(), tmp_path, stations=STATIONS) as plain:
        with_errors, without = Slave(*still), Slave(*plain)
        names = [v.name for v in plain[1].modelVariables if v.causality == "output"]
        assert {v.name for v in still[1].modelVariables} - set(without.references) == set(ERRORS)
        assert drive(with_errors, 0, 40, names) == drive(without, 0, 40, names)
        states = serialised(with_errors), serialised(without)
        assert states[0][CONTROLS : len(states[1])] == states[1][CONTROLS:]
        finer = (still[0] / "resources" / "finer.bin").read_bytes()
        assert len(states[0]) - len(states[1]) == 8 * struct.unpack_from("<q", finer, 8 * 11)[0]
        assert not (plain[0] / "resources" / "finer.bin").exists()
        model = (still[0] / "resources" / "model.bin").read_bytes()
        assert len(model) == (plain[0] / "resources" / "model.bin").stat().st_size
        with_errors.close()
        without.close()


# -- states and instances --------------------------------------------------------------------------


def test_a_state_goes_on_identically_here_and_in_another_process(still, tmp_path):
    slave = Slave(*still)
    drive(slave, 0, 25)
    state, time = slave.fmu.getFMUstate(), slave.time
    here = errors(slave)
    elsewhere = driven_elsewhere(slave, still[0], tmp_path, "test_fmu_error_estimate", 25, 45)
    expected = drive(slave, 25, 45)
    slave.fmu.setFMUstate(state)
    slave.time = time
    assert errors(slave) == here
    assert drive(slave, 25, 45) == expected
    assert elsewhere == expected
    slave.close()


def test_a_reset_starts_again(still):
    slave, fresh = Slave(*still), Slave(*still)
    at_start = errors(slave)
    drive(slave, 0, 10)
    slave.set("cable_types.K.drag_normal", 3.0)
    slave.step(0.5)
    assert errors(slave) != at_start
    slave.begin_again()
    slave.time = 0.0
    assert errors(slave) == at_start
    assert drive(slave, 0, 10) == drive(fresh, 0, 10)
    assert serialised(slave) == serialised(fresh)
    slave.close()
    fresh.close()


def test_many_instances_in_threads(still):
    alone = Slave(*still)
    expected = drive(alone, 0, 20)
    slaves = [Slave(*still) for _ in range(6)]
    seen = {}
    threads = [
        threading.Thread(target=lambda s=s, k=k: seen.update({k: drive(s, 0, 20)}))
        for k, s in enumerate(slaves)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert seen == dict.fromkeys(range(6), expected)
    for slave in (*slaves, alone):
        slave.close()


def test_a_damaged_finer_run_in_a_state_is_refused(still):
    slave = Slave(*still)
    drive(slave, 0, 5)
    good = serialised(slave)
    finer = len(good) - 8 * struct.unpack_from(
        "<q", (still[0] / "resources" / "finer.bin").read_bytes(), 8 * 11
    )[0]  # fmt: skip
    for word in (
        Header.magic.word,
        Header.version.word,
        Header.nodes.word,
        Header.capacity.word,
        Header.position.word,
        Header.edges.word,
    ):
        bad = bytearray(good)
        (value,) = struct.unpack_from("<q", bad, finer + 8 * word)
        struct.pack_into("<q", bad, finer + 8 * word, value + (1 << 20))
        struct.pack_into("<q", bad, 16, zlib.crc32(bad[24:]))
        with pytest.raises(FMICallException):
            slave.fmu.deSerializeFMUstate(bytes(bad))
    rng = np.random.default_rng(4)
    for position in rng.integers(finer, len(good), 50):
        bad = bytearray(good)
        bad[position] ^= 0x10
        with pytest.raises(FMICallException):
            slave.fmu.deSerializeFMUstate(bytes(bad))
    assert serialised(slave) == good
    slave.close()


# -- parameters ------------------------------------------------------------------------------------


def assert_as_the_scene(slave, model, within: float) -> None:
    """Estimates differ by less than this part of what the tolerance allows."""
    apart = np.subtract(errors(slave), (model.position_error, model.tension_error))
    assert (np.abs(apart) < within * promise(model)).all()


def test_coefficients_tuned_in_the_run_reach_the_finer_run(tmp_path):
    """Tuned before the first step of a start that does not depend on them: as in their scene."""
    scene = estimating(
        title="Let go",
        line=[{"cable": {"type": "K", "length": 30}}],
        initial={"straight": [0.6, 0.0, -0.8]},
        payout={},
    )
    tuned = {"drag_normal": 1.3, "drag_tangential": 0.2, "added_mass": 1.2}
    changed = cm.load_scene({**scene.to_dict(), "cable_types": {"K": {**CABLE, **tuned}}})
    with unpacked(scene, tmp_path, stations=STATIONS) as (place, description):
        slave, model, exported = Slave(place, description), *map(cm.CableModel, (changed, scene))
        for name, value in tuned.items():
            slave.set(f"cable_types.K.{name}", value)
        for _ in range(20):
            slave.step(0.25)
            for cable in (model, exported):
                cable.step(0.25, (0, 0, 0), payout_rate=0.0, current=(0, 0, 0))
            assert_as_the_scene(slave, model, 1e-3)
        # A finer run that had not been told would be as far away as the scene before.
        apart = np.linalg.norm(model.tip_position - exported.tip_position)
        assert apart > 10 * model.position_error
        slave.close()


def test_coefficients_and_lengths_set_before_the_start_reach_the_finer_run(still):
    """Both runs start from their equilibrium: what they differ by is that of the scene with these
    values. A line scaled as a whole keeps its mesh."""
    values = {"line.cable[1].length": 24.0, "line.cable[2].length": 12.0}
    values["cable_types.K.drag_normal"] = 1.5
    data = estimating().to_dict()
    data["line"][0]["cable"]["length"], data["line"][2]["cable"]["length"] = 24.0, 12.0
    data["cable_types"]["K"]["drag_normal"] = 1.5
    slave, model = Slave(*still, **values), cm.CableModel(cm.load_scene(data))
    assert_as_the_scene(slave, model, 1e-6)
    for n in range(20):
        velocity = (0.4 * np.sin(0.3 * n), 0.0, 0.0)
        slave.set("vessel.velocity", velocity)
        slave.step(0.5)
        model.step(0.5, velocity, payout_rate=0.0, current=(0, 0, 0))
        # The finer run follows what the changes of the acceleration make ring: its steps grow what
        # the starts differ by.
        assert_as_the_scene(slave, model, 1e-3)
    assert model.position_error > 1e-2 * promise(model)[0]
    slave.close()


# -- a finer run that is left behind, or is not what it should be ----------------------------------


@contextlib.contextmanager
def with_finer(still, data: bytes | None):
    """Other contents of finer.bin; None: there is no such file."""
    path = still[0] / "resources" / "finer.bin"
    kept = path.read_bytes()
    try:
        if data is None:
            path.unlink()
        else:
            path.write_bytes(data)
        yield
    finally:
        path.write_bytes(kept)


def test_a_finer_run_that_cannot_make_a_step_stays_behind(still):
    """The results go on; there is no estimate any more, in states of then either."""
    finer = bytearray((still[0] / "resources" / "finer.bin").read_bytes())
    # Three internal steps are enough for 1 ms and for what is at rest, but not to get under way.
    struct.pack_into("<q", finer, image_start(finer) + 8 * Header.maximum_steps.word, 3)
    whole = Slave(*still)
    with with_finer(still, sealed(finer)):
        slave = Slave(*still)
    for cable in (slave, whole):
        cable.step(1e-3)
    assert errors(slave) == errors(whole)
    before = slave.fmu.getFMUstate()
    for speed in (0.5, 0.0, 0.0):  # it could catch up when the vessel stops
        for cable in (slave, whole):
            cable.set("vessel.velocity", (speed, 0.0, 0.0))
            cable.step(1.0)
        assert slave.get("end.position").tobytes() == whole.get("end.position").tobytes()
        assert np.isnan(errors(slave)).all()
        assert np.isfinite(errors(whole)).all()
    assert slave.messages == []
    behind = slave.fmu.getFMUstate()
    slave.fmu.setFMUstate(before)
    assert np.isfinite(errors(slave)).all()
    slave.fmu.setFMUstate(slave.fmu.deSerializeFMUstate(slave.fmu.serializeFMUstate(behind)))
    assert np.isnan(errors(slave)).all()
    slave.fmu.reset()
    assert np.isfinite(errors(slave)).all()
    slave.close()
    whole.close()


def test_a_finer_run_without_an_equilibrium_is_left_behind(still):
    finer = bytearray((still[0] / "resources" / "finer.bin").read_bytes())
    start = image_start(finer)
    (edges,) = struct.unpack_from("<q", finer, start + 8 * Header.edges.word)
    word = edges + 2 * at.EDGE_WORDS + at.Edge.weight.word
    struct.pack_into("<q", finer, start + 8 * word, NAN)
    values = {"cable_types.K.drag_normal": 1.5}
    whole = Slave(*still, **values)
    with with_finer(still, sealed(finer)):
        slave = Slave(*still, **values)
    assert slave.messages == []
    for _ in range(2):
        assert np.isnan(errors(slave)).all()
        assert np.isfinite(errors(whole)).all()
        assert slave.get("end.position").tobytes() == whole.get("end.position").tobytes()
        for cable in (slave, whole):
            cable.step(0.5)
    slave.close()
    whole.close()


def _damaged(still, how: str) -> bytes | None:
    model, finer = (
        bytearray((still[0] / "resources" / name).read_bytes())
        for name in ("model.bin", "finer.bin")
    )
    if how == "missing":
        return None
    if how == "truncated":
        return bytes(finer[:-8])
    if how == "that of the model":  # it would have a finer run of its own
        return bytes(model)
    if how == "a byte":
        finer[len(finer) // 2] ^= 1
        return bytes(finer)
    if how == "another FMU":
        finer[8 * FileHeader.guid.word + 3] ^= 1
    elif how == "parameters":  # the largest value of the first: the kernels' bounds are the model's
        struct.pack_into("<d", finer, 8 * (FileHeader.WORDS + Parameter.maximum.word), 1e29)
    elif how == "an offset":
        finer[image_start(finer) + 8 * Header.edges.word] ^= 1
    return sealed(finer)


@pytest.mark.parametrize(
    ("how", "words"),
    [
        ("missing", "cannot be opened"),
        ("truncated", "truncated"),
        ("that of the model", "not of the scene"),
        ("a byte", "checksum"),
        ("another FMU", "GUID"),
        ("parameters", "not of the scene"),
        ("an offset", "offset"),
    ],
)
def test_a_file_of_the_finer_run_that_does_not_fit(still, how, words, monkeypatch):
    """The instance is refused, with a message that names the file."""
    messages = []
    monkeypatch.setattr(Slave, "_log", lambda self, *values: messages.append(values[-1].decode()))
    with with_finer(still, _damaged(still, how)), pytest.raises(Exception, match="instantiate"):
        Slave(*still)
    assert len(messages) == 1
    assert "resources/finer.bin" in messages[0]
    assert words in messages[0]


def test_sealed_nonsense_in_the_finer_run_does_no_harm(still):
    """Random words anywhere, with a right checksum: refused, or harmless to the results."""
    data = (still[0] / "resources" / "finer.bin").read_bytes()
    whole = Slave(*still)
    expected = drive(whole, 0, 2, ("end.position",))
    rng = np.random.default_rng(3)
    accepted = 0
    values = [0, 1, -1, 3, 1 << 31, 1 << 62, -(1 << 63), NAN]
    values += [struct.unpack("<q", struct.pack("<d", v))[0] for v in (1e300, -1e300, 0.5, 7)]
    for _ in range(200):
        changed = bytearray(data)
        for _ in range(int(rng.integers(1, 4))):
            word = int(rng.integers(4, len(data) // 8))
            struct.pack_into("<q", changed, 8 * word, values[int(rng.integers(0, len(values)))])
        with with_finer(still, sealed(changed)):
            try:
                slave = Slave(*still)
            except Exception as error:  # fmpy raises nothing more special
                if "instantiate" in str(error):
                    continue
                raise
        accepted += 1
        assert drive(slave, 0, 2, ("end.position",)) == expected
        errors(slave)
        slave.close()
    assert 0 < accepted < 200
    whole.close()
