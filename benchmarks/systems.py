"""``python -m benchmarks.systems``: systems against MoorDyn, work against error.

- L: a buoy on three chain legs that is heaved as given; compared is the middle of a leg, and its
  pull on the buoy. The legs hang clear of a floor: what the two take for one differs.
- B: a bridle of two legs that tows a body from rest; compared is the body, behind the tug.

Each code is compared with its own limit, which knows nothing of the other: cablemodel with a run at
a tolerance far finer than any that is measured, MoorDyn with what its two finest meshes tend to
(its errors fall as the square of the segments). How far apart the limits are says what the models
share. MoorDyn's settings are found by search: every scheme, time step and damping of a list on one
mesh, then all meshes and coupling steps with the cheapest of them that is stable.
"""

from __future__ import annotations

import argparse
import copy
import math
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.compare import cost_at, front
from benchmarks.measure import Contestant, Measurement, Runner, measure, run_once
from benchmarks.peers.moordyn import Settings as MoorDynSettings
from benchmarks.peers.moordyn import deck, silence
from benchmarks.peers.moordyn_search import TRIED
from benchmarks.references import Reference
from benchmarks.report import MEASUREMENT_HEAD, measurement_rows, number
from benchmarks.scenes import GRAVITY, HEAVE, HEAVE_PERIOD, Cable, heave_motion, heave_speed
from benchmarks.sections import read_rows, table, write_part, write_rows

FOLDER = Path("docs/benchmarks")
PAGE = Path("docs/benchmarks.md")
DENSITY = 1025.0
TOLERANCES = (1e-1, 3e-2, 1e-2, 4e-3, 2e-3, 1e-3, 4e-4, 1e-4, 3e-5, 1e-5, 1e-6)
FINEST, CHECK = 1e-7, 1e-6
"""Tolerance of our own limit, and of the run that it is checked by."""
SEGMENTS = (4, 6, 10, 20, 40, 80)
FINE_SEGMENTS = (40, 80)
"""Of each of MoorDyn's lines: those measured, and those that its limit is made of."""
SEARCHED_ON = 10
COUPLING_STEPS = (0.005, 0.02, 0.1)
STABLE = 1.2
"""Over the error with the finest time step: settings below it are stable, and compete."""
ASKED = {"L": "200"}
"""Ratios, at least."""
REPEATS = 5
"""Of a timed run, at most."""
ERRORS = (1e-3, 1e-4, 1e-5)
"""At which costs are compared, of the length [-]."""

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class MoorDynPoint:
    """A point of MoorDyn's: ``Fixed``, ``Coupled`` or ``Free``, at t = 0 (SI units)."""

    kind: str
    place: tuple[float, float, float]
    mass: float = 0.0
    volume: float = 0.0
    drag_area: float = 0.0
    added_mass: float = 0.0


@dataclass(frozen=True)
class SystemCase:
    """A system for both codes, and where it is compared.

    ``motion`` maps a time [s] to the displacement of what is driven (3,) [m]. ``lines``: of each
    line the numbers of MoorDyn's points, from 0, where it begins and ends; the first one is
    compared. ``probe``: which part of it from its beginning.
    """

    name: str
    title: str
    cable: Cable
    scene: dict[str, Any]
    times: tuple[float, ...]
    motion: Callable[[float], tuple[float, float, float]]
    points: tuple[MoorDynPoint, ...]
    lines: tuple[tuple[int, int], ...]
    probe: float
    driven: str
    """Name of the vessel."""
    driven_end: int
    """Of the compared line, that is at the vessel: 0 its beginning, 1 its end."""


CHAIN = Cable(
    length=103.0, diameter=0.04, mass=32.0, axial_stiffness=1.2e8, bending_stiffness=0.0,
    drag_normal=2.0, drag_tangential=0.4,
    submerged_weight=(32.0 - DENSITY * math.pi / 4.0 * 0.04**2) * GRAVITY,
)  # fmt: skip
WIRE = Cable(
    length=60.0, diameter=0.02, mass=1.6, axial_stiffness=2e7, bending_stiffness=0.0,
    drag_normal=1.2, drag_tangential=0.01,
    submerged_weight=(1.6 - DENSITY * math.pi / 4.0 * 0.02**2) * GRAVITY,
)  # fmt: skip


def _scene(cable: Cable, duration: float, **parts: Any) -> dict[str, Any]:
    kind = {key: value for key, value in cable.cable_type().items() if key != "bending_stiffness"}
    return {
        "environment": {"water_density": DENSITY, "gravity": GRAVITY},
        "cable_types": {"K": kind},
        "solver": {"tolerance": 1e-3},
        "run": {"duration": duration},
        **parts,
    }


