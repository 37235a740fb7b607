"""Steps that the caller limits: variable-step BDF2 with, as a rule, one Newton iteration.

At 100 Hz a towed cable is sampled a hundred times more often than its motion needs. The three
stages of the one-step scheme, and its iterations until nothing changes, are then waste: a
formula that uses the state one step ago is accurate enough, and a predictor so close that one
iteration corrects it.

    v = b0 q + b1 q_n + b2 q_(n-1),  a = b0 v + b1 v_n + b2 v_(n-1)

with rho = d_n / d_(n-1), b0 = (1 + 2 rho) / ((1 + rho) d), b1 = -(1 + rho) / d and
b2 = rho^2 / ((1 + rho) d). The prediction is q_n + d v_n + d^2 a_n / 2; its distance from the
result, C d^3 q''', is the error's measure. Whatever is not smooth, or does not converge at once,
is refused here and taken by the one-step scheme, from the same state.
"""

from cablemodel.solvers.finite_element.kernels.element.strain import largest_mean
from cablemodel.solvers.finite_element.kernels.floor.floor_state import rubs
from cablemodel.solvers.finite_element.kernels.line.closures import follow_forces
from cablemodel.solvers.finite_element.kernels.line.newton import (
    NO_TENSION,
    TENSION_SETTLED,
    increment_norm,
    refactor,
)
from cablemodel.solvers.finite_element.kernels.line.products import in_pairs
from cablemodel.solvers.finite_element.kernels.line.system import (
    impose_motion,
    newton_increment,
    recover_tension,
    residual,
    set_time,
)
from cablemodel.solvers.finite_element.kernels.time.rings import left_in_tensions
from cablemodel.solvers.finite_element.kernels.time.watched_tension import watched
from cablemodel.solvers.shared.access import (
    compliance_of,
    header,
    motion_piece_of,
    scalars,
)
from cablemodel.solvers.shared.compile import copy_words, inlined, kernel, view
from cablemodel.solvers.shared.environment import surge_jump

BDF_LARGEST_GROWTH = 2.0  # of the step; variable-step BDF2 is stable up to 1 + sqrt(2)
LARGEST_ERROR = 0.03  # of the local tolerance: what is left after a natural step is .03^(2/3) of it
SHORTEST_WAIT, LONGEST_WAIT = 4, 64  # steps by the one-step scheme after a refusal
CHECK = 16  # steps between measurements of the convergence ratio
BDF_MOST_ITERATIONS = 4
STALE = 0.25  # convergence ratio that asks for a new factorisation
BREAK_SEEN = 0.1  # of a step's tolerance: a jump times dt^2 at which it is not begun
BDF_LARGEST_CUT = 2.5  # of the last step, over this one
MATRIX_FROM, MATRIX_TO = 0.87, 1.15  # of gamma dt: steps that a matrix serves
BDF_LEFT = 0.1  # of the tolerance: what may be left of a step
BDF_ROUNDED = 1e-3  # of that: increments whose ratio is rounding
ROUNDED_RATIO, LEAST_RATIO = 0.05, 0.01  # what is then taken for it at most, and always at least


@in_pairs
def predict(q0, v0, a0, q1, v1, dt, half, b0, b1, b2):
    """Positions by the state's motion; velocities and accelerations that the formula has there."""
    q = q0 + dt * v0 + half * a0
    v = b0 * q + b1 * q0 + b2 * q1
    return q, v, b0 * v + b1 * v0 + b2 * v1


@in_pairs
def correct(q, v, a, x, b, square):
    """Motion with an increment x of the positions, of which v has b times as much, a its square."""
    return q + x, v + b * x, a + square * x


@in_pairs
def change_over(after, before, inverse):
    """Rate of what has changed in a step of 1 / inverse, and what it is now."""
    return (after - before) * inverse, after


@kernel
def starts_at_a_breakpoint(I, M, dt):
    """Whether the vessel's motion or the current has a breakpoint now that matters."""
    head = header(I)
    state = scalars(M)
    surge, _most = surge_jump(I, M, state.time)
    if surge * dt * dt > BREAK_SEEN * state.time_tolerance:
        return True
    if head.live != 0:
        return False
    k = head.piece
    if k + 1 >= head.piece_count:
        return False
    row = motion_piece_of(I, M, k)
    if row.end > state.time:
        return False
    row = motion_piece_of(I, M, k + 1)
    return (
        row.velocity_jump > 0.0
        or row.acceleration_jump * dt * dt > BREAK_SEEN * state.time_tolerance
    )


@inlined
def refuse(I):
    """Leave the next steps to the one-step scheme, and more of them each time in a row."""
    head = header(I)
    rest = min(LONGEST_WAIT, max(SHORTEST_WAIT, 2 * head.two_step_rest))
    head.two_step_rest = rest
    head.two_step_wait = rest
    return False


@kernel
def keep_first_tensions(I, M, tension, constraint):
    """Tensions of what is watched by the positions that are predicted."""
    head = header(I)
    for node in range(1, watched(I)):
        s = compliance_of(I, M, node)
        stretched = s.s00 * constraint[2 * node] + s.s01 * constraint[2 * node + 1]
        M[head.stage_tensions + 6 * node] = tension[2 * node] + stretched


