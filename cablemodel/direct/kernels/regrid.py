"""The mesh follows the cable: intervals are split and joined, joints leave the drum and return."""

from cablemodel.kernels.access import header, scalars
from cablemodel.kernels.layout import NO_CAPACITY, OK

from .compile import kernel
from .frame import to_fixed
from .geometry import last_node
from .layout import (
    B_STATE,
    B_STATE_RATE,
    BODY_STATES,
    BODY_WORDS,
    CABLE,
    D_DRUM,
    D_DRUM_USED,
    D_MEETING,
    D_RESTART,
    D_SECTION_CAPACITY,
    D_SECTIONS,
    DRUM_WORDS,
    N_BODY,
    N_COUNT,
    N_FIRST,
    N_HINGE,
    N_ITEM,
    N_KIND,
    N_MATERIAL,
    N_POINT,
    O_BODY,
    O_DRUM,
    O_FLOW,
    O_LENGTH,
    O_PLACE,
    O_RATE,
    O_SECTION,
    O_SHARE,
    O_STRAINS,
    O_Y,
    PHI,
    R_HINGE,
    R_ITEM,
    R_KIND,
    R_LEAVES,
    R_MATERIAL,
    R_POINT,
    R_RIGID,
    RATES,
    RIGID,
    SECTION_WORDS,
    SHORT_SECTION,
    THETA,
    V1,
    V2,
    V3,
    WIDTH,
    X_FLOW_END,
    X_PAID_IN_STEP,
    X_SPACING,
)

SPLIT, JOIN = 1.5, 0.5
"""Of the node spacing: an interval that grows beyond is split, one that shrinks below is joined."""
FIRST_PIECE = 0.25
"""Of the node spacing: cable that must be out before the joint below it leaves the drum."""
ROOM = 0.25
"""Of the node spacing: what a step should leave of an interval out of which cable flows."""
SHORTEST = 0.5
"""Of the node spacing: cable between the touchdown point and the joint above it."""


@kernel
def copy_node(I, M, source, target):
    """All words of a node."""
    for k in range(WIDTH):
        M[I[O_Y] + WIDTH * target + k] = M[I[O_Y] + WIDTH * source + k]
    for k in range(RATES):
        M[I[O_RATE] + RATES * target + k] = M[I[O_RATE] + RATES * source + k]
    for k in range(3):
        M[I[O_PLACE] + 3 * target + k] = M[I[O_PLACE] + 3 * source + k]
    for k in range(2):
        M[I[O_STRAINS] + 2 * target + k] = M[I[O_STRAINS] + 2 * source + k]
    M[I[O_LENGTH] + target] = M[I[O_LENGTH] + source]
    M[I[O_FLOW] + target] = M[I[O_FLOW] + source]
    M[I[O_SHARE] + target] = M[I[O_SHARE] + source]


@kernel
def shift_nodes(I, M, first, by):
    """Move the nodes from `first` on by `by` places. Returns a status."""
    head = header(I)
    last = last_node(I)
    if last + 1 + by > head.capacity:
        return NO_CAPACITY
    if by > 0:
        for node in range(last, first - 1, -1):
            copy_node(I, M, node, node + by)
    else:
        for node in range(first, last + 1):
            copy_node(I, M, node, node + by)
    for index in range(I[D_SECTIONS]):
        section = I[O_SECTION] + SECTION_WORDS * index
        if I[section + N_FIRST] >= first:
            I[section + N_FIRST] += by
    return OK


@kernel
def blend(I, M, section, left, x, target):
    """The state at a fraction x of the interval that begins at node `left`, into `target`.

    By the cubic through the four nearest nodes of the section, or the parabola or line through
    what there is.
    """
    first = I[section + N_FIRST]
    last = first + I[section + N_COUNT] - 1
    low = max(first, left - 1)
    high = min(last, left + 2)
    h = M[I[O_LENGTH] + left + 1]
    s = x * h
    # Arc lengths of the points from node `left`.
    before = -M[I[O_LENGTH] + left] if low < left else 0.0
    after = h + M[I[O_LENGTH] + left + 2] if high > left + 1 else 0.0
    for base in range(3):
        width = WIDTH if base == 0 else (RATES if base == 1 else 2)
        at = I[O_Y] if base == 0 else (I[O_RATE] if base == 1 else I[O_STRAINS])
        for k in range(width):
            total = 0.0
            for node in range(low, high + 1):
                place = 0.0
                if node < left:
                    place = before
                elif node == left + 1:
                    place = h
                elif node > left + 1:
                    place = after
                weight = 1.0
                for other in range(low, high + 1):
                    if other == node:
                        continue
                    there = 0.0
                    if other < left:
                        there = before
                    elif other == left + 1:
                        there = h
                    elif other > left + 1:
                        there = after
                    weight *= (s - there) / (place - there)
                total += weight * M[at + width * node + k]
            M[at + width * target + k] = total
    for k in range(3):
        a = M[I[O_PLACE] + 3 * left + k]
        M[I[O_PLACE] + 3 * target + k] = a + x * (M[I[O_PLACE] + 3 * (left + 1) + k] - a)


