"""Pacing: deadlines are counted, work is merged, and being late never makes more work."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

import pytest
from cablemodel_ros.pacing import MERGE, ClockPacer, FreePacer, WallPacer
from cablemodel_ros.times import Monotonic, Simulated, Stamp
from cablemodel_ros.timing import Durations


class Hand:
    """A clock that a test moves; `kind` is Monotonic or Stamp."""

    def __init__(self, kind: Any, now: float) -> None:
        self._kind, self.now = kind, now

    def __call__(self) -> Any:
        return self._kind(0) + self.now


def wall(*arguments: float, **named: float) -> tuple[WallPacer, Hand]:
    clock = Hand(Monotonic, 100.0)
    return WallPacer(*arguments, **named, clock=clock), clock


def run(paced: tuple[WallPacer, Hand], cost: Any, seconds: float) -> tuple[list[float], float]:
    """Drive a pacer with a clock of our own; cost(k) [s] is the length of cycle k."""
    pacer, clock = paced
    k, targets = 0, []
    pacer.start(Simulated(0.0))
    while clock.now < 100.0 + seconds:
        plan = pacer.plan()
        if plan.target is None:
            clock.now += plan.wait + 1e-6
            continue
        targets.append(plan.target.seconds)
        clock.now += cost(k)
        k += 1
    return targets, clock.now - 100.0


@pytest.mark.parametrize("factor", [0.5, 1.0, 7.0])
def test_simulated_time_keeps_pace(factor: float) -> None:
    pacer, clock = wall(0.01, factor)
    targets, elapsed = run((pacer, clock), lambda k: 1e-4, 5.0)
    assert targets[-1] == pytest.approx(factor * elapsed, abs=0.011 * max(1.0, factor))
    assert pacer.missed == 0
    assert pacer.slipped == 0
    assert targets == [pytest.approx(0.01 * (k + 1), abs=1e-12) for k in range(len(targets))]


def test_a_hiccup_is_counted_and_made_up_by_longer_steps() -> None:
    pacer, clock = wall(0.01)
    targets, elapsed = run((pacer, clock), lambda k: 0.1 if k == 50 else 1e-4, 2.0)
    assert pacer.missed == 9
    assert pacer.slipped == 0
    assert max(b - a for a, b in pairwise(targets)) == pytest.approx(0.1)
    assert targets[-1] == pytest.approx(elapsed, abs=0.02)


def test_a_model_that_is_too_slow_slips_instead_of_falling_ever_further_behind() -> None:
    pacer, clock = wall(0.01, lag_limit=0.3)
    cost = 0.15  # for at most MERGE periods: two thirds of real time
    targets, elapsed = run((pacer, clock), lambda k: cost, 30.0)
    assert pacer.behind <= 0.3
    assert pacer.slipped > 5.0
    assert targets[-1] + pacer.slipped == pytest.approx(elapsed, abs=0.5)
    assert max(b - a for a, b in pairwise(targets)) <= MERGE * 0.01 + 1e-9


def test_publication_is_shed_only_when_the_next_deadline_has_passed() -> None:
    pacer, clock = wall(0.01)
    pacer.start(Simulated(0.0))
    clock.now += 0.0101
    assert pacer.plan().target == Simulated(0.01)
    clock.now += 0.0098
    assert not pacer.late()
    clock.now += 0.0002
    assert pacer.late()


def test_a_step_is_due_when_its_deadline_is_and_slipping_moves_that() -> None:
    pacer, clock = wall(0.01)
    pacer.start(Simulated(0.0))
    clock.now += 0.0101
    assert pacer.plan().due == Monotonic(0) + 100.01
    clock.now += 2.0  # a hold-up
    assert pacer.plan().due == Monotonic(0) + clock.now
    assert pacer.slipped == pytest.approx(1.9, abs=0.01)


def test_free_running_never_waits() -> None:
    pacer = FreePacer(0.01)
    pacer.start(Simulated(2.0))
    found = [pacer.plan().target for _ in range(3)]
    assert [t.seconds for t in found if t] == pytest.approx([2.01, 2.02, 2.03])


def followed(now: float) -> tuple[ClockPacer, Hand]:
    clock = Hand(Stamp, now)
    pacer = ClockPacer(0.01, clock)
    pacer.start(Simulated(0.0))
    return pacer, clock


def steps(paced: tuple[ClockPacer, Hand], now: float) -> list[float]:
    pacer, clock = paced
    clock.now = now
    found = []
    while (target := pacer.plan().target) is not None:
        found.append(target.seconds)
    return found


def test_a_foreign_clock_is_followed_pauses_included() -> None:
    paced = followed(50.0)
    assert steps(paced, 50.004) == []
    assert steps(paced, 50.01) == pytest.approx([0.01])
    assert steps(paced, 50.01) == []
    assert steps(paced, 50.035) == pytest.approx([0.03])
    assert steps(paced, 50.5)[-1] == pytest.approx(0.5)
    assert not paced[0].jumped


@pytest.mark.parametrize("began", [0.0, 5.0, 1e9])
def test_whether_a_foreign_clock_is_met_has_nothing_to_do_with_how_long_the_machine_is_up(
    began: float,
) -> None:
    paced = followed(began)
    steps(paced, began + 1.0)
    assert not paced[0].late()
    paced[1].now = began + 1.2
    assert paced[0].late()


def test_a_foreign_clock_that_jumps_is_told() -> None:
    for jump in (49.0, 200.0):
        paced = followed(50.0)
        assert steps(paced, jump) == []
        assert paced[0].jumped


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
