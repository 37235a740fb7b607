"""A static start in which friction takes hold of what lies to an anchor as soon as tension asks.

Friction is a bristle of a length u. Where Coulomb's friction ends a tension, it creeps on over
sqrt(EA u / (mu w)), and is wrong by sqrt(EA u mu w) / e at most. Cable that hardly stretches feels
that at its anchor, though nothing has moved by more than u. A start has no steps to take: it is
found on bristles that are as short as tensions ask. Steps go on with longer ones, drawn by the same
shares: what a step may be wrong by would work shorter ones loose.

Bristles get shorter bit by bit, and what slips is drawn after at each length. Who looks for the
start (start/firm_friction.py, the FMU's system_start.c) finds the equilibria between.
"""

import math

from cablemodel.solvers.finite_element.kernels.element.strain import strain_in
from cablemodel.solvers.finite_element.kernels.element.tables import FIRM_BRISTLE, SHORTEST_BRISTLE
from cablemodel.solvers.finite_element.kernels.floor.floor_memory import longest_bristle, settle
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import near_floor
from cablemodel.solvers.finite_element.kernels.start.at_rest import end_search
from cablemodel.solvers.finite_element.kernels.time.begin import hold_supports
from cablemodel.solvers.shared.access import (
    constraint_of,
    edge_of,
    firm_hold_at,
    header,
    scalars,
    tension_of,
)
from cablemodel.solvers.shared.compile import inlined, kernel, view
from cablemodel.solvers.shared.layout import (
    CHANGED,
    FLOOR_NONE,
    HELD_BY_ANCHOR,
    JOINT_BODY,
    JOINT_NONE,
    NOTHING,
    OK,
    SEARCH,
    STATICS_FAILED,
)
from cablemodel.solvers.shared.numbers import PROMISE, RELATIVE_ROUNDING

SHORTER_AT_ONCE = 2.0
"""By how much bristles get shorter at a time, at most; at a fourth the tension beyond what slips
is twice as wrong."""
DRAWINGS = 4
"""In which roots are drawn after what has slipped, at each length. With one of them what lies
pulls twice as much at its anchor; from then on the elements decide."""
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
def begin_to_hold(I, M, words):
    """Before friction takes hold at a start that was found: lengths of bristles into a FirmHold.

    An exported start may have shorter bristles than those on which one is found: it gets these.
    Returns CHANGED where lines that lie to anchors ask for shorter ones, else NOTHING.
    """
    head = header(I)
    state = scalars(M)
    if head.floor_kind == FLOOR_NONE or state.friction == 0.0:
        return NOTHING
    at = firm_hold_at(words, 0)
    bristle = longest_bristle(M)
    if not abs(state.bristle - bristle) <= RELATIVE_ROUNDING * bristle:
        state.bristle = bristle
    at.own = at.least = at.for_steps = bristle
    at.length = at.drawn = at.is_last = 0.0
    for row in range(head.constraint_count):
        anchor, _outward, largest, ea_mu_w = lies_to(I, M, row)
        if anchor >= 0:
            short = short_bristle(M, largest, ea_mu_w)
            creeps = CREEP_ALLOWED * state.tolerance * largest * largest / ea_mu_w
            at.least = min(at.least, short)
            at.for_steps = min(at.for_steps, max(short, FIRM_BRISTLE * max(bristle, creeps)))
    return CHANGED if at.least < bristle else NOTHING


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


@kernel
def takes_up(I, M, before):
    """Whether friction takes up more, of pull and of pressure, than what slips loses, against
    tensions before, (nodes, 2)."""
    most = -math.inf
    least = math.inf
    for node in range(header(I).nodes):
        up = abs(before[2 * node]) - abs(tension_of(I, M, node).mean)
        most = max(most, up)
        least = min(least, up)
    return most > -least


@kernel
def go_on_holding(I, M, status, words, before):
    """Let friction take hold, from one equilibrium to the next, after `begin_to_hold`.

    SEARCH: an equilibrium at rest is to be found next, and this to be called again with its status
    (OK at first); OK: friction holds; else there is no such start, as where what slips loses more
    where the cable lands than friction takes up beyond: where all slips up to the anchor, no
    tension creeps. words: a FirmHold; before: tensions of the start that was found, (nodes, 2).
    """
    state = scalars(M)
    at = firm_hold_at(words, 0)
    in_system = header(I).parts != 0
    if status != OK:
        return status
    if at.length == 0.0:
        lay_to_anchors(I, M)
        at.length = at.own
    elif at.is_last != 0.0:
        if in_system:
            hold_supports(I, M)
            end_search(I, M)
        return OK
    else:
        settle(I, M)
        at.drawn += 1.0
        if at.drawn < DRAWINGS:
            return SEARCH
        if at.length == at.least:
            if not takes_up(I, M, before):
                return STATICS_FAILED
            at.is_last = 1.0
            draw_alike(I, M, at.for_steps)
            return SEARCH
        at.length = max(at.least, at.length / SHORTER_AT_ONCE)
        at.drawn = 0.0
    state.bristle = at.length
    return SEARCH
