"""The node's kinds of time, as types that cannot be mixed.

Instants of one kind are compared and subtracted (a float [s]), and moved by seconds; an instant of
another kind is a TypeError, and mypy refuses it before. What one kind is in another is said in one
place: `timebase`.
"""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Self


@dataclass(frozen=True, order=True)
class _Nanoseconds:
    """An instant in whole nanoseconds: 64-bit floats of absolute time would lose digits."""

    ns: int

    def __add__(self, seconds: float) -> Self:
        return type(self)(self.ns + round(1e9 * seconds))

    def __sub__(self, other: Self) -> float:
        """Seconds between two instants of one kind."""
        if type(other) is not type(self):
            return NotImplemented
        return 1e-9 * (self.ns - other.ns)

    @property
    def seconds(self) -> float:
        """Since the zero of its clock [s]."""
        return 1e-9 * self.ns


@dataclass(frozen=True, order=True)
class Monotonic(_Nanoseconds):
    """The machine's monotonic clock, which nobody sets: deadlines."""

    @classmethod
    def now(cls) -> Monotonic:
        """The present."""
        return cls(time.monotonic_ns())


@dataclass(frozen=True, order=True)
class Stamp(_Nanoseconds):
    """ROS time: what headers and /clock carry. It may be set, paused and begun anew."""

    @classmethod
    def now(cls) -> Stamp:
        """The system's clock, which is ROS time where no /clock is followed."""
        return cls(time.time_ns())


@dataclass(frozen=True, order=True)
class Moment(_Nanoseconds):
    """When, by the clock that commands age by: the monotonic one in real time, else the one on
    /clock."""


@dataclass(frozen=True, order=True)
class Simulated:
    """The model's time [s]."""

    seconds: float

    def __add__(self, seconds: float) -> Simulated:
        return Simulated(self.seconds + seconds)

    def __sub__(self, other: Simulated) -> float:
        """Simulated seconds between two times."""
        if type(other) is not Simulated:
            return NotImplemented
        return self.seconds - other.seconds
