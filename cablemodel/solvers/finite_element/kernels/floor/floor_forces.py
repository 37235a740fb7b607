"""The sea floor's forces on cable and bodies, and their derivatives."""

from cablemodel.solvers.finite_element.kernels.element.tables import (
    CONTACT_H,
    CONTACT_POINTS,
    CONTACT_WEIGHTS,
)
from cablemodel.solvers.finite_element.kernels.floor.contact import (
    approach,
    bristle,
    bristle_at,
    contact_force,
    contact_law,
    contact_of,
    contact_place,
    contact_places,
    damp_bristle,
    damp_bristle_at,
    damping_time,
    friction,
    interpolate,
    place_damping,
    place_force,
    place_law,
)
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import (
    gap_at,
    gap_below,
    lowest_gap,
)
from cablemodel.solvers.shared.access import edge_of, header, matrix, scalars, vector
from cablemodel.solvers.shared.compile import inlined, kernel, own_numbers, view
from cablemodel.solvers.shared.layout import FLOOR_TABLE

element_sums = own_numbers(144)
"""element_sums(): zeros (dimension, dimension, 4, 4), for components and shape functions."""


@inlined
def elements_residual(I, M, q, v, out, dimension):
    """Subtract the floor's forces on the elements. dimension: a constant to the compiler."""
    head = header(I)
    state = scalars(M)
    size = 2 * dimension
    contact = contact_of()
    ends = view(M, head.end_force, size * head.nodes)
    joints = view(I, head.joint, head.nodes)
    parents = view(I, head.parent, head.nodes)
    depth = state.floor_depth
    for node in range(1, head.nodes):
        if joints[node] != 0:
            continue
        if lowest_gap(I, M, q, node) >= depth:
            continue
        parent = parents[node]
        edge = edge_of(I, M, node)
        h = edge.length
        load = edge.contact * edge.support
        contact.ahead = damping_time(M, load, edge.mass)
        above = view(out, size * parent, size)
        below = view(out, size * node, size)
        end = view(ends, size * node, size)
        for p in range(4):
            press, gap, _speed = contact_force(
                I, M, q, v, parent, node, h, p, load, contact, dimension
            )
            if gap >= depth:
                continue
            weight = h * CONTACT_WEIGHTS[p]
            n0 = CONTACT_H[p, 0]
            n1 = h * CONTACT_H[p, 1]
            n2 = CONTACT_H[p, 2]
            n3 = h * CONTACT_H[p, 3]
            for i in range(dimension):
                force = weight * (press * contact.normal[i] + contact.along[i])
                above[i] -= n0 * force
                above[dimension + i] -= n1 * force
                below[i] -= n2 * force
                below[dimension + i] -= n3 * force
                end[i] += n0 * force
                end[dimension + i] -= n2 * force


@kernel
def floor_residual(I, M, q, v, out):
    """Subtract the floor's forces on cable and bodies from the forces that are left at the nodes.

    The elements' end forces get their share, so that tensions inside the line know of the floor.
    """
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    if dimension == 2:
        elements_residual(I, M, q, v, out, 2)
    else:
        elements_residual(I, M, q, v, out, 3)
    contact = contact_of()
    for place in range(contact_places(I)):
        node, load, preload = contact_place(I, M, place)
        if load <= 0.0:
            continue
        press, _gap, _speed = place_force(I, M, place, load, preload, node, q, v, contact)
        for i in range(dimension):
            out[size * node + i] -= press * contact.normal[i] + contact.along[i]


@kernel
def add_at_node(I, M, node, value, a, b, project):
    """Add value times a b^T, or times 1 - a b^T with project, to a node's block for its place."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    at = head.diagonal + size * size * node
    for i in range(dimension):
        for j in range(dimension):
            entry = a[i] * b[j]
            if project:
                entry = -entry
                if i == j:
                    entry += 1.0
            M[at + size * i + j] += value * entry


@kernel
def turn_of_normal(I, M, place, turn):
    """Derivatives of a table's normal to the place, (3, 3) by rows [1/m].

    By differences over the contact layer: the table is C1, its second derivatives jump.
    """
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    step = state.floor_depth
    normal = vector()
    for j in range(dimension):
        r = place[j]
        place[j] = r + step
        gap_at(I, M, place, normal)
        for i in range(dimension):
            turn[3 * i + j] = 0.5 * normal[i] / step
        place[j] = r - step
        gap_at(I, M, place, normal)
        for i in range(dimension):
            turn[3 * i + j] -= 0.5 * normal[i] / step
        place[j] = r


@inlined
def block_of(I, node, k, l, dimension):
    """Where the block of shape functions k (row) and l (column) of an element starts."""
    head = header(I)
    area = 4 * dimension * dimension
    parent = I[head.parent + node]
    if k < 2 and l < 2:
        return head.diagonal + area * parent
    if k >= 2 and l >= 2:
        return head.diagonal + area * node
    if k < 2:
        return head.upper + area * node
    return head.lower + area * node


@inlined
def add_point(p, h, rub, of_spring, contact, sums, dimension):
    """Add the derivatives at contact point p of an element to its sums (d, d, 4, 4).

    For components i, j and shape functions k, l. rub: minus the force's derivative to the bristle,
    damper and spring; of_spring: of the spring, which is linear along the chord. They and the
    contact's stiffness are times the point's weight.
    """
    normal = contact.normal
    slip = contact.slip
    chord = contact.chord
    x = CONTACT_POINTS[p]
    across = 0.0
    slips = 0.0
    if rub != 0.0:
        for i in range(dimension):
            across += normal[i] * chord[i]
            slips += slip[i] * chord[i]
    for i in range(dimension):
        along = of_spring * (chord[i] - across * normal[i] - slips * slip[i]) if rub != 0.0 else 0.0
        for j in range(dimension):
            a = contact.stiffness[3 * i + j]
            a -= rub * (normal[i] * normal[j] + slip[i] * slip[j])
            if i == j:
                a += rub
            b = 0.0
            if rub != 0.0:
                b = along * chord[j]
                a -= b
            at = 16 * (dimension * i + j)
            for k in range(4):
                nk = CONTACT_H[p, k]
                if k % 2 == 1:
                    nk *= h
                ak = nk * a
                sums[at + 4 * k] += ak * CONTACT_H[p, 0] + nk * b * (1.0 - x)
                sums[at + 4 * k + 1] += ak * (h * CONTACT_H[p, 1])
                sums[at + 4 * k + 2] += ak * CONTACT_H[p, 2] + nk * b * x
                sums[at + 4 * k + 3] += ak * (h * CONTACT_H[p, 3])


@inlined
def add_sums(I, M, node, sums, dimension):
    """Add an element's sums to the blocks of the matrix, and clear them."""
    for k in range(4):
        for l in range(4):
            at = block_of(I, node, k, l, dimension)
            at += 2 * dimension * dimension * (k % 2) + dimension * (l % 2)
            for i in range(dimension):
                for j in range(dimension):
                    from_ = 16 * (dimension * i + j) + 4 * k + l
                    M[at + 2 * dimension * i + j] += sums[from_]
                    sums[from_] = 0.0


