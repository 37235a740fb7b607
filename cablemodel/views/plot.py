"""Figures of a run for papers: shape, top tension, tension along the cable."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from os import PathLike
from string import ascii_lowercase
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import CableModelError
from cablemodel.extras import require
from cablemodel.views.drawing import (
    COLOURS,
    Marks,
    Reference,
    Shapes,
    bodies_of,
    has_states,
    held_of,
    names_of,
    sides_of,
    skeletons_of,
    slack_spans,
    start_tensions,
    tension_errors,
    tension_scale,
    time_scale,
    touchdown_of,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from cablemodel.results.run import Run

Floats = NDArray[np.float64]

TIMES = 6
"""Instants at which the shape is drawn."""

STYLE: Any = {
    "font.size": 9,
    "axes.labelsize": 9,
    "axes.titlesize": 9,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "legend.fontsize": 8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.linewidth": 0.7,
    "xtick.major.width": 0.7,
    "ytick.major.width": 0.7,
    "axes.grid": True,
    "grid.color": "0.9",
    "grid.linewidth": 0.6,
    "axes.axisbelow": True,
    "lines.linewidth": 1.4,
    "lines.solid_capstyle": "round",
    "legend.frameon": False,
    "svg.fonttype": "none",
    "pdf.fonttype": 42,
}

_SECTION = 101
"""Points of the floor's section."""
_OUT_OF_PLANE = 1e-6
"""Part of the line's length by which a shape may leave a plane and still count as plane."""
_TRAVEL = 1.0
"""Part of the line's length by which the tow point may travel before shapes are drawn from it."""
_BETWEEN = 24
"""Instants at which the shape is drawn thinly."""
FLOOR_COLOUR = "#8c6d46"
MARKS = {"body": "o", "touchdown": "^"}
"""Marker of what is marked on a shape."""
DASHES = ("-", "--", ":", "-.")
"""Of lines that have the same colour."""
_ERROR = "0.7"
_SLACK = "#f5d6b8"
"""Colour of the shade of estimated errors."""
_IN_A_ROW = 3
"""Panels of lines in a row."""
_ROW = 2.0
"""Height of such a row [inch]."""
_WIDEST = 4.0
"""Largest ratio of sides at which a view is drawn to scale."""


def save_figure(run: Run, path: str | PathLike[str], *, dpi: int = 200) -> None:
    """Draw a run and write it as PNG, PDF or SVG, by the file's ending.

    Raises:
        CableModelError: matplotlib is not installed, the run has no states, or no such format.
        OSError: the file cannot be written.
    """
    import_matplotlib()
    import matplotlib

    with matplotlib.rc_context(STYLE):
        try:
            draw(run).savefig(path, dpi=dpi)
        except ValueError as error:
            raise CableModelError(f"cannot write {path}: {error}") from error


def import_matplotlib() -> None:
    """Raise a CableModelError that says what to install, if matplotlib is missing."""
    require("matplotlib", extra="plot", what="a figure")


def draw(run: Run, *, times: int = TIMES) -> Figure:
    """A figure of the shapes of all lines at some times, the tension at their beginnings over
    time, and the tension along each line at the same times.

    Args:
        run: a run with states.
        times: number of instants; they are chosen so that the shapes differ about equally.

    Raises:
        CableModelError: matplotlib is not installed, or the run has no states.
    """
    import_matplotlib()
    if not has_states(run):
        raise CableModelError("the run has no states: there is nothing to draw")
    view = View.of(run)
    chosen = _instants(view.shape, times)
    between = _instants(view.shape, _BETWEEN)
    colours = _colours(len(chosen))
    parts = view.parts(run)

    figure, sides, top, alongs = _panels(view, list(run.shapes))
    draw_floor(sides[0], run, view)
    for axes, up in zip(sides, view.ups, strict=True):
        _draw_shapes(axes, *view.flat(view.shape, up), chosen, between, colours)
        _draw_parts(axes, view, parts, chosen, colours, up)
        axes.set_xlabel(view.horizontal(view.shape)[1])
        axes.set_ylabel(view.vertical(up))
        scale_axes(axes)
    draw_start_tensions(top, run)
    _draw_chosen(top, run, view.time[chosen], colours)
    for axes, name in zip(alongs, run.shapes, strict=True):
        _draw_tension_along(axes, run, name, chosen, colours)
    for letter, axes in zip(ascii_lowercase, figure.axes, strict=False):
        axes.set_title(f"({letter})", loc="left", fontweight="bold")
    _label(figure, run, view.time[chosen], parts, colours)
    return figure


