"""The tension of a line that does not ring, solved for where steps are too long to follow it.

The acceleration meets the second derivative of |r'| = 1 + strain(T) in time and the equations of
motion, in which the tension is linear. That holds for a line that does not ring along itself. One
that rings leaves its stages apart, but by its end a long step has damped it, and the tension that
is solved for is that of the step: such a step is refused.
"""

import math

from cablemodel.solvers.finite_element.kernels.line.newton import increment_norm
from cablemodel.solvers.finite_element.kernels.line.system import (
    constraints,
    factorise,
    impose_motion,
    material_stretch_rate,
    newton_increment,
    recover_tension,
    residual,
    set_time,
)
from cablemodel.solvers.finite_element.kernels.mesh.payout import set_top_length
from cablemodel.solvers.finite_element.kernels.time.consistency import vessel_jump
from cablemodel.solvers.finite_element.kernels.time.watched_tension import tension_tolerance
from cablemodel.solvers.shared.access import (
    body_of,
    constraint_of,
    edge_of,
    free_body_of,
    header,
    scalars,
    spare_row,
    tension_of,
    tension_rate_of,
    trial_tension_of,
    winch_of,
)
from cablemodel.solvers.shared.compile import copy_words, kernel, outlined, view
from cablemodel.solvers.shared.environment import current_rate, surge_jump
from cablemodel.solvers.shared.layout import SoftnessRows, SolvedRows

SOLVED_Q, SOLVED_V = SolvedRows.places.word, SolvedRows.velocities.word
SOLVED_A, SOLVED_T = SolvedRows.accelerations.word, SolvedRows.tensions.word
SOLVED_RATE, CURVED = SolvedRows.rates.word, SolvedRows.curved.word
STRAINED, SOFTNESS = SolvedRows.strained.word, SoftnessRows.softness.word
SOLVED_FROM = 0.25  # of the error allowed: forgotten scatter from which on tensions are solved for
LARGEST_CHANGE = 20.0  # of the scatter: what solving may change
SHORT = 0.1  # of the step: that of the matrix with which the tension is solved for
DIFFERENCE_STEP = 1e-3  # periods of the line: for the stretch's derivatives
TENSION_RIGID = 1e-3  # compliance of the line over what inertia gives way by in the matrix's step
BEND_OF_CHANGE = 0.25  # of what a tension changes by in a step: what it bends by at least


@kernel
def inertia(I, M):
    """Mass of all lines and bodies [kg]."""
    head = header(I)
    mass = 0.0
    for node in range(1, head.nodes):
        if I[head.joint + node] == 0:
            edge = edge_of(I, M, node)
            mass += edge.mass * edge.length
    for body in range(head.body_count):
        mass += body_of(I, M, body).mass
    for body in range(head.free_count):
        mass += free_body_of(I, M, body).solid[0]
    return mass


@kernel
def may_be_solved_for(I, M):
    """Whether tensions can be solved for: of one line, with Hooke's law and no damping, ends that
    are hinged, and no body of finite length at the tow point."""
    head = header(I)
    if head.parts != 0 or (head.rigid > 0 and winch_of(I, M, 0).passing_body != 0.0):
        return False
    for n in range(head.constraint_count):
        if constraint_of(I, M, n).clamped != 0.0:
            return False
    for node in range(1, head.nodes):
        if I[head.joint + node] == 0:
            edge = edge_of(I, M, node)
            if edge.strain_terms != 1.0 or edge.damping != 0.0:
                return False
    return True


@kernel
def stiffen(I, M, ca):
    """Make the line all but inextensible in a matrix whose mass is ca times that of the line.

    With each element's own mass a light line with a heavy body would keep a fifth of the error.
    `soften` gives the compliances of elements and bodies back.
    """
    head = header(I)
    state = scalars(M)
    soft = TENSION_RIGID / (ca * inertia(I, M))
    length = state.length
    kept = spare_row(I, SOFTNESS)
    for node in range(1, head.nodes):
        edge = edge_of(I, M, node)
        M[kept + node] = edge.compliance
        if I[head.joint + node] == 0:
            edge.compliance = soft / length
    for body in range(head.body_count):
        row = body_of(I, M, body)
        M[kept + head.nodes + body] = row.compliance
        row.compliance = soft


