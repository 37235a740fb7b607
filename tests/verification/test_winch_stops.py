"""What a winch that stops sends along an undamped wire, beside masses on springs."""

import numpy as np
import pytest

import cablemodel as cm
from tests.verification.references.stops import stop
from validation.stops import tensions

END = 8.0  # s
JOBS = (2, 4, 5, 7)  # of 100 to 1,400 m; from waves that are hardly heard to large ones


@pytest.mark.parametrize("tolerance", [1e-3, 1e-4])
@pytest.mark.parametrize("seed", JOBS)
def test_waves_along_a_wire_are_within_the_promise(seed, tolerance):
    job = stop(seed)
    expected = job.tensions(END)
    found = tensions(job, tolerance, len(expected))
    assert np.abs(found - expected).max() < 10.0 * tolerance * expected.max()


def test_other_outputs_leave_the_waves_as_they_are():
    job = stop(4)
    tops = []
    for interval in (0.02, 1.0, 2.0):
        model = cm.CableModel(job.scene(1e-3))
        for n in range(1, round(END / interval) + 1):
            model.step_to(n * interval)
        tops.append(model.top_tension)
    largest = job.tensions(END).max()
    assert max(tops) - min(tops) < 10.0 * 1e-3 * largest
