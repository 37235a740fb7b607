"""What comes in by topics: numbers and texts read off the bytes of a message (CDR).

rclpy builds a message object by object, in Python and with checks, which costs more than all else
that is done with a command.
"""

from __future__ import annotations

import struct
from collections.abc import Callable
from typing import Any

from cablemodel_ros.times import Stamp

Numbers = tuple[float, ...]

UNREADABLE = (struct.error, IndexError)
"""What a message raises that ends before its members do."""

_HEAD = 4
"""Bytes that say which CDR it is; members are aligned from behind them."""
_COVARIANCE = 36


class Reader:
    """Takes the members of a message one after another.

    Args:
        data: of a whole message, in either order of bytes.
    """

    def __init__(self, data: bytes) -> None:
        self._data, self._at = data, _HEAD
        self._order = "<" if data[1] == 1 else ">"

    def _take(self, kinds: str, size: int, count: int) -> tuple[Any, ...]:
        """So many members of a size that they are aligned to [bytes]."""
        self._at += (_HEAD - self._at) % size
        found = struct.unpack_from(self._order + kinds, self._data, self._at)
        self._at += size * count
        return found

    def stamp(self) -> Stamp:
        """A time."""
        seconds, nanoseconds = self._take("iI", 4, 2)
        return Stamp(1_000_000_000 * seconds + nanoseconds)

    def text(self) -> str:
        """A text."""
        (size,) = self._take("I", 4, 1)  # with the zero that ends it
        begin, self._at = self._at, self._at + size
        return self._data[begin : self._at - 1].decode(errors="replace")

    def numbers(self, count: int) -> Numbers:
        """64-bit floats."""
        return self._take(f"{count}d", 8, count)

    def header(self) -> tuple[Stamp | None, str]:
        """Stamp, None where it is zero, which is how a message is not stamped; and frame."""
        stamp = self.stamp()
        return stamp if stamp.ns else None, self.text()


def _six(data: bytes) -> tuple[Numbers, Numbers]:
    values = Reader(data).numbers(6)
    return values[:3], values[3:]


def _six_stamped(data: bytes) -> tuple[Any, ...]:
    reader = Reader(data)
    stamp, frame = reader.header()
    values = reader.numbers(6)
    return stamp, frame, values[:3], values[3:]


def _odometry(data: bytes) -> tuple[Any, ...]:
    reader = Reader(data)
    stamp, frame = reader.header()
    child_frame = reader.text()
    values = reader.numbers(7 + _COVARIANCE + 6)
    twist = values[7 + _COVARIANCE :]
    return stamp, frame, child_frame, values[:3], values[3:7], twist[:3], twist[3:]


ARGUMENTS: dict[str, Callable[[bytes], tuple[Any, ...]]] = {
    "nav_msgs/msg/Odometry": _odometry,
    "geometry_msgs/msg/TwistStamped": _six_stamped,
    "geometry_msgs/msg/Twist": _six,
    "geometry_msgs/msg/WrenchStamped": _six_stamped,
    "std_msgs/msg/Float64": lambda data: Reader(data).numbers(1),
    "rosgraph_msgs/msg/Clock": lambda data: (Reader(data).stamp(),),
}
"""What a port's ``take`` gets of a message, by its type."""
