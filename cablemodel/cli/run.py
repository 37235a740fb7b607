"""``cablemodel run``: simulate a scene, show how it goes, and sum it up."""

from __future__ import annotations

import json
import math
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cablemodel.cli.errors import INTERRUPTED, FailedRunError, bad_option, reported
from cablemodel.cli.files import writable

if TYPE_CHECKING:
    from rich.console import Console

    from cablemodel.results.run import Run
    from cablemodel.results.simulate import Progress
    from cablemodel.scene import Scene
    from cablemodel.systems import SystemScene

SceneArgument = Annotated[Path, typer.Argument(help="Scene file (YAML).", show_default=False)]
SetOption = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="PATH=VALUE",
        help="Change a value of the scene, e.g. line.0.cable.length=50; may be repeated.",
        show_default=False,
    ),
]
JsonOption = Annotated[bool, typer.Option("--json", help="Print one JSON object.")]
UntilOption = Annotated[
    str | None,
    typer.Option(
        metavar="T",
        help='End of the run, in seconds or with a unit ("3 min"), instead of the scene\'s.',
        show_default=False,
    ),
]
ConvergeOption = Annotated[
    bool,
    typer.Option(
        "--converge",
        help="Run again at ever finer tolerances, until the errors are known to be no larger than "
        "the scene's own tolerance (or solver.accuracy) allows; status 1 if none is that good.",
    ),
]

_LONG_START = 3.0
"""Seconds after which a start is said to be hard: others take less."""
_REFRESH = 0.05
"""Least time between updates of the progress line [s]."""


@reported
def run(
    scene: SceneArgument,
    log: Annotated[
        Path | None,
        typer.Option(help="Write the run to this file (.mcap).", show_default=False),
    ] = None,
    until: UntilOption = None,
    overrides: SetOption = None,
    error_estimate: Annotated[
        bool,
        typer.Option(
            "--error-estimate",
            help="Say how far the run may be wrong, from one at a quarter of its tolerance beside "
            "it (solver.error_estimate); the results are the same.",
        ),
    ] = False,
    converge: ConvergeOption = False,
    state_interval: Annotated[
        str | None,
        typer.Option(
            metavar="T",
            help="Time between exact states in the log; by default the scene's output interval, "
            "in long runs what keeps the log small.",
            show_default=False,
        ),
    ] = None,
    as_json: Annotated[
        bool, typer.Option("--json", help="Print the summary as one JSON object.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Show no progress.")] = False,
) -> None:
    """Simulate a scene to its end."""
    from cablemodel.accuracy.converge import converge as run_until_converged
    from cablemodel.errors import ConvergenceError, StaticsError
    from cablemodel.results.simulate import simulate
    from cablemodel.systems import read_scene

    if log is not None:
        writable(log, (".mcap",), "--log")
    estimate = ["solver.error_estimate=true"] if error_estimate else []
    loaded = read_scene(scene, [*(overrides or ()), *estimate])
    _warn(loaded.notes)
    end = None if until is None else seconds_of("--until", until)
    interval = None if state_interval is None else seconds_of("--state-interval", state_interval)
    reached = [math.nan]
    unconverged: ConvergenceError | None = None
    with _progress(quiet or as_json) as show:

        def progress(now: Progress, which: str = "") -> None:
            reached[0] = now.time
            show(now, which)

        def attempt(tolerance: float, now: Progress) -> None:
            progress(now, f"tolerance {tolerance:g} · ")

        try:
            if converge:
                result = run_until_converged(
                    loaded, log=log, until=end, progress=attempt, state_interval=interval
                )
            else:
                result = simulate(
                    loaded, log=log, until=end, progress=progress, state_interval=interval
                )
        except KeyboardInterrupt:
            typer.echo(f"cablemodel: interrupted{_kept(reached[0], log)}", err=True)
            raise typer.Exit(INTERRUPTED) from None
        except Exception as error:
            if math.isnan(reached[0]) or not _expected(error):
                if isinstance(error, StaticsError):
                    _say_why(loaded)
                raise
            if not isinstance(error, ConvergenceError) or error.run is None:
                raise FailedRunError(f"{error}{_kept(reached[0], log)}") from error
            result, unconverged = error.run, error
    if as_json:
        typer.echo(json.dumps(result.summary()))
    else:
        _print_summary(result, log, converged=converge)
    if unconverged is not None:
        raise unconverged


def _say_why(scene: Scene | SystemScene) -> None:
    """What looks wrong in a scene that has no start: that may well be why."""
    from cablemodel.cli.plausibility import scene_warnings, system_warnings
    from cablemodel.scene import Scene

    found = scene_warnings(scene) if isinstance(scene, Scene) else system_warnings(scene)
    _warn(warning for warning in found if warning not in scene.notes)  # those were said before


