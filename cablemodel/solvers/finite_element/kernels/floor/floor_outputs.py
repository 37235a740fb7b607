"""What the sea floor does at a state: its force, the touchdown, what it stores and takes."""

import math

from cablemodel.solvers.finite_element.kernels.element.tables import CONTACT_POINTS, CONTACT_WEIGHTS
from cablemodel.solvers.finite_element.kernels.floor.contact import (
    LYING,
    contact_force,
    contact_law,
    contact_of,
    contact_place,
    contact_places,
    interpolate,
    place_force,
    place_law,
)
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import (
    cubic_end,
    gap_at,
    lowest_gap,
)
from cablemodel.solvers.shared.access import edge_of, header, scalars, vector
from cablemodel.solvers.shared.compile import kernel

ZONE = 2.5, 6.0  # touchdown layers behind a touchdown: ends of the zone of its reaction


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
def first_below(I, M, node, depth):
    """Fraction of an element, from the vessel's side, where its gap first is less; 2: nowhere."""
    place = vector()
    normal = vector()
    before = 0.0
    for k in range(17):
        x = k / 16.0
        if gap_within(I, M, node, x, place, normal) < depth:
            if k == 0:
                return 0.0
            after = x
            for _halving in range(30):
                x = 0.5 * (before + after)
                if gap_within(I, M, node, x, place, normal) < depth:
                    after = x
                else:
                    before = x
            return after
        before = x
    return 2.0


@kernel
def find_touchdown(I, M):
    """Element nearest the vessel where cable comes to lie, and the fraction of it; 0: none touches.

    Cable that the floor bears nowhere by as much as what lies is touched where it begins to be
    borne: something else carries the rest, a flow past it or a pull up.
    """
    head = header(I)
    q = M[head.position : head.position + 2 * head.dimension * head.nodes]
    depth = scalars(M).floor_depth
    touches = 0
    there = 0.0
    for node in range(1, head.nodes):
        if I[head.joint + node] != 0 or lowest_gap(I, M, q, node) >= depth:
            continue
        begin = first_below(I, M, node, lying_gap(I, M, node))
        if begin <= 1.0:
            return node, begin
        if touches == 0:
            begin = first_below(I, M, node, depth)
            if begin <= 1.0:
                touches = node
                there = begin
    return touches, there


@kernel
def lying_share(I, M, node, begin):
    """Share of an element beyond a fraction of it where the floor bears it.

    Cable that lies rises a little behind its touchdown, without leaving the floor.
    """
    depth = scalars(M).floor_depth
    place = vector()
    normal = vector()
    share = 0.0
    before = 0.0
    for k in range(17):
        x = begin + (1.0 - begin) * k / 16.0
        clear = gap_within(I, M, node, x, place, normal) - depth
        if k > 0:
            if clear < 0.0 and before < 0.0:
                share += 1.0
            elif clear < 0.0 or before < 0.0:
                share += min(clear, before) / (min(clear, before) - max(clear, before))
        before = clear
    return share * (1.0 - begin) / 16.0


