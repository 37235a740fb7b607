"""What a run says of its own errors: it has them, and saying so changes nothing."""

import copy
import json
import math
import pickle
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import cablemodel as cm
from cablemodel.cli import app
from cablemodel.cli.run import _error_rows
from cablemodel.results.compare import compare
from cablemodel.results.promise import EstimatedError
from cablemodel.results.replay import replay
from cablemodel.solvers.finite_element.solver import FiniteElementSolver
from cablemodel.solvers.shared import layout as at
from tests.verification.scenes import pendulum

SCENES = Path(__file__).parents[2] / "scenes"
TOW = SCENES / "towed_cable.yaml"
ESTIMATE = "solver.error_estimate=true"


def command(*arguments: Any) -> Result:
    return CliRunner().invoke(app, [str(item) for item in arguments])


def stepped(model: cm.CableModel) -> Iterator[None]:
    """A tow that leaves its plane, in a current, by steps of a caller."""
    for k in range(1, 9):
        speed = (0.1 * k, 0.02 * k, 0.0)
        model.step(0.7, vessel_velocity=speed, current=(0.0, 0.1, 0.0))
        yield


@pytest.mark.parametrize(
    "name", ["towed_cable", "turn", "whip", "release_in_water", "payout_with_bodies", "deployment"]
)
def test_results_are_those_of_a_run_without_it(name: str) -> None:
    path = SCENES / f"{name}.yaml"
    plain, run = (cm.simulate(cm.load_scene(path, given)) for given in ((), [ESTIMATE]))
    assert plain.error_estimate is None
    assert [item for item in run.names if item not in plain.names] == [
        "position_error",
        "tension_error",
    ]
    for item in plain.names:
        assert np.array_equal(run[item], plain[item], equal_nan=True)
    for one, other in zip(run.states, plain.states, strict=True):
        assert np.array_equal(one.position, other.position)
    counts = ("steps", "rejected", "factorisations", "elements")
    assert [run.statistics[key] for key in counts] == [plain.statistics[key] for key in counts]


@pytest.mark.parametrize("tolerance", [1e-2, 1e-3, 1e-4])
def test_the_estimate_is_the_error_from_the_exact_path_of_a_pendulum(tolerance: float) -> None:
    scene, path = pendulum()
    data = scene.to_dict()
    data["solver"] = {"tolerance": tolerance, "error_estimate": True}
    run = cm.simulate(cm.load_scene(data))
    exact = np.linalg.norm(run.tip_position[1:, [0, 2]] - path, axis=1)
    estimated = run["position_error"][1:]
    # Far below what is allowed both runs may err alike.
    assert (exact < np.maximum.accumulate(estimated) + 0.1 * tolerance).all()
    assert exact.max() < estimated.max() < 2.5 * exact.max()


@pytest.mark.filterwarnings("ignore::cablemodel.TautLayWarning")  # of the scene recovery
@pytest.mark.parametrize("name", ["towed_cable", "turn", "deployment", "recovery"])
def test_the_estimate_bounds_the_distance_from_a_far_finer_run(name: str) -> None:
    path = SCENES / f"{name}.yaml"
    model = cm.CableModel(cm.load_scene(path, [ESTIMATE]))
    tolerance = model.scene.solver.tolerance
    finest = cm.CableModel(cm.load_scene(path, [f"solver.tolerance={tolerance / 64.0}"]))
    found = []
    for _ in range(30):
        for each in (model, finest):
            each.step(2.0)
        s = np.linspace(0.0, min(model.line_length, finest.line_length), 201)
        apart = np.linalg.norm(model.sample(s).position - finest.sample(s).position, axis=1).max()
        found.append((apart, model.position_error, tolerance * model.line_length))
    error, estimate, allowed = np.array(found).T
    assert (error < estimate + 0.05 * allowed).all()
    assert estimate.max() < 10.0 * error.max()


