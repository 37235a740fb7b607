"""Laying cable, and dragging what searches for it."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

import cablemodel as cm
from tests.verification.references.jobs import KNOT
from tests.verification.references.lays import LIGHT, independent, lay_angle
from validation.jobs.book import FOLDER, Answer, Result, job, model, picture, scene, shape
from validation.jobs.towing import kinds


@job
def lay_with_slack() -> Result:
    """Zajac's differential equation, with stretch and the momentum of what runs."""
    ours = model("lay_with_slack")
    top, length = independent(LIGHT, 5.0, 5.1 * KNOT, 0.0, 4000.0, straight=True)
    _, angle = lay_angle(LIGHT, 5.0 * KNOT)
    shapes, start = {"at 0 s": shape(ours)}, shape(ours)
    slope = np.degrees(np.arctan2(-start[20, 2], -start[20, 0]))
    hung = ours.line_length - ours.floor_length
    laid, times, tops = ours.floor_length, [], []
    for k in range(1, 13):
        ours.step_to(10.0 * k)
        times.append(ours.time)
        tops.append(ours.top_tension)
    shapes["at 120 s"] = shape(ours)
    answers = [
        Answer("angle to the horizontal", float(slope), float(np.degrees(angle)), "deg", 0.1),
        Answer("cable in the water", hung, length, "m", 0.01 * length),
        Answer("tension at the ship", tops[-1], top, "N", 0.01 * top),
        Answer("cable laid in 120 s", ours.floor_length - laid, 120 * 5.1 * KNOT, "m", 10.0),
    ]
    series = {"cablemodel": (times, tops), "independent": ([0, 120], [top, top])}
    return answers, picture(shapes, series, ("time [s]", "top tension [N]"))


@job
def lay_from_anchor() -> Result:
    """Zajac's differential equation from the floor up to the chute."""
    ours = cm.SystemModel(FOLDER / "lay_from_anchor.yaml")
    cable, rate = ours.lines["cable"], 2.02 * KNOT
    chute = float(cable.sample([0.0]).position[0, 2])
    top, _length = independent(LIGHT, 2.0, rate, 0.0, 200.0 + chute, straight=True)
    _, angle = lay_angle(LIGHT, 2.0 * KNOT)
    shapes = {"at 0 s": shape(cable)}
    start = shapes["at 0 s"]
    way = start[0] - start[20]
    slope = np.degrees(np.arctan2(way[2], way[0]))
    laid, times, tops = cable.on_floor.floor_length, [0.0], [cable.start_tension]
    for k in range(1, 25):
        ours.step_to(5.0 * k)
        times.append(ours.time)
        tops.append(cable.start_tension)
    shapes["at 120 s"] = shape(cable)
    more = cable.on_floor.floor_length - laid
    answers = [
        Answer("angle to the horizontal", float(slope), float(np.degrees(angle)), "deg", 0.1),
        Answer("tension at the start", tops[0], top, "N", 0.01 * top),
        Answer("tension at 120 s", tops[-1], top, "N", 0.01 * top),
        Answer("cable laid in 120 s", more, 120.0 * rate, "m", 2.0),
    ]
    series = {"cablemodel": (times, tops), "independent": ([0, 120], [top, top])}
    shown = dict(reversed(shapes.items()))
    figure = picture(shown, series, ("time [s]", "tension at the chute [N]"), (0, 1))
    figure.axes[1].set_ylim(0.0, 1.2 * top)
    return answers, figure


def pressed_by_meanders(bending: float, rubs: float, slack: float) -> tuple[float, float]:
    """What presses cable that is laid into meanders [N]: their bending alone, and with friction.

    Waves of a length l that take a slack s up store 4 pi^2 EI s / l^2 per length; laying them
    aside rubs over 2/pi of their height, by 2 rubs l sqrt(s) / pi^2. l is where the sum is least.
    bending [N m2]; rubs: friction per length [N/m].
    """
    wave = np.cbrt(4.0 * np.pi**4 * bending * np.sqrt(slack) / rubs)
    bends = 4.0 * np.pi**2 * bending / wave**2
    return float(bends), float(bends + 2.0 * rubs * wave / (np.pi**2 * np.sqrt(slack)))


