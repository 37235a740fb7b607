"""Drag on an element through the surface takes energy, however the cable moves."""

import numba
import numpy as np
import pytest

import cablemodel as cm
from cablemodel.solvers.finite_element.kernels.element.tables import (
    D0,
    D1,
    D2,
    D3,
    H0,
    H1,
    H2,
    H3,
    WEIGHT,
)
from cablemodel.solvers.finite_element.kernels.line.system import set_time
from cablemodel.solvers.finite_element.kernels.water.waves import wave_loads
from cablemodel.solvers.finite_element.kernels.water.wetting import drag_shares
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.access import edge_of, element_points
from cablemodel.solvers.shared.compile import OPTIONS, record_at
from cablemodel.solvers.shared.layout import ElementPoints, Header

POINTS = np.sqrt(0.6) * np.array([-1.0, 0.0, 1.0])
WEIGHTS = WEIGHT[:3]


points_at = record_at(ElementPoints)


@numba.jit(**OPTIONS)
def give_shares(words):
    drag_shares(points_at(words, 0))


@numba.jit(**OPTIONS)
def loads(ints, reals, x0, x1, v0, v1, rest):
    """Of the element above node 1; its tangents and stretch are in the scratch memory."""
    set_time(ints, reals, 0.0)
    edge = edge_of(ints, reals, 1)
    wave_loads(ints, reals, element_points(ints, reals, 0), edge, x0, x1, v0, v1, rest, rest)


def shares(wet):
    words = np.zeros(ElementPoints.WORDS)
    points = ElementPoints(words)
    points.wet[:3] = wet
    give_shares(words)
    return points.drag[:3]


def test_shares_of_drag_are_never_below_zero():
    """Those of a wet part anywhere: its length stays, and its mean where there is room for it."""
    nodes = np.linspace(-1.0, 1.0, 2001)
    outer = POINTS[2]
    lines = np.array(
        [
            nodes * (nodes - outer) / (2 * outer**2),
            1.0 - (nodes / outer) ** 2,
            nodes * (nodes + outer) / (2 * outer**2),
        ]
    )
    rng = np.random.default_rng(5)
    below = 0
    for _ in range(300):
        low, high = np.sort(rng.uniform(-1.5, 1.5, 2))
        inside = (nodes > low) & (nodes < high)
        part = ~inside if rng.random() < 0.3 else inside
        wet = lines[:, part].sum(axis=1) / len(nodes) / WEIGHTS
        found = shares(wet)
        length = max(0.0, WEIGHTS @ wet)
        assert found.min() >= 0.0
        assert WEIGHTS @ found == pytest.approx(length, abs=1e-14)
        if abs(WEIGHTS @ (POINTS * wet)) <= outer * length:
            assert WEIGHTS @ (POINTS * found) == pytest.approx(WEIGHTS @ (POINTS * wet), abs=1e-14)
        if wet.min() >= 0.0:
            np.testing.assert_allclose(found, wet, atol=1e-14)
        below += wet.min() < 0.0
    assert below > 50


@pytest.mark.parametrize("planar", [None, False])
def test_drag_at_the_surface_takes_energy(planar):
    """A shape as long as it likes, and the motion that is quickest where a share is below 0."""
    data = {
        "environment": {"waves": {"regular": {"height": 1.0, "period": 7.0}}},
        "cable_types": {
            "C": {"diameter": 0.02, "mass": 0.5, "axial_stiffness": 1e6, "drag_normal": 1.2,
                  "drag_tangential": 0.05, "added_mass": 1.0}
        },
        "line": [{"cable": {"type": "C", "length": 10}}],
    }  # fmt: skip
    model = cm.CableModel(cm.load_scene(data), planar=planar)
    ints, reals = model._ints, model._reals
    head = Header(ints)
    dimension = int(head.dimension)
    h = float(reals[head.edges + at.EDGE_WORDS + at.Edge.length.word])
    points = ElementPoints(reals, int(head.gauss))
    rng, rest = np.random.default_rng(3), np.zeros(2 * dimension)
    below = 0
    for _ in range(200):
        x = rng.standard_normal((2, 2 * dimension))
        x[:, dimension - 1] *= h
        slope = np.column_stack([D0[:3] / h, D1[:3], D2[:3] / h, D3[:3]]) @ x.reshape(4, dimension)
        points.stretch[:3] = np.linalg.norm(slope, axis=1)
        for i in range(dimension):
            points.tangent[at.POINT_WORDS * i :][:3] = slope[:, i] / points.stretch[:3]
        loads(ints, reals, x[0], x[1], rest, rest, rest)
        still, wet = forces(points, dimension), points.wet[:3].copy()
        v = rng.standard_normal((2, 2 * dimension))
        if wet.min() < 0.0:
            # Velocities at the ends of the element that are 0 at its other Gauss points.
            g = int(wet.argmin())
            wanted = np.zeros((3, dimension))
            wanted[g] = rng.standard_normal(dimension)
            v = np.linalg.lstsq(shapes(h), wanted, rcond=None)[0].reshape(2, 2 * dimension)
            below += 1
        motion = shapes(h) @ v.reshape(4, dimension)
        loads(ints, reals, x[0], x[1], v[0], v[1], rest)
        power = np.sum(WEIGHTS[:, None] * (forces(points, dimension) - still) * motion)
        assert power >= -1e-12 * np.abs(motion).max() ** 3
    assert below > 20


def shapes(h):
    """Hermite's functions at the Gauss points (3, 4), for (r, r') of both ends."""
    return np.column_stack([H0[:3], h * H1[:3], H2[:3], h * H3[:3]])


def forces(points, dimension):
    """Minus the loads at the Gauss points (3, dimension)."""
    return points.force.reshape(3, at.POINT_WORDS)[:dimension, :3].T.copy()
