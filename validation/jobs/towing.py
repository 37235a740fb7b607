"""Towing: fish, turns, arrays, an emergency stop."""

from __future__ import annotations

import numpy as np

import cablemodel as cm
from tests.verification.references.jobs import KNOT, Kind, hanging_line, lumped_line, steady_turn
from validation.jobs.book import Answer, Result, job, model, picture, scene, shape


def kinds(given: cm.Scene) -> dict[str, Kind]:
    """Cables of a scene as the references need them."""
    data = given.to_dict()
    return {name: Kind(one, given.environment.gravity) for name, one in data["cable_types"].items()}


@job
def tow_fish() -> Result:
    """Balance of forces from the fish up."""
    given, ours = scene("tow_fish"), model("tow_fish")
    speed = 6.0 * KNOT
    items = [(500.0, 0.15 * 0.3), (kinds(given)["tow"], 500.0)]
    tip, force, places = hanging_line(items, lambda z: np.array([-speed, 0.0, 0.0]), np.zeros(3))
    top = float(np.linalg.norm(force))
    answers = [
        Answer("depth of the fish", -ours.tip_position[2], -tip[2], "m", 0.5),
        Answer("layback", -ours.tip_position[0], -tip[0], "m", 0.5),
        Answer("tension at the winch", ours.top_tension, top, "N", 10e-3 * top),
    ]
    depths: dict[float, tuple[float, float]] = {}
    for knots in (2.0, 3.0, 4.0, 6.0, 8.0):
        other = model("tow_fish", [f"vessel.velocity.0={knots} kn"])
        flow = np.array([-knots * KNOT, 0.0, 0.0])
        depths[knots] = (-other.tip_position[2], -hanging_line(items, lambda z, u=flow: u,
                                                               np.zeros(3))[0][2])  # fmt: skip
    x = list(depths)
    series = {
        "cablemodel": (x, [depths[k][0] for k in x]),
        "independent": (x, [depths[k][1] for k in x]),
    }
    shapes = {"cablemodel": shape(ours), "independent": places}
    return answers, picture(shapes, series, ("speed [kn]", "depth of the fish [m]"))


@job
def tow_depth() -> Result:
    """As tow_fish, with the lengths before and after 300 m were paid out."""
    given, ours = scene("tow_depth"), model("tow_depth")
    kind, area, speed = kinds(given)["armoured"], 0.3 * 0.4, 4.0 * KNOT

    def expected(length: float):
        water = np.array([-speed, 0.0, 0.0])
        items = [(2500.0, area), (kind, length)]
        return hanging_line(items, lambda z: water, np.zeros(3))

    before = expected(300.0)
    answers = [
        Answer("depth with 300 m", -ours.tip_position[2], -before[0][2], "m", 0.3),
        Answer("tension with 300 m", ours.top_tension, float(np.linalg.norm(before[1])), "N", 40.0),
    ]
    shapes, times, depths, tensions = {"300 m out": shape(ours)}, [], [], []
    for k in range(1, 401):
        ours.step_to(5.0 * k)
        times.append(ours.time)
        depths.append(-ours.tip_position[2])
        tensions.append(ours.top_tension)
    out = ours.line_length
    after = expected(out)
    moved = shape(ours) - ours.vessel_position
    shapes |= {f"{out:.0f} m out": moved, "independent": after[2]}
    answers += [
        Answer("cable out in the end", out, 605.0, "m", 0.1),
        Answer("depth in the end", depths[-1], -after[0][2], "m", 0.9),
        Answer("tension in the end", tensions[-1], float(np.linalg.norm(after[1])), "N", 50.0),
    ]
    flat = np.full(2, -after[0][2])
    series = {"depth": (times, depths), "independent, in the end": ([1500.0, 2000.0], flat)}
    return answers, picture(shapes, series, ("time [s]", "depth of the fish [m]"))


