"""Small motions of the finite elements about a state: matrices over the free unknowns."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cablemodel import library as entry
from cablemodel.block import Block
from cablemodel.kernels import layout as at

FloatArray = NDArray[np.float64]


def small_motions(block: Block) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Mass, damping, stiffness, (n, n) each; tension is condensed out. The block stays as it is."""
    stiffness = _newton_matrix(block, 0.0, 0.0)
    damping = _newton_matrix(block, 1.0, 0.0) - stiffness
    # A large factor keeps the mass from drowning in the axial stiffness.
    guess = _newton_matrix(block, 0.0, 1.0) - stiffness
    factor = float(np.abs(np.diag(stiffness)).max() / max(np.abs(np.diag(guess)).max(), 1e-30))
    factor = max(1.0, factor)
    mass = (_newton_matrix(block, 0.0, factor) - stiffness) / factor
    basis = _free_motions(block)
    return basis.T @ mass @ basis, basis.T @ damping @ basis, basis.T @ stiffness @ basis


def natural_frequencies(
    mass: FloatArray, _damping: FloatArray, stiffness: FloatArray, count: int
) -> FloatArray:
    """The lowest undamped ones [rad/s], (count,)."""
    from scipy.linalg import eigh

    symmetric = 0.5 * (stiffness + stiffness.T), 0.5 * (mass + mass.T)
    values = eigh(*symmetric, eigvals_only=True)
    return np.asarray(np.sqrt(np.maximum(values[:count], 0.0)), dtype=np.float64)


def newton_blocks(
    block: Block, of_velocity: float, of_acceleration: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Stiffness and these multiples of damping and mass, before supports and hinges.

    Returns each node's own block, what ties its parent to it (the parent's rows) and what ties it
    to its parent, (nodes, size, size) each; size: places and slopes. The block stays as it is.
    """
    ints = block.ints
    kept = block.image.copy()
    entry.assemble(ints, block.reals, of_velocity, of_acceleration)
    nodes, size = int(ints[at.I_NODES]), 2 * int(ints[at.I_DIMENSION])
    diagonal, upper, lower = (
        block.array(place, nodes, size, size).copy()
        for place in (at.O_DIAGONAL, at.O_UPPER, at.O_LOWER)
    )
    block.image[:] = kept
    return diagonal, upper, lower


def _newton_matrix(block: Block, of_velocity: float, of_acceleration: float) -> FloatArray:
    """Stiffness and these multiples of damping and mass, over all nodes' unknowns, dense."""
    diagonal, upper, lower = newton_blocks(block, of_velocity, of_acceleration)
    nodes, size = diagonal.shape[:2]
    parent = block.integers(at.O_PARENT, nodes)
    joint = block.integers(at.O_JOINT, nodes)
    matrix = np.zeros((nodes * size, nodes * size))
    for node in range(nodes):
        rows = slice(node * size, (node + 1) * size)
        matrix[rows, rows] += diagonal[node]
        if node and joint[node] != at.JOINT_HINGE:
            above = slice(int(parent[node]) * size, (int(parent[node]) + 1) * size)
            matrix[above, rows] += upper[node]
            matrix[rows, above] += lower[node]
    return matrix


def _free_motions(block: Block) -> FloatArray:
    """Columns that span the motions which supports and joints allow."""
    ints = block.ints
    nodes, dimension = int(ints[at.I_NODES]), int(ints[at.I_DIMENSION])
    size = 2 * dimension
    basis = np.eye(nodes * size)
    drop: list[int] = []
    for row in block.array(at.O_CONSTRAINT, int(ints[at.I_CONSTRAINTS]), at.CONSTRAINT_WORDS):
        first = int(row[at.C_NODE]) * size
        drop += range(first, first + dimension)
        if row[at.C_CLAMPED] == at.EXACTLY:
            direction = row[at.C_DIRECTION : at.C_DIRECTION + dimension]
            slopes = slice(first + dimension, first + size)
            basis[slopes, slopes] = 0.0
            basis[slopes, first + dimension] = direction
            drop += range(first + dimension + 1, first + size)
    parent = block.integers(at.O_PARENT, nodes)
    hinged = block.integers(at.O_JOINT, nodes) == at.JOINT_HINGE
    for node in np.flatnonzero(hinged):
        own = slice(int(node) * size, int(node) * size + dimension)
        above = slice(int(parent[node]) * size, int(parent[node]) * size + dimension)
        basis[own, above] = np.eye(dimension)
        drop += range(own.start, own.stop)
    return np.asarray(np.delete(basis, drop, axis=1), dtype=np.float64)
