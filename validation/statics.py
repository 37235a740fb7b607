"""Closed forms and static differential equations: catenaries, elastica, tows, moorings, modes."""

from __future__ import annotations

from typing import Any

import numpy as np

import cablemodel as cm
from tests.verification.references import catenary, elastica, modes, static_cable
from tests.verification.references.moored import moored_catenary
from tests.verification.scenes import IDEAL, cantilever, scene
from validation import draw
from validation.rows import Row, family, relative

TAU = 1e-4
GRAVITY = 9.80665


@family("catenaries", "Closed forms: catenaries and moorings")
def catenaries() -> tuple[list[Row], Any]:
    """Elastic catenaries, hanging and partly on a floor."""
    rows, (figure, (left, right)) = [], draw.axes(2)
    for rise, stiffness in ((300.0, 1e7), (300.0, 1e5), (600.0, 1e8)):
        exact = catenary.elastic_catenary(800.0, rise, 1000.0, 10.0, stiffness)
        cable = {**IDEAL, "submerged_weight": 10.0, "axial_stiffness": stiffness}
        model = cm.CableModel(
            scene(
                1000.0,
                cable,
                model="cable",
                tolerance=TAU,
                end={"anchor": [0.0, 0.0, 0.0]},
                vessel={"position": [800.0, 0.0, rise]},
            )
        )
        s = np.linspace(0.0, 1000.0, 41)
        found = model.sample(s).position[:, [0, 2]]
        shape = np.array([exact.position(1000.0 - value) for value in s])
        off = float(np.abs(found - shape).max())
        case, source = f"1 km, rise {rise:g} m, EA {stiffness:.0e} N", "Irvine 1981"
        rows.append(Row("catenaries", case, source, "position", off, 1000.0 * TAU, "m"))
        top = relative(model.top_tension, exact.tension(1000.0))
        rows.append(Row("catenaries", case, source, "top tension", top, 1e3 * TAU, "%"))
        left.plot(*shape.T, color=draw.REFERENCE, lw=1)
        left.plot(*found[::4].T, "o", ms=3, label=case)
    for friction in (0.0, 1.0):
        line = moored_catenary(848.67, 250.0, 902.2, 698.094, 384.243e6, friction)
        kind = {
            "diameter": 0.1,
            "mass": 698.094 / GRAVITY,
            "submerged_weight": 698.094,
            "axial_stiffness": 384.243e6,
        }
        model = cm.CableModel(
            scene(
                902.2,
                kind,
                model="cable",
                tolerance=TAU,
                floor={"z": 0, "friction": friction},
                end={"anchor": [848.67, 0, 0]},
                vessel={"position": [0, 0, 250.0]},
            )
        )
        s = np.linspace(0.0, 902.2, 61)
        case, source = f"mooring, friction {friction:g}", "catenary with Coulomb friction"
        exact_top = line.tension(np.array([902.2]))[0]
        off = relative(model.top_tension, exact_top)
        rows.append(Row("catenaries", case, source, "top tension", off, 1e3 * TAU, "%"))
        anchor, found_anchor = line.tension(np.array([0.0]))[0], model.state().tension[-1]
        off = 100.0 * abs(found_anchor - anchor) / exact_top
        rows.append(
            Row("catenaries", case, source, "anchor tension, of the top's", off, 1e3 * TAU, "%")
        )
        right.plot(s, line.tension(s) / 1e3, color=draw.REFERENCE, lw=1)
        here = model.sample(902.2 - s[::5]).tension / 1e3
        right.plot(s[::5], here, "o", ms=3, label=case)
    draw.label(left, "x [m]", "z [m]", "lines: closed form")
    draw.label(right, "from the anchor [m]", "tension [kN]", "lines: closed form")
    return rows, figure


