"""YAML text as scenes use it: numbers as in YAML 1.2, no duplicate keys, no surprises.

YAML 1.1, which PyYAML follows, reads ``1e6`` as text, ``010`` as eight, ``1:30`` as ninety, and
``on`` as true. A scene must not be misread that quietly.
"""

from __future__ import annotations

import gc
import json
import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

import yaml

from cablemodel.errors import SceneError, shown

_INT = re.compile(r"[-+]?[0-9]+$")
_FLOAT = re.compile(
    r"(?:[-+]?(?:\.[0-9]+|[0-9]+(?:\.[0-9]*)?)(?:[eE][-+]?[0-9]+)?"
    r"|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN))$"
)
_BOOL = re.compile(r"(?:true|True|TRUE|false|False|FALSE)$")
_REPLACED = {f"tag:yaml.org,2002:{name}" for name in ("bool", "int", "float", "timestamp")}
_TAB = r"found character '\t'"
"""How PyYAML complains of the tab that YAML forbids."""
_LARGEST = 5_000_000
"""Values in a scene, aliases written out: more is a mistake, or an attack."""
LONG_TABLE = 1000
"""Rows of a table beyond which a scene is written as JSON."""


def _resolvers() -> dict[str | None, list[tuple[str, re.Pattern[str]]]]:
    """PyYAML's rules for what plain text means, with those of YAML 1.2 for numbers and booleans."""
    rules: dict[str | None, list[tuple[str, re.Pattern[str]]]] = {
        first: [rule for rule in old if rule[0] not in _REPLACED]
        for first, old in yaml.SafeLoader.yaml_implicit_resolvers.items()
    }
    for tag, pattern, firsts in (
        ("bool", _BOOL, "tTfF"),
        ("int", _INT, "-+0123456789"),
        ("float", _FLOAT, "-+0123456789."),
    ):
        for first in firsts:
            rules.setdefault(first, []).append((f"tag:yaml.org,2002:{tag}", pattern))
    return rules


class SceneLoader(yaml.SafeLoader):
    """Safe loader with the numbers and booleans of YAML 1.2."""

    yaml_implicit_resolvers = _resolvers()


def _decimal(text: str) -> int | float:
    # Python refuses to read integers of thousands of digits; as a float they are infinite.
    return int(text) if len(text) <= 300 else float(text)


SceneLoader.add_constructor("tag:yaml.org,2002:int", lambda _loader, node: _decimal(node.value))


def _both_resolvers() -> dict[str | None, list[tuple[str, re.Pattern[str]]]]:
    """The rules of both versions: text that either takes for something else gets quotes."""
    new, old = SceneLoader.yaml_implicit_resolvers, yaml.SafeDumper.yaml_implicit_resolvers
    return {first: [*new.get(first, []), *old.get(first, [])] for first in {*new, *old}}


class SceneDumper(yaml.SafeDumper):
    """Safe dumper whose text means the same to `SceneLoader` and to a YAML 1.1 reader."""

    yaml_implicit_resolvers = _both_resolvers()

    def ignore_aliases(self, data: Any) -> bool:
        """No anchors: a scene is to be read by people."""
        return True


def dump_yaml(data: dict[str, Any]) -> str:
    """Plain data as YAML text; with a table of more than LONG_TABLE rows as JSON, which is YAML.

    A measured motion of 100,000 rows takes 39 s to write as YAML, and 0.2 s as JSON.
    """
    if _has_long_table(data):
        with suppress(ValueError):  # a number that is not finite, which JSON has no word for
            return _json(data)
    return yaml.dump(data, Dumper=SceneDumper, sort_keys=False, default_flow_style=None)


def _json(data: dict[str, Any]) -> str:
    """One line for each key at the top."""
    parts = (
        f"{json.dumps(key, ensure_ascii=False)}: "
        f"{json.dumps(value, ensure_ascii=False, allow_nan=False)}"
        for key, value in data.items()
    )
    return "{" + ",\n".join(parts) + "}\n"


def _has_long_table(data: Any) -> bool:
    if isinstance(data, dict):
        return any(_has_long_table(part) for part in data.values())
    return isinstance(data, list) and (
        len(data) > LONG_TABLE or any(_has_long_table(part) for part in data)
    )


@contextmanager
def uncollected() -> Iterator[None]:
    """Without garbage collection, which looks through millions of new objects again and again: they
    are all kept."""
    was = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was:
            gc.enable()


