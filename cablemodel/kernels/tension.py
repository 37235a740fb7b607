"""Tension of a state whose steps are too long for it: from what holds the line's length now.

A step finds the tension from the differences that it makes of positions; where its line is too
stiff to stretch within the step, that is of order 2 only, and wrong by far more than the positions
(a line in heave, 0.05 tau L and ten times the promise of tension). The positions and velocities at
its end are good enough to do without: the acceleration meets the second derivative of
|r'| = 1 + strain(T) in time and the equations of motion, in which the tension is then linear. What
the strain's own second derivative adds, compliance times that of the tension, is left out at first,
and added from how the tension so found changes with the motion (`add_swing`).
"""

import math

from .compile import copy_words, kernel, outlined, view
from .environment import current_rate, vessel_motion
from .floor_surface import may_touch
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
    I_CAPACITY,
    I_CONSTRAINTS,
    I_DIMENSION,
    I_FACTORED,
    I_FLOOR,
    I_NODES,
    I_PAYOUT,
    O_ACCELERATION,
    O_BASE_Q,
    O_BASE_V,
    O_BODY,
    O_CONSTRAINT,
    O_CONSTRAINT_RESIDUAL,
    O_EDGE,
    O_INCREMENT,
    O_JOINT,
    O_MOTION,
    O_POSITION,
    O_RESIDUAL,
    O_STAGE_A,
    O_STAGE_T,
    O_STAGE_V,
    O_TENSION,
    O_TENSION_RATE,
    O_TRIAL_A,
    O_TRIAL_Q,
    O_TRIAL_T,
    O_TRIAL_V,
    O_VELOCITY,
    S_AXIAL,
    S_LARGEST_TENSION,
    S_LENGTH,
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
    impose_motion,
    material_stretch_rate,
    newton_increment,
    recover_tension,
    residual,
    set_time,
)
from .tables import STAGES, TENSION_TEST

PROMISED = 0.75  # of the error of tension that is promised
AXIAL_DAMPED = 1.25  # steps that do not resolve axial waves, in times that one takes along the line
WORSE = 0.05  # error of a step's tension over its tolerance, from which on it is read anew
SHARE = 0.5  # of that error: what a kink of the vessel's acceleration may change
KINKED = 4.0  # tolerances: the same where that error is small
SHORT = 0.1  # of the step: time in which waves that it resolves hardly move
LARGEST_CHANGE = 20.0, 0.5  # of the error: what reading may change; tolerances it counts as
LARGEST_ANCHORED = 12.0, 0.15  # the same for an anchored line, which moves by its stretch when taut
APART = 1e-3  # periods of the line over which the stretch's second derivative is a difference
SWINGS = 0.25  # of the largest tension: its second derivative times the square of a long step
STILL = 0.05  # of the tolerance: what the strain's own second derivative may add unseen
LARGEST_SWING = 0.1  # of the largest tension: where it adds more, the line rings along itself
ASIDE = 0.25  # of the step: how far to both sides of an output it is looked for
RIGID = 1e-3  # compliance of the line over what its inertia gives way by in a matrix's step


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
def inertia(I, M):
    """Mass of all that hangs on the tow point [kg]."""
    mass = 0.0
    for node in range(1, I[I_NODES]):
        if I[I[O_JOINT] + node] == 0:
            edge = I[O_EDGE] + node * EDGE_WORDS
            mass += M[edge + E_MASS] * M[edge + E_LENGTH]
    for body in range(I[I_BODIES]):
        mass += M[I[O_BODY] + body * BODY_WORDS + B_MASS]
    return mass


@kernel
def kink_force(I, M, t, apart):
    """What a kink of the vessel's acceleration near t changes of the tension [N].

    The third difference of the acceleration over four times `apart`: a smooth one has none, where
    a kink is as large as what the acceleration changes by over that time.
    """
    at = I[O_MOTION]
    w = M[at + 40 : at + 43]
    for i in range(3):
        w[i] = 0.0
    for k in range(4):
        vessel_motion(I, M, t + (k - 2) * apart)
        weight = 3.0 if k == 1 or k == 2 else 1.0
        for i in range(3):
            w[i] += (weight if k % 2 == 1 else -weight) * M[at + 6 + i]
    vessel_motion(I, M, t)
    return inertia(I, M) * math.sqrt(w[0] ** 2 + w[1] ** 2 + w[2] ** 2)


