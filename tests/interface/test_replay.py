"""A log is a test: replaying it gives the same run, or says where it does not."""

import json
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import cablemodel as cm
from cablemodel.cli import app
from cablemodel.results.log.writer import LogWriter
from cablemodel.results.replay import Replay, changes, replay
from cablemodel.scene import Scene

ROOT = Path(__file__).parents[2]


def invoke(*arguments: Any) -> Any:
    return CliRunner().invoke(app, ["replay", *map(str, arguments)])


@pytest.fixture(scope="module")
def tow(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The first 40 s of the towed cable, by the engine."""
    path = tmp_path_factory.mktemp("replay") / "tow.mcap"
    cm.simulate(cm.load_scene(ROOT / "scenes" / "towed_cable.yaml"), log=path, until=40.0)
    return path


def named(result: Replay, name: str) -> Any:
    (found,) = [item for item in result.differences if item.name == name]
    return found


def test_a_run_replays_to_the_last_bit(tow: Path) -> None:
    result = replay(cm.open_run(tow))
    assert result.exact
    assert result.passed
    assert result.expected_exact
    assert result.tolerance == 0.0
    assert (result.steps, result.samples) == (80, 81)
    names = {item.name for item in result.differences}
    assert {"top_tension", "tip_position", "top_force", "state.position", "state.tension"} <= names


@pytest.mark.parametrize("scene", ["turn", "whip", "release_in_water"])
def test_scenes_replay_to_the_last_bit(scene: str, tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    cm.simulate(cm.load_scene(ROOT / "scenes" / f"{scene}.yaml"), log=path, until=1.0)
    assert replay(cm.open_run(path)).exact


def test_a_run_driven_by_its_caller_replays_to_the_last_bit(tmp_path: Path) -> None:
    """Velocities, positions and currents that no scene knows, in steps of all lengths."""
    scene = cm.load_scene(ROOT / "scenes" / "towed_cable.yaml")
    path = tmp_path / "run.mcap"
    model = cm.CableModel(scene)
    random = np.random.default_rng(1)
    with LogWriter(path, scene) as writer:
        writer.write_outputs(model)
        for k in range(60):
            step = float(10.0 ** random.uniform(-3, 0))
            inputs: dict[str, Any] = {}
            if k % 3:
                inputs["vessel_velocity"] = random.uniform(-0.5, 0.5, 3).tolist()
            if k % 4 == 1:
                inputs["current"] = [0.1, 0.2, 0.0]
            if k % 5 == 1:
                drift = random.uniform(-1e-3, 1e-3, 3)
                inputs["vessel_position"] = (model.vessel_position + drift).tolist()
            model.step(step, **inputs)
            writer.write_step(model, step, given=inputs)
            writer.write_outputs(model, exact_state=k % 5 == 0)
        writer.close(model.statistics)
    result = replay(cm.open_run(path))
    assert result.failure == ""
    assert result.exact, [d for d in result.differences if d.largest]
    assert result.samples == 61


def test_inputs_matter_to_a_replay(tmp_path: Path, simple_scene: Scene) -> None:
    """The same without saying that the velocity was given: the scene's own drives, and differs."""
    scene = cm.load_scene(ROOT / "scenes" / "towed_cable.yaml")
    path = tmp_path / "run.mcap"
    model = cm.CableModel(scene)
    with LogWriter(path, scene) as writer:
        writer.write_outputs(model)
        for _ in range(5):
            model.step(1.0, vessel_velocity=(0.5, 0.0, 0.0))
            writer.write_step(model, 1.0)
            writer.write_outputs(model)
        writer.close()
    result = replay(cm.open_run(path))
    assert not result.passed
    assert named(result, "tip_position").largest > 0.1


def test_a_difference_says_where_it_is(
    full_scene: Scene, swinging_cable: Any, tmp_path: Path
) -> None:
    """A replay whose cable is tighter at one node after 3 s, by 0.25 N."""

    class Other(swinging_cable):  # type: ignore[misc]
        def state(self) -> Any:
            state = super().state()
            if self.time > 3.0:
                state.tension[4] += 0.25 if self.time < 4.0 else 0.125
            return state

    path = tmp_path / "run.mcap"
    cm.simulate(full_scene, log=path, model=swinging_cable(full_scene))
    result = replay(cm.open_run(path), make_model=Other, tolerance=0.0)
    assert not result.passed
    item = named(result, "state.tension")
    assert item.largest == 0.25
    assert 3.0 < item.time < 4.0
    assert item.arc_length == pytest.approx(15.0, abs=0.5)
    assert named(result, "state.position").largest == 0.0
    assert named(result, "bodies.direction").largest == 0.0
    assert replay(cm.open_run(path), make_model=Other, tolerance=1e-3).passed
    assert not replay(cm.open_run(path), make_model=Other, tolerance=1e-5).passed


def test_values_that_are_no_numbers_must_be_none_again(
    full_scene: Scene, swinging_cable: Any, tmp_path: Path
) -> None:
    class Other(swinging_cable):  # type: ignore[misc]
        @property
        def touchdown_position(self) -> np.ndarray:
            return np.array([self.time / 3, 2.0, -70.0])  # never NaN

    path = tmp_path / "run.mcap"
    cm.simulate(full_scene, log=path, model=swinging_cable(full_scene))
    assert replay(cm.open_run(path), make_model=swinging_cable, tolerance=0.0).exact
    result = replay(cm.open_run(path), make_model=Other, tolerance=1.0)
    assert not result.passed
    assert named(result, "touchdown_position").largest == math.inf


def test_a_step_that_fails_is_said(
    simple_scene: Scene, swinging_cable: Any, tmp_path: Path
) -> None:
    path = tmp_path / "run.mcap"
    cm.simulate(simple_scene, log=path, model=swinging_cable(simple_scene))
    result = replay(cm.open_run(path), make_model=lambda scene: swinging_cable(scene, fail_at=5.0))
    assert not result.passed
    assert "no convergence" in result.failure


def test_a_cut_log_replays_as_far_as_it_goes(tow: Path, tmp_path: Path) -> None:
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(tow.read_bytes()[: tow.stat().st_size // 2])
    run = cm.open_run(cut)
    result = replay(run)
    assert result.exact
    assert 10 < result.samples == len(run.time) < 81


def test_a_log_that_begins_later_is_refused(
    simple_scene: Scene, swinging_cable: Any, tmp_path: Path
) -> None:
    path = tmp_path / "run.mcap"
    model = swinging_cable(simple_scene)
    model.step(2.0)
    cm.simulate(simple_scene, log=path, model=model)
    with pytest.raises(cm.LogError, match="begins at t = 2 s"):
        replay(cm.open_run(path))


def test_a_log_without_outputs_is_refused(simple_scene: Scene, tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    LogWriter(path, simple_scene).close()
    with pytest.raises(cm.LogError, match="nothing to compare"):
        replay(cm.open_run(path))


@pytest.mark.parametrize("tolerance", [-1.0, math.nan, math.inf])
def test_a_tolerance_is_a_number(tow: Path, tolerance: float) -> None:
    with pytest.raises(ValueError, match="tolerance"):
        replay(cm.open_run(tow), tolerance=tolerance)


def test_another_version_is_compared_within_the_scenes_tolerance(tow: Path) -> None:
    run = cm.open_run(tow)
    assert changes(run.metadata) == {}
    run.metadata["numba"] = "0.1"
    result = replay(run)
    assert result.changed["numba"][0] == "0.1"
    assert not result.expected_exact
    assert result.tolerance == run.scene.solver.tolerance
    assert named(result, "tip_position").allowed == pytest.approx(30.0 * result.tolerance)
    # All tensions are measured by the largest one, the lowest ones too.
    assert named(result, "tension_min").allowed == named(result, "top_tension").allowed
    largest = np.max(run.states.tension)
    assert named(result, "top_tension").allowed >= 10.0 * result.tolerance * largest
    assert result.passed


def test_the_command_says_whether_a_log_replays(tow: Path) -> None:
    result = invoke(tow)
    assert result.exit_code == 0, result.output
    assert "replays exactly, to the last bit" in result.stdout
    report = json.loads(invoke(tow, "--json").stdout)
    assert report["exact"] is True
    assert report["samples"] == 81


def test_the_command_fails_on_a_difference(
    tow: Path, swinging_cable: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cablemodel.model.CableModel", swinging_cable)
    result = invoke(tow)
    assert result.exit_code == 1
    assert "differs although version and processor are the same" in result.stdout
    assert "too much" in result.stdout


def test_the_command_refuses_a_wrong_tolerance(tow: Path) -> None:
    result = invoke(tow, "--tolerance", "-1")
    assert result.exit_code == 2
    assert "--tolerance" in result.stderr
