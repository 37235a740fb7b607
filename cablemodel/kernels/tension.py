"""The tension of a step: how wrong it is, and what it is where the step is too long to follow it.

Tension follows the line's stretch. Where steps resolve the motion along the line, an error of that
motion is one of the tension, and adds up from step to step. Where the line is too stiff for its
steps, the tension holds it at its length: a step finds it from differences of positions, of order 2
only, but what is wrong there is forgotten by the next step. The matrix of the stages tells one from
the other: it takes out of the embedded solution's error what the scheme damps.

Where the second kind of error is too large, the tension is solved for from the positions and
velocities at the step's end: the acceleration meets the second derivative of |r'| = 1 + strain(T)
in time and the equations of motion, in which the tension is linear. That holds for a line that does
not ring along itself.

A ring is what a line's tension and velocity are off the ones that are solved for. A long step damps
it, and the embedded solution with it, so that their difference tells nothing. But what a step makes
of a ring is known: R(i angle) instead of exp(i angle), R its scheme's stability function. That much
of the amplitude it misses, and such errors add up for as long as a ring lasts. One of less than is
allowed may be damped away at once: no more than all of it can be missed.
"""

import math

from .access import body_of, constraint_of, edge_of, header, scalars
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
from .tables import GAMMA, NUMERATOR, STAGES, TENSION_TEST

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
def two_step_error(I, M, dt):
    """Error of the top tension of a two-step step [tolerances], and what it does along the line.

    Where the line is too stiff for it to follow, dt^2 T'' at most, by which the prediction from
    the last step's rate is off; else half of what the predicted positions stretch it by more or
    less, which lasts.
    """
    head = header(I)
    state = scalars(M)
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
    """Whether tensions can be solved for: with Hooke's law, ends that are hinged, and no body of
    finite length at the tow point."""
    head = header(I)
    state = scalars(M)
    if state.body_passage != 0.0:
        return False
    for n in range(head.constraint_count):
        if constraint_of(I, M, n).clamped != 0.0:
            return False
    for node in range(1, head.nodes):
        if I[head.joint + node] == 0:
            if edge_of(I, M, node).strain_terms != 1.0:
                return False
    return True


@kernel
def tension_of_speed(I, M, speed):
    """What a line that rings along itself at that speed has of tension, sqrt(k m) of it
    [tolerances]."""
    state = scalars(M)
    return inertia(I, M) * math.sqrt(state.axial) * speed / tension_tolerance(M)


@kernel
def tension_of_motion(I, M, x):
    """What a line that rings along itself with the energy of the velocities x has of tension
    [tolerances]: the root of k times the sum of m x^2."""
    head = header(I)
    state = scalars(M)
    size = 2 * head.dimension
    twice = 0.0
    for node in range(1, head.nodes):
        if I[head.joint + node] == 0:
            edge = edge_of(I, M, node)
            half = 0.5 * edge.mass * edge.length
            parent = size * I[head.parent + node]
            for i in range(head.dimension):
                twice += half * (x[size * node + i] ** 2 + x[parent + i] ** 2)
    for body in range(head.body_count):
        row = body_of(I, M, body)
        at = size * int(row.node)
        for i in range(head.dimension):
            twice += row.mass * x[at + i] ** 2
    return math.sqrt(state.axial * inertia(I, M) * twice) / tension_tolerance(M)


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


