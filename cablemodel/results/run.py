"""A run: what was simulated, kept in memory or read back from a log."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import cached_property
from os import PathLike
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from cablemodel import variables
from cablemodel.errors import LogError, SceneError
from cablemodel.results.promise import ErrorEstimate, PartOfRun
from cablemodel.results.states import States
from cablemodel.scene.wall_tension import Surroundings

if TYPE_CHECKING:
    import xarray

    from cablemodel.scene import Scene
    from cablemodel.systems import SystemScene

Floats = NDArray[np.float64]


class Source(Protocol):
    """Where a run's values come from: memory or a log."""

    def times(self) -> Floats: ...
    def holds(self, variable: variables.Variable) -> bool: ...
    def column(self, variable: variables.Variable) -> Floats: ...
    def shapes(self) -> dict[str, States]: ...
    def applied_inputs(self) -> dict[str, Floats]: ...


class Run:
    """Results over time. ``run[name]`` gives any output of the table of variables by its Python
    name, with time as the first axis.

    Attributes: ``scene``; ``statistics`` (of the solver: steps, rejected, factorisations,
    elements, wall_time [s], ...); ``complete`` and, if it is not, ``reason``; ``metadata`` (of a
    log: versions, revision, machine; else empty); ``wall_time`` [s]; ``snapshot`` (of a log that
    begins at another state than the scene's: that state; else None).
    """

    def __init__(
        self,
        scene: Scene,
        source: Source,
        *,
        statistics: dict[str, Any],
        complete: bool = True,
        reason: str = "",
        metadata: dict[str, str] | None = None,
    ) -> None:
        self.scene = scene
        self.statistics = statistics
        self.complete = complete
        self.reason = reason
        self.metadata = metadata or {}
        self.snapshot: bytes | None = None
        self._source = source
        self._columns: dict[str, Floats] = {}
        self._variables = {
            variable.python: variable
            for variable in variables.outputs_of(scene)
            if variable.message == variables.CLOUD or source.holds(variable)
        }

    def __repr__(self) -> str:
        title = self.scene.title or "untitled"
        reached = f"{self.time[-1]:g} s" if len(self.time) else "nothing"
        ending = "" if self.complete else f", not complete: {self.reason}"
        return f"<Run of {title!r}: {len(self.time)} outputs up to {reached}{ending}>"

    @cached_property
    def time(self) -> Floats:
        """Output times (n,) [s]."""
        return self._source.times()

    @cached_property
    def states(self) -> States:
        """Shape, tension, ... along the cable, exact, at ``states.time``: the output times, or in
        long runs some of them."""
        return self.shapes[""]

    @cached_property
    def shapes(self) -> dict[str, States]:
        """The states of every line by its name: of one line those of ``""``."""
        water = Surroundings.of(self.scene)
        return {name: states.in_water(water) for name, states in self._source.shapes().items()}

    @cached_property
    def applied_inputs(self) -> dict[str, Floats]:
        """What every step applied, by the labels of ``variables.APPLIED_INPUT_LABELS``: ``time``
        (end of the step) and ``step`` [s], ``vessel_velocity.x``, ..., each (steps,)."""
        return self._source.applied_inputs()

    def __getitem__(self, name: str) -> Floats:
        """Values over time of an output: ``run["tension_max"]`` (n,), ``run["top_force"]`` (n, 3).

        ``run["bodies.position"]`` is (n, bodies, 3), from the vessel outwards, the last one always
        the outermost; NaN while a body is on the drum.

        Raises:
            KeyError: the scene has no such output.
        """
        if name not in self._columns:
            variable = self._variables.get(name)
            if variable is None or variable.message == variables.CLOUD:
                known = ", ".join(self.names)
                raise KeyError(f"{name} is no output of this run; it has {known}")
            self._columns[name] = self._source.column(variable)
        return self._columns[name]

    def __iter__(self) -> Iterator[str]:
        """The names of the outputs."""
        return iter(self.names)

    def __contains__(self, name: object) -> bool:
        """Whether there is such an output."""
        return name in self.names

    def variable(self, name: str) -> variables.Variable:
        """The row of the table of variables of an output: its unit, its description, ..."""
        return self._variables[name]

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the outputs over time."""
        rows = self._variables.items()
        return tuple(name for name, row in rows if row.message != variables.CLOUD)

    @property
    def top_tension(self) -> Floats:
        """Tension at the tow point (n,) [N]."""
        return self["top_tension"]

    @property
    def tension_min(self) -> Floats:
        """Lowest tension along the cable (n,) [N]."""
        return self["tension_min"]

    @property
    def tension_max(self) -> Floats:
        """Highest tension along the cable (n,) [N]."""
        return self["tension_max"]

    @property
    def tip_position(self) -> Floats:
        """Position of the far end (n, 3) [m]."""
        return self["tip_position"]

    @property
    def max_curvature(self) -> float:
        """Largest curvature over the cable and all output times [1/m]; NaN without any."""
        found = self.statistics.get("max_curvature")
        # Logs that no run wrote, or that were cut, know the curvatures of their states only.
        known = (states.max_curvature for states in self.shapes.values())
        return max(known) if found is None else float(found)

    @property
    def wall_time(self) -> float:
        """Computing time of the run [s]; NaN when not known."""
        return float(self.statistics.get("wall_time", math.nan))

    def parts_judged(self) -> list[PartOfRun]:
        """What a run with ``solver.error_estimate`` has errors of: the line, or of a system its
        lines and bodies."""
        pulls = self.tension_min, self.tension_max, self.top_tension
        errors = self["position_error"], self["tension_error"]
        return [PartOfRun("", self["line_length"], *errors, pulls)]

    @cached_property
    def error_estimate(self) -> ErrorEstimate | None:
        """What the run says of its own errors: whether it keeps what its tolerance promises, from
        when on it does not. None unless the scene has ``solver.error_estimate``, and of a run
        without outputs."""
        if not self.scene.solver.error_estimate or not len(self.time):
            return None
        return ErrorEstimate.of(self)

    def summary(self) -> dict[str, Any]:
        """What ``cablemodel run --json`` prints: the end of the run and its extremes.

        ``time`` [s], ``top_tension`` [N] and ``tip_position`` [m] are those at the end;
        ``min_tension``, ``max_tension`` [N] and ``max_curvature`` [1/m] the extremes over the cable
        and all output times; ``slack_time``, ``slack_longest`` [s], ``slack_start`` and
        ``slack_end`` [m] say for how long and where some of it was slack; ``wall_time`` [s],
        ``steps``, ``rejected``, ``factorisations``, ``elements`` are of the solver. With
        ``solver.error_estimate`` also the ``tolerance``, the ``accuracy`` that is asked for,
        ``position_error`` [m], ``tension_error`` [N], the largest at any output while they are
        promised, and ``error_share`` of what is allowed, the larger one's. None where a value is
        not known or not finite.
        """
        if len(self.time):
            found: dict[str, Any] = {
                "time": float(self.time[-1]),
                "top_tension": float(self.top_tension[-1]),
                "tip_position": [_finite(value) for value in self.tip_position[-1]],
                "min_tension": float(np.min(self.tension_min)),
                "max_tension": float(np.max(self["tension_max"])),
                **{key: self._at_end(key) for key in SLACK},
                "max_curvature": self.max_curvature,
            }
        else:
            names = (
                "time", "top_tension", "tip_position", "min_tension", "max_tension", *SLACK,
                "max_curvature",
            )  # fmt: skip
            found = dict.fromkeys(names)
        for name in ("wall_time", "steps", "rejected", "factorisations", "elements"):
            found[name] = self.statistics.get(name)
        found |= self._error_summary()
        return {key: _finite(value) for key, value in found.items()}

    def _at_end(self, name: str) -> float | None:
        """An output at the end; None where it is not finite, or not in a log of before it was."""
        found: float | None = _finite(float(self[name][-1])) if name in self.names else None
        return found

    def _error_summary(self) -> dict[str, Any]:
        """What a summary says of errors, where they are estimated."""
        estimate = self.error_estimate
        if estimate is None:
            return {}
        known = estimate.unknown_from is None
        return {
            "tolerance": self.scene.solver.tolerance,
            "accuracy": self.scene.solver.promised,
            "position_error": estimate.position.largest if known else None,
            "tension_error": estimate.tension.largest if known else None,
            "error_share": estimate.share,
        }

    def to_xarray(self) -> xarray.Dataset:
        """Everything in the run as an :class:`xarray.Dataset` with units and descriptions.

        See :func:`cablemodel.results.dataset.dataset`. States whose number of nodes changes are at
        evenly spaced stations (see :class:`~cablemodel.results.states.States`).

        Raises:
            CableModelError: xarray is not installed.
        """
        from cablemodel.results.dataset import dataset

        return dataset(self)


class SystemRun(Run):
    """Results of a system over time: ``run["port.start_tension"]`` (n,), ``run["plate.position"]``
    (n, 3), ``run["tug.force"]``; the states of each line are ``run.lines["port"]``.
    """

    scene: SystemScene  # type: ignore[assignment]

    @property
    def states(self) -> States:
        """There are those of every line: `lines`.

        Raises:
            AttributeError: always.
        """
        raise AttributeError(f"a system has states of each line: lines[{next(iter(self.lines))!r}]")

    @property
    def lines(self) -> dict[str, States]:
        """Shape, tension, ... along each line by its name; see `Run.states`."""
        return self.shapes

    @cached_property
    def shapes(self) -> dict[str, States]:
        return {
            name: states.in_water(Surroundings.of_line(self.scene, name))
            for name, states in self._source.shapes().items()
        }

    @property
    def top_tension(self) -> Floats:
        """The largest tension at the beginning of a line (n,) [N]."""
        return self._over_lines("start_tension", np.max)

    @property
    def tension_min(self) -> Floats:
        """Lowest tension of all lines (n,) [N]."""
        return self._over_lines("tension_min", np.min)

    @property
    def tension_max(self) -> Floats:
        """Highest tension of all lines (n,) [N]."""
        return self._over_lines("tension_max", np.max)

    def _over_lines(self, name: str, extreme: Callable[..., Any]) -> Floats:
        values = [self[f"{line}.{name}"] for line in self.scene.lines]
        return np.asarray(extreme(values, axis=0), dtype=np.float64)

    def line_lengths(self) -> dict[str, Floats]:
        """Unstretched lengths over time of all lines by name (n,) [m], with what winches paid
        out."""
        found = {
            name: np.full(len(self.time), line.length) for name, line in self.scene.lines.items()
        }
        for name, winch in self.scene.winches.items():
            found[winch.line] = self[f"{name}.line_length"]
        return found

    def parts_judged(self) -> list[PartOfRun]:
        lengths = self.line_lengths()
        parts = []
        for name in self.scene.lines:
            keys = "tension_min", "tension_max", "start_tension", "end_tension"
            errors = self[f"{name}.position_error"], self[f"{name}.tension_error"]
            pulls = tuple(self[f"{name}.{key}"] for key in keys)
            parts.append(PartOfRun(name, lengths[name], *errors, pulls))
        for name in self.scene.bodies:
            longest = np.max([lengths[line] for line in self.scene.lines_at(name)], axis=0)
            parts.append(PartOfRun(name, longest, self[f"{name}.position_error"]))
        return parts

    def summary(self) -> dict[str, Any]:
        """What ``cablemodel run --json`` prints: the time, and for every line ``tension_min`` and
        ``tension_max`` of the run [N], what one line says of being slack, tensions at its ends;
        for every body its ``position`` [m] and ``attitude`` [rad], for every vessel ``force`` [N]
        and ``moment`` [N m], all at the end. The rest is as of one line; errors are those of the
        part with the largest share, and every line and body has its own ``position_error`` [m],
        every line its ``tension_error`` [N]."""
        ended = len(self.time) > 0
        found: dict[str, Any] = {"time": float(self.time[-1]) if ended else None}
        found["lines"], found["bodies"], found["vessels"] = {}, {}, {}
        if ended:
            for name in self.scene.lines:
                found["lines"][name] = {
                    "start_tension": _finite(self[f"{name}.start_tension"][-1]),
                    "end_tension": _finite(self[f"{name}.end_tension"][-1]),
                    "tension_min": _finite(np.min(self[f"{name}.tension_min"])),
                    "tension_max": _finite(np.max(self[f"{name}.tension_max"])),
                    **{key: self._at_end(f"{name}.{key}") for key in SLACK},
                }
            for kind, keys in (("bodies", ("position", "attitude")), ("vessels", _WRENCH)):
                for name in getattr(self.scene, kind):
                    values = {key: self[f"{name}.{key}"][-1] for key in keys}
                    found[kind][name] = {k: [_finite(x) for x in v] for k, v in values.items()}
        found["max_curvature"] = _finite(self.max_curvature)
        for name in ("wall_time", "steps", "rejected", "factorisations", "elements"):
            found[name] = _finite(self.statistics.get(name))
        found |= {name: _finite(value) for name, value in self._error_summary().items()}
        if (estimate := self.error_estimate) is not None and estimate.unknown_from is None:
            for part in estimate.parts:
                own = found["lines" if part.name in self.scene.lines else "bodies"][part.name]
                own["position_error"] = _finite(part.position.largest)
                if part.name in self.scene.lines:
                    own["tension_error"] = _finite(part.tension.largest)
        return found


_WRENCH = ("force", "moment")
SLACK = ("slack_time", "slack_longest", "slack_start", "slack_end")


def run_of(scene: Scene | SystemScene, source: Source, **about: Any) -> Run:
    """A run of one line or of a system; ``about`` as for `Run`."""
    kind = SystemRun if variables.is_system(scene) else Run
    return kind(scene, source, **about)  # type: ignore[arg-type]


def _finite(value: Any) -> Any:
    """NumPy's numbers as Python's, and None for what JSON has no number for."""
    value = value.item() if isinstance(value, np.generic) else value
    return None if isinstance(value, float) and not math.isfinite(value) else value


def open_run(path: str | PathLike[str]) -> Run:
    """Read a run from its log.

    A log that was cut off gives everything before its last flush; ``run.complete`` is then False
    and ``run.reason`` says why. Values are those that were computed, to the last bit.

    Raises:
        LogError: no log of this project, damaged, or of another version.
    """
    from cablemodel.results.log.reader import LogFile
    from cablemodel.results.log.source import source_of
    from cablemodel.systems import read_scene

    log = LogFile(path)
    try:
        scene = read_scene(log.scene_text)
    except SceneError as error:
        raise LogError(f"{path}: this version cannot read the scene in the log: {error}") from error
    run = run_of(
        scene,
        source_of(log, scene),
        statistics=log.statistics,
        complete=log.complete,
        reason=log.reason,
        metadata=log.metadata,
    )
    run.snapshot = log.snapshot
    return run
