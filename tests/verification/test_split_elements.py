"""What an element is stretched by, and its tension does not say, is no tension of its pieces."""

import numpy as np
import pytest

import cablemodel as cm
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header

TOLERANCE = 1e-3
SLOW, FAST = 2.0578, 3.0867  # m/s: 4 and 6 knots
MORE = 1.03  # paid out, of the way of the ship


@pytest.mark.parametrize("length", [17961.5, 18200.0, 18600.0])
def test_an_element_at_a_winch_that_is_halved_does_not_kick(length: float) -> None:
    """A cable of 18 km is laid in 3,000 m, by a ship that has become faster: near 550 s the winch's
    element, 2.8 km long and slightly bent, is halved. Nothing else happens then. Ten outputs a
    second see what the halves do to the tension at the ship, which hardly changes.
    """
    faster = [{"t": time, "velocity": [speed, 0, 0]} for time, speed in ((60, SLOW), (360, FAST))]
    model = cm.CableModel(
        cm.load_scene(
            {
                "environment": {"floor": {"z": -3000}},
                "cable_types": {
                    "light": {
                        "diameter": 0.017, "mass": 0.55, "axial_stiffness": 8e6,
                        "drag_normal": 1.5, "drag_tangential": 0.005,
                    }
                },
                "line": [{"cable": {"type": "light", "length": length}}],
                "vessel": {"velocity": [{"t": 0, "velocity": [SLOW, 0, 0]}, *faster]},
                "payout": {
                    "rate": [
                        {"t": time, "rate": MORE * speed}
                        for time, speed in ((0, SLOW), (60, SLOW), (360, FAST))
                    ],
                    "drum": [{"cable": {"type": "light", "length": 2000}}],
                },
                "solver": {"tolerance": TOLERANCE},
            }
        )
    )  # fmt: skip
    model.step_to(500.0)
    lengths, tensions = [], []
    for time in np.arange(500.1, 560.0, 0.1):
        model.step_to(time)
        lengths.append(top_element(model))
        tensions.append(model.top_tension)
    assert min(np.diff(lengths)) < -1000.0
    promised = 10.0 * TOLERANCE * max(tensions)
    assert np.abs(tensions - np.median(tensions)).max() < 2.0 * promised


def top_element(model: cm.CableModel) -> float:
    """Length of the element at the winch [m]."""
    memory = model._solver.memory
    return float(memory.array(Header.edges, 2, at.EDGE_WORDS)[1, at.Edge.length])
