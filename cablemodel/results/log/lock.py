"""Open the file of a log for one writer alone.

Two that wrote the same file would destroy it. The lock is the system's own (``flock``): it ends
with the process, however that ends, and readers need not know of it. Where the platform or the
file system has none, none is held.
"""

from __future__ import annotations

import os
import stat
from contextlib import suppress
from pathlib import Path
from typing import IO

from cablemodel.errors import LogInUseError

try:
    import fcntl
except ImportError:  # Windows
    fcntl = None  # type: ignore[assignment]


def open_alone(path: Path) -> IO[bytes]:
    """A file to write from its beginning, which nobody else writes through this function.

    Raises:
        LogInUseError: somebody does; the file is as it was.
        OSError: it cannot be written.
    """
    # Emptied when it is known to be nobody else's, not by opening it.
    file = open(path, "wb", opener=_without_emptying)  # noqa: SIM115 - the caller closes it
    try:
        if stat.S_ISREG(os.fstat(file.fileno()).st_mode):  # a device has no end to cut off
            _lock(file, path)
            file.truncate(0)
    except BaseException:
        file.close()
        raise
    return file


def close(file: IO[bytes]) -> None:
    """Close it; a process that was forked while it was open does not keep the lock."""
    try:
        file.flush()
    finally:
        if fcntl is not None:
            with suppress(OSError):
                fcntl.flock(file, fcntl.LOCK_UN)
        file.close()


def _without_emptying(name: str, flags: int) -> int:
    return os.open(name, flags & ~os.O_TRUNC, 0o666)


def _lock(file: IO[bytes], path: Path) -> None:
    if fcntl is None:
        return
    try:
        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        problem = "another run writes this log; let it end, or close its Recorder"
        raise LogInUseError(f"cannot write the log {path}: {problem}") from None
    except OSError:
        pass  # a file system without locks
