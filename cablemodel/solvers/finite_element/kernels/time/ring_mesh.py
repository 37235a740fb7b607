"""Elements short enough for what rings: for waves along a line, and across one that hangs in a bow.

They are divided for good, as soon as something rings. Of a bow's ring they may miss as much as all
that steps may: the other half of what is promised is theirs.
"""

import math

from cablemodel.solvers.finite_element.kernels.mesh.payout import split_as_stretched
from cablemodel.solvers.finite_element.kernels.mesh.touchdown_mesh import may_be_halved
from cablemodel.solvers.finite_element.kernels.time.bows import longest_turn, turn_across
from cablemodel.solvers.finite_element.kernels.time.rings import allowed_of
from cablemodel.solvers.finite_element.kernels.time.waves import time_of_sound, tree_of
from cablemodel.solvers.shared.access import constraint_of, edge_of, header, scalars
from cablemodel.solvers.shared.compile import inlined, kernel
from cablemodel.solvers.shared.layout import CHANGED, NO_CAPACITY, NOTHING, OK

ELEMENT_TOO_LONG = 1.5  # of what an element may have: longer ones are divided


@inlined
def rings_as_bow(row):
    """Whether the ring that is followed at a constraint is that of a bow."""
    return row.ring > 0.0 and row.bow != 0.0


@kernel
def parts_of(I, M, row, turn, node):
    """Into how many parts the element above a node is divided so that none is too long for what
    rings at a constraint; 1: it stays. turn: `longest_turn`, 0 where no bow rings."""
    if I[header(I).joint + node] != 0:
        return 1
    longer = 0.0
    if row.wave > 0.0:
        longer = time_of_sound(edge_of(I, M, node)) / row.wave_element
    if turn > 0.0:
        longer = max(longer, turn_across(I, M, row, node) / turn)
    parts = math.ceil(longer / ELEMENT_TOO_LONG)
    return int(parts) if parts > 1.0 and may_be_halved(I, M, node) else 1


@kernel
def follow_with_mesh(I, M, change):
    """Whether elements are too long for what rings; with `change`, divide them, for good.

    NOTHING, CHANGED (or to be changed), or NO_CAPACITY: the block must grow first.
    """
    head = header(I)
    changed = NOTHING
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        turn = 0.0
        if rings_as_bow(row):
            turn = longest_turn(row.ring / allowed_of(I, M, row), row.ring_lasts)
        if row.wave == 0.0 and turn == 0.0:
            continue
        root, end = tree_of(I, int(row.node))
        for node in range(end - 1, root, -1):
            parts = parts_of(I, M, row, turn, node)
            if parts > 1 and not change:
                return CHANGED
            for left in range(parts, 1, -1):
                if split_as_stretched(I, M, node + parts - left, 1.0 / left) != OK:
                    return NO_CAPACITY
                changed = CHANGED
            for part in range(node, node + parts):
                edge = edge_of(I, M, part)
                edge.nominal = min(edge.nominal, edge.length)
            scalars(M).most_nodes += parts - 1.0
    return changed
