"""What the run of a line is measured by, from its lengths: tolerances, times, the mesh's allowance.

Of a scene as it is built, and of an FMU whose lengths and coefficients are set before the start.
"""

import math

from .compile import kernel
from .environment import evaluate_piece, find_piece
from .layout import (
    FACT_ABOVE_FLOOR,
    FACT_BENDS,
    FACT_CALM,
    FACT_DAMPING,
    FACT_FOLLOWS,
    FACT_LENGTH,
    FACT_MASS,
    FACT_SLACK,
    FACT_SOFTNESS,
    FACT_TENSION,
    LIGHT_DAMPING,
    O_MOTION,
    O_PIECES,
    PIECE_WORDS,
    S_AXIAL,
    S_BENT,
    S_FIRST_STEP,
    S_GRAVITY,
    S_LARGEST_TENSION,
    S_LENGTH,
    S_MEMORY,
    S_ORDER_3,
    S_PERIOD,
    S_SMALLEST_STEP,
    S_STEP,
    S_TENSION_SCALE,
    S_TIME_TOLERANCE,
    S_TOLERANCE,
    S_UNDAMPED,
    S_WATER_DENSITY,
)

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
LET_GO = 1e-2  # of sqrt(tau L/g): a step in which whatever is let go hardly moves


@kernel
def first_step(I, M, period, calm):
    """Length of the first step [s], from which they grow up to sixteenfold a step.

    As a rule one in which whatever is let go hardly moves. What is calm, hanging at rest in water
    with a free end, is moved by the vessel only and need not begin so: three steps are saved.
    """
    scale = math.sqrt(max(M[S_TOLERANCE], 1e-12)) * period
    shortest = LET_GO * scale
    if not calm:
        return shortest
    step = CALM_FIRST[0] * scale
    way = CALM_FIRST[1] * M[S_TOLERANCE] * M[S_LENGTH]
    begin = M[I[O_MOTION] + 16 : I[O_MOTION] + 25]
    there = M[I[O_MOTION] + 25 : I[O_MOTION] + 34]
    evaluate_piece(M, I[O_PIECES] + find_piece(I, M, 0.0) * PIECE_WORDS, 0.0, begin)
    while step > shortest:
        evaluate_piece(M, I[O_PIECES] + find_piece(I, M, step) * PIECE_WORDS, step, there)
        moved = 0.0
        faster = 0.0
        for i in range(3):
            moved += (there[i] - begin[i] - step * begin[3 + i]) ** 2
            faster += (there[3 + i] - begin[3 + i]) ** 2
        if max(math.sqrt(moved), 0.5 * step * math.sqrt(faster)) <= way:
            break
        step *= 0.5
    return max(step, shortest)


@kernel
def measure_line(I, M, facts):
    """Write all scalars that follow from the line's lengths and from what it is like.

    facts: FACT_WORDS, see layout.py. Tolerance, gravity, water and motion are in the block.
    """
    tolerance = M[S_TOLERANCE]
    length = facts[FACT_LENGTH]
    rho = M[S_WATER_DENSITY]
    slack = facts[FACT_SLACK] != 0.0
    undamped = facts[FACT_DAMPING] < LIGHT_DAMPING
    allowed = TIME_TOLERANCE * tolerance * length
    if rho == 0.0:
        # Nothing forgets an error, and a stiff line takes an order from the scheme.
        allowed *= UNDAMPED * math.sqrt(tolerance / 1e-3)
    elif undamped:
        allowed *= LIGHTLY_DAMPED
    M[S_TIME_TOLERANCE] = allowed
    M[S_LENGTH] = length
    # What starts slack where drag hardly damps cracks, to no end: its mesh stays. Others there have
    # halves that are not joined again: that would feed a whip that hardly stretches; above a floor
    # what follows the touchdown joins elements, too.
    M[S_BENT] = 0.0
    stays = undamped and (slack or facts[FACT_ABOVE_FLOOR] != 0.0)
    if facts[FACT_FOLLOWS] != 0.0 and not stays:
        bent = BENDS
        if undamped:
            bent = WHIPS
        elif slack:
            bent = FOLDS
        M[S_BENT] = bent * tolerance * length
    M[S_TENSION_SCALE] = facts[FACT_TENSION]
    if slack:
        # What is let go slack snaps, and rings at peaks that no output meets: its tension is left
        # as the steps find it (tension.py reads none that is small against this).
        M[S_LARGEST_TENSION] = math.inf
    period = math.sqrt(length / max(M[S_GRAVITY], 1e-3))
    M[S_PERIOD] = period
    M[S_MEMORY] = 0.0
    if rho > 0.0 and not (facts[FACT_BENDS] != 0.0 and slack and undamped):
        M[S_MEMORY] = MEMORY * period
    M[S_FIRST_STEP] = 0.02 * period
    M[S_STEP] = first_step(I, M, period, facts[FACT_CALM] != 0.0 and not slack and not undamped)
    M[S_SMALLEST_STEP] = 1e-10 * period
    M[S_AXIAL] = 1.0 / (facts[FACT_SOFTNESS] * facts[FACT_MASS])
    M[S_UNDAMPED] = 1.0 if undamped else 0.0
    finest = FINEST_IN_AIR if undamped else FINEST_IN_WATER
    M[S_ORDER_3] = 0.0
    if slack and tolerance >= finest:
        M[S_ORDER_3] = ORDER_3_FIRST
