"""The tension of a step: how wrong it is, and what it is where the step is too long to follow it.

Tension follows the line's stretch. Where steps resolve the motion along the line, an error of that
motion is one of the tension, and adds up from step to step. Where the line is too stiff for its
steps, the tension holds it at its length: a step finds it from differences of positions, of order 2
only, but what is wrong there is forgotten by the next step. The matrix of the stages tells one from
the other: it takes out of the embedded solution's error what the scheme damps.

Where the second kind of error is too large, the tension is solved for from the positions and
velocities at the step's end: the acceleration meets the second derivative of |r'| = 1 + strain(T)
in time and the equations of motion, in which the tension is linear. That holds for a line that does
not ring along itself. One that rings leaves its stages apart, but by its end a long step has damped
it, and the tension that is solved for is that of the step: such a step is refused.

A load rings on its wire when the winch's acceleration jumps. A long step damps that, and the
embedded solution with it, so that their difference tells nothing. But what a step makes of a ring
is known: R(i angle) instead of exp(i angle), R its scheme's stability function. That much of the
amplitude it misses, and such errors add up for as long as a ring lasts. The amplitude is what the
jump makes, then what a window of two turns finds in the top tension beside a cubic of time: the
motion that waves or a vessel force on the line is that, and is none of the ring. One of less than
is allowed may be damped away at once: no more than all of it can be missed.
"""

import math

from .access import body_of, cable_of, constraint_of, edge_of, header, scalars, winch_of
from .closures import scale_gaps
from .compile import copy_words, inlined, kernel, outlined, view
from .consistency import vessel_jump
from .environment import current_rate, surge_jump
from .newton import increment_norm
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
from .tables import GAMMA, NUMERATOR, STAGE_A, STAGE_C, STAGES, TENSION_TEST, WINDOW

PROMISED = 0.5  # of the error of tension that is promised
SHARE = 0.045  # of that: what a step may add to an error that lasts, as of positions
SHARE_OF_LIMITED = 0.03  # the same where the caller makes steps short
LOSS_FACTOR = 0.01  # of a cable's material: 2 / (it w) is the time in which a ring of w dies away
FINEST = 0.1  # step times the frequency of the line's axial motion: one that follows it for sure
UNSEEN = 0.05  # of that: scatter of the stages below which nothing is looked at
SOLVED_FROM = 0.25  # of that: scatter of what is forgotten from which on tensions are solved for
NOTHING = 0.01  # of the scatter: an embedded error that explains none of it
STIFF = 0.2  # part of the embedded error that lasts, from which on a step follows what rings
LARGEST_CHANGE = 20.0  # of the scatter: what solving may change
SHORT = 0.1  # of the step: that of the matrix with which the tension is solved for
APART = 1e-3  # periods of the line over which the stretch's second derivative is a difference
RIGID = 1e-3  # compliance of the line over what its inertia gives way by in that matrix's step


# What a step does along the line.
PASSES_OVER, FOLLOWS, SOLVED = 0, 1, 2


@kernel
def promised_tension(M):
    """What tensions may be wrong by [N], by the largest tension so far.

    A typical one stands for it at first.
    """
    state = scalars(M)
    return 10.0 * state.tolerance * max(state.largest_tension, state.tension_scale)


@kernel
def tension_tolerance(M):
    """Error of a step's top tension that is allowed [N]."""
    return PROMISED * promised_tension(M)


@kernel
def stage_scatter(M, scheme):
    """How far the top tensions of a step's implicit stages are off a smooth curve [tolerances]."""
    state = scalars(M)
    stages = STAGES[scheme] - 1
    worst = 0.0
    for i in range(stages):
        missed = 0.0
        for j in range(stages):
            missed += TENSION_TEST[scheme, i, j] * state.stage_top_tension[j]
        worst = max(worst, abs(missed))
    return worst / tension_tolerance(M)


@kernel
def top_stretch_tension(I, M, x):
    """What a motion x of the nodes changes of the top element's tension by stretching it [N]."""
    head = header(I)
    constraint = view(M, head.constraint_residual, 2 * head.nodes)
    change = view(M, head.stage_velocity, 2 * head.nodes)
    constraint[:] = 0.0
    change[:] = 0.0
    recover_tension(I, M, constraint, x, change)
    return abs(change[2])


