"""Put the page together: data, figures and tables into one HTML file that needs nothing else."""

from __future__ import annotations

import base64
import html
import json
from importlib import resources
from os import PathLike
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING, Any

import numpy as np

from cablemodel.errors import CableModelError
from cablemodel.views.drawing import (
    COLOURS,
    arc_length_label,
    has_states,
    tension_scale,
    time_scale,
)
from cablemodel.views.report import charts, tables
from cablemodel.views.report.samples import Along, Frames
from cablemodel.views.report.shape import shape_figure

if TYPE_CHECKING:
    from cablemodel.results.run import Run

_SCENE_CHARACTERS = 200_000
"""A scene with long tables is shown up to here."""


def save_report(run: Run, path: str | PathLike[str]) -> None:
    """Write a run as one HTML file that opens from disk, without network.

    Raises:
        CableModelError: plotly is not installed, or the run has no states.
        OSError: the file cannot be written.
    """
    Path(path).write_text(report_html(run), encoding="utf-8")


def report_html(run: Run) -> str:
    """The page as text; see :func:`save_report`."""
    library = _plotly_js()
    if not has_states(run) or len(run.time) == 0:
        raise CableModelError("the run has no states: there is nothing to report")
    alongs = {name: Along.of(run, name) for name in run.shapes}
    data = _data(run, alongs)
    title = run.scene.title or "Cable run"
    newtons, unit = tension_scale(run)
    page = Template(_static("page.html"))
    first = next(iter(alongs))
    return page.substitute(
        title=html.escape(title),
        described=html.escape(tables.described(run)),
        incomplete=_incomplete(run),
        keys=_keys(tables.key_figures(run, alongs, newtons, unit)),
        line=html.escape(first or "the cable"),
        of_line=html.escape(f", {first}" if first else ""),
        lines="".join(f"<option>{html.escape(name)}</option>" for name in alongs),
        lines_hidden="" if len(alongs) > 1 else "hidden",
        start_tension="Tension at the beginnings of the lines" if first else "Top tension",
        beginning="the beginning of the line" if first else "the vessel",
        touchdown_hidden="" if "touchdown" in data["figures"] else "hidden",
        inputs_hidden="" if "inputs" in data["figures"] else "hidden",
        extremes=_extremes(tables.extremes(run, alongs, newtons, unit)),
        outputs=f"{len(next(iter(run.shapes.values()))):,}",
        solver=_facts(tables.solver_facts(run)),
        origin=_facts(tables.origin_facts(run)),
        scene=html.escape(_scene_text(run)),
        version=html.escape(_version()),
        style=_static("page.css"),
        script=_static("page.js"),
        plotly=library,
        data=_json(data),
    )


def _data(run: Run, alongs: dict[str, Along]) -> dict[str, Any]:
    """All figures and moving data."""
    newtons, unit = tension_scale(run)
    seconds, hours = time_scale(run.time)
    frames = Frames.of(run)
    shape, moving = shape_figure(run.scene, frames, newtons, unit)
    figures = {
        "shape": shape,
        "top-tension": charts.start_tension(run, seconds, hours, newtons, unit),
        "touchdown": charts.touchdown(run, seconds, hours),
        "inputs": charts.inputs(run, seconds, hours),
    }
    figures = {name: figure for name, figure in figures.items() if figure is not None}
    arc = arc_length_label(run)
    return {
        "figures": figures,
        "lines": {
            name: _line(along, arc, seconds, hours, newtons, unit) for name, along in alongs.items()
        },
        "shape": moving,
        "time": frames.time,
        "seconds": seconds,
        "hours": hours,
        # The curves of the profiles are the columns of the heat maps.
        "profiles": {"tension-along": "tension-map", "curvature-along": "curvature-map"},
        "overTime": [
            *(name for name in ("top-tension", "touchdown", "inputs") if name in figures),
            "tension-map",
            "curvature-map",
        ],
    }


