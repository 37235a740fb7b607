"""WHOI Cable (J. Gobat, M. Grosenbaugh, GPL-3) on the examples that it is published with.

`data/whoi`: what it found. Of the mine (mine.cbl) its manual prints a table, in lb; others are what
its version 3.12 makes of horiz.cbl, Stratus2.cbl, deep_s.cbl, tow3d.cbl and breaking.cbl as they
are: arc length from the anchor or the branch, x, z [m], tension [N]. Tops of moorings are held
where it found them. Of two lists of attachments in a segment it takes the last.

Left out are decks that this version refuses (pay-out), or does not solve (lazy wave, loops); random
seas, whose phases are its own; and the mine in waves, in steps of first order.
"""

from __future__ import annotations

from collections import defaultdict
from typing import Any

import numpy as np

import cablemodel as cm
from benchmarks.sections import read_rows
from validation import draw
from validation.rows import DATA, Row, family, relative

FOLDER = DATA / "whoi"
MOORINGS = {
    # what it is; positions [m] and tension at the anchor [%] that are accepted
    "mine": ("tethered mine", 0.002, 0.1),
    "array": ("horizontal array with five strings", 0.034, 0.1),
    "tether": ("S-tether in 3,500 m", 0.36, 0.1),
    # It has 9 m between nodes where glass balls lift: with 1 m its tension there is ours.
    "stratus": ("Stratus 2 in 4,440 m", 0.55, 0.5),
}


@family("whoi", "Other programs: WHOI Cable's published examples")
def whoi() -> tuple[list[Row], Any]:
    """Moorings at rest in a current, and a tow."""
    figure, (left, middle, right) = draw.axes(3, width=12.0)
    rows = [
        row for name in MOORINGS for row in _mooring(name, middle if name == "array" else right)
    ]
    draw.label(middle, "x [m]", "z [m]", "horizontal array")
    draw.label(right, "x [m]", "z [m]", "moorings")
    return rows + _tow(left), figure


def _mooring(name: str, one: Any) -> list[Row]:
    """A mooring at rest: all places that are known of it, the tensions at both of its ends."""
    case, near, percent = MOORINGS[name]
    model = cm.SystemModel(FOLDER / f"{name}.yaml")
    known = defaultdict(list)
    for row in read_rows(FOLDER / "moorings.csv"):
        if row["case"] == name:
            known[row["line"]].append([float(row[key]) for key in ("s", "x", "z", "tension")])
    off = 0.0
    for line, theirs in known.items():
        ours, (s, x, z, tension) = model.lines[line], np.array(theirs).T
        found = ours.sample(np.minimum(s, ours.length)).position
        off = max(off, float(np.hypot(found[:, 0] - x, found[:, 2] - z).max()))
        shape = ours.sample(np.linspace(0.0, ours.length, 200)).position
        one.plot(shape[:, 0], shape[:, 2], color=draw.FOUND)
        one.plot(x, z, ".", color=draw.REFERENCE)
        if line == "main":
            anchor, top = (
                relative(ours.start_tension, tension[0]),
                relative(ours.end_tension, tension[-1]),
            )
    reference = "WHOI Cable, printed" if name == "mine" else "WHOI Cable 3.12"
    return [
        Row("whoi", case, reference, "position", off, near, "m"),
        Row("whoi", case, reference, "anchor tension", anchor, percent, "%"),
        Row("whoi", case, reference, "top tension", top, 0.1, "%"),
    ]


