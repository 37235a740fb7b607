"""Lines of a system are cut, let go or break: at a time, by command, above a tension.

Nothing of the state changes but what is tied to what: places, velocities and tensions stay, and
with them momentum and energy. What has been cut off begins a tree of its own at a new node; the
wave of what it was pulled with runs from there.
"""

import math

from cablemodel.solvers.finite_element.kernels.bodies.body_clamps import open_clamp
from cablemodel.solvers.finite_element.kernels.element.damping import damping_in
from cablemodel.solvers.finite_element.kernels.element.scales import LET_GO
from cablemodel.solvers.finite_element.kernels.line.closures import open_closure
from cablemodel.solvers.finite_element.kernels.mesh.payout import open_gap, split_edge, top_edge
from cablemodel.solvers.finite_element.kernels.mesh.top_element import next_along
from cablemodel.solvers.finite_element.kernels.mesh.winch import is_due
from cablemodel.solvers.finite_element.kernels.time.consistency import begin_after_a_velocity_jump
from cablemodel.solvers.finite_element.kernels.time.slack import forget_threshold
from cablemodel.solvers.shared.access import (
    arm_of,
    cable_of,
    constraint_at,
    constraint_of,
    cut_of,
    edge_of,
    header,
    scalars,
    tension_at,
    winch_of,
)
from cablemodel.solvers.shared.compile import kernel
from cablemodel.solvers.shared.layout import (
    CONSTRAINT_WORDS,
    CUT_END,
    CUT_START,
    EDGE_WORDS,
    JOINT_ARM,
    JOINT_FREE,
    JOINT_HINGE,
    JOINT_ROOT,
    JOINT_ROOT_FREE,
    NO_CAPACITY,
    NODES_OF_A_CUT,
    OK,
    TENSION_WORDS,
    WHOLLY,
)
from cablemodel.solvers.shared.numbers import FINEST_TOLERANCE

AT_A_NODE = 1e-6  # of an element: a place so near its end is there
BREAK_EARLIEST, BREAK_LATEST = 0.1, 0.9  # of a step that is too long: where a break is looked for


@kernel
def element_of_cut(I, M, row):
    """The node of the element that a cut is in, and the fraction of it from its parent's end; 0:
    its place is on a drum."""
    head = header(I)
    chain = cable_of(I, M, int(row.segment)).chain
    side = int(row.side)
    found = 0
    best = 0.0
    for node in range(1, head.nodes):
        edge = edge_of(I, M, node)
        if I[head.joint + node] != 0 or cable_of(I, M, int(edge.segment)).chain != chain:
            continue
        start = edge.start
        if side == CUT_START:
            if found == 0 or start < best:
                found, best = node, start
        elif side == CUT_END:
            if found == 0 or start > best:
                found, best = node, start
        elif start <= row.arc and (found == 0 or start > best):
            found, best = node, start
    if side == CUT_START:
        return found, 0.0
    if side == CUT_END:
        return found, 1.0
    if found == 0:
        return 0, 0.0
    x = (row.arc - best) / edge_of(I, M, found).length
    return found if x < 1.0 + AT_A_NODE else 0, min(1.0, x)


@kernel
def let_go_step(M):
    """A step in which what is let go hardly moves [s]: when a line breaks is known to it."""
    state = scalars(M)
    return LET_GO * math.sqrt(max(state.tolerance, FINEST_TOLERANCE)) * state.period


@kernel
def tension_there(M, tension, node, x):
    """Tension at a fraction of an element [N]; tension: word of an array of them."""
    there = tension_at(M, tension + TENSION_WORDS * node)
    return there.mean + (2.0 * x - 1.0) * there.slope


@kernel
def damping_there(I, M, node, x):
    """What the material's damping adds to that at the state [N]."""
    d0, d1, _lost = damping_in(I, M, node)
    return d0 + (2.0 * x - 1.0) * d1


@kernel
def share_before_a_break(I, M):
    """The part of the trial step after which a tension reaches where its line breaks; 1: none does,
    or by no more than tau of it."""
    head = header(I)
    state = scalars(M)
    share = 1.0
    for n in range(head.cut_count):
        row = cut_of(I, M, n)
        if row.done < 1e300 or not row.tension < 1e300:
            continue
        node, x = element_of_cut(I, M, row)
        if node == 0:
            continue
        limit = row.tension - damping_there(I, M, node, x)
        before = tension_there(M, head.tension, node, x)
        after = tension_there(M, head.trial_tension, node, x)
        if before < limit and after > limit * (1.0 + state.tolerance):
            aim = limit * (1.0 + 0.5 * state.tolerance)
            share = min(
                share, max(BREAK_EARLIEST, min(BREAK_LATEST, (aim - before) / (after - before)))
            )
    return share


@kernel
def new_node(I, M, like, node):
    """Put a node at a number, alone, at the place and with the motion of another one before it."""
    head = header(I)
    size = 2 * head.dimension
    open_gap(I, M, node, 1)
    for k in range(size):
        M[head.position + size * node + k] = M[head.position + size * like + k]
        M[head.velocity + size * node + k] = M[head.velocity + size * like + k]
        M[head.acceleration + size * node + k] = M[head.acceleration + size * like + k]
        M[head.rest + size * node + k] = M[head.rest + size * like + k]
    for k in range(TENSION_WORDS):
        M[head.tension + TENSION_WORDS * node + k] = 0.0
        M[head.tension_rate + TENSION_WORDS * node + k] = 0.0
    for k in range(EDGE_WORDS):
        M[head.edges + EDGE_WORDS * node + k] = 0.0
    I[head.joint + node] = JOINT_ROOT