@kernel
def filter_motion(I, M, motion, gamma_dt):
    """Leave of a motion of the nodes, (nodes, 2, dimension), what the stages' matrix makes of its
    inertia: all where the step resolves it, 1 / (1 + (omega gamma dt)^2) of what swings. Returns
    what is left in the tension at the top [N]."""
    head = header(I)
    count = 2 * head.dimension * head.nodes
    words = 2 * head.nodes
    forces = view(M, head.residual, count)
    constraint = view(M, head.constraint_residual, words)
    x = view(M, head.increment, count)
    a = view(M, head.stage_acceleration, count)
    inverse2 = 1.0 / (gamma_dt * gamma_dt)
    for n in range(count):
        a[n] = M[head.trial_acceleration + n] - inverse2 * motion[n]
    q = view(M, head.trial_position, count)
    v = view(M, head.trial_velocity, count)
    residual(I, M, q, v, a, view(M, head.trial_tension, words), forces, constraint)
    constraint[:] = 0.0
    scale_gaps(I, M, 0.0)
    newton_increment(I, M, forces, constraint, x)
    for n in range(count):
        motion[n] = x[n]
    return top_stretch_tension(I, M, x)


@outlined
def embedded_error(I, M, error, gamma_dt, scatter):
    """Error of the top tension by the embedded solution [tolerances], and its part that lasts.

    error: of the positions, (nodes, 2, dimension) [m]; it is overwritten. scatter: beside which an
    error is none that is much smaller [tolerances].
    """
    allowed = tension_tolerance(M)
    left = filter_motion(I, M, error, gamma_dt) / allowed
    again = filter_motion(I, M, error, gamma_dt) / allowed
    return left, min(1.0, again / max(left, NOTHING * scatter))


@kernel
def allowed_at(I, M, node):
    """Error of a step's tension in an element of a system that is allowed [N], by its own line."""
    cable = cable_of(I, M, int(edge_of(I, M, node).segment))
    return PROMISED * 10.0 * scalars(M).tolerance * cable.tension


@kernel
def remember_tensions(I, M):
    """In a system: the largest tension of each cable, by which errors are measured."""
    head = header(I)
    for node in range(1, head.nodes):
        if I[head.joint + node] == 0:
            cable = cable_of(I, M, int(edge_of(I, M, node).segment))
            cable.tension = max(cable.tension, abs(M[head.tension + 2 * node]))


@kernel
def keep_stage_tensions(I, M, stage):
    """Keep the tensions of a step's stage, by its number, of all elements of a system."""
    head = header(I)
    for node in range(1, head.nodes):
        M[head.stage_tensions + 6 * node + stage] = M[head.trial_tension + 2 * node]


@kernel
def scatter_at(I, M, node, scheme):
    """`stage_scatter` of an element of a system."""
    stages = STAGES[scheme] - 1
    tension = view(M, header(I).stage_tensions + 6 * node, 6)
    worst = 0.0
    for i in range(stages):
        missed = 0.0
        for j in range(stages):
            missed += TENSION_TEST[scheme, i, j] * tension[j]
        worst = max(worst, abs(missed))
    return worst / allowed_at(I, M, node)


@inlined
def dies_within(M, dt):
    """Whether what a step of dt does not follow dies away by the material before a line has moved:
    what turns by `FINEST` in the step and more."""
    return dt < FINEST * 0.5 * LOSS_FACTOR * scalars(M).period


@kernel
def error_in_parts(I, M, dt, scheme, gamma_dt, error):
    """`tension_error` of a system, the largest of all elements. Nothing is solved for."""
    head = header(I)
    if dies_within(M, dt):
        return 0.0, PASSES_OVER
    scatter = 0.0
    for node in range(1, head.nodes):
        if I[head.joint + node] == 0:
            scatter = max(scatter, scatter_at(I, M, node, scheme))
    if scatter <= UNSEEN:
        return scatter, PASSES_OVER
    filter_motion(I, M, error, gamma_dt)
    for node in range(1, head.nodes):
        M[head.stage_tensions + 6 * node + 5] = M[head.stage_velocity + 2 * node]
    filter_motion(I, M, error, gamma_dt)
    worst = 0.0
    for node in range(1, head.nodes):
        if I[head.joint + node] != 0:
            continue
        allowed = allowed_at(I, M, node)
        left = abs(M[head.stage_tensions + 6 * node + 5]) / allowed
        again = abs(M[head.stage_velocity + 2 * node]) / allowed
        scatter = scatter_at(I, M, node, scheme)
        share = min(1.0, again / max(left, NOTHING * scatter, 1e-300))
        worst = max(worst, left * share * share / SHARE, (1.0 - share * share) * scatter)
    return worst, PASSES_OVER


