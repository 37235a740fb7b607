"""A vehicle that MuJoCo simulates on its tether, over ROS 2: examples/vehicle_on_tether.py again.

The node `cable` has umbilical, cage and tether. This process is the vehicle and the clock: for
every wrench of the tether it goes on by a step, publishes its odometry, and then lets the time go
on. So the two stay in step however fast or slow they are.

    python tethered_vehicle.py

starts both, and needs the package mujoco. Ends with status 1 if the vehicle missed a place by more
than 0.3 m.
"""

from __future__ import annotations

import argparse
import json
import os
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import rclpy
from geometry_msgs.msg import WrenchStamped
from nav_msgs.msg import Odometry
from rclpy.node import Node
from rclpy.time import Time
from rosgraph_msgs.msg import Clock

import cablemodel as cm

sys.path.insert(0, str(Path(__file__).parents[2] / "examples"))
from vehicle_on_tether import DURATION, LEG, SCENE, STEP, WAY, Vehicle


def turned(vector: np.ndarray, quaternion: np.ndarray) -> np.ndarray:
    """A vector (3,) turned by a quaternion (w, x, y, z)."""
    w, axis = quaternion[0], quaternion[1:]
    across = 2.0 * np.cross(axis, vector)
    return vector + w * across + np.cross(axis, across)


class TetheredVehicle(Node):
    """Steps the vehicle to where the tether is, and one step ahead: the tether then follows it."""

    def __init__(self) -> None:
        super().__init__("vehicle")
        self.vehicle = Vehicle()
        self.places: list[list[float]] = []
        self._begin: int | None = None
        self._now = 0  # [ns]
        self._answered = False
        self._clock = self.create_publisher(Clock, "/clock", 10)
        self._odometry = self.create_publisher(Odometry, "cable/vehicle/odom_in", 10)
        self.create_subscription(WrenchStamped, "cable/vehicle/wrench", self._on_wrench, 10)

    def go_on(self) -> None:
        """Let the time go on by a step, and wait a little for a wrench.

        A clock's message may be lost: until a wrench comes the same one is sent again. Only before
        the first, while the node starts, the time goes on without.
        """
        if self._answered or self._begin is None:
            self._now += round(1e9 * STEP)
        self._answered = False
        self._clock.publish(Clock(clock=Time(nanoseconds=self._now).to_msg()))
        rclpy.spin_once(self, timeout_sec=0.1)

    def _on_wrench(self, message: WrenchStamped) -> None:
        self._answered = True
        now = Time.from_msg(message.header.stamp).nanoseconds
        if self._begin is None:
            self._begin = now
        force, torque = message.wrench.force, message.wrench.torque
        wrench = np.array([force.x, force.y, force.z, torque.x, torque.y, torque.z])
        # It is given in the vehicle's axes.
        attitude = self.vehicle.pose[3:]
        pull = np.concatenate([turned(part, attitude) for part in np.split(wrench, 2)])
        while self.vehicle.time < 1e-9 * (now - self._begin) + 0.5 * STEP:
            self.vehicle.step(pull)
            self.places.append(self.vehicle.pose[:3].tolist())
        self._odometry.publish(self._message(self._begin + round(1e9 * self.vehicle.time)))

    def _message(self, stamp: int) -> Odometry:
        pose, velocity = self.vehicle.pose, self.vehicle.velocity
        back = pose[3:] * [1, -1, -1, -1]
        made = Odometry(child_frame_id="vehicle")
        made.header.stamp, made.header.frame_id = Time(nanoseconds=stamp).to_msg(), "map"
        place, turn = made.pose.pose.position, made.pose.pose.orientation
        place.x, place.y, place.z = pose[:3].tolist()
        turn.w, turn.x, turn.y, turn.z = pose[3:].tolist()
        linear, angular = made.twist.twist.linear, made.twist.twist.angular
        linear.x, linear.y, linear.z = turned(velocity[:3], back).tolist()
        angular.x, angular.y, angular.z = velocity[3:].tolist()
        return made


def simulate(folder: Path) -> np.ndarray:
    """Run the node and the vehicle; gives the vehicle's places over time (n, 3) [m]."""
    scene = folder / "scene.yaml"
    scene.write_text(cm.load_system(SCENE).to_yaml(), encoding="utf-8")
    parameters = {
        "scene": scene, "autostart": "true", "rate": 1.0 / STEP,
        "use_sim_time": "true", "vessel_input": "scene", "vessel_inputs": "vehicle=odom",
        "odom_smoothing": 0.0, "command_timeout": 5.0, "log.folder": folder,
    }  # fmt: skip
    command = [sys.executable, "-m", "cablemodel_ros.node", "--ros-args"]
    for name, value in parameters.items():
        command += ["-p", f"{name}:={value}"]
    rclpy.init()
    vehicle = TetheredVehicle()
    with (folder / "node.txt").open("w") as output:
        node = subprocess.Popen(command, stderr=output, stdout=output)
        try:
            while vehicle.vehicle.time < DURATION - 0.5 * STEP:
                vehicle.go_on()
                if node.poll() is not None:
                    raise RuntimeError((folder / "node.txt").read_text())
        finally:
            node.send_signal(signal.SIGINT)  # the node finishes its log
            try:
                node.wait(20.0)
            except subprocess.TimeoutExpired:
                node.kill()
            vehicle.destroy_node()
            rclpy.try_shutdown()
    return np.array(vehicle.places)


def main() -> int:
    """Run, and say how far off it was at the end of each leg."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--folder", type=Path, help="where the log stays; else it is removed")
    arguments = parser.parse_args()
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")  # both are on this machine
    with tempfile.TemporaryDirectory() as temporary:
        folder = arguments.folder or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        places = simulate(folder)
        (log,) = folder.glob("cable_*.mcap")
        tension = cm.open_run(log)["tether.end_tension"]
    at = [places[int((k + 1) * LEG / STEP) - 1] for k in range(len(WAY))]
    off = [float(np.linalg.norm(place - wanted)) for place, wanted in zip(at, WAY, strict=True)]
    result = {
        "places at the end of each leg [m]": [place.tolist() for place in at],
        "off [m]": off,
        "largest tension at the vehicle [N]": float(tension.max()),
    }
    print(json.dumps(result, indent=2))
    return int(max(off) > 0.3)


if __name__ == "__main__":
    sys.exit(main())
