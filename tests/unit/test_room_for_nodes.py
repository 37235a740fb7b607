"""The memory of a run grows with its mesh: how much there was at the start is seen in nothing."""

from __future__ import annotations

import numpy as np
import pytest

import cablemodel as cm
from cablemodel.solvers.shared.layout import Header

UNTIL = 30.0
SLACK = {
    "title": "slack that comes down on a floor",
    "cable_types": {
        "rope": {
            "diameter": 0.016,
            "mass": 0.46,
            "axial_stiffness": 1e6,
            "bending_stiffness": 0.1,
            "drag_normal": 1.0,
            "drag_tangential": 0.05,
        }
    },
    "line": [{"cable": {"type": "rope", "length": 45.0}}],
    "environment": {"floor": {"z": -50.0, "friction": 0.5}},
    "vessel": {"velocity": [{"t": 0.0, "velocity": [0.0, 0.0, 0.0]}]},
    "payout": {
        "rate": [{"t": 0.0, "rate": 0.0}, {"t": 5.0, "rate": 0.5}],
        "drum": [{"cable": {"type": "rope", "length": 200.0}}],
    },
}
LAYING = {
    **SLACK,
    "title": "a lay that touches down",
    "vessel": {"velocity": [{"t": 0.0, "velocity": [0.5, 0.0, 0.0]}]},
    "payout": {**SLACK["payout"], "rate": [{"t": 0.0, "rate": 0.6}]},
}


def nodes_of(model: cm.CableModel) -> dict[int, np.ndarray]:
    """All that the image keeps of a model's nodes, by header word."""
    memory = model._solver.memory
    count, room = (int(memory.ints[word]) for word in (Header.nodes.word, Header.capacity.word))
    arrays, _ = memory.arrays(**memory.sizes_of(memory.ints))
    more, _ = memory.arrays(**{**memory.sizes_of(memory.ints), "capacity": room + 1})
    kept = {}
    for (place, length), (_, longer) in zip(arrays, more, strict=True):
        if place == Header.history.word and memory.header.has_history == 0:
            continue  # there is none, whatever stands there
        words = length - room * (longer - length) + count * (longer - length)
        kept[place] = memory.integers(place, words).copy()
    return kept


def assert_same(one: cm.CableModel, other: cm.CableModel) -> None:
    assert one.time == other.time
    assert one.statistics == other.statistics
    expected = nodes_of(other)
    for place, words in nodes_of(one).items():
        np.testing.assert_array_equal(words, expected[place])


@pytest.mark.parametrize("data", [SLACK, LAYING], ids=["slack", "laying"])
def test_a_run_with_no_room_at_its_start_is_the_same(data: dict) -> None:
    scene = cm.load_scene(data)
    roomy, bare = cm.CableModel(scene), cm.CableModel(scene)
    memory = bare._solver.memory
    nodes = int(memory.header.nodes)
    memory.make_room(nodes)
    assert len(memory.image) < len(roomy._solver.memory.image)
    for each in (roomy, bare):
        while each.time < UNTIL:
            each.step(0.5)
    assert int(memory.header.nodes) > 2 * nodes, "it needed room twice"
    assert_same(bare, roomy)


def test_snapshots_of_before_and_after_go_both_ways() -> None:
    scene = cm.load_scene(SLACK)
    model, grown = cm.CableModel(scene), cm.CableModel(scene)
    grown._solver.memory.make_room(int(grown._header.nodes))
    before, small = model.snapshot(), grown.snapshot()
    assert len(small) < len(before)
    for each in (model, grown):
        each.step_to(UNTIL)
    late = grown.snapshot()
    for taken in (before, small):
        grown.restore(taken)
        assert grown.time == 0.0
        assert len(grown.snapshot()) == len(taken)
        grown.step_to(UNTIL)
        assert_same(grown, model)
    model.restore(late)
    for each in (model, grown):
        each.step(2.0)
    assert_same(model, grown)
    model.reset()
    assert model.snapshot() == before


def test_a_step_that_fails_after_growing_leaves_the_state_as_it_was() -> None:
    scene = cm.load_scene(SLACK)
    model, undisturbed = cm.CableModel(scene), cm.CableModel(scene)
    for each in (model, undisturbed):
        each.step_to(10.0)
    model._solver.memory.make_room(int(model._header.nodes))
    most = int(model._header.maximum_steps)
    model._header.maximum_steps = 100
    with pytest.raises(cm.StepError):
        model.step_to(40.0)
    assert int(model._header.capacity) > int(model._header.nodes), "it had grown"
    model._header.maximum_steps = most
    assert_same(model, undisturbed)


def test_a_snapshot_cut_off_or_of_wrong_sizes_is_refused() -> None:
    model = cm.CableModel(cm.load_scene(SLACK))
    kept = model.snapshot()
    words = np.frombuffer(kept.image, dtype=np.int64)
    for word, value in (
        (Header.capacity.word, 5),
        (Header.capacity.word, -1),
        (Header.image_words.word, -1),
        (Header.image_words.word, 3),
        (Header.body_count.word, 7),
        (Header.version.word, 1),
        (Header.byte_count.word, 8),
    ):
        wrong = words.copy()
        wrong[word] = value
        with pytest.raises(cm.SceneError, match="belongs to another scene or version"):
            model.restore(cm.model.Snapshot(wrong.tobytes()))
    for cut in (0, 8, 80, len(kept) - 8):
        with pytest.raises(cm.SceneError, match="belongs to another scene or version"):
            model.restore(cm.model.Snapshot(kept.image[:cut]))
    assert model.snapshot() == kept
