"""The paper of the method is made from its source and from the data files of the docs."""

from pathlib import Path

import pytest
import typst

DOCS = Path(__file__).parents[2] / "docs"
SOURCE = DOCS / "method" / "method.typ"


def test_it_has_about_eight_pages() -> None:
    """Numbers whose row, column or name is gone make this fail."""
    pages = typst.compile(SOURCE, root=DOCS.parent, format="png", ppi=20, ignore_system_fonts=True)
    assert 7 <= len(pages) <= 9


def test_a_number_that_is_not_in_the_data_is_an_error(tmp_path: Path) -> None:
    text = SOURCE.read_text(encoding="utf-8").replace('"BENDS"', '"NO_SUCH"')
    (tmp_path / "docs" / "method").mkdir(parents=True)
    for name in ("benchmarks", "engine", "figures", "stress", "validation"):
        (tmp_path / "docs" / name).symlink_to(DOCS / name)
    (tmp_path / "pyproject.toml").symlink_to(DOCS.parent / "pyproject.toml")
    (tmp_path / "docs" / "method" / "references.yml").symlink_to(SOURCE.parent / "references.yml")
    copy = tmp_path / "docs" / "method" / "method.typ"
    copy.write_text(text, encoding="utf-8")
    with pytest.raises(typst.TypstError, match=r"scales\.py\.NO_SUCH is no constant"):
        typst.compile(copy, root=tmp_path)
