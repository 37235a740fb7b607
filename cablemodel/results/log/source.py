"""The columns of a run, gathered from its log."""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel import variables
from cablemodel.errors import LogError
from cablemodel.results.log.messages import (
    ODOMETRY_FLOATS,
    ODOMETRY_TWIST,
    POSE_FLOATS,
    direction_of,
)
from cablemodel.results.log.reader import LogFile
from cablemodel.results.states import States, bodies_in_columns, by_label
from cablemodel.scene import Scene

if TYPE_CHECKING:
    from cablemodel.systems import SystemScene

Floats = NDArray[np.float64]

_STATE = variables.resolved(variables.STATE_TOPIC)
_INPUTS = variables.resolved(variables.APPLIED_INPUTS_TOPIC)

_TAIL: dict[str, tuple[int, int]] = {
    "top_force": (6, 0),
    "top_moment": (6, 3),
    "tip_position": (ODOMETRY_FLOATS, 0),
    "tip_velocity": (ODOMETRY_FLOATS, ODOMETRY_TWIST),
    "touchdown_position": (3, 0),
    "floor_force": (6, 0),
}
"""Of every vector: how many floats its message ends in, and where among them the vector begins."""


class LogSource:
    """Values over time from a log; each topic is read when it is asked for."""

    def __init__(self, log: LogFile) -> None:
        self.log = log

    def times(self) -> Floats:
        """Output times (n,) [s]: exact where a step ended or a state was logged then, else to a
        nanosecond."""
        stamps = self.log.stamps(variables.OUTPUTS[0].resolved_topic)
        times = 1e-9 * (stamps - self.log.epoch).astype(np.float64)
        exact = stamps == self.log.epoch
        for topic in (_INPUTS, _STATE):
            known = self.log.stamps(topic)
            if len(known) and not np.all(exact):  # states are read only if steps do not suffice
                at = np.minimum(np.searchsorted(known, stamps), len(known) - 1)
                found = known[at] == stamps
                values = self.state_times if topic == _STATE else self.log.first_floats(topic)
                times[found] = values[at[found]]
                exact |= found
        return times

    @cached_property
    def state_times(self) -> Floats:
        return self.log.first_floats(_STATE)

    @cached_property
    def _state_values(self) -> list[Floats]:
        labels, values = self.log.arrays(_STATE)
        if values and labels != variables.STATE_LABELS:
            raise LogError(f"{self.log.path}: states have other fields than this version knows")
        return values

    def shapes(self) -> dict[str, States]:
        return {"": States(self.state_times, self._matrices)}

    def _matrices(self) -> list[Floats]:
        rows = len(variables.STATE_LABELS)
        return [values[1:].reshape(rows, -1) for values in self._state_values]

    def holds(self, variable: variables.Variable) -> bool:
        """Whether it was logged, which an earlier version may not have done."""
        return not self._counts or self._counts.get(variable.resolved_topic, 0) > 0

    @cached_property
    def _counts(self) -> dict[str, int]:
        return self.log.counts()

    def column(self, variable: variables.Variable) -> Floats:
        topic = variable.resolved_topic
        if variable.message == variables.FLOAT64:
            return self.log.trailing_floats(topic, 1)[:, 0]
        if variable.message == variables.ARRAY:
            key = variable.python.removeprefix("slack_")
            labels = variables.SLACK_LABELS
            return self.log.trailing_floats(topic, len(labels))[:, labels.index(key)]
        if variable.message == variables.POSES:
            return self._bodies(variable)
        count, first = _TAIL[variable.python]
        return self.log.trailing_floats(topic, count)[:, first : first + 3]

    def _bodies(self, variable: variables.Variable) -> Floats:
        """Positions or directions of the bodies (n, bodies, 3)."""
        samples = []
        for message in self.log.messages(variable.resolved_topic).data:
            # 4 bytes CDR, stamp, "map", then the number of poses, and at the end the poses.
            count = POSE_FLOATS * int.from_bytes(message[20:24], "little")
            poses = np.frombuffer(message[len(message) - 8 * count :], "<f8")
            poses = poses.reshape(-1, POSE_FLOATS)
            position = variable.python == "bodies.position"
            samples.append(poses[:, :3] if position else direction_of(poses[:, 3:]))
        return bodies_in_columns(samples)

    def applied_inputs(self) -> dict[str, Floats]:
        """Applied inputs of every step by label: ``time``, ``step``, ``payout_rate``, ..."""
        return applied_inputs_of(self.log, variables.APPLIED_INPUT_LABELS)


class SystemSource:
    """The same from the log of a system: all outputs stand in one topic, exact."""

    def __init__(self, log: LogFile, scene: SystemScene) -> None:
        self.log, self.scene = log, scene

    @cached_property
    def _outputs(self) -> dict[str, Floats]:
        labels, values = self.log.arrays(variables.resolved(variables.OUTPUTS_TOPIC))
        return by_label(values, labels or variables.output_labels(self.scene))

    def times(self) -> Floats:
        return self._outputs["time"]

    def holds(self, variable: variables.Variable) -> bool:
        """Whether it was logged, which an earlier version may not have done."""
        return any(label.startswith(variable.python) for label in self._outputs)

    def column(self, variable: variables.Variable) -> Floats:
        if not variable.shape:
            return self._outputs[variable.python]
        return np.column_stack([self._outputs[f"{variable.python}.{axis}"] for axis in "xyz"])

    def shapes(self) -> dict[str, States]:
        named = variables.state_topics_of(self.scene)
        topics = {name: variables.resolved(topic) for name, topic in named.items()}
        times = {name: self.log.first_floats(topic) for name, topic in topics.items()}
        # A log that was cut may have the last state of some of the lines only.
        count = min(map(len, times.values()))
        return {name: self._states(topic, times[name][:count]) for name, topic in topics.items()}

    def _states(self, topic: str, times: Floats) -> States:
        def matrices() -> list[Floats]:
            labels, values = self.log.arrays(topic)
            if values and labels != variables.STATE_LABELS:
                raise _other_fields(self.log, "states")
            rows = values[: len(times)]
            return [row[1:].reshape(len(variables.STATE_LABELS), -1) for row in rows]

        return States(times, matrices)

    def applied_inputs(self) -> dict[str, Floats]:
        return applied_inputs_of(self.log, variables.input_labels(self.scene))


def source_of(log: LogFile, scene: Scene | SystemScene) -> LogSource | SystemSource:
    """What a log of a scene holds."""
    return LogSource(log) if isinstance(scene, Scene) else SystemSource(log, scene)


def applied_inputs_of(log: LogFile, labels: tuple[str, ...]) -> dict[str, Floats]:
    """What every step applied, by label."""
    return labelled_rows(log, _INPUTS, labels)


def labelled_rows(log: LogFile, topic: str, labels: tuple[str, ...]) -> dict[str, Floats]:
    """All rows of numbers of a topic by label.

    Raises:
        LogError: they have other labels.
    """
    found, values = log.arrays(topic)
    if values and found != labels:
        raise _other_fields(log, topic)
    return by_label(values, labels)


def _other_fields(log: LogFile, what: str) -> LogError:
    return LogError(f"{log.path}: {what} have other fields than this version knows")
