"""Each clock is held up, paused, set and begun anew; commands go on being obeyed, and die in time.

The machine's own clock cannot be set by a test: a node whose ROS clock reads an offset from a file
stands for that.
"""

from __future__ import annotations

import signal
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from geometry_msgs.msg import TwistStamped
from rosgraph_msgs.msg import Clock

from .conftest import NodeProcess, Talker, wait_until
from .helmsman import Helmsman, Watch

Start = Callable[..., NodeProcess]


def seconds(stamp: object) -> float:
    return stamp.sec + 1e-9 * stamp.nanosec  # type: ignore[attr-defined]


def held_up(node: NodeProcess, watch: Watch, span: float = 2.0) -> None:
    """The whole process stands for a while, as on a machine that swaps."""
    node.process.send_signal(signal.SIGSTOP)
    time.sleep(span)
    node.process.send_signal(signal.SIGCONT)
    wait_until(lambda: float(watch.value("simulation", "time slipped [s]")) > 0.5)


def late(watch: Watch, talker: Talker) -> float:
    """How far the stamps of what comes now are from the ROS clock [s]."""
    now = 1e-9 * talker.node.get_clock().now().nanoseconds
    return abs(seconds(watch.applied[-1].header.stamp) - now)


def obeyed(watch: Watch, helmsman: Helmsman, speed: float) -> None:
    """A new command is met, and stays in force for longer than the time after which it is stale."""
    helmsman.velocity = [speed, 0.0, 0.0]
    wait_until(lambda: watch.velocity[0] == pytest.approx(speed, abs=1e-6), 10.0)
    watch.applied.clear()
    wait_until(lambda: len(watch.applied) > 50)
    assert min(m.twist.linear.x for m in watch.applied) > 0.9 * speed


def test_after_a_hold_up_commands_count_over_reset_and_pause(
    start_node: Start, talker: Talker
) -> None:
    node = start_node(vessel_input="cmd_vel", autostart=True, rate=50, diagnostics_rate=10)
    watch = Watch(talker)
    wait_until(lambda: watch.known("simulation", "time slipped [s]"), 300)
    helmsman = Helmsman(talker)
    obeyed(watch, helmsman, 0.8)
    held_up(node, watch)
    obeyed(watch, helmsman, 0.6)
    assert late(watch, talker) < 0.5
    assert talker.trigger("reset").success
    obeyed(watch, helmsman, 0.7)
    assert talker.transition("deactivate")
    time.sleep(1.0)
    assert talker.transition("activate")
    obeyed(watch, helmsman, 0.5)
    assert late(watch, talker) < 0.5
    helmsman.stop()
    wait_until(lambda: watch.velocity[0] == 0.0)


@pytest.mark.parametrize("mode", [{"publish_clock": True}, {"real_time_factor": 2.0}])
def test_after_a_hold_up_commands_count_where_the_node_makes_the_clock(
    start_node: Start, talker: Talker, mode: dict[str, object]
) -> None:
    node = start_node(vessel_input="cmd_vel", autostart=True, rate=50, diagnostics_rate=10,
                      command_timeout=1.0, **mode)  # fmt: skip
    watch = Watch(talker)
    wait_until(lambda: watch.known("simulation", "time slipped [s]"), 300)
    helmsman = Helmsman(talker)
    helmsman.stamped = False
    obeyed(watch, helmsman, 0.8)
    held_up(node, watch)
    obeyed(watch, helmsman, 0.6)
    assert talker.trigger("reset").success
    obeyed(watch, helmsman, 0.7)
    helmsman.stop()
    wait_until(lambda: watch.velocity[0] == 0.0)


def test_behind_a_foreign_clock_nothing_is_left_out_and_it_may_pause_and_begin_anew(
    start_node: Start, talker: Talker
) -> None:
    start_node(vessel_input="cmd_vel", autostart=True, use_sim_time=True, rate=50,
               diagnostics_rate=10, limits__acceleration=100.0)  # fmt: skip
    watch = Watch(talker)
    publisher = talker.node.create_publisher(Clock, "/clock", 10)
    twist = talker.node.create_publisher(TwistStamped, "cmd_vel", 1)
    wait_until(lambda: talker.state == "active", 300)

    def run(begin: float, span: float, speed: float | None) -> None:
        for k in range(round(span / 0.02)):
            now = begin + 0.02 * k
            clock = Clock()
            clock.clock.sec, clock.clock.nanosec = int(now), round(1e9 * (now - int(now)))
            publisher.publish(clock)
            if speed is not None:
                message = TwistStamped()
                message.header.stamp = clock.clock
                message.twist.linear.x = speed
                twist.publish(message)
            time.sleep(0.01)
        wait_until(lambda: seconds(watch.applied[-1].header.stamp) > begin + span - 0.1)

    run(5.0, 4.0, 0.8)  # far less than the machine is up
    assert watch.velocity[0] == pytest.approx(0.8)
    assert len(watch.tension) > 0.9 * len(watch.applied)
    time.sleep(0.5)  # what is on its way comes
    steps = len(watch.applied)
    time.sleep(1.5)  # a pause makes nothing stale
    assert len(watch.applied) == steps
    run(9.0, 0.2, None)
    assert watch.velocity[0] == pytest.approx(0.8)
    run(9.2, 1.0, None)  # but a controller that died is
    assert watch.velocity[0] == 0.0
    run(1.0, 3.0, 0.5)  # the foreign simulation begins anew
    assert watch.velocity[0] == pytest.approx(0.5)
    assert seconds(watch.applied[-1].header.stamp) == pytest.approx(3.98, abs=0.05)


OFFSET = """
import sys
from pathlib import Path
from rclpy.clock import Clock, ClockType
from rclpy.duration import Duration
from cablemodel_ros import node

true = Clock.now

def now(self):
    found = true(self)
    if self.clock_type == ClockType.ROS_TIME:
        found += Duration(seconds=float(Path({path!r}).read_text()))
    return found

Clock.now = now
sys.exit(node.main())
"""


@pytest.mark.parametrize("step", [-20.0, 30.0])
def test_a_system_clock_that_is_set_neither_stops_the_vessel_nor_keeps_a_dead_controller_alive(
    start_node: Start, talker: Talker, tmp_path: Path, step: float
) -> None:
    offset = tmp_path / "offset"
    offset.write_text("0.0")
    start_node(program=OFFSET.format(path=str(offset)), vessel_input="cmd_vel", autostart=True,
               rate=50, diagnostics_rate=10)  # fmt: skip
    watch = Watch(talker)
    wait_until(lambda: watch.known("simulation", "simulated time [s]"), 300)
    helmsman = Helmsman(talker)
    obeyed(watch, helmsman, 0.8)
    watch.applied.clear()
    other = tmp_path / "next"
    other.write_text(str(step))
    other.rename(offset)
    helmsman.clock = step
    time.sleep(1.5)
    assert min(m.twist.linear.x for m in watch.applied) == pytest.approx(0.8)
    assert watch.said("simulation", f"the system's clock was set by {step:+g} s")
    stamp = seconds(watch.applied[-1].header.stamp)
    now = 1e-9 * talker.node.get_clock().now().nanoseconds + step
    assert stamp == pytest.approx(now, abs=0.5)
    helmsman.stop()
    wait_until(lambda: watch.velocity[0] == 0.0, 3.0)
    assert watch.said("commands", "cmd_vel is stale")
