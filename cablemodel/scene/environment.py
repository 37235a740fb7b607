"""The environment of a scene: gravity, water, current, waves, sea floor."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cached_property
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BeforeValidator, Field, ValidationInfo, field_validator, model_validator

from cablemodel.errors import shown
from cablemodel.scene.base import (
    Angle,
    Coefficient,
    Duration,
    Length,
    Metres,
    SceneModel,
    Seconds,
    Vector2,
    Velocity,
    also,
)
from cablemodel.scene.depth_table import DepthSurface
from cablemodel.scene.rows import Rows
from cablemodel.scene.tables import rows_from_file, table_from_file
from cablemodel.scene.units import Count, Quantity, Vector, not_one_of, rejection

FloatArray = NDArray[np.float64]


class CurrentPoint(SceneModel):
    """Velocity of the water at one depth and time."""

    z: Metres = Field(description="height above the still water surface (negative below)")
    t: Seconds = Field(default=0.0, description="time")
    velocity: Velocity = Field(description="velocity of the water")


class Current(SceneModel):
    """Current over depth and time: linear between the points, constant beyond them. While it
    changes, the accelerated water pushes cable and bodies (docs/theory.md)."""

    table: tuple[CurrentPoint, ...] = Field(
        description="points; with times, every depth must be given at every time"
    )

    @model_validator(mode="before")
    @classmethod
    def _from_vector(cls, value: Any) -> Any:
        if isinstance(value, (list, tuple, np.ndarray)):
            return {"table": [{"z": 0.0, "velocity": Vector("m/s")(value)}]}
        if not isinstance(value, (Mapping, Current)):
            allowed = f"none, {Vector('m/s').allowed}, or a mapping with the key table"
            raise rejection(f"{shown(value)} is no current", allowed, value)
        return value

    @field_validator("table")
    @classmethod
    def _full_grid(cls, table: tuple[CurrentPoint, ...]) -> tuple[CurrentPoint, ...]:
        if not table:
            raise rejection("the table is empty", "at least one row", table)
        places = [(point.t, point.z) for point in table]
        known: set[tuple[float, float]] = set()
        for index, place in enumerate(places):
            if place in known:
                problem = f"z = {place[1]:g} m at t = {place[0]:g} s is given twice"
                raise rejection(problem, "each depth once at each time", at=(index,))
            known.add(place)
        times, depths = {t for t, _ in places}, {z for _, z in places}
        if len(known) < len(times) * len(depths):
            t, z = next(
                (t, z) for t in sorted(times) for z in sorted(depths) if (t, z) not in known
            )
            problem = f"z = {z:g} m is missing at t = {t:g} s"
            raise rejection(problem, "every depth at every time", table)
        return tuple(sorted(table, key=lambda point: (point.t, point.z)))

    @cached_property
    def z(self) -> FloatArray:
        """Heights, ascending, (nz,) [m]."""
        return _fixed(sorted({point.z for point in self.table}))

    @cached_property
    def t(self) -> FloatArray:
        """Times, ascending, (nt,) [s]."""
        return _fixed(sorted({point.t for point in self.table}))

    @cached_property
    def velocity(self) -> FloatArray:
        """Velocities, (nt, nz, 3) [m/s], ENU."""
        rows = _fixed([point.velocity for point in self.table])
        return rows.reshape(len(self.t), len(self.z), 3)


class RegularWave(SceneModel):
    """A single Airy wave."""

    height: Length = Field(description="crest to trough")
    period: Duration = Field(description="wave period")
    direction: Angle = Field(
        default=0.0, description="direction of travel, from x counter-clockwise"
    )
    phase: Angle = Field(default=0.0, description="phase at the origin at t = 0 (0: a crest)")


class JonswapWaves(SceneModel):
    """A long-crested irregular sea."""

    hs: Length = Field(description="significant wave height")
    tp: Duration = Field(description="peak period")
    direction: Angle = Field(
        default=0.0, description="direction of travel, from x counter-clockwise"
    )
    seed: Annotated[int, Count(0, 2**32 - 1)] = Field(
        default=0, description="seed of the random phases"
    )
    gamma: Annotated[float, Quantity(at_least=1, at_most=10)] = Field(
        default=3.3, description="peak enhancement"
    )
    components: Annotated[int, Count(1, 1000)] = Field(
        default=100, description="components of equal energy; the more, the more a step costs"
    )


class WaveComponent(SceneModel):
    """One of a sea: a regular wave."""

    amplitude: Annotated[float, Quantity("m", at_least=0)] = Field(description="half its height")
    period: Duration = Field(description="wave period")
    phase: Angle = Field(default=0.0, description="phase at the origin at t = 0 (0: a crest)")


def _component_rows(value: Any, info: ValidationInfo) -> Any:
    if isinstance(value, str):
        return rows_from_file(value, info.context, ("amplitude", "period"), ("phase",))
    return value


class WaveComponents(SceneModel):
    """A long-crested sea by its components."""

    rows: Annotated[tuple[WaveComponent, ...], BeforeValidator(_component_rows)] = Field(
        min_length=1,
        max_length=1000,
        description="components, or a CSV file with the columns amplitude, period and, if not 0, "
        "phase",
        json_schema_extra=also({"type": "string"}),
    )
    direction: Angle = Field(
        default=0.0, description="direction of travel, from x counter-clockwise"
    )

    @field_validator("rows")
    @classmethod
    def _some_wave(cls, rows: tuple[WaveComponent, ...]) -> tuple[WaveComponent, ...]:
        if all(row.amplitude == 0.0 for row in rows):
            raise rejection("all amplitudes are 0", "one above 0, or waves: null", 0.0)
        return rows


class Waves(SceneModel):
    """Surface waves: one of the three kinds."""

    regular: RegularWave | None = Field(default=None, description="a single Airy wave")
    jonswap: JonswapWaves | None = Field(default=None, description="an irregular sea")
    components: WaveComponents | None = Field(default=None, description="a sea by its components")
    ramp: Annotated[float | None, Quantity("s", at_least=0)] = Field(
        default=None,
        description="time in which the waves come up from calm water; by default one (peak) period",
    )

    @model_validator(mode="after")
    def _one_kind(self) -> Waves:
        kinds = (self.regular, self.jonswap, self.components)
        if sum(kind is not None for kind in kinds) != 1:
            raise rejection("not exactly one kind of waves", "regular, jonswap or components")
        return self


class FloorPoint(SceneModel):
    """Height of the sea floor at one place."""

    x: Metres = Field(description="east")
    y: Metres = Field(default=0.0, description="north")
    z: Metres = Field(description="height of the floor (negative below the surface)")


def _floor_rows(value: Any, info: ValidationInfo) -> Any:
    if isinstance(value, str):
        columns = table_from_file(value, info.context, columns=("x", "z"), optional=("y",))
        return Rows(FloorPoint, {"y": np.zeros(len(columns["x"])), **columns})
    return value


class Floor(SceneModel):
    """The sea floor: a plane, or a table of heights."""

    z: Metres | None = Field(default=None, description="height of the plane at the point `at`")
    slope: Annotated[Vector2, Vector("", "xy")] = Field(
        default=(0.0, 0.0), description="rise of the plane per metre towards x and y"
    )
    at: Annotated[Vector2, Vector("m", "xy")] = Field(
        default=(0.0, 0.0), description="point [x, y] where the plane has the height z"
    )
    depth_table: Annotated[
        Rows[FloorPoint] | None,
        BeforeValidator(_floor_rows),
    ] = Field(
        default=None,
        description="instead of z: a CSV file with the columns x, y, z (a full grid; y may be left "
        "out for a profile along x), or its rows",
        json_schema_extra=also({"type": "string"}),
    )
    friction: Coefficient = Field(default=0.0, description="Coulomb friction coefficient")
    damping: Annotated[float, Quantity("s/m", at_least=0)] | None = Field(
        default=None,
        description="growth of the floor's force per speed of approach: a body leaves it at "
        "no more than 1 / damping; by default 1 over the speed at which the cable sinks; bodies "
        "do not bounce",
    )

    @model_validator(mode="after")
    def _plane_or_table(self) -> Floor:
        if (self.z is None) == (self.depth_table is None):
            raise not_one_of(self, "z", "depth_table")
        if self.depth_table is not None:
            _check_grid(self.depth_table)
            if {"slope", "at"} & self.model_fields_set and any((*self.slope, *self.at)):
                raise rejection(
                    "slope and at belong to a plane", "depth_table without slope and at"
                )
        return self

    def height(self, x: float, y: float) -> float:
        """Height of the floor at a place [m]; beyond a table's edge that of the edge.

        Between a table's points it is the surface that the engine has: `DepthSurface`.
        """
        if self.z is not None:
            return self.z + self.slope[0] * (x - self.at[0]) + self.slope[1] * (y - self.at[1])
        return self._surface.height(x, y)

    @cached_property
    def _surface(self) -> DepthSurface:
        return DepthSurface(self.grid_x, self.grid_y, self.grid_z)

    @cached_property
    def grid_x(self) -> FloatArray:
        """East coordinates of the table, ascending, (nx,) [m]; empty for a plane."""
        return self._grid[0]

    @cached_property
    def grid_y(self) -> FloatArray:
        """North coordinates of the table, ascending, (ny,) [m]; empty for a plane."""
        return self._grid[1]

    @cached_property
    def grid_z(self) -> FloatArray:
        """Heights of the table, (nx, ny) [m]; empty for a plane."""
        return self._grid[2]

    @cached_property
    def _grid(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        if self.depth_table is None:
            return _fixed([]), _fixed([]), _fixed([]).reshape(0, 0)
        xs, ys, order = _grid_order(self.depth_table)
        heights = self.depth_table.column("z")[order]
        return _fixed(xs), _fixed(ys), _fixed(heights.reshape(len(xs), len(ys)))


def _grid_order(points: Rows[FloorPoint]) -> tuple[FloatArray, FloatArray, NDArray[np.intp]]:
    """The grid's x and y, ascending, and its rows by x and then y."""
    x, y = points.column("x"), points.column("y")
    return np.unique(x), np.unique(y), np.lexsort((y, x))


