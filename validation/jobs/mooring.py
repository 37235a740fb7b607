"""Moorings, tow lines, power cables."""

from __future__ import annotations

import numpy as np

from tests.verification.references.catenary import elastic_catenary
from tests.verification.references.jobs import Kind, hanging_line
from tests.verification.references.moored import moored_catenary
from validation import industry, published
from validation.jobs.book import Answer, Result, job, model, picture, scene, shape
from validation.jobs.towing import kinds


@job
def mooring_knockdown() -> Result:
    """Balance of forces from the float down."""
    given, ours = scene("mooring_knockdown"), model("mooring_knockdown")
    known = kinds(given)
    depths = [-3200.0, -1000.0, -500.0, -200.0, 0.0]

    def water(z):
        return np.array([np.interp(z, depths, [0.05, 0.25, 0.5, 0.9, 1.0]), 0.0, 0.0])

    items = [
        (-8e3, 1.1 * 0.6),
        (known["wire"], 500.0),
        (100.0, 0.1),
        (known["wire"], 1000.0),
        (known["nylon"], 1500.0),
    ]
    anchor = np.array([0.0, 0.0, -3200.0])
    tip, force, places = hanging_line(items, water, anchor, (-1000.0, -10.0))
    pull = float(np.linalg.norm(force))
    answers = [
        Answer("depth of the float", -ours.tip_position[2], -tip[2], "m", 3.0),
        Answer("its offset", ours.tip_position[0], tip[0], "m", 3.0),
        Answer("tension at the anchor", ours.top_tension, pull, "N", 10e-3 * pull),
    ]
    mine, s = shape(ours), np.linspace(0.0, ours.line_length, 200)
    tension = ours.sample(s).tension
    shapes = {"cablemodel": mine, "independent": places}
    return answers, picture(shapes, {"tension": (tension, mine[:, 2])}, ("tension [N]", "z [m]"))


@job
def chain_leg() -> Result:
    """A catenary that partly lies, with friction."""
    offsets, found, exact, answers, shapes = [], [], [], [], {}
    for place in (540.0, 550.0, 560.0, 570.0, 575.0, 580.0, 583.0):
        ours = model("chain_leg", [f"end.anchor.0={place}"])
        line = moored_catenary(place, 100.0, 600.0, 1070.0, 500e6, 0.6)
        offsets.append(place)
        found.append(abs(ours.top_force[0]) / 1e3)
        exact.append(line.horizontal / 1e3)
        if place in (560.0, 575.0, 580.0):
            name = f"horizontal force at {place:g} m"
            answers.append(Answer(name, found[-1], exact[-1], "kN", 0.01 * exact[-1]))
            shapes[f"{place:g} m"] = shape(ours)
    series = {"cablemodel": (offsets, found), "independent": (offsets, exact)}
    return answers, picture(shapes, series, ("distance of the anchor [m]", "force [kN]"))


@job
def tow_line_sag() -> Result:
    """The elastic catenary."""
    given, ours = scene("tow_line_sag"), model("tow_line_sag")
    kind: Kind = kinds(given)["wire"]
    line = elastic_catenary(620.0, 0.0, 650.0, kind.weight, kind.stiffness)
    sag = -1.0 - line.position(325.0)[1]
    lowest = -float(ours.sample([325.0]).position[0, 2])
    answers = [
        Answer("deepest point", lowest, 2.0 + sag, "m", 0.65),
        Answer("pull along the line's way", abs(ours.top_force[0]), line.horizontal, "N", 200.0),
        Answer("tension at the tug", ours.top_tension, line.tension(650.0), "N", 200.0),
    ]
    spans, found, exact = [600.0, 620.0, 635.0, 645.0], [], []
    for span in spans:
        other = model("tow_line_sag", [f"end.anchor.0={-span}"])
        found.append(-float(other.sample([325.0]).position[0, 2]))
        exact.append(1.0 - elastic_catenary(span, 0.0, 650.0, kind.weight, kind.stiffness)
                     .position(325.0)[1])  # fmt: skip
    series = {"cablemodel": (spans, found), "independent": (spans, exact)}
    return answers, picture({"line": shape(ours)}, series, ("distance [m]", "deepest point [m]"))


@job
def lazy_wave() -> Result:
    """OrcaFlex's values at rest."""
    ours = model("lazy_wave")
    top, bend = industry.INSTALLED["80 m"]
    s = np.linspace(0.0, ours.line_length, 1500)
    found = ours.sample(s)
    answers = [
        Answer("tension at the hang-off", ours.sample(0.0).tension[0] / 1e3, top, "kN", 0.01 * top),
        Answer("largest curvature", industry.inner_curvature(ours), bend, "1/m", 0.01 * bend),
    ]
    series = {"curvature": (s, found.curvature), "independent, largest": ([0, 170], [bend, bend])}
    return answers, picture(
        {"cable": found.position}, series, ("from the hang-off [m]", "curvature [1/m]")
    )


@job
def jumper_in_waves() -> Result:
    """What Lowe and Langley published."""
    case = published.CASES[published.CASES[:, 0] == 4, 1:]
    times, other = case.T
    ours = model("jumper_in_waves")
    shapes, tops = {"at rest": shape(ours)}, []
    for t in times:  # their wave has come up at their zero, here at 20 s
        ours.step_to(20.0 + float(t))
        tops.append(ours.top_tension / 1e3)
        if len(tops) in (20, 45):
            shapes[f"at {ours.time:.1f} s"] = shape(ours)
    found = np.array(tops)
    answers = [
        Answer("highest tension", float(found.max()), float(other.max()), "kN", 0.6),
        Answer("lowest tension", float(found.min()), float(other.min()), "kN", 0.6),
        Answer("mean tension", float(found.mean()), float(other.mean()), "kN", 0.3),
    ]
    series = {"cablemodel": (times + 20.0, found), "independent": (times + 20.0, other)}
    return answers, picture(shapes, series, ("time [s]", "top tension [kN]"))


@job
def umbilical_cage() -> Result:
    """The umbilical alone, from the cage up: the tether hardly pulls."""
    given, ours = scene("umbilical_cage"), model("umbilical_cage")
    flow = np.array([0.3, 0.0, 0.0])
    items = [(14e3, 3.0), (kinds(given)["umbilical"], 1000.0)]
    tip, force, places = hanging_line(items, lambda z: flow, np.zeros(3))
    state = ours.state()
    cage = state.position[np.argmin(np.abs(state.s - 150.0))]
    pull = float(np.linalg.norm(force))
    # The tether is 150 m long in the same current: what drags at it is at most this.
    tether = 0.5 * 1025.0 * 1.2 * 0.022 * 150.0 * 0.3**2
    way = tether / 14e3 * 1000.0
    answers = [
        Answer("the cage's way downstream", cage[0], tip[0], "m", way),
        Answer("depth of the cage", -cage[2], -tip[2], "m", 1.0),
        Answer("tension at the ship", float(state.tension.max()), pull, "N", tether),
        Answer("lowest tension of the tether", float(state.tension.min()), 0.0, "N", 2 * tether),
    ]
    s = np.linspace(0.0, ours.line_length, 400)
    series = {"tension": (s, ours.sample(s).tension)}
    shapes = {"cablemodel": shape(ours, 400), "independent": places}
    return answers, picture(shapes, series, ("from the vehicle [m]", "tension [N]"))
