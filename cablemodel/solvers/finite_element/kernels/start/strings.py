"""Where the parts of a system are at first: strings of masses, with weight and steady drag.

Strings pull and do not push, so the energy is convex and has one lowest place, whatever the start.
"""

import math

from cablemodel.solvers.finite_element.kernels.mesh.bending_mesh import halve_for_good, is_counted
from cablemodel.solvers.finite_element.kernels.mesh.touchdown_mesh import may_be_halved
from cablemodel.solvers.finite_element.kernels.start.settling import size_cables
from cablemodel.solvers.finite_element.kernels.start.string_energy import (
    STRETCHES,
    find_lowest,
    find_profile,
    place_of,
)
from cablemodel.solvers.finite_element.kernels.start.string_masses import (
    group_masses,
    lay_masses,
    length_in,
    load_masses,
    tie_masses,
)
from cablemodel.solvers.finite_element.kernels.start.string_rows import (
    ROW_BASE,
    ROW_GROUP,
    ROW_LEFT,
    ROW_LOAD,
    ROW_MATRIX,
    ROW_OWNER,
    ROW_PLACE,
    ROW_REST,
    ROW_RIGHT,
    ROW_SIZES,
    ROW_UNKNOWN,
    arcs_begin,
    body_in,
    line_in,
    places_begin,
    random_begin,
)
from cablemodel.solvers.shared.access import (
    cable_of,
    closure_of,
    edge_of,
    first_shape_at,
    free_body_of,
    header,
    scalars,
    vector,
)
from cablemodel.solvers.shared.compile import kernel, outlined, view
from cablemodel.solvers.shared.layout import (
    CHANGED,
    JOINT_FREE,
    JOINT_HINGE,
    JOINT_NONE,
    JOINT_ROOT_FREE,
    NO_CAPACITY,
    NOTHING,
    OK,
    W_AMPLITUDE,
)
from cablemodel.solvers.shared.numbers import NO_SIZE, REFINEMENT_SPARE, TALLEST

UPRIGHT_LINE = 0.1
"""Of a line's length: span across which it counts as upright."""
SHAKEN = 1e-3
"""Of the shortest string: by what places are moved at random before the first step."""
CHORD_OF_SLOPE = 1e-3
"""Of a line's length, to either side of a node: the chord that gives its first slope."""


@kernel
def begin_places(words, count, strings, work):
    """Number the unknown places and give them values: bodies where the scene has them, what nothing
    holds there together, all else in the middle of what is fixed. Returns how many there are."""
    shape = first_shape_at(words, 0)
    most = int(shape.most)
    bodies = int(shape.bodies)
    owner = view(work, ROW_OWNER * most, most)
    base = view(work, ROW_BASE * most, 3 * most)
    group = view(work, ROW_GROUP * most, most)
    x = view(work, ROW_PLACE * most, 3 * most)
    shortest = math.inf
    for n in range(strings):
        shortest = min(shortest, work[ROW_REST * most + n])
    middle = vector()
    fixed = 0
    for mass in range(count):
        if owner[mass] == -1 - mass:
            fixed += 1
            for i in range(3):
                middle[i] += base[3 * mass + i]
    unknowns = 0
    for mass in range(count):
        if mass == bodies:
            work[ROW_SIZES * most] = unknowns
        work[ROW_UNKNOWN * most + mass] = -1.0
        if owner[mass] != mass:
            continue
        work[ROW_UNKNOWN * most + mass] = unknowns
        for i in range(3):
            start = middle[i] / max(fixed, 1)
            put = 0
            total = 0.0
            for body in range(bodies):
                row = body_in(words, body)
                if row.given == 1.0 and group[body] == group[mass] and group[mass] >= 0.0:
                    put += 1
                    total += row.place[i]
            if put > 0:
                start = total / put
            if mass < bodies and body_in(words, mass).given == 1.0:
                start = body_in(words, mass).place[i]
            # No string may have length 0.
            random = words[random_begin(words) + 3 * unknowns + i]
            x[3 * unknowns + i] = start + SHAKEN * shortest * random
        unknowns += 1
    for mass in range(count):
        if owner[mass] >= 0.0:
            work[ROW_UNKNOWN * most + mass] = work[ROW_UNKNOWN * most + int(owner[mass])]
    return unknowns


@kernel
def middle_of_fixed(words, count, work, i):
    """A coordinate of the middle of what is fixed [m]."""
    most = int(first_shape_at(words, 0).most)
    middle = 0.0
    fixed = 0
    for mass in range(count):
        if work[ROW_OWNER * most + mass] == -1 - mass:
            fixed += 1
            middle += work[ROW_BASE * most + 3 * mass + i]
    return middle / max(fixed, 1)


