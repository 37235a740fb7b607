"""``cablemodel stats`` and ``cablemodel export``: a run in numbers, and in other formats."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cablemodel.cli.errors import FAILED, bad_option, reported
from cablemodel.cli.files import writable, writing
from cablemodel.cli.inspect import RunArgument, say_incomplete
from cablemodel.cli.numbers import readable
from cablemodel.cli.run import JsonOption, seconds_of
from cablemodel.errors import CableModelError

if TYPE_CHECKING:
    from cablemodel.analysis import Cycles, Floats, Statistic
    from cablemodel.results.run import Run

_WIDEST = 200
"""Columns that the table of statistics may take."""
_ROUNDING = 1e-12
"""Differences of this size, or part of what differs, are none."""
_TABLES = ("outputs", "states", "inputs")


@reported
def stats(
    run: RunArgument,
    after: Annotated[
        str | None,
        typer.Option(metavar="T", help="Leave out what is before this time.", show_default=False),
    ] = None,
    before: Annotated[
        str | None,
        typer.Option(metavar="T", help="Leave out what is after this time.", show_default=False),
    ] = None,
    slope: Annotated[
        float, typer.Option(help="Slope of the fatigue curve, for the equivalent range.")
    ] = 3.0,
    intercept: Annotated[
        float | None,
        typer.Option(
            help="Cycles to failure at a range of the reference: N = intercept (range / "
            "reference)^-slope. Gives damage and life of the top tension, or that of each line.",
            show_default=False,
        ),
    ] = None,
    reference: Annotated[
        float, typer.Option(help="Reference of the fatigue curve, in N, such as the breaking load.")
    ] = 1.0,
    as_json: JsonOption = False,
) -> None:
    """Extremes of all outputs; spectrum, cycles and fatigue of the top tension, or of each line's
    tension at its beginning."""
    from cablemodel.results.run import open_run

    for name, value in (("--slope", slope), ("--reference", reference), ("--intercept", intercept)):
        if value is not None and not (math.isfinite(value) and value > 0.0):
            raise bad_option(name, f"{value} is no number above 0")
    begin = -math.inf if after is None else seconds_of("--after", after)
    end = math.inf if before is None else seconds_of("--before", before)
    opened = open_run(run)
    report = _report(opened, begin, end, slope, intercept, reference)
    if as_json:
        typer.echo(json.dumps(_for_json(report)))
    else:
        say_incomplete(opened.reason)
        _print_report(report)


@reported
def export(
    run: RunArgument,
    output: Annotated[
        Path,
        typer.Option(
            "--output", "-o", help="File to write: .nc, .csv or .parquet.", show_default=False
        ),
    ],
    table: Annotated[
        str | None,
        typer.Option(
            help="What a .csv or .parquet holds: outputs (default), states or inputs; a .nc file "
            "holds all.",
            show_default=False,
        ),
    ] = None,
) -> None:
    """Write a run to NetCDF, CSV or Parquet."""
    from cablemodel.results.export import FORMATS
    from cablemodel.results.export import export as written
    from cablemodel.results.run import open_run

    writable(output, FORMATS)
    if table is not None and table not in _TABLES:
        raise bad_option("--table", f"{table} is none of {', '.join(_TABLES)}")
    if table is not None and output.suffix.lower() == ".nc":
        raise bad_option("--table", "a .nc file holds all tables")
    opened = open_run(run)
    say_incomplete(opened.reason)
    with writing(output):
        written(opened, output, table=table or "outputs")  # type: ignore[arg-type]  # checked above
    typer.echo(f"{output} ({output.stat().st_size / 1e6:.2f} MB)")


def _report(
    run: Run, begin: float, end: float, slope: float, intercept: float | None, reference: float
) -> dict[str, Any]:
    from cablemodel import analysis
    from cablemodel.views.drawing import start_tensions

    try:
        found = analysis.statistics(run, after=begin, before=end)
    except ValueError as error:
        typer.echo(f"cablemodel: {error}", err=True)
        raise typer.Exit(FAILED) from None
    inside = (run.time >= begin) & (run.time <= end)
    time = run.time[inside]
    motions = {
        name: _motion(time, tension[inside], slope, intercept, reference)
        for name, tension in start_tensions(run).items()
    }
    names = run.scene.body_names(len(run["bodies.position"][0])) if _has_bodies(run) else []
    report = {
        "bodies": names,
        "from": float(time[0]), "to": float(time[-1]), "outputs": len(time), "statistics": found,
    }  # fmt: skip
    return report | motions.get("", {"lines": motions})


def _has_bodies(run: Run) -> bool:
    """Whether it has bodies by number, as one line has: a system names its own."""
    return "bodies.position" in run.names


def _motion(
    time: Floats, tension: Floats, slope: float, intercept: float | None, reference: float
) -> dict[str, Any]:
    """Spectrum, cycles and fatigue of the tension at the beginning of a line."""
    from cablemodel import analysis

    span = float(time[-1] - time[0])
    found: dict[str, Any] = {"spectrum": None, "fatigue": None}
    try:
        counted = analysis.cycles(tension)
    except CableModelError as error:  # a package that the rest does without
        if intercept is not None:
            raise
        found["without"] = str(error)
    else:
        found["fatigue"] = _fatigue(counted, span, slope, intercept, reference)
    if len(time) >= 32:
        density = analysis.spectrum(time, tension)
        found["spectrum"] = {
            "significant": density.significant,
            "peak_period": density.peak_period,
            "zero_crossing_period": density.zero_crossing_period,
        }
    return found


def _fatigue(
    counted: Cycles, span: float, slope: float, intercept: float | None, reference: float
) -> dict[str, Any]:
    from cablemodel import analysis

    found = {
        "cycles": float(counted.count.sum()),
        "largest_range": float(counted.range[0]) if len(counted.range) else 0.0,
        "slope": slope,
        # Of one cycle a second, as is usual.
        "equivalent_range_1_hz": analysis.equivalent_range(counted, slope, span) if span else 0.0,
    }
    if intercept is not None:
        curve = analysis.FatigueCurve(intercept, slope, reference)
        damage = analysis.damage(counted, curve)
        found["damage"] = damage
        found["life_years"] = span / damage / analysis.YEAR if damage else math.inf
    return found


def _for_json(report: dict[str, Any]) -> dict[str, Any]:
    """The same with what JSON has: no objects, None for what is not finite."""
    rows = [
        {"name": row.name, "unit": row.unit, "quantity": row.quantity, **asdict(row.extremes)}
        for row in report["statistics"]
    ]
    cleaned: dict[str, Any] = _finite({**report, "statistics": rows})
    return cleaned


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list):
        return [_finite(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _print_report(report: dict[str, Any]) -> None:
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.measure import Measurement
    from rich.table import Table

    console = Console(highlight=False)
    title = f"{report['outputs']} outputs from {report['from']:g} to {report['to']:g} s"
    table = Table(title=title, title_justify="left", box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    table.add_column("quantity", no_wrap=True)
    for heading in ("unit", "mean", "std", "min", "at \\[s]", "max", "at \\[s]"):
        table.add_column(heading, justify="left" if heading == "unit" else "right")
    constant = []
    for row in report["statistics"]:
        lowest, highest = row.extremes.minimum, row.extremes.maximum
        size = max(abs(lowest), abs(highest))
        if highest - lowest > _ROUNDING * max(size, 1.0):
            table.add_row(*_row(row))
        else:
            unit = "" if row.unit == "1" else f" {row.unit}"
            mean = row.extremes.mean if size > _ROUNDING else 0.0
            constant.append(f"{row.name} {readable(mean)}{unit}")
    # What is piped into a file has 80 columns, and a number cut short is none.
    needed = Measurement.get(console, console.options.update(max_width=_WIDEST), table).maximum
    console.width = max(console.width, needed)
    console.print(table)
    for number, name in enumerate(report["bodies"]):
        if name:
            console.print(f"bodies[{number}]: {name}", soft_wrap=True, markup=False)
    if constant:
        console.print(f"constant: {', '.join(constant)}", soft_wrap=True, markup=False)
    for name, motion in report.get("lines", {"": report}).items():
        tension = f"{name}.start_tension" if name else "top tension"
        for text in _words(motion):
            console.print(f"{tension}: {text}", soft_wrap=True, markup=False)


def _words(motion: dict[str, Any]) -> Iterator[str]:
    """Spectrum, cycles and fatigue of a tension."""
    spectrum, fatigue = motion["spectrum"], motion["fatigue"]
    if spectrum is not None:
        yield (
            f"significant range {readable(spectrum['significant'])} N, peak period "
            f"{readable(spectrum['peak_period'], 3)} s, mean period "
            f"{readable(spectrum['zero_crossing_period'], 3)} s"
        )
    if fatigue is None:
        yield f"no cycles: {motion['without']}"
        return
    yield (
        f"{fatigue['cycles']:g} cycles, largest range {readable(fatigue['largest_range'])} N; "
        f"as one cycle a second {readable(fatigue['equivalent_range_1_hz'])} N "
        f"(slope {fatigue['slope']:g})"
    )
    if "damage" in fatigue:
        life = fatigue["life_years"]
        yield f"fatigue damage {fatigue['damage']:.3g}, " + (
            f"a life of {life:.3g} years of this" if math.isfinite(life) else "no end of life"
        )


def _row(row: Statistic) -> list[str]:
    from rich.markup import escape

    e = row.extremes
    values = (
        e.mean, e.standard_deviation, e.minimum, e.time_of_minimum, e.maximum, e.time_of_maximum,
    )  # fmt: skip
    return [escape(row.name), "" if row.unit == "1" else row.unit, *map(readable, values)]
