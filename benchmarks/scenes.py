"""The benchmark scenes: what is simulated, where it is compared, and what is asked.

Scenes are written in the project's own YAML schema (as dicts); the vessel's motion is given a
second time as a plain function of time, so that peers can be driven without cablemodel.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
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

    tip_error: largest distance of the free end from the reference, over the length [-]; infinite:
    not asked.
    tension_error: largest error of the top tension, over its largest value [-]; None: not asked.
    cost: CPU seconds of stepping per simulated second, at most [-].
    ratio: how many times cheaper than MoorDyn at the same tip error, at least [-]; not a number:
    not asked.
    """

    tip_error: float
    tension_error: float | None
    cost: float
    ratio: float = math.nan


@dataclass(frozen=True)
class Wave:
    """A regular Airy wave along x in deep water, a crest at the origin at t = 0 (SI units).

    It comes up within its first period, by a quintic.
    """

    height: float
    period: float

    def share(self, time: float) -> tuple[float, float]:
        """Of the full height, and its rate [1/s]."""
        x = min(1.0, max(0.0, time / self.period))
        rate = 30.0 * x**2 * (1.0 - x) ** 2 / self.period
        return x**3 * (10.0 + x * (6.0 * x - 15.0)), rate

    def water(self, time: float, points: Vector) -> tuple[Vector, Vector]:
        """Velocity and acceleration of the water at points (n, 3), z from still water; (n, 3)."""
        omega = 2.0 * math.pi / self.period
        number = omega**2 / GRAVITY
        share, rate = self.share(time)
        theta = number * points[:, 0] - omega * time
        speed = 0.5 * self.height * omega * np.exp(number * np.minimum(points[:, 2], 0.0))
        still = np.zeros(len(points))
        moving = np.stack([speed * np.cos(theta), still, speed * np.sin(theta)], axis=1)
        change = omega * np.stack([speed * np.sin(theta), still, -speed * np.cos(theta)], axis=1)
        return share * moving, share * change + rate * moving


@dataclass(frozen=True)
class BenchmarkScene:
    """A scene, the instants at which it is compared, and what is asked of it.

    ``motion`` maps a time [s] to the vessel's position (3,) [m]; ``start`` is ``straight``,
    ``steady`` (see :meth:`starting_points`) or ``static`` (left to each simulator). ``target``:
    None where nothing is asked; ``goal``: what is aimed at beyond it. ``probe``: arc length of the
    point that is compared [m], None for the end. ``anchor``: where the end is held (3,) [m],
    relative to the vessel's first place. ``wave``: what the water does; ``depth``: of the vessel's
    first place below still water, where there is a surface [m].
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
    target: Target | None = None
    goal: Target | None = None
    kinks: tuple[float, ...] = ()
    probe: float | None = None
    anchor: tuple[float, float, float] | None = None
    wave: Wave | None = None
    depth: float = 100.0

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
        goal=Target(tip_error=1e-4, tension_error=1e-3, cost=6e-7),
        kinks=(30.0,),
    )


def _release(
    name: str,
    title: str,
    cable: Cable,
    water_density: float,
    times: tuple[float, ...],
    target: Target | None = None,
    goal: Target | None = None,
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
        goal=goal,
    )


def _release_in_water() -> BenchmarkScene:
    return _release(
        "S2w",
        "S2w: horizontal cable released in water, zero tension everywhere at the start",
        Cable(length=10.0),
        1025.0,
        (1.0, 2.0, 4.0, 6.0, 10.0),
        Target(tip_error=1e-4, tension_error=None, cost=1e-4, ratio=500.0),
        Target(tip_error=1e-4, tension_error=None, cost=3e-5),
    )


def _release_in_air() -> BenchmarkScene:
    return _release(
        "S2a",
        "S2a: horizontal cable released in air, a whip; compared up to 1.25 s",
        Cable(length=10.0, submerged_weight=0.4613 * GRAVITY),
        1.2,
        (0.25, 0.5, 0.75, 1.0, 1.25),
        Target(tip_error=5e-4, tension_error=None, cost=2e-3, ratio=30.0),
        Target(tip_error=3e-4, tension_error=None, cost=4e-4),
    )


def _release_in_vacuum() -> BenchmarkScene:
    return _release(
        "S2v",
        "S2v: horizontal cable released in a vacuum; compared up to 1 s",
        Cable(length=10.0, submerged_weight=0.4613 * GRAVITY),
        0.0,
        (0.25, 0.5, 0.75, 1.0),
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
        goal=Target(tip_error=1e-4, tension_error=1e-3, cost=2.5e-6),
        kinks=(TURN_DURATION,),
    )


LAID_TIMES = (10.0, 30.0, 38.0, 60.0, 96.0, 120.0)
"""Instants at which S3 is compared [s]; from 38.8 s on the end lies on the floor, and folds."""


def _laid_motion(time: float) -> tuple[float, float, float]:
    """0 to 0.65 m/s in 20 s, then constant."""
    x = 0.65 * time**2 / 40.0 if time < 20.0 else 6.5 + 0.65 * (time - 20.0)
    return (x, 0.0, 0.0)


def _laid() -> BenchmarkScene:
    cable = Cable(length=60.0)
    title = "S3: a tow with a body, from 20 s on paid out at 0.7 m/s onto a floor at 70 m"
    body = {"mass": 6.0, "submerged_weight": 20.0, "added_mass": 2.0, "added_mass_axial": 2.0,
            "drag_area": 0.03, "drag_coefficient": 0.6, "drag_area_axial": 0.03,
            "drag_coefficient_axial": 0.6}  # fmt: skip

    def part(length: float) -> dict[str, Any]:
        return {"cable": {"type": "K", "length": length, "model": "elastica"}}

    vessel = {
        "position": [0.0, 0.0, 0.0],
        "velocity": [
            {"t": 0.0, "velocity": [0.0, 0.0, 0.0]},
            {"t": 20.0, "velocity": [0.65, 0.0, 0.0]},
        ],
    }
    scene = _scene_dict(title, cable, 1025.0, "static", vessel, 120.0)
    scene["environment"]["floor"] = {"z": -70.0}
    scene["line"] = [part(10.0), {"body": body}, part(50.0)]
    rates = [(0.0, 0.0), (20.0, 0.0), (21.0, 0.7)]
    scene["payout"] = {"rate": [{"t": t, "rate": rate} for t, rate in rates], "drum": [part(80.0)]}
    return BenchmarkScene(
        name="S3",
        title=title,
        cable=cable,
        water_density=1025.0,
        scene=scene,
        times=LAID_TIMES,
        motion=_laid_motion,
        start_velocity=(0.0, 0.0, 0.0),
        start="static",
        target=Target(tip_error=math.inf, tension_error=5e-3, cost=5e-3),
        goal=Target(tip_error=math.inf, tension_error=5e-3, cost=1e-3),
        kinks=(20.0, 21.0),
    )


HEAVE, HEAVE_PERIOD = 1.5, 8.0
"""Amplitude [m] and period [s] of the jumper's top."""


