"""The state with which a run begins, and what the way to that begins with."""

import math

from cablemodel.solvers.finite_element.kernels.element.scales import line_length
from cablemodel.solvers.finite_element.kernels.element.strain import promised_tension
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import near_floor
from cablemodel.solvers.finite_element.kernels.line.system import impose_motion, set_time
from cablemodel.solvers.finite_element.kernels.mesh.bending_mesh import measure_bends
from cablemodel.solvers.shared.access import (
    cable_of,
    constraint_of,
    edge_of,
    header,
    scalars,
    spare_row,
    tension_of,
    winch_of,
)
from cablemodel.solvers.shared.compile import copy_words, kernel, outlined, view
from cablemodel.solvers.shared.layout import FLOOR_TOUCHED, JOINT_NONE, JOINT_ROOT, BeginRows

ROW_BENT, ROW_ACCELERATIONS = BeginRows.bent.word, BeginRows.accelerations.word


@kernel
def place_supports(I, M):
    """Write the prescribed motion at the present time into the state."""
    head = header(I)
    state = scalars(M)
    count = 2 * head.dimension * head.nodes
    set_time(I, M, state.time)
    impose_motion(
        I,
        M,
        state.time,
        view(M, head.position, count),
        view(M, head.velocity, count),
        view(M, head.acceleration, count),
    )


@outlined
def hold_supports(I, M):
    """The same of a shape at rest, but for accelerations: they begin after t = 0. With them the
    force at a top would hold the inertia of a piece as long as the mesh makes it."""
    head = header(I)
    count = 2 * head.dimension * head.nodes
    kept = spare_row(I, ROW_ACCELERATIONS)
    copy_words(I, kept, head.acceleration, count)
    place_supports(I, M)
    copy_words(I, head.acceleration, kept, count)


@kernel
def rest_here(I, M):
    """Make the present places and slopes those of rest: no friction yet."""
    head = header(I)
    copy_words(I, head.rest, head.position, 2 * head.dimension * head.nodes)


@kernel
def count_from_zero(I):
    """Counters, factorisation and history begin with a run."""
    head = header(I)
    head.steps = 0
    head.rejected = 0
    head.factorisations = 0
    head.iterations = 0
    head.factored = 0
    head.has_history = 0


@kernel
def restore_bending(I, M):
    """Every element as stiff in bending as it may be: it is chosen anew."""
    for node in range(1, header(I).nodes):
        edge = edge_of(I, M, node)
        edge.bending = edge.bending_full


@kernel
def start_flow(I, M):
    """Material velocity of a line alone that a winch pays out from the start on: with the vessel,
    along itself.

    A cable at rest would answer with an axial shock of EA rate / c. Where it is laid at the rate of
    the vessel's speed, what lies on the floor is at rest.
    """
    head = header(I)
    if head.parts != 0 or head.payout == 0:
        return
    rate = winch_of(I, M, 0).rate
    if rate == 0.0:
        return
    dimension = head.dimension
    size = 2 * dimension
    for node in range(1, head.nodes):
        q = head.position + size * node
        v = head.velocity + size * node
        for i in range(dimension):
            M[v + i] = M[head.velocity + i] + rate * M[q + dimension + i]


@kernel
def stop_flow(I, M, frame):
    """A line alone as it stands in its shape, where a winch pays out: the drag's derivatives are
    then those of a shape that turns, along which the flow turns with it. frame: the velocity in
    which that is at rest, (dimension,) [m/s]; what has been laid does not move."""
    head = header(I)
    if head.parts != 0 or head.payout == 0 or winch_of(I, M, 0).rate == 0.0:
        return
    dimension = head.dimension
    size = 2 * dimension
    for node in range(head.nodes):
        start = head.velocity + size * node
        moves = False
        for i in range(dimension):
            moves = moves or M[start + i] != 0.0
        for i in range(size):
            M[start + i] = frame[i] if moves and i < dimension else 0.0
            M[head.acceleration + size * node + i] = 0.0
    winch_of(I, M, 0).rate = 0.0


