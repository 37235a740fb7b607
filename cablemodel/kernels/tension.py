"""Tension of a state whose steps are too long for it: from what holds the line's length now.

A step finds the tension from the differences that it makes of positions; where its line is too
stiff to stretch within the step, that is of order 2 only, and wrong by far more than the positions
(a line in heave, 0.05 tau L and ten times the promise of tension). The positions and velocities at
its end are good enough to do without: the acceleration meets the second derivative of
|r'| = 1 + strain(T) in time and the equations of motion, in which the tension is then linear. What
the strain's own second derivative adds is left out; `worth_reading` bounds it.
"""

import math

from .compile import copy_words, kernel, view
from .environment import vessel_motion
from .layout import (
    B_COMPLIANCE,
    B_MASS,
    BODY_WORDS,
    C_CLAMPED,
    CONSTRAINT_WORDS,
    E_COMPLIANCE,
    E_LENGTH,
    E_MASS,
    E_STRAIN_TERMS,
    EDGE_WORDS,
    I_BODIES,
    I_CONSTRAINTS,
    I_DIMENSION,
    I_FACTORED,
    I_NODES,
    I_PAYOUT,
    O_ACCELERATION,
    O_BODY,
    O_CONSTRAINT,
    O_CONSTRAINT_RESIDUAL,
    O_EDGE,
    O_INCREMENT,
    O_JOINT,
    O_MOTION,
    O_POSITION,
    O_RESIDUAL,
    O_STAGE_T,
    O_TENSION,
    O_TENSION_RATE,
    O_TRIAL_Q,
    O_TRIAL_T,
    O_TRIAL_V,
    O_VELOCITY,
    S_AXIAL,
    S_LARGEST_TENSION,
    S_PASSING,
    S_PERIOD,
    S_STAGE_TENSION,
    S_TENSION_SCALE,
    S_TIME,
    S_TOLERANCE,
)
from .payout import set_top_length
from .system import (
    factorise,
    material_stretch_rate,
    newton_increment,
    recover_tension,
    residual,
)
from .tables import STAGES, TENSION_TEST

PROMISED = 0.75  # of the error of tension that is promised
AXIAL_DAMPED = 2.0  # steps that do not resolve axial waves, in times that one takes along the line
WORSE = 0.05  # error of a step's tension over its tolerance, from which on it is read anew
SHARE = 0.5  # of that error: what leaving out the strain's second derivative may make
SHORT = 0.1  # of the step: time in which waves that it resolves hardly move
LARGEST_CHANGE = 20.0  # of the estimated error, or of half the tolerance: what reading may change
APART = 1e-3  # periods of the line over which the stretch's second derivative is a difference
RIGID = 1e-5  # compliance of an element over what its inertia gives way by in that time


@kernel
def tension_tolerance(M):
    """Error of the top tension allowed at an output [N], by the largest tension so far.

    A typical one stands for it at first.
    """
    largest = max(M[S_LARGEST_TENSION], M[S_TENSION_SCALE])
    return PROMISED * 10.0 * M[S_TOLERANCE] * largest


@kernel
def stage_error(M, scheme):
    """Error of a step's top tension over what is allowed, from those of its implicit stages.

    They scatter about a smooth curve by as much as the last one is wrong.
    """
    stages = STAGES[scheme] - 1
    worst = 0.0
    for i in range(stages):
        missed = 0.0
        for j in range(stages):
            missed += TENSION_TEST[scheme, i, j] * M[S_STAGE_TENSION + j]
        worst = max(worst, abs(missed))
    return worst / tension_tolerance(M)


@kernel
def two_step_error(I, M, dt):
    """The same of a two-step step that is to be accepted: its tension is wrong by dt^2 T'', and so
    is the prediction from the last step's rate."""
    predicted = M[I[O_TENSION] + 2] + dt * M[I[O_TENSION_RATE] + 2]
    return abs(M[I[O_TRIAL_T] + 2] - predicted) / tension_tolerance(M)


@kernel
def kink_force(I, M, t, slow):
    """What a kink of the vessel's acceleration just before t changes of the tension [N].

    The line along itself follows a smooth motion at once, a kink only after the time `slow`.
    """
    at = I[O_MOTION]
    w = M[at + 40 : at + 43]
    for i in range(3):
        w[i] = 0.0
    for k in range(3):
        vessel_motion(I, M, t - (2 - k) * slow)
        for i in range(3):
            w[i] += (1.0 if k != 1 else -2.0) * M[at + 6 + i]
    mass = 0.0
    for node in range(1, I[I_NODES]):
        if I[I[O_JOINT] + node] == 0:
            edge = I[O_EDGE] + node * EDGE_WORDS
            mass += M[edge + E_MASS] * M[edge + E_LENGTH]
    for body in range(I[I_BODIES]):
        mass += M[I[O_BODY] + body * BODY_WORDS + B_MASS]
    return mass * math.sqrt(w[0] ** 2 + w[1] ** 2 + w[2] ** 2)


