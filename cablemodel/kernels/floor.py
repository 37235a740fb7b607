"""The sea floor: contact and friction of cable and bodies (docs/engine.md, "Sea floor").

Contact is a spring with a preload: the force per length is p = w (1 - g/delta) below the gap
g = delta, so that cable at rest lies exactly on the floor. It grows with the speed of approach.
Friction is a bristle: f = -mu w e / u, no longer than mu p, where e is the way along the floor from
the place where a node was last at rest. These places stay fixed within a step and are drawn after
the cable between steps (`settle`), so that cable which sticks does not creep.
"""

import math

from .compile import inlined, kernel
from .layout import (
    B_LENGTH,
    B_NODE,
    B_WEIGHT,
    BODY_WORDS,
    E_CONTACT,
    E_LENGTH,
    EDGE_WORDS,
    FLOOR_PLANE,
    I_BODIES,
    I_DIMENSION,
    I_FLOOR,
    I_FLOOR_X,
    I_FLOOR_Y,
    I_NODES,
    O_BODY,
    O_DIAGONAL,
    O_EDGE,
    O_END_FORCE,
    O_FLOOR,
    O_JOINT,
    O_LOWER,
    O_MOTION,
    O_PARENT,
    O_POSITION,
    O_REST,
    O_UPPER,
    S_BASE,
    S_BRISTLE,
    S_FLOOR_BEND,
    S_FLOOR_DAMPING,
    S_FLOOR_DEPTH,
    S_FLOOR_PLANE,
    S_FLOOR_TOP,
    S_FRICTION,
    S_PLANE,
)
from .tables import CONTACT_H, CONTACT_POINTS, CONTACT_WEIGHTS

TIPPING = 1e-3  # of the normal force: what tips cable over that stands on its end


@kernel
def interval(M, grid, count, x):
    """The interval of an ascending grid that holds x, and the place in it (0 to 1)."""
    if x <= M[grid]:
        return 0, 0.0
    if x >= M[grid + count - 1]:
        return count - 2, 1.0
    low = 0
    high = count - 1
    while high - low > 1:
        middle = (low + high) // 2
        if x >= M[grid + middle]:
            low = middle
        else:
            high = middle
    return low, (x - M[grid + low]) / (M[grid + low + 1] - M[grid + low])


@kernel
def table_height(I, M, x, y):
    """Height and slopes at a place (earth) of the table: bicubic, C1; level beyond its edges."""
    nx = I[I_FLOOR_X]
    ny = I[I_FLOOR_Y]
    grid_x = I[O_FLOOR]
    grid_y = grid_x + nx
    data = grid_y + ny
    i, u = interval(M, grid_x, nx, x)
    hx = M[grid_x + i + 1] - M[grid_x + i]
    j = 0
    w = 0.0
    hy = 1.0
    if ny > 1:
        j, w = interval(M, grid_y, ny, y)
        hy = M[grid_y + j + 1] - M[grid_y + j]
    z = 0.0
    zx = 0.0
    zy = 0.0
    for a in range(2):
        n0, n1, d0, d1 = cubic_end(a, u, hx)
        for b in range(2):
            if b == 1 and ny == 1:
                continue
            m0 = 1.0
            m1 = 0.0
            e0 = 0.0
            e1 = 0.0
            if ny > 1:
                m0, m1, e0, e1 = cubic_end(b, w, hy)
            at = data + 4 * ((i + a) * ny + j + b)
            along = n0 * M[at] + n1 * M[at + 1]
            across = n0 * M[at + 2] + n1 * M[at + 3]
            z += m0 * along + m1 * across
            zx += m0 * (d0 * M[at] + d1 * M[at + 1]) + m1 * (d0 * M[at + 2] + d1 * M[at + 3])
            zy += e0 * along + e1 * across
    outside = x < M[grid_x] or x > M[grid_x + nx - 1]
    if outside:
        zx = 0.0
    if ny > 1 and (y < M[grid_y] or y > M[grid_y + ny - 1]):
        zy = 0.0
    return z, zx, zy


@inlined
def cubic_end(end, u, h):
    """Cubic Hermite functions of value and slope at one end of an interval, and derivatives."""
    v = 1.0 - u
    if end == 0:
        return (
            v * v * (1.0 + 2.0 * u),
            h * u * v * v,
            -6.0 * u * v / h,
            v * (1.0 - 3.0 * u),
        )
    return (
        u * u * (3.0 - 2.0 * u),
        -h * u * u * v,
        6.0 * u * v / h,
        u * (3.0 * u - 2.0),
    )


