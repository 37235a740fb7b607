"""The command line: what it prints, its exit status, and its errors."""

import errno
import json
import math
import os
import pty
import re
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner, Result

import cablemodel as cm
from cablemodel.cli import app
from cablemodel.cli.plausibility import scene_warnings, start_warnings, system_warnings
from cablemodel.cli.run import explained_start
from cablemodel.solvers import library
from cablemodel.systems import load_system

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "scenes" / "towed_cable.yaml"
BREAKING = "environment.waves={regular: {height: 9, period: 5}}"
SUMMARY = [
    "time", "top_tension", "tip_position", "min_tension", "max_tension",
    "slack_time", "slack_longest", "slack_start", "slack_end", "max_curvature",
    "wall_time", "steps", "rejected", "factorisations", "elements",
]  # fmt: skip


def invoke(*arguments: str | Path) -> Result:
    """On a screen so wide that no folder of a test breaks a message."""
    return CliRunner(env={"COLUMNS": "300"}).invoke(app, [str(item) for item in arguments])


def command(*arguments: str | Path, **options: Any) -> "subprocess.CompletedProcess[str]":
    """The command in a process of its own."""
    return subprocess.run(
        [sys.executable, "-m", "cablemodel", *map(str, arguments)],
        capture_output=True, text=True, check=False, cwd=ROOT, **options,
    )  # fmt: skip


@pytest.fixture
def stand_in(monkeypatch: pytest.MonkeyPatch, swinging_cable: Any) -> Any:
    """Commands run the stand-in for the engine, which fails at a time of choice."""

    def use(**options: Any) -> None:
        monkeypatch.setattr(
            "cablemodel.model.CableModel", lambda scene: swinging_cable(scene, **options)
        )

    return use


@pytest.fixture
def log(tmp_path: Path) -> Path:
    path = tmp_path / "run.mcap"
    cm.simulate(cm.load_scene(SCENE), log=path, until=20.0)
    return path


def test_run_ends_with_a_summary(tmp_path: Path) -> None:
    path = tmp_path / "run.mcap"
    result = invoke("run", SCENE, "--log", path, "--until", "10")
    assert result.exit_code == 0, result.output
    run = cm.open_run(path)
    assert run.complete
    assert f"{run.top_tension[-1]:.3f} N" in result.stdout
    assert str(path) in result.stdout.replace("\n", "")
    assert result.stderr == ""


def test_run_as_json_is_one_object_with_the_promised_keys() -> None:
    done = command("run", SCENE, "--until", "10", "--json")
    assert done.returncode == 0, done.stderr
    summary = json.loads(done.stdout)
    assert list(summary) == SUMMARY
    assert summary["time"] == 10.0
    # benchmarks/references.json, S1 at t = 10
    assert summary["top_tension"] == pytest.approx(70.0005, abs=0.7)
    assert summary["tip_position"][2] == pytest.approx(-29.97556, abs=0.03)
    assert done.stderr == ""


def test_values_can_be_set() -> None:
    result = invoke(
        "run", SCENE, "--set", "line.0.cable.length=10", "--set", "run.duration=1", "--json"
    )
    summary = json.loads(result.stdout)
    assert summary["time"] == 1.0
    assert summary["top_tension"] == pytest.approx(23.3333, abs=0.1)


def test_until_takes_units() -> None:
    result = invoke("run", SCENE, "--until", "0.05 min", "--json")
    assert json.loads(result.stdout)["time"] == pytest.approx(3.0)


@pytest.mark.parametrize("until", ["0", "-3", "nan", "soon", "5 kg", "inf"])
def test_a_wrong_until_is_bad_input(until: str) -> None:
    result = invoke("run", SCENE, "--until", until)
    assert result.exit_code == 2
    assert "--until" in result.stderr
    assert "Traceback" not in result.output


def test_check_says_what_waves_there_are() -> None:
    waves = "environment.waves={jonswap: {hs: 2, tp: 8, seed: 5, direction: 90 deg}}"
    result = invoke("check", SCENE, "--set", waves, "--json")
    assert result.exit_code == 0, result.output
    words = json.loads(result.stdout)["waves"]
    assert "JONSWAP, significant height 2 m, peak period 8 s" in words
    length = f"{9.80665 * 8**2 / (2 * math.pi):.4g}"
    assert f"seed 5; {length} m long in deep water, going 90 degrees from x" in words


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["run", "missing.yaml"], ["missing.yaml", "cannot be read"]),
        (["run", str(SCENE), "--set", "line.0.cable.length=-5"], ["line.0.cable.length", "-5"]),
        (["run", str(SCENE), "--set", "line.0.cable.lenght=5"], ["lenght"]),
        (["run", str(SCENE), "--set", "nonsense"], ["path=value"]),
        (["run", str(SCENE), "--log", "no/such/folder/run.mcap"], ["no folder no/such/folder"]),
        (["check", str(SCENE), "--set", BREAKING], ["waves.regular.height", "break"]),
        (["check", "missing.yaml"], ["missing.yaml"]),
        (["info", "missing.mcap"], ["missing.mcap"]),
        (["info", str(SCENE)], ["no MCAP file"]),
        (["plot", str(SCENE), "-o", "figure.png"], ["no MCAP file"]),
        (["plot", str(SCENE), "-o", "figure.doc"], [".svg"]),
        (["plot", str(SCENE), "-o", "no/such/figure.png"], ["no folder"]),
        (["run"], ["Missing argument"]),
        (["dance"], ["dance"]),
    ],
)
def test_bad_input_is_one_message_and_status_2(arguments: list[str], words: list[str]) -> None:
    result = invoke(*arguments)
    assert result.exit_code == 2, result.output
    for word in words:
        assert word in result.stderr
    assert "Traceback" not in result.output
    assert result.stdout == ""


