"""Waves and currents of a deck, which stand in files beside it.

Their formats are those of MoorDyn's reader (2.7: ``Waves.cpp``, ``Waves/WaveSpectrum.cpp``): a
steady profile of the current, and a sea as components that are summed (WaveKin 7). Its grids of
water that was computed before are no sea, and none of a scene's.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from cablemodel.errors import shown
from cablemodel.moordyn_deck.deck import Deck, Row

PROFILE, SPECTRUM = "current_profile.txt", "wave_frequencies.txt"
_STEADY = ("1", "3")
_SUMMED = "7"
_NOTHING = ("", "0")
_FAINT = 1e-9
"""Of the largest component: amplitudes that a transform leaves where there is no wave."""


def water(deck: Deck, folder: Path | None) -> dict[str, Any]:
    """``current`` and ``waves`` of a scene's environment, where the deck asks for them.

    folder: that of the deck; None: of a deck that is no file.
    """
    found: dict[str, Any] = {}
    for row in deck.rows.get("options", []):
        if len(row.entries) < 2:
            continue
        value, name = row.entries[0].strip('"'), row.entries[1]
        if value in _NOTHING:
            continue
        if name.lower() == "currents":
            if value not in _STEADY:
                problem = f"{shown(value)} asks for a current that is no steady profile"
                deck.refuse(row, name, problem, f"0, or 1 or 3 with {PROFILE} beside the deck")
            elif rows := _rows(deck, row, folder, PROFILE, 2):
                found["current"] = _current(rows)
        if name.lower() == "wavekin":
            if value != _SUMMED:
                problem = f"{shown(value)} asks for waves that are no sum of components"
                deck.refuse(row, name, problem, f"0, or 7 with {SPECTRUM} beside the deck")
            elif rows := _rows(deck, row, folder, SPECTRUM, 3):
                found |= _waves(deck, row, rows)
    return found


def _rows(
    deck: Deck, option: Row, folder: Path | None, name: str, columns: int
) -> list[list[float]]:
    """Rows of at least so many numbers of a file; its heading is left out."""
    place = f"{option.entries[1]}, {name}"
    try:
        text = (Path() if folder is None else folder).joinpath(name).read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        deck.refuse(option, place, "there is no such file beside the deck", name)
        return []
    found: list[list[float]] = []
    for number, line in enumerate(text.splitlines(), 1):
        try:
            entries = [float(entry) for entry in line.split()]
        except ValueError:
            entries = []
        if len(entries) >= columns and all(map(math.isfinite, entries)):
            found.append(entries)
        elif found and line.strip():
            allowed = f"{columns} numbers or more"
            deck.refuse(option, place, f"line {number}, {shown(line.strip())}, is no row", allowed)
            return []
    if not found:
        deck.refuse(option, place, "it has no rows", f"rows of {columns} numbers or more")
    return found


def _current(rows: list[list[float]]) -> dict[str, Any]:
    """Rows z, ux, uy, uz [m], [m/s]; what is left out is 0."""
    table = []
    for z, *velocity in sorted(rows):
        table.append({"z": z, "velocity": [*velocity, 0.0, 0.0][:3]})
    return {"table": table}


def _waves(deck: Deck, option: Row, rows: list[list[float]]) -> dict[str, Any]:
    """Rows w [rad/s], real and imaginary part of an amplitude [m], and the direction [rad].

    MoorDyn's surface is |A| sin(w t - k s + arg A).
    """
    waves = [row for row in rows if row[0] > 0.0]
    largest = max((math.hypot(row[1], row[2]) for row in waves), default=0.0)
    waves = [row for row in waves if math.hypot(row[1], row[2]) > _FAINT * largest]
    if not waves:
        deck.refuse(option, f"{option.entries[1]}, {SPECTRUM}", "it has no waves", "0 WaveKin")
        return {}
    directions = {row[3] if len(row) > 3 else 0.0 for row in waves}
    if len(directions) > 1:
        problem = f"{len(directions)} directions of waves: a scene's have one"
        deck.refuse(option, f"{option.entries[1]}, {SPECTRUM}", problem, "one direction")
        return {}
    deck.left.append("waves at full height from the start: a scene's come up (waves.ramp)")
    components = [
        {
            "amplitude": math.hypot(real, imaginary),
            "period": 2.0 * math.pi / w,
            "phase": 0.5 * math.pi - math.atan2(imaginary, real),
        }
        for w, real, imaginary, *_direction in waves
    ]
    return {"waves": {"components": {"rows": components, "direction": directions.pop()}}}
