"""Numbers that both solvers make of a scene in the same way."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.shared.numbers import OUT_OF_PLANE

FloatArray = NDArray[np.float64]
CURVE_ENDS = 0.1
"""Of its slope at rest: where a curve of strain ends."""
REAL_ROOT = 1e-9
"""Of a root: its imaginary part by rounding."""


def strain_range(coefficients: tuple[float, ...]) -> tuple[float, float]:
    """Tensions [N] between which the curve is used as it is; its tangents continue it outside.

    A polynomial is fitted to pulls: below zero its tangent there is taken, and above, the curve
    ends where its slope has fallen to a tenth of the slope at rest.
    """
    if len(coefficients) == 1:
        return -math.inf, math.inf
    slope = np.array([(n + 1) * c for n, c in enumerate(coefficients)])
    slope[0] *= 1.0 - CURVE_ENDS
    roots = np.asarray(np.polynomial.polynomial.polyroots(slope), dtype=np.complex128)
    real = [float(root.real) for root in roots if abs(root.imag) < REAL_ROOT * abs(root)]
    real = [tension for tension in real if tension > 0.0]
    return 0.0, min(real, default=math.inf)


def shared_direction(vectors: list[FloatArray]) -> tuple[FloatArray, bool]:
    """Unit vector along the first of horizontal vectors (2,) that is not zero (x where all are),
    and whether all others are parallel to it."""
    every = np.array(vectors, dtype=np.float64).reshape(-1, 2)
    some = every[np.any(every != 0.0, axis=1)]
    if not len(some):
        return np.array([1.0, 0.0]), True
    units = some / np.hypot(some[:, :1], some[:, 1:])
    first = units[0]
    across = np.abs(first[0] * units[:, 1] - first[1] * units[:, 0])
    return first, bool(across.max() <= OUT_OF_PLANE)
