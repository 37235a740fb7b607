"""A system over the wire: parts are moved, pushed and cut by their names; the library agrees."""

from __future__ import annotations

import copy
import json
import math
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from cablemodel_ros.frames import angle_rates, angles_of, axes_of, rotation
from geometry_msgs.msg import TwistStamped, WrenchStamped
from nav_msgs.msg import Odometry
from rosbags.rosbag2 import Reader
from sensor_msgs.msg import PointCloud2
from std_msgs.msg import Float64, Float64MultiArray
from std_srvs.srv import Trigger
from system_to_steer import SCENE as SYSTEM
from visualization_msgs.msg import MarkerArray

import cablemodel as cm
from cablemodel import variables
from cablemodel.results.log.messages import quaternion_of
from cablemodel.results.replay import replay

from .conftest import ROOT, SCENE, NodeProcess, Talker, wait_until
from .helmsman import Watch

Start = Callable[..., NodeProcess]
ARM = np.array([-10.0, 0.0, 3.0])
"""The sheave, in the ship's axes [m]."""


@pytest.fixture
def system(tmp_path: Path) -> Path:
    path = tmp_path / "system.yaml"
    path.write_text(cm.load_system(SYSTEM).to_yaml())
    return path


def seconds(stamp: Any) -> float:
    return float(stamp.sec + 1e-9 * stamp.nanosec)


def vector(message: Any) -> np.ndarray:
    return np.array([message.x, message.y, message.z])


def axes(message: Any) -> np.ndarray:
    return rotation([message.x, message.y, message.z, message.w])


class Bridge:
    """Commands every part of the system 50 times a second, by a course of time."""

    PERIOD = 6.0

    def __init__(self, talker: Talker, node: str = "/cable") -> None:
        self._node = talker.node
        self.frames = {"ship": "ship", "cage": "map"}
        make = talker.node.create_publisher
        self._ship = make(Odometry, f"{node}/ship/odom_in", 1)
        self._vehicle = make(TwistStamped, f"{node}/vehicle/cmd_vel", 1)
        self._cage = make(WrenchStamped, f"{node}/cage/wrench_in", 1)
        self.fin = make(Float64, f"{node}/cage/fin/deflection", 1)
        self.begin = self._now()
        self.push = np.zeros(3)
        self.end = talker.repeat(50.0, self.send)

    def _now(self) -> float:
        return 1e-9 * self._node.get_clock().now().nanoseconds

    def course(self, now: float) -> tuple[np.ndarray, ...]:
        """Place, velocity, angles and their rates: it heaves, pitches by 5 degrees, and yaws."""
        t, w = now - self.begin, 2.0 * math.pi / self.PERIOD
        wave, slope = math.sin(w * t), w * math.cos(w * t)
        ahead, up, pitch = np.eye(3)[0], np.eye(3)[2], math.radians(5.0) * np.eye(3)[1]
        return (
            0.3 * t * ahead + 0.4 * wave * up,
            0.3 * ahead + 0.4 * slope * up,
            pitch * wave + 0.01 * t * up,
            pitch * slope + 0.01 * up,
        )

    def send(self) -> None:
        stamp = self._node.get_clock().now().to_msg()
        place, velocity, angles, rates = self.course(seconds(stamp))
        turn = axes_of(angles)
        # Rates of angles are linear in the spin.
        matrix = np.column_stack([angle_rates(angles, axis) for axis in np.eye(3)])
        odometry = Odometry()
        odometry.header.stamp, odometry.header.frame_id = stamp, "map"
        odometry.child_frame_id = self.frames["ship"]
        pose, twist = odometry.pose.pose, odometry.twist.twist
        pose.position.x, pose.position.y, pose.position.z = place.tolist()
        o = pose.orientation
        o.x, o.y, o.z, o.w = quaternion_of(turn)
        linear, spin = velocity @ turn, np.linalg.solve(matrix, rates) @ turn
        twist.linear.x, twist.linear.y, twist.linear.z = linear.tolist()
        twist.angular.x, twist.angular.y, twist.angular.z = spin.tolist()
        self._ship.publish(odometry)
        command = TwistStamped()
        command.header.stamp, command.header.frame_id = stamp, "vehicle"
        command.twist.linear.x, command.twist.angular.z = 0.2, 0.05
        self._vehicle.publish(command)
        if np.any(self.push):
            wrench = WrenchStamped()
            wrench.header.stamp, wrench.header.frame_id = stamp, self.frames["cage"]
            force = wrench.wrench.force
            force.x, force.y, force.z = self.push.tolist()
            self._cage.publish(wrench)


