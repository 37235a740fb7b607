"""Which solver a scene asks for."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cablemodel.solvers.protocol import Solver

if TYPE_CHECKING:
    from cablemodel.scene import Scene


def choose(scene: Scene, *, planar: bool | None = None, sleep: bool | None = None) -> Solver:
    """The solver that the scene asks for, at the scene's initial state."""
    if scene.solver.method == "direct_integration":
        from cablemodel.solvers.direct.solver import DirectSolver

        return DirectSolver(scene, planar=planar)
    if scene.solver.error_estimate:
        from cablemodel.solvers.estimating import EstimatingSolver

        return EstimatingSolver(scene, planar=planar, sleep=sleep)
    from cablemodel.solvers.finite_element.solver import FiniteElementSolver

    return FiniteElementSolver(scene, planar=planar, sleep=sleep)
