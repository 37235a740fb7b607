"""Where the nodes are, what water they meet, and how the mesh moves along the cable."""

import math

from cablemodel.kernels.access import header
from cablemodel.kernels.environment import current_at, surge_at

from .compile import kernel
from .frame import from_earth, to_earth, to_fixed
from .layout import (
    B_HALF,
    BODY_WORDS,
    D_SECTIONS,
    F3,
    N_BODY,
    N_COUNT,
    N_FIRST,
    N_KIND,
    O_BODY,
    O_CURRENTS,
    O_DELTA,
    O_FLOW,
    O_LENGTH,
    O_OLD_LENGTH,
    O_PLACE,
    O_SECTION,
    O_SHARE,
    O_STRAINS,
    O_WORK,
    O_Y,
    PHI,
    RIGID,
    SECTION_WORDS,
    THETA,
    WIDTH,
    X_DT,
    X_FLOOR,
    X_FLOW_END,
    X_PAID_IN_STEP,
    X_RATE,
    X_SHARE,
    X_VESSEL,
)


@kernel
def last_node(I):
    """Index of the far end's node."""
    section = I[O_SECTION] + SECTION_WORDS * (I[D_SECTIONS] - 1)
    return I[section + N_FIRST] + I[section + N_COUNT] - 1


@kernel
def set_flow(I, M):
    """Cable that flows past each node, and the lengths of the intervals at the end of the step.

    The vessel's node sees the pay-out rate; near the touchdown point the mesh goes along with it,
    by each node's share. Everywhere else nodes are points of the cable.
    """
    count = last_node(I) + 1
    flow = I[O_FLOW]
    share = I[O_SHARE]
    length = I[O_LENGTH]
    old = I[O_OLD_LENGTH]
    end = M[X_FLOW_END]
    for node in range(count):
        M[flow + node] = end * M[share + node]
        if node > 0 and M[old + node] > 0.0:
            moved = M[share + node] - M[share + node - 1]
            M[length + node] = M[old + node] - M[X_DT] * end * moved
    M[flow] += M[X_RATE]
    M[length + 1] += M[X_PAID_IN_STEP]


@kernel
def surge_word(I, node):
    """First of three words with the water's acceleration at a node (paper's axes), while `surge`
    is not 0."""
    head = header(I)
    return I[O_CURRENTS] + 3 * (head.capacity + node)


@kernel
def set_places(I, M):
    """Places of all nodes (earth frame) by integrating the tangent from the vessel, and velocity
    and acceleration of the water there (paper's axes)."""
    head = header(I)
    x, y, z = to_earth(M, M[X_VESSEL], M[X_VESSEL + 1], M[X_VESSEL + 2])
    water = M[I[O_WORK] : I[O_WORK] + 3]
    place = I[O_PLACE]
    for index in range(I[D_SECTIONS]):
        section = I[O_SECTION] + SECTION_WORDS * index
        first = I[section + N_FIRST]
        for node in range(first, first + I[section + N_COUNT]):
            if node > first:
                a = I[O_Y] + WIDTH * (node - 1)
                b = a + WIDTH
                if I[section + N_KIND] == RIGID:
                    h = 2.0 * M[I[O_BODY] + BODY_WORDS * I[section + N_BODY] + B_HALF]
                else:
                    s = I[O_STRAINS] + 2 * node
                    h = M[I[O_LENGTH] + node] * (1.0 + 0.5 * (M[s - 2] + M[s]))
                phi = 0.5 * (M[a + PHI] + M[b + PHI])
                theta = 0.5 * (M[a + THETA] + M[b + THETA])
                g1, g2, g3 = to_fixed(phi, theta, 0.0, 0.0, h)
                dx, dy, dz = to_earth(M, g1, g2, g3)
                x += dx
                y += dy
                z += dz
            M[place + 3 * node] = x
            M[place + 3 * node + 1] = y
            M[place + 3 * node + 2] = z
            at = I[O_CURRENTS] + 3 * node
            if head.current_kind == 0:
                M[at] = 0.0
                M[at + 1] = 0.0
                M[at + 2] = 0.0
            else:
                current_at(I, M, z, water)
                c1, c2, c3 = from_earth(M, water[0], water[1], water[2])
                M[at] = M[X_SHARE] * c1
                M[at + 1] = M[X_SHARE] * c2
                M[at + 2] = M[X_SHARE] * c3
            if head.surge != 0:
                surge_at(I, M, z, water)
                at = surge_word(I, node)
                M[at], M[at + 1], M[at + 2] = from_earth(M, water[0], water[1], water[2])


@kernel
def gap(I, M):
    """Height of the far end above the plane of the floor, along its normal [m]."""
    at = I[O_PLACE] + 3 * last_node(I)
    g1, g2, g3 = from_earth(M, M[at], M[at + 1], M[at + 2])
    return g1 * M[X_FLOOR] + g2 * M[X_FLOOR + 1] + g3 * M[X_FLOOR + 2] - M[X_FLOOR + 3]


@kernel
def gap_change(I, M, side, by_flow):
    """Change of the gap for the changes of the unknowns in O_DELTA (scaled back already), and, for
    by_flow = 1, for a unit change of the flow past the touchdown point."""
    total = 0.0
    for index in range(I[D_SECTIONS]):
        section = I[O_SECTION] + SECTION_WORDS * index
        first = I[section + N_FIRST]
        rigid = I[section + N_KIND] == RIGID
        for node in range(first + 1, first + I[section + N_COUNT]):
            a = I[O_Y] + WIDTH * (node - 1)
            b = a + WIDTH
            da = I[O_DELTA] + 2 * WIDTH * (node - 1) + WIDTH * side
            db = da + 2 * WIDTH
            phi = 0.5 * (M[a + PHI] + M[b + PHI])
            theta = 0.5 * (M[a + THETA] + M[b + THETA])
            d_phi = 0.5 * (M[da + PHI] + M[db + PHI])
            d_theta = 0.5 * (M[da + THETA] + M[db + THETA])
            s = I[O_STRAINS] + 2 * node
            e = 1.0 + 0.5 * (M[s - 2] + M[s])
            d_e = 0.5 * (M[s - 1] * M[da + F3] + M[s + 1] * M[db + F3])
            h = M[I[O_LENGTH] + node]
            d_h = 0.0
            if rigid:
                h = 2.0 * M[I[O_BODY] + BODY_WORDS * I[section + N_BODY] + B_HALF]
                e = 1.0
                d_e = 0.0
            elif by_flow != 0:
                d_h = -M[X_DT] * (M[I[O_SHARE] + node] - M[I[O_SHARE] + node - 1])
            # a3 turns by d_theta towards -a2 and by d_phi sin(theta) towards a1.
            g1, g2, g3 = to_fixed(
                phi,
                theta,
                h * e * math.sin(theta) * d_phi,
                -h * e * d_theta,
                h * d_e + d_h * e,
            )
            total += g1 * M[X_FLOOR] + g2 * M[X_FLOOR + 1] + g3 * M[X_FLOOR + 2]
    return total


@kernel
def line_out(I, M):
    """Unstretched length of cable from the vessel to the far end of the mesh [m]."""
    total = 0.0
    for index in range(I[D_SECTIONS]):
        section = I[O_SECTION] + SECTION_WORDS * index
        if I[section + N_KIND] != RIGID:
            first = I[section + N_FIRST]
            for node in range(first + 1, first + I[section + N_COUNT]):
                total += M[I[O_LENGTH] + node]
    return total
