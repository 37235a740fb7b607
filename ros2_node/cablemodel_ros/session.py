"""A cable or a system that commands steer: all that the node does, without ROS.

A session is made from settings, and stepped by whoever calls it. It is not thread-safe but for
the ports of its `rig`; the control loop holds a lock around it.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn
from zipfile import BadZipFile

import numpy as np

from cablemodel import Scene, StepError, SystemScene, variables
from cablemodel.errors import SceneError
from cablemodel.results.states import shapes_of
from cablemodel.systems import read_scene
from cablemodel_ros.checkpoints import Checkpoints
from cablemodel_ros.frames import Floats
from cablemodel_ros.recording import Recorder
from cablemodel_ros.rig import Frame, Rig, rig_of
from cablemodel_ros.samples import Message, topics
from cablemodel_ros.settings import Settings
from cablemodel_ros.timebase import Published, RealTime, Timebase
from cablemodel_ros.times import Moment, Monotonic, Simulated, Stamp
from cablemodel_ros.timing import Durations


@dataclass(frozen=True)
class Cycle:
    """What a step gave."""

    stamp: Stamp
    """Of the step's end."""
    applied: list[Message]
    """What was applied; always published."""
    outputs: list[Message]
    """All outputs that were wanted."""
    frames: list[Frame]
    """Those that the settings ask for."""
    shed: bool = False
    """Whether outputs were left out to keep up."""


@dataclass(frozen=True)
class Names:
    """What a node and its topics are called."""

    node: str = "/cable"
    """Full name."""
    topic: Callable[[str], str] = variables.resolved
    """Name of a topic of the table (``~/nodes``), as it is on the wire."""

    def of(self, scene: Scene | SystemScene) -> dict[str, str]:
        """Topics of a scene's log that are not called as in the table."""
        states = variables.state_topics_of(scene).values()
        table = [*topics(scene), variables.APPLIED_INPUTS_TOPIC, *states]
        if variables.is_system(scene):
            table.append(variables.OUTPUTS_TOPIC)
        found = {variables.resolved(topic): self.topic(topic) for topic in table}
        return {topic: name for topic, name in found.items() if name != topic}


class SessionError(Exception):
    """The model cannot go on."""


