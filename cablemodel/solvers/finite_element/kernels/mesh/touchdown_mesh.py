"""The mesh follows the touchdown: elements are halved ahead of contact, joined behind it.

An element may be as long as the touchdown layer allows, plus half its gap above the floor, or half
its distance from the nearest cable that hangs; and as its own curvature allows, less of it near the
floor than high above, where the rule is that of free water (bending_mesh.py): one follower for all
of a line, so that none undoes what another did. Splitting is exact; only what is straight is
joined. See docs/engine.md, "Sea floor".
"""

import math

from cablemodel.solvers.finite_element.kernels.element.cubic import bend_at_begin, bend_at_end
from cablemodel.solvers.finite_element.kernels.element.scales import line_length
from cablemodel.solvers.finite_element.kernels.element.tables import CONTACT_POINTS, CONTACT_WEIGHTS
from cablemodel.solvers.finite_element.kernels.floor.contact import (
    ends_in_something,
    touchdown_layer,
)
from cablemodel.solvers.finite_element.kernels.floor.floor_memory import LEFT_PRESSED, bear
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import gap_at, lowest_gap
from cablemodel.solvers.finite_element.kernels.mesh.payout import (
    at_fraction,
    hermite,
    join_at,
    next_cable,
    out_of_joint,
    place_and_slope,
    split_element,
    split_rest,
    winch_of_edge,
)
from cablemodel.solvers.shared.access import (
    cable_of,
    constraint_of,
    edge_at,
    edge_of,
    header,
    scalars,
    spare_row,
    tension_of,
    vector,
    winch_of,
    word_of,
)
from cablemodel.solvers.shared.compile import inlined, kernel, view
from cablemodel.solvers.shared.layout import (
    CHANGED,
    EDGE_WORDS,
    FLOOR_NONE,
    JOINT_ARM,
    LAYER,
    NO_CAPACITY,
    NOTHING,
    OFF_THE_DRUM,
    OK,
    MeshRows,
)
from cablemodel.solvers.shared.numbers import PROMISE

TOUCHDOWN_AHEAD = 0.5  # growth of the wanted length per height above the floor
TOUCHDOWN_TURN = 0.9  # largest angle that an element may turn at a touchdown
CURVATURE_JUMP = 0.2  # largest, times h, near the floor: what folds must be resolved
STRAIN = 2e-5  # largest change of length when elements are joined
TOUCHDOWN_BENT = 1.0  # of tau L: what h^2 times the jump of curvature may be near the floor
TOUCHDOWN_STRAIGHT = 0.15  # of tau L: the same for two elements that are joined
SPLIT_SOON = 2.0  # steps for which what comes down is split at once
FRICTION_KEPT = 0.25  # of a bristle: what the one at the node of two that are joined may change by
TOGETHER = 16  # elements are joined when that part of all may be
SPLIT_ABOVE, JOIN_BELOW = 1.6, 0.8  # of the length wanted
TOUCHDOWN_FINEST, PUSHED = 8.0, 32.0  # of tau L: straighter and shorter stays whole; if pressed
SHORTEST_TOP = 0.4  # of the longest element of its cable at the start: a longer top one is halved
TOUCHDOWN_UNEVEN = 0.05  # of its length: what the halves of an element that is halved may differ by
ROW_GAPS, ROW_BEHIND, ROW_JUMPS = MeshRows.gaps.word, MeshRows.behind.word, MeshRows.jumps.word
ROW_WANTED, ROW_PROMISED = MeshRows.wanted.word, MeshRows.promised.word
ROW_SPARE, ROW_WAYS = MeshRows.spare.word, MeshRows.ways.word
PASSED = 4.0  # of what passes the tow point in sqrt(h/g): a top element so long is halved, too
SURELY_LONGER, SURELY_SHORTER = 1.001, 0.999  # of the cubes of lengths: what needs no cubic root
NEAR_FINEST = 4.0  # of the finest elements that are wanted: gap that counts as near
CUBIC_OFF = 0.02  # of the accuracy: where one cubic may go beside two
CUBIC_TURN = 1e-4  # square of the angle by which it may turn there


