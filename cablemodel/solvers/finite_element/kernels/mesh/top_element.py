"""What passes the tow point: the top element is split or joined, joints and bodies come and go.

A joint, with a point body or none, leaves the drum when a hundredth of an element of the cable
above it is out, and is taken back when half of that is left. A body of finite length takes the
place of the top element's end when a twentieth of it is out, then passes (body_passage.py); the
cable above it comes when the body is out, and goes before it is taken in.
"""

import math

from cablemodel.solvers.finite_element.kernels.bodies.vessel_clamp import update_springs
from cablemodel.solvers.finite_element.kernels.mesh.body_passage import (
    axis_motion,
    bare_length,
    body_above,
    new_axis,
)
from cablemodel.solvers.finite_element.kernels.mesh.payout import (
    close_gap,
    give_properties,
    hermite,
    join_at,
    joint_to,
    next_cable,
    open_gap,
    out_of_joint,
    split_edge,
    split_element,
    top_edge,
    turn_with_matter,
)
from cablemodel.solvers.finite_element.kernels.mesh.touchdown_mesh import (
    bend_allowed,
    jump_at,
    position_accuracy,
)
from cablemodel.solvers.shared.access import (
    body_at,
    body_of,
    cable_of,
    edge_at,
    edge_of,
    header,
    scalars,
    tension_of,
    tension_rate_of,
    vector,
    winch_of,
    word_of,
)
from cablemodel.solvers.shared.compile import inlined, kernel
from cablemodel.solvers.shared.layout import (
    ALONG_THE_LINE,
    BODY_WORDS,
    EDGE_WORDS,
    JOINT_ARM,
    JOINT_BODY,
    NO_CAPACITY,
    OFF_THE_DRUM,
    OK,
)

FEWEST_ELEMENTS = 4
TOP_SPLIT, TOP_JOINED = 2.0, 0.5  # of the nominal length of the top element
LARGEST_SHARE = 0.6  # of the line: a longer top element of few is halved, none becomes longer
TOP_UNEVEN = 0.25  # of the next element: the top one of the fewest is joined with it below that
SLIGHT = 0.15  # the same for one that bends with it
TOP_NEARLY = 1e-6  # how close to a mark the winch's way must end
# What the top of the line asks for.
JOINT_OUT, JOINT_IN, SPLIT_TOP, JOIN_TOP = 1, 2, 3, 4
BODY_OUT, CABLE_AFTER_BODY = 5, 6  # a body, and the cable after it, on the way out
CABLE_IN, BODY_IN = 7, 8  # the cable before a body, and the body, on the way in
MOST_CHANGES = 64  # of a top element between two steps


@kernel
def next_along(I, winch, edge):
    """The element or joint that follows on an edge as one goes away from a winch; 0: none does."""
    head = header(I)
    if winch.way > 0.0:
        child = edge + 1
        if child >= head.nodes or I[head.parent + child] != edge:
            return 0
        return child if I[head.joint + child] < JOINT_ARM else 0
    parent = edge - 1
    if parent <= 0 or I[head.parent + edge] != parent:
        return 0
    return parent if I[head.joint + parent] < JOINT_ARM else 0


@kernel
def measure_line(I, M, winch):
    """Of a winch's line: edges, those of them that are elements, length [m]."""
    head = header(I)
    edges = 0
    elements = 0
    length = 0.0
    edge = top_edge(winch)
    while edge != 0:
        edges += 1
        if I[head.joint + edge] == 0:
            elements += 1
        length += edge_of(I, M, edge).length
        edge = next_along(I, winch, edge)
    return edges, elements, length


@kernel
def is_too_large(I, M, winch, length, joined):
    """Whether a top element of this length is most of a line of few elements, of which so many
    are joined with it."""
    head = header(I)
    if head.parts == 0 and head.nodes - 1 - joined > 2 * FEWEST_ELEMENTS:
        return False
    edges, _elements, total = measure_line(I, M, winch)
    return edges - joined <= 2 * FEWEST_ELEMENTS and length > LARGEST_SHARE * total


