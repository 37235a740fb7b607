"""What the time integrators share of Newton's method: the size of an increment, the matrix."""

import math

from .backup import keep_matrix
from .compile import inlined, kernel
from .layout import (
    E_LENGTH,
    EDGE_WORDS,
    I_DIMENSION,
    I_FACTORED,
    I_FACTORISATIONS,
    I_FRESH,
    I_NODES,
    O_EDGE,
    S_FACTORED_STEP,
)
from .system import factorise

SLOPE_WEIGHT = 0.3  # weight of h |d| in norms, against |r|


@kernel
def increment_norm(I, M, x):
    """max(|dr|, 0.3 h |dd|) over the nodes [m], and the node where it is reached.

    Lengths of vectors, not of components: a run does not depend on the direction of the axes.
    """
    dimension = I[I_DIMENSION]
    largest = 0.0
    where = 0
    for node in range(I[I_NODES]):
        h = M[I[O_EDGE] + max(node, 1) * EDGE_WORDS + E_LENGTH]
        at = 2 * dimension * node
        motion = 0.0
        slope = 0.0
        for i in range(dimension):
            motion += x[at + i] * x[at + i]
            slope += x[at + dimension + i] * x[at + dimension + i]
        size = math.sqrt(max(motion, (SLOPE_WEIGHT * h) ** 2 * slope))
        if not size <= largest:
            largest = size
            where = node
        if size != size:
            break
    return largest, where


@inlined
def refactor(I, M, q, v, a, tension, gamma_dt):
    """Factor the Newton matrix of a stage at the given iterate; 0 on success."""
    keep_matrix(I)
    inverse = 1.0 / gamma_dt
    failed = factorise(I, M, q, v, a, tension, inverse * inverse, inverse)
    I[I_FACTORISATIONS] += 1
    I[I_FRESH] = 1
    I[I_FACTORED] = 1 if failed == 0 else 0
    M[S_FACTORED_STEP] = gamma_dt
    return failed
