"""The vessel of a scene: where the tow point is, how it moves, and what its drum pays out."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import (
    AfterValidator,
    BeforeValidator,
    Field,
    ValidationInfo,
    field_validator,
    model_validator,
)
from pydantic.config import JsonDict

from cablemodel.errors import shown
from cablemodel.scene.base import (
    Angle,
    Duration,
    Length,
    Position,
    SceneModel,
    Seconds,
    Speed,
    Velocity,
    also,
    in_order_of,
)
from cablemodel.scene.line import Connection, LineItem
from cablemodel.scene.motion import VesselMotion
from cablemodel.scene.rows import Rows
from cablemodel.scene.tables import VELOCITIES, MotionInFile, velocity_from_file
from cablemodel.scene.units import Quantity, Vector, not_one_of, rejection

FloatArray = NDArray[np.float64]

_FILE_NAME = re.compile(r"\.[A-Za-z]\w{0,5}\s*$")
_SAME_HEADING = 1e-6
_STANDSTILL = 1e-9


class VelocityPoint(SceneModel):
    """Velocity of the tow point at one time."""

    t: Seconds = Field(description="time")
    velocity: Velocity = Field(description="velocity of the tow point")


Reader = Callable[[str, Any, str | None, tuple[str, ...]], tuple[FloatArray, FloatArray]]
"""Times and vectors from a file: tables.velocity_from_file, or another of its kind."""


def rows_over_time(
    value: Any, info: ValidationInfo, point: type[SceneModel], read: Reader, as_in: str
) -> Any:
    """Rows of a table of vectors over time from its short forms: one vector, or a file.

    point: a row, of t and the vector. as_in: an example of that.
    """
    key = next(name for name in point.model_fields if name != "t")
    if isinstance(value, np.ndarray) or (
        isinstance(value, (list, tuple))
        and value
        and not any(isinstance(item, (Mapping, SceneModel)) for item in value)
    ):
        (unit,) = point.model_fields[key].metadata
        return [{"t": 0.0, key: unit(value)}]
    allowed = f"a vector {as_in}, a list of {{t, {key}}}, or {{file: NAME}} with an optional topic"
    if isinstance(value, str) and _FILE_NAME.search(value):
        problem = f"{shown(value)} is a text; a file is named by {{file: {value}}}"
        raise rejection(problem, allowed, value)
    if isinstance(value, (str, int, float)):
        raise rejection(f"{shown(value)} is no vector", allowed, value)
    if not isinstance(value, Mapping):  # also rows that were read before
        return value
    if set(value) - {"file", "topic"} or not isinstance(value.get("file"), str):
        raise rejection(f"{shown(value)} is not understood", allowed, value)
    topic = value.get("topic")
    if topic is not None and not isinstance(topic, str):
        raise rejection(f"{shown(topic)} is not a text", "name of a topic", topic, ("topic",))
    times, vectors = read(value["file"], info.context, topic, ("file",))
    return Rows(point, {"t": times, key: vectors})


def _velocity_rows(value: Any, info: ValidationInfo) -> Any:
    example = "[x, y, z] in m/s, as [5 kn, 0, 0]"
    return rows_over_time(value, info, VelocityPoint, velocity_from_file, example)


def file_form(kind: MotionInFile) -> JsonDict:
    """Schema of {file, topic}."""
    types = [name.rpartition("/")[2] for name in kind.types]
    return {
        "type": "object",
        "properties": {
            "file": {
                "type": "string",
                "description": "instead of vector or table: a CSV file with the columns t, "
                f"{', '.join(kind.columns)} in SI, or an MCAP log with {kind.words}",
            },
            "topic": {
                "type": "string",
                "description": f"topic of the MCAP log, of {', '.join(types[:-1])} or {types[-1]}; "
                "needed where it has more than one",
            },
        },
        "required": ["file"],
        "additionalProperties": False,
    }


class Straight(SceneModel):
    """A straight leg at constant height."""

    duration: Duration | None = Field(default=None, description="how long; this or length")
    length: Length | None = Field(default=None, description="how far; this or duration")
    speed: Speed | None = Field(
        default=None,
        description="speed reached at the end of the leg, changing uniformly from that of the leg "
        "before; the first leg must have one and keeps it; later ones keep the last",
    )
    heading: Angle | None = Field(
        default=None,
        description="direction of travel, from x counter-clockwise; 0 in the first leg, else as "
        "the leg before ends (it may only be another one from standstill)",
    )

    @model_validator(mode="after")
    def _one_extent(self) -> Straight:
        if (self.duration is None) == (self.length is None):
            raise not_one_of(self, "duration", "length")
        return self


class Turn(SceneModel):
    """A leg on a circle at constant height."""

    angle: Angle = Field(description="change of heading; positive turns to port")
    radius: Length = Field(description="radius of the circle")
    speed: Speed | None = Field(default=None, description="as for a straight leg")
    heading: Angle | None = Field(default=None, description="heading at its start, as for straight")

    @field_validator("angle")
    @classmethod
    def _not_zero(cls, angle: float) -> float:
        if angle == 0.0:
            raise rejection("a turn by nothing", "an angle other than 0", angle)
        return angle


class Leg(SceneModel):
    """A leg of the vessel's path: straight or turn."""

    straight: Straight | None = Field(default=None, description="a straight leg")
    turn: Turn | None = Field(default=None, description="a leg on a circle")

    @model_validator(mode="after")
    def _one_of_them(self) -> Leg:
        if (self.straight is None) == (self.turn is None):
            raise not_one_of(self, "straight", "turn")
        return self


