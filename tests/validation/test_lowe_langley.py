"""Lowe and Langley's jumper in motion and in waves, against what they published (OMAE 2006)."""

import numpy as np
import pytest

from validation.published import top_of_jumper


@pytest.mark.parametrize(
    ("case", "rms"), [(1, 0.2), (2, 0.2), (3, 0.2), (4, 0.35), (5, 0.5), (6, 0.3)]
)
def test_top_tension_of_a_jumper(case, rms):
    """Case 4 swings by a third less without the Froude-Krylov force along the line: 3.5 kN rms.
    Case 3 comes out of the water: 2.2 kN rms where that has no surface."""
    _, published, found = top_of_jumper(case)
    assert np.sqrt(np.mean((found - published) ** 2)) < rms  # [kN]
    assert np.ptp(published) > 4.5  # [kN]: what it swings by
