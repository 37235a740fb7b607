"""Closures: ends of lines that come to a body or a node to which the tree of nodes comes before.

The tree is eliminated as if such an end were free; the force F that holds it there is an unknown,
with the condition that both places are the same. With K the matrix of the tree and G the derivative
of the gap between both places,

    K x - G^T dF = -R,   G x = -gap,

so that x = x0 + Y dF with Y = K^-1 G^T, and G Y dF = -gap - G x0: three columns for each closure,
and a small dense matrix. Of a clamp at a body, which has a row here too (body_clamps.py), dF is
k P^T x, and -1 / k is added to its part of that matrix.
"""

from cablemodel.solvers.finite_element.kernels.bodies.body_clamps import (
    add_body_clamp,
    add_clamp_derivatives,
    clamp_of_motion,
    open_clamp,
    put_clamp,
)
from cablemodel.solvers.finite_element.kernels.bodies.free_bodies import arm_moment, follow_at_body
from cablemodel.solvers.finite_element.kernels.bodies.rotation import to_earth_axes
from cablemodel.solvers.shared.access import arm_of, closure_of, free_body_of, header, vector
from cablemodel.solvers.shared.compile import inlined, kernel, view


@kernel
def close(I, M, q, out):
    """Add the closures' forces to those of the nodes, and measure their gaps. The bodies' motion
    is that of q."""
    head = header(I)
    arm = vector()
    moment = vector()
    for n in range(head.closure_count):
        row = closure_of(I, M, n)
        if row.node < 0.0:
            continue
        if row.clamp != 0.0:
            add_body_clamp(I, M, row, q, out)
            continue
        at = 6 * int(row.node)
        force = row.force
        for i in range(3):
            out[at + i] -= force[i]
        if row.body < 0.0:
            to = 6 * int(row.other)
            for i in range(3):
                out[to + i] += force[i]
                row.gap[i] = q[at + i] - q[to + i]
            continue
        body = free_body_of(I, M, int(row.body))
        to = 6 * int(body.node)
        m = body.motion
        to_earth_axes(m.turn, row.place, arm)
        for i in range(3):
            row.gap[i] = q[at + i] - m.reference.position[i] - arm[i]
        arm_moment(row, m, force, moment)
        for i in range(3):
            out[to + i] += force[i]
            out[to + 3 + i] += moment[i]


@kernel
def close_jacobian(I, M, q, v, a):
    """How places at bodies follow their rotation vectors, and moments of the closures' forces."""
    for n in range(header(I).closure_count):
        row = closure_of(I, M, n)
        if row.node < 0.0 or row.body < 0.0:
            continue
        if row.clamp != 0.0:
            add_clamp_derivatives(I, M, row, q, v, a)
            continue
        follow_at_body(I, M, row, free_body_of(I, M, int(row.body)), row.force, q, v, a)


@kernel
def gap_of_motion(I, M, row, i, x):
    """What a motion x of the nodes changes of component i of a closure's gap."""
    if row.node < 0.0:
        return 0.0
    if row.clamp != 0.0:
        return clamp_of_motion(I, M, row, i, x)
    value = x[6 * int(row.node) + i]
    if row.body < 0.0:
        return value - x[6 * int(row.other) + i]
    to = 6 * int(free_body_of(I, M, int(row.body)).node)
    value -= x[to + i]
    for j in range(3):
        value -= row.follows[3 * i + j] * x[to + 3 + j]
    return value


@kernel
def take_gaps_of_motion(I, M, x):
    """Make the gaps those of a motion x of the nodes, such as a velocity; a clamp has none."""
    for n in range(header(I).closure_count):
        row = closure_of(I, M, n)
        if row.clamp != 0.0:
            continue
        for i in range(3):
            row.gap[i] = gap_of_motion(I, M, row, i, x)


@kernel
def scale_gaps(I, M, share):
    """Leave a share of the gaps to be closed."""
    for n in range(header(I).closure_count):
        gap = closure_of(I, M, n).gap
        for i in range(3):
            gap[i] *= share


