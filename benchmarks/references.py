"""Reference solutions: where they come from, and how far they can be trusted.

Two sets per scene, kept in ``references.json``:

``prototype``: values of independent prototypes with other unknowns and other schemes than any
contestant, drag without the factor sqrt(e) of the paper's eq. 22. Peers leave that factor out
too, so they are compared with these.
``fine``: our own solution with a tolerance far below any contestant's and twice the elements,
drag with the factor. Its distance from a coarser fine solution is stored as its uncertainty, and
its distance from ``prototype`` must be the effect of the factor alone.
"""

from __future__ import annotations

import json
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

PATH = Path(__file__).with_name("references.json")


@dataclass(frozen=True)
class Reference:
    """Free end and top tension at some instants.

    times: (n,) [s]; tip: (n, 3) relative to the vessel [m]; tension: (n,) at the top [N], or
    None where only positions are known; a row or number that is not known is not a number.
    tip_uncertainty [m] and tension_uncertainty [N]: digits
    that can be trusted. made: how it was computed.
    """

    times: tuple[float, ...]
    tip: tuple[tuple[float, float, float], ...]
    tension: tuple[float, ...] | None
    tip_uncertainty: float
    tension_uncertainty: float
    made: str

    def tip_array(self) -> NDArray[np.float64]:
        """Positions as an array (n, 3) [m]."""
        return np.array(self.tip, dtype=np.float64)


def _from_json(data: dict[str, Any]) -> Reference:
    tension = data["tension"]
    nowhere = (math.nan, math.nan, math.nan)
    return Reference(
        times=tuple(data["times"]),
        tip=tuple(nowhere if row is None else (row[0], row[1], row[2]) for row in data["tip"]),
        tension=None if tension is None else tuple(tension),
        tip_uncertainty=data["tip_uncertainty"],
        tension_uncertainty=data["tension_uncertainty"],
        made=data["made"],
    )


def _to_json(reference: Reference) -> dict[str, Any]:
    data = asdict(reference)
    data["tip"] = [None if math.isnan(row[0]) else row for row in reference.tip]
    return data


def load(path: Path = PATH) -> dict[str, dict[str, Reference]]:
    """All references: scene name -> set name (``prototype``, ``fine``) -> reference."""
    stored = json.loads(path.read_text())
    return {
        scene: {name: _from_json(data) for name, data in sets.items()}
        for scene, sets in stored.items()
    }


def save(references: dict[str, dict[str, Reference]], path: Path = PATH) -> None:
    """Write all references, one scene after the other."""
    stored = {
        scene: {name: _to_json(reference) for name, reference in sets.items()}
        for scene, sets in references.items()
    }
    path.write_text(json.dumps(stored, indent=1) + "\n")


def choose(scene: str, prefer: str, path: Path = PATH) -> Reference:
    """The preferred set of a scene, or the other one where that does not exist.

    Raises KeyError when the scene has no reference at all.
    """
    sets = load(path)[scene]
    return sets[prefer] if prefer in sets else next(iter(sets.values()))