def _parse_json(text: str | bytes) -> Any:
    """The data of JSON that YAML reads as the same.

    Raises:
        ValueError: it is none; RecursionError.
    """
    with uncollected():
        return json.loads(
            text, object_pairs_hook=_unique, parse_int=_decimal, parse_constant=_no_number
        )


def _unique(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    found = dict(pairs)
    if len(found) < len(pairs):
        raise ValueError("a key is there twice")
    return found


def _no_number(word: str) -> Any:
    raise ValueError(f"{word} is a text in YAML")


def parse_yaml(text: str | bytes, source: str = "") -> Any:
    """The data of a YAML text.

    Raises:
        SceneError: not YAML, a key twice, or an alias that contains itself or grows beyond reason.
    """
    if text[:1] in ("{", b"{"):
        with suppress(ValueError, RecursionError):  # what is wrong YAML says with its place
            return _parse_json(text)
    try:
        loader = SceneLoader(text)
        try:
            node = loader.get_single_node()
            if node is None:
                return None
            _check_tree(node)
            return loader.construct_document(node)
        finally:
            loader.dispose()
    except yaml.MarkedYAMLError as error:
        problem, allowed = _plain_words(error)
        raise _not_yaml(f"{_place(error.problem_mark)}: {problem}", source, allowed) from None
    except (yaml.YAMLError, UnicodeError, ValueError, OverflowError) as error:
        raise _not_yaml(" ".join(str(error).split()), source) from None
    except RecursionError:
        raise _not_yaml("nested too deeply", source) from None


def _place(mark: yaml.Mark | None) -> str:
    return f"line {mark.line + 1}, column {mark.column + 1}" if mark else "at its end"


def _plain_words(error: yaml.MarkedYAMLError) -> tuple[str, str]:
    """What PyYAML complains of, and what is allowed there, for who does not know its grammar."""
    problem = error.problem or error.context or "not YAML"
    begun = _place(error.context_mark)
    if _TAB in problem:
        return "a tab", "spaces to indent"
    if problem.startswith(("expected ',' or '}'", "expected ',' or ']'")):
        bracket = problem[17]
        opened = {"}": "{", "]": "["}[bracket]
        return (
            f"the {opened} of {begun}, is not closed before this, or a comma is missing",
            f"a comma, or {bracket}",
        )
    if problem.startswith("expected <block end>"):
        return (
            f"this does not go on with what began at {begun}",
            "all keys of a mapping, or all '-' of a list, in one column, and a space after ':' "
            "and '-'",
        )
    if problem.startswith("mapping values are not allowed"):
        return (
            "a ':' that cannot stand here",
            "a key in the column of those above it, or text with ':' in quotes",
        )
    if problem.startswith("could not find expected ':'"):
        return f"no ':' after the key of {begun}", "KEY: VALUE, with a space"
    if "that cannot start any token" in problem:
        return problem.replace("found character ", "").replace(
            "that cannot start any token", "cannot begin a value"
        ), "such text in quotes"
    if "quoted scalar" in (error.context or "") and "unexpected end" in problem:
        return f"the quote of {begun}, is not closed", "a quote at its end"
    repeated = isinstance(error, yaml.constructor.ConstructorError)
    return problem, "YAML with every key once" if repeated else "YAML"


def _not_yaml(problem: str, source: str, allowed: str = "YAML") -> SceneError:
    error = SceneError.at("", None, problem, allowed)
    error.source = source
    return error


def _check_tree(root: yaml.Node) -> None:
    """Refuse duplicate keys, and aliases that make a document endless or huge.

    Done on the tree, before merge keys (``<<``) are resolved: those may override.
    """
    sizes: dict[int, int] = {}
    open_nodes: set[int] = set()

    def size(node: yaml.Node) -> int:
        key = id(node)
        if key in open_nodes:
            raise ValueError("an alias contains itself")
        if key not in sizes:
            open_nodes.add(key)
            children: list[yaml.Node] = []
            if isinstance(node, yaml.MappingNode):
                _check_keys(node)
                children = [part for pair in node.value for part in pair]
            elif isinstance(node, yaml.SequenceNode):
                children = node.value
            sizes[key] = 1 + sum(size(child) for child in children)
            open_nodes.discard(key)
        return sizes[key]

    if size(root) > _LARGEST:
        raise ValueError(f"more than {_LARGEST} values")


def _check_keys(node: yaml.MappingNode) -> None:
    seen: set[str] = set()
    for key, _ in node.value:
        if isinstance(key, yaml.ScalarNode):
            if key.value in seen:
                problem = f"the key {shown(key.value)} is there twice"
                raise yaml.constructor.ConstructorError(None, None, problem, key.start_mark)
            seen.add(key.value)
