"""What a launch file of ROS 2 needs of `launch`, where that is not installed.

The wheels have no `launch`. This runs a launch file as far as its nodes are concerned: arguments,
conditions, and the command line that `launch_ros` makes of a node.
"""

from __future__ import annotations

from typing import Any


class LaunchDescription:
    def __init__(self, entities: list[Any]) -> None:
        self.entities = entities


def value(thing: Any, given: dict[str, str]) -> Any:
    """What a substitution stands for."""
    return thing.of(given) if hasattr(thing, "of") else thing
