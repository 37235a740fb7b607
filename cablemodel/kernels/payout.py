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

from .access import (
    arm_of,
    body_of,
    cable_of,
    constraint_of,
    edge_of,
    free_body_of,
    header,
    scalars,
    word_of,
)
from .backup import keep_sleepers
from .compile import kernel, view
from .layout import (
    EDGE_WORDS,
    EXACTLY,
    NO_CAPACITY,
    OK,
)
from .passing import material_end, overhang, set_first_bit, set_part
from .winch import paid_since


@kernel
def set_top_length(I, M, t):
    """Length of the top element, or of what is out of a body there, and the rate at time t."""
    head = header(I)
    state = scalars(M)
    tau = t - state.time
    length = state.top_length + paid_since(M, tau)
    if state.body_passage != 0.0:
        set_part(I, M, length)
    else:
        edge_of(I, M, 1).length = length
        if head.rigid > 0:
            set_first_bit(I, M, length - state.top_length)
    state.stage_rate = state.payout_rate + state.payout_slope * tau
    state.stage_slope = state.payout_slope


@kernel
def material_top(I, M, q, v, a):
    """Material velocity and acceleration of the vessel's node into the `top` words (12)."""
    head = header(I)
    state = scalars(M)
    if state.body_passage != 0.0:
        material_end(I, M, q, v, a)
        return
    dimension = head.dimension
    size = 2 * dimension
    out = head.top
    rate = state.stage_rate
    slope = state.stage_slope
    h = edge_of(I, M, 1).length
    ih = 1.0 / h
    for i in range(dimension):
        r0 = q[i]
        d0 = q[dimension + i]
        r1 = q[size + i]
        d1 = q[size + dimension + i]
        second = (6.0 * (r1 - r0) * ih - 4.0 * d0 - 2.0 * d1) * ih
        third = (12.0 * (r0 - r1) * ih + 6.0 * d0 + 6.0 * d1) * ih * ih
        v0 = v[i]
        w0 = v[dimension + i]
        v1 = v[size + i]
        w1 = v[size + dimension + i]
        # Time derivative of r''(0): h grows at the rate, which acts on the difference of r only.
        second_rate = (6.0 * (v1 - v0) * ih - 4.0 * w0 - 2.0 * w1) * ih
        second_rate -= rate * ih * (12.0 * (r1 - r0) * ih - 4.0 * d0 - 2.0 * d1) * ih
        M[out + i] = v0 + rate * d0
        M[out + dimension + i] = w0 + rate * second
        M[out + 6 + i] = a[i] + 2.0 * rate * w0 + slope * d0 + rate * rate * second
        M[out + 6 + dimension + i] = (
            a[dimension + i] + 2.0 * rate * second_rate + slope * second + rate * rate * third
        )


@kernel
def material_motion(I, M):
    """`material_top` of the state itself."""
    head = header(I)
    state = scalars(M)
    size = 2 * head.dimension
    set_top_length(I, M, state.time)
    material_top(
        I,
        M,
        M[head.position : head.position + 2 * size],
        M[head.velocity : head.velocity + 2 * size],
        M[head.acceleration : head.acceleration + 2 * size],
    )


@kernel
def turn_with_matter(I, M, rate, second):
    """Make the vessel's slope one whose matter turns at `rate` and `second` (dimension).

    The mesh's own rates differ from these by what flows past, v_p r'' and more: another top
    element at the same place has another r'', so that rates kept from before would be a jump of
    the matter's velocity, which grew with every joined element where v_p is near the waves' speed.
    """
    head = header(I)
    dimension = head.dimension
    for array in range(2):
        # The accelerations need the velocities.
        material_motion(I, M)
        to = head.velocity if array == 0 else head.acceleration
        wanted = rate if array == 0 else second
        for i in range(dimension):
            off = wanted[i] - M[head.top + 6 * array + dimension + i]
            M[to + dimension + i] += off


@kernel
def move_node(I, M, node, to):
    """Copy all that belongs to a node and to the element above it to another place."""
    head = header(I)
    size = 2 * head.dimension
    for k in range(size):
        M[head.position + size * to + k] = M[head.position + size * node + k]
        M[head.velocity + size * to + k] = M[head.velocity + size * node + k]
        M[head.acceleration + size * to + k] = M[head.acceleration + size * node + k]
    for k in range(3):
        M[head.rest + 3 * to + k] = M[head.rest + 3 * node + k]
    for k in range(2):
        M[head.tension + 2 * to + k] = M[head.tension + 2 * node + k]
        M[head.tension_rate + 2 * to + k] = M[head.tension_rate + 2 * node + k]
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
        for node in range(first, first + count + 1):
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
    head.nodes += count
    if head.parts != 0:
        renumber_tree(I, M, first, count)
    else:
        for node in range(1, head.nodes + head.left_out):
            I[head.parent + node] = node - 1
    head.factored = 0
    head.has_history = 0


