"""Statistics of a run that offshore work asks for: extremes, spectra, cycles and fatigue damage.

Everything takes times and values as plain arrays, so that it serves outputs, tensions at a node
(``run.states.tension[:, k]``) and measurements alike. Values that are not finite are left out.
SciPy does the spectra and fits, rainflow (ASTM E1049-85) counts the cycles.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cablemodel.extras import require
from cablemodel.results.columns import Column, output_columns

if TYPE_CHECKING:
    from cablemodel.results.run import Run

Floats = NDArray[np.float64]

YEAR = 365.25 * 86400.0
"""[s]"""

_PEAK_PERIODS = 5
"""In a window that resolves the peak."""
_UNEVEN = 1e-3
"""Part of a step by which steps may differ and still count as even."""


@dataclass(frozen=True)
class Extremes:
    """What a quantity did over time, in its unit."""

    mean: float
    """Weighted by time: outputs need not be evenly spaced."""
    standard_deviation: float
    minimum: float
    time_of_minimum: float
    """[s]"""
    maximum: float
    time_of_maximum: float
    """[s]"""
    zero_crossing_period: float
    """Mean time between upward crossings of the mean [s]; NaN with fewer than two."""


def extremes(time: ArrayLike, values: ArrayLike) -> Extremes:
    """Mean, spread and extremes of a quantity.

    Args:
        time: (n,) [s], increasing.
        values: (n,).

    Raises:
        ValueError: no finite value.
    """
    t, x = _finite(time, values)
    if not len(x):
        raise ValueError("there are no finite values")
    span = float(t[-1] - t[0])
    mean = _integral(x, t) / span if span > 0.0 else float(np.mean(x))
    square = (x - mean) ** 2
    variance = _integral(square, t) / span if span > 0.0 else 0.0
    low, high = int(np.argmin(x)), int(np.argmax(x))
    # A mean is not a value of the series: round-off must not make crossings of a constant.
    above = x > mean + 1e-12 * float(np.max(np.abs(x)))
    rises = np.flatnonzero(~above[:-1] & above[1:])
    period = float((t[rises[-1]] - t[rises[0]]) / (len(rises) - 1)) if len(rises) > 1 else math.nan
    return Extremes(
        mean, math.sqrt(variance), float(x[low]), float(t[low]), float(x[high]), float(t[high]),
        period,
    )  # fmt: skip


def extreme_value(
    time: ArrayLike, values: ArrayLike, *, duration: float = 3 * 3600.0, blocks: int = 20
) -> float:
    """Most probable maximum of a quantity in a duration, from a Gumbel fit.

    The series is cut into blocks; their maxima are fitted by a Gumbel distribution, whose location
    grows with the logarithm of the duration.

    Args:
        time: (n,) [s]; leave out the start-up of the run.
        values: (n,), of one sea state.
        duration: [s]
        blocks: number of blocks; each must be long against the period of the response.

    Raises:
        ValueError: too few values for that many blocks, or a duration that is not positive.
        CableModelError: SciPy is not installed.
    """
    stats: Any = require("scipy.stats", extra="analysis", what="an extreme value")
    t, x = _finite(time, values)
    if blocks < 5 or len(x) < 10 * blocks:
        raise ValueError(f"{len(x)} values are too few for {blocks} blocks (5 blocks of 10 values)")
    if not duration > 0.0:
        raise ValueError(f"duration is {duration}, it must be a positive time in seconds")
    edges = np.linspace(t[0], t[-1], blocks + 1)
    block = np.clip(np.searchsorted(edges, t, side="right") - 1, 0, blocks - 1)
    largest = np.array([np.max(x[block == k]) for k in range(blocks) if np.any(block == k)])
    location, scale = stats.gumbel_r.fit(largest)
    return float(location + scale * math.log(duration / float(edges[1] - edges[0])))


@dataclass(frozen=True)
class Spectrum:
    """One-sided spectral density of a quantity about its mean."""

    frequency: Floats
    """(n,) [Hz]"""
    density: Floats
    """(n,) [unit^2/Hz]"""

    def moment(self, order: int) -> float:
        """Spectral moment over frequency in Hz [unit^2 Hz^order]."""
        inside = self.frequency > 0.0
        frequency = self.frequency[inside]
        return _integral(frequency**order * self.density[inside], frequency)

    @property
    def significant(self) -> float:
        """Significant (double) amplitude, 4 sqrt(m0), in the quantity's unit."""
        return 4.0 * math.sqrt(self.moment(0))

    @property
    def peak_period(self) -> float:
        """Period of the highest density [s]; NaN where there is no motion.

        Between the frequencies of short windows: at the top of the parabola through the logarithms
        of the highest density and its neighbours, which for a Hann window is all but exact.
        """
        at = int(np.argmax(self.density[1:])) + 1
        if not self.density[at] > 0.0:
            return math.nan
        frequency = float(self.frequency[at])
        near = self.density[at - 1 : at + 2]
        if at > 1 and len(near) == 3 and np.all(near > 0.0):
            below, top, above = np.log(near)
            bend = below - 2.0 * top + above
            if bend < 0.0:
                frequency += 0.5 * float((below - above) / bend * self.frequency[1])
        return 1.0 / frequency

    @property
    def zero_crossing_period(self) -> float:
        """sqrt(m0/m2) [s]; NaN where there is no motion."""
        second = self.moment(2)
        return math.sqrt(self.moment(0) / second) if second > 0.0 else math.nan


