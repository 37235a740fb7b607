"""ROS 2 messages of the log, in CDR.

Each message is serialised once by the ``rosbags`` library, with its strings and layout, and is
then a template: all messages of the log end in their numbers, so that a sample only replaces the
stamp near the front and the numbers at the back. Building and serialising message objects for
every sample would cost more than all else that a log does.
"""

from __future__ import annotations

import math
import struct
from collections.abc import Sequence
from functools import cache
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cablemodel import variables

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

Floats = NDArray[np.float64]

FRAME = "map"
TOW_POINT_FRAME = "tow_point"
"""Frame at the tow point, parallel to the map: the wrench on the vessel acts there."""
END_FRAME = "cable_end"
"""Frame at the far end, parallel to the map (the twist of an Odometry is in its child's frame)."""

CLOUD_FIELDS = ("x", "y", "z", "tension", "curvature", "s")

POSE_FLOATS = 7
ODOMETRY_FLOATS = 85
"""Of an Odometry: pose (7) and its covariance (36), twist (6) and its covariance (36)."""
ODOMETRY_TWIST = 43

_FLOAT32 = 7
"""sensor_msgs/PointField.FLOAT32"""
_STAMP = struct.Struct("<iI")
_STAMP_AT = 4
"""Behind the four bytes that say which CDR it is; a header is always the first member."""
_ONE = struct.Struct("<d")
_THREE = struct.Struct("<3d")
_POSE = struct.Struct("<7d")


@cache
def typestore() -> Typestore:
    """Message definitions of ROS 2 Jazzy."""
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY)


def definition(message: str) -> str:
    """Text of a message type and of all that it contains (schema encoding ``ros2msg``)."""
    return typestore().generate_msgdef(message, ros_version=2)[0]


def type_hash(message: str) -> str:
    """Hash of a message type as ROS 2 computes it (REP-2016): ``RIHS01_...``."""
    return typestore().hash_rihs01(message)


def quaternion_onto(direction: Floats) -> tuple[float, float, float, float]:
    """Shortest rotation (x, y, z, w) that turns the x axis onto a unit vector (3,)."""
    x, y, z = (float(value) for value in direction)
    w = math.sqrt(max(0.0, 0.5 * (1.0 + x)))
    if w < 1e-9:  # opposite to the x axis: half a turn about z, as good as any other
        return 0.0, 0.0, 1.0, 0.0
    return 0.0, -0.5 * z / w, 0.5 * y / w, w


def quaternion_of(matrix: Floats) -> tuple[float, float, float, float]:
    """Quaternion (x, y, z, w), w not negative, of a rotation matrix (3, 3): turned axes are in its
    columns."""
    m = matrix
    # The largest of the four squares is divided by: nothing is lost near half a turn.
    squares = np.array(
        [
            1 + m[0, 0] - m[1, 1] - m[2, 2],
            1 - m[0, 0] + m[1, 1] - m[2, 2],
            1 - m[0, 0] - m[1, 1] + m[2, 2],
            1 + m[0, 0] + m[1, 1] + m[2, 2],
        ]
    )
    largest = int(np.argmax(squares))
    rows = (
        (squares[0], m[0, 1] + m[1, 0], m[0, 2] + m[2, 0], m[2, 1] - m[1, 2]),
        (m[0, 1] + m[1, 0], squares[1], m[1, 2] + m[2, 1], m[0, 2] - m[2, 0]),
        (m[0, 2] + m[2, 0], m[1, 2] + m[2, 1], squares[2], m[1, 0] - m[0, 1]),
        (m[2, 1] - m[1, 2], m[0, 2] - m[2, 0], m[1, 0] - m[0, 1], squares[3]),
    )
    q = np.array(rows[largest]) / (2.0 * math.sqrt(squares[largest]))
    x, y, z, w = (q if q[3] >= 0.0 else -q).tolist()
    return x, y, z, w


def direction_of(quaternions: Floats) -> Floats:
    """Where quaternions (..., 4) in the order x, y, z, w turn the x axis to, (..., 3)."""
    x, y, z, w = np.moveaxis(quaternions, -1, 0)
    return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)], axis=-1)


def through_quaternion(direction: Floats) -> Floats:
    """A unit vector (3,) as it comes back from a log, with the round-off of its quaternion."""
    return direction_of(np.array(quaternion_onto(direction)))