def test_a_ship_pitches_by_odometry_and_feels_its_lines_about_its_origin(
    start_node: Start, talker: Talker, system: Path
) -> None:
    start_node(scene=system, vessel_inputs="vehicle=cmd_vel", autostart=True, rate=50,
               stations=9, diagnostics_rate=10)  # fmt: skip
    ship = talker.listen("/cable/ship/odom", Odometry)
    wrench = talker.listen("/cable/ship/wrench", WrenchStamped)
    tension = talker.listen("/cable/umbilical/tension_start", Float64)
    nodes = talker.listen("/cable/umbilical/nodes", PointCloud2)
    pictures = talker.listen("/cable/markers", MarkerArray)
    wait_until(lambda: len(ship) > 3, 300)
    bridge = Bridge(talker)
    time.sleep(1.5 * bridge.PERIOD)
    for kept in (ship, wrench, tension, nodes):
        kept.clear()
    wait_until(lambda: len(ship) > 300, 60)
    places, turns = [], []
    for message in list(ship):
        place, _, angles, _ = bridge.course(seconds(message.header.stamp))
        assert message.child_frame_id == "ship"
        places.append(vector(message.pose.pose.position) - place)
        turns.append(angles_of(axes(message.pose.pose.orientation)) - angles)
    assert np.percentile(np.abs(places), 95) < 0.02
    assert np.percentile(np.abs(turns), 95) < math.radians(0.25)
    assert np.max(np.abs(turns[0])) < math.radians(1.0)
    forces = np.array([vector(message.wrench.force) for message in list(wrench)])
    moments = np.array([vector(message.wrench.torque) for message in list(wrench)])
    assert wrench[-1].header.frame_id == "ship"
    assert moments == pytest.approx(np.cross(ARM, forces), abs=1e-9 * np.abs(forces).max())
    sizes, tensions = np.linalg.norm(forces, axis=1), np.array([item.data for item in tension])
    assert sizes.max() == pytest.approx(tensions.max(), rel=1e-2)
    assert np.ptp(tensions) > 50.0  # it heaves
    cloud = np.frombuffer(bytes(nodes[-1].data), "<f4").reshape(-1, 6)
    assert cloud.shape == (9, 6)
    top = vector(ship[-1].pose.pose.position) + axes(ship[-1].pose.pose.orientation) @ ARM
    assert np.linalg.norm(cloud[0, :3] - top) < 0.05
    lines, texts = pictures[-1].markers[0:4:2], pictures[-1].markers[1:4:2]
    assert [len(line.points) for line in lines] == [9, 9]
    assert [text.text.split(": ")[0] for text in texts] == ["umbilical", "tether"]


