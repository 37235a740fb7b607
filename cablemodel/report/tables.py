"""The numbers of the page: what stands out, extremes, the solver's work, where the run is from."""

from __future__ import annotations

import math
from dataclasses import dataclass
from datetime import UTC, datetime
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.report.samples import Along, Extreme

if TYPE_CHECKING:
    from cablemodel.run import Run
    from cablemodel.scene import Scene

Floats = NDArray[np.float64]

_NEGLIGIBLE = 1e-5
"""Part of a quantity's largest value that is shown as zero: it is beyond the solver's accuracy."""


@dataclass(frozen=True)
class Row:
    """One row of the table of extremes; times in seconds."""

    quantity: str
    unit: str
    lowest: str
    lowest_at: str
    highest: str
    highest_at: str
    at_end: str = ""


@dataclass(frozen=True)
class Key:
    """A number that stands out at the top of the page."""

    name: str
    value: str
    unit: str
    note: str


def number(value: float, scale: float = 0.0) -> str:
    """A value in four digits; zero where it is negligible against ``scale``."""
    if not math.isfinite(value):
        return "–"
    if abs(value) <= _NEGLIGIBLE * abs(scale):
        return "0"
    text = f"{value:,.0f}" if 1e3 <= abs(value) < 1e7 else f"{value:#.4g}"
    return text.replace("-", "−")


def place(value: float) -> str:
    """A time or an arc length, without digits that say nothing."""
    return f"{value:.5g}".replace("-", "−")


def key_figures(run: Run, along: Along, newtons: float, unit: str) -> list[Key]:
    """Numbers that a reader looks for first."""
    high, low = along.tension.highest, along.tension.lowest
    peak = int(np.argmax(run.top_tension))
    top = run.top_tension[peak]
    scale = max(abs(high.value), abs(low.value)) / newtons
    found = [
        Key("Top tension, highest", number(top / newtons, scale), unit,
            f"at t = {place(run.time[peak])} s; {number(run.top_tension[-1] / newtons, scale)} "
            f"{unit} at the end"),
    ]  # fmt: skip
    if high.value > top + 1e-3 * abs(top):
        found.append(Key("Tension, highest", number(high.value / newtons), unit, _where(high)))
    found.append(Key("Tension, lowest", number(low.value / newtons, scale), unit, _where(low)))
    curvature = along.curvature.highest
    radius = f"radius {number(1.0 / curvature.value)} m; " if curvature.value > 0.0 else ""
    found.append(
        Key("Curvature, largest", number(curvature.value), "1/m", radius + _where(curvature))
    )
    found += _error_figures(run, newtons, unit)
    end = run.states[-1].position
    away = float(np.hypot(*(end[-1] - end[0])[:2]))
    below = float(end[0, 2] - end[-1, 2])
    found.append(
        Key("Far end, at the end", number(away, run.scene.line_length), "m away",
            f"horizontally; {number(abs(below), away)} m "
            f"{'below' if below >= 0.0 else 'above'} the tow point"),
    )  # fmt: skip
    return found


def _error_figures(run: Run, newtons: float, unit: str) -> list[Key]:
    """What positions and the top tension may be wrong by, where that is estimated."""
    estimate = run.error_estimate
    if estimate is None:
        return []
    found = []
    for name, error, divide, its_unit in (
        ("positions", estimate.position, 1.0, "m"),
        ("top tension", estimate.tension, newtons, unit),
    ):
        title, note = f"Estimated error, {name}", ""
        if estimate.unknown_from is not None:
            note = f"not known from t = {place(estimate.unknown_from)} s on"
        if math.isnan(error.share):
            if note:
                found.append(Key(title, "–", "", note))
            continue
        note = f"{error.share:.2g} of what is allowed{'; ' if note else ''}{note}"
        found.append(Key(title, number(error.largest / divide), its_unit, note))
    return found


def _where(extreme: Extreme) -> str:
    return f"at t = {_when(extreme)}"


def _when(extreme: Extreme) -> str:
    """Time, and the place on the cable where a state tells it."""
    at = "" if math.isnan(extreme.s) else f", s = {place(extreme.s)} m"
    return f"{place(extreme.time)} s{at}"


