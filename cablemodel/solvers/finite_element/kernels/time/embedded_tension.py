"""What the stages of a step, and its embedded solution, say of the error of its tensions.

The matrix of the stages tells what the next step has forgotten from what lasts: it takes out of the
embedded solution's error what the scheme damps.
"""

from cablemodel.solvers.finite_element.kernels.element.tables import STAGES, TENSION_TEST
from cablemodel.solvers.finite_element.kernels.line.closures import scale_gaps
from cablemodel.solvers.finite_element.kernels.line.system import (
    newton_increment,
    recover_tension,
    residual,
)
from cablemodel.solvers.finite_element.kernels.time.watched_tension import allowed_at, watched
from cablemodel.solvers.shared.access import header, spare_row, trial_tension_of
from cablemodel.solvers.shared.compile import kernel, outlined, view
from cablemodel.solvers.shared.layout import FilterRows

ROW_LEFT, ROW_MOTION = FilterRows.left.word, FilterRows.accelerations.word
UNEXPLAINED = 0.01  # of the scatter: an embedded error that explains none of it


@kernel
def keep_stage_tensions(I, M, stage):
    """Keep the tensions of a step's stage, by its number, of what is watched."""
    head = header(I)
    for node in range(1, watched(I)):
        M[head.stage_tensions + 6 * node + stage] = trial_tension_of(I, M, node).mean


@kernel
def stage_scatter(I, M, node, scheme):
    """How far the tensions of a step's implicit stages are off a smooth curve [tolerances]."""
    head = header(I)
    stages = STAGES[scheme] - 1
    tension = view(M, head.stage_tensions + 6 * node, 6)
    worst = 0.0
    for i in range(stages):
        missed = 0.0
        for j in range(stages):
            missed += TENSION_TEST[scheme, i, j] * tension[j]
        worst = max(worst, abs(missed))
    return worst / allowed_at(I, M, node)


@kernel
def stretch_tensions(I, M, x):
    """What a motion x of the nodes changes of the elements' tensions by stretching them [N], into
    `left` of FilterRows."""
    head = header(I)
    constraint = view(M, head.constraint_residual, 2 * head.nodes)
    change = view(M, spare_row(I, ROW_LEFT), 2 * head.nodes)
    constraint[:] = 0.0
    change[:] = 0.0
    recover_tension(I, M, constraint, x, change, False)


@kernel
def filter_motion(I, M, motion, gamma_dt):
    """Leave of a motion of the nodes, (nodes, 2, dimension), what the stages' matrix makes of its
    inertia: all where the step resolves it, 1 / (1 + (omega gamma dt)^2) of what swings. And by
    `stretch_tensions` what is left in the tensions."""
    head = header(I)
    count = 2 * head.dimension * head.nodes
    words = 2 * head.nodes
    forces = view(M, head.residual, count)
    constraint = view(M, head.constraint_residual, words)
    x = view(M, head.increment, count)
    a = view(M, spare_row(I, ROW_MOTION), count)
    inverse2 = 1.0 / (gamma_dt * gamma_dt)
    for n in range(count):
        a[n] = M[head.trial_acceleration + n] - inverse2 * motion[n]
    q = view(M, head.trial_position, count)
    v = view(M, head.trial_velocity, count)
    residual(I, M, q, v, a, view(M, head.trial_tension, words), forces, constraint)
    constraint[:] = 0.0
    scale_gaps(I, M, 0.0)
    newton_increment(I, M, forces, constraint, x)
    for n in range(count):
        motion[n] = x[n]
    stretch_tensions(I, M, x)


@outlined
def find_embedded_errors(I, M, error, gamma_dt, bound):
    """Errors of the watched tensions by the embedded solution, for `embedded_error`; returns
    whether it is left out how much of them lasts: no error is above `bound` [tolerances].

    error: of the positions, (nodes, 2, dimension) [m]; it is overwritten.
    """
    head = header(I)
    filter_motion(I, M, error, gamma_dt)
    left_in = spare_row(I, ROW_LEFT)
    largest = 0.0
    for node in range(1, watched(I)):
        left = M[left_in + 2 * node]
        M[head.stage_tensions + 6 * node + 5] = left
        largest = max(largest, abs(left) / allowed_at(I, M, node))
    if largest <= bound:
        return True
    filter_motion(I, M, error, gamma_dt)
    return False


@kernel
def embedded_error(I, M, node, scatter):
    """Error of a watched tension by the embedded solution [tolerances], and its part that lasts.

    scatter: beside which an error is none that is much smaller [tolerances].
    """
    head = header(I)
    allowed = allowed_at(I, M, node)
    left = abs(M[head.stage_tensions + 6 * node + 5]) / allowed
    again = abs(M[spare_row(I, ROW_LEFT) + 2 * node]) / allowed
    return left, min(1.0, again / max(left, UNEXPLAINED * scatter))
