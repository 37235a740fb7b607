"""Bodies and rods of a deck: frames that hold points, and what those that are free are made of."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import shown
from cablemodel.moordyn_deck.deck import KINDS, Deck, Row, wide

FloatArray = NDArray[np.float64]

_BODY = ("ID", "Attachment", "X0", "Y0", "Z0", "r0", "p0", "y0", "Mass", "CG", "I", "Volume",
         "CdA", "Ca")  # fmt: skip
_ROD = ("ID", "RodType", "Attachment", "Xa", "Ya", "Za", "Xb", "Yb", "Zb", "NumSegs")
_ROD_TYPE = ("TypeName", "Diam", "Mass/m", "Cd", "Ca", "CdEnd", "CaEnd")
_UPRIGHT = 1e-6
"""Of a rod with a hull: how far its direction may be off the body's z axis [-]."""
_OFF_DIAGONAL = 1e-3
"""Products of inertia below this part of the largest moment are not worth a word."""


@dataclass(frozen=True)
class Lump:
    """A part of a free body, in the body's axes (SI units).

    ``place`` (3,) is its centre, and that of its buoyancy and added mass; ``inertia`` (3, 3) is
    about it, ``added`` (3, 3) the water that moves with it, ``added_inertia``, ``drag`` and
    ``turning`` (3,) are by axis, as a scene has them.
    """

    place: FloatArray
    mass: float
    volume: float
    inertia: FloatArray
    added: FloatArray
    added_inertia: FloatArray
    drag: FloatArray
    turning: FloatArray

    @staticmethod
    def of_point(place: FloatArray, loads: Mapping[str, float], density: float) -> Lump:
        """A point that is fixed to a body, with what hangs on it."""
        none = np.zeros(3)
        added = density * loads["volume"] * loads["added"] * np.eye(3)
        return Lump(place, loads["mass"], loads["volume"], np.zeros((3, 3)), added, none,
                    np.full(3, loads["area"]), none)  # fmt: skip


@dataclass
class Frame:
    """What holds points: the ground, a vessel or a free body; ``axes`` (3, 3) in columns."""

    name: str
    kind: str
    position: FloatArray
    axes: FloatArray
    row: Row | None = None
    points: dict[str, list[float]] = field(default_factory=dict)
    lumps: list[Lump] = field(default_factory=list)
    rods: list[tuple[Row, FloatArray, FloatArray, float]] = field(default_factory=list)
    """Of a free body: rows, both ends in its axes, diameters [m]."""

    def world(self, place: FloatArray) -> FloatArray:
        """Where a place in its axes is (3,)."""
        return self.position + self.axes @ place

    def end(self, point: str, place: FloatArray) -> Any:
        """The end of a line there, as a scene writes it."""
        if self.kind == "fixed":
            return {"anchor": [float(x) for x in self.world(place)]}
        return self.point(point, place)

    def point(self, name: str, place: FloatArray) -> str:
        """A point of it, as a scene writes that."""
        self.points[name] = [float(x) for x in place]
        return f"{self.name}.{name}"

    @property
    def motion(self) -> dict[str, list[float]]:
        """Position, and roll, pitch and yaw of a vessel or body, as a scene writes them."""
        a = self.axes
        level = math.hypot(a[0, 0], a[1, 0])
        pitch = math.atan2(-a[2, 0], level)
        # Upright, roll and yaw are one: all of it is roll.
        turned = level > 1e-9
        roll = math.atan2(a[2, 1], a[2, 2]) if turned else math.atan2(-a[1, 2], a[1, 1])
        yaw = math.atan2(a[1, 0], a[0, 0]) if turned else 0.0
        return {
            "position": [float(x) for x in self.position],
            "attitude": [round(x, 12) + 0.0 for x in (roll, pitch, yaw)],
        }


@dataclass(frozen=True)
class RodEnd:
    """An end of a rod: a point of its frame, with the way out of the rod there, in its axes (3,).

    Without a frame: both ends of a free rod without length, which joins lines so that they bend as
    one. ``name`` is then that of the joint, and ``place`` where it is at first.
    """

    name: str
    place: FloatArray
    frame: Frame | None = None
    way: FloatArray | None = None


