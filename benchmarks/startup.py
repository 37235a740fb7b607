"""How long a user waits before the first step: import, warm start, first start ever."""

from __future__ import annotations

import json
import os
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

from benchmarks.scenes import SCENES

_IMPORT = """
import time
start = time.perf_counter()
import cablemodel
print(time.perf_counter() - start)
"""

_FIRST_STEP = """
import json, sys, time
start = time.perf_counter()
import cablemodel as cm
model = cm.CableModel(cm.load_scene(json.loads(sys.argv[1])))
model.step(1.0)
print(time.perf_counter() - start)
"""


@dataclass(frozen=True)
class StartUp:
    """Wall seconds: import alone; to the end of a first step with kernels cached; and without."""

    import_time: float
    warm_start: float
    first_start: float | None


def _seconds(program: str, argument: str | None = None, cache: Path | None = None) -> float:
    """Wall time that a fresh interpreter prints as its last line [s]."""
    command = [sys.executable, "-c", program] + ([argument] if argument is not None else [])
    environment = dict(os.environ)
    if cache is not None:
        # As on a machine that has neither the compiled library nor a cache of kernels.
        environment["CABLEMODEL_KERNELS"] = "numba"
        environment["CABLEMODEL_CACHE_DIR"] = str(cache)
    done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
    return float(done.stdout.strip().splitlines()[-1])


def measure_start_up(with_first_start: bool = True, repeats: int = 5) -> StartUp:
    """Start fresh interpreters on S4 (three-dimensional) and take the median of the repeats."""
    scene = json.dumps(SCENES["S4"].scene)
    _seconds(_FIRST_STEP, scene)
    first_start = None
    if with_first_start:
        with tempfile.TemporaryDirectory() as directory:
            first_start = _seconds(_FIRST_STEP, scene, Path(directory))
    return StartUp(
        import_time=statistics.median(_seconds(_IMPORT) for _ in range(repeats)),
        warm_start=statistics.median(_seconds(_FIRST_STEP, scene) for _ in range(repeats)),
        first_start=first_start,
    )
