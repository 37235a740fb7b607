"""The lowest and the highest tension of a line are those of all that is given out of it."""

from __future__ import annotations

import numpy as np
import pytest

import cablemodel as cm

CABLE = {"diameter": 0.02, "mass": 1.0, "submerged_weight": 6.0, "axial_stiffness": "1 MN"}
ITEMS = [{"cable": {"type": "K", "length": 100, "elements": 5}}]


def line() -> cm.CableModel:
    return cm.CableModel(
        cm.load_scene({"cable_types": {"K": CABLE}, "line": ITEMS, "end": {"anchor": [80, 0, 0]}})
    )


def test_the_lowest_tension_of_a_line_may_be_within_an_element() -> None:
    """A catenary's is at its lowest point, in the middle of the third of five elements."""
    model = line()
    tension = model.sample(np.linspace(0.0, model.line_length, 1001)).tension
    assert model.tension_min == pytest.approx(tension.min(), rel=1e-9)
    assert model.tension_max == pytest.approx(tension.max(), rel=1e-6)
    ends = model.state().tension
    assert tension.min() < 0.98 * ends.min()


def test_and_that_of_a_line_of_a_system() -> None:
    system = cm.SystemModel(
        cm.load_system(
            {
                "cable_types": {"K": CABLE},
                "vessels": {"ship": {"points": {"hook": [0, 0, 0]}}},
                "lines": {"leg": {"from": {"anchor": [80, 0, 0]}, "to": "ship.hook",
                                  "items": ITEMS}},
            }
        )
    )  # fmt: skip
    leg = system.lines["leg"]
    lowest, highest = leg.tension_range
    tension = leg.sample(np.linspace(0.0, leg.length, 1001)).tension
    assert lowest == pytest.approx(tension.min(), rel=1e-9)
    assert highest == pytest.approx(tension.max(), rel=1e-6)
    outputs = system.outputs()
    assert (lowest, highest) == (outputs["leg.tension_min"], outputs["leg.tension_max"])
    assert lowest == pytest.approx(line().tension_min, rel=1e-3)


def test_the_highest_is_not_below_the_force_at_the_top() -> None:
    """Which has the shear, too: of a line that is clamped across its pull it is all of that; it is
    no tension that would be the lowest."""
    scene = cm.load_scene(
        {
            "cable_types": {"K": {**CABLE, "bending_stiffness": 500}},
            "line": [{"cable": {"type": "K", "length": 100}}],
            "vessel": {"connection": {"clamped": [1, 0, 0.02]}},
        }
    )
    model = cm.CableModel(scene)
    assert model.top_tension == pytest.approx(-600.0, rel=1e-3)
    assert model.tension_max >= abs(model.top_tension) * 0.9
    assert model.tension_min == pytest.approx(model.state().tension.min())
    assert model.tension_min > -50.0
