"""Steady lays: scenes, and the differential equations of a cable that runs along its own shape.

In the frame of the touchdown (Zajac 1957), with stretch and the momentum (m + ma) V^2.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.integrate import solve_ivp

import cablemodel as cm

KNOT = 1852.0 / 3600.0


DENSITY, GRAVITY = 1025.0, 9.80665


LIGHT = {
    "diameter": 0.017,
    "mass": 0.55,
    "axial_stiffness": 8e6,
    "drag_normal": 1.5,
    "drag_tangential": 0.005,
}


ARMOURED = {
    "diameter": 0.04,
    "mass": 4.3,
    "axial_stiffness": 50e6,
    "drag_normal": 1.2,
    "drag_tangential": 0.01,
}


def lay_angle(kind: dict[str, float], speed: float) -> tuple[float, float]:
    """Submerged weight [N/m] and w cos a = D sin^2 a solved for a [rad]."""
    weight = kind["mass"] * GRAVITY - DENSITY * GRAVITY * math.pi / 4.0 * kind["diameter"] ** 2
    drag = 0.5 * DENSITY * kind["drag_normal"] * kind["diameter"] * speed**2
    cosine = (-weight + math.sqrt(weight**2 + 4.0 * drag**2)) / (2.0 * drag)
    return weight, math.acos(cosine)


def lay(
    kind: dict[str, float],
    knots: float,
    depth: float,
    *,
    bending: float,
    slope: float = 0.0,
    slack: float = 0.0,
    tolerance: float = 1e-3,
) -> tuple[cm.Scene, float]:
    """A lay and its pay-out [m/s]; slope: of the floor along the vessel's way [degrees]."""
    speed, up = knots * KNOT, math.radians(slope)
    _, down = lay_angle(kind, speed)
    rate = speed * (math.sin(down) - math.sin(up)) / math.sin(down - up) * (1.0 + slack)
    hanging = depth * math.cos(up) / math.sin(down - up)
    cable = {"type": "c", "length": 1.05 * hanging + 20.0}
    return cm.load_scene(
        {
            "environment": {"floor": {"z": -depth, "slope": [math.tan(up), 0.0], "friction": 0.5}},
            "cable_types": {"c": {**kind, "bending_stiffness": bending}},
            "line": [{"cable": cable}],
            "vessel": {"velocity": [speed, 0, 0]},
            "payout": {"rate": [{"t": 0, "rate": rate}], "drum": [{"cable": cable}]},
            "run": {"duration": 10, "output_interval": 1},
            "solver": {"tolerance": tolerance},
        }
    ), rate


def independent(
    kind: dict[str, float], knots: float, rate: float, bottom: float, rise: float, straight: bool
) -> tuple[float, float]:
    """Top tension [N] and length [m] of what hangs, from a touchdown with a tension up by a rise.

    straight: it leaves the floor at the lay angle, without tension to turn it.
    """
    speed = knots * KNOT
    weight, down = lay_angle(kind, speed)
    added = DENSITY * math.pi / 4.0 * kind["diameter"] ** 2
    momentum = (kind["mass"] + added) * rate**2
    normal = 0.5 * DENSITY * kind["drag_normal"] * kind["diameter"] * speed**2
    along = 0.5 * DENSITY * kind["drag_tangential"] * math.pi * kind["diameter"]

    def rates(_s: float, state: np.ndarray) -> list[float]:
        angle, tension, _height = state
        stretch = 1.0 + tension / kind["axial_stiffness"]
        slip = rate * stretch - speed * math.cos(angle)
        root = math.sqrt(stretch)
        across = weight * math.cos(angle) - root * normal * math.sin(angle) * abs(math.sin(angle))
        turns = 0.0 if straight else across / (tension - momentum * stretch)
        force = weight * math.sin(angle) - root * along * slip * abs(slip)
        return [turns, force, stretch * math.sin(angle)]

    def top(_s: float, state: np.ndarray) -> float:
        return float(state[2]) - rise

    top.terminal = True  # type: ignore[attr-defined]
    up = solve_ivp(rates, (0.0, 1e6), [down if straight else 0.0, bottom, 0.0], events=top,
                   method="LSODA", rtol=1e-9, atol=1e-9)  # fmt: skip
    return float(up.y[1, -1]), float(up.t[-1])


def bottom_tension(model: cm.CableModel) -> float:
    """Tension a little behind the touchdown [N]."""
    lying = model.line_length - 0.98 * model.floor_length
    return float(model.sample([lying]).tension[0])
