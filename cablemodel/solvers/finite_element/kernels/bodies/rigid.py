"""Bodies of finite length: rigid bodies of revolution between two attachments.

Sun & Leonard 1998, section 4.1, eqs. 28-31. A body ties its outer node C to its parent, the inner
node A, in the tree (JOINT_BODY). Its unknowns are those nodes' positions: with length l = 2 R1,
offset lambda of the centre of gravity and g = r_C - r_A,

    axis a3 = g / |g|,  centre of gravity (1 - lambda)/2 r_A + (1 + lambda)/2 r_C,
    centre of buoyancy, where water acts, the middle (r_A + r_C) / 2.

All inertia is then a constant matrix, m |c_t|^2 / 2 + I |g_t|^2 / (2 l^2) being exact for |g| = l
(no spin about the axis). A multiplier N holds |g| = l + c N; it is the tension of this edge, kept
and condensed out like that of an element, with a compliance c that no tolerance sees.

Attached cables keep slopes of their own: the length of a slope is the cable's stretch, which
jumps at a body. A cable that bends is clamped by turning its slope d towards the axis with the
energy k (1 - cos(angle)), which does not see the length of d. The spring k is stiff where the mesh
resolves the bending layer of thickness sqrt(EI/T), and has that layer's own stiffness sqrt(EI T)
where it does not (a hybrid under tension). A flexible cable is hinged: k = 0.
"""

import math

from cablemodel.solvers.finite_element.kernels.bodies.point_bodies import (
    add_waves,
    body_in_water,
    flow_derivatives,
    flow_force,
    lift_of,
    speeds,
    surge_force,
    surge_power,
    wet_derivatives,
    wet_force,
)
from cablemodel.solvers.finite_element.kernels.bodies.slopes import slope_direction
from cablemodel.solvers.finite_element.kernels.mesh.body_passage import part_row
from cablemodel.solvers.shared.access import (
    body_at,
    body_of,
    compliance_of,
    edge_of,
    header,
    scalars,
    tension_of,
    vector,
    winch_of,
)
from cablemodel.solvers.shared.compile import inlined, kernel
from cablemodel.solvers.shared.environment import current_at
from cablemodel.solvers.shared.layout import (
    BODY_WORDS,
    MODEL_HYBRID,
)

CLAMP = 1e4  # stiffness of a clamp, in units of EI over the shorter of element and body
SOFT_CLAMP = 1e3  # the same for a hybrid, whose tension decides from time to time
FREE_WORK = 0.05  # of tau L times a typical tension: what a clamp may gain in sqrt(L/g) by itself
UNRESOLVED = 8.4686  # h / sqrt(EI/T) at which a string's cubic turns as easily as the layer
SLOPE_INERTIA = 1e-9  # of m l^2: keeps the mass matrix regular for the slope at the line's end
LEAST_CUBIC_SHARE = 0.1  # of the layer's softness: what a string's cubic leaves of it at least
# Of an elastica's cubic in powers of h / sqrt(EI/T): as much of the layer's softness is resolved.
CUBIC_FIT_0, CUBIC_FIT_2, CUBIC_FIT_3 = 1440.0, 101.7, 8.22


@kernel
def rigid_row(I, M, body):
    """Row of a body of finite length that is out, or of the part that is out of it, else -1."""
    head = header(I)
    row = head.bodies + body * BODY_WORDS
    of_body = body_at(M, row)
    if of_body.length == 0.0 or of_body.node < 0.0:
        return -1
    if body + 1 == winch_of(I, M, 0).passing_body:
        return part_row(I)
    return row


@inlined
def attachments(I, M, row):
    """Outer node of a body that is out, and the first words of its outer and its inner node."""
    head = header(I)
    size = 2 * head.dimension
    node = int(row.node)
    return node, size * node, size * I[head.parent + node]


