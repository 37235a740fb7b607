"""A stand-in for the engine: a straight cable that swings like a pendulum, in closed form.

Logs, runs and the command line are tested against it for what they do with values; it makes every
output of the table, with numbers that no rounding survives unnoticed.
"""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cablemodel.errors import StepError
from cablemodel.model import CableModel, CableState
from cablemodel.scene import Scene, load_scene

CABLE_TYPE = {
    "diameter": 0.01666,
    "mass": 0.4613,
    "submerged_weight": 2.33333,
    "axial_stiffness": 1.0e6,
    "bending_stiffness": 0.1,
    "drag_normal": 1.0,
    "drag_tangential": 0.1586,
    "added_mass": 1.0,
}

SIMPLE: dict[str, Any] = {
    "title": "Pendulum",
    "cable_types": {"K": CABLE_TYPE},
    "line": [{"cable": {"type": "K", "length": 30, "model": "elastica"}}],
    "end": "free",
    "vessel": {"velocity": [{"t": 0, "velocity": [0, 0, 0]}, {"t": 30, "velocity": [0.8, 0, 0]}]},
    "run": {"duration": 10, "output_interval": 0.3},
}

BODY = {
    "mass": 6, "submerged_weight": 20, "half_length": 0, "centre_offset": 0, "rotary_inertia": 0,
    "added_mass": 2, "added_mass_axial": 2, "drag_area": 0.03, "drag_coefficient": 0.6,
    "drag_area_axial": 0.03, "drag_coefficient_axial": 0.6,
}  # fmt: skip

FULL: dict[str, Any] = {
    **SIMPLE,
    "title": "Everything",
    "environment": {"floor": {"z": -70, "friction": 0.3}},
    "line": [
        {"cable": {"type": "K", "length": 10}},
        {"body": BODY},
        {"cable": {"type": "K", "length": 20}},
        {"body": BODY},
    ],
    "payout": {
        "rate": [{"t": 0, "rate": 0}, {"t": 1, "rate": 0.1}],
        "drum": [{"cable": {"type": "K", "length": 50}}],
    },
    "solver": {"error_estimate": True},
}


