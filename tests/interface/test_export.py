"""A run in other formats: all numbers to the last bit, with units; and in statistics."""

import csv
import json
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

import cablemodel as cm
from cablemodel import variables
from cablemodel.analysis import statistics
from cablemodel.cli import app
from cablemodel.results.columns import input_columns, output_columns, state_columns
from cablemodel.results.export import export
from cablemodel.scene import Scene, load_scene


def invoke(*arguments: Any) -> Any:
    return CliRunner().invoke(app, [*map(str, arguments)])


@pytest.fixture
def log(full_scene: Scene, swinging_cable: Any, tmp_path: Path) -> Path:
    path = tmp_path / "run.mcap"
    model = swinging_cable(full_scene, nodes=lambda time: 5 + int(time > 5.0))
    cm.simulate(full_scene, log=path, model=model)
    return path


def same(a: Any, b: Any) -> bool:
    return bool(np.array_equal(a, b, equal_nan=True))


def test_columns_name_every_number(log: Path) -> None:
    run = cm.open_run(log)
    columns = {column.name: column for column in output_columns(run)}
    assert same(columns["time"].values, run.time)
    assert same(columns["top_force.z"].values, run["top_force"][:, 2])
    assert same(columns["bodies[1].position.x"].values, run["bodies.position"][:, 1, 0])
    assert columns["top_moment.x"].unit == "N.m"
    assert columns["bodies[0].direction.y"].unit == "1"
    assert all(column.quantity for column in columns.values())
    states = {column.name: column.values for column in state_columns(run)}
    assert [*states] == ["time", *variables.STATE_LABELS, *variables.DERIVED]
    assert len(states["time"]) == sum(len(state.s) for state in run.states)
    last = states["time"] == run.time[-1]
    assert same(states["position.z"][last], run.states[-1].position[:, 2])
    inputs = {column.name: column for column in input_columns(run)}
    assert [*inputs] == [*variables.APPLIED_INPUT_LABELS]
    assert inputs["payout_rate"].unit == "m/s"
    assert inputs["payout_rate_given"].unit == "1"


def test_netcdf_holds_everything(log: Path, tmp_path: Path) -> None:
    xarray = pytest.importorskip("xarray")
    pytest.importorskip("h5netcdf")
    run = cm.open_run(log)
    export(run, tmp_path / "run.nc")
    expected = run.to_xarray()
    with xarray.open_dataset(tmp_path / "run.nc", engine="h5netcdf") as data:
        assert set(data.variables) == set(expected.variables)
        for name in expected.variables:
            values, again = expected[name].values, data[name].values
            equal = same(values, again) if values.dtype.kind == "f" else (values == again).all()
            assert equal, name
            assert {**data[name].attrs} == {**expected[name].attrs}
        assert load_scene(data.attrs["scene"]) == run.scene
        assert data.attrs["title"] == "Everything"


def test_csv_reads_back_to_the_last_bit(log: Path, tmp_path: Path) -> None:
    run = cm.open_run(log)
    path = tmp_path / "run.csv"
    export(run, path)
    with path.open(newline="") as stream:
        header, *rows = list(csv.reader(stream))
    columns = output_columns(run)
    assert header[:2] == ["time [s]", "top_tension [N]"]
    assert "bodies[0].direction.x" in header
    values = np.array([[float(cell or "nan") for cell in row] for row in rows])
    assert values.shape == (35, len(columns))
    for index, column in enumerate(columns):
        assert same(values[:, index], column.values), column.name
    assert "" in {row[header.index("touchdown_position.y [m]")] for row in rows}


def test_parquet_reads_back_with_units(log: Path, tmp_path: Path) -> None:
    parquet = pytest.importorskip("pyarrow.parquet")
    run = cm.open_run(log)
    for table, columns in (
        ("outputs", output_columns(run)),
        ("states", state_columns(run)),
        ("inputs", input_columns(run)),
    ):
        path = tmp_path / f"{table}.parquet"
        export(run, path, table=table)  # type: ignore[arg-type]
        read = parquet.read_table(path)
        assert read.column_names == [column.name for column in columns]
        for column in columns:
            assert same(read[column.name].to_numpy(), column.values), column.name
            metadata = read.schema.field(column.name).metadata
            assert metadata[b"unit"].decode() == column.unit
            assert metadata[b"description"].decode() == column.quantity


