"""Errors on the command line: one clear message and an exit status, never a traceback."""

from __future__ import annotations

import functools
import os
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, ParamSpec

import typer

from cablemodel.errors import CableModelError, LogError, SceneError, StartWarning

BAD_INPUT = 2
FAILED = 1
INTERRUPTED = 130

Parameters = ParamSpec("Parameters")

_tracebacks = False


def show_tracebacks(show: bool) -> None:
    """Whether errors come with their traceback from now on."""
    global _tracebacks
    _tracebacks = show


class FailedRunError(Exception):
    """A run that began and failed; its message is complete, its cause the error behind it."""


def reported(command: Callable[Parameters, None]) -> Callable[Parameters, None]:
    """A command whose errors end in a message on standard error and an exit status."""

    @functools.wraps(command)
    def guarded(*args: Parameters.args, **kwargs: Parameters.kwargs) -> None:
        try:
            with _warnings_in_words():
                command(*args, **kwargs)
        except (typer.Exit, typer.BadParameter):
            raise  # typer knows what to do
        except (KeyboardInterrupt, typer.Abort):  # the latter at a question
            _end("interrupted", INTERRUPTED)
        except BrokenPipeError:
            # The reader of our output (head, less) has gone; there is nobody to tell.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            raise typer.Exit(FAILED) from None
        except OSError as error:
            _end(_in_words(error), BAD_INPUT, error)
        except (SceneError, LogError) as error:
            _end(str(error), BAD_INPUT, error)
        except (CableModelError, FailedRunError) as error:
            _end(str(error), FAILED, error)
        except Exception as error:
            message = (
                f"internal error: {type(error).__name__}: {error}\n"
                "This is a defect of cablemodel. Please report it with the output of the same "
                "command and --traceback."
            )
            _end(message, FAILED, error)

    return guarded


def reason_of(error: OSError) -> str:
    """Why a file could not be read or written, in the system's words."""
    # Libraries put a paragraph in the place of the system's words.
    return os.strerror(error.errno) if error.errno else " ".join(str(error).split())


def _in_words(error: OSError) -> str:
    """The file and the reason; standard output, if that is what cannot be written."""
    reason = reason_of(error)
    if error.filename is not None:
        named = error.filename if error.filename2 is None else error.filename2
        return f"{os.fsdecode(named)}: cannot be read or written: {reason}"
    return f"a file, or the output, cannot be read or written: {reason}"


def bad_option(name: str, problem: str) -> typer.BadParameter:
    """A wrong value of an option: typer shows it with the command's usage, exit status 2."""
    return typer.BadParameter(problem, param_hint=name)


@contextmanager
def _warnings_in_words() -> Iterator[None]:
    """Warnings that are meant for users, without the place in the code."""
    with warnings.catch_warnings():
        usual = warnings.showwarning

        def show(message: Any, category: type[Warning], *where: Any, **more: Any) -> None:
            if issubclass(category, StartWarning):
                typer.echo(f"cablemodel: warning: {message}", err=True)
            else:
                usual(message, category, *where, **more)

        warnings.simplefilter("always", StartWarning)
        warnings.showwarning = show
        yield


def _end(message: str, status: int, error: BaseException | None = None) -> None:
    if _tracebacks and error is not None:
        import traceback

        traceback.print_exception(error)
    try:
        sys.stdout.flush()
    except OSError:  # what is left of it cannot be written at the end either
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    typer.echo(f"cablemodel: {message}", err=True)
    raise typer.Exit(status)
