"""A run that is made again until it keeps what is asked of it, or that says that none does."""

import json
import pickle
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import cablemodel as cm
from cablemodel.analysis.sweep import simulate_point
from cablemodel.cli import app
from cablemodel.results.replay import replay

SCENES = Path(__file__).parents[2] / "scenes"
TOW, WHIP = SCENES / "towed_cable.yaml", SCENES / "whip.yaml"


def command(*arguments: Any) -> Result:
    return CliRunner().invoke(app, [str(item) for item in arguments])


def test_a_run_that_keeps_its_tolerance_is_confirmed_by_the_next() -> None:
    finer = ["solver.tolerance=2.5e-4", "solver.accuracy=1e-3", "solver.error_estimate=true"]
    plain = cm.simulate(cm.load_scene(TOW, finer), until=30.0)
    run = cm.converge(TOW, until=30.0)
    assert run.scene == plain.scene
    assert run.statistics["steps"] == plain.statistics["steps"]
    for name in plain.names:
        assert np.array_equal(run[name], plain[name], equal_nan=True)
    assert run.error_estimate is not None
    assert run.error_estimate.kept


def test_a_run_that_does_not_is_made_at_the_tolerance_that_does(tmp_path: Path) -> None:
    log, seen = tmp_path / "run.mcap", []
    run = cm.converge(WHIP, log=log, progress=lambda tau, now: seen.append((tau, now.time)))
    scene = cm.load_scene(WHIP)
    used, asked = run.scene.solver.tolerance, scene.solver.tolerance
    assert used == asked / 16.0  # tau/4 keeps it, by its own estimate, and this one confirms that
    assert run.scene.solver.accuracy == asked
    # The attempts before it were given up where they were first known to fail.
    alone = cm.simulate(cm.load_scene(WHIP, ["solver.error_estimate=true"]))
    assert alone.error_estimate is not None
    assert (
        max(time for tau, time in seen if tau == asked) == alone.error_estimate.position.broken_at
    )
    assert seen[-1] == (used, scene.run.duration)
    # By a run that none of them has seen.
    one, other = (cm.CableModel(cm.load_scene(WHIP, [f"solver.tolerance={tau}"])) for tau in (
        used, used / 64.0,
    ))  # fmt: skip
    for k, time in enumerate(run.time):
        for model in (one, other):
            if k:
                model.step_to(time)
        assert np.array_equal(one.tip_position, run.tip_position[k])
        s = np.linspace(0.0, 10.0, 101)
        deviation = np.linalg.norm(one.sample(s).position - other.sample(s).position, axis=1)
        assert deviation.max() < 10.0 * asked
    # The log says all of it, and replays.
    read = cm.open_run(log)
    assert read.scene == run.scene
    assert read.error_estimate == run.error_estimate
    assert read.error_estimate is not None
    assert read.error_estimate.kept
    assert replay(read).passed


def test_what_cannot_be_kept_is_an_error_with_the_last_run(tmp_path: Path) -> None:
    log = tmp_path / "run.mcap"
    with pytest.raises(cm.ConvergenceError) as caught:
        cm.converge(WHIP, attempts=2, log=log)
    error = caught.value
    assert error.accuracy == 1e-3
    # Nothing could confirm a second one.
    assert [attempt.tolerance for attempt in error.attempts] == [1e-3]
    assert "no run is known to keep an accuracy of 0.001" in str(error)
    assert "tolerance 0.001: positions may be off by more than an accuracy" in str(error)
    assert error.run is not None
    assert error.run.time[-1] == error.run.scene.run.duration
    assert error.run.error_estimate is not None
    assert not error.run.error_estimate.kept
    assert cm.open_run(log).complete
    again = pickle.loads(pickle.dumps(cm.ConvergenceError(1e-3, error.attempts)))
    assert str(again) == str(error)
    assert again.run is None


class Failing(cm.CableModel):
    """The engine, without a start or stopped at 2 s at some tolerances."""

    starts: ClassVar[set[float]] = set()
    stops: ClassVar[set[float]] = set()

    def __init__(self, scene: cm.Scene) -> None:
        if scene.solver.tolerance in self.starts:
            raise cm.StaticsError(f"no start at {scene.solver.tolerance:g}")
        super().__init__(scene)

    def step_to(self, *arguments: Any, **more: Any) -> None:
        if self.scene.solver.tolerance in self.stops and self.time >= 2.0:
            raise cm.StepError("stuck", time=self.time)
        super().step_to(*arguments, **more)


@pytest.fixture
def failing(monkeypatch: pytest.MonkeyPatch) -> type[Failing]:
    monkeypatch.setattr("cablemodel.model.CableModel", Failing)
    monkeypatch.setattr(Failing, "starts", set())
    monkeypatch.setattr(Failing, "stops", set())
    return Failing


def test_an_attempt_that_fails_is_made_again_finer(failing: type[Failing]) -> None:
    failing.starts.add(1e-3)
    failing.stops.add(2.5e-4)
    run = cm.converge(TOW, until=5.0)
    assert run.scene.solver.tolerance == 1e-3 / 64.0
    assert run.complete


