"""The robustness matrix: stiffnesses over many decades, hard starts, any step of the caller.

Three scenes that break explicit and naive implicit integrators, each for every pair of bending
and axial stiffness, each stepped by the caller with 1 ms, 0.1 s and 2 s:

zero tension: a horizontal cable, unstretched and at rest in water, is released;
whip: the same in air, whose free end cracks after 1.3 s;
inverted column: the cable stands on the vessel, tilted by 0.01 rad, and falls over in water.

A run is ``completed`` when every step was made and everything it reports is finite. Runs that
differ in the caller's step only must agree at the instants that they share. The run with 2 s
steps then goes on until drag must have taken nearly all energy: at no time may there be more
energy than at the start (nothing feeds any in), and at the end next to none may be left.
``python -m benchmarks.robustness`` writes ``docs/stress/robustness.csv``, and its summary into
``docs/stress.md``.
"""

from __future__ import annotations

import argparse
import itertools
import math
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.scenes import GRAVITY, Cable
from benchmarks.sections import read_rows, table, write_part, write_rows

BENDING_STIFFNESSES = (0.0, 1e-3, 0.1, 1.0, 10.0)
AXIAL_STIFFNESSES = (1e4, 1e5, 1e6, 1e7, 1e9)
CALLER_STEPS = (0.001, 0.1, 2.0)
SHORT_STEP_DURATION = 0.2
"""How long the run with 1 ms steps lasts [s]."""
TOLERANCE = 1e-3
"""The scenes' tolerance tau: positions within tau L."""
LENGTH = 10.0
TILT = 0.01
MOST_ENERGY = 1.01
"""Largest energy over that of the start that still counts as none fed in [-]."""


@dataclass(frozen=True)
class HardScene:
    """A scene of the matrix.

    agreement: how far apart two runs may be, in units of tau L, at instants up to
    ``predictable`` seconds. Later the motion multiplies every difference (a whip that has
    cracked, a column that has buckled), and only the energy is asked.
    ``predictable_flexible``: the same where EI is below 0.1 N m2. A column without bending has
    no well-posed motion: the shortest waves that the mesh holds grow fastest.
    settled: time at which drag has taken all energy but the share ``left`` [s].
    """

    name: str
    in_water: bool
    direction: tuple[float, float, float]
    duration: float
    predictable: float
    settled: float
    left: float
    agreement: float = 2.0
    predictable_flexible: float = math.inf

    def agrees_until(self, bending_stiffness: float) -> float:
        """Last instant at which runs are compared [s]."""
        if bending_stiffness < 0.1:
            return min(self.predictable, self.predictable_flexible)
        return self.predictable


HARD_SCENES = (
    HardScene("zero tension", True, (1.0, 0.0, 0.0), 6.0, 6.0, 60.0, 0.01),
    HardScene("whip", False, (1.0, 0.0, 0.0), 4.0, 1.25, 80.0, 0.02),
    HardScene(
        "inverted column",
        True,
        (math.sin(TILT), 0.0, math.cos(TILT)),
        10.0,
        0.5,
        60.0,
        0.01,
        predictable_flexible=0.1,
    ),
)


@dataclass
class Outcome:
    """What came out of one run.

    tips: time [s] -> free end (3,) [m] at the end of the steps where runs are compared.
    most_energy, energy_left: highest and last energy above that of the hanging cable, over the
    energy of the start [-]; only of the run that goes on until it has settled.
    """

    scene: str
    bending_stiffness: float
    axial_stiffness: float
    caller_step: float
    completed: bool
    message: str = ""
    wall_time: float = 0.0
    most_energy: float = math.nan
    energy_left: float = math.nan
    tips: dict[float, NDArray[np.float64]] = field(default_factory=dict)
    statistics: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Disagreement:
    """Largest distance between runs of the same scene with different caller steps [tau L]."""

    distance: float
    instant: float
    within: bool


def scene_dict(
    scene: HardScene, bending_stiffness: float, axial_stiffness: float, model: str = "elastica"
) -> dict[str, Any]:
    """The scene in the project's schema. EI = 0 takes the flexible model."""
    cable = Cable(
        length=LENGTH,
        bending_stiffness=bending_stiffness,
        axial_stiffness=axial_stiffness,
        submerged_weight=2.33333 if scene.in_water else 0.4613 * GRAVITY,
    )
    return {
        "title": f"robustness: {scene.name}",
        "environment": {
            "gravity": GRAVITY,
            "water_density": 1025.0 if scene.in_water else 1.2,
        },
        "cable_types": {"K": cable.cable_type()},
        "line": [
            {
                "cable": {
                    "type": "K",
                    "length": LENGTH,
                    "model": model if bending_stiffness > 0.0 else "cable",
                }
            }
        ],
        "end": "free",
        "initial": {"straight": list(scene.direction)},
        "vessel": {"position": [0.0, 0.0, 0.0], "velocity": [{"t": 0.0, "velocity": [0, 0, 0]}]},
        "solver": {"method": "finite_element", "tolerance": TOLERANCE},
        "run": {"duration": scene.duration, "output_interval": scene.duration},
    }


