"""Decks of MoorDyn: what is taken from them, and what is refused or told by name."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from decks import every_change
from scipy.optimize import fsolve
from typer.testing import CliRunner, Result

import cablemodel as cm
from benchmarks.peers.moordyn import Settings, input_file
from benchmarks.scenes import SCENES
from cablemodel.cli import app
from cablemodel.moordyn_deck import read_deck
from cablemodel.scene.sea import sea

FLOAT = """\
---------------------- MoorDyn Input File ----------------------
A rope with a float above an anchor.
---------------------- LINE TYPES ----------------------
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
chain 0.144 126 5e8 -1.0 0 1.33 1.0 0.2 0.5   ! not of this line
rope 0.02 0.5 2e5 -0.8 0 1.2 1.1 0.02 0       # of this one
---------------------- POINTS ----------------------
ID Attachment X Y Z Mass Volume CdA Ca
(#) (word/ID) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Fixed 3 4 -100 0 0 0 0
2 Free 3 4 -40 50 0.1 0.2 0.5
3 Coupled 100 0 0 0 0 0 0
4 Fixed 700 0 -200 0 0 0 0
---------------------- LINES ----------------------
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (ID) (ID) (m) (-) (-)
1 rope 1 2 60 60 p
2 chain 4 3 660 60 -
---------------------- OPTIONS ----------------------
2 writeLog
0.5 cfl
3e5 kBot
120 WtrDpth
9.8 g
1020 WtrDnsty
7 fancy
---------------------- OUTPUTS ----------------------
FairTen1
---------------------- need this line ----------------------
"""


def invoke(*arguments: str | Path) -> Result:
    """On a screen so wide that no folder of a test breaks a message."""
    return CliRunner(env={"COLUMNS": "300"}).invoke(app, [str(item) for item in arguments])


def test_a_float_pulls_as_its_buoyancy_says() -> None:
    text, left = read_deck(FLOAT, "float.txt", 1)
    scene = cm.load_scene(text)
    model = cm.CableModel(scene)
    g, rho = 9.8, 1020.0
    lift = g * (0.1 * rho - 50.0)
    weight = g * (0.5 - rho * math.pi / 4.0 * 0.02**2)
    assert model.top_tension == pytest.approx(lift - 60.0 * weight, rel=1e-9)
    stretch = 60.0 * (lift - 30.0 * weight) / 2e5
    assert model.tip_position == pytest.approx([3.0, 4.0, -40.0 + stretch], abs=1e-6)
    (body,) = scene.bodies
    assert body.added_mass == body.added_mass_axial == pytest.approx(0.05 * rho)
    assert (body.half_length, body.drag_area, body.drag_coefficient) == (0.0, 0.2, 1.0)
    assert scene.environment.floor is not None
    assert scene.environment.floor.z == -200.0  # as low as the lowest point
    assert left == [
        "option fancy (7), which is not known",
        "kBot: the floor is rigid, its friction that of Coulomb",
        "numerics and output of MoorDyn: writeLog, cfl",
        "the other lines: 2",
        "BA/-zeta (-0.8): damping of MoorDyn's segments, by their size",
        "the free point's place, from which MoorDyn seeks rest",
    ]
    assert all(f"# - {words}\n" in text for words in left)


def test_a_chain_from_the_coupled_point_hangs_as_a_catenary() -> None:
    """Elastic, and without friction on the floor: Jonkman's equations of a mooring line."""
    text, left = read_deck(FLOAT, line=2)
    model = cm.CableModel(cm.load_scene(text, ["solver.tolerance=1e-5"]))
    w = 9.8 * (126.0 - 1020.0 * math.pi / 4.0 * 0.144**2)
    length, across, height, stiffness = 660.0, 600.0, 200.0, 5e8

    def misses(forces: np.ndarray) -> list[float]:
        h, v = forces
        span = length - v / w + h / w * math.asinh(v / h) + h * length / stiffness
        drop = h / w * (math.hypot(1.0, v / h) - 1.0) + v**2 / (2.0 * stiffness * w)
        return [span - across, drop - height]

    h, v = fsolve(misses, [1e6, 5e5], xtol=1e-12)
    assert v / w < length  # some lies on the floor
    assert model.top_force == pytest.approx([h, 0.0, -v], rel=1e-3, abs=1e-3 * h)
    assert model.vessel_position == pytest.approx([100.0, 0.0, 0.0])
    assert "the coupled point's motion, which no deck holds: vessel.velocity" in left
    assert "CaAx (0.5): no added mass along a cable" in left


@pytest.mark.parametrize("name", ["S1", "S4", "J"])
def test_the_decks_of_the_benchmarks_are_read_as_they_were_meant(name: str) -> None:
    scene = SCENES[name]
    deck = input_file(scene, Settings(segments=20), 1e-3)
    read = cm.load_scene(read_deck(deck)[0])
    (cable,) = read.cables
    assert cable.length == scene.cable.length
    for item in fields(scene.cable):
        if item.name != "length":
            given = getattr(scene.cable, item.name)
            assert getattr(read.cable_types["K"], item.name) == pytest.approx(given, rel=1e-12)
    assert read.end.kind == ("free" if scene.anchor is None else "anchor")


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("2e5 -0.8", "2e5|3e5 -0.8", "line 7, EA: '2e5|3e5' is viscoelastic or tabulated"),
        ("2e5 -0.8", "curve.dat -0.8", "line 7, EA: 'curve.dat' is viscoelastic or tabulated"),
        ("-0.8 0 ", "-0.8 EI.dat ", "line 7, EI: 'EI.dat' is tabulated; allowed: one number"),
        ("0.02 0       #", "0.02 0 0.7 #", "line 7, Cl: vortices"),
        ("0.02 0       #", "#", "line 7, LINE TYPES: 8 entries; 10 are needed"),
        ("rope 0.02", "rope wide", "line 7, Diam: 'wide' is not a number; allowed: a number"),
        ("rope 0.02", "rope 0", "line 7, Diam: 0 is not above 0"),
        ("1 rope", "1 wire", "LineType: there is no single type 'wire'; allowed: chain, rope"),
        ("2 Free", "2 Body1", "line 12, Attachment: 'Body1' is not taken; allowed: Fixed"),
        ("1 Fixed", "1 Free", "line 18, AttachA, AttachB: no end is held"),
        ("50 0.1 0.2 0.5", "50 0.1 5 0 0 0.2 0.5", "FX, FY, FZ: a scene has no steady forces"),
        ("50 0.1 0.2", "0 0.1 0.2", "line 12, Mass: 0 of a point with volume or drag"),
        ("rope 1 2 60 60", "rope R1A 2 60 60", "line 18, AttachA: 'R1A' is the end of a rod"),
        ("rope 1 2 60 60", "rope 1 9 60 60", "line 18, AttachB: '9' is no single point"),
        ("rope 1 2 60 60", "rope 1 2 -6 60", "line 18, UnstrLen: -6 is not above 0"),
        ("2 chain 4 3", "2 chain 4 2", "the free point 2 joins it to line 2"),
        ("7 fancy", "3 WaveKin", "line 27, WaveKin: '3' asks for waves that are no sum of comp"),
        ("7 fancy", "7 WaveKin", "WaveKin, wave_frequencies.txt: there is no such file beside"),
        ("7 fancy", "2 Currents", "line 27, Currents: '2' asks for a current that is no steady"),
        ("7 fancy", "1 Currents", "Currents, current_profile.txt: there is no such file beside"),
        ("7 fancy", "sea.txt SeafloorFile", "SeafloorFile: 'sea.txt' asks for a table"),
        ("120 WtrDpth", "sea.txt WtrDpth", "line 24, WtrDpth: 'sea.txt' is not a number"),
        ("7 fancy", "0.3 MU_KA", "MU_KT, MU_KA: 0 and 0.3 differ; allowed: one friction"),
        ("- POINTS -", "- BODIES -", "section POINTS: is missing, or has no rows"),
        ("- OUTPUTS -", "- FAILURE -\n\n\n1 2 1 0\n--- OUTPUTS -", "FAILURE: 1 of these"),
    ],
)  # fmt: skip
def test_what_a_scene_cannot_state_is_refused_by_its_place(old: str, new: str, words: str) -> None:
    assert FLOAT.count(old) == 1
    with pytest.raises(cm.SceneError) as caught:
        read_deck(FLOAT.replace(old, new), "float.txt", 1)
    assert words in str(caught.value)
    assert str(caught.value).startswith("float.txt: ")


