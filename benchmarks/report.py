"""The report: measurements as Markdown tables, with figures beside them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from pathlib import Path

from benchmarks.compare import Ratio, cheapest_within, ratio
from benchmarks.contestants import DIRECT, OURS
from benchmarks.figures import work_precision_figure
from benchmarks.measure import Measurement
from benchmarks.references import load as load_references
from benchmarks.rivals import MOORDYN_CURVES
from benchmarks.scaling import SERIES, ScalingPoint, exponent, scaling_figure
from benchmarks.scenes import SCENES, BenchmarkScene
from benchmarks.startup import StartUp

HEADER = """# Run time against error

For those who choose a simulator or a tolerance. Written by `make bench`
(`python -m benchmarks`); the raw numbers are in
[results.json](FIGURES/results.json). Cost is CPU seconds of stepping per simulated
second, in one process on one core, after a warm-up, median of the repeats; making the scene, its
initial statics and reading the clock are not in it. Tip error is the largest distance of the free
end from the reference over the length, tension error the largest error of the top tension over its
largest value, both over the instants listed below. Targets and ratios count the models with bending
only (hybrid, elastica), as MoorDyn and the references have it. *Beyond* are goals set later.
"""

MOORDYN_NOTES = """## MoorDyn: how it was driven

- Version as listed above, through its Python API; only the calls of `Step` are timed. BA = 0 and
  RK4 at 2.7/omega_max is the setting that the project's targets are stated against;
  omega_max = 2N/L sqrt(EA/m) (bending never decides it on these scenes). RK2 with 0.6 of the
  critical damping of the shortest axial mode at 2.0/omega_max is the cheapest stable setting that
  the search below found; MoorDyn's own guide recommends damping near critical. Both have the same
  tip error at the same N: the segments decide it.
- Tangential drag: MoorDyn takes 1/2 rho Cdt (pi d) u_t^2 per length, as cablemodel does, so Cdt
  is passed on unchanged (read in its source, `Line.cpp`).
- The top is 100 m below the surface and gravity is adjusted, so that the submerged weight is exact.
- The starting shape (straight and unstretched, or the exact steady line) is written into its
  serialised state.
- A coupled point moves with constant velocity during a coupling step, so that a moving vessel
  needs short ones (5 ms here) for its top tension; they cost nothing next to its own steps.
- Waves (JW) are given to it from outside at its nodes, 100 times a second, which is not timed: its
  own are stretched to the surface, ours are not, and of the water's acceleration it gets the part
  across the line, as its force of the undisturbed water has a part along it.
- Not like for like: MoorDyn has no factor sqrt(e) on the drag (it is compared with references
  without it; the factor moves S1 by 5e-6 L), and its segments never push.
"""


PEERS_NOTES = """## CableDyn, Exudyn, MuJoCo: what they can state

| scene | MoorDyn | CableDyn | Exudyn | MuJoCo |
|---|---|---|---|---|
| S1 tow | yes | yes, EI = 0 | no drag | no Morison drag |
| S2w, S2a releases | yes | starts from statics only | no drag | no Morison drag |
| S2v release in a vacuum | yes | starts from statics only | yes | yes, does not stretch |
| S3 pay-out to the floor | no pay-out | no pay-out | no drag, no pay-out | no Morison drag |
| S4 turn out of a steady tow | yes | starts at rest only | no drag | no Morison drag |
| J jumper (still water) | yes | yes | no drag | no Morison drag |
| JW jumper in waves | yes | not where it is coupled | no drag | no Morison drag |

- **CableDyn** (finite elements, generalised alpha, implicit): a line with bending must be held at
  both ends, so S1 is solved by its two-node elements with EI = 0 (bending moves the end by 2e-5 L);
  its free end is stepped apart from the line, and needs short steps for that. Tangent reused and a
  Newton tolerance of 1e-6, which cost it no accuracy here; elements, step and damping are searched.
- **Exudyn** (planar ANCF cable elements, the same beam): drag and added mass would be Python
  functions in every iteration, so it takes part in a vacuum only. A whole run is one call of its
  solver, timed as such. Elements, step, generalised alpha or trapezoidal rule and the order of
  integration are searched.
- **MuJoCo**: a chain of rigid rods with hinges and springs (its `cable` composite has ball joints,
  which costs more); it does not stretch, which bounds its error from below by some 1e-4 L. Fluid
  forces are those of ellipsoids. Rods, step and integrator are searched.
- None of them has the factor sqrt(e) on the drag; on the jumper it changes drag by 5e-4.
- Each was driven as its documentation does it; notes on how are in `benchmarks/peers/`.
"""


def number(value: float | None, digits: int = 2) -> str:
    """A number in scientific notation, or a dash."""
    return "-" if value is None or value != value else f"{value:.{digits - 1}e}"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table."""
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(row) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def is_ours(measurement: Measurement) -> bool:
    """Whether cablemodel made it with bending, as peers and references have it.

    The flexible model is drawn and listed, but it solves an easier problem.
    """
    name = measurement.contestant
    return name.startswith(OURS) and name != f"{OURS} cable"


def targets_table(scenes: Sequence[BenchmarkScene], results: Sequence[Measurement]) -> str:
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
                f"{best.contestant}, {best.setting}" if best else "-",
                "yes" if best and best.cost <= target.cost else "no",
            )
        )
    return table(("scene", "error asked", "at most [s/s]", "measured [s/s]", "by", "met"), rows)


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