def _check_grid(points: Rows[FloorPoint]) -> None:
    allowed = (
        "a full grid: every x with every y, each once, at least two different x; for a profile "
        "along x leave out y"
    )
    xs, ys, order = _grid_order(points)
    x, y = points.column("x")[order], points.column("y")[order]
    twice = np.flatnonzero((np.diff(x) == 0.0) & (np.diff(y) == 0.0))
    if len(twice):
        n = int(twice[0])
        problem = f"x = {x[n]:g} m, y = {y[n]:g} m is given twice"
        raise rejection(problem, allowed, at=("depth_table",))
    if len(points) < len(xs) * len(ys):
        filled = np.unique(x, return_counts=True)[1]
        hole = xs[np.flatnonzero(filled < len(ys))[0]]
        missing = np.setdiff1d(ys, y[x == hole])[0]
        raise rejection(
            f"the grid has holes: no z at x = {hole:g} m, y = {missing:g} m",
            allowed,
            at=("depth_table",),
        )
    if len(xs) < 2:
        raise rejection("the table is too short", allowed, at=("depth_table",))


def _none(value: Any) -> Any:
    """``none`` as a word means what YAML's null means."""
    return None if isinstance(value, str) and value == "none" else value


class Environment(SceneModel):
    """What surrounds the cable. Axes: x east, y north, z up, still water at z = 0."""

    gravity: Annotated[float, Quantity("m/s**2", at_least=0)] = Field(
        default=9.80665, description="acceleration of gravity"
    )
    water_density: Annotated[float, Quantity("kg/m**3", at_least=0)] = Field(
        default=1025.0, description="density of the water; 0 is vacuum"
    )
    current: Annotated[Current | None, BeforeValidator(_none)] = Field(
        default=None,
        description="velocity of the water: none, one vector, or a table over depth and time",
        json_schema_extra=also(Vector("m/s").json_schema()),
    )
    waves: Annotated[Waves | None, BeforeValidator(_none)] = Field(
        default=None,
        description="surface waves, and a free surface: no water above it; none: there is water "
        "everywhere, also above z = 0",
    )
    floor: Annotated[Floor | None, BeforeValidator(_none)] = Field(
        default=None, description="the sea floor; none: water without bottom"
    )


def _fixed(values: Any) -> FloatArray:
    array = np.asarray(values, dtype=np.float64)
    array.flags.writeable = False
    return array
