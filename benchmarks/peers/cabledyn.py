"""CableDyn (Fortran core, from PyPI) on the scenes that it can express: S1 and the jumper.

What is like for like, and what is not:

- Equations: finite elements in positions, generalised alpha in time, Morison drag on the
  unstretched diameter without the factor sqrt(e), tangential drag 1/2 rho Cdt (pi d) |u| u. A line
  with EI > 0 is of cubic Hermite elements and must be held at both ends; one with a free end (S1)
  must have EI = 0, and is of two-node elements: S1 is solved without bending, which moves its end
  by 2e-5 L at most.
- Every run starts from CableDyn's own static equilibrium: the releases (S2w, S2a, S2v) and the
  turn out of a steady tow (S4) cannot be stated. There is no pay-out (S3). Its own waves are
  not for a model that is coupled to a host, as this one ("deck waves are not evaluated").
- Water is there where the deck says ``WtrDpth``; the top is 100 m below the surface. Gravity is set
  so that the submerged weight is exact: g' = w / (m - rho pi d^2 / 4).
- Driven in process through its Python class, one call per time step with the vessel's exact
  position, velocity and acceleration, as its documentation says; only these calls are timed.
- The top force is the reaction at the coupled point.
"""

from __future__ import annotations

import math
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.scenes import BenchmarkScene

DEPTH = 2000.0
"""Water depth [m]."""


@dataclass(frozen=True)
class Settings:
    """How CableDyn computes.

    elements: number of equal elements. time_step [s]. spectral_radius: of generalised alpha at
    high frequencies [-]. reuse: of the tangent within a step. newton: relative tolerance [-].
    """

    elements: int
    time_step: float
    spectral_radius: float = 0.4
    reuse: bool = False
    newton: float = 1e-8


def input_file(scene: BenchmarkScene, settings: Settings) -> str:
    """The deck of a scene: one line from the vessel (point 1) to a free or fixed point."""
    cable = scene.cable
    area = math.pi / 4.0 * cable.diameter**2
    gravity = cable.submerged_weight / (cable.mass - scene.water_density * area)
    if scene.anchor is None:
        # Hanging, stretched by its weight: a point that is not, has no static start.
        stretch = 0.5 * cable.submerged_weight * cable.length / cable.axial_stiffness
        kind, end = "Free", (0.0, 0.0, -cable.length * (1.0 + stretch))
    else:
        kind, end = "Fixed", scene.anchor
    bending = 0.0 if scene.anchor is None else cable.bending_stiffness
    return f"""CableDyn input file
---------------------- LINE TYPES ----------------------
TypeName Diam Mass/m EA BA EI Cd_n Cd_t Ca_n Ca_t
(name) (m) (kg/m) (N) (N-s/-) (N-m^2) (-) (-) (-) (-)
K {cable.diameter!r} {cable.mass!r} {cable.axial_stiffness!r} 0.0 {bending!r} \
{cable.drag_normal!r} {cable.drag_tangential!r} {cable.added_mass!r} 0.0
---------------------- POINTS ----------------------
ID Type X Y Z Mass Volume CdA Ca
(#) (-) (m) (m) (m) (kg) (m^3) (m^2) (-)
1 Coupled 0.0 0.0 {-scene.depth!r} 0 0 0 0
2 {kind} {end[0]!r} {end[1]!r} {end[2] - scene.depth!r} 0 0 0 0
---------------------- LINES ----------------------
ID NodeA NodeB Outputs
(#) (-) (-) (-)
1 1 2 -
---------------------- SECTIONS ----------------------
LineID LineType Length NumSegs
(#) (name) (m) (-)
1 K {cable.length!r} {settings.elements}
---------------------- OPTIONS ----------------------
{gravity!r} g
{scene.water_density!r} rhoW
{DEPTH!r} WtrDpth
{settings.spectral_radius!r} rhoInf
{settings.reuse} modified_newton
dynamic_solver {settings.newton!r} 1e-14 30 12
{settings.time_step!r} dtM
{settings.time_step!r} TMax
---------------------- OUTPUTS ----------------------
"FairTen1"
---------------------- need this line ----------------------
"""


