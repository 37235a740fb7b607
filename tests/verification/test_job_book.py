"""The job book: answers agree with independent ones, and pages show what was computed."""

from pathlib import Path

import pytest

from validation.jobs import book

ROOT = Path(__file__).parents[2]
LONG = {"turn_with_array": "masses on springs take a minute; `make validate` computes it"}


@pytest.fixture(autouse=True)
def in_the_root(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)


@pytest.mark.parametrize("name", [name for name in book.jobs() if name not in LONG])
def test_answers_agree(name: str) -> None:
    """With the independent ones, and with those of the page within a tenth of that."""
    answers, figure = book.jobs()[name]()
    assert figure.axes
    stored = {answer.quantity: answer for answer in book.read()[name]}
    assert [answer.quantity for answer in answers] == list(stored)
    for answer in answers:
        assert answer.agrees, answer
        shown = stored[answer.quantity]
        assert answer.found == pytest.approx(shown.found, abs=0.1 * answer.within)
        assert answer.independent == pytest.approx(shown.independent, abs=0.1 * answer.within)


@pytest.mark.parametrize("name", book.jobs())
def test_a_page_shows_the_answers(name: str) -> None:
    """A scene, a picture and a table that is what the data render; all of them agree."""
    answers = book.read()[name]
    assert all(answer.agrees for answer in answers)
    page = (book.FOLDER / f"{name}.md").read_text(encoding="utf-8")
    shown = page.split("<!-- answer: generated -->")[1].split("<!-- end -->")[0].strip()
    assert shown == book.table(answers).strip()
    for ending in ("yaml", "png"):
        assert f"({name}.{ending})" in page
        assert (book.FOLDER / f"{name}.{ending}").exists()


def test_every_page_is_a_job() -> None:
    pages = {path.stem for path in book.FOLDER.glob("*.md")} - {"README"}
    assert pages == set(book.jobs())
    assert set(book.read()) == pages
    assert len(pages) >= 20
