"""Elements on which a system's start is sought from other first shapes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


def divided(nodes: FloatArray, parts: int) -> FloatArray:
    """Arc lengths of nodes (n,) [m], with each element divided into equal parts."""
    count = parts * (len(nodes) - 1) + 1
    return np.asarray(np.interp(np.arange(count) / parts, np.arange(len(nodes)), nodes))
