"""A scene's numbers in the block: settings, motion, current, pay-out, ends."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.start.frame import local
from cablemodel.solvers.finite_element.start.line import Line
from cablemodel.solvers.finite_element.start.refinement import mesh_is_free
from cablemodel.solvers.finite_element.start.scales import is_flexible, pays_out, start_conditions
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header, Scalars

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.scene.common import CableScene

FloatArray = NDArray[np.float64]

TABLE_MOST_STEPS = 2_000_000
"""Internal steps that one call may take."""


def fill_settings(block: Block, scene: CableScene) -> None:
    """Tolerance, gravity and water."""
    ints, reals = block.ints, block.reals
    head = Header(ints)
    state = Scalars(reals)
    head.piece = 1
    head.order = 4
    head.maximum_steps = TABLE_MOST_STEPS
    rho = scene.environment.water_density
    head.drag = int(rho > 0.0)
    state.gravity = scene.environment.gravity
    state.water_density = rho
    state.tolerance = scene.solver.tolerance


def facts_of(scene: Scene, scale: float) -> FloatArray:
    """What `kernels/mesh/lengths.py` wants to know of the line besides its lengths, the words of
    LineFacts. scale: a typical tension [N]."""
    start = start_conditions(scene)
    masses = 0.0
    for cable in scene.cables:
        masses += scene.cable_types[cable.type].mass * cable.length
    words = np.zeros(at.FACT_WORDS)
    facts = at.LineFacts(words, 0)
    facts.mass = masses + math.fsum(body.mass for body in scene.bodies)
    facts.memory = 1.0
    facts.tension = scale
    facts.slack = start.slack
    above_floor = scene.environment.floor is not None
    facts.calm = start.free_end and not above_floor and not pays_out(scene)
    facts.follows = mesh_is_free(scene)
    facts.above_floor = above_floor
    facts.bends = not all(is_flexible(scene, cable) for cable in scene.cables)
    return words


def fill_motion(block: Block, pieces: FloatArray) -> None:
    """The scene's pieces from row 1 on (row 0 is the caller's live motion), and their jumps."""
    table = block.array(Header.pieces, len(pieces) + 1, at.PIECE_WORDS)
    table[1:] = pieces
    fill_jumps(table[1:])


def fill_jumps(rows: FloatArray) -> None:
    """How pieces begin, into their rows."""
    from cablemodel.scene.motion import jumps

    columns = [at.Piece.velocity_jump, at.Piece.acceleration_jump, at.Piece.jerk_jump]
    for column, found in zip(columns, jumps(rows), strict=True):
        rows[0, column] = 0.0
        rows[1:, column] = found


def fill_current(block: Block, scene: CableScene) -> None:
    """The table of the current over depth and time."""
    current = scene.environment.current
    if current is None:
        return
    depths, times = len(current.z), len(current.t)
    block.header.current_kind = 1 if depths == 1 else 2
    block.array(Header.depths, depths)[:] = current.z
    block.array(Header.times, times)[:] = current.t
    block.array(Header.current, times, depths, 3)[:] = current.velocity


def fill_payout(block: Block, scene: Scene) -> None:
    """The table of the pay-out's rate."""
    rates = scene.payout.rate
    block.header.payout = int(pays_out(scene))
    row = block.winch
    row.way, row.rates = 1.0, len(rates)
    block.array(Header.rates, len(rates), at.RATE_WORDS)[:] = [(row.t, row.rate) for row in rates]


def fill_constraints(block: Block, scene: Scene, line: Line) -> None:
    """Where the ends are held, and how: a clamp turns no cable that is perfectly flexible.

    Where cable runs past the tow point its clamp is a spring (kernels/bodies/vessel_clamp.py).
    """
    table = block.array(Header.constraints, int(block.header.constraint_count), at.CONSTRAINT_WORDS)
    ends = [(0, at.HELD_BY_VESSEL, scene.vessel.connection)]
    if scene.end.kind == "anchor":
        ends.append((line.nodes - 1, at.HELD_BY_ANCHOR, scene.end.connection))
    dimension = int(block.header.dimension)
    for row, (node, kind, connection) in zip(table, ends, strict=True):
        row[at.Constraint.node] = node
        row[at.Constraint.kind] = kind
        if kind == at.HELD_BY_ANCHOR:
            place = local(block, np.asarray(scene.end.position), point=True)
            row[at.Constraint.position : at.Constraint.position.word + dimension] = place
        cable = scene.cables[0 if kind == at.HELD_BY_VESSEL else -1]
        runs = kind == at.HELD_BY_VESSEL and pays_out(scene)
        if connection.kind == "clamped" and (runs or not is_flexible(scene, cable)):
            row[at.Constraint.clamped] = at.BY_SPRING if runs else at.EXACTLY
            direction = np.asarray(connection.direction, dtype=float)
            unit = direction / np.linalg.norm(direction)
            row[at.Constraint.direction : at.Constraint.direction.word + dimension] = local(
                block, unit, point=False
            )
