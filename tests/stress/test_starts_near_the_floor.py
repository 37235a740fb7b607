"""Static starts of lines whose ends are on a sea floor, or near it: a start, or an error in words.

The random search draws tow points well above the floor; ValueErrors and numbers that are none came
from those on it.
"""

import math
from typing import Any

import numpy as np
import pytest

import cablemodel as cm
from tests.verification.scenes import CABLE_K

SEEDS = range(60)


def drawn(seed: int) -> dict[str, Any]:
    """A line with its tow point on the floor or a little above it, free, or anchored near by."""
    draw = np.random.default_rng(seed)
    length = float(10.0 ** draw.uniform(0.5, 2.0))
    depth = length * float(draw.uniform(0.05, 1.2))
    slope = [float(x) for x in draw.choice([0.0, 0.05, -0.2], 2)]
    height = float(draw.choice([0.0, 1e-9, 1e-4, 0.01, 0.3])) * depth
    cable = {**CABLE_K, "bending_stiffness": float(draw.choice([0.0, 0.1, 10.0]))}
    scene: dict[str, Any] = {
        "environment": {
            "floor": {"z": -depth, "slope": slope, "friction": float(draw.choice([0.3, 1.0]))}
        },
        "cable_types": {"K": cable},
        "line": [{"cable": {"type": "K", "length": length}}],
        "vessel": {"position": [0.0, 0.0, height - depth]},
        "solver": {"tolerance": float(draw.choice([1e-2, 1e-3]))},
    }
    if draw.random() < 0.3:
        scene["environment"]["current"] = [*(float(x) for x in draw.uniform(-0.3, 0.3, 2)), 0.0]
    if draw.random() < 0.3:
        body = {"mass": 5.0, "submerged_weight": 20.0, "drag_area": 0.03}
        scene["line"].append({"body": {**body, "half_length": float(draw.choice([0.0, 0.02]))}})
    if draw.random() < 0.5:
        across = length * float(draw.choice([0.0, 0.3, 0.99, 1.0, 1.001]))
        way = float(draw.uniform(0.0, 2.0 * math.pi))
        x, y = across * math.cos(way), across * math.sin(way)
        above = float(draw.choice([0.0, 0.1, 1.0])) * depth
        scene["end"] = {"anchor": [x, y, slope[0] * x + slope[1] * y - depth + above]}
    elif draw.random() < 0.3:
        reel = {"rate": -0.3, "drum": [{"cable": {"type": "K", "length": length}}]}
        scene["payout"] = reel
    return scene


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_each_starts_or_says_why_not() -> None:
    started = 0
    for seed in SEEDS:
        try:
            model = cm.CableModel(cm.load_scene(drawn(seed)))
        except (cm.SceneError, cm.StaticsError):
            continue
        started += 1
        state = model.state()
        assert np.isfinite(state.position).all(), seed
        assert np.isfinite(model.top_tension), seed
        model.step(1.0)
        assert np.isfinite(model.state().velocity).all(), seed
    assert started > 0.5 * len(SEEDS)
