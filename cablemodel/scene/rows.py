"""Tables of a scene: rows as numbers in arrays, checked at once, models only where asked for."""

from __future__ import annotations

import types
from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from operator import itemgetter
from typing import Any, Generic, TypeVar, get_args, overload

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

FloatArray = NDArray[np.float64]

Row = TypeVar("Row", bound=BaseModel)


class Rows(Sequence[Row], Generic[Row]):
    """Rows of a table, each a model of numbers and vectors.

    A measured motion has a million of them, which as objects would take minutes and gigabytes.

    Args:
        kind: model of a row.
        columns: numbers (n,) or vectors (n, k) by the model's fields, SI, finite; not copied.
    """

    def __init__(self, kind: type[Row], columns: Mapping[str, FloatArray]) -> None:
        self._kind = kind
        self._columns = {name: columns[name] for name in kind.model_fields}
        for column in self._columns.values():
            column.flags.writeable = False

    @classmethod
    def of(cls, kind: type[Row], rows: Sequence[Row]) -> Rows[Row]:
        """The table of given rows."""
        columns = {
            name: np.array([getattr(row, name) for row in rows], dtype=np.float64)
            for name in kind.model_fields
        }
        return cls(kind, columns)

    def column(self, name: str) -> FloatArray:
        """All values of a field, (n,) or (n, k) [SI], read only."""
        return self._columns[name]

    def as_data(self) -> list[dict[str, Any]]:
        """The rows as a scene's plain data."""
        columns = [column.tolist() for column in self._columns.values()]
        return [dict(zip(self._columns, row, strict=True)) for row in zip(*columns, strict=True)]

    def __len__(self) -> int:
        return len(next(iter(self._columns.values())))

    @overload
    def __getitem__(self, index: int) -> Row: ...
    @overload
    def __getitem__(self, index: slice) -> Rows[Row]: ...
    def __getitem__(self, index: int | slice) -> Row | Rows[Row]:
        if isinstance(index, slice):
            return Rows(self._kind, {name: c[index] for name, c in self._columns.items()})
        found: dict[str, Any] = {}
        for name, column in self._columns.items():
            value = column[index].tolist()
            found[name] = tuple(value) if isinstance(value, list) else value
        return self._kind.model_construct(None, **found)

    def __iter__(self) -> Iterator[Row]:
        return (self[index] for index in range(len(self)))

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Rows):
            return isinstance(other, Sequence) and list(self) == list(other)
        return self._kind is other._kind and all(
            np.array_equal(column, other._columns[name]) for name, column in self._columns.items()
        )

    def __hash__(self) -> int:
        return hash((self._kind, len(self)))

    def __repr__(self) -> str:
        return f"<{len(self)} rows of {self._kind.__name__}>"

    @classmethod
    def __get_pydantic_core_schema__(cls, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        (kind,) = get_args(source)
        return core_schema.no_info_wrap_validator_function(
            partial(_validated, kind),
            handler.generate_schema(types.GenericAlias(tuple, (kind, ...))),
            serialization=core_schema.plain_serializer_function_ser_schema(Rows.as_data),
        )


def _validated(kind: type[Row], value: Any, validate: Callable[[Any], Any]) -> Rows[Row]:
    """A table that was read as one; rows of plain numbers, checked all at once; or others, and what
    is wrong, one by one."""
    if isinstance(value, Rows):
        return value
    columns = _columns_of(kind, value)
    return Rows.of(kind, validate(value)) if columns is None else Rows(kind, columns)


def _columns_of(kind: type[BaseModel], rows: Any) -> dict[str, FloatArray] | None:
    """Columns of rows of plain numbers; None where not all are, or one is not allowed."""
    if type(rows) is not list or set(map(type, rows)) != {dict}:
        return None
    if set(map(len, rows)) != {len(kind.model_fields)}:
        return None
    columns = {}
    for name, field in kind.model_fields.items():
        (rule,) = field.metadata
        try:
            values = list(map(itemgetter(name), rows))
        except KeyError:
            return None
        column = rule.column(values)
        if column is None:
            return None
        columns[name] = column
    return columns
