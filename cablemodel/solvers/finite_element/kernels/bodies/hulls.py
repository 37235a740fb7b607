"""Hulls that pierce the surface: how much of one is wet, and where its buoyancy acts."""

import math

from cablemodel.solvers.finite_element.kernels.bodies.rotation import to_earth_axes
from cablemodel.solvers.finite_element.kernels.water.waves import water_at, wave_at
from cablemodel.solvers.shared.access import free_body_of, header, scalars, vector
from cablemodel.solvers.shared.compile import kernel
from cablemodel.solvers.shared.layout import HULL_SPHERE

COLUMNS = 6  # of equal area, that a cylinder is made of: their ring has its moments of inertia
RING = math.sqrt(0.5)  # of its radius


@kernel
def depth_below(I, M, x, y, z):
    """How deep a place of the block's coordinates lies below the surface [m]."""
    head = header(I)
    state = scalars(M)
    if head.wave_count == 0:
        return -(z + state.origin[2])
    return wave_at(I, M, x, y, z, 1e300, -1, water_at())


@kernel
def wet_hull(I, M, body, centre, middle):
    """Share of a hull that is wet; the place of the wet part's middle (3, body's axes, from the
    reference point) goes into `middle`.

    centre: of the hull, block's coordinates (3). A ball exactly; a cylinder by columns, under a
    surface that is plane over it.
    """
    head = header(I)
    row = free_body_of(I, M, body)
    radius = row.hull_radius
    own = row.hull_centre
    for i in range(3):
        middle[i] = own[i]
    depth = depth_below(I, M, centre[0], centre[1], centre[2])
    if row.hull == HULL_SPHERE:
        h = min(2.0 * radius, max(0.0, radius + depth))
        return h * h * (3.0 * radius - h) / (4.0 * radius**3)
    height = row.hull_height
    m = row.motion
    turn = m.turn
    rise = turn[8]  # of its axis
    tilt = math.sqrt(max(0.0, 1.0 - rise * rise))
    if abs(depth) > 0.5 * height * abs(rise) + 2.0 * radius:  # no wave is so steep
        return 1.0 if depth > 0.0 else 0.0
    slope_x = 0.0
    slope_y = 0.0
    if head.wave_count != 0:
        # Along the way of the waves, over the columns' ring on both sides: the moment of a plane
        # with that slope is that of the wave on a disc, but for (k radius)^4.
        state = scalars(M)
        x = RING * radius * state.wave_x
        y = RING * radius * state.wave_y
        ahead = depth_below(I, M, centre[0] + x, centre[1] + y, centre[2])
        ahead -= depth_below(I, M, centre[0] - x, centre[1] - y, centre[2])
        slope_x = 0.5 * ahead / (RING * radius) * state.wave_x
        slope_y = 0.5 * ahead / (RING * radius) * state.wave_y
    column = vector()  # its middle, then that of its wet part, body's axes
    way = vector()
    # A column has a width: lying down, it is not wet at once.
    half = 0.5 * height * abs(rise) + tilt * radius / math.sqrt(COLUMNS)
    wet = 0.0
    for i in range(3):
        middle[i] = 0.0
    for n in range(COLUMNS):
        angle = 2.0 * math.pi * n / COLUMNS
        column[0] = RING * radius * math.cos(angle)
        column[1] = RING * radius * math.sin(angle)
        column[2] = 0.0
        to_earth_axes(turn, column, way)
        below = depth + slope_x * way[0] + slope_y * way[1] - way[2]
        share = min(1.0, max(0.0, 0.5 * (below / half + 1.0)))
        column[2] = 0.5 * height * (share - 1.0) * (1.0 if rise > 0.0 else -1.0)
        wet += share
        for i in range(3):
            middle[i] += share * column[i]
    if wet == 0.0:
        for i in range(3):
            middle[i] = own[i]
        return 0.0
    for i in range(3):
        middle[i] = own[i] + middle[i] / wet
    return wet / COLUMNS