class SwingingCable:
    """The interface of CableModel with the motion of a stiff pendulum of 60 degrees.

    ``fail_at`` makes the step that would pass that time fail; ``nodes`` may be a function of time.
    """

    def __init__(self, scene: Scene, nodes: Any = 9, fail_at: float = math.inf) -> None:
        self.scene = scene
        self.time = 0.0
        self._nodes = nodes if callable(nodes) else lambda time: nodes
        self._fail_at = fail_at
        self._steps = 0
        self.applied_inputs: dict[str, Any] = {}

    def step(
        self, dt: float, vessel_velocity: Any = None, vessel_position: Any = None,
        payout_rate: float | None = None, current: Any = None,
    ) -> None:  # fmt: skip
        self.step_to(
            self.time + dt,
            vessel_velocity,
            vessel_position,
            payout_rate=payout_rate,
            current=current,
        )

    def step_to(
        self, time: float, vessel_velocity: Any = None, vessel_position: Any = None,
        payout_rate: float | None = None, current: Any = None,
    ) -> None:  # fmt: skip
        if time > self._fail_at:
            raise StepError("no convergence", time=self.time, arc_length=3.0, advice="try less")
        self.time = time
        self._steps += 1
        given = vessel_velocity is not None
        self.applied_inputs = {
            "vessel_position": self._swing(0.0)[0],
            "vessel_velocity": np.asarray(vessel_velocity) if given else self.vessel_velocity,
            "payout_rate": self.payout_rate if payout_rate is None else payout_rate,
            "current": current,
        }

    def numbers(self) -> SwingingCable:
        return self

    def _angle(self) -> tuple[float, float]:
        rate = math.sqrt(9.81 / 30)
        return math.cos(rate * self.time) * math.pi / 3, -rate * math.sin(rate * self.time)

    def _swing(self, s: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Position, tangent and velocity at arc lengths s."""
        angle, rate = self._angle()
        s = np.asarray(s, float)[..., None]
        down = np.array([math.sin(angle), 0.1 / 3, -math.cos(angle)])
        tangent = down / np.linalg.norm(down)
        across = np.array([math.cos(angle), 0.0, math.sin(angle)])
        return s * tangent, tangent + 0 * s, s * rate * across

    def state(self) -> CableState:
        return self.sample(np.linspace(0.0, self.line_length, self._nodes(self.time)))

    def sample(self, s: Any) -> CableState:
        s = np.asarray(s, float)
        position, tangent, velocity = self._swing(s)
        tension = 70.0 + math.pi * (self.line_length - s) + math.sin(self.time)
        curvature = 1e-3 * (1 + np.sin(s + self.time))
        on_floor = (s > 25.0) & (self.time > 1.0)
        return CableState(
            self.time, s, position, tangent, velocity, tension, curvature, 0.1 * curvature, on_floor
        )

    @property
    def top_tension(self) -> float:
        return float(self.state().tension[0])

    @property
    def tension_min(self) -> float:
        return float(self.state().tension.min())

    @property
    def tension_max(self) -> float:
        return float(self.state().tension.max())

    @property
    def slack_time(self) -> float:
        """Of the second half of every second."""
        return 0.5 * math.floor(self.time) + max(0.0, self.time % 1.0 - 0.5)

    @property
    def slack_longest(self) -> float:
        return min(0.5, self.slack_time)

    @property
    def slack_since(self) -> float:
        return math.floor(self.time - 0.5) + 0.5 if self.time >= 0.5 else math.nan

    @property
    def slack_start(self) -> float:
        return math.pi if self.time >= 0.5 else math.nan

    @property
    def slack_end(self) -> float:
        return 7.0 * math.pi if self.time >= 0.5 else math.nan

    @property
    def top_force(self) -> np.ndarray:
        return self.top_tension * self.state().tangent[0]

    @property
    def top_moment(self) -> np.ndarray:
        return np.array([0.1, 1 / 3, math.sin(self.time)])

    @property
    def tip_position(self) -> np.ndarray:
        return self.state().position[-1]

    @property
    def tip_velocity(self) -> np.ndarray:
        return self.state().velocity[-1]

    @property
    def vessel_velocity(self) -> np.ndarray:
        return np.array([0.8 * min(self.time / 30.0, 1.0), 0.0, 0.0])

    @property
    def bodies(self) -> list[Any]:
        found = []
        for s, body in ((10.0, 1), (30.0, 2)):
            position, tangent, velocity = self._swing(s)
            found.append(
                SimpleNamespace(
                    name=f"body {body}", position=position, direction=tangent, velocity=velocity
                )
            )
        return found

    @property
    def payout_rate(self) -> float:
        return 0.1 if self.scene.payout is not None and self.scene.payout.drum else 0.0

    @property
    def line_length(self) -> float:
        return 30.0 + self.payout_rate * self.time

    @property
    def drum_length(self) -> float:
        return 50.0 - self.payout_rate * self.time

    @property
    def touchdown_position(self) -> np.ndarray:
        return np.array([self.time / 3, math.nan if self.time < 1 else 2.0, -70.0])

    @property
    def touchdown_reaction(self) -> float:
        return math.exp(-self.time)

    @property
    def position_error(self) -> float:
        return 1e-3 * self.time

    @property
    def tension_error(self) -> float:
        return 2.0 - math.exp(-self.time)

    @property
    def floor_force(self) -> np.ndarray:
        return np.array([0.1, 0.2, self.time / 7])

    @property
    def floor_length(self) -> float:
        return self.time / 11

    @property
    def statistics(self) -> dict[str, Any]:
        return {
            "steps": self._steps, "rejected": 1, "factorisations": np.int64(2),
            "iterations": 3 * self._steps, "elements": 8,
        }  # fmt: skip


@pytest.fixture(autouse=True, scope="session")
def compiled_engine() -> None:
    """Compile before the first test, so that no command says that it takes long to start."""
    model = CableModel(load_scene(SIMPLE))
    model.step(0.1)
    model.state()


@pytest.fixture
def simple_scene() -> Scene:
    return load_scene(SIMPLE)


@pytest.fixture
def full_scene() -> Scene:
    return load_scene(FULL)


@pytest.fixture
def swinging_cable() -> type[SwingingCable]:
    return SwingingCable
