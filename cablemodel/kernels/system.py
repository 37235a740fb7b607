"""The whole line as one system of equations: residual, Newton matrix, Newton increments.

Everything that depends on the dimension (planar or three-dimensional) is chosen here, once a call.
"""

from .backup import keep_matrix
from .block_solver import (
    factor_parts,
    factor_planar,
    factor_spatial,
    solve_parts,
    solve_planar,
    solve_spatial,
)
from .bodies import body_jacobian, body_residual
from .compile import kernel, outlined, view
from .element_planar import (
    condense_planar,
    jacobian_planar,
    residual_planar,
    stretch_rate_planar,
)
from .element_spatial import (
    condense_spatial,
    jacobian_spatial,
    residual_spatial,
    stretch_rate_spatial,
)
from .environment import current_profile, prescribed_motion, vessel_motion
from .floor import floor_jacobian, floor_residual
from .frames import move_frames, point_motion, turn_clamps, turn_slope
from .free_bodies import follow_bodies, free_jacobian, free_residual
from .layout import (
    ALONE,
    C_CLAMPED,
    C_DIRECTION,
    C_FRAME,
    C_KIND,
    C_NODE,
    C_POINT,
    CONSTRAINT_WORDS,
    EXACTLY,
    FLOOR_TOUCHED,
    FRAME_WORDS,
    I_BODIES,
    I_CONSTRAINTS,
    I_DIMENSION,
    I_DRAG,
    I_FLOOR_STATE,
    I_NODES,
    I_PARTS,
    I_PAYOUT,
    I_RIGID,
    I_SURGE,
    I_WAVES,
    JOINT_HINGE,
    O_COMPLIANCE,
    O_CONSTRAINT,
    O_DIAGONAL,
    O_FRAMES,
    O_JOINT,
    O_LOWER,
    O_MOTION,
    O_PARENT,
    O_STRETCH,
    O_TOP,
    O_UPPER,
    S_PASSING,
    S_STAGE_TIME,
)
from .passing import add_first_bit, exchange_rates
from .payout import material_top, set_top_length
from .rigid import condense_rigid, rigid_jacobian, rigid_residual, stretch_rate_rigid
from .surge import push_elements
from .triangular_solver import (
    factor_planar_lu,
    factor_spatial_lu,
    solve_planar_lu,
    solve_spatial_lu,
)
from .vessel_clamp import add_clamp_moment, add_clamp_tangent
from .waves import set_wave_time


@outlined
def residual(I, M, q, v, a, tension, out, out_constraint):
    """Forces conjugate to (r, d) that the equations of motion leave, and constraint residuals.

    Of a system, places at the arms of free bodies are made those of the bodies first.
    """
    if I[I_PARTS] != 0:
        follow_bodies(I, M, q, v, a)
    if I[I_PAYOUT] != 0:
        material_top(I, M, q, v, a)
    if I[I_DIMENSION] == 2:
        residual_planar(I, M, q, v, a, tension, out, out_constraint)
    else:
        residual_spatial(I, M, q, v, a, tension, out, out_constraint)
    if I[I_SURGE] != 0 and I[I_WAVES] == 0 and I[I_DRAG] != 0:
        push_elements(I, M, q, out)
    if I[I_BODIES] > 0:
        body_residual(I, M, q, v, a, out)
    if I[I_RIGID] > 0:
        if M[S_PASSING] != 0.0:
            exchange_rates(I, M, v, a)
        rigid_residual(I, M, q, v, a, tension, out, out_constraint)
        if M[S_PASSING] != 0.0:
            exchange_rates(I, M, v, a)
        elif I[I_PAYOUT] != 0:
            add_first_bit(I, M, out)
    if I[I_PAYOUT] != 0:
        add_clamp_moment(I, M, q, out)
    if I[I_FLOOR_STATE] == FLOOR_TOUCHED:
        floor_residual(I, M, q, v, out)
    if I[I_PARTS] != 0:
        free_residual(I, M, M[S_STAGE_TIME], out)


