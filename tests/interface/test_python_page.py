"""What docs/python.md shows is what the code does, and its example program too."""

import re
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cablemodel as cm
from cablemodel.replay import replay

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")


def test_the_code_of_the_page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "scenes").symlink_to(ROOT / "scenes")
    names: dict[str, Any] = {}
    for block in re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL):
        exec(compile(block, "docs/python.md", "exec"), names)
    run = names["run"]
    assert replay(run).exact
    assert run.time[-1] == 60.0
    # The controller brings the depressor up, faster towing too; the model was left where it was.
    assert run["bodies.position"][-1, 0, 2] > run["bodies.position"][0, 0, 2] + 5.0
    assert names["depths"][1.6] > names["depths"][2.0] > names["depths"][2.4]
    assert names["model"].time == pytest.approx(60.1)
    assert names["depth"] == pytest.approx(124.2, abs=0.1)
    assert names["layback"] == pytest.approx(268.7, abs=0.5)


def test_the_example_controls_the_depth(tmp_path: Path) -> None:
    example = runpy.run_path(str(ROOT / "examples" / "depth_control.py"))
    runs = example["main"](tmp_path, 12.0)
    depths = {name: -run["bodies.position"][:, -1, 2] for name, run in runs.items()}
    # Reeling in at 0.5 m/s for 12 s brings up 6 m of cable at most; the tow is not that steep.
    assert 2.0 < depths["proportional"][0] - depths["proportional"][-1] < 6.0
    assert depths["predictive"][-1] < depths["proportional"][-1]
    for name in runs:
        assert np.array_equal(cm.open_run(tmp_path / f"{name}.mcap").time, runs[name].time)
