"""The log of a node: written by a thread of its own, in files of bounded size and number.

The control loop only hands bytes over. A slow disk fills the queue: then outputs are left out
first; when even what replay needs must be left out, a new file is begun, which starts at a
snapshot of its own. Every file can be replayed by itself.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from cablemodel.errors import CableModelError
from cablemodel_ros.samples import Message

if TYPE_CHECKING:
    from cablemodel import Scene
    from cablemodel.log.writer import LogWriter

PATTERN = "cable_*.mcap"
SNAPSHOT_ATTACHMENT = "snapshot.bin"
"""State that a file begins at (`CableModel.snapshot`); missing where that is the initial one."""

_PAUSE = 0.05
"""Between two turns of the writing thread [s]; waking for every step would cost more."""
_FLUSH = 0.4
"""At most this long [s] does a message stay in this process."""


@dataclass(frozen=True)
class _Begin:
    epoch: int
    snapshot: bytes | None


@dataclass(frozen=True)
class _Data:
    stamp: int
    messages: tuple[Message, ...]


@dataclass(frozen=True)
class _End:
    reason: str


class Recorder:
    """Writes logs of a scene into a folder.

    Attributes: ``path`` (file being written, or None), ``error`` (why writing stopped, or empty),
    ``dropped`` outputs and ``gaps`` (steps left out, each of which begins a new file),
    ``wants_file`` (the file is full: call `begin` at the next step).
    """

    def __init__(
        self,
        folder: Path,
        scene: Scene,
        *,
        max_bytes: float,
        max_files: int,
        capacity: int = 20_000,
        wait: bool = False,
    ) -> None:
        import mcap.writer  # noqa: F401  its import must not hold up the first cycles

        self._folder, self._scene = folder, scene
        self._max_bytes, self._max_files = max_bytes, max_files
        self._capacity, self._wait = capacity, wait
        self._queue: deque[_Begin | _Data | _End] = deque()
        self._writer: LogWriter | None = None
        self._stop = threading.Event()
        self.path: Path | None = None
        self.error = ""
        self.dropped = 0
        self.gaps = 0
        self.files = 0
        self.written = 0
        self.wants_file = False
        self._thread = threading.Thread(target=self._work, name="cable log", daemon=True)
        self._thread.start()

    def begin(self, epoch: int, snapshot: bytes | None) -> None:
        """Begin a file: `epoch` [ns] is the stamp of t = 0, `snapshot` the state it begins at
        (None: the initial state)."""
        self.wants_file = False
        self._queue.append(_Begin(epoch, snapshot))

    def step(self, stamp: int, messages: Iterable[Message]) -> None:
        """Log what replay needs; only a full queue leaves it out, and begins a new file."""
        if self._room(1.0):
            self._queue.append(_Data(stamp, tuple(messages)))
        elif not self.error:
            self.gaps += 1
            self.wants_file = True

    def outputs(self, stamp: int, messages: Iterable[Message]) -> None:
        """Log outputs; left out when the queue is half full."""
        if self._room(0.5):
            self._queue.append(_Data(stamp, tuple(messages)))
        else:
            self.dropped += 1

    def end(self, reason: str = "") -> None:
        """Finish the file; with a reason where the run failed."""
        self._queue.append(_End(reason))

    def close(self) -> None:
        """Write all that was handed over, finish the file, end the thread."""
        self.end()
        self._stop.set()
        self._thread.join()

    def _room(self, share: float) -> bool:
        while len(self._queue) >= share * self._capacity:
            if not self._wait or self.error:
                return False
            time.sleep(_PAUSE)
        return not self.error

    def _work(self) -> None:
        flushed = time.monotonic()
        while True:
            stopping = self._stop.is_set()  # read before the queue is emptied
            while self._queue:
                item = self._queue.popleft()
                if self.error:
                    continue
                try:
                    self._take(item)
                except (OSError, CableModelError) as error:
                    self.error = str(error)
            now = time.monotonic()
            if self._writer is not None and not self.error and now - flushed >= _FLUSH:
                flushed = now
                try:
                    self._writer.flush()
                    self.written = self._writer.path.stat().st_size
                except (OSError, CableModelError) as error:
                    self.error = str(error)
                if self.written >= self._max_bytes:
                    self.wants_file = True
            if stopping:
                return
            self._stop.wait(_PAUSE)

    def _take(self, item: _Begin | _Data | _End) -> None:
        if isinstance(item, _Data):
            if self._writer is not None:
                self._writer.write(item.stamp, item.messages)
        elif isinstance(item, _Begin):
            self._finish("")
            self._open(item)
        else:
            self._finish(item.reason)

    def _finish(self, reason: str) -> None:
        writer, self._writer, self.path = self._writer, None, None
        if writer is None:
            return
        if reason:
            writer.fail(reason)
        else:
            writer.close()

    def _open(self, begin: _Begin) -> None:
        from cablemodel.log.writer import LogWriter

        self._folder.mkdir(parents=True, exist_ok=True)
        self._make_room()
        name = time.strftime("cable_%Y%m%dT%H%M%S", time.gmtime())
        path = self._folder / f"{name}_{self.files:04d}.mcap"
        while path.exists():
            self.files += 1
            path = self._folder / f"{name}_{self.files:04d}.mcap"
        self._writer = LogWriter(path, self._scene, epoch=begin.epoch)
        if begin.snapshot is not None:
            self._writer.attach(SNAPSHOT_ATTACHMENT, "application/octet-stream", begin.snapshot)
        self.files += 1
        self.written = 0
        self.path = path

    def _make_room(self) -> None:
        """Remove the oldest files, such that the folder holds one less than it may."""
        files = sorted(self._folder.glob(PATTERN), key=lambda path: (path.stat().st_mtime, path))
        for path in files[: max(0, len(files) - self._max_files + 1)]:
            with suppress(FileNotFoundError):
                path.unlink()
