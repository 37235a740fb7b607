"""Sweeps: every combination is run, failures are rows, what has ended survives an interruption."""

import math
import re
import subprocess
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from signal import SIGINT
from typing import Any

import pandas
import pytest
import xarray
from distributed import Client, LocalCluster
from matplotlib.figure import Figure
from typer.testing import CliRunner, Result

import cablemodel as cm
from cablemodel.analysis.sweep import (
    RESULTS,
    Axis,
    _collect,
    read_table,
    swept_columns,
    write_table,
)
from cablemodel.cli import app
from cablemodel.views.sweep_plot import save_sweep_figure

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "scenes" / "towed_cable.yaml"
DIAMETER, LENGTH = "cable_types.K.diameter", "line.0.cable.length"


def command(*arguments: str | Path) -> Result:
    return CliRunner().invoke(app, ["sweep", *map(str, arguments)])


@pytest.mark.parametrize(
    ("text", "axis"),
    [
        ("a.b=0.01:0.03:3", Axis("a.b", (0.01, 0.02, 0.03))),
        ("a=10 mm:30 mm:3", Axis("a", (10.0, 20.0, 30.0), "mm")),
        ("a=-1e3 N/m2 : 1e3 N/m2 : 2", Axis("a", (-1000.0, 1000.0), "N/m2")),
        ("a=3,1,2", Axis("a", (3, 1, 2))),
        ("a=2 kn, 4 kn", Axis("a", (2.0, 4.0), "kn")),
        ("a=hybrid,cable", Axis("a", ("hybrid", "cable"))),
        ("a=[0, 1],[2, 3]", Axis("a", ([0, 1], [2, 3]))),
        ("a=2 kn, 1 m", Axis("a", ("2 kn", "1 m"))),
        ("a=1e-4 m,2e-4 m", Axis("a", (1e-4, 2e-4), "m")),
        ("a=2 s-1, 1", Axis("a", ("2 s-1", 1))),
    ],
)
def test_values_are_a_range_or_a_list(text: str, axis: Axis) -> None:
    assert Axis.parse(text) == axis


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a", "path=start:stop:count"),
        ("a=", "path=start:stop:count"),
        ("=1,2", "path=start:stop:count"),
        ("a=0:1:0.1", "0.1 is no number of values"),
        ("a=0:1:1", "a count from 2"),
        ("a=1 m:20 cm:3", "have not the same unit"),
        ("a=[1,", "is not closed"),
        ("a=200-400", "a: '200-400' says not how many; allowed: path=start:stop:count or path="),
        ("a=10 mm:30 mm", "says not how many"),
    ],
)
def test_what_is_neither_is_said(text: str, words: str) -> None:
    with pytest.raises(cm.SceneError) as caught:
        Axis.parse(text)
    assert words in str(caught.value)


def test_every_combination_gives_what_a_run_of_its_own_gives() -> None:
    over = {DIAMETER: [0.01, -1.0, 0.02], LENGTH: ["10 m", 20]}
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:
        table = cm.sweep(SCENE, over, until=20.0, scheduler=cluster.scheduler_address)
    assert table[DIAMETER].tolist() == [0.01, 0.01, -1.0, -1.0, 0.02, 0.02]
    assert table[LENGTH].tolist() == ["10 m", 20, "10 m", 20, "10 m", 20]
    assert table["error"].str.contains("diameter: -1.0 is out of range").tolist() == [
        False, False, True, True, False, False,
    ]  # fmt: skip
    assert table.loc[[2, 3], "time":"elements"].isna().all(axis=None)
    alone = cm.simulate(cm.load_scene(SCENE, [f"{DIAMETER}=0.02", f"{LENGTH}=20"]), until=20.0)
    row = table.loc[5]
    assert row["top_tension"] == alone.top_tension[-1]
    assert row["highest_tension"] == alone.tension_max.max()
    assert [row["tip_x"], row["tip_y"], row["tip_z"]] == alone.tip_position[-1].tolist()
    assert row["max_curvature"] == alone.max_curvature
    assert row["steps"] == alone.statistics["steps"]