@kernel
def two_step_error_in_parts(I, M, dt):
    """`two_step_error` of a system, the largest of all elements."""
    head = header(I)
    if dies_within(M, dt):
        return 0.0, PASSES_OVER
    worst = 0.0
    for node in range(1, head.nodes):
        if I[head.joint + node] != 0:
            continue
        final = M[head.trial_tension + 2 * node]
        predicted = M[head.tension + 2 * node] + dt * M[head.tension_rate + 2 * node]
        first = M[head.stage_tensions + 6 * node]
        lasting = 0.5 * abs(final - first) / SHARE_OF_LIMITED
        worst = max(worst, min(abs(final - predicted), lasting) / allowed_at(I, M, node))
    return worst, PASSES_OVER


@kernel
def two_step_error(I, M, dt):
    """Error of the top tension of a two-step step [tolerances], and what it does along the line.

    Where the line is too stiff for it to follow, dt^2 T'' at most, by which the prediction from
    the last step's rate is off; else half of what the predicted positions stretch it by more or
    less, which lasts.
    """
    head = header(I)
    state = scalars(M)
    if head.parts != 0:
        return two_step_error_in_parts(I, M, dt)
    if dt * math.sqrt(state.axial) < FINEST:
        return 0.0, FOLLOWS
    final = M[head.trial_tension + 2]
    predicted = M[head.tension + 2] + dt * M[head.tension_rate + 2]
    lasting = 0.5 * abs(final - state.stage_top_tension[0]) / SHARE_OF_LIMITED
    passed_over = abs(final - predicted)
    if passed_over < lasting:
        return passed_over / tension_tolerance(M), PASSES_OVER
    return lasting / tension_tolerance(M), FOLLOWS


@kernel
def inertia(I, M):
    """Mass of all that hangs on the tow point [kg]."""
    head = header(I)
    mass = 0.0
    for node in range(1, head.nodes):
        if I[head.joint + node] == 0:
            edge = edge_of(I, M, node)
            mass += edge.mass * edge.length
    for body in range(head.body_count):
        mass += body_of(I, M, body).mass
    return mass


@kernel
def may_be_solved_for(I, M):
    """Whether tensions can be solved for: of one line, with Hooke's law, ends that are hinged, and
    no body of finite length at the tow point."""
    head = header(I)
    if head.parts != 0 or (head.rigid > 0 and winch_of(I, M, 0).passing != 0.0):
        return False
    for n in range(head.constraint_count):
        if constraint_of(I, M, n).clamped != 0.0:
            return False
    for node in range(1, head.nodes):
        if I[head.joint + node] == 0:
            if edge_of(I, M, node).strain_terms != 1.0:
                return False
    return True


@inlined
def region(I, n):
    """Word of the n-th region of 6 words a node in the workspace of the stages, of eight."""
    head = header(I)
    words = 6 * head.capacity
    if n < 4:
        return head.stage_velocity + n * words
    return head.stage_acceleration + (n - 4) * words


# These regions: what is solved for, then what that takes.
SOLVED_Q, SOLVED_V, SOLVED_A, SOLVED_T, SOLVED_RATE, CURVED, STRAINED, SOFTNESS = range(8)