def _tow(one: Any) -> list[Row]:
    """A sled on 1 km of cable, let go from a catenary: straight at 6 knots, a circle, straight."""
    with (FOLDER / "tow.csv").open() as file:
        table = [line.strip().split(",") for line in file if not line.startswith("#")][1:]
    start = np.array([list(map(float, row[1:])) for row in table if row[0] == "shape"])[::-1]
    series = np.array([list(map(float, row[1:])) for row in table if row[0] == "run"])
    speed, rate = 6.0 * 0.514, 2.0 * np.pi / 600.0
    ship = [(0.0, 0.0, 0.0), (1.0, speed, 0.0), (200.0, speed, 0.0)]
    for t in np.arange(205.0, 801.0, 5.0):
        turned = rate * (t - 200.0)
        ship.append((float(t), float(speed * np.cos(turned)), float(speed * np.sin(turned))))
    cable = {
        "diameter": 0.0173,
        "mass": 1.12,
        "submerged_weight": 8.89,
        "axial_stiffness": 1.2717e7,
        "bending_stiffness": 237.88,
        "drag_normal": 1.5,
        "drag_tangential": 0.01,
        "added_mass": 0.24 / (1025.0 * np.pi / 4.0 * 0.0173**2),
    }
    sled = {
        "mass": 1135,
        "submerged_weight": 1135 * 9.81 - 4448,
        "added_mass": 0.5 * 1025.0 * np.pi / 6.0 * 0.736**3,
        "added_mass_axial": 0.5 * 1025.0 * np.pi / 6.0 * 0.736**3,
        "drag_area": np.pi / 4.0 * 0.736**2,
        "drag_coefficient": 0.77,
    }
    points = [[float(x), 0.0, float(z)] for _, x, z in start]
    scene = {
        "environment": {"gravity": 9.81},
        "cable_types": {"cable": cable},
        "line": [{"cable": {"type": "cable", "length": 1000}}, {"body": sled}],
        "initial": {"points": points, "velocities": "rest"},
        "vessel": {"velocity": [{"t": t, "velocity": [u, v, 0.0]} for t, u, v in ship]},
    }
    model, found = cm.CableModel(cm.load_scene(scene)), []
    for t, _, _ in series:
        model.step_to(float(t))
        found.append((-model.tip_position[2], model.top_tension))
    ours, late = np.array(found), series[:, 0] >= 100.0
    rows = []
    for k, name in enumerate(("depth of the sled", "tension at the ship")):
        theirs = series[:, k + 1]
        off = 100.0 * float(np.sqrt(np.mean((ours[late, k] / theirs[late] - 1.0) ** 2)))
        rows.append(
            Row("whoi", "tow3d, from 100 s", "WHOI Cable 3.12", f"{name}, rms", off, 1.5, "%")
        )
    one.plot(series[:, 0], series[:, 2], color=draw.REFERENCE, label="WHOI Cable")
    one.plot(series[:, 0], ours[:, 1], color=draw.FOUND, label="cablemodel")
    draw.label(one, "time [s]", "tension at the ship [N]", "tow3d")
    return rows


@family("parting", "Other programs: WHOI Cable's tow that parts")
def parting() -> tuple[list[Row], Any]:
    """A steady tow, whose cable parts at the ship after 100 s (breaking.cbl).

    The body sinks faster than the cable, which folds above it. The deck's 200 elements follow that,
    and WHOI Cable comes to the same with shorter ones and shorter steps.
    """
    moment, end_x, end_z = np.array(
        [[float(value) for value in row.values()] for row in read_rows(FOLDER / "breaking.csv")]
    ).T
    added = 0.5 * 1000.0 * np.pi / 6.0
    body = {
        "mass": 500,
        "submerged_weight": 500,
        "added_mass": added,
        "added_mass_axial": added,
        "drag_area": np.pi / 4.0,
        "drag_coefficient": 2.0,
    }
    cable = {
        "diameter": 0.0131,
        "mass": 0.3,
        "submerged_weight": 2.0,
        "axial_stiffness": 1.5e6,
        "bending_stiffness": 10.0,
        "drag_normal": 1.0,
        "drag_tangential": 0.005,
    }
    figure, (one,) = draw.axes(1, width=6.0)
    one.plot(moment, end_z, color=draw.REFERENCE, label="WHOI Cable")
    rows: list[Row] = []
    way = np.hypot(end_x[-1] - end_x[0], end_z[-1] - end_z[0])
    for mesh, more in (("200 elements", {"elements": 200}), ("own mesh", {})):
        items = [{"cable": {"type": "tow", "length": 1000, **more}}, {"body": body}]
        scene = {
            "environment": {"gravity": 10.0, "water_density": 1000.0},
            "cable_types": {"tow": cable},
            "vessels": {"ship": {"points": {"stern": [0, 0, 0]}, "velocity": [0.5, 0, 0]}},
            "lines": {"tow": {"from": "ship.stern", "to": "free", "items": items}},
            "cuts": {"part": {"line": "tow", "at": "start", "time": 100.0}},
        }
        model = cm.SystemModel(scene)
        line, reference = model.lines["tow"], "WHOI Cable 3.12"
        if not rows:
            place = line.sample([1000.0]).position[0, ::2]
            found = (line.start_tension, line.end_tension)
            off = float(np.hypot(*(place - (-511.4784, -859.0651))))
            rows.append(Row("parting", "0.5 m/s", reference, "position of the body", off, 0.1, "m"))
            for end, ours, theirs in zip(
                ("ship", "body"), found, (2260.4656, 537.1714), strict=True
            ):
                gap = relative(ours, theirs)
                rows.append(
                    Row("parting", "0.5 m/s", reference, f"tension at the {end}", gap, 0.1, "%")
                )
        ends = []
        for t in moment:
            model.step_to(float(t))
            ends.append(line.sample([0.0]).position[0, ::2])
        x, z = np.array(ends).T
        rms = 100.0 * float(np.sqrt(np.mean((x - end_x) ** 2 + (z - end_z) ** 2)) / way)
        case = f"parted, {mesh}"
        rows.append(Row("parting", case, reference, "way of the upper end, rms", rms, 1.5, "%"))
        one.plot(moment, z, "-" if more else "--", color=draw.FOUND, label=f"cablemodel, {mesh}")
    draw.label(one, "time [s]", "z of the upper end [m]")
    return rows, figure
