"""simulate, Run and open_run: what was computed is what is read."""

import math
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.reader import make_reader

import cablemodel as cm
from cablemodel import variables
from cablemodel.results.cadence import output_times
from cablemodel.results.log.reader import LogFile
from cablemodel.results.log.writer import LogWriter
from cablemodel.results.replay import replay
from cablemodel.results.run import Run
from cablemodel.results.simulate import Progress
from cablemodel.scene import Scene, load_scene

SUMMARY = [
    "time", "top_tension", "tip_position", "min_tension", "max_tension",
    "slack_time", "slack_longest", "slack_start", "slack_end", "max_curvature",
    "wall_time", "steps", "rejected", "factorisations", "elements",
]  # fmt: skip


@pytest.fixture
def log(full_scene: Scene, swinging_cable: Any, tmp_path: Path) -> Path:
    path = tmp_path / "run.mcap"
    cm.simulate(full_scene, log=path, model=swinging_cable(full_scene))
    return path


def same(a: np.ndarray, b: np.ndarray) -> bool:
    return bool(np.array_equal(a, b, equal_nan=True))


def same_states(a: Run, b: Run, count: int | None = None) -> bool:
    fields = [name for name, _ in variables.STATE_FIELDS]
    return all(
        same(getattr(one, name), getattr(other, name))
        for one, other in zip(a.states[:count], b.states[:count], strict=True)
        for name in fields
    )


def test_a_run_from_a_log_is_the_run_in_memory(
    log: Path, full_scene: Scene, swinging_cable: Any
) -> None:
    memory = cm.simulate(full_scene, model=swinging_cable(full_scene))
    read = cm.open_run(log)
    assert read.complete
    assert read.reason == ""
    assert read.scene == full_scene
    assert same(read.time, memory.time)
    assert read.names == memory.names
    assert len(read.names) == len([r for r in variables.OUTPUTS if "state." not in r.python])
    for name in read.names:
        if name == "bodies.direction":  # goes through a quaternion
            assert np.allclose(read[name], memory[name], rtol=0, atol=1e-14)
        else:
            assert same(read[name], memory[name]), name
    assert same_states(read, memory)
    for label, values in read.applied_inputs.items():
        assert same(values, memory.applied_inputs[label]), label
    assert read.metadata["schema_version"] == "1"


def test_output_times_are_multiples_of_the_interval_without_round_off(
    simple_scene: Scene, swinging_cable: Any
) -> None:
    run = cm.simulate(simple_scene, until=200.0, model=swinging_cable(simple_scene))
    assert len(run.time) == 668
    assert run.time[-1] == 200.0
    assert np.array_equal(run.time[:-1], 0.3 * np.arange(667))  # adding 0.3 up is off by 1e-12


@pytest.mark.parametrize(
    ("start", "end", "interval", "expected"),
    [
        (0.0, 1.0, 0.5, [0.5, 1.0]),
        (0.0, 1.1, 0.5, [0.5, 1.0, 1.1]),
        (0.0, 0.2, 0.5, [0.2]),
        (0.3, 1.0, 0.5, [0.5, 1.0]),
        (0.5, 1.0, 0.5, [1.0]),
        (1.0, 1.0, 0.5, []),
        (0.0, 0.3, 0.1, [0.1, 0.2, 0.3]),  # 3 * 0.1 is above 0.3: no step of 6e-17 s
        (3 * 0.1, 0.5, 0.1, [0.4, 0.5]),
    ],
)
def test_output_times(start: float, end: float, interval: float, expected: list[float]) -> None:
    assert output_times(start, end, interval) == pytest.approx(expected, rel=0, abs=1e-15)


def test_a_run_can_be_shorter_or_longer_than_the_scene_says(
    simple_scene: Scene, swinging_cable: Any
) -> None:
    for until in (0.1, 3.0, 12.0):
        run = cm.simulate(simple_scene, until=until, model=swinging_cable(simple_scene))
        assert run.time[-1] == until