class Session:
    """One cable or system from configuration to clean-up.

    Args:
        settings: see `settings.PARAMETERS`.
        timebase: which stamps belong to the model's time; by default what the settings ask for.
        names: what the node and its topics are called, for the log.

    Raises:
        SceneError, StaticsError: the scene cannot be used; its own message says why.
        SettingsError: a parameter asks for what the scene does not have.
    """

    def __init__(
        self,
        settings: Settings,
        timebase: Timebase | None = None,
        names: Names | None = None,
    ) -> None:
        self.settings = settings
        self.timebase = timebase or (Published() if settings.publishes_clock else RealTime())
        self.scene = scene_of(settings)
        self.rig: Rig = rig_of(self.scene, settings, self.timebase)
        self.model = self.rig.model
        self.rig.warm_up()
        self.started_at_scene = not settings.initial_state
        if settings.initial_state:
            attitude = restore_saved(self.rig, Path(settings.initial_state))
            if attitude is not None and settings.initial_heading == 0.0:
                self.rig.take_attitude(attitude)
        self._start = self.model.snapshot()
        # Libraries load now, not in the first cycle.
        self.rig.outputs(Stamp(0))
        self.rig.record(Stamp(0))
        self.recorder: Recorder | None = None
        self.step_times = Durations()
        self.cycle_times = Durations()
        self.cycles = 0
        self.shed = 0
        self.failure = ""
        self.last_failure = ""
        self.checkpoints = Checkpoints()
        self._next_output = 0.0
        self._log_epoch = Stamp(0)
        if settings.log_folder:
            names = names or Names()
            self.recorder = Recorder(
                Path(settings.log_folder),
                self.scene,
                node=names.node,
                topics=names.of(self.scene),
                max_bytes=settings.log_max_size * 1e6,
                max_files=settings.log_max_files,
                wait=settings.real_time_factor == 0.0,
            )

    # -- running --------------------------------------------------------------------------------

    @property
    def time(self) -> Simulated:
        """The model's time."""
        return Simulated(self.model.time)

    def start(self) -> None:
        """Begin or go on: the model's time is now."""
        self.timebase.begin(self.time)
        self._begin_file()

    def stop(self) -> None:
        """Pause; the log's file is finished."""
        if self.recorder is not None:
            self.recorder.end()

    def close(self) -> None:
        """The end: the log is finished and its thread ended."""
        if self.recorder is not None:
            self.recorder.close()
            self.recorder = None

    def _begin_file(self) -> None:
        self._next_output = self.model.time
        if self.recorder is None:
            return
        initial = self.model.time == 0.0 and self.started_at_scene
        snapshot = None if initial else self.rig.image()
        self._log_epoch = self.timebase.epoch
        self.recorder.begin(self._log_epoch, snapshot)
        self._log_outputs(self.stamp())

    def stamp(self) -> Stamp:
        """Stamp of the model's time."""
        return self.timebase.stamp(self.time)

    def cycle(
        self,
        target: Simulated,
        due: Monotonic | None = None,
        *,
        publish: Callable[[], bool] = lambda: True,
        topics: Collection[str] | None = None,
    ) -> Cycle:
        """Step to `target` with the commands in force.

        Args:
            target: simulated time to reach.
            due: when it was due, where the monotonic clock decides that.
            publish: asked after the step; False makes no outputs, to save the time.
            topics: outputs that are wanted; None: all.

        Raises:
            SessionError: the step cannot be made; the model stands as it was.
        """
        # A file has one epoch: where stamps move against the model's time a new one begins.
        moved = self.timebase.follow_clock_step()
        if moved or (self.recorder is not None and self.recorder.wants_file):
            self._begin_file()
        begin = self.time
        applied = self._step(target, self.timebase.at(target, due))
        reached = self.time
        self.timebase.reached(reached)
        stamp = self.timebase.stamp(reached)
        record, motion = self.rig.applied(applied, target - begin, stamp)
        frames = self.rig.frames() if topics is None or "/tf" in topics else []
        shed = not publish()
        outputs = [] if shed else self.rig.outputs(stamp, topics)
        if self.settings.on_failure == "retry":
            self.checkpoints.keep(self.model)
        self.cycles += 1
        self.shed += shed
        if self.recorder is not None:
            self.recorder.step(self._logged_at(reached), [record])
            if reached.seconds >= self._next_output - 1e-9:
                self._log_outputs(stamp)
        return Cycle(stamp, [record, *motion], outputs, frames, shed)

    def _logged_at(self, time: Simulated) -> Stamp:
        """Where a time is in the log's file: there it goes on where real time slipped."""
        return self._log_epoch + time.seconds

    def _log_outputs(self, stamp: Stamp) -> None:
        assert self.recorder is not None
        interval = self.scene.run.output_interval
        while self._next_output <= self.model.time + 1e-9:
            self._next_output += interval
        self.recorder.outputs(self._logged_at(self.time), self.rig.record(stamp))

    def _step(self, target: Simulated, now: Moment) -> Any:
        begin = time.perf_counter()
        try:
            applied = self.rig.advance(target, now)
        except StepError as error:
            self._fail(error)
        self.step_times.add(time.perf_counter() - begin)
        return applied

    def _fail(self, error: StepError) -> NoReturn:
        self.failure = self.last_failure = str(error)
        if self.recorder is not None:
            self.recorder.end(self.failure)
        raise SessionError(self.failure) from error

    def retry(self) -> bool:
        """After a failure: back to the last good state, if that is wanted and makes sense."""
        if self.settings.on_failure != "retry" or not self.checkpoints.restore(self.model):
            return False
        self.failure = ""
        self.start()
        return True

    # -- services -------------------------------------------------------------------------------

    def update(self, settings: Settings) -> None:
        """Take over parameters that may change at any time."""
        self.settings = settings
        self.rig.update(settings)

    def reset(self) -> None:
        """Back to the initial state, which is now."""
        self.model.restore(self._start)
        self.checkpoints.clear()
        self.rig.forget()
        self.start()

    def save(self) -> SavedState:
        """The present state, to be written."""
        return SavedState(self.rig)

    def summary(self) -> dict[str, Any]:
        """What ``~/scene`` tells: the scene in short and in full."""
        model, scene = self.model, self.scene
        return {
            "title": scene.title or "",
            **self.rig.summary(),
            "tolerance": scene.solver.tolerance,
            "elements": model.statistics["elements"],
            "top_tension": model.top_tension,
            "rate": self.settings.rate,
            "scene": scene.to_yaml(),
        }


