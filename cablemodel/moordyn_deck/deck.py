"""Rows of a deck by section, and what a line, a point and the water in it are.

The format is that of MoorDyn's documentation, "The V2 Input File", and of its reader (2.7,
``MoorDyn2.cpp``): sections begin with a line of dashes and a key phrase; tables have two lines of
heading; options are a value and a key.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from cablemodel.errors import SceneProblem, shown

_SECTIONS: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("options", ("OPTIONS",)),
    ("outputs", ("OUTPUT",)),
    ("SYROPE IC", ("SYROPE IC",)),
    ("FAILURE", ("FAILURE",)),
    ("CONTROL", ("CONTROL",)),
    ("EXTERNAL LOADS", ("EXTERNAL LOADS",)),
    ("line types", ("LINE DICTIONARY", "LINE TYPES")),
    ("rod types", ("ROD DICTIONARY", "ROD TYPES")),
    ("bodies", ("BODIES", "BODY LIST", "BODY PROPERTIES")),
    ("rods", ("RODS", "ROD LIST", "ROD PROPERTIES")),
    ("points", ("POINTS", "POINT LIST", "POINT PROPERTIES", "CONNECTION PROPERTIES",
                "NODE PROPERTIES")),
    ("lines", ("LINES", "LINE LIST", "LINE PROPERTIES")),
)  # fmt: skip
"""Sections, by the phrases that MoorDyn finds them by; in capitals: those that are refused."""
KINDS = {
    "fixed": ("ANCHOR", "FIXED", "FIX"),
    "coupled": ("FAIRLEAD", "VESSEL", "VES", "COUPLED", "CPLD"),
    "free": ("POINT", "CONNECT", "CON", "FREE"),
}
LINE_TYPE = (
    "TypeName",
    "Diam",
    "Mass/m",
    "EA",
    "BA/-zeta",
    "EI",
    "Cd",
    "Ca",
    "CdAx",
    "CaAx",
    "Cl",
)
POINT = ("ID", "Attachment", "X", "Y", "Z", "Mass", "Volume", "CdA", "Ca")
FORCED = (*POINT[:7], "FX", "FY", "FZ", *POINT[7:])
"""Columns of points with steady forces."""
LINE = ("ID", "LineType", "AttachA", "AttachB", "UnstrLen", "NumSegs")
_GRAVITY, _DENSITY = 9.80665, 1025.0
"""What MoorDyn takes where the deck says nothing [m/s2], [kg/m3]."""
_MEANT = {"gravity": "g", "wtrdnsty": "rho", "kb": "kbot", "cb": "cbot", "mc": "statdynfricscale"}
"""Options by their other names."""
_FILES = {"waterkin": "waves or a current", "seafloorfile": "a table of depths"}
"""Options that name files with loads, or a floor, and what they give."""
_WATER = ("wavekin", "currents")
"""Options that water.py reads."""
_FLOOR = {"kbot": "kBot", "cbot": "cBot", "statdynfricscale": "StatDynFricScale"}
_NUMERICS = re.compile(
    "dtm|dt|cfl|tscheme|dtic|icdt|tmaxic|ictmax|cdscaleic|icdfac|threshic|icthresh|gendynamicic|"
    "icgendynamic|fileic|icfile|dtwave|unifycurrentgrid|wavekin_rampt|writelog|writeunits|dtout|"
    "disableoutput|disableouttime|fricdamp|cv|inertialf|inertialf_rampt|outswitch"
)


@dataclass(frozen=True)
class Row:
    """A line of the deck."""

    number: int
    entries: tuple[str, ...]


@dataclass
class Deck:
    """Rows by section, and what is found wrong."""

    rows: dict[str, list[Row]] = field(default_factory=dict)
    problems: list[SceneProblem] = field(default_factory=list)
    left: list[str] = field(default_factory=list)

    @property
    def has_solids(self) -> bool:
        """Whether there are bodies or rods."""
        return bool(self.rows.get("bodies") or self.rows.get("rods"))

    def refuse(self, row: Row | None, what: str, problem: str, allowed: str = "") -> None:
        """Note once what is wrong, and where."""
        place = f"line {row.number}, {what}" if row else what
        found = SceneProblem(place, None, problem, allowed)
        if found not in self.problems:
            self.problems.append(found)

    def is_new(self, section: str, row: Row) -> bool:
        """Whether no row of its section before it has its ID, which may stand in a name."""
        rows = self.rows[section.lower()]
        first = next(other for other in rows if other.entries[0] == row.entries[0])
        if first is not row:
            self.refuse(row, "ID", f"{shown(row.entries[0])} is that of line {first.number}, too")
        if not re.fullmatch(r"\w+", row.entries[0], flags=re.ASCII):
            self.refuse(row, "ID", f"{shown(row.entries[0])} is no number", "a whole number")
        return first is row

    def number(self, row: Row, columns: tuple[str, ...], name: str) -> float:
        """A finite number in a column; what is none is noted, and counts as 0."""
        text = row.entries[columns.index(name)]
        try:
            value = float(text)
        except ValueError:
            value = math.nan
        if not math.isfinite(value):
            self.refuse(row, name, f"{shown(text)} is not a number", "a number")
            return 0.0
        return value

    def numbers(
        self, row: Row, columns: tuple[str, ...], name: str, sizes: tuple[int, ...]
    ) -> list[float]:
        """Numbers with bars between them, as many as one of sizes; one each is 0 where wrong."""
        parts = row.entries[columns.index(name)].split("|")
        if len(parts) not in sizes:
            allowed = f"{' or '.join(map(str, sizes))}, with | between them"
            self.refuse(row, name, f"{len(parts)} numbers", allowed)
            return [0.0] * sizes[0]
        return [self.number(Row(row.number, (part,)), (name,), name) for part in parts]


def sections(text: str) -> Deck:
    """A deck's rows; sections that a scene has not, or that are missing, are noted."""
    deck, name, heading = Deck(), "", 0
    for number, whole in enumerate(text.splitlines(), 1):
        if "---" in whole:
            phrase = whole.upper()
            known = (key for key, phrases in _SECTIONS if any(p in phrase for p in phrases))
            name = next(known, "")
            heading = 0 if name in ("options", "outputs") else 2
            continue
        if heading:
            heading -= 1
            continue
        entries = tuple(re.split(r"[!#%]", whole)[0].split())
        if name and entries:
            deck.rows.setdefault(name, []).append(Row(number, entries))
    _refuse_sections(deck)
    return deck


