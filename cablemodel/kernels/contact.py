"""Contact of cable and bodies with the sea floor, and friction (docs/engine.md, "Sea floor").

Contact is a spring with a preload: the force per length over what it is at rest is 1 at the gap
g = 0, so that cable at rest lies exactly on the floor, fades to nothing at g = delta, and stiffens
below. It grows with the speed of approach. At rest the floor bears the weight w, or what it has
borne for long (`floor_memory`). Friction is a bristle: f = -mu p0 e / u, no longer than mu p, where
p0 is the force at rest and e the way along the floor from the place where a node was last at rest.
"""

import math

from .compile import inlined, kernel, view
from .floor_surface import gap_at, gap_below
from .layout import (
    B_BORNE,
    B_LENGTH,
    B_NODE,
    B_WEIGHT,
    BODY_WORDS,
    C_NODE,
    CONSTRAINT_WORDS,
    E_BENDING_FULL,
    E_CONTACT,
    EDGE_WORDS,
    I_BODIES,
    I_CONSTRAINTS,
    I_DIMENSION,
    I_NODES,
    JOINT_BODY,
    O_BODY,
    O_CONSTRAINT,
    O_EDGE,
    O_JOINT,
    O_PARENT,
    O_REST,
    S_BRISTLE,
    S_END_BORNE,
    S_FLOOR_DAMPING,
    S_FLOOR_DEPTH,
    S_FRICTION,
)
from .tables import CONTACT_H, CONTACT_POINTS, STEEPEST, STIFFENING

TIPPING = 1e-3  # of the normal force: what tips cable over that stands on its end
LYING = 0.2277  # of delta: the gap where a taut cable would touch a rigid floor


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
def friction(I, M, q, parent, node, x, contact, press, w, dimension):
    """Friction per length into w[9:12], bristle e in w[6:9]; the normal is in w[3:6].

    e is linear between the nodes; its part along the normal has been removed. Returns whether it
    sticks, the length of e and the stiffness: minus force over e.
    """
    size = 2 * dimension
    rest = I[O_REST]
    along = 0.0
    for i in range(dimension):
        e0 = q[size * parent + i] - M[rest + 3 * parent + i]
        e1 = q[size * node + i] - M[rest + 3 * node + i]
        w[6 + i] = (1.0 - x) * e0 + x * e1
        along += w[6 + i] * w[3 + i]
    length = 0.0
    for i in range(dimension):
        w[6 + i] -= along * w[3 + i]
        length += w[6 + i] ** 2
    length = math.sqrt(length)
    stiffness = M[S_FRICTION] * contact / M[S_BRISTLE]
    limit = M[S_FRICTION] * press
    sticks = stiffness * length <= limit
    if not sticks:
        stiffness = limit / length
    for i in range(dimension):
        w[9 + i] = -stiffness * w[6 + i]
    return sticks, length, stiffness


@inlined
def interpolate(I, q, parent, node, h, p, w, dimension):
    """A vector field of an element at contact point p into w[0:3]."""
    a = 2 * dimension * parent
    b = 2 * dimension * node
    for i in range(dimension):
        w[i] = CONTACT_H[p, 0] * q[a + i] + h * CONTACT_H[p, 1] * q[a + dimension + i]
        w[i] += CONTACT_H[p, 2] * q[b + i] + h * CONTACT_H[p, 3] * q[b + dimension + i]


@inlined
def approach(I, v, parent, node, h, p, w, dimension):
    """Speed of contact point p along the normal in w[3:6] [m/s]."""
    a = 2 * dimension * parent
    b = 2 * dimension * node
    speed = 0.0
    for i in range(dimension):
        rate = CONTACT_H[p, 0] * v[a + i] + h * CONTACT_H[p, 1] * v[a + dimension + i]
        rate += CONTACT_H[p, 2] * v[b + i] + h * CONTACT_H[p, 3] * v[b + dimension + i]
        speed += rate * w[3 + i]
    return speed


@inlined
def tipping(I, q, parent, node, p, w, dimension):
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
        upright += slope * w[3 + i]
        square += slope * slope
    upright = upright * upright / square
    upright *= upright
    return TIPPING * upright * upright


