"""What the sea floor does at a state: its force, the touchdown, what it stores and takes."""

import math

from cablemodel.solvers.finite_element.kernels.element.tables import CONTACT_POINTS, CONTACT_WEIGHTS
from cablemodel.solvers.finite_element.kernels.floor.contact import (
    contact_force,
    contact_law,
    contact_of,
    contact_place,
    contact_places,
    damping_time,
    interpolate,
    place_force,
    place_law,
)
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import (
    cubic_end,
    gap_at,
    lowest_gap,
)
from cablemodel.solvers.shared.access import (
    cable_of,
    constraint_of,
    edge_of,
    header,
    scalars,
    tension_of,
    vector,
)
from cablemodel.solvers.shared.compile import kernel, own_record, view
from cablemodel.solvers.shared.layout import HELD_BY_ANCHOR, JOINT_BODY, JOINT_HINGE, JOINT_ROOT
from cablemodel.solvers.shared.numbers import LYING
from cablemodel.solvers.shared.record import Record, integer, real

ZONE = 2.5, 6.0  # touchdown layers behind a touchdown: ends of the zone of its reaction
LOOKED_PARTS = 16  # of an element: between them its gap is taken as even
GAP_HALVINGS = 30  # of such a part: where the gap is first less


@kernel
def hermite_point(I, M, node, x, place):
    """Position at a fraction x of an element."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    h = edge_of(I, M, node).length
    n0, n1, _d0, _d1 = cubic_end(0, x, h)
    n2, n3, _d2, _d3 = cubic_end(1, x, h)
    p = head.position + size * I[head.parent + node]
    q = head.position + size * node
    for i in range(dimension):
        place[i] = n0 * M[p + i] + n1 * M[p + dimension + i]
        place[i] += n2 * M[q + i] + n3 * M[q + dimension + i]


@kernel
def lying_gap(I, M, node):
    """Gap below which cable of an element lies: where the floor bears as much of its weight [m]."""
    state = scalars(M)
    share = (1.0 - LYING) * (1.0 - LYING) / edge_of(I, M, node).support
    return state.floor_depth * (1.0 - math.sqrt(share))


@kernel
def gap_within(I, M, node, x, place, normal):
    """The gap at a fraction x of an element [m], its place, and the floor's normal."""
    hermite_point(I, M, node, x, place)
    return gap_at(I, M, place, normal)


@kernel
def against_tree(I, M, node, turned):
    """Whether a line is looked at along an element against the tree; turned: from its end."""
    backward = cable_of(I, M, int(edge_of(I, M, node).segment)).backward != 0.0
    return backward != turned


@kernel
def gap_along(I, M, node, turned, x, place, normal):
    """The gap at a fraction x of an element from where it is looked at, as `gap_within`."""
    if against_tree(I, M, node, turned):
        x = 1.0 - x
    return gap_within(I, M, node, x, place, normal)


@kernel
def adjacent(I, one, other):
    """Whether one of two elements begins at the node at which the other one ends."""
    return I[header(I).parent + other] == one or I[header(I).parent + one] == other


@kernel
def hangs_on(I, node, before):
    """Whether an element hangs in the tree on the one before it, with or without joints between."""
    head = header(I)
    at = I[head.parent + node]
    while I[head.joint + at] == JOINT_HINGE or I[head.joint + at] == JOINT_BODY:
        at = I[head.parent + at]
    return at == before


@kernel
def goes_on(I, M, before, node, turned):
    """Whether the line has not been cut between two elements that follow each other in it."""
    if against_tree(I, M, node, turned):
        return hangs_on(I, before, node)
    return hangs_on(I, node, before)


@kernel
def nothing_beyond(I, M, node, turned):
    """Whether no joint comes after an element that is the last one looked at."""
    head = header(I)
    if against_tree(I, M, node, turned):
        return I[head.parent + node] == 0 or I[head.joint + I[head.parent + node]] >= JOINT_ROOT
    return node + 1 == head.nodes or I[head.parent + node + 1] != node


