"""Positions, velocities and tensions of a state that fit to each other, between steps.

A step leaves |r'| = 1 + strain(T) and its rate met to its tolerance; a short step, an undamped
motion or another mesh asks for more.
"""

import math
from typing import Any

from cablemodel.solvers.finite_element.kernels.bodies.frames import (
    frame_breaks,
    frames_jump,
    move_frames,
    move_frames_on,
    point_motion,
)
from cablemodel.solvers.finite_element.kernels.element.tables import GAMMA, STAGES
from cablemodel.solvers.finite_element.kernels.line.closures import follow_forces, scale_gaps
from cablemodel.solvers.finite_element.kernels.line.newton import refactor
from cablemodel.solvers.finite_element.kernels.line.system import (
    constraints,
    elongation_rate,
    find_gradients,
    impose_motion,
    newton_increment,
    recover_tension,
    remembers,
    residual,
    set_time,
    stretch_rate,
)
from cablemodel.solvers.finite_element.kernels.mesh.winch import slope_jump
from cablemodel.solvers.shared.access import (
    constraint_of,
    frame_of,
    header,
    new_motion,
    scalars,
    spare_row,
)
from cablemodel.solvers.shared.compile import copy_words, kernel, view
from cablemodel.solvers.shared.environment import (
    current_rate,
    find_piece,
    prescribed_motion,
    surge_jump,
    vessel_motion,
)
from cablemodel.solvers.shared.layout import FLOOR_TOUCHED, HELD_BY_FRAME, ConsistentRows

ROW_PLACES_BEFORE = ConsistentRows.places.word
ROW_VELOCITIES_BEFORE = ConsistentRows.velocities.word
ROW_ACCELERATIONS_BEFORE = ConsistentRows.accelerations.word
ROW_TENSIONS_BEFORE, ROW_RATES_BEFORE = ConsistentRows.tensions.word, ConsistentRows.rates.word

MOST_NORMS = 5  # in which a state is brought to its constraints, each of a tenth of the last step
NEGLIGIBLE = 1e-9  # of the length: what may be left of a constraint
AXIAL_SLOW = 2.5  # gamma dt over the time that an axial wave takes along a joined element
AFTER_A_VELOCITY_JUMP = 4.0  # last steps: so much longer ones begin without its acceleration
SEEN = 0.1  # of the local error: what that acceleration would move the line by
JERK = 1e-3  # of sqrt(L/g): over which a jerk is a difference of accelerations
AXIAL_RESOLVED = 5.0  # (axial frequency x gamma dt)^2 below which velocities are not projected
LEAST_PROJECTED = 0.25  # share of that, below which a step of order 4 would feed the line's ring
MATRIX_SHORTER = 0.1  # of a step whose matrix has no sign under pressure: the next one tried
BEFORE_A_BREAK = 1.1  # in JERK: so long before a break of a motion its jerk is that before it
PLACES_PROJECTED = 3  # times that places are projected on to the constraint
CHANGED_PROJECTED = 4  # the same after a change of the mesh


@kernel
def refactor_state(I, M, gamma_dt):
    """Factor the Newton matrix of a step at the state itself; 0 on success."""
    head = header(I)
    state = scalars(M)
    count = 2 * head.dimension * head.nodes
    q = view(M, head.position, count)
    v = view(M, head.velocity, count)
    a = view(M, head.acceleration, count)
    set_time(I, M, state.time)
    return refactor(I, M, q, v, a, view(M, head.tension, 2 * head.nodes), gamma_dt)


def of_state(find: Any) -> Any:
    """`find`, which is `residual` or `constraints`, of the state."""

    @kernel
    def find_of_state(I, M):
        head = header(I)
        count = 2 * head.dimension * head.nodes
        words = 2 * head.nodes
        find(
            I,
            M,
            view(M, head.position, count),
            view(M, head.velocity, count),
            view(M, head.acceleration, count),
            view(M, head.tension, words),
            view(M, head.residual, count),
            view(M, head.constraint_residual, words),
        )

    return find_of_state


state_residual = of_state(residual)
"""state_residual(I, M): forces, and what is left of the constraint."""
state_constraints = of_state(constraints)
"""state_constraints(I, M): what is left of the constraint alone."""


@kernel
def project_position(I, M):
    """Remove what is left of the constraint from the positions; the increment remains."""
    head = header(I)
    count = 2 * head.dimension * head.nodes
    forces = view(M, head.residual, count)
    constraint = view(M, head.constraint_residual, 2 * head.nodes)
    x = view(M, head.increment, count)
    position = view(M, head.position, count)
    forces[:] = 0.0
    newton_increment(I, M, forces, constraint, x)
    for n in range(count):
        position[n] += x[n]


