"""Published experiments and simulations: a jumper in motion and waves, a lazy wave in a basin."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

import cablemodel as cm
from validation import draw
from validation.rows import DATA, Row, family

Array = NDArray[np.float64]

# Lowe and Langley 2006 --------------------------------------------------------------------------

CASES = np.loadtxt(DATA / "lowe_langley.csv", delimiter=",", skiprows=3)
"""Case, time [s], effective tension at the top [kN]; a motion or wave has come up by t = 0."""
WAVES = {4: (0.0, 230.0), 5: (45.0, 165.0), 6: (90.0, 0.0)}
"""Direction and phase at t = 0 of a wave of 10 m and 10 s over 100 m of water [degrees]."""
PERIOD, REACH = 27.0, 10.0
"""Of the top's sinusoidal motion in cases 1 to 3: along x, y and z [s, m]."""


def jumper(case: int) -> cm.CableModel:
    """170 m between points 5 m and 55 m below the surface, 100 m apart."""
    kind = {
        "diameter": 0.396,
        "mass": 165,
        "axial_stiffness": 500e6,
        "bending_stiffness": 120.8e3,
        "drag_normal": 1,
        "drag_tangential": 0,
        "added_mass": 1,
    }
    water: dict[str, Any] = {"water_density": 1000, "gravity": 9.807, "floor": {"z": -100}}
    if case in WAVES:
        way, phase = WAVES[case]
        regular = {"height": 10, "period": 10, "direction": math.radians(way)}
        regular["phase"] = math.radians(phase)
        water["waves"] = {"regular": regular, "ramp": 20.0}
    elif case == 3:  # the top comes out of the water, which a wave of no height ends at z = 0
        water["waves"] = {"regular": {"height": 1e-6, "period": 10}}
    scene = {
        "environment": water,
        "cable_types": {"jumper": kind},
        "line": [{"cable": {"type": "jumper", "length": 170}}],
        "vessel": {"position": [0, 0, -5]},
        "end": {"anchor": [-100, 0, -55]},
        "solver": {"tolerance": 1e-3},
    }
    return cm.CableModel(cm.load_scene(scene))


def top_of_jumper(case: int) -> tuple[Array, Array, Array]:
    """Times [s], published and computed tension at the top [kN]."""
    published = CASES[CASES[:, 0] == case, 1:]
    model, found = jumper(case), []
    ramp = 20.0 if case in WAVES else PERIOD
    # The top's motion is given at least every 0.25 s, up to each time that was published.
    gap = 0.25 if case not in WAVES else ramp
    start = np.array([0.0, 0.0, -5.0])
    for time in published[:, 0]:
        until = ramp + max(0.0, float(time))
        count = max(1, math.ceil((until - model.time) / gap))
        for instant in np.linspace(model.time, until, count + 1)[1:]:
            if case in WAVES:
                model.step_to(float(instant))
                continue
            share = min(instant / ramp, 1.0)
            up = share**3 * (6 * share**2 - 15 * share + 10)
            rise = (30 * share**2 * (share - 1) ** 2) / ramp if share < 1.0 else 0.0
            rate = 2.0 * math.pi / PERIOD
            wave, slope = math.sin(rate * instant), rate * math.cos(rate * instant)
            place, velocity = start.copy(), np.zeros(3)
            place[case - 1] += REACH * up * wave
            velocity[case - 1] = REACH * (rise * wave + up * slope)
            model.step_to(float(instant), vessel_position=place, vessel_velocity=velocity)
        found.append(model.sample(0.0).tension[0] / 1e3)
    return published[:, 0], published[:, 1], np.array(found)


@family("jumper", "Published simulation: a jumper in motion and waves")
def jumpers() -> tuple[list[Row], Any]:
    """Six cases: the top moves along x, y, z; waves along, askew, across."""
    rows, (figure, grid) = [], draw.axes(6, 15.0)
    for case, one in zip(range(1, 7), grid, strict=True):
        times, published, found = top_of_jumper(case)
        rms = float(np.sqrt(np.mean((found - published) ** 2)))
        span = 100.0 * rms / float(np.ptp(published))
        name = f"case {case}, " + (
            "wave" if case in WAVES else f"top moves along {'xyz'[case - 1]}"
        )
        rows.append(
            Row(
                "jumper", name, "Lowe and Langley 2006", "top tension, rms of range", span, 5.0, "%"
            )
        )
        one.plot(times, published, color=draw.REFERENCE, label="published")
        one.plot(times, found, color=draw.FOUND, label="computed")
        draw.label(one, "time [s]", "top tension [kN]" if case == 1 else "", name)
    return rows, figure


