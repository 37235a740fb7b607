"""The scene of a system: vessels with points, free bodies, lines between them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from cablemodel.errors import SceneProblem, shown
from cablemodel.scene import sea
from cablemodel.scene.base import Duration, Length, Position, SceneModel, UnitVector, also
from cablemodel.scene.environment import Environment, Floor
from cablemodel.scene.line import Cable, CableType, LineItem
from cablemodel.scene.problems import suggestion
from cablemodel.scene.schema import Document, RunSettings, Solver
from cablemodel.scene.units import Quantity, rejection, several
from cablemodel.scene.vessel import RatePoint, RateTable
from cablemodel.systems.free_bodies import FreeBody
from cablemodel.systems.vessel_frames import VesselFrame

ON_FLOOR = 1e-3
"""Of the length of a line: gap between its anchor and the floor below which that lies there."""
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


class LineEnd(SceneModel):
    """Where a line begins or ends: exactly one of point, anchor, line; free without any."""

    point: Annotated[str, Field(strict=True)] | None = Field(
        default=None, description="a vessel's or body's point: NAME.POINT"
    )
    anchor: Position | None = Field(default=None, description="a place where it is held")
    line: Annotated[str, Field(strict=True)] | None = Field(
        default=None, description="another line, of which this is a branch"
    )
    at: Length | None = Field(default=None, description="arc length of the branch on that line")
    clamped: UnitVector | None = Field(
        default=None,
        description="at a point: direction of the line there, from its beginning to its end, in "
        "the axes of the vessel or body",
    )

    @property
    def is_free(self) -> bool:
        """Nothing holds it."""
        return self.point is None and self.anchor is None and self.line is None

    @property
    def owner(self) -> str:
        """The vessel or body at whose point it is; empty: at none."""
        return (self.point or "").partition(".")[0]

    @property
    def of_owner(self) -> str:
        """The point's name there."""
        return (self.point or "").partition(".")[2]

    @model_validator(mode="after")
    def _one_of_them(self) -> LineEnd:
        given = [key for key in ("point", "anchor", "line") if getattr(self, key) is not None]
        if len(given) > 1:
            raise rejection(f"{' and '.join(given)} exclude each other", "one of them")
        if (self.line is None) != (self.at is None):
            raise rejection("line and at belong together", "both or none")
        if self.clamped is not None and self.point is None:
            allowed = "a point with clamped; for an anchor that of a vessel which does not move"
            raise rejection("only a point holds a clamp", allowed)
        return self


def _end(value: Any) -> Any:
    if isinstance(value, str):
        return {} if value == "free" else {"point": value}
    return value


class SystemLine(SceneModel):
    """Cables and point bodies between two ends."""

    start: Annotated[LineEnd, BeforeValidator(_end)] = Field(
        alias="from",
        description="where it begins: NAME.POINT, free, or a mapping",
        json_schema_extra=also({"type": "string"}),
    )
    end: Annotated[LineEnd, BeforeValidator(_end)] = Field(
        alias="to",
        description="where it ends: NAME.POINT, free, or a mapping",
        json_schema_extra=also({"type": "string"}),
    )
    items: tuple[LineItem, ...] = Field(description="cables and point bodies along it")

    @property
    def length(self) -> float:
        """Unstretched [m]."""
        return math.fsum(item.cable.length for item in self.items if item.cable is not None)

    @property
    def ends(self) -> tuple[LineEnd, LineEnd]:
        """Both."""
        return self.start, self.end

    def end_at(self, side: Literal["start", "end"]) -> LineEnd:
        """One of them."""
        return self.start if side == "start" else self.end

    def arc_at(self, place: Literal["start", "end"] | float) -> float:
        """Arc length of an end, or of a place that is given by it [m]."""
        if isinstance(place, float):
            return place
        return 0.0 if place == "start" else self.length


def _end_or_arc(value: Any) -> Any:
    """Of what is neither, one problem is told instead of one for each."""
    if isinstance(value, str) and value in ("start", "end"):
        return value
    try:
        return Quantity("m", above=0)(value)
    except PydanticCustomError as error:
        told = error.context or {}
        allowed = f"start, end, or {told['allowed']}"
        problem = told["problem"] + suggestion(value, ["start", "end"])
        raise rejection(problem, allowed, value) from None


