"""One step of ESDIRK, of order 3 or 4, with a simplified Newton method.

Unknown of a stage is the acceleration a_i, through q_i = q^ + (gamma dt)^2 a_i and
v_i = v^ + gamma dt a_i; prescribed nodes are imposed exactly in every stage. Tension is algebraic:
Newton's test looks at it in the last stage before an output only, and its error, of order 2 in the
step, is estimated from those of the stages.
"""

import math

from cablemodel.solvers.finite_element.kernels.element.strain import largest_mean
from cablemodel.solvers.finite_element.kernels.element.tables import (
    GAMMA,
    STAGE_A,
    STAGE_C,
    STAGE_ERROR,
    STAGES,
)
from cablemodel.solvers.finite_element.kernels.floor.floor_state import lands, rubs
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
from cablemodel.solvers.finite_element.kernels.time.embedded_tension import keep_stage_tensions
from cablemodel.solvers.finite_element.kernels.time.rings import left_in_tensions
from cablemodel.solvers.finite_element.kernels.time.tension import PASSES_OVER, tension_error
from cablemodel.solvers.finite_element.kernels.time.two_step import correct, remember
from cablemodel.solvers.finite_element.kernels.water.sea_cells import begin_stage, end_stage
from cablemodel.solvers.shared.access import header, scalars
from cablemodel.solvers.shared.compile import copy_words, inlined, kernel, view
from cablemodel.solvers.shared.layout import FLOOR_ABOVE, NOT_CONVERGED, OK

LARGEST_ITERATIONS = 10
MORE_ITERATIONS = 16  # the same while points of elements begin or cease to bend aside
AT_FLOOR_FORCES = -1  # status of a step without the floor's forces that comes to where they act
LEAST_SHARE = 0.1  # of the local error allowed: what a step however short has
STAGE_AT_ONCE = 0.02  # of the tolerance: what a first iteration may leave, by the last ratio
STAGE_UNSEEN = 1e-4  # tau down to which what that leaves is not seen
NO_NEARER = 0.9  # of the last increment: from there on what bends aside to and fro is halved
BEST_RATIO = 0.003  # that is believed for the next stage
UNSEEN_RATIO = 0.03  # the same where increments were so small that it says little
SAME_STEP = 1e-6  # of gamma dt: a matrix that differs by less serves
STAGE_LEFT = 0.1  # of the tolerance: what may be left of a stage
OUTPUT_LEFT = 0.02  # of the tolerance: the same of a step that is read
STAGE_PERIOD = 0.1  # of the period: gamma dt from which on as much may be left of a stage
DIVERGED = 1e30  # increment from which none comes back [m]
STAGE_EXACT = 0.01  # of the tolerance: an increment after which no more is looked at
SLOW_BEFORE = 0.2  # ratio of increments that asks for a new matrix, with one of an earlier step
SLOW_FRESH = 0.4  # the same with one of this step


@in_pairs
def move_on(v, q, by_a, by_v, weight):
    """Velocities and positions with accelerations and velocities of a stage, in their share."""
    return v + weight * by_a, q + weight * by_v


@in_pairs
def predict_stage(v, q, a, gamma_dt):
    """Velocities and positions of a stage by accelerations near its own."""
    v = v + gamma_dt * a
    return v, q + gamma_dt * v


@in_pairs
def add_multiple(x, y, weight):
    """The sum x + weight y."""
    return (x + weight * y,)


@in_pairs
def sum_of_three(x, y, z, wx, wy, wz):
    """The sum wx x + wy y + wz z."""
    return (wx * x + wy * y + wz * z,)


