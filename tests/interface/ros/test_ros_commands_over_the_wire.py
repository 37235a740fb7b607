"""Node and controller in two processes: commands, their misuse, and what the node makes of it."""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from geometry_msgs.msg import Twist, TwistStamped, WrenchStamped
from nav_msgs.msg import Odometry
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import Float64

from .conftest import SCENE, NodeProcess, Talker, wait_until
from .helmsman import Helmsman, Watch

Start = Callable[..., NodeProcess]


def cloud_of(message: PointCloud2) -> np.ndarray:
    """Points (n, 6): x, y, z, tension, curvature, s."""
    assert [field.name for field in message.fields] == ["x", "y", "z", "tension", "curvature", "s"]
    return np.frombuffer(bytes(message.data), "<f4").reshape(message.width, 6)


@pytest.fixture
def running(start_node: Start, talker: Talker) -> tuple[NodeProcess, Watch]:
    node = start_node(vessel_input="cmd_vel", autostart=True, rate=50, diagnostics_rate=10,
                      limits__acceleration=1.0, limits__speed=2.0)  # fmt: skip
    watch = Watch(talker)
    wait_until(lambda: len(watch.tension) > 3, 300)
    # Topics find their listeners one by one.
    wait_until(lambda: watch.known("simulation", "simulated time [s]"))
    return node, watch


def test_commands_are_followed_within_limits_and_stale_ones_ramp_to_zero(
    running: tuple[NodeProcess, Watch], talker: Talker
) -> None:
    _, watch = running
    wait_until(lambda: watch.said("commands", "no cmd_vel yet"))
    helmsman = Helmsman(talker)
    helmsman.velocity, helmsman.rate = [0.8, 0.6, 0.0], 0.5
    wait_until(lambda: watch.velocity == pytest.approx([0.8, 0.6, 0.0], abs=1e-9))
    wait_until(lambda: watch.rate[-1].data == pytest.approx(0.5))
    wait_until(lambda: watch.length[-1].data > 50.5)
    helmsman.velocity = [9.0, 0.0, 0.0]
    wait_until(lambda: watch.velocity[0] > 1.99)
    assert max(message.twist.linear.x for message in watch.applied) <= 2.0 + 1e-9
    helmsman.stop()
    wait_until(lambda: watch.said("commands", "cmd_vel is stale"))
    wait_until(lambda: watch.said("commands", "payout_rate_cmd is stale"))
    wait_until(lambda: watch.velocity == [0.0, 0.0, 0.0])
    wait_until(lambda: watch.rate[-1].data == 0.0)
    # Every change of velocity obeys the acceleration limit, by the node's own stamps.
    times = np.array([m.header.stamp.sec + 1e-9 * m.header.stamp.nanosec for m in watch.applied])
    speeds = np.array([[m.twist.linear.x, m.twist.linear.y] for m in watch.applied])
    changes = np.linalg.norm(np.diff(speeds, axis=0), axis=1)
    assert np.all(changes <= 1.0 * np.diff(times) + 1e-6)
    helmsman.velocity = [0.5, 0.0, 0.0]  # a controller that comes back is obeyed again
    helmsman.start()
    wait_until(lambda: watch.velocity == pytest.approx([0.5, 0.0, 0.0], abs=1e-9))


def test_nan_frames_and_old_stamps_are_refused_and_do_no_harm(
    running: tuple[NodeProcess, Watch], talker: Talker
) -> None:
    node, watch = running
    helmsman = Helmsman(talker)
    helmsman.velocity = [0.5, 0.0, 0.0]
    wait_until(lambda: watch.velocity == pytest.approx([0.5, 0.0, 0.0], abs=1e-9))
    twist = talker.node.create_publisher(TwistStamped, "cmd_vel", 1)
    winch = talker.node.create_publisher(Float64, "/cable/payout_rate_cmd", 1)
    for linear, frame, age in (
        (math.nan, "map", 0), (math.inf, "map", 0), (5.0, "camera", 0), (5.0, "map", 30),
    ):  # fmt: skip
        message = TwistStamped()
        message.header.frame_id = frame
        message.header.stamp = talker.node.get_clock().now().to_msg()
        message.header.stamp.sec -= age
        message.twist.linear.x = linear
        for _ in range(20):
            twist.publish(message)
            winch.publish(Float64(data=math.nan))
            time.sleep(0.01)
    wait_until(lambda: watch.said("commands", "payout_rate_cmd refused, the last: not finite"))
    wait_until(lambda: watch.said("commands", "of cmd_vel refused"))
    time.sleep(1.0)  # one warning a second
    for _ in range(20):
        twist.publish(bytes([0, 1, 0, 0, 7]))
        time.sleep(0.01)
    wait_until(lambda: "cmd_vel: a message that ends too early" in node.text)
    assert int(watch.value("commands", "cmd_vel refused")) > 3
    assert "refused" in node.text
    assert watch.velocity == pytest.approx([0.5, 0.0, 0.0], abs=1e-9)
    assert max(message.twist.linear.x for message in watch.applied) <= 0.5 + 1e-9
    assert all(message.data == 0.0 for message in watch.rate)
    assert all(math.isfinite(message.data) for message in watch.tension)


