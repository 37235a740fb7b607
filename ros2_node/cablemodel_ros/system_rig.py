"""A system: its vessels, driven ends, bodies, foils, winches and cuts are commanded by name."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Collection, Iterator, Mapping
from functools import cached_property, partial
from typing import Any

import numpy as np

from cablemodel import StepError, SystemModel, SystemScene, VesselInput
from cablemodel.errors import SceneError
from cablemodel_ros import interface
from cablemodel_ros.commands import Commands, PartCommands, Seat, Tally
from cablemodel_ros.frames import Floats
from cablemodel_ros.helm import Freshness, VesselHelm
from cablemodel_ros.limits import approached_number, follow_rate
from cablemodel_ros.rig import (
    Frame,
    Order,
    Port,
    Strand,
    doubts,
    error_values,
    motion_ports,
    notes_of,
)
from cablemodel_ros.samples import Message
from cablemodel_ros.settings import Settings, SettingsError
from cablemodel_ros.system_samples import SystemSampler
from cablemodel_ros.timebase import Timebase
from cablemodel_ros.times import Moment, Simulated, Stamp

OF_ONE_LINE = (
    "payout_input", "vessel_frame", "tow_point", "tow_point_frame", "initial_heading",
)  # fmt: skip
"""Parameters that mean nothing for a system."""


class SystemRig:
    """See `rig.Rig`."""

    def __init__(self, scene: SystemScene, settings: Settings, timebase: Timebase) -> None:
        sources = sources_of(settings, scene)
        self.scene, self._settings = scene, settings
        self.model = SystemModel(scene)
        self._sampler = SystemSampler(scene, settings)
        odometry, twist, wrench, deflection, rate = (
            partial(interface.topic_of_part, topic) for topic in interface.PART_INPUTS
        )
        bodies = {name: wrench(name) for name in scene.bodies}
        foils = {name: deflection(name) for name in self.model.deflections}
        winches = {name: rate(name) for name in scene.winches}
        self._parts = PartCommands(
            settings, timebase, _labels(bodies), _labels(foils), _labels(winches)
        )
        self._wrenches = frozenset(_labels(bodies).values())
        ports = [Port(bodies[name], partial(self._parts.take_wrench, name)) for name in bodies]
        ports += [Port(foils[name], partial(self._parts.take_deflection, name)) for name in foils]
        ports += [Port(winches[name], partial(self._parts.take_rate, name)) for name in winches]
        tallies = dict(self._parts.tallies)
        self._commands: dict[str, Commands] = {}
        self._helms: dict[str, VesselHelm] = {}
        for name, motion in self.model.vessels.items():
            by_odometry, by_twist = odometry(name), twist(name)
            seat = Seat(_label(by_odometry), _label(by_twist), name)
            commands = Commands(settings, timebase, motion.position, seat)
            self._commands[name] = commands
            self._helms[name] = VesselHelm(settings, commands, sources[name])
            ports += motion_ports(commands, sources[name], by_odometry, by_twist, settings)
        self.ports = tuple(ports)
        # Of those that something listens to.
        heard = {_label(port.topic) for port in ports}
        for commands in self._commands.values():
            tallies |= {k: tally for k, tally in commands.tallies.items() if k in heard}
        self.tallies: Mapping[str, Tally] = tallies
        self.orders: Mapping[str, Order] = {
            interface.cut_service(name): partial(self._order_cut, name) for name in scene.cuts
        }
        self._freshness = Freshness()
        self._limited = 0
        self._idle: set[str] = set()
        frames = {odometry(name).name: name for name in scene.vessels}
        self.notes = notes_of(settings, OF_ONE_LINE, self.ports, frames)

    @property
    def stale(self) -> Collection[str]:
        return self._freshness.stale.union(*(helm.stale for helm in self._helms.values()))

    @property
    def abrupt(self) -> Collection[str]:
        return self._wrenches

    @property
    def waiting(self) -> Collection[str]:
        """Of motion: without a wrench or a deflection the scene's own goes on."""
        return set().union(*(helm.waiting for helm in self._helms.values()))

    @property
    def limited(self) -> int:
        return self._limited + sum(helm.limited for helm in self._helms.values())

    def warm_up(self) -> None:
        """A step by itself, and one that is driven."""
        self.model.step(1e-3)
        motions = self.model.vessels.items()
        kept = {name: VesselInput(velocity=motion.velocity) for name, motion in motions}
        self.model.step(1e-3, vessels=kept)
        assert np.isfinite(self.model.top_tension)
        self.model.reset()

    def update(self, settings: Settings) -> None:
        self._settings = settings
        self._parts.update(settings)
        for name, commands in self._commands.items():
            commands.update(settings)
            self._helms[name].update(settings)

    def forget(self) -> None:
        self._parts.forget()
        self._freshness = Freshness()
        self._idle = set()
        for name, commands in self._commands.items():
            commands.forget()
            self._helms[name].reset()

    # -- a step ---------------------------------------------------------------------------------

    def advance(self, target: Simulated, now: Moment) -> dict[str, Any]:
        """Rates of winches that the model refuses are given up, and the step made without."""
        dt = target.seconds - self.model.time
        motions = self.model.motions
        vessels = {}
        for name, helm in self._helms.items():
            wanted = helm.input(now, dt, motions[name])
            if wanted is not None:
                vessels[name] = wanted
        given: dict[str, Any] = {
            "vessels": vessels,
            "forces": self._forces(now, motions),
            "deflections": self._deflections(dt),
            "rates": self._rates(now, dt),
            "cuts": [name for name in self._parts.cuts if self.model.cuts[name] is None],
        }
        try:
            self.model.step_to(target.seconds, **given)
        except StepError as error:
            present, rates = self.model.winches, given["rates"]
            turning = [n for n, rate in rates.items() if rate or present[n].payout_rate]
            if not turning:
                raise
            for name in turning:
                self._parts.refuse_rate(name, str(error))
            given["rates"] = {**rates, **dict.fromkeys(turning, 0.0)}
            self.model.step_to(target.seconds, **given)
        return given

    def _forces(self, now: Moment, motions: Mapping[str, Any]) -> dict[str, Floats]:
        """Outside wrenches in force, in the map's axes; of a stale one there is none."""
        found = {}
        timeout = self._settings.command_timeout
        for name, wrench in self._parts.wrenches.items():
            if self._freshness.fresh(self._parts.topics[name], now, wrench, timeout):
                value = wrench.value
                if wrench.in_body:
                    axes = motions[name].axes
                    value = np.concatenate([axes @ value[:3], axes @ value[3:]])
                found[name] = value
        return found

    def _deflections(self, dt: float) -> dict[str, float]:
        """A foil stays where it was told to, like any servo: no such command gets stale."""
        wanted = self._parts.deflections
        if not wanted:
            return {}
        present, change = self.model.deflections, self._settings.limits_deflection_rate * dt
        found = {n: approached_number(present[n], angle, change) for n, angle in wanted.items()}
        self._limited += found != wanted
        return found

    def _rates(self, now: Moment, dt: float) -> dict[str, float]:
        """Rates of winches that were commanded; a command that is stale is one to stop."""
        s, found = self._settings, {}
        present = self.model.winches if self._parts.rates else {}
        for name, command in self._parts.rates.items():
            topic = self._parts.topics[name]
            fresh = self._freshness.fresh(topic, now, command, s.command_timeout)
            wanted = command.rate if fresh else 0.0
            winch = present[name]
            if wanted > 0.0 and winch.drum_length <= 0.0:
                self._idle.add(name)
            else:
                self._idle.discard(name)
            found[name] = follow_rate(
                winch.payout_rate,
                wanted,
                dt,
                s.limits_payout_rate,
                s.limits_payout_acceleration,
                winch.drum_length,
                winch.line_length - s.limits_line_length_min,
            )
            self._limited += found[name] != wanted
        return found

    def _order_cut(self, name: str) -> tuple[bool, str]:
        made = self.model.cuts[name]
        if made is not None:
            return False, f"{name}: made already, at t = {made:.6g} s"
        self._parts.order_cut(name)
        return True, f"{name}: made in the next step, after t = {self.model.time:.6g} s"

    # -- messages -------------------------------------------------------------------------------

    def applied(
        self, given: dict[str, Any], step: float, stamp: Stamp
    ) -> tuple[Message, list[Message]]:
        return self._sampler.step(self.model, step, given), []

    def outputs(self, stamp: Stamp, wanted: Collection[str] | None = None) -> list[Message]:
        return self._sampler.outputs(self.model, stamp, wanted)

    def record(self, stamp: Stamp) -> list[Message]:
        return self._sampler.record(self.model, stamp)

    def frames(self) -> list[Frame]:
        """Bodies, and on request vessels and driven ends."""
        names = (
            *(self.scene.bodies if self._settings.tf else ()),
            *(self.scene.vessels if self._settings.tf_vessel else ()),
        )
        motions = self.model.motions
        return [Frame(name, motions[name].position, motions[name].axes) for name in names]

    # -- the state ------------------------------------------------------------------------------

    @property
    def attitude(self) -> Floats | None:
        return None

    def take_attitude(self, rotation: Floats) -> None:
        """Vessels turn with the state."""

    def image(self) -> bytes:
        return self.model.snapshot()

    def take_image(self, image: bytes, scene: str) -> None:
        if scene and scene != self.scene_hash:
            problem = "it belongs to another scene, of other values"
            raise SceneError.at("snapshot", None, problem, "one of this scene")
        self.model.restore(image)
        for name, motion in self.model.vessels.items():
            self._commands[name].begin_at(motion.position)

    @cached_property
    def scene_hash(self) -> str:
        data = self.scene.to_dict()
        kept = {key: data[key] for key in data if key not in ("title", "run")}
        return hashlib.sha256(json.dumps(kept, sort_keys=True).encode()).hexdigest()

    # -- pictures and words ---------------------------------------------------------------------

    def strands(self) -> list[Strand]:
        found = []
        for name, line in self.model.lines.items():
            state = line.sample(np.linspace(0.0, line.length, self._settings.stations))
            tension = state.tension
            found.append(Strand(f"{name}: ", state.position, tension, float(tension[0])))
        return found

    def places(self) -> list[Floats]:
        return [motion.position for motion in self.model.bodies.values()]

    def findings(self) -> Iterator[str]:
        for name, winch in self.model.winches.items():
            if winch.limit != "free":
                yield f"the winch {name} stands: {winch.limit}"
        if self.scene.solver.error_estimate:
            yield from doubts(self.model.errors, self.scene.solver)

    def values(self) -> dict[str, str]:
        found = {
            f"{name} made [s]": "not yet" if time is None else f"{time:.3f}"
            for name, time in self.model.cuts.items()
        }
        for name, line in self.model.lines.items():
            found[f"{name}: slack so far [s]"] = f"{line.slack.time:.3f}"
        if self.scene.solver.error_estimate:
            found |= error_values(self.model.errors, "tensions at its ends")
        return found

    def command_findings(self) -> Iterator[str]:
        for commands in self._commands.values():
            yield from commands.contradictions()
        for name in sorted(self._idle):
            has_drum = self.scene.winches[name].drum_length > 0.0
            why = "the drum is empty" if has_drum else f"winches.{name} has no drum"
            yield f"{self._parts.topics[name]} asks for cable, and {why}"

    def summary(self) -> dict[str, Any]:
        scene = self.scene
        return {
            "lines": {name: line.length for name, line in scene.lines.items()},
            "bodies": list(scene.bodies),
            "vessels": {
                name: motion.position.tolist() for name, motion in self.model.vessels.items()
            },
            "winches": list(scene.winches),
            "cuts": list(scene.cuts),
        }


