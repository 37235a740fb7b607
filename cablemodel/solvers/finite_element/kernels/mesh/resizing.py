"""Lines get other lengths, or another place, before a start; their elements keep their number.

`lengths`: rows of CableLength, on the way from one length to another one. What is left is a first
shape, from which the equilibrium is sought.
"""

from cablemodel.solvers.finite_element.kernels.mesh.lengths import (
    arrange,
    change,
    count_of,
    forget_stabilisation,
    growth_of,
    length_out,
    measure,
    row_at,
)
from cablemodel.solvers.finite_element.kernels.time.promote import promote
from cablemodel.solvers.shared.access import (
    cable_of,
    constraint_of,
    edge_of,
    header,
    motion_piece_of,
    polynomial_at,
    scalars,
    start_move_at,
    winch_of,
    word_of,
)
from cablemodel.solvers.shared.compile import inlined, kernel, outlined
from cablemodel.solvers.shared.layout import HELD_BY_ANCHOR, JOINT_NONE, PIECE_WORDS
from cablemodel.solvers.shared.numbers import SAME_PLACE


@inlined
def is_out_of_plane(plane, vector):
    """Whether a vector leaves the vertical plane through a horizontal direction."""
    return plane[0] * vector[1] - plane[1] * vector[0] != 0.0


@kernel
def move_start(I, M, words):
    """Move the tow point to another start, StartMove, and the line with it; an anchor stays. Until
    something drives it the vessel goes on at that start's velocity, where it has one of its own."""
    head = header(I)
    state = scalars(M)
    move = start_move_at(words, 0)
    driven = move.driven != 0.0
    plane = state.plane
    if head.dimension == 2 and (
        (head.constraint_count > 1 and is_out_of_plane(plane, move.way))
        or (driven and is_out_of_plane(plane, move.velocity))
    ):
        promote(I, M)
    for i in range(3):
        state.origin[i] += move.way[i]
        state.shift[i] += move.way[i]
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        if row.kind != HELD_BY_ANCHOR:
            continue
        if head.dimension == 2:
            row.position[0] -= plane[0] * move.way[0] + plane[1] * move.way[1]
            row.position[1] -= move.way[2]
        else:
            for i in range(3):
                row.position[i] -= move.way[i]
    if not driven:
        return
    live = motion_piece_of(I, M, 0)
    first = word_of(M, live)
    for k in range(PIECE_WORDS):
        M[first + k] = 0.0
    law = polynomial_at(live.data, 0)
    for i in range(3):
        law.position[i] = move.position[i]
        law.velocity[i] = move.velocity[i]
    head.live = 1


@kernel
def grow_elements(I, M, lengths):
    """Make each element as many times longer as its cable: the line keeps its strains, its far end
    moves."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    q = head.position
    for node in range(head.nodes - 1, 0, -1):
        edge = edge_of(I, M, node)
        growth = 1.0
        if I[head.joint + node] == JOINT_NONE:
            growth = growth_of(lengths, edge.segment)
        edge.length *= growth
        edge.nominal *= growth
        above = q + size * I[head.parent + node]
        for i in range(dimension):
            place = q + size * node + i
            M[place] = growth * (M[place] - M[above + i])
    arc = 0.0
    for node in range(1, head.nodes):
        edge = edge_of(I, M, node)
        edge.start = arc
        arc += edge.length
        above = q + size * I[head.parent + node]
        for i in range(dimension):
            M[q + size * node + i] += M[above + i]


@kernel
def back_to_the_anchor(I, M):
    """An anchored end back to its anchor: the way to it is shared out along the cable."""
    head = header(I)
    length = scalars(M).length
    dimension = head.dimension
    size = 2 * dimension
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        if row.kind != HELD_BY_ANCHOR:
            continue
        end = head.position + size * int(row.node)
        for i in range(dimension):
            way = row.position[i] - M[end + i]
            for node in range(1, head.nodes):
                edge = edge_of(I, M, node)
                place = head.position + size * node + i
                M[place] += (edge.start + edge.length) / length * way
                M[place + dimension] += way / length


@kernel
def resize_line(I, M, lengths, facts, move):
    """A line alone, to other lengths and to another start. facts: LineFacts; move: a StartMove,
    empty where the start stays, or has been moved."""
    resized = change(lengths)
    if resized:
        grow_elements(I, M, lengths)
    measure(I, M, lengths, facts)
    if len(move) > 0:
        move_start(I, M, move)
    if resized or len(move) > 0:
        back_to_the_anchor(I, M)
    arrange(I, M, lengths)
    forget_stabilisation(I, M)


# -- systems ---------------------------------------------------------------------------------------


@kernel
def is_at_start(I, M, number):
    """Whether a winch is at the beginning of its line."""
    winch = winch_of(I, M, number)
    return (winch.way > 0.0) != (cable_of(I, M, int(winch.cable)).backward != 0.0)


@kernel
def moved_along(I, M, lengths, line, drum, at_start, place):
    """Where a place along a line's cables, or along those on the drum at an end of it, comes to."""
    before = 0.0
    after = 0.0
    for n in range(count_of(lengths)):
        row = row_at(lengths, n)
        if row.line != line or (row.winch >= 0.0) != drum:
            continue
        if drum and is_at_start(I, M, int(row.winch)) != at_start:
            continue
        if place <= before + row.before * (1.0 + SAME_PLACE):
            if row.before == row.length:
                break
            return after + row.length * ((place - before) / row.before)
        before += row.before
        after += row.length
    return after + (place - before)


@outlined
def moved(I, M, lengths, line, arc):
    """Where an arc length along a line, or beyond its ends on drums, comes to."""
    if arc < 0.0:
        return -moved_along(I, M, lengths, line, True, True, -arc)
    before = length_out(lengths, line, True)
    if arc <= before * (1.0 + SAME_PLACE):
        return moved_along(I, M, lengths, line, False, False, arc)
    after = length_out(lengths, line, False)
    return after + moved_along(I, M, lengths, line, True, False, arc - before)


@kernel
def moved_in_tree(I, M, lengths, cable, place):
    """The same as the tree counts it: negative where it goes backward along the line."""
    if cable.backward != 0.0:
        return -moved(I, M, lengths, cable.row, -place)
    return moved(I, M, lengths, cable.row, place)


@kernel
def resize_lines(I, M, lengths, places, grown):
    """The lines of a system: all that is counted along them, and by how much the chords of their
    elements between places (nodes, 6) grow, (nodes, 3) [m]; nodes stay where they are."""
    head = header(I)
    if not change(lengths):
        return
    for node in range(1, head.nodes):
        if I[head.joint + node] != JOINT_NONE:
            continue
        edge = edge_of(I, M, node)
        cable = cable_of(I, M, int(edge.segment))
        growth = growth_of(lengths, edge.segment)
        above = 6 * I[head.parent + node]
        for i in range(3):
            grown[3 * node + i] = (growth - 1.0) * (places[6 * node + i] - places[above + i])
        edge.start = moved_in_tree(I, M, lengths, cable, edge.start)
        edge.length *= growth
        edge.nominal *= growth
    for index in range(head.cable_count):
        cable = cable_of(I, M, index)
        cable.leaves = moved_in_tree(I, M, lengths, cable, cable.leaves)
    arrange(I, M, lengths)
