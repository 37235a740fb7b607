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
"""

import math

from cablemodel.solvers.finite_element.kernels.bodies.point_bodies import surface_band
from cablemodel.solvers.finite_element.kernels.element.strain import folds, promised_tension
from cablemodel.solvers.finite_element.kernels.element.tables import (
    GAMMA,
    STAGES,
    TENSION_TEST,
    UNDERRATED,
)
from cablemodel.solvers.finite_element.kernels.floor.floor_state import rubs
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import lowest_gap
from cablemodel.solvers.finite_element.kernels.line.closures import scale_gaps
from cablemodel.solvers.finite_element.kernels.line.newton import increment_norm
from cablemodel.solvers.finite_element.kernels.line.system import (
    constraints,
    factorise,
    impose_motion,
    material_stretch_rate,
    newton_increment,
    recover_tension,
    remembers,
    residual,
    set_time,
)
from cablemodel.solvers.finite_element.kernels.mesh.payout import set_top_length
from cablemodel.solvers.finite_element.kernels.mesh.touchdown_mesh import begins_anew
from cablemodel.solvers.finite_element.kernels.time.consistency import vessel_jump
from cablemodel.solvers.shared.access import (
    body_of,
    cable_of,
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
from cablemodel.solvers.shared.compile import copy_words, inlined, kernel, outlined, view
from cablemodel.solvers.shared.environment import current_rate, surge_jump
from cablemodel.solvers.shared.layout import (
    FLOOR_TOUCHED,
    HELD_BY_ANCHOR,
    JOINT_ROOT,
    WHOLLY,
    FilterRows,
    SoftnessRows,
    SolvedRows,
)
from cablemodel.solvers.shared.numbers import PROMISE

ROW_LEFT, ROW_MOTION = FilterRows.left.word, FilterRows.accelerations.word
SOLVED_Q, SOLVED_V = SolvedRows.places.word, SolvedRows.velocities.word
SOLVED_A, SOLVED_T = SolvedRows.accelerations.word, SolvedRows.tensions.word
SOLVED_RATE, CURVED = SolvedRows.rates.word, SolvedRows.curved.word
STRAINED, SOFTNESS = SolvedRows.strained.word, SoftnessRows.softness.word
STEP_PROMISE = 0.5  # of the error of tension that is promised
TENSION_SHARE = 0.045  # of that: what a step may add to an error that lasts, as of positions
SHARE_OF_LIMITED = 0.03  # the same where the caller makes steps short
LOSS_FACTOR = 0.01  # of a cable's material: 2 / (it w) is the time in which a ring of w dies away
TENSION_FINEST = 0.1  # step times the frequency of the axial motion: one that follows for sure
TENSION_UNSEEN = 0.05  # of that: scatter of the stages below which nothing is looked at
SOLVED_FROM = 0.25  # of that: scatter of what is forgotten from which on tensions are solved for
UNEXPLAINED = 0.01  # of the scatter: an embedded error that explains none of it
STIFF = 0.2  # part of the embedded error that lasts, from which on a step follows what rings
LARGEST_CHANGE = 20.0  # of the scatter: what solving may change
SHORT = 0.1  # of the step: that of the matrix with which the tension is solved for
DIFFERENCE_STEP = 1e-3  # periods of the line: for the stretch's derivatives
TENSION_NEARLY = 0.5  # of the longest step not looked at: its tensions say how long the next is
TENSION_STAYS = 0.5  # error of a step after which the next one is as long
TENSION_RIGID = 1e-3  # compliance of the line over what inertia gives way by in that step


# What a step does along the line; in a system, where it is refused: that no other one than its
# tensions' error is too large.
PASSES_OVER, FOLLOWS, SOLVED, MISSES = 0, 1, 2, 3
SHARE_RESOLVED = 1e-6  # of an embedded error: what lasts of it at least
BEND_OF_CHANGE = 0.25  # of what a tension changes by in a step: what it bends by at least


@kernel
def tension_tolerance(M):
    """Error of a step's top tension that is allowed [N]."""
    return STEP_PROMISE * promised_tension(M)


@inlined
def watched(I):
    """One beyond the last of the elements whose tension is controlled: of one line the top element,
    1; of a system all."""
    head = header(I)
    return 2 if head.parts == 0 else head.nodes