@pytest.mark.parametrize("until", [0.0, -1.0, math.nan, math.inf])
def test_a_run_needs_an_end(simple_scene: Scene, swinging_cable: Any, until: float) -> None:
    with pytest.raises(ValueError, match="until"):
        cm.simulate(simple_scene, until=until, model=swinging_cable(simple_scene))


def test_the_summary_has_the_promised_keys(log: Path) -> None:
    run = cm.open_run(log)
    summary = run.summary()
    errors = ["tolerance", "accuracy", "position_error", "tension_error", "error_share"]
    assert list(summary) == [*SUMMARY, *errors]
    assert summary["time"] == 10.0
    assert summary["top_tension"] == run.top_tension[-1]
    assert summary["tip_position"] == run.tip_position[-1].tolist()
    assert summary["min_tension"] == run.tension_min.min()
    assert summary["max_tension"] == run["tension_max"].max()
    assert summary["max_curvature"] == run.states.curvature.max()
    assert summary["steps"] == 34
    assert summary["factorisations"] == 2
    assert summary["wall_time"] == run.wall_time > 0.0


def test_progress_is_told_at_every_output(simple_scene: Scene, swinging_cable: Any) -> None:
    told: list[Progress] = []
    run = cm.simulate(simple_scene, model=swinging_cable(simple_scene), progress=told.append)
    assert [item.time for item in told] == run.time.tolist()
    assert {item.until for item in told} == {10.0}
    assert [item.top_tension for item in told] == run.top_tension.tolist()
    assert told[-1].statistics["steps"] == 34


def test_a_failed_step_keeps_what_was_reached(
    simple_scene: Scene, swinging_cable: Any, tmp_path: Path
) -> None:
    path = tmp_path / "run.mcap"
    with pytest.raises(cm.StepError, match="no convergence"):
        cm.simulate(simple_scene, log=path, model=swinging_cable(simple_scene, fail_at=5.0))
    run = cm.open_run(path)
    assert not run.complete
    assert "no convergence" in run.reason
    assert "3 m along the cable" in run.reason
    assert run.time[-1] == pytest.approx(4.8, abs=1e-12)
    assert run.statistics["steps"] == 16


def test_an_interrupted_run_keeps_what_was_reached(
    simple_scene: Scene, swinging_cable: Any, tmp_path: Path
) -> None:
    def interrupt(progress: Progress) -> None:
        if progress.time > 3.0:
            raise KeyboardInterrupt

    path = tmp_path / "run.mcap"
    model = swinging_cable(simple_scene)
    with pytest.raises(KeyboardInterrupt):
        cm.simulate(simple_scene, log=path, model=model, progress=interrupt)
    run = cm.open_run(path)
    assert (run.complete, run.reason) == (False, "interrupted")
    assert run.time[-1] > 3.0


