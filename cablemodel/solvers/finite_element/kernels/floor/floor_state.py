"""How near the line is to the floor: what is far from it is computed as in water without bottom.

FLOOR_FAR: nothing knows of the floor. FLOOR_ABOVE: the mesh does. FLOOR_TOUCHED: its forces act.
A step without forces is refused if it ends in the contact layer, so none is ever missed.
"""

from cablemodel.solvers.finite_element.kernels.floor.feet import feet_are_near, lowest_foot
from cablemodel.solvers.finite_element.kernels.floor.floor_memory import settle
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import gap_at, lowest_gap
from cablemodel.solvers.shared.access import edge_of, header, scalars, vector
from cablemodel.solvers.shared.compile import inlined, kernel, view
from cablemodel.solvers.shared.layout import (
    FLOOR_ABOVE,
    FLOOR_FAR,
    FLOOR_TOUCHED,
)

CLEAR = 2.0  # contact layers: what is higher has left the floor
FLOOR_NEAR = 2.0  # lengths of an element above the floor within which its gap asks for a length
AWAY = 3.0  # and the gap beyond which it does no more: no change to and fro
NEAR_SOON = 2.0  # steps for which what comes down is near before it is


@kernel
def gap_of(I, M, q, node):
    """A gap that nothing between a node and its parent undercuts [m]."""
    head = header(I)
    if I[head.joint + node] == 0:
        return lowest_gap(I, M, q, node)
    dimension = head.dimension
    normal = vector()
    parent = I[head.parent + node]
    above = gap_at(I, M, view(q, 2 * dimension * parent, dimension), normal)
    return min(above, gap_at(I, M, view(q, 2 * dimension * node, dimension), normal))


@kernel
def touches(I, M, q, layers):
    """Whether anything is within so many contact layers of the floor; the line's end comes first.

    q: (nodes, 2, dimension).
    """
    head = header(I)
    state = scalars(M)
    for node in range(head.nodes - 1, 0, -1):
        if gap_of(I, M, q, node) < layers * state.floor_depth:
            return True
    return head.foot_count != 0 and lowest_foot(I, M) < layers * state.floor_depth


@kernel
def is_near(I, M, q, v, lengths):
    """Whether an element is within so many of its lengths of the floor, or comes there soon.

    q, v: (nodes, 2, dimension).
    """
    head = header(I)
    state = scalars(M)
    dimension = head.dimension
    for node in range(head.nodes - 1, 0, -1):
        h = edge_of(I, M, node).length
        way = NEAR_SOON * state.step * max(0.0, -v[2 * dimension * node + dimension - 1])
        if gap_of(I, M, q, node) < state.floor_depth + lengths * h + way:
            return True
    return head.foot_count != 0 and feet_are_near(
        I, M, state.floor_depth, NEAR_SOON * state.step, lengths
    )


@kernel
def leave_floor(I, M):
    """After a step: what has left the floor feels it no more."""
    head = header(I)
    count = 2 * head.dimension * head.nodes
    q = view(M, head.position, count)
    if head.floor_state == FLOOR_TOUCHED and (head.asleep > 0 or touches(I, M, q, CLEAR)):
        return
    head.floor_state = FLOOR_ABOVE
    if not is_near(I, M, q, view(M, head.velocity, count), AWAY):
        head.floor_state = FLOOR_FAR


@kernel
def lands(I, M):
    """After a step without the floor's forces: whether it ends where they act; now they do."""
    head = header(I)
    count = 2 * head.dimension * head.nodes
    q = view(M, head.trial_position, count)
    if head.floor_state == FLOOR_FAR:
        if not is_near(I, M, q, view(M, head.trial_velocity, count), FLOOR_NEAR):
            return False
        head.floor_state = FLOOR_ABOVE
    if not touches(I, M, q, 1.0):
        return False
    head.floor_state = FLOOR_TOUCHED
    settle(I, M)
    return True


@inlined
def rubs(I, M):
    """Whether something lies on a floor with friction."""
    head = header(I)
    return head.floor_state == FLOOR_TOUCHED and (scalars(M).friction > 0.0 or head.foot_count != 0)