def _is_finite(state: Any) -> bool:
    return all(
        bool(np.all(np.isfinite(getattr(state, name))))
        for name in ("position", "velocity", "tension", "tangent")
    )


def run_one(
    scene: HardScene,
    bending_stiffness: float,
    axial_stiffness: float,
    caller_step: float,
    model: str = "elastica",
) -> Outcome:
    """Step one scene to its end with one caller step; never raises for a failing run."""
    import cablemodel as cm

    outcome = Outcome(scene.name, bending_stiffness, axial_stiffness, caller_step, completed=False)
    duration = SHORT_STEP_DURATION if caller_step < 0.01 else scene.duration
    count = round(duration / caller_step)
    started = time.perf_counter()
    try:
        instance = cm.CableModel(
            cm.load_scene(scene_dict(scene, bending_stiffness, axial_stiffness, model))
        )
        at_start = energy_above_rest(scene, instance)
        for index in range(1, count + 1):
            # From the target time, so that the instants of all runs are the same numbers.
            instance.step(index * caller_step - instance.time)
            instant = round(index * caller_step, 6)
            outcome.tips[instant] = np.array(instance.tip_position, dtype=np.float64)
            if not np.all(np.isfinite(outcome.tips[instant])):
                outcome.message = f"tip not finite at {instant:g} s"
                return outcome
        state = instance.state()
        if not _is_finite(state):
            outcome.message = "state not finite"
            return outcome
        outcome.statistics = {
            key: float(value)
            for key, value in instance.statistics.items()
            if isinstance(value, int | float)
        }
        if caller_step == CALLER_STEPS[-1]:
            settle(scene, instance, at_start, outcome)
    except (cm.CableModelError, ArithmeticError, ValueError) as error:
        outcome.message = f"{type(error).__name__}: {error}".splitlines()[0][:160]
        return outcome
    finally:
        outcome.wall_time = time.perf_counter() - started
    outcome.completed = True
    return outcome


def energy_above_rest(scene: HardScene, instance: Any) -> float:
    """Mechanical energy above that of the cable hanging at rest, unstretched [J]."""
    weight = 2.33333 if scene.in_water else 0.4613 * GRAVITY
    energy = instance.energy()
    stored = sum(energy[name] for name in ("kinetic", "axial", "bending", "potential"))
    return float(stored) + 0.5 * weight * LENGTH**2


def settle(scene: HardScene, instance: Any, at_start: float, outcome: Outcome) -> None:
    """Step on until the cable must have come to rest; note the highest and the last energy."""
    outcome.most_energy = energy_above_rest(scene, instance) / at_start
    while instance.time < scene.settled:
        instance.step(CALLER_STEPS[-1])
        outcome.energy_left = energy_above_rest(scene, instance) / at_start
        outcome.most_energy = max(outcome.most_energy, outcome.energy_left)
        if not outcome.most_energy < 10.0:
            break


def energy_is_right(scene: HardScene, outcome: Outcome) -> bool:
    """Whether a run that went on until rest has gained no energy and lost nearly all of it."""
    return outcome.most_energy <= MOST_ENERGY and outcome.energy_left <= scene.left


def compare(scene: HardScene, outcomes: Sequence[Outcome]) -> Disagreement:
    """Largest distance between completed runs at the instants that two of them share."""
    worst, instant_of_worst = 0.0, 0.0
    for one, other in itertools.combinations([o for o in outcomes if o.completed], 2):
        for instant in one.tips.keys() & other.tips.keys():
            if instant > scene.agrees_until(one.bending_stiffness):
                continue
            distance = float(np.linalg.norm(one.tips[instant] - other.tips[instant]))
            if distance > worst:
                worst, instant_of_worst = distance, instant
    scaled = worst / (TOLERANCE * LENGTH)
    return Disagreement(scaled, instant_of_worst, scaled <= scene.agreement)


@dataclass
class Row:
    """One scene and one pair of stiffnesses: a run per caller step, and how they agree."""

    scene: str
    bending_stiffness: float
    axial_stiffness: float
    outcomes: list[Outcome]
    disagreement: Disagreement
    energy_right: bool

    @property
    def passed(self) -> bool:
        """All runs completed and agreed, and the energy is what it must be."""
        completed = all(o.completed for o in self.outcomes)
        return completed and self.disagreement.within and self.energy_right


