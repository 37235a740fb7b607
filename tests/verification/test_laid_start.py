"""Static starts of cable that friction holds where it was laid: on slopes, and across a current."""

import numpy as np
import pytest

import cablemodel as cm

TOLERANCE = 1e-3
LENGTH, DEPTH, WEIGHT = 500.0, 200.0, 17.41  # [m], [m], [N/m]


def lay(slope: float = 0.0, current: object = "none", friction: float = 0.4) -> cm.Scene:
    """A steady lay at 0.6 m/s towards x in 200 m of water, 500 m of cable out."""
    return cm.load_scene(
        {
            "environment": {
                "floor": {"z": -DEPTH, "slope": [slope, 0], "friction": friction},
                "current": current,
            },
            "cable_types": {
                "c": {
                    "diameter": 0.03, "mass": 2.5, "submerged_weight": WEIGHT,
                    "axial_stiffness": 20e6, "bending_stiffness": 200,
                }
            },
            "line": [{"cable": {"type": "c", "length": LENGTH}}],
            "vessel": {"velocity": [0.6, 0, 0]},
            "payout": {"rate": 0.6, "drum": [{"cable": {"type": "c", "length": 1000}}]},
            "solver": {"tolerance": TOLERANCE},
        }
    )  # fmt: skip


@pytest.mark.parametrize("slope", [-0.04, 0.04])
def test_cable_on_a_slope_stays_where_it_was_laid(slope: float) -> None:
    """Friction of 0.4 holds cable on a slope of 0.04; it slid to a heap of folds without."""
    model = cm.CableModel(lay(slope))
    touchdown, end = model.touchdown_position, model.tip_position
    # What lies is straight: as long as the way from the touchdown to the end.
    lying = float(np.linalg.norm(end - touchdown))
    assert lying == pytest.approx(model.floor_length, abs=2e-3 * LENGTH)
    behind = model.sample(np.linspace(LENGTH - 0.9 * lying, LENGTH, 300))
    assert np.all(behind.on_floor)
    assert np.max(behind.curvature) < 1e-3
    # Zajac's lay law: without tension where it lands, the vessel bears the weight down to there.
    assert model.top_tension == pytest.approx(-WEIGHT * touchdown[2], rel=0.01)
    model.step(60.0)
    assert np.linalg.norm(model.tip_position - end) < TOLERANCE * LENGTH


def test_a_lay_starts_in_a_cross_current() -> None:
    """What hangs is blown to the side; the lay lies straight, along the vessel's way, where it
    lands."""
    model = cm.CableModel(lay(current=[0.0, 0.3, 0.0]))
    end = model.tip_position
    assert model.touchdown_position[1] > 10.0
    assert abs(end[1] - model.touchdown_position[1]) < TOLERANCE * LENGTH
    for duration in (0.0, 900.0):
        if duration:
            model.step(duration)
        # Along any flexible cable the tension grows by its weight down to the touchdown, less the
        # drag along it, some 10 N here.
        whole = model.sample(np.linspace(0.0, model.line_length, 2000))
        touchdown = int(np.argmax(whole.on_floor))
        grown = model.top_tension - whole.tension[touchdown]
        assert grown == pytest.approx(WEIGHT * DEPTH, rel=10 * TOLERANCE)
        assert np.linalg.norm(model.tip_position - end) < TOLERANCE * LENGTH


def test_a_level_floor_in_still_water_starts_without_friction() -> None:
    one, other = cm.CableModel(lay()), cm.CableModel(lay(friction=0.0))
    assert np.array_equal(one.state().position, other.state().position)
