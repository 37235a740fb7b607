"""Kinds of time: none is taken for another, neither by Python nor by mypy."""

from __future__ import annotations

import itertools
from pathlib import Path

import pytest
from cablemodel_ros.timebase import Followed, Published, RealTime
from cablemodel_ros.times import Moment, Monotonic, Simulated, Stamp
from clocks_by_hand import Clocks

ROOT = Path(__file__).parents[3]
KINDS = (Monotonic, Stamp, Moment, Simulated)


@pytest.mark.parametrize(("one", "other"), list(itertools.permutations(KINDS, 2)))
def test_instants_of_two_kinds_are_neither_subtracted_nor_compared(one: type, other: type) -> None:
    with pytest.raises(TypeError):
        one(1) - other(1)
    with pytest.raises(TypeError):
        one(1) < other(2)  # noqa: B015
    assert one(1) != other(1)
    assert one(3) - one(3) == 0.0


def test_mypy_refuses_to_mix_them(tmp_path: Path) -> None:
    api = pytest.importorskip("mypy.api")
    lines = [
        "from cablemodel_ros.times import Monotonic, Simulated, Stamp",
        "x: float = Stamp(1) - Stamp(0)",
        "Stamp(1) - Monotonic(1)",
        "Stamp(1) + Stamp(1)",
        "Monotonic(1) < Stamp(1)",
        "Simulated(1.0) - Stamp(1)",
    ]
    wrong = tmp_path / "mixed.py"
    wrong.write_text("\n".join(lines))
    config = tmp_path / "mypy.ini"
    config.write_text(f"[mypy]\nstrict = True\nmypy_path = {ROOT / 'ros2_node'}\n")
    said, _, _ = api.run(["--config-file", str(config), "--cache-dir", str(tmp_path), str(wrong)])
    refused = {int(line.split(":")[1]) for line in said.splitlines() if ": error:" in line}
    assert refused == {3, 4, 5, 6}, said


def test_real_time_begins_at_the_ros_clock_and_ages_by_the_monotonic_one() -> None:
    clocks = Clocks(ros=1000.0, up=7.0)
    base = clocks.timebase
    base.begin(Simulated(3.0))
    assert base.stamp(Simulated(3.5)) == Stamp(0) + 1000.5
    arrival = base.arrival(clocks.ros + -0.2)
    assert (arrival.now.seconds, arrival.made.seconds) == pytest.approx((7.0, 6.8))
    assert base.arrival(None).delay == 0.0
    assert base.at(Simulated(4.0), Monotonic(0) + 8.0) == Moment(0) + 8.0


def test_a_clock_that_runs_evenly_was_not_set_and_one_that_was_is_seen_once() -> None:
    clocks = Clocks()
    clocks.timebase.begin(Simulated(0.0))
    for step in (0.0, 0.01, -20.0, 30.0):
        clocks.set(step)
        clocks.wait(0.2)
        assert clocks.timebase.follow_clock_step() == (abs(step) > 0.05)
        clocks.wait(0.2)
        assert not clocks.timebase.follow_clock_step()
    assert clocks.timebase.clock_steps == 2


def test_a_thread_that_is_held_up_between_two_readings_is_no_clock_that_was_set() -> None:
    readings = iter([Monotonic(0), Monotonic(0), Monotonic(0) + 1.0, Monotonic(0) + 4.0])
    base = RealTime(lambda: Stamp(0) + 1.0, lambda: next(readings))
    base.begin(Simulated(0.0))
    assert not base.follow_clock_step()


def test_published_time_counts_from_zero_and_goes_on_over_resets() -> None:
    base = Published()
    base.begin(Simulated(0.0))
    base.reached(Simulated(12.0))
    base.begin(Simulated(0.0))
    assert base.stamp(Simulated(0.5)) == Stamp(0) + 12.5
    base.reached(Simulated(0.5))
    assert base.arrival(Stamp(0) + 12.4).delay == pytest.approx(0.1)


def test_followed_time_is_the_foreign_clock_also_after_it_began_anew() -> None:
    now: list[Stamp | None] = [None]
    base = Followed(lambda: now[0])
    assert base.ros_now() == Stamp(0)
    for begin in (100.0, 5.0):
        now[0] = Stamp(0) + begin
        base.begin(Simulated(2.0))
        assert base.stamp(Simulated(2.25)) == Stamp(0) + (begin + 0.25)
        assert base.at(Simulated(2.25), None) == Moment(0) + (begin + 0.25)
