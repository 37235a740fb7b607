"""The surface through a table of depths: bicubic, with one tangent plane everywhere."""

from __future__ import annotations

from bisect import bisect_right

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


class DepthSurface:
    """A bicubic C1 surface through heights on a grid, which overshoots nowhere along its lines.

    The slopes are those of PCHIP, first along x, then those of heights and slopes along y. Beyond
    the edges it goes on level. The same surface as that of kernels/floor/floor_forces.py.

    Args:
        x, y: ascending coordinates (nx,), (ny,) [m]; one y: a profile, the same for all y.
        z: heights (nx, ny) [m].
    """

    def __init__(self, x: FloatArray, y: FloatArray, z: FloatArray) -> None:
        self._x, self._y = x.tolist(), y.tolist()
        along_x = monotone_slopes(x, z)
        along_y = monotone_slopes(y, z.T).T
        both = monotone_slopes(y, along_x.T).T
        self._along = z.tolist(), along_x.tolist()
        self._across = along_y.tolist(), both.tolist()

    def height(self, x: float, y: float) -> float:
        """Height at a place [m]."""
        i, x, h = _cell(self._x, x)
        if len(self._y) < 2:
            return _cubic(x, h, *(rows[i + k][0] for rows in self._along for k in (0, 1)))
        j, y, width = _cell(self._y, y)
        ends = [
            _cubic(x, h, rows[i][k], rows[i + 1][k], slopes[i][k], slopes[i + 1][k])
            for rows, slopes in (self._along, self._across)
            for k in (j, j + 1)
        ]
        return _cubic(y, width, *ends)


def _cell(grid: list[float], place: float) -> tuple[int, float, float]:
    """Cell of an ascending grid that holds a place, the place in it from 0 to 1, its width."""
    place = min(max(place, grid[0]), grid[-1])
    cell = min(max(bisect_right(grid, place) - 1, 0), len(grid) - 2)
    width = grid[cell + 1] - grid[cell]
    return cell, (place - grid[cell]) / width, width


def _cubic(x: float, h: float, first: float, last: float, start: float, end: float) -> float:
    """Cubic with these values and slopes at the ends of a cell of width h, at x from 0 to 1."""
    y = 1.0 - x
    return y * y * ((1.0 + 2.0 * x) * first + h * x * start) + x * x * (
        (1.0 + 2.0 * y) * last - h * y * end
    )


def monotone_slopes(x: FloatArray, z: FloatArray) -> FloatArray:
    """Slopes (nx, ...) of cubics through the rows of z over x that overshoot nowhere (PCHIP)."""
    if len(x) < 2:
        return np.zeros_like(z)
    from scipy.interpolate import PchipInterpolator

    return np.asarray(PchipInterpolator(x, z, axis=0).derivative()(x), dtype=np.float64)
