"""What docs/python.md shows is what the code does, and its example program too."""

import json
import re
import runpy
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cablemodel as cm
from cablemodel.model import Snapshot
from cablemodel.results.replay import replay

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
    assert names["higher"] == pytest.approx(70.0, abs=0.5)
    assert names["system"].A.shape[0] == len(names["slow"].states)
    assert names["free"][-1, names["height"]] == pytest.approx(-124.2, abs=0.1)
    assert names["drag"] > 0.0  # a body that resists more rises


def test_a_change_of_speed_in_a_short_step_is_a_blow() -> None:
    """The numbers of the page."""
    model = cm.CableModel(cm.load_scene(ROOT / "scenes" / "depressor_tow.yaml"))
    faster = np.add(model.vessel_velocity, (0.5, 0.0, 0.0))
    start = model.snapshot()
    assert model.top_tension == pytest.approx(1.88e3, rel=0.01)
    for step, tension in ((1e-6, 922e3), (1e-4, 11e3), (1.0, 2.2e3)):
        model.restore(start)
        model.step(step, vessel_velocity=faster)
        assert model.top_tension == pytest.approx(tension, rel=0.01)


def test_models_in_threads_do_not_disturb_each_other() -> None:
    scene = cm.load_scene(ROOT / "scenes" / "depressor_tow.yaml")
    start = cm.CableModel(scene).snapshot()

    def tow(speed: float) -> Snapshot:
        model = cm.CableModel(scene)
        model.restore(start)
        for _ in range(50):
            model.step(0.1, vessel_velocity=(speed, 0.0, 0.0))
        return model.snapshot()

    speeds = [1.6, 2.0, 2.4, 2.8]
    with ThreadPoolExecutor(4) as threads:
        together = list(threads.map(tow, speeds))
    assert together == [tow(speed) for speed in speeds]


def test_the_example_controls_the_depth(tmp_path: Path) -> None:
    example = runpy.run_path(str(ROOT / "examples" / "depth_control.py"))
    runs = example["main"](tmp_path, 12.0)
    depths = {name: -run["bodies.position"][:, -1, 2] for name, run in runs.items()}
    # Reeling in at 0.5 m/s for 12 s brings up 6 m of cable at most; the tow is not that steep.
    assert 2.0 < depths["proportional"][0] - depths["proportional"][-1] < 6.0
    assert depths["predictive"][-1] < depths["proportional"][-1]
    for name in runs:
        assert np.array_equal(cm.open_run(tmp_path / f"{name}.mcap").time, runs[name].time)


def test_the_example_holds_depth_and_tension_through_a_turn() -> None:
    """The first quarter of the turn: the body left alone has begun to sink. In a process of its
    own, with as many threads as the example chooses."""
    program = """
import json, runpy, sys
example = runpy.run_path(sys.argv[1])
turns = [example["turn"](150.0, controlled=controlled).rows for controlled in (False, True)]
print(json.dumps([turns, example["FASTEST"], example["FASTEST_WINCH"]]))
"""
    command = [sys.executable, "-c", program, str(ROOT / "examples" / "mpc_turn.py")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    turns, fastest, fastest_winch = json.loads(done.stdout)
    alone, controlled = (np.array(rows) for rows in turns)
    off, held = (np.abs(rows[:, 1:3] - rows[0, 1:3]).max(axis=0) for rows in (alone, controlled))
    assert off[0] > 20.0
    assert held[0] < 0.1 * off[0]
    assert held[1] < off[1]
    assert np.all(controlled[:, 3] <= fastest + 1e-9)
    assert np.all(np.abs(controlled[:, 4]) <= fastest_winch + 1e-9)
