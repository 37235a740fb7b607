"""Ordinary scenes: tow, turn, lay, lower, recover, moor and heave, drawn as such jobs are done.

Scene number ``seed`` from :data:`ORDINARY` on is a row of a fixed hypercube, of the job that is
``seed`` modulo seven in :data:`JOBS`. Cables are 5 to 100 mm thick, of the materials in
:data:`CABLES`, and none carries more than :data:`WORKING_STRAIN`. Ships do up to 8 knots and change
speed, course or pay-out within tens of seconds; winches run at up to 2 m/s, and no faster than what
hangs on them sinks. Nothing jerks: tensions are asked for until the line is slack.
"""

from __future__ import annotations

import functools
import math
from typing import Any

import numpy as np

from benchmarks.random_scenes.chance import COUNT, decades, latin_hypercube, pick
from benchmarks.random_scenes.draw import SEA, Drawn, draw
from benchmarks.scenes import GRAVITY

ORDINARY = 20 * COUNT
"""First number of an ordinary scene."""
JOBS = ("tow", "turn", "lay", "lower", "recover", "moor", "heave")
KNOT = 1852.0 / 3600.0
SAMPLES = 96
"""Rows of a period of heave: the jumps of jerk at a coarser table's rows make loads ring [-]."""
PROFILE = ((-1.0, 0.1, 1.0), (-0.4, 0.4, 0.5), (-0.1, 0.9, 0.1), (0.0, 1.0, 0.0))
"""Of a current: height over depth, share of the speed at the surface, direction over 1/2 rad."""
WORKING_STRAIN = 0.003
"""Largest strain under what hangs on a cable: about a fifth of what breaks steel wire [-]."""

COLUMNS = (
    "material", "diameter", "density", "modulus", "bending", "drag", "length", "depth", "speed",
    "change", "ramp", "heading", "current", "current_speed", "current_direction", "body",
    "body_weight", "body_density", "body_shape", "body_drag", "variant", "rate", "place", "slope",
    "friction", "amplitude", "period", "model", "tolerance", "duration", "steps",
)  # fmt: skip
"""Axes of the hypercube."""

CABLES = {
    "wire": ((3800.0, 5000.0), (4.0e10, 7.0e10)),
    "armoured": ((2400.0, 4000.0), (1.5e10, 4.0e10)),
    "lightweight": ((1250.0, 2400.0), (1.5e10, 4.0e10)),
    "umbilical": ((1060.0, 1600.0), (2.0e9, 1.0e10)),
    "rope": ((1080.0, 1400.0), (2.0e9, 3.0e10)),
    "chain": ((7820.0, 7820.0), (3.36e10, 3.36e10)),
}
"""Mass [kg/m3] and EA [N/m2] over the area of the circle, from and to. A studless chain has that of
1.8 times the diameter of its bar D, 19.9e3 D^2 kg/m and 8.54e10 D^2 N (OrcaFlex's chain data)."""
MADE_OF = {
    "tow": (("wire", 0.2), ("armoured", 0.5), ("lightweight", 0.1), ("umbilical", 0.2)),
    "turn": (("wire", 0.2), ("armoured", 0.5), ("lightweight", 0.1), ("umbilical", 0.2)),
    "lay": (("armoured", 0.5), ("lightweight", 0.5)),
    "lower": (("wire", 0.5), ("armoured", 0.25), ("umbilical", 0.1), ("rope", 0.15)),
    "recover": (("wire", 0.4), ("armoured", 0.4), ("lightweight", 0.2)),
    "moor": (("wire", 0.3), ("rope", 0.3), ("chain", 0.4)),
    "heave": (("wire", 0.5), ("armoured", 0.25), ("umbilical", 0.1), ("rope", 0.15)),
}

Numbers = dict[str, float]


@functools.cache
def hypercube(number: int = 0) -> np.ndarray:
    """The rows of a set of ordinary scenes, (COUNT, len(COLUMNS)) in [0, 1)."""
    return latin_hypercube(len(COLUMNS), 800 + number)


def drawn(number: int) -> Drawn:
    """The scene of that number, of any kind.

    Raises:
        ValueError: there is no such row.
    """
    return draw_ordinary(number) if number >= ORDINARY else draw(number)


