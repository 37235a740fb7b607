"""The schemes' stability function, by which a ring is missed, and the window that measures one."""

import numpy as np
import pytest

from cablemodel.solvers.finite_element.kernels.element import tables
from cablemodel.solvers.finite_element.kernels.time import consistency


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


def turned(scheme, angle):
    """Of a ring (tension, rate over w) after a step in which it turns by that angle, and of its
    rate by the parabola through the tensions at the step's ends and its last stage but one."""
    stages = tables.STAGES[scheme]
    a, c = tables.STAGE_A[scheme, :stages, :stages], tables.STAGE_C[scheme, stages - 2]
    turn = np.array([[0.0, 1.0], [-1.0, 0.0]])
    every = np.linalg.solve(
        np.eye(2 * stages) - angle * np.kron(a, turn), np.kron(np.ones((stages, 1)), np.eye(2))
    )
    between, end = every[-4], every[-2:]
    parabola = (
        (1.0 - c) / c * np.array([1.0, 0.0])
        - between / (c * (1.0 - c))
        + (2.0 - c) / (1.0 - c) * end[0]
    )
    return end, parabola / angle


@pytest.mark.parametrize("scheme", [0, 1])
@pytest.mark.parametrize("short", [0.003, 0.05, 0.19, 0.5, 1.0, 2.0])
def test_no_ring_grows_where_velocities_are_projected(scheme, short):
    """Steps of one length, each followed by one of another, before which the velocity is brought to
    the rate of the tension (kernels/time/consistency.py), at any angle of the ring."""
    passes = int(tables.STAGES[1])
    largest = once = 0.0
    for angle in np.geomspace(0.05, 100.0, 400):
        end, parabola = turned(scheme, angle)
        follows, _ = turned(scheme, short * angle)
        part = (tables.GAMMA[1] * angle) ** 2
        part /= 1.0 + part
        for times in (passes, 1):
            step = end.copy()
            step[1] += part**times * (parabola - end[1])
            size = np.abs(np.linalg.eigvals(follows @ step)).max()
            largest, once = (max(largest, size), once) if times > 1 else (largest, max(once, size))
    assert largest <= 1.0
    if scheme == 1 and short < 0.3:
        assert once > 1.1  # one pass is not enough


@pytest.mark.parametrize(
    ("ratio", "coming"), [(1.0, 1.0), (1.0, 0.5), (1.0, 0.3), (1.5, 1.0), (2.0, 2.0)]
)
def test_no_ring_grows_where_undamped_velocities_are_projected(ratio, coming):
    """Before each step of order 4, by `project_velocity`: a share by the line's lowest frequency,
    a ratio below the ring's, in steps that alternate with others."""

    def projected(angle, matrix_angle):
        end, parabola = turned(1, angle)
        square = (tables.GAMMA[1] * matrix_angle) ** 2
        lowest = square / ratio**2
        share = lowest / (lowest + consistency.AXIAL_RESOLVED)
        if share >= consistency.LEAST_PROJECTED:
            end[1] += share * square / (1.0 + square) * (parabola - end[1])
        return end

    for angle in np.geomspace(0.05, 100.0, 1000):
        step = projected(coming * angle, angle) @ projected(angle, coming * angle)
        assert np.abs(np.linalg.eigvals(step)).max() <= 1.0
