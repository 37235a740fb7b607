"""Soaks: a million steps of 10 ms of the model that the ROS 2 node runs, under random commands.

``python -m benchmarks.soak``: S4's line in space, alone, with a winch and several streams of random
numbers, above a floor that it trails over, and with a body at its end; for an hour with all of
them together. Every few seconds (at
random) vessel velocity, pay-out rate and current get new random targets, which the commands
approach as a vessel and a winch would. What must hold: no step fails, every number is finite,
lengths are exact, memory stays flat, and the energy of the cable neither grows from tenth to tenth
of the run nor ever exceeds what commands of this size can give. With all of them together every
tenth of a second takes less than that of processor time.

One of them: ``--only [--winch] [--floor] [--body] [--seed N]``, which prints and writes no page;
with ``--keep FILE`` what leads to the first failure is pickled there: the ``scene``, a ``snapshot``
one to two seconds before, and the ``steps`` from there on: time, and the arguments of ``step_to``.
"""

from __future__ import annotations

import argparse
import json
import pickle
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.sections import table, write_part

STEP = 0.01
"""Time between commands [s]."""
FASTEST, PAYOUT, CURRENT = 2.0, 0.5, 0.8
"""Largest horizontal speed, pay-out rate and current commanded [m/s]; heave is a quarter."""
HOLD = 8.0
"""Mean time between new targets [s]."""
MEAN_HEIGHT = -20.0
"""Where the vessel starts and is led back to, slowly: it heaves some metres about it [m]."""
BODY = {
    "mass": 4.0,
    "submerged_weight": 25.0,
    "added_mass": 0.8,
    "drag_area": 0.01,
    "drag_coefficient": 0.6,
}
"""A sinker: twice the weight of the line."""
FLOOR = -32.0
"""Height of the floor [m]: 12 m below where the vessel is led back to, never above its heave."""
SEED = 8
"""Of the random numbers."""
MEMORY = 0.97
"""Share of the fastest speed commanded that still counts a second later."""
MEMORY_GROWTH = 2.0
"""Memory of the process that may be added after the first tenth [MB]."""


@dataclass(frozen=True)
class Kind:
    """What is soaked: with a winch, above a floor, with a body at the end; seed of the commands."""

    winch: bool = False
    floor: bool = False
    body: bool = False
    seed: int = SEED

    @property
    def steps(self) -> int:
        """How many there are: an hour of all that may be there together."""
        return 360_000 if self.winch and self.floor and self.body else 1_000_000


KINDS = (
    Kind(),
    *(Kind(winch=True, seed=SEED + k) for k in range(4)),
    Kind(floor=True),
    Kind(floor=True, body=True),
    Kind(winch=True, floor=True, body=True),
)
"""The soaks of the page."""


@dataclass
class Soak:
    """What a soak measured.

    memory: of the process after each tenth [MB]. kinetic: largest kinetic energy in each tenth over
    that of the whole line at the fastest speed relative to the water [-]. recent: the same over
    that of what is out at the fastest speed commanded of late (see :data:`MEMORY`) [-].
    highest: largest tension in each tenth [N]. cost: processor time in each tenth [s].
    slowest: longest processor time of a tenth of a second [s], and when [s]; late: how many took
    longer than that. length_error: largest change of line and drum together [m]. clamped,
    touching: looks at which the drum was at one of its ends, cable lay on the floor.
    """

    steps: int
    failed: int = 0
    slow: str = ""
    memory: list[float] = field(default_factory=list)
    kinetic: list[float] = field(default_factory=list)
    recent: list[float] = field(default_factory=list)
    highest: list[float] = field(default_factory=list)
    slowest: tuple[float, float] = (0.0, 0.0)
    late: int = 0
    length_error: float = 0.0
    finite: bool = True
    clamped: int = 0
    touching: int = 0
    cost: list[float] = field(default_factory=list)
    first_failure: str = ""
    kind: Kind = field(default_factory=Kind)

    @property
    def problems(self) -> list[str]:
        """What does not hold."""
        found = []
        if self.failed:
            found.append(f"{self.failed} steps failed, first: {self.first_failure}")
        if self.slow:
            found.append(self.slow)
        if self.late and self.kind.winch and self.kind.floor and self.kind.body:
            found.append(
                f"{self.late} tenths of a second took longer, one {self.slowest[0]:.2g} s"
                f" at t = {self.slowest[1]:g} s"
            )
        if not self.finite:
            found.append("a number was not finite")
        if self.length_error > 1e-9:
            found.append(f"{self.length_error:.1e} m of cable appeared")
        if len(self.memory) < 10:
            found.append(f"given up in tenth {len(self.memory) + 1}")
        elif self.memory[-1] - self.memory[0] > MEMORY_GROWTH:
            found.append(f"memory grew by {self.memory[-1] - self.memory[0]:.1f} MB")
        if max(self.recent, default=0.0) > 1.5:
            found.append("more kinetic energy than commands can give")
        if len(self.recent) == 10 and max(self.recent[-3:]) > 1.5 * max(self.recent[:3]):
            found.append("energy grew")
        return found