def _continuous(legs: tuple[Leg, ...]) -> tuple[Leg, ...]:
    """Refuse a path whose velocity would jump, or that never ends a leg."""
    if not legs:
        raise rejection("the path is empty", "at least one leg", legs)
    heading, speed = 0.0, 0.0
    for index, leg in enumerate(legs):
        kind = "straight" if leg.straight is not None else "turn"
        move = leg.straight or leg.turn
        assert move is not None
        first = index == 0
        if first and move.speed is None:
            raise rejection(
                "is missing", "the speed of the first leg", None, (index, kind, "speed")
            )
        if move.heading is not None:
            off = math.remainder(move.heading - heading, 2 * math.pi)
            if not first and speed > 0 and abs(off) > _SAME_HEADING:
                problem = (
                    f"heading {move.heading:g} rad, but the leg before ends at {heading:g} rad"
                )
                allowed = "the same heading, or none; turn changes it"
                raise rejection(problem, allowed, move.heading, (index, kind, "heading"))
            heading = move.heading if first or speed == 0 else heading
        reached = speed if move.speed is None else move.speed
        started = reached if first else speed
        timed = leg.straight is not None and leg.straight.duration is not None
        if not timed and started + reached < _STANDSTILL:
            problem = "a leg without speed never ends"
            allowed = "a speed above 0, or a straight with a duration"
            raise rejection(problem, allowed, reached, (index, kind))
        heading += leg.turn.angle if leg.turn is not None else 0.0
        speed = reached
    return legs


class Vessel(SceneModel):
    """The vessel, seen from the cable: a tow point that moves as prescribed."""

    position: Position = Field(
        default=(0.0, 0.0, 0.0), description="position of the tow point at t = 0"
    )
    connection: Connection = Field(
        default=Connection.model_validate("pinned"),
        description="how the cable is held: pinned, or clamped in a direction",
    )
    velocity: Annotated[
        Rows[VelocityPoint] | None,
        AfterValidator(in_order_of("t")),
        BeforeValidator(_velocity_rows),
    ] = Field(
        default=None,
        description="velocity of the tow point: one vector, a table over time that holds its first "
        "and last value, or a file: CSV with the columns t, vx, vy, vz in SI, or MCAP with an "
        "Odometry or TwistStamped topic; none: at rest",
        json_schema_extra=also(Vector("m/s").json_schema(), file_form(VELOCITIES)),
    )
    interpolation: Literal["linear", "cubic"] = Field(
        default="linear",
        description="between the rows of velocity; cubic has a continuous acceleration",
    )
    path: Annotated[tuple[Leg, ...], AfterValidator(_continuous)] | None = Field(
        default=None,
        description="instead of velocity: legs of a track at constant height; the velocity of its "
        "end goes on",
    )

    @model_validator(mode="after")
    def _one_motion(self) -> Vessel:
        if self.velocity is not None and self.path is not None:
            raise rejection("velocity and path exclude each other", "velocity or path")
        return self

    def motion(self) -> VesselMotion:
        """The prescribed motion of the tow point."""
        if self.path is not None:
            return VesselMotion.from_path(self.path, self.position)
        if self.velocity is None:
            return VesselMotion.from_table([0.0], [(0.0, 0.0, 0.0)], self.position)
        table = self.velocity
        return VesselMotion.from_table(
            table.column("t"), table.column("velocity"), self.position, self.interpolation
        )


class RatePoint(SceneModel):
    """Pay-out rate at one time."""

    t: Seconds = Field(description="time")
    rate: Annotated[float, Quantity("m/s")] = Field(
        description="unstretched cable a second; positive out, negative in"
    )


def _rate_rows(value: Any) -> Any:
    if isinstance(value, (int, float, str)):
        return [{"t": 0.0, "rate": Quantity("m/s")(value)}]
    return value


RateTable = Annotated[
    tuple[RatePoint, ...], AfterValidator(in_order_of("t")), BeforeValidator(_rate_rows)
]
"""Speed of a winch: one number, or a table over time."""


class Payout(SceneModel):
    """The winch: how fast it pays out, and what its drum still holds."""

    rate: RateTable = Field(
        default=(RatePoint(t=0.0, rate=0.0),),
        description="speed at which cable, or a body of finite length, passes the tow point: one "
        "number, or a table over time, linear between its rows, that holds its first and last "
        "value",
        json_schema_extra=also(Quantity("m/s").json_schema()),
    )
    drum: tuple[LineItem, ...] = Field(
        default=(),
        description="cables and bodies on the drum, as in line, vessel end first; the last one is "
        "a cable",
    )
