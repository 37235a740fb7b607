"""The guard of `make bench-quick` against slower steps."""

import json

from benchmarks.instructions import COUNTED, STORE, exceeded


def test_a_tenth_more_instructions_fails_and_less_does_not():
    stored = {"tow": 1000, "turn": 1000, "lay": 1000}

    assert exceeded({"tow": 1099, "turn": 1101, "lay": 500}, stored) == ["turn"]


def test_a_scene_of_which_nothing_is_stored_fails():
    assert exceeded({"new": 1}, {}) == ["new"]


def test_every_counted_scene_is_stored():
    assert json.loads(STORE.read_text())["instructions"].keys() == COUNTED.keys()
