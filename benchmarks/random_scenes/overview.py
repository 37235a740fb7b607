"""What all random searches came to, in one table at the top of the page: from what is stored."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

from benchmarks.random_scenes import estimate
from benchmarks.random_scenes.failures import BY_THE_PROMISE
from benchmarks.random_scenes.report import ALL, AT_SEA, CONVERGED, Search
from benchmarks.report import table
from benchmarks.sections import write_section

TITLE = "What random scenes come to"

_TEXT = """Written by `make stress`, from what its searches stored. *Impossible*: energy from
nowhere, a limit broken, a line that does not carry its weight, numbers that are not finite. *Says
that it is right*: of runs that are asked what they are off by; of those, how many are not. *Misses
its promise*: of runs that come to their end, how many are further from a finer run than their
tolerance promises, whether they say so or not. Single runs are compared as long as the motion can
be predicted, and not where finer runs do not agree either; estimates are judged by a run at tau/16
to the end, in all scenes, so that far more miss it. Each search has a section below.
"""
_WORDS = (
    (ALL, "single runs"),
    (AT_SEA, "single runs in waves"),
    (CONVERGED, "runs that are asked to converge"),
)


def write(page: Path) -> None:
    """Write the section anew; what is not stored yet is left out."""
    write_section(page, "Stress", TITLE, section(page))


def section(page: Path) -> str:
    """The table and what its columns mean."""
    head = (
        "what is run", "scenes", "crashed", "impossible", "says that it is right", "is not",
        "misses its promise",
    )  # fmt: skip
    rows = [_of(search, words, page) for search, words in _WORDS]
    rows.append(_of_estimates(page))
    return f"{_TEXT}\n{table(head, [row for row in rows if row is not None])}"


def _of(search: Search, words: str, page: Path) -> tuple[str, ...] | None:
    store = search.beside(page, ".json")
    if not store.exists():
        return None
    rows = json.loads(store.read_text())
    counts = Counter(row["outcome"] for row in rows)
    impossible = sum(bool(set(row["kinds"]) - BY_THE_PROMISE) for row in rows)
    ended = counts["completed"] + counts["wrong"]
    missed = _share(counts["wrong"], ended if search.claimed else ended + counts["unsettled"])
    claims = (str(ended), str(counts["wrong"])) if search.claimed else ("claims nothing", "")
    return (words, str(len(rows)), str(counts["crashed"]), str(impossible), *claims, missed)


def _of_estimates(page: Path) -> tuple[str, ...] | None:
    store = page.parent / page.stem / estimate.STORE.name
    if not store.exists():
        return None
    counts = Counter(row["outcome"] for row in json.loads(store.read_text()))
    silent, total = counts[estimate.SILENT], counts.total()
    claims = (str(counts[estimate.KEPT] + silent), str(silent))
    missed = _share(counts[estimate.WARNED] + silent, total)
    words = "runs with an estimate of their errors, those that come to their end"
    return (words, str(total), "", "", *claims, missed)


def _share(part: int, whole: int) -> str:
    return f"{part} of {whole} ({100 * part / max(whole, 1):.2g} %)"
