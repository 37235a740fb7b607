"""A line under pressure leaves the straight: no rope is a strut.

A line that is exactly straight stays so in arithmetic, whatever presses it, where any real one is a
little crooked and bends aside. And an implicit step much longer than the time in which that grows
leads back to the straight, instead of away from it. So where an element that hangs free is pressed
by more than tensions may be wrong by, a step must be so short that nothing grows within it: the
matrix of its stages, M / (gamma dt)^2 + C / (gamma dt) + K, has no negative pivot then (Sylvester's
law of inertia, see cablemodel/solvers/finite_element/stability.py). And what is pressed and
straight is made crooked, by a part of what positions and tensions may be wrong by.

A stretch that is straight as a whole is bent in one bow, a cubic over its length that every mesh
holds alike: so the side that it goes to is not the mesh's, and what grows from it the same. In a
stretch that has bent, elements that are straight get all waves that the mesh has: the fastest of
them grows; and one that lies in a vertical plane gets a bow out of it.

A strut that is stiff enough, as a riser below its Euler load, has no negative pivot at any step.
"""

import math

from cablemodel.solvers.finite_element.kernels.element.limp import sheds
from cablemodel.solvers.finite_element.kernels.element.strain import (
    promised_tension,
)
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import near_floor
from cablemodel.solvers.finite_element.kernels.line.inertia import is_held
from cablemodel.solvers.finite_element.kernels.line.newton import refactor
from cablemodel.solvers.finite_element.kernels.mesh.payout import slope_is_held
from cablemodel.solvers.shared.access import edge_of, header, scalars, vector
from cablemodel.solvers.shared.compile import (
    inlined,
    kernel,
    view,
)
from cablemodel.solvers.shared.layout import (
    FLOOR_FAR,
    FLOOR_TOUCHED,
)

BUCKLING_FLAT = 1e-3  # of what cable is made crooked by: what is so flat never was
BUCKLING_BENT = 10.0  # bows: cable that is as far off its chord has bent
BOW_HEIGHT = 4.0 / 27.0  # largest x^2 (1 - x)
UPRIGHT = 1e-6  # sine of an angle off the vertical, below which cable is in no vertical plane
GOLDEN_ANGLE = 2.399963229728653  # golden angle: its multiples hold all waves of the mesh [rad]


@kernel
def bears_pressure(I, M, node, q, tension):
    """Whether the element above a node hangs free; not what `sheds` its pressure. What lies on the
    floor is held by it."""
    head = header(I)
    if I[head.joint + node] != 0:
        return False
    if sheds(M, edge_of(I, M, node), tension[2 * node], tension[2 * node + 1]):
        return False
    if head.floor_state == FLOOR_FAR:
        return True
    parent = I[head.parent + node]
    return not (near_floor(I, M, node, q) or near_floor(I, M, parent, q))


@inlined
def is_pressed(I, M, node, q, tension, least):
    """Whether the element above a node is pressed by more than `least` [N], and `bears_pressure`.

    q: (nodes, 2, dimension), tension: (nodes, 2).
    """
    return tension[2 * node] < -least and bears_pressure(I, M, node, q, tension)


@kernel
def any_pressed(I, M, q, tension):
    """Whether `is_pressed` by more than tensions may be wrong by."""
    head = header(I)
    least = promised_tension(M)
    for node in range(1, head.nodes):
        if is_pressed(I, M, node, q, tension, least):
            return True
    return False


@kernel
def across(I, M, node, out):
    """A unit vector across the line at a node, in the vertical plane of its slope, into out."""
    head = header(I)
    dimension = head.dimension
    slope = view(M, head.position + (2 * node + 1) * dimension, dimension)
    square = 0.0
    for i in range(dimension):
        square += slope[i] * slope[i]
    if dimension == 2:
        out[0] = -slope[1] / math.sqrt(square)
        out[1] = slope[0] / math.sqrt(square)
        return
    along = math.hypot(slope[0], slope[1])
    x = 1.0
    y = 0.0
    if along > UPRIGHT * math.sqrt(square):
        x = slope[0] / along
        y = slope[1] / along
    out[0] = -slope[2] * x
    out[1] = -slope[2] * y
    out[2] = slope[0] * x + slope[1] * y
    length = math.sqrt(out[0] ** 2 + out[1] ** 2 + out[2] ** 2)
    for i in range(3):
        out[i] /= length


@kernel
def crookedness(M, edge, least):
    """By how much the slopes of an element are turned that is straight [rad]: no more than what
    positions may be wrong by, nor than what changes its tension by `least` [N]."""
    state = scalars(M)
    place = state.tolerance * state.length / edge.length
    return min(place, math.sqrt(least * edge.compliance))