def _velocities(speed: Callable[[float], list[float]], until: float) -> dict[str, Any]:
    """A vessel's motion as a smooth table, ten rows a second; it goes on beyond the end of the run,
    where a cubic table has another slope."""
    instants = (0.1 * np.arange(round(10.0 * until) + 20)).tolist()
    rows = [{"t": t, "velocity": speed(t)} for t in instants]
    return {"velocity": rows, "interpolation": "cubic"}


def three_legs() -> SystemCase:
    """A buoy that is heaved on three legs."""
    deep, until = -10.0, 24.0
    ways = [(math.cos(a), math.sin(a)) for a in (0.0, 2.0 * math.pi / 3.0, -2.0 * math.pi / 3.0)]
    held = [(1.5 * x, 1.5 * y, 0.0) for x, y in ways]
    anchors = [(81.5 * x, 81.5 * y, deep - 60.0) for x, y in ways]
    items = [{"cable": {"type": "K", "length": CHAIN.length}}]
    names = "abc"
    scene = _scene(
        CHAIN, until,
        vessels={"buoy": {
            "position": [0.0, 0.0, deep],
            "points": {name: list(place) for name, place in zip(names, held, strict=True)},
            **_velocities(lambda t: [0.0, 0.0, heave_speed(t)], until),
        }},
        lines={
            name: {"from": {"anchor": list(anchor)}, "to": f"buoy.{name}", "items": items}
            for name, anchor in zip(names, anchors, strict=True)
        },
    )  # fmt: skip
    points = [MoorDynPoint("Fixed", anchor) for anchor in anchors]
    points += [MoorDynPoint("Coupled", (x, y, z + deep)) for x, y, z in held]
    return SystemCase(
        name="L",
        title=f"a buoy on three chain legs, heaved by {2 * HEAVE:g} m in {HEAVE_PERIOD:g} s",
        cable=CHAIN,
        scene=scene,
        times=(2.0, 4.0, 6.0, 8.0, 11.0, 14.0, 17.0, 20.0, until),
        motion=heave_motion,
        points=tuple(points),
        lines=((0, 3), (1, 4), (2, 5)),
        probe=0.5,
        driven="buoy",
        driven_end=1,
    )


TOW_SPEED, TOW_RAMP = 1.5, 20.0


def _tow(time: float) -> tuple[float, float, float]:
    """From rest to TOW_SPEED within TOW_RAMP, as half a cosine."""
    if time >= TOW_RAMP:
        return (TOW_SPEED * (time - 0.5 * TOW_RAMP), 0.0, 0.0)
    omega = math.pi / TOW_RAMP
    return (0.5 * TOW_SPEED * (time - math.sin(omega * time) / omega), 0.0, 0.0)


def _tow_speed(time: float) -> list[float]:
    share = 0.5 * (1.0 - math.cos(math.pi * min(time, TOW_RAMP) / TOW_RAMP))
    return [TOW_SPEED * share, 0.0, 0.0]


def bridle() -> SystemCase:
    """A body on two legs that is towed from rest."""
    deep, until, wide = -10.0, 60.0, 5.0
    mass, volume, drag_area = 800.0, 0.1, 2.0
    sides = {"port": wide, "starboard": -wide}
    items = [{"cable": {"type": "K", "length": WIRE.length}}]
    below = math.sqrt(WIRE.length**2 - wide**2)
    scene = _scene(
        WIRE, until,
        vessels={"tug": {
            "position": [0.0, 0.0, deep],
            "points": {name: [0.0, y, 0.0] for name, y in sides.items()},
            **_velocities(_tow_speed, until),
        }},
        bodies={"body": {
            "mass": mass, "submerged_weight": (mass - DENSITY * volume) * GRAVITY,
            "inertia": 100.0, "added_mass": DENSITY * volume, "drag_area": drag_area,
            "drag_turning": 1.0, "points": {"eye": [0.0, 0.0, 0.0]},
        }},
        lines={
            name: {"from": f"tug.{name}", "to": "body.eye", "items": items} for name in sides
        },
    )  # fmt: skip
    points = [MoorDynPoint("Coupled", (0.0, y, deep)) for y in sides.values()]
    points.append(MoorDynPoint("Free", (0.0, 0.0, deep - below), mass, volume, drag_area, 1.0))
    return SystemCase(
        name="B",
        title="a body on a bridle of two legs, towed from rest",
        cable=WIRE,
        scene=scene,
        times=(5.0, 10.0, 15.0, 20.0, 25.0, 30.0, 40.0, 50.0, until),
        motion=_tow,
        points=tuple(points),
        lines=((0, 2), (1, 2)),
        probe=1.0,
        driven="tug",
        driven_end=0,
    )