@kernel
def constraint_row_at(I, M, node):
    """Row of the constraint that holds a node; -1: none does."""
    head = header(I)
    for n in range(head.constraint_count):
        row = head.constraints + n * CONSTRAINT_WORDS
        constraint = constraint_at(M, row)
        if constraint.node == node:
            return row
    return -1


@kernel
def let_go_of_winch(I, M, node):
    """The winch at a node has no line any more."""
    for n in range(header(I).winch_count):
        winch = winch_of(I, M, n)
        if winch.node == node:
            winch.node = -1.0
            winch.rate = 0.0
            winch.slope = 0.0


@kernel
def shorten_lines(I, M):
    """After a cut a winch takes in no more of its cables than is left of them."""
    head = header(I)
    for n in range(head.winch_count):
        winch = winch_of(I, M, n)
        if winch.node < 0.0:
            continue
        edge = top_edge(winch)
        chain = cable_of(I, M, int(winch.cable)).chain
        left = winch.top_length
        while True:
            edge = next_along(I, winch, edge)
            if edge == 0:
                break
            row = edge_of(I, M, edge)
            if I[head.joint + edge] == 0 and cable_of(I, M, int(row.segment)).chain != chain:
                break
            left += row.length
        left -= winch.shortest
        winch.travel_least = max(winch.travel_least, winch.travel - max(0.0, left))


@kernel
def part_above(I, M, edge):
    """Cut an element off from its parent's end."""
    head = header(I)
    parent = I[head.parent + edge]
    joint = I[head.joint + parent]
    if joint == JOINT_HINGE:
        I[head.joint + parent] = JOINT_ROOT
        return
    if joint == JOINT_ARM:
        I[head.joint + parent] = JOINT_ROOT
        for n in range(head.arm_count):
            arm = arm_of(I, M, n)
            if arm.node == parent:
                arm.body = -1.0
        open_clamp(I, M, parent)
        return
    if joint == JOINT_ROOT and constraint_row_at(I, M, parent) < 0:
        return  # it was cut off there before
    new_node(I, M, parent, edge)
    let_go_of_winch(I, M, parent)
    row = constraint_row_at(I, M, parent)
    constraint = constraint_at(M, row)
    if row >= 0:
        constraint.clamped = WHOLLY


@kernel
def part_below(I, M, node):
    """Cut a line off from what it comes to at its last node."""
    head = header(I)
    if open_closure(I, M, node):
        return
    row = constraint_row_at(I, M, node)
    constraint = constraint_at(M, row)
    if row >= 0:
        new_node(I, M, node, node + 1)
        let_go_of_winch(I, M, node)
        constraint.node = node + 1
        constraint.clamped = WHOLLY
        return
    first = 0
    for child in range(node + 1, head.nodes):
        if I[head.parent + child] != node or I[head.joint + child] >= JOINT_ROOT:
            continue
        if I[head.joint + child] == JOINT_FREE:
            I[head.joint + child] = JOINT_ROOT_FREE
        elif first == 0:
            I[head.joint + child] = JOINT_ROOT  # of what it was a branch
            first = child
        else:
            I[head.parent + child] = first


@kernel
def cut(I, M, row):
    """Make a cut. The block has room for NODES_OF_A_CUT."""
    head = header(I)
    state = scalars(M)
    edge, x = element_of_cut(I, M, row)
    side = int(row.side)
    if side == CUT_END:
        part_below(I, M, edge)
    elif x < AT_A_NODE:
        part_above(I, M, edge)
    else:
        if x < 1.0 - AT_A_NODE:
            split_edge(I, M, edge, x, False)
        # What comes after the node begins anew: a hinge there, or the next element.
        if I[head.joint + edge + 1] == JOINT_HINGE:
            I[head.joint + edge + 1] = JOINT_ROOT
        else:
            part_above(I, M, edge + 1)
    row.done = state.time


@kernel
def end_rings(I, M):
    """What rings is known no more: it hangs on something else."""
    head = header(I)
    for n in range(head.constraint_count):
        constraint_of(I, M, n).ring = 0.0
        constraint_of(I, M, n).wave = 0.0
    head.rings = 0
    head.axial_waves = 0


@kernel
def make_cuts(I, M):
    """Make all cuts that are due at the state: a status."""
    head = header(I)
    state = scalars(M)
    due = False
    for n in range(head.cut_count):
        row = cut_of(I, M, n)
        over = is_due(M, row)
        if row.done < 1e300 or not (over or row.tension < 1e300):
            continue
        node, x = element_of_cut(I, M, row)
        if node == 0:
            continue  # what is cut on a drum parts where it leaves it
        if not over:
            carries = tension_there(M, head.tension, node, x) + damping_there(I, M, node, x)
            over = carries >= row.tension
        if not over:
            continue
        if head.nodes + NODES_OF_A_CUT > head.capacity:
            return NO_CAPACITY
        cut(I, M, row)
        forget_threshold(I, M, int(row.segment))
        due = True
    if due:
        end_rings(I, M)
        shorten_lines(I, M)
        head.factored = 0
        head.has_history = 0
        head.settled = 0
        step = let_go_step(M)
        begin_after_a_velocity_jump(I, M, step)
        state.step = min(state.step, step)
        state.last_step = 0.0
    return OK
