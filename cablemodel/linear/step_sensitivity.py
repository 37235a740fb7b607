"""What a step's end changes by with its inputs and with the scene's parameters.

A change of an input or a parameter moves the line by the equations of motion made linear about the
step that is made: x' = A(t) x + B(t) u. They are integrated by the Radau IIA formula of order 5 (E.
Hairer & G. Wanner, Solving Ordinary Differential Equations II, 1996, table IV.5.6), with A and B
from the Newton matrices at the step's own states at the formula's times. Pieces of the step are
halved until no output's derivatives change, or they are the engine's own steps, which follow waves
along the line, too. So these are the derivatives of the motion itself; those of the integrator's
result differ by its errors.

Of a parameter p B is -M^-1 dR/dp, where the residual R is linear or nearly so in all that is looked
at: its central difference between two scenes' tables is as exact as the matrices.
"""

from __future__ import annotations

import copy
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cablemodel.errors import CableModelError
from cablemodel.linear.equations import Equations
from cablemodel.linear.line import LineEquations
from cablemodel.linear.model import Names
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.start.line_tables import edge_row, fill_body
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header

if TYPE_CHECKING:
    from cablemodel.linear.model import LinearModel
    from cablemodel.model import CableModel
    from cablemodel.scene import Scene

FloatArray = NDArray[np.float64]

_ROOT = np.sqrt(6.0)
TIMES = np.array([(4.0 - _ROOT) / 10.0, (4.0 + _ROOT) / 10.0, 1.0])
WEIGHTS = np.array(
    [
        [(88 - 7 * _ROOT) / 360, (296 - 169 * _ROOT) / 1800, (-2 + 3 * _ROOT) / 225],
        [(296 + 169 * _ROOT) / 1800, (88 + 7 * _ROOT) / 360, (-2 - 3 * _ROOT) / 225],
        [(16 - _ROOT) / 36, (16 + _ROOT) / 36, 1 / 9],
    ]
)
"""Radau IIA of three stages: times and weights within a piece."""
AT_ONCE = 1e-6
"""Of a step: within it the mesh follows what was due, and a jump at its begin."""
SETTLED = 1e-3
"""Of an output's largest derivative: what half as long pieces change."""
SHARE = 1e-4
"""Of a parameter, its change for a central difference; of one that is zero in SI units."""
OF_EDGES = ("mass", "added_mass", "weight", "drag_normal", "drag_tangential", "compliance")
OF_BODIES = (
    "mass", "weight", "dry_weight", "inertia", "added_mass", "added_mass_axial", "drag",
    "drag_axial",
)  # fmt: skip


@dataclass(frozen=True)
class StepSensitivity:
    """Derivatives of what a step ends with: state and outputs by inputs and parameters."""

    inputs: Names
    """Of the step, each axis by itself: values reached at its end [SI]."""
    parameters: Names
    """Paths in the scene; derivatives are by their values in SI units."""
    states: Names
    """As in `LinearModel`: places and velocities from the tow point, then levels."""
    outputs: Names
    """By the names of docs/variables.md."""
    state_by_input: FloatArray
    """(states, inputs)."""
    output_by_input: FloatArray
    """(outputs, inputs)."""
    state_by_parameter: FloatArray
    """(states, parameters), of the same state before the step."""
    output_by_parameter: FloatArray
    """(outputs, parameters)."""

    def of(self, output: str, by: str) -> float:
        """One of them by its names.

        Raises:
            CableModelError: there is no such output, input or parameter.
        """
        for names, table in (
            (self.inputs, self.output_by_input),
            (self.parameters, self.output_by_parameter),
        ):
            if by in names and output in self.outputs:
                return float(table[self.outputs.index(output), names.index(by)])
        raise CableModelError(
            f"no sensitivity of {output!r} to {by!r}; there are those of {', '.join(self.outputs)} "
            f"to {', '.join((*self.inputs, *self.parameters))}"
        )


