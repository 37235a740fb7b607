"""A film of a run: the moving lines, coloured by tension, over the tension at their beginnings."""

from __future__ import annotations

import shutil
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import CableModelError
from cablemodel.views.drawing import has_states, tension_scale, time_scale
from cablemodel.views.plot import (
    MARKS,
    STYLE,
    Parts,
    View,
    draw_floor,
    draw_start_tensions,
    import_matplotlib,
    scale_axes,
)

if TYPE_CHECKING:
    from matplotlib.animation import AbstractMovieWriter
    from matplotlib.axes import Axes

    from cablemodel.results.run import Run

SHORTEST, USUAL, LONGEST = 4.0, 20.0, 600.0
"""Length of a film [s]: of a short run and of a long one if not said, and at most."""

_SIZE, _DPI = (7.2, 5.4), 140
"""[inch], [1/inch]; both sides must be even numbers of pixels."""


def save_animation(
    run: Run, path: str | PathLike[str], *, seconds: float | None = None, fps: int = 20
) -> None:
    """Write a film of a run as MP4 or GIF, by the file's ending.

    Args:
        run: a run with states.
        path: file to write.
        seconds: how long the film is [s]; by default the run's own time, at least 4, at most 20.
        fps: pictures per second.

    Raises:
        CableModelError: matplotlib or the writer of the format is missing, the run has no states,
            or no such format.
        OSError: the file cannot be written.
        ValueError: ``seconds`` or ``fps`` is out of range.
    """
    import_matplotlib()
    import matplotlib
    from matplotlib.figure import Figure

    if not has_states(run):
        raise CableModelError("the run has no states: there is nothing to animate")
    time = next(iter(run.shapes.values())).time
    span = float(time[-1] - time[0])
    length = min(max(span, SHORTEST), USUAL) if seconds is None else seconds
    if not (0.0 < length <= LONGEST and fps >= 1):
        raise ValueError(f"a film of {length} s at {fps} pictures per second cannot be made")
    target = Path(path)
    settings: Any = {**STYLE, **_ffmpeg_path(target)}
    with matplotlib.rc_context(settings):
        writer = _writer(target, fps)
        film = _Film(run)
        times = np.linspace(time[0], time[-1], max(2, round(length * fps)))
        # The writers draw a whole figure for every picture. Theirs holds nothing but an image:
        # axes and labels are drawn once, which makes a film ten times as quick.
        screen = Figure(figsize=_SIZE, dpi=_DPI)
        picture = screen.figimage(film.picture(float(times[0])))
        with writer.saving(screen, str(target), _DPI):
            for at in times:
                picture.set_data(film.picture(float(at)))
                writer.grab_frame()


def _ffmpeg_path(target: Path) -> dict[str, str]:
    """Where ffmpeg is: the system's, or else that of the package imageio-ffmpeg."""
    if target.suffix.lower() != ".mp4":
        return {}
    found = shutil.which("ffmpeg")
    if found is None:
        try:
            import imageio_ffmpeg

            found = imageio_ffmpeg.get_ffmpeg_exe()
        except (ImportError, RuntimeError) as error:
            raise CableModelError(
                "films in MP4 need ffmpeg: install it, or pip install 'cablemodel[plot]'; "
                "a GIF needs neither"
            ) from error
    return {"animation.ffmpeg_path": str(found)}


def _writer(target: Path, fps: int) -> AbstractMovieWriter:
    from matplotlib.animation import FFMpegWriter, PillowWriter

    ending = target.suffix.lower()
    if ending == ".gif":
        return PillowWriter(fps=fps)
    if ending == ".mp4":
        # Players on phones and in browsers want this pixel format.
        options = ["-pix_fmt", "yuv420p", "-crf", "20", "-preset", "veryfast"]
        return FFMpegWriter(fps=fps, codec="libx264", extra_args=options)
    raise CableModelError(f"cannot write {target}: a film ends in .mp4 or .gif")


