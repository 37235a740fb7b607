"""Record a model that is stepped by a loop of one's own: a controller, a coupled vessel."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from os import PathLike
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cablemodel import variables
from cablemodel.errors import CableModelError, LogError, shown
from cablemodel.results.cadence import Cadence
from cablemodel.results.run import Run, open_run, run_of
from cablemodel.results.states import (
    States,
    applied_values,
    bodies_in_columns,
    by_label,
    matrix_of,
    shapes_of,
)

if TYPE_CHECKING:
    from cablemodel.model import CableModel, CableState
    from cablemodel.results.log.writer import LogWriter
    from cablemodel.scene import Scene
    from cablemodel.systems import SystemScene
    from cablemodel.systems.inputs import SystemInputs

Floats = NDArray[np.float64]

_EARLY = 1e-6
"""Part of an output interval by which a step may end before an output is due, and still give it:
times of a loop are sums of steps, with their round-off."""


class Recorder:
    """Steps a model and keeps the run, in a log or in memory.

    Use it as a context manager, and call ``step`` or ``step_to`` here instead of on the model;
    the model may be read, and stepped for a what-if if it is restored afterwards:

        with cm.Recorder(model, "run.mcap") as recorder:
            while model.time < 300.0:
                recorder.step(0.1, payout_rate=controller(model))
        run = recorder.run()

    A step that fails is not recorded, and the loop may go on with another one. Leaving the block
    by an exception closes the log properly; the run is then not complete, and says why.

    Args:
        model: the model to step, from its present time.
        log: file to write the log to (MCAP); the run is kept in memory if not given.
        output_interval: time between outputs, the scene's if not given. An output is taken at
            the first step that reaches each multiple of it, at the start and at the end.
        state_interval: time between exact states, rounded to whole output intervals; by default
            what keeps a long run small (see :mod:`cablemodel.results.cadence`).
        until: when the run will probably end, to judge that; the scene's duration if not given.
            These times are in seconds, or text with a unit.

    Raises:
        LogError: the log cannot be written, or another run writes it.
        ValueError: a time is not a positive one.
        TypeError: ``model`` is no model, or one of a system, which a `SystemRecorder` records.
    """

    def __init__(
        self,
        model: CableModel,
        log: str | PathLike[str] | None = None,
        *,
        output_interval: float | str | None = None,
        state_interval: float | str | None = None,
        until: float | str | None = None,
    ) -> None:
        from cablemodel.scene.units import seconds

        check_model(model)
        if variables.is_system(model.scene) != isinstance(self, SystemRecorder):
            other = Recorder if isinstance(self, SystemRecorder) else SystemRecorder
            raise TypeError(f"{model!r} is recorded by a {other.__name__}")
        settings = model.scene.run
        interval, end = settings.output_interval, settings.duration
        if output_interval is not None:
            interval = seconds("output_interval", output_interval)
        if state_interval is not None:
            state_interval = seconds("state_interval", state_interval)
        if until is not None:
            end = seconds("until", until)
        outputs = max(0, math.ceil((end - model.time) / interval)) + 1
        nodes = sum(len(shape.s) for shape in shapes_of(model).values())
        self.model = model
        self._interval = interval
        self._cadence = Cadence.of(outputs, nodes, interval, state_interval)
        self._log = log
        self._memory: Memory | None = None
        self._writer: LogWriter | None = None
        if log is None:
            self._memory = Memory(model.scene)
        else:
            from cablemodel.results.log.writer import LogWriter

            self._writer = LogWriter(log, model.scene)
        self._time = model.time
        self._due = self._next_due()
        self._outputs = 0
        self._last_output = math.nan
        self._last_exact = self._last_shape = False
        self._largest_curvature = 0.0
        self._wall_time = 0.0
        self._ended = False
        self._reason = ""
        self._output()

    # -- stepping -------------------------------------------------------------------------------

    def step(
        self,
        dt: float,
        vessel_velocity: ArrayLike | None = None,
        vessel_position: ArrayLike | None = None,
        payout_rate: float | None = None,
        current: ArrayLike | None = None,
    ) -> None:
        """As :meth:`CableModel.step`, recorded."""
        inputs = (vessel_velocity, vessel_position, payout_rate, current)
        self._take(self.model.step, dt, _by_name(inputs))

    def step_to(
        self,
        end: float,
        vessel_velocity: ArrayLike | None = None,
        vessel_position: ArrayLike | None = None,
        payout_rate: float | None = None,
        current: ArrayLike | None = None,
    ) -> None:
        """As :meth:`CableModel.step_to`, recorded."""
        inputs = (vessel_velocity, vessel_position, payout_rate, current)
        self._take(self.model.step_to, end, _by_name(inputs))

    def _check(self) -> None:
        if self._ended:
            raise CableModelError("the recording has ended: make another Recorder")
        if self.model.time != self._time:
            raise CableModelError(
                f"the recording is at t = {self._time:g} s, but the model was taken to "
                f"{self.model.time:g} s without it: restore it, or step it with the recorder"
            )

    def _take(self, step: Callable[..., None], to: float, given: dict[str, Any]) -> None:
        """Call a step of the model with its time and inputs, and record it."""
        self._check()
        begin = time.perf_counter()
        step(to, **given)
        model, length = self.model, self.model.time - self._time
        self._time = model.time
        if self._memory is not None:
            self._memory.steps.append(applied_values(model, length, given))
        if self._writer is not None:
            self._writer.write_step(model, length, given)
        if model.time >= self._due - _EARLY * self._interval:
            self._due = self._next_due()
            self._output()
        self._wall_time += time.perf_counter() - begin

    def _next_due(self) -> float:
        """The first multiple of the output interval after the present time [s]."""
        passed = math.floor(self._time / self._interval + _EARLY)
        return (passed + 1) * self._interval

    def _output(self, *, last: bool = False) -> None:
        model = self.model
        shapes = shapes_of(model)
        for state in shapes.values():
            self._largest_curvature = max(self._largest_curvature, float(np.max(state.curvature)))
        exact = last or self._outputs % self._cadence.states == 0
        shape = last or self._outputs % self._cadence.shapes == 0
        if self._memory is not None:
            self._memory.output(model, shapes, exact=exact)
        if self._writer is not None:
            self._writer.write_outputs(model, shapes, exact_state=exact, shape=shape)
        self._outputs += 1
        self._last_output, self._last_exact, self._last_shape = model.time, exact, shape

    # -- the end --------------------------------------------------------------------------------

    @property
    def statistics(self) -> dict[str, Any]:
        """Of the model, with the largest curvature of outputs [1/m] and the computing time [s]."""
        found = {"max_curvature": self._largest_curvature, "wall_time": self._wall_time}
        return {**self.model.statistics, **found}

    def close(self) -> None:
        """End the recording with an output at the present time; leaving a ``with`` block does it.

        Raises:
            CableModelError: the model was taken elsewhere without the recorder, or the log cannot
                be written. The recording has ended all the same, with what it has until then; the
                run is not complete, and says why.
        """
        if self._ended:
            return
        try:
            self._check()
            self._end_output()
        except BaseException as error:
            with suppress(LogError):  # it is the error, or of no account beside it
                self.fail(str(error) or type(error).__name__)
            raise
        self._ended = True
        if self._writer is not None:
            self._writer.close(self.statistics)

    def _end_output(self) -> None:
        """The output at the end, or what the last one left out along the cable."""
        if self._last_output != self._time:
            self._output(last=True)
        elif self._memory is not None and not self._last_exact:
            self._memory.keep(shapes_of(self.model))
        elif self._writer is not None:
            self._writer.write_along(
                self.model, exact_state=not self._last_exact, shape=not self._last_shape
            )

    def fail(self, reason: str) -> None:
        """End the recording of a run that did not come to its end, and say why in its log."""
        if self._ended:
            return
        self._ended, self._reason = True, reason
        if self._writer is not None:
            self._writer.fail(reason, self.statistics)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if error is None:
            self.close()
        else:
            interrupted = isinstance(error, KeyboardInterrupt)
            self.fail("interrupted" if interrupted else str(error) or type(error).__name__)

    def run(self) -> Run:
        """The run that was recorded, after its end: read from the log, or from memory.

        Raises:
            CableModelError: the recording goes on.
        """
        if not self._ended:
            raise CableModelError("the recording goes on: close it first, or leave its with block")
        if self._log is not None:
            return open_run(self._log)
        assert self._memory is not None
        return run_of(
            self.model.scene,
            self._memory,
            statistics=self.statistics,
            complete=not self._reason,
            reason=self._reason,
        )


class SystemRecorder(Recorder):
    """A `Recorder` of a `SystemModel`."""

    def step(self, dt: float, **inputs: Unpack[SystemInputs]) -> None:  # type: ignore[override]
        """As :meth:`SystemModel.step`, recorded."""
        self._take(self.model.step, dt, _kept(inputs))

    def step_to(self, end: float, **inputs: Unpack[SystemInputs]) -> None:  # type: ignore[override]
        """As :meth:`SystemModel.step_to`, recorded."""
        self._take(self.model.step_to, end, _kept(inputs))


def recorder_of(model: Any, *arguments: Any, **options: Any) -> Recorder:
    """A recorder of a model of one line or of a system; arguments as those of `Recorder`."""
    check_model(model)
    kind = SystemRecorder if variables.is_system(model.scene) else Recorder
    return kind(model, *arguments, **options)


def _by_name(inputs: tuple[Any, ...]) -> dict[str, Any]:
    """Those inputs of a step of one line that are given."""
    pairs = zip(variables.INPUTS, inputs, strict=True)
    return {item.python: value for item, value in pairs if value is not None}


def _kept(inputs: SystemInputs) -> dict[str, Any]:
    """Those inputs of a step of a system that are given."""
    from cablemodel.systems.inputs import names_of

    given: dict[str, Any] = {**inputs}
    given["cuts"] = names_of(given.get("cuts"))
    return {name: value for name, value in given.items() if value}


def check_model(model: Any) -> None:
    """Refuse what cannot be stepped, such as a scene or its file.

    Raises:
        TypeError: it is no model.
    """
    if not callable(getattr(model, "step_to", None)):
        raise TypeError(f"model is {shown(model)}; allowed: a CableModel, CableModel(scene)")


class Memory:
    """Outputs, states and applied inputs of a run, kept in memory (a ``Source`` of a Run)."""

    def __init__(self, scene: Scene | SystemScene) -> None:
        self.steps: list[Floats] = []
        """What each step applied, in the order of ``variables.input_labels``."""
        self._labels = variables.input_labels(scene)
        self._system = variables.is_system(scene)
        self._times: list[float] = []
        self._state_times: list[float] = []
        self._states: dict[str, list[Floats]] = {
            line: [] for line in variables.state_topics_of(scene)
        }
        self._values: dict[str, list[Any]] = {
            variable.python: []
            for variable in variables.outputs_of(scene)
            if variable.message != variables.CLOUD
        }

    def output(self, model: Any, shapes: Mapping[str, CableState], *, exact: bool) -> None:
        """Keep all outputs at the model's time, and its shapes if they are to be exact."""
        self._times.append(model.time)
        if exact:
            self.keep(shapes)
        outputs = model.outputs(shapes) if self._system else {}
        for name, values in self._values.items():
            owner, _, attribute = name.rpartition(".")
            if self._system:
                values.append(np.array(outputs[name], float))
            elif owner == "bodies":
                vectors = [getattr(body, attribute) for body in model.bodies]
                values.append(np.array(vectors, float).reshape(-1, 3))
            else:
                values.append(np.array(getattr(model, name), float))

    def keep(self, shapes: Mapping[str, CableState]) -> None:
        for name, state in shapes.items():
            self._states[name].append(matrix_of(state))
        self._state_times.append(state.time)

    def times(self) -> Floats:
        return np.array(self._times)

    def holds(self, variable: variables.Variable) -> bool:
        return True

    def column(self, variable: variables.Variable) -> Floats:
        values = self._values[variable.python]
        if variable.present == "bodies":
            return bodies_in_columns(values)
        return np.array(values, float)

    def shapes(self) -> dict[str, States]:
        times = np.array(self._state_times)
        return {name: States(times, matrices) for name, matrices in self._states.items()}

    def applied_inputs(self) -> dict[str, Floats]:
        return by_label(self.steps, self._labels)
