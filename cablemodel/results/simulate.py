"""A scene is simulated to its end."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING, Any

from cablemodel.results.cadence import check_outputs, output_times
from cablemodel.results.recorder import check_model, recorder_of

if TYPE_CHECKING:
    from cablemodel.model import CableModel
    from cablemodel.results.run import Run
    from cablemodel.scene import Scene
    from cablemodel.systems import SystemModel, SystemScene


@dataclass(frozen=True)
class Progress:
    """How far a simulation is, for ``simulate(progress=...)``."""

    time: float
    """Simulated time [s]."""
    until: float
    """End of the run [s]."""
    wall_time: float
    """Computing time so far [s]."""
    top_tension: float
    """[N]"""
    statistics: dict[str, Any]
    """Of the model: steps, iterations, ..."""


def simulate(
    scene: Scene | SystemScene | str | PathLike[str] | Mapping[str, Any],
    *,
    log: str | PathLike[str] | None = None,
    until: float | str | None = None,
    progress: Callable[[Progress], None] | None = None,
    model: CableModel | SystemModel | None = None,
    state_interval: float | str | None = None,
) -> Run:
    """Run a scene from its initial state to its end.

    Outputs over time are at every output interval of the scene. In a long run, what is kept along
    the cable is not (see :mod:`cablemodel.results.cadence`), unless ``state_interval`` says how
    often.

    Args:
        scene: what to simulate: a scene of one line or of a system, or what `load_scene` takes.
        log: file to write the log to (MCAP); the states are then read from it, not kept.
        until: end of the run instead of the scene's duration: seconds, or text with a unit.
        progress: called at every output.
        model: a model of this scene to go on with, from its present time.
        state_interval: time between exact states, as ``until``, rounded to whole output intervals.

    Raises:
        StepError: a step could not be made; a log keeps what was reached.
        StaticsError, SceneError: the model cannot be made, or there are too many outputs.
        LogError: the log cannot be written.
        ValueError: ``until`` or ``state_interval`` is not a positive time.
        TypeError: ``model`` is no model.
    """
    from cablemodel.systems import read_scene

    scene = read_scene(scene)
    if model is not None:
        check_model(model)
    end = end_of(scene, until, 0.0 if model is None else model.time)
    if model is None:
        model = model_of(scene)
    times = output_times(model.time, end, scene.run.output_interval)
    begin = time.perf_counter()
    with recorder_of(
        model,
        log,
        output_interval=scene.run.output_interval,
        state_interval=state_interval,
        until=end,
    ) as recorder:
        for target in [None, *times]:
            if target is not None:
                recorder.step_to(target)
            if progress is not None:
                wall = time.perf_counter() - begin
                until = times[-1] if times else model.time
                statistics = dict(model.statistics)
                progress(Progress(model.time, until, wall, model.top_tension, statistics))
    return recorder.run()


def model_of(scene: Scene | SystemScene) -> CableModel | SystemModel:
    """A model of one line or of a system, at the scene's initial state.

    Raises:
        StaticsError, SceneError: it cannot be made.
    """
    from cablemodel.model import CableModel
    from cablemodel.scene import Scene
    from cablemodel.systems import SystemModel

    return CableModel(scene) if isinstance(scene, Scene) else SystemModel(scene)


def end_of(
    scene: Scene | SystemScene, until: float | str | None = None, start: float = 0.0
) -> float:
    """When a run ends [s]: ``until``, or the scene's duration. Asked before a model is made, which
    may take long.

    Raises:
        SceneError: ``until`` is not a positive time, or there would be too many outputs.
    """
    from cablemodel.scene.units import seconds

    end = scene.run.duration if until is None else seconds("until", until)
    check_outputs(start, end, scene.run.output_interval)
    return end