class _Film:
    """The figure of a film, and how to move it."""

    def __init__(self, run: Run) -> None:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        self._run = run
        self._view = view = View.of(run)
        self._newtons, self._unit = tension_scale(run)
        self._seconds, self._hours = time_scale(view.time)
        tension = view.shapes.tension / self._newtons
        parts = view.parts(run)

        figure = Figure(figsize=_SIZE, dpi=_DPI, layout="constrained")
        self._canvas: Any = cast(Any, FigureCanvasAgg(figure))  # its methods have no types
        grid = figure.add_gridspec(2, len(view.ups), height_ratios=(2.4, 1.0))
        self._panels = []
        for column, up in enumerate(view.ups):
            axes = figure.add_subplot(grid[0, column])
            if column == 0:
                draw_floor(axes, run, view)
            self._panels.append(_Panel(axes, view, parts, tension, up))
        figure.colorbar(
            self._panels[0].cable,
            ax=[panel.axes for panel in self._panels],
            label=f"tension [{self._unit}]",
            aspect=30,
            pad=0.02,
        )
        self._top = figure.add_subplot(grid[1, :])
        self._draw_start_tensions()
        self._title = figure.suptitle(" ", fontsize=10, x=0.01, ha="left", animated=True)
        self._canvas.draw()
        self._still = self._canvas.copy_from_bbox(figure.bbox)

    def _draw_start_tensions(self) -> None:
        run = self._run
        time = run.time / self._seconds
        draw_start_tensions(self._top, run)
        self._top.margins(x=0.0)
        self._now = self._top.axvline(time[0], color="#d1495b", linewidth=1.2, animated=True)

    def picture(self, time: float) -> NDArray[np.uint8]:
        """Everything at a time [s], (height, width, 4); shapes are linear between outputs."""
        times = self._view.time
        right = int(np.clip(np.searchsorted(times, time), 1, max(len(times) - 1, 1)))
        left = right - 1
        right = min(right, len(times) - 1)
        step = times[right] - times[left]
        part = (time - times[left]) / step if step > 0.0 else 0.0
        for panel in self._panels:
            panel.show(left, right, part)
        self._now.set_xdata([time / self._seconds])
        title = self._run.scene.title or "Cable"
        self._title.set_text(f"{title}   ·   t = {time / self._seconds:.2f} {self._hours}")
        self._canvas.restore_region(self._still)
        for panel in self._panels:
            panel.draw()
        self._top.draw_artist(self._now)
        self._canvas.figure.draw_artist(self._title)
        return np.asarray(self._canvas.buffer_rgba())


class _Panel:
    """A view of the cable from one side."""

    def __init__(self, axes: Axes, view: View, parts: Parts, tension: Any, up: int) -> None:
        import matplotlib
        from matplotlib.collections import LineCollection
        from matplotlib.colors import LinearSegmentedColormap

        self.axes = axes

        def flat(places: Any) -> NDArray[np.float64]:
            return np.stack(view.flat(places, up), axis=-1)

        self._points = flat(view.shape)
        self._tension = tension
        # Without the palest part, which is hard to see on white.
        plasma = matplotlib.colormaps["plasma"](np.linspace(0.0, 0.82, 256))
        colours = LinearSegmentedColormap.from_list("tension", plasma)
        self.cable = LineCollection(
            [], cmap=colours, linewidths=2.6, capstyle="round", animated=True
        )
        low, high = float(np.nanmin(tension)), float(np.nanmax(tension))
        self.cable.set_clim(low, max(high, low + 1e-9))
        axes.add_collection(self.cable)
        styles: list[tuple[NDArray[np.float64], dict[str, Any]]] = [
            (parts.skeletons, {"linestyle": "-", "color": "0.3", "linewidth": 1.0}),
            (parts.held.places, {"linestyle": "", "marker": "s", "color": "0.15"}),
            *(
                (marks.places, {"linestyle": "", "marker": MARKS[marks.kind], "color": "0.3"})
                for marks in parts.marks
            ),
        ]
        self._marks = [
            (axes.plot([], [], markersize=5, animated=True, **style)[0], flat(places))
            for places, style in styles
        ]
        self._names = [
            axes.annotate(
                name, (0, 0), (5, 5), textcoords="offset points", fontsize=8, animated=True
            )
            for name in parts.names.names
        ]
        self._named = flat(parts.names.places)
        # Invisible points hold the limits, which must not move with the cable.
        seen = [self._points, *(places for _, places in self._marks)]
        edges = np.concatenate([places.reshape(-1, 2) for places in seen])
        axes.plot(*np.stack([np.nanmin(edges, axis=0), np.nanmax(edges, axis=0)]).T, alpha=0.0)
        axes.set_xlabel(view.horizontal(view.shape)[1])
        axes.set_ylabel(view.vertical(up))
        axes.margins(0.06)
        scale_axes(axes)

    def show(self, left: int, right: int, part: float) -> None:
        def at(values: NDArray[np.float64]) -> NDArray[np.float64]:
            return np.asarray((1.0 - part) * values[left] + part * values[right])

        points, tension = at(self._points), at(self._tension)
        segments, forces = np.stack([points[:-1], points[1:]], axis=1), tension[:-1] + tension[1:]
        there = np.isfinite(forces)  # not between two lines
        self.cable.set_segments(list(segments[there]))
        self.cable.set_array(forces[there] / 2)
        for marks, places in self._marks:
            marks.set_data(*at(places).T)
        for name, place in zip(self._names, at(self._named), strict=True):
            name.xy = tuple(place)

    def draw(self) -> None:
        """Draw what moves, onto what stands still."""
        self.axes.draw_artist(self.cable)
        for artist in (*(marks for marks, _places in self._marks), *self._names):
            self.axes.draw_artist(artist)
