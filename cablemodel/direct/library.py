"""The direct solver's kernels, compiled when first called: ``library.step(ints, reals, ...)``."""

from __future__ import annotations

from typing import Any


def __getattr__(name: str) -> Any:
    """An entry point of kernels/entry.py."""
    if name.startswith("_"):
        raise AttributeError(name)
    from cablemodel.direct.kernels.entry import ENTRY_POINTS

    if name not in ENTRY_POINTS:
        raise AttributeError(f"the direct solver's kernels have no entry point {name!r}")
    globals()[name] = ENTRY_POINTS[name]
    return ENTRY_POINTS[name]
