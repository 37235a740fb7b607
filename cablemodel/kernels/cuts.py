"""Lines of a system are cut, let go or break: at a time, by command, above a tension.

Nothing of the state changes but what is tied to what: places, velocities and tensions stay, and
with them momentum and energy. What has been cut off begins a tree of its own at a new node; the
wave of what it was pulled with runs from there.
"""

import math

from .compile import kernel
from .consistency import begin_after_a_blow
from .layout import (
    A_BODY,
    A_NODE,
    ALONE,
    ARM_WORDS,
    C_CLAMPED,
    C_NODE,
    CONSTRAINT_WORDS,
    CUT_ARC,
    CUT_DONE,
    CUT_END,
    CUT_ORDERED,
    CUT_SEGMENT,
    CUT_SIDE,
    CUT_START,
    CUT_TENSION,
    CUT_TIME,
    CUT_WORDS,
    E_LENGTH,
    E_SEGMENT,
    E_START,
    EDGE_WORDS,
    I_ARMS,
    I_CAPACITY,
    I_CONSTRAINTS,
    I_CUTS,
    I_DIMENSION,
    I_FACTORED,
    I_HISTORY,
    I_NODES,
    I_SETTLED,
    JOINT_ARM,
    JOINT_FREE,
    JOINT_HINGE,
    JOINT_ROOT,
    JOINT_ROOT_FREE,
    NO_CAPACITY,
    NODES_OF_A_CUT,
    O_ACCELERATION,
    O_ARMS,
    O_CONSTRAINT,
    O_CUTS,
    O_EDGE,
    O_JOINT,
    O_PARENT,
    O_POSITION,
    O_REST,
    O_TENSION,
    O_TENSION_RATE,
    O_TRIAL_T,
    O_VELOCITY,
    OK,
    S_LAST_STEP,
    S_PERIOD,
    S_STEP,
    S_TIME,
    S_TOLERANCE,
)
from .payout import open_gap, split_edge
from .scales import LET_GO

AT_A_NODE = 1e-6  # of an element: a place so near its end is there


@kernel
def edge_of(I, M, row):
    """The node of the element that a cut is in, and the fraction of it from its parent's end."""
    segment = M[row + CUT_SEGMENT]
    side = int(M[row + CUT_SIDE])
    found = 0
    best = 0.0
    for node in range(1, I[I_NODES]):
        edge = I[O_EDGE] + node * EDGE_WORDS
        if I[I[O_JOINT] + node] != 0 or M[edge + E_SEGMENT] != segment:
            continue
        start = M[edge + E_START]
        if side == CUT_START:
            if found == 0 or start < best:
                found, best = node, start
        elif side == CUT_END:
            if found == 0 or start > best:
                found, best = node, start
        elif start <= M[row + CUT_ARC] and (found == 0 or start > best):
            found, best = node, start
    if side == CUT_START:
        return found, 0.0
    if side == CUT_END:
        return found, 1.0
    x = (M[row + CUT_ARC] - best) / M[I[O_EDGE] + found * EDGE_WORDS + E_LENGTH]
    return found, min(1.0, max(0.0, x))


@kernel
def let_go_step(M):
    """A step in which what is let go hardly moves [s]: when a line breaks is known to it."""
    return LET_GO * math.sqrt(max(M[S_TOLERANCE], 1e-12)) * M[S_PERIOD]


@kernel
def tension_there(M, tension, node, x):
    """Tension at a fraction of an element [N]; tension: word of an array of them."""
    return M[tension + 2 * node] + (2.0 * x - 1.0) * M[tension + 2 * node + 1]


@kernel
def share_before_a_break(I, M):
    """The part of the trial step after which a tension reaches where its line breaks; 1: none does,
    or by no more than tau of it."""
    share = 1.0
    for n in range(I[I_CUTS]):
        row = I[O_CUTS] + n * CUT_WORDS
        limit = M[row + CUT_TENSION]
        if M[row + CUT_DONE] < 1e300 or not limit < 1e300:
            continue
        node, x = edge_of(I, M, row)
        before = tension_there(M, I[O_TENSION], node, x)
        after = tension_there(M, I[O_TRIAL_T], node, x)
        if before < limit and after > limit * (1.0 + M[S_TOLERANCE]):
            aim = limit * (1.0 + 0.5 * M[S_TOLERANCE])
            share = min(share, max(0.1, min(0.9, (aim - before) / (after - before))))
    return share


