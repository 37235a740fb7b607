"""Equilibrium in a frame that moves with the vessel, by pseudo-transient continuation.

Backward Euler, which damps everything, with steps that grow until inertia has no part left: the
limit is Newton's method on the static equations, reached from any guess. With kinetic damping each
step starts from rest: slack cable settles where it would bounce otherwise.
"""

from .backup import keep_matrix
from .clamp_layer import settle_layer
from .compile import copy_words, kernel, view
from .floor_memory import bear
from .floor_state import leave_floor
from .flow import flow_jacobian, flow_residual, is_laid
from .free_bodies import count_turns_anew
from .layout import (
    E_LENGTH,
    EDGE_WORDS,
    FLOOR_NONE,
    FLOOR_TOUCHED,
    I_DIMENSION,
    I_FACTORED,
    I_FACTORISATIONS,
    I_FLOOR,
    I_FLOOR_STATE,
    I_ITERATIONS,
    I_MAXIMUM_STEPS,
    I_NODES,
    I_PARTS,
    I_PAYOUT,
    I_RIGID,
    O_ACCELERATION,
    O_COMPLIANCE,
    O_CONSTRAINT_RESIDUAL,
    O_EDGE,
    O_FAILED,
    O_INCREMENT,
    O_JOINT,
    O_MOTION,
    O_PARENT,
    O_POSITION,
    O_RESIDUAL,
    O_STAGE_A,
    O_STAGE_V,
    O_TENSION,
    O_TRIAL_A,
    O_TRIAL_Q,
    O_TRIAL_T,
    O_TRIAL_V,
    O_VELOCITY,
    OK,
    S_FIRST_STEP,
    S_FLOOR_DAMPING,
    S_LENGTH,
    S_PAYOUT_RATE,
    S_STAGE_RATE,
    S_TIME,
    STATICS_FAILED,
)
from .newton import increment_norm, is_folded
from .system import (
    factor_assembled,
    jacobian,
    newton_increment,
    recover_tension,
    residual,
    set_time,
)
from .vessel_clamp import update_springs

LARGEST_STEPS = 2000
LONGEST_STEP = 1e7
NEWTON_LIMIT = 12
FLOOR_ROUNDS = 12
CALM = 1e-10  # of the length: what the last two steps may move
ROUND_OFF = 1e-8, 20  # of the length, where so many of the longest steps in a row move no more


@kernel
def find_equilibrium(I, M, frame):
    """Equilibrium from the positions in the block; frame: velocity of the frame (dimension words).

    On success the state is at rest in that frame: v = frame, a = 0; with pay-out at S_TIME the
    shape is at rest and the cable runs along it. A shape that ends folded in line is none: the
    next attempt allows no fold on its way, or does without kinetic damping. A search in few steps,
    on a way over easier ones, is one attempt.
    """
    count = 2 * I[I_DIMENSION] * I[I_NODES]
    words = 2 * I[I_NODES]
    copy_words(I, I[O_STAGE_V], I[O_POSITION], count)
    copy_words(I, I[O_STAGE_A], I[O_TENSION], words)
    status = STATICS_FAILED
    if I[I_FLOOR] != FLOOR_NONE:
        I[I_FLOOR_STATE] = FLOOR_TOUCHED  # on its way it may be anywhere
    few = I[I_MAXIMUM_STEPS] < LARGEST_STEPS and I[I_PAYOUT] != 0 and M[S_PAYOUT_RATE] != 0.0
    for attempt in range(1 if few else 4):
        if attempt > 0:
            copy_words(I, I[O_POSITION], I[O_STAGE_V], count)
            copy_words(I, I[O_TENSION], I[O_STAGE_A], words)
        status = relax(I, M, frame, attempt < 2, attempt % 2 == 1)
        if status == OK:
            break
    if I[I_FLOOR] != FLOOR_NONE:
        leave_floor(I, M)
    return status


