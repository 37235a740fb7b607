"""``cablemodel import``: scenes from the input of other programs."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cablemodel.cli.errors import reported
from cablemodel.cli.files import new_file, writing

imports = typer.Typer(help="Make a scene from the input of another program.", no_args_is_help=True)


@imports.command()
@reported
def moordyn(
    deck: Annotated[Path, typer.Argument(help="Input file of MoorDyn v2.", show_default=False)],
    output: Annotated[
        Path | None,
        typer.Option(
            "--output",
            "-o",
            help="Scene to write (.yaml, .yml); by default the deck's name with .yaml.",
            show_default=False,
        ),
    ] = None,
    line: Annotated[
        int | None,
        typer.Option(help="ID of a line to take alone; by default all.", show_default=False),
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="Overwrite the scene.")] = False,
) -> None:
    """Lines with their points, bodies and rods; says what it cannot take."""
    from cablemodel.moordyn_deck import read_deck
    from cablemodel.systems.model import read_scene

    target = new_file(output or deck.with_suffix(".yaml"), force, "--output")
    # Units in its headings may be in any encoding.
    text, left = read_deck(
        deck.read_text(encoding="utf-8", errors="replace"), deck.name, line, deck.parent
    )
    read_scene(text)
    with writing(target), target.open("w" if force else "x", encoding="utf-8") as scene:
        scene.write(text)
    for item in left:
        typer.echo(f"cablemodel: not as in the deck: {item}", err=True)
    typer.echo(f"Scene: {target}")