CASES = {case.name: case for case in (three_legs(), bridle())}


class SystemRunner:
    """One system of cablemodel's, stepped from one reference time to the next."""

    def __init__(self, case: SystemCase, tolerance: float) -> None:
        import cablemodel as cm

        scene = copy.deepcopy(case.scene)
        scene["solver"]["tolerance"] = tolerance
        self._model = cm.SystemModel(scene)
        self._case = case
        self._line = next(iter(self._model.lines.values()))

    def advance(self, time: float) -> None:
        """One step to that time [s], whatever its length."""
        self._model.step_to(time)

    def tip(self) -> Vector:
        """What is compared, relative to the vessel (3,) [m]."""
        place = self._line.sample([self._case.probe * self._line.length]).position[0]
        tip: Vector = place - self._model.vessels[self._case.driven].position
        return tip

    def top_tension(self) -> float:
        """Of the compared line at the vessel [N]."""
        line = self._line
        return line.end_tension if self._case.driven_end else line.start_tension

    def statistics(self) -> dict[str, float]:
        """Counts of the solver."""
        return {key: float(value) for key, value in self._model.statistics.items()}

    def close(self) -> None:
        """Nothing to free."""


@dataclass(frozen=True)
class Settings(MoorDynSettings):
    """How MoorDyn integrates, in words, too."""

    @property
    def words(self) -> str:
        """All but the mesh."""
        return (
            f"{self.scheme} {self.step_factor:g}/omega_max zeta={self.damping:g} "
            f"inputs every {self.coupling_step:g} s"
        )


def moordyn_input(case: SystemCase, settings: Settings, time_step: float) -> str:
    """MoorDyn's input file for a case."""
    cable = case.cable
    points = "\n".join(
        f"{k} {p.kind} {' '.join(map(repr, p.place))} {p.mass!r} {p.volume!r} {p.drag_area!r} "
        f"{p.added_mass!r}"
        for k, p in enumerate(case.points, 1)
    )
    lines = "\n".join(
        f"{k} K {one + 1} {other + 1} {cable.length!r} {settings.segments} -"
        for k, (one, other) in enumerate(case.lines, 1)
    )
    return deck(
        cable,
        settings,
        time_step,
        points=points,
        lines=lines,
        bending=0.0,
        gravity=GRAVITY,
        density=DENSITY,
    )


_RELAXED: dict[tuple[str, int, str], bytes] = {}
"""States after MoorDyn's relaxation, by case, segments and scheme: it takes most of a run."""