@kernel
def new_node(I, M, like, node):
    """Put a node at a number, alone, at the place and with the motion of another one before it."""
    size = 2 * I[I_DIMENSION]
    open_gap(I, M, node, 1)
    for k in range(size):
        M[I[O_POSITION] + size * node + k] = M[I[O_POSITION] + size * like + k]
        M[I[O_VELOCITY] + size * node + k] = M[I[O_VELOCITY] + size * like + k]
        M[I[O_ACCELERATION] + size * node + k] = M[I[O_ACCELERATION] + size * like + k]
    for k in range(3):
        M[I[O_REST] + 3 * node + k] = M[I[O_REST] + 3 * like + k]
    for k in range(2):
        M[I[O_TENSION] + 2 * node + k] = 0.0
        M[I[O_TENSION_RATE] + 2 * node + k] = 0.0
    for k in range(EDGE_WORDS):
        M[I[O_EDGE] + EDGE_WORDS * node + k] = 0.0
    I[I[O_JOINT] + node] = JOINT_ROOT


@kernel
def constraint_at(I, M, node):
    """Row of the constraint that holds a node; -1: none does."""
    for n in range(I[I_CONSTRAINTS]):
        row = I[O_CONSTRAINT] + n * CONSTRAINT_WORDS
        if M[row + C_NODE] == node:
            return row
    return -1


@kernel
def part_above(I, M, edge):
    """Cut an element off from its parent's end."""
    parent = I[I[O_PARENT] + edge]
    joint = I[I[O_JOINT] + parent]
    if joint == JOINT_HINGE:
        I[I[O_JOINT] + parent] = JOINT_ROOT
        return
    if joint == JOINT_ARM:
        I[I[O_JOINT] + parent] = JOINT_ROOT
        for n in range(I[I_ARMS]):
            arm = I[O_ARMS] + n * ARM_WORDS
            if M[arm + A_NODE] == parent:
                M[arm + A_BODY] = -1.0
        return
    if joint == JOINT_ROOT and constraint_at(I, M, parent) < 0:
        return  # it was cut off there before
    new_node(I, M, parent, edge)
    row = constraint_at(I, M, parent)
    if row >= 0:
        M[row + C_CLAMPED] = ALONE


@kernel
def part_below(I, M, node):
    """Cut a line off from what it comes to at its last node."""
    row = constraint_at(I, M, node)
    if row >= 0:
        new_node(I, M, node, node + 1)
        M[row + C_NODE] = node + 1
        M[row + C_CLAMPED] = ALONE
        return
    first = 0
    for child in range(node + 1, I[I_NODES]):
        if I[I[O_PARENT] + child] != node or I[I[O_JOINT] + child] >= JOINT_ROOT:
            continue
        if I[I[O_JOINT] + child] == JOINT_FREE:
            I[I[O_JOINT] + child] = JOINT_ROOT_FREE
        elif first == 0:
            I[I[O_JOINT] + child] = JOINT_ROOT  # of what it was a branch
            first = child
        else:
            I[I[O_PARENT] + child] = first


@kernel
def cut(I, M, row):
    """Make a cut. The block has room for NODES_OF_A_CUT."""
    edge, x = edge_of(I, M, row)
    side = int(M[row + CUT_SIDE])
    if side == CUT_END:
        part_below(I, M, edge)
    elif x < AT_A_NODE:
        part_above(I, M, edge)
    else:
        if x < 1.0 - AT_A_NODE:
            split_edge(I, M, edge, x, False)
        # What comes after the node begins anew: a hinge there, or the next element.
        if I[I[O_JOINT] + edge + 1] == JOINT_HINGE:
            I[I[O_JOINT] + edge + 1] = JOINT_ROOT
        else:
            part_above(I, M, edge + 1)
    M[row + CUT_DONE] = M[S_TIME]


@kernel
def make_cuts(I, M):
    """Make all cuts that are due at the state: a status."""
    due = False
    for n in range(I[I_CUTS]):
        row = I[O_CUTS] + n * CUT_WORDS
        if M[row + CUT_DONE] < 1e300:
            continue
        over = M[row + CUT_ORDERED] != 0.0 or M[row + CUT_TIME] <= M[S_TIME]
        if not over and M[row + CUT_TENSION] < 1e300:
            node, x = edge_of(I, M, row)
            over = tension_there(M, I[O_TENSION], node, x) >= M[row + CUT_TENSION]
        if not over:
            continue
        if I[I_NODES] + NODES_OF_A_CUT > I[I_CAPACITY]:
            return NO_CAPACITY
        cut(I, M, row)
        due = True
    if due:
        I[I_FACTORED] = 0
        I[I_HISTORY] = 0
        I[I_SETTLED] = 0
        step = let_go_step(M)
        begin_after_a_blow(I, M, step)
        M[S_STEP] = min(M[S_STEP], step)
        M[S_LAST_STEP] = 0.0
    return OK