def spectrum(time: ArrayLike, values: ArrayLike, *, segment: float | None = None) -> Spectrum:
    """Spectral density by Welch's method: averaged over half-overlapping Hann windows.

    Args:
        time: (n,) [s]. Where it is not even, values are interpolated at the median step.
        values: (n,)
        segment: length of a window [s]; a longer one resolves frequencies finer, but averages over
            less. If not given a quarter of the series, or a half or all of it where that holds
            fewer than five peak periods.

    Raises:
        ValueError: fewer than 8 finite values, or a segment of fewer.
        CableModelError: SciPy is not installed.
    """
    signal: Any = require("scipy.signal", extra="analysis", what="a spectrum")
    t, x = _finite(time, values)
    if len(x) < 8:
        raise ValueError(f"a spectrum needs at least 8 values, not {len(x)}")
    steps = np.diff(t)
    step = float(np.median(steps))
    # The last step of a run may be shorter than the others.
    if np.max(np.abs(steps - step)) > _UNEVEN * step:
        even = np.arange(t[0], t[-1] + 0.5 * _UNEVEN * step, step)
        t, x = even, np.interp(even, t, x)
    count = len(x) // 4 if segment is None else round(segment / step)
    count = min(len(x), max(count, 8) if segment is None else count)
    if count < 8:
        raise ValueError(f"a segment of {segment:g} s has fewer than 8 values")
    while True:
        frequency, density = signal.welch(x, fs=1.0 / step, nperseg=count, detrend="constant")
        resolved = int(np.argmax(density)) >= _PEAK_PERIODS or not np.any(density > 0.0)
        if segment is not None or resolved or count == len(x):
            return Spectrum(np.asarray(frequency, float), np.asarray(density, float))
        count = min(2 * count, len(x))


@dataclass(frozen=True)
class Cycles:
    """Cycles of a series, from the largest to the smallest range."""

    range: Floats
    """Double amplitude (n,), in the quantity's unit."""
    mean: Floats
    """(n,), in the quantity's unit."""
    count: Floats
    """(n,): 1 for a cycle, 0.5 for half a one."""


def cycles(values: ArrayLike) -> Cycles:
    """Rainflow cycles (ASTM E1049-85) of a series (n,).

    Raises:
        CableModelError: rainflow is not installed.
    """
    rainflow: Any = require("rainflow", extra="analysis", what="counting cycles")
    x = np.asarray(values, float)
    found = [item[:3] for item in rainflow.extract_cycles(x[np.isfinite(x)].tolist())]
    table = np.array(found, float).reshape(-1, 3)
    order = np.argsort(-table[:, 0], kind="stable")
    return Cycles(*table[order].T)


