"""Build the shared libraries: ``python -m cablemodel_fmu.build [native linux64 win64 ...]``.

The kernels' LLVM module becomes object code for each platform (llvmlite), and is linked with the
FMI functions in c/ by the Zig tool chain, which cross-compiles from any machine. What is built is
what cablemodel/library.py loads and what an exported FMU holds. The outcome depends on the sources
and on the versions of the tools alone; a library that is up to date is not built again.
"""

from __future__ import annotations

import hashlib
import json
import os
import struct
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from cablemodel.library import BINARIES, PREFIX, kernel_hash, platform_name
from cablemodel_fmu.c_layout import header
from cablemodel_fmu.intermediate import PARTS, kernel_module

SOURCES = Path(__file__).parent / "c"
Progress = Callable[[str], None]


@dataclass(frozen=True)
class Machine:
    """A processor and operating system: LLVM's and Zig's words for it."""

    triple: str
    cpu: str
    zig: str


@dataclass(frozen=True)
class Platform:
    """One library: its folder and file, and the machines that it is for."""

    name: str
    file: str
    machines: tuple[Machine, ...]
    flags: tuple[str, ...] = ()


PLATFORMS = {
    platform.name: platform
    for platform in (
        Platform(
            "linux64",
            "cablemodel.so",
            # glibc 2.17: everything since 2012
            (Machine("x86_64-unknown-linux-gnu", "x86-64", "x86_64-linux-gnu.2.17"),),
            ("-Wl,--build-id=none", "-lm"),
        ),
        Platform(
            "win64",
            "cablemodel.dll",
            (Machine("x86_64-pc-windows-gnu", "x86-64", "x86_64-windows-gnu"),),
        ),
        Platform(
            "darwin64",
            "cablemodel.dylib",
            (
                Machine("x86_64-apple-macosx11.0.0", "x86-64", "x86_64-macos.11.0"),
                Machine("arm64-apple-macosx11.0.0", "apple-m1", "aarch64-macos.11.0"),
            ),
            ("-Wl,-install_name,@rpath/cablemodel.dylib",),
        ),
        Platform(
            "aarch64-linux",
            "cablemodel.so",
            (Machine("aarch64-unknown-linux-gnu", "generic", "aarch64-linux-gnu.2.17"),),
            ("-Wl,--build-id=none", "-lm"),
        ),
    )
}


def build(
    names: Iterable[str] = tuple(PLATFORMS),
    *,
    folder: Path = BINARIES,
    progress: Progress = lambda line: None,
) -> list[Path]:
    """Build the libraries of these platforms, where they are not up to date. Returns their paths.

    Raises RuntimeError with the tools' output when a step fails.
    """
    paths = []
    key = _key()
    for name in names:
        platform = PLATFORMS[name]
        place = folder / name
        path, about = place / platform.file, place / "library.json"
        paths.append(path)
        if path.exists() and about.exists():
            known = json.loads(about.read_text(encoding="utf-8"))
            if known.get("key") == key and known.get("sha256") == _sha256(path):
                continue
        modules = [kernel_module(part, progress) for part in PARTS]
        arguments: dict[str, list[str]] = {}
        for _, kinds in modules:
            arguments |= json.loads(kinds.read_text(encoding="utf-8"))
        place.mkdir(parents=True, exist_ok=True)
        about.unlink(missing_ok=True)
        with tempfile.TemporaryDirectory(prefix="cablemodel-") as work:
            parts = [
                _link(
                    platform,
                    machine,
                    [
                        _objects(machine, part, assembly, progress)
                        for part, (assembly, _) in zip(PARTS, modules, strict=True)
                    ],
                    Path(work),
                    progress,
                )
                for machine in platform.machines
            ]
            partial = place / f"{platform.file}.{os.getpid()}"
            partial.write_bytes(parts[0] if len(parts) == 1 else universal(parts))
            partial.chmod(0o755)
            partial.replace(path)
        known = {
            "kernels": kernel_hash(),
            "key": key,
            "file": platform.file,
            "sha256": _sha256(path),
            "arguments": arguments,
        }
        about.write_text(json.dumps(known, indent=1) + "\n", encoding="utf-8")
    return paths


def _key() -> str:
    """Hash of all that a library is made from: kernels, C sources, this tool, its tools."""
    digest = hashlib.sha256(kernel_hash().encode())
    for path in (*sorted(SOURCES.rglob("*.[ch]")), *sorted(Path(__file__).parent.glob("*.py"))):
        if path.suffix == ".py" and path.stem not in ("build", "intermediate", "c_layout"):
            continue
        digest.update(path.read_bytes().replace(b"\r\n", b"\n"))
    digest.update(header(kernel_hash()).encode())
    for tool in ("numba", "llvmlite", "ziglang"):
        try:
            digest.update(metadata.version(tool).encode())
        except metadata.PackageNotFoundError:
            digest.update(b"missing")
    return digest.hexdigest()


