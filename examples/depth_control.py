"""Hold the depth of a towed depressor by pay-out and speed: two controllers, compared.

The depressor of scenes/depressor_tow.yaml is to come up from 124 m to 110 m, and from 150 s on to
95 m, over a rise of the floor. A proportional controller pays out by the error in depth, at 10 Hz
and constant speed. A predictive one decides every two seconds: from a snapshot of the model it
tries 99 pairs of speed and pay-out rate, half a minute ahead, and takes the best.

    python examples/depth_control.py [FOLDER]

writes proportional.mcap, predictive.mcap and depth_control.png into FOLDER (or here); then
`cablemodel diff proportional.mcap predictive.mcap` says where they differ most. With --parallel
the 99 what-ifs of a decision are shared among processes.
"""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable, Iterable
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np

import cablemodel as cm
from cablemodel.model import Snapshot

SCENE = Path(__file__).resolve().parents[1] / "scenes" / "depressor_tow.yaml"
PERIOD, DECISION, AHEAD = 0.1, 2.0, 30.0  # [s]
SPEED, SLOWEST, FASTEST, FASTEST_WINCH = 2.0, 1.6, 2.4, 0.5  # [m/s]
GAIN = 0.1  # pay-out rate by error in depth [1/s]
CHOICES = [
    (float(speed), float(rate))
    for speed in np.linspace(SLOWEST, FASTEST, 9)
    for rate in np.linspace(-FASTEST_WINCH, FASTEST_WINCH, 11)
]

Choice = tuple[float, float]
"""Speed over ground and pay-out rate [m/s]."""


def wanted(time: float) -> float:
    """Depth that is asked for [m]."""
    return 110.0 if time < 150.0 else 95.0


def depth(model: cm.CableModel) -> float:
    """Depth of the depressor [m]."""
    return float(-model.bodies[-1].position[2])


def layback(model: cm.CableModel) -> float:
    """How far the line's end is behind the tow point, horizontally [m]."""
    return float(np.linalg.norm((model.vessel_position - model.tip_position)[:2]))


def proportional(model: cm.CableModel) -> Choice:
    error = wanted(model.time) - depth(model)
    return SPEED, float(np.clip(GAIN * error, -FASTEST_WINCH, FASTEST_WINCH))


class Predictive:
    """Takes the choice with the least cost ahead; all are tried from one snapshot."""

    def __init__(self, model: cm.CableModel, tried: Callable[..., Iterable[float]] = map) -> None:
        self._tried = tried
        self._choice: Choice = (SPEED, 0.0)
        self._next = model.time

    def __call__(self, model: cm.CableModel) -> Choice:
        if model.time >= self._next - 1e-9:
            snapshot, count = model.snapshot(), len(CHOICES)
            costs = self._tried(cost, [snapshot] * count, CHOICES, [self._choice] * count)
            self._choice = CHOICES[int(np.argmin(list(costs)))]
            self._next += DECISION
        return self._choice


_ahead: cm.CableModel | None = None
"""The model for what-ifs, one in each process: the one that is steered is left alone."""


def cost(snapshot: Snapshot, choice: Choice, before: Choice) -> float:
    """Of going on with a choice: errors in depth squared, another speed, a change of choice."""
    global _ahead
    if _ahead is None:
        _ahead = cm.CableModel(cm.load_scene(SCENE))
    speed, rate = choice
    _ahead.restore(snapshot)
    total = 300.0 * (speed - SPEED) ** 2
    total += 100.0 * (speed - before[0]) ** 2 + 50.0 * (rate - before[1]) ** 2
    try:
        for _ in range(6):
            _ahead.step(AHEAD / 6.0, vessel_velocity=(speed, 0.0, 0.0), payout_rate=rate)
            total += (depth(_ahead) - wanted(_ahead.time)) ** 2
    except cm.StepError:  # the model is as it was; this choice is none
        return math.inf
    return total


def control(
    controller: Callable[[cm.CableModel], Choice], model: cm.CableModel, log: Path, until: float
) -> cm.Run:
    """Steer a model to a time [s], recorded."""
    steps = round(until / PERIOD)
    with cm.Recorder(model, log, until=until) as recorder:
        for step in range(1, steps + 1):
            speed, rate = controller(model)
            end = step * PERIOD  # not a sum of steps, whose round-off grows
            try:
                recorder.step_to(end, vessel_velocity=(speed, 0.0, 0.0), payout_rate=rate)
            except cm.StepError as error:  # hold what it has rather than stop
                print(f"{error}; holding the speed, with the winch stopped")
                recorder.step_to(end, vessel_velocity=model.vessel_velocity, payout_rate=0.0)
    return recorder.run()


def plot(runs: dict[str, cm.Run], path: Path) -> None:
    import matplotlib.pyplot as plt

    figure, axes = plt.subplots(4, 1, sharex=True, figsize=(7, 7.5), layout="constrained")
    for name, run in runs.items():
        inputs = run.applied_inputs
        axes[0].plot(run.time, -run["bodies.position"][:, -1, 2], label=name)
        axes[1].plot(run.time, run.top_tension / 1e3)
        axes[2].plot(inputs["time"], inputs["vessel_velocity.x"])
        axes[3].plot(run.time, run["payout_rate"])
    time = next(iter(runs.values())).time
    axes[0].plot(time, [wanted(t) for t in time], "k:", label="wanted")
    axes[0].invert_yaxis()
    axes[0].legend()
    titles = ("depth [m]", "top tension [kN]", "speed [m/s]", "pay-out rate [m/s]")
    for axis, title in zip(axes, titles, strict=True):
        axis.set_ylabel(title)
        axis.grid(alpha=0.3)
    axes[-1].set_xlabel("time [s]")
    figure.savefig(path, dpi=120)


def main(folder: Path, until: float = 300.0, *, parallel: bool = False) -> dict[str, cm.Run]:
    scene = cm.load_scene(SCENE)
    first, second = cm.CableModel(scene), cm.CableModel(scene)
    runs = {"proportional": control(proportional, first, folder / "proportional.mcap", until)}
    predictive = folder / "predictive.mcap"
    if parallel:
        with ProcessPoolExecutor() as pool:
            controller = Predictive(second, lambda *a: pool.map(*a, chunksize=10))
            runs["predictive"] = control(controller, second, predictive, until)
    else:
        runs["predictive"] = control(Predictive(second), second, predictive, until)
    for (name, run), model in zip(runs.items(), (first, second), strict=True):
        error = -run["bodies.position"][:, -1, 2] - [wanted(time) for time in run.time]
        print(
            f"{name}: off by {np.sqrt(np.mean(error**2)):.2f} m rms, up to "
            f"{run.top_tension.max():.0f} N; in the end {depth(model):.2f} m deep, "
            f"{layback(model):.1f} m behind"
        )
    return runs


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", nargs="?", type=Path, default=Path())
    parser.add_argument("--parallel", action="store_true")
    arguments = parser.parse_args()
    found = main(arguments.folder, parallel=arguments.parallel)
    plot(found, arguments.folder / "depth_control.png")
