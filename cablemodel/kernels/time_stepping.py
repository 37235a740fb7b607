"""Adaptive time integration: ESDIRK of order 3 or 4 with a simplified Newton method.

Unknown of a stage is the acceleration a_i, through q_i = q^ + (gamma dt)^2 a_i and
v_i = v^ + gamma dt a_i; prescribed nodes are imposed exactly in every stage. Tension is algebraic:
Newton's test looks at it in the last stage before an output only, and its error, of order 2 in the
step, is estimated from those of the stages.
"""

import math

from .access import edge_of, header, scalars
from .buckling import any_pressed, arch_stands, fall_over, follow_pressure, is_held, make_crooked
from .clamp_layer import follow_layer
from .closures import follow_forces, give_back_forces, keep_forces
from .compile import copy_words, inlined, kernel, view
from .consistency import (
    begin_after_a_blow,
    begins_a_surge,
    follows_a_blow,
    make_consistent,
    project_velocity,
    take_rates_from_velocity,
)
from .cuts import let_go_step, make_cuts, share_before_a_break
from .environment import find_piece
from .floor_memory import settle
from .floor_state import lands, leave_floor
from .follow import follow_floor
from .free_bodies import count_turns_anew
from .layout import (
    FLOOR_ABOVE,
    FLOOR_FAR,
    FLOOR_NONE,
    FLOOR_TOUCHED,
    MODEL_HYBRID,
    NO_CAPACITY,
    NOT_CONVERGED,
    NOTHING,
    OK,
    OVERSTRETCHED,
    STALLED,
    TOO_MANY_STEPS,
)
from .newton import NO_TENSION, increment_norm, is_folded, refactor
from .payout import pay_out
from .promote import promote
from .refine import follow_bending
from .rings import begin_rings, follow_rings, left_of_rings, longest_ring_step, may_miss_rings
from .sea_cells import begin_stage, end_stage
from .slack import follow_slack
from .sleep import (
    disturbance,
    fall_asleep,
    leave_out,
    may_sleep,
    place_to_sleep,
    prepare_joining,
    rejoin,
    wake,
    wake_as_many,
)
from .stabilisation import follow_third_mode
from .step_size import (
    adapt_step,
    choose_order,
    follow_iterations,
    natural_step,
    next_stop,
    prefer_order_3,
    shorten,
)
from .strain import overstretched
from .system import (
    impose_motion,
    newton_increment,
    recover_tension,
    residual,
    set_time,
)
from .tables import GAMMA, STAGE_A, STAGE_C, STAGE_ERROR, STAGES
from .tension import (
    FOLLOWS,
    MISSES,
    PASSES_OVER,
    SHORT,
    SOLVED,
    keep_stage_tensions,
    longest_unwatched,
    remember_tensions,
    take_solved,
    tension_error,
    two_step_error,
)
from .top_of_line import adapt_tops, anything_passes
from .two_step import accept_two_step, remember, try_two_step, two_step_gamma
from .vessel_clamp import update_springs
from .winch import begin_payout, longest_payout_step

