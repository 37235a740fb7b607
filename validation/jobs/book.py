"""What a job leaves: answers beside independent ones, and a picture."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import cablemodel as cm
from benchmarks.sections import read_rows, write_part, write_rows
from validation import draw

FOLDER = Path("docs") / "jobs"
STORE = FOLDER / "answers.csv"
MODULES = ("towing", "lifting", "mooring", "laying", "systems")


@dataclass(frozen=True)
class Answer:
    """A quantity, as computed here and elsewhere; both in `unit`, `within` what they may differ."""

    quantity: str
    found: float
    independent: float
    unit: str
    within: float

    @property
    def agrees(self) -> bool:
        """Whether both are the same within what is stated."""
        return abs(self.found - self.independent) <= self.within


Result = tuple[list[Answer], Any]
JOBS: dict[str, Callable[[], Result]] = {}


def job(run: Callable[[], Result]) -> Callable[[], Result]:
    """Register a job: its name is that of the function, of the scene and of the page."""
    JOBS[run.__name__] = run
    return run


def jobs() -> dict[str, Callable[[], Result]]:
    """All jobs by name."""
    for module in MODULES:
        importlib.import_module(f"validation.jobs.{module}")
    return {name: JOBS[name] for name in sorted(JOBS)}


def scene(name: str, overrides: Sequence[str] = ()) -> cm.Scene:
    """The scene beside the page."""
    return cm.load_scene(FOLDER / f"{name}.yaml", list(overrides))


def model(name: str, overrides: Sequence[str] = ()) -> cm.CableModel:
    """At its start."""
    return cm.CableModel(scene(name, overrides))


def shape(line: Any, count: int = 200) -> Any:
    """Places along a line (count, 3) [m], of a model or of a line of a system."""
    length = line.line_length if hasattr(line, "line_length") else line.length
    return line.sample(np.linspace(0.0, length, count)).position


def picture(
    shapes: dict[str, Any],
    series: dict[str, tuple[Any, Any]],
    axis: tuple[str, str] = ("time [s]", ""),
    plane: tuple[int, int] = (0, 2),
) -> Any:
    """Shapes of lines in a plane, and curves; what is named `independent` is black."""
    figure, (left, right) = draw.axes(2, 9.0, 3.4)
    for name, places in shapes.items():
        style = {"color": draw.REFERENCE, "ls": "--"} if "independent" in name else {}
        left.plot(places[:, plane[0]], places[:, plane[1]], label=name, **style)
    draw.label(left, f"{'xyz'[plane[0]]} [m]", f"{'xyz'[plane[1]]} [m]")
    for name, (x, y) in series.items():
        style = {"color": draw.REFERENCE, "ls": "--"} if "independent" in name else {}
        right.plot(x, y, marker="o" if len(x) < 12 else "", ms=4, label=name, **style)
    draw.label(right, *axis)
    return figure


def digits(value: float) -> str:
    """Four of them, with a comma between thousands."""
    size = abs(value)
    return f"{value:,.0f}" if size >= 1000 else f"{value:.4g}"


def write(found: dict[str, list[Answer]]) -> None:
    """The data file; jobs that were not run stay."""
    kept = read() if STORE.exists() else {}
    merged = kept | found
    body = [
        [name, a.quantity, f"{a.found:.6g}", f"{a.independent:.6g}", a.unit, f"{a.within:.3g}"]
        for name in sorted(merged)
        if name in JOBS
        for a in merged[name]
    ]
    write_rows(STORE, ["job", "quantity", "cablemodel", "independent", "unit", "within"], body)


def read() -> dict[str, list[Answer]]:
    """Answers of the data file by job."""
    stored: dict[str, list[Answer]] = {}
    for row in read_rows(STORE):
        values = (float(row["cablemodel"]), float(row["independent"]))
        answer = Answer(row["quantity"], *values, row["unit"], float(row["within"]))
        stored.setdefault(row["job"], []).append(answer)
    return stored


def table(answers: Sequence[Answer]) -> str:
    """What a page shows; without blanks about cells, which would count as words."""
    lines = ["|answer|cablemodel|independent|may differ by|", "|---|---|---|---|"]
    for a in answers:
        cells = [f"{digits(v)} {a.unit}".strip() for v in (a.found, a.independent, a.within)]
        lines.append("|" + "|".join([a.quantity, *cells]) + "|")
    return "\n".join(lines)


def render(name: str) -> None:
    """Write the generated part of a job's page."""
    write_part(FOLDER / f"{name}.md", "answer", table(read()[name]))
