"""What the sea floor remembers from step to step: places of rest, and what it bears for long."""

import math

from cablemodel.solvers.finite_element.kernels.element.tables import BRISTLE, DEPTH
from cablemodel.solvers.finite_element.kernels.floor.contact import (
    along_floor,
    bristle,
    bristle_at,
    contact_law,
    contact_of,
    contact_place,
    contact_places,
    interpolate,
    place_force,
    place_law,
)
from cablemodel.solvers.finite_element.kernels.floor.feet import settle_feet
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import (
    gap_at,
    gap_below,
    lowest_gap,
)
from cablemodel.solvers.shared.access import body_of, edge_of, header, scalars, vector
from cablemodel.solvers.shared.compile import inlined, kernel

LEFT_PRESSED = 3.0  # times what is borne at rest that a run leaves pressed, or folds wander
SUPPORT_FASTEST = 3.0  # growth of what is borne for long, at most, in one change of it


LANDED = 0.05  # of the contact layer: cable that moves below this has landed
SLIPPED = 2.0  # bristles, up to the longest: as long is what has slipped; noise loosens nothing
FORGETS = 10.0  # times e, in what sinks by the contact layer's depth while it lands


@inlined
def share_within(way, normal, limit, dimension):
    """Share of a bristle that is within a limit; its part along the normal is removed."""
    length = along_floor(way, normal, dimension)
    return 1.0 if length <= limit else limit / length


@inlined
def longest_bristle(M):
    """That of lines that lie to no anchor [m]."""
    return BRISTLE / DEPTH * scalars(M).floor_depth


@inlined
def longest_kept(M):
    """Bristle to which what has slipped is drawn, at rest [m]."""
    bristle = scalars(M).bristle
    return max(bristle, min(SLIPPED * bristle, longest_bristle(M)))


@kernel
def share_of_element(I, M, node):
    """Share of an element's bristles with which its friction is still whole, the largest of its
    points'; 0 where it does not touch."""
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    q = M[head.position : head.position + 2 * dimension * head.nodes]
    if I[head.joint + node] != 0 or lowest_gap(I, M, q, node) >= state.floor_depth:
        return 0.0
    contact = contact_of()
    depth = state.floor_depth
    parent = I[head.parent + node]
    h = edge_of(I, M, node).length
    share = 0.0
    for p in range(4):
        interpolate(q, parent, node, h, p, contact.place, dimension)
        gap = gap_below(I, M, contact.place, contact.normal, dimension)
        if gap >= depth:
            continue
        bristle(I, M, q, parent, node, h, p, contact, dimension)
        law, _stiffness, _energy = contact_law(gap, depth)
        limit = longest_kept(M) * law
        share = max(share, share_within(contact.bristle, contact.normal, limit, dimension))
    return share


@kernel
def settle(I, M):
    """Draw what is at rest after nodes that have slipped or left the floor (return mapping), and
    after what lands.

    Elements bear friction at points within, by the bristles of their nodes. A node's is
    shortened no more than leaves that friction as it is: where a point beside it sticks, not at
    all. Otherwise cable that hangs by its friction would sink by a bit in each step.

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
    contact = contact_of()
    place = contact.place
    was = vector()  # a place of rest
    depth = state.floor_depth
    q = M[head.position : head.position + size * head.nodes]
    beside = 0.0
    for node in range(head.nodes):
        child = node + 1
        above = beside
        beside = 0.0
        if child < head.nodes and I[head.parent + child] == node:
            beside = share_of_element(I, M, child)
        rest = head.rest + size * node
        for i in range(dimension):
            place[i] = q[size * node + i]
        gap = gap_at(I, M, place, contact.normal)
        bristle_at(I, M, node, contact, dimension)
        held = 0.0
        if gap < depth:
            law, _stiffness, _energy = contact_law(gap, depth)
            limit = longest_kept(M) * law
            own = share_within(contact.bristle, contact.normal, limit, dimension)
            held = max(own, above, beside)
            for i in range(dimension):
                was[i] = M[rest + i]
            fell = min(gap_at(I, M, was, vector()), depth)
            sunk = fell - max(gap, LANDED * depth)
            if sunk > 0.0:
                held *= math.exp(-FORGETS * sunk / depth)
        if held < 1.0:
            for i in range(dimension):
                M[rest + i] = place[i] - held * contact.bristle[i]
            for i in range(dimension):
                contact.bristle[i] = q[size * node + dimension + i] - M[rest + dimension + i]
            along_floor(contact.bristle, contact.normal, dimension)
            for i in range(dimension):
                at = dimension + i
                M[rest + at] = q[size * node + at] - held * contact.bristle[i]


@inlined
def load_aimed_at(support_load, law, harder):
    """What is to be borne for long, where the law of contact gives `law` times that now."""
    if law > harder:
        return support_load * min(law / harder, SUPPORT_FASTEST)
    return max(1.0, support_load * min(law, 1.0))


@kernel
def bear(I, M, share, harder):
    """Let what the floor's springs bear at rest follow the load, by a share of the difference.

    Cable and bodies that press harder than by their weight for long, on the top of a hump, lie on
    the floor as others do, or where they press it by so many times what it bears; what strikes it
    finds it as soft as it is. Returns the largest difference, relative to what was borne, with its
    sign.
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
        difference = load_aimed_at(support_load, pressed, harder) - support_load
        edge.support = support_load + share * difference
        if abs(difference) > abs(largest) * support_load:
            largest = difference / support_load
    for place in range(contact_places(I)):
        node, load, preload = contact_place(I, M, place)
        if load <= 0.0:
            continue
        _press, gap, _speed = place_force(I, M, place, load, preload, node, q, v, contact)
        law, _stiffness, _energy = place_law(preload, gap, depth)
        row = body_of(I, M, place // 2)
        at_end = place == 2 * head.body_count
        support_load = state.end_support if at_end else row.support[place % 2]
        difference = load_aimed_at(support_load, law, harder) - support_load
        if abs(difference) > abs(largest) * support_load:
            largest = difference / support_load
        if at_end:
            state.end_support += share * difference
        else:
            row.support[place % 2] += share * difference
    return largest