@kernel
def solve_stage(I, M, t, gamma_dt, tolerance, most_left, to_output, ratio):
    """Newton for one stage; on entry the trial holds what is predicted.

    most_left: tension that may be left [N]. ratio: convergence of the matrix in the stages before,
    1 where it is not known. Returns a status, and the ratio for the next stage.
    """
    head = header(I)
    state = scalars(M)
    count = 2 * head.dimension * head.nodes
    nodes = head.nodes
    q = view(M, head.trial_position, count)
    v = view(M, head.trial_velocity, count)
    a = view(M, head.trial_acceleration, count)
    tension = view(M, head.trial_tension, 2 * nodes)
    forces = view(M, head.residual, count)
    constraint = view(M, head.constraint_residual, 2 * nodes)
    x = view(M, head.increment, count)
    inverse = 1.0 / gamma_dt
    inverse2 = inverse * inverse
    set_time(I, M, t)
    impose_motion(I, M, t, q, v, a)
    if head.factored == 0 or abs(state.factored_step - gamma_dt) > SAME_STEP * gamma_dt:
        if refactor(I, M, q, v, a, tension, gamma_dt) != 0:
            return NOT_CONVERGED, ratio
    previous = 0.0
    since = 0  # iterations with a factorisation made in this stage
    growing = 0
    head.bent_aside = 0
    good = OUTPUT_LEFT if to_output else STAGE_LEFT
    at_once = 0.0 if to_output or state.tolerance < STAGE_UNSEEN else STAGE_AT_ONCE
    # What is left of a stage leaves that over gamma dt in the velocity, which an undamped motion
    # keeps: it must be small against the tolerance over a period, however short the steps are.
    tolerance *= min(1.0, gamma_dt / (STAGE_PERIOD * state.period))
    for iteration in range(MORE_ITERATIONS):
        residual(I, M, q, v, a, tension, forces, constraint)
        newton_increment(I, M, forces, constraint, x)
        head.iterations += 1
        size, where = increment_norm(I, M, x)
        if not size < DIVERGED:
            I[head.failed] = where
            head.factored = 0
            return NOT_CONVERGED, ratio
        if not size < NO_NEARER * previous and (
            head.bent_aside != 0 or (iteration > 1 and rubs(I, M))
        ):
            # Points change sides, bend aside or slip, to and fro: what is looked for is between.
            for n in range(count):
                x[n] *= 0.5
        correct(count, (q, v, a), (q, v, a, x), (inverse, inverse2))
        tension_change = recover_tension(I, M, constraint, x, tension, True)
        follow_forces(I, M)
        settled = True
        if to_output:
            largest = max(NO_TENSION * state.tension_scale, largest_mean(tension, nodes))
            settled = tension_change <= TENSION_SETTLED * largest
        if settled and size <= STAGE_EXACT * tolerance and tension_change <= most_left:
            if ratio == 1.0 and since > 0:
                ratio = max(size / previous, UNSEEN_RATIO)
            return OK, ratio
        if iteration == 0:
            left = ratio / (1.0 - ratio) if ratio < 1.0 else math.inf
            if left * size <= at_once * tolerance and left * tension_change <= most_left:
                return OK, ratio
        else:
            shrunk = size / previous
            # After a new matrix it compares two of them.
            ratio = max(shrunk, BEST_RATIO) if since > 0 else 1.0
            left = shrunk / (1.0 - shrunk) if shrunk < 1.0 else math.inf
            enough = left * size <= good * tolerance and left * tension_change <= most_left
            if settled and enough:
                return OK, ratio
            growing = growing + 1 if shrunk > 2.0 else 0
            if growing == 2 and size > tolerance:
                I[head.failed] = where
                return NOT_CONVERGED, ratio
            slow = shrunk > (SLOW_BEFORE if head.fresh == 0 else SLOW_FRESH) and since > 0
            if slow or head.bent_aside != 0:
                if refactor(I, M, q, v, a, tension, gamma_dt) != 0:
                    return NOT_CONVERGED, ratio
                since = -1
        since += 1
        previous = size
        I[head.failed] = where
        if iteration + 1 >= LARGEST_ITERATIONS and head.bent_aside == 0:
            break
    return NOT_CONVERGED, ratio


@inlined
def stage_words(I, i, stages):
    """Words where velocity and acceleration of a stage are: state, stages between, trial."""
    head = header(I)
    if i == 0:
        return head.velocity, head.acceleration
    if i == stages - 1:
        return head.trial_velocity, head.trial_acceleration
    between = 2 * head.dimension * head.nodes * (i - 1)
    return head.stage_velocity + between, head.stage_acceleration + between


@kernel
def share_of_error(M, dt):
    """Of the local error that is allowed, what a step has that is short against the line's memory.

    An error e of the position goes with one of e / dt of the velocity, which moves the line on for
    as long as drag and gravity take to forget it, and shorter steps are more. In proportion to dt
    steps would become ever shorter where stiff axial motion decides the estimate; the root of it
    does for what was wrong, and has a floor.
    """
    state = scalars(M)
    memory = state.memory
    if dt >= memory:
        return 1.0
    return max(LEAST_SHARE, math.sqrt(dt / memory))


