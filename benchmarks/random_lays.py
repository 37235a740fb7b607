"""Random steady lays beside an independent answer: ``python -m benchmarks.random_lays``.

Drawn over 0.5 to 8 knots, 20 to 8,000 m, slopes to 15 degrees, bending stiffness from 0 to 5,000
N m2, with currents and slack. The answer is the shape of a flexible cable that lands without
tension: an ordinary differential equation, integrated upwards from the floor with SciPy. Bending
changes what lies ahead of the touchdown by its layer, and the tension at the vessel not at all.
A steady lay over a level floor goes on as it began: what cable without bending stiffness does is
run for a quarter of its line, and a minute at most.
"""

from __future__ import annotations

import argparse
import math
import time
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.random_scenes.chance import decades
from benchmarks.sections import write_rows

if TYPE_CHECKING:
    import cablemodel as cm

FloatArray = NDArray[np.float64]

RESULTS = Path("docs/benchmarks/random_lays.csv")
HEAD = (
    "seed",
    "knots",
    "depth [m]",
    "slope [deg]",
    "bending stiffness [N m2]",
    "pay-out over speed",
    "current",
    "start [ms]",
    "tension over the answer",
    "touchdown aside [tau L]",
    "lowest of the run",
    "highest of the run",
    "warned",
)
KNOT, SEA, GRAVITY = 1852.0 / 3600.0, 1025.0, 9.80665
SHALLOWEST = math.radians(4.0)
"""Between cable and floor: at less a lay runs away from its vessel, and none is drawn."""


def draw(seed: int, tolerance: float = 1e-3) -> cm.Scene:
    """A lay with .3 of what hangs on the floor; the same for the same number."""
    import cablemodel as cm

    chance = np.random.default_rng(seed)
    while (drawn := _drawn(chance)) is None:
        pass
    hangs = landing(cm.load_scene(drawn)).length
    drawn["line"] = [{"cable": {"type": "c", "length": 1.3 * hangs}}]
    return cm.load_scene({**drawn, "solver": {"tolerance": tolerance}})


def _drawn(chance: np.random.Generator) -> dict[str, Any] | None:
    """A lay; None where its cable would hang too flat above its floor."""
    speed = decades(chance.random(), 0.5, 8.0) * KNOT
    depth = decades(chance.random(), 20.0, 8000.0)
    diameter = decades(chance.random(), 0.012, 0.15)
    area = 0.25 * math.pi * diameter**2
    mass = chance.uniform(1.15, 3.0) * SEA * area
    weight = GRAVITY * (mass - SEA * area)
    stiffest = min(5000.0, 200.0 * (diameter / 0.02) ** 4)
    stiffness = decades(chance.random(), 1.0, stiffest) if chance.random() < 0.5 else 0.0
    drag = chance.uniform(1.0, 2.0)
    kind = {
        "diameter": diameter, "mass": mass, "bending_stiffness": stiffness, "drag_normal": drag,
        "axial_stiffness": depth * weight / decades(chance.random(), 2e-4, 5e-3),
        "drag_tangential": 0.01,
    }  # fmt: skip
    rise = math.tan(math.radians(chance.uniform(0.0, 15.0))) if chance.random() < 0.5 else 0.0
    turn = chance.uniform(0.0, 2.0 * math.pi)
    slope = [rise * math.cos(turn), rise * math.sin(turn)]
    environment: dict[str, Any] = {"floor": {"z": -depth, "slope": slope, "friction": 0.6}}
    if chance.random() < 0.4:
        turn, size = chance.uniform(0.0, 2.0 * math.pi), chance.uniform(0.05, 0.8)
        velocity = [size * math.cos(turn), size * math.sin(turn), 0.0]
        below = [0.1 * value for value in velocity]
        rows = [{"z": 0.0, "velocity": velocity}, {"z": -0.3 * depth, "velocity": below}]
        environment["current"] = {"table": rows}
    slack = chance.choice([0.0, chance.uniform(0.0, 0.03), chance.uniform(0.03, 0.1)])

    push = 0.5 * SEA * drag * diameter * speed**2
    down, up = lay_angle(weight / push), math.atan(slope[0])
    if down - up < SHALLOWEST:
        return None
    # Down a slope the vessel's speed lays with slack, up a slope it would be taut.
    exact = speed * (math.sin(down) - math.sin(up)) / math.sin(down - up)
    rate = max(exact, speed if up < 0.0 else 0.0) * (1.0 + slack)
    return {
        "environment": environment,
        "cable_types": {"c": kind},
        "line": [{"cable": {"type": "c", "length": depth}}],
        "vessel": {"velocity": [speed, 0.0, 0.0]},
        "payout": {"rate": rate, "drum": [{"cable": {"type": "c", "length": 2000.0}}]},
        "run": {"duration": 1.0},
    }