class MoorDynSystemRunner:
    """One MoorDyn system, at rest as its own relaxation finds it."""

    def __init__(self, case: SystemCase, times: Sequence[float], settings: Settings) -> None:
        import moordyn

        self._api: Any = moordyn
        cable = case.cable
        spacing = cable.length / settings.segments
        highest = 2.0 / spacing * math.sqrt(cable.axial_stiffness / cable.mass)
        self._longest_step = settings.step_factor / highest
        self._directory = tempfile.TemporaryDirectory()
        path = Path(self._directory.name) / "lines.txt"
        path.write_text(moordyn_input(case, settings, self._longest_step))
        self._coupled = [k for k, point in enumerate(case.points) if point.kind == "Coupled"]
        places = np.array([case.points[k].place for k in self._coupled])
        start = (places + case.motion(0.0)).ravel().tolist()
        with silence():
            self._system = moordyn.Create(str(path))
            moordyn.SetVerbosity(self._system, moordyn.LEVEL_NONE)
            kept = _RELAXED.get((case.name, settings.segments, settings.scheme))
            begin = moordyn.Init if kept is None else moordyn.Init_NoIC
            begin(self._system, start, [0.0] * len(start))
            if kept is not None:
                moordyn.Deserialize(self._system, kept)
            else:
                state = bytes(moordyn.Serialize(self._system))
                _RELAXED[case.name, settings.segments, settings.scheme] = state
        self._line = moordyn.GetLine(self._system, 1)
        node = case.probe * settings.segments
        if node != round(node):
            raise ValueError(f"{settings.segments} segments have no node at the probe")
        self._node = round(node)
        self._first = 3 * self._coupled.index(case.lines[0][case.driven_end])
        self._settings, self._origin = settings, np.mean(places, axis=0)
        self._plan = dict(self._inputs(case, times, places))
        self._moved = np.zeros(3)
        self._force: Sequence[float] = [0.0] * len(start)
        self._steps = 0

    def _inputs(
        self, case: SystemCase, times: Sequence[float], places: Vector
    ) -> Iterator[tuple[float, tuple[float, float, list[Any], Vector]]]:
        """By reference time: internal and coupling step [s], (place, velocity, time) of each
        coupling step, and what the driven points have moved by then; made before the clock starts.
        """
        before = 0.0
        for until in times:
            count = max(1, math.ceil((until - before) / self._settings.coupling_step - 1e-9))
            coupling = (until - before) / count
            # Whole internal steps in a coupling step: a remainder would cost a step of its own.
            internal = coupling / max(1, math.ceil(coupling / self._longest_step - 1e-9))
            instants = before + coupling * np.arange(count + 1)
            moved = np.array([case.motion(float(t)) for t in instants])
            speeds = np.diff(moved, axis=0) / coupling
            rows = [
                ((places + now).ravel().tolist(), np.tile(speed, len(places)).tolist(), float(t))
                for now, speed, t in zip(moved[:-1], speeds, instants[:-1], strict=True)
            ]
            yield until, (internal, coupling, rows, moved[-1])
            before = until

    def advance(self, time: float) -> None:
        """Step to that time; it must be one of those given at the start."""
        internal, coupling, rows, self._moved = self._plan[time]
        self._api.SetDt(self._system, internal)
        step, system, force = self._api.Step, self._system, self._force
        for place, velocity, instant in rows:
            force = step(system, place, velocity, instant, coupling)
        self._force = force
        self._steps += len(rows) * round(coupling / internal)

    def tip(self) -> Vector:
        """What is compared, relative to the vessel (3,) [m]."""
        node = np.array(self._api.GetLineNodePos(self._line, self._node), dtype=np.float64)
        tip: Vector = node - self._origin - self._moved
        return tip

    def top_tension(self) -> float:
        """Net force on the driven end of the compared line [N]."""
        return math.hypot(*self._force[self._first : self._first + 3])

    def statistics(self) -> dict[str, float]:
        """Segments and internal steps."""
        return {"elements": float(self._settings.segments), "steps": float(self._steps)}

    def close(self) -> None:
        """Free the system and its input file."""
        with silence():
            self._api.Close(self._system)
        self._directory.cleanup()


def ours(tolerance: float) -> Contestant:
    """cablemodel at a tolerance."""

    def make(case: Any, _times: Sequence[float]) -> Runner:
        return SystemRunner(case, tolerance)

    return Contestant("cablemodel", f"tau={tolerance:g}", make, "own", compiles=True)


def theirs(settings: Settings) -> Contestant:
    """MoorDyn with settings."""

    def make(case: Any, times: Sequence[float]) -> Runner:
        return MoorDynSystemRunner(case, times, settings)

    return Contestant(f"MoorDyn {settings.words}", f"N={settings.segments}", make, "own")


def _solved(contestant: Contestant, case: Any) -> tuple[Vector, Vector]:
    """Places (n, 3) [m] and tensions (n,) [N] at the case's instants."""
    nowhere = tuple((0.0, 0.0, 0.0) for _ in case.times)
    blank = Reference(case.times, nowhere, None, 0.0, 0.0, "")
    _spent, tips, tensions, _counts = run_once(contestant, case, blank)
    return tips, tensions


def _reference(
    case: SystemCase, tips: Vector, tensions: Vector, other: tuple[Vector, Vector], made: str
) -> Reference:
    """A limit, and how far it is from the coarser solution that it is checked by."""
    off = float(np.linalg.norm(tips - other[0], axis=1).max())
    pull = float(np.abs(tensions - other[1]).max())
    rows = tuple((float(x), float(y), float(z)) for x, y, z in tips)
    return Reference(case.times, rows, tuple(tensions.tolist()), off, pull, made)


def our_limit(case: SystemCase) -> Reference:
    """Of cablemodel alone."""
    fine, check = (_solved(ours(tolerance), case) for tolerance in (FINEST, CHECK))
    return _reference(case, *fine, check, f"tau = {FINEST:g} against {CHECK:g}")


def their_limit(case: SystemCase) -> Reference:
    """Of MoorDyn alone, without damping: what two meshes tend to with the square of segments."""
    coarse, fine = (
        _solved(theirs(Settings(segments, "RK4", 2.7, 0.0, COUPLING_STEPS[0])), case)
        for segments in FINE_SEGMENTS
    )
    share = 1.0 / ((FINE_SEGMENTS[1] / FINE_SEGMENTS[0]) ** 2 - 1.0)
    tips, tensions = (b + share * (b - a) for a, b in zip(coarse, fine, strict=True))
    return _reference(case, tips, tensions, fine, f"N = {FINE_SEGMENTS} extrapolated")


