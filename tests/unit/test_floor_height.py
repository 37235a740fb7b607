"""The sea floor that Python sees (starts, checks, pictures) is the one that the kernels have."""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
import pytest

import cablemodel as cm
from cablemodel.solvers.finite_element.kernels.floor.floor_surface import table_height
from cablemodel.solvers.finite_element.start.from_scene import build
from cablemodel.solvers.shared.compile import OPTIONS


@numba.jit(**OPTIONS)
def heights_of_kernel(ints: Any, reals: Any, places: Any, out: Any) -> None:
    for n in range(len(out)):
        z, _slope_x, _slope_y = table_height(ints, reals, places[n, 0], places[n, 1])
        out[n] = z


@pytest.mark.parametrize("rows", [1, 2, 6])
def test_heights_of_a_table_are_those_of_the_kernel(rows: int) -> None:
    random = np.random.default_rng(rows)
    x, y = np.cumsum(random.uniform(5.0, 80.0, 7)), np.cumsum(random.uniform(5.0, 80.0, rows))
    table = [
        {"x": a, "y": b, "z": random.uniform(-120.0, -80.0)} for a in x.tolist() for b in y.tolist()
    ]
    middle = [float(x.mean()), float(y.mean()), 0.0]
    scene = cm.load_scene(
        {
            "environment": {"floor": {"depth_table": table}},
            "cable_types": {"K": {"diameter": 0.02, "mass": 1.0, "axial_stiffness": 1e6}},
            "line": [{"cable": {"type": "K", "length": 10.0}}],
            "vessel": {"position": middle},
            "initial": {"straight": [0, 0, -1]},
        }
    )
    floor = scene.environment.floor
    assert floor is not None
    corners = np.array([[a, b] for a in x for b in y])
    inside = random.uniform([x[0], y[0]], [x[-1], y[-1]], (300, 2))
    around = random.uniform([x[0] - 50.0, y[0] - 50.0], [x[-1] + 50.0, y[-1] + 50.0], (300, 2))
    places = np.concatenate([corners, inside, around])
    block = build(scene)
    found = np.empty(len(places))
    heights_of_kernel(block.ints, block.reals, places, found)
    assert [floor.height(a, b) for a, b in places] == pytest.approx(found, abs=1e-10)
    assert found[: len(corners)] == pytest.approx([row["z"] for row in table], abs=1e-10)
