"""Run one drawn scene at a tolerance and keep what is needed to judge it."""

from __future__ import annotations

import copy
import time
import traceback
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.random_scenes.draw import Drawn

FloatArray = NDArray[np.float64]

INSTANTS = 20
"""Instants of a run at which its shape is kept."""
STATIONS = 17
"""Places along the line, at equal shares of what is out, where it is kept."""

GROSS = 0.02
"""Share of the line by which no piece of it may be too long, however wild the motion [-]."""


@dataclass
class Trace:
    """What a run did until its end or until it stopped.

    end: ``completed``, ``refused`` (no start), ``stopped`` (a StepError), ``crashed`` (another
    exception), ``not finite`` or ``too slow``; message: the error. times: (n,) [s] of the instants;
    shapes: (n, STATIONS, 3) [m]; top, lowest, highest: (n,) tension at the top, the
    smallest and the largest [N]. on_floor: (n,) length that lies on the floor [m]. lengths: (n,)
    out [m]. errors: what the model says of its own, of positions [m] and top tension [N], if the
    scene asks for that. clamped: first time at which the winch could not follow [s]. broken: limits
    that every state must keep and one did not. energy_gain: energy from nowhere, over what went
    through the cable [-]; not a number where no balance can be drawn up.
    """

    end: str = "completed"
    message: str = ""
    times: list[float] = field(default_factory=list)
    shapes: list[FloatArray] = field(default_factory=list)
    top: list[float] = field(default_factory=list)
    lowest: list[float] = field(default_factory=list)
    highest: list[float] = field(default_factory=list)
    on_floor: list[float] = field(default_factory=list)
    lengths: list[float] = field(default_factory=list)
    errors: list[tuple[float, float]] = field(default_factory=list)
    clamped: float = float("inf")
    broken: list[str] = field(default_factory=list)
    energy_gain: float = float("nan")
    cpu: float = 0.0
    statistics: dict[str, int] = field(default_factory=dict)


def perturbed(drawn: Drawn, share: float) -> dict[str, Any]:
    """The scene with weights and diameter changed by a share, and a faint cross current.

    Where so little changes the motion much, no solver can be held to its tolerance.
    """
    scene = copy.deepcopy(drawn.scene)
    cable = scene["cable_types"]["K"]
    cable["submerged_weight"] *= 1.0 + share
    cable["diameter"] *= 1.0 + share
    if "current" not in scene["environment"] and scene["environment"]["water_density"] > 0.0:
        scene["environment"]["current"] = [0.07 * share, 0.1 * share, 0.0]
    return scene


def run(
    drawn: Drawn,
    scene: dict[str, Any],
    tolerance: float,
    cpu_limit: float = 60.0,
    parts: int = 1,
    time_error: float = 1.0,
) -> tuple[Trace, Any]:
    """Step the scene with the drawn steps to its end; returns the trace and the model (or None).

    Nothing is raised: whatever happens is in the trace. With `parts` above 1 the powers of the
    balance are also taken within each step, from as many short steps on a way of their own.
    time_error: share of the error that a time step may have.
    """
    import cablemodel as cm

    trace, model = Trace(), None
    begin = time.process_time()
    scene = {**scene, "solver": {**scene["solver"], "tolerance": tolerance}}
    count = round(drawn.duration / drawn.step)
    kept = {round(count * (k + 1) / INSTANTS) for k in range(INSTANTS)}
    balance = _Balance(scene, tolerance)
    try:
        model = cm.CableModel(cm.load_scene(scene))
        model._solver.memory.scalars.time_tolerance *= time_error
        total = model.line_length + model.drum_length
        _keep(trace, model, scene, tolerance, total)
        balance.add(model)
        for index in range(1, count + 1):
            balance.look_within(model, index * drawn.step, parts)
            model.step_to(index * drawn.step)
            balance.add(model)
            if model.winch != "free":
                trace.clamped = min(trace.clamped, model.time - drawn.step)
            if index in kept:
                _keep(trace, model, scene, tolerance, total)
            if not np.isfinite(trace.top[-1]) or not np.isfinite(trace.shapes[-1]).all():
                trace.end, trace.message = "not finite", f"at t = {model.time:g} s"
                break
            if time.process_time() - begin > cpu_limit:
                trace.end, trace.message = "too slow", f"at t = {model.time:g} s"
                break
    except Exception as error:
        trace.end, trace.message = ending(error)
    trace.cpu = time.process_time() - begin
    trace.energy_gain = balance.gain()
    if model is not None:
        trace.statistics = model.statistics
    return trace, model


def ending(error: Exception) -> tuple[str, str]:
    """The outcome of a run that an error ended, and the error in words."""
    import cablemodel as cm

    for outcome, kinds in (
        ("refused", (cm.SceneError, cm.StaticsError)),
        ("stopped", (cm.StepError,)),
        ("unsettled", (cm.ConvergenceError,)),
    ):
        if isinstance(error, kinds):
            return outcome, f"{type(error).__name__}: {error}"
    # The search is for exactly these.
    return "crashed", "".join(traceback.format_exception(error, limit=-3))