@kernel
def axis_of(dimension, q, inner, outer, axis):
    """Unit vector from word `inner` of q to `outer` into `axis`; returns their distance [m]."""
    square = 0.0
    for i in range(dimension):
        axis[i] = q[outer + i] - q[inner + i]
        square += axis[i] * axis[i]
    length = math.sqrt(square)
    for i in range(dimension):
        axis[i] /= length
    return length


@kernel
def middle_height(dimension, q, inner, outer):
    """Height of the body's middle in the block's coordinates [m]."""
    return 0.5 * (q[inner + dimension - 1] + q[outer + dimension - 1])


@kernel
def middle_flow(I, M, q, v, a, inner, outer, body):
    """Flow and acceleration of the body's middle."""
    head = header(I)
    dimension = head.dimension
    current_at(I, M, middle_height(dimension, q, inner, outer), body.flow)
    for i in range(dimension):
        body.flow[i] -= 0.5 * (v[inner + i] + v[outer + i])
        body.acceleration[i] = 0.5 * (a[inner + i] + a[outer + i])


@kernel
def middle_waves(I, M, row, q, inner, outer, body):
    """Add the waves at the body's middle to what `middle_flow` wrote."""
    head = header(I)
    up = head.dimension - 1
    add_waves(
        I,
        M,
        row,
        0.5 * (q[inner] + q[outer]),
        0.5 * (q[inner + 1] + q[outer + 1]),
        middle_height(up + 1, q, inner, outer),
        q[outer + up] - q[inner + up],
        body,
    )


@kernel
def clamp_stiffness(M, edge, tension, length, resolved):
    """Moment per angle [N m] between a body of this length [m] and a cable under tension [N].

    edge: row of the element next to the body; resolved: the mesh resolves its layer, as that of an
    elastica does at a body. A hybrid's element that is long against the layer sqrt(EI/T) resists a
    turn of its end by 1/(1 - share) of the layer's sqrt(EI T); the spring in series with it makes
    up for the rest. `share` is fitted to an even mesh within 2 %.
    """
    full = edge.bending_full
    if full == 0.0:
        return 0.0
    h = edge.length
    if resolved:
        return CLAMP * full / min(h, length)
    stiff = SOFT_CLAMP * full / min(h, length)
    if not tension > 0.0:
        return stiff
    stiff += SOFT_CLAMP * math.sqrt(full * tension)
    x = h * math.sqrt(tension / full)
    x4 = x**4
    share = x4 / (CUBIC_FIT_0 + CUBIC_FIT_2 * x * x + CUBIC_FIT_3 * x**3 + x4)
    if edge.bending == 0.0:
        # A string's cubic, which gives way by UNRESOLVED / h of the layer.
        share = max(1.0 - UNRESOLVED / x, LEAST_CUBIC_SHARE)
    return 1.0 / (share / math.sqrt(full * tension) + 1.0 / stiff)


@kernel
def stiffen_gently(M, k, target, tension, before, bend, share):
    """The stiffness that a clamp takes instead of k where its cable asks for `target` [N m].

    bend: its energy over its stiffness, 1 - cos(angle); tension, before: smoothed over time, now
    and at the step before. A bent spring that is made stiffer gives energy to the line: by what
    an element that was split, or a hybrid whose bending came and went, asked of it a body under a
    snapping line got hundreds of times all the energy that there was. A layer's stiffness follows
    the tension, as its root; what goes beyond comes as its bend fades.
    """
    state = scalars(M)
    if target <= k or k <= 0.0 or not 0.0 < share < 1.0:
        return target
    allowed = k
    if before > 0.0 and tension > before:
        allowed *= math.sqrt(tension / before)
    work = share * FREE_WORK * state.tolerance * state.length * state.tension_scale
    if (target - allowed) * bend <= work:
        return target
    return allowed + work / bend