@kernel
def set_time(I, M, t):
    """Evaluate what depends on time alone: vessel motion, current profile, cable paid out."""
    if I[I_PAYOUT] != 0:
        set_top_length(I, M, t)
    vessel_motion(I, M, t)
    if I[I_PARTS] != 0:
        M[S_STAGE_TIME] = t
        move_frames(I, M, t)
        turn_clamps(I, M)
    current_profile(I, M, t)
    if I[I_WAVES] != 0:
        set_wave_time(M, t)


@kernel
def keep_along(M, direction, dimension, x, at):
    """Leave of a slope, or of its rate, at x[at] what lies along a direction, by its word."""
    along = 0.0
    for i in range(dimension):
        along += M[direction + i] * x[at + i]
    for i in range(dimension):
        x[at + i] = along * M[direction + i]


@kernel
def impose_motion(I, M, t, q, v, a):
    """Write the prescribed position, velocity and acceleration into the state.

    Of a clamped slope the length is free, the direction is not: nothing pulls back what rounding
    has turned it by, and a rate of turning, however small, would go on for ever.
    """
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    out = view(M, I[O_MOTION] + 16, 9)
    for n in range(I[I_CONSTRAINTS]):
        row = I[O_CONSTRAINT] + n * CONSTRAINT_WORDS
        at = size * int(M[row + C_NODE])
        if M[row + C_KIND] == C_POINT:
            frame = I[O_FRAMES] + int(M[row + C_FRAME]) * FRAME_WORDS
            w = view(M, I[O_MOTION] + 28, 9)
            point_motion(M, row, frame, out, w)
            for i in range(3):
                q[at + i] = out[i]
                v[at + i] = out[3 + i]
                a[at + i] = out[6 + i]
            if M[row + C_CLAMPED] == EXACTLY:
                turn_slope(M, row, frame, q, v, a, at + 3, w)
            continue
        prescribed_motion(I, M, row, t, out)
        for i in range(dimension):
            q[at + i] = out[i]
            v[at + i] = out[dimension + i]
            a[at + i] = out[2 * dimension + i]
        if M[row + C_CLAMPED] == EXACTLY:
            keep_along(M, row + C_DIRECTION, dimension, q, at + dimension)
            keep_along(M, row + C_DIRECTION, dimension, v, at + dimension)
            keep_along(M, row + C_DIRECTION, dimension, a, at + dimension)


@kernel
def project_rows(I, M, row, at):
    """Left-multiply a block by the constraint's projector: no r, d only along the clamp."""
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    for j in range(size):
        for i in range(dimension):
            M[at + size * i + j] = 0.0
        if M[row + C_CLAMPED] == EXACTLY:
            value = 0.0
            for i in range(dimension):
                value += M[row + C_DIRECTION + i] * M[at + size * (dimension + i) + j]
            for i in range(dimension):
                M[at + size * (dimension + i) + j] = M[row + C_DIRECTION + i] * value


@kernel
def project_columns(I, M, row, at):
    """Right-multiply a block by the constraint's projector."""
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    for i in range(size):
        for j in range(dimension):
            M[at + size * i + j] = 0.0
        if M[row + C_CLAMPED] == EXACTLY:
            value = 0.0
            for j in range(dimension):
                value += M[row + C_DIRECTION + j] * M[at + size * i + dimension + j]
            for j in range(dimension):
                M[at + size * i + dimension + j] = M[row + C_DIRECTION + j] * value


