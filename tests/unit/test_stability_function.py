"""The schemes' stability function, by which a ring is missed, and the window that measures one."""

import numpy as np
import pytest

from cablemodel.solvers.finite_element.kernels.element import tables


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


def found_in_window(tension):
    """What the window finds of a tension [N] over two turns, cosine and sine, by quadrature."""
    y = np.linspace(-2.0 * np.pi, 2.0 * np.pi, 4001)
    seen = 0.5 * (1.0 + np.cos(0.5 * y)) * tension(y)
    even = tables.WINDOW[0] @ np.stack([np.cos(y), np.ones_like(y), y**2])
    odd = tables.WINDOW[1] @ np.stack([np.sin(y), y, y**3])
    return [float(np.trapezoid(seen * part, y)) for part in (even, odd)]


@pytest.mark.parametrize(("cosine", "sine"), [(1.0, 0.0), (0.0, 1.0), (-0.6, 0.8)])
def test_window_finds_a_ring_beside_a_cubic(cosine, sine):
    def tension(y):
        return cosine * np.cos(y) + sine * np.sin(y) + 30.0 - 4.0 * y + 2.0 * y**2 + 0.5 * y**3

    assert found_in_window(tension) == pytest.approx([cosine, sine], abs=1e-6)


def test_window_finds_next_to_nothing_of_slow_waves():
    """Ten times slower than the ring: less than a thousandth of them."""
    slow = [np.hypot(*found_in_window(lambda y, p=p: np.cos(0.1 * y + p))) for p in (0.0, 0.8, 1.6)]
    assert max(slow) < 1e-3