def soak_scene(kind: Kind) -> dict[str, Any]:
    """S4's line, at rest; with a winch that holds 30 m more."""
    from benchmarks.scenes import SCENES

    scene = {**SCENES["S4"].scene, "title": "soak"}
    scene["vessel"] = {
        "position": [0.0, 0.0, MEAN_HEIGHT],
        "velocity": [{"t": 0.0, "velocity": [0.0, 0.0, 0.0]}],
    }
    cable = {"cable": {"type": "K", "length": 30.0, "model": "hybrid"}}
    scene["line"] = [cable]
    if kind.body:
        scene["line"] = [cable, {"body": {**BODY}}]
    if kind.winch:
        scene["payout"] = {"drum": [cable]}
    if kind.floor:
        floor = {"z": FLOOR, "friction": 0.3}
        scene["environment"] = {**scene["environment"], "floor": floor}
    return scene


def resident() -> float:
    """Memory of this process [MB]."""
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * 4096 / 1e6


TENTH = 10
"""Steps of a tenth of a second."""
GIVE_UP = 10
"""Failed steps after which a soak ends."""
TOO_SLOW = 1e-2
"""Mean time of a step [s] at which a soak ends: a hundred times the usual one."""


def soak(steps: int, kind: Kind, keep: Path | None = None) -> Soak:
    """Step on; failed steps are counted, and asked for again without commands.

    keep: file for what leads to the first failure.
    """
    import cablemodel as cm

    rng = np.random.default_rng(kind.seed)
    scene = soak_scene(kind)
    model = cm.CableModel(cm.load_scene(scene), planar=False)
    total = model.line_length + model.drum_length
    scale = kinetic_scale(scene, total) * (FASTEST + CURRENT) ** 2
    found = Soak(steps, kind=kind)
    command, target = np.zeros(7), np.zeros(7)
    sizes = np.array([FASTEST, FASTEST, 0.25 * FASTEST, PAYOUT, CURRENT, CURRENT, 0.0])
    lag = np.array([5.0, 5.0, 1.0, 1.0, 10.0, 10.0, 1.0])
    kinetic = highest = recent = fastest = 0.0
    before: tuple[Any, list[Any]] = (model.snapshot(), [])
    earlier: tuple[Any, list[Any]] = (model.snapshot(), [])
    began = looked = tenth = time.process_time()
    for index in range(1, steps + 1):
        if rng.random() < STEP / HOLD:
            target = rng.uniform(-1.0, 1.0, 7) * sizes
            target[:2] *= FASTEST / max(float(np.hypot(*target[:2])), FASTEST)
        target[2] -= 0.01 * (model.vessel_position[2] - MEAN_HEIGHT) * STEP
        command += (target - command) * STEP / lag
        inputs: dict[str, Any] = {
            "vessel_velocity": command[:3].copy(),
            "payout_rate": float(command[3]) if kind.winch else None,
            "current": command[4:].copy(),
        }
        if keep is not None:
            if index % 100 == 0:
                before, earlier = earlier, (model.snapshot(), [])
            for _snapshot, since in (before, earlier):
                since.append((index * STEP, inputs))
        try:
            model.step_to(index * STEP, **inputs)
        except cm.StepError as error:
            found.failed += 1
            found.first_failure = found.first_failure or str(error)
            if keep is not None and found.failed == 1:
                snapshot, since = before
                kept = {"scene": scene, "snapshot": snapshot, "steps": since}
                keep.write_bytes(pickle.dumps(kept))
            command *= 0.0
            if found.failed >= GIVE_UP:
                break
            continue
        if index % TENTH == 0:
            took = time.process_time() - tenth
            found.slowest = max(found.slowest, (took, model.time))
            found.late += took > TENTH * STEP
        if index % 100 == 0:
            if time.process_time() - looked > 100.0 * TOO_SLOW:
                found.slow = f"at t = {model.time:g} s a step takes more than {TOO_SLOW:g} s"
                break
            looked = time.process_time()
            energy = model.energy()["kinetic"]
            now = float(np.linalg.norm(command[:3]) + np.linalg.norm(command[4:])) + abs(command[3])
            fastest = max(now, fastest * MEMORY ** (100 * STEP))
            if fastest > 0.1 * FASTEST:
                out = kinetic_scale(scene, model.line_length) * fastest**2
                recent = max(recent, float(energy / out))
            kinetic, highest = max(kinetic, energy / scale), max(highest, model.tension_max)
            found.finite &= bool(np.isfinite([energy, highest, *model.tip_position]).all())
            apart = abs(model.line_length + model.drum_length - total)
            found.length_error = max(found.length_error, apart)
            found.clamped += model.winch != "free"
            found.touching += model.floor_length > 0.0
        if index % TENTH == 0:
            tenth = time.process_time()
        if index % (steps // 10) == 0:
            found.memory.append(resident())
            found.kinetic.append(kinetic)
            found.recent.append(recent)
            found.highest.append(highest)
            found.cost.append(time.process_time() - began)
            print(
                f"{len(found.cost)}/10: {found.cost[-1]:.1f} s, {found.failed} failed", flush=True
            )
            began = time.process_time()
            kinetic = highest = recent = 0.0
    return found


def kinetic_scale(scene: dict[str, Any], length: float) -> float:
    """Kinetic energy of that length of cable, and bodies, at 1 m/s in the water [J]."""
    cable = scene["cable_types"]["K"]
    mass = length * (cable["mass"] + 1025.0 * np.pi / 4.0 * cable["diameter"] ** 2)
    for item in scene["line"]:
        if "body" in item:
            mass += item["body"]["mass"] + item["body"]["added_mass"]
    return float(0.5 * mass)


PAGE = Path("docs/stress.md")
STORE = Path("docs/stress/soak.json")


def summary(soaks: list[Soak]) -> str:
    """A row for each kind of soak: how many hold, and the most of what is watched."""
    kinds: dict[str, list[Soak]] = {}
    for found in soaks:
        parts = [name for name in ("winch", "floor", "body") if getattr(found.kind, name)]
        kinds.setdefault(", ".join(parts) or "line alone", []).append(found)
    rows = [
        (
            kind,
            f"{sum(not one.problems for one in mine)} of {len(mine)}",
            f"{max(max(one.recent) for one in mine):.2f}",
            f"{max(one.memory[-1] - one.memory[0] for one in mine):.1f}",
        )
        for kind, mine in kinds.items()
    ]
    return table(("with", "hold", "kinetic energy, of what commands give", "memory [MB]"), rows)


def main() -> None:
    """Soak, write the section; fails where something does not hold."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.soak", description=__doc__)
    parser.add_argument("--steps", type=int, help="instead of as many as the kind has")
    parser.add_argument("--only", action="store_true", help="one soak, of the kind that follows")
    for name in ("winch", "floor", "body"):
        parser.add_argument(f"--{name}", action="store_true")
    parser.add_argument("--seed", type=int, default=SEED)
    parser.add_argument("--keep", type=Path, help="file for what leads to the first failure")
    chosen = parser.parse_args()
    kinds = KINDS
    if chosen.only:
        kinds = (Kind(chosen.winch, chosen.floor, chosen.body, chosen.seed),)
    soaks = []
    for kind in kinds:
        soaks.append(soak(chosen.steps or kind.steps, kind, chosen.keep))
        print(asdict(soaks[-1]), flush=True)
    if not chosen.only:
        STORE.write_text(json.dumps([asdict(found) for found in soaks], indent=1) + "\n")
        write_part(PAGE, "soaks", summary(soaks))
    problems = [problem for found in soaks for problem in found.problems]
    if problems:
        raise SystemExit("; ".join(problems))


if __name__ == "__main__":
    main()