@kernel
def second_derivative(I, M, node, side, out):
    """r'' at the parent's (side 0) or the child's end of an element, (dimension,) [1/m]."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    h = edge_of(I, M, node).length
    p = head.position + size * I[head.parent + node]
    q = head.position + size * node
    for i in range(dimension):
        chord = (M[q + i] - M[p + i]) / h
        d0 = M[p + dimension + i]
        d1 = M[q + dimension + i]
        if side == 0:
            out[i] = bend_at_begin(6.0 * chord, d0, d1) / h
        else:
            out[i] = bend_at_end(6.0 * chord, d0, d1) / h


@kernel
def jump_at(I, M, node, across):
    """Jump of r'' at an element's child end [1/m]: 0 at a joint, all of it at the line's end.

    across: only what of it is across the line, a bend. Along it r'' jumps where |r'| does not stay
    the same, as in waves along the line. That falls as h in shorter elements, not as h^2.
    """
    head = header(I)
    if I[head.joint + node] != 0:
        return 0.0
    dimension = head.dimension
    before = vector()
    after = vector()
    second_derivative(I, M, node, 1, before)
    if node + 1 < head.nodes + head.left_out:
        if I[head.joint + node + 1] != 0:
            return 0.0
        second_derivative(I, M, node + 1, 0, after)
    slope = head.position + 2 * dimension * node + dimension
    square = 0.0
    along = 0.0
    size = 1e-300
    for i in range(dimension):
        jump = after[i] - before[i]
        square += jump * jump
        along += jump * M[slope + i]
        size += M[slope + i] ** 2
    if across:
        square = max(0.0, square - along * along / size)
    return math.sqrt(square)


@kernel
def begins_anew(I, node):
    """Whether no cable comes to a node from that before it: another line of a system begins."""
    head = header(I)
    return I[head.parent + node] != node - 1 or I[head.joint + node] >= JOINT_ARM


@kernel
def position_accuracy(I, M, node):
    """What places along the line that an element is a part of may be wrong by, tau L [m]."""
    return scalars(M).tolerance * line_length(I, M, edge_of(I, M, node))


@kernel
def bend_allowed(I, M, node):
    """What h^2 times the jump of r'' at an element may be in free water [m]."""
    head = header(I)
    state = scalars(M)
    if head.parts == 0:
        return state.bent
    return state.bent * position_accuracy(I, M, node) / (state.tolerance * state.length)


@kernel
def measure(I, M, gaps, behind, jumps):
    """Gap of every element, its distance from hanging cable, jump of r'' at its child end."""
    head = header(I)
    state = scalars(M)
    nodes = head.nodes
    dimension = head.dimension
    depth = state.floor_depth
    q = M[head.position : head.position + 2 * dimension * nodes]
    way = 1e300
    jumps[0] = 0.0
    for node in range(1, nodes):
        gaps[node] = 1e300
        if begins_anew(I, node):
            way = 1e300
        behind[node] = way
        jumps[node] = 0.0
        if I[head.joint + node] != 0:
            continue
        gaps[node] = lowest_gap(I, M, q, node)
        if gaps[node] >= depth:
            way = 0.0
            behind[node] = 0.0
        else:
            way += edge_of(I, M, node).length
        jumps[node] = jump_at(I, M, node, gaps[node] >= depth)
    way = 1e300
    for node in range(nodes - 1, 0, -1):
        if begins_anew(I, node):
            way = 1e300
        if I[head.joint + node] != 0:
            continue
        behind[node] = min(behind[node], way)
        if gaps[node] >= depth:
            way = 0.0
        else:
            way += edge_of(I, M, node).length


@inlined
def largest_tension_of(I, M, node):
    """The largest tension that steps have found in an element's line [N]; infinite: no tension is
    promised there."""
    if header(I).parts == 0:
        return scalars(M).largest_tension
    return cable_of(I, M, int(edge_of(I, M, node).segment)).tension


@kernel
def measure_promise(I, M, gaps, promised, spare):
    """What the tension of elements may be wrong by [N], by the largest in their lines, and how far
    along itself what lands of them may be misplaced [m]: more would stretch what hangs by more."""
    head = header(I)
    state = scalars(M)
    first = 1
    give = 0.0
    largest = 0.0
    for node in range(1, head.nodes + 1):
        if node == head.nodes or begins_anew(I, node):
            for of_line in range(first, node):
                promised[of_line] = PROMISE * state.tolerance * largest
                spare[of_line] = promised[of_line] * give
            first = node
            give = 0.0
            largest = 0.0
        if node == head.nodes or I[head.joint + node] != 0:
            continue
        tension = abs(tension_of(I, M, node).mean)
        largest = max(largest, tension, largest_tension_of(I, M, node))
        if gaps[node] >= state.floor_depth:
            edge = edge_of(I, M, node)
            give += edge.compliance * edge.length


@kernel
def measure_ways(I, M, gaps, ways):
    """How far elements that lie are from an anchor, along what lies [m]; 1e300: there is none."""
    head = header(I)
    depth = scalars(M).floor_depth
    ways[: head.nodes] = 1e300
    for n in range(head.constraint_count):
        node = int(constraint_of(I, M, n).node)
        if head.left_out != 0 and node == head.nodes - 1:
            continue  # beyond it cable sleeps, and friction goes on
        if I[head.joint + node] == 0 and gaps[node] < depth:
            ways[node] = 0.0
        if node + 1 < head.nodes and not begins_anew(I, node + 1) and gaps[node + 1] < depth:
            ways[node + 1] = 0.0
    for node in range(2, head.nodes):
        if gaps[node] < depth and not begins_anew(I, node):
            ways[node] = min(ways[node], ways[node - 1] + edge_of(I, M, node - 1).length)
    for node in range(head.nodes - 2, 0, -1):
        if gaps[node] < depth and not begins_anew(I, node + 1):
            ways[node] = min(ways[node], ways[node + 1] + edge_of(I, M, node + 1).length)


@kernel
def length_by_grip(I, M, node, promised, way):
    """The longest element that finds what friction holds next to an anchor [m].

    There friction grows from none to all. An element, whose bristles are linear between its nodes,
    that begins at the anchor has half of its friction.
    """
    if way == 1e300:
        return 1e300
    grip = scalars(M).friction * edge_of(I, M, node).contact
    return promised / grip / SPLIT_ABOVE + TOUCHDOWN_AHEAD * way


@kernel
def landing_radius(I, M, node, gap, layer):
    """Radius to which an element bends where it lands [m]; gap: its height at present [m]."""
    # T - w z hardly changes along a hanging cable: the tension that it will land with.
    at = tension_of(I, M, node)
    tension = at.mean - abs(at.slope)
    return layer + max(0.0, tension / edge_of(I, M, node).contact - max(0.0, gap))


@kernel
def finest_length(I, M, node, gap, layer):
    """Length of the elements where cable of this kind lands [m].

    gap: height of the element at present [m]. layer: that of its touchdown [m].
    """
    accuracy = position_accuracy(I, M, node)
    radius = landing_radius(I, M, node, gap, layer)
    # By the place of the cable, and by the angle that an element turns: what it misses of its
    # length when it lands strains the laid cable.
    return max(LAYER * layer, min(math.sqrt(2.0 * accuracy * radius), TOUCHDOWN_TURN * radius))


@kernel
def length_by_tension(I, M, node, gap, layer, spare, longest):
    """The longest element with which a touchdown goes on without a jump of the tension [m], up to
    `longest`, of which one wants no more.

    The touchdown passes from element to element. In each, the line's length is wrong by up to what
    its arc is longer than the chord, h^3/(24 R^2), and right again in the next. Elements as short
    as the layer over which the cable bends on to the floor follow it there.
    """
    radius = landing_radius(I, M, node, gap, layer)
    cube = 24.0 * spare * radius * radius
    if spare == 0.0 or cube > SURELY_LONGER * (SPLIT_ABOVE * longest) ** 3:
        return longest
    if cube < SURELY_SHORTER * (SPLIT_ABOVE * layer) ** 3:
        return min(longest, layer)
    return min(longest, max(layer, cube ** (1.0 / 3.0) / SPLIT_ABOVE))


@inlined
def moved_by_winch(I, M, edge):
    """The winch that changes an element's length; -1: none does."""
    if header(I).payout == 0:
        return -1
    return winch_of_edge(I, M, edge)


