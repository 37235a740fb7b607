"""The log of a node: written by a thread of its own, in files of bounded size and number.

The control loop only hands bytes over. A slow disk fills the queue: then outputs are left out
first; when even what replay needs must be left out, a new file is begun, which starts at a
snapshot of its own. Every file can be replayed by itself. A file that cannot be written is given up
and another one tried, until one can.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cablemodel.errors import CableModelError
from cablemodel_ros.log_folder import LogFolder
from cablemodel_ros.samples import Message
from cablemodel_ros.times import Stamp

if TYPE_CHECKING:
    from cablemodel import Scene, SystemScene
    from cablemodel.results.log.writer import LogWriter

_PAUSE = 0.05
"""Between two turns of the writing thread [s]; waking for every step would cost more."""
_FLUSH = 0.4
"""At most this long [s] does a message stay in this process."""
RETRY = 2.0
"""How long after a failure another file is tried [s]; twice as long after every further one."""
_LONGEST_RETRY = 60.0


@dataclass(frozen=True)
class _Begin:
    epoch: Stamp
    snapshot: bytes | None


@dataclass(frozen=True)
class _Data:
    stamp: Stamp
    messages: tuple[Message, ...]


@dataclass(frozen=True)
class _End:
    reason: str


class Recorder:
    """Writes logs of a scene into a folder.

    Args:
        folder: where the files are.
        scene: of the run.
        node: full name of the node.
        topics: names of topics that are not those of the table (the node's namespace, remapping).
        max_bytes: size at which another file is begun.
        max_files: most files of this node's that stay.
        capacity: most messages that wait to be written.
        wait: wait for the disk instead of leaving anything out.

    Attributes: ``path`` (file being written, or None), ``error`` (why nothing is written now, or
    empty), ``failures`` and ``recoveries`` (how often writing began to fail, and went on again),
    ``dropped`` outputs and ``gaps`` (steps left out, each of which begins a new file),
    ``wants_file`` (call `begin` at the next step).
    """

    def __init__(
        self,
        folder: Path,
        scene: Scene | SystemScene,
        *,
        node: str = "/cable",
        topics: Mapping[str, str] | None = None,
        max_bytes: float,
        max_files: int,
        capacity: int = 20_000,
        wait: bool = False,
    ) -> None:
        import mcap.writer  # noqa: F401  its import must not hold up the first cycles

        self._folder = LogFolder(folder, node, max_files)
        self._scene, self._topics = scene, topics
        self._max_bytes = max_bytes
        self._capacity, self._wait = capacity, wait
        self._queue: deque[_Begin | _Data | _End] = deque()
        self._writer: LogWriter | None = None
        self._stop = threading.Event()
        self.path: Path | None = None
        self.error = ""
        self._begun = self._taken = 0
        self.failures = self.recoveries = 0
        self._patience, self._retry_at = RETRY, 0.0
        self._flushed = False
        self.dropped = 0
        self.gaps = 0
        self.files = 0
        self.written = 0
        self.wants_file = False
        self._thread = threading.Thread(target=self._work, name="cable log", daemon=True)
        self._thread.start()

    def begin(self, epoch: Stamp, snapshot: bytes | None) -> None:
        """Begin a file: `epoch` is the stamp of t = 0, `snapshot` the state it begins at
        (None: the initial state)."""
        self.wants_file = False
        self._begun += 1
        self._queue.append(_Begin(epoch, snapshot))

    def step(self, stamp: Stamp, messages: Iterable[Message]) -> None:
        """Log what replay needs; only a full queue leaves it out, and begins a new file."""
        if self._room(1.0):
            self._queue.append(_Data(stamp, tuple(messages)))
        elif self._listens:
            self.gaps += 1
            self.wants_file = True

    def outputs(self, stamp: Stamp, messages: Iterable[Message]) -> None:
        """Log outputs; left out when the queue is half full."""
        if self._room(0.5):
            self._queue.append(_Data(stamp, tuple(messages)))
        elif self._listens:
            self.dropped += 1

    def end(self, reason: str = "") -> None:
        """Finish the file; with a reason where the run failed."""
        self._queue.append(_End(reason))

    def close(self) -> None:
        """Write all that was handed over, finish the file, end the thread."""
        self.end()
        self._stop.set()
        self._thread.join()

    @property
    def _listens(self) -> bool:
        """Whether anything is written now, or a file waits that may be: its first steps are some
        turns of the thread before it is opened."""
        return not self.error or self._begun > self._taken

    def _room(self, share: float) -> bool:
        while len(self._queue) >= share * self._capacity:
            if not self._wait or not self._listens:
                return False
            time.sleep(_PAUSE)
        return self._listens

    @property
    def problem(self) -> str:
        """What does not keep it from writing; empty if there is nothing."""
        return self._folder.problem

    def _work(self) -> None:
        flushed = time.monotonic()
        while True:
            stopping = self._stop.is_set()  # read before the queue is emptied
            now = time.monotonic()
            # A queue that is filled as fast as it is emptied must not keep it from the disk.
            while self._queue and (stopping or now - flushed < _FLUSH):
                self._guarded(self._take, self._queue.popleft())
                now = time.monotonic()
            if now - flushed >= _FLUSH:
                flushed = now
                if self._writer is not None:
                    self._guarded(self._flush)
            if self.error and now >= self._retry_at:
                self._retry_at = now + self._patience
                self.wants_file = True
            if stopping:
                return
            if not self._queue:
                self._stop.wait(_PAUSE)

    def _guarded(self, call: Callable[..., None], *arguments: Any) -> None:
        """What the disk refuses ends the file, not this thread."""
        try:
            call(*arguments)
        except (OSError, CableModelError) as error:
            if not self.error:
                self.failures += 1
            self.error = str(error)
            self._patience = min(2.0 * self._patience, _LONGEST_RETRY)
            self._retry_at = time.monotonic() + 0.5 * self._patience
            with suppress(OSError, CableModelError):
                self._abandon(self.error)

    def _take(self, item: _Begin | _Data | _End) -> None:
        if isinstance(item, _Begin):
            try:
                self._finish("")
                self._open(item)
                self.recoveries += bool(self.error)
                self.error = ""
            finally:
                self._taken += 1
        elif isinstance(item, _End):
            self._finish(item.reason)
        elif self._writer is not None:
            self._writer.write(item.stamp.ns, item.messages)

    def _flush(self) -> None:
        assert self._writer is not None
        path = self._writer.path
        if path.stat().st_size < self.written:
            raise OSError(f"{path} is shorter than what was written to it")
        self._writer.flush()
        self.written = path.stat().st_size
        if not self._flushed:
            # Only now is the new file worth an old one.
            self._flushed = True
            self._patience = RETRY
            self._folder.make_room()
        if self.written >= self._max_bytes:
            self.wants_file = True

    def _finish(self, reason: str) -> None:
        if self._writer is None:
            return
        path = self._writer.path
        if reason:
            self._writer.fail(reason)
        else:
            self._writer.close()
        self._writer = self.path = None
        self._folder.finished(path)
        if not self._flushed:
            self._folder.make_room()

    def _abandon(self, reason: str) -> None:
        """Close what can no longer be written; what nothing reached is removed."""
        writer, self._writer, self.path = self._writer, None, None
        if writer is None:
            return
        with suppress(OSError, CableModelError):
            writer.fail(reason)
        if not self._flushed:
            self._folder.forget(writer.path)

    def _open(self, begin: _Begin) -> None:
        from cablemodel.results.log.writer import SNAPSHOT_ATTACHMENT, LogWriter

        path = self._folder.new()
        self._flushed = False
        self._writer = LogWriter(path, self._scene, epoch=begin.epoch.ns, topics=self._topics)
        self._folder.opened(path)
        if begin.snapshot is not None:
            self._writer.attach(SNAPSHOT_ATTACHMENT, "application/octet-stream", begin.snapshot)
        self.files += 1
        self.written = 0
        self.path = path