@kernel
def worth_reading(I, M, dt, span, pull):
    """Whether to read the tension anew after the trial, a step of dt that is to be accepted and
    whose own tension is wrong by `pull` tolerances: 0 no, 1 yes, 2 with `add_swing`.

    span: the longer of this step and the one before it, whose error a short one has. Not where
    steps resolve axial waves, where a strain curve is no line, where an end is clamped, or while a
    body passes the tow point.
    """
    slow = 1.0 / math.sqrt(M[S_AXIAL])
    if span < AXIAL_DAMPED * slow or M[S_PASSING] != 0.0:
        return 0
    if pull < WORSE:
        return 0  # by far the most steps
    for n in range(I[I_CONSTRAINTS]):
        if M[I[O_CONSTRAINT] + n * CONSTRAINT_WORDS + C_CLAMPED] != 0.0:
            return 0
    for node in range(1, I[I_NODES]):
        if I[I[O_JOINT] + node] == 0:
            if M[I[O_EDGE] + node * EDGE_WORDS + E_STRAIN_TERMS] != 1.0:
                return 0
    tolerance = tension_tolerance(M)
    if kink_force(I, M, M[S_TIME] + dt, slow) >= tolerance * max(SHARE * pull, KINKED):
        return 0
    # A long step hardly follows the tension up and down: by its square, the second derivative.
    added = SWINGS * M[S_LARGEST_TENSION] * (slow / span) ** 2
    if added < STILL * tolerance:
        return 1
    if I[I_FLOOR] != 0:
        q = view(M, I[O_TRIAL_Q], 2 * I[I_DIMENSION] * I[I_NODES])
        if may_touch(I, M, q, view(M, I[O_MOTION] + 28, 9)):
            # Cable that lands has no second derivative: a lay read so rings by a per cent. Without
            # it what is read may be wrong by more than the step's own tension.
            return 1 if added < pull * tolerance else 0
    return 2


@kernel
def stiffen(I, M, ca):
    """Make the line all but inextensible in a matrix whose mass is ca times that of the line.

    `soften` gives the compliances of elements and bodies back.
    """
    soft = RIGID / (ca * inertia(I, M))
    length = M[S_LENGTH]
    for node in range(1, I[I_NODES]):
        edge = I[O_EDGE] + node * EDGE_WORDS
        M[I[O_STAGE_T] + node] = M[edge + E_COMPLIANCE]
        if I[I[O_JOINT] + node] == 0:
            M[edge + E_COMPLIANCE] = soft / length
    for body in range(I[I_BODIES]):
        row = I[O_BODY] + body * BODY_WORDS
        M[I[O_STAGE_T] + I[I_NODES] + body] = M[row + B_COMPLIANCE]
        M[row + B_COMPLIANCE] = soft


@kernel
def soften(I, M):
    """Undo `stiffen`."""
    for node in range(1, I[I_NODES]):
        M[I[O_EDGE] + node * EDGE_WORDS + E_COMPLIANCE] = M[I[O_STAGE_T] + node]
    for body in range(I[I_BODIES]):
        row = I[O_BODY] + body * BODY_WORDS
        M[row + B_COMPLIANCE] = M[I[O_STAGE_T] + I[I_NODES] + body]


