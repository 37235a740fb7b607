"""``cablemodel new``: a scene to start from."""

from __future__ import annotations

import shlex
import sys
from pathlib import Path
from typing import Annotated, Any

import typer

from cablemodel.cli.errors import bad_option, reported
from cablemodel.cli.files import new_file, writing

TEMPLATES = Path(__file__).parent / "templates"
"""Complete scenes; the first line of each says what it is."""


def _text(name: str) -> str:
    return (TEMPLATES / f"{name}.yaml").read_text(encoding="utf-8")


def _what(name: str) -> str:
    """The first line of a template, without its comment sign."""
    return _text(name).partition("\n")[0].removeprefix("# ")


def _flag(name: str) -> Any:
    return typer.Option(f"--{name}", help=_what(name))


@reported
def new(
    file: Annotated[Path, typer.Argument(help="Scene to write (.yaml, .yml).", show_default=False)],
    tow: Annotated[bool, _flag("tow")] = False,
    turn: Annotated[bool, _flag("turn")] = False,
    lay: Annotated[bool, _flag("lay")] = False,
    recover: Annotated[bool, _flag("recover")] = False,
    lower: Annotated[bool, _flag("lower")] = False,
    mooring: Annotated[bool, _flag("mooring")] = False,
    jumper: Annotated[bool, _flag("jumper")] = False,
    system: Annotated[bool, _flag("system")] = False,
    force: Annotated[bool, typer.Option("--force", help="Overwrite FILE.")] = False,
) -> None:
    """Write a complete scene with comments, to be changed; asks which where no option says it."""
    asked = {
        "tow": tow, "turn": turn, "lay": lay, "recover": recover,
        "lower": lower, "mooring": mooring, "jumper": jumper,
        "system": system,
    }  # fmt: skip
    chosen = [name for name, wanted in asked.items() if wanted]
    options = ", ".join(f"--{name}" for name in asked)
    if len(chosen) > 1:
        raise bad_option(f"--{chosen[1]}", f"one template a scene, not also --{chosen[0]}")
    target = new_file(file, force, "FILE")
    if not chosen and not sys.stdin.isatty():
        raise typer.BadParameter(f"which scene? One of {options}")
    name = chosen[0] if chosen else _answer(list(asked))
    with writing(target, "FILE"), target.open("w" if force else "x", encoding="utf-8") as scene:
        scene.write(_text(name))
    written, log = (shlex.quote(str(path)) for path in (target, target.with_suffix(".mcap")))
    typer.echo(f"Scene: {target}")
    typer.echo(f"Next: cablemodel check {written}")
    typer.echo(f"      cablemodel run {written} --log {log}")
    typer.echo(f"      cablemodel open {log}")


def _answer(names: list[str]) -> str:
    """Which template the user wants, by its name or number."""
    for number, name in enumerate(names, 1):
        typer.echo(f"{number}  {name:8} {_what(name)}", err=True)

    def known(answer: str) -> str:
        numbered = {str(number): name for number, name in enumerate(names, 1)}
        found = numbered.get(answer.strip(), answer.strip())
        if found not in names:
            raise typer.BadParameter(f"{answer!r} is none of {', '.join(names)}")
        return found

    found: str = typer.prompt("Which", value_proc=known, err=True)
    return found
