"""Replay: run a logged run again from its scene and inputs, and compare every output.

A run is a pure function of its scene and of what was applied in each step, so that a log is a
test: on the same version and the same kind of processor all values come out to the last bit.
Elsewhere round-off differs, may now and then change the size of a step, and the values agree to
the accuracy that the scene asks for.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cablemodel import variables
from cablemodel.errors import LogError, SceneError, StepError
from cablemodel.results.compare import SAME_TIME, STATE_UNITS, Along, Difference, differences_of
from cablemodel.results.states import bodies_in_columns

if TYPE_CHECKING:
    from cablemodel.model import CableModel, CableState
    from cablemodel.results.run import Run
    from cablemodel.scene import Scene

Floats = NDArray[np.float64]

SAME_BITS = (
    "engine", "python", "numpy", "scipy", "numba", "llvmlite", "libc", "machine", "cpu_target",
)  # fmt: skip
"""What must be the same for values to be the same to the last bit."""


@dataclass
class Replay:
    """How a replay compares with its log."""

    differences: list[Difference]
    expected_exact: bool
    """Whether version and processor are those of the log."""
    changed: dict[str, tuple[str, str]]
    """What is not: name to what it was and what it is."""
    tolerance: float
    """Allowed, see :func:`~cablemodel.results.compare.differences_of`; 0 where the values must be
    the same to the last bit."""
    steps: int = 0
    samples: int = 0
    failure: str = ""
    """Why the replay could not follow the log to its end."""

    @property
    def exact(self) -> bool:
        return not self.failure and all(item.largest == 0.0 for item in self.differences)

    @property
    def passed(self) -> bool:
        return not self.failure and all(item.within for item in self.differences)


def replay(
    run: Run,
    *,
    tolerance: float | None = None,
    progress: Callable[[float], None] | None = None,
    make_model: Callable[[Scene], CableModel] | None = None,
) -> Replay:
    """Run a logged run again and compare.

    Args:
        run: from :func:`~cablemodel.open_run`; one that was cut is compared as far as it goes.
        tolerance: see :attr:`Replay.tolerance`; by default 0 on the version and processor of the
            log, else the tolerance of the scene's solver.
        progress: called with the simulated time [s] after every step.
        make_model: makes the model of a scene; :class:`~cablemodel.CableModel` by default.

    Raises:
        LogError: the log holds no outputs; or it begins later than t = 0 without a state to begin
            at, or at one of another engine.
        ValueError: ``tolerance`` is negative or not finite.
    """
    if tolerance is not None and not (math.isfinite(tolerance) and tolerance >= 0.0):
        raise ValueError(f"tolerance is {tolerance}, it must be a number of at least 0")
    if not len(run.time):
        raise LogError("the log holds no outputs: there is nothing to compare")
    inputs = run.applied_inputs
    changed = changes(run.metadata)
    model: Any = (make_model or _model_of)(run.scene)
    _begin(model, run, inputs, changed)
    if tolerance is None:
        tolerance = run.scene.solver.tolerance if changed else 0.0
    result = Replay([], not changed, changed, tolerance)
    comparison = _Comparison(run, tolerance)
    result.differences = comparison.differences
    comparison.take(model)
    for step in range(len(inputs["time"])):
        if comparison.done:
            break
        try:
            model.step_to(float(inputs["time"][step]), **_given(model, inputs, step))
        except StepError as error:
            result.failure = f"a step that the log has cannot be made again: {error}"
            break
        result.steps += 1
        comparison.take(model)
        if progress is not None:
            progress(model.time)
    result.samples = comparison.samples
    if not result.failure and not comparison.done:
        result.failure = "the log has outputs at times that its steps do not reach"
    return result


def changes(logged: dict[str, str]) -> dict[str, tuple[str, str]]:
    """What has changed since a log was written, of that which decides the bits of a result."""
    import cablemodel.solvers.finite_element.kernels.entry  # noqa: F401  (the processor is known once a compiler is loaded)
    from cablemodel.results.log.provenance import provenance

    now = provenance()
    pairs = {name: (logged.get(name, ""), now.get(name, "")) for name in SAME_BITS}
    return {name: pair for name, pair in pairs.items() if pair[0] != pair[1]}


def _begin(
    model: Any, run: Run, inputs: dict[str, Floats], changed: dict[str, tuple[str, str]]
) -> None:
    """Bring a model to where the log begins."""
    if run.snapshot is not None:
        if "engine" in changed:
            was, now = changed["engine"]
            raise LogError(
                f"the log begins at a state of engine {was}, which this one ({now}) cannot take up"
            )
        from cablemodel.model import Snapshot

        system = variables.is_system(run.scene)
        try:
            model.restore(run.snapshot if system else Snapshot(run.snapshot))
        except SceneError as error:
            raise LogError(f"the log begins at a state that does not fit: {error}") from error
        return
    if len(inputs["time"]):
        begin = float(inputs["time"][0] - inputs["step"][0])
    else:
        begin = float(run.time[0])
    if abs(begin) > SAME_TIME:
        raise LogError(
            f"the log begins at t = {begin:g} s, without a state to begin at: it cannot be replayed"
        )


def _model_of(scene: Any) -> Any:
    """A model of a scene, of one line or of a system."""
    if variables.is_system(scene):
        from cablemodel.systems import SystemModel

        return SystemModel(scene)
    from cablemodel.model import CableModel

    return CableModel(scene)


def _given(model: Any, inputs: dict[str, Floats], step: int) -> dict[str, Any]:
    """The inputs that the caller of a step gave; the others come from the scene again."""
    if variables.is_system(model.scene):
        row = np.array([inputs[label][step] for label in variables.input_labels(model.scene)])
        return dict(model.given_by(row))
    given: dict[str, Any] = {}
    for item in variables.INPUTS:
        if inputs[f"{item.python}_given"][step] > 0.5:
            place = variables.span(variables.APPLIED_INPUT_FIELDS, item.python)
            values = [float(inputs[label][step]) for label in variables.APPLIED_INPUT_LABELS[place]]
            given[item.python] = values if item.shape else values[0]
    return given


@dataclass
class _Comparison:
    """Takes a model through the output times of a run."""

    run: Run
    tolerance: float
    samples: int = 0
    _states: int = 0
    _outputs: dict[str, Difference] = field(default_factory=dict)
    _along: Along = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._outputs, self._along = differences_of(self.run, self.tolerance)

    @property
    def differences(self) -> list[Difference]:
        return [*self._outputs.values(), *self._along.values()]

    @property
    def done(self) -> bool:
        """Whether all outputs and states of the log were met."""
        return self.samples == len(self.run.time) and self._states == len(self._state_times)

    @property
    def _state_times(self) -> Floats:
        return next(iter(self.run.shapes.values())).time

    def take(self, model: Any) -> None:
        """Compare at the model's time, if the log has an output there."""
        now = model.time
        if self.samples < len(self.run.time) and _same(now, self.run.time[self.samples]):
            system = variables.is_system(model.scene)
            outputs = model.outputs() if system else {}
            for name, difference in self._outputs.items():
                logged = self.run[name][self.samples]
                again = outputs[name] if system else _output(model, name, logged)
                difference.take(logged, again, now)
            self.samples += 1
        times = self._state_times
        if self._states < len(times) and _same(now, times[self._states]):
            for line, states in self.run.shapes.items():
                state = states[self._states]
                again = _state_at(model, line, state.s)
                for name in STATE_UNITS:
                    values = getattr(state, name), getattr(again, name)
                    self._along[line, name].take(*values, now, state.s)
            self._states += 1


def _same(one: float, other: float) -> bool:
    return abs(one - other) <= SAME_TIME


def _output(model: CableModel, name: str, logged: Any) -> Any:
    """An output of the model, in the shape of what was logged."""
    owner, _, attribute = name.rpartition(".")
    if owner != "bodies":
        return getattr(model, name)
    values = np.array([getattr(body, attribute) for body in model.bodies], float).reshape(-1, 3)
    if attribute == "direction":
        # The log has a direction as a quaternion, whose round-off is not the model's.
        from cablemodel.results.log.messages import through_quaternion

        values = np.array([through_quaternion(value) for value in values]).reshape(-1, 3)
    if len(values) > len(logged):  # a body that the log has not is no number of its own
        return np.full_like(logged, np.inf)
    return bodies_in_columns([values], len(logged))[0]


def _state_at(model: Any, line: str, s: Floats) -> CableState:
    """A line's state at the nodes of a log, which another version may mesh differently."""
    part = model.lines[line] if line else model
    state: CableState = part.sample() if line else model.state()
    return state if np.array_equal(state.s, s) else part.sample(s)
