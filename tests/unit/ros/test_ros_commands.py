"""Commands: frames are honoured; what cannot be used is refused, counted and told."""

from __future__ import annotations

import math
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from cablemodel_ros.commands import Commands
from cablemodel_ros.frames import heading_rotation, rotation
from cablemodel_ros.helm import Helm, Present
from cablemodel_ros.samples import Sampler
from cablemodel_ros.settings import Settings
from cablemodel_ros.times import Moment, Stamp
from clocks_by_hand import Clocks
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from cablemodel import load_scene
from cablemodel.results.log.messages import quaternion_of

SCENE = Path(__file__).parents[3] / "ros2_node/scenes/waypoint_tow.yaml"
STAMP = Stamp(0) + 1000.0
NOW = Moment(0) + 7.0
"""The same instant, by the clock that commands age by."""
EAST_TO_NORTH = (0.0, 0.0, math.sqrt(0.5), math.sqrt(0.5))


def made(**values: object) -> tuple[Commands, Helm]:
    names = {name.replace("__", "."): value for name, value in values.items()}
    settings = Settings.of(names)
    commands = Commands(settings, Clocks().timebase, (0.0, 0.0, 0.0))
    return commands, Helm(settings, commands)


def at_rest(velocity=(0.0, 0.0, 0.0), rate: float = 0.0, drum: float = 100.0) -> Present:
    return Present(np.zeros(3), np.array(velocity), rate, 50.0, drum)


def odometry(commands: Commands, stamp: Stamp | None = STAMP, **changes: object) -> str:
    values = {
        "stamp": stamp, "frame": "map", "child_frame": "base_link",
        "position": (0.0, 0.0, 0.0), "orientation": (0.0, 0.0, 0.0, 1.0),
        "linear": (1.0, 0.0, 0.0), "angular": (0.0, 0.0, 0.0),
    }  # fmt: skip
    return commands.take_odometry(**{**values, **changes})  # type: ignore[arg-type]


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_is_refused_and_the_command_before_stays(bad: float) -> None:
    commands, _ = made()
    assert commands.take_twist(STAMP, "map", (1, 0, 0), (0, 0, 0)) == ""
    assert "not finite" in commands.take_twist(STAMP, "map", (1, bad, 0), (0, 0, 0))
    assert commands.take_payout_rate(0.5) == ""
    assert "not finite" in commands.take_payout_rate(bad)
    assert odometry(commands) == ""
    for name in ("position", "orientation", "linear", "angular"):
        size = 4 if name == "orientation" else 3
        assert "not finite" in odometry(commands, **{name: (bad,) * size})
    latest = commands.latest()
    assert latest.twist is not None
    assert latest.twist.linear.tolist() == [1, 0, 0]
    assert latest.payout is not None
    assert latest.payout.rate == 0.5
    counts = {topic: (t.received, t.refused) for topic, t in commands.tallies.items()}
    assert counts == {"odom": (1, 4), "cmd_vel": (1, 1), "payout_rate_cmd": (1, 1)}


def test_frames_that_are_not_known_are_refused_by_name() -> None:
    commands, _ = made()
    reason = commands.take_twist(STAMP, "camera", (1, 0, 0), (0, 0, 0))
    assert "'camera'" in reason
    assert "map, base_link" in reason
    assert "'odom'" in odometry(commands, frame="odom")


def test_stamps_that_are_old_or_in_the_future_are_refused() -> None:
    commands, _ = made(command_timeout=0.5)
    assert "0.6 s old" in commands.take_twist(STAMP + -0.6, "map", (1, 0, 0), (0, 0, 0))
    assert "in the future" in odometry(commands, stamp=STAMP + 2.0)
    assert commands.take_twist(None, "map", (1, 0, 0), (0, 0, 0)) == ""  # not stamped


def test_an_orientation_that_is_no_rotation_is_refused() -> None:
    commands, _ = made()
    assert "unit quaternion" in odometry(commands, orientation=(0.0, 0.0, 0.0, 0.0))


