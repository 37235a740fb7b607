"""The state at places of a cable, and of bodies of finite length: rows of a Station."""

import math

from cablemodel.solvers.finite_element.kernels.bodies.clamp_layer import add_layer_shape
from cablemodel.solvers.finite_element.kernels.bodies.rigid import axis_of, rigid_row
from cablemodel.solvers.finite_element.kernels.element.tension_along import (
    bend_at,
    bow_of_tension,
    end_tension,
)
from cablemodel.solvers.finite_element.kernels.floor.floor_outputs import lying_gap
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import gap_at
from cablemodel.solvers.finite_element.kernels.mesh.body_passage import exchange_rates, overhang
from cablemodel.solvers.finite_element.kernels.mesh.payout import rate_words
from cablemodel.solvers.finite_element.kernels.outputs.summary import (
    end_forces,
    line_length,
    place_on_earth,
    to_earth,
)
from cablemodel.solvers.shared.access import body_at, edge_of, header, station_at, vector, winch_of
from cablemodel.solvers.shared.compile import kernel
from cablemodel.solvers.shared.layout import STATION_WORDS
from cablemodel.solvers.shared.numbers import SAME_PLACE

GAUSS = 0.5 - 0.5 / math.sqrt(3.0)  # where the second derivative of a cubic is most accurate
# A parabola k'' s^2 / 2 exceeds its mean of Gauss points in an element's middle by -h^2 k'' / 24,
# and that of the nearest ones at a node by -GAUSS^2 h^2 k'' / 2; the first of these means exceeds
# those at the ends by (1 / 24 - 1 / 8 - GAUSS^2 / 2) h^2 k''.
BOW = 1.0 / 12.0 + 0.5 * GAUSS * GAUSS
IN_MIDDLE = 1.0 / 24.0 / BOW  # share of the bow in an element's middle
AT_NODE = 0.5 * GAUSS * GAUSS / BOW  # the same at a node
BESIDE_A_NODE = 1e-10  # of the line: a station so near before a node counts as behind it


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
def bend_between(I, M, node, out):
    """The curvature vector at the node between an element and the next, from both sides' places
    where cubics have it best."""
    beyond = vector()
    bend_at(I, M, node, 1.0 - GAUSS, out)
    bend_at(I, M, node + 1, GAUSS, beyond)
    h = edge_of(I, M, node).length
    share = h / (h + edge_of(I, M, node + 1).length)
    for i in range(header(I).dimension):
        out[i] += share * (beyond[i] - out[i])


@kernel
def bow_of_bend(I, M, node, out):
    """By how much the curvature vector of an element exceeds the mean of those at its ends, where
    it goes on at both: -BOW h^2 k''. Returns whether it does."""
    if not (go_on(I, M, node, node - 1) and go_on(I, M, node, node + 1)):
        return False
    begin = vector()
    end = vector()
    middle = vector()
    bend_between(I, M, node - 1, begin)
    bend_between(I, M, node, end)
    bend_at(I, M, node, 0.5, middle)
    for i in range(3):
        out[i] = -0.5 * (begin[i] + end[i]) + middle[i]
    return True


@kernel
def smooth_bend(I, M, node, x, out):
    """The curvature vector at a fraction of an element from those of it and its neighbours, into
    out. Returns whether it goes on with the same cable at both ends.

    The second derivative of a cubic jumps at nodes, and swings within elements, more where their
    lengths change. Its means from Gauss point to Gauss point do not; what such a mean, at a node
    or in the middle, lacks of a parabola is added, and a parabola laid through the three.
    """
    own = vector()
    if not bow_of_bend(I, M, node, own):
        return False
    beside = vector()  # bow of an element beside, or its own
    bend = vector()
    y = 1.0 - x
    if not (go_on(I, M, node, node - 2) and bow_of_bend(I, M, node - 1, beside)):
        for i in range(3):
            beside[i] = own[i]
    bend_between(I, M, node - 1, bend)
    for i in range(3):
        out[i] = y * (1.0 - 2.0 * x) * (bend[i] + 0.5 * AT_NODE * (own[i] + beside[i]))
    if not (go_on(I, M, node, node + 2) and bow_of_bend(I, M, node + 1, beside)):
        for i in range(3):
            beside[i] = own[i]
    bend_between(I, M, node, bend)
    for i in range(3):
        out[i] += x * (2.0 * x - 1.0) * (bend[i] + 0.5 * AT_NODE * (own[i] + beside[i]))
    bend_at(I, M, node, 0.5, bend)
    for i in range(3):
        out[i] += 4.0 * x * y * (bend[i] + IN_MIDDLE * own[i])
    return True