@dataclass
class Solids:
    """All frames by name, and the ends of rods by theirs, as ``R1A``."""

    frames: dict[str, Frame]
    rod_ends: dict[str, RodEnd]

    @property
    def ground(self) -> Frame:
        """Where anchors are."""
        return self.frames["ground"]

    @property
    def vessel(self) -> Frame:
        """What all coupled points and rods move with."""
        return self.frames["vessel"]


def read_solids(deck: Deck, density: float) -> Solids:
    """Frames of a deck's bodies and rods; what is wrong is noted in the deck."""
    frames = {
        name: Frame(name, kind, np.zeros(3), np.eye(3))
        for name, kind in (("ground", "fixed"), ("vessel", "coupled"))
    }
    for row in deck.rows.get("bodies", []):
        if wide(deck, row, _BODY, "BODIES") and deck.is_new("BODIES", row):
            frame = _body(deck, row, density)
            frames[frame.name] = frame
    ends: dict[str, RodEnd] = {}
    for row in deck.rows.get("rods", []):
        if wide(deck, row, _ROD, "RODS") and deck.is_new("RODS", row):
            _add_rod(deck, row, density, frames, ends)
    return Solids(frames, ends)


def _body(deck: Deck, row: Row, density: float) -> Frame:
    from scipy.spatial.transform import Rotation

    name, said = f"body{row.entries[0]}", row.entries[1]
    kind = next((kind for kind, words in KINDS.items() if said.upper() in words), "")
    if not kind:
        deck.refuse(row, "Attachment", f"{shown(said)} is not taken", "Fixed, Coupled or Free")
    numbers = [deck.number(row, _BODY, column) for column in _BODY[2:9]]
    angles = Rotation.from_euler("XYZ", numbers[3:6], degrees=True)
    frame = Frame(name, kind, np.array(numbers[:3]), angles.as_matrix(), row)
    centre = deck.numbers(row, _BODY, "CG", (1, 3))
    inertia = deck.numbers(row, _BODY, "I", (1, 3))
    volume = deck.number(row, _BODY, "Volume")
    drag = deck.numbers(row, _BODY, "CdA", (1, 2, 3, 6))
    added = deck.numbers(row, _BODY, "Ca", (1, 3))
    if kind != "free":
        return frame
    # One number is for all; two are for shifts and turns; three are by axis, for both.
    area = np.repeat(drag, 3) if len(drag) == 2 else np.resize(drag, 6)
    place = np.array(centre if len(centre) == 3 else [0.0, 0.0, centre[0]])
    frame.lumps.append(
        Lump(
            place, numbers[6], volume, np.diag(np.broadcast_to(inertia, 3)),
            density * volume * np.diag(np.broadcast_to(added, 3)), np.zeros(3), area[:3], area[3:],
        )
    )  # fmt: skip
    deck.left.append(
        f"body {row.entries[0]}: its buoyancy acts at CG, as in MoorDyn, and its added mass there "
        "too; its drag goes by the whole relative speed"
    )
    return frame


def _add_rod(
    deck: Deck,
    row: Row,
    density: float,
    frames: dict[str, Frame],
    ends: dict[str, RodEnd],
) -> None:
    """A rod as points of what it is fixed to, and as a part of that where it is free."""
    number = row.entries[0]
    numbers = [deck.number(row, _ROD, column) for column in _ROD[3:9]]
    a, b = np.array(numbers[:3]), np.array(numbers[3:])
    length = float(np.linalg.norm(b - a))
    if length == 0.0 or row.entries[9] == "0":
        if row.entries[2].upper() in KINDS["free"]:
            ends[f"R{number}A"] = ends[f"R{number}B"] = RodEnd(f"R{number}", a)
            deck.left.append(
                f"rod {number}: without a length it is a joint, where lines bend as one"
            )
        else:
            deck.refuse(row, "RODS", f"rod {number} has no length", "two ends, or Free")
        return
    kind = _rod_type(deck, row)
    owner = _owner(deck, row, frames, a, b)
    if owner is None or not kind:
        return
    if owner.name == f"rod{number}":
        a, b = np.zeros(3), np.array([0.0, 0.0, length])
        names = "a", "b"
    else:
        names = f"r{number}a", f"r{number}b"
    along = (b - a) / length
    ends[f"R{number}A"] = RodEnd(names[0], a, owner, -along)
    ends[f"R{number}B"] = RodEnd(names[1], b, owner, along)
    if owner.kind == "free":
        owner.lumps.append(_cylinder(kind, a, b, density))
        owner.rods.append((row, a, b, kind["Diam"]))
        deck.left.append(
            f"rod {number}: drag and added mass are by the axes of the body, about its middle"
        )


