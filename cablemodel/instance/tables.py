"""A scene's numbers in the block: settings, motion, current, pay-out, ends."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.block import Block
from cablemodel.instance.frame import local
from cablemodel.instance.line import Line
from cablemodel.instance.refinement import mesh_is_free
from cablemodel.instance.scales import is_flexible, pays_out, start_conditions
from cablemodel.instance.winch import Winch
from cablemodel.kernels import layout as at

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.scene.common import CableScene

FloatArray = NDArray[np.float64]

MOST_STEPS = 2_000_000
"""Internal steps that one call may take."""


def fill_settings(block: Block, scene: CableScene) -> None:
    """Tolerance, gravity and water."""
    ints, reals = block.ints, block.reals
    ints[at.I_PIECE] = 1
    ints[at.I_ORDER] = 4
    ints[at.I_MAXIMUM_STEPS] = MOST_STEPS
    rho = scene.environment.water_density
    ints[at.I_DRAG] = int(rho > 0.0)
    reals[at.S_GRAVITY] = scene.environment.gravity
    reals[at.S_WATER_DENSITY] = rho
    reals[at.S_TOLERANCE] = scene.solver.tolerance


def facts_of(scene: Scene, scale: float) -> FloatArray:
    """What `kernels/scales.py` wants to know of the line, (FACT_WORDS,). scale: a typical
    tension [N]."""
    start = start_conditions(scene)
    softness = masses = 0.0
    for cable in scene.cables:
        kind = scene.cable_types[cable.type]
        softness += kind.strain_coefficients[0] * cable.length
        masses += kind.mass * cable.length
    facts = np.zeros(at.FACT_WORDS)
    facts[at.FACT_LENGTH] = scene.line_length
    facts[at.FACT_DAMPING] = start.damping
    facts[at.FACT_SOFTNESS] = softness
    facts[at.FACT_MASS] = masses + math.fsum(body.mass for body in scene.bodies)
    facts[at.FACT_TENSION] = scale
    facts[at.FACT_SLACK] = start.slack
    above_floor = scene.environment.floor is not None
    facts[at.FACT_CALM] = start.free_end and not above_floor and not pays_out(scene)
    facts[at.FACT_FOLLOWS] = mesh_is_free(scene)
    facts[at.FACT_ABOVE_FLOOR] = above_floor
    facts[at.FACT_BENDS] = not all(is_flexible(scene, cable) for cable in scene.cables)
    return facts


def fill_motion(block: Block, pieces: FloatArray) -> None:
    """The scene's pieces from row 1 on (row 0 is the caller's live motion), and their kinks."""
    from cablemodel.scene.motion import jumps

    table = block.array(at.O_PIECES, len(pieces) + 1, at.PIECE_WORDS)
    table[1:] = pieces
    table[1, [at.P_VELOCITY_JUMP, at.P_ACCELERATION_JUMP]] = 0.0
    table[2:, at.P_VELOCITY_JUMP], table[2:, at.P_ACCELERATION_JUMP] = jumps(pieces)


def fill_current(block: Block, scene: CableScene) -> None:
    """The table of the current over depth and time."""
    current = scene.environment.current
    if current is None:
        return
    depths, times = len(current.z), len(current.t)
    block.ints[at.I_CURRENT] = 1 if depths == 1 else 2
    block.array(at.O_DEPTHS, depths)[:] = current.z
    block.array(at.O_TIMES, times)[:] = current.t
    block.array(at.O_CURRENT, times, depths, 3)[:] = current.velocity


def fill_payout(block: Block, scene: Scene, winch: Winch) -> None:
    """The table of the pay-out's rate, and what it may reach."""
    ints, reals = block.ints, block.reals
    rates = scene.payout.rate
    ints[at.I_PAYOUT] = int(pays_out(scene))
    reals[at.S_PAID_MOST] = winch.most
    reals[at.S_TRAVEL_MOST] = winch.most_travel
    reals[at.S_TRAVEL_LEAST] = winch.least_travel
    block.array(at.O_RATES, len(rates), at.RATE_WORDS)[:] = [(row.t, row.rate) for row in rates]


def fill_constraints(block: Block, scene: Scene, line: Line) -> None:
    """Where the ends are held, and how: a clamp turns no cable that is perfectly flexible.

    Where cable runs past the tow point its clamp is a spring (kernels/vessel_clamp.py).
    """
    table = block.array(at.O_CONSTRAINT, int(block.ints[at.I_CONSTRAINTS]), at.CONSTRAINT_WORDS)
    ends = [(0, at.C_VESSEL, scene.vessel.connection)]
    if scene.end.kind == "anchor":
        ends.append((line.nodes - 1, at.C_ANCHOR, scene.end.connection))
    dimension = int(block.ints[at.I_DIMENSION])
    block.reals[at.S_CLAMP_PULL] = block.reals[at.S_TENSION_SCALE]  # until the tension is known
    for row, (node, kind, connection) in zip(table, ends, strict=True):
        row[at.C_NODE] = node
        row[at.C_KIND] = kind
        if kind == at.C_ANCHOR:
            place = local(block, np.asarray(scene.end.position), point=True)
            row[at.C_POSITION : at.C_POSITION + dimension] = place
        cable = scene.cables[0 if kind == at.C_VESSEL else -1]
        runs = kind == at.C_VESSEL and pays_out(scene)
        if connection.kind == "clamped" and (runs or not is_flexible(scene, cable)):
            row[at.C_CLAMPED] = at.BY_SPRING if runs else at.EXACTLY
            direction = np.asarray(connection.direction, dtype=float)
            unit = direction / np.linalg.norm(direction)
            row[at.C_DIRECTION : at.C_DIRECTION + dimension] = local(block, unit, point=False)
