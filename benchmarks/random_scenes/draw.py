"""Draw scenes: a Latin hypercube over cable, water, manoeuvre, winch, floor, bodies, tolerance.

Scene number ``seed`` is a row of a fixed hypercube of :data:`COUNT` rows, so that a number always
means the same scene: 0 to 999 are the search, 1000 to 1999 a second set, and so on; from
:data:`IN_WAVES` on they are in waves. Rules of the solver that are made from the search are judged
by scenes of another set. Quantities are drawn so that every combination can be built: axial
stiffness from the strain under a typical load, bending stiffness from that of a solid rod, sizes of
bodies from the weight of the line. Nothing else is kept apart: slack, whips, snaps, cable that
piles up on the floor and commands that the winch cannot follow are all wanted.
"""

from __future__ import annotations

import functools
import itertools
import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.random_scenes.chance import COUNT, decades, latin_hypercube, pick
from benchmarks.random_scenes.sea import add_waves
from benchmarks.scenes import GRAVITY

IN_WAVES = 10 * COUNT
"""First number of a scene in waves: all are in water, and its surface is at z = 0."""
SEA = 1025.0
"""Density of sea water [kg/m3]: that of the cable is drawn relative to it."""

COLUMNS = (
    "length", "diameter", "density", "density_class", "strain", "bending", "bends", "drag",
    "added_mass", "medium", "current", "current_speed", "current_direction", "manoeuvre", "speed",
    "abruptness", "heading", "elevation", "payout", "payout_rate", "floor", "floor_depth", "slope",
    "friction", "body", "body_weight", "body_place", "floats", "end", "span", "model", "tolerance",
    "connection", "duration", "steps", "amplitude", "period",
)  # fmt: skip
"""Axes of the hypercube."""

RINGS = 0.25
"""Axial wave over what the tension may be wrong by, from which on it is a shock [-]."""


@dataclass(frozen=True)
class Drawn:
    """One scene of the search.

    scene: in the project's schema. step: of the caller [s]. shock: when a command first changes so
    fast that the line rings along itself (see :func:`shock_time`) [s]. traits: the words and
    numbers by which outcomes are mapped. predictable: all of its motion is held to the promise.
    """

    seed: int
    scene: dict[str, Any]
    duration: float
    step: float
    tolerance: float
    shock: float
    traits: dict[str, str | float]
    predictable: bool = False


@functools.cache
def hypercube(number: int = 0) -> np.ndarray:
    """The rows of a set of scenes, (COUNT, len(COLUMNS)) in [0, 1); number 0 is the search."""
    return latin_hypercube(len(COLUMNS), 8 + number)


def direction(heading: float, elevation: float) -> list[float]:
    """Unit vector from two numbers in [0, 1), even over the sphere."""
    up = 2.0 * elevation - 1.0
    level = math.sqrt(1.0 - up * up)
    turn = 2.0 * math.pi * heading
    return [level * math.cos(turn), level * math.sin(turn), up]


MANOEUVRES = (
    ("rest", 0.06), ("tow", 0.2), ("turn", 0.15), ("stop", 0.14), ("reverse", 0.06),
    ("heave", 0.17), ("whip", 0.15), ("released under way", 0.07),
)  # fmt: skip
ANCHORED_MANOEUVRES = (("rest", 0.2), ("heave", 0.5), ("tow", 0.3))


