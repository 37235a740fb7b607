"""What follows from the lengths of cables: what a run is measured by, how cables pass winches.

Of a scene as it is built, and of an FMU whose lengths are set before the start: elements keep their
number then, and each is as many times longer as its cable. `lengths`: rows of CableLength.
"""

import math

from cablemodel.solvers.finite_element.kernels.element import scales
from cablemodel.solvers.finite_element.kernels.element.tables import (
    BRISTLE,
    DEPTH,
    ELEMENT_RIGID,
    STABILISATION,
)
from cablemodel.solvers.shared.access import (
    body_of,
    cable_length_at,
    cable_of,
    constraint_of,
    edge_of,
    header,
    line_facts_at,
    scalars,
    winch_of,
    word_of,
)
from cablemodel.solvers.shared.compile import inlined, kernel
from cablemodel.solvers.shared.layout import (
    BY_SPRING,
    FLOOR_NONE,
    JOINT_NONE,
    LENGTH_WORDS,
    Constraint,
)
from cablemodel.solvers.shared.numbers import SHORTEST_LINE, TAKES_OFF

SHORTEST_PIECE = 0.01  # of an element: cable out before the joint below it leaves the drum
# Of a body of finite length: cable that must be out before the body leaves the tow point.
WINCH_FIRST_PIECE = 0.02
LEAST_PIECE = 1e-3  # of an element: the same where the body is short
BODY_SOFTEST = 3e-5  # largest axial compliance of a body of finite length, of that of the line
SPRING_FIRST, SPRING_LAST = Constraint.spring.word, Constraint.drift_rate.word + 2


@inlined
def row_at(lengths, n):
    """The n-th row."""
    return cable_length_at(lengths, LENGTH_WORDS * n)


@inlined
def count_of(lengths):
    """How many rows there are."""
    return len(lengths) // LENGTH_WORDS


@kernel
def length_out(lengths, line, before):
    """Length of a line's cables that are out, from now on or before [m]."""
    total = 0.0
    for n in range(count_of(lengths)):
        row = row_at(lengths, n)
        if row.winch < 0.0 and row.line == line:
            total += row.before if before else row.length
    return total


@kernel
def change(lengths):
    """Whether some length changes."""
    for n in range(count_of(lengths)):
        row = row_at(lengths, n)
        if row.length != row.before:
            return True
    return False


@kernel
def first_of(lengths, cable):
    """The first row of a cable of the cable table: out before on a drum; -1: there is none."""
    for n in range(count_of(lengths)):
        if row_at(lengths, n).row == cable:
            return n
    return -1


@kernel
def growth_of(lengths, cable):
    """By how much elements of a cable get longer, one with all."""
    n = first_of(lengths, cable)
    if n < 0:
        return 1.0
    row = row_at(lengths, n)
    return row.length / row.before


# -- what a run is measured by ---------------------------------------------------------------------


@kernel
def softness_of(lengths, line):
    """Of a line's cables that are out [m/N]."""
    total = 0.0
    for n in range(count_of(lengths)):
        row = row_at(lengths, n)
        if row.winch < 0.0 and row.line == line:
            total += row.softness * row.length
    return total


@kernel
def add_up(lengths, words, together):
    """Complete LineFacts, whose mass and tension are those at the scene's lengths; together: of a
    system, whose are those without its cables, so that the same lengths have the same ones."""
    facts = line_facts_at(words, 0)
    facts.length = 0.0
    facts.shortest = math.inf
    facts.damping = math.inf
    facts.softness = 0.0
    lines = 0
    for n in range(count_of(lengths)):
        row = row_at(lengths, n)
        lines = max(lines, 1 + int(row.line))
        if row.winch < 0.0:
            more = row.length if together else row.length - row.first
            facts.mass += row.mass * more
            facts.tension += row.tension * more
    for line in range(lines):
        drag = 0.0
        mass = 0.0
        for n in range(count_of(lengths)):
            row = row_at(lengths, n)
            if row.winch < 0.0 and row.line == line:
                drag += row.drag * row.length
                mass += row.mass * row.length
        length = length_out(lengths, line, False)
        facts.length = max(facts.length, length)
        facts.shortest = min(facts.shortest, length)
        facts.damping = min(facts.damping, drag * length / mass)
        facts.softness = max(facts.softness, softness_of(lengths, line))


