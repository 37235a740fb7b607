"""What the equations of motion made linear are handed on in: what drives, turns and answers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cablemodel.linear.model import Names

FloatArray = NDArray[np.float64]

_AXES = "xyz"


def of_axes(name: str) -> Names:
    """Names of three components."""
    return tuple(f"{name}.{axis}" for axis in _AXES)


@dataclass
class Drives:
    """Levels and inputs by name, with what nodes and residual follow them by: columns over all
    nodes' unknowns, (nodes SIZE,)."""

    count: int
    """Unknowns."""
    levels: list[str] = field(default_factory=list)
    values: list[float] = field(default_factory=list)
    inputs: list[str] = field(default_factory=list)
    driven: list[str] = field(default_factory=list)
    chain: dict[str, str] = field(default_factory=dict)
    """Levels that grow by others."""
    of_levels: list[tuple[FloatArray, FloatArray, FloatArray, FloatArray]] = field(
        default_factory=list
    )
    """Place, velocity, acceleration, and the residual beside."""
    of_inputs: list[tuple[FloatArray, FloatArray]] = field(default_factory=list)
    """Acceleration, and the residual beside."""

    def level(
        self,
        name: str,
        value: float,
        *,
        place: FloatArray | None = None,
        velocity: FloatArray | None = None,
        acceleration: FloatArray | None = None,
        residual: FloatArray | None = None,
        grows_by: str | None = None,
    ) -> None:
        """Add a level."""
        none = np.zeros(self.count)
        columns = (place, velocity, acceleration, residual)
        place, velocity, acceleration, residual = (none if c is None else c for c in columns)
        self.levels.append(name)
        self.values.append(float(value))
        self.of_levels.append((place, velocity, acceleration, residual))
        if grows_by is not None:
            self.chain[name] = grows_by

    def input(
        self,
        name: str,
        driven: str,
        *,
        acceleration: FloatArray | None = None,
        residual: FloatArray | None = None,
    ) -> None:
        """Add an input, and which level it is the rate of (empty: of none)."""
        none = np.zeros(self.count)
        self.inputs.append(name)
        self.driven.append(driven)
        self.of_inputs.append(
            (
                none if acceleration is None else acceleration,
                none if residual is None else residual,
            )
        )

    def by_levels(self) -> tuple[FloatArray, ...]:
        """Place, velocity, acceleration and residual by levels, (unknowns, levels) each."""
        return tuple(np.column_stack(columns) for columns in zip(*self.of_levels, strict=True))

    def by_inputs(self) -> tuple[FloatArray, ...]:
        """Acceleration and residual by inputs, (unknowns, inputs) each."""
        return tuple(np.column_stack(columns) for columns in zip(*self.of_inputs, strict=True))

    def growth(self) -> FloatArray:
        """Rates of levels by levels, (levels, levels)."""
        matrix = np.zeros((len(self.levels), len(self.levels)))
        for name, rate in self.chain.items():
            matrix[self.levels.index(name), self.levels.index(rate)] = 1.0
        return matrix


@dataclass
class Turning:
    """What velocities and accelerations of nodes follow free motions by, beside Z z' and Z z'':
    (unknowns, motions) each."""

    velocity: FloatArray
    """By z."""
    acceleration: FloatArray
    """By z."""
    by_rate: FloatArray
    """Accelerations by z'."""


@dataclass
class Response:
    """What follows z, z', levels and inputs, a column each, and what there is without them."""

    place: FloatArray
    """Of all nodes' unknowns, (unknowns, columns)."""
    velocity: FloatArray
    """Of the same."""
    force: FloatArray
    """What supports and ends of elements bear: the residual's rows, (unknowns, columns)."""
    rest: FloatArray
    """That force at the state while the inputs are zero, (unknowns,)."""
    change: FloatArray
    """How much of that is because the state's own inputs are not, (unknowns,)."""
    answer: FloatArray
    """Second rates of the free motions, (motions, columns)."""
    first_level: int
    """Column of the first level."""

    def level(self, number: int) -> FloatArray:
        """A level itself, (columns,)."""
        row = np.zeros(self.place.shape[1])
        row[self.first_level + number] = 1.0
        return row


@dataclass
class Outputs:
    """Outputs by name: rows over the columns of a Response, and values at the state."""

    names: list[str] = field(default_factory=list)
    rows: list[FloatArray] = field(default_factory=list)
    values: list[float] = field(default_factory=list)

    def add(self, names: str | Sequence[str], rows: FloatArray, values: FloatArray | float) -> None:
        """Add one, or several with a row each."""
        self.names += [names] if isinstance(names, str) else names
        self.rows += list(np.atleast_2d(rows))
        self.values += [float(value) for value in np.atleast_1d(values)]


@dataclass
class Winding:
    """A winch that may turn both ways."""

    number: int
    prefix: str
    """Of its names: ``winch.``, of one line empty."""
    length: float
    """Of its line [m]."""
    rate: float
    slope: float
