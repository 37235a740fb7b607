"""The control loop: a thread that steps a session when its pacer says so."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

from cablemodel_ros.pacing import MERGE, ClockPacer, FreePacer, Pacer, WallPacer
from cablemodel_ros.session import Cycle, Session, SessionError
from cablemodel_ros.settings import Settings

_LONGEST_WAIT = 0.1
"""[s], so that a stop is noticed."""


class ForeignClock:
    """The last time of a foreign clock [ns], and a way to wait for the next."""

    def __init__(self) -> None:
        self._condition = threading.Condition()
        self._now: int | None = None

    def set(self, now: int) -> None:
        """Called for every message of the clock."""
        with self._condition:
            self._now = now
            self._condition.notify_all()

    @property
    def now(self) -> int | None:
        """[ns]; None before the first message."""
        return self._now

    def wait(self, seen: int | None, timeout: float) -> int | None:
        """The time, as soon as it differs from `seen`, or after `timeout` [s]."""
        with self._condition:
            self._condition.wait_for(lambda: self._now != seen, timeout)
            return self._now


def pacer_for(settings: Settings, foreign: bool) -> Pacer:
    """The pacer that the settings ask for; `foreign`: follow a foreign clock."""
    period = 1.0 / settings.rate
    if foreign:
        return ClockPacer(period)
    if settings.real_time_factor == 0.0:
        return FreePacer(period)
    return WallPacer(period, settings.real_time_factor, settings.lag_limit)


class ControlLoop:
    """Runs a session in a thread of its own.

    Args:
        session: what to step.
        lock: held while the session is touched.
        publish: called with every cycle, outside the lock.
        failed: called (from the thread) when the session cannot go on; the thread ends.
        clock: a foreign clock to follow, or None.
        ros_now: ROS time [ns], where simulated time is not that time itself.

    Attributes: ``pacer``, ``resets`` that a jump of the foreign clock caused.
    """

    def __init__(
        self,
        session: Session,
        lock: threading.Lock,
        publish: Callable[[Cycle], None],
        failed: Callable[[str], None],
        *,
        clock: ForeignClock | None = None,
        ros_now: Callable[[], int] = time.time_ns,
    ) -> None:
        self.session = session
        self.pacer = pacer_for(session.settings, clock is not None)
        self.resets = 0
        self._lock, self._publish, self._failed = lock, publish, failed
        self._clock, self._ros_now = clock, ros_now
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None
        self._shed_in_a_row = 0
        self._started = False

    def start(self) -> None:
        """Go on from the session's present state."""
        self._stop.clear()
        self._started = False
        if self._clock is None:
            with self._lock:
                self._begin()
        self._thread = threading.Thread(target=self._run, name="cable control", daemon=True)
        self._thread.start()

    def stop(self) -> None:
        """Stop after the present cycle; the log's file is finished."""
        self._stop.set()
        if self._thread is not None and self._thread is not threading.current_thread():
            self._thread.join()
        self._thread = None
        with self._lock:
            self.session.stop()

    @property
    def running(self) -> bool:
        """Whether the thread runs."""
        return self._thread is not None and self._thread.is_alive()

    def update(self, settings: Settings) -> None:
        """Take over parameters that may change at any time."""
        with self._lock:
            self.session.update(settings)
            if isinstance(self.pacer, WallPacer):
                self.pacer.lag_limit = settings.lag_limit

    def reset(self) -> None:
        """The session back to its initial state; time goes on from now."""
        with self._lock:
            self.session.reset(self._now_ns())
            if self.running:
                self._restart_pacer()
            else:
                self.session.stop()

    def _begin(self) -> None:
        self.session.start(self._now_ns())
        self._restart_pacer()
        self._started = True

    def _restart_pacer(self) -> None:
        now = 1e-9 * self.session.stamp() if self._clock is not None else time.monotonic()
        self.pacer.start(now, self.session.model.time)

    def _now_ns(self) -> int:
        """ROS time [ns] that belongs to the session's present time when it starts."""
        if self._clock is not None:
            return self._clock.now or 0
        if self.session.settings.publishes_clock:
            return self.session.stamp()  # counts from 0, and goes on over a reset
        return self._ros_now()

    def _run(self) -> None:
        seen: int | None = None
        try:
            while not self._stop.is_set():
                if self._clock is not None:
                    seen = self._follow(seen)
                    continue
                plan = self.pacer.plan(time.monotonic())
                if plan.wait > 0.0:
                    time.sleep(min(plan.wait, _LONGEST_WAIT))
                elif plan.target is not None:
                    self._cycle(plan.target)
        except SessionError as failure:
            self._failed(str(failure))
        except Exception as error:
            self._failed(f"{type(error).__name__}: {error}")

    def _follow(self, seen: int | None) -> int | None:
        """Make all steps that the foreign clock allows, then wait for it."""
        assert self._clock is not None
        now = self._clock.wait(seen, _LONGEST_WAIT)
        if now is None or now == seen:
            return seen
        if not self._started:
            with self._lock:
                self._begin()
        while not self._stop.is_set():
            # Counted from the start of the run: absolute times in 64-bit floats would lose digits.
            target = self.pacer.plan(1e-9 * now).target
            if getattr(self.pacer, "jumped", False):
                with self._lock:
                    self.resets += 1
                    self.session.reset(now)
                    self._restart_pacer()
                break
            if target is None:
                break
            self._cycle(target)
        return now

    def _has_time(self) -> bool:
        """Whether to publish: what is late is not, but for one cycle in ten, so that topics stay
        alive."""
        publish = self._shed_in_a_row >= MERGE - 1 or not self.pacer.late(time.monotonic())
        self._shed_in_a_row = 0 if publish else self._shed_in_a_row + 1
        return publish

    def _cycle(self, target: float) -> None:
        begin = time.perf_counter()
        with self._lock:
            session = self.session
            if target <= session.model.time:
                return  # a reset came between the plan and the step
            now = 1e-9 * session.epoch + target + self.pacer.slipped
            cycle = session.cycle(target, now, publish=self._has_time)
        self._publish(cycle)
        session.cycle_times.add(time.perf_counter() - begin)
