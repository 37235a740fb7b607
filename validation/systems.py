"""Systems of bodies and lines: closed forms of rigid bodies on strings."""

from __future__ import annotations

from typing import Any

import numpy as np

import cablemodel as cm
from tests.verification.references.bodies import free_spin
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
