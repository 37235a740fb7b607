"""``cablemodel convergence``: how accurate a run is, and what accuracy costs."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cablemodel.cli.differences import difference_report
from cablemodel.cli.errors import FAILED, bad_option, reported
from cablemodel.cli.files import PICTURES, writable, writing
from cablemodel.cli.numbers import readable
from cablemodel.cli.run import (
    JsonOption,
    SceneArgument,
    SetOption,
    UntilOption,
    explained_start,
    seconds_of,
)

if TYPE_CHECKING:
    from rich.table import Table

    from cablemodel.accuracy.verdict import Convergence, Row
    from cablemodel.results.simulate import Progress

_KEY = (
    "CPU: of the steps, for a simulated second. off: the largest difference from the reference "
    "(ref.). share: of what is allowed, tau L or 10 tau of the largest tension. worst, "
    "place: of the position."
)


@reported
def convergence(
    scene: SceneArgument,
    tolerances: Annotated[
        str | None,
        typer.Option(
            metavar="T,T,...",
            help="Tolerances besides the scene's own, e.g. 1e-2,1e-4; by default four times and a "
            "quarter of it.",
            show_default=False,
        ),
    ] = None,
    until: UntilOption = None,
    overrides: SetOption = None,
    plot: Annotated[
        Path | None,
        typer.Option(
            help="Picture of error against processor time to write as well: .png, .pdf or .svg.",
            show_default=False,
        ),
    ] = None,
    as_json: JsonOption = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Show no progress.")] = False,
) -> None:
    """Run a scene at several tolerances; status 0 if its own keeps what it promises, else 1."""
    from cablemodel.accuracy.study import convergence as study
    from cablemodel.accuracy.study import runs_of
    from cablemodel.errors import SceneError
    from cablemodel.scene import load_scene
    from cablemodel.scene.load import is_system, read_content

    if plot is not None:
        writable(plot, PICTURES, "--plot")
    if is_system(read_content(scene)[2]):
        problem = "a study is made of one line: this is a system, not a scene of one line"
        allowed = "cablemodel run SCENE --converge, or --error-estimate"
        raise SceneError.at("lines", None, problem, allowed)
    loaded = load_scene(scene, overrides or ())
    given = None if tolerances is None else _tolerances(tolerances)
    end = None if until is None else seconds_of("--until", until)
    with _progress(runs_of(loaded, given), quiet or as_json) as show:
        found = study(loaded, given, until=end, progress=show)
    if as_json:
        typer.echo(json.dumps(_report(found)))
    else:
        _print_report(found, loaded.title or "Scene")
    if plot is not None:
        from cablemodel.views.accuracy_plot import save_convergence_figure

        with writing(plot, "--plot"):
            save_convergence_figure(found, plot)
        typer.echo(f"Picture: {plot}", err=as_json)
    if not found.passed:
        raise typer.Exit(FAILED)


def _tolerances(text: str) -> list[float]:
    from cablemodel.accuracy.study import allowed_tolerance
    from cablemodel.errors import SceneError

    try:
        return [allowed_tolerance(part.strip()) for part in text.split(",")]
    except SceneError as error:
        first = error.problems[0]
        raise bad_option("--tolerances", f"{first.problem}; allowed: {first.allowed}") from None


def _report(found: Convergence) -> dict[str, Any]:
    return {
        "passed": found.passed,
        "outcome": found.outcome,
        "conclusion": found.conclusion,
        "notes": list(found.notes),
        "tolerance": found.tolerance,
        "unsettled": found.unsettled,
        "rows": [_row_report(row) for row in found.rows],
        "reference": _row_report(found.reference),
    }


def _row_report(row: Row) -> dict[str, Any]:
    report = asdict(row)
    for name in ("position", "top_tension", "tension"):
        difference = getattr(row, name)
        report[name] = None if difference is None else difference_report(difference)
    return {
        key: None if isinstance(value, float) and not math.isfinite(value) else value
        for key, value in {
            **report, "position_share": row.position_share, "tension_share": row.tension_share
        }.items()
    }  # fmt: skip


def _print_report(found: Convergence, title: str) -> None:
    from rich.console import Console
    from rich.markup import escape

    console = Console(highlight=False)
    console.print(_table(found, title))
    for row in (*found.rows, found.reference):
        if row.error:
            console.print(f"{row.tolerance:g} failed: {escape(row.error)}", soft_wrap=True)
    for note in found.notes:
        console.print(f"[yellow]note:[/yellow] {note}", soft_wrap=True)
    console.print(found.conclusion, soft_wrap=True)


def _table(found: Convergence, title: str) -> Table:
    from rich.box import SIMPLE_HEAD
    from rich.markup import escape
    from rich.table import Table

    asked = found.own.asked
    accuracy = "" if asked is None else f", for an accuracy of {asked:g}"
    table = Table(
        title=f"{escape(title)}: tolerance {found.tolerance:g}{accuracy}",
        caption=_KEY,
        title_justify="left",
        caption_justify="left",
        box=SIMPLE_HEAD,
        padding=0,
        pad_edge=False,
    )
    for heading in (
        "tole-\nrance", "CPU\nms/s", "\nsteps", "ele-\nments", "position\noff, m", "\nshare",
        "top T\noff, N", "along\noff, N", "\nshare", "worst\nt, s", "place\ns, m",
    ):  # fmt: skip
        table.add_column(heading, justify="right", no_wrap=True)
    for row in (*found.rows, found.reference):
        table.add_row(*_cells(row, row is found.reference))
    return table


def _cells(row: Row, reference: bool) -> list[str]:
    if row.error:
        return [f"{row.tolerance:g}", "failed"]
    cost = [f"{row.tolerance:g}", readable(1e3 * row.processor_time, 2), f"{row.steps:,}"]
    cost.append(str(row.elements))
    if row.position is None or row.top_tension is None or row.tension is None:
        return [*cost, "(ref.)" if reference else ""]
    return [
        *cost,
        readable(row.position.largest, 3),
        readable(row.position_share, 2),
        readable(row.top_tension.largest, 3),
        readable(row.tension.largest, 3),
        readable(row.tension_share, 2),
        f"{row.position.time:g}",
        readable(row.position.arc_length or 0.0, 3),
    ]


@contextmanager
def _progress(runs: list[float], quiet: bool) -> Iterator[Callable[[float, Progress], None]]:
    """A function that shows on a terminal which run is on, and how far."""
    from rich.console import Console

    console = Console(stderr=True)
    with explained_start(quiet, console) as started:
        if quiet or not console.is_terminal:
            yield lambda tolerance, now: started()
            return
        with console.status("starting") as status:

            def show(tolerance: float, now: Progress) -> None:
                started()
                # The reference first, then the others from the finest to the coarsest.
                run = len(runs) - runs.index(tolerance)
                status.update(
                    f"run {run} of {len(runs)}, tolerance {tolerance:g}: "
                    f"t = {now.time:.1f} of {now.until:g} s"
                )

            yield show
