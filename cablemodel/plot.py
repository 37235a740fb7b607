"""Figures of a run for papers: shape, top tension, tension along the cable."""

from __future__ import annotations

import math
from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import CableModelError
from cablemodel.extras import require

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from cablemodel.run import Run

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

_STATIONS = 101
"""Points of a shape at least."""
_OUT_OF_PLANE = 1e-6
"""Part of the line's length by which a shape may leave a plane and still count as plane."""
_TRAVEL = 1.0
"""Part of the line's length by which the tow point may travel before shapes are drawn from it."""
_BETWEEN = 24
"""Instants at which the shape is drawn thinly."""
FLOOR_COLOUR = "#8c6d46"
MARKS = {"bodies.position": ("o", "body"), "touchdown_position": ("^", "touchdown")}
"""Marker and name of what is marked on a shape, by the output that gives its places."""
_ERROR = "0.7"
"""Colour of the shade of estimated errors."""
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
    """A figure of the cable's shape at some times, the top tension over time, and the tension
    along the cable at the same times.

    Args:
        run: a run with states.
        times: number of instants; they are chosen so that the shapes differ about equally.

    Raises:
        CableModelError: matplotlib is not installed, or the run has no states.
    """
    import_matplotlib()
    from matplotlib.figure import Figure

    if len(run.states) == 0:
        raise CableModelError("the run has no states: there is nothing to draw")
    view = View.of(run)
    chosen = _instants(view.shape, times)
    between = _instants(view.shape, _BETWEEN)
    colours = _colours(len(chosen))
    spatial = view.along is None

    figure = Figure(figsize=(7.2, 6.4 if spatial else 4.4), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(1.25, 1.0))
    side = figure.add_subplot(grid[0, 0] if spatial else grid[:, 0])
    panels = [side]
    draw_floor(side, run, view)
    across, label = view.horizontal(view.shape)
    _draw_shapes(side, across, view.shape[..., 2], chosen, between, colours)
    _draw_marks(side, run, view, chosen, colours)
    side.set_xlabel(label)
    side.set_ylabel("z from the tow point [m]" if view.relative else "z [m]")
    scale_axes(side)
    if spatial:
        plan = figure.add_subplot(grid[1, 0])
        _draw_shapes(plan, view.shape[..., 0], view.shape[..., 1], chosen, between, colours)
        _draw_marks(plan, run, view, chosen, colours, plan=True)
        after = " from the tow point" if view.relative else ""
        plan.set_xlabel(f"x{after} [m]")
        plan.set_ylabel(f"y{after} [m]")
        scale_axes(plan)
        panels.append(plan)
    top, along = figure.add_subplot(grid[0, 1]), figure.add_subplot(grid[1, 1])
    _draw_top_tension(top, run, chosen, colours)
    _draw_tension_along(along, run, chosen, colours)
    for letter, axes in zip("abcd", [*panels, top, along], strict=False):
        axes.set_title(f"({letter})", loc="left", fontweight="bold")
    _label(figure, run, run.states.time[chosen], colours)
    return figure


@dataclass(frozen=True)
class View:
    """Shapes (nt, n, 3) [m] as they are drawn, and how."""

    shape: Floats
    relative: bool
    """Whether they are drawn relative to the tow point, because it travels far."""
    origin: Floats
    """What the shapes are drawn from (nt, 3) [m]: the tow point, or zero."""
    along: Floats | None
    """Horizontal unit vector (2,) of the vertical plane that they stay in; None if in none."""

    @classmethod
    def of(cls, run: Run) -> View:
        # Nodes are the ends of cubics, not of straight lines.
        shape = run.states.resampled(max(_STATIONS, run.states.s.shape[1])).position
        top = shape[:, :1]
        length = float(np.max(run.states.s[:, -1] - run.states.s[:, 0]))
        travel = float(np.max(np.linalg.norm(top - top[:1], axis=-1)))
        relative = travel > _TRAVEL * length
        origin = top[:, 0] if relative else np.zeros((len(shape), 3))
        shape = shape - origin[:, None]
        across = shape[..., :2] - shape[:1, :1, :2]
        directions = np.linalg.svd(across.reshape(-1, 2), full_matrices=False)[2]
        off = float(np.max(np.abs(across @ directions[1])))
        along = None
        if off <= _OUT_OF_PLANE * length:
            # The axis nearest to the plane's own direction keeps its sign, so that x is x.
            leading = directions[0][np.argmax(np.abs(directions[0]))]
            along = directions[0] * math.copysign(1.0, leading)
        return cls(shape, relative, origin, along)

    def horizontal(self, points: Floats) -> tuple[Floats, str]:
        """Abscissa of points (..., 3) [m] in the side view, and its label."""
        after = " from the tow point" if self.relative else ""
        if self.along is None or abs(self.along[0]) > 1.0 - 1e-9:
            return points[..., 0], f"x{after} [m]"
        if abs(self.along[1]) > 1.0 - 1e-9:
            return points[..., 1], f"y{after} [m]"
        heading = math.degrees(math.atan2(self.along[1], self.along[0]))
        return points[..., :2] @ self.along, f"distance along {heading:.0f}° from x{after} [m]"


def _instants(shape: Floats, count: int) -> list[int]:
    """Indices of times, first and last included, between which the cable moves about equally."""
    moved = np.max(np.linalg.norm(np.diff(shape, axis=0), axis=-1), axis=1, initial=0.0)
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


