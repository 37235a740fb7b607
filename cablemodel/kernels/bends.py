"""The mesh follows the cable's bends: elements that come to bend too much are halved.

A line that starts straight, or under tension, has few elements; when it is slowed, turned or let go
it bends where nobody knew beforehand. What h^2 times the jump of curvature says about a static
shape at its start (instance/refinement.py) is asked again after every natural step.
"""

import math

from .compile import kernel
from .follow import second_derivative
from .layout import (
    CABLE_WORDS,
    E_LENGTH,
    E_NOMINAL,
    EDGE_WORDS,
    I_DIMENSION,
    I_NODES,
    I_PAYOUT,
    I_TOP_CABLE,
    K_NOMINAL,
    O_CABLES,
    O_EDGE,
    O_JOINT,
    O_MOTION,
    OK,
    S_BEND_SPARE,
    S_LENGTH,
    S_TOLERANCE,
)
from .payout import split_edge

BENT = 120.0  # of tau L: what h^2 times the jump of curvature may be in motion
TOP = 1.2  # nominal lengths; half of a shorter element at a winch would be joined again at once
SMALLEST = 0.1  # of the longest element at the start: what is halved must be longer


@kernel
def jump_at(I, M, node, w):
    """Jump of r'' at an element's child end; at a joint or end half of its change inside [1/m].

    w: 6 words of scratch.
    """
    inner = node + 1 < I[I_NODES] and I[I[O_JOINT] + node + 1] == 0
    second_derivative(I, M, node, 1, w[0:3])
    second_derivative(I, M, node + 1 if inner else node, 0, w[3:6])
    square = 0.0
    for i in range(I[I_DIMENSION]):
        square += (w[3 + i] - w[i]) ** 2
    return math.sqrt(square) if inner else 0.25 * math.sqrt(square)


@kernel
def follow_bends(I, M, change):
    """Whether an element bends too much; with `change`, halve those that do.

    A flexible end has no neighbour to compare with, as in the refinement of static shapes.
    """
    w = M[I[O_MOTION] + 28 : I[O_MOTION] + 34]
    limit = BENT * M[S_TOLERANCE] * M[S_LENGTH]
    changed = False
    for node in range(I[I_NODES] - 1, 0, -1):
        if I[I[O_JOINT] + node] != 0:
            continue
        edge = I[O_EDGE] + node * EDGE_WORDS
        h = M[edge + E_LENGTH]
        if node == 1 and I[I_PAYOUT] != 0:
            row = I[O_CABLES] + I[I_TOP_CABLE] * CABLE_WORDS
            if h < TOP * M[row + K_NOMINAL]:
                break
        jump = jump_at(I, M, node, w)
        if node > 1 and I[I[O_JOINT] + node - 1] == 0:
            jump = max(jump, jump_at(I, M, node - 1, w))
        if h * h * jump > limit and h > SMALLEST * M[edge + E_NOMINAL]:
            if M[S_BEND_SPARE] == 0.0:
                break
            if not change:
                return True
            if split_edge(I, M, node, 0.5, False) == OK:
                M[S_BEND_SPARE] -= 1.0
                changed = True
    return changed