def _warn(found: Iterable[str]) -> None:
    """Say on standard error what looks wrong."""
    for warning in found:
        typer.echo(f"cablemodel: warning: {warning}", err=True)


def _expected(error: Exception) -> bool:
    from cablemodel.errors import CableModelError

    return isinstance(error, CableModelError)


def seconds_of(option: str, text: str) -> float:
    """A time [s] that an option gives, with or without a unit."""
    from cablemodel.errors import SceneError
    from cablemodel.scene.units import seconds

    try:
        return seconds(option, text)
    except SceneError:
        raise bad_option(option, f"{text!r} is no time above 0, such as 200 or '3 min'") from None


def _kept(reached: float, log: Path | None) -> str:
    """What is left of a run that ended early."""
    if log is None or math.isnan(reached):
        return ""
    return f"\nWhat was reached, up to t = {reached:g} s, is in {log}"


@contextmanager
def _progress(quiet: bool) -> Iterator[Callable[[Progress, str], None]]:
    """A function that shows progress on a terminal, after a word on which run it is of; elsewhere,
    and when quiet, it shows nothing."""
    from rich.console import Console

    console = Console(stderr=True)
    with explained_start(quiet, console) as started:
        if console.is_terminal and not quiet:
            with _bar(console, started) as show:
                yield show
        else:
            yield lambda now, _run: started() if now.time > 0.0 else None


@contextmanager
def explained_start(quiet: bool, console: Console | None = None) -> Iterator[Callable[[], None]]:
    """Say why a start takes long, lest users think that it hangs.

    Gives a function to call when the start is over (the end of the block is, at the latest).
    """

    from cablemodel.solvers.finite_element.start import search
    from cablemodel.solvers.library import compiling_told, library_path

    def say(text: str) -> None:
        if quiet:
            return
        if console is not None:
            console.print(text, highlight=False)
        else:
            typer.echo(text, err=True)

    hard = (
        "Looking for a static start: hard for this scene; initial: {points: ...} gives one to a "
        "line, and positions of bodies help a system."
    )
    waiting: list[threading.Timer] = []
    over = threading.Event()  # it has been said, or is not to be any more

    def tell() -> None:
        over.set()
        say(hard)

    def begin() -> None:
        if library_path() is None:
            return  # compiling may be what takes long
        if not quiet and not waiting and not over.is_set():
            timer = threading.Timer(_LONG_START, tell)
            timer.daemon = True
            waiting.append(timer)
            timer.start()

    def end() -> None:
        while waiting:
            waiting.pop().cancel()

    def finish() -> None:
        over.set()
        end()

    try:
        with search.told(begin, end), compiling_told(say):
            yield finish
    finally:
        finish()


@contextmanager
def _bar(
    console: Console, started: Callable[[], None]
) -> Iterator[Callable[[Progress, str], None]]:
    from rich import progress as rich_progress

    bar = rich_progress.Progress(
        rich_progress.BarColumn(bar_width=24),
        rich_progress.TextColumn("{task.description}"),
        console=console,
        transient=True,
    )
    with bar:
        task = bar.add_task("starting", total=None)
        last = -math.inf
        # The clock of the first step: a first start spends its time before it, compiling.
        began = [math.nan, 0.0]
        reached = 0.0

        def show(now: Progress, run: str) -> None:
            nonlocal last, reached
            clock = time.perf_counter()
            if now.time > 0.0:
                started()
            if math.isnan(began[0]) or now.time < reached:
                began[:] = [clock, now.time]
            reached = now.time
            if clock - last < _REFRESH and now.time < now.until:
                return
            last = clock
            elapsed = clock - began[0]
            rate = (now.time - began[1]) / elapsed if elapsed > 0.0 else 0.0
            steps, iterations = (now.statistics.get(key, 0) for key in ("steps", "iterations"))
            text = (
                f"{run}t = {now.time:.1f} of {now.until:g} s · {rate:,.0f} × real time · "
                f"top tension {now.top_tension:,.1f} N · {steps:,} steps · "
                f"{iterations:,} iterations"
            )
            bar.update(task, description=text, completed=now.time, total=now.until)

        yield show


