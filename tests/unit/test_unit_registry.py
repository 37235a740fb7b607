"""Pint's registry is kept on disk: the same units, whatever becomes of what is kept."""

import os
import subprocess
import sys

import pint
import pytest

from cablemodel.scene.units import kept_registry

UNITS = "mm", "km", "kN", "MN/m", "kg/m", "tonne", "knot", "deg", "kPa", "ft", "lbf", "min", "N m2"


def factors(units):
    return [units.parse_expression(unit.replace(" m2", "*m**2")).to_base_units() for unit in UNITS]


def magnitudes(units):
    return [quantity.magnitude for quantity in factors(units)]


@pytest.fixture(scope="module")
def wanted():
    return magnitudes(pint.UnitRegistry())


def test_it_is_kept_and_read_again(tmp_path, wanted):
    folder = tmp_path / "new" / "pint"
    assert magnitudes(kept_registry(folder)) == wanted
    files = {path: path.stat().st_mtime_ns for path in folder.iterdir()}
    assert any(path.suffix == ".pickle" for path in files)
    assert [path.name for path in folder.parent.iterdir()] == ["pint"]
    assert magnitudes(kept_registry(folder)) == wanted
    assert {path: path.stat().st_mtime_ns for path in folder.iterdir()} == files


def test_without_a_place_nothing_is_kept(tmp_path, wanted):
    (tmp_path / "file").touch()
    assert magnitudes(kept_registry(tmp_path / "file" / "pint")) == wanted


def test_what_is_spoilt_is_made_anew(tmp_path, wanted):
    folder = tmp_path / "pint"
    kept_registry(folder)
    sizes = {path: path.stat().st_size for path in folder.iterdir()}
    for path in folder.glob("*.pickle"):
        path.write_bytes(path.read_bytes()[: sizes[path] // 2])
    assert magnitudes(kept_registry(folder)) == wanted
    assert {path: path.stat().st_size for path in folder.iterdir()} == sizes


def test_another_process_may_be_first(tmp_path, wanted, monkeypatch):
    folder = tmp_path / "pint"
    make = pint.UnitRegistry

    def meanwhile(**options):
        if not folder.exists():
            folder.mkdir()
            (folder / "of another").touch()
        return make(**options)

    monkeypatch.setattr(pint, "UnitRegistry", meanwhile)
    assert magnitudes(kept_registry(folder)) == wanted
    assert [path.name for path in folder.iterdir()] == ["of another"]
    assert [path.name for path in tmp_path.iterdir()] == ["pint"]


def test_processes_that_begin_at_once_all_read_their_units(tmp_path):
    code = "import cablemodel.scene.units as u; print(u._registry().parse_expression('12 mm').m)"
    environment = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(sys.path),
        "CABLEMODEL_CACHE_DIR": str(tmp_path),
    }
    running = [
        subprocess.Popen(
            [sys.executable, "-c", code],
            env=environment,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        for _ in range(4)
    ]
    for process in running:
        out, errors = process.communicate(timeout=120)
        assert (process.returncode, out.strip()) == (0, "12"), errors
    (kept,) = tmp_path.iterdir()
    assert any(kept.iterdir())