def lay_angle(weight: float) -> float:
    """Of a lay from the horizontal [rad]: k cos a = sin^2 a (Zajac 1957).

    weight: k, over the drag of the vessel's speed across a vertical cable.
    """
    return math.acos((math.hypot(weight, 2.0) - weight) / 2.0)


class Landing(NamedTuple):
    """Where a lay comes down (3,) [m], its tension at the vessel [N], and what hangs [m]."""

    place: FloatArray
    tension: float
    length: float


def landing(scene: cm.Scene) -> Landing:
    """Of flexible cable without tension at its foot, from a vessel at the origin that steams
    towards x over a plane.

    The force P = T t, integrated upwards along cable that stretches by T / EA.
    """
    from scipy.optimize import newton

    floor, speed = scene.environment.floor, float(scene.motion().evaluate(0.0)[1][0])
    assert floor is not None
    assert floor.z is not None
    kind = scene.cable_types[scene.cables[-1].type]
    push = 0.5 * scene.environment.water_density * kind.drag_normal * kind.diameter * speed**2
    down = lay_angle(kind.submerged_weight / push)

    def off(bottom: float) -> float:
        x, y, _z = _lands_at(scene, bottom, down).place
        return floor.height(x, y) - bottom

    bottom = floor.z
    if any(floor.slope):
        straight = floor.z / (1.0 - floor.slope[0] / math.tan(down))
        bottom = float(newton(off, straight, x1=1.01 * straight, tol=1e-7 * abs(floor.z)))
    return _lands_at(scene, bottom, down)


def _lands_at(scene: cm.Scene, bottom: float, down: float) -> Landing:
    """The same of cable that lands at this height [m]. down: its angle there, nearly [rad]."""
    from scipy.integrate import solve_ivp
    from scipy.optimize import fsolve

    kind, water = scene.cable_types[scene.cables[-1].type], scene.environment.water_density
    stiffness = 1.0 / kind.strain_coefficients[0]
    across = 0.5 * water * kind.drag_normal * kind.diameter
    along = 0.5 * water * kind.drag_tangential * math.pi * kind.diameter
    vessel, current = scene.motion().evaluate(0.0)[1], scene.environment.current

    def load(up: FloatArray, z: float) -> FloatArray:
        """On cable of this direction at this height [N/m]."""
        flow = -np.asarray(vessel)
        if current is not None:
            flow += [np.interp(z, current.z, current.velocity[0, :, i]) for i in range(3)]
        runs = flow @ up * up
        normal = flow - runs
        runs = runs + scene.rate_at_start * up
        drag = across * np.linalg.norm(normal) * normal + along * np.linalg.norm(runs) * runs
        return np.asarray(drag - [0.0, 0.0, kind.submerged_weight])

    def grows(_s: float, state: FloatArray) -> list[float]:
        pull = float(np.linalg.norm(state[:3]))
        up = state[:3] / pull
        return [*-load(up, state[5]), *((1.0 + pull / stiffness) * up)]

    def at_the_vessel(_s: float, state: FloatArray) -> float:
        return float(state[5])

    at_the_vessel.terminal = True  # type: ignore[attr-defined]
    # Where nothing pulls, the cable lies along what it has to bear.
    y, z = fsolve(
        lambda u: np.cross(_unit(1, *u), load(_unit(1, *u), bottom))[1:], [0.0, math.tan(down)]
    )
    scale = kind.submerged_weight * abs(bottom)
    found = solve_ivp(
        grows,
        (0.0, 100.0 * abs(bottom)),
        [*(1e-4 * scale * _unit(1, y, z)), 0.0, 0.0, bottom],
        method="Radau",
        rtol=1e-8,
        atol=1e-8 * scale,
        events=at_the_vessel,
    )
    state = found.y[:, -1]
    place = np.array([-state[3], -state[4], bottom])
    return Landing(place, float(np.linalg.norm(state[:3])), float(found.t[-1]))