@kernel
def state_elongation_rate(I, M):
    """Rate of the constraint's residual at the state, with the rates of the tensions."""
    head = header(I)
    words = 2 * head.nodes
    v = view(M, head.velocity, 2 * head.dimension * head.nodes)
    rate = view(M, head.tension_rate, words)
    elongation_rate(I, M, v, rate, view(M, head.constraint_residual, words))


@kernel
def follow_increment(I, M, array):
    """Let tensions, or their rates, by their word, follow the last increment."""
    head = header(I)
    words = 2 * head.nodes
    constraint = view(M, head.constraint_residual, words)
    x = view(M, head.increment, 2 * head.dimension * head.nodes)
    recover_tension(I, M, constraint, x, view(M, array, words), False)


@kernel
def project_on_to_rates(I, M, passes, share, follow):
    """Remove from the velocity a share of what stretches the line at another rate than its tensions
    change; follow: their rates become those of the velocity.

    Those rates are differences: of a ring that turns by w dt = 3 in a step they are wrong by all
    of it, and would feed it. One pass takes x^2 / (1 + x^2) of what stretches with x = w gamma dt,
    by the matrix; the next takes that part of the part. With a pass for each stage of order 4 no
    ring grows, whatever it turns by, and what is too stiff to be followed is taken as before.
    """
    head = header(I)
    count = 2 * head.dimension * head.nodes
    words = 2 * head.nodes
    forces = view(M, head.residual, count)
    constraint = view(M, head.constraint_residual, words)
    x = view(M, head.increment, count)
    velocity = view(M, head.velocity, count)
    state_elongation_rate(I, M)
    for again in range(passes):
        if again > 0:
            stretch_rate(I, M, x, constraint)
            scale_gaps(I, M, -1.0)
            for n in range(words):
                constraint[n] = -constraint[n]
        forces[:] = 0.0
        newton_increment(I, M, forces, constraint, x)
    if follow:
        if passes > 1:
            state_elongation_rate(I, M)
        follow_increment(I, M, head.tension_rate)
    for n in range(count):
        velocity[n] += share * x[n]


@kernel
def project_velocity(I, M, gamma_dt):
    """Remove from the velocity what stretches a line too stiff to be stretched.

    A step meets |r'| = 1 + strain(T) in the positions; velocities are left with an error along
    the constraint (index 3: order 2) that is always of one sign where the cable swings, and feeds
    energy into a nearly inextensible whip. It is projected out in the norm of the coming step's
    matrix, which that step then starts with. Where the line is soft enough for its axial motion
    to be resolved, this would replace that motion by an estimate from the rate of T: the share of
    the correction fades with the line's axial frequency times the step.
    """
    head = header(I)
    state = scalars(M)
    if state.undamped == 0.0:
        return
    stiffness = state.axial * gamma_dt * gamma_dt
    share = stiffness / (stiffness + AXIAL_RESOLVED)
    if share < LEAST_PROJECTED or refactor_state(I, M, gamma_dt) != 0:
        return
    project_on_to_rates(I, M, 1, share, False)
    head.has_history = 0


@kernel
def constraint_size(I, M):
    """Largest of what is left of the constraint at the state; leaves it."""
    head = header(I)
    state_constraints(I, M)
    constraint = view(M, head.constraint_residual, 2 * head.nodes)
    largest = 0.0
    for n in range(2 * head.nodes):
        if not abs(constraint[n]) < 1e300:
            return 1e300
        largest = max(largest, abs(constraint[n]))
    return largest


@kernel
def meet_constraints(I, M, gamma_dt, changed, passes):
    """Bring positions and velocities to the constraint in the norm of a step; False: it failed."""
    head = header(I)
    state = scalars(M)
    if refactor_state(I, M, gamma_dt) != 0:
        return False
    before = constraint_size(I, M)
    for iteration in range(CHANGED_PROJECTED if changed else PLACES_PROJECTED):
        if iteration > 0:
            state_constraints(I, M)
        project_position(I, M)
        if not changed:
            follow_increment(I, M, head.tension)
            follow_forces(I, M)
    after = constraint_size(I, M)
    for iteration in range(2):
        if iteration > 0 and head.payout != 0:
            state_constraints(I, M)
        project_on_to_rates(I, M, passes, 1.0, not changed)
    return after <= before + NEGLIGIBLE * state.length


