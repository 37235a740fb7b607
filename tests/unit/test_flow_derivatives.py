"""What a steady pay-out adds to a start: its Newton matrix is the derivative of its forces."""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
import pytest
from newton_matrix import clear, dense, differences
from numpy.typing import NDArray

import cablemodel as cm
from cablemodel.solvers.finite_element.kernels.water.flow import flow_jacobian, flow_residual
from cablemodel.solvers.shared.compile import OPTIONS
from cablemodel.solvers.shared.layout import Header, Scalars

FLOW = 1.7


@numba.jit(**OPTIONS)
def forces(ints: Any, reals: Any, frame: Any, q: Any, v: Any, a: Any, t: Any, out: Any,
           constraint: Any) -> None:  # fmt: skip
    flow_residual(ints, reals, FLOW, frame, q, v, a, t, out, constraint)


@numba.jit(**OPTIONS)
def matrix(ints: Any, reals: Any, frame: Any, q: Any, v: Any, a: Any,
           cv: float) -> None:  # fmt: skip
    flow_jacobian(ints, reals, FLOW, frame, q, v, a, 0.0, cv)


@pytest.mark.parametrize("planar", [True, False])
@pytest.mark.parametrize("layer", [0.0, 1e3, 1.0])
def test_matrix_is_the_derivative(planar: bool, layer: float) -> None:
    """A curved line with a point body in it: all clear of the floor, or all laid on it, by the
    floor's contact layer; or in between, without the body, whose share that rests has no part."""
    lies = layer > 0.0
    body = {"mass": 6, "submerged_weight": 20, "drag_area": 0.02 if layer != 1.0 else 0.0}
    kind = {"diameter": 0.02, "mass": 1.0, "axial_stiffness": 1e6, "bending_stiffness": 0.3}
    model = cm.CableModel(
        cm.load_scene(
            {
                "environment": {
                    "floor": {"z": -9.0 if lies else -90.0, "friction": 0.0},
                    "current": {"table": [{"z": 0, "velocity": [0.3, 0 if planar else 0.4, 0]}]},
                },
                "cable_types": {"c": {**kind, "drag_tangential": 0.05}},
                "line": [
                    {"cable": {"type": "c", "length": 3, "model": "elastica", "elements": 4}},
                    {"body": body},
                    {"cable": {"type": "c", "length": 3, "model": "elastica", "elements": 4}},
                ],
                "vessel": {"position": [0, 0, -8.9 if lies else -1.0]},
                "payout": {
                    "rate": [{"t": 0, "rate": FLOW}],
                    "drum": [{"cable": {"type": "c", "length": 3}}],
                },
                "initial": {"straight": [-1, 0, 0]},
                "solver": {"tolerance": 1e-2},
            }
        ),
        planar=planar,
    )
    ints, reals = model._ints, model._reals
    head = Header(ints)
    state = Scalars(reals)
    memory, nodes = model._solver.memory, int(head.nodes)
    dimension = int(head.dimension)
    assert dimension == (2 if planar else 3)
    size = 2 * dimension
    count = nodes * size
    memory.winch.stage_rate = 0.0
    state.laid = 2.0 if lies else 0.0
    if lies:
        state.floor_depth = layer
    random = np.random.default_rng(4)
    q = memory.array(Header.position, count) + 0.1 * random.standard_normal(count)
    frame = np.array([1.3, 0.2, 0.1][:dimension])
    v = 0.2 * random.standard_normal(count)
    v.reshape(nodes, size)[:, :dimension] += frame
    a, tension = np.zeros(count), random.standard_normal(2 * nodes)
    cv = 0.7

    def at_change(change: NDArray[np.float64]) -> NDArray[np.float64]:
        out, constraint = np.zeros(count), np.zeros(2 * nodes)
        forces(ints, reals, frame, q + change, v + cv * change, a, tension, out, constraint)
        return out

    assert np.abs(at_change(np.zeros(count))).max() > 0.1
    clear(memory, nodes, size)
    matrix(ints, reals, frame, q.copy(), v.copy(), a, cv)
    expected = differences(at_change, count, 1e-6)
    found = dense(memory, nodes, size)
    assert found == pytest.approx(expected, rel=1e-5, abs=1e-5 * np.abs(expected).max())