# Holcombe et al. 2025 ---------------------------------------------------------------------------

MARKERS = np.loadtxt(DATA / "holcombe_2025.csv", delimiter=",", skiprows=3)
"""Material arc [m], x and z of seven markers [m]; the last one is where the tether holds it."""
HANGOFF = (0.075561, -0.290105)
"""Place of the platform fixing in the same axes [m]."""


def lazy_wave(clamped: bool) -> cm.CableModel:
    """A model cable of 3.67 m, 1:70, with 20 buoyancy modules and 7 markers, in still water.

    A module or marker is a point body: mass, and the weight that its volume leaves in water.
    Modules of 1.36 g with a buoyant force of 27.3 mN, markers of 1.1 g with 14.1 mN (the article's
    table 6; a marker's force is that of its sphere, so that masses weigh beside it); stations as
    in the author's thesis of 2026.
    """
    gravity = 9.80665
    cable = {
        "diameter": 0.0023,
        "mass": 0.0127,
        "axial_stiffness": 65.5e3,
        "bending_stiffness": 6.25e-4,
        "drag_normal": 1.0,
    }
    modules = [(2.14 + i * 1.09 / 19.0, 1.36e-3, 27.3e-3) for i in range(20)]
    marks = [(arc, 1.1e-3, 14.1e-3) for arc in MARKERS[:-1, 0]]
    line: list[dict[str, Any]] = []
    at = 0.0
    for arc, mass, lift in sorted(modules + marks):
        piece = {"type": "c", "length": float(arc - at), "model": "elastica"}
        line.append({"cable": piece})
        line.append({"body": {"mass": mass, "submerged_weight": mass * gravity - lift}})
        at = arc
    line.append({"cable": {"type": "c", "length": float(3.67 - at), "model": "elastica"}})
    vessel: dict[str, Any] = {"position": [HANGOFF[0], 0, HANGOFF[1]]}
    if clamped:
        vessel["connection"] = {"clamped": [0, 0, -1]}
    end = [float(MARKERS[-1, 1]), 0.0, float(MARKERS[-1, 2])]
    scene = {
        "environment": {"water_density": 1000, "gravity": gravity},
        "cable_types": {"c": cable},
        "line": line,
        "vessel": vessel,
        "end": {"anchor": end},
        "solver": {"tolerance": 1e-4},
    }
    return cm.CableModel(cm.load_scene(scene))


def curvature_of_markers(places: Array) -> Array:
    """Of the circles through three markers in a row (n - 2,) [1/m]."""
    a, b, c = places[:-2], places[1:-1], places[2:]
    one, other = b - a, c - a
    area = np.abs(one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0])
    sides = [np.linalg.norm(v, axis=1) for v in (b - a, c - b, c - a)]
    return 2.0 * area / (sides[0] * sides[1] * sides[2])


@family("lazywave", "Measured: a lazy wave in a basin")
def holcombe() -> tuple[list[Row], Any]:
    """Between the two limits of a fixing whose stiffness was not measured."""
    rows, (figure, (left, right)) = [], draw.axes(2)
    measured = MARKERS[:, 1:]
    source = "Holcombe et al. 2025"
    left.errorbar(*measured.T, xerr=0.008, yerr=0.003, fmt="x", color=draw.REFERENCE)
    bend = curvature_of_markers(measured)
    right.plot(MARKERS[1:-1, 0], bend, "x", color=draw.REFERENCE, label="measured")
    # Accepted: what CableDyn's model of the same data leaves, without fitting.
    for clamped, position in ((False, 39.4), (True, 69.4)):
        model = lazy_wave(clamped)
        found = model.sample(MARKERS[:, 0]).position[:, [0, 2]]
        apart = np.linalg.norm(found[:-1] - measured[:-1], axis=1)
        case = "clamped at the fixing" if clamped else "free to turn at the fixing"
        rms = 1e3 * float(np.sqrt(np.mean(apart**2)))
        rows.append(Row("lazywave", case, source, "rms of six markers", rms, position * 1.02, "mm"))
        mine = curvature_of_markers(found)
        off = 100.0 * abs(float(mine.max() / bend.max()) - 1.0)
        # Digitisation leaves the measured one 9 % uncertain.
        rows.append(Row("lazywave", case, source, "largest curvature", off, 9.0, "%"))
        s = np.linspace(0.0, 3.67, 300)
        left.plot(*model.sample(s).position[:, [0, 2]].T, label=case)
        right.plot(MARKERS[1:-1, 0], mine, "o", ms=4, label=case)
    draw.label(left, "x [m]", "z [m]", "crosses: measured")
    draw.label(right, "along the line [m]", "curvature of three markers [1/m]")
    return rows, figure