@kernel
def try_step(I, M, dt, scheme, to_output, anew):
    """One ESDIRK step from the state to the trial.

    anew: its first stage is implicit, too, which gives the accelerations to begin with. Where an
    end's acceleration jumps and cable rubs, those before the jump would move it by several
    bristles, and what friction holds would stay wrong.

    Returns the status, the error of position or top tension over what is allowed, and what the
    step does along the line (`tension_error`).
    """
    head = header(I)
    state = scalars(M)
    count = 2 * head.dimension * head.nodes
    nodes = head.nodes
    stages = STAGES[scheme]
    gamma_dt = GAMMA[scheme] * dt
    time = state.time
    tolerance = state.time_tolerance
    q = view(M, head.position, count)
    v = view(M, head.velocity, count)
    a = view(M, head.acceleration, count)
    base_q = view(M, head.base_position, count)
    base_v = view(M, head.base_velocity, count)
    trial_q = view(M, head.trial_position, count)
    trial_v = view(M, head.trial_velocity, count)
    trial_a = view(M, head.trial_acceleration, count)
    head.fresh = 0
    most_left = left_in_tensions(I, M, dt)
    ratio = 1.0
    for n in range(count):
        trial_a[n] = 0.0 if anew else a[n]
    for n in range(2 * nodes):
        M[head.trial_tension + n] = M[head.tension + n]
    for i in range(0 if anew else 1, stages):
        weight = dt * STAGE_A[scheme, i, 0]
        move_on(count, (base_v, base_q), (v, q, a, v), (weight,))
        for j in range(1, i):
            weight = dt * STAGE_A[scheme, i, j]
            if weight != 0.0:
                place_v, place_a = stage_words(I, j, stages)
                stage_v = view(M, place_v, count)
                stage_a = view(M, place_a, count)
                move_on(count, (base_v, base_q), (base_v, base_q, stage_a, stage_v), (weight,))
        predict_stage(count, (trial_v, trial_q), (base_v, base_q, trial_a), (gamma_dt,))
        last = i == stages - 1
        stage_time = time + dt if last else time + max(STAGE_C[scheme, i] * dt, gamma_dt)
        begin_stage(I, M)
        status, ratio = solve_stage(
            I, M, stage_time, gamma_dt, tolerance, most_left, to_output and last, ratio
        )
        end_stage(I, M)
        if i == 0:
            if status == OK:
                copy_words(I, head.acceleration, head.trial_acceleration, count)
            else:
                copy_words(I, head.trial_acceleration, head.acceleration, count)
                copy_words(I, head.trial_tension, head.tension, 2 * nodes)
            continue
        if status != OK:
            return status, 0.0, PASSES_OVER
        if head.floor_state == FLOOR_ABOVE and lands(I, M):
            return AT_FLOOR_FORCES, 0.0, PASSES_OVER
        if not last:
            place_v, place_a = stage_words(I, i, stages)
            copy_words(I, place_v, head.trial_velocity, count)
            copy_words(I, place_a, head.trial_acceleration, count)
        keep_stage_tensions(I, M, i - 1)
        if i == stages - 2:
            for n in range(2 * nodes):
                M[head.stage_tension + n] = M[head.trial_tension + n]
    for n in range(count):
        base_q[n] = 0.0
    for i in range(stages):
        weight = dt * STAGE_ERROR[scheme, i]
        place_v, _place_a = stage_words(I, i, stages)
        stage_v = view(M, place_v, count)
        add_multiple(count, (base_q,), (base_q, stage_v), (weight,))
    error, where = increment_norm(I, M, base_q)
    I[head.failed] = where
    error /= tolerance * share_of_error(M, dt)
    if not error <= 1.0:
        return OK, error, PASSES_OVER
    of_tension, along = tension_error(I, M, dt, scheme, gamma_dt, base_q, error)
    return OK, max(error, of_tension), along


@kernel
def accept_trial(I, M, dt, scheme):
    """The trial becomes the state; the tension's rate is that of a parabola through the step."""
    head = header(I)
    state = scalars(M)
    count = 2 * head.dimension * head.nodes
    c = STAGE_C[scheme, STAGES[scheme] - 2]
    remember(I, M)
    w0 = (1.0 - c) / (c * dt)
    wc = -1.0 / (c * (1.0 - c) * dt)
    w1 = (2.0 - c) / ((1.0 - c) * dt)
    tension = view(M, head.tension, 2 * head.nodes)
    inner = view(M, head.stage_tension, 2 * head.nodes)
    final = view(M, head.trial_tension, 2 * head.nodes)
    rate = view(M, head.tension_rate, 2 * head.nodes)
    sum_of_three(2 * head.nodes, (rate,), (tension, inner, final), (w0, wc, w1))
    state.largest_tension = max(state.largest_tension, largest_mean(final, head.nodes))
    state.last_step = dt
    copy_words(I, head.position, head.trial_position, count)
    copy_words(I, head.velocity, head.trial_velocity, count)
    copy_words(I, head.acceleration, head.trial_acceleration, count)
    copy_words(I, head.tension, head.trial_tension, 2 * head.nodes)
