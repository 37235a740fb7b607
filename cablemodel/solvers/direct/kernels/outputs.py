"""What is read off a state: stations along the cable, the numbers of every step, the floor."""

import math

from cablemodel.solvers.shared.access import station_at, summary_at, winch_of
from cablemodel.solvers.shared.layout import STATION_WORDS
from cablemodel.solvers.shared.slack import read_slack
from cablemodel.solvers.shared.summary import clear_floor

from .access import (
    material_row,
    own_header,
    own_scalars,
    place_of,
    rigid_body_of,
    section_of,
    strain_of,
    unknowns_of,
)
from .compile import kernel
from .frame import to_earth, to_fixed
from .geometry import last_node, line_out
from .joints import bending_of
from .layout import (
    CABLE,
    END_CONTACT,
    END_TOUCHDOWN,
    RIGID,
)


@kernel
def node_vector(I, M, node, which):
    """Earth-frame vector of a node: 0 velocity, 1 force, 2 moment over EI, 3 tangent."""
    y = unknowns_of(I, M, node)
    x1 = 0.0
    x2 = 0.0
    x3 = 1.0
    if which == 0:
        x1 = y.v1
        x2 = y.v2
        x3 = y.v3
    elif which == 1:
        x1 = y.f1
        x2 = y.f2
        x3 = y.f3
    elif which == 2:
        x1 = y.k1
        x2 = y.k2
        x3 = 0.0
    g1, g2, g3 = to_fixed(y.phi, y.theta, x1, x2, x3)
    return to_earth(M, g1, g2, g3)


@kernel
def laid_direction(I, M):
    """Horizontal direction in which laid cable lies behind the end of the mesh, with the floor's
    slope: the tangent there."""
    return node_vector(I, M, last_node(I), 3)


@kernel
def station(I, M, section, left, x, found):
    """The state at a fraction x of the interval after node `left` into a Station."""
    own = own_header(I)
    right = left + 1
    h = M[own.length + right]
    tx0, ty0, tz0 = node_vector(I, M, left, 3)
    tx1, ty1, tz1 = node_vector(I, M, right, 3)
    e0 = h * (1.0 + strain_of(I, M, left).strain)
    e1 = h * (1.0 + strain_of(I, M, right).strain)
    y = 1.0 - x
    n0 = y * y * (1.0 + 2.0 * x)
    n1 = x * y * y * e0
    n2 = x * x * (3.0 - 2.0 * x)
    n3 = -x * x * y * e1
    p = place_of(I, M, left)
    q = place_of(I, M, right)
    place = found.position
    place[0] = n0 * p.x + n1 * tx0 + n2 * q.x + n3 * tx1
    place[1] = n0 * p.y + n1 * ty0 + n2 * q.y + n3 * ty1
    place[2] = n0 * p.z + n1 * tz0 + n2 * q.z + n3 * tz1
    a = unknowns_of(I, M, left)
    b = unknowns_of(I, M, right)
    phi = y * a.phi + x * b.phi
    theta = y * a.theta + x * b.theta
    g1, g2, g3 = to_fixed(phi, theta, 0.0, 0.0, 1.0)
    tx, ty, tz = to_earth(M, g1, g2, g3)
    put(found.tangent, tx, ty, tz)
    g1, g2, g3 = to_fixed(
        phi,
        theta,
        y * a.v1 + x * b.v1,
        y * a.v2 + x * b.v2,
        y * a.v3 + x * b.v3,
    )
    vx, vy, vz = to_earth(M, g1, g2, g3)
    put(found.velocity, vx, vy, vz)
    found.tension = y * a.f3 + x * b.f3
    if section.kind == CABLE:
        k1 = (b.theta - a.theta) / h
        k2 = (b.phi - a.phi) / h * math.sin(theta)
        found.curvature = math.sqrt(k1 * k1 + k2 * k2)
        found.bending_moment = 0.0
    else:
        k1 = y * a.k1 + x * b.k1
        k2 = y * a.k2 + x * b.k2
        found.curvature = math.sqrt(k1 * k1 + k2 * k2)
        found.bending_moment = bending_of(I, M, section) * found.curvature


@kernel
def sample_stations(I, M, stations, out):
    """State at arc lengths `stations` [m]: rows of a Station into out, as for the finite elements.
    Returns the index of the first station that is not on the line, or their number."""
    own = own_header(I)
    run = own_scalars(M)
    mesh = line_out(I, M)
    total = mesh + run.laid
    # A body may be last: what rounding puts behind the cable's end belongs to the cable's end.
    outermost = own.section_count - 1
    while section_of(I, M, outermost).kind == RIGID:
        outermost -= 1
    for n in range(len(stations)):
        s = stations[n]
        if not (s >= -1e-9 * total and s <= total * (1.0 + 1e-9)):
            return n
        found = station_at(out, STATION_WORDS * n)
        arc = 0.0
        done = False
        for index in range(own.section_count):
            section = section_of(I, M, index)
            if done or section.kind == RIGID:
                continue
            first = section.first
            last = first + section.count - 1
            for node in range(first + 1, last + 1):
                h = M[own.length + node]
                if s <= arc + h or (index == outermost and node == last):
                    x = min(1.0, max(0.0, (s - arc) / h))
                    station(I, M, section, node - 1, x, found)
                    done = True
                    break
                arc += h
        beyond = s - mesh
        if run.laid > 0.0 and beyond > 0.0:
            tx, ty, tz = laid_direction(I, M)
            found.position[0] += beyond * tx
            found.position[1] += beyond * ty
            found.position[2] += beyond * tz
            put(found.velocity, 0.0, 0.0, 0.0)
            found.tension = 0.0
            found.curvature = 0.0
            found.bending_moment = 0.0
        found.on_floor = 1.0 if run.laid > 0.0 and beyond >= 0.0 else 0.0
    return len(stations)


