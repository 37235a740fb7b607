"""The line of a scene: cable types, cables and bodies from the vessel outwards, and its far end."""

from __future__ import annotations

import itertools
import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field, field_validator, model_serializer, model_validator
from pydantic_core import PydanticCustomError

from cablemodel.scene.base import (
    Coefficient,
    Length,
    Position,
    SceneModel,
    UnitVector,
    Vector3,
    Velocity,
    WordOrMapping,
)
from cablemodel.scene.units import Count, Quantity, not_one_of, rejection

_LARGEST_DEGREE = 8
_SUBMERGED_UNKNOWN = math.nan
_SAME_POINT = 1e-9
"""Of a line through points: as near as rounding brings two that were meant to be one."""

PositiveNewtons = Annotated[float, Quantity("N", above=0)]


class CableType(SceneModel):
    """What a metre of unstretched cable is like."""

    diameter: Length = Field(description="outer diameter")
    mass: Annotated[float, Quantity("kg/m", above=0)] = Field(description="mass per length in air")
    submerged_weight: Annotated[float, Quantity("N/m")] = Field(
        default=_SUBMERGED_UNKNOWN,
        description="weight per length in water (negative: it floats)",
        json_schema_extra=lambda schema: schema.update(default="from mass and diameter"),
    )
    axial_stiffness: PositiveNewtons | None = Field(
        default=None, description="EA; this or tension_strain must be given"
    )
    tension_strain: tuple[float, ...] | None = Field(
        default=None,
        description="coefficients c1, c2, ... [1/N^k] of strain = c1 T + c2 T^2 + ..., "
        "instead of axial_stiffness; its tangents continue the curve below T = 0, and beyond the "
        "tension at which its slope has fallen to a tenth of c1: what a curve does that bends over "
        "further, or turns down, is not computed",
        json_schema_extra=lambda schema: schema.update(
            anyOf=[
                {
                    "type": "array",
                    "items": {"anyOf": [{"type": "number"}, {"type": "string"}]},
                    "minItems": 1,
                    "maxItems": _LARGEST_DEGREE,
                },
                {"type": "null"},
            ]
        ),
    )
    axial_damping: Annotated[float, Quantity("N*s", at_least=0)] = Field(
        default=0.0, description="BA, force over the rate of strain"
    )
    bending_stiffness: Annotated[float, Quantity("N*m**2", at_least=0)] = Field(
        default=0.0, description="EI"
    )
    drag_normal: Coefficient = Field(
        default=1.0, description="normal drag coefficient Cdn, on the diameter"
    )
    drag_tangential: Coefficient = Field(
        default=0.01,
        description="tangential drag coefficient Cdt, on the circumference: it multiplies pi times "
        "the diameter (divide by pi a coefficient that is meant for the diameter)",
    )
    added_mass: Coefficient = Field(
        default=1.0, description="added-mass coefficient Ca of normal motion"
    )

    @field_validator("tension_strain", mode="before")
    @classmethod
    def _coefficients(cls, value: Any) -> Any:
        if value is None:
            return None
        allowed = f"1 to {_LARGEST_DEGREE} numbers [c1, c2, ...], c1 above 0"
        if not isinstance(value, (list, tuple)) or not 1 <= len(value) <= _LARGEST_DEGREE:
            raise rejection("not a list of coefficients", allowed, value)
        coefficients = []
        for index, item in enumerate(value):
            try:
                coefficients.append(Quantity(f"1/N**{index + 1}")(item))
            except PydanticCustomError as error:
                context = error.context or {}
                raise rejection(context["problem"], context["allowed"], item, (index,)) from None
        if not coefficients[0] > 0:
            problem = "the strain does not grow with tension at zero tension"
            raise rejection(problem, allowed, value[0], (0,))
        return tuple(coefficients)

    @model_validator(mode="after")
    def _one_strain_law(self) -> CableType:
        if (self.axial_stiffness is None) == (self.tension_strain is None):
            raise not_one_of(self, "axial_stiffness", "tension_strain")
        return self

    @property
    def strain_coefficients(self) -> tuple[float, ...]:
        """c1, c2, ... [1/N^k] of strain(T) = c1 T + c2 T^2 + ... (the paper's eq. 21)."""
        if self.tension_strain is not None:
            return self.tension_strain
        assert self.axial_stiffness is not None
        return (1.0 / self.axial_stiffness,)

    def typical_weight(self, gravity: float) -> float:
        """Size of its weight in water, of what floats a thousandth of that in air [N/m]."""
        return max(abs(self.submerged_weight), 1e-3 * self.mass * gravity)

    def resolved(self, water_density: float, gravity: float) -> CableType:
        """The same type with its submerged weight as a number."""
        if not math.isnan(self.submerged_weight):
            return self
        area = math.pi / 4 * self.diameter**2
        weight = (self.mass - water_density * area) * gravity
        return self.model_copy(update={"submerged_weight": weight})


