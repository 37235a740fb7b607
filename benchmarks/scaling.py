"""How work and memory grow: with elements, length of cable, steps, instances, lines of a system.

Every series is the tow S1 (elastica, tau = 1e-3), one thing varied; a buoy's legs are of its cable.
``python -m benchmarks --parts scaling`` measures and draws them.
"""

from __future__ import annotations

import copy
import math
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.contestants import cablemodel_scene
from benchmarks.scenes import SCENES

SIMULATED = 10.0
"""Seconds of scene S1 that are simulated."""


@dataclass(frozen=True)
class ScalingPoint:
    """One run of a series.

    size: what is varied. elements; cost: CPU seconds of stepping; build: of making the model and
    its static start [s]; steps; memory: of the instance's block [bytes].
    """

    series: str
    size: float
    elements: float
    cost: float
    build: float
    steps: float
    memory: float


@dataclass(frozen=True)
class Series:
    """What is varied, over which sizes, how a point is measured; between which sizes the
    exponent is taken."""

    name: str
    varied: str
    sizes: tuple[float, ...]
    measure: Callable[[float], ScalingPoint]
    from_size: float
    to_size: float = float("inf")


def _model(length: float, elements: int | None) -> tuple[Any, float]:
    """A model of S1 with another length, and the CPU time of making it [s].

    EA grows with the length: the strain under the line's own weight stays that of S1.
    """
    import cablemodel as cm

    scene = copy.deepcopy(cablemodel_scene(SCENES["S1"], 1e-3, "elastica", elements))
    own = scene["line"][0]["cable"]["length"]
    scene["line"][0]["cable"]["length"] = length
    scene["cable_types"]["K"]["axial_stiffness"] *= length / own
    began = time.process_time()
    model = cm.CableModel(cm.load_scene(scene))
    return model, time.process_time() - began


def _point(name: str, size: float, length: float, elements: int | None) -> ScalingPoint:
    """The first ten seconds in one call; the least of three runs."""
    model, build = _model(length, elements)
    start, costs = model.snapshot(), []
    for _ in range(3):
        model.restore(start)
        before = dict(model.statistics)
        began = time.process_time()
        model.step_to(SIMULATED)
        costs.append(time.process_time() - began)
    counts = model.statistics
    return ScalingPoint(
        name,
        size,
        counts["elements"],
        min(costs),
        build,
        counts["steps"] - before["steps"],
        model._solver.memory.ints.nbytes,
    )


def _short_elements(size: float) -> ScalingPoint:
    return _point("elements of a 30 m line", size, 30.0, int(size))


def _long_line(size: float) -> ScalingPoint:
    return _point("elements of 1 m", size, size, int(size))


def _own_mesh(size: float) -> ScalingPoint:
    return _point("length, mesh from the tolerance", size, size, None)


def _steps(size: float) -> ScalingPoint:
    """That many steps of 10 ms."""
    model, build = _model(30.0, None)
    began = time.process_time()
    for k in range(1, int(size) + 1):
        model.step_to(0.01 * k)
    cost = time.process_time() - began
    memory = model._solver.memory.ints.nbytes
    elements = model.statistics["elements"]
    return ScalingPoint("steps of 10 ms", size, elements, cost, build, size, memory)


def _instances(size: float) -> ScalingPoint:
    """That many models in one process, stepped in turn, 200 steps of 10 ms each."""
    import cablemodel as cm

    first, build = _model(30.0, None)
    models = [first, *(cm.CableModel(first.scene) for _ in range(int(size) - 1))]
    began = time.process_time()
    for k in range(1, 201):
        for model in models:
            model.step_to(0.01 * k)
    cost = time.process_time() - began
    memory = sum(model._solver.memory.ints.nbytes for model in models)
    elements = first.statistics["elements"]
    return ScalingPoint("instances", size, elements, cost, build, 200.0 * size, memory)


def _system(name: str, size: float, parts: dict[str, Any]) -> ScalingPoint:
    """The first ten seconds of a system in one call; the least of three runs."""
    import cablemodel as cm

    scene = cablemodel_scene(SCENES["S1"], 1e-3, "elastica")
    shared = {key: scene[key] for key in ("environment", "cable_types", "solver") if key in scene}
    lines = {name: {**ends, "items": scene["line"]} for name, ends in parts.pop("lines").items()}
    began = time.process_time()
    model = cm.SystemModel({**shared, **parts, "lines": lines})
    build = time.process_time() - began
    start, costs = model.snapshot(), []
    for _ in range(3):
        model.restore(start)
        before, began = model.statistics["steps"], time.process_time()
        model.step(SIMULATED)
        costs.append(time.process_time() - began)
    counts, memory = model.statistics, model.built.block.ints.nbytes
    steps = counts["steps"] - before
    return ScalingPoint(name, size, counts["elements"], min(costs), build, steps, memory)


