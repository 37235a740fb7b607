"""Scenes as plain data, for tests to change."""

from __future__ import annotations

from typing import Any


def minimal() -> dict[str, Any]:
    """As little as a scene can hold."""
    return {
        "cable_types": {"K": {"diameter": 0.01666, "mass": 0.4613, "axial_stiffness": 1e6}},
        "line": [{"cable": {"type": "K", "length": 30}}],
    }


def full() -> dict[str, Any]:
    """Every part that a scene can hold."""
    return {
        "title": "Everything",
        "environment": {
            "gravity": 9.81,
            "water_density": 1000,
            "current": {
                "table": [
                    {"z": 0, "t": 0, "velocity": [1, 0, 0]},
                    {"z": -50, "t": 0, "velocity": [0.5, 0, 0]},
                    {"z": 0, "t": 100, "velocity": [0, 1, 0]},
                    {"z": -50, "t": 100, "velocity": [0, 0.5, 0]},
                ]
            },
            "waves": {"jonswap": {"hs": 2, "tp": 8, "direction": "30 deg", "seed": 4}},
            "floor": {"z": -70, "slope": [0.01, 0], "at": [5, 0], "friction": 0.3, "damping": 2},
        },
        "cable_types": {
            "K": {
                "diameter": 0.01666,
                "mass": 0.4613,
                "submerged_weight": 2.33333,
                "axial_stiffness": 1e6,
                "bending_stiffness": 0.1,
                "drag_normal": 1.0,
                "drag_tangential": 0.1586,
                "added_mass": 1.0,
            },
            "rope": {"diameter": "12 mm", "mass": 0.1, "tension_strain": [1e-5, -1e-10]},
        },
        "line": [
            {"cable": {"type": "K", "length": 10, "model": "elastica", "elements": 8}},
            {"body": {"name": "sonar", "mass": 6, "submerged_weight": 20, "half_length": 0.5}},
            {"cable": {"type": "rope", "length": "20 m", "model": "cable"}},
        ],
        "end": {"anchor": [0, 0, -31], "connection": {"clamped": [0, 0, -2]}},
        "initial": {"points": [[0, 0, 0], [0, 1, -15], [0, 0, -31]]},
        "vessel": {
            "position": [0, 0, 0],
            "connection": {"clamped": [0, 1, -1]},
            "velocity": [
                {"t": 0, "velocity": [0, 0, 0]},
                {"t": 30, "velocity": ["1 kn", 0, 0]},
            ],
            "interpolation": "cubic",
        },
        "payout": {
            "rate": [{"t": 0, "rate": 0}, {"t": 5, "rate": 0.7}],
            "drum": [
                {"cable": {"type": "K", "length": 100}},
                {"body": {"mass": 1, "submerged_weight": 0}},
            ],
        },
        "solver": {
            "method": "direct_integration",
            "time_step": 1.0,
            "node_spacing": 1.0,
            "alpha": 0.55,
            "relative_tolerance": 0.01,
            "joint": "paper",
        },
        "run": {"duration": "2 min", "output_interval": 0.5},
    }
