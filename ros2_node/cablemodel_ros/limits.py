"""Bounded motion: how an applied value follows a wanted one within speed and acceleration."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]

TRACKING_RATE = 1.0
"""[1/s] at which a position error dies away where it cannot be met at once."""


def clipped(vector: Floats, largest: float) -> Floats:
    """A vector (3,) shortened to a length, its direction kept."""
    size = float(np.linalg.norm(vector))
    return vector if size <= largest else vector * (largest / size)


def approached(value: Floats, target: Floats, largest_change: float) -> Floats:
    """A vector (3,) moved towards a target by no more than a distance; exact when it arrives."""
    change = target - value
    size = float(np.linalg.norm(change))
    return target.copy() if size <= largest_change else value + change * (largest_change / size)


def approached_number(value: float, target: float, largest_change: float) -> float:
    """The same for a number."""
    return min(max(target, value - largest_change), value + largest_change)


@dataclass(frozen=True)
class Motion:
    """How the tow point is to move over a step: velocity reached at its end, and the position
    too where both can be met (None: the velocity alone)."""

    velocity: Floats
    position: Floats | None
    limited: bool
    """Whether a limit kept it from what was wanted."""


def follow_velocity(
    velocity: Floats, target: Floats, dt: float, speed: float, acceleration: float
) -> Motion:
    """Towards a velocity (3,) [m/s] within speed [m/s] and acceleration [m/s2] limits."""
    wanted = clipped(target, speed)
    applied = approached(velocity, wanted, acceleration * dt)
    return Motion(applied, None, not np.array_equal(applied, target))


def follow_position(
    position: Floats,
    velocity: Floats,
    target_position: Floats,
    target_velocity: Floats,
    dt: float,
    speed: float,
    acceleration: float,
) -> Motion:
    """Towards a position and velocity (3,) at the step's end, without drift.

    Where the cubic that meets both stays within the limits it is taken. Else (noise, jumps, a
    vessel that starts elsewhere) the velocity is corrected by the position error, and never more
    than can be braked away again.
    """
    mean = (target_position - position) / dt
    start = (6.0 * mean - 4.0 * velocity - 2.0 * target_velocity) / dt
    end = (2.0 * velocity + 4.0 * target_velocity - 6.0 * mean) / dt
    hardest = max(float(np.linalg.norm(start)), float(np.linalg.norm(end)))
    fastest = max(float(np.linalg.norm(mean)), float(np.linalg.norm(target_velocity)))
    if hardest <= acceleration and fastest <= speed:
        return Motion(target_velocity.copy(), target_position.copy(), False)
    error = target_position - (position + 0.5 * (velocity + target_velocity) * dt)
    size = float(np.linalg.norm(error))
    wanted = target_velocity.copy()
    if size > 0.0:
        rate = min(TRACKING_RATE, 0.5 / dt)
        wanted += error / size * min(rate * size, math.sqrt(acceleration * size))
    applied = approached(velocity, clipped(wanted, speed), acceleration * dt)
    return Motion(applied, None, True)


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
