"""What the FMU tests share: scenes, an FMU of each, and instances of it through fmpy."""

from __future__ import annotations

import contextlib
import shutil
import struct
import subprocess
import sys
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE

import cablemodel as cm
from cablemodel_fmu.export import export_fmu
from cablemodel_fmu.file_records import FileHeader, Parameter

CABLE = {
    "diameter": 0.01666,
    "mass": 0.4613,
    "submerged_weight": 2.33333,
    "axial_stiffness": 1.0e6,
    "bending_stiffness": 0.1,
    "drag_normal": 1.0,
    "drag_tangential": 0.1586,
    "added_mass": 1.0,
}


def still_scene(**changes):
    """A cable with a body that hangs at rest: nothing is scheduled, the inputs drive."""
    data = {
        "title": "Still cable",
        "environment": {"current": {"table": [{"z": 0, "velocity": [0.1, 0, 0]}]}},
        "cable_types": {"K": CABLE},
        "line": [
            {"cable": {"type": "K", "length": 20}},
            {
                "body": {
                    "mass": 6,
                    "submerged_weight": 20,
                    "added_mass": 2,
                    "added_mass_axial": 2,
                    "drag_area": 0.03,
                    "drag_coefficient": 0.6,
                    "drag_area_axial": 0.03,
                    "drag_coefficient_axial": 0.6,
                }
            },
            {"cable": {"type": "K", "length": 10}},
        ],
        "end": "free",
        "vessel": {"position": [5, 3, 0]},
        "payout": {"drum": [{"cable": {"type": "K", "length": 15}}]},
        "run": {"duration": 20, "output_interval": 0.5},
    }
    data.update(changes)
    return cm.load_scene(data)


@contextlib.contextmanager
def unpacked(scene, folder: Path, **options) -> Iterator[tuple[Path, object]]:
    """An exported FMU, unpacked: its folder and its model description."""
    path = export_fmu(scene, folder / "cable.fmu", platforms=["linux64"], **options)
    place = extract(str(path))
    try:
        yield Path(place), read_model_description(str(path))
    finally:
        shutil.rmtree(place, ignore_errors=True)


class Slave:
    """An instance, by the names of its variables; messages are collected."""

    def __init__(
        self,
        place: Path,
        description: object,
        *,
        start: float = 0.0,
        begin: bool = True,
        logging: bool = False,
        **values,
    ) -> None:
        self.messages: list[tuple[int, str]] = []
        self.description = description
        self.references = {v.name: v for v in description.modelVariables}
        self.fmu = FMU2Slave(
            guid=description.guid,
            unzipDirectory=str(place),
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="cable",
        )
        callbacks = fmi2CallbackFunctions()
        callbacks.logger = fmi2CallbackLoggerTYPE(self._log)
        self.fmu.instantiate(callbacks=callbacks, loggingOn=logging)
        self.time = start
        if not begin:
            return
        self._begin(**values)

    def _begin(self, **values) -> None:
        self.fmu.setupExperiment(startTime=self.time)
        for name, value in values.items():
            self.set(name, value)
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def begin_again(self) -> None:
        """At t = 0, after a reset."""
        self.fmu.reset()
        self.time = 0.0
        self._begin()

    def _log(self, environment, name, status, category, message) -> None:
        assert name == b"cable"
        self.messages.append((status, message.decode()))

    def names(self, name: str) -> list[str]:
        if name in self.references:
            return [name]
        return sorted(
            (n for n in self.references if n.startswith(name + "[") and n.endswith("]")),
            key=lambda n: [int(k) for k in n[len(name) + 1 : -1].split(",")],
        )

    def get(self, name: str):
        names = self.names(name)
        values = self.fmu.getReal([self.references[n].valueReference for n in names])
        return values[0] if names == [name] else np.array(values)

    def set(self, name: str, value) -> None:
        name = {"use_scene_inputs": "use_scene_inputs", "vessel_input": "vessel.input"}.get(
            name, name
        )
        variable = self.references.get(name)
        if variable is not None and variable.type == "Boolean":
            self.fmu.setBoolean([variable.valueReference], [bool(value)])
        elif variable is not None and variable.type in ("Integer", "Enumeration"):
            self.fmu.setInteger([variable.valueReference], [int(value)])
        else:
            names = self.names(name)
            assert names, name
            references = [self.references[n].valueReference for n in names]
            self.fmu.setReal(references, np.atleast_1d(value).tolist())

    def step(self, dt: float) -> None:
        self.fmu.doStep(currentCommunicationPoint=self.time, communicationStepSize=dt)
        self.time += dt

    def close(self) -> None:
        self.fmu.freeInstance()


