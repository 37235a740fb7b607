"""The kernels' entry points: from the compiled library where it fits, else by numba.

`cablemodel/binaries` may hold a shared library that was made ahead of time from the same kernels
(`python -m cablemodel_fmu.build`); it is the one inside an exported FMU. When its hash is that of
the kernel sources next to it, it is loaded and nothing is compiled. Otherwise, as after an edit of
a kernel, numba compiles, which is told (`compiling_told`). Both give the same bits.

Every entry point of kernels/entry.py is a function of this module with the same arguments:
``library.step(ints, reals, t_end, inputs)``. The library holds those of direct/kernels/entry.py
too, with the prefix ``direct_``: see direct/library.py. Set CABLEMODEL_KERNELS=numba to leave the
library aside.
"""

from __future__ import annotations

import hashlib
import json
import logging
import os
import platform
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache
from pathlib import Path
from typing import Any

PREFIX = "cablemodel_"
BINARIES = Path(__file__).parents[1] / "binaries"
KERNELS = ("shared", "finite_element/kernels", "direct/kernels")
"""Folders of kernels, beside this module."""
ABOUT = "library.json"
"""Beside each library: what `description` returns."""

Kernel = Callable[..., int]


@cache
def kernel_hash() -> str:
    """Hash of the kernel sources: a library with another hash does not belong to them."""
    here = Path(__file__).parent
    digest = hashlib.sha256()
    for folder in KERNELS:
        for path in sorted((here / folder).rglob("*.py")):
            digest.update(path.relative_to(here).as_posix().encode())
            digest.update(path.read_bytes().replace(b"\r\n", b"\n"))
    return digest.hexdigest()


def platform_name() -> str | None:
    """Folder of this machine's library, in the words of FMI; None where there is none."""
    machine = platform.machine().lower()
    if sys.platform == "darwin":
        return "darwin64"
    if machine in ("x86_64", "amd64"):
        return {"linux": "linux64", "win32": "win64"}.get(sys.platform)
    if machine in ("aarch64", "arm64") and sys.platform == "linux":
        return "aarch64-linux"
    return None


def description(name: str) -> dict[str, Any] | None:
    """What is known of a platform's library: kernels (hash), file, arguments; None if not built."""
    try:
        text = (BINARIES / name / ABOUT).read_text(encoding="utf-8")
    except OSError:
        return None
    found: dict[str, Any] = json.loads(text)
    return found


def fits(name: str) -> bool:
    """Whether a platform's library is there and belongs to the kernels next to it."""
    found = description(name)
    if found is None or found["kernels"] != kernel_hash():
        return False
    return (BINARIES / name / str(found["file"])).exists()


@cache
def library_path() -> Path | None:
    """The library that will be used here; None: numba compiles the kernels."""
    name = platform_name()
    if name is None or os.environ.get("CABLEMODEL_KERNELS") == "numba" or not fits(name):
        return None
    found = description(name)
    assert found is not None
    return BINARIES / name / str(found["file"])


@cache
def entry_points() -> dict[str, Kernel]:
    """All entry points by name."""
    path = library_path()
    if path is not None:
        name = platform_name()
        assert name is not None
        found = description(name)
        assert found is not None
        return load(path, found["arguments"])
    from cablemodel.solvers.finite_element.kernels.entry import ENTRY_POINTS

    return telling(ENTRY_POINTS)


COMPILING = (
    "No compiled library for this machine is installed: the solver is compiled now, once, which "
    "takes one to two minutes and 0.7 GB of memory. A wheel brings the library, and so does "
    "`pip install .`, or `make native`, in the sources."
)
LONG = 3.0
"""Seconds after which a kernel is said to be compiling; one that is cached is there by then."""

_compiled = [0.0]


def time_compiling() -> float:
    """Time that numba has taken to compile kernels in this process so far [s]."""
    return _compiled[0]


_tell: ContextVar[Callable[[str], None]] = ContextVar(
    "tell", default=logging.getLogger("cablemodel").warning
)


