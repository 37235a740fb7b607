"""The schemes' stability function, by which a ring is missed, from their tableaus."""

import numpy as np
import pytest

from cablemodel.kernels import tables


@pytest.mark.parametrize("scheme", [0, 1])
@pytest.mark.parametrize("angle", [0.1, 1.0, 4.0, 30.0])
def test_its_numerator_is_that_of_a_step(scheme, angle):
    """A step of y' = i w y, by solving for the stages all at once."""
    stages = tables.STAGES[scheme]
    a = tables.STAGE_A[scheme, :stages, :stages]
    turn = 1j * angle
    slopes = np.linalg.solve(np.eye(stages) - turn * a, np.full(stages, turn))
    pole = 1.0 - tables.GAMMA[scheme] * turn
    found = np.polyval(tables.NUMERATOR[scheme, :stages], turn) / pole ** (stages - 1)
    assert found == pytest.approx(1.0 + a[-1] @ slopes, abs=1e-12)
