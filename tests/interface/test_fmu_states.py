"""FMU states: saved, restored, moved to another process; many instances; threads."""

import shutil
import threading

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from fmu_tools import Slave, driven_elsewhere, still_scene, unpacked


@pytest.fixture(scope="module")
def still(tmp_path_factory):
    with unpacked(still_scene(), tmp_path_factory.mktemp("fmu"), stations=3) as found:
        yield found


def drive(slave, first: int, last: int) -> bytes:
    """Steps number first to last; every output after each one."""
    seen = b""
    for n in range(first, last):
        slave.set("vessel.velocity", (0.4 * np.sin(0.1 * n), 0.1 * np.cos(0.3 * n), 0))
        slave.set("payout.rate", 0.3 * np.sin(0.2 * n))
        slave.step(0.05 + 0.01 * (n % 7))
        for name in ("tension.top", "end.position", "line.curvature", "drum.length"):
            seen += np.asarray(slave.get(name)).tobytes()
    return seen


def test_restored_state_goes_on_identically(still):
    slave = Slave(*still)
    drive(slave, 0, 25)
    state, time = slave.fmu.getFMUstate(), slave.time
    expected = drive(slave, 25, 60)
    for _ in range(2):
        slave.fmu.setFMUstate(state)
        slave.time = time
        assert drive(slave, 25, 60) == expected
    slave.fmu.freeFMUstate(state)
    slave.close()


def test_state_holds_inputs_parameters_and_phase(still):
    slave = Slave(*still)
    slave.set("vessel.velocity", (0.1, 0.2, 0.3))
    slave.set("cable_types.K.drag_normal", 1.5)
    state = slave.fmu.getFMUstate()
    slave.set("vessel.velocity", (0, 0, 0))
    slave.set("cable_types.K.drag_normal", 1.0)
    slave.fmu.terminate()
    slave.fmu.setFMUstate(state)
    assert slave.get("vessel.velocity").tolist() == [0.1, 0.2, 0.3]
    assert slave.get("cable_types.K.drag_normal") == 1.5
    slave.step(0.1)
    slave.close()


def test_a_state_overwrites_one_that_is_given(still):
    import ctypes

    slave = Slave(*still)
    state = slave.fmu.getFMUstate()
    address = state.value
    slave.step(0.1)
    slave.fmu.fmi2GetFMUstate(slave.fmu.component, ctypes.byref(state))
    assert state.value == address
    after = slave.get("end.position").tobytes()
    slave.step(3.0)
    slave.fmu.setFMUstate(state)
    assert slave.get("end.position").tobytes() == after
    slave.close()


def test_state_goes_on_in_another_process(still, tmp_path):
    slave = Slave(*still)
    drive(slave, 0, 25)
    elsewhere = driven_elsewhere(slave, still[0], tmp_path, "test_fmu_states", 25, 60)
    assert elsewhere == drive(slave, 25, 60)
    slave.close()


def test_states_that_are_not_whole_are_refused(still, tmp_path):
    slave = Slave(*still)
    drive(slave, 0, 5)
    good = bytearray(slave.fmu.serializeFMUstate(slave.fmu.getFMUstate()))
    rng = np.random.default_rng(4)
    for position in (0, 8, 16, 24, 32, *rng.integers(0, len(good), 200)):
        bad = bytearray(good)
        bad[position] ^= 0x10
        if position in range(20, 24):
            continue  # the upper half of the checksum
        with pytest.raises(FMICallException):
            slave.fmu.deSerializeFMUstate(bytes(bad))
    for bad in (good[:-8], good + bytes(8), b""):
        with pytest.raises(FMICallException):
            slave.fmu.deSerializeFMUstate(bytes(bad))
    with unpacked(still_scene(title="Another"), tmp_path, stations=3) as other:
        stranger = Slave(*other)
        with pytest.raises(FMICallException):
            stranger.fmu.deSerializeFMUstate(bytes(good))
        assert "another FMU" in stranger.messages[-1][1]
        stranger.close()
    before = slave.get("end.position").tobytes()
    slave.fmu.setFMUstate(slave.fmu.deSerializeFMUstate(bytes(good)))
    assert slave.get("end.position").tobytes() == before
    slave.close()


