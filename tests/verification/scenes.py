"""Scenes of the verification, as plain data: what `load_scene` reads from YAML."""

from __future__ import annotations

from typing import Any

import numpy as np

import cablemodel as cm
from tests.verification.references.motion import spring_pendulum

CABLE_K = {
    "diameter": 0.01666,
    "mass": 0.4613,
    "submerged_weight": 2.33333,
    "axial_stiffness": 1.0e6,
    "bending_stiffness": 0.1,
    "drag_normal": 1.0,
    "drag_tangential": 0.1586,
    "added_mass": 1.0,
}
IDEAL = {
    "diameter": 0.01,
    "mass": 1.0,
    "submerged_weight": 0.0,
    "axial_stiffness": 1.0e9,
    "bending_stiffness": 0.0,
    "drag_normal": 0.0,
    "drag_tangential": 0.0,
    "added_mass": 0.0,
}
"""A cable without loads: a test adds the few that it is about."""


def scene(
    length: float,
    cable: dict[str, Any],
    *,
    model: str = "elastica",
    elements: int | None = None,
    tolerance: float = 1e-4,
    body: dict[str, Any] | None = None,
    end: Any = "free",
    initial: Any = "static",
    vessel: dict[str, Any] | None = None,
    density: float = 1025.0,
    gravity: float = 9.80665,
    current: Any = None,
    floor: Any = None,
) -> cm.Scene:
    """One cable from the vessel, perhaps a body at its end."""
    piece: dict[str, Any] = {"type": "C", "length": length, "model": model}
    if elements is not None:
        piece["elements"] = elements
    line: list[dict[str, Any]] = [{"cable": piece}]
    if body is not None:
        line.append({"body": {"half_length": 0.0, **body}})
    return cm.load_scene(
        {
            "environment": {
                "gravity": gravity,
                "water_density": density,
                "current": current,
                "floor": floor,
            },
            "cable_types": {"C": cable},
            "line": line,
            "end": end,
            "initial": initial,
            "vessel": vessel or {"position": [0.0, 0.0, 0.0]},
            "solver": {"tolerance": tolerance},
        }
    )


def towed(**settings: Any) -> cm.Scene:
    """S1: hanging at rest, the vessel goes to 0.8 m/s in 30 s."""
    ramp = [{"t": 0, "velocity": [0, 0, 0]}, {"t": 30, "velocity": [0.8, 0, 0]}]
    return scene(30.0, CABLE_K, vessel={"velocity": ramp}, **settings)


def released_in_water(**settings: Any) -> cm.Scene:
    """S2w: straight, horizontal, unstretched and at rest; pinned at the origin and let go."""
    return scene(10.0, CABLE_K, initial={"straight": [1, 0, 0]}, **settings)


def released_in_air(**settings: Any) -> cm.Scene:
    """S2a: the same in air, where it whips."""
    cable = {**CABLE_K, "submerged_weight": CABLE_K["mass"] * 9.80665}
    return scene(10.0, cable, initial={"straight": [1, 0, 0]}, density=1.2, **settings)


def turned(angle: str = "180 deg", **settings: Any) -> cm.Scene:
    """S4: steady at 0.8 m/s along x, the vessel turns to port on a radius of 10 m."""
    legs = [
        {"turn": {"angle": angle, "radius": 10.0, "speed": 0.8}},
        {"straight": {"duration": 1000.0, "speed": 0.8}},
    ]
    return scene(30.0, CABLE_K, vessel={"path": legs}, **settings)


def cantilever(
    length: float = 1.0,
    axial_stiffness: float = 1e6,
    weight: float = 0.0,
    load: float = 0.0,
    **settings: Any,
) -> cm.CableModel:
    """EI = 1 N m2, clamped level unless said otherwise; load: of a body at its end [N]."""
    cable = {
        **IDEAL,
        "submerged_weight": weight,
        "axial_stiffness": axial_stiffness,
        "bending_stiffness": 1.0,
    }
    body = {"mass": 1.0, "submerged_weight": load} if load else None
    settings.setdefault("vessel", {"connection": {"clamped": [1.0, 0.0, 0.0]}})
    return cm.CableModel(scene(length, cable, body=body, **settings))


def hoist_that_stops() -> cm.CableModel:
    """8 kN at the end of 1 km of cable without weight, hoisted at 1 m/s until t = 0.1 s and stopped
    within 50 ms, in vacuum: T falls by V sqrt(EA m); the echo is back after 0.63 s."""
    cable = {**IDEAL, "axial_stiffness": 1e7}
    table = [(0.0, 1.0), (0.1, 1.0), (0.15, 0.0)]
    vessel = {"velocity": [{"t": t, "velocity": [0, 0, v]} for t, v in table]}
    body = {"mass": 8000.0 / 9.80665, "submerged_weight": 8000.0}
    settings = {"model": "cable", "elements": 128, "density": 0.0, "tolerance": 1e-8}
    return cm.CableModel(scene(1000.0, cable, body=body, vessel=vessel, **settings))


def pendulum() -> tuple[cm.Scene, Any]:
    """1 kg on an elastic line of 1 m, let go at 60 degrees under its tension, and its exact path.

    A straight cable adds a third of its mass and half of its weight to those of the bob.
    """
    gravity, stiffness, ratio, angle = 9.80665, 1e5, 1e-5, np.radians(60.0)
    stretch = 1.0 + gravity * np.cos(angle) / stiffness
    place = [stretch * np.sin(angle), 0.0, -stretch * np.cos(angle)]
    cable = {
        "diameter": 0.01, "mass": ratio, "submerged_weight": ratio * gravity,
        "axial_stiffness": stiffness, "drag_normal": 0, "drag_tangential": 0, "added_mass": 0,
    }  # fmt: skip
    scene = cm.load_scene(
        {
            "environment": {"gravity": gravity, "water_density": 0.0},
            "cable_types": {"C": cable},
            "line": [
                {"cable": {"type": "C", "length": 1.0, "model": "cable", "elements": 2}},
                {"body": {"mass": 1.0, "submerged_weight": gravity, "half_length": 0.0}},
            ],
            "initial": {"points": [[0.0, 0.0, 0.0], place]},
            "solver": {"tolerance": 1e-2},
            "run": {"duration": 4.0, "output_interval": 0.25},
        }
    )
    times = np.arange(1, 17) * 0.25
    start = (place[0], place[2])
    path = spring_pendulum(1.0, stiffness, 1 + ratio / 3, gravity * (1 + ratio / 2), start, times)
    return scene, path
