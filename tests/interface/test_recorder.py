"""A loop of one's own, recorded: the run is what the model did, in memory and in a log."""

import importlib.util
import os
import warnings
from pathlib import Path

import numpy as np
import pytest

import cablemodel as cm
from cablemodel.results.replay import replay

needs_locks = pytest.mark.skipif(
    importlib.util.find_spec("fcntl") is None, reason="the platform has no locks of this kind"
)
SCENE = Path(__file__).parents[2] / "scenes" / "towed_cable.yaml"


def velocity(time: float) -> tuple[float, float, float]:
    return (0.8 + 0.2 * np.sin(time), 0.0, 0.0)


def steered(model: cm.CableModel, log: Path | None) -> cm.Run:
    with cm.Recorder(model, log, output_interval=0.5, until=4.05) as recorder:
        for step in range(1, 41):
            recorder.step_to(0.1 * step, vessel_velocity=velocity(0.1 * step))
        recorder.step(0.05)
    return recorder.run()


@pytest.fixture(scope="module")
def scene() -> cm.Scene:
    return cm.load_scene(SCENE)


def test_a_recorded_loop_is_what_the_model_did(scene: cm.Scene, tmp_path: Path) -> None:
    run = steered(cm.CableModel(scene), tmp_path / "run.mcap")
    memory = steered(cm.CableModel(scene), None)
    model = cm.CableModel(scene)
    tension = [model.top_tension]
    for step in range(1, 41):
        model.step_to(0.1 * step, vessel_velocity=velocity(0.1 * step))
        if step % 5 == 0:
            tension.append(model.top_tension)
    model.step(0.05)
    tension.append(model.top_tension)
    for found in (run, memory):
        assert found.complete
        assert np.allclose(found.time, [0, 0.5, 1, 1.5, 2, 2.5, 3, 3.5, 4, 4.05], atol=1e-12)
        assert found.top_tension.tolist() == tension
        assert np.array_equal(found.states[-1].position, model.state().position)
        assert len(found.applied_inputs["time"]) == 41
        given = found.applied_inputs["vessel_velocity_given"]
        assert given.tolist() == [1.0] * 40 + [0.0]
        assert found.statistics["steps"] == model.statistics["steps"]
    assert replay(run).exact


def test_a_long_recording_ends_with_a_state(scene: cm.Scene, tmp_path: Path) -> None:
    for log in (tmp_path / "run.mcap", None):
        model = cm.CableModel(scene)
        with cm.Recorder(model, log, output_interval=0.1, state_interval=0.7) as recorder:
            for _ in range(10):
                recorder.step(0.1)
        run = recorder.run()
        assert np.allclose(run.states.time, [0.0, 0.7, 1.0])
        assert len(run.time) == 11


def test_a_what_if_and_a_failed_step_leave_no_trace(scene: cm.Scene, tmp_path: Path) -> None:
    model = cm.CableModel(scene)
    with cm.Recorder(model, tmp_path / "run.mcap") as recorder:
        recorder.step(1.0)
        snapshot = model.snapshot()
        model.step(30.0, vessel_velocity=(1.0, 0.0, 0.0))
        with pytest.raises(cm.CableModelError, match="taken to 31 s without it"):
            recorder.step(1.0)
        model.restore(snapshot)
        with pytest.raises(cm.StepError):
            recorder.step(1.0, vessel_velocity=(np.nan, 0.0, 0.0))
        recorder.step(1.0)
    run = recorder.run()
    assert run.applied_inputs["time"].tolist() == [1.0, 2.0]
    assert replay(run).exact
    with pytest.raises(cm.CableModelError, match="has ended"):
        recorder.step(1.0)


def test_a_loop_that_breaks_says_why(scene: cm.Scene, tmp_path: Path) -> None:
    for log in (tmp_path / "run.mcap", None):
        recorder = cm.Recorder(cm.CableModel(scene), log)
        recorder.step(1.0)
        with pytest.raises(ZeroDivisionError), recorder:
            _ = 1 / 0
        run = recorder.run()
        assert not run.complete
        assert run.reason == "division by zero"
        assert run.time[-1] == 1.0


