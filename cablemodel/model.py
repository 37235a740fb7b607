"""The stepping model: a cable that is moved, step by step, by whoever calls it."""

from __future__ import annotations

import copy
import hashlib
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cablemodel.errors import CableModelError, SceneError, StepError
from cablemodel.solvers.choose import choose
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.protocol import Errors, images_of
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header, Scalars, Summary

if TYPE_CHECKING:
    from cablemodel.linear.model import LinearModel
    from cablemodel.linear.step_sensitivity import StepSensitivity
    from cablemodel.scene import Scene
    from cablemodel.scene.wall_tension import Surroundings

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]
BoolArray = NDArray[np.bool_]

_NO_NUMBERS = frozenset((str, bytes, bool, np.bool_, np.str_, np.bytes_))
"""What Python would make a number of, and nobody means as one."""
NO_INPUTS: FloatArray = np.zeros(at.INPUT_WORDS)
NO_INPUTS.flags.writeable = False
_TIME = Scalars.time.place
_VELOCITY = at.StepInputs.velocity_given.word
_POSITION = at.StepInputs.position_given.word
_CURRENT = at.StepInputs.current_given.word
_PAYOUT = at.StepInputs.payout_given.word
"""Words that say whether what follows them is given."""
WINCH_LIMITS = {0: "free", 1: "drum empty", -1: "shortest length"}
"""What clamps a winch's rate, by the words of its record."""


@dataclass(frozen=True)
class CableState:
    """The cable at one instant, at n arc lengths; SI units, earth frame (x east, y north, z up)."""

    time: float
    """[s]"""
    s: FloatArray
    """Unstretched arc length from the vessel (n,) [m]."""
    position: FloatArray
    """(n, 3) [m]."""
    tangent: FloatArray
    """Unit vector away from the vessel (n, 3)."""
    velocity: FloatArray
    """Of the material (n, 3) [m/s]."""
    tension: FloatArray
    """Effective tension (n,) [N]: that of the equations; see `wall_tension`."""
    curvature: FloatArray
    """|dt/ds| (n,) [1/m]."""
    bending_moment: FloatArray
    """EI times the curvature where bending is kept (n,) [N m]."""
    on_floor: BoolArray
    """(n,)."""
    water: tuple[Surroundings, float] | None = field(default=None, repr=False, compare=False)
    """What is around the line, and the line's length [m]."""

    @property
    def wall_tension(self) -> FloatArray:
        """What the cable's material carries (n,) [N]: effective tension less the pressure of the
        water around it times the unstretched cross-section; equal above the water.

        Raises:
            CableModelError: the state was made without its scene.
        """
        if self.water is None:
            raise CableModelError("wall_tension: this state does not know the water around it")
        around, length = self.water
        return self.tension - around.pressure_force(self.time, self.s, self.position, length)


@dataclass(frozen=True)
class Snapshot:
    """A model's whole state: what restore brings back bit by bit."""

    image: bytes = field(repr=False)
    scene: str = ""
    """Hash of the scene that it belongs to; empty where that is not known."""

    def __repr__(self) -> str:
        time = Scalars(np.frombuffer(self.image, dtype=np.float64)).time
        return f"<Snapshot at t = {time:g} s: {len(self.image)} bytes>"

    def __len__(self) -> int:
        return len(self.image)


@dataclass(frozen=True)
class BodyState:
    """A body on the cable."""

    name: str | None
    position: FloatArray
    """Of its centre of gravity (3,) [m]."""
    velocity: FloatArray
    """Of its centre of gravity (3,) [m/s]."""
    direction: FloatArray
    """Unit vector along its axis, away from the vessel (3,)."""