def test_a_body_is_pushed_a_foil_turned_a_line_cut_and_what_is_wrong_is_told(
    start_node: Start, talker: Talker, system: Path
) -> None:
    start_node(scene=system, vessel_inputs="vehicle=cmd_vel", autostart=True, rate=50,
               diagnostics_rate=10)  # fmt: skip
    cage = talker.listen("/cable/cage/odom", Odometry)
    cut = talker.listen("/cable/weak_link/time", Float64)
    end = talker.listen("/cable/tether/tension_start", Float64)
    inputs = talker.listen("/cable/applied_inputs", Float64MultiArray)
    watch = Watch(talker)
    wait_until(lambda: len(cage) > 3, 300)
    wait_until(lambda: watch.said("commands", "no ship/odom_in yet"))
    bridge = Bridge(talker)
    place = {label: k for k, label in enumerate(variables.input_labels(cm.load_system(system)))}

    def last(label: str) -> float:
        return float(inputs[-1].data[place[label]])

    assert math.isnan(last("cage.force.y"))
    bridge.push = np.array([0.0, 400.0, 0.0])
    wait_until(lambda: last("cage.force.y") == 400.0)
    wait_until(lambda: cage[-1].pose.pose.position.y > 0.5)
    bridge.fin.publish(Float64(data=0.25))
    wait_until(lambda: last("cage.fin.deflection") == 0.25)
    bridge.push = np.zeros(3)  # its publisher falls silent
    wait_until(lambda: watch.said("commands", "cage/wrench_in is stale"))
    wait_until(lambda: math.isnan(last("cage.force.y")))
    bridge.frames["ship"] = "camera"
    wait_until(lambda: watch.said("commands", "of ship/odom_in refused, the last: child frame"))
    wait_until(lambda: watch.said("commands", "ship/odom_in is stale: ramping to zero"))
    wait_until(lambda: [last(f"ship.velocity.{axis}") for axis in "xyz"] == [0.0, 0.0, 0.0])
    bridge.frames["ship"] = "ship"
    bridge.fin.publish(Float64(data=math.nan))
    wait_until(lambda: watch.said("commands", "1 of cage/fin/deflection refused"))

    assert math.isnan(cut[-1].data)
    before = last("time")
    made = talker.call("/cable/weak_link/cut", Trigger)
    assert made.success
    wait_until(lambda: cut[-1].data >= before)
    at = cut[-1].data
    wait_until(lambda: last("time") > at + 1.0)
    again = talker.call("/cable/weak_link/cut", Trigger)
    assert not again.success
    assert again.message == f"weak_link: made already, at t = {at:.6g} s"
    wait_until(lambda: watch.known("simulation", "weak_link made [s]")[-1] == f"{at:.3f}")
    assert end[-1].data < 50.0  # twenty metres that hang: five newtons, and what they are dragged
    assert talker.trigger("reset").success
    wait_until(lambda: math.isnan(cut[-1].data))
    assert talker.transition("deactivate")
    refused = talker.call("/cable/weak_link/cut", Trigger)
    assert not refused.success
    assert "not active" in refused.message


def test_pay_out_of_a_winch_without_a_drum_is_told(
    start_node: Start, talker: Talker, tmp_path: Path
) -> None:
    path, data = tmp_path / "no_drum.yaml", copy.deepcopy(SYSTEM)
    data["winches"]["hoist"]["drum"] = 0.0
    path.write_text(cm.load_system(data).to_yaml())
    start_node(scene=path, vessel_input="scene", autostart=True, rate=50, diagnostics_rate=10)
    watch = Watch(talker)
    wait_until(lambda: watch.known("simulation", "cycles"), 300)
    winch = talker.node.create_publisher(Float64, "/cable/hoist/payout_rate_cmd", 1)
    talker.repeat(20.0, lambda: winch.publish(Float64(data=0.3)))
    told = "hoist/payout_rate_cmd asks for cable, and winches.hoist has no drum"
    wait_until(lambda: watch.said("commands", told))
    assert int(watch.value("commands", "steps with a limit at work")) > 0


