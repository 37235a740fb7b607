"""Thin a run to what a screen can show, without losing its peaks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.compare import SAME_TIME

if TYPE_CHECKING:
    from cablemodel.model import CableState
    from cablemodel.run import Run

Floats = NDArray[np.float64]
Indices = NDArray[np.intp]

FRAMES = 500
"""Instants of the animation and of the heat maps at most."""
STATIONS = 101
"""Points of a shape at least."""
MOST_STATIONS = 201
_SAME_PLACE = 1e-9
"""Part of its length by which a line may end before a station that is its end."""
BUCKETS = 1000
"""A curve over time has at most two points in each of this many stretches."""


@dataclass(frozen=True)
class Frames:
    """A run at instants spaced as evenly as its outputs allow, at stations spaced evenly in s."""

    time: Floats
    """(nf,) [s]"""
    s: Floats
    """Unstretched arc length from the vessel (nf, n) [m]."""
    position: Floats
    """(nf, n, 3) [m], east, north, up."""
    tension: Floats
    """(nf, n) [N]"""
    bodies: Floats
    """Positions (nf, bodies, 3) [m]; NaN while a body is on the drum."""

    @classmethod
    def of(cls, run: Run, count: int = FRAMES) -> Frames:
        states = run.states
        chosen = evenly_spaced(states.time, count)
        most_nodes = max(len(states[index].s) for index in chosen)
        even = states.chosen(chosen).resampled(min(max(most_nodes, STATIONS), MOST_STATIONS))
        bodies = np.empty((len(chosen), 0, 3))
        if "bodies.position" in run.names:
            bodies = run["bodies.position"][nearest(run.time, even.time)]
        return cls(even.time, even.s, even.position, even.tension, bodies)

    @property
    def tow_point(self) -> Floats:
        """(nf, 3) [m]"""
        return self.position[:, 0]


@dataclass(frozen=True)
class Extreme:
    """An extreme over the cable and all output times."""

    value: float
    time: float
    """[s]"""
    s: float
    """Arc length from the vessel [m]; NaN where no state tells it."""


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
    """Quantities at fixed stations along the cable that may ever be out."""

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
    def of(cls, run: Run, count: int = FRAMES) -> Along:
        states = run.states
        frames = evenly_spaced(states.time, count)
        everything = list(states)
        longest = max(float(state.s[-1]) for state in everything)
        nodes = max(len(state.s) for state in everything)
        s = np.linspace(0.0, longest, min(max(nodes, STATIONS), MOST_STATIONS))
        fields = {
            name: _field(everything, name, s, frames)
            for name in ("tension", "curvature", "bending_moment")
        }
        tension = fields["tension"]
        # What `run`, `stats` and all other outputs say: at nodes the two sides differ, and in long
        # runs there are fewer states than outputs.
        fields["tension"] = replace(
            tension,
            lowest=_of_outputs(run, run.tension_min, np.argmin),
            highest=_of_outputs(run, run.tension_max, np.argmax),
        )
        ends = np.array([float(everything[frame].s[-1]) for frame in frames])
        return cls(states.time[frames], s, ends, **fields)


def _of_outputs(run: Run, values: Floats, which: Callable[[Floats], np.intp]) -> Extreme:
    """The extreme tension of all outputs; its place is that of the node nearest to it."""
    row = int(which(values))
    time, state = float(run.time[row]), int(nearest(run.states.time, run.time[row : row + 1])[0])
    s = float("nan")
    if abs(run.states.time[state] - time) <= SAME_TIME:
        there = run.states[state]
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


def nearest(time: Floats, wanted: Floats) -> Indices:
    """Index of the time nearest to each wanted one."""
    after = np.clip(np.searchsorted(time, wanted), 1, max(len(time) - 1, 1))
    before = after - 1
    after = np.minimum(after, len(time) - 1)
    chosen = np.where(wanted - time[before] <= time[after] - wanted, before, after)
    return np.asarray(chosen, np.intp)


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
