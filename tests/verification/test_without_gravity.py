"""Nothing pulls at a line: no weight, no current, no motion. It has a start all the same, by its
own stiffness, or what it lacks is said."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import ellipe, ellipk

import cablemodel as cm

LENGTH = 70.0
EI = 5.0
ANCHOR = [60.0, 0.0, -20.0]


def line(bending_stiffness: float = EI, **changes: Any) -> dict[str, Any]:
    return {
        "environment": {"gravity": 0.0},
        "cable_types": {
            "c": {
                "diameter": 0.02,
                "mass": 0.9,
                "axial_stiffness": 5e6,
                "bending_stiffness": bending_stiffness,
            }
        },
        "line": [{"cable": {"type": "c", "length": LENGTH}}],
        **changes,
    }


def test_between_its_ends_it_is_eulers_elastica() -> None:
    """Pinned ends nearer than the line is long: chord/L = 2 E(k)/K(k) - 1, P = 4 K(k)^2 EI/L^2."""
    model = cm.CableModel(cm.load_scene(line(end={"anchor": ANCHOR})))
    chord = float(np.linalg.norm(ANCHOR))
    k = brentq(lambda k: 2 * ellipe(k**2) / ellipk(k**2) - 1 - chord / LENGTH, 0.01, 0.9)
    load = 4 * ellipk(k**2) ** 2 * EI / LENGTH**2
    tolerance = 10 * model.scene.solver.tolerance
    assert np.linalg.norm(model.top_force) == pytest.approx(load, rel=tolerance)
    assert model.top_tension == pytest.approx(-load, rel=tolerance)  # it pushes
    model.step(10.0)
    assert np.linalg.norm(model.top_force) == pytest.approx(load, rel=tolerance)


@pytest.mark.parametrize("stiffness", [EI, 0.0])
@pytest.mark.parametrize(
    "start", [{}, {"initial": {"straight": [1.0, 0.0, -0.5]}}], ids=["hung", "straight"]
)
def test_a_free_line_stays_where_it_begins(stiffness: float, start: dict[str, Any]) -> None:
    model = cm.CableModel(cm.load_scene(line(stiffness, **start)))
    before = model.tip_position
    assert np.linalg.norm(before) == pytest.approx(LENGTH)
    model.step(10.0)
    np.testing.assert_allclose(model.tip_position, before, atol=1e-6 * LENGTH)
    assert abs(model.top_tension) < 1e-6


def test_one_that_is_drawn_has_its_start() -> None:
    points = [[0.0, 0.0, 0.0], [35.0, 0.0, -12.0], ANCHOR]
    data = line(initial={"points": points}, end={"anchor": ANCHOR})
    model = cm.CableModel(cm.load_scene(data))
    np.testing.assert_allclose(model.tip_position, ANCHOR)
    model.step(0.5)
    np.testing.assert_allclose(model.tip_position, ANCHOR)


def test_slack_without_stiffness_has_no_shape_and_says_so() -> None:
    with pytest.raises(cm.StaticsError, match=r"along the cable\. Tried: .*\. Check weights"):
        cm.CableModel(cm.load_scene(line(0.0, end={"anchor": ANCHOR})))
