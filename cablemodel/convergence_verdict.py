"""What runs of one scene at several tolerances say about its accuracy.

Two runs that both keep their promise are at most the sum of both tolerances apart. Where even the
two finest runs differ by more than half of what the scene's tolerance allows, there is nothing to
judge the others by: between the first and the last such time for the motion, which remembers; at
these times only for tensions, whose peaks in snaps and shocks fall between outputs.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from cablemodel.compare import Difference, looseness

if TYPE_CHECKING:
    from cablemodel.run import Run
    from cablemodel.scene import Scene

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Outcome = Literal["kept", "broken", "unsettled", "failed"]

SETTLED = 0.5
"""Share of the promise by which the two finest runs may differ for the others to be judged."""
_CHEAPER = 0.9
"""Part of the processor time from which on a coarser tolerance is not worth a word."""


@dataclass(frozen=True)
class Row:
    """A run of the scene at one tolerance, and how far it is from the reference."""

    tolerance: float
    processor_time: float = math.nan
    """Of the steps, without start and outputs, for a simulated second [s]."""
    steps: int = 0
    elements: int = 0
    """The most of all outputs."""
    position: Difference | None = None
    """The largest distance from the reference of any place of the line, all run long. None of the
    reference itself, as all that follows, and of a run that failed."""
    top_tension: Difference | None = None
    tension: Difference | None = None
    """Along the line."""
    accuracy: float = math.nan
    """The tolerance that would allow these differences, where they could be judged."""
    broken: str = ""
    """What of the promise the run cannot have kept: positions, tensions, or both; else empty."""
    broken_at: float | None = None
    """First time at which it did not [s]."""
    error: str = ""
    """Why the run failed."""

    @property
    def position_share(self) -> float:
        """The position's difference as a part of what the tolerance allows."""
        return math.nan if self.position is None else self.position.share / self.tolerance

    @property
    def tension_share(self) -> float:
        """The larger of both differences in tension as a part of what the tolerance allows."""
        if self.top_tension is None or self.tension is None:
            return math.nan
        return max(self.top_tension.share, self.tension.share) / self.tolerance


@dataclass(frozen=True)
class Convergence:
    """A scene at several tolerances: what each run costs, and how accurate it is."""

    tolerance: float
    """The scene's own."""
    rows: tuple[Row, ...]
    """From the coarsest to the finest, without the reference."""
    reference: Row
    outcome: Outcome
    """What can be said of the run at the scene's tolerance."""
    conclusion: str
    """The same in one sentence."""
    notes: tuple[str, ...] = ()
    """What to know about the comparison, a sentence each."""
    unsettled: tuple[float, float] | None = None
    """First and last time between which the motion cannot be judged [s]."""

    @property
    def passed(self) -> bool:
        """Whether the run keeps the promise of the scene's tolerance, as far as it goes."""
        return self.outcome == "kept"

    @property
    def own(self) -> Row:
        """The run at the scene's tolerance."""
        every = (*self.rows, self.reference)
        return next(row for row in every if row.tolerance == self.tolerance)


@dataclass(frozen=True)
class Series:
    """Values over time, each the tolerance that would allow the difference there."""

    time: Floats
    values: Floats

    def over(self, limit: float) -> Flags:
        """Where the differences are larger than a tolerance allows, or no numbers."""
        return ~(self.values <= limit)


@dataclass(frozen=True)
class Apart:
    """How far a run is from the reference."""

    position: Difference
    top_tension: Difference
    tension: Difference
    motion: Series
    tensions: tuple[Series, Series]
    """At the top, at every output; along the line, where there are states."""

    @classmethod
    def of(cls, run: Run, reference: Run) -> Apart:
        """Compare two runs of the same outputs. Scales are those of the reference."""
        one, other = reference.states, run.states
        length = np.interp(one.time, reference.time, reference["line_length"])
        # Of the whole run, either way: what a tension may be wrong by does not come and go.
        pulls = (reference.tension_max, reference.tension_min, reference.top_tension)
        pull = looseness("N") * max(float(np.max(np.abs(values))) for values in pulls)
        pull = max(pull, float(np.finfo(float).tiny))
        tolerance = run.scene.solver.tolerance
        distance = np.linalg.norm(other.position - one.position, axis=2)
        along = np.abs(other.tension - one.tension)
        top = np.abs(run.top_tension - reference.top_tension)[:, None]
        return cls(
            _largest("position", "m", tolerance, one.time, distance, length, one.s),
            _largest("top_tension", "N", tolerance, reference.time, top, np.full(len(top), pull)),
            _largest("tension", "N", tolerance, one.time, along, np.full(len(along), pull), one.s),
            Series(one.time, distance.max(axis=1) / length),
            (Series(reference.time, top[:, 0] / pull), Series(one.time, along.max(axis=1) / pull)),
        )


