"""The outcome map of the random search: a table, a figure, the worst scenes by number."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.stats import binomtest

from benchmarks.random_scenes.chance import COUNT
from benchmarks.random_scenes.draw import IN_WAVES, Drawn, draw
from benchmarks.random_scenes.judge import (
    CONVERGE_LIMIT,
    CONVERGED_WITHIN,
    FINER,
    JUDGE_LIMIT,
    RUN_LIMIT,
    TOOK,
    Verdict,
)
from benchmarks.report import number, table

OUTCOMES = ("completed", "refused", "stopped", "unsettled", "wrong", "too slow", "crashed")
COLOURS = ("#7fb77e", "#9db4c0", "#e0a458", "#d9d27a", "#c1443c", "#7d5ba6", "#222222")
WORDS = (
    "manoeuvre", "medium", "model", "pay-out", "floor", "body", "end", "top", "current", "weight",
    "EI", "shock", "waves",
)  # fmt: skip
"""Traits that are words: a row of the table for each value."""
NUMBERS = ("length", "strain", "bending length", "tolerance", "step", "friction")
"""Traits that are numbers: a panel of the figure for each."""

_HEADER = """Written by `make stress` (`python -m benchmarks.random_scenes`). Scenes are drawn by a
Latin hypercube over cable (length 3 to 1,000 m, density 0.5 to 8 of the water's, EI 0 or up to that
of a solid rod, EA from the strain under a typical load), medium, current, manoeuvre, winch, floor,
bodies, ends, model, tolerance (1e-4 to 1e-2) and the caller's step; they last 5 to 60 s. How they
are judged is in `benchmarks/random_scenes/judge.py`: by the run at a quarter of the tolerance as
long as the motion can be predicted, by energy, and by limits that always hold. *Refused*: a
SceneError or StaticsError at the start; *stopped*: a StepError that names time and place; *too
slow*: more than {limit:g} s of processor time; *unsettled*: runs at tau, tau/4 and tau/16 all
differ, so that there is nothing to judge by; *wrong*: more than {allowed:g} of the promise away,
or by energy, limits or numbers that are not finite. Any of them again, with the scene as YAML:
`python -m benchmarks.random_scenes --only SEED`.

A single run does not know what it is off by, and claims nothing. One that is asked to estimate its
errors, or to converge, does: how far to be trusted is in *What runs say of their own errors* and
*Random scenes that are asked to converge*. This search fails for what is impossible (crashes,
energy from nowhere, broken limits), and for a scene that misses its promise and did not before
(`benchmarks/random_scenes/failures.py`).
"""


_IN_WAVES = """Written by `make stress` (`python -m benchmarks.random_scenes --waves`). Scenes
drawn and judged as above, all in water with a surface: regular waves or a JONSWAP sea of 3 to 15 s,
up to 0.06 of their length and a fifth of the depth high, the tow point from 2 m below to 5 m above
still water. Lines that float without tension have no shape at rest: most of what is refused.
"""


_CONVERGED = """Written by `make stress` (`python -m benchmarks.random_scenes --converge`). The
scenes of *Random scenes*, and five hundred of a second set (seeds from 1000 on), each made by
`cablemodel.converge`, which repeats it at finer tolerances until two attempts in a row estimate
their errors to be within what its tolerance tau promises, and judged by a run at a sixteenth of the
tolerance that it took: no attempt has seen that. They are compared to the end, at all outputs and
102 places, however the motion multiplies differences; tensions are asked for and compared (until
the line is slack, or the winch has reached an end) where no command makes it ring along itself, nor
the ends of a turn. The judge is the same solver, only finer: what all its runs share is not seen.
*Wrong*: more than {limit:.4g} of the promise away; *unsettled*: a ConvergenceError, which says that
no run at tau, tau/4, tau/16 and tau/64 is known to keep the promise, and why none is; *too slow*:
more than {slow:g} s of processor time for all attempts, or more than {judge:g} s for the judge.
"""

BAD = ("crashed", "too slow", "wrong", "unsettled", "stopped")


@dataclass(frozen=True)
class Search:
    """Scenes that are judged and told of together: ``count`` of them, from the number ``first`` on.

    title: of their section; their file and their figure are named by it. by: what they are
    compared with; limit: what they may differ from it by, in units of the promise. listed: outcomes
    whose scenes are told of one by one. claimed: whether runs say that they keep the promise.
    """

    title: str
    header: str
    first: int
    count: int
    by: str = "the run at tau/4"
    limit: float = 1.0 + FINER
    listed: tuple[str, ...] = BAD
    claimed: bool = False

    def beside(self, page: Path, suffix: str) -> Path:
        """The file of that suffix, in the folder of the page's files."""
        name = self.title.lower().replace(" ", "_")
        return page.parent / page.stem / f"{name}{suffix}"


ALL = Search("Random scenes", _HEADER.format(limit=RUN_LIMIT, allowed=1.0 + FINER), 0, COUNT)
AT_SEA = Search("Random scenes in waves", _IN_WAVES, IN_WAVES, 200)
CONVERGED = Search(
    "Random scenes that are asked to converge",
    _CONVERGED.format(limit=CONVERGED_WITHIN, slow=CONVERGE_LIMIT, judge=JUDGE_LIMIT),
    0,
    COUNT + COUNT // 2,
    by="a far finer run",
    limit=CONVERGED_WITHIN,
    listed=("crashed", "too slow", "wrong", "stopped"),
    claimed=True,
)


