"""The sea floor: contact and friction of cable and bodies (docs/engine.md, "Sea floor").

Contact is a spring with a preload: the force per length p over the weight w is 1 at the gap g = 0,
so that cable at rest lies exactly on the floor, fades to nothing at g = delta, and grows
exponentially below. It grows with the speed of approach, too.
Friction is a bristle: f = -mu w e / u, no longer than mu p, where e is the way along the floor from
the place where a node was last at rest. These places stay fixed within a step and are drawn after
the cable between steps (`settle`), so that cable which sticks does not creep.
"""

import math

from .compile import inlined, kernel
from .floor_surface import gap_at, lowest_gap
from .layout import (
    B_LENGTH,
    B_NODE,
    B_WEIGHT,
    BODY_WORDS,
    C_NODE,
    CONSTRAINT_WORDS,
    E_BENDING_FULL,
    E_CONTACT,
    E_LENGTH,
    EDGE_WORDS,
    I_BODIES,
    I_CONSTRAINTS,
    I_DIMENSION,
    I_NODES,
    O_BODY,
    O_CONSTRAINT,
    O_DIAGONAL,
    O_EDGE,
    O_END_FORCE,
    O_JOINT,
    O_LOWER,
    O_MOTION,
    O_PARENT,
    O_POSITION,
    O_REST,
    O_UPPER,
    S_BRISTLE,
    S_FLOOR_DAMPING,
    S_FLOOR_DEPTH,
    S_FRICTION,
)
from .tables import CONTACT_H, CONTACT_POINTS, CONTACT_WEIGHTS

TIPPING = 1e-3  # of the normal force: what tips cable over that stands on its end
LYING = 0.2277  # of delta: the gap where a taut cable would touch a rigid floor


@inlined
def contact_law(gap, depth):
    """Force over its value at rest, its stiffness [1/m], energy over that force [m].

    With y = 2 g/delta: (1 - y/2)^2 above y = 0, exp(-y) below, as steep as at y = -6 from there on:
    a load of p/w sinks by delta/2 ln(p/w), and a Newton iterate that is far too deep comes back.
    """
    e = 0.5 * depth
    y = gap / e
    if y >= 2.0:
        return 0.0, 0.0, 0.0
    if y >= 0.0:
        left = 1.0 - 0.5 * y
        return left * left, left / e, 2.0 / 3.0 * e * left * left * left
    deeper = max(0.0, -y - 6.0)
    share = math.exp(min(-y, 6.0))
    energy = share * (1.0 + deeper + 0.5 * deeper * deeper) - 1.0 / 3.0
    return share * (1.0 + deeper), share / e, e * energy


@inlined
def friction(I, M, q, parent, node, x, contact, press, w):
    """Friction per length into w[9:12], bristle e in w[6:9]; the normal is in w[3:6].

    e is linear between the nodes; its part along the normal has been removed. Returns whether it
    sticks, the length of e and the stiffness: minus force over e.
    """
    dimension = I[I_DIMENSION]
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
def interpolate(I, q, parent, node, h, p, w):
    """A vector field of an element at contact point p into w[0:3]."""
    dimension = I[I_DIMENSION]
    a = 2 * dimension * parent
    b = 2 * dimension * node
    for i in range(dimension):
        w[i] = CONTACT_H[p, 0] * q[a + i] + h * CONTACT_H[p, 1] * q[a + dimension + i]
        w[i] += CONTACT_H[p, 2] * q[b + i] + h * CONTACT_H[p, 3] * q[b + dimension + i]


@inlined
def approach(I, v, parent, node, h, p, w):
    """Speed of contact point p along the normal in w[3:6] [m/s]."""
    dimension = I[I_DIMENSION]
    a = 2 * dimension * parent
    b = 2 * dimension * node
    speed = 0.0
    for i in range(dimension):
        rate = CONTACT_H[p, 0] * v[a + i] + h * CONTACT_H[p, 1] * v[a + dimension + i]
        rate += CONTACT_H[p, 2] * v[b + i] + h * CONTACT_H[p, 3] * v[b + dimension + i]
        speed += rate * w[3 + i]
    return speed


@inlined
def tipping(I, q, parent, node, p, w):
    """Share of the normal force that pushes cable over that stands on its end, along x.

    Exactly vertical cable would stand on the floor as no column can. The share is nothing where
    cable lies: it falls with the eighth power of the tangent along the normal.
    """
    dimension = I[I_DIMENSION]
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
def contact_force(I, M, q, v, parent, node, h, p, contact, w):
    """Normal force per length at contact point p of an element [N/m], 0 where it does not touch.

    Position into w[0:3], normal into w[3:6], what acts along the floor [N/m] into w[9:12]. Returns
    force, gap and speed of approach.
    """
    dimension = I[I_DIMENSION]
    interpolate(I, q, parent, node, h, p, w)
    gap = gap_at(I, M, w, w[3:6])
    for i in range(dimension):
        w[9 + i] = 0.0
    if gap >= M[S_FLOOR_DEPTH]:
        return 0.0, gap, 0.0
    speed = approach(I, v, parent, node, h, p, w)
    share, _stiffness, _energy = contact_law(gap, M[S_FLOOR_DEPTH])
    press = contact * share
    press *= max(0.0, 1.0 - M[S_FLOOR_DAMPING] * speed)
    if M[S_FRICTION] > 0.0 and press > 0.0:
        friction(I, M, q, parent, node, CONTACT_POINTS[p], contact, press, w)
    w[9] += press * tipping(I, q, parent, node, p, w)
    return press, gap, speed


