"""Time in all its modes, the log under a kill, controllers that die, and the example."""

from __future__ import annotations

import json
import math
import os
import signal
import struct
import subprocess
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TwistStamped
from mcap.exceptions import EndOfFile
from mcap.records import Channel, Message, Schema
from mcap.stream_reader import StreamReader
from rosbags.rosbag2 import Reader
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64

import cablemodel as cm

from .conftest import ROOT, NodeProcess, Talker, wait_until
from .helmsman import Watch

Start = Callable[..., NodeProcess]
EXAMPLES = ROOT / "ros2_node/examples"
FREE_RUN = {"vessel_input": "scene", "payout_input": "scene", "autostart": True}


def seconds(stamp: object) -> float:
    return stamp.sec + 1e-9 * stamp.nanosec  # type: ignore[attr-defined]


def clocks(talker: Talker) -> list[Clock]:
    from rclpy.qos import QoSProfile, ReliabilityPolicy

    found = talker.received["/clock"]
    quality = QoSProfile(depth=1000, reliability=ReliabilityPolicy.BEST_EFFORT)
    talker.node.create_subscription(Clock, "/clock", found.append, quality)
    return found


def test_as_fast_as_possible_makes_a_clock_that_never_goes_back(
    start_node: Start, talker: Talker
) -> None:
    ticks = clocks(talker)
    start_node(**FREE_RUN, real_time_factor=0.0)
    wait_until(lambda: len(ticks) > 10, 300)
    begin, first = time.monotonic(), seconds(ticks[-1].clock)
    time.sleep(2.0)
    assert talker.trigger("reset").success
    time.sleep(1.0)
    assert (seconds(ticks[-1].clock) - first) > 1.5 * (time.monotonic() - begin)
    times = [seconds(tick.clock) for tick in ticks]
    assert times == sorted(times)


def test_following_a_foreign_clock_its_pauses_and_its_jumps(
    start_node: Start, talker: Talker
) -> None:
    start_node(**FREE_RUN, use_sim_time=True, rate=50, diagnostics_rate=10)
    applied = talker.listen("/cable/applied_cmd_vel", TwistStamped)
    diagnostics = talker.listen("/diagnostics", DiagnosticArray)
    publisher = talker.node.create_publisher(Clock, "/clock", 10)

    def tick(now: float) -> None:
        message = Clock()
        message.clock.sec, part = int(now), now - int(now)
        message.clock.nanosec = round(1e9 * part)
        publisher.publish(message)

    def last() -> float:
        return seconds(applied[-1].header.stamp)

    wait_until(lambda: talker.state == "active", 300)
    now = 100.0
    end = time.monotonic() + 30.0
    while not applied or last() < 110.0 - 1e-6:  # four times real time
        now = min(now + 0.02, 110.0)
        tick(now)
        time.sleep(0.005)
        assert time.monotonic() < end
    stamps = np.array([seconds(message.header.stamp) for message in applied])
    steps = np.diff(stamps)
    assert np.all(steps > 0)
    assert np.allclose(steps / 0.02, np.round(steps / 0.02), atol=1e-6)
    count = len(applied)
    time.sleep(0.5)  # a pause
    assert len(applied) == count
    wait_until(lambda: any("time stands still" in s.message for a in diagnostics for s in a.status))
    for k in range(30):
        tick(5.0 + 0.02 * k)
        time.sleep(0.01)
    wait_until(lambda: last() == pytest.approx(5.58, abs=0.03))
    wait_until(lambda: any("jumped" in s.message for a in diagnostics for s in a.status))