class Messages:
    """Makes the messages of one log (not thread-safe). Every method returns CDR bytes; ``stamp``
    is in nanoseconds since 1970, vectors are in the map's axes.

    Args:
        tow_point_frame: name of the frame at the tow point.
    """

    def __init__(self, tow_point_frame: str = TOW_POINT_FRAME) -> None:
        build = _Prototypes()
        self._float64 = build.float64()
        self._wrench = build.wrench(FRAME)
        self._top_wrench = build.wrench(tow_point_frame)
        self._odometry = build.odometry()
        self._point = build.point()
        # These depend on how many bodies or nodes there are, or on what parts a system has.
        self._build = build
        self._parts: dict[tuple[str, str], bytearray] = {}
        self._rows: dict[tuple[str, ...], bytearray] = {}
        self._poses: tuple[int, bytearray] = (-1, bytearray())
        self._cloud: tuple[int, bytearray, NDArray[np.float32]] | None = None
        self._states: dict[str, tuple[int, bytearray, Floats]] = {}

    def float64(self, value: float) -> bytes:
        _ONE.pack_into(self._float64, len(self._float64) - 8, value)
        return bytes(self._float64)

    def wrench(self, stamp: int, force: Floats, torque: Floats | None = None) -> bytes:
        """Force (3,) [N] and moment (3,) [N m]."""
        return _wrench(self._wrench, stamp, force, torque)

    def top_wrench(self, stamp: int, force: Floats, torque: Floats) -> bytes:
        """Force (3,) [N] and moment (3,) [N m] of the cable on the vessel, at the tow point."""
        return _wrench(self._top_wrench, stamp, force, torque)

    def odometry(self, stamp: int, position: Floats, velocity: Floats) -> bytes:
        """Position (3,) [m] and velocity (3,) [m/s] of the far end; its frame does not turn."""
        at = _stamped(self._odometry, stamp) - 8 * ODOMETRY_FLOATS
        _THREE.pack_into(self._odometry, at, *position.tolist())
        _THREE.pack_into(self._odometry, at + 8 * ODOMETRY_TWIST, *velocity.tolist())
        return bytes(self._odometry)

    def part_odometry(self, stamp: int, name: str, motion: Any) -> bytes:
        """A part of a system (see `systems.Motion`): its pose in the map, its twist in its own
        axes."""
        key = variables.ODOMETRY, name
        if key not in self._parts:
            self._parts[key] = self._build.odometry(name)
        data = self._parts[key]
        at = _stamped(data, stamp) - 8 * ODOMETRY_FLOATS
        _POSE.pack_into(data, at, *motion.position, *quaternion_of(motion.axes))
        at += 8 * ODOMETRY_TWIST
        _THREE.pack_into(data, at, *(motion.velocity @ motion.axes))
        _THREE.pack_into(data, at + 24, *(motion.angular_velocity @ motion.axes))
        return bytes(data)

    def part_wrench(self, stamp: int, name: str, axes: Floats, wrench: Floats) -> bytes:
        """Force and moment (6,) [N, N m], earth frame, in the axes (3, 3) of the part that they
        act on."""
        key = variables.WRENCH, name
        if key not in self._parts:
            self._parts[key] = self._build.wrench(name)
        return _wrench(self._parts[key], stamp, wrench[:3] @ axes, wrench[3:] @ axes)

    def row(self, labels: tuple[str, ...], values: Floats) -> bytes:
        """Values with a name for each."""
        if labels not in self._rows:
            self._rows[labels] = self._build.labelled(labels)
        data = self._rows[labels]
        data[len(data) - 8 * len(labels) :] = values.astype("<f8", copy=False).tobytes()
        return bytes(data)

    def point(self, stamp: int, position: Floats) -> bytes:
        """A point (3,) [m]."""
        _THREE.pack_into(self._point, _stamped(self._point, stamp) - 24, *position)
        return bytes(self._point)

    def poses(self, stamp: int, positions: Sequence[Floats], directions: Sequence[Floats]) -> bytes:
        """Bodies: position (3,) [m] and direction (3,) each; a pose turns x onto the direction."""
        count = len(positions)
        if self._poses[0] != count:
            self._poses = (count, self._build.poses(count))
        data = self._poses[1]
        at = _stamped(data, stamp) - 8 * POSE_FLOATS * count
        for position, direction in zip(positions, directions, strict=True):
            _POSE.pack_into(data, at, *position, *quaternion_onto(direction))
            at += 8 * POSE_FLOATS
        return bytes(data)

    def cloud(self, stamp: int, state: Any) -> bytes:
        """The shape for viewers, in 32-bit floats (a millimetre at 10 km)."""
        count = len(state.s)
        if self._cloud is None or self._cloud[0] != count:
            data = self._build.cloud(count)
            size = len(CLOUD_FIELDS) * count
            # One byte, is_dense, follows the points.
            rows = np.frombuffer(data, "<f4", size, len(data) - 1 - 4 * size)
            self._cloud = (count, data, rows.reshape(count, len(CLOUD_FIELDS)))
        _, data, rows = self._cloud
        _stamped(data, stamp)
        rows[:, :3] = state.position
        rows[:, 3] = state.tension
        rows[:, 4] = state.curvature
        rows[:, 5] = state.s
        return bytes(data)

    def state(self, time: float, state: Any, line: str = "") -> bytes:
        """Exact state of a line: the time, then a row for each of ``variables.STATE_LABELS``.

        Each component's values lie together: they compress far better than node by node.
        """
        count = len(state.s)
        if line not in self._states or self._states[line][0] != count:
            data = self._build.matrix(variables.STATE_LABELS, count)
            size = 1 + len(variables.STATE_LABELS) * count
            values = np.frombuffer(data, "<f8", size, len(data) - 8 * size)
            self._states[line] = (count, data, values)
        _, data, values = self._states[line]
        values[0] = time
        rows = values[1:].reshape(len(variables.STATE_LABELS), count)
        row = 0
        for name, components in variables.STATE_FIELDS:
            rows[row : row + components] = getattr(state, name).T
            row += components
        return bytes(data)


