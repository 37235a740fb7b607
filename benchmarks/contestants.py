"""Who is measured: cablemodel over its tolerances, and each peer over its segment counts."""

from __future__ import annotations

import copy
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.measure import Contestant, Runner
from benchmarks.scenes import BenchmarkScene

TOLERANCES = (1e-2, 3e-3, 1e-3, 5e-4, 3e-4, 1e-4, 1e-5, 1e-6)
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
        self._model.step(time - self._model.time)

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
    models: Sequence[str] = MODELS, tolerances: Sequence[float] = TOLERANCES
) -> list[Contestant]:
    """Our solver: one curve per model, one point per tolerance."""

    def contestant(model: str, tolerance: float) -> Contestant:
        def make(scene: BenchmarkScene, _times: Sequence[float]) -> Runner:
            return CableModelRunner(cablemodel_scene(scene, tolerance, model), scene.probe)

        return Contestant(f"{OURS} {model}", f"tau={tolerance:g}", make, "fine", compiles=True)

    return [contestant(model, tolerance) for model in models for tolerance in tolerances]


# Cost grows with the square of the segments: stop where one run takes about a minute.
MOORDYN_SEGMENTS = {
    "S1": (10, 20, 40, 80, 120),
    "S2w": (10, 20, 40, 80, 160),
    "S2a": (10, 20, 40, 80, 160, 320),
    "S4": (10, 20, 40, 80, 120),
}
MOORDYN_CURVES = (
    # The setting that the project's targets are stated against, and the cheapest stable one
    # that a search over schemes, steps and damping found (see docs/benchmarks.md).
    ("MoorDyn RK4, BA=0", "RK4", 2.7, 0.0),
    ("MoorDyn RK2, zeta=0.6", "RK2", 2.0, 0.6),
)


def moordyn_contestants(scene: str, max_segments: int = 10_000) -> list[Contestant]:
    """MoorDyn: one curve per scheme, one point per number of segments."""
    from benchmarks.peers.moordyn import MoorDynRunner, Settings

    def contestant(name: str, settings: Settings) -> Contestant:
        def make(scene: BenchmarkScene, times: Sequence[float]) -> Runner:
            return MoorDynRunner(scene, times, settings)

        return Contestant(name, f"N={settings.segments}", make, "prototype")

    return [
        contestant(name, Settings(segments, scheme, factor, damping))
        for name, scheme, factor, damping in MOORDYN_CURVES
        for segments in MOORDYN_SEGMENTS[scene]
        if segments <= max_segments
    ]
