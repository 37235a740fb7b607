"""Thin a run to what a screen can show, without losing its peaks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.results.compare import SAME_TIME
from cablemodel.views.drawing import (
    Marks,
    Reference,
    Shapes,
    bodies_of,
    held_of,
    names_of,
    nearest,
    sides_of,
    skeletons_of,
    stations_of,
)

if TYPE_CHECKING:
    from cablemodel.model import CableState
    from cablemodel.results.run import Run
    from cablemodel.results.states import States

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

FRAMES = 500
"""Instants of the animation and of the heat maps at most."""
MOST_STATIONS = 201
"""Points of a line."""
_SAME_PLACE = 1e-9
"""Part of its length by which a line may end before a station that is its end."""
BUCKETS = 1000
"""A curve over time has at most two points in each of this many stretches."""


@dataclass(frozen=True)
class Frames:
    """A run at instants spaced as evenly as its outputs allow, at stations spaced evenly in s."""

    shapes: Shapes
    """All lines."""
    reference: Reference
    """What x and y count from where the view follows it."""
    held: Marks
    """The tow point, or points of vessels, and anchors."""
    bodies: Marks
    names: Marks
    """Of vessels and bodies."""
    skeletons: Floats
    """Vessels and free bodies as lines (nf, n, 3) [m], with gaps (NaN)."""

    @classmethod
    def of(cls, run: Run, count: int = FRAMES) -> Frames:
        states = next(iter(run.shapes.values()))
        shapes = Shapes.of(run, evenly_spaced(states.time, count), most=MOST_STATIONS)
        reference, bodies = Reference.of(run, shapes), bodies_of(run, shapes)
        seen = shapes.position - reference.place[:, None]
        return cls(
            shapes,
            reference,
            held_of(run, shapes),
            bodies,
            names_of(run, shapes, bodies),
            skeletons_of(run, shapes.time, float(np.max(sides_of(seen)))),
        )

    @property
    def time(self) -> Floats:
        """(nf,) [s]"""
        return self.shapes.time

    @property
    def ground(self) -> Floats:
        """x and y of the reference, and z = 0 (nf, 3) [m]."""
        return np.asarray(self.reference.place * [1.0, 1.0, 0.0])


@dataclass(frozen=True)
class Extreme:
    """An extreme over the cable and all output times."""

    value: float
    time: float
    """[s]"""
    s: float
    """Arc length from the beginning of the line [m]; NaN where no state tells it."""


@dataclass(frozen=True)
class Field:
    """One quantity along the cable, over the whole run."""

    values: Floats
    """At the frames and stations (nf, n); NaN where there is no cable."""
    ends: Floats
    """At the far end of the line, which lies between stations, at the frames (nf,)."""
    lower: Floats
    """Lowest (n,) and ..."""
    upper: Floats
    """... highest value at each station, of all output times."""
    lowest: Extreme
    highest: Extreme


@dataclass(frozen=True)
class Along:
    """Quantities at fixed stations along a line, along all of it that may ever be out."""

    time: Floats
    """(nf,) [s]"""
    s: Floats
    """(n,) [m]"""
    ends: Floats
    """Arc length of the far end at the frames (nf,) [m]."""
    tension: Field
    curvature: Field
    bending_moment: Field

    @classmethod
    def of(cls, run: Run, line: str = "", count: int = FRAMES) -> Along:
        states = run.shapes[line]
        frames = evenly_spaced(states.time, count)
        everything = list(states)
        longest = max(float(state.s[-1]) for state in everything)
        s = np.linspace(0.0, longest, stations_of(states, MOST_STATIONS))
        fields = {
            name: _field(everything, name, s, frames)
            for name in ("tension", "curvature", "bending_moment")
        }
        tension = fields["tension"]
        lowest, highest = run.tension_min, run.tension_max
        if line:
            lowest, highest = run[f"{line}.tension_min"], run[f"{line}.tension_max"]
        # What `run`, `stats` and all other outputs say: at nodes the two sides differ, and in long
        # runs there are fewer states than outputs.
        fields["tension"] = replace(
            tension,
            lowest=_of_outputs(run.time, lowest, states, np.argmin),
            highest=_of_outputs(run.time, highest, states, np.argmax),
        )
        ends = np.array([float(everything[frame].s[-1]) for frame in frames])
        return cls(states.time[frames], s, ends, **fields)


def _of_outputs(
    times: Floats, values: Floats, states: States, which: Callable[[Floats], np.intp]
) -> Extreme:
    """The extreme tension of all outputs; its place is that of the node nearest to it."""
    row = int(which(values))
    time, state = float(times[row]), int(nearest(states.time, times[row : row + 1])[0])
    s = float("nan")
    if abs(states.time[state] - time) <= SAME_TIME:
        there = states[state]
        s = float(there.s[which(there.tension)])
    return Extreme(float(values[row]), time, s)


def _field(states: list[CableState], name: str, s: Floats, frames: Indices) -> Field:
    """Everything about one quantity, from every node of every state."""
    table = np.stack([_at(s, state, name) for state in states])
    ever = ~np.all(np.isnan(table), axis=0)
    lower, upper = (np.full(len(s), np.nan) for _ in range(2))
    lower[ever] = np.nanmin(table[:, ever], axis=0)
    upper[ever] = np.nanmax(table[:, ever], axis=0)
    # Extremes are those of the nodes: stations lie between them.
    lows = [int(np.argmin(getattr(state, name))) for state in states]
    highs = [int(np.argmax(getattr(state, name))) for state in states]
    low = int(np.argmin([getattr(state, name)[k] for state, k in zip(states, lows, strict=True)]))
    high = int(np.argmax([getattr(state, name)[k] for state, k in zip(states, highs, strict=True)]))
    return Field(
        table[frames],
        np.array([float(getattr(states[frame], name)[-1]) for frame in frames]),
        lower,
        upper,
        _extreme(states[low], name, lows[low]),
        _extreme(states[high], name, highs[high]),
    )


def _at(s: Floats, state: CableState, name: str) -> Floats:
    """A quantity at stations (n,); NaN beyond the end, but for what rounding puts there."""
    end = float(state.s[-1])
    at = np.where(s <= end * (1.0 + _SAME_PLACE), np.minimum(s, end), s)
    return np.asarray(np.interp(at, state.s, getattr(state, name), left=np.nan, right=np.nan))


def _extreme(state: CableState, name: str, node: int) -> Extreme:
    return Extreme(float(getattr(state, name)[node]), state.time, float(state.s[node]))


def evenly_spaced(time: Floats, count: int) -> Indices:
    """Indices of at most ``count`` times, as evenly spaced as can be; first and last included."""
    if len(time) <= count:
        return np.arange(len(time))
    return np.unique(nearest(time, np.linspace(time[0], time[-1], count)))


def thinned(values: Floats, buckets: int = BUCKETS) -> Indices:
    """Indices that a curve can be drawn from: the lowest and the highest of every stretch, so that
    no peak is lost, and the first and the last value. NaN stay where a stretch has nothing else."""
    count = len(values)
    if count <= 2 * buckets:
        return np.arange(count)
    width = -(-count // buckets)
    padded = np.concatenate([values, np.full(width * buckets - count, np.nan)])
    stretches = padded.reshape(buckets, width)
    begin = np.arange(buckets) * width
    low = begin + np.argmin(np.where(np.isnan(stretches), np.inf, stretches), axis=1)
    high = begin + np.argmax(np.where(np.isnan(stretches), -np.inf, stretches), axis=1)
    kept = np.unique(np.concatenate([[0], low, high, [count - 1]]))
    return kept[kept < count]
