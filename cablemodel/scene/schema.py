"""The scene as a whole: its parts together, and what must hold between them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import (
    Field,
    PrivateAttr,
    ValidationInfo,
    field_validator,
    model_serializer,
    model_validator,
)

from cablemodel.errors import SceneProblem, shown
from cablemodel.scene import sea
from cablemodel.scene.base import Duration, Length, SceneModel, Vector3
from cablemodel.scene.environment import Environment
from cablemodel.scene.line import Body, Cable, CableType, End, Initial, LineItem
from cablemodel.scene.motion import VesselMotion
from cablemodel.scene.text import dump_yaml, uncollected
from cablemodel.scene.units import Quantity, rejection, several
from cablemodel.scene.vessel import Payout, Vessel

_SAME_PLACE = 1e-3
"""Of the line's length: a start that misses the tow point or anchor by more is a mistake."""

_LEAST_STRETCH = 0.05
"""Stretch of a line to its anchor that is always accepted."""

_BREAKING_STRESS = 0.5e9
"""Over the full section [Pa]: what stretches by more than 5 % is fibre rope, and breaks here."""

_SHORTEST_BODY = 1e-6
"""Of the line's length: a body's direction follows from the places of its two ends."""

_FINITE_ELEMENT_ONLY = (
    "tolerance",
    "accuracy",
    "accuracy_of",
    "error_estimate",
    "start_time_limit",
)
_DIRECT_ONLY = (
    "time_step",
    "node_spacing",
    "alpha",
    "relative_tolerance",
    "joint",
    "bending_length",
    "linear_solver",
)


class Solver(SceneModel):
    """How the scene is computed."""

    method: Literal["finite_element", "direct_integration"] = Field(
        default="finite_element",
        description="finite_element for all scenes, or direct_integration, the method of 1998",
    )
    tolerance: Annotated[float, Quantity(above=0, below=1)] = Field(
        default=1e-3,
        description="finite_element: positions are right within this times the line's length, "
        "tensions within ten times this times the largest",
    )
    accuracy: Annotated[float | None, Quantity(above=0, below=1)] = Field(
        default=None,
        description="finite_element: the tolerance whose promise is asked of the run, where it is "
        "computed at a finer one to keep that; by default the tolerance",
    )
    accuracy_of: Literal["all", "positions"] = Field(
        default="all",
        description="finite_element: what is asked to be so accurate: positions and the top "
        "tension, or positions alone, as where jerks make a stiff line ring along itself",
    )
    error_estimate: bool = Field(
        default=False,
        description="finite_element: say what positions and the top tension may be wrong by, from "
        "a run at a quarter of the tolerance beside this one",
    )
    start_time_limit: Duration = Field(
        default=60.0,
        description="finite_element: how long a static start may be sought, in seconds of the "
        "clock; what is not found by then is an error that says what was tried",
    )
    time_step: Duration = Field(default=1.0, description="direct_integration: time step")
    node_spacing: Length = Field(default=1.0, description="direct_integration: distance of nodes")
    alpha: Annotated[float, Quantity(at_least=0.5, at_most=1)] = Field(
        default=1.0,
        description="direct_integration: 1 is backward Euler, 0.5 the trapezoidal rule",
    )
    relative_tolerance: Annotated[float, Quantity(above=0, below=1)] = Field(
        default=0.01, description="direct_integration: of the Newton iteration"
    )
    joint: Literal["paper", "moment_free"] = Field(
        default="moment_free",
        description="direct_integration: condition at the joint of the hybrid model",
    )
    bending_length: Length = Field(
        default=5.0,
        description="direct_integration: length of the part of a hybrid that bends, at a free end, "
        "on the floor or at a clamp",
    )
    linear_solver: Literal["superposition", "elimination"] = Field(
        default="superposition",
        description="direct_integration: how the linear systems along the cable are solved, by the "
        "superposition of initial value problems as in 1998 or by elimination",
    )

    @model_validator(mode="after")
    def _settings_of_the_method(self) -> Solver:
        direct = self.method == "direct_integration"
        for key in _FINITE_ELEMENT_ONLY if direct else _DIRECT_ONLY:
            if key in self.model_fields_set:
                problem = f"{self.method} has no such setting"
                allowed = ", ".join(_DIRECT_ONLY if direct else _FINITE_ELEMENT_ONLY)
                raise rejection(problem, allowed, getattr(self, key), (key,))
        if self.accuracy is not None and self.accuracy < self.tolerance:
            problem = f"finer than the tolerance of {self.tolerance:g}, which is all that is kept"
            raise rejection(problem, "the tolerance or more", self.accuracy, ("accuracy",))
        return self

    @property
    def promised(self) -> float:
        """What errors are judged by: positions within this times the line's length."""
        return self.tolerance if self.accuracy is None else self.accuracy

    @property
    def asked(self) -> str:
        """The same in words."""
        name = "a tolerance" if self.accuracy is None else "an accuracy"
        return f"{name} of {self.promised:g}"

    @model_serializer
    def as_written(self) -> dict[str, Any]:
        """The settings of the chosen method only."""
        keys: tuple[str, ...] = _DIRECT_ONLY
        if self.method == "finite_element":
            asked = {
                "accuracy": self.accuracy is not None,
                "accuracy_of": self.accuracy_of != "all",
                "error_estimate": self.error_estimate,
                "start_time_limit": self.start_time_limit != 60.0,
            }
            keys = ("tolerance", *(key for key, given in asked.items() if given))
        return {"method": self.method, **{key: getattr(self, key) for key in keys}}


