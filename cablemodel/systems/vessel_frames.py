"""Vessels of a system: rigid frames that move as prescribed, and answer waves."""

from __future__ import annotations

import math
from typing import Annotated, Any

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

from cablemodel.scene.base import (
    Coefficient,
    Duration,
    Position,
    SceneModel,
    Seconds,
    also,
    in_order_of,
)
from cablemodel.scene.line import Connection
from cablemodel.scene.rows import Rows
from cablemodel.scene.tables import ATTITUDES, attitudes_from_file, rows_from_file
from cablemodel.scene.units import Quantity, Vector, rejection
from cablemodel.scene.vessel import Vessel, file_form, rows_over_time
from cablemodel.systems.motion import axes_of, first_angles, first_turn

FloatArray = NDArray[np.float64]
Attitude = Annotated[tuple[float, float, float], Vector("rad")]
SAME_RESPONSE = 1e-6
"""By what rounding may make responses or coefficients differ that are the same."""


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
