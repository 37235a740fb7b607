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


WIRE = {
    "diameter": 0.1, "mass": 29.0, "axial_stiffness": 1.9e8, "bending_stiffness": 2600.0,
    "drag_normal": 1.2, "drag_tangential": 0.01,
}  # fmt: skip
LOAD = {"mass": 600.0, "submerged_weight": 4000.0, "drag_area": 0.4, "drag_coefficient": 0.6}
ROPE = {"diameter": 0.018, "mass": 0.7, "axial_stiffness": 3e7, "drag_normal": 1.3}
FISH = {"mass": 120.0, "submerged_weight": 800.0, "drag_area": 0.15, "drag_coefficient": 1.0}


def off_by(scene: dict, tolerance: float, times: np.ndarray) -> float:
    """By how much the tension at the top differs from a run sixteen times as fine [promises]."""
    runs = [
        cm.CableModel({**scene, "solver": {"tolerance": finer}})
        for finer in (tolerance, tolerance / 16.0)
    ]
    off, largest = [], 0.0
    for time in times:
        for run in runs:
            run.step_to(float(time))
        off.append(runs[0].top_tension - runs[1].top_tension)
        largest = max(largest, runs[1].tension_max)
    return float(np.abs(off).max()) / (10.0 * tolerance * largest)


@pytest.mark.parametrize("current", [1.0, 3.0])
@pytest.mark.parametrize("model", ["hybrid", "cable"])
def test_a_wire_that_hangs_in_a_current_rings_no_otherwise_for_being_split(model, current):
    """Its elements bend, and are halved as its winch begins: what a cubic is stretched by is no
    tension of its halves. (With positions brought to tensions it rang by 4 to 17 promises.)"""
    scene = {
        "environment": {"current": [current, 0, 0]},
        "cable_types": {"wire": WIRE},
        "line": [{"cable": {"type": "wire", "length": 60.0, "model": model}}, {"body": LOAD}],
        "payout": {
            "drum": [{"cable": {"type": "wire", "length": 40.0, "model": model}}],
            "rate": [{"t": 0, "rate": 0}, {"t": 1, "rate": 0}, {"t": 4.6, "rate": 0.3}],
        },
    }
    assert off_by(scene, 2e-4, 0.01 * np.arange(1, 251)) < 1.25


@pytest.mark.parametrize(("current", "rate"), [(2.0, -0.3), (3.0, 0.3)])
def test_a_ring_goes_on_alike_as_a_wire_bends(current: float, rate: float) -> None:
    """Its winch slows down and stops: waves run along it, to and fro, and meanwhile it bends less
    and less. What that does to the modes of its elements is no tension. (It was, of modes as stiff
    as waves want them: 9.4 promises.)"""
    scene = {
        "environment": {"current": [current, 0, 0]},
        "cable_types": {"wire": WIRE},
        "line": [{"cable": {"type": "wire", "length": 60.0}}, {"body": LOAD}],
        "payout": {
            "drum": [{"cable": {"type": "wire", "length": 40.0}}],
            "rate": [
                {"t": 0, "rate": 0}, {"t": 2, "rate": 0}, {"t": 5.6, "rate": rate},
                {"t": 20, "rate": rate}, {"t": 22, "rate": 0},
            ],
        },
    }  # fmt: skip
    assert off_by(scene, 2e-4, np.arange(0.05, 26.0, 0.05)) < 1.25


@pytest.mark.parametrize("current", [0.25, 0.5])
def test_a_heaving_ship_shakes_a_rope_in_a_bow(current: float) -> None:
    """Ramps of the velocity send waves along a rope that is bowed and bends as they run. (They
    were 1.1 and 5.1 promises off.)"""
    heave = ((0, 0), (2, 0), (4, 0.4), (6, -0.4), (8, 0))
    scene = {
        "environment": {"current": [current, 0, 0]},
        "cable_types": {"rope": ROPE},
        "line": [{"cable": {"type": "rope", "length": 150.0}}, {"body": FISH}],
        "vessel": {"velocity": [{"t": time, "velocity": [0, 0, up]} for time, up in heave]},
    }
    assert off_by(scene, 1e-3, np.arange(0.02, 10.0, 0.02)) < 1.0


def top_element(model: cm.CableModel) -> float:
    """Length of the element at the winch [m]."""
    memory = model._solver.memory
    return float(memory.array(Header.edges, 2, at.EDGE_WORDS)[1, at.Edge.length])