def test_the_vessel_frame_turns(running: tuple[NodeProcess, Watch], talker: Talker) -> None:
    _, watch = running
    helmsman = Helmsman(talker, frame="base_link")
    helmsman.velocity = [0.5, 0.0, 0.0]
    wait_until(lambda: watch.velocity == pytest.approx([0.5, 0.0, 0.0], abs=1e-9))
    helmsman.turn_rate = 0.5
    wait_until(lambda: watch.velocity[1] > 0.45)  # to port: from east to north
    helmsman.turn_rate = 0.0
    wait_until(lambda: np.hypot(*watch.velocity[:2]) == pytest.approx(0.5, abs=1e-6))
    assert watch.velocity[1] > 0.25  # it may turn on a little


def test_a_storm_of_messages_does_not_hold_up_the_cable(
    running: tuple[NodeProcess, Watch], talker: Talker
) -> None:
    _, watch = running
    stop = threading.Event()
    publisher = talker.node.create_publisher(TwistStamped, "cmd_vel", 10)
    sent = [0]

    def storm() -> None:
        message = TwistStamped()
        message.twist.linear.x = 0.4
        end = time.monotonic() + 6.0
        while not stop.is_set() and time.monotonic() < end:
            for _ in range(20):
                publisher.publish(message)
                sent[0] += 1
            time.sleep(0.005)

    thread = threading.Thread(target=storm)
    before = float(watch.value("simulation", "simulated time [s]"))
    begin = time.monotonic()
    thread.start()
    time.sleep(4.0)
    now = float(watch.value("simulation", "simulated time [s]"))
    elapsed = time.monotonic() - begin
    slipped = float(watch.value("simulation", "time slipped [s]"))
    stop.set()
    thread.join()
    assert sent[0] > 1000
    assert now - before + slipped == pytest.approx(elapsed, abs=0.5)
    assert watch.velocity == pytest.approx([0.4, 0.0, 0.0], abs=1e-9)
    assert talker.state == "active"


def test_odometry_is_followed_without_drift(start_node: Start, talker: Talker) -> None:
    start_node(vessel_input="odom", odom_relative=True, autostart=True,
               tow_point="[-2.0, 0.0, 0.0]", limits__acceleration=1.0)  # fmt: skip
    motion = talker.listen("/cable/applied_odom", Odometry)
    nodes = talker.listen("/cable/nodes", PointCloud2)
    wait_until(lambda: len(motion) > 3, 300)
    publisher = talker.node.create_publisher(Odometry, "/cable/odom", 1)
    rate, radius = 0.1, 8.0
    begin = talker.node.get_clock().now().nanoseconds

    def course(now: float) -> tuple[np.ndarray, float]:
        """Vessel on a circle from its eastward course, 300 m away from the map's origin."""
        angle = rate * (now - 1e-9 * begin)
        centre = np.array([300.0, radius])
        return centre + radius * np.array([math.sin(angle), -math.cos(angle)]), angle

    def send() -> None:
        stamp = talker.node.get_clock().now()
        place, angle = course(1e-9 * stamp.nanoseconds)
        message = Odometry()
        message.header.stamp, message.header.frame_id = stamp.to_msg(), "map"
        message.child_frame_id = "base_link"
        message.pose.pose.position.x, message.pose.pose.position.y = place.tolist()
        message.pose.pose.orientation.z = math.sin(angle / 2)
        message.pose.pose.orientation.w = math.cos(angle / 2)
        message.twist.twist.linear.x = rate * radius
        message.twist.twist.angular.z = rate
        publisher.publish(message)

    first = course(1e-9 * begin)[0] + [-2.0, 0.0]
    end = talker.repeat(50.0, send)
    time.sleep(9.0)
    count = len(motion)
    time.sleep(2.0)
    end()
    errors = []
    for message in motion[count - 50 :]:
        place, angle = course(message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec)
        stern = place - 2.0 * np.array([math.cos(angle), math.sin(angle)]) - first
        applied = message.pose.pose.position
        if message is motion[-1]:
            break
        errors.append(math.hypot(applied.x - stern[0], applied.y - stern[1]))
    # The first message may come some periods after the course's beginning: a constant shift.
    assert np.median(errors) < 0.08
    assert np.ptp(errors[:100]) < 0.05
    points = cloud_of(nodes[-1])
    assert points.shape == (64, 6)
    assert points[:, 5] == pytest.approx(np.linspace(0, 50, 64), abs=1e-3)
    assert points[0, :2] == pytest.approx(
        [motion[-1].pose.pose.position.x, motion[-1].pose.pose.position.y], abs=0.05
    )


