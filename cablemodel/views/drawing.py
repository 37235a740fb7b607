"""What pictures, films and pages of a run share: its lines, what holds them, what hangs on them.

A run of one line is that of a system whose only line has no name.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.results.run import Run, SystemRun

if TYPE_CHECKING:
    from cablemodel.results.states import States

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

COLOURS = ("#1f5fa8", "#d1495b", "#2a9d6f", "#8a6bbf")
"""Told apart by the colour-blind, and readable on white."""
STATIONS = 101
"""Points of a shape at least."""
AXES = (1.0, 0.5, 0.5)
"""Lengths at which axes of bodies are drawn, x being the longest: it tells where they head."""
AXES_SIZE = 0.07
"""Of the longest of them, as a part of what is seen."""


@dataclass(frozen=True)
class Shapes:
    """All lines at the times of their states, at stations spaced evenly in s: one line after the
    other in one array, with a gap, a NaN, between two, and where a line may be cut."""

    time: Floats
    """(nt,) [s]"""
    places: dict[str, slice]
    """Which stations are those of a line, by its name."""
    s: Floats
    """Unstretched arc length from the beginning of the line (nt, n) [m]."""
    position: Floats
    """(nt, n, 3) [m], east, north, up."""
    tension: Floats
    """(nt, n) [N]"""

    @classmethod
    def of(cls, run: Run, chosen: Indices | None = None, *, most: int | None = None) -> Shapes:
        """chosen: some of the states only; most: stations of a line at most."""
        places: dict[str, slice] = {}
        parts: dict[str, list[Floats]] = {"s": [], "position": [], "tension": []}
        end, time = -1, np.empty(0)
        for name, states in run.shapes.items():
            seen = states if chosen is None else states.chosen(chosen)
            cuts = run.scene.cuts_along(name) if isinstance(run, SystemRun) else []
            first, time = end + 1, seen.time
            for piece in seen.split(cuts):
                count = stations_of(piece, most)
                even = piece.resampled(count)
                for field, columns in parts.items():
                    values = getattr(even, field)
                    if end > 0:
                        columns.append(np.full_like(values[:, :1], np.nan))
                    columns.append(values)
                end += count + 1
            places[name] = slice(first, end)
        joined = {field: np.concatenate(columns, axis=1) for field, columns in parts.items()}
        return cls(time, places, **joined)

    @property
    def length(self) -> float:
        """Of the longest line at any time [m]."""
        spans = [self.s[:, at.stop - 1] - self.s[:, at.start] for at in self.places.values()]
        return float(np.max(spans))


def stations_of(states: States, most: int | None = None) -> int:
    """Stations that show what a line's states hold, at most so many."""
    count = max(states.most_nodes, STATIONS)
    return count if most is None else min(count, most)


@dataclass(frozen=True)
class Part:
    """A vessel or free body of a system over time."""

    name: str
    position: Floats
    """Of its origin (nt, 3) [m]."""
    axes: Floats
    """Its x, y and z axes in the columns (nt, 3, 3)."""
    points: dict[str, Floats]
    """Its points by name, each (nt, 3) [m]."""


def parts_of(run: Run, kind: str, time: Floats) -> list[Part]:
    """The ``vessels`` or ``bodies`` of a system at the outputs nearest to times (nt,) [s]; none in
    a scene of one line."""
    if not isinstance(run, SystemRun):
        return []
    at = nearest(run.time, time)
    found = []
    for name, part in getattr(run.scene, kind).items():
        position, axes = run[f"{name}.position"][at], axes_of(run[f"{name}.attitude"][at])
        points = {
            point: position + axes @ np.asarray(place) for point, place in part.points.items()
        }
        found.append(Part(name, position, axes, points))
    return found


