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
from cablemodel.solvers.shared.compile import copy_words, kernel, view
from cablemodel.solvers.shared.layout import (
    FLOOR_NONE,
    FLOOR_TOUCHED,
    OK,
    STATICS_FAILED,
    SearchRows,
)

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
    for attempt in range(1 if few else 4):
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


@kernel
def relax(I, M, frame, damped, strict):
    """One attempt; damped: every step starts from rest; strict: no step may end folded."""
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    size = 2 * dimension
    nodes = head.nodes
    count = size * nodes
    q0 = M[head.position : head.position + count]
    w0 = M[head.velocity : head.velocity + count]
    a0 = M[head.acceleration : head.acceleration + count]
    t0 = M[head.tension : head.tension + 2 * nodes]
    q = M[head.trial_position : head.trial_position + count]
    v = M[head.trial_velocity : head.trial_velocity + count]
    a = M[head.trial_acceleration : head.trial_acceleration + count]
    tension = M[head.trial_tension : head.trial_tension + 2 * nodes]
    forces = M[head.residual : head.residual + count]
    constraint = M[head.constraint_residual : head.constraint_residual + 2 * nodes]
    x = M[head.increment : head.increment + count]
    length = state.length
    flow = flow_of(I, M)
    set_time(I, M, state.time)
    if flow != 0.0:
        winch_of(I, M, 0).stage_rate = 0.0  # flow.py adds the flow, at the top as elsewhere
    damping = state.floor_damping
    if flow != 0.0:
        state.floor_damping = 0.0  # down a slope the frame moves towards the floor, no cable does
    w0[:] = 0.0
    a0[:] = 0.0
    springs = head.rigid > 0 or head.payout != 0 or head.closure_count != 0
    longest = LONGEST_PSEUDO_STEP
    if head.free_count != 0:
        longest = min(longest, LONGEST_WITH_BODIES * state.first_step)
    if springs:
        update_springs(I, M, 0.0)
    keep_forces(I, M)
    dt = state.first_step
    calm = 0
    still = 0
    rounds = 0
    bore = view(M, spare_row(I, ROW_BORE), nodes)  # what the floor did, before
    halvings = LOAD_HALVINGS  # of the last change of that, while no step has followed it
    pressed = 0.0  # by how much more the floor was pressed than it bore
    share = 1.0
    status = STATICS_FAILED
    for _step in range(min(LARGEST_STEPS, head.maximum_steps)):
        inverse = 1.0 / dt
        for n in range(count):
            q[n] = q0[n]
        for n in range(2 * nodes):
            tension[n] = t0[n]
        converged = False
        used = 0
        for iteration in range(NEWTON_LIMIT):
            used = iteration + 1
            for node in range(nodes):
                for i in range(size):
                    n = size * node + i
                    w = (q[n] - q0[n]) * inverse
                    a[n] = (w - w0[n]) * inverse
                    v[n] = w
                    if i < dimension:
                        v[n] += frame[i]
            keep_matrix(I)
            jacobian(I, M, q, v, a, tension, inverse * inverse, inverse)
            if flow != 0.0:
                flow_jacobian(I, M, flow, frame, q, v, a, inverse * inverse, inverse)
            if factor_assembled(I, M) != 0:
                break
            head.factorisations += 1
            head.iterations += 1
            residual(I, M, q, v, a, tension, forces, constraint)
            if flow != 0.0:
                flow_residual(I, M, flow, frame, q, v, a, tension, forces, constraint)
            newton_increment(I, M, forces, constraint, x)
            change, where = increment_norm(I, M, x)
            I[head.failed] = where
            if not change < 10.0 * length:
                break
            for n in range(count):
                q[n] += x[n]
            tension_change = recover_tension(I, M, constraint, x, tension, True)
            follow_forces(I, M)
            largest = 1e-30
            for n in range(1, nodes):
                largest = max(largest, abs(tension[2 * n]))
            if change <= 1e-11 * length or (
                change <= 1e-8 * length and tension_change <= 1e-8 * largest
            ):
                converged = True
                break
        if not converged or (strict and is_folded(I, M, q, tension)):
            give_back_forces(I, M)
            if halvings < LOAD_HALVINGS:
                share_loads(I, M, bore)
                halvings += 1
                continue
            dt *= 0.25
            if dt < 1e-9 * state.first_step:
                break
            continue
        halvings = LOAD_HALVINGS
        keep_forces(I, M)
        for n in range(count):
            x[n] = q[n] - q0[n]
        moved, where = increment_norm(I, M, x)
        for n in range(count):
            w0[n] = 0.0 if damped else x[n] * inverse
            q0[n] = q[n]
        for n in range(2 * nodes):
            t0[n] = tension[n]
        if head.parts != 0:
            count_turns_anew(I, M, q0, w0, a0)
        if springs and dt > 1e3 * state.first_step:
            if head.payout != 0:
                settle_layer(I, M, q0)
            update_springs(I, M, 1.0)
        # Light cable may not come closer to its place than round-off lets it.
        rounded = moved <= STATICS_ROUND_OFF[0] * length
        if head.free_count != 0:
            # What nothing holds from turning turns by what Newton's method leaves.
            rounded = rounded or moved <= UNBALANCED * state.gravity * dt * dt
        still = still + 1 if rounded and dt == longest else 0
        if still >= STATICS_ROUND_OFF[1] or (
            moved <= STATICS_CALM * length and dt > 1e3 * state.first_step
        ):
            calm += 1
            if calm >= 2 and head.floor_kind != 0 and rounds < FLOOR_ROUNDS:
                more = bear(I, M, 0.0)
                if abs(more) > 1e-3:
                    # Whole steps may move the cable to and fro.
                    if more * pressed < 0.0 and abs(more) > 0.5 * abs(pressed):
                        share *= 0.5
                    pressed = more
                    for node in range(nodes):
                        bore[node] = edge_of(I, M, node).support
                    bear(I, M, share)
                    halvings = 0
                    rounds += 1
                    calm = 0
            if calm >= 2:
                if not is_folded(I, M, q0, t0):
                    status = OK
                break
        else:
            calm = 0
        if moved < 0.2 * length and used <= 8:
            dt = min(dt * (2.5 if used <= 5 else 1.3), longest)
        elif moved > 0.5 * length:
            dt *= 0.5
    for node in range(nodes):
        for i in range(size):
            n = size * node + i
            w0[n] = 0.0
            if i < dimension:
                w0[n] = frame[i]
            a0[n] = 0.0
    set_time(I, M, state.time)
    state.floor_damping = damping
    if flow != 0.0:
        add_flow(I, M, flow, q0, w0, a0)
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


@kernel
def stretch_to_tension(I, M):
    """Tensions that belong to the stretch of the positions in the block (at rest)."""
    head = header(I)
    state = scalars(M)
    count = 2 * head.dimension * head.nodes
    nodes = head.nodes
    q = M[head.position : head.position + count]
    v = M[head.velocity : head.velocity + count]
    a = M[head.acceleration : head.acceleration + count]
    tension = M[head.tension : head.tension + 2 * nodes]
    forces = M[head.residual : head.residual + count]
    constraint = M[head.constraint_residual : head.constraint_residual + 2 * nodes]
    set_time(I, M, state.time)
    for _iteration in range(30):
        residual(I, M, q, v, a, tension, forces, constraint)
        jacobian(I, M, q, v, a, tension, 1.0, 1.0)
        for node in range(1, nodes):
            s = head.compliance + 3 * node
            r0 = constraint[2 * node]
            r1 = constraint[2 * node + 1]
            tension[2 * node] += M[s] * r0 + M[s + 1] * r1
            tension[2 * node + 1] += M[s + 1] * r0 + M[s + 2] * r1
    head.factored = 0
