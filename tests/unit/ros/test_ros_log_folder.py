"""The log's folder: only the node's own files go, what fails is tried again, and it is one bag."""

from __future__ import annotations

import shutil
import struct
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from cablemodel_ros import recording
from cablemodel_ros.control import ControlLoop
from cablemodel_ros.diagnostics import ERROR, OK, WARN, Diagnostics
from cablemodel_ros.session import Names, Session
from cablemodel_ros.settings import Settings
from cablemodel_ros.times import Simulated
from clocks_by_hand import Clocks
from mcap.exceptions import EndOfFile
from mcap.records import Message
from mcap.stream_reader import StreamReader
from rosbags.rosbag2 import Reader

import cablemodel as cm

CABLE = {
    "diameter": 0.01666, "mass": 0.4613, "submerged_weight": 2.33333, "axial_stiffness": 1.0e6,
    "bending_stiffness": 0.1, "drag_normal": 1.0, "drag_tangential": 0.1586, "added_mass": 1.0,
}  # fmt: skip
SCENE: dict[str, Any] = {
    "cable_types": {"K": CABLE},
    "line": [{"cable": {"type": "K", "length": 30}}],
    "run": {"duration": 60, "output_interval": 0.1},
}
TUG = Names("/tug/cable", lambda topic: topic.replace("~", "/tug/cable"))


def begun(folder: Path, names: Names | None = None, **values: Any) -> Session:
    settings = Settings.of(
        {"scene": cm.load_scene(SCENE).to_yaml(), "vessel_input": "scene",
         "payout_input": "scene", "log.folder": str(folder),
         **{key.replace("__", "."): value for key, value in values.items()}}
    )  # fmt: skip
    made = Session(settings, Clocks().timebase, names)
    made.start()
    return made


def steps(session: Session, count: int) -> None:
    begin = round(100 * session.model.time)
    for k in range(begin + 1, begin + count + 1):
        session.cycle(Simulated(0.01 * k))


def files_of(session: Session, count: int) -> None:
    """As many files, each of them with steps in it."""
    recorder = session.recorder
    assert recorder is not None
    for number in range(count):
        steps(session, 30)
        wait_until(lambda n=number: recorder.files == n + 1)
        if number < count - 1:
            recorder.wants_file = True
    steps(session, 1)


def wait_until(condition: Callable[[], Any], seconds: float = 20.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.01)


def test_rotation_removes_what_this_node_wrote_and_nothing_else(tmp_path: Path) -> None:
    foreign = [tmp_path / "cable_20200101T000000_0000.mcap", tmp_path / "cable_of_mine.mcap"]
    for path in foreign:
        path.write_bytes(b"somebody's")
    session = begun(tmp_path, log__max_files=3)
    files_of(session, 3)
    session.close()
    (first, *_) = sorted(set(tmp_path.glob("cable_*.mcap")) - set(foreign))
    renamed, copied = tmp_path / "kept.mcap", tmp_path / "cable_copy.mcap"
    shutil.copy(first, copied)
    first.rename(renamed)
    other = begun(tmp_path, TUG, log__max_files=3)
    files_of(other, 2)
    other.close()
    session = begun(tmp_path, log__max_files=2)  # a later process of the first node
    files_of(session, 4)
    session.close()
    left = set(tmp_path.glob("*.mcap"))
    assert {*foreign, renamed, copied} <= left
    assert len(left - {*foreign, renamed, copied}) == 2 + 2
    assert len(list(tmp_path.glob("tug_cable_*.mcap"))) == 2


def test_a_file_that_took_the_place_of_ours_stays(tmp_path: Path) -> None:
    session = begun(tmp_path, log__max_files=1)
    files_of(session, 1)
    session.close()
    (path,) = tmp_path.glob("cable_*.mcap")
    path.unlink()
    (tmp_path / "new").write_bytes(b"somebody's")
    (tmp_path / "new").rename(path)
    session = begun(tmp_path, log__max_files=1)
    files_of(session, 3)
    session.close()
    assert path.read_bytes() == b"somebody's"
    assert len(list(tmp_path.glob("cable_*.mcap"))) == 2


def test_a_log_that_fails_is_tried_again_and_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(recording, "RETRY", 0.2)
    folder = tmp_path / "log"
    folder.write_text("not a folder")
    session = begun(folder)
    recorder = session.recorder
    assert recorder is not None
    loop = ControlLoop(session, threading.Lock(), lambda c: None, lambda reason: None)
    diagnostics = Diagnostics(session, loop)
    wait_until(lambda: recorder.error)
    steps(session, 50)
    assert session.model.time == pytest.approx(0.5)  # the cable goes on
    status = diagnostics.statuses()[2]
    assert status.level == ERROR
    assert "nothing is logged" in status.message
    folder.unlink()
    wait_until(lambda: steps(session, 1) or not recorder.error)
    before = session.model.time
    steps(session, 50)
    status = diagnostics.statuses()[2]
    assert status.level == WARN
    assert "a new file begins after the gap" in status.message
    assert diagnostics.statuses()[2].level == OK
    session.close()
    (path,) = folder.glob("cable_*.mcap")
    times = cm.open_run(path).applied_inputs["time"]
    assert times[0] <= before + 0.02
    assert times[-1] == pytest.approx(session.model.time)
    assert recorder.failures == 1


