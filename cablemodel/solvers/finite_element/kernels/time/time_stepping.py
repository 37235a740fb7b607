"""Adaptive time integration to a given time.

`advance_to` is the whole of it: what is due before a step, its plan, an attempt. That says what
happened; `take` follows where a step was made, else `try_again`, by what stood in its way.
"""

import math

from cablemodel.solvers.finite_element.kernels.bodies.clamp_layer import follow_layer
from cablemodel.solvers.finite_element.kernels.bodies.free_bodies import count_turns_anew
from cablemodel.solvers.finite_element.kernels.bodies.vessel_clamp import update_springs
from cablemodel.solvers.finite_element.kernels.element.limp import follow_limp
from cablemodel.solvers.finite_element.kernels.element.stabilisation import follow_third_mode
from cablemodel.solvers.finite_element.kernels.element.strain import largest_mean, overstretched
from cablemodel.solvers.finite_element.kernels.element.tables import GAMMA, STAGES
from cablemodel.solvers.finite_element.kernels.floor.floor_memory import settle
from cablemodel.solvers.finite_element.kernels.floor.floor_state import lands, leave_floor, rubs
from cablemodel.solvers.finite_element.kernels.line.closures import give_back_forces, keep_forces
from cablemodel.solvers.finite_element.kernels.line.inertia import is_held
from cablemodel.solvers.finite_element.kernels.line.newton import is_folded, refactor
from cablemodel.solvers.finite_element.kernels.mesh.bending_mesh import follow_bending
from cablemodel.solvers.finite_element.kernels.mesh.cuts import (
    let_go_step,
    make_cuts,
    share_before_a_break,
)
from cablemodel.solvers.finite_element.kernels.mesh.payout import pay_out
from cablemodel.solvers.finite_element.kernels.mesh.sleep import (
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
from cablemodel.solvers.finite_element.kernels.mesh.top_element import adapt_tops, anything_passes
from cablemodel.solvers.finite_element.kernels.mesh.touchdown_mesh import follow_floor
from cablemodel.solvers.finite_element.kernels.mesh.winch import (
    begin_payout,
    longest_payout_step,
    slope_jump,
)
from cablemodel.solvers.finite_element.kernels.time.buckling import (
    any_pressed,
    arch_stands,
    fall_over,
    make_crooked,
)
from cablemodel.solvers.finite_element.kernels.time.consistency import (
    AFTER_A_VELOCITY_JUMP,
    begin_after_a_velocity_jump,
    begins_a_surge,
    follows_a_velocity_jump,
    make_consistent,
    project_velocity,
    take_rates_from_velocity,
)
from cablemodel.solvers.finite_element.kernels.time.esdirk import (
    AT_FLOOR_FORCES,
    accept_trial,
    try_step,
)
from cablemodel.solvers.finite_element.kernels.time.promote import promote
from cablemodel.solvers.finite_element.kernels.time.ring_mesh import follow_with_mesh
from cablemodel.solvers.finite_element.kernels.time.rings import (
    begin_rings,
    follow_rings,
    largest_jump,
    longest_ring_step,
    may_miss_rings,
)
from cablemodel.solvers.finite_element.kernels.time.slack import follow_slack
from cablemodel.solvers.finite_element.kernels.time.solved_tension import SHORT, take_solved
from cablemodel.solvers.finite_element.kernels.time.step_size import (
    REFUSED,
    adapt_step,
    choose_order,
    follow_iterations,
    natural_step,
    next_stop,
    prefer_order_3,
    shorten,
)
from cablemodel.solvers.finite_element.kernels.time.tension import (
    FOLLOWS,
    MISSES,
    PASSES_OVER,
    SOLVED,
    longest_unwatched,
    two_step_error,
)
from cablemodel.solvers.finite_element.kernels.time.two_step import (
    accept_two_step,
    try_two_step,
    two_step_gamma,
)
from cablemodel.solvers.finite_element.kernels.time.watched_tension import remember_tensions
from cablemodel.solvers.finite_element.kernels.time.waves import end_waves
from cablemodel.solvers.shared.access import (
    edge_of,
    header,
    scalars,
    tension_of,
)
from cablemodel.solvers.shared.compile import inlined, kernel, outlined, own_record, view
from cablemodel.solvers.shared.environment import find_piece
from cablemodel.solvers.shared.layout import (
    FLOOR_FAR,
    FLOOR_NONE,
    FLOOR_TOUCHED,
    JOINT_BODY,
    JOINT_NONE,
    MODEL_HYBRID,
    NO_CAPACITY,
    NOT_CONVERGED,
    NOTHING,
    OK,
    OVERSTRETCHED,
    STALLED,
    TOO_MANY_STEPS,
)
from cablemodel.solvers.shared.record import Record, integer, real

STALL = 5000, 1e-5  # internal steps in a row, and their mean length in sqrt(L/g), that end a call
MOST_REFUSALS = 4  # of a step that ends folded
UNSTABLE = 30.0  # error of a step that is too long for what grows: the next has 0.4 of it
LONGEST = 0.999  # of the longest step whose tensions are not looked at: one that is so short
FOLDS_ITSELF = 1e-4  # sqrt(L/g): steps so short follow the motion into a fold, none is refused
JUMP_RUBS = 0.1  # of a bristle: motion by a jump of acceleration in a step that is seen in friction
BENDING_ON, BENDING_OFF = 0.01, 0.005  # hybrid: (EI/T)/h^2 above which bending is kept
BENDING_SEEN = 1e-5  # tau below which what leaving it out misplaces, EI/T times r'', would be seen

MADE = 0  # what happened in an attempt: the trial is the next state
TOO_LONG = 1  # its error is too large, Newton's method failed, or something grows unseen
REACHES_FLOOR = 2  # the line comes to the floor, whose forces were left out
STIRS = 3  # what was left out, asleep, feels it
BREAKS = 4  # a link breaks within it
AFTER_A_JUMP = 10.0  # of the smallest step: the least one over which a velocity jumps
TAKES_ALL = 0.999  # of what is left to a stop: a step so long goes there
LIMITED = 0.25  # of what the line allows: steps that the caller makes shorter need no high order
MUCH_SHORTER = 0.2  # of the last step: one that feels what that has smeared


class Plan(Record):
    """The next step on the way to the end of a call, and what came of it."""

    end = real("of the call", "s")
    dt = real("length of the step", "s")
    natural = real("the step that nothing but the line itself limits", "s")
    scheme = integer("row of the tables of ESDIRK: 0 of order 3, 1 of order 4")
    lands = integer("1: it ends at a stop")
    stop = real("the time to land on", "s")
    to_output = integer("1: it ends the call")
    after_a_stop = integer("1: what drives the line may have a breakpoint where it begins")
    began = integer("1: rings may have begun with it, and their mesh is not looked at yet")
    unprojected = integer("1: a step of order 4 came before, which leaves velocities as they are")
    last_jump = real("when a velocity last jumped", "s")
    iterations = integer("Newton's, before it")
    status = integer("of the attempt")
    error = real("of the attempt: local error over what is allowed")
    along = integer("what the step does along the line (tension_error)")
    anew = integer("1: it begins with accelerations of its own, where cable rubs")
    two_steps = integer("1: made by the two-step scheme")
    folded = integer("attempts in a row that ended folded")
    stirred = integer("which disturbance wakes what sleeps")
    share = real("of the step, after which a link breaks")


new_plan = own_record(Plan)


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
    head.chosen = 0
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
    if head.rings + head.axial_waves != 0 and follow_with_mesh(I, M, True) == NO_CAPACITY:
        return NO_CAPACITY
    found = NOTHING
    if head.floor_state != FLOOR_FAR:
        found = follow_floor(I, M, True, first)
    elif state.bent > 0.0:
        found = follow_bending(I, M, True)
    if found == NO_CAPACITY:
        return NO_CAPACITY
    if rests:
        fall_asleep(I, M, first)  # what was joined is made consistent when it wakes
    make_consistent(I, M, True, 0)
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
        geometric = h * h * (tension_of(I, M, node).mean - abs(tension_of(I, M, node).slope))
        if e.bending == 0.0:
            if stiffness > BENDING_ON * fine * geometric:
                e.bending = stiffness
                switched = True
        elif stiffness < BENDING_OFF * fine * geometric:
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
def change_what_is_due(I, M):
    """Before a step the mesh changes, where it is due: what is read after the step is then a state
    that a step has made."""
    head = header(I)
    state = scalars(M)
    rests = head.sleep != 0 and state.time >= state.sleep_after and may_sleep(I, M)
    if (
        rests
        or (head.payout != 0 and anything_passes(I, M))
        or (head.floor_state != FLOOR_FAR and follow_floor(I, M, False, 0) != NOTHING)
        or (mesh_is_due(I, M) and follow_bending(I, M, False) != NOTHING)
        or (head.rings + head.axial_waves != 0 and follow_with_mesh(I, M, False) != NOTHING)
    ):
        return change_mesh(I, M, rests)
    return OK


@kernel
def plan_step(I, M, plan):
    """Where the next step ends, how long it is, and of which order."""
    head = header(I)
    state = scalars(M)
    natural = natural_step(I, M)
    stop = next_stop(I, M, plan.end, natural)
    jump = 0.0
    acceleration_jump = 0.0
    if head.payout != 0:
        stop, jump = begin_payout(I, M, stop)
        acceleration_jump = slope_jump(I, M)
        if acceleration_jump != 0.0:
            head.settled = 0
        natural = longest_payout_step(I, M, natural)
    plan.began = 0
    if plan.after_a_stop != 0 or acceleration_jump != 0.0:
        begin_rings(I, M, natural)
        plan.began = 1 if acceleration_jump == 0.0 else 0
        plan.after_a_stop = 0
    if jump * natural > state.time_tolerance:
        natural = max(state.time_tolerance / jump, AFTER_A_JUMP * state.smallest_step)
        state.step = natural
        plan.last_jump = state.time
    remaining = stop - state.time
    # Friction that slips turns suddenly: across it the stages of order 4 make rings.
    highest = 1 if head.order == 4 and state.order_3 == 0.0 and not rubs(I, M) else 0
    dt = longest_ring_step(I, M, natural, highest)
    plan.lands = 0
    if dt >= remaining * TAKES_ALL:
        dt = remaining
        plan.lands = 1
    elif dt > 0.5 * remaining:
        dt = 0.5 * remaining
    # Steps that the caller limits need no high order: three stages instead of five. But from
    # those three nobody can tell the error of the tension of a line that is too stiff for them:
    # of one that is followed as it rings they can, and order 3 damps what is quicker.
    if head.rings + head.axial_waves != 0:
        high = dt == natural or not may_miss_rings(I, M, dt, 0)
    else:
        high = dt > LIMITED * natural or head.settled != 0
    plan.scheme = highest if high else 0
    plan.to_output = 1 if plan.lands != 0 and stop == plan.end else 0
    plan.stop = stop
    plan.natural = natural
    plan.dt = dt


@outlined
def begins_rubbing(I, M, dt):
    """Whether accelerations of the last step are none to begin with where cable rubs: one of an end
    jumps, or the last step was so much shorter that it resolved bristles."""
    if not rubs(I, M):
        return False
    last = scalars(M).last_step
    if last > 0.0 and dt > AFTER_A_VELOCITY_JUMP * last:
        return True
    return largest_jump(I, M) * dt * dt > JUMP_RUBS * scalars(M).bristle


@kernel
def make_ready(I, M, plan):
    """What the state has to meet before a step of another kind than the last one."""
    head = header(I)
    state = scalars(M)
    dt = plan.dt
    plan.anew = 0
    follow_limp(I, M)
    if dt < MUCH_SHORTER * state.last_step:
        # Velocities do not meet what a jump of one asks for: they run into it, and make its wave.
        if state.time != plan.last_jump:
            make_consistent(I, M, False, plan.unprojected)
    elif follows_a_velocity_jump(I, M, dt):
        begin_after_a_velocity_jump(I, M, state.last_step)
    elif head.floor_state == FLOOR_TOUCHED and begins_rubbing(I, M, dt):
        plan.anew = 1
    elif plan.unprojected != 0:
        project_velocity(I, M, GAMMA[plan.scheme] * dt)
    if head.current_kind != 0 and begins_a_surge(I, M, dt):
        begin_after_a_velocity_jump(I, M, SHORT * SHORT * dt)
    plan.unprojected = 0


@kernel
def attempt(I, M, plan):
    """Try the planned step: MADE, or what happened instead."""
    head = header(I)
    state = scalars(M)
    dt = plan.dt
    plan.iterations = head.iterations
    make_ready(I, M, plan)
    plan.status = OK
    plan.error = 0.0
    plan.along = PASSES_OVER
    plan.two_steps = 0
    if (
        plan.to_output != 0
        and plan.anew == 0
        and dt <= LIMITED * plan.natural
        and may_miss_rings(I, M, dt, -1)
        and try_two_step(I, M, dt)
    ):
        of_tension, plan.along = two_step_error(I, M, dt)
        plan.two_steps = 1 if of_tension <= 1.0 else 0
    if plan.two_steps == 0:
        give_back_forces(I, M)
        plan.status, plan.error, plan.along = try_step(
            I, M, dt, plan.scheme, plan.to_output != 0, plan.anew != 0
        )
        if (
            plan.status == OK
            and head.floor_state != FLOOR_FAR
            and plan.folded < MOST_REFUSALS
            and dt > FOLDS_ITSELF * state.period
            and folds(I, M)
        ):
            # Where the mesh follows folds; a whip on a coarse one may end so for a while.
            plan.folded += 1
            plan.status = NOT_CONVERGED
    if plan.status == AT_FLOOR_FORCES:
        return REACHES_FLOOR
    if plan.status != OK or not plan.error <= 1.0:
        return TOO_LONG
    if head.floor_kind != FLOOR_NONE and head.floor_state != FLOOR_TOUCHED and lands(I, M):
        return REACHES_FLOOR
    if head.left_out != 0:
        plan.stirred = disturbance(I, M)
        if plan.stirred != 0:
            return STIRS
    if grows_unseen(I, M, two_step_gamma(M, dt) if plan.two_steps else GAMMA[plan.scheme] * dt):
        plan.along = PASSES_OVER
        plan.error = UNSTABLE
        state.bent_after = state.time  # it bends where the mesh lets it
        return TOO_LONG
    if head.cut_count != 0:
        plan.share = share_before_a_break(I, M)
        if plan.share < 1.0 and plan.share * dt > let_go_step(M):
            return BREAKS
    return MADE


@kernel
def try_again(I, M, plan, happened):
    """What lets the next attempt do what this one did not; a status."""
    head = header(I)
    state = scalars(M)
    if happened == TOO_LONG:
        if not shorten(I, M, plan.dt, plan.scheme, plan.status, plan.error):
            return NOT_CONVERGED
        if plan.along == MISSES and plan.status == OK:
            # A shorter one than where tensions are not looked at is none the better for them.
            least = min(REFUSED * plan.dt, LONGEST * longest_unwatched(M))
            state.step = max(state.step, least)
        return OK
    head.rejected += 1
    if happened == STIRS:
        wake(I, M, plan.stirred == 2)
        return change_mesh(I, M, False)
    if happened == REACHES_FLOOR and head.floor_state == FLOOR_TOUCHED:
        head.chosen = 0  # what folded as it hung freely may not any longer
        if head.axial_waves != 0:
            end_waves(I, M)
    if happened == BREAKS:
        state.step = plan.share * plan.dt
    return OK


@kernel
def take(I, M, plan):
    """The trial becomes the state, and what goes with a state follows; a status."""
    head = header(I)
    state = scalars(M)
    dt = plan.dt
    scheme = plan.scheme
    two_steps = plan.two_steps != 0
    follow_rings(I, M, dt, -1 if two_steps else scheme)
    follow_slack(I, M, dt)
    if two_steps:
        accept_two_step(I, M, dt)
    else:
        accept_trial(I, M, dt, scheme)
    keep_forces(I, M)
    if plan.along == SOLVED:
        take_solved(I, M)
    elif plan.along == FOLLOWS:
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
    if plan.lands != 0:
        state.time = plan.stop
        plan.after_a_stop = 1
    else:
        state.time += dt
    plan.unprojected = 1 if scheme == 1 else 0
    plan.folded = 0
    if head.floor_kind != FLOOR_NONE:
        state.floor_wait += dt
        if head.floor_state == FLOOR_TOUCHED:
            settle(I, M)
        if head.floor_state != FLOOR_FAR:
            leave_floor(I, M)
    if head.hybrid == 1:
        update_bending(I, M)
    if head.rigid > 0 or head.payout != 0 or head.closure_count != 0:
        if head.payout != 0:
            follow_layer(I, M, dt)
        update_springs(I, M, dt / (dt + state.period))
    follow_third_mode(I, M, dt)
    if head.live == 0:
        head.piece = find_piece(I, M, state.time)
    head.steps += 1
    iterations = head.iterations - plan.iterations
    adapt_step(I, M, dt, scheme, plan.error)
    if not two_steps:
        if head.floor_state == FLOOR_TOUCHED:
            follow_iterations(I, M, dt, iterations / (STAGES[scheme] - 1))
        choose_order(I, M, scheme, iterations, plan.to_output != 0)
    # An output at the time of a cut is of the state before it: its wave has not run yet.
    if head.cut_count != 0 and state.time < plan.end:
        return make_cuts(I, M)
    return OK


@kernel
def quickest_period(I, M):
    """sqrt(L/g) of the shortest line of a system, or piece that is cut off [s]: it moves as
    quickly as it would alone, however long the others are."""
    head = header(I)
    state = scalars(M)
    shortest = state.length
    if head.parts == 0:
        return state.period
    length = 0.0
    for node in range(1, head.nodes):
        if I[head.joint + node] == JOINT_NONE:
            length += edge_of(I, M, node).length
        last = node + 1 == head.nodes or I[head.joint + node + 1] > JOINT_BODY
        if length > 0.0 and (last or I[head.parent + node + 1] != node):
            shortest = min(shortest, length)
            length = 0.0
    return state.period * math.sqrt(shortest / state.length)


@kernel
def advance_to(I, M, t_end):
    """Integrate to t_end exactly; on failure the status says why and the state is of no use."""
    head = header(I)
    state = scalars(M)
    plan = new_plan()
    plan.end = t_end
    plan.after_a_stop = 1
    plan.last_jump = -1e300
    status = make_cuts(I, M) if head.cut_count != 0 else OK
    keep_forces(I, M)
    if head.steps == 0 and head.parts == 0:  # steps of a system remember their lines'
        tension = view(M, head.tension, 2 * head.nodes)
        state.largest_tension = max(state.largest_tension, largest_mean(tension, head.nodes))
    taken = 0
    mark = state.time
    while status == OK and state.time < t_end:
        give_back_forces(I, M)
        status = change_what_is_due(I, M)
        if status != OK:
            break
        plan_step(I, M, plan)
        if plan.began != 0 and head.rings != 0 and follow_with_mesh(I, M, False) != NOTHING:
            continue  # what the tension jumps by is right on elements that are short enough
        happened = attempt(I, M, plan)
        if happened == MADE:
            status = take(I, M, plan)
        else:
            status = try_again(I, M, plan, happened)
        taken += 1
        if status == OK and taken > head.maximum_steps:
            status = TOO_MANY_STEPS
        if status == OK and taken % STALL[0] == 0:
            if state.time - mark < STALL[0] * STALL[1] * quickest_period(I, M):
                status = STALLED
            mark = state.time
    if status == OK and plan.two_steps == 0:
        node = overstretched(I, M)
        if node != 0:
            I[head.failed] = node
            return OVERSTRETCHED
    return status
