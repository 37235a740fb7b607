"""One step of the model as its callers see it: inputs in, time reached or nothing changed."""

import math

from cablemodel.solvers.finite_element.kernels.bodies.vessel_clamp import release_slope
from cablemodel.solvers.finite_element.kernels.line.system import set_time
from cablemodel.solvers.finite_element.kernels.mesh.sleep import leave_out, rejoin
from cablemodel.solvers.finite_element.kernels.time.backup import give_back, keep_state
from cablemodel.solvers.finite_element.kernels.time.consistency import state_residual
from cablemodel.solvers.finite_element.kernels.time.promote import promote
from cablemodel.solvers.finite_element.kernels.time.step_size import natural_step
from cablemodel.solvers.finite_element.kernels.time.time_stepping import advance_to
from cablemodel.solvers.shared.access import (
    header,
    motion_piece_of,
    polynomial_at,
    scalars,
)
from cablemodel.solvers.shared.compile import kernel
from cablemodel.solvers.shared.inputs import possible, release_inputs, take_inputs
from cablemodel.solvers.shared.layout import (
    NOT_FINITE,
    OK,
)
from cablemodel.solvers.shared.numbers import OUT_OF_PLANE

STANDING = 1e-12  # of length, speed and acceleration across: of cable that hangs and is still


@kernel
def out_of_plane(I, M, x, y):
    """Whether a horizontal vector leaves the plane of a planar model."""
    state = scalars(M)
    across = state.plane[0] * y - state.plane[1] * x
    return abs(across) > OUT_OF_PLANE * (abs(x) + abs(y))


@kernel
def turn_or_leave_plane(I, M, x, y):
    """Turn the plane to (x, y) where the cable is vertical and still, else leave the plane."""
    head = header(I)
    state = scalars(M)
    nodes = head.nodes
    largest = 0.0
    for n in range(nodes):
        for k in range(2):
            at = 4 * n + 2 * k
            largest = max(
                largest,
                abs(M[head.position + at]) / state.length,
                abs(M[head.velocity + at]),
                abs(M[head.acceleration + at]),
            )
    if largest <= STANDING and head.current_kind == 0 and head.wave_count == 0:
        size = math.hypot(x, y)
        state.plane[0] = x / size
        state.plane[1] = y / size
    else:
        promote(I, M)


@kernel
def follow_inputs_out_of_plane(I, M):
    """Promote a planar model whose live inputs leave its plane."""
    head = header(I)
    state = scalars(M)
    if head.dimension == 3:
        return
    live = state.live_current
    law = polynomial_at(motion_piece_of(I, M, 0).data, 0)
    # A plane that was turned for one input must hold for all of them: a second time.
    for again in range(2):
        if head.live == 1:
            for rate in (law.velocity, law.second, law.third):
                if head.dimension == 2 and out_of_plane(I, M, rate[0], rate[1]):
                    if again == 0:
                        turn_or_leave_plane(I, M, rate[0], rate[1])
                    else:
                        promote(I, M)
        for flow in (live.first, live.last):
            if head.dimension == 2 and out_of_plane(I, M, flow[0], flow[1]):
                if again == 0:
                    turn_or_leave_plane(I, M, flow[0], flow[1])
                else:
                    promote(I, M)


@kernel
def take_step(I, M, t_end, inputs):
    """Step to t_end [s] with the given inputs (INPUT_WORDS); on failure nothing has changed."""
    head = header(I)
    state = scalars(M)
    if not possible(M, t_end, inputs):
        return NOT_FINITE
    keep_state(I)
    returning, runs = take_inputs(I, M, t_end, inputs)
    if runs:
        release_slope(I, M)
    follow_inputs_out_of_plane(I, M)
    if head.parts != 0:
        # The matrix goes by what lines pulled bodies with at the last residual: that of the state,
        # whether its outputs have been read or not.
        set_time(I, M, state.time)
        state_residual(I, M)
    if head.asleep != 0:
        leave_out(I, M)
    status = OK
    span = t_end - state.time
    middle = state.time + 0.5 * span
    halves = 2 if state.halves != 0.0 and natural_step(I, M) > span else 1
    for half in range(halves):
        status = advance_to(I, M, t_end if half == halves - 1 else middle)
        if status != OK:
            give_back(I)
            return status
    if head.asleep != 0:
        rejoin(I, M)
    head.keep_matrix = 0
    head.keep_sleepers = 0
    release_inputs(I, returning)
    return status