def test_whatever_stands_in_a_deck_is_read_or_refused() -> None:
    """Every line left out, and every word another, in turn."""
    changed = list(every_change(FLOAT, ("x", "-1", "0", "nan", "")))
    read = 0
    for deck in changed:
        with suppress(cm.SceneError):
            read_deck(deck, "float.txt", 1)
            read += 1
    assert 0 < read < len(changed)


def test_two_coupled_ends_are_one_too_many() -> None:
    with pytest.raises(cm.SceneError, match="both ends are coupled"):
        read_deck(FLOAT.replace("4 Fixed", "4 Vessel"), line=2)


def test_options_that_ask_for_nothing_are_no_loads() -> None:
    calm = FLOAT.replace("7 fancy", "0 WaveKin\n0 Currents\n0.3 FrictionCoefficient")
    scene = cm.load_scene(read_deck(calm, line=1)[0])
    assert scene.environment.floor is not None
    assert scene.environment.floor.friction == 0.3


PROFILE = """\
--------------------- MoorDyn steady currents File ----------------------------------
Tabulated file with the water currents components
z (m), ux (m/s), uy (m/s), uz (m/s)
-130 0.1 0 0
-60 0.3 0.1
0 0.8 0.2 0
"""
SPECTRUM = "0.0 0.0 0.0 0.4\n0.5 0.3 -0.2 0.4\n0.9 -0.5 0.6 0.4\n1.1 0 0 0.4\n1.3 0.1 0.2 0.4\n"