@pytest.mark.parametrize(
    "arguments",
    [
        ["run", SCENE, "--until", "10", "--set", "run.output_interval=1e-9"],
        ["run", SCENE, "--set", "run.duration=1e12"],
        ["check", SCENE, "--set", "run.duration=1e12"],
    ],
)
def test_more_outputs_than_fit_are_bad_input(arguments: list[Any]) -> None:
    result = invoke(*arguments)
    assert result.exit_code == 2
    assert "run.output_interval" in result.stderr
    assert "allowed: at most 10,000,000" in result.stderr


def test_a_failed_run_has_status_1_and_keeps_its_log(tmp_path: Path, stand_in: Any) -> None:
    stand_in(fail_at=5.2)
    path = tmp_path / "run.mcap"
    result = invoke("run", SCENE, "--log", path)
    assert result.exit_code == 1
    assert "no convergence" in result.stderr
    assert "3 m along the cable" in result.stderr
    assert f"up to t = 5 s, is in {path}" in result.stderr
    assert "Traceback" not in result.output
    assert result.stdout == ""
    assert cm.open_run(path).time[-1] == 5.0


def test_a_failed_run_without_a_log_claims_none(stand_in: Any) -> None:
    stand_in(fail_at=5.2)
    result = invoke("run", SCENE)
    assert result.exit_code == 1
    assert "is in" not in result.stderr


def test_a_defect_is_said_to_be_one(monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(scene: Any) -> None:
        raise ZeroDivisionError("oops")

    monkeypatch.setattr("cablemodel.model.CableModel", broken)
    result = invoke("run", SCENE)
    assert result.exit_code == 1
    assert "internal error: ZeroDivisionError: oops" in result.stderr
    assert "Traceback" not in result.stderr


def test_a_traceback_can_be_asked_for() -> None:
    done = command("run", "missing.yaml", "--traceback")
    assert done.returncode == 2
    assert "Traceback" in done.stderr
    assert "SceneError" in done.stderr


def test_an_interrupted_run_keeps_its_log(
    tmp_path: Path, stand_in: Any, monkeypatch: pytest.MonkeyPatch, swinging_cable: Any
) -> None:
    class Interrupted(swinging_cable):  # type: ignore[misc]
        def step_to(self, time: float, *args: Any, **kwargs: Any) -> None:
            if time > 3.0:
                raise KeyboardInterrupt
            super().step_to(time, *args, **kwargs)

    monkeypatch.setattr("cablemodel.model.CableModel", Interrupted)
    path = tmp_path / "run.mcap"
    result = invoke("run", SCENE, "--log", path)
    assert result.exit_code == 130
    assert f"up to t = 3 s, is in {path}" in result.stderr
    assert cm.open_run(path).reason == "interrupted"


def test_a_log_does_not_overwrite_the_scene(tmp_path: Path) -> None:
    scene = tmp_path / "scene.yaml"
    scene.write_bytes(SCENE.read_bytes())
    result = invoke("run", scene, "--log", scene)
    assert result.exit_code == 2
    assert "must end in .mcap" in result.stderr
    assert scene.read_bytes() == SCENE.read_bytes()


def test_a_log_given_for_a_scene_is_said(log: Path) -> None:
    result = invoke("check", log)
    assert result.exit_code == 2
    assert "it is the log of a run" in result.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_a_full_disk_is_said(tmp_path: Path) -> None:
    log = tmp_path / "run.mcap"
    log.symlink_to("/dev/full")
    result = invoke("run", SCENE, "--log", log)
    assert result.exit_code == 2
    assert "No space left" in result.stderr


@pytest.mark.skipif(os.name == "nt", reason="the platform has no locks of this kind")
def test_two_runs_with_one_log_leave_the_first_whole(tmp_path: Path) -> None:
    log = tmp_path / "run.mcap"
    script = (
        "import sys, cablemodel as cm\n"
        f"with cm.Recorder(cm.CableModel({str(SCENE)!r}), {str(log)!r}) as recorder:\n"
        "    print('writes', flush=True)\n"
        "    sys.stdin.readline()\n"
        "    recorder.step(1.0)\n"
    )
    with subprocess.Popen(
        [sys.executable, "-c", script],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, cwd=ROOT,
    ) as first:  # fmt: skip
        assert first.stdout is not None
        assert first.stdout.readline() == "writes\n"
        second = invoke("run", SCENE, "--until", "0.5", "--log", log)
        first.communicate("go on\n")
    assert first.returncode == 0
    assert second.exit_code == 2
    assert f"{log}: another run writes this log" in second.stderr
    run = cm.open_run(log)
    assert run.complete
    assert run.time.tolist() == [0.0, 1.0]


def said(result: Result) -> str:
    """Standard error without the frame of an option's error."""
    return " ".join(result.stderr.replace("│", " ").split())


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
@pytest.mark.parametrize(
    ("words", "ending"),
    [
        (["plot"], ".png"), (["plot"], ".svg"), (["report"], ".html"),
        (["export"], ".csv"), (["export"], ".nc"), (["export"], ".parquet"),
    ],
)  # fmt: skip
def test_a_full_disk_is_said_of_every_file(
    words: list[str], ending: str, log: Path, tmp_path: Path
) -> None:
    target = tmp_path / f"f{ending}"
    target.symlink_to("/dev/full")
    result = invoke(*words, log, "-o", target)
    assert result.exit_code == 2, result.output
    assert "cannot be written: No space left on device" in said(result)
    assert target.name in said(result)
    assert "defect" not in said(result)


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="needs a folder that takes no file")
@pytest.mark.parametrize("ending", [".png", ".csv", ".nc", ".parquet", ".fmu"])
def test_a_file_that_cannot_be_made_is_said(ending: str, log: Path) -> None:
    words: dict[str, list[Any]] = {
        ".png": ["plot", log],
        ".fmu": ["fmu", SCENE, "--platform", "linux64"],
    }
    if ending == ".fmu":
        pytest.importorskip("cablemodel_fmu")
    result = invoke(*words.get(ending, ["export", log]), "-o", f"/proc/x{ending}")
    assert result.exit_code == 2, result.output
    assert f"--output: /proc/x{ending} cannot be written: No such file" in said(result)


