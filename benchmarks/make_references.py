"""Compute the ``fine`` references anew: ``python -m benchmarks.make_references``.

Solved twice, at a tolerance and a number of elements far beyond any contestant's: the distance
between the two is stored as the uncertainty.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from benchmarks import references
from benchmarks.contestants import CableModelRunner, cablemodel_scene
from benchmarks.measure import Contestant, Runner, run_once
from benchmarks.references import Reference
from benchmarks.scenes import SCENES, BenchmarkScene

FINE = (1e-9, 320)
CHECK = (1e-8, 160)
"""Tolerance tau and elements of the reference, and of the solution that it is checked against."""
SIGNIFICANT = 2.0
"""Uncertainty over the distance between the two solutions [-]."""


def solve(scene: BenchmarkScene, tolerance: float, elements: int) -> tuple[np.ndarray, np.ndarray]:
    """Tip (n, 3) [m] and top tension (n,) [N] at the scene's instants."""

    def make(scene: BenchmarkScene, _times: Sequence[float]) -> Runner:
        return CableModelRunner(cablemodel_scene(scene, tolerance, "elastica", elements))

    nowhere = Reference(
        times=scene.times,
        tip=tuple((0.0, 0.0, 0.0) for _ in scene.times),
        tension=None,
        tip_uncertainty=0.0,
        tension_uncertainty=0.0,
        made="",
    )
    _, tips, tensions, _ = run_once(Contestant("", "", make, ""), scene, nowhere)
    return tips, tensions


def fine_reference(scene: BenchmarkScene) -> Reference:
    """The reference of one scene with its uncertainty."""
    tips, tensions = solve(scene, *FINE)
    check_tips, check_tensions = solve(scene, *CHECK)
    tip_distance = float(np.linalg.norm(tips - check_tips, axis=1).max())
    tension_distance = float(np.abs(tensions - check_tensions).max())
    return Reference(
        times=scene.times,
        tip=tuple((round(x, 8), round(y, 8), round(z, 8)) for x, y, z in tips.tolist()),
        tension=tuple(round(value, 6) for value in tensions.tolist()),
        tip_uncertainty=float(f"{SIGNIFICANT * tip_distance:.1e}"),
        tension_uncertainty=float(f"{SIGNIFICANT * tension_distance:.1e}"),
        made=(
            f"cablemodel, elastica, tau = {FINE[0]:g}, {FINE[1]} equal elements, against "
            f"tau = {CHECK[0]:g}, {CHECK[1]} elements; drag with the factor sqrt(e)"
        ),
    )


def main() -> None:
    """Replace the ``fine`` set of every scene."""
    stored = references.load()
    for name, scene in SCENES.items():
        reference = fine_reference(scene)
        stored.setdefault(name, {})["fine"] = reference
        print(
            f"{name}: tip within {reference.tip_uncertainty:.1e} m, "
            f"tension within {reference.tension_uncertainty:.1e} N"
        )
    references.save(stored)


if __name__ == "__main__":
    main()
