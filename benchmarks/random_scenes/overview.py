"""What all random searches came to, in one table at the top of the page: from what is stored."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Any

from benchmarks.random_scenes import estimate
from benchmarks.random_scenes.failures import BY_THE_PROMISE
from benchmarks.random_scenes.report import ALL, AT_SEA, CONVERGED, HELD, JOBS, Search
from benchmarks.sections import table, write_part

TITLE = "random scenes"
"""The mark of the part."""
_WORDS = (
    (ALL, "single runs, in sample"),
    (HELD, "single runs, out of sample"),
    (AT_SEA, "single runs in waves"),
    (JOBS, "single runs of ordinary jobs"),
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


def write_pages() -> None:
    """What is told of all searches: the page of stress, and the few rows of the README."""
    write(Path("docs/stress.md"))
    write_part(Path("README.md"), PROMISE, promise(Path("docs/stress")))


PROMISE = "promise"
"""The mark of the part of the README."""


def promise(stored: Path) -> str:
    """How often runs are wrong, by what a user asks for; all searches must be stored."""
    rows = []
    for search, words in (
        (ALL, "a single run, in sample"),
        (HELD, "a single run, out of sample"),
        (AT_SEA, "a single run in waves"),
        (JOBS, "a single run of an ordinary job, out of sample"),
    ):
        found = Counter(row["outcome"] for row in _read(stored / search.file(".json")))
        rows.append((words, *_rate(found["wrong"], found.total() - sum(found[o] for o in NEVER))))
    judged = json.loads((stored / "random_systems.json").read_text())["systems"]
    untold = [verdict for verdict in judged if verdict["outcome"] in ("kept", "missed")]
    missed = [verdict for verdict in untold if verdict["outcome"] == "missed"]
    of_systems = _rate(len(missed), len(untold))
    unsettled = sum(verdict["outcome"] == "unsettled" for verdict in judged)
    words = f"a single run of a system, unwarned, where finer ones agree ({unsettled} more do not)"
    rows.append((words, *of_systems))
    sure = [verdict for verdict in untold if verdict["share"] <= 1.0]
    of_systems = _rate(sum(verdict["silent"] for verdict in sure), len(sure))
    rows.append(("the same with an estimate, which says that it is right", *of_systems))
    said = Counter(row["outcome"] for row in _read(stored / estimate.STORE.name))
    claimed = said[estimate.KEPT] + said[estimate.SILENT]
    rows.append(
        ("an estimate, which says that the run is right", *_rate(said[estimate.SILENT], claimed))
    )
    found = Counter(row["outcome"] for row in _read(stored / CONVERGED.file(".json")))
    ended = found["completed"] + found["wrong"]
    rows.append(("`converge`, which comes to an end", *_rate(found["wrong"], ended)))
    return table(("you ask for", "random scenes", "wrong"), rows)


NEVER = ("refused", "stopped", "too slow", "crashed")
"""Outcomes of runs that do not come to their end."""


def _read(store: Path) -> list[dict[str, Any]]:
    rows: list[dict[str, Any]] = json.loads(store.read_text())
    return rows


def _rate(part: int, whole: int) -> tuple[str, str]:
    return f"{whole:,}", f"{100 * part / whole:.2g} %"


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
