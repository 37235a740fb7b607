"""A scene at several tolerances: its errors are those that it has, and the conclusion holds."""

import json
import re
import shlex
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import cablemodel as cm
from cablemodel.accuracy.study import runs_of
from cablemodel.cli import app
from cablemodel.solvers import estimating as error_estimate
from tests.verification.scenes import pendulum

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "scenes" / "towed_cable.yaml"
UNTIL = 10.0


def command(*arguments: str | Path, scene: Path = SCENE) -> Result:
    shown = ["convergence", scene, "--until", UNTIL, *arguments]
    return CliRunner().invoke(app, [str(item) for item in shown])


def by_hand(tolerance: float) -> dict[str, Any]:
    """Shapes, tensions and size of the towed cable at its outputs, at places of the test's own."""
    model = cm.CableModel(cm.load_scene(SCENE, [f"solver.tolerance={tolerance}"]))
    s = np.linspace(0.0, 30.0, 601)
    shapes, tensions, top, elements = [], [], [], []
    for time in 0.5 * np.arange(2 * UNTIL + 1):
        if time > 0.0:
            model.step_to(time)
        state = model.sample(s)
        shapes.append(state.position)
        tensions.append(state.tension)
        top.append(model.top_tension)
        elements.append(model.statistics["elements"])
    return {
        "position": np.array(shapes),
        "tension": np.array(tensions),
        "top_tension": np.array(top),
        "elements": max(elements),
        "steps": model.statistics["steps"],
    }


def test_the_table_has_the_differences_that_runs_by_hand_have() -> None:
    found = cm.convergence(cm.load_scene(SCENE), [1e-2, 1e-4], until=UNTIL)
    assert [row.tolerance for row in found.rows] == [1e-2, 1e-3, 1e-4]
    assert found.reference.tolerance == 2.5e-5
    finest = by_hand(2.5e-5)
    assert (found.reference.steps, found.reference.elements) == (
        finest["steps"], finest["elements"],
    )  # fmt: skip
    largest_tension = finest["tension"].max()
    for row in found.rows:
        run = by_hand(row.tolerance)
        assert (row.steps, row.elements) == (run["steps"], run["elements"])
        assert row.position is not None
        assert row.top_tension is not None
        assert row.tension is not None
        distance = np.linalg.norm(run["position"] - finest["position"], axis=2)
        output, place = np.unravel_index(np.argmax(distance), distance.shape)
        assert row.position.largest == pytest.approx(distance.max(), rel=1e-2)
        assert row.position.time == 0.5 * output
        assert row.position.arc_length == pytest.approx(30.0 * place / 600, abs=0.5)
        assert row.position_share == pytest.approx(distance.max() / (30 * row.tolerance), rel=1e-2)
        off = np.abs(run["top_tension"] - finest["top_tension"])
        assert row.top_tension.largest == off.max()
        along = np.abs(run["tension"] - finest["tension"])
        assert row.tension.largest == pytest.approx(along.max(), rel=5e-2)
        share = along.max() / (10 * row.tolerance * largest_tension)
        assert row.tension_share == pytest.approx(share, rel=5e-2)
        assert row.accuracy == pytest.approx(
            max(row.position_share, row.tension_share) * row.tolerance
        )
        assert 0.0 < row.processor_time < 0.1
    assert found.passed
    assert found.own.tolerance == 1e-3


def test_errors_are_those_from_the_exact_path_of_a_pendulum() -> None:
    scene, path = pendulum()
    found = cm.convergence(scene, [1e-3, 1e-4])

    def error(tolerance: float) -> float:
        data = scene.to_dict()
        data["solver"]["tolerance"] = tolerance
        tip = cm.simulate(cm.load_scene(data)).tip_position[1:, [0, 2]]
        return float(np.linalg.norm(tip - path, axis=1).max())

    of_reference = error(found.reference.tolerance)
    errors = [error(row.tolerance) for row in found.rows]
    for row, exact in zip(found.rows, errors, strict=True):
        assert row.position is not None
        assert row.position.arc_length == pytest.approx(1.0)
        # All that a reference can be wrong by is its own error.
        assert abs(row.position.largest - exact) < 1.01 * of_reference
    assert errors[0] > 2.0 * errors[1] > 4.0 * errors[2] > 8.0 * of_reference
    # Neither the fixed mesh nor the start out of equilibrium goes without a word.
    assert ["gives elements" in note or "Tensions" in note for note in found.notes] == [True, True]


def test_default_tolerances_are_around_the_scene_s_own() -> None:
    scene = cm.load_scene(SCENE)
    assert runs_of(scene) == [4e-3, 1e-3, 2.5e-4, 6.25e-5]
    assert runs_of(scene, [1e-3, 1e-2]) == [1e-2, 1e-3, 2.5e-4]
    coarse = cm.load_scene(SCENE, ["solver.tolerance=0.5"])
    assert runs_of(coarse) == [0.5, 0.125, 0.03125]


