"""Flexible cable over a floor that goes slack and snaps: legs of moorings, a load that lands.

They ended in a StepError where slack that lies was limp, in a third to all of such runs.
"""

from typing import Any

import numpy as np
import pytest

import cablemodel as cm

G, WATER = 9.80665, 1025.0


def chain_leg(tolerance: float, interval: float) -> dict[str, Any]:
    """A chain from a fairlead that surges by 4 m and heaves by 1 m in 9 s, to an anchor."""
    period = 9.0
    w = 2.0 * np.pi / period
    times = np.arange(0.0, 41.0, period / 40.0)
    ramp = np.clip(times / (2.0 * period), 0.0, 1.0)
    speed = w * np.cos(w * times) * ramp * ramp * (3.0 - 2.0 * ramp)
    rows = zip(times.tolist(), speed.tolist(), strict=True)
    chain = {
        "diameter": 0.09, "mass": 38.0, "submerged_weight": 330.0, "axial_stiffness": 2.2e8,
        "drag_normal": 2.0, "drag_tangential": 0.3,
    }  # fmt: skip
    return {
        "environment": {"floor": {"z": -60.0, "friction": 0.5}},
        "cable_types": {"chain": chain},
        "line": [{"cable": {"type": "chain", "length": 220.0}}],
        "vessel": {"velocity": [{"t": t, "velocity": [4.0 * v, 0, v]} for t, v in rows]},
        "end": {"anchor": [195.0, 0, -60.0]},
        "solver": {"tolerance": tolerance},
        "run": {"duration": 40.0, "output_interval": interval},
    }


def test_a_chain_that_surges_and_goes_slack_comes_to_its_end() -> None:
    """At any tolerance, and at outputs that let steps be long, or make them short."""
    peaks = {}
    for tolerance in (1e-3, 3e-4, 1e-4):
        for interval in (0.05, 0.5):
            run = cm.simulate(cm.load_scene(chain_leg(tolerance, interval)))
            assert run.time[-1] == 40.0
            peaks[tolerance, interval] = run.top_tension.max()
    fine = peaks[1e-4, 0.05]
    assert fine > 50e3
    for (tolerance, interval), peak in peaks.items():
        missed = 0.01 if interval > 0.1 else 0.0  # between outputs
        assert peak == pytest.approx(fine, rel=10.0 * (tolerance + 1e-4) + missed)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
@pytest.mark.parametrize("interval", [0.1, 1.0])
def test_a_load_lands_and_is_lifted(tolerance: float, interval: float) -> None:
    """5 t on wire, 200 m down and up again: by the weights, and the drag of the way up."""
    diameter, mass, weight, area = 0.026, 2.7, 3.6e4, 4.0
    wire = {
        "diameter": diameter, "mass": mass, "axial_stiffness": 30e6, "drag_normal": 1.2,
        "drag_tangential": 0.01,
    }  # fmt: skip
    load = {
        "mass": 5000, "submerged_weight": weight, "added_mass": 3000, "added_mass_axial": 3000,
        "drag_area": area, "drag_area_axial": area, "drag_coefficient": 1.0,
        "drag_coefficient_axial": 1.0,
    }  # fmt: skip
    rates = [(0, 0), (10, 0), (11, 0.5), (60, 0.5), (61, 0), (120, 0), (122, -0.4), (180, -0.4)]
    scene = {
        "environment": {"floor": {"z": -200.0, "friction": 0.6}},
        "cable_types": {"wire": wire},
        "line": [{"cable": {"type": "wire", "length": 180.0}}, {"body": load}],
        "payout": {
            "drum": [{"cable": {"type": "wire", "length": 60.0}}],
            "rate": [{"t": t, "rate": rate} for t, rate in rates],
        },
        "solver": {"tolerance": tolerance},
        "run": {"duration": 180.0, "output_interval": interval},
    }
    run = cm.simulate(cm.load_scene(scene))
    hangs = mass * G - WATER * G * np.pi / 4.0 * diameter**2
    promise = 10.0 * tolerance * run.top_tension.max()
    landed = (run.time > 90.0) & (run.time < 118.5)
    assert run.top_tension[landed] == pytest.approx(hangs * 200.0, abs=promise)
    lifted = (run.time > 165.0) & (run.time < 178.0)
    length = 205.5 - 1.0 - 0.4 - 0.4 * (run.time[lifted] - 122.0)
    skin = 0.01 * np.pi * diameter * length
    expected = weight + hangs * length + 0.5 * WATER * 0.4**2 * (area + skin)
    assert run.top_tension[lifted].mean() == pytest.approx(expected.mean(), abs=promise)