@inlined
def middle_of(winch):
    """The node between a top element and the next one: that at the far end of the upper one of
    both along the tree."""
    edge = top_edge(winch)
    return edge if winch.way > 0.0 else edge - 1


@kernel
def bends_with_next(I, M, winch, below):
    """Whether the top element and the next one bend more than one cubic in their place may.

    The node between would move by more than tau L, and the line's ends would be pulled after it: a
    fold that is straightened so stores energy from nowhere. Or, where the mesh follows what bends,
    what is joined would be halved at once, and what it was is lost.
    """
    state = scalars(M)
    if moved_by_joining(I, M, winch, below) > position_accuracy(I, M, below):
        return True
    length = winch.top_length + edge_of(I, M, below).length
    bent = bend_allowed(I, M, below)
    return state.bent > 0.0 and length * length * jump_at(I, M, middle_of(winch), False) > bent


@kernel
def moved_by_joining(I, M, winch, below):
    """How far the node between lies from the cubic that would take its place [m].

    A bend that both elements have part of, as at a clamp that cable is drawn through, has no jump.
    """
    head = header(I)
    dimension = head.dimension
    other = edge_of(I, M, below).length
    length = winch.top_length + other
    first = winch.top_length if winch.way > 0.0 else other
    size = 2 * dimension
    middle = middle_of(winch)
    start = head.position + size * I[head.parent + middle]
    end = head.position + size * (middle + 1)
    place = vector()
    hermite(M, start, end, dimension, length, first / length, place, vector())
    square = 0.0
    for i in range(dimension):
        square += (place[i] - M[head.position + size * middle + i]) ** 2
    return math.sqrt(square)


@kernel
def next_change(I, M, n):
    """What a winch asks for next; 0: nothing."""
    winch = winch_of(I, M, n)
    if winch.node < 0.0:
        return 0
    cable = int(winch.cable)
    row = cable_of(I, M, cable)
    above = next_cable(I, M, winch, OFF_THE_DRUM)
    if above >= 0:
        out = out_of_joint(I, M, winch, above)
        body = body_above(I, M, cable)
        of_body = body_at(M, body)
        if winch.passing_body != 0.0:
            beyond = out - of_body.length
            if beyond >= (1.0 - TOP_NEARLY) * cable_of(I, M, above).shortest:
                return CABLE_AFTER_BODY
            if out <= 0.5 * bare_length(M, of_body, cable_of(I, M, above)):
                return BODY_IN
            return 0
        if body >= 0:
            if out >= (1.0 - TOP_NEARLY) * bare_length(M, of_body, cable_of(I, M, above)):
                return BODY_OUT
        elif out >= cable_of(I, M, above).shortest and out < winch.top_length:
            # A joint leaves the vessel once enough of the next cable is out.
            return JOINT_OUT
    below = next_cable(I, M, winch, ALONG_THE_LINE)
    if below >= 0:
        # It is taken back when less than half of that is left.
        out = out_of_joint(I, M, winch, below)
        body = body_above(I, M, below)
        of_body = body_at(M, body)
        if body >= 0:
            if out - of_body.length <= 0.5 * row.shortest:
                return CABLE_IN
        elif out <= 0.5 * row.shortest:
            return JOINT_IN
    length = winch.top_length
    if length > TOP_SPLIT * row.nominal or is_too_large(I, M, winch, length, 0):
        return SPLIT_TOP
    if may_unite_with_next(I, M, winch, row.nominal):
        return JOIN_TOP
    return 0


