"""How long cycles take: a histogram that stays as small as it is."""

from __future__ import annotations

import math

import numpy as np

_DECADES = (1e-6, 1e2)
_BINS_A_DECADE = 50


class Durations:
    """Counts durations [s] in bins 5 % wide, from a microsecond to a hundred seconds."""

    def __init__(self) -> None:
        low, high = (math.log10(end) for end in _DECADES)
        self.counts = np.zeros(round((high - low) * _BINS_A_DECADE) + 1, dtype=np.int64)
        self.largest = 0.0
        self.total = 0.0

    def add(self, duration: float) -> None:
        place = math.log10(max(duration, _DECADES[0]) / _DECADES[0]) * _BINS_A_DECADE
        self.counts[min(int(place), len(self.counts) - 1)] += 1
        self.total += duration
        self.largest = max(self.largest, duration)

    @property
    def count(self) -> int:
        return int(self.counts.sum())

    @property
    def mean(self) -> float:
        """[s], 0 when nothing was counted."""
        return self.total / max(self.count, 1)

    def edges(self) -> np.ndarray:
        """Lower edges of the bins, and the upper edge of the last (bins + 1,) [s]."""
        return _DECADES[0] * 10.0 ** (np.arange(len(self.counts) + 1) / _BINS_A_DECADE)

    def percentile(self, share: float) -> float:
        """Duration [s] that `share` per cent stay below (upper edge of the bin; no more than the
        largest)."""
        if self.count == 0:
            return 0.0
        reached = np.cumsum(self.counts) >= share / 100.0 * self.count
        return min(float(self.edges()[int(np.argmax(reached)) + 1]), self.largest)

    def table(self) -> dict[str, int]:
        """Counts between round durations, in milliseconds: ``{"0.1-0.2": 12, ...}``; bins that
        lie across two of them count where they begin. Empty ones are left out."""
        starts = 1e3 * self.edges()[:-1] * (1.0 + 1e-9)
        rounds = [m * 10.0**e for e in range(-3, 5) for m in (1, 2, 5)]
        places = np.searchsorted(rounds, starts, side="right") - 1
        sums = np.bincount(places, weights=self.counts, minlength=len(rounds))
        return {
            f"{rounds[k]:g}-{rounds[k + 1]:g}": int(count)
            for k, count in enumerate(sums[:-1])
            if count
        }
