"""``python -m benchmarks.random_systems [--first N] [--count N] [--only N]``: random systems.

System number n is of the kind n modulo the number of KINDS, its numbers drawn from the generator
that n seeds. Each runs at the scene's tolerance (1e-3) and at a hundredth of it, with outputs ten
times as often; what differs by more than is promised, tau L of positions of each line and 10 tau of
its largest tension, is a miss; warned, if the model said that it is unstable: the tolerance decides
when a run leaves such a state. A line that is cut is compared until then: what is left of it is
slack, and rings. As of one line (random_scenes/judge.py) tensions are compared until a line has
pushed: what follows are snaps, whose peaks fall between any two instants; and where a run at four
hundredths of the tolerance and the one at a hundredth are more than half of the promise apart,
there is nothing to judge by (unsettled). The run estimates its own errors: ``share`` is the
largest of what is allowed that it says, and ``silent`` is a miss that it does not tell. Verdicts
are kept in ``docs/stress/random_systems.json``. Nothing in the engine was made from these systems:
a set of numbers judges once.
"""

from __future__ import annotations

import argparse
import json
import math
import time
import warnings
from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.machine import describe
from benchmarks.random_scenes.judge import PUSHES, SETTLED
from cablemodel.errors import CableModelError, UnstableStartWarning
from cablemodel.systems import SystemModel

STORED = Path("docs/stress/random_systems.json")
TAU, FINER, BETWEEN = 1e-3, 1e-5, 4e-5
DURATION, INTERVAL = 40.0, 1.0
G, RHO = 9.81, 1025.0

Data = dict[str, Any]


class Draw:
    """Numbers of one system."""

    def __init__(self, number: int) -> None:
        self.rng = np.random.default_rng(70_000 + number)

    def between(self, low: float, high: float) -> float:
        """Evenly, to four digits: a scene that can be read."""
        return float(f"{self.rng.uniform(low, high):.4g}")

    def decades(self, low: float, high: float) -> float:
        """Evenly in its logarithm."""
        return float(f"{math.exp(self.rng.uniform(math.log(low), math.log(high))):.4g}")

    def chance(self, share: float) -> bool:
        """Whether it is so."""
        return bool(self.rng.random() < share)

    def wire(self, thick: float) -> Data:
        """A wire rope, or a light umbilical, of a diameter [m]."""
        if self.chance(0.7):
            return {
                "diameter": thick, "mass": 3900.0 * thick**2, "axial_stiffness": 4.5e10 * thick**2,
                "drag_normal": 1.2, "added_mass": 1.0, "drag_tangential": 0.01,
            }  # fmt: skip
        return {
            "diameter": thick, "mass": 1100.0 * thick**2, "axial_stiffness": 4e9 * thick**2,
            "drag_normal": 1.2, "added_mass": 1.0, "drag_tangential": 0.01,
            "bending_stiffness": 1e6 * thick**3,
        }  # fmt: skip

    def body(self, mass: float, points: Data, **more: Any) -> Data:
        """A steel body of a mass [kg], as wide as a ball of twice its size."""
        wide = 2.0 * (mass / 7800.0) ** (1.0 / 3.0)
        area = wide * wide
        return {
            "mass": mass, "submerged_weight": 0.85 * mass * G,
            "inertia": [0.1 * mass * wide**2] * 3, "added_mass": 0.15 * mass,
            "added_inertia": 0.02 * mass * wide**2, "drag_area": [0.5 * area, area, area],
            "drag_turning": 0.3 * wide**5, "points": points, **more,
        }  # fmt: skip


def cables(*lengths: float) -> list[Data]:
    """Items of a line."""
    return [{"cable": {"type": "wire", "length": length}} for length in lengths]