def states_of_two_orders(
    first: Slave,
    second: Slave,
    one: tuple[str, float],
    other: tuple[str, float],
    wrong: float,
    read: str,
) -> list[bytes]:
    """States after the initialization of two that have not begun: one gets both values as they
    are given; the other the other way round, `wrong` at first, with outputs read in between."""
    for slave in (first, second):
        slave.fmu.setupExperiment()
        slave.fmu.enterInitializationMode()
    for name, value in (one, other):
        first.set(name, value)
    for name, value in (other, (one[0], wrong)):
        second.set(name, value)
        second.get(read)
    second.set(*one)
    for slave in (first, second):
        slave.fmu.exitInitializationMode()
    return [slave.fmu.serializeFMUstate(slave.fmu.getFMUstate()) for slave in (first, second)]


def step_alike(slave: Slave, model, rng: np.random.Generator, dt: float) -> None:
    """One step of both with the same random inputs: motion in all directions, current, pay-out."""
    velocity, current = rng.uniform(-0.5, 0.5, 3), rng.uniform(-0.1, 0.1, 3)
    rate = rng.uniform(-0.2, 0.4)
    slave.set("vessel.velocity", velocity)
    slave.set("current.velocity", current)
    slave.set("payout.rate", rate)
    slave.step(dt)
    model.step(dt, vessel_velocity=velocity, payout_rate=rate, current=current)


PROCESS = """
import sys
from pathlib import Path
from fmpy import read_model_description
sys.path[:0] = {paths!r}
from fmu_tools import Slave
from {module} import drive
place = Path({place!r})
slave = Slave(place, read_model_description(str(place)))
slave.fmu.setFMUstate(slave.fmu.deSerializeFMUstate(Path({state!r}).read_bytes()))
slave.time = {time!r}
Path({out!r}).write_bytes(drive(slave, {first}, {last}))
"""


def driven_elsewhere(
    slave: Slave, place: Path, folder: Path, module: str, first: int, last: int
) -> bytes:
    """What ``drive`` of a test module gives in another process, from an instance's state."""
    state, out = folder / "state", folder / "out"
    state.write_bytes(slave.fmu.serializeFMUstate(slave.fmu.getFMUstate()))
    code = PROCESS.format(
        paths=sys.path,
        module=module,
        place=str(place),
        state=str(state),
        time=slave.time,
        out=str(out),
        first=first,
        last=last,
    )
    subprocess.run([sys.executable, "-c", code], check=True)
    return out.read_bytes()


def python_outputs(model, stations: int) -> dict[str, np.ndarray]:
    """What the FMU's outputs are in the Python model."""
    length = model.line_length
    state = model.sample([length * k / (stations - 1) for k in range(stations)])
    found = {
        "tension.top": model.top_tension,
        "tension.min": model.tension_min,
        "tension.max": model.tension_max,
        "slack.time": model.slack_time,
        "slack.longest": model.slack_longest,
        "slack.since": model.slack_since,
        "slack.start": model.slack_start,
        "slack.end": model.slack_end,
        "force.top": model.top_force,
        "moment.top": model.top_moment,
        "end.position": model.tip_position,
        "end.velocity": model.tip_velocity,
        "line.length": length,
        "payout.applied": model.payout_rate,
        "line.position": state.position.ravel(),
        "line.tension": state.tension,
        "line.curvature": state.curvature,
    }
    items = [*model.scene.line, *model.scene.payout.drum]
    inside = sum(item.body is not None for item in items) - len(model.bodies)
    for j, body in enumerate(model.bodies, start=1 + inside):
        found[f"body[{j}].position"] = body.position
        found[f"body[{j}].direction"] = body.direction
    if model.scene.payout.drum:
        found["drum.length"] = model.drum_length
    if model.scene.environment.floor is not None:
        found["floor.force"] = model.floor_force
        found["floor.length"] = model.floor_length
        found["touchdown.position"] = model.touchdown_position
        found["touchdown.reaction"] = model.touchdown_reaction
    if model.scene.solver.error_estimate:
        found["error.position"] = model.position_error
        found["error.tension"] = model.tension_error
    return {name: np.asarray(value) for name, value in found.items()}


def assert_same_bits(slave: Slave, model, stations: int) -> None:
    """Every output has the bits of the Python model's."""
    assert slave.time == model.time
    for name, expected in python_outputs(model, stations).items():
        np.testing.assert_array_equal(slave.get(name), expected, err_msg=name)


# -- a model file (cablemodel_fmu/model_file.py), altered ------------------------------------------


def sealed(data: bytearray) -> bytes:
    """With the checksum that belongs to the contents: what a vandal with a manual would write."""
    at, behind = 8 * FileHeader.checksum.word, 8 * FileHeader.kernels.word
    data[at:behind] = struct.pack("<q", zlib.crc32(data[behind:]))
    return bytes(data)


def image_start(data: bytes) -> int:
    """Where the block begins."""
    parameters = struct.unpack_from("<q", data, 8 * FileHeader.parameter_count.word)[0]
    return 8 * (FileHeader.WORDS + Parameter.WORDS * parameters)
