"""The scenes of systems that are there to be copied: they start and go on."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cablemodel.errors import StaticsError
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


def test_an_array_that_leaves_its_drum_pulls_with_its_drag() -> None:
    """Level and straight, all of it goes through the water at what the ship is faster than the
    winch; at rest on the winch at the ship's speed."""
    (path,) = (path for path in SCENES if path.stem == "array_from_its_drum")
    model = SystemModel(load_system(path))
    for time, birds, speed in ((62.0, 1, 2.0), (400.0, 0, 3.0)):
        model.step_to(time)
        line = model.lines["array"]
        drag = 0.5 * 1025.0 * (0.01 * np.pi * 0.06 * line.length + birds * 0.02) * speed**2
        assert line.start_tension == pytest.approx(drag, rel=0.01)
    assert line.length == pytest.approx(50.0, abs=1e-9)
    assert model.winches["winch"].drum_length == pytest.approx(170.0, abs=1e-9)


def test_a_start_that_takes_too_long_says_what_was_tried() -> None:
    """A limit of no time at all is the shortest there is."""
    scene = load_system(SCENES[0], ["solver.start_time_limit=1e-6"])
    with pytest.raises(StaticsError, match=r"start_time_limit.*Tried: without friction"):
        SystemModel(scene)


def test_a_vehicle_that_mujoco_simulates_holds_its_place_on_its_tether() -> None:
    from examples.vehicle_on_tether import LEG, STEP, WAY, couple

    run = couple()
    ends = [int(k * LEG / STEP) - 1 for k in range(1, len(WAY) + 1)]
    off = np.linalg.norm(run["place"] - run["wanted"], axis=1)
    # Its controller has no integral: it is off by the tether's pull over its stiffness.
    assert off[ends].max() < 0.3
    assert np.abs(np.diff(run["tension"][200:])).max() < 20.0  # nothing rings
    assert run["tension"].max() < 200.0
