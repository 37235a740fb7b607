"""The vessel of vessel_fmu.c: as an FMU, and in Python with the same arithmetic."""

from __future__ import annotations

import zipfile
from pathlib import Path

import numpy as np

from cablemodel_fmu.build import SOURCES, compile_c

NAMES = [
    *(f"force[{i}]" for i in (1, 2, 3)),
    *(f"velocity[{i}]" for i in (1, 2, 3)),
    *(f"position[{i}]" for i in (1, 2, 3)),
]
PARAMETERS = {"mass": 5000.0, "thrust": 300.0, "resistance": 200.0}


def export_vessel(path: Path, work: Path) -> Path:
    library = work / "vessel.so"
    compile_c(
        "x86_64-linux-gnu.2.17",
        [Path(__file__).with_suffix(".c")],
        library,
        "-shared",
        f"-I{SOURCES / 'fmi2'}",
        "-lm",
    )
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("modelDescription.xml", _description())
        archive.write(library, "binaries/linux64/vessel.so")
    return path


def _description() -> str:
    rows, outputs = [], []
    for reference, name in enumerate(NAMES):
        is_input = name.startswith("force")
        causality, start = ("input", ' start="0"') if is_input else ("output", "")
        rows.append(
            f'<ScalarVariable name="{name}" valueReference="{reference}" causality="{causality}" '
            f'variability="continuous"><Real{start}/></ScalarVariable>'
        )
        if not is_input:
            outputs.append(f'<Unknown index="{reference + 1}"/>')
    for reference, (name, value) in enumerate(PARAMETERS.items(), start=len(NAMES)):
        rows.append(
            f'<ScalarVariable name="{name}" valueReference="{reference}" causality="parameter" '
            f'variability="fixed"><Real start="{value}"/></ScalarVariable>'
        )
    return (
        '<?xml version="1.0" encoding="UTF-8"?><fmiModelDescription fmiVersion="2.0" '
        'modelName="vessel" guid="{vessel}"><CoSimulation modelIdentifier="vessel" '
        'canHandleVariableCommunicationStepSize="true"/><ModelVariables>'
        f"{''.join(rows)}</ModelVariables><ModelStructure><Outputs>{''.join(outputs)}</Outputs>"
        f"<InitialUnknowns>{''.join(outputs)}</InitialUnknowns></ModelStructure>"
        "</fmiModelDescription>"
    )


class Vessel:
    """The same vessel in Python."""

    def __init__(self) -> None:
        self.velocity = np.zeros(3)
        self.position = np.zeros(3)

    def step(self, dt: float, force) -> None:
        h = dt / 10
        for _ in range(10):
            speed = np.sqrt(self.velocity[0] ** 2 + self.velocity[1] ** 2)
            for i in range(2):
                thrust = PARAMETERS["thrust"] if i == 0 else 0.0
                total = thrust + force[i] - PARAMETERS["resistance"] * speed * self.velocity[i]
                self.velocity[i] += h * total / PARAMETERS["mass"]
                self.position[i] += h * self.velocity[i]


def coupled_in_python(scene, ends: list[float]) -> np.ndarray:
    """Vessel and cable side by side, values exchanged after each step: rows of (vx, top tension).

    ends: of the steps, to the last bit as the co-simulation master has them.
    """
    import cablemodel as cm

    cable, vessel = cm.CableModel(scene), Vessel()
    velocity, force = vessel.velocity.copy(), cable.top_force
    rows = []
    for end in ends:
        dt = end - cable.time
        cable.step_to(end, velocity, payout_rate=0.0, current=(0, 0, 0))
        vessel.step(dt, force)
        velocity, force = vessel.velocity.copy(), cable.top_force
        rows.append((vessel.velocity[0], cable.top_tension))
    return np.array(rows)
