"""Run every contestant on every scene and keep the raw measurements."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from benchmarks import references
from benchmarks.contestants import (
    MODELS,
    TOLERANCES,
    cablemodel_contestants,
    moordyn_contestants,
)
from benchmarks.measure import Contestant, Measurement, measure
from benchmarks.scenes import SCENES, BenchmarkScene

QUICK_TOLERANCES = (1e-3, 1e-4)
QUICK_SEGMENTS = 20


def contestants_for(
    scene: BenchmarkScene, quick: bool, ours: bool, peers: bool
) -> list[Contestant]:
    """Everyone who takes part in a scene."""
    chosen: list[Contestant] = []
    if ours:
        models = MODELS[:1] if quick else MODELS
        chosen += cablemodel_contestants(models, QUICK_TOLERANCES if quick else TOLERANCES)
    if peers:
        chosen += moordyn_contestants(scene.name, QUICK_SEGMENTS if quick else 10_000)
    return chosen


def run(
    names: Iterable[str],
    quick: bool = False,
    ours: bool = True,
    peers: bool = True,
    report: Callable[[Measurement], None] = lambda _measurement: None,
) -> list[Measurement]:
    """Measure; ``report`` is called with every result as it comes."""
    results = []
    for name in names:
        scene = SCENES[name]
        for contestant in contestants_for(scene, quick, ours, peers):
            reference = references.choose(name, contestant.reference)
            if scene.name == "S2a":
                # Too few instants of the prototype lie before the whip; in air the factor
                # sqrt(e) on the drag is far below the errors compared here.
                reference = references.choose(name, "fine")
            result = measure(contestant, scene, reference)
            results.append(result)
            report(result)
    return results