def run_matrix(
    scenes: Iterable[HardScene] = HARD_SCENES,
    bending_stiffnesses: Sequence[float] = BENDING_STIFFNESSES,
    axial_stiffnesses: Sequence[float] = AXIAL_STIFFNESSES,
    caller_steps: Sequence[float] = CALLER_STEPS,
    report: Callable[[Row], None] = lambda _row: None,
) -> list[Row]:
    """Every combination; ``report`` is called with every row as it comes."""
    rows = []
    for scene, bending, axial in itertools.product(scenes, bending_stiffnesses, axial_stiffnesses):
        outcomes = [run_one(scene, bending, axial, step) for step in caller_steps]
        row = Row(
            scene.name,
            bending,
            axial,
            outcomes,
            compare(scene, outcomes),
            all(energy_is_right(scene, o) for o in outcomes if o.caller_step == CALLER_STEPS[-1]),
        )
        rows.append(row)
        report(row)
    return rows


def describe_row(row: Row) -> tuple[str, ...]:
    """A row of the outcome table."""
    cells = [
        f"ok, {outcome.statistics.get('steps', math.nan):.0f} steps, {outcome.wall_time:.2f} s"
        if outcome.completed
        else outcome.message
        for outcome in row.outcomes
    ]
    agreement = f"{row.disagreement.distance:.2g} at {row.disagreement.instant:g} s"
    last = row.outcomes[-1]
    return (
        row.scene,
        f"{row.bending_stiffness:g}",
        f"{row.axial_stiffness:g}",
        *cells,
        agreement,
        f"{last.most_energy:.3g}, {last.energy_left:.2g}",
        "passed" if row.passed else "**failed**",
    )


PAGE = Path("docs/stress.md")
STORE = Path("docs/stress/robustness.csv")
HEAD = (
    "scene", "EI [N m2]", "EA [N]",
    *(f"steps of {step:g} s" for step in CALLER_STEPS),
    "apart [tau L]", "most energy", "energy left", "outcome",
)  # fmt: skip


def fields(row: Row) -> tuple[object, ...]:
    """A row of the data file: what was run, the steps of each run, how they agree, energies."""
    last = row.outcomes[-1]
    return (
        row.scene,
        f"{row.bending_stiffness:g}",
        f"{row.axial_stiffness:g}",
        *(
            f"{outcome.statistics.get('steps', math.nan):.0f}"
            if outcome.completed
            else outcome.message
            for outcome in row.outcomes
        ),
        f"{row.disagreement.distance:.2g}",
        f"{last.most_energy:.3g}",
        f"{last.energy_left:.2g}",
        "passed" if row.passed else "failed",
    )


def summary(rows: Sequence[dict[str, str]]) -> str:
    """A row for each scene, from the data file."""
    lines = []
    for scene in HARD_SCENES:
        mine = [row for row in rows if row["scene"] == scene.name]
        until = f"{scene.predictable:g} s"
        if math.isfinite(scene.predictable_flexible):
            until += f" ({scene.predictable_flexible:g} s for EI < 0.1)"
        lines.append(
            (
                scene.name,
                "water" if scene.in_water else "air",
                f"{sum(row['outcome'] == 'passed' for row in mine)} of {len(mine)}",
                f"{max(float(row['apart [tau L]']) for row in mine):.2g}",
                f"{scene.agreement:g} up to {until}",
                f"{max(float(row['most energy']) for row in mine):.2g}",
                f"{max(float(row['energy left']) for row in mine):.2g} at {scene.settled:g} s",
                f"{scene.left:g}",
            )
        )
    head = (
        "scene", "in", "passed", "apart [tau L]", "allowed", "most energy", "left", "allowed",
    )  # fmt: skip
    return table(head, lines)


def main(given: Sequence[str] | None = None) -> None:
    """Run the matrix, or a part of it; keep the rows of a whole one, and write their summary."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.robustness")
    parser.add_argument("--only", default="", help="part of a scene's name")
    chosen = parser.parse_args(given)
    scenes = [scene for scene in HARD_SCENES if chosen.only in scene.name]
    rows = run_matrix(scenes, report=lambda row: print(" | ".join(describe_row(row)), flush=True))
    if not chosen.only:
        write_rows(STORE, HEAD, [fields(row) for row in rows])
        write_part(PAGE, "robustness", summary(read_rows(STORE)))
    failed = [row for row in rows if not row.passed]
    print(f"{len(rows) - len(failed)} of {len(rows)} passed")
    if failed:
        raise SystemExit(1)


if __name__ == "__main__":
    main()
