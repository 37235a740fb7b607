"""Where elements begin whose cable runs past a clamp: at the end of the layer in which it bends.

A cable of stiffness EI under the tension T leaves a clamp along the clamp's direction c and turns
to its own, u, over some layers lambda = sqrt(EI/T). From there on it is straight, and seems to come
from a place beside the tow point (the elastica under tension, tan(psi/4) = tan(angle/4)
exp(-s/lambda), integrated):

    lambda (2 sin(angle/2) n - 2 (1 - cos(angle/2)) u),  n towards c across u.

A force T u that acts there has the clamp's moment about the tow point, 2 sqrt(EI T) sin(angle/2).
Elements many layers long therefore begin at that place, hinged: a spring at the tow point gives
them the moment as well, but bends the top one along its whole length. Elements that are not so
long have some of the spring (`vessel_clamp.py`) and some of the way, by `Constraint.share`.

In motion the place follows with three equal time constants, of a part of sqrt(L/g): its course
over a step is known before the step is made, smooth however long that is, and prescribed as the
vessel's. With two of them its acceleration jumped at each step, and shook stiff lines.
"""

import math

from cablemodel.solvers.finite_element.kernels.bodies.slopes import half_cosine, slope_direction
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import gap_at
from cablemodel.solvers.shared.access import (
    body_of,
    constraint_of,
    edge_of,
    header,
    new_motion,
    scalars,
    tension_of,
    vector,
    winch_of,
)
from cablemodel.solvers.shared.compile import kernel, view
from cablemodel.solvers.shared.environment import add_layer_motion
from cablemodel.solvers.shared.layout import BY_SPRING
from cablemodel.solvers.shared.numbers import NO_DIRECTION

FEW, MANY = 4.0, 8.0  # layers in the cable's length, up to which the spring has all of it, or none
FOLLOW_RATE = 6.0  # rate at which the place follows, times sqrt(L/g); faster what a winch changes
SPREAD = 2.0  # length along which a place that is not there yet is made up for, over its distance
CALMS = 1.25  # what a gain that was too large grows by again, at most by one
NEXT = 0.25  # part of that length in which the highest tension is that of the layer
LAYER_UNSEEN = 0.003  # of tau L: by what a place may be off in an equilibrium
GONE = 40.0  # layers from the tow point on which nothing is left of it


@kernel
def layer_thickness(I, M):
    """sqrt(EI/T) at a clamp past which cable runs [m]; 0: there is none."""
    stiffness = edge_of(I, M, 1).bending_full
    row = constraint_of(I, M, 0)
    if row.clamped != BY_SPRING or winch_of(I, M, 0).passing_body != 0.0 or stiffness == 0.0:
        return 0.0
    if not row.layer_tension > 0.0:
        return 0.0
    return math.sqrt(stiffness / row.layer_tension)


@kernel
def free_length(I, M):
    """Cable between the tow point and the first body or joint [m]."""
    head = header(I)
    length = 0.0
    node = 1
    while node < head.nodes and I[head.joint + node] == 0:
        length += edge_of(I, M, node).length
        for body in range(head.body_count):
            if body_of(I, M, body).node == node:
                node = head.nodes
                break
        node += 1
    return length


@kernel
def present_tension(I, M):
    """Tension that bends the cable out of the clamp [N]: the highest in what follows next.

    Where elements resolve the layer, that in the first of them is its part along the clamp.
    """
    head = header(I)
    near = NEXT * free_length(I, M)
    tension = tension_of(I, M, 1).mean - tension_of(I, M, 1).slope
    length = edge_of(I, M, 1).length
    node = 2
    while node < head.nodes and length < near:
        tension = max(tension, tension_of(I, M, node).mean)
        length += edge_of(I, M, node).length
        node += 1
    return tension


@kernel
def follow_tension(I, M, share):
    """Bring the tension that the layer goes by towards the present one, by `share` of the way.

    A line that hardly stretches answers a small change of the layer with a large one of tension:
    what goes to and fro goes by ever less.
    """
    row = constraint_of(I, M, 0)
    change = present_tension(I, M) - row.layer_tension
    gain = row.tension_gain
    if change * row.tension_change < 0.0:
        gain *= 0.5
    else:
        gain = min(1.0, CALMS * gain)
    if gain == 0.0:
        gain = 1.0
    row.tension_gain = gain
    row.tension_change = change
    row.layer_tension += share * gain * change


@kernel
def share_of_layer(I, M):
    """Which part of a clamp is the way of a hinge, by how many layers its cable has: 0 to 1.

    Up to the first body, to the radius to which its weight bends a level cable, and to the height
    above the floor.
    """
    head = header(I)
    layer = layer_thickness(I, M)
    if layer == 0.0:
        return 0.0
    weight = abs(edge_of(I, M, 1).weight)
    bends = constraint_of(I, M, 0).layer_tension / max(weight, 1e-300)
    room = min(free_length(I, M), bends)
    if head.floor_kind != 0:
        place = view(M, head.position, head.dimension)
        room = min(room, gap_at(I, M, place, vector()))
    x = (room / layer - FEW) / (MANY - FEW)
    x = min(1.0, max(0.0, x))
    return x * x * (3.0 - 2.0 * x)


@kernel
def way_of_layer(dimension, thickness, cosine, clamp, cable, out):
    """The way from the tow point to where the cable seems to come from, into out.

    clamp, cable: directions of both, unit vectors; cosine: of the angle between them.
    """
    half = half_cosine(cosine)
    for i in range(dimension):
        across = (clamp[i] - cosine * cable[i]) / half
        out[i] = thickness * (across - 2.0 * (1.0 - half) * cable[i])