def test_it_knows_a_run_that_breaks_its_promise_from_one_that_keeps_it() -> None:
    tow = cm.load_scene(TOW, [ESTIMATE])
    kept = cm.simulate(tow).error_estimate
    assert kept is not None
    assert kept.kept
    assert 0.0 < kept.share < 0.5
    assert kept.problems(tow.solver) == []
    assert (kept.position.broken_at, kept.tension.broken_at, kept.unknown_from) == (None,) * 3
    assert kept.taut_until == math.inf
    run = cm.simulate(cm.load_scene(SCENES / "whip.yaml", [ESTIMATE]))
    broken = run.error_estimate
    assert broken is not None
    assert not broken.kept
    shares = run["position_error"] / (run.scene.solver.tolerance * run["line_length"])
    assert broken.share == broken.position.share == shares.max() > 1.0
    assert broken.position.broken_at == run.time[shares > 1.0][0]
    assert broken.position.time == run.time[np.argmax(run["position_error"])]
    # It starts slack: tensions are not promised.
    assert broken.taut_until == 0.0
    assert math.isnan(broken.tension.share)
    (problem,) = broken.problems(run.scene.solver)
    assert f"first at t = {broken.position.broken_at:g} s" in problem
    assert "positions may be off" in problem


def test_tensions_count_until_the_line_is_slack() -> None:
    run = cm.simulate(cm.load_scene(SCENES / "touchdown.yaml", [ESTIMATE]), until=40.0)
    found = run.error_estimate
    assert found is not None
    assert 20.0 < found.taut_until < 35.0
    pull = max(float(np.abs(run[name]).max()) for name in ("tension_max", "tension_min"))
    allowed = 10.0 * run.scene.solver.tolerance * pull
    taut = run.time < found.taut_until
    assert found.tension.largest == run["tension_error"][taut].max()
    assert found.tension.share == pytest.approx(found.tension.largest / allowed)
    assert run["tension_error"][~taut].max() > 10.0 * found.tension.largest


@pytest.mark.parametrize(
    "copied",
    [copy.deepcopy, lambda model: pickle.loads(pickle.dumps(model))],
    ids=["deepcopy", "pickle"],
)
def test_copies_and_snapshots_bring_it_along(
    copied: Callable[[cm.CableModel], cm.CableModel],
) -> None:
    model = cm.CableModel(cm.load_scene(TOW, [ESTIMATE]))
    for _ in stepped(model):
        pass
    then = (model.position_error, model.tension_error)
    assert min(then) > 0.0
    snapshot, other = model.snapshot(), copied(model)
    assert (other.position_error, other.tension_error) == then
    for each in (model, other):
        each.step(3.0, vessel_velocity=(0.0, 0.0, 0.0))
    later = (model.position_error, model.tension_error)
    assert (other.position_error, other.tension_error) == later != then
    model.restore(snapshot)
    assert (model.position_error, model.tension_error) == then
    model.step(3.0, vessel_velocity=(0.0, 0.0, 0.0))
    assert (model.position_error, model.tension_error) == later
    model.reset()
    fresh = cm.CableModel(cm.load_scene(TOW, [ESTIMATE]))
    assert model.snapshot() == fresh.snapshot()
    assert model.position_error == fresh.position_error


def test_a_snapshot_without_it_is_refused_and_changes_nothing() -> None:
    plain = cm.CableModel(cm.load_scene(TOW))
    model = cm.CableModel(cm.load_scene(TOW, [ESTIMATE]))
    for each in (plain, model):
        each.step(5.0)
    kept = model.snapshot()
    for one, other in ((plain, model), (model, plain)):
        before = other.snapshot()
        with pytest.raises(cm.SceneError, match="another scene"):
            other.restore(one.snapshot())
        with pytest.raises(cm.SceneError, match=f"a snapshot of {len(before)} bytes"):
            other.restore(replace(one.snapshot(), scene=""))
        assert other.snapshot() == before
    # Right in length, but of another line in its second half.
    longer = cm.CableModel(cm.load_scene(TOW, [ESTIMATE, "line.0.cable.elements=9"]))
    half = len(plain.snapshot())
    mixed = kept.image[:half] + longer.snapshot().image[: len(kept) - half]
    with pytest.raises(cm.SceneError, match="belongs to another scene or version"):
        model.restore(replace(kept, image=mixed))
    assert model.snapshot() == kept


