"""Build the shared libraries: ``python -m cablemodel_fmu.build [native linux64 win64 ...]``.

The kernels' LLVM module becomes object code for each platform (llvmlite), and is linked with the
FMI functions in c/ by the Zig tool chain, which cross-compiles from any machine. What is built is
what cablemodel/solvers/library.py loads and what an exported FMU holds. The outcome depends on the
sources and on the versions of the tools alone; a library that is up to date is not built again.
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
from concurrent.futures import Future, ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from cablemodel.solvers.library import ABOUT, BINARIES, kernel_hash, platform_name
from cablemodel_fmu.c_layout import header
from cablemodel_fmu.intermediate import PARTS, kernel_module
from cablemodel_fmu.machine_code import Machine, compile_kernels

SOURCES = Path(__file__).parent / "c"
VESSEL = "vessel"
"""The other library of each platform, beside its own: c/vessel, for exported systems."""
Progress = Callable[[str], None]


@dataclass(frozen=True)
class Platform:
    """One library: its folder and file, and the machines that it is for."""

    name: str
    file: str
    machines: tuple[Machine, ...]
    flags: tuple[str, ...] = ()

    @property
    def vessel_file(self) -> str:
        """Of the vessel's library."""
        return VESSEL + Path(self.file).suffix


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

    What does not wait for each other is done at the same time, on as many processors as there are.
    Raises RuntimeError with the tools' output when a step fails.
    """
    key = _key()
    platforms = [PLATFORMS[name] for name in names]
    stale = [platform for platform in platforms if not _is_up_to_date(platform, folder, key)]
    if stale:
        with tempfile.TemporaryDirectory(prefix="cablemodel-") as work:
            made, arguments = _make(stale, Path(work), progress)
        for platform in stale:
            cable, vessel = (
                thin[0] if len(thin) == 1 else universal(list(thin))
                for thin in zip(*(made[machine] for machine in platform.machines), strict=True)
            )
            _put(platform, folder, cable, vessel, {"key": key, "arguments": arguments})
    return [folder / platform.name / platform.file for platform in platforms]


def _is_up_to_date(platform: Platform, folder: Path, key: str) -> bool:
    path, about = folder / platform.name / platform.file, folder / platform.name / ABOUT
    if not (path.exists() and about.exists()):
        return False
    known = json.loads(about.read_text(encoding="utf-8"))
    vessel = folder / platform.name / platform.vessel_file
    return bool(
        known.get("key") == key
        and known.get("sha256") == _sha256(path.read_bytes())
        and vessel.exists()
    )


def _make(
    platforms: list[Platform], work: Path, progress: Progress
) -> tuple[dict[Machine, tuple[bytes, bytes]], dict[str, list[str]]]:
    """Each machine's libraries, of cable and vessel, and the arguments of each kernel."""
    objects: dict[Machine, list[Future[Path]]] = {
        machine: [] for platform in platforms for machine in platform.machines
    }
    arguments: dict[str, list[str]] = {}
    with ThreadPoolExecutor(os.cpu_count()) as pool:  # each waits for a process of its own
        try:
            modules = {pool.submit(kernel_module, part, progress): part for part in PARTS}
            ready = [pool.submit(_prepare, machine, work) for machine in objects]
            for module in as_completed(modules):
                part = modules[module]
                assembly, kinds = module.result()
                arguments |= json.loads(kinds.read_text(encoding="utf-8"))
                for machine, jobs in objects.items():
                    jobs.append(pool.submit(_objects, machine, part, assembly, work, progress))
            links = {}
            for job in ready:
                job.result()
            for platform in platforms:
                for machine in platform.machines:
                    files = [job.result() for job in objects[machine]]
                    links[machine] = pool.submit(
                        _link, platform, machine, files, sorted(arguments), work, progress
                    )
            libraries = {machine: link.result() for machine, link in links.items()}
            return libraries, dict(sorted(arguments.items()))
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise


