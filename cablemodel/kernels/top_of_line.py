"""What passes the tow point: the top element is split or joined, joints and bodies come and go.

A joint, with a point body or none, leaves the drum when a hundredth of an element of the cable
above it is out, and is taken back when half of that is left. A body of finite length takes the
place of the top element's end when a twentieth of it is out, then passes (passing.py); the cable
above it comes when the body is out, and goes before it is taken in.
"""

import math

from .access import body_at, body_of, cable_at, cable_of, edge_at, edge_of, header, scalars, word_of
from .compile import kernel
from .follow import jump_at
from .layout import (
    BODY_WORDS,
    CABLE_WORDS,
    EDGE_WORDS,
    JOINT_BODY,
    NO_CAPACITY,
    OK,
)
from .passing import axis_motion, bare_length, body_above
from .payout import (
    close_gap,
    give_properties,
    hermite,
    join_at,
    open_gap,
    split_edge,
    turn_with_matter,
)
from .vessel_clamp import update_springs

FEWEST_ELEMENTS = 4
SPLIT, JOIN = 2.0, 0.5  # of the nominal length of the top element
LARGEST_SHARE = 0.6  # of the line: a longer top element of few is halved, none becomes longer
UNEVEN = 0.25  # of the next element: the top one of the fewest is joined with it below that
SLIGHT = 0.15  # the same for one that bends with it
NEARLY = 1e-6  # how close to a mark the winch's way must end
# What the top of the line asks for.
LEAVES, RETURNS, DIVIDES, UNITES = 1, 2, 3, 4
COMES, FOLLOWS = 5, 6  # a body, and the cable after it, on the way out
STOPS, ENTERS = 7, 8  # the cable before a body, and the body, on the way in


@kernel
def element_number(I, M):
    """Elements of the line."""
    head = header(I)
    count = 0
    for node in range(1, head.nodes):
        if I[head.joint + node] == 0:
            count += 1
    return count


@kernel
def is_too_large(I, M, length, elements):
    """Whether a top element of this length is most of a line of few elements."""
    head = header(I)
    if elements > 2 * FEWEST_ELEMENTS:
        return False
    total = 0.0
    for node in range(1, head.nodes):
        total += edge_of(I, M, node).length
    return length > LARGEST_SHARE * total


@kernel
def bends_with_next(I, M):
    """Whether the top element and the next one bend more than one cubic in their place may.

    The node between would move by more than tau L, and the line's ends would be pulled after it: a
    fold that is straightened so stores energy from nowhere. Or, where the mesh follows what bends,
    what is joined would be halved at once, and what it was is lost.
    """
    state = scalars(M)
    if moved_by_joining(I, M) > state.tolerance * state.length:
        return True
    length = state.top_length + edge_of(I, M, 2).length
    return state.bent > 0.0 and length * length * jump_at(I, M, 1, False) > state.bent


@kernel
def moved_by_joining(I, M):
    """How far the first node lies from the cubic that would take its place [m].

    A bend that both elements have part of, as at a clamp that cable is drawn through, has no jump.
    """
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    first = state.top_length
    length = first + edge_of(I, M, 2).length
    size = 2 * dimension
    w = M[head.motion + 28 : head.motion + 34]
    hermite(M, head.position, head.position + 2 * size, dimension, length, first / length, w)
    square = 0.0
    for i in range(dimension):
        square += (w[i] - M[head.position + size + i]) ** 2
    return math.sqrt(square)


@kernel
def next_change(I, M):
    """What the top of the line asks for next; 0: nothing."""
    head = header(I)
    state = scalars(M)
    cable = head.top_cable
    row = cable_of(I, M, cable)
    if cable + 1 < head.cable_count:
        out = state.travel - row.leaves
        body = body_above(I, M, cable)
        of_body = body_at(M, body)
        if state.body_passage != 0.0:
            beyond = out - of_body.length
            if beyond >= (1.0 - NEARLY) * cable_of(I, M, cable + 1).shortest:
                return FOLLOWS
            if out <= 0.5 * bare_length(M, of_body, cable_of(I, M, cable + 1)):
                return ENTERS
            return 0
        if body >= 0:
            if out >= (1.0 - NEARLY) * bare_length(M, of_body, cable_of(I, M, cable + 1)):
                return COMES
        elif out >= cable_of(I, M, cable + 1).shortest and out < state.top_length:
            # A joint leaves the vessel once enough of the next cable is out.
            return LEAVES
    if cable > 0:
        # It is taken back when less than half of that is left.
        out = state.travel - cable_of(I, M, cable - 1).leaves
        body = body_above(I, M, cable - 1)
        of_body = body_at(M, body)
        if body >= 0:
            if out - of_body.length <= 0.5 * row.shortest:
                return STOPS
        elif out <= 0.5 * row.shortest:
            return RETURNS
    nominal = row.nominal
    if state.top_length > SPLIT * nominal or is_too_large(I, M, state.top_length, head.nodes - 1):
        return DIVIDES
    first = edge_of(I, M, 1)
    below = edge_of(I, M, 2)
    if head.nodes > 2 and state.top_length < JOIN * min(nominal, below.length):
        if bends_with_next(I, M) and state.top_length > SLIGHT * below.length:
            return 0
        if below.segment == first.segment and I[head.joint + 2] == 0:
            # One of few elements goes only where another one gains by being halved.
            if state.top_length < UNEVEN * below.length or (
                element_number(I, M) > FEWEST_ELEMENTS
                and not is_too_large(I, M, state.top_length + below.length, head.nodes - 2)
            ):
                return UNITES
    return 0


