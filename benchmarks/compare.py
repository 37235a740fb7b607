"""Compare contestants at equal error: cheapest curve of each, interpolated in log-log."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from benchmarks.measure import Measurement
from benchmarks.scenes import Target

Point = tuple[float, float]
"""(tip error [-], CPU seconds per simulated second [-])."""


def by_tolerance(measurement: Measurement) -> bool:
    """Whether one tolerance is all that a contestant was given: it promises an error."""
    return measurement.setting.startswith("tau=")


def without_luck(measurements: Iterable[Measurement]) -> list[Point]:
    """Points; what errs by less than at a finer tolerance does so by chance, and has the larger
    error. Peers whose settings were searched keep their luck."""
    valid = [
        m
        for m in measurements
        if m.failure is None and m.tip_error > 0.0 and math.isfinite(m.tip_error)
    ]
    points = [(m.tip_error, m.cost) for m in valid if not by_tolerance(m)]
    promised = [m for m in valid if by_tolerance(m)]
    for one in promised:
        tau = tolerance_of(one)
        finer = (
            m.tip_error
            for m in promised
            if m.contestant == one.contestant and tolerance_of(m) <= tau
        )
        points.append((max(finer), one.cost))
    return points


def tolerance_of(measurement: Measurement) -> float:
    """Of a setting ``tau=1e-3``."""
    return float(measurement.setting.removeprefix("tau="))


def front(measurements: Iterable[Measurement]) -> list[Point]:
    """Points that no other beats in both error and cost, from large to small error."""
    points = sorted(without_luck(measurements))
    best: list[Point] = []
    cheapest = math.inf
    for error, cost in points:
        if cost < cheapest:
            best.append((error, cost))
            cheapest = cost
    return best[::-1]


def cost_at(points: Sequence[Point], error: float) -> tuple[float, bool] | None:
    """Cost of reaching an error, on the straight lines between the points in log-log.

    Returns the cost and whether it is extrapolated (with the slope of the last two points).
    An error larger than any that was measured costs as much as the cheapest point (nothing is
    gained by assuming that the contestant could be made cheaper still). None without points.
    """
    if not points:
        return None
    if error >= points[0][0]:
        return points[0][1], False
    logs = [(math.log(e), math.log(c)) for e, c in points]
    wanted = math.log(error)
    for (e1, c1), (e2, c2) in itertools.pairwise(logs):
        if e2 <= wanted <= e1:
            return math.exp(c1 + (c2 - c1) * (wanted - e1) / (e2 - e1)), False
    if len(logs) < 2:
        return None
    (e1, c1), (e2, c2) = logs[-2:]
    return math.exp(c2 + (c2 - c1) * (wanted - e2) / (e2 - e1)), True


@dataclass(frozen=True)
class Ratio:
    """How many times cheaper we are than a peer at one tip error."""

    scene: str
    peer: str
    tip_error: float
    ours: float
    theirs: float
    ours_extrapolated: bool
    theirs_extrapolated: bool

    @property
    def ratio(self) -> float:
        """Their cost over ours [-]."""
        return self.theirs / self.ours


def ratio(
    scene: str,
    peer: str,
    tip_error: float,
    ours: Sequence[Measurement],
    theirs: Sequence[Measurement],
) -> Ratio | None:
    """Ratio at one error, or None where one of the two has no curve to read."""
    our_cost = cost_at(front(ours), tip_error)
    their_cost = cost_at(front(theirs), tip_error)
    if our_cost is None or their_cost is None:
        return None
    return Ratio(
        scene=scene,
        peer=peer,
        tip_error=tip_error,
        ours=our_cost[0],
        theirs=their_cost[0],
        ours_extrapolated=our_cost[1],
        theirs_extrapolated=their_cost[1],
    )


def cheapest_within(measurements: Iterable[Measurement], target: Target) -> Measurement | None:
    """The cheapest measurement that keeps both errors that are asked for; None: none does."""
    good = [
        m
        for m in measurements
        if m.failure is None
        and m.tip_error <= target.tip_error
        and (
            target.tension_error is None
            or m.tension_error is None
            or m.tension_error <= target.tension_error
        )
    ]
    return min(good, key=lambda m: m.cost, default=None)
