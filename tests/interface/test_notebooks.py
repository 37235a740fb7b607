"""Notebooks of the job book run, and come to the answers of the book: they assert them."""

from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError

FOLDER = Path(__file__).parents[2] / "docs" / "jobs"
NOTEBOOKS = sorted(FOLDER.glob("*.ipynb"))
pytestmark = [
    # jupyter_client and its kernel warn of their own ways.
    pytest.mark.filterwarnings("ignore::DeprecationWarning"),
    pytest.mark.filterwarnings("ignore::ResourceWarning"),
]


def run(notebook: nbformat.NotebookNode) -> None:
    NotebookClient(notebook, timeout=120, resources={"metadata": {"path": str(FOLDER)}}).execute()


def test_there_are_some_and_the_book_lists_them() -> None:
    listed = (FOLDER / "README.md").read_text(encoding="utf-8")
    assert len(NOTEBOOKS) >= 3
    assert all(f"({path.name})" in listed for path in NOTEBOOKS)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path: Path) -> None:
    notebook = nbformat.read(path, as_version=4)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert not any(cell.outputs or cell.execution_count for cell in code), "clear its outputs"
    assert any("assert " in cell.source for cell in code)
    run(notebook)
    assert any("image/png" in out.get("data", {}) for cell in code for out in cell.outputs)


def test_a_wrong_answer_stops_a_notebook() -> None:
    notebook = nbformat.read(FOLDER / "notebook_fish.ipynb", as_version=4)
    for cell in notebook.cells:
        cell.source = cell.source.replace("<= within", "> within")
    with pytest.raises(CellExecutionError, match="AssertionError"):
        run(notebook)
