"""A run as columns of numbers, each with its name and unit: what tables and statistics are of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cablemodel import variables
from cablemodel.results.states import matrix_of

if TYPE_CHECKING:
    from cablemodel.results.run import Run

Floats = NDArray[np.float64]

STATE_FIELDS: dict[str, tuple[str, str]] = {
    "s": ("m", "unstretched arc length from the vessel, or the line's beginning"),
    "position": ("m", "position along the cable"),
    "tangent": ("1", "unit tangent away from the vessel, or the line's beginning"),
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
    """Values of one kind."""

    name: str
    unit: str
    """SI; ``1`` for a pure number."""
    quantity: str
    """What it is, in words."""
    values: NDArray[Any]
    """(n,), numbers or text."""


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
    ``position.x``, ..., and what is made of them: ``wall_tension``. Of a system the first column
    is ``line``, the name of each row's line; one line follows the other."""
    named = variables.is_system(run.scene)
    matrices = {name: [matrix_of(state) for state in of] for name, of in run.shapes.items()}
    nodes = {name: [matrix.shape[1] for matrix in of] for name, of in matrices.items()}
    empty = np.empty((len(variables.STATE_LABELS), 0))
    table = np.concatenate([empty, *(one for of in matrices.values() for one in of)], axis=1)
    times = [np.repeat(of.time, nodes[name]) for name, of in run.shapes.items()]
    found = []
    if named:
        lines = np.repeat([*nodes], [sum(of) for of in nodes.values()])
        found.append(Column("line", "1", "name of the line", lines))
    found.append(Column("time", "s", "time", np.concatenate(times)))
    for label, values in zip(variables.STATE_LABELS, table, strict=True):
        unit, quantity = STATE_FIELDS[label.partition(".")[0]]
        found.append(Column(label, unit, quantity, values))
    for name in variables.DERIVED:
        parts = [getattr(state, name) for of in run.shapes.values() for state in of]
        values = np.concatenate([np.empty(0), *parts])
        found.append(Column(name, *STATE_FIELDS[name], values))
    return found


def input_columns(run: Run) -> list[Column]:
    """What every step applied, by the labels of ``variables.input_labels``: of a system what was
    given to it, NaN where nothing was."""
    fields = input_fields(run.scene)
    return [
        Column(label, fields[name][0] or "1", fields[name][1], run.applied_inputs[label])
        for name in fields
        for label in fields[name][2]
    ]


def input_fields(scene: Any) -> dict[str, tuple[str, str, tuple[str, ...]]]:
    """Fields of a logged step by name: their unit, what they are, and the labels of their
    components, in the order of ``variables.input_labels``."""
    known = {"time": ("s", "end of the step"), "step": ("s", "length of the step")}
    if variables.is_system(scene):
        for part, row in variables.inputs_of_system(scene):
            known[f"{part}.{row.python}"] = row.unit, f"{part}: {row.quantity}"
    else:
        known |= {row.python: (row.unit, row.quantity) for row in variables.INPUTS}
        known |= {
            f"{row.python}_given": ("1", f"whether the caller gave it: {row.quantity}")
            for row in variables.INPUTS
        }
    found: dict[str, list[str]] = {}
    for label in variables.input_labels(scene):
        name = label if label in known else label.rpartition(".")[0]
        found.setdefault(name, []).append(label)
    return {name: (*known[name], tuple(labels)) for name, labels in found.items()}
