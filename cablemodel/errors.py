"""The errors that users see. Everything that this package raises on purpose is one of these."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

_LONGEST_VALUE = 60


class CableModelError(Exception):
    """Base of all errors of this package."""


@dataclass(frozen=True)
class SceneProblem:
    """One thing that is wrong with a scene."""

    path: str
    """Where, in the words of the file: ``line.0.cable.length``; empty for the scene as a whole."""
    value: Any
    """What stands there (None where a key is missing)."""
    problem: str
    """What is wrong with it, in plain words."""
    allowed: str = ""
    """What may stand there."""

    def __str__(self) -> str:
        where = f"{self.path}: " if self.path else ""
        allowed = f"; allowed: {self.allowed}" if self.allowed else ""
        return f"{where}{self.problem}{allowed}"


class SceneError(CableModelError, ValueError):
    """A scene that cannot be used; names every problem with its path, value and what is allowed.

    ``path``, ``value`` and ``allowed`` are those of the first problem; ``problems`` holds all.
    """

    def __init__(self, problems: Sequence[SceneProblem], source: str = "") -> None:
        if not problems:
            raise ValueError("a SceneError needs at least one problem")
        super().__init__(tuple(problems), source)
        self.problems = tuple(problems)
        self.source = source

    @classmethod
    def at(cls, path: str, value: Any, problem: str, allowed: str = "") -> SceneError:
        """An error with a single problem."""
        return cls([SceneProblem(path, value, problem, allowed)])

    @property
    def path(self) -> str:
        return self.problems[0].path

    @property
    def value(self) -> Any:
        return self.problems[0].value

    @property
    def allowed(self) -> str:
        return self.problems[0].allowed

    def __str__(self) -> str:
        source = f"{self.source}: " if self.source else ""
        if len(self.problems) == 1:
            return f"{source}{self.problems[0]}"
        lines = "\n".join(f"  {problem}" for problem in self.problems)
        return f"{source}{len(self.problems)} problems in the scene\n{lines}"


class StaticsError(CableModelError):
    """No static equilibrium was found for the start of a run."""


class StepError(CableModelError):
    """A step that could not be made. The model stands as it was before the step.

    Attributes: ``time`` [s] at which the step failed, ``arc_length`` [m] of the place along the
    cable (None where no place is to blame), ``advice`` what to try.
    """

    def __init__(
        self, problem: str, *, time: float, arc_length: float | None = None, advice: str = ""
    ) -> None:
        super().__init__(problem)
        self.problem = problem
        self.time = time
        self.arc_length = arc_length
        self.advice = advice

    def __reduce__(self) -> tuple[Any, ...]:
        state = {"time": self.time, "arc_length": self.arc_length, "advice": self.advice}
        return _rebuild_step_error, (self.problem, state)

    def __str__(self) -> str:
        place = "" if self.arc_length is None else f", {self.arc_length:g} m along the cable"
        advice = f"; {self.advice}" if self.advice else ""
        return f"at t = {self.time:g} s{place}: {self.problem}{advice}"


def _rebuild_step_error(problem: str, state: dict[str, Any]) -> StepError:
    """Unpickle (keyword-only arguments are beyond the default of Exception)."""
    return StepError(problem, **state)


@dataclass(frozen=True)
class Attempt:
    """A run at one tolerance."""

    tolerance: float
    problem: str = ""
    """From when on it is not known to keep what is asked of it, or why it failed; else empty."""


class ConvergenceError(CableModelError):
    """No attempt at a scene is known to keep the accuracy that is asked for.

    Attributes: ``accuracy`` that is asked for; ``attempts``, the tolerances that were tried and
    what became of each; ``run``, the :class:`~cablemodel.results.run.Run` of the last attempt that
    came to its end, None if none did.
    """

    def __init__(self, accuracy: float, attempts: Sequence[Attempt], run: Any = None) -> None:
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


class StartWarning(UserWarning):
    """What a user should know of a start: told by the command line without the place in code."""


class DrawnStartWarning(StartWarning):
    """A lay starts with tension in what lies, which friction was to hold: no such start was found.

    Attributes: ``tension`` at the touchdown [N]; ``by``: what draws at it, in words.
    """

    def __init__(self, tension: float, by: str = "its own weight down the slope") -> None:
        super().__init__(tension, by)
        self.tension = tension
        self.by = by

    def __str__(self) -> str:
        return (
            f"no start was found in which friction holds what has been laid: it starts with "
            f"{self.tension:.4g} N where it lands, drawn by {self.by}"
        )


class SweptStartWarning(StartWarning):
    """Friction does not hold a lay's cable where it is laid, on its slope, in the current there.

    Attributes: ``needed``: what it takes, over what there is [-].
    """

    def __init__(self, needed: float) -> None:
        super().__init__(needed)
        self.needed = needed

    def __str__(self) -> str:
        return (
            f"to stay where it is laid the cable needs {self.needed:.3g} times the friction that "
            "there is, against its slope and the current there: it starts where it has slid to"
        )


class TautLayWarning(StartWarning):
    """A lay that pays out less than it takes: what lies is dragged from the start on; or, down a
    slope or over ridges, it starts without tension where it lands, and becomes taut.

    Attributes: ``rate`` of the pay-out, ``needed`` by a lay without tension there [m/s];
    ``tension`` where it lands at the start [N], None: it starts without; ``floor`` in words.
    """

    def __init__(
        self,
        rate: float,
        needed: float,
        tension: float | None = None,
        floor: str = "down this slope",
    ) -> None:
        super().__init__(rate, needed, tension, floor)
        self.rate = rate
        self.needed = needed
        self.tension = tension
        self.floor = floor

    def __str__(self) -> str:
        if self.tension is not None:
            return (
                f"this lay takes {self.needed:.5g} m/s and gets {self.rate:.5g}: it is taut, and "
                f"starts with {self.tension:.4g} N where it lands, of the friction of what is "
                f"dragged over the floor, by {self.needed - self.rate:.3g} m/s"
            )
        return (
            f"a lay {self.floor} takes {self.needed:.5g} m/s and gets {self.rate:.5g}: it "
            "starts without tension where it lands, and becomes taut as it goes"
        )


class UnstableStartWarning(StartWarning):
    """A static start is an equilibrium that the line leaves by itself, and no other was found.

    Attributes: ``rate`` at which it does [1/s]: the least motion grows by exp(rate t);
    ``arc_length`` [m] of the place along the cable that moves most; in a system ``part``, the line
    or body that does, ``frequency`` [rad/s] at which it swings, 0: it falls; and ``time`` [s]: a
    system with foils may become so after its start.
    """

    def __init__(
        self,
        rate: float,
        arc_length: float,
        part: str = "",
        frequency: float = 0.0,
        time: float = 0.0,
    ) -> None:
        super().__init__(rate, arc_length, part, frequency, time)
        self.rate = rate
        self.arc_length = arc_length
        self.part = part
        self.frequency = frequency
        self.time = time

    def __str__(self) -> str:
        if self.part:
            place = f"{self.part} at {self.arc_length:.4g} m" if self.arc_length else self.part
            swings = (
                f"swings with a period of {2.0 * math.pi / self.frequency:.3g} s and "
                if self.frequency
                else ""
            )
            state = "the start is an unstable equilibrium"
            if self.time > 0.0:
                state = f"what it does at t = {self.time:.4g} s is unstable"
            return (
                f"{state}: what leaves it {swings}grows by e in "
                f"{1.0 / self.rate:.3g} s (growth rate {self.rate:.3g} 1/s), most of all {place}. "
                "The run will leave it, at a time that depends on the tolerance: check the points "
                "at which bodies are held, their centres and foils (a wing wants a tail), and "
                "lines whose slack would hang doubled below one end (move the other one aside)"
            )
        return (
            f"the static start is an unstable equilibrium: what leaves it grows by e in "
            f"{1.0 / self.rate:.3g} s (growth rate {self.rate:.3g} 1/s) and moves most "
            f"{self.arc_length:g} m along the cable; no stable equilibrium was found near it. "
            "The line will fall or snap off it during the run: check clamps, weights and "
            "buoyancy, or start from initial: {straight: ...} or {points: ...}"
        )


class OverturnedStartWarning(StartWarning):
    """Bodies do not last as the scene has them, and start turned from there, as they fall.

    Attributes: ``angles`` by which their vertical axes turn [rad], by name; ``bodies``, the names.
    """

    def __init__(self, angles: dict[str, float]) -> None:
        super().__init__(angles)
        self.angles = angles
        self.bodies = list(angles)

    def __str__(self) -> str:
        turned = [
            f"{name} starts turned by {math.degrees(angle):.0f} degrees"
            for name, angle in self.angles.items()
        ]
        many = len(turned) > 1
        return (
            f"{' and '.join(turned)}: as the scene has "
            f"{'them, they fall' if many else 'it, it falls'} from an unstable equilibrium. Check "
            "the points at which bodies are held, their centres and foils"
        )


class LogError(CableModelError):
    """A log that cannot be written or read."""


class LogInUseError(LogError):
    """A log that another run writes: it is left alone."""


def shown(value: Any) -> str:
    """A value as an error message quotes it: on one line, and short."""
    try:
        text = repr(value)
    except Exception:  # a foreign object's repr may do anything; the message must still come out
        text = f"<{type(value).__name__}>"
    text = " ".join(text.split())
    return text if len(text) <= _LONGEST_VALUE else text[: _LONGEST_VALUE - 3] + "..."