def test_nodes_may_come_and_go(simple_scene: Scene, swinging_cable: Any, tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"

    def nodes(time: float) -> int:
        return 5 + int(time)

    cm.simulate(simple_scene, log=path, model=swinging_cable(simple_scene, nodes=nodes))
    run = cm.open_run(path)
    memory = cm.simulate(simple_scene, model=swinging_cable(simple_scene, nodes=nodes))
    assert same_states(run, memory)
    assert [len(state.s) for state in run.states] == [nodes(t) for t in run.time]
    assert run.states.position.shape == (35, 15, 3)
    assert np.allclose(run.states.position[:, -1], run.tip_position, rtol=0, atol=1e-13)


def test_bodies_may_come_off_the_drum(
    full_scene: Scene, swinging_cable: Any, tmp_path: Path
) -> None:
    """The inner body appears after 5 s: before, its column holds no numbers."""

    class Paying(swinging_cable):  # type: ignore[misc]
        @property
        def bodies(self) -> list[Any]:
            inner, outer = super().bodies
            found = [inner, outer] if self.time > 5.0 else [outer]
            return found if self.time > 1.0 else []

    path = tmp_path / "run.mcap"
    cm.simulate(full_scene, log=path, model=Paying(full_scene))
    run = cm.open_run(path)
    memory = cm.simulate(full_scene, model=Paying(full_scene))
    position = run["bodies.position"]
    assert position.shape == (35, 2, 3)
    assert same(position, memory["bodies.position"])
    assert np.array_equal(np.isnan(position[:, 0, 0]), run.time <= 5.0)
    assert np.array_equal(np.isnan(position[:, 1, 0]), run.time <= 1.0)
    late = position[run.time > 5.0]
    assert np.all(np.linalg.norm(late[:, 1], axis=1) > np.linalg.norm(late[:, 0], axis=1))
    assert np.allclose(
        run["bodies.direction"], memory["bodies.direction"], rtol=0, atol=1e-14, equal_nan=True
    )
    assert replay(run, make_model=Paying, tolerance=0.0).exact
    assert not replay(run, make_model=swinging_cable, tolerance=1.0).passed


def test_an_unknown_output_names_those_that_exist(simple_scene: Scene, swinging_cable: Any) -> None:
    run = cm.simulate(simple_scene, model=swinging_cable(simple_scene))
    for name in ("colour", "floor_force", "state.position"):
        assert name not in run
        with pytest.raises(KeyError, match="top_tension"):
            run[name]
    assert list(run) == list(run.names)
    assert "top_tension" in run


def test_outputs_at_other_times_than_states(
    simple_scene: Scene, swinging_cable: Any, tmp_path: Path
) -> None:
    """A node publishes faster than it logs states: then times are those of the stamps."""
    path = tmp_path / "run.mcap"
    model = swinging_cable(simple_scene)
    tensions = []
    with LogWriter(path, simple_scene) as writer:
        for k in range(7):
            model.step(0.1)
            writer.write_outputs(model, exact_state=k % 3 == 0)
            tensions.append(model.top_tension)
        writer.close()
    run = cm.open_run(path)
    assert run.time == pytest.approx([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7], rel=0, abs=1e-9)
    assert run.top_tension.tolist() == tensions
    assert run.states.time == pytest.approx([0.1, 0.4, 0.7], rel=0, abs=1e-15)
    assert run.states.position.shape == (3, 9, 3)


def test_to_xarray_has_everything_with_units_and_equal_values(log: Path) -> None:
    pytest.importorskip("xarray")
    run = cm.open_run(log)
    data = run.to_xarray()
    assert data["top_tension"].attrs == {"units": "N", "long_name": "tension at the tow point"}
    assert same(data["top_tension"].values, run.top_tension)
    assert data["top_force"].dims == ("time", "axis")
    assert data["bodies_position"].dims == ("time", "body", "axis")
    assert same(data["position"].sel(axis="z").values, run.states.position[..., 2])
    assert float(data["tip_position"].sel(axis="x", time=10.0)) == run.tip_position[-1, 0]
    assert same(data["applied_vessel_velocity"].sel(axis="x").values,
                run.applied_inputs["vessel_velocity.x"])  # fmt: skip
    assert data["applied_payout_rate"].attrs["units"] == "m/s"
    assert data["applied_payout_rate_given"].dtype == bool
    outputs = {name.replace(".", "_") for name in run.names}
    fields = {name for name, _ in variables.STATE_FIELDS} | {*variables.DERIVED}
    inputs = {f"applied_{name}" for name, _ in variables.APPLIED_INPUT_FIELDS if name != "time"}
    assert set(data.data_vars) == outputs | fields | inputs
    for name in [*data.data_vars, "time", "state_time", "step_time"]:
        assert data[name].attrs["units"], name
        assert data[name].attrs["long_name"], name
    assert load_scene(data.attrs["scene"]) == run.scene
    assert data.attrs["complete"] == "yes"


def test_to_xarray_without_xarray_says_what_to_install(
    log: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "xarray", None)
    with pytest.raises(cm.CableModelError, match=r"cablemodel\[export\]"):
        cm.open_run(log).to_xarray()


# Cut and damaged files


def test_a_file_cut_at_any_byte_gives_all_before_the_last_flush(log: Path, tmp_path: Path) -> None:
    whole = log.read_bytes()
    full = cm.open_run(log)
    chunks = LogFile(log)._chunks
    ends = [chunk.offset + 9 + _length(whole, chunk.offset) for chunk in chunks]
    samples = [len(chunk.indexes.get(1, ())) for chunk in chunks]
    assert sum(samples) == len(full.time)
    with log.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    first_record = summary.metadata_indexes[0]  # it follows the scene
    scene_end = first_record.offset + first_record.length
    points = set(random.Random(1).sample(range(len(whole)), 300))
    points |= {end + shift for end in ends for shift in (-1, 0, 1)}
    points |= set(range(40)) | set(range(len(whole) - 40, len(whole)))
    cut = tmp_path / "cut.mcap"
    for size in sorted(points):
        cut.write_bytes(whole[:size])
        if size < scene_end:
            with pytest.raises(cm.LogError, match="nothing in it"):
                cm.open_run(cut)
            continue
        run = cm.open_run(cut)
        assert not run.complete
        assert "end of the file is missing" in run.reason
        kept = sum(n for end, n in zip(ends, samples, strict=True) if end <= size)
        assert len(run.time) == kept
        assert same(run.time, full.time[:kept])
        assert same(run.top_tension, full.top_tension[:kept])
        assert same(run["top_force"], full["top_force"][:kept].reshape(kept, 3))
    cut.write_bytes(whole[: ends[-1]])
    assert same_states(cm.open_run(cut), full)


def _length(data: bytes, at: int) -> int:
    return int.from_bytes(data[at + 1 : at + 9], "little")


def test_a_file_with_one_wrong_byte_is_refused(log: Path, tmp_path: Path) -> None:
    """Any bit in the data section is covered by a checksum; none may pass for other values."""
    whole = log.read_bytes()
    data_end = LogFile(log)._chunks[-1].offset
    damaged = tmp_path / "damaged.mcap"
    for at in random.Random(2).sample(range(8, data_end), 200):
        wrong = bytearray(whole)
        wrong[at] ^= 1 << (at % 8)
        damaged.write_bytes(wrong)
        with pytest.raises(cm.LogError, match="damaged at byte"):
            cm.open_run(damaged)


def test_a_cut_file_with_a_wrong_byte_in_a_chunk_is_refused(log: Path, tmp_path: Path) -> None:
    whole = bytearray(log.read_bytes())
    chunks = LogFile(log)._chunks
    whole[chunks[1].offset + 200] ^= 1
    damaged = tmp_path / "damaged.mcap"
    damaged.write_bytes(whole[: chunks[-1].offset])
    with pytest.raises(cm.LogError, match="damaged at byte"):
        cm.open_run(damaged)


def test_zeros_at_the_end_are_a_cut_file(log: Path, tmp_path: Path) -> None:
    """What a file system leaves of a file that was growing when the power went."""
    whole = log.read_bytes()
    chunks = LogFile(log)._chunks
    path = tmp_path / "zeros.mcap"
    path.write_bytes(whole[: chunks[3].offset] + bytes(5000))
    run = cm.open_run(path)
    assert not run.complete
    assert len(run.time) == sum(len(chunk.indexes.get(1, ())) for chunk in chunks[:3]) > 0


def test_no_file_another_file_and_an_empty_file_are_clear_errors(tmp_path: Path) -> None:
    with pytest.raises(cm.LogError, match="cannot read"):
        cm.open_run(tmp_path / "missing.mcap")
    other = tmp_path / "other.mcap"
    other.write_text("title: a scene\n")
    with pytest.raises(cm.LogError, match="no MCAP file"):
        cm.open_run(other)
    other.write_bytes(b"")
    with pytest.raises(cm.LogError, match="nothing in it"):
        cm.open_run(other)


def test_an_mcap_file_by_someone_else_is_a_clear_error(tmp_path: Path) -> None:
    from mcap.writer import Writer

    path = tmp_path / "other.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start("ros2")
        writer.finish()
    with pytest.raises(cm.LogError, match="no log of cablemodel"):
        cm.open_run(path)


def test_a_log_by_another_schema_version_is_a_clear_error(
    simple_scene: Scene, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "run.mcap"
    monkeypatch.setattr("cablemodel.results.log.writer.SCHEMA_VERSION", "99")
    LogWriter(path, simple_scene).close()
    with pytest.raises(cm.LogError, match=r"schema version 99 .*install a newer cablemodel"):
        cm.open_run(path)
    monkeypatch.setattr("cablemodel.results.log.writer.SCHEMA_VERSION", "0")
    LogWriter(path, simple_scene).close()
    with pytest.raises(cm.LogError, match=r"schema version 0 .*read it with cablemodel \d"):
        cm.open_run(path)


def test_a_log_may_have_fewer_states_than_outputs(
    simple_scene: Scene, swinging_cable: Any, tmp_path: Path
) -> None:
    """Every fourth output and the last have states; all values over time are there and exact."""
    path = tmp_path / "run.mcap"
    full = cm.simulate(simple_scene, model=swinging_cable(simple_scene))
    memory = cm.simulate(simple_scene, model=swinging_cable(simple_scene), state_interval=1.2)
    model = swinging_cable(simple_scene)
    run = cm.simulate(simple_scene, log=path, model=model, state_interval=1.2)
    for thin in (run, memory):
        assert same(thin.time, full.time)
        assert same(thin.states.time, np.append(full.time[:-1:4], full.time[-1]))
        for name in full.names:
            assert same(thin[name], full[name])
        assert thin.summary()["max_curvature"] == full.states.max_curvature
    assert same_states(run, memory)
    result = replay(run, make_model=swinging_cable, tolerance=0.0)
    assert result.exact
    assert result.samples == len(full.time)
    with pytest.raises(ValueError, match="state_interval"):
        cm.simulate(simple_scene, model=swinging_cable(simple_scene), state_interval=0.0)


def test_more_outputs_than_fit_are_refused_before_a_model_is_made(
    simple_scene: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    def made(*_: Any) -> None:
        raise AssertionError("a model was made")

    monkeypatch.setattr("cablemodel.model.CableModel", made)
    for run in (cm.simulate, cm.converge, cm.convergence):
        with pytest.raises(cm.SceneError, match=r"run\.output_interval: .* outputs; allowed"):
            run(simple_scene, until=1e12)


def test_a_run_and_a_model_take_what_load_scene_takes(tmp_path: Path) -> None:
    path = Path(__file__).parents[2] / "scenes" / "towed_cable.yaml"
    scene = load_scene(path)
    expected = cm.simulate(scene, until=1.0)
    for source in (path, str(path), path.read_text(), scene.to_dict()):
        run = cm.simulate(source, until="1000 ms", state_interval="500 ms")
        assert run.scene == scene
        assert same(run.top_tension, expected.top_tension)
        assert cm.CableModel(source).top_tension == cm.CableModel(scene).top_tension
    for make in (cm.simulate, cm.CableModel):
        with pytest.raises(cm.SceneError, match="line: is missing"):
            make({})
        with pytest.raises(cm.SceneError, match=r"no\.yaml: cannot be read"):
            make(tmp_path / "no.yaml")
        with pytest.raises(cm.SceneError, match="5 is no scene; allowed: a file"):
            make(5)  # type: ignore[arg-type]


@pytest.mark.parametrize("until", ["2 m", "soon", True, [2.0], "-1 s"])
def test_a_wrong_end_is_said_in_the_words_of_a_scene(until: Any, simple_scene: Scene) -> None:
    for run in (cm.simulate, cm.converge, cm.convergence):
        with pytest.raises(cm.SceneError, match=r"^until: .*; allowed: a number above 0 in s"):
            run(simple_scene, until=until)


def test_what_is_no_model_is_said(simple_scene: Scene) -> None:
    for wrong in ("m", simple_scene, 3):
        with pytest.raises(TypeError, match=r"^model is .*; allowed: a CableModel"):
            cm.simulate(simple_scene, model=wrong)  # type: ignore[arg-type]
        with pytest.raises(TypeError, match=r"^model is .*; allowed: a CableModel"):
            cm.Recorder(wrong)  # type: ignore[arg-type]