@kernel
def update_clamps(I, M, share):
    """Clamps' stiffnesses by the tensions, of which `share` is the present one, the rest the past.

    They hold until the next step is made, and follow axial vibrations by their mean only: a
    stiffness that changes while the clamp is bent does work, and would feed such vibrations.
    """
    head = header(I)
    dimension = head.dimension
    axis = vector()
    along = vector()
    for body in range(head.body_count):
        if rigid_row(I, M, body) < 0:
            continue
        row = body_of(I, M, body)
        node = int(row.node)
        for side in range(2):
            edge = I[head.parent + node] if side == 0 else node + 1
            if edge == 0 or (side == 1 and row.tie != 0.0):
                row.clamp[side] = 0.0  # no cable there: the vessel or a spring holds the slope
                continue
            slope = tension_of(I, M, edge).slope
            tension = tension_of(I, M, edge).mean + (slope if side == 0 else -slope)
            row_of_edge = edge_of(I, M, edge)
            before = row.clamp_tension[side]
            row.clamp_tension[side] += share * (tension - row.clamp_tension[side])
            resolved = row_of_edge.model != MODEL_HYBRID
            target = clamp_stiffness(M, row_of_edge, row.clamp_tension[side], row.length, resolved)
            if not resolved and target > row.clamp[side]:
                inner = 2 * dimension * I[head.parent + node]
                outer = 2 * dimension * node
                q = M[head.position : head.position + 2 * dimension * head.nodes]
                axis_of(dimension, q, inner, outer, axis)
                at = dimension + (inner if side == 0 else outer)
                _length, cosine = slope_direction(dimension, q, at, axis, along)
                bend = 1.0 - cosine
                target = stiffen_gently(
                    M, row.clamp[side], target, row.clamp_tension[side], before, bend, share
                )
            row.clamp[side] = target


@kernel
def clamp_forces(dimension, k, q, at, inner, outer, reach, axis, out):
    """Add the forces of a clamp of stiffness k [N m] between the slope at word `at` and the axis.

    reach: distance of the attachments [m].
    """
    along = vector()
    length, cosine = slope_direction(dimension, q, at, axis, along)
    for i in range(dimension):
        out[at + i] -= k / length * (axis[i] - cosine * along[i])
        force = k / reach * (along[i] - cosine * axis[i])
        out[outer + i] -= force
        out[inner + i] += force


@kernel
def tie_forces(M, row, dimension, tie, q, a, node, inner, outer, out):
    """Add the forces of the spring [N m] by which a slope that no cable holds follows the axis.

    node: the first word of the slope's node, the inner or the outer one.
    """
    length = row.length
    inertia = SLOPE_INERTIA * row.mass * length * length
    for i in range(dimension):
        at = node + dimension + i
        force = tie * (q[at] - (q[outer + i] - q[inner + i]) / length)
        out[at] += force + inertia * a[at]
        out[outer + i] -= force / length
        out[inner + i] += force / length


@kernel
def add_tie(M, row, dimension, tie, ca, inner_side, D_inner, D_outer, U, L):
    """Derivatives of `tie_forces`."""
    size = 2 * dimension
    length = row.length
    slope = tie + ca * SLOPE_INERTIA * row.mass * length * length
    coupling = tie / length
    for i in range(dimension):
        d = dimension + i
        add_pair(D_inner, D_outer, U, L, size, i, i, coupling / length)
        if inner_side:
            D_inner[size * d + d] += slope
            D_inner[size * d + i] += coupling
            D_inner[size * i + d] += coupling
            U[size * d + i] -= coupling
            L[size * i + d] -= coupling
        else:
            D_outer[size * d + d] += slope
            D_outer[size * d + i] -= coupling
            D_outer[size * i + d] -= coupling
            L[size * d + i] += coupling
            U[size * i + d] += coupling


