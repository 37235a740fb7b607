"""How far runs are from a reference over time, and where that can be judged.

Where even the two finest runs differ by more than half of what is asked of the scene, there
is nothing to judge the others by: between the first and the last such time for the motion, which
remembers; at these times only for tensions. Those are promised while the line is taut: snaps peak
between any two outputs, and the ringing that they leave is damped by the steps, which are chosen by
positions.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.results.compare import Difference
from cablemodel.results.promise import largest_tension, looseness, taut_until

if TYPE_CHECKING:
    from cablemodel.results.run import Run

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class Series:
    """Values over time, each the tolerance that would allow the difference there."""

    time: Floats
    values: Floats

    def over(self, limit: float) -> Flags:
        """Where the differences are larger than a tolerance allows, or no numbers."""
        return ~(self.values <= limit)


@dataclass(frozen=True)
class Deviation:
    """How far a run is from the reference."""

    position: Difference
    top_tension: Difference
    tension: Difference
    motion: Series
    tensions: tuple[Series, Series]
    """At the top, at every output; along the line, where there are states."""
    taut_until: float
    """First time at which one of the runs is slack [s]; infinite if none is."""

    @classmethod
    def of(cls, run: Run, reference: Run) -> Deviation:
        """Compare two runs of the same outputs. Scales are those of the reference."""
        one, other = reference.states, run.states
        length = np.interp(one.time, reference.time, reference["line_length"])
        pulls = reference.tension_max, reference.tension_min, reference.top_tension
        largest = largest_tension(*pulls)
        pull = max(looseness("N") * largest, float(np.finfo(float).tiny))
        lowest = np.minimum(run.tension_min, reference.tension_min)
        tolerance = run.scene.solver.promised
        distance = np.linalg.norm(other.position - one.position, axis=2)
        along = np.abs(other.tension - one.tension)
        top = np.abs(run.top_tension - reference.top_tension)[:, None]
        return cls(
            _largest("position", "m", tolerance, one.time, distance, length, one.s),
            _largest("top_tension", "N", tolerance, reference.time, top, np.full(len(top), pull)),
            _largest("tension", "N", tolerance, one.time, along, np.full(len(along), pull), one.s),
            Series(one.time, distance.max(axis=1) / length),
            (Series(reference.time, top[:, 0] / pull), Series(one.time, along.max(axis=1) / pull)),
            taut_until(reference.time, lowest, largest),
        )


def _largest(
    name: str,
    unit: str,
    tolerance: float,
    times: Floats,
    deviation: Floats,
    scales: Floats,
    s: Floats | None = None,
) -> Difference:
    """The largest of differences (n, places) at times and arc lengths, on the scale of its time."""
    k, place = np.unravel_index(int(np.argmax(deviation)), deviation.shape)
    return Difference(
        name,
        unit,
        allowed=tolerance * float(scales[k]),
        scale=float(scales[k]),
        largest=float(deviation[k, place]),
        time=float(times[k]),
        arc_length=None if s is None else float(s[k, place]),
    )


@dataclass(frozen=True)
class Judgement:
    """How accurate a run is, where that can be judged."""

    accuracy: float
    """The tolerance that would allow its differences from the reference."""
    broken: str = ""
    """What of its promise it cannot have kept: positions, tensions, or both; else empty."""
    broken_at: float | None = None
    """First time at which it did not [s]."""


@dataclass(frozen=True)
class Settled:
    """Where the two finest runs agree well enough to judge the others by."""

    begin: float
    end: float
    """Of the runs [s]."""
    span: tuple[float, float] | None
    """First and last time between which the motion is not settled [s]."""
    deviation: float
    """The tolerance that would allow the motion's differences between them."""
    taut_until: float
    """Time from which on tensions are not promised [s]; infinite if there is none."""
    tensions: tuple[Flags, Flags]
    """Whether the tension at the top is settled, and along the line, at the times of its series."""
    snaps: Floats
    """Times before that at which one of them is not [s]."""

    @classmethod
    def of(cls, fine: Deviation, limit: float, *, static: bool) -> Settled:
        """What a tolerance of ``limit`` allows the two finest runs to differ by.

        ``static``: the line starts in equilibrium; else it rings from the start.
        """
        time = fine.motion.time
        off = time[_near(fine.motion.over(limit))]
        span = (float(off[0]), float(off[-1])) if off.size else None
        deviation = float(np.max(fine.motion.values[~_outside(span, time)], initial=0.0))
        taut_until = fine.taut_until if static else float(time[0])
        top, along = (
            _outside(span, series.time) & ~_near(series.over(limit)) for series in fine.tensions
        )
        at = [series.time[~ok] for series, ok in zip(fine.tensions, (top, along), strict=True)]
        snaps = np.union1d(*at)
        snaps = snaps[snaps < taut_until]
        return cls(
            float(time[0]), float(time[-1]), span, deviation, taut_until, (top, along), snaps
        )

    def judge(self, deviation: Deviation, limit: float) -> Judgement:
        """Whether the differences of a run are within a tolerance, where they can be judged."""
        taut_until = min(self.taut_until, deviation.taut_until)
        settled = [_outside(self.span, deviation.motion.time)]
        for series, where in zip(deviation.tensions, self.tensions, strict=True):
            settled.append(where & (series.time < taut_until))
        accuracy, since, broken = 0.0, math.inf, []
        names = ("positions", "tensions", "tensions")
        every = (deviation.motion, *deviation.tensions)
        for name, series, where in zip(names, every, settled, strict=True):
            accuracy = max(accuracy, float(np.max(series.values[where], initial=0.0)))
            off = series.time[where & series.over(limit)]
            if off.size:
                since = min(since, float(off[0]))
                broken.append(name)
        return Judgement(accuracy, " and ".join(dict.fromkeys(broken)), since if broken else None)


def _near(flags: Flags) -> Flags:
    """Where a flag or a neighbour of it is set: a coarser run may be an output early or late."""
    wide = flags.copy()
    wide[1:] |= flags[:-1]
    wide[:-1] |= flags[1:]
    return wide


def _outside(span: tuple[float, float] | None, time: Floats) -> Flags:
    first, last = span or (math.inf, math.inf)
    return (time < first) | (time > last)
