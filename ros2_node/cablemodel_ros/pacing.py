"""When to step, and how far: by the clock, as fast as possible, or behind a foreign clock.

A pacer reads one clock, its own; nothing here waits. Steps end on the grid ``start + k period``
(never a sum of periods, whose round-off would grow). Where the clock has run ahead, several periods
become one longer step, which costs hardly more than one period; what even that cannot make up
slips. So simulated time may fall behind, but a late cycle never causes more work in the next.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from cablemodel_ros.times import Monotonic, Simulated, Stamp

MERGE = 10
"""Most periods in one step."""


@dataclass(frozen=True)
class Plan:
    """What to do now: wait [s], or step to `target` (None: nothing to do until told)."""

    wait: float = 0.0
    target: Simulated | None = None
    due: Monotonic | None = None
    """When the target was due, where the monotonic clock decides that."""
    slip: float = 0.0
    """By how much more simulated time now lags real time for good [s]."""


class Pacer(Protocol):
    """Decides on the next step.

    Attributes: ``missed`` deadlines, ``slipped`` [s] that were given up, ``behind`` [s] at the
    last decision, ``jumped`` (the clock jumped: begin anew).
    """

    missed: int
    slipped: float
    behind: float
    jumped: bool

    def start(self, time: Simulated) -> None:
        """Begin: simulated `time` is now."""

    def plan(self) -> Plan:
        """What to do now."""

    def late(self) -> bool:
        """Whether the next deadline has passed: then publication is shed."""


class _Grid:
    """Ends of steps: start + k period."""

    def __init__(self, period: float) -> None:
        self.period = period
        self.missed = 0
        self.slipped = 0.0
        self.behind = 0.0
        self.jumped = False
        self._begin = Simulated(0.0)
        self._step = 0

    def _restart(self, time: Simulated) -> None:
        self._begin, self._step = time, 0

    def _advance(self, periods: int) -> Simulated:
        self._step += periods
        return self._begin + self._step * self.period


class WallPacer(_Grid):
    """Real time, or `factor` times real time.

    Args:
        period: of simulated time between steps [s].
        factor: simulated seconds per second.
        lag_limit: how far the simulation may lag [s] before time slips.
        clock: reads the time.
    """

    def __init__(
        self,
        period: float,
        factor: float = 1.0,
        lag_limit: float = 0.5,
        clock: Callable[[], Monotonic] = Monotonic.now,
    ) -> None:
        super().__init__(period)
        self.factor = factor
        self.lag_limit = lag_limit
        self._clock = clock
        self._zero = clock()

    def start(self, time: Simulated) -> None:
        self._restart(time)
        self._zero = self._clock()

    def _deadline(self, step: int) -> Monotonic:
        return self._zero + step * self.period / self.factor

    def plan(self) -> Plan:
        now = self._clock()
        wait = self._deadline(self._step + 1) - now
        if wait > 0.0:
            return Plan(wait=wait)
        # The step for a deadline begins at it: being a whole period late is a miss.
        tick = self.period / self.factor
        late = math.floor(-wait / tick)
        periods = 1 + min(late, MERGE - 1)
        self.missed += late
        target = self._advance(periods)
        self.behind = now - self._deadline(self._step)
        slip = 0.0
        if self.behind > self.lag_limit:
            slip = self.behind
            self.slipped += slip
            self._zero += slip
            self.behind = 0.0
        return Plan(target=target, due=self._deadline(self._step), slip=slip)

    def late(self) -> bool:
        return self._clock() > self._deadline(self._step + 1)


class FreePacer(_Grid):
    """As fast as possible: there is no clock and no deadline."""

    def start(self, time: Simulated) -> None:
        self._restart(time)

    def plan(self) -> Plan:
        return Plan(target=self._advance(1))

    def late(self) -> bool:
        return False


class ClockPacer(_Grid):
    """Behind a foreign clock. It may pause; where it jumps back, or by more than `jump_limit` [s]
    ahead, `jumped` is set and the caller starts anew."""

    def __init__(self, period: float, clock: Callable[[], Stamp], jump_limit: float = 60.0) -> None:
        super().__init__(period)
        self.jump_limit = jump_limit
        self._clock = clock
        self._zero = self._last = Stamp(0)

    def start(self, time: Simulated) -> None:
        self._restart(time)
        self._zero = self._last = self._clock()
        self.jumped = False

    def plan(self) -> Plan:
        now = self._clock()
        if now < self._last or now - self._last > self.jump_limit:
            self.jumped = True
            return Plan()
        self._last = now
        # A stamp is rounded to a nanosecond: what is nearer than that has been reached.
        ready = math.floor((now - self._zero + 2e-9) / self.period) - self._step
        if ready <= 0:
            return Plan()
        target = self._advance(min(ready, MERGE))
        self.behind = max(0.0, now - self._zero - self._step * self.period)
        return Plan(target=target)

    def late(self) -> bool:
        return self._clock() - self._zero > (self._step + MERGE) * self.period
