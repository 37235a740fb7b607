"""A body of finite length passes the tow point, like a piece of cable that does not bend.

While it passes, the body ties its outer attachment C to the tow point: its inner end slides
through that point at the winch's rate, free to turn about it (a clamp holds cable only). What is
out of a body of length l is a body of the length x that has passed: its mass, weight, areas
and added masses are x / l of the whole, its rotary inertia (x / l)^3. For a body of even mass that
is the matter that has passed, so that it comes out of the drum with the forces of a cable of its
mass; at x = 0 and x = l it is nothing and the whole for any body.

With g = r_C - r_0 and the axis a3 = g / x, the matter at the tow point moves, like that of a cable
that is paid out at v_p (payout.py), with

    v = r_0,t + v_p a3,      a = r_0,tt + v_p_dot a3 + 2 v_p a3_t,      x a3_t = g_t - v_p a3.

With these in place of the vessel's motion the body is computed like any other one (rigid.py).
"""

from cablemodel.solvers.shared.access import (
    body_at,
    body_of,
    cable_of,
    header,
    matter_of,
    scalars,
    winch_of,
    word_of,
)
from cablemodel.solvers.shared.compile import kernel, own_record, view
from cablemodel.solvers.shared.layout import BODY_WORDS, MATTER_WORDS
from cablemodel.solvers.shared.numbers import SAME_PLACE
from cablemodel.solvers.shared.record import Record, reals

BARE = 0.05  # of its length: what is out of a body before it takes the top element's place,
LARGEST_BARE = 0.25  # or this where it is short against elements


class Axis(Record):
    """That of the body at the tow point: block's coordinates, in a plane the first two of three."""

    direction = reals(3, "unit vector along it")
    turn = reals(3, "rate of that", "1/s")
    turn_rate = reals(3, "rate of that", "1/s2")


new_axis = own_record(Axis)


@kernel
def part_row(I):
    """Word of the row of what is out of the body that passes; `set_part` has filled it."""
    head = header(I)
    return head.matter + MATTER_WORDS * head.winch_count


@kernel
def body_above(I, M, cable):
    """Row of the body of finite length at the vessel's end of a cable of the winch, or -1."""
    head = header(I)
    if head.rigid == 0 or cable + 1 >= head.cable_count:
        return -1
    body = int(cable_of(I, M, cable + 1).body)
    if body < 0:
        return -1
    row = head.bodies + body * BODY_WORDS
    of_body = body_at(M, row)
    if of_body.length == 0.0:
        return -1
    return row


@kernel
def bare_length(M, body, above):
    """What is out of a body before it takes the top element's place [m].

    A short end of a body swings about the tow point the wider the shorter it gets. body, above:
    rows of the body and of the cable above it.
    """
    length = body.length
    return max(BARE * length, min(LARGEST_BARE * length, above.shortest))


@kernel
def bodies_passed(I, M, travel):
    """Length of the bodies that have passed the tow point since the outermost cable did [m]."""
    head = header(I)
    length = 0.0
    for cable in range(head.cable_count - 1):
        row = body_above(I, M, cable)
        body = body_at(M, row)
        if row >= 0:
            out = travel - cable_of(I, M, cable).leaves
            length += min(max(out, 0.0), body.length)
    return length


@kernel
def cable_paid(I, M, n):
    """Cable that has passed a winch since t = 0 [m]: the travel without the bodies."""
    head = header(I)
    travel = winch_of(I, M, n).travel
    if head.rigid == 0:
        return travel
    return travel - bodies_passed(I, M, travel) + bodies_passed(I, M, 0.0)


@kernel
def overhang(I, M):
    """What of the top element is not cable but the first bit of a body that comes [m]."""
    head = header(I)
    if head.rigid == 0:
        return 0.0
    winch = winch_of(I, M, 0)
    cable = int(winch.cable)
    row = body_above(I, M, cable)
    body = body_at(M, row)
    if row < 0 or winch.passing_body != 0.0:
        return 0.0
    out = winch.travel - cable_of(I, M, cable).leaves
    return min(max(out, 0.0), body.length)


@kernel
def next_mark(I, M, n, outwards):
    """Way of a winch to where a body that comes or goes must be met exactly [m]; 1e300: none."""
    head = header(I)
    if head.rigid == 0:
        return 1e300
    winch = winch_of(I, M, n)
    cable = int(winch.cable)
    row = body_above(I, M, cable)
    body = body_at(M, row)
    if row < 0:
        return 1e300
    at = cable_of(I, M, cable)
    out = winch.travel - at.leaves
    length = body.length
    near = SAME_PLACE * length
    if not outwards:
        if winch.passing_body != 0.0 and out > length + near:
            return out - length
        return 1e300
    if winch.passing_body == 0.0:
        return max(bare_length(M, body, cable_of(I, M, cable + 1)) - out, near)
    if out < length - near:
        return length - out
    return max(length + cable_of(I, M, cable + 1).shortest - out, near)