@kernel
def floor_residual(I, M, q, v, out):
    """Subtract the floor's forces on cable and bodies from the forces that are left at the nodes.

    The elements' end forces get their share, so that tensions inside the line know of the floor.
    """
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    w = M[I[O_MOTION] + 28 : I[O_MOTION] + 52]
    depth = M[S_FLOOR_DEPTH]
    for node in range(1, I[I_NODES]):
        if I[I[O_JOINT] + node] != 0:
            continue
        if lowest_gap(I, M, q, node, w) >= depth:
            continue
        parent = I[I[O_PARENT] + node]
        edge = I[O_EDGE] + node * EDGE_WORDS
        h = M[edge + E_LENGTH]
        contact = M[edge + E_CONTACT]
        for p in range(4):
            press, gap, _speed = contact_force(I, M, q, v, parent, node, h, p, contact, w)
            if gap >= depth:
                continue
            weight = h * CONTACT_WEIGHTS[p]
            n0 = CONTACT_H[p, 0]
            n1 = h * CONTACT_H[p, 1]
            n2 = CONTACT_H[p, 2]
            n3 = h * CONTACT_H[p, 3]
            for i in range(dimension):
                force = weight * (press * w[3 + i] + w[9 + i])
                out[size * parent + i] -= n0 * force
                out[size * parent + dimension + i] -= n1 * force
                out[size * node + i] -= n2 * force
                out[size * node + dimension + i] -= n3 * force
                M[I[O_END_FORCE] + size * node + i] += n0 * force
                M[I[O_END_FORCE] + size * node + dimension + i] -= n2 * force
    for place in range(contact_places(I)):
        node, contact, preload = contact_place(I, M, place)
        if contact <= 0.0:
            continue
        press, _gap, _speed = place_force(I, M, contact, preload, node, q, v, w)
        for i in range(dimension):
            out[size * node + i] -= press * w[3 + i] + w[9 + i]


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
        if node == 0 or ends_in_something(I, M, node):
            return 0, 0.0, False
        edge = I[O_EDGE] + node * EDGE_WORDS
        layer = (M[edge + E_BENDING_FULL] / M[edge + E_CONTACT]) ** (1.0 / 3.0)
        return node, M[edge + E_CONTACT] * layer, False
    row = I[O_BODY] + place // 2 * BODY_WORDS
    node = int(M[row + B_NODE])
    if node < 0:  # on the drum
        return 0, 0.0, True
    if M[row + B_LENGTH] > 0.0:
        if place % 2 == 1:
            node = I[I[O_PARENT] + node]
        return node, 0.5 * M[row + B_WEIGHT], True
    return node, M[row + B_WEIGHT] if place % 2 == 0 else 0.0, True


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
    gap = gap_at(I, M, w, w[3:6])
    if gap >= depth:
        return 0.0, gap, 0.0
    speed = 0.0
    for i in range(dimension):
        speed += v[size * node + i] * w[3 + i]
    share, _stiffness, _energy = place_law(preload, gap, depth)
    press = contact * share * max(0.0, 1.0 - M[S_FLOOR_DAMPING] * speed)
    if M[S_FRICTION] > 0.0 and press > 0.0:
        friction(I, M, q, node, node, 0.0, contact, press, w)
    w[9] += press * tipping(I, q, node, node, 0, w)
    return press, gap, speed


@kernel
def add_block(I, M, at, k, l, h, value, ni, nj, w, project):
    """Add value (ni nj^T, or 1 - n n^T with project) for shape functions k, l to a matrix block."""
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    scale = value
    if k % 2 == 1:
        scale *= h
    if l % 2 == 1:
        scale *= h
    row = dimension * (k % 2)
    column = dimension * (l % 2)
    for i in range(dimension):
        for j in range(dimension):
            entry = w[ni + i] * w[nj + j]
            if project:
                entry = -entry
                if i == j:
                    entry += 1.0
            M[at + size * (row + i) + column + j] += scale * entry


