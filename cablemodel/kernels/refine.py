"""The mesh follows what bends in free water: elements are halved where a cubic does not do.

A cubic element misses a smooth curve by h^4 |r''''| / 384, and r'' jumps by J = h^2 |r''''| / 6
between two of them: h^2 J / 64 is what it misses. Where a line is pushed, cracks or folds, that
grows from nothing to hundreds of tau L within a second. Halves become one again, never more than
they were at the start, once one cubic does for both.
"""

from .compile import kernel
from .follow import holds_something, jump_at, one_cubic_does
from .layout import (
    CABLE_WORDS,
    E_BENDING_FULL,
    E_LENGTH,
    E_NOMINAL,
    E_SEGMENT,
    EDGE_WORDS,
    I_CAPACITY,
    I_NODES,
    I_PAYOUT,
    I_TOP_CABLE,
    K_NOMINAL,
    O_CABLES,
    O_EDGE,
    O_JOINT,
    O_STAGE_V,
    O_TENSION,
    OK,
    S_BENT,
    S_BENT_AFTER,
    S_PASSING,
    S_PERIOD,
    S_TIME,
    S_TOP_LENGTH,
)
from .payout import join_at, split_edge
from .top_of_line import FEWEST_ELEMENTS, JOIN, element_number, follows_top, is_too_large

PAUSE = 0.02  # of sqrt(L/g): how often the mesh is looked at
STRAIGHT = 0.02  # of what is allowed: the same for two elements that are joined
FINEST = 0.5  # of what is allowed: no shorter element of cable that does not bend is halved
HALVE, UNITE = 1, 2  # what the shape may ask for of the top element


@kernel
def bends_too_much(I, M, node, jump):
    """Whether an element's cubic misses more than is allowed; jump: the larger at its ends.

    Cable without bending stiffness that is pushed buckles at the scale of its elements, whatever
    that is: it has no shape to follow. Let go slack it folds ever finer, to no end either.
    """
    edge = I[O_EDGE] + node * EDGE_WORDS
    h = M[edge + E_LENGTH]
    if M[edge + E_BENDING_FULL] == 0.0:
        if M[I[O_TENSION] + 2 * node] < 0.0 or h < FINEST * M[S_BENT]:
            return False
    return h * h * jump > M[S_BENT]


@kernel
def may_unite(I, M, node, jump):
    """Whether the elements on both sides of a node, where r'' jumps, are halves that may be one."""
    upper = I[O_EDGE] + node * EDGE_WORDS
    lower = upper + EDGE_WORDS
    h = M[upper + E_LENGTH] + M[lower + E_LENGTH]
    return (
        h <= 1.001 * min(M[upper + E_NOMINAL], M[lower + E_NOMINAL])
        and h * h * jump < STRAIGHT * M[S_BENT]
        and M[upper + E_SEGMENT] == M[lower + E_SEGMENT]
        and not holds_something(I, M, node)
        and one_cubic_does(I, M, node)
    )


@kernel
def top_wish(I, M):
    """What the shape asks for of the winch's top element: HALVE, UNITE with the next one, or 0.

    Its length is the winch's (top_of_line.py), but a bend in it is resolved like any other: left
    alone, those below were halved instead of it, and a join of bent elements gave the line three
    times its energy.
    """
    if M[S_PASSING] != 0.0 or I[I_NODES] < 3 or not follows_top(I, M):
        return 0
    if I[I[O_JOINT] + 1] != 0 or I[I[O_JOINT] + 2] != 0:
        return 0
    jump = jump_at(I, M, 1)
    if bends_too_much(I, M, 1, jump):
        return HALVE if I[I_NODES] < I[I_CAPACITY] else 0
    first = I[O_EDGE] + EDGE_WORDS
    below = first + EDGE_WORDS
    nominal = M[I[O_CABLES] + I[I_TOP_CABLE] * CABLE_WORDS + K_NOMINAL]
    h = M[S_TOP_LENGTH] + M[below + E_LENGTH]
    next_jump = jump_at(I, M, 2) if I[I_NODES] > 3 else 0.0
    if (
        M[S_TOP_LENGTH] < JOIN * nominal
        and element_number(I, M) > FEWEST_ELEMENTS
        and not is_too_large(I, M, h, I[I_NODES] - 2)
        and M[below + E_SEGMENT] == M[first + E_SEGMENT]
        and not holds_something(I, M, 1)
        and h * h * next_jump <= M[S_BENT]
        and h * h * jump < STRAIGHT * M[S_BENT]
        and one_cubic_does(I, M, 1)
    ):
        return UNITE
    return 0


@kernel
def follow_bending(I, M, change):
    """Whether the shape asks for another mesh; with `change`, halve and join elements for it."""
    M[S_BENT_AFTER] = M[S_TIME] + PAUSE * M[S_PERIOD]
    nodes = I[I_NODES]
    first = 2 if I[I_PAYOUT] != 0 else 1
    jumps = M[I[O_STAGE_V] : I[O_STAGE_V] + nodes + 1]
    for node in range(nodes):
        # At the line's ends r'' may be anything.
        jumps[node] = jump_at(I, M, node) if 0 < node < nodes - 1 else 0.0
    changed = False
    if first == 2 and not change and top_wish(I, M) != 0:
        return True
    node = nodes - 1
    while node >= first:
        if I[I[O_JOINT] + node] == 0:
            if bends_too_much(I, M, node, max(jumps[node - 1], jumps[node])):
                if I[I_NODES] < I[I_CAPACITY]:
                    if not change:
                        return True
                    changed = split_edge(I, M, node, 0.5, False) == OK or changed
            elif (
                # Nodes after this one may have been split; those before it are as measured.
                node > first
                and I[I[O_JOINT] + node - 1] == 0
                and not bends_too_much(I, M, node - 1, max(jumps[node - 2], jumps[node - 1]))
                and may_unite(I, M, node - 1, jumps[node - 1])
            ):
                if not change:
                    return True
                join_at(I, M, node - 1, 1)
                changed = True
                node -= 1
        node -= 1
    if first == 2:
        wish = top_wish(I, M)
        if wish == HALVE:
            changed = split_edge(I, M, 1, 0.5, False) == OK or changed
        elif wish == UNITE:
            join_at(I, M, 1, 1)
            changed = True
    return changed