@kernel
def bends(I, M, out):
    """By how much each element of a static shape bends, (nodes,), in tau times its line's length:
    bending_mesh.measure_bends."""
    head = header(I)
    measure_bends(I, M, out)
    for node in range(1, head.nodes):
        if out[node] != 0.0:
            out[node] /= scalars(M).tolerance * line_length(I, M, edge_of(I, M, node))


@kernel
def worst_of_shape(I, M, out):
    """The most of that; the largest strain of an element, by the chord between its nodes; and the
    lowest tension where it presses by more than tensions may be wrong by, else 0 [N]."""
    head = header(I)
    size = 2 * head.dimension
    bent = view(M, spare_row(I, ROW_BENT), head.nodes)
    bends(I, M, bent)
    for n in range(3):
        out[n] = 0.0
    for node in range(1, head.nodes):
        out[0] = max(out[0], bent[node])
        out[2] = min(out[2], tension_of(I, M, node).mean)
        if I[head.joint + node] != JOINT_NONE:
            continue
        square = 0.0
        for i in range(head.dimension):
            here = M[head.position + size * node + i]
            square += (here - M[head.position + size * I[head.parent + node] + i]) ** 2
        out[1] = max(out[1], math.sqrt(square) / edge_of(I, M, node).length - 1.0)
    if not out[2] < -promised_tension(M):
        out[2] = 0.0


@kernel
def start_paying_out(I, M, number):
    """Velocities of what hangs on a winch of a system that runs from t = 0 on: cable along itself,
    and what is tied to it as it does there. At rest it would answer with a shock of EA rate / c.

    Nothing else holds it: its tree begins at the winch. Returns the node behind its last one.
    """
    head = header(I)
    winch = winch_of(I, M, number)
    top = int(winch.node)
    line = cable_of(I, M, int(winch.cable)).row
    node = top + 1
    while node < head.nodes and I[head.joint + node] < JOINT_ROOT:
        runs = I[head.joint + node] == JOINT_NONE
        if runs:
            runs = cable_of(I, M, int(edge_of(I, M, node).segment)).row == line
        source = top if runs else I[head.parent + node]
        for i in range(3):
            velocity = M[head.velocity + 6 * source + i]
            if runs:
                velocity += winch.rate * M[head.position + 6 * node + 3 + i]
            M[head.velocity + 6 * node + i] = velocity
        node += 1
    return node


@kernel
def start_flowing(I, M):
    """Velocities of what hangs on winches of a system that run from t = 0 on. Returns the first
    node of that which touches the floor, where it would not move along, or -1."""
    head = header(I)
    places = view(M, head.position, 6 * head.nodes)
    for number in range(head.winch_count):
        winch = winch_of(I, M, number)
        if winch.rate == 0.0:
            continue
        end = start_paying_out(I, M, number)
        if head.floor_state == FLOOR_TOUCHED:
            for node in range(int(winch.node), end):
                if near_floor(I, M, node, places):
                    return node
    return -1


@kernel
def held_line(I, M, node):
    """Number of the line at whose end a node is that is held, or -1."""
    head = header(I)
    if head.parts == 0:
        return 0
    if node == 0 or I[head.joint + node] != JOINT_NONE:
        node += 1
    if node >= head.nodes or I[head.joint + node] != JOINT_NONE:
        return -1
    return int(cable_of(I, M, int(edge_of(I, M, node).segment)).row)


@kernel
def ends_apart(I, M, out):
    """How far apart the ends of each line are that are both held, (lines,) [m]; 0: they are not."""
    head = header(I)
    size = 2 * head.dimension
    for line in range(head.line_count):
        out[line] = 0.0
    for n in range(1, head.constraint_count):
        node = int(constraint_of(I, M, n).node)
        line = held_line(I, M, node)
        for other in range(n):
            to = int(constraint_of(I, M, other).node)
            if line < 0 or held_line(I, M, to) != line:
                continue
            square = 0.0
            for i in range(head.dimension):
                square += (
                    M[head.position + size * node + i] - M[head.position + size * to + i]
                ) ** 2
            out[line] = max(out[line], math.sqrt(square))
