"""Shares of an element that are wet, against quadrature of its wet part."""

import itertools

import numba
import numpy as np
import pytest
from scipy.integrate import quad

from cablemodel.solvers.finite_element.kernels.element.tables import P1, WEIGHT
from cablemodel.solvers.finite_element.kernels.water.wetting import share_at, wet_shares
from cablemodel.solvers.shared.compile import OPTIONS, record_at
from cablemodel.solvers.shared.layout import ElementPoints

POINTS = np.asarray(P1)[:3]
points_at = record_at(ElementPoints)


@numba.jit(**OPTIONS)
def shares_of(words, half):
    wet_shares(points_at(words, 0), half)


@numba.jit(**OPTIONS)
def share_of(depth, half):
    return share_at(depth, half)


def shares(depths, half):
    """Shares and slopes at the three Gauss points of an element, by the depths there."""
    words = np.zeros(ElementPoints.WORDS)
    points = ElementPoints(words)
    points.wet[:3] = depths
    shares_of(words, half)
    return points.wet[:3], points.wet_slope[:3]


def depth_along(depths):
    """The quadratic through the depths of the Gauss points, x in [-1, 1]."""
    return np.polynomial.Polynomial.fit(POINTS, depths, 2)


CASES = [
    [3.0, 1.0, -1.0],  # a straight element
    [-2.0, 0.4, 0.9],
    [0.5, -0.2, 0.5],  # an arch through a flat surface, or a crest on a flat element: crossed twice
    [-0.3, 0.1, -0.3],
    [1.4, 0.3, -0.02],  # crossed near its end, beyond the last Gauss point
    [0.01, -0.005, 0.012],  # all of it in the band
    [0.2, 0.02, 0.015],
]


@pytest.mark.parametrize("depths", CASES)
@pytest.mark.parametrize("half", [1e-3, 0.02, 0.5])
def test_the_rule_with_shares_integrates_the_wet_part(depths, half):
    """Loads that are quadratic along the element, to the share's own quadrature."""
    found, _slopes = shares(depths, half)
    depth = depth_along(depths)
    # Where the share changes its form: quadrature is told.
    kinks = [
        float(root.real)
        for edge in (-half, half)
        for root in (depth - edge).roots()
        if abs(root.imag) < 1e-12 and -1.0 < root.real < 1.0
    ]
    for power in range(3):
        expected = 0.0
        for low, high in itertools.pairwise([-1.0, *sorted(kinks), 1.0]):
            expected += quad(lambda x, n=power: x**n * share_of(depth(x), half)[0], low, high)[0]
        rule = float(np.sum(WEIGHT[:3] * found * POINTS**power))
        assert rule == pytest.approx(0.5 * expected, abs=1e-6)


@pytest.mark.parametrize("depths", CASES)
def test_slopes_are_derivatives_by_the_height(depths):
    half, up = 0.05, 1e-6
    _shares, slopes = shares(depths, half)
    above = shares(np.array(depths) - up, half)[0]
    below = shares(np.array(depths) + up, half)[0]
    np.testing.assert_allclose(slopes, (above - below) / (2 * up), atol=1e-4 * np.ptp(slopes))


def test_far_from_the_surface_all_is_wet_or_dry():
    assert shares([5.0, 4.0, 3.0], 0.01)[0].tolist() == [1.0, 1.0, 1.0]
    assert shares([-5.0, -4.0, -3.0], 0.01)[0].tolist() == [0.0, 0.0, 0.0]
    assert not shares([5.0, 4.0, 3.0], 0.01)[1].any()


def test_an_element_that_lies_in_the_surface_is_wet_by_the_share_of_its_depth():
    for depth in (-0.015, -0.004, 0.0, 0.013):
        share, rate = share_of(depth, 0.02)
        found, slopes = shares([depth] * 3, 0.02)
        np.testing.assert_allclose(found, share, rtol=1e-12)
        np.testing.assert_allclose(slopes, -rate, rtol=1e-12)


def test_shares_change_smoothly_while_an_element_sinks():
    """One of 3 m that stands: the old rule's wet length was wrong by 5 % of it."""
    sunk = np.linspace(-2.0, 2.0, 401)
    lengths = [float(WEIGHT[:3] @ shares(d - 1.5 * POINTS, 0.01)[0]) * 3.0 for d in sunk]
    np.testing.assert_allclose(lengths, np.clip(sunk + 1.5, 0.0, 3.0), atol=0.005)
