"""Steps, tolerances and spacings of the 1998 method on the paper's examples, judged by the finite
elements: what completes, what is refused, and whether any state that was taken over is wrong.
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

import cablemodel as cm

SCENES = Path(__file__).parents[1] / "scenes"
STEPS = (0.25, 0.5, 1.0, 2.0)
TOLERANCES = (1e-2, 1e-4, 1e-6, 1e-8)
MODELS = ("cable", "hybrid", "elastica")
WRONG = 0.05
"""Of the largest tension, or of the length of the line: an error that no step length explains."""

Floats = NDArray[np.float64]
Table = tuple[list[str], list[list[str]]]
"""The head of a data file, and its rows."""


@dataclass(frozen=True)
class Example:
    """A scene of the survey, compared every 5 s until its end."""

    name: str
    make: Callable[..., cm.Scene]
    end: float
    tolerance: float
    """Of the finite elements."""
    models: tuple[str, ...] = MODELS

    @property
    def times(self) -> Floats:
        return np.arange(5.0, self.end + 0.1, 5.0)


def deployed(model: str, **settings: Any) -> cm.Scene:
    """Example 1 with point bodies: the finite elements have no others on the drum."""
    data = cm.load_scene(SCENES / "example_1_deployment.yaml").to_dict()
    for item in (*data["line"], *data["payout"]["drum"]):
        if item.get("body"):
            item["body"] |= {"half_length": 0.0, "rotary_inertia": 0.0}
    return changed(data, model, settings)


def towed(model: str, **settings: Any) -> cm.Scene:
    """Example 2."""
    data = cm.load_scene(SCENES / "example_2_tow.yaml").to_dict()
    return changed(data, model, settings)


def laid(model: str, **settings: Any) -> cm.Scene:
    """Example 3; its last cable bends in any case."""
    data = cm.load_scene(SCENES / "example_3_touchdown.yaml").to_dict()
    scene = changed(data, model, settings).to_dict()
    if model == "cable":
        scene["line"][-1]["cable"]["model"] = "hybrid"
    return cm.load_scene(scene)


def changed(data: dict[str, Any], model: str, settings: dict[str, Any]) -> cm.Scene:
    """A scene with another model of all cables and other settings of the method."""
    for item in (*data["line"], *data["payout"]["drum"]):
        if item.get("cable"):
            item["cable"]["model"] = model
    data["solver"] |= settings
    return cm.load_scene(data)


EXAMPLES = (
    Example("1, 0.5 m", functools.partial(deployed, node_spacing=0.5), 200.0, 1e-5),
    Example("2", towed, 200.0, 1e-4),
    Example("3, 0.5 m", laid, 125.0, 1e-3),
    Example("S3, 1 m", functools.partial(laid, node_spacing=1.0), 125.0, 1e-3),
)


def by_finite_elements(scene: cm.Scene, tolerance: float) -> cm.CableModel:
    """The same scene with the other method."""
    data = scene.to_dict()
    data["solver"] = {"tolerance": tolerance}
    return cm.CableModel(cm.load_scene(data))


def seen(model: cm.CableModel) -> Floats:
    """Top tension; places of the end (on a floor, of the touchdown) and of the first body."""
    end = model.touchdown_position if model.floor_length > 0.0 else model.tip_position
    bodies = model.bodies
    first = bodies[0].position if bodies else end
    away = [place - model.vessel_position for place in (end, first)]
    return np.array([model.top_tension, *away[0], *away[1]])


def history(model: cm.CableModel, times: Floats) -> tuple[Floats, float]:
    """What is seen at the times that are reached, and the time of a refusal (else the last)."""
    rows = []
    for time in times:
        try:
            model.step_to(time)
        except cm.StepError:
            return np.array(rows), model.time
        rows.append(seen(model))
    return np.array(rows), float(times[-1])


def errors(found: Floats, reference: Floats, length: float) -> tuple[float, float]:
    """Largest error of the tension over its largest value, and of places over the length."""
    common = min(len(found), len(reference))
    found, reference = found[:common], reference[:common]
    pull = float(np.abs(found[:, 0] - reference[:, 0]).max() / reference[:, 0].max())
    places = (found - reference)[:, 1:].reshape(-1, 3)
    return pull, float(np.linalg.norm(places, axis=1).max() / length)


def survey() -> Table:
    """A row for each example, model and time step, over all tolerances."""
    rows = []
    for example, model in itertools.product(EXAMPLES, MODELS):
        reference_model = by_finite_elements(example.make(model), example.tolerance)
        reference, known = history(reference_model, example.times)
        for step in STEPS:
            completed, wrong, refusals, pulls, places = 0, 0, [], [], []
            for tolerance in TOLERANCES:
                scene = example.make(model, time_step=step, relative_tolerance=tolerance)
                found, reached = history(cm.CableModel(scene), example.times)
                if reached == example.end:
                    completed += 1
                else:
                    refusals.append(reached)
                pull, place = errors(found, reference, reference_model.line_length)
                pulls.append(pull)
                places.append(place)
                wrong += max(pull, place) > WRONG
            rows.append(
                [
                    example.name,
                    model,
                    f"{step:g}",
                    str(completed),
                    f"{min(refusals):.0f}" if refusals else "",
                    f"{known:.0f}",
                    f"{100 * max(pulls):.2f}",
                    f"{100 * max(places):.2f}",
                    str(wrong),
                ]
            )
    heads = ["example", "model", "dt [s]", "completed", "first refused at [s]"]
    heads += ["compared to [s]", "tension [%]", "place [%]", "wrong"]
    return heads, rows


def touchdown() -> Table:
    """Example 3 as steps, spacing and alpha change one by one; and without tangential drag."""
    base: dict[str, Any] = {"relative_tolerance": 1e-6, "time_step": 0.5, "node_spacing": 0.5}
    times = np.array([60.0, 96.0, 120.0])
    rows = []
    for drag in (True, False):
        cases: list[tuple[str, cm.Scene | None]] = [
            (f"{name} {value:g}{unit}", laid("elastica", **{**base, key: value}))
            for key, name, unit, values in (
                ("time_step", "dt", " s", (1.0, 0.5, 0.25, 0.125)),
                ("node_spacing", "ds", " m", (1.0, 0.25, 0.125)),
                ("alpha", "alpha", "", (0.55,)),
            )
            for value in values
        ]
        if not drag:
            cases = [cases[0], cases[3], cases[6]]
        scenes = [(name, resisted(scene, drag)) for name, scene in cases if scene is not None]
        models = [(name, cm.CableModel(scene)) for name, scene in scenes]
        other = resisted(laid("hybrid"), drag)
        models += [
            (f"finite elements, {tolerance:g}", by_finite_elements(other, tolerance))
            for tolerance in (1e-3, 1e-4)
        ]
        for name, model in models:
            values = []
            for time in times:
                model.step_to(time)
                values.append((model.top_tension, float(model.floor_force[2])))
            label = name if drag else f"{name}, Cdt = 0"
            rows.append(
                [label, *(f"{pull:.2f}" for pull, _ in values), *(f"{f:.2f}" for _, f in values)]
            )
        if drag:
            rows.append(["prototype (S3)", "117.21", "134.98", "138.83", "28.0", "71.2", "103.7"])
    heads = ["settings", *(f"T, {t:.0f} s [N]" for t in times)]
    heads += [f"floor, {t:.0f} s [N]" for t in times]
    return heads, rows


def resisted(scene: cm.Scene, drag: bool) -> cm.Scene:
    """The scene, with or without tangential drag."""
    data = scene.to_dict()
    if not drag:
        data["cable_types"]["K"]["drag_tangential"] = 0.0
    return cm.load_scene(data)
