"""The Newton matrix of a body of finite length is the derivative of its forces."""

import numba
import numpy as np
import pytest

import cablemodel as cm
from cablemodel.kernels import layout as at
from cablemodel.kernels.compile import OPTIONS
from cablemodel.kernels.environment import current_profile
from cablemodel.kernels.rigid import rigid_jacobian, rigid_residual

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


def line(at_end):
    cable = {
        "diameter": 0.02, "mass": 0.5, "axial_stiffness": 1e5, "bending_stiffness": 0.3,
    }  # fmt: skip
    parts = [{"cable": {"type": "c", "length": 4, "model": "elastica"}}, {"body": BODY}]
    if not at_end:
        parts.append({"cable": {"type": "c", "length": 3, "model": "hybrid"}})
    return cm.load_scene(
        {
            "environment": {"current": [0.4, 0.1, 0.2]},
            "cable_types": {"c": cable},
            "line": parts,
            "initial": {"straight": [0.6, 0, -0.8]},
        }
    )


@pytest.mark.parametrize("planar", [None, False])
@pytest.mark.parametrize("at_end", [False, True])
def test_matrix_is_the_derivative(planar, at_end):
    scene = line(at_end)
    if planar is None:
        data = scene.to_dict()
        data["environment"]["current"] = [0.4, 0, 0.2]
        scene = cm.load_scene(data)
    model = cm.CableModel(scene, planar=planar)
    ints, reals = model._ints, model._reals
    nodes, size = int(ints[at.I_NODES]), 2 * int(ints[at.I_DIMENSION])
    assert model.planar == (planar is None)
    # A softer clamp and tie, so that differences see everything at once.
    model._solver.memory.array(at.O_EDGE, nodes, at.EDGE_WORDS)[:, at.E_BENDING_FULL] *= 1e-6
    random = np.random.default_rng(4)
    q = model._solver.memory.array(at.O_POSITION, nodes * size).copy()
    q += 0.1 * random.standard_normal(len(q))
    v, a = random.standard_normal((2, len(q)))
    tension = 20.0 + random.standard_normal(2 * nodes)

    cv, ca = 0.7, 0.3

    def residual(change):
        out, constraint = np.zeros(len(q)), np.zeros(2 * nodes)
        forces(ints, reals, q + change, v + cv * change, a + ca * change, tension, out, constraint)
        return out

    for place in (at.O_DIAGONAL, at.O_UPPER, at.O_LOWER):
        model._solver.memory.array(place, nodes, size, size)[:] = 0.0
    matrix(ints, reals, q, v, a, tension, ca, cv)
    blocks = [
        model._solver.memory.array(place, nodes, size, size)
        for place in (at.O_DIAGONAL, at.O_UPPER, at.O_LOWER)
    ]
    expected = np.zeros((len(q), len(q)))
    for node in range(nodes):
        own = slice(size * node, size * (node + 1))
        above = slice(size * (node - 1), size * node)
        expected[own, own] += blocks[0][node]
        if node:
            expected[above, own] += blocks[1][node]
            expected[own, above] += blocks[2][node]
    step = 1e-5
    found = np.array(
        [(residual(step * e) - residual(-step * e)) / (2.0 * step) for e in np.eye(len(q))]
    ).T
    # The multiplier is condensed out: its stiffness along the axis is no part of the forces.
    (body,) = model._solver.memory.array(at.O_BODY, 1, at.BODY_WORDS)
    node, dimension = int(body[at.B_NODE]), size // 2
    axis = q[size * node :][:dimension] - q[size * (node - 1) :][:dimension]
    pull = np.zeros(len(q))
    pull[size * node : size * node + dimension] = axis / np.linalg.norm(axis)
    pull[size * (node - 1) : size * (node - 1) + dimension] = -axis / np.linalg.norm(axis)
    expected -= np.outer(pull, pull) / body[at.B_COMPLIANCE]
    assert found == pytest.approx(expected, abs=1e-7 * np.abs(expected).max())