class RunSettings(SceneModel):
    """How long a run takes and how often its state is kept."""

    duration: Duration = Field(default=60.0, description="simulated time")
    output_interval: Duration = Field(default=0.5, description="time between logged states")


def longest_stretch(kind: CableType) -> float:
    """Stretched over unstretched length of a cable just before any cable breaks."""
    strongest = _BREAKING_STRESS * math.pi / 4 * kind.diameter**2
    powers = enumerate(kind.strain_coefficients, start=1)
    stretch = math.fsum(c * strongest**power for power, c in powers)
    return 1.0 + max(_LEAST_STRETCH, stretch)


class Document(SceneModel):
    """What stands in a scene file as a whole, of one line or of a system."""

    _source_text: str | None = PrivateAttr(default=None)
    _source_path: str | None = PrivateAttr(default=None)
    _notes: tuple[str, ...] = PrivateAttr(default=())

    @property
    def source_text(self) -> str | None:
        """The YAML text as it was read, before any override; None for a scene from a mapping."""
        return self._source_text

    @property
    def source_path(self) -> str | None:
        """The file that it was read from; None for a scene from text or a mapping."""
        return self._source_path

    @property
    def notes(self) -> tuple[str, ...]:
        """What was chosen when it was read, where the scene leaves a doubt."""
        return self._notes

    def to_dict(self) -> dict[str, Any]:
        """The scene in SI as plain data, files resolved; it loads again to an equal scene."""
        with uncollected():
            return self.model_dump(mode="json", by_alias=True, exclude_none=True)

    def to_yaml(self) -> str:
        """The scene in SI as YAML text, files resolved; it loads again to an equal scene. With a
        table of more than 1000 rows it is JSON, which is YAML too."""
        return dump_yaml(self.to_dict())

    def __eq__(self, other: object) -> bool:
        """Equal content, wherever it was read from."""
        return isinstance(other, type(self)) and self.to_dict() == other.to_dict()

    __hash__ = None  # type: ignore[assignment]


