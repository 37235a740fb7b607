"""What is read off a state: stations along the cable, forces at the ends, energies, extremes."""

import math

from .access import (
    body_at,
    body_of,
    constraint_of,
    edge_of,
    header,
    scalars,
    station_at,
    summary_at,
    winch_of,
)
from .bodies import add_waves, body_kinematics, surge_power
from .clamp_layer import add_layer_shape
from .compile import kernel, view
from .environment import add_layer_motion, current_at, surge_at
from .floor_outputs import floor_energy, floor_summary, lying_gap
from .floor_surface import gap_at
from .layout import (
    BY_SPRING,
    ENERGY_WORDS,
    GAUSS_WORDS,
    STATION_WORDS,
)
from .passing import exchange_rates, overhang
from .payout import velocity_word
from .rigid import axis_of, flow_energy, rigid_energy, rigid_row, wave_power
from .slack import read_slack
from .strain import strain_and_slope
from .system import residual, set_time
from .tables import (
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
from .vessel_clamp import add_clamp_moment, clamp_energy
from .waves import ACCELERATION, DRAG, VELOCITY, WET, buoyancy, displaced, element_water


@kernel
def to_earth(I, M, local, at, out, to, origin):
    """A vector (or with origin = 1 a point) in the block's coordinates into the earth frame."""
    head = header(I)
    state = scalars(M)
    if head.dimension == 3:
        out[to] = local[at]
        out[to + 1] = local[at + 1]
        out[to + 2] = local[at + 2]
    else:
        out[to] = state.plane[0] * local[at]
        out[to + 1] = state.plane[1] * local[at]
        out[to + 2] = local[at + 1]
    if origin != 0:
        for i in range(3):
            out[to + i] += state.origin[i]


@kernel
def way_from_tow_point(I, M, w):
    """Where the elements begin, from the tow point, and its rate, earth frame, into w[0:6].

    0 but for a clamp past which cable runs (`clamp_layer.py`). w: 15 words.
    """
    head = header(I)
    state = scalars(M)
    for i in range(15):
        w[i] = 0.0
    if constraint_of(I, M, 0).clamped == BY_SPRING:
        add_layer_motion(I, M, state.time, w[6:15])
        to_earth(I, M, w, 6, w, 0, 0)
        to_earth(I, M, w, 6 + head.dimension, w, 3, 0)


@kernel
def end_forces(I, M):
    """Residual of the present state into the workspace: the supports' forces at their nodes."""
    head = header(I)
    state = scalars(M)
    count = 2 * head.dimension * head.nodes
    set_time(I, M, state.time)
    residual(
        I,
        M,
        M[head.position : head.position + count],
        M[head.velocity : head.velocity + count],
        M[head.acceleration : head.acceleration + count],
        M[head.tension : head.tension + 2 * head.nodes],
        M[head.residual : head.residual + count],
        M[head.constraint_residual : head.constraint_residual + 2 * head.nodes],
    )


@kernel
def support_force(I, M, node, out):
    """Force and moment (6 words, earth frame) that the support exerts on the cable at a node.

    `end_forces` has been called. The moment is r' x (force conjugate to r').
    """
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    w = M[head.motion + 16 : head.motion + 28]
    forces = M[head.residual + size * node : head.residual + size * (node + 1)]
    q = M[head.position + size * node : head.position + size * (node + 1)]
    to_earth(I, M, forces, 0, out, 0, 0)
    to_earth(I, M, q, dimension, w, 0, 0)
    to_earth(I, M, forces, dimension, w, 3, 0)
    if node == 0 and head.payout != 0:
        # A spring's moment is no reaction: it is among the forces that the residual balances.
        moment = M[head.motion + 28 : head.motion + 28 + size]
        moment[:] = 0.0
        add_clamp_moment(I, M, M[head.position : head.position + size], moment)
        for i in range(dimension):
            moment[dimension + i] = M[head.residual + dimension + i] - moment[dimension + i]
        to_earth(I, M, moment, dimension, w, 3, 0)
        to_earth(I, M, q, dimension, w, 0, 0)
    out[3] = w[1] * w[5] - w[2] * w[4]
    out[4] = w[2] * w[3] - w[0] * w[5]
    out[5] = w[0] * w[4] - w[1] * w[3]
    if node == 0:
        # The force acts where the elements begin, beside the tow point.
        way = M[head.motion + 28 : head.motion + 43]
        way_from_tow_point(I, M, way)
        out[3] += way[1] * out[2] - way[2] * out[1]
        out[4] += way[2] * out[0] - way[0] * out[2]
        out[5] += way[0] * out[1] - way[1] * out[0]


@kernel
def pull_along(I, M, node, sign):
    """Component along the tangent of the support's force at an end node: the tension there [N]."""
    head = header(I)
    dimension = head.dimension
    at = 2 * dimension * node
    q = head.position + at + dimension
    f = head.residual + at
    norm = 0.0
    along = 0.0
    for i in range(dimension):
        norm += M[q + i] * M[q + i]
        along += M[q + i] * M[f + i]
    return sign * along / math.sqrt(norm)


@kernel
def end_tension(I, M, element, side):
    """Tension at the parent (side 0) or child (1) end of an element: its end force along r'.

    The end forces are the weak form's own reactions, inertia and loads included: they are as
    accurate inside the line as the force at its top, where the element's T is only its mean.
    """
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    node = element if side == 1 else I[head.parent + element]
    q = head.position + size * node + dimension
    f = head.end_force + size * element + dimension * side
    norm = 0.0
    along = 0.0
    for i in range(dimension):
        norm += M[q + i] * M[q + i]
        along += M[q + i] * M[f + i]
    return along / math.sqrt(norm)


@kernel
def line_length(I, M):
    """Unstretched length of the cable that is out [m]."""
    head = header(I)
    last = head.nodes - 1
    edge = edge_of(I, M, last)
    if last == 1:
        return edge.length - overhang(I, M)
    return edge.start + edge.length + winch_of(I, M, 0).paid


GAUSS = 0.5 - 0.5 / math.sqrt(3.0)  # where the second derivative of a cubic is most accurate
# A parabola k'' s^2 / 2 exceeds its mean of Gauss points in an element's middle by -h^2 k'' / 24,
# and that of the nearest ones at a node by -GAUSS^2 h^2 k'' / 2; the first of these means exceeds
# those at the ends by (1 / 24 - 1 / 8 - GAUSS^2 / 2) h^2 k''.
BOW = 1.0 / 12.0 + 0.5 * GAUSS * GAUSS
IN_MIDDLE = 1.0 / 24.0 / BOW  # share of the bow in an element's middle
AT_NODE = 0.5 * GAUSS * GAUSS / BOW  # the same at a node
PRESSED = 24.0  # of EI k^2: by how much the mean of T is off in an element that bends


@kernel
def bend_at(I, M, node, x, out):
    """dt/ds, the curvature as a vector, at a fraction of an element, (dimension,) [1/m]."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    h = edge_of(I, M, node).length
    p = head.position + size * I[head.parent + node]
    q = head.position + size * node
    y = 1.0 - x
    square = 0.0
    along = 0.0
    for i in range(dimension):
        chord = (M[q + i] - M[p + i]) / h
        a = M[p + dimension + i]
        b = M[q + dimension + i]
        slope = 6.0 * x * y * chord + y * (1.0 - 3.0 * x) * a + x * (3.0 * x - 2.0) * b
        out[i] = ((6.0 - 12.0 * x) * chord + (6.0 * x - 4.0) * a + (6.0 * x - 2.0) * b) / h
        out[3 + i] = slope
        square += slope * slope
        along += out[i] * slope
    for i in range(dimension):
        out[i] = (out[i] - along / square * out[3 + i]) / math.sqrt(square)


@kernel
def sharpest_bend(I, M, node, w):
    """Square of the larger curvature at an element's ends [1/m2]."""
    head = header(I)
    largest = 0.0
    for side in range(2):
        bend_at(I, M, node, float(side), w)
        square = 0.0
        for i in range(head.dimension):
            square += w[i] * w[i]
        largest = max(largest, square)
    return largest


@kernel
def go_on(I, M, node, other):
    """Whether another element goes on with the same cable, bent alike, with nothing between."""
    head = header(I)
    if other < 1 or other >= head.nodes or I[head.joint + other] != 0:
        return False
    edge = edge_of(I, M, node)
    beside = edge_of(I, M, other)
    same = edge.segment == beside.segment
    return same and edge.bending == beside.bending


@kernel
def bend_between(I, M, node, out, w):
    """The curvature vector at the node between an element and the next, from both sides' places
    where cubics have it best."""
    head = header(I)
    bend_at(I, M, node, 1.0 - GAUSS, out)
    bend_at(I, M, node + 1, GAUSS, w)
    h = edge_of(I, M, node).length
    share = h / (h + edge_of(I, M, node + 1).length)
    for i in range(head.dimension):
        out[i] += share * (w[i] - out[i])


@kernel
def bow_of_bend(I, M, node, out, w):
    """By how much the curvature vector of an element exceeds the mean of those at its ends, where
    it goes on at both: -BOW h^2 k''. Returns whether it does. w: 12 words."""
    head = header(I)
    if not (go_on(I, M, node, node - 1) and go_on(I, M, node, node + 1)):
        return False
    bend_between(I, M, node - 1, w[0:6], w[6:12])
    for i in range(3):
        out[i] = w[i]
    bend_between(I, M, node, w[0:6], w[6:12])
    for i in range(3):
        out[i] = -0.5 * (out[i] + w[i])
    bend_at(I, M, node, 0.5, w)
    for i in range(head.dimension):
        out[i] += w[i]
    return True


@kernel
def smooth_bend(I, M, node, x, out, w):
    """The curvature vector at a fraction of an element from those of it and its neighbours, into
    out. Returns whether it goes on with the same cable at both ends. w: 18 words.

    The second derivative of a cubic jumps at nodes, and swings within elements, more where their
    lengths change. Its means from Gauss point to Gauss point do not; what such a mean, at a node
    or in the middle, lacks of a parabola is added, and a parabola laid through the three.
    """
    own = w[12:15]
    if not bow_of_bend(I, M, node, own, w):
        return False
    beside = w[15:18]
    y = 1.0 - x
    if not (go_on(I, M, node, node - 2) and bow_of_bend(I, M, node - 1, beside, w)):
        for i in range(3):
            beside[i] = own[i]
    bend_between(I, M, node - 1, w[0:6], w[6:12])
    for i in range(3):
        out[i] = y * (1.0 - 2.0 * x) * (w[i] + 0.5 * AT_NODE * (own[i] + beside[i]))
    if not (go_on(I, M, node, node + 2) and bow_of_bend(I, M, node + 1, beside, w)):
        for i in range(3):
            beside[i] = own[i]
    bend_between(I, M, node, w[0:6], w[6:12])
    for i in range(3):
        out[i] += x * (2.0 * x - 1.0) * (w[i] + 0.5 * AT_NODE * (own[i] + beside[i]))
    bend_at(I, M, node, 0.5, w)
    for i in range(3):
        out[i] += 4.0 * x * y * (w[i] + IN_MIDDLE * own[i])
    return True


@kernel
def station_in_element(I, M, low, x, s, found):
    """State at a fraction x of the element above node `low`, s from the vessel, into a Station.

    `end_forces` has been called.
    """
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    w = M[head.motion + 28 : head.motion + 56]
    bend = M[head.motion + 56 : head.motion + 62]
    wide = M[head.motion + 62 : head.motion + 80]
    edge = edge_of(I, M, low)
    parent = I[head.parent + low]
    h = edge.length
    y = 1.0 - x
    n0 = y * y * (1.0 + 2.0 * x)
    n1 = h * x * y * y
    n2 = x * x * (3.0 - 2.0 * x)
    n3 = -h * x * x * y
    d0 = -6.0 * x * y / h
    d1 = y * (1.0 - 3.0 * x)
    d3 = x * (3.0 * x - 2.0)
    e0 = (12.0 * x - 6.0) / (h * h)
    e1 = (6.0 * x - 4.0) / h
    e3 = (6.0 * x - 2.0) / h
    q0 = head.position + size * parent
    q1 = head.position + size * low
    v0 = head.velocity + size * parent
    v1 = head.velocity + size * low
    if head.payout != 0:
        v0 = velocity_word(I, M, parent)
        v1 = velocity_word(I, M, low)
    g2 = 0.0
    for i in range(dimension):
        a = M[q0 + i]
        b = M[q0 + dimension + i]
        c = M[q1 + i]
        d = M[q1 + dimension + i]
        w[i] = n0 * a + n1 * b + n2 * c + n3 * d
        w[3 + i] = d0 * (a - c) + d1 * b + d3 * d
        w[6 + i] = e0 * (a - c) + e1 * b + e3 * d
        w[9 + i] = (
            n0 * M[v0 + i]
            + n1 * M[v0 + dimension + i]
            + n2 * M[v1 + i]
            + n3 * M[v1 + dimension + i]
        )
        g2 += w[3 + i] * w[3 + i]
    g = math.sqrt(g2)
    along = 0.0
    for i in range(dimension):
        w[3 + i] /= g
        along += w[6 + i] * w[3 + i]
    curvature = 0.0
    for i in range(dimension):
        curvature += ((w[6 + i] - along * w[3 + i]) / g) ** 2
    curvature = math.sqrt(curvature)
    bending = edge.bending
    if bending > 0.0 and smooth_bend(I, M, low, x, bend[0:3], wide):
        curvature = 0.0
        for i in range(dimension):
            curvature += bend[i] ** 2
        curvature = math.sqrt(curvature)
    moment = 0.0
    if head.payout != 0:
        moment = add_layer_shape(I, M, s, w, winch_of(I, M, 0).stage_rate)
    left = end_tension(I, M, low, 0)
    right = end_tension(I, M, low, 1)
    found.on_floor = 0.0
    if head.floor_kind != 0 and gap_at(I, M, w, w[12:15]) < lying_gap(I, M, low):
        found.on_floor = 1.0
    to_earth(I, M, w, 0, found.position, 0, 1)
    to_earth(I, M, w, 3, found.tangent, 0, 0)
    to_earth(I, M, w, 9, found.velocity, 0, 0)
    mean = M[head.tension + 2 * low]
    # The parabola through both end tensions that has the element's mean.
    bow = 6.0 * mean - 3.0 * (left + right)
    if bending > 0.0:  # where it bends sharply, that mean is not that of the tension
        off = PRESSED * bending * sharpest_bend(I, M, low, bend[0:6])
        bow = math.copysign(max(0.0, abs(bow) - off), bow)
    found.tension = left + x * (right - left) + bow * x * y
    found.curvature = curvature
    found.bending_moment = edge.bending * curvature
    if moment > 0.0:
        found.curvature += moment / edge.bending_full
        found.bending_moment += moment


@kernel
def sample_stations(I, M, stations, out):
    """State at arc lengths `stations` (ascending or not): rows of a Station each into out.

    Returns the index of the first station that lies outside the line (then nothing more is
    written), or the number of stations.
    """
    head = header(I)
    nodes = head.nodes
    end_forces(I, M)
    total = line_length(I, M)
    above = overhang(I, M)
    paid = winch_of(I, M, 0).paid
    # A node belongs to what lies beyond it, however its arc length is rounded: tensions jump there.
    slack = 1e-10 * total
    for n in range(len(stations)):
        s = stations[n]
        if not (s >= -1e-9 * total and s <= total * (1.0 + 1e-9)):
            return n
        low = 1
        high = nodes
        while high - low > 1:
            middle = (low + high) // 2
            if s - paid + slack >= edge_of(I, M, middle).start:
                low = middle
            else:
                high = middle
        if I[head.joint + low] != 0:
            low = low - 1 if low > 1 else 2
        edge = edge_of(I, M, low)
        start = edge.start + paid if I[head.parent + low] > 0 else -above
        x = min(1.0, max(0.0, (s - start) / edge.length))
        station_in_element(I, M, low, x, s, station_at(out, STATION_WORDS * n))
    return len(stations)


@kernel
def body_stations(I, M, out):
    """Bodies of finite length that are out: position, axis and velocity of the centre of gravity.

    out: a row of a Station for each body of the table, of which the rest stays as it is; those of
    other bodies, too (they move with the cable: see sample_stations).
    """
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    count = size * head.nodes
    q = M[head.position : head.position + count]
    v = M[head.velocity : head.velocity + count]
    w = M[head.motion + 28 : head.motion + 52]
    a = M[head.acceleration : head.acceleration + count]
    passing = head.rigid > 0 and winch_of(I, M, 0).passing != 0.0
    if passing:
        end_forces(I, M)
        exchange_rates(I, M, v, a)
    for body in range(head.body_count):
        row = rigid_row(I, M, body)
        of_body = body_at(M, row)
        if row < 0:
            continue
        node = int(of_body.node)
        outer = size * node
        inner = size * I[head.parent + node]
        axis_of(dimension, q, inner, outer, w)
        near = 0.5 * (1.0 - of_body.offset)
        far = 0.5 * (1.0 + of_body.offset)
        for i in range(dimension):
            w[3 + i] = near * q[inner + i] + far * q[outer + i]
            w[6 + i] = near * v[inner + i] + far * v[outer + i]
        found = station_at(out, STATION_WORDS * body)
        to_earth(I, M, w, 3, found.position, 0, 1)
        to_earth(I, M, w, 0, found.tangent, 0, 0)
        to_earth(I, M, w, 6, found.velocity, 0, 0)
    if passing:
        exchange_rates(I, M, v, a)


@kernel
def summarise(I, M, out):
    """Numbers of the present state that logs and co-simulation ask for at every step: a Summary."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    nodes = head.nodes
    found = summary_at(out, 0)
    wrench = found.wrench
    end_forces(I, M)
    support_force(I, M, 0, wrench)
    for i in range(6):
        wrench[i] = -wrench[i]
    top = pull_along(I, M, 0, -1.0)
    found.top_tension = math.copysign(
        math.sqrt(wrench[0] ** 2 + wrench[1] ** 2 + wrench[2] ** 2), top
    )
    lowest = 1e300
    highest = found.top_tension  # the force at the top has the shear, too
    for node in range(1, nodes):
        if I[head.joint + node] == 0:
            for side in range(2):
                value = end_tension(I, M, node, side)
                lowest = min(lowest, value)
                highest = max(highest, value)
    found.tension_min = lowest
    found.tension_max = highest
    last = size * (nodes - 1)
    q = M[head.position : head.position + size * nodes]
    v = M[head.velocity : head.velocity + size * nodes]
    to_earth(I, M, q, last, found.tip_position, 0, 1)
    to_earth(I, M, v, last, found.tip_velocity, 0, 0)
    to_earth(I, M, q, 0, found.vessel_position, 0, 1)
    to_earth(I, M, v, 0, found.vessel_velocity, 0, 0)
    way = M[head.motion + 28 : head.motion + 43]
    way_from_tow_point(I, M, way)
    for i in range(3):
        found.vessel_position[i] -= way[i]
        found.vessel_velocity[i] -= way[3 + i]
    found.line_length = line_length(I, M)
    winch = winch_of(I, M, 0)
    found.payout_rate = winch.stage_rate if head.payout != 0 else 0.0
    found.drum_length = winch.paid_most - winch.paid
    clear_floor(found, 0.0)
    if head.floor_kind != 0:
        w = M[head.motion + 16 : head.motion + 24]
        floor_summary(I, M, w)
        to_earth(I, M, w, 0, found.floor_force, 0, 0)
        to_earth(I, M, w, 4, found.touchdown_position, 0, 1)
        found.floor_length = w[3]
        found.touchdown_reaction = w[7]
    read_slack(I, M, found)


@kernel
def clear_floor(found, place):
    """Nothing touches the floor; place: what stands for the touchdown point."""
    for i in range(3):
        found.floor_force[i] = 0.0
        found.touchdown_position[i] = place
    found.floor_length = 0.0
    found.touchdown_reaction = 0.0


@kernel
def energies(I, M, out):
    """Energies [J] and powers [W] of the present state, by the elements' own rules of quadrature.

    Where cable is folded within an element no other rule sees what its equations hold: with five
    points the energy of the third strain mode grew by a tenth of all that went through the line.

    out: 0 kinetic (with added mass), 1 axial strain, 2 bending, 3 potential of the submerged
    weight (zero at z = 0), 4 power of the supports on the cable, 5 power lost to drag, 6 what the
    floor's springs hold, 7 power lost to friction and damping on the floor, 8 power that added mass
    takes beyond its share of 0. 5 is less by what a current that changes in time gives as it
    accelerates. With waves there is no added mass in 0 and nothing in 8, 3 is the
    potential of the weight in air, and 5 the power that the water takes in all its forces: drag,
    buoyancy, inertia.

    Morison's force -ma (I - t t^T) a works at the rate -d/dt(ma |v_n|^2 / 2) - ma (v.t)(v.t_dot):
    the second part is what the water takes, or gives, where cable turns while it slides. In whips
    and fast tows it is a quarter of all that goes through the line.
    """
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    size = 2 * dimension
    nodes = head.nodes
    w = M[head.motion + 28 : head.motion + 52]
    W = view(M, head.gauss, GAUSS_WORDS)
    for i in range(ENERGY_WORDS):
        out[i] = 0.0
    end_forces(I, M)
    if head.floor_kind != 0:
        floor_energy(I, M, out)
    for node in range(1, nodes):
        if I[head.joint + node] != 0:
            continue
        parent = I[head.parent + node]
        edge = edge_of(I, M, node)
        h = edge.length
        q0 = head.position + size * parent
        q1 = head.position + size * node
        v0 = head.velocity + size * parent
        v1 = head.velocity + size * node
        a0 = head.acceleration + size * parent
        a1 = head.acceleration + size * node
        if head.payout != 0:
            v0 = velocity_word(I, M, parent)
            v1 = velocity_word(I, M, node)
            a0 = v0 + 6
            a1 = v1 + 6
        mean = M[head.tension + 2 * node]
        slope = M[head.tension + 2 * node + 1]
        dry = edge.added_mass if head.wave_count != 0 else 0.0
        out[0] += 0.5 * h * (edge.mass - dry) * square(M, v0, v1, dimension, h)
        if head.wave_count != 0:
            element_water(I, M, W, edge, view(M, q0, size), view(M, q1, size))
        e2 = 0.0
        for p in range(3):
            weight = h * WEIGHT[p]
            g2 = 0.0
            along = 0.0
            vt = 0.0
            height = 0.0
            for i in range(dimension):
                d = dimension + i
                a = M[q0 + i]
                b = h * M[q0 + d]
                c = M[q1 + i]
                f = h * M[q1 + d]
                height = a * H0[p] + b * H1[p] + c * H2[p] + f * H3[p]
                w[15 + i] = height
                w[i] = (a * D0[p] + b * D1[p] + c * D2[p] + f * D3[p]) / h
                w[3 + i] = (a * E0[p] + b * E1[p] + c * E2[p] + f * E3[p]) / (h * h)
                w[6 + i] = M[v0 + i] * H0[p] + M[v1 + i] * H2[p]
                w[6 + i] += h * (M[v0 + d] * H1[p] + M[v1 + d] * H3[p])
                w[18 + i] = M[a0 + i] * H0[p] + M[a1 + i] * H2[p]
                w[18 + i] += h * (M[a0 + d] * H1[p] + M[a1 + d] * H3[p])
                g2 += w[i] * w[i]
            g = math.sqrt(g2)
            if head.wave_count == 0:
                current_at(I, M, height, w[12:15])
            else:
                for i in range(dimension):
                    w[12 + i] = W[VELOCITY + 4 * i + p]
            ut = 0.0
            for i in range(dimension):
                w[i] /= g
                along += w[3 + i] * w[i]
                vt += w[6 + i] * w[i]
                w[9 + i] = w[12 + i] - w[6 + i]
                ut += w[9 + i] * w[i]
            curvature = 0.0
            un2 = 0.0
            for i in range(dimension):
                curvature += ((w[3 + i] - along * w[i]) / g) ** 2
                un2 += (w[9 + i] - ut * w[i]) ** 2
            un = math.sqrt(un2)
            if head.wave_count == 0:
                out[0] -= 0.5 * weight * edge.added_mass * vt * vt
                out[3] += weight * edge.weight * (height + state.origin[2])
            # Complementary energy subtracted from T strain: exact for a curved law too.
            out[1] += weight * strain_energy(M, edge, mean + slope * P1[p])
            out[2] += 0.5 * weight * edge.bending * curvature
            if head.wave_count != 0:
                cable_in_waves(I, M, W, p, edge, weight, g, un, ut, height, w, out)
            elif head.drag != 0:
                root = math.sqrt(g)
                fn = root * edge.drag_normal * un
                ft = root * edge.drag_tangential * abs(ut) * ut
                for i in range(dimension):
                    force = fn * (w[9 + i] - ut * w[i]) + ft * w[i]
                    out[5] -= weight * force * w[6 + i]
                if head.surge != 0:
                    surge_at(I, M, height, w[12:15])
                    turning = 0.0
                    for i in range(dimension):
                        turning += w[12 + i] * w[i]
                    for i in range(dimension):
                        force = displaced(I, M, edge) * w[12 + i]
                        force += edge.added_mass * (w[12 + i] - turning * w[i])
                        out[5] -= weight * force * w[6 + i]
                turning = 0.0  # v . dv/ds, then v . t_dot
                stretching = 0.0
                for i in range(dimension):
                    d = dimension + i
                    rate = (M[v0 + i] * D0[p] + M[v1 + i] * D2[p]) / h
                    rate += M[v0 + d] * D1[p] + M[v1 + d] * D3[p]
                    turning += w[6 + i] * rate
                    stretching += w[i] * rate
                turning = (turning - vt * stretching) / g
                out[8] += weight * edge.added_mass * vt * turning
            e2 += WEIGHT_P2[p] * (g - 1.0)
        e2 = 5.0 * e2 - edge.third_rest / edge.stabilisation
        out[1] += 0.1 * h * edge.stabilisation * e2 * e2
    q = M[head.position : head.position + size * nodes]
    v = M[head.velocity : head.velocity + size * nodes]
    a = M[head.acceleration : head.acceleration + size * nodes]
    flow = M[head.motion + 16 : head.motion + 46]
    passing = head.rigid > 0 and winch_of(I, M, 0).passing != 0.0
    for body in range(head.body_count):
        row = body_of(I, M, body)
        if row.node < 0.0:
            continue
        if row.length > 0.0:
            tension = M[head.tension : head.tension + 2 * nodes]
            if passing:
                exchange_rates(I, M, v, a)
            rigid_energy(I, M, body_at(M, rigid_row(I, M, body)), q, v, a, tension, out)
            if passing:
                exchange_rates(I, M, v, a)
            continue
        node = int(row.node)
        at = size * node
        speed = 0.0
        for i in range(dimension):
            speed += v[at + i] ** 2
        out[0] += 0.5 * row.mass * speed
        height = q[at + dimension - 1] + state.origin[2]
        body_kinematics(I, M, node, q, v, a, flow)
        for i in range(dimension):
            flow[12 + i] = v[at + i]
        if head.wave_count != 0:
            out[3] += row.mass * state.gravity * height
            add_waves(I, M, row, q[at], q[at + 1], q[at + dimension - 1], 0.0, flow)
            wave_power(I, M, row, flow, out)
            continue
        out[3] += row.weight * height
        slope = view(M, head.position + at + dimension, dimension)
        rate = view(M, head.velocity + at + dimension, dimension)
        size_of_slope = 0.0
        for i in range(dimension):
            size_of_slope += slope[i] ** 2
        for i in range(dimension):
            flow[15 + i] = rate[i] / math.sqrt(size_of_slope)
        flow_energy(M, row, dimension, flow, out)
        if head.surge != 0:
            out[5] -= surge_power(I, M, row, q[at + dimension - 1], flow)
    if head.payout != 0:
        out[2] += clamp_energy(I, M, q)
    for i in range(dimension):
        out[4] += M[head.residual + i] * M[head.velocity + i]


@kernel
def cable_in_waves(I, M, W, p, edge, weight, g, un, ut, height, w, out):
    """Energies of a piece of cable, and what the water takes from it; see `energies`.

    weight: length of the piece [m], at Gauss point p; w: tangent, -, velocity, relative flow (3
    words each, at 0, 6 and 9), acceleration at 18; W: what `element_water` has written.
    """
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    mass = edge.mass - edge.added_mass
    at = 0.0
    wt = 0.0
    for i in range(dimension):
        at += w[18 + i] * w[i]
        wt += W[ACCELERATION + 4 * i + p] * w[i]
    out[3] += weight * mass * state.gravity * (height + state.origin[2])
    added = edge.added_mass
    mass_of_water = displaced(I, M, edge)
    fn = math.sqrt(g) * edge.drag_normal * un
    ft = math.sqrt(g) * edge.drag_tangential * abs(ut) * ut
    power = buoyancy(M, edge) * w[6 + dimension - 1]
    drag = 0.0
    for i in range(dimension):
        drag += (fn * (w[9 + i] - ut * w[i]) + ft * w[i]) * w[6 + i]
        force = mass_of_water * W[ACCELERATION + 4 * i + p]
        force += added * (W[ACCELERATION + 4 * i + p] - wt * w[i] - w[18 + i] + at * w[i])
        power += force * w[6 + i]
    out[5] -= weight * (W[WET + p] * power + W[DRAG + p] * drag)


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
