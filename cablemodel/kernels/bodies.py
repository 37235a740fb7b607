"""Point bodies at nodes: mass, submerged weight, drag and added mass about the node's tangent.

Drag of a point is 1/2 rho |u| (CdA_n u_n + CdA_a u_a): with equal areas along and across, that of
a sphere, whatever way the cable points. (Of its parts squared each, a body of equal areas would
feel up to 30 % less drag when it moves askew: 1.5 % of the top tension in the pay-out scene S3.)

The half-length of the bodies of Sun & Leonard 1998, section 4.1, is zero here: a point mass passes
no moment; see rigid.py for the others. In the plane the second component is the vertical one.
"""

import math

from .access import body_of, header, scalars, word_of
from .compile import kernel
from .environment import current_at, surge_at
from .layout import (
    BODY_WORDS,
)
from .waves import P_ACCELERATION, P_SLOPE, P_VELOCITY, P_WET, SMALLEST, wave_at, wet_at


@kernel
def body_kinematics(I, M, node, q, v, a, w):
    """t (w[0:3]), relative water velocity (w[3:6]), acceleration (w[6:9]); returns 1/|r'|."""
    head = header(I)
    dimension = head.dimension
    at = 2 * dimension * node
    current_at(I, M, q[at + dimension - 1], w[3:6])
    norm = 0.0
    for i in range(dimension):
        norm += q[at + dimension + i] ** 2
    inverse = 1.0 / math.sqrt(norm)
    for i in range(3):
        w[i] = 0.0
        w[6 + i] = 0.0
    for i in range(dimension):
        w[i] = q[at + dimension + i] * inverse
        w[3 + i] -= v[at + i]
        w[6 + i] = a[at + i]
    if dimension == 2:
        w[5] = 0.0
    return inverse


@kernel
def speeds(M, row, dimension, w):
    """Flow and acceleration along the axis; speeds that the normal and axial drag go with [m/s].

    The whole relative speed for a point, its part across and along for a body of finite length
    (cross-flow principle). The flow across goes into w[9:12].
    """
    ut = 0.0
    along = 0.0
    u2 = 0.0
    for i in range(dimension):
        ut += w[3 + i] * w[i]
        along += w[6 + i] * w[i]
        u2 += w[3 + i] ** 2
    un2 = 0.0
    for i in range(dimension):
        w[9 + i] = w[3 + i] - ut * w[i]
        un2 += w[9 + i] ** 2
    if row.length > 0.0:
        return ut, along, math.sqrt(un2), abs(ut)
    speed = math.sqrt(u2)
    return ut, along, speed, speed


@kernel
def flow_force(M, row, dimension, inertia, w):
    """Inertia minus drag [N] into w[12:15], from axis, relative flow, acceleration in w[0:9].

    ``inertia`` is the mass that resists acceleration across the axis: its own and the added one.
    """
    ut, along, sn, st = speeds(M, row, dimension, w)
    fn = row.drag * sn
    ft = row.drag_axial * st * ut
    ft += (row.added_mass - row.added_mass_axial) * along
    for i in range(dimension):
        w[12 + i] = inertia * w[6 + i] - fn * w[9 + i] - ft * w[i]


@kernel
def flow_derivatives(M, row, dimension, inertia, ig, ca, cv, w):
    """Derivatives of `flow_force`, (dimension, dimension) each, from w[0:9].

    w[12:21]: for the motion, ca and cv being those of acceleration and velocity for a change of
    position; w[21:30]: for a vector along the axis, whose inverse length is ig.
    """
    ut, along, sn, st = speeds(M, row, dimension, w)
    finite = row.length > 0.0
    inverse = 1.0 / max(sn, 1e-30)
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
            tt = w[i] * w[j]
            p = -tt
            own = 0.0
            if i == j:
                p += 1.0
                own = ca * inertia
            if finite:
                drag = cn * (sn * p + inverse * w[9 + i] * w[9 + j]) + 2.0 * ct * st * tt
            else:
                drag = cn * sn * p + ct * st * tt
                drag += (cn * w[9 + i] + ct * ut * w[i]) * w[3 + j] * inverse
            at = dimension * i + j
            w[12 + at] = own + cv * drag - ca * added * tt
            w[21 + at] = (
                e_tn * w[i] * w[9 + j]
                + e_p * p
                + e_nn * w[9 + i] * w[9 + j]
                - added * ig * w[i] * (w[6 + j] - along * w[j])
            )


@kernel
def lift_of(M, row):
    """Buoyancy of a wet body [N]: weight in air less the submerged one."""
    state = scalars(M)
    return row.mass * state.gravity - row.weight


@kernel
def add_waves(I, M, row, x, y, z, rise, w):
    """Take the waves into relative flow and acceleration, w[3:9], of a body at a place.

    rise [m]: height of its upper end over its lower one. The band around the surface is a sphere
    of the body's volume, and what it stands across. Leaves the point of `wave_at` and `wet_at`.
    """
    head = header(I)
    state = scalars(M)
    volume = max(0.0, lift_of(M, row)) / (state.gravity * state.water_density)
    radius = math.pow(0.75 * volume / math.pi, 1.0 / 3.0)
    half = max(SMALLEST, radius + 0.5 * abs(rise))
    slot = 3 * head.capacity + (word_of(M, row) - head.bodies) // BODY_WORDS
    wet_at(I, M, wave_at(I, M, x, y, z, half, slot), half)
    at = head.motion
    if head.surge != 0:
        surge_at(I, M, z, w[9:12])
        for i in range(head.dimension):
            M[at + P_ACCELERATION + i] += w[9 + i]
    for i in range(head.dimension):
        w[3 + i] += M[at + P_VELOCITY + i]
        w[6 + i] -= M[at + P_ACCELERATION + i]