def moving(draw: Draw, speed: float) -> Data:
    """A ship's motion: ahead, with a turn or a change of speed."""
    if draw.chance(0.5):
        return {"path": [
            {"straight": {"duration": draw.between(2, 8), "speed": speed, "heading": 0.0}},
            {"turn": {"angle": math.copysign(draw.between(0.3, 1.5), draw.between(-1, 1)),
                      "radius": draw.between(40, 150), "speed": speed}},
            {"straight": {"duration": 60.0, "speed": speed}},
        ]}  # fmt: skip
    rows = [(0.0, speed), (5.0, speed), (5.0 + draw.between(5, 20), speed * draw.between(0.3, 1.4))]
    return {"velocity": [{"t": t, "velocity": [v, 0.0, 0.0]} for t, v in rows]}


def sea(draw: Draw) -> Data:
    """Water, sometimes with a current, sometimes with waves."""
    found: Data = {"water_density": RHO}
    if draw.chance(0.4):
        found["current"] = {"table": [
            {"z": 0, "velocity": [draw.between(-0.5, 0.5), draw.between(-0.5, 0.5), 0]}
        ]}  # fmt: skip
    if draw.chance(0.3):
        wave = {"height": draw.between(0.5, 2.0), "period": draw.between(5, 11)}
        found["waves"] = {"regular": wave, "ramp": 10.0}
    return found


def bridle(draw: Draw) -> Data:
    """Two legs to a plate, a tow to a body behind it: by one line, or by two that close a cycle."""
    speed, leg = draw.between(0.5, 3.0), draw.between(20, 80)
    wide = draw.between(2, 8)
    lines: Data = {
        side: {"from": f"tug.{side}", "to": f"plate.{side}", "items": cables(leg)}
        for side in ("port", "starboard")
    }
    behind = draw.between(20, 80)
    stern = {"mid": [1.0, 0, 0], "a": [1.0, 1.0, 0], "b": [1.0, -1.0, 0]}
    plate = {"port": [0.5, 0.4, 0], "starboard": [0.5, -0.4, 0], "aft": [-0.5, 0, 0],
             "left": [-0.4, 0.4, 0], "right": [-0.4, -0.4, 0]}  # fmt: skip
    if draw.chance(0.5):
        for one, other in (("left", "a"), ("right", "b")):
            lines[f"tow_{one}"] = {
                "from": f"plate.{one}", "to": f"fish.{other}", "items": cables(behind)
            }  # fmt: skip
    else:
        lines["tow"] = {"from": "plate.aft", "to": "fish.mid", "items": cables(behind)}
    return {
        "environment": sea(draw),
        "cable_types": {"wire": draw.wire(draw.decades(0.012, 0.04))},
        "vessels": {"tug": {
            "points": {"port": [-10, wide / 2, 0], "starboard": [-10, -wide / 2, 0]},
            **moving(draw, speed),
        }},
        "bodies": {
            "plate": draw.body(draw.decades(100, 800), plate),
            "fish": draw.body(draw.decades(200, 3000), stern),
        },
        "lines": lines,
    }  # fmt: skip


def lowered(draw: Draw) -> Data:
    """A cage on a winch, with a tether to a vehicle that is driven."""
    depth, tether = draw.between(40, 200), draw.between(20, 60)
    away = 0.7 * tether
    rate = draw.between(-0.8, 1.0)
    return {
        "environment": sea(draw),
        "cable_types": {"wire": draw.wire(draw.decades(0.015, 0.04))},
        "vessels": {
            "ship": {"points": {"sheave": [0, 0, 3]}},
            "vehicle": {
                "position": [away, 0, -depth], "points": {"tail": [0, 0, 0]},
                "velocity": [{"t": 0, "velocity": [0, 0, 0]}, {"t": 4, "velocity": [0, 0, 0]},
                             {"t": 10, "velocity": [0, draw.between(-0.5, 0.5), 0.1]}],
            },
        },
        "bodies": {"cage": draw.body(draw.decades(500, 4000),
                                     {"top": [0, 0, 0.8], "spool": [0.5, 0, -0.4]})},
        "lines": {
            "umbilical": {"from": "ship.sheave", "to": "cage.top", "items": cables(depth + 3)},
            "tether": {"from": "cage.spool", "to": "vehicle.tail", "items": cables(tether)},
        },
        "winches": {"winch": {"line": "umbilical", "drum": 100.0, "rate": [
            {"t": 0, "rate": 0}, {"t": 3, "rate": 0}, {"t": 8, "rate": rate},
            {"t": 25, "rate": rate}, {"t": 30, "rate": 0}]}},
    }  # fmt: skip