@kernel
def floor_summary(I, M, force_on_all, touchdown):
    """What the floor does, in the block's coordinates, at the present state.

    Writes its force on cable and bodies (3) [N] and the touchdown point nearest the vessel (3) [m],
    not a number where no cable touches. Returns the length of cable from there on that the floor
    bears [m] and the concentrated reaction there [N].

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
    state = scalars(M)
    dimension = head.dimension
    size = 2 * dimension
    nodes = head.nodes
    contact = contact_of()
    normal = contact.normal
    acceleration = vector()
    q = M[head.position : head.position + size * nodes]
    v = M[head.velocity : head.velocity + size * nodes]
    a = M[head.acceleration : head.acceleration + size * nodes]
    depth = state.floor_depth
    for i in range(3):
        force_on_all[i] = 0.0
        touchdown[i] = 0.0
    lying = 0.0
    reaction = 0.0
    touched, start = find_touchdown(I, M)
    arc = 0.0  # of the element's beginning
    geometric = 0.0  # arc length where cable is as near the floor as it lies
    last = 1e300  # arc length in whose element the zone ends
    first = 1e300  # and where it may end at the earliest
    ends = 0
    weight_there = 0.0
    force = 0.0
    moment = 0.0  # about arc = 0
    square = 0.0  # sums over the ends
    before = 0.0
    for node in range(1, nodes):
        if I[head.joint + node] != 0:
            continue
        edge = edge_of(I, M, node)
        h = edge.length
        if lowest_gap(I, M, q, node) >= depth:
            arc += h
            continue
        parent = I[head.parent + node]
        load = edge.contact * edge.support
        inertia = edge.mass + edge.added_mass
        begin = 0.0
        reached = touched != 0 and node >= touched
        if node == touched:
            begin = start
            geometric = arc + begin * h
            layer = (edge.bending_full / edge.contact) ** (1.0 / 3.0)
            pull = max(0.0, M[head.tension + 2 * node])
            layer += math.sqrt(2.0 * depth * pull / edge.contact)
            first = geometric + ZONE[0] * layer
            last = geometric + ZONE[1] * layer
            gap_within(I, M, node, begin, touchdown, normal)
            weight_there = edge.contact * normal[dimension - 1]
        if reached:
            lying += h * lying_share(I, M, node, begin)
        # Whole elements: forces of single points are not in balance.
        within = arc < last
        if reached and edge.segment != edge_of(I, M, touched).segment:
            within = False  # bodies and other cable weigh something else
        for p in range(4):
            press, gap, _speed = contact_force(
                I, M, q, v, parent, node, h, p, load, contact, dimension
            )
            if gap >= depth:
                continue
            weight = h * CONTACT_WEIGHTS[p]
            for i in range(dimension):
                force_on_all[i] += weight * (press * normal[i] + contact.along[i])
            there = arc + h * CONTACT_POINTS[p]
            if within:
                interpolate(a, parent, node, h, p, acceleration, dimension)
                for i in range(dimension):
                    press -= inertia * normal[i] * acceleration[i]
                force += weight * press
                moment += weight * press * there
        arc += h
        if reached and within and (arc > first or node + 1 == nodes):
            about_end = force * arc - moment
            square += force * force - 2.0 * weight_there * about_end
            before += arc - force / max(weight_there, 1e-300)
            ends += 1
    if touched == 0:
        for i in range(3):
            touchdown[i] = math.nan
    elif ends > 0:
        reaction = math.sqrt(max(0.0, square / ends))
        where = before / ends + reaction / max(weight_there, 1e-300)
        if abs(where - geometric) < last - geometric:
            # Forward or back from where the cable is as near the floor as it lies.
            lying += geometric - where
            go_along(I, M, touched, where, touchdown)
    for place in range(contact_places(I)):
        node, load, preload = contact_place(I, M, place)
        if load <= 0.0:
            continue
        press, _gap, _speed = place_force(I, M, load, preload, node, q, v, contact)
        for i in range(dimension):
            force_on_all[i] += press * normal[i] + contact.along[i]
    return lying, reaction


@kernel
def go_along(I, M, node, where, place):
    """Position at an arc length, as `floor_summary` counts it, from an element on."""
    head = header(I)
    arc = 0.0
    for n in range(1, node):
        if I[head.joint + n] == 0:
            arc += edge_of(I, M, n).length
    while where < arc and node > 1 and I[head.joint + node - 1] == 0:
        node -= 1
        arc -= edge_of(I, M, node).length
    h = edge_of(I, M, node).length
    while where > arc + h and node + 1 < head.nodes and I[head.joint + node + 1] == 0:
        arc += h
        node += 1
        h = edge_of(I, M, node).length
    hermite_point(I, M, node, min(1.0, max(0.0, (where - arc) / h)), place)


@kernel
def floor_energy(I, M, out):
    """Add the energy of the contact springs and the power lost on the floor to Energies."""
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    size = 2 * dimension
    nodes = head.nodes
    contact = contact_of()
    velocity = vector()
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
            interpolate(v, parent, node, h, p, velocity, dimension)
            for i in range(dimension):
                out.floor_power -= weight * contact.along[i] * velocity[i]
    for place in range(contact_places(I)):
        node, load, preload = contact_place(I, M, place)
        if load <= 0.0:
            continue
        press, gap, _speed = place_force(I, M, load, preload, node, q, v, contact)
        share, _stiffness, energy = place_law(preload, gap, depth)
        out.floor += load * energy
        for i in range(dimension):
            force = (press - load * share) * contact.normal[i] + contact.along[i]
            out.floor_power -= force * v[size * node + i]
