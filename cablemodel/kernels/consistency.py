"""Positions, velocities and tensions of a state that fit to each other, between steps.

A step leaves |r'| = 1 + strain(T) and its rate met to its tolerance; a short step, an undamped
motion or another mesh asks for more.
"""

import math

from .compile import copy_words, kernel, view
from .environment import current_rate, prescribed_motion, surge_jump, vessel_motion
from .frames import frames_jump, move_frames
from .layout import (
    C_NODE,
    I_DIMENSION,
    I_FACTORED,
    I_HISTORY,
    I_LIVE,
    I_NODES,
    I_PARTS,
    I_PAYOUT,
    O_ACCELERATION,
    O_BASE_Q,
    O_BASE_V,
    O_CONSTRAINT,
    O_CONSTRAINT_RESIDUAL,
    O_INCREMENT,
    O_MOTION,
    O_POSITION,
    O_RESIDUAL,
    O_STAGE_T,
    O_TENSION,
    O_TENSION_RATE,
    O_TRIAL_T,
    O_VELOCITY,
    S_AXIAL,
    S_JOINED,
    S_LAST_STEP,
    S_LENGTH,
    S_PERIOD,
    S_TIME,
    S_TIME_TOLERANCE,
    S_UNDAMPED,
)
from .newton import refactor
from .system import (
    elongation_rate,
    impose_motion,
    newton_increment,
    recover_tension,
    residual,
    set_time,
)
from .tables import GAMMA

MOST_NORMS = 5  # in which a state is brought to its constraints, each of a tenth of the last step
NEGLIGIBLE = 1e-9  # of the length: what may be left of a constraint
AXIAL_SLOW = 2.5  # gamma dt over the time that an axial wave takes along a joined element
AFTER_A_BLOW = 4.0  # last steps: a step so much longer does not begin with that one's acceleration
SEEN = 0.1  # of the local error: what that acceleration would move the line by
AXIAL_RESOLVED = 5.0  # (axial frequency x gamma dt)^2 below which velocities are not projected


@kernel
def refactor_state(I, M, gamma_dt):
    """Factor the Newton matrix of a step at the state itself; 0 on success."""
    count = 2 * I[I_DIMENSION] * I[I_NODES]
    q = view(M, I[O_POSITION], count)
    v = view(M, I[O_VELOCITY], count)
    a = view(M, I[O_ACCELERATION], count)
    set_time(I, M, M[S_TIME])
    return refactor(I, M, q, v, a, view(M, I[O_TENSION], 2 * I[I_NODES]), gamma_dt)


@kernel
def state_residual(I, M):
    """Residual of the state: forces, and what is left of the constraint."""
    count = 2 * I[I_DIMENSION] * I[I_NODES]
    words = 2 * I[I_NODES]
    residual(
        I,
        M,
        view(M, I[O_POSITION], count),
        view(M, I[O_VELOCITY], count),
        view(M, I[O_ACCELERATION], count),
        view(M, I[O_TENSION], words),
        view(M, I[O_RESIDUAL], count),
        view(M, I[O_CONSTRAINT_RESIDUAL], words),
    )


@kernel
def project(I, M, place, share):
    """Remove a share of what is left of the constraint from an array of the state."""
    count = 2 * I[I_DIMENSION] * I[I_NODES]
    forces = view(M, I[O_RESIDUAL], count)
    constraint = view(M, I[O_CONSTRAINT_RESIDUAL], 2 * I[I_NODES])
    x = view(M, I[O_INCREMENT], count)
    array = view(M, I[place], count)
    if share != 1.0:
        for n in range(2 * I[I_NODES]):
            constraint[n] *= share
    forces[:] = 0.0
    newton_increment(I, M, forces, constraint, x)
    for n in range(count):
        array[n] += x[n]


@kernel
def state_elongation_rate(I, M):
    """Rate of the constraint's residual at the state, with the rates of the tensions."""
    words = 2 * I[I_NODES]
    v = view(M, I[O_VELOCITY], 2 * I[I_DIMENSION] * I[I_NODES])
    rate = view(M, I[O_TENSION_RATE], words)
    elongation_rate(I, M, v, rate, view(M, I[O_CONSTRAINT_RESIDUAL], words))


