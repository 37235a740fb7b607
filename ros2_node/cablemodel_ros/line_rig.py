"""A scene of one line: a tow point and a winch are commanded."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping
from typing import Any

import numpy as np

from cablemodel import CableModel, Scene, StepError, variables
from cablemodel.model import Snapshot
from cablemodel_ros import interface
from cablemodel_ros.commands import Commands, Tally
from cablemodel_ros.frames import Floats
from cablemodel_ros.helm import Applied, Helm, Present
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
from cablemodel_ros.samples import Message, Sampler
from cablemodel_ros.settings import Settings
from cablemodel_ros.timebase import Timebase
from cablemodel_ros.times import Moment, Simulated, Stamp


class LineRig:
    """See `rig.Rig`. Attributes beyond those: ``commands``, ``helm``, ``sampler``."""

    def __init__(self, scene: Scene, settings: Settings, timebase: Timebase) -> None:
        self.scene, self._settings = scene, settings
        self.model = CableModel(scene)
        self.commands = Commands(settings, timebase, self.model.vessel_position)
        self.helm = Helm(settings, self.commands)
        self.sampler = Sampler(scene, settings)
        self.tallies: Mapping[str, Tally] = self.commands.tallies
        self.ports = motion_ports(
            self.commands, settings.vessel_input, interface.ODOM, interface.CMD_VEL, settings
        )
        if settings.payout_input == "command":
            self.ports += (Port(interface.PAYOUT_RATE, self.commands.take_payout_rate),)
        self.orders: Mapping[str, Order] = {}
        frames = {interface.ODOM.name: settings.vessel_frame}
        self.notes = notes_of(settings, ("vessel_inputs",), self.ports, frames)

    @property
    def stale(self) -> Collection[str]:
        return self.helm.stale

    @property
    def abrupt(self) -> Collection[str]:
        return ()

    @property
    def waiting(self) -> Collection[str]:
        return self.helm.waiting

    @property
    def limited(self) -> int:
        return self.helm.limited

    def warm_up(self) -> None:
        """Kernels in the plane and out of it."""
        model = self.model
        sideways = (0.0, 1e-6, 0.0) if abs(model.vessel_velocity[1]) < 0.5 else (1e-6, 0.0, 0.0)
        for velocity in (model.vessel_velocity, model.vessel_velocity + sideways):
            model.step(1e-3, vessel_velocity=velocity)
            model.sample([0.0])
            assert np.isfinite(model.top_tension)
        model.reset()

    def update(self, settings: Settings) -> None:
        self._settings = settings
        self.commands.update(settings)
        self.helm.update(settings)

    def forget(self) -> None:
        self.commands.forget()
        self.helm.reset()

    # -- a step ---------------------------------------------------------------------------------

    def advance(self, target: Simulated, now: Moment) -> Applied:
        """Pay-out that the model refuses is given up, and the step made without."""
        model = self.model
        found = model.numbers()
        present = Present(
            found.vessel_position.copy(),
            found.vessel_velocity.copy(),
            float(found.payout_rate),
            float(found.line_length),
            float(found.drum_length),
        )
        applied = self.helm.inputs(now, target.seconds - model.time, present)
        try:
            self._step(target, applied)
        except StepError as error:
            if not applied.payout_rate and not present.payout_rate:
                raise
            self.commands.refuse_payout(str(error))
            applied = Applied(applied.velocity, 0.0)
            self._step(target, applied)
        return applied

    def _step(self, target: Simulated, applied: Applied) -> None:
        self.model.step_to(
            target.seconds,
            vessel_velocity=applied.velocity,
            payout_rate=applied.payout_rate,
        )

    # -- messages -------------------------------------------------------------------------------

    def applied(self, given: Applied, step: float, stamp: Stamp) -> tuple[Message, list[Message]]:
        return self.sampler.step(self.model, step, given, stamp)

    def outputs(self, stamp: Stamp, wanted: Collection[str] | None = None) -> list[Message]:
        return self.sampler.outputs(self.model, stamp, self.helm.rotation, wanted)

    def record(self, stamp: Stamp) -> list[Message]:
        return self.sampler.record(self.model, stamp)

    def frames(self) -> list[Frame]:
        """The tow point's frame, and on request the vessel's."""
        settings, place, turn = self._settings, self.model.vessel_position, self.helm.rotation
        found = []
        if settings.tf:
            found.append(Frame(settings.tow_point_frame, place, np.eye(3)))
        if settings.tf_vessel:
            origin = place - turn @ settings.tow_point
            found.append(Frame(settings.vessel_frame, origin, turn))
        return found

    # -- the state ------------------------------------------------------------------------------

    @property
    def attitude(self) -> Floats | None:
        return self.helm.rotation

    def take_attitude(self, rotation: Floats) -> None:
        self.helm.begin_with(rotation)

    def image(self) -> bytes:
        return self.model.snapshot().image

    def take_image(self, image: bytes, scene: str) -> None:
        self.model.restore(Snapshot(image, scene))
        self.commands.begin_at(self.model.vessel_position)

    @property
    def scene_hash(self) -> str:
        return self.model.snapshot().scene

    # -- pictures and words ---------------------------------------------------------------------

    def strands(self) -> list[Strand]:
        model = self.model
        state = model.sample(np.linspace(0.0, model.line_length, self._settings.stations))
        return [Strand("", state.position, state.tension, model.top_tension)]

    def places(self) -> list[Floats]:
        return [body.position for body in self.model.bodies]

    def findings(self) -> Iterator[str]:
        """Tensions of slack lines are not promised."""
        model, settings = self.model, self.scene.solver
        if model.winch != "free":
            yield f"the winch stands: {model.winch}"
        if settings.error_estimate:
            yield from doubts(model.errors, settings)

    def values(self) -> dict[str, str]:
        found = {"slack so far [s]": f"{self.model.slack_time:.3f}"}
        if self.scene.solver.error_estimate:
            found |= error_values(self.model.errors, "top tension")
        return found

    def command_findings(self) -> Iterator[str]:
        yield from self.commands.contradictions()
        scheduled = any(point.rate != 0.0 for point in self.scene.payout.rate)
        if scheduled and self.helm.wants_payout and self.commands.latest().payout is None:
            yield "no payout_rate_cmd yet: the winch stands, payout_input scene follows the scene"
        if self.helm.idle_payout:
            has_drum = "drum" in variables.features(self.scene)
            why = "the drum is empty" if has_drum else "the scene has no payout.drum"
            yield f"payout_rate_cmd asks for cable, and {why}"

    def summary(self) -> dict[str, Any]:
        model, scene = self.model, self.scene
        return {
            "line_length": model.line_length,
            "drum_length": model.drum_length,
            "bodies": len(scene.bodies),
            "end": scene.end.kind,
            "vessel_position": model.vessel_position.tolist(),
        }