_ZERO = (0.0, 0.0, 0.0)


def _wrench(data: bytearray, stamp: int, force: Floats, torque: Floats | None) -> bytes:
    at = _stamped(data, stamp) - 48
    _THREE.pack_into(data, at, *force.tolist())
    _THREE.pack_into(data, at + 24, *(_ZERO if torque is None else torque.tolist()))
    return bytes(data)


def _stamped(data: bytearray, stamp: int) -> int:
    """Put a time into a message's header; gives the length of the message."""
    _STAMP.pack_into(data, _STAMP_AT, *divmod(stamp, 1_000_000_000))
    return len(data)


class _Prototypes:
    """Messages with zeros for numbers, serialised by rosbags."""

    def __init__(self) -> None:
        self._types = typestore().types
        self._header = self._header_in(FRAME)

    def _header_in(self, frame: str) -> Any:
        time = self._new("builtin_interfaces/msg/Time", 0, 0)
        return self._new("std_msgs/msg/Header", time, frame)

    def _new(self, name: str, *values: Any) -> Any:
        return self._types[name](*values)

    def _serialized(self, name: str, *values: Any) -> bytearray:
        return bytearray(typestore().serialize_cdr(self._new(name, *values), name))

    def _point(self) -> Any:
        return self._new("geometry_msgs/msg/Point", 0.0, 0.0, 0.0)

    def _vector(self) -> Any:
        return self._new("geometry_msgs/msg/Vector3", 0.0, 0.0, 0.0)

    def _pose(self) -> Any:
        turn = self._new("geometry_msgs/msg/Quaternion", 0.0, 0.0, 0.0, 1.0)
        return self._new("geometry_msgs/msg/Pose", self._point(), turn)

    def float64(self) -> bytearray:
        return self._serialized(variables.FLOAT64, 0.0)

    def wrench(self, frame: str) -> bytearray:
        wrench = self._new("geometry_msgs/msg/Wrench", self._vector(), self._vector())
        return self._serialized(variables.WRENCH, self._header_in(frame), wrench)

    def point(self) -> bytearray:
        return self._serialized(variables.POINT, self._header, self._point())

    def odometry(self, child: str = END_FRAME) -> bytearray:
        twist = self._new("geometry_msgs/msg/Twist", self._vector(), self._vector())
        return self._serialized(
            variables.ODOMETRY,
            self._header,
            child,
            self._new("geometry_msgs/msg/PoseWithCovariance", self._pose(), np.zeros(36)),
            self._new("geometry_msgs/msg/TwistWithCovariance", twist, np.zeros(36)),
        )

    def poses(self, count: int) -> bytearray:
        poses = [self._pose() for _ in range(count)]
        return self._serialized(variables.POSES, self._header, poses)

    def cloud(self, count: int) -> bytearray:
        fields = [
            self._new("sensor_msgs/msg/PointField", name, 4 * index, _FLOAT32, 1)
            for index, name in enumerate(CLOUD_FIELDS)
        ]
        step = 4 * len(CLOUD_FIELDS)
        points = np.zeros(step * count, np.uint8)
        return self._serialized(
            variables.CLOUD, self._header, 1, count, fields, False, step, step * count, points, True
        )

    def labelled(self, labels: tuple[str, ...]) -> bytearray:
        """An array with one name for each value."""
        return self._array([(",".join(labels), len(labels))], 0)

    def matrix(self, labels: tuple[str, ...], count: int) -> bytearray:
        """One value for the time, then a matrix with a named row for each label."""
        return self._array([(",".join(labels), len(labels)), ("node", count)], 1)

    def _array(self, dimensions: list[tuple[str, int]], offset: int) -> bytearray:
        size = 1
        layout: list[Any] = []
        for label, length in reversed(dimensions):
            size *= length
            layout.insert(0, self._new("std_msgs/msg/MultiArrayDimension", label, length, size))
        return self._serialized(
            variables.ARRAY,
            self._new("std_msgs/msg/MultiArrayLayout", layout, offset),
            np.zeros(offset + size),
        )
