"""Thinning a run for the report keeps what matters of it."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cablemodel.results.states import States
from cablemodel.variables import STATE_LABELS
from cablemodel.views.report.samples import Along, evenly_spaced, nearest, thinned
from cablemodel.views.report.tables import number


def test_thinned_curves_keep_every_peak_and_both_ends() -> None:
    values = np.sin(np.linspace(0.0, 50.0, 72_001))
    values[40_123], values[5] = 7.0, -9.0
    kept = thinned(values)
    assert len(kept) <= 2002
    assert {0, 5, 40_123, 72_000} <= set(kept.tolist())
    assert np.all(np.diff(kept) > 0)


def test_short_curves_are_whole() -> None:
    assert np.array_equal(thinned(np.arange(2000.0)), np.arange(2000))


def test_gaps_stay_gaps() -> None:
    values = np.ones(30_000)
    values[10_000:20_000] = np.nan
    kept = thinned(values)
    assert np.isnan(values[kept]).sum() > 100
    assert np.isfinite(values[kept]).sum() > 100


@pytest.mark.parametrize("count", [1, 2, 3, 500, 501, 5000])
def test_instants_are_evenly_spaced_in_time_and_hold_both_ends(count: int) -> None:
    time = np.cumsum(np.random.default_rng(1).uniform(0.1, 0.3, count))
    chosen = evenly_spaced(time, 500)
    assert chosen[0] == 0
    assert chosen[-1] == count - 1
    assert len(chosen) == min(count, len(set(chosen.tolist())))
    if count == 5000:
        assert np.max(np.diff(time[chosen])) < 1.5 * (time[-1] - time[0]) / 499


def run_of(lengths: list[float], lowest: list[float]) -> Any:
    """A run with tension 300 N at the vessel and 200 N at the end, and these outputs."""
    matrices = []
    for length in lengths:
        matrix = np.zeros((len(STATE_LABELS), 3))
        matrix[STATE_LABELS.index("s")] = 0.0, 0.3 * length, length
        matrix[STATE_LABELS.index("tension")] = 300.0, 270.0, 200.0
        matrices.append(matrix)
    states = States(np.arange(len(lengths)) * 1.0, matrices)
    time = np.arange(len(lowest)) / (len(lowest) / len(lengths))
    return SimpleNamespace(
        shapes={"": states},
        time=time,
        tension_min=np.array(lowest),
        tension_max=np.full(len(time), 3e2),
    )


def test_curves_along_the_cable_reach_its_end() -> None:
    """Lengths that a run adds up differ in the last digits, and none of them is no end."""
    along = Along.of(run_of([300.0, 300.00000000000006, 150.7], [200.0] * 3))
    assert along.tension.values[:2, -1].tolist() == [200.0, 200.0]
    assert along.ends.tolist() == [300.0, 300.00000000000006, 150.7]
    assert along.tension.ends.tolist() == [200.0] * 3
    assert np.isnan(along.tension.values[2, along.s > 150.7]).all()


def test_the_extreme_tensions_are_those_of_the_outputs() -> None:
    """At a node the states have the mean of both sides; and there may be fewer states."""
    low = Along.of(run_of([300.0, 300.0], [200.0, 199.9])).tension.lowest
    assert (low.value, low.time, low.s) == (199.9, 1.0, 300.0)
    low = Along.of(run_of([300.0, 300.0], [200.0, 180.0, 200.0, 200.0])).tension.lowest
    assert (low.value, low.time) == (180.0, 0.5)
    assert np.isnan(low.s)


def test_nearest_time() -> None:
    assert nearest(np.array([0.0, 1.0, 5.0]), np.array([-1.0, 0.4, 0.6, 3.1, 9.0])).tolist() == [
        0, 0, 1, 2, 2,
    ]  # fmt: skip
    assert nearest(np.array([2.0]), np.array([0.0, 5.0])).tolist() == [0, 0]


@pytest.mark.parametrize(
    ("value", "scale", "text"),
    [
        (94.605, 0.0, "94.61"),
        (-1.4e-4, 94.0, "0"),
        (-24.0, 0.0, "−24.00"),
        (12345.6, 0.0, "12,346"),
        (1e9, 0.0, "1.000e+09"),
        (float("nan"), 0.0, "–"),
    ],
)
def test_numbers_have_four_digits(value: float, scale: float, text: str) -> None:
    assert number(value, scale) == text
