"""What a tolerance promises, and whether a run that estimates its own errors keeps it.

A tolerance tau promises positions within tau L, L the length of the line, and tensions within 10
tau of the largest one of the run, while the line is taut: snaps peak between any two outputs, and
the ringing that they leave is damped by the steps, which are chosen by positions. A scene that
gives ``solver.accuracy`` is judged by that in place of the tolerance at which it is computed.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.protocol import FINER

if TYPE_CHECKING:
    from cablemodel.results.run import Run
    from cablemodel.scene import Scene
    from cablemodel.scene.schema import Solver
    from cablemodel.systems import SystemScene

Floats = NDArray[np.float64]

_LOOSE = {"m": 1.0, "1/m": 100.0, "N.m": 100.0}
"""Multiples of the tolerance by unit. It is the accuracy of positions; tensions and all else are
as accurate as 10 times it, and curvatures, being second derivatives, as 100 times it."""
_LOOSE_OTHERWISE = 10.0
PUSHES = 0.01
"""Compression over the largest tension from which on a line counts as slack."""


def looseness(unit: str) -> float:
    """How many times the tolerance a quantity of this unit may be wrong by."""
    return _LOOSE.get(unit, _LOOSE_OTHERWISE)


def tensions_promised(scene: Scene | SystemScene) -> bool:
    """Whether tensions are promised as long as the line is taut: not if it starts out of
    equilibrium, and rings, nor if they are not asked for."""
    return scene.starts_at_rest and scene.solver.accuracy_of == "all"


def largest_tension(*pulls: Floats) -> float:
    """Of tensions of a whole run, either way [N]: what one may be wrong by does not come and go."""
    return max(float(np.max(np.abs(values))) for values in pulls)


def taut_until(time: Floats, lowest: Floats, largest: float) -> float:
    """First time at which a line is slack [s], infinite if there is none.

    Args:
        time: of the outputs (n,) [s].
        lowest: tension along the line at these times (n,) [N].
        largest: tension of the run [N].
    """
    slack = time[lowest < -PUSHES * largest]
    return float(slack[0]) if slack.size else math.inf


@dataclass(frozen=True)
class EstimatedError:
    """Of one quantity, over a run; while the promise holds for it."""

    largest: float
    """In the quantity's unit; not a number where no output has an estimate."""
    time: float
    """When that was [s]."""
    share: float
    """Of what the tolerance allows: the largest one of the run."""
    broken_at: float | None
    """First time at which it was larger than that [s]."""

    @classmethod
    def of(cls, time: Floats, errors: Floats, allowed: Floats) -> EstimatedError:
        """From errors (n,) at times (n,) [s] and what is allowed there (n,)."""
        known = np.isfinite(errors)
        time, errors, shares = time[known], errors[known], errors[known] / allowed[known]
        if not errors.size:
            return cls(math.nan, math.nan, math.nan, None)
        worst, off = int(np.argmax(errors)), time[shares > 1.0]
        first = float(off[0]) if off.size else None
        return cls(float(errors[worst]), float(time[worst]), float(shares.max()), first)


@dataclass(frozen=True)
class PartOfRun:
    """A line or a body of a run that estimates its own errors, over its n outputs."""

    name: str
    """Empty where there is one line only."""
    length: Floats
    """What a tolerance promises positions as a part of (n,) [m]."""
    position_error: Floats
    """(n,) [m]."""
    tension_error: Floats | None = None
    """Of the tensions that are promised (n,) [N]; None: the part has none."""
    pulls: tuple[Floats, ...] = ()
    """Lowest tensions along it first, then others whose largest counts, each (n,) [N]."""


