"""A start from a shape that a scene gives: what it stretches the cable by, and its tensions.

A curve through points is longer than their chords, and no longer than arcs through them. Cable
that fits between is unstretched; a longer curve stretches all of it alike. But elements whose nodes
lie along it each have a length of their own: cubics cut its bends. In a stiff cable that would be
tensions without bound, which tear the shape apart. (Which stretch: start/first_shape.py.)
"""

import math

from cablemodel.solvers.finite_element.kernels.element.strain import tensions_after
from cablemodel.solvers.finite_element.kernels.line.system import jacobian, residual, set_time
from cablemodel.solvers.finite_element.kernels.time.consistency import (
    AXIAL_SLOW,
    NEGLIGIBLE,
    constraint_size,
    project_position,
    refactor_state,
    state_constraints,
)
from cablemodel.solvers.shared.access import (
    compliance_of,
    edge_of,
    header,
    scalars,
    spare_row,
    tension_of,
)
from cablemodel.solvers.shared.compile import copy_words, kernel
from cablemodel.solvers.shared.layout import FLOOR_NONE, GivenShapeRows

ROW_GIVEN, ROW_EVEN = GivenShapeRows.given.word, GivenShapeRows.even.word
STRETCHED_ALIKE = 1e-13  # of the length: what may be left of an element's stretch
EVENED_OUT = 12  # steps of Newton's method for that, at most
SMALLEST_STRETCH = 1.0 / 64.0  # of the way to the stretch that is wanted, at once
STRETCH_ROUNDS = 30  # for tensions that belong to a stretch


@kernel
def given_stretch(I, M):
    """By what the curve of a shape that is given stretches its cable: the nodes' mean slope."""
    head = header(I)
    size = 2 * head.dimension
    total = 0.0
    for node in range(head.nodes):
        square = 0.0
        for i in range(head.dimension, size):
            square += M[head.position + size * node + i] ** 2
        total += math.sqrt(square)
    return total / head.nodes


@kernel
def stretch_by(I, M, stretch, gamma_dt):
    """Move nodes to where all of the cable is stretched alike, from nearby; whether they are."""
    head = header(I)
    most = scalars(M).length
    for node in range(1, head.nodes):
        if I[head.joint + node] == 0:
            tension = tension_of(I, M, node)
            tension.mean, tension.slope, _others = tensions_after(
                M, edge_of(I, M, node), 0.0, 0.0, stretch - 1.0, 0.0
            )
    off = constraint_size(I, M)
    for _iteration in range(EVENED_OUT):
        before = off
        if off <= STRETCHED_ALIKE * most or refactor_state(I, M, gamma_dt) != 0:
            break
        state_constraints(I, M)
        project_position(I, M)
        off = constraint_size(I, M)
        if not off < before:
            break
    return off <= NEGLIGIBLE * most


@kernel
def stretch_evenly(I, M, wanted):
    """Move the nodes of a shape that is given to where all of the cable is stretched by `wanted`.

    By as little as their mass allows, in a time in which waves along the line pass it and nothing
    else has moved. A shape that no such motion leads to stays as it is given.
    """
    head = header(I)
    state = scalars(M)
    set_time(I, M, state.time)
    given = given_stretch(I, M)
    gamma_dt = max(AXIAL_SLOW / math.sqrt(state.axial), state.first_step)
    count = 2 * head.dimension * head.nodes
    places = spare_row(I, ROW_GIVEN)
    even = spare_row(I, ROW_EVEN)
    copy_words(I, places, head.position, count)
    copy_words(I, even, head.position, count)
    way = 0.0
    step = 1.0
    while way < 1.0 and step >= SMALLEST_STRETCH:
        share = min(1.0, way + step)
        if stretch_by(I, M, given + share * (wanted - given), gamma_dt):
            copy_words(I, even, head.position, count)
            way = share
            step *= 2.0
        else:
            copy_words(I, head.position, even, count)
            step *= 0.5
    if way < 1.0:
        copy_words(I, head.position, places, count)
    elif head.floor_kind != FLOOR_NONE:
        for n in range(count):
            M[head.rest + n] += M[head.position + n] - M[places + n]


@kernel
def stretch_to_tension(I, M):
    """Tensions that belong to the stretch of the positions in the block (at rest)."""
    head = header(I)
    state = scalars(M)
    count = 2 * head.dimension * head.nodes
    nodes = head.nodes
    q = M[head.position : head.position + count]
    v = M[head.velocity : head.velocity + count]
    a = M[head.acceleration : head.acceleration + count]
    tension = M[head.tension : head.tension + 2 * nodes]
    forces = M[head.residual : head.residual + count]
    constraint = M[head.constraint_residual : head.constraint_residual + 2 * nodes]
    set_time(I, M, state.time)
    for _iteration in range(STRETCH_ROUNDS):
        residual(I, M, q, v, a, tension, forces, constraint)
        jacobian(I, M, q, v, a, tension, 1.0, 1.0)
        for node in range(1, nodes):
            s = compliance_of(I, M, node)
            r0 = constraint[2 * node]
            r1 = constraint[2 * node + 1]
            tension[2 * node] += s.s00 * r0 + s.s01 * r1
            tension[2 * node + 1] += s.s01 * r0 + s.s11 * r1
    head.factored = 0
