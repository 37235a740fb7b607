"""Couple the FMU of a taut line to a vessel, and keep the coupling from driving the vessel.

A vessel of 5 t at the end of a line of 1e4 N/m swings with a period of 4.4 s. The FMUs run side by
side and exchange velocity and force after every step H of 0.1 s. In "plain" both models hold what
they got: the force is late by a step and a half, which acts as a damper of -1.5 k H, at any step. A
line that damps less lets the vessel swing ever more. What cures it, with means of the FMU:

- "timing": `input.timing` is 2. The velocity is that at the step's start, and the FMU goes on from
  there. The vessel still holds the force: -0.5 k H is left.
- "timing, derivatives": the vessel also takes the force with its output derivative. About
  -k^2 H^3 / m is left; both models may run at the same time.
- "derivatives": the vessel steps first, with the force and its derivative; the cable gets the
  velocity that it reaches. Nothing is left.
- "newton": the vessel's velocity is solved for together with the force at the end of the step, by
  the directional derivative of the force; the step is then made again. Nothing is left at any step.

    python examples/taut_line.py

needs the extra [fmu].
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

import cablemodel as cm
from cablemodel.solvers.library import platform_name
from cablemodel_fmu.export import export_fmu

MASS, STEP, DURATION = 5000.0, 0.1, 30.0  # [kg], [s], [s]
SPEED = 0.01  # of the vessel at the start [m/s]
SWING = 4.4  # its period [s]
WAYS = ("plain", "timing", "timing, derivatives", "derivatives", "newton")


def scene() -> cm.Scene:
    """A line to an anchor, stretched by a hundredth: 1e4 N/m."""
    rope = {"diameter": 0.02, "mass": 0.3, "axial_stiffness": 1e6, "bending_stiffness": 0.1}
    return cm.load_scene(
        {
            "title": "Taut line",
            "cable_types": {"rope": rope},
            "line": [{"cable": {"type": "rope", "length": 100}}],
            "end": {"anchor": [101, 0, 0]},
            "run": {"duration": DURATION, "output_interval": STEP},
        }
    )


class Cable:
    """An instance of the FMU, by what the coupling wants of it."""

    def __init__(self, fmu: Path, folder: str, *, timing: int) -> None:
        description = read_model_description(str(fmu))
        reference = {v.name: v.valueReference for v in description.modelVariables}
        self._velocity = [reference[f"vessel.velocity[{i}]"] for i in (1, 2, 3)]
        self._force = reference["force.top[1]"]
        self.fmu = FMU2Slave(
            guid=description.guid,
            unzipDirectory=folder,
            modelIdentifier=description.coSimulation.modelIdentifier,
            instanceName="cable",
        )
        self.fmu.instantiate()
        self.fmu.setupExperiment()
        self.fmu.setInteger([reference["input.timing"]], [timing])
        self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()

    def step(self, n: int, speed: float) -> float:
        """A step with the vessel's speed; returns the force on the vessel, along the line [N]."""
        self.fmu.setReal(self._velocity, [speed, 0.0, 0.0])
        self.fmu.doStep(currentCommunicationPoint=n * STEP, communicationStepSize=STEP)
        return self.force()

    def force(self) -> float:
        return float(self.fmu.getReal([self._force])[0])

    def rate(self) -> float:
        """Of the force, over time [N/s]."""
        return float(self.fmu.getRealOutputDerivatives([self._force], [1])[0])

    def by_speed(self) -> float:
        """Of the force, by the speed of the last step [N s/m]."""
        return float(
            self.fmu.getDirectionalDerivative([self._force], [self._velocity[0]], [1.0])[0]
        )


def couple(fmu: Path, folder: str, way: str) -> np.ndarray:
    """Speed of the vessel at the end of each step [m/s]."""
    cable = Cable(fmu, folder, timing=2 if "timing" in way else 1)
    thrust = -cable.force()  # balances the line
    speed, force, rate = SPEED, cable.force(), 0.0
    gain = 0.0  # of the vessel's speed, in the last step
    speeds = []
    for n in range(round(DURATION / STEP)):
        if way == "newton":
            # To a speed that goes on as before; then to the one that fits the force at the end.
            state = cable.fmu.getFMUstate()
            guess = speed + gain
            end = cable.step(n, guess)
            by_speed = cable.by_speed()
            # m (v - speed) / H = thrust + (force + end + by_speed (v - guess)) / 2
            pull = thrust + 0.5 * (force + end - by_speed * guess)
            new = (MASS * speed / STEP + pull) / (MASS / STEP - 0.5 * by_speed)
            cable.fmu.setFMUstate(state)
            cable.fmu.freeFMUstate(state)
            force = cable.step(n, new)
        else:
            new = speed + STEP * (thrust + force + 0.5 * STEP * rate) / MASS
            force = cable.step(n, new if way == "derivatives" else speed)
            rate = cable.rate() if "derivatives" in way else 0.0
        gain, speed = new - speed, new
        speeds.append(speed)
    cable.fmu.terminate()
    cable.fmu.freeInstance()
    return np.array(speeds)


def growth(speeds: np.ndarray) -> float:
    """From the largest speed of the first swing to that of the last [1/s]."""
    swing = round(SWING / STEP)
    last, first = np.abs(speeds[-swing:]).max(), np.abs(speeds[:swing]).max()
    return float(np.log(last / first) / (DURATION - SWING))


def main() -> dict[str, float]:
    """The growth rate of each way [1/s]."""
    with tempfile.TemporaryDirectory() as work:
        fmu = Path(work) / "taut.fmu"
        export_fmu(scene(), fmu, platforms=[platform_name() or "linux64"])
        folder = extract(str(fmu), unzipdir=str(fmu.with_suffix("")))
        found = {way: growth(couple(fmu, folder, way)) for way in WAYS}
    for way, rate in found.items():
        print(f"{way:20} grows by {rate:+.4f} 1/s")
    return found


if __name__ == "__main__":
    main()