@kernel
def along_the_body(I, M):
    """Let the vessel node's slope point along the body that passes, and turn with it.

    Leaves axis, its rate and second rate in w[0:9], the words of `motion` from 28 on.
    """
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    count = 4 * dimension
    q = head.position
    v = head.velocity
    a = head.acceleration
    w = M[head.motion + 28 : head.motion + 37]
    axis_motion(
        I,
        M,
        M[q : q + count],
        M[v : v + count],
        M[a : a + count],
        state.top_length,
        state.payout_rate,
        state.payout_slope,
        w,
    )
    for i in range(dimension):
        M[q + dimension + i] = w[i]
        M[v + dimension + i] = w[3 + i]
        M[a + dimension + i] = w[6 + i]


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
    state = scalars(M)
    cable = head.top_cable
    out = state.travel - cable_of(I, M, cable).leaves
    if split_edge(I, M, 1, out / state.top_length, False) != OK:
        return NO_CAPACITY
    edge = edge_of(I, M, 1)
    I[head.joint + 1] = JOINT_BODY
    edge.length = 0.0
    edge.start = -state.paid
    edge_at(M, word_of(M, edge) + EDGE_WORDS).start = -state.paid
    for array in range(2):
        # The split has left the mean of the piece above: the tension at the new node.
        t = head.tension if array == 0 else head.tension_rate
        M[t + 2] += M[t + 3]
        M[t + 3] = 0.0
    row = body_at(M, body_above(I, M, cable))
    row.node = 1.0
    row.clamp_tension[0] = M[head.tension + 2]
    row.clamp_tension[1] = M[head.tension + 2]
    state.body_passage = 1.0 + (word_of(M, row) - head.bodies) // BODY_WORDS
    along_the_body(I, M)
    body_moved(I, M, row)
    update_springs(I, M, 0.0)
    return OK


@kernel
def let_cable_follow(I, M):
    """The body is out: the first bit of the next cable takes its place at the tow point."""
    head = header(I)
    state = scalars(M)
    if head.nodes + head.left_out + 1 > head.capacity:
        return NO_CAPACITY
    dimension = head.dimension
    size = 2 * dimension
    cable = head.top_cable
    row = body_at(M, body_above(I, M, cable))
    length = state.top_length - row.length
    along_the_body(I, M)
    w = M[head.motion + 28 : head.motion + 37]
    pull = M[head.tension + 2]
    rate = M[head.tension_rate + 2]
    open_gap(I, M, 1, 1)
    for k in range(EDGE_WORDS):
        M[head.edges + EDGE_WORDS + k] = 0.0
    give_properties(I, M, 1, cable + 1)
    edge_of(I, M, 1).length = length
    edge_of(I, M, 1).start = -state.paid
    edge_of(I, M, 2).start = length - state.paid
    I[head.joint + 1] = 0
    M[head.tension + 2] = pull
    M[head.tension + 3] = 0.0
    M[head.tension_rate + 2] = rate
    M[head.tension_rate + 3] = 0.0
    speed = state.payout_rate
    for i in range(dimension):
        at = size + i
        M[head.position + at] = M[head.position + i] + length * w[i]
        M[head.velocity + at] = M[head.velocity + i] + speed * w[i] + length * w[3 + i]
        M[head.acceleration + at] = M[head.acceleration + i] + state.payout_slope * w[i]
        M[head.acceleration + at] += 2.0 * speed * w[3 + i] + length * w[6 + i]
        M[head.position + at + dimension] = w[i]
        M[head.velocity + at + dimension] = w[3 + i]
        M[head.acceleration + at + dimension] = w[6 + i]
    for i in range(3):
        M[head.rest + 3 + i] = M[head.rest + i]
    state.top_length = length
    body_moved(I, M, row)
    state.body_passage = 0.0
    head.top_cable = cable + 1
    row.clamp_tension[0] = pull
    update_springs(I, M, 0.0)
    return OK