def test_plain_twist_on_request(start_node: Start, talker: Talker) -> None:
    start_node(vessel_input="cmd_vel", cmd_vel_stamped=False, autostart=True, rate=50,
               initial_heading=math.pi / 2)  # fmt: skip
    watch = Watch(talker)
    wait_until(lambda: len(watch.tension) > 3, 300)
    publisher = talker.node.create_publisher(Twist, "cmd_vel", 1)
    message = Twist()
    message.linear.x = 0.3
    talker.repeat(20.0, lambda: publisher.publish(message))
    wait_until(lambda: watch.velocity == pytest.approx([0.0, 0.3, 0.0], abs=1e-6))
    assert watch.velocity == pytest.approx([0.0, 0.3, 0.0], abs=1e-6)


def test_rates_of_roll_and_pitch_move_the_tow_point_by_its_arm(
    start_node: Start, talker: Talker
) -> None:
    """Three metres above the point about which the vessel rolls and pitches."""
    start_node(vessel_input="cmd_vel", autostart=True, rate=50, diagnostics_rate=10,
               tow_point="[0.0, 0.0, 3.0]")  # fmt: skip
    watch = Watch(talker)
    wait_until(lambda: len(watch.tension) > 3, 300)
    publisher = talker.node.create_publisher(TwistStamped, "cmd_vel", 1)
    message = TwistStamped()
    message.header.frame_id = "map"

    def send() -> None:
        message.header.stamp = talker.node.get_clock().now().to_msg()
        publisher.publish(message)

    talker.repeat(50.0, send)
    message.twist.angular.x = 0.01
    wait_until(lambda: watch.velocity == pytest.approx([0.0, -0.03, 0.0], abs=2e-3))
    message.twist.angular.x, message.twist.angular.y = 0.0, 0.02
    wait_until(lambda: watch.velocity == pytest.approx([0.06, 0.0, 0.0], abs=5e-3))


def test_odometry_with_empty_frames_is_what_the_message_means(
    start_node: Start, talker: Talker
) -> None:
    """The pose in `odom_frame`, the twist in the vessel's axes: a vessel that heads north."""
    start_node(vessel_input="odom", odom_relative=True, autostart=True, rate=50,
               diagnostics_rate=10)  # fmt: skip
    watch = Watch(talker)
    wait_until(lambda: len(watch.tension) > 3, 300)
    publisher = talker.node.create_publisher(Odometry, "/cable/odom", 1)
    begin = talker.node.get_clock().now().nanoseconds

    def send() -> None:
        stamp = talker.node.get_clock().now()
        message = Odometry()
        message.header.stamp = stamp.to_msg()
        message.pose.pose.position.y = 0.3e-9 * (stamp.nanoseconds - begin)
        orientation = message.pose.pose.orientation
        orientation.z = orientation.w = math.sqrt(0.5)
        message.twist.twist.linear.x = 0.3
        publisher.publish(message)

    talker.repeat(50.0, send)
    wait_until(lambda: watch.velocity == pytest.approx([0.0, 0.3, 0.0], abs=0.02))
    assert watch.value("commands", "odom refused") == "0"
    assert not watch.said("commands", "contradicts itself")


