"""Cable at rest on the sea floor sleeps: it leaves the system until something moves it.

What sleeps is the end of the line beyond a node A that lies far behind the touchdown. While a step
is made the line ends at A, whose place and tangent are held, the tangent's length too: there the
tensions of both sides balance. Nothing beyond is assembled, eliminated or copied (`leave_out`,
`rejoin`). Between steps the line is whole again, so that what reads a state knows nothing of it.

It may sleep while it is at rest and friction holds it: a change of the tension at A by dT pulls
cable along over the way on which friction can take it up. `holding_tension` is the change that
moves A by MISSED tau L, or half of what friction has to spare; a change is left out up to that,
and up to MISSED_TENSION tau times the largest tension, since what sleeps keeps its own. No step is
accepted that changes the tension by more, takes the cable before A further than MISSED tau L from
where it was, lifts it nearby, or brings water that drags at what sleeps: such a step is made again
with more of the cable awake.
"""

import math

from cablemodel.solvers.finite_element.kernels.element.strain import (
    may_be_slack,
    moments,
    strain_in,
)
from cablemodel.solvers.finite_element.kernels.floor.contact import (
    along_floor,
    bristle_at,
    contact_of,
    touchdown_layer,
)
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import gap_at, lowest_gap
from cablemodel.solvers.finite_element.kernels.mesh.payout import hermite
from cablemodel.solvers.finite_element.kernels.mesh.touchdown_mesh import (
    finest_length,
    holds_something,
)
from cablemodel.solvers.finite_element.kernels.time.backup import keep_sleepers
from cablemodel.solvers.finite_element.kernels.water.airy import column
from cablemodel.solvers.finite_element.kernels.water.waves import displaced
from cablemodel.solvers.shared.access import (
    body_of,
    constraint_of,
    edge_of,
    header,
    scalars,
    tension_of,
    trial_tension_of,
    vector,
    word_of,
)
from cablemodel.solvers.shared.compile import (
    copy_words,
    kernel,
    view,
)
from cablemodel.solvers.shared.environment import over_depth
from cablemodel.solvers.shared.layout import (
    CONSTRAINT_WORDS,
    HELD_BY_ANCHOR,
    W_FREQUENCY,
    W_MIRROR,
    W_NUMBER,
    W_SPEED,
    WHOLLY,
)
from cablemodel.solvers.shared.numbers import SLOPE_WEIGHT

QUIET = 0.01  # of tau L in sqrt(L/g): cable that is slower is at rest
LAYERS, ELEMENTS = 16.0, 4.0  # touchdown layers, or finest elements, that lie awake before A
SLEEP_NEAR = 0.5  # of that way: hanging cable closer than this wakes
MISSED = 0.02  # of tau L: motion of A that may be left out
MISSED_TENSION = 1.0  # of tau times the largest tension: a tenth of what is promised
SLEEP_SPARE = 0.1  # of the friction over the way before A: least change of tension to be held
SLEEP_CALM, ROUGH = 0.25, 0.5  # of the friction: what water may take of what falls asleep; sleeps
FEWEST_AWAKE = 12  # elements
LEAST_PART = 0.125  # of the nodes awake: fewer do not pay for a new matrix
SLEEP_PAUSE = 0.1, 0.4  # between looks for cable at rest, and after waking, in units of sqrt(L/g)
TURN_WEIGHT = SLOPE_WEIGHT * SLOPE_WEIGHT  # of h^2: what the square of a slope's rate counts
WATER_SPARE = 0.1  # of the friction: most that waves may take of what may sleep at all