@inlined
def is_watched(I, node):
    """Whether the tension above that node, of those, is: joints of a system have none."""
    head = header(I)
    return head.parts == 0 or I[head.joint + node] == 0


@inlined
def allowed_in(M, cable):
    """Error of a step's tension that is allowed in a cable of a system [N]: by the largest tension
    of its own line."""
    return STEP_PROMISE * PROMISE * scalars(M).tolerance * cable.tension


@kernel
def allowed_at(I, M, node):
    """Error of a step's tension in a watched element that is allowed [N]."""
    if header(I).parts == 0:
        return tension_tolerance(M)
    return allowed_in(M, cable_of(I, M, int(edge_of(I, M, node).segment)))


@kernel
def least_tolerance(I, M):
    """The least error of a step's tension that is allowed in what may lie on a floor [N]."""
    head = header(I)
    least = tension_tolerance(M)
    if head.parts == 0:
        return least
    for n in range(head.cable_count):
        cable = cable_of(I, M, n)
        if cable.edge.contact > 0.0:
            least = min(least, allowed_in(M, cable))
    return least


@kernel
def keep_stage_tensions(I, M, stage):
    """Keep the tensions of a step's stage, by its number, of what is watched."""
    head = header(I)
    for node in range(1, watched(I)):
        M[head.stage_tensions + 6 * node + stage] = trial_tension_of(I, M, node).mean


@kernel
def stage_scatter(I, M, node, scheme):
    """How far the tensions of a step's implicit stages are off a smooth curve [tolerances]."""
    head = header(I)
    stages = STAGES[scheme] - 1
    tension = view(M, head.stage_tensions + 6 * node, 6)
    worst = 0.0
    for i in range(stages):
        missed = 0.0
        for j in range(stages):
            missed += TENSION_TEST[scheme, i, j] * tension[j]
        worst = max(worst, abs(missed))
    return worst / allowed_at(I, M, node)


@kernel
def stretch_tensions(I, M, x):
    """What a motion x of the nodes changes of the elements' tensions by stretching them [N], into
    `left` of FilterRows."""
    head = header(I)
    constraint = view(M, head.constraint_residual, 2 * head.nodes)
    change = view(M, spare_row(I, ROW_LEFT), 2 * head.nodes)
    constraint[:] = 0.0
    change[:] = 0.0
    recover_tension(I, M, constraint, x, change, False)


@kernel
def filter_motion(I, M, motion, gamma_dt):
    """Leave of a motion of the nodes, (nodes, 2, dimension), what the stages' matrix makes of its
    inertia: all where the step resolves it, 1 / (1 + (omega gamma dt)^2) of what swings. And by
    `stretch_tensions` what is left in the tensions."""
    head = header(I)
    count = 2 * head.dimension * head.nodes
    words = 2 * head.nodes
    forces = view(M, head.residual, count)
    constraint = view(M, head.constraint_residual, words)
    x = view(M, head.increment, count)
    a = view(M, spare_row(I, ROW_MOTION), count)
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
    stretch_tensions(I, M, x)


@outlined
def find_embedded_errors(I, M, error, gamma_dt, bound):
    """Errors of the watched tensions by the embedded solution, for `embedded_error`; returns
    whether it is left out how much of them lasts: no error is above `bound` [tolerances].

    error: of the positions, (nodes, 2, dimension) [m]; it is overwritten.
    """
    head = header(I)
    filter_motion(I, M, error, gamma_dt)
    left_in = spare_row(I, ROW_LEFT)
    largest = 0.0
    for node in range(1, watched(I)):
        left = M[left_in + 2 * node]
        M[head.stage_tensions + 6 * node + 5] = left
        largest = max(largest, abs(left) / allowed_at(I, M, node))
    if largest <= bound:
        return True
    filter_motion(I, M, error, gamma_dt)
    return False


@kernel
def embedded_error(I, M, node, scatter):
    """Error of a watched tension by the embedded solution [tolerances], and its part that lasts.

    scatter: beside which an error is none that is much smaller [tolerances].
    """
    head = header(I)
    allowed = allowed_at(I, M, node)
    left = abs(M[head.stage_tensions + 6 * node + 5]) / allowed
    again = abs(M[spare_row(I, ROW_LEFT) + 2 * node]) / allowed
    return left, min(1.0, again / max(left, UNEXPLAINED * scatter))


