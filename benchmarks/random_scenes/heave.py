"""The top tension of every random scene in heave, against short steps: ``python -m ...heave``.

The search compares a run with one at a quarter of its tolerance, and both may share an error: time
steps that the positions allow are far too long for the tension of a stiff line, which is read off
its motion instead (``kernels/tension.py``). Here each scene that starts at rest is run again at
tau/4 with 1/256 of the error that a time step may have, in steps that resolve what the line does
along itself, and the top tensions of both are compared until the line is slack, or rings along
itself after a jump of the winch's rate (``draw.shock_time``), which long steps damp.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from benchmarks.random_scenes.chance import COUNT
from benchmarks.random_scenes.draw import Drawn, draw
from benchmarks.random_scenes.judge import FINER, taut_instants, tension_promise
from benchmarks.random_scenes.trace import run
from benchmarks.report import table
from benchmarks.sections import write_section

PAGE = Path("docs/stress.md")
SHORT = 1.0 / 256.0
"""Of the error of a time step, in the reference."""
LIMIT = 25.0
"""CPU seconds of the reference [s]."""
FEWEST = 4
"""Instants that must be left to compare."""


@dataclass
class Row:
    """A scene: its errors of the top tension in units of the promise, 10 tau of the largest."""

    drawn: Drawn
    touches: bool
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
    return Row(drawn, touches, float(errors[worst]), rms, trace.times[worst])


def section(rows: list[Row]) -> str:
    """How many keep the promise, by what they touch; those that do not."""
    groups = {
        "all": rows,
        "no floor": [r for r in rows if r.drawn.traits["floor"] == "none"],
        "above a floor": [r for r in rows if r.drawn.traits["floor"] != "none" and not r.touches],
        "on a floor": [r for r in rows if r.touches],
    }
    lines = []
    for name, chosen in groups.items():
        if not chosen:
            continue
        largest = [r.largest for r in chosen]
        kept = sum(value <= 1.0 for value in largest)
        middle, late = np.percentile(largest, [50.0, 90.0])
        lines.append((name, str(len(chosen)), str(kept), f"{middle:.2f}", f"{late:.2f}"))
    bad = sorted((r for r in rows if r.largest > 1.0), key=lambda r: r.largest, reverse=True)
    worst = [
        (
            str(r.drawn.seed),
            "on a floor" if r.touches else str(r.drawn.traits["floor"]),
            f"{r.drawn.tolerance:.1e}",
            f"{r.largest:.1f}",
            f"{r.rms:.2f}",
            f"{r.when:.3g}",
        )
        for r in bad
    ]
    text = " ".join((__doc__ or "").split("\n\n", 1)[1].replace("``", "`").split())
    return (
        f"Written by `python -m benchmarks.random_scenes.heave`. {text} Errors in units of the "
        "promise, 10 tau of the largest tension, at 21 instants of each scene. What strikes a "
        "floor rings, and the reference with it: there part of the difference is the "
        "reference's.\n\n"
        + table(
            ("scenes", "number", "within the promise", "median of the largest error", "90 %"), lines
        )
        + "\nNot within it:\n\n"
        + table(("seed", "floor", "tau", "largest error", "rms", "largest at t [s]"), worst)
    )


def main() -> None:
    """Measure all of them; write the section of the page."""
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
    write_section(PAGE, "Stress", "Tension in heave", section(rows))


if __name__ == "__main__":
    main()
