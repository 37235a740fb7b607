"""Statistics against closed forms, and cycles against the example of the standard."""

import math

import numpy as np
import pytest

from cablemodel.analysis import (
    Cycles,
    FatigueCurve,
    cycles,
    damage,
    equivalent_range,
    extreme_value,
    extremes,
    spectrum,
)


def sine(amplitude: float = 3.0, period: float = 8.0, mean: float = 50.0) -> tuple:
    time = np.arange(0.0, 100 * period, 0.05)
    return time, mean + amplitude * np.sin(2 * math.pi * time / period)


def test_extremes_of_a_sine() -> None:
    found = extremes(*sine())
    assert found.mean == pytest.approx(50.0, abs=1e-3)
    assert found.standard_deviation == pytest.approx(3.0 / math.sqrt(2.0), rel=1e-4)
    assert found.minimum == pytest.approx(47.0, abs=1e-9)
    assert found.maximum == pytest.approx(53.0, abs=1e-9)
    assert found.time_of_maximum % 8.0 == pytest.approx(2.0)
    assert found.time_of_minimum % 8.0 == pytest.approx(6.0)
    assert found.zero_crossing_period == pytest.approx(8.0, rel=1e-4)


def test_the_mean_is_over_time_and_not_over_samples() -> None:
    time = np.concatenate([np.linspace(0.0, 1.0, 1000), [10.0]])  # dense where the ramp begins
    found = extremes(time, 2.0 * time)
    assert found.mean == pytest.approx(10.0)
    # The trapezoidal rule sees the square of a ramp: 20^2 / 12 by the integral.
    assert found.standard_deviation > math.sqrt(400.0 / 12.0)


def test_what_is_no_number_is_left_out() -> None:
    found = extremes([0.0, 1.0, 2.0, 3.0], [math.nan, 5.0, 7.0, math.nan])
    assert (found.minimum, found.maximum, found.mean) == (5.0, 7.0, 6.0)
    assert (found.time_of_minimum, found.time_of_maximum) == (1.0, 2.0)
    with pytest.raises(ValueError, match="no finite values"):
        extremes([0.0, 1.0], [math.nan, math.nan])
    with pytest.raises(ValueError, match="equal length"):
        extremes([0.0, 1.0], [1.0])


def test_a_constant_has_no_period() -> None:
    found = extremes(np.arange(100.0), np.full(100, 0.1))
    assert math.isnan(found.zero_crossing_period)
    assert found.standard_deviation == pytest.approx(0.0, abs=1e-15)
    assert extremes([1.0], [4.0]).mean == 4.0


def test_the_spectrum_of_a_sine() -> None:
    time, values = sine(amplitude=3.0, period=8.0)
    found = spectrum(time, values, segment=80.0)
    assert found.peak_period == pytest.approx(8.0, rel=1e-6)
    assert found.significant == pytest.approx(4 * 3.0 / math.sqrt(2.0), rel=1e-3)
    assert found.zero_crossing_period == pytest.approx(8.0, rel=0.01)
    assert found.frequency[1] == pytest.approx(1 / 80.0)


