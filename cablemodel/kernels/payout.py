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

from .backup import keep_sleepers
from .compile import kernel, view
from .layout import (
    A_NODE,
    ARM_WORDS,
    B_NODE,
    BODY_WORDS,
    C_CLAMPED,
    C_NODE,
    CABLE_WORDS,
    CONSTRAINT_WORDS,
    E_LENGTH,
    E_START,
    EDGE_WORDS,
    EXACTLY,
    FREE_WORDS,
    I_ARMS,
    I_BODIES,
    I_CAPACITY,
    I_CONSTRAINTS,
    I_DIMENSION,
    I_FACTORED,
    I_FREE,
    I_HISTORY,
    I_LEFT_OUT,
    I_NODES,
    I_PARTS,
    I_PAYOUT,
    I_RIGID,
    K_EDGE,
    NO_CAPACITY,
    O_ACCELERATION,
    O_ARMS,
    O_BODY,
    O_CABLES,
    O_CONSTRAINT,
    O_EDGE,
    O_FREE,
    O_JOINT,
    O_MOTION,
    O_PARENT,
    O_POSITION,
    O_REST,
    O_TENSION,
    O_TENSION_RATE,
    O_TOP,
    O_VELOCITY,
    OK,
    S_JOINED,
    S_PAID,
    S_PASSING,
    S_PAYOUT_RATE,
    S_PAYOUT_SLOPE,
    S_STAGE_RATE,
    S_STAGE_SLOPE,
    S_TIME,
    S_TOP_LENGTH,
    Y_NODE,
)
from .passing import material_end, overhang, set_first_bit, set_part
from .winch import paid_since


@kernel
def set_top_length(I, M, t):
    """Length of the top element, or of what is out of a body there, and the rate at time t."""
    tau = t - M[S_TIME]
    length = M[S_TOP_LENGTH] + paid_since(M, tau)
    if M[S_PASSING] != 0.0:
        set_part(I, M, length)
    else:
        M[I[O_EDGE] + EDGE_WORDS + E_LENGTH] = length
        if I[I_RIGID] > 0:
            set_first_bit(I, M, length - M[S_TOP_LENGTH])
    M[S_STAGE_RATE] = M[S_PAYOUT_RATE] + M[S_PAYOUT_SLOPE] * tau
    M[S_STAGE_SLOPE] = M[S_PAYOUT_SLOPE]


@kernel
def material_top(I, M, q, v, a):
    """Material velocity and acceleration of the vessel's node into the O_TOP words (12)."""
    if M[S_PASSING] != 0.0:
        material_end(I, M, q, v, a)
        return
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    out = I[O_TOP]
    rate = M[S_STAGE_RATE]
    slope = M[S_STAGE_SLOPE]
    h = M[I[O_EDGE] + EDGE_WORDS + E_LENGTH]
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
    size = 2 * I[I_DIMENSION]
    set_top_length(I, M, M[S_TIME])
    material_top(
        I,
        M,
        M[I[O_POSITION] : I[O_POSITION] + 2 * size],
        M[I[O_VELOCITY] : I[O_VELOCITY] + 2 * size],
        M[I[O_ACCELERATION] : I[O_ACCELERATION] + 2 * size],
    )


@kernel
def turn_with_matter(I, M, rate, second):
    """Make the vessel's slope one whose matter turns at `rate` and `second` (dimension).

    The mesh's own rates differ from these by what flows past, v_p r'' and more: another top
    element at the same place has another r'', so that rates kept from before would be a jump of
    the matter's velocity, which grew with every joined element where v_p is near the waves' speed.
    """
    dimension = I[I_DIMENSION]
    for array in range(2):
        # The accelerations need the velocities.
        material_motion(I, M)
        to = I[O_VELOCITY] if array == 0 else I[O_ACCELERATION]
        wanted = rate if array == 0 else second
        for i in range(dimension):
            off = wanted[i] - M[I[O_TOP] + 6 * array + dimension + i]
            M[to + dimension + i] += off


@kernel
def move_node(I, M, node, to):
    """Copy all that belongs to a node and to the element above it to another place."""
    size = 2 * I[I_DIMENSION]
    for k in range(size):
        M[I[O_POSITION] + size * to + k] = M[I[O_POSITION] + size * node + k]
        M[I[O_VELOCITY] + size * to + k] = M[I[O_VELOCITY] + size * node + k]
        M[I[O_ACCELERATION] + size * to + k] = M[I[O_ACCELERATION] + size * node + k]
    for k in range(3):
        M[I[O_REST] + 3 * to + k] = M[I[O_REST] + 3 * node + k]
    for k in range(2):
        M[I[O_TENSION] + 2 * to + k] = M[I[O_TENSION] + 2 * node + k]
        M[I[O_TENSION_RATE] + 2 * to + k] = M[I[O_TENSION_RATE] + 2 * node + k]
    for k in range(EDGE_WORDS):
        M[I[O_EDGE] + EDGE_WORDS * to + k] = M[I[O_EDGE] + EDGE_WORDS * node + k]
    I[I[O_JOINT] + to] = I[I[O_JOINT] + node]


