"""The node in a process of its own, and a ROS 2 node of the test that talks to it.

Everything stays on loopback, in a domain of this test session's own. Where rclpy is not installed
these tests are not collected; `make test` runs them in the environment that has it.
"""

from __future__ import annotations

import importlib.util
import os
import subprocess
import sys
import threading
import time
from collections import defaultdict
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

if importlib.util.find_spec("rclpy") is None:
    collect_ignore_glob = ["test_*.py"]

ROOT = Path(__file__).parents[3]
SCENE = ROOT / "ros2_node/scenes/waypoint_tow.yaml"
STARTS_IN = 300.0
"""Kernels may have to be compiled first [s]."""
ANSWERS_IN = 20.0

os.environ["ROS_AUTOMATIC_DISCOVERY_RANGE"] = "LOCALHOST"
os.environ["ROS_DOMAIN_ID"] = str(1 + os.getpid() % 100)


class NodeProcess:
    """The node `cable`, started and stopped by its process id."""

    def __init__(
        self, folder: Path, program: str = "", remap: tuple[str, ...] = (), **parameters: Any
    ) -> None:
        self.output = folder / "node.txt"
        arguments = [word for rule in remap for word in ("-r", rule)]
        for name, value in parameters.items():
            text = str(value).lower() if isinstance(value, bool) else str(value)
            arguments += ["-p", f"{name.replace('__', '.')}:={text}"]
        run = ["-c", program] if program else ["-m", "cablemodel_ros.node"]
        self._file = self.output.open("w")
        self.process = subprocess.Popen(
            [sys.executable, *run, "--ros-args", *arguments],
            stdout=self._file,
            stderr=subprocess.STDOUT,
            env={**os.environ, "ROS_LOG_DIR": str(folder / "ros_log")},
        )

    @property
    def text(self) -> str:
        return self.output.read_text(encoding="utf-8", errors="replace")

    def stop(self, patience: float = 20.0) -> int:
        """Interrupt, wait, and in the end kill; gives the exit status."""
        if self.process.poll() is None:
            self.process.terminate()
            try:
                self.process.wait(patience)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        self._file.close()
        return self.process.returncode


class Talker:
    """A ROS 2 node of the test's own, spun by a thread: keeps all messages by topic."""

    def __init__(self) -> None:
        import rclpy
        from rclpy.executors import SingleThreadedExecutor

        self.context = rclpy.Context()
        rclpy.init(context=self.context)
        self.node = rclpy.create_node("talker", context=self.context)
        self.received: dict[str, list[Any]] = defaultdict(list)
        self._executor = SingleThreadedExecutor(context=self.context)
        self._executor.add_node(self.node)
        self._stop = threading.Event()
        self._clients: dict[str, Any] = {}
        self._thread = threading.Thread(target=self._spin, daemon=True)
        self._thread.start()

    def _spin(self) -> None:
        while not self._stop.is_set():
            self._executor.spin_once(timeout_sec=0.05)

    def close(self) -> None:
        import rclpy

        self._stop.set()
        self._thread.join()
        self.node.destroy_node()
        rclpy.shutdown(context=self.context)

    def listen(self, topic: str, kind: Any, latched: bool = False) -> list[Any]:
        from rclpy.qos import DurabilityPolicy, QoSProfile

        durability = DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE
        quality = QoSProfile(depth=100, durability=durability)
        self.node.create_subscription(kind, topic, self.received[topic].append, quality)
        return self.received[topic]

    def call(self, name: str, kind: Any, request: Any = None, patience: float = ANSWERS_IN) -> Any:
        if name not in self._clients:
            self._clients[name] = self.node.create_client(kind, name)
            assert self._clients[name].wait_for_service(patience), f"{name} is not there"
            # A service can be seen before its answers find the way back: they would be lost.
            time.sleep(0.7)
        client = self._clients[name]
        assert client.wait_for_service(patience), f"{name} is not there"
        answer = client.call_async(request or kind.Request())
        wait_until(answer.done, patience)
        return answer.result()

    def transition(self, label: str, patience: float = STARTS_IN) -> bool:
        from lifecycle_msgs.msg import Transition
        from lifecycle_msgs.srv import ChangeState

        number = getattr(Transition, f"TRANSITION_{label.upper()}")
        request = ChangeState.Request(transition=Transition(id=number))
        return bool(self.call("/cable/change_state", ChangeState, request, patience).success)

    @property
    def state(self) -> str:
        from lifecycle_msgs.srv import GetState

        for patience in (3.0, 6.0, ANSWERS_IN):  # asking again changes nothing
            try:
                return str(
                    self.call("/cable/get_state", GetState, None, patience).current_state.label
                )
            except AssertionError:
                if patience == ANSWERS_IN:
                    raise
        raise AssertionError("no state")

    def trigger(self, name: str) -> Any:
        from std_srvs.srv import Trigger

        return self.call(f"/cable/{name}", Trigger)

    def set_parameter(self, name: str, value: Any) -> Any:
        from rcl_interfaces.srv import SetParameters
        from rclpy.parameter import Parameter

        message = Parameter(name, value=value).to_parameter_msg()
        request = SetParameters.Request(parameters=[message])
        return self.call("/cable/set_parameters", SetParameters, request).results[0]

    def repeat(self, rate: float, call: Callable[[], None]) -> Callable[[], None]:
        """Call something at a rate [Hz]; gives what ends it."""
        timer = self.node.create_timer(1.0 / rate, call)
        return lambda: self.node.destroy_timer(timer)


def wait_until(condition: Callable[[], Any], patience: float = ANSWERS_IN) -> None:
    end = time.monotonic() + patience
    while not condition():
        assert time.monotonic() < end, "waited in vain"
        time.sleep(0.01)


@pytest.fixture
def talker() -> Iterator[Talker]:
    made = Talker()
    yield made
    made.close()


@pytest.fixture
def start_node(tmp_path: Path) -> Iterator[Callable[..., NodeProcess]]:
    started: list[NodeProcess] = []

    def start(**parameters: Any) -> NodeProcess:
        parameters = {"scene": SCENE, **parameters}
        node = NodeProcess(tmp_path, **parameters)
        started.append(node)
        return node

    yield start
    for node in started:
        node.stop()
