"""The log (MCAP) of an FMU's run in fmpy, as of any other run: with exact states and inputs."""

from __future__ import annotations

import zipfile
from collections.abc import Iterable
from os import PathLike
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cablemodel.errors import CableModelError
from cablemodel.model import CableModel
from cablemodel.results.recorder import recorder_of
from cablemodel.solvers.protocol import Memory
from cablemodel.solvers.shared import layout as at
from cablemodel.systems import SystemModel, VesselInput
from cablemodel.systems.inputs import motion_given
from cablemodel.systems.model import read_scene
from cablemodel.variables import is_system
from cablemodel_fmu.export import block_of
from cablemodel_fmu.shared_numbers import STATE_APPLIED

_LAST_STEP = STATE_APPLIED + at.INPUT_WORDS
"""Word of a state that holds the length of the last step."""


class FmuLog:
    """Writes the log of a run that fmpy makes of an exported FMU.

        with FmuLog("tow.fmu", "tow.mcap") as log:
            simulate_fmu("tow.fmu", stop_time=200, output_interval=0.5, step_finished=log)

    After every step the FMU's state is taken over, so that the log holds what the FMU computed, and
    `cablemodel replay tow.mcap` makes the same run again in Python. Parameters must be those of the
    scene: with others, export the scene with them.

    Args:
        fmu: the FMU that is run.
        log: file to write.
        options: of `cablemodel.Recorder`: output_interval, state_interval, until.

    Raises:
        CableModelError: its scene estimates errors, whose states hold two runs.
    """

    def __init__(self, fmu: str | PathLike[str], log: str | PathLike[str], **options: Any) -> None:
        with zipfile.ZipFile(fmu) as archive:
            scene = read_scene(archive.read("resources/scene.yaml").decode())
        if scene.solver.error_estimate:
            raise CableModelError(
                "an FMU that estimates its errors cannot be logged: export it without "
                "solver.error_estimate"
            )
        self._fmu = fmu
        self._parameters: list[tuple[str, int, float]] | None = None
        self.model: Any = (_SystemFollower if is_system(scene) else _Follower)(scene)
        self.recorder: Any = recorder_of(self.model, log, **options)

    def __call__(self, time: float, recorder: Any) -> bool:
        """Take over a step that was made; fmpy goes on.

        Raises:
            CableModelError: a parameter is not that of the scene; or the step did not begin where
                the log ends: one was left out, or taken back.
        """
        slave = recorder.fmu
        self._check_parameters(slave)
        state = slave.getFMUstate()
        try:
            words = np.frombuffer(slave.serializeFMUstate(state), dtype=np.int64)
        finally:
            slave.freeFMUstate(state)
        given = self.model.take(words)
        before, reached = self.model.time, self.model.reached
        if reached == before:
            return True
        step = float(words[_LAST_STEP : _LAST_STEP + 1].view(np.float64)[0])
        if abs(reached - step - before) > 1e-9 * (abs(reached) + step):
            raise CableModelError(
                f"the FMU stepped from {reached - step:g} to {reached:g} s, and the log ends at "
                f"{before:g} s: a log holds every step once, in order"
            )
        self.recorder.step_to(reached, **given)
        return True

    def _check_parameters(self, slave: Any) -> None:
        if self._parameters is None:
            from fmpy import read_model_description

            self._parameters = [
                (variable.name, variable.valueReference, float(variable.start))
                for variable in read_model_description(str(self._fmu)).modelVariables
                if variable.causality == "parameter" and variable.type == "Real"
            ]
        values = slave.getReal([reference for _, reference, _ in self._parameters])
        for (name, _, start), value in zip(self._parameters, values, strict=True):
            if value != start:
                raise CableModelError(
                    f"{name} is {value:g}, in the scene it is {start:g}: a log holds one scene; "
                    "export it with this value"
                )

    def __enter__(self) -> Self:
        self.recorder.__enter__()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.recorder.__exit__(kind, error, trace)