@kernel
def layer_target(I, M, out):
    """Where the elements should begin, from the tow point, into out [m]."""
    head = header(I)
    dimension = head.dimension
    row = constraint_of(I, M, 0)
    share = row.share
    layer = layer_thickness(I, M)
    for i in range(dimension):
        out[i] = 0.0
    if share == 0.0 or layer == 0.0:
        return
    cable = vector()
    q = view(M, head.position, 2 * dimension)
    _length, cosine = slope_direction(dimension, q, dimension, row.direction, cable)
    way_of_layer(dimension, share * layer, cosine, row.direction, cable, out)


@kernel
def follow_layer(I, M, dt):
    """After a step of dt: the place goes on from where and as fast as it is, to where it should be.

    Followed at once, its jumps from one step to the next would shake the line.
    """
    head = header(I)
    state = scalars(M)
    row = constraint_of(I, M, 0)
    if row.clamped != BY_SPRING:
        return
    now = new_motion()
    add_layer_motion(I, M, state.time, now)
    rate = FOLLOW_RATE / state.period
    layer = layer_thickness(I, M)
    if layer > 0.0:
        rate += abs(winch_of(I, M, 0).rate) / layer
    elif winch_of(I, M, 0).passing_body != 0.0:
        rate = max(rate, row.layer_rate)  # as before the body came
    row.layer_rate = rate
    follow_tension(I, M, dt / (dt + state.period))
    row.share = share_of_layer(I, M)
    target = row.place
    layer_target(I, M, target)
    for i in range(head.dimension):
        away = now.position[i] - target[i]
        row.away[i] = away
        drift = now.velocity[i] + rate * away
        row.drift[i] = drift
        turn = now.acceleration[i] + rate * (2.0 * drift - rate * away)
        row.drift_rate[i] = 0.5 * turn
    row.layer_time = state.time


@kernel
def settle_layer(I, M, q):
    """In a search for an equilibrium: the place is at once where it should be, and q with it.

    Differences that nobody sees are left: what is sought is at rest to many more digits.
    """
    head = header(I)
    state = scalars(M)
    row = constraint_of(I, M, 0)
    if row.clamped != BY_SPRING:
        return
    dimension = head.dimension
    follow_tension(I, M, 1.0)
    row.share = share_of_layer(I, M)
    change = vector()
    layer_target(I, M, change)
    square = 0.0
    for i in range(dimension):
        change[i] -= row.place[i] + row.away[i]
        square += change[i] * change[i]
    if math.sqrt(square) <= LAYER_UNSEEN * state.tolerance * state.length:
        return
    for i in range(dimension):
        q[i] += change[i]
        row.place[i] += change[i] + row.away[i]
        row.away[i] = 0.0
        row.drift[i] = 0.0
        row.drift_rate[i] = 0.0
    row.layer_time = state.time


@kernel
def add_layer_shape(I, M, s, place, tangent, velocity, rate):
    """Add to a station of the elements what the layer itself adds; returns its bending moment.

    s: arc length from the tow point [m]; rate: of the pay-out [m/s]. Position, unit tangent and
    velocity are changed. The moment is in N m.
    """
    head = header(I)
    state = scalars(M)
    row = constraint_of(I, M, 0)
    if row.clamped != BY_SPRING:
        return 0.0
    dimension = head.dimension
    share = row.share
    layer = layer_thickness(I, M)
    off = new_motion()  # of where elements begin, from where they should
    add_layer_motion(I, M, state.time, off)
    moment = 0.0
    if share > 0.0:
        cable = vector()
        here = vector()  # direction of the cable at s
        way = vector()
        q = view(M, head.position, 2 * dimension)
        clamp = row.direction
        _length, cosine = slope_direction(dimension, q, dimension, clamp, cable)
        way_of_layer(dimension, share * layer, cosine, clamp, cable, way)
        for i in range(dimension):
            off.position[i] -= way[i]
        # The angle psi that is left at s, from its quarter's tangent, and the direction there.
        half = math.sqrt(max(0.0, 0.5 * (1.0 + cosine)))
        quarter = math.sqrt((1.0 - half) / (1.0 + half)) * math.exp(-min(s / layer, GONE))
        half = (1.0 - quarter * quarter) / (1.0 + quarter * quarter)
        half_sine = 2.0 * quarter / (1.0 + quarter * quarter)
        left = 2.0 * half * half - 1.0
        sine = max(math.sqrt(max(0.0, 1.0 - cosine * cosine)), NO_DIRECTION)
        for i in range(dimension):
            across = (clamp[i] - cosine * cable[i]) / sine
            here[i] = left * cable[i] + 2.0 * half * half_sine * across
            tangent[i] += share * (here[i] - cable[i])
            velocity[i] += rate * share * (here[i] - cable[i])
        way_of_layer(dimension, share * layer, left, here, cable, way)
        for i in range(dimension):
            place[i] -= way[i]
        size = 0.0
        for i in range(dimension):
            size += tangent[i] * tangent[i]
        for i in range(dimension):
            tangent[i] /= math.sqrt(size)
        moment = 2.0 * share * layer * row.layer_tension * half_sine
    distance = 0.0
    for i in range(dimension):
        distance += off.position[i] * off.position[i]
    distance = max(layer, SPREAD * math.sqrt(distance))
    if 0.0 < distance and s < GONE * distance:
        fade = math.exp(-s / distance)
        for i in range(dimension):
            place[i] -= fade * off.position[i]
            velocity[i] -= fade * off.velocity[i]
    return moment
