"""The vessel of cablemodel_fmu/c/vessel: as an FMU, and in Python with the same arithmetic."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from cablemodel.solvers.library import BINARIES
from cablemodel_fmu.system import vessel_fmu

PARAMETERS = {"mass": 5000.0, "thrust": 300.0, "resistance": 200.0}


def export_vessel(path: Path) -> Path:
    library = (BINARIES / "linux64" / "vessel.so").read_bytes()
    return vessel_fmu(path, {"binaries/linux64/vessel.so": library})


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


def coupled_in_python(scene, ends: list[float], first_force=None) -> np.ndarray:
    """Vessel and cable side by side, values exchanged after each step: rows of (vx, top tension).

    ends: of the steps, to the last bit as the co-simulation master has them. first_force: on the
    vessel in its first step, that of the cable at rest if not given.
    """
    import cablemodel as cm

    cable, vessel = cm.CableModel(scene), Vessel()
    velocity, force = vessel.velocity.copy(), cable.top_force
    if first_force is not None:
        force = first_force
    rows = []
    for end in ends:
        dt = end - cable.time
        cable.step_to(end, velocity, payout_rate=0.0, current=(0, 0, 0))
        vessel.step(dt, force)
        velocity, force = vessel.velocity.copy(), cable.top_force
        rows.append((vessel.velocity[0], cable.top_tension))
    return np.array(rows)
