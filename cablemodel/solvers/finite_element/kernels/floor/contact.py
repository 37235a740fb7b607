"""Contact of cable and bodies with the sea floor, and friction (docs/engine.md, "Sea floor").

Contact is a spring with a preload: the force per length over what it is at rest is 1 at the gap
g = 0, so that cable at rest lies exactly on the floor, fades to nothing at g = delta, and stiffens
below. It grows with the speed of approach. At rest the floor bears the weight w, or what it has
borne for long (`floor_memory`). Friction is a bristle: f = -mu p0 e / u, no longer than mu p, where
p0 is the force at rest and e the way along the floor from where cable was last at rest. Across the
cable it is cubic as the cable is: what bends or swings between nodes is held, too.
"""

import math

from cablemodel.solvers.finite_element.kernels.element.tables import (
    CONTACT_H,
    CONTACT_POINTS,
    STEEPEST,
    STIFFENING,
)
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import gap_at, gap_below
from cablemodel.solvers.shared.access import (
    body_of,
    closure_of,
    constraint_of,
    edge_of,
    header,
    scalars,
    vector,
)
from cablemodel.solvers.shared.compile import inlined, kernel, own_record, view
from cablemodel.solvers.shared.layout import JOINT_BODY
from cablemodel.solvers.shared.record import Record, real, reals

TIPPING = 1e-3  # of the normal force: what tips cable over that stands on its end


class Contact(Record):
    """A place of cable or of a body at the floor: block's coordinates, in a plane two of three."""

    place = reals(3, "where it is", "m")
    normal = reals(3, "of the floor below it, a unit vector upwards")
    velocity = reals(3, "of it", "m/s")
    bristle = reals(3, "way along the floor from where it was last at rest", "m")
    along = reals(3, "force along the floor, per length of cable", "N")
    slip = reals(3, "direction in which it slips, or zeros")
    chord = reals(3, "direction of its element's chord, along which the bristle is linear")
    ahead = real("damping over stiffness of its bristle", "s")
    stiffness = reals(9, "minus the derivative of the force by the place, by rows of three", "N/m")


contact_of = own_record(Contact)


@inlined
def contact_law(gap, depth):
    """Force over its value at rest, its stiffness [1/m], energy over that force [m].

    With y = 2 g/delta: (1 - y/2)^2 above y = 0, 1 + S (exp(-y/S) - 1) below, no steeper than
    exp(STEEPEST), so that an iterate which is far too deep comes back.
    """
    e = 0.5 * depth
    y = gap / e
    if y >= 2.0:
        return 0.0, 0.0, 0.0
    if y >= 0.0:
        left = 1.0 - 0.5 * y
        return left * left, left / e, 2.0 / 3.0 * e * left * left * left
    steep = math.exp(min(-y / STIFFENING, STEEPEST))
    share = 1.0 + STIFFENING * (steep - 1.0)
    energy = 2.0 / 3.0 + STIFFENING * STIFFENING * (steep - 1.0)
    deeper = -y - STEEPEST * STIFFENING
    if deeper <= 0.0:
        return share, steep / e, e * (energy - y * (1.0 - STIFFENING))
    energy += STEEPEST * STIFFENING * (1.0 - STIFFENING) + deeper * (share + 0.5 * deeper * steep)
    return share + deeper * steep, steep / e, e * energy


@inlined
def place_law(preload, gap, depth):
    """The law of contact at a place; without a preload it begins, as a parabola, at a gap of 0."""
    share, stiffness, energy = contact_law(gap, depth)
    if not preload:
        e = 0.5 * depth
        if gap >= 0.0:
            return 0.0, 0.0, 0.0
        d = -gap / e
        share -= 1.0 + d
        stiffness -= 1.0 / e
        energy -= e * (2.0 / 3.0 + d + 0.5 * d * d)
    return share, stiffness, energy


@inlined
def place_damping(M, preload):
    """By how much the floor's force at a place grows per speed of approach [s/m]: bodies bear."""
    return scalars(M).landing_damping if preload else scalars(M).floor_damping


@inlined
def along_floor(way, normal, dimension):
    """Remove the part along the normal from a vector; returns its length."""
    along = 0.0
    for i in range(dimension):
        along += way[i] * normal[i]
    length = 0.0
    for i in range(dimension):
        way[i] -= along * normal[i]
        length += way[i] ** 2
    return math.sqrt(length)


