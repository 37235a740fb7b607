"""How near the line is to the floor: what is far from it is computed as in water without bottom.

FLOOR_FAR: nothing knows of the floor. FLOOR_ABOVE: the mesh does. FLOOR_TOUCHED: its forces act.
A step without forces is refused if it ends in the contact layer, so none is ever missed.
"""

from .compile import kernel, view
from .feet import feet_are_near, lowest_foot
from .floor_memory import settle
from .floor_surface import gap_at, lowest_gap
from .layout import (
    E_LENGTH,
    EDGE_WORDS,
    FLOOR_ABOVE,
    FLOOR_FAR,
    FLOOR_TOUCHED,
    I_ASLEEP,
    I_DIMENSION,
    I_FEET,
    I_FLOOR_STATE,
    I_NODES,
    O_EDGE,
    O_JOINT,
    O_MOTION,
    O_PARENT,
    O_POSITION,
    O_TRIAL_Q,
    O_TRIAL_V,
    O_VELOCITY,
    S_FLOOR_DEPTH,
    S_STEP,
)

CLEAR = 2.0  # contact layers: what is higher has left the floor
NEAR = 2.0  # lengths of an element above the floor within which its length follows from its gap
AWAY = 3.0  # and the gap beyond which it does no more: no change to and fro
SOON = 2.0  # steps for which what comes down is near before it is


@kernel
def gap_of(I, M, q, node, w):
    """A gap that nothing between a node and its parent undercuts [m]; w: 9 words of workspace."""
    if I[I[O_JOINT] + node] == 0:
        return lowest_gap(I, M, q, node, w)
    dimension = I[I_DIMENSION]
    normal = view(w, 3, 3)
    parent = I[I[O_PARENT] + node]
    above = gap_at(I, M, view(q, 2 * dimension * parent, dimension), normal)
    return min(above, gap_at(I, M, view(q, 2 * dimension * node, dimension), normal))


@kernel
def touches(I, M, q, layers):
    """Whether anything is within so many contact layers of the floor; the line's end comes first.

    q: (nodes, 2, dimension).
    """
    w = view(M, I[O_MOTION] + 28, 9)
    for node in range(I[I_NODES] - 1, 0, -1):
        if gap_of(I, M, q, node, w) < layers * M[S_FLOOR_DEPTH]:
            return True
    return I[I_FEET] != 0 and lowest_foot(I, M) < layers * M[S_FLOOR_DEPTH]


@kernel
def is_near(I, M, q, v, lengths):
    """Whether an element is within so many of its lengths of the floor, or comes there soon.

    q, v: (nodes, 2, dimension).
    """
    dimension = I[I_DIMENSION]
    w = view(M, I[O_MOTION] + 28, 9)
    for node in range(I[I_NODES] - 1, 0, -1):
        h = M[I[O_EDGE] + node * EDGE_WORDS + E_LENGTH]
        way = SOON * M[S_STEP] * max(0.0, -v[2 * dimension * node + dimension - 1])
        if gap_of(I, M, q, node, w) < M[S_FLOOR_DEPTH] + lengths * h + way:
            return True
    return I[I_FEET] != 0 and feet_are_near(I, M, M[S_FLOOR_DEPTH], SOON * M[S_STEP], lengths)


@kernel
def leave_floor(I, M):
    """After a step: what has left the floor feels it no more."""
    count = 2 * I[I_DIMENSION] * I[I_NODES]
    q = view(M, I[O_POSITION], count)
    if I[I_FLOOR_STATE] == FLOOR_TOUCHED and (I[I_ASLEEP] > 0 or touches(I, M, q, CLEAR)):
        return
    I[I_FLOOR_STATE] = FLOOR_ABOVE
    if not is_near(I, M, q, view(M, I[O_VELOCITY], count), AWAY):
        I[I_FLOOR_STATE] = FLOOR_FAR


@kernel
def lands(I, M):
    """After a step without the floor's forces: whether it ends where they act; now they do."""
    count = 2 * I[I_DIMENSION] * I[I_NODES]
    q = view(M, I[O_TRIAL_Q], count)
    if I[I_FLOOR_STATE] == FLOOR_FAR:
        if not is_near(I, M, q, view(M, I[O_TRIAL_V], count), NEAR):
            return False
        I[I_FLOOR_STATE] = FLOOR_ABOVE
    if not touches(I, M, q, 1.0):
        return False
    I[I_FLOOR_STATE] = FLOOR_TOUCHED
    settle(I, M)
    return True
