"""The flat charts of the page, as plotly figures (plain dictionaries)."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cablemodel.results.columns import input_fields
from cablemodel.results.run import Run, SystemRun
from cablemodel.views.drawing import (
    COLOURS,
    slack_spans,
    start_of,
    start_tensions,
    tension_errors,
    touchdowns,
)
from cablemodel.views.report.samples import Along, Field, thinned

Floats = NDArray[np.float64]
Figure = dict[str, Any]

INK = "#1f2a37"
GRID = "#e6eaee"
DASHES = ("solid", "dash", "dot", "dashdot")
"""Of curves that have the same colour."""
TENSION_SCALE = [
    [0.0, "#0d0887"], [0.125, "#41049d"], [0.25, "#6a00a8"], [0.375, "#8f0da4"],
    [0.5, "#b12a90"], [0.625, "#cc4778"], [0.75, "#e16462"], [0.875, "#f2844b"], [1.0, "#fca636"],
]  # fmt: skip
"""Plasma without its palest part, which is hard to see on white."""
NOW = "now"
"""Name of the traces that the page moves with time."""

SLACK_COLOUR = "rgba(230,120,40,0.22)"
"""Of the times between two outputs in which some of a line was slack."""

_SATURATED = 0.995
_PEAKED = 2.0
"""Colours end at this quantile where the largest value is more than so many times it."""
_ZERO = 1e-9
_NOTABLE = 0.02
"""The highest tension is drawn where it is above the top tension by this part of the largest."""


def base_layout() -> dict[str, Any]:
    """What all figures share."""
    return {
        "font": {"family": "system-ui, -apple-system, 'Segoe UI', Roboto, sans-serif",
                 "size": 12, "color": INK},
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
        "showlegend": False,
        "hoverlabel": {"font": {"size": 12}},
        "colorway": list(COLOURS),
        "modebar": {"bgcolor": "rgba(255,255,255,0.7)", "color": "#9aa5b1", "activecolor": INK},
    }  # fmt: skip


def axis_style() -> dict[str, Any]:
    return {
        "gridcolor": GRID, "zerolinecolor": "#cfd6dd", "linecolor": "#9aa5b1",
        "tickfont": {"size": 11},
    }  # fmt: skip


def _over_time(time: Floats, hours: str, y: str, **more: Any) -> dict[str, Any]:
    """Layout of a chart over time: all of them span the run, so that they can be zoomed as one."""
    layout = _layout(f"time [{hours}]", y, **more)
    if time[-1] > time[0]:
        layout["xaxis"]["range"] = [float(time[0]), float(time[-1])]
    return layout


def _layout(x: str, y: str, **more: Any) -> dict[str, Any]:
    return {
        **base_layout(),
        "margin": {"l": 58, "r": 14, "t": 10, "b": 40},
        "xaxis": {**axis_style(), "title": _title(x), "showline": True, "ticks": "outside"},
        "yaxis": {**axis_style(), "title": _title(y), "showline": True, "automargin": True},
        "hovermode": "x unified",
        **more,
    }


def _title(text: str) -> dict[str, Any]:
    return {"text": text, "font": {"size": 12}, "standoff": 6}


def _legend() -> dict[str, Any]:
    return {
        "showlegend": True,
        "legend": {"orientation": "h", "x": 0, "y": 1.0, "yanchor": "bottom",
                   "font": {"size": 11}, "bgcolor": "rgba(0,0,0,0)"},
        "margin": {"l": 58, "r": 14, "t": 34, "b": 40},
    }  # fmt: skip


def _curve(time: Floats, values: Floats, name: str, **line: Any) -> dict[str, Any]:
    kept = thinned(values)
    there = np.isfinite(values)
    alone = there & ~np.append(there[1:], False) & ~np.insert(there[:-1], 0, False)
    return {
        "type": "scatter", "name": name, "x": time[kept], "y": values[kept],
        # A value between two gaps is no line.
        "mode": "lines+markers" if np.any(alone) else "lines",
        "line": {"width": 1.6, **line},
        "hovertemplate": "%{y:.5g}",
    }  # fmt: skip


def start_tension(run: Run, seconds: float, hours: str, newtons: float, unit: str) -> Figure:
    """Tension at the beginnings of all lines over time, with the extremes where they differ."""
    time, top = run.time / seconds, run.top_tension / newtons
    highest, lowest = run.tension_max / newtons, run.tension_min / newtons
    where = "along the cable" if "" in run.shapes else "along all lines"
    traces = []
    if np.max(highest - top) > _NOTABLE * np.max(np.abs(highest)):
        traces.append(_curve(time, highest, f"highest {where}", color=COLOURS[1], width=1))
    starts = start_tensions(run)
    for k, (name, errors) in enumerate(tension_errors(run).items()):
        traces += _band(time, starts[name] / newtons, errors / newtons, named=k == 0)
    for k, (name, tension) in enumerate(starts.items()):
        words = name or start_of(name)
        traces.append(_curve(time, tension / newtons, words, **_style(k), width=2))
    traces.append(_curve(time, lowest, f"lowest {where}", color="#8a97a5", width=1))
    shades = [
        {"type": "rect", "x0": begin / seconds, "x1": end / seconds, "yref": "paper", "y0": 0,
         "y1": 1, "fillcolor": SLACK_COLOUR, "line": {"width": 0}, "layer": "below"}
        for begin, end in slack_spans(run)
    ]  # fmt: skip
    if shades:  # the key tells of them
        traces.append(
            {"type": "scatter", "mode": "markers", "x": [None], "y": [None], "name": "slack",
             "marker": {"symbol": "square", "size": 11, "color": SLACK_COLOUR}}
        )  # fmt: skip
    layout = _over_time(time, hours, f"tension [{unit}]", shapes=shades, **_legend())
    return {"data": traces, "layout": layout}


def _band(time: Floats, values: Floats, errors: Floats, *, named: bool) -> list[dict[str, Any]]:
    """Values more and less their estimated errors, as a shade; none where these are not known.

    named: whether the key tells of it.
    """
    errors = np.where(np.isnan(errors), 0.0, errors)
    # No peak of either edge is lost, nor of the curve between them.
    kept = np.unique(np.concatenate([thinned(values - errors), thinned(values + errors)]))
    time, values, errors = time[kept], values[kept], errors[kept]
    edge = {"type": "scatter", "mode": "lines", "x": time, "line": {"width": 0},
            "hoverinfo": "skip"}  # fmt: skip
    return [
        {**edge, "y": values - errors, "showlegend": False},
        {**edge, "y": values + errors, "name": "estimated error", "fill": "tonexty",
         "fillcolor": "rgba(31,95,168,0.25)", "showlegend": named},
    ]  # fmt: skip


def profile(along: Along, field: Field, arc: str, label: str, colour: str, scale: float) -> Figure:
    """A quantity along a line: its range over the run, and a curve for the page to move."""
    lower, upper = field.lower / scale, field.upper / scale
    edge = {"type": "scatter", "mode": "lines", "x": along.s, "hovertemplate": "%{y:.4g}"}
    shade = {"width": 0.8, "color": "#b9c3cd"}
    there = along.s < along.ends[0]
    traces = [
        {**edge, "y": lower, "name": "lowest of the run", "line": shade},
        {**edge, "y": upper, "name": "highest of the run", "line": shade,
         "fill": "tonexty", "fillcolor": "rgba(154,165,177,0.22)"},
        {**edge, "x": [*along.s[there], along.ends[0]],
         "y": [*field.values[0, there] / scale, field.ends[0] / scale], "name": NOW,
         "line": {"width": 2.2, "color": colour}},
    ]  # fmt: skip
    return {"data": traces, "layout": _layout(arc, label)}


def heat_map(
    along: Along,
    field: Field,
    arc: str,
    label: str,
    seconds: float,
    hours: str,
    scale: float,
    colours: Any,
) -> tuple[Figure, str]:
    """A quantity over time and along a line, and what to say about its colours."""
    values = field.values / scale
    largest = field.highest.value / scale
    seen = values[np.isfinite(values)]
    top = float(np.quantile(seen, _SATURATED))
    note = ""
    if largest > _PEAKED * top and top > 0.0:
        note = f"Colours end at {top:.3g}; the largest value is {largest:.4g}."
    else:
        top = max(largest, float(np.min(seen)) + _ZERO)
    trace = {
        "type": "heatmap",
        "x": along.time / seconds,
        "y": along.s.astype(np.float32),
        "z": values.T.astype(np.float32),
        "zmin": float(np.min(seen)),
        "zmax": top,
        "colorscale": colours,
        "zsmooth": "best" if np.all(np.isfinite(values)) else False,
        "hovertemplate": f"t = %{{x:.4g}} {hours}, s = %{{y:.4g}} m<br>%{{z:.4g}}<extra></extra>",
        "colorbar": {
            "title": {"text": label, "side": "top", "font": {"size": 11}},
            "orientation": "h", "thickness": 9, "len": 0.6, "x": 0.5, "y": 1.01,
            "yanchor": "bottom", "ypad": 2, "outlinewidth": 0, "nticks": 5,
            "tickfont": {"size": 10},
        },
    }  # fmt: skip
    layout = _over_time(along.time / seconds, hours, arc, hovermode="closest")
    layout["margin"] = {"l": 58, "r": 14, "t": 50, "b": 40}
    layout["yaxis"]["autorange"] = "reversed"
    for axis in ("xaxis", "yaxis"):
        layout[axis]["showgrid"] = layout[axis]["zeroline"] = False
    return {"data": [trace], "layout": layout}, note


def touchdown(run: Run, seconds: float, hours: str) -> Figure | None:
    """Where the cable meets the floor, and how much of it lies there; of the lines of a system how
    much of each lies. None if nothing ever does."""
    places = {name: at for name, at in touchdowns(run).items() if np.isfinite(at).any()}
    if not places:
        return None
    time = run.time / seconds
    traces = []
    if "" in places:
        place = places[""]
        top = np.array([state.position[0] for state in run.states])
        across = [np.interp(run.time, run.states.time, top[:, axis]) for axis in (0, 1)]
        away = np.hypot(place[:, 0] - across[0], place[:, 1] - across[1])
        traces.append(_curve(time, away, "horizontally from the tow point", color=COLOURS[0]))
        traces.append(_curve(time, run["floor_length"], "length on the floor", color=COLOURS[2]))
    else:
        for k, name in enumerate(places):
            traces.append(_curve(time, run[f"{name}.floor_length"], name, **_style(k)))
    label = "length [m]" if "" in places else "length on the floor [m]"
    return {"data": traces, "layout": _over_time(time, hours, label, **_legend())}


def _style(k: int) -> dict[str, Any]:
    """Colour and dashes of one of many curves."""
    return {"color": COLOURS[k % len(COLOURS)], "dash": DASHES[k // len(COLOURS) % len(DASHES)]}


_INPUTS = (
    ("vessel_velocity", "tow point [m/s]", ("x, east", "y, north", "z, up")),
    ("payout_rate", "pay-out [m/s]", ("pay-out",)),
    ("current", "current [m/s]", ("current x", "current y", "current z")),
)
"""Name, label, names of the components."""


def inputs(run: Run, seconds: float, hours: str) -> Figure | None:
    """What the steps applied: motion of the tow point, pay-out and current where there are
    any; of a system how its vessels move, and all that was given. None when the run has no steps,
    or there is nothing of it."""
    if not len(run.applied_inputs["time"]):
        return None
    found = _inputs_of_system(run) if isinstance(run, SystemRun) else _inputs_of_line(run)
    rows = [row for row in found if row[1]]
    if not rows:
        return None
    layout = _over_time(run.time / seconds, hours, "", **_legend())
    layout["xaxis"]["anchor"] = "y" if len(rows) == 1 else f"y{len(rows)}"
    traces = []
    height = (1.0 - 0.1 * (len(rows) - 1)) / len(rows)
    for row, (label, pairs, time) in enumerate(rows):
        suffix = "" if row == 0 else str(row + 1)
        top = 1.0 - row * (height + 0.1)
        layout[f"yaxis{suffix}"] = {
            **layout["yaxis"], "title": _title(label), "domain": [max(top - height, 0.0), top],
            "rangemode": "tozero",
        }  # fmt: skip
        for index, (part, values) in enumerate(pairs):
            colour = COLOURS[(index + row) % len(COLOURS)]
            curve = _curve(time / seconds, values, part, color=colour)
            traces.append({**curve, "yaxis": f"y{suffix}"})
    layout["height"] = 90 + 160 * len(rows)
    return {"data": traces, "layout": layout}


_Row = tuple[str, list[tuple[str, Floats]], Floats]
"""Label, names and values of its curves, and their times [s]."""


def _inputs_of_line(run: Run) -> Iterator[_Row]:
    applied = run.applied_inputs
    for name, label, parts in _INPUTS:
        keys = [name] if len(parts) == 1 else [f"{name}.{axis}" for axis in "xyz"]
        pairs = [
            (part, applied[key])
            for part, key in zip(parts, keys, strict=True)
            if _any(applied[key])
        ]
        yield label, pairs, applied["time"]


def _inputs_of_system(run: SystemRun) -> Iterator[_Row]:
    applied = run.applied_inputs
    for name in run.scene.vessels:
        velocity = run[f"{name}.velocity"]
        axes = [k for k in range(3) if _any(velocity[:, k])]
        curves = [(f"{name} {'xyz'[k]}", velocity[:, k]) for k in axes]
        yield f"{name} velocity [m/s]", curves, run.time
    for name, (unit, _quantity, labels) in input_fields(run.scene).items():
        if name in ("time", "step") or np.all(np.isnan(applied[labels[0]])):
            continue
        part, _, field = name.rpartition(".")
        words = f"{part} {field.replace('_', ' ')}"
        curves = [
            (f"{words}{label.removeprefix(name).replace('.', ' ')}", applied[label])
            for label in labels
            if _any(applied[label]) or len(labels) == 1
        ]
        yield f"{words} [{unit}]" if unit else words, curves, applied["time"]


def _any(values: Floats) -> bool:
    return bool(np.any(np.abs(np.nan_to_num(values)) > _ZERO))
