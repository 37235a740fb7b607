"""A run that keeps what is asked of it: the scene again at ever finer tolerances, until two
attempts in a row know their errors to be small enough, and they do not grow.

Every attempt estimates its own errors by a run at a quarter of its tolerance (`error_estimate`), so
that three tolerances agree in the end, as is asked of grids in convergence studies (Roache, 1994).
An attempt whose positions are off by more than is allowed is given up at that output, but for the
last that may be made: its run is for users to look at.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cablemodel.errors import (
    Attempt,
    CableModelError,
    ConvergenceError,
    LogInUseError,
    SceneError,
    StaticsError,
    StepError,
)
from cablemodel.results.promise import ErrorEstimate
from cablemodel.results.run import Run, open_run
from cablemodel.results.simulate import Progress, end_of, model_of, simulate
from cablemodel.solvers.protocol import FINER

if TYPE_CHECKING:
    from cablemodel.model import CableModel
    from cablemodel.scene import Scene
    from cablemodel.systems import SystemModel, SystemScene

ATTEMPTS = 4
"""At the scene's tolerance, and at 1/4, 1/16 and 1/64 of it."""
SMALL = 0.25
"""Of what is allowed: estimated errors that may be larger than at the tolerance before."""


class _GivenUpError(Exception):
    """An attempt that cannot be the last any more."""


def converge(
    scene: Scene | SystemScene | str | PathLike[str] | Mapping[str, Any],
    *,
    attempts: int = ATTEMPTS,
    log: str | PathLike[str] | None = None,
    until: float | str | None = None,
    progress: Callable[[float, Progress], None] | None = None,
    state_interval: float | str | None = None,
) -> Run:
    """Simulate a scene at a tolerance that keeps what is asked of it.

    Asked is what ``solver.accuracy``, by default ``solver.tolerance``, promises: positions within
    it times the line's length, top tensions within ten times it times the largest while the line
    is taut (not with ``solver.accuracy_of: positions``); of a system those of every line, and
    tensions at both ends of it. The first attempt is at the scene's tolerance, each further one at
    a quarter of the last; the second of two in a row whose error estimates keep it, and do not
    grow, is the result.

    Args:
        scene: a scene of one line or of a system, or what `load_scene` or `load_system` takes.
        attempts: how many at most, 2 or more.
        log: file to write the log of the result to (MCAP).
        until: end of the run instead of the scene's duration: seconds, or text with a unit.
        progress: called at every output with the tolerance of the attempt.
        state_interval: time between exact states [s], rounded to whole output intervals.

    Returns:
        The run. Its scene has the tolerance that it took, the accuracy that was asked for, and
        ``error_estimate``: the log and all that is made of it say so.

    Raises:
        ConvergenceError: no attempt is known to keep it: the motion cannot be predicted, or
            converges slowly. Its ``run``, and the log, are those of the last attempt that came to
            its end; without one the log has how far the last attempt came.
        StaticsError, StepError: no attempt came as far as to be judged; the first one's error.
        SceneError: no scene, one whose method has no tolerance, or too many outputs.
        LogError: the log cannot be written.
        ValueError: fewer than two attempts, or see `simulate`.
    """
    from cablemodel.systems import read_scene

    if not isinstance(attempts, int) or attempts < 2:
        raise ValueError(f"attempts is {attempts}, it must be 2 or more: one confirms another")
    scene = read_scene(scene)
    settings = scene.solver
    if settings.method != "finite_element":
        problem = f"{settings.method} has no tolerance to make finer"
        raise SceneError.at("solver.method", settings.method, problem, "finite_element")
    until = end_of(scene, until)
    made: list[Attempt] = []
    failures: list[CableModelError] = []
    last: Run | None = None
    before: ErrorEstimate | None = None
    for k in range(attempts):
        changes = {
            "tolerance": settings.tolerance / FINER**k,
            "accuracy": settings.promised,
            "error_estimate": True,
        }
        tried = scene.model_copy(update={"solver": settings.model_copy(update=changes)})
        run = estimate = None
        with _Log(log, keep=last is None) as file:
            try:
                model = model_of(tried)
                look = _watch(model, give_up=k + 2 < attempts, progress=progress)
                run = simulate(
                    tried, log=file.path, until=until, progress=look, model=model,
                    state_interval=state_interval,
                )  # fmt: skip
            except _GivenUpError as reason:
                problem = str(reason)
            except (StaticsError, StepError) as error:
                failures.append(error)
                problem = str(error)
            else:
                file.keep = True
                last, estimate = run, run.error_estimate
                assert estimate is not None  # the scene asks for it
                problem = "; ".join(estimate.problems(tried.solver)) or _growth(before, estimate)
        if run is not None and before is not None and not problem:
            return _at_its_place(run, log)
        made.append(Attempt(tried.solver.tolerance, problem))
        before = None if problem else estimate
        if problem and k + 2 >= attempts:
            break  # nothing is left that could confirm another
    if len(failures) == len(made):
        raise failures[0]
    whole = None if last is None else _at_its_place(last, log)
    raise ConvergenceError(settings.promised, made, whole)


def _growth(before: ErrorEstimate | None, now: ErrorEstimate) -> str:
    """What of the errors grows from one attempt that keeps the promise to the next, in words."""
    if before is None:
        return ""
    pairs = [
        (what, one.share, other.share)
        for old, new in zip(before.parts, now.parts, strict=True)
        for what, one, other in (
            (new.positions, old.position, new.position),
            (new.tensions, old.tension, new.tension),
        )
    ]
    return "; ".join(
        f"errors of {what} grow, from {one:.2g} to {other:.2g} of what is allowed"
        for what, one, other in pairs
        if other > max(one, SMALL)
    )


class _Log:
    """The file of an attempt, beside the log; at its end it takes the log's place or goes.

    keep: whether it takes its place. An attempt that fails is no loss once one came to its end.
    """

    def __init__(self, log: str | PathLike[str] | None, *, keep: bool) -> None:
        self._log = None if log is None else Path(log)
        self.path = None if self._log is None else self._log.with_name(f".{self._log.name}.part")
        self.keep = keep

    def __enter__(self) -> _Log:
        return self

    def __exit__(self, _kind: object, error: BaseException | None, _trace: object) -> None:
        if self.path is None or self._log is None or not self.path.exists():
            return
        if isinstance(error, LogInUseError):
            return  # it is another's
        if self.keep:
            os.replace(self.path, self._log)
        else:
            self.path.unlink()


def _at_its_place(run: Run, log: str | PathLike[str] | None) -> Run:
    """A run whose attempt's file has become the log."""
    return run if log is None else open_run(log)


def _watch(
    model: CableModel | SystemModel,
    *,
    give_up: bool,
    progress: Callable[[float, Progress], None] | None,
) -> Callable[[Progress], None]:
    """What looks at every output of an attempt, and may give it up."""
    settings = model.scene.solver

    def look(now: Progress) -> None:
        if progress is not None:
            progress(settings.tolerance, now)
        for name, errors in model.errors.items() if give_up else ():
            share = errors.position / (settings.promised * errors.length)
            if share <= 1.0:
                continue
            what = f"positions of {name}" if name else "positions"
            problem = f"{what} may be off by {share:.3g} times what is allowed"
            if math.isnan(share):
                problem = f"what {what} are off by is not known"
            raise _GivenUpError(f"{problem} at t = {now.time:g} s")

    return look