def test_a_table_and_pictures_that_cannot_be_written_are_said(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    import pandas

    def full(*_: Any, **__: Any) -> None:
        raise OSError(errno.ENOSPC, "a paragraph of a library")

    def swept(*_: Any, finished: Any, **__: Any) -> Any:
        table = pandas.DataFrame({"error": [""]})
        finished(1, table)
        return table

    table, picture = tmp_path / "t.csv", tmp_path / "p.png"
    monkeypatch.setattr("cablemodel.analysis.sweep.sweep", swept)
    monkeypatch.setattr("cablemodel.views.sweep_plot.save_sweep_figure", full)
    arguments = ["sweep", SCENE, "--over", "line.0.cable.length=20,30", "-o", table]
    result = invoke(*arguments, "--plot", picture)
    assert result.exit_code == 2
    assert "--plot" in said(result)
    assert "p.png cannot be written: No space left on device" in said(result)
    monkeypatch.setattr("cablemodel.analysis.sweep.write_table", full)
    result = invoke(*arguments)
    assert result.exit_code == 2
    assert "t.csv cannot be written: No space left on device" in said(result)
    monkeypatch.setattr("cablemodel.views.accuracy_plot.save_convergence_figure", full)
    options = ["--until", "0.5", "--tolerances", "1e-2", "--set", "solver.tolerance=0.01"]
    result = invoke("convergence", SCENE, *options, "--plot", picture)
    assert result.exit_code == 2
    assert "p.png cannot be written: No space left on device" in said(result)


def test_a_file_that_nobody_expected_to_fail_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    def denied(*_: Any) -> None:
        raise PermissionError(errno.EACCES, "Permission denied", "/some/file")

    monkeypatch.setattr("cablemodel.scene.scene_json_schema", denied)
    result = invoke("schema")
    assert result.exit_code == 2
    assert "/some/file: cannot be read or written: Permission denied" in result.stderr
    assert "defect" not in result.stderr


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_an_output_that_cannot_be_written_is_said() -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [sys.executable, "-m", "cablemodel", "schema"],
            stdout=full, stderr=subprocess.PIPE, text=True, check=False, cwd=ROOT,
        )  # fmt: skip
    assert done.returncode == 2
    assert done.stderr.startswith("cablemodel: a file, or the output, cannot be read or written: ")
    assert "Traceback" not in done.stderr


def test_check_says_what_a_scene_holds() -> None:
    result = invoke("check", SCENE)
    assert result.exit_code == 0, result.output
    words = " ".join(result.stdout.replace("│", " ").split())
    assert "30 m of cable K (elastica), 70 N in water" in words
    assert "70.000 N" in words
    assert "the third dimension" in words
    assert "No warnings." in words


@pytest.mark.parametrize(
    ("scene", "words"),
    [
        ("towed_cable", "static equilibrium"),
        ("depressor_tow", "steady state at 2.058 m/s"),
        ("cable_lay", "steady state at 1 m/s, with a pay-out of 1 m/s"),
        ("whip", "given shape"),
    ],
)
def test_check_says_what_the_start_is(scene: str, words: str) -> None:
    result = invoke("check", ROOT / "scenes" / f"{scene}.yaml")
    assert re.search(rf"│ start +│ {words} ", result.stdout), result.stdout


def test_a_study_of_a_system_names_what_there_is() -> None:
    result = invoke("convergence", ROOT / "scenes" / "systems" / "bridle_tow.yaml")
    assert result.exit_code == 2
    assert "allowed: cablemodel run SCENE --converge, or --error-estimate" in result.stderr


def test_check_as_json() -> None:
    report = json.loads(invoke("check", SCENE, "--json").stdout)
    assert report["line_length"] == 30.0
    assert report["planar"] is True
    assert report["start"]["top_tension"] == pytest.approx(70.0, abs=1e-3)
    assert report["start"]["tip_position"] == pytest.approx([0.0, 0.0, -30.001], abs=2e-3)
    assert report["warnings"] == []
    assert any(item.startswith("current") for item in report["skipped"])


def test_check_says_where_a_landing_bends_too_shortly_to_be_seen() -> None:
    """(EI/w)^(1/3) beside tau L; not at the tolerance that it names."""
    lay = ROOT / "scenes" / "cable_lay.yaml"
    words = "the bend where cable lands"
    report = json.loads(invoke("check", lay, "--json").stdout)
    (told,) = (item for item in report["skipped"] if item.startswith(words))
    assert "a tolerance of 0.0003 shows it" in told
    finer = json.loads(invoke("check", lay, "--set", "solver.tolerance=2.9e-4", "--json").stdout)
    assert not any(item.startswith(words) for item in finer["skipped"])