def test_a_twist_in_the_vessel_frame_turns_with_the_vessel() -> None:
    commands, helm = made(vessel_input="cmd_vel", initial_heading=math.pi / 2,
                          limits__acceleration=1000.0)  # fmt: skip
    commands.take_twist(STAMP, "base_link", (1, 0, 0), (0, 0, 0))
    applied = helm.inputs(NOW, 0.01, at_rest())
    assert applied.velocity == pytest.approx([0, 1, 0], abs=1e-12)
    commands.take_twist(STAMP, "map", (1, 0, 0), (0, 0, 0))
    assert helm.inputs(NOW, 0.01, at_rest()).velocity == pytest.approx([1, 0, 0])
    commands.take_twist(STAMP, "base_link", (1, 0, 0), (0, 0, 0.5))
    for _ in range(100):  # half a radian in a second
        applied = helm.inputs(NOW, 0.01, at_rest())
    assert applied.velocity == pytest.approx([-math.sin(0.5), math.cos(0.5), 0], abs=1e-9)


def test_the_tow_point_of_a_turning_vessel_moves_by_its_arm() -> None:
    commands, helm = made(vessel_input="cmd_vel", tow_point=[-5.0, 0.0, 0.0],
                          limits__acceleration=1000.0)  # fmt: skip
    commands.take_twist(STAMP, "base_link", (0, 0, 0), (0, 0, 0.2))
    applied = helm.inputs(NOW, 0.01, at_rest())
    assert applied.velocity == pytest.approx([0.002, -1.0, 0], abs=1e-5)


def test_odometry_gives_the_tow_point_in_the_map() -> None:
    commands, _ = made(tow_point=[-2.0, 0.0, 1.0])
    assert odometry(commands, position=(10.0, 0.0, 0.0), orientation=EAST_TO_NORTH,
                    angular=(0.0, 0.0, 0.1)) == ""  # fmt: skip
    sample = commands.latest().odometry
    assert sample is not None
    assert sample.course.position == pytest.approx([10.0, -2.0, 1.0])
    # The bow points north; turning to port swings the stern to the east.
    assert sample.course.velocity == pytest.approx([0.2, 1.0, 0.0])


def test_roll_and_pitch_rates_move_the_tow_point_by_its_arm() -> None:
    """A tow point 3 m above and 5 m behind the origin: v + omega x r, with all three rates."""
    ahead, spin = np.array([1.0, 0.0, 0.0]), np.array([0.3, -0.2, 0.1])
    arm = np.array([-5.0, 0.0, 3.0])
    commands, helm = made(vessel_input="cmd_vel", tow_point=arm.tolist(),
                          limits__acceleration=1.0e3, limits__speed=100.0)  # fmt: skip
    commands.take_twist(STAMP, "base_link", (1, 0, 0), spin)
    dt = 1e-3
    applied = helm.inputs(NOW, dt, at_rest(tuple(ahead + np.cross(spin, arm))))
    assert applied.velocity == pytest.approx(ahead + np.cross(spin, arm), abs=2e-3)
    for _ in range(999):  # for a second, against scipy's rotation by the same vector
        helm.inputs(NOW, dt, at_rest())
    assert helm.rotation == pytest.approx(Rotation.from_rotvec(spin).as_matrix(), abs=1e-9)
    commands, _ = made(tow_point=arm.tolist())
    assert odometry(commands, angular=tuple(spin)) == ""
    sample = commands.latest().odometry
    assert sample is not None
    assert sample.course.velocity == pytest.approx(ahead + np.cross(spin, arm))


def test_between_samples_the_vessel_turns_on() -> None:
    """What is given in its axes, and its frame on /tf, do not wait for the next sample."""
    commands, helm = made(command_timeout=5.0, odom_frame="odom")
    assert odometry(commands, frame="odom", angular=(0.0, 0.0, 0.1)) == ""
    for after in (0.0, 0.4, 1.0):
        helm.inputs(NOW + after, 0.01, at_rest())
        assert helm.rotation == pytest.approx(heading_rotation(0.1 * after), abs=1e-12)
    # Of a sample that is refused, nothing is taken.
    assert odometry(commands, STAMP + 0.1, frame="odom", position=(900.0, 0.0, 0.0),
                    orientation=EAST_TO_NORTH) == ""  # fmt: skip
    helm.inputs(NOW + 1.0, 0.01, at_rest())
    assert "m from the present one" in commands.tallies["odom"].reason
    assert helm.rotation == pytest.approx(heading_rotation(0.1), abs=1e-12)


