"""Pay-out and reel-in: cable passes the tow point, the top element's length varies with it.

All nodes but the vessel's are material points; the mesh moves along the cable in the top element
only. A material point that passes the tow point sees d/dt + v_p d/ds, so the material velocity and
acceleration of the top element are cubics again, with the Hermite data at the vessel's end

    v   = r_t + v_p r',              v'  = r'_t + v_p r''
    a   = r_tt + 2 v_p r'_t + v_p_dot r' + v_p^2 r''
    a'  = r'_tt + 2 v_p (r'')_t + v_p_dot r'' + v_p^2 r'''

(Sun & Leonard 1998, eq. 16, with the factors of stretch that it lacks). With these in place of
the nodal rates the element is computed like any other one. Elements are split and joined between
steps; splitting a cubic is exact, in position, velocity, acceleration and tension.
"""

from cablemodel.solvers.finite_element.kernels.element.cubic import bend_at_begin
from cablemodel.solvers.finite_element.kernels.element.scales import least_stiffness
from cablemodel.solvers.finite_element.kernels.element.strain import is_limp, tensions_of_both
from cablemodel.solvers.finite_element.kernels.element.stretch import (
    join_rests,
    rest_as_stretched,
    split_rests,
    split_third,
    splitting_tears,
    take_in_rest,
)
from cablemodel.solvers.finite_element.kernels.floor.contact import linear_along
from cablemodel.solvers.finite_element.kernels.mesh.body_passage import (
    cable_paid,
    material_end,
    overhang,
    set_first_bit,
    set_part,
)
from cablemodel.solvers.finite_element.kernels.mesh.winch import out_of, paid_since
from cablemodel.solvers.finite_element.kernels.time.backup import keep_sleepers
from cablemodel.solvers.shared.access import (
    arm_of,
    body_of,
    cable_of,
    closure_of,
    constraint_of,
    edge_of,
    free_body_of,
    header,
    matter_of,
    scalars,
    tension_at,
    tension_of,
    tension_rate_of,
    vector,
    winch_of,
    word_of,
)
from cablemodel.solvers.shared.compile import inlined, kernel, own_numbers, view
from cablemodel.solvers.shared.layout import (
    EDGE_WORDS,
    EXACTLY,
    NO_CAPACITY,
    OK,
    TENSION_WORDS,
    WHOLLY,
    Matter,
)

VELOCITY, ACCELERATION = Matter.velocity.word, Matter.acceleration.word

place_and_slope = own_numbers(6)
"""place_and_slope(): zeros, r and d of a node, or their rates, (2, dimension)."""


@inlined
def top_edge(winch):
    """The element next to a winch, by its node."""
    return int(winch.node) + (1 if winch.way > 0.0 else 0)


@kernel
def next_cable(I, M, winch, way):
    """Row of the cable that follows on what passes a winch: OFF_THE_DRUM or ALONG_THE_LINE; -1:
    none does."""
    cable = int(winch.cable)
    row = cable + way * int(winch.off_drum)
    if row < 0 or row >= header(I).cable_count:
        return -1
    return row if cable_of(I, M, row).chain == cable_of(I, M, cable).chain else -1


@kernel
def out_of_joint(I, M, winch, other):
    """How far the joint of the cable that passes and its neighbour in a row is out [m]."""
    return out_of(winch, cable_of(I, M, min(int(winch.cable), other)).leaves)


@inlined
def joint_to(I, M, winch, other):
    """The row that says what their joint is like."""
    return cable_of(I, M, max(int(winch.cable), other))


@kernel
def winch_of_edge(I, M, edge):
    """The winch whose top element that is; -1: none."""
    for n in range(header(I).winch_count):
        winch = winch_of(I, M, n)
        if winch.node >= 0.0 and top_edge(winch) == edge:
            return n
    return -1


@kernel
def set_top_length(I, M, t):
    """Lengths of top elements, or of what is out of a body there, and rates at time t."""
    head = header(I)
    tau = t - scalars(M).time
    for n in range(head.winch_count):
        winch = winch_of(I, M, n)
        if winch.node < 0.0:
            continue
        length = winch.top_length + paid_since(winch, tau)
        if winch.passing_body != 0.0:
            set_part(I, M, length)
        else:
            edge_of(I, M, top_edge(winch)).length = length
            if head.rigid > 0:
                set_first_bit(I, M, length - winch.top_length)
        winch.stage_rate = winch.rate + winch.slope * tau
        winch.stage_slope = winch.slope