@kernel
def leave_out(I, M):
    """Before a step: the line ends at A, the last node that is awake, which is held."""
    head = header(I)
    asleep = head.asleep
    if asleep == 0:
        return
    dimension = head.dimension
    head.nodes -= asleep
    head.left_out = asleep
    last = head.nodes - 1
    for body in range(head.body_count):
        row = body_of(I, M, body)
        if row.node > last:
            row.node = -row.node - 2.0  # like those on the drum: at no node
    end = constraint_of(I, M, 1)
    head.anchor_kept = 0
    if head.constraint_count == 2:
        copy_words(I, word_of(M, end) + CONSTRAINT_WORDS, word_of(M, end), CONSTRAINT_WORDS)
        head.anchor_kept = 1
    head.constraint_count = 2
    at = head.position + 2 * dimension * last
    end.node = last
    end.kind = HELD_BY_ANCHOR
    end.clamped = WHOLLY
    for i in range(dimension):
        end.position[i] = M[at + i]


@kernel
def rejoin(I, M):
    """After a step: the line is whole again."""
    head = header(I)
    if head.left_out == 0:
        return
    head.nodes += head.left_out
    head.left_out = 0
    for body in range(head.body_count):
        row = body_of(I, M, body)
        if row.node < -1.0:
            row.node = -row.node - 2.0
    end = constraint_of(I, M, 1)
    if head.anchor_kept != 0:
        copy_words(I, word_of(M, end), word_of(M, end) + CONSTRAINT_WORDS, CONSTRAINT_WORDS)
        end.node = head.nodes - 1
    else:
        head.constraint_count = 1


@kernel
def is_quiet(I, M, node, arc):
    """Whether a node is at rest: its speed, and what its acceleration makes of it in a step.

    arc: length of what hangs between two places on the floor and has the node in it, else that of
    the line [m]. What is held at both ends swings to and fro in the root of its length over g:
    shorter arcs come as far at higher speed.
    """
    head = header(I)
    state = scalars(M)
    period = state.period * math.sqrt(arc / state.length)
    limit = QUIET * state.tolerance * state.length / period
    dimension = head.dimension
    v = head.velocity + 2 * dimension * node
    a = head.acceleration + 2 * dimension * node
    h = edge_of(I, M, node).length
    time = min(state.last_step, period)
    speed = 0.0
    turning = 0.0
    push = 0.0
    for i in range(dimension):
        speed += M[v + i] ** 2
        turning += M[v + dimension + i] ** 2
        push += M[a + i] ** 2
    return max(speed, TURN_WEIGHT * h * h * turning, time * time * push) <= limit * limit


@kernel
def lies(I, M, q, node):
    """Whether an element touches the floor."""
    return I[header(I).joint + node] == 0 and lowest_gap(I, M, q, node) < scalars(M).floor_depth


@kernel
def hanging_before(I, M, q, node):
    """Length of cable before a node that does not touch the floor [m]."""
    head = header(I)
    way = 0.0
    for n in range(node, 0, -1):
        if lies(I, M, q, n):
            break
        if I[head.joint + n] == 0:
            way += edge_of(I, M, n).length
    return way


@kernel
def lying_before(I, M, q, node, enough):
    """Length of cable on the floor before a node, not counted beyond `enough` [m].

    Arcs between, as of slack that has come down in a pile, do not count and do not end it.
    """
    way = 0.0
    for n in range(node, 0, -1):
        if way >= enough:
            break
        if lies(I, M, q, n):
            way += edge_of(I, M, n).length
    return way