def draw(seed: int) -> Drawn:
    """The scene of that number, from 0 on.

    Raises:
        ValueError: there is no such row.
    """
    if seed < 0:
        raise ValueError(f"seed {seed}: allowed are 0 and more")
    number, row = divmod(seed, COUNT)
    u = dict(zip(COLUMNS, hypercube(number)[row].tolist(), strict=True))
    length = decades(u["length"], 3.0, 1000.0)
    diameter = decades(u["diameter"], 0.004, 0.06)
    area = math.pi / 4.0 * diameter**2
    in_waves = seed >= IN_WAVES
    media = (("water", 1.0),) if in_waves else (("water", 0.85), ("air", 0.1), ("vacuum", 0.05))
    water = pick(u["medium"], media)
    rho = {"water": SEA, "air": 1.2, "vacuum": 0.0}[water]
    cable = _cable_density(u)
    mass = cable * SEA * area
    weight = (mass - rho * area) * GRAVITY
    manoeuvre, anchored = pick(u["manoeuvre"], MANOEUVRES), u["end"] > 0.82
    if anchored:
        manoeuvre = pick(u["manoeuvre"], ANCHORED_MANOEUVRES)
    speed = decades(u["speed"], 0.2, 4.0)
    body_kind, bodies, body_load = _bodies(u, abs(weight) * length, water, anchored)
    drag_normal = 0.5 + 1.5 * u["drag"]
    flow = speed if manoeuvre not in ("rest", "whip") else 0.0
    current_kind, current, current_speed = _current(u, rho)
    flow += current_speed
    load = abs(weight) * length + body_load + 0.05 * mass * GRAVITY * length
    load += 0.5 * rho * drag_normal * diameter * flow**2 * length
    strain = decades(u["strain"], 1e-6, 0.03)
    stiffness = load / strain
    rod = stiffness * diameter**2 / 16.0
    bending = 0.0 if u["bends"] < 0.2 else rod * decades(u["bending"], 1e-4, 1.0)
    model = pick(u["model"], (("hybrid", 0.4), ("elastica", 0.35), ("cable", 0.25)))
    duration = min(60.0, 5.0 + (2.0 + 6.0 * u["duration"]) * math.sqrt(length / GRAVITY))
    step = duration / round(decades(u["steps"], 20.0, 600.0))
    tolerance = decades(u["tolerance"], 1e-4, 1e-2)

    floor_kind, floor = _floor(u, length)
    payout_kind, payout = _payout(u, length, duration, "K", model)
    environment: dict[str, Any] = {"gravity": GRAVITY, "water_density": rho}
    if current is not None:
        environment["current"] = current
    if floor is not None:
        environment["floor"] = floor
    scene: dict[str, Any] = {
        "title": f"random scene {seed}",
        "environment": environment,
        "cable_types": {
            "K": {
                "diameter": diameter,
                "mass": mass,
                "submerged_weight": weight,
                "axial_stiffness": stiffness,
                "bending_stiffness": bending,
                "drag_normal": drag_normal,
                "drag_tangential": 0.1 * u["drag"],
                "added_mass": u["added_mass"],
            }
        },
        "line": _line(body_kind, bodies, length, u["body_place"], model),
        "vessel": _vessel(manoeuvre, u, speed, length, anchored),
        "payout": payout,
        "solver": {"method": "finite_element", "tolerance": tolerance},
        "run": {"duration": duration, "output_interval": step},
    }
    if manoeuvre in ("whip", "released under way"):
        scene["initial"] = {"straight": direction(u["heading"], u["elevation"])}
    if anchored:
        scene["end"] = {"anchor": _anchor(u, length, floor)}
    if u["connection"] > 0.85:
        scene["vessel"]["connection"] = {"clamped": direction(u["heading"], u["elevation"])}
    traits: dict[str, str | float] = {
        "manoeuvre": manoeuvre,
        "medium": water,
        "model": model,
        "pay-out": payout_kind,
        "floor": floor_kind,
        "body": body_kind,
        "end": "anchored" if anchored else "free",
        "top": "clamped" if u["connection"] > 0.85 else "pinned",
        "current": current_kind,
        "weight": "buoyant" if weight < 0.0 else "heavy",
        "EI": "zero" if bending == 0.0 else "bends",
        "length": length,
        "strain": strain,
        "bending length": (bending / max(abs(weight), 1e-9)) ** (1.0 / 3.0) / length,
        "friction": floor["friction"] if floor else math.nan,
        "tolerance": tolerance,
        "step": step,
    }
    traits["waves"] = add_waves(scene, seed - IN_WAVES) if in_waves else "none"
    shock = shock_time(scene, load)
    traits["shock"] = "shock" if shock < duration else "gentle"
    return Drawn(seed, scene, duration, step, tolerance, shock, traits)


def shock_time(scene: dict[str, Any], load: float) -> float:
    """When the line first rings along itself by more than its tension may be wrong [s].

    A change V of the speed of an end over a time R leaves a wave of V sqrt(EA m) min(1, P / pi R),
    P = 4 L sqrt(m / EA) the axial period. Released unstretched, a line rings under its own weight.
    Steps are chosen by positions, which such waves hardly move, and the scheme damps them: from
    then on only positions are held to the promise. Infinite where nothing changes so fast.
    """
    if "initial" in scene:
        return 0.0
    cable = scene["cable_types"]["K"]
    length = sum(item["cable"]["length"] for item in scene["line"] if "cable" in item)
    impedance = math.sqrt(cable["axial_stiffness"] * cable["mass"])
    period = 4.0 * length * math.sqrt(cable["mass"] / cable["axial_stiffness"])
    allowed = 10.0 * scene["solver"]["tolerance"] * load
    first = math.inf
    speeds = [(row["t"], row["velocity"]) for row in scene["vessel"].get("velocity", [])]
    if "interpolation" in scene["vessel"]:
        speeds = []  # heave is smooth
    rates = [(row["t"], [row["rate"]]) for row in scene["payout"].get("rate", [])]
    for rows in (speeds, rates):
        for (t0, before), (t1, after) in itertools.pairwise(rows):
            wave = impedance * math.dist(before, after) * min(1.0, period / (math.pi * (t1 - t0)))
            if wave > RINGS * allowed:
                first = min(first, t0)
    return first


