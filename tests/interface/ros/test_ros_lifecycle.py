"""The lifecycle in all orders, parameters, and services, over the wire."""

from __future__ import annotations

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from geometry_msgs.msg import Twist
from std_msgs.msg import Float64, String

import cablemodel as cm

from .conftest import SCENE, STARTS_IN, NodeProcess, Talker, wait_until

Start = Callable[..., NodeProcess]


def test_all_transitions_and_those_that_do_not_exist(start_node: Start, talker: Talker) -> None:
    node = start_node(vessel_input="cmd_vel")
    tensions = talker.listen("/cable/tension_top", Float64)
    assert talker.state == "unconfigured"
    for impossible in ("activate", "deactivate", "cleanup"):
        assert not talker.transition(impossible)
    assert talker.state == "unconfigured"
    refusal = "transition activate refused: the node is unconfigured; allowed: configure, "
    wait_until(lambda: refusal in node.text)
    for _ in range(2):
        assert talker.transition("configure")
        assert talker.state == "inactive"
        for impossible in ("configure", "deactivate"):
            assert not talker.transition(impossible)
        count = len(tensions)
        for _ in range(2):
            assert talker.transition("activate")
            assert not talker.transition("activate")
            assert not talker.transition("cleanup")
            wait_until(lambda n=count: len(tensions) > n + 5)
            assert talker.transition("deactivate")
            assert talker.state == "inactive"
            count = len(tensions)
        assert talker.transition("cleanup")
        assert talker.state == "unconfigured"
    assert talker.transition("configure")
    assert talker.transition("activate")
    assert talker.transition("active_shutdown")
    assert talker.state == "finalized"
    weight = 50 * 2.33333
    assert tensions[0].data == pytest.approx(weight, rel=1e-3)
    assert node.process.poll() is None
    assert node.stop() == 0


def test_a_wrong_scene_fails_configure_with_its_own_message(
    start_node: Start, talker: Talker, tmp_path: Path
) -> None:
    wrong = tmp_path / "wrong.yaml"
    wrong.write_text(SCENE.read_text().replace("length: 50", "lenght: 50"))
    node = start_node(scene=wrong)
    with pytest.raises(cm.SceneError) as caught:
        cm.load_scene(wrong)
    assert not talker.transition("configure")
    assert talker.state == "unconfigured"
    wait_until(lambda: "did you mean length" in node.text)
    for line in str(caught.value).splitlines():
        assert line in node.text
    assert talker.set_parameter("scene", str(SCENE)).successful
    assert talker.transition("configure")


def test_bad_parameters_are_refused_with_reasons(start_node: Start, talker: Talker) -> None:
    start_node(vessel_input="cmd_vel", rate=50)
    for name, value, reason in (
        ("rate", -1.0, "out of range"),
        ("rate", float("nan"), "out of range"),
        ("stations", 0, "out of range"),
        ("vessel_input", "wind", "allowed: odom"),
        ("vessel_frame", "hull", "read-only"),
    ):
        result = talker.set_parameter(name, value)
        assert not result.successful
        assert reason in result.reason, result.reason
    result = talker.set_parameter("use_sim_time", True)
    assert not result.successful
    assert "at start-up only" in result.reason
    assert talker.set_parameter("use_sim_time", False).successful  # as it is
    assert talker.transition("configure")
    result = talker.set_parameter("rate", 20.0)
    assert not result.successful
    assert "before the node is configured" in result.reason
    assert talker.set_parameter("limits.speed", 1.5).successful
    assert talker.set_parameter("command_timeout", 0.3).successful


def test_a_wrong_start_parameter_ends_the_node_in_plain_words(start_node: Start) -> None:
    node = start_node(vessel_input="wind")
    assert node.process.wait(60) == 2
    assert "vessel_input is 'wind'; allowed: odom | cmd_vel | scene" in node.text
    assert "Traceback" not in node.text


def test_what_the_graph_shows_to_be_wrong_is_told(
    start_node: Start, talker: Talker, tmp_path: Path
) -> None:
    """A misspelt parameter, a plain Twist, a pay-out rate with best effort, a second node."""
    from rclpy.qos import QoSProfile, ReliabilityPolicy

    from .helmsman import Watch

    watch = Watch(talker)
    told = partial(watch.said, "commands")
    settings = {"vessel_input": "cmd_vel", "autostart": True, "diagnostics_rate": 10.0}
    node = start_node(**settings, command_timout=0.1)
    twist = talker.node.create_publisher(Twist, "cmd_vel", 1)
    careless = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    talker.node.create_publisher(Float64, "/cable/payout_rate_cmd", careless)
    wait_until(lambda: told("cmd_vel comes as geometry_msgs/msg/Twist from talker"), STARTS_IN)
    assert told("geometry_msgs/msg/TwistStamped is (or cmd_vel_stamped: false)")
    wait_until(lambda: told("payout_rate_cmd comes with best effort from talker"))
    assert "no parameter command_timout: it is ignored; did you mean command_timeout?" in node.text
    assert not told("run twice")
    talker.node.destroy_publisher(twist)
    (tmp_path / "second").mkdir()
    second = NodeProcess(tmp_path / "second", scene=SCENE, **settings)
    try:
        wait_until(lambda: "does /cable run twice?" in node.text, STARTS_IN)
        twice = "another node publishes ~/applied_inputs, too: does /cable run twice?"
        wait_until(lambda: told(twice))  # diagnostics come after the console
    finally:
        second.stop()
    watch.diagnostics.clear()
    wait_until(lambda: len(watch.diagnostics) > 10)
    watch.diagnostics.clear()
    wait_until(lambda: watch.diagnostics)
    assert not told("comes as")
    assert not told("run twice")
    assert node.text.count("cmd_vel comes as") == 1


