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

from cablemodel.solver import FINER

if TYPE_CHECKING:
    from cablemodel.run import Run
    from cablemodel.scene import Scene
    from cablemodel.scene.schema import Solver

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


def tensions_promised(scene: Scene) -> bool:
    """Whether tensions are promised as long as the line is taut: not if it starts out of
    equilibrium, and rings, nor if they are not asked for."""
    return scene.initial.kind == "static" and scene.solver.accuracy_of == "all"


def largest_tension(run: Run) -> float:
    """Of a whole run, either way [N]: what a tension may be wrong by does not come and go."""
    pulls = (run.tension_max, run.tension_min, run.top_tension)
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
class ErrorEstimate:
    """What a run with ``solver.error_estimate`` says of its own errors."""

    position: EstimatedError
    """Along the whole line [m]."""
    tension: EstimatedError
    """At the tow point, while tensions are promised [N]."""
    taut_until: float
    """Time from which on tensions are not promised [s]: the line is slack, or starts out of
    equilibrium and rings, or they are not asked for; infinite if there is none."""
    unknown_from: float | None
    """First time without an estimate [s]: the finer run has no start, or could not go on. None if
    there is none."""

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
        sentences."""
        found = []
        for what, error in (("positions", self.position), ("the top tension", self.tension)):
            if error.broken_at is not None:
                found.append(
                    f"{what} may be off by more than {settings.asked} allows, "
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
        time, promised = run.time, run.scene.solver.promised
        largest = largest_tension(run)
        taut = float(time[0])
        if tensions_promised(run.scene):
            taut = taut_until(time, run.tension_min, largest)
        judged = time < taut
        pull = max(looseness("N") * promised * largest, float(np.finfo(float).tiny))
        position, tension = run["position_error"], run["tension_error"]
        unknown = time[np.isnan(position)]
        return cls(
            EstimatedError.of(time, position, promised * run["line_length"]),
            EstimatedError.of(time[judged], tension[judged], np.full(judged.sum(), pull)),
            taut,
            float(unknown[0]) if unknown.size else None,
        )
