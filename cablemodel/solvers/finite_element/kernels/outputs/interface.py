"""How forces on vessels, or at a tow point, follow time and motion, for what is coupled to them.

All kernels use the block up: whoever asks works on a copy.
"""

from cablemodel.solvers.finite_element.kernels.line.closures import follow_forces
from cablemodel.solvers.finite_element.kernels.line.swinging import add_product
from cablemodel.solvers.finite_element.kernels.line.system import (
    assemble_here,
    factorise,
    impose_motion,
    newton_increment,
    recover_tension,
    residual,
    set_time,
)
from cablemodel.solvers.finite_element.kernels.outputs.part_outputs import add_wrenches
from cablemodel.solvers.finite_element.kernels.outputs.summary import end_forces
from cablemodel.solvers.finite_element.kernels.time.promote import promote
from cablemodel.solvers.shared.access import header, motion_change_at, scalars, spare_row, vector
from cablemodel.solvers.shared.compile import kernel, outlined, view
from cablemodel.solvers.shared.layout import JOINT_HINGE, ResponseRows

ROW_CHANGE, ROW_FORCES = ResponseRows.motion.word, ResponseRows.forces.word
ROW_SOLUTION = ResponseRows.solution.word

RATE_AHEAD = 0.25  # of the caller's last step: the time over which a rate of the force is taken
RATE_ITERATIONS = 2  # of Newton's method for it: tensions are linear in what little changes


@kernel
def force_at_top(I, y, i):
    """Component of the forces y that acts where the line begins: at node 0 and hinges there."""
    head = header(I)
    total = y[i]
    for node in range(1, head.nodes):
        above = node
        while above > 0 and I[head.joint + above] == JOINT_HINGE:
            above = I[head.parent + above]
        if above == 0:
            total += y[6 * node + i]
    return total


@kernel
def top_reaction(I, forces, out):
    """Force of the cable on the vessel, earth frame, into out[0:3]: less that of the support."""
    for i in range(3):
        out[i] = -force_at_top(I, forces, i)


@outlined
def increment(I, M, forces, constraint, x):
    """`newton_increment`, once for all kernels."""
    newton_increment(I, M, forces, constraint, x)


@outlined
def implicit_step(I, M, ahead, length):
    """Correct a prediction by an implicit step in which accelerations are constant; returns 0, or
    1 + the node whose pivot vanished.

    ahead: the time over which the present motion goes on [s]; there prescribed motions are met.
    length: of the step whose matrix the correction takes [s]. The result is the trial state, and
    the forces in the residual are those of it.
    """
    head = header(I)
    state = scalars(M)
    count = 6 * head.nodes
    words = 2 * head.nodes
    q = view(M, head.trial_position, count)
    v = view(M, head.trial_velocity, count)
    a = view(M, head.trial_acceleration, count)
    tension = view(M, head.trial_tension, words)
    forces = view(M, head.residual, count)
    constraint = view(M, head.constraint_residual, words)
    x = view(M, head.increment, count)
    for n in range(words):
        tension[n] = M[head.tension + n]
    for n in range(count):
        a[n] = M[head.acceleration + n]
        v[n] = M[head.velocity + n] + ahead * a[n]
        q[n] = M[head.position + n] + ahead * (M[head.velocity + n] + 0.5 * ahead * a[n])
    time = state.time + ahead
    set_time(I, M, time)
    impose_motion(I, M, time, q, v, a)
    cv = 2.0 / length
    ca = 2.0 / (length * length)
    failed = factorise(I, M, q, v, a, tension, ca, cv)
    if failed != 0:
        return failed
    for _iteration in range(RATE_ITERATIONS):
        residual(I, M, q, v, a, tension, forces, constraint)
        increment(I, M, forces, constraint, x)
        for n in range(count):
            q[n] += x[n]
            v[n] += cv * x[n]
            a[n] += ca * x[n]
        recover_tension(I, M, constraint, x, tension, False)
        follow_forces(I, M)
    residual(I, M, q, v, a, tension, forces, constraint)
    return 0


