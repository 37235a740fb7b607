"""An FMU's memory grows with its mesh, as Python's does: how much there was is seen in nothing."""

from __future__ import annotations

import contextlib
import ctypes
import subprocess
import sys
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import test_fmu_systems as systems
from fmpy import simulate_fmu
from fmpy.fmi1 import FMICallException
from fmu_tools import CABLE, Slave, assert_same_bits, driven_elsewhere, unpacked

import cablemodel as cm
from cablemodel.results.replay import replay
from cablemodel.solvers.direct.kernels import layout as direct
from cablemodel.solvers.finite_element.block import SIZES, Block
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header
from cablemodel.systems import SystemModel
from cablemodel_fmu.export import export_fmu
from cablemodel_fmu.model_file import ModelFile
from cablemodel_fmu.recording import FmuLog

STATIONS = 5
STEP = 0.5


def cable(length: float) -> dict[str, Any]:
    return {"cable": {"type": "K", "length": length}}


SLACK: dict[str, Any] = {
    "title": "slack that comes down on a floor",
    "cable_types": {"K": CABLE},
    "line": [cable(24.0)],
    "environment": {"floor": {"z": -25.0, "friction": 0.5}},
    "payout": {
        "rate": [{"t": 0.0, "rate": 0.0}, {"t": 1.0, "rate": 0.5}],
        "drum": [cable(100.0)],
    },
    "run": {"duration": 60, "output_interval": STEP},
}
SYSTEM: dict[str, Any] = {
    "title": "slack below a ship, and a load beside it",
    "cable_types": {"K": CABLE},
    "environment": {"floor": {"z": -25.0, "friction": 0.5}},
    "vessels": {"ship": {"points": {"stern": [0, 0, 0], "side": [0, 8, 0]}}},
    "bodies": {
        "load": {"mass": 50.0, "submerged_weight": 300.0, "inertia": 5.0, "drag_area": 0.2,
                 "points": {"eye": [0, 0, 0.3]}}
    },
    "lines": {
        "lay": {"from": "ship.stern", "to": "free", "items": [cable(24.0)]},
        "hoist": {"from": "ship.side", "to": "load.eye", "items": [cable(10.0)]},
    },
    "winches": {
        "winch": {"line": "lay", "at": "start", "drum": 100.0,
                  "rate": [{"t": 0.0, "rate": 0.0}, {"t": 1.0, "rate": 0.5}]}
    },
    "run": {"duration": 60, "output_interval": STEP},
}  # fmt: skip


@contextlib.contextmanager
def bare() -> Iterator[None]:
    """Exports have no room at all beyond the nodes at the start."""
    to_bytes = ModelFile.to_bytes

    def shrunk(self: ModelFile) -> bytes:
        block: Any = self.block
        block.make_room(int(block.header.nodes))
        return to_bytes(self)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(ModelFile, "to_bytes", shrunk)
        yield


@contextlib.contextmanager
def exported(scene: Any, folder: Path) -> Iterator[tuple[Path, object]]:
    with contextlib.ExitStack() as stack:
        with bare():
            found = stack.enter_context(unpacked(scene, folder, stations=STATIONS))
        yield found


@pytest.fixture(scope="module")
def line(tmp_path_factory: pytest.TempPathFactory) -> Any:
    """With an estimate of its errors, by a finer run."""
    scene = cm.load_scene({**SLACK, "solver": {"error_estimate": True}})
    with exported(scene, tmp_path_factory.mktemp("line")) as (place, about):
        yield scene, place, about


@pytest.fixture(scope="module")
def system(tmp_path_factory: pytest.TempPathFactory) -> Any:
    scene = cm.load_system(SYSTEM)
    with exported(scene, tmp_path_factory.mktemp("system")) as (place, about):
        yield scene, place, about


def outputs_of(slave: Slave) -> bytes:
    names = [v.name for v in slave.description.modelVariables if v.causality == "output"]
    values = slave.fmu.getReal([slave.references[name].valueReference for name in names])
    return np.asarray(values).tobytes()


