"""Industry: OrcaFlex's results for chains, a mooring and dynamic power cables.

Values of OrcaFlex 11.6 are those that the authors of CableDyn published in its VALIDATION.md and
tests (Apache-2.0); series of chains that heave are those that MoorDyn distributes. Scenes are
stated from the properties that both give. OrcaFlex's floor is elastic and its nodes are a metre or
ten apart: within a few per cent is agreement.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

import cablemodel as cm
from validation import draw
from validation.rows import DATA, Row, family, relative

CHAIN = {
    "diameter": 0.252,
    "mass": 390.0,
    "axial_stiffness": 1.674e9,
    "drag_normal": 1.37,
    "drag_tangential": 0.64,
    "added_mass": 1.0,
}
VOLTURN = {**CHAIN, "diameter": 0.333, "mass": 685.0, "axial_stiffness": 3.27e9}
DEPTHS = {"WD0050": (400.0, 50.0, 410.0), "WD0200": (700.0, 200.0, 760.0),
          "WD0600": (1500.0, 600.0, 1700.0)}  # fmt: skip
"""Distance of the anchor, depth, length of three chains [m]."""
QUASI_STATIC = {"WD0050": (991.6, 826.2), "WD0200": (2065.4, 1402.2), "WD0600": (5232.6, 3244.2)}
"""At fairlead and anchor, by quasi-static codes (MoorDyn's tests) [kN]."""
SURFACE = {"regular": {"height": 1e-6, "period": 8.0}}
"""Still water that ends at z = 0: what heaves out of it weighs its own weight."""


def moored(kind: dict[str, float], across: float, top: float, depth: float, length: float,
           **water: Any) -> cm.CableModel:  # fmt: skip
    """A chain from a fairlead at z = top to an anchor on the floor."""
    scene = {
        "environment": {"floor": {"z": -depth}} | water,
        "cable_types": {"chain": kind},
        "line": [{"cable": {"type": "chain", "length": length, "model": "cable"}}],
        "vessel": {"position": [0, 0, top]},
        "end": {"anchor": [across, 0, -depth]},
        "solver": {"tolerance": 1e-4},
    }
    return cm.CableModel(cm.load_scene(scene))


def ends(model: cm.CableModel) -> tuple[float, float]:
    """Tension at the fairlead and at the anchor [kN]."""
    tension = model.state().tension
    return float(model.top_tension) / 1e3, float(tension[-1]) / 1e3


@family("chains", "Industry: chains at rest")
def chains() -> tuple[list[Row], Any]:
    """Still water, currents, the moorings of three sites."""
    rows, (figure, (left,)) = [], draw.axes(1, 6.0)

    def add(case: str, source: str, model: cm.CableModel, expected: tuple[float, ...]) -> None:
        for name, one, other in zip(("fairlead", "anchor"), ends(model), expected, strict=False):
            rows.append(Row("chains", case, source, name, relative(one, other), 2.0, "%"))
            left.loglog(other, one, "o", ms=5, color=draw.FOUND)

    for name, (across, depth, length) in DEPTHS.items():
        model = moored(CHAIN, across, 0.0, depth, length)
        add(f"{name}, still water", "quasi-static codes", model, QUASI_STATIC[name])
    across, depth, length = DEPTHS["WD0050"]
    model = moored(CHAIN, across, 0.0, depth, length)
    add("WD0050, still water", "OrcaFlex 11.6", model, (998.1108935, 832.2421912))
    for name, flow, expected in (
        ("in its plane", [-1.0, 0, 0], (983.637125, 919.157043)),
        ("across", [0, 1.0, 0], (1018.861393, 852.907635)),
    ):
        model = moored(CHAIN, across, 0.0, depth, length, current=flow)
        add(f"WD0050, 1 m/s {name}", "OrcaFlex 11.6", model, expected)
    model = moored(VOLTURN, 779.6, -14.0, 200.0, 850.0)
    add("VolturnUS-S", "OrcaFlex 11.6", model, (2427.011,))
    add("VolturnUS-S", "MoorDyn", model, (2439.0,))
    for site, (top, anchor, pieces), expected in SITES:
        add(f"mooring, {site}", "OrcaFlex 11.6", sited(top, anchor, pieces), (expected,))
    left.plot([5e2, 6e3], [5e2, 6e3], color=draw.REFERENCE, lw=1)
    draw.label(left, "reference [kN]", "cablemodel [kN]")
    return rows, figure


ROPES = {
    "chain160": {"diameter": 0.288, "mass": 512.0, "axial_stiffness": 2.191e9},
    "chain155": {"diameter": 0.2791, "mass": 480.93, "axial_stiffness": 2.058e9},
    "chain120": {"diameter": 0.216, "mass": 288.0, "axial_stiffness": 1.232e9},
    "poly182": {"diameter": 0.1438, "mass": 22.42, "axial_stiffness": 1.42e8},
    "poly184": {"diameter": 0.145, "mass": 23.0, "axial_stiffness": 1.45e8},
}
SITES = (
    ("80 m", (58.0, (400.0, -80.0), (("chain160", 364.5),)), 747.4),
    ("200 m", (58.0, (700.0, -200.0), (("poly182", 199.8), ("chain155", 497.7))), 1199.2),
    (
        "800 m",
        (58.0, (1400.0, -800.0), (("chain120", 80.0), ("poly184", 1378.9), ("chain120", 80.0))),
        1881.5,
    ),
)
"""Moorings of Lozon et al. 2025: x of the fairlead, anchor, pieces; fairlead tension [kN]."""


def sited(top: float, anchor: tuple[float, float], pieces: Any) -> cm.CableModel:
    """One line of such a mooring."""
    scene = {
        "environment": {"floor": {"z": anchor[1]}},
        "cable_types": ROPES,
        "line": [
            {"cable": {"type": kind, "length": length, "model": "cable"}} for kind, length in pieces
        ],
        "vessel": {"position": [top, 0, -14]},
        "end": {"anchor": [anchor[0], 0, anchor[1]]},
        "solver": {"tolerance": 1e-4},
    }
    return cm.CableModel(cm.load_scene(scene))


# Chains in motion --------------------------------------------------------------------------------


@family("heave", "Industry: chains whose fairlead heaves; of twice the swing")
def heaving() -> tuple[list[Row], Any]:
    """z = A sin(2 pi t / 10), and an hour of two motions at once."""
    rows, (figure, grid) = [], draw.axes(6, 15.0)
    with (DATA / "orcaflex_chains.csv").open() as file:
        table = [line.strip().split(",") for line in file if not line.startswith("#")][1:]
    grid_of = iter(grid)
    for name, (across, depth, length) in DEPTHS.items():
        for motion, reach in (("A1", 2.0), ("A2", 5.0)):
            series = np.array([list(map(float, r[2:])) for r in table if r[:2] == [name, motion]])
            model = moored(CHAIN, across, 0.0, depth, length, waves=SURFACE)
            static = np.array([model.top_tension, model.state().tension[-1]]) / 1e3
            found = _heaved(model, reach, series[:, 0])
            off = np.abs(found - series[:, 2:]).max(axis=0)
            off *= 50.0 / np.abs(series[:, 2:] - static).max(axis=0)
            case = f"{name}, heave of {reach:g} m"
            rows += [
                Row("heave", case, "OrcaFlex", end, float(share), 15.0, "%")
                for end, share in zip(("fairlead", "anchor"), off, strict=True)
            ]
            one = next(grid_of)
            one.plot(series[:, 0], series[:, 2], color=draw.REFERENCE, label="OrcaFlex")
            one.plot(series[:, 0], found[:, 0], color=draw.FOUND, label="cablemodel")
            draw.label(one, "time [s]", "fairlead [kN]" if name == "WD0050" else "", case)
    rows += _hour()
    return rows, figure


def _heaved(model: cm.CableModel, reach: float, times: Any, warm: float = 60.0) -> Any:
    """Fairlead's and anchor's tensions [kN], (times, 2), at times [s] after `warm` seconds of heave
    (whole periods)."""
    rate, found = 2.0 * math.pi / 10.0, []
    instants = np.arange(1, round((warm + times[-1]) / 0.1) + 1) * 0.1
    wanted = {round(10 * (warm + t)) for t in times}
    for k, t in enumerate(instants, start=1):
        share = min(t / 10.0, 1.0)
        up, rise = share**2 * (3 - 2 * share), 6 * share * (1 - share) / 10.0
        z = reach * up * math.sin(rate * t)
        speed = reach * (rise * math.sin(rate * t) + up * rate * math.cos(rate * t))
        model.step_to(t, vessel_position=[0, 0, z], vessel_velocity=[0, 0, speed])
        if k in wanted:
            found.append((model.top_tension / 1e3, model.state().tension[-1] / 1e3))
    return np.array(found)


def _hour() -> list[Row]:
    """Surge of 5 m in 90 s with heave of 2 m in 12 s, for an hour, VolturnUS-S."""
    model = moored(VOLTURN, 779.6, -14.0, 200.0, 850.0, waves=SURFACE)
    times, tops = np.arange(1, 36001) * 0.1, []
    for t in times:
        share = min(t / 100.0, 1.0)
        up, rise = 0.5 - 0.5 * math.cos(math.pi * share), 0.0
        if share < 1.0:
            rise = 0.5 * math.pi / 100.0 * math.sin(math.pi * share)
        place, speed = [0.0, 0.0, -14.0], [0.0, 0.0, 0.0]
        for axis, reach, period in ((0, 5.0, 90.0), (2, 2.0, 12.0)):
            rate = 2.0 * math.pi / period
            place[axis] += reach * up * math.sin(rate * t)
            speed[axis] = reach * (rise * math.sin(rate * t) + up * rate * math.cos(rate * t))
        model.step_to(t, vessel_position=place, vessel_velocity=speed)
        tops.append(model.top_tension / 1e3)
    tension = np.array(tops)
    late = tension[times > 200.0]

    def amplitude(period: float, start: float) -> float:
        part = times > start
        wave = np.exp(-2j * math.pi * times[part] / period)
        return float(2.0 * abs(np.mean(tension[part] * wave)))

    values = {
        "mean": (late.mean(), 2439.385),
        "standard deviation": (late.std(), 206.079),
        "lowest": (late.min(), 2057.857),
        "highest": (late.max(), 2850.911),
        "amplitude at 90 s": (amplitude(90.0, 270.0), 228.569),
        "amplitude at 12 s": (amplitude(12.0, 204.0), 178.796),
    }
    case = "VolturnUS-S, one hour"
    return [
        Row("heave", case, "OrcaFlex 11.6", name, relative(*pair), 5.0, "%")
        for name, pair in values.items()
    ]


# Dynamic power cables ----------------------------------------------------------------------------

BARE = {
    "diameter": 0.16,
    "mass": 36.7,
    "axial_stiffness": 4.69e8,
    "bending_stiffness": 1.99e4,
    "drag_normal": 1.2,
    "drag_tangential": 0.1,
    "added_mass": 1.0,
}
CABLES = {
    "80 m": (125.0, -80.0, (68.114, 50.0, 52.101), 0.29, 59.53),
    "200 m": (205.0, -200.0, (171.978, 60.0, 121.527), 0.30, 60.85),
    "800 m": (805.0, -800.0, (372.449, 400.0, 597.981), 0.29, 59.17),
}
"""Anchor x and z, lengths of bare, buoyant and bare cable [m], diameter [m] and mass [kg/m] of the
buoyant one: Lozon et al. 2025, tables 3, 4, 11, 16, 21."""
SPANS = {
    "80 m": (83.875401, -79.999985, 134.10728),
    "200 m": (108.96953, -199.999951, 262.50768),
    "800 m": (349.884466, -799.999769, 920.43387),
}
"""Touchdown where the hanging part is pinned, x from the hang-off and z, and its length [m]."""
INSTALLED = {"80 m": (9.32, 0.0968), "200 m": (25.16, 0.0831), "800 m": (56.535, 0.02802)}
"""Hang-off tension [kN] and largest curvature [1/m] at rest."""
HEAVED = {
    "80 m": (0.10279, 9.3210, 5.6342, 13.0806),
    "200 m": (0.08823, 25.1560, 14.8934, 35.5169),
    "800 m": (0.03881, 57.7876, 33.2413, 82.9632),
}
"""Pinned spans whose hang-off heaves by 3 m in 12 s: largest curvature [1/m]; mean, lowest and
highest tension [kN]."""


def power_cable(site: str, *, pinned: bool = False, **settings: Any) -> cm.CableModel:
    """A lazy wave from a hang-off 14 m below the surface, installed or pinned at its touchdown."""
    x, z, lengths, diameter, mass = CABLES[site]
    top = 5.0
    if pinned:
        x, z, length = SPANS[site]
        top, lengths = 0.0, (*lengths[:2], length - sum(lengths[:2]))
    line = [
        {"cable": {"type": kind, "length": length, "model": "elastica"}}
        for kind, length in zip(("bare", "buoyant", "bare"), lengths, strict=True)
    ]
    water = settings.pop("environment", {})
    scene = {
        "environment": water if pinned else {"floor": {"z": z}, **water},
        "cable_types": {"bare": BARE, "buoyant": {**BARE, "diameter": diameter, "mass": mass}},
        "line": line,
        "vessel": {"position": [top, 0, -14]},
        "end": {"anchor": [x, 0, z]},
        "solver": {"tolerance": 1e-4},
        **settings,
    }
    return cm.CableModel(cm.load_scene(scene))


def inner_curvature(model: cm.CableModel) -> float:
    """Largest curvature of what is 3 to 97 % of the way along the line [1/m]."""
    s = np.linspace(0.03, 0.97, 1500) * model.line_length
    return float(model.sample(s).curvature.max())


def heaved(model: cm.CableModel) -> tuple[Any, Any, list[float]]:
    """Times [s], hang-off tension [kN] from 24 to 60 s, and the largest curvature then [1/m]."""
    start, rate = model.vessel_position, 2.0 * math.pi / 12.0
    times, tension, bend, touch = [], [], 0.0, []
    for k in range(1, 601):
        t = 0.1 * k
        share = min(t / 12.0, 1.0)
        up, rise = share**2 * (3 - 2 * share), 6 * share * (1 - share) / 12.0
        z = 3.0 * up * math.sin(rate * t)
        speed = 3.0 * (rise * math.sin(rate * t) + up * rate * math.cos(rate * t))
        place = start + np.array([0.0, 0.0, z])
        model.step_to(t, vessel_position=place, vessel_velocity=[0, 0, speed])
        if t > 24.0:
            times.append(t)
            tension.append(model.sample(0.0).tension[0] / 1e3)
            bend = max(bend, inner_curvature(model))
            touch.append(model.line_length - model.floor_length)
    return np.array(times), np.array(tension), [bend, min(touch), max(touch)]


@family("cables", "Industry: dynamic power cables")
def cables() -> tuple[list[Row], Any]:
    """Lazy waves at three depths: at rest, in heave, in a sea, with a touchdown that moves."""
    rows, (figure, grid) = [], draw.axes(4, 14.0)
    source = "OrcaFlex 11.6"
    for site in CABLES:
        model = power_cable(site)
        top, bend = INSTALLED[site]
        case = f"{site}, at rest"
        found = model.sample(0.0).tension[0] / 1e3
        rows.append(Row("cables", case, source, "hang-off tension", relative(found, top), 1.0, "%"))
        off = relative(inner_curvature(model), bend)
        rows.append(Row("cables", case, source, "largest curvature", off, 1.0, "%"))
        shape = model.sample(np.linspace(0, model.line_length, 300)).position
        grid[0].plot(shape[:, 0], shape[:, 2], label=site)
    draw.label(grid[0], "x [m]", "z [m]", "at rest")
    for site, one in zip(CABLES, grid[1:], strict=True):
        times, tension, (bend, *_) = heaved(power_cable(site, pinned=True))
        rows += _compared(f"{site}, heave of 3 m", bend, tension, HEAVED[site], 2.0)
        one.plot(times, tension, color=draw.FOUND)
        for value in HEAVED[site][1:]:
            one.axhline(value, color=draw.REFERENCE, lw=1)
        draw.label(one, "time [s]", "hang-off tension [kN]", f"{site}; lines: OrcaFlex")
    times, tension, (bend, near, far) = heaved(power_cable("80 m"))
    expected = (0.10321, 9.3321, 5.6513, 13.0876)
    rows += _compared("80 m, touchdown that moves", bend, tension, expected, 2.0)
    for name, value, other in (("nearest", near, 134.48), ("farthest", far, 137.48)):
        rows.append(Row("cables", "80 m, touchdown that moves", source, f"{name} touchdown",
                        abs(value - other), 1.5, "m"))  # fmt: skip
    rows += _sea()
    return rows, figure


def _compared(case: str, bend: float, tension: Any, expected: Any, limit: float) -> list[Row]:
    found = (bend, tension.mean(), tension.min(), tension.max())
    names = ("largest curvature", "mean tension", "lowest tension", "highest tension")
    return [
        Row("cables", case, "OrcaFlex 11.6", name, relative(one, other), limit, "%")
        for name, one, other in zip(names, found, expected, strict=True)
    ]


def _sea() -> list[Row]:
    """Hs 2 m, Tp 12 s, 80 components, 120 s: another realisation than OrcaFlex's.

    Two of OrcaFlex's own realisations differ by 1.3 % in the largest curvature.
    """
    sea = {"jonswap": {"hs": 2.0, "tp": 12.0, "seed": 12345, "components": 80}}
    model = power_cable("80 m", pinned=True, environment={"waves": sea, "floor": {"z": -81.0}})
    tension, bend = [], 0.0
    for k in range(1, 289):
        model.step_to(0.5 * k)
        if model.time > 24.0:
            tension.append(model.sample(0.0).tension[0] / 1e3)
            bend = max(bend, inner_curvature(model))
    case, source = "80 m, JONSWAP, another realisation", "OrcaFlex 11.6"
    return [
        Row("cables", case, source, "mean tension", relative(np.mean(tension), 9.3072), 1.0, "%"),
        Row("cables", case, source, "largest curvature", relative(bend, 0.10254), 5.0, "%"),
    ]