@kernel
def store_places(words, count, work):
    """Places of all masses into the table; what nothing holds goes where the scene puts its bodies;
    the way across each line."""
    shape = first_shape_at(words, 0)
    most = int(shape.most)
    bodies = int(shape.bodies)
    x = view(work, ROW_PLACE * most, 3 * most)
    group = view(work, ROW_GROUP * most, most)
    begin = places_begin(words)
    for mass in range(count):
        for i in range(3):
            words[begin + 3 * mass + i] = place_of(work, most, mass, x, i)
    for own in range(bodies):
        first = group[own] >= 0.0
        for body in range(own):
            first = first and group[body] != group[own]
        if not first:
            continue
        for i in range(2):
            put = 0
            bodies_of = 0
            by = 0.0
            back = 0.0
            for body in range(bodies):
                if group[body] == group[own]:
                    bodies_of += 1
                    back -= words[begin + 3 * body + i]
                    if body_in(words, body).given == 1.0:
                        put += 1
                        by += body_in(words, body).place[i] - words[begin + 3 * body + i]
            by = by / put if put > 0 else back / bodies_of + middle_of_fixed(words, count, work, i)
            for mass in range(count):
                if group[mass] == group[own]:
                    words[begin + 3 * mass + i] += by
    for line in range(int(shape.lines)):
        row = line_in(words, line)
        last = int(row.first) + int(row.count) - 1
        one = begin + 3 * int(row.first)
        other = begin + 3 * last
        x_across = -(words[other + 1] - words[one + 1])
        y_across = words[other] - words[one]
        size = math.sqrt(x_across**2 + y_across**2)
        upright = size <= UPRIGHT_LINE * words[arcs_begin(words) + last]
        row.way[0] = 1.0 if upright else x_across / size
        row.way[1] = 0.0 if upright else y_across / size
        row.way[2] = 0.0


@kernel
def find_first_shape(I, M, words, work):
    """Places of all masses of a FirstShape, and the ways across its lines. Returns how many words
    of work it needs, where there are not as many."""
    shape = first_shape_at(words, 0)
    most = int(shape.most)
    if len(work) < ROW_MATRIX * most:
        return ROW_MATRIX * most
    work[:] = 0.0
    count = lay_masses(words)
    load_masses(words, view(work, ROW_LOAD * most, 3 * most))
    tie_masses(
        words,
        count,
        view(work, ROW_OWNER * most, most),
        view(work, ROW_BASE * most, 3 * most),
    )
    strings = 0
    for line in range(int(shape.lines)):
        row = line_in(words, line)
        for mass in range(int(row.first), int(row.first) + int(row.count) - 1):
            here = arcs_begin(words) + mass
            work[ROW_LEFT * most + strings] = mass
            work[ROW_RIGHT * most + strings] = mass + 1
            work[ROW_REST * most + strings] = words[here + 1] - words[here]
            strings += 1
    group_masses(words, count, strings, work, most)
    unknowns = begin_places(words, count, strings, work)
    size = find_profile(words, count, strings, unknowns, work)
    if len(work) < ROW_MATRIX * most + 2 * size:
        return ROW_MATRIX * most + 2 * size
    work[ROW_SIZES * most + 1] = size
    if unknowns > 0:
        for stretch in STRETCHES:
            find_lowest(I, M, words, count, strings, unknowns, stretch, work)
    store_places(words, count, work)
    return 0


@kernel
def shape_at(words, line, arc, place):
    """Place (3,) at an arc length of a line, within it [m]."""
    row = line_in(words, line)
    first = int(row.first)
    arcs = arcs_begin(words)
    mass = first
    while mass < first + int(row.count) - 2 and words[arcs + mass + 1] < arc:
        mass += 1
    low = words[arcs + mass]
    share = min(1.0, max(0.0, (arc - low) / (words[arcs + mass + 1] - low)))
    for i in range(3):
        here = places_begin(words) + 3 * mass + i
        place[i] = words[here] + share * (words[here + 3] - words[here])