@kernel
def constrain_matrix(I, M):
    """Fix the prescribed unknowns in the Newton matrix: A K A + (1 - A) k with A the projector.

    For a clamped slope k is the stiffness that A K A has along it: beside 1e16 N m of a line that
    hardly stretches a 1 would be lost in rounding, and with it what holds the direction.
    """
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    area = size * size
    for n in range(I[I_CONSTRAINTS]):
        row = I[O_CONSTRAINT] + n * CONSTRAINT_WORDS
        node = int(M[row + C_NODE])
        at = I[O_DIAGONAL] + area * node
        project_rows(I, M, row, at)
        project_columns(I, M, row, at)
        for i in range(dimension):
            M[at + size * i + i] += 1.0
        if M[row + C_CLAMPED] == ALONE:
            for i in range(dimension, size):
                M[at + size * i + i] += 1.0
        if M[row + C_CLAMPED] == EXACTLY:
            along = 0.0
            for i in range(dimension):
                along += M[at + size * (dimension + i) + dimension + i]
            along = max(1.0, abs(along))
            for i in range(dimension):
                for j in range(dimension):
                    value = -M[row + C_DIRECTION + i] * M[row + C_DIRECTION + j]
                    if i == j:
                        value += 1.0
                    M[at + size * (dimension + i) + dimension + j] += along * value
        if node > 0:
            project_rows(I, M, row, I[O_LOWER] + area * node)
            project_columns(I, M, row, I[O_UPPER] + area * node)
        # A line begins or ends here: nothing else than its own first element is tied to it.
        child = node + 1
        if child < I[I_NODES] and I[I[O_PARENT] + child] == node:
            project_rows(I, M, row, I[O_UPPER] + area * child)
            project_columns(I, M, row, I[O_LOWER] + area * child)


@kernel
def constrain_vector(I, M, x):
    """Remove the prescribed components of a right-hand side."""
    dimension = I[I_DIMENSION]
    for n in range(I[I_CONSTRAINTS]):
        row = I[O_CONSTRAINT] + n * CONSTRAINT_WORDS
        at = 2 * dimension * int(M[row + C_NODE])
        for i in range(dimension):
            x[at + i] = 0.0
        if M[row + C_CLAMPED] == EXACTLY:
            value = 0.0
            for i in range(dimension):
                value += M[row + C_DIRECTION + i] * x[at + dimension + i]
            for i in range(dimension):
                x[at + dimension + i] = M[row + C_DIRECTION + i] * value


@outlined
def jacobian(I, M, q, v, a, tension, ca, cv):
    """Assemble the effective Jacobian (not constrained, not factored)."""
    if I[I_PARTS] != 0:
        follow_bodies(I, M, q, v, a)
    if I[I_PAYOUT] != 0:
        material_top(I, M, q, v, a)
    if I[I_DIMENSION] == 2:
        jacobian_planar(I, M, q, v, a, tension, ca, cv)
    else:
        jacobian_spatial(I, M, q, v, a, tension, ca, cv)
    if I[I_BODIES] > 0:
        body_jacobian(I, M, q, v, a, ca, cv)
    if I[I_RIGID] > 0:
        if M[S_PASSING] != 0.0:
            exchange_rates(I, M, v, a)
        rigid_jacobian(I, M, q, v, a, tension, ca, cv)
        if M[S_PASSING] != 0.0:
            exchange_rates(I, M, v, a)
    if I[I_PAYOUT] != 0:
        add_clamp_tangent(I, M, q)
    if I[I_FLOOR_STATE] == FLOOR_TOUCHED:
        floor_jacobian(I, M, q, v, cv)
    if I[I_PARTS] != 0:
        free_jacobian(I, M, M[S_STAGE_TIME], q, v, a, ca, cv)


@outlined
def factorise(I, M, q, v, a, tension, ca, cv):
    """Assemble, constrain and factor; returns 0, or 1 + the node whose pivot vanished."""
    keep_matrix(I)
    jacobian(I, M, q, v, a, tension, ca, cv)
    return factor_assembled(I, M)


@kernel
def factor_assembled(I, M):
    """Constrain and factor the matrix that has been assembled; returns as `factorise`."""
    constrain_matrix(I, M)
    if I[I_PARTS] != 0:
        return factor_parts(I, M)
    if I[I_RIGID] > 0:
        if I[I_DIMENSION] == 2:
            return factor_planar_lu(I, M)
        return factor_spatial_lu(I, M)
    if I[I_DIMENSION] == 2:
        return factor_planar(I, M)
    return factor_spatial(I, M)


