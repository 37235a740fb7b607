"""Small motions of the finite elements about a state: matrices over the free unknowns."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers import library as entry
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header

FloatArray = NDArray[np.float64]

OWN = 0.2
"""Share of the stabilisation in what holds a motion above which it is the elements' own."""
LOCKED = 0.1
"""Of what holds motions across an element that bends: more of it would hold them too."""
STIFFEST = 1e6
"""Of the stabilisation: what is stiffer drowns all else in rounding, at 1e8."""
LINEAR_ROUNDING = 1e-12
Matrix = Any
"""Of scipy.sparse."""
SHARES_PLACE = at.JOINT_HINGE, at.JOINT_ARM, at.JOINT_FREE
"""Joints at which a node's place is its parent's, or follows it."""
TIED = 0, at.JOINT_BODY
"""Those with an element or a body between both."""


def small_motions(block: Block) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Mass, damping, stiffness, (n, n) each; tension is condensed out. The block stays as it is."""
    basis, _names = free_motions(block)
    mass, damping, stiffness = (basis.T @ part @ basis for part in matrices(block))
    return mass.toarray(), damping.toarray(), stiffness.toarray()


def matrices(block: Block) -> tuple[Matrix, Matrix, Matrix]:
    """The same over all nodes' places and slopes, what holds them left out, sparse."""
    from scipy.sparse import csc_matrix

    nodes, size = int(block.header.nodes), 2 * int(block.header.dimension)
    kept = block.image.copy()
    words = np.empty((3, 3, nodes, size, size))
    entry.motion_matrices(block.ints, block.reals, words.reshape(-1))
    block.image[:] = kept
    stiffness, damping, mass = (_sparse(block, part) for part in words)
    if block.header.closure_count:
        for columns in clamps_at_bodies(block):
            stiffness -= csc_matrix(columns) @ csc_matrix(columns).T
    return mass, damping, stiffness


def natural_frequencies(block: Block, count: int) -> FloatArray:
    """The lowest undamped ones [rad/s], (count,), or as many as the mesh has; the block stays.

    The third mode of an element's strain is held by a stabilisation that is a number, not a
    property of the cable: with that, elements stretch and shorten within themselves at frequencies
    among those of the line. Here it is the cable's own stiffness where an element is straight; of
    one that bends, which may not be held like that, a frequency that depends on the stabilisation
    is left out.
    """
    from scipy.linalg import eigh

    edges = block.array(Header.edges, int(block.header.nodes), at.EDGE_WORDS)
    kept = edges[:, at.Edge.stabilisation].copy()
    edges[:, at.Edge.stabilisation] = stiff = _stiffened(block)
    mass, _damping, stiffness = (0.5 * (m + m.T) for m in small_motions(block))
    bent = stiff * edges[:, at.Edge.compliance] < 1.0 - LINEAR_ROUNDING
    edges[bent, at.Edge.stabilisation] *= 2.0
    stiffer = small_motions(block)[2]
    edges[:, at.Edge.stabilisation] = kept
    values, motions = eigh(stiffness, mass)
    # The derivative of the square of a frequency to the stabilisation, in units of both.
    change = np.einsum("im,ij,jm->m", motions, 0.5 * (stiffer + stiffer.T) - stiffness, motions)
    cable = change < OWN * np.abs(values) + LINEAR_ROUNDING * np.abs(values).max()
    return np.asarray(np.sqrt(np.maximum(values[cable][:count], 0.0)), dtype=np.float64)


def _stiffened(block: Block) -> FloatArray:
    """The stabilisation of each element [N], (nodes,): EA, or where the element turns by an angle a
    as much as takes from its motions across, which tension holds, a share of `LOCKED`."""
    nodes, dimension = int(block.header.nodes), int(block.header.dimension)
    edges = block.array(Header.edges, nodes, at.EDGE_WORDS)
    slopes = block.array(Header.position, nodes, 2, dimension)[:, 1]
    sizes = np.linalg.norm(slopes, axis=1, keepdims=True)
    slopes = slopes / np.where(sizes > 0.0, sizes, 1.0)  # a free body has none
    turn = np.linalg.norm(slopes - slopes[block.integers(Header.parent, nodes)], axis=1)
    tension = np.abs(block.array(Header.tension, nodes, 2)[:, 0])
    with np.errstate(divide="ignore", invalid="ignore"):
        most = np.where(turn > LINEAR_ROUNDING, LOCKED * tension / turn**2, np.inf)
        axial = np.where(
            edges[:, at.Edge.compliance] > 0.0, 1.0 / edges[:, at.Edge.compliance], 0.0
        )
    most = np.minimum(most, STIFFEST * edges[:, at.Edge.stabilisation])
    return np.maximum(edges[:, at.Edge.stabilisation], np.minimum(axial, most))