@dataclass(frozen=True)
class PartEstimate:
    """What a run says of the errors of one of its lines or bodies."""

    name: str
    """Empty where there is one line only."""
    position: EstimatedError
    """Anywhere along it [m]."""
    tension: EstimatedError
    """At its ends, of one line below a vessel at the tow point, while tensions are promised [N]."""
    taut_until: float
    """Time from which on tensions are not promised [s]: the line is slack, or starts out of
    equilibrium and rings, or they are not asked for; infinite if there is none."""

    @property
    def positions(self) -> str:
        """Of what `position` is, in words."""
        return f"positions of {self.name}" if self.name else "positions"

    @property
    def tensions(self) -> str:
        """Of what `tension` is, in words."""
        return f"tensions at the ends of {self.name}" if self.name else "the top tension"

    @classmethod
    def of(cls, part: PartOfRun, time: Floats, scene: Scene | SystemScene) -> PartEstimate:
        """Of a part of a run of a scene, with outputs at times (n,) [s]."""
        promised = scene.solver.promised
        position = EstimatedError.of(time, part.position_error, promised * part.length)
        taut, errors = float(time[0]), part.tension_error
        if errors is None:
            return cls(part.name, position, EstimatedError.of(*np.zeros((3, 0))), taut)
        largest = largest_tension(*part.pulls)
        if tensions_promised(scene):
            taut = taut_until(time, part.pulls[0], largest)
        judged = time < taut
        pull = max(looseness("N") * promised * largest, float(np.finfo(float).tiny))
        allowed = np.full(judged.sum(), pull)
        tension = EstimatedError.of(time[judged], errors[judged], allowed)
        return cls(part.name, position, tension, taut)


@dataclass(frozen=True)
class ErrorEstimate:
    """What a run with ``solver.error_estimate`` says of its own errors."""

    parts: tuple[PartEstimate, ...]
    """Of the line, or of a system's lines and bodies."""
    unknown_from: float | None
    """First time without an estimate [s]: the finer run has no start, or could not go on. None if
    there is none."""

    @property
    def of_positions(self) -> PartEstimate:
        """The part whose positions have the largest share of what is allowed."""
        return max(self.parts, key=lambda part: np.nan_to_num(part.position.share, nan=-1.0))

    @property
    def of_tensions(self) -> PartEstimate:
        """The part whose tensions have the largest share of what is allowed."""
        return max(self.parts, key=lambda part: np.nan_to_num(part.tension.share, nan=-1.0))

    @property
    def position(self) -> EstimatedError:
        """Of positions [m]: of a system those of the part with the largest share."""
        return self.of_positions.position

    @property
    def tension(self) -> EstimatedError:
        """Of tensions [N]: of a system those of the part with the largest share."""
        return self.of_tensions.tension

    @property
    def taut_until(self) -> float:
        """Time from which on the tensions of `tension` are not promised [s]."""
        return self.of_tensions.taut_until

    @property
    def share(self) -> float:
        """The larger share of what the tolerance allows; more than 1 breaks the promise.

        Not a number where that is not known up to the end.
        """
        if self.unknown_from is not None:
            return math.nan
        return float(np.fmax(self.position.share, self.tension.share))

    @property
    def kept(self) -> bool:
        """Whether the promise is known to be kept at all outputs."""
        return self.share <= 1.0

    def problems(self, settings: Solver) -> list[str]:
        """Where the promise of a run with these settings is not kept, or that is not known, in
        sentences: of the worst part, with the names of others."""
        found = []
        worst, pulled = self.of_positions, self.of_tensions
        moved = {part.name: part.position for part in self.parts}
        drawn = {part.name: part.tension for part in self.parts}
        for what, name, errors in (
            (worst.positions, worst.name, moved),
            (pulled.tensions, pulled.name, drawn),
        ):
            error = errors.pop(name)
            if error.broken_at is None:
                continue
            others = [other for other, its in errors.items() if its.broken_at is not None]
            also = f" (and those of {', '.join(others)})" if others else ""
            found.append(
                f"{what}{also} may be off by more than {settings.asked} allows, "
                f"first at t = {error.broken_at:g} s, by up to {error.share:.2g} times as much"
            )
        if self.unknown_from is not None:
            found.append(
                f"from t = {self.unknown_from:g} s on errors are not known: the run at "
                f"{settings.tolerance / FINER:g} that they are estimated by has no start, or could "
                "not go on"
            )
        return found

    @classmethod
    def of(cls, run: Run) -> ErrorEstimate:
        """Of a run whose scene has ``solver.error_estimate``."""
        judged = run.parts_judged()
        parts = tuple(PartEstimate.of(part, run.time, run.scene) for part in judged)
        unknown = run.time[np.any([np.isnan(part.position_error) for part in judged], axis=0)]
        return cls(parts, float(unknown[0]) if unknown.size else None)
