"""Write the log of a run as it goes.

The file is worth something at every moment: scene and versions are in it before the first sample,
and what has been written is on its way to the disk at the latest after one simulated second,
64 kB, or one second by the clock.
"""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable, Collection, Iterable, Mapping
from contextlib import suppress
from os import PathLike
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any, Self

import numpy as np
import yaml
from numpy.typing import NDArray

from cablemodel import variables
from cablemodel.errors import LogError
from cablemodel.results.log import lock
from cablemodel.results.log.messages import Messages, definition, type_hash
from cablemodel.results.log.parts import encode_parts
from cablemodel.results.log.provenance import provenance
from cablemodel.results.states import applied_values, shapes_of
from cablemodel.solvers.shared.layout import Summary

if TYPE_CHECKING:
    from cablemodel.model import CableModel, CableState
    from cablemodel.scene import Scene
    from cablemodel.systems import SystemScene

SCHEMA_VERSION = "1"
"""Version of what this project adds to MCAP and ROS 2: names, layouts, metadata."""

METADATA_START = "cablemodel"
METADATA_END = "cablemodel_end"
TOPIC_NAMES = "topics"
"""In the metadata: topics of the table whose names in the file are others (JSON)."""
SCENE_ATTACHMENT = "scene.yaml"
SOURCE_ATTACHMENT = "scene_as_written.yaml"
SNAPSHOT_ATTACHMENT = "snapshot.bin"
"""State that a file begins at (`CableModel.snapshot`); missing where that is the initial one."""

CHUNK_BYTES = 64 * 1024
CHUNK_SIMULATED_SECONDS = 1.0
CHUNK_WALL_SECONDS = 1.0

VALUES, SHAPES, STATES = "values", "shapes", "states"
"""Groups of channels with chunks of their own, in the order of the file: who reads the tension over
time of a long log does not read its states along, and a log that is cut between two chunks lacks
states of outputs rather than outputs of states."""

# As rosbag2 writes it for a publisher with the default profile (metadata version 9, ROS 2 Jazzy).
_QOS = yaml.safe_dump(
    [
        {
            "history": "keep_last",
            "depth": 10,
            "reliability": "reliable",
            "durability": "volatile",
            "deadline": {"sec": 9223372036, "nsec": 854775807},
            "lifespan": {"sec": 9223372036, "nsec": 854775807},
            "liveliness": "automatic",
            "liveliness_lease_duration": {"sec": 9223372036, "nsec": 854775807},
            "avoid_ros_namespace_conventions": False,
        }
    ],
    sort_keys=False,
).strip()