def test_a_folder_with_a_strange_name(still, tmp_path):
    """The resource location is a URI: spaces and letters beyond ASCII are escaped in it."""
    place = tmp_path / "båt & kabel #1 %20"
    shutil.copytree(still[0], place)
    slave = Slave(place, still[1])
    slave.step(0.1)
    assert slave.get("tension.top") > 0.0
    slave.close()


def test_a_thousand_instances(still):
    slaves = [Slave(*still) for _ in range(1000)]
    for n, slave in enumerate(slaves):
        slave.set("vessel.velocity", (0.001 * n, 0, 0))
        slave.step(0.5)
    tension = np.array([slave.get("tension.top") for slave in slaves])
    assert np.unique(tension).size > 990
    alone = Slave(*still)
    alone.set("vessel.velocity", (0.5, 0, 0))
    alone.step(0.5)
    assert alone.get("tension.top") == tension[500]
    for slave in (*slaves, alone):
        slave.close()


def test_instances_in_parallel_threads(still):
    """ctypes lets go of Python's lock: the steps run at the same time, with the same result."""
    alone = Slave(*still)
    expected = drive(alone, 0, 80)
    slaves = [Slave(*still) for _ in range(8)]
    seen = {}
    threads = [
        threading.Thread(target=lambda s=s, k=k: seen.update({k: drive(s, 0, 80)}))
        for k, s in enumerate(slaves)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert seen == dict.fromkeys(range(8), expected)
    for slave in (*slaves, alone):
        slave.close()


def test_a_rollback_keeps_input_derivatives(still):
    """They are for the next step, which may be tried twice; moved elsewhere, too."""
    slave = Slave(*still)
    reference = slave.references["vessel.velocity[3]"].valueReference
    slave.set("vessel.velocity", (0.0, 0.0, 0.1))
    slave.fmu.setRealInputDerivatives([reference], [1], [2.0])
    state = slave.fmu.getFMUstate()
    moved = slave.fmu.deSerializeFMUstate(slave.fmu.serializeFMUstate(state))
    tensions = []
    for kept in (None, state, moved):
        if kept is not None:
            slave.fmu.setFMUstate(kept)
            slave.time = 0.0
        slave.step(0.1)
        tensions.append(slave.get("tension.top"))
    assert tensions[1:] == tensions[:1] * 2
    slave.fmu.setFMUstate(state)
    slave.fmu.setRealInputDerivatives([], [], [])
    slave.time = 0.0
    slave.step(0.1)
    assert abs(slave.get("tension.top") - tensions[0]) > 1.0  # they do something
    slave.close()


def test_a_rollback_keeps_what_was_extrapolated(still):
    slave = Slave(*still, **{"input.timing": 2})
    for n in range(3):
        slave.set("vessel.velocity", (0.1 * n * n, 0, 0))
        slave.step(0.2)
    state = slave.fmu.getFMUstate()
    seen = set()
    for _ in range(2):
        slave.fmu.setFMUstate(state)
        slave.time = 0.6
        slave.set("vessel.velocity", (0.5, 0, 0))
        slave.step(0.3)
        seen.add(slave.get("end.position").tobytes())
    assert len(seen) == 1
    slave.close()


def test_saving_and_restoring_take_less_than_five_microseconds(still):
    """Beside steps of one or two: what leaves the instance has a checksum, nothing else."""
    import ctypes
    import time

    slave = Slave(*still)
    drive(slave, 0, 20)
    state = slave.fmu.getFMUstate()
    get = slave.fmu.dll.fmi2GetFMUstate
    put = slave.fmu.dll.fmi2SetFMUstate
    for call, argument in ((get, ctypes.byref(state)), (put, state)):
        best = np.inf
        for _ in range(20):
            begin = time.perf_counter()
            for _ in range(200):
                call(slave.fmu.component, argument)
            best = min(best, (time.perf_counter() - begin) / 200)
        assert best < 5e-6
    slave.close()


def test_a_state_of_fewer_elements_leaves_nothing_behind(still):
    """The mesh grows as cable is paid out; a state from before has the bytes that it had."""
    slave = Slave(*still)
    state = slave.fmu.getFMUstate()
    before = slave.fmu.serializeFMUstate(state)
    for _ in range(20):
        slave.set("payout.rate", 1.0)
        slave.step(0.5)
    assert slave.get("line.length") > 39.0
    slave.fmu.setFMUstate(state)
    assert slave.fmu.serializeFMUstate(slave.fmu.getFMUstate()) == before
    slave.close()
