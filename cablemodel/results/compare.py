"""Compare two runs: the largest difference of every quantity, when and where it occurs."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cablemodel import variables
from cablemodel.errors import LogError
from cablemodel.results.promise import looseness
from cablemodel.results.states import state_at

if TYPE_CHECKING:
    from cablemodel.results.run import Run

Floats = NDArray[np.float64]

STATE_UNITS = {
    "position": "m", "tangent": "", "velocity": "m/s", "tension": "N", "curvature": "1/m",
    "bending_moment": "N.m", "on_floor": "",
}  # fmt: skip
"""Fields of states that are compared, and their units."""

SAME_TIME = 2e-9
"""Stamps of logs are whole nanoseconds [s]."""


@dataclass
class Difference:
    """The largest difference of one quantity between two runs."""

    name: str
    unit: str
    allowed: float
    """In the quantity's unit."""
    scale: float = math.nan
    """What a tolerance of 1 would allow, in the quantity's unit."""
    largest: float = 0.0
    time: float = math.nan
    """Where it occurred [s]."""
    arc_length: float | None = None
    """And at which place of the cable [m], for quantities along it."""

    @property
    def within(self) -> bool:
        return self.largest <= self.allowed

    @property
    def share(self) -> float:
        """The tolerance within which the quantity would be."""
        if self.largest == 0.0:
            return 0.0
        return self.largest / self.scale if self.scale > 0.0 else math.inf

    def take(self, one: ArrayLike, other: ArrayLike, time: float, s: Floats | None = None) -> None:
        """Compare one sample; values that are NaN in both are equal.

        Args:
            one, other: values, of one shape; along the cable with its nodes as the first axis.
            time: of the sample [s].
            s: arc lengths of the nodes [m], for quantities along the cable.
        """
        off = _off(one, other)
        worst = float(np.max(off, initial=0.0))
        if worst > self.largest:
            self.largest, self.time = worst, time
            if s is not None:
                node = np.unravel_index(int(np.argmax(off)), off.shape)[0]
                self.arc_length = float(s[node])

    def take_all(self, one: Floats, other: Floats, time: Floats) -> None:
        """Compare samples over time: values (n, ...) at times (n,) [s]."""
        if one.size:
            off = _off(one, other).reshape(len(time), -1)
            worst = int(np.argmax(np.max(off, axis=1)))
            self.take(one[worst], other[worst], float(time[worst]))


def _off(one: ArrayLike, other: ArrayLike) -> Floats:
    """Absolute differences; none where both are NaN, infinite where one is."""
    a, b = np.atleast_1d(np.asarray(one, float), np.asarray(other, float))
    with np.errstate(invalid="ignore"):  # infinity less infinity
        off = np.abs(a - b)
    off[np.isnan(a) & np.isnan(b) | (a == b)] = 0.0
    return np.where(np.isnan(off), np.inf, off)


def differences_of(run: Run, tolerance: float) -> tuple[dict[str, Difference], Along]:
    """Differences yet to be found, of the outputs of a run by name, and of its lines' states.

    A tolerance allows lengths this part of the (longest) line's length at the start; curvatures and
    moments a hundred times this part, and all else ten times, of the largest value in the same
    unit.
    """
    rows = {row.python: row for row in variables.outputs_of(run.scene)}
    largest = {"m": run.scene.line_length}

    def note(unit: str, values: Floats) -> None:
        finite = np.abs(values[np.isfinite(values)])
        if unit != "m":
            largest[unit] = float(np.max(finite, initial=largest.get(unit, 0.0)))

    for name in run.names:
        if rows[name].present != "error_estimate":
            note(rows[name].unit, run[name])
    for states in run.shapes.values():
        for state in states:
            for name, unit in STATE_UNITS.items():
                note(unit, np.asarray(getattr(state, name), float))

    def difference(name: str, unit: str) -> Difference:
        scale = looseness(unit) * largest.get(unit, 0.0)
        return Difference(name, unit, tolerance * scale, scale)

    outputs = {name: difference(name, rows[name].unit) for name in run.names}
    along = {
        (line, name): difference(f"{line}.state.{name}".lstrip("."), unit)
        for line in run.shapes
        for name, unit in STATE_UNITS.items()
    }
    return outputs, along


Along = dict[tuple[str, str], Difference]
"""By line and field of its states."""


@dataclass
class Comparison:
    """How two runs compare."""

    differences: list[Difference]
    tolerance: float
    samples: int = 0
    """Output times that were compared."""
    states: int = 0
    """States that were compared."""
    interpolated: bool = False
    """Whether the runs have no output times in common, so that the second was interpolated."""
    unmatched: list[str] = field(default_factory=list)
    """What one run has and the other has not, in words."""

    @property
    def identical(self) -> bool:
        """Whether all values are the same, to the last bit."""
        return not self.unmatched and all(item.largest == 0.0 for item in self.differences)

    @property
    def passed(self) -> bool:
        """Whether nothing is missing and all values are within the tolerance."""
        return not self.unmatched and all(item.within for item in self.differences)