@pytest.mark.parametrize(
    ("package", "ending"), [("pyarrow", "parquet"), ("h5netcdf", "nc"), ("xarray", "nc")]
)
def test_a_missing_package_names_the_extra(
    log: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, package: str, ending: str
) -> None:
    monkeypatch.setitem(__import__("sys").modules, package, None)
    result = invoke("export", log, "-o", tmp_path / f"run.{ending}")
    assert result.exit_code == 1
    assert f"needs the package {package}: pip install 'cablemodel[export]'" in result.stderr
    assert not (tmp_path / f"run.{ending}").exists()


def test_an_unknown_ending_is_an_error(log: Path, tmp_path: Path) -> None:
    with pytest.raises(cm.CableModelError, match=r"must end in \.nc, \.csv, \.parquet"):
        export(cm.open_run(log), tmp_path / "run.xlsx")


def test_the_export_command(log: Path, tmp_path: Path) -> None:
    for name in ("run.nc", "run.csv", "run.parquet"):
        result = invoke("export", log, "-o", tmp_path / name)
        assert result.exit_code == 0, result.output
        assert (tmp_path / name).stat().st_size > 1000
    result = invoke("export", log, "-o", tmp_path / "states.csv", "--table", "states")
    assert result.exit_code == 0
    assert (tmp_path / "states.csv").read_text().startswith("time [s],s [m],position.x [m]")
    for arguments in (
        ("-o", tmp_path / "run.xlsx"),
        ("-o", tmp_path / "missing" / "run.csv"),
        ("-o", tmp_path / "x.csv", "--table", "colours"),
        ("-o", tmp_path / "x.nc", "--table", "states"),
    ):
        assert invoke("export", log, *arguments).exit_code == 2


def test_statistics_of_a_run(log: Path) -> None:
    run = cm.open_run(log)
    found = {row.name: row for row in statistics(run, after=1.0, before=8.0)}
    inside = (run.time >= 1.0) & (run.time <= 8.0)
    tension = run.top_tension[inside]
    assert found["top_tension"].extremes.maximum == tension.max()
    assert found["top_tension"].unit == "N"
    assert 1.0 <= found["top_tension"].extremes.time_of_minimum <= 8.0
    assert "bodies[1].position.z" in found
    assert "time" not in found
    ends = "the run is from 0 to 10 s"
    with pytest.raises(ValueError, match=f"no outputs from 20 to 30 s; {ends}"):
        statistics(run, after=20.0, before=30.0)
    with pytest.raises(ValueError, match=f"no outputs after 20 s; {ends}"):
        statistics(run, after=20.0)


def test_statistics_do_without_what_counts_cycles(
    log: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Unless fatigue is asked for."""
    monkeypatch.setitem(sys.modules, "rainflow", None)
    result = invoke("stats", log)
    assert result.exit_code == 0, result.output
    assert "peak period" in result.stdout
    assert "no cycles: counting cycles needs the package rainflow: pip install" in result.stdout
    assert json.loads(invoke("stats", log, "--json").stdout)["fatigue"] is None
    assert invoke("stats", log, "--intercept", "1e6").exit_code == 1


def test_statistics_tell_numbers_of_bodies_by_name_and_leave_rounding_out(log: Path) -> None:
    run = cm.open_run(log)
    names = [body.name or "" for body in run.scene.bodies]
    assert run.scene.body_names(len(names)) == names
    assert run.scene.body_names(1) == names[-1:]
    words = invoke("stats", log).stdout
    for number, name in enumerate(names):
        assert (f"bodies[{number}]: {name}" in words) == bool(name)


def test_the_stats_command(log: Path) -> None:
    result = invoke("stats", log, "--after", "1 s", "--intercept", "1e6", "--reference", "1 kN")
    assert result.exit_code == 2  # a reference is a plain number
    result = invoke("stats", log, "--after", "1 s", "--intercept", "1e6", "--reference", "1000")
    assert result.exit_code == 0, result.output
    assert "top_tension" in result.stdout
    assert "fatigue damage" in result.stdout
    assert "constant: line_length 30 m" not in result.stdout
    report = json.loads(invoke("stats", log, "--json", "--before", "9").stdout)
    rows = {row["name"]: row for row in report["statistics"]}
    run = cm.open_run(log)
    assert rows["top_tension"]["maximum"] == run.top_tension[run.time <= 9.0].max()
    assert report["to"] == pytest.approx(9.0)
    assert report["fatigue"]["cycles"] > 0.0
    assert "damage" not in report["fatigue"]
    assert invoke("stats", log, "--after", "20").exit_code == 1
    assert invoke("stats", log, "--slope", "0").exit_code == 2
    assert invoke("stats", log, "--after", "soon").exit_code == 2
