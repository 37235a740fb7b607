"""The command ``cablemodel fmu`` and the examples of docs/fmu.md."""

import os
import re
import resource
import runpy
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from fmpy import simulate_fmu

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "scenes" / "towed_cable.yaml"


def command(*arguments, folder):
    return subprocess.run(
        [sys.executable, "-m", "cablemodel", "fmu", *map(str, arguments)],
        capture_output=True,
        text=True,
        cwd=folder,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )


def test_export_takes_less_than_three_seconds(tmp_path):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = command(SCENE, "-o", "tow.fmu", folder=tmp_path)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    assert done.returncode == 0, done.stderr
    assert "tow.fmu" in done.stdout
    assert after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime < 3.0
    names = zipfile.ZipFile(tmp_path / "tow.fmu").namelist()
    assert {
        "modelDescription.xml",
        "model.png",
        "resources/model.bin",
        "resources/scene.yaml",
        "documentation/index.html",
        "documentation/licenses/cablemodel-Apache-2.0.txt",
        "documentation/licenses/fmi-headers-BSD-2-Clause.txt",
        "documentation/licenses/mingw-w64-ZPL-2.1.txt",
        "documentation/licenses/zig-MIT.txt",
        "binaries/linux64/cablemodel.so",
        "binaries/win64/cablemodel.dll",
        "binaries/darwin64/cablemodel.dylib",
    } == set(names)


def test_the_same_scene_gives_the_same_file(tmp_path, monkeypatch):
    """At the same date, which is now or that of reproducible builds."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    for name in ("a.fmu", "b.fmu"):
        assert command(SCENE, "-o", name, "--platform", "linux64", folder=tmp_path).returncode == 0
    assert (tmp_path / "a.fmu").read_bytes() == (tmp_path / "b.fmu").read_bytes()
    with zipfile.ZipFile(tmp_path / "a.fmu") as archive:
        description = archive.read("modelDescription.xml")
    assert b'generationDateAndTime="2023-11-14T22:13:20Z"' in description


def test_the_scene_inside_loads_again_and_can_be_changed(tmp_path):
    import cablemodel as cm

    done = command(
        SCENE, "-o", "tow.fmu", "--platform", "linux64", "--set", "line.0.cable.length=40",
        "--stations", 5, folder=tmp_path,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    with zipfile.ZipFile(tmp_path / "tow.fmu") as archive:
        scene = cm.load_scene(archive.read("resources/scene.yaml").decode())
        assert b"line.tension[5]" in archive.read("modelDescription.xml")
        assert b"line.tension[6]" not in archive.read("modelDescription.xml")
        page = archive.read("documentation/index.html").decode()
    assert scene.line_length == 40.0
    assert "line.tension[5]" in page
    assert "length: 40" in page


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((SCENE, "--platform", "linux32"), "linux32"),
        ((SCENE, "--stations", "1"), "stations"),
        (("missing.yaml",), "missing.yaml"),
    ],
)
def test_what_cannot_be_exported(tmp_path, arguments, words):
    done = command(*arguments, folder=tmp_path)
    assert done.returncode != 0
    assert words in done.stderr
    assert "Traceback" not in done.stderr
    assert list(tmp_path.iterdir()) == []


def test_the_example_of_a_vessel_comes_to_a_balance(capsys):
    """Thrust, resistance and the cable's pull balance within 1 %, slower than without the cable."""
    example = runpy.run_path(str(ROOT / "examples" / "vessel_and_cable.py"))
    rows = example["main"]([])
    _, speed, pull, _ = rows[-1]
    thrust, resistance = example["THRUST"], example["RESISTANCE"]
    assert abs(thrust + pull - resistance * speed**2) < 0.01 * thrust
    assert 0.5 < speed < (thrust / resistance) ** 0.5
    assert "speed" in capsys.readouterr().out


def test_the_recipe_for_fmpy_drives_it_as_python_does(tmp_path, monkeypatch, capsys):
    """A step early, for fmpy holds inputs: what the page says of both ways is so."""
    import cablemodel as cm

    done = command(SCENE, "-o", "tow.fmu", "--platform", "linux64", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    page = (ROOT / "docs" / "fmu.md").read_text(encoding="utf-8")
    section = page.split("## In fmpy\n")[1].split("\n## ")[0]
    monkeypatch.chdir(tmp_path)
    names = {}
    for block in re.findall(r"```python\n(.*?)```", section, flags=re.DOTALL):
        exec(compile(block, "docs/fmu.md", "exec"), names)
    assert names["result"]["tension.top"][-1] == pytest.approx(94.6, abs=0.05)

    model = cm.CableModel(cm.load_scene(SCENE))
    series, pulls = names["series"], [model.top_tension]
    for speed in series["vessel.velocity[1]"][1:]:
        model.step(0.5, vessel_velocity=(speed, 0, 0), payout_rate=0.0, current=(0, 0, 0))
        pulls.append(model.top_tension)
    np.testing.assert_allclose(names["driven"]["tension.top"], pulls, rtol=1e-9)

    ways = {"input": series, "stop_time": 60, "output_interval": 0.5}
    ways["start_values"] = {"use_scene_inputs": False}
    with pytest.raises(ValueError, match="Can only assign sequence of same size"):
        simulate_fmu("tow.fmu", set_input_derivatives=True, **ways)
    series["time"] += 0.5
    late = simulate_fmu("tow.fmu", **ways)["tension.top"]
    assert np.abs(late - pulls).max() > 0.01 * np.max(pulls)