def test_a_turn_above_its_limit_is_counted() -> None:
    commands, helm = made(vessel_input="cmd_vel", payout_input="scene")
    for rate, limited in ((0.9, 0), (1.5, 1)):
        commands.take_twist(STAMP, "base_link", (0, 0, 0), (0, 0, rate))
        helm.inputs(NOW, 0.01, at_rest())
        assert helm.limited == limited


def test_empty_frames_of_odometry_are_what_the_message_means() -> None:
    """A vessel that heads north: its own speed ahead is northward, one in the map is eastward."""
    for frame, child, velocity in (
        ("", "", [0, 1, 0]), ("map", "", [0, 1, 0]), ("", "base_link", [0, 1, 0]),
        ("map", "map", [1, 0, 0]),
    ):  # fmt: skip
        commands, _ = made()
        assert odometry(commands, frame=frame, child_frame=child, orientation=EAST_TO_NORTH) == ""
        sample = commands.latest().odometry
        assert sample is not None
        assert sample.course.velocity == pytest.approx(velocity)
    commands, _ = made()
    assert "child frame 'imu'; allowed: base_link, map" in odometry(commands, child_frame="imu")


@pytest.mark.parametrize(
    ("axes", "told"), [("base_link", True), ("map", False)], ids=["wrong axes", "right axes"]
)
def test_a_twist_that_contradicts_its_pose_is_told(axes: str, told: bool) -> None:
    """A vessel heads north at 1.5 m/s, its velocity is given in the map; with waves and noise."""
    commands, _ = made(command_timeout=20.0)
    noise = np.random.default_rng(1).normal(0.0, 0.1, (500, 3))
    for n in range(500):
        t = 0.02 * n
        place = np.array([0.3 * math.sin(t), 1.5 * t, 0.0]) + noise[n]
        stamp = STAMP + (t - 9.98)
        speed = (0.3 * math.cos(t), 1.5, 0.0)
        assert odometry(commands, stamp, child_frame=axes, position=place, linear=speed,
                        orientation=EAST_TO_NORTH) == ""  # fmt: skip
    found = list(commands.contradictions())
    assert bool(found) == told
    assert not told or "odom contradicts itself by 1." in found[0]


def test_pay_out_without_a_drum_is_told() -> None:
    commands, helm = made(vessel_input="scene")
    commands.take_payout_rate(0.2)
    assert helm.inputs(NOW, 0.01, at_rest(drum=0.0)).payout_rate == 0.0
    assert helm.idle_payout
    helm.inputs(NOW, 0.01, at_rest(drum=5.0))
    assert not helm.idle_payout


def test_the_wrench_on_the_vessel_has_the_moment_of_its_arm() -> None:
    """10 N to the east, 2 m behind the origin of a vessel that heads north: in vessel axes the
    force is (0, -10, 0) at (-2, 0, 0), and turns the bow to port with 20 N m."""
    sampler = Sampler(load_scene(SCENE), Settings.of({"tow_point": [-2.0, 0.0, 0.0]}))
    model: Any = SimpleNamespace(
        top_force=np.array([10.0, 0.0, 0.0]), top_moment=np.array([0.0, 0.0, 3.0])
    )
    force, moment = sampler.vessel_wrench(model, heading_rotation(math.pi / 2))
    assert force == pytest.approx([0, -10, 0], abs=1e-12)
    assert moment == pytest.approx([0, 0, 23.0])


def test_relative_odometry_counts_from_the_first_message() -> None:
    commands, _ = made(odom_relative=True)
    odometry(commands, position=(500.0, 300.0, 0.0))
    odometry(commands, position=(501.0, 300.0, 0.0))
    sample = commands.latest().odometry
    assert sample is not None
    assert sample.course.position == pytest.approx([1.0, 0.0, 0.0])


