"""Lines and floors that cannot be meant are refused before the run, with path, value, allowed."""

from __future__ import annotations

from typing import Any

import pytest
from scene_examples import minimal

import cablemodel as cm

LENGTH = 30.0


def built(floor: dict[str, Any] | None = None, **parts: Any) -> cm.CableModel:
    """A model of a line of 30 m of the example's cable over a floor at 20 m."""
    data = minimal() | {"environment": {"floor": floor or {"z": -20}}} | parts
    kind = next(iter(data["cable_types"]))
    data["line"] = [{"cable": {"type": kind, "length": LENGTH, "model": "elastica"}}]
    return cm.CableModel(cm.load_scene(data))


def table(start: float, end: float) -> dict[str, Any]:
    return {"depth_table": [{"x": start, "z": -20}, {"x": end, "z": -20}]}


@pytest.mark.parametrize(
    ("parts", "path", "allowed"),
    [
        ({"vessel": {"position": [0, 0, -25]}}, "vessel.position", "at least -20"),
        ({"end": {"anchor": [5, 0, -21]}}, "end.anchor", "at least -20"),
        ({"initial": {"points": [[0, 0, 0], [0, 0, -30]]}}, "initial.points.1", "at least -20"),
        ({"initial": {"straight": [0, 0, -1]}}, "initial", "at least -20"),
        ({"end": {"anchor": [40, 0, -20]}}, "end.anchor", "at most"),
        ({"end": {"anchor": [0, 300, -20]}}, "end.anchor", "at most"),
        (
            {"floor": {"z": -20, "slope": [0.5, 0]}, "vessel": {"velocity": [2, 0, 0]}},
            "vessel",
            "a motion above the floor",
        ),
        ({"floor": table(-40, 10), "vessel": {"velocity": [0.5, 0, 0]}}, "depth_table", "50 m"),
        ({"floor": table(-5, 100)}, "depth_table", "x from -"),
        ({"floor": table(10, 100)}, "depth_table", "at least"),
    ],
)
def test_is_refused(parts: dict[str, Any], path: str, allowed: str) -> None:
    with pytest.raises(cm.SceneError) as caught:
        built(**parts, run={"duration": 100})
    assert caught.value.path.endswith(path)
    assert caught.value.value is not None
    assert allowed in caught.value.allowed


def test_slack_that_has_no_single_shape_is_named() -> None:
    with pytest.raises(cm.StaticsError, match="is 10 m longer than straight down and along"):
        built(end={"anchor": [0, 0, -20]})


@pytest.mark.parametrize("share", [1.001, 1.04])
def test_a_taut_line_to_an_anchor_is_allowed(share: float) -> None:
    model = built(
        end={"anchor": [0, 0.6 * LENGTH * share, -0.8 * LENGTH * share]}, floor={"z": -40}
    )
    assert model.top_tension > 0.0


def test_a_rope_that_stretches_much_is_allowed() -> None:
    data = minimal()
    kind = next(iter(data["cable_types"]))
    data["cable_types"][kind] = {**data["cable_types"][kind], "axial_stiffness": 1000.0}
    model = built(
        end={"anchor": [0, 0, -1.3 * LENGTH]},
        floor={"z": -50},
        **{"cable_types": data["cable_types"]},
    )
    assert model.top_tension > 200.0
