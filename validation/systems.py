"""Systems of bodies and lines: closed forms of rigid bodies on strings, lines that meet."""

from __future__ import annotations

from typing import Any

import numpy as np

import cablemodel as cm
from tests.verification.references.bodies import free_spin
from tests.verification.references.junction import Leg, meeting, two_masses
from validation import draw
from validation.rows import Row, family, relative

G = 9.81
STRING = {"diameter": 0.002, "mass": 0.002, "axial_stiffness": 2e6, "submerged_weight": 0.002 * G}


def hung(body: dict[str, Any], anchors: dict[str, list[float]], length: float) -> cm.SystemModel:
    """A body on strings in a vacuum, from anchors to its points of the same names."""
    items = [{"cable": {"type": "string", "length": length, "model": "cable"}}]
    lines = {
        name: {"from": {"anchor": place}, "to": f"body.{name}", "items": items}
        for name, place in anchors.items()
    }
    scene = {
        "environment": {"water_density": 0.0, "gravity": G},
        "cable_types": {"string": STRING},
        "bodies": {"body": body},
        "lines": lines,
        "solver": {"tolerance": 1e-5},
    }
    return cm.SystemModel(scene)


@family("bodies", "Closed forms: bodies on strings")
def bodies() -> tuple[list[Row], Any]:
    """Bifilar pendulum, three strings, Euler's equations."""
    rows, (figure, (left, right)) = [], draw.axes(2)
    # A bar on two strings turns with 2 pi sqrt(I h / (m g a b)), small angles.
    points = {"one": [0.6, 0, 0], "two": [-0.6, 0, 0]}
    bar = {"mass": 20.0, "submerged_weight": 20.0 * G, "inertia": [0.5, 3.0, 3.0], "points": points}
    model = hung(bar, points, 5.0)
    model.step(0.5, forces={"body": [0, 0, 0, 0, 0, 0.5]})
    model.step(0.5)
    times, yaw = [], []
    for _ in range(400):
        model.step(0.025)
        times.append(model.time)
        yaw.append(model.bodies["body"].attitude[2])
    t, a = np.array(times), np.array(yaw)
    k = np.flatnonzero(np.diff(np.sign(a)) != 0)
    crossings = t[k] - a[k] * (t[k + 1] - t[k]) / (a[k + 1] - a[k])
    expected = 2.0 * np.pi * np.sqrt(3.0 * 5.0 / (20.0 * G * 0.36))
    off = relative(2.0 * np.diff(crossings).mean(), expected)
    rows.append(Row("bodies", "bifilar pendulum", "small angles", "period", off, 0.2, "%"))
    left.plot(t, a, color=draw.FOUND)
    for n in range(len(crossings)):
        left.plot(crossings[0] + 0.5 * n * expected, 0.0, "x", color=draw.REFERENCE)
    draw.label(left, "time [s]", "yaw [rad]", "crosses: half periods in closed form")
    # An off-centre weight on three vertical strings.
    places = {"a": [1.0, 0.0, 0.0], "b": [-0.5, 0.8, 0.0], "c": [-0.5, -0.8, 0.0]}
    centre = [0.1, 0.15, 0.0]
    plate = {"mass": 50.0, "submerged_weight": 50.0 * G, "inertia": [5.0, 5.0, 9.0],
             "centre_of_gravity": centre, "points": places}  # fmt: skip
    model = hung(plate, places, 4.0)
    arms = np.array(list(places.values()))
    balance = np.vstack([np.ones(3), arms[:, 0], arms[:, 1]])
    loads = np.linalg.solve(balance, 50.0 * G * np.array([1.0, *centre[:2]]))
    for name, load in zip(places, loads, strict=True):
        off = relative(model.lines[name].end_tension, load)
        rows.append(
            Row("bodies", f"plate, string {name}", "balance of moments", "tension", off, 0.01, "%")
        )
    # Hung by its centre of gravity a body turns as Euler's equations say.
    inertia = np.array([1.0, 2.0, 2.5])
    free = {"mass": 10.0, "submerged_weight": 98.1, "inertia": inertia.tolist(),
            "points": {"c": [0, 0, 0]}}  # fmt: skip
    model = hung(free, {"c": [0, 0, 0]}, 3.0)
    model.step(1.0, forces={"body": [0, 0, 0, 0.3, 3.0, 0.6]})
    model.step(1.0)

    def spin() -> Any:
        state = model.bodies["body"]
        return state.axes.T @ state.angular_velocity

    begun, first = model.time, spin()
    exact = free_spin(inertia, first, 30.0)
    times, found = [], []
    for _ in range(60):
        model.step(0.5)
        times.append(model.time - begun)
        found.append(spin())
    t, w = np.array(times), np.array(found)
    off = 100.0 * float(np.abs(w - exact(t).T).max() / np.linalg.norm(first))
    rows.append(Row("bodies", "free body", "Euler's equations", "spin", off, 0.2, "%"))
    for axis in range(3):
        right.plot(t, exact(t)[axis], color=draw.REFERENCE, lw=1)
        right.plot(t, w[:, axis], "o", ms=3)
    draw.label(right, "time [s]", "spin about its axes [rad/s]", "lines: Euler's equations")
    return rows, figure