@kernel
def rigid_residual(I, M, q, v, a, tension, out, out_constraint):
    """Add the bodies' forces to those of their nodes, and set their constraint residuals."""
    head = header(I)
    dimension = head.dimension
    body = body_in_water()
    axis = body.axis
    force = body.force
    for n in range(head.body_count):
        row = rigid_row(I, M, n)
        of_body = body_at(M, row)
        if row < 0:
            continue
        node, outer, inner = attachments(I, M, of_body)
        length = of_body.length
        reach = axis_of(dimension, q, inner, outer, axis)
        bar = tension[2 * node]
        out_constraint[2 * node] = reach - length - of_body.compliance * bar
        out_constraint[2 * node + 1] = 0.0
        for side in range(2):
            k = of_body.clamp[side]
            if k != 0.0 and (side == 1 or inner > 0):
                at = dimension + (inner if side == 0 else outer)
                clamp_forces(dimension, k, q, at, inner, outer, reach, axis, out)
        near = 0.5 * (1.0 - of_body.offset)
        far = 0.5 * (1.0 + of_body.offset)
        turning = of_body.inertia / (length * length)
        middle_flow(I, M, q, v, a, inner, outer, body)
        wet = 1.0
        if head.wave_count != 0:
            middle_waves(I, M, of_body, q, inner, outer, body)
            wet_force(I, M, of_body, body)
            wet = body.water.wet
        elif head.surge != 0:
            surge_force(I, M, of_body, middle_height(dimension, q, inner, outer), body)
        else:
            flow_force(of_body, dimension, of_body.added_mass, body)
        force[dimension - 1] -= wet * (of_body.dry_weight - of_body.weight)  # buoyancy
        for i in range(dimension):
            centre = of_body.mass * (near * a[inner + i] + far * a[outer + i])
            if i == dimension - 1:
                centre += of_body.dry_weight
            pair = bar * axis[i] + turning * (a[outer + i] - a[inner + i])
            out[inner + i] += near * centre + 0.5 * force[i] - pair
            out[outer + i] += far * centre + 0.5 * force[i] + pair
        if inner == 0:
            tie_forces(M, of_body, dimension, of_body.clamp[0], q, a, 0, inner, outer, out)
        if of_body.tie != 0.0:
            tie_forces(M, of_body, dimension, of_body.tie, q, a, outer, inner, outer, out)


@kernel
def add_pair(D_inner, D_outer, U, L, size, i, j, value):
    """Add value to entry (i, j) of a term in g = r_C - r_A: rows and columns of both nodes."""
    D_inner[size * i + j] += value
    D_outer[size * i + j] += value
    U[size * i + j] -= value
    L[size * i + j] -= value


@kernel
def add_clamp(dimension, k, q, at, inner_side, reach, axis, D_inner, D_outer, U, L):
    """Second derivatives of k (1 - cos(angle)) for the slope d at word `at` of q and the axis."""
    size = 2 * dimension
    along = vector()
    length, cosine = slope_direction(dimension, q, at, axis, along)
    d_d = k / (length * length)
    d_g = k / (length * reach)
    g_g = k / (reach * reach)
    for i in range(dimension):
        for j in range(dimension):
            unit = 1.0 if i == j else 0.0
            ti = along[i]
            tj = along[j]
            bi = axis[i]
            bj = axis[j]
            cross = ti * bj + bi * tj
            dd = d_d * (cross + cosine * (unit - 3.0 * ti * tj))
            gg = g_g * (cross + cosine * (unit - 3.0 * bi * bj))
            # (1 - t t)(1 - b b): row d_i, column g_j, and its transpose.
            dg = -d_g * (unit - ti * tj - bi * bj + cosine * ti * bj)
            gd = -d_g * (unit - ti * tj - bi * bj + cosine * bi * tj)
            add_pair(D_inner, D_outer, U, L, size, i, j, gg)
            row_d = size * (dimension + i) + j
            column_d = size * i + dimension + j
            diagonal_d = size * (dimension + i) + dimension + j
            if inner_side:
                D_inner[diagonal_d] += dd
                D_inner[row_d] -= dg
                U[row_d] += dg
                D_inner[column_d] -= gd
                L[column_d] += gd
            else:
                D_outer[diagonal_d] += dd
                D_outer[row_d] += dg
                L[row_d] -= dg
                D_outer[column_d] += gd
                U[column_d] -= gd