class Cable(SceneModel):
    """A length of one type of cable."""

    type: Annotated[str, Field(strict=True)] = Field(description="one of cable_types")
    length: Length = Field(description="unstretched length")
    model: Literal["elastica", "cable", "hybrid"] = Field(
        default="hybrid",
        description="elastica: bends everywhere; cable: perfectly flexible; "
        "hybrid: bends where tension is low",
    )
    elements: Annotated[int, Count(1, 1_000_000)] | None = Field(
        default=None, description="number of elements, for studies; else the tolerance decides"
    )


def _along_the_axis(body: dict[str, Any], across: str, otherwise: float) -> float:
    """What is left out along the axis of a body, from its fields before: those that are wrong are
    missing, and refused anyway."""
    value = body.get(across, otherwise) if body.get("half_length") == 0.0 else otherwise
    return float(value)


class Body(SceneModel):
    """A rigid body of revolution in the line or at its end.

    Drag depends on half_length. At 0 it is 1/2 rho |u| (CdA_n u_n + CdA_a u_a), by the whole
    relative speed |u|, with the cable's direction for the axis: with equal areas that of a sphere.
    Above 0 it is 1/2 rho (CdA_n |u_n| u_n + CdA_a |u_a| u_a), of each part by itself (cross-flow
    principle), with an axis of its own. The two differ wherever water comes askew, however short
    the body is.
    """

    name: Annotated[str, Field(strict=True)] | None = Field(
        default=None, description="what outputs call it"
    )
    mass: Annotated[float, Quantity("kg", above=0)] = Field(description="mass in air")
    submerged_weight: Annotated[float, Quantity("N")] = Field(
        description="weight in water (negative: it floats)"
    )
    half_length: Annotated[float, Quantity("m", at_least=0)] = Field(
        default=0.0,
        description="half of the length between its attachments, which is no longer than the "
        "cables next to it; 0 is a point, whose drag follows another law (above)",
    )
    centre_offset: Annotated[float, Quantity(at_least=-1, at_most=1)] = Field(
        default=0.0,
        description="place of the centre of gravity, in half lengths from the middle, "
        "away from the vessel",
    )
    rotary_inertia: Annotated[float, Quantity("kg*m**2", at_least=0)] = Field(
        default=0.0,
        description="about a cross axis through the centre of gravity, with the water's share",
    )
    added_mass: Annotated[float, Quantity("kg", at_least=0)] = Field(
        default=0.0, description="of motion across the axis; acts, like drag, at the middle"
    )
    added_mass_axial: Annotated[float, Quantity("kg", at_least=0)] = Field(
        default=0.0, description="of motion along the axis"
    )
    drag_area: Annotated[float, Quantity("m**2", at_least=0)] = Field(
        default=0.0,
        description="area for drag across the axis, which this times drag_coefficient makes "
        "CdA_n; the law depends on half_length (above)",
    )
    drag_coefficient: Coefficient = Field(default=1.0, description="of drag across the axis")
    drag_area_axial: Annotated[float, Quantity("m**2", at_least=0)] = Field(
        default_factory=lambda body: _along_the_axis(body, "drag_area", 0.0),
        description="area for drag along the axis, which this times drag_coefficient_axial makes "
        "CdA_a; by default drag_area of a point, which has no axis, and 0 of a body with length",
        json_schema_extra=lambda schema: schema.update(default="drag_area of a point, else 0"),
    )
    drag_coefficient_axial: Coefficient = Field(
        default_factory=lambda body: _along_the_axis(body, "drag_coefficient", 1.0),
        description="of drag along the axis; by default drag_coefficient of a point, and 1 of a "
        "body with length",
        json_schema_extra=lambda schema: schema.update(
            default="drag_coefficient of a point, else 1"
        ),
    )


class LineItem(SceneModel):
    """A cable or a body: exactly one of them."""

    cable: Cable | None = Field(default=None, description="a length of cable")
    body: Body | None = Field(default=None, description="a body in the line or at its end")

    @model_validator(mode="after")
    def _one_of_them(self) -> LineItem:
        if (self.cable is None) == (self.body is None):
            raise not_one_of(self, "cable", "body")
        return self


