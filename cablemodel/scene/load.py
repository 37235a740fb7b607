"""Reading a scene: from a file, YAML text or a mapping, with overrides by path."""

from __future__ import annotations

import copy
import os
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from cablemodel.errors import SceneError, shown
from cablemodel.scene.problems import problems_of
from cablemodel.scene.schema import Document, Scene
from cablemodel.scene.text import parse_yaml

_LOG = b"\x89MCAP"
"""What an MCAP file begins with."""

_OVERRIDES = 'texts "path=value", such as "line.0.cable.length=50"'

Kind = TypeVar("Kind", bound=Document)

SceneSource = str | os.PathLike[str] | Mapping[str, Any]


def load_scene(
    source: SceneSource,
    overrides: str | Iterable[str] = (),
    folder: str | os.PathLike[str] | None = None,
) -> Scene:
    """Read and check a scene.

    Args:
        source: a file, YAML text (text with a line break), or a mapping as YAML would give.
        overrides: ``"line.0.cable.length=50"``: values in YAML put in place before the check; one,
            or several.
        folder: where files that the scene names are; by default that of the scene's own file,
            else the working directory.

    Returns:
        The scene, all numbers in SI.

    Raises:
        SceneError: naming every problem with its path, its value and what is allowed.
    """
    text, name, data = read_content(source)
    if is_system(data):
        raise _no_single_line(name or "")
    return loaded(Scene, (text, name, data), overrides, folder)


def _no_single_line(source: str) -> SceneError:
    problem = "lines between vessels and bodies are a system, not a scene of one line"
    allowed = "line, from a vessel outwards; in Python load_system and SystemModel take systems"
    error = SceneError.at("lines", None, problem, allowed)
    error.source = source
    return error


def loaded(
    kind: type[Kind],
    content: tuple[str | None, str | None, Mapping[str, Any]],
    overrides: str | Iterable[str] = (),
    folder: str | os.PathLike[str] | None = None,
) -> Kind:
    """A scene of a kind from what `read_content` gave; otherwise as `load_scene`."""
    text, name, data = content
    if folder is None:
        folder = Path(name).parent if name is not None else Path()
    overrides = listed(overrides)
    try:
        scene = _validated(kind, apply_overrides(data, overrides), Path(folder))
    except SceneError as error:
        error.source = error.source or name or ""
        raise
    # The text tells what was read only if nothing was changed on the way.
    scene._source_text = None if overrides else text
    scene._source_path = name
    return scene


def is_system(data: Mapping[str, Any]) -> bool:
    """Whether plain data are those of a system (cablemodel/systems), by the key ``lines``."""
    return "lines" in data and "line" not in data


def scene_of(source: Document | SceneSource) -> Scene:
    """A scene as it is, or read from what `load_scene` takes.

    Raises:
        SceneError: neither, or a scene that is wrong.
    """
    if isinstance(source, Scene):
        return source
    if isinstance(source, Document):
        raise _no_single_line("")
    return load_scene(source)


def listed(overrides: str | Iterable[str]) -> list[str]:
    """Overrides as a list; a single one may stand alone.

    Raises:
        SceneError: something else.
    """
    if isinstance(overrides, str):
        return [overrides]
    if not isinstance(overrides, Iterable):
        raise SceneError.at("", overrides, f"{shown(overrides)} are no overrides", _OVERRIDES)
    return list(overrides)


def apply_overrides(data: Mapping[str, Any], overrides: Iterable[str]) -> dict[str, Any]:
    """A copy of a scene's data with values replaced.

    Args:
        data: the scene as plain data.
        overrides: ``path=value`` with the path in dots (numbers count list items from 0) and the
            value in YAML. Mappings on the way are made where they are missing.

    Raises:
        SceneError: not ``path=value``, or no such place.
    """
    changed = dict(data)
    for override in overrides:
        if not isinstance(override, str):
            raise SceneError.at("", override, f"{shown(override)} is no override", _OVERRIDES)
        path, equals, text = override.partition("=")
        if not equals or not path.strip():
            raise SceneError.at("", override, f"{shown(override)} is no override", "path=value")
        if changed is not data:
            changed = copy.deepcopy(changed)
        _put(changed, path.strip(), parse_yaml(text, source=override))
    return changed


