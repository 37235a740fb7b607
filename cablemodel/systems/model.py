"""The stepping model of a system: lines, bodies and vessels by the user's names."""

from __future__ import annotations

import copy
import math
import warnings
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass
from os import PathLike
from typing import TYPE_CHECKING, Any, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cablemodel.errors import (
    CableModelError,
    SceneError,
    StaticsError,
    StepError,
    UnstableStartWarning,
)
from cablemodel.model import NO_INPUTS, WINCH_LIMITS, CableState
from cablemodel.scene import Scene
from cablemodel.scene.load import SceneSource, is_system, loaded, read_content
from cablemodel.scene.wall_tension import Surroundings
from cablemodel.solvers.finite_element.failures import MEANING
from cablemodel.solvers.protocol import Errors, images_of
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header, Winch
from cablemodel.systems.build import build
from cablemodel.systems.inputs import InputNames, SystemInputs, names_of
from cablemodel.systems.scene import SystemScene
from cablemodel.systems.stability import warn_if_unstable

if TYPE_CHECKING:
    from cablemodel.linear.model import LinearModel
from cablemodel.solvers.shared.numbers import RELATIVE_ROUNDING, SAME_PLACE

FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Motion:
    """How a vessel or body moves; SI units, earth frame."""

    position: FloatArray
    """Of its origin (3,) [m]."""
    velocity: FloatArray
    """(3,) [m/s]."""
    acceleration: FloatArray
    """(3,) [m/s2]."""
    axes: FloatArray
    """Its x, y and z axes in the columns (3, 3)."""
    angular_velocity: FloatArray
    """(3,) [rad/s]."""
    angular_acceleration: FloatArray
    """(3,) [rad/s2]."""
    attitude: FloatArray
    """Roll, pitch and yaw (3,) [rad]."""


@dataclass(frozen=True)
class WinchState:
    """What a winch does, and has done."""

    payout_rate: float
    """Applied, positive out [m/s]; differs from the command where it is at a limit."""
    line_length: float
    """Unstretched length of its line [m]."""
    drum_length: float
    """Cable on the drum [m]."""
    limit: str
    """``free``, ``drum empty`` or ``shortest length``."""


@dataclass(frozen=True)
class Slack:
    """For how long some of a line has been slack so far, and where; see `CableModel.slack_time`."""

    time: float
    """[s]"""
    longest: float
    """The longest spell [s]."""
    since: float
    """When the last spell began [s]; not a number: none has yet."""
    start: float
    """Arc length from the line's beginning where what has been slack so far begins [m]; not a
    number: nothing has."""
    end: float
    """Where that ends [m]."""


@dataclass(frozen=True)
class OnFloor:
    """What the sea floor does to a line; see the properties of `CableModel` of these names."""

    touchdown_position: FloatArray
    """(3,) [m]; not numbers: it touches nowhere."""
    touchdown_reaction: float
    """[N]"""
    floor_force: FloatArray
    """(3,) [N], earth frame."""
    floor_length: float
    """[m]"""


