"""How the node is, in words and numbers, as /diagnostics tells it."""

from __future__ import annotations

import time
from dataclasses import dataclass, field

from cablemodel_ros.control import ControlLoop
from cablemodel_ros.session import Session

OK, WARN, ERROR = 0, 1, 2
"""Levels of diagnostic_msgs/DiagnosticStatus."""


@dataclass
class Status:
    """One entry of /diagnostics."""

    name: str
    level: int = OK
    messages: list[str] = field(default_factory=list)
    values: dict[str, str] = field(default_factory=dict)

    def add(self, level: int, message: str) -> None:
        """A finding; the highest level counts."""
        self.level = max(self.level, level)
        self.messages.append(message)

    @property
    def message(self) -> str:
        """All findings, or `running`."""
        return "; ".join(self.messages) or "running"


class Diagnostics:
    """Watches a session; remembers what it last saw, so that it tells of what is new as well."""

    def __init__(self, session: Session, loop: ControlLoop) -> None:
        self._session, self._loop = session, loop
        self._wall, self._cpu = time.monotonic(), time.process_time()
        self._simulated = session.model.time
        self._before: dict[str, float] = {}

    def statuses(self) -> list[Status]:
        """The node's present state; call it with the session's lock held."""
        found = [self._simulation(), self._commands()]
        if self._session.recorder is not None:
            found.append(self._log())
        return found

    def _new(self, name: str, count: float) -> float:
        """How much a counter has grown since the last call."""
        before = self._before.get(name, 0.0)
        self._before[name] = count
        return count - before

    def _simulation(self) -> Status:
        session, pacer = self._session, self._loop.pacer
        model = session.model
        status = Status("simulation")
        wall, cpu = time.monotonic(), time.process_time()
        span = max(wall - self._wall, 1e-9)
        speed = (model.time - self._simulated) / span
        load = 100.0 * (cpu - self._cpu) / span
        self._wall, self._cpu, self._simulated = wall, cpu, model.time
        if session.failure:
            status.add(ERROR, session.failure)
        elif not self._loop.running:
            status.add(OK, "paused")
        if self._new("retries", session.checkpoints.retries):
            status.add(ERROR, f"a step could not be made: {session.last_failure}; gone back by "
                              f"{session.checkpoints.gone_back:.3g} s")  # fmt: skip
        missed = self._new("missed", pacer.missed)
        if missed:
            status.add(WARN, f"{missed:g} deadlines missed")
        slipped = self._new("slipped", pacer.slipped)
        if slipped:
            status.add(WARN, f"simulated time slipped by {slipped:.3g} s: too slow for this rate")
        if self._new("clock steps", session.timebase.clock_steps):
            status.add(WARN, f"the system's clock was set by {session.timebase.clock_step:+.3g} s: "
                             "stamps follow it")  # fmt: skip
        shed = self._new("shed", session.shed)
        if shed:
            status.add(WARN, f"{shed:g} publications left out to keep up")
        if self._new("resets", self._loop.resets):
            status.add(WARN, "the foreign clock jumped: reset")
        for finding in session.rig.findings():
            status.add(WARN, finding)
        if self._loop.running and not speed:
            status.add(WARN, "time stands still: waiting for /clock?")
        statistics = model.statistics
        status.values |= session.rig.values()
        status.values |= {
            "simulated time [s]": f"{model.time:.3f}",
            "times real time": f"{speed:.3f}",
            "top tension [N]": f"{model.top_tension:.3f}",
            "cycles": str(session.cycles),
            "deadlines missed": str(pacer.missed),
            "time slipped [s]": f"{pacer.slipped:.3f}",
            "behind [s]": f"{pacer.behind:.4f}",
            "publications left out": str(session.shed),
            "gone back after a failure": str(session.checkpoints.retries),
            "processor [% of one core]": f"{load:.1f}",
            **{f"solver {name}": str(value) for name, value in statistics.items()},
        }
        for name, times in (("step", session.step_times), ("cycle", session.cycle_times)):
            milliseconds = {
                "mean": times.mean, "50 %": times.percentile(50.0), "99 %": times.percentile(99.0),
                "99.9 %": times.percentile(99.9), "largest": times.largest,
            }  # fmt: skip
            for key, value in milliseconds.items():
                status.values[f"{name} time {key} [ms]"] = f"{1e3 * value:.4f}"
            counts = (f"{span}: {count}" for span, count in times.table().items())
            status.values[f"{name} times [ms]"] = ", ".join(counts)
        return status

    def _commands(self) -> Status:
        session = self._session
        rig, status = session.rig, Status("commands")
        for topic in sorted(rig.stale):
            ends = "it acts no more" if topic in rig.abrupt else "ramping to zero"
            status.add(WARN, f"{topic} is stale: {ends}")
        for finding in rig.command_findings():
            status.add(WARN, finding)
        for topic in sorted(rig.waiting):
            status.add(WARN, f"no {topic} yet")
        for topic, tally in rig.tallies.items():
            status.values[f"{topic} received"] = str(tally.received)
            status.values[f"{topic} refused"] = str(tally.refused)
            new = self._new(topic, tally.refused)
            if new:
                status.add(WARN, f"{new:g} of {topic} refused, the last: {tally.reason}")
            if tally.reason:
                status.values[f"{topic} last refusal"] = tally.reason
        limited = self._new("limited", rig.limited)
        status.values["steps with a limit at work"] = str(rig.limited)
        status.values["limited now"] = str(bool(limited)).lower()
        return status

    def _log(self) -> Status:
        recorder = self._session.recorder
        assert recorder is not None
        status = Status("log")
        recovered = self._new("log recoveries", recorder.recoveries)
        if recorder.error:
            status.add(ERROR, f"nothing is logged: {recorder.error}; it is tried again")
        elif recovered:
            status.add(WARN, "nothing was logged for a while: a new file begins after the gap")
        if recorder.problem:
            status.add(WARN, recorder.problem)
        if self._new("dropped", recorder.dropped):
            status.add(WARN, "outputs were left out: the disk is too slow")
        if self._new("gaps", recorder.gaps):
            status.add(ERROR, "steps were left out: a new file begins after the gap")
        status.values = {
            "file": str(recorder.path or ""),
            "bytes": str(recorder.written),
            "files": str(recorder.files),
            "outputs left out": str(recorder.dropped),
            "gaps": str(recorder.gaps),
        }
        return status
