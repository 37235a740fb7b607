"""What a step applies: commands made into bounded motion of the tow point and pay-out."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cablemodel_ros.commands import Commands, Odometry, PayoutRate, Twist
from cablemodel_ros.frames import cross, heading_rotation, turned
from cablemodel_ros.limits import Motion, clipped, follow_course, follow_rate, follow_velocity
from cablemodel_ros.settings import Settings
from cablemodel_ros.times import Moment

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Applied:
    """Inputs of one step, as `CableModel.step` takes them (None: the scene's own schedule)."""

    velocity: Floats | None
    payout_rate: float | None

    @property
    def given(self) -> tuple[str, ...]:
        """Names of the inputs that are given."""
        values = {
            "vessel_velocity": self.velocity,
            "payout_rate": self.payout_rate,
        }
        return tuple(name for name, value in values.items() if value is not None)


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


class Helm:
    """Steers the model by the commands in force.

    Attributes: ``rotation`` (vessel axes to map axes), ``stale`` (by topic, those whose command
    has timed out), ``waiting`` (topics that have given no command yet), ``limited`` (steps in
    which a limit was at work), ``idle_payout`` (pay-out is commanded, and there is no cable on the
    drum).
    """

    def __init__(self, settings: Settings, commands: Commands) -> None:
        self._settings = settings
        self._commands = commands
        self.limited = 0
        self.reset()

    def update(self, settings: Settings) -> None:
        """Take over changed limits."""
        self._settings = settings

    def reset(self) -> None:
        """Back to the initial heading; no command was ever seen."""
        self.rotation = heading_rotation(self._settings.initial_heading)
        self.idle_payout = False
        self.stale: set[str] = set()
        self._seen: set[str] = set()
        self.last_refusal = ""

    @property
    def waiting(self) -> set[str]:
        """Sources of motion that have given nothing yet."""
        return {self._settings.vessel_input} - {"scene"} - self._seen

    @property
    def wants_payout(self) -> bool:
        """Whether pay-out follows commands (else the scene's schedule)."""
        return self._settings.payout_input == "command"

    def inputs(self, now: Moment, dt: float, present: Present) -> Applied:
        """Inputs of a step of dt [s] that ends at `now`."""
        latest = self._commands.latest()
        motion: Motion | None = None
        if self._settings.vessel_input == "cmd_vel":
            motion = self._by_twist(now, dt, present)
        elif self._settings.vessel_input == "odom":
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

    def _fresh(
        self, topic: str, now: Moment, command: Twist | Odometry | PayoutRate | None
    ) -> bool:
        """Whether a command is in force; keeps the set of stale ones."""
        if command is None:
            return False
        self._seen.add(topic)
        if now - command.given <= self._settings.command_timeout:
            self.stale.discard(topic)
            return True
        self.stale.add(topic)
        return False

    def _by_twist(self, now: Moment, dt: float, present: Present) -> Motion:
        s = self._settings
        twist = self._commands.latest().twist
        target = np.zeros(3)
        if self._fresh("cmd_vel", now, twist):
            assert twist is not None
            spin = clipped(twist.angular, s.limits_turn_rate)
            spin = self.rotation @ spin if twist.in_vessel else spin
            self.rotation = turned(self.rotation, spin, dt)
            linear = self.rotation @ twist.linear if twist.in_vessel else twist.linear
            target = linear + cross(spin, self.rotation @ np.array(s.tow_point))
        return follow_velocity(present.velocity, target, dt, s.limits_speed, s.limits_acceleration)

    def _by_odometry(self, now: Moment, dt: float, present: Present) -> Motion:
        s = self._settings
        sample = self._commands.latest().odometry
        if self._fresh("odom", now, sample):
            assert sample is not None
            self.rotation = sample.rotation
            course = sample.course.after(now - sample.measured - dt)
            distance = float(np.linalg.norm(course.position - present.position))
            if distance <= s.limits_position_jump:
                return follow_course(
                    present.position,
                    present.velocity,
                    course,
                    dt,
                    max(s.odom_smoothing, min(sample.interval, s.command_timeout)),
                    s.limits_speed,
                    s.limits_acceleration,
                )
            self.last_refusal = self._commands.refuse_odometry_jump(distance)
            self.stale.add("odom")
        return follow_velocity(
            present.velocity, np.zeros(3), dt, s.limits_speed, s.limits_acceleration
        )
