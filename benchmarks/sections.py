"""Pages of several programs' results: each program owns the sections of its headings."""

from __future__ import annotations

import re
from pathlib import Path


def write_section(path: Path, title: str, heading: str, text: str) -> None:
    """Replace the section of that heading (level two) in a page, or add it at the end.

    A page that does not exist begins with its title (level one). The section ends where the next
    heading of level two, or the page, does.
    """
    page = path.read_text() if path.exists() else f"# {title}\n"
    section = f"## {heading}\n\n{text.strip()}\n\n"
    pattern = re.compile(rf"^## {re.escape(heading)}\n.*?(?=^## |\Z)", re.MULTILINE | re.DOTALL)
    if pattern.search(page):
        page = pattern.sub(lambda _: section, page)
    else:
        page = page.rstrip("\n") + "\n\n" + section
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(page.rstrip("\n") + "\n")