@kernel
def turned(I, M, node):
    """By how much the slopes of the element above a node are off its chord, at most [rad]."""
    head = header(I)
    dimension = head.dimension
    h = edge_of(I, M, node).length
    q0 = head.position + 2 * dimension * I[head.parent + node]
    q1 = head.position + 2 * dimension * node
    above = 0.0
    below = 0.0
    for i in range(dimension):
        chord = (M[q1 + i] - M[q0 + i]) / h
        above += (M[q0 + dimension + i] - chord) ** 2
        below += (M[q1 + dimension + i] - chord) ** 2
    return math.sqrt(max(above, below))


@kernel
def is_strut(I, M, node, q, tension, least):
    """Whether the element above a node `is_pressed` and straight."""
    if not is_pressed(I, M, node, q, tension, least):
        return False
    return turned(I, M, node) < crookedness(M, edge_of(I, M, node), least)


@kernel
def end_of_stretch(I, M, first, q, tension, least):
    """The last node of the pressed cable that begins at the element above a node."""
    head = header(I)
    last = first
    while (
        last + 1 < head.nodes
        and I[head.parent + last + 1] == last
        and is_pressed(I, M, last + 1, q, tension, least)
    ):
        last += 1
    return last


@kernel
def farthest_off(I, M, first, last):
    """How far the middles and ends of elements `first` to `last` are off their common chord [m]."""
    head = header(I)
    dimension = head.dimension
    size = 2 * dimension
    start = head.position + size * I[head.parent + first]
    end = head.position + size * last
    chord = vector()
    square = 0.0
    for i in range(dimension):
        chord[i] = M[end + i] - M[start + i]
        square += chord[i] * chord[i]
    largest = 0.0
    for node in range(first, last + 1):
        q0 = head.position + size * I[head.parent + node]
        q1 = head.position + size * node
        h = edge_of(I, M, node).length
        for middle in range(2):
            along = 0.0
            off = 0.0
            for i in range(dimension):
                place = M[q1 + i] - M[start + i]
                if middle == 1:
                    bend = 0.125 * h * (M[q0 + dimension + i] - M[q1 + dimension + i])
                    place = 0.5 * (M[q0 + i] + M[q1 + i]) - M[start + i] + bend
                along += place * chord[i]
                off += place * place
            largest = max(largest, off - along * along / square)
    return math.sqrt(largest)


@kernel
def bow_angle(I, M, first, last, least):
    """By how much a bow turns elements `first` to `last` [rad]: no more than what positions may be
    wrong by, nor than what changes their tension by `least` [N]."""
    length = 0.0
    softness = 0.0
    for node in range(first, last + 1):
        edge = edge_of(I, M, node)
        length += edge.length
        softness += edge.compliance * edge.length
    place = scalars(M).tolerance * scalars(M).length / length
    return min(place, math.sqrt(least * softness / length))


@kernel
def add_bow(I, M, places, first, last, angle, aside):
    """Bend elements `first` to `last` in one bow, x^2 (1 - x) over their length.

    places: where the positions, or the places of rest, begin.
    """
    head = header(I)
    dimension = head.dimension
    length = 0.0
    for node in range(first, last + 1):
        length += edge_of(I, M, node).length
    s = 0.0
    for node in range(first, last + 1):
        s += edge_of(I, M, node).length
        x = s / length
        at = places + 2 * dimension * node
        held = slope_is_held(I, M, node)
        for i in range(dimension):
            if node < last:
                M[at + i] += angle * length * x * x * (1.0 - x) * aside[i]
            if not held:
                M[at + dimension + i] += angle * x * (2.0 - 3.0 * x) * aside[i]


@kernel
def is_bowed(I, M, first, last, least):
    """Bend pressed cable in a bow that is straight as a whole: which side it goes to is then the
    same on every mesh. Whether it is hardly more than that."""
    length = 0.0
    for node in range(first, last + 1):
        length += edge_of(I, M, node).length
    angle = bow_angle(I, M, first, last, least)
    off = farthest_off(I, M, first, last) / (BOW_HEIGHT * angle * length)
    if off <= 1.0:
        aside = vector()
        across(I, M, last, aside)
        add_bow(I, M, header(I).position, first, last, angle, aside)
    return off < BUCKLING_BENT


@kernel
def off_plane(I, M, node, normal):
    """By how much the slopes of the element above a node leave its vertical plane, at most [-].

    The normal of that plane, a horizontal unit vector, is written.
    """
    h = edge_of(I, M, node).length
    start = header(I).position
    above = view(M, start + 6 * I[header(I).parent + node], 6)  # place, slope
    below = view(M, start + 6 * node, 6)
    dx = (below[0] - above[0]) / h
    dy = (below[1] - above[1]) / h
    along = math.sqrt(dx * dx + dy * dy)
    normal[0] = -dy / along if along > 0.0 else 0.0
    normal[1] = dx / along if along > 0.0 else 1.0
    normal[2] = 0.0
    begins = above[3] * normal[0] + above[4] * normal[1]
    ends = below[3] * normal[0] + below[4] * normal[1]
    return max(abs(begins), abs(ends))