def _keep(trace: Trace, model: Any, scene: dict[str, Any], tolerance: float, total: float) -> None:
    """Keep the present state, and what it breaks."""
    out = model.line_length
    state = model.sample(np.linspace(0.0, out, STATIONS))
    trace.times.append(model.time)
    trace.shapes.append(state.position)
    trace.top.append(model.top_tension)
    trace.lowest.append(model.tension_min)
    trace.highest.append(model.tension_max)
    trace.on_floor.append(model.floor_length)
    trace.lengths.append(out)
    if scene["solver"].get("error_estimate"):
        trace.errors.append((model.position_error, model.tension_error))
    at = f"at t = {model.time:g} s"
    if abs(out + model.drum_length - total) > 1e-9 * total:
        trace.broken.append(f"{at} {out + model.drum_length - total:.1e} m of cable appeared")
    finite = all(np.isfinite(getattr(state, name)).all() for name in ("velocity", "tension"))
    if not finite:
        trace.end, trace.message = "not finite", at
        trace.shapes[-1] = np.full_like(state.position, np.nan)
        return
    strain = max(model.tension_max, 0.0) / scene["cable_types"]["K"]["axial_stiffness"]
    chords = np.linalg.norm(np.diff(state.position, axis=0), axis=1)
    # Bodies of finite length lie between two stations, and add theirs.
    rigid = sum(2.0 * i["body"].get("half_length", 0.0) for i in scene["line"] if "body" in i)
    longest = out / (STATIONS - 1) * (1.0 + strain) + rigid + (2.0 * tolerance + GROSS) * out
    if chords.max() > longest:
        trace.broken.append(f"{at} a chord of {chords.max():g} m over {longest:g} m of cable")
    floor = scene["environment"].get("floor")
    if floor is not None:
        slope = np.array(floor.get("slope", [0.0, 0.0]))
        ground = floor["z"] + state.position[:, :2] @ slope
        deepest = float((ground - state.position[:, 2]).max() / np.hypot(1.0, np.hypot(*slope)))
        if deepest > tolerance * out:
            trace.broken.append(f"{at} {deepest / (tolerance * out):.2g} tau L below the floor")


class _Balance:
    """Energy that the cable holds against what vessel, drag and floor gave and took.

    What a shape that is wrong by tau L may hide of the line's weight is no gain. A trapezoidal rule
    over the caller's steps, and one over every second step: their distance is what the rule may be
    wrong by. It sees nothing of what comes and goes between two steps, as the drag on a line that
    is let go into a current: `look_within` does. Cable that passes the tow point carries energy
    with it that the model does not report: no balance with pay-out.
    """

    def __init__(self, scene: dict[str, Any], tolerance: float) -> None:
        self._drawn_up = not scene.get("payout")
        self._hidden = tolerance * _weight_times_length(scene)
        self._times: list[float] = []
        self._stored_times: list[float] = []
        self._stored: list[float] = []
        self._powers: list[tuple[float, ...]] = []

    def look_within(self, model: Any, end: float, parts: int) -> None:
        """Take the powers on a way of short steps to `end`, and put the model back."""
        if not self._drawn_up or parts == 1:
            return
        snapshot, start = model.snapshot(), model.time
        for part in range(1, parts):
            model.step_to(start + (end - start) * part / parts)
            self._take_powers(model, model.energy())
        model.restore(snapshot)

    def add(self, model: Any) -> None:
        """Take energy and powers of a state of the run."""
        if not self._drawn_up:
            return
        energy = model.energy()
        names = ("kinetic", "axial", "bending", "potential", "floor")
        self._stored.append(sum(energy[name] for name in names))
        self._stored_times.append(model.time)
        self._take_powers(model, energy)

    def _take_powers(self, model: Any, energy: dict[str, float]) -> None:
        self._times.append(model.time)
        names = ("vessel_power", "drag_power", "floor_power", "added_mass_power")
        self._powers.append(tuple(energy[name] for name in names))

    def gain(self) -> float:
        """The largest gain at any time beyond what the quadrature may be wrong by [-]."""
        if len(self._stored) < 5:
            return float("nan")
        times = np.array(self._times)
        ends = np.searchsorted(times, np.array(self._stored_times))
        stored = np.array(self._stored)
        powers = np.array(self._powers)
        given = powers[:, 0] - powers[:, 1:].sum(axis=1)
        fine = _integral(times, given)
        coarse = np.interp(times, times[::2], _integral(times[::2], given[::2]))
        doubt = np.maximum.accumulate(np.abs(fine - coarse))[ends]
        through = _integral(times, np.abs(powers).sum(axis=1))[ends] + np.ptp(stored)
        excess = stored - stored[0] - fine[ends] - 3.0 * doubt - self._hidden
        return float(np.max(excess[1:] / np.maximum(through[1:], 1e-12)))


def _weight_times_length(scene: dict[str, Any]) -> float:
    """Sizes of all weights, in air and in water, times the line's length [J]."""
    cable, gravity = scene["cable_types"]["K"], scene["environment"]["gravity"]
    length = sum(item["cable"]["length"] for item in scene["line"] if "cable" in item)
    weight = length * max(abs(cable["submerged_weight"]), cable["mass"] * gravity)
    for item in scene["line"]:
        if "body" in item:
            weight += max(abs(item["body"]["submerged_weight"]), item["body"]["mass"] * gravity)
    return float(weight * length)


def _integral(times: FloatArray, values: FloatArray) -> FloatArray:
    """Trapezoidal integral from the first time on."""
    parts = 0.5 * (values[1:] + values[:-1]) * np.diff(times)
    return np.concatenate([[0.0], np.cumsum(parts)])
