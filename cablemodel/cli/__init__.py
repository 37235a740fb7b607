"""The command line. It is the only part of the package that prints.

Results go to standard output, progress and errors to standard error. Exit status: 0 done, 1 a run
that failed, 2 bad input, 130 interrupted.
"""

from cablemodel.cli.app import app, main

__all__ = ["app", "main"]
