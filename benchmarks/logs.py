"""What logs cost: to write a sample, to open an hour, to draw a page (python -m benchmarks.logs).

Processor time, fastest of several runs, beside that of mcap's own writer and reader over the same
messages: the ratios hold on any machine.
"""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from mcap.reader import make_reader
from mcap.writer import Writer

import cablemodel as cm
from benchmarks.measure import best
from benchmarks.sections import table, write_part
from cablemodel.results.log.writer import LogWriter
from cablemodel.views.report.page import save_report

ROOT = Path(__file__).parents[1]
STEP = 0.05
"""Of the logged runs: 20 Hz [s]."""
STATIONS = 64
BATCHES, SAMPLES = 10, 200
TENSION = "/cable/tension_top"
HOUR = 72_000
"""Samples of an hour."""


@dataclass(frozen=True)
class LogCost:
    """Seconds of processor time; ``mcap``: of the library's own writer or reader."""

    what: str
    ours: float
    mcap: float | None


def writing(folder: Path) -> LogCost:
    """A sample of 64 stations: step and outputs, by us and by mcap's writer."""
    scene = cm.load_scene(ROOT / "scenes" / "towed_cable.yaml")
    model = cm.CableModel(scene)
    model.step(STEP)
    state = model.sample(np.linspace(0.0, model.line_length, STATIONS))
    with LogWriter(folder / "ours.mcap", scene, epoch=0) as writer:

        def write() -> None:
            for _ in range(SAMPLES):
                writer.write_step(model, STEP)
                writer.write_outputs(model, state)

        ours = best(write, BATCHES)
        writer.close()
    with (folder / "ours.mcap").open("rb") as file:
        found = [
            (channel.topic, message.data)
            for _schema, channel, message in make_reader(file).iter_messages()
        ]

    def plain() -> None:
        with (folder / "plain.mcap").open("wb") as file:
            copy = Writer(file)
            copy.start()
            channels: dict[str, int] = {}
            for n, (topic, data) in enumerate(found):
                if topic not in channels:
                    channels[topic] = copy.register_channel(topic, "cdr", 0)
                copy.add_message(channels[topic], log_time=n, publish_time=n, data=data)
            copy.finish()

    return LogCost(
        f"write a sample of {STATIONS} stations",
        ours / SAMPLES,
        best(plain, 3) / (BATCHES * SAMPLES),
    )


def an_hour(folder: Path) -> Path:
    """The log of an hour at 20 Hz."""
    path = folder / "hour.mcap"
    scene = cm.load_scene(ROOT / "scenes" / "turn.yaml")
    model = cm.CableModel(scene)
    with LogWriter(path, scene, epoch=0) as writer:
        writer.write_outputs(model)
        for n in range(1, HOUR + 1):
            model.step_to(n * STEP)
            writer.write_step(model, STEP)
            writer.write_outputs(model, exact_state=n % 20 == 0, shape=n % 20 == 0)
        writer.close(model.statistics)
    return path


def opening(hour: Path) -> LogCost:
    """The top tension over an hour, by us and by mcap's reader with no message decoded."""

    def plain() -> None:
        with hour.open("rb") as file:
            for _ in make_reader(file).iter_messages([TENSION]):
                pass

    return LogCost(
        "top tension of an hour at 20 Hz", best(lambda: cm.open_run(hour).top_tension, 3),
        best(plain, 1),
    )  # fmt: skip


def reporting(log: Path, what: str) -> LogCost:
    """The page of a log."""
    page = log.with_suffix(".html")
    return LogCost(what, best(lambda: save_report(cm.open_run(log), page), 2), None)


def main() -> None:
    """Measure, print, write the table."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        short = folder / "short.mcap"
        cm.simulate(cm.load_scene(ROOT / "scenes" / "towed_cable.yaml"), log=short)
        hour = an_hour(folder)
        costs = [
            writing(folder),
            opening(hour),
            reporting(short, "report of the towed cable"),
            reporting(hour, "report of an hour at 20 Hz"),
        ]
    rows = [
        [
            cost.what,
            f"{1e3 * cost.ours:.3g}",
            "" if cost.mcap is None else f"{1e3 * cost.mcap:.3g}",
            "" if cost.mcap is None else f"{cost.ours / cost.mcap:.2f}",
        ]
        for cost in costs
    ]
    text = table(["", "CPU ms", "mcap's own [ms]", "ratio"], rows)
    print(text)
    write_part(ROOT / "docs" / "logs.md", "cost", text)


if __name__ == "__main__":
    main()
