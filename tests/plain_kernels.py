"""Run the finite elements' kernels as plain Python: to trace them, and to check what is compiled.

Import this before anything of cablemodel that imports kernels, or give pytest ``-p plain_kernels``
with this folder on PYTHONPATH. A step takes milliseconds instead of microseconds, but nothing is
compiled, and kernels can be wrapped, printed from and stopped in: replace a function in the module
that calls it, as in ``time_stepping.try_step = traced``.
"""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from importlib import import_module
from types import ModuleType
from typing import Any

import numpy as np

os.environ["CABLEMODEL_KERNELS"] = "numba"


def as_it_is(function: Any) -> Any:
    """Instead of compiling."""
    return function


def entry_point(signature: Any) -> Callable[[Any], Any]:
    """A function that keeps its signature; of `compile` it has the name alone."""

    def decorate(function: Any) -> Any:
        function.entry_signature = signature
        function.compile = as_it_is
        return function

    return decorate


def view(array: Any, start: Any, count: Any) -> Any:
    """As the compiled one; one word stands for all from there on."""
    return array[start : start + count] if count != 1 else array[start:]


def record_in(record: Any) -> Any:
    """The record is the view itself."""
    return record


def record_at(record: Any) -> Any:
    """The record is the view itself."""
    return record


def row_of(record: Any, table: Any) -> Any:
    """As the compiled one."""
    start, width = table.__index__(), record.WORDS
    return lambda header, words, row: record(words, header[start] + width * row)


def own_record(record: Any) -> Any:
    """As the compiled one; whole numbers and others beside each other stay what they are."""
    kinds = {field.kind for field in record.FIELDS.values()}
    numbers = kinds.pop() if len(kinds) == 1 else object
    return lambda: record(np.zeros(record.WORDS, numbers), 0)


def own_numbers(count: int) -> Any:
    """As the compiled one."""
    return lambda: np.zeros(count)


def word_of(words: Any, record: Any) -> int:
    """As the compiled one."""
    word: int = record._first
    return word


def copy_words(array: Any, to: Any, start: Any, count: Any) -> None:
    """As the compiled one."""
    array[to : to + count] = array[start : start + count].copy()


def table_product(table: Any) -> Any:
    """As the compiled one, with a matrix."""
    factors = np.array([[float(factor) for factor in row] for row in table])

    def product(result: Any, rows: Any, width: Any) -> None:
        count = factors.shape[1]
        terms = rows[: width * count].reshape(count, width)
        result[: width * len(factors)] = (factors @ terms).ravel()

    return product


def matrix_vector(size: int, sign: float, *, add: bool, columns: int | None = None) -> Any:
    """As the compiled one."""
    terms = size if columns is None else columns

    def product(
        matrix: Any, at: Any, vector: Any, start: Any, stride: Any, out: Any, to: Any
    ) -> None:
        block = matrix.ravel()[at : at + size * terms].reshape(terms, size)
        total = np.array([vector[start + k * stride] for k in range(terms)]) @ block
        out[to : to + size] = out[to : to + size] + sign * total if add else total

    return product


def sums_of_two(table: Any, add: str) -> Any:
    """As the compiled one."""
    factors = np.array(table)

    def sums(vector: Any, out: Any) -> None:
        terms = len(factors)
        for i in range(2):
            total = vector[4 * i : 4 * i + terms] @ factors
            out[i::2] = total if add == "no" else out[i::2] + total

    return sums


def values_of_two(tables: Any) -> Any:
    """As the compiled one."""
    factors = np.array([table[:3] for table in tables])

    def values(unknowns: Any, out: Any) -> None:
        for i in range(2):
            out[4 * i : 4 * i + 3] = unknowns[i::2] @ factors
            out[4 * i + 3] = out[4 * i + 2]

    return values


def scatter_pairs(dimension: int, row: int) -> Any:
    """As the compiled one."""
    size = 2 * dimension

    def scatter(words: Any, above: Any, upper: Any, lower: Any, below: Any) -> None:
        pairs = words[: 16 * row].reshape(2, 2, 2, 2, row)[..., : dimension**2]
        pairs = pairs.reshape(2, 2, 2, 2, dimension, dimension)
        blocks = pairs.transpose(0, 2, 1, 4, 3, 5).reshape(2, 2, size * size)
        above[: size * size] += blocks[0, 0]
        upper[: size * size] = blocks[0, 1]
        lower[: size * size] = blocks[1, 0]
        below[: size * size] += blocks[1, 1]

    return scatter


def in_pairs(formula: Any) -> Any:
    """As the compiled one."""

    def loop(count: Any, results: Any, arrays: Any, numbers: Any) -> None:
        found = formula(*(array[:count] for array in arrays), *numbers)
        for result, value in zip(results, found, strict=True):
            result[:count] = value

    return loop


def two_products(size: int) -> Any:
    """As the compiled one."""

    def product(matrix: Any, vector: Any, above: Any, below: Any, out: Any, to: Any) -> None:
        rows = matrix[: 4 * size].reshape(2, 2, size)
        parts = vector[above : above + size], vector[below : below + size]
        out[to : to + 2] = rows[0] @ parts[0] + rows[1] @ parts[1]

    return product


def block_kernels(size: int) -> tuple[Any, Any]:
    """As the compiled ones, by NumPy's own inverse."""
    area = size * size

    def transpose(words: Any, start: Any, to: Any) -> None:
        block = words[start : start + area].reshape(size, size)
        words[to : to + area] = block.T.copy().ravel()

    def invert(words: Any, start: Any) -> bool:
        block = words[start : start + area].reshape(size, size)
        try:
            inverse = np.linalg.inv(block)
        except np.linalg.LinAlgError:
            return False
        words[start : start + area] = inverse.T.ravel()
        return bool(np.isfinite(inverse).all())

    return transpose, invert


def install() -> None:
    """Put these in the place of the modules that compile, and of products."""
    compiling = ModuleType("cablemodel.solvers.shared.compile")
    products = ModuleType("cablemodel.solvers.finite_element.kernels.line.products")
    for function in (
        entry_point,
        view,
        record_in,
        record_at,
        row_of,
        own_record,
        own_numbers,
        word_of,
        copy_words,
    ):
        setattr(compiling, function.__name__, function)
    for function in (
        table_product,
        matrix_vector,
        sums_of_two,
        values_of_two,
        scatter_pairs,
        in_pairs,
        two_products,
        block_kernels,
    ):
        setattr(products, function.__name__, function)
    for name in ("kernel", "inlined", "outlined"):
        setattr(compiling, name, as_it_is)
    for name in ("INTEGERS", "REALS"):
        setattr(compiling, name, name)
    for module in (compiling, products):
        package, _, name = module.__name__.rpartition(".")
        sys.modules[module.__name__] = module
        vars(import_module(package))[name] = module


install()
