"""The wheel in clean environments, outside of the sources: it brings the compiled library, and runs
with every Python that it says it supports, and with the oldest packages that it accepts."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import zipfile
from pathlib import Path
from shutil import copy, which

import pytest

from cablemodel.cli.new import TEMPLATES
from cablemodel.solvers import library

ROOT = Path(__file__).parents[2]
SCENE = ROOT / "scenes" / "towed_cable.yaml"

pytestmark = pytest.mark.skipif(
    library.library_path() is None, reason="the library is not built: make native"
)


def uv(*arguments: str | Path) -> None:
    """uv, with what pip would find; without network, from what it has stored."""
    command = [sys.executable, "-m", "uv", *map(str, arguments)]
    # It could fetch interpreters from places of its own.
    plain = {**os.environ, "UV_PYTHON_DOWNLOADS": "never"}
    done = subprocess.run(command, capture_output=True, text=True, env=plain)
    if done.returncode != 0 and "error sending request" in done.stderr:
        offline = {**plain, "UV_OFFLINE": "1"}
        done = subprocess.run(command, capture_output=True, text=True, env=offline)
        if done.returncode != 0:
            pytest.skip("no network, and not all that is needed is stored")
    assert done.returncode == 0, done.stderr


def interpreter(version: str) -> Path:
    """A Python of this version: this one, on the path, or one of pyenv."""
    if sys.version_info[:2] == tuple(map(int, version.split("."))):
        return Path(sys.executable)
    found = [which(f"python{version}")]
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv"))
    found += [str(path) for path in sorted(pyenv.glob(f"versions/{version}.*/bin/python"))]
    for path in filter(None, found):
        # Pyenv puts commands on the path that say that there is no such Python.
        if subprocess.run([path, "-c", ""], capture_output=True).returncode == 0:
            return Path(path)
    pytest.skip(f"no Python {version}")


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("dist")
    uv("build", "--wheel", "--out-dir", folder, ROOT)
    (found,) = folder.glob("*.whl")
    return found


def test_the_wheel_brings_the_library_and_is_named_for_what_it_holds(wheel: Path) -> None:
    names = zipfile.ZipFile(wheel).namelist()
    held = {
        parts[2]
        for parts in (Path(name).parts for name in names)
        if parts[:2] == ("cablemodel", "binaries")
    }
    assert {f"cablemodel/cli/templates/{path.name}" for path in TEMPLATES.iterdir()} <= set(names)
    assert library.platform_name() in held
    assert wheel.stem.endswith("-any") == (len(held) == 4)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("version", "resolution"),
    [("3.11", "highest"), ("3.12", "lowest-direct"), ("3.13", "highest")],
)
def test_an_installed_wheel_runs_a_scene(
    version: str, resolution: str, wheel: Path, tmp_path: Path
) -> None:
    uv("venv", "--python", interpreter(version), tmp_path / "env")
    python = tmp_path / "env" / "bin" / "python"
    chosen = ("--python", python, "--only-binary", ":all:", "--resolution", resolution)
    # Lowest are the bounds that are written there, not those of what needs what.
    uv("pip", "install", *chosen, "--requirement", ROOT / "pyproject.toml", wheel)
    copy(SCENE, tmp_path)
    outside = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}

    def run(*command: str | Path) -> str:
        done = subprocess.run(
            list(map(str, command)), cwd=tmp_path, env=outside, capture_output=True, text=True
        )
        assert done.returncode == 0, done.stderr
        assert done.stderr == ""
        return done.stdout

    code = (
        "import sys, numpy, cablemodel as cm; from cablemodel.solvers import library; "
        f"cm.CableModel(cm.load_scene('{SCENE.name}')).step(1.0); "
        "print(cm.__file__, library.library_path(), 'numba' in sys.modules, numpy.__version__)"
    )
    package, compiled, numba, numpy = run(python, "-c", code).split()
    assert Path(package).is_relative_to(tmp_path)
    assert Path(compiled).is_relative_to(tmp_path)
    assert numba == "False"
    assert numpy.startswith("1.26.") == (resolution != "highest")

    cablemodel = python.with_name("cablemodel")
    summary = json.loads(run(cablemodel, "run", SCENE.name, "--log", "run.mcap", "--json"))
    assert summary["top_tension"] == pytest.approx(94.61, abs=0.01)  # the closed form
    run(cablemodel, "info", "run.mcap")
    own = str(library.platform_name())
    run(cablemodel, "fmu", SCENE.name, "--output", "tow.fmu", "--platform", own)
    assert f"binaries/{own}/cablemodel.so" in zipfile.ZipFile(tmp_path / "tow.fmu").namelist()
