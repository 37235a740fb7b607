"""The elements in space hold those in a plane: their Newton matrices agree in the plane."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from newton_matrix import dense
from numpy.typing import NDArray

import cablemodel as cm
from cablemodel.solvers import library as entry
from cablemodel.solvers.finite_element.block import Block

WAVES = {"regular": {"height": 1.5, "period": 6.0}}
CURRENT = [0.4, 0.0, 0.0]


def matrix(environment: dict[str, Any], *, planar: bool | None) -> NDArray[np.float64]:
    """Stiffness, damping and mass at an instant under way, (nodes, unknowns, nodes, unknowns)."""
    scene = {
        "environment": environment,
        "cable_types": {
            "K": {
                "diameter": 0.0173,
                "mass": 0.3,
                "axial_stiffness": 3e5,
                "bending_stiffness": 1.0,
            }
        },
        "line": [{"cable": {"type": "K", "length": 12.0, "elements": 5, "model": "elastica"}}],
        "vessel": {"velocity": [{"t": 0, "velocity": [0, 0, 0]}, {"t": 2, "velocity": [1, 0, 0]}]},
        # Tighter, steps follow what a kink makes ring, and what differs by rounding grows.
        "solver": {"tolerance": 1e-2},
        "run": {"duration": 10.0},
    }
    model = cm.CableModel(cm.load_scene(scene), planar=planar)
    model.step_to(3.0)
    memory = model._solver.memory
    assert isinstance(memory, Block)
    nodes, size = int(memory.header.nodes), 2 * int(memory.header.dimension)
    entry.assemble(memory.ints, memory.reals, 3.0, 7.0)
    return dense(memory, nodes, size).reshape(nodes, size, nodes, size)


@pytest.mark.parametrize("environment", [{}, {"current": CURRENT}, {"waves": WAVES}])
def test_matrices_agree_in_the_plane(environment: dict[str, Any]) -> None:
    plane = matrix(environment, planar=None)
    space = matrix(environment, planar=False)
    within = [0, 2, 3, 5]  # x and z of position and slope
    found = space[:, within][:, :, :, within]
    np.testing.assert_allclose(found, plane, rtol=1e-6, atol=1e-11 * np.abs(plane).max())
    across = space[:, within][:, :, :, [1, 4]]
    assert np.abs(across).max() < 1e-11 * np.abs(plane).max()