def test_the_command_writes_a_table_and_a_picture(tmp_path: Path) -> None:
    target, picture = tmp_path / "sweep.csv", tmp_path / "sweep.png"
    result = command(
        SCENE, "--over", f"{DIAMETER}=10 mm:30 mm:3", "--over", "line.0.cable.model=hybrid,cable",
        "--until", "5", "--workers", "1", "-o", target, "--plot", picture, "--against", DIAMETER,
    )  # fmt: skip
    assert result.exit_code == 0, result.output
    table = pandas.read_csv(target, index_col="run", keep_default_na=False)
    assert table[f"{DIAMETER} [mm]"].tolist() == [10.0, 10.0, 20.0, 20.0, 30.0, 30.0]
    assert table["error"].tolist() == [""] * 6
    assert "6 runs, 0 failed" in result.stdout
    words = " ".join(result.stdout.split())
    assert f"{DIAMETER} [mm] line.0.cable.model" in words
    assert re.search(r" 20 +cable +[\d.,]+ ", result.stdout), result.stdout
    assert picture.read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize("result", RESULTS)
def test_every_result_can_be_drawn(result: str, tmp_path: Path) -> None:
    rows = [{DIAMETER: d, **dict.fromkeys(RESULTS, d), "error": ""} for d in (0.01, 0.02)]
    save_sweep_figure(pandas.DataFrame(rows), tmp_path / "sweep.png", result=result)
    assert (tmp_path / "sweep.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("values", "label", "curve"),
    [
        ({DIAMETER: [0.01, 0.02], LENGTH: 20}, f"{DIAMETER} [m]", "length 20 m"),
        ({f"{LENGTH} [ft]": [60.0, 90.0], DIAMETER: 0.01}, f"{LENGTH} [ft]", "diameter 0.01 m"),
        ({LENGTH: ["60 ft", "20 m"], "solver.tolerance": 0.01}, LENGTH, "tolerance 0.01"),
    ],
)
def test_a_picture_names_units(
    values: dict[str, Any], label: str, curve: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The unit that the values were given with, or that of the scene's numbers, which is SI."""
    drawn: list[Figure] = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, path, **_: drawn.append(figure))
    table = pandas.DataFrame({**values, **dict.fromkeys(RESULTS, 1.0), "error": ""})
    save_sweep_figure(table, "sweep.png", result="highest_tension")
    (axes,) = drawn[0].axes
    assert axes.get_xlabel() == label
    assert [text.get_text() for text in axes.get_legend().get_texts()] == [curve]


def test_errors_that_no_run_estimates_are_not_drawn(
    table: pandas.DataFrame, tmp_path: Path
) -> None:
    """Nor those of a table that was written before there were any."""
    for given in (table, table.assign(error_share=math.nan)):
        with pytest.raises(cm.CableModelError, match="no run of the sweep has a value of error_sh"):
            save_sweep_figure(given, tmp_path / "sweep.png", result="error_share")


