"""The outcome map of the random searches: tables, a figure each, and a data file of all traits."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.stats import binomtest

from benchmarks.random_scenes.chance import COUNT
from benchmarks.random_scenes.draw import IN_WAVES, Drawn
from benchmarks.random_scenes.failures import BY_THE_PROMISE
from benchmarks.random_scenes.judge import CONVERGED_WITHIN, FINER, TOOK, Verdict
from benchmarks.random_scenes.ordinary import ORDINARY, drawn
from benchmarks.sections import table, write_part, write_rows

OUTCOMES = ("completed", "refused", "stopped", "unsettled", "wrong", "too slow", "crashed")
COLOURS = ("#7fb77e", "#9db4c0", "#e0a458", "#d9d27a", "#c1443c", "#7d5ba6", "#222222")
WORDS = (
    "manoeuvre", "medium", "model", "pay-out", "floor", "body", "end", "top", "current", "weight",
    "EI", "shock", "waves",
)  # fmt: skip
"""Traits that are words: a row of the table for each value."""
NUMBERS = ("length", "strain", "bending length", "tolerance", "step", "friction")
"""Traits that are numbers: a panel of the figure for each."""


@dataclass(frozen=True)
class Search:
    """Scenes that are judged and told of together: ``count`` of them, from the number ``first`` on.

    title: its file and its figure are named by it. limit: what they may differ by from the run that
    judges, in units of the promise. claimed: whether runs say that they keep the promise. pictured:
    whether there is a figure of them.
    """

    title: str
    first: int
    count: int
    limit: float = 1.0 + FINER
    claimed: bool = False
    pictured: bool = True

    def file(self, suffix: str) -> str:
        """The name of its file of that suffix."""
        return self.title.lower().replace(" ", "_") + suffix


ALL = Search("Random scenes", 0, COUNT)
HELD = Search("Random scenes held back", 5 * COUNT, 200, pictured=False)
"""Judged once: no rule was made by any of them."""
AT_SEA = Search("Random scenes in waves", IN_WAVES, 200)
CONVERGED = Search(
    "Random scenes that are asked to converge",
    0,
    COUNT + COUNT // 2,
    limit=CONVERGED_WITHIN,
    claimed=True,
)
JOBS = Search("Ordinary scenes", ORDINARY, 140, pictured=False)
SEARCHES = (ALL, HELD, AT_SEA, JOBS, CONVERGED)
SHOWN = ("medium",)
"""Traits by which the page tells of single runs; all others are in the data file."""

Rows = Sequence[tuple[Drawn, Verdict]]


def outcomes_by_trait(rows: Rows) -> list[tuple[str, ...]]:
    """Outcomes in per cent: of all scenes, and for each value of each word."""
    lines = [_counts("all", [v for _, v in rows])]
    for word in WORDS:
        values = sorted({str(d.traits[word]) for d, _ in rows})
        if values == ["none"]:
            continue
        lines += [
            _counts(f"{word}: {value}", [v for d, v in rows if d.traits[word] == value])
            for value in values
        ]
    return lines


def _counts(name: str, verdicts: Sequence[Verdict]) -> tuple[str, ...]:
    counts = Counter(v.outcome for v in verdicts)
    shares = [f"{100 * counts[o] / len(verdicts):.1f}" if counts[o] else "" for o in OUTCOMES]
    return (name, str(len(verdicts)), *shares)


def wrong_counts(search: Search, verdicts: Sequence[Verdict]) -> list[int]:
    """How many scenes are wrong by what; the names are in ``WRONG_BY``."""
    wrong = [v for v in verdicts if v.outcome == "wrong"]

    def beyond(low: float, high: float) -> int:
        return sum("position" in v.kinds and low < v.position <= high for v in wrong)

    return [
        beyond(search.limit, 3.0),
        beyond(3.0, 10.0),
        beyond(10.0, math.inf),
        sum(v.kinds == ["tension"] for v in wrong),
        sum(bool(set(v.kinds) - BY_THE_PROMISE) for v in wrong),
    ]


WRONG_BY = (
    "position, up to 3 tau L",
    "position, 3 to 10 tau L",
    "position, more than 10 tau L",
    "tension alone",
    "something impossible",
)


def figure(rows: Rows, path: Path) -> None:
    """Shares of the outcomes against each drawn number, in eight bins of equal count."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    canvas, axes = pyplot.subplots(2, 3, figsize=(11.0, 6.0), layout="constrained", sharey=True)
    for panel, name in zip(axes.flat, NUMBERS, strict=True):
        known = [(d.traits[name], v.outcome) for d, v in rows if d.traits[name] == d.traits[name]]
        known.sort(key=lambda pair: pair[0])
        bins = [part for part in np.array_split(np.arange(len(known)), 8) if len(part)]
        base = np.zeros(len(bins))
        for outcome, colour in zip(OUTCOMES, COLOURS, strict=True):
            shares = np.array([np.mean([known[k][1] == outcome for k in part]) for part in bins])
            panel.bar(range(len(bins)), shares, bottom=base, color=colour, label=outcome, width=0.9)
            base += shares
        middles = [float(known[part[len(part) // 2]][0]) for part in bins]
        panel.set_xticks(range(len(bins)), [_short(value) for value in middles], fontsize=7)
        panel.set_xlabel(LABELS[name])
        panel.set_ylim(0.0, 1.0)
    for panel in axes[:, 0]:
        panel.set_ylabel("share of the scenes")
    canvas.legend(*axes.flat[0].get_legend_handles_labels(), loc="outside upper center", ncols=7)
    path.parent.mkdir(parents=True, exist_ok=True)
    canvas.savefig(path, dpi=110)
    pyplot.close(canvas)


def _short(value: float) -> str:
    """A number in as few characters as a bar's label has room for."""
    if 0.01 <= abs(value) < 1000.0 or value == 0.0:
        return f"{value:.2g}" if value < 100.0 else f"{value:.0f}"
    return f"{value:.0e}".replace("e-0", "e-").replace("e+0", "e")


LABELS = {
    "length": "length [m]",
    "strain": "strain under a typical load",
    "bending length": "(EI/w)^(1/3) over the length",
    "tolerance": "tolerance tau",
    "step": "step of the caller [s]",
    "friction": "friction of the floor",
}


def converged_table(verdicts: Sequence[Verdict]) -> str:
    """At what tolerances runs converged, how many of them are wrong, and how sure that is."""
    rows = []
    for name, first in (("the first set", 0), ("a second set", COUNT)):
        of_set = [v for v in verdicts if first <= v.seed < first + COUNT]
        judged = [v for v in of_set if TOOK in v.statistics and v.outcome in ("completed", "wrong")]
        if not judged:
            continue
        wrong = sum(v.outcome == "wrong" for v in judged)
        sure = binomtest(wrong, len(judged)).proportion_ci(0.95)
        counts = Counter(v.statistics[TOOK] for v in judged)
        rows.append(
            (
                name,
                str(len(of_set)),
                *(str(counts[finer]) for finer in (4, 16, 64)),
                str(wrong),
                f"{100 * sure.low:.2g} to {100 * sure.high:.2g} %",
            )
        )
    head = ("scenes", "number", "at tau/4", "at tau/16", "at tau/64", "wrong", "wrong, 95 % sure")
    return table(head, rows)


def write(page: Path, stored: Path) -> None:
    """Tables and figures of all searches that are stored, and their outcomes by trait as data."""
    every: list[tuple[str, ...]] = []
    shown: list[tuple[str, ...]] = []
    wrong: list[tuple[str, list[int]]] = []
    for search in SEARCHES:
        store = stored / search.file(".json")
        if not store.exists():
            continue
        verdicts = [Verdict(**row) for row in json.loads(store.read_text())]
        rows = [(drawn(v.seed), v) for v in verdicts]
        if search.pictured:
            figure(rows, stored / search.file(".png"))
        lines = outcomes_by_trait(rows)
        every += [(search.title, *line) for line in lines]
        told = ("all", *SHOWN) if search is ALL else ("all",)
        shown += [
            (search.title if line[0] == "all" else line[0], *line[1:])
            for line in lines
            if line[0].split(":")[0] in told
        ]
        wrong.append((search.title, wrong_counts(search, verdicts)))
        if search.claimed:
            write_part(page, "converged", converged_table(verdicts))
    head = ("scenes", "number", *(f"{outcome} [%]" for outcome in OUTCOMES))
    write_rows(stored / "outcomes.csv", ("search", *head), every)
    write_part(page, "outcomes", table(head, shown))
    lines = [(by, *(str(counts[k]) for _, counts in wrong)) for k, by in enumerate(WRONG_BY)]
    write_part(page, "wrong", table(("wrong by", *(title for title, _ in wrong)), lines))
