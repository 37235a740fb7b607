"""Couple the FMU of a towed cable to a vessel with mass, thrust and resistance.

The vessel here is a few lines of Python; in a project it is another FMU or a Simulink model. It
starts from rest at full thrust. Cable and vessel run side by side and exchange velocity and force
after every step of 0.1 s. In the end thrust balances the vessel's resistance and the cable's pull:

    thrust = resistance U^2 - F_x(U)

    python examples/vessel_and_cable.py [PLOT.png]

needs the extra [fmu], and [plot] for the picture.
"""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

import cablemodel as cm
from cablemodel.solvers.library import platform_name
from cablemodel_fmu.export import export_fmu

ROOT = Path(__file__).resolve().parents[1]
MASS, THRUST, RESISTANCE = 2000.0, 200.0, 150.0  # [kg], [N], [N s2/m2]
STEP, DURATION = 0.1, 250.0  # [s]


def couple(fmu: Path) -> np.ndarray:
    """Rows of time, vessel speed, force of the cable along x, top tension."""
    folder = extract(str(fmu), unzipdir=str(fmu.with_suffix("")))
    description = read_model_description(str(fmu))
    reference = {v.name: v.valueReference for v in description.modelVariables}
    velocity = [reference[f"vessel.velocity[{i}]"] for i in (1, 2, 3)]
    outputs = [reference["force.top[1]"], reference["tension.top"]]
    cable = FMU2Slave(
        guid=description.guid,
        unzipDirectory=folder,
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="cable",
    )
    cable.instantiate()
    cable.setupExperiment()
    cable.setBoolean([reference["use_scene_inputs"]], [False])
    cable.enterInitializationMode()
    cable.exitInitializationMode()
    speed = 0.0
    pull, tension = cable.getReal(outputs)
    rows = []
    for n in range(round(DURATION / STEP)):
        cable.setReal(velocity, [speed, 0.0, 0.0])
        cable.doStep(currentCommunicationPoint=n * STEP, communicationStepSize=STEP)
        speed += STEP * (THRUST + pull - RESISTANCE * abs(speed) * speed) / MASS
        pull, tension = cable.getReal(outputs)
        rows.append(((n + 1) * STEP, speed, pull, tension))
    cable.terminate()
    cable.freeInstance()
    return np.array(rows)


def plot(rows: np.ndarray, path: Path) -> None:
    """Speed and top tension over time."""
    import matplotlib.pyplot as plt

    figure, (upper, lower) = plt.subplots(2, 1, sharex=True, figsize=(7, 5))
    upper.plot(rows[:, 0], rows[:, 1])
    upper.set_ylabel("vessel's speed [m/s]")
    lower.plot(rows[:, 0], rows[:, 3])
    lower.set_ylabel("tension at the vessel [N]")
    lower.set_xlabel("time [s]")
    figure.savefig(path)


def main(arguments: list[str]) -> np.ndarray:
    with tempfile.TemporaryDirectory() as work:
        fmu = Path(work) / "tow.fmu"
        scene = cm.load_scene(ROOT / "scenes" / "towed_cable.yaml")
        export_fmu(scene, fmu, platforms=[platform_name() or "linux64"])
        rows = couple(fmu)
    _, speed, pull, tension = rows[-1]
    left = THRUST + pull - RESISTANCE * speed**2
    print(f"speed {speed:.4f} m/s, cable {pull:.2f} N along x, tension {tension:.2f} N")
    print(f"thrust that nothing balances: {left:.3f} N of {THRUST:g} N")
    if arguments:
        plot(rows, Path(arguments[0]))
    return rows


if __name__ == "__main__":
    main(sys.argv[1:])