def _put(
    platform: Platform, folder: Path, library: bytes, vessel: bytes, known: dict[str, Any]
) -> None:
    """Write libraries and what is known about them; a library is never there in part."""
    place = folder / platform.name
    place.mkdir(parents=True, exist_ok=True)
    path, about = place / platform.file, place / ABOUT
    about.unlink(missing_ok=True)
    for target, data in ((place / platform.vessel_file, vessel), (path, library)):
        partial = target.with_name(f"{target.name}.{os.getpid()}")
        partial.write_bytes(data)
        partial.chmod(0o755)
        partial.replace(target)
    known |= {"kernels": kernel_hash(), "file": platform.file, "sha256": _sha256(library)}
    about.write_text(json.dumps(known, indent=1) + "\n", encoding="utf-8")


def _key() -> str:
    """Hash of all that a library is made from: kernels, C sources, this tool, its tools."""
    digest = hashlib.sha256(kernel_hash().encode())
    for path in (*sorted(SOURCES.rglob("*.[ch]")), *sorted(Path(__file__).parent.glob("*.py"))):
        if path.suffix == ".py" and path.stem not in (
            "build",
            "intermediate",
            "machine_code",
            "c_layout",
        ):
            continue
        digest.update(path.read_bytes().replace(b"\r\n", b"\n"))
    digest.update(header(kernel_hash()).encode())
    for tool in ("numba", "llvmlite", "ziglang"):
        try:
            digest.update(metadata.version(tool).encode())
        except metadata.PackageNotFoundError:
            digest.update(b"missing")
    return digest.hexdigest()


def _sha256(library: bytes) -> str:
    return hashlib.sha256(library).hexdigest()


def _objects(machine: Machine, part: str, assembly: Path, work: Path, progress: Progress) -> Path:
    """A solver's object file for a machine."""
    progress(f"machine code of {part} for {machine.triple} (up to a minute)")
    output = work / f"{machine.triple}-{part}.o"
    compile_kernels(machine, part, assembly, output)
    return output


def _prepare(machine: Machine, work: Path) -> None:
    """Have Zig make its C library for a machine, as it does once: minutes for Windows.

    It is found in Zig's cache by the link that would have to wait for it.
    """
    empty = work / f"{machine.zig}.c"
    empty.touch()
    compile_c(machine.zig, [empty], empty.with_suffix(".library"), "-shared")


def _link(
    platform: Platform,
    machine: Machine,
    objects: list[Path],
    kernels: list[str],
    work: Path,
    progress: Progress,
) -> tuple[bytes, bytes]:
    """One machine's shared library from its objects, with these kernels, and the C sources; and the
    vessel's."""
    progress(f"linking {platform.name} for {machine.zig}")
    output = work / machine.zig / platform.file
    output.parent.mkdir()
    (output.parent / "layout.h").write_text(header(kernel_hash()), encoding="utf-8")
    names = " ".join(f"K({name})" for name in kernels)
    (output.parent / "kernels.h").write_text(f"#define KERNELS(K) {names}\n", encoding="utf-8")
    compile_c(
        machine.zig,
        [*sorted(SOURCES.glob("*.c")), *sorted(objects)],
        output,
        "-shared",
        f"-I{output.parent}",
        f"-I{SOURCES}",
        f"-I{SOURCES / 'fmi2'}",
        *platform.flags,
    )
    vessel = output.with_name(platform.vessel_file)
    own = [flag.replace(platform.file, platform.vessel_file) for flag in platform.flags]
    headers = f"-I{SOURCES / 'fmi2'}"
    compile_c(machine.zig, [SOURCES / VESSEL / "vessel.c"], vessel, "-shared", headers, *own)
    return output.read_bytes(), vessel.read_bytes()


def compile_c(zig: str, sources: Iterable[Path], output: Path, *flags: str) -> None:
    """Compile and link C with Zig's compiler for one of its targets, reproducibly; for size: the
    kernels do the work."""
    command = [sys.executable, "-m", "ziglang", "cc", "-target", zig, "-std=c11", "-Os", "-g0"]
    command += ["-s", "-fvisibility=hidden", "-ffp-contract=off", "-fno-sanitize=all"]
    command += ["-D_FORTIFY_SOURCE=0"]  # its checks are functions of macOS alone
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
