"""Hold a towed body's depth and the top tension through a turn: model predictive control.

A vessel tows the depressor of scenes/depressor_tow.yaml at 4 knots and turns by 180 degrees on a
circle of 150 m radius. Left alone the body cuts the corner, slows down and sinks by 75 m. Every
three seconds the controller looks 75 s ahead. What happens with the speed and the pay-out rate of
now it takes from the model itself, a copy that runs ahead; what changes of both would do, from the
linear model of the present state (`CableModel.linearise`). The best changes are the solution of a
bounded least-squares problem; their first part is done.

    python examples/mpc_turn.py [FOLDER]

prints how far depth and tension are off in both turns and how much faster than real time control
and simulation were, and writes mpc_turn.png into FOLDER (or here).
"""

from __future__ import annotations

import argparse
import os
import time
from dataclasses import dataclass, field
from pathlib import Path

# Matrices of 160 rows are multiplied faster by one thread than by several that wait for each other.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import toeplitz
from scipy.optimize import lsq_linear

import cablemodel as cm

FloatArray = NDArray[np.float64]

SCENE = Path(__file__).resolve().parents[1] / "scenes" / "depressor_tow.yaml"
RADIUS, BEFORE = 150.0, 60.0  # of the turn, and of the way to it [m]
PERIOD, AHEAD, PARTS = 3.0, 25, 3  # of a decision [s]; how many are foreseen; steps in each
SLOWEST, FASTEST, FASTEST_WINCH = 1.5, 2.6, 0.4  # [m/s]
DEPTH, TENSION = 1.0, 40.0  # what counts as an error of one [m, N]
SPEED_CHANGE, RATE_CHANGE = 0.04, 0.1  # what counts as one of a change from step to step [m/s]
OTHER_SPEED, OTHER_LENGTH = 2.0, 20.0  # the same of another speed or length than at first [m/s, m]
WATCHED = ("tip_position.z", "top_tension")


@dataclass
class Vessel:
    """A tow point on its way: straight, half round to port, straight."""

    speed: float
    rate: float = 0.0
    along: float = 0.0
    """Way made good [m]."""

    @property
    def heading(self) -> FloatArray:
        angle = np.clip((self.along - BEFORE) / RADIUS, 0.0, np.pi)
        return np.array([np.cos(angle), np.sin(angle), 0.0])

    def go_on(self, model: cm.CableModel, speed: float, rate: float) -> None:
        """One period, at the end of which speed and pay-out rate are these."""
        speeds = np.linspace(self.speed, speed, PARTS + 1)
        rates = np.linspace(self.rate, rate, PARTS + 1)
        for part in range(PARTS):
            self.along += PERIOD / PARTS * 0.5 * (speeds[part] + speeds[part + 1])
            velocity = speeds[part + 1] * self.heading
            model.step(PERIOD / PARTS, vessel_velocity=velocity, payout_rate=rates[part + 1])
        self.speed, self.rate = speed, rate

    def copy(self) -> Vessel:
        return Vessel(self.speed, self.rate, self.along)


class Controller:
    """Speed and pay-out rate by what is foreseen."""

    def __init__(self, model: cm.CableModel, speed: float) -> None:
        self._ahead = cm.CableModel(model.scene)
        self._wanted = seen(model)
        self._speed, self._length = speed, model.line_length
        ones = np.ones(AHEAD)
        self._change = np.eye(AHEAD) - np.eye(AHEAD, k=-1)
        self._sum = PERIOD * (np.tril(np.outer(ones, ones)) - 0.5 * np.eye(AHEAD))

    def __call__(self, model: cm.CableModel, vessel: Vessel) -> tuple[float, float]:
        free = self._foresee(model, vessel)
        of_speed, of_rate = self._answers(model, vessel)
        scale = np.array([DEPTH, TENSION])
        rows, right = [], []
        for output in range(2):
            response = np.column_stack([of_speed[output], of_rate[output]])
            rows.append(response / scale[output])
            right.append((self._wanted[output] - free[:, output]) / scale[output])
        none = np.zeros((AHEAD, AHEAD))
        rows += [
            np.column_stack([self._change / SPEED_CHANGE, none]),
            np.column_stack([none, self._change / RATE_CHANGE]),
            np.column_stack([np.eye(AHEAD) / OTHER_SPEED, none]),
            np.column_stack([none, self._sum / OTHER_LENGTH]),
        ]
        went_on = vessel.rate * PERIOD * np.arange(1, AHEAD + 1)
        right += [
            np.zeros(AHEAD),
            np.zeros(AHEAD),
            np.full(AHEAD, (self._speed - vessel.speed) / OTHER_SPEED),
            (self._length - model.line_length - went_on) / OTHER_LENGTH,
        ]
        low = np.repeat([SLOWEST - vessel.speed, -FASTEST_WINCH - vessel.rate], AHEAD)
        high = np.repeat([FASTEST - vessel.speed, FASTEST_WINCH - vessel.rate], AHEAD)
        found = lsq_linear(np.vstack(rows), np.concatenate(right), (low, high), method="bvls").x
        return vessel.speed + found[0], vessel.rate + found[AHEAD]

    def _foresee(self, model: cm.CableModel, vessel: Vessel) -> FloatArray:
        """Depth and tension with speed and pay-out rate as they are, (AHEAD, 2)."""
        ahead, other = self._ahead, vessel.copy()
        ahead.restore(model.snapshot())
        free = np.empty((AHEAD, 2))
        for k in range(AHEAD):
            other.go_on(ahead, vessel.speed, vessel.rate)
            free[k] = seen(ahead)
        return free

    def _answers(self, model: cm.CableModel, vessel: Vessel) -> tuple[FloatArray, FloatArray]:
        """What speeds and pay-out rates do to depth and tension, (2, AHEAD, AHEAD) each."""
        drives = ("vessel_acceleration.x", "vessel_acceleration.y", "payout_acceleration")
        linear = model.linearise().only(drives, WATCHED)
        _free, pulse = linear.reduced(12).discrete(PERIOD).responses(AHEAD)
        pulse[:, 0] *= -1.0  # depth
        of_speed = pulse[:, :, :2] @ vessel.heading[:2]
        none = np.zeros(AHEAD)
        speed, rate = (
            np.array([toeplitz(column, none) for column in of.T])
            for of in (of_speed, pulse[:, :, 2])
        )
        return speed, rate