@kernel
def stiffen(I, M, ca):
    """Make the line all but inextensible in a matrix whose mass is ca times that of the line.

    With each element's own mass a light line with a heavy body would keep a fifth of the error.
    `soften` gives the compliances of elements and bodies back.
    """
    head = header(I)
    state = scalars(M)
    soft = RIGID / (ca * inertia(I, M))
    length = state.length
    kept = region(I, SOFTNESS)
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
    kept = region(I, SOFTNESS)
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
    solved_q = view(M, region(I, SOLVED_Q), count)
    solved_v = view(M, region(I, SOLVED_V), count)
    a = view(M, region(I, SOLVED_A), count)
    solved = view(M, region(I, SOLVED_T), words)
    curved = view(M, region(I, CURVED), words)
    strained = view(M, region(I, STRAINED), words)
    forces = view(M, head.residual, count)
    constraint = view(M, head.constraint_residual, words)
    x = view(M, head.increment, count)
    ca = 1.0 / (short * short)
    set_time(I, M, t)
    if t == state.time:
        current_rate(I, M, t, True)  # as the water goes on
    for n in range(count):
        solved_q[n] = q[n]
        solved_v[n] = v[n]
    for n in range(words):
        solved[n] = tension[n]
        strained[n] += tension[n]
    impose_motion(I, M, t, solved_q, solved_v, a)
    stiffen(I, M, ca)
    failed = factorise(I, M, q, solved_v, a, tension, ca, 0.0)
    soften(I, M)
    head.factored = 0
    if failed != 0:
        return -1.0, -1.0
    # Velocities that stretch the line at the rate at which the tensions change.
    residual(I, M, q, solved_v, a, strained, forces, curved)
    residual(I, M, q, solved_v, a, tension, forces, constraint)
    for n in range(words):
        curved[n] -= constraint[n]
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
    step = APART * state.period
    for k in range(3):
        ahead = (k - 1) * step
        for n in range(count):
            solved_q[n] = q[n] + ahead * (solved_v[n] + 0.5 * ahead * a[n])
        if head.payout != 0:
            set_top_length(I, M, t + ahead)
        residual(I, M, solved_q, solved_v, a, tension, forces, constraint)
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
    recover_tension(I, M, constraint, x, solved)
    for n in range(count):
        a[n] += ca * x[n]
    # Positions whose stretch has these tensions.
    residual(I, M, q, solved_v, a, solved, forces, constraint)
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
    copy_words(I, region(I, SOLVED_A), head.trial_acceleration, count)
    tension = view(M, head.trial_tension, words)
    rate = view(M, region(I, STRAINED), words)
    for n in range(words):
        rate[n] = (tension[n] - M[head.tension + n]) / dt
    q = view(M, head.trial_position, count)
    v = view(M, head.trial_velocity, count)
    change, _moving = solve_for_tension(I, M, state.time + dt, SHORT * dt, q, v, tension)
    for n in range(words):
        solved = M[region(I, SOLVED_T) + n]
        M[region(I, SOLVED_RATE) + n] = (solved - M[head.tension + n]) / dt
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
    rate = view(M, region(I, STRAINED), words)
    for n in range(words):
        rate[n] = (M[region(I, SOLVED_T) + n] - tension[n]) / dt
    copy_words(I, region(I, SOLVED_A), head.acceleration, count)
    q = view(M, head.position, count)
    v = view(M, head.velocity, count)
    change, moving = solve_for_tension(I, M, state.time, SHORT * dt, q, v, tension)
    return not (0.0 <= change and change <= 1.0 and moving <= 1.0)


@kernel
def first_motion(I, M):
    """Of the line's first motion along itself, its end free: frequency [rad/s], and the mass that
    moves with it when the tow point accelerates [kg].

    By Rayleigh's quotient, of displacements s as under a load at the end: the stiffness over the
    sum of m s^2; of the mass the square of the sum of m s over that.
    """
    head = header(I)
    s = region(I, SOFTNESS)  # from the tow point to each node [m/N]
    for node in range(head.nodes):
        M[s + node] = 0.0
    for body in range(head.body_count):
        row = body_of(I, M, body)
        if row.node > 0.0:
            M[s + int(row.node)] = row.compliance
    softest = 0.0
    moved = 0.0
    squares = 0.0
    for node in range(1, head.nodes):
        above = M[s + I[head.parent + node]]
        below = above + M[s + node]
        if I[head.joint + node] == 0:
            edge = edge_of(I, M, node)
            below += edge.compliance * edge.length
            mass = edge.mass * edge.length
            moved += mass * 0.5 * (above + below)
            squares += mass * (above * above + above * below + below * below) / 3.0
        M[s + node] = below
        softest = max(softest, below)
    for body in range(head.body_count):
        row = body_of(I, M, body)
        if row.node > 0.0:
            mass = row.mass + row.added_mass_axial
            way = M[s + int(row.node)]
            moved += mass * way
            squares += mass * way * way
    return math.sqrt(softest / squares), moved * moved / squares


