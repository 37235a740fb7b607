"""Run every contestant on every scene and keep the raw measurements."""

from __future__ import annotations

from collections.abc import Callable, Iterable

from benchmarks import references
from benchmarks.contestants import (
    MODELS,
    TOLERANCES,
    cablemodel_contestants,
    direct_contestants,
)
from benchmarks.measure import Contestant, Measurement, measure
from benchmarks.rivals import PEERS
from benchmarks.scenes import SCENES, BenchmarkScene

QUICK_TOLERANCES = (1e-3, 1e-4)


OURS = "ours"
PARTS = (OURS, *PEERS)


def contestants_for(scene: BenchmarkScene, part: str, quick: bool) -> list[Contestant]:
    """Everyone of a part (our solvers, or one peer) who takes part in a scene."""
    if part != OURS:
        return PEERS[part](scene.name, quick)
    models = MODELS[:1] if quick else MODELS
    chosen = cablemodel_contestants(scene.name, models, QUICK_TOLERANCES if quick else TOLERANCES)
    return chosen if quick else chosen + direct_contestants(scene.name)


def run(
    names: Iterable[str],
    part: str,
    quick: bool = False,
    report: Callable[[Measurement], None] = lambda _measurement: None,
) -> list[Measurement]:
    """Measure; ``report`` is called with every result as it comes."""
    results = []
    for name in names:
        scene = SCENES[name]
        for contestant in contestants_for(scene, part, quick):
            reference = references.choose(name, contestant.reference)
            if scene.name == "S2a":
                # Too few instants of the prototype lie before the whip; in air the factor
                # sqrt(e) on the drag is far below the errors compared here.
                reference = references.choose(name, "fine")
            result = measure(contestant, scene, reference)
            results.append(result)
            report(result)
    return results