@kernel
def gap_at(I, M, r, n):
    """Gap between a point r (dimension words, block coordinates) and the floor [m].

    Along the floor's normal, which goes into n (dimension words).
    """
    x = M[S_BASE] + r[0]
    y = M[S_BASE + 1] + r[1]
    planar = I[I_DIMENSION] == 2
    if planar:
        x = M[S_BASE] + M[S_PLANE] * r[0]
        y = M[S_BASE + 1] + M[S_PLANE + 1] * r[0]
    if I[I_FLOOR] == FLOOR_PLANE:
        zx = M[S_FLOOR_PLANE + 1]
        zy = M[S_FLOOR_PLANE + 2]
        z = M[S_FLOOR_PLANE]
        z += zx * (x - M[S_FLOOR_PLANE + 3]) + zy * (y - M[S_FLOOR_PLANE + 4])
    else:
        z, zx, zy = table_height(I, M, x, y)
    nz = 1.0 / math.sqrt(1.0 + zx * zx + zy * zy)
    if planar:
        n[0] = -(M[S_PLANE] * zx + M[S_PLANE + 1] * zy) * nz
        n[1] = nz
        return (r[1] + M[S_BASE + 2] - z) * nz
    n[0] = -zx * nz
    n[1] = -zy * nz
    n[2] = nz
    return (r[2] + M[S_BASE + 2] - z) * nz


@kernel
def lowest_gap(I, M, q, node, w):
    """A gap that no point of an element undercuts, by the convex hull of its Bezier points [m].

    The element's gap itself where that is below some metres, something large far above the floor.
    """
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    parent = I[I[O_PARENT] + node]
    h = M[I[O_EDGE] + node * EDGE_WORDS + E_LENGTH]
    up = dimension - 1
    lowest = 1e300
    for k in range(4):
        end = parent if k < 2 else node
        third = 0.0
        if k == 1:
            third = h / 3.0
        elif k == 2:
            third = -h / 3.0
        lowest = min(lowest, q[size * end + up] + third * q[size * end + dimension + up])
    clear = lowest + M[S_BASE + 2] - M[S_FLOOR_TOP]
    if clear > 4.0 * h + M[S_FLOOR_DEPTH]:
        return clear
    lowest = 1e300
    for k in range(4):
        end = parent if k < 2 else node
        third = 0.0
        if k == 1:
            third = h / 3.0
        elif k == 2:
            third = -h / 3.0
        for i in range(dimension):
            w[i] = q[size * end + i] + third * q[size * end + dimension + i]
        lowest = min(lowest, gap_at(I, M, w, w[3:6]))
    return lowest - M[S_FLOOR_BEND] * h * h


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
    press = contact * (1.0 - gap / M[S_FLOOR_DEPTH])
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
    for body in range(I[I_BODIES]):
        points = contact_points(I, M, body)
        for point in range(points):
            node = contact_node(I, M, body, point)
            contact = M[I[O_BODY] + body * BODY_WORDS + B_WEIGHT] / points
            press = body_force(I, M, contact, node, q, v, w)
            for i in range(dimension):
                out[size * node + i] -= press * w[3 + i] + w[9 + i]


@kernel
def contact_points(I, M, body):
    """Where a body touches: its node and one place, both ends of a finite body; 0: on the drum."""
    row = I[O_BODY] + body * BODY_WORDS
    if M[row + B_NODE] < 0.0:
        return 0
    return 2 if M[row + B_LENGTH] > 0.0 else 1


@kernel
def contact_node(I, M, body, point):
    """Node of a body's place of contact: its own, or its other end."""
    node = int(M[I[O_BODY] + body * BODY_WORDS + B_NODE])
    return node if point == 0 else I[I[O_PARENT] + node]


@kernel
def body_force(I, M, contact, node, q, v, w):
    """Normal force of the floor on a body's end that bears the weight `contact` at rest [N].

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
    if gap >= depth or contact <= 0.0:
        return 0.0
    speed = 0.0
    for i in range(dimension):
        speed += v[size * node + i] * w[3 + i]
    press = contact * (1.0 - gap / depth) * max(0.0, 1.0 - M[S_FLOOR_DAMPING] * speed)
    if M[S_FRICTION] > 0.0 and press > 0.0:
        friction(I, M, q, node, node, 0.0, contact, press, w)
    w[9] += press * tipping(I, q, node, node, 0, w)
    return press


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
            spring = contact * (1.0 - gap / depth)
            stiff = contact / depth * free + cv * damping * spring
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
    for body in range(I[I_BODIES]):
        points = contact_points(I, M, body)
        for point in range(points):
            node = contact_node(I, M, body, point)
            contact = M[I[O_BODY] + body * BODY_WORDS + B_WEIGHT] / points
            press = body_force(I, M, contact, node, q, v, w)
            if press <= 0.0:
                continue
            speed = 0.0
            for i in range(dimension):
                speed += v[size * node + i] * w[3 + i]
            free = 1.0 - damping * speed
            stiff = contact / depth * free + cv * damping * press / free
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
        limit = M[S_BRISTLE] * max(0.0, 1.0 - gap / depth)
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