@kernel
def soften(I, M):
    """Undo `stiffen`."""
    head = header(I)
    kept = spare_row(I, SOFTNESS)
    for node in range(1, head.nodes):
        edge_of(I, M, node).compliance = M[kept + node]
    for body in range(head.body_count):
        row = body_of(I, M, body)
        row.compliance = M[kept + head.nodes + body]


@outlined
def solve_for_tension(I, M, t, short, q, v, tension):
    """Tensions and accelerations of a line that does not ring, at time t, from positions and
    velocities, and what these are then, into the regions SOLVED_...

    q, v: (nodes, 2, dimension), tension: (nodes, 2), near which it is. The region SOLVED_A holds
    accelerations near those that are looked for, STRAINED the rates of the tensions. short: the
    matrix is that of a step so long [s]; what is far too quick for it has to follow.

    Returns by how much the top tension, and that of what the velocities stretch the line by, are
    other ones [tolerances]; negative: there is no answer.
    """
    head = header(I)
    state = scalars(M)
    count = 2 * head.dimension * head.nodes
    words = 2 * head.nodes
    solved_q = view(M, spare_row(I, SOLVED_Q), count)
    solved_v = view(M, spare_row(I, SOLVED_V), count)
    a = view(M, spare_row(I, SOLVED_A), count)
    solved = view(M, spare_row(I, SOLVED_T), words)
    curved = view(M, spare_row(I, CURVED), words)
    strained = view(M, spare_row(I, STRAINED), words)
    forces = view(M, head.residual, count)
    constraint = view(M, head.constraint_residual, words)
    x = view(M, head.increment, count)
    ca = 1.0 / (short * short)
    set_time(I, M, t)
    if t <= state.time + state.smallest_step:
        current_rate(I, M, t, True)  # as the water goes on
    for n in range(count):
        solved_q[n] = q[n]
        solved_v[n] = v[n]
    step = DIFFERENCE_STEP * state.period
    for n in range(words):
        solved[n] = tension[n]
        strained[n] = tension[n] + step * strained[n]
    impose_motion(I, M, t, solved_q, solved_v, a)
    stiffen(I, M, ca)
    failed = factorise(I, M, q, solved_v, a, tension, ca, 1.0 / short)
    soften(I, M)
    head.factored = 0
    if failed != 0:
        return -1.0, -1.0
    # Velocities that stretch the line at the rate at which the tensions change.
    constraints(I, M, q, solved_v, a, strained, forces, curved)
    constraints(I, M, q, solved_v, a, tension, forces, constraint)
    for n in range(words):
        curved[n] = (curved[n] - constraint[n]) / step
    material_stretch_rate(I, M, solved_v, constraint)
    for n in range(words):
        constraint[n] += curved[n]
        curved[n] = 0.0
    forces[:] = 0.0
    newton_increment(I, M, forces, constraint, x)
    speed, _where = increment_norm(I, M, x)
    for n in range(count):
        solved_v[n] += x[n]
    # The second derivative of |r'|, of a motion without a jerk.
    for k in range(3):
        ahead = (k - 1) * step
        for n in range(count):
            solved_q[n] = q[n] + ahead * (solved_v[n] + 0.5 * ahead * a[n])
        if head.payout != 0:
            set_top_length(I, M, t + ahead)
        constraints(I, M, solved_q, solved_v, a, tension, forces, constraint)
        weight = -2.0 if k == 1 else 1.0
        for n in range(words):
            curved[n] += weight * constraint[n]
    if head.payout != 0:
        set_top_length(I, M, t)
    residual(I, M, q, solved_v, a, tension, forces, constraint)
    scale = short * short / (step * step)
    for n in range(words):
        constraint[n] = scale * curved[n]
    newton_increment(I, M, forces, constraint, x)
    recover_tension(I, M, constraint, x, solved, False)
    for n in range(count):
        a[n] += ca * x[n]
    # Positions whose stretch has these tensions.
    constraints(I, M, q, solved_v, a, solved, forces, constraint)
    forces[:] = 0.0
    newton_increment(I, M, forces, constraint, x)
    for n in range(count):
        solved_q[n] = q[n] + x[n]
    change = abs(solved[2] - tension[2])
    if not change < 1e300:
        return -1.0, -1.0
    allowed = tension_tolerance(M)
    return change / allowed, inertia(I, M) * math.sqrt(state.axial) * speed / allowed


