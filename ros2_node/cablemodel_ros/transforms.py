"""Messages of /tf, as bytes: made once for the names of frames, then only numbers change."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import Any

from cablemodel.results.log.messages import FRAME, quaternion_of, typestore
from cablemodel_ros.rig import Frame
from cablemodel_ros.times import Stamp

_KIND = "tf2_msgs/msg/TFMessage"

_STAMP = struct.Struct("<iI")
_POSE = struct.Struct("<7d")
_FIRST = 8
"""Where the first transform begins: behind four bytes that say which CDR it is, and the count."""


class Transforms:
    """Makes the messages of one node (not thread-safe)."""

    def __init__(self) -> None:
        self._names: tuple[str, ...] = ()
        self._data = bytearray()
        self._places: list[tuple[int, int]] = []

    def message(self, stamp: Stamp, frames: Sequence[Frame]) -> bytes:
        """Frames in the map at a stamp."""
        names = tuple(frame.name for frame in frames)
        if names != self._names:
            self._names, self._data, self._places = names, _message(names), _places(names)
        time = divmod(stamp.ns, 1_000_000_000)
        for frame, (stamp_at, numbers_at) in zip(frames, self._places, strict=True):
            _STAMP.pack_into(self._data, stamp_at, *time)
            place, turn = frame.position.tolist(), quaternion_of(frame.axes)
            _POSE.pack_into(self._data, numbers_at, *place, *turn)
        return bytes(self._data)


def _message(names: Sequence[str]) -> bytearray:
    types: Any = typestore().types
    time = types["builtin_interfaces/msg/Time"](0, 0)
    place = types["geometry_msgs/msg/Vector3"](0.0, 0.0, 0.0)
    turn = types["geometry_msgs/msg/Quaternion"](0.0, 0.0, 0.0, 1.0)
    transform = types["geometry_msgs/msg/Transform"](place, turn)
    header = types["std_msgs/msg/Header"](time, FRAME)
    stamped = types["geometry_msgs/msg/TransformStamped"]
    message = types[_KIND]([stamped(header, name, transform) for name in names])
    return bytearray(typestore().serialize_cdr(message, _KIND))


def _places(names: Sequence[str]) -> list[tuple[int, int]]:
    """Where the stamp and the numbers of each transform begin; numbers are aligned from behind the
    first four bytes."""
    found, at = [], _FIRST
    for name in names:
        stamp_at = at
        at = _behind(name, _behind(FRAME, at + _STAMP.size))
        at += (4 - at) % 8
        found.append((stamp_at, at))
        at += _POSE.size
    return found


def _behind(text: str, at: int) -> int:
    """Where what follows a text may begin: its length, its bytes, and a zero."""
    at += 4 + len(text.encode()) + 1
    return at + -at % 4