@kernel
def time_of_hanging(I, M, node):
    """sqrt(h/g) of the height of a node above the floor, at most sqrt(L/g) [s]: what lies is none
    of the line that moves."""
    head = header(I)
    state = scalars(M)
    if head.floor_kind == FLOOR_NONE:
        return state.period
    dimension = head.dimension
    place = view(M, head.position + 2 * dimension * node, dimension)
    height = max(0.0, gap_at(I, M, place, vector()))
    return state.period * math.sqrt(min(1.0, height / state.length))


@kernel
def may_be_halved(I, M, node):
    """Whether an element may be shorter: any but some next to a winch that moves its line.

    The first bit of another cable that has begun to leave the drum lies in the top element.
    """
    n = moved_by_winch(I, M, node)
    if n < 0:
        return True
    winch = winch_of(I, M, n)
    edge = edge_of(I, M, node)
    row = cable_of(I, M, int(winch.cable))
    above = next_cable(I, M, winch, OFF_THE_DRUM)
    if above >= 0 and out_of_joint(I, M, winch, above) > 0.0:
        return False
    passed = PASSED * abs(winch.rate) * time_of_hanging(I, M, int(winch.node))
    return edge.length > min(SHORTEST_TOP * row.nominal, passed)


@kernel
def finest_flexible(I, M, node):
    """Length below which no element of cable that hardly bends is halved for its bend [m].

    Under pressure, where it buckles, sooner; where drag hardly damps, none is halved then.
    """
    state = scalars(M)
    accuracy = position_accuracy(I, M, node)
    if tension_of(I, M, node).mean < 0.0:
        return 1e300 if state.undamped != 0.0 else PUSHED * accuracy
    return bend_allowed(I, M, node) if state.undamped != 0.0 else TOUCHDOWN_FINEST * accuracy