@kernel
def rate_of_force(I, M, last_step, out):
    """Time derivative of the force of the cable on the vessel, earth frame, into out[0:3] [N/s].

    What a single implicit step ahead makes of it, a quarter of the caller's last step long, with
    the vessel's acceleration of now: a state's own rates ring, with waves along the line.
    """
    head = header(I)
    promote(I, M)
    forces = view(M, head.residual, 6 * head.nodes)
    before = vector()
    span = RATE_AHEAD * last_step
    end_forces(I, M)
    top_reaction(I, forces, out)
    if implicit_step(I, M, span, span) != 0:
        for i in range(3):
            out[i] = 0.0
        return
    for i in range(3):
        before[i] = out[i]
    top_reaction(I, forces, out)
    for i in range(3):
        out[i] = (out[i] - before[i]) / span


@kernel
def wrenches_when_moved(I, M, length, out):
    """Forces and moments of the lines of a system on its frames, about their origins, where the
    frames are not where they were: 6 words each [N, N m].

    The nodes follow as in an implicit step of a length [s], without time going on. Returns 0, or
    1 + the node whose pivot vanished.
    """
    head = header(I)
    failed = implicit_step(I, M, 0.0, length)
    out[:] = 0.0
    if failed == 0:
        add_wrenches(I, M, head.trial_position, out, 6, 0)
    return failed


@kernel
def add_assembled(I, M, x, y):
    """y += (assembled matrix) x of a line alone; a hinge is where its parent is."""
    head = header(I)
    for node in range(1, head.nodes):
        if I[head.joint + node] == JOINT_HINGE:
            for i in range(3):
                x[6 * node + i] = x[6 * I[head.parent + node] + i]
    area = head.upper - head.diagonal
    add_product(I, view(M, head.diagonal, 3 * area), area, x, y)


@kernel
def response_to_motion(I, M, words, out):
    """What a small change of the tow point's motion, a MotionChange, does to the force on the
    vessel [N].

    Other nodes follow with the Newton matrix of one step of the time that it has lasted, in which
    accelerations are constant: M, C and K act on a change x of position as
    (2/T^2 M + 2/T C + K) x. out: the change of the force (3). Returns 0, or 1 + the node whose
    pivot vanished.
    """
    head = header(I)
    change = motion_change_at(words, 0)
    promote(I, M)
    count = 6 * head.nodes
    cv = 2.0 / change.lasted
    ca = 2.0 / (change.lasted * change.lasted)
    x = view(M, spare_row(I, ROW_CHANGE), count)
    y = view(M, spare_row(I, ROW_FORCES), count)
    solution = view(M, spare_row(I, ROW_SOLUTION), count)
    y[:] = 0.0
    for part in range(3):
        x[:] = 0.0
        for i in range(3):
            of_damping = change.velocity[i] / cv
            of_mass = change.acceleration[i] / ca
            if part == 0:
                x[i] = change.position[i] - of_damping - of_mass
            else:
                x[i] = of_damping if part == 1 else of_mass
        assemble_here(I, M, cv if part == 1 else 0.0, ca if part == 2 else 0.0)
        add_assembled(I, M, x, y)
    failed = factorise(
        I,
        M,
        view(M, head.position, count),
        view(M, head.velocity, count),
        view(M, head.acceleration, count),
        view(M, head.tension, 2 * head.nodes),
        ca,
        cv,
    )
    if failed != 0:
        return failed
    forces = view(M, head.residual, count)
    constraint = view(M, head.constraint_residual, 2 * head.nodes)
    constraint[:] = 0.0
    for n in range(count):
        forces[n] = y[n]
    increment(I, M, forces, constraint, solution)
    assemble_here(I, M, cv, ca)
    add_assembled(I, M, solution, y)
    for i in range(3):
        out[i] = -force_at_top(I, y, i)
    return 0
