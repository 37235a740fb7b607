"""The numbers of the page: what stands out, extremes, the solver's work, where the run is from."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from datetime import UTC, datetime

import numpy as np
from numpy.typing import NDArray

from cablemodel.results.run import Run, SystemRun
from cablemodel.views.drawing import start_of, start_tensions
from cablemodel.views.report.samples import Along, Extreme

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


def key_figures(run: Run, alongs: dict[str, Along], newtons: float, unit: str) -> list[Key]:
    """Numbers that a reader looks for first."""
    found = []
    for name, top in start_tensions(run).items():
        tension = alongs[name].tension
        high, peak = tension.highest, int(np.argmax(top))
        scale = max(abs(high.value), abs(tension.lowest.value)) / newtons
        title = f"{name}: tension at its beginning" if name else "Top tension"
        found.append(
            Key(f"{title}, highest", number(top[peak] / newtons, scale), unit,
                f"at t = {place(run.time[peak])} s; {number(top[-1] / newtons, scale)} "
                f"{unit} at the end")
        )  # fmt: skip
        if high.value > top[peak] + 1e-3 * abs(top[peak]):
            title = _of(name, "tension, highest")
            found.append(Key(title, number(high.value / newtons), unit, _where(high)))
    name = min(alongs, key=lambda name: alongs[name].tension.lowest.value)
    low, high = alongs[name].tension.lowest, alongs[name].tension.highest
    scale = max(abs(high.value), abs(low.value)) / newtons
    title = _of(name, "tension, lowest")
    found.append(Key(title, number(low.value / newtons, scale), unit, _where(low)))
    found += [figure for name in alongs for figure in _slack_figure(run, name)]
    name = max(alongs, key=lambda name: alongs[name].curvature.highest.value)
    curvature = alongs[name].curvature.highest
    radius = f"radius {number(1.0 / curvature.value)} m; " if curvature.value > 0.0 else ""
    title = _of(name, "curvature, largest")
    found.append(Key(title, number(curvature.value), "1/m", radius + _where(curvature)))
    found += _error_figures(run, newtons, unit)
    if isinstance(run, SystemRun):
        return found + _part_figures(run, newtons, unit)
    return [*found, _far_end(run)]


def _slack_figure(run: Run, name: str) -> Iterator[Key]:
    """For how long, and where, a line has been slack, if it has."""

    def at_end(key: str) -> float:
        return float(run[f"{name}.slack_{key}".lstrip(".")][-1])

    known = f"{name}.slack_time".lstrip(".") in run.names
    if known and (total := at_end("time")) > 0.0:
        note = (
            f"up to {number(at_end('longest'))} s at a time, the last time from t = "
            f"{place(at_end('since'))} s on; s = {place(at_end('start'))} to "
            f"{place(at_end('end'))} m"
        )
        yield Key(_of(name, "slack for"), number(total), "s", note)


def _of(line: str, text: str) -> str:
    """A heading of something of a line, or of the only one."""
    return f"{line}: {text}" if line else text.capitalize()


def _far_end(run: Run) -> Key:
    end = run.states[-1].position
    away = float(np.hypot(*(end[-1] - end[0])[:2]))
    below = float(end[0, 2] - end[-1, 2])
    return Key(
        "Far end, at the end", number(away, run.scene.line_length), "m away",
        f"horizontally; {number(abs(below), away)} m "
        f"{'below' if below >= 0.0 else 'above'} the tow point",
    )  # fmt: skip


def _part_figures(run: SystemRun, newtons: float, unit: str) -> list[Key]:
    """Where bodies end, and the largest forces on vessels."""
    found = []
    for name in run.scene.bodies:
        x, y, z = run[f"{name}.position"][-1]
        scale = run.scene.line_length
        note = f"at x = {number(x, scale)} m, y = {number(y, scale)} m"
        found.append(Key(f"{name}: z at the end", number(z, scale), "m", note))
    for name in run.scene.vessels:
        force = np.linalg.norm(run[f"{name}.force"], axis=-1) / newtons
        peak = int(np.argmax(force))
        note = f"at t = {place(run.time[peak])} s; {number(force[-1])} {unit} at the end"
        title = f"{name}: force of the lines, largest"
        found.append(Key(title, number(force[peak]), unit, note))
    for name, cut in run.scene.cuts.items():
        made = run[f"{name}.time"][-1]
        when = ("not cut", "") if math.isnan(made) else (place(made), "s")
        where = f"s = {place(cut.at)} m" if isinstance(cut.at, float) else f"its {cut.at}"
        found.append(Key(f"{name}: {cut.line} is cut", *when, f"at {where}"))
    return found


def _error_figures(run: Run, newtons: float, unit: str) -> list[Key]:
    """What positions and tensions may be wrong by, where that is estimated."""
    estimate = run.error_estimate
    if estimate is None:
        return []
    found = []
    for name, error, divide, its_unit in (
        (estimate.of_positions.positions, estimate.position, 1.0, "m"),
        (estimate.of_tensions.tensions.removeprefix("the "), estimate.tension, newtons, unit),
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


def extremes(run: Run, alongs: dict[str, Along], newtons: float, unit: str) -> list[Row]:
    """Extremes over all output times, with time and place."""
    rows = []
    for name, top in start_tensions(run).items():
        along = alongs[name]
        rows.append(_over_time(f"tension {start_of(name)}", unit, run.time, top / newtons))
        if name:
            tension = run[f"{name}.end_tension"] / newtons
            rows.append(_over_time(f"tension at the end of {name}", unit, run.time, tension))
        for quantity, its_unit, field, divide in (
            ("tension", unit, along.tension, newtons),
            ("curvature", "1/m", along.curvature, 1.0),
            ("bending moment", "N m", along.bending_moment, 1.0),
        ):
            low, high = field.lowest, field.highest
            if field is along.bending_moment and low.value == high.value == 0.0:
                continue  # nothing has been stiff: a hybrid bends where it is slack, or lies
            scale = max(abs(low.value), abs(high.value)) / divide
            rows.append(
                Row(
                    f"{quantity} along {name or 'the cable'}", its_unit,
                    number(low.value / divide, scale), _when(low),
                    number(high.value / divide, scale), _when(high),
                )
            )  # fmt: skip
    more = _part_rows(run, newtons, unit) if isinstance(run, SystemRun) else _line_rows(run)
    return rows + [_over_time(name, its_unit, run.time, values) for name, its_unit, values in more]


_Values = Iterator[tuple[str, str, Floats]]
"""Quantity, unit and values over time."""


def _line_rows(run: Run) -> _Values:
    """Of the far end, bodies and lengths of a scene of one line."""
    for axis, name in enumerate("xyz"):
        yield f"far end, {name}", "m", run.tip_position[:, axis]
    yield "speed of the far end", "m/s", np.linalg.norm(run["tip_velocity"], axis=-1)
    if "bodies.position" in run.names:
        places = run["bodies.position"]
        names = run.scene.body_names(places.shape[1])
        for body, name in enumerate(names):
            yield f"{name or f'body {body + 1} from the vessel'}, z", "m", places[:, body, 2]
    for name, label in (("line_length", "cable out"), ("floor_length", "length on the floor")):
        if name in run.names and np.ptp(run[name]) > 0.0:
            yield label, "m", run[name]


def _part_rows(run: SystemRun, newtons: float, unit: str) -> _Values:
    """Of the bodies and vessels of a system."""
    for name in run.scene.bodies:
        for axis, word in enumerate("xyz"):
            yield f"{name}, {word}", "m", run[f"{name}.position"][:, axis]
        for axis, word in enumerate(("roll", "pitch", "yaw")):
            yield f"{name}, {word}", "deg", np.degrees(run[f"{name}.attitude"][:, axis])
        yield f"speed of {name}", "m/s", np.linalg.norm(run[f"{name}.velocity"], axis=-1)
    for name in run.scene.lines:
        key = f"{name}.floor_length"
        if key in run.names and np.ptp(run[key]) > 0.0:
            yield f"length of {name} on the floor", "m", run[key]
    for name in run.scene.vessels:
        force = np.linalg.norm(run[f"{name}.force"], axis=-1)
        moment = np.linalg.norm(run[f"{name}.moment"], axis=-1)
        yield f"force of the lines on {name}", unit, force / newtons
        yield f"moment of the lines about the origin of {name}", "N m", moment


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


def described(run: Run) -> str:
    """The run in one sentence."""
    parts = _parts_of_system(run) if isinstance(run, SystemRun) else _parts_of_line(run)
    span = f"t = {place(run.time[0])} to {place(run.time[-1])} s"
    return " · ".join([*parts, span])


def _parts_of_system(run: SystemRun) -> Iterator[str]:
    scene = run.scene
    for name, line in scene.lines.items():
        types = _joined([item.cable.type for item in line.items if item.cable is not None])
        out = next((winch for winch, own in scene.winches.items() if own.line == name), None)
        ends = run[f"{out}.line_length"][[0, -1]] if out is not None else [line.length] * 2
        yield f"{name}: {place(line.length)} m of {types}{_paid_out(*ends)}"
    for kind, word in (("bodies", "body"), ("vessels", "vessel")):
        for name in getattr(scene, kind):
            yield f"{word} {name}"


def _parts_of_line(run: Run) -> Iterator[str]:
    scene = run.scene
    cables = [item.cable for item in scene.line if item.cable is not None]
    bodies = sum(item.body is not None for item in scene.line)
    length = f"{place(scene.line_length)} m of {_joined([cable.type for cable in cables])}"
    yield length + _paid_out(*run["line_length"][[0, -1]])
    if bodies:
        yield "one body" if bodies == 1 else f"{bodies} bodies"
    yield f"far end {'anchored' if scene.end.kind == 'anchor' else 'free'}"


def _paid_out(start: float, end: float) -> str:
    """What follows a length [m] where cable is paid out, or reeled in."""
    return "" if place(start) == place(end) else f" at the start, {place(end)} m at the end"


def _joined(names: list[str]) -> str:
    unique = list(dict.fromkeys(names))
    return ", ".join(unique[:4]) + (", …" if len(unique) > 4 else "")