def ratio_table(scenes: Sequence[BenchmarkScene], results: Sequence[Measurement]) -> str:
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
                "-" if one.theirs_extrapolated else f"{one.ratio:.3g}",
                asked,
            )
        )
    return table(
        ("scene", "peer", "tip error / L", "peer [s/s]", "cablemodel [s/s]", "ratio", "asked"),
        rows,
    )


def scene_section(scene: BenchmarkScene, results: Sequence[Measurement], figures: Path) -> str:
    """Figure and table of one scene."""
    picture = figures / f"work_precision_{scene.name}.png"
    work_precision_figure(scene, results, picture)
    rows = [
        (
            m.contestant,
            m.setting,
            number(m.cost),
            number(m.tip_error) if m.failure is None else m.failure.splitlines()[0][:100],
            number(m.tension_error),
            f"{m.statistics.get('elements', float('nan')):.0f}",
            f"{m.statistics.get('steps', float('nan')):.0f}",
        )
        for m in results
    ]
    sets = load_references()[scene.name]
    made = "\n".join(
        f"- reference `{name}` at t = {', '.join(f'{t:g}' for t in reference.times)} s: "
        f"{reference.made} (tip within {reference.tip_uncertainty:.0e} m"
        + (
            f", tension within {reference.tension_uncertainty:.0e} N).\n"
            if reference.tension is not None
            else ").\n"
        )
        for name, reference in sets.items()
    )
    head = ("contestant", "setting", "s/s", "tip error / L", "T error", "elements", "steps")
    return (
        f"### {scene.title}\n\n![{scene.name}]({figures.name}/{picture.name})\n\n"
        f"{table(head, rows)}\n{made}"
    )


MOST_MEMORY = 4000.0
"""Memory of an instance per element, at most [bytes]."""


def scaling_section(points: Sequence[ScalingPoint], figures: Path) -> str:
    """Every series with its exponents, and the memory of an element."""
    picture = figures / "scaling.png"
    scaling_figure(points, picture)
    parts = [
        "## Scaling\n\nThe tow S1 (elastica, tau = 1e-3), one thing varied. Ten seconds in one "
        f"call where nothing else is said.\n\n![scaling]({figures.name}/{picture.name})\n"
    ]
    for series in SERIES:
        mine = [p for p in points if p.series == series.name]
        if not mine:
            continue
        rows = [
            (
                f"{p.size:g}",
                f"{p.elements:g}",
                number(p.build),
                number(p.cost),
                f"{p.steps:g}",
                number(p.cost / p.steps),
                f"{p.memory / 1e6:.3g}",
            )
            for p in mine
        ]
        head = (series.varied, "elements", "start, CPU s", "stepping, CPU s", "steps")
        text = f"### {series.name.capitalize()}\n\n{series.note}\n\n"
        text += table((*head, "CPU s a step", "memory [MB]"), rows)
        used = [p for p in mine if series.from_size <= p.size <= series.to_size]
        if len(used) > 1:
            sizes = [p.size for p in used]
            whole = exponent(sizes, [p.cost for p in used])
            start = exponent(sizes, [p.build for p in used])
            span = f"{sizes[0]:g} to {sizes[-1]:g}"
            text += f"\nExponent from {span}: stepping {whole:.2f}"
            if series.name.startswith("elements"):
                a_step = exponent(sizes, [p.cost / p.steps for p in used])
                text += f" (a step {a_step:.2f}; asked: at most 1.1), start {start:.2f}"
            text += ".\n"
        parts.append(text)
    largest = max(points, key=lambda p: p.elements)
    each = largest.memory / largest.elements
    parts.append(
        f"Memory of an instance: {each:.0f} bytes an element (asked: at most {MOST_MEMORY:g}; "
        f"{'met' if each <= MOST_MEMORY else '**not met**'}), with {largest.elements:g} elements.\n"
    )
    return "\n".join(parts)


def start_up_section(start_up: StartUp) -> str:
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
    return "## Start-up\n\n" + table(("what", "wall s", "asked"), rows)


def search_section(found: Sequence[Measurement]) -> str:
    """The search for MoorDyn's best stable settings."""
    rows = [
        (
            m.contestant,
            m.setting,
            number(m.cost),
            number(m.tip_error) if m.failure is None else m.failure.split(":")[0],
            number(m.tension_error),
        )
        for m in found
    ]
    return (
        "### Settings tried\n\nS1, 20 segments. A stable run has the tip error of the segments "
        "alone (the first rows); more means that time integration adds to it.\n\n"
        + table(("scheme", "setting", "s/s", "tip error / L", "T error"), rows)
    )


def write(
    path: Path,
    machine: dict[str, str],
    results: Sequence[Measurement],
    scaling: Sequence[ScalingPoint] = (),
    start_up: StartUp | None = None,
    searched: Sequence[Measurement] = (),
) -> None:
    """Write the report to ``path`` and its figures beside it."""
    figures = path.parent / path.stem
    names = {m.scene for m in results}
    scenes = [scene for name, scene in SCENES.items() if name in names]
    parts = [
        HEADER.replace("FIGURES", figures.name),
        "## Machine\n\n" + table(("what", "value"), machine.items()),
        "## What was asked\n\n" + targets_table(scenes, results),
        "## Ratio to the peers at equal error of position\n\n" + ratio_table(scenes, results),
        "## Work against precision\n",
    ]
    parts.extend(
        scene_section(scene, [m for m in results if m.scene == scene.name], figures)
        for scene in scenes
    )
    if scaling:
        parts.append(scaling_section(scaling, figures))
    if start_up is not None:
        parts.append(start_up_section(start_up))
    parts.append(PEERS_NOTES)
    parts.append(MOORDYN_NOTES)
    if searched:
        parts.append(search_section(searched))
    path.write_text("\n".join(parts))