@kernel
def put_force(I, M, row, i, x):
    """A unit of component i of a closure's force, into the right-hand side x."""
    if row.node < 0.0:
        return
    if row.clamp != 0.0:
        put_clamp(I, M, row, i, x)
        return
    x[6 * int(row.node) + i] = 1.0
    if row.body < 0.0:
        x[6 * int(row.other) + i] = -1.0
        return
    to = 6 * int(free_body_of(I, M, int(row.body)).node)
    x[to + i] = -1.0
    for j in range(3):
        x[to + 3 + j] = -row.follows[3 * i + j]


@inlined
def column_word(I, k):
    """Word of column k of Y; behind the last one is G Y, which is factored."""
    head = header(I)
    return head.closure_work + 6 * head.nodes * k


@kernel
def factor_small(I, M):
    """Fill the small matrix from the columns, and factor it (L U, no pivots: it is symmetric, of
    one sign for closures and of the other for clamps). Returns 0, or 1 + a node where no force
    closes the gap."""
    head = header(I)
    count = 3 * head.closure_count
    S = view(M, column_word(I, count), count * count)
    for r in range(count):
        row = closure_of(I, M, r // 3)
        for c in range(count):
            S[count * r + c] = gap_of_motion(
                I, M, row, r % 3, view(M, column_word(I, c), 6 * head.nodes)
            )
        if row.node < 0.0:
            S[count * r + r] = 1.0
        elif row.clamp != 0.0:
            S[count * r + r] -= 1.0 / row.stiffness
    for k in range(count):
        pivot = S[count * k + k]
        if pivot == 0.0 or pivot != pivot:
            return 1 + int(closure_of(I, M, k // 3).node)
        for r in range(k + 1, count):
            S[count * r + k] /= pivot
            for c in range(k + 1, count):
                S[count * r + c] -= S[count * r + k] * S[count * k + c]
    return 0


@kernel
def close_increment(I, M, x):
    """Add to the tree's increment x what closes the gaps, and keep the forces' changes."""
    head = header(I)
    count = 3 * head.closure_count
    S = view(M, column_word(I, count), count * count)
    for k in range(count):
        row = closure_of(I, M, k // 3)
        value = -row.gap[k % 3] - gap_of_motion(I, M, row, k % 3, x)
        for c in range(k):
            value -= S[count * k + c] * closure_of(I, M, c // 3).change[c % 3]
        row.change[k % 3] = value
    for k in range(count - 1, -1, -1):
        row = closure_of(I, M, k // 3)
        value = row.change[k % 3]
        for c in range(k + 1, count):
            value -= S[count * k + c] * closure_of(I, M, c // 3).change[c % 3]
        row.change[k % 3] = value / S[count * k + k]
    for k in range(count):
        change = closure_of(I, M, k // 3).change[k % 3]
        y = view(M, column_word(I, k), 6 * head.nodes)
        for n in range(6 * head.nodes):
            x[n] += change * y[n]


@kernel
def follow_forces(I, M):
    """The forces follow the last increment; a clamp's follow from the state."""
    for n in range(header(I).closure_count):
        row = closure_of(I, M, n)
        if row.clamp != 0.0:
            continue
        for i in range(3):
            row.force[i] += row.change[i]


@kernel
def keep_forces(I, M):
    """Keep the forces of an accepted state, at arms too: what failed begins with them again, since
    its own may be no numbers, and a matrix is made of them before forces are found anew."""
    head = header(I)
    for n in range(head.closure_count):
        row = closure_of(I, M, n)
        for i in range(3):
            row.kept[i] = row.force[i]
    for n in range(head.arm_count):
        arm = arm_of(I, M, n)
        for i in range(3):
            arm.kept[i] = arm.force[i]


@kernel
def give_back_forces(I, M):
    """Those that were kept."""
    head = header(I)
    for n in range(head.closure_count):
        row = closure_of(I, M, n)
        for i in range(3):
            row.force[i] = row.kept[i]
    for n in range(head.arm_count):
        arm = arm_of(I, M, n)
        for i in range(3):
            arm.force[i] = arm.kept[i]


@kernel
def open_closure(I, M, node):
    """The end of a line at a node is let go; returns whether it was held by a closure."""
    open_clamp(I, M, node)
    for n in range(header(I).closure_count):
        row = closure_of(I, M, n)
        if row.node == node:
            row.node = -1.0
            for i in range(3):
                row.force[i] = 0.0
                row.kept[i] = 0.0
            return True
    return False