@kernel
def place_before(I, M, q, node, way, out):
    """The place of the line at an arc length before a node; elements may have changed since."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    while node > 1 and I[head.joint + node] == 0 and way > edge_of(I, M, node).length:
        way -= edge_of(I, M, node).length
        node -= 1
    h = edge_of(I, M, node).length
    x = max(0.0, 1.0 - way / h)
    hermite(q, size * I[head.parent + node], size * node, dimension, h, x, out, vector())


@kernel
def spare_friction(I, M, node):
    """Share of the friction at a node that nothing calls on yet, 0 to 1."""
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    contact = contact_of()
    at = head.position + 2 * dimension * node
    for i in range(dimension):
        contact.place[i] = M[at + i]
    gap = gap_at(I, M, contact.place, contact.normal)
    bristle_at(I, M, node, contact, dimension)
    share = min(1.0, 1.0 - gap / state.floor_depth)
    stretched = along_floor(contact.bristle, contact.normal, dimension) / state.bristle
    return max(0.0, share - stretched)


@kernel
def holding_tension(I, M, node):
    """Change of the tension at a node that the cable beyond it takes up [N], see above."""
    head = header(I)
    state = scalars(M)
    allowed = MISSED * state.tolerance * state.length
    spare = 0.0
    way = 0.0
    before = spare_friction(I, M, node)
    for n in range(node + 1, head.nodes + head.left_out):
        if I[head.joint + n] != 0:
            continue
        edge = edge_of(I, M, n)
        h = edge.length
        after = spare_friction(I, M, n)
        slope = 0.5 * (before + after) * state.friction * edge.contact
        before = after
        # A change of spare/2 moves A by less than spare/2 x way/EA: where is that `allowed`?
        most = 2.0 * allowed / edge.compliance
        if (spare + slope * h) * (way + h) >= most:
            b = spare + slope * way
            root = math.sqrt(b * b + 4.0 * slope * max(0.0, most - spare * way))
            x = 2.0 * max(0.0, most - spare * way) / (b + root)
            return 0.5 * (spare + slope * x)
        spare += slope * h
        way += h
    return 0.5 * spare


@kernel
def flow_squared(I, M, profile):
    """Largest square of the water's speed between the lowest and the highest cable asleep, or of
    its acceleration, by the first word of the profile."""
    head = header(I)
    state = scalars(M)
    flow = vector()
    largest = 0.0
    for end in range(2):
        over_depth(I, M, profile, state.sleep_low if end == 0 else state.sleep_high, flow)
        largest = max(largest, flow[0] ** 2 + flow[1] ** 2 + flow[2] ** 2)
    for k in range(head.depth_count):
        z = M[head.depths + k] - state.origin[2]
        if state.sleep_low < z and z < state.sleep_high:
            there = view(M, profile + 3 * k, 3)
            largest = max(largest, there[0] ** 2 + there[1] ** 2 + there[2] ** 2)
    return largest


@kernel
def water_leaves_alone(I, M, first):
    """Whether current and waves leave the cable beyond a node alone; sets what wakes it later.

    Their drag must be a small share of the friction; cable that hangs between two places on the
    floor stays awake where water moves.
    """
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    q = view(M, head.position, 2 * dimension * head.nodes)
    state.sleep_low = 1e300
    state.sleep_high = -1e300
    moves = head.current_kind != 0 or head.wave_count != 0
    flow = 1e300  # square of the speed whose drag is the friction
    push = 1e300  # acceleration of the water whose force is the friction
    for n in range(first, head.nodes):
        z = q[2 * dimension * n + dimension - 1]
        state.sleep_low = min(state.sleep_low, z)
        state.sleep_high = max(state.sleep_high, z)
        if n == first or I[head.joint + n] != 0:
            continue
        if moves and lowest_gap(I, M, q, n) >= state.floor_depth:
            return False
        edge = edge_of(I, M, n)
        friction = state.friction * edge.contact
        drag = edge.drag_normal + edge.drag_tangential
        flow = min(flow, friction / max(drag, 1e-300))
        driven = edge.added_mass + displaced(I, M, edge)
        push = min(push, friction / max(driven, 1e-300))
    for body in range(head.body_count):
        row = body_of(I, M, body)
        if row.node > first:
            friction = state.friction * max(0.0, row.weight)
            flow = min(flow, friction / max(row.drag + row.drag_axial, 1e-300))
    state.sleep_flow = flow
    if head.wave_count != 0:
        z = state.sleep_high + state.origin[2]
        speed = 0.0
        rate = 0.0
        count = head.wave_count
        number = view(M, column(I, W_NUMBER), count)
        mirror = view(M, column(I, W_MIRROR), count)
        orbit = view(M, column(I, W_SPEED), count)
        frequency = view(M, column(I, W_FREQUENCY), count)
        for n in range(count):
            up = math.exp(number[n] * min(0.0, z))
            orbital = orbit[n] * (up + mirror[n] / up)
            speed += orbital
            rate += orbital * frequency[n]
        if speed * speed > WATER_SPARE * flow or rate > WATER_SPARE * push:
            return False
    state.sleep_push = push
    if head.surge != 0:
        surge = flow_squared(I, M, head.profile + 3 * head.depth_count)
        if surge > SLEEP_CALM * push * push:
            return False
    return head.current_kind == 0 or flow_squared(I, M, head.profile) <= SLEEP_CALM * flow


@kernel
def place_to_sleep(I, M):
    """The node A beyond which all may sleep, 0: none. Sets the way of lying cable before it.

    All beyond A is at rest, and so is the way before it, of which arcs do not count: friction holds
    what touches. A itself lies.
    """
    head = header(I)
    state = scalars(M)
    q = view(M, head.position, 2 * head.dimension * head.nodes)
    last = head.nodes - 1
    first = last
    arc = 0.0
    while first > FEWEST_AWAKE:
        hangs = not lies(I, M, q, first)
        if hangs and arc == 0.0:
            arc = hanging_before(I, M, q, first)
        if not is_quiet(I, M, first, arc if arc > 0.0 else state.length):
            break
        if not hangs:
            arc = 0.0
        first -= 1
    way = 0.0
    for node in range(first + 1, last):
        if not lies(I, M, q, node):
            continue
        way += edge_of(I, M, node).length
        layer = touchdown_layer(M, edge_of(I, M, node))
        finest = finest_length(I, M, node, 0.0, layer)
        needed = max(LAYERS * layer, ELEMENTS * finest)
        if way < needed or holds_something(I, M, node) or not lies(I, M, q, node + 1):
            continue
        friction = state.friction * edge_of(I, M, node).contact
        if holding_tension(I, M, node) >= SLEEP_SPARE * friction * needed:
            state.sleep_awake = needed
            return node
    return 0


@kernel
def may_sleep(I, M):
    """Whether enough of the cable that is awake may sleep; asked from time to time."""
    head = header(I)
    state = scalars(M)
    state.sleep_after = state.time + SLEEP_PAUSE[0] * state.period
    if state.last_step == 0.0 or not is_quiet(I, M, head.nodes - 2, state.length):
        return False
    node = place_to_sleep(I, M)
    return node > 0 and head.nodes - 1 - node >= max(2.0, LEAST_PART * head.nodes)


@kernel
def wake_as_many(I, M):
    """Wake as many nodes as are awake: what has fallen asleep last is joined with what will.

    What lies further off has been looked at as often as its elements have lain there; so the cost
    of falling asleep does not grow with the cable that sleeps.
    """
    head = header(I)
    if head.asleep == 0:
        return
    node = 2 * head.nodes - 1
    keep_sleepers(I)
    rejoin(I, M)
    last = head.nodes - 1
    while node < last and holds_something(I, M, node):
        node += 1
    head.asleep = max(0, last - node)
    head.factored = 0
    if head.asleep > 0:
        hold(I, M, node)
    leave_out(I, M)


@kernel
def fall_asleep(I, M, node):
    """Let all beyond a node sleep, if there is one and water leaves that alone."""
    head = header(I)
    if node == 0:
        return
    rejoin(I, M)
    head.asleep = 0
    if not water_leaves_alone(I, M, node):
        return
    size = 2 * head.dimension
    head.asleep = head.nodes - 1 - node
    for n in range(size * node, size * head.nodes):
        M[head.velocity + n] = 0.0
        M[head.acceleration + n] = 0.0
    for n in range(2 * node + 2, 2 * head.nodes):
        M[head.tension_rate + n] = 0.0
    head.factored = 0
    hold(I, M, node)
    leave_out(I, M)


@kernel
def prepare_joining(I, M, first):
    """Give r' the length that the tension gives it beyond a node, where cable may sleep.

    The elements' third strain mode, which only a numerical stiffness holds, moves slowly; where it
    stood still with the cable, elements that lie straight could not be joined. Where some of an
    element bends aside the other two modes say the length: tension says it at no single place.
    """
    head = header(I)
    dimension = head.dimension
    if first == 0:
        return
    for node in range(first + 1, head.nodes):
        if I[head.joint + node] != 0:
            continue
        edge = edge_of(I, M, node)
        t0 = tension_of(I, M, node).mean
        t1 = tension_of(I, M, node).slope
        strain, _slope = strain_in(M, edge, t0 + t1)
        if may_be_slack(edge, t0, t1):
            mean, first_mode, _c00, _c01, _c11, _bent = moments(M, edge, t0, t1)
            strain = mean + 3.0 * first_mode
        at = head.position + dimension * (2 * node + 1)
        square = 0.0
        for i in range(dimension):
            square += M[at + i] ** 2
        more = (1.0 + strain) / math.sqrt(square) - 1.0
        rest = head.rest + at - head.position
        for i in range(dimension):
            change = more * M[at + i]
            M[at + i] += change
            M[rest + i] += change  # friction does not feel it


@kernel
def hold(I, M, node):
    """Note tension and place before the last node awake, and what the tension may change by.

    The mean of its element: in cable that lies bent, that at its end changes with the stretch of
    r' there, which is no longer that of the elements beyond.
    """
    head = header(I)
    state = scalars(M)
    state.sleep_tension = tension_of(I, M, node).mean
    state.sleep_way = edge_of(I, M, node).length
    q = view(M, head.position, 2 * head.dimension * (node + 1))
    place_before(I, M, q, node, state.sleep_way, state.sleep_place)
    most = MISSED_TENSION * state.tolerance * state.largest_tension
    state.sleep_spare = min(most, holding_tension(I, M, node))


@kernel
def disturbance(I, M):
    """What a trial step does to cable that sleeps: 0 nothing, 1 moves its end, 2 moves it all."""
    head = header(I)
    state = scalars(M)
    node = head.nodes - 1
    size = 2 * head.dimension
    if not abs(trial_tension_of(I, M, node).mean - state.sleep_tension) <= state.sleep_spare:
        return 1
    q = view(M, head.trial_position, size * (node + 1))
    place = vector()
    place_before(I, M, q, node, state.sleep_way, place)
    square = 0.0
    for i in range(head.dimension):
        square += (place[i] - state.sleep_place[i]) ** 2
    if not square <= (MISSED * state.tolerance * state.length) ** 2:
        return 1
    near = SLEEP_NEAR * state.sleep_awake
    if lying_before(I, M, q, node, near) < near:
        return 1
    if head.current_kind != 0 and flow_squared(I, M, head.profile) > ROUGH * state.sleep_flow:
        return 2
    if head.surge != 0:
        surge = flow_squared(I, M, head.profile + 3 * head.depth_count)
        if surge > ROUGH * state.sleep_push**2:
            return 2
    return 0


@kernel
def wake(I, M, everything):
    """Wake as much cable as lies awake already, and the way before A, or everything."""
    head = header(I)
    state = scalars(M)
    node = head.nodes - 1
    size = 2 * head.dimension
    keep_sleepers(I)
    wanted = lying_before(I, M, view(M, head.position, size * (node + 1)), node, 1e300)
    wanted += state.sleep_awake
    rejoin(I, M)
    way = 0.0
    while node < head.nodes - 1 and (everything or way < wanted or holds_something(I, M, node)):
        node += 1
        way += edge_of(I, M, node).length
    head.asleep = head.nodes - 1 - node
    head.factored = 0
    head.has_history = 0
    state.sleep_after = state.time + SLEEP_PAUSE[1] * state.period
    if head.asleep > 0:
        hold(I, M, node)
    leave_out(I, M)