def compare(one: Run, other: Run, *, tolerance: float = 0.0) -> Comparison:
    """Compare two runs of any scenes, at the times that both have.

    Args:
        one: measures the scales, see :func:`differences_of`.
        other: what is compared with it.
        tolerance: what :attr:`Comparison.passed` allows.

    States are compared at the arc lengths of ``one``. Where the runs have less than two output
    times in common, the outputs of ``other`` are interpolated linearly in time.

    Raises:
        LogError: the runs have no span of time in common.
        ValueError: ``tolerance`` is negative or not finite.
    """
    if not (math.isfinite(tolerance) and tolerance >= 0.0):
        raise ValueError(f"tolerance is {tolerance}, it must be a number of at least 0")
    if not len(one.time) or not len(other.time):
        raise LogError("a run without outputs: there is nothing to compare")
    begin, end = max(one.time[0], other.time[0]), min(one.time[-1], other.time[-1])
    if begin > end + SAME_TIME:
        raise LogError(f"the runs have no time in common: {_span(one)} and {_span(other)}")
    outputs, along = differences_of(one, tolerance)
    result = Comparison([*outputs.values(), *along.values()], tolerance)
    result.unmatched = _unmatched(one, other)
    result.differences = [
        item for item in result.differences if item.name in other.names or item in along.values()
    ]

    rows, others = _common(one.time, other.time)
    result.interpolated = len(rows) < 2 and len(one.time) > 1 and len(other.time) > 1
    if result.interpolated:
        rows = np.flatnonzero((one.time >= begin) & (one.time <= end))
    result.samples = len(rows)
    for name in set(outputs) & set(other.names):
        if result.interpolated:
            values = _interpolated(other.time, other[name])(one.time[rows])
        else:
            values = other[name][others]
        outputs[name].take_all(*_as_wide(one[name][rows], values), one.time[rows])

    for line in set(one.shapes) & set(other.shapes):
        mine, theirs = one.shapes[line], other.shapes[line]
        rows, others = _common(mine.time, theirs.time)
        result.states = len(rows)
        for row, match in zip(rows.tolist(), others.tolist(), strict=True):
            state = mine[row]
            again = state_at(theirs[match], state.s)
            for name in STATE_UNITS:
                ours = getattr(state, name)
                along[line, name].take(ours, getattr(again, name), state.time, state.s)
    return result


def _unmatched(one: Run, other: Run) -> list[str]:
    found = []
    for run, missing, which in ((one, other, "first"), (other, one, "second")):
        # What a run says of its own errors is said beside its results.
        own = (name for name in run.names if run.variable(name).present != "error_estimate")
        names = [name for name in own if name not in missing.names]
        if names:
            found.append(f"only the {which} run has {', '.join(names)}")
    if abs(one.time[0] - other.time[0]) > SAME_TIME or (
        abs(one.time[-1] - other.time[-1]) > SAME_TIME
    ):
        found.append(f"the first run is {_span(one)}, the second {_span(other)}")
    return found


def _span(run: Run) -> str:
    return f"from {run.time[0]:g} to {run.time[-1]:g} s"


def _common(one: Floats, other: Floats) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Indices of equal times in two increasing arrays."""
    if not len(one) or not len(other):
        return np.empty(0, np.intp), np.empty(0, np.intp)
    right = np.minimum(np.searchsorted(other, one), len(other) - 1)
    left = np.maximum(right - 1, 0)
    nearest = np.where(np.abs(other[left] - one) < np.abs(other[right] - one), left, right)
    rows = np.flatnonzero(np.abs(other[nearest] - one) <= SAME_TIME)
    return rows, nearest[rows]


def _interpolated(time: Floats, values: Floats) -> Callable[[Floats], Floats]:
    """Values over time (n, ...) as a function of time, linear."""

    def at(when: Floats) -> Floats:
        columns = values.reshape(len(values), -1).T
        found = [np.interp(when, time, column) for column in columns]
        return np.stack(found, axis=1).reshape(len(when), *values.shape[1:]) if found else (
            np.empty((len(when), *values.shape[1:]))
        )  # fmt: skip

    return at


def _as_wide(one: Floats, other: Floats) -> tuple[Floats, Floats]:
    """Bodies (n, count, 3) of two runs in as many columns; the outermost is always the last."""
    if one.ndim == 3 and one.shape[1] != other.shape[1]:
        count = max(one.shape[1], other.shape[1])
        one, other = (
            np.concatenate([np.full((len(a), count - a.shape[1], 3), np.nan), a], axis=1)
            for a in (one, other)
        )
    return one, other
