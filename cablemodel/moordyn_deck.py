"""Decks of MoorDyn (its input files, version 2) as scenes: one line between two points.

The format is that of MoorDyn's documentation, "The V2 Input File", and of its reader (2.7,
``MoorDyn2.cpp``): sections begin with a line of dashes and a key phrase; tables have two lines of
heading; options are a value and a key. What the two programs share is taken as it is: the line's
diameter, mass, EA, EI, drag coefficients on d and on pi d, added mass; mass, volume, drag and added
mass of a free point, whose drag is that of a sphere. What a scene cannot state is refused by name
where it is a load or a constraint, and told where it is damping, numerics or output.
"""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from cablemodel.errors import SceneError, SceneProblem, shown

_SECTIONS: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("options", ("OPTIONS",)),
    ("outputs", ("OUTPUT",)),
    ("SYROPE IC", ("SYROPE IC",)),
    ("FAILURE", ("FAILURE",)),
    ("CONTROL", ("CONTROL",)),
    ("EXTERNAL LOADS", ("EXTERNAL LOADS",)),
    ("line types", ("LINE DICTIONARY", "LINE TYPES")),
    ("rod types", ("ROD DICTIONARY", "ROD TYPES")),
    ("BODIES", ("BODIES", "BODY LIST", "BODY PROPERTIES")),
    ("RODS", ("RODS", "ROD LIST", "ROD PROPERTIES")),
    ("points", ("POINTS", "POINT LIST", "POINT PROPERTIES", "CONNECTION PROPERTIES",
                "NODE PROPERTIES")),
    ("lines", ("LINES", "LINE LIST", "LINE PROPERTIES")),
)  # fmt: skip
"""Sections, by the phrases that MoorDyn finds them by; in capitals: those that are refused."""
_KINDS = {
    "fixed": ("ANCHOR", "FIXED", "FIX"),
    "coupled": ("FAIRLEAD", "VESSEL", "VES", "COUPLED", "CPLD"),
    "free": ("POINT", "CONNECT", "CON", "FREE"),
}
_LINE_TYPE = (
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
_POINT = ("ID", "Attachment", "X", "Y", "Z", "Mass", "Volume", "CdA", "Ca")
_FORCED = (*_POINT[:7], "FX", "FY", "FZ", *_POINT[7:])
"""Columns of points with steady forces."""
_LINE = ("ID", "LineType", "AttachA", "AttachB", "UnstrLen", "NumSegs")
_GRAVITY, _DENSITY = 9.80665, 1025.0
"""What MoorDyn takes where the deck says nothing [m/s2], [kg/m3]."""
_MEANT = {"gravity": "g", "wtrdnsty": "rho", "kb": "kbot", "cb": "cbot", "mc": "statdynfricscale"}
"""Options by their other names."""
_WATER = {"wavekin": "waves", "currents": "a current", "waterkin": "waves or a current",
          "seafloorfile": "a table of depths"}  # fmt: skip
"""Options that name files with loads, or a floor, and what they give."""
_FLOOR = {"kbot": "kBot", "cbot": "cBot", "statdynfricscale": "StatDynFricScale"}
_NUMERICS = re.compile(
    "dtm|dt|cfl|tscheme|dtic|icdt|tmaxic|ictmax|cdscaleic|icdfac|threshic|icthresh|gendynamicic|"
    "icgendynamic|fileic|icfile|dtwave|unifycurrentgrid|wavekin_rampt|writelog|writeunits|dtout|"
    "disableoutput|disableouttime|fricdamp|cv|inertialf|inertialf_rampt|outswitch"
)


@dataclass(frozen=True)
class _Row:
    """A line of the deck."""

    number: int
    entries: tuple[str, ...]


@dataclass
class _Deck:
    """Rows by section, and what is found wrong."""

    rows: dict[str, list[_Row]] = field(default_factory=dict)
    problems: list[SceneProblem] = field(default_factory=list)
    left: list[str] = field(default_factory=list)

    def refuse(self, row: _Row | None, what: str, problem: str, allowed: str = "") -> None:
        place = f"line {row.number}, {what}" if row else what
        self.problems.append(SceneProblem(place, None, problem, allowed))

    def number(self, row: _Row, columns: tuple[str, ...], name: str) -> float:
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


def read_deck(text: str, source: str = "", line: int | None = None) -> tuple[str, list[str]]:
    """A scene in YAML from the text of a MoorDyn deck of version 2.

    Args:
        text: the deck.
        source: what its errors call it.
        line: ID of the line to take; needed where the deck has several.

    Returns:
        The scene's text: the line from its coupled point, or else from a fixed one, which is at
        rest as long as the scene says nothing else; and what was left out, in words.

    Raises:
        SceneError: naming, by the deck's lines and columns, all that a scene cannot state.
    """
    deck = _sections(text)
    _refuse_sections(deck)
    environment = _environment(deck)
    scene = _line(deck, environment, line)
    if deck.problems:
        raise SceneError(deck.problems, source)
    return _written(scene, environment, deck.left, source), deck.left


def _sections(text: str) -> _Deck:
    deck, name, heading = _Deck(), "", 0
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
            deck.rows.setdefault(name, []).append(_Row(number, entries))
    return deck


def _refuse_sections(deck: _Deck) -> None:
    """Sections of what a scene has not."""
    for name, rows in deck.rows.items():
        if name.isupper():
            deck.refuse(rows[0], name, f"{len(rows)} of these: a scene has none", "no such section")
    for name in ("line types", "points", "lines"):
        if not deck.rows.get(name):
            deck.refuse(None, f"section {name.upper()}", "is missing, or has no rows")


def _environment(deck: _Deck) -> dict[str, float]:
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
            if value.strip('"') not in ("", "0"):
                problem = f"{shown(value)} asks for {_WATER[key]} from a file"
                deck.refuse(row, name, problem, "0; give it in the scene (docs/scene.md)")
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


def _line(deck: _Deck, environment: dict[str, float], wanted: int | None) -> dict[str, Any]:
    """The line and its ends; empty where something is wrong."""
    rows = [row for row in deck.rows.get("lines", []) if _wide(deck, row, _LINE, "LINES")]
    found = [row for row in rows if wanted is None or row.entries[0] == str(wanted)]
    listed = ", ".join(row.entries[0] for row in rows)
    if len(found) != 1:
        if rows and wanted is None:
            deck.refuse(
                None, "LINES", f"there are {len(rows)}", f"one, which --line names: {listed}"
            )
        elif rows:
            deck.refuse(None, "LINES", f"there is no single line {wanted}", listed)
        return {}
    row = found[0]
    others = [other for other in rows if other is not row]
    if others:
        deck.left.append(f"the other lines: {', '.join(other.entries[0] for other in others)}")
    length = deck.number(row, _LINE, "UnstrLen")
    if length <= 0.0:
        deck.refuse(row, "UnstrLen", f"{length:g} is not above 0", "a length in m")
    kind = _line_type(deck, row)
    ends = [_point(deck, row, name) for name in ("AttachA", "AttachB")]
    for end in ends:
        if end.get("kind") == "free":
            shared = [o.entries[0] for o in others if end["id"] in o.entries[2:4]]
            if shared:
                joined = f"the free point {end['id']} joins it to line {', '.join(shared)}"
                deck.refuse(row, "AttachA, AttachB", joined, "ends of no other line")
    if not all(ends) or deck.problems:
        return {}
    # From the vessel outwards: the coupled end, else the fixed one; B is the fairlead.
    order = ("coupled", "fixed", "free")
    a, b = ends
    near, far = sorted((b, a), key=lambda end: order.index(end["kind"]))
    if near["kind"] == "free" or far["kind"] == "coupled":
        both = "no end is held" if near["kind"] == "free" else "both ends are coupled"
        deck.refuse(row, "AttachA, AttachB", both, "one coupled or fixed end, and a fixed or free")
        return {}
    for end in (near, far):
        if end["kind"] != "free" and (end["mass"] or end["volume"] or end["area"]):
            deck.left.append(f"mass, volume and drag of point {end['id']}, which is held")
    if near["kind"] == "coupled":
        deck.left.append("the coupled point's motion, which no deck holds: vessel.velocity")
    if max(near["place"][2], far["place"][2]) > 0.0:
        deck.left.append("the dry part above z = 0: water is everywhere in a scene without waves")
    # MoorDyn's floor is no higher than its lowest point.
    rows = [point for point in deck.rows["points"] if _wide(deck, point, _POINT, "POINTS")]
    lowest = min(deck.number(point, _POINT, "Z") for point in rows)
    environment["wtrdpth"] = max(environment["wtrdpth"], -lowest)
    return {"length": length, "type": kind, "near": near, "far": _far(deck, far, environment)}


def _wide(deck: _Deck, row: _Row, columns: tuple[str, ...], section: str) -> bool:
    """Whether a row has all columns that it needs."""
    if len(row.entries) >= len(columns):
        return True
    problem = f"{len(row.entries)} entries; {len(columns)} are needed: {', '.join(columns)}"
    deck.refuse(row, section, problem, "a deck of MoorDyn v2")
    return False


def _line_type(deck: _Deck, line: _Row) -> dict[str, Any]:
    name = line.entries[1]
    found = [row for row in deck.rows.get("line types", []) if row.entries[0] == name]
    if len(found) != 1:
        names = ", ".join(row.entries[0] for row in deck.rows.get("line types", []))
        deck.refuse(line, "LineType", f"there is no single type {shown(name)}", names)
        return {}
    row = found[0]
    if not _wide(deck, row, _LINE_TYPE[:-1], "LINE TYPES"):
        return {}
    for column, what in (("EA", "viscoelastic or tabulated"), ("EI", "tabulated")):
        text = row.entries[_LINE_TYPE.index(column)]
        if re.search(r"[|:]|[^\d.eE+-]", text):
            deck.refuse(row, column, f"{shown(text)} is {what}", "one number")
            return {}

    def value(column: str) -> float:
        return deck.number(row, _LINE_TYPE, column)

    kind = {
        "diameter": value("Diam"), "mass": value("Mass/m"),
        "axial_stiffness": value("EA"), "bending_stiffness": value("EI"),
        "drag_normal": value("Cd"), "drag_tangential": value("CdAx"), "added_mass": value("Ca"),
    }  # fmt: skip
    for column in ("Diam", "Mass/m", "EA"):
        if value(column) <= 0.0:
            deck.refuse(row, column, f"{value(column):g} is not above 0", "a number above 0")
    if len(row.entries) > len(_LINE_TYPE) - 1 and value("Cl") != 0.0:
        deck.refuse(row, "Cl", "vortices that shake a line are not computed", "0")
    if row.entries[4] not in ("0", "0.0"):
        deck.left.append(f"BA/-zeta ({row.entries[4]}): a cable has no internal damping")
    if value("CaAx") != 0.0:
        deck.left.append(f"CaAx ({row.entries[9]}): no added mass along a cable")
    return {"name": name, **kind}


def _point(deck: _Deck, line: _Row, column: str) -> dict[str, Any]:
    """An end of the line: what it is, where, and what hangs on it."""
    name = line.entries[_LINE.index(column)]
    found = [row for row in deck.rows.get("points", []) if row.entries[0] == name]
    if len(found) != 1:
        is_rod = re.fullmatch(r"[rR](OD|od)?\d+[aAbB]", name)
        problem = "is the end of a rod" if is_rod else "is no single point"
        deck.refuse(line, column, f"{shown(name)} {problem}", "the ID of a point")
        return {}
    row = found[0]
    if not _wide(deck, row, _POINT, "POINTS"):
        return {}
    columns = _FORCED if len(row.entries) >= len(_FORCED) else _POINT
    said = row.entries[1]
    kind = next((kind for kind, words in _KINDS.items() if said.upper() in words), "")
    if not kind:
        deck.refuse(row, "Attachment", f"{shown(said)} is not taken", "Fixed, Coupled or Free")
        return {}
    x, y, z, *loads = (deck.number(row, columns, name) for name in columns[2:])
    if len(loads) > 4 and any(loads[2:5]):
        deck.refuse(row, "FX, FY, FZ", "a scene has no steady forces", "0")
    mass, volume, area, added = (*loads[:2], *loads[-2:])
    return {
        "id": name, "kind": kind, "place": [x, y, z], "row": row,
        "mass": mass, "volume": volume, "area": area, "added": added,
    }  # fmt: skip


def _far(deck: _Deck, far: dict[str, Any], environment: Mapping[str, float]) -> dict[str, Any]:
    """The far end, with a body where a free point has a mass."""
    mass, volume, area, added = (far[key] for key in ("mass", "volume", "area", "added"))
    if far["kind"] == "fixed":
        return {"anchor": far["place"]}
    deck.left.append("the free point's place, from which MoorDyn seeks rest")
    if not (mass or volume or area):
        return {}
    if mass <= 0.0:
        deck.refuse(far["row"], "Mass", f"{mass:g} of a point with volume or drag", "above 0")
    moved = environment["rho"] * volume * added
    body = {
        "name": f"point {far['id']}", "mass": mass,
        "submerged_weight": environment["g"] * (mass - environment["rho"] * volume),
        "added_mass": moved, "added_mass_axial": moved, "drag_area": area,
    }  # fmt: skip
    return {"body": body}


def _written(
    scene: dict[str, Any], environment: Mapping[str, float], left: list[str], source: str
) -> str:
    """The scene in YAML, with what was left out as its first comment."""
    import yaml

    from cablemodel.scene.text import SceneDumper

    kind, near, far = dict(scene["type"]), scene["near"], scene["far"]
    name = kind.pop("name")
    cable: dict[str, Any] = {"type": name, "length": scene["length"]}
    if kind["bending_stiffness"] > 0.0:
        cable["model"] = "elastica"  # MoorDyn's line bends everywhere
    line: list[dict[str, Any]] = [{"cable": cable}]
    if "body" in far:
        line.append({"body": far["body"]})
    floor = {"z": -environment["wtrdpth"], "friction": environment["frictioncoefficient"]}
    data: dict[str, Any] = {"title": f"Line of {source or 'a MoorDyn deck'}"}
    data["environment"] = {
        "gravity": environment["g"], "water_density": environment["rho"], "floor": floor,
    }  # fmt: skip
    data["cable_types"] = {name: kind}
    data["line"] = line
    data["end"] = {"anchor": far["anchor"]} if "anchor" in far else "free"
    data["vessel"] = {"position": near["place"]}
    comment = [f"# The {near['kind']} point {near['id']} is the vessel. Not taken from the deck:"]
    comment += [f"# - {' '.join(item.split())}" for item in left] or ["# - nothing"]
    body = yaml.dump(data, Dumper=SceneDumper, sort_keys=False, allow_unicode=True)
    return "\n".join(comment) + "\n" + body
