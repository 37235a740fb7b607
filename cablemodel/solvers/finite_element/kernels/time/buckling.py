"""A line under pressure leaves the straight: no rope is a strut.

A line that is exactly straight stays so in arithmetic, whatever presses it, where any real one is a
little crooked and bends aside. And an implicit step much longer than the time in which that grows
leads back to the straight, instead of away from it. So where an element that hangs free is pressed
by more than tensions may be wrong by, a step must be so short that nothing grows within it: the
matrix of its stages, M / (gamma dt)^2 + C / (gamma dt) + K, has no negative pivot then (Sylvester's
law of inertia, see cablemodel/solvers/finite_element/stability.py). And what is pressed and
straight is made crooked, by a part of what positions and tensions may be wrong by, in all waves
that the mesh has: the fastest of them grows.

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
from cablemodel.solvers.shared.compile import inlined, kernel, view
from cablemodel.solvers.shared.layout import (
    FLOOR_FAR,
    FLOOR_TOUCHED,
)

BUCKLING_FLAT = 1e-3  # of what cable is made crooked by: what is so flat never was
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
    """A horizontal unit vector across the line at a node, or the one nearest to it, into out."""
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
    # The first axis without its part along the line, or the second one where that is short.
    first = 0 if slope[0] * slope[0] < 0.5 * square else 1
    along = slope[first] / square
    length = 0.0
    for i in range(3):
        out[i] = (1.0 if i == first else 0.0) - along * slope[i]
        length += out[i] * out[i]
    for i in range(3):
        out[i] /= math.sqrt(length)


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
def make_crooked(I, M):
    """Turn the slopes at the ends of elements of the state that are pressed and straight, where
    a line so pressed does not stay."""
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
    for node in range(first, head.nodes):
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


@kernel
def off_plane(I, M, node, normal):
    """By how much the slopes of the element above a node leave its vertical plane, at most [-].

    The normal of that plane, a horizontal unit vector, is written.
    """
    h = edge_of(I, M, node).length
    start = header(I).position
    q0 = start + 6 * I[header(I).parent + node]
    q1 = start + 6 * node
    dx = (M[q1] - M[q0]) / h
    dy = (M[q1 + 1] - M[q0 + 1]) / h
    along = math.sqrt(dx * dx + dy * dy)
    normal[0] = -dy / along if along > 0.0 else 0.0
    normal[1] = dx / along if along > 0.0 else 1.0
    normal[2] = 0.0
    above = M[q0 + 3] * normal[0] + M[q0 + 4] * normal[1]
    below = M[q1 + 3] * normal[0] + M[q1 + 4] * normal[1]
    return max(abs(above), abs(below))


@kernel
def fall_over(I, M):
    """Turn the slopes of slack cable that lies in one vertical plane, where it touches the floor.

    Loops of slack would stand in that plane, and roll or sway for ever. Any real cable is a little
    crooked, and they fall over. What friction holds is crooked, too.
    """
    head = header(I)
    if head.dimension == 2 or head.floor_state != FLOOR_TOUCHED:
        return
    least = promised_tension(M)
    normal = vector()
    q = view(M, head.position, 6 * head.nodes)
    for node in range(1, head.nodes):
        if I[head.joint + node] != 0 or M[head.tension + 2 * node] >= 0.0:
            continue
        if not near_floor(I, M, node, q):
            continue
        angle = crookedness(M, edge_of(I, M, node), least)
        if off_plane(I, M, node, normal) > BUCKLING_FLAT * angle or slope_is_held(I, M, node):
            continue
        angle *= math.cos(GOLDEN_ANGLE * node)
        for i in range(3):
            M[head.position + 6 * node + 3 + i] += angle * normal[i]
            M[head.rest + 6 * node + 3 + i] += angle * normal[i]
