"""Equilibrium in a frame that moves with the vessel, by pseudo-transient continuation.

Backward Euler, which damps everything, with steps that grow until inertia has no part left: the
limit is Newton's method on the static equations, reached from any guess. With kinetic damping each
step starts from rest: slack cable settles where it would bounce otherwise.
"""

from cablemodel.solvers.finite_element.kernels.bodies.clamp_layer import settle_layer
from cablemodel.solvers.finite_element.kernels.bodies.free_bodies import count_turns_anew
from cablemodel.solvers.finite_element.kernels.bodies.vessel_clamp import update_springs
from cablemodel.solvers.finite_element.kernels.element.cubic import bend_at_begin, bend_at_end
from cablemodel.solvers.finite_element.kernels.element.limp import forget_limp
from cablemodel.solvers.finite_element.kernels.element.strain import largest_mean
from cablemodel.solvers.finite_element.kernels.floor.floor_memory import bear
from cablemodel.solvers.finite_element.kernels.floor.floor_state import leave_floor
from cablemodel.solvers.finite_element.kernels.line.closures import (
    follow_forces,
    give_back_forces,
    keep_forces,
)
from cablemodel.solvers.finite_element.kernels.line.newton import increment_norm, is_folded
from cablemodel.solvers.finite_element.kernels.line.system import (
    factor_assembled,
    jacobian,
    newton_increment,
    recover_tension,
    residual,
    set_time,
)
from cablemodel.solvers.finite_element.kernels.time.backup import keep_matrix
from cablemodel.solvers.finite_element.kernels.water.flow import (
    flow_jacobian,
    flow_residual,
    laid_share,
)
from cablemodel.solvers.shared.access import edge_of, header, scalars, spare_row, vector, winch_of
from cablemodel.solvers.shared.compile import copy_words, kernel, outlined, own_record, view
from cablemodel.solvers.shared.layout import (
    FLOOR_NONE,
    FLOOR_TOUCHED,
    OK,
    STATICS_FAILED,
    SearchRows,
)
from cablemodel.solvers.shared.numbers import NO_SIZE
from cablemodel.solvers.shared.record import Record, integer, real

ROW_PLACES, ROW_TENSIONS = SearchRows.places.word, SearchRows.tensions.word
ROW_BORE = SearchRows.bore.word
LARGEST_STEPS = 2000
LONGEST_PSEUDO_STEP = 1e7
LONGEST_WITH_BODIES = 1e4  # first steps: longer ones let rounding turn a body that nothing holds
NEWTON_LIMIT = 12
FLOOR_ROUNDS = 12
LOAD_HALVINGS = 8  # of a change of what the floor bears that is not followed, before shorter steps
STATICS_CALM = 1e-10  # of the length: what the last two steps may move
STATICS_ROUND_OFF = 1e-8, 20  # of the length, where so many longest steps in a row move no more
UNBALANCED = 1e-9  # of gravity: the same in a system, whose bodies may turn freely
THROWN = 10.0  # of the line's length: an increment from which none comes back
STATICS_EXACT = 1e-11  # of the line's length: an increment that is the last one
STATICS_SETTLED = 1e-8  # the same where tensions change by as little of the largest
PSEUDO_SHORTER = 0.25  # of a pseudo step that fails: the next one
SMALLEST_PSEUDO_STEP = 1e-9  # of the first step: a shorter pseudo step is not tried
LONG_PSEUDO_STEP = 1e3  # in first steps: pseudo steps that tell of rest
BORNE_AGAIN = 1e-3  # of what the floor bears: what it may be pressed by beyond that
PSEUDO_MOVED = 0.2  # of the line's length: motion in a pseudo step that lets the next be longer
PSEUDO_EASY, PSEUDO_FAIR = 5, 8  # iterations of it, at most, with which it grows much, or little
EASY_GROWTH, FAIR_GROWTH = 2.5, 1.3  # of the pseudo step, then
STATICS_ATTEMPTS = 4  # with folds on the way and without, damped and not