@kernel
def hermite(M, p0, p1, dimension, h, x, out):
    """Value and derivative at x of the cubic with data (r, d) at words p0 and p1."""
    y = 1.0 - x
    for i in range(dimension):
        a = M[p0 + i]
        b = M[p0 + dimension + i]
        c = M[p1 + i]
        d = M[p1 + dimension + i]
        out[i] = y * y * (1.0 + 2.0 * x) * a + h * x * y * y * b
        out[i] += x * x * (3.0 - 2.0 * x) * c - h * x * x * y * d
        out[dimension + i] = -6.0 * x * y / h * (a - c) + y * (1.0 - 3.0 * x) * b
        out[dimension + i] += x * (3.0 * x - 2.0) * d


@kernel
def split_edge(I, M, edge, x, hinge):
    """Split an element at a fraction x from its parent end by one node, or by a hinge (two).

    All fields stay as they were, exactly. The new elements have the old one's properties.
    """
    head = header(I)
    state = scalars(M)
    count = 2 if hinge else 1
    if head.nodes + head.left_out + count > head.capacity:
        return NO_CAPACITY
    dimension = head.dimension
    size = 2 * dimension
    w = head.motion + 28
    row = edge_of(I, M, edge)
    h = row.length
    p = I[head.parent + edge]
    v0 = head.velocity + size * p
    a0 = head.acceleration + size * p
    if edge == 1 and head.payout == 1:
        material_motion(I, M)
        v0 = head.top
        a0 = head.top + 6
    hermite(
        M, head.position + size * p, head.position + size * edge, dimension, h, x, M[w : w + size]
    )
    hermite(M, v0, head.velocity + size * edge, dimension, h, x, M[w + 6 : w + 6 + size])
    hermite(M, a0, head.acceleration + size * edge, dimension, h, x, M[w + 12 : w + 12 + size])
    # The bristle of friction is linear between the nodes: it stays as it was there too.
    for i in range(dimension):
        above = M[head.position + size * p + i] - M[head.rest + 3 * p + i]
        below = M[head.position + size * edge + i] - M[head.rest + 3 * edge + i]
        M[w + 18 + i] = M[w + i] - ((1.0 - x) * above + x * below)
    open_gap(I, M, edge, count)
    lower = edge + count
    for node in range(edge, lower):
        for k in range(size):
            M[head.position + size * node + k] = M[w + k]
            M[head.velocity + size * node + k] = M[w + 6 + k]
            M[head.acceleration + size * node + k] = M[w + 12 + k]
        for k in range(dimension):
            M[head.rest + 3 * node + k] = M[w + 18 + k]
        for k in range(EDGE_WORDS):
            M[head.edges + EDGE_WORDS * node + k] = M[head.edges + EDGE_WORDS * lower + k]
        for k in range(2):
            M[head.tension + 2 * node + k] = 0.0
            M[head.tension_rate + 2 * node + k] = 0.0
        I[head.joint + node] = 0
    if hinge:
        I[head.joint + edge + 1] = 1
        edge_of(I, M, edge + 1).length = 0.0
        edge_of(I, M, edge + 1).start += x * h
    for array in range(2):
        t = head.tension if array == 0 else head.tension_rate
        mean = M[t + 2 * lower]
        slope = M[t + 2 * lower + 1]
        M[t + 2 * edge] = mean + slope * (x - 1.0)
        M[t + 2 * edge + 1] = slope * x
        M[t + 2 * lower] = mean + slope * x
        M[t + 2 * lower + 1] = slope * (1.0 - x)
    edge_of(I, M, edge).length = x * h
    edge_of(I, M, lower).length = h - x * h
    edge_of(I, M, lower).start += x * h
    if edge == 1:
        state.top_length = edge_of(I, M, 1).length
        # The lower part begins where the cable is that is out now, less the new top element.
        start = x * h - overhang(I, M) - state.paid
        edge_of(I, M, lower).start = start
        if hinge:
            edge_of(I, M, 2).start = start
    return OK


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
    turn = M[head.top + 12 : head.top + 12 + 2 * dimension]
    if node == 1 and head.payout == 1:
        material_motion(I, M)
        for i in range(dimension):
            turn[i] = M[head.top + dimension + i]
            turn[dimension + i] = M[head.top + 6 + dimension + i]
    start = edge_of(I, M, upper).start
    for array in range(2):
        t = head.tension if array == 0 else head.tension_rate
        top = M[t + 2 * upper] - M[t + 2 * upper + 1]
        bottom = M[t + 2 * lower] + M[t + 2 * lower + 1]
        M[t + 2 * lower] = (h1 * M[t + 2 * upper] + h2 * M[t + 2 * lower]) / h
        M[t + 2 * lower + 1] = 0.5 * (bottom - top)
    edge_of(I, M, lower).length = h
    edge_of(I, M, lower).start = start
    close_gap(I, M, node, count)
    if node == 1:
        state.top_length = h
        if head.payout == 1 and constraint_of(I, M, 0).clamped != EXACTLY:
            turn_with_matter(I, M, turn[0:dimension], turn[dimension : 2 * dimension])
    state.joined = max(state.joined, h)


@kernel
def give_properties(I, M, edge, cable):
    """Make an element one of another cable: all of the row but its length and place."""
    row = edge_of(I, M, edge)
    h = row.length
    start = row.start
    for k in range(EDGE_WORDS):
        M[word_of(M, row) + k] = M[word_of(M, cable_of(I, M, cable).edge) + k]
    row.length = h
    row.start = start