@kernel
def rigid_jacobian(I, M, q, v, a, tension, ca, cv):
    """Add the bodies' derivatives: blocks of both nodes and those that tie them, N condensed out.

    The force on a node is a sum of terms in g and in the middle's motion; see jacobian_spatial.
    """
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    area = size * size
    body = body_in_water()
    axis = body.axis
    for n in range(head.body_count):
        row = rigid_row(I, M, n)
        of_body = body_at(M, row)
        if row < 0:
            continue
        node, outer, inner = attachments(I, M, of_body)
        parent = I[head.parent + node]
        D_inner = M[head.diagonal + area * parent : head.diagonal + area * (parent + 1)]
        D_outer = M[head.diagonal + area * node : head.diagonal + area * (node + 1)]
        U = M[head.upper + area * node : head.upper + area * (node + 1)]
        L = M[head.lower + area * node : head.lower + area * (node + 1)]
        U[:] = 0.0
        L[:] = 0.0
        length = of_body.length
        reach = axis_of(dimension, q, inner, outer, axis)
        k = of_body.clamp[0]
        if k != 0.0 and inner > 0:
            add_clamp(dimension, k, q, inner + dimension, True, reach, axis, D_inner, D_outer, U, L)
        k = of_body.clamp[1]
        if k != 0.0:
            add_clamp(
                dimension, k, q, outer + dimension, False, reach, axis, D_inner, D_outer, U, L
            )
        stiffness = 1.0 / of_body.compliance
        inverse = compliance_of(I, M, node)
        inverse.s00 = stiffness
        inverse.s01 = 0.0
        inverse.s11 = stiffness
        B = M[head.gradient + 4 * size * node : head.gradient + 4 * size * node + dimension]
        geometric = tension[2 * node] / reach
        near = 0.5 * (1.0 - of_body.offset)
        far = 0.5 * (1.0 + of_body.offset)
        mass = ca * of_body.mass
        turning = ca * of_body.inertia / (length * length)
        middle_flow(I, M, q, v, a, inner, outer, body)
        if head.wave_count != 0:
            middle_waves(I, M, of_body, q, inner, outer, body)
            wet_derivatives(I, M, of_body, 1.0 / reach, ca, cv, body)
        else:
            flow_derivatives(of_body, dimension, of_body.added_mass, 1.0 / reach, ca, cv, body)
        if inner == 0:
            k = of_body.clamp[0]
            add_tie(M, of_body, dimension, k, ca, True, D_inner, D_outer, U, L)
        if of_body.tie != 0.0:
            add_tie(M, of_body, dimension, of_body.tie, ca, False, D_inner, D_outer, U, L)
        for i in range(dimension):
            B[i] = axis[i]
            for j in range(dimension):
                value = (stiffness - geometric) * axis[i] * axis[j]
                if i == j:
                    value += geometric + turning
                add_pair(D_inner, D_outer, U, L, size, i, j, value)
                flow = 0.25 * body.by_motion[dimension * i + j]
                turn = 0.5 * body.by_axis[dimension * i + j]
                D_inner[size * i + j] += flow - turn
                U[size * i + j] += flow + turn
                L[size * i + j] += flow - turn
                D_outer[size * i + j] += flow + turn
            D_inner[size * i + i] += mass * near * near
            U[size * i + i] += mass * near * far
            L[size * i + i] += mass * near * far
            D_outer[size * i + i] += mass * far * far


@kernel
def condense_rigid(I, M, out_constraint, out):
    """Add B^T S (constraint residual) of every body: N condensed out."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    for body in range(head.body_count):
        row = rigid_row(I, M, body)
        if row < 0:
            continue
        node, outer, inner = attachments(I, M, body_at(M, row))
        z = compliance_of(I, M, node).s00 * out_constraint[2 * node]
        B = head.gradient + 4 * size * node
        for i in range(dimension):
            out[inner + i] -= z * M[B + i]
            out[outer + i] += z * M[B + i]


@kernel
def stretch_rate_rigid(I, M, x, out):
    """Gradient B of the bodies' constraints times a vector x of the nodes."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    for body in range(head.body_count):
        row = rigid_row(I, M, body)
        if row < 0:
            continue
        node, outer, inner = attachments(I, M, body_at(M, row))
        B = head.gradient + 4 * size * node
        value = 0.0
        for i in range(dimension):
            value += M[B + i] * (x[outer + i] - x[inner + i])
        out[2 * node] = value
        out[2 * node + 1] = 0.0