class LogWriter:
    """Writes one run to one MCAP file; use it as a context manager.

    Leaving the ``with`` block by an exception closes the file properly and records why it ended
    early; a run is complete only after :meth:`close` was told so.

    Args:
        path: file to write; an existing one is replaced.
        scene: scene of the run; attached to the file with all its values in SI.
        epoch: time that stands for t = 0 [ns since 1970]; now (whole seconds) if not given.
        topics: names in the file of topics that are not to have those of the table there, such as
            ``{"/cable/nodes": "/tug/cable/nodes"}``.

    Raises:
        LogError: the file cannot be written, or another run writes it.
    """

    def __init__(
        self,
        path: str | PathLike[str],
        scene: Scene | SystemScene,
        *,
        epoch: int | None = None,
        topics: Mapping[str, str] | None = None,
    ) -> None:
        from cablemodel.results.log.container import Container

        self.path = Path(path)
        self.epoch = int(time.time()) * 1_000_000_000 if epoch is None else int(epoch)
        try:
            self._file = lock.open_alone(self.path)
        except OSError as error:
            raise LogError(f"cannot write the log {self.path}: {error.strerror}") from error
        self._messages = Messages()
        self._topics = variables.topics_of(scene)
        states = variables.state_topics_of(scene)
        self._states = {line: variables.resolved(topic) for line, topic in states.items()}
        self._input_labels = variables.input_labels(scene)
        self._output_labels: tuple[str, ...] = ()
        if variables.is_system(scene):
            self._output_labels = variables.output_labels(scene)
            self._topics[_OUTPUTS] = variables.ARRAY
        self._names = dict(topics or {})
        self._topics_over_time = [
            topic for topic, message in self._topics.items() if message != variables.CLOUD
        ]
        self._channels: dict[str, int] = {}
        self._lock = threading.Lock()
        self._failure: OSError | None = None
        self._closed = False
        self._pending_bytes = 0  # of the largest open chunk
        self._pending_since = 0.0
        self._chunk_start = 0
        try:
            self._mcap = Container(
                self._file, profile="ros2", library=f"cablemodel {_package_version()}"
            )
            self._begin(scene)
        except OSError as error:
            self._close_file()
            raise self._write_error(error) from error
        self._wake = threading.Event()
        self._timer = threading.Thread(
            target=self._flush_by_the_clock, name=f"log {self.path.name}", daemon=True
        )
        self._timer.start()

    def _begin(self, scene: Scene | SystemScene) -> None:
        """Header, scene and versions, and the channels of everything that may follow."""
        self._attach(SCENE_ATTACHMENT, scene.to_yaml())
        if scene.source_text is not None:
            self._attach(SOURCE_ATTACHMENT, scene.source_text)
        solver = scene.model_dump(
            mode="json", by_alias=True, exclude_none=True, include={"solver"}
        ).get("solver", {})
        self._mcap.add_metadata(
            METADATA_START,
            {
                "schema_version": SCHEMA_VERSION,
                "epoch_ns": str(self.epoch),
                "title": scene.title or "",
                "solver": json.dumps(solver),
                **({TOPIC_NAMES: json.dumps(self._names)} if self._names else {}),
                **provenance(),
            },
        )
        self._file.flush()
        schemas: dict[str, int] = {}
        groups = dict.fromkeys(self._states.values(), STATES)
        groups |= {t: SHAPES for t, message in self._topics.items() if message == variables.CLOUD}
        every = {**self._topics, _INPUTS: variables.ARRAY}
        for topic, message in {
            **every,
            **dict.fromkeys(self._states.values(), variables.ARRAY),
        }.items():
            if message not in schemas:
                schemas[message] = self._mcap.add_schema(
                    message, "ros2msg", definition(message).encode()
                )
            self._channels[topic] = self._mcap.add_channel(
                self._names.get(topic, topic),
                "cdr",
                schemas[message],
                {"offered_qos_profiles": _QOS, "topic_type_hash": type_hash(message)},
                groups.get(topic, VALUES),
            )

    def _attach(self, name: str, text: str) -> None:
        self._mcap.attach(self.epoch, name, "application/yaml", text.encode())

    def stamp(self, simulated_time: float) -> int:
        """Time stamp [ns] of a simulated time [s]."""
        return self.epoch + round(simulated_time * 1e9)

    def write_step(
        self, model: CableModel, step: float, given: Collection[str] | Mapping[str, Any] = ()
    ) -> None:
        """Log what the step that was just made applied.

        Args:
            model: the model after the step.
            step: length of the step [s].
            given: the inputs that the caller gave to ``step`` (the others came from the scene), by
                name; replay gives the same ones again. For an exact replay, with their values.
        """
        values = applied_values(model, step, given)
        message = self._messages.row(self._input_labels, values)
        self.write(self.stamp(model.time), [(_INPUTS, message)])

    def write_outputs(
        self,
        model: Any,
        shapes: CableState | Mapping[str, CableState] | None = None,
        *,
        exact_state: bool = True,
        shape: bool = True,
    ) -> None:
        """Log all outputs of the table and the exact state at the model's time.

        Args:
            model: the model at an output time.
            shapes: ``model.state()``, or of a system ``model.shapes()``, if the caller has it.
            exact_state: False leaves out the state in 64-bit floats, most of a log's size, for
                outputs more frequent than states are wanted.
            shape: False leaves out the shape for viewers, most of what is then left.
        """
        topics = list(self._topics) if shape else self._topics_over_time
        found = self._outputs(model, shapes, topics, exact_state=exact_state)
        self.write(self.stamp(model.time), found)

    def write_along(self, model: Any, *, exact_state: bool, shape: bool) -> None:
        """Log what an output at the model's time left out along the cable."""
        over_time = set(self._topics_over_time)
        topics = [topic for topic in self._topics if shape and topic not in over_time]
        found = self._outputs(model, None, topics, exact_state=exact_state)
        if found:
            self.write(self.stamp(model.time), found)

    def _outputs(
        self,
        model: Any,
        shapes: CableState | Mapping[str, CableState] | None,
        topics: list[str],
        *,
        exact_state: bool,
    ) -> list[tuple[str, bytes]]:
        if shapes is None:
            shapes = shapes_of(model)
        elif not isinstance(shapes, Mapping):
            shapes = {"": shapes}
        stamp = self.stamp(model.time)
        if self._output_labels:
            found = encode_parts(self._messages, topics, stamp, model, shapes, self._output_labels)
        else:
            found = encode_outputs(self._messages, topics, stamp, model, shapes[""])
        if exact_state:
            found += [
                (self._states[name], self._messages.state(model.time, state, name))
                for name, state in shapes.items()
            ]
        return found

    def write(self, stamp: int, messages: Iterable[tuple[str, bytes]]) -> None:
        """Log messages that are serialised already, all of one time.

        Args:
            stamp: their time [ns], see :meth:`stamp`.
            messages: topics of this log (``~`` may stand for the node's name) and CDR bytes.
        """
        with self._lock:
            self._begin_sample(stamp)
            for topic, data in messages:
                self._put(variables.resolved(topic), stamp, data)
            self._end_sample()

    def attach(self, name: str, media_type: str, data: bytes) -> None:
        """Attach a file, such as the state that this log begins at."""
        with self._lock:
            self._mcap.attach(self.epoch, name, media_type, data)

    def flush(self) -> None:
        """Hand all that was written to the operating system: no kill of this process loses it."""
        with self._lock:
            if self._pending_bytes and not self._closed:
                self._flush()

    def close(self, statistics: Mapping[str, Any] | None = None) -> None:
        """Finish the file of a run that went to its end; ``statistics`` are kept with it."""
        self._finish("complete", "", statistics)

    def fail(self, reason: str, statistics: Mapping[str, Any] | None = None) -> None:
        """Finish the file of a run that ended early, and say in it why."""
        self._finish("failed", reason, statistics)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._closed:
            return
        if error is None:
            self._finish("stopped", "the log was closed before the run was at its end", None)
        else:
            self.fail(str(error) or type(error).__name__)

    def _begin_sample(self, stamp: int) -> None:
        """Close the chunks if this sample would make them longer than a simulated second."""
        if self._closed:
            raise LogError(f"the log {self.path} is closed")
        if self._failure is not None:
            raise self._write_error(self._failure) from self._failure
        if self._pending_bytes and stamp - self._chunk_start >= _CHUNK_NANOSECONDS:
            self._flush()
        if not self._pending_bytes:
            self._chunk_start = stamp
            self._pending_since = time.monotonic()

    def _put(self, topic: str, stamp: int, data: bytes) -> None:
        size = self._mcap.add_message(self._channels[topic], stamp, data)
        if size > self._pending_bytes:
            self._pending_bytes = size

    def _end_sample(self) -> None:
        if self._pending_bytes >= CHUNK_BYTES:
            self._flush()

    def _flush(self) -> None:
        """Close the chunks and hand them to the operating system."""
        try:
            self._mcap.close_chunks()
        except OSError as error:
            self._failure = error
            raise self._write_error(error) from error
        self._pending_bytes = 0

    def _flush_by_the_clock(self) -> None:
        """Flush what is a second old even while a long step is being computed."""
        while not self._wake.wait(0.25 * CHUNK_WALL_SECONDS):
            with self._lock:
                age = time.monotonic() - self._pending_since
                if self._pending_bytes and age >= 0.75 * CHUNK_WALL_SECONDS:
                    try:
                        self._flush()
                    except LogError:
                        return  # the next write raises it where the caller can see it

    def _finish(self, status: str, reason: str, statistics: Mapping[str, Any] | None) -> None:
        """Write how the run ended, statistics, indexes and the summary, and close the file."""
        if self._closed:
            return
        self._closed = True
        self._wake.set()
        self._timer.join()
        end = {"status": status, "reason": reason}
        if statistics is not None:
            end["statistics"] = json.dumps({key: _plain(v) for key, v in statistics.items()})
        try:
            if self._failure is not None:
                raise self._failure
            self._mcap.close_chunks()
            self._mcap.add_metadata(METADATA_END, end)
            self._mcap.finish()
        except OSError as error:
            raise self._write_error(error) from error
        finally:
            self._close_file()

    def _close_file(self) -> None:
        with suppress(OSError):  # what could not be written was reported where it happened
            lock.close(self._file)

    def _write_error(self, error: OSError) -> LogError:
        return LogError(f"cannot write the log {self.path}: {error.strerror or error}")