@dataclass
class Record:
    """What happened in a turn: rows of time, depth, tension, speed, pay-out rate; the way."""

    rows: list[list[float]] = field(default_factory=list)
    places: list[list[float]] = field(default_factory=list)
    seconds: float = 0.0

    def add(self, model: cm.CableModel, vessel: Vessel) -> None:
        self.rows.append([model.time, *seen(model), vessel.speed, model.payout_rate])
        self.places.append([*model.vessel_position[:2], *model.tip_position[:2]])


def seen(model: cm.CableModel) -> FloatArray:
    """Depth of the far end [m] and top tension [N]."""
    return np.array([-model.tip_position[2], model.top_tension])


def turn(until: float, *, controlled: bool) -> Record:
    """A turn to a time [s]."""
    model = cm.CableModel(cm.load_scene(SCENE))
    speed = float(np.linalg.norm(model.vessel_velocity))
    vessel, record = Vessel(speed), Record()
    controller = Controller(model, speed)
    record.add(model, vessel)
    begin = time.perf_counter()
    while model.time < until - 0.5 * PERIOD:
        choice = controller(model, vessel) if controlled else (speed, 0.0)
        vessel.go_on(model, *choice)
        record.add(model, vessel)
    record.seconds = time.perf_counter() - begin
    return record


def main(until: float = 600.0) -> dict[str, Record]:
    records = {
        "left alone": turn(until, controlled=False),
        "controlled": turn(until, controlled=True),
    }
    for name, record in records.items():
        off = np.array(record.rows)[:, 1:3] - record.rows[0][1:3]
        worst, mean = np.abs(off).max(axis=0), np.sqrt(np.mean(off**2, axis=0))
        print(
            f"{name}: depth off by {worst[0]:.2f} m at most, {mean[0]:.2f} m rms; tension by "
            f"{worst[1]:.0f} N, {mean[1]:.0f} N rms; {until / record.seconds:.0f} times real time"
        )
    return records


def plot(records: dict[str, Record], path: Path) -> None:
    import matplotlib.pyplot as plt

    figure, panels = plt.subplot_mosaic(
        [["way", "depth"], ["way", "tension"], ["speed", "rate"]],
        figsize=(9, 7.5),
        layout="constrained",
    )
    for number, (name, record) in enumerate(records.items()):
        rows, places, colour = np.array(record.rows), np.array(record.places), f"C{number}"
        panels["way"].plot(places[:, 2], places[:, 3], colour, label=f"body, {name}")
        if number == 0:
            panels["way"].plot(places[:, 0], places[:, 1], "k:", label="tow point")
        for column, panel in enumerate(("depth", "tension", "speed", "rate"), start=1):
            scale = 1e-3 if panel == "tension" else 1.0
            panels[panel].plot(rows[:, 0], scale * rows[:, column], colour, label=name)
    panels["way"].set(xlabel="x [m]", ylabel="y [m]", aspect="equal")
    panels["depth"].invert_yaxis()
    labels = {
        "depth": "depth [m]",
        "tension": "top tension [kN]",
        "speed": "speed [m/s]",
        "rate": "pay-out rate [m/s]",
    }
    for panel, label in labels.items():
        panels[panel].set(ylabel=label, xlabel="time [s]")
        panels[panel].grid(alpha=0.3)
    panels["way"].legend(loc="best")
    panels["depth"].legend()
    figure.savefig(path, dpi=120)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", nargs="?", type=Path, default=Path())
    arguments = parser.parse_args()
    plot(main(), arguments.folder / "mpc_turn.png")