@kernel
def rigid_energy(I, M, row, q, v, a, tension, out):
    """Add a body's energies and what the water takes from it to Energies."""
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    body = body_in_water()
    axis = body.axis
    along = vector()
    node, outer, inner = attachments(I, M, row)
    reach = axis_of(dimension, q, inner, outer, axis)
    bar = tension[2 * node]
    out.axial += 0.5 * row.compliance * bar * bar
    k = row.clamp[0]
    if k != 0.0 and inner > 0:
        _length, cosine = slope_direction(dimension, q, inner + dimension, axis, along)
        out.bending += k * (1.0 - cosine)
    k = row.clamp[1]
    if k != 0.0:
        _length, cosine = slope_direction(dimension, q, outer + dimension, axis, along)
        out.bending += k * (1.0 - cosine)
    near = 0.5 * (1.0 - row.offset)
    far = 0.5 * (1.0 + row.offset)
    up = dimension - 1
    low = q[inner + up] + state.origin[2]
    high = q[outer + up] + state.origin[2]
    weight = row.dry_weight
    out.potential += weight * (near * low + far * high)
    if head.wave_count == 0:
        out.potential -= 0.5 * (weight - row.weight) * (low + high)
    speed = 0.0
    turn = 0.0
    for i in range(dimension):
        speed += (near * v[inner + i] + far * v[outer + i]) ** 2
        turn += ((v[outer + i] - v[inner + i]) / reach) ** 2
    out.kinetic += 0.5 * (row.mass * speed + row.inertia * turn)
    middle_flow(I, M, q, v, a, inner, outer, body)
    for i in range(dimension):
        body.velocity[i] = 0.5 * (v[inner + i] + v[outer + i])
    if head.wave_count != 0:
        middle_waves(I, M, row, q, inner, outer, body)
        wave_power(I, M, row, body, out)
        return
    for i in range(dimension):
        body.turn[i] = (v[outer + i] - v[inner + i]) / reach
    flow_energy(row, dimension, body, out)
    if head.surge != 0:
        height = middle_height(dimension, q, inner, outer)
        out.drag_power -= surge_power(I, M, row, height, body)


@kernel
def wave_power(I, M, row, body, out):
    """Add what the water of a scene with waves takes from a body, by its velocity."""
    head = header(I)
    up = head.dimension - 1
    wet_force(I, M, row, body)
    for i in range(up + 1):
        out.drag_power += body.force[i] * body.velocity[i]
    out.drag_power -= body.water.wet * lift_of(M, row) * body.velocity[up]


@kernel
def flow_energy(row, dimension, body, out):
    """Add energy of the added mass and losses to the water, by a body's axis, flow, velocity and
    turn, with or without the part of this along the axis."""
    ut, _along, sn, st = speeds(row, dimension, body)
    axis = body.axis
    velocity = body.velocity
    along = 0.0
    square = 0.0
    turning = 0.0
    stretching = 0.0
    for i in range(dimension):
        along += velocity[i] * axis[i]
        square += velocity[i] ** 2
        turning += velocity[i] * body.turn[i]
        stretching += axis[i] * body.turn[i]
    turning -= along * stretching
    out.added_mass_power += (row.added_mass - row.added_mass_axial) * along * turning
    out.kinetic += 0.5 * row.added_mass * (square - along * along)
    out.kinetic += 0.5 * row.added_mass_axial * along * along
    fn = row.drag * sn
    ft = row.drag_axial * st * ut
    for i in range(dimension):
        out.drag_power -= (fn * body.across[i] + ft * axis[i]) * velocity[i]
