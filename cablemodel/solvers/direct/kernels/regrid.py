"""The mesh follows the cable: intervals are split and joined, joints leave the drum and return."""

from cablemodel.solvers.shared.access import header, winch_of, word_of
from cablemodel.solvers.shared.compile import copy_words
from cablemodel.solvers.shared.layout import NO_CAPACITY, OK

from .access import (
    drum_row_of,
    own_header,
    own_scalars,
    place_of,
    rigid_body_of,
    section_at,
    section_of,
    unknowns_of,
)
from .compile import kernel
from .frame import to_fixed
from .geometry import last_node
from .layout import (
    BODY_STATES,
    CABLE,
    PLACE_WORDS,
    RATES,
    RIGID,
    SECTION_WORDS,
    SHORT_SECTION,
    STRAIN_WORDS,
    WIDTH,
)

REGRID_SPLIT, JOIN = 1.5, 0.5
"""Of the node spacing: an interval that grows beyond is split, one that shrinks below is joined."""
REGRID_FIRST_PIECE = 0.25
"""Of the node spacing: cable that must be out before the joint below it leaves the drum."""
ROOM = 0.25
"""Of the node spacing: what a step should leave of an interval out of which cable flows."""
REGRID_SHORTEST = 0.5
"""Of the node spacing: cable between the touchdown point and the joint above it."""


@kernel
def copy_row(M, table, words, source, target):
    """A row of a table of so many words a row."""
    copy_words(M, table + words * target, table + words * source, words)


@kernel
def copy_node(I, M, source, target):
    """All words of a node."""
    own = own_header(I)
    copy_row(M, own.unknowns, WIDTH, source, target)
    copy_row(M, own.rate, RATES, source, target)
    copy_row(M, own.place, PLACE_WORDS, source, target)
    copy_row(M, own.strains, STRAIN_WORDS, source, target)
    M[own.length + target] = M[own.length + source]
    M[own.flow + target] = M[own.flow + source]
    M[own.share + target] = M[own.share + source]


@kernel
def shift_nodes(I, M, first, by):
    """Move the nodes from `first` on by `by` places. Returns a status."""
    own = own_header(I)
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
    for index in range(own.section_count):
        section = section_of(I, M, index)
        if section.first >= first:
            section.first += by
    return OK


@kernel
def blend(I, M, section, left, x, target):
    """The state at a fraction x of the interval that begins at node `left`, into `target`.

    By the cubic through the four nearest nodes of the section, or the parabola or line through
    what there is.
    """
    own = own_header(I)
    first = section.first
    last = first + section.count - 1
    low = max(first, left - 1)
    high = min(last, left + 2)
    h = M[own.length + left + 1]
    s = x * h
    # Arc lengths of the points from node `left`.
    before = -M[own.length + left] if low < left else 0.0
    after = h + M[own.length + left + 2] if high > left + 1 else 0.0
    for base in range(3):
        width = WIDTH if base == 0 else (RATES if base == 1 else STRAIN_WORDS)
        at = own.unknowns if base == 0 else (own.rate if base == 1 else own.strains)
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
    a = place_of(I, M, left)
    b = place_of(I, M, left + 1)
    between = place_of(I, M, target)
    between.x = a.x + x * (b.x - a.x)
    between.y = a.y + x * (b.y - a.y)
    between.z = a.z + x * (b.z - a.z)


@kernel
def split(I, M, section, left):
    """A new node in the middle of the interval after node `left`. Returns a status."""
    own = own_header(I)
    head = header(I)
    if last_node(I) + 3 > head.capacity:
        return NO_CAPACITY
    # The blended state waits behind the last node until the others have moved.
    spare = last_node(I) + 2
    blend(I, M, section, left, 0.5, spare)
    h = M[own.length + left + 1]
    status = shift_nodes(I, M, left + 1, 1)
    if status != OK:
        return status
    copy_node(I, M, spare, left + 1)
    M[own.length + left + 1] = 0.5 * h
    M[own.length + left + 2] = 0.5 * h
    M[own.flow + left + 1] = 0.0
    M[own.share + left + 1] = 0.0
    section.count += 1
    return OK


@kernel
def join(I, M, section, node):
    """Take an inner node out of a section. Returns a status."""
    own = own_header(I)
    h = M[own.length + node] + M[own.length + node + 1]
    status = shift_nodes(I, M, node + 1, -1)
    M[own.length + node] = h
    section.count -= 1
    return status


@kernel
def first_moving(I, M, section):
    """The node from which on a section's mesh goes along with the touchdown point: the interval
    before it takes up the change of length. 0: there is none."""
    own = own_header(I)
    share = own.share
    first = section.first
    for node in range(first + 1, first + section.count):
        if M[share + node] - M[share + node - 1] > 0.5:
            return node
    return 0


