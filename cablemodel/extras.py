"""Packages that only some users need: imported when they are used, and named when missing."""

from __future__ import annotations

import importlib
from types import ModuleType

from cablemodel.errors import CableModelError


def require(package: str, *, extra: str, what: str) -> ModuleType:
    """Import an optional package.

    Args:
        package: to import.
        extra: of this project's packaging that installs it.
        what: needs it, for the message.

    Raises:
        CableModelError: it is not installed; says how to install it.
    """
    try:
        return importlib.import_module(package)
    except ImportError as error:
        name = package.split(".")[0]
        raise CableModelError(
            f"{what} needs the package {name}: pip install 'cablemodel[{extra}]'"
        ) from error