@inlined
def friction(M, load, press, contact, dimension):
    """Friction into `along`, by the bristle, whose part along the normal is removed.

    load: what the floor bears at rest; press: now. Returns whether it sticks, the length of the
    bristle and the stiffness: minus force over bristle.
    """
    state = scalars(M)
    length = along_floor(contact.bristle, contact.normal, dimension)
    stiffness = state.friction * load / state.bristle
    limit = state.friction * press
    sticks = stiffness * length <= limit
    if not sticks:
        stiffness = limit / length
    for i in range(dimension):
        contact.along[i] = -stiffness * contact.bristle[i]
    return sticks, length, stiffness


@inlined
def interpolate(q, parent, node, h, p, out, dimension):
    """A vector field of an element at contact point p."""
    a = 2 * dimension * parent
    b = 2 * dimension * node
    for i in range(dimension):
        out[i] = CONTACT_H[p, 0] * q[a + i] + h * CONTACT_H[p, 1] * q[a + dimension + i]
        out[i] += CONTACT_H[p, 2] * q[b + i] + h * CONTACT_H[p, 3] * q[b + dimension + i]


@inlined
def damping_time(M, load, mass):
    """Of a bristle, damping over stiffness [s]: critical, so that what it holds does not swing.

    load: what presses it at rest, mass: what it holds; both per length of cable, or of a body.
    """
    state = scalars(M)
    if state.bristles_damped == 0.0 or state.friction == 0.0:
        return 0.0
    return 2.0 * math.sqrt(mass * state.bristle / (state.friction * load))


@inlined
def linear_along(M, q, at, rest, x, e, chord, dimension):
    """Make a bristle e linear between two nodes along their chord, whose direction is given back.

    at, rest: where the places of both nodes begin, in q, and of what is at rest, in M. Across the
    chord it is cubic as the cable is; slopes along the cable are strains, and what lies down turns
    them.
    """
    square = 1e-300
    more = 0.0
    for i in range(dimension):
        q0 = q[at[0] + i]
        q1 = q[at[1] + i]
        chord[i] = q1 - q0
        linear = (1.0 - x) * (q0 - M[rest[0] + i]) + x * (q1 - M[rest[1] + i])
        square += chord[i] * chord[i]
        more += chord[i] * (linear - e[i])
    length = math.sqrt(square)
    for i in range(dimension):
        chord[i] /= length
        e[i] += more / length * chord[i]


@inlined
def bristle(I, M, q, parent, node, h, p, contact, dimension):
    """The way from rest at contact point p of an element, and its chord's direction."""
    size = 2 * dimension
    start = header(I).rest
    rest = vector()
    interpolate(view(M, start, size * (node + 1)), parent, node, h, p, rest, dimension)
    for i in range(dimension):
        contact.bristle[i] = contact.place[i] - rest[i]
    above = size * parent
    below = size * node
    linear_along(
        M,
        q,
        (above, below),
        (start + above, start + below),
        CONTACT_POINTS[p],
        contact.bristle,
        contact.chord,
        dimension,
    )


@inlined
def bristle_at(I, M, node, contact, dimension):
    """The way from rest of a node that is at the contact's place."""
    rest = header(I).rest + 2 * dimension * node
    for i in range(dimension):
        contact.bristle[i] = contact.place[i] - M[rest + i]


@inlined
def damp_bristle(contact, dimension):
    """Lengthen the bristle by what its velocity adds in the time `ahead`: a spring and a damper
    side by side. The damper is cubic along the chord as forces are. The spring is linear there, and
    a force that acts along another way than its spring is drawn out gives energy: chain that lay
    still was shaken loose by that."""
    for i in range(dimension):
        contact.bristle[i] += contact.ahead * contact.velocity[i]


@inlined
def damp_bristle_at(v, node, contact, dimension):
    """The same of a node's bristle."""
    for i in range(dimension):
        contact.bristle[i] += contact.ahead * v[2 * dimension * node + i]


@inlined
def approach(v, parent, node, h, p, contact, dimension):
    """Velocity of contact point p of an element into `velocity`; returns it along the normal
    [m/s]."""
    interpolate(v, parent, node, h, p, contact.velocity, dimension)
    speed = 0.0
    for i in range(dimension):
        speed += contact.velocity[i] * contact.normal[i]
    return speed


@inlined
def tipping(q, parent, node, p, normal, dimension):
    """Share of the normal force that pushes cable over that stands on its end, along x.

    Exactly vertical cable would stand on the floor as no column can. The share is nothing where
    cable lies: it falls with the eighth power of the tangent along the normal.
    """
    x = CONTACT_POINTS[p]
    a = 2 * dimension * parent + dimension
    b = 2 * dimension * node + dimension
    upright = 0.0
    square = 1e-300
    for i in range(dimension):
        slope = (1.0 - x) * q[a + i] + x * q[b + i]
        upright += slope * normal[i]
        square += slope * slope
    upright = upright * upright / square
    upright *= upright
    return TIPPING * upright * upright