def _largest(
    name: str,
    unit: str,
    tolerance: float,
    times: Floats,
    apart: Floats,
    scales: Floats,
    s: Floats | None = None,
) -> Difference:
    """The largest of differences (n, places) at times and arc lengths, on the scale of its time."""
    k, place = np.unravel_index(int(np.argmax(apart)), apart.shape)
    return Difference(
        name,
        unit,
        allowed=tolerance * float(scales[k]),
        scale=float(scales[k]),
        largest=float(apart[k, place]),
        time=float(times[k]),
        arc_length=None if s is None else float(s[k, place]),
    )


@dataclass(frozen=True)
class Settled:
    """Where the two finest runs agree well enough to judge the others by."""

    begin: float
    end: float
    """Of the runs [s]."""
    span: tuple[float, float] | None
    """First and last time between which the motion is not settled [s]."""
    tensions: tuple[Flags, Flags]
    """Whether the tension at the top is settled, and along the line, at the times of its series."""
    snaps: Floats
    """Times at which one of them is not [s]."""

    @classmethod
    def of(cls, fine: Apart, limit: float) -> Settled:
        """What a tolerance of ``limit`` allows the two finest runs to differ by."""
        time = fine.motion.time
        off = time[_near(fine.motion.over(limit))]
        span = (float(off[0]), float(off[-1])) if off.size else None
        inside = [~_outside(span, series.time) for series in fine.tensions]
        snaps = [_near(series.over(limit)) for series in fine.tensions]
        top, along = (~(in_span | snap) for in_span, snap in zip(inside, snaps, strict=True))
        at = [series.time[~ok] for series, ok in zip(fine.tensions, (top, along), strict=True)]
        return cls(float(time[0]), float(time[-1]), span, (top, along), np.union1d(*at))

    def judge(self, row: Row, apart: Apart, limit: float) -> Row:
        """A row with the differences of its run, and whether they are within a tolerance."""
        accuracy, since, broken = 0.0, math.inf, []
        names = ("positions", "tensions", "tensions")
        settled = (_outside(self.span, apart.motion.time), *self.tensions)
        every = (apart.motion, *apart.tensions)
        for name, series, where in zip(names, every, settled, strict=True):
            accuracy = max(accuracy, float(np.max(series.values[where], initial=0.0)))
            off = series.time[where & series.over(limit)]
            if off.size:
                since = min(since, float(off[0]))
                broken.append(name)
        return replace(
            row,
            position=apart.position,
            top_tension=apart.top_tension,
            tension=apart.tension,
            accuracy=accuracy,
            broken=" and ".join(dict.fromkeys(broken)),
            broken_at=since if broken else None,
        )


def _near(flags: Flags) -> Flags:
    """Where a flag or a neighbour of it is set: a coarser run may be an output early or late."""
    wide = flags.copy()
    wide[1:] |= flags[:-1]
    wide[:-1] |= flags[1:]
    return wide


def _outside(span: tuple[float, float] | None, time: Floats) -> Flags:
    first, last = span or (math.inf, math.inf)
    return (time < first) | (time > last)