class Cut(SceneModel):
    """A place where a line is cut, let go or breaks; what is cut off goes on by itself.

    By a command at any time; also at ``time``, and above ``tension``, where these are given.
    """

    line: Annotated[str, Field(strict=True)] = Field(description="name of the line")
    at: Annotated[
        Literal["start", "end"] | Length,
        Field(union_mode="left_to_right"),
        BeforeValidator(_end_or_arc),
    ] = Field(description="arc length from its beginning, or start or end: there it is let go")
    time: Duration | None = Field(default=None, description="when")
    tension: Annotated[float, Quantity("N", above=0)] | None = Field(
        default=None, description="above which it breaks there"
    )


_AS_IN_THE_LINE = ""
"""Type of a cable on a drum of which only the length is given."""
_DRUM = Quantity("m", at_least=0)


def _wound(value: Any) -> Any:
    if isinstance(value, (int, float, str)):
        length = _DRUM(value)
        return [{"cable": {"type": _AS_IN_THE_LINE, "length": length}}] if length > 0.0 else []
    return value


class SystemWinch(SceneModel):
    """A winch at a vessel's point, where a line begins or ends."""

    line: Annotated[str, Field(strict=True)] = Field(description="name of the line")
    at: Literal["start", "end"] = Field(default="start", description="which end of it")
    rate: RateTable = Field(
        default=(RatePoint(t=0.0, rate=0.0),),
        description="speed at which it pays out, negative: reels in; one number, or a table over "
        "time, linear between its rows, that holds its first and last value; at t = 0 a line over "
        "a floor that is tied to nothing else starts as a lay, or as it is taken up, with its far "
        "end free or at an anchor on the floor",
        json_schema_extra=also(Quantity("m/s").json_schema()),
    )
    drum: Annotated[tuple[LineItem, ...], BeforeValidator(_wound)] = Field(
        default=(),
        description="cables and point bodies on the drum in the order in which they leave it, the "
        "last one a cable; or one length, of the cable at that end of the line",
        json_schema_extra=also(_DRUM.json_schema()),
    )

    @property
    def drum_cables(self) -> list[Cable]:
        """The cables on the drum at t = 0, in the order in which they leave it."""
        return [item.cable for item in self.drum if item.cable is not None]

    @property
    def drum_length(self) -> float:
        """Cable on the drum at t = 0 [m]."""
        return math.fsum(cable.length for cable in self.drum_cables)

    def wound_with(self, like: Cable) -> SystemWinch:
        """The same with a cable on the drum in place of a length."""
        drum = tuple(
            LineItem(cable=like.model_copy(update={"length": item.cable.length, "elements": None}))
            if item.cable is not None and item.cable.type == _AS_IN_THE_LINE
            else item
            for item in self.drum
        )
        return self.model_copy(update={"drum": drum})

    @property
    def rate_at_start(self) -> float:
        """At t = 0 [m/s]; an empty drum pays out nothing."""
        rate = float(np.interp(0.0, [row.t for row in self.rate], [row.rate for row in self.rate]))
        return rate if self.drum_length > 0.0 else min(rate, 0.0)