def drive(slave: Slave, first: int, last: int) -> bytes:
    """Steps number first to last, as the scene drives; every output after each one."""
    seen = b""
    for _ in range(first, last):
        slave.step(STEP)
        seen += outputs_of(slave)
    return seen


def state_of(slave: Slave) -> bytes:
    state = slave.fmu.getFMUstate()
    try:
        return bytes(slave.fmu.serializeFMUstate(state))
    finally:
        slave.fmu.freeFMUstate(state)


def images_in(state: bytes) -> list[int]:
    """Where the images of a state begin [words]."""
    words = np.frombuffer(state, dtype=np.int64)
    starts = np.flatnonzero(words == at.MAGIC) - Header.magic.word
    assert sum(words[starts + Header.image_words.word]) == len(words) - starts[0]
    return [int(start) for start in starts]


def rooms(state: bytes) -> list[int]:
    """For how many nodes there is room, in the run and in the finer one."""
    words = np.frombuffer(state, dtype=np.int64)
    return [int(words[start + Header.capacity.word]) for start in images_in(state)]


def resealed(words: np.ndarray) -> bytes:
    """A state with the words and the checksum that belong to its contents."""
    words[1] = len(words)
    words[2] = zlib.crc32(words[3:].tobytes())
    return words.tobytes()


def restore(slave: Slave, state: bytes, time: float) -> None:
    kept = slave.fmu.deSerializeFMUstate(state)
    slave.fmu.setFMUstate(kept)
    slave.fmu.freeFMUstate(kept)
    slave.time = time


def test_a_line_grows_and_so_does_its_finer_run(line: Any) -> None:
    scene, *fmu = line
    slave, model = Slave(*fmu, use_scene_inputs=True), cm.CableModel(scene)
    before = rooms(state_of(slave))
    for _ in range(80):
        slave.step(STEP)
        model.step(STEP)
        assert_same_bits(slave, model, STATIONS)
    after = rooms(state_of(slave))
    assert len(after) == 2
    assert all(late > 4 * early for late, early in zip(after, before, strict=True)), after
    slave.close()


def test_a_system_grows(system: Any) -> None:
    scene, *fmu = system
    slave, model = Slave(*fmu, use_scene_inputs=True), SystemModel(scene)
    before = rooms(state_of(slave))
    for _ in range(80):
        slave.step(STEP)
        model.step(STEP)
        systems.assert_same_bits(slave, model)
    assert rooms(state_of(slave))[0] > 4 * before[0]
    slave.close()


def test_a_start_at_another_length_grows(system: Any, tmp_path: Path) -> None:
    """It is sought in the block along the first shape, with room of its own."""
    scene, *fmu = system
    with unpacked(scene, tmp_path, stations=STATIONS) as roomy:
        slaves = [Slave(*one, **{"lay.cable[1].length": 36.0}) for one in (fmu, roomy)]
        for _ in range(3):
            assert outputs_of(slaves[0]) == outputs_of(slaves[1])
            for slave in slaves:
                slave.step(STEP)
        for slave in slaves:
            slave.close()


def test_a_look_ahead_grows(system: Any) -> None:
    """A system's output derivatives are made with a copy of the block, which has no more room."""
    scene, *fmu = system
    roomy, tight = (Slave(*fmu, use_scene_inputs=True) for _ in range(2))
    block = SystemModel(scene).built.block
    names = ["ship.force[3]", "ship.moment[1]"]
    references = [roomy.references[name].valueReference for name in names]
    grown = 0
    for _ in range(40):
        roomy.step(STEP)
        words = np.frombuffer(state_of(roomy), dtype=np.int64)
        start = images_in(words.tobytes())[0]
        block.take(words[start:])
        block.make_room(int(block.header.nodes))
        restore(tight, resealed(np.concatenate([words[:start], block.image])), roomy.time)
        least = rooms(state_of(tight))
        rates = [
            list(slave.fmu.getRealOutputDerivatives(references, [1] * len(names)))
            for slave in (roomy, tight)
        ]
        assert rates[0] == rates[1]
        assert any(rates[0])
        grown += rooms(state_of(tight)) > least
    assert grown > 0
    for slave in (roomy, tight):
        slave.close()


