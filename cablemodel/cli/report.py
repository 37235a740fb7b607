"""``cablemodel report``, ``open`` and ``animate``: show a run to oneself and to others."""

from __future__ import annotations

import os
import tempfile
import webbrowser
from pathlib import Path
from typing import Annotated

import typer

from cablemodel.cli.errors import bad_option, reported
from cablemodel.cli.files import writable, writing
from cablemodel.cli.inspect import RunArgument, opened_with_states, say_incomplete


@reported
def report(
    run: RunArgument,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            help="File to write: .html; by default the run's name with .html.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Write a run as one web page: moving shape, tension, curvature, inputs, extremes, scene."""
    from cablemodel.views.report import save_report

    target = writable(output or run.with_suffix(".html"), (".html", ".htm"))
    opened = opened_with_states(run)
    with writing(target):
        save_report(opened, target)
    say_incomplete(opened.reason)
    typer.echo(f"Report: {target} ({target.stat().st_size / 1e6:.1f} MB)")


@reported
def show(run: RunArgument) -> None:
    """Make a run's report and show it in the browser."""
    from cablemodel.views.report import save_report

    opened = opened_with_states(run)
    target = run.with_suffix(".html")
    # Logs of others, or on a medium that cannot be written, have no place beside them.
    if not os.access(target if target.exists() else target.parent, os.W_OK):
        target = Path(tempfile.mkdtemp(prefix="cablemodel-")) / target.name
    with writing(target, "RUN"):
        save_report(opened, target)
    say_incomplete(opened.reason)
    typer.echo(f"Report: {target}")
    if not webbrowser.open(target.resolve().as_uri()):
        typer.echo("cablemodel: no browser is found here; open the report in one", err=True)


@reported
def animate(
    run: RunArgument,
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            help="File to write: .mp4 or .gif; by default the run's name with .mp4.",
            show_default=False,
        ),
    ] = None,
    seconds: Annotated[
        float | None,
        typer.Option(
            help="How long the film is, in seconds; by default the run's own time, at least 4, "
            "at most 20.",
            show_default=False,
        ),
    ] = None,
    fps: Annotated[int, typer.Option(min=1, max=60, help="Pictures per second.")] = 20,
) -> None:
    """Write a run as a film of the moving cable and its top tension."""
    from cablemodel.views.animate import LONGEST, save_animation

    target = writable(output or run.with_suffix(".mp4"), (".mp4", ".gif"))
    if seconds is not None and not 0.0 < seconds <= LONGEST:
        raise bad_option("--seconds", f"{seconds} is not above 0 and at most {LONGEST:g}")
    opened = opened_with_states(run)
    with writing(target):
        save_animation(opened, target, seconds=seconds, fps=fps)
    say_incomplete(opened.reason)
    typer.echo(f"Film: {target} ({target.stat().st_size / 1e6:.1f} MB)")
