"""Scenes for the direct solver: those of the finite elements' tests, and the paper's examples."""

from __future__ import annotations

from typing import Any

import cablemodel as cm
from tests.verification.scenes import CABLE_K

STANDSTILL_TO_TOW = [{"t": 0, "velocity": [0, 0, 0]}, {"t": 30, "velocity": [0.8, 0, 0]}]
TURN = [
    {"turn": {"angle": "180 deg", "radius": 10.0, "speed": 0.8}},
    {"straight": {"duration": 1000.0, "speed": 0.8}},
]
POINT_BODY = {
    "mass": 6.0,
    "submerged_weight": 20.0,
    "added_mass": 2.0,
    "added_mass_axial": 2.0,
    "drag_area": 0.03,
    "drag_coefficient": 0.6,
    "drag_area_axial": 0.03,
    "drag_coefficient_axial": 0.6,
}


def cable(length: float, model: str = "elastica", kind: str = "K") -> dict[str, Any]:
    """An item of a line."""
    return {"cable": {"type": kind, "length": length, "model": model}}


def direct(
    line: list[dict[str, Any]],
    *,
    vessel: dict[str, Any] | None = None,
    initial: Any = "static",
    end: Any = "free",
    environment: dict[str, Any] | None = None,
    payout: dict[str, Any] | None = None,
    types: dict[str, Any] | None = None,
    **solver: Any,
) -> cm.Scene:
    """A scene for direct integration with cable K."""
    return cm.load_scene(
        {
            "environment": environment or {},
            "cable_types": types or {"K": CABLE_K},
            "line": line,
            "end": end,
            "initial": initial,
            "vessel": vessel or {},
            "payout": payout or {},
            "solver": {"method": "direct_integration", **solver},
        }
    )


def towed(model: str = "elastica", **settings: Any) -> cm.Scene:
    """S1, the paper's example 2."""
    vessel = {"velocity": STANDSTILL_TO_TOW}
    return direct([cable(30.0, model)], vessel=vessel, **settings)


def turned(model: str = "elastica", **settings: Any) -> cm.Scene:
    """S4: steady at 0.8 m/s along x, the vessel turns to port."""
    return direct([cable(30.0, model)], vessel={"path": TURN}, **settings)


def released(**settings: Any) -> cm.Scene:
    """S2w: straight, level, unstretched, at rest."""
    return direct([cable(10.0)], initial={"straight": [1, 0, 0]}, **settings)


def laid(rate: float = 0.7, floor: dict[str, Any] | None = None, **settings: Any) -> cm.Scene:
    """S3, after the paper's example 3: pay-out and touchdown, a body 10 m below the vessel."""
    return direct(
        [cable(10.0, "cable"), {"body": POINT_BODY}, cable(50.0, "hybrid")],
        vessel={"velocity": [{"t": 0, "velocity": [0, 0, 0]}, {"t": 20, "velocity": [0.65, 0, 0]}]},
        environment={"floor": floor or {"z": -70.0}},
        payout={
            "rate": [{"t": 0, "rate": 0}, {"t": 20, "rate": 0}, {"t": 21, "rate": rate}],
            "drum": [cable(100.0, "cable")],
        },
        **settings,
    )


def deployed(model: str, half_length: float = 0.25, **settings: Any) -> cm.Scene:
    """After the paper's example 1, on assumed data: three cables of 10 m, each with a nearly
    neutral body; 0 to 0.7 m/s in 60 s, a sharp turn at 65 s, pay-out at 0.75 m/s from 70 s."""
    body = {
        "body": {
            "mass": 20.0,
            "submerged_weight": 2.0,
            "half_length": half_length,
            "rotary_inertia": 0.5,
            "added_mass": 15.0,
            "added_mass_axial": 2.0,
            "drag_area": 0.1,
            "drag_coefficient": 1.0,
            "drag_area_axial": 0.03,
            "drag_coefficient_axial": 0.5,
        }
    }
    path = [
        {"straight": {"duration": 1e-3, "speed": 0.0, "heading": 0}},
        {"straight": {"duration": 60.0, "speed": 0.7}},
        {"straight": {"duration": 5.0, "speed": 0.7}},
        {"turn": {"angle": "90 deg", "radius": 5.0, "speed": 0.7}},
        {"straight": {"duration": 300.0, "speed": 0.7}},
    ]
    pieces = [cable(10.0, model), body]
    return direct(
        pieces * 3,
        vessel={"path": path},
        payout={
            "rate": [{"t": 0, "rate": 0}, {"t": 70, "rate": 0}, {"t": 71, "rate": 0.75}],
            "drum": [body, cable(10.0, model)] * 10,
        },
        relative_tolerance=0.05,
        **settings,
    )