@kernel
def place_on_line(I, M, words, node, element, sense):
    """Place and slope of a node along the first shape. element: the node at the far end of the one
    whose end it is; sense: of the tree along the line."""
    edge = edge_of(I, M, element)
    cable = cable_of(I, M, int(edge.segment))
    line = int(cable.row)
    arc = edge.start if node != element else edge.start + edge.length
    last = line_in(words, line)
    length = words[arcs_begin(words) + int(last.first) + int(last.count) - 1]
    arc = min(length, max(0.0, sense * arc))
    q = header(I).position + 6 * node
    here = vector()
    above = vector()
    below = vector()
    shape_at(words, line, arc, here)
    shape_at(words, line, max(0.0, arc - CHORD_OF_SLOPE * length), above)
    shape_at(words, line, min(length, arc + CHORD_OF_SLOPE * length), below)
    size = 0.0
    for i in range(3):
        size += (below[i] - above[i]) ** 2
    size = max(math.sqrt(size), NO_SIZE)
    for i in range(3):
        M[q + i] = here[i]
        M[q + 3 + i] = sense * (below[i] - above[i]) / size


@kernel
def place_nodes(I, M, words):
    """Nodes of a system along its first shape, bodies at theirs, as they are turned there."""
    head = header(I)
    for node in range(head.nodes):
        joint = I[head.joint + node]
        if joint == JOINT_FREE or joint == JOINT_ROOT_FREE:
            continue
        alone = node == 0 or joint != JOINT_NONE
        element = node + 1 if alone else node
        backward = cable_of(I, M, int(edge_of(I, M, element).segment)).backward != 0.0
        place_on_line(I, M, words, node, element, -1.0 if backward else 1.0)
    for body in range(head.free_count):
        row = free_body_of(I, M, body)
        q = head.position + 6 * int(row.node)
        for i in range(3):
            M[q + i] = words[places_begin(words) + 3 * body + i]
            for j in range(3):
                M[q + i] -= row.rotation[3 * i + j] * row.origin[j]
            M[q + 3 + i] = 0.0
    for n in range(head.closure_count):
        tie = closure_of(I, M, n)
        if tie.clamp != 0.0:
            turn = free_body_of(I, M, int(tie.body)).rotation
            for i in range(3):
                slope = head.position + 6 * int(tie.node) + 3 + i
                M[slope] = 0.0
                for j in range(3):
                    M[slope] += turn[3 * i + j] * tie.place[j]
    # Steps move what shares a place alike, but do not bring it together.
    for node in range(head.nodes):
        joint = I[head.joint + node]
        if joint == JOINT_HINGE or joint == JOINT_FREE:
            for i in range(3):
                above = head.position + 6 * I[head.parent + node]
                M[head.position + 6 * node + i] = M[above + i]


@outlined
def halve_in_waves(I, M, words):
    """Halve elements along a first shape that are longer than 1/k where waves reach, half a length
    deep, or too tall at the surface. NOTHING, CHANGED or NO_CAPACITY."""
    head = header(I)
    state = scalars(M)
    square = 0.0
    for n in range(head.wave_count):
        square += M[head.waves + W_AMPLITUDE * head.wave_count + n] ** 2
    crest = 2.0 * math.sqrt(0.5 * square)  # half of hs, of a wave 1.4 a
    changed = NOTHING
    node = head.nodes - 1  # from the last one on: halves go where the whole one went
    while node >= 1:
        if I[head.joint + node] == JOINT_NONE and not is_counted(I, M, node):
            edge = edge_of(I, M, node)
            first = M[head.position + 6 * I[head.parent + node] + 2]
            last = M[head.position + 6 * node + 2]
            low, high = min(first, last), max(first, last)
            line = int(cable_of(I, M, int(edge.segment)).row)
            accuracy = state.tolerance * length_in(words, line)
            tallest = max(TALLEST[0] * crest, TALLEST[1] * accuracy)
            is_too_tall = low < crest and high > -crest and high - low > tallest
            if (
                state.wave_number * high >= -math.pi
                and (state.wave_number * edge.length > 1.0 or is_too_tall)
                and may_be_halved(I, M, node)
            ):
                if halve_for_good(I, M, node) != OK:
                    return NO_CAPACITY
                state.most_nodes += REFINEMENT_SPARE[1]
                changed = CHANGED
        node -= 1
    return changed


@kernel
def place_on_shape(I, M, words):
    """A system along its first shape, on elements that are short enough for its waves. OK, or
    NO_CAPACITY: the block must grow, and this be called again."""
    found = CHANGED
    while found == CHANGED:
        place_nodes(I, M, words)
        found = NOTHING if header(I).wave_count == 0 else halve_in_waves(I, M, words)
    if found == NO_CAPACITY:
        return found
    if header(I).wave_count != 0:
        size_cables(I, M)
    return OK
