"""Lays, touchdown and the sea floor."""

from __future__ import annotations

from typing import Any

import numpy as np

import cablemodel as cm
from tests.verification.references.lays import ARMOURED, LIGHT, bottom_tension, independent, lay
from tests.verification.scenes import CABLE_K
from tests.verification.touchdown_layer import touchdown_layer
from validation import draw
from validation.rows import Row, family, relative


@family("lays", "Lays, touchdown, sea floor")
def lays() -> tuple[list[Row], Any]:
    """Zajac's lay with stretch and momentum, the layer of bending, dragging."""
    rows, (figure, (left, right)) = [], draw.axes(2)
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
