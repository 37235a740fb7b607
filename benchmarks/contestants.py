"""Who is measured: cablemodel over its tolerances, each peer over a grid of its settings."""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.measure import Contestant, Runner
from benchmarks.scenes import BenchmarkScene

TOLERANCES = (1e-2, 6e-3, 4e-3, 3e-3, 2.5e-3, 2e-3, 1e-3, 5e-4, 3e-4, 1e-4, 1e-5, 1e-6)
LEAST_TOLERANCE = {("S3", "hybrid"): 1e-5, ("S3", "elastica"): 1e-5, ("S3", "cable"): 1e-4}
"""Where smaller ones would take minutes: the floor's contact is stiffer then, and a flexible cable
that folds on it without tension has no well-posed motion."""
MODELS = ("hybrid", "elastica", "cable")
OURS = "cablemodel"


class CableModelRunner:
    """One cablemodel instance, stepped from one reference time to the next."""

    def __init__(self, scene: dict[str, Any], probe: float | None = None) -> None:
        import cablemodel as cm

        self._model: Any = cm.CableModel(cm.load_scene(scene))
        self._probe = probe

    def advance(self, time: float) -> None:
        """One step to that time [s], whatever its length."""
        self._model.step_to(time)

    def tip(self) -> NDArray[np.float64]:
        """Free end, or the probe, relative to the vessel (3,) [m]."""
        if self._probe is None:
            place = self._model.tip_position
        else:
            place = self._model.sample([self._probe]).position[0]
        tip: NDArray[np.float64] = np.asarray(place) - np.asarray(self._model.vessel_position)
        return tip

    def top_tension(self) -> float:
        """Magnitude of the force of the cable on the vessel [N]."""
        return math.hypot(*self._model.top_force)

    def statistics(self) -> dict[str, float]:
        """Counts of the solver."""
        return {
            key: float(value)
            for key, value in self._model.statistics.items()
            if isinstance(value, int | float)
        }

    def close(self) -> None:
        """Nothing to free."""


def cablemodel_scene(
    scene: BenchmarkScene,
    tolerance: float,
    model: str = "hybrid",
    elements: int | None = None,
) -> dict[str, Any]:
    """The scene with another tolerance, cable model or number of elements."""
    changed = copy.deepcopy(scene.scene)
    changed["solver"]["tolerance"] = tolerance
    for item in [*changed["line"], *changed.get("payout", {}).get("drum", [])]:
        if "cable" in item:
            item["cable"]["model"] = model
            if elements is not None:
                item["cable"]["elements"] = elements
    return changed


def cablemodel_contestants(
    scene: str, models: Sequence[str] = MODELS, tolerances: Sequence[float] = TOLERANCES
) -> list[Contestant]:
    """Our solver: one curve per model, one point per tolerance."""

    def contestant(model: str, tolerance: float) -> Contestant:
        def make(scene: BenchmarkScene, _times: Sequence[float]) -> Runner:
            return CableModelRunner(cablemodel_scene(scene, tolerance, model), scene.probe)

        return Contestant(f"{OURS} {model}", f"tau={tolerance:g}", make, "fine", compiles=True)

    return [
        contestant(model, tolerance)
        for model in models
        for tolerance in tolerances
        if tolerance >= LEAST_TOLERANCE.get((scene, model), 0.0)
    ]


DIRECT = "direct integration"
DIRECT_STEPS: dict[str, tuple[tuple[float, float], ...]] = {
    # time step [s], distance of nodes [m]
    "S1": ((2.0, 2.0), (1.0, 1.0), (0.5, 0.5), (0.25, 0.25), (0.125, 0.125)),
    "S2w": ((0.08, 0.4), (0.04, 0.2), (0.02, 0.1), (0.01, 0.05)),
    "S3": ((1.0, 1.0), (0.5, 1.0), (0.5, 0.5), (0.25, 0.5)),
    "S4": ((1.0, 1.0), (0.5, 0.5), (0.25, 0.25), (0.125, 0.125)),
}
"""Scenes of the second solver. A release in air or a vacuum has no drag to hold its first, slack
steps; a line held at both ends (J) has no static state for it."""


def direct_scene(
    scene: BenchmarkScene, time_step: float, spacing: float, model: str
) -> dict[str, Any]:
    """The scene for direct integration, of nearly second order (alpha 0.55).

    On the floor it must bend (hybrid); S3's upper parts are its flexible cable, as in the paper.
    """
    changed = cablemodel_scene(scene, 1e-3, model)
    changed["solver"] = {
        "method": "direct_integration",
        "time_step": time_step,
        "node_spacing": spacing,
        "alpha": 0.55,
        "relative_tolerance": 1e-5,
    }
    if scene.name == "S3":
        upper, lower = changed["line"][0]["cable"], changed["line"][2]["cable"]
        upper["model"], lower["model"] = "cable", "hybrid"
        changed["payout"]["drum"][0]["cable"]["model"] = "cable"
        # The paper's own settings there: with others its Newton iteration gives up at touchdown.
        changed["solver"] |= {"alpha": 1.0, "relative_tolerance": 1e-2}
    return changed


def direct_contestants(scene: str, models: Sequence[str] = MODELS) -> list[Contestant]:
    """The second solver: one curve per model, one point per time step and distance of nodes."""

    def contestant(model: str, time_step: float, spacing: float) -> Contestant:
        def make(scene: BenchmarkScene, _times: Sequence[float]) -> Runner:
            return CableModelRunner(direct_scene(scene, time_step, spacing, model), scene.probe)

        setting = f"dt={time_step:g} ds={spacing:g}"
        return Contestant(f"{DIRECT} {model}", setting, make, "fine", compiles=True)

    # A flexible cable has no equations without tension (S2w), and S3 mixes the models anyway.
    allowed = {"S2w": ("elastica",), "S3": ("hybrid",)}.get(scene, tuple(models))
    return [
        contestant(model, time_step, spacing)
        for model in models
        if model in allowed
        for time_step, spacing in DIRECT_STEPS.get(scene, ())
    ]
