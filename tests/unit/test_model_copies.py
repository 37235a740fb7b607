"""Copies and snapshots of a model: each goes on by itself, or says that it cannot."""

import copy
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cablemodel as cm
from cablemodel.model import Snapshot

SCENE = Path(__file__).parents[2] / "scenes" / "towed_cable.yaml"


def same(one: cm.CableModel, other: cm.CableModel) -> bool:
    return one.time == other.time and np.array_equal(one.state().position, other.state().position)


@pytest.mark.parametrize(
    "copied",
    [copy.deepcopy, copy.copy, lambda model: pickle.loads(pickle.dumps(model))],
    ids=["deepcopy", "copy", "pickle"],
)
@pytest.mark.parametrize("method", ["finite_element", "direct_integration"])
def test_a_copy_goes_on_as_the_model_does(
    copied: Callable[[cm.CableModel], cm.CableModel], method: str
) -> None:
    model = cm.CableModel(cm.load_scene(SCENE, ["solver={method: " + method + "}"]))
    model.step(3.0, vessel_velocity=(0.4, 0.0, 0.0))
    before, time = model.state().position, model.time
    other = copied(model)
    other.step(2.0, vessel_velocity=(0.8, 0.0, 0.0))
    # The copy moved in all that it says, the model in nothing.
    assert other.time == 5.0
    assert model.time == time
    assert np.array_equal(model.state().position, before)
    model.step(2.0, vessel_velocity=(0.8, 0.0, 0.0))
    assert same(model, other)
    other.step(1.0)
    model.restore(other.snapshot())
    assert same(model, other)
    other.reset()
    assert other.time == 0.0


@pytest.mark.parametrize("change", ["cable_types.K.drag_normal=2", "vessel.velocity=[0.7, 0, 0]"])
def test_a_snapshot_of_other_values_is_refused(change: str) -> None:
    model = cm.CableModel(cm.load_scene(SCENE))
    other = cm.CableModel(cm.load_scene(SCENE, [change]))
    kept = other.snapshot()
    with pytest.raises(cm.SceneError, match="another scene, of other values"):
        other.restore(model.snapshot())
    assert other.snapshot() == kept


def test_a_snapshot_goes_where_all_that_it_brings_is_the_same() -> None:
    model = cm.CableModel(cm.load_scene(SCENE))
    model.step(1.0)
    other = cm.CableModel(cm.load_scene(SCENE, ["run.duration=10000", "title=again", "end=free"]))
    other.restore(model.snapshot())
    assert same(model, other)
    model.step(1.0)
    # One that was kept as bytes does not know its scene.
    other.restore(Snapshot(model.snapshot().image))
    assert same(model, other)


def test_a_model_and_its_snapshot_are_shown_in_a_line() -> None:
    model: Any = cm.CableModel(cm.load_scene(SCENE))
    model.step(1.5)
    assert "at t = 1.5 s" in repr(model)
    assert "at t = 1.5 s" in repr(model.snapshot())
    assert len(repr(model.snapshot())) < 80