@kernel
def split(I, M, section, left):
    """A new node in the middle of the interval after node `left`. Returns a status."""
    head = header(I)
    if last_node(I) + 3 > head.capacity:
        return NO_CAPACITY
    # The blended state waits behind the last node until the others have moved.
    spare = last_node(I) + 2
    blend(I, M, section, left, 0.5, spare)
    h = M[I[O_LENGTH] + left + 1]
    status = shift_nodes(I, M, left + 1, 1)
    if status != OK:
        return status
    copy_node(I, M, spare, left + 1)
    M[I[O_LENGTH] + left + 1] = 0.5 * h
    M[I[O_LENGTH] + left + 2] = 0.5 * h
    M[I[O_FLOW] + left + 1] = 0.0
    M[I[O_SHARE] + left + 1] = 0.0
    I[section + N_COUNT] += 1
    return OK


@kernel
def join(I, M, section, node):
    """Take an inner node out of a section. Returns a status."""
    h = M[I[O_LENGTH] + node] + M[I[O_LENGTH] + node + 1]
    status = shift_nodes(I, M, node + 1, -1)
    M[I[O_LENGTH] + node] = h
    I[section + N_COUNT] -= 1
    return status


@kernel
def first_moving(I, M, section):
    """The node from which on a section's mesh goes along with the touchdown point: the interval
    before it takes up the change of length. 0: there is none."""
    share = I[O_SHARE]
    first = I[section + N_FIRST]
    for node in range(first + 1, first + I[section + N_COUNT]):
        if M[share + node] - M[share + node - 1] > 0.5:
            return node
    return 0


@kernel
def regrid_section(I, M, index):
    """Split and join the intervals of a section whose lengths change. Returns a status."""
    section = I[O_SECTION] + SECTION_WORDS * index
    spacing = M[X_SPACING]
    first = I[section + N_FIRST]
    count = I[section + N_COUNT]
    share = I[O_SHARE]
    last = first + count - 1
    moves = first_moving(I, M, section)
    if index == 0:
        h = M[I[O_LENGTH] + 1]
        if h > SPLIT * spacing and moves != 1:
            return split(I, M, section, first)
        if h < JOIN * spacing and count > 2 and M[share + 1] == 0.0:
            return join(I, M, section, 1)
    if moves != 0:
        h = M[I[O_LENGTH] + moves]
        if h > SPLIT * spacing:
            return split(I, M, section, moves - 1)
        if h < JOIN * spacing and moves > first + 1:
            return join(I, M, section, moves - 1)
        if h < JOIN * spacing and index > 0 and index == I[D_SECTIONS] - 2:
            return absorb(I, M, index)
        if h < 0.05 * spacing:
            return SHORT_SECTION
    elif index == I[D_SECTIONS] - 1 and M[share + last] == 1.0 and M[share + first] == 0.0:
        total = 0.0
        for node in range(first + 1, last + 1):
            total += M[I[O_LENGTH] + node]
        if total < SHORTEST * spacing:
            return SHORT_SECTION
    return OK


@kernel
def make_room(I, M, dt):
    """Before a step of dt: join the intervals that it would use up with their neighbours.

    Cable flows out of the interval at the vessel on reel-in, and out of the last one above the
    part that goes along with the touchdown point.
    """
    least = ROOM * M[X_SPACING]
    share = I[O_SHARE]
    top = I[O_SECTION]
    while M[X_PAID_IN_STEP] < 0.0 and M[I[O_LENGTH] + 1] + M[X_PAID_IN_STEP] < least:
        if I[top + N_COUNT] <= 2 or M[share + 1] != 0.0:
            break
        join(I, M, top, 1)
    index = 0
    while index < I[D_SECTIONS] and dt * M[X_FLOW_END] > 0.0:
        section = I[O_SECTION] + SECTION_WORDS * index
        used = dt * M[X_FLOW_END]
        moves = first_moving(I, M, section)
        while moves != 0 and M[I[O_LENGTH] + moves] - used < least:
            if moves <= I[section + N_FIRST] + 1:
                if index > 0 and index == I[D_SECTIONS] - 2:
                    absorb(I, M, index)
                break
            join(I, M, section, moves - 1)
            moves -= 1
        index += 1