class Changed(cm.CableModel):
    """The engine, wrong from 4 s on by what ``pull`` [N] and ``shift`` [m] give for a tolerance."""

    pull: ClassVar[dict[float, float]] = {}
    shift: ClassVar[dict[float, float]] = {}

    def _late(self, table: dict[float, float]) -> float:
        return table.get(self.scene.solver.tolerance, 0.0) if self.time > 4.0 else 0.0

    @property
    def top_tension(self) -> float:
        return super().top_tension + self._late(self.pull)

    def sample(self, s: Any) -> Any:
        state = super().sample(s)
        state.position[:, 1] += self._late(self.shift)
        return state


@pytest.fixture
def changed(monkeypatch: pytest.MonkeyPatch) -> type[Changed]:
    monkeypatch.setattr("cablemodel.model.CableModel", Changed)
    monkeypatch.setattr(Changed, "pull", {})
    monkeypatch.setattr(Changed, "shift", {})
    return Changed


def test_a_wrong_tension_breaks_the_promise(changed: type[Changed]) -> None:
    changed.pull[1e-3] = 1.5  # of 10 * 1e-3 * 70.0 N
    result = command("--json")
    assert result.exit_code == 1
    report = json.loads(result.stdout)
    assert report["outcome"] == "broken"
    assert report["passed"] is False
    coarse, own, fine = report["rows"]
    assert (own["broken"], own["broken_at"]) == ("tensions", 4.5)
    assert own["top_tension"]["largest"] == pytest.approx(1.5, abs=0.1)
    assert own["tension_share"] == pytest.approx(1.5 / 0.7, rel=0.1)
    assert coarse["broken"] == fine["broken"] == ""
    assert "from t = 4.5 s on tensions are off by up to 2.1 times" in report["conclusion"]
    assert "0.00025 keeps the accuracy that was asked for" in report["conclusion"]


def test_what_two_of_the_finest_runs_dispute_is_unsettled(changed: type[Changed]) -> None:
    changed.shift.update({1e-3: 0.3, 2.5e-4: 0.1})  # of 0.03 m
    result = command("--json")
    assert result.exit_code == 1
    report = json.loads(result.stdout)
    assert report["outcome"] == "unsettled"
    assert report["unsettled"] == [4.0, 10.0]
    assert "does not converge from t = 4 s on" in report["conclusion"]
    assert "differ by up to 3.3 times what 0.001 allows" in report["conclusion"]
    assert "not keep" not in report["conclusion"]
    # The same error of the scene's own run, if the finer ones agree, is one.
    changed.shift.clear()
    changed.shift[1e-3] = 0.3
    report = json.loads(command("--json").stdout)
    assert report["outcome"] == "broken"
    assert report["rows"][1]["broken"] == "positions"


def test_tensions_are_judged_until_the_line_is_slack(
    changed: type[Changed], monkeypatch: pytest.MonkeyPatch
) -> None:
    changed.pull[1e-3] = 1.5
    monkeypatch.setattr(
        Changed, "tension_min", property(lambda model: -1.0 if model.time > 4.0 else 0.0)
    )
    report = json.loads(command("--json").stdout)
    assert report["outcome"] == "kept"
    assert "keeps the promise (of tensions until t = 4.5 s)" in report["conclusion"]
    assert "until t = 4.5 s only" in report["notes"][0]
    assert report["rows"][1]["tension_share"] > 2.0  # the table has them all


@pytest.fixture
def failing(monkeypatch: pytest.MonkeyPatch) -> set[float]:
    """Tolerances at which runs fail after 3 s."""
    tolerances: set[float] = set()

    class Failing(cm.CableModel):
        def step_to(self, time: float, *arguments: Any) -> None:
            if time > 3.0 and self.scene.solver.tolerance in tolerances:
                raise cm.StepError("no convergence", time=self.time, advice="try less")
            super().step_to(time, *arguments)

    monkeypatch.setattr("cablemodel.model.CableModel", Failing)
    return tolerances


def test_a_run_that_fails_is_a_row_that_says_so(failing: set[float]) -> None:
    failing.add(4e-3)
    result = command()
    assert result.exit_code == 0, result.output
    assert "0.004 failed: at t = 3 s: no convergence; try less" in result.stdout
    assert "keeps the promise" in result.stdout
    report = json.loads(command("--json").stdout)
    row = report["rows"][0]
    assert (row["error"], row["position"]) == ("at t = 3 s: no convergence; try less", None)
    assert report["rows"][1]["position"]["largest"] > 0.0


def test_another_reference_is_taken_if_the_finest_run_fails(failing: set[float]) -> None:
    failing.add(6.25e-5)
    found = cm.convergence(SCENE, until=UNTIL)
    assert found.reference.tolerance == 2.5e-4
    assert [row.tolerance for row in found.rows] == [4e-3, 1e-3, 6.25e-5]
    assert found.passed
    assert found.notes[0].startswith("The run at 6.25e-05 failed")


