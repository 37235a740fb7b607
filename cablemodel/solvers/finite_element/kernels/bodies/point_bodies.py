"""Point bodies at nodes: mass, submerged weight, drag and added mass about the node's tangent.

Drag of a point is 1/2 rho |u| (CdA_n u_n + CdA_a u_a): with equal areas along and across, that of
a sphere, whatever way the cable points. (Of its parts squared each, a body of equal areas would
feel up to 30 % less drag when it moves askew: 1.5 % of the top tension in the pay-out scene S3.)

The half-length of the bodies of Sun & Leonard 1998, section 4.1, is zero here: a point mass passes
no moment; see rigid.py for the others. In the plane the second component is the vertical one.
"""

import math

from cablemodel.solvers.finite_element.kernels.water.waves import SMALLEST, Water, wave_at, wet_at
from cablemodel.solvers.shared.access import body_of, header, scalars, vector, word_of
from cablemodel.solvers.shared.compile import kernel, own_record
from cablemodel.solvers.shared.environment import current_at, surge_at
from cablemodel.solvers.shared.layout import BODY_WORDS
from cablemodel.solvers.shared.numbers import NO_SIZE
from cablemodel.solvers.shared.record import Record, part, reals


class BodyInWater(Record):
    """A body in the water that passes it: block's coordinates, in a plane the first two of three.

    Derivatives are (dimension, dimension) by rows.
    """

    axis = reals(3, "unit vector along it")
    flow = reals(3, "velocity of the water past it", "m/s")
    across = reals(3, "part of that across its axis", "m/s")
    velocity = reals(3, "its own", "m/s")
    acceleration = reals(3, "its own, less that of the water where this accelerates", "m/s2")
    turn = reals(3, "rate of a vector of length one along its axis, or of one near it", "1/s")
    force = reals(3, "inertia minus drag", "N")
    by_motion = reals(9, "derivative of that by its motion", "N/m")
    by_axis = reals(9, "by a vector along its axis", "N/m")
    water = part(Water, "at its place: what waves and a current that changes add")


body_in_water = own_record(BodyInWater)


@kernel
def body_kinematics(I, M, node, q, v, a, body):
    """Axis, flow and acceleration of a point body; returns 1/|r'|."""
    head = header(I)
    dimension = head.dimension
    at = 2 * dimension * node
    current_at(I, M, q[at + dimension - 1], body.flow)
    norm = 0.0
    for i in range(dimension):
        norm += q[at + dimension + i] ** 2
    inverse = 1.0 / math.sqrt(norm)
    for i in range(dimension):
        body.axis[i] = q[at + dimension + i] * inverse
        body.flow[i] -= v[at + i]
        body.acceleration[i] = a[at + i]
    return inverse


@kernel
def speeds(row, dimension, body):
    """Flow and acceleration along the axis; speeds that the normal and axial drag go with [m/s].

    The whole relative speed for a point, its part across and along for a body of finite length
    (cross-flow principle). Writes `across`.
    """
    ut = 0.0
    along = 0.0
    u2 = 0.0
    for i in range(dimension):
        ut += body.flow[i] * body.axis[i]
        along += body.acceleration[i] * body.axis[i]
        u2 += body.flow[i] ** 2
    un2 = 0.0
    for i in range(dimension):
        body.across[i] = body.flow[i] - ut * body.axis[i]
        un2 += body.across[i] ** 2
    if row.length > 0.0:
        return ut, along, math.sqrt(un2), abs(ut)
    speed = math.sqrt(u2)
    return ut, along, speed, speed


@kernel
def flow_force(row, dimension, inertia, body):
    """Inertia minus drag [N] into `force`, from axis, flow and acceleration.

    ``inertia`` is the mass that resists acceleration across the axis: its own and the added one.
    """
    ut, along, sn, st = speeds(row, dimension, body)
    fn = row.drag * sn
    ft = row.drag_axial * st * ut
    ft += (row.added_mass - row.added_mass_axial) * along
    for i in range(dimension):
        body.force[i] = inertia * body.acceleration[i] - fn * body.across[i] - ft * body.axis[i]


@kernel
def flow_derivatives(row, dimension, inertia, ig, ca, cv, body):
    """Derivatives of `flow_force` into `by_motion` and `by_axis`.

    ca and cv: those of acceleration and velocity for a change of position; ig: inverse length of
    the vector along the axis.
    """
    ut, along, sn, st = speeds(row, dimension, body)
    axis = body.axis
    across = body.across
    finite = row.length > 0.0
    inverse = 1.0 / max(sn, NO_SIZE)
    cn = row.drag
    ct = row.drag_axial
    added = row.added_mass - row.added_mass_axial
    e_tn = -ig * (ct * st - cn * sn)
    e_p = -ig * (ct * st * ut - cn * sn * ut + added * along)
    e_nn = 0.0
    if finite:
        e_tn -= ig * ct * st
        e_nn = ig * cn * ut * inverse
    for i in range(dimension):
        for j in range(dimension):
            tt = axis[i] * axis[j]
            p = -tt
            own = 0.0
            if i == j:
                p += 1.0
                own = ca * inertia
            if finite:
                drag = cn * (sn * p + inverse * across[i] * across[j]) + 2.0 * ct * st * tt
            else:
                drag = cn * sn * p + ct * st * tt
                drag += (cn * across[i] + ct * ut * axis[i]) * body.flow[j] * inverse
            at = dimension * i + j
            body.by_motion[at] = own + cv * drag - ca * added * tt
            body.by_axis[at] = (
                e_tn * axis[i] * across[j]
                + e_p * p
                + e_nn * across[i] * across[j]
                - added * ig * axis[i] * (body.acceleration[j] - along * axis[j])
            )