def scene_json_schema(kind: type[Document] = Scene) -> dict[str, Any]:
    """JSON schema of a scene of a kind, for editors."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **kind.model_json_schema(mode="validation"),
    }


def unit_at(path: str, kind: type[Document] = Scene) -> str:
    """SI unit of the numbers at a place of a scene (``line.0.cable.length``: m), as scene.md writes
    it; empty where there is none."""
    schema = kind.model_json_schema(mode="validation")
    forms = _forms(schema, schema)
    for part in path.split("."):
        forms = [form for above in forms for form in _below(schema, above, part)]
    units = [str(form["unit"]) for form in forms if "unit" in form]
    return units[0] if units else ""


def _forms(schema: Mapping[str, Any], here: Any) -> list[dict[str, Any]]:
    """What a value may be by a part of a schema, with whatever that refers to."""
    if not isinstance(here, dict):
        return []
    more = list(here.get("anyOf", ()))
    if "$ref" in here:
        more.append(schema["$defs"][here["$ref"].rpartition("/")[2]])
    return [here, *(form for part in more for form in _forms(schema, part))]


def _below(schema: Mapping[str, Any], form: dict[str, Any], part: str) -> list[dict[str, Any]]:
    """What a key of a mapping, or an item of a list, of this form may be."""
    if part.isdecimal() and "items" in form:
        # A vector has its unit as a whole.
        own = {"unit": form["unit"]} if "unit" in form else {}
        return [own, *_forms(schema, form["items"])]
    if part in form.get("properties", {}):
        return _forms(schema, form["properties"][part])
    return _forms(schema, form.get("additionalProperties"))


def read_content(source: SceneSource) -> tuple[str | None, str | None, Mapping[str, Any]]:
    """Text, file name and data of a source."""
    if isinstance(source, Mapping):
        return None, None, source
    if isinstance(source, str) and "\n" in source:
        return source, None, _mapping(parse_yaml(source), "")
    if not isinstance(source, (str, os.PathLike)):
        allowed = "a file, YAML text with line breaks, or a mapping"
        raise SceneError.at("", source, f"{shown(source)} is no scene", allowed)
    name = os.fspath(source)
    try:
        raw = Path(name).read_bytes()
        if raw.startswith(_LOG):
            raise ValueError("it is the log of a run")
        text = raw.decode("utf-8-sig")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        if isinstance(error, UnicodeDecodeError):
            reason = f"no UTF-8 text: byte {error.start} is {error.object[error.start]:#04x}"
        error_ = SceneError.at("", name, f"cannot be read ({reason})", "a scene file in UTF-8")
        error_.source = str(name)
        raise error_ from None
    return text, str(name), _mapping(parse_yaml(text, source=str(name)), str(name))


def _mapping(data: Any, source: str) -> Mapping[str, Any]:
    if not isinstance(data, dict):
        problem = "is empty" if data is None else f"{shown(data)} is not a mapping"
        error = SceneError.at("", data, problem, "a mapping such as {line: ..., ...}")
        error.source = source
        raise error
    return data


def _validated(kind: type[Kind], data: Mapping[str, Any], folder: Path) -> Kind:
    try:
        notes: list[str] = []
        scene = kind.model_validate(dict(data), context={"folder": folder, "notes": notes})
        if isinstance(scene, Scene) and (at_rest := scene.rest_under_way()):
            notes.append(at_rest)
        scene._notes = tuple(notes)
        return scene
    except ValidationError as error:
        raise SceneError(problems_of(error, kind)) from None
    except RecursionError:
        raise SceneError.at("", None, "nested too deeply", "a finite tree of data") from None


def _put(data: dict[str, Any], path: str, value: Any) -> None:
    parts = path.split(".")
    here: Any = data
    for depth, part in enumerate(parts):
        last = depth == len(parts) - 1
        reached = ".".join(parts[: depth + 1])
        if isinstance(here, list):
            if not part.isdecimal() or int(part) >= len(here):
                allowed = f"0 to {len(here) - 1}" if here else "nothing: the list is empty"
                raise SceneError.at(reached, part, "no such list item", allowed)
            if last:
                here[int(part)] = value
            else:
                here = here[int(part)]
        elif isinstance(here, dict):
            if last:
                here[part] = value
            else:
                if here.get(part) is None:
                    here[part] = {}
                here = here[part]
        else:
            above = ".".join(parts[:depth])
            problem = f"{above} is {shown(here)}: it has no parts to set"
            raise SceneError.at(reached, here, problem, f"{above}=...")
