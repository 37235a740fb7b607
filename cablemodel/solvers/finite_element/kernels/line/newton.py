"""What the time integrators share of Newton's method: the size of an increment, the matrix."""

import math

from cablemodel.solvers.finite_element.kernels.bodies.body_clamps import turned_back
from cablemodel.solvers.finite_element.kernels.line.system import factorise
from cablemodel.solvers.shared.access import edge_of, header, scalars
from cablemodel.solvers.shared.compile import inlined, kernel, outlined, view
from cablemodel.solvers.shared.layout import (
    JOINT_FREE,
    JOINT_ROOT_FREE,
)
from cablemodel.solvers.shared.numbers import SLOPE_WEIGHT

SLOPE_RANGE = 0.5, 1.6  # of |r'| at a node, beside its stretch
NO_TENSION = 1e-8  # of a typical tension: what a line at rest without any has by rounding
TENSION_SETTLED = 1e-4  # of the largest: change in the last iteration of what is read


@inlined
def _largest_square(I, M, x, dimension):
    """Square of the norm, and the node where it is reached."""
    head = header(I)
    largest = 0.0
    where = 0
    for node in range(head.nodes):
        h = edge_of(I, M, max(node, 1)).length
        at = view(x, 2 * dimension * node, 2 * dimension)
        motion = 0.0
        slope = 0.0
        for i in range(dimension):
            motion += at[i] * at[i]
            slope += at[dimension + i] * at[dimension + i]
        square = max(motion, (SLOPE_WEIGHT * h) ** 2 * slope)
        if not square <= largest:
            largest = square
            where = node
        if square != square:
            break
    return largest, where


@kernel
def increment_norm(I, M, x):
    """max(|dr|, 0.3 h |dd|) over the nodes [m], and the node where it is reached.

    Lengths of vectors, not of components: a run does not depend on the direction of the axes.
    """
    head = header(I)
    if head.dimension == 2:
        square, where = _largest_square(I, M, x, 2)
    else:
        square, where = _largest_square(I, M, x, 3)
    return math.sqrt(square), where


@inlined
def is_free_body(I, node):
    """Whether a node is a free body: it has a rotation vector in place of a slope."""
    head = header(I)
    joint = I[head.joint + node]
    return joint == JOINT_FREE or joint == JOINT_ROOT_FREE


@kernel
def is_folded(I, M, q, tension):
    """Whether an element lies folded in line: a root of the discrete equations, of no cable.

    Its slope passes through zero and back along itself; the two means of |r'| that are held to
    1 + strain are met with slopes of length 2 at its ends. It costs no bending energy. Or whether a
    line is turned back at a body that clamps it, where that has no moment either.
    """
    head = header(I)
    if head.closure_count != 0:
        turned = turned_back(I, M, q)
        if turned >= 0:
            I[head.failed] = turned
            return True
    dimension = head.dimension
    longest = SLOPE_RANGE[1]
    for node in range(1, head.nodes):
        longest = max(longest, SLOPE_RANGE[1] + edge_of(I, M, node).compliance * tension[2 * node])
    for node in range(head.nodes):
        if head.parts != 0 and is_free_body(I, node):
            continue
        at = view(q, (2 * node + 1) * dimension, dimension)
        square = 0.0
        for i in range(dimension):
            square += at[i] * at[i]
        if not (SLOPE_RANGE[0] ** 2 <= square and square <= longest * longest):
            I[head.failed] = node
            return True
    return False


@outlined
def refactor(I, M, q, v, a, tension, gamma_dt):
    """Factor the Newton matrix of a stage at the given iterate; 0 on success."""
    head = header(I)
    state = scalars(M)
    inverse = 1.0 / gamma_dt
    failed = factorise(I, M, q, v, a, tension, inverse * inverse, inverse)
    head.factorisations += 1
    head.fresh = 1
    head.factored = 1 if failed == 0 else 0
    state.factored_step = gamma_dt
    return failed