def newton_blocks(
    block: Block, of_velocity: float, of_acceleration: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Stiffness and these multiples of damping and mass, before supports and hinges.

    Returns each node's own block, what ties its parent to it (the parent's rows) and what ties it
    to its parent, (nodes, size, size) each; size: places and slopes. The block stays as it is.
    """
    ints = block.ints
    head = Header(ints)
    kept = block.image.copy()
    block.scalars.bristles_damped = 0.0  # that is for steps
    entry.assemble(ints, block.reals, of_velocity, of_acceleration)
    nodes, size = int(head.nodes), 2 * int(head.dimension)
    diagonal, upper, lower = (
        block.array(place, nodes, size, size).copy()
        for place in (Header.diagonal.word, Header.upper.word, Header.lower.word)
    )
    block.image[:] = kept
    return diagonal, upper, lower


def _sparse(block: Block, parts: FloatArray) -> Matrix:
    """A matrix over all nodes' unknowns from each node's own block, what ties its parent to it and
    it to its parent, (3, nodes, size, size)."""
    from scipy.sparse import csc_matrix

    diagonal, upper, lower = parts
    nodes, size = diagonal.shape[:2]
    node = np.arange(nodes)
    tied = np.isin(block.integers(Header.joint, nodes), TIED) & (node > 0)
    own, above = node[tied], block.integers(Header.parent, nodes)[tied]
    word = np.arange(size)
    rows, columns = np.concatenate([node, above, own]), np.concatenate([node, own, above])
    at_rows = np.broadcast_to(size * rows[:, None, None] + word[:, None], (len(rows), size, size))
    at_columns = np.broadcast_to(size * columns[:, None, None] + word, at_rows.shape)
    values = np.concatenate([diagonal, upper[tied], lower[tied]])
    shape = nodes * size, nodes * size
    found = csc_matrix((values.ravel(), (at_rows.ravel(), at_columns.ravel())), shape=shape)
    found.eliminate_zeros()
    return found


def free_motions(block: Block) -> tuple[Matrix, tuple[str, ...]]:
    """Columns that span the motions which supports and joints allow, sparse, and their names:
    ``nodes[2].position.x``, ``nodes[2].slope.x``; of a slope that is clamped ``.along``."""
    from scipy.sparse import csc_matrix, eye

    ints = block.ints
    head = Header(ints)
    nodes, dimension = int(head.nodes), int(head.dimension)
    size = 2 * dimension
    basis = eye(nodes * size, format="lil")
    axes = "xyz" if dimension == 3 else "hz"
    names = [
        f"nodes[{node}].{kind}.{axis}"
        for node in range(nodes)
        for kind in ("position", "slope")
        for axis in axes
    ]
    drop: list[int] = []
    for row in block.array(Header.constraints, int(head.constraint_count), at.CONSTRAINT_WORDS):
        held = int(row[at.Constraint.node])
        first = held * size
        drop += range(first, first + dimension)
        if row[at.Constraint.clamped] == at.EXACTLY:
            direction = row[at.Constraint.direction : at.Constraint.direction.word + dimension]
            slopes = slice(first + dimension, first + size)
            basis[slopes] = 0.0
            basis[slopes, first + dimension] = direction[:, None]
            names[first + dimension] = f"nodes[{held}].slope.along"
            drop += range(first + dimension + 1, first + size)
    parent = block.integers(Header.parent, nodes)
    joint = block.integers(Header.joint, nodes)
    arms, gaps = ties_to_bodies(block) if head.parts else ({}, [])
    for node in np.flatnonzero(np.isin(joint, SHARES_PLACE)):
        own = slice(int(node) * size, int(node) * size + dimension)
        above = slice(int(parent[node]) * size, int(parent[node]) * size + dimension)
        motion = basis[above]
        if joint[node] == at.JOINT_ARM:
            turns = slice(above.stop, above.stop + dimension)
            motion = motion + csc_matrix(arms[int(node)]) @ basis[turns]
        basis[own] = motion
        drop += range(own.start, own.stop)
    kept = np.setdiff1d(np.arange(nodes * size), drop)
    basis = basis.tocsc()[:, kept]
    found = tuple(names[column] for column in kept)
    if gaps:
        basis = _closed(basis, np.vstack(gaps))
        return basis, tuple(f"motion {k}" for k in range(basis.shape[1]))
    return basis, found


def _closed(basis: Matrix, gaps: FloatArray) -> Matrix:
    """Of these motions those that leave gaps (n, unknowns) closed."""
    from scipy.linalg import null_space
    from scipy.sparse import csc_matrix, hstack

    opens = gaps @ basis
    some = np.any(opens != 0.0, axis=0)
    return hstack(
        [basis[:, ~some], basis[:, some] @ csc_matrix(null_space(opens[:, some]))]
    ).tocsc()


def clamps_at_bodies(block: Block) -> list[FloatArray]:
    """What is to be taken from the nodes' own blocks for each clamp of an end at a body, times its
    transpose: sqrt(k) P of kernels/bodies/body_clamps.py, (unknowns, 3)."""
    head = Header(block.ints)
    kept = block.image.copy()
    entry.assemble(block.ints, block.reals, 0.0, 0.0)
    rows = block.array(Header.closures, int(head.closure_count), at.CLOSURE_WORDS).copy()
    block.image[:] = kept
    bodies = block.array(Header.free_bodies, int(head.free_count), at.FREE_WORDS)
    found = []
    for row in rows[(rows[:, at.Closure.clamp] != 0.0) & (rows[:, at.Closure.node] >= 0.0)]:
        columns = np.zeros((6 * int(head.nodes), 3))
        own = 6 * int(row[at.Closure.node]) + 3
        body = 6 * int(bodies[int(row[at.Closure.body]), at.FreeBody.node]) + 3
        columns[own : own + 3] = row[at.Closure.slopes.span].reshape(3, 3).T
        columns[body : body + 3] = row[at.Closure.follows.span].reshape(3, 3).T
        found.append(np.sqrt(row[at.Closure.stiffness]) * columns)
    return found


def ties_to_bodies(block: Block) -> tuple[dict[int, FloatArray], list[FloatArray]]:
    """Of a system: how places at bodies' points follow the bodies' rotation vectors, (3, 3) by
    node; and what motions of all nodes make of the gap of each end that closes a cycle, (3, n)."""
    head = Header(block.ints)
    kept = block.image.copy()
    entry.assemble(block.ints, block.reals, 0.0, 0.0)
    nodes = int(head.nodes)
    beside = block.array(Header.lower, nodes, 36)[:, 18:27].copy()
    rows = block.array(Header.closures, int(head.closure_count), at.CLOSURE_WORDS).copy()
    block.image[:] = kept
    joint = block.integers(Header.joint, nodes)
    arms = {int(n): beside[n].reshape(3, 3) for n in np.flatnonzero(joint == at.JOINT_ARM)}
    bodies = block.array(Header.free_bodies, int(head.free_count), at.FREE_WORDS)
    gaps = []
    for row in rows:
        if row[at.Closure.node] < 0.0 or row[at.Closure.clamp] != 0.0:
            continue
        gap = np.zeros((3, 6 * nodes))
        own, body = 6 * int(row[at.Closure.node]), int(row[at.Closure.body])
        gap[:, own : own + 3] = np.eye(3)
        other = 6 * int(row[at.Closure.other] if body < 0 else bodies[body, at.FreeBody.node])
        gap[:, other : other + 3] -= np.eye(3)
        if body >= 0:
            gap[:, other + 3 : other + 6] -= row[at.Closure.follows.span].reshape(3, 3)
        gaps.append(gap)
    return arms, gaps
