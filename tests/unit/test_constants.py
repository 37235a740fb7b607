"""Each number that steers the engine has a row that says where it comes from, and no row is of
yesterday."""

import csv
import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def writer() -> ModuleType:
    spec = importlib.util.spec_from_file_location(
        "write_constants", ROOT / "docs" / "write_constants.py"
    )
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    # A dataclass looks its module up.
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(__import__("sys").modules, "write_constants", module)
        spec.loader.exec_module(module)
    return module


def rows() -> list[dict[str, str]]:
    with (ROOT / "docs" / "engine" / "constants.csv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_every_constant_has_a_row_with_its_value(writer: ModuleType) -> None:
    """After a change of the code: `python docs/write_constants.py`, then fill the row in."""
    code = {(c.module, c.name): c.value for c in writer.constants()}
    stored = {(row["module"], row["name"]): row["value"] for row in rows()}
    assert stored == code
    assert len(stored) > 500


def test_effects_are_those_of_the_code(writer: ModuleType) -> None:
    said = {(c.module, c.name): c.effect for c in writer.constants() if c.effect}
    stored = {(row["module"], row["name"]): row["effect"] for row in rows()}
    assert {key: stored[key] for key in said} == said


def test_a_name_has_one_meaning() -> None:
    """Who searches for it finds one thing: what several modules need is in shared/numbers.py."""
    places: dict[str, list[str]] = {}
    for row in rows():
        places.setdefault(row["name"], []).append(row["module"])
    assert {name: found for name, found in places.items() if len(found) > 1} == {}


def test_no_row_leaves_anything_out() -> None:
    for row in rows():
        assert all(row.values()), row


def test_commands_of_rows_exist() -> None:
    """Programs and tests that show what a constant is worth."""
    for row in rows():
        for word in row["command"].split():
            if word.startswith("tests/"):
                assert (ROOT / word).exists(), row
            elif word.startswith("benchmarks."):
                place = ROOT / word.replace(".", "/")
                assert place.is_dir() or place.with_suffix(".py").exists(), row


def test_a_constant_is_found_with_what_the_code_says_of_it(
    writer: ModuleType, tmp_path: Path
) -> None:
    """Behind it, below it or above it; several in a line; words and names in small letters not."""
    found = {(c.module, c.name): c for c in writer.constants()}
    assert (
        found["solvers/finite_element/kernels/mesh/touchdown_mesh.py", "SPLIT_ABOVE"].value == "1.6"
    )
    assert (
        found["solvers/finite_element/kernels/mesh/touchdown_mesh.py", "JOIN_BELOW"].effect
        == "of the length wanted"
    )
    assert found["solvers/finite_element/start/refinement.py", "FAR_TOO_BENT"].effect.startswith(
        "Times REFINEMENT_BENT, from where on"
    )
    assert ("solvers/shared/layout.py", "EDGE_WORDS") not in found
    assert ("solvers/finite_element/kernels/element/element_planar.py", "R") not in found
    assert found["solvers/shared/layout.py", "LIGHT_DAMPING"].value == "10"
    assert ("solvers/shared/layout.py", "MOTIONS") not in found
    assert found["systems/guess.py", "STANDS_WITHIN"].value == "0.05"
    in_c = found["fmu/cablemodel_fmu/c/system_start.c", "SMALLEST_PART"]
    assert (in_c.value, in_c.effect) == ("0.015625", "of the way, where larger ones fail")
    assert found["fmu/cablemodel_fmu/c/fmi2.c", "ZERO_STEPS"].value == "10"