@kernel
def may_unite_with_next(I, M, winch, nominal):
    """Whether the top element and the next one may become one."""
    head = header(I)
    edge = top_edge(winch)
    below = next_along(I, winch, edge)
    if below == 0:
        return False
    length = winch.top_length
    other = edge_of(I, M, below)
    if length >= TOP_JOINED * min(nominal, other.length):
        return False
    if bends_with_next(I, M, winch, below) and length > SLIGHT * other.length:
        return False
    if other.segment != edge_of(I, M, edge).segment or I[head.joint + below] != 0:
        return False
    # One of few elements goes only where another one gains by being halved.
    if length < TOP_UNEVEN * other.length:
        return True
    _edges, elements, _length = measure_line(I, M, winch)
    return elements > FEWEST_ELEMENTS and not is_too_large(I, M, winch, length + other.length, 1)


@kernel
def anything_passes(I, M):
    """Whether any winch asks for a change."""
    for n in range(header(I).winch_count):
        if next_change(I, M, n) != 0:
            return True
    return False


@kernel
def along_the_body(I, M, axis):
    """Let the vessel node's slope point along the body that passes, and turn with it: `axis`."""
    head = header(I)
    winch = winch_of(I, M, 0)
    dimension = head.dimension
    count = 4 * dimension
    q = head.position
    v = head.velocity
    a = head.acceleration
    axis_motion(
        I,
        M,
        M[q : q + count],
        M[v : v + count],
        M[a : a + count],
        winch.top_length,
        winch.rate,
        winch.slope,
        axis,
    )
    for i in range(dimension):
        M[q + dimension + i] = axis.direction[i]
        M[v + dimension + i] = axis.turn[i]
        M[a + dimension + i] = axis.turn_rate[i]


@kernel
def body_moved(I, M, row):
    """Say that a body's place has changed: `make_consistent` must not resolve its axial motion.

    A body weighs as much as a piece of cable that axial waves take longer for.
    """
    head = header(I)
    state = scalars(M)
    node = int(row.node)
    edge = edge_of(I, M, node + 1)
    if node + 1 < head.nodes:
        reach = edge.length + row.mass / edge.mass
        state.joined = max(state.joined, reach)


@kernel
def let_body_come(I, M):
    """The first bit of a body, until now a piece of the top element, becomes the body itself."""
    head = header(I)
    winch = winch_of(I, M, 0)
    cable = int(winch.cable)
    out = winch.travel - cable_of(I, M, cable).leaves
    if split_edge(I, M, 1, out / winch.top_length, False) != OK:
        return NO_CAPACITY
    edge = edge_of(I, M, 1)
    I[head.joint + 1] = JOINT_BODY
    edge.length = 0.0
    edge.start = -winch.paid
    edge_at(M, word_of(M, edge) + EDGE_WORDS).start = -winch.paid
    for array in range(2):
        # The split has left the mean of the piece above: the tension at the new node.
        first = tension_of(I, M, 1) if array == 0 else tension_rate_of(I, M, 1)
        first.mean += first.slope
        first.slope = 0.0
    row = body_at(M, body_above(I, M, cable))
    row.node = 1.0
    row.clamp_tension[0] = tension_of(I, M, 1).mean
    row.clamp_tension[1] = tension_of(I, M, 1).mean
    winch.passing_body = 1.0 + (word_of(M, row) - head.bodies) // BODY_WORDS
    along_the_body(I, M, new_axis())
    body_moved(I, M, row)
    update_springs(I, M, 0.0)
    return OK