def _cable_density(u: dict[str, float]) -> float:
    """Density over that of sea water: 15 % float, 10 % are all but neutral, the others sink."""
    if u["density_class"] < 0.15:
        return 0.5 + 0.45 * u["density"]
    if u["density_class"] < 0.25:
        return 0.97 + 0.06 * u["density"]
    return decades(u["density"], 1.05, 8.0)


def _current(u: dict[str, float], rho: float) -> tuple[str, Any, float]:
    """None, the same everywhere, or over depth and time; with its largest speed [m/s]."""
    kind = pick(u["current"], (("none", 0.5), ("uniform", 0.25), ("sheared", 0.25)))
    speed = 2.0 * u["current_speed"]
    if kind == "none" or rho == 0.0:
        return "none", None, 0.0
    turn = 2.0 * math.pi * u["current_direction"]
    flow = [speed * math.cos(turn), speed * math.sin(turn), 0.0]
    if kind == "uniform":
        return kind, flow, speed
    rows = []
    for t, factor in ((0.0, 1.0), (10.0, 0.3), (25.0, -0.5)):
        for z, share in ((-200.0, 0.2), (-20.0, 0.6), (0.0, 1.0)):
            rows.append({"z": z, "t": t, "velocity": [factor * share * v for v in flow]})
    return kind, {"table": rows}, speed


def _bodies(
    u: dict[str, float], line_weight: float, water: str, anchored: bool
) -> tuple[str, dict[str, Any] | None, float]:
    """Kind, the body, and its weight [N]: a tenth to ten times that of the line, some float."""
    kind = pick(
        u["body"],
        (("none", 0.5), ("end, point", 0.15), ("inner, point", 0.15), ("end, finite", 0.1),
         ("inner, finite", 0.1)),
    )  # fmt: skip
    if kind == "none":
        return kind, None, 0.0
    if anchored:  # an anchor holds a cable, not a body
        kind = kind.replace("end", "inner")
    pull = max(line_weight, 1.0) * decades(u["body_weight"], 0.1, 10.0)
    floats = water == "water" and u["floats"] < 0.2
    displaced = pull / GRAVITY * (1.5 if floats else 0.5) if water == "water" else 0.0
    mass = pull / GRAVITY * (0.5 if floats else 1.5 if water == "water" else 1.0)
    volume = max(displaced, 0.2 * mass) / SEA
    body: dict[str, Any] = {
        "mass": mass,
        "submerged_weight": -pull if floats else pull,
        "added_mass": 0.5 * displaced,
        "added_mass_axial": 0.2 * displaced,
        "drag_area": volume ** (2.0 / 3.0),
        "drag_area_axial": 0.5 * volume ** (2.0 / 3.0),
    }
    if kind.endswith("finite"):
        half = 0.5 * volume ** (1.0 / 3.0)
        body |= {
            "half_length": half,
            "rotary_inertia": 0.5 * (mass + displaced) * half**2,
            "centre_offset": 0.5 * (2.0 * u["body_place"] - 1.0),
        }
    return kind, body, pull


def _line(
    kind: str, body: dict[str, Any] | None, length: float, place: float, model: str
) -> list[dict[str, Any]]:
    """Cable, with the body at its end or somewhere in its middle half."""

    def cable(part: float) -> dict[str, Any]:
        return {"cable": {"type": "K", "length": part, "model": model}}

    if body is None:
        return [cable(length)]
    if kind.startswith("end"):
        return [cable(length), {"body": body}]
    upper = (0.25 + 0.5 * place) * length
    return [cable(upper), {"body": body}, cable(length - upper)]


def _floor(u: dict[str, float], length: float) -> tuple[str, dict[str, Any] | None]:
    """None, flat, or sloped by up to 0.3 in any direction; 0.3 to 1.3 lengths below the vessel."""
    kind = pick(u["floor"], (("none", 0.5), ("flat", 0.25), ("sloped", 0.25)))
    if kind == "none":
        return kind, None
    friction = 0.0 if u["friction"] < 0.3 else (u["friction"] - 0.3) / 0.7
    floor: dict[str, Any] = {"z": -(0.3 + u["floor_depth"]) * length, "friction": friction}
    if kind == "sloped":
        turn = 2.0 * math.pi * u["current_direction"]
        steep = 0.3 * u["slope"]
        floor["slope"] = [steep * math.cos(turn), steep * math.sin(turn)]
    return kind, floor