@kernel
def block_of(I, node, k, l):
    """Where the block of shape functions k (row) and l (column) of an element starts."""
    area = 4 * I[I_DIMENSION] * I[I_DIMENSION]
    parent = I[I[O_PARENT] + node]
    if k < 2 and l < 2:
        return I[O_DIAGONAL] + area * parent
    if k >= 2 and l >= 2:
        return I[O_DIAGONAL] + area * node
    if k < 2:
        return I[O_UPPER] + area * node
    return I[O_LOWER] + area * node


@kernel
def floor_jacobian(I, M, q, v, cv):
    """Add the derivatives of the floor's forces to the blocks of the effective Jacobian."""
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    w = M[I[O_MOTION] + 28 : I[O_MOTION] + 52]
    depth = M[S_FLOOR_DEPTH]
    damping = M[S_FLOOR_DAMPING]
    rubs = M[S_FRICTION] > 0.0
    for node in range(1, I[I_NODES]):
        if I[I[O_JOINT] + node] != 0:
            continue
        if lowest_gap(I, M, q, node, w) >= depth:
            continue
        parent = I[I[O_PARENT] + node]
        edge = I[O_EDGE] + node * EDGE_WORDS
        h = M[edge + E_LENGTH]
        contact = M[edge + E_CONTACT]
        for p in range(4):
            interpolate(I, q, parent, node, h, p, w)
            gap = gap_at(I, M, w, w[3:6])
            if gap >= depth:
                continue
            speed = approach(I, v, parent, node, h, p, w)
            free = max(0.0, 1.0 - damping * speed)
            if free == 0.0:
                continue
            share, stiffness, _energy = contact_law(gap, depth)
            spring = contact * share
            stiff = contact * stiffness * free + cv * damping * spring
            x = CONTACT_POINTS[p]
            sticks = True
            rub = 0.0
            if rubs:
                sticks, length, rub = friction(I, M, q, parent, node, x, contact, spring * free, w)
                if not sticks:
                    for i in range(dimension):
                        w[6 + i] /= length
            weight = h * CONTACT_WEIGHTS[p]
            for k in range(4):
                for l in range(4):
                    at = block_of(I, node, k, l)
                    value = weight * CONTACT_H[p, k] * CONTACT_H[p, l]
                    add_block(I, M, at, k, l, h, value * stiff, 3, 3, w, False)
                    if not rubs:
                        continue
                    if not sticks:
                        push = -value * M[S_FRICTION] * stiff
                        add_block(I, M, at, k, l, h, push, 6, 3, w, False)
                    if l % 2 == 0:
                        # The bristle is linear between the nodes.
                        part = 1.0 - x if l == 0 else x
                        value = weight * CONTACT_H[p, k] * part * rub
                        add_block(I, M, at, k, l, h, value, 3, 3, w, True)
                        if not sticks:
                            add_block(I, M, at, k, l, h, -value, 6, 6, w, False)
    for place in range(contact_places(I)):
        node, contact, preload = contact_place(I, M, place)
        if contact <= 0.0:
            continue
        press, gap, speed = place_force(I, M, contact, preload, node, q, v, w)
        if press <= 0.0:
            continue
        _share, stiffness, _energy = place_law(preload, gap, depth)
        free = 1.0 - damping * speed
        stiff = contact * stiffness * free + cv * damping * press / free
        at = I[O_DIAGONAL] + size * size * node
        add_block(I, M, at, 0, 0, 1.0, stiff, 3, 3, w, False)
        if rubs:
            sticks, length, rub = friction(I, M, q, node, node, 0.0, contact, press, w)
            add_block(I, M, at, 0, 0, 1.0, rub, 3, 3, w, True)
            if not sticks:
                for i in range(dimension):
                    w[6 + i] /= length
                add_block(I, M, at, 0, 0, 1.0, -rub, 6, 6, w, False)
                add_block(I, M, at, 0, 0, 1.0, -M[S_FRICTION] * stiff, 6, 3, w, False)


@kernel
def settle(I, M):
    """Draw the places of rest after nodes that have slipped or left the floor (return mapping)."""
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    w = M[I[O_MOTION] + 28 : I[O_MOTION] + 52]
    depth = M[S_FLOOR_DEPTH]
    q = M[I[O_POSITION] : I[O_POSITION] + size * I[I_NODES]]
    for node in range(I[I_NODES]):
        rest = I[O_REST] + 3 * node
        for i in range(dimension):
            w[i] = q[size * node + i]
        gap = gap_at(I, M, w, w[3:6])
        share, _stiffness, _energy = contact_law(gap, depth)
        limit = M[S_BRISTLE] * share
        along = 0.0
        for i in range(dimension):
            w[6 + i] = w[i] - M[rest + i]
            along += w[6 + i] * w[3 + i]
        length = 0.0
        for i in range(dimension):
            w[6 + i] -= along * w[3 + i]
            length += w[6 + i] ** 2
        length = math.sqrt(length)
        if length > limit:
            for i in range(dimension):
                M[rest + i] = w[i] - w[6 + i] * (limit / length)