def moored(draw: Draw) -> Data:
    """A buoy below the surface on three or four legs to the floor."""
    depth, count = draw.between(40, 120), 3 if draw.chance(0.6) else 4
    sunk = draw.between(8, 15)
    rise = depth - sunk
    away = rise * draw.between(1.0, 2.2)
    leg = math.hypot(rise, away) * draw.between(1.01, 1.06)
    lines, points = {}, {}
    for k in range(count):
        angle = 2.0 * math.pi * k / count
        way = np.array([math.cos(angle), math.sin(angle), 0.0])
        points[f"p{k}"] = np.round(2.0 * way, 4).tolist()
        anchor = np.round((away + 2.0) * way - [0, 0, depth], 4).tolist()
        lines[f"leg{k}"] = {"from": {"anchor": anchor}, "to": f"buoy.p{k}", "items": cables(leg)}
    kind = draw.wire(draw.decades(0.02, 0.06))
    weight = max(1.0, kind["mass"] - RHO * math.pi / 4 * kind["diameter"] ** 2) * G * leg * count
    lift = weight * draw.between(1.5, 4.0)
    volume = lift / (RHO * G)
    wide = (1.9 * volume) ** (1.0 / 3.0)
    buoy = {
        "mass": 0.4 * lift / G, "submerged_weight": -lift, "inertia": 0.1 * lift / G * wide**2,
        "added_mass": 0.5 * RHO * volume, "drag_area": wide**2, "drag_turning": 0.3 * wide**5,
        "added_inertia": 0.02 * RHO * volume * wide**2, "position": [0, 0, -sunk],
        "points": points,
    }  # fmt: skip
    environment = sea(draw)
    environment["floor"] = {"z": -depth - 0.5, "friction": draw.between(0, 0.6)}
    push = lift * draw.between(0.02, 0.15)
    return {
        "environment": environment, "cable_types": {"wire": kind}, "bodies": {"buoy": buoy},
        "lines": lines,
        "cuts": {"leg_breaks": {"line": "leg0", "at": "end", "time": 25.0}}
        if draw.chance(0.3) else {},
        "push": [push, draw.between(-1, 1) * push, 0, 0, 0, 0],
    }  # fmt: skip


def flown(draw: Draw) -> Data:
    """A depressor with a wing, and a branch with a weight above it."""
    length, speed = draw.between(50, 200), draw.between(1.0, 3.0)
    wing = {
        "area": draw.between(0.2, 1.0), "position": [0.05, 0, 0],
        "deflection": draw.between(-0.2, -0.05),
    }  # fmt: skip
    body = draw.body(draw.decades(60, 300), {"eye": [0.15, 0, 0.2]}, foils={"wing": wing},
                     centre_of_buoyancy=[0, 0, 0.1])  # fmt: skip
    lines: Data = {"tow": {"from": "ship.stern", "to": "wing_body.eye", "items": cables(length)}}
    if draw.chance(0.6):
        weight = {"mass": 30.0, "submerged_weight": 250.0, "drag_area": 0.05}
        items = [*cables(draw.between(5, 20)), {"body": weight}]
        lines["branch"] = {"from": {"line": "tow", "at": round(0.6 * length, 2)}, "to": "free",
                           "items": items}  # fmt: skip
    return {
        "environment": sea(draw),
        "cable_types": {"wire": draw.wire(draw.decades(0.008, 0.02))},
        "vessels": {"ship": {"points": {"stern": [-20, 0, 1]}, **moving(draw, speed)}},
        "bodies": {"wing_body": body}, "lines": lines,
        "cuts": {"snag": {"line": "tow", "at": round(0.8 * length, 2), "time": 20.0}}
        if draw.chance(0.2) else {},
    }  # fmt: skip


