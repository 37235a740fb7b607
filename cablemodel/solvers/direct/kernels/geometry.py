"""Where the nodes are, what water they meet, and how the mesh moves along the cable."""

import math

from cablemodel.solvers.shared.access import header, vector
from cablemodel.solvers.shared.environment import current_at, surge_at

from .access import (
    change_of,
    own_header,
    own_scalars,
    place_of,
    rigid_body_of,
    section_of,
    strain_of,
    unknowns_of,
    water_of,
)
from .compile import kernel
from .frame import from_earth, to_earth, to_fixed
from .layout import RIGID


@kernel
def last_node(I):
    """Index of the far end's node."""
    own = own_header(I)
    section = section_of(I, I, own.section_count - 1)
    return section.first + section.count - 1


@kernel
def set_flow(I, M):
    """Cable that flows past each node, and the lengths of the intervals at the end of the step.

    The vessel's node sees the pay-out rate; near the touchdown point the mesh goes along with it,
    by each node's share. Everywhere else nodes are points of the cable.
    """
    own = own_header(I)
    run = own_scalars(M)
    count = last_node(I) + 1
    flow = own.flow
    share = own.share
    length = own.length
    old = own.old_length
    end = run.flow_end
    for node in range(count):
        M[flow + node] = end * M[share + node]
        if node > 0 and M[old + node] > 0.0:
            moved = M[share + node] - M[share + node - 1]
            M[length + node] = M[old + node] - run.dt * end * moved
    M[flow] += run.rate
    M[length + 1] += run.paid_in_step


@kernel
def set_places(I, M):
    """Places of all nodes (earth frame) by integrating the tangent from the vessel, and velocity
    and acceleration of the water there (paper's axes)."""
    own = own_header(I)
    run = own_scalars(M)
    head = header(I)
    x, y, z = to_earth(M, run.vessel[0], run.vessel[1], run.vessel[2])
    flow = vector()
    for index in range(own.section_count):
        section = section_of(I, M, index)
        first = section.first
        for node in range(first, first + section.count):
            if node > first:
                a = unknowns_of(I, M, node - 1)
                b = unknowns_of(I, M, node)
                if section.kind == RIGID:
                    h = 2.0 * rigid_body_of(I, M, section.body).half
                else:
                    before = strain_of(I, M, node - 1).strain
                    after = strain_of(I, M, node).strain
                    h = M[own.length + node] * (1.0 + 0.5 * (before + after))
                phi = 0.5 * (a.phi + b.phi)
                theta = 0.5 * (a.theta + b.theta)
                g1, g2, g3 = to_fixed(phi, theta, 0.0, 0.0, h)
                dx, dy, dz = to_earth(M, g1, g2, g3)
                x += dx
                y += dy
                z += dz
            place = place_of(I, M, node)
            place.x = x
            place.y = y
            place.z = z
            water = water_of(I, M, node)
            if head.current_kind == 0:
                water.e1 = 0.0
                water.e2 = 0.0
                water.e3 = 0.0
            else:
                current_at(I, M, z, flow)
                c1, c2, c3 = from_earth(M, flow[0], flow[1], flow[2])
                water.e1 = run.share * c1
                water.e2 = run.share * c2
                water.e3 = run.share * c3
            if head.surge != 0:
                surge_at(I, M, z, flow)
                surge = water_of(I, M, head.capacity + node)
                surge.e1, surge.e2, surge.e3 = from_earth(M, flow[0], flow[1], flow[2])


@kernel
def gap(I, M):
    """Height of the far end above the plane of the floor, along its normal [m]."""
    run = own_scalars(M)
    place = place_of(I, M, last_node(I))
    g1, g2, g3 = from_earth(M, place.x, place.y, place.z)
    return g1 * run.floor[0] + g2 * run.floor[1] + g3 * run.floor[2] - run.floor[3]


@kernel
def gap_change(I, M, side, by_flow):
    """Change of the gap for the changes of the unknowns in `delta` (scaled back already), and, for
    by_flow = 1, for a unit change of the flow past the touchdown point."""
    own = own_header(I)
    run = own_scalars(M)
    total = 0.0
    for index in range(own.section_count):
        section = section_of(I, M, index)
        first = section.first
        rigid = section.kind == RIGID
        for node in range(first + 1, first + section.count):
            a = unknowns_of(I, M, node - 1)
            b = unknowns_of(I, M, node)
            da = change_of(I, M, 2 * (node - 1) + side)
            db = change_of(I, M, 2 * node + side)
            phi = 0.5 * (a.phi + b.phi)
            theta = 0.5 * (a.theta + b.theta)
            d_phi = 0.5 * (da.phi + db.phi)
            d_theta = 0.5 * (da.theta + db.theta)
            before = strain_of(I, M, node - 1)
            after = strain_of(I, M, node)
            e = 1.0 + 0.5 * (before.strain + after.strain)
            d_e = 0.5 * (before.slope * da.f3 + after.slope * db.f3)
            h = M[own.length + node]
            d_h = 0.0
            if rigid:
                h = 2.0 * rigid_body_of(I, M, section.body).half
                e = 1.0
                d_e = 0.0
            elif by_flow != 0:
                d_h = -run.dt * (M[own.share + node] - M[own.share + node - 1])
            # a3 turns by d_theta towards -a2 and by d_phi sin(theta) towards a1.
            g1, g2, g3 = to_fixed(
                phi,
                theta,
                h * e * math.sin(theta) * d_phi,
                -h * e * d_theta,
                h * d_e + d_h * e,
            )
            total += g1 * run.floor[0] + g2 * run.floor[1] + g3 * run.floor[2]
    return total


@kernel
def line_out(I, M):
    """Unstretched length of cable from the vessel to the far end of the mesh [m]."""
    own = own_header(I)
    total = 0.0
    for index in range(own.section_count):
        section = section_of(I, M, index)
        if section.kind != RIGID:
            first = section.first
            for node in range(first + 1, first + section.count):
                total += M[own.length + node]
    return total