@kernel
def wet_force(I, M, row, w):
    """`flow_force` of a body in waves into w[12:15], without the mass of its own: the wet share,
    less the Froude-Krylov force; `add_waves` has been called."""
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    at = head.motion
    flow_force(M, row, dimension, row.added_mass, w)
    mass = lift_of(M, row) / state.gravity
    for i in range(dimension):
        w[12 + i] = M[at + P_WET] * (w[12 + i] - mass * M[at + P_ACCELERATION + i])


@kernel
def surge_force(I, M, row, z, w):
    """`flow_force` of a body at height z in a current that changes in time into w[12:15], without
    the mass of its own, less the Froude-Krylov force."""
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    water = M[head.motion + P_ACCELERATION : head.motion + P_ACCELERATION + 3]
    surge_at(I, M, z, water)
    for i in range(dimension):
        w[6 + i] -= water[i]
    flow_force(M, row, dimension, row.added_mass, w)
    mass = lift_of(M, row) / state.gravity
    for i in range(dimension):
        w[12 + i] -= mass * water[i]


@kernel
def surge_power(I, M, row, z, w):
    """What accelerated water gives a body at height z that moves at w[12:15], axis w[0:3] [W]."""
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    water = M[head.motion + P_ACCELERATION : head.motion + P_ACCELERATION + 3]
    surge_at(I, M, z, water)
    along = 0.0
    moving = 0.0
    power = 0.0
    for i in range(dimension):
        along += water[i] * w[i]
        moving += w[12 + i] * w[i]
        power += water[i] * w[12 + i]
    power *= lift_of(M, row) / state.gravity + row.added_mass
    return power + (row.added_mass_axial - row.added_mass) * along * moving


@kernel
def wet_derivatives(I, M, row, ig, ca, cv, w):
    """`flow_derivatives` of a body in waves, without the mass of its own."""
    head = header(I)
    dimension = head.dimension
    at = head.motion
    flow_derivatives(M, row, dimension, row.added_mass, ig, ca, cv, w)
    for n in range(dimension * dimension):
        w[12 + n] *= M[at + P_WET]
        w[21 + n] *= M[at + P_WET]
    w[12 + dimension * dimension - 1] -= lift_of(M, row) * M[at + P_SLOPE]


@kernel
def body_residual(I, M, q, v, a, out):
    """Add inertia, weight and minus drag of every body to the forces of its node."""
    head = header(I)
    dimension = head.dimension
    w = M[head.motion + 16 : head.motion + 46]
    for body in range(head.body_count):
        row = body_of(I, M, body)
        node = int(row.node)
        if node < 0 or row.length > 0.0:  # still on the drum, or in rigid.py
            continue
        body_kinematics(I, M, node, q, v, a, w)
        at = 2 * dimension * node
        if head.wave_count != 0:
            add_waves(I, M, row, q[at], q[at + 1], q[at + dimension - 1], 0.0, w)
            wet_force(I, M, row, w)
            for i in range(dimension):
                w[12 + i] += row.mass * a[at + i]
            dry = 1.0 - M[head.motion + P_WET]
            w[12 + dimension - 1] += dry * lift_of(M, row)
        elif head.surge != 0:
            surge_force(I, M, row, q[at + dimension - 1], w)
            for i in range(dimension):
                w[12 + i] += row.mass * a[at + i]
        else:
            flow_force(M, row, dimension, row.mass + row.added_mass, w)
        for i in range(dimension):
            out[at + i] += w[12 + i]
        out[at + dimension - 1] += row.weight


@kernel
def body_jacobian(I, M, q, v, a, ca, cv):
    """Add the bodies' derivatives to the diagonal blocks of their nodes."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    w = M[head.motion + 16 : head.motion + 46]
    for body in range(head.body_count):
        row = body_of(I, M, body)
        node = int(row.node)
        if node < 0 or row.length > 0.0:
            continue
        ig = body_kinematics(I, M, node, q, v, a, w)
        if head.wave_count != 0:
            at = size * node
            add_waves(I, M, row, q[at], q[at + 1], q[at + dimension - 1], 0.0, w)
            wet_derivatives(I, M, row, ig, ca, cv, w)
            for i in range(dimension):
                w[12 + (dimension + 1) * i] += ca * row.mass
        else:
            flow_derivatives(M, row, dimension, row.mass + row.added_mass, ig, ca, cv, w)
        D = M[head.diagonal + size * size * node : head.diagonal + size * size * (node + 1)]
        for i in range(dimension):
            for j in range(dimension):
                D[size * i + j] += w[12 + dimension * i + j]
                D[size * i + dimension + j] += w[21 + dimension * i + j]
