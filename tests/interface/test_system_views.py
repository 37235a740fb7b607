"""Pictures, films, reports, tables and sweeps of a system, by the names of its parts."""

import csv
import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas
import pytest
import yaml
from scipy.spatial.transform import Rotation
from test_report import browser, data_of, figures_of, made, plain, wait  # noqa: F401
from typer.testing import CliRunner, Result

import cablemodel as cm
from cablemodel.cli import app
from cablemodel.results.columns import input_columns, output_columns, state_columns
from cablemodel.results.recorder import recorder_of
from cablemodel.results.run import SystemRun
from cablemodel.systems import SystemModel, load_system
from cablemodel.views.drawing import Shapes, axes_of, bodies_of, held_of, parts_of

SCENE = Path(__file__).with_name("bridle.yaml")
LINES = ["port", "starboard", "streamer"]


def invoke(*arguments: Any) -> Result:
    return CliRunner().invoke(app, [*map(str, arguments)])


@pytest.fixture(scope="module")
def log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A tug with a wing on two lines and a streamer turns; the wing is pushed, and steers,
    and the streamer is cut."""
    path = tmp_path_factory.mktemp("system") / "bridle.mcap"
    model = SystemModel(SCENE)
    with recorder_of(model, path, until=20.0) as recorder:
        while model.time < 20.0 - 1e-9:
            push = [0.0, 200.0 * (model.time > 8.0), 0.0, 0.0, 0.0, 0.0]
            wing = {"wing.elevator": 0.1 * np.sin(model.time / 3.0)}
            cuts = ["knife"] if model.time == 15.0 else []
            recorder.step(0.5, forces={"wing": push}, deflections=wing, cuts=cuts)
    return path


@pytest.fixture
def run(log: Path) -> SystemRun:
    opened = cm.open_run(log)
    assert isinstance(opened, SystemRun)
    return opened


# ---- what pictures share ----


def test_axes_are_those_of_the_attitudes() -> None:
    """Roll, pitch and yaw as `Motion.attitude` gives them, by SciPy."""
    attitude = np.random.default_rng(3).uniform(-1.5, 1.5, (20, 3))
    expected = Rotation.from_euler("xyz", attitude).as_matrix()
    assert axes_of(attitude) == pytest.approx(expected, abs=1e-15)


def test_places_of_parts_are_where_the_lines_end(run: SystemRun) -> None:
    """Points of vessels and bodies, turned by their attitudes, are the ends of the lines there; a
    body on a line is at its arc length."""
    shapes = Shapes.of(run)
    ends = {name: run.lines[name].position[:, [0, -1]] for name in LINES}
    (tug,), (wing,) = (parts_of(run, kind, shapes.time) for kind in ("vessels", "bodies"))
    for name in ("port", "starboard"):
        assert tug.points[name] == pytest.approx(ends[name][:, 0], abs=1e-6)
        assert wing.points[name] == pytest.approx(ends[name][:, 1], abs=1e-6)
    assert tug.points["stern"] == pytest.approx(ends["streamer"][:, 0], abs=1e-6)
    assert held_of(run, shapes).names == ("tug.port", "tug.starboard", "tug.stern")
    bodies = bodies_of(run, shapes)
    assert bodies.names == ("wing", "drogue", "")
    assert bodies.places[:, 2] == pytest.approx(ends["streamer"][:, 1], abs=1e-6)
    for state, place in zip(run.lines["streamer"], bodies.places[:, 1], strict=True):
        assert place == pytest.approx(state.position[state.s == 20.0][0], abs=0.05)


def test_lines_stand_side_by_side_with_gaps(run: SystemRun) -> None:
    shapes = Shapes.of(run)
    assert list(shapes.places) == LINES
    gaps = np.flatnonzero(np.isnan(shapes.tension[0]))
    between, cut = gaps[:2], gaps[2]
    assert between.tolist() == [at.stop for at in list(shapes.places.values())[:-1]]
    # Both sides of the cut: together until it is made, then apart.
    assert shapes.s[0, [cut - 1, cut + 1]].tolist() == [25.0, 25.0]
    apart = np.linalg.norm(shapes.position[:, cut + 1] - shapes.position[:, cut - 1], axis=-1)
    assert apart[shapes.time <= 15.0].max() < 1e-9
    assert apart[-1] > 1.0
    assert run["knife.time"][-1] == 15.0
    for name, at in shapes.places.items():
        assert np.array_equal(shapes.tension[:, at.start], run[f"{name}.start_tension"])
        assert np.array_equal(shapes.position[:, at.stop - 1], run.lines[name].position[:, -1])


# ---- plot and animate ----


def test_a_figure_shows_every_line_body_and_vessel(run: SystemRun) -> None:
    from cablemodel.views.plot import draw

    figure = draw(run)
    side, plan, start, *alongs = figure.axes
    assert (side.get_ylabel(), plan.get_ylabel()) == ("z [m]", "y [m]")
    for axes in (side, plan):
        assert [text.get_text() for text in axes.texts] == ["tug", "wing", "drogue"]
    place = run["wing.position"][-1]
    assert side.texts[1].xy == pytest.approx(place[[0, 2]])
    assert plan.texts[1].xy == pytest.approx(place[[0, 1]])
    curves = {line.get_label(): line.get_ydata() for line in start.get_lines()}
    for name in LINES:
        assert np.array_equal(curves[name], run[f"{name}.start_tension"])
    assert [text.get_text() for text in start.get_legend().get_texts()] == LINES
    assert [axes.get_title() for axes in alongs] == LINES
    last, state = alongs[2].get_lines()[-1], run.lines["streamer"][-1]
    assert np.array_equal(last.get_xydata(), np.column_stack([state.s, state.tension]))
    key = [text.get_text() for text in figure.legends[0].get_texts()]
    assert key[-3:-1] == ["body", "point of a vessel"]


@pytest.mark.parametrize(
    ("corner", "size"),
    [((500.0, 0.0, 300.0), 500.0), ((80.0, 0.0, 500.0), 80.0), ((0.0, 0.0, 500.0), 500.0)],
)
def test_axes_of_bodies_fit_a_picture_that_is_not_to_scale(
    run: SystemRun, corner: tuple[float, ...], size: float
) -> None:
    from cablemodel.views.plot import View

    view = View.of(run)
    shape = np.array([[(0.0, 0.0, 0.0), corner]])
    assert replace(view, shape=shape, along=np.array([1.0, 0.0]))._size() == size


def test_the_commands_draw_and_film_a_system(log: Path, tmp_path: Path) -> None:
    from PIL import Image

    picture, film = tmp_path / "run.png", tmp_path / "run.gif"
    for arguments in (["plot", log, "-o", picture],
                      ["animate", log, "-o", film, "--seconds", "1", "--fps", "2"]):  # fmt: skip
        result = invoke(*arguments)
        assert result.exit_code == 0, result.output
    assert picture.read_bytes().startswith(b"\x89PNG")
    with Image.open(film) as pictures:
        assert pictures.n_frames == 2


def test_a_film_moves_lines_bodies_and_names(run: SystemRun) -> None:
    from cablemodel.views.animate import _Film

    film = _Film(run)
    film.picture(float(run.time[-1]))
    side = film._panels[0]
    segments = np.array(side.cable.get_segments())
    shapes = Shapes.of(run)
    # No segment joins two lines.
    assert len(segments) == np.isfinite(np.diff(shapes.s[0])).sum()
    assert np.isfinite(segments).all()
    named = {text.get_text(): text.xy for text in side.axes.texts}
    assert named["wing"] == pytest.approx(tuple(run["wing.position"][-1, [0, 2]]))


# ---- report ----


def test_the_report_holds_all_lines(log: Path, run: SystemRun) -> None:
    import plotly.graph_objects as go

    page = made(log)
    data = data_of(page)
    assert list(data["lines"]) == LINES
    for name in LINES:
        figures = figures_of(data, name)
        for title, figure in figures.items():
            assert go.Figure(figure).data, title
        heat = figures["tension-map"]["data"][0]["z"]
        assert heat[0] == pytest.approx(run[f"{name}.start_tension"], rel=1e-6)
        assert figures["tension-along"]["layout"]["xaxis"]["title"]["text"] == (
            "arc length from its beginning [m]"
        )
    figures = figures_of(data, "port")
    curves = {curve["name"]: curve["y"] for curve in figures["top-tension"]["data"]}
    assert np.array_equal(curves["starboard"], run["starboard.start_tension"])
    inputs = {curve["name"]: curve for curve in figures["inputs"]["data"]}
    assert [*inputs] == ["tug x", "tug y", "wing force y", "wing.elevator deflection", "knife cut"]
    assert np.array_equal(inputs["wing force y"]["y"], run.applied_inputs["wing.force.y"])
    assert np.array_equal(inputs["tug y"]["y"], run["tug.velocity"][:, 1])
    assert np.nansum(inputs["knife cut"]["y"]) == 1.0
    assert inputs["knife cut"]["mode"] == "lines+markers"
    assert inputs["tug y"]["mode"] == "lines"


def test_the_report_tells_what_a_winch_pays_out(tmp_path: Path) -> None:
    wire = {"diameter": 0.02, "mass": 1.6, "axial_stiffness": 2e7}
    log = tmp_path / "lowered.mcap"
    scene = {
        "cable_types": {"wire": wire},
        "vessels": {"ship": {"points": {"crane": [0, 0, 0]}}},
        "lines": {
            "fall": {
                "from": "ship.crane", "to": "free",
                "items": [
                    {"cable": {"type": "wire", "length": 20}},
                    {"body": {"mass": 100, "submerged_weight": 900, "drag_area": 0.1}},
                ],
            },
        },
        "winches": {"crane": {"line": "fall", "drum": 10, "rate": 0.5}},
        "run": {"duration": 4},
    }  # fmt: skip
    cm.simulate(scene, log=log)
    invoke("report", log)
    page = log.with_suffix(".html").read_text(encoding="utf-8")
    assert "fall: 20 m of wire at the start, 22 m at the end · " in page


def test_the_shape_of_the_report_moves_every_part(log: Path, run: SystemRun) -> None:
    shape = plain(data_of(made(log))["shape"])
    held, bodies, _skeletons, names = shape["marks"]
    ground = np.append(shape["ground"][-1], 0.0)
    assert shape["reference"] == "tug"
    assert ground[:2] == pytest.approx(run["tug.position"][-1, :2])
    assert bodies[-1, 0] + ground == pytest.approx(run["wing.position"][-1], abs=1e-4)
    assert held[-1, 1] + ground == pytest.approx(run.lines["starboard"][-1].position[0], abs=1e-4)
    assert names[-1, 0] + ground == pytest.approx(run["tug.position"][-1], abs=1e-4)
    lines = Shapes.of(run)
    assert np.array_equal(np.isnan(shape["position"][0, :, 0]), np.isnan(lines.s[0]))
    end = shape["position"][-1, -1] + ground
    assert end == pytest.approx(run.lines["streamer"][-1].position[-1], abs=1e-4)


def test_numbers_of_the_report_are_of_named_parts(log: Path, run: SystemRun) -> None:
    from cablemodel.views.report.tables import number

    text = made(log).read_text(encoding="utf-8")
    assert "port: 60 m of wire · starboard: 60 m of wire · streamer: 30 m of wire · " in text
    assert "body wing · vessel tug · t = 0 to 20 s" in text
    highest = number(run["starboard.start_tension"].max())
    assert f"<h3>starboard: tension at its beginning, highest</h3><p><b>{highest}</b>" in (
        text.replace("\n", "")
    )
    assert "<h3>knife: streamer is cut</h3><p><b>15</b> s" in text
    for words in ("tension along streamer", "tension at the end of port", "wing, pitch",
                  "force of the lines on tug", "speed of wing"):  # fmt: skip
        assert f'<th scope="row">{words} <i>' in text
    assert "<option>port</option><option>starboard</option><option>streamer</option>" in text


@pytest.mark.slow
@pytest.mark.parametrize("browser", ["laptop"], indirect=True)
def test_browsers_show_another_line(browser: Any, log: Path, run: SystemRun) -> None:  # noqa: F811
    browser.get(made(log).as_uri())
    wait(browser, "document.body.dataset.ready")
    last = len(run.time) - 1
    browser.execute_script(
        "for (const [id, event, value] of arguments[0]) {"
        "const e = document.getElementById(id); e.value = value;"
        "e.dispatchEvent(new Event(event)); }",
        [["time", "input", last], ["line", "change", "streamer"]],
    )
    tension = run["streamer.start_tension"][-1]
    curve = "document.getElementById('tension-along').data[2].y"
    wait(browser, f"Math.abs({curve}[0] - {tension}) < 1e-3 * {tension}")
    shown = browser.execute_script(
        "return [...document.querySelectorAll('.line, .of-line')].map(e => e.textContent)"
    )
    assert shown == ["streamer", "streamer", ", streamer", ", streamer"]
    z = browser.execute_script(
        "const z = document.getElementById('shape').data[2].z; return [...z]"
    )
    assert z[0] == pytest.approx(run["wing.position"][-1, 2], abs=1e-4)
    severe = [entry for entry in browser.get_log("browser") if entry["level"] == "SEVERE"]
    assert severe == []


# ---- tables ----


def test_tables_name_lines_and_parts(run: SystemRun) -> None:
    outputs = {column.name: column for column in output_columns(run)}
    assert np.array_equal(outputs["wing.attitude.y"].values, run["wing.attitude"][:, 1])
    assert outputs["tug.force.z"].unit == "N"
    states = {column.name: column.values for column in state_columns(run)}
    for name in LINES:
        rows = states["line"] == name
        for field in ("tension", "wall_tension"):
            values = np.concatenate([getattr(state, field) for state in run.lines[name]])
            assert np.array_equal(states[field][rows], values)
    inputs = {column.name: column for column in input_columns(run)}
    assert [*inputs] == [*run.applied_inputs]
    assert inputs["wing.elevator.deflection"].unit == "rad"
    assert inputs["wing.force.y"].quantity == "wing: outside force"


def test_wall_tension_of_a_line_is_less_by_the_pressure(run: SystemRun) -> None:
    state = run.lines["port"][-1]
    depth = np.maximum(-state.position[:, 2], 0.0)
    area = np.pi / 4 * 0.02**2
    pressure = run.scene.environment.water_density * run.scene.environment.gravity * depth
    assert state.wall_tension == pytest.approx(state.tension - pressure * area, rel=1e-12)


def test_export_of_a_system(log: Path, run: SystemRun, tmp_path: Path) -> None:
    xarray = pytest.importorskip("xarray")
    parquet = pytest.importorskip("pyarrow.parquet")
    for name in ("states.csv", "states.parquet", "inputs.csv", "all.nc"):
        table = ["--table", name.partition(".")[0]] if "all" not in name else []
        result = invoke("export", log, "-o", tmp_path / name, *table)
        assert result.exit_code == 0, result.output
    columns = {column.name: column.values for column in state_columns(run)}
    with (tmp_path / "states.csv").open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert [row["line"] for row in rows] == columns["line"].tolist()
    assert [float(row["tension [N]"]) for row in rows] == columns["tension"].tolist()
    read = parquet.read_table(tmp_path / "states.parquet")
    assert read["line"].to_pylist() == columns["line"].tolist()
    with xarray.open_dataset(tmp_path / "all.nc", engine="h5netcdf") as data:
        assert np.array_equal(data["streamer_state_tension"].values, run.lines["streamer"].tension)
        assert data["streamer_state_tension"].dims == ("state_time", "streamer_node")
        assert np.array_equal(data["wing_position"].values, run["wing.position"])
        assert data["applied_wing_force"].dims == ("step_time", "axis")
        assert data["applied_wing_elevator_deflection"].attrs["units"] == "rad"
        assert load_system(data.attrs["scene"]) == run.scene


def test_statistics_are_of_each_line(log: Path, run: SystemRun) -> None:
    from cablemodel import analysis

    report = json.loads(invoke("stats", log, "--json", "--intercept", "1e6").stdout)
    rows = {row["name"]: row for row in report["statistics"]}
    assert rows["wing.position.z"]["minimum"] == run["wing.position"][:, 2].min()
    assert list(report["lines"]) == LINES
    largest = analysis.cycles(run["streamer.start_tension"]).range[0]
    assert report["lines"]["streamer"]["fatigue"]["largest_range"] == largest
    text = invoke("stats", log, "--intercept", "1e6").stdout
    for name in LINES:
        assert f"{name}.start_tension: significant range" in text
        assert f"{name}.start_tension: fatigue damage" in text


def test_info_and_diff_of_a_system(log: Path) -> None:
    info = invoke("info", log)
    assert info.exit_code == 0, info.output
    assert "/cable/streamer/state" in info.stdout
    diff = invoke("diff", log, log)
    assert diff.exit_code == 0, diff.output
    assert "wing.position" in diff.stdout


def test_a_cut_log_has_states_of_all_lines_at_the_same_times(log: Path, tmp_path: Path) -> None:
    whole = log.read_bytes()
    for share in (0.5, 0.9):
        cut = tmp_path / "cut.mcap"
        cut.write_bytes(whole[: int(share * len(whole))])
        opened = cm.open_run(cut)
        times = [states.time.tolist() for states in opened.shapes.values()]
        assert times[0] == times[1] == times[2]
        assert all(len(states.tension) == len(times[0]) for states in opened.shapes.values())


# ---- sweep ----


def test_a_sweep_over_a_system_is_what_its_runs_are(tmp_path: Path) -> None:
    target, picture = tmp_path / "sweep.csv", tmp_path / "sweep.png"
    data = yaml.safe_load(SCENE.read_text())
    del data["lines"]["streamer"], data["cuts"]
    scene, length = tmp_path / "wing.yaml", "lines.port.items.0.cable.length"
    scene.write_text(yaml.safe_dump(data))
    result = invoke("sweep", scene, "--over", f"{length}=-1 m, 61 m", "--until", "2",
                    "--workers", "1", "-o", target, "--plot", picture, "--result",
                    "wing.position.z")  # fmt: skip
    assert result.exit_code == 0, result.output
    assert picture.read_bytes().startswith(b"\x89PNG")
    table = pandas.read_csv(target, index_col="run", keep_default_na=False)
    assert [bool(text) for text in table["error"]] == [True, False]
    alone = cm.simulate(load_system(scene, [f"{length}=61"]), until=2.0)
    assert isinstance(alone, SystemRun)
    row = table.loc[1]
    assert float(row["wing.position.z"]) == alone["wing.position"][-1, 2]
    assert float(row["port.tension_max"]) == alone["port.tension_max"].max()
    assert float(row["starboard.end_tension"]) == alone["starboard.end_tension"][-1]
    assert float(row["tug.force.x"]) == alone["tug.force"][-1, 0]
    assert float(row["highest_tension"]) == alone.tension_max.max()


def test_results_of_a_sweep_are_named_with_units() -> None:
    from cablemodel.analysis.sweep import result_label, results_of

    results = results_of(load_system(SCENE))
    assert "tip_x" not in results
    assert all(result_label(name) == text for name, text in results.items())
    assert results["port.tension_max"] == "port: highest tension along it, of the run [N]"
    assert results["wing.attitude.y"] == "wing: roll, pitch and yaw, y, at the end [rad]"


def test_what_a_system_has_not_is_refused_by_name(tmp_path: Path) -> None:
    sweep = ["sweep", SCENE, "--over", "run.duration=1,2", "-o", tmp_path / "sweep.csv"]
    for arguments, words in (
        ([*sweep, "--result", "tip_x"], "tip_x is none of time"),
        (["convergence", SCENE], "a system, not a scene of one line"),
    ):
        result = invoke(*arguments)
        assert result.exit_code == 2, result.output
        assert words in " ".join(result.stderr.replace("│", " ").split())
    with pytest.raises(cm.SceneError, match="a system, not a scene of one line"):
        cm.convergence(load_system(SCENE))
