"""What the site adds to the pages: files of the repository that they link to, and data as tables.

MkDocs calls these functions while it builds (``mkdocs.yml``). A page may link to a file outside of
docs/, as GitHub shows it; the file is copied into the site. A link to nothing stays as it is, and
fails the build.
"""

from __future__ import annotations

import csv
import html as escapes
import re
from pathlib import Path
from typing import Any

import typst
from mkdocs.structure.files import File

DOCS = Path(__file__).parent
ROOT = DOCS.parent
CONSTANTS = "engine/constants"
"""The data file that becomes a page."""
RECORDS = "engine/records"
LAYOUT = ROOT / "cablemodel" / "solvers" / "shared" / "layout.py"
"""The declarations that become a page."""

METHOD = "method/method"
"""The paper, whose source becomes a PDF."""

_LINK = re.compile(r"(?<=\]\()(?![a-z]+:|#)([^)#\s]+)")


def on_files(files: Any, config: Any, **_: Any) -> Any:
    """The pages of constants and of records, made from data and declarations, and the paper."""
    with (DOCS / f"{CONSTANTS}.csv").open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    files.append(File.generated(config, f"{CONSTANTS}.md", content=_constants(rows)))
    files.append(File.generated(config, f"{RECORDS}.md", content=_records()))
    paper = typst.compile(DOCS / f"{METHOD}.typ", root=ROOT, ignore_system_fonts=True)
    files.append(File.generated(config, f"{METHOD}.pdf", content=paper))
    return files


def on_page_markdown(markdown: str, page: Any, config: Any, files: Any, **_: Any) -> str:
    """Links out of docs/ lead to copies in the site."""
    here = Path(page.file.src_uri).parent

    def target(match: re.Match[str]) -> str:
        there = (DOCS / here / match[1]).resolve()
        if there == DOCS / f"{CONSTANTS}.csv":
            return match[1].replace(".csv", ".md")
        if there == LAYOUT:
            return "../" * len(here.parts) + f"{RECORDS}.md"
        if there == DOCS / f"{METHOD}.typ":
            return match[1].replace(".typ", ".pdf")
        if there.is_relative_to(DOCS) or not there.exists() or not there.is_relative_to(ROOT):
            return match[1]
        name = f"repository/{there.relative_to(ROOT)}"
        up = "../" * len(here.parts)
        for path in sorted(there.glob("*.yaml")) if there.is_dir() else [there]:
            copy = f"{name}/{path.name}" if there.is_dir() else name
            if files.get_file_from_path(copy) is None:
                files.append(File.generated(config, copy, abs_src_path=str(path)))
        if not there.is_dir():
            return f"{up}{name}"
        index = f"{name}/index.html"
        if files.get_file_from_path(index) is None:
            files.append(File.generated(config, index, content=_listing(there)))
        return f"{up}{index}"

    return _LINK.sub(target, _with_scene(markdown, DOCS / here))


def on_page_content(html: str, page: Any, **_: Any) -> str:
    """Links of notebooks to pages, which MkDocs does not see."""
    if not page.file.src_uri.endswith(".ipynb"):
        return html
    for target in re.findall(r'href="(\w+\.md)"', html):
        if not (DOCS / page.file.src_uri).with_name(target).exists():
            raise ValueError(f"{page.file.src_uri} links to {target}, which is not there")
    return re.sub(r'href="(\w+)\.md"', r'href="\1.html"', html)


def _with_scene(markdown: str, folder: Path) -> str:
    """A page of the job book shows its scene, which is a file beside it."""

    def shown(match: re.Match[str]) -> str:
        text = (folder / match[1]).read_text(encoding="utf-8")
        return f"{match[0]}\n\n```yaml\n{text.strip()}\n```"

    return re.sub(r"^Scene: \[[\w.]+\]\(([\w.]+)\)$", shown, markdown, flags=re.MULTILINE)


def _listing(folder: Path) -> str:
    names = [escapes.escape(path.name) for path in sorted(folder.glob("*.yaml"))]
    items = "\n".join(f'<li><a href="{name}">{name}</a></li>' for name in names)
    return f"<!doctype html>\n<title>{escapes.escape(folder.name)}</title>\n<ul>\n{items}\n</ul>\n"


def _constants(rows: list[list[str]]) -> str:
    """A table for each module."""
    head, *body = rows
    place = head.index("module")
    lines = [
        "# Constants",
        "",
        "Numbers that steer the engine, and where each comes from. Values and effects are read",
        "from the code; the date is that of the line. `calibrated` is what was chosen by runs of",
        "what is named.",
    ]
    module = ""
    for row in body:
        cells = [cell.replace("|", "\\|") for cell in row]
        if cells.pop(place) != module:
            module = row[place]
            lines += ["", f"## `{module}`", ""]
            names = [name for name in head if name != "module"]
            lines += ["| " + " | ".join(names) + " |", "|" + "---|" * len(names)]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def _records() -> str:
    """A table for each record of the block's memory."""
    from cablemodel.solvers.shared import layout
    from cablemodel.solvers.shared.record import Part, Spare, described, records

    lines = [
        "# Memory",
        "",
        "A model's state is one block of memory, of words of eight bytes. What they are, record by",
        "record, as `cablemodel/solvers/shared/layout.py` declares it.",
    ]
    for record in records(layout):
        lines += ["", f"## {record.__name__}", "", (record.__doc__ or "").strip(), ""]
        lines += ["| word | field | words | meaning |", "|---|---|---|---|"]
        for name, field in record.FIELDS.items():
            if isinstance(field, Spare):
                continue
            of = (
                f", a [{field.of.__name__}](#{field.of.__name__.lower()})"
                if isinstance(field, Part)
                else ""
            )
            told = described(field).replace("|", "\\|")
            lines.append(f"| {field.word} | `{name}` | {field.words} | {told}{of} |")
    return "\n".join(lines) + "\n"
