"""What scenes are drawn from: rows of Latin hypercubes, and words and numbers out of them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

COUNT = 1000
"""Rows of a hypercube."""


def latin_hypercube(columns: int, stream: int) -> np.ndarray:
    """Rows of numbers in [0, 1), (COUNT, columns); the same for the same number of the stream."""
    from scipy.stats import qmc

    # A generator, not a number: its stream does not depend on SciPy's way to seed.
    generator = np.random.default_rng(stream)
    return np.asarray(qmc.LatinHypercube(columns, seed=generator).random(COUNT))


def pick(u: float, shares: Sequence[tuple[str, float]]) -> str:
    """The word in whose share of [0, 1) the number falls."""
    for word, share in shares:
        u -= share
        if u < 0.0:
            return word
    return shares[-1][0]


def decades(u: float, low: float, high: float) -> float:
    """Between two positive numbers, even in the logarithm."""
    return low * (high / low) ** u