def axes_of(attitude: Floats) -> Floats:
    """Axes in the columns (n, 3, 3) of rolls, pitches and yaws (n, 3) [rad]: R = Rz Ry Rx."""
    (ca, cb, cc), (sa, sb, sc) = np.cos(attitude).T, np.sin(attitude).T
    rows = [
        [cc * cb, cc * sb * sa - sc * ca, cc * sb * ca + sc * sa],
        [sc * cb, sc * sb * sa + cc * ca, sc * sb * ca - cc * sa],
        [-sb, cb * sa, cb * ca],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


@dataclass(frozen=True)
class Marks:
    """Points that a picture marks, over time."""

    kind: str
    """What they are, in words."""
    names: tuple[str, ...]
    """Of each point; empty where it has none."""
    places: Floats
    """(nt, n, 3) [m]; NaN where there is none."""


def bodies_of(run: Run, shapes: Shapes) -> Marks:
    """Bodies: free ones, and those on lines. NaN while a body is on the drum."""
    time = shapes.time
    if not isinstance(run, SystemRun):
        places = np.empty((len(time), 0, 3))
        if "bodies.position" in run.names:
            places = run["bodies.position"][nearest(run.time, time)]
        return Marks("body", ("",) * places.shape[1], places)
    parts = parts_of(run, "bodies", time)
    names, columns = [part.name for part in parts], [part.position for part in parts]
    for line, at in shapes.places.items():
        along = 0.0
        for item in run.scene.lines[line].items:
            if item.cable is not None:
                along += item.cable.length
            elif item.body is not None:
                names.append(item.body.name or "")
                columns.append(_on_line(shapes.s[:, at], shapes.position[:, at], along))
    return Marks("body", tuple(names), _stacked(columns, time))


def _on_line(s: Floats, position: Floats, along: float) -> Floats:
    """Places (nt, 3) at an arc length [m] of a line."""
    return np.array(
        [
            [np.interp(along, row[there], place[there, axis]) for axis in range(3)]
            for row, place, there in zip(s, position, np.isfinite(s), strict=True)
        ]
    )


def touchdowns(run: Run) -> dict[str, Floats]:
    """Touchdown point of every line over a floor (n, 3) [m], by its name; NaN without touchdown."""
    keys = {name: f"{name}.touchdown_position".lstrip(".") for name in run.shapes}
    return {name: run[key] for name, key in keys.items() if key in run.names}


def touchdown_of(run: Run, shapes: Shapes) -> Marks:
    """Where lines meet the floor; NaN without touchdown."""
    found = touchdowns(run)
    columns = [places[nearest(run.time, shapes.time)] for places in found.values()]
    return Marks("touchdown", ("",) * len(found), _stacked(columns, shapes.time))


def held_of(run: Run, shapes: Shapes) -> Marks:
    """What drives or holds the lines: the tow point, or points of vessels, and anchors."""
    if not isinstance(run, SystemRun):
        return Marks("tow point", ("tow point",), shapes.position[:, :1])
    vessels = parts_of(run, "vessels", shapes.time)
    found = {f"{part.name}.{point}": at for part in vessels for point, at in part.points.items()}
    for name, line in run.scene.lines.items():
        for word, end in (("beginning", line.start), ("end", line.end)):
            if end.anchor is not None:
                place = np.broadcast_to(np.asarray(end.anchor), (len(shapes.time), 3))
                found[f"anchor at the {word} of {name}"] = place
    places = _stacked([*found.values()], shapes.time)
    kind = "point of a vessel" if vessels else "anchor"
    return Marks(kind, tuple(found), places)


def names_of(run: Run, shapes: Shapes, bodies: Marks) -> Marks:
    """Names of vessels, at their origins, and of bodies that have one."""
    vessels = parts_of(run, "vessels", shapes.time)
    found = {part.name: part.position for part in vessels}
    found |= {name: bodies.places[:, k] for k, name in enumerate(bodies.names) if name}
    return Marks("name", tuple(found), _stacked([*found.values()], shapes.time))


def skeletons_of(run: Run, time: Floats, size: float) -> Floats:
    """Vessels and free bodies as lines (nt, n, 3) [m], with gaps (NaN): from the origin to every
    point, and of bodies their axes, in proportion to the size of what is seen [m]."""
    lines: list[Floats] = []
    lengths = AXES_SIZE * size * np.array(AXES)
    for kind in ("vessels", "bodies"):
        for part in parts_of(run, kind, time):
            ends = list(part.points.values())
            if kind == "bodies":
                ends += [part.position + lengths[k] * part.axes[..., k] for k in range(3)]
            for end in ends:
                lines += [part.position, end, np.full_like(end, np.nan)]
    return _stacked(lines, time)


def sides_of(seen: Floats) -> Floats:
    """Extent of places (nt, n, k) along each of k axes [m]."""
    return np.asarray(np.nanmax(seen, axis=(0, 1)) - np.nanmin(seen, axis=(0, 1)))


def _stacked(columns: list[Floats], time: Floats) -> Floats:
    """Points over time, each (nt, 3), as one array (nt, n, 3)."""
    return np.stack(columns, axis=1) if columns else np.empty((len(time), 0, 3))


@dataclass(frozen=True)
class Reference:
    """What a picture that follows the motion counts from."""

    name: str
    """In words: ``the tow point``, or a part by its name."""
    place: Floats
    """(nt, 3) [m]"""

    @classmethod
    def of(cls, run: Run, shapes: Shapes) -> Reference:
        """The tow point; of a system its first vessel, or body, or the beginning of its line."""
        for kind in ("vessels", "bodies"):
            for part in parts_of(run, kind, shapes.time):
                return cls(part.name, part.position)
        first = next(iter(shapes.places))
        name = f"the beginning of {first}" if first else "the tow point"
        return cls(name, shapes.position[:, 0])


def start_tensions(run: Run) -> dict[str, Floats]:
    """Tension at the beginning of every line over time (n,) [N]: at the tow point of one line."""
    return {name: run[f"{name}.start_tension"] if name else run.top_tension for name in run.shapes}


def tension_errors(run: Run) -> dict[str, Floats]:
    """What those are estimated to be wrong by (n,) [N], of the lines of which that is known."""
    names = {name: f"{name}.tension_error".lstrip(".") for name in run.shapes}
    found = {name: run[key] for name, key in names.items() if key in run.names}
    return {name: errors for name, errors in found.items() if np.isfinite(errors).any()}


def slack_spans(run: Run) -> list[tuple[float, float]]:
    """From which output to which some of a line has been slack [s]."""
    grew = np.zeros(max(0, len(run.time) - 1), dtype=bool)
    for name in run.shapes:
        key = f"{name}.slack_time".lstrip(".")
        if key in run.names:
            grew |= np.diff(run[key]) > 0.0
    steps = np.diff(np.concatenate([[0], grew.astype(int), [0]]))
    first, last = np.flatnonzero(steps > 0), np.flatnonzero(steps < 0)
    return list(zip(run.time[first].tolist(), run.time[last].tolist(), strict=True))


def start_of(name: str) -> str:
    """Where that tension is, in words."""
    return f"at the beginning of {name}" if name else "at the tow point"


def arc_length_label(run: Run) -> str:
    """Of an axis with the arc lengths of lines."""
    beginning = "its beginning" if isinstance(run, SystemRun) else "the vessel"
    return f"arc length from {beginning} [m]"


def tension_scale(run: Run) -> tuple[float, str]:
    """Newtons in the unit that the run's tensions are shown in, and its symbol."""
    largest = float(np.nanmax(np.abs(run.tension_max), initial=0.0))
    return (1e3, "kN") if largest >= 2e4 else (1.0, "N")


def time_scale(time: Floats) -> tuple[float, str]:
    """Seconds in the unit that a run's times are shown in, and its symbol."""
    return (3600.0, "h") if time[-1] >= 3 * 3600.0 else (1.0, "s")


def nearest(time: Floats, wanted: Floats) -> Indices:
    """Index of the time nearest to each wanted one."""
    after = np.clip(np.searchsorted(time, wanted), 1, max(len(time) - 1, 1))
    before = after - 1
    after = np.minimum(after, len(time) - 1)
    chosen = np.where(wanted - time[before] <= time[after] - wanted, before, after)
    return np.asarray(chosen, np.intp)


def has_states(run: Run) -> bool:
    """Whether there is something to draw."""
    return all(len(states) for states in run.shapes.values())
