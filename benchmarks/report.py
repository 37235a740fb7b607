"""The report: measurements as data files and figures, and short tables of them on a page.

What the tables mean is written by hand in ``docs/benchmarks.md``.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

from benchmarks.compare import Ratio, cheapest_within, ratio
from benchmarks.contestants import DIRECT, OURS
from benchmarks.figures import work_precision_figure
from benchmarks.measure import Measurement
from benchmarks.rivals import MOORDYN_CURVES
from benchmarks.scaling import SERIES, ScalingPoint, exponent, scaling_figure
from benchmarks.scenes import SCENES, BenchmarkScene
from benchmarks.sections import read_rows, table, write_part, write_rows
from benchmarks.startup import StartUp

PAGE = Path("docs/benchmarks.md")
FOLDER = Path("docs/benchmarks")
"""Data and figures."""
SECOND = "second_machine.csv"
"""Ratios that another machine measured, for comparison."""


def number(value: float | None, digits: int = 2) -> str:
    """A number in scientific notation, or a dash."""
    return "-" if value is None or value != value else f"{value:.{digits - 1}e}"


def is_ours(measurement: Measurement) -> bool:
    """Whether cablemodel made it with bending, as peers and references have it.

    The flexible model is drawn and listed, but it solves an easier problem.
    """
    name = measurement.contestant
    return name.startswith(OURS) and name != f"{OURS} cable"


TARGET_HEAD = ("scene", "error asked", "at most [s/s]", "measured [s/s]", "met")


def target_rows(
    scenes: Sequence[BenchmarkScene], results: Sequence[Measurement]
) -> list[tuple[str, ...]]:
    """What was asked of each scene, first and beyond, and the cheapest of our settings for it."""
    rows = []
    asked_of = [(scene, "", scene.target) for scene in scenes]
    asked_of += [(scene, ", beyond", scene.goal) for scene in scenes]
    for scene, which, target in asked_of:
        if target is None:
            continue
        best = cheapest_within([m for m in results if m.scene == scene.name and is_ours(m)], target)
        errors = {"tip": target.tip_error, "T": target.tension_error}
        asked = ", ".join(
            f"{name} {number(error, 1)}{' L' if name == 'tip' else ''}"
            for name, error in errors.items()
            if error is not None and math.isfinite(error)
        )
        rows.append(
            (
                scene.name + which,
                asked,
                number(target.cost),
                number(best.cost) if best else "none",
                "yes" if best and best.cost <= target.cost else "no",
            )
        )
    return rows


UNASKED_ERRORS = (1e-3, 1e-4)
"""Position errors at which scenes without a target are compared, over the length [-]."""


def ratios(scenes: Sequence[BenchmarkScene], results: Sequence[Measurement]) -> list[Ratio]:
    """Our cheapest curve against each peer's, at the error that the scene asks for and at ten times
    that."""
    found = []
    for scene in scenes:
        of_scene = [m for m in results if m.scene == scene.name]
        mine = [m for m in of_scene if is_ours(m)]
        others = [m for m in of_scene if not m.contestant.startswith((OURS, DIRECT))]
        asked = scene.target.tip_error if scene.target is not None else math.inf
        errors = (10.0 * asked, asked) if math.isfinite(asked) else UNASKED_ERRORS
        for peer in dict.fromkeys(m.contestant for m in others):
            theirs = [m for m in others if m.contestant == peer]
            for error in errors:
                one = ratio(scene.name, peer, error, mine, theirs)
                if one is not None:
                    found.append(one)
    return found


RATIO_HEAD = ("scene", "peer", "tip error / L", "peer [s/s]", "cablemodel [s/s]", "ratio", "asked")


def ratio_rows(
    scenes: Sequence[BenchmarkScene], results: Sequence[Measurement]
) -> list[tuple[str, ...]]:
    """Ratios at equal error of position; none where a peer's best setting does not reach it."""
    rows = []
    for one in ratios(scenes, results):
        target = SCENES[one.scene].target
        asked = (
            f"{target.ratio:.0f}"
            if target is not None
            and one.tip_error == target.tip_error
            and one.peer == MOORDYN_CURVES[0][0]
            else ""
        )
        rows.append(
            (
                one.scene,
                one.peer,
                number(one.tip_error, 1),
                "not reached" if one.theirs_extrapolated else number(one.theirs),
                number(one.ours) + (" (extrapolated)" if one.ours_extrapolated else ""),
                "" if one.theirs_extrapolated else f"{one.ratio:.3g}",
                asked,
            )
        )
    return rows