@pytest.mark.parametrize("kind", ["line", "system"])
def test_states_of_before_and_after_go_both_ways(
    kind: str, request: pytest.FixtureRequest, tmp_path: Path
) -> None:
    _, *fmu = request.getfixturevalue(kind)
    slave = Slave(*fmu, use_scene_inputs=True)
    first = state_of(slave)
    slave.step(STEP)
    held, early = slave.fmu.getFMUstate(), state_of(slave)
    passed = drive(slave, 1, 60)
    late = state_of(slave)
    assert len(late) > 2 * len(early)
    assert min(rooms(late)) > max(rooms(early))
    further = drive(slave, 60, 70)

    slave.fmu.setFMUstate(held)  # from before it grew, in memory
    assert state_of(slave) == early
    slave.time = STEP
    assert drive(slave, 1, 60) == passed
    restore(slave, early, STEP)  # the same from bytes
    assert state_of(slave) == early
    restore(slave, late, 60 * STEP)  # a larger one than the instance has room for
    assert state_of(slave) == late
    elsewhere = driven_elsewhere(slave, fmu[0], tmp_path, "test_fmu_memory", 60, 70)
    assert elsewhere == further
    assert drive(slave, 60, 70) == further
    fresh = Slave(*fmu, use_scene_inputs=True)
    restore(fresh, late, 60 * STEP)
    assert drive(fresh, 60, 70) == further
    restore(fresh, early, STEP)
    assert drive(fresh, 1, 60) == passed
    fresh.close()

    slave.fmu.fmi2GetFMUstate(slave.fmu.component, ctypes.byref(held))  # a larger one over it
    restore(slave, early, STEP)
    slave.fmu.setFMUstate(held)
    slave.time = 70 * STEP
    assert drive(slave, 70, 71)
    slave.fmu.freeFMUstate(held)

    slave.fmu.reset()
    slave.fmu.setupExperiment(startTime=0.0)
    slave.set("use_scene_inputs", True)
    slave.fmu.enterInitializationMode()
    slave.fmu.exitInitializationMode()
    assert state_of(slave) == first
    slave.close()


def test_a_log_of_a_run_that_grows_replays(tmp_path: Path) -> None:
    for scene in (cm.load_scene(SLACK), cm.load_system(SYSTEM)):
        path = tmp_path / f"{type(scene).__name__}.fmu"
        with bare():
            export_fmu(scene, path, platforms=["linux64"])
        log = path.with_suffix(".mcap")
        with FmuLog(path, log) as following:
            simulate_fmu(
                str(path),
                stop_time=20.0,
                output_interval=STEP,
                step_finished=following,
                start_values={"use_scene_inputs": True},
            )
        found = replay(cm.open_run(log))
        assert found.expected_exact
        assert found.exact, found.differences


# -- what is refused -------------------------------------------------------------------------------


def is_taken(slave: Slave, state: bytes) -> bool:
    try:
        restore(slave, state, slave.time)
    except FMICallException:
        return False
    return True


@pytest.mark.parametrize("kind", ["line", "system"])
def test_a_state_of_wrong_sizes_is_refused(kind: str, request: pytest.FixtureRequest) -> None:
    _, *fmu = request.getfixturevalue(kind)
    slave = Slave(*fmu, use_scene_inputs=True)
    drive(slave, 0, 10)
    good = state_of(slave)
    words = np.frombuffer(good, dtype=np.int64)
    assert resealed(words.copy()) == good
    sizes = {*SIZES.values(), Header.image_words.word, Header.byte_count.word}
    rule = Block.arrays(**dict.fromkeys(SIZES, 0))
    offsets = [place for arrays in rule for place, _length in arrays]
    for start in images_in(good):
        for word in (*sorted(sizes), *offsets):
            for change in (1, -1, 8, 1 << 20, 1 << 40, -(1 << 62)):
                wrong = words.copy()
                wrong[start + word] += change
                assert not is_taken(slave, resealed(wrong)), (start, word, change)
        for word, value in (
            (Header.nodes.word, words[start + Header.capacity.word] + 1),
            (Header.parts.word, 0 if words[start + Header.parts.word] else 1),
            (Header.magic.word, direct.MAGIC),
        ):
            wrong = words.copy()
            wrong[start + word] = value
            assert not is_taken(slave, resealed(wrong)), (start, word)
    for length in (0, 1, 5, 40, images_in(good)[-1], images_in(good)[-1] + 3, len(words) - 1):
        assert not is_taken(slave, resealed(words[:length].copy()) if length > 3 else bytes(length))
    assert not is_taken(slave, resealed(np.append(words, 0)))
    assert state_of(slave) == good
    slave.close()


