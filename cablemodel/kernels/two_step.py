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

from .compile import copy_words, inlined, kernel, view
from .environment import surge_jump
from .layout import (
    I_DIMENSION,
    I_FACTORED,
    I_FRESH,
    I_HISTORY,
    I_ITERATIONS,
    I_LIVE,
    I_NODES,
    I_PIECE,
    I_PIECES,
    I_TWO_STEP_CHECK,
    I_TWO_STEP_REST,
    I_TWO_STEP_WAIT,
    O_ACCELERATION,
    O_COMPLIANCE,
    O_CONSTRAINT_RESIDUAL,
    O_HISTORY,
    O_INCREMENT,
    O_PIECES,
    O_POSITION,
    O_RESIDUAL,
    O_TENSION,
    O_TENSION_RATE,
    O_TRIAL_A,
    O_TRIAL_Q,
    O_TRIAL_T,
    O_TRIAL_V,
    O_VELOCITY,
    P_ACCELERATION_JUMP,
    P_END,
    P_VELOCITY_JUMP,
    PIECE_WORDS,
    S_FACTORED_STEP,
    S_LARGEST_TENSION,
    S_LAST_STEP,
    S_PERIOD,
    S_STAGE_TENSION,
    S_TENSION_SCALE,
    S_TIME,
    S_TIME_TOLERANCE,
    S_TWO_STEP_RATIO,
)
from .newton import NO_TENSION, increment_norm, refactor
from .system import (
    impose_motion,
    newton_increment,
    recover_tension,
    residual,
    set_time,
)

LARGEST_GROWTH = 2.0  # of the step; variable-step BDF2 is stable up to 1 + sqrt(2)
LARGEST_ERROR = 0.03  # of the local tolerance: what is left after a natural step is .03^(2/3) of it
SHORTEST_WAIT, LONGEST_WAIT = 4, 64  # steps by the one-step scheme after a refusal
CHECK = 16  # steps between measurements of the convergence ratio
MOST_ITERATIONS = 4
STALE = 0.25  # convergence ratio that asks for a new factorisation


@kernel
def starts_at_a_kink(I, M, dt):
    """Whether the vessel's motion or the current has a kink that matters at the present time."""
    surge, _most = surge_jump(I, M, M[S_TIME])
    if surge * dt * dt > 0.1 * M[S_TIME_TOLERANCE]:
        return True
    if I[I_LIVE] != 0:
        return False
    k = I[I_PIECE]
    if k + 1 >= I[I_PIECES]:
        return False
    row = I[O_PIECES] + k * PIECE_WORDS
    if M[row + P_END] > M[S_TIME]:
        return False
    row += PIECE_WORDS
    return (
        M[row + P_VELOCITY_JUMP] > 0.0
        or M[row + P_ACCELERATION_JUMP] * dt * dt > 0.1 * M[S_TIME_TOLERANCE]
    )


@inlined
def refuse(I):
    """Leave the next steps to the one-step scheme, and more of them each time in a row."""
    rest = min(LONGEST_WAIT, max(SHORTEST_WAIT, 2 * I[I_TWO_STEP_REST]))
    I[I_TWO_STEP_REST] = rest
    I[I_TWO_STEP_WAIT] = rest
    return False