def ratio_table(rows: Sequence[dict[str, str]], second: Sequence[dict[str, str]]) -> str:
    """Each simulator at its best, at the smallest error that a scene is compared at.

    Beside it the ratio of a second machine.
    """

    def key(row: dict[str, str]) -> tuple[str, str, str]:
        return row["scene"], row["peer"], row["tip error / L"]

    there = {key(row): row["ratio"] for row in second}
    finest: dict[str, float] = {}
    for row in rows:
        error = float(row["tip error / L"])
        finest[row["scene"]] = min(error, finest.get(row["scene"], error))
    head = ("scene", "peer", "error / L", "peer [s/s]", "cablemodel [s/s]", "ratio", "second")
    best: dict[tuple[str, str], dict[str, str]] = {}
    for row in rows:
        if float(row["tip error / L"]) != finest[row["scene"]]:
            continue
        simulator = row["scene"], row["peer"].split()[0]
        if float(row["ratio"] or "inf") <= float(best.get(simulator, row)["ratio"] or "inf"):
            best[simulator] = row
    lines = [
        (*key(row), *(row[name] for name in RATIO_HEAD[3:6]), there.get(key(row), ""))
        for row in best.values()
    ]
    return table(head, lines)


MEASUREMENT_HEAD = (
    "scene", "contestant", "setting", "s/s", "tip error / L", "T error", "elements", "steps",
    "failure",
)  # fmt: skip


def measurement_rows(results: Sequence[Measurement]) -> list[tuple[str, ...]]:
    """Every run of every contestant."""
    return [
        (
            m.scene,
            m.contestant,
            m.setting,
            number(m.cost),
            number(m.tip_error),
            number(m.tension_error),
            f"{m.statistics.get('elements', float('nan')):.0f}",
            f"{m.statistics.get('steps', float('nan')):.0f}",
            "" if m.failure is None else m.failure.splitlines()[0][:100],
        )
        for m in results
    ]


MOST_MEMORY = 4000.0
"""Memory of an instance per element, at most [bytes]."""


def scaling_table(points: Sequence[ScalingPoint]) -> str:
    """The exponents of every series, and the memory of an element."""
    rows = []
    for series in SERIES:
        mine = [p for p in points if p.series == series.name]
        used = [p for p in mine if series.from_size <= p.size <= series.to_size]
        if len(used) < 2:
            continue
        sizes = [p.size for p in used]
        largest = used[-1]
        rows.append(
            (
                series.name,
                f"{sizes[0]:g} to {sizes[-1]:g}",
                f"{exponent(sizes, [p.cost for p in used]):.2f}",
                f"{exponent(sizes, [p.cost / p.steps for p in used]):.2f}",
                f"{exponent(sizes, [p.build for p in used]):.2f}",
                number(largest.cost / largest.steps),
                f"{largest.memory / 1e6:.3g}",
            )
        )
    head = ("varied", "sizes", "stepping", "a step", "start", "CPU s a step", "memory [MB]")
    largest = max(points, key=lambda p: p.elements)
    each = largest.memory / largest.elements
    return table(head, rows) + (
        f"\nExponents of processor time; the last two columns are of the largest size. Memory: "
        f"{each:.0f} bytes an element (asked: at most {MOST_MEMORY:g}).\n"
    )


def start_up_table(start_up: StartUp) -> str:
    """Import, warm start and first start against what was asked."""
    rows = [
        ("import cablemodel", f"{start_up.import_time:.2f}", "0.5"),
        ("import to the end of a first step, kernels cached", f"{start_up.warm_start:.2f}", "1.5"),
    ]
    if start_up.first_start is not None:
        rows.append(
            (
                "the same without a compiled library or cached kernels",
                f"{start_up.first_start:.1f}",
                "60",
            )
        )
    return table(("what", "wall s", "asked"), rows)


def write(
    machine: dict[str, str],
    results: Sequence[Measurement],
    scaling: Sequence[ScalingPoint] = (),
    start_up: StartUp | None = None,
) -> None:
    """Write data files and figures, and the generated parts of the page."""
    names = {m.scene for m in results}
    scenes = [scene for name, scene in SCENES.items() if name in names]
    for scene in scenes:
        picture = FOLDER / f"work_precision_{scene.name}.png"
        work_precision_figure(scene, [m for m in results if m.scene == scene.name], picture)
    write_rows(FOLDER / "measurements.csv", MEASUREMENT_HEAD, measurement_rows(results))
    write_rows(FOLDER / "ratios.csv", RATIO_HEAD, ratio_rows(scenes, results))
    versions = ", ".join(f"{what} {value}" for what, value in machine.items() if what != "load")
    write_part(PAGE, "machine", f"Measured with {versions}.")
    targets = target_rows(scenes, results)
    write_rows(FOLDER / "targets.csv", TARGET_HEAD, targets)
    missed = [row for row in targets if row[-1] == "no"]
    kept = f"{len(targets) - len(missed)} of {len(targets)} are met. Not met:"
    write_part(PAGE, "asked", f"{kept}\n\n{table(TARGET_HEAD[:-1], [row[:-1] for row in missed])}")
    second = FOLDER / SECOND
    write_part(
        PAGE,
        "ratios",
        ratio_table(read_rows(FOLDER / "ratios.csv"), read_rows(second) if second.exists() else ()),
    )
    if scaling:
        scaling_figure(scaling, FOLDER / "scaling.png")
        write_part(PAGE, "scaling", scaling_table(scaling))
    if start_up is not None:
        write_part(PAGE, "start-up", start_up_table(start_up))
