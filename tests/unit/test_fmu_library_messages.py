"""What an export says where a platform's library is not here, and nothing could make it."""

from __future__ import annotations

import pytest

from cablemodel_fmu import export


@pytest.mark.parametrize(
    ("here", "words"),
    [
        (("linux64",), "for win64, darwin64 that fits the kernels: pip install 'cablemodel[fmu]'"),
        (("linux64",), "leave them out: --platform linux64"),
        ((), "for linux64, win64, darwin64 that fits"),
    ],
)
def test_it_says_at_once_what_to_do(
    here: tuple[str, ...], words: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    fits = {"kernels": export.kernel_hash()}
    monkeypatch.setattr(export, "description", lambda name: fits if name in here else None)
    monkeypatch.setattr(export, "find_spec", lambda _name: None)
    told: list[str] = []
    with pytest.raises(export.ExportError) as caught:
        export._libraries(("linux64", "win64", "darwin64"), told.append)
    assert words in str(caught.value)
    assert ("--platform" in str(caught.value)) == bool(here)
    assert not told  # nothing is compiled first
