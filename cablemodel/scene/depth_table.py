"""The surface through a table of depths: bicubic, with one tangent plane everywhere."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


class DepthSurface:
    """A bicubic C1 surface through heights on a grid, which overshoots nowhere along its lines.

    The slopes are those of PCHIP, first along x, then those of heights and slopes along y. Beyond
    the edges it goes on level. The same surface as that of kernels/floor.py.

    Args:
        x, y: ascending coordinates (nx,), (ny,) [m]; one y: a profile, the same for all y.
        z: heights (nx, ny) [m].
    """

    def __init__(self, x: FloatArray, y: FloatArray, z: FloatArray) -> None:
        from scipy.interpolate import CubicHermiteSpline

        self._x, self._y = x, y
        along_x = _slopes(x, z)
        along_y = _slopes(y, z.T).T
        both = _slopes(y, along_x.T).T
        self._heights = CubicHermiteSpline(x, z, along_x)
        self._slopes = CubicHermiteSpline(x, along_y, both)

    def height(self, x: float, y: float) -> float:
        """Height at a place [m]."""
        from scipy.interpolate import CubicHermiteSpline

        x = float(np.clip(x, self._x[0], self._x[-1]))
        heights = self._heights(x)
        if len(self._y) < 2:
            return float(heights[0])
        y = float(np.clip(y, self._y[0], self._y[-1]))
        left = int(np.clip(np.searchsorted(self._y, y, side="right") - 1, 0, len(self._y) - 2))
        cell = slice(left, left + 2)
        across = CubicHermiteSpline(self._y[cell], heights[cell], self._slopes(x)[cell])
        return float(across(y))


def _slopes(x: FloatArray, z: FloatArray) -> FloatArray:
    """Slopes (nx, ...) of cubics through the rows of z over x that overshoot nowhere (PCHIP)."""
    if len(x) < 2:
        return np.zeros_like(z)
    from scipy.interpolate import PchipInterpolator

    return np.asarray(PchipInterpolator(x, z, axis=0).derivative()(x), dtype=np.float64)
