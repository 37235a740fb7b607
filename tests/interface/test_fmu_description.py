"""What an FMU says about itself: units, sizes, limits, who made it and when, how it looks."""

import struct
import zipfile
import zlib
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from fmpy import read_model_description
from fmu_tools import CABLE, Slave, still_scene, unpacked

import cablemodel as cm
from cablemodel_fmu.documentation import picture
from cablemodel_fmu.export import export_fmu

SCENES = Path(__file__).parents[2] / "scenes"


@pytest.fixture(scope="module")
def described(tmp_path_factory):
    path = tmp_path_factory.mktemp("fmu") / "cable.fmu"
    scene = cm.load_scene(SCENES / "cable_lay.yaml")
    return export_fmu(scene, path, platforms=["linux64"], author="A. Rigger")


def test_author_and_date(described, monkeypatch, tmp_path):
    root = ElementTree.fromstring(zipfile.ZipFile(described).read("modelDescription.xml"))
    assert root.get("author") == "A. Rigger"
    assert root.get("generationDateAndTime").endswith("Z")
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "0")
    export_fmu(still_scene(), tmp_path / "x.fmu", platforms=["linux64"])
    root = ElementTree.fromstring(zipfile.ZipFile(tmp_path / "x.fmu").read("modelDescription.xml"))
    assert root.get("generationDateAndTime") == "1970-01-01T00:00:00Z"
    assert root.get("author") is None


def test_sizes_units_and_limits(described):
    """10 km of cable in 3,000 m: positions of kilometres, tensions of kilonewtons, speeds in knots;
    every real variable has a nominal value, and every input limits."""
    variables = {v.name: v for v in read_model_description(str(described)).modelVariables}
    reals = [v for v in variables.values() if v.type == "Real"]
    assert all(v.nominal and float(v.nominal) > 0.0 for v in reals if v.unit != "1")
    assert 1e3 < float(variables["end.position[1]"].nominal) < 3e4
    assert float(variables["tension.top"].nominal) > 1e3
    assert variables["vessel.velocity[1]"].displayUnit == "kn"
    assert variables["tension.top"].displayUnit == "kN"
    driven = [v for v in variables.values() if v.causality == "input"]
    assert len(driven) == 10
    assert all(float(v.min) < float(v.start) < float(v.max) for v in driven)
    factor = {"kn": 3600 / 1852, "kN": 1e-3}
    root = ElementTree.fromstring(zipfile.ZipFile(described).read("modelDescription.xml"))
    shown = {d.get("name"): float(d.get("factor")) for d in root.iter("DisplayUnit")}
    assert {name: shown[name] for name in factor} == pytest.approx(factor)


def test_limits_are_those_that_hold(tmp_path):
    with unpacked(still_scene(), tmp_path) as found:
        slave = Slave(*found)
        for name in ("vessel.velocity[1]", "vessel.position[2]", "payout.rate"):
            for limit in (slave.references[name].min, slave.references[name].max):
                slave.set(name, float(limit))
                with pytest.raises(Exception, match="fmi2SetReal"):
                    slave.set(name, 1.001 * float(limit))
        slave.close()


def test_the_notices_of_what_is_linked_are_in_it(described):
    names = zipfile.ZipFile(described).namelist()
    assert "documentation/licenses/zig-MIT.txt" in names
    assert "documentation/licenses/mingw-w64-ZPL-2.1.txt" in names
    page = zipfile.ZipFile(described).read("documentation/index.html").decode()
    assert "compiler runtime (MIT)" in page


def pixels(png: bytes) -> np.ndarray:
    """Of an 8-bit RGB image whose rows are not filtered, (rows, columns, 3)."""
    width, height = struct.unpack(">II", png[16:24])
    at, data = 8, b""
    while at < len(png):
        (size,) = struct.unpack(">I", png[at : at + 4])
        if png[at + 4 : at + 8] == b"IDAT":
            data += png[at + 8 : at + 8 + size]
        at += size + 12
    rows = np.frombuffer(zlib.decompress(data), np.uint8).reshape(height, 1 + 3 * width)
    return rows[:, 1:].reshape(height, width, 3).astype(int)


@pytest.mark.parametrize("name", ["towed_cable", "release_in_water", "cable_lay", "deployment"])
def test_the_icon_shows_the_line(name):
    """From end to end of most of the picture, and dark on whatever is behind it: hanging, level at
    the surface, laid on a floor, with bodies."""
    image = pixels(picture(cm.load_scene(SCENES / f"{name}.yaml")))
    dark = image.sum(axis=2) < 150
    assert dark.sum() > 250
    rows, columns = np.nonzero(dark)
    assert max(np.ptp(rows), np.ptp(columns)) > 0.6 * len(image)


def test_the_largest_tension_is_not_below_that_at_the_tow_point(tmp_path):
    """A stiff line that is bent at its clamp, and swung: the force at the top has shear, too."""
    stiff = {**CABLE, "bending_stiffness": 200.0}
    scene = still_scene(
        cable_types={"K": stiff},
        vessel={"connection": {"clamped": [1, 0, 0]}},
        line=[{"cable": {"type": "K", "length": 20, "model": "elastica"}}],
        payout={},
    )
    sheared = 0
    with unpacked(scene, tmp_path) as found:
        slave, model = Slave(*found), cm.CableModel(scene)
        for n in range(40):
            velocity = (0.0, 0.0, 1.0 * np.cos(0.8 * n))
            slave.set("vessel.velocity", velocity)
            slave.step(0.2)
            model.step(0.2, velocity, payout_rate=0.0, current=(0, 0, 0))
            assert slave.get("tension.max") >= slave.get("tension.top")
            assert model.tension_max == slave.get("tension.max")
            sheared += slave.get("tension.top") > 1.001 * np.max(model.state().tension)
        slave.close()
    assert sheared > 0
