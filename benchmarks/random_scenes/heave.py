"""The top tension of every random scene in heave, against short steps: ``python -m ...heave``.

The search compares a run with one at a quarter of its tolerance, and both may share an error: time
steps that the positions allow are far too long for the tension of a stiff line, which is solved
for instead (``kernels/time/tension.py``). Here each scene that starts at rest is run again at
tau/4 with 1/256 of the error that a time step may have, in steps that resolve what the line does
along itself, and the top tensions of both are compared until the line is slack, or rings along
itself after a jump of the winch's rate (``draw.shock_time``), which long steps damp.
"""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from benchmarks.random_scenes.chance import COUNT
from benchmarks.random_scenes.draw import Drawn, draw
from benchmarks.random_scenes.judge import FINER, taut_instants, tension_promise
from benchmarks.random_scenes.trace import run
from benchmarks.sections import table, write_part

PAGE = Path("docs/stress.md")
STORE = Path("docs/stress/heave.json")
SHORT = 1.0 / 256.0
"""Of the error of a time step, in the reference."""
LIMIT = 25.0
"""CPU seconds of the reference [s]."""
FEWEST = 4
"""Instants that must be left to compare."""


@dataclass
class Row:
    """A scene: its errors of the top tension in units of the promise, 10 tau of the largest.

    floor: none, flat or sloped; touches: whether cable came to lie on it. when: of the largest [s].
    """

    seed: int
    floor: str
    touches: bool
    tolerance: float
    largest: float
    rms: float
    when: float


def measured(drawn: Drawn) -> Row | None:
    """Run the scene twice; None where there is too little to compare."""
    tau = drawn.tolerance
    trace, model = run(drawn, drawn.scene, tau, LIMIT)
    if trace.end != "completed" or model is None:
        return None
    fine, _ = run(drawn, drawn.scene, FINER * tau, LIMIT, time_error=SHORT)
    count = min(len(trace.times), taut_instants(drawn, fine))
    off = np.abs(np.subtract(trace.top[:count], fine.top[:count]))
    errors = off / tension_promise(drawn, fine)
    if count < FEWEST:
        return None
    worst = int(np.argmax(errors))
    touches = drawn.traits["floor"] != "none" and max(trace.on_floor[:count]) > 0.0
    rms = math.sqrt(float(np.mean(np.square(errors))))
    return Row(
        drawn.seed, str(drawn.traits["floor"]), touches, tau, float(errors[worst]), rms,
        float(trace.times[worst]),
    )  # fmt: skip


def summary(rows: list[Row]) -> str:
    """How many keep the promise, by what they touch."""
    groups = {
        "all": rows,
        "no floor": [r for r in rows if r.floor == "none"],
        "above a floor": [r for r in rows if r.floor != "none" and not r.touches],
        "on a floor": [r for r in rows if r.touches],
    }
    lines = []
    for name, chosen in groups.items():
        if not chosen:
            continue
        largest = [r.largest for r in chosen]
        kept = sum(value <= 1.0 for value in largest)
        middle, late, worst = np.percentile(largest, [50.0, 90.0, 100.0])
        lines.append(
            (name, str(len(chosen)), str(kept), f"{middle:.2f}", f"{late:.2f}", f"{worst:.2g}")
        )
    head = ("scenes", "number", "within the promise", "median error", "90 %", "largest")
    return table(head, lines)


def main() -> None:
    """Measure all of them; keep the rows, write their summary."""
    rows = []
    for seed in range(COUNT):
        drawn = draw(seed)
        if drawn.traits["manoeuvre"] != "heave" or "initial" in drawn.scene:
            continue
        row = measured(drawn)
        if row is not None:
            rows.append(row)
            print(
                f"{seed:4d} {row.largest:8.2f} {row.rms:8.2f} at t = {row.when:.3g} s", flush=True
            )
    STORE.write_text(json.dumps([asdict(row) for row in rows], indent=1) + "\n")
    write_part(PAGE, "heave", summary(rows))


if __name__ == "__main__":
    main()