def test_the_density_of_white_noise_is_its_variance_over_the_band() -> None:
    random = np.random.default_rng(1)
    found = spectrum(0.1 * np.arange(100_000), random.normal(0.0, 2.0, 100_000))
    assert found.moment(0) == pytest.approx(4.0, rel=0.03)
    middle = found.density[len(found.density) // 4 : -len(found.density) // 4]
    assert np.mean(middle) == pytest.approx(4.0 / 5.0, rel=0.03)


@pytest.mark.parametrize("period", [5.0, 9.0, 10.0, 12.0])
def test_the_peak_period_of_a_minute_of_swell(period: float) -> None:
    time = np.arange(0.0, 60.0, 0.2)
    found = spectrum(time, 1e4 + 400.0 * np.sin(2 * math.pi * time / period))
    assert found.peak_period == pytest.approx(period, rel=0.02)


def test_a_spectrum_of_uneven_times_is_that_of_even_ones() -> None:
    time, values = sine()
    uneven = time + 0.01 * np.sin(time)
    again = 50.0 + 3.0 * np.sin(2 * math.pi * uneven / 8.0)
    one, other = spectrum(time, values), spectrum(uneven, again)
    assert other.peak_period == pytest.approx(one.peak_period, rel=1e-3)
    assert other.significant == pytest.approx(one.significant, rel=1e-3)


def test_a_short_last_step_of_a_run_bends_no_spectrum() -> None:
    time, values = sine()
    time, values = np.append(time, time[-1] + 0.013), np.append(values, 50.0)
    assert spectrum(time, values).peak_period == pytest.approx(8.0, rel=1e-3)


def test_a_spectrum_needs_values() -> None:
    with pytest.raises(ValueError, match="at least 8"):
        spectrum([0.0, 1.0], [0.0, 1.0])
    with pytest.raises(ValueError, match="a segment of 1 s"):
        spectrum(np.arange(100.0), np.arange(100.0), segment=1.0)
    still = spectrum(np.arange(100.0), np.ones(100))
    assert math.isnan(still.peak_period)
    assert math.isnan(still.zero_crossing_period)


def test_cycles_of_the_example_in_the_standard() -> None:
    """ASTM E1049-85, figure 6: ranges 3, 4, 6, 8, 9 with 0.5, 1.5, 0.5, 1, 0.5 cycles."""
    found = cycles([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0])
    counts: dict[float, float] = {}
    for size, count in zip(found.range.tolist(), found.count.tolist(), strict=True):
        counts[size] = counts.get(size, 0.0) + count
    assert counts == {9.0: 0.5, 8.0: 1.0, 6.0: 0.5, 4.0: 1.5, 3.0: 0.5}
    assert np.all(np.diff(found.range) <= 0.0)


def test_a_series_that_does_not_turn_has_no_whole_cycles() -> None:
    assert cycles([]).count.sum() == 0.0
    assert cycles([1.0, 2.0, 3.0]).count.tolist() == [0.5]
    assert cycles([1.0, math.nan, 1.0]).count.sum() in (0.0, 0.5)


def test_the_damage_of_a_sine() -> None:
    counted = cycles(sine(amplitude=3.0)[1])
    assert counted.count.sum() == pytest.approx(100.0, abs=1.0)
    curve = FatigueCurve(intercept=1e6, slope=3.0)
    assert damage(counted, curve) == pytest.approx(100.0 / (1e6 / 6.0**3), rel=0.02)
    scaled = FatigueCurve(intercept=1e6, slope=3.0, reference=600.0)
    assert damage(counted, scaled) == pytest.approx(100.0 / (1e6 / 0.01**3), rel=0.02)
    assert equivalent_range(counted, 3.0, counted.count.sum()) == pytest.approx(6.0, rel=0.01)
    assert equivalent_range(counted, 3.0, 8 * counted.count.sum()) == pytest.approx(3.0, rel=0.01)


def test_a_curve_of_two_branches_is_continuous() -> None:
    # DNV-RP-C203, curve D in air: log a 12.164 and 15.606, m 3 and 5, knee at 1e7.
    curve = FatigueCurve(10**12.164, 3.0, knee=1e7, second_slope=5.0)
    knee = (10**12.164 / 1e7) ** (1 / 3)
    assert curve.cycles_to_failure([knee])[0] == pytest.approx(1e7)
    assert curve.cycles_to_failure([100.0])[0] == pytest.approx(10**12.164 / 1e6)
    assert curve.cycles_to_failure([20.0])[0] == pytest.approx(10**15.606 / 20.0**5, rel=0.01)
    limit = FatigueCurve(10**12.164, 3.0, knee=1e7)
    assert limit.cycles_to_failure([20.0])[0] == math.inf
    none = Cycles(np.array([20.0, 0.0]), np.zeros(2), np.ones(2))
    assert damage(none, limit) == 0.0


@pytest.mark.parametrize("wrong", [{"intercept": 0.0}, {"slope": -3.0}, {"reference": 0.0}])
def test_a_curve_is_of_positive_numbers(wrong: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="must be positive"):
        FatigueCurve(**{"intercept": 1e6, "slope": 3.0, **wrong})


def test_an_equivalent_range_needs_cycles() -> None:
    with pytest.raises(ValueError, match="must be positive"):
        equivalent_range(cycles([0.0, 1.0, 0.0]), 3.0, 0.0)
    assert equivalent_range(cycles([1.0, 1.0, 1.0]), 3.0, 10.0) == 0.0


def test_the_extreme_of_a_rayleigh_process() -> None:
    """Maxima of a narrow-band process: most probable sigma sqrt(2 ln N) in N cycles."""
    random = np.random.default_rng(2)
    time = np.arange(0.0, 36_000.0, 0.5)
    frequency = np.linspace(0.09, 0.11, 200)
    phase = random.uniform(0.0, 2 * math.pi, 200)
    amplitude = random.rayleigh(math.sqrt(1.0 / 200.0), 200)
    values = np.zeros(len(time))
    for a, f, p in zip(amplitude, frequency, phase, strict=True):
        values += a * np.cos(2 * math.pi * f * time + p)
    sigma = np.std(values)
    found = extreme_value(time, values, duration=3 * 3600.0, blocks=40)
    assert found == pytest.approx(sigma * math.sqrt(2 * math.log(1080.0)), rel=0.08)
    assert extreme_value(time, values, duration=36_000.0, blocks=40) > found


def test_an_extreme_needs_blocks() -> None:
    with pytest.raises(ValueError, match="too few"):
        extreme_value(np.arange(50.0), np.arange(50.0))
    with pytest.raises(ValueError, match="duration"):
        extreme_value(np.arange(500.0), np.arange(500.0), duration=0.0)