@kernel
def share_of_ring(M, dt, scheme, share):
    """Of what is allowed, what a step's embedded error may be of a tension that rings, in a system
    without winches: elements that pass one make rings of their own, which steps had better damp.

    share: what of that error lasts, 1 / (1 + (w gamma dt)^2), which tells the angle w dt. Errors
    of a ring add up for 2 / LOSS_FACTOR radians, and are larger than the embedded one by
    `UNDERRATED` times the angle. What its material ends before a line has moved is left to steps.
    """
    angle = math.sqrt(max(0.0, 1.0 / max(share, SHARE_RESOLVED) - 1.0)) / GAMMA[scheme]
    if 0.5 * LOSS_FACTOR * angle * scalars(M).period > dt:
        return TENSION_SHARE
    angle = max(angle, TENSION_FINEST)
    return 0.5 * LOSS_FACTOR * angle / max(1.0, UNDERRATED[scheme] * angle)


@inlined
def is_root(I, node):
    """Whether a tree begins at that node."""
    return node == 0 or I[header(I).joint + node] >= JOINT_ROOT


@inlined
def watched_element(I, row):
    """The element next to a constraint, whose tension is looked at."""
    node = int(row.node)
    return node + 1 if is_root(I, node) else node


@inlined
def height_of(I, M, node):
    """Of a node above still water [m]."""
    head = header(I)
    return scalars(M).origin[2] + M[head.position + head.dimension * (2 * node + 1) - 1]


@kernel
def hears(I, M):
    """Whether rings are listened for that no end of a line begins: below or above a sea whose
    troughs a body may come out of, which knocks it. Not in systems without winches
    (`share_of_ring`), nor where what comes to a floor ends them."""
    head = header(I)
    if head.wave_count == 0 or head.floor_state == FLOOR_TOUCHED:
        return False
    if head.parts != 0 and head.payout == 0:
        return False
    trough = -scalars(M).wave_crest
    for n in range(head.body_count):
        row = body_of(I, M, n)
        if row.node > 0.0:
            reach = surface_band(M, row, row.length)
            if height_of(I, M, int(row.node)) > trough - reach:
                return True
    for n in range(head.free_count):
        row = free_body_of(I, M, n)
        if height_of(I, M, int(row.node)) > trough - row.radius - row.size:
            return True
    return False


@kernel
def missed_embedded(I, M, node, scheme):
    """What a step has missed of a ring in a watched tension [N], as its embedded solution tells;
    0 where the step follows nothing that rings."""
    left, share = embedded_error(I, M, node, stage_scatter(I, M, node, scheme))
    if share <= STIFF:
        return 0.0
    angle = math.sqrt(1.0 / share - 1.0) / GAMMA[scheme]
    return left * allowed_at(I, M, node) * UNDERRATED[scheme] * angle


@kernel
def missed_late(I, M, node):
    """The same of a two-step step, which is late by a third of the angle's cube, and by half of
    that cube off what is predicted."""
    final = trial_tension_of(I, M, node).mean
    change = abs(final - tension_of(I, M, node).mean)
    off = abs(final - M[header(I).stage_tensions + 6 * node])
    return 2.0 / 3.0 * off if 2.0 * off < change else 0.0


@kernel
def hear(I, M, scheme):
    """Keep what a step by a scheme, -1: the two-step one, has missed of rings at ends that none
    follows: they may be followed from there (rings.py)."""
    head = header(I)
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        if row.kind == HELD_BY_ANCHOR or row.clamped == WHOLLY or row.ring > 0.0:
            continue
        top = watched_element(I, row)
        missed = missed_late(I, M, top) if scheme < 0 else missed_embedded(I, M, top, scheme)
        if missed > 0.0:
            row.ring_missed = missed
            head.heard += 1


@kernel
def is_slack(I, M, first):
    """Whether the line of a system that begins above a node is slack in a step: pressed somewhere
    by more than its tensions may be wrong by, or nowhere carries more than that.

    Cable bends aside where it is pressed, and waves along it end there: nothing rings on for as
    long as a material lets it.
    """
    head = header(I)
    least = 0.0
    largest = 0.0
    allowed = 0.0
    for node in range(first, head.nodes):
        if node > first and begins_anew(I, node):
            break
        if I[head.joint + node] != 0:
            continue
        allowed = allowed_at(I, M, node)
        for n in range(2):
            tension = M[(head.tension if n == 0 else head.trial_tension) + 2 * node]
            least = min(least, tension)
            largest = max(largest, tension)
    return least < -allowed or largest < allowed