@pytest.mark.parametrize(
    ("tolerances", "words"),
    [
        ({1e-3}, "the run fails; it comes to its end at 0.004, 0.00025, 6.25e-05"),
        ({2.5e-4, 6.25e-5}, "nothing to be judged by"),
        ({4e-3, 2.5e-4, 6.25e-5}, "nothing to be judged by"),
    ],
)
def test_where_nothing_can_be_judged_the_status_is_1(
    failing: set[float], tolerances: set[float], words: str
) -> None:
    failing.update(tolerances)
    result = command("--json")
    assert result.exit_code == 1
    report = json.loads(result.stdout)
    assert report["outcome"] == "failed"
    assert words in report["conclusion"]


def test_if_all_runs_fail_so_does_the_command(failing: set[float]) -> None:
    failing.update(runs_of(cm.load_scene(SCENE)))
    result = command()
    assert result.exit_code == 1
    assert "no convergence" in result.stderr
    assert result.stdout == ""


def test_the_command_prints_a_table_of_80_columns_and_draws(tmp_path: Path) -> None:
    picture = tmp_path / "cost.png"
    result = command("--tolerances", "1e-2, 1e-4", "--plot", picture)
    assert result.exit_code == 0, result.output
    table = result.stdout.split("CPU: of the steps")[0]
    assert "…" not in table
    assert max(map(len, table.splitlines())) <= 80
    rows = [line.split() for line in table.splitlines() if line.lstrip()[:1].isdigit()]
    assert [row[0] for row in rows] == ["0.01", "0.001", "0.0001", "2.5e-05"]
    assert [len(row) for row in rows] == [11, 11, 11, 5]
    assert "At its tolerance of 0.001 the run keeps the promise" in result.stdout
    assert picture.read_bytes().startswith(b"\x89PNG")
    assert f"Picture: {picture}" in result.stdout.replace("\n", "")


def test_values_can_be_set() -> None:
    report = json.loads(command("--json", "--set", "solver.tolerance=2e-3").stdout)
    assert report["tolerance"] == 2e-3
    assert [row["tolerance"] for row in report["rows"]] == [8e-3, 2e-3, 5e-4]
    assert report["reference"]["tolerance"] == 1.25e-4
    assert report["reference"]["position"] is None


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--tolerances", "1e-3,2"], ["--tolerances", "'2' is out of range", "below 1"]),
        (["--tolerances", "0"], ["--tolerances", "'0' is out of range", "above 0"]),
        (["--tolerances", "1e-3,,1e-4"], ["--tolerances", "''", "a number above 0"]),
        (["--tolerances", "small"], ["--tolerances", "'small'", "a number above 0"]),
        (["--until", "-1"], ["--until"]),
        (["--plot", "cost.txt"], ["--plot", ".svg"]),
        (["--set", "solver={method: direct_integration}"],
         ["solver.method", "direct_integration has no tolerance", "finite_element"]),
        (["--set", "line.0.cable.lenght=1"], ["lenght"]),
    ],
)  # fmt: skip
def test_bad_input_names_the_option_and_what_is_allowed(
    arguments: list[str], words: list[str]
) -> None:
    result = command(*arguments)
    assert result.exit_code == 2, result.output
    text = " ".join(result.stderr.replace("│", " ").split())
    for word in words:
        assert word in text
    assert result.stdout == ""


def test_an_interruption_is_said(monkeypatch: pytest.MonkeyPatch) -> None:
    class Interrupted(cm.CableModel):
        def step_to(self, time: float, *arguments: Any) -> None:
            raise KeyboardInterrupt

    monkeypatch.setattr("cablemodel.model.CableModel", Interrupted)
    result = command()
    assert result.exit_code == 130
    assert "interrupted" in result.stderr
    assert result.stdout == ""


def test_commands_and_code_of_the_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    page = (ROOT / "docs" / "convergence.md").read_text(encoding="utf-8")
    shell, code = (
        re.findall(rf"```{name}\n(.*?)```", page, re.DOTALL) for name in ("sh", "python")
    )
    for line in "".join(shell).splitlines():
        result = CliRunner().invoke(app, shlex.split(line)[1:])
        assert result.exit_code == 0, (line, result.output)
    assert (tmp_path / "cost.png").exists()
    exec(compile(code[0], "docs/convergence.md", "exec"), {})


def test_its_runs_estimate_no_errors_of_their_own(monkeypatch: pytest.MonkeyPatch) -> None:
    """Processor time is that of the steps alone, whatever the scene asks of a run."""

    def refused(*_: Any, **__: Any) -> None:
        raise AssertionError("a second run beside it")

    monkeypatch.setattr(error_estimate, "EstimatingSolver", refused)
    scene = cm.load_scene(SCENE, ["solver.error_estimate=true"])
    found = cm.convergence(scene, [2e-3], until=2.0)
    assert [row.error for row in found.rows] == [""] * len(found.rows)
