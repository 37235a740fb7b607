"""What a system says of its own errors, line by line and body by body, and whether it converges."""

import copy
import json
import math
import pickle
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import cablemodel as cm
from cablemodel.analysis.sweep import simulate_point
from cablemodel.cli import app
from cablemodel.errors import CableModelError, UnstableStartWarning
from cablemodel.results.compare import compare
from cablemodel.results.promise import ErrorEstimate
from cablemodel.results.recorder import SystemRecorder
from cablemodel.results.replay import replay
from cablemodel.results.run import SystemRun
from cablemodel.solvers.estimating import PLACES

SYSTEMS = Path(__file__).parents[2] / "scenes" / "systems"
DEPRESSOR, WEAK_LINK = SYSTEMS / "depressor.yaml", SYSTEMS / "weak_link.yaml"
BRIDLE = Path(__file__).with_name("bridle.yaml")
ESTIMATE = "solver.error_estimate=true"


def command(*arguments: Any) -> Result:
    return CliRunner().invoke(app, [str(item) for item in arguments])


def model_of(path: Path, *overrides: str) -> cm.SystemModel:
    return cm.SystemModel(cm.load_system(path, [ESTIMATE, *overrides]))


def said(run: cm.Run) -> ErrorEstimate:
    assert run.error_estimate is not None
    return run.error_estimate


@pytest.mark.parametrize(
    ("name", "end"), [("weak_link", 30.0), ("cage_on_its_winch", 20.0), ("streamer", 60.0)]
)
def test_results_are_those_of_a_run_without_it(name: str, end: float) -> None:
    path = SYSTEMS / f"{name}.yaml"
    plain, run = (cm.simulate(cm.load_system(path, given), until=end) for given in ([], [ESTIMATE]))
    assert plain.error_estimate is None
    parts = [(line, "position", "tension") for line in run.scene.lines]  # type: ignore[attr-defined]
    parts += [(body, "position") for body in run.scene.bodies]  # type: ignore[attr-defined]
    assert [item for item in run.names if item not in plain.names] == [
        f"{part}.{key}_error" for part, *keys in parts for key in keys
    ]
    for item in plain.names:
        assert np.array_equal(run[item], plain[item], equal_nan=True)
    assert compare(plain, run).identical
    assert run.statistics["steps"] == plain.statistics["steps"]


@pytest.mark.parametrize(
    ("name", "end"),
    [("depressor", 60.0), ("cage_on_its_winch", 40.0), ("bridle_tow", 50.0), ("anchor_last", 20.0)],
)
def test_the_estimate_covers_the_error_from_a_run_at_a_hundredth_of_the_tolerance(
    name: str, end: float
) -> None:
    """Of all lines anywhere, of tensions at their ends, and of bodies; where one was larger before,
    that counts."""
    path = SYSTEMS / f"{name}.yaml"
    model = model_of(path)
    tau = model.scene.solver.tolerance
    finest = cm.SystemModel(cm.load_system(path, [f"solver.tolerance={tau / 100.0}"]))
    rows: dict[str, list[Any]] = {part: [] for part in model.errors}
    largest = dict.fromkeys(model.lines, 0.0)
    for time in np.linspace(0.0, end, 41)[1:]:
        for each in (model, finest):
            each.step_to(time)
        errors = model.errors
        for part, line in model.lines.items():
            s = PLACES * min(line.length, finest.lines[part].length)
            one, other = line.sample(s), finest.lines[part].sample(s)
            apart = np.linalg.norm(one.position - other.position, axis=1).max()
            pull = np.abs(one.tension - other.tension)[[0, -1]].max()
            largest[part] = max(largest[part], np.abs(other.tension).max())
            rows[part].append((apart, errors[part].position, pull, errors[part].tension))
        for part, body in model.bodies.items():
            apart = np.linalg.norm(body.position - finest.bodies[part].position)
            rows[part].append((apart, errors[part].position, 0.0, 0.0))
    for part, values in rows.items():
        error, estimate, pull, doubt = np.array(values).T
        allowed = tau * model.errors[part].length
        assert (error < np.maximum.accumulate(estimate) + 0.05 * allowed).all(), part
        assert estimate.max() < 10.0 * error.max() + 0.05 * allowed, part
        if part in largest:
            allowed = 10.0 * tau * largest[part]
            doubted = np.maximum.accumulate(doubt)
            # Of what rings in other phases the estimate says that it is lost, not by how much.
            assert ((pull < doubted + 0.2 * allowed) | (doubted > allowed)).all(), part


