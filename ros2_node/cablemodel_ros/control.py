"""The control loop: a thread that steps a session when its pacer says so."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Collection

from cablemodel_ros.pacing import MERGE, ClockPacer, FreePacer, Pacer, WallPacer
from cablemodel_ros.session import Cycle, Session, SessionError
from cablemodel_ros.settings import Settings
from cablemodel_ros.times import Simulated, Stamp

_LONGEST_WAIT = 0.1
"""[s], so that a stop is noticed."""


class ForeignClock:
    """The last time of a foreign clock, and a way to wait for the next."""

    def __init__(self) -> None:
        self._condition = threading.Condition()
        self._now: Stamp | None = None

    def set(self, now: Stamp) -> None:
        """Called for every message of the clock."""
        with self._condition:
            self._now = now
            self._condition.notify_all()

    def now(self) -> Stamp | None:
        """None before the first message."""
        return self._now

    def wait(self, seen: Stamp | None, timeout: float) -> Stamp | None:
        """The time, as soon as it differs from `seen`, or after `timeout` [s]."""
        with self._condition:
            self._condition.wait_for(lambda: self._now != seen, timeout)
            return self._now


def pacer_for(settings: Settings, foreign: ForeignClock | None) -> Pacer:
    """The pacer that the settings ask for; `foreign`: a foreign clock to follow."""
    period = 1.0 / settings.rate
    if foreign is not None:
        return ClockPacer(period, lambda: foreign.now() or Stamp(0))
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
        listened: topics that somebody reads; None: all.

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
        listened: Callable[[], Collection[str] | None] = lambda: None,
    ) -> None:
        self.session = session
        self.pacer = pacer_for(session.settings, clock)
        self.resets = 0
        self._lock, self._publish, self._failed = lock, publish, failed
        self._clock, self._listened = clock, listened
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
            self.session.reset()
            if self.running:
                self._restart_pacer()
            else:
                self.session.stop()

    def _begin(self) -> None:
        self.session.start()
        self._restart_pacer()
        self._started = True

    def _restart_pacer(self) -> None:
        self.pacer.start(Simulated(self.session.model.time))

    def _run(self) -> None:
        try:
            while not self._stop.is_set():
                try:
                    self._go()
                except SessionError as failure:
                    with self._lock:
                        goes_on = self.session.retry()
                        if goes_on:
                            self._restart_pacer()
                    if not goes_on:
                        self._failed(str(failure))
                        return
        except Exception as error:
            self._failed(f"{type(error).__name__}: {error}")

    def _go(self) -> None:
        """Step until told to stop."""
        seen: Stamp | None = None
        while not self._stop.is_set():
            if self._clock is not None:
                seen = self._follow(seen)
                continue
            wait = self._turn()
            if wait is not None and wait > 0.0:
                time.sleep(min(wait, _LONGEST_WAIT))

    def _follow(self, seen: Stamp | None) -> Stamp | None:
        """Make all steps that the foreign clock allows, then wait for it."""
        assert self._clock is not None
        now = self._clock.wait(seen, _LONGEST_WAIT)
        if now is None or now == seen:
            return seen
        if not self._started:
            with self._lock:
                self._begin()
        while not self._stop.is_set() and self._turn() is None:
            pass
        return now

    def _has_time(self) -> bool:
        """Whether to publish: what is late is not, but for one cycle in ten, so that topics stay
        alive."""
        publish = self._shed_in_a_row >= MERGE - 1 or not self.pacer.late()
        self._shed_in_a_row = 0 if publish else self._shed_in_a_row + 1
        return publish

    def _turn(self) -> float | None:
        """A step and its publication (then None), or how long to wait [s].

        Planned and made under one lock: a reset between the two would make one step of all the
        time before it.
        """
        begin = time.perf_counter()
        session = self.session
        with self._lock:
            plan = self.pacer.plan()
            if self.pacer.jumped:
                self.resets += 1
                session.reset()
                self._restart_pacer()
            if plan.target is None:
                return plan.wait
            session.timebase.slip(plan.slip)
            cycle = session.cycle(
                plan.target, plan.due, publish=self._has_time, topics=self._listened()
            )
        self._publish(cycle)
        session.cycle_times.add(time.perf_counter() - begin)
        return None