def searched(case: Any, limit: Reference) -> tuple[list[Measurement], list[Settings]]:
    """All schemes, time steps and dampings on one mesh, and what goes on: the cheapest stable one,
    with all coupling steps, whose errors show on finer meshes only."""
    tried = [
        Settings(SEARCHED_ON, scheme, factor, damping, COUPLING_STEPS[1])
        for scheme, factor, damping in TRIED
    ]
    finest = Settings(SEARCHED_ON, "RK4", 1.35, 0.0, COUPLING_STEPS[1])
    found = {settings: measure(theirs(settings), case, limit, 1) for settings in tried}
    least = STABLE * found[finest].tip_error
    stable = [settings for settings, m in found.items() if m.tip_error <= least]
    best = min(stable, key=lambda settings: found[settings].cost)
    going = [replace(best, coupling_step=step) for step in COUPLING_STEPS]
    return list(found.values()), going


def apart(one: Reference, other: Reference, length: float) -> tuple[float, float]:
    """The largest distance of two limits over the length, and of their tensions over the largest
    one."""
    places = np.linalg.norm(one.tip_array() - other.tip_array(), axis=1).max()
    pulls, others = np.array(one.tension), np.array(other.tension)
    return float(places) / length, float(np.abs(pulls - others).max() / pulls.max())


HEAD = (
    "scene", "error / L", "MoorDyn [s/s]", "cablemodel [s/s]", "ratio", "limits apart / L",
    "of tensions",
)  # fmt: skip


def compared(case: Any, tell: Callable[[str], None]) -> tuple[list[Measurement], list[list[str]]]:
    """All runs of a case, and its rows of the table."""
    mine, limit = our_limit(case), their_limit(case)
    place, pull = apart(mine, limit, case.cable.length)
    tell(
        f"{case.name}: limits {place:.1e} L and {pull:.1e} of tensions apart; own checks "
        f"{mine.tip_uncertainty:.1e} m, {limit.tip_uncertainty:.1e} m"
    )
    runs = [measure(ours(tolerance), case, mine, REPEATS) for tolerance in TOLERANCES]
    tried, kept = searched(case, limit)
    tell(f"{case.name}: kept {'; '.join(settings.words for settings in kept)}")
    rival = [
        measure(
            theirs(replace(s, segments=n)), case, limit, REPEATS,
        )
        for s in kept
        for n in SEGMENTS
    ]  # fmt: skip
    for one in (*runs, *rival):
        tell(f"{one.contestant} {one.setting}: {one.cost:.2e} s/s, {one.tip_error:.1e} L")
    rows = []
    for error in ERRORS:
        own, other = (cost_at(front(of), error) for of in (runs, rival))
        if own is None or other is None:
            continue
        reached = not other[1]
        rows.append([
            case.name, number(error, 1), number(other[0]) if reached else "not reached",
            number(own[0]), f"{other[0] / own[0]:.3g}" if reached else "",
            number(place, 1), number(pull, 1),
        ])  # fmt: skip
    return [*runs, *tried, *rival], rows


def main() -> None:
    """Measure the cases; write their rows and the table of the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.systems", description=__doc__)
    parser.add_argument("--only", choices=CASES, help="one of them; rows of the others stay")
    parser.add_argument("--report", action="store_true", help="only write the table anew")
    chosen = parser.parse_args()
    for name, case in CASES.items():
        if chosen.only in (None, name) and not chosen.report:
            runs, rows = compared(case, lambda text: print(text, flush=True))
            keep(FOLDER / "systems.csv", MEASUREMENT_HEAD, name, measurement_rows(runs))
            keep(FOLDER / "systems_ratios.csv", HEAD, name, rows)
    rows_kept = read_rows(FOLDER / "systems_ratios.csv")
    shown = [(*row.values(), ASKED.get(row["scene"], "")) for row in rows_kept]
    write_part(PAGE, "systems", table((*HEAD, "asked"), shown))


def keep(path: Path, head: Sequence[str], name: str, rows: Sequence[Sequence[str]]) -> None:
    """Replace the rows of a case in a data file."""
    before = read_rows(path) if path.exists() else []
    of_case = {case: [list(row.values()) for row in before if row["scene"] == case]
               for case in CASES}  # fmt: skip
    of_case[name] = [list(row) for row in rows]
    write_rows(path, head, (row for case in CASES for row in of_case[case]))


if __name__ == "__main__":
    main()