JUNCTION_TAU = 1e-5


def t_junction() -> tuple[cm.SystemModel, list[Leg]]:
    """A line between two anchors, a branch at 200 m to a third one, and the same as three legs."""
    kinds = {"main": (300.0, 5e6), "branch": (120.0, 2e6)}
    ends = {"west": (0.0, 0.0, 0.0), "east": (380.0, 20.0, -25.0), "deep": (190.0, 140.0, -130.0)}
    pieces = (("west", "main", 200.0), ("east", "main", 230.0), ("deep", "branch", 150.0))
    items = [{"cable": {"type": "main", "length": 430.0}}]
    model = cm.SystemModel({
        "environment": {"water_density": 0.0, "gravity": G},
        "cable_types": {
            name: {"diameter": 0.02, "mass": weight / G, "submerged_weight": weight,
                   "axial_stiffness": stiffness}
            for name, (weight, stiffness) in kinds.items()
        },
        "lines": {
            "main": {"from": {"anchor": list(ends["west"])}, "to": {"anchor": list(ends["east"])},
                     "items": items},
            "branch": {"from": {"line": "main", "at": 200.0}, "to": {"anchor": list(ends["deep"])},
                       "items": [{"cable": {"type": "branch", "length": 150.0}}]},
        },
        "solver": {"tolerance": JUNCTION_TAU},
    })  # fmt: skip
    return model, [Leg(ends[end], length, *kinds[kind]) for end, kind, length in pieces]


HALF, APART, BELOW, HUNG, CARRIED = 5.0, 8.0, 3.0, 20.0, 15.0
"""Strings of a swing: half of the upper one, its ends' distance, the lower one [m]; masses at its
end and at the junction [kg]."""


def swing(carried: float, pulse: tuple[float, float, float]) -> cm.SystemModel:
    """A weight on a branch at the middle of a string, whose beam is jerked aside within a second.

    carried: mass at the junction [kg], 0: none. pulse: highest velocity of the beam [m/s].
    """
    half = {"cable": {"type": "string", "length": HALF, "model": "cable"}}
    node = [{"body": {"mass": carried, "submerged_weight": carried * G}}] if carried else []
    rows = [(0.0, 0.0), (0.5, 1.0), (1.0, 0.0)]
    return cm.SystemModel({
        "environment": {"water_density": 0.0, "gravity": G},
        "cable_types": {"string": STRING},
        "vessels": {"beam": {
            "points": {"one": [0.5 * APART, 0, 0], "two": [-0.5 * APART, 0, 0]},
            "velocity": [{"t": t, "velocity": [share * v for v in pulse]} for t, share in rows],
        }},
        "lines": {
            "upper": {"from": "beam.one", "to": "beam.two", "items": [half, *node, half]},
            "branch": {"from": {"line": "upper", "at": HALF}, "to": "free", "items": [
                {"cable": {"type": "string", "length": BELOW, "model": "cable"}},
                {"body": {"mass": HUNG, "submerged_weight": HUNG * G}},
            ]},
        },
        "solver": {"tolerance": JUNCTION_TAU},
    })  # fmt: skip