def test_a_disk_that_fills_up_costs_one_file_and_leaves_no_empty_ones(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from cablemodel.results.log.writer import LogWriter

    monkeypatch.setattr(recording, "RETRY", 0.1)
    whole, full = LogWriter.flush, threading.Event()

    def flush(writer: LogWriter) -> None:
        if full.is_set():
            raise OSError(28, "No space left on device")
        whole(writer)

    monkeypatch.setattr(LogWriter, "flush", flush)
    session = begun(tmp_path, log__max_files=3)
    recorder = session.recorder
    assert recorder is not None
    files_of(session, 1)
    wait_until(lambda: recorder.written > 0)
    full.set()
    until = time.monotonic() + 1.5
    while time.monotonic() < until:
        steps(session, 1)
    assert recorder.failures >= 1
    full.clear()
    loop = ControlLoop(session, threading.Lock(), lambda c: None, lambda reason: None)
    diagnostics = Diagnostics(session, loop)
    wait_until(lambda: steps(session, 1) or (not recorder.error and recorder.written > 0))
    status = diagnostics.statuses()[2]
    assert status.level == WARN
    assert "a new file begins after the gap" in status.message
    session.close()
    logs = sorted(tmp_path.glob("cable_*.mcap"))
    assert len(logs) == 2
    assert "No space left" in cm.open_run(logs[0]).reason
    assert cm.open_run(logs[1]).complete


def test_the_folder_is_a_bag_of_all_finished_files(tmp_path: Path) -> None:
    session = begun(tmp_path, log__max_files=3)
    files_of(session, 3)
    session.close()
    runs = [cm.open_run(path) for path in sorted(tmp_path.glob("cable_*.mcap"))]
    logged = np.concatenate([run.applied_inputs["time"] for run in runs])
    with Reader(tmp_path) as bag:
        counts = {c.topic: c.msgcount for c in bag.connections}
        assert counts["/cable/applied_inputs"] == len(logged) == 91
        stamps = [stamp for c, stamp, _ in bag.messages() if c.topic == "/cable/applied_inputs"]
        assert stamps == sorted(stamps)
        assert bag.duration == pytest.approx(0.91e9, rel=1e-3)


def test_a_bag_of_somebody_else_is_left_alone_and_told(tmp_path: Path) -> None:
    theirs = tmp_path / "metadata.yaml"
    theirs.write_text(yaml.safe_dump({"rosbag2_bagfile_information": {"version": 5}}))
    before = theirs.read_bytes()
    session = begun(tmp_path)
    files_of(session, 2)
    recorder = session.recorder
    assert recorder is not None
    wait_until(lambda: recorder.problem)
    loop = ControlLoop(session, threading.Lock(), lambda c: None, lambda reason: None)
    assert "left as it is" in Diagnostics(session, loop).statuses()[2].message
    session.close()
    assert theirs.read_bytes() == before


def test_a_node_in_a_namespace_logs_its_own_topics_and_they_open_by_the_table(
    tmp_path: Path,
) -> None:
    session = begun(tmp_path, TUG)
    files_of(session, 1)
    session.close()
    (path,) = tmp_path.glob("tug_cable_*.mcap")
    with Reader(tmp_path) as bag:
        topics = set(bag.topics)
    assert "/tug/cable/tension_top" in topics
    assert not [topic for topic in topics if topic.startswith("/cable")]
    run = cm.open_run(path)
    assert run.top_tension[0] == pytest.approx(30 * 2.33333, rel=1e-3)
    assert len(run.states) == 4
    assert run.applied_inputs["time"][-1] == pytest.approx(0.31)


def test_a_cut_log_is_read_to_its_last_chunk_without_an_index(tmp_path: Path) -> None:
    """As `mcap recover` reads it: record by record, schemas and channels before their messages."""
    session = begun(tmp_path)
    recorder = session.recorder
    assert recorder is not None
    steps(session, 150)
    wait_until(lambda: recorder.written > 0)
    time.sleep(0.6)
    (path,) = tmp_path.glob("cable_*.mcap")
    cut = tmp_path / "cut.mcap"
    shutil.copy(path, cut)
    session.close()
    found, known = [], set()
    with cut.open("rb") as file, suppress(EndOfFile, struct.error):
        for record in StreamReader(file).records:
            if type(record).__name__ == "Channel":
                known.add(record.id)
            if isinstance(record, Message):
                assert record.channel_id in known
                found.append(record)
    run = cm.open_run(cut)
    assert not run.complete
    assert len(found) > 150
    assert len(found) == sum(run._source.log.counts().values())