def _print_summary(result: Run, log: Path | None, *, converged: bool) -> None:
    """The end of the run as a table. converged: whether it was asked to converge."""
    from rich.console import Console
    from rich.table import Table

    summary = result.summary()
    table = Table(title=result.scene.title or "Run", title_justify="left", show_header=False)
    table.add_column(style="dim")
    table.add_column(justify="right")
    for row in [*_rows(summary), *_error_rows(result)]:
        table.add_row(*row)
    console = Console()
    console.print(table)
    estimate = result.error_estimate
    problems = estimate.problems(result.scene.solver) if estimate is not None else []
    for problem in problems:
        console.print(f"[yellow]warning:[/yellow] {problem}", highlight=False, soft_wrap=True)
    if problems and not converged:
        console.print(
            "A run that keeps the promise, if there is one: cablemodel run SCENE --converge",
            highlight=False,
            soft_wrap=True,
        )
    if log is not None:
        size = log.stat().st_size
        console.print(
            f"Log: {log} ({size / 1e6:.2f} MB)", highlight=False, soft_wrap=True, markup=False
        )


def _rows(summary: dict[str, Any]) -> list[tuple[str, str]]:
    end = summary["time"]
    wall = summary["wall_time"]
    rows = [("simulated time", f"{end:g} s")]
    rows += _part_rows(summary) if "lines" in summary else [
        ("top tension at the end", f"{fixed(summary['top_tension'])} N"),
        ("far end at the end (x, y, z)", _vector(summary["tip_position"])),
        ("lowest tension of the run", f"{fixed(summary['min_tension'])} N"),
        ("highest tension of the run", f"{fixed(summary['max_tension'])} N"),
        *_slack_rows(summary, "slack"),
    ]  # fmt: skip
    rows.append(("largest curvature of the run", f"{summary['max_curvature']:.4g} 1/m"))
    if wall:
        rows.append(
            ("computing time, with outputs", f"{wall:.3g} s ({end / wall:,.0f} × real time)")
        )
    for key in ("steps", "rejected", "factorisations", "elements"):
        if summary[key] is not None:
            name = "rejected steps" if key == "rejected" else key
            rows.append((name, f"{summary[key]:,}"))
    if (tolerance := summary.get("tolerance")) is not None:
        finer = tolerance < summary["accuracy"]
        asked = f", for an accuracy of {summary['accuracy']:g}" if finer else ""
        rows.append(("tolerance", f"{tolerance:g}{asked}"))
    return rows


def _part_rows(summary: dict[str, Any]) -> list[tuple[str, str]]:
    """Lines, bodies and vessels of a system."""
    rows = []
    for name, line in summary["lines"].items():
        ends = f"{fixed(line['start_tension'])} N, {fixed(line['end_tension'])} N"
        range_ = f"{fixed(line['tension_min'])} to {fixed(line['tension_max'])} N"
        rows.append((f"{name}: tension at its ends, at the end", ends))
        rows.append((f"{name}: tension of the run", range_))
        rows += _slack_rows(line, f"{name}: slack")
    for name, body in summary["bodies"].items():
        rows.append((f"{name}: position at the end (x, y, z)", _vector(body["position"])))
    for name, vessel in summary["vessels"].items():
        force = ", ".join(map(fixed, vessel["force"]))
        rows.append((f"{name}: force of the lines at the end (x, y, z)", f"({force}) N"))
    return rows


def _slack_rows(found: dict[str, Any], name: str) -> list[tuple[str, str]]:
    """For how long, and where, a line has been slack; nothing where it has not."""
    if not found["slack_time"]:
        return []
    times = f"{found['slack_time']:.3g} s, up to {found['slack_longest']:.3g} s at a time"
    return [(name, f"{times}, s = {found['slack_start']:.4g} to {found['slack_end']:.4g} m")]


def _error_rows(result: Run) -> list[tuple[str, str]]:
    """What positions and tensions may be wrong by, where that is estimated."""
    estimate = result.error_estimate
    if estimate is None:
        return []
    rows, settings = [], result.scene.solver
    moved, pulled = estimate.of_positions, estimate.of_tensions
    for name, unit, error, until in (
        (moved.positions, "m", moved.position, math.inf),
        (pulled.tensions.removeprefix("the "), "N", pulled.tension, pulled.taut_until),
    ):
        text = f"{error.largest:.3g} {unit}, {error.share:.2g} of what is allowed"
        if until <= result.time[0]:
            text = "not promised: slack, or not at rest at the start"
            if settings.accuracy_of == "positions":
                text = "not asked for"
        elif math.isnan(error.share):
            text = "not known"
        elif estimate.unknown_from is not None and estimate.unknown_from < until:
            text += f", not known from t = {estimate.unknown_from:g} s on"
        elif until < math.inf:
            text += f", until slack at t = {until:g} s"
        rows.append((f"estimated error, {name}", text))
    return rows


def fixed(value: float) -> str:
    """A number with three decimals, and no minus sign before a zero."""
    return f"{round(value, 3) + 0.0:,.3f}"


def _vector(values: list[float]) -> str:
    return "(" + ", ".join(map(fixed, values)) + ") m"
