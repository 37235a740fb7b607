"""How accurate a run is, and what accuracy costs: one scene at several tolerances.

All runs are compared with one at a quarter of the finest tolerance, the reference.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterable, Mapping
from os import PathLike
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from cablemodel.accuracy.deviation import Deviation
from cablemodel.accuracy.verdict import Convergence, Row, conclude
from cablemodel.errors import CableModelError, SceneError
from cablemodel.results.run import Run
from cablemodel.results.simulate import Progress, end_of, simulate
from cablemodel.solvers.estimating import PLACES
from cablemodel.solvers.protocol import FINER

if TYPE_CHECKING:
    from cablemodel.model import CableModel, CableState
    from cablemodel.scene import Scene

Floats = NDArray[np.float64]

_SHORT, _AGAIN = 0.1, 3
"""Steps that take less processor time [s] are made again, so many times: clocks are coarse."""


def convergence(
    scene: Scene | str | PathLike[str] | Mapping[str, Any],
    tolerances: Iterable[float] | None = None,
    *,
    until: float | str | None = None,
    progress: Callable[[float, Progress], None] | None = None,
) -> Convergence:
    """Run a scene at its own tolerance and at others, and compare all with a finer reference.

    Args:
        scene: a scene, or what `load_scene` takes.
        tolerances: besides the scene's own; by default four times and a quarter of it.
        until: end of the runs instead of the scene's duration: seconds, or text with a unit.
        progress: called at every output with the tolerance of the run.

    Raises:
        SceneError: the scene's method has no tolerance, a tolerance is not allowed, or there are
            too many outputs.
        CableModelError: no run came to its end; the error of the scene's own.
        ValueError: ``until`` is not a positive number.
    """
    from cablemodel.scene.load import scene_of

    scene = scene_of(scene)
    *listed, finest = runs_of(scene, tolerances)
    until = end_of(scene, until)
    own, asked = scene.solver.tolerance, scene.solver.accuracy
    done: dict[float, Row] = {}
    errors: dict[float, CableModelError] = {}
    deviation: dict[float, Deviation] = {}
    reference: Run | None = None
    for tolerance in (finest, *reversed(listed)):
        try:
            run, row = _run(scene, tolerance, until, progress)
        except CableModelError as error:
            errors[tolerance] = error
            done[tolerance] = Row(tolerance, error=str(error), asked=asked)
            continue
        done[tolerance] = row
        if reference is None:
            reference, finest = run, tolerance  # a coarser one, if the finest failed
        else:
            deviation[tolerance] = Deviation.of(run, reference)
    if reference is None:
        raise errors[own]
    return conclude(scene, done, done[finest], deviation)


def runs_of(scene: Scene, tolerances: Iterable[float] | None = None) -> list[float]:
    """Tolerances of all runs of :func:`convergence`, from the coarsest; the last is the reference.

    Raises:
        SceneError: the scene's method has no tolerance, or a tolerance is not allowed.
    """
    settings = scene.solver
    if settings.method != "finite_element":
        problem = f"{settings.method} has no tolerance to vary"
        allowed = "finite_element; cablemodel diff compares runs of other node_spacing or time_step"
        raise SceneError.at("solver.method", settings.method, problem, allowed)
    own = settings.tolerance
    if tolerances is None:
        tolerances = [own / FINER, *([FINER * own] if FINER * own < 1.0 else [])]
    listed = sorted({own, *map(allowed_tolerance, tolerances)}, reverse=True)
    return [*listed, allowed_tolerance(listed[-1] / FINER)]


def allowed_tolerance(value: Any) -> float:
    """A tolerance that a scene may have, from a number or text.

    Raises:
        SceneError: it may not.
    """
    from pydantic import ValidationError

    from cablemodel.scene.problems import problems_of
    from cablemodel.scene.schema import Solver

    try:
        return Solver.model_validate({"tolerance": value}).tolerance
    except ValidationError as error:
        raise SceneError(problems_of(error, Solver)) from None


def _run(
    scene: Scene,
    tolerance: float,
    until: float | None,
    progress: Callable[[float, Progress], None] | None,
) -> tuple[Run, Row]:
    from cablemodel.model import CableModel

    # Without an estimate of its own errors: what it takes is the time of its own steps.
    changes = {"tolerance": tolerance, "error_estimate": False}
    settings = scene.solver.model_copy(update=changes)
    model = CableModel(scene.model_copy(update={"solver": settings}))
    watched = _Watched(model)
    elements = 0

    def look(now: Progress) -> None:
        nonlocal elements
        elements = max(elements, now.statistics["elements"])
        if progress is not None:
            progress(tolerance, now)

    run = simulate(scene, until=until, model=cast("CableModel", watched), progress=look)
    seconds = watched.seconds
    for _ in range(_AGAIN if seconds < _SHORT else 0):
        model.reset()
        begin = time.process_time()
        for target in run.time[1:].tolist():
            model.step_to(target)
        seconds = min(seconds, time.process_time() - begin)
    simulated = float(run.time[-1] - run.time[0])
    steps, asked = int(run.statistics["steps"]), scene.solver.accuracy
    return run, Row(tolerance, seconds / simulated, steps, elements, asked=asked)


class _Watched:
    """A model whose steps are timed, with states at the same places of the line in all runs."""

    def __init__(self, model: CableModel) -> None:
        self._model = model
        self.seconds = 0.0

    def __getattr__(self, name: str) -> Any:
        return getattr(self._model, name)

    def step_to(self, *arguments: Any) -> None:
        begin = time.process_time()
        self._model.step_to(*arguments)
        self.seconds += time.process_time() - begin

    def state(self) -> CableState:
        # Between nodes by the solver itself: a tension is no straight line there.
        return self._model.sample(PLACES * self._model.line_length)
