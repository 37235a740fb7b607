"""What a sweep of many short runs costs beside them: ``python -m benchmarks.sweeps``.

A cable is towed for ten seconds at many diameters. Wall clock times, the start of dask and of its
workers included; *beside* is what the workers spend on a run that the run itself does not take.
"""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np

import cablemodel as cm
from benchmarks.sections import write_rows

SCENE = Path("scenes/towed_cable.yaml")
STORED = Path("docs/benchmarks/sweeps.csv")
CASES = ((1_000, 1), (1_000, 2), (10_000, 2))
"""Runs and workers."""
UNTIL = 10.0


def measure(runs: int, workers: int) -> list[str]:
    """A row of the table."""
    diameters = np.linspace(0.01, 0.03, runs).tolist()
    begin = time.perf_counter()
    table = cm.sweep(SCENE, {"cable_types.K.diameter": diameters}, until=UNTIL, workers=workers)
    wall = time.perf_counter() - begin
    assert len(table) == runs
    assert (table["error"] == "").all()
    own = 1e3 * float(table["wall_time"].mean())
    each = 1e3 * wall * workers / runs
    return [
        str(runs),
        str(workers),
        f"{wall:.1f}",
        f"{each:.2f}",
        f"{own:.2f}",
        f"{each - own:.2f}",
    ]


def main() -> None:
    """Measure, and write the table."""
    rows = []
    for runs, workers in CASES:
        rows.append(measure(runs, workers))
        print(*rows[-1])
    header = ["runs", "workers", "wall [s]", "a run and worker [ms]", "run [ms]", "beside [ms]"]
    write_rows(STORED, header, rows)


if __name__ == "__main__":
    main()
