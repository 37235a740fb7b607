"""The direct solver's kernels by name, compiled when first called (see kernels/entry.py)."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cablemodel.kernels.layout import S_TIME

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

_NO_INPUTS: FloatArray = np.zeros(14)


@cache
def _kernels() -> Any:
    from cablemodel.direct.kernels import entry

    return entry


def step(ints: IntArray, reals: FloatArray, end: float, inputs: FloatArray) -> int:
    """Step to a time [s] with 14 words of inputs; the status."""
    entry = _kernels()
    return int(entry.work(ints, reals, entry.STEP, end, inputs))


def equilibrium(ints: IntArray, reals: FloatArray) -> int:
    """The steady state at the block's time; the status."""
    entry = _kernels()
    return int(entry.work(ints, reals, entry.EQUILIBRIUM, float(reals[S_TIME]), _NO_INPUTS))


def assemble(ints: IntArray, reals: FloatArray) -> int:
    """The slots of the Newton system at the present state; their number."""
    entry = _kernels()
    return int(entry.work(ints, reals, entry.ASSEMBLE, 0.0, _NO_INPUTS))


def solve(ints: IntArray, reals: FloatArray, slots: int) -> int:
    """Solve the assembled slots by the block's method; the status."""
    entry = _kernels()
    return int(entry.work(ints, reals, entry.SOLVE, float(slots), _NO_INPUTS))


def place(ints: IntArray, reals: FloatArray, time: float) -> None:
    """Strains and places of the nodes for the vessel's motion at a time [s]."""
    _kernels().place(ints, reals, time)


def sample(ints: IntArray, reals: FloatArray, stations: FloatArray, out: FloatArray) -> int:
    """State at arc lengths [m]; out: rows of STATION_WORDS. How many are on the line."""
    return int(_kernels().sample(ints, reals, stations, out))


def bodies(ints: IntArray, reals: FloatArray, out: FloatArray) -> int:
    """Motion of the bodies of line and drum; out: rows of STATION_WORDS. Their number."""
    return int(_kernels().bodies(ints, reals, out))


def summary(ints: IntArray, reals: FloatArray, out: FloatArray) -> None:
    """The numbers of kernels/outputs.py: summarise."""
    _kernels().summary(ints, reals, out)
