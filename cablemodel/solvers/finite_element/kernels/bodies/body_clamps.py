"""Clamps of lines' ends at free bodies: the slope follows a direction that turns with the body.

With t along the slope d, u the direction as the body has turned it, and k a stiffness as of a body
in a line (rigid.py), a clamp has the energy

    k (1 - t.u) = k |t - u|^2 / 2,

whose forces on d and on the rotation vector theta are A^T f and -B^T f, f = k (t - u),
A = dt/dd and B = du/dtheta. Second derivatives are those of t and u, in the blocks of both nodes,
and k [A, -B]^T [A, -B], which ties two nodes that may be anywhere in the tree. That is
2 k diag(A^T A, B^T B), in their blocks, minus k P P^T with P = [A, B]^T: the tree is eliminated as
if the end and the body were held each by itself, and three columns take that back (closures.py).
Rows are those of closures, with the direction for the place at the body.
"""

from cablemodel.solvers.finite_element.kernels.bodies.free_bodies import arm_moment, follow_at_body
from cablemodel.solvers.finite_element.kernels.bodies.rigid import clamp_stiffness, stiffen_gently
from cablemodel.solvers.finite_element.kernels.bodies.rotation import to_earth_axes
from cablemodel.solvers.finite_element.kernels.bodies.slopes import slope_direction
from cablemodel.solvers.shared.access import (
    closure_of,
    edge_of,
    free_body_of,
    header,
    tension_of,
    vector,
)
from cablemodel.solvers.shared.compile import kernel, view
from cablemodel.solvers.shared.layout import JOINT_ARM, MODEL_HYBRID


@kernel
def clamp_axes(I, M, row, q, axis, along):
    """Unit vectors of the direction as the body has turned it, and along the slope; returns the
    slope's length and the cosine between both. The body's motion is that of q."""
    to_earth_axes(free_body_of(I, M, int(row.body)).motion.turn, row.place, axis)
    return slope_direction(3, q, 6 * int(row.node) + 3, axis, along)


@kernel
def add_body_clamp(I, M, row, q, out):
    """Add a clamp's forces to those of the line's node, and of the body's."""
    axis = vector()
    along = vector()
    moment = vector()
    length, cosine = clamp_axes(I, M, row, q, axis, along)
    at = 6 * int(row.node) + 3
    body = free_body_of(I, M, int(row.body))
    to = 6 * int(body.node) + 3
    for i in range(3):
        out[at + i] -= row.stiffness / length * (axis[i] - cosine * along[i])
        row.force[i] = row.stiffness * (axis[i] - along[i])
    arm_moment(row, body.motion, row.force, moment)
    for i in range(3):
        out[to + i] += moment[i]


@kernel
def add_clamp_derivatives(I, M, row, q, v, a):
    """Add a clamp's second derivatives to the blocks of both nodes; leave A and B in its row."""
    head = header(I)
    axis = vector()
    along = vector()
    force = vector()
    k = row.stiffness
    length, cosine = clamp_axes(I, M, row, q, axis, along)
    node = int(row.node)
    square = k / (length * length)
    D = view(M, head.diagonal + 36 * node, 36)
    for i in range(3):
        force[i] = k * (axis[i] - along[i])
        for j in range(3):
            unit = 1.0 if i == j else 0.0
            across = unit - along[i] * along[j]
            row.slopes[3 * i + j] = across / length
            value = along[i] * axis[j] + axis[i] * along[j]
            value += cosine * (unit - 3.0 * along[i] * along[j])
            D[6 * (3 + i) + 3 + j] += square * (value + across)
    body = free_body_of(I, M, int(row.body))
    follow_at_body(I, M, row, body, force, q, v, a)
    D = view(M, head.diagonal + 36 * int(body.node), 36)
    for i in range(3):
        for j in range(3):
            value = 0.0
            for n in range(3):
                value += row.follows[3 * n + i] * row.follows[3 * n + j]
            D[6 * (3 + i) + 3 + j] += 2.0 * k * value


@kernel
def clamp_of_motion(I, M, row, i, x):
    """Component i of P^T x, of a motion x of the nodes."""
    at = 6 * int(row.node) + 3
    to = 6 * int(free_body_of(I, M, int(row.body)).node) + 3
    value = 0.0
    for j in range(3):
        value += row.slopes[3 * i + j] * x[at + j] + row.follows[3 * i + j] * x[to + j]
    return value


@kernel
def put_clamp(I, M, row, i, x):
    """Column i of P into the right-hand side x."""
    at = 6 * int(row.node) + 3
    to = 6 * int(free_body_of(I, M, int(row.body)).node) + 3
    for j in range(3):
        x[at + j] = row.slopes[3 * i + j]
        x[to + j] = row.follows[3 * i + j]


@kernel
def turned_back(I, M, q):
    """The node of a line that is turned back at its clamp; -1: none is."""
    axis = vector()
    along = vector()
    for n in range(header(I).closure_count):
        row = closure_of(I, M, n)
        if row.clamp != 0.0 and row.node >= 0.0:
            _length, cosine = clamp_axes(I, M, row, q, axis, along)
            if cosine < 0.0:
                return int(row.node)
    return -1


@kernel
def body_clamp_energy(I, M, q):
    """What all these clamps hold [J]."""
    axis = vector()
    along = vector()
    total = 0.0
    for n in range(header(I).closure_count):
        row = closure_of(I, M, n)
        if row.clamp != 0.0 and row.node >= 0.0:
            _length, cosine = clamp_axes(I, M, row, q, axis, along)
            total += row.stiffness * (1.0 - cosine)
    return total


@kernel
def update_body_clamps(I, M, share):
    """Stiffnesses by the tensions, of which `share` is the present one; see rigid.update_clamps."""
    head = header(I)
    axis = vector()
    along = vector()
    q = view(M, head.position, 6 * head.nodes)
    for n in range(head.closure_count):
        row = closure_of(I, M, n)
        if row.clamp == 0.0 or row.node < 0.0:
            continue
        node = int(row.node)
        begins = I[head.joint + node] == JOINT_ARM
        element = node + 1 if begins else node
        edge = edge_of(I, M, element)
        slope = tension_of(I, M, element).slope
        tension = tension_of(I, M, element).mean + (-slope if begins else slope)
        before = row.tension
        row.tension += share * (tension - before)
        resolved = edge.model != MODEL_HYBRID
        target = clamp_stiffness(M, edge, row.tension, edge.length, resolved)
        if not resolved and target > row.stiffness:
            _length, cosine = clamp_axes(I, M, row, q, axis, along)
            target = stiffen_gently(
                M, row.stiffness, target, row.tension, before, 1.0 - cosine, share
            )
        row.stiffness = target


@kernel
def open_clamp(I, M, node):
    """The end of a line at a node is let go by what clamps it."""
    for n in range(header(I).closure_count):
        row = closure_of(I, M, n)
        if row.clamp != 0.0 and row.node == node:
            row.node = -1.0
