"""The whole line as one system of equations: residual, Newton matrix, Newton increments.

Everything that depends on the dimension (planar or three-dimensional) is chosen here, once a call.
"""

from cablemodel.solvers.finite_element.kernels.bodies.frames import (
    move_frames,
    point_motion,
    turn_clamps,
    turn_slope,
)
from cablemodel.solvers.finite_element.kernels.bodies.free_bodies import (
    follow_bodies,
    free_jacobian,
    free_residual,
)
from cablemodel.solvers.finite_element.kernels.bodies.point_bodies import (
    body_jacobian,
    body_residual,
)
from cablemodel.solvers.finite_element.kernels.bodies.rigid import (
    condense_rigid,
    rigid_jacobian,
    rigid_residual,
    stretch_rate_rigid,
)
from cablemodel.solvers.finite_element.kernels.bodies.vessel_clamp import (
    add_clamp_moment,
    add_clamp_tangent,
)
from cablemodel.solvers.finite_element.kernels.element.element_planar import (
    condense_planar,
    constraints_planar,
    gradients_planar,
    jacobian_planar,
    residual_planar,
    stretch_rate_planar,
)
from cablemodel.solvers.finite_element.kernels.element.element_spatial import (
    condense_spatial,
    constraints_spatial,
    gradients_spatial,
    jacobian_spatial,
    residual_spatial,
    stretch_rate_spatial,
)
from cablemodel.solvers.finite_element.kernels.element.strain import may_be_slack, tensions_after
from cablemodel.solvers.finite_element.kernels.floor.floor_forces import (
    floor_jacobian,
    floor_residual,
)
from cablemodel.solvers.finite_element.kernels.line.block_solver import (
    factor_parts,
    factor_planar,
    factor_spatial,
    solve_parts,
    solve_planar,
    solve_spatial,
)
from cablemodel.solvers.finite_element.kernels.line.closures import (
    close,
    close_increment,
    close_jacobian,
    column_word,
    factor_small,
    put_force,
    take_gaps_of_motion,
)
from cablemodel.solvers.finite_element.kernels.line.triangular_solver import (
    factor_planar_lu,
    factor_spatial_lu,
    solve_planar_lu,
    solve_spatial_lu,
)
from cablemodel.solvers.finite_element.kernels.mesh.body_passage import (
    add_first_bit,
    exchange_rates,
    exchange_velocities,
)
from cablemodel.solvers.finite_element.kernels.mesh.payout import material_top, set_top_length
from cablemodel.solvers.finite_element.kernels.time.backup import keep_matrix
from cablemodel.solvers.finite_element.kernels.water.surge import push_elements
from cablemodel.solvers.finite_element.kernels.water.waves import set_wave_time
from cablemodel.solvers.shared.access import (
    closure_of,
    compliance_of,
    constraint_of,
    edge_of,
    frame_of,
    header,
    new_motion,
    scalars,
    winch_of,
)
from cablemodel.solvers.shared.compile import inlined, kernel, outlined, view
from cablemodel.solvers.shared.environment import current_profile, prescribed_motion, vessel_motion
from cablemodel.solvers.shared.layout import (
    EXACTLY,
    FLOOR_TOUCHED,
    HELD_BY_FRAME,
    JOINT_HINGE,
    WHOLLY,
)


@outlined
def residual(I, M, q, v, a, tension, out, out_constraint):
    """Forces conjugate to (r, d) that the equations of motion leave, and constraint residuals.

    Of a system, places at the arms of free bodies are made those of the bodies first.
    """
    head = header(I)
    state = scalars(M)
    if head.parts != 0:
        follow_bodies(I, M, q, v, a)
    if head.payout != 0:
        material_top(I, M, q, v, a)
        exchange_rates(I, M, v, a)
    if head.dimension == 2:
        residual_planar(I, M, q, v, a, tension, out, out_constraint)
    else:
        residual_spatial(I, M, q, v, a, tension, out, out_constraint)
    if head.payout != 0:
        exchange_rates(I, M, v, a)
    if head.surge != 0 and head.wave_count == 0 and head.drag != 0:
        push_elements(I, M, q, out)
    if head.body_count > 0:
        body_residual(I, M, q, v, a, out)
    if head.rigid > 0:
        passing_body = winch_of(I, M, 0).passing_body != 0.0
        if passing_body:
            exchange_rates(I, M, v, a)
        rigid_residual(I, M, q, v, a, tension, out, out_constraint)
        if passing_body:
            exchange_rates(I, M, v, a)
        elif head.payout != 0:
            add_first_bit(I, M, out)
    if head.payout != 0:
        add_clamp_moment(I, M, q, out)
    if head.floor_state == FLOOR_TOUCHED:
        floor_residual(I, M, q, v, out)
    if head.parts != 0:
        free_residual(I, M, state.stage_time, out)
        if head.closure_count != 0:
            close(I, M, q, out)