def heave_motion(time: float) -> tuple[float, float, float]:
    """Up and down, the full stroke after the first period; position and velocity are smooth."""
    share, _ = _heave_share(time)
    omega = 2.0 * math.pi / HEAVE_PERIOD
    return (0.0, 0.0, HEAVE * share * (1.0 - math.cos(omega * time)))


def heave_speed(time: float) -> float:
    """Rate of :func:`heave_motion` [m/s]."""
    share, rate = _heave_share(time)
    omega = 2.0 * math.pi / HEAVE_PERIOD
    return HEAVE * (share * omega * math.sin(omega * time) + rate * (1.0 - math.cos(omega * time)))


def _heave_share(time: float) -> tuple[float, float]:
    """Share of the full stroke and its rate [1/s]: half a cosine over the first period."""
    if time >= HEAVE_PERIOD:
        return 1.0, 0.0
    omega = math.pi / HEAVE_PERIOD
    return 0.5 * (1.0 - math.cos(omega * time)), 0.5 * omega * math.sin(omega * time)


JUMPER = Cable(
    length=100.0,
    diameter=0.1,
    mass=20.0,
    submerged_weight=117.0,
    axial_stiffness=1e7,
    bending_stiffness=1000.0,
    drag_normal=1.1,
    drag_tangential=0.01,
)


def _jumper() -> BenchmarkScene:
    cable = JUMPER
    title = "J: a jumper of 100 m between an anchor and a top that heaves, in still water"
    instants = np.linspace(0.0, 24.0, 241).tolist()
    table = [{"t": t, "velocity": [0.0, 0.0, heave_speed(t)]} for t in instants]
    vessel = {"position": [0.0, 0.0, 0.0], "velocity": table, "interpolation": "cubic"}
    scene = _scene_dict(title, cable, 1025.0, "static", vessel, 24.0)
    anchor = (60.0, 0.0, -40.0)
    scene["end"] = {"anchor": list(anchor)}
    return BenchmarkScene(
        name="J",
        title=title,
        cable=cable,
        water_density=1025.0,
        scene=scene,
        times=(2.0, 4.0, 6.0, 8.0, 11.0, 14.0, 17.0, 20.0, 24.0),
        motion=heave_motion,
        start_velocity=(0.0, 0.0, 0.0),
        start="static",
        probe=50.0,
        anchor=anchor,
    )


def _jumper_in_waves() -> BenchmarkScene:
    # In water it weighs what it does in air less what floats: peers then have the wave's gravity.
    floats = 1025.0 * math.pi / 4.0 * JUMPER.diameter**2
    cable = replace(JUMPER, submerged_weight=(JUMPER.mass - floats) * GRAVITY)
    wave = Wave(height=4.0, period=8.0)
    depth = 10.0
    title = "JW: the jumper, held 10 m below a regular wave of 4 m and 8 s; the seventh period"
    vessel = {"position": [0.0, 0.0, -depth], "velocity": [{"t": 0.0, "velocity": [0.0, 0.0, 0.0]}]}
    scene = _scene_dict(title, cable, 1025.0, "static", vessel, 56.0)
    anchor = (60.0, 0.0, -40.0)
    scene["end"] = {"anchor": [anchor[0], anchor[1], anchor[2] - depth]}
    regular = {"height": wave.height, "period": wave.period}
    scene["environment"]["waves"] = {"regular": regular}
    return BenchmarkScene(
        name="JW",
        title=title,
        cable=cable,
        water_density=1025.0,
        scene=scene,
        times=(49.0, 50.0, 51.0, 52.0, 53.0, 54.0, 55.0, 56.0),
        motion=_at_rest,
        start_velocity=(0.0, 0.0, 0.0),
        start="static",
        probe=50.0,
        anchor=anchor,
        wave=wave,
        depth=depth,
    )


SCENES: dict[str, BenchmarkScene] = {
    scene.name: scene
    for scene in (
        _tow(), _release_in_water(), _release_in_air(), _release_in_vacuum(), _laid(), _turn(),
        _jumper(), _jumper_in_waves(),
    )
}  # fmt: skip