@inlined
def elements_jacobian(I, M, q, v, cv, dimension):
    """Add the derivatives of the floor's forces on the elements; dimension as above."""
    head = header(I)
    state = scalars(M)
    contact = contact_of()
    normal = contact.normal
    slip = contact.slip
    turn = matrix()
    depth = state.floor_depth
    damping = state.floor_damping
    rubs = state.friction > 0.0
    bends = head.floor_kind == FLOOR_TABLE
    sums = element_sums()
    for node in range(1, head.nodes):
        if I[head.joint + node] != 0:
            continue
        if lowest_gap(I, M, q, node) >= depth:
            continue
        parent = I[head.parent + node]
        edge = edge_of(I, M, node)
        h = edge.length
        load = edge.contact * edge.support
        contact.ahead = damping_time(M, load, edge.mass)
        touched = False
        for p in range(4):
            interpolate(q, parent, node, h, p, contact.place, dimension)
            gap = gap_below(I, M, contact.place, normal, dimension)
            if gap >= depth:
                continue
            speed = approach(v, parent, node, h, p, contact, dimension)
            free = max(0.0, 1.0 - damping * speed)
            if free == 0.0:
                continue
            share, stiffness, _energy = contact_law(gap, depth)
            spring = load * share
            stiff = load * stiffness * free + cv * damping * spring
            weight = h * CONTACT_WEIGHTS[p]
            touched = True
            if bends:
                turn_of_normal(I, M, contact.place, turn)
            for i in range(dimension):
                for j in range(dimension):
                    turned = spring * free * turn[3 * i + j] if bends else 0.0
                    contact.stiffness[3 * i + j] = weight * (stiff * normal[i] * normal[j] - turned)
            rub = 0.0
            of_spring = 0.0
            if rubs:
                press = spring * free
                bristle(I, M, q, parent, node, h, p, contact, dimension)
                damp_bristle(contact, dimension)
                sticks, length, rub = friction(M, load, press, contact, dimension)
                of_spring = weight * rub
                rub *= 1.0 + cv * contact.ahead
                for i in range(dimension):
                    slip[i] = 0.0 if sticks else contact.bristle[i] / length
                    push = weight * state.friction * stiff * slip[i]
                    for j in range(dimension):
                        contact.stiffness[3 * i + j] -= push * normal[j]
            add_point(p, h, weight * rub, of_spring, contact, sums, dimension)
        if touched:
            add_sums(I, M, node, sums, dimension)


@kernel
def floor_jacobian(I, M, q, v, cv):
    """Add the derivatives of the floor's forces to the blocks of the effective Jacobian."""
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    size = 2 * dimension
    if dimension == 2:
        elements_jacobian(I, M, q, v, cv, 2)
    else:
        elements_jacobian(I, M, q, v, cv, 3)
    contact = contact_of()
    normal = contact.normal
    slip = contact.slip
    turn = matrix()
    depth = state.floor_depth
    rubs = state.friction > 0.0
    bends = head.floor_kind == FLOOR_TABLE
    for place in range(contact_places(I)):
        node, load, preload = contact_place(I, M, place)
        if load <= 0.0:
            continue
        press, gap, speed = place_force(I, M, place, load, preload, node, q, v, contact)
        if press <= 0.0:
            continue
        _share, stiffness, _energy = place_law(preload, gap, depth)
        damping = place_damping(M, preload)
        free = 1.0 - damping * speed
        stiff = load * stiffness * free + cv * damping * press / free
        add_at_node(I, M, node, stiff, normal, normal, False)
        if bends:
            turn_of_normal(I, M, contact.place, turn)
            at = head.diagonal + size * size * node
            for i in range(dimension):
                for j in range(dimension):
                    M[at + size * i + j] -= press * turn[3 * i + j]
        if rubs:
            bristle_at(I, M, node, contact, dimension)
            damp_bristle_at(v, node, contact, dimension)
            sticks, length, rub = friction(M, load, press, contact, dimension)
            rub *= 1.0 + cv * contact.ahead
            add_at_node(I, M, node, rub, normal, normal, True)
            if not sticks:
                for i in range(dimension):
                    slip[i] = contact.bristle[i] / length
                add_at_node(I, M, node, -rub, slip, slip, False)
                add_at_node(I, M, node, -state.friction * stiff, slip, normal, False)