@kernel
def length_by_bend(I, M, node, layer, jumps):
    """The length of an element high above a floor that its bend allows [m], as in free water.

    layer: that of its touchdown [m]. Cable in which bending reaches no further than the finest
    element is as good as perfectly flexible: see `bending_mesh.bends_too_much`.
    """
    head = header(I)
    allowed = bend_allowed(I, M, node)
    if allowed == 0.0 or not may_be_halved(I, M, node):
        return 1e300
    # At the line's ends r'' may be anything.
    bend = jumps[node - 1]
    if node < head.nodes - 1:
        bend = max(bend, jumps[node])
    if bend == 0.0:
        return 1e300
    wanted = math.sqrt(allowed / bend)
    finest = finest_flexible(I, M, node)
    if layer < finest:
        wanted = max(wanted, finest)
    return wanted / SPLIT_ABOVE


@kernel
def wanted_length(I, M, node, layer, gaps, behind, jumps, spare):
    """The length that an element should have where it is [m]; layer: that of its touchdown [m]."""
    state = scalars(M)
    accuracy = position_accuracy(I, M, node)
    depth = state.floor_depth
    shortest = LAYER * layer
    finest = finest_length(I, M, node, gaps[node], layer)
    finest = length_by_tension(I, M, node, gaps[node], layer, spare[node], finest)
    finest = max(shortest, finest)
    if gaps[node] >= depth:
        wanted = finest + TOUCHDOWN_AHEAD * (gaps[node] - depth)
        near = gaps[node] < NEAR_FINEST * finest
    else:
        wanted = finest + 0.5 * max(0.0, behind[node] - 2.0 * finest)
        near = True
    if near:
        bend = max(jumps[node], jumps[node - 1])
        if bend > 0.0:
            allowed = min(math.sqrt(TOUCHDOWN_BENT * accuracy / bend), CURVATURE_JUMP / bend)
            wanted = max(shortest, min(wanted, allowed))
    else:
        wanted = min(wanted, length_by_bend(I, M, node, layer, jumps))
    return wanted


@kernel
def holds_something(I, M, node):
    """Whether a body, a prescribed end or a joint sits at a node."""
    head = header(I)
    if ends_in_something(I, M, node):
        return True
    return I[head.joint + node] != 0 or I[head.joint + node + 1] != 0


@kernel
def arc_length(I, M, p0, p1, h, start, share):
    """Length of a share of the cubic between the nodal data at two words from a fraction of it on.

    By Gauss's rule of 4 points [m].
    """
    head = header(I)
    dimension = head.dimension
    place = vector()
    slope = vector()
    length = 0.0
    for p in range(4):
        x = start + share * CONTACT_POINTS[p]
        hermite(M, p0, p1, dimension, h, x, place, slope)
        square = 0.0
        for i in range(dimension):
            square += slope[i] ** 2
        length += share * h * CONTACT_WEIGHTS[p] * math.sqrt(square)
    return length


