"""What a step applies: commands made into bounded motion, of the tow point and of vessels."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel_ros.commands import Commands, Odometry, PayoutRate, Twist, Wrench
from cablemodel_ros.frames import (
    angle_rates,
    angles_of,
    axes_of,
    cross,
    heading_rotation,
    turned,
)
from cablemodel_ros.limits import (
    Course,
    Motion,
    clipped,
    follow_course,
    follow_rate,
    follow_velocity,
)
from cablemodel_ros.settings import Settings
from cablemodel_ros.times import Moment

if TYPE_CHECKING:
    from cablemodel import VesselInput
    from cablemodel.systems.model import Motion as PartMotion

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Applied:
    """Inputs of one step, as `CableModel.step` takes them (None: the scene's own schedule)."""

    velocity: Floats | None
    payout_rate: float | None

    @property
    def given(self) -> tuple[str, ...]:
        """Names of the inputs that are given."""
        velocity = () if self.velocity is None else ("vessel_velocity",)
        return velocity if self.payout_rate is None else (*velocity, "payout_rate")


@dataclass(frozen=True)
class Present:
    """Where the model stands before a step."""

    position: Floats
    """Of the tow point (3,) [m]."""
    velocity: Floats
    """(3,) [m/s]."""
    payout_rate: float
    line_length: float
    drum_length: float


class Freshness:
    """Which commands are in force.

    Attributes: ``stale`` (topics whose command has timed out), ``seen`` (topics that have given
    one).
    """

    def __init__(self) -> None:
        self.stale: set[str] = set()
        self.seen: set[str] = set()

    def fresh(
        self,
        topic: str,
        now: Moment,
        command: Twist | Odometry | PayoutRate | Wrench | None,
        timeout: float,
    ) -> bool:
        """Whether a command is in force; keeps the set of stale ones."""
        if command is None:
            return False
        self.seen.add(topic)
        if now - command.given <= timeout:
            self.stale.discard(topic)
            return True
        self.stale.add(topic)
        return False


class Steering:
    """What moves one vessel, by the commands in force.

    Attributes: ``stale`` (by topic, those whose command has timed out), ``waiting`` (topics that
    have given no command yet), ``limited`` (steps in which a limit was at work).
    """

    def __init__(self, settings: Settings, commands: Commands, source: str) -> None:
        self._settings = settings
        self._commands = commands
        self._source = source
        self._topic = {
            "odom": commands.seat.odometry,
            "cmd_vel": commands.seat.twist,
        }.get(source, "")
        self._freshness = Freshness()
        self.limited = 0

    def update(self, settings: Settings) -> None:
        """Take over changed limits."""
        self._settings = settings

    def reset(self) -> None:
        """No command was ever seen."""
        self._freshness = Freshness()

    @property
    def stale(self) -> set[str]:
        """Topics whose command has timed out."""
        return self._freshness.stale

    @property
    def waiting(self) -> set[str]:
        """Sources of motion that have given nothing yet."""
        return {self._topic} - {""} - self._freshness.seen

    def _fresh(
        self, topic: str, now: Moment, command: Twist | Odometry | PayoutRate | None
    ) -> bool:
        return self._freshness.fresh(topic, now, command, self._settings.command_timeout)

    def _twist(self, now: Moment) -> Twist | None:
        """The velocity command in force."""
        twist = self._commands.latest().twist
        return twist if self._fresh(self._topic, now, twist) else None

    def _odometry(self, now: Moment) -> Odometry | None:
        """The sample of odometry in force."""
        sample = self._commands.latest().odometry
        return sample if self._fresh(self._topic, now, sample) else None

    def _within_reach(self, course: Course, position: Floats) -> bool:
        """Whether a course is near enough to be followed; else it is refused."""
        distance = float(np.linalg.norm(course.position - position))
        if distance <= self._settings.limits_position_jump:
            return True
        self._commands.refuse_odometry_jump(distance)
        self.stale.add(self._topic)
        return False

    def _smoothing(self, sample: Odometry) -> float:
        s = self._settings
        return max(s.odom_smoothing, min(sample.interval, s.command_timeout))

    def _along(
        self, sample: Odometry, course: Course, position: Floats, velocity: Floats, dt: float
    ) -> Motion:
        """Along a course, of which a sample tells."""
        s = self._settings
        return follow_course(
            position, velocity, course, dt, self._smoothing(sample),
            s.limits_speed, s.limits_acceleration,
        )  # fmt: skip

    def _towards(self, target: Floats, velocity: Floats, dt: float) -> Motion:
        """Towards a velocity."""
        s = self._settings
        return follow_velocity(velocity, target, dt, s.limits_speed, s.limits_acceleration)


class Helm(Steering):
    """Steers the tow point and the winch of a scene of one line.

    Attributes beyond those of `Steering`: ``rotation`` (vessel axes to map axes), ``idle_payout``
    (pay-out is commanded, and there is no cable on the drum).
    """

    def __init__(self, settings: Settings, commands: Commands) -> None:
        super().__init__(settings, commands, settings.vessel_input)
        self.begin_with(heading_rotation(settings.initial_heading))

    def begin_with(self, rotation: Floats) -> None:
        """Begin, now and after a reset, with an attitude: vessel axes to map axes (3, 3)."""
        self._initial = rotation
        self.reset()

    def reset(self) -> None:
        """Back to the initial attitude; no command was ever seen."""
        super().reset()
        self.rotation = self._initial.copy()
        self.idle_payout = False

    @property
    def wants_payout(self) -> bool:
        """Whether pay-out follows commands (else the scene's schedule)."""
        return self._settings.payout_input == "command"

    def inputs(self, now: Moment, dt: float, present: Present) -> Applied:
        """Inputs of a step of dt [s] that ends at `now`."""
        latest = self._commands.latest()
        motion: Motion | None = None
        if self._source == "cmd_vel":
            motion = self._by_twist(now, dt, present)
        elif self._source == "odom":
            motion = self._by_odometry(now, dt, present)
        rate = None
        limited = motion is not None and motion.limited
        if self.wants_payout:
            wanted = 0.0
            if self._fresh("payout_rate_cmd", now, latest.payout):
                assert latest.payout is not None
                wanted = latest.payout.rate
            self.idle_payout = wanted > 0.0 and present.drum_length <= 0.0
            rate = follow_rate(
                present.payout_rate,
                wanted,
                dt,
                self._settings.limits_payout_rate,
                self._settings.limits_payout_acceleration,
                present.drum_length,
                present.line_length - self._settings.limits_line_length_min,
            )
            limited = limited or rate != wanted
        self.limited += limited
        if motion is None:
            return Applied(None, rate)
        return Applied(motion.velocity, rate)

    def _by_twist(self, now: Moment, dt: float, present: Present) -> Motion:
        s = self._settings
        twist = self._twist(now)
        target, slowed = np.zeros(3), False
        if twist is not None:
            spin = clipped(twist.angular, s.limits_turn_rate)
            slowed = spin is not twist.angular
            spin = self.rotation @ spin if twist.in_vessel else spin
            self.rotation = turned(self.rotation, spin, dt)
            linear = self.rotation @ twist.linear if twist.in_vessel else twist.linear
            target = linear + cross(spin, self.rotation @ np.array(s.tow_point))
        motion = self._towards(target, present.velocity, dt)
        return replace(motion, limited=True) if slowed else motion

    def _by_odometry(self, now: Moment, dt: float, present: Present) -> Motion:
        sample = self._odometry(now)
        if sample is not None:
            since = now - sample.measured
            course = sample.course.after(since - dt)
            if self._within_reach(course, present.position):
                self.rotation = _turned(sample, since)
                return self._along(sample, course, present.position, present.velocity, dt)
        return self._towards(np.zeros(3), present.velocity, dt)


class VesselHelm(Steering):
    """Steers a vessel or driven end of a system, which turns as well: roll, pitch and yaw follow
    as the place does, within limits of their own."""

    def input(self, now: Moment, dt: float, present: PartMotion) -> VesselInput | None:
        """Input of a step of dt [s] that ends at `now`; None: the scene moves it.

        present: its motion at the beginning of the step.
        """
        from cablemodel import VesselInput

        if self._source == "scene":
            return None
        rates = angle_rates(present.attitude, present.angular_velocity)
        follow = self._by_twist if self._source == "cmd_vel" else self._by_odometry
        motion, turning = follow(now, dt, present, rates)
        self.limited += motion.limited or turning.limited
        return VesselInput(velocity=motion.velocity, attitude_rate=turning.velocity)

    def _turn_towards(self, target: Floats, rates: Floats, dt: float) -> Motion:
        s = self._settings
        return follow_velocity(rates, target, dt, s.limits_turn_rate, s.limits_turn_acceleration)

    def _by_twist(
        self, now: Moment, dt: float, present: PartMotion, rates: Floats
    ) -> tuple[Motion, Motion]:
        twist = self._twist(now)
        if twist is None:
            return self._to_rest(dt, present, rates)
        spin = present.axes @ twist.angular if twist.in_vessel else twist.angular
        turning = self._turn_towards(angle_rates(present.attitude, spin), rates, dt)
        target = twist.linear
        if twist.in_vessel:
            target = axes_of(present.attitude + 0.5 * dt * (rates + turning.velocity)) @ target
        return self._towards(target, present.velocity, dt), turning

    def _by_odometry(
        self, now: Moment, dt: float, present: PartMotion, rates: Floats
    ) -> tuple[Motion, Motion]:
        sample = self._odometry(now)
        if sample is None:
            return self._to_rest(dt, present, rates)
        span = now - sample.measured - dt
        course = sample.course.after(span)
        if not self._within_reach(course, present.position):
            return self._to_rest(dt, present, rates)
        s = self._settings
        turning = follow_course(
            present.attitude, rates, _turning(sample, span, dt, present.attitude), dt,
            self._smoothing(sample), s.limits_turn_rate, s.limits_turn_acceleration,
        )  # fmt: skip
        return self._along(sample, course, present.position, present.velocity, dt), turning

    def _to_rest(self, dt: float, present: PartMotion, rates: Floats) -> tuple[Motion, Motion]:
        rest = np.zeros(3)
        return self._towards(rest, present.velocity, dt), self._turn_towards(rest, rates, dt)


def _turning(sample: Odometry, span: float, dt: float, near: Floats) -> Course:
    """Roll, pitch and yaw of a sample, `span` [s] after it, over a step of dt [s].

    near: angles (3,), of which those of the course are less than half a turn away.
    """
    angles, begin = _turned_angles(sample, span)
    _, end = _turned_angles(sample, span + dt)
    away = np.remainder(angles - near + np.pi, 2.0 * np.pi) - np.pi
    return Course(near + away, begin, (end - begin) / dt)


def _turned(sample: Odometry, span: float) -> Floats:
    """Vessel axes to map axes a time [s] after a sample (3, 3)."""
    return turned(sample.rotation, sample.spin + 0.5 * span * sample.spin_rate, span)


def _turned_angles(sample: Odometry, span: float) -> tuple[Floats, Floats]:
    """Roll, pitch and yaw a time after a sample, and their rates."""
    angles = angles_of(_turned(sample, span))
    return angles, angle_rates(angles, sample.spin + span * sample.spin_rate)
