"""A scene's numbers in the block: settings, motion, current, pay-out, ends."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.block import Block
from cablemodel.instance.frame import local
from cablemodel.instance.line import Line
from cablemodel.instance.refinement import BENDS, FOLDS, WHIPS, follows_bending
from cablemodel.instance.scales import is_flexible, pays_out, start_conditions
from cablemodel.instance.winch import Winch
from cablemodel.kernels import layout as at

if TYPE_CHECKING:
    from cablemodel.mesh import Start
    from cablemodel.scene import Scene

FloatArray = NDArray[np.float64]

TIME_TOLERANCE = 0.045
"""Local error allowed in a step, in units of tau L; calibrated, see docs/engine/time.md."""
LIGHTLY_DAMPED = 0.35
"""Factor on it where drag hardly damps, in air above all: errors are not forgotten, but add up."""
UNDAMPED = 0.08
"""The same in a vacuum, at tau = 1e-3."""
MEMORY = 0.3
"""How long an error of the velocity goes on moving the line, in sqrt(L/g): steps shorter than that
may make less of the local error allowed. (A whip in air that bends is left out: waves that its mesh
does not follow are damped by its steps, and decide. In a vacuum little is allowed anyhow.)"""
ORDER_3_FIRST = 16.0
"""Good steps by order 3 with which a line that starts slack begins: it snaps, and Newton's method
has trouble in longer ones."""
FINEST_IN_AIR, FINEST_IN_WATER = 1e-4, 5e-4
"""tau down to which it does, with little drag and with much; below, tensions would suffer."""
CALM_FIRST = 2.5, 0.01
"""First step of a line that hangs at rest in water, in sqrt(tau) sqrt(L/g), and of tau L: how far
the vessel may leave its uniform motion in it."""
MOST_STEPS = 2_000_000
"""Internal steps that one call may take."""


def fill_settings(block: Block, scene: Scene, scale: float) -> None:
    """Tolerances, scales, gravity and water. scale: a typical tension [N]."""
    ints, reals = block.ints, block.reals
    ints[at.I_PIECE] = 1
    ints[at.I_ORDER] = 4
    ints[at.I_MAXIMUM_STEPS] = MOST_STEPS
    rho = scene.environment.water_density
    ints[at.I_DRAG] = int(rho > 0.0)
    reals[at.S_GRAVITY] = scene.environment.gravity
    reals[at.S_WATER_DENSITY] = rho
    tolerance, length = scene.solver.tolerance, scene.line_length
    start = start_conditions(scene)
    reals[at.S_TOLERANCE] = tolerance
    allowed = TIME_TOLERANCE * tolerance * length
    if rho == 0.0:
        # Nothing forgets an error, and a stiff line takes an order from the scheme.
        allowed *= UNDAMPED * math.sqrt(tolerance / 1e-3)
    elif start.lightly_damped:
        allowed *= LIGHTLY_DAMPED
    reals[at.S_TIME_TOLERANCE] = allowed
    reals[at.S_LENGTH] = length
    if follows_bending(scene):
        bent = WHIPS if start.lightly_damped else FOLDS if start.slack else BENDS
        reals[at.S_BENT] = bent * tolerance * length
    reals[at.S_TENSION_SCALE] = scale
    if start.slack:
        # What is let go slack snaps, and rings at peaks that no output meets: its tension is left
        # as the steps find it (kernels/tension.py reads none that is small against this).
        reals[at.S_LARGEST_TENSION] = math.inf
    period = math.sqrt(length / max(scene.environment.gravity, 1e-3))
    reals[at.S_PERIOD] = period
    bends = not all(is_flexible(scene, cable) for cable in scene.cables)
    if rho > 0.0 and not (bends and start.slack and start.lightly_damped):
        reals[at.S_MEMORY] = MEMORY * period
    reals[at.S_FIRST_STEP] = 0.02 * period
    reals[at.S_STEP] = first_step(scene, start, period)
    reals[at.S_SMALLEST_STEP] = 1e-10 * period
    softness = masses = 0.0
    for cable in scene.cables:
        kind = scene.cable_types[cable.type]
        softness += kind.strain_coefficients[0] * cable.length
        masses += kind.mass * cable.length
    masses += math.fsum(body.mass for body in scene.bodies)
    reals[at.S_AXIAL] = 1.0 / (softness * masses)
    reals[at.S_UNDAMPED] = float(start.lightly_damped)
    finest = FINEST_IN_AIR if start.lightly_damped else FINEST_IN_WATER
    if start.slack and tolerance >= finest:
        reals[at.S_ORDER_3] = ORDER_3_FIRST


def first_step(scene: Scene, start: Start, period: float) -> float:
    """Length of the first step [s], from which they grow up to sixteenfold a step.

    As a rule one in which whatever is let go hardly moves. What hangs at rest in water, with a
    free end, is moved by the vessel only and need not begin so: three steps are saved.
    """
    tolerance = scene.solver.tolerance
    scale = math.sqrt(max(tolerance, 1e-12)) * period
    shortest = 1e-2 * scale
    if (
        start.slack
        or start.lightly_damped
        or not start.free_end
        or scene.environment.floor is not None
        or pays_out(scene)
    ):
        return shortest
    motion = scene.motion()
    place, velocity, _acceleration = motion.evaluate(0.0)
    step = CALM_FIRST[0] * scale
    way = CALM_FIRST[1] * tolerance * scene.line_length
    while step > shortest:
        there, speed, _acceleration = motion.evaluate(step)
        moved = float(np.linalg.norm(there - place - step * velocity))
        if max(moved, 0.5 * step * float(np.linalg.norm(speed - velocity))) <= way:
            break
        step *= 0.5
    return max(step, shortest)


def fill_motion(block: Block, pieces: FloatArray) -> None:
    """The scene's pieces from row 1 on (row 0 is the caller's live motion), and their kinks."""
    from cablemodel.scene.motion import jumps

    table = block.array(at.O_PIECES, len(pieces) + 1, at.PIECE_WORDS)
    table[1:] = pieces
    table[1, [at.P_VELOCITY_JUMP, at.P_ACCELERATION_JUMP]] = 0.0
    table[2:, at.P_VELOCITY_JUMP], table[2:, at.P_ACCELERATION_JUMP] = jumps(pieces)


def fill_current(block: Block, scene: Scene) -> None:
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
