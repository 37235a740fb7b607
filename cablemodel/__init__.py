"""Simulate ocean cables with bodies on them: towing, laying, anchoring, recovering.

Public names load on first use, so that ``import cablemodel`` is quick and pulls in neither the
compiler (numba) nor the unit, log and plot libraries.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cablemodel.accuracy.converge import converge
    from cablemodel.accuracy.study import convergence
    from cablemodel.analysis.sweep import grid_of, sweep
    from cablemodel.errors import (
        CableModelError,
        ConvergenceError,
        DrawnStartWarning,
        LogError,
        OverturnedStartWarning,
        SceneError,
        StaticsError,
        StepError,
        SweptStartWarning,
        TautLayWarning,
        UnstableStartWarning,
    )
    from cablemodel.model import CableModel, CableState
    from cablemodel.results.recorder import Recorder
    from cablemodel.results.run import Run, open_run
    from cablemodel.results.simulate import simulate
    from cablemodel.scene import Scene, load_scene
    from cablemodel.systems import SystemModel, SystemScene, VesselInput, load_system

    __version__: str

_HOME = {
    "CableModelError": "cablemodel.errors",
    "ConvergenceError": "cablemodel.errors",
    "LogError": "cablemodel.errors",
    "SceneError": "cablemodel.errors",
    "StaticsError": "cablemodel.errors",
    "StepError": "cablemodel.errors",
    "DrawnStartWarning": "cablemodel.errors",
    "OverturnedStartWarning": "cablemodel.errors",
    "SweptStartWarning": "cablemodel.errors",
    "TautLayWarning": "cablemodel.errors",
    "UnstableStartWarning": "cablemodel.errors",
    "CableModel": "cablemodel.model",
    "CableState": "cablemodel.model",
    "converge": "cablemodel.accuracy.converge",
    "convergence": "cablemodel.accuracy.study",
    "grid_of": "cablemodel.analysis.sweep",
    "sweep": "cablemodel.analysis.sweep",
    "Recorder": "cablemodel.results.recorder",
    "SystemRecorder": "cablemodel.results.recorder",
    "Run": "cablemodel.results.run",
    "open_run": "cablemodel.results.run",
    "simulate": "cablemodel.results.simulate",
    "Scene": "cablemodel.scene",
    "load_scene": "cablemodel.scene",
    "SystemModel": "cablemodel.systems",
    "SystemScene": "cablemodel.systems",
    "VesselInput": "cablemodel.systems",
    "load_system": "cablemodel.systems",
}

__all__ = [
    "CableModel",
    "CableModelError",
    "CableState",
    "ConvergenceError",
    "DrawnStartWarning",
    "LogError",
    "OverturnedStartWarning",
    "Recorder",
    "Run",
    "Scene",
    "SceneError",
    "StaticsError",
    "StepError",
    "SweptStartWarning",
    "SystemModel",
    "SystemRecorder",
    "SystemScene",
    "TautLayWarning",
    "UnstableStartWarning",
    "VesselInput",
    "__version__",
    "converge",
    "convergence",
    "grid_of",
    "load_scene",
    "load_system",
    "open_run",
    "simulate",
    "sweep",
]


def __getattr__(name: str) -> Any:
    """Import the home of a public name when the name is first used (PEP 562)."""
    if name == "__version__":
        value: Any = _version()
    elif name in _HOME:
        value = getattr(importlib.import_module(_HOME[name]), name)
    else:
        raise AttributeError(f"module 'cablemodel' has no attribute {name!r}")
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted(set(globals()) | set(__all__))


def _version() -> str:
    """Version of the installed distribution; ``0+unknown`` in a tree that is not installed."""
    from importlib import metadata

    try:
        return metadata.version("cablemodel")
    except metadata.PackageNotFoundError:
        return "0+unknown"
