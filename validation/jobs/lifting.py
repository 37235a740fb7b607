"""Lifting and lowering: winches, waves, resonance, currents."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from tests.verification.references import jobs as reference
from tests.verification.references.jobs import DENSITY, GRAVITY, hanging_line
from tests.verification.references.motion import pendulum_period
from tests.verification.references.static_cable import hanging_length
from validation.jobs.book import Answer, Result, job, model, picture, scene, shape
from validation.jobs.towing import kinds


@job
def winch_stop() -> Result:
    """Masses on springs."""
    ours = model("winch_stop")
    ours.step_to(20.0)
    times = np.arange(1, 251) * 0.02
    tops = []
    for t in times:
        ours.step_to(20.0 + t)
        tops.append(ours.top_tension)
    other = reference.lumped_load(times)
    found = np.array(tops)
    answers = [
        Answer("highest tension", found.max() / 1e3, other.max() / 1e3, "kN", 3.0),
        Answer("lowest tension", found.min() / 1e3, other.min() / 1e3, "kN", 3.0),
        Answer("ringing, standard deviation", found.std() / 1e3, other.std() / 1e3, "kN", 2.0),
    ]
    series = {"cablemodel": (times, found / 1e3), "independent": (times, other / 1e3)}
    return answers, picture(
        {"line": shape(ours)}, series, ("after the stop [s]", "top tension [kN]")
    )


@job
def snap_in_heave() -> Result:
    """Masses on springs that cannot push."""
    ours = model("snap_in_heave")
    times, tops = np.arange(1, 2001) * 0.02, []
    for t in times:
        ours.step_to(t)
        tops.append(ours.top_tension / 1e3)
    highest = reference.tension_only_wire(reference.heave, 40.0) / 1e3
    answers = [
        Answer("highest tension", max(tops), highest, "kN", 0.05 * highest),
    ]
    series = {"cablemodel": (times, tops), "independent, highest": ([0, 40], [highest, highest])}
    return answers, picture({"line": shape(ours)}, series, ("time [s]", "top tension [kN]"))


@job
def lower_in_waves() -> Result:
    """One mass on the wire's spring, in the wave's own orbits."""
    ours = model("lower_in_waves")
    amplitude, period = 1.25, 9.0
    rate = 2.0 * np.pi / period
    number = rate**2 / GRAVITY
    weight, mass, added, area = 230e3, 30e3, 25e3, 16 * 1.5
    wire, stiffness, air = 8.0, 90e6, 10.0
    wet = (wire - DENSITY * np.pi / 4 * 0.044**2) * GRAVITY

    def out(t):
        ramp = np.clip(t - 30.0, 0.0, 2.0)
        return 18.0 + 0.25 * ramp**2 / 4.0 + 0.25 * max(t - 32.0, 0.0)

    def water(t, x, z):
        """Velocity and acceleration of the water (x, z)."""
        share = min(t / period, 1.0)
        up = share**3 * (6 * share**2 - 15 * share + 10)
        rise = 30 * share**2 * (1 - share) ** 2 / period
        decay, phase = amplitude * rate * np.exp(number * z), number * x - rate * t
        speed = decay * np.array([np.cos(phase), np.sin(phase)])
        slope = decay * rate * np.array([np.sin(phase), -np.cos(phase)])
        return up * speed, up * slope + rise * speed

    def pull(t, x, z):
        length = out(t)
        hang = wire * GRAVITY * air + wet * max(length - air, 0.0)
        # At its upper end; the stretch by its own weight is half of that by the same at its end.
        end = stiffness * (np.hypot(x, air - z) / length - 1.0) - 0.5 * hang
        return end, end + hang

    def slopes(t, y):
        place, velocity = y[:2], y[2:]
        speed, slope = water(t, *place)
        u = speed - velocity
        force = 0.5 * DENSITY * area * np.linalg.norm(u) * u
        force = force + (mass - weight / GRAVITY + added) * slope - [0.0, weight]
        way = np.array([-place[0], air - place[1]])
        force = force + pull(t, *place)[0] * way / np.linalg.norm(way)
        return np.r_[velocity, force / (mass + added + wire * out(t) / 3.0)]

    hang = wire * GRAVITY * 10.0 + wet * 8.0
    start = [0.0, air - 18.0 * (1.0 + (weight + 0.5 * hang) / stiffness), 0.0, 0.0]
    times = np.arange(1, 1201) * 0.1
    found = solve_ivp(slopes, (0.0, 120.0), start, "LSODA", t_eval=times, rtol=1e-7, atol=1e-7,
                      max_step=0.05)  # fmt: skip
    other = np.array([pull(t, *y[:2])[1] for t, y in zip(times, found.y.T, strict=True)]) / 1e3
    tops = []
    for t in times:
        ours.step_to(t)
        tops.append(ours.top_tension / 1e3)
    ours_late, other_late = np.array(tops)[150:], other[150:]
    span = float(np.ptp(other_late))
    answers = [
        Answer("highest tension", ours_late.max(), other_late.max(), "kN", 0.04 * span),
        Answer("lowest tension", ours_late.min(), other_late.min(), "kN", 0.04 * span),
        Answer("depth after 120 s", -ours.tip_position[2], -found.y[1, -1], "m", 0.05),
    ]
    series = {"cablemodel": (times, tops), "independent": (times, other)}
    return answers, picture({"line": shape(ours)}, series, ("time [s]", "top tension [kN]"))


@job
def load_resonance() -> Result:
    """b tan b = m L / M of a bar with a mass at its end."""
    answers, lengths = [], [250.0, 500.0, 1000.0, 1500.0, 2000.0, 3000.0]
    found, exact = [], []
    for length in lengths:
        ours = model("load_resonance", [f"line.0.cable.length={length}"])
        ratio = 21.0 * length / 70e3
        root = brentq(lambda b, r=ratio: b * np.tan(b) - r, 1e-6, 0.5 * np.pi - 1e-6)
        expected = 2.0 * np.pi * length / (root * np.sqrt(250e6 / 21.0))
        modes = 2.0 * np.pi / ours.natural_frequencies(40)
        period = float(modes[np.argmin(np.abs(modes - expected))])
        found.append(period)
        exact.append(expected)
        if length in (500.0, 1500.0, 3000.0):
            name = f"period with {length:,.0f} m"
            answers.append(Answer(name, period, expected, "s", 0.01 * expected))
    series = {"cablemodel": (lengths, found), "independent": (lengths, exact)}
    return answers, picture(
        {"line": shape(model("load_resonance"))}, series, ("wire [m]", "period [s]")
    )


@job
def crane_swing() -> Result:
    """The period of a pendulum, by an elliptic integral."""
    ours = model("crane_swing")
    times, places = np.arange(1, 401) * 0.1, []
    for t in times:
        ours.step_to(t)
        places.append(ours.tip_position[0])
    x = np.array(places)
    k = np.flatnonzero(np.diff(np.sign(x)) != 0)
    crossings = times[k] - x[k] * 0.1 / (x[k + 1] - x[k])
    period = float(2.0 * np.diff(crossings).mean())
    angle = float(np.arctan2(2.6158, 29.8995))
    # The wire swings along: its inertia is a third of its mass, its moment a half of its weight.
    ratio = 4.0 * 30.0 / 8000.0
    stretch = 8000.0 * GRAVITY / 60e6
    length = 30.0 * (1.0 + stretch) * (1.0 + ratio / 3.0) / (1.0 + ratio / 2.0)
    exact = pendulum_period(length, angle)
    answers = [
        Answer("period", period, exact, "s", 2e-3 * exact),
        Answer("reach", float(np.abs(x).max()), 30.0142 * np.sin(angle), "m", 0.03),
    ]
    series = {
        "cablemodel": (times, x),
        "independent": (times, 2.6158 * np.cos(2.0 * np.pi * times / exact)),
    }
    return answers, picture({"line": shape(ours)}, series, ("time [s]", "x of the load [m]"))


@job
def load_in_current() -> Result:
    """Balance of forces from the load up, in three dimensions."""
    given, ours = scene("load_in_current"), model("load_in_current")
    depths = [-800.0, -200.0, 0.0]

    def water(z):
        return np.array(
            [np.interp(z, depths, [0, 0.7, 1.2]), np.interp(z, depths, [0.3, 0.4, 0.0]), 0.0]
        )

    items = [(30e3, 6 * 1.2), (kinds(given)["wire"], 800.0)]
    tip, force, places = hanging_line(items, water, np.zeros(3))
    top = float(np.linalg.norm(force))
    found = ours.tip_position
    answers = [
        Answer("offset along x", found[0], tip[0], "m", 0.4),
        Answer("offset along y", found[1], tip[1], "m", 0.4),
        Answer("depth", -found[2], -tip[2], "m", 0.4),
        Answer("tension at the winch", ours.top_tension, top, "N", 3e-3 * top),
    ]
    mine = shape(ours)
    series = {"cablemodel": (mine[:, 1], mine[:, 2]), "independent": (places[:, 1], places[:, 2])}
    shapes = {"cablemodel": mine, "independent": places}
    return answers, picture(shapes, series, ("y [m]", "z [m]"))


@job
def nylon_stretch() -> Result:
    """The integral of the strain along a vertical rope."""
    ours = model("nylon_stretch")
    curve = [6.0e-6, -4.0e-10, 1.5e-14]
    length = hanging_length(1000.0, 0.4, 9000.0, curve)
    answers = [
        Answer("depth of the lander", -ours.tip_position[2], length, "m", 0.3),
        Answer("tension at the ship", ours.top_tension, 9400.0, "N", 10.0),
    ]
    weights = [2e3, 5e3, 9e3, 12e3, 16e3]
    found, exact = [], []
    for weight in weights:
        other = model("nylon_stretch", [f"line.1.body.submerged_weight={weight}"])
        found.append(-other.tip_position[2] - 1000.0)
        exact.append(hanging_length(1000.0, 0.4, weight, curve) - 1000.0)
    series = {"cablemodel": (weights, found), "independent": (weights, exact)}
    return answers, picture({"line": shape(ours)}, series, ("weight [N]", "stretch [m]"))


@job
def recover_lander() -> Result:
    """Weights and drag of what moves up steadily."""
    ours = model("recover_lander")
    wet = (0.72 - DENSITY * np.pi / 4 * 0.014**2) * GRAVITY
    drag = 0.5 * DENSITY * 2.5 * 1.1 * 0.8**2
    along = 0.5 * DENSITY * 0.01 * np.pi * 0.014 * 0.8**2
    times, tops, expected = np.arange(1, 301) * 2.0, [], []
    for t in times:
        ours.step_to(t)
        tops.append(ours.top_tension)
        expected.append(5.5e3 + drag + (wet + along) * ours.line_length)
    found, other = np.array(tops), np.array(expected)
    late = times > 40.0
    answers = [
        Answer("tension at rest", model("recover_lander").top_tension, 5.5e3 + 600 * wet, "N", 95),
        Answer("tension after 100 s", found[49], other[49], "N", 95),
        Answer("tension after 600 s", found[-1], other[-1], "N", 95),
        Answer("cable out after 600 s", ours.line_length, 600 - 0.8 * 585, "m", 0.1),
    ]
    series = {"cablemodel": (times, found), "independent": (times[late], other[late])}
    return answers, picture({"line": shape(ours)}, series, ("time [s]", "top tension [N]"))
