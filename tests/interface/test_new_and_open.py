"""A first scene from a template, and a run shown in the browser."""

from __future__ import annotations

import inspect
import json
import os
import pty
import subprocess
import sys
import typing
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import yaml
from typer.testing import CliRunner, Result

import cablemodel as cm
from cablemodel.cli import app
from cablemodel.cli.new import TEMPLATES, new

NAMES = sorted(path.stem for path in TEMPLATES.glob("*.yaml"))


def invoke(*arguments: str | Path) -> Result:
    """On a screen so wide that no folder of a test breaks a message."""
    return CliRunner(env={"COLUMNS": "300"}).invoke(app, [str(item) for item in arguments])


def test_every_template_has_its_option() -> None:
    hints = typing.get_type_hints(new)
    flags = [key for key in inspect.signature(new).parameters if hints[key] is bool]
    assert sorted(flags) == sorted([*NAMES, "force"])


@pytest.mark.parametrize("name", NAMES)
def test_a_new_scene_is_complete_and_passes_the_check(name: str, tmp_path: Path) -> None:
    target = tmp_path / "my scene.yaml"
    written = invoke("new", target, f"--{name}")
    assert written.exit_code == 0, written.output
    assert f"cablemodel check '{target}'" in written.stdout
    text = target.read_text(encoding="utf-8")
    assert text == (TEMPLATES / f"{name}.yaml").read_text(encoding="utf-8")
    # To be changed: units and places are told, and nothing that matters is left to a default.
    given = yaml.safe_load(text)
    sections = {"title", "environment", "cable_types", "solver", "run"}
    sections |= {"lines", "vessels", "bodies"} if name == "system" else {"line", "vessel"}
    assert sections <= set(given)
    assert set(given["run"]) == {"duration", "output_interval"}
    for vessel in given.get("vessels", {"": given.get("vessel")}).values():
        assert "position" in vessel
    assert text.startswith("# ")
    assert text.count("  # ") > 10
    checked = invoke("check", target, "--json")
    assert checked.exit_code == 0, checked.output
    assert json.loads(checked.stdout)["warnings"] == []


def tow(run: cm.Run) -> bool:
    """A body of a weight goes up, and the tension with the speed."""
    tip = run["tip_position"][:, 2]
    return bool(tip[-1] > tip[0] + 10.0 and run.top_tension[-1] > 1.1 * run.top_tension[0])


def turn(run: cm.Run) -> bool:
    """What is steady before and after the turn is the same."""
    tension = run.top_tension
    back = abs(tension[-1] / tension[0] - 1.0) < 1e-2
    return bool(back and tension.min() < 0.9 * tension[0])


def lay(run: cm.Run) -> bool:
    """Tension is highest, and the touchdown farthest behind, at the end of the slow winch."""
    behind = run.time - run["touchdown_position"][:, 0]
    moments = run.time[[run.top_tension.argmax(), behind.argmax()]]
    return bool(np.all(np.abs(moments - 930.0) < 60.0))


def recover(run: cm.Run) -> bool:
    """All is off the floor in the end, and hangs by its weight and its drag upwards."""
    wire = cm.load_scene(TEMPLATES / "recover.yaml").cable_types["wire"]
    out = run["line_length"][-1]
    area = 0.15 + wire.drag_tangential * np.pi * wire.diameter * out
    weight = 250.0 + out * (wire.submerged_weight or 0.0)
    expected = weight + 0.5 * 1025.0 * area * 0.5**2
    lifted = run["floor_length"][0] > 0.0 and run["floor_length"][-1] == 0.0
    return bool(lifted and abs(run.top_tension[-1] / expected - 1.0) < 0.01)


def lower(run: cm.Run) -> bool:
    """The tension grows by the weight of what was paid out, and the load stays off the floor."""
    scene = cm.load_scene(TEMPLATES / "lower.yaml")
    paid = 0.5 * (10.0 + 460.0 + 10.0)
    weight = paid * (scene.cable_types["wire"].submerged_weight or 0.0)
    grown = run.top_tension[-1] - run.top_tension[0]
    return bool(abs(grown / weight - 1.0) < 0.02 and run["tip_position"][:, 2].min() > -300.0)


def mooring(run: cm.Run) -> bool:
    """Chain is lifted; each metre of drift costs more than the one before."""
    tension = run.top_tension
    first, second = (tension[round(t)] for t in (60, 110))
    stiffer = (second - first) / 50.0 > (first - tension[20]) / 40.0
    return bool(stiffer and run["floor_length"][-1] < run["floor_length"][0])


def jumper(run: cm.Run) -> bool:
    """The tension swings about that of calm water."""
    tension = run.top_tension
    calm = tension[0]
    return bool(abs(tension.mean() / calm - 1.0) < 0.01 and tension.min() < calm < tension.max())


def system(run: cm.Run) -> bool:
    """The wing holds the depressor down, in the turn as before; nothing breaks."""
    depth = run["depressor.position"][:, 2]
    dives = depth.max() < -40.0 and np.isnan(run["weak_link.time"]).all()
    return bool(dives and abs(run["plate.attitude"][-1, 2]) > 0.3)


