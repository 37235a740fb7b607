"""Records: words of memory with names, declared once.

A record is a class whose fields follow each other without gaps, in the order of their declaration,
each with its meaning and its unit. The declaration is all there is: the view by name in Python
(``Header(block.ints).nodes``), the one in kernels (records.py), NumPy's dtype, the struct of the
FMU's C code, the page of the site and the numbers of words come from it. Fields can therefore not
overlap.
"""

from __future__ import annotations

from types import ModuleType
from typing import Any, ClassVar, Self, overload

import numpy as np
from numpy.typing import NDArray

INTEGER, REAL = "i8", "f8"


class Field:
    """One or more words of a record."""

    kind = REAL

    def __init__(self, meaning: str, unit: str = "", words: int = 1) -> None:
        self.meaning, self.unit, self.words = meaning, unit, words
        self.name = ""
        self.first = 0
        """Word of a block at which the record that there is one of begins."""
        self.word = 0
        """Its first word, from the record's first."""

    def __index__(self) -> int:
        """In an index: its first word, in a block or in a row of a table."""
        return self.place

    @property
    def place(self) -> int:
        """Its first word in a block, of a record that there is one of."""
        return self.first + self.word

    @property
    def span(self) -> slice:
        """Its words there."""
        return slice(self.place, self.place + self.words)


class Integer(Field):
    """A whole number."""

    kind = INTEGER

    @overload
    def __get__(self, record: None, owner: Any) -> Self: ...
    @overload
    def __get__(self, record: Record, owner: Any) -> int: ...
    def __get__(self, record: Record | None, owner: Any) -> Self | int:
        if record is None:
            return self
        number: int = record._words[record._first + self.word]
        return number

    def __set__(self, record: Record, value: Any) -> None:
        record._words[record._first + self.word] = value


class Real(Field):
    """A number."""

    @overload
    def __get__(self, record: None, owner: Any) -> Self: ...
    @overload
    def __get__(self, record: Record, owner: Any) -> float: ...
    def __get__(self, record: Record | None, owner: Any) -> Self | float:
        if record is None:
            return self
        number: float = record._words[record._first + self.word]
        return number

    def __set__(self, record: Record, value: Any) -> None:
        record._words[record._first + self.word] = value


class Several(Field):
    """Numbers, one after another."""

    @overload
    def __get__(self, record: None, owner: Any) -> Self: ...
    @overload
    def __get__(self, record: Record, owner: Any) -> NDArray[Any]: ...
    def __get__(self, record: Record | None, owner: Any) -> Self | NDArray[Any]:
        if record is None:
            return self
        start = record._first + self.word
        numbers: NDArray[Any] = record._words[start : start + self.words]
        return numbers

    def __set__(self, record: Record, value: Any) -> None:
        start = record._first + self.word
        record._words[start : start + self.words] = value


class Integers(Several):
    """Whole numbers, one after another."""

    kind = INTEGER


class Part(Field):
    """A record within the record."""

    def __init__(self, meaning: str, of: type[Record]) -> None:
        super().__init__(meaning, words=of.WORDS)
        self.of = of

    @overload
    def __get__(self, record: None, owner: Any) -> Self: ...
    @overload
    def __get__(self, record: Record, owner: Any) -> Any: ...
    def __get__(self, record: Record | None, owner: Any) -> Any:
        return self if record is None else self.of(record._words, record._first + self.word)


class Text(Field):
    """Characters, ended by zeros: of what is written for elsewhere, not of a block."""


class Spare(Field):
    """Words that nothing uses."""


def integer(meaning: str, unit: str = "") -> Integer:
    """A whole number."""
    return Integer(meaning, unit)


def real(meaning: str, unit: str = "") -> Real:
    """A number; without a unit, a flag, a count or a ratio."""
    return Real(meaning, unit)


def reals(words: int, meaning: str, unit: str = "") -> Several:
    """So many numbers."""
    return Several(meaning, unit, words)


def integers(words: int, meaning: str) -> Integers:
    """So many whole numbers."""
    return Integers(meaning, words=words)


def text(words: int, meaning: str) -> Text:
    """Characters, eight in a word."""
    return Text(meaning, words=words)


def part(of: type[Record], meaning: str) -> Part:
    """Another record."""
    return Part(meaning, of)


def spare(words: int) -> Spare:
    """So many words that nothing uses."""
    return Spare("", words=words)


class Record:
    """Words of a piece of memory by name: a view, no copy."""

    FIELDS: ClassVar[dict[str, Field]] = {}
    WORDS: ClassVar[int] = 0
    FIRST: ClassVar[int] = 0
    WITHIN: ClassVar[int | None] = None
    BESIDE: ClassVar[tuple[type[Record], ...]] = ()

    __slots__ = ("_first", "_words")

    def __init__(self, memory: NDArray[Any], first: int | None = None) -> None:
        """The record at word `first` of an array of words, or at its own place in a block."""
        self._words = memory
        self._first = self.FIRST if first is None else first

    def __init_subclass__(
        cls,
        *,
        first: int = 0,
        within: Field | None = None,
        beside: tuple[type[Record], ...] = (),
    ) -> None:
        """Where the words are.

        first: word of a block, of a record that there is one of. within: of scratch memory that
        several users have, each at its time, the header's word where it starts; beside: those users
        that may have it at the same time, so that no word of theirs may be one of these.
        """
        cls.FIRST, cls.BESIDE = first, beside
        cls.WITHIN = None if within is None else within.place
        cls.FIELDS = {name: field for name, field in vars(cls).items() if isinstance(field, Field)}
        word = 0
        for name, field in cls.FIELDS.items():
            field.name, field.first, field.word = name, first, word
            word += field.words
        cls.WORDS = word


def records(module: ModuleType) -> list[type[Record]]:
    """The records that a module declares, each behind those that it holds."""
    return [
        kind
        for kind in vars(module).values()
        if isinstance(kind, type)
        and issubclass(kind, Record)
        and kind.__module__ == module.__name__
    ]


def described(field: Field) -> str:
    """What a field is, and its unit."""
    return f"{field.meaning} [{field.unit}]" if field.unit else field.meaning


def dtype_of(record: type[Record]) -> np.dtype[Any]:
    """The record as a structured type of NumPy."""
    formats: list[Any] = [
        dtype_of(field.of)
        if isinstance(field, Part)
        else f"S{8 * field.words}"
        if isinstance(field, Text)
        else (field.kind, (field.words,))
        if isinstance(field, (Several, Spare))
        else field.kind
        for field in record.FIELDS.values()
    ]
    return np.dtype(list(zip(record.FIELDS, formats, strict=True)))


def c_struct(record: type[Record]) -> str:
    """The record as a struct of C."""
    lines = ["typedef struct {"]
    for name, field in record.FIELDS.items():
        several = f"[{field.words}]" if isinstance(field, (Several, Spare)) else ""
        if isinstance(field, Part):
            kind = field.of.__name__
        elif isinstance(field, Text):
            kind, several = "char", f"[{8 * field.words}]"
        else:
            kind = "int64_t" if field.kind == INTEGER else "double"
        told = f" /* {described(field)} */" if field.meaning else ""
        lines.append(f"    {kind} {name}{several};{told}")
    return "\n".join([*lines, f"}} {record.__name__};"])