@kernel
def bend_flexible(I, M, longer):
    """What perfectly flexible cable bends by where it is slack over a floor, as
    start/sea_floor.least_bending has it of lines so many times as long."""
    head = header(I)
    density = scalars(M).water_density
    for n in range(1, head.nodes + head.cable_count):
        edge = edge_of(I, M, n) if n < head.nodes else cable_of(I, M, n - head.nodes).edge
        if edge.flexible == 0.0 or not edge.bending_full > 0.0:
            continue
        thick = 0.0
        if density > 0.0:
            displaced = cable_of(I, M, int(edge.segment)).displaced
            thick = math.sqrt(displaced / (density * 0.25 * math.pi))
        layer = (edge.bending_full / edge.contact) ** (1.0 / 3.0)
        edge.bending_full = edge.contact * max(layer * longer, thick) ** 3
        edge.bending = edge.bending_full


@kernel
def measure(I, M, lengths, words):
    """Write what follows from the lengths of lines as a whole: LineFacts, and the scalars that
    scales.measure_line makes of them; of a system that has a floor, what its contact goes by."""
    head = header(I)
    state = scalars(M)
    before = state.length
    add_up(lengths, words, head.parts != 0)
    scales.measure_line(I, M, words)
    if head.parts != 0 and head.floor_kind != FLOOR_NONE and before > 0.0:
        bend_flexible(I, M, state.length / before)
        state.floor_depth = DEPTH * state.tolerance * state.length
        state.bristle = BRISTLE * (state.tolerance * state.length)
        if state.landing_damping > state.floor_damping:
            speed = math.sqrt(2.0 * state.gravity * (state.tolerance * state.length))
            landing = TAKES_OFF * speed / (state.gravity * state.floor_depth)
            state.landing_damping = max(state.floor_damping, landing)


# -- tables ----------------------------------------------------------------------------------------


@kernel
def forget_stabilisation(I, M):
    """Every element as it is before tensions are known."""
    head = header(I)
    state = scalars(M)
    state.third_mode = STABILISATION * state.tension_scale
    for n in range(1, head.nodes + head.cable_count):
        edge = edge_of(I, M, n) if n < head.nodes else cable_of(I, M, n - head.nodes).edge
        if edge.compliance > 0.0:
            edge.stabilisation = min(state.third_mode, 1.0 / edge.compliance)


@kernel
def begin_clamps(I, M, lengths):
    """Clamps and stiff bodies of a line alone, as they are before tensions are known."""
    head = header(I)
    state = scalars(M)
    typical = state.tension_scale
    softest = BODY_SOFTEST * softness_of(lengths, 0)
    state.clamp_tension = typical
    for n in range(head.body_count):
        body = body_of(I, M, n)
        if body.length == 0.0:
            continue
        for side in range(2):
            body.clamp_tension[side] = typical
            body.clamp[side] = 0.0
        if body.tie != 0.0:
            body.tie = typical * body.length
        body.compliance = min(body.length / (ELEMENT_RIGID * typical), softest)
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        if row.clamped == BY_SPRING:
            start = word_of(M, row)
            for k in range(SPRING_FIRST, SPRING_LAST + 1):
                M[start + k] = 0.0


@kernel
def body_below(I, M, index):
    """Length of the body at the lower end of a cable of the cable table [m]; 0: none, a point."""
    body = int(cable_of(I, M, index).body)
    if body < 0:
        return 0.0
    return body_of(I, M, body).length