def _refuse_sections(deck: Deck) -> None:
    """Sections of what a scene has not."""
    for name, rows in deck.rows.items():
        if name.isupper():
            deck.refuse(rows[0], name, f"{len(rows)} of these: a scene has none", "no such section")
    for name in ("line types", "points", "lines"):
        if not deck.rows.get(name):
            deck.refuse(None, f"section {name.upper()}", "is missing, or has no rows")


def environment(deck: Deck) -> dict[str, float]:
    """Gravity [m/s2], density [kg/m3], depth [m] and friction of the floor."""
    found = {"g": _GRAVITY, "rho": _DENSITY, "wtrdpth": 0.0, "frictioncoefficient": 0.0}
    numerics, floor = [], []
    for row in deck.rows.get("options", []):
        if len(row.entries) < 2:
            deck.refuse(
                row, "OPTIONS", f"{shown(row.entries[0])} has no name", "a value and a name"
            )
            continue
        value, name = row.entries[0], row.entries[1]
        key = _MEANT.get(name.lower(), name.lower())
        if key in found or key in ("mu_kt", "mu_ka"):
            found[key] = deck.number(row, (name,), name)
        elif key in _WATER:
            continue
        elif key in _FILES:
            if value.strip('"') not in ("", "0"):
                problem = f"{shown(value)} asks for {_FILES[key]}, which is not in the deck itself"
                deck.refuse(row, name, problem, "0; see cablemodel keys environment")
        elif key in _FLOOR:
            floor.append(_FLOOR[key])
        elif _NUMERICS.fullmatch(key):
            numerics.append(name)
        else:
            deck.left.append(f"option {name} ({value}), which is not known")
    across, along = found.pop("mu_kt", 0.0), found.pop("mu_ka", 0.0)
    if across != along:
        deck.refuse(None, "MU_KT, MU_KA", f"{across:g} and {along:g} differ", "one friction")
    found["frictioncoefficient"] = found["frictioncoefficient"] or across
    if floor:
        deck.left.append(f"{', '.join(floor)}: the floor is rigid, its friction that of Coulomb")
    if numerics:
        deck.left.append(f"numerics and output of MoorDyn: {', '.join(numerics)}")
    return found


def wide(deck: Deck, row: Row, columns: tuple[str, ...], section: str) -> bool:
    """Whether a row has all columns that it needs."""
    if len(row.entries) >= len(columns):
        return True
    problem = f"{len(row.entries)} entries; {len(columns)} are needed: {', '.join(columns)}"
    deck.refuse(row, section, problem, "a deck of MoorDyn v2")
    return False


