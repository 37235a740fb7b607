"""Every golden log replays: to the last bit on the engine and machine that made it, and within the
tolerance of its scene otherwise. See cases.py for what each is there for."""

import importlib.util
import json
import sys
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

import cablemodel as cm
from cablemodel.cli import app
from cablemodel.results.log.reader import LogFile
from cablemodel.results.replay import replay

HERE = Path(__file__).parent


def module(name: str) -> Any:
    """A module of this folder, by its path: tests are not a package."""
    spec = importlib.util.spec_from_file_location(name, HERE / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    sys.modules[name] = found
    spec.loader.exec_module(found)
    return found


golden = module("cases")
CASES = golden.CASES


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_golden_log_replays(case: Any) -> None:
    run = cm.open_run(case.path)
    result = replay(run)
    worst = [
        f"{item.name} {item.largest:.3g} at {item.time:g} s, allowed {item.allowed:.3g} {item.unit}"
        for item in sorted(result.differences, key=lambda item: -item.share)[:5]
    ]
    assert result.failure == ""
    assert result.samples == len(run.time) >= 25
    assert result.passed, (
        f"{case.name} has changed: {worst}; if it was meant to, `make golden` makes it anew"
    )
    assert result.exact or not result.expected_exact


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_golden_log_is_small_and_complete(case: Any) -> None:
    assert case.path.stat().st_size <= golden.LARGEST
    assert len(case.reason) > 40
    run = cm.open_run(case.path)
    assert run.complete
    assert run.metadata["engine"]


def test_there_is_a_case_for_every_golden_log() -> None:
    assert {path.name for path in golden.FOLDER.glob("*.mcap")} == {c.path.name for c in CASES}


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_case_makes_the_same_log_twice(case: Any, tmp_path: Path) -> None:
    """Byte by byte: no clock, no order of a set, nothing random is in it."""
    one, other = case.make(tmp_path / "one.mcap"), case.make(tmp_path / "other.mcap")
    assert one.read_bytes() == other.read_bytes()


def test_cases_are_what_they_say(tmp_path: Path) -> None:
    runs = {case.name: cm.open_run(case.make(tmp_path / case.path.name)) for case in CASES}
    steered = runs["turn_steered"]
    steps = steered.applied_inputs["step"]
    assert steps.min() < 2e-3
    assert steps.max() > 0.8
    assert 0 < steered.applied_inputs["vessel_position_given"].sum() < len(steps)
    assert abs(steered.tip_position[:, 1]).max() > 1.0
    bodies = runs["pay_out_and_reel_in"]["bodies.position"]
    out = (~(bodies[:, :, 0] != bodies[:, :, 0])).sum(axis=1)
    assert (out.min(), out.max(), out[-1]) == (1, 3, 2)
    release = runs["release_from_zero_tension"]
    assert abs(release.states.tension[0]).max() < 1e-9  # round-off of positions times EA
    assert not LogFile(runs["tow"]._source.log.path).cut


def test_a_changed_engine_is_compared_within_the_tolerance(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What a golden log does on another machine or a later engine."""
    path = CASES[0].make(tmp_path / "run.mcap")
    monkeypatch.setattr("cablemodel.results.log.provenance.engine_hash", lambda: "another")
    result = replay(cm.open_run(path))
    assert result.changed["engine"][1] == "another"
    assert not result.expected_exact
    assert result.tolerance == cm.open_run(path).scene.solver.tolerance > 0.0
    assert result.passed


def test_the_command_replays_a_golden_log() -> None:
    result = CliRunner().invoke(app, ["replay", str(CASES[0].path), "--json"])
    report = json.loads(result.stdout)
    assert result.exit_code == 0
    assert report["passed"]
    assert report["samples"] == 25


def test_only_what_has_changed_is_made_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    make_golden = module("make_golden")
    monkeypatch.setattr(make_golden, "FOLDER", tmp_path)
    monkeypatch.setattr(sys.modules["cases"], "FOLDER", tmp_path)
    monkeypatch.setattr(golden, "FOLDER", tmp_path)
    name = CASES[0].name
    assert make_golden.main([name]) == 0
    first = CASES[0].path.read_bytes()
    assert make_golden.main([name]) == 0
    assert CASES[0].path.read_bytes() == first
    (tmp_path / "stray.mcap").write_bytes(b"")
    other = CASES[1].make(CASES[0].path)
    assert make_golden.main([name]) == 0
    assert other.read_bytes() != b""
    said = capsys.readouterr().out
    assert "as it was" in said
    assert "stray.mcap: no case, removed" in said
    assert "changed by up to" in said
    assert make_golden.main(["nothing"]) == 2