@kernel
def known_ring(M):
    """Amplitude of the ring [tolerances]; 0: none that may not be damped away."""
    ring = scalars(M).ring / tension_tolerance(M)
    return ring if ring > 1.0 else 0.0


@kernel
def begin_window(M, t, tension):
    """Begin to measure how the line rings, at time t and that top tension."""
    state = scalars(M)
    state.ring_since = t
    state.ring_about = tension
    state.ring_cosine = 0.0
    state.ring_sine = 0.0


@kernel
def begin_ring(I, M, jump, dt):
    """The acceleration along the line jumps [m/s2] as a step of dt begins: so does the tension with
    which it would not ring, and it rings about that. Velocities go on."""
    head = header(I)
    state = scalars(M)
    _frequency, moved = first_motion(I, M)
    made = moved * abs(jump)
    if made <= tension_tolerance(M) or dies_away(M):
        return
    made += state.ring
    count = 2 * head.dimension * head.nodes
    if may_be_solved_for(I, M):
        copy_words(I, region(I, SOLVED_A), head.acceleration, count)
        copy_words(I, region(I, STRAINED), head.tension_rate, 2 * head.nodes)
        tension = view(M, head.tension, 2 * head.nodes)
        q = view(M, head.position, count)
        v = view(M, head.velocity, count)
        change, _moving = solve_for_tension(I, M, state.time, SHORT * dt, q, v, tension)
        if change >= 0.0:
            made = min(made, math.hypot(state.ring, change * tension_tolerance(M)))
    state.ring = made
    begin_window(M, state.time, M[head.tension + 2])


@kernel
def add_to_window(M, y, weight, tension):
    """A top tension at that place in the window, for a stretch of it of that weight [rad]."""
    state = scalars(M)
    seen = 0.5 * (1.0 + math.cos(0.5 * y)) if abs(y) < 2.0 * math.pi else 0.0
    of_it = weight * seen * (tension - state.ring_about)
    even = WINDOW[0, 0] * math.cos(y) + WINDOW[0, 1] + WINDOW[0, 2] * y * y
    odd = WINDOW[1, 0] * math.sin(y) + WINDOW[1, 1] * y + WINDOW[1, 2] * y * y * y
    state.ring_cosine += of_it * even
    state.ring_sine += of_it * odd


@kernel
def follow_ring(I, M, dt, scheme):
    """Measure the ring in a step from the state to the trial, by a scheme of STAGES; -1: two-step.

    At the window's end there is no more of it than that finds.
    """
    head = header(I)
    state = scalars(M)
    if known_ring(M) == 0.0:
        return
    frequency, _moved = first_motion(I, M)
    angle = frequency * dt
    y = frequency * (state.time - state.ring_since) - 2.0 * math.pi
    before = M[head.tension + 2]
    after = M[head.trial_tension + 2]
    if scheme < 0:
        add_to_window(M, y, 0.5 * angle, before)
        add_to_window(M, y + angle, 0.5 * angle, after)
    else:
        last = STAGES[scheme] - 1
        add_to_window(M, y, STAGE_A[scheme, last, 0] * angle, before)
        for i in range(1, last + 1):
            at = y + STAGE_C[scheme, i] * angle
            share = STAGE_A[scheme, last, i] * angle
            add_to_window(M, at, share, state.stage_top_tension[i - 1])
    if y + angle >= 2.0 * math.pi:
        state.ring = min(state.ring, math.hypot(state.ring_cosine, state.ring_sine))
        if known_ring(M) == 0.0:
            state.ring = 0.0
        begin_window(M, state.time + dt, after)


@kernel
def error_of_ring(scheme, angle):
    """By how much a step in which a ring turns by that angle [rad] misses it, of its amplitude:
    by how much the scheme's stability function R(i angle) differs from exp(i angle)."""
    real, imaginary = 0.0, 0.0
    for n in range(STAGES[scheme]):
        # Horner's rule in i angle, from the highest power.
        real, imaginary = NUMERATOR[scheme, n] - angle * imaginary, angle * real
    turn = GAMMA[scheme] * angle
    poles = STAGES[scheme] - 1
    size = (1.0 + turn * turn) ** (-0.5 * poles)
    behind = angle - poles * math.atan(turn)
    return math.hypot(size * real - math.cos(behind), size * imaginary - math.sin(behind))