@kernel
def let_cable_follow(I, M):
    """The body is out: the first bit of the next cable takes its place at the tow point."""
    head = header(I)
    winch = winch_of(I, M, 0)
    if head.nodes + head.left_out + 1 > head.capacity:
        return NO_CAPACITY
    dimension = head.dimension
    size = 2 * dimension
    cable = int(winch.cable)
    row = body_at(M, body_above(I, M, cable))
    length = winch.top_length - row.length
    axis = new_axis()
    along_the_body(I, M, axis)
    tension = tension_of(I, M, 1).mean
    rate = tension_rate_of(I, M, 1).mean
    open_gap(I, M, 1, 1)
    for k in range(EDGE_WORDS):
        M[head.edges + EDGE_WORDS + k] = 0.0
    give_properties(I, M, 1, cable + 1)
    edge_of(I, M, 1).length = length
    edge_of(I, M, 1).start = -winch.paid
    edge_of(I, M, 2).start = length - winch.paid
    I[head.joint + 1] = 0
    tension_of(I, M, 1).mean = tension
    tension_of(I, M, 1).slope = 0.0
    tension_rate_of(I, M, 1).mean = rate
    tension_rate_of(I, M, 1).slope = 0.0
    speed = winch.rate
    for i in range(dimension):
        at = size + i
        direction = axis.direction[i]
        turn = axis.turn[i]
        turn_rate = axis.turn_rate[i]
        M[head.position + at] = M[head.position + i] + length * direction
        M[head.velocity + at] = M[head.velocity + i] + speed * direction + length * turn
        M[head.acceleration + at] = M[head.acceleration + i] + winch.slope * direction
        M[head.acceleration + at] += 2.0 * speed * turn + length * turn_rate
        M[head.position + at + dimension] = direction
        M[head.velocity + at + dimension] = turn
        M[head.acceleration + at + dimension] = turn_rate
    for i in range(size):
        M[head.rest + size + i] = M[head.rest + i]
    winch.top_length = length
    body_moved(I, M, row)
    winch.passing_body = 0.0
    winch.cable = cable + 1
    row.clamp_tension[0] = tension
    update_springs(I, M, 0.0)
    return OK


@kernel
def let_body_stop(I, M):
    """The cable above a body is taken in: the body's inner end comes to the tow point."""
    head = header(I)
    winch = winch_of(I, M, 0)
    while I[head.joint + 2] == 0:
        join_at(I, M, 1, 1)
    cable = int(winch.cable) - 1
    row = body_at(M, body_above(I, M, cable))
    close_gap(I, M, 1, 1)
    body_moved(I, M, row)
    winch.top_length = winch.travel - cable_of(I, M, cable).leaves
    winch.passing_body = 1.0 + (word_of(M, row) - head.bodies) // BODY_WORDS
    winch.cable = cable
    along_the_body(I, M, new_axis())
    update_springs(I, M, 0.0)


@kernel
def let_body_enter(I, M):
    """The last bit of a body that is taken in becomes a piece of the top element."""
    head = header(I)
    state = scalars(M)
    winch = winch_of(I, M, 0)
    dimension = head.dimension
    size = 2 * dimension
    cable = int(winch.cable)
    row = body_at(M, body_above(I, M, cable))
    row.node = -1.0
    winch.passing_body = 0.0
    axis = new_axis()
    for i in range(dimension):
        axis.direction[i] = M[head.position + size + dimension + i]
        axis.turn[i] = M[head.velocity + size + dimension + i]
        axis.turn_rate[i] = M[head.acceleration + size + dimension + i]
    close_gap(I, M, 1, 1)
    winch.top_length += edge_of(I, M, 1).length
    edge_of(I, M, 1).length = winch.top_length
    state.joined = max(state.joined, winch.top_length)
    for i in range(dimension):
        M[head.position + dimension + i] = axis.direction[i]
    turn_with_matter(I, M, 0, axis.turn, axis.turn_rate)


@kernel
def keep_length(I, M, edge):
    """An element that the winch has made stays as long as it is: only its halves are joined."""
    state = scalars(M)
    if state.bent > 0.0:
        row = edge_of(I, M, edge)
        row.nominal = row.length


@kernel
def unite(I, M, n):
    """Join the top element with the next one; of the fewest, halve the longest instead."""
    winch = winch_of(I, M, n)
    join_at(I, M, middle_of(winch), 1)
    edge = top_edge(winch)
    edge_of(I, M, edge).length = winch.top_length
    _edges, elements, _length = measure_line(I, M, winch)
    if elements >= FEWEST_ELEMENTS:
        return OK
    longest = edge
    while edge != 0:
        if edge_of(I, M, edge).length > edge_of(I, M, longest).length:
            longest = edge
        edge = next_along(I, winch, edge)
    status = split_element(I, M, longest, 0.5)
    if status == OK:
        keep_length(I, M, longest)
        keep_length(I, M, longest + 1)
    return status