def lifted(draw: Draw) -> Data:
    """A frame on four slings below a hook, from a crane that swings or a pair of winches."""
    depth, sling = draw.between(20, 120), draw.between(4, 10)
    half = 0.4 * sling
    corners = {"a": [half, half, 0], "b": [half, -half, 0], "c": [-half, half, 0],
               "d": [-half, -half, 0]}  # fmt: skip
    lines: Data = {"hoist": {"from": "crane.tip", "to": "hook.eye", "items": cables(depth)}}
    for name in corners:
        lines[f"sling_{name}"] = {
            "from": "hook.ring", "to": f"frame.{name}", "items": cables(sling)
        }  # fmt: skip
    rows = [(0.0, 0.0), (4.0, 0.0), (9.0, draw.between(-0.5, 0.5)), (20.0, 0.0)]
    return {
        "environment": sea(draw),
        "cable_types": {"wire": draw.wire(draw.decades(0.015, 0.04))},
        "vessels": {"crane": {"points": {"tip": [0, 0, 5]},
                              "velocity": [{"t": t, "velocity": [v, 0, 0]} for t, v in rows]}},
        "bodies": {
            "hook": draw.body(draw.decades(100, 400), {"eye": [0, 0, 0.3], "ring": [0, 0, -0.3]}),
            "frame": draw.body(draw.decades(1000, 8000), corners),
        },
        "lines": lines,
        "winches": {"winch": {"line": "hoist", "drum": 50.0, "rate": [
            {"t": 0, "rate": 0}, {"t": 5, "rate": 0}, {"t": 8, "rate": draw.between(-0.5, 0.5)}]}},
    }  # fmt: skip


KINDS = (bridle, lowered, moored, flown, lifted)


def scene_of(number: int) -> tuple[Data, list[float] | None]:
    """The scene of a number, and what pushes its buoy from 5 s on [N, N m]."""
    kind = KINDS[number % len(KINDS)]
    scene = {"title": f"random system {number}, {kind.__name__}", **kind(Draw(number))}
    return scene, scene.pop("push", None)


def run(
    scene: Data, push: list[float] | None, tolerance: float, parts: int, *, estimate: bool = False
) -> dict[str, Any]:
    """Positions (times, 5, 3) and tensions (times, 5) of all lines, and bodies' places; and the
    least tension of each line so far (times,).

    estimate: also what lines may be wrong by, (times, 2) [m, N].
    """
    solver = {"tolerance": tolerance, "error_estimate": estimate}
    model = SystemModel({**scene, "solver": solver})
    lines: dict[str, list[Any]] = {name: [] for name in model.lines}
    doubts: dict[str, list[Any]] = {name: [] for name in model.lines}
    bodies: dict[str, list[Any]] = {name: [] for name in model.bodies}
    least: dict[str, list[float]] = {name: [] for name in model.lines}
    lowest = dict.fromkeys(model.lines, math.inf)
    for k in range(int(DURATION / INTERVAL) + 1):
        for j in range(parts if k else 0):
            end = INTERVAL * (k - 1) + INTERVAL * (j + 1) / parts
            share = min(1.0, max(0.0, (end - 5.0) / 5.0))  # at the step's end
            model.step_to(end, forces={"buoy": share * np.array(push)} if push else {})
            for name, line in model.lines.items():
                lowest[name] = min(lowest[name], line.tension_range[0])
        for name, line in model.lines.items():
            state = line.sample(np.linspace(0.0, line.length, 5))
            lines[name].append((state.position, state.tension, line.length))
            least[name].append(lowest[name])
            if estimate:
                its = model.errors[name]
                doubts[name].append((its.position, its.tension))
        for name, body in model.bodies.items():
            bodies[name].append(body.position)
    return {
        "lines": {
            name: (np.array([r[0] for r in rows]), np.array([r[1] for r in rows]), rows[0][2])
            for name, rows in lines.items()
        },
        "bodies": {name: np.array(rows) for name, rows in bodies.items()},
        "least": {name: np.array(rows) for name, rows in least.items()},
        "doubts": {name: np.array(rows) for name, rows in doubts.items()},
        "steps": model.statistics["steps"],
    }


def cut_times(scene: Data, line: str) -> list[float]:
    """When a line is cut [s]."""
    return [cut["time"] for cut in scene.get("cuts", {}).values() if cut["line"] == line]