@kernel
def worth_reading(I, M, dt, pull):
    """Whether to read the tension anew after the trial, a step of dt that is to be accepted and
    whose own tension is wrong by `pull` tolerances.

    Not where steps resolve axial waves, where a strain curve is no line, where an end is clamped,
    or while a body passes the tow point.
    """
    slow = 1.0 / math.sqrt(M[S_AXIAL])
    if pull < WORSE or dt < AXIAL_DAMPED * slow or M[S_PASSING] != 0.0:
        return False  # by far the most steps
    for n in range(I[I_CONSTRAINTS]):
        if M[I[O_CONSTRAINT] + n * CONSTRAINT_WORDS + C_CLAMPED] != 0.0:
            return False
    for node in range(1, I[I_NODES]):
        if I[I[O_JOINT] + node] == 0:
            if M[I[O_EDGE] + node * EDGE_WORDS + E_STRAIN_TERMS] != 1.0:
                return False
    # Its second derivative times the square of a long step is no more than its change.
    change = abs(M[I[O_TRIAL_T] + 2] - M[I[O_TENSION] + 2])
    neglected = 0.5 * change * (slow / dt) ** 2
    allowed = SHARE * tension_tolerance(M)
    if neglected >= allowed * pull:
        return False
    return kink_force(I, M, M[S_TIME] + dt, slow) < allowed * pull


@kernel
def stiffen(I, M, ca):
    """Make every element all but inextensible in a matrix whose mass is ca times that of the line.

    Returns nothing; `soften` gives their compliances back.
    """
    for node in range(1, I[I_NODES]):
        edge = I[O_EDGE] + node * EDGE_WORDS
        M[I[O_STAGE_T] + node] = M[edge + E_COMPLIANCE]
        if I[I[O_JOINT] + node] == 0:
            h = M[edge + E_LENGTH]
            M[edge + E_COMPLIANCE] = RIGID / (ca * M[edge + E_MASS] * h * h)
    for body in range(I[I_BODIES]):
        row = I[O_BODY] + body * BODY_WORDS
        M[I[O_STAGE_T] + I[I_NODES] + body] = M[row + B_COMPLIANCE]
        M[row + B_COMPLIANCE] = RIGID / (ca * M[row + B_MASS])


@kernel
def soften(I, M):
    """Undo `stiffen`."""
    for node in range(1, I[I_NODES]):
        M[I[O_EDGE] + node * EDGE_WORDS + E_COMPLIANCE] = M[I[O_STAGE_T] + node]
    for body in range(I[I_BODIES]):
        row = I[O_BODY] + body * BODY_WORDS
        M[row + B_COMPLIANCE] = M[I[O_STAGE_T] + I[I_NODES] + body]


@kernel
def read_tension(I, M, dt, pull):
    """Tensions and accelerations of the state after a step of dt from its positions and velocities.

    pull: error of the step's top tension, in tolerances: nothing is taken over that is much further
    from it. The velocities are those of the state without what stretches the line; the state
    keeps its own. What is far too quick for the step, as bending of short elements, has to follow:
    the matrix is that of a step of SHORT dt.
    """
    count = 2 * I[I_DIMENSION] * I[I_NODES]
    words = 2 * I[I_NODES]
    q = view(M, I[O_POSITION], count)
    v = view(M, I[O_TRIAL_V], count)
    a = view(M, I[O_ACCELERATION], count)
    near = view(M, I[O_TRIAL_Q], count)
    before = view(M, I[O_TENSION], words)
    tension = view(M, I[O_TRIAL_T], words)
    forces = view(M, I[O_RESIDUAL], count)
    constraint = view(M, I[O_CONSTRAINT_RESIDUAL], words)
    second = view(M, I[O_STAGE_T], words)
    x = view(M, I[O_INCREMENT], count)
    short = SHORT * dt
    ca = 1.0 / (short * short)
    copy_words(I, I[O_TRIAL_V], I[O_VELOCITY], count)
    copy_words(I, I[O_TRIAL_T], I[O_TENSION], words)
    stiffen(I, M, ca)
    failed = factorise(I, M, q, v, a, before, ca, 0.0)
    soften(I, M)
    I[I_FACTORED] = 0
    if failed != 0:
        return
    if I[I_PAYOUT] != 0:
        residual(I, M, q, v, a, before, forces, constraint)
    material_stretch_rate(I, M, v, constraint)
    forces[:] = 0.0
    newton_increment(I, M, forces, constraint, x)
    for n in range(count):
        v[n] += x[n]
    # The second derivative of the stretch along the present motion.
    step = APART * M[S_PERIOD]
    second[:] = 0.0
    for k in range(3):
        t = (k - 1) * step
        for n in range(count):
            near[n] = q[n] + t * v[n] + 0.5 * t * t * a[n]
        if I[I_PAYOUT] != 0:
            set_top_length(I, M, M[S_TIME] + dt + t)
        residual(I, M, near, v, a, before, forces, constraint)
        weight = -2.0 if k == 1 else 1.0
        for n in range(words):
            second[n] += weight * constraint[n]
    scale = short * short / (step * step)
    if I[I_PAYOUT] != 0:
        set_top_length(I, M, M[S_TIME] + dt)
    residual(I, M, q, v, a, before, forces, constraint)
    for n in range(words):
        constraint[n] = scale * second[n]
    newton_increment(I, M, forces, constraint, x)
    recover_tension(I, M, constraint, x, tension)
    if abs(tension[2] - before[2]) <= LARGEST_CHANGE * max(pull, 0.5) * tension_tolerance(M):
        copy_words(I, I[O_TENSION], I[O_TRIAL_T], words)
        for n in range(count):
            a[n] += ca * x[n]
