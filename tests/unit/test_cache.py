"""Where things are kept, whatever the environment says."""

from pathlib import Path

import pytest

from cablemodel.cache import cache_root


@pytest.mark.parametrize(
    ("variables", "wanted"),
    [
        ({"CABLEMODEL_CACHE_DIR": "/a", "XDG_CACHE_HOME": "/b", "HOME": "/c"}, "/a"),
        ({"XDG_CACHE_HOME": "/b", "HOME": "/c"}, "/b/cablemodel"),
        ({"HOME": "/c"}, "/c/.cache/cablemodel"),
        ({"CABLEMODEL_CACHE_DIR": "", "XDG_CACHE_HOME": "", "HOME": "/c"}, "/c/.cache/cablemodel"),
    ],
)
def test_variables_say_where(variables, wanted, monkeypatch):
    for name in ("CABLEMODEL_CACHE_DIR", "XDG_CACHE_HOME", "HOME"):
        monkeypatch.delenv(name, raising=False)
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert cache_root() == Path(wanted)


def test_a_folder_of_ones_own_may_be_relative(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("CABLEMODEL_CACHE_DIR", "kept")
    assert cache_root() == tmp_path / "kept"


def test_without_a_home_a_process_keeps_it_to_itself(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    for name in ("CABLEMODEL_CACHE_DIR", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr("os.path.expanduser", lambda path: path)
    assert cache_root().is_dir()
    assert cache_root().is_absolute()
    assert cache_root() == cache_root()
    assert list(tmp_path.iterdir()) == []
