"""What comes in by topics: subscriptions that hand messages to a session's ports."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cablemodel_ros import interface, messages
from cablemodel_ros.control import ForeignClock
from cablemodel_ros.rig import Port
from cablemodel_ros.session import Session


class Inputs:
    """Subscribes to the topics of a session's ports.

    Args:
        node: the node that subscribes.
        session: what takes the commands.
        foreign: clock to follow, or None.
    """

    def __init__(self, node: Any, session: Session, foreign: ForeignClock | None) -> None:
        self._node = node
        self._made: list[Any] = []
        for port in session.rig.ports:
            self._subscribe(port.topic, self._taking(port))
        if foreign is not None:
            self._subscribe(
                interface.FOREIGN_CLOCK,
                lambda message: foreign.set(messages.stamp_of(message.clock)),
            )

    def destroy(self) -> None:
        """No message comes any more."""
        for subscription in self._made:
            self._node.destroy_subscription(subscription)
        self._made.clear()

    def _subscribe(self, topic: interface.Topic, call: Callable[[Any], None]) -> None:
        kind, quality = messages.message_class(topic.message), messages.qos(topic.quality)
        self._made.append(self._node.create_subscription(kind, topic.name, call, quality))

    def _taking(self, port: Port) -> Callable[[Any], None]:
        arguments, take = messages.ARGUMENTS[port.topic.message], port.take

        def call(message: Any) -> None:
            refusal = take(*arguments(message))
            if refusal:
                self._node.get_logger().warning(refusal, throttle_duration_sec=1.0)

        return call
