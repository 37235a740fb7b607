"""A controller that steers a vessel along way-points and keeps the tow line's tension down.

It is an ordinary ROS 2 node: it reads the cable's topics as it would read the tow-line load cell
and the vessel's position, and commands the vessel's velocity and the winch. The law itself is a
plain class.

    python waypoint_controller.py --ros-args -p use_sim_time:=true
"""

from __future__ import annotations

import math
import sys
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Leg:
    """A way-point, and how fast to go there."""

    x: float
    y: float
    speed: float


COURSE = (Leg(60, 0, 0.8), Leg(120, 0, 1.4), Leg(120, 60, 0.8), Leg(60, 60, 0.8))
"""Out, a sprint, a turn to port, and back. Positions [m], speeds [m/s]."""


@dataclass
class WaypointController:
    """Velocity towards the next way-point, and a PD law for the winch.

    The law acts on the tension behind a low-pass filter. A stiff cable answers the winch by axial
    waves, 680 N for 1 m/s here, and rings at 5 Hz; a law that is quick at that frequency drives
    the ringing instead of damping it (derivative / smoothing must stay below 1 / 680).

    Above `start` of the limit the winch pays out, below `slack` of it it reels in again, down to
    `length` [m].
    """

    course: tuple[Leg, ...] = COURSE
    limit: float = 300.0
    """Tension that must not be exceeded [N]."""
    length: float = 50.0
    """Cable that should be out [m]."""
    start: float = 0.65
    slack: float = 0.6
    proportional: float = 0.007
    """[m/s per N]"""
    derivative: float = 0.0002
    """[m/s per N/s]"""
    rate_limit: float = 1.0
    """[m/s]"""
    smoothing: float = 0.4
    """Time constant of the filter [s]."""
    reached: int = 0
    """Way-points behind us."""
    _time: float | None = None
    _tension: float = 0.0

    @property
    def done(self) -> bool:
        """Whether the last way-point is reached."""
        return self.reached >= len(self.course)

    def velocity(self, x: float, y: float) -> tuple[float, float]:
        """Velocity command [m/s] at a position [m]."""
        while not self.done:
            leg = self.course[self.reached]
            dx, dy = leg.x - x, leg.y - y
            distance = math.hypot(dx, dy)
            if distance > 1.0:
                speed = min(leg.speed, 0.5 * distance)
                return speed * dx / distance, speed * dy / distance
            self.reached += 1
        return 0.0, 0.0

    def payout_rate(self, time: float, tension: float, line_length: float) -> float:
        """Winch command [m/s] at a time [s], with a tension [N] and a length that is out [m]."""
        if self._time is None:
            self._time, self._tension = time, tension
        dt, self._time = max(time - self._time, 0.0), time
        change = (1.0 - math.exp(-dt / self.smoothing)) * (tension - self._tension)
        self._tension += change
        excess = self._tension - self.start * self.limit
        if excess > 0.0:
            rise = change / dt if dt > 0.0 else 0.0
            rate = self.proportional * excess + self.derivative * rise
            return min(max(rate, 0.0), self.rate_limit)
        room = self.slack * self.limit - self._tension
        if room > 0.0 and line_length > self.length:
            return -min(0.003 * room, 0.2, 0.2 * (line_length - self.length))
        return 0.0


def main() -> int:
    """Run the controller as a node until the course is done."""
    import rclpy
    from geometry_msgs.msg import TwistStamped
    from nav_msgs.msg import Odometry
    from rclpy.executors import ExternalShutdownException
    from std_msgs.msg import Float64

    rclpy.init()
    node = rclpy.create_node("waypoint_controller")
    controller = WaypointController(limit=node.declare_parameter("limit", 300.0).value)
    line_length = [controller.length]
    velocity = node.create_publisher(TwistStamped, "cmd_vel", 1)
    winch = node.create_publisher(Float64, "/cable/payout_rate_cmd", 1)

    def on_tension(message: Any) -> None:
        time = 1e-9 * node.get_clock().now().nanoseconds
        rate = controller.payout_rate(time, message.data, line_length[0])
        winch.publish(Float64(data=rate))

    def on_motion(message: Any) -> None:
        place = message.pose.pose.position
        command = TwistStamped()
        command.header.stamp = message.header.stamp
        command.header.frame_id = "map"
        command.twist.linear.x, command.twist.linear.y = controller.velocity(place.x, place.y)
        velocity.publish(command)

    node.create_subscription(Float64, "/cable/tension_top", on_tension, 1)
    node.create_subscription(Odometry, "/cable/applied_odom", on_motion, 1)
    node.create_subscription(
        Float64, "/cable/line_length", lambda message: line_length.append(message.data), 1
    )
    try:
        while rclpy.ok() and not controller.done:
            rclpy.spin_once(node, timeout_sec=1.0)
            del line_length[:-1]
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    finally:
        node.destroy_node()
        rclpy.try_shutdown()
    return 0


if __name__ == "__main__":
    sys.exit(main())