@job
def turn_with_fish() -> Result:
    """A boundary value problem in the frame that turns with the ship."""
    given, ours = scene("turn_with_fish"), model("turn_with_fish")
    times, tops, depths = [], [], []
    for k in range(1, 301):
        ours.step_to(10.0 * k)
        times.append(ours.time)
        tops.append(ours.top_tension)
        depths.append(-ours.tip_position[2])
    kind = kinds(given)["wire"]
    turned = steady_turn(kind, 1000.0, 6686.0, 0.4254 * 0.77, 1135.0 + 107.0, 295.0, 6.0 * KNOT)
    top, end = turned
    centre = np.array([6.0 * KNOT * 60.0, 295.0])
    off = float(np.hypot(*(ours.tip_position[:2] - centre)))
    answers = [
        Answer("tension in the turn", tops[-1], top, "N", 3e-3 * top),
        Answer("depth in the turn", depths[-1], -end[2], "m", 0.6),
        Answer("radius of the fish's circle", off, float(np.hypot(*end[:2])), "m", 0.6),
    ]
    path = shape(ours)
    series = {"tension": (times, tops), "independent": ([1500.0, 3000.0], [top, top])}
    shapes = {"line from above, in the end": path}
    return answers, picture(shapes, series, ("time [s]", "top tension [N]"), (0, 1))


@job
def turn_with_array() -> Result:
    """Straight: force balance. In the turn: masses on springs."""
    given, ours = scene("turn_with_array"), model("turn_with_array")
    known, speed = kinds(given), 5.0 * KNOT
    water = np.array([-speed, 0.0, 0.0])
    items = [(1.0, 0.1), (known["array"], 1000.0), (known["leadin"], 600.0)]
    tip, force, _ = hanging_line(items, lambda z: water, np.zeros(3), (-400.0, -1.0))
    top = float(np.linalg.norm(force))
    answers = [
        Answer("depth of the drogue, straight", -ours.tip_position[2], -tip[2], "m", 1.6),
        Answer("tension, straight", ours.top_tension, top, "N", 10e-3 * top),
    ]
    motion = given.motion()
    times = np.arange(1, 141) * 15.0
    chain = [(known["leadin"], 600.0, 15), (known["array"], 1000.0, 25)]
    s = np.r_[np.linspace(0.0, 600.0, 16), np.linspace(600.0, 1600.0, 26)[1:]]
    start = ours.sample(s).position
    moved, pulled = lumped_line(
        chain, (5.0, 1.0, 0.1), lambda t: motion.evaluate(t)[:2], start, times, step=5.0
    )
    deepest, tops = [], []
    shapes = {"straight": shape(ours)}
    for t in times:
        ours.step_to(t)
        here = shape(ours, 400)
        deepest.append(-float(here[:, 2].min()))
        tops.append(ours.top_tension)
        if abs(t - 1500.0) < 1.0:
            shapes["at 1,500 s"] = here
    other = -moved[:, :, 2].min(axis=1)
    answers += [
        Answer("deepest point of the line in the turn", max(deepest), float(other.max()), "m", 4.0),
        Answer("lowest tension in the turn", min(tops), float(pulled.min()), "N", 0.03 * top),
    ]
    series = {"cablemodel": (times, deepest), "independent": (times, other)}
    return answers, picture(shapes, series, ("time [s]", "deepest point [m]"), (0, 1))


@job
def emergency_stop() -> Result:
    """Masses on springs, until the fish is down."""
    given, ours = scene("emergency_stop"), model("emergency_stop")
    kind, motion = kinds(given)["armoured"], given.motion()
    times = np.arange(1, 151) * 0.5
    s = np.linspace(0.0, 400.0, 21)
    start = ours.sample(s).position
    moved, _ = lumped_line(
        [(kind, 400.0, 20)],
        (150.0 + 80.0, 1200.0, 0.3 * 0.8),
        lambda t: motion.evaluate(t)[:2],
        start,
        times,
    )
    other = moved[:, -1, 2]
    found, shapes = [], {"at 0 s": shape(ours)}
    for t in times:
        ours.step_to(t)
        found.append(float(ours.tip_position[2]))
        if t in (30.0, 60.0):
            shapes[f"at {t:g} s"] = shape(ours)

    def landing(heights):
        k = int(np.argmax(np.asarray(heights) < -219.5))
        low, high = heights[k - 1], heights[k]
        return float(times[k - 1] + 0.5 * (low + 219.5) / (low - high))

    fall = -np.gradient(np.array(found), times)
    fell = -np.gradient(other, times)
    before = times < 60.0
    answers = [
        Answer("the fish is 0.5 m above the floor at", landing(found), landing(other), "s", 1.0),
        Answer("fastest fall", float(fall[before].max()), float(fell[before].max()), "m/s", 0.1),
        Answer("depth at 40 s", -found[79], -float(other[79]), "m", 1.0),
    ]
    free = other > -219.0
    series = {"cablemodel": (times, found), "independent": (times[free], other[free])}
    return answers, picture(shapes, series, ("time [s]", "height of the fish [m]"))
