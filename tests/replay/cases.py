"""The golden logs: what each one is there for, and how it is made.

A golden log is a run that was looked at once and is replayed by every test run since: on the engine
that made it to the last bit, on a changed one within the tolerance of its scene. `make golden`
makes all of them anew, after a change that is meant to change results; look at what
`cablemodel diff` says of old and new before committing them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cablemodel.model import CableModel
from cablemodel.results.log.writer import LogWriter
from cablemodel.scene import load_scene

FOLDER = Path(__file__).parent / "golden"
EPOCH = 1_700_000_000_000_000_000
LARGEST = 100_000
"""Bytes of a golden log at most."""

CABLE = {
    "diameter": 0.01666, "mass": 0.4613, "submerged_weight": 2.33333, "axial_stiffness": 1.0e6,
    "bending_stiffness": 0.1, "drag_normal": 1.0, "drag_tangential": 0.1586, "added_mass": 1.0,
}  # fmt: skip

BODY = {
    "mass": 6, "submerged_weight": 20, "added_mass": 2, "added_mass_axial": 2, "drag_area": 0.03,
    "drag_coefficient": 0.6, "drag_area_axial": 0.03, "drag_coefficient_axial": 0.6,
}  # fmt: skip

Step = tuple[float, dict[str, Any]]
"""The end of a step [s], and the inputs that its caller gives."""


@dataclass(frozen=True)
class Case:
    """One golden log."""

    name: str
    reason: str
    scene: dict[str, Any]
    steps: Callable[[], Iterator[Step]]
    outputs: int
    """Every how many steps there is an output."""
    states: int = 1
    """Every how many outputs there is an exact state."""

    @property
    def path(self) -> Path:
        return FOLDER / f"{self.name}.mcap"

    def make(self, path: Path | None = None) -> Path:
        """Run it and write its log, to the golden one by default; gives the path."""
        path = path or self.path
        scene = load_scene({"title": self.name.replace("_", " "), **self.scene})
        model = CableModel(scene)
        with LogWriter(path, scene, epoch=EPOCH) as writer:
            writer.write_outputs(model)
            for k, (end, inputs) in enumerate(self.steps(), 1):
                step = end - model.time
                model.step_to(end, **inputs)
                writer.write_step(model, step, given=inputs)
                if k % self.outputs == 0:
                    exact = k % (self.outputs * self.states) == 0
                    writer.write_outputs(model, exact_state=exact, shape=exact)
            writer.close(model.statistics)
        return path


def even(step: float, count: int) -> Callable[[], Iterator[Step]]:
    """Steps of one length, all inputs from the scene."""
    return lambda: ((step * k, {}) for k in range(1, count + 1))


def steered() -> Iterator[Step]:
    """A pilot's hand: steps from a millisecond to a second; velocity, position and current come
    and go. The positions given are the integral of the velocities, as an observer has them."""
    random = np.random.default_rng(1998)
    time, velocity = 0.0, np.array([0.8, 0.0, 0.0])
    position = np.zeros(3)
    for k in range(160):
        step = float(10.0 ** random.uniform(-3.0, 0.0))
        time += step
        heading = 0.08 * time
        now = np.array([0.8 * np.cos(heading), 0.8 * np.sin(heading), 0.1 * np.sin(time)])
        position = position + 0.5 * step * (velocity + now)
        velocity = now
        inputs: dict[str, Any] = {"vessel_velocity": velocity.tolist()}
        if k % 4 == 3:
            inputs["vessel_position"] = position.tolist()
        if 60 <= k < 120:
            inputs["current"] = [0.0, 0.2, 0.0]
        yield time, inputs


CASES = (
    Case(
        "tow",
        "The plainest run: static start, a vessel that gets under way, all of it in one plane. If "
        "this one differs, something basic does.",
        {
            "cable_types": {"K": CABLE},
            "line": [{"cable": {"type": "K", "length": 30, "model": "elastica"}}],
            "vessel": {
                "velocity": [
                    {"t": 0, "velocity": [0, 0, 0]},
                    {"t": 30, "velocity": [0.8, 0, 0]},
                ]
            },
        },
        even(2.5, 24),
        outputs=1,
    ),
    Case(
        "turn_steered",
        "Three dimensions, driven by its caller in uneven steps of 1 ms to 1 s with velocities, "
        "positions and currents that come and go, as a ROS 2 node or an FMU drives it.",
        {
            "cable_types": {"K": CABLE},
            "line": [{"cable": {"type": "K", "length": 30, "model": "elastica"}}],
            "vessel": {"velocity": [{"t": 0, "velocity": [0.8, 0, 0]}]},
        },
        steered,
        outputs=4,
        states=2,
    ),
    Case(
        "pay_out_and_reel_in",
        "Cable and two bodies come off the drum, and go back onto it: elements and bodies are made "
        "and taken away at the tow point, and the mesh there moves.",
        {
            "cable_types": {"K": CABLE},
            "line": [{"cable": {"type": "K", "length": 10}}, {"body": {"name": "probe", **BODY}}],
            "vessel": {"velocity": [{"t": 0, "velocity": [0.5, 0, 0]}]},
            "payout": {
                "rate": [
                    {"t": 0, "rate": 0}, {"t": 2, "rate": 0.6}, {"t": 22, "rate": 0.6},
                    {"t": 26, "rate": -1.4},
                ],
                "drum": [
                    {"cable": {"type": "K", "length": 2}}, {"body": {"name": "lower", **BODY}},
                    {"cable": {"type": "K", "length": 4}}, {"body": {"name": "upper", **BODY}},
                    {"cable": {"type": "K", "length": 20}},
                ],
            },
        },
        even(1.0, 32),
        outputs=1,
        states=2,
    ),
    Case(
        "release_from_zero_tension",
        "No tension anywhere at the start, where the equations of a flexible cable are singular: "
        "bending and inertia carry it over.",
        {
            "cable_types": {"K": CABLE},
            "line": [{"cable": {"type": "K", "length": 10, "model": "elastica"}}],
            "initial": {"straight": [1, 0, 0]},
        },
        even(0.1, 40),
        outputs=1,
        states=2,
    ),
    Case(
        "current_over_depth",
        "A current that turns and changes over depth and time, on a hybrid of two cable types from "
        "vessel to anchor: tables, joints, and a far end that is held.",
        {
            "environment": {
                "current": {
                    "table": [
                        {"t": 0, "z": -40, "velocity": [0, 0, 0]},
                        {"t": 0, "z": 0, "velocity": [0.4, 0, 0]},
                        {"t": 30, "z": -40, "velocity": [0, 0.1, 0]},
                        {"t": 30, "z": 0, "velocity": [0.3, 0.4, 0]},
                    ]
                }
            },
            "cable_types": {"K": CABLE, "heavy": {**CABLE, "mass": 1.2, "submerged_weight": 9.0}},
            "line": [
                {"cable": {"type": "K", "length": 35}},
                {"cable": {"type": "heavy", "length": 15, "model": "cable"}},
            ],
            "end": {"anchor": [20, 5, -40]},
        },
        even(1.0, 32),
        outputs=1,
        states=2,
    ),
)  # fmt: skip