@kernel
def missed_of_ring(M, scheme, angle):
    """What a step in which the ring turns by that angle misses of it, over what it may add [-].

    That is a share of the tolerance: a ring lasts for 2 / LOSS_FACTOR radians. By the two-step
    scheme, -1, it misses a third of the angle's cube.
    """
    missed = angle * angle * angle / 3.0 if scheme < 0 else error_of_ring(scheme, angle)
    return known_ring(M) * missed / (0.5 * LOSS_FACTOR * angle)


@kernel
def may_miss_ring(I, M, dt, scheme):
    """Whether a step of dt may miss what it does of the ring."""
    if known_ring(M) == 0.0:
        return True
    frequency, _moved = first_motion(I, M)
    return missed_of_ring(M, scheme, frequency * dt) <= 1.0


@kernel
def longest_ring_step(I, M, dt, scheme):
    """A step of at most dt that follows the ring: what it misses goes with the angle to the power
    of the scheme's order."""
    if known_ring(M) == 0.0:
        return dt
    frequency, _moved = first_motion(I, M)
    angle = frequency * dt
    missed = missed_of_ring(M, scheme, angle)
    while missed > 1.0:
        angle = min(angle, math.pi) * 0.9 * missed ** (-1.0 / (3 + scheme))
        missed = missed_of_ring(M, scheme, angle)
    longest = angle / frequency
    return longest if 0.0 < longest and longest < 1e300 else dt


@kernel
def take_solved(I, M):
    """Make what was solved for the state: it does not ring."""
    head = header(I)
    count = 2 * head.dimension * head.nodes
    copy_words(I, head.position, region(I, SOLVED_Q), count)
    copy_words(I, head.velocity, region(I, SOLVED_V), count)
    copy_words(I, head.acceleration, region(I, SOLVED_A), count)
    copy_words(I, head.tension, region(I, SOLVED_T), 2 * head.nodes)
    copy_words(I, head.tension_rate, region(I, SOLVED_RATE), 2 * head.nodes)
    head.settled = 1
    head.has_history = 0  # the two-step scheme would differentiate what was solved for


@kernel
def bend_of_tension(I, M, dt):
    """What the top tension changes by in a step of dt, or in the one before it, and twice what
    that differs by: a bound of its second derivative times the square of dt [tolerances]."""
    head = header(I)
    change = M[head.trial_tension + 2] - M[head.tension + 2]
    before = dt * M[head.tension_rate + 2]
    largest = max(0.25 * max(abs(change), abs(before)), 2.0 * abs(change - before))
    return largest / tension_tolerance(M)


@kernel
def dies_away(M):
    """Whether what rings along the line is over before the line has moved, by its material."""
    state = scalars(M)
    return state.axial * state.period * state.period > (2.0 / LOSS_FACTOR) ** 2


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


@kernel
def tension_error(I, M, dt, scheme, gamma_dt, error):
    """Error of the top tension of a step from the state to the trial [tolerances], and what the
    step does along the line: PASSES_OVER, FOLLOWS, or SOLVED, for which see `take_solved`.

    error: of the positions, (nodes, 2, dimension) [m].
    """
    head = header(I)
    state = scalars(M)
    if head.parts != 0:
        return error_in_parts(I, M, dt, scheme, gamma_dt, error)
    if dt * math.sqrt(state.axial) < FINEST:
        return 0.0, FOLLOWS
    scatter = stage_scatter(M, scheme)
    if scatter <= UNSEEN:
        return scatter, PASSES_OVER
    if dies_away(M):
        return 0.0, SOLVED if solves(I, M, dt, scatter) else PASSES_OVER
    left, share = embedded_error(I, M, error, gamma_dt, scatter)
    lasting = left * share * share / SHARE
    forgotten = (1.0 - share * share) * scatter
    unseen = bend_of_tension(I, M, dt) / (state.axial * dt * dt)
    if share > STIFF or unseen > SOLVED_FROM or known_ring(M) > 0.0:
        return max(lasting, forgotten), FOLLOWS
    settled = head.settled != 0 and begins_smoothly(I, M)
    if (settled or forgotten > SOLVED_FROM) and lasting <= 1.0 and solves(I, M, dt, scatter):
        if settled:
            return lasting, SOLVED
        if not rings(I, M, dt):
            solve_at_end(I, M, dt)
            return lasting, SOLVED
    return max(lasting, forgotten), PASSES_OVER