@kernel
def pay_out(I, M, dt):
    """After a step of dt: what has passed the winches, and their rates at its end."""
    head = header(I)
    for n in range(head.winch_count):
        winch = winch_of(I, M, n)
        if winch.node < 0.0:
            continue
        paid = paid_since(winch, dt)
        if paid < 0.0 < winch.top_length:
            take_in_rest(edge_of(I, M, top_edge(winch)), 1.0 + paid / winch.top_length)
        winch.travel += paid
        winch.paid = cable_paid(I, M, n)
        winch.top_length += paid
        winch.rate += winch.slope * dt
        if head.parts != 0:
            edge = edge_of(I, M, top_edge(winch))
            edge.length = winch.top_length
            if winch.way > 0.0:
                edge.start = winch.start - winch.paid
        for other in range(head.winch_count):
            at_other_end = winch_of(I, M, other)
            if other == n or at_other_end.node < 0.0:
                continue
            chain = cable_of(I, M, int(at_other_end.cable)).chain
            if cable_of(I, M, int(winch.cable)).chain == chain:
                at_other_end.travel_least -= paid  # what one pays out another may take in


@kernel
def material_top(I, M, q, v, a):
    """Velocity and acceleration of the matter at winches' nodes into Matter."""
    for n in range(header(I).winch_count):
        winch = winch_of(I, M, n)
        if winch.passing_body != 0.0:
            material_end(I, M, q, v, a)
        elif winch.node >= 0.0:
            material_at(I, M, n, q, v, a)


@kernel
def material_at(I, M, n, q, v, a):
    """Those of one. Slopes are counted away from the winch, whichever way the tree goes."""
    head = header(I)
    winch = winch_of(I, M, n)
    dimension = head.dimension
    size = 2 * dimension
    matter = matter_of(I, M, n)
    rate = winch.stage_rate
    slope = winch.stage_slope
    edge = top_edge(winch)
    way = winch.way
    near = size * int(winch.node)
    far = size * (edge if way > 0.0 else I[head.parent + edge])
    h = edge_of(I, M, edge).length
    ih = 1.0 / h
    for i in range(dimension):
        r0 = q[near + i]
        d0 = way * q[near + dimension + i]
        r1 = q[far + i]
        d1 = way * q[far + dimension + i]
        second = bend_at_begin(6.0 * (r1 - r0) * ih, d0, d1) * ih
        third = (12.0 * (r0 - r1) * ih + 6.0 * d0 + 6.0 * d1) * ih * ih
        v0 = v[near + i]
        w0 = way * v[near + dimension + i]
        v1 = v[far + i]
        w1 = way * v[far + dimension + i]
        # Time derivative of r''(0): h grows at the rate, which acts on the difference of r only.
        second_rate = bend_at_begin(6.0 * (v1 - v0) * ih, w0, w1) * ih
        second_rate -= rate * ih * bend_at_begin(12.0 * (r1 - r0) * ih, d0, d1) * ih
        matter.velocity[i] = v0 + rate * d0
        matter.velocity[dimension + i] = way * (w0 + rate * second)
        acceleration = a[near + i] + 2.0 * rate * w0 + slope * d0 + rate * rate * second
        matter.acceleration[i] = acceleration
        turning = way * a[near + dimension + i]
        matter.acceleration[dimension + i] = way * (
            turning + 2.0 * rate * second_rate + slope * second + rate * rate * third
        )


@kernel
def material_motion(I, M):
    """`material_top` of the state itself."""
    head = header(I)
    count = 2 * head.dimension * head.nodes
    set_top_length(I, M, scalars(M).time)
    material_top(
        I,
        M,
        view(M, head.position, count),
        view(M, head.velocity, count),
        view(M, head.acceleration, count),
    )


@kernel
def matter_words(I, M, n):
    """Words of velocity and acceleration of the matter at a winch."""
    first = word_of(M, matter_of(I, M, n))
    return first + VELOCITY, first + ACCELERATION


@kernel
def rate_words(I, M, node):
    """Words of velocity and acceleration of the cable at a node: at a winch past which cable may
    run those of the matter, which `material_top` has written."""
    head = header(I)
    if head.payout != 0:
        for n in range(head.winch_count):
            if winch_of(I, M, n).node == node:
                return matter_words(I, M, n)
    at = 2 * head.dimension * node
    return head.velocity + at, head.acceleration + at


