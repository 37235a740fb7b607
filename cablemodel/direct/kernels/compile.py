"""How the direct solver's kernels are compiled: as all kernels, in a cache folder of their own."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba

from cablemodel.kernels.compile import INTEGERS, OPTIONS, REALS, cache_folder, inlined, kernel

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
    """A kernel that Python calls: fixed signature, cached on disk, compiled when first called."""

    def decorate(function: Callable[..., Any]) -> Any:
        config: Any = numba.config
        previous = config.CACHE_DIR
        config.CACHE_DIR = str(own_cache_folder())
        try:
            dispatcher = numba.jit(**OPTIONS, cache=True)(function)
        finally:
            config.CACHE_DIR = previous
        dispatcher.entry_signature = signature
        return dispatcher

    return decorate