def scene_of(settings: Settings) -> Scene | SystemScene:
    """The scene that the parameter names, or is: of one line, or a system.

    Raises:
        SceneError: there is none, or it is wrong.
    """
    text = settings.scene
    if not text.strip():
        raise SceneError.at("scene", text, "the parameter is empty", "a path, or YAML text")
    return read_scene(text)


class SavedState:
    """What ``~/save`` writes: the scene as YAML, and the state as ``.npz`` (NumPy).

    The arrays are those of `CableState`, of a system with the names of lines before them
    (``tow.position``); of a scene of one line the vessel's ``attitude`` (3, 3), its axes to the
    map's; and ``snapshot``, which `restore_saved` takes up.
    """

    def __init__(self, rig: Rig) -> None:
        model = rig.model
        self._scene = rig.scene.to_yaml()
        self._shapes = shapes_of(model)
        self._snapshot, self._hash = rig.image(), rig.scene_hash
        self._time = model.time
        self._attitude: dict[str, Any] = {}
        if rig.attitude is not None:
            self._attitude["attitude"] = rig.attitude.copy()
        self._facts = {
            "time": model.time,
            "top_tension": model.top_tension,
            "statistics": model.statistics,
        }

    def write(self, folder: Path) -> Path:
        """Write ``cable_<date>_<simulated time>.yaml`` and ``.npz``; gives the path of the state.

        Raises:
            OSError: the folder cannot be written to.
        """
        folder.mkdir(parents=True, exist_ok=True)
        day = time.strftime("%Y%m%dT%H%M%S", time.gmtime())
        path = folder / f"cable_{day}_{self._time:.3f}s.npz"
        path.with_suffix(".yaml").write_text(self._scene, encoding="utf-8")
        arrays = {
            f"{line}.{name}" if line else name: getattr(state, name)
            for line, state in self._shapes.items()
            for name, _ in variables.STATE_FIELDS
        }
        with path.open("wb") as file:
            np.savez_compressed(
                file,
                time=self._time,
                **arrays,
                **self._attitude,
                snapshot=np.frombuffer(self._snapshot, dtype=np.uint8),
                scene=np.array(self._hash),
                facts=np.array(json.dumps(self._facts)),
            )
        return path


def restore_saved(rig: Rig, path: Path) -> Floats | None:
    """Take up a saved state; gives the vessel's attitude (3, 3), where the state has one.

    Raises:
        SceneError: it cannot be read, is no saved state, or one of another scene.
    """

    def wrong(problem: str) -> SceneError:
        return SceneError.at(
            "initial_state", str(path), f"{path} {problem}", "a .npz file that ~/save wrote"
        )

    try:
        with path.open("rb") as file, np.load(file) as saved:
            # A state of before scenes were named in it is judged by its size alone.
            scene = str(saved["scene"]) if "scene" in saved else ""
            image = saved["snapshot"].tobytes()
            attitude = saved["attitude"].astype(float) if "attitude" in saved else None
    except OSError as error:
        raise wrong(f"cannot be read ({error.strerror or error})") from error
    except (AttributeError, EOFError, KeyError, TypeError, ValueError, BadZipFile) as error:
        raise wrong("is no saved state") from error
    try:
        rig.take_image(image, scene)
    except SceneError as error:
        raise wrong("belongs to another scene") from error
    return attitude
