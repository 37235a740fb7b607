"""Draw the figures of docs/theory.md: python docs/draw_theory.py

They are the paper's figures 10 to 13 and 15 to 17, by the project's own runs: example 2 with its
data, example 3 and example 1 with assumed data.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib
import numpy as np

import cablemodel as cm
from tests.verification import direct_scenes as scenes

matplotlib.use("Agg")
from matplotlib import pyplot as plt

FOLDER = Path(__file__).parent / "images"
STYLE = {"elastica": "-", "hybrid": "--", "cable": ":"}
COLOUR = {"elastica": "C0", "hybrid": "C1", "cable": "C3"}


def save(figure: Any, name: str) -> None:
    figure.tight_layout()
    figure.savefig(FOLDER / name, dpi=90, pil_kwargs={"optimize": True})
    plt.close(figure)


def towed() -> None:
    """Figures 10 and 11: configurations from 0 to 160 s, tension at some times (elastica)."""
    model = cm.CableModel(scenes.towed("elastica"))
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.5, 3.6))
    for time in np.arange(0.0, 161.0, 4.0):
        if time:
            model.step_to(time)
        state = model.state()
        left.plot(state.position[:, 0], state.position[:, 2], "k", lw=0.6)
        if time in (0.0, 40.0, 60.0, 100.0, 152.0):
            right.plot(state.s, state.tension, label=f"{time:.0f} s")
    left.set(xlabel="x [m]", ylabel="z [m]", title="every 4 s from 0 to 160 s")
    left.set_aspect("equal")
    right.set(xlabel="s from the vessel [m]", ylabel="tension [N]", title="tension")
    right.legend()
    save(figure, "theory_towed.png")


def three_models() -> None:
    """Figures 12 and 13: configuration and tension of the three models at 60 s."""
    figure, axes = plt.subplots(1, 3, figsize=(9.5, 3.4))
    states = {}
    for name in STYLE:
        model = cm.CableModel(scenes.towed(name))
        model.step_to(60.0)
        state = states[name] = model.state()
        axes[0].plot(
            state.position[:, 0], state.position[:, 2], STYLE[name], color=COLOUR[name], label=name
        )
        axes[1].plot(state.s, state.tension, STYLE[name], color=COLOUR[name])
    stations = np.linspace(0.0, 30.0, 31)
    exact = states["elastica"]
    for name in ("hybrid", "cable"):
        state = states[name]
        apart = [
            1e3 * (np.interp(stations, state.s, state.position[:, i]) - exact.position[:, i])
            for i in (0, 2)
        ]
        axes[2].plot(stations, np.hypot(*apart), STYLE[name], color=COLOUR[name])
    axes[0].set(xlabel="x [m]", ylabel="z [m]", title="at 60 s")
    axes[0].set_aspect("equal")
    axes[0].legend()
    axes[1].set(xlabel="s [m]", ylabel="tension [N]")
    axes[2].set(xlabel="s [m]", ylabel="away from the elastica [mm]")
    save(figure, "theory_models.png")


def laid() -> None:
    """Figures 15 to 17: example 3, with assumed data, and its touchdown layer at 96 s."""
    model = cm.CableModel(scenes.laid(time_step=0.5, node_spacing=0.5))
    figure, axes = plt.subplots(2, 2, figsize=(9.5, 6.2))
    for time in np.arange(30.0, 125.1, 6.0):
        model.step_to(time)
        state = model.state()
        axes[0, 0].plot(state.position[:, 0], state.position[:, 2], "k", lw=0.6)
        body = model.bodies[0].position
        axes[0, 0].plot(body[0], body[2], "C3.", ms=5)
        if time == 96.0:
            end = model.line_length - model.floor_length
            layer = model.sample(np.linspace(end - 4.0, end, 300))
            axes[0, 1].plot(state.s, state.tension, "k")
            for axis, values, name in (
                (axes[1, 0], layer.tension, "tension [N]"),
                (axes[1, 1], layer.curvature, "curvature [1/m]"),
            ):
                axis.plot(end - layer.s, values, "k")
                axis.axhline(0.0, color="0.7", lw=0.8)
                axis.set(xlabel="s above the touchdown point [m]", ylabel=name)
            axes[1, 0].set_title(
                f"reaction at the touchdown point {model.touchdown_reaction:.2f} N"
            )
    axes[0, 0].axhline(-70.0, color="C0", lw=1.0)
    axes[0, 0].set(xlabel="x [m]", ylabel="z [m]", title="every 6 s from 30 to 120 s")
    axes[0, 0].set_aspect("equal")
    axes[0, 1].set(xlabel="s from the vessel [m]", ylabel="tension [N]", title="tension at 96 s")
    save(figure, "theory_laid.png")


def deployed() -> None:
    """Figures 7 and 8: example 1, with assumed data; where the flexible model ends."""
    model = cm.CableModel(scenes.deployed("elastica"))
    figure, axes = plt.subplots(1, 2, figsize=(9.5, 3.8))
    for time in np.arange(0.0, 201.0, 20.0):
        if time:
            model.step_to(time)
        p = model.state().position
        bodies = np.array([body.position for body in model.bodies])
        for axis, i, k in ((axes[0], 1, 0), (axes[1], 1, 2)):
            axis.plot(p[:, i], p[:, k], "k", lw=0.7)
            axis.plot(bodies[:, i], bodies[:, k], "C3.", ms=4)
    flexible = cm.CableModel(scenes.deployed("cable"))
    while True:
        try:
            flexible.step(0.5)
        except cm.StepError:
            break
    p = flexible.state().position
    for axis, i, k in ((axes[0], 1, 0), (axes[1], 1, 2)):
        axis.plot(p[:, i], p[:, k], "C0", lw=2.0, label=f"flexible: ends at {flexible.time:.1f} s")
        axis.set_aspect("equal")
        axis.set_xlabel("y [m]")
    axes[0].set(ylabel="x [m]", title="plan, every 20 s")
    axes[1].set(ylabel="z [m]", title="elevation")
    axes[0].legend()
    save(figure, "theory_deployed.png")


if __name__ == "__main__":
    towed()
    three_models()
    laid()
    deployed()
