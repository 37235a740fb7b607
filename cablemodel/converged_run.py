"""A run that keeps what is asked of it: the scene again at ever finer tolerances, until two
attempts in a row know their errors to be small enough.

Every attempt estimates its own errors by a run at a quarter of its tolerance (`error_estimate`), so
that three tolerances agree in the end, as is asked of grids in convergence studies (Roache, 1994):
of two that agree the third is another one in one case of seventy (docs/stress.md). An attempt whose
positions are off by more than is allowed is given up at that output, but for the last that may be
made: its run is for users to look at.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING, Any

from cablemodel.errors import CableModelError, SceneError, StaticsError, StepError
from cablemodel.run import Progress, Run, simulate
from cablemodel.solver import FINER

if TYPE_CHECKING:
    from cablemodel.model import CableModel
    from cablemodel.scene import Scene

ATTEMPTS = 4
"""At the scene's tolerance, and at 1/4, 1/16 and 1/64 of it."""


@dataclass(frozen=True)
class Attempt:
    """A run at one tolerance."""

    tolerance: float
    problem: str = ""
    """From when on it is not known to keep what is asked of it, or why it failed; else empty."""


class ConvergenceError(CableModelError):
    """No attempt at a scene is known to keep the accuracy that is asked for.

    Attributes: ``accuracy`` that is asked for; ``attempts``, the tolerances that were tried and
    what became of each; ``run``, the last attempt, None if it did not come to its end.
    """

    def __init__(
        self, accuracy: float, attempts: Sequence[Attempt], run: Run | None = None
    ) -> None:
        super().__init__(accuracy, tuple(attempts), run)
        self.accuracy = accuracy
        self.attempts = tuple(attempts)
        self.run = run

    def __str__(self) -> str:
        alone = "errors are estimated to be small enough, which no other attempt confirms"
        tried = "".join(
            f"\n  tolerance {each.tolerance:g}: {each.problem or alone}" for each in self.attempts
        )
        return (
            f"no run is known to keep an accuracy of {self.accuracy:g}: the motion cannot be "
            f"predicted so far, or converges slowly{tried}"
        )


class _GivenUpError(Exception):
    """An attempt that cannot be the last any more."""


def converge(
    scene: Scene | str | PathLike[str] | Mapping[str, Any],
    *,
    tensions: bool = True,
    attempts: int = ATTEMPTS,
    log: str | PathLike[str] | None = None,
    until: float | None = None,
    progress: Callable[[float, Progress], None] | None = None,
    state_interval: float | None = None,
) -> Run:
    """Simulate a scene at a tolerance that keeps what is asked of it.

    Asked is what ``solver.accuracy``, by default ``solver.tolerance``, promises: positions within
    it times the line's length, top tensions within ten times it times the largest while the line
    is taut. The first attempt is at the scene's tolerance, each further one at a quarter of the
    last; the second of two in a row whose error estimates keep it is the result.

    Args:
        scene: a scene, or what `load_scene` takes.
        tensions: whether top tensions must be right, too. What jerks a stiff line, as a kink in its
            vessel's speed does, makes it ring along itself, and no two tolerances agree on that.
        attempts: how many at most, 2 or more.
        log: file to write the log of the last attempt to (MCAP).
        until: end of the run [s] instead of the scene's duration.
        progress: called at every output with the tolerance of the attempt.
        state_interval: time between exact states [s], rounded to whole output intervals.

    Returns:
        The run. Its scene has the tolerance that it took, the accuracy that was asked for, and
        ``error_estimate``: the log and all that is made of it say so.

    Raises:
        ConvergenceError: no attempt is known to keep it: the motion cannot be predicted, or
            converges slowly. Its ``run`` is the last attempt, made to its end.
        StaticsError, StepError: no attempt came as far as to be judged; the first one's error.
        SceneError: no scene, or one whose method has no tolerance.
        LogError: the log cannot be written.
        ValueError: fewer than two attempts, or see `simulate`.
    """
    from cablemodel.model import CableModel
    from cablemodel.scene import Scene, load_scene

    if attempts < 2:
        raise ValueError(f"attempts is {attempts}, it must be 2 or more: one confirms another")
    if not isinstance(scene, Scene):
        scene = load_scene(scene)
    settings = scene.solver
    if settings.method != "finite_element":
        problem = f"{settings.method} has no tolerance to make finer"
        raise SceneError.at("solver.method", settings.method, problem, "finite_element")
    made: list[Attempt] = []
    failures: list[CableModelError] = []
    for k in range(attempts):
        changes = {
            "tolerance": settings.tolerance / FINER**k,
            "accuracy": settings.promised,
            "error_estimate": True,
        }
        tried = scene.model_copy(update={"solver": settings.model_copy(update=changes)})
        run = None
        try:
            model = CableModel(tried)
            look = _watch(model, give_up=k + 2 < attempts, progress=progress)
            run = simulate(
                tried, log=log, until=until, progress=look, model=model,
                state_interval=state_interval,
            )  # fmt: skip
        except _GivenUpError as reason:
            problem = str(reason)
        except (StaticsError, StepError) as error:
            failures.append(error)
            problem = str(error)
        else:
            estimate = run.error_estimate
            assert estimate is not None  # the scene asks for it
            problem = "; ".join(estimate.problems(tried.solver, tensions=tensions))
            if not problem and made and not made[-1].problem:
                return run
        made.append(Attempt(tried.solver.tolerance, problem))
        if problem and k + 2 >= attempts:
            break  # nothing is left that could confirm another
    if len(failures) == len(made):
        raise failures[0]
    raise ConvergenceError(settings.promised, made, run)


def _watch(
    model: CableModel, *, give_up: bool, progress: Callable[[float, Progress], None] | None
) -> Callable[[Progress], None]:
    """What looks at every output of an attempt, and may give it up."""
    settings = model.scene.solver

    def look(now: Progress) -> None:
        if progress is not None:
            progress(settings.tolerance, now)
        share = model.position_error / (settings.promised * model.line_length)
        if give_up and not share <= 1.0:
            problem = f"positions may be off by {share:.3g} times what is allowed"
            if math.isnan(share):
                problem = "what positions are off by is not known"
            raise _GivenUpError(f"{problem} at t = {now.time:g} s")

    return look