@kernel
def follow_increment(I, M, place):
    """Let tensions, or their rates, by their header word, follow the last increment."""
    words = 2 * I[I_NODES]
    constraint = view(M, I[O_CONSTRAINT_RESIDUAL], words)
    x = view(M, I[O_INCREMENT], 2 * I[I_DIMENSION] * I[I_NODES])
    recover_tension(I, M, constraint, x, view(M, I[place], words))


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
    if M[S_UNDAMPED] == 0.0:
        return
    stiffness = M[S_AXIAL] * gamma_dt * gamma_dt
    share = stiffness / (stiffness + AXIAL_RESOLVED)
    if share < 0.1 or refactor_state(I, M, gamma_dt) != 0:
        return
    state_elongation_rate(I, M)
    project(I, M, O_VELOCITY, share)
    I[I_HISTORY] = 0


@kernel
def constraint_size(I, M):
    """Largest of what is left of the constraint at the state; leaves it and the forces."""
    state_residual(I, M)
    constraint = view(M, I[O_CONSTRAINT_RESIDUAL], 2 * I[I_NODES])
    largest = 0.0
    for n in range(2 * I[I_NODES]):
        if not abs(constraint[n]) < 1e300:
            return 1e300
        largest = max(largest, abs(constraint[n]))
    return largest


@kernel
def meet_constraints(I, M, gamma_dt, changed):
    """Bring positions and velocities to the constraint in the norm of a step; False: it failed."""
    if refactor_state(I, M, gamma_dt) != 0:
        return False
    before = constraint_size(I, M)
    for iteration in range(4 if changed else 3):
        if iteration > 0:
            state_residual(I, M)
        project(I, M, O_POSITION, 1.0)
        if not changed:
            follow_increment(I, M, O_TENSION)
    after = constraint_size(I, M)
    for _iteration in range(2):
        if I[I_PAYOUT] != 0:
            state_residual(I, M)
        state_elongation_rate(I, M)
        project(I, M, O_VELOCITY, 1.0)
        if not changed:
            follow_increment(I, M, O_TENSION_RATE)
    return after <= before + NEGLIGIBLE * M[S_LENGTH]


@kernel
def make_consistent(I, M, changed):
    """Remove what a step much shorter than the last one would answer with huge tensions.

    A step leaves the constraint |r'| = 1 + strain(T) and its time derivative met to Newton's and
    the integrator's tolerance. A following step of dt turns such an error of d (in r) or w (in v)
    into forces of m d / dt^2 and m w / dt. Both are projected out here in the norm of the last
    step's matrix: slow modes, which that step resolved, are left as they are.

    Where the mesh has changed the errors are those of joined elements: tensions and their rates
    are held, in the norm of a step that does not resolve these elements' axial motion.
    """
    if M[S_LAST_STEP] == 0.0:
        return
    gamma_dt = GAMMA[0] * M[S_LAST_STEP]
    if changed:
        slow = AXIAL_SLOW * M[S_JOINED] / (M[S_LENGTH] * math.sqrt(M[S_AXIAL]))
        gamma_dt = max(slow, gamma_dt)
    count = 2 * I[I_DIMENSION] * I[I_NODES]
    words = 2 * I[I_NODES]
    for _attempt in range(MOST_NORMS):
        copy_words(I, I[O_BASE_Q], I[O_POSITION], count)
        copy_words(I, I[O_BASE_V], I[O_VELOCITY], count)
        copy_words(I, I[O_TRIAL_T], I[O_TENSION], words)
        copy_words(I, I[O_STAGE_T], I[O_TENSION_RATE], words)
        if meet_constraints(I, M, gamma_dt, changed):
            break
        # Under pressure a long step's matrix may have no sign: inertia has.
        copy_words(I, I[O_POSITION], I[O_BASE_Q], count)
        copy_words(I, I[O_VELOCITY], I[O_BASE_V], count)
        copy_words(I, I[O_TENSION], I[O_TRIAL_T], words)
        copy_words(I, I[O_TENSION_RATE], I[O_STAGE_T], words)
        gamma_dt *= 0.1
    I[I_FACTORED] = 0
    I[I_HISTORY] = 0
    M[S_LAST_STEP] = 0.0


