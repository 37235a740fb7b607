"""Lays, touchdown and the sea floor."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

import cablemodel as cm
from cablemodel.errors import TautLayWarning
from tests.verification.references.lays import (
    ARMOURED,
    KNOT,
    LIGHT,
    bottom_tension,
    independent,
    lay,
)
from tests.verification.references.lumped_lay import lay_in_heave
from tests.verification.scenes import CABLE_K
from tests.verification.touchdown_layer import touchdown_layer
from validation import draw
from validation.rows import Row, family, relative


@family("lays", "Lays, touchdown, sea floor")
def lays() -> tuple[list[Row], Any]:
    """Zajac's lay with stretch and momentum, the layer of bending, dragging."""
    rows, (figure, (left, right, below)) = [], draw.axes(3)
    cases = {
        "light cable, 5 kn, 4,000 m": (LIGHT, 5.0, 4000.0, 20.0, 0.0, 0.0),
        "light cable, 8 kn, 500 m": (LIGHT, 8.0, 500.0, 1.0, 0.0, 0.0),
        "light cable, 1 kn up 15 degrees": (LIGHT, 1.0, 500.0, 1.0, 15.0, 0.0),
        "armoured, 8 kn, 2,000 m": (ARMOURED, 8.0, 2000.0, 5000.0, 0.0, 0.0),
        "armoured, 3 kn, 8,000 m, 2 % slack": (ARMOURED, 3.0, 8000.0, 1000.0, 0.0, 0.02),
    }
    for case, (kind, knots, depth, stiff, slope, slack) in cases.items():
        scene, rate = lay(kind, knots, depth, bending=stiff, slope=slope, slack=slack)
        model = cm.CableModel(scene)
        rise = -float(model.touchdown_position[2])
        top, _ = independent(kind, knots, rate, bottom_tension(model), rise, straight=True)
        off = relative(model.top_tension, top)
        rows.append(Row("lays", case, "Zajac 1957, ODE", "top tension", off, 0.5, "%"))
        s = np.linspace(0.0, model.line_length, 200)
        shape = model.sample(s).position / depth
        left.plot(shape[:, 0], shape[:, 2], label=case)
    for stiff in (1.0, 10.0, 50.0):
        rows += _layer(stiff, right)
    rows.append(_dragged())
    rows += _in_heave(below)
    draw.label(left, "x [depth]", "z [depth]", "shapes of lays")
    draw.label(right, "from the touchdown [m]", "curvature [1/m]", "crosses: largest of the BVP")
    return rows, figure


def _layer(stiff: float, one: Any) -> list[Row]:
    """A frictionless lay that starts steadily."""
    kind = {**CABLE_K, "bending_stiffness": stiff}
    cable = {"cable": {"type": "K", "length": 120.0, "model": "elastica"}}
    scene = cm.load_scene(
        {
            "environment": {"floor": {"z": -70}},
            "cable_types": {"K": kind},
            "line": [cable],
            "vessel": {"velocity": [0.65, 0, 0]},
            "payout": {"rate": [{"t": 0, "rate": 0.65}], "drum": [cable]},
            "solver": {"tolerance": 1e-4},
        }
    )
    model = cm.CableModel(scene)
    lying = model.floor_length
    tension = float(model.sample([model.line_length - lying]).tension[0])
    reaction, curvature = touchdown_layer(scene.cable_types["K"], tension, 0.65, 0.65)
    s = np.linspace(model.line_length - lying - 12.0, model.line_length - lying, 1201)
    found = model.sample(s).curvature
    case = f"touchdown, EI {stiff:g} N m2"
    one.plot(model.line_length - lying - s, found, label=case)
    one.plot(model.line_length - lying - s[np.argmax(found)], curvature, "x", color=draw.REFERENCE)
    source = "boundary value problem"
    return [
        Row(
            "lays", case, source, "reaction", relative(model.touchdown_reaction, reaction), 1.0, "%"
        ),
        Row("lays", case, source, "curvature", relative(found.max(), curvature), 1.0, "%"),
    ]