def test_commands_and_clocks_of_two_senders_and_topics_that_nothing_takes_are_told(
    start_node: Start, talker: Talker
) -> None:
    """Two controllers of one vessel, a second clock, odometry of a vessel that cmd_vel moves, and a
    command by a wrong name; what runs as it should, and what left, is not."""
    import rclpy
    from geometry_msgs.msg import TwistStamped
    from nav_msgs.msg import Odometry
    from rosgraph_msgs.msg import Clock

    from .helmsman import Helmsman, Watch

    watch = Watch(talker)
    told = partial(watch.said, "commands")
    node = start_node(vessel_input="cmd_vel", autostart=True, diagnostics_rate=10.0,
                      publish_clock=True)  # fmt: skip
    helmsman = Helmsman(talker)
    helmsman.stamped, helmsman.rate = False, 0.1
    wait_until(lambda: watch.velocity == [0.0, 0.0, 0.0], STARTS_IN)
    watch.diagnostics.clear()
    wait_until(lambda: len(watch.diagnostics) > 10)
    for words in ("take turns", "to and fro", "nothing takes it"):
        assert not told(words)
    other = rclpy.create_node("other", context=talker.context)
    for kind, topic in ((TwistStamped, "cmd_vel"), (Clock, "/clock"), (Odometry, "/cable/odom"),
                        (Float64, "/cable/payout_rate_command")):  # fmt: skip
        other.create_publisher(kind, topic, 1)
    wait_until(lambda: told("cmd_vel comes from /other and /talker: they take turns"))
    wait_until(lambda: told("more than one node publishes /clock: time goes to and fro"))
    takes = "comes from other, and nothing takes it: cmd_vel, payout_rate_cmd"
    wait_until(lambda: told(f"odom {takes}"))
    wait_until(lambda: told(f"payout_rate_command {takes}"))
    assert "they take turns" in node.text
    other.destroy_node()

    def nothing_told() -> bool:
        watch.diagnostics.clear()
        wait_until(lambda: len(watch.diagnostics) > 3)
        return not any(told(words) for words in ("to and fro", "take turns", "nothing takes it"))

    wait_until(nothing_told)


def test_following_a_clock_and_making_one_exclude_each_other(
    start_node: Start, talker: Talker
) -> None:
    node = start_node(use_sim_time=True, publish_clock=True)
    assert not talker.transition("configure")
    wait_until(lambda: "use_sim_time follows a foreign /clock" in node.text)


def test_reset_save_and_scene_summary(start_node: Start, talker: Talker, tmp_path: Path) -> None:
    start_node(vessel_input="scene", payout_input="scene", save_folder=tmp_path / "saved",
               autostart=True)  # fmt: skip
    lengths = talker.listen("/cable/line_length", Float64)
    wait_until(lambda: len(lengths) > 20, 300)
    summaries = talker.listen("/cable/scene", String, latched=True)  # later than it was published
    wait_until(lambda: summaries)
    summary: dict[str, Any] = json.loads(summaries[0].data)
    assert summary["title"] == "Way-point tow with a tension-limiting winch"
    assert cm.load_scene(summary["scene"]) == cm.load_scene(SCENE)
    saved = talker.trigger("save")
    assert saved.success
    path = Path(saved.message)
    assert path.exists()
    assert cm.load_scene(path.with_suffix(".yaml")) == cm.load_scene(SCENE)
    assert talker.trigger("reset").success
    assert talker.set_parameter("save_folder", "/dev/null/nowhere").successful
    refused = talker.trigger("save")
    assert not refused.success
    assert "cannot save" in refused.message


def test_a_signal_between_two_looks_at_the_context_is_a_shutdown(tmp_path: Path) -> None:
    """What rclpy then says of its wait set is no failure of the node; with a context it is one."""
    code = """
import rclpy
from rclpy.executors import SingleThreadedExecutor
from cablemodel_ros.node import until_shutdown

class Racing(SingleThreadedExecutor):
    def spin(self):
        self.context.shutdown()
        self.spin_once(timeout_sec=0.1)
        raise AssertionError("rclpy waited in a context that is down")

rclpy.init()
executor = Racing()
executor.add_node(rclpy.create_node("racing"))
with until_shutdown():
    executor.spin()
print("ended quietly")

context = rclpy.Context()
rclpy.init(context=context)
node = rclpy.create_node("other", context=context)
from rclpy.impl.implementation_singleton import rclpy_implementation
with until_shutdown(context):
    raise rclpy_implementation.RCLError("of something else")
"""
    node = NodeProcess(tmp_path, code)
    assert node.process.wait(60) == 1
    node.stop()
    assert "ended quietly" in node.text
    assert node.text.rstrip().endswith("RCLError: of something else")