def _unit(*vector: float) -> FloatArray:
    return np.asarray(np.array(vector) / np.linalg.norm(vector))


class Measured(NamedTuple):
    """How a lay started, and how far from the answer."""

    start: float
    """Processor time [s]."""
    warned: bool
    over: float
    """Tension at the vessel over the answer's; nan: no start was found."""
    aside: float
    """Of the touchdown from where the answer lands [tau L]; nan: there is none."""
    lowest: float
    highest: float
    """Tension at the vessel in the run over the answer's; nan: it is not steady."""


def measure(scene: cm.Scene) -> Measured:
    """Start a lay, and find the answer."""
    import cablemodel as cm

    begin = time.process_time()
    with warnings.catch_warnings(record=True) as said:
        warnings.simplefilter("always")
        try:
            model = cm.CableModel(scene)
        except cm.StaticsError:
            spent = time.process_time() - begin
            return Measured(spent, bool(said), math.nan, math.nan, math.nan, math.nan)
    spent = time.process_time() - begin
    answer, touchdown = landing(scene), model.touchdown_position
    aside = abs(touchdown[1] - answer.place[1]) / (scene.solver.tolerance * scene.line_length)
    over = model.top_tension / answer.tension
    runs = [math.nan]
    if not any(scene.environment.floor.slope) and not scene.cable_types["c"].bending_stiffness:
        end = min(60.0, 0.25 * scene.line_length / scene.rate_at_start)
        runs = [tension / answer.tension for tension in _tensions(model, end)]
    return Measured(spent, bool(said), over, aside, min(runs), max(runs))


def _tensions(model: cm.CableModel, end: float) -> list[float]:
    """At the vessel at forty times of a run [N]; not a number where it stops."""
    import cablemodel as cm

    found = []
    for time_ in np.linspace(0.0, end, 41)[1:]:
        try:
            model.step_to(float(time_))
        except cm.StepError:
            return [math.nan]
        found.append(model.top_tension)
    return found


def row(seed: int, scene: cm.Scene, found: Measured) -> list[str]:
    """What is laid, how it started, and how far from the answer."""
    floor, speed = scene.environment.floor, float(scene.motion().evaluate(0.0)[1][0])
    assert floor is not None
    assert floor.z is not None
    return [
        f"{seed}",
        f"{speed / KNOT:.2f}",
        f"{-floor.z:.0f}",
        f"{math.degrees(math.atan(floor.slope[0])):.1f}",
        f"{scene.cable_types['c'].bending_stiffness:.3g}",
        f"{scene.rate_at_start / speed:.3f}",
        "" if scene.environment.current is None else "yes",
        f"{1e3 * found.start:.0f}",
        "none found" if math.isnan(found.over) else f"{found.over:.5f}",
        f"{found.aside:.3f}",
        "" if math.isnan(found.lowest) else f"{found.lowest:.4f}",
        "" if math.isnan(found.highest) else f"{found.highest:.4f}",
        "yes" if found.warned else "",
    ]


def main(arguments: Sequence[str] | None = None) -> None:
    """Measure so many lays, and keep the rows."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--first", type=int, default=0, help="number of the first lay")
    parser.add_argument("--count", type=int, default=100, help="how many")
    options = parser.parse_args(arguments)
    rows, lays = [], []
    for seed in range(options.first, options.first + options.count):
        scene = draw(seed)
        lays.append(measure(scene))
        rows.append(row(seed, scene, lays[-1]))
    write_rows(RESULTS, HEAD, rows)
    quiet = [lay for lay in lays if not lay.warned and not math.isnan(lay.over)]
    print(f"{len(lays)} lays, {sum(math.isnan(lay.over) for lay in lays)} without a start")
    print(f"start within 2 s: {sum(lay.start <= 2.0 for lay in lays)}")
    print(f"without a warning: {len(quiet)}; of these tensions within the promise (1 %):", end=" ")
    print(f"{sum(abs(lay.over - 1.0) <= 0.01 for lay in quiet)}", end=", ")
    print(f"touchdowns within tau L: {sum(lay.aside <= 1.0 for lay in quiet)}")
    runs = [lay for lay in quiet if not math.isnan(lay.lowest)]
    keep = sum(lay.lowest >= 0.99 and lay.highest <= 1.01 for lay in runs)
    print(f"run: {len(runs)}; of these tensions within the promise throughout: {keep}")


if __name__ == "__main__":
    main()