def _dragged() -> Row:
    """20 m over a floor at 0.5 m/s, friction 0.5: linear along the cable."""
    speed, weight = 0.5, CABLE_K["submerged_weight"]
    scene = {
        "environment": {"floor": {"z": 0, "friction": 0.5}},
        "cable_types": {"K": CABLE_K},
        "line": [{"cable": {"type": "K", "length": 20.0, "model": "elastica"}}],
        "initial": {"points": [[0, 0, 0], [-20, 0, 0]]},
        "vessel": {
            "velocity": [{"t": 0, "velocity": [0, 0, 0]}, {"t": 10, "velocity": [speed, 0, 0]}]
        },
        "solver": {"tolerance": 1e-4},
    }
    model = cm.CableModel(cm.load_scene(scene))
    model.step_to(60.0)
    drag = 0.5 * 1025.0 * CABLE_K["drag_tangential"] * np.pi * CABLE_K["diameter"] * speed**2
    off = relative(model.top_tension, 20.0 * (drag + 0.5 * weight))
    return Row("lays", "cable dragged over a floor", "Coulomb, drag", "tension", off, 0.1, "%")


def _in_heave(one: Any) -> list[Row]:
    """A fibre cable at 5 knots in 200 m, a little taut, from a ship that heaves by 1 m in 8 s.

    Masses that join the line shake it: peaks of the reference are within 1 % of finer ones.
    """
    kind = {
        "diameter": 0.03, "mass": 1.5, "axial_stiffness": 12e6, "axial_damping": 5e3,
        "drag_normal": 1.2, "drag_tangential": 0.01,
    }  # fmt: skip
    speed, depth, period, ramp, duration = 5.0 * KNOT, 200.0, 8.0, 20.0, 80.0
    turn = 2.0 * np.pi / period
    times = np.arange(0.0, duration + 0.5, 0.25)
    upwards = -turn * np.sin(turn * times) * np.minimum(1.0, times / ramp)
    table = [
        {"t": float(t), "velocity": [speed, 0.0, float(rise)]}
        for t, rise in zip(times, upwards, strict=True)
    ]
    scene = {
        "environment": {"floor": {"z": -depth, "friction": 0.3}},
        "cable_types": {"fibre": kind},
        "line": [{"cable": {"type": "fibre", "length": 900.0}}],
        "vessel": {"velocity": table, "interpolation": "cubic"},
        "payout": {
            "rate": 0.98 * speed, "drum": [{"cable": {"type": "fibre", "length": 500.0}}]
        },
    }  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", TautLayWarning)  # as it is meant to be
        finer = cm.CableModel(cm.load_scene({**scene, "solver": {"tolerance": 1e-4}}))
        model = cm.CableModel(cm.load_scene(scene))
    shape = finer.sample(np.linspace(0.0, 900.0, 451)).position[:, [0, 2]]
    wave = {"heave": 1.0, "period": period, "ramp": ramp, "duration": duration}
    places = {"speed": speed, "depth": depth, "friction": 0.3}
    wanted = lay_in_heave(shape, 900.0, kind=kind, payout=0.98 * speed, **places, **wave)
    found = np.zeros(len(wanted))
    for k in range(len(found)):
        model.step_to(0.1 * (k + 1))
        found[k] = model.top_tension
    wanted, found = wanted[300:], found[300:]
    at = 30.0 + 0.1 * np.arange(1, len(found) + 1)
    one.plot(at, wanted / 1e3, color=draw.REFERENCE, label="lumped masses")
    one.plot(at, found / 1e3, label="lay in heave")
    draw.label(one, "t [s]", "top tension [kN]", "5 kn, heave of 1 m")
    case, source = "5 kn in 200 m, heave of 1 m", "lumped masses"
    off = np.sqrt(np.mean((found - wanted) ** 2)) / np.ptp(wanted)
    highest = relative(found.max(), wanted.max())
    return [
        Row("lays", case, source, "highest tension", highest, 2.0, "%"),
        Row("lays", case, source, "rms of range", 100.0 * float(off), 3.0, "%"),
    ]