@inlined
def remembers(I):
    """Whether forces go by what was found before: at bodies, and in the cells of a sea. Then all is
    found where constraints alone are asked for."""
    head = header(I)
    return head.parts != 0 or head.rigid > 0 or head.wave_count != 0


@kernel
def constraints(I, M, q, v, a, tension, forces, out):
    """Constraint residuals as `residual` finds them, which may find `forces` too."""
    head = header(I)
    if remembers(I):
        residual(I, M, q, v, a, tension, forces, out)
        return
    if head.payout != 0:
        material_top(I, M, q, v, a)
    if head.dimension == 2:
        constraints_planar(I, M, q, tension, out)
    else:
        constraints_spatial(I, M, q, tension, out)


@kernel
def set_time(I, M, t):
    """Evaluate what depends on time alone: vessel motion, current profile, cable paid out."""
    head = header(I)
    state = scalars(M)
    if head.payout != 0:
        set_top_length(I, M, t)
    vessel_motion(I, M, t)
    if head.parts != 0:
        state.stage_time = t
        move_frames(I, M, t)
        turn_clamps(I, M)
    current_profile(I, M, t)
    if head.wave_count != 0:
        set_wave_time(M, t)


@kernel
def keep_along(direction, dimension, x, at):
    """Leave of a slope, or of its rate, at x[at] what lies along a direction."""
    along = 0.0
    for i in range(dimension):
        along += direction[i] * x[at + i]
    for i in range(dimension):
        x[at + i] = along * direction[i]


@kernel
def impose_motion(I, M, t, q, v, a):
    """Write the prescribed position, velocity and acceleration into the state.

    Of a clamped slope the length is free, the direction is not: nothing pulls back what rounding
    has turned it by, and a rate of turning, however small, would go on for ever.
    """
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    motion = new_motion()
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        at = size * int(row.node)
        if row.kind == HELD_BY_FRAME:
            frame = frame_of(I, M, int(row.frame))
            point_motion(M, row, frame, motion)
            for i in range(3):
                q[at + i] = motion.position[i]
                v[at + i] = motion.velocity[i]
                a[at + i] = motion.acceleration[i]
            if row.clamped == EXACTLY:
                turn_slope(row, frame, q, v, a, at + 3)
            continue
        prescribed_motion(I, M, row, t, motion)
        for i in range(dimension):
            q[at + i] = motion.position[i]
            v[at + i] = motion.velocity[i]
            a[at + i] = motion.acceleration[i]
        if row.clamped == EXACTLY:
            keep_along(row.direction, dimension, q, at + dimension)
            keep_along(row.direction, dimension, v, at + dimension)
            keep_along(row.direction, dimension, a, at + dimension)
        elif row.clamped == WHOLLY:
            for i in range(dimension, size):
                v[at + i] = 0.0
                a[at + i] = 0.0


@kernel
def project_rows(I, M, row, at):
    """Left-multiply a block by the constraint's projector: no r, d only along the clamp."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    held = size if row.clamped == WHOLLY else dimension
    for j in range(size):
        for i in range(held):
            M[at + size * i + j] = 0.0
        if row.clamped == EXACTLY:
            value = 0.0
            for i in range(dimension):
                value += row.direction[i] * M[at + size * (dimension + i) + j]
            for i in range(dimension):
                M[at + size * (dimension + i) + j] = row.direction[i] * value


@kernel
def project_columns(I, M, row, at):
    """Right-multiply a block by the constraint's projector."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    held = size if row.clamped == WHOLLY else dimension
    for i in range(size):
        for j in range(held):
            M[at + size * i + j] = 0.0
        if row.clamped == EXACTLY:
            value = 0.0
            for j in range(dimension):
                value += row.direction[j] * M[at + size * i + dimension + j]
            for j in range(dimension):
                M[at + size * i + dimension + j] = row.direction[j] * value


