"""Keys of scenes in words, from their JSON schema: for docs/scene.md and the command line."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from cablemodel.errors import SceneError, SceneProblem, shown
from cablemodel.scene.problems import suggestion


@dataclass(frozen=True)
class Key:
    """A key: what kind of value it takes, its default, what it means; empty where there is none."""

    name: str
    kind: str
    default: str
    meaning: str


def keys_of(schema: dict[str, Any], above: str = "") -> Iterator[Key]:
    """Keys of a mapping, each followed by those of a mapping that has no definition of its own."""
    required = set(schema.get("required", ()))
    for key, field in schema["properties"].items():
        path = f"{above}{key}"
        needed = "required in it" if above else "required"
        default = needed if key in required else _default(field)
        kind = " ".join(part for part in (_kind(field), _unit(field)) if part)
        yield Key(path, kind, default, field.get("description", ""))
        for part in (field, *field.get("anyOf", ())):
            if "properties" in part:
                yield from keys_of(part, f"{path}.")


def definition(schema: dict[str, Any], path: str) -> dict[str, Any]:
    """What the schema says of a mapping, by its path in a scene: ``line.body``; empty: the scene.

    Names and numbers of rows may be left out or given: ``lines.items`` is ``lines.tow.items.0``.

    Raises:
        SceneError: there is no such key, or its value is no mapping; says which keys there are.
    """
    found = schema
    walked: list[str] = []
    may_be_name = False
    for part in path.split(".") if path else []:
        field = found["properties"].get(part)
        if field is None and may_be_name:
            may_be_name = False
            continue
        place = ".".join([*walked, part])
        if field is None:
            known = list(found["properties"])
            near = suggestion(part, known)
            if not near and not walked and (homes := _homes(schema, part)):
                near = f", it is one of {' and of '.join(homes)}"
            problem = f"{shown(part)} is no key there{near}"
            raise SceneError([SceneProblem(place, None, problem, ", ".join(known))])
        found = _mapping(schema, field)
        if not found:
            problem = f"has no keys of its own: {_kind(field)}: {field.get('description', '')}"
            raise SceneError([SceneProblem(place, None, problem)])
        walked.append(part)
        may_be_name = _has_names(field)
    return found


_MOST_HOMES = 3
"""Places that are worth naming; more tell nothing."""


def _homes(schema: dict[str, Any], key: str) -> list[str]:
    """Paths of the mappings that have a key, where there are few."""
    waiting: list[tuple[str, dict[str, Any]]] = [("", schema)]
    found: list[str] = []
    for path, mapping in waiting:  # grows on the way
        for name, field in mapping["properties"].items():
            if name == key:
                found.append(path)
            if below := _mapping(schema, field):
                waiting.append((f"{path}.{name}".lstrip("."), below))
    return found if len(found) <= _MOST_HOMES else []


def word_of(schema: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """The word that a definition may be instead of a mapping, or none; and the mapping."""
    if "anyOf" in schema:
        return str(schema["anyOf"][0]["const"]), schema["anyOf"][1]
    return "", schema


def _has_names(field: dict[str, Any]) -> bool:
    """Whether names or numbers stand below a key."""
    below = ("items", "additionalProperties")
    return any(word in part for part in (field, *field.get("anyOf", ())) for word in below)


def _mapping(schema: dict[str, Any], field: dict[str, Any]) -> dict[str, Any]:
    """The mapping that a key's value is, or each of its rows or parts; empty where it is none."""
    parts = (field, *field.get("anyOf", ()))
    for part in parts:
        if "$ref" in part:
            return word_of(schema["$defs"][part["$ref"].rpartition("/")[2]])[1]
        for below in ("items", "additionalProperties"):
            if isinstance(part.get(below), dict) and (found := _mapping(schema, part[below])):
                return found
    return next((part for part in parts if "properties" in part), {})


def _default(field: dict[str, Any]) -> str:
    default = field.get("default")
    if default is None:
        return ""
    if isinstance(default, dict) and "$ref" in field:
        return "as below"
    return f"`{_yaml(default)}`" if not isinstance(default, str) or " " not in default else default


def _yaml(value: Any) -> str:
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_yaml(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(_yaml, value)) + "]"
    return (
        f"{value:g}" if isinstance(value, float) and value < 1000 and value % 1 == 0 else f"{value}"
    )


def _unit(field: dict[str, Any]) -> str:
    units = [str(part["unit"]) for part in (field, *field.get("anyOf", ())) if "unit" in part]
    return f"[{units[0]}]" if units else ""


def _kind(field: dict[str, Any]) -> str:
    """What kind of value, with its bounds."""
    if "enum" in field:
        return " or ".join(f"`{word}`" for word in field["enum"])
    if "$ref" in field:
        return "mapping"
    if "anyOf" in field:
        kinds = []
        for part in field["anyOf"]:
            kind = _kind(part)
            # Every number may be text with a unit: said once, at the top.
            if part.get("type") not in ("null", "string") and kind not in kinds:
                kinds.append(kind)
        if {"type": "string"} in field["anyOf"] and not any("number" in kind for kind in kinds):
            kinds.insert(0, "text")
        return " or ".join(kinds)
    kind = str(field.get("type", ""))
    if kind == "array":
        size = field.get("minItems") if field.get("minItems") == field.get("maxItems") else None
        return f"list of {size} numbers" if size else "list"
    if kind == "object":
        return "mapping"
    if kind in ("number", "integer"):
        bounds = [
            f"{sign} {_yaml(field[word])}"
            for word, sign in (
                ("exclusiveMinimum", ">"),
                ("minimum", "≥"),
                ("exclusiveMaximum", "<"),
                ("maximum", "≤"),
            )
            if word in field
        ]
        name = "number" if kind == "number" else "whole number"
        return " ".join([name, ", ".join(bounds)]).strip()
    return "text" if kind == "string" else kind