@kernel
def turn_with_matter(I, M, n, rate, second):
    """Make the slope at a winch one whose matter turns at `rate` and `second` (dimension).

    The mesh's own rates differ from these by what flows past, v_p r'' and more: another top
    element at the same place has another r'', so that rates kept from before would be a jump of
    the matter's velocity, which grew with every joined element where v_p is near the waves' speed.
    """
    head = header(I)
    dimension = head.dimension
    matter = matter_of(I, M, n)
    slope = 2 * dimension * int(winch_of(I, M, n).node) + dimension
    for array in range(2):
        # The accelerations need the velocities.
        material_motion(I, M)
        to = (head.velocity if array == 0 else head.acceleration) + slope
        wanted = rate if array == 0 else second
        present = matter.velocity if array == 0 else matter.acceleration
        for i in range(dimension):
            off = wanted[i] - present[dimension + i]
            M[to + i] += off


@kernel
def move_node(I, M, node, to):
    """Copy all that belongs to a node and to the element above it to another place."""
    head = header(I)
    size = 2 * head.dimension
    for k in range(size):
        M[head.position + size * to + k] = M[head.position + size * node + k]
        M[head.velocity + size * to + k] = M[head.velocity + size * node + k]
        M[head.acceleration + size * to + k] = M[head.acceleration + size * node + k]
        M[head.rest + size * to + k] = M[head.rest + size * node + k]
    for array in range(2):
        tensions = head.tension if array == 0 else head.tension_rate
        there = tension_at(M, tensions + TENSION_WORDS * to)
        here = tension_at(M, tensions + TENSION_WORDS * node)
        there.mean = here.mean
        there.slope = here.slope
    for k in range(EDGE_WORDS):
        M[head.edges + EDGE_WORDS * to + k] = M[head.edges + EDGE_WORDS * node + k]
    I[head.joint + to] = I[head.joint + node]


@kernel
def open_gap(I, M, at, count):
    """Move nodes from `at` on by `count` places and renumber all that points to them."""
    head = header(I)
    keep_sleepers(I)
    for node in range(head.nodes + head.left_out - 1, at - 1, -1):
        move_node(I, M, node, node + count)
    renumber(I, M, at, count)


@kernel
def close_gap(I, M, at, count):
    """Remove nodes at ... at + count - 1."""
    head = header(I)
    keep_sleepers(I)
    for node in range(at + count, head.nodes + head.left_out):
        move_node(I, M, node, node - count)
    renumber(I, M, at + count, -count)


@kernel
def renumber_tree(I, M, first, count):
    """The same for parents in a tree, free bodies and arms; `nodes` counts the new nodes.

    Nodes that come take the parent of that before which they come; to nodes that go, whatever had
    them as parents gets the node before them.
    """
    head = header(I)
    parents = view(I, head.parent, head.nodes + max(0, -count))
    if count > 0:
        for node in range(head.nodes - 1, first + count - 1, -1):
            parent = parents[node - count]
            parents[node] = parent + count if parent >= first else parent
        for node in range(first, min(first + count + 1, head.nodes)):
            parents[node] = node - 1
    else:
        for node in range(first + count, head.nodes):
            parent = parents[node - count]
            if parent >= first:
                parent += count
            parents[node] = min(parent, node - 1)
    for n in range(head.free_count):
        row = free_body_of(I, M, n)
        if row.node >= first:
            row.node += count
    for n in range(head.arm_count):
        arm = arm_of(I, M, n)
        if arm.node >= first:
            arm.node += count


@kernel
def renumber(I, M, first, count):
    """Node numbers >= first change by count, in bodies, constraints, parts and parents.

    Within a line a node's parent is the node before it; one line is such a chain as a whole.
    """
    head = header(I)
    for body in range(head.body_count):
        row = body_of(I, M, body)
        if row.node >= first:
            row.node += count
        elif row.node < -1.0:
            row.node -= count  # asleep, see sleep.py
    for n in range(head.constraint_count):
        end = constraint_of(I, M, n)
        if end.node >= first:
            end.node += count
    for n in range(head.winch_count):
        winch = winch_of(I, M, n)
        if winch.node >= first:
            winch.node += count
    for n in range(head.closure_count):
        closure = closure_of(I, M, n)
        if closure.node >= first:
            closure.node += count
        if closure.other >= first:
            closure.other += count
    head.nodes += count
    if head.parts != 0:
        renumber_tree(I, M, first, count)
    else:
        for node in range(1, head.nodes + head.left_out):
            I[head.parent + node] = node - 1
    head.factored = 0
    head.has_history = 0