class SystemScene(Document):
    """A scene of several lines, vessels and bodies, in SI units, checked and unchangeable."""

    title: Annotated[str, Field(strict=True)] = Field(default="", description="what it shows")
    environment: Environment = Field(default=Environment(), description="what surrounds it")
    cable_types: dict[str, CableType] = Field(min_length=1, description="kinds of cable by name")
    vessels: dict[str, VesselFrame] = Field(
        default_factory=dict, description="vessels and driven ends by name"
    )
    bodies: dict[str, FreeBody] = Field(default_factory=dict, description="free bodies by name")
    lines: dict[str, SystemLine] = Field(min_length=1, description="lines by name")
    cuts: dict[str, Cut] = Field(
        default_factory=dict, description="places where lines are cut, let go or break, by name"
    )
    winches: dict[str, SystemWinch] = Field(
        default_factory=dict, description="winches at vessels' points, by name"
    )
    solver: Solver = Field(default=Solver(), description="how the scene is computed")
    run: RunSettings = Field(default=RunSettings(), description="length of a run and its output")

    @property
    def cables(self) -> list[Cable]:
        """All cables, line by line."""
        items = (item for line in self.lines.values() for item in line.items)
        return [item.cable for item in items if item.cable is not None]

    @property
    def drum_cables(self) -> list[Cable]:
        """All cables on drums at t = 0."""
        return [cable for winch in self.winches.values() for cable in winch.drum_cables]

    def cuts_along(self, line: str) -> list[float]:
        """Arc lengths between the ends of a line at which it may be cut, in order [m]."""
        places = (cut.at for cut in self.cuts.values() if cut.line == line)
        return sorted({place for place in places if isinstance(place, float)})

    def joints_along(self, line: str) -> list[float]:
        """Arc lengths from where a line begins now at which tension or slope may jump, in order
        [m]: cuts, branches, bodies, and where another cable begins, on drums too."""
        places = {*self.cuts_along(line)}
        ends = (end for other in self.lines.values() for end in other.ends)
        places |= {end.at for end in ends if end.line == line and end.at is not None}
        arc = 0.0
        for item in self.lines[line].items:
            arc += item.cable.length if item.cable is not None else 0.0
            places.add(arc)
        places -= {0.0, arc}
        for winch in self.winches.values():
            if winch.line != line:
                continue
            way, place = (-1.0, 0.0) if winch.at == "start" else (1.0, arc)
            for item in winch.drum:
                places.add(place)
                place += way * item.cable.length if item.cable is not None else 0.0
        return sorted(places)

    def held_with(self, line: str) -> list[str]:
        """Where vessels and anchors hold a line, and all that is tied to it: names of the ends."""
        tied, todo = {line}, [line]
        while todo:
            name = todo.pop()
            own = self._ties(name)
            more = {other for other in self.lines if other not in tied and own & self._ties(other)}
            todo += more
            tied |= more
        return [
            f"{name}'s {word}"
            for name in self.lines
            if name in tied
            for word, end in zip(("beginning", "end"), self.lines[name].ends, strict=True)
            if end.anchor is not None or end.owner in self.vessels
        ]

    def runs_alone(self, name: str) -> bool:
        """Whether a winch runs at t = 0, over a sea floor within reach, and its line is tied to
        nothing but its vessel's point and, it may be, an anchor on the floor."""
        winch, floor = self.winches[name], self.environment.floor
        line = self.lines[winch.line]
        other = line.end if winch.at == "start" else line.start
        branches = (end.line for each in self.lines.values() for end in each.ends)
        if winch.rate_at_start == 0.0 or floor is None or winch.line in branches:
            return False
        if other.anchor is not None:
            x, y, z = other.anchor
            return z <= floor.height(x, y) + ON_FLOOR * line.length
        end = line.end_at(winch.at)
        return other.is_free and self._may_reach(floor, end, line.length)

    def _may_reach(self, floor: Floor, end: LineEnd, length: float) -> bool:
        """Whether a line may touch the floor that hangs from a vessel's point, however that is
        turned."""
        vessel = self.vessels.get(end.owner)
        if vessel is None or end.of_owner not in vessel.points:
            return False  # what is reported
        x, y, z = vessel.position
        arm = math.hypot(*vessel.points[end.of_owner])
        slope, top = 0.0, float(np.max(floor.grid_z)) if floor.z is None else floor.height(x, y)
        if floor.z is not None:
            slope = math.hypot(*floor.slope)
        return z - top - arm * (1.0 + slope) < length * math.hypot(1.0, slope)

    def _ties(self, line: str) -> set[str]:
        """Names of a line, and of the bodies and lines at its ends."""
        ends = self.lines[line].ends
        bodies = {end.owner for end in ends} & set(self.bodies)
        return {line, *bodies, *(end.line for end in ends if end.line is not None)}

    @property
    def starts_at_rest(self) -> bool:
        """Always: other starts are none of a system's."""
        return True

    def lines_at(self, body: str) -> list[str]:
        """Names of the lines that are attached to a body."""
        points = {f"{body}.{point}" for point in self.bodies[body].points}
        return [
            name
            for name, line in self.lines.items()
            if any(end.point in points for end in line.ends)
        ]

    @property
    def place(self) -> tuple[float, float, float]:
        """Where it is: the first vessel at t = 0, else the first anchor [m]."""
        for vessel in self.vessels.values():
            return vessel.position
        ends = (end for line in self.lines.values() for end in line.ends)
        return next((end.anchor for end in ends if end.anchor is not None), (0.0, 0.0, 0.0))

    @property
    def line_length(self) -> float:
        """Unstretched length of the longest line [m]."""
        return max(line.length for line in self.lines.values())

    @model_validator(mode="after")
    def _consistent(self) -> SystemScene:
        density, gravity = self.environment.water_density, self.environment.gravity
        for name, kind in list(self.cable_types.items()):
            self.cable_types[name] = kind.resolved(density, gravity)
        for name, winch in list(self.winches.items()):
            line = self.lines.get(winch.line)
            cables = [] if line is None else [item.cable for item in line.items if item.cable]
            if cables:
                self.winches[name] = winch.wound_with(cables[0 if winch.at == "start" else -1])
        problems = list(self._problems())
        if problems:
            raise several(problems)
        return self

    def _problems(self) -> Iterator[SceneProblem]:
        named: dict[str, str] = {}
        if self.solver.method != "finite_element":
            problem = f"{self.solver.method} computes one line below one point"
            yield SceneProblem("solver.method", self.solver.method, problem, "finite_element")
        for kind in ("vessels", "bodies", "lines", "cuts", "winches"):
            for name in getattr(self, kind):
                if name in named:
                    problem = f"one of {named[name]} has this name"
                    yield SceneProblem(f"{kind}.{name}", name, problem, "another one")
                if not _NAME.fullmatch(name):
                    problem = f"{shown(name)} is no name"
                    allowed = "letters, digits and _, a letter first: it stands in topics"
                    yield SceneProblem(f"{kind}.{name}", name, problem, allowed)
                named.setdefault(name, kind)
        yield from self._names_of_parts()
        used: set[str] = set()
        for name, line in self.lines.items():
            path = f"lines.{name}"
            if not any(item.cable for item in line.items):
                yield SceneProblem(f"{path}.items", None, "no cable", "at least one cable")
            yield from self._item_problems(f"{path}.items", line.items)
            for index, item in enumerate(line.items):
                at = f"{path}.items.{index}"
                ends_item = index in (0, len(line.items) - 1)
                if item.body is not None and ends_item and line.ends[index != 0].point is not None:
                    problem = "a body where the line is attached"
                    yield SceneProblem(at, None, problem, "cable at an attached end")
            for word, end in (("from", line.start), ("to", line.end)):
                yield from self._end_problems(name, f"{path}.{word}", end, used)
        for name in self.bodies:
            if name not in used:
                problem = "no line is attached to it"
                yield SceneProblem(
                    f"bodies.{name}", name, problem, f"a line from or to {name}.POINT"
                )
        yield from sea.problems(self)
        for name, vessel in self.vessels.items():
            if vessel.raos and self.environment.waves is None:
                problem = "there are no waves that it could answer"
                yield SceneProblem(f"vessels.{name}.raos", len(vessel.raos), problem, "waves")
        yield from self._floor_problems()
        yield from self._cut_problems()
        yield from self._winch_problems()

    def _names_of_parts(self) -> Iterator[SceneProblem]:
        """Names of points and foils that are none."""
        groups: list[tuple[str, Iterable[str]]] = [
            (f"{kind}.{name}.points", part.points)
            for kind, parts in (("vessels", self.vessels), ("bodies", self.bodies))
            for name, part in parts.items()
        ]
        groups += [(f"bodies.{name}.foils", body.foils) for name, body in self.bodies.items()]
        for path, names in groups:
            for name in names:
                if not _NAME.fullmatch(name):
                    problem = f"{shown(name)} is no name"
                    allowed = "letters, digits and _, a letter first"
                    yield SceneProblem(f"{path}.{name}", name, problem, allowed)

    def _item_problems(self, path: str, items: Sequence[LineItem]) -> Iterator[SceneProblem]:
        """Of what is in a line or on a drum."""
        for index, item in enumerate(items):
            at = f"{path}.{index}"
            if item.cable is not None and item.cable.type not in self.cable_types:
                problem = f"{shown(item.cable.type)} is not one of the cable types"
                known = ", ".join(self.cable_types)
                yield SceneProblem(f"{at}.cable.type", item.cable.type, problem, known)
            if item.body is not None and item.body.half_length > 0.0:
                problem = "a body with length in a line of a system"
                allowed = "a body of its own in bodies, or half_length: 0"
                length = item.body.half_length
                yield SceneProblem(f"{at}.body.half_length", length, problem, allowed)
            if index > 0 and item.body is not None and items[index - 1].body is not None:
                yield SceneProblem(at, None, "two bodies in a row", "a cable between them")

    def _cut_problems(self) -> Iterator[SceneProblem]:
        for name, cut in self.cuts.items():
            path = f"cuts.{name}"
            line = self.lines.get(cut.line)
            if line is None:
                problem = f"{shown(cut.line)} is not one of the lines"
                yield SceneProblem(f"{path}.line", cut.line, problem, ", ".join(self.lines))
                continue
            if isinstance(cut.at, float) and not cut.at < line.length:
                problem = f"{cut.line} is {line.length:g} m long"
                allowed = f"above 0 and below {line.length:g} m, or start or end"
                yield SceneProblem(f"{path}.at", cut.at, problem, allowed)
            end = None if isinstance(cut.at, float) else line.end_at(cut.at)
            if end is not None and end.is_free:
                problem = f"{cut.line} is free there"
                yield SceneProblem(f"{path}.at", cut.at, problem, "an end that is held")
            owner = "" if end is None else end.owner
            if end is not None and end.clamped is not None and owner in self.vessels:
                problem = "a vessel does not let go of a clamped end"
                yield SceneProblem(f"{path}.at", cut.at, problem, "a place beside it, in metres")

    def _winch_problems(self) -> Iterator[SceneProblem]:
        taken: dict[tuple[str, str], str] = {}
        for name, winch in self.winches.items():
            path = f"winches.{name}"
            line = self.lines.get(winch.line)
            if line is None:
                problem = f"{shown(winch.line)} is not one of the lines"
                yield SceneProblem(f"{path}.line", winch.line, problem, ", ".join(self.lines))
                continue
            end = line.end_at(winch.at)
            owner = end.owner
            if owner not in self.vessels:
                problem = f"{winch.line} is not held by a vessel at its {winch.at}"
                yield SceneProblem(f"{path}.at", winch.at, problem, "an end at a vessel's point")
            yield from self._item_problems(f"{path}.drum", winch.drum)
            if winch.drum and winch.drum[-1].body is not None:
                last = f"{path}.drum.{len(winch.drum) - 1}"
                yield SceneProblem(last, None, "a body is wound up last", "a cable last")
            if end.clamped is not None:
                problem = "cable that runs past a clamp is not computed in a system"
                yield SceneProblem(f"{path}.at", winch.at, problem, "an end without clamped")
            held = self.held_with(winch.line)
            if winch.rate_at_start != 0.0 and len(held) > 1 and not self.runs_alone(name):
                problem = f"what hangs on it is held at {' and '.join(held)}: nothing moves along"
                allowed = "0 m/s at t = 0, or a line that goes to an anchor on the floor alone"
                yield SceneProblem(f"{path}.rate", winch.rate_at_start, problem, allowed)
            other = taken.setdefault((winch.line, winch.at), name)
            if other != name:
                problem = f"{other} is at this end of {winch.line}"
                yield SceneProblem(f"{path}.at", winch.at, problem, "one winch at an end")

    def _floor_problems(self) -> Iterator[SceneProblem]:
        """Anchors and vessels' points below the floor at t = 0."""
        floor = self.environment.floor
        if floor is None:
            return
        for name, line in self.lines.items():
            for word, end in (("from", line.start), ("to", line.end)):
                if end.anchor is None:
                    continue
                height = floor.height(end.anchor[0], end.anchor[1])
                if end.anchor[2] < height - ON_FLOOR * line.length:
                    problem = "it lies below the sea floor"
                    allowed = f"z of at least {height:g} m there"
                    yield SceneProblem(f"lines.{name}.{word}.anchor", end.anchor, problem, allowed)
        for name, vessel in self.vessels.items():
            for point, place in vessel.places_at_start().items():
                x, y, z = map(float, place)
                height = floor.height(x, y)
                if z < height - ON_FLOOR * self.line_length:
                    problem = f"it is at z = {z:g} m at t = 0, below the sea floor"
                    allowed = f"z of at least {height:g} m there, with position and attitude"
                    own, at = vessel.points[point], f"vessels.{name}.points.{point}"
                    yield SceneProblem(at, own, problem, allowed)

    def _end_problems(
        self, name: str, path: str, end: LineEnd, used: set[str]
    ) -> Iterator[SceneProblem]:
        if end.point is not None:
            owner, point = end.owner, end.of_owner
            used.add(owner)  # also where the point is not: that is told once
            places = self.vessels.get(owner) or self.bodies.get(owner)
            if places is None or point not in places.points:
                points = [
                    f"{other}.{key}"
                    for group in (self.vessels, self.bodies)
                    for other, part in group.items()
                    for key in part.points
                ]
                problem = f"{shown(end.point)} is no point of a vessel or body"
                yield SceneProblem(path, end.point, problem, ", ".join(points) or "a point")
                return
        if end.line is not None:
            other = self.lines.get(end.line)
            if other is None or end.line == name:
                problem = f"{shown(end.line)} is not another line"
                known = ", ".join(key for key in self.lines if key != name)
                yield SceneProblem(f"{path}.line", end.line, problem, known)
            elif end.at is not None and not 0.0 < end.at < other.length:
                problem = (
                    f"a branch at {end.at:g} m of {end.line}, which is {other.length:g} m long"
                )
                allowed = f"between 0 and {other.length:g} m, not at its ends"
                yield SceneProblem(f"{path}.at", end.at, problem, allowed)
