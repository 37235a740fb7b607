"""Motion that the node applies: within its limits, without drift, and to rest in time."""

from __future__ import annotations

import numpy as np
import pytest
from cablemodel_ros.limits import follow_position, follow_rate, follow_velocity
from hypothesis import given
from hypothesis import strategies as st

DT = 0.01
SPEED, ACCELERATION = 3.0, 0.5

numbers = st.floats(-20.0, 20.0)
vectors = st.tuples(numbers, numbers, numbers).map(np.array)


@given(vectors, vectors)
def test_velocity_stays_within_speed_and_acceleration(
    velocity: np.ndarray, target: np.ndarray
) -> None:
    motion = follow_velocity(velocity, target, DT, SPEED, ACCELERATION)
    change = np.linalg.norm(motion.velocity - velocity)
    assert change <= ACCELERATION * DT * (1 + 1e-9)
    if np.linalg.norm(velocity) <= SPEED:
        assert np.linalg.norm(motion.velocity) <= SPEED * (1 + 1e-9)


def test_velocity_ramps_at_the_acceleration_and_arrives_exactly() -> None:
    velocity, target = np.zeros(3), np.array([0.6, 0.8, 0.0])
    steps = 0
    while not np.array_equal(velocity, target):
        velocity = follow_velocity(velocity, target, DT, SPEED, ACCELERATION).velocity
        steps += 1
    assert steps == pytest.approx(1.0 / (ACCELERATION * DT), abs=1)


def track(course, seconds: float, noise: float = 0.0, start=(0.0, 0.0, 0.0)):
    """Follow a course(t) -> position, velocity; gives errors, speeds and accelerations."""
    random = np.random.default_rng(1)
    position, velocity = np.array(start, float), np.zeros(3)
    errors, speeds, accelerations = [], [], []
    for k in range(1, round(seconds / DT) + 1):
        place, speed = course(k * DT)
        seen = place + noise * random.standard_normal(3)
        motion = follow_position(position, velocity, seen, speed, DT, SPEED, ACCELERATION)
        accelerations.append(np.linalg.norm(motion.velocity - velocity) / DT)
        if motion.position is not None:
            position = motion.position
        else:
            position = position + 0.5 * (velocity + motion.velocity) * DT
        velocity = motion.velocity
        errors.append(np.linalg.norm(position - place))
        speeds.append(np.linalg.norm(velocity))
    return np.array(errors), np.array(speeds), np.array(accelerations)


def circle(t: float):
    rate = 0.1
    position = np.array([10 * np.sin(rate * t), 10 - 10 * np.cos(rate * t), 0.0])
    return position, np.array([np.cos(rate * t), np.sin(rate * t), 0.0])


def test_a_course_that_begins_elsewhere_is_caught_up_and_then_met_exactly() -> None:
    errors, speeds, accelerations = track(circle, 60.0, start=(-3.0, 1.0, 0.0))
    assert errors[-1] < 1e-9
    assert speeds.max() <= SPEED + 1e-9
    assert accelerations.max() <= ACCELERATION * (1 + 1e-9)


def test_noise_in_position_neither_shakes_the_vessel_nor_lets_it_drift() -> None:
    errors, _, accelerations = track(circle, 120.0, noise=0.02)
    assert accelerations.max() <= ACCELERATION * (1 + 1e-9)
    assert errors[len(errors) // 4 :].max() < 0.02


@given(st.floats(-30, 30), st.floats(0.0, 100.0), st.floats(0.0, 100.0))
def test_payout_never_uses_up_what_is_left(wanted: float, out: float, back: float) -> None:
    rate, left, line = 0.0, out, back
    for _ in range(3000):
        new = follow_rate(rate, wanted, DT, 5.0, 1.0, left, line)
        assert abs(new - rate) <= 1.0 * DT + 1e-12
        assert abs(new) <= 5.0
        left -= 0.5 * (rate + new) * DT
        line += 0.5 * (rate + new) * DT
        rate = new
    assert left >= -1e-3
    assert line >= -1e-3
