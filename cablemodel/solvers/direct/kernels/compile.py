"""How the direct solver's kernels are compiled: as all kernels, in a cache folder of their own."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from cablemodel.solvers.shared.compile import INTEGERS, REALS, cache_folder, inlined, kernel
from cablemodel.solvers.shared.compile import entry_point as shared_entry_point

__all__ = ["INTEGERS", "REALS", "entry_point", "inlined", "kernel"]


def own_cache_folder() -> Path:
    """Named by the shared kernels' hash and that of the sources here."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    shared = cache_folder()
    return shared.with_name(f"direct-{shared.name}-{digest.hexdigest()[:16]}")


def entry_point(signature: Any) -> Callable[[Callable[..., Any]], Any]:
    """An entry point of this solver: see shared/compile.py."""
    return shared_entry_point(signature, own_cache_folder)
