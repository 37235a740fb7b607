"""What comes in by topics: subscriptions that hand messages to a session."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import Odometry
from rosgraph_msgs.msg import Clock
from std_msgs.msg import Float64

from cablemodel_ros import interface, messages
from cablemodel_ros.control import ForeignClock
from cablemodel_ros.session import Session


class Inputs:
    """Subscribes to what the settings of a session ask for.

    Args:
        node: the node that subscribes.
        session: what takes the commands.
        foreign: clock to follow, or None.
    """

    def __init__(self, node: Any, session: Session, foreign: ForeignClock | None) -> None:
        self._node, self._commands = node, session.commands
        self._vessel_frame = session.settings.vessel_frame
        self._made: list[Any] = []
        settings = session.settings
        if settings.vessel_input == "odom":
            self._subscribe(interface.ODOM, Odometry, self._on_odometry)
        if settings.vessel_input == "cmd_vel":
            if settings.cmd_vel_stamped:
                self._subscribe(interface.CMD_VEL, TwistStamped, self._on_twist_stamped)
            else:
                self._subscribe(interface.CMD_VEL, Twist, self._on_twist)
        if settings.payout_input == "command":
            self._subscribe(interface.PAYOUT_RATE, Float64, self._on_payout_rate)
        if foreign is not None:
            self._subscribe(
                interface.FOREIGN_CLOCK,
                Clock,
                lambda message: foreign.set(messages.stamp_of(message.clock)),
            )

    def destroy(self) -> None:
        """No message comes any more."""
        for subscription in self._made:
            self._node.destroy_subscription(subscription)
        self._made.clear()

    def _subscribe(self, topic: interface.Topic, kind: Any, call: Callable[[Any], None]) -> None:
        quality = messages.qos(topic.quality)
        self._made.append(self._node.create_subscription(kind, topic.name, call, quality))

    def _tell(self, refusal: str) -> None:
        if refusal:
            self._node.get_logger().warning(refusal, throttle_duration_sec=1.0)

    def _on_odometry(self, message: Odometry) -> None:
        self._tell(self._commands.take_odometry(*messages.odometry_arguments(message)))

    def _on_twist_stamped(self, message: TwistStamped) -> None:
        vectors = messages.twist_vectors(message.twist)
        stamp = messages.given_stamp(message.header)
        self._tell(self._commands.take_twist(stamp, message.header.frame_id, *vectors))

    def _on_twist(self, message: Twist) -> None:
        vectors = messages.twist_vectors(message)
        self._tell(self._commands.take_twist(None, self._vessel_frame, *vectors))

    def _on_payout_rate(self, message: Float64) -> None:
        self._tell(self._commands.take_payout_rate(message.data))