def test_check_names_what_is_not_skipped() -> None:
    report = json.loads(
        invoke(
            "check",
            ROOT / "scenes" / "turn.yaml",
            "--set",
            "environment.current=[0, 0.5, 0]",
            "--json",
        ).stdout
    )
    assert report["planar"] is False
    assert not any(item.startswith(("current", "the third")) for item in report["skipped"])


ROPE = "{cable: {type: K, length: 30}}"


@pytest.mark.parametrize(
    ("overrides", "words"),
    [
        (["run.output_interval=1000"], "only the start and the end"),
        (["cable_types.K.submerged_weight=-1"], "floats"),
        (["cable_types.K.axial_stiffness=1000"], "stretch"),
        (
            ["cable_types.K.bending_stiffness=0", "vessel.connection={clamped: [0, 0, -1]}"],
            "no effect",
        ),
        (["vessel.position=[0, 0, 5]"], "above z = 0"),
        (
            [f"line=[{ROPE}, {{body: {{mass: 9, submerged_weight: 40, drag_coefficient: 1}}}}]"],
            "a body has a drag_coefficient, but no drag_area: it has no effect",
        ),
        (
            [f"line=[{ROPE}, {{body: {{mass: 9, submerged_weight: 40, centre_offset: 0.5}}}}]"],
            "a body has a centre_offset, but no half_length: it has no effect",
        ),
        (
            [
                "vessel={path: [{straight: {duration: 9, speed: 0}}], interpolation: cubic}",
            ],
            "vessel.interpolation is between rows of velocity: a path is as it is",
        ),
        (
            [
                "environment.current={table: [{z: 0, velocity: [1, 0, 0]}, "
                "{z: 50, velocity: [0, 0, 0]}]}"
            ],
            "up to z = 50 m: z is up, and a depth of 50 m has z = -50",
        ),
        (["cable_types.K.drag_tangential=1.2"], "a coefficient on the diameter is to be divided"),
        (["cable_types.K.submerged_weight=0.238"], "or 2.333 N/m; kgf/m need their unit"),
        (
            [
                "vessel.velocity=[{t: 0, velocity: [0, 0, 0.1]}, {t: 2, velocity: [0, 0, -0.1]}, "
                "{t: 4, velocity: [0, 0, 0.1]}]"
            ],
            "velocity ends at 4 s, run.duration is 200 s: from then on it goes on at 0.1 m/s",
        ),
        (["cable_types.K.mass=100 t/km"], "density of"),
        (
            ["cable_types.K.mass=100 t/km", "cable_types.K.bending_stiffness=0"],
            "Of chain it is that of its volume, 1.8 times the bar's.",
        ),
        (["environment.water_density=1.025"], "t/m3 need their unit: 1.025 t/m3"),
        (["environment.water_density=0.998"], "t/m3 need their unit: 0.998 t/m3"),
        (["cable_types.K.submerged_weight=5"], "cable type K is heavier in water (5 N/m) than in"),
        (["cable_types.K.axial_stiffness=90"], "90 N; MN need their unit: 90 MN"),
        (
            ["environment.waves={regular: {height: 0.1, period: 5, direction: 90}}"],
            "waves.regular.direction: 90 rad is 14.3 turns; degrees need their unit: 90 deg",
        ),
        (
            ["environment.waves={jonswap: {hs: 0.1, tp: 5, direction: -90}}"],
            "waves.jonswap.direction: -90 rad is 14.3 turns; degrees need their unit: -90 deg",
        ),
    ],
)
def test_check_warns(overrides: list[str], words: str) -> None:
    options = [item for override in overrides for item in ("--set", override)]
    report = json.loads(invoke("check", SCENE, *options, "--json").stdout)
    assert any(words in warning for warning in report["warnings"]), report["warnings"]


STOPPED = """\
cable_types: {wire: {diameter: 36 mm, mass: 5, axial_stiffness: 60 MN}}
line:
  - cable: {type: wire, length: 1200}
  - body: {name: load, mass: 25000, submerged_weight: 200 kN}
payout:
  rate: [{t: 0, rate: 1.5}, {t: 2, rate: 1.5}, {t: 2.2, rate: 0}]
  drum: [{cable: {type: wire, length: 50}}]
solver: {tolerance: 1e-4}
"""


def test_check_warns_of_waves_that_a_winch_sends_along_undamped_wire() -> None:
    def warned_of(*overrides: str) -> list[str]:
        scene = cm.load_scene(STOPPED, overrides)
        model = cm.CableModel(scene)
        return [
            warning
            for warning in start_warnings(scene, model, model.state())
            if "without an end" in warning
        ]

    (warning,) = warned_of()
    assert "payout.rate changes by 1.5 m/s within 0.2 s at 2 s" in warning
    # masses between a winch that slows and a load that stands: the first mode of what is left
    count, length = 400, 1200.0
    h = length / count
    place = np.arange(1, count) * h
    moved, rate, dt = np.zeros(count - 1), np.zeros(count - 1), 2e-4
    for n in range(round(0.2 / dt)):
        top = 0.5 * (1.5 / 0.2) * (n * dt) ** 2
        ends = np.concatenate(([top], moved, [0.0]))
        rate += dt * 60e6 / (5.0 * h * h) * np.diff(ends, 2)
        moved += dt * rate
    turn = math.pi / length * math.sqrt(60e6 / 5.0)
    bends = 2.0 / count * np.sin(math.pi * place / length)
    held = bends @ (moved - 0.5 * 1.5 * 0.2 * (1.0 - place / length))
    moves = bends @ (rate - 1.5 * (1.0 - place / length))
    wave = 60e6 * math.pi / length * math.hypot(held, moves / turn)
    most = wave / math.sin(0.5 * turn * 0.2)  # both ends of the ramp add up
    assert float(warning.split("up to ")[1].split()[0]) == pytest.approx(most / 1e3, rel=0.05)
    needed = float(warning.split("axial_damping of ")[1].split()[0])
    assert not warned_of(f"cable_types.wire.axial_damping={1.01 * needed}")
    assert not warned_of("payout.rate.2.t=4")
    assert not warned_of("solver.tolerance=1e-3")  # all that is heard is followed


