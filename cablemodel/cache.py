"""Where things are kept that are made once for all processes of a user."""

import atexit
import os
import shutil
import tempfile
from functools import cache
from pathlib import Path


def cache_root() -> Path:
    """Folder of all that cablemodel keeps: CABLEMODEL_CACHE_DIR, or one in ~/.cache.

    XDG_CACHE_HOME stands for ~/.cache, as everywhere. A process without a home keeps what it makes
    to itself.
    """
    chosen = os.environ.get("CABLEMODEL_CACHE_DIR")
    if chosen:
        return Path(chosen).absolute()
    home = Path(os.environ.get("XDG_CACHE_HOME") or os.path.expanduser("~/.cache"))
    return home / "cablemodel" if home.is_absolute() else _of_this_process()


@cache
def _of_this_process() -> Path:
    folder = tempfile.mkdtemp(prefix="cablemodel-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return Path(folder)
