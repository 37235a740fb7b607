"""Bodies of a system, in six degrees of freedom, with their hulls and foils."""

from __future__ import annotations

import math
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, model_validator
from pydantic.config import JsonDict

from cablemodel.scene.base import Coefficient, Length, Position, SceneModel, UnitVector, also
from cablemodel.scene.depth_table import monotone_slopes
from cablemodel.scene.environment import Environment
from cablemodel.scene.units import Quantity, Vector, not_one_of, rejection
from cablemodel.solvers.shared.curves import hermite
from cablemodel.systems.vessel_frames import SAME_RESPONSE, Attitude

FloatArray = NDArray[np.float64]

ALONG_CHORD = 1e-6
"""Sine between chord and span of a foil that is none."""
STALL_BEGINS, STALL_LASTS = 0.75, 0.5
"""Of the stall angle: where the flow begins to part, and within what it has."""
WING_ROWS = 361
"""Of a thin wing's table: one a degree."""
INERTIA_ROUNDED = 1e-9
"""Of a moment of inertia: by what rounding may make it larger than the sum of the others."""
_Number = Annotated[float, Quantity()]
_ONE: tuple[JsonDict, ...] = ({"type": "number"}, {"type": "string"})
FoilRow = tuple[_Number, _Number, Coefficient]
"""Angle of attack [degrees], lift and drag coefficient."""


class Foil(SceneModel):
    """A wing of a body: lift along chord x span, drag along the flow, by its angle of attack."""

    position: Position = Field(default=(0.0, 0.0, 0.0), description="where its forces act")
    area: Annotated[float, Quantity("m**2", above=0)] = Field(description="of its planform")
    chord: UnitVector = Field(default=(1.0, 0.0, 0.0), description="towards its leading edge")
    span: UnitVector = Field(
        default=(0.0, 1.0, 0.0), description="along its leading edge; it lifts along chord x span"
    )
    aspect_ratio: Annotated[float, Quantity(above=0)] = Field(
        default=6.0, description="of a thin wing: span squared over area"
    )
    stall: Annotated[float, Quantity("rad", above=0, at_most=math.pi / 2)] = Field(
        default=math.radians(15.0), description="angle of attack at which it stalls"
    )
    drag: Coefficient = Field(default=0.01, description="drag coefficient without lift")
    deflection: Annotated[float, Quantity("rad", at_least=-math.pi, at_most=math.pi)] = Field(
        default=0.0, description="angle by which it is turned about its span, leading edge up"
    )
    table: tuple[FoilRow, ...] | None = Field(
        default=None,
        description="instead of a thin wing: rows of angle of attack in degrees, lift and drag "
        "coefficient, from -180 to 180; between them cubics that overshoot nowhere (PCHIP)",
    )

    @model_validator(mode="after")
    def _span_across(self) -> Foil:
        if np.linalg.norm(np.cross(self.chord, self.span)) < ALONG_CHORD:
            allowed = "a span across the chord"
            raise rejection("along the chord: it lifts nowhere", allowed, self.span, ("span",))
        return self

    @model_validator(mode="after")
    def _table_in_order(self) -> Foil:
        if self.table is None:
            return self
        angles, at = [row[0] for row in self.table], ("table",)
        allowed = "angles that rise from -180 to 180 degrees"
        if not angles:
            raise rejection("it has no rows", f"rows of {allowed}", self.table, at)
        if angles[0] != -180.0 or angles[-1] != 180.0 or np.any(np.diff(angles) <= 0.0):
            raise rejection("angles out of order", allowed, angles, at)
        first, last = self.table[0][1:], self.table[-1][1:]
        if not np.allclose(first, last, rtol=SAME_RESPONSE, atol=SAME_RESPONSE):
            problem = "lift and drag at -180 degrees, {:g} and {:g}, are others than at 180, {:g} "
            problem = (problem + "and {:g}").format(*first, *last)
            raise rejection(problem, "the same at both: it is one angle", None, at)
        return self

    def coefficients(self, angles: FloatArray) -> FloatArray:
        """Lift and drag coefficients (n, 2) at angles of attack (n,) [rad], from -pi to pi."""
        rows = self.rows()
        found, _slope = hermite(angles, rows[:, 0], rows[:, 1::2].T, rows[:, 2::2].T)
        return found.T

    def rows(self) -> FloatArray:
        """The coefficients as solvers have them: angle of attack [rad], lift, its derivative
        [1/rad], drag, its derivative, (n, 5); cubic between rows."""
        if self.table is None:
            angles = np.linspace(-math.pi, math.pi, WING_ROWS)
            values = self._thin_wing(angles)
            ahead, behind = np.roll(values[:-1], -1, axis=0), np.roll(values[:-1], 1, axis=0)
            slopes = (ahead - behind) / (2.0 * (angles[1] - angles[0]))
            slopes = np.concatenate([slopes, slopes[:1]])
        else:
            given = np.array(self.table)
            angles, values = np.radians(given[:, 0]), given[:, 1:]
            slopes = monotone_slopes(angles, values)
        columns = angles, values[:, 0], slopes[:, 0], values[:, 1], slopes[:, 1]
        return np.column_stack(columns)

    def _thin_wing(self, angles: FloatArray) -> FloatArray:
        """Lift and drag coefficients (n, 2) of a thin wing at angles of attack (n,) [rad].

        Of finite span (lifting-line theory) up to the stall; beyond it a flat plate across the
        flow, with two quarters of the stall angle in between.
        """
        slope = 2.0 * math.pi * self.aspect_ratio / (self.aspect_ratio + 2.0)
        folded = np.arcsin(np.sin(angles))  # flow from behind meets a plate alike
        lift = slope * np.sin(folded) * np.cos(folded)
        drag = self.drag + lift**2 / (math.pi * self.aspect_ratio)
        normal = 2.0 * np.sin(folded)
        plate = np.column_stack([normal * np.cos(folded), self.drag + normal * np.sin(folded)])
        x = np.clip((np.abs(folded) / self.stall - STALL_BEGINS) / STALL_LASTS, 0.0, 1.0)
        stalled = (x * x * (3.0 - 2.0 * x))[:, None]
        wing = np.column_stack([lift, drag])
        found = wing + stalled * (plate - wing)
        found[:, 0] *= np.sign(np.cos(angles))
        return np.asarray(found, dtype=np.float64)