@job
def lay_speeding_up() -> Result:
    """Zajac's differential equation at both speeds, and the work that meanders take."""
    ours = model("lay_speeding_up")
    slow, _ = independent(LIGHT, 1.0, 1.0 * KNOT, 0.0, 100.0, straight=True)
    fast, length = independent(LIGHT, 5.0, 5.1 * KNOT, 0.0, 100.0, straight=True)
    weight, _ = lay_angle(LIGHT, 5.0 * KNOT)
    shapes, times, tops = {}, [], []
    for k in range(1, 201):
        ours.step_to(5.0 * k)
        times.append(ours.time)
        tops.append(ours.top_tension)
        if k in (12, 60, 120, 200):
            shapes[f"at {5 * k} s"] = shape(ours)
    arcs = np.linspace(300.0, ours.line_length, 20_000)
    places = ours.sample(arcs).position
    laid = (places[:, 0] > 1200.0) & (places[:, 0] < 1550.0)
    slack = np.ptp(arcs[laid]) / np.ptp(places[laid, 0]) - 1.0
    least, most = pressed_by_meanders(20.0, 0.5 * weight, 0.02)
    fast -= 0.5 * (least + most)
    mean = float(np.mean(tops[170:]))
    answers = [
        Answer("tension at 1 knot", tops[11], slow, "N", 0.01 * slow),
        Answer("mean tension at 5 knots", mean, fast, "N", 0.5 * (most - least)),
        Answer("cable in the water", ours.line_length - ours.floor_length, length, "m", 5.0),
        Answer("slack on the floor", 100.0 * slack, 2.0, "%", 0.1),
    ]
    series = {
        "cablemodel": (times, tops),
        "independent": ([0, 60, 60, 850, 1000], [slow, slow, np.nan, fast, fast]),
    }
    return answers, picture(shapes, series, ("time [s]", "top tension [N]"))


@job
def drag_grapnel() -> Result:
    """The static equation up from the floor, pulled by friction and drag of what lies."""
    given, ours = scene("drag_grapnel"), model("drag_grapnel")
    rope, weight = given.cable_types["rope"], kinds(given)["rope"].weight
    depth, length, speed, friction = 1000.0, 1800.0, 0.2, 0.6
    along = 0.5 * 1025.0 * np.pi * rope.diameter * rope.drag_tangential
    across = 0.5 * 1025.0 * rope.diameter * rope.drag_normal

    def slope(_s, y):
        pull = np.hypot(*y[2:])
        t = y[2:] / pull
        flow = np.array([-speed, 0.0])
        over = flow - (flow @ t) * t
        drag = across * np.hypot(*over) * over + along * abs(flow @ t) * (flow @ t) * t
        return np.concatenate([t * (1.0 + pull / rope.axial_stiffness), [0.0, weight] - drag])

    def up(lies):
        pull = friction * 10e3 + 0.5 * 1025.0 * 0.5 * speed**2
        pull += lies * (friction * weight + along * speed**2)
        start = [0.0, -depth, pull, 0.0]
        return solve_ivp(slope, [0.0, length - lies], start, rtol=1e-9, max_step=25.0)

    lies = brentq(lambda lies: up(lies).y[1, -1], 0.0, 700.0)
    hangs = up(lies)
    pulls = np.hypot(*hangs.y[2:])
    top = float(pulls[-1])
    for k in range(1, 151):
        ours.step_to(20.0 * k)
    answers = [
        Answer("tension at the ship", ours.top_tension, top, "N", 0.001 * top),
        Answer("rope on the floor", ours.floor_length, lies, "m", 1.8),
        Answer("speed of the grapnel", ours.tip_velocity[0], 0.2, "m/s", 0.005),
    ]
    where = np.linspace(0.0, length, 181)
    series = {
        "cablemodel": (where, ours.sample(where).tension),
        "independent": ((length - lies - hangs.t)[::5], pulls[::5]),
    }
    return answers, picture(
        {"in the end": shape(ours)}, series, ("from the ship [m]", "tension [N]")
    )


@job
def pay_out_on_a_pile() -> Result:
    """What hangs is weighed, less the drag along what runs down at a steady rate."""
    given, ours = scene("pay_out_on_a_pile"), model("pay_out_on_a_pile")
    rope, depth, rate = given.cable_types["rope"], 50.0, 0.5
    weight = kinds(given)["rope"].weight
    drag = 0.5 * 1025.0 * rope.drag_tangential * np.pi * rope.diameter * rate**2 * depth
    times, tops, shapes = [], [], {}
    for k in range(1, 151):
        ours.step_to(2.0 * k)
        times.append(ours.time)
        tops.append(ours.top_tension)
        if k in (20, 63, 150):
            shapes[f"at {2 * k} s"] = shape(ours)
    running, hangs = float(np.mean(tops[40:60])), weight * depth
    down = weight * (ours.line_length - depth)
    answers = [
        Answer("tension while it pays out", running, hangs - drag, "N", 0.02 * hangs),
        Answer("tension in the end", tops[-1], hangs, "N", 0.03 * hangs),
        Answer("what the floor bears", float(ours.floor_force[2]), down, "N", 0.03 * hangs),
    ]
    series = {
        "cablemodel": (times, tops),
        "independent": ([20, 126, 128, 300], [hangs - drag, hangs - drag, hangs, hangs]),
    }
    return answers, picture(shapes, series, ("time [s]", "top tension [N]"))