LARGEST_ITERATIONS = 10
MORE_ITERATIONS = 16  # the same while points of elements begin or cease to bend aside
STALL = 5000, 1e-5  # internal steps in a row, and their mean length in sqrt(L/g), that end a call
LANDED = -1  # status of a step without the floor's forces that comes to where they act
MOST_REFUSALS = 4  # of a step that ends folded
LEAST_SHARE = 0.1  # of the local error allowed: what a step however short has
AT_ONCE = 0.02  # of the tolerance: what a stage's first iteration may leave, by the last ratio
UNSEEN = 1e-4  # tau down to which what that leaves is not seen
NO_NEARER = 0.9  # of the last increment: from there on what bends aside to and fro is halved
BEST_RATIO = 0.003  # that is believed for the next stage
UNSEEN_RATIO = 0.03  # the same where increments were so small that it says little
UNSTABLE = 30.0  # error of a step that is too long for what grows: the next has 0.4 of it
LONGEST = 0.999  # of the longest step whose tensions are not looked at: one that is so short
FOLDS_ITSELF = 1e-4  # sqrt(L/g): steps so short follow the motion into a fold, none is refused
BENDING_ON, BENDING_OFF = 0.01, 0.005  # hybrid: (EI/T)/h^2 above which bending is kept
BENDING_SEEN = 1e-5  # tau below which what leaving it out misplaces, EI/T times r'', would be seen


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
    if head.factored == 0 or abs(state.factored_step - gamma_dt) > 1e-6 * gamma_dt:
        if refactor(I, M, q, v, a, tension, gamma_dt) != 0:
            return NOT_CONVERGED, ratio
    previous = 0.0
    since = 0  # iterations with a factorisation made in this stage
    growing = 0
    head.bent_aside = 0
    good = 0.02 if to_output else 0.1
    at_once = 0.0 if to_output or state.tolerance < UNSEEN else AT_ONCE
    # What is left of a stage leaves that over gamma dt in the velocity, which an undamped motion
    # keeps: it must be small against the tolerance over a period, however short the steps are.
    tolerance *= min(1.0, gamma_dt / (0.1 * state.period))
    for iteration in range(MORE_ITERATIONS):
        residual(I, M, q, v, a, tension, forces, constraint)
        newton_increment(I, M, forces, constraint, x)
        head.iterations += 1
        size, where = increment_norm(I, M, x)
        if not size < 1e30:
            I[head.failed] = where
            head.factored = 0
            return NOT_CONVERGED, ratio
        if head.bent_aside != 0 and not size < NO_NEARER * previous:
            # Points of elements change sides to and fro: between the two is what is looked for.
            for n in range(count):
                x[n] *= 0.5
        for n in range(count):
            q[n] += x[n]
            v[n] += inverse * x[n]
            a[n] += inverse2 * x[n]
        tension_change = recover_tension(I, M, constraint, x, tension, True)
        follow_forces(I, M)
        settled = True
        if to_output:
            largest = NO_TENSION * state.tension_scale
            for n in range(1, nodes):
                largest = max(largest, abs(tension[2 * n]))
            settled = tension_change <= 1e-4 * largest
        if settled and size <= 0.01 * tolerance and tension_change <= most_left:
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
            slow = shrunk > (0.2 if head.fresh == 0 else 0.4) and since > 0
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
def try_step(I, M, dt, scheme, to_output):
    """One ESDIRK step from the state to the trial.

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
    most_left = left_of_rings(I, M, dt)
    ratio = 1.0
    for n in range(count):
        trial_a[n] = a[n]
    for n in range(2 * nodes):
        M[head.trial_tension + n] = M[head.tension + n]
    for i in range(1, stages):
        weight = dt * STAGE_A[scheme, i, 0]
        for n in range(count):
            base_v[n] = v[n] + weight * a[n]
            base_q[n] = q[n] + weight * v[n]
        for j in range(1, i):
            weight = dt * STAGE_A[scheme, i, j]
            if weight != 0.0:
                place_v, place_a = stage_words(I, j, stages)
                stage_v = view(M, place_v, count)
                stage_a = view(M, place_a, count)
                for n in range(count):
                    base_v[n] += weight * stage_a[n]
                    base_q[n] += weight * stage_v[n]
        for n in range(count):
            motion = gamma_dt * trial_a[n]
            trial_v[n] = base_v[n] + motion
            trial_q[n] = base_q[n] + gamma_dt * (base_v[n] + motion)
        last = i == stages - 1
        stage_time = time + dt if last else time + STAGE_C[scheme, i] * dt
        begin_stage(I, M)
        status, ratio = solve_stage(
            I, M, stage_time, gamma_dt, tolerance, most_left, to_output and last, ratio
        )
        end_stage(I, M)
        if status != OK:
            return status, 0.0, PASSES_OVER
        if head.floor_state == FLOOR_ABOVE and lands(I, M):
            return LANDED, 0.0, PASSES_OVER
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
        for n in range(count):
            base_q[n] += weight * stage_v[n]
    error, where = increment_norm(I, M, base_q)
    I[head.failed] = where
    error /= tolerance * share_of_error(M, dt)
    if not error <= 1.0:
        return OK, error, PASSES_OVER
    of_tension, along = tension_error(I, M, dt, scheme, gamma_dt, base_q)
    return OK, max(error, of_tension), along


@kernel
def folds(I, M):
    """Whether the trial is folded in line where the state is not yet."""
    head = header(I)
    count = 2 * head.dimension * head.nodes
    words = 2 * head.nodes
    return is_folded(
        I, M, view(M, head.trial_position, count), view(M, head.trial_tension, words)
    ) and not (is_folded(I, M, view(M, head.position, count), view(M, head.tension, words)))


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
    for n in range(2 * head.nodes):
        rate[n] = w0 * tension[n] + wc * inner[n] + w1 * final[n]
    for node in range(1, head.nodes):
        state.largest_tension = max(state.largest_tension, abs(final[2 * node]))
    state.last_step = dt
    copy_words(I, head.position, head.trial_position, count)
    copy_words(I, head.velocity, head.trial_velocity, count)
    copy_words(I, head.acceleration, head.trial_acceleration, count)
    copy_words(I, head.tension, head.trial_tension, 2 * head.nodes)


@kernel
def change_mesh(I, M, rests):
    """Let joints pass the tow point, split and join elements; then make the state consistent.

    rests: whether cable may fall asleep, which is joined with as much that sleeps: nothing else is,
    since what stays awake beside it would stir.

    Splitting is exact. A joined element has the strain and the elongation's rate of its parts.
    """
    head = header(I)
    state = scalars(M)
    if state.last_step == 0.0:
        state.last_step = state.step
    take_rates_from_velocity(I, M)
    state.joined = 0.0
    state.modes_known = 0.0
    if rests:
        wake_as_many(I, M)
    if head.payout != 0:
        status = adapt_tops(I, M)
        if status != OK:
            return status
    first = 0
    if rests:
        first = place_to_sleep(I, M)
        prepare_joining(I, M, first)
    found = NOTHING
    if head.floor_state != FLOOR_FAR:
        found = follow_floor(I, M, True, first)
    elif state.bent > 0.0:
        found = follow_bending(I, M, True)
    if found == NO_CAPACITY:
        return NO_CAPACITY
    if rests:
        fall_asleep(I, M, first)  # what was joined is made consistent when it wakes
    make_consistent(I, M, True)
    state.joined = 0.0
    return OK


@kernel
def update_bending(I, M):
    """Hybrid model: bending is kept where sqrt(EI/T) is long enough for the mesh to see it.

    What that makes ring beside the ring that is followed order 3 damps, and order 4 would not.
    """
    head = header(I)
    state = scalars(M)
    switched = False
    fine = min(1.0, state.tolerance / BENDING_SEEN) ** 2
    for node in range(1, head.nodes):
        e = edge_of(I, M, node)
        if e.model != MODEL_HYBRID:
            continue
        h = e.length
        stiffness = e.bending_full
        pull = h * h * (M[head.tension + 2 * node] - abs(M[head.tension + 2 * node + 1]))
        if e.bending == 0.0:
            if stiffness > BENDING_ON * fine * pull:
                e.bending = stiffness
                switched = True
        elif stiffness < BENDING_OFF * fine * pull:
            e.bending = 0.0
            switched = True
    if switched:
        head.factored = 0
        head.has_history = 0
        if head.rings != 0:
            prefer_order_3(M)


@kernel
def grows_unseen(I, M, gamma_dt):
    """Whether something grows that is pressed aside in the trial, faster than its step follows."""
    head = header(I)
    state = scalars(M)
    count = 2 * head.dimension * head.nodes
    q = view(M, head.trial_position, count)
    tension = view(M, head.trial_tension, 2 * head.nodes)
    if gamma_dt < FOLDS_ITSELF * state.period or not any_pressed(I, M, q, tension):
        return False
    v = view(M, head.trial_velocity, count)
    a = view(M, head.trial_acceleration, count)
    return refactor(I, M, q, v, a, tension, gamma_dt) != 0 or not is_held(I, M)


@inlined
def mesh_is_due(I, M):
    """Whether the mesh of a line far from any floor may be looked at again."""
    head = header(I)
    state = scalars(M)
    return head.floor_state == FLOOR_FAR and state.bent > 0.0 and state.time >= state.bent_after


@kernel
def leave_plane(I, M):
    """A planar model goes on in space; what sleeps, too."""
    asleep = header(I).left_out
    rejoin(I, M)
    promote(I, M)
    if asleep != 0:
        leave_out(I, M)


@kernel
def advance_to(I, M, t_end):
    """Integrate to t_end exactly; on failure the status says why and the state is of no use."""
    head = header(I)
    state = scalars(M)
    status = OK
    taken = 0
    unprojected = False
    refused = 0
    mark = state.time
    jolted = -1e300
    two_steps = False
    landed = True  # on what may have a kink
    if head.cut_count != 0:
        status = make_cuts(I, M)
        if status != OK:
            return status
    keep_forces(I, M)
    while state.time < t_end:
        give_back_forces(I, M)
        # The mesh changes before a step: what is read after it is a state that a step has made.
        rests = head.sleep != 0 and state.time >= state.sleep_after and may_sleep(I, M)
        if (
            rests
            or (head.payout != 0 and anything_passes(I, M))
            or (head.floor_state != FLOOR_FAR and follow_floor(I, M, False, 0) != NOTHING)
            or (mesh_is_due(I, M) and follow_bending(I, M, False) != NOTHING)
        ):
            status = change_mesh(I, M, rests)
            if status != OK:
                break
        natural = natural_step(I, M)
        stop = next_stop(I, M, t_end, natural)
        jump = 0.0
        kink = 0.0
        if head.payout != 0:
            stop, jump, kink = begin_payout(I, M, stop)
            if kink != 0.0:
                head.settled = 0
            natural = longest_payout_step(I, M, natural)
        if landed or kink != 0.0:
            begin_rings(I, M, natural)
            landed = False
        if jump * natural > state.time_tolerance:
            natural = max(state.time_tolerance / jump, 10.0 * state.smallest_step)
            state.step = natural
            jolted = state.time
        remaining = stop - state.time
        # Friction that slips has a kink: across it the stages of order 4 make rings.
        rubs = head.floor_state == FLOOR_TOUCHED and (state.friction > 0.0 or head.foot_count != 0)
        highest = 1 if head.order == 4 and state.order_3 == 0.0 and not rubs else 0
        dt = longest_ring_step(I, M, natural, highest)
        landing = False
        if dt >= remaining * 0.999:
            dt = remaining
            landing = True
        elif dt > 0.5 * remaining:
            dt = 0.5 * remaining
        # Steps that the caller limits need no high order: three stages instead of five. But from
        # those three nobody can tell the error of the tension of a line that is too stiff for them:
        # of one that is followed as it rings they can, and order 3 damps what is quicker.
        if head.rings != 0:
            high = dt == natural or not may_miss_rings(I, M, dt, 0)
        else:
            high = dt > 0.25 * natural or head.settled != 0
        scheme = highest if high else 0
        before = head.iterations
        to_output = landing and stop == t_end
        if dt < 0.2 * state.last_step:
            # Velocities do not meet what a jolt asks for: they run into it, and make its wave.
            if state.time != jolted:
                make_consistent(I, M, False)
        elif (head.live != 0 or head.current_kind != 0 or head.parts != 0) and follows_a_blow(
            I, M, dt
        ):
            begin_after_a_blow(I, M, state.last_step)
        elif unprojected:
            project_velocity(I, M, GAMMA[scheme] * dt)
        if head.current_kind != 0 and begins_a_surge(I, M, dt):
            begin_after_a_blow(I, M, SHORT * SHORT * dt)
        unprojected = False
        status = OK
        error = 0.0
        along = PASSES_OVER
        two_steps = to_output and dt <= 0.25 * natural and may_miss_rings(I, M, dt, -1)
        two_steps = two_steps and try_two_step(I, M, dt)
        if two_steps:
            of_tension, along = two_step_error(I, M, dt)
            two_steps = of_tension <= 1.0
        if not two_steps:
            give_back_forces(I, M)
            status, error, along = try_step(I, M, dt, scheme, to_output)
            if (
                status == OK
                and head.floor_state != FLOOR_FAR
                and refused < MOST_REFUSALS
                and dt > FOLDS_ITSELF * state.period
                and folds(I, M)
            ):
                # Where the mesh follows folds; a whip on a coarse one may end so for a while.
                refused += 1
                status = NOT_CONVERGED
        if status == LANDED or (
            head.floor_kind != FLOOR_NONE
            and head.floor_state != FLOOR_TOUCHED
            and status == OK
            and error <= 1.0
            and lands(I, M)
        ):
            head.rejected += 1
            continue
        if head.left_out != 0 and status == OK and error <= 1.0:
            disturbed = disturbance(I, M)
            if disturbed != 0:
                head.rejected += 1
                wake(I, M, disturbed == 2)
                status = change_mesh(I, M, False)
                if status != OK:
                    break
                continue
        if status == OK and error <= 1.0:
            gamma_dt = two_step_gamma(M, dt) if two_steps else GAMMA[scheme] * dt
            if grows_unseen(I, M, gamma_dt):
                along = PASSES_OVER
                error = UNSTABLE
                state.bent_after = state.time  # it bends where the mesh lets it
        if head.cut_count != 0 and status == OK and error <= 1.0:
            share = share_before_a_break(I, M)
            if share < 1.0 and share * dt > let_go_step(M):
                head.rejected += 1
                state.step = share * dt
                continue
        if status != OK or not error <= 1.0:
            if not shorten(I, M, dt, scheme, status, error):
                status = NOT_CONVERGED
                break
            if along == MISSES and status == OK:
                # A shorter one than where tensions are not looked at is none the better for them.
                state.step = max(state.step, min(0.9 * dt, LONGEST * longest_unwatched(M)))
            status = OK
        else:
            follow_rings(I, M, dt, -1 if two_steps else scheme)
            follow_slack(I, M, dt)
            if two_steps:
                accept_two_step(I, M, dt)
            else:
                accept_trial(I, M, dt, scheme)
            keep_forces(I, M)
            if along == SOLVED:
                take_solved(I, M)
            elif along == FOLLOWS:
                head.settled = 0
            if head.parts != 0:
                remember_tensions(I, M)
                count = 6 * head.nodes
                count_turns_anew(
                    I,
                    M,
                    view(M, head.position, count),
                    view(M, head.velocity, count),
                    view(M, head.acceleration, count),
                )
            make_crooked(I, M)
            if arch_stands(I, M):
                leave_plane(I, M)
            fall_over(I, M)
            if head.payout != 0:
                pay_out(I, M, dt)
            if landing:
                state.time = stop
                landed = True
            else:
                state.time += dt
            unprojected = scheme == 1
            refused = 0
            if head.floor_kind != FLOOR_NONE:
                state.floor_wait += dt
                if head.floor_state == FLOOR_TOUCHED:
                    settle(I, M)
                if head.floor_state != FLOOR_FAR:
                    leave_floor(I, M)
                follow_pressure(I, M)
            if head.hybrid == 1:
                update_bending(I, M)
            if head.rigid > 0 or head.payout != 0 or head.closure_count != 0:
                if head.payout != 0:
                    follow_layer(I, M, dt)
                update_springs(I, M, dt / (dt + state.period))
            follow_third_mode(I, M, dt / (dt + state.period))
            if head.live == 0:
                head.piece = find_piece(I, M, state.time)
            head.steps += 1
            adapt_step(I, M, dt, scheme, error)
            if head.floor_state == FLOOR_TOUCHED and not two_steps:
                follow_iterations(M, dt, (head.iterations - before) / (STAGES[scheme] - 1))
            if not two_steps:
                choose_order(I, M, scheme, head.iterations - before, to_output)
            if head.cut_count != 0:
                status = make_cuts(I, M)
                if status != OK:
                    break
        taken += 1
        if taken > head.maximum_steps:
            status = TOO_MANY_STEPS
            break
        if taken % STALL[0] == 0:
            if state.time - mark < STALL[0] * STALL[1] * state.period:
                status = STALLED
                break
            mark = state.time
    if status == OK and not two_steps:
        node = overstretched(I, M)
        if node != 0:
            I[head.failed] = node
            status = OVERSTRETCHED
    return status
