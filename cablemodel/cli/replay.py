"""``cablemodel replay``: a log as a test."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cablemodel.cli.differences import check_tolerance, difference_report, difference_table
from cablemodel.cli.errors import FAILED, reported
from cablemodel.cli.inspect import RunArgument, say_incomplete
from cablemodel.cli.run import JsonOption, explained_start

if TYPE_CHECKING:
    from cablemodel.results.replay import Replay


@reported
def replay(
    run: RunArgument,
    tolerance: Annotated[
        float | None,
        typer.Option(
            help="Allowed difference: this part of the line's length at the start for lengths; of "
            "the largest value, ten times it for tensions and all else, a hundred times it for "
            "curvatures and moments. By default 0 on the version and processor of the "
            "log, else the tolerance of the scene's solver.",
            show_default=False,
        ),
    ] = None,
    as_json: JsonOption = False,
) -> None:
    """Run a log again from its scene and inputs, and compare; status 0 if it agrees, else 1."""
    from cablemodel.results.replay import replay as replayed
    from cablemodel.results.run import open_run

    if tolerance is not None:
        check_tolerance(tolerance)
    opened = open_run(run)
    with explained_start(quiet=as_json) as started:
        result = replayed(opened, tolerance=tolerance, progress=lambda time: started())
    if as_json:
        typer.echo(json.dumps(_report(result)))
    else:
        say_incomplete(opened.reason)
        _print_report(result, run)
    if not result.passed:
        raise typer.Exit(FAILED)


def _report(result: Replay) -> dict[str, Any]:
    return {
        "passed": result.passed,
        "exact": result.exact,
        "expected_exact": result.expected_exact,
        "failure": result.failure,
        "tolerance": result.tolerance,
        "steps": result.steps,
        "samples": result.samples,
        "changed": result.changed,
        "differences": [difference_report(item) for item in result.differences],
    }


def _print_report(result: Replay, path: Path) -> None:
    from rich.console import Console

    console = Console(highlight=False)
    title = f"{result.samples} outputs of {result.steps} steps"
    console.print(difference_table(title, result.differences))
    for name, (before, now) in result.changed.items():
        console.print(f"{name} was {before or 'unknown'}, is {now or 'unknown'}", soft_wrap=True)
    console.print(f"{path}: {_verdict(result)}", soft_wrap=True)


def _verdict(result: Replay) -> str:
    if result.failure:
        return f"differs: {result.failure}"
    if result.exact:
        return "replays exactly, to the last bit"
    if not result.passed:
        because = " although version and processor are the same" if result.expected_exact else ""
        return f"differs{because}"
    return f"replays within a tolerance of {result.tolerance:g}"
