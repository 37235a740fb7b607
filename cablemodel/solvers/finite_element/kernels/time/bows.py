"""Lines that hang in a bow between two ends that are held: how they ring.

Where an end of such a line begins to accelerate along it by a, the bow has to become flatter at
once: each piece of it moves across itself by the tension's change times its curvature K over its
mass m, the water's with it. So the tension jumps by a over the sum of K^2 / m along the line, and
rings about that, since the line gives way along itself, too: the square of the frequency is that
sum over the sum of compliances. The tension changes everywhere at once, as sound runs along the
line within half a turn of the ring: not where it turns by much more than pi.

At that frequency waves run across the line, of the speed sqrt(T / m). They begin where it is held
and cannot follow, and are short: a few metres on a wire in air. What they turn by along an element
tells by how much it misses the ring (`longest_turn`), as of waves along a line.

A line so taut that it has no room for one of these waves does not ring, but is stretched as a
string: that is below lambda = 2 pi of Irvine and Caughey (1974). What bodies or other lines hang
on has other rings, and so has what lies on a floor.
"""

import math

from cablemodel.solvers.finite_element.kernels.mesh.touchdown_mesh import second_derivative
from cablemodel.solvers.finite_element.kernels.time.tension import LOSS_FACTOR
from cablemodel.solvers.finite_element.kernels.time.watched_tension import allowed_at
from cablemodel.solvers.finite_element.kernels.time.waves import (
    ELEMENT_DISPERSION,
    runs_through,
    time_of_sound,
    tree_of,
)
from cablemodel.solvers.shared.access import (
    body_of,
    constraint_of,
    edge_of,
    free_body_of,
    header,
    tension_of,
    vector,
)
from cablemodel.solvers.shared.compile import inlined, kernel
from cablemodel.solvers.shared.layout import FLOOR_TOUCHED, JOINT_HINGE

ONE_WAVE = 2.0 * math.pi  # rad: of waves across along the line, from which on it rings as a bow


@kernel
def is_one_line(I, M, root, end):
    """Whether what is tied together is one line without bodies, held at both ends, which does not
    run from one winch to another."""
    head = header(I)
    if runs_through(I, M, root, end):
        return False
    held = 0
    for n in range(head.constraint_count):
        node = int(constraint_of(I, M, n).node)
        if root <= node < end:
            held += 1 if node == root or node == end - 1 else 2
    if held != 2:
        return False
    for node in range(root + 1, end):
        if I[head.joint + node] > JOINT_HINGE or I[head.parent + node] != node - 1:
            return False
    for n in range(head.body_count):
        if root < body_of(I, M, n).node < end:
            return False
    for n in range(head.free_count):
        if root <= free_body_of(I, M, n).node < end:
            return False
    return True


@kernel
def square_of_bend(I, M, node):
    """The mean of the square of an element's curvature [1/m2]."""
    begin = vector()
    after = vector()
    second_derivative(I, M, node, 0, begin)
    second_derivative(I, M, node, 1, after)
    square = 0.0
    for i in range(header(I).dimension):
        square += begin[i] * begin[i] + begin[i] * after[i] + after[i] * after[i]
    return square / 3.0


@inlined
def time_across(edge, tension):
    """In which a wave across runs along an element under that tension [s]."""
    return edge.length * math.sqrt((edge.mass + edge.added_mass) / tension)


@kernel
def bow_mode(I, M, held, top):
    """Of a line that hangs in a bow from a node that is held: the ring's frequency [rad/s], the
    mass that moves with the node along the line as that accelerates [kg], and of what is allowed of
    the tension of the element `top` the part that the line has which it harms most. 0: no bow."""
    head = header(I)
    if head.constraint_count < 2 or head.floor_state == FLOOR_TOUCHED:
        return 0.0, 0.0, 1.0
    root, end = tree_of(I, held)
    if not is_one_line(I, M, root, end):
        return 0.0, 0.0, 1.0
    bends = 0.0
    gives = 0.0
    along = 0.0
    across = 0.0
    least = math.inf
    for node in range(root + 1, end):
        if I[head.joint + node] != 0:
            continue
        edge = edge_of(I, M, node)
        tension = tension_of(I, M, node).mean
        if not tension > 0.0:
            return 0.0, 0.0, 1.0
        bends += edge.length * square_of_bend(I, M, node) / (edge.mass + edge.added_mass)
        gives += edge.length * edge.compliance
        along += time_of_sound(edge)
        across += time_across(edge, tension)
        least = min(least, allowed_at(I, M, node))
    if gives == 0.0:
        return 0.0, 0.0, 1.0
    frequency = math.sqrt(bends / gives)
    if not (frequency * across > ONE_WAVE and frequency * along < math.pi):
        return 0.0, 0.0, 1.0
    return frequency, 1.0 / bends, least / allowed_at(I, M, top)


@kernel
def longest_turn(amplitude, lasts):
    """The most by which a wave across may turn along an element [rad], for a ring of that amplitude
    [what may be missed of it] that lasts so long [rad; 0: not known yet]."""
    if lasts == 0.0:
        lasts = 2.0 / LOSS_FACTOR
    return (ELEMENT_DISPERSION * amplitude * lasts) ** (-1.0 / 6.0)


@kernel
def turn_across(I, M, row, node):
    """By what angle a wave across turns along an element as the bow rings [rad]. A ring that is
    larger than the tension would leave the line slack."""
    tension = max(tension_of(I, M, node).mean, row.ring)
    return row.ring_frequency * time_across(edge_of(I, M, node), tension)
