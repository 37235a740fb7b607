"""What all random searches came to, in one table at the top of the page: from what is stored."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path

from benchmarks.random_scenes import estimate
from benchmarks.random_scenes.failures import BY_THE_PROMISE
from benchmarks.random_scenes.report import ALL, AT_SEA, CONVERGED, Search
from benchmarks.sections import table, write_part

TITLE = "random scenes"
"""The mark of the part."""
_WORDS = (
    (ALL, "single runs"),
    (AT_SEA, "single runs in waves"),
    (CONVERGED, "runs that are asked to converge"),
)


def write(page: Path) -> None:
    """Write the part anew; what is not stored yet is left out."""
    write_part(page, TITLE, summary(page.parent / page.stem))


def summary(stored: Path) -> str:
    """A row for each search, from the files in that folder."""
    head = (
        "what is run", "scenes", "crashed", "impossible", "says that it is right", "is not",
        "misses its promise",
    )  # fmt: skip
    rows = [_of(search, words, stored) for search, words in _WORDS]
    rows.append(_of_estimates(stored))
    return table(head, [row for row in rows if row is not None])


def _of(search: Search, words: str, stored: Path) -> tuple[str, ...] | None:
    store = stored / search.file(".json")
    if not store.exists():
        return None
    rows = json.loads(store.read_text())
    counts = Counter(row["outcome"] for row in rows)
    impossible = sum(bool(set(row["kinds"]) - BY_THE_PROMISE) for row in rows)
    ended = counts["completed"] + counts["wrong"]
    missed = _share(counts["wrong"], ended if search.claimed else ended + counts["unsettled"])
    claims = (str(ended), str(counts["wrong"])) if search.claimed else ("claims nothing", "")
    return (words, str(len(rows)), str(counts["crashed"]), str(impossible), *claims, missed)


def _of_estimates(stored: Path) -> tuple[str, ...] | None:
    store = stored / estimate.STORE.name
    if not store.exists():
        return None
    counts = Counter(row["outcome"] for row in json.loads(store.read_text()))
    silent, total = counts[estimate.SILENT], counts.total()
    claims = (str(counts[estimate.KEPT] + silent), str(silent))
    missed = _share(counts[estimate.WARNED] + silent, total)
    words = "runs with an estimate of their errors"
    return (words, str(total), "", "", *claims, missed)


def _share(part: int, whole: int) -> str:
    return f"{part} of {whole} ({100 * part / max(whole, 1):.2g} %)"
