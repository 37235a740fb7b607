"""Who commands a vessel, and what the node says of it."""

from __future__ import annotations

import math
from collections.abc import Callable

from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TwistStamped
from nav_msgs.msg import Odometry
from rclpy.duration import Duration
from std_msgs.msg import Float64

from .conftest import Talker


class Helmsman:
    """Commands the vessel and the winch, until told otherwise."""

    def __init__(self, talker: Talker, frame: str = "map") -> None:
        self.talker, self.frame = talker, frame
        self.velocity = [0.0, 0.0, 0.0]
        self.turn_rate = 0.0
        self.rate: float | None = None
        self.clock = 0.0
        """What its clock is ahead of this machine's [s]."""
        self.stamped = True
        self._twist = talker.node.create_publisher(TwistStamped, "cmd_vel", 1)
        self._winch = talker.node.create_publisher(Float64, "/cable/payout_rate_cmd", 1)
        self._end: Callable[[], None] | None = None
        self.start()

    def start(self) -> None:
        self._end = self.talker.repeat(50.0, self.send)

    def stop(self) -> None:
        assert self._end is not None
        self._end()

    def send(self) -> None:
        message = TwistStamped()
        now = self.talker.node.get_clock().now() + Duration(seconds=self.clock)
        if self.stamped:
            message.header.stamp = now.to_msg()
        message.header.frame_id = self.frame
        linear = message.twist.linear
        linear.x, linear.y, linear.z = self.velocity
        message.twist.angular.z = self.turn_rate
        self._twist.publish(message)
        if self.rate is not None:
            self._winch.publish(Float64(data=self.rate))


class Watch:
    """The newest of what the node says."""

    def __init__(self, talker: Talker) -> None:
        self.tension = talker.listen("/cable/tension_top", Float64)
        self.applied = talker.listen("/cable/applied_cmd_vel", TwistStamped)
        self.motion = talker.listen("/cable/applied_odom", Odometry)
        self.length = talker.listen("/cable/line_length", Float64)
        self.rate = talker.listen("/cable/payout_rate", Float64)
        self.diagnostics = talker.listen("/diagnostics", DiagnosticArray)

    @property
    def velocity(self) -> list[float]:
        if not self.applied:
            return [math.nan] * 3
        linear = self.applied[-1].twist.linear
        return [linear.x, linear.y, linear.z]

    def said(self, name: str, words: str) -> bool:
        return any(
            words in status.message
            for array in self.diagnostics
            for status in array.status
            if status.name == f"cable: {name}"
        )

    def known(self, name: str, key: str) -> list[str]:
        """All values of it so far, the newest last."""
        return [
            str(item.value)
            for array in self.diagnostics
            for status in array.status
            if status.name == f"cable: {name}"
            for item in status.values
            if item.key == key
        ]

    def value(self, name: str, key: str) -> str:
        return self.known(name, key)[-1]