@family("bending", "Closed forms: bending")
def bending() -> tuple[list[Row], Any]:
    """Large deflections and the layer at a clamp."""
    rows, (figure, (left, right)) = [], draw.axes(2)
    for load in (1.0, 10.0):
        x, z, _ = elastica.cantilever_tip_load(load)
        model = cantilever(1.0, load=load, axial_stiffness=1e8 * load, tolerance=TAU)
        off = float(np.hypot(model.tip_position[0] - x, model.tip_position[2] + z))
        case, source = f"end load, P L2/EI = {load:g}", "elliptic integrals (Bisshopp, Drucker)"
        rows.append(Row("bending", case, source, "end, of L", off, TAU, ""))
        off = relative(abs(model.top_moment[1]), load * x)
        rows.append(Row("bending", case, source, "moment at the clamp", off, 1e3 * TAU, "%"))
        left.plot(*model.sample(np.linspace(0, 1, 60)).position[:, [0, 2]].T, label=case)
        left.plot(x, -z, "x", color=draw.REFERENCE)
    for weight in (1.0, 100.0):
        exact = elastica.extensible_rod(1.0, 1.0, 1e8, 0.0, weight=weight)
        model = cantilever(1.0, weight=weight, axial_stiffness=1e8, tolerance=TAU)
        off = float(np.linalg.norm(model.tip_position[[0, 2]] - exact.tip))
        case = f"own weight, w L3/EI = {weight:g}"
        rows.append(Row("bending", case, "rod ODE", "end, of L", off, TAU, ""))
        left.plot(*model.sample(np.linspace(0, 1, 60)).position[:, [0, 2]].T, label=case)
        left.plot(*exact.tip, "x", color=draw.REFERENCE)
    for degrees in (10.0, 30.0, 60.0):
        angle = np.radians(degrees)
        clamp = {"connection": {"clamped": [np.sin(angle), 0.0, -np.cos(angle)]}}
        model = cantilever(20.0, load=100.0, axial_stiffness=1e9, vessel=clamp, tolerance=TAU)
        moment = elastica.clamped_end_curvature(1.0, 100.0, angle)
        off = relative(np.linalg.norm(model.top_moment), moment)
        case, source = f"clamp at {degrees:g} degrees", "(2/lambda) sin(a/2)"
        rows.append(Row("bending", case, source, "moment", off, 50.0 * TAU**0.5, "%"))
        s = np.linspace(0.0, 0.6, 60)
        right.plot(s, model.sample(s).curvature, label=case)
        right.plot(0.0, moment, "x", color=draw.REFERENCE)
    draw.label(left, "x [L]", "z [L]", "crosses: closed form")
    draw.label(right, "from the clamp [m]", "curvature [1/m]", "crosses: closed form")
    return rows, figure


TOW = {
    "diameter": 0.025,
    "mass": 1.3,
    "submerged_weight": 8.0,
    "axial_stiffness": 5e6,
    "bending_stiffness": 0.0,
    "drag_normal": 1.2,
    "drag_tangential": 0.02,
    "added_mass": 1.0,
}
FISH = {
    "mass": 700.0,
    "submerged_weight": 5000.0,
    "drag_area": 0.5,
    "drag_coefficient": 0.8,
    "drag_area_axial": 0.5,
    "drag_coefficient_axial": 0.1,
}


def towed(length: float) -> static_cable.CableProperties:
    """The reference's cable."""
    strain = static_cable.linear_strain(TOW["axial_stiffness"])
    names = ("submerged_weight", "diameter", "drag_normal", "drag_tangential")
    weight, diameter, normal, tangential = (TOW[name] for name in names)
    return static_cable.CableProperties(length, weight, strain, diameter, normal, tangential)


@family("tows", "Static equations: tows and currents")
def tows() -> tuple[list[Row], Any]:
    """The static differential equation, integrated from the body upwards."""
    rows, (figure, (left, right)) = [], draw.axes(2)
    body = static_cable.EndBody(5000.0, 0.4, 0.05)
    source = "static ODE, DOP853"
    for speed in (1.0, 2.0, 3.0):
        exact = static_cable.steady_shape(
            towed(1000.0), body, lambda z, u=speed: np.array([-u, 0.0, 0.0])
        )
        vessel = {"velocity": [{"t": 0, "velocity": [speed, 0.0, 0.0]}]}
        model = cm.CableModel(scene(1000.0, TOW, tolerance=TAU, body=FISH, vessel=vessel))
        off = float(np.linalg.norm(model.tip_position - exact.end_position))
        case = f"body on 1 km at {speed:g} m/s"
        rows.append(Row("tows", case, source, "position", off, 1000.0 * TAU, "m"))
        off = relative(model.top_tension, exact.top_tension)
        rows.append(Row("tows", case, source, "top tension", off, 1e3 * TAU, "%"))
        s = np.linspace(0.0, 1000.0, 51)
        left.plot(*exact.position(s)[:, [0, 2]].T, color=draw.REFERENCE, lw=1)
        left.plot(*model.sample(s[::5]).position[:, [0, 2]].T, "o", ms=3, label=case)
    depths, east, north = [-300.0, -120.0, 0.0], [-0.3, 0.9, 1.5], [0.2, -0.4, 0.3]

    def water(z: float) -> Any:
        return np.array([np.interp(z, depths, east), np.interp(z, depths, north), 0.0])

    table = [{"z": z, "velocity": [u, v, 0.0]} for z, u, v in zip(depths, east, north, strict=True)]
    exact = static_cable.steady_shape(towed(400.0), body, water)
    model = cm.CableModel(scene(400.0, TOW, tolerance=TAU, body=FISH, current={"table": table}))
    off = float(np.linalg.norm(model.tip_position - exact.end_position))
    case = "current that turns with depth"
    rows.append(Row("tows", case, source, "position", off, 400.0 * TAU, "m"))
    off = relative(model.top_tension, exact.top_tension)
    rows.append(Row("tows", case, source, "top tension", off, 1e3 * TAU, "%"))
    s = np.linspace(0.0, 400.0, 41)
    for place, name in ((0, "east"), (1, "north")):
        right.plot(exact.position(s)[:, place], -s, color=draw.REFERENCE, lw=1)
        right.plot(model.sample(s[::4]).position[:, place], -s[::4], "o", ms=3, label=name)
    curve = [4.0e-6, -2.0e-10, 6.0e-15]
    cable = {**IDEAL, "submerged_weight": 30.0, "tension_strain": curve}
    del cable["axial_stiffness"]
    model = cm.CableModel(
        scene(400.0, cable, tolerance=TAU, body={"mass": 500.0, "submerged_weight": 4000.0})
    )
    length = static_cable.hanging_length(400.0, 30.0, 4000.0, curve)
    off = abs(model.tip_position[2] + length)
    rows.append(
        Row("tows", "hanging, strain a cubic in T", "integral", "length", off, 400.0 * TAU, "m")
    )
    draw.label(left, "x [m]", "z [m]", "lines: ODE")
    draw.label(right, "aside [m]", "along the line [m]", "current that turns; lines: ODE")
    return rows, figure


