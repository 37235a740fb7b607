"""Pacing: deadlines are counted, work is merged, and being late never makes more work."""

from __future__ import annotations

from itertools import pairwise

import pytest
from cablemodel_ros.pacing import MERGE, ClockPacer, FreePacer, WallPacer
from cablemodel_ros.timing import Durations


def run(pacer, cost, seconds: float):
    """Drive a pacer with a clock of our own; cost(k) [s] is the length of cycle k."""
    now, k, targets = 100.0, 0, []
    pacer.start(now, 0.0)
    while now < 100.0 + seconds:
        plan = pacer.plan(now)
        if plan.wait > 0.0:
            now += plan.wait + 1e-6
            continue
        targets.append(plan.target)
        now += cost(k)
        k += 1
    return targets, now - 100.0


@pytest.mark.parametrize("factor", [0.5, 1.0, 7.0])
def test_simulated_time_keeps_pace(factor: float) -> None:
    pacer = WallPacer(0.01, factor)
    targets, elapsed = run(pacer, lambda k: 1e-4, 5.0)
    assert targets[-1] == pytest.approx(factor * elapsed, abs=0.011 * max(1.0, factor))
    assert pacer.missed == 0
    assert pacer.slipped == 0
    assert targets == [pytest.approx(0.01 * (k + 1), abs=1e-12) for k in range(len(targets))]


def test_a_hiccup_is_counted_and_made_up_by_longer_steps() -> None:
    pacer = WallPacer(0.01)
    targets, elapsed = run(pacer, lambda k: 0.1 if k == 50 else 1e-4, 2.0)
    assert pacer.missed == 9
    assert pacer.slipped == 0
    assert max(b - a for a, b in pairwise(targets)) == pytest.approx(0.1)
    assert targets[-1] == pytest.approx(elapsed, abs=0.02)


def test_a_model_that_is_too_slow_slips_instead_of_falling_ever_further_behind() -> None:
    pacer = WallPacer(0.01, lag_limit=0.3)
    cost = 0.15  # for at most MERGE periods: two thirds of real time
    targets, elapsed = run(pacer, lambda k: cost, 30.0)
    assert pacer.behind <= 0.3
    assert pacer.slipped > 5.0
    assert targets[-1] + pacer.slipped == pytest.approx(elapsed, abs=0.5)
    assert max(b - a for a, b in pairwise(targets)) <= MERGE * 0.01 + 1e-9


def test_publication_is_shed_only_when_the_next_deadline_has_passed() -> None:
    pacer = WallPacer(0.01)
    pacer.start(0.0, 0.0)
    assert pacer.plan(0.0101).target == pytest.approx(0.01)
    assert not pacer.late(0.0199)
    assert pacer.late(0.0201)


def test_free_running_never_waits() -> None:
    pacer = FreePacer(0.01)
    pacer.start(0.0, 2.0)
    assert [pacer.plan(0.0).target for _ in range(3)] == pytest.approx([2.01, 2.02, 2.03])


def steps(pacer: ClockPacer, now: float) -> list[float]:
    found = []
    while (target := pacer.plan(now).target) is not None:
        found.append(target)
    return found


def test_a_foreign_clock_is_followed_pauses_included() -> None:
    pacer = ClockPacer(0.01)
    pacer.start(50.0, 0.0)
    assert steps(pacer, 50.004) == []
    assert steps(pacer, 50.01) == pytest.approx([0.01])
    assert steps(pacer, 50.01) == []
    assert steps(pacer, 50.035) == pytest.approx([0.03])
    assert steps(pacer, 50.5)[-1] == pytest.approx(0.5)
    assert not pacer.jumped


def test_a_foreign_clock_that_jumps_is_told() -> None:
    for jump in (49.0, 200.0):
        pacer = ClockPacer(0.01)
        pacer.start(50.0, 0.0)
        assert steps(pacer, jump) == []
        assert pacer.jumped


def test_percentiles_of_durations_are_within_a_bin() -> None:
    durations = Durations()
    for k in range(1, 1001):
        durations.add(1e-5 * k)
    assert durations.count == 1000
    assert durations.mean == pytest.approx(5.005e-3)
    for share in (50.0, 99.0, 99.9):
        assert durations.percentile(share) == pytest.approx(1e-4 * share, rel=0.05)
    durations.add(1e9)
    assert durations.largest == 1e9
    assert durations.percentile(100.0) == pytest.approx(100.0, rel=0.05)  # the last bin's edge


def test_the_table_of_durations_counts_everything_once() -> None:
    durations = Durations()
    for duration, count in ((1.5e-4, 3), (3e-4, 5), (7e-3, 1)):
        for _ in range(count):
            durations.add(duration)
    assert durations.table() == {"0.1-0.2": 3, "0.2-0.5": 5, "5-10": 1}