@kernel
def body_stations(I, M, out):
    """Motion of every body of line and drum in rows of a Station: place of the centre of gravity,
    axis, velocity; the rest is not touched. What is on the drum is at the tow
    point."""
    own = own_header(I)
    for body in range(own.body_count):
        body_station(I, M, body, 0, out)
    for index in range(own.section_count + 1):
        section = section_of(I, M, index)
        if section.point >= 0:
            node = section.first - 1 if index < own.section_count else last_node(I)
            body_station(I, M, section.point, node, out)
        if index < own.section_count and section.kind == RIGID:
            body = section.body
            node = section.first
            row = rigid_body_of(I, M, body)
            body_station(I, M, body, node, out)
            found = station_at(out, STATION_WORDS * body)
            arm = (1.0 + row.offset) * row.half
            for k in range(3):
                found.position[k] += arm * found.tangent[k]
            y = unknowns_of(I, M, node)
            g1, g2, g3 = to_fixed(y.phi, y.theta, row.state[0], row.state[1], row.state[2])
            vx, vy, vz = to_earth(M, g1, g2, g3)
            put(found.velocity, vx, vy, vz)


@kernel
def body_station(I, M, body, node, out):
    """A body's row from the place, tangent and velocity of a node."""
    found = station_at(out, STATION_WORDS * body)
    place = place_of(I, M, node)
    put(found.position, place.x, place.y, place.z)
    tx, ty, tz = node_vector(I, M, node, 3)
    put(found.tangent, tx, ty, tz)
    vx, vy, vz = node_vector(I, M, node, 0)
    put(found.velocity, vx, vy, vz)


@kernel
def summarise(I, M, out):
    """The Summary of cablemodel/solvers/shared/layout.py."""
    own = own_header(I)
    run = own_scalars(M)
    found = summary_at(out, 0)
    wrench = found.wrench
    fx, fy, fz = node_vector(I, M, 0, 1)
    wrench[0] = fx
    wrench[1] = fy
    wrench[2] = fz
    mx, my, mz = node_vector(I, M, 0, 2)
    bending = bending_of(I, M, section_of(I, M, 0))
    wrench[3] = bending * mx
    wrench[4] = bending * my
    wrench[5] = bending * mz
    size = math.sqrt(fx * fx + fy * fy + fz * fz)
    found.top_tension = math.copysign(size, unknowns_of(I, M, 0).f3)
    lowest = unknowns_of(I, M, 0).f3
    highest = found.top_tension  # with the shear
    last = last_node(I)
    for node in range(last + 1):
        tension = unknowns_of(I, M, node).f3
        lowest = min(lowest, tension)
        highest = max(highest, tension)
    if run.laid > 0.0:  # cable that has been laid bears none
        lowest = min(lowest, 0.0)
        highest = max(highest, 0.0)
    found.tension_min = lowest
    found.tension_max = highest
    laid = run.laid
    tx, ty, tz = laid_direction(I, M)
    tip = place_of(I, M, last)
    put(found.tip_position, tip.x + laid * tx, tip.y + laid * ty, tip.z + laid * tz)
    vx, vy, vz = node_vector(I, M, last, 0)
    if laid > 0.0:
        vx = 0.0
        vy = 0.0
        vz = 0.0
    put(found.tip_velocity, vx, vy, vz)
    x, y, z = to_earth(M, run.vessel[0], run.vessel[1], run.vessel[2])
    put(found.vessel_position, x, y, z)
    x, y, z = to_earth(M, run.vessel[3], run.vessel[4], run.vessel[5])
    put(found.vessel_velocity, x, y, z)
    found.line_length = line_out(I, M) + laid
    found.payout_rate = run.rate
    winch = winch_of(I, M, 0)
    found.drum_length = winch.paid_most - winch.paid
    clear_floor(found, math.nan)
    read_slack(I, M, found)
    if own.end != END_CONTACT and own.end != END_TOUCHDOWN:
        return
    # The force at the end is the floor's; what lies beyond rests there with its weight.
    fx, fy, fz = node_vector(I, M, last, 1)
    section = section_of(I, M, own.section_count - 1)
    put(found.floor_force, fx, fy, fz + material_row(I, M, section.material).weight * laid)
    found.floor_length = laid
    put(found.touchdown_position, tip.x, tip.y, tip.z)
    nx, ny, nz = to_earth(M, run.floor[0], run.floor[1], run.floor[2])
    found.touchdown_reaction = fx * nx + fy * ny + fz * nz


@kernel
def put(vector, x, y, z):
    """Three numbers into a vector."""
    vector[0] = x
    vector[1] = y
    vector[2] = z
