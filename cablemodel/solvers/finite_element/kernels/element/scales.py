"""What the run of a line is measured by, from its lengths: tolerances, times, the mesh's allowance.

Of a scene as it is built, and of an FMU whose lengths and coefficients are set before the start.
"""

import math

from cablemodel.solvers.finite_element.kernels.element.tables import STABILISATION
from cablemodel.solvers.shared.access import (
    cable_of,
    header,
    line_facts_at,
    motion_piece_of,
    new_motion,
    scalars,
)
from cablemodel.solvers.shared.compile import kernel
from cablemodel.solvers.shared.environment import evaluate_piece, find_piece
from cablemodel.solvers.shared.layout import LIGHT_DAMPING

TIME_TOLERANCE = 0.045  # of tau L: local error allowed in a step; calibrated, docs/engine/time.md
LIGHTLY_DAMPED = 0.35  # factor on it where drag hardly damps, in air above all: errors add up
UNDAMPED = 0.08  # the same in a vacuum, at tau = 1e-3
# How long an error of the velocity goes on moving the line, in sqrt(L/g): steps shorter than that
# may make less of the local error allowed. (A whip in air that bends is left out: waves that its
# mesh does not follow are damped by its steps, and decide. In a vacuum little is allowed anyhow.)
MEMORY = 0.3
# Good steps by order 3 with which a line that starts slack begins: it snaps, and Newton's method
# has trouble in longer ones.
ORDER_3_FIRST = 16.0
# tau down to which it does, with little drag and with much; below, tensions would suffer.
FINEST_IN_AIR, FINEST_IN_WATER = 1e-4, 5e-4
# First step of a line that hangs at rest in water, in sqrt(tau) sqrt(L/g), and of tau L: how far
# the vessel may leave its uniform motion in it.
CALM_FIRST = 2.5, 0.01
BENDS = 8.0  # of tau L: what h^2 times the jump of curvature may be in motion, in free water
FOLDS = 25.0  # the same for a line that starts slack, and folds: it begins with smaller elements
# The same where drag hardly damps: only what cracks like a whip, and its elements stay halves.
WHIPS = 60.0
FLEXURAL = 10.0  # of EI / L^2: third mode's least stiffness of a line that bending holds
LET_GO = 1e-2  # of sqrt(tau L/g): a step in which whatever is let go hardly moves


@kernel
def first_step(I, M, period, calm):
    """Length of the first step [s], from which they grow up to sixteenfold a step.

    As a rule one in which whatever is let go hardly moves. What is calm, hanging at rest in water
    with a free end, is moved by the vessel only and need not begin so: three steps are saved.
    """
    state = scalars(M)
    scale = math.sqrt(max(state.tolerance, 1e-12)) * period
    shortest = LET_GO * scale
    if not calm:
        return shortest
    step = CALM_FIRST[0] * scale
    way = CALM_FIRST[1] * state.tolerance * state.length
    begin = new_motion()
    there = new_motion()
    evaluate_piece(M, motion_piece_of(I, M, find_piece(I, M, 0.0)), 0.0, begin)
    while step > shortest:
        evaluate_piece(M, motion_piece_of(I, M, find_piece(I, M, step)), step, there)
        moved = 0.0
        faster = 0.0
        for i in range(3):
            gone = there.position[i] - begin.position[i]
            moved += (gone - step * begin.velocity[i]) ** 2
            faster += (there.velocity[i] - begin.velocity[i]) ** 2
        if max(math.sqrt(moved), 0.5 * step * math.sqrt(faster)) <= way:
            break
        step *= 0.5
    return max(step, shortest)


@kernel
def measure_line(I, M, words):
    """Write all scalars that follow from the line's lengths and from what it is like, LineFacts.

    Tolerance, gravity, water and motion are in the block.
    """
    state = scalars(M)
    facts = line_facts_at(words, 0)
    tolerance = state.tolerance
    length = facts.length
    rho = state.water_density
    slack = facts.slack != 0.0
    undamped = facts.damping < LIGHT_DAMPING
    allowed = TIME_TOLERANCE * tolerance * length
    if rho == 0.0:
        # Nothing forgets an error, and a stiff line takes an order from the scheme.
        allowed *= UNDAMPED * math.sqrt(tolerance / 1e-3)
    elif undamped:
        allowed *= LIGHTLY_DAMPED
    # Of every line tau times its own length is promised: the shortest one decides.
    state.time_tolerance = allowed * (facts.shortest / length)
    state.length = length
    # What starts slack where drag hardly damps cracks, to no end: its mesh stays. Others there have
    # halves that are not joined again: that would feed a whip that hardly stretches; above a floor
    # what follows the touchdown joins elements, too.
    state.bent = 0.0
    stays = undamped and (slack or facts.above_floor != 0.0)
    if facts.follows != 0.0 and not stays:
        bent = BENDS
        if undamped:
            bent = WHIPS
        elif slack:
            bent = FOLDS
        state.bent = bent * tolerance * length
    state.tension_scale = facts.tension
    state.third_mode = STABILISATION * state.tension_scale
    if slack:
        # What is let go slack snaps, and rings at peaks that no output meets: its tension is left
        # as the steps find it (tension.py reads none that is small against this).
        state.largest_tension = math.inf
    period = math.sqrt(length / max(state.gravity, 1e-3))
    state.period = period
    state.memory = 0.0
    if rho > 0.0 and not (facts.bends != 0.0 and slack and undamped):
        # A heavy body swings on where drag has long stopped a cable: what it misses adds up.
        state.memory = MEMORY * period * facts.memory
    state.first_step = 0.02 * period
    state.step = first_step(I, M, period, facts.calm != 0.0 and not slack and not undamped)
    state.smallest_step = 1e-10 * period
    state.axial = 1.0 / (facts.softness * facts.mass)
    state.undamped = 1.0 if undamped else 0.0
    finest = FINEST_IN_AIR if undamped else FINEST_IN_WATER
    state.order_3 = 0.0
    if slack and tolerance >= finest:
        state.order_3 = ORDER_3_FIRST


@kernel
def line_length(I, M, edge):
    """Length of the line that an element is a part of [m]."""
    if header(I).parts == 0:
        return scalars(M).length
    return cable_of(I, M, int(edge.segment)).line


@kernel
def least_stiffness(M, edge):
    """What any element's mode has at least [N]: no more than EA."""
    state = scalars(M)
    flexural = FLEXURAL * edge.bending_full / (state.length * state.length)
    return min(max(state.third_mode, flexural), 1.0 / edge.compliance)
