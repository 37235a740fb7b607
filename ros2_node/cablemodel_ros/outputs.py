"""What goes out by topics: lifecycle publishers, and who listens to them.

A message that nobody reads costs as much as one that is read. Only topics with subscribers are
made and published; who subscribes is seen within a tenth of a second.
"""

from __future__ import annotations

import time
from typing import Any

from rclpy.event_handler import PublisherEventCallbacks

from cablemodel_ros import interface, messages
from cablemodel_ros.session import Cycle, Session
from cablemodel_ros.transforms import Transforms

_LOOK_EVERY = 0.1
"""[s]"""
_NO_EVENTS = PublisherEventCallbacks(use_default_callbacks=False)
"""Every event of a publisher is looked at whenever the executor waits, which would cost more than
all else it does; a subscriber whose QoS does not fit is told by its own side."""
_ALWAYS = "/clock"
"""Whoever waits for it stands still."""


class Outputs:
    """Publishers of a session's topics.

    Args:
        node: the lifecycle node that publishes.
        session: what there is to publish.
    """

    def __init__(self, node: Any, session: Session) -> None:
        self._node = node
        self.publishers: dict[str, Any] = {}
        self._handles: dict[str, Any] = {}
        self._transforms = Transforms()
        self._listened: frozenset[str] = frozenset()
        self._looked = 0.0
        settings = session.settings
        wanted = {
            "/diagnostics": False,  # also while there is no session
            "/clock": settings.publishes_clock,
            "/tf": settings.tf or settings.tf_vessel,
            "~/markers": settings.markers_rate > 0.0,
        }
        for topic in (*interface.topics_of(session.scene), *interface.OTHERS):
            if not wanted.get(topic.name, True):
                continue
            kind = messages.message_class(topic.message)
            if kind is None:
                node.get_logger().warning(f"{topic.name} is left out: no {topic.message} here")
                continue
            quality = messages.qos(topic.quality)
            publisher = node.create_lifecycle_publisher(
                kind, topic.name, quality, event_callbacks=_NO_EVENTS
            )
            self.publishers[topic.name] = publisher
            # What rclpy's publishers ask before, each time, holds for as long as the control thread
            # runs: they are active, and not destroyed.
            self._handles[topic.name] = publisher.handle

    def destroy(self) -> None:
        """No message goes out any more."""
        for publisher in self.publishers.values():
            self._node.destroy_lifecycle_publisher(publisher)
        self.publishers.clear()
        self._handles.clear()

    def listened(self) -> frozenset[str]:
        """Topics that somebody reads."""
        now = time.monotonic()
        if now - self._looked >= _LOOK_EVERY:
            self._looked = now
            self._listened = frozenset(
                name
                for name, handle in self._handles.items()
                if name == _ALWAYS or handle.get_subscription_count()
            )
        return self._listened

    def publish(self, cycle: Cycle) -> None:
        """What a step gave; called by the control thread."""
        listened, handles = self._listened, self._handles
        if _ALWAYS in listened:
            self.publishers[_ALWAYS].publish(messages.clock(cycle.stamp))
        for topic, data in (*cycle.applied, *cycle.outputs):
            if topic in listened:
                handles[topic].publish_raw(data)
        if "/tf" in listened and not cycle.shed:
            handles["/tf"].publish_raw(self._transforms.message(cycle.stamp, cycle.frames))