@kernel
def regrid_section(I, M, index):
    """Split and join the intervals of a section whose lengths change. Returns a status."""
    own = own_header(I)
    run = own_scalars(M)
    section = section_of(I, M, index)
    spacing = run.spacing
    first = section.first
    count = section.count
    share = own.share
    last = first + count - 1
    moves = first_moving(I, M, section)
    if index == 0:
        h = M[own.length + 1]
        if h > REGRID_SPLIT * spacing and moves != 1:
            return split(I, M, section, first)
        if h < JOIN * spacing and count > 2 and M[share + 1] == 0.0:
            return join(I, M, section, 1)
    if moves != 0:
        h = M[own.length + moves]
        if h > REGRID_SPLIT * spacing:
            return split(I, M, section, moves - 1)
        if h < JOIN * spacing and moves > first + 1:
            return join(I, M, section, moves - 1)
        if h < JOIN * spacing and index > 0 and index == own.section_count - 2:
            return absorb(I, M, index)
        if h < 0.05 * spacing:
            return SHORT_SECTION
    elif index == own.section_count - 1 and M[share + last] == 1.0 and M[share + first] == 0.0:
        total = 0.0
        for node in range(first + 1, last + 1):
            total += M[own.length + node]
        if total < REGRID_SHORTEST * spacing:
            return SHORT_SECTION
    return OK


@kernel
def make_room(I, M, dt):
    """Before a step of dt: join the intervals that it would use up with their neighbours.

    Cable flows out of the interval at the vessel on reel-in, and out of the last one above the
    part that goes along with the touchdown point.
    """
    own = own_header(I)
    run = own_scalars(M)
    least = ROOM * run.spacing
    share = own.share
    top = section_of(I, M, 0)
    while run.paid_in_step < 0.0 and M[own.length + 1] + run.paid_in_step < least:
        if top.count <= 2 or M[share + 1] != 0.0:
            break
        join(I, M, top, 1)
    index = 0
    while index < own.section_count and dt * run.flow_end > 0.0:
        section = section_of(I, M, index)
        used = dt * run.flow_end
        moves = first_moving(I, M, section)
        while moves != 0 and M[own.length + moves] - used < least:
            if moves <= section.first + 1:
                if index > 0 and index == own.section_count - 2:
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
    own = own_header(I)
    above = section_of(I, M, index)
    last = section_at(M, word_of(M, above) + SECTION_WORDS)
    first = above.first
    extra = M[own.length + first + 1]
    last.point = above.point
    last.hinge = above.hinge
    for k in range(2 * SECTION_WORDS):
        I[word_of(M, above) + k] = I[word_of(M, last) + k]
    own.section_count -= 1
    # The last section's first node now stands at the joint: its first interval is longer.
    status = shift_nodes(I, M, first + 2, -2)
    M[own.length + first] = 0.0
    M[own.length + first + 1] += extra
    count = above.count
    total = 0.0
    for node in range(first + 1, first + count):
        total += M[own.length + node]
    arc = 0.0
    for node in range(first, first + count):
        if node > first:
            arc += M[own.length + node]
        M[own.share + node] = arc / total
    M[own.share + first + count - 1] = 1.0
    own.restart = 1
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
    own = own_header(I)
    index = own.section_count - 1
    last = section_of(I, M, index)
    share = own.share
    length = own.length
    first = last.first
    end = first + last.count - 1
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
        above = section_at(M, word_of(M, last) - SECTION_WORDS)
        if above.kind == RIGID or last.point >= 0:
            return
        if above.material != last.material:
            return
        last.hinge = 0
        begin -= 1  # the other node at the joint
    if begin == 0:
        return
    for node in range(begin, end + 1):
        M[share + node] = 1.0
    own.restart = 1