def _line(
    along: Along, arc: str, seconds: float, hours: str, newtons: float, unit: str
) -> dict[str, Any]:
    """Figures of one line, what to say under its heat maps, and where its curves end."""
    figures, notes, ends = {}, {}, {"s": along.ends}
    for name, field, label, colour, scale, colours in (
        ("tension", along.tension, f"tension [{unit}]", COLOURS[0], newtons,
         charts.TENSION_SCALE),
        ("curvature", along.curvature, "curvature [1/m]", COLOURS[2], 1.0, "Viridis"),
    ):  # fmt: skip
        figures[f"{name}-along"] = charts.profile(along, field, arc, label, colour, scale)
        figures[f"{name}-map"], notes[f"{name}-map"] = charts.heat_map(
            along, field, arc, label, seconds, hours, scale, colours
        )
        # They go on to the far end, which lies between two rows.
        ends[f"{name}-along"] = field.ends / scale
    return {"figures": figures, "notes": notes, "ends": ends}


def _plotly_js() -> str:
    try:
        from plotly.offline import get_plotlyjs
    except ImportError as error:
        raise CableModelError(
            "reports need the package plotly: pip install 'cablemodel[plot]'"
        ) from error
    return _in_script(str(get_plotlyjs()))


def _version() -> str:
    import cablemodel

    return cablemodel.__version__


def _static(name: str) -> str:
    static = resources.files("cablemodel.views.report") / "static"
    return (static / name).read_text(encoding="utf-8")


def _json(data: Any) -> str:
    return _in_script(json.dumps(data, default=_encoded, allow_nan=False, separators=(",", ":")))


def _encoded(value: Any) -> Any:
    """Arrays as plotly writes them: their bytes in base 64. NaN survive, which JSON has not."""
    if isinstance(value, np.ndarray):
        kind = "f4" if value.dtype == np.float32 else "f8"
        array = np.ascontiguousarray(value, f"<{kind}")
        text = base64.b64encode(array.tobytes()).decode("ascii")
        return {"dtype": kind, "bdata": text, "shape": ", ".join(map(str, array.shape))}
    if isinstance(value, np.generic):
        return value.item()
    raise TypeError(f"{type(value).__name__} has no place in a report")


def _in_script(text: str) -> str:
    """Text that may stand inside a script element: nothing in it ends the element."""
    return text.replace("</", "<\\/").replace("<!--", "<\\!--")


def _incomplete(run: Run) -> str:
    if run.complete:
        return ""
    reason = html.escape(run.reason or "unknown")
    return f'<p class="warning" role="alert">This run is not complete: {reason}</p>'


def _keys(keys: list[tables.Key]) -> str:
    return "\n".join(
        f'<div class="key"><h3>{html.escape(key.name)}</h3>'
        f"<p><b>{key.value}</b> {html.escape(key.unit)}</p>"
        f"<small>{html.escape(key.note)}</small></div>"
        for key in keys
    )


def _extremes(rows: list[tables.Row]) -> str:
    lines = []
    for row in rows:
        cells = (row.lowest, row.lowest_at, row.highest, row.highest_at, row.at_end)
        classes = ("n", "at", "n", "at", "n")
        lines.append(
            f'<tr><th scope="row">{html.escape(row.quantity)} <i>[{html.escape(row.unit)}]</i></th>'
            + "".join(
                f'<td class="{kind}">{html.escape(cell)}</td>'
                for kind, cell in zip(classes, cells, strict=True)
            )
            + "</tr>"
        )
    return "\n".join(lines)


def _facts(facts: list[tuple[str, str]]) -> str:
    return "\n".join(
        f'<tr><th scope="row">{html.escape(name)}</th><td>{html.escape(value)}</td></tr>'
        for name, value in facts
    )


def _scene_text(run: Run) -> str:
    text = run.scene.to_yaml()
    if len(text) <= _SCENE_CHARACTERS:
        return text
    shown = text[:_SCENE_CHARACTERS].rpartition("\n")[0]
    left = text.count("\n") - shown.count("\n")
    return f"{shown}\n# ... {left:,} more lines are in the log"