def test_a_finer_run_that_cannot_go_on_ends_the_estimate_and_nothing_else() -> None:
    model = cm.CableModel(cm.load_scene(TOW, [ESTIMATE]))
    plain = cm.CableModel(cm.load_scene(TOW))
    for each in (model, plain):
        each.step(5.0)
    snapshot = model.snapshot()
    finer: Any = model._solver
    finer._finer.step = lambda end, inputs: at.NOT_CONVERGED
    recorder = cm.Recorder(model)
    with recorder:
        recorder.step_to(6.0)
        del finer._finer.step
        recorder.step_to(8.0)
        assert math.isnan(model.position_error)
        assert math.isnan(model.tension_error)
    plain.step_to(6.0)
    plain.step_to(8.0)
    assert np.array_equal(model.state().position, plain.state().position)
    found = recorder.run().error_estimate
    assert found is not None
    assert found.unknown_from == 6.0
    assert not found.kept
    assert math.isnan(found.share)
    last = found.problems(plain.scene.solver)[-1]
    assert "from t = 6 s on errors are not known: the run at 0.00025" in last
    model.restore(snapshot)
    model.step(1.0)
    assert model.position_error > 0.0


def test_a_finer_run_without_a_start_leaves_the_run_as_it_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    build = FiniteElementSolver.__init__

    def without(self: Any, scene: cm.Scene, **settings: Any) -> None:
        if scene.solver.tolerance == 2.5e-4:
            raise cm.StaticsError("no static equilibrium was found")
        build(self, scene, **settings)

    monkeypatch.setattr(FiniteElementSolver, "__init__", without)
    scene = cm.load_scene(TOW, [ESTIMATE])
    model, plain = cm.CableModel(scene), cm.CableModel(cm.load_scene(TOW))
    snapshot = model.snapshot()
    for each in (model, plain):
        each.step(5.0)
    assert math.isnan(model.position_error)
    assert np.array_equal(copy.deepcopy(model).state().position, plain.state().position)
    model.restore(snapshot)
    assert model.time == 0.0
    run = cm.simulate(scene, until=5.0)
    found = run.error_estimate
    assert found is not None
    assert found.unknown_from == 0.0
    assert not found.kept
    assert "has no start" in found.problems(run.scene.solver)[0]
    summary = run.summary()
    assert [summary[key] for key in ("position_error", "tension_error", "error_share")] == [
        None
    ] * 3


@pytest.mark.filterwarnings("ignore::cablemodel.TautLayWarning")  # of the scene recovery
def test_runs_with_and_without_it_are_no_different() -> None:
    path = SCENES / "recovery.yaml"
    plain, run = (cm.simulate(cm.load_scene(path, given), until=20.0) for given in ((), [ESTIMATE]))
    for one, other in ((plain, run), (run, plain)):
        found = compare(one, other)
        assert found.identical
        assert found.passed
    allowed = [
        {item.name: item.allowed for item in compare(one, run, tolerance=1e-3).differences}
        for one in (plain, run)
    ]
    assert allowed[1].items() >= allowed[0].items()


def test_a_step_that_is_refused_changes_neither_run(monkeypatch: pytest.MonkeyPatch) -> None:
    model = cm.CableModel(cm.load_scene(TOW, [ESTIMATE]))
    model.step(2.0)
    before, error = model.snapshot(), model.position_error
    for wrong in ({"vessel_velocity": (math.nan, 0.0, 0.0)}, {"payout_rate": math.inf}):
        with pytest.raises(cm.StepError, match="not finite"):
            model.step(1.0, **wrong)
    with monkeypatch.context() as patch:
        patch.setattr(FiniteElementSolver, "step", lambda *_: at.TOO_MANY_STEPS)
        with pytest.raises(cm.StepError, match="internal steps"):
            model.step(1.0)
    assert model.snapshot() == before
    assert model.position_error == error