@dataclass(frozen=True)
class FatigueCurve:
    """Cycles to failure N = intercept * (range / reference)^-slope, one branch or two.

    An S-N curve (DNV-RP-C203) has ranges of stress: scale the tension by the area first, and write
    log10(intercept) as its "log a". A T-N curve of ropes (API RP 2SK) has ranges of tension
    relative to the breaking load: give that as the reference.
    """

    intercept: float
    slope: float
    reference: float = 1.0
    """In the unit of the ranges."""
    knee: float = math.inf
    """Cycles beyond which the second branch holds."""
    second_slope: float | None = None
    """Slope beyond the knee; None: infinite life there (an endurance limit)."""

    def __post_init__(self) -> None:
        for name in ("intercept", "slope", "reference", "knee"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name} is {getattr(self, name)}, it must be positive")

    def cycles_to_failure(self, ranges: ArrayLike) -> Floats:
        """Cycles to failure (n,) of ranges (n,)."""
        relative = np.asarray(ranges, float) / self.reference
        with np.errstate(divide="ignore", over="ignore"):
            found = self.intercept * relative**-self.slope
            if math.isfinite(self.knee):
                at_knee = (self.intercept / self.knee) ** (1.0 / self.slope)
                slope = math.inf if self.second_slope is None else self.second_slope
                beyond = self.knee * (relative / at_knee) ** -slope
                found = np.where(found > self.knee, beyond, found)
        return np.asarray(found, float)


def damage(counted: Cycles, curve: FatigueCurve) -> float:
    """Fatigue damage of cycles by Palmgren and Miner: 1 is failure."""
    return float(np.sum(counted.count / curve.cycles_to_failure(counted.range)))


def equivalent_range(counted: Cycles, slope: float, count: float) -> float:
    """Range whose ``count`` cycles do the damage of all cycles together, on a curve of one slope.

    Raises:
        ValueError: ``slope`` or ``count`` is not positive.
    """
    if not (slope > 0.0 and count > 0.0):
        raise ValueError(f"slope {slope} and count {count} must be positive")
    largest = float(np.max(counted.range, initial=0.0))
    if largest == 0.0:
        return 0.0
    total = float(np.sum(counted.count * (counted.range / largest) ** slope))
    return float(largest * (total / count) ** (1.0 / slope))


@dataclass(frozen=True)
class Statistic:
    """Extremes of a column of a run."""

    name: str
    unit: str
    quantity: str
    extremes: Extremes


def statistics(run: Run, *, after: float = -math.inf, before: float = math.inf) -> list[Statistic]:
    """Extremes of every component of every output, in the order of the table of variables.

    Args:
        run: any run.
        after, before: leave out what is not between these times [s], such as a start-up.

    Raises:
        ValueError: the run has no outputs in between.
    """
    time, *columns = output_columns(run)
    inside = (time.values >= after) & (time.values <= before)
    if not np.any(inside):
        wanted = f"from {after:g} to {before:g} s"
        if math.isinf(before):
            wanted = f"after {after:g} s"
        elif math.isinf(after):
            wanted = f"before {before:g} s"
        ends = f"{time.values[0]:g} to {time.values[-1]:g} s"
        raise ValueError(f"there are no outputs {wanted}; the run is from {ends}")
    return [
        Statistic(c.name, c.unit, c.quantity, extremes(time.values[inside], c.values[inside]))
        for c in columns
        if _any_finite(c, inside)
    ]


def _any_finite(column: Column, inside: NDArray[np.bool_]) -> bool:
    return bool(np.any(np.isfinite(column.values[inside])))


def _finite(time: ArrayLike, values: ArrayLike) -> tuple[Floats, Floats]:
    t, x = np.asarray(time, float), np.asarray(values, float)
    if t.ndim != 1 or t.shape != x.shape:
        raise ValueError(f"times {t.shape} and values {x.shape} must be rows of equal length")
    keep = np.isfinite(x)
    return t[keep], x[keep]


def _integral(values: Floats, at: Floats) -> float:
    """By the trapezoidal rule (NumPy 1 and 2 have no name for it in common)."""
    return float(np.sum(0.5 * (values[1:] + values[:-1]) * np.diff(at)))
