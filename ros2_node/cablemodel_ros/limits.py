"""Bounded motion: how an applied value follows a wanted one within speed and acceleration."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


def length(vector: Floats) -> float:
    """Of a vector (3,); `np.linalg.norm` takes several times as long for one."""
    return math.hypot(*vector.tolist())


def clipped(vector: Floats, largest: float) -> Floats:
    """A vector (3,) shortened to a length, its direction kept."""
    size = length(vector)
    return vector if size <= largest else vector * (largest / size)


def approached(value: Floats, target: Floats, largest_change: float) -> Floats:
    """A vector (3,) moved towards a target by no more than a distance; exact when it arrives."""
    change = target - value
    size = length(change)
    return target.copy() if size <= largest_change else value + change * (largest_change / size)


def approached_number(value: float, target: float, largest_change: float) -> float:
    """The same for a number."""
    return min(max(target, value - largest_change), value + largest_change)


@dataclass(frozen=True)
class Motion:
    """How the tow point is to move over a step."""

    velocity: Floats
    """Reached at the step's end (3,) [m/s]."""
    limited: bool
    """Whether a limit kept it from what was wanted."""


def follow_velocity(
    velocity: Floats, target: Floats, dt: float, speed: float, acceleration: float
) -> Motion:
    """Towards a velocity (3,) [m/s] within speed [m/s] and acceleration [m/s2] limits."""
    wanted = clipped(target, speed)
    applied = approached(velocity, wanted, acceleration * dt)
    return Motion(applied, applied.tolist() != target.tolist())


@dataclass(frozen=True)
class Course:
    """Where something is at an instant, and how it moves."""

    position: Floats
    """(3,) [m]."""
    velocity: Floats
    """(3,) [m/s]."""
    acceleration: Floats
    """(3,) [m/s2]."""

    def after(self, span: float) -> Course:
        """The same [s] later, or earlier."""
        change = self.acceleration * span
        return Course(
            self.position + (self.velocity + 0.5 * change) * span,
            self.velocity + change,
            self.acceleration,
        )


def follow_course(
    position: Floats,
    velocity: Floats,
    course: Course,
    dt: float,
    smoothing: float,
    speed: float,
    acceleration: float,
) -> Motion:
    """Towards a course that is known with noise, without drift.

    The course's own acceleration is applied, and errors of position and velocity die away as in a
    critically damped system of time constant `smoothing` [s] (at least two steps): noise in a
    sample is not taken for motion. An error that is too large for that is made good as fast as can
    be braked again.

    Args:
        position, velocity: of the tow point at the step's start (3,).
        course: at the step's start.
        dt: length of the step [s].
        smoothing: time constant [s].
        speed, acceleration: limits [m/s], [m/s2].
    """
    half = 0.5 * max(smoothing, 2.0 * dt)
    error = course.position - position
    size = length(error)
    wanted = course.velocity
    if size > 0.0:
        pull = min(0.25 * size / half, math.sqrt(acceleration * size))
        wanted = wanted + error * (pull / size)
    kept = clipped(wanted, speed)
    asked = course.acceleration + (kept - velocity) / half
    given = clipped(asked, acceleration)
    fastest = max(speed, length(velocity))
    return Motion(clipped(velocity + given * dt, fastest), given is not asked or kept is not wanted)


def follow_rate(
    rate: float,
    target: float,
    dt: float,
    largest: float,
    acceleration: float,
    left_out: float,
    left_in: float,
) -> float:
    """Pay-out rate [m/s] at the step's end, within limits, and such that it can be brought to
    rest before the cable on the drum (`left_out` [m]) or outside (`left_in` [m]) is used up."""

    def stopping(left: float) -> float:
        # v such that this step's v dt and the braking after it, v^2/(2 a), take up what is left.
        if left <= 0.0:
            return 0.0
        return math.sqrt((acceleration * dt) ** 2 + 2.0 * acceleration * left) - acceleration * dt

    wanted = min(max(target, -largest), largest)
    wanted = min(max(wanted, -stopping(left_in)), stopping(left_out))
    return approached_number(rate, wanted, acceleration * dt)
