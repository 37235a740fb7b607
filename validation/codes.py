"""Other open programs, run beside this one: MoorPy and MoorDyn, of the extra `bench`."""

from __future__ import annotations

import contextlib
import tempfile
from pathlib import Path
from typing import Any

import numpy as np

import cablemodel as cm
from benchmarks.peers.moordyn import silence
from benchmarks.sections import read_rows
from validation import draw, industry
from validation.rows import DATA, Row, family, relative

GRAVITY, DENSITY = 9.80665, 1025.0


@family("programs", "Other programs: MoorPy and MoorDyn")
def programs() -> tuple[list[Row], Any]:
    """Moorings at rest by MoorPy; chains, at rest and in heave, and a polyester by MoorDyn."""
    rows, (figure, (left, right)) = [], draw.axes(2)
    rows += _moorpy(left)
    for name in ("WD0050", "WD0200"):
        rows += _moordyn(name, right if name == "WD0200" else None)
    rows.append(_polyester())
    draw.label(left, "MoorPy [kN]", "cablemodel [kN]")
    draw.label(right, "time [s]", "fairlead [kN]", "WD0200, heave of 2 m")
    return rows, figure


def _moorpy(one: Any) -> list[Row]:
    """Tension at both ends of chains and ropes, hanging, lying, with friction."""
    from moorpy.Catenary import catenary

    rows = []
    cases = {
        "chain, slack": (industry.CHAIN, 400.0, 50.0, 410.0, 0.0),
        "chain, friction 0.5": (industry.CHAIN, 395.0, 50.0, 410.0, 0.5),
        "chain, deep": (industry.CHAIN, 1500.0, 600.0, 1700.0, 0.0),
        "chain, deep, friction 1": (industry.CHAIN, 1480.0, 600.0, 1700.0, 1.0),
        "rope, taut": (industry.ROPES["poly184"], 1300.0, 800.0, 1500.0, 0.0),
    }
    for case, (kind, across, depth, length, friction) in cases.items():
        area = np.pi / 4.0 * kind["diameter"] ** 2
        weight = (kind["mass"] - DENSITY * area) * GRAVITY
        stiff = kind["axial_stiffness"]
        found = catenary(across, depth, length, stiff, weight, CB=friction)
        forces = np.hypot(found[2], found[3]), np.hypot(found[0], found[1])
        floor = {"z": -depth, "friction": friction}
        model = industry.moored(kind, across, 0.0, depth, length, floor=floor)
        for name, ours, theirs in zip(("top", "anchor"), industry.ends(model), forces, strict=True):
            if theirs < 1.0:
                continue
            off = 100.0 * abs(1e3 * ours - theirs) / forces[0]
            rows.append(Row("programs", case, "MoorPy", f"{name} tension, of the top's", off, 0.1,
                            "%"))  # fmt: skip
            one.loglog(theirs / 1e3, ours, "o", color=draw.FOUND)
    one.plot([1e2, 1e4], [1e2, 1e4], color=draw.REFERENCE, lw=1)
    return rows


DECK = """MoorDyn input file
---------------------- LINE TYPES ----------------------
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
chain {diameter} {mass} {axial_stiffness} -0.6 0 {drag_normal} {added_mass} {drag_tangential} 0.0
---------------------- POINTS ----------------------
ID Type X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Fixed {across} 0 {bottom} 0 0 0 0
2 Coupled 0 0 0 0 0 0 0
---------------------- LINES ----------------------
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (ID) (ID) (m) (-) (-)
1 chain 1 2 {length} {segments} -
---------------------- OPTIONS ----------------------
0 writeLog
1 disableOutput
RK2 tScheme
{gravity} g
{density} rho
{depth} WtrDpth
1e6 kBot
1e5 cBot
{step} dtM
1.0 dtIC
600 TmaxIC
1e-6 threshIC
---------------------- OUTPUTS ----------------------
FairTen1
---------------------- need this line ----------------------
"""


