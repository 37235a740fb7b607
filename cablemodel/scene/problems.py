"""Pydantic's findings in the words of a user: path, value, what is wrong, what is allowed."""

from __future__ import annotations

import math
import re
import types
import typing
from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo

from cablemodel.errors import SceneProblem, shown
from cablemodel.scene.meant import meant
from cablemodel.scene.rows import Rows
from cablemodel.scene.units import Count, Quantity, Vector

_MOST = 20
_KEY_MARK = "[key]"
_DEEPEST = 4
"""Keys on the way to where else a key may stand."""
_HOMES = 3
"""Places at which a key may stand that are worth naming; more tell nothing."""

_NUMBERS = (Count, Quantity, Vector)

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
        meaning, allowed = _meaning(root, location), _allowed(root, location)
        told = f": {meaning}" if meaning and allowed else ""
        return [SceneProblem(path, None, f"is missing{told}", allowed or meaning)]
    if kind == "extra_forbidden":
        return [_unknown_key(root, location, value)]
    if kind in ("model_type", "model_attributes_type", "dict_type"):
        keys = _keys_at(root, location)
        allowed = f"a mapping with the keys {', '.join(keys)}" if keys else _by_name(root, location)
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


def _by_name(root: type[BaseModel], location: Location) -> str:
    """What a mapping by names may be."""
    if keys := _keys_at(root, (*location, "NAME")):
        return f"a mapping {{NAME: {{{', '.join(keys)}}}}}"
    field = _field_at(root, location)
    inner = get_args(get_args(field.annotation)[1]) if field is not None else ()
    numbers = next((kind.allowed for kind in inner if isinstance(kind, _NUMBERS)), "...")
    return f"a mapping {{NAME: {numbers}}}"


def _unknown_key(root: type[BaseModel], location: Location, value: Any) -> SceneProblem:
    keys = _keys_at(root, location[:-1])
    word = str(location[-1])
    stands_for = meant(word, keys)
    near = f", did you mean {stands_for}?" if stands_for else ""
    # At the top what is like it is likelier; below, a key that is right elsewhere.
    like, home = suggestion(word, keys), _home(root, location)
    near = near or ((like or home) if len(location) == 1 else (home or like))
    return SceneProblem(dotted(location), value, f"unknown key{near}", ", ".join(keys))


def _home(root: type[BaseModel], location: Location) -> str:
    """Where a key is known that is unknown at its place: the nearest below it, else anywhere."""
    word, above = str(location[-1]), location[:-1]
    ways: tuple[tuple[Any, Location, str], ...] = (
        (_type_at(root, above), above, "it belongs in"),
        (root, (), "a key of"),
    )
    for model, prefix, told in ways:
        found = sorted(_places(model, word, prefix), key=len) if _is_model(model) else []
        nearest = [dotted(place) for place in found if len(place) == len(found[0])]
        if found:
            named = " or ".join(place or "the scene itself" for place in nearest)
            return f", {told} {named}" if len(nearest) <= _HOMES else ""
    return ""


def _places(model: type[BaseModel], word: str, at: Location, depth: int = 0) -> Iterator[Location]:
    """Places of the mappings, at one of this kind and below, that have such a key."""
    fields = {field.alias or name: field for name, field in model.model_fields.items()}
    if word in fields:
        yield at
    for name, field in fields.items() if depth < _DEEPEST else ():
        inner, way = _bare(field.annotation), (*at, name)
        while get_origin(inner) in (tuple, Rows, dict, Mapping):
            rows = get_origin(inner) in (tuple, Rows)
            inner, way = _bare(get_args(inner)[0 if rows else 1]), (*way, "N" if rows else "NAME")
        if _is_model(inner):
            yield from _places(inner, word, way, depth + 1)


def suggestion(word: Any, words: list[str]) -> str:
    """A question whether one of the words was meant, where one is like it; else nothing."""
    given = str(word)
    close = min(words, key=lambda known: _slips(given, known), default="")
    return f", did you mean {close}?" if _slips(given, close) < math.inf else ""


_LONG = 8
"""Letters from which on a word may have two slips of the pen: in a shorter one they make another
word, a time of a title."""
_STEM = 4
"""Letters of a word that may stand for all of it."""
_ENDINGS = ("s", "d", "ed")
"""Of the same word, as a plural or a participle."""


def _slips(given: str, known: str) -> float:
    """Slips of the pen between two keys; infinite, if one is no slip for the other.

    Each part between underscores has to be like: lift_coefficient is no slip for drag_coefficient,
    though most of its letters are the same.
    """
    ours, theirs = (re.split(r"[_\W]", word.lower()) for word in (given, known))
    if "".join(ours) == "".join(theirs):
        return 0.0  # but for what stands between the parts
    if len(ours) != len(theirs):
        return math.inf
    pairs = list(zip(ours, theirs, strict=True))
    # Beside longer parts, two letters (accuracy_of) are too few to mean something else.
    long = [pair for pair in pairs if len(pair[1]) > 2] or pairs
    return sum(_slips_of_a_word(*pair) for pair in long)


def _slips_of_a_word(given: str, known: str) -> float:
    """Letters left out, added, mistaken or swapped; infinite, if it is another word."""
    if given == known:
        return 0.0
    if len(known) <= 2:
        return math.inf
    short, long = sorted((given, known), key=len)
    same = long.startswith(short) and (short == given or long[len(short) :] in _ENDINGS)
    if same and len(short) >= _STEM:
        return 1.0
    if given[-3:] == "ies" and given[:-3] + "y" == known:
        return 1.0
    most = 2 if len(known) >= _LONG else 1
    slips = _edits(given, known)
    return slips if slips <= most else math.inf


def _edits(given: str, known: str) -> float:
    """The least number of letters to leave out, add, replace, or swap with the next one."""
    rows = [list(range(len(known) + 1))]
    for i, ours in enumerate(given, start=1):
        row = [i]
        for j, theirs in enumerate(known, start=1):
            least = min(rows[-1][j] + 1, row[-1] + 1, rows[-1][j - 1] + (ours != theirs))
            if i > 1 and j > 1 and ours == known[j - 2] and given[i - 2] == theirs:
                least = min(least, rows[-2][j - 2] + 1)
            row.append(least)
        rows.append(row)
    return float(rows[-1][-1])


def _keys_at(root: type[BaseModel], location: Location) -> list[str]:
    model = _type_at(root, location)
    if not _is_model(model):
        return []
    return [field.alias or name for name, field in model.model_fields.items()]


def _field_of(model: type[BaseModel], key: str) -> FieldInfo | None:
    """The field that a key of the file names."""
    for name, field in model.model_fields.items():
        if key == (field.alias or name):
            return field
    return None


def _field_at(root: type[BaseModel], location: Location) -> FieldInfo | None:
    parent = _type_at(root, location[:-1])
    return _field_of(parent, str(location[-1])) if _is_model(parent) else None


def _meaning(root: type[BaseModel], location: Location) -> str:
    """The description of the field at a place."""
    field = _field_at(root, location)
    return (field.description or "") if field is not None else ""


def _allowed(root: type[BaseModel], location: Location) -> str:
    """What may stand at a place, where its kind of number says so."""
    field = _field_at(root, location)
    kinds = field.metadata if field is not None else []
    return next((kind.allowed for kind in kinds if isinstance(kind, _NUMBERS)), "")


def _type_at(root: type[BaseModel], location: Location) -> Any:
    """The type that the schema has at a place, without Annotated and None; None if unknown."""
    here: Any = root
    for part in location:
        if _is_model(here):
            field = _field_of(here, str(part))
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
