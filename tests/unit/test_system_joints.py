"""Tension of a system's line where it jumps: at bodies, branches, other cables."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import cablemodel as cm

SCENE: dict[str, Any] = {
    "cable_types": {
        "wire": {"diameter": 0.02, "mass": 2.0, "axial_stiffness": 1e7},
        "rope": {"diameter": 0.03, "mass": 0.9, "axial_stiffness": 1e6},
    },
    "vessels": {"ship": {"points": {"eye": [0, 0, 0]}}},
    "lines": {
        "up": {
            "from": {"anchor": [0, 0, -100]},
            "to": "ship.eye",
            "items": [
                {"cable": {"type": "wire", "length": 50}},
                {"body": {"mass": 200, "submerged_weight": -10000}},
                {"cable": {"type": "rope", "length": 49}},
            ],
        },
        "side": {
            "from": {"line": "up", "at": 20},
            "to": {"anchor": [30, 0, -90]},
            "items": [{"cable": {"type": "wire", "length": 31}}],
        },
    },
}


def test_the_highest_tension_is_that_below_a_float() -> None:
    """Ten kilonewtons of buoyancy are in the wire below, and not in the rope above."""
    model = cm.SystemModel(SCENE)
    line = model.lines["up"]
    below, above = line.sample([50.0 - 1e-7, 50.0]).tension
    assert below - above == pytest.approx(10e3, rel=0.01)
    outputs = model.outputs()
    assert outputs["up.tension_max"] == pytest.approx(below, rel=1e-6)
    assert line.tension_range == (outputs["up.tension_min"], outputs["up.tension_max"])


def test_states_have_both_sides_of_every_joint() -> None:
    model = cm.SystemModel(SCENE)
    assert model.scene.joints_along("up") == [20.0, 50.0]
    state = model.lines["up"].sample()
    for arc in (20.0, 50.0):
        before, after = np.flatnonzero(np.abs(state.s - arc) < 1e-9)
        assert state.position[before] == pytest.approx(state.position[after], abs=1e-9)
        assert abs(state.tension[before] - state.tension[after]) > 1.0
    assert np.all(np.diff(state.s) >= 0.0)


def test_a_line_that_is_drawn_has_its_kink_at_the_branch_and_no_other_bend() -> None:
    """Stations between nodes: beside the branch the wire is as straight as where it hangs."""
    run = cm.simulate(SCENE, until=1.0)
    even = run.lines["up"].resampled(397)  # a station every 25 cm
    place = even.position[0]
    turn = np.linalg.norm(np.diff(place, 2, axis=0), axis=1)
    kinks = np.flatnonzero(turn > 1e-3)
    assert set(np.round(even.s[0][kinks + 1])) <= {20.0, 50.0}
    assert 20.0 in np.round(even.s[0][kinks + 1])