_CHUNK_NANOSECONDS = round(CHUNK_SIMULATED_SECONDS * 1e9)
_INPUTS = variables.resolved(variables.APPLIED_INPUTS_TOPIC)
_OUTPUTS = variables.resolved(variables.OUTPUTS_TOPIC)

_Encode = Callable[[Messages, int, Summary, Any, Any], bytes]


def _float64(name: str) -> _Encode:
    if name in Summary.FIELDS:
        return lambda messages, stamp, found, model, state: messages.float64(getattr(found, name))
    return lambda messages, stamp, found, model, state: messages.float64(getattr(model, name))


def encode_outputs(
    messages: Messages, topics: Iterable[str], stamp: int, model: CableModel, state: Any
) -> list[tuple[str, bytes]]:
    """Messages of output topics (the table's or resolved names) of a model at a stamp [ns]."""
    found = model.numbers()
    return [(topic, _ENCODE[topic](messages, stamp, found, model, state)) for topic in topics]


def _encoders() -> dict[str, _Encode]:
    """How the message of each output topic, by both of its names, is made from a model and its
    state."""
    special: dict[str, _Encode] = {
        "~/top_wrench": lambda m, t, found, model, state: m.top_wrench(
            t, model.top_force, model.top_moment
        ),
        "~/end_odom": lambda m, t, found, model, state: m.odometry(
            t, found.tip_position, found.tip_velocity
        ),
        "~/bodies": lambda m, t, found, model, state: m.poses(
            t, [b.position for b in model.bodies], [b.direction for b in model.bodies]
        ),
        "~/nodes": lambda m, t, found, model, state: m.cloud(t, state),
        "~/touchdown": lambda m, t, found, model, state: m.point(t, model.touchdown_position),
        "~/slack": lambda m, t, found, model, state: m.row(variables.SLACK_LABELS, _slack(found)),
        "~/floor_force": lambda m, t, found, model, state: m.wrench(t, found.floor_force),
    }
    return {
        topic: special.get(variable.topic) or _float64(variable.python)
        for variable in variables.OUTPUTS
        for topic in (variable.topic, variable.resolved_topic)
    }


_ENCODE = _encoders()


def _slack(found: Summary) -> NDArray[np.float64]:
    """In the order of ``variables.SLACK_LABELS``."""
    times = found.slack_time, found.slack_longest, found.slack_since
    return np.array([*times, found.slack_start, found.slack_end])


def _plain(value: Any) -> Any:
    """A NumPy number as Python's own, for JSON."""
    return value.item() if isinstance(value, np.generic) else value


def _package_version() -> str:
    import cablemodel

    return cablemodel.__version__