def test_library_and_node_agree_to_the_bit_and_the_log_replays(
    start_node: Start, talker: Talker, system: Path, tmp_path: Path
) -> None:
    folder = tmp_path / "log"
    node = start_node(scene=system, vessel_inputs="vehicle=cmd_vel", autostart=True, rate=50,
                      log__folder=folder, remap=("__ns:=/tug",))  # fmt: skip
    sent = talker.listen("/tug/cable/outputs", Float64MultiArray)
    wait_until(lambda: len(sent) > 3, 300)
    bridge = Bridge(talker, "/tug/cable")
    bridge.push = np.array([100.0, 50.0, 0.0])
    bridge.fin.publish(Float64(data=0.2))
    time.sleep(4.0)
    assert talker.call("/tug/cable/weak_link/cut", Trigger).success
    bridge.fin.publish(Float64(data=-0.1))
    time.sleep(4.0)
    assert node.stop() == 0
    with Reader(folder) as bag:
        names = {"ship/odom", "tether/state", "outputs", "applied_inputs", "weak_link/time"}
        assert {f"/tug/cable/{name}" for name in names} <= set(bag.topics)
        assert not [topic for topic in bag.topics if topic.startswith("/cable")]
    (path,) = folder.glob("tug_cable_*.mcap")
    run = cm.open_run(path)
    assert run.complete
    result = replay(run)
    assert result.exact, result
    assert result.steps > 350
    # What went over the wire is what the library gives, fed the inputs that were applied.
    wire = {message.data[0]: message.data for message in sent}
    model = cm.SystemModel(run.scene)
    labels = variables.input_labels(run.scene)
    outputs = [row for row in variables.outputs_of(run.scene) if row.message != variables.CLOUD]
    compared = 0
    for row in np.stack([run.applied_inputs[label] for label in labels], axis=1):
        model.step_to(row[0], **model.given_by(row))
        if model.time in wire:
            found = model.outputs()
            expected = [model.time, *(np.atleast_1d(found[output.python]) for output in outputs)]
            assert np.array_equal(wire[model.time], np.hstack(expected), equal_nan=True)
            compared += 1
    assert compared > 300
    assert model.cuts["weak_link"] is not None


@pytest.mark.slow
def test_a_vehicle_that_mujoco_simulates_goes_the_same_way_over_ros(tmp_path: Path) -> None:
    from examples.vehicle_on_tether import LEG, STEP, WAY, couple

    example = ROOT / "ros2_node/examples/tethered_vehicle.py"
    command = [sys.executable, str(example), "--folder", str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, env=os.environ)
    assert done.returncode == 0, done.stderr
    result = json.loads(done.stdout)
    run = couple()
    for k, place in enumerate(result["places at the end of each leg [m]"]):
        there = run["place"][int((k + 1) * LEG / STEP) - 1]
        assert np.linalg.norm(there - place) < 0.02
    assert len(result["off [m]"]) == len(WAY)
    assert result["largest tension at the vehicle [N]"] == pytest.approx(
        run["tension"].max(), rel=0.05
    )


def test_a_scene_of_one_line_and_a_system_take_turns(
    start_node: Start, talker: Talker, system: Path, tmp_path: Path
) -> None:
    node = start_node(vessel_input="scene", vessel_inputs="ship=radio", save_folder=tmp_path)
    assert talker.transition("configure")
    wait_until(lambda: "vessel_inputs is set, and means nothing for this scene" in node.text)
    tension = talker.listen("/cable/tension_top", Float64)
    end = talker.listen("/cable/tether/tension_end", Float64)
    assert talker.transition("activate")
    wait_until(lambda: len(tension) > 5)
    assert talker.transition("deactivate")
    assert talker.transition("cleanup")
    assert talker.set_parameter("scene", str(system)).successful
    assert not talker.transition("configure")
    wait_until(lambda: "'ship=radio'; allowed: NAME=SOURCE with NAME ship | vehicle" in node.text)
    assert talker.set_parameter("vessel_inputs", "").successful
    assert talker.transition("configure")
    assert talker.transition("activate")
    wait_until(lambda: len(end) > 5)
    assert talker.trigger("save").success
    assert len(list(tmp_path.glob("cable_*.npz"))) == 1
    assert talker.transition("deactivate")
    assert talker.transition("cleanup")
    assert talker.set_parameter("scene", str(SCENE)).successful
    assert talker.transition("configure")