class Connection(WordOrMapping):
    """How an end of the line is held: pinned (free to turn) or clamped in a direction."""

    clamped: UnitVector | None = Field(
        default=None,
        description="direction in which the cable leaves the vessel, or arrives at the anchor, "
        "from the vessel outwards; fixed in space; a perfectly flexible cable passes no moment",
    )

    word: ClassVar = "pinned"
    keys: ClassVar = ("clamped",)

    @property
    def kind(self) -> Literal["pinned", "clamped"]:
        """The word of the scene file."""
        return "pinned" if self.clamped is None else "clamped"

    @property
    def direction(self) -> Vector3 | None:
        """Unit vector along the cable from the vessel outwards; None where pinned."""
        return self.clamped

    @model_serializer
    def _as_written(self) -> Any:
        return "pinned" if self.clamped is None else {"clamped": list(self.clamped)}


class End(WordOrMapping):
    """The far end of the line."""

    anchor: Position | None = Field(default=None, description="place where the end is held")
    connection: Connection = Field(
        default=Connection.model_validate("pinned"),
        description="how the end is held: pinned, or clamped in a direction",
    )

    word: ClassVar = "free"
    keys: ClassVar = ("anchor",)

    @model_validator(mode="after")
    def _held_only_at_an_anchor(self) -> End:
        if self.anchor is None and "connection" in self.model_fields_set:
            raise rejection("a free end is not held", "anchor with the connection")
        return self

    @property
    def kind(self) -> Literal["free", "anchor"]:
        """The word of the scene file."""
        return "free" if self.anchor is None else "anchor"

    @property
    def position(self) -> Vector3 | None:
        """Where the end is anchored [m]; None where it is free."""
        return self.anchor

    @model_serializer
    def _as_written(self) -> Any:
        if self.anchor is None:
            return "free"
        return {"anchor": list(self.anchor), "connection": self.connection._as_written()}


class Initial(WordOrMapping):
    """The cable at t = 0."""

    straight: UnitVector | None = Field(
        default=None, description="direction of a straight, unstretched cable at rest"
    )
    points: tuple[Position, ...] | None = Field(
        default=None,
        description="points of the shape from the vessel to the end, the first one the tow point; "
        "a smooth curve through them, unstretched where it may be as long as the cable",
    )
    velocities: Literal["rest", "steady"] | tuple[Velocity, ...] | None = Field(
        default=None,
        description="of the points: rest; one of the material at each point; or steady, where the "
        "points are what the steady lay or tow is sought from; by default steady under a vessel "
        "that moves and pays out, else rest",
    )

    word: ClassVar = "static"
    keys: ClassVar = ("straight", "points")

    @model_validator(mode="after")
    def _two_different_points(self) -> Initial:
        if self.points is not None:
            if len(self.points) < 2:
                raise rejection("too few points", "at least two", at=("points",))
            chords = [math.dist(a, b) for a, b in itertools.pairwise(self.points)]
            for index, chord in enumerate(chords, start=1):
                if chord <= _SAME_POINT * math.fsum(chords):
                    problem = "the same point twice in a row"
                    raise rejection(problem, "different points", at=("points", index))
        if self.velocities is not None and self.points is None:
            raise rejection("velocities without points", "points", at=("velocities",))
        if isinstance(self.velocities, tuple) and len(self.velocities) != len(self.points or ()):
            allowed = f"{len(self.points or ())}, one for each of points"
            raise rejection(f"{len(self.velocities)} velocities", allowed, at=("velocities",))
        return self

    @property
    def kind(self) -> Literal["static", "straight", "points"]:
        """The word of the scene file."""
        if self.straight is not None:
            return "straight"
        return "static" if self.points is None else "points"

    @property
    def direction(self) -> Vector3 | None:
        """Unit vector from the vessel outwards; None unless straight."""
        return self.straight

    @model_serializer
    def _as_written(self) -> Any:
        if self.straight is not None:
            return {"straight": list(self.straight)}
        if self.points is not None:
            written: dict[str, Any] = {"points": [list(point) for point in self.points]}
            if isinstance(self.velocities, tuple):
                written["velocities"] = [list(velocity) for velocity in self.velocities]
            elif self.velocities is not None:
                written["velocities"] = self.velocities
            return written
        return "static"
