"""Build backend: setuptools, after a look at whether the wheel brings this machine's library.

Where the source tree holds no library that fits the kernels, `pip install .` builds it first, as
`make native` does, with the tools that pip fetches for it: one to three minutes. Without it the
wheel would install at once, and every first start would compile for as long, with 0.7 GB of
memory. Where the build fails, or numba is the only way, the wheel comes without a library, and
cablemodel says so at its first start. An editable install builds none: `make native` does.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from typing import Any

from setuptools import build_meta
from setuptools.build_meta import *  # noqa: F403  (the hooks that stay as they are)

from cablemodel.solvers import library

ROOT = Path(__file__).parent
_TAGS = {
    "linux64": "manylinux_2_17_x86_64",
    "aarch64-linux": "manylinux_2_17_aarch64",
    "win64": "win_amd64",
    "darwin64": "macosx_11_0_universal2",
}
"""Names of wheels that hold one platform's library, by its name (cablemodel_fmu.build)."""


def get_requires_for_build_wheel(config_settings: Any = None) -> list[str]:
    """What setuptools needs, and what builds a library where one is to be built."""
    needs: list[str] = build_meta.get_requires_for_build_wheel(config_settings)
    if _to_be_built():
        project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
        tools = project["optional-dependencies"]["fmu"]
        needs += [*project["dependencies"], *(tool for tool in tools if "ziglang" in tool)]
    return needs


def build_wheel(
    wheel_directory: str, config_settings: Any = None, metadata_directory: str | None = None
) -> str:
    """A wheel: of any platform if it holds the libraries of all, or none; else of this one."""
    if _to_be_built():
        _build()
    # Setuptools leaves copies there, and would take along those of files that are gone: a kernel
    # that is gone makes the library one of other kernels.
    shutil.rmtree(ROOT / "build" / "lib", ignore_errors=True)
    fit = [name for name in _TAGS if library.fits(name)]
    if fit and len(fit) < len(_TAGS):
        own = str(library.platform_name())
        config_settings = {**(config_settings or {}), "--build-option": f"--plat-name={_TAGS[own]}"}
    return str(build_meta.build_wheel(wheel_directory, config_settings, metadata_directory))


def _to_be_built() -> bool:
    own = library.platform_name()
    return own is not None and not library.fits(own)


def _build() -> None:
    path = [str(ROOT), str(ROOT / "fmu"), *filter(None, [os.environ.get("PYTHONPATH")])]
    done = subprocess.run(
        [sys.executable, "-m", "cablemodel_fmu.build", "native"],
        env={**os.environ, "PYTHONPATH": os.pathsep.join(path)},
    )
    if done.returncode != 0:
        print("no library could be built; numba will compile", file=sys.stderr)  # noqa: T201
