"""The mesh follows what bends in free water: elements are halved where a cubic does not do.

A cubic element misses a smooth curve by h^4 |r''''| / 384, and r'' jumps by J = h^2 |r''''| / 6
between two of them: h^2 J / 64 is what it misses. Where a line is pushed, cracks or folds, that
grows from nothing to hundreds of tau L within a second. Halves become one again, never more than
they were at the start, once one cubic does for both.
"""

import math

from cablemodel.solvers.finite_element.kernels.element.limp import SNAPS
from cablemodel.solvers.finite_element.kernels.element.scales import line_length
from cablemodel.solvers.finite_element.kernels.element.strain import (
    folds,
    is_limp,
    promised_tension,
)
from cablemodel.solvers.finite_element.kernels.mesh.payout import join_at, split_element
from cablemodel.solvers.finite_element.kernels.mesh.touchdown_mesh import (
    ROW_JUMPS,
    bend_allowed,
    finest_flexible,
    halves_are_even,
    holds_something,
    jump_at,
    may_be_halved,
    one_cubic_does,
    position_accuracy,
    second_derivative,
)
from cablemodel.solvers.finite_element.kernels.time.buckling import is_pressed
from cablemodel.solvers.shared.access import (
    cable_of,
    edge_at,
    edge_of,
    header,
    scalars,
    spare_row,
    tension_of,
    vector,
    word_of,
)
from cablemodel.solvers.shared.compile import kernel, view
from cablemodel.solvers.shared.layout import (
    CHANGED,
    EDGE_WORDS,
    JOINT_NONE,
    NO_CAPACITY,
    NOTHING,
    OK,
)
from cablemodel.solvers.shared.numbers import COMMON_TOLERANCE, END_BEND

BENDING_PAUSE = 0.02  # of sqrt(L/g): how often the mesh is looked at
BENDING_STRAIGHT = 0.02  # of what is allowed: the same for two elements that are joined
BENDING_TOO_LONG = 1.5  # of what an element should have: longer ones are halved
UNITED_LENGTH = 1.001  # of the length before: two elements that may be one are no longer, rounded


@kernel
def bends_too_much(I, M, node, jump):
    """Whether an element's cubic misses more than is allowed; jump: the larger at its ends.

    Cable without bending stiffness that is pushed buckles at the scale of its elements, whatever
    that is, and let go slack it folds ever finer: there an end is set, sooner under pressure.
    """
    edge = edge_of(I, M, node)
    h = edge.length
    if edge.bending_full == 0.0 and h < finest_flexible(I, M, node):
        return False
    return h * h * jump > bend_allowed(I, M, node)


@kernel
def is_pressed_aside(I, M, node):
    """Whether an element is pressed so that it would have to bend further within than positions
    may be wrong by: to get rid of its pressure T at once, by 2 / pi h sqrt(T / EA)."""
    head = header(I)
    count = 2 * head.dimension * head.nodes
    q = view(M, head.position, count)
    tension = view(M, head.tension, 2 * head.nodes)
    if not is_pressed(I, M, node, q, tension, promised_tension(M)):
        return False
    edge = edge_of(I, M, node)
    bend = 2.0 / math.pi * math.sqrt(-tension[2 * node] * edge.compliance)
    return bend * edge.length > position_accuracy(I, M, node)


@kernel
def may_snap(I, M, node):
    """Whether an element is slack, and too long for the waves of the snap that ends that."""
    edge = edge_of(I, M, node)
    t0, t1 = tension_of(I, M, node).mean, tension_of(I, M, node).slope
    if is_limp(edge) or not folds(M, edge, t0, t1):
        return False
    finer = math.pow(scalars(M).tolerance / COMMON_TOLERANCE, 0.25)
    return edge.length > BENDING_TOO_LONG * SNAPS * line_length(I, M, edge) * finer


@kernel
def may_unite(I, M, node, jump):
    """Whether the elements on both sides of a node are halves that may be one; jump: the larger at
    the far ends of both, by which one in their place would be halved at once.

    None where drag hardly damps: what a join leaves would go on for good. Here r'' may not jump
    along the line either: the strains of two elements that differ make a mode of the joined one
    which nothing but its stabilisation holds.
    """
    state = scalars(M)
    if state.undamped != 0.0:
        return False
    upper = edge_of(I, M, node)
    lower = edge_at(M, word_of(M, upper) + EDGE_WORDS)
    h = upper.length + lower.length
    return (
        h <= UNITED_LENGTH * min(upper.nominal, lower.nominal)
        and upper.segment == lower.segment
        and not holds_something(I, M, node)
        and h * h * jump <= bend_allowed(I, M, node)
        and h * h * jump_at(I, M, node, False) < BENDING_STRAIGHT * bend_allowed(I, M, node)
        and one_cubic_does(I, M, node)
    )