@outlined
def balance(I, M, q, v, a, tension, second, t, short):
    """Make accelerations and tensions at time t meet the equations of motion and the second
    derivative of |r'| = 1 + strain(T).

    second: that of the tensions. The stored matrix is that of a step of `short`.
    """
    count = 2 * I[I_DIMENSION] * I[I_NODES]
    words = 2 * I[I_NODES]
    near = view(M, I[O_TRIAL_Q], count)
    strained = view(M, I[O_STAGE_A], words)
    forces = view(M, I[O_RESIDUAL], count)
    constraint = view(M, I[O_CONSTRAINT_RESIDUAL], words)
    curved = view(M, I[O_STAGE_T], words)
    x = view(M, I[O_INCREMENT], count)
    step = APART * M[S_PERIOD]
    curved[:] = 0.0
    for k in range(3):
        ahead = (k - 1) * step
        half = 0.5 * ahead * ahead
        for n in range(count):
            near[n] = q[n] + ahead * v[n] + half * a[n]
        for n in range(words):
            strained[n] = tension[n] + half * second[n]
        if I[I_PAYOUT] != 0:
            set_top_length(I, M, t + ahead)
        residual(I, M, near, v, a, strained, forces, constraint)
        weight = -2.0 if k == 1 else 1.0
        for n in range(words):
            curved[n] += weight * constraint[n]
    if I[I_PAYOUT] != 0:
        set_top_length(I, M, t)
    residual(I, M, q, v, a, tension, forces, constraint)
    scale = short * short / (step * step)
    for n in range(words):
        constraint[n] = scale * curved[n]
    newton_increment(I, M, forces, constraint, x)
    recover_tension(I, M, constraint, x, tension)
    inverse = 1.0 / (short * short)
    for n in range(count):
        a[n] += inverse * x[n]


@outlined
def add_stretching(I, M, q, v, a, tension, rate):
    """Add to velocities that stretch nothing what stretches the line as its tension changes.

    rate: of the tensions [N/s]. An anchored line gives way by it, and moves across itself.
    """
    count = 2 * I[I_DIMENSION] * I[I_NODES]
    words = 2 * I[I_NODES]
    later = view(M, I[O_STAGE_A], words)
    forces = view(M, I[O_RESIDUAL], count)
    constraint = view(M, I[O_CONSTRAINT_RESIDUAL], words)
    now = view(M, I[O_STAGE_T], words)
    x = view(M, I[O_INCREMENT], count)
    residual(I, M, q, v, a, tension, forces, constraint)
    for n in range(words):
        now[n] = constraint[n]
        later[n] = tension[n] + rate[n]
    residual(I, M, q, v, a, later, forces, constraint)
    for n in range(words):
        constraint[n] -= now[n]
    forces[:] = 0.0
    newton_increment(I, M, forces, constraint, x)
    for n in range(count):
        v[n] += x[n]


@outlined
def look_aside(I, M, q, v, a, jerk, second, t, aside, short):
    """Balance accelerations and tensions at t - aside and t + aside of a line that moves on so.

    They stand in O_STAGE_V: accelerations before and after, then the tensions.
    """
    count = 2 * I[I_DIMENSION] * I[I_NODES]
    words = 2 * I[I_NODES]
    room = 6 * I[I_CAPACITY]
    place = view(M, I[O_BASE_Q], count)
    speed = view(M, I[O_BASE_V], count)
    for side in range(2):
        there = view(M, I[O_STAGE_V] + side * room, count)
        pull = view(M, I[O_STAGE_V] + (2 + side) * room, words)
        ahead = aside if side == 1 else -aside
        for n in range(count):
            speed[n] = v[n] + ahead * (a[n] + 0.5 * ahead * jerk[n])
            place[n] = q[n] + ahead * (v[n] + ahead * (0.5 * a[n] + ahead * jerk[n] / 6.0))
        set_time(I, M, t + ahead)
        current_rate(I, M, t, False)  # beyond a kink of the current the line would jump
        impose_motion(I, M, t + ahead, place, speed, there)
        balance(I, M, place, speed, there, pull, second, t + ahead, short)
    set_time(I, M, t)
    if I[I_PAYOUT] != 0:
        set_top_length(I, M, t)


