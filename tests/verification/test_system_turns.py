"""A vessel that is led along a path turns with its track, at a rate that does not jump."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

import cablemodel as cm

SPEED, RADIUS, STRAIGHT, ANGLE = 3.0, 40.0, 5.0, 0.6
TURNS = ANGLE * RADIUS / SPEED
ARM = np.array([-15.0, 4.0, 0.0])
G, MASS, LENGTH, STIFFNESS = 9.81, 500.0, 30.0, 2e6
PATH = [
    {"straight": {"duration": STRAIGHT, "speed": SPEED}},
    {"turn": {"angle": ANGLE, "radius": RADIUS}},
]


def towed(**vessel: Any) -> dict[str, Any]:
    """A load on a light wire below a fairlead, in a vacuum."""
    wire = {"diameter": 0.01, "mass": 0.01, "axial_stiffness": STIFFNESS}
    load = {"body": {"mass": MASS, "submerged_weight": MASS * G, "drag_area": 0.0}}
    items = [{"cable": {"type": "wire", "length": LENGTH}}, load]
    return {
        "environment": {"water_density": 0.0, "gravity": G},
        "cable_types": {"wire": wire},
        "vessels": {"tug": {"points": {"stern": ARM.tolist()}, "path": PATH, **vessel}},
        "lines": {"tow": {"from": "tug.stern", "to": "free", "items": items}},
    }


def track(t: float) -> float:
    """Heading of the track [rad]."""
    return ANGLE * min(1.0, max(0.0, (t - STRAIGHT) / TURNS))


def heading(t: float, span: float) -> float:
    """Its mean, weighed by a triangle over a span of time about t."""
    half = 0.5 * span
    kinks = [s for s in (STRAIGHT - t, STRAIGHT + TURNS - t, 0.0) if abs(s) < half]
    mean = quad(lambda s: (half - abs(s)) * track(t + s), -half, half, points=kinks or None)[0]
    return float(mean / half**2)


@pytest.mark.parametrize("span", [None, 1.0, 10.0])
def test_the_heading_is_that_of_the_track_averaged(span: float | None) -> None:
    """Also where both kinks are within the time that it takes."""
    model = cm.SystemModel(towed(**({} if span is None else {"turn_time": span})))
    for t in np.arange(0.25, 16.0, 0.25):
        model.step_to(t)
        yaw = heading(t, span or 4.0)
        rate = (heading(t + 1e-4, span or 4.0) - heading(t - 1e-4, span or 4.0)) / 2e-4
        assert model.vessels["tug"].attitude[2] == pytest.approx(yaw, abs=1e-9)
        assert model.vessels["tug"].angular_velocity[2] == pytest.approx(rate, abs=1e-7)


def test_a_heading_that_jumps_at_standstill_takes_its_time() -> None:
    """By half a turn in 8 s: the rate rises evenly, to twice the mean."""
    rest = {"straight": {"duration": 10.0, "speed": 0.0}}
    away = {"straight": {"duration": 10.0, "speed": 1.0, "heading": math.pi / 2}}
    model = cm.SystemModel(towed(path=[rest, away], turn_time=8.0))
    yaws, rates = [], []
    for t in (6.0, 8.0, 10.0, 12.0, 14.0):
        model.step_to(t)
        yaws.append(model.vessels["tug"].attitude[2])
        rates.append(model.vessels["tug"].angular_velocity[2])
    peak = 2.0 * (math.pi / 2) / 8.0
    assert rates == pytest.approx([0.0, peak / 2, peak, peak / 2, 0.0], abs=1e-12)
    assert yaws == pytest.approx(math.pi / 2 * np.array([0, 0.125, 0.5, 0.875, 1]), abs=1e-12)


def test_a_load_below_a_fairlead_swings_as_its_equation_says() -> None:
    """A mass on a spring, hung from an arm of the vessel; without the time to turn, the fairlead's
    velocity would jump by 1.2 m/s."""
    span, until = 4.0, 20.0
    times = np.arange(0.0, until + 1e-9, 5e-3)
    yaws = np.array([heading(t, span) for t in times])
    ways = np.array([track(t) for t in times])
    before = np.clip(times, 0.0, STRAIGHT) * SPEED
    after = np.clip(times - STRAIGHT - TURNS, 0.0, None) * SPEED
    x = before + RADIUS * np.sin(ways) + after * np.cos(ANGLE)
    y = RADIUS * (1.0 - np.cos(ways)) + after * np.sin(ANGLE)
    held = np.column_stack([
        x + np.cos(yaws) * ARM[0] - np.sin(yaws) * ARM[1],
        y + np.sin(yaws) * ARM[0] + np.cos(yaws) * ARM[1],
        np.zeros_like(x),
    ])  # fmt: skip

    def motion(t: float, state: np.ndarray) -> np.ndarray:
        hook = np.array([np.interp(t, times, held[:, k]) for k in range(3)])
        way = state[:3] - hook
        size = float(np.linalg.norm(way))
        pull = STIFFNESS * (size / LENGTH - 1.0)
        return np.concatenate([state[3:], -pull / MASS * way / size - [0.0, 0.0, G]])

    start = [*ARM[:2], -LENGTH * (1.0 + MASS * G / STIFFNESS), SPEED, 0.0, 0.0]
    outputs = np.arange(1.0, until)
    run = solve_ivp(
        motion, (0.0, until), start, t_eval=outputs, rtol=1e-8, atol=1e-8, max_step=0.02
    )
    model = cm.SystemModel(towed(turn_time=span))
    for t, place in zip(run.t, run.y[:3].T, strict=True):
        model.step_to(t)
        found = model.lines["tow"].sample([LENGTH]).position[0]
        assert found == pytest.approx(place, abs=1e-3 * LENGTH)


def test_a_vessel_that_waits_lies_on_the_heading_of_its_first_leg() -> None:
    """It gets under way without a turn, and so does what it tows: turned by as much, a scene is
    the same."""
    turn = 0.9
    models = []
    for heading in (0.0, turn):
        legs = [
            {"straight": {"duration": 5.0, "speed": 0.0, "heading": heading}},
            {"straight": {"duration": 10.0, "speed": 1.0}},
        ]
        models.append(cm.SystemModel(towed(path=legs)))
    c, s = math.cos(turn), math.sin(turn)
    way = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    for t in (0.0, 4.0, 5.0, 7.0, 12.0):
        for model in models if t > 0.0 else ():
            model.step_to(t)
        _ahead, turned = models
        assert turned.vessels["tug"].attitude[2] == pytest.approx(turn, abs=1e-12)
        ends = [model.lines["tow"].sample([0.0, LENGTH]).position for model in models]
        assert ends[1] == pytest.approx(ends[0] @ way.T, abs=1e-5)


@pytest.mark.parametrize(
    ("vessel", "message"),
    [
        ({"turn_time": 0}, "turn_time"),
        ({"turn_time": 11}, "turns at 5 s"),
        ({"path": None, "turn_time": 4}, "path"),
    ],
)
def test_a_time_to_turn_that_cannot_be_is_refused(vessel: dict[str, Any], message: str) -> None:
    with pytest.raises(cm.SceneError, match=message):
        cm.SystemModel(towed(**vessel))


def test_a_turn_soon_after_the_start_is_taken_in_less_time() -> None:
    """Unless the scene says how long."""
    path = [{"straight": {"duration": 0.5, "speed": SPEED}}, PATH[1]]
    model = cm.SystemModel(towed(path=path))
    model.step_to(1.0)
    assert model.vessels["tug"].angular_velocity[2] == pytest.approx(SPEED / RADIUS, abs=1e-12)
