"""The JSON schema and the reference page say what the code does."""

from __future__ import annotations

import importlib.util
import json
import re
from collections import Counter
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
import yaml
from jsonschema import Draft202012Validator
from scene_examples import full, minimal

import cablemodel as cm
from cablemodel.scene import scene_json_schema, unit_at
from cablemodel.scene.load import is_system
from cablemodel.systems import SystemScene

ROOT = Path(__file__).parents[2]
READY = sorted([*ROOT.glob("scenes/**/*.yaml"), *ROOT.glob("cablemodel/cli/templates/*.yaml")])


@pytest.fixture(scope="module")
def validator() -> Draft202012Validator:
    schema = json.loads(json.dumps(scene_json_schema(), allow_nan=False))
    Draft202012Validator.check_schema(schema)
    return Draft202012Validator(schema)


@pytest.mark.parametrize("data", [minimal(), full()], ids=["minimal", "full"])
def test_schema_accepts_what_loads(validator: Draft202012Validator, data: dict[str, Any]) -> None:
    assert list(validator.iter_errors(data)) == []
    assert list(validator.iter_errors(cm.load_scene(data).to_dict())) == []


@pytest.mark.parametrize("path", READY, ids=lambda p: p.stem)
def test_schema_accepts_the_ready_scenes(validator: Draft202012Validator, path: Path) -> None:
    data = yaml.safe_load(path.read_text(encoding="utf-8"))
    if is_system(data):
        validator = Draft202012Validator(json.loads(json.dumps(scene_json_schema(SystemScene))))
    assert list(validator.iter_errors(data)) == []


@pytest.mark.parametrize(
    "change",
    [
        {"zzz": 1},
        {"line": 5},
        {"end": "fixed"},
        {"end": {}},
        {"environment": {"gravity": True}},
        {"environment": {"gravity": -1}},
        {"environment": {"current": [1, 2]}},
        {"vessel": {"velocity": {"fil": "x"}}},
        {"solver": {"method": "fem"}},
    ],
)
def test_schema_refuses_what_does_not_load(
    validator: Draft202012Validator, change: dict[str, Any]
) -> None:
    assert not validator.is_valid(minimal() | change)
    with pytest.raises(cm.SceneError):
        cm.load_scene(minimal() | change)


def test_schema_names_unit_and_meaning_of_every_key() -> None:
    schema = scene_json_schema()
    for name, definition in {**schema["$defs"], "Scene": schema}.items():
        mapping = definition["anyOf"][1] if "anyOf" in definition else definition
        for key, field in mapping["properties"].items():
            assert field.get("description"), f"{name}.{key} has no description"


@pytest.mark.parametrize(
    ("path", "unit"),
    [
        ("line.0.cable.length", "m"),
        ("cable_types.K.mass", "kg/m"),
        ("payout.drum.1.body.drag_area", "m2"),
        ("environment.waves.jonswap.tp", "s"),
        ("vessel.velocity", "m/s"),
        ("vessel.velocity.0", "m/s"),
        ("vessel.velocity.0.velocity.2", "m/s"),
        ("vessel.path.1.turn.angle", "rad"),
        ("end.anchor.0", "m"),
        ("cable_types.K.drag_normal", ""),
        ("line.0.cable.model", ""),
        ("line.0", ""),
        ("nothing.like.it", ""),
    ],
)
def test_unit_of_a_place(path: str, unit: str) -> None:
    assert unit_at(path) == unit


def page_writer() -> ModuleType:
    path = ROOT / "docs" / "write_scene_reference.py"
    spec = importlib.util.spec_from_file_location("write_scene_reference", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_reference_page_is_up_to_date() -> None:
    written = (ROOT / "docs" / "scene.md").read_text(encoding="utf-8")
    assert written == page_writer().scene_reference(), "run `make docs`"


def keys_of(schema: Any) -> Counter[str]:
    """Every key that any mapping of a JSON schema may have, as often as there are such mappings."""
    if isinstance(schema, list):
        return sum((keys_of(part) for part in schema), Counter())
    if not isinstance(schema, dict):
        return Counter()
    own = schema.get("properties", {})
    rest = (part for word, part in schema.items() if word not in ("properties", "default"))
    return sum((keys_of(part) for part in (*own.values(), *rest)), Counter(own.keys()))


def test_reference_page_lists_every_key_of_the_schema() -> None:
    """Also those of mappings inside a field, as {file: NAME, topic: NAME} for a velocity."""
    page = (ROOT / "docs" / "scene.md").read_text(encoding="utf-8")
    listed = re.findall(r"^\|`([\w.]+)`\|", page, flags=re.MULTILINE)
    assert "velocity.topic" in listed
    assert Counter(path.rpartition(".")[2] for path in listed) == keys_of(scene_json_schema())


def test_example_on_the_reference_page_loads() -> None:
    text = page_writer().INTRODUCTION.split("```yaml\n")[1].split("```")[0]
    scene = cm.load_scene(text)
    assert scene.cable_types["rope"].diameter == 0.012
    assert scene.cable_types["rope"].axial_stiffness == 1e6