@kernel
def constrain_matrix(I, M):
    """Fix the prescribed unknowns in the Newton matrix: A K A + (1 - A) k with A the projector.

    For a clamped slope k is the stiffness that A K A has along it: beside 1e16 N m of a line that
    hardly stretches a 1 would be lost in rounding, and with it what holds the direction.
    """
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    area = size * size
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        node = int(row.node)
        at = head.diagonal + area * node
        project_rows(I, M, row, at)
        project_columns(I, M, row, at)
        for i in range(size if row.clamped == WHOLLY else dimension):
            M[at + size * i + i] += 1.0
        if row.clamped == EXACTLY:
            along = 0.0
            for i in range(dimension):
                along += M[at + size * (dimension + i) + dimension + i]
            along = max(1.0, abs(along))
            for i in range(dimension):
                for j in range(dimension):
                    value = -row.direction[i] * row.direction[j]
                    if i == j:
                        value += 1.0
                    M[at + size * (dimension + i) + dimension + j] += along * value
        if node > 0:
            project_rows(I, M, row, head.lower + area * node)
            project_columns(I, M, row, head.upper + area * node)
        # A line begins or ends here: nothing else than its own first element is tied to it.
        child = node + 1
        if child < head.nodes and I[head.parent + child] == node:
            project_rows(I, M, row, head.upper + area * child)
            project_columns(I, M, row, head.lower + area * child)