@kernel
def remember_tensions(I, M):
    """In a system: the largest tension of each cable, by which errors are measured."""
    head = header(I)
    for node in range(1, head.nodes):
        if I[head.joint + node] == 0:
            cable = cable_of(I, M, int(edge_of(I, M, node).segment))
            cable.tension = max(cable.tension, abs(tension_of(I, M, node).mean))


@inlined
def longest_unwatched(M):
    """Below this step what one does not follow dies away by the material before a line has moved
    [s]: what turns by `TENSION_FINEST` in the step and more."""
    return TENSION_FINEST * 0.5 * LOSS_FACTOR * scalars(M).period


@inlined
def dies_within(M, dt):
    """Whether a step is so short."""
    return dt < longest_unwatched(M)


@inlined
def is_over_at_once(I, M, dt):
    """Whether a step of dt need not look at tensions: of one line as it follows all, of a system as
    what it does not follow dies away."""
    if header(I).parts != 0:
        return dies_within(M, dt)
    return dt * math.sqrt(scalars(M).axial) < TENSION_FINEST


@inlined
def phase_missed(change, off):
    """What two-step steps miss of a tension that rings, until its material ends the ring [N].

    change: of the tension in the step; off: what the prediction missed of it. Of a ring a at the
    angle x = w dt they are a x and a x^3 / 2, a quarter of a turn from its peaks both, and a step
    is late by a x^3 / 3: after 2 / LOSS_FACTOR radians by a x^2 / 3 for each, and never by more
    than 2 a. Where x is not small the line is too stiff for the step to follow.
    """
    if off == 0.0 or 2.0 * off > change:
        return 0.0
    turn = math.sqrt(2.0 * off / change)
    late = 2.0 / LOSS_FACTOR / 3.0 * change * turn
    return min(late, 2.0 * change / turn)


@kernel
def two_step_error(I, M, dt):
    """Error of the watched tensions of a two-step step [tolerances], and what it does along the
    line.

    Where the line is too stiff for it to follow, dt^2 T'' at most, by which the prediction from
    the last step's rate is off; else half of what the predicted positions stretch it by more or
    less, which lasts. In a system what lasts may ring (`phase_missed`).
    """
    head = header(I)
    if is_over_at_once(I, M, dt):
        return 0.0, FOLLOWS
    worst = 0.0
    along = PASSES_OVER
    for node in range(1, watched(I)):
        if not is_watched(I, node):
            continue
        final = trial_tension_of(I, M, node).mean
        predicted = tension_of(I, M, node).mean + dt * tension_rate_of(I, M, node).mean
        first = M[head.stage_tensions + 6 * node]
        lasting = 0.5 * abs(final - first) / SHARE_OF_LIMITED
        passed_over = abs(final - predicted)
        if not passed_over < lasting:
            along = FOLLOWS
        missed = min(passed_over, lasting)
        if head.parts != 0:
            change = abs(final - tension_of(I, M, node).mean)
            missed = max(missed, phase_missed(change, abs(final - first)))
        worst = max(worst, missed / allowed_at(I, M, node))
    if hears(I, M):
        hear(I, M, -1)
    return worst, along


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
def gives_way(I, M, tension):
    """Whether flexible cable bends aside within an element under these tensions: waves along it
    end there, and nothing rings on."""
    head = header(I)
    for node in range(1, head.nodes):
        if I[head.joint + node] == 0:
            if folds(M, edge_of(I, M, node), tension[2 * node], tension[2 * node + 1]):
                return True
    return False


@kernel
def bend_of_tension(I, M, dt):
    """What the top tension changes by in a step of dt, or in the one before it, and twice what
    that differs by: a bound of its second derivative times the square of dt [tolerances]."""
    change = trial_tension_of(I, M, 1).mean - tension_of(I, M, 1).mean
    before = dt * tension_rate_of(I, M, 1).mean
    largest = max(BEND_OF_CHANGE * max(abs(change), abs(before)), 2.0 * abs(change - before))
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


