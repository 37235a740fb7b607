"""What the README shows of scenes is what the code does."""

from __future__ import annotations

import json
import re
import shlex
import shutil
import tomllib
from pathlib import Path

import pytest
import yaml
from typer.testing import CliRunner

import cablemodel as cm
from benchmarks.random_scenes import overview
from benchmarks.sections import read_rows
from cablemodel.cli import app
from docs import write_version

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    found = re.findall(r"^```(\w*)\n(.*?)^```$", README, flags=re.DOTALL | re.MULTILINE)
    return [text for kind, text in found if kind == language]


def test_scene_of_the_readme_loads() -> None:
    (text,) = blocks("yaml")
    scene = cm.load_scene(text)
    assert scene.run.duration == 600
    assert scene.vessel.velocity is not None
    assert scene.vessel.velocity[1].t == 60
    assert scene.vessel.velocity[1].velocity[0] == pytest.approx(2 * 1852 / 3600)


def test_messages_of_the_readme_are_those_of_the_code() -> None:
    (text,) = blocks("yaml")
    for override in ("line.0.cable.lenght=1", "vessel.velocity.1.t=1 m"):
        data = cm.load_scene(text).to_dict()
        with pytest.raises(cm.SceneError) as caught:
            cm.load_scene(data, [override])
        assert f"\n{caught.value}\n" in README


def test_make_commands_of_the_readme_exist() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    for target in re.findall(r"^make ([a-z-]+)", README, flags=re.MULTILINE):
        assert re.search(rf"^{target}:", makefile, flags=re.MULTILINE)


def table_rows(text: str) -> list[list[str]]:
    lines = (line for line in text.splitlines() if line.startswith("|"))
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def test_speeds_of_the_readme_are_those_measured_last() -> None:
    """Beside the best of MoorDyn's settings."""
    measured = read_rows(ROOT / "docs" / "benchmarks" / "ratios.csv")
    rows = [(row, re.search(r"\((\w+)\)$", row[0])) for row in table_rows(README)]
    compared = {scene[1]: row for row, scene in rows if scene and len(row) == 5}

    def best_of(scene: str) -> dict[str, str]:
        """MoorDyn at its best at the smaller error."""
        peer = [r for r in measured if r["scene"] == scene and r["peer"].startswith("MoorDyn")]
        finest = min(float(row["tip error / L"]) for row in peer)
        same = [row for row in peer if float(row["tip error / L"]) == finest]
        return min(same, key=lambda row: float(row["peer [s/s]"]))

    ratios = {scene: float(best_of(scene)["ratio"]) for scene in {r["scene"] for r in measured}}
    largest, smallest = max(ratios, key=ratios.__getitem__), min(ratios, key=ratios.__getitem__)
    assert list(compared) == [largest, "JW", smallest]
    for scene, (_, error, ours, theirs, ratio) in compared.items():
        best = best_of(scene)
        assert error == f"{best['tip error / L']} L"
        assert [f"{best['cablemodel [s/s]']} s", f"{best['peer [s/s]']} s"] == [ours, theirs]
        two_digits = float(f"{float(best['ratio']):.2g}")
        assert f"{two_digits:,.0f}" == ratio


def test_what_the_promise_is_worth_is_counted_from_what_is_stored() -> None:
    assert overview.promise(ROOT / "docs" / "stress") in README


def test_it_is_read_in_a_minute() -> None:
    assert len(README.split()) <= 700


def test_the_first_minute_is_as_it_says(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    seen: list[str] = []
    monkeypatch.setattr("webbrowser.open", lambda address: bool(seen.append(address)) or True)
    (lines,) = (block for block in blocks("") if block.startswith("cablemodel new"))
    for line in lines.splitlines():
        name, *arguments = shlex.split(line, comments=True)
        assert name == "cablemodel"
        done = CliRunner().invoke(app, arguments)
        assert done.exit_code == 0, done.output
    assert seen == [(tmp_path / "tow.html").as_uri()]


def test_editors_find_the_schema_that_the_readme_writes() -> None:
    (lines,) = (block for block in blocks("") if block.startswith("cablemodel schema"))
    command, modeline = lines.splitlines()
    name, argument, _, target = command.split()
    assert name == "cablemodel"
    assert json.loads(CliRunner().invoke(app, [argument]).stdout)["properties"]["line"]
    assert modeline == f"# yaml-language-server: $schema={target}"


def test_a_release_writes_its_version_wherever_one_stands(tmp_path: Path) -> None:
    assert (
        len({version for found in write_version.versions(ROOT).values() for version in found}) == 1
    )
    for name in (*write_version.PLACES, "CHANGELOG.md"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    write_version.write(tmp_path, "12.3.4")
    assert set(map(tuple, write_version.versions(tmp_path).values())) == {("12.3.4",)}
    for name in write_version.PLACES:
        before, after = ((root / name).read_text().splitlines() for root in (ROOT, tmp_path))
        assert sum(a != b for a, b in zip(before, after, strict=True)) == 1
    changes = (tmp_path / "CHANGELOG.md").read_text(encoding="utf-8")
    assert re.search(
        r"^## Unreleased\n\n## 12\.3\.4 - \d{4}-\d\d-\d\d\n\n### ", changes, re.MULTILINE
    )
    with pytest.raises(SystemExit, match="three numbers"):
        write_version.write(tmp_path, "1.0")


def test_what_is_cited_is_what_is_installed() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    cited = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    assert cited["version"] == project["version"]
    assert cited["license"] == project["license"]["text"]
    assert cited["keywords"] == project["keywords"]
    assert {"cff-version", "message", "title", "authors"} <= set(cited)