def _moordyn(name: str, one: Any) -> list[Row]:
    """A chain from its relaxed start, then 30 s of heave of 2 m in 10 s that come up in 10 s."""
    import moordyn

    across, depth, length = industry.DEPTHS[name]
    segments = round(length / 5.0)
    step = 0.5 * length / segments / np.sqrt(industry.CHAIN["axial_stiffness"] / 390.0)
    deck = DECK.format(
        **industry.CHAIN,
        across=across,
        bottom=-depth,
        depth=depth,
        length=length,
        segments=segments,
        gravity=GRAVITY,
        density=DENSITY,
        step=step,
    )
    times, rate = np.arange(1, 1201) * 0.05, 2.0 * np.pi / 10.0
    share = np.minimum(times / 10.0, 1.0)
    up = share**2 * (3 - 2 * share)
    rise = 6 * share * (1 - share) / 10.0
    z = 2.0 * up * np.sin(rate * times)
    speed = 2.0 * (rise * np.sin(rate * times) + up * rate * np.cos(rate * times))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "line.txt"
        path.write_text(deck)
        with silence():
            system = moordyn.Create(str(path))
            moordyn.SetVerbosity(system, moordyn.LEVEL_NONE)
            moordyn.Init(system, [0.0, 0.0, 0.0], [0.0, 0.0, 0.0])
            theirs, before = [np.array(moordyn.GetLineFairTen(moordyn.GetLine(system, 1)))], 0.0
            for t, here in zip(times, z, strict=True):
                mean = float((here - before) / 0.05)
                start = [0.0, 0.0, float(before)]
                moordyn.Step(system, start, [0.0, 0.0, mean], float(t) - 0.05, 0.05)
                theirs.append(moordyn.GetLineFairTen(moordyn.GetLine(system, 1)))
                before = here
            moordyn.Close(system)
    model = industry.moored(industry.CHAIN, across, 0.0, depth, length, waves=industry.SURFACE)
    ours = [model.top_tension]
    for t, here, moves in zip(times, z, speed, strict=True):
        model.step_to(t, vessel_position=[0, 0, here], vessel_velocity=[0, 0, moves])
        ours.append(model.top_tension)
    mine, other = np.array(ours) / 1e3, np.array(theirs, float) / 1e3
    late = np.concatenate([[0.0], times]) > 30.0
    rms = float(np.sqrt(np.mean((mine - other)[late] ** 2)))
    if one is not None:
        one.plot(times, other[1:], color=draw.REFERENCE, label="MoorDyn")
        one.plot(times, mine[1:], color=draw.FOUND, label="cablemodel")
    case = f"{name}, segments of 5 m"
    return [
        Row("programs", case, "MoorDyn 2.7", "fairlead at rest", relative(mine[0], other[0]), 2.0,
            "%"),
        Row("programs", case, "MoorDyn 2.7", "heave of 2 m, rms of range",
            100.0 * rms / float(np.ptp(other[late])), 5.0, "%"),
    ]  # fmt: skip


TAUT = """MoorDyn input file
---------------------- LINE TYPES ----------------------
TypeName Diam Mass/m EA BA/-zeta EI Cd Ca CdAx CaAx
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
poly 0.203 40 curve.dat 1e5 0 1.6 1.0 0.0 0.0
---------------------- POINTS ----------------------
ID Type X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Fixed 0 0 -372.192 0 0 0 0
2 Coupled {across} 0 -18 0 0 0 0
---------------------- LINES ----------------------
ID LineType AttachA AttachB UnstrLen NumSegs LineOutputs
(#) (name) (ID) (ID) (m) (-) (-)
1 poly 1 2 1400 40 -
---------------------- OPTIONS ----------------------
0 writeLog
1 disableOutput
RK2 tScheme
9.80665 g
1025 rho
372.3 WtrDpth
0.002 dtM
1.0 dtIC
300 TmaxIC
1e-7 threshIC
---------------------- OUTPUTS ----------------------
FairTen1
---------------------- need this line ----------------------
"""


def _polyester() -> Row:
    """1.4 km of polyester, taut at five distances, by the curve that MoorDyn has for Syrope's rope.

    MoorDyn goes by its table; ours is a polynomial of degree eight, 5e-5 of strain off.
    """
    import moordyn

    table = read_rows(DATA / "syrope_polyester.csv")
    strain, tension = (np.array([float(row[k]) for row in table]) for k in ("strain", "tension"))
    powers = np.arange(1, 9)
    share = (tension / tension[-1])[:, None] ** powers
    curve = np.linalg.lstsq(share, strain, rcond=None)[0] / tension[-1] ** powers
    rope = {
        "diameter": 0.203,
        "mass": 40.0,
        "tension_strain": curve.tolist(),
        "drag_normal": 1.6,
        "drag_tangential": 0.0,
        "added_mass": 1.0,
    }
    off = 0.0
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        points = "\n".join(f"{e} {t}" for e, t in zip(strain, tension, strict=True))
        Path("curve.dat").write_text(f"Strain Tension\n(-) (N)\n{points}")
        for across in (1365.0, 1380.0, 1400.0, 1420.0, 1435.0):
            Path("line.txt").write_text(TAUT.format(across=across))
            with silence():
                system = moordyn.Create("line.txt")
                moordyn.SetVerbosity(system, moordyn.LEVEL_NONE)
                moordyn.Init(system, [across, 0.0, -18.0], [0.0, 0.0, 0.0])
                theirs = float(moordyn.GetLineFairTen(moordyn.GetLine(system, 1)))
                moordyn.Close(system)
            scene = {
                "cable_types": {"rope": rope},
                "line": [{"cable": {"type": "rope", "length": 1400.0}}],
                "vessel": {"position": [across, 0.0, -18.0]},
                "end": {"anchor": [0.0, 0.0, -372.192]},
            }
            off = max(off, relative(cm.CableModel(cm.load_scene(scene)).top_tension, theirs))
    return Row("programs", "polyester, Syrope's curve", "MoorDyn 2.7",
               "fairlead, at five distances", off, 0.5, "%")  # fmt: skip