@kernel
def constrain_vector(I, M, x):
    """Remove the prescribed components of a right-hand side."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        at = size * int(row.node)
        for i in range(size if row.clamped == WHOLLY else dimension):
            x[at + i] = 0.0
        if row.clamped == EXACTLY:
            value = 0.0
            for i in range(dimension):
                value += row.direction[i] * x[at + dimension + i]
            for i in range(dimension):
                x[at + dimension + i] = row.direction[i] * value


@outlined
def jacobian(I, M, q, v, a, tension, ca, cv):
    """Assemble the effective Jacobian (not constrained, not factored)."""
    head = header(I)
    state = scalars(M)
    if head.parts != 0:
        follow_bodies(I, M, q, v, a)
    if head.payout != 0:
        material_top(I, M, q, v, a)
        exchange_rates(I, M, v, a)
    if head.dimension == 2:
        jacobian_planar(I, M, q, v, a, tension, ca, cv)
    else:
        jacobian_spatial(I, M, q, v, a, tension, ca, cv)
    if head.payout != 0:
        exchange_rates(I, M, v, a)
    if head.body_count > 0:
        body_jacobian(I, M, q, v, a, ca, cv)
    if head.rigid > 0:
        passing_body = winch_of(I, M, 0).passing_body != 0.0
        if passing_body:
            exchange_rates(I, M, v, a)
        rigid_jacobian(I, M, q, v, a, tension, ca, cv)
        if passing_body:
            exchange_rates(I, M, v, a)
    if head.payout != 0:
        add_clamp_tangent(I, M, q)
    if head.floor_state == FLOOR_TOUCHED:
        floor_jacobian(I, M, q, v, cv)
    if head.parts != 0:
        free_jacobian(I, M, state.stage_time, q, v, a, ca, cv)
        if head.closure_count != 0:
            close_jacobian(I, M, q, v, a)


@kernel
def find_gradients(I, M, q, tension):
    """Those of the constraints, as a Jacobian stores them; no matrix fits to them. Not of what
    `remembers`."""
    head = header(I)
    keep_matrix(I)
    if head.dimension == 2:
        gradients_planar(I, M, q, tension)
    else:
        gradients_spatial(I, M, q, tension)
    head.factored = 0


@outlined
def factorise(I, M, q, v, a, tension, ca, cv):
    """Assemble, constrain and factor; returns 0, or 1 + the node whose pivot vanished."""
    keep_matrix(I)
    jacobian(I, M, q, v, a, tension, ca, cv)
    return factor_assembled(I, M)


@kernel
def assemble_here(I, M, cv, ca):
    """K + cv C + ca M at the state into the matrix arrays (not constrained, not factored)."""
    head = header(I)
    count = 2 * head.dimension * head.nodes
    set_time(I, M, scalars(M).time)
    jacobian(
        I,
        M,
        view(M, head.position, count),
        view(M, head.velocity, count),
        view(M, head.acceleration, count),
        view(M, head.tension, 2 * head.nodes),
        ca,
        cv,
    )


@kernel
def factor_assembled(I, M):
    """Constrain and factor the matrix that has been assembled; returns as `factorise`."""
    head = header(I)
    constrain_matrix(I, M)
    if head.parts != 0:
        failed = factor_parts(I, M)
        if failed != 0 or head.closure_count == 0:
            return failed
        return factor_closures(I, M)
    if head.rigid > 0:
        if head.dimension == 2:
            return factor_planar_lu(I, M)
        return factor_spatial_lu(I, M)
    if head.dimension == 2:
        return factor_planar(I, M)
    return factor_spatial(I, M)


@kernel
def factor_closures(I, M):
    """Columns and small matrix of the closures, by the tree's factored matrix; returns as
    `factorise`."""
    head = header(I)
    for k in range(3 * head.closure_count):
        y = view(M, column_word(I, k), 6 * head.nodes)
        y[:] = 0.0
        put_force(I, M, closure_of(I, M, k // 3), k % 3, y)
        constrain_vector(I, M, y)
        solve_parts(I, M, y)
    return factor_small(I, M)


@kernel
def newton_increment(I, M, forces, constraint, x):
    """x = increments of (r, d) from the residuals, with the stored factorisation.

    `forces` is overwritten by its condensed form.
    """
    head = header(I)
    count = 2 * head.dimension * head.nodes
    if head.dimension == 2:
        condense_planar(I, M, constraint, forces)
    else:
        condense_spatial(I, M, constraint, forces)
    if head.rigid > 0:
        condense_rigid(I, M, constraint, forces)
    for n in range(count):
        x[n] = -forces[n]
    constrain_vector(I, M, x)
    if head.parts != 0:
        solve_parts(I, M, x)
        if head.closure_count != 0:
            close_increment(I, M, x)
    elif head.rigid > 0:
        if head.dimension == 2:
            solve_planar_lu(I, M, x)
        else:
            solve_spatial_lu(I, M, x)
    elif head.dimension == 2:
        solve_planar(I, M, x)
    else:
        solve_spatial(I, M, x)


@kernel
def stretch_rate(I, M, x, out):
    """B x: what a motion x of the nodes adds to the constraint residuals."""
    head = header(I)
    if head.dimension == 2:
        stretch_rate_planar(I, M, x, out)
    else:
        stretch_rate_spatial(I, M, x, out)
    if head.rigid > 0:
        stretch_rate_rigid(I, M, x, out)
    if head.closure_count != 0:
        take_gaps_of_motion(I, M, x)


@kernel
def recover_tension(I, M, constraint, x, tension, iterates):
    """Add the tension increments S (constraint + B x) that belong to x; returns the largest [N].

    iterates: these are the tensions that Newton's method is at, and elements that are pressed get
    what their strain asks for, of whatever state the matrix is.
    """
    head = header(I)
    nodes = head.nodes
    joints = view(I, head.joint, nodes)
    work = view(M, head.stretch, 2 * nodes)
    stretch_rate(I, M, x, work)
    head.bent_aside = 0
    largest = 0.0
    for node in range(1, nodes):
        if joints[node] == JOINT_HINGE:
            continue
        s = compliance_of(I, M, node)
        r0 = constraint[2 * node] + work[2 * node]
        r1 = constraint[2 * node + 1] + work[2 * node + 1]
        d0 = s.s00 * r0 + s.s01 * r1
        d1 = s.s01 * r0 + s.s11 * r1
        if iterates and joints[node] == 0:
            t0 = tension[2 * node]
            t1 = tension[2 * node + 1]
            edge = edge_of(I, M, node)
            if may_be_slack(edge, t0, t1) or may_be_slack(edge, t0 + d0, t1 + d1):
                h = edge.length
                d0, d1, others = tensions_after(M, edge, t0, t1, r0 / h, r1 / h)
                if others:
                    head.bent_aside = 1
        tension[2 * node] += d0
        tension[2 * node + 1] += d1
        largest = max(largest, abs(d0), abs(d1))
    return largest


@kernel
def material_stretch_rate(I, M, v, out):
    """Rate of |r'| in the constraint residuals, of the cable, not of the mesh past which it runs.

    With pay-out the last residual or constraints were those of these velocities.
    """
    head = header(I)
    if head.payout == 0:
        stretch_rate(I, M, v, out)
        return
    exchange_velocities(I, M, v)
    stretch_rate(I, M, v, out)
    exchange_velocities(I, M, v)


@kernel
def elongation_rate(I, M, v, tension_rate, out):
    """Time derivative of the constraint residual: B v - C dT/dt, with the stored gradient B.

    With tension_rate the solution of the projected system, out is what is left of the constraint.
    """
    head = header(I)
    material_stretch_rate(I, M, v, out)
    for node in range(1, head.nodes):
        s = compliance_of(I, M, node)
        determinant = s.s00 * s.s11 - s.s01 * s.s01
        if determinant == 0.0:
            continue
        t0 = tension_rate[2 * node]
        t1 = tension_rate[2 * node + 1]
        out[2 * node] -= (s.s11 * t0 - s.s01 * t1) / determinant
        out[2 * node + 1] -= (s.s00 * t1 - s.s01 * t0) / determinant
