"""What a start needs where the floor's friction takes hold of lines that lie to anchors: its places
of rest and the lengths of its bristles (start/firm_friction.py; the FMU's system_start.c).
"""

import math

from cablemodel.solvers.finite_element.kernels.element.strain import strain_in
from cablemodel.solvers.finite_element.kernels.element.tables import FIRM_BRISTLE, SHORTEST_BRISTLE
from cablemodel.solvers.finite_element.kernels.floor.floor_memory import longest_bristle
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import near_floor
from cablemodel.solvers.shared.access import (
    constraint_of,
    edge_of,
    header,
    scalars,
    tension_of,
)
from cablemodel.solvers.shared.compile import inlined, kernel, view
from cablemodel.solvers.shared.layout import (
    CHANGED,
    HELD_BY_ANCHOR,
    JOINT_BODY,
    JOINT_NONE,
    NOTHING,
)
from cablemodel.solvers.shared.numbers import PROMISE

CREEP_ALLOWED = 100.0  # in tau: tension of an anchored line that bristles for steps may move by


@kernel
def next_along(I, node, outward):
    """The node that follows on one along its line, away from the tree's root or towards it; -1: it
    ends there."""
    head = header(I)
    if outward:
        child = node + 1
        if child < head.nodes and I[head.parent + child] == node:
            return child if I[head.joint + child] <= JOINT_BODY else -1
        return -1
    if node == 0 or I[head.joint + node] > JOINT_BODY:
        return -1
    return I[head.parent + node]


@inlined
def lies_to(I, M, row):
    """What lies to the anchor of a constraint, up to where its line rises.

    Returns the anchor's node (-1: nothing lies to one there), whether its line goes away from the
    tree's root, the largest tension along it [N], and EA mu w, the largest of what lies [N2/m].
    """
    head = header(I)
    state = scalars(M)
    held = constraint_of(I, M, row)
    anchor = int(held.node) if int(held.kind) == HELD_BY_ANCHOR else -1
    outward = False
    largest = ea_mu_w = 0.0
    if anchor >= 0:
        outward = next_along(I, anchor, True) != -1
        places = view(M, head.position, 2 * head.dimension * head.nodes)
        # Past what lies, to the end of the line.
        node = anchor
        hangs = not near_floor(I, M, anchor, places)
        while True:
            before = node
            node = next_along(I, before, outward)
            if node == -1:
                break
            hangs = hangs or not near_floor(I, M, node, places)
            element = node if outward else before
            if I[head.joint + element] != JOINT_NONE:
                continue
            largest = max(largest, abs(tension_of(I, M, element).mean))
            edge = edge_of(I, M, element)
            if not hangs and edge.compliance > 0.0:
                ea_mu_w = max(ea_mu_w, state.friction * edge.contact / edge.compliance)
        if not hangs or ea_mu_w == 0.0:
            anchor = -1
    return anchor, outward, largest, ea_mu_w


@inlined
def short_bristle(M, largest, ea_mu_w):
    """Bristle with which tensions are wrong by as much as is promised [m]."""
    state = scalars(M)
    promised = PROMISE * state.tolerance * largest
    return max((math.e * promised) ** 2 / ea_mu_w, SHORTEST_BRISTLE * state.length)


@kernel
def lengths_of_bristles(I, M, lengths):
    """Those of lines that lie to anchors [m]: their own length, the shortest that tensions ask, and
    that for steps. Returns whether any are shorter than their own."""
    bristle = longest_bristle(M)
    lengths[0] = lengths[1] = lengths[2] = bristle
    for row in range(header(I).constraint_count):
        anchor, _outward, largest, ea_mu_w = lies_to(I, M, row)
        if anchor >= 0:
            short = short_bristle(M, largest, ea_mu_w)
            creeps = CREEP_ALLOWED * scalars(M).tolerance * largest * largest / ea_mu_w
            lengths[1] = min(lengths[1], short)
            lengths[2] = min(lengths[2], max(short, FIRM_BRISTLE * max(bristle, creeps)))
    return CHANGED if lengths[1] < bristle else NOTHING


@kernel
def lay_to_anchors(I, M):
    """Make places of rest of what lies to anchors those where it was laid, without tension, from
    the anchor on along its own way; what lies between two ends and rises nowhere stays free."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    bristle = longest_bristle(M)
    places = view(M, head.position, size * head.nodes)
    for row in range(head.constraint_count):
        anchor, outward, largest, ea_mu_w = lies_to(I, M, row)
        if anchor < 0 or short_bristle(M, largest, ea_mu_w) >= bristle:
            continue
        node = anchor
        stretch = 0.0
        sense = 1.0 if outward else -1.0
        while node != -1 and near_floor(I, M, node, places):
            q = head.position + size * node
            rest = head.rest + size * node
            square = 0.0
            for i in range(dimension, size):
                square += M[q + i] ** 2
            slope = math.sqrt(square)
            for i in range(dimension):
                along = M[q + dimension + i] / slope
                M[rest + i] = M[q + i] - sense * stretch * along
                M[rest + dimension + i] = along
            before = node
            node = next_along(I, before, outward)
            element = node if outward else before
            if node != -1 and I[head.joint + element] == JOINT_NONE:
                edge = edge_of(I, M, element)
                tension = tension_of(I, M, element).mean
                stretch += edge.length * strain_in(M, edge, tension)[0]


@kernel
def draw_alike(I, M, bristle):
    """Bristles of another length [m], drawn by the same shares."""
    head = header(I)
    state = scalars(M)
    longer = bristle / state.bristle
    for n in range(2 * head.dimension * head.nodes):
        place = M[head.position + n]
        M[head.rest + n] = place - longer * (place - M[head.rest + n])
    state.bristle = bristle
