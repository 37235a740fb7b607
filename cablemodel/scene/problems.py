"""Pydantic's findings in the words of a user: path, value, what is wrong, what is allowed."""

from __future__ import annotations

import difflib
import re
import types
import typing
from collections.abc import Mapping
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError

from cablemodel.errors import SceneProblem, shown
from cablemodel.scene.rows import Rows

_MOST = 20
_KEY_MARK = "[key]"

Location = tuple[int | str, ...]


def problems_of(error: ValidationError, root: type[BaseModel]) -> list[SceneProblem]:
    """All problems in a validation error of ``root``, in the order of the file; at most 20."""
    problems: list[SceneProblem] = []
    for finding in error.errors(include_url=False):
        problems.extend(_translated(dict(finding), root))
    if len(problems) > _MOST:
        rest = len(problems) - _MOST
        problems[_MOST:] = [SceneProblem("", None, f"and {rest} more problems")]
    return problems


def dotted(location: Location) -> str:
    """A place in the words of the file: ``line.0.cable.length``."""
    return ".".join(str(part) for part in location if part != _KEY_MARK)


def _translated(finding: dict[str, Any], root: type[BaseModel]) -> list[SceneProblem]:
    location: Location = finding["loc"]
    kind, value, context = finding["type"], finding["input"], finding.get("ctx") or {}
    if kind == "scenes":
        return list(context["problems"])
    if kind == "scene":
        given = value if context["value"] is None else context["value"]
        path = dotted((*location, *context["at"]))
        return [SceneProblem(path, given, context["problem"], context["allowed"])]
    path = dotted(location)
    if kind == "missing":
        return [SceneProblem(path, None, "is missing", _meaning(root, location))]
    if kind == "extra_forbidden":
        return [_unknown_key(root, location, value)]
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        keys = _keys_at(root, location)
        allowed = f"a mapping with the keys {', '.join(keys)}" if keys else "a mapping"
        return [SceneProblem(path, value, f"{shown(value)} is not a mapping", allowed)]
    if kind in ("tuple_type", "list_type"):
        keys = _keys_at(root, (*location, 0))
        rows = f" of mappings with the keys {', '.join(keys)}" if keys else ""
        meaning = _meaning(root, location)
        allowed = f"a list{rows}{f' ({meaning})' if meaning else ''}"
        return [SceneProblem(path, value, f"{shown(value)} is not a list", allowed)]
    if kind == "default_factory_not_called":
        return []  # it follows from a value that is reported itself
    if kind == "string_type":
        what = "name" if location and location[-1] == _KEY_MARK else "text"
        problem = f"{shown(value)} is not a {what}"
        return [SceneProblem(path, value, problem, "text (in quotes where YAML sees a number)")]
    if kind == "invalid_key":
        return [SceneProblem(path, value, "the key is not text", "keys that are text")]
    if kind == "literal_error":
        allowed = context["expected"].replace("'", "")
        near = suggestion(value, allowed.replace(" or ", ", ").split(", "))
        return [SceneProblem(path, value, f"{shown(value)} is unknown{near}", allowed)]
    if kind == "too_short":
        return [SceneProblem(path, value, "is empty", "at least one")]
    return [SceneProblem(path, value, f"{shown(value)}: {finding['msg']}")]


def _unknown_key(root: type[BaseModel], location: Location, value: Any) -> SceneProblem:
    keys = _keys_at(root, location[:-1])
    near = suggestion(location[-1], keys)
    return SceneProblem(dotted(location), value, f"unknown key{near}", ", ".join(keys))


def suggestion(word: Any, words: list[str]) -> str:
    """A question whether one of the words was meant, where one is like it; else nothing."""
    given = str(word)
    close = max(words, key=lambda known: _likeness(given, known), default="")
    return f", did you mean {close}?" if _likeness(given, close) >= _ALIKE else ""


_ALIKE = 0.6
"""Likeness from which on one word may be meant for another: difflib's own bound."""


def _likeness(given: str, known: str) -> float:
    """How alike two keys are: as the part between underscores is that is least so.

    What they share elsewhere says nothing of what was meant: lift_coefficient is no slip of the pen
    for drag_coefficient, though most of its letters are the same.
    """
    ours, theirs = (re.split(r"[_\W]", word.lower()) for word in (given, known))
    if "".join(ours) == "".join(theirs):
        return 1.0  # but for what stands between the parts
    if len(ours) != len(theirs):
        return 0.0
    pairs = list(zip(ours, theirs, strict=True))
    # Beside longer parts, two letters (accuracy_of) are too few to mean something else.
    long = [pair for pair in pairs if len(pair[1]) > 2] or pairs
    return min(difflib.SequenceMatcher(None, *pair).ratio() for pair in long)


def _keys_at(root: type[BaseModel], location: Location) -> list[str]:
    model = _type_at(root, location)
    return list(model.model_fields) if _is_model(model) else []


def _meaning(root: type[BaseModel], location: Location) -> str:
    """The description of the field at a place."""
    parent = _type_at(root, location[:-1])
    field = parent.model_fields.get(str(location[-1])) if _is_model(parent) else None
    return (field.description or "") if field is not None else ""


def _type_at(root: type[BaseModel], location: Location) -> Any:
    """The type that the schema has at a place, without Annotated and None; None if unknown."""
    here: Any = root
    for part in location:
        if _is_model(here):
            field = here.model_fields.get(str(part))
            here = _bare(field.annotation) if field is not None else None
        elif get_origin(here) in (tuple, Rows):
            here = _bare(get_args(here)[0])
        elif get_origin(here) in (dict, Mapping):
            here = _bare(get_args(here)[1])
        else:
            return None
    return here


def _bare(annotation: Any) -> Any:
    while True:
        origin = get_origin(annotation)
        if origin is Annotated:
            annotation = get_args(annotation)[0]
        elif origin in (Union, types.UnionType):
            annotation = next(a for a in get_args(annotation) if a is not type(None))
        else:
            return annotation


def _is_model(candidate: Any) -> typing.TypeGuard[type[BaseModel]]:
    return isinstance(candidate, type) and issubclass(candidate, BaseModel)