@kernel
def lift_of(M, row):
    """Buoyancy of a wet body [N]: weight in air less the submerged one."""
    state = scalars(M)
    return row.mass * state.gravity - row.weight


@kernel
def surface_band(M, row, rise):
    """Half of the band around the surface in which a body becomes wet [m]: a sphere of its volume,
    and what it stands across. rise: height of its upper end over its lower one [m]."""
    state = scalars(M)
    volume = max(0.0, lift_of(M, row)) / (state.gravity * state.water_density)
    radius = math.pow(0.75 * volume / math.pi, 1.0 / 3.0)
    return max(SMALLEST, radius + 0.5 * abs(rise))


@kernel
def add_waves(I, M, row, x, y, z, rise, body):
    """Take the waves into a body's flow and acceleration at a place, and write its `water`.

    rise: height of its upper end over its lower one [m].
    """
    head = header(I)
    half = surface_band(M, row, rise)
    slot = 3 * head.capacity + (word_of(M, row) - head.bodies) // BODY_WORDS
    water = body.water
    wet_at(wave_at(I, M, x, y, z, half, slot, water), half, water)
    if head.surge != 0:
        surge = vector()
        surge_at(I, M, z, surge)
        for i in range(head.dimension):
            water.acceleration[i] += surge[i]
    for i in range(head.dimension):
        body.flow[i] += water.velocity[i]
        body.acceleration[i] -= water.acceleration[i]


@kernel
def wet_force(I, M, row, body):
    """`flow_force` of a body in waves, without the mass of its own: the wet share, less the
    Froude-Krylov force; `add_waves` has been called."""
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    water = body.water
    flow_force(row, dimension, row.added_mass, body)
    mass = lift_of(M, row) / state.gravity
    for i in range(dimension):
        body.force[i] = water.wet * (body.force[i] - mass * water.acceleration[i])


@kernel
def surge_force(I, M, row, z, body):
    """`flow_force` of a body at height z in a current that changes in time, without the mass of
    its own, less the Froude-Krylov force."""
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    push = body.water.acceleration
    surge_at(I, M, z, push)
    for i in range(dimension):
        body.acceleration[i] -= push[i]
    flow_force(row, dimension, row.added_mass, body)
    mass = lift_of(M, row) / state.gravity
    for i in range(dimension):
        body.force[i] -= mass * push[i]


@kernel
def surge_power(I, M, row, z, body):
    """What accelerated water gives a body at height z, by its velocity and axis [W]."""
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    push = body.water.acceleration
    surge_at(I, M, z, push)
    along = 0.0
    moving = 0.0
    power = 0.0
    for i in range(dimension):
        along += push[i] * body.axis[i]
        moving += body.velocity[i] * body.axis[i]
        power += push[i] * body.velocity[i]
    power *= lift_of(M, row) / state.gravity + row.added_mass
    return power + (row.added_mass_axial - row.added_mass) * along * moving


@kernel
def wet_derivatives(I, M, row, ig, ca, cv, body):
    """`flow_derivatives` of a body in waves, without the mass of its own."""
    head = header(I)
    dimension = head.dimension
    water = body.water
    flow_derivatives(row, dimension, row.added_mass, ig, ca, cv, body)
    for n in range(dimension * dimension):
        body.by_motion[n] *= water.wet
        body.by_axis[n] *= water.wet
    body.by_motion[dimension * dimension - 1] -= lift_of(M, row) * water.slope


@kernel
def body_residual(I, M, q, v, a, out):
    """Add inertia, weight and minus drag of every body to the forces of its node."""
    head = header(I)
    dimension = head.dimension
    body = body_in_water()
    for n in range(head.body_count):
        row = body_of(I, M, n)
        node = int(row.node)
        if node < 0 or row.length > 0.0:  # still on the drum, or in rigid.py
            continue
        body_kinematics(I, M, node, q, v, a, body)
        at = 2 * dimension * node
        force = body.force
        if head.wave_count != 0:
            add_waves(I, M, row, q[at], q[at + 1], q[at + dimension - 1], 0.0, body)
            wet_force(I, M, row, body)
            for i in range(dimension):
                force[i] += row.mass * a[at + i]
            force[dimension - 1] += (1.0 - body.water.wet) * lift_of(M, row)
        elif head.surge != 0:
            surge_force(I, M, row, q[at + dimension - 1], body)
            for i in range(dimension):
                force[i] += row.mass * a[at + i]
        else:
            flow_force(row, dimension, row.mass + row.added_mass, body)
        for i in range(dimension):
            out[at + i] += force[i]
        out[at + dimension - 1] += row.weight


@kernel
def body_jacobian(I, M, q, v, a, ca, cv):
    """Add the bodies' derivatives to the diagonal blocks of their nodes."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    body = body_in_water()
    for n in range(head.body_count):
        row = body_of(I, M, n)
        node = int(row.node)
        if node < 0 or row.length > 0.0:
            continue
        ig = body_kinematics(I, M, node, q, v, a, body)
        if head.wave_count != 0:
            at = size * node
            add_waves(I, M, row, q[at], q[at + 1], q[at + dimension - 1], 0.0, body)
            wet_derivatives(I, M, row, ig, ca, cv, body)
            for i in range(dimension):
                body.by_motion[(dimension + 1) * i] += ca * row.mass
        else:
            flow_derivatives(row, dimension, row.mass + row.added_mass, ig, ca, cv, body)
        D = M[head.diagonal + size * size * node : head.diagonal + size * size * (node + 1)]
        for i in range(dimension):
            for j in range(dimension):
                D[size * i + j] += body.by_motion[dimension * i + j]
                D[size * i + dimension + j] += body.by_axis[dimension * i + j]