def outcome_table(rows: Sequence[tuple[Drawn, Verdict]]) -> str:
    """Outcomes in per cent for each value of each word."""
    lines = [_counts("all", [v for _, v in rows])]
    for word in WORDS:
        values = sorted({str(d.traits[word]) for d, _ in rows})
        if values == ["none"]:
            continue
        lines += [
            _counts(f"{word}: {value}", [v for d, v in rows if d.traits[word] == value])
            for value in values
        ]
    return table(("scenes", "number", *OUTCOMES), lines)


def _counts(name: str, verdicts: Sequence[Verdict]) -> tuple[str, ...]:
    counts = Counter(v.outcome for v in verdicts)
    shares = [f"{100 * counts[o] / len(verdicts):.1f} %" if counts[o] else "" for o in OUTCOMES]
    return (name, str(len(verdicts)), *shares)


def wrong_table(search: Search, verdicts: Sequence[Verdict]) -> str:
    """What is wrong, and by how much."""

    verdicts = [v for v in verdicts if v.outcome == "wrong"]

    def count(test: Callable[[Verdict], bool]) -> str:
        return str(sum(test(v) for v in verdicts))

    def beyond(low: float, high: float) -> str:
        return count(lambda v: "position" in v.kinds and low < v.position <= high)

    rows = [
        (f"position {search.limit:.4g} to 3 tau L from {search.by}", beyond(search.limit, 3.0)),
        ("position 3 to 10 tau L", beyond(3.0, 10.0)),
        ("position more than 10 tau L", beyond(10.0, math.inf)),
        ("tension, positions right", count(lambda v: v.kinds == ["tension"])),
        ("energy from nowhere", count(lambda v: "energy" in v.kinds)),
        ("a limit broken (stretched, or deep in the floor)", count(lambda v: "limit" in v.kinds)),
        ("does not carry its weight after an hour", count(lambda v: "rest" in v.kinds)),
        ("not finite", count(lambda v: "not finite" in v.kinds)),
    ]
    return table(("what is wrong", "scenes"), rows)


def worst_table(search: Search, rows: Sequence[tuple[Drawn, Verdict]], most: int = 80) -> str:
    """The worst scenes: crashed, too slow, then by how far they are off."""

    def badness(row: tuple[Drawn, Verdict]) -> tuple[int, float]:
        verdict = row[1]
        rank = search.listed.index(verdict.outcome)
        return rank, -max(np.nan_to_num([verdict.position, verdict.tension]))

    bad = [row for row in rows if row[1].outcome in search.listed]
    lines = [
        (
            str(v.seed),
            v.outcome,
            ", ".join(v.kinds),
            number(v.position),
            number(v.tension),
            " ".join(v.why.split())[:110].replace("|", "/"),
        )
        for _, v in sorted(bad, key=badness)[:most]
    ]
    return table(("seed", "outcome", "what", "position", "tension", "in words"), lines)


def figure(rows: Sequence[tuple[Drawn, Verdict]], path: Path) -> None:
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


def _taken(verdicts: Sequence[Verdict]) -> str:
    """At what tolerances runs converged, where they were asked to, and how sure that is."""
    sentences = []
    for name, first in (("The first set", 0), ("The second, by which no rule was made", COUNT)):
        of_set = [v for v in verdicts if first <= v.seed < first + COUNT]
        judged = [v for v in of_set if TOOK in v.statistics and v.outcome in ("completed", "wrong")]
        if not judged:
            continue
        wrong = sum(v.outcome == "wrong" for v in judged)
        sure = binomtest(wrong, len(judged)).proportion_ci(0.95)
        counts = sorted(Counter(v.statistics[TOOK] for v in judged).items())
        sentences.append(
            f"{name}: of {len(of_set)} scenes {len(judged)} converged and were judged ("
            + ", ".join(f"{count} at tau/{finer}" for finer, count in counts)
            + f"), {wrong} of them wrong: {100 * sure.low:.2g} to {100 * sure.high:.2g} % of such "
            "scenes (95 %, exact binomial)."
        )
    return " ".join(sentences) + "\n" if sentences else ""


def section(search: Search, verdicts: Sequence[Verdict], page: Path) -> str:
    """The whole section; its figure lies beside the page."""
    rows = [(draw(v.seed), v) for v in verdicts]
    picture = search.beside(page, ".png")
    figure(rows, picture)
    judged = [v for v in verdicts if v.outcome in ("completed", "unsettled", "wrong")]
    part = np.mean([v.compared for v in judged]) if judged else math.nan
    whole = sum(v.compared > 0.99 for v in judged)
    return "\n".join(
        (
            search.header,
            _taken(verdicts)
            or f"{len(rows)} of {search.count} scenes. Of the {len(judged)} that ran to their end, "
            f"{whole} could be compared to the end, and {100 * part:.0f} % of all instants; "
            "comparing stops where the motion cannot be predicted or where a scene is already "
            "wrong.\n",
            f"![outcomes](stress/{picture.name})\n",
            outcome_table(rows),
            wrong_table(search, verdicts),
            f"The worst of them (differences from {search.by} in units of the promise, of "
            f"which {search.limit:.4g} is allowed):\n",
            worst_table(search, rows),
        )
    )
