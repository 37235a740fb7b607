"""Steps listen for rings that no end of a line begins: where the sea knocks a body."""

import math

from cablemodel.solvers.finite_element.kernels.bodies.point_bodies import surface_band
from cablemodel.solvers.finite_element.kernels.element.tables import GAMMA, UNDERRATED
from cablemodel.solvers.finite_element.kernels.time.embedded_tension import (
    embedded_error,
    stage_scatter,
)
from cablemodel.solvers.finite_element.kernels.time.watched_tension import (
    allowed_at,
    watched_element,
)
from cablemodel.solvers.shared.access import (
    body_of,
    constraint_of,
    free_body_of,
    header,
    scalars,
    tension_of,
    trial_tension_of,
)
from cablemodel.solvers.shared.compile import inlined, kernel
from cablemodel.solvers.shared.layout import FLOOR_TOUCHED, HELD_BY_ANCHOR, WHOLLY

STIFF = 0.2  # part of the embedded error that lasts, from which on a step follows what rings


@inlined
def height_of(I, M, node):
    """Of a node above still water [m]."""
    head = header(I)
    return scalars(M).origin[2] + M[head.position + head.dimension * (2 * node + 1) - 1]


@kernel
def hears(I, M):
    """Whether rings are listened for that no end of a line begins: below or above a sea whose
    troughs a body may come out of, which knocks it. Not in systems without winches
    (`share_of_ring`), nor where what comes to a floor ends them."""
    head = header(I)
    if head.wave_count == 0 or head.floor_state == FLOOR_TOUCHED:
        return False
    if head.parts != 0 and head.payout == 0:
        return False
    trough = -scalars(M).wave_crest
    for n in range(head.body_count):
        row = body_of(I, M, n)
        if row.node > 0.0:
            reach = surface_band(M, row, row.length)
            if height_of(I, M, int(row.node)) > trough - reach:
                return True
    for n in range(head.free_count):
        row = free_body_of(I, M, n)
        if height_of(I, M, int(row.node)) > trough - row.radius - row.size:
            return True
    return False


@kernel
def missed_embedded(I, M, node, scheme):
    """What a step has missed of a ring in a watched tension [N], as its embedded solution tells;
    0 where the step follows nothing that rings."""
    left, share = embedded_error(I, M, node, stage_scatter(I, M, node, scheme))
    if share <= STIFF:
        return 0.0
    angle = math.sqrt(1.0 / share - 1.0) / GAMMA[scheme]
    return left * allowed_at(I, M, node) * UNDERRATED[scheme] * angle


@kernel
def missed_late(I, M, node):
    """The same of a two-step step, which is late by a third of the angle's cube, and by half of
    that cube off what is predicted."""
    final = trial_tension_of(I, M, node).mean
    change = abs(final - tension_of(I, M, node).mean)
    off = abs(final - M[header(I).stage_tensions + 6 * node])
    return 2.0 / 3.0 * off if 2.0 * off < change else 0.0


@kernel
def hear(I, M, scheme):
    """Keep what a step by a scheme, -1: the two-step one, has missed of rings at ends that none
    follows: they may be followed from there (rings.py)."""
    head = header(I)
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        if row.kind == HELD_BY_ANCHOR or row.clamped == WHOLLY or row.ring > 0.0:
            continue
        top = watched_element(I, row)
        missed = missed_late(I, M, top) if scheme < 0 else missed_embedded(I, M, top, scheme)
        if missed > 0.0:
            row.ring_missed = missed
            head.heard += 1