@kernel
def solve_at_end(I, M, dt):
    """`solve_for_tension` at the trial after a step of dt: by how much the top tension changes."""
    head = header(I)
    state = scalars(M)
    count = 2 * head.dimension * head.nodes
    words = 2 * head.nodes
    copy_words(I, spare_row(I, SOLVED_A), head.trial_acceleration, count)
    tension = view(M, head.trial_tension, words)
    rate = view(M, spare_row(I, STRAINED), words)
    for n in range(words):
        rate[n] = (tension[n] - M[head.tension + n]) / dt
    q = view(M, head.trial_position, count)
    v = view(M, head.trial_velocity, count)
    change, _moving = solve_for_tension(I, M, state.time + dt, SHORT * dt, q, v, tension)
    for n in range(words):
        solved = M[spare_row(I, SOLVED_T) + n]
        M[spare_row(I, SOLVED_RATE) + n] = (solved - M[head.tension + n]) / dt
    return change


@kernel
def begins_smoothly(I, M):
    """Whether the accelerations of vessel and water go on as they were in the last step."""
    state = scalars(M)
    surge, _most = surge_jump(I, M, state.time)
    return inertia(I, M) * (vessel_jump(I, M) + surge) <= SOLVED_FROM * tension_tolerance(M)


@kernel
def rings(I, M, dt):
    """Whether the state rings along itself by more than is allowed, as a step of dt begins at
    whose end tensions have been solved for: they tell the rate at which what rings not changes.
    """
    head = header(I)
    state = scalars(M)
    count = 2 * head.dimension * head.nodes
    words = 2 * head.nodes
    tension = view(M, head.tension, words)
    rate = view(M, spare_row(I, STRAINED), words)
    for n in range(words):
        rate[n] = (M[spare_row(I, SOLVED_T) + n] - tension[n]) / dt
    copy_words(I, spare_row(I, SOLVED_A), head.acceleration, count)
    q = view(M, head.position, count)
    v = view(M, head.velocity, count)
    change, moving = solve_for_tension(I, M, state.time, SHORT * dt, q, v, tension)
    return not (0.0 <= change and change <= 1.0 and moving <= 1.0)


@kernel
def take_solved(I, M):
    """Make what was solved for the state: it does not ring."""
    head = header(I)
    count = 2 * head.dimension * head.nodes
    copy_words(I, head.position, spare_row(I, SOLVED_Q), count)
    copy_words(I, head.velocity, spare_row(I, SOLVED_V), count)
    copy_words(I, head.acceleration, spare_row(I, SOLVED_A), count)
    copy_words(I, head.tension, spare_row(I, SOLVED_T), 2 * head.nodes)
    copy_words(I, head.tension_rate, spare_row(I, SOLVED_RATE), 2 * head.nodes)
    head.settled = 1
    head.has_history = 0  # the two-step scheme would differentiate what was solved for


@kernel
def bend_of_tension(I, M, dt):
    """What the top tension changes by in a step of dt, or in the one before it, and twice what
    that differs by: a bound of its second derivative times the square of dt [tolerances]."""
    change = trial_tension_of(I, M, 1).mean - tension_of(I, M, 1).mean
    before = dt * tension_rate_of(I, M, 1).mean
    largest = max(BEND_OF_CHANGE * max(abs(change), abs(before)), 2.0 * abs(change - before))
    return largest / tension_tolerance(M)


@kernel
def solves(I, M, dt, scatter):
    """Whether the tension at the trial could be solved for, as `take_solved` takes it."""
    state = scalars(M)
    if bend_of_tension(I, M, dt) > SOLVED_FROM * state.axial * dt * dt:
        return False  # what the strain's second derivative adds would be seen
    if not may_be_solved_for(I, M):
        return False
    change = solve_at_end(I, M, dt)
    return 0.0 <= change and change <= LARGEST_CHANGE * max(scatter, 0.5)