def draw_ordinary(seed: int) -> Drawn:
    """The ordinary scene of that number, from :data:`ORDINARY` on.

    Raises:
        ValueError: there is no such row.
    """
    if seed < ORDINARY:
        raise ValueError(f"seed {seed}: allowed are {ORDINARY} and more")
    place = seed - ORDINARY
    row = hypercube(place // COUNT)[place % COUNT].tolist()
    u = dict(zip(COLUMNS, row, strict=True))
    job = JOBS[place % len(JOBS)]
    material = pick(u["material"], MADE_OF[job])
    model = pick(u["model"], (("hybrid", 0.7), ("elastica", 0.15), ("cable", 0.15)))
    cable = _cable(u, material)
    tolerance = decades(u["tolerance"], 1e-4, 1e-3)
    scene: dict[str, Any] = {
        "title": f"ordinary scene {seed}: {job}",
        "environment": {"gravity": GRAVITY, "water_density": SEA},
        "cable_types": {"K": cable},
        "solver": {"method": "finite_element", "tolerance": tolerance},
    }
    traits: dict[str, str | float] = {"manoeuvre": job, "medium": "water", "model": model}
    duration = _BUILD[job](scene, u, traits)
    for item in (*scene["line"], *scene.get("payout", {}).get("drum", [])):
        if "cable" in item:
            item["cable"] |= {"type": "K", "model": model}
    step = duration / math.ceil(duration / decades(u["steps"], 0.2, 4.0))
    scene["run"] = {"duration": duration, "output_interval": step}
    words = _traits(scene, traits)
    return Drawn(seed, scene, duration, step, tolerance, math.inf, words, predictable=True)


def _cable(u: Numbers, material: str) -> dict[str, float]:
    """A cable of that material; EI is up to a third of a solid rod's, a chain has none."""
    density, modulus = CABLES[material]
    diameter = decades(u["diameter"], 0.005, 0.1)
    area = math.pi / 4.0 * diameter**2
    mass = decades(u["density"], *density) * area
    stiffness = decades(u["modulus"], *modulus) * area
    bends = material != "chain" and u["bending"] > 0.1
    rod = stiffness * diameter**2 / 16.0
    return {
        "diameter": diameter,
        "mass": mass,
        "submerged_weight": (mass - SEA * area) * GRAVITY,
        "axial_stiffness": stiffness,
        "bending_stiffness": rod * decades(u["bending"], 0.001, 0.3) if bends else 0.0,
        "drag_normal": 1.0 + 0.8 * u["drag"],
        "drag_tangential": 0.005 + 0.015 * u["drag"],
        "added_mass": 1.0,
    }


def _body(
    scene: dict[str, Any], u: Numbers, length: float, *, least: float = 0.0, floats: bool = False
) -> dict[str, Any]:
    """What hangs on that length of cable: a tenth of a kilonewton to 200 kN, as the cable allows.

    least: of the weight of the cable, what the body weighs at least [-]. Mass is 1.5 to 7 times
    that of the water displaced, of a float a quarter to three quarters. It is a point or a body
    with length, with drag and added mass of its own in both directions.
    """
    cable = scene["cable_types"]["K"]
    hangs = max(cable["submerged_weight"], 0.0) * length
    most = max(WORKING_STRAIN * cable["axial_stiffness"] - hangs, 100.0)
    pull = min(max(decades(u["body_weight"], 100.0, 2e5), least * hangs), most)
    ratio = 0.25 + 0.5 * u["body_density"] if floats else decades(u["body_density"], 1.5, 7.0)
    displaced = pull / GRAVITY / abs(ratio - 1.0)
    volume = displaced / SEA
    face = volume ** (2.0 / 3.0)
    body: dict[str, Any] = {
        "mass": ratio * displaced,
        "submerged_weight": -pull if floats else pull,
        "added_mass": (0.5 + 0.5 * u["body_drag"]) * displaced,
        "added_mass_axial": (0.2 + 0.5 * u["body_drag"]) * displaced,
        "drag_area": 1.2 * face,
        "drag_coefficient": 0.5 + 0.7 * u["body_drag"],
        "drag_area_axial": face,
        "drag_coefficient_axial": 0.2 + 0.8 * u["body_drag"],
    }
    if u["body_shape"] < 0.5:
        half = min(decades(u["body_shape"] * 2.0, 0.5, 1.5) * volume ** (1.0 / 3.0), 0.05 * length)
        body |= {"half_length": half, "rotary_inertia": 2.0 * ratio * displaced * half**2 / 3.0}
    return body


def _carried(scene: dict[str, Any], length: float) -> float:
    """That length, or what has four fifths of the working strain under its own weight [m]."""
    cable = scene["cable_types"]["K"]
    most = 0.8 * WORKING_STRAIN * cable["axial_stiffness"] / cable["submerged_weight"]
    return float(min(length, most))


def _line(length: float, body: dict[str, Any] | None) -> list[dict[str, Any]]:
    line: list[dict[str, Any]] = [{"cable": {"length": length}}]
    return line if body is None else [*line, {"body": body}]


def _sinks_at(body: dict[str, Any]) -> float:
    """Speed at which it sinks by itself [m/s]."""
    area = body["drag_area_axial"] * body["drag_coefficient_axial"]
    return math.sqrt(2.0 * abs(body["submerged_weight"]) / (SEA * area))


def _along(u: Numbers) -> list[float]:
    turn = 2.0 * math.pi * u["heading"]
    return [math.cos(turn), math.sin(turn), 0.0]


def _velocity(u: Numbers, *rows: tuple[float, float]) -> list[dict[str, Any]]:
    """Rows of time and speed on the drawn heading."""
    return [{"t": t, "velocity": [v * a for a in _along(u)]} for t, v in rows]


def _ramp(u: Numbers) -> float:
    """In what time a ship or a winch changes its speed [s]."""
    return decades(u["ramp"], 10.0, 60.0)


def _add_current(
    scene: dict[str, Any], u: Numbers, depth: float, most: float, *, changes: float | None = None
) -> str:
    """None, or over depth, at most so fast [m/s]; changes: within how long to a half of it [s]."""
    kind = pick(u["current"], (("none", 0.4), ("sheared", 0.6)))
    if kind == "none" and changes is None:
        return "none"
    turn = 2.0 * math.pi * u["current_direction"]
    rows = []
    for t, factor in ((0.0, 1.0),) if changes is None else ((20.0, 1.0), (20.0 + changes, 0.5)):
        for share, part, veer in PROFILE:
            speed, angle = factor * part * most * u["current_speed"], turn + 0.5 * veer
            velocity = [speed * math.cos(angle), speed * math.sin(angle), 0.0]
            rows.append({"z": share * depth, "t": t, "velocity": velocity})
    scene["environment"]["current"] = {"table": rows}
    return "sheared"


def _towed(scene: dict[str, Any], u: Numbers, traits: dict[str, Any]) -> float:
    """A line of 50 to 3,000 m with a fish, or with nothing; its speed is returned [m/s]."""
    length = _carried(scene, decades(u["length"], 50.0, 3000.0))
    body = None if u["body"] < 0.2 else _body(scene, u, length)
    scene["line"] = _line(length, body)
    traits["current"] = _add_current(scene, u, length, 0.7)
    return decades(u["speed"], 1.0, 8.0) * KNOT


def _tow(scene: dict[str, Any], u: Numbers, traits: dict[str, Any]) -> float:
    """Under way, to another speed; a third also pays out or reels in."""
    speed = _towed(scene, u, traits)
    other = min(speed * decades(u["change"], 0.5, 2.0), 8.0 * KNOT)
    ramp = _ramp(u)
    scene["vessel"] = {"velocity": _velocity(u, (0.0, speed), (10.0, speed), (10.0 + ramp, other))}
    duration = 60.0 + ramp + 240.0 * u["duration"]
    if u["variant"] < 1.0 / 3.0:
        length = scene["line"][0]["cable"]["length"]
        rate = min(decades(u["rate"], 0.1, 1.5), 0.5 * length / duration, 0.7 * min(speed, other))
        _winch(scene, u, rate if u["place"] < 0.5 else -rate, 20.0, duration)
    return duration


def _turn(scene: dict[str, Any], u: Numbers, traits: dict[str, Any]) -> float:
    """A turn of 30 to 180 degrees on a radius of 100 to 1,000 m."""
    speed = min(_towed(scene, u, traits), 6.0 * KNOT)
    radius = decades(u["amplitude"], 100.0, 1000.0)
    angle = math.radians(30.0 + 150.0 * u["period"]) * (1.0 if u["place"] < 0.5 else -1.0)
    heading = 2.0 * math.pi * u["heading"]
    scene["vessel"] = {
        "path": [
            {"straight": {"duration": 20.0, "speed": speed, "heading": heading}},
            {"turn": {"angle": angle, "radius": radius}},
            {"straight": {"duration": 1000.0}},
        ]
    }
    return min(20.0 + abs(angle) * radius / speed + 60.0, 600.0)


def _winch(scene: dict[str, Any], u: Numbers, rate: float, start: float, duration: float) -> None:
    """From rest to that rate within 2 to 20 s, with cable enough on the drum."""
    ramp = decades(u["ramp"], 2.0, 20.0)
    rows = [{"t": 0.0, "rate": 0.0}, {"t": start, "rate": 0.0}, {"t": start + ramp, "rate": rate}]
    stored = 10.0 + max(rate, 0.0) * duration
    scene["payout"] = {"rate": rows, "drum": [{"cable": {"length": stored}}]}


def _lay(scene: dict[str, Any], u: Numbers, traits: dict[str, Any]) -> float:
    """In 30 to 4,000 m at up to 8 knots, with a slack of -1 to 3 % that changes, on up to 1 in 20.

    Cable that would hang at less than 10 degrees is laid more slowly.
    """
    cable = scene["cable_types"]["K"]
    depth = _carried(scene, decades(u["depth"], 30.0, 4000.0))
    weight = cable["submerged_weight"]
    drag = 0.5 * SEA * cable["drag_normal"] * cable["diameter"]
    shallow = math.radians(10.0)
    fastest = math.sqrt(weight * math.cos(shallow) / drag) / math.sin(shallow)
    speed = min(decades(u["speed"], 0.5, 8.0) * KNOT, fastest)
    # w cos a = 1/2 rho Cdn d V^2 sin^2 a (Zajac 1957)
    k = weight / (drag * speed**2)
    hangs = depth / math.sqrt(1.0 - ((math.sqrt(k * k + 4.0) - k) / 2.0) ** 2)
    steep = 0.05 * u["slope"] if u["slope"] > 0.5 else 0.0
    turn = 2.0 * math.pi * u["current_direction"]
    floor: dict[str, Any] = {"z": -depth, "friction": 0.2 + 0.6 * u["friction"]}
    if steep:
        floor["slope"] = [steep * math.cos(turn), steep * math.sin(turn)]
    scene["environment"]["floor"] = floor
    traits["current"] = _add_current(scene, u, depth, 0.5)
    ramp, other = _ramp(u), speed * (1.0 if u["variant"] < 0.5 else 0.6 + 0.4 * u["change"])
    slack, later = 0.02 * u["amplitude"], -0.01 + 0.04 * u["rate"]
    scene["line"] = _line((1.1 + 0.3 * u["length"]) * hangs, None)
    scene["vessel"] = {"velocity": _velocity(u, (0.0, speed), (20.0, speed), (20.0 + ramp, other))}
    duration = 60.0 + ramp + 240.0 * u["duration"]
    rows = ((0.0, speed, slack), (20.0, speed, slack), (20.0 + ramp, other, later))
    scene["payout"] = {
        "rate": [{"t": t, "rate": v * (1.0 + extra)} for t, v, extra in rows],
        "drum": [{"cable": {"length": 1.1 * speed * duration + 10.0}}],
    }
    return duration


def _lower(scene: dict[str, Any], u: Numbers, traits: dict[str, Any]) -> float:
    """A load on 10 to 1,500 m goes down; half of them land, at up to half a metre a second."""
    length = _carried(scene, decades(u["length"], 10.0, 1500.0))
    body = _body(scene, u, length, least=0.1)
    lands = u["variant"] < 0.5
    rate = min(decades(u["rate"], 0.1, 0.5 if lands else 2.0), 0.6 * _sinks_at(body))
    duration = 60.0 + 180.0 * u["duration"]
    scene["line"] = _line(length, body)
    scene["vessel"] = {"position": [0.0, 0.0, 0.0]}
    _winch(scene, u, rate, 10.0, duration)
    if lands:
        depth = length + 2.0 * body.get("half_length", 0.0) + 0.6 * rate * (duration - 20.0)
        scene["environment"]["floor"] = {"z": -depth, "friction": 0.2 + 0.6 * u["friction"]}
    traits["current"] = _add_current(scene, u, length + rate * duration, 0.7)
    return duration


def _recover(scene: dict[str, Any], u: Numbers, traits: dict[str, Any]) -> float:
    """A load under way is reeled in; half lift cable off the floor, laid at up to a knot."""
    ramp, duration = _ramp(u), 90.0 + 210.0 * u["duration"]
    speed = decades(u["speed"], 0.3, 4.0) * KNOT
    if u["variant"] < 0.5:
        depth = _carried(scene, decades(u["depth"], 20.0, 2000.0))
        length = (1.3 + 0.7 * u["length"]) * depth
        speed = min(speed, KNOT)
        rate = min(decades(u["rate"], 0.1, 1.5), 0.6 * length / duration)
        scene["environment"]["floor"] = {"z": -depth, "friction": 0.2 + 0.6 * u["friction"]}
        scene["line"] = _line(length, None)
        ship = ((0.0, speed), (10.0, speed), (10.0 + ramp, 0.0))
        rates = [(t, v) for t, v in ship] + [(20.0 + ramp, 0.0), (30.0 + ramp, -rate)]
        duration += ramp
    else:
        length = _carried(scene, decades(u["length"], 50.0, 3000.0))
        depth = length
        rate = min(decades(u["rate"], 0.2, 2.0), 0.8 * length / duration)
        scene["line"] = _line(length, _body(scene, u, length, least=0.05))
        ship = ((0.0, speed), (10.0, speed), (10.0 + ramp, 0.5 * speed))
        rates = [(0.0, 0.0), (20.0, 0.0), (20.0 + 0.2 * ramp, -rate)]
    scene["vessel"] = {"velocity": _velocity(u, *ship)}
    scene["payout"] = {
        "rate": [{"t": t, "rate": v} for t, v in rates],
        "drum": [{"cable": {"length": 10.0 + speed * (10.0 + ramp)}}],
    }
    traits["current"] = _add_current(scene, u, depth, 0.5)
    return duration


def _moor(scene: dict[str, Any], u: Numbers, traits: dict[str, Any]) -> float:
    """A leg of a moored ship that surges, or a line up to a float in a current that changes.

    A leg reaches 70 to 95 % of what it could if it hung taut from the floor up, and the ship surges
    by up to a thirtieth of the depth within 20 to 120 s. The float carries the line three times.
    """
    cable = scene["cable_types"]["K"]
    duration = 120.0 + 240.0 * u["duration"]
    if u["variant"] < 0.5 and cable["bending_stiffness"] > 0.0:
        length = _carried(scene, decades(u["length"], 50.0, 3000.0))
        scene["line"] = _line(length, _body(scene, u, length, least=2.0, floats=True))
        bottom = 1.1 * length
        scene["vessel"] = {"position": [0.0, 0.0, -bottom]}
        traits["current"] = _add_current(scene, u, bottom, 1.0, changes=_ramp(u))
        return duration
    depth = _carried(scene, decades(u["depth"], 20.0, 1000.0))
    length = depth * decades(u["length"], 1.6, 6.0)
    reach = (0.7 + 0.25 * u["place"]) * math.sqrt(length**2 - depth**2)
    reach = max(reach, 1.02 * (length - depth))  # not piled up below the ship
    turn = 2.0 * math.pi * u["heading"]
    scene["line"] = _line(length, None)
    scene["end"] = {"anchor": [reach * math.cos(turn), reach * math.sin(turn), -depth]}
    scene["environment"]["floor"] = {"z": -depth, "friction": 0.2 + 0.6 * u["friction"]}
    period = decades(u["period"], 20.0, 120.0)
    surge = depth / 30.0 * decades(u["amplitude"], 0.1, 1.0)
    surge = min(surge, 0.2 * (math.sqrt(length**2 - depth**2) - reach))
    scene["vessel"] = _swings(_along(u), surge, period, duration)
    traits["current"] = _add_current(scene, u, depth, 1.0)
    return duration


def _swings(
    along: list[float], amplitude: float, period: float, duration: float, speed: float = 0.0
) -> dict[str, Any]:
    """To and fro about a steady motion to the last direction, to the full extent in 3 periods."""
    omega = 2.0 * math.pi / period
    rows = []
    for k in range(math.ceil(duration / period * SAMPLES) + 4):
        t = k * period / SAMPLES
        part = amplitude * omega * math.sin(omega * t) * min(t / (3.0 * period), 1.0)
        velocity = [part * a for a in along]
        velocity[0] += speed
        rows.append({"t": t, "velocity": velocity})
    return {"position": [0.0, 0.0, 0.0], "velocity": rows, "interpolation": "cubic"}


def _heave(scene: dict[str, Any], u: Numbers, traits: dict[str, Any]) -> float:
    """A load on 20 to 3,000 m below a ship that heaves by up to 2.5 m in 5 to 14 s.

    No ship heaves by more than 2 m/s2. A third of them tow at up to 4 knots.
    """
    length = _carried(scene, decades(u["length"], 20.0, 3000.0))
    period = 5.0 + 9.0 * u["period"]
    highest = 2.0 * (period / (2.0 * math.pi)) ** 2
    amplitude = min(decades(u["amplitude"], 0.1, 2.5), highest)
    duration = (6.0 + 6.0 * u["duration"]) * period
    speed = decades(u["speed"], 1.0, 4.0) * KNOT if u["variant"] < 1.0 / 3.0 else 0.0
    scene["line"] = _line(length, _body(scene, u, length, least=0.1))
    scene["vessel"] = _swings([0.0, 0.0, 1.0], amplitude, period, duration, speed)
    traits["current"] = _add_current(scene, u, length, 0.7)
    return duration


_BUILD = {
    "tow": _tow,
    "turn": _turn,
    "lay": _lay,
    "lower": _lower,
    "recover": _recover,
    "moor": _moor,
    "heave": _heave,
}


def _traits(scene: dict[str, Any], known: dict[str, str | float]) -> dict[str, str | float]:
    """All words and numbers by which outcomes are mapped."""
    cable, floor = scene["cable_types"]["K"], scene["environment"].get("floor")
    bodies = [item["body"] for item in scene["line"] if "body" in item]
    length = sum(item["cable"]["length"] for item in scene["line"] if "cable" in item)
    load = cable["submerged_weight"] * min(length, -floor["z"] if floor else math.inf)
    load += sum(abs(body["submerged_weight"]) for body in bodies)
    rates = [row["rate"] for row in scene.get("payout", {}).get("rate", [])]
    way = "out" if max(rates, default=0.0) > -min(rates, default=0.0) else "in"
    bending = cable["bending_stiffness"]
    return known | {
        "pay-out": way if any(rates) else "none",
        "floor": "none" if floor is None else "sloped" if "slope" in floor else "flat",
        "body": ("end, finite" if "half_length" in bodies[0] else "end, point")
        if bodies
        else "none",
        "end": "anchored" if "end" in scene else "free",
        "top": "pinned",
        "weight": "heavy",
        "EI": "bends" if bending else "zero",
        "shock": "gentle",
        "waves": "none",
        "length": length,
        "strain": load / cable["axial_stiffness"],
        "bending length": (bending / cable["submerged_weight"]) ** (1.0 / 3.0) / length,
        "friction": floor["friction"] if floor else math.nan,
        "tolerance": scene["solver"]["tolerance"],
        "step": scene["run"]["output_interval"],
    }