@kernel
def size_of(I, local):
    """Length of a vector in the block's coordinates."""
    square = 0.0
    for i in range(header(I).dimension):
        square += local[i] ** 2
    return math.sqrt(square)


@kernel
def station_in_element(I, M, low, x, s, found):
    """State at a fraction x of the element above node `low`, s from the vessel, into a Station.

    `end_forces` has been called.
    """
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    place = vector()
    tangent = vector()
    second = vector()  # r''
    velocity = vector()
    bend = vector()
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
    v0, _a0 = rate_words(I, M, parent)
    v1, _a1 = rate_words(I, M, low)
    for i in range(dimension):
        a = M[q0 + i]
        b = M[q0 + dimension + i]
        c = M[q1 + i]
        d = M[q1 + dimension + i]
        place[i] = n0 * a + n1 * b + n2 * c + n3 * d
        tangent[i] = d0 * (a - c) + d1 * b + d3 * d
        second[i] = e0 * (a - c) + e1 * b + e3 * d
        velocity[i] = (
            n0 * M[v0 + i]
            + n1 * M[v0 + dimension + i]
            + n2 * M[v1 + i]
            + n3 * M[v1 + dimension + i]
        )
    g = size_of(I, tangent)
    along = 0.0
    for i in range(dimension):
        tangent[i] /= g
        along += second[i] * tangent[i]
    for i in range(dimension):
        bend[i] = (second[i] - along * tangent[i]) / g
    bending = edge.bending
    if bending > 0.0:
        smooth_bend(I, M, low, x, bend)
    curvature = size_of(I, bend)
    moment = 0.0
    if head.payout != 0:
        moment = add_layer_shape(I, M, s, place, tangent, velocity, winch_of(I, M, 0).stage_rate)
    left = end_tension(I, M, low, 0)
    right = end_tension(I, M, low, 1)
    found.on_floor = 0.0
    if head.floor_kind != 0 and gap_at(I, M, place, vector()) < lying_gap(I, M, low):
        found.on_floor = 1.0
    place_on_earth(I, M, place, found.position)
    to_earth(I, M, tangent, found.tangent)
    to_earth(I, M, velocity, found.velocity)
    bow = bow_of_tension(I, M, low, left, right)
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
    slack = BESIDE_A_NODE * total
    for n in range(len(stations)):
        s = stations[n]
        if not (s >= -SAME_PLACE * total and s <= total * (1.0 + SAME_PLACE)):
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
    axis = vector()
    centre = vector()
    velocity = vector()
    a = M[head.acceleration : head.acceleration + count]
    passing_body = head.rigid > 0 and winch_of(I, M, 0).passing_body != 0.0
    if passing_body:
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
        axis_of(dimension, q, inner, outer, axis)
        near = 0.5 * (1.0 - of_body.offset)
        far = 0.5 * (1.0 + of_body.offset)
        for i in range(dimension):
            centre[i] = near * q[inner + i] + far * q[outer + i]
            velocity[i] = near * v[inner + i] + far * v[outer + i]
        found = station_at(out, STATION_WORDS * body)
        place_on_earth(I, M, centre, found.position)
        to_earth(I, M, axis, found.tangent)
        to_earth(I, M, velocity, found.velocity)
    if passing_body:
        exchange_rates(I, M, v, a)