def extremes(run: Run, along: Along, newtons: float, unit: str) -> list[Row]:
    """Extremes over all output times, with time and place."""
    rows = [_over_time("tension at the tow point", unit, run.time, run.top_tension / newtons)]
    fields = (
        ("tension along the cable", unit, along.tension, newtons),
        ("curvature along the cable", "1/m", along.curvature, 1.0),
        ("bending moment along the cable", "N m", along.bending_moment, 1.0),
    )
    for name, its_unit, field, divide in fields:
        low, high = field.lowest, field.highest
        scale = max(abs(low.value), abs(high.value)) / divide
        rows.append(
            Row(
                name, its_unit,
                number(low.value / divide, scale), _when(low),
                number(high.value / divide, scale), _when(high),
            )
        )  # fmt: skip
    for axis, name in enumerate(("x", "y", "z")):
        values = run.tip_position[:, axis]
        rows.append(_over_time(f"far end, {name}", "m", run.time, values))
    speed = np.linalg.norm(run["tip_velocity"], axis=-1)
    rows.append(_over_time("speed of the far end", "m/s", run.time, speed))
    if "bodies.position" in run.names:
        places = run["bodies.position"]
        for body in range(places.shape[1]):
            name = f"body {body + 1} from the vessel, z"
            rows.append(_over_time(name, "m", run.time, places[:, body, 2]))
    for name, label in (("line_length", "cable out"), ("floor_length", "length on the floor")):
        if name in run.names and np.ptp(run[name]) > 0.0:
            rows.append(_over_time(label, "m", run.time, run[name]))
    return rows


def _over_time(name: str, unit: str, time: Floats, values: Floats) -> Row:
    if np.all(np.isnan(values)):
        return Row(name, unit, "–", "", "–", "", "–")
    low, high = int(np.nanargmin(values)), int(np.nanargmax(values))
    scale = max(abs(values[low]), abs(values[high]))
    return Row(
        name, unit, number(values[low], scale), f"{place(time[low])} s",
        number(values[high], scale), f"{place(time[high])} s", number(values[-1], scale),
    )  # fmt: skip


def solver_facts(run: Run) -> list[tuple[str, str]]:
    """What the solver was asked for and did."""
    scene = run.scene
    facts = [
        ("method", scene.solver.method.replace("_", " ")),
        ("tolerance", place(scene.solver.tolerance)),
    ]
    if scene.solver.accuracy is not None:
        facts.append(("accuracy asked for", place(scene.solver.accuracy)))
    known = {"rejected": "rejected steps", "wall_time": "computing time"}
    for name, value in run.statistics.items():
        if isinstance(value, bool) or not isinstance(value, int | float):
            continue
        text = f"{value:,}" if isinstance(value, int) else number(value)
        if name == "wall_time":
            text = f"{value:.3g} s"
            if value > 0.0:
                text += f" ({(run.time[-1] - run.time[0]) / value:,.0f} × real time)"
        facts.append((known.get(name, name.replace("_", " ")), text))
    facts.append(("outputs", f"{len(run.time):,}"))
    return facts


_ORIGIN = ("cablemodel", "git", "python", "numpy", "numba", "cpu", "platform")


def origin_facts(run: Run) -> list[tuple[str, str]]:
    """Where the run comes from: versions and machine."""
    facts = [(name, run.metadata[name]) for name in _ORIGIN if name in run.metadata]
    epoch = run.metadata.get("epoch_ns", "")
    if epoch.isdigit():
        when = datetime.fromtimestamp(int(epoch) // 1_000_000_000, UTC)
        facts.insert(0, ("t = 0 in the log", when.strftime("%Y-%m-%d %H:%M:%S UTC")))
    return facts


def described(scene: Scene, run: Run) -> str:
    """The run in one sentence."""
    cables = [item.cable for item in scene.line if item.cable is not None]
    bodies = sum(item.body is not None for item in scene.line)
    parts = [f"{place(scene.line_length)} m of {_joined([cable.type for cable in cables])}"]
    at_end = place(run["line_length"][-1])
    if at_end != place(run["line_length"][0]):
        # Cable was paid out, or reeled in.
        parts[0] += f" at the start, {at_end} m at the end"
    if bodies:
        parts.append("one body" if bodies == 1 else f"{bodies} bodies")
    end = "anchored" if scene.end.kind == "anchor" else "free"
    parts.append(f"far end {end}")
    span = f"t = {place(run.time[0])} to {place(run.time[-1])} s"
    return " · ".join([*parts, span])


def _joined(names: list[str]) -> str:
    unique = list(dict.fromkeys(names))
    return ", ".join(unique[:4]) + (", …" if len(unique) > 4 else "")
