"""What the sea floor remembers from step to step: places of rest, and what it bears for long."""

import math

from cablemodel.solvers.finite_element.kernels.floor.contact import (
    along_floor,
    contact_law,
    contact_of,
    contact_place,
    contact_places,
    interpolate,
    place_force,
    place_law,
)
from cablemodel.solvers.finite_element.kernels.floor.feet import settle_feet
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import gap_at, lowest_gap
from cablemodel.solvers.shared.access import body_of, edge_of, header, scalars, vector
from cablemodel.solvers.shared.compile import inlined, kernel

SUPPORT_FASTEST = 3.0  # growth of what is borne for long, at most, in one change of it


LANDED = 0.05  # of the contact layer: cable that moves below this has landed
SLOPE_SHIFTS = 4.0 / 27.0  # of its length: what a slope of 1 at one end moves a cubic by, at most
FORGETS = 10.0  # times e, in what sinks by the contact layer's depth while it lands


@kernel
def longest_beside(I, M, node):
    """The longer of a line's elements at a node [m]."""
    head = header(I)
    longest = 0.0
    if node > 0 and I[head.joint + node] == 0:
        longest = edge_of(I, M, node).length
    child = node + 1
    if child < head.nodes and I[head.parent + child] == node and I[head.joint + child] == 0:
        longest = max(longest, edge_of(I, M, child).length)
    return longest


@inlined
def kept_of(way, normal, limit, dimension):
    """Share of a vector that is left of it, along the floor, where it is longer than a limit; its
    part along the normal is removed."""
    length = along_floor(way, normal, dimension)
    return 1.0 if length <= limit else limit / length


@kernel
def settle(I, M):
    """Draw what is at rest after nodes that have slipped or left the floor (return mapping), and
    after what lands: places, and slopes, which alone move the cable between nodes by 4/27 of an
    element's length.

    Cable that lies down on a rigid floor touches it flat and does not slide. Through a soft floor
    it comes at an angle a, and slides by what the cosine lacks on the way: with the friction of
    that in its bristles it was laid pressed, by 3 N/m in 3,000 m of water. A place of rest lies as
    high as the node did when it was drawn there.
    """
    head = header(I)
    state = scalars(M)
    if head.foot_count != 0:
        settle_feet(I, M)
    dimension = head.dimension
    size = 2 * dimension
    place = vector()
    normal = vector()
    was = vector()  # a place of rest
    way = vector()
    depth = state.floor_depth
    q = M[head.position : head.position + size * head.nodes]
    for node in range(head.nodes):
        rest = head.rest + size * node
        for i in range(dimension):
            place[i] = q[size * node + i]
        gap = gap_at(I, M, place, normal)
        share, _stiffness, _energy = contact_law(gap, depth)
        limit = state.bristle * share
        held = 1.0
        if gap < depth:
            for i in range(dimension):
                was[i] = M[rest + i]
            above = min(gap_at(I, M, was, vector()), depth)
            sunk = above - max(gap, LANDED * depth)
            if sunk > 0.0:
                held = math.exp(-FORGETS * sunk / depth)
        for part in range(2):
            at = part * dimension
            for i in range(dimension):
                way[i] = q[size * node + at + i] - M[rest + at + i]
            most = limit
            if part == 1:
                # What slips has its slope's bristle drawn, too.
                most = limit / max(1e-300, SLOPE_SHIFTS * longest_beside(I, M, node))
            held *= kept_of(way, normal, most, dimension)
            if held < 1.0:
                for i in range(dimension):
                    M[rest + at + i] = q[size * node + at + i] - way[i] * held


@inlined
def load_aimed_at(support_load, law):
    """What is to be borne for long, where the law of contact gives `law` times that now."""
    return max(1.0, support_load * min(law, SUPPORT_FASTEST))


@kernel
def bear(I, M, share):
    """Let what the floor's springs bear at rest follow the load, by a share of the difference.

    Cable and bodies that press harder than by their weight for long, on the top of a hump, lie on
    the floor as others do; what strikes it finds it as soft as it is. Returns the largest
    difference, relative to what was borne, with its sign.
    """
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    size = 2 * dimension
    contact = contact_of()
    q = M[head.position : head.position + size * head.nodes]
    v = M[head.velocity : head.velocity + size * head.nodes]
    depth = state.floor_depth
    largest = 0.0
    for node in range(1, head.nodes):
        if I[head.joint + node] != 0:
            continue
        edge = edge_of(I, M, node)
        support_load = edge.support
        pressed = 0.0
        if lowest_gap(I, M, q, node) < depth:
            parent = I[head.parent + node]
            for p in range(4):
                interpolate(q, parent, node, edge.length, p, contact.place, dimension)
                gap = gap_at(I, M, contact.place, contact.normal)
                law, _stiffness, _energy = contact_law(gap, depth)
                pressed = max(pressed, law)
        difference = load_aimed_at(support_load, pressed) - support_load
        edge.support = support_load + share * difference
        if abs(difference) > abs(largest) * support_load:
            largest = difference / support_load
    for place in range(contact_places(I)):
        node, load, preload = contact_place(I, M, place)
        if load <= 0.0:
            continue
        _press, gap, _speed = place_force(I, M, load, preload, node, q, v, contact)
        law, _stiffness, _energy = place_law(preload, gap, depth)
        row = body_of(I, M, place // 2)
        at_end = place == 2 * head.body_count
        support_load = state.end_support if at_end else row.support[place % 2]
        difference = load_aimed_at(support_load, law) - support_load
        if abs(difference) > abs(largest) * support_load:
            largest = difference / support_load
        if at_end:
            state.end_support += share * difference
        else:
            row.support[place % 2] += share * difference
    return largest