@contextmanager
def compiling_told(tell: Callable[[str], None]) -> Iterator[None]:
    """Within the block, `tell` is called with COMPILING when kernels are compiled; elsewhere the
    logger ``cablemodel`` gets it as a warning."""
    before = _tell.set(tell)
    try:
        yield
    finally:
        _tell.reset(before)


def telling(kernels: dict[str, Any]) -> dict[str, Kernel]:
    """Kernels of numba, the first of which to compile for long says so."""
    told = threading.Event()

    def wrapped(compiling: Callable[[Any], Any]) -> Callable[[Any], Any]:
        def compile_and_tell(signature: Any) -> Any:
            tell = _tell.get()

            def say() -> None:
                if not told.is_set():
                    told.set()
                    tell(COMPILING)

            timer = threading.Timer(LONG, say)
            timer.daemon = True
            timer.start()
            began = time.monotonic()
            try:
                return compiling(signature)
            finally:
                timer.cancel()
                _compiled[0] += time.monotonic() - began

        return compile_and_tell

    for kernel in kernels.values():
        kernel.compile = wrapped(kernel.compile)
    return dict(kernels)


def load(path: Path, arguments: dict[str, list[str]]) -> dict[str, Kernel]:
    """Entry points of a library; arguments: kinds of arguments of each, as its JSON file says."""
    import ctypes

    library = ctypes.CDLL(str(path))
    types: dict[str, list[Any]] = {
        "block": [ctypes.c_void_p, ctypes.c_int64],
        "array": [ctypes.c_void_p, ctypes.c_int64],
        "float64": [ctypes.c_double],
        "int64": [ctypes.c_int64],
    }
    kernels = {}
    # They are not exported: each library in a process has its own.
    address_of = library.cablemodel_kernel
    address_of.restype, address_of.argtypes = ctypes.c_void_p, [ctypes.c_char_p]
    for name, kinds in arguments.items():
        address = address_of(name.encode())
        if address is None:
            raise OSError(f"{path} has no kernel {name!r}")
        kinds_in_c = [kind for word in kinds for kind in types[word]]
        function = ctypes.CFUNCTYPE(ctypes.c_int64, *kinds_in_c)(address)
        kernels[name] = _kernel(function, tuple(kinds))
    return kernels


def _kernel(function: Any, kinds: tuple[str, ...]) -> Kernel:
    """A C function with the arguments of the Python kernel: ints, reals (one block), and more.

    Arrays must be contiguous and of 64-bit words, as for numba; they are not checked here.
    """
    from ctypes import c_int64, c_void_p

    # Looking up an array's address costs as much as a short kernel: those of the last call are
    # kept, one tuple a place, so that threads at worst look up again.
    last: list[tuple[Any, Any, Any]] = [(None, None, None)] * len(kinds)

    def look_up(place: int, value: Any) -> tuple[Any, Any, Any]:
        found = (value, c_void_p(value.ctypes.data), c_int64(value.size))
        last[place] = found
        return found

    # A loop over the arguments costs as much as the call itself: the wrapper is written for them.
    names = [f"x{place}" for place in range(len(kinds))]
    lines = [f"def call({', '.join([names[0], 'reals', *names[1:]])}):"]
    flat = []
    for place, (name, kind) in enumerate(zip(names, kinds, strict=True)):
        if kind in ("block", "array"):
            lines.append(f"    known{place} = last[{place}]")
            lines.append(f"    if known{place}[0] is not {name}:")
            lines.append(f"        known{place} = look_up({place}, {name})")
            flat += [f"known{place}[1]", f"known{place}[2]"]
        else:
            flat.append(name)
    lines.append(f"    return function({', '.join(flat)})")
    space: dict[str, Any] = {"function": function, "last": last, "look_up": look_up}
    exec("\n".join(lines), space)
    written: Kernel = space["call"]
    return written


def __getattr__(name: str) -> Any:
    """An entry point, loaded or compiled when first asked for."""
    if name.startswith("_"):
        raise AttributeError(name)
    found = entry_points().get(name)
    if found is None:
        raise AttributeError(f"the kernels have no entry point {name!r}")
    globals()[name] = found
    return found