@kernel
def find_equilibrium(I, M, frame):
    """Equilibrium from the positions in the block; frame: velocity of the frame (dimension words).

    On success the state is at rest in that frame: v = frame, a = 0; with pay-out at `time` the
    shape is at rest and the cable runs along it. A shape that ends folded in line is none: the
    next attempt allows no fold on its way, or does without kinetic damping. A search in few steps,
    on a way over easier ones, is one attempt.
    """
    head = header(I)
    count = 2 * head.dimension * head.nodes
    words = 2 * head.nodes
    first_places = spare_row(I, ROW_PLACES)
    first_tensions = spare_row(I, ROW_TENSIONS)
    copy_words(I, first_places, head.position, count)
    copy_words(I, first_tensions, head.tension, words)
    status = STATICS_FAILED
    if head.floor_kind != FLOOR_NONE:
        head.floor_state = FLOOR_TOUCHED  # on its way it may be anywhere
    few = head.maximum_steps < LARGEST_STEPS and flow_of(I, M) != 0.0
    forget_limp(I, M)  # what a search passes through is not what bends aside
    for attempt in range(1 if few else STATICS_ATTEMPTS):
        if attempt > 0:
            copy_words(I, head.position, first_places, count)
            copy_words(I, head.tension, first_tensions, words)
        status = relax(I, M, frame, attempt < 2, attempt % 2 == 1)
        if status == OK:
            break
    if head.floor_kind != FLOOR_NONE:
        leave_floor(I, M)
    return status


@kernel
def flow_of(I, M):
    """Rate at which cable runs along a line at a start [m/s]; in systems none does."""
    head = header(I)
    if head.payout == 0 or head.parts != 0:
        return 0.0
    return winch_of(I, M, 0).rate


class Relaxation(Record):
    """One attempt to find an equilibrium by implicit steps in a pseudo-time."""

    dt = real("length of the step", "s")
    longest = real("that it may have", "s")
    flow = real("rate at which cable runs along the line", "m/s")
    springs = integer("1: clamps' stiffnesses follow the tensions")
    used = integer("iterations of Newton's method in the last step")
    still = integer("longest steps in a row that moved the line by round-off alone")
    calm = integer("steps in a row that moved it by no more than an equilibrium may")
    rounds = integer("in which the floor has followed the load")
    halvings = integer("of the last change of that, while no step has followed it")
    pressed = real("by how much more the floor was pressed than it bore")
    share = real("of that, by which it bears more")


new_relaxation = own_record(Relaxation)


@kernel
def begin_relaxation(I, M, at):
    """The line stands still, in steps as short as those of a run's start."""
    head = header(I)
    state = scalars(M)
    at.flow = flow_of(I, M)
    set_time(I, M, state.time)
    if at.flow != 0.0:
        winch_of(I, M, 0).stage_rate = 0.0  # flow.py adds the flow, at the top as elsewhere
    count = 2 * head.dimension * head.nodes
    for n in range(count):
        M[head.velocity + n] = 0.0
        M[head.acceleration + n] = 0.0
    at.longest = LONGEST_PSEUDO_STEP
    if head.free_count != 0:
        at.longest = min(at.longest, LONGEST_WITH_BODIES * state.first_step)
    if head.rigid > 0 or head.payout != 0 or head.closure_count != 0:
        at.springs = 1
        update_springs(I, M, 0.0)
    keep_forces(I, M)
    at.dt = state.first_step
    at.halvings = LOAD_HALVINGS
    at.share = 1.0


