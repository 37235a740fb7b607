"""Loads that fall into their wires, by masses on springs that cannot push."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.ticker import NullFormatter

import cablemodel as cm
from tests.verification.references.snaps import OUTPUT, Hoist, snaps
from validation import draw
from validation.rows import Row, family

CASES = ((1e-3, 5.0, 0.0), (1e-4, 2.0, 0.0), (1e-3, 5.0, 0.01), (1e-4, 2.0, 0.01))
"""Tolerance, error accepted [%], bending stiffness over that of a solid bar: a rope's is 0.01."""
FIRST, COUNT = 1000, 30
"""Seeds that no rule was made from."""


def highest_and_lowest(
    hoist: Hoist, end: float, tolerance: float, bending: float = 0.0
) -> tuple[float, float]:
    """Of the tension at the tip until then [N]."""
    model = cm.CableModel(hoist.scene(tolerance, bending))
    found = []
    for n in range(1, round(end / OUTPUT) + 1):
        model.step_to(n * OUTPUT)
        found.append(model.top_tension)
    return max(found), min(found)


@family("snaps", "Loads that fall into their wires")
def first_snaps() -> tuple[list[Row], Any]:
    """Thirty hoists drawn at random, in the sea and in air: the first snap of each."""
    rows, (figure, (left, right)) = [], draw.axes(2)
    hoists = list(snaps(FIRST, COUNT))
    masses = np.array([pull for _, _, pull in hoists])
    for tolerance, accepted, bending in CASES:
        found = np.array(
            [highest_and_lowest(one, end, tolerance, bending) for one, end, _ in hoists]
        )
        off = 100.0 * np.abs(found[:, 0] / masses - 1.0)
        push = 100.0 * np.maximum(0.0, -found[:, 1]) / masses
        case = f"tau {tolerance:g}" + (f", EI {bending:g} of a bar" if bending else "")
        for metric, value in (
            ("highest, median", np.median(off)),
            ("highest, worst", off.max()),
            ("pressure, median", np.median(push)),
        ):
            rows.append(Row("snaps", case, "masses", metric, float(value), accepted, "%"))
        left.plot(masses / 1e3, found[:, 0] / masses, "o", label=case)
        right.plot(masses / 1e3, found[:, 1] / masses, "o", label=case)
    for one in (left, right):
        one.set_xscale("log")
        one.xaxis.set_minor_formatter(NullFormatter())
    draw.label(left, "highest by masses [kN]", "highest over that", "first snaps")
    draw.label(right, "highest by masses [kN]", "lowest over that", "what pushes")
    return rows, figure
