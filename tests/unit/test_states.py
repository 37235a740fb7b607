"""States over time, also where the number of nodes changes."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cablemodel.results.states import States, by_label, matrix_of
from cablemodel.variables import APPLIED_INPUT_LABELS


def arc(nodes: int, angle: float = 1.0, radius: float = 10.0) -> Any:
    """A circular arc with exact tangents."""
    phi = np.linspace(0.0, angle, nodes)
    zero = 0.0 * phi
    return SimpleNamespace(
        s=radius * phi,
        position=radius * np.stack([np.sin(phi), zero, np.cos(phi) - 1.0], axis=1),
        tangent=np.stack([np.cos(phi), zero, -np.sin(phi)], axis=1),
        velocity=np.stack([phi, zero, zero], axis=1),
        tension=100.0 - phi,
        curvature=zero + 1.0 / radius,
        bending_moment=zero + 0.1 / radius,
        on_floor=phi > 0.8,
    )


def test_equal_numbers_of_nodes_give_the_values_as_they_are() -> None:
    states = States(np.array([0.0, 1.0]), [matrix_of(arc(9)), matrix_of(arc(9, 0.5))])
    assert states.position.shape == (2, 9, 3)
    assert np.array_equal(states.position[1], arc(9, 0.5).position)
    assert np.array_equal(states.tension[0], arc(9).tension)
    assert states.on_floor.dtype == bool
    assert np.array_equal(states.on_floor[0], arc(9).on_floor)
    assert states.max_curvature == 0.1


def test_changing_numbers_of_nodes_give_even_stations() -> None:
    states = States(np.array([0.0, 1.0]), [matrix_of(arc(6)), matrix_of(arc(9, 1.2))])
    assert states.position.shape == (2, 9, 3)
    assert np.allclose(states.s[0], np.linspace(0.0, 10.0, 9), rtol=0, atol=1e-14)
    # Cubic Hermite on an arc of 0.2 rad: radius h^4/384, 4e-5 m here.
    assert np.allclose(states.position[0], arc(9).position, rtol=0, atol=5e-5)
    assert np.allclose(states.position[1], arc(9, 1.2).position, rtol=0, atol=1e-13)
    assert np.allclose(np.linalg.norm(states.tangent, axis=-1), 1.0)


def test_resampling_keeps_the_ends_and_bears_double_nodes() -> None:
    state = arc(5)
    for name in vars(state):  # two nodes at one place, as at a body
        setattr(state, name, np.insert(getattr(state, name), 2, getattr(state, name)[2], axis=0))
    resampled = States(np.array([0.0]), [matrix_of(state)]).resampled(21)
    assert np.all(np.isfinite(resampled.position))
    assert np.array_equal(resampled.position[0, 0], state.position[0])
    assert np.allclose(resampled.position[0, -1], state.position[-1], rtol=0, atol=1e-14)


def test_no_states_are_empty_arrays() -> None:
    states = States(np.empty(0), [])
    assert len(states) == 0
    assert states.position.shape == (0, 0, 3)
    assert states.tension.shape == (0, 0)
    assert np.isnan(states.max_curvature)


def test_an_index_out_of_range_is_an_error() -> None:
    with pytest.raises(IndexError):
        States(np.array([0.0]), [matrix_of(arc(3))])[1]


def test_inputs_by_label_also_without_steps() -> None:
    assert by_label([], APPLIED_INPUT_LABELS)["payout_rate"].shape == (0,)
    row = np.arange(float(len(APPLIED_INPUT_LABELS)))
    assert by_label([row, row], APPLIED_INPUT_LABELS)["step"].tolist() == [1.0, 1.0]
