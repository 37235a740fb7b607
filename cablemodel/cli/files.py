"""Files that commands write: looked at before the work is done, so that none is done in vain."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from cablemodel.cli.errors import bad_option, reason_of

PICTURES = (".png", ".pdf", ".svg")
"""Endings of a picture's file."""


def writable(target: Path, endings: tuple[str, ...], option: str = "--output") -> Path:
    """A file to write, after a look at its ending and folder.

    The ending keeps a slip from overwriting a scene with a picture or a log.

    Raises:
        typer.BadParameter: a wrong ending, or no such folder.
    """
    if target.suffix.lower() not in endings:
        named = " or ".join(filter(None, [", ".join(endings[:-1]), endings[-1]]))
        raise bad_option(option, f"{target} must end in {named}")
    if not target.parent.is_dir():
        raise bad_option(option, f"there is no folder {target.parent}")
    if target.is_dir():
        raise bad_option(option, f"{target} is a folder")
    return target


def new_file(target: Path, force: bool, option: str) -> Path:
    """A scene to write that is not there yet, or is to be overwritten.

    Raises:
        typer.BadParameter: as of `writable`; or there is such a file.
    """
    writable(target, (".yaml", ".yml"), option)
    if target.exists() and not force:
        raise bad_option(option, f"{target} exists; --force overwrites it")
    return target


@contextmanager
def writing(target: Path, option: str = "--output") -> Iterator[None]:
    """A block that writes a file: where it cannot, that is said of the option that names it.

    Raises:
        typer.BadParameter: the file cannot be written.
    """
    try:
        yield
    except BrokenPipeError:
        raise  # the reader of our output has gone
    except OSError as error:
        raise bad_option(option, f"{target} cannot be written: {reason_of(error)}") from error
