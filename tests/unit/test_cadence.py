"""Which outputs come with shapes and states."""

import math

import pytest

from cablemodel.cadence import SHAPE_BYTES, STATE_BYTES, Cadence
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