@kernel
def make_consistent(I, M, changed, scheme):
    """Remove what a step much shorter than the last one would answer with huge tensions.

    A step leaves the constraint |r'| = 1 + strain(T) and its time derivative met to Newton's and
    the integrator's tolerance. A following step of dt turns such an error of d (in r) or w (in v)
    into forces of m d / dt^2 and m w / dt. Both are projected out here in the norm of the last
    step's matrix: slow modes, which that step resolved, are left as they are.

    scheme: that of the last step.

    Where the mesh has changed the errors are those of joined elements: tensions and their rates
    are held, in the norm of a step that does not resolve these elements' axial motion.
    """
    head = header(I)
    state = scalars(M)
    if state.last_step == 0.0:
        return
    gamma_dt = GAMMA[scheme] * state.last_step
    passes = STAGES[1] if scheme == 1 else 1
    if changed:
        slow = AXIAL_SLOW * state.joined / (state.length * math.sqrt(state.axial))
        gamma_dt = max(slow, gamma_dt)
    count = 2 * head.dimension * head.nodes
    words = 2 * head.nodes
    places = spare_row(I, ROW_PLACES_BEFORE)
    velocities = spare_row(I, ROW_VELOCITIES_BEFORE)
    tensions = spare_row(I, ROW_TENSIONS_BEFORE)
    rates = spare_row(I, ROW_RATES_BEFORE)
    for _attempt in range(MOST_NORMS):
        copy_words(I, places, head.position, count)
        copy_words(I, velocities, head.velocity, count)
        copy_words(I, tensions, head.tension, words)
        copy_words(I, rates, head.tension_rate, words)
        if meet_constraints(I, M, gamma_dt, changed, passes):
            break
        # Under pressure a long step's matrix may have no sign: inertia has.
        copy_words(I, head.position, places, count)
        copy_words(I, head.velocity, velocities, count)
        copy_words(I, head.tension, tensions, words)
        copy_words(I, head.tension_rate, rates, words)
        state_residual(I, M)  # the next matrix takes the forces at arms from the last one
        gamma_dt *= MATRIX_SHORTER
    if head.floor_state == FLOOR_TOUCHED:
        # Friction does not feel what is no motion.
        for n in range(count):
            M[head.rest + n] += M[head.position + n] - M[places + n]
    head.factored = 0
    head.has_history = 0
    state.last_step = 0.0


@kernel
def take_rates_from_velocity(I, M):
    """Make the rates of the tensions those that the velocities give.

    From one step to the next they are differences, which a projection of velocities on to them
    would feed back: an axial motion that steps resolve would grow with every change of the mesh.
    """
    head = header(I)
    state = scalars(M)
    count = 2 * head.dimension * head.nodes
    if not remembers(I):
        set_time(I, M, state.time)
        q = view(M, head.position, count)
        find_gradients(I, M, q, view(M, head.tension, 2 * head.nodes))
    elif refactor_state(I, M, GAMMA[0] * state.last_step) != 0:
        return
    if head.payout != 0:
        state_constraints(I, M)
    state_elongation_rate(I, M)
    x = view(M, head.increment, count)
    x[:] = 0.0
    follow_increment(I, M, head.tension_rate)


@kernel
def vessel_jump(I, M):
    """By how much the tow point's acceleration is now another one than the state's [m/s2]."""
    head = header(I)
    state = scalars(M)
    if head.parts != 0:
        move_frames_on(I, M)
        return frames_jump(I, M)
    dimension = head.dimension
    motion = new_motion()
    row = constraint_of(I, M, 0)
    end_motion(I, M, row, state.time, motion)
    at = head.acceleration + 2 * dimension * int(row.node)
    changed = 0.0
    for i in range(dimension):
        changed += (motion.acceleration[i] - M[at + i]) ** 2
    return math.sqrt(changed)


@kernel
def end_motion(I, M, row, t, out):
    """Motion of an end that a vessel holds, at time t, by the pieces of motion that begin there:
    block's coordinates."""
    t += scalars(M).smallest_step
    if row.kind == HELD_BY_FRAME:
        move_frames(I, M, t)
        point_motion(M, row, frame_of(I, M, int(row.frame)), out)
    else:
        vessel_motion(I, M, t)
        prescribed_motion(I, M, row, t, out)


@kernel
def jump_along(I, M, row):
    """By how much velocity and acceleration of an end that a vessel holds are now others along its
    line than the state's [m/s, m/s2]."""
    dimension = header(I).dimension
    motion = new_motion()
    end_motion(I, M, row, scalars(M).time, motion)
    at = 2 * dimension * int(row.node)
    slope = view(M, header(I).position + at + dimension, dimension)
    velocity = view(M, header(I).velocity + at, dimension)
    acceleration = view(M, header(I).acceleration + at, dimension)
    faster = 0.0
    along = 0.0
    square = 0.0
    for i in range(dimension):
        faster += (motion.velocity[i] - velocity[i]) * slope[i]
        along += (motion.acceleration[i] - acceleration[i]) * slope[i]
        square += slope[i] * slope[i]
    if not square > 0.0:
        return 0.0, 0.0
    length = math.sqrt(square)
    return abs(faster) / length, abs(along) / length