def _panels(view: View, lines: list[str]) -> tuple[Figure, list[Axes], Axes, list[Axes]]:
    """A figure and its panels: side view and plan, if the shapes leave a plane; tensions at the
    beginnings; tension along each line, of several lines in rows below."""
    from matplotlib.figure import Figure

    spatial = len(view.ups) > 1
    rows = 0 if len(lines) == 1 else -(-len(lines) // _IN_A_ROW)
    height = 6.4 if spatial else 4.4 if rows == 0 else 3.2
    figure = Figure(figsize=(7.2, height + _ROW * rows), layout="constrained")
    heights = [height, *([_ROW * rows] if rows else [])]
    outer = figure.add_gridspec(len(heights), 1, height_ratios=heights)
    grid = outer[0].subgridspec(2, 2, width_ratios=(1.25, 1.0))
    cells = [grid[0, 0], grid[1, 0]] if spatial else [grid[:, 0]]
    sides = [figure.add_subplot(cell) for cell in cells]
    top = figure.add_subplot(grid[:, 1] if rows else grid[0, 1])
    if not rows:
        return figure, sides, top, [figure.add_subplot(grid[1, 1])]
    columns = min(len(lines), _IN_A_ROW)
    below = outer[1].subgridspec(rows, columns)
    alongs = [figure.add_subplot(below[divmod(k, columns)]) for k in range(len(lines))]
    for axes, name in zip(alongs, lines, strict=True):
        axes.set_title(name)
    return figure, sides, top, alongs


@dataclass(frozen=True)
class View:
    """Shapes (nt, n, 3) [m] of all lines as they are drawn, and how."""

    shapes: Shapes
    shape: Floats
    """Their positions, from the origin; NaN between two lines."""
    reference: str
    """What they are drawn from, in words, because it travels far; empty if they are not."""
    origin: Floats
    """What they are drawn from (nt, 3) [m], or zero."""
    along: Floats | None
    """Horizontal unit vector (2,) of the vertical plane that they stay in; None if in none."""

    @classmethod
    def of(cls, run: Run) -> View:
        # Nodes are the ends of cubics, not of straight lines.
        shapes = Shapes.of(run)
        reference = Reference.of(run, shapes)
        travel = float(np.max(np.linalg.norm(reference.place - reference.place[:1], axis=-1)))
        relative = travel > _TRAVEL * shapes.length
        origin = reference.place if relative else np.zeros((len(shapes.time), 3))
        shape = shapes.position - origin[:, None]
        across = (shape[..., :2] - shape[:1, :1, :2]).reshape(-1, 2)
        across = across[np.isfinite(across[:, 0])]
        directions = np.linalg.svd(across, full_matrices=False)[2]
        off = float(np.max(np.abs(across @ directions[1])))
        along = None
        if off <= _OUT_OF_PLANE * shapes.length:
            # The axis nearest to the plane's own direction keeps its sign, so that x is x.
            leading = directions[0][np.argmax(np.abs(directions[0]))]
            along = directions[0] * math.copysign(1.0, leading)
        return cls(shapes, shape, reference.name if relative else "", origin, along)

    @property
    def time(self) -> Floats:
        """Of the states (nt,) [s]."""
        return self.shapes.time

    @property
    def after(self) -> str:
        """What follows the name of a coordinate."""
        return f" from {self.reference}" if self.reference else ""

    def seen(self, places: Floats) -> Floats:
        """Places (nt, n, 3) [m] as they are drawn."""
        return places - self.origin[:, None]

    def parts(self, run: Run) -> Parts:
        """What is drawn beside the lines."""
        shapes = self.shapes
        bodies = bodies_of(run, shapes)
        held, bodies, touchdown, names = (
            replace(marks, places=self.seen(marks.places))
            for marks in (
                held_of(run, shapes), bodies, touchdown_of(run, shapes),
                names_of(run, shapes, bodies),
            )
        )  # fmt: skip
        skeletons = self.seen(skeletons_of(run, self.time, self._size()))
        found = [marks for marks in (bodies, touchdown) if marks.names]
        return Parts(held, found, skeletons, names)

    def _size(self) -> float:
        """Of what is drawn [m]: where axes have scales of their own, that of the shorter one, or
        what is a little long along the other would span the picture along this."""
        across, *up = sides_of(np.stack([*self.flat(self.shape, 2), self.shape[..., 1]], axis=-1))
        shorter, longer = sorted((float(across), float(up[0])))
        scaled = longer <= _WIDEST * shorter or shorter == 0.0
        return max(longer, float(up[1])) if scaled else shorter

    @property
    def ups(self) -> tuple[int, ...]:
        """Axes that are ordinates: z of the side view, and y of the plan where there is one."""
        return (2, 1) if self.along is None else (2,)

    def flat(self, points: Floats, up: int) -> tuple[Floats, Floats]:
        """Abscissa and ordinate of points (..., 3) [m] in the view with this ordinate."""
        return self.horizontal(points)[0], points[..., up]

    def vertical(self, up: int) -> str:
        """Label of an ordinate."""
        return f"{'xyz'[up]}{self.after} [m]"

    def horizontal(self, points: Floats) -> tuple[Floats, str]:
        """Abscissa of points (..., 3) [m] in the side view, and its label."""
        after = self.after
        if self.along is None or abs(self.along[0]) > 1.0 - 1e-9:
            return points[..., 0], f"x{after} [m]"
        if abs(self.along[1]) > 1.0 - 1e-9:
            return points[..., 1], f"y{after} [m]"
        heading = math.degrees(math.atan2(self.along[1], self.along[0]))
        return points[..., :2] @ self.along, f"distance along {heading:.0f}° from x{after} [m]"


@dataclass(frozen=True)
class Parts:
    """What is drawn beside the lines; all places from the origin of the view."""

    held: Marks
    marks: list[Marks]
    """Bodies and touchdown, where there are any."""
    skeletons: Floats
    """Vessels and free bodies as lines (nt, n, 3) [m], with gaps (NaN)."""
    names: Marks
    """Of vessels and bodies."""

    def key(self) -> list[tuple[str, str, str]]:
        """Kind, marker and colour of what needs a word in the key."""
        seen = [marks for marks in self.marks if np.isfinite(marks.places[..., 0]).any()]
        found = [(marks.kind, MARKS[marks.kind], "0.4") for marks in seen]
        if self.names.names and self.held.names:
            found.append((self.held.kind, "o", "0.15"))
        return found


def _instants(shape: Floats, count: int) -> list[int]:
    """Indices of times, first and last included, between which the cable moves about equally."""
    steps = np.nan_to_num(np.linalg.norm(np.diff(shape, axis=0), axis=-1))
    moved = np.max(steps, axis=1, initial=0.0)
    way = np.concatenate([[0.0], np.cumsum(moved)])
    if way[-1] == 0.0:
        return [0]
    wanted = np.linspace(0.0, way[-1], count)
    return sorted({int(np.argmin(np.abs(way - value))) for value in wanted})


def _colours(count: int) -> list[Any]:
    """Colours from early to late: even in lightness, and told apart by the colour-blind."""
    import matplotlib

    viridis = matplotlib.colormaps["viridis"]
    return [viridis(value) for value in np.linspace(0.0, 0.88, max(count, 1))]


def _draw_parts(
    axes: Axes, view: View, parts: Parts, chosen: list[int], colours: list[Any], up: int
) -> None:
    """What holds the lines and what hangs on them, and, at the last of the times, their names."""

    def flat(places: Floats) -> tuple[Floats, Floats]:
        return view.flat(places, up)

    for index, colour in zip(chosen, colours, strict=True):
        if parts.skeletons.size:
            axes.plot(*flat(parts.skeletons[index]), color=colour, linewidth=0.8)
        for marks in parts.marks:
            seen = marks.places[index][np.isfinite(marks.places[index, :, 0])]
            axes.plot(*flat(seen), MARKS[marks.kind], color=colour, markersize=4)
    axes.plot(*map(np.ravel, flat(parts.held.places[chosen])), "o", color="0.15", markersize=4)
    for name, place in zip(parts.names.names, parts.names.places[chosen[-1]], strict=True):
        axes.annotate(name, flat(place), (4, 4), textcoords="offset points", fontsize=7)


def _draw_shapes(
    axes: Axes,
    x: Floats,
    y: Floats,
    chosen: list[int],
    between: list[int],
    colours: list[Any],
) -> None:
    """Coloured shapes at the chosen times, and thin grey ones between."""
    from matplotlib.collections import LineCollection

    thin = [np.column_stack([x[index], y[index]]) for index in between if index not in chosen]
    axes.add_collection(LineCollection(thin, colors="0.75", linewidths=0.5, zorder=1.5))
    for index, colour in zip(chosen, colours, strict=True):
        axes.plot(x[index], y[index], color=colour)


def draw_floor(axes: Axes, run: Run, view: View) -> None:
    """The sea floor where its section with the picture is one line."""
    floor = run.scene.environment.floor
    if floor is None:
        return
    if floor.z is not None and not any(floor.slope):
        heights = floor.z - view.origin[:, 2]
        if np.ptp(heights) <= _OUT_OF_PLANE * abs(float(heights[0])):
            axes.axhline(float(heights[0]), color=FLOOR_COLOUR, linewidth=1.0, zorder=1.2)
        return
    if view.reference or view.along is None:
        return
    points = view.shape[..., :2].reshape(-1, 2)
    along = points @ view.along
    section = np.linspace(along.min(), along.max(), _SECTION)
    places = points[0] + np.outer(section - along[0], view.along)
    height = [floor.height(float(x), float(y)) for x, y in places]
    shown = view.horizontal(np.column_stack([places, height]))[0]
    axes.plot(shown, height, color=FLOOR_COLOUR, linewidth=1.0, zorder=1.2)


def scale_axes(axes: Axes) -> None:
    """Both axes to one scale where the shape allows it; say so where it does not."""
    axes.margins(0.06)
    left, right = axes.get_xlim()
    low, high = axes.get_ylim()
    ratio = (right - left) / (high - low)
    if 1.0 / _WIDEST <= ratio <= _WIDEST:
        axes.set_aspect("equal", adjustable="datalim")
    else:
        axes.set_title("axes not to one scale", loc="right", color="0.4", fontsize=8)


def draw_start_tensions(axes: Axes, run: Run) -> None:
    """Tensions at the beginnings of all lines over time."""
    seconds, time_unit = time_scale(run.time)
    newtons, unit = tension_scale(run)
    named = "" not in run.shapes
    for k, (name, tension) in enumerate(start_tensions(run).items()):
        axes.plot(
            run.time / seconds, tension / newtons, DASHES[k // len(COLOURS) % len(DASHES)],
            color=COLOURS[k % len(COLOURS)] if named else "0.25", linewidth=1.1, label=name,
        )  # fmt: skip
    for begin, end in slack_spans(run):
        axes.axvspan(begin / seconds, end / seconds, color=_SLACK, linewidth=0.0, zorder=0.5)
    axes.set_xlabel(f"time [{time_unit}]")
    axes.set_ylabel(f"{'start tension' if named else 'top tension'} [{unit}]")
    if named:
        axes.legend()


def _draw_chosen(axes: Axes, run: Run, at: Floats, colours: list[Any]) -> None:
    """The chosen times (n,) [s] on the curves, and the estimated error around them."""
    seconds, _ = time_scale(run.time)
    newtons, _ = tension_scale(run)
    for tension in start_tensions(run).values():
        values = np.interp(at, run.time, tension) / newtons
        axes.scatter(
            at / seconds, values, c=colours, s=22, zorder=3, edgecolors="white", linewidths=0.6
        )
    limits = axes.get_ylim()
    for name, error in tension_errors(run).items():
        tension = start_tensions(run)[name]
        lower, upper = tension - error, tension + error
        axes.fill_between(run.time / seconds, lower / newtons, upper / newtons, color=_ERROR,
                          linewidth=0.0, zorder=1.5)  # fmt: skip
        axes.set_ylim(limits)  # what a snap may be off by must not hide all else
    axes.margins(x=0.03)


def _draw_tension_along(
    axes: Axes, run: Run, name: str, chosen: list[int], colours: list[Any]
) -> None:
    newtons, unit = tension_scale(run)
    for index, colour in zip(chosen, colours, strict=True):
        state = run.shapes[name][index]
        axes.plot(state.s, state.tension / newtons, color=colour)
    # Panels of several lines are narrow.
    axes.set_xlabel("from its beginning [m]" if name else "arc length from the vessel [m]")
    axes.set_ylabel(f"tension [{unit}]")
    axes.margins(x=0.03)


def _label(figure: Figure, run: Run, times: Floats, parts: Parts, colours: list[Any]) -> None:
    """One key for all panels: the colours' times, and what is marked."""
    from matplotlib.lines import Line2D

    seconds, unit = time_scale(times)
    handles = [Line2D([], [], linestyle="none", label="time:")]
    handles += [
        Line2D([], [], color=colour, label=f"{time / seconds:.4g} {unit}")
        for time, colour in zip(times, colours, strict=True)
    ]
    handles += [
        Line2D([], [], linestyle="none", marker=marker, markersize=4, color=colour, label=kind)
        for kind, marker, colour in parts.key()
    ]
    if tension_errors(run):
        handles.append(Line2D([], [], color=_ERROR, linewidth=5.0, label="estimated error"))
    if slack_spans(run):
        handles.append(Line2D([], [], color=_SLACK, linewidth=5.0, label="slack"))
    for rows in range(1, len(handles) + 1):  # as many as it takes to stay within the picture
        legend = figure.legend(
            handles=handles,
            loc="outside lower center",
            ncols=math.ceil(len(handles) / rows),
            columnspacing=1.4,
            handlelength=1.6,
        )
        if legend.get_window_extent().width <= figure.bbox.width:
            return
        legend.remove()
