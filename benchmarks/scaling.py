"""Work against the number of elements: is it linear up to 10,000?"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from benchmarks.contestants import CableModelRunner, cablemodel_scene
from benchmarks.scenes import SCENES

ELEMENTS = (10, 30, 100, 300, 1000, 3000, 10_000)
SIMULATED = 10.0
"""Seconds of scene S1 that are simulated."""


@dataclass(frozen=True)
class ScalingPoint:
    """CPU seconds of stepping for one number of elements, and the steps it took."""

    elements: int
    cost: float
    steps: float


def measure_scaling(elements: Sequence[int] = ELEMENTS, repeats: int = 3) -> list[ScalingPoint]:
    """Tow S1 for ten seconds with each number of elements; the least of the repeats counts."""
    points = []
    for count in elements:
        scene = cablemodel_scene(SCENES["S1"], 1e-3, "elastica", elements=count)
        costs = []
        steps = 0.0
        for _ in range(repeats):
            runner = CableModelRunner(scene)
            # The initial statics already compiled and warmed everything that stepping needs,
            # except the very first process: the least of the repeats leaves that out.
            start = time.process_time()
            runner.advance(SIMULATED)
            costs.append(time.process_time() - start)
            steps = runner.statistics().get("steps", float("nan"))
        points.append(ScalingPoint(count, min(costs), steps))
    return points


def exponent(points: Sequence[ScalingPoint], from_elements: int = 100) -> tuple[float, float]:
    """Slope of cost, and of cost per step, against elements in log-log (least squares).

    Points below ``from_elements`` are left out: there the cost of a call is not yet small.
    """
    used = [p for p in points if p.elements >= from_elements]
    sizes = np.log([p.elements for p in used])
    cost = np.log([p.cost for p in used])
    per_step = np.log([p.cost / p.steps for p in used])
    return float(np.polyfit(sizes, cost, 1)[0]), float(np.polyfit(sizes, per_step, 1)[0])