def _lines_of_a_vessel(size: float) -> ScalingPoint:
    """That many lines, towed beside each other by one vessel."""
    vessel = {
        "points": {f"p{k}": [0.0, 5.0 * k, 0.0] for k in range(int(size))},
        "velocity": cablemodel_scene(SCENES["S1"], 1e-3)["vessel"]["velocity"],
    }
    lines = {f"line{k}": {"from": f"ship.p{k}", "to": "free"} for k in range(int(size))}
    return _system("lines of a vessel", size, {"vessels": {"ship": vessel}, "lines": lines})


def _legs_of_a_buoy(size: float) -> ScalingPoint:
    """A buoy that as many legs hold, each with 500 N, as a current comes up to S1's speed."""
    count = int(size)
    turns = [2.0 * math.pi * k / count for k in range(count)]
    buoy = {
        "position": [0.0, 0.0, -5.0],
        "mass": 100.0 * count,
        "submerged_weight": -500.0 * count,
        "inertia": [30.0 * count] * 3,
        "drag_area": [0.1 * count] * 3,
        "points": {f"p{k}": [math.cos(a), math.sin(a), 0.0] for k, a in enumerate(turns)},
    }
    legs = {
        f"leg{k}": {
            "from": {"anchor": [20.0 * math.cos(a), 20.0 * math.sin(a), -26.0]},
            "to": f"buoy.p{k}",
        }
        for k, a in enumerate(turns)
    }
    rise = [
        {"t": 0.0, "z": 0.0, "velocity": [0.0] * 3},
        {"t": 30.0, "z": 0.0, "velocity": [0.8, 0.0, 0.0]},
    ]
    parts = {"environment": {"current": {"table": rise}}, "bodies": {"buoy": buoy}, "lines": legs}
    return _system("legs of a buoy", size, parts)


SERIES = (
    Series(
        "elements of a 30 m line",
        "elements",
        (10, 30, 100, 300, 1000, 3000, 10_000, 30_000),
        _short_elements,
        100,
        3000,  # beyond, round-off of positions over an element reaches Newton's tolerance
    ),
    Series("elements of 1 m", "elements", (10, 100, 1000, 10_000, 100_000), _long_line, 100),
    Series(
        "length, mesh from the tolerance",
        "length [m]",
        (30, 100, 300, 1000, 3000, 10_000, 30_000, 100_000),
        _own_mesh,
        30,
    ),
    Series("steps of 10 ms", "steps", (100, 1000, 10_000, 100_000), _steps, 1000),
    Series("instances", "instances", (1, 10, 100, 1000), _instances, 1),
    Series("lines of a vessel", "lines", (1, 3, 10, 30, 100, 300, 1000), _lines_of_a_vessel, 10),
    Series("legs of a buoy", "legs", (3, 10, 30, 100, 300, 1000), _legs_of_a_buoy, 10),
)


def measure_scaling(
    report: Callable[[ScalingPoint], None] = lambda _point: None, quick: bool = False
) -> list[ScalingPoint]:
    """Every series, or the smaller sizes of each."""
    points = []
    for series in SERIES:
        for size in series.sizes[: 3 if quick else None]:
            points.append(series.measure(size))
            report(points[-1])
    return points


def exponent(sizes: Sequence[float], values: Sequence[float]) -> float:
    """Slope of values against sizes in log-log (least squares)."""
    return float(np.polyfit(np.log(sizes), np.log(values), 1)[0])


def scaling_figure(points: Sequence[ScalingPoint], path: Path) -> None:
    """Cost against size, a panel for each series, with a line of slope one."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    canvas, axes = pyplot.subplots(2, 4, figsize=(13.0, 6.4), layout="constrained")
    for panel in axes.flat[len(SERIES) :]:
        panel.set_axis_off()
    for panel, series in zip(axes.flat, SERIES, strict=False):
        mine = [p for p in points if p.series == series.name]
        if not mine:
            continue
        sizes = np.array([p.size for p in mine])
        costs = np.array([p.cost for p in mine])
        panel.loglog(sizes, costs, "o-", markersize=4, label="measured")
        if series.varied != "length [m]":
            panel.loglog(sizes, costs[-1] * sizes / sizes[-1], "k:", label="linear")
        panel.set_title(series.name, fontsize=9)
        panel.set_xlabel(series.varied)
        panel.grid(True, which="major", linewidth=0.4)
        panel.legend(fontsize=8)
    for first in axes[:, 0]:
        first.set_ylabel("CPU seconds of stepping")
    path.parent.mkdir(parents=True, exist_ok=True)
    canvas.savefig(path, dpi=110)
    pyplot.close(canvas)