def step_sensitivity(
    model: CableModel,
    dt: float,
    vessel_velocity: ArrayLike | None,
    payout_rate: float | None,
    current: ArrayLike | None,
    parameters: Sequence[str],
) -> StepSensitivity:
    """See `CableModel.sensitivities`."""
    changes = [_Change(model.scene, path) for path in parameters]
    begin = model.time
    reached = {
        "vessel_velocity": (model.vessel_velocity, vessel_velocity),
        "payout_rate": (model.payout_rate, payout_rate),
        "current": (model.applied_inputs["current"], current),
    }

    def inputs(part: float) -> dict[str, Any]:
        return {
            name: start + part * (np.asarray(end, dtype=float) - start)
            for name, (start, end) in reached.items()
            if end is not None
        }

    def along(pieces: int) -> tuple[LinearModel, FloatArray, FloatArray]:
        """The line's equations at the step's end, derivatives of its state, and of its outputs."""
        ahead = _with_its_mesh(model)
        # Before anything has moved: what is due of the mesh, then what a jump asks of it.
        for part in (AT_ONCE, 2.0 * AT_ONCE):
            ahead.step_to(begin + part * dt, **inputs(part))
        first = LineEquations(ahead)
        last = first.linear_model({c.path: c.residual(first) for c in changes})
        rates, count = len(last.inputs) - len(changes), len(last.states)
        # An input that ends by one more has grown evenly.
        scale = np.concatenate([np.full(rates, 1.0 / dt), np.ones(len(changes))])
        x: FloatArray = np.zeros((count, len(scale)))
        h = dt / pieces
        for piece in range(pieces):
            matrix = np.eye(3 * count)
            right = np.tile(x, (3, 1))
            for j, time in enumerate(TIMES):
                part = (piece + time) / pieces
                ahead.step_to(begin + part * dt, **inputs(part))
                equations = LineEquations(ahead)
                if equations.names != first.names:
                    raise CableModelError(
                        f"sensitivities: the mesh changed between {begin:g} and {ahead.time:g} s; "
                        "give a shorter step"
                    )
                last = equations.linear_model({c.path: c.residual(equations) for c in changes})
                for i in range(3):
                    rows = slice(i * count, (i + 1) * count)
                    matrix[rows, j * count : (j + 1) * count] -= h * WEIGHTS[i, j] * last.A
                    right[rows] += h * WEIGHTS[i, j] * last.B * scale
            x = np.asarray(np.linalg.solve(matrix, right)[2 * count :])
        return last, x, last.C @ x + last.D * scale

    whole = _with_its_mesh(model)
    whole.step(dt, **inputs(1.0))
    most = whole.statistics["steps"] - model.statistics["steps"]
    pieces = 1
    last, x, y = along(pieces)
    while pieces < most:
        pieces = min(2 * pieces, most)
        before = y
        last, x, y = along(pieces)
        largest = np.abs(y).max(axis=1, keepdims=True)
        if (np.abs(y - before) <= SETTLED * largest).all():
            break
    paths = tuple(parameters)
    rates = len(last.inputs) - len(paths)
    return StepSensitivity(
        inputs=last.driven[:rates],
        parameters=paths,
        states=last.states,
        outputs=last.outputs,
        state_by_input=x[:, :rates],
        output_by_input=y[:, :rates],
        state_by_parameter=x[:, rates:],
        output_by_parameter=y[:, rates:],
    )


def _with_its_mesh(model: CableModel) -> CableModel:
    """A copy whose mesh does not follow bends: a motion's derivatives do not depend on that."""
    other = copy.deepcopy(model)
    other._solver.memory.scalars.bent = 0.0
    return other


class _Change:
    """What a parameter of the scene changes in the block's tables."""

    def __init__(self, scene: Scene, path: str) -> None:
        from cablemodel.scene.load import load_scene

        self.path = path
        data = scene.to_dict()
        keys = [int(key) if key.isdigit() else key for key in path.split(".")]
        owner: Any = data
        try:
            for key in keys[:-1]:
                owner = owner[key]
            value = owner[keys[-1]]
        except (KeyError, IndexError, TypeError):
            value = None
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise CableModelError(
                f"sensitivities: {path} is {value!r}, not a number of the scene, as "
                "cable_types.NAME.drag_normal or line.1.body.submerged_weight is"
            )
        self.step = SHARE * (abs(value) or 1.0)
        tables = []
        for sign in (1.0, -1.0):
            owner[keys[-1]] = value + sign * self.step
            tables.append(_tables(load_scene(data)))
        (edges, bodies), (other_edges, other_bodies) = tables
        self.edges = (edges - other_edges) / (2.0 * self.step)
        self.bodies = (bodies - other_bodies) / (2.0 * self.step)
        if not (self.edges.any() or self.bodies.any()):
            raise CableModelError(
                f"sensitivities: {path} changes none of {', '.join(OF_EDGES)} of a cable, nor "
                f"{', '.join(OF_BODIES)} of a body; of a length see `payout_rate`, and "
                "`linearise().gains()` of `line_length`"
            )

    def residual(self, equations: Equations) -> FloatArray:
        """The residual's derivative to it."""

        def change(block: Block, by: float) -> None:
            nodes = int(block.header.nodes)
            edges = block.array(Header.edges, nodes, at.EDGE_WORDS)
            for node in range(1, nodes):
                edges[node] += by * self.edges[int(edges[node, at.Edge.type])]
            bodies = block.array(Header.bodies, int(block.header.body_count), at.BODY_WORDS)
            for row in bodies:
                row += by * self.bodies[int(row[at.Body.item])]

        return equations.by(change, self.step)


def _tables(scene: Scene) -> tuple[FloatArray, FloatArray]:
    """What a parameter may change: rows of edges by cable type, and of bodies by their items."""
    items = scene.line_and_drum
    edges = np.zeros((len(scene.cable_types), at.EDGE_WORDS))
    bodies = np.zeros((len(items), at.BODY_WORDS))
    kinds = list(scene.cable_types)
    for item, piece in enumerate(items):
        if piece.cable is not None:
            row = edge_row(scene, piece.cable, 0, 0)
            for name in OF_EDGES:
                place = getattr(at.Edge, name)
                edges[kinds.index(piece.cable.type), place] = row[place]
        if piece.body is not None:
            row = np.zeros(at.BODY_WORDS)
            fill_body(row, 0, piece.body, scene.environment.water_density)
            if piece.body.half_length > 0.0:
                row[at.Body.dry_weight] = piece.body.mass * scene.environment.gravity
                row[at.Body.inertia] = piece.body.rotary_inertia
            for name in OF_BODIES:
                place = getattr(at.Body, name)
                bodies[item, place] = row[place]
    return edges, bodies
