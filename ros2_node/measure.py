"""Measure the node as a robot would see it: processor, cycle times, memory.

    python ros2_node/measure.py --minutes 10 --hours 1

Starts the node on the turn scene (30 m of cable in three dimensions, tolerance 1e-3) at 100 Hz
with 64 stations, a log, markers and transforms, steers it by cmd_vel at 50 Hz, and subscribes to
every topic that it publishes. Times are the node's own, from its diagnostics; processor and memory
are those of its process.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
os.environ.setdefault("ROS_DOMAIN_ID", str(1 + os.getpid() % 100))

import rclpy
from cablemodel_ros import interface, messages
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TwistStamped

import cablemodel as cm

ROOT = Path(__file__).parents[1]
SCENE = ROOT / "scenes/turn.yaml"
EVERY_STEP = "every step"


class Measured:
    """The node in its process, and what is seen of it."""

    def __init__(self, folder: Path, **parameters: Any) -> None:
        command = [sys.executable, "-m", "cablemodel_ros.node", "--ros-args"]
        parameters = {
            "scene": SCENE, "autostart": "true", "rate": 100.0, "stations": 64, "tf": "true",
            "tf_vessel": "true", "log.folder": folder, "log.max_size": 20.0, "log.max_files": 2,
            **parameters,
        }  # fmt: skip
        for name, value in parameters.items():
            command += ["-p", f"{name}:={value}"]
        self.process = subprocess.Popen(command)
        self.node = rclpy.create_node("measure")
        self.values: dict[str, str] = {}
        self.counts: dict[str, int] = {}
        """Messages of each topic of every step."""
        self.node.create_subscription(DiagnosticArray, "/diagnostics", self._diagnostics, 10)
        for topic in (*interface.topics_of(cm.load_scene(SCENE)), *interface.OTHERS):
            self._subscribe(topic)
        self._twist = self.node.create_publisher(TwistStamped, "cmd_vel", 1)
        self._begin = time.monotonic()

    def steer(self) -> None:
        """Turns to port and to starboard, as in the scene."""
        angle = 1.5 * math.sin(0.05 * (time.monotonic() - self._begin))
        message = TwistStamped()
        message.header.stamp = self.node.get_clock().now().to_msg()
        message.twist.linear.x, message.twist.linear.y = (
            0.8 * math.cos(angle),
            0.8 * math.sin(angle),
        )
        self._twist.publish(message)

    def _diagnostics(self, message: DiagnosticArray) -> None:
        for status in message.status:
            if status.name == "cable: simulation":
                self.values = {item.key: item.value for item in status.values}

    def _subscribe(self, topic: interface.Topic) -> None:
        kind, quality = messages.message_class(topic.message), messages.qos(topic.quality)
        if topic.name in ("/diagnostics", "/clock") or kind is None:
            return
        if topic.rate == EVERY_STEP:
            self.counts[topic.name] = 0

        def call(data: bytes) -> None:
            if topic.name in self.counts:
                self.counts[topic.name] += 1

        name = topic.name.replace("~", "/cable")
        self.node.create_subscription(kind, name, call, quality, raw=True)

    @property
    def count(self) -> int:
        """Messages of that topic of every step of which the fewest came."""
        return min(self.counts.values())

    def spin(self, seconds: float) -> None:
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            rclpy.spin_once(self.node, timeout_sec=0.1)

    def processor(self) -> float:
        """Processor time of the node so far [s]."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")

    def memory(self) -> float:
        """Resident memory of the node [MB]."""
        for line in Path(f"/proc/{self.process.pid}/status").read_text().splitlines():
            if line.startswith("VmRSS"):
                return int(line.split()[1]) / 1024
        raise RuntimeError("no VmRSS")

    def wait(self, patience: float = 300.0) -> None:
        end = time.monotonic() + patience
        while not self.count:
            self.spin(0.5)
            if time.monotonic() > end or self.process.poll() is not None:
                raise TimeoutError("the node does not publish")

    def close(self) -> None:
        self.process.terminate()
        self.process.wait(30)
        self.node.destroy_node()


def real_time(minutes: float) -> dict[str, Any]:
    """Processor, cycle times and memory in real time."""
    with tempfile.TemporaryDirectory() as folder:
        node = Measured(Path(folder), vessel_input="cmd_vel")
        try:
            node.wait()
            node.node.create_timer(0.02, node.steer)
            node.spin(5.0)
            begin, used, count = time.monotonic(), node.processor(), node.count
            node.spin(60.0 * minutes)
            span = time.monotonic() - begin
            keys = [key for key in node.values if key.startswith(("step time", "cycle time"))]
            return {
                "minutes": minutes,
                "processor [% of one core]": round(100 * (node.processor() - used) / span, 2),
                "topics of every step": len(node.counts),
                "received of each, at least [Hz]": round((node.count - count) / span, 2),
                "memory [MB]": round(node.memory(), 1),
                "load average": os.getloadavg()[0],
                **{key: node.values[key] for key in ("cycles", "deadlines missed",
                   "time slipped [s]", "publications left out", *keys)},
            }  # fmt: skip
        finally:
            node.close()


def accelerated(hours: float) -> dict[str, Any]:
    """Memory over hours of simulated time, as fast as possible."""
    with tempfile.TemporaryDirectory() as folder:
        node = Measured(Path(folder), vessel_input="scene", real_time_factor=0.0,
                        **{"log.max_size": 3.0})  # fmt: skip
        samples = []
        begin = time.monotonic()
        try:
            node.wait()
            while True:
                node.spin(2.0)
                simulated = float(node.values.get("simulated time [s]", 0.0))
                samples.append((simulated, node.memory()))
                if simulated >= 3600.0 * hours:
                    break
            tenth = [m for t, m in samples if t >= 360.0 * hours]
            return {
                "hours": hours,
                "took [s]": round(time.monotonic() - begin, 1),
                "steps": node.values["cycles"],
                "memory after a tenth [MB]": round(tenth[0], 1),
                "memory at the half [MB]": round(tenth[len(tenth) // 2], 1),
                "memory at the end [MB]": round(tenth[-1], 1),
                "log files left": len(list(Path(folder).glob("cable_*.mcap"))),
            }
        finally:
            node.close()


def main() -> int:
    """Measure and print; 1 where a bound is not kept."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--hours", type=float, default=1.0)
    arguments = parser.parse_args()
    rclpy.init()
    live = real_time(arguments.minutes)
    print(json.dumps(live, indent=2), flush=True)
    long = accelerated(arguments.hours)
    print(json.dumps(long, indent=2), flush=True)
    rclpy.shutdown()
    kept = [
        live["processor [% of one core]"] <= 10.0,
        float(live["cycle time 99.9 % [ms]"]) < 5.0,
        long["memory at the end [MB]"] - long["memory after a tenth [MB]"] < 5.0,
    ]
    print("kept:", kept)
    return 0 if all(kept) else 1


if __name__ == "__main__":
    sys.exit(main())
