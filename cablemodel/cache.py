"""Where things are kept that are made once for all processes of a user."""

import os
from pathlib import Path


def cache_root() -> Path:
    """Folder of all that cablemodel keeps: CABLEMODEL_CACHE_DIR, or the system's own for caches."""
    chosen = os.environ.get("CABLEMODEL_CACHE_DIR")
    if chosen is not None:
        return Path(chosen)
    home = os.environ.get("XDG_CACHE_HOME", os.path.expanduser("~/.cache"))
    return Path(home) / "cablemodel"
