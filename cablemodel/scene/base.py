"""What all parts of the scene schema share: the base model, number types, tables over time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, ClassVar, TypeVar

import numpy as np
from pydantic import BaseModel, ConfigDict, GetJsonSchemaHandler, model_validator
from pydantic.config import JsonDict
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema

from cablemodel.errors import shown
from cablemodel.scene.rows import Rows
from cablemodel.scene.units import Direction, Quantity, Vector, rejection

Vector2 = tuple[float, float]
Vector3 = tuple[float, float, float]

Metres = Annotated[float, Quantity("m")]
Length = Annotated[float, Quantity("m", above=0)]
Seconds = Annotated[float, Quantity("s")]
Duration = Annotated[float, Quantity("s", above=0)]
Speed = Annotated[float, Quantity("m/s", at_least=0)]
Angle = Annotated[float, Quantity("rad")]
Coefficient = Annotated[float, Quantity(at_least=0)]
Position = Annotated[Vector3, Vector("m")]
Velocity = Annotated[Vector3, Vector("m/s")]
UnitVector = Annotated[Vector3, Direction()]


class SceneModel(BaseModel):
    """A mapping of a scene file: known keys only, and unchangeable once it is read."""

    model_config = ConfigDict(extra="forbid", frozen=True)


class WordOrMapping(SceneModel):
    """A part that is a single word or a mapping: ``end: free`` or ``end: {anchor: ...}``.

    The word is an empty mapping inside; a mapping has exactly one of ``keys``.
    """

    word: ClassVar[str]
    keys: ClassVar[tuple[str, ...]]

    @model_validator(mode="before")
    @classmethod
    def _from_word(cls, value: Any) -> Any:
        if isinstance(value, str) and value == cls.word:
            return {}
        allowed = f"{cls.word}, or a mapping with {' or '.join(cls.keys)}"
        if isinstance(value, Mapping) and value:
            given = [key for key in cls.keys if value.get(key) is not None]
            if len(given) > 1:
                raise rejection(f"{' and '.join(given)} exclude each other", allowed, value)
            return value
        if isinstance(value, cls):
            return value
        raise rejection(f"{shown(value)} is not understood", allowed, value)

    @classmethod
    def __get_pydantic_json_schema__(
        cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> JsonSchemaValue:
        schema = handler.resolve_ref_schema(handler(core_schema))
        mapping = dict(schema)
        mapping["anyOf"] = [{"required": [key]} for key in cls.keys]
        schema.clear()
        schema["title"] = mapping.pop("title")
        schema["description"] = mapping.pop("description")
        schema["anyOf"] = [{"const": cls.word}, mapping]
        return schema


def also(*forms: JsonDict) -> Callable[[JsonDict], None]:
    """``json_schema_extra`` of a field that has short forms next to its own."""

    def extend(schema: JsonDict) -> None:
        own = schema.pop("anyOf", None)
        if own is None:
            words = ("type", "items", "minItems", "$ref")
            own = [{word: schema.pop(word) for word in words if word in schema}]
        assert isinstance(own, list)
        schema["anyOf"] = [*forms, *own]

    return extend


_CLOSEST = 1e-9
"""Rows of a table nearer than this are the same place or time."""

Table = TypeVar("Table", bound=Sequence[Any] | None)


def rising(key: str) -> str:
    """What is allowed of a table's first column, in words."""
    jump = "; what jumps takes a time, as short as 1e-6 s" if key == "t" else ""
    return f"{key} rising from row to row{jump}"


def in_order_of(key: str) -> Callable[[Table], Table]:
    """A validator for tables: at least one row, and ``key`` rises strictly from row to row. None,
    where a field allows it, is no table."""

    def validate(rows: Table) -> Table:
        if rows is None:
            return rows
        if not rows:
            raise rejection("the table is empty", "at least one row", rows)
        if isinstance(rows, Rows):
            values = rows.column(key)
        else:
            values = np.array([getattr(row, key) for row in rows])
        wrong = np.flatnonzero(np.diff(values) < _CLOSEST)
        if len(wrong):
            index = int(wrong[0]) + 1
            before, here = float(values[index - 1]), float(values[index])
            word = "out of order:" if here < before else "twice the same"
            problem = f"{word} {key} ({here:g} after {before:g})"
            raise rejection(problem, rising(key), here, (index, key))
        return rows

    return validate
