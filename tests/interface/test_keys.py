"""``cablemodel keys``: what a scene, or a part of it, may say."""

from __future__ import annotations

from contextlib import suppress
from typing import Any

import pytest
from typer.testing import CliRunner, Result

import cablemodel as cm
from cablemodel.cli import app
from cablemodel.scene import Scene, scene_json_schema
from cablemodel.scene.reference import definition, keys_of, word_of
from cablemodel.systems import SystemScene


def invoke(*arguments: str) -> Result:
    return CliRunner(env={"COLUMNS": "200"}).invoke(app, ["keys", *arguments])


def names(kind: Any, path: str) -> set[str]:
    return {key.name for key in keys_of(definition(scene_json_schema(kind), path))}


def test_a_part_is_found_by_its_path_with_and_without_names_and_numbers() -> None:
    assert names(Scene, "") == set(Scene.model_fields)
    cable = {"type", "length", "model", "elements"}
    assert names(Scene, "line.cable") == names(Scene, "line.3.cable") == cable
    assert names(Scene, "payout.drum.cable") == cable
    assert names(SystemScene, "lines.items.cable") == names(SystemScene, "lines.tow.items.0.cable")
    assert names(SystemScene, "bodies.fish.hull") == {"diameter", "height", "centre"}
    assert names(Scene, "environment.floor.depth_table") == {"x", "y", "z"}
    assert names(Scene, "end.connection") == {"clamped"}
    assert {"velocity.file", "velocity.topic"} <= names(Scene, "vessel")


def test_keys_come_with_unit_default_and_meaning() -> None:
    done = invoke("environment")
    assert done.exit_code == 0
    (row,) = [line for line in done.stdout.splitlines() if "water_density" in line]
    assert [cell.strip() for cell in row.split("│")[1:-1]] == [
        "water_density", "number ≥ 0 [kg/m3]", "1025.0", "density of the water; 0 is vacuum",
    ]  # fmt: skip
    assert "submerged_weight" in invoke("--system", "bodies").stdout


@pytest.mark.parametrize(
    ("path", "words"),
    [
        ("vesel", "vesel: 'vesel' is no key there, did you mean vessel?; allowed: title,"),
        ("vessel.postion", "vessel.postion: 'postion' is no key there, did you mean position?"),
        ("vessel.position", "vessel.position: has no keys of its own: list of 3 numbers: position"),
        ("vessel.position.x", "vessel.position: has no keys of its own"),
        ("line.0.bdy", "line.bdy: 'bdy' is no key there"),
        ("body", "body: 'body' is no key there, it is one of line and of payout.drum; allowed:"),
        ("drag_normal", "'drag_normal' is no key there, it is one of cable_types; allowed: title"),
    ],
)
def test_what_is_no_part_is_told_by_its_place(path: str, words: str) -> None:
    failed = invoke(path)
    assert failed.exit_code == 2
    assert words in failed.stderr


@pytest.mark.parametrize("kind", [Scene, SystemScene])
def test_every_mapping_of_the_schema_is_reached(kind: Any) -> None:
    """By walking from the scene down; no definition is left."""
    schema = scene_json_schema(kind)
    waiting: list[str] = [""]
    seen: set[tuple[str, ...]] = set()
    while waiting:
        path = waiting.pop()
        keys = tuple(definition(schema, path)["properties"])
        if keys in seen:
            continue
        seen.add(keys)
        for key in keys:
            below = f"{path}.{key}".strip(".")
            with suppress(cm.SceneError):  # it has no keys of its own
                definition(schema, below)
                waiting.append(below)
    mappings = {name: word_of(part)[1] for name, part in schema["$defs"].items()}
    assert [name for name, part in mappings.items() if tuple(part["properties"]) not in seen] == []
