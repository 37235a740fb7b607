"""Nodes of a system go along with supports that are moved before a start: a first shape.

Elements act as springs of length over stiffness one: displacements solve the Laplace equation of
the graph that they make, as meshes that follow a moving boundary do, by conjugate gradients. Nodes
that share a place, or are of one body, are a group that has one displacement.
"""

import math

from cablemodel.solvers.finite_element.kernels.line.swinging import dot
from cablemodel.solvers.shared.access import (
    closure_of,
    constraint_of,
    edge_of,
    free_body_of,
    header,
)
from cablemodel.solvers.shared.compile import inlined, kernel, outlined, view
from cablemodel.solvers.shared.layout import (
    JOINT_FREE,
    JOINT_NONE,
    JOINT_ROOT,
    JOINT_ROOT_FREE,
)

LAPLACE_ACCURACY = 1e-12  # of the square of the residual at first: what conjugate gradients leave
FOLLOW_WORDS = 14  # of each node, that follow_supports works with


@inlined
def is_free_body(joint):
    """Whether a node's second three words turn a free body: they are no slope."""
    return joint == JOINT_FREE or joint == JOINT_ROOT_FREE


@inlined
def rotate(c, s, vector, first, second):
    """Two words of a vector, turned."""
    x = vector[first]
    y = vector[second]
    vector[first] = c * x - s * y
    vector[second] = s * x + c * y


@kernel
def rotate_system(I, M, x, y, angle):
    """Turn a system about the vertical through a place of the block's coordinates [m], [rad]."""
    head = header(I)
    c = math.cos(angle)
    s = math.sin(angle)
    for node in range(head.nodes):
        q = view(M, head.position + 6 * node, 6)
        q[0] -= x
        q[1] -= y
        rotate(c, s, q, 0, 1)
        q[0] += x
        q[1] += y
        if not is_free_body(I[head.joint + node]):
            rotate(c, s, q, 3, 4)
    for n in range(head.free_count):
        axes = free_body_of(I, M, n).rotation
        for j in range(3):  # by rows: its columns are the body's axes
            rotate(c, s, axes, j, 3 + j)


@kernel
def find_groups(I, M, group):
    """Of each node the first one that shares its place or is of the same body, (nodes,)."""
    head = header(I)
    for node in range(head.nodes):
        joint = I[head.joint + node]
        apart = node == 0 or joint == JOINT_NONE or joint >= JOINT_ROOT
        group[node] = node if apart else group[I[head.parent + node]]
    for n in range(head.closure_count):
        row = closure_of(I, M, n)
        if row.node < 0.0 or row.clamp != 0.0:
            continue
        other = row.other if row.body < 0.0 else free_body_of(I, M, int(row.body)).node
        one = group[int(row.node)]
        to = group[int(other)]
        for node in range(head.nodes):
            if group[node] == one:
                group[node] = to


@outlined
def laplacian(I, M, group, held, growth, grown, displacement, out):
    """Forces of springs between groups, (nodes, 3), with these displacements; 0 on what is held.

    growth: whether springs have grown, by `grown` (nodes, 3)."""
    head = header(I)
    count = 3 * head.nodes
    for n in range(count):
        out[n] = 0.0
    for node in range(1, head.nodes):
        if I[head.joint + node] != JOINT_NONE:
            continue
        h = edge_of(I, M, node).length
        above = 3 * int(group[I[head.parent + node]])
        below = 3 * int(group[node])
        for i in range(3):
            more = grown[3 * node + i] if growth else 0.0
            force = (displacement[below + i] - displacement[above + i] - more) / h
            out[below + i] += force
            out[above + i] -= force
    for n in range(count):
        if held[n // 3] != 0.0:
            out[n] = 0.0


@kernel
def solve_laplace(I, M, group, held, grown, displacement, work):
    """Displacements of all groups from those of what is held: conjugate gradients. work: (3, nodes,
    3)."""
    nodes = header(I).nodes
    count = 3 * nodes
    residual = view(work, 0, count)
    direction = view(work, count, count)
    image = view(work, 2 * count, count)
    laplacian(I, M, group, held, True, grown, displacement, residual)
    for n in range(count):
        residual[n] = -residual[n]
        direction[n] = residual[n]
    size = dot(residual, residual)
    first = size
    for _iteration in range(nodes):
        if not size > LAPLACE_ACCURACY * first:
            return
        laplacian(I, M, group, held, False, grown, direction, image)
        step = size / dot(direction, image)
        for n in range(count):
            displacement[n] += step * direction[n]
            residual[n] -= step * image[n]
        after = dot(residual, residual)
        for n in range(count):
            direction[n] = residual[n] + after / size * direction[n]
        size = after


@kernel
def follow_supports(I, M, before, grown, work):
    """Lines and bodies after supports, which have moved since `before` (nodes, 6), and after
    elements whose chords have grown by `grown` (nodes, 3). Slopes turn by half of what each side
    turns. work: FOLLOW_WORDS of each node."""
    head = header(I)
    nodes = head.nodes
    group = view(work, 0, nodes)
    held = view(work, nodes, nodes)
    displacement = view(work, 2 * nodes, 3 * nodes)
    for n in range(nodes):
        held[n] = 0.0
    for n in range(3 * nodes):
        displacement[n] = 0.0
    find_groups(I, M, group)
    for n in range(head.constraint_count):
        node = int(constraint_of(I, M, n).node)
        of = int(group[node])
        held[of] = 1.0
        for i in range(3):
            displacement[3 * of + i] = M[head.position + 6 * node + i] - before[6 * node + i]
    solve_laplace(I, M, group, held, grown, displacement, view(work, 5 * nodes, 9 * nodes))
    for node in range(nodes):
        of = int(group[node])
        for i in range(3):
            M[head.position + 6 * node + i] = before[6 * node + i] + displacement[3 * of + i]
    for node in range(1, nodes):
        if I[head.joint + node] != JOINT_NONE:
            continue
        parent = I[head.parent + node]
        h = edge_of(I, M, node).length
        above = int(group[parent])
        below = int(group[node])
        for end in range(2):
            at = node if end == 1 else parent
            if is_free_body(I[head.joint + at]):
                continue
            for i in range(3):
                turn = displacement[3 * below + i] - displacement[3 * above + i]
                M[head.position + 6 * at + 3 + i] += 0.5 * (turn - grown[3 * node + i]) / h
