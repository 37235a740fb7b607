"""Curves agree with SciPy's, which they stand in for; crossings are where they must be."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline

from cablemodel.solvers.shared.curves import crossing, hermite


@pytest.mark.parametrize("count", [2, 3, 40])
def test_a_hermite_curve_and_its_derivative_are_those_of_scipy(count):
    rng = np.random.default_rng(count)
    s = np.cumsum(rng.uniform(0.1, 2.0, count))
    values, slopes = rng.normal(size=(2, 3, count))
    at = np.concatenate([s, rng.uniform(s[0] - 0.5, s[-1] + 0.5, 200)])
    wanted = CubicHermiteSpline(s, values, slopes, axis=1)
    value, slope = hermite(at, s, values, slopes)
    np.testing.assert_allclose(value, wanted(at), atol=1e-12 * np.abs(wanted(at)).max())
    wanted = wanted.derivative()(at)
    np.testing.assert_allclose(slope, wanted, atol=1e-12 * np.abs(wanted).max())


@given(
    root=st.floats(-3.0, 3.0),
    power=st.sampled_from([1, 3, 7]),
    growth=st.floats(-3.0, 3.0),
    rises=st.booleans(),
)
def test_a_crossing_is_found_wherever_it_is(root, power, growth, rises):
    def function(x):
        value = (x - root) ** power * math.exp(growth * x)
        return value if rises else -value

    low, high = -4.0, 5.0
    found = crossing(
        function, low, high, at_low=function(low), at_high=function(high), near=0.0, width=1e-9
    )
    assert found == pytest.approx(root, abs=1e-8)


def test_a_smooth_crossing_takes_few_trials():
    asked = []

    def function(x):
        asked.append(x)
        return math.cos(x) - x

    found = crossing(
        function, 0.0, 1.0, at_low=1.0, at_high=math.cos(1.0) - 1.0, near=1e-9, width=0.0
    )
    assert found == pytest.approx(0.7390851332151607, abs=1e-9)
    assert len(asked) <= 8


def test_a_jump_across_zero_counts():
    found = crossing(
        lambda x: 1.0 if x < 0.3 else -20.0,
        0.0,
        1.0,
        at_low=1.0,
        at_high=-20.0,
        near=1e-9,
        width=1e-7,
    )
    assert found == pytest.approx(0.3, abs=1e-7)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("end", [0.0, 1.0])
def test_a_function_that_is_zero_at_an_end_crosses_there(sign, end):
    found = crossing(
        lambda x: sign * (x - end),
        0.0,
        1.0,
        at_low=-sign * end,
        at_high=sign * (1.0 - end),
        near=0.0,
        width=1e-12,
    )
    assert found == pytest.approx(end, abs=1e-9)


def test_without_a_crossing_it_ends_at_an_end():
    found = crossing(lambda x: -1.0 - x, 0.0, 1.0, at_low=-1.0, at_high=-2.0, near=1e-9, width=1e-9)
    assert found == pytest.approx(0.0, abs=1e-8)
