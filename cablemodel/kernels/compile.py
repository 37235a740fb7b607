"""How kernels are compiled: one place for the options that let them run without Python.

Kernels obey the rules of docs/architecture.md: scalars and preallocated arrays only, no allocation,
no exceptions, an int status where something can fail. `fastmath` stays off, so that the
just-in-time and the ahead-of-time build give the same bits.
"""

import hashlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numba
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import make_array, populate_array

OPTIONS: dict[str, Any] = {
    "nopython": True,
    "nogil": True,
    "error_model": "numpy",
    "fastmath": False,
    "boundscheck": False,
    "_nrt": False,
}

# Entry points take the instance block twice, as 64-bit integers and as doubles.
INTEGERS = types.Array(types.int64, 1, "C")
REALS = types.Array(types.float64, 1, "C")


def source_hash() -> str:
    """Hash of every kernel source and of the compiler's version: the key of the kernel cache."""
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted(Path(__file__).parent.glob("*.py")):
        digest.update(path.name.encode())
        digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


def cache_folder() -> Path:
    """Folder of compiled kernels; numba itself does not notice edits in imported modules."""
    root = os.environ.get("CABLEMODEL_CACHE_DIR")
    if root is None:
        root = os.path.join(
            os.environ.get("XDG_CACHE_HOME", os.path.expanduser("~/.cache")), "cablemodel"
        )
    return Path(root) / source_hash()


def kernel(function: Callable[..., Any]) -> Any:
    """An inner kernel, compiled into the entry points that call it."""
    return numba.jit(**OPTIONS)(function)


def inlined(function: Callable[..., Any]) -> Any:
    """A small kernel that is always inlined by the compiler."""
    return numba.jit(**OPTIONS, forceinline=True)(function)


def entry_point(signature: Any) -> Callable[[Callable[..., Any]], Any]:
    """A kernel that Python, the FMU and the node call: fixed signature, cached on disk.

    The signature is kept on the dispatcher and compiled when first called (or loaded from the
    cache), so that importing this package compiles nothing.
    """

    def decorate(function: Callable[..., Any]) -> Any:
        config: Any = numba.config
        previous = config.CACHE_DIR
        config.CACHE_DIR = str(cache_folder())
        try:
            dispatcher = numba.jit(**OPTIONS, cache=True)(function)
        finally:
            config.CACHE_DIR = previous
        dispatcher.entry_signature = signature
        return dispatcher

    return decorate


@intrinsic
def view(typing_context: Any, array: Any, start: Any, count: Any) -> Any:
    """``array[start : start + count]`` without the checks of a Python slice: 0 <= start.

    A slice clips its ends and, like every index that the compiler cannot prove to be positive,
    counts from the end when negative: a dozen instructions that keep loops from being vectorised.
    """
    signature = array(array, types.int64, types.int64)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        kind = signature.args[0]
        whole = make_array(kind)(context, builder, values[0])
        part = make_array(kind)(context, builder)
        word = context.get_constant(types.intp, 8)
        populate_array(
            part,
            data=builder.gep(whole.data, [values[1]]),
            shape=cgutils.pack_array(builder, [values[2]]),
            strides=cgutils.pack_array(builder, [word]),
            itemsize=word,
            meminfo=None,
        )
        return part._getvalue()

    return signature, generate


@intrinsic
def copy_words(typing_context: Any, array: Any, to: Any, start: Any, count: Any) -> Any:
    """``array[to : to + count] = array[start : start + count]``, two places that do not meet."""
    signature = types.void(array, types.int64, types.int64, types.int64)

    def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        data = make_array(signature.args[0])(context, builder, values[0]).data
        to, start, count = values[1:]
        cgutils.raw_memcpy(builder, builder.gep(data, [to]), builder.gep(data, [start]), count, 8)
        return context.get_dummy_value()

    return signature, generate