@kernel
def hermite(M, p0, p1, dimension, h, x, value, slope):
    """Value and derivative at x of the cubic with data (r, d) at words p0 and p1."""
    y = 1.0 - x
    for i in range(dimension):
        a = M[p0 + i]
        b = M[p0 + dimension + i]
        c = M[p1 + i]
        d = M[p1 + dimension + i]
        value[i] = y * y * (1.0 + 2.0 * x) * a + h * x * y * y * b
        value[i] += x * x * (3.0 - 2.0 * x) * c - h * x * x * y * d
        slope[i] = -6.0 * x * y / h * (a - c) + y * (1.0 - 3.0 * x) * b
        slope[i] += x * (3.0 * x - 2.0) * d


@kernel
def at_fraction(M, p0, p1, dimension, h, x, out):
    """The same, as the data (r, d) of a node there."""
    hermite(M, p0, p1, dimension, h, x, view(out, 0, dimension), view(out, dimension, dimension))


@inlined
def split_rest(I, M, above, below, h, x, place, rest):
    """What is at rest at a place between two nodes, and its slope, into `rest`. The bristle stays
    as it was there."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    at = (head.position + size * above, head.position + size * below)
    ends = (head.rest + size * above, head.rest + size * below)
    at_fraction(M, ends[0], ends[1], dimension, h, x, rest)
    bristle = vector()
    for i in range(dimension):
        bristle[i] = place[i] - rest[i]
    linear_along(M, M, at, ends, x, bristle, vector(), dimension)
    for i in range(dimension):
        rest[i] = place[i] - bristle[i]


@kernel
def split_edge(I, M, edge, x, hinge):
    """Split an element at a fraction x from its parent end by one node, or by a hinge (two).

    All fields stay as they were, exactly. The new elements have the old one's properties.
    """
    head = header(I)
    count = 2 if hinge else 1
    if head.nodes + head.left_out + count > head.capacity:
        return NO_CAPACITY
    dimension = head.dimension
    size = 2 * dimension
    row = edge_of(I, M, edge)
    h = row.length
    p = I[head.parent + edge]
    v0 = head.velocity + size * p
    v1 = head.velocity + size * edge
    a0 = head.acceleration + size * p
    a1 = head.acceleration + size * edge
    top = winch_of_edge(I, M, edge)
    if top >= 0:
        material_motion(I, M)
        if winch_of(I, M, top).way > 0.0:
            v0, a0 = matter_words(I, M, top)
        else:
            v1, a1 = matter_words(I, M, top)
    q = place_and_slope()
    v = place_and_slope()
    a = place_and_slope()
    rest = place_and_slope()
    at_fraction(M, head.position + size * p, head.position + size * edge, dimension, h, x, q)
    at_fraction(M, v0, v1, dimension, h, x, v)
    at_fraction(M, a0, a1, dimension, h, x, a)
    split_rest(I, M, p, edge, h, x, q, rest)
    open_gap(I, M, edge, count)
    lower = edge + count
    for node in range(edge, lower):
        for k in range(size):
            M[head.position + size * node + k] = q[k]
            M[head.velocity + size * node + k] = v[k]
            M[head.acceleration + size * node + k] = a[k]
            M[head.rest + size * node + k] = rest[k]
        for k in range(EDGE_WORDS):
            M[head.edges + EDGE_WORDS * node + k] = M[head.edges + EDGE_WORDS * lower + k]
        tension_of(I, M, node).mean = 0.0
        tension_of(I, M, node).slope = 0.0
        tension_rate_of(I, M, node).mean = 0.0
        tension_rate_of(I, M, node).slope = 0.0
        I[head.joint + node] = 0
    if hinge:
        I[head.joint + edge + 1] = 1
        edge_of(I, M, edge + 1).length = 0.0
        edge_of(I, M, edge + 1).start += x * h
    for array in range(2):
        t = head.tension if array == 0 else head.tension_rate
        before = tension_at(M, t + TENSION_WORDS * edge)
        beyond = tension_at(M, t + TENSION_WORDS * lower)
        mean = beyond.mean
        slope = beyond.slope
        before.mean = mean + slope * (x - 1.0)
        before.slope = slope * x
        beyond.mean = mean + slope * x
        beyond.slope = slope * (1.0 - x)
    edge_of(I, M, edge).length = x * h
    edge_of(I, M, lower).length = h - x * h
    edge_of(I, M, lower).start += x * h
    edge_of(I, M, edge).third_rest *= x * x
    edge_of(I, M, lower).third_rest *= (1.0 - x) * (1.0 - x)
    split_rests(I, M, edge, lower, x)
    if top >= 0:
        winch = winch_of(I, M, top)
        winch.top_length = edge_of(I, M, top_edge(winch)).length
        if winch.way > 0.0:
            # The lower part begins where the cable is that is out now, less the new top element.
            start = winch.start + x * h - overhang(I, M) - winch.paid
            edge_of(I, M, lower).start = start
            if hinge:
                edge_of(I, M, edge + 1).start = start
    return OK


@kernel
def split_as_stretched(I, M, edge, x):
    """Split an element in two that rest as they are stretched, where that would become tension. OK
    or NO_CAPACITY."""
    tears, third = splitting_tears(I, M, edge)
    status = split_edge(I, M, edge, x, False)
    if status == OK and tears:
        split_third(I, M, edge, edge + 1, x, third)
        rest_as_stretched(I, M, edge)
        rest_as_stretched(I, M, edge + 1)
    return status


@kernel
def split_element(I, M, edge, x):
    """Split an element in two, where waves run, and at a winch that pays out, as it is stretched.
    Not where nothing damps a line: there its third mode rings. OK or NO_CAPACITY."""
    top = winch_of_edge(I, M, edge)
    keeps = header(I).axial_waves != 0 or (top >= 0 and winch_of(I, M, top).rate > 0.0)
    if keeps and scalars(M).undamped == 0.0:
        return split_as_stretched(I, M, edge, x)
    return split_edge(I, M, edge, x, False)


@kernel
def slope_is_held(I, M, node):
    """Whether the slope at a node is prescribed."""
    for n in range(header(I).constraint_count):
        row = constraint_of(I, M, n)
        if row.node == node and row.clamped in (EXACTLY, WHOLLY):
            return True
    return False


@kernel
def join_at(I, M, node, count):
    """Remove an inner node (count 1) or a hinge (count 2): its two elements become one.

    What the merged cubic cannot hold is lost; the caller makes the state consistent.
    """
    head = header(I)
    state = scalars(M)
    upper = node
    lower = node + count
    h1 = edge_of(I, M, upper).length
    h2 = edge_of(I, M, lower).length
    h = h1 + h2
    dimension = head.dimension
    winch = winch_of_edge(I, M, upper)
    if winch < 0:
        winch = winch_of_edge(I, M, lower)
    turn = vector()
    turn_rate = vector()
    if winch >= 0:
        material_motion(I, M)
        matter = matter_of(I, M, winch)
        for i in range(dimension):
            turn[i] = matter.velocity[dimension + i]
            turn_rate[i] = matter.acceleration[dimension + i]
    start = edge_of(I, M, upper).start
    aside = is_limp(edge_of(I, M, lower))
    both0 = 0.0
    both1 = 0.0
    if aside:
        both0, both1 = tensions_of_both(I, M, upper, lower)
    for array in range(2):
        t = head.tension if array == 0 else head.tension_rate
        before = tension_at(M, t + TENSION_WORDS * upper)
        both = tension_at(M, t + TENSION_WORDS * lower)
        top = before.mean - before.slope
        bottom = both.mean + both.slope
        both.mean = (h1 * before.mean + h2 * both.mean) / h
        both.slope = 0.5 * (bottom - top)
    if aside:
        tension_of(I, M, lower).mean = both0
        tension_of(I, M, lower).slope = both1
    edge_of(I, M, lower).start = start
    edge_of(I, M, lower).stabilisation = least_stiffness(M, edge_of(I, M, lower))
    edge_of(I, M, lower).third_rest = 0.0
    join_rests(I, M, upper, lower)
    edge_of(I, M, lower).length = h
    close_gap(I, M, node, count)
    if winch >= 0:
        winch_of(I, M, winch).top_length = h
        if not slope_is_held(I, M, int(winch_of(I, M, winch).node)):
            turn_with_matter(I, M, winch, turn, turn_rate)
    state.joined = max(state.joined, h)


@kernel
def give_properties(I, M, edge, cable):
    """Make an element one of another cable: all of the row but its length, place and rest."""
    row = edge_of(I, M, edge)
    h = row.length
    start = row.start
    stretch = row.stretch_rest
    moment = row.moment_rest
    for k in range(EDGE_WORDS):
        M[word_of(M, row) + k] = M[word_of(M, cable_of(I, M, cable).edge) + k]
    row.length = h
    row.start = start
    row.stretch_rest = stretch
    row.moment_rest = moment
