"""How the direct solver's kernels are compiled: as all kernels, in a cache folder of their own."""

import hashlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba

from cablemodel.kernels.compile import INTEGERS, OPTIONS, REALS, cache_folder, inlined
from cablemodel.kernels.compile import kernel as shared_kernel

__all__ = ["INTEGERS", "REALS", "entry_point", "inlined", "kernel", "merged"]

_INNER: dict[str, Any] = {**OPTIONS, "no_cpython_wrapper": True, "no_cfunc_wrapper": True}


def kernel(function: Callable[..., Any]) -> Any:
    """An inner kernel, compiled into the entry points that call it."""
    return shared_kernel(function)


def merged(function: Callable[..., Any]) -> Any:
    """A kernel that becomes part of its caller before it is compiled.

    Every level of calls is optimised again with all that is below it. For the outer kernels, that
    are called from one place, this saves most of the time of compiling.
    """
    return numba.jit(**_INNER, inline="always")(function)


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
