"""Which outputs come with shapes and states."""

import math

import pytest

from cablemodel import SceneError
from cablemodel.results.cadence import (
    MOST_OUTPUTS,
    SHAPE_BYTES,
    STATE_BYTES,
    Cadence,
    check_outputs,
    output_times,
)
from cablemodel.variables import STATE_LABELS


def test_short_runs_keep_everything() -> None:
    assert Cadence.of(401, 64, 0.5) == Cadence(shapes=1, states=1)
    assert Cadence.of(0, 64, 0.5) == Cadence(shapes=1, states=1)


def test_an_hour_at_20_hz_with_64_nodes() -> None:
    assert Cadence.of(72001, 64, 0.05) == Cadence(shapes=2, states=20)


@pytest.mark.parametrize("outputs", [1_000, 30_000, 72_001, 1_000_000, 86_400_000])
@pytest.mark.parametrize("nodes", [2, 64, 1000])
def test_budgets_are_kept_and_used(outputs: int, nodes: int) -> None:
    found = Cadence.of(outputs, nodes, 0.1)
    for every, size, budget in (
        (found.shapes, 24 * nodes, SHAPE_BYTES),
        (found.states, 8 * len(STATE_LABELS) * nodes, STATE_BYTES),
    ):
        assert str(every).rstrip("0") in ("1", "2", "5")
        assert outputs * size / every <= budget
        assert every == 1 or outputs * size / every > 0.39 * budget
    assert found.states >= found.shapes


def test_the_user_may_ask_for_states() -> None:
    assert Cadence.of(72001, 64, 0.05, 0.05) == Cadence(shapes=1, states=1)
    assert Cadence.of(72001, 64, 0.05, 0.12) == Cadence(shapes=2, states=2)
    assert Cadence.of(101, 64, 0.5, 10.0) == Cadence(shapes=1, states=20)
    assert Cadence.of(101, 64, 0.5, 0.1) == Cadence(shapes=1, states=1)


@pytest.mark.parametrize("interval", [0.0, -1.0, math.nan, math.inf])
def test_an_interval_is_a_positive_time(interval: float) -> None:
    with pytest.raises(ValueError, match="state_interval"):
        Cadence.of(101, 64, 0.5, interval)


@pytest.mark.parametrize(
    ("end", "interval", "count", "least", "latest"),
    [
        (10.0, 1e-9, "10,000,000,000", "1e-06", "0.01"),
        (1e12, 0.5, "2,000,000,000,000", "100000", "5e+06"),
        (1e30, 1e-30, "1e+60", "1e+23", "1e-23"),
    ],
)
def test_outputs_without_number_are_refused_before_they_are_made(
    end: float, interval: float, count: str, least: str, latest: str
) -> None:
    with pytest.raises(SceneError) as refused:
        output_times(0.0, end, interval)
    assert refused.value.path == "run.output_interval"
    assert f"makes {count} outputs" in str(refused.value)
    assert f"at most 10,000,000: an output_interval of at least {least} s" in str(refused.value)
    assert f"(run.duration, until) of at most {latest} s" in str(refused.value)


def test_what_a_refusal_allows_is_allowed() -> None:
    check_outputs(0.0, 7.3, 7.3e-7)
    with pytest.raises(SceneError) as refused:
        check_outputs(0.0, 7.3, 7.2e-7)
    least = float(refused.value.allowed.partition("at least ")[2].split()[0])
    check_outputs(0.0, 7.3, least)
    check_outputs(5.0, 5.0 + MOST_OUTPUTS * 0.5, 0.5)
