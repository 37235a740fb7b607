"""What the water of another depth drags is in Newton's matrix."""

from __future__ import annotations

import numpy as np
import pytest
from newton_matrix import differences
from numpy.typing import NDArray

import cablemodel as cm
from cablemodel.solvers import library as entry
from cablemodel.solvers.finite_element.linearisation import matrices
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header


@pytest.mark.parametrize("planar", [True, False])
def test_matrix_is_the_derivative_in_a_sheared_current(planar: bool) -> None:
    """A curved line through two slopes of the current's table, and beyond its end."""
    across = 0.0 if planar else 0.5
    table = [
        {"z": z, "velocity": [x, across * x * x, 0.0]}
        for z, x in ((0.0, 1.5), (-4.0, 0.2), (-7.0, 0.9))
    ]
    kind = {"diameter": 0.02, "mass": 1.0, "axial_stiffness": 1e4, "bending_stiffness": 0.3}
    model = cm.CableModel(
        cm.load_scene(
            {
                "environment": {"current": {"table": table}},
                "cable_types": {"c": {**kind, "drag_tangential": 0.05}},
                "line": [{"cable": {"type": "c", "length": 10, "elements": 8}}],
                "initial": {"straight": [0.3, 0, -1]},
            }
        ),
        planar=planar,
    )
    memory = model._solver.memory
    dimension, nodes = int(memory.header.dimension), int(memory.header.nodes)
    assert dimension == (2 if planar else 3)
    count = 2 * dimension * nodes
    random = np.random.default_rng(2)
    for place, size in ((Header.position, 0.02), (Header.velocity, 0.1)):
        memory.array(place, count)[:] += size * random.standard_normal(count)
    edges = memory.array(Header.edges, nodes, at.EDGE_WORDS)
    normal, along = edges[:, at.Edge.drag_normal].copy(), edges[:, at.Edge.drag_tangential].copy()

    def drag_of(share: float) -> None:
        edges[:, at.Edge.drag_normal] = share * normal
        edges[:, at.Edge.drag_tangential] = share * along

    q = memory.array(Header.position, count)
    own = q.copy()

    def forces(change: NDArray[np.float64]) -> NDArray[np.float64]:
        out = np.zeros(count)
        q[:] = own + change
        entry.residual(memory.ints, memory.reals, out, np.zeros(2 * nodes))
        q[:] = own
        return out

    found, expected = np.zeros((count, count)), np.zeros((count, count))
    for share, sign in ((1.0, 1.0), (0.0, -1.0)):  # tensions would round what drag is
        drag_of(share)
        found += sign * matrices(memory)[2].toarray()
        expected += sign * differences(forces, count, 1e-5)
    free = slice(dimension, None)  # the tow point is held
    assert np.abs(expected).max() > 1.0
    largest = np.abs(expected).max()
    assert found[free, free] == pytest.approx(expected[free, free], rel=1e-4, abs=1e-5 * largest)
