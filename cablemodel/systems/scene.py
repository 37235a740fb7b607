"""The scene of a system: vessels with points, free bodies, lines between them."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Iterator, Sequence
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
from pydantic_core import PydanticCustomError

from cablemodel.errors import SceneProblem, shown
from cablemodel.scene import sea
from cablemodel.scene.base import (
    Coefficient,
    Duration,
    Length,
    Position,
    SceneModel,
    Seconds,
    UnitVector,
    also,
    in_order_of,
)
from cablemodel.scene.depth_table import monotone_slopes
from cablemodel.scene.environment import Environment, Floor
from cablemodel.scene.line import Cable, CableType, Connection, LineItem
from cablemodel.scene.problems import suggestion
from cablemodel.scene.rows import Rows
from cablemodel.scene.schema import Document, RunSettings, Solver
from cablemodel.scene.tables import ATTITUDES, attitudes_from_file, rows_from_file
from cablemodel.scene.units import Quantity, Vector, not_one_of, rejection, several
from cablemodel.scene.vessel import RatePoint, RateTable, Vessel, file_form, rows_over_time
from cablemodel.solvers.shared.curves import hermite
from cablemodel.systems.motion import axes_of, first_angles, first_turn

FloatArray = NDArray[np.float64]

ON_FLOOR = 1e-3
"""Of the length of a line: gap between its anchor and the floor below which that lies there."""
_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")

Attitude = Annotated[tuple[float, float, float], Vector("rad")]
ALONG_CHORD = 1e-6
"""Sine between chord and span of a foil that is none."""
STALL_BEGINS, STALL_LASTS = 0.75, 0.5
"""Of the stall angle: where the flow begins to part, and within what it has."""
WING_ROWS = 361
"""Of a thin wing's table: one a degree."""
SAME_RESPONSE = 1e-6
"""By what rounding may make responses or coefficients differ that are the same."""
INERTIA_ROUNDED = 1e-9
"""Of a moment of inertia: by what rounding may make it larger than the sum of the others."""


class RaoPoint(SceneModel):
    """How a vessel answers a wave of 1 m amplitude, of one period and heading.

    Amplitudes and phases of the displacements of its origin, in degrees where the name says so. A
    response is amplitude times cos(w t + phase) where the wave there is cos(w t).
    """

    heading_deg: Annotated[float, Quantity()] = Field(
        description="where the waves go to, from the vessel's bow: 0 from astern, 180 head sea"
    )
    period: Duration = Field(description="of the wave")
    surge: Coefficient = Field(default=0.0, description="[m/m]")
    surge_phase_deg: Annotated[float, Quantity()] = Field(default=0.0, description="its phase")
    sway: Coefficient = Field(default=0.0, description="[m/m]")
    sway_phase_deg: Annotated[float, Quantity()] = Field(default=0.0, description="its phase")
    heave: Coefficient = Field(default=0.0, description="[m/m]")
    heave_phase_deg: Annotated[float, Quantity()] = Field(default=0.0, description="its phase")
    roll_deg: Coefficient = Field(default=0.0, description="degrees per metre")
    roll_phase_deg: Annotated[float, Quantity()] = Field(default=0.0, description="its phase")
    pitch_deg: Coefficient = Field(default=0.0, description="degrees per metre")
    pitch_phase_deg: Annotated[float, Quantity()] = Field(default=0.0, description="its phase")
    yaw_deg: Coefficient = Field(default=0.0, description="degrees per metre")
    yaw_phase_deg: Annotated[float, Quantity()] = Field(default=0.0, description="its phase")

    @property
    def response(self) -> NDArray[np.complex128]:
        """Surge, sway, heave [m/m], roll, pitch and yaw [rad/m] with their phases (6,)."""
        names = ("surge", "sway", "heave", "roll_deg", "pitch_deg", "yaw_deg")
        phases = [name.removesuffix("_deg") + "_phase_deg" for name in names]
        sizes = np.array([getattr(self, name) for name in names]) * [1, 1, 1, *(math.pi / 180,) * 3]
        return sizes * np.exp(1j * np.radians([getattr(self, phase) for phase in phases]))


class AttitudePoint(SceneModel):
    """Attitude of a vessel at one time."""

    t: Seconds = Field(description="time")
    attitude: Attitude = Field(description="roll, pitch and yaw")


def _attitude_rows(value: Any, info: ValidationInfo) -> Any:
    example = "[roll, pitch, yaw] in rad, as [0, 5 deg, 0]"
    return rows_over_time(value, info, AttitudePoint, attitudes_from_file, example)


def _rao_rows(value: Any, info: ValidationInfo) -> Any:
    if isinstance(value, str):
        given = ("heading_deg", "period")
        more = tuple(key for key in RaoPoint.model_fields if key not in given)
        return rows_from_file(value, info.context, given, more)
    return value