@kernel
def halve_for_good(I, M, node):
    """Halve an element into two that are not joined again. OK or NO_CAPACITY."""
    if split_element(I, M, node, 0.5) != OK:
        return NO_CAPACITY
    for half in range(node, node + 2):
        edge_of(I, M, half).nominal = edge_of(I, M, half).length
    scalars(M).most_nodes += 1.0
    return OK


@kernel
def is_counted(I, M, node):
    """Whether the scene counts the elements of an element's cable."""
    return cable_of(I, M, int(edge_of(I, M, node).segment)).counted != 0.0


@kernel
def halve_bent(I, M, bends, allowed):
    """Halve elements of a static shape that bend by more than is allowed, (nodes,), where the mesh
    may change. NOTHING, CHANGED, or NO_CAPACITY: the block, as it was, must grow first."""
    changed = NOTHING
    if header(I).parts == 0 and scalars(M).bent == 0.0:
        return changed
    node = header(I).nodes - 1  # from the last one on: halves go where the whole one went
    while node >= 1:
        bent = I[header(I).joint + node] == JOINT_NONE and bends[node] > allowed
        if bent and not is_counted(I, M, node) and may_be_halved(I, M, node):
            if halve_for_good(I, M, node) != OK:
                return NO_CAPACITY
            changed = CHANGED
        node -= 1
    return changed


@kernel
def measure_bends(I, M, out):
    """By how much each element of a static shape bends, (nodes,) [m]: h^2 times the larger jump of
    r'' at its ends.

    The curvature of a cubic changes by D over its length h and jumps by J at its nodes; what it
    cannot follow misplaces the cable by a fraction of h^2 J. Flexible ends have no neighbour to
    compare with: a quarter of D stands for J.
    """
    head = header(I)
    begin = vector()
    end = vector()
    last = head.nodes - 1
    while last > 1 and I[head.joint + last] != 0:
        last -= 1  # beyond it there may be a body
    out[: head.nodes] = 0.0
    for node in range(1, head.nodes):
        if I[head.joint + node] != 0:
            continue
        above = node > 1 and I[head.joint + node - 1] == 0
        below = node + 1 < head.nodes and I[head.joint + node + 1] == 0
        jump = 0.0
        if above:
            jump = max(jump, jump_at(I, M, node - 1, False))
        if below:
            jump = max(jump, jump_at(I, M, node, False))
        is_end = node == 1 or node == last
        if head.parts != 0:
            is_end = not above or not below
        if is_end:
            second_derivative(I, M, node, 0, begin)
            second_derivative(I, M, node, 1, end)
            square = 0.0
            for i in range(head.dimension):
                square += (end[i] - begin[i]) ** 2
            jump = max(jump, END_BEND * math.sqrt(square))
        h = edge_of(I, M, node).length
        out[node] = h * h * jump


@kernel
def follow_bending(I, M, change):
    """Whether the shape asks for another mesh; with `change`, halve and join elements for it.

    NOTHING, CHANGED (or to be changed), or NO_CAPACITY: the block must grow first.
    """
    head = header(I)
    state = scalars(M)
    state.bent_after = state.time + BENDING_PAUSE * state.period
    nodes = head.nodes
    jumps = view(M, spare_row(I, ROW_JUMPS), nodes + 1)
    for node in range(nodes):
        # At the line's ends r'' may be anything.
        jumps[node] = jump_at(I, M, node, True) if 0 < node < nodes - 1 else 0.0
    changed = NOTHING
    node = nodes - 1
    while node >= 1:
        if I[head.joint + node] == 0:
            if may_snap(I, M, node) and may_be_halved(I, M, node):
                if not change:
                    return CHANGED
                if halve_for_good(I, M, node) != OK:
                    return NO_CAPACITY
                changed = CHANGED
            elif bends_too_much(I, M, node, max(jumps[node - 1], jumps[node])) or (
                tension_of(I, M, node).mean < 0.0 and is_pressed_aside(I, M, node)
            ):
                if (
                    head.nodes + head.left_out < state.most_nodes
                    and may_be_halved(I, M, node)
                    and halves_are_even(I, M, node)
                ):
                    if not change:
                        return CHANGED
                    if split_element(I, M, node, 0.5) != OK:
                        return NO_CAPACITY
                    changed = CHANGED
            elif (
                # Nodes after this one may have been split; those before it are as measured.
                node > 1
                and I[head.joint + node - 1] == 0
                and not bends_too_much(I, M, node - 1, max(jumps[node - 2], jumps[node - 1]))
                and may_unite(I, M, node - 1, max(jumps[node - 2], jumps[node]))
            ):
                if not change:
                    return CHANGED
                join_at(I, M, node - 1, 1)
                changed = CHANGED
                node -= 1
        node -= 1
    return changed