def test_without_any_attempt_to_judge_the_first_error_stands(failing: type[Failing]) -> None:
    failing.starts.update({1e-3, 2.5e-4})
    with pytest.raises(cm.StaticsError, match=r"no start at 0\.001"):
        cm.converge(TOW, attempts=2)


def test_a_last_attempt_that_fails_leaves_the_run_before_it(
    failing: type[Failing], tmp_path: Path
) -> None:
    log = tmp_path / "run.mcap"
    failing.stops.add(2.5e-4)
    with pytest.raises(cm.ConvergenceError, match=r"0\.00025: at t = 2 s: stuck") as caught:
        cm.converge(TOW, attempts=2, until=5.0, log=log)
    problem = "tolerance 0.001: errors are estimated to be small enough, which no other attempt"
    assert problem in str(caught.value)
    run = caught.value.run
    assert run is not None
    assert (run.time[-1], run.scene.solver.tolerance) == (5.0, 1e-3)
    assert cm.open_run(log).time[-1] == 5.0
    assert list(tmp_path.iterdir()) == [log]
    # Without one that came to its end, what there is.
    failing.stops.update({1e-3, 6.25e-5, 1e-3 / 64.0})
    failing.starts.add(2.5e-4)
    log.unlink()
    result = command("run", TOW, "--converge", "--until", 5, "--log", log)
    assert result.exit_code == 1
    assert f"What was reached, up to t = 2 s, is in {log}" in result.stderr
    assert cm.open_run(log).time[-1] == 2.0
    assert list(tmp_path.iterdir()) == [log]


class Estimating(cm.CableModel):
    """The engine, whose estimates of its errors are given, as shares of 1e-3 L and about 0.7 N."""

    shares: ClassVar[dict[float, float]] = {}
    pulls: ClassVar[dict[float, float]] = {}

    @property
    def position_error(self) -> float:
        return self.shares[self.scene.solver.tolerance] * 1e-3 * self.line_length

    @property
    def tension_error(self) -> float:
        return self.pulls.get(self.scene.solver.tolerance, 0.0) * 1e-2 * self.tension_max


