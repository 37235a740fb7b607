"""What runs say of their own errors, for all random scenes: ``python -m ...estimate``.

Each scene is run as it is, with ``solver.error_estimate``, and at tau/16, which no estimate has
seen. At twenty instants the distance from that run is compared with what the tolerance allows, and
with what the run itself says: the first instant at which it doubts itself, by an estimate larger
than what is allowed or by having none, against the first at which it is wrong. Tensions count while
the line is taut and not shocked.
"""

from __future__ import annotations

import argparse
import json
import math
import os
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.random_scenes.chance import COUNT
from benchmarks.random_scenes.draw import Drawn, draw
from benchmarks.random_scenes.judge import FINER, RUN_LIMIT, taut_instants, tension_promise
from benchmarks.random_scenes.trace import Trace, run
from benchmarks.sections import table, write_part

PAGE = Path("docs/stress.md")
STORE = Path("docs/stress/error_estimates.json")
LIMIT = 20.0
"""CPU seconds that the run with an estimate, or the one at tau/16, may take [s]."""
WRONG = 1.0 + FINER**2
"""Of the promise, from which on a run is wrong: the one at tau/16 may err, too."""
SEEN = 0.05
"""Of the promise: errors below are too small to judge the size of an estimate by."""

KEPT, WARNED, CAUTIOUS, SILENT, UNJUDGED = OUTCOMES = (
    "right, and says so",
    "wrong, and says so before or then",
    "right, but doubts itself",
    "wrong in silence",
    "not judged",
)


@dataclass
class Row:
    """A scene. errors, estimates: at the instants, in units of what is allowed, the larger of
    position's and tension's; cost: CPU seconds with an estimate over those without."""

    seed: int
    outcome: str
    errors: list[float] = field(default_factory=list)
    estimates: list[float] = field(default_factory=list)
    cost: float = math.nan


def measured(seed: int) -> Row | None:
    """Run a scene three times; None where it does not come to its end at its own tolerance."""
    drawn = draw(seed)
    plain, _ = run(drawn, drawn.scene, drawn.tolerance, RUN_LIMIT)
    if plain.end != "completed":
        return None
    doubting = {**drawn.scene, "solver": {**drawn.scene["solver"], "error_estimate": True}}
    trace, _ = run(drawn, doubting, drawn.tolerance, RUN_LIMIT + LIMIT)
    finest, _ = run(drawn, drawn.scene, FINER**2 * drawn.tolerance, LIMIT)
    errors, estimates = _compared(drawn, trace, finest)
    complete = trace.end == finest.end == "completed"
    outcome = judged(errors, estimates, complete=complete)
    return Row(seed, outcome, errors, estimates, trace.cpu / plain.cpu)


def judged(errors: list[float], estimates: list[float], *, complete: bool) -> str:
    """What became of a scene: which came first, an error or a doubt.

    errors, estimates: in units of what is allowed; NaN: there is no estimate. complete: whether
    they reach to the end of the run.
    """
    wrong = next((k for k, error in enumerate(errors) if not error <= WRONG), None)
    doubt = next((k for k, estimate in enumerate(estimates) if not estimate <= 1.0), None)
    if wrong is not None:
        return WARNED if doubt is not None and doubt <= wrong else SILENT
    if not complete:
        return UNJUDGED
    return KEPT if doubt is None else CAUTIOUS


def _compared(drawn: Drawn, trace: Trace, finest: Trace) -> tuple[list[float], list[float]]:
    """Errors and estimates at the instants that both runs have, over what is allowed."""
    errors, estimates = [], []
    pull = tension_promise(drawn, finest)
    read = 0 if "initial" in drawn.scene else taut_instants(drawn, finest, trace)
    for k in range(min(len(trace.times), len(finest.times))):
        scale = drawn.tolerance * max(trace.lengths[k], finest.lengths[k])
        deviation = np.linalg.norm(trace.shapes[k] - finest.shapes[k], axis=1).max()
        off = [float(deviation) / scale]
        position, tension = trace.errors[k]
        said = [position / scale]
        if k < read:
            off.append(abs(trace.top[k] - finest.top[k]) / pull)
            said.append(tension / pull)
        errors.append(max(off))
        estimates.append(max(said) if not math.isnan(position) else math.nan)
    return errors, estimates


def summary(rows: list[Row]) -> str:
    """How many scenes are right and know it, by their kind; how large estimates are."""
    traits = {row.seed: draw(row.seed).traits for row in rows}
    groups = {"all": rows}
    for name in ("water", "air", "vacuum"):
        groups[name] = [r for r in rows if traits[r.seed]["medium"] == name]
    lines = []
    for name, chosen in groups.items():
        counts = [sum(row.outcome == outcome for row in chosen) for outcome in OUTCOMES]
        lines.append((name, str(len(chosen)), *(str(count or "") for count in counts)))
    pairs = np.array([pair for r in rows for pair in zip(r.errors, r.estimates, strict=True)])
    seen = np.isfinite(pairs).all(axis=1) & (pairs[:, 0] > SEEN) & (pairs[:, 0] < 1.0)
    ratios = np.percentile(pairs[seen, 1] / pairs[seen, 0], [5.0, 50.0, 95.0])
    costs = np.percentile([row.cost for row in rows], [5.0, 50.0, 95.0])
    sizes = [
        (name, *(f"{value:.2g}" for value in values))
        for name, values in (
            (f"estimate over error, of errors of {SEEN:g} to 1 promise", ratios),
            ("processor time over that of a run without an estimate", costs),
        )
    ]
    return (
        table(("scenes", "number", *OUTCOMES), lines)
        + "\n"
        + table(("ratio", "5 % are below", "median", "5 % are above"), sizes)
    )


def _load() -> None:
    """What only a process's first run would pay for."""
    run(draw(0), draw(0).scene, 1e-2, RUN_LIMIT)


def search(seeds: Iterable[int], workers: int) -> list[Row]:
    """Measure these scenes, the slowest of them at the same time."""
    rows = []
    with ProcessPoolExecutor(workers, initializer=_load) as pool:
        for seed, row in zip(seeds, pool.map(measured, seeds), strict=True):
            print(f"{seed:4d} {row.outcome if row else '-'}", flush=True)
            if row is not None:
                rows.append(row)
    return rows


def main() -> None:
    """Measure all of them; keep the rows, write their summary."""
    from benchmarks.random_scenes import overview  # which imports this module

    parser = argparse.ArgumentParser(prog="python -m benchmarks.random_scenes.estimate")
    parser.add_argument("--count", type=int, default=COUNT, help="how many seeds")
    parser.add_argument("--workers", type=int, default=os.cpu_count(), help="processes")
    parser.add_argument("--report", action="store_true", help="only write the page anew")
    chosen = parser.parse_args()
    if chosen.report:
        kept: list[dict[str, Any]] = json.loads(STORE.read_text())
        rows = [Row(**row) for row in kept]
    else:
        rows = search(range(chosen.count), chosen.workers)
        STORE.write_text(json.dumps([asdict(row) for row in rows]) + "\n")
    write_part(PAGE, "estimates", summary(rows))
    overview.write_pages()


if __name__ == "__main__":
    main()