class CableModel:
    """A cable hung from a vessel, at the scene's initial state until it is stepped.

    Copies (``copy.deepcopy``, or by pickle to another process) go on by themselves, bit by bit
    like the original.

    Args:
        scene: what to simulate: a scene, or what `load_scene` takes.
        planar: False forces three dimensions where the scene lies in one vertical plane (the
            default, None, takes advantage of that).
        sleep: False keeps cable awake that friction holds at rest on the sea floor (the default,
            None, leaves it out of the steps until something moves it).

    Raises:
        SceneError: no scene, or one that asks for something that its solver does not support.
        StaticsError: no static equilibrium was found for its start.
    """

    def __init__(
        self,
        scene: Scene | str | PathLike[str] | Mapping[str, Any],
        *,
        planar: bool | None = None,
        sleep: bool | None = None,
    ) -> None:
        from cablemodel.scene.load import scene_of

        self.scene = scene = scene_of(scene)
        self._pinned = scene.vessel.connection.kind == "pinned"
        self._solver = choose(scene, planar=planar, sleep=sleep)
        self._initial = [memory.image.copy() for memory in self._solver.memories]
        self._inputs: FloatArray = np.zeros(at.INPUT_WORDS)
        self._summary: FloatArray = np.zeros(at.SUMMARY_WORDS)
        self._summary_by_name = Summary(self._summary)
        self._summary_current = False
        self._errors: tuple[float, float] | None = None

    def __repr__(self) -> str:
        title = self.scene.title or "untitled"
        return f"<CableModel of {title!r} at t = {self.time:g} s>"

    def __copy__(self) -> CableModel:
        # One that shared the state would show numbers that the other's steps have overtaken.
        return copy.deepcopy(self)

    @property
    def _ints(self) -> IntArray:
        return self._solver.memory.ints

    @property
    def _reals(self) -> FloatArray:
        return self._solver.memory.reals

    @property
    def _header(self) -> Header:
        return self._solver.memory.header

    @property
    def _scalars(self) -> Scalars:
        return self._solver.memory.scalars

    # -- stepping -------------------------------------------------------------------------------

    def step(
        self,
        dt: float,
        vessel_velocity: ArrayLike | None = None,
        vessel_position: ArrayLike | None = None,
        payout_rate: float | None = None,
        current: ArrayLike | None = None,
    ) -> None:
        """Advance by dt [s], of any length.

        An input is the value reached at the end of the step; it varies linearly from its present
        value. None: the scene's own schedule. A position with a velocity makes the motion the
        cubic that meets both; a position alone ends with the mean velocity of the step.

        Args:
            vessel_velocity: of the tow point (3,) [m/s].
            vessel_position: of the tow point (3,) [m].
            payout_rate: unstretched [m/s], positive out. It is clamped to zero where the drum is
                empty or the shortest length is reached; `payout_rate` and `winch` say so.
            current: water velocity (3,) [m/s], added to the scene's at every depth. Water that
                accelerates pushes: a change within a short step is a blow on the cable.

        Raises:
            StepError: an input is not finite or not allowed, or no step could be made; the model
                is as it was.
        """
        self.step_to(
            self.time + self._number("dt", dt),
            vessel_velocity,
            vessel_position,
            payout_rate,
            current,
        )

    def step_to(
        self,
        time: float,
        vessel_velocity: ArrayLike | None = None,
        vessel_position: ArrayLike | None = None,
        payout_rate: float | None = None,
        current: ArrayLike | None = None,
    ) -> None:
        """Advance to a time [s] exactly; otherwise like `step`."""
        end = time if type(time) is float else self._number("time", time)
        if not self.time < end < math.inf:
            self._number("time", end)
            raise StepError(
                f"a step must go forward in time, not by {end - self.time:g} s",
                time=self.time,
                advice="give a positive step",
            )
        if end - self.time > at.LONGEST_STEP:
            raise StepError(
                f"a step of {end - self.time:g} s is longer than any that is made",
                time=self.time,
                advice=f"give a step of at most {at.LONGEST_STEP:g} s",
            )
        inputs = NO_INPUTS
        if not (
            vessel_velocity is None
            and vessel_position is None
            and payout_rate is None
            and current is None
        ):
            inputs = self._inputs
            inputs[:] = 0.0
            self._take_vector(_VELOCITY, "vessel_velocity", vessel_velocity)
            self._take_vector(_POSITION, "vessel_position", vessel_position)
            self._take_vector(_CURRENT, "current", current)
            if payout_rate is not None:
                inputs[_PAYOUT + 1] = self._number("payout_rate", payout_rate)
                inputs[_PAYOUT] = 1.0
        solver = self._solver
        status = solver.step(end, inputs)
        self._summary_current, self._errors = False, None
        if status != at.OK:
            problem, advice = solver.explain(status)
            place = solver.failed_arc()
            raise StepError(problem, time=self.time, arc_length=place, advice=advice)

    def _number(self, name: str, value: Any) -> float:
        try:
            if type(value) in _NO_NUMBERS:
                raise TypeError
            number = float(value)
        except (TypeError, ValueError, OverflowError):
            raise StepError(
                f"{name} is {value!r}, not a number", time=self.time, advice="give a number"
            ) from None
        if not math.isfinite(number):
            raise StepError(
                f"{name} is {number}: not finite", time=self.time, advice="give a finite number"
            )
        return number

    def _take_vector(self, place: int, name: str, value: ArrayLike | None) -> None:
        if value is None:
            return
        try:
            vector = np.asarray(value)
            kind = vector.dtype.kind
            if kind != "f" or type(value) is not np.ndarray:
                # NumPy, too, would make numbers of text and truths.
                if kind not in "fiuO" or not _NO_NUMBERS.isdisjoint(map(type, value)):  # type: ignore[arg-type]
                    raise TypeError
                if kind != "f":
                    vector = vector.astype(np.float64)
        except (TypeError, ValueError, OverflowError):
            vector = np.empty(0)
        if vector.shape != (3,):
            raise StepError(
                f"{name} is {value!r}", time=self.time, advice="give three numbers (x, y, z)"
            )
        # One by one: of three numbers NumPy's own test takes several times as long.
        if not all(map(math.isfinite, vector.tolist())):
            raise StepError(
                f"{name} is {vector.tolist()}: not finite",
                time=self.time,
                advice="give finite numbers",
            )
        self._inputs[place] = 1.0
        self._inputs[place + 1 : place + 4] = vector

    def reset(self) -> None:
        """Back to the scene's initial state, t = 0."""
        for memory, initial in zip(self._solver.memories, self._initial, strict=True):
            memory.take(initial)
        self._summary_current, self._errors = False, None

    def snapshot(self) -> Snapshot:
        """The whole state: a model that restores it goes on bit by bit as this one does."""
        return Snapshot(
            b"".join(memory.image.tobytes() for memory in self._solver.memories), self._scene_hash
        )

    @cached_property
    def _scene_hash(self) -> str:
        """Of all that a snapshot brings along: the scene but for its title, start and outputs."""
        data = self.scene.to_dict()
        kept = {key: data[key] for key in data if key not in ("title", "initial", "run")}
        return hashlib.sha256(json.dumps(kept, sort_keys=True).encode()).hexdigest()

    def restore(self, snapshot: Snapshot) -> None:
        """Take over a snapshot of a model of the same scene.

        Title, start and run settings of the scene may differ; all else is part of a snapshot, the
        vessel's schedule too.

        Raises:
            SceneError: the snapshot does not belong to this scene; the model is as it was.
            TypeError: it is no snapshot.
        """
        if not isinstance(snapshot, Snapshot):
            kind = type(snapshot).__name__
            raise TypeError(f"restore needs what snapshot() gave (a Snapshot), not {kind}")
        if snapshot.scene and snapshot.scene != self._scene_hash:
            raise SceneError.at(
                "snapshot",
                repr(snapshot),
                "it belongs to another scene, of other values",
                "a snapshot of a model of the same scene",
            )
        own = self._solver.memories
        parts = images_of(snapshot.image, own)
        if not parts:
            raise SceneError.at(
                "snapshot",
                f"{len(snapshot.image)} bytes",
                "it belongs to another scene or version",
                f"a snapshot of {sum(memory.image.nbytes for memory in own)} bytes of this scene",
            )
        for memory, part in zip(own, parts, strict=True):
            memory.take(part)
        self._summary_current, self._errors = False, None

    # -- what the model says --------------------------------------------------------------------

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return float(self._solver.memory.reals[_TIME])

    def numbers(self) -> Summary:
        """The numbers below by name, in one record, for who wants many of them at every step.

        It is a view, which a later call changes.
        """
        if not self._summary_current:
            self._solver.summary(self._summary)
            self._summary_current = True
        return self._summary_by_name

    @property
    def top_force(self) -> FloatArray:
        """Force of the cable on the vessel (3,) [N]."""
        return self.numbers().wrench[:3].copy()

    @property
    def top_moment(self) -> FloatArray:
        """Moment of the cable on the vessel, where it is clamped (3,) [N m]."""
        if self._pinned:
            return np.zeros(3)
        return self.numbers().wrench[3:].copy()

    @property
    def top_tension(self) -> float:
        """Tension at the tow point, as a load cell there reads it, effective below water [N].

        The size of `top_force`, negative where the cable pushes. It differs from the axial
        tension, `sample(0).tension`, by the shear force of a cable that bends there.
        """
        return float(self.numbers().top_tension)

    @property
    def tension_min(self) -> float:
        """Lowest tension in the cable [N]."""
        return float(self.numbers().tension_min)

    @property
    def tension_max(self) -> float:
        """Highest tension in the cable [N]."""
        return float(self.numbers().tension_max)

    @property
    def slack_time(self) -> float:
        """For how long some of the cable has been slack so far [s].

        A spell begins as the lowest tension comes to 0, and is over as it comes to 2 % of the
        largest one at the start, or of the cable's weight in water, or to half of the lowest one at
        the start where that is less: what is folded pulls a little. A line with a free end is taut
        again from 0 on. Cable that the floor bears does not count. Every step is counted, whatever
        outputs are asked for.
        """
        return float(self.numbers().slack_time)

    @property
    def slack_longest(self) -> float:
        """The longest spell so far for which some of the cable was slack [s]."""
        return float(self.numbers().slack_longest)

    @property
    def slack_since(self) -> float:
        """When the last such spell began [s]; not a number: none has yet."""
        return float(self.numbers().slack_since)

    @property
    def slack_start(self) -> float:
        """Arc length where what has been without tension so far begins [m]; not a number: nothing
        has."""
        return float(self.numbers().slack_start)

    @property
    def slack_end(self) -> float:
        """Arc length where what has been without tension so far ends [m]; not a number: nothing
        has."""
        return float(self.numbers().slack_end)

    @property
    def tip_position(self) -> FloatArray:
        """Far end of the line (3,) [m]: the outer end of a body there, else the cable's."""
        return self.numbers().tip_position.copy()

    @property
    def tip_velocity(self) -> FloatArray:
        """Velocity of the far end (3,) [m/s]."""
        return self.numbers().tip_velocity.copy()

    @property
    def vessel_position(self) -> FloatArray:
        """Tow point (3,) [m]."""
        return self.numbers().vessel_position.copy()

    @property
    def vessel_velocity(self) -> FloatArray:
        """Velocity of the tow point (3,) [m/s]."""
        return self.numbers().vessel_velocity.copy()

    @property
    def line_length(self) -> float:
        """Unstretched length of cable that is out [m]."""
        return float(self.numbers().line_length)

    @property
    def drum_length(self) -> float:
        """Unstretched length of cable on the drum [m]."""
        return float(self.numbers().drum_length)

    @property
    def payout_rate(self) -> float:
        """Applied pay-out rate, unstretched [m/s]; differs from the command when clamped."""
        return float(self.numbers().payout_rate)

    @property
    def winch(self) -> str:
        """``free``, ``drum empty`` or ``shortest length``: what clamps the pay-out rate."""
        return WINCH_LIMITS[int(self._solver.memory.winch.at_limit)]

    @property
    def floor_force(self) -> FloatArray:
        """Total force of the sea floor on cable and bodies, friction included (3,) [N]."""
        return self.numbers().floor_force.copy()

    @property
    def floor_length(self) -> float:
        """Length of cable from the touchdown on that the sea floor bears [m].

        As a rigid floor would bear it: at rest within 0.05 touchdown layers (EI/w)^(1/3) where the
        bend there is resolved, else as it would bear a catenary, within tau L. In a run it wavers
        as the touchdown does.
        """
        return float(self.numbers().floor_length)

    @property
    def touchdown_position(self) -> FloatArray:
        """Touchdown point nearest the vessel (3,) [m]; not a number where no cable touches.

        Where cable would meet a rigid floor, about sqrt(EI/T) beyond a catenary's touchdown: at
        rest within 0.02 touchdown layers (EI/w)^(1/3) where the bend there is resolved, else that
        of the catenary, within tau L, or between the two. While cable lands it wavers: in 100 m of
        water by tau L at a tolerance of 1e-3, and by 0.15 m, 6 tau L, at 1e-4.
        Nothing does where the scene has no floor: its force, length and reaction are then zero.
        """
        if self.scene.environment.floor is None:
            return np.full(3, math.nan)
        return self.numbers().touchdown_position.copy()

    @property
    def touchdown_reaction(self) -> float:
        """Concentrated floor reaction at the touchdown point, that bending causes [N].

        What the floor bears beyond the cable's weight within four lengths (EI/w)^(1/3) of it.
        """
        return float(self.numbers().touchdown_reaction)

    @property
    def position_error(self) -> float:
        """What positions are estimated to be wrong by, the largest along the cable [m].

        The promise of a tolerance tau is tau times the line's length. The estimate is twice the
        distance of the cable from that of a run at tau/4, which a scene with
        ``solver.error_estimate`` makes beside this one. It stays not a number once that run could
        not make a step.

        Raises:
            CableModelError: the scene does not ask for it.
        """
        return self._estimate()[0]

    @property
    def tension_error(self) -> float:
        """What `top_tension` is estimated to be wrong by [N]; otherwise as `position_error`.

        The promise is 10 tau times the largest tension, while the line is taut.
        """
        return self._estimate()[1]

    @property
    def errors(self) -> dict[str, Errors]:
        """`position_error`, `tension_error` and the length that positions are promised as a part
        of, as of a system's parts: of the line, whose name is empty.

        Raises:
            CableModelError: the scene does not ask for it.
        """
        return {"": Errors(self.position_error, self.tension_error, self.line_length)}

    def _estimate(self) -> tuple[float, float]:
        found = self._errors or self._solver.errors()
        if found is None:
            raise CableModelError(
                "errors are not estimated: load the scene with solver.error_estimate: true"
            )
        self._errors = found
        return found

    @property
    def bodies(self) -> list[BodyState]:
        """The bodies that are out, from the vessel outwards."""
        return [
            BodyState(body.name, body.position, body.velocity, body.direction)
            for body in self._solver.bodies()
        ]

    @property
    def planar(self) -> bool:
        """Whether the cable is computed in a vertical plane."""
        return self._solver.planar

    @property
    def statistics(self) -> dict[str, int]:
        """Counters since the start: steps, rejected, factorisations, iterations; at present:
        elements, and how many of them are asleep on the floor."""
        return {
            "steps": int(self._header.steps),
            "rejected": int(self._header.rejected),
            "factorisations": int(self._header.factorisations),
            "iterations": int(self._header.iterations),
            "elements": self._solver.elements,
            "asleep": self._solver.asleep,
        }

    @property
    def applied_inputs(self) -> dict[str, Any]:
        """What drives the model at the present time: vessel motion, pay-out, live current."""
        found = self.numbers()
        return {
            "vessel_position": found.vessel_position.copy(),
            "vessel_velocity": found.vessel_velocity.copy(),
            "payout_rate": float(found.payout_rate),
            "current": self._scalars.live_current.last.copy(),
        }

    def state(self) -> CableState:
        """The cable at its nodes."""
        return self.sample(self._solver.node_arcs())

    def sample(self, s: ArrayLike) -> CableState:
        """The cable at any arc lengths s (n,) [m], 0 at the vessel.

        Raises:
            ValueError: an arc length lies outside the line; names it and the range.
        """
        stations = np.atleast_1d(np.array(s, dtype=np.float64))
        if stations.ndim != 1:
            raise ValueError(f"arc lengths must be one number or a list, not {stations.shape}")
        out = np.empty(at.STATION_WORDS * len(stations))
        self.sample_words(stations, out)
        rows = out.reshape(-1, at.STATION_WORDS)
        return CableState(
            time=self.time,
            s=stations,
            position=rows[:, at.Station.position.span].copy(),
            tangent=rows[:, at.Station.tangent.span].copy(),
            velocity=rows[:, at.Station.velocity.span].copy(),
            tension=rows[:, at.Station.tension].copy(),
            curvature=rows[:, at.Station.curvature].copy(),
            bending_moment=rows[:, at.Station.bending_moment].copy(),
            on_floor=rows[:, at.Station.on_floor] > 0.5,
            water=(
                self._surroundings,
                self._surroundings.length + float(self._solver.memory.winch.paid),
            ),
        )

    def sample_words(self, stations: FloatArray, out: FloatArray) -> None:
        """As `sample`, into memory of the caller's, for who asks at every step.

        Args:
            stations: arc lengths (n,) [m].
            out: words of a ``layout.Station`` for each of them, one after the other.
        """
        done = self._solver.sample(stations, out)
        if done != len(stations):
            raise ValueError(
                f"s = {stations[done]:g} m is not on the line; allowed: 0 to "
                f"{self.line_length:.12g} m"
            )

    @cached_property
    def _surroundings(self) -> Surroundings:
        from cablemodel.scene.wall_tension import Surroundings

        return Surroundings.of(self.scene)

    # -- analysis -------------------------------------------------------------------------------

    def energy(self) -> dict[str, float]:
        """Energies [J]: kinetic (with added mass), axial, bending, potential (of the submerged
        weight, zero at z = 0), floor (its contact springs); powers [W]: of the vessel on the
        cable, lost in its material, lost to drag (less what a current that changes gives), lost to
        friction and damping on the floor, and what added mass takes from cable that turns while it
        slides (negative: gives), beside its kinetic energy. In a scene with waves the kinetic
        energy is without added mass, the potential that of the weight in air, and drag_power what
        the water takes by all its forces (negative: gives)."""
        from cablemodel.solvers import library as entry

        self._finite_elements("energy")
        out = np.zeros(at.ENERGY_WORDS)
        entry.energy(self._ints, self._reals, out)
        return dict(zip(at.Energies.FIELDS, out.tolist(), strict=True))

    def linearise(self) -> LinearModel:
        """A linear model about the present state, with named states, inputs and outputs.

        Of the finite elements as they are, in space, whether the state is steady or not: see
        :class:`~cablemodel.linear.model.LinearModel`. Tensions are eliminated through the
        compliances. Drag on water that does not pass has no linear part.

        Raises:
            CableModelError: another solver than that of the finite elements, or something that is
                not linear, by name: contact with the floor, waves, a slack line without bending
                stiffness, a body that passes the tow point, a line without a force at the top.
        """
        from cablemodel.linear.line import linear_model

        return linear_model(self)

    def sensitivities(
        self,
        dt: float,
        vessel_velocity: ArrayLike | None = None,
        payout_rate: float | None = None,
        current: ArrayLike | None = None,
        *,
        parameters: Sequence[str] = (),
    ) -> StepSensitivity:
        """What the end of a step would change by with its inputs and parameters; the model stays.

        Args:
            dt, vessel_velocity, payout_rate, current: as of `step`.
            parameters: paths in the scene, as ``cable_types.NAME.drag_normal`` or
                ``line.1.body.submerged_weight``: drag, weight, mass, added mass, axial stiffness.

        Raises:
            CableModelError: what `linearise` refuses, a parameter that is not one, or a mesh that
                changes within the step.
            StepError: the step cannot be made.
        """
        from cablemodel.linear.step_sensitivity import step_sensitivity

        return step_sensitivity(self, dt, vessel_velocity, payout_rate, current, parameters)

    def small_motions(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Mass, damping and stiffness of small motions about the present state, (n, n) each.

        Over the free unknowns of all nodes, position and slope, tension condensed out; meant for
        a state at rest. Dense: for studies of natural frequencies, not for long lines.

        Raises:
            CableModelError: the solver is not that of the finite elements.
        """
        from cablemodel.solvers.finite_element.linearisation import small_motions

        return small_motions(self._finite_elements("small_motions"))

    def natural_frequencies(self, count: int = 5) -> FloatArray:
        """The lowest natural frequencies about the present state [rad/s], (count,).

        Fewer where the mesh has no more. Those by which elements stretch and shorten within
        themselves, which are no property of the cable, are left out.
        """
        from cablemodel.solvers.finite_element.linearisation import natural_frequencies

        return natural_frequencies(self._finite_elements("natural_frequencies"), count)

    def _finite_elements(self, what: str) -> Block:
        """The block of the finite elements; other solvers have no such analysis."""
        memory = self._solver.memory
        if not isinstance(memory, Block):
            method = self.scene.solver.method
            raise CableModelError(f"{what}: not with method {method}, use finite_element")
        return memory