def apart(scene: Data, one: Data, other: Data) -> tuple[float, float, str, Data]:
    """By how much two runs differ, positions and tensions [promises], the line that does most, and
    up to which output each is compared; other: the finer one."""
    place = tension = 0.0
    where = ""
    until: Data = {}
    for name, (positions, tensions, length) in one["lines"].items():
        true_place, true_tension, _ = other["lines"][name]
        held = round(min(cut_times(scene, name), default=DURATION + 1.0) / INTERVAL)
        until[name] = held
        off = np.linalg.norm(positions - true_place, axis=2)[:held].max() / (TAU * length)
        largest = np.abs(true_tension[:held]).max()
        lowest = np.minimum(one["least"][name], other["least"][name])[:held]
        pushed = np.flatnonzero(lowest < -PUSHES * largest)
        taut = int(pushed[0]) if pushed.size else held
        force = np.abs(tensions - true_tension)[:taut].max() / (10.0 * TAU * largest)
        if max(off, force) > max(place, tension):
            where = name
        place, tension = max(place, float(off)), max(tension, float(force))
    return place, tension, where, until


def judge(number: int) -> Data:
    """What came of a system: errors in promises, by line the worst."""
    verdict: Data = {"number": number, "kind": KINDS[number % len(KINDS)].__name__}
    scene, push = scene_of(number)
    begin = time.process_time()
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", UnstableStartWarning)
            own = run(scene, push, TAU, 1, estimate=True)
        verdict["cpu"] = round(time.process_time() - begin, 2)
        finer = run(scene, push, FINER, 5)
    except CableModelError as error:
        return verdict | {"outcome": "refused", "why": str(error)[:300]}
    place, tension, where, until = apart(scene, own, finer)
    share = 0.0
    for name, taut in until.items():
        _place, tensions, length = own["lines"][name]
        allowed = np.array([TAU * length, 10.0 * TAU * np.abs(tensions[:taut]).max()])
        # Not known is no number, and no smaller than any.
        share = float(np.maximum(share, (own["doubts"][name][:taut] / allowed).max()))
    bad = not (math.isfinite(place) and math.isfinite(tension))
    outcome = "impossible" if bad else "kept" if max(place, tension) <= 1.0 else "missed"
    if outcome == "missed" and any(w.category is UnstableStartWarning for w in caught):
        outcome = "warned"
    elif outcome == "missed":
        between = run(scene, push, BETWEEN, 5)
        unsure = apart(scene, between, finer)
        verdict["unsure"] = round(max(unsure[:2]), 3)
        if (place > 1.0 and unsure[0] > SETTLED) or (tension > 1.0 and unsure[1] > SETTLED):
            outcome = "unsettled"
    return verdict | {
        "outcome": outcome, "position": round(place, 3), "tension": round(tension, 3),
        "where": where, "steps": own["steps"], "share": round(share, 3),
        "silent": outcome != "kept" and share <= 1.0,
    }  # fmt: skip


def main() -> None:
    """Judge systems; keep the verdicts."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmarks.random_systems", description=__doc__
    )
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--count", type=int, default=100)
    parser.add_argument("--only", type=int, help="show this one, and keep nothing")
    chosen = parser.parse_args()
    warnings.simplefilter("ignore")
    if chosen.only is not None:
        import yaml

        print(yaml.safe_dump(scene_of(chosen.only)[0], sort_keys=False))
        print(judge(chosen.only))
        return
    verdicts = []
    for number in range(chosen.first, chosen.first + chosen.count):
        verdicts.append(judge(number))
        print(json.dumps(verdicts[-1]), flush=True)
    counts = Counter(v["outcome"] for v in verdicts)
    silent = sum(verdict.get("silent", False) for verdict in verdicts)
    print(dict(counts), f"{silent} misses were not told")
    found = {"machine": describe(), "outcomes": dict(counts)}
    STORED.write_text(json.dumps({**found, "systems": verdicts}, indent=1) + "\n")


if __name__ == "__main__":
    main()