def test_a_run_that_breaks_its_promise_names_the_line() -> None:
    kept = said(cm.simulate(cm.load_system(DEPRESSOR, [ESTIMATE])))
    assert kept.kept
    assert kept.problems(cm.load_system(DEPRESSOR).solver) == []
    assert [part.name for part in kept.parts] == ["wire", "depressor"]
    assert math.isnan(kept.parts[1].tension.share)
    run = cm.simulate(cm.load_system(WEAK_LINK, [ESTIMATE]), until=30.0)
    (wire,) = said(run).parts
    shares = run["wire.position_error"] / (1e-3 * 250.0)
    assert wire.position.share == shares.max() == said(run).share > 1.0
    assert wire.position.broken_at == run.time[shares > 1.0][0] > run["weak_link.time"][-1]
    first, *_rest = said(run).problems(run.scene.solver)
    assert first.startswith("positions of wire may be off by more than a tolerance of 0.001")
    assert f"first at t = {wire.position.broken_at:g} s" in first


def test_a_message_has_one_sentence_for_all_lines() -> None:
    at_once = "vessels.tug.turn_time=0.01"
    scene = cm.load_system(SYSTEMS / "bridle_tow.yaml", [ESTIMATE, at_once])
    run = cm.simulate(scene, until=45.0)
    (problem,) = said(run).problems(run.scene.solver)
    assert problem.startswith("tensions at the ends of port (and those of starboard, tow) may be")
    positions = cm.load_system(
        SYSTEMS / "bridle_tow.yaml", [ESTIMATE, at_once, "solver.accuracy_of=positions"]
    )
    assert said(cm.simulate(positions, until=45.0)).kept


def test_lengths_are_those_that_a_winch_has_paid_out() -> None:
    run = cm.simulate(cm.load_system(SYSTEMS / "cage_on_its_winch.yaml", [ESTIMATE]), until=20.0)
    assert isinstance(run, SystemRun)
    out = run["winch.line_length"]
    assert out[-1] > out[0] + 5.0
    umbilical, cage = run.parts_judged()
    assert np.array_equal(umbilical.length, out)
    assert np.array_equal(cage.length, out)
    model = model_of(SYSTEMS / "cage_on_its_winch.yaml")
    model.step_to(20.0)
    assert model.errors["umbilical"].length == model.errors["cage"].length
    assert model.errors["cage"].length == pytest.approx(out[-1])


def test_copies_and_snapshots_bring_it_along() -> None:
    model = model_of(BRIDLE)
    start = model.snapshot()
    forces = {"wing": [100.0, 0.0, 0.0, 0.0, 0.0, 0.0]}
    model.step(1.0, forces=forces)
    model.step(0.3, forces=forces, cuts=iter(["knife"]))
    then = model.errors
    assert min(errors.position for errors in then.values()) > 0.0
    snapshot = model.snapshot()
    others = [copy.copy(model), copy.deepcopy(model), pickle.loads(pickle.dumps(model))]
    assert all(other.errors == then for other in others)
    for each in (model, *others):
        each.step(0.2, forces=forces, deflections={"wing.elevator": 0.02})
    later = model.errors
    assert later != then
    assert all(other.errors == later for other in others)
    model.restore(snapshot)
    assert model.errors == then
    model.step(0.2, forces=forces, deflections={"wing.elevator": 0.02})
    assert model.errors == later
    model.reset()
    assert model.snapshot() == start == model_of(BRIDLE).snapshot()


def test_inputs_reach_the_finer_run() -> None:
    """Iterables that can be gone through once, too: else the runs would part."""
    model = model_of(BRIDLE)
    model.step(0.2, cuts=(name for name in ("knife",)))
    finer: Any = model._finer
    assert finer.cuts == model.cuts == {"knife": 0.0}