@kernel
def halves_are_even(I, M, node):
    """Whether the halves of an element have the length of the cable in them, nearly.

    Those of one that is folded, as at a tow point that pushes slack cable, do not: halved, a top
    element of 1.17 m had halves 27 % too long and too short, which no projection undoes, and what
    the next step made of it were 1e6 N.
    """
    head = header(I)
    size = 2 * head.dimension
    h = edge_of(I, M, node).length
    p0 = head.position + size * I[head.parent + node]
    p1 = head.position + size * node
    upper = arc_length(I, M, p0, p1, h, 0.0, 0.5)
    return abs(upper - arc_length(I, M, p0, p1, h, 0.5, 0.5)) <= TOUCHDOWN_UNEVEN * h


@kernel
def is_straight(I, M, node, jump):
    """Whether the cable is straight enough at a node for its two elements to become one."""
    accuracy = position_accuracy(I, M, node)
    edge = edge_of(I, M, node)
    h = edge.length + edge_at(M, word_of(M, edge) + EDGE_WORDS).length
    if (
        jump * h * h > TOUCHDOWN_STRAIGHT * accuracy
        or jump * h > TOUCHDOWN_STRAIGHT * CURVATURE_JUMP
    ):
        return False
    return one_cubic_does(I, M, node)


@kernel
def one_cubic_does(I, M, node):
    """Whether a cubic in the place of the two at a node goes where they go, and is as long."""
    head = header(I)
    accuracy = position_accuracy(I, M, node)
    dimension = head.dimension
    size = 2 * dimension
    h1 = edge_of(I, M, node).length
    h = h1 + edge_of(I, M, node + 1).length
    place = vector()
    slope = vector()
    at = head.position + size * node
    hermite(M, at - size, at + size, dimension, h, h1 / h, place, slope)
    off = 0.0
    turn = 0.0
    for i in range(dimension):
        off += (place[i] - M[at + i]) ** 2
        turn += (slope[i] - M[at + dimension + i]) ** 2
    if off > (CUBIC_OFF * accuracy) ** 2 or turn > CUBIC_TURN:
        return False
    both = arc_length(I, M, at - size, at, h1, 0.0, 1.0)
    both += arc_length(I, M, at, at + size, h - h1, 0.0, 1.0)
    return abs(arc_length(I, M, at - size, at + size, h, 0.0, 1.0) - both) <= STRAIN * h


@kernel
def keeps_friction(I, M, node):
    """Whether one element in the place of the two at a node has the bristle there that it has."""
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    size = 2 * dimension
    h1 = edge_of(I, M, node).length
    h = h1 + edge_of(I, M, node + 1).length
    place = place_and_slope()
    rest = place_and_slope()
    at = size * node
    at_fraction(
        M, head.position + at - size, head.position + at + size, dimension, h, h1 / h, place
    )
    split_rest(I, M, node - 1, node + 1, h, h1 / h, place, rest)
    square = 0.0
    for i in range(dimension - 1):
        bristle = M[head.position + at + i] - M[head.rest + at + i]
        square += (bristle - (place[i] - rest[i])) ** 2
    return square <= (FRICTION_KEPT * state.bristle) ** 2


@kernel
def may_join(I, M, node, gaps, wanted):
    """Whether an element may become one with that before it."""
    state = scalars(M)
    lower = edge_of(I, M, node)
    upper = edge_at(M, word_of(M, lower) - EDGE_WORDS)
    aim = JOIN_BELOW * min(wanted[node - 1], wanted[node])
    if max(gaps[node - 1], gaps[node]) >= state.floor_depth:
        aim = min(aim, upper.nominal)
    return (
        lower.length + upper.length < aim
        and upper.segment == lower.segment
        and is_straight(I, M, node - 1, jump_at(I, M, node - 1, False))
        and (
            state.friction == 0.0
            or gaps[node] >= state.floor_depth
            or keeps_friction(I, M, node - 1)
        )
    )