@kernel
def new_joint(I, M, row, extra):
    """The joint of a row of the drum passes the tow point, `extra` of the next cable behind it.

    A new section comes first, and one of two nodes for a rigid body. Velocities are those of the
    cable there: no impulse. Returns a status.
    """
    own = own_header(I)
    head = header(I)
    rigid = row.rigid >= 0
    more = 2 if rigid else 1
    nodes = 2 * more
    if own.section_count + more > own.section_capacity or last_node(I) + nodes + 2 > head.capacity:
        return NO_CAPACITY
    old = section_of(I, M, 0)
    h = M[own.length + 1]
    spare = last_node(I) + nodes + 1
    blend(I, M, old, 0, extra / h, spare)
    status = shift_nodes(I, M, 0, nodes)
    if status != OK:
        return status
    words = SECTION_WORDS * (own.section_count + 1)
    for k in range(words - 1, -1, -1):
        I[own.sections + SECTION_WORDS * more + k] = I[own.sections + k]
    copy_node(I, M, nodes, 0)
    for node in range(1, nodes + 1):
        copy_node(I, M, spare, node)
        M[own.flow + node] = 0.0
        M[own.share + node] = 0.0
    M[own.length] = 0.0
    M[own.length + 1] = extra
    M[own.length + nodes] = 0.0
    M[own.length + nodes + 1] = h - extra
    top = section_of(I, M, 0)
    top.first = 0
    top.count = 2
    top.kind = row.kind
    top.material = row.material
    top.body = -1
    top.point = -1
    top.hinge = 0
    top.item = row.item
    below = section_at(M, word_of(M, top) + SECTION_WORDS * more)
    below.point = row.point
    below.hinge = row.hinge
    if rigid:
        between = section_at(M, word_of(M, top) + SECTION_WORDS)
        for k in range(SECTION_WORDS):
            I[word_of(M, between) + k] = I[word_of(M, top) + k]
        between.first = 2
        between.kind = RIGID
        between.body = row.rigid
        M[own.length + 2] = 0.0
        M[own.length + 3] = 0.0
    own.section_count += more
    body = row.rigid if rigid else row.point
    if body >= 0:
        start_body(I, M, body, 1, rigid)
    if own.meeting > 0:
        set_meeting(I, M)
    own.restart = 1
    return OK


@kernel
def start_body(I, M, body, node, rigid):
    """A body that leaves the drum has the cable's velocity there and does not turn."""
    at = rigid_body_of(I, M, body)
    y = unknowns_of(I, M, node)
    v1 = y.v1
    v2 = y.v2
    v3 = y.v3
    if not rigid:
        v1, v2, v3 = to_fixed(y.phi, y.theta, v1, v2, v3)
    for k in range(BODY_STATES):
        at.state[k] = 0.0
        at.state_rate[k] = 0.0
    at.state[0] = v1
    at.state[1] = v2
    at.state[2] = v3


@kernel
def take_joint_back(I, M, row, out):
    """The top section, `out` metres of it, and the body below it go back onto the drum."""
    own = own_header(I)
    rigid = row.rigid >= 0
    more = 2 if rigid else 1
    nodes = 2 * more
    if own.section_count <= more:
        return SHORT_SECTION
    h = M[own.length + nodes + 1] + out
    copy_node(I, M, 0, nodes)
    for k in range(SECTION_WORDS * (own.section_count + 1 - more)):
        I[own.sections + k] = I[own.sections + SECTION_WORDS * more + k]
    own.section_count -= more
    status = shift_nodes(I, M, nodes, -nodes)
    top = section_of(I, M, 0)
    top.point = -1
    M[own.length] = 0.0
    M[own.length + 1] = h
    if own.meeting > 0:
        set_meeting(I, M)
    own.restart = 1
    return status


@kernel
def set_meeting(I, M):
    """Slot C at which two sweeps meet: the last joint between a cable and an elastica, 0: none."""
    own = own_header(I)
    own.meeting = 0
    for index in range(1, own.section_count):
        section = section_of(I, M, index)
        flexible = section.kind == CABLE
        if flexible != (section_at(M, word_of(M, section) - SECTION_WORDS).kind == CABLE):
            own.meeting = section.first


@kernel
def regrid(I, M):
    """After a step: joints that pass the tow point, and intervals that have changed too much."""
    own = own_header(I)
    run = own_scalars(M)
    used = own.drum_used
    spacing = run.spacing
    if used < own.drum_count:
        row = drum_row_of(I, M, used)
        extra = winch_of(I, M, 0).paid - row.leaves
        if extra >= REGRID_FIRST_PIECE * spacing:
            # The interval at the vessel must reach past the joint.
            while M[own.length + 1] - extra < 0.1 * spacing and section_of(I, M, 0).count > 2:
                status = join(I, M, section_of(I, M, 0), 1)
                if status != OK:
                    return status
            status = new_joint(I, M, row, extra)
            if status != OK:
                return status
            own.drum_used += 1
    if used > 0 and used == own.drum_used:
        row = drum_row_of(I, M, used - 1)
        extra = winch_of(I, M, 0).paid - row.leaves
        if extra < 0.5 * REGRID_FIRST_PIECE * spacing:
            status = take_joint_back(I, M, row, extra)
            if status != OK:
                return status
            own.drum_used -= 1
    for _round in range(20):
        before = last_node(I)
        for index in range(own.section_count):
            status = regrid_section(I, M, index)
            if status != OK:
                return status
        if last_node(I) == before:
            break
    let_flow(I, M)
    set_meeting(I, M)
    return OK
