"""Links from page to page lead to files and headings that are there; pages stay few and short."""

import re
from itertools import pairwise
from pathlib import Path

import pytest
from markdown_it import MarkdownIt

ROOT = Path(__file__).parents[2]
FOLDERS = ("docs", "fmu", "ros2_node")
PAGES = sorted(
    [*ROOT.glob("*.md"), *(page for at in FOLDERS for page in (ROOT / at).rglob("*.md"))]
)


def anchors(page: Path) -> set[str]:
    """The headings of a page, as GitHub names them."""
    tokens = MarkdownIt().parse(page.read_text(encoding="utf-8"))
    titles = (text.content for token, text in pairwise(tokens) if token.type == "heading_open")
    plain = (re.sub(r"[^\w\- ]", "", title.lower()) for title in titles)
    return {title.replace(" ", "-") for title in plain}


def links(page: Path) -> list[str]:
    """Where a page's links and pictures lead."""
    parser = MarkdownIt().enable("table")
    found = []
    for token in parser.parse(page.read_text(encoding="utf-8")):
        for part in token.children or []:
            target = part.attrGet("href") or part.attrGet("src")
            if target:
                found.append(str(target))
    return found


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page: Path) -> None:
    broken = []
    for target in links(page):
        if re.match(r"[a-z]+:", target):
            continue
        name, _, anchor = target.partition("#")
        there = page.parent / name if name else page
        if not there.exists() or (anchor and anchor not in anchors(there)):
            broken.append(target)
    assert not broken


def test_engine_pages_are_all_listed() -> None:
    index = ROOT / "docs" / "engine.md"
    listed = {Path(target).name for target in links(index) if re.match(r"engine/.*\.md$", target)}
    assert listed == {page.name for page in (ROOT / "docs" / "engine").glob("*.md")}


def test_words_of_the_documentation_stay_within_their_budget() -> None:
    """As `wc -w` counts; measurements are rows in data files, and no prose."""
    pages = [ROOT / "README.md", ROOT / "CHANGELOG.md", *(ROOT / "docs").rglob("*.md")]
    words = {page: len(page.read_text(encoding="utf-8").split()) for page in pages}
    assert sum(words.values()) <= 30_000, sorted(words.items(), key=lambda item: -item[1])[:5]


def test_every_page_is_on_the_site() -> None:
    """`make docs` builds it, with pages made from data and from declarations."""
    site = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    listed = re.findall(r"^ +- (?:[^:\n]+: )?(\S+\.md)$", site, flags=re.MULTILINE)
    pages = {str(page.relative_to(ROOT / "docs")) for page in (ROOT / "docs").rglob("*.md")}
    assert sorted(listed) == sorted({*pages, "engine/constants.md", "engine/records.md"})


CODE = ("cablemodel", "tests", "benchmarks", "fmu", "ros2_node", "examples", "docs")
MAINTAINERS = sorted(
    [*(ROOT / "docs" / "engine").glob("*.md"), *(ROOT / "docs").glob("[ades]*.md")]
)
"""Pages that name files and functions: architecture, decisions, engine, stress among others."""


def test_files_and_functions_that_pages_name_are_there() -> None:
    places = [ROOT, ROOT / "docs", *(ROOT / folder for folder in CODE)]
    places += [ROOT / "tests" / "verification", ROOT / "benchmarks" / "random_scenes"]
    solvers = ROOT / "cablemodel" / "solvers"
    places += [path for path in solvers.rglob("*") if path.is_dir()] + [solvers]
    sources = (path for folder in CODE for path in (ROOT / folder).rglob("*.py"))
    words = {word for path in sources for word in re.findall(r"\w+", path.read_text("utf-8"))}
    missing = []
    for page in MAINTAINERS:
        for name in re.findall(r"`([^`\n]+)`", page.read_text(encoding="utf-8")):
            if re.fullmatch(r"[\w/*\[\]]+\.(py|csv|json|md|yaml)", name):
                if not any(list(place.glob(name)) for place in places):
                    missing.append((page.name, name))
            elif re.fullmatch(r"\w+_\w+(\(\))?", name) and name.removesuffix("()") not in words:
                missing.append((page.name, name))
    assert not missing
