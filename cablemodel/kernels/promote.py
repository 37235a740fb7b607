"""A planar model becomes three-dimensional when something leaves its plane."""

from .access import header, scalars
from .backup import keep_sleepers
from .compile import kernel
from .layout import (
    C_AWAY,
    C_CLAMPED,
    C_DIRECTION,
    C_DRIFT,
    C_DRIFT_RATE,
    C_PLACE,
    C_POSITION,
    CONSTRAINT_WORDS,
)


@kernel
def unfold(M, at, px, py):
    """(h, z) at `at` becomes (x, y, z) there."""
    h = M[at]
    z = M[at + 1]
    M[at] = px * h
    M[at + 1] = py * h
    M[at + 2] = z


@kernel
def promote(I, M):
    """Rewrite positions, velocities, accelerations and constraints from 4 to 6 words a node."""
    head = header(I)
    state = scalars(M)
    if head.dimension == 3:
        return
    keep_sleepers(I)
    px = state.plane[0]
    py = state.plane[1]
    for array in range(3):
        start = head.position
        if array == 1:
            start = head.velocity
        elif array == 2:
            start = head.acceleration
        for node in range(head.nodes - 1, -1, -1):
            h = M[start + 4 * node]
            z = M[start + 4 * node + 1]
            dh = M[start + 4 * node + 2]
            dz = M[start + 4 * node + 3]
            to = start + 6 * node
            M[to] = px * h
            M[to + 1] = py * h
            M[to + 2] = z
            M[to + 3] = px * dh
            M[to + 4] = py * dh
            M[to + 5] = dz
    for node in range(head.nodes):
        unfold(M, head.rest + 3 * node, px, py)
    for n in range(head.constraint_count):
        row = head.constraints + n * CONSTRAINT_WORDS
        unfold(M, row + C_POSITION, px, py)
        if M[row + C_CLAMPED] != 0.0:
            unfold(M, row + C_DIRECTION, px, py)
            unfold(M, row + C_PLACE, px, py)
            unfold(M, row + C_AWAY, px, py)
            unfold(M, row + C_DRIFT, px, py)
            unfold(M, row + C_DRIFT_RATE, px, py)
    head.dimension = 3
    head.factored = 0
    head.has_history = 0