@outlined
def error_kept(I, M, error, gamma_dt):
    """Error of a step's tensions [tolerances], where cable rubs: along what lies friction keeps it,
    and it may be no more than what lasts elsewhere.

    error: of the positions, (nodes, 2, dimension) [m]; it is overwritten.
    """
    head = header(I)
    filter_motion(I, M, error, gamma_dt)
    left_in = spare_row(I, ROW_LEFT)
    q = view(M, head.trial_position, 2 * head.dimension * head.nodes)
    depth = scalars(M).floor_depth
    worst = 0.0
    for node in range(1, head.nodes):
        if I[head.joint + node] != 0:
            continue
        missed = abs(M[left_in + 2 * node]) / allowed_at(I, M, node)
        if TENSION_SHARE * worst < missed and lowest_gap(I, M, q, node) < depth:
            missed /= TENSION_SHARE
        worst = max(worst, missed)
    return worst


@kernel
def tension_error(I, M, dt, scheme, gamma_dt, error, of_positions):
    """Error of the watched tensions of a step from the state to the trial [tolerances], and what
    the step does along the line: PASSES_OVER, FOLLOWS, or SOLVED, for which see `take_solved`.
    Nothing is solved for in a system.

    error: of the positions, (nodes, 2, dimension) [m]. of_positions: that over what is allowed;
    what is no more than that is not told exactly.
    """
    head = header(I)
    state = scalars(M)
    at_once = is_over_at_once(I, M, dt)
    if at_once and (head.parts == 0 or dt < TENSION_NEARLY * longest_unwatched(M)):
        return 0.0, FOLLOWS
    if rubs(I, M):
        return error_kept(I, M, error, gamma_dt), PASSES_OVER
    scatter = 0.0
    for node in range(1, watched(I)):
        if is_watched(I, node):
            scatter = max(scatter, stage_scatter(I, M, node, scheme))
    if scatter <= TENSION_UNSEEN:
        return scatter, PASSES_OVER
    if head.parts == 0:
        if gives_way(I, M, view(M, head.trial_tension, 2 * head.nodes)):
            return 0.0, FOLLOWS
    if head.parts == 0 and dies_away(M):
        return 0.0, SOLVED if solves(I, M, dt, scatter) else PASSES_OVER
    follows = head.rings + head.axial_waves != 0
    follows = follows or bend_of_tension(I, M, dt) / (state.axial * dt * dt) > SOLVED_FROM
    bound = -1.0
    if head.parts == 0 and scatter <= of_positions and not remembers(I):
        if follows or (head.settled == 0 and scatter <= SOLVED_FROM):
            bound = TENSION_SHARE * of_positions
    if find_embedded_errors(I, M, error, gamma_dt, bound):
        return of_positions, FOLLOWS if follows else PASSES_OVER
    share = 0.0
    lasting = 0.0
    forgotten = 0.0
    rings_on = False
    for node in range(1, watched(I)):
        if head.parts != 0 and head.payout == 0 and (node == 1 or begins_anew(I, node)):
            rings_on = not is_slack(I, M, node)
        if is_watched(I, node):
            scatter = stage_scatter(I, M, node, scheme) if head.parts != 0 else scatter
            left, share = embedded_error(I, M, node, scatter)
            part = share_of_ring(M, dt, scheme, share) if rings_on else TENSION_SHARE
            lasting = max(lasting, left * share * share / part)
            forgotten = max(forgotten, (1.0 - share * share) * scatter)
    if hears(I, M):
        hear(I, M, scheme)
    if head.parts != 0:
        missed = max(lasting, forgotten)
        if at_once:
            return min(TENSION_STAYS, missed), FOLLOWS
        return missed, MISSES if missed > 1.0 else PASSES_OVER
    if share > STIFF or follows:
        return max(lasting, forgotten), FOLLOWS
    settled = head.settled != 0 and begins_smoothly(I, M)
    if (settled or forgotten > SOLVED_FROM) and lasting <= 1.0 and solves(I, M, dt, scatter):
        if settled:
            return lasting, SOLVED
        if not rings(I, M, dt):
            solve_at_end(I, M, dt)
            return lasting, SOLVED
    return max(lasting, forgotten), PASSES_OVER
