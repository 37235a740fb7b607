"""Energies of a state, and the powers by which they change."""

import math

from cablemodel.solvers.finite_element.kernels.bodies.body_clamps import body_clamp_energy
from cablemodel.solvers.finite_element.kernels.bodies.point_bodies import (
    add_waves,
    body_in_water,
    body_kinematics,
    surge_power,
)
from cablemodel.solvers.finite_element.kernels.bodies.rigid import (
    flow_energy,
    rigid_energy,
    rigid_row,
    wave_power,
)
from cablemodel.solvers.finite_element.kernels.bodies.vessel_clamp import clamp_energy
from cablemodel.solvers.finite_element.kernels.element.damping import damping_in
from cablemodel.solvers.finite_element.kernels.element.strain import energy_aside
from cablemodel.solvers.finite_element.kernels.element.tables import (
    D0,
    D1,
    D2,
    D3,
    E0,
    E1,
    E2,
    E3,
    H0,
    H1,
    H2,
    H3,
    MASS,
    P1,
    WEIGHT,
    WEIGHT_P2,
)
from cablemodel.solvers.finite_element.kernels.floor.floor_outputs import floor_energy
from cablemodel.solvers.finite_element.kernels.mesh.body_passage import exchange_rates
from cablemodel.solvers.finite_element.kernels.mesh.payout import rate_words
from cablemodel.solvers.finite_element.kernels.outputs.summary import end_forces
from cablemodel.solvers.finite_element.kernels.water.waves import (
    buoyancy,
    displaced,
    element_water,
)
from cablemodel.solvers.shared.access import (
    body_at,
    body_of,
    edge_of,
    element_points,
    energies_at,
    header,
    scalars,
    tension_of,
    vector,
    winch_of,
)
from cablemodel.solvers.shared.compile import kernel, own_record, view
from cablemodel.solvers.shared.environment import current_at, surge_at
from cablemodel.solvers.shared.layout import POINT_WORDS
from cablemodel.solvers.shared.record import Record, reals
from cablemodel.solvers.shared.strain import strain_and_slope

HALF_OF_P2 = 0.1  # half of the mean of P2^2


class CableInWater(Record):
    """Cable at a Gauss point of its element: block's coordinates, in a plane two of three."""

    tangent = reals(3, "unit vector")
    bend = reals(3, "r'' by arc length", "1/m")
    velocity = reals(3, "of the cable", "m/s")
    acceleration = reals(3, "of it", "m/s2")
    water = reals(3, "velocity of the water", "m/s")
    flow = reals(3, "velocity of the water past it", "m/s")


cable_in_water = own_record(CableInWater)


@kernel
def energies(I, M, out):
    """Energies [J] and powers [W] of the present state, by the elements' own rules of quadrature:
    an Energies.

    Where cable is folded within an element no other rule sees what its equations hold: with five
    points the energy of the third strain mode grew by a tenth of all that went through the line.

    The power lost to drag is less by what a current that changes in time gives as it accelerates.
    With waves there is no added mass in the kinetic energy and nothing in `added_mass_power`, and
    `drag_power` has all forces of the water: drag, buoyancy, inertia.

    Morison's force -ma (I - t t^T) a works at the rate -d/dt(ma |v_n|^2 / 2) - ma (v.t)(v.t_dot):
    the second part is what the water takes, or gives, where cable turns while it slides. In whips
    and fast tows it is a quarter of all that goes through the line.
    """
    head = header(I)
    size = 2 * head.dimension
    count = size * head.nodes
    found = energies_at(out, 0)
    out[:] = 0.0
    end_forces(I, M)
    if head.floor_kind != 0:
        floor_energy(I, M, found)
    for node in range(1, head.nodes):
        if I[head.joint + node] == 0:
            cable_energy(I, M, node, found)
    q = view(M, head.position, count)
    v = view(M, head.velocity, count)
    a = view(M, head.acceleration, count)
    passing_body = head.rigid > 0 and winch_of(I, M, 0).passing_body != 0.0
    for body in range(head.body_count):
        row = body_of(I, M, body)
        if row.node < 0.0:
            continue
        if row.length == 0.0:
            point_energy(I, M, row, q, v, a, found)
            continue
        tension = view(M, head.tension, 2 * head.nodes)
        if passing_body:
            exchange_rates(I, M, v, a)
        rigid_energy(I, M, body_at(M, rigid_row(I, M, body)), q, v, a, tension, found)
        if passing_body:
            exchange_rates(I, M, v, a)
    if head.payout != 0:
        found.bending += clamp_energy(I, M, q)
    if head.closure_count != 0:
        found.bending += body_clamp_energy(I, M, q)
    for i in range(head.dimension):
        found.vessel_power += M[head.residual + i] * M[head.velocity + i]