class VesselFrame(Vessel):
    """A vessel, or a driven end: a rigid frame that moves as prescribed, with named points.

    ``position``, ``velocity`` and ``path`` are those of its origin. Along a path its x axis keeps
    to the track, and its yaw rate changes over ``turn_time``.
    """

    position: Position = Field(
        default=(0.0, 0.0, 0.0), description="position of its origin at t = 0"
    )
    connection: Connection = Field(
        default=Connection.model_validate("pinned"),
        description="pinned: a line is clamped where it begins or ends, by clamped there",
    )
    attitude: Annotated[
        Rows[AttitudePoint] | None,
        AfterValidator(in_order_of("t")),
        BeforeValidator(_attitude_rows),
    ] = Field(
        default=None,
        description="roll, pitch and yaw about its axes, R = Rz Ry Rx: one vector, a table over "
        "time that holds its first and last value, twice differentiable, or a file: CSV with the "
        "columns t, roll, pitch, yaw in SI, or MCAP with an Odometry, PoseStamped or Imu topic; "
        "along a path yaw is added to the heading; none: 0",
        json_schema_extra=also(Vector("rad").json_schema(), file_form(ATTITUDES)),
    )
    turn_time: Duration | None = Field(
        default=None,
        description="in which its yaw rate changes along a path, half of it before a turn begins "
        "or ends: the heading is that of the track, averaged over it; by default 4 s, or twice "
        "the time before the first turn where that is less",
    )
    points: dict[str, Position] = Field(
        default_factory=dict, description="places of its fairleads, in its own axes"
    )
    raos: Annotated[tuple[RaoPoint, ...], BeforeValidator(_rao_rows)] = Field(
        default=(),
        description="how the scene's waves move it on top of that: a CSV file with the columns of "
        "the rows, or these; of headings from 0 to 180 the others are mirror images",
        json_schema_extra=also({"type": "string"}),
    )

    def places_at_start(self) -> dict[str, FloatArray]:
        """Places of its points at t = 0 (3,) [m], by name."""
        axes = axes_of(first_angles(self))
        return {name: np.array(self.position) + axes @ own for name, own in self.points.items()}

    @field_validator("connection")
    @classmethod
    def _pinned(cls, connection: Connection) -> Connection:
        if connection.clamped is not None:
            allowed = "pinned; from: {point: VESSEL.POINT, clamped: [x, y, z]} of a line"
            raise rejection("lines have clamps, not the vessel", allowed)
        return connection

    @model_validator(mode="after")
    def _turns_in_time(self) -> VesselFrame:
        if self.turn_time is None:
            return self
        if self.path is None:
            raise rejection(
                "it does not follow a path", "turn_time with path", None, ("turn_time",)
            )
        first = first_turn(self)
        if self.turn_time > 2.0 * first:
            problem = f"the track turns at {first:g} s: it would begin to before the start"
            allowed = f"at most {2.0 * first:g} s, or a longer first leg"
            raise rejection(problem, allowed, self.turn_time, ("turn_time",))
        return self

    @field_validator("raos")
    @classmethod
    def _full_grid(cls, rows: tuple[RaoPoint, ...]) -> tuple[RaoPoint, ...]:
        headings = sorted({row.heading_deg for row in rows})
        periods = sorted({row.period for row in rows})
        pairs = {(row.heading_deg, row.period) for row in rows}
        if not len(pairs) == len(rows) == len(headings) * len(periods):
            allowed = "one row for every period at every heading"
            problem = f"{len(rows)} rows of {len(headings)} headings and {len(periods)} periods"
            raise rejection(problem, allowed, len(rows))
        return rows

    @field_validator("raos")
    @classmethod
    def _one_answer(cls, rows: tuple[RaoPoint, ...]) -> tuple[RaoPoint, ...]:
        """Headings that a turn lies between are the same one."""
        first: dict[tuple[float, float], int] = {}
        for index, row in enumerate(rows):
            heading = round(row.heading_deg % 360.0, 9) % 360.0
            before = first.setdefault((heading, row.period), index)
            if not np.allclose(
                rows[before].response, row.response, rtol=SAME_RESPONSE, atol=SAME_RESPONSE
            ):
                problem = f"rows {before} and {index} differ, of period {row.period:g} s and "
                problem += f"headings {rows[before].heading_deg:g} and {row.heading_deg:g} degrees,"
                problem += " which are the same"
                raise rejection(problem, "one of these rows, or equal ones", None, (index,))
        return rows


_Number = Annotated[float, Quantity()]
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


_ONE: tuple[JsonDict, ...] = ({"type": "number"}, {"type": "string"})


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