@kernel
def relax(I, M, frame, damped, strict):
    """One attempt; damped: every step starts from rest; strict: no step may end folded."""
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    nodes = I[I_NODES]
    count = size * nodes
    q0 = M[I[O_POSITION] : I[O_POSITION] + count]
    w0 = M[I[O_VELOCITY] : I[O_VELOCITY] + count]
    a0 = M[I[O_ACCELERATION] : I[O_ACCELERATION] + count]
    t0 = M[I[O_TENSION] : I[O_TENSION] + 2 * nodes]
    q = M[I[O_TRIAL_Q] : I[O_TRIAL_Q] + count]
    v = M[I[O_TRIAL_V] : I[O_TRIAL_V] + count]
    a = M[I[O_TRIAL_A] : I[O_TRIAL_A] + count]
    tension = M[I[O_TRIAL_T] : I[O_TRIAL_T] + 2 * nodes]
    forces = M[I[O_RESIDUAL] : I[O_RESIDUAL] + count]
    constraint = M[I[O_CONSTRAINT_RESIDUAL] : I[O_CONSTRAINT_RESIDUAL] + 2 * nodes]
    x = M[I[O_INCREMENT] : I[O_INCREMENT] + count]
    length = M[S_LENGTH]
    flow = M[S_PAYOUT_RATE] if I[I_PAYOUT] != 0 else 0.0
    set_time(I, M, M[S_TIME])
    M[S_STAGE_RATE] = 0.0  # the flow is added by flow.py, at the top as elsewhere
    damping = M[S_FLOOR_DAMPING]
    if flow != 0.0:
        M[S_FLOOR_DAMPING] = 0.0  # down a slope the frame moves towards the floor, no cable does
    w0[:] = 0.0
    a0[:] = 0.0
    springs = I[I_RIGID] > 0 or I[I_PAYOUT] != 0
    if springs:
        update_springs(I, M, 0.0)
    dt = M[S_FIRST_STEP]
    calm = 0
    still = 0
    rounds = 0
    status = STATICS_FAILED
    for _step in range(min(LARGEST_STEPS, I[I_MAXIMUM_STEPS])):
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
                flow_jacobian(I, M, flow, frame, q0, q, v, a, inverse * inverse, inverse)
            if factor_assembled(I, M) != 0:
                break
            I[I_FACTORISATIONS] += 1
            I[I_ITERATIONS] += 1
            residual(I, M, q, v, a, tension, forces, constraint)
            if flow != 0.0:
                flow_residual(I, M, flow, frame, q0, q, v, a, tension, forces, constraint)
            newton_increment(I, M, forces, constraint, x)
            change, where = increment_norm(I, M, x)
            I[I[O_FAILED]] = where
            if not change < 10.0 * length:
                break
            for n in range(count):
                q[n] += x[n]
            tension_change = recover_tension(I, M, constraint, x, tension)
            largest = 1e-30
            for n in range(1, nodes):
                largest = max(largest, abs(tension[2 * n]))
            if change <= 1e-11 * length or (
                change <= 1e-8 * length and tension_change <= 1e-8 * largest
            ):
                converged = True
                break
        if not converged or (strict and is_folded(I, M, q, tension)):
            dt *= 0.25
            if dt < 1e-9 * M[S_FIRST_STEP]:
                break
            continue
        for n in range(count):
            x[n] = q[n] - q0[n]
        moved, where = increment_norm(I, M, x)
        for n in range(count):
            w0[n] = 0.0 if damped else x[n] * inverse
            q0[n] = q[n]
        for n in range(2 * nodes):
            t0[n] = tension[n]
        if I[I_PARTS] != 0:
            count_turns_anew(I, M, q0, w0, a0)
        if springs and dt > 1e3 * M[S_FIRST_STEP]:
            if I[I_PAYOUT] != 0:
                settle_layer(I, M, view(M, I[O_MOTION] + 16, 9), q0)
            update_springs(I, M, 1.0)
        # Light cable may not come closer to its place than round-off lets it.
        still = still + 1 if moved <= ROUND_OFF[0] * length and dt == LONGEST_STEP else 0
        if still >= ROUND_OFF[1] or (moved <= CALM * length and dt > 1e3 * M[S_FIRST_STEP]):
            calm += 1
            if calm >= 2 and I[I_FLOOR] != 0 and rounds < FLOOR_ROUNDS and bear(I, M, 0.0) > 1e-3:
                bear(I, M, 1.0)
                rounds += 1
                calm = 0
            if calm >= 2:
                if not is_folded(I, M, q0, t0):
                    status = OK
                break
        else:
            calm = 0
        if moved < 0.2 * length and used <= 8:
            dt = min(dt * (2.5 if used <= 5 else 1.3), LONGEST_STEP)
        elif moved > 0.5 * length:
            dt *= 0.5
    for node in range(nodes):
        for i in range(size):
            n = size * node + i
            w0[n] = 0.0
            if i < dimension:
                w0[n] = frame[i]
            a0[n] = 0.0
    set_time(I, M, M[S_TIME])
    M[S_FLOOR_DAMPING] = damping
    if flow != 0.0:
        add_flow(I, M, flow, q0, w0, a0)
    I[I_FACTORED] = 0
    return status


