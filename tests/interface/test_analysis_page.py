"""What docs/analysis.md shows is what the code does."""

import re
import shlex
from pathlib import Path

import pytest
from typer.testing import CliRunner

import cablemodel as cm
from cablemodel.cli import app

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "analysis.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", PAGE, flags=re.DOTALL)


def test_commands_and_code_of_the_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    for line in "".join(blocks("sh")).splitlines():
        program, *arguments = shlex.split(line)
        assert program == "cablemodel"
        result = CliRunner().invoke(app, arguments)
        assert result.exit_code == 0, (line, result.output)
    assert {path.name for path in tmp_path.iterdir()} >= {"tow.nc", "tow.csv", "states.parquet"}
    (code,) = blocks("python")
    exec(compile(code, "docs/analysis.md", "exec"), {})
    first = capsys.readouterr().out.splitlines()[0]
    mean, low, high = (float(value) for value in re.findall(r"\d+\.\d+", first))
    run = cm.open_run("tow.mcap")
    late = run.top_tension[run.time > 100.0]
    assert low <= mean <= high
    assert (low, high) == pytest.approx((late.min(), late.max()), abs=0.01)
    assert mean == pytest.approx(94.6, abs=0.1)  # the steady tow in closed form: 94.61 N