@kernel
def try_two_step(I, M, dt):
    """One BDF2 step from the state to the trial; returns whether it may be accepted.

    The state is as before; the factorisation may be another one.
    """
    head = header(I)
    state = scalars(M)
    last = state.last_step
    if head.has_history == 0 or dt > BDF_LARGEST_GROWTH * last or last > BDF_LARGEST_CUT * dt:
        return False
    if head.two_step_wait > 0:
        head.two_step_wait -= 1
        return False
    if starts_at_a_breakpoint(I, M, dt):
        return False
    count = 2 * head.dimension * head.nodes
    nodes = head.nodes
    q0 = view(M, head.position, count)
    v0 = view(M, head.velocity, count)
    a0 = view(M, head.acceleration, count)
    q1 = view(M, head.history, count)
    v1 = view(M, head.history + count, count)
    q = view(M, head.trial_position, count)
    v = view(M, head.trial_velocity, count)
    a = view(M, head.trial_acceleration, count)
    t0 = view(M, head.tension, 2 * nodes)
    rate = view(M, head.tension_rate, 2 * nodes)
    tension = view(M, head.trial_tension, 2 * nodes)
    forces = view(M, head.residual, count)
    constraint = view(M, head.constraint_residual, 2 * nodes)
    x = view(M, head.increment, count)

    rho = dt / last
    gamma_dt = two_step_gamma(M, dt)
    b0 = 1.0 / gamma_dt
    b1 = -(1.0 + rho) / dt
    b2 = rho * rho / ((1.0 + rho) * dt)
    half = 0.5 * dt * dt
    predict(count, (q, v, a), (q0, v0, a0, q1, v1), (dt, half, b0, b1, b2))
    for n in range(2 * nodes):
        tension[n] = t0[n] + dt * rate[n]
    set_time(I, M, state.time + dt)
    impose_motion(I, M, state.time + dt, q, v, a)
    head.fresh = 0
    change = state.factored_step / gamma_dt
    if head.factored == 0 or change < MATRIX_FROM or change > MATRIX_TO:
        if refactor(I, M, q, v, a, tension, gamma_dt) != 0:
            return False
        head.two_step_check = 0
    # What is left of a step is a force that acts as long as it is left; over a period of the line
    # it must move it by less than the tolerance.
    tolerance = state.time_tolerance
    share = min(1.0, dt / state.period)
    enough = BDF_LEFT * tolerance * share * share
    # Cable that rubs sticks and slips: how fast increments shrank before says nothing.
    measure = head.two_step_check <= 0 or rubs(I, M)
    most_left = left_in_tensions(I, M, dt)
    previous = 0.0
    moved = 0.0
    for iteration in range(BDF_MOST_ITERATIONS):
        residual(I, M, q, v, a, tension, forces, constraint)
        newton_increment(I, M, forces, constraint, x)
        head.iterations += 1
        size, _where = increment_norm(I, M, x)
        if iteration == 0:
            keep_first_tensions(I, M, tension, constraint)
        moved += size
        if not 0.5 * moved <= LARGEST_ERROR * tolerance:
            return refuse(I)
        correct(count, (q, v, a), (q, v, a, x), (b0, b0 * b0))
        tension_change = recover_tension(I, M, constraint, x, tension, True)
        follow_forces(I, M)
        largest = largest_mean(tension, nodes)
        if iteration > 0:
            ratio = size / previous if previous > 0.0 else 0.0
            if size < BDF_ROUNDED * enough:
                ratio = min(ratio, ROUNDED_RATIO)
            state.two_step_ratio = max(ratio, LEAST_RATIO)
            head.two_step_rest = head.two_step_rest // 2
            head.two_step_check = CHECK
            measure = False
        ratio = state.two_step_ratio
        if (
            not measure
            and ratio < 0.5
            and ratio * size <= enough
            and ratio * tension_change
            <= min(TENSION_SETTLED * max(largest, NO_TENSION * state.tension_scale), most_left)
        ):
            head.two_step_check -= 1
            state.largest_tension = max(state.largest_tension, largest)
            return True
        if iteration > 0 and ratio > STALE:
            if head.fresh == 1:
                break
            if refactor(I, M, q, v, a, tension, gamma_dt) != 0:
                return False
        previous = size
    return refuse(I)


@kernel
def two_step_gamma(M, dt):
    """Of a two-step step of dt, what gamma dt is of a one-step step [s]."""
    state = scalars(M)
    rho = dt / state.last_step
    return dt * (1.0 + rho) / (1.0 + 2.0 * rho)


@kernel
def remember(I, M):
    """Keep the state that a step is about to replace."""
    head = header(I)
    count = 2 * head.dimension * head.nodes
    copy_words(I, head.history, head.position, count)
    copy_words(I, head.history + count, head.velocity, count)
    head.has_history = 1


@kernel
def accept_two_step(I, M, dt):
    """The trial becomes the state."""
    head = header(I)
    state = scalars(M)
    remember(I, M)
    count = 2 * head.dimension * head.nodes
    before = view(M, head.tension, 2 * head.nodes)
    after = view(M, head.trial_tension, 2 * head.nodes)
    rate = view(M, head.tension_rate, 2 * head.nodes)
    inverse = 1.0 / dt
    change_over(2 * head.nodes, (rate, before), (after, before), (inverse,))
    copy_words(I, head.position, head.trial_position, count)
    copy_words(I, head.velocity, head.trial_velocity, count)
    copy_words(I, head.acceleration, head.trial_acceleration, count)
    state.last_step = dt