@kernel
def absorb(I, M, index):
    """What is left of the part above the one that bends becomes part of it. Returns a status.

    The joint above it is then that of the last section, whose mesh shrinks evenly from now on.
    """
    above = I[O_SECTION] + SECTION_WORDS * index
    last = above + SECTION_WORDS
    first = I[above + N_FIRST]
    extra = M[I[O_LENGTH] + first + 1]
    I[last + N_POINT] = I[above + N_POINT]
    I[last + N_HINGE] = I[above + N_HINGE]
    for k in range(2 * SECTION_WORDS):
        I[above + k] = I[last + k]
    I[D_SECTIONS] -= 1
    # The last section's first node now stands at the joint: its first interval is longer.
    status = shift_nodes(I, M, first + 2, -2)
    M[I[O_LENGTH] + first] = 0.0
    M[I[O_LENGTH] + first + 1] += extra
    count = I[above + N_COUNT]
    total = 0.0
    for node in range(first + 1, first + count):
        total += M[I[O_LENGTH] + node]
    arc = 0.0
    for node in range(first, first + count):
        if node > first:
            arc += M[I[O_LENGTH] + node]
        M[I[O_SHARE] + node] = arc / total
    M[I[O_SHARE] + first + count - 1] = 1.0
    I[D_RESTART] = 1
    return status


@kernel
def let_flow(I, M):
    """Let the part that is laid go along with the touchdown point as a whole.

    A mesh that shrinks evenly between a point of the cable and the touchdown point would shrink
    to nothing as that point comes down: the old end of the line at the drum. When it is half as
    long as the line, its nodes all move with the touchdown point, and the interval above takes up
    the change of length. Cable flows through a joint there if both sides are of one type without
    a body between.
    """
    index = I[D_SECTIONS] - 1
    last = I[O_SECTION] + SECTION_WORDS * index
    share = I[O_SHARE]
    length = I[O_LENGTH]
    first = I[last + N_FIRST]
    end = first + I[last + N_COUNT] - 1
    if M[share + first] > 0.0 or M[share + end] < 0.999 or first_moving(I, M, last) != 0:
        return
    shrinks = 0.0  # length of the mesh that does
    begin = end
    while begin > first and M[share + begin] > 0.0:
        shrinks += M[length + begin]
        begin -= 1
    total = 0.0
    for node in range(1, end + 1):
        total += M[length + node]
    if shrinks > 0.5 * total:
        return
    if begin == first and index > 0:
        above = last - SECTION_WORDS
        if I[above + N_KIND] == RIGID or I[last + N_POINT] >= 0:
            return
        if I[above + N_MATERIAL] != I[last + N_MATERIAL]:
            return
        I[last + N_HINGE] = 0
        begin -= 1  # the other node at the joint
    if begin == 0:
        return
    for node in range(begin, end + 1):
        M[share + node] = 1.0
    I[D_RESTART] = 1


@kernel
def new_joint(I, M, row, extra):
    """The joint of a row of the drum passes the tow point, `extra` of the next cable behind it.

    A new section comes first, and one of two nodes for a rigid body. Velocities are those of the
    cable there: no impulse. Returns a status.
    """
    head = header(I)
    rigid = I[row + R_RIGID] >= 0
    more = 2 if rigid else 1
    nodes = 2 * more
    if I[D_SECTIONS] + more > I[D_SECTION_CAPACITY] or last_node(I) + nodes + 2 > head.capacity:
        return NO_CAPACITY
    old = I[O_SECTION]
    h = M[I[O_LENGTH] + 1]
    spare = last_node(I) + nodes + 1
    blend(I, M, old, 0, extra / h, spare)
    status = shift_nodes(I, M, 0, nodes)
    if status != OK:
        return status
    words = SECTION_WORDS * (I[D_SECTIONS] + 1)
    for k in range(words - 1, -1, -1):
        I[I[O_SECTION] + SECTION_WORDS * more + k] = I[I[O_SECTION] + k]
    copy_node(I, M, nodes, 0)
    for node in range(1, nodes + 1):
        copy_node(I, M, spare, node)
        M[I[O_FLOW] + node] = 0.0
        M[I[O_SHARE] + node] = 0.0
    M[I[O_LENGTH]] = 0.0
    M[I[O_LENGTH] + 1] = extra
    M[I[O_LENGTH] + nodes] = 0.0
    M[I[O_LENGTH] + nodes + 1] = h - extra
    top = I[O_SECTION]
    I[top + N_FIRST] = 0
    I[top + N_COUNT] = 2
    I[top + N_KIND] = I[row + R_KIND]
    I[top + N_MATERIAL] = I[row + R_MATERIAL]
    I[top + N_BODY] = -1
    I[top + N_POINT] = -1
    I[top + N_HINGE] = 0
    I[top + N_ITEM] = I[row + R_ITEM]
    below = top + SECTION_WORDS * more
    I[below + N_POINT] = I[row + R_POINT]
    I[below + N_HINGE] = I[row + R_HINGE]
    if rigid:
        between = top + SECTION_WORDS
        for k in range(SECTION_WORDS):
            I[between + k] = I[top + k]
        I[between + N_FIRST] = 2
        I[between + N_KIND] = RIGID
        I[between + N_BODY] = I[row + R_RIGID]
        M[I[O_LENGTH] + 2] = 0.0
        M[I[O_LENGTH] + 3] = 0.0
    I[D_SECTIONS] += more
    body = I[row + R_RIGID] if rigid else I[row + R_POINT]
    if body >= 0:
        start_body(I, M, body, 1, rigid)
    if I[D_MEETING] > 0:
        set_meeting(I, M)
    I[D_RESTART] = 1
    return OK


