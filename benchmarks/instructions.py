"""Guard against slower steps: instructions of four scenes, counted by valgrind.

Times depend on the machine and on what else runs there; the instructions that the compiled library
executes for given steps do not, so that a tenth more of them is a finding. Each scene's block is
made here and stepped by a small C program under callgrind, which counts inside ``step`` only.

``python -m benchmarks.instructions`` compares with ``benchmarks/instructions.json`` and fails where
a scene takes more than 10 % more; ``--store`` replaces what is stored. The counts change with the
numba release that compiles the library and with the C library's sines and powers, too: both are
stored with them and shown where they differ.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import re
import shutil
import subprocess
import tempfile
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

STORE = Path(__file__).with_suffix(".json")
DRIVER = Path(__file__).with_name("count_steps.c")
MOST = 1.10
"""Instructions over those stored, at most [-]."""


def _towed() -> tuple[Any, list[float]]:
    """S1 to 200 s in as long steps as the tolerance allows: the one-step scheme in a plane."""
    from benchmarks.kernels import towed

    return towed(model="hybrid"), [200.0]


def _turned() -> tuple[Any, list[float]]:
    """S4 at 100 Hz for five seconds: the two-step scheme in space."""
    from benchmarks.scenes import SCENES

    return SCENES["S4"].scene, [0.01 * k for k in range(1, 501)]


def _laid() -> tuple[Any, list[float]]:
    """S3 to 60 s: a body, pay-out, the floor and the mesh that follows the touchdown."""
    from benchmarks.stress_scenes import pay_out_scene

    return pay_out_scene(), [0.5 * k for k in range(1, 121)]


def _in_waves() -> tuple[Any, list[float]]:
    """The first ten seconds of a jumper in an irregular sea, at 10 Hz: its components' sums."""
    return "scenes/jumper_in_waves.yaml", [0.1 * k for k in range(1, 101)]


COUNTED: dict[str, Callable[[], tuple[Any, list[float]]]] = {
    "tow, adaptive": _towed,
    "turn, 100 Hz": _turned,
    "pay-out to the floor": _laid,
    "irregular sea, 10 Hz": _in_waves,
}


def compiler() -> str:
    """The C compiler: $CC, or cc.

    Raises:
        SystemExit: there is none.
    """
    found = shutil.which(os.environ.get("CC", "cc"))
    if found is None:
        raise SystemExit("counting instructions needs a C compiler: install one, or set CC")
    return found


def count(scene: Any, times: list[float], folder: Path) -> int:
    """Instructions of the steps to these times [s].

    Raises:
        SystemExit: no valgrind, or no compiled library of the present kernels.
        RuntimeError: a step failed, or callgrind said nothing.
    """
    import cablemodel as cm
    from cablemodel.solvers import library

    valgrind = shutil.which("valgrind")
    if valgrind is None:
        raise SystemExit("counting instructions needs valgrind (Debian: apt-get install valgrind)")
    path = library.library_path()
    if path is None:
        raise SystemExit("the library does not belong to these kernels: run `make native` first")
    model = cm.CableModel(scene if isinstance(scene, cm.Scene) else cm.load_scene(scene))
    np.asarray(model._solver.memory.ints).tofile(folder / "block")
    driver = folder / "count_steps"
    if not driver.exists():
        subprocess.run([compiler(), "-O1", "-o", driver, DRIVER, "-ldl"], check=True)
    command = [valgrind, "--tool=callgrind", "--toggle-collect=counted_step"]
    command += [f"--callgrind-out-file={folder}/out", str(driver), str(path), f"{folder}/block"]
    done = subprocess.run(
        command + [repr(t) for t in times], capture_output=True, text=True, check=False
    )
    found = re.search(r"Collected : (\d+)", done.stderr)
    if done.returncode != 0 or found is None:
        raise RuntimeError(f"stepping under valgrind failed: {done.stdout} {done.stderr[-2000:]}")
    return int(found[1])


def toolchain() -> dict[str, str]:
    """What the counts depend on besides the kernels."""
    return {
        "machine": platform.machine(),
        "numba": version("numba"),
        "libc": "-".join(platform.libc_ver()),
    }


def count_all() -> dict[str, int]:
    """Instructions of every scene."""
    with tempfile.TemporaryDirectory() as folder:
        return {name: count(*make(), Path(folder)) for name, make in COUNTED.items()}


def exceeded(counts: dict[str, int], stored: dict[str, int]) -> list[str]:
    """Names of the scenes that take too many instructions, or that nothing is stored of."""
    return [name for name, found in counts.items() if not found <= MOST * stored.get(name, 0)]


def main() -> None:
    """Compare with what is stored, or store."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.instructions", description=__doc__)
    parser.add_argument("--store", action="store_true", help="replace what is stored")
    chosen = parser.parse_args()
    counts = count_all()
    if chosen.store:
        kept = {"toolchain": toolchain(), "instructions": counts}
        STORE.write_text(json.dumps(kept, indent=1) + "\n")
    kept = json.loads(STORE.read_text())
    stored = kept["instructions"]
    for name, found in counts.items():
        ratio = found / stored.get(name, float("nan"))
        print(f"{name:24s} {found:12,d} instructions, {ratio:.3f} of those stored")
    if kept["toolchain"] != toolchain():
        print(f"stored with {kept['toolchain']}, counted with {toolchain()}")
    failed = exceeded(counts, stored)
    if failed:
        raise SystemExit(f"more than {100 * MOST - 100:.0f} % more: {', '.join(failed)}")


if __name__ == "__main__":
    main()
