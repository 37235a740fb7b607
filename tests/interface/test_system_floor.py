"""What lines of a system do on the sea floor, in logs, tables, pictures and on topics."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_log_file import decoded
from test_report import data_of, figures_of, made
from typer.testing import CliRunner

import cablemodel as cm
from cablemodel.cli import app
from cablemodel.results.replay import replay
from cablemodel.results.run import SystemRun
from cablemodel.variables import LINE_FLOOR
from cablemodel.views.drawing import Shapes, touchdown_of

SCENE: dict[str, Any] = {
    "environment": {"floor": {"z": -20.0}},
    "cable_types": {"wire": {"diameter": 0.01, "mass": 0.5, "axial_stiffness": 1e6}},
    "vessels": {
        "ship": {
            "points": {"eye": [0, 0, 0]},
            "velocity": [{"t": 0, "velocity": [0, 0, 0]}, {"t": 1, "velocity": [-1, 0, 0]}],
        }
    },
    "lines": {
        "leg": {
            "from": {"anchor": [70, 0, -20]},
            "to": "ship.eye",
            "items": [{"cable": {"type": "wire", "length": 80}}],
        },
        "tail": {
            "from": "ship.eye",
            "to": "free",
            "items": [{"cable": {"type": "wire", "length": 10}}],
        },
    },
    "run": {"duration": 3.0, "output_interval": 0.5},
}


def xyz(vector: Any) -> list[float]:
    return [vector.x, vector.y, vector.z]


def invoke(*arguments: Any) -> str:
    result = CliRunner().invoke(app, [*map(str, arguments)])
    assert result.exit_code == 0, result.output
    return result.stdout


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("floor") / "run.mcap"
    cm.simulate(cm.load_system(SCENE), log=path)
    return path


@pytest.fixture
def run(log: Path) -> SystemRun:
    opened = cm.open_run(log)
    assert isinstance(opened, SystemRun)
    return opened


def test_a_log_holds_what_the_model_gives(run: SystemRun) -> None:
    model = cm.SystemModel(cm.load_system(SCENE))
    for k, time in enumerate(run.time):
        if k:
            model.step_to(float(time))
        outputs = model.outputs()
        for name in model.lines:
            for row in LINE_FLOOR:
                key = row.python.replace("NAME", name)
                np.testing.assert_array_equal(run[key][k], outputs[key], err_msg=key)
    assert run["leg.floor_length"][-1] < run["leg.floor_length"][0] - 1.0
    assert np.isnan(run["tail.touchdown_position"]).all()


def test_messages_hold_the_numbers_of_the_run(log: Path, run: SystemRun) -> None:
    point, force = decoded(log, "/cable/leg/touchdown"), decoded(log, "/cable/leg/floor_force")
    length = decoded(log, "/cable/leg/floor_length")
    assert xyz(point[-1].point) == run["leg.touchdown_position"][-1].tolist()
    assert xyz(force[-1].wrench.force) == run["leg.floor_force"][-1].tolist()
    assert [message.data for message in length] == run["leg.floor_length"].tolist()


def test_replay_and_tables_have_it(log: Path, run: SystemRun, tmp_path: Path) -> None:
    assert replay(run).exact
    invoke("export", log, "-o", tmp_path / "out.csv")
    with (tmp_path / "out.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [float(row["leg.floor_length [m]"]) for row in rows] == run["leg.floor_length"].tolist()
    assert {row["tail.touchdown_position.x [m]"] for row in rows} == {""}
    data = cm.open_run(log).to_xarray()
    assert np.array_equal(data["leg_touchdown_position"].values, run["leg.touchdown_position"])
    assert "leg.floor_length" in invoke("stats", log)


def test_pictures_and_the_report_show_it(log: Path, run: SystemRun) -> None:
    shapes = Shapes.of(run)
    marks = touchdown_of(run, shapes)
    assert np.array_equal(marks.places[:, 0], run["leg.touchdown_position"])
    page = made(log)
    figure = figures_of(data_of(page), "leg")["touchdown"]
    assert [curve["name"] for curve in figure["data"]] == ["leg"]
    assert np.array_equal(figure["data"][0]["y"], run["leg.floor_length"])
    assert "length of leg on the floor" in page.read_text(encoding="utf-8")


def test_check_tells_what_lies(tmp_path: Path, run: SystemRun) -> None:
    scene = tmp_path / "scene.yaml"
    scene.write_text(cm.load_system(SCENE).to_yaml())
    lies = f"{run['leg.floor_length'][0]:.5g} m on the floor"
    leg, tail = (line for line in invoke("check", scene).splitlines() if "at its beginning" in line)
    assert leg.startswith("leg: ")
    assert leg.endswith(lies)
    assert "floor" not in tail
