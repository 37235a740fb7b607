"""Tensions that a long step solves for from positions and velocities at its end.

Each scene is made twice: read at its own steps, which are as long as the tolerance allows, and in
steps so short that none is solved for.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import cablemodel as cm
from benchmarks.random_scenes.ordinary import drawn


def heave(amplitude: float, period: float, duration: float, **towed: float) -> dict[str, Any]:
    """A vessel's motion, as velocities at 40 times a period joined by cubics."""
    rate = 2.0 * math.pi / period
    times = np.arange(0.0, duration + period, period / 40.0)
    grown = np.minimum(times / (2.0 * period), 1.0)
    up = amplitude * rate * grown**2 * (3.0 - 2.0 * grown) * np.sin(rate * times)
    points = [
        {"t": float(t), "velocity": [towed.get("speed", 0.0), 0.0, float(v)]}
        for t, v in zip(times, up, strict=True)
    ]
    return {"interpolation": "cubic", "velocity": points}


def largest_error(scene: dict[str, Any], interval: float, duration: float, parts: int) -> float:
    """Of the top tension at the ends of the intervals, beside a run in so many parts of each, over
    ten tau of the largest."""
    tops = []
    for split in (1, parts):
        model = cm.CableModel(cm.load_scene(scene))
        found = []
        for k in range(1, round(duration / interval) + 1):
            for part in range(1, split + 1):
                model.step_to((k - 1 + part / split) * interval)
            found.append(model.top_tension)
        tops.append(np.array(found))
    tau = scene["solver"]["tolerance"]
    return float(np.abs(tops[0] - tops[1]).max() / (10.0 * tau * tops[1].max()))


@pytest.mark.parametrize("interval", [1.0, 1.9])
def test_of_a_weight_that_is_towed_in_heave(interval: float) -> None:
    """Drag holds the wire across itself within hundredths of a second: velocities that meet the
    stretch must leave it there, or accelerations across it are wrong, and with them the tension."""
    scene = {
        "cable_types": {
            "wire": {
                "diameter": 0.013, "mass": 0.64, "axial_stiffness": 6.6e6, "drag_normal": 1.46,
                "drag_tangential": 0.014,
            }
        },
        "line": [
            {"cable": {"type": "wire", "length": 88.0}},
            {
                "body": {
                    "mass": 680.0, "submerged_weight": 5650.0, "added_mass": 95.0,
                    "added_mass_axial": 63.0, "drag_area": 0.26, "drag_coefficient": 1.05,
                }
            },
        ],
        "vessel": heave(0.27, 11.6, 80.0, speed=1.55),
        "solver": {"tolerance": 1.6e-4},
    }  # fmt: skip
    assert largest_error(scene, interval, 80.0, 20) < 0.5


def test_of_cable_whose_tension_falls_by_all_of_it_in_a_second() -> None:
    """The rate at which tensions change stretches cable as it does now, not as it would in a
    second's time, by when it would be slack."""
    scene = drawn(871).scene
    assert largest_error(scene, scene["run"]["output_interval"], 1.6, 10) < 1.0