def sources_of(settings: Settings, scene: SystemScene) -> dict[str, str]:
    """What moves each vessel and driven end: odom, cmd_vel or scene.

    Raises:
        SettingsError: `vessel_inputs` is none, or names what the scene does not have; or a vessel
            that the scene's waves move is to be moved as a whole.
    """
    found = dict.fromkeys(scene.vessels, settings.vessel_input)
    for entry in settings.vessel_inputs.split():
        name, _, source = entry.partition("=")
        if name not in found or source not in SOURCES:
            raise SettingsError(
                f"parameter vessel_inputs has {entry!r}; allowed: NAME=SOURCE with NAME "
                f"{' | '.join(found) or '(the scene has none)'} and SOURCE {' | '.join(SOURCES)}"
            )
        found[name] = source
    for name, source in found.items():
        if scene.vessels[name].raos and source != "scene":
            raise SettingsError(
                f"{name} is moved by {source}, and vessels.{name}.raos would move it again; "
                f"allowed: {name}=scene in the parameter vessel_inputs, or no raos"
            )
    return found


SOURCES = ("odom", "cmd_vel", "scene")


def _label(topic: interface.Topic) -> str:
    """What a topic is called in diagnostics: ``ship/odom_in``."""
    return topic.name.removeprefix("~/")


def _labels(topics: Mapping[str, interface.Topic]) -> dict[str, str]:
    return {name: _label(topic) for name, topic in topics.items()}