@kernel
def lower(I, M, gaps):
    """Let what comes down be as near the floor as it will be some steps later.

    Every change of the mesh takes matrices: what has to be split soon is split with the rest.
    """
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    depth = state.floor_depth
    step = state.step
    if state.tractable > 0.0:
        step = min(step, state.tractable)
    for node in range(1, head.nodes):
        if gaps[node] >= depth and gaps[node] < 1e299:
            sinking = -M[head.velocity + 2 * dimension * node + dimension - 1]
            way = SPLIT_SOON * step * max(0.0, sinking)
            gaps[node] = max(depth, gaps[node] - min(way, 0.5 * gaps[node]))


@kernel
def follow_floor(I, M, change, first):
    """Whether the floor asks for another mesh; with `change`, halve and join elements for it.

    first: the node beyond which it may change, and the element after it stays; 0: everywhere.
    NOTHING, CHANGED (or to be changed), or NO_CAPACITY: the block must grow first.
    """
    head = header(I)
    state = scalars(M)
    if state.floor_wait > 0.0:
        # Before a step: the forces that are read after one are those that made it.
        way = state.floor_wait / state.period
        bear(I, M, way / (1.0 + way), LEFT_PRESSED)
        state.floor_wait = 0.0
    gaps = view(M, spare_row(I, ROW_GAPS), head.capacity)
    behind = view(M, spare_row(I, ROW_BEHIND), head.capacity)
    jumps = view(M, spare_row(I, ROW_JUMPS), head.capacity)
    wanted = view(M, spare_row(I, ROW_WANTED), head.capacity)
    promised = view(M, spare_row(I, ROW_PROMISED), head.capacity)
    spare = view(M, spare_row(I, ROW_SPARE), head.capacity)
    ways = view(M, spare_row(I, ROW_WAYS), head.capacity)
    measure(I, M, gaps, behind, jumps)
    measure_promise(I, M, gaps, promised, spare)
    grips = state.friction > 0.0 and head.constraint_count > 1
    if grips:
        measure_ways(I, M, gaps, ways)
    if change:
        lower(I, M, gaps)
    alike = 0  # an element of the same cable, whose touchdown layer is known
    layer = 0.0
    for node in range(1, head.nodes):
        if I[head.joint + node] == 0:
            edge, other = edge_of(I, M, node), edge_of(I, M, alike)
            if (
                alike == 0
                or edge.bending_full != other.bending_full
                or edge.contact != other.contact
            ):
                layer = touchdown_layer(M, edge)
                alike = node
            if moved_by_winch(I, M, node) < 0:
                wanted[node] = wanted_length(I, M, node, layer, gaps, behind, jumps, spare)
                if grips:
                    by_grip = length_by_grip(I, M, node, promised[node], ways[node])
                    wanted[node] = min(wanted[node], by_grip)
            else:
                # The element that the winch changes follows its bend alone.
                wanted[node] = length_by_bend(I, M, node, layer, jumps)
    hanging = 0
    for node in range(1, head.nodes):
        if gaps[node] >= state.floor_depth:
            hanging += 1
    changed = NOTHING
    waiting = 0
    node = head.nodes - 1
    last = first + 2 if first > 0 else 1
    while node >= last:
        if I[head.joint + node] == 0:
            h = edge_of(I, M, node).length
            if h > SPLIT_ABOVE * wanted[node] and halves_are_even(I, M, node):
                # What folds near the floor is followed at any number of nodes.
                if gaps[node] < h or hanging < state.most_nodes:
                    if not change:
                        return CHANGED
                    if split_element(I, M, node, 0.5) != OK:
                        return NO_CAPACITY
                    hanging += 1
                    changed = CHANGED
            elif (
                # Nodes after this one may have been split; those before it are as measured.
                node > 1
                and moved_by_winch(I, M, node) < 0
                and moved_by_winch(I, M, node - 1) < 0
                and not holds_something(I, M, node - 1)
                and may_join(I, M, node, gaps, wanted)
            ):
                if not change:
                    waiting += 1
                    if waiting * TOGETHER >= head.nodes:
                        return CHANGED
                    node -= 1
                    continue
                above = edge_of(I, M, node - 1)
                below = edge_of(I, M, node)
                below.support = max(above.support, below.support)
                join_at(I, M, node - 1, 1)
                changed = CHANGED
                node -= 1
        node -= 1
    return changed
