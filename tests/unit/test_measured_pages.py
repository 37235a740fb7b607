"""Tables of measurements in the pages are those of the data files beside them."""

import json
from pathlib import Path
from typing import Any

import pytest

from benchmarks import direct, report, robustness, skips, soak, stress_scenes
from benchmarks.random_scenes import estimate, heave, moordyn, overview
from benchmarks.random_scenes.judge import Verdict
from benchmarks.random_scenes.report import CONVERGED, converged_table
from benchmarks.scaling import ScalingPoint
from benchmarks.sections import read_rows, write_part
from benchmarks.startup import StartUp

ROOT = Path(__file__).parents[2]
STRESS, BENCHMARKS = ROOT / "docs" / "stress.md", ROOT / "docs" / "benchmarks.md"


@pytest.fixture(autouse=True)
def in_the_root(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)


def stored(store: Path) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = json.loads(store.read_text(encoding="utf-8"))
    return rows


def part(page: Path, name: str) -> str:
    """What stands between the marks."""
    text = page.read_text(encoding="utf-8").split(f"<!-- {name}: generated -->")
    assert len(text) == 2
    return text[1].split("<!-- end -->")[0].strip()


def test_stress() -> None:
    folder = ROOT / "docs" / "stress"
    soaks = [soak.Soak(**{**r, "kind": soak.Kind(**r["kind"])}) for r in stored(soak.STORE)]
    ours = {row["seed"]: row["outcome"] for row in stored(folder / "random_scenes.json")}
    converged = [Verdict(**row) for row in stored(folder / CONVERGED.file(".json"))]
    expected = {
        "random scenes": overview.summary(folder),
        "estimates": estimate.summary([estimate.Row(**row) for row in stored(estimate.STORE)]),
        "converged": converged_table(converged),
        "heave": heave.summary([heave.Row(**row) for row in stored(heave.STORE)]),
        "moordyn": moordyn.summary([moordyn.Row(**row) for row in stored(moordyn.STORE)], ours),
        "robustness": robustness.summary(read_rows(robustness.STORE)),
        "hard scenes": stress_scenes.summary(read_rows(stress_scenes.STORE)),
        "soaks": soak.summary(soaks),
    }
    for name, text in expected.items():
        assert part(STRESS, name) == text.strip(), name


def test_benchmarks() -> None:
    folder = ROOT / "docs" / "benchmarks"
    results = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    second = read_rows(folder / report.SECOND)
    expected = {
        "ratios": report.ratio_table(read_rows(folder / "ratios.csv"), second),
        "scaling": report.scaling_table([ScalingPoint(**p) for p in results["scaling"]]),
        "start-up": report.start_up_table(StartUp(**results["startup"])),
        "skips": skips.summary(read_rows(skips.STORE)),
        "method of 1998": direct.summary(),
    }
    for name, text in expected.items():
        assert part(BENCHMARKS, name) == text.strip(), name


def test_ratios_are_those_of_the_measurements() -> None:
    from benchmarks.measure import Measurement
    from benchmarks.scenes import SCENES

    folder = ROOT / "docs" / "benchmarks"
    results = json.loads((folder / "results.json").read_text(encoding="utf-8"))
    measured = [Measurement(**m) for m in results["measurements"]]
    rows = report.ratio_rows(list(SCENES.values()), measured)
    assert [list(row) for row in rows] == [
        list(row.values()) for row in read_rows(folder / "ratios.csv")
    ]


def test_a_part_is_written_between_its_marks_alone(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "before\n<!-- x: generated -->\nold\n<!-- end -->\n<!-- y: generated -->\n<!-- end -->\n"
    )
    write_part(page, "x", "new \\1")
    text = page.read_text()
    assert text == (
        "before\n<!-- x: generated -->\n\nnew \\1\n\n<!-- end -->\n"
        "<!-- y: generated -->\n<!-- end -->\n"
    )
    with pytest.raises(ValueError, match=r"page.md: 0 parts marked 'z'; allowed: one"):
        write_part(page, "z", "")