def line_type(deck: Deck, line: Row) -> dict[str, Any]:
    name = line.entries[1]
    found = [row for row in deck.rows.get("line types", []) if row.entries[0] == name]
    if len(found) != 1:
        names = ", ".join(row.entries[0] for row in deck.rows.get("line types", []))
        deck.refuse(line, "LineType", f"there is no single type {shown(name)}", names)
        return {}
    row = found[0]
    if not wide(deck, row, LINE_TYPE[:-1], "LINE TYPES"):
        return {}
    for column, what in (("EA", "viscoelastic or tabulated"), ("EI", "tabulated")):
        text = row.entries[LINE_TYPE.index(column)]
        if re.search(r"[|:]|[^\d.eE+-]", text):
            deck.refuse(row, column, f"{shown(text)} is {what}", "one number")
            return {}

    def value(column: str) -> float:
        return deck.number(row, LINE_TYPE, column)

    kind = {
        "diameter": value("Diam"), "mass": value("Mass/m"),
        "axial_stiffness": value("EA"), "bending_stiffness": value("EI"),
        "drag_normal": value("Cd"), "drag_tangential": value("CdAx"), "added_mass": value("Ca"),
    }  # fmt: skip
    for column in ("Diam", "Mass/m", "EA"):
        if value(column) <= 0.0:
            deck.refuse(row, column, f"{value(column):g} is not above 0", "a number above 0")
    if len(row.entries) > len(LINE_TYPE) - 1 and value("Cl") != 0.0:
        deck.refuse(row, "Cl", "vortices that shake a line are not computed", "0")
    damping = value("BA/-zeta")
    if damping > 0.0:
        kind["axial_damping"] = damping
    elif damping < 0.0:
        deck.left.append(
            f"BA/-zeta ({row.entries[4]}): damping of MoorDyn's segments, by their size"
        )
    if value("CaAx") != 0.0:
        deck.left.append(f"CaAx ({row.entries[9]}): no added mass along a cable")
    return {"name": name, **kind}


def point(deck: Deck, line: Row, column: str) -> dict[str, Any]:
    """An end of a line: what `read_point` finds; empty where something is wrong, which is noted."""
    name = line.entries[LINE.index(column)]
    found = [row for row in deck.rows.get("points", []) if row.entries[0] == name]
    if len(found) != 1:
        is_rod = re.fullmatch(r"[rR](OD|od)?\d+[aAbB]", name)
        problem = "is the end of a rod" if is_rod else "is no single point"
        deck.refuse(line, column, f"{shown(name)} {problem}", "the ID of a point")
        return {}
    return read_point(deck, found[0])


def read_point(deck: Deck, row: Row, on_bodies: bool = False) -> dict[str, Any]:
    """What a point is, where, and what hangs on it (SI units).

    ``kind`` is fixed, coupled, free, or the name of a body where those are asked for: then the
    place is in its axes. Empty where something is wrong, which is noted.
    """
    if not wide(deck, row, POINT, "POINTS"):
        return {}
    columns = FORCED if len(row.entries) >= len(FORCED) else POINT
    said = row.entries[1]
    kind = next((kind for kind, words in KINDS.items() if said.upper() in words), "")
    if on_bodies and re.fullmatch(r"BODY\d+", said.upper()):
        kind = said.lower()
    if not kind:
        allowed = "Fixed, Coupled, Free" + (" or Body1" if on_bodies else "")
        deck.refuse(row, "Attachment", f"{shown(said)} is not taken", allowed)
        return {}
    x, y, z, *loads = (deck.number(row, columns, name) for name in columns[2:])
    if len(loads) > 4 and any(loads[2:5]):
        deck.refuse(row, "FX, FY, FZ", "a scene has no steady forces", "0")
    mass, volume, area, added = (*loads[:2], *loads[-2:])
    return {
        "id": row.entries[0], "kind": kind, "place": [x, y, z], "row": row,
        "mass": mass, "volume": volume, "area": area, "added": added,
    }  # fmt: skip


def point_body(
    deck: Deck, free: Mapping[str, Any], environment: Mapping[str, float]
) -> list[dict[str, Any]]:
    """The item of a line that stands for a free point; none where it has neither mass nor drag."""
    mass, volume, area, added = (free[key] for key in ("mass", "volume", "area", "added"))
    if not (mass or volume or area):
        return []
    if mass <= 0.0:
        deck.refuse(free["row"], "Mass", f"{mass:g} of a point with volume or drag", "above 0")
    moved = environment["rho"] * volume * added
    body = {
        "name": f"point {free['id']}", "mass": mass,
        "submerged_weight": environment["g"] * (mass - environment["rho"] * volume),
        "added_mass": moved, "added_mass_axial": moved, "drag_area": area,
    }  # fmt: skip
    return [{"body": body}]
