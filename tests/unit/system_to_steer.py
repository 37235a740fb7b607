"""A system with one of each that the node takes commands for."""

from __future__ import annotations

from typing import Any

SCENE: dict[str, Any] = {
    "title": "Ship, cage and vehicle",
    "environment": {"water_density": 1025.0},
    "cable_types": {
        "wire": {"diameter": 0.02, "mass": 0.9, "axial_stiffness": 5e6, "added_mass": 1.0},
        "tether": {
            "diameter": 0.016, "mass": 0.23, "submerged_weight": 0.3, "axial_stiffness": 1e6,
        },
    },
    "vessels": {
        "ship": {"points": {"sheave": [-10.0, 0.0, 3.0]}},
        "vehicle": {"position": [10.0, 0.0, -37.0], "points": {"tail": [-0.5, 0.0, 0.0]}},
    },
    "bodies": {
        "cage": {
            "mass": 400.0, "submerged_weight": 2500.0, "inertia": 80.0, "added_mass": 200.0,
            "drag_area": 1.0, "drag_turning": 1.0,
            "points": {"top": [0.0, 0.0, 0.5], "spool": [0.4, 0.0, -0.4]},
            "foils": {"fin": {"area": 0.4, "aspect_ratio": 3.0}},
        }
    },
    "lines": {
        "umbilical": {
            "from": "ship.sheave", "to": "cage.top",
            "items": [{"cable": {"type": "wire", "length": 40.0}}],
        },
        "tether": {
            "from": "cage.spool", "to": "vehicle.tail",
            "items": [{"cable": {"type": "tether", "length": 25.0}}],
        },
    },
    "winches": {"hoist": {"line": "umbilical", "drum": 30.0}},
    "cuts": {"weak_link": {"line": "tether", "at": 20.0}},
    "run": {"duration": 60.0, "output_interval": 0.1},
}  # fmt: skip
