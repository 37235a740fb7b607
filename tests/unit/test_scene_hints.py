"""A slip in any key of a scene is told the right key; a word for something else is told none."""

from __future__ import annotations

import re
from typing import Any

import pytest

from cablemodel.scene import scene_json_schema
from cablemodel.scene.meant import meant
from cablemodel.scene.problems import suggestion
from cablemodel.systems import SystemScene


def mappings() -> list[list[str]]:
    """The keys of every mapping of a scene, of one line or of a system."""
    schema = [scene_json_schema(), scene_json_schema(SystemScene)]
    found: list[list[str]] = []

    def look(part: Any) -> None:
        if isinstance(part, dict):
            if isinstance(part.get("properties"), dict):
                found.append(list(part["properties"]))
            for value in part.values():
                look(value)
        elif isinstance(part, list):
            for value in part:
                look(value)

    look(schema)
    return found


def slips(key: str) -> set[str]:
    """A letter left out, doubled, swapped with the next, or mistaken; underscores forgotten."""
    at = range(len(key))
    made = {key[:n] + key[n + 1 :] for n in at} | {
        key[:n] + key[n] + key[n:] for n in at if key[n] != "_"
    }
    made |= {
        key[:n] + key[n + 1] + key[n] + key[n + 2 :] for n in at[:-1] if "_" not in key[n : n + 2]
    }
    made |= {key[:n] + "x" + key[n + 1 :] for n in at if key[n] != "_"}
    made |= {key.replace("_", ""), key.replace("_", "-"), key.upper()}
    return made


CASES = sorted({(key, tuple(keys)) for keys in mappings() for key in keys if len(key) > 3})


@pytest.mark.parametrize(("key", "keys"), CASES, ids=[f"{key}-{len(keys)}" for key, keys in CASES])
def test_a_slip_is_told_the_key(key: str, keys: tuple[str, ...]) -> None:
    told = {slip: suggestion(slip, list(keys)) for slip in slips(key) - set(keys)}
    wrong = {slip: hint for slip, hint in told.items() if hint != f", did you mean {key}?"}
    assert not wrong


OTHER_WORDS = [
    "lift_coefficient",
    "lift_area",
    "torsional_stiffness",
    "structural_damping",
    "damping_ratio",
    "contents_density",
    "poisson_ratio",
    "fairlead_position",
    "winch_inertia",
    "youngs_modulus",
    "seabed_stiffness",
    "wind_speed",
    "stretch_law",
    "kinematic_viscosity",
    "BA",
    "BAoverEA",
    "EI_damping",
    "CdAx_lift",
    "yield_stress",
    "material_density",
    "pretension",
    "strength",
    "moment",
    "rotation",
    "twist",
    "wavelength",
    "description",
    "location",
    "iterations",
    "integrator",
    "penetration",
    "scheme",
    "force",
    "camber",
]
"""Of other programs and of the trade, for what scenes do not have, or have in other words."""


@pytest.mark.parametrize("word", OTHER_WORDS)
def test_a_word_for_something_else_is_told_no_key(word: str) -> None:
    told = {hint for keys in mappings() if (hint := suggestion(word, keys))}
    assert not told


@pytest.mark.parametrize(
    ("word", "key", "told"),
    [
        ("anchored", "anchor", True),
        ("clamp", "clamped", True),
        ("bodies", "body", True),
        ("drag_coeff", "drag_coefficient", True),
        ("tolarence", "tolerance", True),
        ("time", "title", False),
        ("sampling", "damping", False),
        ("position", "friction", False),
    ],
)
def test_forms_of_a_word_are_that_word_and_what_rhymes_is_not(
    word: str, key: str, told: bool
) -> None:
    assert suggestion(word, ["mass", key]) == (f", did you mean {key}?" if told else "")


def test_words_of_systems_are_told_where_one_line_has_another_way() -> None:
    one = scene_json_schema()["properties"]
    end = scene_json_schema(SystemScene)["$defs"]["LineEnd"]["properties"]
    assert "line" in one
    assert "line" in end
    for word in ("bodies", "cuts"):
        assert meant(word, list(one)).startswith("line")
        assert meant(word, list(end)) == ""


@pytest.mark.parametrize(
    ("word", "key"),
    [
        ("tau", "tolerance"),
        ("sea_floor", "floor"),
        ("bathymetry", "floor: {depth_table: ...}"),
        ("normal_drag", "drag_normal"),
        ("damping", "axial_damping"),
    ],
)
def test_words_of_the_trade_are_told_the_key(word: str, key: str) -> None:
    known = [keys for keys in mappings() if re.split(r"\W", key, maxsplit=1)[0] in keys]
    assert known
    assert meant(word, known[0]) == key
