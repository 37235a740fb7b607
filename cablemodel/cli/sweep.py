"""``cablemodel sweep``: a scene for every combination of some of its values."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Annotated

import typer

from cablemodel.cli.errors import FAILED, INTERRUPTED, bad_option, reported
from cablemodel.cli.files import PICTURES, writable, writing
from cablemodel.cli.numbers import readable
from cablemodel.cli.run import (
    ConvergeOption,
    SceneArgument,
    SetOption,
    UntilOption,
    seconds_of,
)

if TYPE_CHECKING:
    import pandas

FORMATS = (".csv", ".parquet", ".nc")
_WIDEST, _WORDS = 300, 12
"""Columns of text that the results on a screen may take, and the words above one of them."""
_FEW = 20
"""Runs whose results are shown as well."""
_SHOWN = ("highest_tension", "lowest_tension", "tip_x", "tip_y", "tip_z")
"""Of these results, and of the one that a picture shows, those that there are."""


@reported
def sweep(
    scene: SceneArgument,
    over: Annotated[
        list[str],
        typer.Option(
            metavar="PATH=VALUES",
            help="What to vary: path=start:stop:count, both ends included, or path=value,value,... "
            "Repeated: every combination is run.",
            show_default=False,
        ),
    ],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            help="Table to write: .csv, .parquet or .nc; by default SCENE_sweep.csv here.",
            show_default=False,
        ),
    ] = None,
    plot: Annotated[
        Path | None,
        typer.Option(help="Picture to write as well: .png, .pdf or .svg.", show_default=False),
    ] = None,
    result: Annotated[
        str, typer.Option(help="Column of the table that the picture shows.")
    ] = "highest_tension",
    against: Annotated[
        str | None,
        typer.Option(
            metavar="PATH",
            help="Value that is the picture's abscissa; by default that of the first --over.",
            show_default=False,
        ),
    ] = None,
    overrides: SetOption = None,
    until: UntilOption = None,
    scheduler: Annotated[
        str | None,
        typer.Option(
            metavar="ADDRESS",
            help="Run on the cluster of this dask scheduler, e.g. tcp://host:8786, instead of on "
            "this machine.",
            show_default=False,
        ),
    ] = None,
    workers: Annotated[
        int | None,
        typer.Option(
            min=1, help="Processes on this machine; by default one a processor.", show_default=False
        ),
    ] = None,
    converge: ConvergeOption = False,
    resume: Annotated[
        bool,
        typer.Option(
            help="Go on with the table of an interrupted sweep of the same scene, .csv or "
            ".parquet: only what is missing or failed is run.",
            show_default=False,
        ),
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Show no progress.")] = False,
) -> None:
    """Run a scene for every combination of some of its values, in parallel, into one table."""
    from cablemodel.analysis.sweep import Axis, read_table, results_of, write_table
    from cablemodel.analysis.sweep import sweep as run_all
    from cablemodel.systems import read_scene

    target = writable(output or Path(f"{scene.stem}_sweep.csv"), FORMATS)
    if plot is not None:
        writable(plot, PICTURES, "--plot")
    results = results_of(read_scene(scene))
    if result not in results:
        raise bad_option("--result", f"{result} is none of {', '.join(results)}")
    axes = [Axis.parse(text) for text in over]
    columns = {name: axis.column for axis in axes for name in (axis.path, axis.column)}
    if against is not None and against not in columns:
        paths = ", ".join(axis.path for axis in axes)
        raise bad_option("--against", f"{against} is not swept over; there is {paths}")
    end = None if until is None else seconds_of("--until", until)
    count = 1
    for axis in axes:
        count *= len(axis.values)
    done = read_table(target) if resume and target.exists() else None
    kept: list[pandas.DataFrame] = []
    with _progress(count, quiet) as show:

        def finished(done: int, table: pandas.DataFrame) -> None:
            kept[:] = [table]
            if done:
                with writing(target):
                    write_table(table, target)
            show(done, int((table["error"] != "").sum()))

        try:
            table = run_all(
                scene, axes, overrides=overrides or (), until=end, scheduler=scheduler,
                workers=workers, converge=converge, done=done, finished=finished,
            )  # fmt: skip
        except KeyboardInterrupt:
            done = len(kept[0]) if kept else 0
            words = f"\nThe {done} of {count} runs that had ended are in {target}" if done else ""
            typer.echo(f"cablemodel: interrupted{words}", err=True)
            raise typer.Exit(INTERRUPTED) from None
    if len(table) <= _FEW and not quiet:
        shown = {name: results[name] for name in (*_SHOWN, result) if name in results}
        _show(table, [axis.column for axis in axes], shown)
    _say(table, target)
    if (table["error"] != "").all():
        raise typer.Exit(FAILED)
    if plot is not None:
        from cablemodel.views.sweep_plot import save_sweep_figure

        chosen = None if against is None else columns[against]
        with writing(plot, "--plot"):
            save_sweep_figure(table, plot, result=result, against=chosen)
        typer.echo(f"Picture: {plot}")


def _show(table: pandas.DataFrame, varied: list[str], results: dict[str, str]) -> None:
    """What is varied in a short table, and these results, as far as they are there."""
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.measure import Measurement
    from rich.table import Table

    shown = [name for name in (*varied, *results) if name in table.columns]
    rows = Table(box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for name in shown:
        title = "\n".join(wrap(results[name], _WORDS)) if name in results else name
        rows.add_column(title, justify="right", no_wrap=True)
    for values in table[shown].itertuples(index=False):
        rows.add_row(*(readable(v) if isinstance(v, float) else str(v) for v in values))
    console = Console(highlight=False, markup=False)
    # What is piped into a file has 80 columns, and a path cut short is none.
    needed = Measurement.get(console, console.options.update(max_width=_WIDEST), rows).maximum
    console.width = max(console.width, needed)
    console.print(rows)


def _say(table: pandas.DataFrame, target: Path) -> None:
    """What came of it; a few of the failures by their text."""
    failed = table[table["error"] != ""]
    typer.echo(f"Table: {target} ({len(table)} runs, {len(failed)} failed)")
    texts = failed["error"].drop_duplicates()
    for index, text in list(texts.items())[:3]:
        typer.echo(f"cablemodel: run {index}: {text}", err=True)
    if len(texts) > 3:
        typer.echo(f"cablemodel: ... and {len(texts) - 3} other errors: see the table", err=True)


@contextmanager
def _progress(count: int, quiet: bool) -> Iterator[Callable[[int, int], None]]:
    """A function that shows on a terminal how many runs have ended, and how many of them failed."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

    console = Console(stderr=True)
    if quiet or not console.is_terminal:
        yield lambda done, failed: None
        return
    columns = (
        BarColumn(bar_width=24), MofNCompleteColumn(), TextColumn("{task.description}"),
        TimeElapsedColumn(),
    )  # fmt: skip
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task("starting", total=count)

        def show(done: int, failed: int) -> None:
            words = f"runs, {failed} failed" if failed else "runs"
            bar.update(task, completed=done, description=words)

        yield show