TURNED = """\
cable_types: {K: {diameter: 11 mm, mass: 0.45, axial_stiffness: 6 MN}}
line: [{cable: {type: K, length: 300}}, {body: {name: fish, mass: 50, submerged_weight: 300}}]
vessel: {path: [{straight: {duration: 60, speed: 3}}, {turn: {angle: 180 deg, radius: 100}}]}
run: {duration: 600}
"""


def warned(*overrides: str) -> list[str]:
    return scene_warnings(cm.load_scene(TURNED, overrides))


@pytest.mark.parametrize(
    ("override", "words"),
    [
        (
            "vessel.path.1.turn.angle=180",
            "vessel.path.1.turn.angle: 180 rad is 28.6 turns; degrees",
        ),
        ("vessel.path.0.straight.heading=90", "path.0.straight.heading: 90 rad is 14.3 turns"),
        ("vessel.path.0.straight.speed=60 kn", "moves at up to 30.9 m/s (60 knots)"),
        ("environment.current=[60, 0, 0]", "environment.current reaches 60 m/s (117 knots)"),
        ("payout.rate=-400", "payout.rate reaches -400 m/s: no winch is as fast"),
        (
            "cable_types.K={diameter: 500 mm, mass: 300, axial_stiffness: 90 MN}",
            "cable type K is 0.5 m thick; mm need their unit",
        ),
        (
            "line.1.body={mass: 50, submerged_weight: 300, half_length: 0.5, drag_area: 1}",
            "a body has a drag_area, but no drag along its axis",
        ),
        ("line.1.body.submerged_weight=600", "body fish is heavier in water (600 N) than in air"),
        (
            "cable_types.K.axial_stiffness=600",
            "under the line's own weight; is its axial stiffness",
        ),
        (
            "cable_types.K={diameter: 0.01, mass: 0.45, tension_strain: [1]}",
            "under the line's own weight; is its tension_strain right?",
        ),
        (
            "payout.rate=0.5",
            "holds 0 m, and payout.rate asks for 300 m within the run: it is empty at t = 0",
        ),
        (
            "payout={rate: 0.5, drum: [{cable: {type: K, length: 240}}]}",
            "holds 240 m, and payout.rate asks for 300 m within the run: it is empty at t = 480 s",
        ),
        (
            "payout.rate=[{t: 0, rate: -1}, {t: 10, rate: -1}, {t: 20, rate: 1}]",
            "holds 0 m, and payout.rate asks for 570 m within the run: it is empty at t = 30 s",
        ),
    ],
)
def test_a_slip_in_a_unit_is_seen(override: str, words: str) -> None:
    found = warned(override)
    assert len(found) == 1, found
    assert words in found[0]


@pytest.mark.parametrize(
    "overrides",
    [
        [],
        ["vessel.path.1.turn.angle=720 deg"],
        ["vessel.path.1.turn.angle=-6.28"],
        ["environment.water_density=0"],
        ["environment.water_density=1.2"],
        ["environment.water_density=1.025 t/m3"],
        ["line.1.body.submerged_weight=490.33"],  # of 50 kg, in vacuum
        ["payout={rate: 0.5, drum: [{cable: {type: K, length: 300}}]}"],
        ["payout.rate=[{t: 0, rate: -1}, {t: 300, rate: -1}, {t: 300.001, rate: 0.5}]"],
        ["payout.rate=[{t: 600, rate: 0}, {t: 700, rate: 1}]"],
        ["cable_types.K.axial_stiffness=6 kN"],
        # Most of it lies on the floor.
        ["cable_types.K.axial_stiffness=600", "environment.floor={z: -20}"],
    ],
)
def test_what_may_well_be_meant_is_no_slip(overrides: list[str]) -> None:
    assert warned(*overrides) == []


def test_a_stretch_is_told_once() -> None:
    report = json.loads(
        invoke("check", SCENE, "--set", "cable_types.K.axial_stiffness=90", "--json").stdout
    )
    assert len([w for w in report["warnings"] if "stretch" in w]) == 1, report["warnings"]


def told_of_a_start(scene: Path, words: str) -> str:
    """What `run` writes on standard error; `check` warns of the same start, in these words."""
    report = json.loads(invoke("check", scene, "--json").stdout)
    assert any(words in warning for warning in report["warnings"])
    result = invoke("run", scene)
    assert result.exit_code == 0, result.output
    return result.stderr


def test_a_start_at_rest_under_a_ship_that_moves_is_told(tmp_path: Path) -> None:
    scene = tmp_path / "tow.yaml"
    scene.write_text(
        "cable_types: {K: {diameter: 0.05, mass: 5.2, axial_stiffness: 60 MN}}\n"
        "line: [{cable: {type: K, length: 500}}]\n"
        "vessel: {velocity: [5 kn, 0, 0]}\n"
        "initial: {straight: [-0.9, 0, -0.44]}\n"
        "run: {duration: 0.01, output_interval: 0.01}\n"
    )
    told = told_of_a_start(scene, "at rest under a tow point that moves at 2.57222 m/s")
    assert told.count("the line is jerked along") == 1


