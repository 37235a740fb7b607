"""Pictures, one look for all."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure

FOUND, REFERENCE = "tab:blue", "black"


def axes(count: int, width: float = 9.0, height: float = 3.2) -> tuple[Any, list[Any]]:
    """A figure with some axes beside each other."""
    figure = Figure(figsize=(width, height), layout="constrained")
    grid = np.atleast_1d(np.asarray(figure.subplots(1, count)))
    for one in grid:
        one.grid(alpha=0.3)
        one.tick_params(labelsize=8)
    return figure, list(grid)


def label(one: Any, x: str, y: str, title: str = "") -> None:
    """Names of the axes, and a legend where something is labelled."""
    one.set_xlabel(x, fontsize=9)
    one.set_ylabel(y, fontsize=9)
    one.set_title(title, fontsize=9)
    if one.get_legend_handles_labels()[0]:
        one.legend(fontsize=7)


def deviations(one: Any, rows: Any) -> None:
    """Each row's share of what is accepted, as a bar."""
    shares = [row.result / row.limit for row in rows]
    places = np.arange(len(shares))
    one.barh(places, shares, color=[FOUND if s <= 1 else "tab:red" for s in shares])
    one.axvline(1.0, color=REFERENCE, lw=1)
    one.set_xscale("log")
    one.set_yticks(places, [row.case for row in rows], fontsize=6)
    one.invert_yaxis()
    label(one, "share of what is accepted", "")
