"""What the façade asks of a solver: one protocol, with an implementation for each method."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.shared.layout import HEADER_WORDS, Header, Scalars, Winch

if TYPE_CHECKING:
    pass

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

FINER = 4.0
"""Ratio of a tolerance to that of a run that it is judged by. Here, for those who only read what
such a run said do without the finite elements."""


@dataclass(frozen=True)
class PlacedBody:
    """A body that is out."""

    name: str | None
    position: FloatArray
    """Of its centre of gravity (3,) [m]."""
    velocity: FloatArray
    """(3,) [m/s]."""
    direction: FloatArray
    """Unit vector along its axis, away from the vessel (3,)."""


@dataclass(frozen=True)
class Errors:
    """What a part of a model, a line or a body, is estimated to be wrong by at one time."""

    position: float
    """The largest anywhere [m]; not a number where it is not known."""
    tension: float | None
    """At its ends, of one line below a vessel at the top [N]; not a number where it is not known.
    A body has none."""
    length: float
    """What a tolerance promises positions as a part of [m]."""


class Memory(Protocol):
    """An instance block: one piece of memory, whose words of cablemodel/solvers/shared/layout.py
    that hold identity, time, counters, vessel motion, current and pay-out are the same for all."""

    ints: IntArray
    reals: FloatArray

    @property
    def header(self) -> Header: ...

    @property
    def scalars(self) -> Scalars: ...

    @property
    def winch(self) -> Winch: ...

    @property
    def image(self) -> IntArray: ...

    def fits(self, image: IntArray) -> bool: ...

    def take(self, image: IntArray) -> None: ...


def images_of(image: bytes, memories: Sequence[Memory]) -> list[IntArray]:
    """The images of blocks, which a snapshot has one after the other; none where it is not of
    these. Each says how long it is: what runs have added to makes no difference."""
    if len(image) % 8:
        return []
    rest = np.frombuffer(image, dtype=np.int64)
    parts = []
    for _memory in memories:
        words = int(Header(rest).image_words) if len(rest) >= HEADER_WORDS else 0
        parts.append(rest[: max(0, words)])
        rest = rest[max(0, words) :]
    pairs = zip(memories, parts, strict=True)
    if len(rest) > 0 or not all(memory.fits(part) for memory, part in pairs):
        return []
    return parts


class OfBlock:
    """What a solver reads of its block goes through the block: a copy of a solver whose views were
    its own, as NumPy copies them, would hold two pieces of memory."""

    memory: Memory

    @property
    def _ints(self) -> IntArray:
        return self.memory.ints

    @property
    def _reals(self) -> FloatArray:
        return self.memory.reals

    @property
    def _header(self) -> Header:
        return self.memory.header

    @property
    def _scalars(self) -> Scalars:
        return self.memory.scalars

    @property
    def memories(self) -> tuple[Memory, ...]:
        """The blocks whose images are all that a snapshot keeps."""
        return (self.memory,)

    def errors(self) -> tuple[float, float] | None:
        """None: not estimated."""
        return None


class Solver(Protocol):
    """One line at one instant, and how it goes on."""

    @property
    def memory(self) -> Memory: ...

    @property
    def memories(self) -> tuple[Memory, ...]:
        """The blocks whose images are all that a snapshot keeps; the first one is `memory`."""

    def errors(self) -> tuple[float, float] | None:
        """What positions [m] and the top tension [N] are estimated to be wrong by; None where that
        is not asked for, not numbers where it is not known."""

    def step(self, end: float, inputs: FloatArray) -> int:
        """Step to a time with the INPUT_WORDS of kernels/time/stepping.py; 0, or a status of
        failure."""

    def explain(self, status: int) -> tuple[str, str]:
        """Problem and advice of a status."""

    def failed_arc(self) -> float:
        """Arc length of the place that the last failure points to [m]."""

    def summary(self, out: FloatArray) -> None:
        """The numbers of kernels/outputs/summary.py: summarise."""

    def sample(self, stations: FloatArray, out: FloatArray) -> int:
        """Rows of STATION_WORDS at arc lengths; how many stations are on the line."""

    def node_arcs(self) -> FloatArray:
        """Arc lengths of the nodes, without those that share a place [m]."""

    def bodies(self) -> list[PlacedBody]:
        """The bodies that are out, from the vessel outwards."""

    @property
    def planar(self) -> bool: ...

    @property
    def elements(self) -> int: ...

    @property
    def asleep(self) -> int:
        """Elements that rest on the floor and are left out of the steps."""
