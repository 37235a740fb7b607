"""Surface waves: motion of the water below a free surface, and its forces on the cable.

Airy waves over a depth h, k (x cos b + y sin b) - w t + phase = theta:

    elevation a cos(theta), u = a w (e^kz + E e^-kz) / (1 - E) cos(theta) along b,
    w = a w (e^kz - E e^-kz) / (1 - E) sin(theta) upwards, E = e^-2kh,

accelerations are their derivatives in time at a fixed place. Above still water the motion is that
at z = 0. A ramp in time takes the waves from calm water.

Above the surface there is neither buoyancy nor drag nor added mass: a share s is wet (wetting.py).
Loads per unit length on a cable, u relative velocity, a_w acceleration of the water, P across:

    s [drag(u) - ma P (a - a_w) + rho A a_w] + s (m g - w) e_z - m g e_z

(drag with a share of its own where s is below 0); a_w holds what a current that changes in time
has, too.

Sun & Leonard 1998, eqs. 22 and 23, with the Froude-Krylov force rho A a_w, along the line too: the
tension is the effective one, whose weight is that in water.
"""

import math

from cablemodel.solvers.finite_element.kernels.element.tables import H0, H1, H2, H3
from cablemodel.solvers.finite_element.kernels.water.airy import living, sum_components
from cablemodel.solvers.finite_element.kernels.water.sea_cells import is_kept, keep, sum_in_cell
from cablemodel.solvers.finite_element.kernels.water.wetting import (
    drag_shares,
    share_at,
    wet_shares,
)
from cablemodel.solvers.shared.access import cable_of, cell_of, header, scalars, vector, word_of
from cablemodel.solvers.shared.compile import kernel, outlined, own_record, view
from cablemodel.solvers.shared.environment import current_at, surge_at
from cablemodel.solvers.shared.layout import EDGE_WORDS, POINT_WORDS
from cablemodel.solvers.shared.record import Record, real, reals

SMALLEST = 1e-3  # half of the band around the surface, at least [m]


class Water(Record):
    """The water at a place: block's coordinates, in a plane the first two of three."""

    velocity = reals(3, "by the waves", "m/s")
    acceleration = reals(3, "by the waves, and by a current that changes in time", "m/s2")
    wet = real("share of what is there that is wet")
    slope = real("what that share changes by upwards", "1/m")


water_at = own_record(Water)


@kernel
def set_wave_time(M, t):
    """Time, share of the waves (0 to 1, quintic) and its derivative; calm until t = 0."""
    state = scalars(M)
    state.wave_time = t
    state.wave_rise = 0.0
    state.wave_share = 1.0 if t > 0.0 else 0.0
    if 0.0 < t and t < state.wave_ramp:
        x = t / state.wave_ramp
        state.wave_share = x * x * x * (10.0 + x * (6.0 * x - 15.0))
        state.wave_rise = 30.0 * x * x * (1.0 - x) ** 2 / state.wave_ramp


@outlined
def wave_at(I, M, x, y, z, reach, slot, water):
    """Waves at a place of the block's coordinates (planar: x along the plane, y is not read).

    Writes velocity and acceleration of the water. Returns how deep the place lies below the surface
    [m], or, where no trough comes within the reach [m] of it, below still water: on the same
    element a crest's height less or more. slot: where the sea's cell about the place may be kept
    (sea_cells.py); -1: its components are summed for this place alone.
    """
    head = header(I)
    state = scalars(M)
    velocity = water.velocity
    acceleration = water.acceleration
    planar = head.dimension == 2
    if planar:
        y = state.origin[1] + state.plane[1] * x
        x = state.origin[0] + state.plane[0] * x
    else:
        x += state.origin[0]
        y += state.origin[1]
    height = z + state.origin[2]
    level = max(min(height, 0.0), -state.wave_depth)
    near = height > -2.0 * state.wave_crest - reach
    share = state.wave_share
    rise = state.wave_rise
    way = state.wave_x * x + state.wave_y * y
    calm = share == 0.0 and rise == 0.0  # as in static starts
    in_cell = slot >= 0 and head.cell_terms != 0 and not calm
    cell = cell_of(I, M, max(0, slot))
    if in_cell:
        if is_kept(I, M, cell, way, level, near):
            for i in range(3):
                velocity[i] = cell.velocity[i]
                acceleration[i] = cell.acceleration[i]
            return cell.elevation - height if near else -height
        surface, u, uz, du, az = sum_in_cell(I, M, slot, way, level, near)
    else:
        count = head.wave_count if near else living(I, M, level)
        surface, u, uz, du, az = sum_components(I, M, 0 if calm else count, way, level)
    a = share * du + rise * u
    az = share * az + rise * uz
    u *= share
    uz *= share
    ahead = state.wave_x
    if planar:
        ahead = ahead * state.plane[0] + state.wave_y * state.plane[1]
    else:
        velocity[1] = u * state.wave_y
        acceleration[1] = a * state.wave_y
    up = head.dimension - 1
    velocity[0] = u * ahead
    velocity[up] = uz
    acceleration[0] = a * ahead
    acceleration[up] = az
    if in_cell:
        keep(I, M, cell, way, level, near)
        cell.elevation = share * surface
        for i in range(3):
            cell.velocity[i] = velocity[i]
            cell.acceleration[i] = acceleration[i]
    return share * surface - height if near else -height