@kernel
def set_part(I, M, length):
    """The row of what is out of the passing body, `length` [m] from its outer attachment.

    Beyond its own length it is the whole body on a weightless stick: the bit of the next cable.
    """
    state = scalars(M)
    whole = body_of(I, M, int(winch_of(I, M, 0).passing_body) - 1)
    take_share(I, M, whole, length)
    # Nothing but this spring holds the slope at the vessel.
    body_at(M, part_row(I)).clamp[0] = state.tension_scale * length


@kernel
def set_first_bit(I, M, out):
    """The same while the first bit of a body is a piece of the top element: `Body.mass` 0: none is.

    out: what has passed the tow point since `time` [m].
    """
    winch = winch_of(I, M, 0)
    part = body_at(M, part_row(I))
    part.mass = 0.0
    cable = int(winch.cable)
    row = body_above(I, M, cable)
    if row < 0:
        return
    out += winch.travel - cable_of(I, M, cable).leaves
    if out > 0.0:
        take_share(I, M, body_at(M, row), out)


@kernel
def take_share(I, M, whole, length):
    """The part row: what is out of a body whose row is `whole`."""
    part = body_at(M, part_row(I))
    for k in range(BODY_WORDS):
        M[word_of(M, part) + k] = M[word_of(M, whole) + k]
    part.length = length
    share = min(1.0, length / whole.length)
    part.mass *= share
    part.weight *= share
    part.dry_weight *= share
    part.added_mass *= share
    part.added_mass_axial *= share
    part.drag *= share
    part.drag_axial *= share
    part.inertia *= share**3
    part.tie *= share


@kernel
def add_first_bit(I, M, out):
    """Weight and inertia of the first bit of a body to the vessel node's forces: it bears them.

    The cable of its length, which stands in its place, bears its own.
    """
    head = header(I)
    part = body_at(M, part_row(I))
    if part.mass == 0.0:
        return
    dimension = head.dimension
    for i in range(dimension):
        out[i] += part.mass * matter_of(I, M, 0).acceleration[i]
    out[dimension - 1] += part.weight


@kernel
def axis_motion(I, M, q, v, a, length, rate, slope, axis):
    """Motion of the axis of the body at the tow point.

    length: what is out of it [m], which grows with `rate` and `slope`.
    """
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    direction = axis.direction
    turn = axis.turn
    square = 0.0
    for i in range(dimension):
        direction[i] = q[size + i] - q[i]
        square += direction[i] ** 2
    reach = square**0.5
    for i in range(dimension):
        direction[i] /= reach
        turn[i] = (v[size + i] - v[i] - rate * direction[i]) / length
        second = a[size + i] - a[i] - slope * direction[i] - 2.0 * rate * turn[i]
        axis.turn_rate[i] = second / length


@kernel
def material_end(I, M, q, v, a):
    """Motion of the passing body's matter at the tow point into the winch's Matter."""
    head = header(I)
    winch = winch_of(I, M, 0)
    dimension = head.dimension
    matter = matter_of(I, M, 0)
    axis = new_axis()
    rate = winch.stage_rate
    slope = winch.stage_slope
    axis_motion(I, M, q, v, a, body_at(M, part_row(I)).length, rate, slope, axis)
    for i in range(dimension):
        along = axis.direction[i]
        matter.velocity[i] = v[i] + rate * along
        matter.velocity[dimension + i] = v[dimension + i]
        matter.acceleration[i] = a[i] + slope * along + 2.0 * rate * axis.turn[i]
        matter.acceleration[dimension + i] = a[dimension + i]


@kernel
def exchange(I, M, n, of_matter, x):
    """Put the rates of the matter at a winch in place of those of its node in x, and back."""
    node = int(winch_of(I, M, n).node)
    if node < 0:
        return
    size = 2 * header(I).dimension
    own = view(x, size * node, size)
    for k in range(size):
        kept = own[k]
        own[k] = of_matter[k]
        of_matter[k] = kept


@kernel
def exchange_velocities(I, M, v):
    """Put the matter's velocities in place of those of winches' nodes; a second call, back."""
    for n in range(header(I).winch_count):
        exchange(I, M, n, matter_of(I, M, n).velocity, v)


@kernel
def exchange_rates(I, M, v, a):
    """The same of velocities and accelerations."""
    for n in range(header(I).winch_count):
        matter = matter_of(I, M, n)
        exchange(I, M, n, matter.velocity, v)
        exchange(I, M, n, matter.acceleration, a)