def test_an_unstable_start_is_told_in_words(tmp_path: Path) -> None:
    """By `check` with its other findings, by a run on standard error, without the place in code."""
    scene = tmp_path / "sinker.yaml"
    scene.write_text(
        "cable_types: {K: {diameter: 0.03, mass: 0.55, submerged_weight: -4, drag_normal: 1.6,\n"
        "  axial_stiffness: 1.6 MN, drag_tangential: 0.08, added_mass: 0.8}}\n"
        "line: [{cable: {type: K, length: 200, model: cable}},\n"
        "       {body: {mass: 12, submerged_weight: 80}}]\n"
        "run: {duration: 0.01, output_interval: 0.01}\n"
        "solver: {tolerance: 1e-2}\n"
    )
    told = told_of_a_start(scene, "200 m along the cable")
    assert "cablemodel: warning: the static start is an unstable equilibrium" in told


@pytest.mark.parametrize(
    ("slope", "rate", "words"),
    [
        (-0.09, 1.0, "a lay down this slope takes 1.03"),
        (0.0, 0.97, "this lay takes 1 m/s and gets 0.97: it is taut, and starts with "),
    ],
)
def test_a_lay_that_is_or_becomes_taut_is_told_in_words(
    tmp_path: Path, slope: float, rate: float, words: str
) -> None:
    scene = tmp_path / "lay.yaml"
    scene.write_text(
        f"environment: {{floor: {{z: -100, friction: 0.5, slope: [{slope}, 0]}}}}\n"
        "cable_types: {K: {diameter: 0.02, mass: 0.8, axial_stiffness: 8 MN,\n"
        "  bending_stiffness: 5}}\n"
        "line: [{cable: {type: K, length: 400}}]\n"
        "vessel: {velocity: [1, 0, 0]}\n"
        f"payout: {{rate: {rate}, drum: [{{cable: {{type: K, length: 200}}}}]}}\n"
        "run: {duration: 0.01, output_interval: 0.01}\n"
    )
    told = told_of_a_start(scene, words)
    assert f"cablemodel: warning: {words}" in told
    assert "finite_element" not in told


def test_check_says_what_looks_wrong_where_there_is_no_start(tmp_path: Path) -> None:
    scene = tmp_path / "lay.yaml"
    scene.write_text(
        "environment: {floor: {z: -150}}\n"
        "cable_types: {power: {diameter: 80, mass: 12, axial_stiffness: 200 MN}}\n"  # mm were meant
        "line: [{cable: {type: power, length: 500}}]\n"
        "vessel: {velocity: [0.5, 0, 0]}\n"
        "payout: {rate: 0.5, drum: [{cable: {type: power, length: 3000}}]}\n"
    )
    result = invoke("check", scene)
    assert result.exit_code == 1
    assert "are its diameter (80 m)" in " ".join(result.stdout.split())
    assert "no static equilibrium" in result.stderr
    assert "Tried: without friction" in " ".join(result.stderr.split())
    result = invoke("run", scene)
    assert result.exit_code == 1
    assert "cablemodel: warning: cable type power has a density" in result.stderr
    assert "no static equilibrium" in result.stderr


def test_check_says_where_the_line_is_against_floor_and_vessel() -> None:
    lay = ROOT / "scenes" / "recovery.yaml"
    words = " ".join(invoke("check", lay).stdout.replace("│", " ").split())
    assert "on the drum 20 m of cable wire (hybrid), 78 N in water" in words
    assert "pay-out -0.5 to 0.48 m/s" in words
    assert "tow point (0, 0, 0) m, 0.5 m/s; at the end (10, 0, 0) m" in words
    assert "30.07 m on it, touchdown at (-92.090" in words
    start = json.loads(
        invoke("check", SCENE, "--set", "environment.floor={z: -50}", "--json").stdout
    )
    # 30 m hang from the surface, stretched by a millimetre.
    assert start["start"]["floor_clearance"] == pytest.approx(20.0, abs=2e-3)
    assert start["start"]["touchdown_position"] is None


def test_a_cable_on_the_drum_is_used(tmp_path: Path) -> None:
    drum = "payout={drum: [{cable: {type: W, length: 5}}], rate: 0.1}"
    kind = "cable_types.W={diameter: 0.01, mass: 0.2, axial_stiffness: 1e6}"
    report = json.loads(invoke("check", SCENE, "--set", kind, "--set", drum, "--json").stdout)
    assert not any("not used" in warning for warning in report["warnings"])
    assert report["drum"][0]["length"] == 5.0


def test_schema_is_a_json_schema() -> None:
    schema = json.loads(invoke("schema").stdout)
    assert schema["$schema"].startswith("https://json-schema.org/")
    assert {"line", "cable_types", "environment"} <= set(schema["properties"])


def test_info_says_what_a_log_holds(log: Path) -> None:
    result = invoke("info", log)
    assert result.exit_code == 0, result.output
    assert "/cable/tension_top" in result.stdout
    report = json.loads(invoke("info", log, "--json").stdout)
    assert report["complete"] is True
    counts = {channel["topic"]: channel["messages"] for channel in report["channels"]}
    assert counts["/cable/tension_top"] == counts["/cable/state"] == 41
    assert counts["/cable/applied_inputs"] == 40
    assert report["metadata"]["cablemodel"] == cm.__version__


def test_info_says_that_a_log_was_cut(log: Path) -> None:
    log.write_bytes(log.read_bytes()[:-2000])
    result = invoke("info", log)
    assert result.exit_code == 0
    assert "end of the file is missing" in " ".join(result.stdout.replace("│", " ").split())


