"""The command line's commands, put together."""

from __future__ import annotations

import sys
from typing import Annotated

import typer

from cablemodel.cli import (
    analyse,
    check,
    convergence,
    differences,
    fmu,
    imports,
    inspect,
    new,
    replay,
    report,
    run,
    sweep,
)
from cablemodel.cli.errors import show_tracebacks

app = typer.Typer(
    name="cablemodel",
    help="Simulate ocean cables: towing, laying, anchoring, recovering.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)


def _print_version(asked: bool) -> None:
    if asked:
        import cablemodel

        typer.echo(f"cablemodel {cablemodel.__version__}")
        raise typer.Exit


@app.callback()
def _options(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version."
        ),
    ] = False,
    traceback: Annotated[
        bool,
        typer.Option("--traceback", help="Show the Python traceback of an error, for debugging."),
    ] = False,
) -> None:
    show_tracebacks(traceback)


app.command("new")(new.new)
app.command("run")(run.run)
app.add_typer(imports.imports, name="import")
app.command("check")(check.check)
app.command("plot")(inspect.plot)
app.command("report")(report.report)
app.command("open")(report.show)
app.command("animate")(report.animate)
app.command("replay")(replay.replay)
app.command("diff")(differences.diff)
app.command("stats")(analyse.stats)
app.command("export")(analyse.export)
app.command("info")(inspect.info)
app.command("keys")(check.keys)
app.command("schema")(check.schema)
app.command("fmu")(fmu.fmu)
app.command("sweep")(sweep.sweep)
app.command("convergence")(convergence.convergence)


def main() -> None:
    """Entry point of the ``cablemodel`` command."""
    arguments = sys.argv[1:]
    if "--traceback" in arguments:  # wherever it stands, it means the whole command
        arguments = ["--traceback", *(item for item in arguments if item != "--traceback")]
    app(args=arguments, prog_name="cablemodel")