def _sha256(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()


RARE_KERNELS = (
    "consistency", "floor_memory", "follow", "passing", "payout", "promote", "refine", "rigid",
    "sleep", "statics", "tension", "top_of_line", "vessel_clamp",
)  # fmt: skip
"""Modules of kernels that are little of the work: built for size."""
RARE_ENTRIES = ("bodies", "energy", "equilibrium", "sample")
"""The same for entry points."""


def _is_rare(name: str) -> bool:
    """Whether a function of a module is built for size; its name is as numba mangles it."""
    if name.startswith(PREFIX):
        return name.removeprefix(PREFIX) in RARE_ENTRIES
    return any(f"7kernels{len(kernels)}{kernels}" in name for kernels in RARE_KERNELS)


def _objects(machine: Machine, part: str, assembly: Path, progress: Progress) -> bytes:
    """A module's object code for a machine."""
    import llvmlite.binding as llvm

    progress(f"kernels for {machine.triple}")
    llvm.initialize_all_targets()
    llvm.initialize_all_asmprinters()
    module = llvm.parse_assembly(assembly.read_text(encoding="utf-8"))
    target = llvm.Target.from_triple(machine.triple).create_target_machine(
        cpu=machine.cpu, opt=3, reloc="pic", codemodel="default"
    )
    module.triple = machine.triple
    module.data_layout = str(target.target_data)
    if "windows" in machine.triple:
        for function in module.functions:
            if function.name.startswith(PREFIX):
                function.storage_class = "dllexport"
    for function in module.functions:
        if not function.is_declaration and _is_rare(function.name):
            function.add_function_attribute("optsize")
    # Level 2 is as fast as 3 here and a quarter smaller; code for AVX2 gains 5 % only.
    options = llvm.create_pipeline_tuning_options(speed_level=2)
    options.loop_vectorization = options.slp_vectorization = True
    # Unrolling is a fifth of the size and of the speed. An FMU for all desktops must not exceed a
    # megabyte: the direct solver, and the Intel half of the Mac's library, go without.
    intel_mac = machine.triple.startswith("x86_64-apple")
    options.loop_unrolling = part == "finite_element" and not intel_mac
    builder: Any = llvm.create_pass_builder(target, options)
    builder.getModulePassManager().run(module, builder)
    code: bytes = target.emit_object(module)
    return code


def _link(
    platform: Platform, machine: Machine, objects: list[bytes], work: Path, progress: Progress
) -> bytes:
    """One machine's shared library from its objects and the C sources."""
    slow = " (the first time takes minutes)" if "windows" in machine.zig else ""
    progress(f"linking {platform.name} for {machine.zig}{slow}")
    kernels = [work / f"{machine.zig}-{n}.o" for n in range(len(objects))]
    for path, code in zip(kernels, objects, strict=True):
        path.write_bytes(code)
    (work / "layout.h").write_text(header(kernel_hash()), encoding="utf-8")
    output = work / machine.zig / platform.file
    output.parent.mkdir()
    compile_c(
        machine.zig,
        [*sorted(SOURCES.glob("*.c")), *kernels],
        output,
        "-shared",
        f"-I{work}",
        f"-I{SOURCES}",
        f"-I{SOURCES / 'fmi2'}",
        *platform.flags,
    )
    return output.read_bytes()


def compile_c(zig: str, sources: Iterable[Path], output: Path, *flags: str) -> None:
    """Compile and link C with Zig's compiler for one of its targets, reproducibly."""
    command = [sys.executable, "-m", "ziglang", "cc", "-target", zig, "-std=c11", "-O2", "-g0"]
    command += ["-s", "-fvisibility=hidden", "-ffp-contract=off", "-fno-sanitize=all"]
    command += ["-Wall", "-Wextra", "-Werror", "-o", str(output)]
    command += [str(source) for source in sources]
    done = subprocess.run([*command, *flags], capture_output=True, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"{' '.join(command)} failed:\n{done.stderr}")


_CPU_TYPES = {0x01000007: "x86_64", 0x0100000C: "arm64"}


def universal(parts: list[bytes]) -> bytes:
    """A universal Mach-O file of several thin ones (see mach-o/fat.h): big-endian table, pages."""
    alignment = 14  # 16 kB pages, as arm64 wants them
    table = struct.pack(">II", 0xCAFEBABE, len(parts))
    offset = 1 << alignment
    places = []
    for part in parts:
        cpu, kind = struct.unpack("<II", part[4:12])
        if cpu not in _CPU_TYPES:
            raise RuntimeError(f"not a Mach-O file for a known processor: {cpu:#x}")
        table += struct.pack(">IIIII", cpu, kind, offset, len(part), alignment)
        places.append(offset)
        offset += -(-len(part) // (1 << alignment)) * (1 << alignment)
    whole = bytearray(places[-1] + len(parts[-1]))
    whole[: len(table)] = table
    for place, part in zip(places, parts, strict=True):
        whole[place : place + len(part)] = part
    return bytes(whole)


def main(names: list[str]) -> None:
    def progress(line: str) -> None:
        print(f"cablemodel: {line}", file=sys.stderr, flush=True)  # noqa: T201

    own = platform_name()
    if names == ["native"]:
        if own is None:
            progress("there is no library for this machine: numba compiles the kernels")
            return
        names = [own]
    unknown = sorted(set(names) - set(PLATFORMS))
    if unknown:
        sys.exit(f"unknown: {', '.join(unknown)}; there are {', '.join(PLATFORMS)}")
    build(names or tuple(PLATFORMS), progress=progress)


if __name__ == "__main__":
    main(sys.argv[1:])