@kernel
def newton_increment(I, M, forces, constraint, x):
    """x = increments of (r, d) from the residuals, with the stored factorisation.

    `forces` is overwritten by its condensed form.
    """
    count = 2 * I[I_DIMENSION] * I[I_NODES]
    if I[I_DIMENSION] == 2:
        condense_planar(I, M, constraint, forces)
    else:
        condense_spatial(I, M, constraint, forces)
    if I[I_RIGID] > 0:
        condense_rigid(I, M, constraint, forces)
    for n in range(count):
        x[n] = -forces[n]
    constrain_vector(I, M, x)
    if I[I_PARTS] != 0:
        solve_parts(I, M, x)
    elif I[I_RIGID] > 0:
        if I[I_DIMENSION] == 2:
            solve_planar_lu(I, M, x)
        else:
            solve_spatial_lu(I, M, x)
    elif I[I_DIMENSION] == 2:
        solve_planar(I, M, x)
    else:
        solve_spatial(I, M, x)


@kernel
def stretch_rate(I, M, x, out):
    """B x: what a motion x of the nodes adds to the constraint residuals."""
    if I[I_DIMENSION] == 2:
        stretch_rate_planar(I, M, x, out)
    else:
        stretch_rate_spatial(I, M, x, out)
    if I[I_RIGID] > 0:
        stretch_rate_rigid(I, M, x, out)


@kernel
def recover_tension(I, M, constraint, x, tension):
    """Add the tension increments S (constraint + B x) that belong to x; returns the largest [N]."""
    nodes = I[I_NODES]
    joints = view(I, I[O_JOINT], nodes)
    work = view(M, I[O_STRETCH], 2 * nodes)
    stretch_rate(I, M, x, work)
    largest = 0.0
    for node in range(1, nodes):
        if joints[node] == JOINT_HINGE:
            continue
        s = view(M, I[O_COMPLIANCE] + 3 * node, 3)
        r0 = constraint[2 * node] + work[2 * node]
        r1 = constraint[2 * node + 1] + work[2 * node + 1]
        d0 = s[0] * r0 + s[1] * r1
        d1 = s[1] * r0 + s[2] * r1
        tension[2 * node] += d0
        tension[2 * node + 1] += d1
        largest = max(largest, abs(d0), abs(d1))
    return largest


@kernel
def material_stretch_rate(I, M, v, out):
    """Rate of |r'| in the constraint residuals, of the cable, not of the mesh past which it runs.

    With pay-out the last residual was that of these velocities.
    """
    if I[I_PAYOUT] != 0:
        # Material velocities, which the last residual left in O_TOP, in place of the mesh's.
        size = 2 * I[I_DIMENSION]
        kept = view(M, I[O_TOP] + 12, size)
        for n in range(size):
            kept[n] = v[n]
            v[n] = M[I[O_TOP] + n]
        stretch_rate(I, M, v, out)
        for n in range(size):
            v[n] = kept[n]
    else:
        stretch_rate(I, M, v, out)


@kernel
def elongation_rate(I, M, v, tension_rate, out):
    """Time derivative of the constraint residual: B v - C dT/dt, with the stored gradient B.

    With tension_rate the solution of the projected system, out is what is left of the constraint.
    """
    material_stretch_rate(I, M, v, out)
    for node in range(1, I[I_NODES]):
        s = I[O_COMPLIANCE] + 3 * node
        determinant = M[s] * M[s + 2] - M[s + 1] * M[s + 1]
        if determinant == 0.0:
            continue
        t0 = tension_rate[2 * node]
        t1 = tension_rate[2 * node + 1]
        out[2 * node] -= (M[s + 2] * t0 - M[s + 1] * t1) / determinant
        out[2 * node + 1] -= (M[s] * t1 - M[s + 1] * t0) / determinant
