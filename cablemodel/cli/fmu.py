"""``cablemodel fmu``: a scene as a Functional Mock-up Unit."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cablemodel.cli.errors import reported
from cablemodel.cli.files import writable, writing
from cablemodel.cli.run import SceneArgument, SetOption


@reported
def fmu(
    scene: SceneArgument,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="File to write; else SCENE.fmu here.",
                     show_default=False),
    ] = None,
    platform: Annotated[
        str,
        typer.Option(
            help="Platforms, with commas: linux64, win64, darwin64 (Intel and ARM); or "
            "aarch64-linux alone."
        ),
    ] = "linux64,win64,darwin64",
    stations: Annotated[
        int, typer.Option(min=2, help="Points along each cable that are outputs.")
    ] = 11,
    inputs: Annotated[
        str,
        typer.Option(
            help="Who drives until use_scene_inputs is set: connected (the scene where no input is "
            "set), scene (inputs are ignored), master (the inputs)."
        ),
    ] = "connected",
    vessel_input: Annotated[
        str,
        typer.Option(
            help="What moves the tow point, or each vessel of a system, until vessel.input is set: "
            "velocity, position, or 'position and velocity'."
        ),
    ] = "velocity",
    timing: Annotated[
        str,
        typer.Option(
            help="When in a step inputs hold until input.timing is set: end, or start (the FMU "
            "extrapolates)."
        ),
    ] = "end",
    author: Annotated[str, typer.Option(help="Named in the model description.")] = "",
    ssp: Annotated[
        Path | None,
        typer.Option("--ssp", help="Write a system of vessels and this cable, too (SSP 1.0).",
                     show_default=False),
    ] = None,
    overrides: SetOption = None,
) -> None:  # fmt: skip
    """Export a scene as an FMU (FMI 2.0 co-simulation) that needs no Python."""
    from cablemodel.errors import CableModelError
    from cablemodel.systems.model import read_scene

    try:
        from cablemodel_fmu.export import export_fmu, ports_file
    except ModuleNotFoundError as error:
        raise CableModelError(f"the package cablemodel_fmu is not installed: {error}") from error

    loaded = read_scene(scene, overrides or ())
    target = writable(output or Path(scene.with_suffix(".fmu").name), (".fmu",))

    system = None if ssp is None else writable(ssp, (".ssp",))

    def say(line: str) -> None:
        typer.echo(f"cablemodel: {line}", err=True)

    names = [name.strip() for name in platform.split(",") if name.strip()]
    with writing(target):
        export_fmu(
            loaded, target, platforms=names, stations=stations, progress=say, inputs=inputs,
            vessel_input=vessel_input, timing=timing, author=author, ssp=system,
        )  # fmt: skip
    size = target.stat().st_size / 1e6
    typer.echo(f"FMU: {target} ({size:.1f} MB) for {', '.join(names)}")
    if system is not None:
        typer.echo(f"A vessel with it, as a system (SSP): {system}")
    typer.echo(f"Its ports, for the Open Simulation Platform: {ports_file(loaded, target)}")