@kernel
def divide(I, M, n):
    """Split the top element: but for what is still too long it becomes one of the others."""
    winch = winch_of(I, M, n)
    pieces = max(2, int(winch.top_length / cable_of(I, M, int(winch.cable)).nominal))
    edge = top_edge(winch)
    share = 1.0 - 1.0 / pieces if winch.way > 0.0 else 1.0 / pieces
    status = split_element(I, M, edge, share)
    if status == OK:
        keep_length(I, M, edge + 1 if winch.way > 0.0 else edge)
    return status


@kernel
def let_joint_leave(I, M, n):
    """The first bit of the next cable, until now of the top element, becomes an element, and the
    joint, with what body it has, a node or a hinge."""
    winch = winch_of(I, M, n)
    above = next_cable(I, M, winch, OFF_THE_DRUM)
    joint = joint_to(I, M, winch, above)
    out = out_of_joint(I, M, winch, above) / winch.top_length
    node = top_edge(winch)
    status = split_edge(I, M, node, out if winch.way > 0.0 else 1.0 - out, joint.hinge != 0.0)
    if status != OK:
        return status
    give_properties(I, M, top_edge(winch), above)
    if joint.body >= 0.0:
        body_of(I, M, int(joint.body)).node = node
    winch.cable = above
    return OK


@kernel
def take_joint(I, M, n):
    """What is out of the cable above a joint becomes a part of the top element of that below."""
    head = header(I)
    winch = winch_of(I, M, n)
    below = next_cable(I, M, winch, ALONG_THE_LINE)
    joint = joint_to(I, M, winch, below)
    if joint.body >= 0.0:
        body_of(I, M, int(joint.body)).node = -1.0
    segment = edge_of(I, M, top_edge(winch)).segment
    while True:
        after = next_along(I, winch, top_edge(winch))
        if I[head.joint + after] != 0 or edge_of(I, M, after).segment != segment:
            break
        join_at(I, M, middle_of(winch), 1)
    count = 2 if joint.hinge != 0.0 else 1
    edge = top_edge(winch)
    join_at(I, M, edge if winch.way > 0.0 else edge - count, count)
    give_properties(I, M, top_edge(winch), below)
    edge_of(I, M, top_edge(winch)).length = winch.top_length
    winch.cable = below


@kernel
def adapt_tops(I, M):
    """Before a step: let joints and bodies pass the winches, split or join top elements."""
    for n in range(header(I).winch_count):
        if adapt_top(I, M, n) != OK:
            return NO_CAPACITY
    return OK


@kernel
def adapt_top(I, M, n):
    """The same for one winch."""
    winch = winch_of(I, M, n)
    for _pass in range(MOST_CHANGES):
        change = next_change(I, M, n)
        if change == 0:
            break
        status = OK
        if change == JOINT_OUT:
            status = let_joint_leave(I, M, n)
        elif change == JOINT_IN:
            take_joint(I, M, n)
        elif change == BODY_OUT:
            status = let_body_come(I, M)
        elif change == CABLE_AFTER_BODY:
            status = let_cable_follow(I, M)
        elif change == CABLE_IN:
            let_body_stop(I, M)
        elif change == BODY_IN:
            let_body_enter(I, M)
        elif change == SPLIT_TOP:
            status = divide(I, M, n)
        else:
            _edges, elements, _length = measure_line(I, M, winch)
            few = elements <= FEWEST_ELEMENTS
            status = unite(I, M, n)
            if few:
                break
        if status != OK:
            return NO_CAPACITY
    return OK
