"""The scenes of systems that are there to be copied: they start and go on."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cablemodel.systems import SystemModel, load_system

SCENES = sorted((Path(__file__).parents[2] / "scenes" / "systems").glob("*.yaml"))


@pytest.mark.parametrize("path", SCENES, ids=lambda path: path.stem)
def test_a_scene_to_copy_runs(path: Path) -> None:
    scene = load_system(path)
    assert load_system(scene.to_yaml()) == scene
    model = SystemModel(scene)
    for _ in range(8):
        model.step(0.5)
    for name, line in model.lines.items():
        state = line.sample()
        assert np.isfinite(state.position).all(), name
        chords = np.linalg.norm(np.diff(state.position, axis=0), axis=1)
        assert chords.sum() < 1.02 * line.length, name
        assert state.tension.max() < 1e6, name
    for name, body in model.bodies.items():
        assert np.isfinite(body.position).all(), name
        assert np.linalg.norm(body.velocity) < 10.0, name
