"""What programs write of their results: rows in data files, and parts of pages between marks.

A page's words are written by hand; a program owns what stands between its mark and the next end.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Iterable, Sequence
from pathlib import Path


def write_part(page: Path, name: str, text: str) -> None:
    """Replace what stands between ``<!-- name: generated -->`` and the next ``<!-- end -->``.

    Raises ValueError where the page has no such marks, or more than one pair of them.
    """
    old = page.read_text(encoding="utf-8")
    mark = re.compile(
        rf"(<!-- {re.escape(name)}: generated -->\n).*?(<!-- end -->)", flags=re.DOTALL
    )
    new, count = mark.subn(lambda match: f"{match[1]}\n{text.strip()}\n\n{match[2]}", old)
    if count != 1:
        raise ValueError(f"{page}: {count} parts marked {name!r}; allowed: one")
    page.write_text(new, encoding="utf-8")


def write_rows(path: Path, head: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """A table as a CSV file; a comma in a cell is quoted."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", encoding="utf-8", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        writer.writerows(rows)


def read_rows(path: Path) -> list[dict[str, str]]:
    """The rows of a CSV file by the names in its head."""
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table, without blanks about its cells: each would count as a word."""
    lines = ["|" + "|".join(head) + "|", "|" + "---|" * len(head)]
    lines += ["|" + "|".join(row) + "|" for row in rows]
    return "\n".join(lines) + "\n"