def conclude(
    scene: Scene, done: Mapping[float, Row], reference: Row, apart: Mapping[float, Apart]
) -> Convergence:
    """Judge the runs of a scene.

    Args:
        done: a row for each tolerance, without differences.
        reference: one of them, the finest that came to its end.
        apart: how far the others are from it that did.
    """
    own, finest = scene.solver.tolerance, reference.tolerance
    rows, settled = dict(done), None
    if apart:
        fine = min(apart)
        settled = Settled.of(apart[fine], max(SETTLED * own, fine + finest))
        for tolerance, found in apart.items():
            rows[tolerance] = settled.judge(done[tolerance], found, tolerance + finest)
    order = sorted(rows, reverse=True)
    listed = tuple(rows[tolerance] for tolerance in order if tolerance != finest)
    outcome, sentence = _verdict(own, listed, reference, settled)
    notes = tuple(_notes(scene, order[-1], reference, apart, settled))
    span = settled.span if settled is not None else None
    return Convergence(own, listed, reference, outcome, sentence, notes, span)


def _verdict(
    own: float, rows: tuple[Row, ...], reference: Row, settled: Settled | None
) -> tuple[Outcome, str]:
    found = next(row for row in (*rows, reference) if row.tolerance == own)
    good = [row for row in rows if not row.error]
    run = f"At its tolerance of {own:g} the run"
    if found.error:
        others = ", ".join(f"{row.tolerance:g}" for row in (*good, reference))
        return "failed", f"{run} fails; it comes to its end at {others}."
    if found is reference or settled is None:
        return "failed", f"{run} has nothing to be judged by: no finer one comes to its end."
    enough = [row for row in good if row.accuracy <= own + reference.tolerance]
    share = f"{found.accuracy / own:.2g}"
    unsettled = _unsettled(own, min(good, key=lambda row: row.tolerance), reference, settled)
    if found.broken:
        finer = [f"{row.tolerance:g}" for row in enough if row.tolerance < own]
        keeps = finer[0] if finer else "none of the others"
        sentence = (
            f"{run} does not keep the promise: from t = {found.broken_at:g} s on {found.broken} "
            f"are off by up to {share} times what it allows; {keeps} keeps the accuracy that was "
            "asked for."
        )
        return "broken", f"{sentence} {unsettled}".rstrip()
    if unsettled:
        whole = settled.span == (settled.begin, settled.end)
        return "unsettled", unsettled if whole else f"{unsettled} Else the run keeps the promise."
    sentence = f"{run} keeps the promise, off by {share} of what it allows"
    ratio = enough[0].processor_time / found.processor_time
    if enough[0].tolerance > own and ratio < _CHEAPER:
        sentence += f"; {enough[0].tolerance:g} would do, for {ratio:.2g} of the processor time"
    return "kept", f"{sentence}."


def _unsettled(own: float, fine: Row, reference: Row, settled: Settled) -> str:
    """Where nothing can be said about the motion, in a sentence; empty if there is no such time."""
    if settled.span is None or fine.position is None:
        return ""
    first, last = settled.span
    when = f"from t = {first:g} s on" if last >= settled.end else f"at t = {first:g} to {last:g} s"
    apart, share = fine.position.largest, fine.position.share / own
    return (
        f"The motion does not converge {when}: even the runs at {fine.tolerance:g} and "
        f"{reference.tolerance:g} are up to {apart:.2g} m apart, {share:.2g} times what {own:g} "
        "allows."
    )


def _notes(
    scene: Scene,
    finest: float,
    reference: Row,
    apart: Mapping[float, Apart],
    settled: Settled | None,
) -> Iterator[str]:
    if finest != reference.tolerance:
        yield f"The run at {finest:g} failed: the others are compared with {reference.tolerance:g}."
    if settled is not None and settled.snaps.size:
        count = len(next(iter(apart.values())).tensions[0].time)
        yield (
            f"Tensions at {settled.snaps.size} of {count} outputs are not judged, the first at "
            f"t = {settled.snaps[0]:g} s: there the two finest runs differ by more than half the "
            "promise, as in snaps and shocks. The table has the differences at all of them."
        )
    if any(item.cable.elements for item in (*scene.line, *scene.payout.drum) if item.cable):
        yield (
            "The line gives elements: its mesh is the same at all tolerances, and what that is "
            "wrong by is not seen."
        )