@kernel
def solve_pseudo_step(I, M, frame, at):
    """An implicit step from the state to the trial; whether Newton's method converged."""
    head = header(I)
    length = scalars(M).length
    flow = at.flow
    inverse = 1.0 / at.dt
    size = 2 * head.dimension
    count = size * head.nodes
    words = 2 * head.nodes
    q0 = view(M, head.position, count)
    w0 = view(M, head.velocity, count)
    q = view(M, head.trial_position, count)
    v = view(M, head.trial_velocity, count)
    a = view(M, head.trial_acceleration, count)
    tension = view(M, head.trial_tension, words)
    forces = view(M, head.residual, count)
    constraint = view(M, head.constraint_residual, words)
    x = view(M, head.increment, count)
    for n in range(count):
        q[n] = q0[n]
    for n in range(words):
        tension[n] = M[head.tension + n]
    at.used = 0
    for iteration in range(NEWTON_LIMIT):
        at.used = iteration + 1
        for node in range(head.nodes):
            for i in range(size):
                n = size * node + i
                w = (q[n] - q0[n]) * inverse
                a[n] = (w - w0[n]) * inverse
                v[n] = w
                if i < head.dimension:
                    v[n] += frame[i]
        keep_matrix(I)
        jacobian(I, M, q, v, a, tension, inverse * inverse, inverse)
        if flow != 0.0:
            flow_jacobian(I, M, flow, frame, q, v, a, inverse * inverse, inverse)
        if factor_assembled(I, M) != 0:
            return False
        head.factorisations += 1
        head.iterations += 1
        residual(I, M, q, v, a, tension, forces, constraint)
        if flow != 0.0:
            flow_residual(I, M, flow, frame, q, v, a, tension, forces, constraint)
        newton_increment(I, M, forces, constraint, x)
        change, where = increment_norm(I, M, x)
        I[head.failed] = where
        if not change < THROWN * length:
            return False
        for n in range(count):
            q[n] += x[n]
        tension_change = recover_tension(I, M, constraint, x, tension, True)
        follow_forces(I, M)
        largest = max(NO_SIZE, largest_mean(tension, head.nodes))
        if change <= STATICS_EXACT * length or (
            change <= STATICS_SETTLED * length and tension_change <= STATICS_SETTLED * largest
        ):
            return True
    return False


@kernel
def shorten_pseudo_step(I, M, at):
    """What lets the next attempt converge; whether there is something left to try."""
    head = header(I)
    give_back_forces(I, M)
    if at.halvings < LOAD_HALVINGS:
        share_loads(I, M, view(M, spare_row(I, ROW_BORE), head.nodes))
        at.halvings += 1
        return True
    at.dt *= PSEUDO_SHORTER
    return not at.dt < SMALLEST_PSEUDO_STEP * scalars(M).first_step


@kernel
def take_pseudo_step(I, M, at, damped):
    """The trial becomes the state, and what goes with that follows; how far it moved [m]."""
    head = header(I)
    inverse = 1.0 / at.dt
    count = 2 * head.dimension * head.nodes
    q0 = view(M, head.position, count)
    w0 = view(M, head.velocity, count)
    a0 = view(M, head.acceleration, count)
    x = view(M, head.increment, count)
    at.halvings = LOAD_HALVINGS
    keep_forces(I, M)
    for n in range(count):
        x[n] = M[head.trial_position + n] - q0[n]
    moved, _where = increment_norm(I, M, x)
    for n in range(count):
        w0[n] = 0.0 if damped else x[n] * inverse
        q0[n] = M[head.trial_position + n]
    copy_words(I, head.tension, head.trial_tension, 2 * head.nodes)
    if head.parts != 0:
        count_turns_anew(I, M, q0, w0, a0)
    if at.springs != 0 and at.dt > LONG_PSEUDO_STEP * scalars(M).first_step:
        if head.payout != 0:
            settle_layer(I, M, q0)
        update_springs(I, M, 1.0)
    return moved


@kernel
def is_calm(I, M, at, moved):
    """Whether a step that moved the line so far [m] leaves it at an equilibrium."""
    state = scalars(M)
    # Light cable may not come closer to its place than round-off lets it.
    rounded = moved <= STATICS_ROUND_OFF[0] * state.length
    if header(I).free_count != 0:
        # What nothing holds from turning turns by what Newton's method leaves.
        rounded = rounded or moved <= UNBALANCED * state.gravity * at.dt * at.dt
    at.still = at.still + 1 if rounded and at.dt == at.longest else 0
    long = at.dt > LONG_PSEUDO_STEP * state.first_step
    return at.still >= STATICS_ROUND_OFF[1] or (moved <= STATICS_CALM * state.length and long)


@kernel
def bear_load(I, M, at):
    """Let the floor bear what it is pressed by: the line is calm only when that is no more."""
    head = header(I)
    more = bear(I, M, 0.0, 1.0)
    if not abs(more) > BORNE_AGAIN:
        return
    # Whole steps may move the cable to and fro.
    if more * at.pressed < 0.0 and abs(more) > 0.5 * abs(at.pressed):
        at.share *= 0.5
    at.pressed = more
    bore = spare_row(I, ROW_BORE)  # what it did, before
    for node in range(head.nodes):
        M[bore + node] = edge_of(I, M, node).support
    bear(I, M, at.share, 1.0)
    at.halvings = 0
    at.rounds += 1
    at.calm = 0