def _three(value: Any) -> Any:
    """One number for all three axes."""
    if isinstance(value, (int, float, str)) and not isinstance(value, bool):
        return [value, value, value]
    return value


class Hull(SceneModel):
    """A ball, or a cylinder about the body's z axis, that floats at the surface or below it."""

    diameter: Length = Field(description="of ball or cylinder")
    height: Length | None = Field(default=None, description="of a cylinder; none: a ball")
    centre: Position = Field(default=(0.0, 0.0, 0.0), description="place of its middle")

    @property
    def volume(self) -> float:
        """[m3]."""
        if self.height is None:
            return math.pi / 6.0 * self.diameter**3
        return 0.25 * math.pi * self.diameter**2 * self.height


class FreeBody(SceneModel):
    """A rigid body with six degrees of freedom; places and axes are its own."""

    mass: Annotated[float, Quantity("kg", above=0)] = Field(description="mass in air")
    submerged_weight: Annotated[float, Quantity("N")] | None = Field(
        default=None,
        description="weight in water (negative: it floats); of a body with a hull that of its mass "
        "and of the water that the whole hull displaces",
    )
    hull: Hull | None = Field(
        default=None,
        description="what displaces water: a shape that may leave it; added mass and inertia, and "
        "drag, are given for all of it under water: at the surface they have its wet share",
    )
    inertia: Annotated[tuple[float, float, float], Vector("kg*m**2"), BeforeValidator(_three)] = (
        Field(
            description="moments of inertia about the axes through the centre of gravity, "
            "without the water's; one number for all three",
            json_schema_extra=also(*_ONE),
        )
    )
    centre_of_gravity: Position = Field(default=(0.0, 0.0, 0.0), description="its place")
    centre_of_buoyancy: Position = Field(
        default=(0.0, 0.0, 0.0), description="place of buoyancy and added mass"
    )
    centre_of_drag: Position = Field(default=(0.0, 0.0, 0.0), description="where drag acts")
    added_mass: Annotated[tuple[float, float, float], Vector("kg"), BeforeValidator(_three)] = (
        Field(
            default=(0.0, 0.0, 0.0),
            description="of motion along its axes",
            json_schema_extra=also(*_ONE),
        )
    )
    added_inertia: Annotated[
        tuple[float, float, float], Vector("kg*m**2"), BeforeValidator(_three)
    ] = Field(
        default=(0.0, 0.0, 0.0),
        description="of turning about its axes",
        json_schema_extra=also(*_ONE),
    )
    drag_area: Annotated[tuple[float, float, float], Vector("m**2"), BeforeValidator(_three)] = (
        Field(
            default=(0.0, 0.0, 0.0),
            description="drag coefficient times area of flow along its axes; the law is "
            "1/2 rho |u| CdA u",
            json_schema_extra=also(*_ONE),
        )
    )
    drag_turning: Annotated[tuple[float, float, float], Vector("m**5"), BeforeValidator(_three)] = (
        Field(
            default=(0.0, 0.0, 0.0),
            description="of turning: the moment is 1/2 rho times this times the angular velocity "
            "squared",
            json_schema_extra=also(*_ONE),
        )
    )
    points: dict[str, Position] = Field(
        default_factory=dict, description="places at which lines are attached"
    )
    foils: dict[str, Foil] = Field(default_factory=dict, description="wings")
    feet: tuple[Position, ...] | None = Field(
        default=None, description="places that touch the sea floor; by default its points"
    )
    position: Position | None = Field(
        default=None,
        description="at t = 0, where the start is sought from; on the sea floor, where friction "
        "holds it",
    )
    attitude: Attitude = Field(
        default=(0.0, 0.0, 0.0), description="roll, pitch and yaw from which a start is sought"
    )

    @model_validator(mode="after")
    def _weight_or_hull(self) -> FreeBody:
        if (self.submerged_weight is None) == (self.hull is None):
            raise not_one_of(self, "submerged_weight", "hull")
        return self

    def place(self, point: str) -> tuple[float, float, float]:
        """Of a point by its name, in the body's axes; without one, of the origin [m]."""
        return self.points[point] if point else (0.0, 0.0, 0.0)

    def weight_in(self, environment: Environment) -> float:
        """Its weight in water, wholly submerged [N]."""
        if self.submerged_weight is not None:
            return self.submerged_weight
        assert self.hull is not None
        mass = self.mass - environment.water_density * self.hull.volume
        return mass * environment.gravity

    @model_validator(mode="after")
    def _inertia_of_a_body(self) -> FreeBody:
        a = sorted(self.inertia)
        if a[0] <= 0.0 or a[2] > a[0] + a[1] + INERTIA_ROUNDED * a[2]:
            allowed = "above 0, none larger than the sum of the others"
            raise rejection("not of a rigid body", allowed, self.inertia, ("inertia",))
        return self
