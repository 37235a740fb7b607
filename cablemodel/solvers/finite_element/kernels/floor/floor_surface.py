"""The sea floor as a surface: height and slopes at a place, the gap below a point or an element."""

import math

from cablemodel.solvers.shared.access import (
    edge_of,
    floor_place_at,
    header,
    scalars,
    vector,
)
from cablemodel.solvers.shared.compile import inlined, kernel, view
from cablemodel.solvers.shared.environment import interval
from cablemodel.solvers.shared.layout import (
    FLOOR_PLACE_WORDS,
    FLOOR_PLANE,
)

FAR_ABOVE = 4.0  # of an element, above the highest floor: no nearer gap is looked for


@kernel
def table_height(I, M, x, y):
    """Height and slopes at a place (earth) of the table: bicubic, C1; level beyond its edges."""
    head = header(I)
    nx = head.floor_columns
    ny = head.floor_rows
    grid_x = head.floor
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
            at = floor_place_at(M, data + FLOOR_PLACE_WORDS * ((i + a) * ny + j + b))
            along = n0 * at.z + n1 * at.by_x
            across = n0 * at.by_y + n1 * at.by_xy
            z += m0 * along + m1 * across
            zx += m0 * (d0 * at.z + d1 * at.by_x) + m1 * (d0 * at.by_y + d1 * at.by_xy)
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
    head = header(I)
    state = scalars(M)
    x = state.origin[0] + r[0]
    y = state.origin[1] + r[1]
    planar = head.dimension == 2
    if planar:
        x = state.origin[0] + state.plane[0] * r[0]
        y = state.origin[1] + state.plane[1] * r[0]
    if head.floor_kind == FLOOR_PLANE:
        zx = state.floor_plane[1]
        zy = state.floor_plane[2]
        z = state.floor_plane[0]
        z += zx * (x - state.floor_plane[3]) + zy * (y - state.floor_plane[4])
    else:
        z, zx, zy = table_height(I, M, x, y)
    if zx == 0.0 and zy == 0.0:
        level = 1 if planar else 2
        n[0] = 0.0
        n[1] = 0.0
        n[level] = 1.0
        return r[level] + state.origin[2] - z
    nz = 1.0 / math.sqrt(1.0 + zx * zx + zy * zy)
    if planar:
        n[0] = -(state.plane[0] * zx + state.plane[1] * zy) * nz
        n[1] = nz
        return (r[1] + state.origin[2] - z) * nz
    n[0] = -zx * nz
    n[1] = -zy * nz
    n[2] = nz
    return (r[2] + state.origin[2] - z) * nz


@inlined
def is_level(I, M):
    """Whether the floor is a plane without a slope, whose top is its height everywhere."""
    head = header(I)
    state = scalars(M)
    return head.floor_kind == FLOOR_PLANE and state.floor_top == state.floor_plane[0]


@inlined
def gap_below(I, M, r, n, dimension):
    """As `gap_at`, for callers that know the dimension; quick over a level floor."""
    state = scalars(M)
    if is_level(I, M):
        for i in range(dimension - 1):
            n[i] = 0.0
        n[dimension - 1] = 1.0
        return r[dimension - 1] + state.origin[2] - state.floor_top
    return gap_at(I, M, r, n)


@inlined
def bezier_third(k, h):
    """How far along its end's slope Bezier point k of an element lies from that end [m]."""
    if k == 1:
        return h / 3.0
    if k == 2:
        return -h / 3.0
    return 0.0


@kernel
def lowest_gap(I, M, q, node):
    """A gap that no point of an element undercuts, by the convex hull of its Bezier points [m].

    The element's gap itself where that is below some metres, something large far above the floor.
    """
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    size = 2 * dimension
    parent = I[head.parent + node]
    h = edge_of(I, M, node).length
    up = dimension - 1
    lowest = 1e300
    for k in range(4):
        end = parent if k < 2 else node
        third = bezier_third(k, h)
        lowest = min(lowest, q[size * end + up] + third * q[size * end + dimension + up])
    clear = lowest + state.origin[2] - state.floor_top
    if clear > FAR_ABOVE * h + state.floor_depth or is_level(I, M):
        return clear
    place = vector()
    normal = vector()
    begin = vector()
    lowest = 1e300
    first = 0.0
    for k in range(4):
        end = parent if k < 2 else node
        third = bezier_third(k, h)
        for i in range(dimension):
            place[i] = q[size * end + i] + third * q[size * end + dimension + i]
        if k == 0 or head.floor_kind != FLOOR_PLANE:
            gap = gap_at(I, M, place, normal)
            first = gap
            for i in range(dimension):
                begin[i] = place[i]
        else:
            gap = first
            for i in range(dimension):
                gap += normal[i] * (place[i] - begin[i])
        lowest = min(lowest, gap)
    return lowest - state.floor_bend * h * h


@kernel
def near_floor(I, M, node, q):
    """Whether a node is so near to the floor that it may bear on it."""
    dimension = header(I).dimension
    place = view(q, 2 * dimension * node, dimension)
    return gap_at(I, M, place, vector()) < scalars(M).floor_depth
