"""Work-precision diagrams: error against cost, both logarithmic, one figure per scene."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

from benchmarks.compare import by_tolerance, front
from benchmarks.measure import Measurement
from benchmarks.scenes import BenchmarkScene


def work_precision_figure(
    scene: BenchmarkScene, measurements: Sequence[Measurement], path: Path
) -> None:
    """Draw tip error and tension error against cost for every contestant; write a PNG."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    curves: dict[str, list[Measurement]] = defaultdict(list)
    for measurement in measurements:
        if measurement.failure is None:
            curves[measurement.contestant].append(measurement)
    figure, (tip_axes, tension_axes) = pyplot.subplots(
        1, 2, figsize=(11.0, 4.5), sharex=True, layout="constrained"
    )
    for name, points in curves.items():
        best = front(points)
        # Of a peer whose settings were searched, the best at each error.
        searched = [m for m in points if (m.tip_error, m.cost) in best]
        shown = points if len(points) < 10 or by_tolerance(points[0]) else searched
        ordered = sorted(shown, key=lambda m: m.cost)
        costs = [m.cost for m in ordered]
        style = "o-" if name.startswith("cablemodel") else "s--"
        style = "^:" if name.startswith("direct") else style
        tip_axes.loglog(costs, [m.tip_error for m in ordered], style, label=name, markersize=4)
        with_tension = [m for m in ordered if m.tension_error is not None]
        tension_axes.loglog(
            [m.cost for m in with_tension],
            [m.tension_error for m in with_tension],
            style,
            label=name,
            markersize=4,
        )
    target = scene.target
    if target is not None and math.isfinite(target.tip_error):
        tip_axes.plot([target.cost], [target.tip_error], "k*", markersize=11, label="asked")
    if target is not None and target.tension_error is not None:
        tension_axes.plot([target.cost], [target.tension_error], "k*", markersize=11)
    tip_axes.set_ylabel("largest error of the position / L")
    tension_axes.set_ylabel("largest error of top tension / largest tension")
    for axes in (tip_axes, tension_axes):
        axes.set_xlabel("CPU seconds per simulated second")
        axes.grid(True, which="major", linewidth=0.4)
    tip_axes.legend(fontsize="small")
    figure.suptitle(scene.title)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=110)
    pyplot.close(figure)