def test_a_kill_loses_at_most_the_last_second(
    start_node: Start, talker: Talker, tmp_path: Path
) -> None:
    node = start_node(**FREE_RUN, log__folder=tmp_path / "log")
    tensions = talker.listen("/cable/applied_cmd_vel", TwistStamped)
    wait_until(lambda: len(tensions) > 350, 300)
    node.process.send_signal(signal.SIGKILL)
    node.process.wait()
    killed = time.time()
    time.sleep(0.2)
    (path,) = (tmp_path / "log").glob("cable_*.mcap")
    run = cm.open_run(path)
    assert not run.complete
    logged = run.applied_inputs["time"]
    assert np.all(np.diff(logged) > 0)
    begin = seconds(tensions[0].header.stamp)
    epoch = 1e-9 * int(run.metadata["epoch_ns"])
    assert killed - (epoch + logged[-1]) < 1.0 + 0.1  # and the moment between kill and clock
    assert seconds(tensions[-1].header.stamp) - (epoch + logged[-1]) < 1.0
    # Whatever reads records one after another, without an index, has them all, and can decode them.
    with path.open("rb") as file:
        found, channels, schemas = [], {}, {}
        with suppress(EndOfFile, struct.error):
            for record in StreamReader(file).records:
                if isinstance(record, Schema):
                    schemas[record.id] = record
                elif isinstance(record, Channel):
                    channels[record.id] = record
                elif isinstance(record, Message):
                    found.append((channels[record.channel_id], record))
    assert all(schemas[channel.schema_id].data for channel, _ in found)
    steps = [record for channel, record in found if channel.topic == "/cable/applied_inputs"]
    assert len(steps) == len(logged)
    assert epoch + logged[0] <= begin + 1e-6  # seconds of the epoch as a float end at 2.4e-7
    assert len(run.states) >= 6


def test_a_node_in_a_namespace_logs_what_is_on_the_wire(
    start_node: Start, talker: Talker, tmp_path: Path
) -> None:
    folder = tmp_path / "log"
    node = start_node(**FREE_RUN, log__folder=folder, log__max_size=0.1,
                      remap=("__ns:=/tug", "~/tension_top:=/load_cell"))  # fmt: skip
    tensions = talker.listen("/load_cell", Float64)
    diagnostics = talker.listen("/diagnostics", DiagnosticArray)
    wait_until(lambda: len(tensions) > 200, 300)
    wait_until(lambda: any(s.name == "tug/cable: log" for a in diagnostics for s in a.status))
    assert node.stop() == 0
    with Reader(folder) as bag:
        assert {"/load_cell", "/tug/cable/nodes", "/tug/cable/applied_inputs"} <= set(bag.topics)
        assert not [topic for topic in bag.topics if topic.startswith("/cable")]
    for path in folder.glob("tug_cable_*.mcap"):
        assert cm.open_run(path).top_tension[0] == pytest.approx(50 * 2.33333, rel=0.1)


def test_a_log_whose_folder_fails_goes_on_when_its_cause_is_gone(
    start_node: Start, talker: Talker, tmp_path: Path
) -> None:
    folder = tmp_path / "log"
    folder.write_text("not a folder")
    node = start_node(**FREE_RUN, log__folder=folder, diagnostics_rate=10)
    watch = Watch(talker)
    wait_until(lambda: watch.said("log", "nothing is logged"), 300)
    wait_until(lambda: "log: nothing is logged: " in node.text)
    folder.unlink()
    wait_until(lambda: watch.said("log", "a new file begins after the gap"), 60)
    watch.diagnostics.clear()
    wait_until(lambda: watch.known("log", "file"))
    assert not watch.said("log", "nothing is logged")
    assert node.stop() == 0
    (path,) = folder.glob("cable_*.mcap")
    assert cm.open_run(path).complete


def test_a_log_that_is_shortened_is_given_up_for_a_new_file(
    start_node: Start, talker: Talker, tmp_path: Path
) -> None:
    """By what rotates logs in place, say: what follows would stand behind a hole."""
    folder = tmp_path / "log"
    node = start_node(vessel_input="scene", payout_input="scene", autostart=True, rate=50,
                      log__folder=folder, diagnostics_rate=10)  # fmt: skip
    watch = Watch(talker)
    wait_until(lambda: any(int(size) > 0 for size in watch.known("log", "bytes")), 300)
    (first,) = folder.glob("cable_*.mcap")
    first.write_bytes(b"")
    wait_until(lambda: watch.said("log", "is shorter than what was written to it"))
    wait_until(lambda: watch.said("log", "a new file begins after the gap"), 60)
    time.sleep(1.0)
    assert node.stop() == 0
    (second,) = set(folder.glob("cable_*.mcap")) - {first}
    assert cm.open_run(second).complete