@kernel
def turn(elements):
    """The elements of a line in the opposite order."""
    last = len(elements) - 1
    for k in range(len(elements) // 2):
        elements[k], elements[last - k] = elements[last - k], elements[k]


@kernel
def first_below(I, M, node, turned, depth):
    """Fraction of an element, from where it is looked at, where its gap first is less; 2: none."""
    place = vector()
    normal = vector()
    before = 0.0
    for k in range(LOOKED_PARTS + 1):
        x = k / LOOKED_PARTS
        if gap_along(I, M, node, turned, x, place, normal) < depth:
            if k == 0:
                return 0.0
            after = x
            for _halving in range(GAP_HALVINGS):
                x = 0.5 * (before + after)
                if gap_along(I, M, node, turned, x, place, normal) < depth:
                    after = x
                else:
                    before = x
            return after
        before = x
    return 2.0


@kernel
def find_touchdown(I, M, elements, turned):
    """Index of the first element where cable comes to lie, and the fraction of it; -1: none
    touches.

    Cable that the floor bears nowhere by as much as what lies is touched where it begins to be
    borne: something else carries the rest, a flow past it or a pull up.
    """
    head = header(I)
    q = M[head.position : head.position + 2 * head.dimension * head.nodes]
    depth = scalars(M).floor_depth
    touches = -1
    there = 0.0
    for k in range(len(elements)):
        node = int(elements[k])
        if lowest_gap(I, M, q, node) >= depth:
            continue
        begin = first_below(I, M, node, turned, lying_gap(I, M, node))
        if begin <= 1.0:
            return k, begin
        if touches < 0:
            begin = first_below(I, M, node, turned, depth)
            if begin <= 1.0:
                touches = k
                there = begin
    return touches, there


@kernel
def lying_share(I, M, node, turned, begin):
    """Share of an element beyond a fraction of it where the floor bears it.

    Cable that lies rises a little behind its touchdown, without leaving the floor.
    """
    depth = scalars(M).floor_depth
    place = vector()
    normal = vector()
    share = 0.0
    before = 0.0
    for k in range(LOOKED_PARTS + 1):
        x = begin + (1.0 - begin) * k / LOOKED_PARTS
        clear = gap_along(I, M, node, turned, x, place, normal) - depth
        if k > 0:
            if clear < 0.0 and before < 0.0:
                share += 1.0
            elif clear < 0.0 or before < 0.0:
                share += min(clear, before) / (min(clear, before) - max(clear, before))
        before = clear
    return share * (1.0 - begin) / LOOKED_PARTS


class FloorZone(Record):
    """Of cable that comes to lie: what the floor bears up to the ends of several elements."""

    geometric = real("arc length where cable is as near the floor as it lies", "m")
    first = real("arc length where the zone may end at the earliest", "m")
    last = real("arc length in whose element it ends", "m")
    weight = real("of the cable there, across the floor", "N/m")
    force = real("of the floor so far", "N")
    moment = real("of that about arc length 0", "N m")
    square = real("sum over the ends, of the reaction's square", "N2")
    before = real("sum over the ends, of where cable lies that weighs as much", "m")
    ends = integer("how many ends there are")


floor_zone = own_record(FloorZone)


@kernel
def begin_zone(I, M, node, turned, arc, begin, zone, touchdown):
    """The zone of a touchdown at a fraction of the element above a node, which begins at `arc`;
    writes its place (3)."""
    edge = edge_of(I, M, node)
    normal = vector()
    zone.geometric = arc + begin * edge.length
    layer = (edge.bending_full / edge.contact) ** (1.0 / 3.0)
    tension = max(0.0, tension_of(I, M, node).mean)
    layer += math.sqrt(2.0 * scalars(M).floor_depth * tension / edge.contact)
    zone.first = zone.geometric + ZONE[0] * layer
    zone.last = zone.geometric + ZONE[1] * layer
    gap_along(I, M, node, turned, begin, touchdown, normal)
    zone.weight = edge.contact * normal[header(I).dimension - 1]


@kernel
def add_floor_force(I, M, node, arc, against, zone):
    """Add the floor's force on the element above a node, without what accelerates it, and its
    moment; arc: where it begins; against: its cable goes against the tree."""
    head = header(I)
    dimension = head.dimension
    count = 2 * dimension * head.nodes
    q = M[head.position : head.position + count]
    v = M[head.velocity : head.velocity + count]
    a = M[head.acceleration : head.acceleration + count]
    contact = contact_of()
    acceleration = vector()
    edge = edge_of(I, M, node)
    parent = I[head.parent + node]
    h = edge.length
    load = edge.contact * edge.support
    inertia = edge.mass + edge.added_mass
    for p in range(4):
        press, gap, _speed = contact_force(I, M, q, v, parent, node, h, p, load, contact, dimension)
        if gap >= scalars(M).floor_depth:
            continue
        weight = h * CONTACT_WEIGHTS[p]
        there = arc + h * (1.0 - CONTACT_POINTS[p] if against else CONTACT_POINTS[p])
        interpolate(a, parent, node, h, p, acceleration, dimension)
        for i in range(dimension):
            press -= inertia * contact.normal[i] * acceleration[i]
        zone.force += weight * press
        zone.moment += weight * press * there


@kernel
def touchdown_along(I, M, elements, turned, touchdown):
    """Where a line, or a part of it, comes down to the floor, looked at in the order of `elements`.

    elements: numbers of the nodes at their far ends along the tree. turned: from the line's end.
    Writes the first touchdown point (3) [m] in the block's coordinates, not a number where no cable
    touches. Returns the length of cable from there on that the floor bears [m] and the
    concentrated reaction there [N].

    On a rigid floor cable lies down with a reaction R at one point, at a distance a before the end
    of the zone looked at, and its weight w on the length a. A soft floor spreads R, and cable comes
    to it sooner, by the cube root of its depth; but it bears the same force F = R + w a and the
    same moment about the zone's end, G = R a + w a^2 / 2: so R^2 = F^2 - 2 w G and a = (F - R) / w,
    wherever the zone ends in cable at rest. The touchdown is where the rigid floor's would be. F is
    the floor's force without what accelerates the cable; the mean over the ends of several elements
    is taken. At rest tests hold the touchdown to 0.02 touchdown layers and the length to 0.05 at
    tolerances from 1e-3 to 1e-5 (test_touchdown_layer.py). Where no cable lies as near the floor as
    it does at rest, they are where contact begins.
    """
    head = header(I)
    count = len(elements)
    depth = scalars(M).floor_depth
    q = M[head.position : head.position + 2 * head.dimension * head.nodes]
    zone = floor_zone()
    zone.first = 1e300
    zone.last = 1e300
    for i in range(3):
        touchdown[i] = math.nan
    touched, start = find_touchdown(I, M, elements, turned)
    if touched < 0:
        return 0.0, 0.0
    for i in range(3):
        touchdown[i] = 0.0
    segment = edge_of(I, M, int(elements[touched])).segment
    lying = 0.0
    arc = 0.0  # of the element's beginning
    arc_touched = 0.0
    whole = True
    for k in range(count):
        node = int(elements[k])
        edge = edge_of(I, M, node)
        h = edge.length
        if k > 0 and not goes_on(I, M, int(elements[k - 1]), node, turned):
            # Nothing that is beyond a cut is in balance with what is before it.
            whole = k <= touched
            zone.force = zone.force if k > touched else 0.0
            zone.moment = zone.moment if k > touched else 0.0
        if lowest_gap(I, M, q, node) >= depth:
            arc += h
            continue
        begin = 0.0
        reached = k >= touched
        if k == touched:
            begin = start
            arc_touched = arc
            begin_zone(I, M, node, turned, arc, begin, zone, touchdown)
        if reached:
            lying += h * lying_share(I, M, node, turned, begin)
        # Whole elements: forces of single points are not in balance.
        within = whole and arc < zone.last
        if reached and edge.segment != segment:
            within = False  # bodies and other cable weigh something else
        if within:
            add_floor_force(I, M, node, arc, against_tree(I, M, node, turned), zone)
        arc += h
        if reached and within:
            if arc > zone.first or (k + 1 == count and nothing_beyond(I, M, node, turned)):
                about_end = zone.force * arc - zone.moment
                zone.square += zone.force * zone.force - 2.0 * zone.weight * about_end
                zone.before += arc - zone.force / max(zone.weight, 1e-300)
                zone.ends += 1
    reaction = 0.0
    if zone.ends > 0:
        reaction = math.sqrt(max(0.0, zone.square / zone.ends))
        where = zone.before / zone.ends + reaction / max(zone.weight, 1e-300)
        if abs(where - zone.geometric) < zone.last - zone.geometric:
            # Forward or back from where the cable is as near the floor as it lies; not to where
            # it is clear of the floor: what folds there is in no balance.
            place = vector()
            normal = vector()
            go_along(I, M, elements, turned, touched, arc_touched, where, place)
            if gap_at(I, M, place, normal) < depth:
                lying += zone.geometric - where
                for i in range(head.dimension):
                    touchdown[i] = place[i]
    return lying, reaction


@kernel
def go_along(I, M, elements, turned, k, arc, where, place):
    """Position at an arc length, as `touchdown_along` counts it, from the element of index k on,
    which begins at arc."""
    while where < arc and k > 0 and adjacent(I, int(elements[k - 1]), int(elements[k])):
        k -= 1
        arc -= edge_of(I, M, int(elements[k])).length
    node = int(elements[k])
    h = edge_of(I, M, node).length
    while where > arc + h and k + 1 < len(elements) and adjacent(I, node, int(elements[k + 1])):
        arc += h
        k += 1
        node = int(elements[k])
        h = edge_of(I, M, node).length
    x = min(1.0, max(0.0, (where - arc) / h))
    if against_tree(I, M, node, turned):
        x = 1.0 - x
    hermite_point(I, M, node, x, place)


@kernel
def is_anchored(I, M, node):
    """Whether an anchor holds a node."""
    for n in range(header(I).constraint_count):
        row = constraint_of(I, M, n)
        if row.node == node and row.kind == HELD_BY_ANCHOR:
            return True
    return False


@kernel
def near_node(I, M, node, turned):
    """The node of an element from which it is looked at."""
    if against_tree(I, M, node, turned):
        return node
    return I[header(I).parent + node]


@kernel
def lies_at_first(I, M, node, turned):
    """Whether cable lies where an element is looked at from."""
    return gap_along(I, M, node, turned, 0.0, vector(), vector()) < lying_gap(I, M, node)


@kernel
def touchdown_of_line(I, M, elements, touchdown):
    """The touchdown of a line of a system, as `touchdown_along` gives it, of a line from its
    beginning on. elements are those of the line; their order changes.

    It is looked at from its beginning, or from its end where only the beginning is an anchor or
    lies. What begins on the floor and rises from it comes down again in both directions; what
    comes down from both ends lies between two touchdowns. The point is the first one.
    """
    count = len(elements)
    last = count - 1
    first = int(elements[0])
    low = is_anchored(I, M, near_node(I, M, first, False)) or lies_at_first(I, M, first, False)
    first = int(elements[last])
    low_end = is_anchored(I, M, near_node(I, M, first, True)) or lies_at_first(I, M, first, True)
    turned = low and not low_end
    if turned:
        turn(elements)
    place = vector()
    normal = vector()
    if lies_at_first(I, M, int(elements[0]), turned):
        for k in range(last):
            gap = gap_along(I, M, int(elements[k]), turned, 1.0, place, normal)
            if gap >= scalars(M).floor_depth:
                near = view(elements, 0, k + 1)
                turn(near)
                lying, reaction = touchdown_along(I, M, near, not turned, touchdown)
                far = view(elements, k + 1, last - k)
                more, _reaction = touchdown_along(I, M, far, turned, place)
                return lying + more, reaction
    elif not lies_at_first(I, M, int(elements[last]), not turned):
        one, _start = find_touchdown(I, M, elements, turned)
        turn(elements)
        other, _start = find_touchdown(I, M, elements, not turned)
        other = last - other
        turn(elements)
        if 0 <= one < other <= last:
            half = (one + other) // 2
            near = view(elements, 0, half + 1)
            lying, reaction = touchdown_along(I, M, near, turned, touchdown)
            far = view(elements, half + 1, last - half)
            turn(far)
            more, _reaction = touchdown_along(I, M, far, not turned, place)
            return lying + more, reaction
    return touchdown_along(I, M, elements, turned, touchdown)


@kernel
def touches_line(I, elements, node):
    """Whether a node is at an end of one of a line's elements."""
    for k in range(len(elements)):
        element = int(elements[k])
        if element == node or I[header(I).parent + element] == node:
            return True
    return False


@kernel
def floor_force(I, M, elements, out):
    """The floor's force (3) [N] on elements of a line and on bodies at them, in the block's
    coordinates, at the present state."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    contact = contact_of()
    normal = contact.normal
    q = M[head.position : head.position + size * head.nodes]
    v = M[head.velocity : head.velocity + size * head.nodes]
    depth = scalars(M).floor_depth
    for i in range(3):
        out[i] = 0.0
    for k in range(len(elements)):
        node = int(elements[k])
        if lowest_gap(I, M, q, node) >= depth:
            continue
        edge = edge_of(I, M, node)
        parent = I[head.parent + node]
        h = edge.length
        load = edge.contact * edge.support
        contact.ahead = damping_time(M, load, edge.mass)
        for p in range(4):
            press, gap, _speed = contact_force(
                I, M, q, v, parent, node, h, p, load, contact, dimension
            )
            if gap >= depth:
                continue
            weight = h * CONTACT_WEIGHTS[p]
            for i in range(dimension):
                out[i] += weight * (press * normal[i] + contact.along[i])
    for place in range(contact_places(I)):
        node, load, preload = contact_place(I, M, place)
        if load <= 0.0 or (head.parts != 0 and not touches_line(I, elements, node)):
            continue
        press, _gap, _speed = place_force(I, M, place, load, preload, node, q, v, contact)
        for i in range(dimension):
            out[i] += press * normal[i] + contact.along[i]


@kernel
def floor_energy(I, M, out):
    """Add the energy of the contact springs and the power lost on the floor to Energies."""
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    size = 2 * dimension
    nodes = head.nodes
    contact = contact_of()
    q = M[head.position : head.position + size * nodes]
    v = M[head.velocity : head.velocity + size * nodes]
    depth = state.floor_depth
    for node in range(1, nodes):
        if I[head.joint + node] != 0 or lowest_gap(I, M, q, node) >= depth:
            continue
        parent = I[head.parent + node]
        edge = edge_of(I, M, node)
        h = edge.length
        load = edge.contact * edge.support
        contact.ahead = damping_time(M, load, edge.mass)
        for p in range(4):
            press, gap, speed = contact_force(
                I, M, q, v, parent, node, h, p, load, contact, dimension
            )
            if gap >= depth:
                continue
            share, _stiffness, energy = contact_law(gap, depth)
            weight = h * CONTACT_WEIGHTS[p]
            out.floor += weight * load * energy
            out.floor_power -= weight * (press - load * share) * speed
            for i in range(dimension):
                out.floor_power -= weight * contact.along[i] * contact.velocity[i]
    for place in range(contact_places(I)):
        node, load, preload = contact_place(I, M, place)
        if load <= 0.0:
            continue
        press, gap, _speed = place_force(I, M, place, load, preload, node, q, v, contact)
        share, _stiffness, energy = place_law(preload, gap, depth)
        out.floor += load * energy
        for i in range(dimension):
            force = (press - load * share) * contact.normal[i] + contact.along[i]
            out.floor_power -= force * v[size * node + i]