@kernel
def open_gap(I, M, at, count):
    """Move nodes from `at` on by `count` places and renumber all that points to them."""
    keep_sleepers(I)
    for node in range(I[I_NODES] + I[I_LEFT_OUT] - 1, at - 1, -1):
        move_node(I, M, node, node + count)
    renumber(I, M, at, count)


@kernel
def close_gap(I, M, at, count):
    """Remove nodes at ... at + count - 1."""
    keep_sleepers(I)
    for node in range(at + count, I[I_NODES] + I[I_LEFT_OUT]):
        move_node(I, M, node, node - count)
    renumber(I, M, at + count, -count)


@kernel
def renumber_tree(I, M, first, count):
    """The same for parents in a tree, free bodies and arms; I_NODES counts the new nodes.

    Nodes that come take the parent of that before which they come; to nodes that go, whatever had
    them as parents gets the node before them.
    """
    parents = view(I, I[O_PARENT], I[I_NODES] + max(0, -count))
    if count > 0:
        for node in range(I[I_NODES] - 1, first + count - 1, -1):
            parent = parents[node - count]
            parents[node] = parent + count if parent >= first else parent
        for node in range(first, first + count + 1):
            parents[node] = node - 1
    else:
        for node in range(first + count, I[I_NODES]):
            parent = parents[node - count]
            if parent >= first:
                parent += count
            parents[node] = min(parent, node - 1)
    for n in range(I[I_FREE]):
        row = I[O_FREE] + n * FREE_WORDS + Y_NODE
        if M[row] >= first:
            M[row] += count
    for n in range(I[I_ARMS]):
        row = I[O_ARMS] + n * ARM_WORDS + A_NODE
        if M[row] >= first:
            M[row] += count


@kernel
def renumber(I, M, first, count):
    """Node numbers >= first change by count, in bodies, constraints, parts and parents.

    Within a line a node's parent is the node before it; one line is such a chain as a whole.
    """
    for body in range(I[I_BODIES]):
        row = I[O_BODY] + body * BODY_WORDS + B_NODE
        if M[row] >= first:
            M[row] += count
        elif M[row] < -1.0:
            M[row] -= count  # asleep, see sleep.py
    for n in range(I[I_CONSTRAINTS]):
        row = I[O_CONSTRAINT] + n * CONSTRAINT_WORDS + C_NODE
        if M[row] >= first:
            M[row] += count
    I[I_NODES] += count
    if I[I_PARTS] != 0:
        renumber_tree(I, M, first, count)
    else:
        for node in range(1, I[I_NODES] + I[I_LEFT_OUT]):
            I[I[O_PARENT] + node] = node - 1
    I[I_FACTORED] = 0
    I[I_HISTORY] = 0


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
    count = 2 if hinge else 1
    if I[I_NODES] + I[I_LEFT_OUT] + count > I[I_CAPACITY]:
        return NO_CAPACITY
    dimension = I[I_DIMENSION]
    size = 2 * dimension
    w = I[O_MOTION] + 28
    row = I[O_EDGE] + edge * EDGE_WORDS
    h = M[row + E_LENGTH]
    p = I[I[O_PARENT] + edge]
    v0 = I[O_VELOCITY] + size * p
    a0 = I[O_ACCELERATION] + size * p
    if edge == 1 and I[I_PAYOUT] == 1:
        material_motion(I, M)
        v0 = I[O_TOP]
        a0 = I[O_TOP] + 6
    hermite(
        M, I[O_POSITION] + size * p, I[O_POSITION] + size * edge, dimension, h, x, M[w : w + size]
    )
    hermite(M, v0, I[O_VELOCITY] + size * edge, dimension, h, x, M[w + 6 : w + 6 + size])
    hermite(M, a0, I[O_ACCELERATION] + size * edge, dimension, h, x, M[w + 12 : w + 12 + size])
    # The bristle of friction is linear between the nodes: it stays as it was there too.
    for i in range(dimension):
        above = M[I[O_POSITION] + size * p + i] - M[I[O_REST] + 3 * p + i]
        below = M[I[O_POSITION] + size * edge + i] - M[I[O_REST] + 3 * edge + i]
        M[w + 18 + i] = M[w + i] - ((1.0 - x) * above + x * below)
    open_gap(I, M, edge, count)
    lower = edge + count
    for node in range(edge, lower):
        for k in range(size):
            M[I[O_POSITION] + size * node + k] = M[w + k]
            M[I[O_VELOCITY] + size * node + k] = M[w + 6 + k]
            M[I[O_ACCELERATION] + size * node + k] = M[w + 12 + k]
        for k in range(dimension):
            M[I[O_REST] + 3 * node + k] = M[w + 18 + k]
        for k in range(EDGE_WORDS):
            M[I[O_EDGE] + EDGE_WORDS * node + k] = M[I[O_EDGE] + EDGE_WORDS * lower + k]
        for k in range(2):
            M[I[O_TENSION] + 2 * node + k] = 0.0
            M[I[O_TENSION_RATE] + 2 * node + k] = 0.0
        I[I[O_JOINT] + node] = 0
    if hinge:
        I[I[O_JOINT] + edge + 1] = 1
        M[I[O_EDGE] + EDGE_WORDS * (edge + 1) + E_LENGTH] = 0.0
        M[I[O_EDGE] + EDGE_WORDS * (edge + 1) + E_START] += x * h
    for array in range(2):
        t = I[O_TENSION] if array == 0 else I[O_TENSION_RATE]
        mean = M[t + 2 * lower]
        slope = M[t + 2 * lower + 1]
        M[t + 2 * edge] = mean + slope * (x - 1.0)
        M[t + 2 * edge + 1] = slope * x
        M[t + 2 * lower] = mean + slope * x
        M[t + 2 * lower + 1] = slope * (1.0 - x)
    M[I[O_EDGE] + EDGE_WORDS * edge + E_LENGTH] = x * h
    M[I[O_EDGE] + EDGE_WORDS * lower + E_LENGTH] = h - x * h
    M[I[O_EDGE] + EDGE_WORDS * lower + E_START] += x * h
    if edge == 1:
        M[S_TOP_LENGTH] = M[I[O_EDGE] + EDGE_WORDS + E_LENGTH]
        # The lower part begins where the cable is that is out now, less the new top element.
        start = x * h - overhang(I, M) - M[S_PAID]
        M[I[O_EDGE] + EDGE_WORDS * lower + E_START] = start
        if hinge:
            M[I[O_EDGE] + EDGE_WORDS * 2 + E_START] = start
    return OK