class Scene(Document):
    """A scene: everything that a simulation needs, in SI units, checked and unchangeable."""

    title: Annotated[str, Field(strict=True)] = Field(default="", description="what it shows")
    environment: Environment = Field(default=Environment(), description="what surrounds the cable")
    cable_types: dict[str, CableType] = Field(
        min_length=1, description="kinds of cable by name: what a metre of each is like"
    )
    line: tuple[LineItem, ...] = Field(description="cables and bodies from the vessel outwards")
    end: End = Field(default=End.model_validate("free"), description="the far end of the line")
    initial: Initial = Field(
        default=Initial.model_validate("static"),
        description="the cable at t = 0; static: at rest, or in steady tow",
    )
    vessel: Vessel = Field(default=Vessel(), description="the motion of the tow point")
    payout: Payout = Field(default=Payout(), description="the winch")
    solver: Solver = Field(default=Solver(), description="how the scene is computed")
    run: RunSettings = Field(default=RunSettings(), description="length of a run and its output")

    _motion: tuple[Vessel, VesselMotion] | None = PrivateAttr(default=None)

    @field_validator("cable_types")
    @classmethod
    def _with_submerged_weight(
        cls, types: dict[str, CableType], info: ValidationInfo
    ) -> dict[str, CableType]:
        environment = info.data.get("environment")
        if environment is None:  # it has an error of its own, which is reported
            return types
        density, gravity = environment.water_density, environment.gravity
        return {name: kind.resolved(density, gravity) for name, kind in types.items()}

    @model_validator(mode="after")
    def _consistent(self) -> Scene:
        problems = [
            *self._line_problems(),
            *self._start_problems(),
            *self._reach_problems(),
            *self._floor_problems(),
            *sea.problems(self),
        ]
        if problems:
            raise several(problems)
        return self

    def _line_problems(self) -> Iterator[SceneProblem]:
        known = ", ".join(self.cable_types)
        for part, items in (("line", self.line), ("payout.drum", self.payout.drum)):
            for index, item in enumerate(items):
                if item.cable is not None and item.cable.type not in self.cable_types:
                    problem = f"{shown(item.cable.type)} is not one of the cable types"
                    path = f"{part}.{index}.cable.type"
                    yield SceneProblem(path, item.cable.type, problem, known)
                if index > 0 and item.body is not None and items[index - 1].body is not None:
                    problem = "two bodies in a row"
                    yield SceneProblem(f"{part}.{index}", None, problem, "a cable between them")
            yield from self._length_problems(part, items)
        if not any(item.cable is not None for item in self.line):
            yield SceneProblem("line", None, "there is no cable in the line", "at least one cable")
        elif self.line[0].body is not None:
            allowed = "a cable first: a body at the tow point cannot move"
            yield SceneProblem("line.0", None, "the line begins with a body", allowed)
        if self.end.anchor is not None and self.line and self.line[-1].body is not None:
            allowed = "a cable last, or end: free"
            yield SceneProblem("end", None, "the last body would be anchored", allowed)

    def _length_problems(self, part: str, items: Sequence[LineItem]) -> Iterator[SceneProblem]:
        """Bodies that are longer than a cable next to them, or too short for their length."""
        shortest = _SHORTEST_BODY * self.line_length
        for index, item in enumerate(items):
            if item.body is None or item.body.half_length == 0.0:
                continue
            half = item.body.half_length
            path = f"{part}.{index}.body.half_length"
            neighbours = [*items[max(index - 1, 0) : index], *items[index + 1 : index + 2]]
            if index == 0 and part == "payout.drum":
                neighbours += self.line[:1]  # the cable that is out is next to it
            lengths = [beside.cable.length for beside in neighbours if beside.cable is not None]
            room = min(lengths, default=math.inf)
            if 2.0 * half > room:
                problem = f"the body is {2.0 * half:g} m long, the cable next to it {room:g} m"
                yield SceneProblem(path, half, problem, f"at most {0.5 * room:g} m")
            if 2.0 * half < shortest:
                problem = "too short against the line to turn as a rigid body"
                allowed = f"0 (a point body), or at least {0.5 * shortest:g} m"
                yield SceneProblem(path, half, problem, allowed)

    def _start_problems(self) -> Iterator[SceneProblem]:
        start, anchor = self.vessel.position, self.end.anchor
        reach = _SAME_PLACE * max(self._span, 1e-9)
        if self.initial.points is not None:
            ends = [("0", self.initial.points[0], start, "the tow point, vessel.position")]
            if anchor is not None:
                last = str(len(self.initial.points) - 1)
                ends.append((last, self.initial.points[-1], anchor, "the anchor, end.anchor"))
            for index, point, place, name in ends:
                if math.dist(point, place) > reach:
                    problem = f"the shape is {math.dist(point, place):g} m away from its end"
                    yield SceneProblem(f"initial.points.{index}", point, problem, name)
        speed, given = self._speed_at_start, self.initial.velocities
        rests = given == "rest" or (isinstance(given, tuple) and not any(map(any, given)))
        if rests and speed > 0.0:
            problem = f"the tow point moves at {speed:g} m/s and would jerk a cable at rest along"
            allowed = "steady, or a velocity for each of points"
            yield SceneProblem("initial.velocities", given, problem, allowed)
        if self.initial.velocities == "steady" and anchor is not None and speed > 0.0:
            problem = f"the tow point moves at {speed:g} m/s away from an anchor"
            yield SceneProblem("initial.velocities", "steady", problem, "one for each of points")
        if self.initial.straight is not None and anchor is not None:
            along = self.initial.straight
            far = tuple(s + self._span * a for s, a in zip(start, along, strict=True))
            if math.dist(far, anchor) > reach:
                problem = f"a straight line would end {math.dist(far, anchor):g} m from the anchor"
                yield SceneProblem("initial.straight", along, problem, "a line that ends there")

    def _reach_problems(self) -> Iterator[SceneProblem]:
        """An anchor so far away that the line would break: a slip in a coordinate or a length."""
        anchor = self.end.anchor
        if anchor is None:
            return
        reach = 2.0 * math.fsum(body.half_length for body in self.bodies)
        for cable in self.cables:
            kind = self.cable_types.get(cable.type)
            if kind is None:  # reported as an unknown type
                return
            reach += cable.length * longest_stretch(kind)
        distance = math.dist(self.vessel.position, anchor)
        if distance > reach:
            problem = f"{distance:g} m from the vessel, out of reach of {self._span:g} m of line"
            allowed = f"at most {reach:g} m away: the line stretched as far as any cable bears"
            yield SceneProblem("end.anchor", anchor, problem, allowed)

    def _floor_problems(self) -> Iterator[SceneProblem]:
        floor = self.environment.floor
        if floor is None:
            return
        places: list[tuple[str, Vector3]] = [("vessel.position", self.vessel.position)]
        if self.end.anchor is not None:
            places.append(("end.anchor", self.end.anchor))
        places += [
            (f"initial.points.{index}", point)
            for index, point in enumerate(self.initial.points or ())
        ]
        reach = _SAME_PLACE * max(self._span, 1e-9)
        for path, (x, y, z) in places:
            height = floor.height(x, y)
            depth = height - z
            if depth > reach:
                problem = f"{depth:g} m below the sea floor"
                if height > 0.0:
                    problem += (
                        f", which is at z = {height:g} m there, above the water: z is up, and a "
                        "floor in 100 m of water has z = -100"
                    )
                yield SceneProblem(path, (x, y, z), problem, f"z of at least {z + depth:g} m")

    @property
    def _span(self) -> float:
        """Unstretched length of cables and bodies together [m]."""
        return self.line_length + sum(2 * body.half_length for body in self.bodies)

    @property
    def cables(self) -> list[Cable]:
        """The cables that are out at t = 0, from the vessel outwards."""
        return [item.cable for item in self.line if item.cable is not None]

    @property
    def drum_cables(self) -> list[Cable]:
        """The cables on the drum at t = 0, vessel end first."""
        return [item.cable for item in self.payout.drum if item.cable is not None]

    @property
    def line_and_drum(self) -> tuple[LineItem, ...]:
        """All cables and bodies: those that are out, then those on the drum."""
        return (*self.line, *self.payout.drum)

    @property
    def bodies(self) -> list[Body]:
        """The bodies that are out at t = 0, from the vessel outwards."""
        return [item.body for item in self.line if item.body is not None]

    def body_names(self, count: int) -> list[str]:
        """Names of the outermost bodies, those on the drum among them, from the vessel outwards;
        empty where one has none."""
        items = (*self.payout.drum, *self.line)
        names = [item.body.name or "" for item in items if item.body is not None]
        return names[-count:] if count else []

    @property
    def line_length(self) -> float:
        """Total unstretched length of the cables that are out at t = 0 [m]."""
        return math.fsum(cable.length for cable in self.cables)

    @property
    def place(self) -> Vector3:
        """Where it is: the tow point at t = 0 [m]."""
        return self.vessel.position

    def motion(self) -> VesselMotion:
        """The prescribed motion of the tow point, made once."""
        kept = self._motion
        if kept is None or kept[0] is not self.vessel:
            kept = self._motion = self.vessel, self.vessel.motion()
        return kept[1]

    @property
    def rate_at_start(self) -> float:
        """Pay-out rate just after t = 0 [m/s]; a table holds its first value before it begins.

        An empty drum pays out nothing.
        """
        rates = self.payout.rate
        if not rates:
            return 0.0
        rate = float(np.interp(0.0, [row.t for row in rates], [row.rate for row in rates]))
        return rate if self.payout.drum else min(rate, 0.0)

    @property
    def starts_at_rest(self) -> bool:
        """Whether it starts in equilibrium."""
        return self.initial.kind == "static"

    @property
    def starts_steady(self) -> bool:
        """Whether a start from points takes the motion of a steady lay or tow."""
        if self.initial.points is None or self.end.anchor is not None:
            return False
        if self.initial.velocities is not None:
            return self.initial.velocities == "steady"
        moves = bool(np.any(self.motion().evaluate(0.0)[1]))
        return moves and self.environment.floor is not None and self.rate_at_start > 0.0

    def rest_under_way(self) -> str:
        """What to know of a line that starts at rest under a tow point that moves; else empty."""
        speed = self._speed_at_start
        if self.starts_at_rest or self.initial.velocities is not None or speed == 0.0:
            return ""
        finite_element = self.solver.method == "finite_element"
        straight = self.initial.points is None
        if finite_element and (self.starts_steady or (straight and self.rate_at_start != 0.0)):
            return ""
        shape = "initial.straight starts" if straight else "initial.points start"
        steadily = self.end.anchor is None
        if steadily and (straight or not finite_element):
            instead = "initial: static starts"
        elif steadily:
            instead = "velocities: steady, or one for each of points, start"
        else:
            instead = "initial.points with velocities, one for each, start"
        return (
            f"{shape} at rest under a tow point that moves at {speed:g} m/s: the line is jerked "
            f"along, and its first tensions are those of the jerk; {instead} with its motion"
        )

    @property
    def _speed_at_start(self) -> float:
        """Of the tow point [m/s]."""
        return math.hypot(*(float(part) for part in self.motion().evaluate(0.0)[1]))
