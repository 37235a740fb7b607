"""What a step publishes, as the bytes that go out and into the log.

Messages are made once, in the log's own templates, and the same bytes are published and logged:
that is several times cheaper than message objects, and the log is what was on the wire.
"""

from __future__ import annotations

import struct
from collections.abc import Collection
from typing import TYPE_CHECKING, Any

import numpy as np

from cablemodel import variables
from cablemodel.results.log.messages import Messages, typestore
from cablemodel.results.log.writer import encode_outputs
from cablemodel.results.states import applied_values
from cablemodel.solvers.shared import layout as at
from cablemodel_ros.frames import Floats, cross
from cablemodel_ros.helm import Applied
from cablemodel_ros.settings import Settings
from cablemodel_ros.times import Stamp

if TYPE_CHECKING:
    from cablemodel import CableModel, Scene, SystemScene

Message = tuple[str, bytes]
"""Topic as the table writes it (``~/...``), and CDR bytes."""

NODES = "~/nodes"
APPLIED_ODOMETRY = "~/applied_odom"
APPLIED_TWIST = "~/applied_cmd_vel"
TWIST = "geometry_msgs/msg/TwistStamped"

VESSEL_WRENCH = "~/vessel_wrench"

_STAMP = struct.Struct("<iI")
_THREE = struct.Struct("<3d")
_ODOMETRY_DOUBLES, _TWIST_IN_ODOMETRY = 85, 43


class Stations:
    """Points spaced evenly along a cable: what `Messages.cloud` reads of a `CableState`, in memory
    that stays."""

    def __init__(self, count: int) -> None:
        self._shares = np.linspace(0.0, 1.0, count)
        self._words = np.empty(at.STATION_WORDS * count)
        rows = self._words.reshape(-1, at.STATION_WORDS)
        self.s = np.empty(count)
        self.position = rows[:, at.Station.position.span]
        self.tension = rows[:, at.Station.tension]
        self.curvature = rows[:, at.Station.curvature]

    def look_at(self, model: CableModel) -> None:
        """Become what the model is now."""
        np.multiply(self._shares, model.line_length, out=self.s)
        model.sample_words(self.s, self._words)


class Sampler:
    """Makes the messages of one scene (not thread-safe).

    Args:
        scene: scene of the model.
        settings: how many points ``~/nodes`` has, and names of frames.
    """

    def __init__(self, scene: Scene, settings: Settings) -> None:
        self._messages = Messages(settings.tow_point_frame)
        self._in_vessel = Messages(settings.vessel_frame)
        self._arm = np.array(settings.tow_point)
        self.topics = topics(scene)
        self._stations = Stations(settings.stations)
        self._odometry = _odometry(settings.tow_point_frame)
        self._twist = _twist()

    def step(
        self, model: CableModel, step: float, applied: Applied, stamp: Stamp
    ) -> tuple[Message, list[Message]]:
        """What a step applied: the exact record, and what controllers read.

        Returns: the message of ``~/applied_inputs``; those of the tow point's applied motion.
        """
        values = applied_values(model, step, applied.given)
        # The value asked for, not the last bit that evaluating the motion makes of it: a replay
        # that gives it again is then exact.
        if applied.velocity is not None:
            values[_VELOCITY] = applied.velocity
        if applied.payout_rate is not None:
            values[_PAYOUT] = applied.payout_rate
        seconds, nanoseconds = divmod(stamp.ns, 1_000_000_000)
        position, velocity = values[_POSITION].tolist(), values[_VELOCITY].tolist()
        odometry, twist = self._odometry, self._twist
        _STAMP.pack_into(odometry, 4, seconds, nanoseconds)
        at = len(odometry) - 8 * _ODOMETRY_DOUBLES
        _THREE.pack_into(odometry, at, *position)
        _THREE.pack_into(odometry, at + 8 * _TWIST_IN_ODOMETRY, *velocity)
        _STAMP.pack_into(twist, 4, seconds, nanoseconds)
        _THREE.pack_into(twist, len(twist) - 48, *velocity)
        exact = self._messages.row(variables.APPLIED_INPUT_LABELS, values)
        record = (variables.APPLIED_INPUTS_TOPIC, exact)
        return record, [(APPLIED_ODOMETRY, bytes(odometry)), (APPLIED_TWIST, bytes(twist))]

    def outputs(
        self,
        model: CableModel,
        stamp: Stamp,
        rotation: Floats,
        wanted: Collection[str] | None = None,
    ) -> list[Message]:
        """All outputs of the table, with ``~/nodes`` at the stations, and the wrench on the vessel.

        rotation: vessel axes to map axes (3, 3); wanted: topics, None: all.
        """
        topics = [topic for topic in self.topics if wanted is None or topic in wanted]
        if NODES in topics:
            self._stations.look_at(model)
        found = encode_outputs(self._messages, topics, stamp.ns, model, self._stations)
        if wanted is None or VESSEL_WRENCH in wanted:
            force, moment = self.vessel_wrench(model, rotation)
            found.append((VESSEL_WRENCH, self._in_vessel.top_wrench(stamp.ns, force, moment)))
        return found

    def vessel_wrench(self, model: CableModel, rotation: Floats) -> tuple[Floats, Floats]:
        """Force [N] and moment [N m] of the cable about the vessel frame's origin, in its axes."""
        force = model.top_force @ rotation
        return force, model.top_moment @ rotation + cross(self._arm, force)

    def record(self, model: CableModel, stamp: Stamp) -> list[Message]:
        """All outputs with ``~/nodes`` at the model's own nodes, and the exact state: what
        ``cablemodel run`` logs at an output time."""
        state = model.state()
        exact = (variables.STATE_TOPIC, self._messages.state(model.time, state))
        return [*encode_outputs(self._messages, self.topics, stamp.ns, model, state), exact]


def topics(scene: Scene | SystemScene) -> tuple[str, ...]:
    """Output topics that a scene has, in the table's order."""
    return tuple(dict.fromkeys(variable.topic for variable in variables.outputs_of(scene)))


_LABELS = variables.APPLIED_INPUT_FIELDS
_POSITION = variables.span(_LABELS, "vessel_position")
_VELOCITY = variables.span(_LABELS, "vessel_velocity")
_PAYOUT = variables.span(_LABELS, "payout_rate")


def _new(name: str, *values: Any) -> Any:
    return typestore().types[name](*values)


def _header() -> Any:
    return _new("std_msgs/msg/Header", _new("builtin_interfaces/msg/Time", 0, 0), "map")


def _zero_twist() -> Any:
    zero = [_new("geometry_msgs/msg/Vector3", 0.0, 0.0, 0.0) for _ in range(2)]
    return _new("geometry_msgs/msg/Twist", *zero)


def _serialized(message: Any, name: str) -> bytearray:
    return bytearray(typestore().serialize_cdr(message, name))


def _odometry(frame: str) -> bytearray:
    """Odometry of the tow point; its frame is parallel to the map."""
    point = _new("geometry_msgs/msg/Point", 0.0, 0.0, 0.0)
    turn = _new("geometry_msgs/msg/Quaternion", 0.0, 0.0, 0.0, 1.0)
    pose = _new("geometry_msgs/msg/Pose", point, turn)
    message = _new(
        variables.ODOMETRY,
        _header(),
        frame,
        _new("geometry_msgs/msg/PoseWithCovariance", pose, np.zeros(36)),
        _new("geometry_msgs/msg/TwistWithCovariance", _zero_twist(), np.zeros(36)),
    )
    return _serialized(message, variables.ODOMETRY)


def _twist() -> bytearray:
    return _serialized(_new(TWIST, _header(), _zero_twist()), TWIST)
