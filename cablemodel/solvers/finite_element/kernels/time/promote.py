"""A planar model becomes three-dimensional when something leaves its plane."""

from cablemodel.solvers.finite_element.kernels.time.backup import keep_sleepers
from cablemodel.solvers.shared.access import constraint_of, header, scalars
from cablemodel.solvers.shared.compile import (
    kernel,
    view,
)


@kernel
def unfold(vector, px, py):
    """(h, z) becomes (x, y, z) there."""
    h = vector[0]
    z = vector[1]
    vector[0] = px * h
    vector[1] = py * h
    vector[2] = z


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
    for array in range(4):
        start = head.position
        if array == 1:
            start = head.velocity
        elif array == 2:
            start = head.acceleration
        elif array == 3:
            start = head.rest
        for node in range(head.nodes - 1, -1, -1):
            planar = view(M, start + 4 * node, 4)
            h = planar[0]
            z = planar[1]
            dh = planar[2]
            dz = planar[3]
            place = view(M, start + 6 * node, 3)
            slope = view(M, start + 6 * node + 3, 3)
            place[0] = px * h
            place[1] = py * h
            place[2] = z
            slope[0] = px * dh
            slope[1] = py * dh
            slope[2] = dz
    for n in range(head.constraint_count):
        row = constraint_of(I, M, n)
        unfold(row.position, px, py)
        if row.clamped != 0.0:
            unfold(row.direction, px, py)
            unfold(row.place, px, py)
            unfold(row.away, px, py)
            unfold(row.drift, px, py)
            unfold(row.drift_rate, px, py)
    unfold(state.sleep_place, px, py)
    head.dimension = 3
    head.factored = 0
    head.has_history = 0
