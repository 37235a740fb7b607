"""A picture of what accuracy costs: error against processor time, a point for each tolerance."""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING

from cablemodel.errors import CableModelError
from cablemodel.views.plot import STYLE, import_matplotlib

if TYPE_CHECKING:
    from cablemodel.accuracy.verdict import Convergence

_FEW_DECADES = 50.0
"""Ratio of times below which numbers stand at 1, 2 and 5, not at powers of ten alone."""


def save_convergence_figure(found: Convergence, path: str | PathLike[str]) -> None:
    """Draw the largest error of the position against the processor time of a simulated second.

    Args:
        found: what `convergence` gave.
        path: file to write: .png, .pdf or .svg.

    Raises:
        CableModelError: matplotlib is not installed, or there is nothing to draw.
        OSError: the file cannot be written.
    """
    import_matplotlib()
    import matplotlib
    from matplotlib.figure import Figure
    from matplotlib.ticker import LogLocator, NullFormatter

    points = [
        (row, row.position)
        for row in found.rows
        if row.position is not None and row.position.largest > 0.0
    ]
    if not points:
        raise CableModelError("no run differs from the reference: there is nothing to draw")
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(5.6, 3.8), layout="constrained")
        axes = figure.add_subplot()
        axes.set_xscale("log")
        axes.set_yscale("log")
        times = [1e3 * row.processor_time for row, _ in points]
        axes.plot(times, [position.largest for _, position in points], "-", color="0.75")
        for row, position in points:
            own = row.tolerance == found.tolerance
            place = (1e3 * row.processor_time, position.largest)
            axes.plot(*place, "o", markersize=6 if own else 4, color="#2a6f97" if own else "0.35",
                      label="the scene's tolerance" if own else None)  # fmt: skip
            axes.annotate(f"{row.tolerance:g}", place, xytext=(6, 5), textcoords="offset points",
                          fontsize=8)  # fmt: skip
        allowed = found.tolerance * points[0][1].scale
        axes.axhline(allowed, color="#d1495b", linewidth=0.8, linestyle="--", zorder=1.5,
                     label=f"allowed at {found.tolerance:g}")  # fmt: skip
        axes.set_xlabel("processor time of a simulated second [ms]")
        axes.set_ylabel("largest error of the position [m]")
        axes.margins(0.18, 0.15)
        if max(times) < _FEW_DECADES * min(times):
            axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
            axes.xaxis.set_minor_formatter(NullFormatter())
        axes.xaxis.set_major_formatter("{x:g}")
        axes.legend()
        try:
            figure.savefig(path, dpi=200)
        except ValueError as error:
            raise CableModelError(f"cannot write {path}: {error}") from error
