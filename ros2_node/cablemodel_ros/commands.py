"""Commands as they arrive: checked, brought into the map, and kept until the next step.

The newest of each kind is kept. What cannot be used is refused with a reason and counted, and the
command before it stays in force until it is stale.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cablemodel_ros.frames import cross, finite, rotation
from cablemodel_ros.limits import Course
from cablemodel_ros.settings import Settings
from cablemodel_ros.timebase import Arrival, Timebase
from cablemodel_ros.times import Moment, Stamp

Floats = NDArray[np.float64]

MAP = "map"
FUTURE = 1.0
"""How far a stamp may lie in the future [s] before the clocks are taken to disagree."""
DRIFT_TIME = 5.0
"""Over which a drift is smoothed [s]: noise of 0.2 m is one of 0.04 m/s then."""
DRIFT_SPEED, DRIFT_SHARE = 0.25, 0.1
"""A drift above this [m/s], and this part of the speed, is a twist that contradicts its pose."""


@dataclass(frozen=True)
class Twist:
    """A commanded velocity of the vessel."""

    given: Moment
    """When it was made; never later than it came."""
    linear: Floats
    """(3,) [m/s]."""
    angular: Floats
    """(3,) [rad/s]."""
    in_vessel: bool
    """Whether both are in vessel axes (else the map's)."""


@dataclass(frozen=True)
class Odometry:
    """Motion of the tow point as measured, in the map."""

    given: Moment
    measured: Moment
    """The moment of its stamp, which may lie in the future."""
    course: Course
    """At that moment; its acceleration is that of the samples so far, smoothed."""
    interval: float
    """Since the sample before it [s]; 0 for the first."""
    rotation: Floats
    """Vessel axes to map axes (3, 3)."""
    spin: Floats
    """In map axes (3,) [rad/s]."""
    spin_rate: Floats
    """Its change, as that of the velocity (3,) [rad/s2]."""
    drift: Floats
    """How much faster places have moved than velocities said, smoothed (3,) [m/s]."""


@dataclass(frozen=True)
class PayoutRate:
    """A commanded pay-out rate."""

    given: Moment
    rate: float
    """[m/s], positive out."""


@dataclass(frozen=True)
class Wrench:
    """A commanded force and torque on a body, about its origin."""

    given: Moment
    value: Floats
    """(6,) [N, N m]."""
    in_body: bool
    """Whether both are in the body's axes (else the map's)."""


@dataclass
class Tally:
    """What came in by one topic."""

    received: int = 0
    refused: int = 0
    reason: str = ""
    """Why the last refused one was refused."""


@dataclass
class Latest:
    """The commands in force."""

    twist: Twist | None = None
    odometry: Odometry | None = None
    payout: PayoutRate | None = None


@dataclass(frozen=True)
class Seat:
    """A vessel that is commanded: what its topics and its frame are called, and which of its
    points the commands are brought to."""

    odometry: str
    twist: str
    frame: str
    point: tuple[float, ...] = (0.0, 0.0, 0.0)
    """In its own axes [m]."""

    @classmethod
    def of(cls, settings: Settings) -> Seat:
        """The one of a scene of one line."""
        return cls("odom", "cmd_vel", settings.vessel_frame, settings.tow_point)


class Desk:
    """Where commands of some topics are checked and counted; every ``take`` returns an empty text,
    or why it refused.

    A stamp says how long a message was under way, by the clock that it was stamped with. From then
    on it ages by the time base's own clock: no clock that is set makes it older or younger.
    """

    def __init__(self, settings: Settings, timebase: Timebase, topics: Iterable[str]) -> None:
        self._settings = settings
        self._timebase = timebase
        self._lock = threading.Lock()
        self.tallies = {topic: Tally() for topic in topics}

    def update(self, settings: Settings) -> None:
        """Take over changed limits."""
        self._settings = settings

    def _refuse(self, topic: str, reason: str) -> str:
        with self._lock:
            tally = self.tallies[topic]
            tally.refused += 1
            tally.reason = reason
        return f"{topic} refused: {reason}"

    def _wrong_stamp(self, arrival: Arrival) -> str:
        if arrival.delay > self._settings.command_timeout:
            return f"its stamp is {arrival.delay:.3g} s old; allowed: command_timeout"
        if arrival.delay < -FUTURE:
            return f"its stamp lies {-arrival.delay:.3g} s in the future: do the clocks agree?"
        return ""


class Commands(Desk):
    """Takes commands of a vessel, and of the winch of a scene of one line, from any thread; gives
    the newest to the control loop.

    Args:
        settings: limits, and names of frames.
        timebase: says when a message was made.
        origin: where its point is at the start, in the map (3,) [m].
        seat: what is commanded; by default that of a scene of one line.
    """

    def __init__(
        self,
        settings: Settings,
        timebase: Timebase,
        origin: ArrayLike = (0.0, 0.0, 0.0),
        seat: Seat | None = None,
    ) -> None:
        self.seat = seat or Seat.of(settings)
        topics = (self.seat.odometry, self.seat.twist, *(() if seat else ("payout_rate_cmd",)))
        super().__init__(settings, timebase, topics)
        self._origin = np.array(origin, dtype=np.float64)
        self._shift: Floats | None = None if settings.odom_relative else np.zeros(3)
        self._point = np.array(self.seat.point)
        self._latest = Latest()

    def latest(self) -> Latest:
        """The newest commands."""
        with self._lock:
            return Latest(self._latest.twist, self._latest.odometry, self._latest.payout)

    def begin_at(self, origin: ArrayLike) -> None:
        """The model begins with its point elsewhere in the map (3,) [m]."""
        with self._lock:
            self._origin = np.array(origin, dtype=np.float64)

    def forget(self) -> None:
        """Drop all commands (after a reset: they were given for another state)."""
        with self._lock:
            self._latest = Latest()
            if self._settings.odom_relative:
                self._shift = None

    def forget_payout(self) -> None:
        """Drop the pay-out command; a new one is tried anew."""
        with self._lock:
            self._latest.payout = None

    def take_twist(
        self,
        stamp: Stamp | None,
        frame: str,
        linear: Sequence[float],
        angular: Sequence[float],
    ) -> str:
        """A velocity command: its `stamp` (None: not stamped), `frame` of its axes (empty: the
        map's)."""
        values = np.array([*linear, *angular], dtype=np.float64)
        if not finite(values):
            return self._refuse(self.seat.twist, f"not finite: {values.tolist()}")
        seat = self.seat
        if frame not in ("", MAP, seat.frame):
            return self._refuse(seat.twist, f"frame {frame!r}; allowed: {MAP}, {seat.frame}")
        arrival = self._timebase.arrival(stamp)
        reason = self._wrong_stamp(arrival)
        if reason:
            return self._refuse(seat.twist, reason)
        in_vessel = frame == seat.frame
        twist = Twist(_given(arrival), values[:3], values[3:], in_vessel)
        with self._lock:
            self._latest.twist = twist
            self.tallies[seat.twist].received += 1
        return ""

    def take_odometry(
        self,
        stamp: Stamp | None,
        frame: str,
        child_frame: str,
        position: Sequence[float],
        orientation: Sequence[float],
        linear: Sequence[float],
        angular: Sequence[float],
    ) -> str:
        """Motion of the vessel: pose in `frame`, twist in `child_frame` (as Odometry has it).

        Empty frames are `odom_frame` and the vessel's, as the message's definition means them.
        """
        topic, own_frame = self.seat.odometry, self.seat.frame
        values = np.array([*position, *orientation, *linear, *angular], dtype=np.float64)
        if not finite(values):
            return self._refuse(topic, f"not finite: {values.tolist()}")
        if frame not in ("", self._settings.odom_frame):
            return self._refuse(topic, f"frame {frame!r}; allowed: {self._settings.odom_frame}")
        fixed = (self._settings.odom_frame, MAP)
        if child_frame not in ("", own_frame, *fixed):
            return self._refuse(
                topic,
                f"child frame {child_frame!r}; allowed: {own_frame}, "
                f"{', '.join(dict.fromkeys(fixed))}",
            )
        arrival = self._timebase.arrival(stamp)
        reason = self._wrong_stamp(arrival)
        if reason:
            return self._refuse(topic, reason)
        try:
            turn = rotation(orientation)
        except ValueError as error:
            return self._refuse(topic, str(error))
        arm = turn @ self._point
        velocity, spin = values[7:10], values[10:13]
        if child_frame not in fixed:
            velocity, spin = turn @ velocity, turn @ spin
        place = values[:3] + arm
        with self._lock:
            if self._shift is None:
                self._shift = self._origin - place
            self._latest.odometry = self._sample(
                arrival, place + self._shift, velocity + cross(spin, arm), turn, spin
            )
            self.tallies[topic].received += 1
        return ""

    def _sample(
        self, arrival: Arrival, position: Floats, velocity: Floats, turn: Floats, spin: Floats
    ) -> Odometry:
        """A sample with the accelerations that it and those before it show."""
        before = self._latest.odometry
        motion = np.concatenate([velocity, spin])
        acceleration, drift, interval = np.zeros(6), np.zeros(3), 0.0
        if before is not None:
            interval = arrival.made - before.measured
            if interval <= self._settings.command_timeout:
                acceleration = np.concatenate([before.course.acceleration, before.spin_rate])
                if interval > 0.0:
                    old = np.concatenate([before.course.velocity, before.spin])
                    seen = (motion - old) / interval
                    share = -math.expm1(-interval / max(self._settings.odom_smoothing, 1e-9))
                    acceleration = acceleration + share * (seen - acceleration)
                    way = position - before.course.position
                    ahead = way / interval - 0.5 * (velocity + before.course.velocity)
                    share = -math.expm1(-interval / DRIFT_TIME)
                    drift = before.drift + share * (ahead - before.drift)
                else:
                    drift = before.drift
        course = Course(position, velocity, acceleration[:3])
        return Odometry(
            _given(arrival), arrival.made, course, max(interval, 0.0), turn, spin,
            acceleration[3:], drift,
        )  # fmt: skip

    def contradictions(self) -> Iterator[str]:
        """Odometry in force whose twist does not say how its pose moves, in words."""
        with self._lock:
            sample = self._latest.odometry
        if sample is None:
            return
        drift = float(np.linalg.norm(sample.drift))
        speed = float(np.linalg.norm(sample.course.velocity))
        fresh = self._timebase.now() - sample.given <= self._settings.command_timeout
        if fresh and drift > DRIFT_SPEED + DRIFT_SHARE * speed:
            yield (
                f"{self.seat.odometry} contradicts itself by {drift:.2g} m/s: its twist does not "
                "say how its pose moves; is it in the axes of child_frame_id?"
            )

    def take_payout_rate(self, rate: float) -> str:
        """A pay-out rate [m/s], positive out."""
        if not math.isfinite(rate):
            return self._refuse("payout_rate_cmd", f"not finite: {rate}")
        with self._lock:
            self._latest.payout = PayoutRate(self._timebase.now(), float(rate))
            self.tallies["payout_rate_cmd"].received += 1
        return ""

    def refuse_odometry_jump(self, distance: float) -> str:
        """Drop an odometry sample that lies too far away to be followed."""
        with self._lock:
            self._latest.odometry = None
        return self._refuse(
            self.seat.odometry,
            f"position is {distance:.3g} m from the present one; allowed: limits.position_jump = "
            f"{self._settings.limits_position_jump:g} m (odom_relative counts from the first "
            "message; ~/reset begins anew)",
        )

    def refuse_payout(self, reason: str) -> str:
        """Drop a pay-out command that the model could not carry out."""
        self.forget_payout()
        return self._refuse("payout_rate_cmd", reason)


class PartCommands(Desk):
    """Takes what acts on the parts of a system: wrenches on bodies, deflections of foils, rates of
    winches, and orders to cut.

    Args:
        settings: the time-out.
        timebase: says when a message was made.
        bodies, foils, winches: topics by the names of bodies, of ``BODY.FOIL``, and of winches.

    Attributes: ``topics`` (of all), ``wrenches``, ``deflections`` and ``rates`` (the newest, by
    name), ``cuts`` (that are ordered).
    """

    def __init__(
        self,
        settings: Settings,
        timebase: Timebase,
        bodies: Mapping[str, str],
        foils: Mapping[str, str],
        winches: Mapping[str, str],
    ) -> None:
        self.topics = {**bodies, **foils, **winches}
        super().__init__(settings, timebase, self.topics.values())
        self.forget()

    def forget(self) -> None:
        """Drop all of them."""
        with self._lock:
            self.wrenches: dict[str, Wrench] = {}
            self.deflections: dict[str, float] = {}
            self.rates: dict[str, PayoutRate] = {}
            self.cuts: tuple[str, ...] = ()

    def take_wrench(
        self,
        body: str,
        stamp: Stamp | None,
        frame: str,
        force: Sequence[float],
        torque: Sequence[float],
    ) -> str:
        """Force and torque about a body's origin, in `frame`: the map's (or empty), or its own."""
        topic = self.topics[body]
        value = np.array([*force, *torque], dtype=np.float64)
        if not finite(value):
            return self._refuse(topic, f"not finite: {value.tolist()}")
        if frame not in ("", MAP, body):
            return self._refuse(topic, f"frame {frame!r}; allowed: {MAP}, {body}")
        arrival = self._timebase.arrival(stamp)
        reason = self._wrong_stamp(arrival)
        if reason:
            return self._refuse(topic, reason)
        with self._lock:
            self.wrenches[body] = Wrench(_given(arrival), value, frame == body)
            self.tallies[topic].received += 1
        return ""

    def take_deflection(self, foil: str, angle: float) -> str:
        """Deflection of a foil [rad]."""
        topic = self.topics[foil]
        if not math.isfinite(angle):
            return self._refuse(topic, f"not finite: {angle}")
        with self._lock:
            self.deflections[foil] = float(angle)
            self.tallies[topic].received += 1
        return ""

    def take_rate(self, winch: str, rate: float) -> str:
        """A pay-out rate of a winch [m/s], positive out."""
        topic = self.topics[winch]
        if not math.isfinite(rate):
            return self._refuse(topic, f"not finite: {rate}")
        with self._lock:
            self.rates[winch] = PayoutRate(self._timebase.now(), float(rate))
            self.tallies[topic].received += 1
        return ""

    def refuse_rate(self, winch: str, reason: str) -> str:
        """Stop a winch, whose rate the model could not carry out, until a new one comes."""
        with self._lock:
            self.rates[winch] = replace(self.rates[winch], rate=0.0)
        return self._refuse(self.topics[winch], reason)

    def order_cut(self, name: str) -> None:
        """Make a cut in the next step, and again if the model goes back to before it."""
        with self._lock:
            self.cuts = tuple(dict.fromkeys((*self.cuts, name)))


def _given(arrival: Arrival) -> Moment:
    return min(arrival.made, arrival.now)