@kernel
def place_cable(I, M, node, p, point):
    """Fill CableInWater at Gauss point p of the element above a node, but for the water, with a
    tangent that is as long as the cable is stretched; returns the height there and that length."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    parent = I[head.parent + node]
    h = edge_of(I, M, node).length
    q0 = head.position + size * parent
    q1 = head.position + size * node
    v0, a0 = rate_words(I, M, parent)
    v1, a1 = rate_words(I, M, node)
    height = 0.0
    g2 = 0.0
    for i in range(dimension):
        d = dimension + i
        a = M[q0 + i]
        b = h * M[q0 + d]
        c = M[q1 + i]
        f = h * M[q1 + d]
        height = a * H0[p] + b * H1[p] + c * H2[p] + f * H3[p]
        point.tangent[i] = (a * D0[p] + b * D1[p] + c * D2[p] + f * D3[p]) / h
        point.bend[i] = (a * E0[p] + b * E1[p] + c * E2[p] + f * E3[p]) / (h * h)
        point.velocity[i] = M[v0 + i] * H0[p] + M[v1 + i] * H2[p]
        point.velocity[i] += h * (M[v0 + d] * H1[p] + M[v1 + d] * H3[p])
        point.acceleration[i] = M[a0 + i] * H0[p] + M[a1 + i] * H2[p]
        point.acceleration[i] += h * (M[a0 + d] * H1[p] + M[a1 + d] * H3[p])
        g2 += point.tangent[i] * point.tangent[i]
    return height, math.sqrt(g2)


@kernel
def cable_energy(I, M, node, found):
    """Add what the element above a node has and loses."""
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    size = 2 * dimension
    points = element_points(I, M, 0)
    point = cable_in_water()
    tangent = point.tangent
    velocity = point.velocity
    flow = point.flow
    parent = I[head.parent + node]
    edge = edge_of(I, M, node)
    h = edge.length
    v0, _a0 = rate_words(I, M, parent)
    v1, _a1 = rate_words(I, M, node)
    mean = tension_of(I, M, node).mean
    slope = tension_of(I, M, node).slope
    dry = edge.added_mass if head.wave_count != 0 else 0.0
    found.kinetic += 0.5 * h * (edge.mass - dry) * square(M, v0, v1, dimension, h)
    if head.wave_count != 0:
        q0 = head.position + size * parent
        q1 = head.position + size * node
        element_water(I, M, points, edge, view(M, q0, size), view(M, q1, size))
    e2 = 0.0
    for p in range(3):
        weight = h * WEIGHT[p]
        height, g = place_cable(I, M, node, p, point)
        if head.wave_count == 0:
            current_at(I, M, height, point.water)
        else:
            for i in range(dimension):
                point.water[i] = points.water[POINT_WORDS * i + p]
        along = 0.0
        vt = 0.0
        ut = 0.0
        for i in range(dimension):
            tangent[i] /= g
            along += point.bend[i] * tangent[i]
            vt += velocity[i] * tangent[i]
            flow[i] = point.water[i] - velocity[i]
            ut += flow[i] * tangent[i]
        curvature = 0.0
        un2 = 0.0
        for i in range(dimension):
            curvature += ((point.bend[i] - along * tangent[i]) / g) ** 2
            un2 += (flow[i] - ut * tangent[i]) ** 2
        un = math.sqrt(un2)
        if head.wave_count == 0:
            found.kinetic -= 0.5 * weight * edge.added_mass * vt * vt
            found.potential += weight * edge.weight * (height + state.origin[2])
        # Complementary energy subtracted from T strain: exact for a curved law too.
        tension = mean + slope * P1[p]
        found.axial += weight * strain_energy(M, edge, tension)
        if edge.yields != 0.0:
            found.axial += weight * energy_aside(edge, tension)
        found.bending += 0.5 * weight * edge.bending * curvature
        if head.wave_count != 0:
            cable_in_waves(I, M, points, p, edge, weight, g, un, ut, height, point, found)
        elif head.drag != 0:
            cable_in_current(I, M, node, p, weight, g, un, ut, height, point, found)
        e2 += WEIGHT_P2[p] * (g - 1.0)
    _d0, _d1, lost = damping_in(I, M, node)
    found.damping_power += h * lost
    e2 = 5.0 * e2 - edge.third_rest / edge.stabilisation
    found.axial += HALF_OF_P2 * h * edge.stabilisation * e2 * e2


@kernel
def cable_in_current(I, M, node, p, weight, g, un, ut, height, point, found):
    """Add what water without waves takes from a piece of the cable above a node; see `energies`.

    weight: length of the piece [m], at Gauss point p; g: by how much it is stretched; un, ut: speed
    of the water past it across and along it [m/s]; height: of the piece [m].
    """
    head = header(I)
    dimension = head.dimension
    tangent = point.tangent
    velocity = point.velocity
    edge = edge_of(I, M, node)
    h = edge.length
    root = math.sqrt(g)
    fn = root * edge.drag_normal * un
    ft = root * edge.drag_tangential * abs(ut) * ut
    for i in range(dimension):
        force = fn * (point.flow[i] - ut * tangent[i]) + ft * tangent[i]
        found.drag_power -= weight * force * velocity[i]
    if head.surge != 0:
        surge = vector()
        surge_at(I, M, height, surge)
        turning = 0.0
        for i in range(dimension):
            turning += surge[i] * tangent[i]
        for i in range(dimension):
            force = displaced(I, M, edge) * surge[i]
            force += edge.added_mass * (surge[i] - turning * tangent[i])
            found.drag_power -= weight * force * velocity[i]
    v0, _a0 = rate_words(I, M, I[head.parent + node])
    v1, _a1 = rate_words(I, M, node)
    along = 0.0  # v . t
    turning = 0.0  # v . dv/ds, then v . t_dot
    stretching = 0.0
    for i in range(dimension):
        d = dimension + i
        rate = (M[v0 + i] * D0[p] + M[v1 + i] * D2[p]) / h
        rate += M[v0 + d] * D1[p] + M[v1 + d] * D3[p]
        along += velocity[i] * tangent[i]
        turning += velocity[i] * rate
        stretching += tangent[i] * rate
    turning = (turning - along * stretching) / g
    found.added_mass_power += weight * edge.added_mass * along * turning


@kernel
def cable_in_waves(I, M, points, p, edge, weight, g, un, ut, height, point, found):
    """Add energies of a piece of cable, and what the water takes from it; see `energies`.

    weight: length of the piece [m], at Gauss point p; points: its element's ElementPoints,
    for which `element_water` has been called.
    """
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    tangent = point.tangent
    velocity = point.velocity
    acceleration = point.acceleration
    mass = edge.mass - edge.added_mass
    at = 0.0
    wt = 0.0
    for i in range(dimension):
        at += acceleration[i] * tangent[i]
        wt += points.water_acceleration[POINT_WORDS * i + p] * tangent[i]
    found.potential += weight * mass * state.gravity * (height + state.origin[2])
    added = edge.added_mass
    mass_of_water = displaced(I, M, edge)
    fn = math.sqrt(g) * edge.drag_normal * un
    ft = math.sqrt(g) * edge.drag_tangential * abs(ut) * ut
    power = buoyancy(M, edge) * velocity[dimension - 1]
    drag = 0.0
    for i in range(dimension):
        across = point.flow[i] - ut * tangent[i]
        drag += (fn * across + ft * tangent[i]) * velocity[i]
        push = points.water_acceleration[POINT_WORDS * i + p]
        force = mass_of_water * push
        force += added * (push - wt * tangent[i] - acceleration[i] + at * tangent[i])
        power += force * velocity[i]
    found.drag_power -= weight * (points.wet[p] * power + points.drag[p] * drag)


@kernel
def point_energy(I, M, row, q, v, a, found):
    """Add what a point body has and loses."""
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    node = int(row.node)
    at = 2 * dimension * node
    body = body_in_water()
    speed = 0.0
    for i in range(dimension):
        speed += v[at + i] ** 2
    found.kinetic += 0.5 * row.mass * speed
    height = q[at + dimension - 1] + state.origin[2]
    body_kinematics(I, M, node, q, v, a, body)
    for i in range(dimension):
        body.velocity[i] = v[at + i]
    if head.wave_count != 0:
        found.potential += row.mass * state.gravity * height
        add_waves(I, M, row, q[at], q[at + 1], q[at + dimension - 1], 0.0, body)
        wave_power(I, M, row, body, found)
        return
    found.potential += row.weight * height
    slope = view(q, at + dimension, dimension)
    rate = view(v, at + dimension, dimension)
    square_of_slope = 0.0
    for i in range(dimension):
        square_of_slope += slope[i] ** 2
    for i in range(dimension):
        body.turn[i] = rate[i] / math.sqrt(square_of_slope)
    flow_energy(row, dimension, body, found)
    if head.surge != 0:
        found.drag_power -= surge_power(I, M, row, q[at + dimension - 1], body)


@kernel
def square(M, v0, v1, dimension, h):
    """Mean of |v|^2 over an element, from the words of its nodes' velocities: the exact mass's."""
    total = 0.0
    for i in range(dimension):
        d = dimension + i
        a = M[v0 + i]
        b = h * M[v0 + d]
        c = M[v1 + i]
        f = h * M[v1 + d]
        total += a * (MASS[0, 0] * a + 2.0 * (MASS[0, 1] * b + MASS[0, 2] * c + MASS[0, 3] * f))
        total += b * (MASS[1, 1] * b + 2.0 * (MASS[1, 2] * c + MASS[1, 3] * f))
        total += c * (MASS[2, 2] * c + 2.0 * MASS[2, 3] * f) + MASS[3, 3] * f * f
    return total


@kernel
def strain_energy(M, edge, tension):
    """Strain energy per unit length [J/m]: T strain(T) minus the integral of strain dT."""
    low = edge.tension_low
    high = edge.tension_high
    offset = int(edge.strain_offset)
    terms = int(edge.strain_terms)
    strain, slope = strain_and_slope(M, tension, low, high, offset, terms)
    t = min(max(tension, low), high)
    at_limit, slope = strain_and_slope(M, t, low, high, offset, terms)
    integral = 0.0
    for n in range(terms - 1, -1, -1):
        integral = (integral + M[offset + n] / (n + 2)) * t
    integral *= t
    beyond = tension - t
    return tension * strain - integral - beyond * (at_limit + 0.5 * slope * beyond)
