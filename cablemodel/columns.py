"""A run as columns of numbers, each with its name and unit: what tables and statistics are of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel import variables
from cablemodel.states import matrix_of

if TYPE_CHECKING:
    from cablemodel.run import Run

Floats = NDArray[np.float64]

STATE_FIELDS: dict[str, tuple[str, str]] = {
    "s": ("m", "unstretched arc length from the vessel"),
    "position": ("m", "position along the cable"),
    "tangent": ("1", "unit tangent away from the vessel"),
    "velocity": ("m/s", "velocity of the material"),
    "tension": ("N", "effective tension along the cable"),
    "wall_tension": ("N", "wall tension along the cable: effective less pressure times area"),
    "curvature": ("1/m", "curvature along the cable"),
    "bending_moment": ("N.m", "bending moment along the cable"),
    "on_floor": ("1", "whether the node touches the floor"),
}
"""Unit and description of the fields of states."""

_AXES = "xyz"


@dataclass(frozen=True)
class Column:
    """Numbers of one kind."""

    name: str
    unit: str
    """SI; ``1`` for a pure number."""
    quantity: str
    """What it is, in words."""
    values: Floats


def output_columns(run: Run) -> list[Column]:
    """The time and every component of every output over time: ``top_force.x``,
    ``bodies[0].position.x`` (from the vessel outwards, the last one always the outermost)."""
    found = [Column("time", "s", "time", run.time)]
    for name in run.names:
        variable = run.variable(name)
        unit, values = variable.unit or "1", run[name]
        if values.ndim == 1:
            found.append(Column(name, unit, variable.quantity, values))
        elif values.ndim == 2:
            found += _components(name, unit, variable.quantity, values)
        else:
            owner, _, attribute = name.partition(".")
            for body in range(values.shape[1]):
                label = f"{owner}[{body}].{attribute}"
                found += _components(label, unit, variable.quantity, values[:, body])
    return found


def _components(name: str, unit: str, quantity: str, values: Floats) -> list[Column]:
    return [
        Column(f"{name}.{axis}", unit, f"{quantity}, {axis}", values[:, index])
        for index, axis in enumerate(_AXES)
    ]


def state_columns(run: Run) -> list[Column]:
    """Exact states as a long table, a row for each node of each state: ``time``, ``s``,
    ``position.x``, ..., and what is made of them: ``wall_tension``."""
    matrices = [matrix_of(state) for state in run.states]
    nodes = [matrix.shape[1] for matrix in matrices]
    empty = np.empty((len(variables.STATE_LABELS), 0))
    table = np.concatenate([empty, *matrices], axis=1)
    found = [Column("time", "s", "time", np.repeat(run.states.time, nodes))]
    for label, values in zip(variables.STATE_LABELS, table, strict=True):
        unit, quantity = STATE_FIELDS[label.partition(".")[0]]
        found.append(Column(label, unit, quantity, values))
    for name in variables.DERIVED:
        values = np.concatenate([np.empty(0), *(getattr(state, name) for state in run.states)])
        found.append(Column(name, *STATE_FIELDS[name], values))
    return found


def input_columns(run: Run) -> list[Column]:
    """What every step applied, by the labels of ``variables.APPLIED_INPUT_LABELS``."""
    found = []
    for label in variables.APPLIED_INPUT_LABELS:
        unit, quantity = input_field(label.partition(".")[0])
        found.append(Column(label, unit, quantity, run.applied_inputs[label]))
    return found


def input_field(name: str) -> tuple[str, str]:
    """Unit and description of a field of ``variables.APPLIED_INPUT_FIELDS``."""
    if name == "time":
        return "s", "end of the step"
    if name == "step":
        return "s", "length of the step"
    rows = {item.python: item for item in variables.INPUTS}
    given = name.removesuffix("_given")
    if given != name:
        return "1", f"whether the caller gave it: {rows[given].quantity}"
    return rows[name].unit, rows[name].quantity