def test_an_interruption_keeps_the_runs_that_have_ended(tmp_path: Path) -> None:
    target = tmp_path / "sweep.csv"
    arguments = ["--over", f"{DIAMETER}=0.01:0.03:5000", "--workers", "1", "-o", str(target)]
    sweep = subprocess.Popen(
        [sys.executable, "-m", "cablemodel", "sweep", str(SCENE), *arguments],
        stderr=subprocess.PIPE, text=True,
    )  # fmt: skip
    end = time.monotonic() + 120.0
    while not target.exists() and sweep.poll() is None and time.monotonic() < end:
        time.sleep(0.1)
    sweep.send_signal(SIGINT)
    _output, errors = sweep.communicate(timeout=60)
    rows = pandas.read_csv(target)
    assert sweep.returncode == 130
    assert 0 < len(rows) < 5000
    assert f"The {len(rows)} of 5000 runs that had ended are in" in errors
    assert rows["top_tension"].notna().all()
    assert "Traceback" not in errors


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--over", "cable_types.K.diametr=1,2"], "did you mean diameter?"),
        (["--over", f"{DIAMETER}=-1,-2"], "-1 is out of range"),
        (["--over", f"{DIAMETER}=1,2", "--over", f"{DIAMETER}=3,4"], "swept over twice"),
        (["--over", f"{DIAMETER}=1,2", "-o", "table.txt"], ".parquet"),
        (["--over", f"{DIAMETER}=1,2", "--result", "price"], "highest_tension"),
        (["--over", f"{DIAMETER}=1,2", "--against", "line"], DIAMETER),
        (["--over", f"{DIAMETER}=1:2:2000", "--over", f"{LENGTH}=1:2:2000"], "4,000,000"),
        ([], "--over"),
    ],
)
def test_a_sweep_that_cannot_be_meant_is_bad_input(arguments: list[str], words: str) -> None:
    result = command(SCENE, *arguments)
    assert result.exit_code == 2
    assert words in result.stderr


@pytest.fixture
def table() -> pandas.DataFrame:
    """As a sweep over two values gives it when one run failed and one has not ended."""
    columns = {DIAMETER: [0.01, 0.01, 0.02], "line.0.cable.model": ["hybrid", "cable", "hybrid"]}
    results = {"time": [5.0, 5.0, None], "steps": pandas.array([7, 8, None], dtype="Int64")}
    return pandas.DataFrame({**columns, **results, "error": ["", "", "it broke"]})


def test_a_table_reads_back_from_parquet(table: pandas.DataFrame, tmp_path: Path) -> None:
    write_table(table, tmp_path / "sweep.parquet")
    pandas.testing.assert_frame_equal(pandas.read_parquet(tmp_path / "sweep.parquet"), table)


def test_a_netcdf_file_has_the_values_as_dimensions(
    table: pandas.DataFrame, tmp_path: Path
) -> None:
    write_table(table, tmp_path / "sweep.nc")
    with xarray.open_dataset(tmp_path / "sweep.nc") as grid:
        at = {DIAMETER: 0.01, "line.0.cable.model": "cable"}
        assert float(grid["time"].sel(at)) == 5.0
        assert str(grid["error"].sel({**at, DIAMETER: 0.02}).values) == "not finished"