@kernel
def stand_in_frame(I, M, frame, flow):
    """The state at rest in a frame that moves; cable runs along it at a rate `flow`."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    count = size * head.nodes
    w0 = view(M, head.velocity, count)
    a0 = view(M, head.acceleration, count)
    for node in range(head.nodes):
        for i in range(size):
            n = size * node + i
            w0[n] = frame[i] if i < dimension else 0.0
            a0[n] = 0.0
    set_time(I, M, scalars(M).time)
    if flow != 0.0:
        add_flow(I, M, flow, view(M, head.position, count), w0, a0)


@outlined
def relax(I, M, frame, damped, strict):
    """One attempt; damped: every step starts from rest; strict: no step may end folded."""
    head = header(I)
    state = scalars(M)
    count = 2 * head.dimension * head.nodes
    words = 2 * head.nodes
    at = new_relaxation()
    begin_relaxation(I, M, at)
    damping, landing = state.floor_damping, state.landing_damping
    if at.flow != 0.0:
        state.floor_damping = 0.0  # down a slope the frame moves towards the floor, no cable does
    state.landing_damping = state.floor_damping  # nothing lands: more would only slow the search
    state.bristles_damped = 0.0  # velocities are the frame's: what lies has none
    status = STATICS_FAILED
    for _step in range(min(LARGEST_STEPS, head.maximum_steps)):
        if not solve_pseudo_step(I, M, frame, at) or (
            strict
            and is_folded(
                I, M, view(M, head.trial_position, count), view(M, head.trial_tension, words)
            )
        ):
            if not shorten_pseudo_step(I, M, at):
                break
            continue
        moved = take_pseudo_step(I, M, at, damped)
        if is_calm(I, M, at, moved):
            at.calm += 1
            if at.calm >= 2 and head.floor_kind != FLOOR_NONE and at.rounds < FLOOR_ROUNDS:
                bear_load(I, M, at)
            if at.calm >= 2:
                if not is_folded(I, M, view(M, head.position, count), view(M, head.tension, words)):
                    status = OK
                break
        else:
            at.calm = 0
        if moved < PSEUDO_MOVED * state.length and at.used <= PSEUDO_FAIR:
            at.dt = min(
                at.dt * (EASY_GROWTH if at.used <= PSEUDO_EASY else FAIR_GROWTH), at.longest
            )
        elif moved > 0.5 * state.length:
            at.dt *= 0.5
    state.floor_damping, state.landing_damping = damping, landing
    state.bristles_damped = 1.0
    stand_in_frame(I, M, frame, at.flow)
    head.factored = 0
    return status


@kernel
def share_loads(I, M, bore):
    """Take back half of what the floor bears more of the elements than it did, (nodes,)."""
    head = header(I)
    for node in range(head.nodes):
        edge = edge_of(I, M, node)
        edge.support = 0.5 * (edge.support + bore[node])


@kernel
def add_flow(I, M, flow, q, v, a):
    """Motion of cable that runs along its own shape at the rate `flow` (eq. 16, d/dt = 0).

    v += flow r', v' = flow r'', a = flow^2 r''; r'' at a node is the mean of both sides. The
    vessel's node gets its own by the pay-out terms of the top element. What has been laid is at
    rest.
    """
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    nodes = head.nodes
    normal = vector()
    for node in range(1, nodes):
        laid, _change = laid_share(I, M, q, node, normal)
        for i in range(dimension):
            n = size * node + i
            second = 0.0
            sides = 0.0
            for side in range(2):
                edge = node + side
                if edge >= nodes or I[head.joint + edge] != 0:
                    continue
                h = edge_of(I, M, edge).length
                p = size * I[head.parent + edge] + i
                c = size * edge + i
                chord = (q[c] - q[p]) / h
                d0 = q[p + dimension]
                d1 = q[c + dimension]
                if side == 0:
                    second += bend_at_end(6.0 * chord, d0, d1) / h
                else:
                    second += bend_at_begin(6.0 * chord, d0, d1) / h
                sides += 1.0
            second /= max(sides, 1.0)
            v[n] = (1.0 - laid) * (v[n] + flow * q[n + dimension])
            v[n + dimension] += (1.0 - laid) * flow * second
            a[n] = (1.0 - laid) * flow * flow * second