class _Follower(CableModel):
    """A model whose steps an FMU makes."""

    def __init__(self, scene: Any) -> None:
        super().__init__(scene)
        solver: Any = self._solver
        solver.memory = block_of(self.scene)  # with the FMU's room
        self._initial = [memory.image.copy() for memory in solver.memories]
        self._next: NDArray[np.int64] = solver.memory.image.copy()
        self.reached = self.time

    def take(self, state: NDArray[np.int64]) -> dict[str, Any]:
        """A state of the FMU: the next step ends there. Returns the inputs that led to it."""
        self._next = state[-_image_words(self._solver.memory, state) :]
        applied = state[STATE_APPLIED : STATE_APPLIED + at.INPUT_WORDS].view(np.float64)
        inputs = at.StepInputs(applied, 0)
        given: dict[str, Any] = {}
        if inputs.velocity_given != 0.0:
            given["vessel_velocity"] = inputs.velocity.copy()
        if inputs.position_given != 0.0:
            given["vessel_position"] = inputs.position.copy()
        if inputs.current_given != 0.0:
            given["current"] = inputs.current.copy()
        if inputs.payout_given != 0.0:
            given["payout_rate"] = float(inputs.payout_rate)
        self.reached = _time_of(self._solver.memory, self._next)
        return given

    def step_to(
        self,
        time: float,
        vessel_velocity: ArrayLike | None = None,
        vessel_position: ArrayLike | None = None,
        payout_rate: float | None = None,
        current: ArrayLike | None = None,
    ) -> None:
        """Take over the state that the FMU has reached."""
        self._solver.memory.take(self._next)
        self._summary_current, self._errors = False, None


class _SystemFollower(SystemModel):
    """A system whose steps an FMU makes."""

    def __init__(self, scene: Any) -> None:
        super().__init__(scene)
        self._next: NDArray[np.int64] = self.built.block.image.copy()
        self._pushed, self._turned = self._forces, self._angles
        self.reached = self.time

    def take(self, state: NDArray[np.int64]) -> dict[str, Any]:
        """A state of the FMU: the next step ends there. Returns the inputs that led to it."""
        size = _image_words(self.built.block, state)
        self._next = state[-size:]
        self.reached = _time_of(self.built.block, self._next)
        scene = self.scene
        vessels, bodies, foils = len(scene.vessels), len(scene.bodies), len(self._angles)
        counts = (at.FRAME_INPUTS * vessels, 6 * bodies, foils, 2 * len(scene.winches))
        applied = state[-size - sum(counts) - len(scene.cuts) : -size].view(np.float64)
        motion, forces, angles, rates, orders = np.split(applied, np.cumsum(counts))
        self._pushed = forces.reshape(bodies, 6).copy()
        self._turned = np.where(np.isnan(angles), self._angles, angles)
        return {
            "vessels": {
                name: VesselInput(**given)
                for name, row in zip(scene.vessels, motion.reshape(vessels, -1), strict=True)
                if (given := motion_given(row))
            },
            "forces": _by_name(scene.bodies, self._pushed, np.any(self._pushed != 0.0, axis=1)),
            "deflections": _by_name(self.deflections, self._turned, ~np.isnan(angles)),
            "rates": _by_name(scene.winches, rates[1::2], rates[::2] != 0.0),
            "cuts": list(_by_name(scene.cuts, orders, orders != 0.0)),
        }

    def step_to(self, time: float, **inputs: Any) -> None:
        """Take over the state that the FMU has reached."""
        self.built.block.take(self._next)
        self._forces, self._angles = self._pushed, self._turned


def _image_words(memory: Memory, state: NDArray[np.int64]) -> int:
    """Of the image at the end of a state of the FMU, whose memory may have grown."""
    for start in np.flatnonzero(state == memory.ints[at.Header.magic.word]):
        image = state[start - at.Header.magic.word :]
        if memory.fits(image):
            return len(image)
    raise CableModelError("a state of the FMU is of another scene")


def _time_of(memory: Memory, image: NDArray[np.int64]) -> float:
    """Of an image of a block, or of what is its memory [s]."""
    now = memory.image.copy()
    memory.take(image)
    time = float(memory.scalars.time)
    memory.take(now)
    return time


def _by_name(
    names: Iterable[str], values: NDArray[np.float64], given: NDArray[np.bool_]
) -> dict[str, Any]:
    """Those values that were given."""
    return {
        name: value for name, value, is_given in zip(names, values, given, strict=True) if is_given
    }
