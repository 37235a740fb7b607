"""MuJoCo (C core, from PyPI) on the release in a vacuum (S2v).

What is like for like, and what is not:

- A chain of rigid rods with hinges, each with a spring of EI over a rod's length: MuJoCo has no
  elastic cable element in one dimension; its ``cable`` composite is such a chain with ball joints,
  which costs more. The chain does not stretch: EA = 1e6 N stretches this cable by 1e-4.
- Its fluid forces are those of ellipsoids or boxes, without Morison's normal and tangential
  coefficients, and without added mass on a chain of rods: scenes in water are left out, hence the
  vacuum. Nor is there pay-out.
- Coordinates are minimal (angles), so that time steps are long; RK4 and the implicit Euler scheme
  that its documentation recommends are both tried. Only mj_step is timed; the force in the top is
  its force sensor's at the instant itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.scenes import GRAVITY, BenchmarkScene


@dataclass(frozen=True)
class Settings:
    """How MuJoCo computes: number of rods, time step [s], integrator."""

    rods: int
    time_step: float
    integrator: str = "RK4"


def model_file(scene: BenchmarkScene, settings: Settings) -> str:
    """The chain in MuJoCo's XML."""
    cable, count = scene.cable, settings.rods
    length = cable.length / count
    mass = cable.mass * length
    # A hinge between two rods bends by EI / length; the outer half rods are stiff.
    spring = cable.bending_stiffness / length
    inertia = mass * length**2 / 12.0
    bodies = "".join(
        f'<body pos="{length if k else 0.0!r} 0 0">'
        f'<joint type="hinge" axis="0 1 0" stiffness="{spring if k else 0.0!r}"/>'
        f'<inertial pos="{0.5 * length!r} 0 0" mass="{mass!r}" '
        f'diaginertia="{0.1 * inertia!r} {inertia!r} {inertia!r}"/>'
        + ('<site name="top"/>' if k == 0 else "")
        for k in range(count)
    )
    return (
        f'<mujoco><compiler boundmass="0" boundinertia="0"/>'
        f'<option timestep="{settings.time_step!r}" integrator="{settings.integrator}" '
        f'gravity="0 0 {-GRAVITY!r}"><flag contact="disable"/></option>'
        f'<worldbody>{bodies}<site name="end" pos="{length!r} 0 0"/>{"</body>" * count}'
        f'</worldbody><sensor><force site="top"/></sensor></mujoco>'
    )


class MuJoCoRunner:
    """One MuJoCo chain at the scene's start."""

    def __init__(self, scene: BenchmarkScene, times: Sequence[float], settings: Settings) -> None:
        import mujoco

        if scene.water_density != 0.0 or scene.start != "straight":
            raise ValueError(f"{scene.name}: MuJoCo has no Morison drag and no added mass")
        self._api: Any = mujoco
        self._model = mujoco.MjModel.from_xml_string(model_file(scene, settings))
        self._data = mujoco.MjData(self._model)
        self._settings = settings
        self._counts = {t: round(t / settings.time_step) for t in times}
        if any(abs(n * settings.time_step - t) > 1e-9 for t, n in self._counts.items()):
            raise ValueError(f"{settings.time_step} s does not divide the instants {times}")
        self._steps = 0

    def advance(self, time: float) -> None:
        """Step to that time; it must be one of those given at the start."""
        count = self._counts[time] - self._steps
        self._api.mj_step(self._model, self._data, count)
        self._steps += count

    def tip(self) -> NDArray[np.float64]:
        """Free end relative to the vessel (3,) [m]."""
        self._api.mj_forward(self._model, self._data)
        return np.array(self._data.site("end").xpos)

    def top_tension(self) -> float:
        """Magnitude of the force in the first hinge [N]."""
        self._api.mj_forward(self._model, self._data)
        return float(np.linalg.norm(self._data.sensordata[:3]))

    def statistics(self) -> dict[str, float]:
        """Rods and steps."""
        return {"elements": float(self._settings.rods), "steps": float(self._steps)}

    def close(self) -> None:
        """Nothing to free."""
