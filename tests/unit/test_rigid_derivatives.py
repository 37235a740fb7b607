"""Newton matrices of a body of finite length, and of a clamp, are derivatives of their forces."""

import numba
import numpy as np
import pytest
from newton_matrix import clear, dense, differences

import cablemodel as cm
from cablemodel.solvers.finite_element.kernels.bodies.rigid import rigid_jacobian, rigid_residual
from cablemodel.solvers.finite_element.kernels.bodies.vessel_clamp import (
    add_clamp_moment,
    add_clamp_tangent,
)
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.compile import OPTIONS
from cablemodel.solvers.shared.environment import current_profile
from cablemodel.solvers.shared.layout import Header

BODY = {
    "mass": 6, "submerged_weight": 20, "half_length": 0.4, "centre_offset": 0.3,
    "rotary_inertia": 0.5, "added_mass": 5, "added_mass_axial": 1, "drag_area": 0.05,
    "drag_area_axial": 0.02,
}  # fmt: skip


@numba.jit(**OPTIONS)
def forces(ints, reals, q, v, a, tension, out, constraint):
    current_profile(ints, reals, 0.0)
    rigid_residual(ints, reals, q, v, a, tension, out, constraint)


@numba.jit(**OPTIONS)
def matrix(ints, reals, q, v, a, tension, ca, cv):
    current_profile(ints, reals, 0.0)
    rigid_jacobian(ints, reals, q, v, a, tension, ca, cv)


@numba.jit(**OPTIONS)
def moment(ints, reals, q, out):
    add_clamp_moment(ints, reals, q, out)


@numba.jit(**OPTIONS)
def clamp_matrix(ints, reals, q):
    add_clamp_tangent(ints, reals, q)


def line(place):
    cable = {
        "diameter": 0.02, "mass": 0.5, "axial_stiffness": 1e5, "bending_stiffness": 0.3,
    }  # fmt: skip
    upper = {"cable": {"type": "c", "length": 4, "model": "elastica"}}
    lower = {"cable": {"type": "c", "length": 3, "model": "hybrid"}}
    parts, payout = [upper, {"body": BODY}], {}
    if place == "inside":
        parts.append(lower)
    if place == "tow point":
        parts = [lower]
        payout = {"rate": 0.1, "drum": [{"body": BODY}, upper]}
    return cm.load_scene(
        {
            "payout": payout,
            "environment": {"current": [0.4, 0.1, 0.2]},
            "cable_types": {"c": cable},
            "line": parts,
            "initial": {"straight": [0.6, 0, -0.8]},
        }
    )


@pytest.mark.parametrize("planar", [None, False])
@pytest.mark.parametrize("place", ["inside", "end", "tow point"])
def test_matrix_is_the_derivative(planar, place):
    scene = line(place)
    if planar is None:
        data = scene.to_dict()
        data["environment"]["current"] = [0.4, 0, 0.2]
        scene = cm.load_scene(data)
    model = cm.CableModel(scene, planar=planar)
    if place == "tow point":
        model.step_to(4.0)
        assert len(model.bodies) == 1
        assert model.top_tension > 0.0  # what is out of the body is computed with it
    ints, reals = model._ints, model._reals
    head = Header(ints)
    nodes, size = int(head.nodes), 2 * int(head.dimension)
    assert model.planar == (planar is None)
    # A softer clamp and tie, so that differences see everything at once.
    model._solver.memory.array(Header.edges, nodes, at.EDGE_WORDS)[:, at.Edge.bending_full] *= 1e-6
    random = np.random.default_rng(4)
    q = model._solver.memory.array(Header.position, nodes, size).ravel().copy()
    q += 0.1 * random.standard_normal(len(q))
    v, a = random.standard_normal((2, len(q)))
    tension = 20.0 + random.standard_normal(2 * nodes)

    cv, ca = 0.7, 0.3

    def residual(change):
        out, constraint = np.zeros(len(q)), np.zeros(2 * nodes)
        forces(ints, reals, q + change, v + cv * change, a + ca * change, tension, out, constraint)
        return out

    clear(model._solver.memory, nodes, size)
    matrix(ints, reals, q, v, a, tension, ca, cv)
    expected = dense(model._solver.memory, nodes, size)
    found = differences(residual, len(q), 1e-5)
    # The multiplier is condensed out: its stiffness along the axis is no part of the forces.
    (body,) = model._solver.memory.array(Header.bodies, 1, at.BODY_WORDS)
    node, dimension = int(body[at.Body.node]), size // 2
    axis = q[size * node :][:dimension] - q[size * (node - 1) :][:dimension]
    pull = np.zeros(len(q))
    pull[size * node : size * node + dimension] = axis / np.linalg.norm(axis)
    pull[size * (node - 1) : size * (node - 1) + dimension] = -axis / np.linalg.norm(axis)
    expected -= np.outer(pull, pull) / body[at.Body.compliance]
    assert found == pytest.approx(expected, abs=1e-7 * np.abs(expected).max())


@pytest.mark.parametrize("planar", [None, False])
def test_matrix_of_a_clamp_is_the_derivative(planar):
    """At a tow point past which cable runs: 4 k (1 - cos(angle/2)), for any length of the slope."""
    scene = line("inside").to_dict()
    scene["environment"].pop("current")
    scene["vessel"]["connection"] = {"clamped": [0.8, 0, 0.6]}
    scene["payout"] = {"rate": 0.1, "drum": [scene["line"][0]]}
    model = cm.CableModel(cm.load_scene(scene), planar=planar)
    ints, reals = model._ints, model._reals
    head = Header(ints)
    dimension = int(head.dimension)
    size = 2 * dimension
    q = np.zeros(size)
    q[dimension:] = 1.3 * np.array([0.5, 0.2, -0.7])[-dimension:]

    def force(change):
        out = np.zeros(size)
        moment(ints, reals, q + change, out)
        return out

    block = model._solver.memory.array(Header.diagonal, size, size)
    block[:] = 0.0
    clamp_matrix(ints, reals, q)
    step = 1e-6
    found = np.array([(force(step * e) - force(-step * e)) / (2.0 * step) for e in np.eye(size)])
    assert np.abs(block).max() > 0.0
    assert block == pytest.approx(found.T, abs=1e-7 * np.abs(block).max())
