"""Motion that the node applies: within its limits, without drift, and to rest in time."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from cablemodel_ros.commands import Commands
from cablemodel_ros.helm import Helm, Present
from cablemodel_ros.limits import follow_rate, follow_velocity
from cablemodel_ros.settings import Settings
from clocks_by_hand import Clocks
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


def track(
    course: Any, seconds: float, noise: float = 0.0, start: Any = (0.0, 0.0, 0.0), **values: Any
) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
    """Follow a course(t) -> position, velocity as the node does: samples at 50 Hz, steps at 100.

    Gives errors, speeds, accelerations, and the share of steps with a limit at work.
    """
    random = np.random.default_rng(1)
    clocks = Clocks(ros=1.0, up=0.0)
    settings = Settings.of(
        {"limits.speed": SPEED, "limits.acceleration": ACCELERATION, "limits.position_jump": 100.0,
         "payout_input": "scene", **values}
    )  # fmt: skip
    commands = Commands(settings, clocks.timebase)
    helm = Helm(settings, commands)
    position, velocity = np.array(start, float), np.zeros(3)
    errors, speeds, accelerations = [], [], []
    steps = round(seconds / DT)
    for k in range(steps):
        if k % 2 == 0:
            place, speed = course(k * DT)
            seen = place + noise * random.standard_normal(3)
            refusal = commands.take_odometry(
                clocks.ros, "map", "map", seen, (0, 0, 0, 1), speed, (0, 0, 0)
            )
            assert refusal == ""
        clocks.wait(DT)
        present = Present(position, velocity, 0.0, 50.0, 0.0)
        applied = helm.inputs(clocks.timebase.now(), DT, present)
        assert applied.velocity is not None
        accelerations.append(np.linalg.norm(applied.velocity - velocity) / DT)
        position = position + 0.5 * (velocity + applied.velocity) * DT
        velocity = applied.velocity
        errors.append(np.linalg.norm(position - course((k + 1) * DT)[0]))
        speeds.append(np.linalg.norm(velocity))
    return np.array(errors), np.array(speeds), np.array(accelerations), helm.limited / steps


def circle(t: float) -> tuple[np.ndarray, np.ndarray]:
    rate = 0.1
    position = np.array([10 * np.sin(rate * t), 10 - 10 * np.cos(rate * t), 0.0])
    return position, np.array([np.cos(rate * t), np.sin(rate * t), 0.0])


def heaving(t: float) -> tuple[np.ndarray, np.ndarray]:
    """One metre up and down in six seconds, at a knot."""
    w = 2.0 * np.pi / 6.0
    return np.array([0.5 * t, 0.0, np.sin(w * t)]), np.array([0.5, 0.0, w * np.cos(w * t)])


def test_a_course_that_begins_elsewhere_is_caught_up_and_then_met() -> None:
    errors, speeds, accelerations, _ = track(circle, 60.0, start=(-3.0, 1.0, 0.0))
    assert errors[-1] < 1e-3
    assert speeds.max() <= SPEED + 1e-9
    assert accelerations.max() <= ACCELERATION * (1 + 1e-9)


def test_a_course_of_steady_acceleration_is_met_exactly() -> None:
    def speeding_up(t: float) -> tuple[np.ndarray, np.ndarray]:
        return np.array([0.1 * t * t, 0.0, 0.0]), np.array([0.2 * t, 0.0, 0.0])

    errors, _, _, limited = track(speeding_up, 12.0)
    assert errors[-1] < 1e-9
    assert limited == 0.0


def test_noise_in_position_neither_shakes_the_vessel_nor_lets_it_drift() -> None:
    errors, _, accelerations, _ = track(circle, 120.0, noise=0.02)
    assert accelerations.max() <= ACCELERATION * (1 + 1e-9)
    assert errors[len(errors) // 4 :].max() < 0.02


@pytest.mark.parametrize("noise", [0.0, 0.005, 0.01])
def test_at_default_limits_a_vessel_in_a_seaway_is_met_and_no_limit_is_at_work(
    noise: float,
) -> None:
    errors, _, _, limited = track(
        heaving, 60.0, noise, **{"limits.acceleration": 2.0, "limits.speed": 10.0}
    )
    assert limited < 0.02
    assert errors[1000:].max() < 0.012 + noise


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