@kernel
def start_body(I, M, body, node, rigid):
    """A body that leaves the drum has the cable's velocity there and does not turn."""
    at = I[O_BODY] + BODY_WORDS * body
    y = I[O_Y] + WIDTH * node
    v1 = M[y + V1]
    v2 = M[y + V2]
    v3 = M[y + V3]
    if not rigid:
        v1, v2, v3 = to_fixed(M[y + PHI], M[y + THETA], v1, v2, v3)
    for k in range(BODY_STATES):
        M[at + B_STATE + k] = 0.0
        M[at + B_STATE_RATE + k] = 0.0
    M[at + B_STATE] = v1
    M[at + B_STATE + 1] = v2
    M[at + B_STATE + 2] = v3


@kernel
def take_joint_back(I, M, row, out):
    """The top section, `out` metres of it, and the body below it go back onto the drum."""
    rigid = I[row + R_RIGID] >= 0
    more = 2 if rigid else 1
    nodes = 2 * more
    if I[D_SECTIONS] <= more:
        return SHORT_SECTION
    h = M[I[O_LENGTH] + nodes + 1] + out
    copy_node(I, M, 0, nodes)
    for k in range(SECTION_WORDS * (I[D_SECTIONS] + 1 - more)):
        I[I[O_SECTION] + k] = I[I[O_SECTION] + SECTION_WORDS * more + k]
    I[D_SECTIONS] -= more
    status = shift_nodes(I, M, nodes, -nodes)
    top = I[O_SECTION]
    I[top + N_POINT] = -1
    M[I[O_LENGTH]] = 0.0
    M[I[O_LENGTH] + 1] = h
    if I[D_MEETING] > 0:
        set_meeting(I, M)
    I[D_RESTART] = 1
    return status


@kernel
def set_meeting(I, M):
    """Slot C at which two sweeps meet: the last joint between a cable and an elastica, 0: none."""
    I[D_MEETING] = 0
    for index in range(1, I[D_SECTIONS]):
        section = I[O_SECTION] + SECTION_WORDS * index
        flexible = I[section + N_KIND] == CABLE
        if flexible != (I[section - SECTION_WORDS + N_KIND] == CABLE):
            I[D_MEETING] = I[section + N_FIRST]


@kernel
def regrid(I, M):
    """After a step: joints that pass the tow point, and intervals that have changed too much."""
    state = scalars(M)
    used = I[D_DRUM_USED]
    spacing = M[X_SPACING]
    if used < I[D_DRUM]:
        row = I[O_DRUM] + DRUM_WORDS * used
        extra = state.paid - M[row + R_LEAVES]
        if extra >= FIRST_PIECE * spacing:
            # The interval at the vessel must reach past the joint.
            while M[I[O_LENGTH] + 1] - extra < 0.1 * spacing and I[I[O_SECTION] + N_COUNT] > 2:
                status = join(I, M, I[O_SECTION], 1)
                if status != OK:
                    return status
            status = new_joint(I, M, row, extra)
            if status != OK:
                return status
            I[D_DRUM_USED] += 1
    if used > 0 and used == I[D_DRUM_USED]:
        row = I[O_DRUM] + DRUM_WORDS * (used - 1)
        extra = state.paid - M[row + R_LEAVES]
        if extra < 0.5 * FIRST_PIECE * spacing:
            status = take_joint_back(I, M, row, extra)
            if status != OK:
                return status
            I[D_DRUM_USED] -= 1
    for _round in range(20):
        before = last_node(I)
        for index in range(I[D_SECTIONS]):
            status = regrid_section(I, M, index)
            if status != OK:
                return status
        if last_node(I) == before:
            break
    let_flow(I, M)
    set_meeting(I, M)
    return OK