def _owner(
    deck: Deck, row: Row, frames: dict[str, Frame], a: FloatArray, b: FloatArray
) -> Frame | None:
    """What a rod is fixed to; of a free one a frame of its own, z from its end A to B."""
    said = row.entries[2].upper()
    if (body := re.fullmatch(r"BODY(\d+)", said)) is not None:
        owner = frames.get(f"body{body[1]}")
        if owner is None:
            deck.refuse(row, "Attachment", f"there is no body {body[1]}", _listed(deck, "bodies"))
        return owner
    kind = next((kind for kind, words in KINDS.items() if said in words), "")
    if kind == "fixed":
        return frames["ground"]
    if kind == "coupled":
        return frames["vessel"]
    if kind == "free":
        from scipy.spatial.transform import Rotation

        way = (b - a) / np.linalg.norm(b - a)
        turn = Rotation.align_vectors(way[None], np.array([[0.0, 0.0, 1.0]]))[0]
        name = f"rod{row.entries[0]}"
        frames[name] = Frame(name, "free", a, turn.as_matrix(), row)
        return frames[name]
    problem = f"{shown(row.entries[2])} is not taken"
    allowed = "Fixed, Coupled, Free or Body1: what is pinned turns about one end"
    deck.refuse(row, "Attachment", problem, allowed)
    return None


def _listed(deck: Deck, section: str) -> str:
    return ", ".join(row.entries[0] for row in deck.rows.get(section, [])) or "none is there"


def _rod_type(deck: Deck, rod: Row) -> dict[str, float]:
    rows = deck.rows.get("rod types", [])
    found = [row for row in rows if row.entries[0] == rod.entries[1]]
    if len(found) != 1:
        problem = f"there is no single type {shown(rod.entries[1])}"
        deck.refuse(rod, "RodType", problem, _listed(deck, "rod types"))
        return {}
    (row,) = found
    if not wide(deck, row, _ROD_TYPE, "ROD TYPES"):
        return {}
    kind = {column: deck.number(row, _ROD_TYPE, column) for column in _ROD_TYPE[1:]}
    if kind["Diam"] <= 0.0:
        deck.refuse(row, "Diam", f"{kind['Diam']:g} is not above 0", "a number above 0")
        return {}
    return kind


def _cylinder(kind: Mapping[str, float], a: FloatArray, b: FloatArray, density: float) -> Lump:
    """A rod between two places, with the water that it moves."""
    length = float(np.linalg.norm(b - a))
    along = (b - a) / length
    axis = np.outer(along, along)
    across = np.eye(3) - axis
    d = kind["Diam"]
    section = math.pi / 4.0 * d * d
    mass, water = kind["Mass/m"] * length, density * section * length
    inertia = mass * (axis * d * d / 8.0 + across * (d * d / 16.0 + length**2 / 12.0))
    ends = 2.0 * density * math.pi / 12.0 * d**3  # half a ball at each end
    moved = kind["Ca"] * water
    sizes = np.abs(along), np.sqrt(np.clip(1.0 - along**2, 0.0, 1.0))
    return Lump(
        place=0.5 * (a + b),
        mass=mass,
        volume=section * length,
        inertia=inertia,
        added=moved * across + kind["CaEnd"] * ends * axis,
        added_inertia=moved * length**2 / 12.0 * np.diag(across),
        drag=kind["Cd"] * d * length * sizes[1] + 2.0 * kind["CdEnd"] * section * sizes[0],
        turning=kind["Cd"] * d * length**4 / 32.0 * sizes[1],
    )