@family("modes", "Closed forms: natural frequencies")
def natural() -> tuple[list[Row], Any]:
    """Frequencies of chains, rods, strings and bars."""
    rows, (figure, (left,)) = [], draw.axes(1)

    def add(case: str, source: str, model: cm.CableModel, expected: Any, accept: float) -> None:
        expected = np.asarray(expected)
        found = model.natural_frequencies(len(expected))
        off = float(100.0 * np.abs(found / expected - 1.0).max())
        rows.append(Row("modes", case, source, f"first {len(expected)}", off, accept, "%"))
        left.plot(found / found[0], expected / expected[0], "o", ms=5, alpha=0.6, label=case)

    chain = {**IDEAL, "submerged_weight": GRAVITY, "axial_stiffness": 1e8}
    model = cm.CableModel(scene(10.0, chain, model="cable", elements=32, density=0.0))
    add("hanging chain", "Bernoulli", model, modes.hanging_chain(10.0, 3), 1e-4)
    rod = {**chain, "bending_stiffness": 1e-3 * GRAVITY}
    down = {"connection": {"clamped": [0.0, 0.0, -1.0]}}
    model = cm.CableModel(scene(1.0, rod, elements=64, density=0.0, vessel=down))
    expected = np.array(modes.hanging_elastica(1e-3, 3)) * np.sqrt(GRAVITY)
    add("hanging rod, EI/w L3 = 1e-3", "power series", model, expected, 1e-3)
    beam = {**IDEAL, "axial_stiffness": 1e9, "bending_stiffness": 1.0}
    level = {"clamped": [1.0, 0.0, 0.0]}
    for name, vessel, tension in (("cantilever", True, 0.0), ("pinned", False, 100.0),
                                  ("clamped", True, 100.0)):  # fmt: skip
        reach = 1.0 + tension / 1e9
        end: Any = "free"
        if tension:
            end = {"anchor": [reach, 0.0, 0.0], **({"connection": level} if vessel else {})}
        model = cm.CableModel(
            scene(
                1.0,
                beam,
                elements=16,
                density=0.0,
                end=end,
                vessel={"connection": level} if vessel else None,
                initial={"points": [[0, 0, 0], [reach, 0, 0]]},
            )
        )
        exact = {
            "cantilever": lambda: np.array(modes.cantilever(2)) ** 2,
            "pinned": lambda: modes.tensioned_beam_pinned(100.0, 2),
            "clamped": lambda: modes.tensioned_beam_clamped(100.0, 2),
        }[name]()
        title = name if name == "cantilever" else f"beam under tension, {name}"
        add(title, "Euler beam", model, exact, 5e-3)
    for parameter in (1.0, 4.0 * np.pi**2, 100.0):
        stiffness = parameter / 1e-6
        sagging = {**IDEAL, "submerged_weight": 1e-3, "axial_stiffness": stiffness}
        span = catenary.pinned_catenary_span(1.0, 1.0, 1e-3, stiffness)
        end = {"anchor": [span, 0.0, 0.0]}
        model = cm.CableModel(scene(1.0, sagging, model="cable", elements=48, density=0, end=end))
        exact = sorted([modes.irvine_symmetric(parameter), 2.0 * np.pi])
        add(f"sagging, lambda2 = {parameter:.3g}", "Irvine 1974", model, exact, 2e-4)
    model = cm.CableModel(
        scene(
            1000.0,
            {**IDEAL, "axial_stiffness": 1e7, "submerged_weight": GRAVITY},
            model="cable",
            elements=4,
            density=0.0,
            body={"mass": 1000.0, "submerged_weight": 1000.0 * GRAVITY},
        )
    )
    (exact,) = modes.axial_with_end_mass(1000.0, 1e7, 1.0, 1000.0, 1)
    found = model.natural_frequencies(16)
    off = float(100.0 * np.abs(found / exact - 1.0).min())
    rows.append(Row("modes", "bar with an end mass", "b tan b = 1", "axial mode", off, 1e-3, "%"))
    left.plot([1, 7], [1, 7], color=draw.REFERENCE, lw=1)
    draw.label(left, "computed, over the first", "closed form, over the first")
    return rows, figure