def test_plot_draws_a_picture(log: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    assert invoke("plot", log).exit_code == 0
    assert log.with_suffix(".png").read_bytes().startswith(b"\x89PNG")
    result = invoke("plot", log, "-o", tmp_path / "figure.svg")
    assert str(tmp_path / "figure.svg") in result.stdout
    assert (tmp_path / "figure.svg").read_bytes().startswith(b"<?xml")


def test_plot_of_a_cut_run_says_so(log: Path) -> None:
    pytest.importorskip("matplotlib")
    log.write_bytes(log.read_bytes()[:-2000])
    result = invoke("plot", log)
    assert result.exit_code == 0
    assert "not complete" in result.stderr


def test_version() -> None:
    assert invoke("--version").stdout == f"cablemodel {cm.__version__}\n"


def test_help_names_every_command() -> None:
    text = invoke("--help").stdout
    names = {command.name for command in app.registered_commands}
    assert {name for name in names if f"│ {name} " in text} == names


def test_help_loads_no_heavy_library() -> None:
    heavy = ("numba", "matplotlib", "pint", "scipy", "mcap", "rosbags", "plotly")
    code = (
        "import runpy, sys\n"
        "sys.argv = ['cablemodel', '--help']\n"
        "try:\n"
        "    runpy.run_module('cablemodel', run_name='__main__')\n"
        "except SystemExit as end:\n"
        "    assert not end.code\n"
        f"print([name for name in {heavy!r} if name in sys.modules], file=sys.stderr)\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stderr.strip() == "[]"


def test_a_terminal_sees_progress(tmp_path: Path) -> None:
    leader, follower = pty.openpty()
    environment = {**os.environ, "TERM": "xterm", "COLUMNS": "160"}
    with subprocess.Popen(
        [sys.executable, "-m", "cablemodel", "run", str(SCENE)],
        stdout=subprocess.PIPE, stderr=follower, env=environment,
    ) as process:  # fmt: skip
        os.close(follower)
        seen = b""
        while True:
            try:
                part = os.read(leader, 65536)
            except OSError:  # Linux's way of saying that the other side is closed
                break
            if not part:
                break
            seen += part
        assert process.stdout is not None
        summary = process.stdout.read().decode()
    os.close(leader)
    text = seen.decode(errors="replace")
    assert process.returncode == 0
    for words in ("of 200 s", "× real time", "top tension 94.6 N", "steps", "iterations"):
        assert words in text
    assert "simulated time" in summary


def test_the_example_of_the_readme_agrees_with_the_closed_form(tmp_path: Path) -> None:
    log = tmp_path / "tow.mcap"
    assert command("run", SCENE, "--log", log, "--quiet").returncode == 0
    done = subprocess.run(
        [sys.executable, ROOT / "examples" / "towed_cable.py", log],
        capture_output=True, text=True, check=False, env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert "94.6082" in done.stdout


def test_the_example_refuses_a_run_that_is_not_steady(log: Path) -> None:
    done = subprocess.run(
        [sys.executable, ROOT / "examples" / "towed_cable.py", log],
        capture_output=True, text=True, check=False, env={**os.environ, "PYTHONPATH": str(ROOT)},
    )  # fmt: skip
    assert done.returncode != 0
    assert "not that of the closed form" in done.stderr


def test_a_long_start_says_why(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("cablemodel.solvers.library.library_path", lambda: Path("library"))
    monkeypatch.setattr("cablemodel.cli.run._LONG_START", 0.01)

    class BeganError(Exception):
        """The equilibrium is sought."""

    def begin(*_: object) -> None:
        time.sleep(0.3)
        raise BeganError

    monkeypatch.setattr("cablemodel.solvers.library.equilibrium", begin)
    scene = cm.load_scene(SCENE)
    with pytest.raises(BeganError), explained_start(quiet=True):
        cm.CableModel(scene)
    assert capsys.readouterr().err == ""
    with pytest.raises(BeganError), explained_start(quiet=False):
        cm.CableModel(scene)
    assert "static start" in capsys.readouterr().err


def test_compiling_is_told_on_standard_error(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("cablemodel.solvers.library.LONG", 0.01)
    for quiet in (True, False):
        (kernel,) = library.telling({"step": SlowKernel()}).values()
        with explained_start(quiet=quiet):
            kernel.compile(None)
        assert (library.COMPILING in capsys.readouterr().err) == (not quiet)


class SlowKernel:
    """What numba makes of a kernel, as far as `telling` knows it."""

    def compile(self, signature: object) -> str:
        time.sleep(0.2)
        return f"compiled for {signature}"


def test_a_wait_for_tables_is_not_blamed_on_the_start(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("cablemodel.solvers.library.library_path", lambda: Path("library"))
    monkeypatch.setattr("cablemodel.cli.run._LONG_START", 0.01)
    with explained_start(quiet=False):
        time.sleep(0.3)
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize("system", [False, True])
def test_a_wait_after_the_start_is_not_blamed_on_it(
    system: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As for a log that begins with a long table: the clock runs while a start is sought."""

    class Clock:
        daemon = False

        def __init__(self, _after: float, tell: Callable[[], None]) -> None:
            self.tell, self.runs = tell, False
            clocks.append(self)

        def start(self) -> None:
            self.runs = True

        def cancel(self) -> None:
            self.runs = False

    clocks: list[Clock] = []
    monkeypatch.setattr("cablemodel.solvers.library.library_path", lambda: Path("library"))
    monkeypatch.setattr("cablemodel.cli.run.threading.Timer", Clock)
    at_work = []
    sought = library.equilibrium

    def seek(*given: Any) -> Any:
        at_work.append([clock.runs for clock in clocks])
        return sought(*given)

    monkeypatch.setattr("cablemodel.solvers.library.equilibrium", seek)
    path = ROOT / "scenes" / "systems" / "cage_on_its_winch.yaml"
    with explained_start(quiet=False) as started:
        for times in (1, 2):  # one more run, as of an estimate of errors, has a start of its own
            if system:
                cm.SystemModel(load_system(path))
            else:
                cm.CableModel(cm.load_scene(SCENE))
            assert [clock.runs for clock in clocks] == [False] * times
        started()
        assert all(running[-1] and not any(running[:-1]) for running in at_work)
        before = len(clocks)
        cm.CableModel(cm.load_scene(SCENE))
        assert len(clocks) == before


def test_checks_see_a_system_that_goes_too_fast() -> None:
    """A winch and a current, as of one line."""
    path = ROOT / "scenes" / "systems" / "cage_on_its_winch.yaml"
    assert not any("is it right?" in word for word in system_warnings(load_system(path)))
    rate = "[{t: 0, rate: 0}, {t: 10, rate: -400}]"
    fast = load_system(path, [f"winches.winch.rate={rate}", "environment.current=[30, 0, 0]"])
    found = "\n".join(system_warnings(fast))
    assert "winches.winch.rate reaches -400 m/s: no winch is as fast" in found
    assert "environment.current reaches 30 m/s (58.3 knots)" in found


def test_checks_see_lines_of_a_system_that_are_too_short_or_in_the_air(tmp_path: Path) -> None:
    """A tie to the ground that lacks 80 m, from a fairlead 5 m above the water."""
    scene: dict[str, Any] = {
        "cable_types": {"wire": {"diameter": 0.02, "mass": 1.56, "axial_stiffness": 18e6}},
        "vessels": {"ship": {"points": {"eye": [0, 0, 5]}}},
        "bodies": {
            "load": {
                "mass": 600,
                "submerged_weight": 4e3,
                "inertia": 100,
                "points": {"eye": [0] * 3},
            }
        },
        "lines": {
            "hoist": {
                "from": "ship.eye",
                "to": "load.eye",
                "items": [{"cable": {"type": "wire", "length": 60}}],
            },
            "tie": {
                "from": {"anchor": [0, 0, -195]},
                "to": "load.eye",
                "items": [{"cable": {"type": "wire", "length": 60}}],
            },
        },
    }
    path = tmp_path / "tied.yaml"
    path.write_text(json.dumps(scene))
    words = invoke("check", path).output
    for line in ("hoist", "tie"):
        found = re.search(rf"stretch by (\S+) % under the highest tension of lines.{line} ", words)
        assert found
        assert float(found[1]) == pytest.approx(100 * (200 / 120 - 1), rel=0.01)
    assert "lines.hoist reaches 5 m above z = 0" in words
    scene["lines"]["tie"]["items"][0]["cable"]["length"] = 145
    scene["vessels"]["ship"]["points"]["eye"] = [0, 0, 0]
    path.write_text(json.dumps(scene))
    words = invoke("check", path).output
    assert "warning:" not in words


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({}, True),
        ({"rate": 3.0}, False),
        ({"bending": 0.0}, False),
        ({"start": {"straight": [-1, 0, -0.1]}}, False),
        ({"floor": -500.0}, False),  # the line is let down to it, and lies nowhere
    ],
)
def test_slack_that_has_to_fold_what_lies_straight_is_told(
    change: dict[str, Any], told: bool
) -> None:
    """Top tension falls by half within the first second of such a lay, as what lies is pushed."""
    given = {"rate": 3.15, "bending": 150.0, "start": "static", "floor": -50.0} | change
    kind = {"diameter": 0.035, "mass": 3.2, "axial_stiffness": 5e7}
    kind["bending_stiffness"] = given["bending"]
    scene = cm.load_scene(
        {
            "environment": {"floor": {"z": given["floor"], "friction": 0.5}},
            "cable_types": {"K": kind},
            "line": [{"cable": {"type": "K", "length": 253.4}}],
            "vessel": {"velocity": [3.0, 0.0, 0.0]},
            "payout": {
                "rate": given["rate"],
                "drum": [{"cable": {"type": "K", "length": 300.0}}],
            },
            "initial": given["start"],
            "run": {"duration": 60.0},
        }
    )
    model = cm.CableModel(scene)
    found = start_warnings(scene, model, model.state())
    assert any("until it has folded" in each for each in found) == told


@pytest.mark.parametrize(
    ("override", "place"),
    [
        ("bodies.depressor.attitude=[0, 0, 90]", "bodies.depressor.attitude"),
        ("vessels.ship.attitude=[0, 0, 45]", "vessels.ship.attitude"),
        (
            "environment.waves={regular: {height: 1, period: 6, direction: 90}}",
            "environment.waves.regular.direction",
        ),
    ],
)
def test_angles_of_a_system_without_their_unit_are_seen(override: str, place: str) -> None:
    from cablemodel.systems import read_scene

    scene = read_scene(ROOT / "scenes" / "systems" / "depressor.yaml", [override])
    (told,) = (word for word in system_warnings(scene) if "turns" in word)
    assert told.startswith(f"{place}: ")


@pytest.mark.parametrize("angle", ["wing.deflection=10", "tail.stall=15"])
def test_angles_of_a_foil_without_their_unit_are_refused(angle: str) -> None:
    from cablemodel.systems import read_scene

    place, value = f"bodies.depressor.foils.{angle}".split("=")
    with pytest.raises(cm.SceneError, match=f"{place}: {value} is out of range.* with a unit"):
        read_scene(ROOT / "scenes" / "systems" / "depressor.yaml", [f"{place}={value}"])
