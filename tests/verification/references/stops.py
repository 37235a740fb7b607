"""Loads on wires whose winches stop: masses on springs below a sheave, along the vertical alone.

Nothing damps the wire but the drag of its load. Leapfrog near its limit of stability hardly
disperses waves, so that some hundreds of masses follow what a stop sends along the wire.
"""

import math
from dataclasses import dataclass
from typing import Any

import numba
import numpy as np
from numpy.typing import NDArray

G, WATER = 9.80665, 1025.0
OUTPUT = 0.02  # s: between tensions
BEGINS = 2.0  # s: when the winch begins to stop
DRUM = 50.0  # m: of wire that is wound up at first

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Stop:
    """A load that goes down at `rate` on a wire, whose winch stops within `time`."""

    diameter: float
    length: float
    mass: float
    stiffness: float
    load: float
    weight: float
    drag_area: float
    rate: float
    time: float

    @property
    def per_metre(self) -> float:
        """Weight of the wire in water [N/m]."""
        return (self.mass - WATER * math.pi / 4.0 * self.diameter**2) * G

    def scene(self, tolerance: float) -> dict[str, Any]:
        """What a user writes."""
        wire = {
            "diameter": self.diameter,
            "mass": self.mass,
            "axial_stiffness": self.stiffness,
            "drag_normal": 1.2,
            "drag_tangential": 0.0,
        }
        load = {
            "mass": self.load,
            "submerged_weight": self.weight,
            "drag_area": self.drag_area,
            "drag_coefficient": 1.0,
        }
        return {
            "cable_types": {"wire": wire},
            "line": [{"cable": {"type": "wire", "length": self.length}}, {"body": load}],
            "payout": {
                "rate": [
                    {"t": 0.0, "rate": self.rate},
                    {"t": BEGINS, "rate": self.rate},
                    {"t": BEGINS + self.time, "rate": 0.0},
                ],
                "drum": [{"cable": {"type": "wire", "length": DRUM}}],
            },
            "solver": {"tolerance": tolerance},
        }

    def tensions(self, end: float, masses: int = 1600) -> Floats:
        """At the sheave, every OUTPUT from BEGINS to `end` [N]."""
        count = round((end - BEGINS) / OUTPUT)
        return _tensions(
            self.length + self.rate * BEGINS,
            self.mass,
            self.stiffness,
            self.per_metre,
            self.load,
            self.weight,
            0.5 * WATER * self.drag_area,
            self.rate,
            self.time,
            masses,
            count,
        )


@numba.njit(cache=True)
def _tensions(length, mass, stiffness, per_metre, load, weight, drag, rate, time, masses, count):
    """Mass n hangs on mass n + 1, the last one on the sheave; new ones come off the top spring."""
    dx = length / masses
    room = masses + int(0.5 * rate * time / dx) + 4
    x = np.zeros(room)
    v = np.zeros(room)
    spring = np.full(room, dx)
    n = masses
    hung = weight - drag * rate * rate
    for k in range(n - 1, -1, -1):
        x[k] = x[k + 1] + dx * (1.0 + (hung + per_metre * (k + 0.5) * dx) / stiffness)
    # What comes off the sheave is stretched there.
    v[:n] = rate * (1.0 + (hung + per_metre * length) / stiffness)
    parts = math.ceil(OUTPUT / (0.9 * dx / math.sqrt(stiffness / mass)))
    dt = OUTPUT / parts
    found = np.zeros(count)
    for output in range(count):
        for part in range(parts):
            t = output * OUTPUT + (part + 0.5) * dt
            runs = rate * max(0.0, 1.0 - t / time)
            below = 0.0
            for k in range(n):
                pull = stiffness * ((x[k] - x[k + 1]) / spring[k] - 1.0)
                if k == 0:
                    moved = 0.5 * mass * spring[0] + load
                    force = weight + 0.5 * per_metre * spring[0] - drag * abs(v[0]) * v[0]
                else:
                    moved = 0.5 * mass * (spring[k - 1] + spring[k])
                    force = 0.5 * per_metre * (spring[k - 1] + spring[k])
                v[k] += dt * (force + below - pull) / moved
                below = pull
            x[:n] += dt * v[:n]
            spring[n - 1] += dt * runs
            if spring[n - 1] > 2.0 * dx:
                share = 1.0 - dx / spring[n - 1]
                x[n] = x[n - 1] * share
                v[n] = v[n - 1] * share + (1.0 - share) * runs
                spring[n] = spring[n - 1] - dx
                spring[n - 1] = dx
                n += 1
        last = x[n - 1] / spring[n - 1] - 1.0
        before = (x[n - 2] - x[n - 1]) / spring[n - 2] - 1.0
        bent = (last - before) / (spring[n - 1] + spring[n - 2])
        found[output] = stiffness * (last + bent * spring[n - 1])
    return found


def stop(seed: int) -> Stop:
    """One drawn over what winches lower: wires of 12 to 60 mm, 40 to 2,000 m, that carry up to a
    fifth of what breaks them."""
    draw = np.random.default_rng(seed)
    diameter = draw.uniform(0.012, 0.06)
    length = math.exp(draw.uniform(math.log(40.0), math.log(2000.0)))
    mass, breaks = 3900.0 * diameter**2, 6e8 * diameter**2
    weight = draw.uniform(0.04, 0.2) * breaks - mass * length * 0.87 * G
    weight = max(weight, 0.03 * breaks)
    denser = draw.uniform(1.5, 7.0)
    load = weight / G / (1.0 - WATER / 1000.0 / denser)
    return Stop(
        diameter=diameter,
        length=length,
        mass=mass,
        stiffness=4.2e10 * diameter**2,
        load=load,
        weight=weight,
        rate=math.exp(draw.uniform(math.log(0.2), math.log(1.5))),
        time=math.exp(draw.uniform(math.log(0.2), math.log(2.0))),
        drag_area=(load / denser / 1000.0) ** (2.0 / 3.0),
    )
