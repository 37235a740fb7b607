"""Search for MoorDyn's best stable settings: scheme, time step and damping on one scene.

The space discretisation alone decides the tip error of a stable run, so a setting is called
stable when its tip error is that of the finest time step, and the best one is the cheapest of
those. Both are measured, none is assumed.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from benchmarks import references
from benchmarks.measure import Contestant, Measurement, Runner, measure
from benchmarks.peers.moordyn import MoorDynRunner, Settings
from benchmarks.scenes import SCENES, BenchmarkScene

SEGMENTS = 20
TRIED: tuple[tuple[str, float, float], ...] = (
    # scheme, step times highest frequency, share of critical damping
    ("RK4", 2.82, 0.0),
    ("RK4", 2.7, 0.0),
    ("RK4", 1.35, 0.0),
    ("RK4", 2.4, 0.4),
    ("RK4", 2.4, 0.8),
    ("RK2", 1.0, 0.0),
    ("RK2", 0.25, 0.0),
    ("RK2", 1.4, 0.2),
    ("RK2", 1.8, 0.4),
    ("RK2", 2.0, 0.8),
    ("RK2", 2.0, 0.6),
    ("RK2", 2.2, 0.8),
    ("RK2", 2.0, 1.0),
    ("Heun", 0.5, 0.0),
    ("Heun", 0.5, 0.8),
    ("Euler", 0.05, 0.8),
    ("AB2", 0.25, 0.0),
    ("AB2", 0.25, 0.8),
    ("AB4", 0.1, 0.0),
    ("AB4", 0.1, 0.8),
    ("BEuler5", 1.0, 0.0),
    ("Midpoint5", 1.0, 0.0),
    ("Midpoint10", 2.0, 0.0),
    ("ACA5", 1.0, 0.0),
    ("Wilson5", 1.0, 0.0),
)


def search(
    scene: BenchmarkScene = SCENES["S1"],
    tried: Sequence[tuple[str, float, float]] = TRIED,
    report: Callable[[Measurement], None] = lambda _measurement: None,
) -> list[Measurement]:
    """One run per setting."""
    reference = references.choose(scene.name, "prototype")
    results = []
    for scheme, factor, damping in tried:
        settings = Settings(SEGMENTS, scheme, factor, damping)

        def make(
            scene: BenchmarkScene, times: Sequence[float], settings: Settings = settings
        ) -> Runner:
            return MoorDynRunner(scene, times, settings)

        name = f"MoorDyn {scheme}"
        setting = f"dt = {factor:g}/omega_max, zeta = {damping:g}"
        result = measure(Contestant(name, setting, make, "prototype"), scene, reference, 1)
        results.append(result)
        report(result)
    return results