@pytest.mark.parametrize(
    ("shares", "taken"),
    [
        ([0.9, 0.5], 2.5e-4),
        ([0.9, 0.9], 2.5e-4),
        ([0.1, 0.2], 2.5e-4),  # too small to matter
        ([1.1, 0.9, 0.5], 6.25e-5),
        ([0.3, 0.5, 0.4, 0.3], 1e-3 / 64.0),  # grows, and falls again
        ([0.3, 1.1, 0.4, 0.3], 1e-3 / 64.0),
        ([1.1, 0.4, 0.5], None),
        ([0.3, 0.4, 0.9, 1.1], None),
        ([0.9, 1.1, 1.1], None),
    ],
)
def test_two_in_a_row_must_keep_it_and_not_grow(
    shares: list[float], taken: float | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    table = {1e-3 / 4.0**k: share for k, share in enumerate(shares)}
    monkeypatch.setattr("cablemodel.model.CableModel", Estimating)
    monkeypatch.setattr(Estimating, "shares", table)
    if taken is not None:
        run = cm.converge(TOW, until=1.0)
        assert run.scene.solver.tolerance == taken
        return
    with pytest.raises(cm.ConvergenceError) as caught:
        cm.converge(TOW, until=1.0)
    assert [attempt.tolerance for attempt in caught.value.attempts] == list(table)
    assert caught.value.run is not None
    if shares == [1.1, 0.4, 0.5]:
        assert caught.value.attempts[-1].problem == (
            "errors of positions grow, from 0.4 to 0.5 of what is allowed"
        )


def test_neither_positions_nor_tensions_may_grow(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cablemodel.model.CableModel", Estimating)
    monkeypatch.setattr(
        Estimating, "shares", {1e-3: 0.1, 2.5e-4: 0.9, 6.25e-5: 0.1, 1e-3 / 64: 0.1}
    )
    monkeypatch.setattr(
        Estimating, "pulls", {1e-3: 0.95, 2.5e-4: 0.1, 6.25e-5: 0.3, 1e-3 / 64: 0.5}
    )
    with pytest.raises(cm.ConvergenceError) as caught:
        cm.converge(TOW, until=1.0)
    problems = [attempt.problem for attempt in caught.value.attempts]
    assert problems == [
        "",
        "errors of positions grow, from 0.1 to 0.9 of what is allowed",
        "",
        "errors of the top tension grow, from 0.3 to 0.5 of what is allowed",
    ]


def test_tensions_may_be_left_out(tmp_path: Path) -> None:
    """The winch's jerk makes the line ring along itself, in another way at every tolerance."""
    path, log = SCENES / "touchdown.yaml", tmp_path / "run.mcap"
    with pytest.raises(cm.ConvergenceError, match="the top tension may be off"):
        cm.converge(path, until=22.0)
    shown = command(
        "run", path, "--converge", "--until", 22, "--set", "solver.accuracy_of=positions",
        "--log", log,
    )  # fmt: skip
    assert shown.exit_code == 0, shown.output
    assert "not asked for" in shown.output
    assert "warning" not in shown.output
    run = cm.open_run(log)
    assert run.error_estimate is not None
    assert 0.0 < run.error_estimate.share == run.error_estimate.position.share < 1.0
    assert run["tension_error"].max() > 10.0 * 1e-4 * run.top_tension.max()
    positions = cm.load_scene(path, ["solver.accuracy_of=positions", "run.duration=22"])
    found = cm.convergence(positions, [2.5e-5])
    assert "Tensions are not judged: the scene asks for positions." in found.notes
    assert found.passed


@pytest.mark.parametrize(
    ("overrides", "more", "words"),
    [
        ([], {"attempts": 2.5}, "attempts is 2.5, it must be 2 or more"),
        ([], {"attempts": 1}, "attempts is 1, it must be 2 or more"),
        ([], {"until": -1.0}, "until: -1.0 is out of range"),
        (
            ["solver={method: direct_integration}"],
            {},
            "solver.method: direct_integration has no tol",
        ),
        (["solver.accuracy=1e-4"], {}, r"solver.accuracy: finer than the tolerance of 0\.001"),
        (["solver.accuracy=2"], {}, r"solver.accuracy: 2 is out of range"),
        (["solver={method: direct_integration, accuracy: 0.1}"], {}, "no such setting"),
    ],
)
def test_bad_input(overrides: list[str], more: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        cm.converge(cm.load_scene(TOW, overrides), **more)


def test_an_accuracy_is_kept_through_text_and_judged_by() -> None:
    scene = cm.load_scene(WHIP, ["solver.tolerance=2.5e-4", "solver.accuracy=1e-3"])
    assert cm.load_scene(scene.to_yaml()) == scene
    assert scene.solver.promised == 1e-3
    # What is computed does not depend on what is asked for.
    finer = cm.load_scene(WHIP, ["solver.tolerance=2.5e-4"])
    one, other = cm.simulate(scene), cm.simulate(finer)
    assert np.array_equal(one.tip_position, other.tip_position)
    found = cm.convergence(scene, [6.25e-5])
    assert found.outcome == "kept"
    assert "At its tolerance of 0.00025 the run keeps an accuracy of 0.001" in found.conclusion
    broken = cm.convergence(finer, [6.25e-5])
    assert broken.outcome != "kept"
    for row, other in zip(found.rows, broken.rows, strict=True):
        assert row.position == replace(other.position, allowed=row.position.allowed)
        assert row.position_share == row.position.share / 1e-3


def test_the_command_line_tells_what_it_took(tmp_path: Path) -> None:
    log = tmp_path / "run.mcap"
    shown = command("run", WHIP, "--converge", "--log", log)
    assert shown.exit_code == 0, shown.output
    assert "6.25e-05, for an accuracy of 0.001" in shown.output
    assert "warning" not in shown.output
    summary = json.loads(command("run", WHIP, "--converge", "--json").stdout)
    assert (summary["tolerance"], summary["accuracy"]) == (6.25e-5, 1e-3)
    assert 0.0 < summary["error_share"] < 1.0
    page = tmp_path / "run.html"
    assert command("report", log, "-o", page).exit_code == 0
    assert "accuracy asked for" in page.read_text(encoding="utf-8")


def test_the_command_line_ends_with_status_1_where_none_is_good_enough(tmp_path: Path) -> None:
    log, long = tmp_path / "run.mcap", ("--until", 12)  # some seconds later no two runs agree
    shown = command("run", WHIP, *long, "--converge", "--log", log)
    assert shown.exit_code == 1
    assert "no run is known to keep an accuracy of 0.001" in shown.stderr
    assert shown.stderr.count("positions may be off") == 3
    assert "tolerance 6.25e-05" in shown.stderr
    assert "warning: positions may be off by more than an accuracy of 0.001" in shown.stdout
    assert cm.open_run(log).time[-1] == 12.0
    printed = command("run", WHIP, *long, "--converge", "--json")
    assert printed.exit_code == 1
    assert json.loads(printed.stdout)["error_share"] > 1.0


def test_runs_of_a_sweep_converge_each_by_itself() -> None:
    text = WHIP.read_text(encoding="utf-8") + "\n"
    rows = [
        simulate_point(text, str(SCENES), [f"run.duration={end}"], converge=True)
        for end in (0.5, 2.0)
    ]
    assert [row["tolerance"] for row in rows] == [2.5e-4, 6.25e-5]
    assert all(0.0 < row["error_share"] < 1.0 and not row["error"] for row in rows)
    lost = simulate_point(text, str(SCENES), ["run.duration=12"], converge=True)
    assert lost["error_share"] > 1.0
    assert lost["time"] == 12.0
    assert "no run is known to keep" in lost["error"]
