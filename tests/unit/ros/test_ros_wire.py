"""Members of messages are read off their bytes as rosbags wrote them."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from cablemodel_ros import interface, wire
from cablemodel_ros.times import Stamp

from cablemodel.results.log.messages import typestore

LINEAR, ANGULAR = (1.5, -2.0, 1e-300), (0.25, 3.0, -0.0)
PLACE, TURN = (10.0, 20.0, -30.0), (0.1, 0.2, 0.3, 0.9)


def new(name: str, *values: Any) -> Any:
    return typestore().types[name](*values)


def header(seconds: int, nanoseconds: int, frame: str) -> Any:
    time = new("builtin_interfaces/msg/Time", seconds, nanoseconds)
    return new("std_msgs/msg/Header", time, frame)


def vectors(name: str) -> Any:
    """Two vectors, as Twist and Wrench have them."""
    return new(name, *(new("geometry_msgs/msg/Vector3", *three) for three in (LINEAR, ANGULAR)))


def pose() -> Any:
    point = new("geometry_msgs/msg/Point", *PLACE)
    return new("geometry_msgs/msg/Pose", point, new("geometry_msgs/msg/Quaternion", *TURN))


def message(
    name: str, stamp: tuple[int, int], frame: str, child: str
) -> tuple[Any, tuple[Any, ...]]:
    """A message, and what is to be read off it."""
    time = Stamp(1_000_000_000 * stamp[0] + stamp[1])
    given = time if time.ns else None
    if name == "std_msgs/msg/Float64":
        return new(name, LINEAR[0]), (LINEAR[0],)
    if name == "rosgraph_msgs/msg/Clock":
        return new(name, new("builtin_interfaces/msg/Time", *stamp)), (time,)
    if name == "geometry_msgs/msg/Twist":
        return vectors(name), (LINEAR, ANGULAR)
    head = header(*stamp, frame)
    if name in ("geometry_msgs/msg/TwistStamped", "geometry_msgs/msg/WrenchStamped"):
        return new(name, head, vectors(name.removesuffix("Stamped"))), (
            given,
            frame,
            LINEAR,
            ANGULAR,
        )
    assert name == "nav_msgs/msg/Odometry"
    spread = np.arange(36.0)
    twist = vectors("geometry_msgs/msg/Twist")
    made = new(
        name,
        head,
        child,
        new("geometry_msgs/msg/PoseWithCovariance", pose(), spread),
        new("geometry_msgs/msg/TwistWithCovariance", twist, -spread),
    )
    return made, (given, frame, child, PLACE, TURN, LINEAR, ANGULAR)


def test_every_input_can_be_read() -> None:
    topics = (*interface.INPUTS, *interface.PART_INPUTS, interface.unstamped(interface.CMD_VEL))
    assert {topic.message for topic in topics} == set(wire.ARGUMENTS)


@pytest.mark.parametrize("little", [True, False])
@pytest.mark.parametrize("name", wire.ARGUMENTS)
def test_members_are_those_that_were_written(name: str, little: bool) -> None:
    # Lengths of texts move what stands behind them; a stamp may lie before 1970.
    for stamp in ((0, 0), (1_700_000_000, 999_999_999), (-1, 5)):
        for frame in ("", "map", "base_link", "\u00f6dometrie"):
            for child in ("", "a", "base_link"):
                made, expected = message(name, stamp, frame, child)
                data = bytes(typestore().serialize_cdr(made, name, little_endian=little))
                found = wire.ARGUMENTS[name](data)
                assert repr(found) == repr(expected)  # the sign of a zero, too


@pytest.mark.parametrize("name", wire.ARGUMENTS)
def test_a_message_that_ends_too_early_is_told_from_others(name: str) -> None:
    made, _ = message(name, (1, 2), "map", "base_link")
    data = bytes(typestore().serialize_cdr(made, name))
    for size in range(len(data) if "Odometry" not in name else 400):
        with pytest.raises(wire.UNREADABLE):
            wire.ARGUMENTS[name](data[:size])