def test_a_jump_in_position_is_refused_with_distance_and_advice() -> None:
    commands, helm = made(limits__position_jump=10.0)
    odometry(commands, position=(500.0, 0.0, 0.0))
    applied = helm.inputs(NOW, 0.01, at_rest())
    assert applied.velocity == pytest.approx([0, 0, 0])
    assert commands.tallies["odom"].refused == 1
    assert "500 m" in commands.tallies["odom"].reason
    assert "odom_relative" in commands.tallies["odom"].reason


def test_a_stale_command_ramps_to_zero_and_comes_back() -> None:
    clocks = Clocks()
    settings = Settings.of({"vessel_input": "cmd_vel", "command_timeout": 0.5})
    commands = Commands(settings, clocks.timebase)
    helm = Helm(settings, commands)
    commands.take_twist(STAMP, "map", (1, 0, 0), (0, 0, 0))
    commands.take_payout_rate(0.5)
    moving = at_rest((1.0, 0.0, 0.0), 0.5)
    fresh = helm.inputs(NOW + 0.5, 0.1, moving)
    assert fresh.velocity == pytest.approx([1, 0, 0])
    assert fresh.payout_rate == 0.5
    assert helm.stale == set()
    late = helm.inputs(NOW + 0.6, 0.1, moving)
    assert late.velocity == pytest.approx([0.8, 0, 0])
    assert late.payout_rate == pytest.approx(0.4)
    assert helm.stale == {"cmd_vel", "payout_rate_cmd"}
    clocks.wait(1.0)
    commands.take_twist(STAMP + 1.0, "map", (1, 0, 0), (0, 0, 0))
    helm.inputs(NOW + 1.0, 0.1, moving)
    assert helm.stale == {"payout_rate_cmd"}


@pytest.mark.parametrize("step", [-20.0, 30.0])
def test_a_system_clock_that_is_set_makes_commands_neither_older_nor_younger(step: float) -> None:
    clocks = Clocks()
    settings = Settings.of({"vessel_input": "cmd_vel", "limits.acceleration": 1000.0})
    commands = Commands(settings, clocks.timebase)
    helm = Helm(settings, commands)
    commands.take_twist(clocks.ros, "map", (1, 0, 0), (0, 0, 0))
    clocks.wait(0.1)
    clocks.set(step)
    assert helm.inputs(clocks.timebase.now(), 0.01, at_rest()).velocity[0] == 1.0
    # The controller's stamps follow the clock, and are as good as before.
    assert commands.take_twist(clocks.ros, "map", (2, 0, 0), (0, 0, 0)) == ""
    assert helm.inputs(clocks.timebase.now(), 0.01, at_rest()).velocity[0] == 2.0
    clocks.wait(0.6)  # then it dies
    assert helm.inputs(clocks.timebase.now(), 0.01, at_rest()).velocity[0] == 0.0
    assert helm.stale == {"cmd_vel"}


def test_a_stamp_in_the_future_does_not_keep_a_command_alive() -> None:
    commands, helm = made(vessel_input="cmd_vel")
    assert commands.take_twist(STAMP + 0.9, "map", (1, 0, 0), (0, 0, 0)) == ""
    helm.inputs(NOW + 0.6, 0.01, at_rest())
    assert helm.stale == {"cmd_vel"}


def test_before_the_first_command_nothing_moves_and_the_helm_waits() -> None:
    _, helm = made()
    applied = helm.inputs(NOW, 0.01, at_rest())
    assert applied.velocity == pytest.approx([0, 0, 0])
    assert applied.payout_rate == 0
    assert helm.waiting == {"odom"}


def test_a_scene_that_drives_itself_is_left_alone() -> None:
    _, helm = made(vessel_input="scene", payout_input="scene")
    applied = helm.inputs(NOW, 0.01, at_rest())
    assert applied.given == ()
    assert helm.waiting == set()


@given(st.floats(-3.1, 3.1), st.floats(-1.5, 1.5), st.floats(-3.1, 3.1))
def test_quaternions_and_matrices_are_each_others_inverse(a: float, b: float, c: float) -> None:
    turn = heading_rotation(a) @ np.roll(np.roll(heading_rotation(b), 1, 0), 1, 1)
    turn = turn @ np.roll(np.roll(heading_rotation(c), -1, 0), -1, 1)
    assert rotation(quaternion_of(turn)) == pytest.approx(turn, abs=1e-12)
