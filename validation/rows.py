"""What a comparison leaves: rows of a table, and a picture for each family of them."""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterable
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from benchmarks.sections import read_rows, write_part, write_rows

DOCS = Path("docs")
STORE = DOCS / "validation" / "results.csv"
PAGE = DOCS / "validation.md"
DATA = Path(__file__).parent / "data"


@dataclass(frozen=True)
class Row:
    """One comparison. `result` is a deviation in `unit`: it is met where it is at most `limit`."""

    family: str
    case: str
    reference: str
    metric: str
    result: float
    limit: float
    unit: str

    @property
    def met(self) -> bool:
        """Whether the deviation is within what is accepted."""
        return self.result <= self.limit

    @property
    def command(self) -> str:
        """What makes it again."""
        return f"python -m validation {self.family}"


@dataclass(frozen=True)
class Family:
    """Comparisons of one kind: `run()` returns their rows and draws a picture of them."""

    name: str
    title: str
    run: Callable[[], tuple[list[Row], Any]]


FAMILIES: dict[str, Family] = {}
MODULES = (
    "statics",
    "motions",
    "snaps",
    "stops",
    "lays",
    "systems",
    "tank",
    "published",
    "codes",
    "whoi",
    "industry",
)
"""Where families are defined, in the order of the page."""


def family(name: str, title: str) -> Callable[[Callable[[], Any]], Callable[[], Any]]:
    """Register what runs a family."""

    def keep(run: Callable[[], tuple[list[Row], Any]]) -> Callable[[], Any]:
        FAMILIES[name] = Family(name, title, run)
        return run

    return keep


def families() -> dict[str, Family]:
    """All families, in the order of the page."""
    for module in MODULES:
        importlib.import_module(f"validation.{module}")

    def place(one: Family) -> int:
        return MODULES.index(one.run.__module__.removeprefix("validation."))

    return {one.name: one for one in sorted(FAMILIES.values(), key=place)}


def relative(found: float, expected: float) -> float:
    """Deviation in per cent of what is expected."""
    return 100.0 * abs(float(found) - float(expected)) / abs(float(expected))


def write(rows: Iterable[Row]) -> None:
    """The data file; rows of families that were not run stay."""
    new = list(rows)
    ran = {row.family for row in new}
    kept = read() if STORE.exists() else []
    order = list(families())
    merged = sorted(
        [*(row for row in kept if row.family not in ran and row.family in order), *new],
        key=lambda row: order.index(row.family),
    )
    names = [field.name for field in fields(Row)]
    body = [
        [_text(getattr(row, name)) for name in names] + ["yes" if row.met else "no", row.command]
        for row in merged
    ]
    write_rows(STORE, [*names, "met", "command"], body)


def _text(value: Any) -> str:
    return f"{value:.3g}" if isinstance(value, float) else str(value)


def read() -> list[Row]:
    """The rows of the data file."""
    names = [field.name for field in fields(Row)]
    return [
        Row(**{n: float(row[n]) if n in ("result", "limit") else row[n] for n in names})
        for row in read_rows(STORE)
    ]


def tables() -> str:
    """What the page shows: a table and a picture for each family.

    Cells have no blanks about them: every one would count as a word of the documentation. Case and
    reference are those above where a row does not name one; limits have the result's unit.
    """
    rows, parts = read(), []
    for one in families().values():
        mine = [row for row in rows if row.family == one.name]
        if not mine:
            continue
        parts += [f"### {one.title}", "", f"`{mine[0].command}`", ""]
        parts += ["|case|reference|deviation|result|accepted|", "|---|---|---|---|---|"]
        above = ("", "")
        for row in mine:
            unit = f" {row.unit}" if row.unit else ""
            limit = f"{row.limit:.3g}" + ("" if row.met else ", **not met**")
            about = (row.case, row.reference)
            named = ["" if one == other else one for one, other in zip(about, above, strict=True)]
            above = about
            cells = [*named, row.metric, f"{row.result:.3g}{unit}", limit]
            parts.append("|" + "|".join(cells) + "|")
        parts += ["", f"![{one.title}](validation/{one.name}.png)", ""]
    return "\n".join(parts)


def summary() -> str:
    """How many rows there are, and how many are met."""
    rows = read()
    missed = [row for row in rows if not row.met]
    return f"{len(rows)} rows, {len(rows) - len(missed)} within what is accepted."


def render() -> None:
    """Write the generated parts of the page."""
    write_part(PAGE, "summary", summary())
    write_part(PAGE, "rows", tables())
