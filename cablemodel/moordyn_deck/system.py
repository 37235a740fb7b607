"""All lines of a deck, with what joins and holds them: a scene of a system.

Points that are free join lines: two of them go on as one line, others begin there as branches. So
a joint needs no body of its own; one with a mass is a point body of the line that goes through.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import shown
from cablemodel.moordyn_deck.deck import LINE, Deck, Row, line_type, point_body, read_point, wide
from cablemodel.moordyn_deck.solids import Lump, Solids, body_of, read_solids
from cablemodel.moordyn_deck.text import cable_of, type_of

Joint = str
"""ID of a free point, or R and that of a rod without length."""


@dataclass(frozen=True)
class _End:
    """An end of a line of the deck: a joint, or what holds it as a scene writes that."""

    joint: Joint | None = None
    held: Any = None
    place: tuple[float, float, float] = (0.0, 0.0, 0.0)
    way: tuple[float, float, float] | None = None
    """In which a line that bends leaves what holds it clamped."""


@dataclass(frozen=True)
class _Line:
    """A line of the deck."""

    row: Row
    kind: Mapping[str, Any]
    length: float
    ends: tuple[_End, _End]

    @property
    def id(self) -> str:
        return self.row.entries[0]


@dataclass(frozen=True)
class _Path:
    """Lines of the deck that are one of the scene, each with whether it is turned round."""

    parts: tuple[tuple[_Line, bool], ...]

    @property
    def name(self) -> str:
        return "line" + "_".join(line.id for line, _turned in self.parts)

    @property
    def ends(self) -> tuple[_End, _End]:
        (first, turned), (last, back) = self.parts[0], self.parts[-1]
        return first.ends[turned], last.ends[not back]

    @property
    def joints(self) -> dict[Joint, float]:
        """Those within, with their arc lengths [m]."""
        arc, found = 0.0, {}
        for line, turned in self.parts[:-1]:
            arc += line.length
            joint = line.ends[not turned].joint
            assert joint is not None
            found[joint] = arc
        return found

    def turned(self) -> _Path:
        return _Path(tuple((line, not turned) for line, turned in reversed(self.parts)))


def system(deck: Deck, environment: dict[str, float]) -> tuple[dict[str, Any], str]:
    """Parts of a scene by its keys, and a comment; empty where something is wrong.

    environment: gravity [m/s2], density [kg/m3], depth [m]: made as deep as the lowest point.
    """
    solids = read_solids(deck, environment["rho"])
    points = _points(deck, solids, environment["rho"])
    lines = [
        line
        for row in deck.rows.get("lines", [])
        if wide(deck, row, LINE, "LINES") and deck.is_new("LINES", row)
        for line in [_line(deck, row, solids, points)]
        if line is not None
    ]
    if deck.problems:
        return {}, ""
    paths = _joined(deck, lines)
    _refuse_what_nothing_holds(deck, paths, solids)
    _tell(deck, lines, solids)
    bodies = {
        name: body_of(deck, frame, environment)
        for name, frame in solids.frames.items()
        if frame.kind == "free"
    }
    low = min(end.place[2] for line in lines for end in line.ends)
    environment["wtrdpth"] = max(environment["wtrdpth"], -low)
    scene: dict[str, Any] = {
        "cable_types": {line.kind["name"]: type_of(line.kind) for line in lines}
    }
    vessels = {
        name: {**frame.motion, "points": frame.points}
        for name, frame in solids.frames.items()
        if frame.kind != "free" and frame.points
    }
    if vessels:
        scene["vessels"] = vessels
    if vessels.keys() - {"ground"}:
        what = "coupled points and rods" if "vessel" in vessels else "coupled bodies"
        deck.left.append(f"the motion of {what}, which no deck holds: vessels.NAME.velocity")
    if bodies:
        scene["bodies"] = bodies
    scene["lines"] = {path.name: _written(deck, path, paths, points, environment) for path in paths}
    return scene, "Coupled points and rods are points of one vessel."


def _points(deck: Deck, solids: Solids, density: float) -> dict[str, dict[str, Any]]:
    """All points by their IDs; those with a mass on a free body become parts of it."""
    points = {}
    used = {word for row in deck.rows.get("lines", []) for word in row.entries[2:4]}
    for row in deck.rows.get("points", []):
        found = read_point(deck, row, on_bodies=True)
        if not found or not deck.is_new("POINTS", row):
            continue
        points[found["id"]] = found
        name = {"fixed": "ground", "coupled": "vessel"}.get(found["kind"], found["kind"])
        loaded = found["mass"] or found["volume"] or found["area"]
        if found["kind"] == "free":
            if found["id"] not in used:
                deck.left.append(f"point {found['id']}, which no line holds")
        elif name not in solids.frames:
            deck.refuse(row, "Attachment", f"there is no {name}", "one of BODIES")
        elif loaded and solids.frames[name].kind == "free":
            place = np.array(found["place"])
            solids.frames[name].lumps.append(Lump.of_point(place, found, density))
        elif loaded:
            deck.left.append(f"mass, volume and drag of point {found['id']}, which is held")
        found["frame"] = name
    return points


def _line(
    deck: Deck, row: Row, solids: Solids, points: Mapping[str, dict[str, Any]]
) -> _Line | None:
    length = deck.number(row, LINE, "UnstrLen")
    if length <= 0.0:
        deck.refuse(row, "UnstrLen", f"{length:g} is not above 0", "a length in m")
    kind = line_type(deck, row)
    bends = bool(kind) and kind["bending_stiffness"] > 0.0
    ends = [_end(deck, row, name, solids, points, bends) for name in ("AttachA", "AttachB")]
    if not kind or ends[0] is None or ends[1] is None:
        return None
    return _Line(row, kind, length, (ends[0], ends[1]))


def _end(
    deck: Deck,
    row: Row,
    column: str,
    solids: Solids,
    points: Mapping[str, dict[str, Any]],
    bends: bool,
) -> _End | None:
    said = row.entries[LINE.index(column)]
    if re.fullmatch(r"[rR]([oO][dD])?\d+[aAbB]", said):
        key = said.upper().replace("ROD", "R")
        if key not in solids.rod_ends:
            known = ", ".join(solids.rod_ends) or "no rod is there"
            deck.refuse(row, column, f"there is no end {said} of a rod", known)
            return None
        rod = solids.rod_ends[key]
        if rod.frame is None:
            return _End(joint=rod.name, place=_three(rod.place))
        there = _three(rod.frame.world(rod.place))
        if bends and rod.frame.kind == "free":
            deck.left.append(
                f"the clamp of line {row.entries[0]} at {said}: it is free to turn there"
            )
        if not bends or rod.frame.kind == "free" or rod.way is None:
            return _End(held=rod.frame.end(rod.name, rod.place), place=there)
        held = rod.frame.point(rod.name, rod.place)
        return _End(held=held, place=there, way=_three(rod.way))
    if said not in points:
        deck.refuse(row, column, f"{shown(said)} is no single point", "the ID of a point")
        return None
    found = points[said]
    place = np.array(found["place"])
    if found["kind"] == "free":
        return _End(joint=said, place=_three(place))
    if found["frame"] not in solids.frames:
        return None
    holder = solids.frames[found["frame"]]
    return _End(held=holder.end(f"p{said}", place), place=_three(holder.world(place)))


def _joined(deck: Deck, lines: list[_Line]) -> list[_Path]:
    """Lines of the scene: at every joint two go on as one, held ones and long ones first."""
    paths = [_Path(((line, False),)) for line in lines]
    joints = dict.fromkeys(end.joint for line in lines for end in line.ends if end.joint)
    for joint in joints:
        there = [path for path in paths if joint in {end.joint for end in path.ends}]
        if len(there) < 2:
            continue
        there.sort(key=_held_and_long, reverse=True)
        first, second = sorted(there[:2], key=paths.index)
        before = first if first.ends[1].joint == joint else first.turned()
        after = second if second.ends[0].joint == joint else second.turned()
        whole = _Path(before.parts + after.parts)
        paths[paths.index(first)] = whole
        paths.remove(second)
    for path in paths:
        ring = {end.joint for end in path.ends if end.joint} & set(path.joints)
        first_end, last_end = (end.joint for end in path.ends)
        if ring or (first_end is not None and first_end == last_end):
            at = next(iter(ring), first_end)
            deck.refuse(
                path.parts[0][0].row, "AttachA, AttachB",
                f"{path.name} comes back to the free point {at}", "lines that make no ring",
            )  # fmt: skip
    bent = sorted({j for path in paths for j in path.joints if _bends(path) and j[0] != "R"})
    if bent:
        deck.left.append(f"hinges at points {', '.join(bent)}: lines that are joined bend as one")
    return paths


def _bends(path: _Path) -> bool:
    return any(line.kind["bending_stiffness"] > 0.0 for line, _turned in path.parts)


def _held_and_long(path: _Path) -> tuple[int, float]:
    held = sum(end.held is not None for end in path.ends)
    return held, math.fsum(line.length for line, _turned in path.parts)


def _refuse_what_nothing_holds(deck: Deck, paths: list[_Path], solids: Solids) -> None:
    """Parts of the deck that no anchor and no vessel holds, and bodies without a line."""
    groups: list[tuple[set[str], bool]] = []
    for path in paths:
        names, held = {path.name}, False
        for end in path.ends:
            owner = _owner(end, solids)
            names |= {owner} if owner else {f"point {end.joint}"} if end.joint else set()
            held = held or (end.held is not None and not owner)
        names |= {f"point {joint}" for joint in path.joints}
        touched = [group for group in groups if group[0] & names]
        groups = [group for group in groups if group not in touched]
        names = names.union(*(group[0] for group in touched))
        groups.append((names, held or any(group[1] for group in touched)))
    rows = {path.name: path.parts[0][0].row for path in paths}
    for names, held in groups:
        if not held:
            first = next(path for path in paths if path.name in names)
            allowed = "a fixed or coupled end somewhere on what hangs together"
            deck.refuse(rows[first.name], "AttachA, AttachB", "no end is held", allowed)
    attached = set().union(*(names for names, _held in groups)) if groups else set()
    for name, frame in solids.frames.items():
        if frame.kind == "free" and name not in attached:
            deck.refuse(frame.row, "ID", f"no line is attached to {name}", "a line at it")


def _owner(end: _End, solids: Solids) -> str:
    """Name of the free body that an end is at; empty elsewhere."""
    name = end.held.partition(".")[0] if isinstance(end.held, str) else ""
    return name if name in solids.frames and solids.frames[name].kind == "free" else ""


def _tell(deck: Deck, lines: list[_Line], solids: Solids) -> None:
    """What is only like the deck."""
    if any(end.joint for line in lines for end in line.ends):
        deck.left.append("the places of free points, from which MoorDyn seeks rest")
    if max(end.place[2] for line in lines for end in line.ends) > 0.0:
        deck.left.append("the dry part above z = 0: water is everywhere in a scene without waves")


def _written(
    deck: Deck,
    path: _Path,
    paths: list[_Path],
    points: Mapping[str, dict[str, Any]],
    environment: Mapping[str, float],
) -> dict[str, Any]:
    """A line of the scene, with point bodies where joints have a mass."""
    items: list[dict[str, Any]] = []
    ends: list[Any] = []
    for end, sign in zip(path.ends, (1.0, -1.0), strict=True):
        through = next((other for other in paths if end.joint in other.joints), None)
        if end.way is not None:
            ends.append({"point": end.held, "clamped": [sign * x + 0.0 for x in end.way]})
        elif end.joint is None:
            ends.append(end.held)
        elif through is not None:
            ends.append({"line": through.name, "at": through.joints[end.joint]})
        else:
            ends.append("free")

    def bodies(end: _End) -> Iterator[dict[str, Any]]:
        if end.joint is not None and end.joint in points:
            yield from point_body(deck, points[end.joint], environment)

    if ends[0] == "free":
        items += bodies(path.ends[0])
    for index, (line, turned) in enumerate(path.parts):
        items.append(cable_of(line.kind, line.length))
        if index < len(path.parts) - 1:
            items += bodies(line.ends[not turned])
    if ends[1] == "free":
        items += bodies(path.ends[1])
    return {"from": ends[0], "to": ends[1], "items": items}


def _three(place: NDArray[np.float64]) -> tuple[float, float, float]:
    x, y, z = (float(value) for value in place)
    return x, y, z
