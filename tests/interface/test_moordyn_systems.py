"""Decks of several lines, joints, bodies and rods: beside MoorDyn itself, and what is refused."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

import moordyn
import numpy as np
import pytest
from decks import every_change
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

import cablemodel as cm
from benchmarks.peers.moordyn import silence
from cablemodel.moordyn_deck import read_deck

Vector = NDArray[np.float64]

SEGMENTS = {"chain": 40, "rope": 20}
SETTLES, LOOKED_AT = 300.0, 100.0
"""MoorDyn swings to rest for so long, and is then looked at, on the average, for so long [s]."""


def deck(points: str, lines: str, depth: float, solids: str = "") -> str:
    """Soft ropes, that long steps of time carry; numbers of segments are added to lines."""
    rows = "\n".join(f"{line} {SEGMENTS[line.split()[1]]} -" for line in lines.splitlines())
    return f"""MoorDyn input file
---------------------- LINE TYPES ----------------------
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
chain 0.06 60 2e7 -0.5 0 2.0 1.0 0.4 0
rope 0.08 6 3e6 -0.5 0 1.2 1.0 0.05 0
{solids}---------------------- POINTS ----------------------
ID Attachment X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
{points}
---------------------- LINES ----------------------
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (ID) (ID) (m) (-) (-)
{rows}
---------------------- OPTIONS ----------------------
0.005 dtM
RK4 tScheme
9.81 g
1025 rho
{depth} WtrDpth
300 TmaxIC
1e-6 threshIC
---------------------- OUTPUTS ----------------------
FairTen1
---------------------- need this line ----------------------
"""


def around(radius: float, k: int) -> str:
    """x and y of one of three places about the z axis."""
    angle = 2.0 * math.pi * k / 3.0
    return f"{radius * math.cos(angle)!r} {radius * math.sin(angle)!r}"


BODIES = """---------------------- BODIES ----------------------
ID Attachment X0 Y0 Z0 r0 p0 y0 Mass CG I Volume CdA Ca
(#) (-) (m) (m) (m) (deg) (deg) (deg) (kg) (m) (kg-m^2) (m^3) (m^2) (-)
"""
RODS = """---------------------- ROD TYPES ----------------------
TypeName Diam Mass/m Cd Ca CdEnd CaEnd
(name) (m) (kg/m) (-) (-) (-) (-)
float 1 300 2 1.0 5 1.0
spar 3 1000 2 1.0 5 1.0
---------------------- RODS ----------------------
ID RodType Attachment Xa Ya Za Xb Yb Zb NumSegs RodOutputs
(#) (name) (-) (m) (m) (m) (m) (m) (m) (-) (-)
"""
THREE_LEGS = deck(
    "\n".join(
        f"{2 * k + 1} Fixed {around(600, k)} -120 0 0 0 0\n"
        f"{2 * k + 2} Vessel {around(20, k)} -12 0 0 0 0"
        for k in range(3)
    ),
    "\n".join(f"{k + 1} chain {2 * k + 1} {2 * k + 2} {612 + 2 * k}" for k in range(3)),
    depth=120.0,
)
Y = deck(
    "1 Body1 2 -1 0.5 0 0 0 0\n"
    "2 Connect 130 0 -110 3000 6.0 4.0 0.5\n"
    "3 Free 60 0 -50 500 0.1 0.5 0.5\n"
    "4 Vessel 0 12 -10 0 0 0 0\n"
    "5 Vessel 0 -12 -10 0 0 0 0",
    "1 chain 1 2 290\n2 rope 3 2 90\n3 rope 3 4 75\n4 rope 5 3 73",
    depth=200.0,
    solids=BODIES + "1 Fixed 400 0 -198 20 -15 40 0 0 0 0 0 0\n",
)
"""Chain and rope from an anchor on a body that lies askew, over a float, to two legs."""
BODY = deck(
    "\n".join(
        f"{2 * k + 1} Fixed {around(80, k)} -100 0 0 0 0\n"
        f"{2 * k + 2} Body1 {around(3, k)} -2 0 0 0 0"
        for k in range(3)
    )
    + "\n7 Body1 1 0 0.5 2000 0.5 1 0",
    "\n".join(f"{k + 1} rope {2 * k + 1} {2 * k + 2} {92 + 2 * k}" for k in range(3)),
    depth=100.0,
    solids=BODIES + "1 Free 3 2 -41 0 0 10 40000 0.5 3e5|3e5|4e5 60 100|30000 0.8\n",
)
"""A body with a weight on its side."""
BUOY = deck(
    "\n".join(
        f"{2 * k + 1} Fixed {around(120, k)} -100 0 0 0 0\n"
        f"{2 * k + 2} Body1 {around(1.5, k)} -19 0 0 0 0"
        for k in range(3)
    ),
    "\n".join(f"{k + 1} rope {2 * k + 1} {2 * k + 2} {140 + k}" for k in range(3)),
    depth=100.0,
    solids=BODIES
    + "1 Free 1 0.6 4 0 0 0 70000 -17 3e5 0 0 0\n"
    + RODS
    + "1 spar Body1 0 0 -20 0 0 6 26 -\n",
)
"""A spar at the surface: a ballast in a rod."""
ROD = deck(
    "1 Fixed 60 20 -100 0 0 0 0\n2 Fixed 60 -20 -100 0 0 0 0\n3 Fixed -60 0 -100 0 0 0 0",
    "1 rope 1 R1B 85\n2 rope 2 R1B 86\n3 rope R1A 3 88",
    depth=100.0,
    solids=RODS + "1 float Free -6 0.1 -30 6 0 -31 12 -\n",
)
"""A float on three ropes at two ends."""


@dataclass(frozen=True)
class Legs:
    """By the line of the deck: tension at the middle of its last segment [N], its ends (2, 3)."""

    tension: dict[str, float]
    ends: dict[str, Vector]


def by_moordyn(text: str, folder: Path, coupled: list[float]) -> Legs:
    """MoorDyn at rest, or on the average of what is left of its swing."""
    path = folder / "deck.txt"
    path.write_text(text)
    still = [0.0] * len(coupled)
    with silence():
        system = moordyn.Create(str(path))
        moordyn.Init(system, coupled, still)
    lines = [moordyn.GetLine(system, k + 1) for k in range(moordyn.GetNumberLines(system))]
    found = []
    for time in np.arange(0.0, SETTLES + LOOKED_AT, 0.5):
        moordyn.Step(system, coupled, still, float(time), 0.5)
        if time >= SETTLES:
            found.append(
                [
                    [moordyn.GetLineFairTen(line), *moordyn.GetLineNodePos(line, 0),
                     *moordyn.GetLineNodePos(line, moordyn.GetLineN(line))]
                    for line in lines
                ]
            )  # fmt: skip
    with silence():
        moordyn.Close(system)
    means = np.mean(found, axis=0)
    return Legs(
        {str(k + 1): row[0] for k, row in enumerate(means)},
        {str(k + 1): row[1:].reshape(2, 3) for k, row in enumerate(means)},
    )


def by_cablemodel(text: str, turned: tuple[str, ...]) -> Legs:
    """Of each line of the deck within those of the scene; turned ones run the other way."""
    scene, _left = read_deck(text)
    model = cm.SystemModel(scene)
    tension, ends = {}, {}
    for name, line in model.lines.items():
        arc = 0.0
        items = (item.cable for item in model.scene.lines[name].items)
        cables = [cable for cable in items if cable is not None]
        for key, cable in zip(name.removeprefix("line").split("_"), cables, strict=True):
            first, last = arc, arc + cable.length
            if key in turned:
                first, last = last, first
            half = (first - last) / (2.0 * SEGMENTS[cable.type])
            state = line.sample([last + half, first, last])
            tension[key], ends[key] = state.tension[0], state.position[1:]
            arc += cable.length
    return Legs(tension, ends)


@pytest.mark.parametrize(
    ("text", "coupled", "turned", "names"),
    [
        pytest.param(THREE_LEGS, 3, (), ["line1", "line2", "line3"], id="three legs"),
        pytest.param(Y, 2, ("2",), ["line1_2_3", "line4"], id="Y"),
        pytest.param(BODY, 0, (), ["line1", "line2", "line3"], id="body"),
        pytest.param(BUOY, 0, (), ["line1", "line2", "line3"], id="buoy"),
        pytest.param(ROD, 0, (), ["line1", "line2", "line3"], id="rod"),
    ],
)
def test_a_deck_hangs_in_both_programs_alike(
    text: str, coupled: int, turned: tuple[str, ...], names: list[str], tmp_path: Path
) -> None:
    """MoorDyn's lines are chains of masses, off by some parts of one over their number squared; its
    floor is a spring."""
    rows = [line.split() for line in text.splitlines()]
    places = [float(x) for row in rows if row[1:2] == ["Vessel"] for x in row[2:5]]
    assert len(places) == 3 * coupled
    theirs, ours = by_moordyn(text, tmp_path, places), by_cablemodel(text, turned)
    scene = cm.load_system(read_deck(text)[0])
    assert list(scene.lines) == names
    for key, tension in theirs.tension.items():
        assert ours.tension[key] == pytest.approx(tension, rel=5e-3), key
        assert ours.ends[key] == pytest.approx(theirs.ends[key], abs=0.1), key


def test_three_legs_that_are_heaved_pull_in_both_programs_alike(tmp_path: Path) -> None:
    """By a metre in 8 s: drag and added mass are those of the deck, too. Over the range of the
    tension, as the validation of chains beside MoorDyn."""
    step, rate = 0.05, 2.0 * math.pi / 8.0
    times = step * np.arange(960)
    heights = 0.5 * (1.0 - np.cos(rate * np.append(times, times[-1] + step)))
    path = tmp_path / "deck.txt"
    path.write_text(THREE_LEGS)
    rows = [line.split() for line in THREE_LEGS.splitlines()]
    held = np.array([[float(x) for x in row[2:5]] for row in rows if row[1:2] == ["Vessel"]])
    theirs = []
    with silence():
        system = moordyn.Create(str(path))
        moordyn.Init(system, list(held.ravel()), [0.0] * held.size)
        lines = [moordyn.GetLine(system, k + 1) for k in range(3)]
        for k, time in enumerate(times):
            speed = np.tile([0.0, 0.0, (heights[k + 1] - heights[k]) / step], 3)
            place = (held + np.array([0.0, 0.0, heights[k]])).ravel()
            moordyn.Step(system, list(place), list(speed), float(time), step)
            theirs.append([moordyn.GetLineFairTen(line) for line in lines])
        moordyn.Close(system)
    model = cm.SystemModel(read_deck(THREE_LEGS)[0])
    ours = []
    for height in heights[1:]:
        model.step(step, vessels={"vessel": cm.VesselInput(position=[0.0, 0.0, height])})
        last = [line.length * (1.0 - 0.5 / SEGMENTS["chain"]) for line in model.lines.values()]
        at = zip(model.lines.values(), last, strict=True)
        ours.append([line.sample([arc]).tension[0] for line, arc in at])
    settled = slice(len(times) // 2, None)
    range_ = np.ptp(np.array(theirs)[settled], axis=0)
    apart = np.array(ours)[settled] - np.array(theirs)[settled]
    assert np.all(np.sqrt(np.mean(apart**2, axis=0)) < 0.05 * range_)


def test_what_is_only_like_the_deck_is_told() -> None:
    _text, left = read_deck(BODY.replace("9.81 g", "9.81 g\n3e5 cBot"))
    assert left == [
        "cBot: the floor is rigid, its friction that of Coulomb",
        "numerics and output of MoorDyn: dtM, tScheme, TmaxIC, threshIC",
        "body 1: its buoyancy acts at CG, as in MoorDyn, and its added mass there too; its drag "
        "goes by the whole relative speed",
        "BA/-zeta (-0.5): damping of MoorDyn's segments, by their size",
    ]
    text, left = read_deck(Y.replace("2e7 -0.5 0", "2e7 -0.5 10").replace("2 Connect", "2 Con"))
    assert "hinges at points 2, 3: lines that are joined bend as one" in left
    assert "the places of free points, from which MoorDyn seeks rest" in left
    assert all(f"# - {words}\n" in text for words in left)


def test_a_body_has_the_masses_of_its_points_and_rods() -> None:
    scene = cm.load_system(read_deck(BODY)[0])
    body = scene.bodies["body1"]
    assert body.mass == 42000.0
    assert body.submerged_weight == pytest.approx(9.81 * (42000.0 - 1025.0 * 60.5))
    assert body.centre_of_gravity == pytest.approx((2000.0 / 42000.0, 0.0, 0.5))
    assert body.centre_of_buoyancy == pytest.approx((0.5 / 60.5, 0.0, 0.5))
    assert body.drag_area == (101.0, 101.0, 101.0)
    assert body.drag_turning == (30000.0, 30000.0, 30000.0)
    lever = 40000.0 * 2000.0 / 42000.0
    assert body.inertia == pytest.approx((3e5, 3e5 + lever, 4e5 + lever))
    assert body.attitude == pytest.approx((0.0, 0.0, math.radians(10.0)))
    spar = cm.load_system(read_deck(BUOY)[0]).bodies["body1"]
    assert spar.mass == 96000.0
    assert spar.hull is not None
    assert (spar.hull.diameter, spar.hull.height) == (3.0, 26.0)
    assert spar.hull.centre == pytest.approx((0.0, 0.0, -7.0))


def test_bodies_and_rods_that_are_coupled_move_as_vessels() -> None:
    solids = (
        BODIES
        + "1 Coupled 1 2 -5 10 20 30 0 0 0 0 0 0\n"
        + RODS
        + "1 spar Coupled 0 0 -10 0 0 -4 6 -\n"
    )
    points = "1 Fixed 100 0 -80 0 0 0 0\n2 Fixed -100 0 -80 0 0 0 0\n3 Body1 4 0 1 0 0 0 0"
    text = deck(points, "1 rope 1 3 130\n2 rope 2 R1A 130", 80.0, solids)
    scene = cm.load_system(read_deck(text)[0])
    body = scene.vessels["body1"]
    told = Rotation.from_euler("XYZ", [10.0, 20.0, 30.0], degrees=True)
    assert body.attitude is not None
    ours = Rotation.from_euler("xyz", body.attitude[0].attitude)
    assert ours.as_matrix() == pytest.approx(told.as_matrix(), abs=1e-9)
    assert body.position == (1.0, 2.0, -5.0)
    assert body.points == {"p3": (4.0, 0.0, 1.0)}
    assert scene.vessels["vessel"].points == {"r1a": (0.0, 0.0, -10.0)}
    assert scene.lines["line2"].end.point == "vessel.r1a"


def test_lines_that_bend_are_clamped_at_rods_and_joined_by_those_without_length() -> None:
    """A cantilever of two lines: w L^4 / 8 EI at its end."""
    solids = RODS + "1 float Fixed -5 0 -30 0 0 -30 4 -\n2 float Free 4 0 -30 4 0 -30 0 -\n"
    text = deck("1 Free 10 0 -30 0 0 0 0", "1 rope R1B R2A 4\n2 rope R2B 1 6", 80.0, solids)
    text = text.replace("rope 0.08 6 3e6 -0.5 0", "rope 0.08 60 3e8 -0.5 1e7")
    scene, left = read_deck(text)
    assert "rod 2: without a length it is a joint, where lines bend as one" in left
    model = cm.SystemModel(scene)
    (line,) = model.lines.values()
    weight = 9.81 * (60.0 - 1025.0 * math.pi / 4.0 * 0.08**2)
    ((_x, _y, z),) = line.sample([10.0]).position
    assert z == pytest.approx(-30.0 - weight * 1e4 / 8e7, abs=1e-4)
    start, end = line.sample([0.0, 10.0]).position
    assert start == pytest.approx([0.0, 0.0, -30.0])
    turned = cm.SystemModel(read_deck(text.replace("1 rope R1B R2A 4", "1 rope R2A R1B 4"))[0])
    (line,) = turned.lines.values()
    assert line.sample([10.0]).position[0] == pytest.approx(end, abs=1e-6)


def test_a_line_between_two_clamps_leaves_one_and_arrives_at_the_other() -> None:
    solids = RODS + "1 float Fixed -5 0 -30 0 0 -30 4 -\n2 float Coupled 10 0 -30 15 0 -30 4 -\n"
    text = deck("1 Fixed 0 0 -40 0 0 0 0", "1 rope R1B R2A 10\n2 rope R2B 1 30", 80.0, solids)
    scene = cm.load_system(read_deck(text.replace("3e6 -0.5 0", "3e8 -0.5 1e7"))[0])
    first = scene.lines["line1"]
    assert (first.start.point, first.start.clamped) == ("ground.r1b", (1.0, 0.0, 0.0))
    assert (first.end.point, first.end.clamped) == ("vessel.r2a", (1.0, 0.0, 0.0))
    assert scene.lines["line2"].start.clamped == (1.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("text", "old", "new", "words"),
    [
        (Y, "2 Connect", "2 Turbine1", "Attachment: 'Turbine1' is not taken"),
        (Y, "1 Body1", "1 Body7", "Attachment: there is no body7; allowed: one of BODIES"),
        (Y, "1 Fixed 400", "1 CoupledPinned 400", "Attachment: 'CoupledPinned' is not"),
        (Y, "4 rope 5 3", "3 rope 5 3", "ID: '3' is that of line 24, too"),
        (Y, "2 rope 3 2", "2 rope 3 9", "AttachB: '9' is no single point"),
        (Y, "2 rope 3 2", "2 rope R1A 2", "AttachA: there is no end R1A of a rod"),
        (Y, "1 chain 1 2", "1 chain 2 2", "line1_2 comes back to the free point 2"),
        (Y, "2 rope 3 2", "2 wire 3 2", "LineType: there is no single type 'wire'"),
        (Y, "500 0.1", "0 0.1", "Mass: 0 of a point with volume or drag"),
        (Y, "-198 20", "-198 x", "r0: 'x' is not a number"),
        (BODY, "40000 0.5 3e5", "40000 0.5|1 3e5", "CG: 2 numbers; allowed: 1 or 3"),
        (BODY, "3e5|3e5|4e5", "3e5|3e5|9e5", "that of no rigid body; allowed: above 0"),
        (BODY, "40000 0.5 3e5|3e5|4e5", "-2000 0 3e5", "Mass: 0 in all, of what is free"),
        (BUOY, "1 spar Body1", "1 spar Body1Pinned", "Attachment: 'Body1Pinned' is not"),
        (BUOY, "1 spar Body1", "1 spar Body4", "Attachment: there is no body 4"),
        (BUOY, "1 spar Body1", "1 tube Body1", "RodType: there is no single type 'tube'"),
        (BUOY, "0 0 -20 0 0 6", "0 0 -20 0 0 -20", "RODS: rod 1 has no length; allowed:"),
        (BUOY, "1 spar Body1 0 0", "1 spar Body1 0 1", "body1 leaves the water, and is no single"),
    ],
)  # fmt: skip
def test_what_a_system_cannot_state_is_refused_by_its_place(
    text: str, old: str, new: str, words: str
) -> None:
    assert text.count(old) == 1
    changed = text.replace(old, new)
    (row,) = (k for k, line in enumerate(changed.splitlines(), 1) if new in line)
    with pytest.raises(cm.SceneError) as caught:
        read_deck(changed, "deck.txt")
    assert f"line {row}, " in str(caught.value)
    assert words in str(caught.value)


def test_a_system_that_nothing_holds_is_refused() -> None:
    free = ROD.replace("Fixed", "Free")
    with pytest.raises(cm.SceneError, match="AttachA, AttachB: no end is held"):
        read_deck(free)


@pytest.mark.parametrize("text", [Y, BUOY, ROD], ids=["Y", "buoy", "rod"])
def test_whatever_stands_in_a_deck_of_several_lines_is_read_or_refused(text: str) -> None:
    """Every line left out, and every word another, in turn."""
    changed = list(every_change(text, ("x", "-1", "0", "nan", "1|2")))
    read = 0
    for one in changed:
        with suppress(cm.SceneError):
            read_deck(one, "deck.txt")
            read += 1
    assert 0 < read < len(changed)
