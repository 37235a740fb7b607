"""A picture of a sweep: one result against one of the values swept over."""

from __future__ import annotations

from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from cablemodel.analysis.sweep import RESULTS, result_label, swept_columns
from cablemodel.errors import CableModelError
from cablemodel.scene import unit_at
from cablemodel.systems import SystemScene
from cablemodel.views.plot import STYLE, import_matplotlib

if TYPE_CHECKING:
    import pandas

_MOST_NAMED = 12
"""Curves that get a name in the key; more are told by a colour bar or not at all."""


def save_sweep_figure(
    table: pandas.DataFrame, path: str | PathLike[str], *, result: str, against: str | None = None
) -> None:
    """Draw a result of a sweep against one value, a curve for each combination of the others.

    Args:
        table: what `sweep` gave.
        path: file to write: .png, .pdf or .svg.
        result: a column of `RESULTS`, or of the results of a system.
        against: the column of a value swept over; by default the first.

    Raises:
        CableModelError: matplotlib is not installed, no such column, or nothing to draw.
        OSError: the file cannot be written.
    """
    import_matplotlib()
    import matplotlib
    from matplotlib.figure import Figure

    swept = swept_columns(table)
    results = [str(name) for name in table.columns if name not in (*swept, "error")]
    against = swept[0] if against is None else against
    for name, allowed in ((result, [*dict.fromkeys([*results, *RESULTS])]), (against, swept)):
        if name not in allowed:
            raise CableModelError(f"a sweep has no column {name}; it has {', '.join(allowed)}")
    good = table[table["error"] == ""]
    if good.empty:
        raise CableModelError("no run of the sweep came to its end: there is nothing to draw")
    if result not in good or good[result].isna().all():
        raise CableModelError(f"no run of the sweep has a value of {result}: nothing to draw")
    others = [name for name in swept if name != against]
    curves = list(good.groupby(others, sort=False)) if others else [((), good)]
    with matplotlib.rc_context(STYLE):
        figure = Figure(figsize=(5.6, 3.8), layout="constrained")
        axes = figure.add_subplot()
        colours = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.88, len(curves)))
        named = [with_unit(table, name) for name in others]
        for (values, rows), colour in zip(curves, colours, strict=True):
            axes.plot(rows[against], rows[result], "o-", color=colour, markersize=3.5,
                      label=_named(named, values))  # fmt: skip
        for place in table.loc[table["error"] != "", against].unique():
            # A gap in a curve could be anything; a failed run is marked.
            axes.axvline(place, color="#d1495b", linewidth=0.8, linestyle=":", zorder=0.5)
        axes.set_xlabel(with_unit(table, against))
        axes.set_ylabel(result_label(result))
        if others and len(curves) <= _MOST_NAMED:
            axes.legend(fontsize=7)
        if len(good) < len(table):
            title = f"dotted: {len(table) - len(good)} of {len(table)} runs failed"
            axes.set_title(title, loc="right", color="0.4", fontsize=8)
        try:
            figure.savefig(path, dpi=200)
        except ValueError as error:
            raise CableModelError(f"cannot write {path}: {error}") from error


def with_unit(table: pandas.DataFrame, column: str) -> str:
    """A column swept over, with the unit of its numbers: what the sweep was given, else SI."""
    if " [" in column or not is_numeric(table[column]):
        return column
    unit = unit_at(column) or unit_at(column, SystemScene)
    return f"{column} [{unit}]" if unit else column


def is_numeric(values: pandas.Series) -> bool:
    from pandas.api.types import is_bool_dtype, is_numeric_dtype

    return bool(is_numeric_dtype(values) and not is_bool_dtype(values))


def _named(names: list[str], values: Any) -> str:
    """A curve's name in the key: the last part of each path, and its value."""
    words = []
    for name, value in zip(names, values, strict=True):
        path, _, unit = name.partition(" [")
        text = f"{value:g}" if isinstance(value, float) else str(value)
        *above, last = path.split(".")
        last = f"{above[-1]}.{last}" if above and last.isdecimal() else last
        words.append(" ".join([last, text, unit.removesuffix("]")]).strip())
    return ", ".join(words)
