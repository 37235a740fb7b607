"""Who else is on the topics of a node: what the graph shows to be wrong, and no message tells."""

from __future__ import annotations

from typing import Any

from rclpy.qos import ReliabilityPolicy

from cablemodel_ros import interface
from cablemodel_ros.session import Session

_UNSTAMPED = "geometry_msgs/msg/Twist"
_UNKNOWN = "_NODE_NAME_UNKNOWN_"
"""What the middleware calls a node of which it has discovered a publisher only, so far."""


class Neighbours:
    """Looks at publishers in the graph. A message of another type, or of another name, never
    arrives, so that a command is awaited in vain; two that command one vessel, or set one clock,
    take turns; two nodes of one name command and publish the same cable.

    Args:
        node: whose topics they are.
        session: what takes the commands.
        follows: whether it follows a foreign /clock.
    """

    def __init__(self, node: Any, session: Session, *, follows: bool = False) -> None:
        self._node = node
        self._inputs = [port.topic for port in session.rig.ports]
        published = (*interface.topics_of(session.scene), *interface.OTHERS)
        known = (topic.name for topic in (*self._inputs, *published))
        self._known = {node.resolve_topic_name(name) for name in known}
        self._on_clock = follows or session.settings.publishes_clock
        self._said: set[str] = set()

    def findings(self) -> list[str]:
        """What is wrong now; each is told on the console, too, the first time."""
        found = [text for topic in self._inputs for text in self._misfits(topic)]
        found += self._astray()
        if self._on_clock and self._node.count_publishers(interface.FOREIGN_CLOCK.name) > 1:
            found.append("more than one node publishes /clock: time goes to and fro")
        own = interface.INPUTS_APPLIED.name
        if self._node.count_publishers(own) > 1:
            name = self._node.get_fully_qualified_name()
            found.append(f"another node publishes {own}, too: does {name} run twice?")
        for text in found:
            if text not in self._said:
                self._node.get_logger().warning(text)
        self._said |= set(found)
        return found

    def _misfits(self, topic: interface.Topic) -> list[str]:
        found: dict[str, None] = {}
        senders: set[str] = set()  # one that is restarted is seen twice for a while
        for publisher in self._node.get_publishers_info_by_topic(topic.name):
            if publisher.node_name == _UNKNOWN:
                continue  # it is told by its name
            name, kind = topic.name.removeprefix("~/"), publisher.topic_type
            best_effort = publisher.qos_profile.reliability == ReliabilityPolicy.BEST_EFFORT
            if kind != topic.message:
                way = " (or cmd_vel_stamped: false)" if kind == _UNSTAMPED else ""
                found[f"{name} comes as {kind} from {publisher.node_name}, which cannot be taken: "
                      f"{topic.message} is{way}"] = None  # fmt: skip
            elif best_effort and topic.quality.reliable:
                found[f"{name} comes with best effort from {publisher.node_name}, which cannot be "
                      "taken: reliable is"] = None  # fmt: skip
            else:
                senders.add(f"{publisher.node_namespace.rstrip('/')}/{publisher.node_name}")
        if len(senders) > 1:
            found[f"{topic.name.removeprefix('~/')} comes from {' and '.join(sorted(senders))}: "
                  "they take turns, the newest message counts"] = None  # fmt: skip
        return list(found)

    def _astray(self) -> list[str]:
        """What others publish below the node's own name, and nothing takes."""
        node = self._node
        own = node.get_fully_qualified_name() + "/"
        found = []
        for topic, _ in node.get_topic_names_and_types():
            if not topic.startswith(own) or topic in self._known:
                continue
            publishers = node.get_publishers_info_by_topic(topic)
            names = {publisher.node_name for publisher in publishers} - {node.get_name(), _UNKNOWN}
            if names:
                inputs = [known.name.removeprefix("~/") for known in self._inputs]
                name = topic.removeprefix(own)
                found.append(
                    f"{name} comes from {' and '.join(sorted(names))}, and nothing takes it: "
                    f"{', '.join(inputs) or 'the scene moves all'}"
                )
        return found
