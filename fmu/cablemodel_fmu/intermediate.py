"""The kernels of each solver as one LLVM module behind a plain C interface, free of Python.

Numba compiles every entry point of a solver (PARTS); what it adds for Python is cut off.
This runs in a process of its own, because the options that make the code portable (a generic
processor, no Intel vector library) must be set before numba is imported.

A C function takes the instance block once, where the kernel takes it as integers and as reals:
``int64_t cablemodel_step(void *block, int64_t words, double t_end, double *inputs, int64_t n)``.
"""

from __future__ import annotations

import gc
import hashlib
import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

from cablemodel.solvers.library import PREFIX

PARTS = ("finite_element", "direct")
"""Solvers, each with an LLVM module of its own: an edit of one does not compile the other anew."""

PORTABLE = {
    "NUMBA_DISABLE_INTEL_SVML": "1",
    "NUMBA_CPU_NAME": "generic",
    "NUMBA_CPU_FEATURES": "",
    "NUMBA_OPT": "0",
    "NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING": "1",
    "PYTHONHASHSEED": "0",
}
"""Environment in which numba makes code for every processor of an architecture.

Optimising is left to the build, once for all entry points together: numba would do it for each one
with all that it calls, which makes a library half as large again, and no faster. Numba colours the
words of every overload that does not fit, whether anybody reads them or not.
"""
SELDOM = (100_000, 50, 1000)
"""Thresholds of Python's garbage collector here: what is typed and lowered is hardly ever garbage,
and looking for it was a sixth of the work."""


def native_module(dispatchers: dict[str, Any]) -> tuple[str, dict[str, list[str]]]:
    """IR of entry points and of all that they call, and the arguments of each C function.

    dispatchers: name -> numba function with its `entry_signature`. Kinds of arguments: ``block``
    (pointer and words), ``array`` (pointer and length), ``float64``, ``int64``.
    """
    import llvmlite.binding as llvm

    from cablemodel.solvers.shared.compile import kernel, modules_of

    wrappers = []
    arguments = {}
    entries = []
    for name, dispatcher in dispatchers.items():
        function = kernel(dispatcher.py_func)
        function.compile(dispatcher.entry_signature)
        (compiled,) = function.overloads.values()
        arguments[name], text = _wrapper(name, compiled.fndesc.llvm_func_name, compiled.signature)
        wrappers.append(text)
        entries.append(compiled.library)
    whole = llvm.parse_assembly("\n".join(wrappers))
    seen: set[Any] = set()
    for library in entries:
        whole.link_in(library._final_module, preserve=True)
        for module in modules_of(library, seen):
            whole.link_in(module, preserve=True)
    for part in (*whole.functions, *whole.global_variables):
        if not part.is_declaration and not part.name.startswith(PREFIX):
            part.linkage = "internal"
    _drop_unused(whole)
    return str(whole), arguments


def _wrapper(name: str, native: str, signature: Any) -> tuple[list[str], str]:
    """A C function around numba's calling convention (see numba.core.callconv, CPUCallConv)."""
    from numba import types

    kinds: list[str] = []
    outer: list[str] = []
    inner = ["ptr %result", "ptr %exception"]
    for index, kind in enumerate(signature.args):
        if isinstance(kind, types.Array):
            if index == 0:
                outer += ["ptr %block", "i64 %words"]
                kinds.append("block")
            elif index > 1:
                outer += [f"ptr %a{index}", f"i64 %n{index}"]
                kinds.append("array")
            data, count = ("%block", "%words") if index < 2 else (f"%a{index}", f"%n{index}")
            # meminfo, parent, items, item size, data, shape, stride
            inner += ["ptr null", "ptr null", f"i64 {count}", "i64 8", f"ptr {data}"]
            inner += [f"i64 {count}", "i64 8"]
        elif kind in (types.float64, types.int64):
            word = "double" if kind == types.float64 else "i64"
            outer.append(f"{word} %a{index}")
            inner.append(f"{word} %a{index}")
            kinds.append(str(kind))
        else:
            raise TypeError(f"{name}: no C type for {kind}")
    if signature.return_type != types.int64:
        raise TypeError(f"{name} returns {signature.return_type}, not int64")
    declared = ", ".join(item.split(" ")[0] for item in inner)
    text = f"""
declare i32 @{_quoted(native)}({declared})
define i64 @{PREFIX}{name}({", ".join(outer)}) {{
  %result = alloca i64
  %exception = alloca ptr
  store i64 -1, ptr %result
  store ptr null, ptr %exception
  %status = call i32 @{_quoted(native)}({", ".join(inner)})
  %value = load i64, ptr %result
  ret i64 %value
}}"""
    return kinds, text


def _quoted(name: str) -> str:
    return f'"{name}"'


def _drop_unused(module: Any) -> None:
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    target = llvm.Target.from_default_triple().create_target_machine()
    builder = llvm.create_pass_builder(target, llvm.create_pipeline_tuning_options())
    passes = llvm.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    passes.add_strip_dead_prototype_pass()
    passes.run(module, builder)


def kernel_module(
    part: str, progress: Callable[[str], None] = lambda line: None
) -> tuple[Path, Path]:
    """Files with the IR of a solver's entry points and with their arguments (JSON), made when
    needed."""
    folder = _cache(part)
    assembly, arguments = folder / "kernels.ll", folder / "arguments.json"
    if not (assembly.exists() and arguments.exists()):
        progress(f"compiling the kernels of {part} with numba (about a minute)")
        folder.mkdir(parents=True, exist_ok=True)
        environment = {**os.environ, **PORTABLE, "PYTHONPATH": os.pathsep.join(sys.path)}
        command = [sys.executable, "-m", "cablemodel_fmu.intermediate", part, str(folder)]
        done = subprocess.run(command, env=environment, capture_output=True, text=True)
        if done.returncode != 0:
            raise RuntimeError(f"the kernels did not compile:\n{done.stderr}")
    return assembly, arguments


def _cache(part: str) -> Path:
    if part == "direct":
        from cablemodel.solvers.direct.kernels.compile import own_cache_folder as cache_folder
    else:
        from cablemodel.solvers.shared.compile import cache_folder

    tool = hashlib.sha256(Path(__file__).read_bytes()).hexdigest()[:16]
    return cache_folder() / f"ahead-{tool}"


def entry_points(part: str) -> dict[str, Any]:
    """A solver's entry points by their names in the library, without PREFIX."""
    if part == "direct":
        from cablemodel.solvers.direct.kernels import entry as direct_entry
        from cablemodel.solvers.direct.library import PREFIX as OF_DIRECT

        return {OF_DIRECT + name: kernel for name, kernel in direct_entry.ENTRY_POINTS.items()}
    from cablemodel.solvers.finite_element.kernels.entry import ENTRY_POINTS

    return dict(ENTRY_POINTS)


def main(part: str, folder: Path) -> None:
    """Compile here and now; run in a process with the environment PORTABLE."""
    from cablemodel.solvers.shared.compile import calls_resolved_once, indices_from_zero

    gc.set_threshold(*SELDOM)
    with calls_resolved_once(), indices_from_zero():
        assembly, arguments = native_module(entry_points(part))
    for name, text in (
        ("arguments.json", json.dumps(arguments, indent=1)),
        ("kernels.ll", assembly),
    ):
        partial = folder / f"{name}.{os.getpid()}"
        partial.write_text(text, encoding="utf-8")
        partial.replace(folder / name)


if __name__ == "__main__":
    main(sys.argv[1], Path(sys.argv[2]))