@pytest.mark.parametrize("kind", ["line", "system"])
def test_sealed_nonsense_in_a_state_does_no_harm(kind: str, request: pytest.FixtureRequest) -> None:
    """Random words in what a state says of its memory, with a right checksum: refused, or
    harmless."""
    _, *fmu = request.getfixturevalue(kind)
    slave = Slave(*fmu, use_scene_inputs=True)
    drive(slave, 0, 10)
    good = state_of(slave)
    rng = np.random.default_rng(5)
    values = [0, 1, -1, 3, 9, 1 << 31, 1 << 62, -(1 << 63)]
    values += np.array([np.nan, 1e300, -1e300, 0.5, 7.0]).view(np.int64).tolist()
    taken = 0
    for _ in range(300):
        words = np.frombuffer(good, dtype=np.int64).copy()
        start = images_in(good)[int(rng.integers(0, len(images_in(good))))]
        for _ in range(int(rng.integers(1, 4))):
            words[start + int(rng.integers(0, at.HEADER_WORDS))] = rng.choice(values)
        if is_taken(slave, resealed(words)):
            taken += 1
            with contextlib.suppress(FMICallException):
                slave.step(0.01)
            outputs_of(slave)
        restore(slave, good, 10 * STEP)
    assert 0 < taken < 300
    assert state_of(slave) == good
    slave.close()


WITHOUT_MEMORY = """
import ctypes, resource, sys
from pathlib import Path
from fmpy import read_model_description
from fmpy.fmi1 import FMICallException
sys.path[:0] = {paths!r}
from fmu_tools import Slave
from test_fmu_memory import STEP, outputs_of, rooms, state_of
place = Path({place!r})
slave, other = (
    Slave(place, read_model_description(str(place)), use_scene_inputs=True) for _ in range(2)
)
for _ in range({steps}):
    slave.step(STEP)
    other.step(STEP)
before = rooms(state_of(slave))
lost = outputs_of(slave)
c = ctypes.CDLL(None)
c.malloc.restype, c.malloc.argtypes = ctypes.c_void_p, [ctypes.c_size_t]
c.free.argtypes = [ctypes.c_void_p]
pages = int(Path("/proc/self/statm").read_text().split()[0])
hard = resource.getrlimit(resource.RLIMIT_AS)[1]
held = [0] * 100000
count = 0
resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize(), hard))
while True:
    block = c.malloc({chunk})
    if not block:
        break
    held[count] = block
    count += 1
try:
    slave.step({far})
    refused = False
except FMICallException:
    refused = True
resource.setrlimit(resource.RLIMIT_AS, (hard, hard))
for block in held[:count]:
    c.free(block)
assert refused
assert "than there is memory for" in slave.messages[-1][1], slave.messages
assert slave.time == other.time
assert outputs_of(slave) == lost
for each in (slave, other):
    each.step({far})
assert outputs_of(slave) == outputs_of(other)
assert rooms(state_of(slave))[0] > before[0]
print("as it was")
"""


@pytest.mark.parametrize("kind", ["line", "system"])
def test_without_memory_a_step_is_refused(kind: str, request: pytest.FixtureRequest) -> None:
    """The state stays, and with memory again the run goes on."""
    _, place, _ = request.getfixturevalue(kind)
    code = WITHOUT_MEMORY.format(
        paths=sys.path, place=str(place), steps=60, far=40.0, chunk=1 << 16
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.strip() == "as it was", done.stderr
