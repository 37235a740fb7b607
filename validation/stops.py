"""Winches that stop on undamped wires, by masses on springs below a sheave."""

from __future__ import annotations

from typing import Any

import numpy as np

import cablemodel as cm
from tests.verification.references.stops import BEGINS, OUTPUT, Floats, Stop, stop
from validation import draw
from validation.rows import Row, family

TOLERANCES = (1e-3, 1e-4)
FIRST, COUNT = 1000, 30
"""Seeds that no rule was made from."""
END = 10.0
"""Seconds."""


def tensions(job: Stop, tolerance: float, count: int) -> Floats:
    """At the winch, every OUTPUT from BEGINS [N]."""
    model = cm.CableModel(job.scene(tolerance))
    found = []
    for n in range(1, count + 1):
        model.step_to(BEGINS + n * OUTPUT)
        found.append(model.top_tension)
    return np.array(found)


@family("stops", "Winches that stop, on undamped wires")
def winch_stops() -> tuple[list[Row], Any]:
    """Thirty loads drawn at random: the tension at the winch for eight seconds."""
    rows, (figure, (left, right)) = [], draw.axes(2)
    jobs = [stop(seed) for seed in range(FIRST, FIRST + COUNT)]
    masses = [job.tensions(END) for job in jobs]
    promises = 10.0 * np.array([expected.max() for expected in masses])
    for tolerance in TOLERANCES:
        off = np.array(
            [
                np.abs(tensions(job, tolerance, len(expected)) - expected).max()
                for job, expected in zip(jobs, masses, strict=True)
            ]
        )
        off /= tolerance * promises
        case = f"tau {tolerance:g}"
        for metric, value in (("median", np.median(off)), ("worst", off.max())):
            rows.append(Row("stops", case, "masses", metric, float(value), 1.0, "promises"))
        right.semilogx([job.length for job in jobs], off, "o", label=case)
    times = BEGINS + OUTPUT * np.arange(1, len(masses[0]) + 1)
    shown = times < BEGINS + 2.0
    left.plot(times[shown], masses[0][shown] / 1e3, color=draw.REFERENCE, label="masses")
    found = tensions(jobs[0], TOLERANCES[-1], len(times))
    left.plot(times[shown], found[shown] / 1e3, "--", color=draw.FOUND, label="cablemodel")
    draw.label(left, "time [s]", "tension [kN]", f"{jobs[0].length:.0f} m of wire")
    draw.label(right, "length of the wire [m]", "largest deviation [promises]", "thirty loads")
    return rows, figure