@kernel
def stretch_at_rate(I, M, q, a, tension):
    """Give the velocities in SOLVED_V, by the matrix in use, what stretches the line at the rates
    of the tensions that are in STRAINED; returns how fast that is [m/s]."""
    head = header(I)
    count = 2 * head.dimension * head.nodes
    words = 2 * head.nodes
    v = view(M, region(I, SOLVED_V), count)
    curved = view(M, region(I, CURVED), words)
    strained = view(M, region(I, STRAINED), words)
    forces = view(M, head.residual, count)
    constraint = view(M, head.constraint_residual, words)
    x = view(M, head.increment, count)
    for n in range(words):
        strained[n] += tension[n]
    residual(I, M, q, v, a, strained, forces, curved)
    residual(I, M, q, v, a, tension, forces, constraint)
    for n in range(words):
        curved[n] -= constraint[n]
    material_stretch_rate(I, M, v, constraint)
    for n in range(words):
        constraint[n] += curved[n]
        curved[n] = 0.0
    forces[:] = 0.0
    newton_increment(I, M, forces, constraint, x)
    speed, _where = increment_norm(I, M, x)
    for n in range(count):
        v[n] += x[n]
    return speed


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
    impose_motion(I, M, t, solved_q, solved_v, a)
    stiffen(I, M, ca)
    failed = factorise(I, M, q, solved_v, a, tension, ca, 0.0)
    soften(I, M)
    head.factored = 0
    if failed != 0:
        return -1.0, -1.0
    speed = stretch_at_rate(I, M, q, a, tension)
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
    return change / tension_tolerance(M), tension_of_speed(I, M, speed)


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
def known_ring(M):
    """Amplitude of the ring that is known of [tolerances]; 0: none that may not be damped away."""
    state = scalars(M)
    ring = state.ring / tension_tolerance(M)
    return ring if ring > 1.0 else 0.0


@kernel
def ring_is_due(M):
    """Whether the ring that is known of has turned once since it was measured."""
    state = scalars(M)
    turned = math.sqrt(state.axial) * (state.time - state.ring_found)
    return known_ring(M) > 0.0 and turned > 2.0 * math.pi


@kernel
def begin_ring(I, M, jump):
    """The acceleration along the line jumps [m/s2]: by its inertia times that the tension does."""
    state = scalars(M)
    made = inertia(I, M) * abs(jump)
    if made > tension_tolerance(M) and not dies_away(M):
        state.ring += made
        state.ring_found = state.time


@kernel
def range_of_tension(I, M, scheme):
    """Between what the top tension is in a step, at its ends and stages [tolerances]."""
    head = header(I)
    state = scalars(M)
    least = M[head.tension + 2]
    most = least
    for n in range(STAGES[scheme] - 1):
        least = min(least, state.stage_top_tension[n])
        most = max(most, state.stage_top_tension[n])
    return (most - least) / tension_tolerance(M)


@kernel
def left_by_last_step(M):
    """What the last step's matrix leaves of a ring [-]: see `filter_motion`."""
    state = scalars(M)
    turn = GAMMA[1] * state.last_step
    return 1.0 / (1.0 + state.axial * turn * turn)


@kernel
def may_ring(I, M, dt, most, matters):
    """Whether a ring may be so large that it matters, of at most that amplitude [tolerances]: it
    comes through the last step, or begins with this one.
    """
    state = scalars(M)
    if most <= matters:
        return False
    if most * left_by_last_step(M) > matters or not begins_smoothly(I, M):
        return True
    set_time(I, M, state.time + dt)
    return False


@kernel
def measure_ring(I, M, dt, scheme):
    """Measure the tension with which the state rings along itself, as a step of dt begins, and keep
    it where it is more than is allowed. Returns whether all goes on as what is solved for.

    It is what the tension, and the velocity along the line, are off the ones that are solved for,
    at the step's beginning and, for the rate at which what rings not changes, at its end. Of the
    velocity no more counts than the last step's matrix leaves, the rest is that step's error; nor
    more than the tensions in this step show: in a turn by some angle c (1 - cos) + v sin of them.
    """
    head = header(I)
    state = scalars(M)
    state.ring = 0.0
    if not may_be_solved_for(I, M) or solve_at_end(I, M, dt) < 0.0:
        return False
    count = 2 * head.dimension * head.nodes
    words = 2 * head.nodes
    tension = view(M, head.tension, words)
    rate = view(M, region(I, STRAINED), words)
    after = view(M, region(I, SOLVED_RATE), words)
    solved = view(M, region(I, SOLVED_T), words)
    for n in range(words):
        after[n] = solved[n]
        rate[n] = (after[n] - tension[n]) / dt
    copy_words(I, region(I, SOLVED_A), head.acceleration, count)
    q = view(M, head.position, count)
    v = view(M, head.velocity, count)
    change, _moving = solve_for_tension(I, M, state.time, SHORT * dt, q, v, tension)
    moving = ringing = change
    if change >= 0.0:
        for n in range(words):
            rate[n] = (after[n] - solved[n]) / dt
        solved_q = view(M, region(I, SOLVED_Q), count)
        solved_v = view(M, region(I, SOLVED_V), count)
        a = view(M, region(I, SOLVED_A), count)
        copy_words(I, region(I, SOLVED_V), head.velocity, count)
        impose_motion(I, M, state.time, solved_q, solved_v, a)
        moving = tension_of_speed(I, M, stretch_at_rate(I, M, q, a, tension))
        ringing = tension_of_motion(I, M, view(M, head.increment, count))
    set_time(I, M, state.time + dt)
    if change < 0.0:
        return False
    angle = min(math.sqrt(state.axial) * dt, 0.5 * math.pi)
    seen = range_of_tension(I, M, scheme) + change * (1.0 - math.cos(angle))
    ringing = min(ringing * left_by_last_step(M), seen / math.sin(angle))
    amplitude = math.hypot(change, ringing)
    if amplitude > 1.0:
        state.ring = amplitude * tension_tolerance(M)
        state.ring_found = state.time
    return change <= 1.0 and moving <= 1.0


