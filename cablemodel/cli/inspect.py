"""``cablemodel info`` and ``cablemodel plot``: look at a run."""

from __future__ import annotations

import json
from collections.abc import Callable
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cablemodel.cli.errors import reported
from cablemodel.cli.files import PICTURES, writable, writing
from cablemodel.cli.run import JsonOption

if TYPE_CHECKING:
    from cablemodel.results.run import Run

RunArgument = Annotated[Path, typer.Argument(help="Log of a run (MCAP).", show_default=False)]


def _instant(nanoseconds: object) -> str:
    """An epoch as a date and a time of day."""
    moment = datetime.fromtimestamp(int(str(nanoseconds)) / 1e9, tz=UTC)
    return moment.strftime("%Y-%m-%d %H:%M:%S UTC")


_READABLE: dict[str, tuple[str, Callable[[object], str]]] = {
    "epoch_ns": ("t = 0 is at", _instant),
    "engine": ("hash of the engine", str),
    "max_curvature": ("largest curvature", lambda value: f"{value:.4g} 1/m"),
    "wall_time": ("computing time", lambda value: f"{value:.3g} s"),
}
"""Names and texts of what a log calls by a key; all other keys speak for themselves."""


@reported
def plot(
    run: RunArgument,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            help="File to write: .png, .pdf or .svg; by default the run's name with .png.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Draw the shape of the cable and its tension, as for a paper."""
    from cablemodel.views.plot import save_figure

    target = writable(output or run.with_suffix(".png"), PICTURES)
    opened = opened_with_states(run)
    with writing(target):
        save_figure(opened, target)
    say_incomplete(opened.reason)
    typer.echo(f"Picture: {target}")


@reported
def info(
    run: RunArgument,
    as_json: JsonOption = False,
) -> None:
    """Say what a log holds, where it comes from, and whether it is complete."""
    from cablemodel.results.log.reader import LogFile

    log = LogFile(run)
    report = {
        "file": str(run),
        "bytes": run.stat().st_size,
        "complete": log.complete,
        "reason": log.reason,
        "metadata": log.metadata,
        "statistics": log.statistics,
        "channels": [
            {"topic": log.names.get(topic, topic), "type": log.topics[topic], "messages": count}
            for topic, count in log.counts().items()
        ],
    }
    if as_json:
        typer.echo(json.dumps(report))
    else:
        _print_info(report)


def _print_info(report: dict[str, Any]) -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    console = Console(highlight=False)
    table = Table(title=escape(report["file"]), title_justify="left", show_header=False)
    table.add_column(style="dim")
    table.add_column(overflow="fold")
    table.add_row("complete", "yes" if report["complete"] else f"no: {escape(report['reason'])}")
    table.add_row("size", f"{report['bytes'] / 1e6:.3f} MB")
    for section in ("metadata", "statistics"):
        for key, value in report[section].items():
            name, text = _READABLE.get(key, (key.replace("_", " "), str))
            table.add_row(name, escape(text(value)))
    console.print(table)
    channels = Table()
    channels.add_column("topic")
    channels.add_column("type")
    channels.add_column("messages", justify="right")
    for channel in report["channels"]:
        channels.add_row(channel["topic"], channel["type"], f"{channel['messages']:,}")
    console.print(channels)


def opened_with_states(path: Path) -> Run:
    """A run that has something to draw; one that has not is bad input."""
    from cablemodel.results.run import open_run

    opened = open_run(path)
    if not any(len(states) for states in opened.shapes.values()):
        raise typer.BadParameter(f"{path} holds no states: there is nothing to draw")
    return opened


def say_incomplete(reason: str) -> None:
    """Warn that a run ended early or was cut, if there is a reason to give."""
    if reason:
        typer.echo(f"cablemodel: the run is not complete: {reason}", err=True)
