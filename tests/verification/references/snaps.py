"""Loads below the tip of a crane that drops or heaves: masses on springs that cannot push.

All on one vertical. Springs have dashpots, without which these masses do not converge: what is
slack is pulled taut in shocks. Jobs are drawn over what cranes hoist; `snaps` leaves those out
that do not go slack, or whose answer depends on the number of masses.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

G, WATER, AIR = 9.80665, 1025.0, 1.2
OUTPUT = 0.005  # s: between tensions that the masses leave
SLACK = 0.02  # of the tension at rest: less is none
SLACK_FOR = 0.05  # s: what counts as slack at all
HIGHEST_STRAIN = 0.02  # of wires that still hold
OVER_FOR = 0.2  # s: for which the tension stays below that at rest when a snap is over
SAME = 1.02  # ratio of answers of twice as many masses

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Hoist:
    """A load on a wire below a tip that goes down at `speed` at `time`, linear between rows."""

    length: float
    mass: float
    stiffness: float
    damping: float
    diameter: float
    load: float
    weight: float
    drag: float
    density: float
    time: Floats
    speed: Floats

    @property
    def per_metre(self) -> float:
        """Weight of the wire less that of what it displaces [N/m]."""
        return (self.mass - self.density * math.pi / 4.0 * self.diameter**2) * G

    @property
    def at_rest(self) -> float:
        """Tension at the tip before anything moves [N]."""
        return self.weight + self.per_metre * self.length

    def scene(self, tolerance: float, bending: float = 0.0) -> dict[str, Any]:
        """What a user writes; bending: stiffness over that of a solid wire, EA d^2 / 16 [-]."""
        rows = [
            {"t": float(t), "velocity": [0.0, 0.0, -float(v)]}
            for t, v in zip(self.time, self.speed, strict=True)
        ]
        wire = {
            "diameter": self.diameter, "mass": self.mass, "axial_stiffness": self.stiffness,
            "axial_damping": self.damping, "drag_normal": 1.2, "drag_tangential": 0.0,
            "bending_stiffness": bending * self.stiffness * self.diameter**2 / 16.0,
        }  # fmt: skip
        load = {
            "name": "load", "mass": self.load, "submerged_weight": self.weight,
            "drag_area": self.drag, "drag_coefficient": 1.0,
        }  # fmt: skip
        return {
            "environment": {"water_density": self.density},
            "cable_types": {"wire": wire},
            "line": [{"cable": {"type": "wire", "length": self.length}}, {"body": load}],
            "vessel": {"velocity": rows},
            "run": {"duration": float(self.time[-1]), "output_interval": OUTPUT},
            "solver": {"tolerance": tolerance},
        }


def drawn(seed: int) -> Hoist:
    """A hoist of 0.4 to 8 t on 30 to 500 m, in the sea or in air; its tip heaves faster than the
    load falls, or drops and stops."""
    chance = np.random.default_rng(seed)
    in_air = bool(chance.integers(2))
    length = float(10.0 ** chance.uniform(1.5, 2.7))
    stiffness = float(10.0 ** chance.uniform(7.3, 8.3))
    mass = stiffness / float(10.0 ** chance.uniform(6.6, 7.1))
    load = stiffness * float(10.0 ** chance.uniform(-3.9, -3.2)) / G
    share = 1.0 if in_air else chance.uniform(0.5, 0.88)
    drag = 0.0 if in_air else chance.uniform(0.3, 1.0) * load / 4000.0
    damping = chance.choice([0.002, 0.004, 0.01]) * math.sqrt(stiffness * mass) * length
    if chance.integers(2):
        period = chance.uniform(3.0, 7.0)
        turn = 2.0 * math.pi / period
        fastest = min(6.0, chance.uniform(0.7, 1.6) * G / turn if in_air else chance.uniform(2, 5))
        time = np.arange(0.0, 2.0 * period, 0.02)
        speed = fastest * np.sin(turn * time) * np.minimum(time / period, 1.0)
    else:
        fastest, ramp, hold = chance.uniform([1.5, 0.1, 0.2], [5.0, 0.3, 1.2])
        time = np.cumsum([0.0, 1.0, ramp, hold, ramp, 3.0])
        speed = np.array([0.0, 0.0, fastest, fastest, 0.0, 0.0])
    return Hoist(
        length=length, mass=mass, stiffness=stiffness, damping=float(damping),
        diameter=1.15 * math.sqrt(4.0 * mass / (math.pi * 5000.0)), load=load,
        weight=load * G * share, drag=float(drag), density=AIR if in_air else WATER,
        time=time, speed=speed,
    )  # fmt: skip


@numba.njit
def _tensions(
    count: int, length: float, mass: float, ea: float, ba: float, per_metre: float, load: float,
    weight: float, drag: float, time: Floats, speed: Floats, output: float,
) -> Floats:  # fmt: skip
    """By the symplectic Euler method, from a load that moves steadily as the tip does at first."""
    h = length / count
    dt = 0.3 * h / math.sqrt(ea / mass)
    if ba > 0.0:
        dt = min(dt, 0.3 * mass * h * h / ba)
    own = np.full(count + 1, mass * h)
    own[count] = 0.5 * mass * h + load
    pulls = np.full(count + 1, per_metre * h)
    pulls[count] = 0.5 * per_metre * h + weight
    depth = np.zeros(count + 1)
    for i in range(1, count + 1):
        hangs = weight - drag * speed[0] * abs(speed[0]) + per_metre * (length - (i - 0.5) * h)
        depth[i] = depth[i - 1] + h * (1.0 + hangs / ea)
    down = np.full(count + 1, speed[0])
    tension = np.zeros(count + 2)
    found = np.empty(int(time[-1] / output))
    row, seen, now = 0, 0, 0.0
    while seen < len(found):
        while row < len(time) - 2 and time[row + 1] <= now:
            row += 1
        part = (now - time[row]) / (time[row + 1] - time[row])
        down[0] = speed[row] + part * (speed[row + 1] - speed[row])
        for i in range(1, count + 1):
            strain = (depth[i] - depth[i - 1]) / h - 1.0
            pull = ea * strain + ba * (down[i] - down[i - 1]) / h
            tension[i] = pull if strain > 0.0 and pull > 0.0 else 0.0
        if seen * output <= now:
            found[seen] = tension[1]
            seen += 1
        for i in range(1, count + 1):
            force = tension[i + 1] - tension[i] + pulls[i]
            if i == count:
                force -= drag * down[i] * abs(down[i])
            down[i] += dt * force / own[i]
        for i in range(count + 1):
            depth[i] += dt * down[i]
        now += dt
    return found


def tensions(hoist: Hoist, count: int, output: float = OUTPUT) -> Floats:
    """At the tip, every `output` seconds from 0 on [N], by so many masses."""
    return _tensions(
        count, hoist.length, hoist.mass, hoist.stiffness, hoist.damping, hoist.per_metre,
        hoist.load, hoist.weight, 0.5 * hoist.density * hoist.drag, hoist.time, hoist.speed, output,
    )  # fmt: skip


def first_snap(hoist: Hoist, count: int) -> tuple[float, float] | None:
    """When the first snap is over [s], and the highest tension until then [N]; None: there is
    none. A second one follows from where the first has thrown the load: anything changes it."""
    found = tensions(hoist, count)
    slack = _lasts(found < SLACK * hoist.at_rest, SLACK_FOR)
    if slack is None:
        return None
    taut = np.flatnonzero(found[slack:] > 1.5 * hoist.at_rest)
    if not len(taut):
        return None
    begins = slack + int(taut[0])
    over = _lasts(found[begins:] < hoist.at_rest, OVER_FOR)
    if over is None:
        return None
    end = begins + over + round(OVER_FOR / OUTPUT)
    return OUTPUT * end, float(found[:end].max())


def _lasts(these: NDArray[np.bool_], duration: float) -> int | None:
    """Where the first stretch begins in which they last so long."""
    count = round(duration / OUTPUT)
    found = np.flatnonzero(np.convolve(these, np.ones(count), "valid") == count)
    return int(found[0]) if len(found) else None


def snaps(first: int, count: int) -> Iterator[tuple[Hoist, float, float]]:
    """So many hoists from that seed on, with the end of their first snap [s] and its tension [N]
    by 300 masses."""
    while count > 0:
        hoist = drawn(first)
        first += 1
        coarse, fine = first_snap(hoist, 150), first_snap(hoist, 300)
        if coarse is None or fine is None:
            continue
        ratio = coarse[1] / fine[1]
        if max(ratio, 1.0 / ratio) < SAME and fine[1] < HIGHEST_STRAIN * hoist.stiffness:
            yield hoist, *fine
            count -= 1