@outlined
def add_swing(I, M, q, v, a, tension, t, aside, short):
    """Add to accelerations and tensions at t what the rate and second derivative of the stretch do.

    They are the compliance times the tension's, which are found from the tensions at t - aside and
    t + aside of a line that moves on as if it could not stretch: first with the acceleration at t,
    then with its rate, too, which the tension of what moves across itself depends on.
    """
    count = 2 * I[I_DIMENSION] * I[I_NODES]
    words = 2 * I[I_NODES]
    room = 6 * I[I_CAPACITY]
    a_before = view(M, I[O_STAGE_V], count)
    a_after = view(M, I[O_STAGE_V] + room, count)
    before = view(M, I[O_STAGE_V] + 2 * room, words)
    after = view(M, I[O_STAGE_V] + 3 * room, words)
    second = view(M, I[O_STAGE_A] + room, words)
    jerk = view(M, I[O_STAGE_A] + 2 * room, count)
    rate = view(M, I[O_STAGE_A] + 3 * room, words)
    second[:] = 0.0
    jerk[:] = 0.0
    for n in range(count):
        a_before[n] = a[n]
        a_after[n] = a[n]
    for n in range(words):
        before[n] = tension[n]
        after[n] = tension[n]
    look_aside(I, M, q, v, a, jerk, second, t, aside, short)
    for n in range(count):
        jerk[n] = (a_after[n] - a_before[n]) / (2.0 * aside)
    for n in range(words):
        rate[n] = (after[n] - before[n]) / (2.0 * aside)
    add_stretching(I, M, q, v, a, tension, rate)
    balance(I, M, q, v, a, tension, second, t, short)
    look_aside(I, M, q, v, a, jerk, second, t, aside, short)
    for n in range(words):
        second[n] = (before[n] - 2.0 * tension[n] + after[n]) / (aside * aside)
    balance(I, M, q, v, a, tension, second, t, short)


@kernel
def read_tension(I, M, dt, span, pull, swings):
    """Tensions and accelerations of the state after a step of dt from its positions and velocities.

    span, pull: as in `worth_reading`, swings: whether to `add_swing`. Nothing is taken over that
    is anywhere much further from the step's tension than that at the top is wrong, nor where the
    line rings along itself, nor of an anchored line that gives way by its stretch: one that is all
    but taut cannot move without. The velocities are those of the state without what stretches the
    line; the state keeps its own. What is far too quick for the step, as bending of short
    elements, has to follow: the matrix is that of a step of SHORT span.
    """
    count = 2 * I[I_DIMENSION] * I[I_NODES]
    words = 2 * I[I_NODES]
    q = view(M, I[O_POSITION], count)
    v = view(M, I[O_TRIAL_V], count)
    a = view(M, I[O_TRIAL_A], count)
    before = view(M, I[O_TENSION], words)
    tension = view(M, I[O_TRIAL_T], words)
    forces = view(M, I[O_RESIDUAL], count)
    constraint = view(M, I[O_CONSTRAINT_RESIDUAL], words)
    x = view(M, I[O_INCREMENT], count)
    anchored = I[I_CONSTRAINTS] > 1
    short = SHORT * span
    aside = max(ASIDE * span, 1.0 / math.sqrt(M[S_AXIAL]))
    if swings:
        # What is far too quick for it would grow aside, by (aside / short)^2 / 2 at each look.
        short = max(short, aside)
    ca = 1.0 / (short * short)
    t = M[S_TIME] + dt
    copy_words(I, I[O_TRIAL_V], I[O_VELOCITY], count)
    copy_words(I, I[O_TRIAL_A], I[O_ACCELERATION], count)
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
    still = view(M, I[O_STAGE_V], words)
    still[:] = 0.0
    balance(I, M, q, v, a, tension, still, t, short)
    if swings:
        before_it = tension[2]
        add_swing(I, M, q, v, a, tension, t, aside, short)
        added = abs(tension[2] - before_it)
        if not added <= LARGEST_SWING * M[S_LARGEST_TENSION]:
            return
        if anchored and added > pull * tension_tolerance(M):
            return
    changed = 0.0
    for node in range(1, I[I_NODES]):
        if I[I[O_JOINT] + node] == 0:
            changed = max(changed, abs(tension[2 * node] - before[2 * node]))
    most, least = LARGEST_CHANGE
    if anchored:
        most, least = LARGEST_ANCHORED
    if changed <= most * max(pull, least) * tension_tolerance(M):
        copy_words(I, I[O_TENSION], I[O_TRIAL_T], words)
        copy_words(I, I[O_ACCELERATION], I[O_TRIAL_A], count)