def test_a_foreign_snapshot_is_refused_and_changes_nothing() -> None:
    plain, model = cm.SystemModel(cm.load_system(DEPRESSOR)), model_of(DEPRESSOR)
    for each in (plain, model):
        each.step(5.0)
    errors, before = model.errors, model.snapshot()  # reading leaves its marks, once
    for wrong in (plain.snapshot(), b"", b"123", before[:-8], before + before):
        with pytest.raises(cm.SceneError, match="belongs to another scene"):
            model.restore(wrong)
    with pytest.raises(cm.SceneError, match="belongs to another scene"):
        plain.restore(before)
    assert model.snapshot() == before
    assert model.errors == errors


def test_a_finer_run_that_cannot_go_on_ends_the_estimate_and_nothing_else(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    plain, model = cm.SystemModel(cm.load_system(DEPRESSOR)), model_of(DEPRESSOR)
    for each in (plain, model):
        each.step(5.0)
    snapshot = model.snapshot()
    finer: Any = model._finer

    def stuck(*_: Any, **__: Any) -> None:
        raise cm.StepError("stuck", time=5.0)

    recorder = SystemRecorder(model)
    with recorder:
        with monkeypatch.context() as patch:
            patch.setattr(finer, "step_to", stuck)
            recorder.step_to(6.0)
        recorder.step_to(8.0)
        assert all(math.isnan(errors.position) for errors in model.errors.values())
    for time in (6.0, 8.0):
        plain.step_to(time)
    one, other = plain.lines["wire"].sample(), model.lines["wire"].sample()
    assert np.array_equal(one.position, other.position)
    assert np.array_equal(one.tension, other.tension)
    run = recorder.run()
    found = said(run)
    assert found.unknown_from == 6.0
    assert not found.kept
    assert "from t = 6 s on errors are not known" in found.problems(run.scene.solver)[-1]
    summary = run.summary()
    assert (summary["position_error"], summary["error_share"]) == (None, None)
    model.restore(snapshot)
    model.step(1.0)
    assert model.errors["wire"].position > 0.0


def test_a_finer_run_without_a_start_leaves_the_run_as_it_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from cablemodel.systems import model as module

    build = module.build

    def without(scene: cm.SystemScene) -> Any:
        if scene.solver.tolerance == 2.5e-4:
            raise cm.StaticsError("no static equilibrium of the system was found")
        return build(scene)

    monkeypatch.setattr(module, "build", without)
    model = model_of(DEPRESSOR)
    snapshot = model.snapshot()
    model.step(1.0)
    assert math.isnan(model.errors["wire"].position)
    model.restore(snapshot)
    run = cm.simulate(model.scene, until=2.0)
    assert said(run).unknown_from == 0.0
    assert "has no start" in said(run).problems(run.scene.solver)[0]


def test_an_unstable_start_is_told_once() -> None:
    """Not of the finer run as well. The wing has no tail."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        data = cm.load_system(DEPRESSOR, [ESTIMATE]).to_dict()
        for name in ("tail", "fin"):
            del data["bodies"]["depressor"]["foils"][name]
        cm.SystemModel(data)
    assert [warning.category for warning in caught] == [UnstableStartWarning]


def test_without_it_there_is_no_estimate() -> None:
    with pytest.raises(CableModelError, match=r"solver\.error_estimate: true"):
        _ = cm.SystemModel(cm.load_system(DEPRESSOR)).errors
    summary = cm.simulate(cm.load_system(DEPRESSOR), until=1.0).summary()
    assert not {"position_error", "tension_error", "error_share"} & set(summary)
    assert "position_error" not in summary["lines"]["wire"]


def test_a_log_holds_it_and_replays(tmp_path: Path) -> None:
    log, page, picture = (tmp_path / f"run.{end}" for end in ("mcap", "html", "png"))
    scene = cm.load_system(BRIDLE, [ESTIMATE])
    memory, read = cm.simulate(scene, until=5.0), cm.simulate(scene, until=5.0, log=log)
    for name in ("port.position_error", "streamer.tension_error", "wing.position_error"):
        assert np.array_equal(read[name], memory[name])
    assert read.error_estimate == memory.error_estimate
    assert replay(cm.open_run(log)).passed
    assert command("report", log, "-o", page).exit_code == 0
    text = page.read_text(encoding="utf-8")
    assert f"Estimated error, positions of {said(read).of_positions.name}" in text
    assert text.count("estimated error") >= 1
    assert command("plot", log, "-o", picture).exit_code == 0


def test_the_command_line_says_it(tmp_path: Path) -> None:
    shown = command("run", DEPRESSOR, "--error-estimate", "--until", 20)
    assert shown.exit_code == 0, shown.output
    summary = cm.simulate(cm.load_system(DEPRESSOR, [ESTIMATE]), until=20.0).summary()
    words = " ".join(shown.output.replace("│", " ").split())
    assert f"estimated error, positions of wire {summary['position_error']:.3g} m, " in words
    assert f"estimated error, tensions at the ends {summary['tension_error']:.3g} N, " in words
    printed = json.loads(
        command("run", DEPRESSOR, "--error-estimate", "--until", 20, "--json").stdout
    )
    for each in (printed, summary):
        each.pop("wall_time")
    assert printed == summary
    assert printed["lines"]["wire"]["position_error"] == printed["position_error"]
    assert 0.0 < printed["bodies"]["depressor"]["position_error"] < printed["position_error"]
    broken = command("run", WEAK_LINK, "--error-estimate", "--until", 30)
    assert "warning: positions of wire may be off by more than a tolerance" in broken.output
    assert "cablemodel run SCENE --converge" in broken.output


def test_a_system_that_keeps_its_tolerance_is_confirmed_by_the_next(tmp_path: Path) -> None:
    finer = ["solver.tolerance=2.5e-4", "solver.accuracy=1e-3", ESTIMATE]
    plain = cm.simulate(cm.load_system(DEPRESSOR, finer), until=20.0)
    seen: list[float] = []
    log = tmp_path / "run.mcap"
    run = cm.converge(DEPRESSOR, until=20.0, log=log, progress=lambda tau, _now: seen.append(tau))
    assert run.scene == plain.scene
    assert set(seen) == {1e-3, 2.5e-4}
    for name in plain.names:
        assert np.array_equal(run[name], plain[name], equal_nan=True)
    assert said(run).kept
    assert replay(cm.open_run(log)).passed


@pytest.mark.slow
def test_a_system_that_does_not_settle_says_where(tmp_path: Path) -> None:
    """Both ends of a wire that breaks fly back, in a way of their own at every tolerance."""
    log = tmp_path / "run.mcap"
    with pytest.raises(cm.ConvergenceError) as caught:
        cm.converge(WEAK_LINK, log=log, until=28.0)
    attempts = caught.value.attempts
    assert [attempt.tolerance for attempt in attempts] == [1e-3, 2.5e-4, 6.25e-5]
    assert all(
        attempt.problem.startswith("positions of wire may be off by") for attempt in attempts
    )
    assert cm.open_run(log).time[-1] == 28.0
    cut = cm.open_run(log)["weak_link.time"][-1]
    # Until then it does: what was refused is the flight, not the pull.
    assert said(cm.converge(WEAK_LINK, until=cut - 1.0)).kept
    shown = command("run", WEAK_LINK, "--converge", "--until", 28)
    assert shown.exit_code == 1
    assert shown.stderr.count("positions of wire may be off") == 3


def test_runs_of_a_sweep_converge_each_by_itself() -> None:
    row = simulate_point(DEPRESSOR.read_text(), str(SYSTEMS), ["run.duration=5"], converge=True)
    assert (row["tolerance"], row["error"]) == (2.5e-4, "")
    assert 0.0 < row["error_share"] < 1.0
    assert row["wire.start_tension"] > 0.0


@pytest.mark.parametrize(
    ("overrides", "more", "words"),
    [
        ([], {"attempts": 1}, "attempts is 1, it must be 2 or more"),
        ([], {"until": -1.0}, "until: -1.0 is out of range"),
        (["solver={method: direct_integration}"], {}, "direct_integration computes one line"),
        (["solver.accuracy=1e-4"], {}, r"solver.accuracy: finer than the tolerance of 0\.001"),
    ],
)
def test_bad_input(overrides: list[str], more: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        cm.converge(cm.load_system(DEPRESSOR, overrides), **more)
