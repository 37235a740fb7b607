"""Cubic curves and a root, in a few lines of NumPy each.

SciPy has both; its import takes half a second, in which the starts that need them are over.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]

_TRIALS = 200
_HALVES_EACH = 4
"""Every fourth trial halves the interval, however flat the function is."""


def way_along(points: FloatArray) -> FloatArray:
    """Length along a polyline (n, 3) at each of its points, (n,) [m]."""
    chords = np.linalg.norm(np.diff(points, axis=0), axis=1)
    return np.concatenate([[0.0], np.cumsum(chords)])


def bends(places: FloatArray, slopes: FloatArray, h: FloatArray) -> tuple[FloatArray, FloatArray]:
    """r'' at the beginnings and at the ends of cubics of lengths h (n,) [m] between places (n + 1,
    d) [m] with slopes (n + 1, d), (n, d) each [1/m]."""
    h = h[:, None]
    chords = np.diff(places, axis=0) / h
    begin = (6.0 * chords - 4.0 * slopes[:-1] - 2.0 * slopes[1:]) / h
    end = (2.0 * slopes[:-1] + 4.0 * slopes[1:] - 6.0 * chords) / h
    return begin, end


def hermite(
    at: FloatArray, s: FloatArray, values: FloatArray, slopes: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """The piecewise cubic with these values and slopes, and its derivative, (k, m) each.

    Beyond its ends the last cubic goes on.

    Args:
        at: places (m,).
        s: rising, (n,), n > 1. Where two are equal the first belongs to the cubic before them, the
            second to the one after; the last two differ.
        values, slopes: at these, (k, n).
    """
    k = np.clip(np.searchsorted(s, at, side="right") - 1, 0, len(s) - 2)
    h = s[k + 1] - s[k]
    x = (at - s[k]) / h
    v0, v1, d0, d1 = values[:, k], values[:, k + 1], slopes[:, k], slopes[:, k + 1]
    left: FloatArray = (1 + 2 * x) * (1 - x) ** 2 * v0 + x * (1 - x) ** 2 * h * d0
    right: FloatArray = x**2 * (3 - 2 * x) * v1 + x**2 * (x - 1) * h * d1
    inner = 6 * x * (1 - x) * (v1 - v0) / h
    slope: FloatArray = inner + (1 - x) * (1 - 3 * x) * d0 + x * (3 * x - 2) * d1
    return left + right, slope


def crossing(
    function: Callable[[float], float],
    low: float,
    high: float,
    *,
    at_low: float,
    at_high: float,
    near: float,
    width: float,
) -> float:
    """Where a function crosses zero between two places, by false position.

    By the Illinois rule: an end that stays twice counts half the next time (Dowell and Jarratt,
    BIT 11, 1971). A jump across zero counts as a crossing. The function is asked last for the place
    that is returned.

    Args:
        function: of a place between low and high.
        at_low, at_high: its values there, of opposite signs, or zero. Where nothing crosses zero
            the place is next to one of them.
        near: the value that is near enough to zero.
        width: the interval about the crossing that is short enough.
    """
    falls = at_low > at_high
    middle, side = 0.5 * (low + high), 0
    for trial in range(_TRIALS):
        share = at_low / (at_low - at_high) if at_low != at_high else 0.5
        if trial % _HALVES_EACH == _HALVES_EACH - 1 or not 0.0 < share < 1.0:
            share = 0.5
        middle = low + share * (high - low)
        value = function(middle)
        if abs(value) <= near or abs(high - low) <= width:
            break
        if (value > 0.0) == falls:
            low, at_low = middle, value
            at_high *= 0.5 if side < 0 else 1.0
            side = -1
        else:
            high, at_high = middle, value
            at_low *= 0.5 if side > 0 else 1.0
            side = 1
    return middle