@kernel
def arrange_cables(I, M, lengths):
    """How long the elements of cables are, and what of each is out before what is below it leaves
    the winch. Cable on a drum comes in the line's mean length, unless the scene counts its own."""
    for index in range(header(I).cable_count):
        cable = cable_of(I, M, index)
        n = first_of(lengths, index)
        whole = math.inf
        if n >= 0:
            row = row_at(lengths, n)
            if row.winch < 0.0 or row.counted != 0.0:
                cable.nominal *= row.length / row.before
            else:
                after = length_out(lengths, row.line, False)
                cable.nominal *= after / length_out(lengths, row.line, True)
            whole = 0.0
            for k in range(count_of(lengths)):
                if row_at(lengths, k).row == index:
                    whole += row_at(lengths, k).length
        cable.edge.nominal = cable.nominal
        cable.shortest = SHORTEST_PIECE * min(cable.nominal, whole)
        body = body_below(I, M, index)
        if body > 0.0:
            least = max(WINCH_FIRST_PIECE * body, LEAST_PIECE * cable.nominal)
            cable.shortest = min(cable.shortest, least)


@kernel
def arrange_winch(I, M, lengths):
    """The cables of a line alone as they pass the tow point: where each leaves, how far reel-in and
    drum go."""
    winch = winch_of(I, M, 0)
    count = count_of(lengths)
    line = length_out(lengths, 0, False)
    above = 0.0
    out = 0
    while out < count and row_at(lengths, out).winch < 0.0:
        row = row_at(lengths, out)
        cable_of(I, M, int(row.row)).leaves = -above
        above += row.length + body_below(I, M, int(row.row))
        out += 1
    left = SHORTEST_LINE * line  # at the end of reel-in, with the bodies that are beyond
    reeled = 0.0
    for n in range(out - 1, -1, -1):
        row = row_at(lengths, n)
        if left <= 0.0:
            reeled += body_below(I, M, int(row.row))
        left -= row.length
    most = 0.0
    travel = 0.0
    last = row_at(lengths, 0).row
    for n in range(out, count):
        row = row_at(lengths, n)
        if row.row != last:
            travel += body_below(I, M, int(row.row))
        last = row.row
        travel += row.length
        most += row.length
        cable_of(I, M, int(row.row)).leaves = travel
    winch.top_length = edge_of(I, M, 1).length
    winch.paid_most = most
    winch.travel_most = travel
    winch.travel_least = -reeled - (1.0 - SHORTEST_LINE) * line


@kernel
def arrange_winches(I, M, lengths):
    """Winches of a system: where each is, how far reel-in and drum go."""
    head = header(I)
    for n in range(head.winch_count):
        winch = winch_of(I, M, n)
        passes = cable_of(I, M, int(winch.cable))
        node = int(winch.node)
        top = edge_of(I, M, node + 1 if winch.way > 0.0 else node)
        out = 0.0
        for k in range(1, head.nodes):
            if I[head.joint + k] != JOINT_NONE:
                continue
            edge = edge_of(I, M, k)
            if cable_of(I, M, int(edge.segment)).chain == passes.chain:
                out += edge.length
        drum = 0.0
        for k in range(count_of(lengths)):
            if row_at(lengths, k).winch == n:
                drum += row_at(lengths, k).length
        winch.start = top.start if winch.way > 0.0 else top.start + top.length
        winch.top_length = top.length
        winch.travel_most = drum
        winch.paid_most = drum
        winch.shortest = SHORTEST_LINE * length_out(lengths, passes.row, False)
        winch.paid_least = min(0.0, winch.shortest - out)
        winch.travel_least = winch.paid_least


@kernel
def arrange_lines(I, M, lengths):
    """What cables of a system go by: their line's length, and the least of its largest tension."""
    for index in range(header(I).cable_count):
        cable = cable_of(I, M, index)
        cable.line = length_out(lengths, cable.row, False)
        cable.tension = 0.0
        for n in range(count_of(lengths)):
            row = row_at(lengths, n)
            if row.winch < 0.0 and row.line == cable.row:
                cable.tension += row.tension * row.length


@kernel
def arrange(I, M, lengths):
    """Cables, winches and clamps for lines of these lengths, whose elements have theirs."""
    arrange_cables(I, M, lengths)
    if header(I).parts == 0:
        arrange_winch(I, M, lengths)
        begin_clamps(I, M, lengths)
    else:
        arrange_lines(I, M, lengths)
        arrange_winches(I, M, lengths)