@kernel
def let_body_stop(I, M):
    """The cable above a body is taken in: the body's inner end comes to the tow point."""
    head = header(I)
    state = scalars(M)
    while I[head.joint + 2] == 0:
        join_at(I, M, 1, 1)
    cable = head.top_cable - 1
    row = body_at(M, body_above(I, M, cable))
    close_gap(I, M, 1, 1)
    body_moved(I, M, row)
    state.top_length = state.travel - cable_of(I, M, cable).leaves
    state.body_passage = 1.0 + (word_of(M, row) - head.bodies) // BODY_WORDS
    head.top_cable = cable
    along_the_body(I, M)
    update_springs(I, M, 0.0)


@kernel
def let_body_enter(I, M):
    """The last bit of a body that is taken in becomes a piece of the top element."""
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    size = 2 * dimension
    cable = head.top_cable
    row = body_at(M, body_above(I, M, cable))
    row.node = -1.0
    state.body_passage = 0.0
    w = M[head.motion + 28 : head.motion + 37]
    for i in range(dimension):
        w[i] = M[head.position + size + dimension + i]
        w[3 + i] = M[head.velocity + size + dimension + i]
        w[6 + i] = M[head.acceleration + size + dimension + i]
    close_gap(I, M, 1, 1)
    state.top_length += edge_of(I, M, 1).length
    edge_of(I, M, 1).length = state.top_length
    state.joined = max(state.joined, state.top_length)
    for i in range(dimension):
        M[head.position + dimension + i] = w[i]
    turn_with_matter(I, M, w[3 : 3 + dimension], w[6 : 6 + dimension])


@kernel
def keep_length(I, M, edge):
    """An element that the winch has made stays as long as it is: only its halves are joined."""
    state = scalars(M)
    if state.bent > 0.0:
        row = edge_of(I, M, edge)
        row.nominal = row.length


@kernel
def unite(I, M):
    """Join the top element with the next one; of the fewest, halve the longest instead."""
    head = header(I)
    state = scalars(M)
    join_at(I, M, 1, 1)
    edge_of(I, M, 1).length = state.top_length
    if element_number(I, M) >= FEWEST_ELEMENTS:
        return OK
    longest = 1
    for node in range(1, head.nodes):
        if edge_of(I, M, node).length > edge_of(I, M, longest).length:
            longest = node
    status = split_edge(I, M, longest, 0.5, False)
    if status == OK:
        keep_length(I, M, longest)
        keep_length(I, M, longest + 1)
    return status


@kernel
def adapt_top(I, M):
    """Before a step: let joints and bodies pass the tow point, split or join the top element."""
    head = header(I)
    state = scalars(M)
    for _pass in range(64):
        change = next_change(I, M)
        if change == 0:
            break
        cable = head.top_cable
        row = cable_of(I, M, cable)
        status = OK
        if change == LEAVES:
            above = cable_at(M, word_of(M, row) + CABLE_WORDS)
            out = state.travel - row.leaves
            hinge = above.hinge != 0.0
            status = split_edge(I, M, 1, out / state.top_length, hinge)
            if status == OK:
                give_properties(I, M, 1, cable + 1)
                if above.body >= 0.0:
                    body_of(I, M, int(above.body)).node = 1.0
                head.top_cable = cable + 1
        elif change == RETURNS:
            if row.body >= 0.0:
                body_of(I, M, int(row.body)).node = -1.0
            # All of the upper cable's elements go.
            while I[head.joint + 2] == 0 and (edge_of(I, M, 2).segment == edge_of(I, M, 1).segment):
                join_at(I, M, 1, 1)
            join_at(I, M, 1, 2 if row.hinge != 0.0 else 1)
            give_properties(I, M, 1, cable - 1)
            edge_of(I, M, 1).length = state.top_length
            head.top_cable = cable - 1
        elif change == COMES:
            status = let_body_come(I, M)
        elif change == FOLLOWS:
            status = let_cable_follow(I, M)
        elif change == STOPS:
            let_body_stop(I, M)
        elif change == ENTERS:
            let_body_enter(I, M)
        elif change == DIVIDES:
            pieces = max(2, int(state.top_length / row.nominal))
            status = split_edge(I, M, 1, 1.0 - 1.0 / pieces, False)
            if status == OK:
                keep_length(I, M, 2)
        else:
            few = element_number(I, M) <= FEWEST_ELEMENTS
            status = unite(I, M)
            if few:
                break
        if status != OK:
            return NO_CAPACITY
    return OK