class LineView:
    """One line of a model, by its name."""

    def __init__(self, model: SystemModel, name: str) -> None:
        self._model, self.name = model, name
        self._water = Surroundings.of_line(model.scene, name)
        self._joints = np.array(model.scene.joints_along(name))

    @property
    def length(self) -> float:
        """Unstretched [m]: with what winches have paid out."""
        before, after = self._model.built.paid(self.name)
        return self._model.scene.lines[self.name].length + before + after

    def sample(self, stations: ArrayLike | None = None) -> CableState:
        """The line at arc lengths from its beginning (n,) [m]; by default at its nodes, with both
        sides of where it is cut, branches, bears a body or goes on as another cable.

        Raises:
            ValueError: a station is not on the line.
        """
        elements = self._model.built.elements(self.name)
        length, before = self.length, self._model.built.paid(self.name)[0]
        if stations is None:
            # Halves of elements that go back along a line begin at 0 to rounding.
            s = np.clip(np.append(elements.start, length), 0.0, length)
        else:
            s = np.atleast_1d(np.asarray(stations, dtype=np.float64))
        if not np.all((s >= 0.0) & (s <= length * (1.0 + RELATIVE_ROUNDING))):
            wrong = s[~((s >= 0.0) & (s <= length * (1.0 + RELATIVE_ROUNDING)))][0]
            raise ValueError(f"s = {wrong:g} m is not on {self.name}; allowed: 0 to {length:g} m")
        which = np.clip(np.searchsorted(elements.start, s, side="right") - 1, 0, None)
        if stations is None:
            gaps = np.abs(elements.start[:, None] - before - self._joints)
            sides = 1 + np.flatnonzero(np.any(gaps[1:] <= SAME_PLACE * length, axis=1))
            s = np.insert(s, sides, s[sides])
            which = np.insert(which, sides, sides - 1)
        x = np.clip((s - elements.start[which]) / elements.length[which], 0.0, 1.0)
        backward = elements.backward[which]
        x = np.where(backward, 1.0 - x, x)
        rows = self._model.sample_elements(elements.node[which].astype(np.float64), x)
        sign = np.where(backward, -1.0, 1.0)[:, None]
        return CableState(
            time=self._model.time,
            s=s,
            position=rows[:, at.Station.position.span],
            tangent=sign * rows[:, at.Station.tangent.span],
            velocity=rows[:, at.Station.velocity.span],
            tension=rows[:, at.Station.tension],
            curvature=rows[:, at.Station.curvature],
            bending_moment=rows[:, at.Station.bending_moment],
            on_floor=rows[:, at.Station.on_floor] != 0.0,
            water=(self._water, self._model.scene.lines[self.name].length + before),
        )

    @property
    def tension_range(self) -> tuple[float, float]:
        """Lowest and highest tension anywhere in it [N]."""
        from cablemodel.solvers import library as entry

        nodes = self._model.built.elements(self.name).node.astype(np.float64)
        ranges = np.zeros(2 * len(nodes))
        block = self._model.built.block
        entry.tension_ranges(block.ints, block.reals, nodes, ranges)
        return float(ranges[::2].min()), float(ranges[1::2].max())

    @property
    def slack(self) -> Slack:
        """For how long some of it has been slack so far, and where."""
        row = self._model.built.line_rows[self.name]
        return Slack(*map(float, (row.total, row.longest, row.since, row.first, row.last)))

    @property
    def on_floor(self) -> OnFloor:
        """How it lies on the sea floor.

        The touchdown point is the one nearest to its beginning; of a line that begins at an anchor,
        or on the floor, and ends above it, the one nearest to its end.
        """
        from cablemodel.solvers import library as entry

        nodes = self._model.built.elements(self.name).node.astype(np.float64)
        words, block = np.zeros(at.SUMMARY_WORDS), self._model.built.block
        entry.floor_of_line(block.ints, block.reals, nodes, words)
        found = at.Summary(words)
        return OnFloor(
            touchdown_position=found.touchdown_position.copy(),
            touchdown_reaction=float(found.touchdown_reaction),
            floor_force=found.floor_force.copy(),
            floor_length=float(found.floor_length),
        )

    @property
    def start_tension(self) -> float:
        """Along the line at its beginning [N]."""
        return float(self.sample([0.0]).tension[0])

    @property
    def end_tension(self) -> float:
        """Along the line at its end [N]."""
        return float(self.sample([self.length]).tension[0])