def test_a_recorder_refuses_what_is_no_interval(scene: cm.Scene) -> None:
    model = cm.CableModel(scene)
    with pytest.raises(ValueError, match=r"output_interval: 0\.0 is out of range"):
        cm.Recorder(model, output_interval=0.0)
    for name in ("output_interval", "state_interval", "until"):
        with pytest.raises(ValueError, match=f"{name}: 'soon' is not a number with a unit"):
            cm.Recorder(model, **{name: "soon"})  # type: ignore[arg-type]
    recorder = cm.Recorder(model)
    with pytest.raises(cm.CableModelError, match="goes on"):
        recorder.run()


def test_a_recording_whose_model_was_taken_elsewhere_can_be_closed(
    scene: cm.Scene, tmp_path: Path
) -> None:
    for log in (tmp_path / "run.mcap", None):
        model = cm.CableModel(scene)
        recorder = cm.Recorder(model, log)
        recorder.step(0.5)
        model.step(0.5)
        with pytest.raises(cm.CableModelError, match="taken to 1 s without it"):
            recorder.close()
        recorder.close()  # it is told once
        run = recorder.run()
        assert not run.complete
        assert "taken to 1 s without it" in run.reason
        assert run.time.tolist() == [0.0, 0.5]
        assert run.applied_inputs["time"].tolist() == [0.5]
        with pytest.raises(cm.CableModelError, match="has ended"):
            recorder.step(0.5)


def test_a_log_that_cannot_be_ended_is_closed(
    scene: cm.Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    model = cm.CableModel(scene)
    recorder = cm.Recorder(model, tmp_path / "run.mcap", output_interval=1.0)
    recorder.step(0.5)

    def fails() -> None:
        raise RuntimeError("no state")

    with monkeypatch.context() as patch:
        patch.setattr(model, "state", fails)
        with pytest.raises(RuntimeError, match="no state"):
            recorder.close()
    run = recorder.run()
    assert run.reason == "no state"
    assert run.time.tolist() == [0.0]


@needs_locks
def test_a_log_has_one_writer(scene: cm.Scene, tmp_path: Path) -> None:
    log = tmp_path / "run.mcap"
    with cm.Recorder(cm.CableModel(scene), log) as recorder:
        recorder.step(0.5)
        with pytest.raises(cm.LogError, match="another run writes this log"):
            cm.Recorder(cm.CableModel(scene), log)
        with pytest.raises(cm.LogError, match="another run writes this log"):
            cm.simulate(scene, until=1.0, log=log)
        recorder.step(0.5)
    assert recorder.run().complete
    assert recorder.run().time.tolist() == [0.0, 0.5, 1.0]
    assert len(cm.simulate(scene, until=0.5, log=log).time) == 2  # the log is free again


@needs_locks
def test_a_log_that_converge_writes_is_left_alone(scene: cm.Scene, tmp_path: Path) -> None:
    log, part = tmp_path / "run.mcap", tmp_path / ".run.mcap.part"
    with cm.Recorder(cm.CableModel(scene), part) as recorder:
        recorder.step(0.5)
        with pytest.raises(cm.LogError, match="another run writes this log"):
            cm.converge(scene, until=1.0, log=log)
        assert part.exists()
        assert not log.exists()
    assert recorder.run().complete


@needs_locks
@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")
def test_a_forked_process_does_not_keep_a_closed_log(scene: cm.Scene, tmp_path: Path) -> None:
    log = tmp_path / "run.mcap"
    waits, ends = os.pipe()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # a fork beside threads
        with cm.Recorder(cm.CableModel(scene), log) as recorder:
            recorder.step(0.5)
            child = os.fork()
            if child == 0:
                os.close(ends)
                os.read(waits, 1)
                os._exit(0)
    try:
        assert cm.simulate(scene, until=0.5, log=log).complete
    finally:
        os.close(ends)
        os.close(waits)
        os.waitpid(child, 0)