def test_at_default_limits_live_odometry_is_met_and_limits_are_idle(
    start_node: Start, talker: Talker
) -> None:
    """A vessel in a seaway, seen with 5 mm of noise and stamps as they come."""
    start_node(vessel_input="odom", payout_input="scene", autostart=True, diagnostics_rate=10)
    watch = Watch(talker)
    wait_until(lambda: watch.known("simulation", "cycles"), 300)
    publisher = talker.node.create_publisher(Odometry, "/cable/odom", 1)
    random = np.random.default_rng(1)
    begin = 1e-9 * talker.node.get_clock().now().nanoseconds

    def course(now: float) -> tuple[np.ndarray, np.ndarray]:
        """Half a knot ahead, half a metre up and down in six seconds."""
        t, w = now - begin, 2.0 * math.pi / 6.0
        place = np.array([0.25 * t, 0.0, 0.5 * (1.0 - math.cos(w * t))])
        return place, np.array([0.25, 0.0, 0.5 * w * math.sin(w * t)])

    def send() -> None:
        stamp = talker.node.get_clock().now()
        place, velocity = course(1e-9 * stamp.nanoseconds)
        message = Odometry()
        message.header.stamp, message.header.frame_id = stamp.to_msg(), "map"
        message.child_frame_id = "base_link"
        position, linear = message.pose.pose.position, message.twist.twist.linear
        position.x, position.y, position.z = place + 0.005 * random.standard_normal(3)
        linear.x, linear.y, linear.z = velocity
        publisher.publish(message)

    talker.repeat(50.0, send)
    wait_until(lambda: len(watch.motion) > 300, 30)
    steps = int(watch.value("simulation", "cycles"))
    limited = int(watch.value("commands", "steps with a limit at work"))
    watch.motion.clear()
    time.sleep(6.0)
    errors = []
    for message in list(watch.motion):
        place, _ = course(message.header.stamp.sec + 1e-9 * message.header.stamp.nanosec)
        at = message.pose.pose.position
        errors.append(math.dist((at.x, at.y, at.z), place))
    steps = int(watch.value("simulation", "cycles")) - steps
    limited = int(watch.value("commands", "steps with a limit at work")) - limited
    assert steps > 300
    assert limited < 0.02 * steps
    assert np.percentile(errors, 95) < 0.03


def test_pay_out_that_nothing_can_answer_is_told(
    start_node: Start, talker: Talker, tmp_path: Path
) -> None:
    scene = tmp_path / "no_drum.yaml"
    scene.write_text(SCENE.read_text().split("payout:")[0])
    start_node(scene=scene, vessel_input="scene", autostart=True, rate=50, diagnostics_rate=10)
    watch = Watch(talker)
    wait_until(lambda: watch.known("simulation", "cycles"), 300)
    winch = talker.node.create_publisher(Float64, "/cable/payout_rate_cmd", 1)
    talker.repeat(20.0, lambda: winch.publish(Float64(data=0.3)))
    wait_until(lambda: watch.said("commands", "asks for cable, and the scene has no payout.drum"))


def test_the_wrench_is_given_where_it_acts_and_about_the_vessel(
    start_node: Start, talker: Talker
) -> None:
    start_node(vessel_input="scene", payout_input="scene", autostart=True, rate=50,
               initial_heading=math.pi / 2, tow_point="[-2.0, 1.0, 0.0]")  # fmt: skip
    tow = talker.listen("/cable/top_wrench", WrenchStamped)
    vessel = talker.listen("/cable/vessel_wrench", WrenchStamped)
    wait_until(lambda: tow and vessel, 300)
    assert tow[-1].header.frame_id == "tow_point"
    assert tow[-1].wrench.force.z == pytest.approx(-50 * 2.33333, rel=1e-2)
    found = vessel[-1]
    assert found.header.frame_id == "base_link"
    # The cable hangs: 117 N down, two metres behind and one to port of the vessel's origin.
    weight, moment = -found.wrench.force.z, found.wrench.torque
    assert moment.x == pytest.approx(-1.0 * weight, abs=1e-6)
    assert moment.y == pytest.approx(-2.0 * weight, abs=1e-6)
    assert moment.z == pytest.approx(0.0, abs=1e-6)


def test_a_publisher_whose_quality_does_not_fit_is_told_of(
    running: tuple[NodeProcess, Watch], talker: Talker
) -> None:
    """A pay-out rate must not get lost: from a best-effort publisher none comes, and the log says
    so."""
    from rclpy.qos import QoSProfile, ReliabilityPolicy

    node, _ = running
    quality = QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    talker.node.create_publisher(Float64, "/cable/payout_rate_cmd", quality)
    wait_until(lambda: "payout_rate_cmd', offering incompatible QoS" in node.text)