@inlined
def contact_force(I, M, q, v, parent, node, h, p, load, contact, dimension):
    """Normal force per length at contact point p of an element [N/m], 0 where it does not touch.

    load: per length, what the floor bears at rest. `ahead` of the contact is given. Writes place,
    velocity, normal and force along the floor.
    Returns force, gap and speed of approach.
    """
    state = scalars(M)
    normal = contact.normal
    interpolate(q, parent, node, h, p, contact.place, dimension)
    gap = gap_below(I, M, contact.place, normal, dimension)
    for i in range(dimension):
        contact.along[i] = 0.0
    if gap >= state.floor_depth:
        return 0.0, gap, 0.0
    speed = approach(v, parent, node, h, p, contact, dimension)
    share, _stiffness, _energy = contact_law(gap, state.floor_depth)
    press = load * share
    press *= max(0.0, 1.0 - state.floor_damping * speed)
    if state.friction > 0.0 and press > 0.0:
        bristle(I, M, q, parent, node, h, p, contact, dimension)
        damp_bristle(contact, dimension)
        friction(M, load, press, contact, dimension)
    contact.along[0] += press * tipping(q, parent, node, p, normal, dimension)
    return press, gap, speed


@kernel
def touchdown_layer(M, edge):
    """Length over which bending spreads a touchdown [m]."""
    return (edge.bending_full / edge.contact) ** (1.0 / 3.0)


@inlined
def contact_places(I):
    """How many places touch as points: two of each body, and the line's end."""
    head = header(I)
    return 2 * head.body_count + 1


@kernel
def contact_place(I, M, place):
    """A place's node, the force that it bears per unit of the law [N], whether it has a preload.

    A point body touches at its node, a body of finite length at both ends. The end of a line
    without a body has no weight of its own; cable that comes down on it end-on would go through
    the floor as far as the first Gauss point is away. Force 0: a place that there is not.
    """
    head = header(I)
    state = scalars(M)
    if place == 2 * head.body_count:
        node = head.nodes - 1
        if node == 0 or I[head.joint + node] > JOINT_BODY or ends_in_something(I, M, node):
            return 0, 0.0, False
        edge = edge_of(I, M, node)
        return node, edge.contact * touchdown_layer(M, edge) * state.end_support, False
    row = body_of(I, M, place // 2)
    node = int(row.node)
    if node < 0:  # on the drum
        return 0, 0.0, True
    if row.length > 0.0:
        if place % 2 == 1:
            node = I[head.parent + node]
        return node, 0.5 * row.weight * row.support[place % 2], True
    return node, row.weight * row.support[0] if place % 2 == 0 else 0.0, True


@kernel
def ends_in_something(I, M, node):
    """Whether a body, a prescribed end or a closure is at a node."""
    head = header(I)
    for body in range(head.body_count):
        if body_of(I, M, body).node == node:
            return True
    for n in range(head.constraint_count):
        if constraint_of(I, M, n).node == node:
            return True
    for n in range(head.closure_count):
        closure = closure_of(I, M, n)
        if closure.clamp == 0.0 and (closure.node == node or closure.other == node):
            return True
    return False


@inlined
def place_mass(I, M, place, node):
    """What a place of contact holds on its bristle [kg]."""
    if place == 2 * header(I).body_count:
        edge = edge_of(I, M, node)
        return edge.mass * touchdown_layer(M, edge)
    return body_of(I, M, place // 2).mass


@kernel
def place_force(I, M, place, load, preload, node, q, v, contact):
    """Normal force of the floor on a place of contact [N], the gap, the speed along the normal.

    load: what the floor bears there at rest [N]. Writes normal, bristle, its `ahead` and force
    along the floor.
    """
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    size = 2 * dimension
    depth = state.floor_depth
    normal = contact.normal
    for i in range(3):
        contact.along[i] = 0.0
    for i in range(dimension):
        contact.place[i] = q[size * node + i]
    gap = gap_at(I, M, contact.place, normal)
    if gap >= depth:
        return 0.0, gap, 0.0
    speed = 0.0
    for i in range(dimension):
        speed += v[size * node + i] * normal[i]
    share, _stiffness, _energy = place_law(preload, gap, depth)
    press = load * share * max(0.0, 1.0 - place_damping(M, preload) * speed)
    if state.friction > 0.0 and press > 0.0:
        bristle_at(I, M, node, contact, dimension)
        contact.ahead = damping_time(M, load, place_mass(I, M, place, node))
        damp_bristle_at(v, node, contact, dimension)
        friction(M, load, press, contact, dimension)
    contact.along[0] += press * tipping(q, node, node, 0, normal, dimension)
    return press, gap, speed