def _payout(
    u: dict[str, float], length: float, duration: float, kind: str, model: str
) -> tuple[str, dict[str, Any]]:
    """None, out or in; up to 90 % of the line in the run, jumped to or over a ramp."""
    word = pick(u["payout"], (("none", 0.5), ("out", 0.25), ("in", 0.25)))
    if word == "none":
        return word, {}
    rate = min(decades(u["payout_rate"], 0.05, 3.0), 0.9 * length / duration)
    ramp = decades(u["abruptness"], 0.01, 10.0)
    start = 0.1 * duration
    rows = [{"t": 0.0, "rate": 0.0}, {"t": start, "rate": 0.0}]
    rows.append({"t": start + ramp, "rate": rate if word == "out" else -rate})
    drum = [{"cable": {"type": kind, "length": 0.5 * length, "model": model}}]
    return word, {"rate": rows, "drum": drum}


def _anchor(u: dict[str, float], length: float, floor: dict[str, Any] | None) -> list[float]:
    """In the water, or on the floor where that is within reach: 40 to 95 % of the length away."""
    span = (0.4 + 0.55 * u["span"]) * length
    turn = 2.0 * math.pi * u["heading"]
    down = min((0.2 + 0.6 * u["elevation"]) * span, 0.95 * span)
    if floor is not None and "slope" not in floor and -floor["z"] < 0.9 * span:
        down = -floor["z"]
    across = math.sqrt(span**2 - down**2)
    return [across * math.cos(turn), across * math.sin(turn), -down]


def _vessel(
    manoeuvre: str, u: dict[str, float], speed: float, length: float, anchored: bool
) -> dict[str, Any]:
    """Motion of the tow point. An anchored line is not pulled further than its slack."""
    ramp = decades(u["abruptness"], 0.01, 10.0)
    turn = 2.0 * math.pi * u["heading"]
    along = [math.cos(turn), math.sin(turn), 0.0]

    def table(*rows: tuple[float, float]) -> dict[str, Any]:
        velocity = [{"t": t, "velocity": [v * a for a in along]} for t, v in rows]
        return {"position": [0.0, 0.0, 0.0], "velocity": velocity}

    if manoeuvre in ("rest", "whip"):
        return table((0.0, 0.0))
    if manoeuvre == "heave":
        period = decades(u["period"], 2.0, 12.0)
        amplitude = decades(u["amplitude"], 0.05, 3.0)
        if anchored:
            amplitude = min(amplitude, 0.02 * length)
        return _heave(amplitude, period)
    if anchored:
        # Out by 2 % of the length, away from the anchor or towards it, and stop.
        distance = 0.02 * length
        return table((0.0, 0.0), (ramp, distance / (ramp + 1.0)), (ramp + 1.0, 0.0))
    if manoeuvre == "tow":
        return table((0.0, 0.0), (ramp, speed))
    if manoeuvre == "stop":
        return table((0.0, speed), (3.0, speed), (3.0 + ramp, 0.0))
    if manoeuvre == "reverse":
        return table((0.0, speed), (3.0, speed), (3.0 + ramp, -speed))
    if manoeuvre == "released under way":
        return table((0.0, 0.0), (0.5 + ramp, speed))
    radius = max(0.1 * length, 1.0) * decades(u["amplitude"], 0.3, 3.0)
    angle = (0.25 + 1.5 * u["period"]) * math.pi * (1.0 if u["elevation"] < 0.5 else -1.0)
    return {
        "position": [0.0, 0.0, 0.0],
        "path": [
            {"straight": {"duration": 2.0, "speed": speed, "heading": turn}},
            {"turn": {"angle": angle, "radius": radius, "speed": speed}},
            {"straight": {"duration": 100.0, "speed": speed}},
        ],
    }


def _heave(amplitude: float, period: float) -> dict[str, Any]:
    """Up and down, from rest, to the full amplitude within a period."""
    omega = 2.0 * math.pi / period
    rows = []
    for k in range(math.ceil(60.0 / period * 24) + 1):
        t = k * period / 24.0
        speed = amplitude * omega * math.sin(omega * t) * min(t / period, 1.0)
        rows.append({"t": t, "velocity": [0.0, 0.0, speed]})
    return {"position": [0.0, 0.0, 0.0], "velocity": rows, "interpolation": "cubic"}
