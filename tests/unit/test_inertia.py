"""Eigenvalues with a negative real part are counted by the sign of a matrix."""

import numba
import numpy as np
import pytest

from cablemodel.solvers.finite_element.kernels.line.inertia import negative_eigenvalues
from cablemodel.solvers.shared.compile import OPTIONS


@numba.jit(**OPTIONS)
def compiled(matrix, size, work, inverse):
    return negative_eigenvalues(matrix, size, work, inverse)


def counted(matrix: np.ndarray) -> int:
    size = len(matrix)
    return compiled(matrix.ravel().copy(), size, np.zeros(size * size), np.zeros(size * size))


@pytest.mark.parametrize("size", [2, 3, 4, 6, 40, 120])
def test_it_counts_as_eigenvalues_do(size):
    random = np.random.default_rng(size)
    for _ in range(200 // size + 5):
        matrix = random.standard_normal((size, size))
        assert counted(matrix) == np.sum(np.linalg.eigvals(matrix).real < 0.0)


@pytest.mark.parametrize("apart", [1.0, 1e3, 1e6])
def test_rows_and_columns_of_other_units_make_no_difference(apart):
    """As places in metres beside slopes, of stiff cable."""
    random = np.random.default_rng(1)
    for _ in range(50):
        matrix = random.standard_normal((6, 6))
        scale = apart ** random.uniform(-1.0, 1.0, 6)
        expected = np.sum(np.linalg.eigvals(matrix).real < 0.0)
        assert counted(matrix * scale[:, None] / scale) == expected


@pytest.mark.parametrize("part", [1e-2, 1e-4, 1e-6])
def test_what_hardly_grows_while_it_swings_is_told_from_what_decays(part):
    """Real parts of so much of the imaginary ones, in axes that are no eigenvectors."""
    random = np.random.default_rng(2)
    for _ in range(20):
        turns = [np.array([[s * part, 1.0], [-1.0, s * part]]) for s in (1.0, -1.0, 1.0)]
        matrix = np.zeros((6, 6))
        for k, turn in enumerate(turns):
            matrix[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = (k + 1.0) * turn
        axes = random.standard_normal((6, 6)) + 3.0 * np.eye(6)
        assert counted(axes @ matrix @ np.linalg.inv(axes)) == 2


def test_a_singular_matrix_counts_wholly():
    """It is not told that nothing grows."""
    assert counted(np.zeros((4, 4))) == 4
