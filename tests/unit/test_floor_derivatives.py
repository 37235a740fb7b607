"""The law of contact is smooth and has an energy; the floor's Newton matrix is the derivative of
its forces."""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
import pytest
from newton_matrix import clear, dense, differences
from numpy.typing import NDArray

import cablemodel as cm
from cablemodel.solvers.finite_element.kernels.floor.contact import contact_law
from cablemodel.solvers.finite_element.kernels.floor.floor_forces import (
    floor_jacobian,
    floor_residual,
)
from cablemodel.solvers.finite_element.start.laid_start import law_of_contact
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.compile import OPTIONS
from cablemodel.solvers.shared.layout import Header, Scalars
from cablemodel.solvers.shared.numbers import LYING


@numba.jit(**OPTIONS)
def laws(gaps: Any, out: Any) -> None:
    for n in range(len(gaps)):
        out[0, n], out[1, n], out[2, n] = contact_law(gaps[n], 2.0)


@numba.jit(**OPTIONS)
def forces(ints: Any, reals: Any, q: Any, v: Any, out: Any) -> None:
    floor_residual(ints, reals, q, v, out)


@numba.jit(**OPTIONS)
def matrix(ints: Any, reals: Any, q: Any, v: Any, cv: float) -> None:
    floor_jacobian(ints, reals, q, v, cv)


def law(gaps: NDArray[np.float64]) -> NDArray[np.float64]:
    """Force, stiffness, energy (3, n) of a contact layer with delta = 2 m."""
    out = np.empty((3, len(gaps)))
    laws(gaps, out)
    return out


def test_a_start_on_the_floor_knows_the_same_law() -> None:
    """From above the layer down to where an iterate that is far too deep comes back."""
    gaps = np.linspace(1.2, -40.0, 201)
    of_kernels = law(2.0 * gaps)[0]
    assert of_kernels.max() > 100.0
    assert np.allclose(law_of_contact(gaps), of_kernels, rtol=1e-12, atol=1e-14)


def test_law_of_contact_is_smooth_and_has_an_energy() -> None:
    gaps = np.linspace(3.0, -25.0, 5601)
    force, stiffness, _ = law(gaps)
    step = 1e-5
    less, more = law(gaps - step), law(gaps + step)
    assert (less[2] - more[2]) / (2.0 * step) == pytest.approx(force, rel=1e-8, abs=1e-8)
    assert (less[0] - more[0]) / (2.0 * step) == pytest.approx(stiffness, rel=1e-4, abs=1e-4)
    assert law(np.array([0.0]))[0, 0] == 1.0
    assert (np.diff(force) >= 0.0).all()


def test_cable_lies_where_a_taut_one_would_touch_a_rigid_floor() -> None:
    """T g'' = w - p by quadratures: LYING is the gap above the vertex of the parabola that the
    cable follows where it is clear of the floor."""
    from scipy.integrate import quad

    # With delta = 2, w = T: g'^2 / 2 is the energy less that of lying, plus g.
    def slope(gap: float) -> float:
        return float(np.sqrt(2.0 * (gap + law(np.array([gap]))[2, 0] - law(np.zeros(1))[2, 0])))

    back = slope(2.0)  # from the edge of the layer to the vertex
    way, _ = quad(lambda gap: 1.0 / slope(gap), 2.0 * LYING, 2.0, epsabs=1e-10)
    assert way == pytest.approx(back, rel=1e-3)


WAVY = [
    {"x": x, "y": y, "z": -0.2 * np.sin(0.5 * x) + 0.1 * np.cos(0.4 * y)}
    for x in np.linspace(-9.0, 9.0, 13).tolist()
    for y in np.linspace(-9.0, 9.0, 13).tolist()
]


@pytest.mark.parametrize("floor", [{"z": 0.0, "slope": [0.1, 0.05]}, {"depth_table": WAVY}])
def test_matrix_is_the_derivative(floor: dict[str, Any]) -> None:
    """Cable with a body in it and a free end, pressed on and into the floor as it moves."""
    kind = {"diameter": 0.02, "mass": 1.0, "axial_stiffness": 1e6, "bending_stiffness": 0.3}
    model = cm.CableModel(
        cm.load_scene(
            {
                "environment": {"floor": {**floor, "friction": 0.0}},
                "cable_types": {"c": kind},
                "line": [
                    {"cable": {"type": "c", "length": 3, "model": "elastica", "elements": 6}},
                    {"body": {"mass": 6, "submerged_weight": 20}},
                    {"cable": {"type": "c", "length": 3, "model": "elastica", "elements": 6}},
                ],
                "vessel": {"position": [-3, 0.3, 1.0]},
                "initial": {"straight": [1, 0, 0]},
                "solver": {"tolerance": 1e-2},
            }
        ),
        planar=False,
    )
    ints, reals = model._ints, model._reals
    head = Header(ints)
    state = Scalars(reals)
    memory, nodes, size = model._solver.memory, int(head.nodes), 6
    depth = float(state.floor_depth)
    memory.array(Header.edges, nodes, at.EDGE_WORDS)[4:7, at.Edge.support] = 3.0
    state.end_support = 2.0
    height = model.scene.environment.floor.height
    q = memory.array(Header.position, nodes, size).copy()
    base = state.origin
    random = np.random.default_rng(3)
    for node in range(nodes):
        x, y = base[:2] + q[node, :2]
        q[node, 2] = height(float(x), float(y)) - base[2] + depth * random.uniform(-1.5, 0.6)
        q[node, 5] = (height(float(x) + 0.1, float(y)) - height(float(x) - 0.1, float(y))) / 0.2
    q = q.ravel()
    v = 0.05 * random.standard_normal(len(q))
    cv = 0.7

    def residual(change: NDArray[np.float64]) -> NDArray[np.float64]:
        out = np.zeros(len(q))
        forces(ints, reals, q + change, v + cv * change, out)
        return out

    clear(memory, nodes, size)
    matrix(ints, reals, q, v, cv)
    expected = dense(memory, nodes, size)
    found = differences(residual, len(q), 1e-6)
    # The gap's own gradient turns with the floor's curvature times the gap, which is left out.
    rel = 1e-6 if "z" in floor else 2e-2
    assert np.abs(residual(np.zeros(len(q)))).max() > 1.0
    assert found == pytest.approx(expected, abs=rel * np.abs(expected).max())
