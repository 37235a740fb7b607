"""What the README shows of scenes is what the code does."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import cablemodel as cm
from benchmarks.random_scenes import overview
from benchmarks.sections import read_rows

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", README, flags=re.DOTALL)


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
    lines = (line for line in text.splitlines() if line.startswith("| "))
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def test_speeds_of_the_readme_are_those_measured_last() -> None:
    """Beside the best of MoorDyn's settings."""
    measured = read_rows(ROOT / "docs" / "benchmarks" / "ratios.csv")
    rows = [(row, re.search(r"\((\w+)\)$", row[0])) for row in table_rows(README)]
    compared = {scene[1]: row for row, scene in rows if scene and len(row) == 5}
    assert set(compared) == {"S1", "S4", "S2w", "S2a", "J", "JW"}
    for scene, (_, error, ours, theirs, ratio) in compared.items():
        same = [
            row
            for row in measured
            if row["scene"] == scene
            and row["peer"].startswith("MoorDyn")
            and f"{row['tip error / L']} L" == error
        ]
        best = min(same, key=lambda row: float(row["peer [s/s]"]))
        assert [f"{best['cablemodel [s/s]']} s", f"{best['peer [s/s]']} s"] == [ours, theirs]
        two_digits = float(f"{float(best['ratio']):.2g}")
        assert f"{two_digits:,.0f}" == ratio


def test_what_the_promise_is_worth_is_counted_from_what_is_stored() -> None:
    assert overview.promise(ROOT / "docs" / "stress") in README