@kernel
def jerk_along(I, M, row, t):
    """Jerk along its line of an end that a vessel holds, from time t on [m/s3]."""
    dimension = header(I).dimension
    motion = new_motion()
    at = header(I).position + 2 * dimension * int(row.node) + dimension
    slope = view(M, at, dimension)
    step = JERK * scalars(M).period
    changed = 0.0
    square = 0.0
    for n in range(2):
        end_motion(I, M, row, t + n * step, motion)
        for i in range(dimension):
            changed += (2 * n - 1) * motion.acceleration[i] * slope[i]
            square += slope[i] * slope[i]
    return changed / (step * math.sqrt(0.5 * square)) if square > 0.0 else 0.0


@kernel
def motion_breaks(I, M, row):
    """Whether another piece of motion of an end that a vessel holds begins now."""
    time = scalars(M).time
    after = time + scalars(M).smallest_step
    if time == 0.0:
        return True
    if row.kind == HELD_BY_FRAME:
        return frame_breaks(M, header(I), frame_of(I, M, int(row.frame)), time, after)
    return header(I).live == 0 and find_piece(I, M, time) != find_piece(I, M, after)


@kernel
def jerk_jump(I, M, row):
    """By how much the jerk along its line of an end that a vessel holds is now another [m/s3],
    where its motion breaks.

    What stands at the start has had none. A caller's motion is as smooth as the caller makes it.
    """
    time = scalars(M).time
    before = 0.0
    if time > 0.0:
        before = jerk_along(I, M, row, time - BEFORE_A_BREAK * JERK * scalars(M).period)
    return abs(jerk_along(I, M, row, time) - before)


@kernel
def follows_a_velocity_jump(I, M, dt):
    """Whether the acceleration of the vessel, of a winch or of the water was another one in the
    last step, one much shorter than dt.

    Who changes the vessel's speed within a microsecond gives the line 1e6 m/s^2, which is over when
    the next step begins with it: that moves the line by no more than a step may err, at tens of
    metres a second.
    """
    state = scalars(M)
    last = state.last_step
    if last == 0.0 or dt < AFTER_A_VELOCITY_JUMP * last:
        return False
    limit = SEEN * state.time_tolerance
    surge, _most = surge_jump(I, M, state.time)
    if surge * dt * dt > limit:
        return True
    if slope_jump(I, M) * dt * dt > limit:
        return True
    return vessel_jump(I, M) * dt * dt > limit


@kernel
def begins_a_surge(I, M, dt):
    """Whether the water's acceleration jumps as a step of dt begins, so that it is seen.

    The step's first stage, with the acceleration before it, has a fifth of what the water gives the
    line: missed once and for all, where in steps that are alike all is a little late.
    """
    state = scalars(M)
    surge, _most = surge_jump(I, M, state.time)
    return surge * dt * state.period > SEEN * state.time_tolerance


@kernel
def begin_after_a_velocity_jump(I, M, span):
    """Accelerations that go with those of the vessel and the water, at the tensions of the line.

    What they change moves the line's mass at once; tensions follow as waves run along it.
    The equations are linear; the matrix is that of a step of `span`, as short as the jump.
    """
    head = header(I)
    state = scalars(M)
    count = 2 * head.dimension * head.nodes
    gamma_dt = GAMMA[0] * span
    q = view(M, head.position, count)
    v = view(M, head.velocity, count)
    a = view(M, head.acceleration, count)
    before = spare_row(I, ROW_ACCELERATIONS_BEFORE)
    copy_words(I, before, head.acceleration, count)
    begins = state.time + state.smallest_step  # by the pieces of motion that begin there
    set_time(I, M, begins)
    impose_motion(I, M, begins, q, v, a)
    if refactor_state(I, M, gamma_dt) == 0:
        current_rate(I, M, state.time, True)
        state_residual(I, M)
        constraint = view(M, head.constraint_residual, 2 * head.nodes)
        constraint[:] = 0.0
        scale_gaps(I, M, 0.0)
        x = view(M, head.increment, count)
        newton_increment(I, M, view(M, head.residual, count), constraint, x)
        follow_forces(I, M)
        inverse = 1.0 / (gamma_dt * gamma_dt)
        for n in range(count):
            a[n] += inverse * x[n]
    else:
        copy_words(I, head.acceleration, before, count)
    head.factored = 0
    head.has_history = 0