@kernel
def join_at(I, M, node, count):
    """Remove an inner node (count 1) or a hinge (count 2): its two elements become one.

    What the merged cubic cannot hold is lost; the caller makes the state consistent.
    """
    upper = node
    lower = node + count
    h1 = M[I[O_EDGE] + EDGE_WORDS * upper + E_LENGTH]
    h2 = M[I[O_EDGE] + EDGE_WORDS * lower + E_LENGTH]
    h = h1 + h2
    dimension = I[I_DIMENSION]
    turn = M[I[O_TOP] + 12 : I[O_TOP] + 12 + 2 * dimension]
    if node == 1 and I[I_PAYOUT] == 1:
        material_motion(I, M)
        for i in range(dimension):
            turn[i] = M[I[O_TOP] + dimension + i]
            turn[dimension + i] = M[I[O_TOP] + 6 + dimension + i]
    start = M[I[O_EDGE] + EDGE_WORDS * upper + E_START]
    for array in range(2):
        t = I[O_TENSION] if array == 0 else I[O_TENSION_RATE]
        top = M[t + 2 * upper] - M[t + 2 * upper + 1]
        bottom = M[t + 2 * lower] + M[t + 2 * lower + 1]
        M[t + 2 * lower] = (h1 * M[t + 2 * upper] + h2 * M[t + 2 * lower]) / h
        M[t + 2 * lower + 1] = 0.5 * (bottom - top)
    M[I[O_EDGE] + EDGE_WORDS * lower + E_LENGTH] = h
    M[I[O_EDGE] + EDGE_WORDS * lower + E_START] = start
    close_gap(I, M, node, count)
    if node == 1:
        M[S_TOP_LENGTH] = h
        if I[I_PAYOUT] == 1 and M[I[O_CONSTRAINT] + C_CLAMPED] != EXACTLY:
            turn_with_matter(I, M, turn[0:dimension], turn[dimension : 2 * dimension])
    M[S_JOINED] = max(M[S_JOINED], h)


@kernel
def give_properties(I, M, edge, cable):
    """Make an element one of another cable: all of the row but its length and place."""
    row = I[O_EDGE] + EDGE_WORDS * edge
    h = M[row + E_LENGTH]
    start = M[row + E_START]
    for k in range(EDGE_WORDS):
        M[row + k] = M[I[O_CABLES] + cable * CABLE_WORDS + K_EDGE + k]
    M[row + E_LENGTH] = h
    M[row + E_START] = start