@kernel
def wet_at(depth, half, water):
    """Write the share that is wet at a depth with a band of +- half [m], and its slope upwards."""
    share, rate = share_at(depth, half)
    water.wet = share
    water.slope = -rate


@kernel
def displaced(I, M, edge):
    """Mass of the water that a cable displaces, of the edge's cable [kg/m]."""
    return cable_of(I, M, int(edge.segment)).displaced


@kernel
def band(I, M, edge):
    """Half of the band around the surface [m]: of the cable's diameter."""
    state = scalars(M)
    square = displaced(I, M, edge) / (math.pi * state.water_density)
    return max(SMALLEST, math.sqrt(square))


@kernel
def buoyancy(M, edge):
    """Of a wet cable [N/m]: weight in air less the submerged one."""
    state = scalars(M)
    return (edge.mass - edge.added_mass) * state.gravity - edge.weight


@outlined
def element_water(I, M, points, edge, x0, x1):
    """Motion of the water, waves and current, and wet shares at an element's Gauss points
    (ElementPoints)."""
    head = header(I)
    dimension = head.dimension
    up = dimension - 1
    h = edge.length
    water = water_at()
    flow = vector()
    place = vector()
    first = (word_of(M, edge) - head.edges) // EDGE_WORDS * 3
    for g in range(3):
        for i in range(dimension):
            place[i] = x0[i] * H0[g] + h * x0[dimension + i] * H1[g]
            place[i] += x1[i] * H2[g] + h * x1[dimension + i] * H3[g]
        # No point is further than h from the rest of its element.
        points.wet[g] = wave_at(I, M, place[0], place[1], place[up], h, first + g, water)
        for i in range(dimension):
            points.water[POINT_WORDS * i + g] = water.velocity[i]
            points.water_acceleration[POINT_WORDS * i + g] = water.acceleration[i]
        if head.current_kind != 0:
            current_at(I, M, place[up], flow)
            for i in range(dimension):
                points.water[POINT_WORDS * i + g] += flow[i]
        if head.surge != 0:
            surge_at(I, M, place[up], flow)
            for i in range(dimension):
                points.water_acceleration[POINT_WORDS * i + g] += flow[i]
    wet_shares(points, band(I, M, edge))
    drag_shares(points)


@outlined
def wave_loads(I, M, points, edge, x0, x1, v0, v1, a0, a1):
    """Minus the loads of the water per unit length, beside m + ma times a and the weight in water.

    In place of the elements' load_forces; geometry(...) has been called.
    """
    head = header(I)
    dimension = head.dimension
    h = edge.length
    added = edge.added_mass
    mass = displaced(I, M, edge)
    lift = buoyancy(M, edge)
    element_water(I, M, points, edge, x0, x1)
    for g in range(3):
        ut = 0.0
        u2 = 0.0
        at = 0.0
        wt = 0.0
        for i in range(dimension):
            d = dimension + i
            t = points.tangent[POINT_WORDS * i + g]
            u = points.water[POINT_WORDS * i + g]
            u -= v0[i] * H0[g] + v1[i] * H2[g] + h * (v0[d] * H1[g] + v1[d] * H3[g])
            a = a0[i] * H0[g] + a1[i] * H2[g] + h * (a0[d] * H1[g] + a1[d] * H3[g])
            points.force[POINT_WORDS * i + g] = u
            ut += u * t
            u2 += u * u
            at += a * t
            wt += points.water_acceleration[POINT_WORDS * i + g] * t
        un = math.sqrt(max(0.0, u2 - ut * ut))
        root = math.sqrt(points.stretch[g])
        fn = root * edge.drag_normal * un
        ft = root * edge.drag_tangential * abs(ut) * ut
        s = points.wet[g]
        fn *= points.drag[g]
        ft *= points.drag[g]
        for i in range(dimension):
            d = dimension + i
            t = points.tangent[POINT_WORDS * i + g]
            u = points.force[POINT_WORDS * i + g]
            a = a0[i] * H0[g] + a1[i] * H2[g] + h * (a0[d] * H1[g] + a1[d] * H3[g])
            push = added * (a - at * t - points.water_acceleration[POINT_WORDS * i + g] + wt * t)
            push -= mass * points.water_acceleration[POINT_WORDS * i + g]
            # The elements' mass holds all of ma a.
            points.force[POINT_WORDS * i + g] = s * push - fn * (u - ut * t) - ft * t - added * a
        points.force[POINT_WORDS * (dimension - 1) + g] += (1.0 - s) * lift
    for n in range(POINT_WORDS * dimension):
        points.force[n] *= h


@kernel
def wet_rows(I, M, points, edge, motion, slope, width, ca):
    """Derivatives of wave_loads from those of a wet element in calm water.

    motion, slope: its rows for the motion and for r', `width` words each, one for each Gauss
    point: see the elements' tangent_matrices. The water's own gradients are left out, and all
    loads count by the shares of drag: it grows with the speed, and added mass is little beside all.
    """
    head = header(I)
    dimension = head.dimension
    h = edge.length
    added = ca * edge.added_mass
    lift = buoyancy(M, edge)
    for g in range(3):
        s = points.drag[g]
        row = view(motion, width * g, width)
        for n in range(dimension * dimension):
            row[n] *= s
            slope[width * g + n] *= s
        for i in range(dimension):
            row[dimension * i + i] -= (1.0 - s) * h * added
        row[dimension * dimension - 1] -= h * lift * points.wet_slope[g]