@kernel
def ring_share(angle):
    """What a step in which a ring turns by that angle [rad] may add to the error of what rings,
    of what it may be in all: it lasts for 2 / LOSS_FACTOR radians."""
    return 0.5 * LOSS_FACTOR * angle


@kernel
def ring_needs_stages(M, dt):
    """Whether the two-step scheme would miss the ring that is known of, by a third of the cube of
    the angle by which it turns in a step, or cannot tell how much is left of it."""
    state = scalars(M)
    angle = dt * math.sqrt(state.axial)
    return ring_is_due(M) or known_ring(M) * angle * angle * angle / 3.0 > ring_share(angle)


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
def take_solved(I, M):
    """Make what was solved for the state: it does not ring."""
    head = header(I)
    state = scalars(M)
    count = 2 * head.dimension * head.nodes
    copy_words(I, head.position, region(I, SOLVED_Q), count)
    copy_words(I, head.velocity, region(I, SOLVED_V), count)
    copy_words(I, head.acceleration, region(I, SOLVED_A), count)
    copy_words(I, head.tension, region(I, SOLVED_T), 2 * head.nodes)
    copy_words(I, head.tension_rate, region(I, SOLVED_RATE), 2 * head.nodes)
    head.settled = 1
    state.ring = 0.0
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
    angle = dt * math.sqrt(state.axial)
    ring = known_ring(M)
    due = ring_is_due(M)
    if angle < FINEST and not due:
        return 0.0, FOLLOWS
    scatter = stage_scatter(M, scheme)
    if scatter <= UNSEEN and ring == 0.0:
        return scatter, PASSES_OVER
    if dies_away(M):
        return 0.0, SOLVED if solves(I, M, dt, scatter) else PASSES_OVER
    missed = error_of_ring(scheme, angle) / ring_share(angle)
    # Whatever its phase, so much of a ring the tensions in the step would show.
    most = range_of_tension(I, M, scheme) / (1.0 - math.cos(0.5 * min(angle, math.pi)))
    if ring > most:
        ring = most
        state.ring = most * tension_tolerance(M)
    due = ring > 1.0 and (due or ring * missed > 1.0)
    if scatter <= UNSEEN:
        if due:
            measure_ring(I, M, dt, scheme)
        return max(scatter, known_ring(M) * missed), FOLLOWS
    left, share = embedded_error(I, M, error, gamma_dt, scatter)
    lasting = left * share * share / SHARE
    forgotten = (1.0 - share * share) * scatter
    unseen = bend_of_tension(I, M, dt) / (state.axial * dt * dt)
    follows = share > STIFF or unseen > SOLVED_FROM
    known = head.settled != 0 and begins_smoothly(I, M)
    if not known and ring <= 1.0 and lasting <= 1.0:
        if follows:
            due = may_ring(I, M, dt, most, max(1.0, 1.0 / missed))
        else:
            due = forgotten > SOLVED_FROM
    if due:
        known = measure_ring(I, M, dt, scheme)
    lasting = max(lasting, known_ring(M) * missed)
    if follows:
        return max(lasting, forgotten), FOLLOWS
    if known and lasting <= 1.0 and solves(I, M, dt, scatter):
        return lasting, SOLVED
    return max(lasting, forgotten), PASSES_OVER
