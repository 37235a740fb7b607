"""The benchmark scenes: what is simulated, where it is compared, and what is asked.

Scenes are written in the project's own YAML schema (as dicts); the vessel's motion is given a
second time as a plain function of time, so that peers can be driven without cablemodel.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

GRAVITY = 9.80665
"""Standard gravity [m/s2]."""

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Cable:
    """One uniform cable, in the words of the scene schema (SI units)."""

    length: float
    diameter: float = 0.01666
    mass: float = 0.4613
    submerged_weight: float = 2.33333
    axial_stiffness: float = 1.0e6
    bending_stiffness: float = 0.1
    drag_normal: float = 1.0
    drag_tangential: float = 0.1586
    added_mass: float = 1.0

    def cable_type(self) -> dict[str, float]:
        """The entry of ``cable_types`` in a scene."""
        return {
            "diameter": self.diameter,
            "mass": self.mass,
            "submerged_weight": self.submerged_weight,
            "axial_stiffness": self.axial_stiffness,
            "bending_stiffness": self.bending_stiffness,
            "drag_normal": self.drag_normal,
            "drag_tangential": self.drag_tangential,
            "added_mass": self.added_mass,
        }


@dataclass(frozen=True)
class Target:
    """What the project promises for a scene.

    tip_error: largest distance of the free end from the reference, over the length [-].
    tension_error: largest error of the top tension, over its largest value [-]; None: not asked.
    cost: CPU seconds of stepping per simulated second, at most [-].
    ratio: how many times cheaper than MoorDyn at the same tip error, at least [-].
    """

    tip_error: float
    tension_error: float | None
    cost: float
    ratio: float


@dataclass(frozen=True)
class BenchmarkScene:
    """A scene, the instants at which it is compared, and what is asked of it.

    ``points``: (n+1, 3) starting shape relative to the vessel is left to
    :meth:`starting_points`; ``motion`` maps a time [s] to the vessel's position (3,) [m].
    """

    name: str
    title: str
    cable: Cable
    water_density: float
    scene: dict[str, Any]
    times: tuple[float, ...]
    motion: Callable[[float], tuple[float, float, float]]
    start_velocity: tuple[float, float, float]
    start: str
    target: Target
    kinks: tuple[float, ...] = ()

    def starting_points(self, segments: int) -> Vector:
        """Nodes of the starting shape for a lumped-mass peer, relative to the vessel [m].

        segments: number of equal segments.
        Returns (segments + 1, 3), from the vessel outwards. ``straight``: along x, unstretched.
        ``steady``: the straight line that a towed cable without bending takes (every point of it
        has the same angle), each segment stretched by its own tension.
        """
        length = self.cable.length
        if self.start == "straight":
            return np.outer(np.linspace(0.0, length, segments + 1), (1.0, 0.0, 0.0))
        angle, tangential_load = steady_tow(self)
        step = length / segments
        tension = tangential_load * step * (segments - 0.5 - np.arange(segments))
        along = np.concatenate(
            [[0.0], np.cumsum(step * (1.0 + tension / self.cable.axial_stiffness))]
        )
        return np.outer(along, (-math.cos(angle), 0.0, -math.sin(angle)))


def steady_tow(scene: BenchmarkScene) -> tuple[float, float]:
    """Angle below the horizontal [rad] and load along the cable [N/m] of a steady tow along x.

    w cos a = 1/2 rho Cdn d U^2 sin^2 a, without the factor sqrt(e) on the drag (as peers take it).
    """
    cable = scene.cable
    speed = scene.start_velocity[0]
    pressure = 0.5 * scene.water_density * cable.diameter * speed**2
    weight = cable.submerged_weight
    angle = math.pi / 2.0
    if speed != 0.0:
        normal = pressure * cable.drag_normal
        angle = float(
            brentq(lambda a: weight * math.cos(a) - normal * math.sin(a) ** 2, 1e-6, math.pi / 2.0)
        )
    tangential = pressure * cable.drag_tangential * math.pi * math.cos(angle) ** 2
    return angle, weight * math.sin(angle) + tangential


def _scene_dict(
    title: str,
    cable: Cable,
    water_density: float,
    initial: Any,
    vessel: dict[str, Any],
    duration: float,
) -> dict[str, Any]:
    return {
        "title": title,
        "environment": {"gravity": GRAVITY, "water_density": water_density},
        "cable_types": {"K": cable.cable_type()},
        "line": [{"cable": {"type": "K", "length": cable.length, "model": "elastica"}}],
        "end": "free",
        "initial": initial,
        "vessel": vessel,
        "solver": {"method": "finite_element", "tolerance": 1.0e-3},
        "run": {"duration": duration, "output_interval": duration},
    }


def _at_rest(_time: float) -> tuple[float, float, float]:
    return (0.0, 0.0, 0.0)


def _tow_motion(time: float) -> tuple[float, float, float]:
    """0 to 0.8 m/s in 30 s, then constant."""
    x = 0.8 * time**2 / 60.0 if time < 30.0 else 12.0 + 0.8 * (time - 30.0)
    return (x, 0.0, 0.0)


TURN_RADIUS = 10.0
TURN_SPEED = 0.8
TURN_DURATION = math.pi * TURN_RADIUS / TURN_SPEED


def _turn_motion(time: float) -> tuple[float, float, float]:
    """Half a circle to port from the origin, then back along -x."""
    if time < TURN_DURATION:
        phase = TURN_SPEED / TURN_RADIUS * time
        return (TURN_RADIUS * math.sin(phase), TURN_RADIUS * (1.0 - math.cos(phase)), 0.0)
    return (-TURN_SPEED * (time - TURN_DURATION), 2.0 * TURN_RADIUS, 0.0)


def _tow() -> BenchmarkScene:
    cable = Cable(length=30.0)
    title = "S1: tow, hanging at rest, vessel from 0 to 0.8 m/s in 30 s"
    vessel = {
        "position": [0.0, 0.0, 0.0],
        "velocity": [
            {"t": 0.0, "velocity": [0.0, 0.0, 0.0]},
            {"t": 30.0, "velocity": [0.8, 0.0, 0.0]},
        ],
    }
    return BenchmarkScene(
        name="S1",
        title=title,
        cable=cable,
        water_density=1025.0,
        scene=_scene_dict(title, cable, 1025.0, "static", vessel, 200.0),
        times=(10.0, 30.0, 45.0, 60.0, 100.0, 150.0, 200.0),
        motion=_tow_motion,
        start_velocity=(0.0, 0.0, 0.0),
        start="steady",
        target=Target(tip_error=1e-4, tension_error=1e-3, cost=2e-6, ratio=5000.0),
        kinks=(30.0,),
    )


def _release(
    name: str,
    title: str,
    cable: Cable,
    water_density: float,
    times: tuple[float, ...],
    target: Target,
) -> BenchmarkScene:
    """A straight, unstretched cable along x, at rest and pinned at one end, is let go."""
    vessel = {"position": [0.0, 0.0, 0.0], "velocity": [{"t": 0.0, "velocity": [0.0, 0.0, 0.0]}]}
    straight = {"straight": [1.0, 0.0, 0.0]}
    return BenchmarkScene(
        name=name,
        title=title,
        cable=cable,
        water_density=water_density,
        scene=_scene_dict(title, cable, water_density, straight, vessel, times[-1]),
        times=times,
        motion=_at_rest,
        start_velocity=(0.0, 0.0, 0.0),
        start="straight",
        target=target,
    )


def _release_in_water() -> BenchmarkScene:
    return _release(
        "S2w",
        "S2w: horizontal cable released in water, zero tension everywhere at the start",
        Cable(length=10.0),
        1025.0,
        (1.0, 2.0, 4.0, 6.0, 10.0),
        Target(tip_error=1e-4, tension_error=None, cost=1e-4, ratio=500.0),
    )


def _release_in_air() -> BenchmarkScene:
    return _release(
        "S2a",
        "S2a: horizontal cable released in air, a whip; compared up to 1.25 s",
        Cable(length=10.0, submerged_weight=0.4613 * GRAVITY),
        1.2,
        (0.25, 0.5, 0.75, 1.0, 1.25),
        Target(tip_error=5e-4, tension_error=None, cost=2e-3, ratio=30.0),
    )


def _turn() -> BenchmarkScene:
    cable = Cable(length=30.0)
    title = "S4: steady tow at 0.8 m/s, then a turn of 180 deg to port, radius 10 m"
    vessel = {
        "position": [0.0, 0.0, 0.0],
        "path": [
            {"turn": {"angle": math.pi, "radius": TURN_RADIUS, "speed": TURN_SPEED}},
            {"straight": {"duration": 200.0, "speed": TURN_SPEED}},
        ],
    }
    return BenchmarkScene(
        name="S4",
        title=title,
        cable=cable,
        water_density=1025.0,
        scene=_scene_dict(title, cable, 1025.0, "static", vessel, 120.0),
        times=(10.0, 20.0, 30.0, 39.27, 60.0, 120.0),
        motion=_turn_motion,
        start_velocity=(TURN_SPEED, 0.0, 0.0),
        start="steady",
        target=Target(tip_error=1e-4, tension_error=1e-3, cost=8e-6, ratio=5000.0),
        kinks=(TURN_DURATION,),
    )


SCENES: dict[str, BenchmarkScene] = {
    scene.name: scene for scene in (_tow(), _release_in_water(), _release_in_air(), _turn())
}
