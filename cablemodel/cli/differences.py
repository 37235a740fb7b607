"""``cablemodel diff``, and how differences between runs are shown."""

from __future__ import annotations

import json
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cablemodel.cli.errors import FAILED, bad_option, reported
from cablemodel.cli.inspect import say_incomplete
from cablemodel.cli.numbers import readable
from cablemodel.cli.run import JsonOption

if TYPE_CHECKING:
    from collections.abc import Iterable

    from rich.table import Table

    from cablemodel.results.compare import Comparison, Difference


@reported
def diff(
    first: Annotated[Path, typer.Argument(help="Log of a run (MCAP).", show_default=False)],
    second: Annotated[Path, typer.Argument(help="Log of another run.", show_default=False)],
    tolerance: Annotated[
        float,
        typer.Option(
            help="Allowed difference: this part of the line's length at the start for lengths; of "
            "the largest value, ten times it for tensions and all else, a hundred times it for "
            "curvatures and moments.",
        ),
    ] = 0.0,
    as_json: JsonOption = False,
) -> None:
    """Compare two runs; status 0 if they agree within the tolerance, else 1."""
    from cablemodel.results.compare import compare
    from cablemodel.results.run import open_run

    check_tolerance(tolerance)
    one, other = open_run(first), open_run(second)
    result = compare(one, other, tolerance=tolerance)
    if as_json:
        typer.echo(json.dumps(_report(result)))
    else:
        for path, run in ((first, one), (second, other)):
            say_incomplete(f"{path}: {run.reason}" if run.reason else "")
        _print_comparison(result)
    if not result.passed:
        raise typer.Exit(FAILED)


def check_tolerance(tolerance: float) -> None:
    if not (math.isfinite(tolerance) and tolerance >= 0.0):
        raise bad_option("--tolerance", f"{tolerance} is no number of at least 0")


def difference_table(title: str, differences: Iterable[Difference]) -> Table:
    """The largest differences, the most serious first."""
    from rich.table import Table

    table = Table(title=title, title_justify="left")
    for heading, justify in (
        ("quantity", "left"), ("difference", "right"), ("allowed", "right"),
        ("at t", "right"), ("at s", "right"), ("", "left"),
    ):  # fmt: skip
        table.add_column(heading, justify=justify, no_wrap=heading == "quantity")  # type: ignore[arg-type]
    for item in sorted(differences, key=lambda item: item.share, reverse=True):
        table.add_row(
            item.name,
            f"{_size(item.largest)} {item.unit}" if item.largest else "0",
            f"{_size(item.allowed)} {item.unit}" if item.allowed else "0",
            "" if math.isnan(item.time) else f"{item.time:g} s",
            "" if item.arc_length is None else f"{readable(item.arc_length)} m",
            "" if item.within else "too much",
        )
    return table


def _size(value: float) -> str:
    return readable(value, 3) if math.isfinite(value) else "no number"


def difference_report(item: Difference) -> dict[str, Any]:
    """A difference for JSON."""
    return {
        "name": item.name,
        "unit": item.unit,
        "largest": item.largest if math.isfinite(item.largest) else None,
        "allowed": item.allowed,
        "within": item.within,
        "time": item.time if math.isfinite(item.time) else None,
        "arc_length": item.arc_length,
    }


def _report(result: Comparison) -> dict[str, Any]:
    return {
        "passed": result.passed,
        "identical": result.identical,
        "tolerance": result.tolerance,
        "samples": result.samples,
        "states": result.states,
        "interpolated": result.interpolated,
        "unmatched": result.unmatched,
        "differences": [difference_report(item) for item in result.differences],
    }


def _print_comparison(result: Comparison) -> None:
    from rich.console import Console

    console = Console(highlight=False)
    title = f"{result.samples} outputs, {result.states} states"
    console.print(difference_table(title, result.differences))
    for line in result.unmatched:
        console.print(line, soft_wrap=True)
    if result.interpolated:
        console.print("no output times in common: the second run was interpolated in time")
    if result.identical:
        verdict = "the same, to the last bit"
    elif result.passed:
        verdict = f"the same within a tolerance of {result.tolerance:g}"
    else:
        verdict = "different"
    console.print(f"The runs are {verdict}", soft_wrap=True)
