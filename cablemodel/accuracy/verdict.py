"""What runs of one scene at several tolerances say about its accuracy.

Two runs that both keep their promise are at most the sum of both tolerances apart.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

from cablemodel.accuracy.deviation import Deviation, Settled
from cablemodel.results.promise import tensions_promised

if TYPE_CHECKING:
    from cablemodel.results.compare import Difference
    from cablemodel.scene import Scene
    from cablemodel.scene.schema import Solver

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
    asked: float | None = None
    """The accuracy that the scene asks for, if that is not the tolerance."""

    @property
    def promised(self) -> float:
        """What the run is judged by: the tolerance, or the accuracy that is asked for."""
        return self.tolerance if self.asked is None else self.asked

    @property
    def position_share(self) -> float:
        """The position's difference as a part of what is allowed."""
        return math.nan if self.position is None else self.position.share / self.promised

    @property
    def tension_share(self) -> float:
        """The larger of both differences in tension as a part of what is allowed."""
        if self.top_tension is None or self.tension is None:
            return math.nan
        return max(self.top_tension.share, self.tension.share) / self.promised


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


def conclude(
    scene: Scene, done: Mapping[float, Row], reference: Row, deviation: Mapping[float, Deviation]
) -> Convergence:
    """Judge the runs of a scene.

    Args:
        done: a row for each tolerance, without differences.
        reference: one of them, the finest that came to its end.
        apart: how far the others are from it that did.
    """
    own, asked, finest = scene.solver.tolerance, scene.solver.promised, reference.tolerance
    rows, settled = dict(done), None
    if deviation:
        fine = min(deviation)
        settled = Settled.of(
            deviation[fine], max(SETTLED * asked, fine + finest), static=tensions_promised(scene)
        )
        for tolerance, found in deviation.items():
            judged = settled.judge(found, done[tolerance].promised + finest)
            rows[tolerance] = replace(
                done[tolerance],
                position=found.position,
                top_tension=found.top_tension,
                tension=found.tension,
                accuracy=judged.accuracy,
                broken=judged.broken,
                broken_at=judged.broken_at,
            )
    order = sorted(rows, reverse=True)
    listed = tuple(rows[tolerance] for tolerance in order if tolerance != finest)
    outcome, sentence = _verdict(scene.solver, listed, reference, settled)
    notes = tuple(_notes(scene, order[-1], reference, deviation, settled))
    span = settled.span if settled is not None else None
    return Convergence(own, listed, reference, outcome, sentence, notes, span)


def _verdict(
    solver: Solver, rows: tuple[Row, ...], reference: Row, settled: Settled | None
) -> tuple[Outcome, str]:
    own, asked = solver.tolerance, solver.promised
    promise = "the promise" if solver.accuracy is None else solver.asked
    found = next(row for row in (*rows, reference) if row.tolerance == own)
    good = [row for row in rows if not row.error]
    run = f"At its tolerance of {own:g} the run"
    if found.error:
        others = ", ".join(f"{row.tolerance:g}" for row in (*good, reference))
        return "failed", f"{run} fails; it comes to its end at {others}."
    if found is reference or settled is None:
        return "failed", f"{run} has nothing to be judged by: no finer one comes to its end."
    enough = [row for row in good if row.accuracy <= asked + reference.tolerance]
    share = f"{found.accuracy / asked:.2g}"
    unsettled = _unsettled(asked, min(good, key=lambda row: row.tolerance), reference, settled)
    if found.broken:
        finer = [f"{row.tolerance:g}" for row in enough if row.tolerance < own]
        keeps = finer[0] if finer else "none of the others"
        sentence = (
            f"{run} does not keep {promise}: from t = {found.broken_at:g} s on {found.broken} "
            f"are off by up to {share} times what it allows; {keeps} keeps the accuracy that was "
            "asked for."
        )
        return "broken", f"{sentence} {unsettled}".rstrip()
    if unsettled:
        whole = settled.span == (settled.begin, settled.end)
        return "unsettled", unsettled if whole else f"{unsettled} Else the run keeps {promise}."
    kept = promise
    if settled.taut_until <= settled.begin:
        kept = f"{promise} of positions"
    elif math.isfinite(settled.taut_until):
        kept = f"{promise} (of tensions until t = {settled.taut_until:g} s)"
    sentence = f"{run} keeps {kept}, off by {share} of what it allows"
    ratio = enough[0].processor_time / found.processor_time
    if enough[0].tolerance > own and ratio < _CHEAPER:
        sentence += f"; {enough[0].tolerance:g} would do, for {ratio:.2g} of the processor time"
    return "kept", f"{sentence}."


def _unsettled(asked: float, fine: Row, reference: Row, settled: Settled) -> str:
    """Where nothing can be said about the motion, in a sentence; empty if there is no such time."""
    if settled.span is None:
        return ""
    first, last = settled.span
    when = f"from t = {first:g} s on" if last >= settled.end else f"at t = {first:g} to {last:g} s"
    return (
        f"The motion does not converge {when}: even the runs at {fine.tolerance:g} and "
        f"{reference.tolerance:g} differ by up to {settled.deviation / asked:.2g} times what "
        f"{asked:g} allows."
    )


def _notes(
    scene: Scene,
    finest: float,
    reference: Row,
    deviation: Mapping[float, Deviation],
    settled: Settled | None,
) -> Iterator[str]:
    if finest != reference.tolerance:
        yield f"The run at {finest:g} failed: the others are compared with {reference.tolerance:g}."
    if scene.solver.accuracy_of == "positions":
        yield "Tensions are not judged: the scene asks for positions."
    elif settled is not None and settled.taut_until <= settled.begin:
        yield "Tensions are not judged: the line starts out of equilibrium, or slack, and rings."
    elif settled is not None:
        if math.isfinite(settled.taut_until):
            yield (
                f"Tensions are judged until t = {settled.taut_until:g} s only: then the line is "
                "slack, and snaps and what they leave are not promised."
            )
        if settled.snaps.size:
            count = len(next(iter(deviation.values())).tensions[0].time)
            yield (
                f"Tensions at {settled.snaps.size} of {count} outputs are not judged, the first at "
                f"t = {settled.snaps[0]:g} s: there even the two finest runs differ by more than "
                "half the promise, as in shocks, or one of them is an output late."
            )
    if any(item.cable.elements for item in scene.line_and_drum if item.cable):
        yield (
            "The line gives elements: its mesh is the same at all tolerances, and what that is "
            "wrong by is not seen."
        )
