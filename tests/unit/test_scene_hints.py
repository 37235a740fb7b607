"""A slip in any key of a scene is told the right key; a word for something else is told none."""

from __future__ import annotations

from typing import Any

import pytest

from cablemodel.scene import scene_json_schema
from cablemodel.scene.problems import suggestion


def mappings() -> list[list[str]]:
    """The keys of every mapping of the schema."""
    schema = scene_json_schema()
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
]
"""Of other programs, for what scenes do not have."""


@pytest.mark.parametrize("word", OTHER_WORDS)
def test_a_word_for_something_else_is_told_no_key(word: str) -> None:
    told = {hint for keys in mappings() if (hint := suggestion(word, keys))}
    assert not told