def test_its_current_and_waves_are_those_of_the_files_beside_it(tmp_path: Path) -> None:
    """The surface is that which MoorDyn makes of the same files."""
    import moordyn

    text = FLOAT.replace("7 fancy", "7 WaveKin\n0.0005 dtM\n0.2 TmaxIC")
    (tmp_path / "wave_frequencies.txt").write_text(SPECTRUM)
    (tmp_path / "float.txt").write_text(text.replace("2 writeLog", "0 writeLog"))
    scene = cm.load_scene(read_deck(text, "float.txt", 1, tmp_path)[0])
    field = sea(scene)
    assert field is not None
    assert len(field.amplitude) == 3
    other = moordyn.Create(str(tmp_path / "float.txt"))
    try:
        place, still = np.array([100.0, 0.0, 0.0]), np.zeros(3)
        moordyn.Init(other, place, still)
        for k in range(3):
            moordyn.Step(other, place, still, 0.4 * k, 0.4)
            found = moordyn.GetWavesKin(moordyn.GetWaves(other), 30.0, 20.0, -20.0)[2]
            elevation = field.elevation(time := 0.4 * (k + 1), 30.0, 20.0) / field.share(time)
            assert elevation == pytest.approx(found, abs=1e-6)
    finally:
        moordyn.Close(other)


def test_a_steady_current_is_read(tmp_path: Path) -> None:
    (tmp_path / "current_profile.txt").write_text(PROFILE)
    scene = cm.load_scene(read_deck(FLOAT.replace("7 fancy", "3 Currents"), "", 1, tmp_path)[0])
    current = scene.environment.current
    assert current is not None
    assert [(point.z, point.velocity) for point in current.table] == [
        (-130.0, (0.1, 0.0, 0.0)), (-60.0, (0.3, 0.1, 0.0)), (0.0, (0.8, 0.2, 0.0)),
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("option", "name", "text", "words"),
    [
        ("1 Currents", "current_profile.txt", "z u\n\n", "it has no rows; allowed: rows of 2"),
        ("1 Currents", "current_profile.txt", "0 1\n-5 x\n", "line 2, '-5 x', is no row"),
        ("7 WaveKin", "wave_frequencies.txt", "0 1 1\n1 0 0\n", "it has no waves"),
        ("7 WaveKin", "wave_frequencies.txt", "1 1 1 0\n2 1 1 0.1\n", "2 directions of waves"),
    ],
)
def test_a_file_that_is_none_is_refused_by_its_place(
    option: str, name: str, text: str, words: str, tmp_path: Path
) -> None:
    (tmp_path / name).write_text(text)
    with pytest.raises(cm.SceneError) as caught:
        read_deck(FLOAT.replace("7 fancy", option), "float.txt", 1, tmp_path)
    assert words in str(caught.value)
    assert name in str(caught.value)


def test_a_deck_becomes_a_scene_on_the_command_line(tmp_path: Path) -> None:
    deck = tmp_path / "float.txt"
    deck.write_bytes(FLOAT.replace("(m^3)", "(m\xb3)").encode("latin-1"))
    both = invoke("import", "moordyn", deck, "--output", tmp_path / "both.yaml")
    assert both.exit_code == 0, both.output
    assert list(cm.load_system(tmp_path / "both.yaml").lines) == ["line1", "line2"]
    done = invoke("import", "moordyn", deck, "--line", "1")
    assert done.exit_code == 0, done.output
    scene = tmp_path / "float.yaml"
    assert done.stdout == f"Scene: {scene}\n"
    assert "cablemodel: not as in the deck: the other lines: 2\n" in done.stderr
    assert invoke("check", scene).exit_code == 0
    again = invoke("import", "moordyn", deck, "--line", "1")
    assert again.exit_code == 2
    assert f"{scene} exists; --force overwrites it" in again.stderr
    assert invoke("import", "moordyn", deck, "--line", "1", "--force").exit_code == 0
    assert invoke("import", "moordyn", tmp_path / "none.txt").exit_code == 2
