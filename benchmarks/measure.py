"""Measure one contestant on one scene: CPU time of stepping alone, and the error it ends with."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from benchmarks.references import Reference
from benchmarks.scenes import BenchmarkScene

ENOUGH_CPU_SECONDS = 1.0
"""Repeating stops once the timed runs have taken this long together [s]."""
LONG_RUN_SECONDS = 5.0
"""A run longer than this is neither warmed up nor repeated [s]."""


def best(
    run: Callable[[], object], repeats: int = 7, before: Callable[[], object] = lambda: None
) -> float:
    """Processor time of the fastest of several calls [s]; `before` each of them, untimed."""
    shortest = float("inf")
    for _ in range(repeats):
        before()
        start = time.process_time()
        run()
        shortest = min(shortest, time.process_time() - start)
    return shortest


@cache
def clock_cost() -> float:
    """CPU time that two readings of the clock see between them when nothing is done [s]."""
    costs = []
    for _ in range(1000):
        start = time.process_time()
        costs.append(time.process_time() - start)
    return statistics.median(costs)


class Runner(Protocol):
    """One instance of a scene in one simulator, ready at t = 0."""

    def advance(self, time: float) -> None:
        """Step to that time [s]; the only call whose CPU time counts."""

    def tip(self) -> NDArray[np.float64]:
        """The point that is compared, the free end as a rule, relative to the vessel (3,) [m]."""

    def top_tension(self) -> float:
        """Magnitude of the force of the cable on the vessel [N]."""

    def statistics(self) -> dict[str, float]:
        """What the simulator counts (steps, elements, ...)."""

    def close(self) -> None:
        """Free what the simulator holds."""


@dataclass(frozen=True)
class Contestant:
    """A simulator with its settings.

    name: the simulator and the settings that a curve shares; setting: what varies along it.
    make: builds a runner for a scene that will be stopped at the given times [s].
    reference: which set of references it is compared with (see benchmarks.references).
    compiles: whether its first run in a process may spend time on compiling.
    """

    name: str
    setting: str
    make: Callable[[BenchmarkScene, Sequence[float]], Runner]
    reference: str
    compiles: bool = False


@dataclass
class Measurement:
    """What came out. Errors are infinite and the cost is that until the failure if it failed."""

    scene: str
    contestant: str
    setting: str
    cost: float
    tip_error: float
    tension_error: float | None
    simulated: float
    repeats: int
    spread: float
    statistics: dict[str, float] = field(default_factory=dict)
    failure: str | None = None


def run_once(
    contestant: Contestant, scene: BenchmarkScene, reference: Reference
) -> tuple[float, NDArray[np.float64], NDArray[np.float64], dict[str, float]]:
    """One run through all reference times.

    Returns CPU seconds of stepping, tip (n, 3) [m], tension (n,) [N] and the counts. What reading
    the clock takes is not counted.
    """
    times = reference.times
    runner = contestant.make(scene, times)
    tips = np.empty((len(times), 3))
    tensions = np.empty(len(times))
    spent = 0.0
    try:
        for index, instant in enumerate(times):
            start = time.process_time()
            runner.advance(instant)
            spent += max(0.0, time.process_time() - start - clock_cost())
            tips[index] = runner.tip()
            tensions[index] = runner.top_tension()
        counts = runner.statistics()
    finally:
        runner.close()
    return spent, tips, tensions, counts


def errors(
    scene: BenchmarkScene,
    reference: Reference,
    tips: NDArray[np.float64],
    tensions: NDArray[np.float64],
) -> tuple[float, float | None]:
    """Largest tip error over the length, and largest tension error over the largest tension.

    tips: (n, 3) [m]; tensions: (n,) [N]. The second is None where the reference has no tension.
    """
    distance = np.linalg.norm(tips - reference.tip_array(), axis=1)
    known = ~np.isnan(reference.tip_array()[:, 0])
    tip_error = float(distance[known].max()) / scene.cable.length
    if reference.tension is None:
        return tip_error, None
    expected = np.array(reference.tension)
    return tip_error, float(np.abs(tensions - expected).max() / expected.max())


def measure(
    contestant: Contestant, scene: BenchmarkScene, reference: Reference, max_repeats: int = 25
) -> Measurement:
    """Median cost of repeated runs after a warm-up, and the errors of the last one.

    A failing contestant gives a measurement that says so; nothing is raised.
    """
    simulated = reference.times[-1]
    try:
        spent, tips, tensions, counts = run_once(contestant, scene, reference)
        if contestant.compiles and spent >= LONG_RUN_SECONDS:
            spent, tips, tensions, counts = run_once(contestant, scene, reference)
        costs = [spent]
        if spent < LONG_RUN_SECONDS:
            costs = []
            while len(costs) < max_repeats and (len(costs) < 3 or sum(costs) < ENOUGH_CPU_SECONDS):
                spent, tips, tensions, counts = run_once(contestant, scene, reference)
                costs.append(spent)
    except Exception as error:  # a peer may fail in any way, and that is a result
        return Measurement(
            scene=scene.name,
            contestant=contestant.name,
            setting=contestant.setting,
            cost=float("nan"),
            tip_error=float("inf"),
            tension_error=None,
            simulated=simulated,
            repeats=0,
            spread=0.0,
            failure=f"{type(error).__name__}: {error}"[:200],
        )
    tip_error, tension_error = errors(scene, reference, tips, tensions)
    middle = statistics.median(costs)
    return Measurement(
        scene=scene.name,
        contestant=contestant.name,
        setting=contestant.setting,
        cost=middle / simulated,
        tip_error=tip_error,
        tension_error=tension_error,
        simulated=simulated,
        repeats=len(costs),
        spread=(max(costs) - min(costs)) / middle if middle > 0.0 else 0.0,
        statistics=counts,
        failure=None if np.isfinite(tip_error) else "not finite",
    )