@kernel
def add_flow(I, M, flow, q, v, a):
    """Motion of cable that runs along its own shape at the rate `flow` (eq. 16, d/dt = 0).

    v += flow r', v' = flow r'', a = flow^2 r''; r'' at a node is the mean of both sides. The
    vessel's node gets its own by the pay-out terms of the top element. What has been laid is at
    rest.
    """
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    nodes = I[I_NODES]
    w = view(M, I[O_MOTION] + 28, 3)
    for node in range(1, nodes):
        if is_laid(I, M, q, node, w):
            for i in range(dimension):
                v[size * node + i] = 0.0
            continue
        for i in range(dimension):
            n = size * node + i
            second = 0.0
            sides = 0.0
            for side in range(2):
                edge = node + side
                if edge >= nodes or I[I[O_JOINT] + edge] != 0:
                    continue
                h = M[I[O_EDGE] + edge * EDGE_WORDS + E_LENGTH]
                p = size * I[I[O_PARENT] + edge] + i
                c = size * edge + i
                chord = (q[c] - q[p]) / h
                if side == 0:
                    second += (2.0 * q[p + dimension] + 4.0 * q[c + dimension] - 6.0 * chord) / h
                else:
                    second += (6.0 * chord - 4.0 * q[p + dimension] - 2.0 * q[c + dimension]) / h
                sides += 1.0
            second /= max(sides, 1.0)
            v[n] += flow * q[n + dimension]
            v[n + dimension] += flow * second
            a[n] = flow * flow * second


@kernel
def stretch_to_tension(I, M):
    """Tensions that belong to the stretch of the positions in the block (at rest)."""
    count = 2 * I[I_DIMENSION] * I[I_NODES]
    nodes = I[I_NODES]
    q = M[I[O_POSITION] : I[O_POSITION] + count]
    v = M[I[O_VELOCITY] : I[O_VELOCITY] + count]
    a = M[I[O_ACCELERATION] : I[O_ACCELERATION] + count]
    tension = M[I[O_TENSION] : I[O_TENSION] + 2 * nodes]
    forces = M[I[O_RESIDUAL] : I[O_RESIDUAL] + count]
    constraint = M[I[O_CONSTRAINT_RESIDUAL] : I[O_CONSTRAINT_RESIDUAL] + 2 * nodes]
    set_time(I, M, M[S_TIME])
    for _iteration in range(30):
        residual(I, M, q, v, a, tension, forces, constraint)
        jacobian(I, M, q, v, a, tension, 1.0, 1.0)
        for node in range(1, nodes):
            s = I[O_COMPLIANCE] + 3 * node
            r0 = constraint[2 * node]
            r1 = constraint[2 * node + 1]
            tension[2 * node] += M[s] * r0 + M[s + 1] * r1
            tension[2 * node + 1] += M[s + 1] * r0 + M[s + 2] * r1
    I[I_FACTORED] = 0
