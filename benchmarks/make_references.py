"""Compute the ``fine`` references anew: ``python -m benchmarks.make_references``.

Solved twice, at a tolerance and a number of elements far beyond any contestant's: the distance
between the two is stored as the uncertainty.
"""

from __future__ import annotations

import argparse
import math
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
LESS_FINE = {"J": ((1e-8, 160), (1e-7, 120))}
"""The same for scenes where they would take minutes."""
SIGNIFICANT = 2.0
"""Uncertainty over the distance between the two solutions [-]."""


def solve(
    scene: BenchmarkScene, tolerance: float, elements: int | None
) -> tuple[np.ndarray, np.ndarray]:
    """Tip (n, 3) [m] and top tension (n,) [N] at the scene's instants."""

    def make(scene: BenchmarkScene, _times: Sequence[float]) -> Runner:
        changed = cablemodel_scene(scene, tolerance, "elastica", elements)
        return CableModelRunner(changed, scene.probe)

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
    fine, check = LESS_FINE.get(scene.name, (FINE, CHECK))
    tips, tensions = solve(scene, *fine)
    check_tips, check_tensions = solve(scene, *check)
    tip_distance = float(np.linalg.norm(tips - check_tips, axis=1).max())
    tension_distance = float(np.abs(tensions - check_tensions).max())
    return Reference(
        times=scene.times,
        tip=tuple((round(x, 8), round(y, 8), round(z, 8)) for x, y, z in tips.tolist()),
        tension=tuple(round(value, 6) for value in tensions.tolist()),
        tip_uncertainty=float(f"{SIGNIFICANT * tip_distance:.1e}"),
        tension_uncertainty=float(f"{SIGNIFICANT * tension_distance:.1e}"),
        made=(
            f"cablemodel, elastica, tau = {fine[0]:g}, {fine[1]} equal elements, against "
            f"tau = {check[0]:g}, {check[1]} elements; drag with the factor sqrt(e)"
        ),
    )


def laid_reference(scene: BenchmarkScene) -> Reference:
    """S3: the end until it lands (then it folds, which nobody can predict), and the tension.

    Before touchdown from our own runs; after it from independent prototypes with a rigid floor
    (to 0.05 N), which our soft floor only approaches as the tolerance falls.
    """
    landed = scene.times.index(38.0) + 1
    tips, tensions = solve(scene, 1e-5, None)
    check_tips, check_tensions = solve(scene, 1e-4, None)
    tip_apart = float(np.linalg.norm((tips - check_tips)[:landed], axis=1).max())
    tension_apart = float(np.abs(tensions - check_tensions)[:landed].max())
    nowhere = (math.nan, math.nan, math.nan)
    early = [(round(x, 6), round(y, 6), round(z, 6)) for x, y, z in tips[:landed].tolist()]
    return Reference(
        times=scene.times,
        tip=(*early, *[nowhere] * (len(scene.times) - landed)),
        tension=(*(round(value, 4) for value in tensions[:landed].tolist()), *RIGID_FLOOR),
        tip_uncertainty=float(f"{tip_apart:.1e}"),
        tension_uncertainty=max(0.05, float(f"{tension_apart:.1e}")),
        made=(
            "until touchdown cablemodel, elastica, tau = 1e-05, against tau = 1e-04; tensions at "
            "60, 96, 120 s from prototypes with a rigid floor"
        ),
    )


RIGID_FLOOR = (117.21, 134.98, 138.83)
"""Top tension of S3 at 60, 96, 120 s in the limit of a rigid, frictionless floor [N]."""


def main() -> None:
    """Replace the ``fine`` set of every scene."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.make_references")
    parser.add_argument("--only", default=",".join(SCENES), help="scenes, with commas")
    names = parser.parse_args().only.split(",")
    stored = references.load()
    for name in names:
        scene = SCENES[name]
        reference = laid_reference(scene) if name == "S3" else fine_reference(scene)
        stored.setdefault(name, {})["fine"] = reference
        print(
            f"{name}: tip within {reference.tip_uncertainty:.1e} m, "
            f"tension within {reference.tension_uncertainty:.1e} N"
        )
    references.save(stored)


if __name__ == "__main__":
    main()