class CableDynRunner:
    """One CableDyn model at its static start."""

    def __init__(self, scene: BenchmarkScene, times: Sequence[float], settings: Settings) -> None:
        from cabledyn.model import CableDyn

        if scene.start == "straight" or any(scene.start_velocity):
            raise ValueError(f"{scene.name}: CableDyn starts from statics at rest only")
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "line.dat"
            path.write_text(input_file(scene, settings))
            self._model: Any = CableDyn(path)
        self._elements = settings.elements
        self._probe = scene.probe
        self._length = scene.cable.length
        self._top = np.array([0.0, 0.0, -scene.depth])
        self._place = np.zeros(3)
        self._steps = 0
        self._plan = self._plan_inputs(scene, times, settings.time_step)

    def _plan_inputs(
        self, scene: BenchmarkScene, times: Sequence[float], time_step: float
    ) -> dict[float, tuple[float, list[tuple[Any, Any, Any]]]]:
        """Step [s] and inputs (position, velocity, acceleration) until each reference time."""
        layout = self._model.coupled_layout()
        mine = self._model.host_dofs()
        motion = self._model.get_coupled_motion()
        plan, before = {}, 0.0
        for until in times:
            count = max(1, round((until - before) / time_step))
            step = (until - before) / count
            inputs = []
            for k in range(1, count + 1):
                values = [np.array(part) for part in motion]
                instant = before + k * step
                for part, value in zip(values, _derivatives(scene, instant), strict=True):
                    part[mine] = value
                values[0][mine] += self._top
                inputs.append((values[0], values[1], values[2]))
            plan[until] = (step, inputs)
            before = until
        if layout[0][1] != "coupled":
            raise RuntimeError("CableDyn orders its points in another way than expected")
        return plan

    def advance(self, time: float) -> None:
        """Step to that time; it must be one of those given at the start."""
        dt, inputs = self._plan[time]
        step = self._model.step
        for position, velocity, acceleration in inputs:
            step(dt, position, velocity, acceleration)
        self._place = inputs[-1][0][:3]
        self._steps += len(inputs)

    def tip(self) -> NDArray[np.float64]:
        """The end, or the probe, relative to the vessel (3,) [m]."""
        nodes = np.asarray(self._model.lines[0].node_positions())
        nodes = nodes if nodes.shape[1] == 3 else nodes.T
        if self._probe is None:
            return np.asarray(nodes[-1] - self._place)
        if self._elements * self._probe / self._length % 1.0:
            raise ValueError(f"{self._elements} elements have no node at {self._probe} m")
        return np.asarray(nodes[round(self._elements * self._probe / self._length)] - self._place)

    def top_tension(self) -> float:
        """Magnitude of the reaction at the coupled point [N]."""
        return float(np.linalg.norm(self._model.calc_output()[:3]))

    def statistics(self) -> dict[str, float]:
        """Elements and steps."""
        return {"elements": float(self._elements), "steps": float(self._steps)}

    def close(self) -> None:
        """Free the model."""
        self._model.close()


def _derivatives(scene: BenchmarkScene, time: float) -> tuple[Any, Any, Any]:
    """Position [m], velocity [m/s], acceleration [m/s2] of the vessel, left limits at kinks.

    The motion is known as positions only: differences over a small interval that ends at ``time``
    where a kink follows, else around it; exact to round-off for the polynomials of the scenes.
    """
    h = 1e-3
    at = time - h if any(abs(time - kink) < h for kink in scene.kinks) else time
    left, middle, right = (np.array(scene.motion(at + k * h)) for k in (-1, 0, 1))
    acceleration = (left - 2.0 * middle + right) / h**2
    velocity = (right - left) / (2.0 * h) + (time - at) * acceleration
    return np.array(scene.motion(time)), velocity, acceleration