def body_of(deck: Deck, frame: Frame, environment: Mapping[str, float]) -> dict[str, Any]:
    """A free frame with its parts, as a scene writes a body."""
    row, density = frame.row, environment["rho"]
    assert row is not None
    mass = math.fsum(lump.mass for lump in frame.lumps)
    if mass <= 0.0:
        deck.refuse(row, "Mass", f"{mass:g} in all, of what is free", "above 0")
        return {}
    centre = sum((lump.mass * lump.place for lump in frame.lumps), np.zeros(3)) / mass
    tensor = np.zeros((3, 3))
    for lump in frame.lumps:
        tensor += lump.inertia + lump.mass * _about(lump.place - centre)
    inertia = np.diag(tensor)
    products = float(np.abs(tensor - np.diag(inertia)).max())
    least, middle, most = sorted(inertia)
    if least <= 0.0 or most > (least + middle) * (1.0 + 1e-9):
        moments = ", ".join(f"{x:g}" for x in inertia)
        allowed = "above 0, none larger than the sum of the others"
        deck.refuse(row, "I", f"{moments} in all is that of no rigid body", allowed)
        return {}
    if products > _OFF_DIAGONAL * most:
        deck.left.append(f"products of inertia of {frame.name}: {products:.3g} kg m2")
    volume = math.fsum(lump.volume for lump in frame.lumps)
    floats = sum((lump.volume * lump.place for lump in frame.lumps), np.zeros(3))
    wet = floats / volume if volume else centre
    added = sum((lump.added for lump in frame.lumps), np.zeros((3, 3)))
    turned = np.zeros(3)
    for lump in frame.lumps:
        arm = _cross(lump.place - wet)
        turned += lump.added_inertia + np.diag(arm @ lump.added @ arm.T)
    body: dict[str, Any] = {"mass": mass}
    hull = _hull(deck, frame, volume)
    if hull:
        body["hull"] = hull
    else:
        body["submerged_weight"] = environment["g"] * (mass - density * volume)
    body |= {
        "inertia": _list(inertia),
        "centre_of_gravity": _list(centre),
        "centre_of_buoyancy": _list(wet),
        "centre_of_drag": _list(wet),
        "added_mass": _list(np.diag(added)),
        "added_inertia": _list(turned),
        "drag_area": _list(sum((lump.drag for lump in frame.lumps), np.zeros(3))),
        "drag_turning": _list(sum((lump.turning for lump in frame.lumps), np.zeros(3))),
        "points": dict(frame.points),
        **frame.motion,
    }
    return body


def _hull(deck: Deck, frame: Frame, volume: float) -> dict[str, Any]:
    """Of a body with one upright rod that leaves the water; empty where nothing leaves it."""
    out = [rod for rod in frame.rods if max(frame.world(end)[2] for end in rod[1:3]) > 0.0]
    if not out:
        if frame.rods:
            deck.left.append(f"the surface: rods of {frame.name} are in the water wherever it is")
        return {}
    row, a, b, diameter = out[0]
    length = float(np.linalg.norm(b - a))
    alone = math.isclose(math.pi / 4.0 * diameter**2 * length, volume, rel_tol=1e-9)
    upright = float(np.hypot(*(b - a)[:2])) <= _UPRIGHT * length
    if len(out) > 1 or not alone or not upright:
        problem = f"{frame.name} leaves the water, and is no single upright rod"
        deck.refuse(row, "Za, Zb", problem, "all ends below z = 0, or one rod along z that floats")
    return {"diameter": diameter, "height": length, "centre": _list(0.5 * (a + b))}


def _about(arm: FloatArray) -> FloatArray:
    """Moments of inertia (3, 3) of a unit mass at the end of an arm."""
    return np.asarray(float(arm @ arm) * np.eye(3) - np.outer(arm, arm), dtype=np.float64)


def _cross(arm: FloatArray) -> FloatArray:
    """The matrix (3, 3) of arm x."""
    x, y, z = arm
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _list(values: FloatArray) -> list[float]:
    return [float(value) + 0.0 for value in values]