@kernel
def take_rates_from_velocity(I, M):
    """Make the rates of the tensions those that the velocities give.

    From one step to the next they are differences, which a projection of velocities on to them
    would feed back: an axial motion that steps resolve would grow with every change of the mesh.
    """
    if refactor_state(I, M, GAMMA[0] * M[S_LAST_STEP]) != 0:
        return
    if I[I_PAYOUT] != 0:
        state_residual(I, M)
    state_elongation_rate(I, M)
    x = view(M, I[O_INCREMENT], 2 * I[I_DIMENSION] * I[I_NODES])
    x[:] = 0.0
    follow_increment(I, M, O_TENSION_RATE)


@kernel
def vessel_jump(I, M):
    """By how much the tow point's acceleration is now another one than the state's [m/s2]."""
    if I[I_PARTS] != 0:
        move_frames(I, M, M[S_TIME])
        return frames_jump(I, M, view(M, I[O_MOTION] + 16, 18))
    dimension = I[I_DIMENSION]
    vessel_motion(I, M, M[S_TIME])
    out = view(M, I[O_MOTION] + 16, 9)
    row = I[O_CONSTRAINT]
    prescribed_motion(I, M, row, M[S_TIME], out)
    at = I[O_ACCELERATION] + 2 * dimension * int(M[row + C_NODE])
    changed = 0.0
    for i in range(dimension):
        changed += (out[2 * dimension + i] - M[at + i]) ** 2
    return math.sqrt(changed)


@kernel
def follows_a_blow(I, M, dt):
    """Whether the vessel's acceleration, by the caller, or that of the water was another one in the
    last step, one much shorter than dt.

    A caller who changes the vessel's speed within a microsecond gives the line 1e6 m/s^2, which is
    over when the next step begins with it: that moves the line by no more than a step may err, at
    tens of metres a second.
    """
    last = M[S_LAST_STEP]
    if last == 0.0 or dt < AFTER_A_BLOW * last:
        return False
    limit = SEEN * M[S_TIME_TOLERANCE]
    surge, _most = surge_jump(I, M, M[S_TIME])
    if surge * dt * dt > limit:
        return True
    if I[I_LIVE] == 0 and I[I_PARTS] == 0:
        return False
    return vessel_jump(I, M) * dt * dt > limit


@kernel
def begins_a_surge(I, M, dt):
    """Whether the water's acceleration jumps as a step of dt begins, so that it is seen.

    The step's first stage, with the acceleration before it, has a fifth of what the water gives the
    line: missed once and for all, where in steps that are alike all is a little late.
    """
    surge, _most = surge_jump(I, M, M[S_TIME])
    return surge * dt * M[S_PERIOD] > SEEN * M[S_TIME_TOLERANCE]


@kernel
def begin_after_a_blow(I, M, span):
    """Accelerations that go with those of the vessel and the water, at the tensions of the line.

    What they change moves the line's mass at once; tensions follow as waves run along it.
    The equations are linear; the matrix is that of a step of `span`, as short as the blow.
    """
    count = 2 * I[I_DIMENSION] * I[I_NODES]
    gamma_dt = GAMMA[0] * span
    q = view(M, I[O_POSITION], count)
    v = view(M, I[O_VELOCITY], count)
    a = view(M, I[O_ACCELERATION], count)
    copy_words(I, I[O_BASE_V], I[O_ACCELERATION], count)
    set_time(I, M, M[S_TIME])
    impose_motion(I, M, M[S_TIME], q, v, a)
    if refactor_state(I, M, gamma_dt) == 0:
        current_rate(I, M, M[S_TIME], True)
        state_residual(I, M)
        constraint = view(M, I[O_CONSTRAINT_RESIDUAL], 2 * I[I_NODES])
        constraint[:] = 0.0
        x = view(M, I[O_INCREMENT], count)
        newton_increment(I, M, view(M, I[O_RESIDUAL], count), constraint, x)
        inverse = 1.0 / (gamma_dt * gamma_dt)
        for n in range(count):
            a[n] += inverse * x[n]
    else:
        copy_words(I, I[O_ACCELERATION], I[O_BASE_V], count)
    I[I_FACTORED] = 0
    I[I_HISTORY] = 0
