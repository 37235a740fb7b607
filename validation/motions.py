"""Motions with closed forms, or differential equations of a few unknowns, as solutions."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

import numpy as np

import cablemodel as cm
from tests.verification import scenes
from tests.verification.references import bodies, motion, tables
from tests.verification.scenes import CABLE_K, IDEAL, pendulum, scene
from validation import draw
from validation.rows import Row, family

TAU = 1e-4


@family("transients", "Converged runs of other programs: tow, release, turn, whip")
def transients() -> tuple[list[Row], Any]:
    """Tables of two prototypes with other unknowns, converged in space and time."""
    rows, (figure, grid) = [], draw.axes(4, 13.0)
    cases = {
        "tow from rest": (scenes.towed, tables.TOWED),
        "release in water": (scenes.released_in_water, tables.RELEASED_IN_WATER),
        "turn of 180 degrees": (scenes.turned, tables.TURNED),
        "whip in air": (scenes.released_in_air, tables.RELEASED_IN_AIR),
    }
    for (case, (make, table)), one in zip(cases.items(), grid, strict=True):
        model = cm.CableModel(make(tolerance=TAU))
        tips, tops, path = [], [], []
        times = np.linspace(0.0, table.time[-1], 101)[1:]
        for t in sorted({*times, *table.time}):
            model.step_to(t)
            tip = model.tip_position - model.vessel_position
            path.append(tip)
            if t in table.time:
                tips.append(tip)
                tops.append(model.top_tension)
        off = float(np.linalg.norm(np.array(tips) - table.tip, axis=1).max())
        limit = TAU * table.length + float(table.position_digits.max())
        source = "two prototypes, converged"
        rows.append(Row("transients", case, source, "free end", off, limit, "m"))
        if not np.isnan(table.tension).any():
            off = float(np.abs(np.array(tops) - table.tension).max())
            limit = 10.0 * TAU * table.largest_tension + float(np.max(table.tension_digits))
            rows.append(Row("transients", case, source, "top tension", off, limit, "N"))
        path = np.array(path)
        down = 1 if case.startswith("turn") else 2
        one.plot(path[:, 0], path[:, down], color=draw.FOUND)
        one.plot(table.tip[:, 0], table.tip[:, down], "x", color=draw.REFERENCE)
        draw.label(one, "x [m]", "y [m]" if down == 1 else "z [m]", case)
    return rows, figure


GUSTS = [(0.0, 0.0), (0.5, 1.0), (1.0, -0.6), (2.0, 0.4), (3.0, 0.4)]


def gust(t: float) -> float:
    """Current [m/s]."""
    return float(np.interp(t, *zip(*GUSTS, strict=True)))


def _rod() -> tuple[list[Row], Any]:
    added = 1025.0 * np.pi / 4.0 * CABLE_K["diameter"] ** 2
    drag = 0.5 * 1025.0 * CABLE_K["drag_normal"] * CABLE_K["diameter"]
    cable = {
        **CABLE_K,
        "drag_tangential": 0.0,
        "axial_stiffness": 1e8,
        "bending_stiffness": 1e6,
    }
    times = np.linspace(0.0, 3.0, 61)[1:]
    at = [t for t, _ in GUSTS]
    exact = motion.rigid_rod(
        1.0, 0.4613, 2.33333, drag, added, gust, at, times, current_inertia=2.0 * added
    )
    current = {"table": [{"t": t, "z": 0.0, "velocity": [c, 0.0, 0.0]} for t, c in GUSTS]}
    model = cm.CableModel(scene(1.0, cable, elements=16, tolerance=1e-5, current=current))
    found = []
    for time in times:
        model.step_to(time)
        found.append(np.arctan2(model.tip_position[0], -model.tip_position[2]))
    off = float(np.abs(np.array(found) - exact).max())
    row = Row("motions", "rod in gusts", "ODE of one angle", "angle", off, 1e-4, "rad")
    return [row], (times, found, exact)


@family("motions", "Closed forms and small ODEs: motions")
def motions() -> tuple[list[Row], Any]:
    """Pendulum, rod, sinking, axial waves, winch, rigid bodies."""
    figure, grid = draw.axes(4, 13.0)
    given, path = pendulum()
    times = np.arange(1, 17) * 0.25
    model = cm.CableModel(cm.load_scene(given.to_dict() | {"solver": {"tolerance": TAU}}))
    found = []
    for t in times:
        model.step_to(t)
        found.append(model.tip_position[[0, 2]])
    found = np.array(found)
    off = float(np.linalg.norm(found - path, axis=1).max())
    rows = [Row("motions", "pendulum, 60 degrees", "ODE of a spring pendulum", "position", off,
                TAU, "m")]  # fmt: skip
    grid[0].plot(times, path[:, 0], color=draw.REFERENCE)
    grid[0].plot(times, found[:, 0], "o", ms=3)
    draw.label(grid[0], "time [s]", "x [m]", "pendulum")
    some, (times, angle, exact) = _rod()
    rows += some
    grid[1].plot(times, exact, color=draw.REFERENCE)
    grid[1].plot(times[::3], angle[::3], "o", ms=3)
    draw.label(grid[1], "time [s]", "angle [rad]", "rod in gusts")
    added = 1025.0 * np.pi / 4.0 * CABLE_K["diameter"] ** 2
    drag = 0.5 * 1025.0 * CABLE_K["drag_normal"] * CABLE_K["diameter"]
    model = cm.CableModel(scene(10.0, CABLE_K, tolerance=1e-5, initial={"straight": [1, 0, 0]}))
    model.step_to(0.3)
    _, depth = motion.sinking(0.3, 2.33333, 0.4613, added, drag)
    off = abs(float(model.sample([8.0]).position[0, 2]) + float(depth))
    rows.append(
        Row("motions", "middle of a cable let go", "V tanh(t/tau)", "depth", off, 1e-4, "m")
    )
    rows += _front(grid[2])
    rows += _payout_pendulum()
    rows += _swing(grid[3])
    return rows, figure


def _front(one: Any) -> list[Row]:
    """A load is hoisted at 1 m/s and stopped within 50 ms; the echo is back after 0.63 s."""
    model = scenes.hoist_that_stops()
    times, found = np.linspace(0.02, 0.66, 33), []
    for t in times:
        model.step_to(t)
        found.append(model.top_tension)
    expected = 8000.0 - np.sqrt(1e7) * np.clip((times - 0.1) / 0.05, 0.0, 1.0)
    off = float(100.0 * np.abs(found - expected).max() / np.sqrt(1e7))
    one.plot(times, expected / 1e3, color=draw.REFERENCE)
    one.plot(times, np.array(found) / 1e3, "o", ms=3)
    draw.label(one, "time [s]", "top tension [kN]", "hoist that stops")
    return [Row("motions", "hoist that stops", "V sqrt(EA m)", "top tension, of the front", off,
                1.0, "%")]  # fmt: skip


def _payout_pendulum() -> list[Row]:
    mass, gravity, length, stiffness, angle = 1000.0, 9.80665, 10.0, 1e9, 1e-3
    stretched = length * (1.0 + mass * gravity * np.cos(angle) / stiffness)
    end = [stretched * np.sin(angle), 0.0, -stretched * np.cos(angle)]
    rows, kind = [], {"diameter": 0.01, "mass": 1e-4, "axial_stiffness": stiffness}
    for rate, shares in ((0.5, (-0.0640678512, -0.6247651622)), (-0.4, (0.612518142, 0.281774882))):
        given = {
            "environment": {"water_density": 0},
            "cable_types": {"c": kind},
            "line": [
                {"cable": {"type": "c", "length": length, "model": "cable", "elements": 4}},
                {"body": {"mass": mass, "submerged_weight": mass * gravity}},
            ],
            "initial": {"points": [[0, 0, 0], end]},
            "payout": {
                "rate": [{"t": 0, "rate": rate}],
                "drum": [{"cable": {"type": "c", "length": 20, "model": "cable"}}],
            },
            "solver": {"tolerance": 1e-6},
        }
        model, worst = cm.CableModel(cm.load_scene(given)), 0.0
        for time, share in zip((5.0, 10.0), shares, strict=True):
            model.step_to(time)
            out = length + rate * time
            x, _, z = model.tip_position
            worst = max(worst, abs(out * np.arctan2(x, -z) - out * angle * share))
        case = f"pendulum, {'paid out' if rate > 0 else 'reeled in'}"
        rows.append(Row("motions", case, "Bessel functions", "position", worst, 1e-5, "m"))
    return rows


def _swing(one: Any) -> list[Row]:
    gravity, stiffness = bodies.GRAVITY, 1e6
    swung = [
        bodies.Body(5.0, 0.7 * 5.0 * gravity, 0.4, centre_offset=0.3, rotary_inertia=0.4),
        bodies.Body(2.0, 2.0 * gravity, 0.3, centre_offset=-0.2, rotary_inertia=0.1),
    ]
    angle = np.radians(40.0)
    way = np.array([np.sin(angle), -np.cos(angle)])
    cable = {**IDEAL, "mass": 1e-6, "submerged_weight": 0.0, "axial_stiffness": stiffness}
    line, start, at = [], [], np.zeros(2)
    for k, body in enumerate(swung):
        line += [
            {"cable": {"type": "C", "length": 1.0, "model": "cable", "elements": 2}},
            {"body": asdict(body)},
        ]
        weight = sum(below.submerged_weight for below in swung[k:])
        at = at + (1.0 + weight * np.cos(angle) / stiffness) * way
        start.append([*at, angle])
        at = at + 2.0 * body.half_length * way
    model = cm.CableModel(
        cm.load_scene(
            {
                "environment": {"gravity": gravity, "water_density": 0.0},
                "cable_types": {"C": cable},
                "line": line,
                "initial": {"points": [[0, 0, 0], [at[0], 0, at[1]]]},
                "solver": {"tolerance": TAU},
            }
        )
    )
    times = np.linspace(0.0, 3.0, 61)[1:]
    exact = bodies.chain(swung, np.ones(2), stiffness, start, times)
    worst, found, expected = 0.0, [], []
    for time, states in zip(times, exact, strict=True):
        model.step_to(time)
        ends = bodies.centre_and_end(swung[1], states[1])[1]
        tip = model.tip_position[[0, 2]]
        worst = max(worst, float(np.linalg.norm(tip - ends)))
        found.append(tip[0])
        expected.append(ends[0])
    one.plot(times, expected, color=draw.REFERENCE)
    one.plot(times[::2], found[::2], "o", ms=3)
    draw.label(one, "time [s]", "x of the end [m]", "two rigid bodies")
    return [Row("motions", "two rigid bodies swing", "Newton's and Euler's equations",
                "end", worst, TAU * 3.4, "m")]  # fmt: skip