@pytest.mark.parametrize("told", [tow, turn, lay, recover, lower, mooring, jumper, system])
def test_what_a_template_tells_comes_true(told: Callable[[cm.Run], bool], tmp_path: Path) -> None:
    run = cm.simulate(TEMPLATES / f"{told.__name__}.yaml", log=tmp_path / "run.mcap")
    assert run.complete
    assert told(run)


def test_a_file_is_overwritten_only_by_force(tmp_path: Path) -> None:
    target = tmp_path / "scene.yaml"
    target.write_text("mine")
    refused = invoke("new", target, "--tow")
    assert refused.exit_code == 2
    assert f"{target} exists; --force overwrites it" in refused.stderr
    assert target.read_text() == "mine"
    assert invoke("new", target, "--tow", "--force").exit_code == 0
    assert target.read_text() == (TEMPLATES / "tow.yaml").read_text()


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["scene.yaml"], "which scene? One of --tow, "),  # and nobody to ask
        (["scene.yaml", "--lay", "--tow"], "one template a scene, not also --tow"),
        (["scene.txt", "--tow"], "scene.txt must end in .yaml or .yml"),
        (["no/such/scene.yaml", "--tow"], "there is no folder no/such"),
    ],
)
def test_what_new_refuses(
    arguments: list[str], words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    refused = invoke("new", *arguments)
    assert refused.exit_code == 2
    assert words in refused.stderr
    assert not list(tmp_path.iterdir())


def at_a_terminal(answers: str, folder: Path) -> tuple[str, int]:
    """What `cablemodel new` asks there, and its exit status."""
    leader, follower = pty.openpty()
    os.write(leader, answers.encode())
    done = subprocess.run(
        [sys.executable, "-m", "cablemodel", "new", "scene.yaml"],
        stdin=follower, capture_output=True, text=True, cwd=folder,
        env={**os.environ, "PYTHONPATH": str(TEMPLATES.parents[1])},
    )  # fmt: skip
    os.close(follower)
    os.close(leader)
    return done.stderr, done.returncode


@pytest.mark.parametrize("answer", ["lay", "{number}", "nonsense\nlay"])
def test_at_a_terminal_it_asks(answer: str, tmp_path: Path) -> None:
    flags = [key for key in inspect.signature(new).parameters if key in NAMES]
    number = flags.index("lay") + 1
    asked, status = at_a_terminal(answer.format(number=number) + "\n", tmp_path)
    assert status == 0, asked
    assert all(name in asked for name in NAMES)
    assert ("'nonsense' is none of tow, " in asked) == answer.startswith("nonsense")
    assert (tmp_path / "scene.yaml").read_text() == (TEMPLATES / "lay.yaml").read_text()


def test_no_answer_is_an_interruption(tmp_path: Path) -> None:
    asked, status = at_a_terminal("\x04", tmp_path)
    assert status == 130
    assert "cablemodel: interrupted" in asked
    assert not list(tmp_path.iterdir())


@pytest.fixture
def log(tmp_path: Path) -> Path:
    path = tmp_path / "my run.mcap"
    cm.simulate(TEMPLATES / "tow.yaml", log=path, until=5.0)
    return path


def opened(log: Path, browser: str, **more: str) -> subprocess.CompletedProcess[str]:
    known = ("PATH", "HOME", "LD_LIBRARY_PATH", "XDG_CACHE_HOME", "CABLEMODEL_CACHE_DIR")
    plain = {key: value for key, value in os.environ.items() if key in known}
    return subprocess.run(
        [sys.executable, "-m", "cablemodel", "open", str(log)],
        capture_output=True, text=True, cwd=TEMPLATES.parents[1],
        env={**plain, "BROWSER": browser, **more},
    )  # fmt: skip


def test_open_shows_the_report_in_the_browser(log: Path, tmp_path: Path) -> None:
    browser = tmp_path / "browser"
    browser.write_text('#!/bin/sh\nprintf %s "$1" > "$(dirname "$0")/seen"\n')
    browser.chmod(0o755)
    done = opened(log, str(browser) + " %s")
    assert (done.returncode, done.stderr) == (0, "")
    report = log.with_suffix(".html")
    assert done.stdout == f"Report: {report}\n"
    assert (tmp_path / "seen").read_text() == report.as_uri()
    assert "A body under tow" in report.read_text(encoding="utf-8")


def test_without_a_browser_the_reports_place_is_told(log: Path, tmp_path: Path) -> None:
    # Nothing on the path, so none that this machine may have.
    done = opened(log, "", PATH=str(tmp_path))
    assert done.returncode == 0
    assert done.stdout == f"Report: {log.with_suffix('.html')}\n"
    assert "no browser is found here" in done.stderr


def test_where_nothing_can_be_written_beside_the_log_it_goes_elsewhere(
    log: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(elsewhere))
    monkeypatch.setattr("webbrowser.open", lambda address: True)
    # Root may write everywhere.
    monkeypatch.setattr("os.access", lambda path, mode: Path(path) != log.parent)
    done = invoke("open", log)
    assert done.exit_code == 0, done.output
    (report,) = elsewhere.rglob("*.html")
    assert done.stdout == f"Report: {report}\n"
    assert not log.with_suffix(".html").exists()