@inlined
def contact_force(I, M, q, v, parent, node, h, p, contact, w, dimension):
    """Normal force per length at contact point p of an element [N/m], 0 where it does not touch.

    Position into w[0:3], normal into w[3:6], what acts along the floor [N/m] into w[9:12]. Returns
    force, gap and speed of approach.
    """
    interpolate(I, q, parent, node, h, p, w, dimension)
    gap = gap_below(I, M, w, view(w, 3, 3), dimension)
    for i in range(dimension):
        w[9 + i] = 0.0
    if gap >= M[S_FLOOR_DEPTH]:
        return 0.0, gap, 0.0
    speed = approach(I, v, parent, node, h, p, w, dimension)
    share, _stiffness, _energy = contact_law(gap, M[S_FLOOR_DEPTH])
    press = contact * share
    press *= max(0.0, 1.0 - M[S_FLOOR_DAMPING] * speed)
    if M[S_FRICTION] > 0.0 and press > 0.0:
        friction(I, M, q, parent, node, CONTACT_POINTS[p], contact, press, w, dimension)
    w[9] += press * tipping(I, q, parent, node, p, w, dimension)
    return press, gap, speed


@kernel
def touchdown_layer(M, edge):
    """Length over which bending spreads a touchdown [m]."""
    return (M[edge + E_BENDING_FULL] / M[edge + E_CONTACT]) ** (1.0 / 3.0)


@inlined
def contact_places(I):
    """How many places touch as points: two of each body, and the line's end."""
    return 2 * I[I_BODIES] + 1


@kernel
def contact_place(I, M, place):
    """A place's node, the force that it bears per unit of the law [N], whether it has a preload.

    A point body touches at its node, a body of finite length at both ends. The end of a line
    without a body has no weight of its own; cable that comes down on it end-on would go through
    the floor as far as the first Gauss point is away. Force 0: a place that there is not.
    """
    if place == 2 * I[I_BODIES]:
        node = I[I_NODES] - 1
        if node == 0 or I[I[O_JOINT] + node] > JOINT_BODY or ends_in_something(I, M, node):
            return 0, 0.0, False
        edge = I[O_EDGE] + node * EDGE_WORDS
        return node, M[edge + E_CONTACT] * touchdown_layer(M, edge) * M[S_END_BORNE], False
    row = I[O_BODY] + place // 2 * BODY_WORDS
    node = int(M[row + B_NODE])
    if node < 0:  # on the drum
        return 0, 0.0, True
    if M[row + B_LENGTH] > 0.0:
        if place % 2 == 1:
            node = I[I[O_PARENT] + node]
        return node, 0.5 * M[row + B_WEIGHT] * M[row + B_BORNE + place % 2], True
    return node, M[row + B_WEIGHT] * M[row + B_BORNE] if place % 2 == 0 else 0.0, True


@kernel
def ends_in_something(I, M, node):
    """Whether a body or a prescribed end sits at a node."""
    for body in range(I[I_BODIES]):
        if M[I[O_BODY] + body * BODY_WORDS + B_NODE] == node:
            return True
    for n in range(I[I_CONSTRAINTS]):
        if M[I[O_CONSTRAINT] + n * CONSTRAINT_WORDS + C_NODE] == node:
            return True
    return False


@kernel
def place_force(I, M, contact, preload, node, q, v, w):
    """Normal force of the floor on a place of contact [N], the gap, the speed along the normal.

    The normal goes into w[3:6], friction [N] into w[9:12].
    """
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    depth = M[S_FLOOR_DEPTH]
    for i in range(3):
        w[i] = 0.0
        w[9 + i] = 0.0
    for i in range(dimension):
        w[i] = q[size * node + i]
    gap = gap_at(I, M, w, view(w, 3, 3))
    if gap >= depth:
        return 0.0, gap, 0.0
    speed = 0.0
    for i in range(dimension):
        speed += v[size * node + i] * w[3 + i]
    share, _stiffness, _energy = place_law(preload, gap, depth)
    press = contact * share * max(0.0, 1.0 - M[S_FLOOR_DAMPING] * speed)
    if M[S_FRICTION] > 0.0 and press > 0.0:
        friction(I, M, q, node, node, 0.0, contact, press, w, dimension)
    w[9] += press * tipping(I, q, node, node, 0, w, dimension)
    return press, gap, speed