def test_rotation_leaves_files_of_the_users_own(
    start_node: Start, talker: Talker, tmp_path: Path
) -> None:
    """Though they are called as the node calls its files."""
    folder = tmp_path / "log"
    folder.mkdir()
    own = folder / "cable_20200101T000000_0000.mcap"
    own.write_text("of the user's own")
    node = start_node(**FREE_RUN, log__folder=folder, log__max_size=0.1, log__max_files=2,
                      real_time_factor=20.0, diagnostics_rate=10)  # fmt: skip
    watch = Watch(talker)
    wait_until(lambda: any(int(count) > 4 for count in watch.known("log", "files")), 300)
    assert node.stop() == 0
    assert own.read_text() == "of the user's own"
    assert len(list(folder.glob("cable_*.mcap"))) == 3


def test_a_controller_may_die_and_come_back(start_node: Start, talker: Talker) -> None:
    start_node(vessel_input="cmd_vel", autostart=True, rate=50, diagnostics_rate=10)
    applied = talker.listen("/cable/applied_cmd_vel", TwistStamped)
    diagnostics = talker.listen("/diagnostics", DiagnosticArray)
    command = [sys.executable, str(EXAMPLES / "waypoint_controller.py")]
    wait_until(lambda: len(applied) > 3, 300)
    for _ in range(2):
        controller = subprocess.Popen(command)
        try:
            wait_until(lambda: applied[-1].twist.linear.x > 0.7, 60)
            diagnostics.clear()
        finally:
            controller.kill()
            controller.wait()
        wait_until(lambda: applied[-1].twist.linear.x == 0.0)
        wait_until(
            lambda: any("cmd_vel is stale" in s.message for a in diagnostics for s in a.status)
        )
    assert talker.state == "active"


def test_node_and_library_fed_the_same_commands_give_the_same_states(
    start_node: Start, talker: Talker, tmp_path: Path
) -> None:
    node = start_node(vessel_input="cmd_vel", autostart=True, rate=50, log__folder=tmp_path / "log")
    applied = talker.listen("/cable/applied_cmd_vel", TwistStamped)
    wait_until(lambda: len(applied) > 3, 300)
    twist = talker.node.create_publisher(TwistStamped, "cmd_vel", 1)
    winch = talker.node.create_publisher(Float64, "/cable/payout_rate_cmd", 1)
    begin = time.monotonic()

    def send() -> None:
        t = time.monotonic() - begin
        message = TwistStamped()
        message.header.stamp = talker.node.get_clock().now().to_msg()
        message.twist.linear.x = 0.8 * math.cos(0.5 * t)
        message.twist.linear.y = 0.8 * math.sin(0.5 * t)
        twist.publish(message)
        winch.publish(Float64(data=0.3 * math.sin(t)))

    talker.repeat(50.0, send)
    wait_until(lambda: len(applied) > 400, 60)
    assert node.stop() == 0
    (path,) = (tmp_path / "log").glob("cable_*.mcap")
    run = cm.open_run(path)
    assert run.complete
    inputs = run.applied_inputs
    assert np.abs(inputs["payout_rate"]).max() > 0.2
    # What went over the wire is what the log holds.
    velocities = {(m.twist.linear.x, m.twist.linear.y) for m in applied}
    logged = set(zip(inputs["vessel_velocity.x"], inputs["vessel_velocity.y"], strict=True))
    assert velocities <= logged
    model = cm.CableModel(run.scene)
    states = {0.0: model.state()}
    for k, end in enumerate(inputs["time"]):
        velocity = [inputs[f"vessel_velocity.{axis}"][k] for axis in "xyz"]
        model.step_to(end, vessel_velocity=velocity, payout_rate=inputs["payout_rate"][k])
        states[float(end)] = model.state()
    assert len(run.states) >= 16
    for state in run.states:
        assert np.array_equal(state.position, states[state.time].position)
        assert np.array_equal(state.tension, states[state.time].tension)


@pytest.mark.slow
def test_the_waypoint_example_keeps_the_tension_below_its_limit(tmp_path: Path) -> None:
    command = [sys.executable, str(EXAMPLES / "waypoint_tow.py"), "--factor", "15",
               "--folder", str(tmp_path), "--plot", str(tmp_path / "tow.png")]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, timeout=500, env=os.environ)
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    assert result["highest tension [N]"] < 300
    assert result["highest tension with the winch locked [N]"] == pytest.approx(392, abs=6)
    assert 60 < result["longest line [m]"] < 70
    assert result["line at the end [m]"] < 53
    assert (tmp_path / "tow.png").stat().st_size > 20_000