def test_without_it_there_is_no_estimate() -> None:
    model = cm.CableModel(cm.load_scene(TOW))
    for name in ("position_error", "tension_error"):
        with pytest.raises(cm.CableModelError, match=r"solver\.error_estimate: true"):
            getattr(model, name)
    run = cm.simulate(model.scene, until=1.0)
    assert not {"position_error", "tension_error", "error_share"} & set(run.summary())
    assert "error_estimate" not in run.scene.to_dict()["solver"]
    with pytest.raises(cm.SceneError, match=r"solver\.error_estimate: direct_integration has no"):
        cm.load_scene(TOW, ["solver={method: direct_integration, error_estimate: true}"])
    with pytest.raises(cm.SceneError, match=r"solver\.error_estimate"):
        cm.load_scene(TOW, ["solver.error_estimate=0.3"])


def test_estimates_are_shares_of_what_is_allowed() -> None:
    time, errors = np.arange(5.0), np.array([0.0, 3.0, np.nan, 1.0, 2.0])
    found = EstimatedError.of(time, errors, np.array([1.0, 4.0, 1.0, 0.5, 4.0]))
    assert found == EstimatedError(largest=3.0, time=1.0, share=2.0, broken_at=3.0)
    none = EstimatedError.of(time[:0], errors[:0], errors[:0])
    assert math.isnan(none.share)
    assert none.broken_at is None


def test_a_log_holds_it_and_replays(tmp_path: Path) -> None:
    log = tmp_path / "run.mcap"
    scene = cm.load_scene(SCENES / "deployment.yaml", [ESTIMATE])
    memory = cm.simulate(scene, until=20.0)
    read = cm.simulate(scene, until=20.0, log=log)
    assert read.scene.solver.error_estimate
    assert np.array_equal(read["position_error"], memory["position_error"])
    assert read.error_estimate == memory.error_estimate
    result = replay(cm.open_run(log))
    assert result.passed
    found = {item.name: item.largest for item in result.differences}
    assert found["position_error"] == found["tension_error"] == 0.0


def test_the_command_line_says_it(tmp_path: Path) -> None:
    shown = command("run", TOW, "--error-estimate", "--until", 20)
    assert shown.exit_code == 0, shown.output
    summary = cm.simulate(cm.load_scene(TOW, [ESTIMATE]), until=20.0).summary()
    assert f"{summary['position_error']:.3g} m, " in shown.output
    assert f"{summary['tension_error']:.3g} N, " in shown.output
    assert "of what is allowed" in shown.output
    assert "warning" not in shown.output
    printed = json.loads(command("run", TOW, "--error-estimate", "--until", 20, "--json").stdout)
    assert printed["error_share"] == summary["error_share"] < 1.0
    whip = command("run", SCENES / "whip.yaml", "--error-estimate", "--until", 2)
    assert whip.exit_code == 0
    assert "not promised" in whip.output
    assert "warning: positions may be off by more than a tolerance of 0.001" in whip.output
    assert "cablemodel run SCENE --converge" in whip.output


@pytest.mark.parametrize(
    ("fails_at", "row", "note"),
    [
        (6.0, ", not known from t = 6 s on", " of what is allowed; not known from t = 6"),
        (0.0, "not known", "not known from t = 0"),
    ],
)
def test_tables_say_from_when_on_errors_are_not_known(
    fails_at: float, row: str, note: str, tmp_path: Path
) -> None:
    """The largest of those that are known would be the error of the first second, or of rest."""
    model = cm.CableModel(cm.load_scene(TOW, [ESTIMATE]))
    finer: Any = model._solver
    if not fails_at:
        finer._finer.memory.scalars.time = -1.0
    with cm.Recorder(model, tmp_path / "run.mcap", output_interval=1.0) as recorder:
        for time in range(1, 11):
            if time == fails_at:
                finer._finer.step = lambda end, inputs: at.NOT_CONVERGED
            recorder.step_to(float(time))
    run = cm.open_run(tmp_path / "run.mcap")
    estimate = run.error_estimate
    assert estimate is not None
    assert estimate.unknown_from == fails_at
    rows = _error_rows(run)
    assert [name for name, _ in rows] == [
        f"estimated error, {w}" for w in ("positions", "top tension")
    ]
    assert all(text.endswith(row) for _, text in rows)
    page = command("report", tmp_path / "run.mcap", "-o", tmp_path / "run.html")
    assert page.exit_code == 0, page.output
    assert (tmp_path / "run.html").read_text(encoding="utf-8").count(note) == 2