@kernel
def try_two_step(I, M, dt):
    """One BDF2 step from the state to the trial; returns whether it may be accepted.

    The state is as before; the factorisation may be another one.
    """
    last = M[S_LAST_STEP]
    if I[I_HISTORY] == 0 or dt > LARGEST_GROWTH * last or last > 2.5 * dt:
        return False
    if I[I_TWO_STEP_WAIT] > 0:
        I[I_TWO_STEP_WAIT] -= 1
        return False
    if starts_at_a_kink(I, M, dt):
        return False
    count = 2 * I[I_DIMENSION] * I[I_NODES]
    nodes = I[I_NODES]
    q0 = view(M, I[O_POSITION], count)
    v0 = view(M, I[O_VELOCITY], count)
    a0 = view(M, I[O_ACCELERATION], count)
    q1 = view(M, I[O_HISTORY], count)
    v1 = view(M, I[O_HISTORY] + count, count)
    q = view(M, I[O_TRIAL_Q], count)
    v = view(M, I[O_TRIAL_V], count)
    a = view(M, I[O_TRIAL_A], count)
    t0 = view(M, I[O_TENSION], 2 * nodes)
    rate = view(M, I[O_TENSION_RATE], 2 * nodes)
    tension = view(M, I[O_TRIAL_T], 2 * nodes)
    forces = view(M, I[O_RESIDUAL], count)
    constraint = view(M, I[O_CONSTRAINT_RESIDUAL], 2 * nodes)
    x = view(M, I[O_INCREMENT], count)

    rho = dt / last
    gamma_dt = two_step_gamma(M, dt)
    b0 = 1.0 / gamma_dt
    b1 = -(1.0 + rho) / dt
    b2 = rho * rho / ((1.0 + rho) * dt)
    half = 0.5 * dt * dt
    for n in range(count):
        q[n] = q0[n] + dt * v0[n] + half * a0[n]
        v[n] = b0 * q[n] + b1 * q0[n] + b2 * q1[n]
        a[n] = b0 * v[n] + b1 * v0[n] + b2 * v1[n]
    for n in range(2 * nodes):
        tension[n] = t0[n] + dt * rate[n]
    set_time(I, M, M[S_TIME] + dt)
    impose_motion(I, M, M[S_TIME] + dt, q, v, a)
    I[I_FRESH] = 0
    change = M[S_FACTORED_STEP] / gamma_dt
    if I[I_FACTORED] == 0 or change < 0.87 or change > 1.15:
        if refactor(I, M, q, v, a, tension, gamma_dt) != 0:
            return False
        I[I_TWO_STEP_CHECK] = 0
    # What is left of a step is a force that acts as long as it is left; over a period of the line
    # it must move it by less than the tolerance.
    tolerance = M[S_TIME_TOLERANCE]
    share = min(1.0, dt / M[S_PERIOD])
    enough = 0.1 * tolerance * share * share
    measure = I[I_TWO_STEP_CHECK] <= 0
    previous = 0.0
    moved = 0.0
    for iteration in range(MOST_ITERATIONS):
        residual(I, M, q, v, a, tension, forces, constraint)
        newton_increment(I, M, forces, constraint, x)
        I[I_ITERATIONS] += 1
        size, _where = increment_norm(I, M, x)
        if iteration == 0:
            s = view(M, I[O_COMPLIANCE] + 3, 3)
            M[S_STAGE_TENSION] = tension[2] + s[0] * constraint[2] + s[1] * constraint[3]
        moved += size
        if not 0.5 * moved <= LARGEST_ERROR * tolerance:
            return refuse(I)
        for n in range(count):
            q[n] += x[n]
            v[n] += b0 * x[n]
            a[n] += b0 * b0 * x[n]
        tension_change = recover_tension(I, M, constraint, x, tension)
        largest = 0.0
        for n in range(1, nodes):
            largest = max(largest, abs(tension[2 * n]))
        if iteration > 0:
            ratio = size / previous if previous > 0.0 else 0.0
            if size < 1e-3 * enough:
                ratio = min(ratio, 0.05)  # rounding
            M[S_TWO_STEP_RATIO] = max(ratio, 0.01)
            I[I_TWO_STEP_REST] = I[I_TWO_STEP_REST] // 2
            I[I_TWO_STEP_CHECK] = CHECK
            measure = False
        ratio = M[S_TWO_STEP_RATIO]
        if (
            not measure
            and ratio < 0.5
            and ratio * size <= enough
            and ratio * tension_change <= 1e-4 * max(largest, NO_TENSION * M[S_TENSION_SCALE])
        ):
            I[I_TWO_STEP_CHECK] -= 1
            M[S_LARGEST_TENSION] = max(M[S_LARGEST_TENSION], largest)
            return True
        if iteration > 0 and ratio > STALE:
            if I[I_FRESH] == 1:
                break
            if refactor(I, M, q, v, a, tension, gamma_dt) != 0:
                return False
        previous = size
    return refuse(I)


@kernel
def two_step_gamma(M, dt):
    """Of a two-step step of dt, what gamma dt is of a one-step step [s]."""
    rho = dt / M[S_LAST_STEP]
    return dt * (1.0 + rho) / (1.0 + 2.0 * rho)


@kernel
def remember(I, M):
    """Keep the state that a step is about to replace."""
    count = 2 * I[I_DIMENSION] * I[I_NODES]
    copy_words(I, I[O_HISTORY], I[O_POSITION], count)
    copy_words(I, I[O_HISTORY] + count, I[O_VELOCITY], count)
    I[I_HISTORY] = 1


@kernel
def accept_two_step(I, M, dt):
    """The trial becomes the state."""
    remember(I, M)
    count = 2 * I[I_DIMENSION] * I[I_NODES]
    before = view(M, I[O_TENSION], 2 * I[I_NODES])
    after = view(M, I[O_TRIAL_T], 2 * I[I_NODES])
    rate = view(M, I[O_TENSION_RATE], 2 * I[I_NODES])
    inverse = 1.0 / dt
    for n in range(2 * I[I_NODES]):
        rate[n] = (after[n] - before[n]) * inverse
        before[n] = after[n]
    copy_words(I, I[O_POSITION], I[O_TRIAL_Q], count)
    copy_words(I, I[O_VELOCITY], I[O_TRIAL_V], count)
    copy_words(I, I[O_ACCELERATION], I[O_TRIAL_A], count)
    M[S_LAST_STEP] = dt