class SystemModel:
    """Lines between vessels, bodies and anchors, at the scene's initial state until it is stepped.

    ``lines``, ``bodies`` and ``vessels`` are by the names of the scene. Copies go on by themselves.

    Args:
        scene: what to simulate, or what `load_system` takes.

    Raises:
        SceneError: a scene that is wrong, or asks for what is not computed.
        StaticsError: no equilibrium was found for its start.
    """

    def __init__(self, scene: SystemScene | str | PathLike[str] | Mapping[str, Any]) -> None:
        self.scene = scene if isinstance(scene, SystemScene) else load_system(scene)
        self.built = build(self.scene)
        self._initial = self.built.block.image.copy()
        self.lines = {name: LineView(self, name) for name in self.scene.lines}
        self._inputs = InputNames(self.scene)
        self._forces = np.zeros((len(self.scene.bodies), 6))
        self._angles = self._inputs.first_angles.copy()
        self._left_alone = False  # whether a step is known to need nothing but its end
        self._motions = self._new_motions()
        self._moments = self._motions
        self._finer = _finer_model(self.scene) if self.scene.solver.error_estimate else None
        self._errors: dict[str, Errors] | None = None

    def __repr__(self) -> str:
        title = self.scene.title or "untitled"
        return f"<SystemModel of {title!r} at t = {self.time:g} s>"

    def __copy__(self) -> SystemModel:
        return copy.deepcopy(self)

    @property
    def time(self) -> float:
        """[s]."""
        return float(self.built.block.scalars.time)

    def step(self, dt: float, **inputs: Unpack[SystemInputs]) -> None:
        """Advance by dt [s], of any length.

        An input is the value reached at the end of the step; what is not given follows the scene.

        Args:
            vessels: a `VesselInput` by the name of a vessel or driven end.
            forces: outside force and torque about the origin (6,) [N, N m], earth frame, by the
                name of a body; one that is not named has none.
            deflections: of foils, by ``BODY.FOIL`` [rad]; those not named stay.
            rates: of winches, by name, positive out [m/s].
            cuts: names of those that are made now, at the beginning of the step.

        Raises:
            StepError: an input is wrong, or no step could be made; the model is as it was.
        """
        self.step_to(self.time + float(dt), **inputs)

    def step_to(self, time: float, **inputs: Unpack[SystemInputs]) -> None:
        """Advance to a time [s] exactly; otherwise like `step`.

        Warns:
            UnstableStartWarning: where a vessel's motion has become another one, foils feed what
                leaves it.
        """
        end = float(time)
        if not self.time < end < math.inf or end - self.time > at.LONGEST_STEP:
            advice = f"give a positive step of at most {at.LONGEST_STEP:g} s"
            raise StepError(f"dt is {end - self.time!r}", time=self.time, advice=advice)
        from cablemodel.solvers import library as entry

        if "cuts" in inputs:
            inputs["cuts"] = names_of(inputs["cuts"])  # whatever it is, it is asked for twice
        block, beside = self.built.block, self._beside
        before = None  # a step that fails gives the state back, but not what drives it
        forces, angles = self._forces, self._angles
        if inputs or not self._left_alone:
            drive = self._inputs.drive(inputs, self._angles, self.time)
            forces, angles = drive.forces, drive.angles
            pushed = drive.forces.any() or self._forces.any()
            given = any(inputs.get(key) for key in ("vessels", "deflections", "rates"))
            self._left_alone = not (given or self._drives(block) or pushed or drive.orders.any())
            if not self._left_alone:
                before = block.image.copy()
                entry.drive(block.ints, block.reals, end, *drive.arrays)
        status = int(entry.step(block.ints, block.reals, end, NO_INPUTS))
        while status == at.NO_CAPACITY:
            block.grow()
            status = int(entry.step(block.ints, block.reals, end, NO_INPUTS))
        if status != at.OK:
            part, arc = self.built.where(min(block.failed_node, self.built.nodes - 1))
            if before is not None:
                block.take(before)
            problem, advice = MEANING[status]
            raise StepError(f"{part}: {problem}", time=self.time, arc_length=arc, advice=advice)
        self._forces, self._angles, self._errors = forces, angles, None
        if self._moments and self._moments[0] <= self.time:
            unstable = warn_if_unstable(self.built)
            self._moments = [t for t in self._moments if t > self.time and not unstable]
        if beside is not None:
            with suppress(StepError):  # it stays behind for good: there is no estimate then
                beside.step_to(end, **inputs)

    def _new_motions(self) -> list[float]:
        """When a piece of a vessel's motion is over [s], in a system with foils, which may feed at
        another speed what they damped; none after a start that has been warned of."""
        if self.built.unstable or not any(body.foils for body in self.scene.bodies.values()):
            return []
        ends = [vessel.motion().pieces[:, at.Piece.end] for vessel in self.scene.vessels.values()]
        return sorted({float(end) for each in ends for end in each if 0.0 < end < math.inf})

    def _drives(self, block: Any) -> bool:
        rows = block.array(Header.frames, len(self.scene.vessels), at.FRAME_WORDS)
        live = rows[:, [at.Frame.live.word, at.Frame.turn_live.word]] != at.LIVE_NOT
        return bool(np.any(live)) or any(winch.live != at.LIVE_NOT for winch in self._winches())

    def _winches(self) -> list[Winch]:
        return [self.built.winch(number) for number in range(len(self.scene.winches))]

    @property
    def winches(self) -> dict[str, WinchState]:
        """What each winch has done, by name."""
        return {
            name: WinchState(
                payout_rate=float(row.rate),
                line_length=self.lines[winch.line].length,
                drum_length=float(row.paid_most - row.paid),
                limit=WINCH_LIMITS[int(row.at_limit)],
            )
            for (name, winch), row in zip(self.scene.winches.items(), self._winches(), strict=True)
        }

    @property
    def cuts(self) -> dict[str, float | None]:
        """When each cut was made [s], by name; None: not yet."""
        rows = self.built.block.array(Header.cuts, len(self.scene.cuts), at.CUT_WORDS)
        done = rows[:, at.Cut.done].tolist()
        return {
            name: time if time < math.inf else None
            for name, time in zip(self.scene.cuts, done, strict=True)
        }

    @property
    def deflections(self) -> dict[str, float]:
        """Of foils, by ``BODY.FOIL`` [rad]."""
        return dict(zip(self._inputs.foils, self._angles.tolist(), strict=True))

    def _parts(self) -> tuple[FloatArray, FloatArray]:
        from cablemodel.solvers import library as entry

        block = self.built.block
        bodies = np.zeros((len(self.scene.bodies), at.PART_WORDS))
        frames = np.zeros((len(self.scene.vessels), at.PART_WORDS))
        entry.parts(block.ints, block.reals, bodies.ravel(), frames.ravel())
        return bodies, frames

    @property
    def bodies(self) -> dict[str, Motion]:
        """Motion of the free bodies by name."""
        motions = self.motions
        return {name: motions[name] for name in self.scene.bodies}

    @property
    def vessels(self) -> dict[str, Motion]:
        """Motion of vessels and driven ends by name."""
        motions = self.motions
        return {name: motions[name] for name in self.scene.vessels}

    @property
    def motions(self) -> dict[str, Motion]:
        """Motion of vessels, driven ends and free bodies by name."""
        bodies, frames = self._parts()
        names = *self.scene.vessels, *self.scene.bodies
        rows = *frames, *bodies
        return {name: _motion(row) for name, row in zip(names, rows, strict=True)}

    @property
    def finer(self) -> SystemModel | None:
        """The run that errors are estimated by; None where they are not, or it has no start."""
        return self._finer

    @property
    def _beside(self) -> SystemModel | None:
        """The finer run, if it stands where this one does."""
        other = self._finer
        return None if other is None or other.time != self.time else other

    @property
    def errors(self) -> dict[str, Errors]:
        """What lines and bodies are estimated to be wrong by, by name; see
        `CableModel.position_error`.

        Of a line the largest distance anywhere along it, and the larger one of the tensions at its
        ends; of a body that of its origin. Not numbers once the finer run could not make a step.

        Raises:
            CableModelError: the scene does not ask for it.
        """
        if not self.scene.solver.error_estimate:
            raise CableModelError(
                "errors are not estimated: load the scene with solver.error_estimate: true"
            )
        if self._errors is None:
            self._errors = dict(self._estimates())
        return self._errors

    def _estimates(self) -> Iterator[tuple[str, Errors]]:
        from cablemodel.solvers.estimating import FACTOR, PLACES, estimated

        other = self._beside
        for name, line in self.lines.items():
            found = math.nan, math.nan
            if other is not None:
                length, ends = min(line.length, other.lines[name].length), [0, -1]
                one, two = (each.lines[name].sample(PLACES * length) for each in (self, other))
                found = estimated(one.position, two.position, one.tension[ends], two.tension[ends])
            yield name, Errors(*found, line.length)
        finer = {} if other is None else other.bodies
        for name, body in self.bodies.items():
            off = math.nan
            if name in finer:
                difference = body.position - finer[name].position
                # Of one row, whose squares are added in order, as in the FMU.
                off = FACTOR * float(np.linalg.norm(difference[None], axis=1)[0])
            longest = max(self.lines[line].length for line in self.scene.lines_at(name))
            yield name, Errors(off, None, longest)

    @property
    def top_tension(self) -> float:
        """The largest tension at the beginning of a line [N]."""
        return max(line.start_tension for line in self.lines.values())

    def linearise(self) -> LinearModel:
        """A linear model about the present state, with named states, inputs and outputs; see
        `CableModel.linearise`.

        Inputs are the rates of what `step` takes, and of the current; what only one vessel holds is
        counted from there. Bodies turn about their own axes.

        Raises:
            CableModelError: something is not linear, by name: contact with the floor, waves, a
                slack line without bending stiffness, a cut that has been made.
        """
        from cablemodel.systems.linear import linear_model

        return linear_model(self)

    def small_motions(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Mass, damping and stiffness of small motions about the present state, (n, n) each.

        Over the free unknowns of all lines and bodies, as `CableModel.small_motions`; bodies turn
        by rotation vectors [rad], and what closes a cycle is taken into account.
        """
        from cablemodel.solvers.finite_element.linearisation import small_motions

        return small_motions(self.built.block)

    def natural_frequencies(self, count: int = 5) -> FloatArray:
        """The lowest natural frequencies about the present state [rad/s], (count,); see
        `CableModel.natural_frequencies`. A body that turns freely has a frequency of 0."""
        from cablemodel.solvers.finite_element.linearisation import natural_frequencies

        return natural_frequencies(self.built.block, count)

    @property
    def statistics(self) -> dict[str, int]:
        """Counters since the start: steps, rejected, factorisations, iterations; elements."""
        ints = self.built.block.ints
        head = Header(ints)
        return {
            "steps": int(head.steps),
            "rejected": int(head.rejected),
            "factorisations": int(head.factorisations),
            "iterations": int(head.iterations),
            "elements": len(self.built.elements().node),
        }

    def shapes(self) -> dict[str, CableState]:
        """All lines at their nodes, by name."""
        return {name: line.sample() for name, line in self.lines.items()}

    def outputs(self, shapes: Mapping[str, CableState] | None = None) -> dict[str, FloatArray]:
        """Everything that a run keeps over time, by the names of the table of variables:
        ``port.start_tension``, ``plate.position``, ``tug.force``, ...

        shapes: of `shapes`, if the caller has them.
        """
        found: dict[str, FloatArray] = {}
        for name, state in (shapes or self.shapes()).items():
            tension = state.tension
            found[f"{name}.start_tension"], found[f"{name}.end_tension"] = tension[[0, -1]]
            lowest, highest = self.lines[name].tension_range
            found[f"{name}.tension_min"] = np.array(lowest)
            found[f"{name}.tension_max"] = np.array(highest)
            for key, value in asdict(self.lines[name].slack).items():
                found[f"{name}.slack_{key}"] = np.array(value)
        bodies, frames = self._parts()
        for names, rows in ((self.scene.bodies, bodies), (self.scene.vessels, frames)):
            for name, row in zip(names, rows, strict=True):
                motion = _motion(row)
                for key in ("position", "attitude", "velocity", "angular_velocity"):
                    found[f"{name}.{key}"] = getattr(motion, key)
        for name, row in zip(self.scene.vessels, frames, strict=True):
            found[f"{name}.force"], found[f"{name}.moment"] = np.split(_wrench(row), 2)
        for name, winch in self.winches.items():
            for key in ("payout_rate", "line_length", "drum_length"):
                found[f"{name}.{key}"] = np.array(getattr(winch, key))
        for name, time in self.cuts.items():
            found[f"{name}.time"] = np.array(np.nan if time is None else time)
        if self.scene.environment.floor is not None:
            for name, line in self.lines.items():
                for key, value in asdict(line.on_floor).items():
                    found[f"{name}.{key}"] = np.array(value)
        if self.scene.solver.error_estimate:
            for name, errors in self.errors.items():
                found[f"{name}.position_error"] = np.array(errors.position)
                if errors.tension is not None:
                    found[f"{name}.tension_error"] = np.array(errors.tension)
        return found

    def input_row(self, step: float, given: Mapping[str, Any]) -> FloatArray:
        """What a step was given, in the order of ``variables.input_labels``.

        Args:
            step: its length [s].
            given: arguments of `step_to`, by name.
        """
        row = [np.array([self.time, step]), *self._inputs.row(given)]
        return np.concatenate(row)

    def given_by(self, row: FloatArray) -> SystemInputs:
        """The arguments of `step_to` that made a row of `input_row`."""
        return self._inputs.given_by(row[2:])

    @property
    def wrenches(self) -> dict[str, FloatArray]:
        """Force and moment about its origin (6,) [N, N m] of all lines on each vessel, earth
        frame."""
        frames = self._parts()[1]
        return {name: _wrench(row) for name, row in zip(self.scene.vessels, frames, strict=True)}

    def sample_elements(self, elements: FloatArray, fractions: FloatArray) -> FloatArray:
        """Rows of STATION_WORDS at fractions of elements, by the numbers of their nodes."""
        from cablemodel.solvers import library as entry

        out = np.zeros((len(elements), at.STATION_WORDS))
        block = self.built.block
        entry.sample_elements(
            block.ints,
            block.reals,
            np.ascontiguousarray(elements),
            np.ascontiguousarray(fractions),
            out.reshape(-1),
        )
        return out

    @property
    def _runs(self) -> list[SystemModel]:
        """This one, and the finer one that its errors are estimated by."""
        return [self] if self._finer is None else [self, self._finer]

    def snapshot(self) -> bytes:
        """The whole state: a model of the same scene that restores it goes on bit by bit."""
        runs = self._runs
        images = [run.built.block.image.tobytes() for run in runs]
        driven = [part.tobytes() for run in runs for part in (run._forces, run._angles)]
        return b"".join(images + driven)

    def restore(self, snapshot: bytes) -> None:
        """Take over a snapshot of a model of the same scene.

        Raises:
            SceneError: it belongs to another scene; the model is as it was.
        """
        runs = self._runs
        split = len(snapshot) - 8 * len(runs) * (self._forces.size + self._angles.size)
        images = images_of(snapshot[: max(split, 0)], [run.built.block for run in runs])
        if not images:
            raise SceneError.at(
                "snapshot", len(snapshot), "it belongs to another scene", "one of this scene"
            )
        driven = np.frombuffer(snapshot[split:], dtype=np.float64).reshape(len(runs), -1)
        for run, image, words in zip(runs, images, driven, strict=True):
            run.built.block.take(image)
            forces, run._angles = np.split(words.copy(), [run._forces.size])
            run._forces = forces.reshape(run._forces.shape)
            run._left_alone, run._errors = False, None

    def reset(self) -> None:
        """Back to the initial state, t = 0."""
        for run in self._runs:
            run.built.block.take(run._initial)
            run._forces[:] = 0.0
            run._moments = run._motions
            run._angles = run._inputs.first_angles.copy()
            run._left_alone, run._errors = False, None


def _finer_model(scene: SystemScene) -> SystemModel | None:
    """The system at a quarter of its tolerance, to estimate errors by; None: it has no start."""
    from cablemodel.solvers.estimating import finer, step_in_halves

    with suppress(StaticsError), warnings.catch_warnings():
        warnings.simplefilter("ignore", UnstableStartWarning)  # which the run itself gives
        model = SystemModel(finer(scene))
        model._motions = model._moments = []
        step_in_halves(model.built.block)
        model._initial = model.built.block.image.copy()
        return model
    return None


def _wrench(row: FloatArray) -> FloatArray:
    """Force and moment of a vessel, by the words of its PartMotion."""
    return at.PartMotion(row).wrench.copy()


def _motion(row: FloatArray) -> Motion:
    found = at.PartMotion(row.copy())
    return Motion(
        position=found.position,
        velocity=found.velocity,
        acceleration=found.acceleration,
        axes=found.axes.reshape(3, 3),
        angular_velocity=found.angular_velocity,
        angular_acceleration=found.angular_acceleration,
        attitude=found.attitude,
    )


def load_system(
    source: str | PathLike[str] | Mapping[str, Any], overrides: Any = ()
) -> SystemScene:
    """Read and check the scene of a system: a file, YAML text, or a mapping.

    Raises:
        SceneError: naming every problem with its path, its value and what is allowed.
    """
    content = read_content(source)
    if "line" in content[2] and "lines" not in content[2]:
        problem = "a scene of one line, from a vessel outwards, is no system"
        error = SceneError.at("line", None, problem, "lines by name; load_scene and CableModel")
        error.source = content[1] or ""
        raise error
    return loaded(SystemScene, content, overrides)


def read_scene(
    source: Scene | SystemScene | SceneSource,
    overrides: str | Iterable[str] = (),
    folder: str | PathLike[str] | None = None,
) -> Scene | SystemScene:
    """A scene of one line or of a system, as it is or read: a file, YAML text, or a mapping.

    overrides, folder: as of `load_scene`.

    Raises:
        SceneError: as `load_scene`, `load_system`.
    """
    if isinstance(source, (Scene, SystemScene)):
        return source
    content = read_content(source)
    if is_system(content[2]):
        return loaded(SystemScene, content, overrides, folder)
    return loaded(Scene, content, overrides, folder)
