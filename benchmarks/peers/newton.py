"""Newton (rods of its solver VBD, on the CPU, from PyPI) on the release in a vacuum (S2v).

What is like for like, and what is not:

- A rod is a chain of capsules whose joints stretch, shear, bend and twist; stiffnesses come from
  EA, EI, kGA and GJ over the distance of the joints. Shear and twist, which our cable has not, take
  no part: kGA = EA, GJ = EI. Mass and inertia are those of thin rods of the cable's mass. Its top
  hangs from the world by a ball joint. There are no contacts.
- Newton has no drag and no added mass: a force on each body would be a kernel of one's own, with
  explicit forces, and added mass differs by direction. Hence the vacuum.
- VBD is a scheme of first order with single precision, and sweeps over the bodies a fixed number
  of times a step: too few sweeps make the rod softer. Of its solvers none else takes rods.
- Only its steps are timed. It tells no force of a joint: that in the top is the change of the
  momentum in the last two steps.
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
    """How Newton computes: number of capsules, time step [s], sweeps a step."""

    segments: int
    time_step: float
    sweeps: int


class NewtonRunner:
    """One Newton rod at the scene's start."""

    def __init__(self, scene: BenchmarkScene, times: Sequence[float], settings: Settings) -> None:
        import newton
        import warp

        if scene.water_density != 0.0 or scene.start != "straight":
            raise ValueError(f"{scene.name}: Newton has no drag and no added mass")
        warp.config.quiet = True
        cable, count = scene.cable, settings.segments
        length = cable.length / count
        builder = newton.ModelBuilder(gravity=(0.0, 0.0, -GRAVITY))
        rod = newton.Rod.create_straight(
            start=warp.vec3(0.0, 0.0, 0.0),
            direction=warp.vec3(1.0, 0.0, 0.0),
            length=cable.length,
            segment_count=count,
            radius=0.5 * cable.diameter,
            stretch_rigidity=cable.axial_stiffness,
            shear_rigidity=cable.axial_stiffness,
            bend_rigidity=cable.bending_stiffness,
            twist_rigidity=cable.bending_stiffness,
        )
        bodies, joints = builder.add_rod(rod=rod, wrap_in_articulation=False)
        mass = cable.mass * length
        across = mass * length**2 / 12.0
        for body in bodies:
            builder.body_mass[body] = mass
            builder.body_inv_mass[body] = 1.0 / mass
            builder.body_inertia[body] = warp.mat33(np.diag([across, across, 0.1 * across]))
            builder.body_inv_inertia[body] = warp.inverse(builder.body_inertia[body])
        held = builder.add_joint_ball(
            parent=-1,
            child=bodies[0],
            child_xform=warp.transform((0.0, 0.0, -0.5 * length), warp.quat_identity()),
        )
        builder.add_articulation([*joints, held])
        builder.color()
        self._model: Any = builder.finalize(device="cpu")
        self._states = [self._model.state(), self._model.state()]
        self._control = self._model.control()
        self._mass, self._settings, self._half = mass, settings, 0.5 * length
        self._counts = {t: round(t / settings.time_step) for t in times}
        whole = (
            n % 2 == 0 and abs(n * settings.time_step - t) < 1e-9 for t, n in self._counts.items()
        )
        if not all(whole):
            raise ValueError(f"pairs of {settings.time_step} s do not divide the instants {times}")
        self._steps = 0

        def begin() -> None:
            self._states = [self._model.state(), self._model.state()]
            self._solver: Any = newton.solvers.SolverVBD(
                self._model,
                iterations=settings.sweeps,
                rigid_joint_linear_ke=cable.axial_stiffness / length,
            )

        # Two steps, recorded once, are launched as one: a thirtieth of the cost from Python.
        begin()
        self._pair()  # loads what is needed, and leaves its history in the solver
        begin()
        with warp.ScopedCapture(device="cpu") as recorded:
            self._pair()
        self._graph, self._launch = recorded.graph, warp.capture_launch
        self._before = self._states[0].body_qd.numpy().copy()

    def _pair(self) -> None:
        """Two steps: the first state is the newest again."""
        one, two = self._states
        for now, after in ((one, two), (two, one)):
            self._solver.step(now, after, self._control, None, self._settings.time_step)

    def advance(self, time: float) -> None:
        """Step to that time; it must be one of those given at the start."""
        for _ in range((self._counts[time] - self._steps) // 2 - 1):
            self._launch(self._graph)
        self._before = self._states[0].body_qd.numpy().copy()
        self._launch(self._graph)
        self._steps = self._counts[time]

    def tip(self) -> NDArray[np.float64]:
        """Free end relative to the vessel (3,) [m]."""
        x, y, z, *quaternion = self._states[0].body_q.numpy()[-1].astype(float)
        i, j, k, w = quaternion
        axis = [2.0 * (i * k + w * j), 2.0 * (j * k - w * i), 1.0 - 2.0 * (i * i + j * j)]
        return np.array([x, y, z]) + self._half * np.array(axis)

    def top_tension(self) -> float:
        """Magnitude of the force that holds the top [N]."""
        gained = (self._states[0].body_qd.numpy() - self._before)[:, :3].astype(float).sum(axis=0)
        force = self._mass * gained / (2.0 * self._settings.time_step)
        force[2] += self._mass * self._settings.segments * GRAVITY
        return float(np.linalg.norm(force))

    def statistics(self) -> dict[str, float]:
        """Capsules and steps."""
        return {"elements": float(self._settings.segments), "steps": float(self._steps)}

    def close(self) -> None:
        """Nothing to free."""
