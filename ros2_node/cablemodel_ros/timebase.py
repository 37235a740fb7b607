"""What one kind of time is in another: the one place where kinds of time meet.

A time base says which stamp belongs to the model's time, and by which clock commands age:

| | stamps | commands age by |
|---|---|---|
| `RealTime` | the system's clock, also after it was set | the monotonic clock |
| `Published` | simulated time, which goes out on /clock | the same |
| `Followed` | a foreign /clock | the same |
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from cablemodel_ros.times import Moment, Monotonic, Simulated, Stamp

CLOCK_STEP = 0.05
"""How far [s] the system's clock must move against the monotonic one to have been set."""
_LOOK_EVERY = 0.1
"""[s]"""
_AT_ONCE = 1e-3
"""Two clocks are compared when they were read within this time [s]: a thread may be held up
between two readings."""


@dataclass(frozen=True)
class Arrival:
    """When a message came, and when it was made."""

    now: Moment
    made: Moment
    """By its stamp; `now` where it has none."""

    @property
    def delay(self) -> float:
        """[s]; negative where the stamp lies in the future."""
        return self.now - self.made


class Timebase:
    """Common to all; `epoch` is the stamp of the model's time zero.

    Attributes: ``clock_steps`` (times that the system's clock was set), ``clock_step`` (by how much
    it was set last [s]).
    """

    def __init__(self) -> None:
        self.epoch = Stamp(0)
        self.clock_steps = 0
        self.clock_step = 0.0

    def begin(self, time: Simulated) -> None:
        """The model's `time` is now: at a start, after a pause, and after a reset."""
        self.epoch = self.ros_now() + -time.seconds

    def stamp(self, time: Simulated) -> Stamp:
        """Stamp that belongs to the model's time."""
        return self.epoch + time.seconds

    def reached(self, time: Simulated) -> None:
        """The model stands at `time`."""

    def slip(self, seconds: float) -> None:
        """The model's time has fallen behind real time by so much [s], for good."""

    def ros_now(self) -> Stamp:
        """The present on the clock that messages are stamped by."""
        raise NotImplementedError

    def now(self) -> Moment:
        """The present on the clock that commands age by."""
        return Moment(self.ros_now().ns)

    def at(self, time: Simulated, due: Monotonic | None) -> Moment:
        """The moment that the model's `time` belongs to; `due`: when it was due, in real time."""
        return Moment(self.stamp(time).ns)

    def arrival(self, stamp: Stamp | None) -> Arrival:
        """When a message that comes now was made; None: it is not stamped."""
        now = self.now()
        delay = 0.0 if stamp is None else self.ros_now() - stamp
        return Arrival(now, now + -delay)

    def follow_clock_step(self) -> bool:
        """Whether the system's clock was set since the last call; stamps then follow it."""
        return False


class RealTime(Timebase):
    """Real time: the model's time passes with the monotonic clock.

    Args:
        ros: reads ROS time.
        monotonic: reads the monotonic clock.
    """

    def __init__(
        self,
        ros: Callable[[], Stamp] = Stamp.now,
        monotonic: Callable[[], Monotonic] = Monotonic.now,
    ) -> None:
        super().__init__()
        self._ros, self._monotonic = ros, monotonic
        self._looked = monotonic()
        self._anchor = (self._ros(), self._looked)

    def begin(self, time: Simulated) -> None:
        super().begin(time)
        self._anchor = (self._ros(), self._monotonic())

    def slip(self, seconds: float) -> None:
        self.epoch += seconds

    def ros_now(self) -> Stamp:
        return self._ros()

    def now(self) -> Moment:
        return Moment(self._monotonic().ns)

    def at(self, time: Simulated, due: Monotonic | None) -> Moment:
        return self.now() if due is None else Moment(due.ns)

    def follow_clock_step(self) -> bool:
        before = self._monotonic()
        if before - self._looked < _LOOK_EVERY:
            return False
        self._looked = before
        ros, after = self._ros(), self._monotonic()
        if after - before > _AT_ONCE:
            return False
        step = (ros - self._anchor[0]) - (after - self._anchor[1])
        if abs(step) < CLOCK_STEP:
            return False
        self._anchor = (ros, after)
        self.epoch += step
        self.clock_steps += 1
        self.clock_step = step
        return True


class Published(Timebase):
    """Simulated time, which this node puts on /clock: it counts from 0 and never goes back."""

    def __init__(self) -> None:
        super().__init__()
        self._last: Stamp | None = None

    def begin(self, time: Simulated) -> None:
        if self._last is None:
            self._last = Stamp(0) + time.seconds
        super().begin(time)

    def reached(self, time: Simulated) -> None:
        self._last = self.stamp(time)

    def ros_now(self) -> Stamp:
        return self._last or Stamp(0)


class Followed(Timebase):
    """The time of a foreign clock; `clock` reads it (None before its first message)."""

    def __init__(self, clock: Callable[[], Stamp | None]) -> None:
        super().__init__()
        self._clock = clock

    def ros_now(self) -> Stamp:
        return self._clock() or Stamp(0)
