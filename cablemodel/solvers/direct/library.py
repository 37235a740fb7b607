"""The direct solver's kernels by name: from the compiled library where it fits, else by numba."""

from __future__ import annotations

from functools import cache

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers import library
from cablemodel.solvers.direct.kernels.layout import (
    TASK_ASSEMBLE,
    TASK_EQUILIBRIUM,
    TASK_SOLVE,
    TASK_STEP,
)
from cablemodel.solvers.shared.layout import Scalars

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

PREFIX = "direct_"
"""Of these entry points' names among those of the library."""
_NO_INPUTS: FloatArray = np.zeros(14)


@cache
def _kernels() -> dict[str, library.Kernel]:
    """The entry points of kernels/entry.py by name."""
    if library.library_path() is not None:
        return {
            name.removeprefix(PREFIX): kernel
            for name, kernel in library.entry_points().items()
            if name.startswith(PREFIX)
        }
    from cablemodel.solvers.direct.kernels.entry import ENTRY_POINTS

    return library.telling(ENTRY_POINTS)


def step(ints: IntArray, reals: FloatArray, end: float, inputs: FloatArray) -> int:
    """Step to a time [s] with 14 words of inputs; the status."""
    return int(_kernels()["work"](ints, reals, TASK_STEP, end, inputs))


def equilibrium(ints: IntArray, reals: FloatArray) -> int:
    """The steady state at the block's time; the status."""
    state = Scalars(reals)
    return int(_kernels()["work"](ints, reals, TASK_EQUILIBRIUM, float(state.time), _NO_INPUTS))


def assemble(ints: IntArray, reals: FloatArray) -> int:
    """The slots of the Newton system at the present state; their number."""
    return int(_kernels()["work"](ints, reals, TASK_ASSEMBLE, 0.0, _NO_INPUTS))


def solve(ints: IntArray, reals: FloatArray, slots: int) -> int:
    """Solve the assembled slots by the block's method; the status."""
    return int(_kernels()["work"](ints, reals, TASK_SOLVE, float(slots), _NO_INPUTS))


def place(ints: IntArray, reals: FloatArray, time: float) -> None:
    """Strains and places of the nodes for the vessel's motion at a time [s]."""
    _kernels()["place"](ints, reals, time)


def sample(ints: IntArray, reals: FloatArray, stations: FloatArray, out: FloatArray) -> int:
    """State at arc lengths [m]; out: rows of STATION_WORDS. How many are on the line."""
    return int(_kernels()["sample"](ints, reals, stations, out))


def bodies(ints: IntArray, reals: FloatArray, out: FloatArray) -> int:
    """Motion of the bodies of line and drum; out: rows of STATION_WORDS. Their number."""
    return int(_kernels()["bodies"](ints, reals, out))


def summary(ints: IntArray, reals: FloatArray, out: FloatArray) -> None:
    """The numbers of kernels/outputs/summary.py: summarise."""
    _kernels()["summary"](ints, reals, out)
