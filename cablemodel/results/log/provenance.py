"""Where a run comes from: versions, revision, machine. Written into every log."""

from __future__ import annotations

import hashlib
import platform
import subprocess
import sys
from functools import cache
from importlib import import_module, metadata
from pathlib import Path

_PACKAGES = ("numpy", "numba", "scipy", "llvmlite")

_ENGINE = ("scene", "solvers", "systems", "model.py")
"""Parts of the package that can change a result; all others look at results."""


def provenance() -> dict[str, str]:
    """Versions of everything that can change a result, git revision when known, and the machine.

    ``cpu_target`` is what the compiler compiles for: two machines with the same one compute the
    same bits.
    """
    import cablemodel

    found = {
        "cablemodel": cablemodel.__version__,
        "engine": engine_hash(),
        "python": platform.python_version(),
        "platform": platform.platform(),
        "machine": platform.machine(),
        "cpu": _cpu(),
        "cpu_target": _cpu_target(),
        "libc": " ".join(platform.libc_ver()).strip(),
        "git": _git_revision(),
    }
    for package in _PACKAGES:
        try:
            found[package] = metadata.version(package)
        except metadata.PackageNotFoundError:
            continue
    return {key: value for key, value in found.items() if value}


@cache
def engine_hash() -> str:
    """Hash of all sources that can change a result: engine and scenes. Two logs with the same one
    were made by the same engine, whatever else changed between their commits."""
    root = Path(__file__).resolve().parents[2]
    digest = hashlib.sha256()
    for part in _ENGINE:
        place = root / part
        for path in sorted(place.rglob("*.py")) if place.is_dir() else [place]:
            digest.update(path.relative_to(root).as_posix().encode())
            digest.update(path.read_bytes().replace(b"\r\n", b"\n"))
    return digest.hexdigest()[:16]


@cache
def _cpu() -> str:
    """Name of the processor, as the system tells it."""
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass  # not Linux
    return platform.processor()


def _cpu_target() -> str:
    """Processor that the kernels are compiled for: that of the library made ahead of time where it
    is used, else this one; empty while no compiler is loaded."""
    from cablemodel.solvers import library

    if library.library_path() is not None:
        return f"{library.platform_name()} library"
    if "llvmlite" not in sys.modules:
        return ""
    return str(import_module("llvmlite.binding").get_host_cpu_name())


@cache
def _git_revision() -> str:
    """Commit of the working tree that this package is in; empty when it is installed elsewhere."""
    root = Path(__file__).resolve().parents[3]
    if not (root / ".git").exists():  # not a checkout, or inside another project's
        return ""
    try:
        answer = subprocess.run(
            ["git", "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*"],
            cwd=root,
            capture_output=True,
            text=True,
            timeout=5,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return ""
    return answer.stdout.strip()