def test_without_dask_the_error_names_the_extra() -> None:
    code = (
        "import sys; sys.modules['distributed'] = None\n"
        f"sys.argv = ['cablemodel', 'sweep', {str(SCENE)!r}, '--over', '{DIAMETER}=1,2']\n"
        "from cablemodel.cli import main; main()\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "pip install 'cablemodel[sweep]'" in done.stderr


@pytest.mark.parametrize(
    ("over", "words"),
    [
        (
            {"line.0.cable.length": 5},
            "line.0.cable.length: 5 is no list of values; allowed: a list",
        ),
        ({"line.0.cable.length": "20"}, "line.0.cable.length: '20' is no list of values"),
        (["line.0.cable.length=20,30"], "is nothing to sweep over; allowed: {path:"),
        ("line.0.cable.length=20,30", "is nothing to sweep over; allowed: {path:"),
        (5, "5 is nothing to sweep over"),
    ],
)
def test_what_is_no_list_of_values_is_said(over: Any, words: str) -> None:
    with pytest.raises(cm.SceneError) as refused:
        cm.sweep(SCENE, over)
    assert words in str(refused.value)


def test_a_wrong_end_of_a_sweep_is_said_before_it_begins() -> None:
    with pytest.raises(cm.SceneError, match="until: 'soon' is not a number with a unit"):
        cm.sweep(SCENE, {"line.0.cable.length": [20, 30]}, until="soon")


def test_a_sweep_goes_on_where_it_was_interrupted(tmp_path: Path) -> None:
    """What ended well is kept as it is; what failed or is missing is run."""
    path = tmp_path / "sweep.csv"
    arguments = (SCENE, "--over", f"{DIAMETER}=0.01:0.03:4", "--until", "2", "-o", path)
    assert command(*arguments).exit_code == 0
    whole = read_table(path)
    partial = whole.drop(index=2)
    partial.loc[1, "error"] = "no static equilibrium was found"
    partial.loc[0, "wall_time"] = 1234.0
    write_table(partial, path)
    assert command(*arguments, "--resume").exit_code == 0
    found = read_table(path)
    assert list(found.index) == [0, 1, 2, 3]
    assert (found["error"] == "").all()
    assert found.loc[0, "wall_time"] == 1234.0
    assert found.loc[3, "wall_time"] == whole.loc[3, "wall_time"]
    same = [name for name in whole.columns if name != "wall_time"]
    pandas.testing.assert_frame_equal(found[same], whole[same])
    again = command(*arguments, "--resume")
    assert again.exit_code == 0, again.output
    pandas.testing.assert_frame_equal(read_table(path), found)


def test_a_table_of_another_sweep_is_not_gone_on_with(tmp_path: Path) -> None:
    path = tmp_path / "sweep.csv"
    arguments = ("--until", "1", "-o", path)
    assert command(SCENE, "--over", f"{DIAMETER}=0.01,0.02", *arguments).exit_code == 0
    before = path.read_text()
    result = command(SCENE, "--over", f"{DIAMETER}=0.02,0.03", *arguments, "--resume")
    assert result.exit_code == 2, result.output
    assert "run 0 of the table has 0.01" in result.output
    result = command(SCENE, "--over", f"{LENGTH}=20,30", *arguments, "--resume")
    assert f"the table has other columns: {DIAMETER}" in result.output
    for other in (("--until", "2"), ("--set", f"{LENGTH}=30"), ("--converge",)):
        swept = (SCENE, "--over", f"{DIAMETER}=0.01,0.02", "--until", "1", *other, "-o", path)
        result = command(*swept, "--resume")
        assert result.exit_code == 2, result.output
        assert "of a sweep over another scene, or with other --set" in " ".join(
            result.output.split()
        )
    assert path.read_text() == before
    path.write_text("a,b\n1,2\n")
    result = command(SCENE, "--over", f"{LENGTH}=20,30", *arguments, "--resume")
    assert "is not the table of a sweep" in result.output


def test_a_table_is_a_grid(table: pandas.DataFrame) -> None:
    grid = cm.grid_of(table)
    assert set(grid.sizes) == set(swept_columns(table))


def test_a_table_that_pandas_has_read_is_the_same_grid(
    table: pandas.DataFrame, tmp_path: Path
) -> None:
    path = tmp_path / "sweep.csv"
    table.to_csv(path, index_label="run")
    read, kept = cm.grid_of(pandas.read_csv(path)), cm.grid_of(table)
    assert read.sizes == kept.sizes
    assert (read["error"] == kept["error"]).all()
    assert set(kept["error"].values.ravel()) == {"", "it broke", "not finished"}
    xarray.testing.assert_allclose(read["time"], kept["time"])


def test_short_runs_that_go_together_fail_by_themselves() -> None:
    """One that raises what nobody expects is a row; those beside it are what they are."""

    def simulate(overrides: Sequence[str]) -> dict[str, Any]:
        number = int(overrides[0])
        if number == 150:
            raise RuntimeError("no good")
        return {"top_tension": float(number), "error": ""}

    rows: dict[int, dict[str, Any]] = {3: {"error": "", "top_tension": 3.0}}
    changes = {index: [str(index)] for index in range(200) if index != 3}
    reports: list[int] = []
    with LocalCluster(n_workers=1, threads_per_worker=1, dashboard_address=None) as cluster:
        client = Client(cluster, set_as_default=False)
        _collect(client, simulate, changes, rows, lambda: reports.append(len(rows)))
        client.close()
    assert sorted(rows) == list(range(200))
    assert rows.pop(150) == {"error": "RuntimeError: no good"}
    assert all(row == {"top_tension": float(k), "error": ""} for k, row in rows.items())