def marked_places(run: Run, name: str) -> Floats:
    """Places (states, n, 3) [m] of bodies or touchdown at the times of the states.

    NaN where there is none: bodies on the drum, no touchdown.
    """
    times = run.states.time
    right = np.clip(np.searchsorted(run.time, times), 1, max(len(run.time) - 1, 1))
    left = right - 1
    right = np.minimum(right, len(run.time) - 1)
    nearest = np.where(times - run.time[left] <= run.time[right] - times, left, right)
    return run[name][nearest].reshape(len(times), -1, 3)


def _draw_marks(
    axes: Axes, run: Run, view: View, chosen: list[int], colours: list[Any], *, plan: bool = False
) -> None:
    for name in (name for name in MARKS if name in run.names):
        places = marked_places(run, name)
        for index, colour in zip(chosen, colours, strict=True):
            seen = places[index][np.isfinite(places[index, :, 0])] - view.origin[index]
            x = seen[:, 0] if plan else view.horizontal(seen)[0]
            marker = MARKS[name][0]
            axes.plot(x, seen[:, 1 if plan else 2], marker, color=colour, markersize=4)


def _draw_shapes(
    axes: Axes,
    x: Floats,
    y: Floats,
    chosen: list[int],
    between: list[int],
    colours: list[Any],
) -> None:
    """Coloured shapes at the chosen times, thin grey ones between, and where the tow point was."""
    from matplotlib.collections import LineCollection

    thin = [np.column_stack([x[index], y[index]]) for index in between if index not in chosen]
    axes.add_collection(LineCollection(thin, colors="0.75", linewidths=0.5, zorder=1.5))
    for index, colour in zip(chosen, colours, strict=True):
        axes.plot(x[index], y[index], color=colour)
    axes.plot(x[chosen, 0], y[chosen, 0], "o", color="0.15", markersize=4)


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
    if view.relative or view.along is None:
        return
    points = view.shape[..., :2].reshape(-1, 2)
    along = points @ view.along
    section = np.linspace(along.min(), along.max(), _STATIONS)
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


def _draw_top_tension(axes: Axes, run: Run, chosen: list[int], colours: list[Any]) -> None:
    seconds, time_unit = time_scale(run.time)
    newtons, unit = tension_scale(run)
    axes.plot(run.time / seconds, run.top_tension / newtons, color="0.25", linewidth=1.1)
    if "tension_error" in run.names:
        limits = axes.get_ylim()
        error = run["tension_error"]
        lower, upper = run.top_tension - error, run.top_tension + error
        axes.fill_between(run.time / seconds, lower / newtons, upper / newtons, color=_ERROR,
                          linewidth=0.0, zorder=1.5)  # fmt: skip
        axes.set_ylim(limits)  # what a snap may be off by must not hide all else
    at = run.states.time[chosen]
    values = np.interp(at, run.time, run.top_tension) / newtons
    axes.scatter(
        at / seconds, values, c=colours, s=22, zorder=3, edgecolors="white", linewidths=0.6
    )
    axes.set_xlabel(f"time [{time_unit}]")
    axes.set_ylabel(f"top tension [{unit}]")
    axes.margins(x=0.03)


def _draw_tension_along(axes: Axes, run: Run, chosen: list[int], colours: list[Any]) -> None:
    newtons, unit = tension_scale(run)
    for index, colour in zip(chosen, colours, strict=True):
        state = run.states[index]
        axes.plot(state.s, state.tension / newtons, color=colour)
    axes.set_xlabel("arc length from the vessel [m]")
    axes.set_ylabel(f"tension [{unit}]")
    axes.margins(x=0.03)


def tension_scale(run: Run) -> tuple[float, str]:
    """Newtons in the unit that the run's tensions are shown in, and its symbol."""
    largest = float(np.nanmax(np.abs(run.tension_max), initial=0.0))
    return (1e3, "kN") if largest >= 2e4 else (1.0, "N")


def time_scale(time: Floats) -> tuple[float, str]:
    """Seconds in the unit that a run's times are shown in, and its symbol."""
    return (3600.0, "h") if time[-1] >= 3 * 3600.0 else (1.0, "s")


def _label(figure: Figure, run: Run, times: Floats, colours: list[Any]) -> None:
    """One key for all panels: the colours' times, and what is marked."""
    from matplotlib.lines import Line2D

    seconds, unit = time_scale(times)
    handles = [Line2D([], [], linestyle="none", label="time:")]
    handles += [
        Line2D([], [], color=colour, label=f"{time / seconds:.4g} {unit}")
        for time, colour in zip(times, colours, strict=True)
    ]
    handles += [
        Line2D([], [], linestyle="none", marker=marker, markersize=4, color="0.4", label=label)
        for name, (marker, label) in MARKS.items()
        if name in run.names and np.isfinite(marked_places(run, name)[..., 0]).any()
    ]
    if "tension_error" in run.names and np.isfinite(run["tension_error"]).any():
        handles.append(Line2D([], [], color=_ERROR, linewidth=5.0, label="estimated error"))
    figure.legend(
        handles=handles,
        loc="outside lower center",
        ncols=len(handles),
        columnspacing=1.4,
        handlelength=1.6,
    )