@family("junction", "A T-junction: three catenaries, and what swings from one")
def junction() -> tuple[list[Row], Any]:
    """Statics by the balance of three catenaries, small motions by two lumped masses."""
    rows, (figure, (left, right)) = [], draw.axes(2)
    model, legs = t_junction()
    place, forces = meeting(legs, [190.0, 40.0, -60.0])
    case, source = "a branch of 150 m on 430 m", "three catenaries, scipy"
    longest = model.scene.line_length
    found = model.lines["branch"].sample([0.0]).position[0]
    off = float(np.linalg.norm(found - place))
    rows.append(Row("junction", case, source, "junction", off, JUNCTION_TAU * longest, "m"))
    main, branch = model.lines["main"], model.lines["branch"]
    west, east, deep = (
        leg.reach(force, np.linspace(0.0, leg.length, 41)) + place
        for leg, force in zip(legs, forces, strict=True)
    )
    apart = [
        main.sample(np.linspace(200.0, 0.0, 41)).position - west,
        main.sample(np.linspace(200.0, 430.0, 41)).position - east,
        branch.sample(np.linspace(0.0, 150.0, 41)).position - deep,
    ]
    off = float(np.linalg.norm(apart, axis=2).max())
    rows.append(Row("junction", case, source, "position", off, JUNCTION_TAU * longest, "m"))
    pulls = [
        relative(main.start_tension, legs[0].end_tension(forces[0])),
        relative(main.end_tension, legs[1].end_tension(forces[1])),
        relative(branch.end_tension, legs[2].end_tension(forces[2])),
        relative(branch.start_tension, float(np.linalg.norm(forces[2]))),
    ]
    rows.append(Row("junction", case, source, "tensions", max(pulls), 1e3 * JUNCTION_TAU, "%"))
    for shape, line in ((west, main), (east, main), (deep, branch)):
        left.plot(shape[:, 0], shape[:, 2], color=draw.REFERENCE, lw=1)
        state = line.sample(np.linspace(0.0, line.length, 15))
        left.plot(state.position[:, 0], state.position[:, 2], "o", ms=3, color=draw.FOUND)
    draw.label(left, "x [m]", "z [m]", "lines: three catenaries")
    # Both halves of the upper string have their length: its middle turns about its ends, and stays
    # where it is as the weight swings along them.
    sag = float(np.sqrt(HALF**2 - 0.25 * APART**2))
    radii = {"across": (1, sag), "along": (0, 0.0)}
    for way, (axis, radius) in radii.items():
        pulse = np.zeros(3)
        pulse[axis] = 0.04
        model = swing(0.0, (pulse[0], pulse[1], 0.0))
        model.step(2.0)
        times, places = [], []
        for _ in range(800):
            model.step(0.025)
            times.append(model.time)
            bob = model.lines["branch"].sample([BELOW]).position[0]
            places.append(bob[axis] - model.vessels["beam"].position[axis])
        t, x = np.array(times), np.array(places)
        k = np.flatnonzero(np.diff(np.sign(x)) != 0)
        crossings = t[k] - x[k] * (t[k + 1] - t[k]) / (x[k + 1] - x[k])
        expected = 2.0 * np.pi * np.sqrt((radius + BELOW) / G)
        off = relative(2.0 * np.diff(crossings).mean(), expected)
        rows.append(Row("junction", f"weight, {way}", "small angles", "period", off, 0.2, "%"))
        right.plot(t, x, label=way)
        marks = crossings[0] + 0.5 * expected * np.arange(len(crossings))
        right.plot(marks, np.zeros(len(marks)), "x", color=draw.REFERENCE)
    draw.label(right, "time [s]", "weight, from the beam [m]", "crosses: half periods")
    model = swing(CARRIED, (0.0, 0.0, 0.0))
    lumped = np.sort([*two_masses(sag, BELOW, CARRIED, HUNG, G), np.sqrt(G / BELOW)])
    apart_by = map(relative, model.natural_frequencies(3), lumped)
    case, source = "masses at and below it", "two lumped masses"
    rows.append(Row("junction", case, source, "three frequencies", max(apart_by), 0.2, "%"))
    return rows, figure