@kernel
def bend_out_of_plane(I, M, first, last, least):
    """Bend elements `first` to `last` in a bow out of the vertical plane in which they lie, if they
    do. What friction holds is crooked, too."""
    head = header(I)
    aside = vector()
    normal = vector()
    leaves = off_plane(I, M, first, aside)
    for node in range(first + 1, last + 1):
        leaves = max(leaves, off_plane(I, M, node, normal))
    angle = bow_angle(I, M, first, last, least)
    if leaves > BUCKLING_FLAT * angle:
        return
    if aside[1] < 0.0 or (aside[1] == 0.0 and aside[0] < 0.0):
        angle = -angle  # a plane has one side, wherever cable in it turns back
    add_bow(I, M, head.position, first, last, angle, aside)
    add_bow(I, M, head.rest, first, last, angle, aside)


@kernel
def make_crooked(I, M):
    """Bend aside what is pressed and straight, or turn the slopes at the ends of its elements where
    it has bent as a whole, if a line so pressed does not stay."""
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    count = 2 * dimension * head.nodes
    least = promised_tension(M)
    aside = vector()
    q = view(M, head.position, count)
    tension = view(M, head.tension, 2 * head.nodes)
    first = 0
    for node in range(1, head.nodes):
        if tension[2 * node] < -least and is_strut(I, M, node, q, tension, least):
            first = node
            break
    if first == 0:
        return
    v = view(M, head.velocity, count)
    a = view(M, head.acceleration, count)
    stays = refactor(I, M, q, v, a, tension, state.period) == 0 and is_held(I, M)
    head.factored = 0
    if stays:
        return
    last = 0
    bowed = False
    for node in range(first, head.nodes):
        if node > last and is_pressed(I, M, node, q, tension, least):
            last = end_of_stretch(I, M, node, q, tension, least)
            bowed = is_bowed(I, M, node, last, least)
            if not bowed and dimension == 3:
                bend_out_of_plane(I, M, node, last, least)
        if bowed and node <= last:
            continue
        if not is_strut(I, M, node, q, tension, least):
            continue
        angle = crookedness(M, edge_of(I, M, node), least)
        across(I, M, node, aside)
        for end in range(2):
            at = node if end == 1 else I[head.parent + node]
            if slope_is_held(I, M, at):
                continue
            slope = view(M, head.position + (2 * at + 1) * dimension, dimension)
            for i in range(dimension):
                slope[i] += angle * math.cos(GOLDEN_ANGLE * at) * aside[i]


@kernel
def arch_stands(I, M):
    """Whether slack that is paid out stands on the floor, pressed and clear of it between places
    that touch, in the plane of a planar model.

    More and more arches would sway there, and none sleep; in space they fall over. Without
    friction nothing sleeps anyway.
    """
    head = header(I)
    if head.dimension == 3 or head.payout == 0:
        return False
    if head.floor_state != FLOOR_TOUCHED or scalars(M).friction == 0.0:
        return False
    q = view(M, head.position, 4 * head.nodes)
    tension = view(M, head.tension, 2 * head.nodes)
    touches = False
    for node in range(1, head.nodes):
        if touches and is_pressed(I, M, node, q, tension, 0.0):
            return True
        touches = touches or near_floor(I, M, node, q)
    return False


@inlined
def lies_slack(I, M, node, q, tension):
    """Whether the element above a node touches the floor and is not taut."""
    if I[header(I).joint + node] != 0 or tension[2 * node] >= 0.0:
        return False
    return near_floor(I, M, node, q)


@kernel
def fall_over(I, M):
    """Bend slack cable aside that lies in one vertical plane, where it touches the floor.

    Loops of slack would stand in that plane, and roll or sway for ever. Any real cable is a little
    crooked, and they fall over.
    """
    head = header(I)
    if head.dimension == 2 or head.floor_state != FLOOR_TOUCHED:
        return
    least = promised_tension(M)
    q = view(M, head.position, 6 * head.nodes)
    tension = view(M, head.tension, 2 * head.nodes)
    last = 0
    for first in range(1, head.nodes):
        if first <= last or not lies_slack(I, M, first, q, tension):
            continue
        last = first
        while (
            last + 1 < head.nodes
            and I[head.parent + last + 1] == last
            and lies_slack(I, M, last + 1, q, tension)
        ):
            last += 1
        bend_out_of_plane(I, M, first, last, least)
