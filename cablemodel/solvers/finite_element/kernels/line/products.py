"""Products with small blocks, and their inverse, as kernels that hold them in registers.

What a loop nest would leave to the optimiser's taste is written out here, in vectors of two.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import make_array

_intrinsic: Any = intrinsic  # for callers, what it makes takes one argument less


class _Pair:
    """Two numbers side by side in code that is made: sums and products of them, in that order."""

    def __init__(self, builder: Any, value: Any) -> None:
        self.builder = builder
        self.value = value

    def __add__(self, other: _Pair) -> _Pair:
        return _Pair(self.builder, self.builder.fadd(self.value, other.value))

    def __sub__(self, other: _Pair) -> _Pair:
        return _Pair(self.builder, self.builder.fsub(self.value, other.value))

    def __mul__(self, other: _Pair) -> _Pair:
        return _Pair(self.builder, self.builder.fmul(self.value, other.value))


def in_pairs(formula: Callable[..., Any]) -> Any:
    """Kernel f(count, results, arrays, numbers), of tuples: word by word of as many results what
    the formula makes of the arrays, then the numbers; an even count of words.

    A result may be one of the arrays, and otherwise none overlaps another: a loop in a kernel would
    begin by looking whether any does, for longer than it takes with a line of few elements.
    """

    @_intrinsic
    def loop(typing_context: Any, count: Any, results: Any, arrays: Any, numbers: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            pair, integer = ir.VectorType(ir.DoubleType(), 2), ir.IntType(64)

            def places(n: int) -> list[Any]:
                kinds = signature.args[n]
                parts = [builder.extract_value(values[n], k) for k in range(len(kinds))]
                return [
                    make_array(kind)(context, builder, part).data
                    for kind, part in zip(kinds, parts, strict=True)
                ]

            def both(number: Any) -> Any:
                vector = ir.Constant(pair, ir.Undefined)
                for lane in range(2):
                    index = ir.Constant(ir.IntType(32), lane)
                    vector = builder.insert_element(vector, number, index)
                return _Pair(builder, vector)

            constants = [
                both(builder.extract_value(values[3], k)) for k in range(len(signature.args[3]))
            ]
            to, start = places(1), places(2)
            zero, two = ir.Constant(integer, 0), ir.Constant(integer, 2)
            with cgutils.for_range_slice(builder, zero, values[0], two) as (word, _):

                def place(data: Any) -> Any:
                    return builder.bitcast(builder.gep(data, [word]), pair.as_pointer())

                read = [_Pair(builder, builder.load(place(data), align=8)) for data in start]
                found = formula(*read, *constants)
                for result, data in zip(found, to, strict=True):
                    builder.store(result.value, place(data), align=8)
            return context.get_dummy_value()

        return types.void(types.int64, results, arrays, numbers), generate

    return loop


def _add_term(builder: Any, total: Any, factor: float, both: Any, known: dict[float, Any]) -> Any:
    """total (None: nothing yet) and a factor times a vector; known: products with that vector.

    A product with minus a factor that is known is minus that product: it is subtracted.
    """
    if factor == 0.0:
        return total
    term, less = known.get(factor), known.get(-factor)
    if term is None and less is not None:
        return builder.fneg(less) if total is None else builder.fsub(total, less)
    if term is None:
        term = builder.fmul(ir.Constant(both.type, [factor, factor]), both)
        known[factor] = term
    return term if total is None else builder.fadd(total, term)


def table_product(table: Any) -> Any:
    """Kernel f(result, rows, width): row e of a result is the sum over m of table[e, m] * row m.

    Rows are of `width` words (even), one after another; the places do not meet. The table's numbers
    become constants of the code, and the loop over a row vectors of two: what a loop nest leaves to
    the optimiser's taste is thus settled, and compiled quickly.
    """
    factors = [[float(factor) for factor in row] for row in table]

    @_intrinsic(prefer_literal=True)
    def product(typing_context: Any, result: Any, array: Any, width: Any) -> Any:
        words = width.literal_value
        signature = types.void(result, array, width)

        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            to, start = (
                make_array(signature.args[n])(context, builder, values[n]).data for n in range(2)
            )
            pair = ir.VectorType(ir.DoubleType(), 2)

            def place(data: Any, word: int) -> Any:
                address = builder.gep(data, [ir.Constant(ir.IntType(64), word)])
                return builder.bitcast(address, pair.as_pointer())

            for column in range(0, words, 2):
                rows = [
                    builder.load(place(start, words * m + column), align=8)
                    for m in range(len(factors[0]))
                ]
                known: list[dict[float, Any]] = [{} for _ in rows]
                for e, line in enumerate(factors):
                    total = None
                    for factor, row, terms in zip(line, rows, known, strict=True):
                        total = _add_term(builder, total, factor, row, terms)
                    builder.store(total, place(to, words * e + column), align=8)
            return context.get_dummy_value()

        return signature, generate

    return product


def matrix_vector(size: int, sign: float, *, add: bool, columns: int | None = None) -> Any:
    """Kernel f(A, at, x, start, stride, out, to): out = [out] + sign A x for one small block.

    A is stored by columns of `size` words (even) from `at`, as many unless `columns` says how
    many; element k of x is at start + k stride.
    The sum stays in registers until the end, so out may be x.
    """

    @_intrinsic
    def product(
        typing_context: Any,
        matrix: Any,
        at: Any,
        vector: Any,
        start: Any,
        stride: Any,
        result: Any,
        to: Any,
    ) -> Any:
        word = types.int64
        signature = types.void(matrix, word, vector, word, word, result, word)

        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            arrays = [
                make_array(signature.args[n])(context, builder, values[n]).data for n in (0, 2, 5)
            ]
            at, start, stride, to = values[1], values[3], values[4], values[6]
            pair = ir.VectorType(ir.DoubleType(), 2)
            integer = ir.IntType(64)

            def place(data: Any, start: Any, offset: int) -> Any:
                word = builder.add(start, ir.Constant(integer, offset))
                return builder.bitcast(builder.gep(data, [word]), pair.as_pointer())

            halves = range(0, size, 2)
            totals: list[Any] = [None for _ in halves]
            for k in range(size if columns is None else columns):
                where = builder.add(start, builder.mul(stride, ir.Constant(integer, k)))
                factor = builder.load(builder.gep(arrays[1], [where]))
                both = ir.Constant(pair, ir.Undefined)
                for lane in range(2):
                    index = ir.Constant(ir.IntType(32), lane)
                    both = builder.insert_element(both, factor, index)
                for n, half in enumerate(halves):
                    column = builder.load(place(arrays[0], at, size * k + half), align=8)
                    term = builder.fmul(column, both)
                    total = totals[n]
                    totals[n] = term if total is None else builder.fadd(total, term)
            places = [place(arrays[2], to, half) for half in halves]
            if add:
                combine = builder.fadd if sign > 0.0 else builder.fsub
                totals = [
                    combine(builder.load(where, align=8), total)
                    for where, total in zip(places, totals, strict=True)
                ]
            for where, total in zip(places, totals, strict=True):
                builder.store(total, where, align=8)
            return context.get_dummy_value()

        return signature, generate

    return product


def sums_of_two(table: Any, add: str) -> Any:
    """Kernel f(x, out): weighted sums over two components of a vector, side by side.

    table: (terms, rows), the numbers by which rows take the terms; they become constants of the
    code. Term m of the first component is at m of x, of the second four words on; row k of both
    is at 2 k of out. Sums replace what is there ("no"), or are added to it, term by term ("each")
    or once they are complete ("sum").
    """
    factors = [[float(factor) for factor in row] for row in table]

    @_intrinsic
    def sums(typing_context: Any, vector: Any, result: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            x, out = (
                make_array(signature.args[n])(context, builder, values[n]).data for n in range(2)
            )
            pair, integer = ir.VectorType(ir.DoubleType(), 2), ir.IntType(64)
            places = [
                builder.bitcast(builder.gep(out, [ir.Constant(integer, 2 * k)]), pair.as_pointer())
                for k in range(len(factors[0]))
            ]
            totals: list[Any] = [None for _ in places]
            if add == "each":
                totals = [builder.load(place, align=8) for place in places]
            for m, line in enumerate(factors):
                both = ir.Constant(pair, ir.Undefined)
                for lane in range(2):
                    word = ir.Constant(integer, m + 4 * lane)
                    number = builder.load(builder.gep(x, [word]))
                    index = ir.Constant(ir.IntType(32), lane)
                    both = builder.insert_element(both, number, index)
                terms: dict[float, Any] = {}
                for k, factor in enumerate(line):
                    totals[k] = _add_term(builder, totals[k], factor, both, terms)
            if add == "sum":
                totals = [
                    builder.fadd(builder.load(place, align=8), total)
                    for place, total in zip(places, totals, strict=True)
                ]
            for place, total in zip(places, totals, strict=True):
                builder.store(total, place, align=8)
            return context.get_dummy_value()

        return types.void(vector, result), generate

    return sums


def values_of_two(tables: Any) -> Any:
    """Kernel f(unknowns, out): two components of a function at three points, side by side.

    tables: for each unknown what it has there, in the order of the sum. Unknown k has its first
    component at the word 2 k, its second beside it. What that is at the points comes to the words
    0, 1, 2 of out, the second component four words on; the words after them get numbers that count
    for nothing.
    """
    factors = [[float(factor) for factor in table[:3]] for table in tables]

    @_intrinsic
    def values(typing_context: Any, unknowns: Any, result: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, given: Any) -> Any:
            x, out = (
                make_array(signature.args[n])(context, builder, given[n]).data for n in range(2)
            )
            pair, integer = ir.VectorType(ir.DoubleType(), 2), ir.IntType(64)

            def place(data: Any, word: int) -> Any:
                address = builder.gep(data, [ir.Constant(integer, word)])
                return builder.bitcast(address, pair.as_pointer())

            def lanes(first: Any, second: Any, lane: int) -> Any:
                mask = ir.Constant(ir.VectorType(ir.IntType(32), 2), [lane, lane + 2])
                return builder.shuffle_vector(first, second, mask)

            points: list[Any] = [None] * 3
            for k, table in enumerate(factors):
                both = builder.load(place(x, 2 * k), align=8)
                terms: dict[float, Any] = {}
                for g in range(3):
                    points[g] = _add_term(builder, points[g], table[g], both, terms)
            for component in range(2):
                first = lanes(points[0], points[1], component)
                builder.store(first, place(out, 4 * component), align=8)
                last = lanes(points[2], points[2], component)
                builder.store(last, place(out, 4 * component + 2), align=8)
            return context.get_dummy_value()

        return types.void(unknowns, result), generate

    return values


def scatter_pairs(dimension: int, row: int) -> Any:
    """Kernel f(pairs, above, upper, lower, below): an element's matrix into its nodes' blocks.

    pairs: the sixteen pairs of shape functions, `row` words each, with a word for every pair of
    components. They are added to the blocks of the node above and of that
    below, and replace those off the diagonal.
    """
    size = 2 * dimension
    integer = ir.IntType(64)
    vectors = [(0, 2)] if dimension == 2 else [(0, 2), (2, 1)]  # words side by side: from, how many

    @_intrinsic
    def scatter(
        typing_context: Any, pairs: Any, above: Any, upper: Any, lower: Any, below: Any
    ) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            data = [
                make_array(signature.args[n])(context, builder, values[n]).data for n in range(5)
            ]
            first = data[0]

            def place(address: Any, word: int, count: int) -> Any:
                kind = ir.VectorType(ir.DoubleType(), count).as_pointer()
                return builder.bitcast(builder.gep(address, [ir.Constant(integer, word)]), kind)

            for function in range(16):
                k, l = divmod(function, 4)
                to, adds = data[1 + 2 * (k // 2) + l // 2], k // 2 == l // 2
                for i in range(dimension):
                    for j, count in vectors:
                        word = row * function + dimension * i + j
                        value = builder.load(place(first, word, count), align=8)
                        word = size * (dimension * (k % 2) + i) + dimension * (l % 2) + j
                        there = place(to, word, count)
                        if adds:
                            value = builder.fadd(builder.load(there, align=8), value)
                        builder.store(value, there, align=8)
            return context.get_dummy_value()

        return types.void(pairs, above, upper, lower, below), generate

    return scatter


def two_products(size: int) -> Any:
    """Kernel f(A, x, above, below, out, to): two products of a vector in two parts with rows of A.

    A holds the rows' parts of `size` words (even) one after another: both that meet x from `above`
    on, then both that meet x from `below` on. out and the word after it get the sums.
    """

    @_intrinsic
    def product(
        typing_context: Any, matrix: Any, vector: Any, above: Any, below: Any, result: Any, to: Any
    ) -> Any:
        word = types.int64
        signature = types.void(matrix, vector, word, word, result, word)

        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            rows, x, out = (
                make_array(signature.args[n])(context, builder, values[n]).data for n in (0, 1, 4)
            )
            pair, integer = ir.VectorType(ir.DoubleType(), 2), ir.IntType(64)

            def load(data: Any, word: Any) -> Any:
                place = builder.bitcast(builder.gep(data, [word]), pair.as_pointer())
                return builder.load(place, align=8)

            totals: list[Any] = [None, None]
            for part, start in enumerate(values[2:4]):
                for n in range(0, size, 2):
                    both = load(x, builder.add(start, ir.Constant(integer, n)))
                    for row in range(2):
                        at = ir.Constant(integer, size * (2 * part + row) + n)
                        term = builder.fmul(load(rows, at), both)
                        total = totals[row]
                        totals[row] = term if total is None else builder.fadd(total, term)
            for row, total in enumerate(totals):
                lanes = [
                    builder.extract_element(total, ir.Constant(ir.IntType(32), lane))
                    for lane in range(2)
                ]
                place = builder.gep(out, [builder.add(values[5], ir.Constant(integer, row))])
                builder.store(builder.fadd(*lanes), place)
            return context.get_dummy_value()

        return signature, generate

    return product


def block_kernels(size: int) -> tuple[Any, Any]:
    """(transpose, invert) of one small block of size (even) by size words, held in registers.

    transpose(A, start, to) writes the transpose of the block at `start` to `to`. invert(A, start)
    replaces it by the transpose of its inverse (Gauss-Jordan without pivoting) and returns
    whether no pivot vanished.
    """
    pair, integer = ir.VectorType(ir.DoubleType(), 2), ir.IntType(64)
    halves = range(size // 2)

    def place(builder: Any, data: Any, start: Any, offset: int) -> Any:
        word = builder.add(start, ir.Constant(integer, offset))
        return builder.bitcast(builder.gep(data, [word]), pair.as_pointer())

    def transposed(builder: Any, data: Any, start: Any) -> list[list[Any]]:
        """Rows of the transpose, each as pairs."""
        rows: list[list[Any]] = [[None for _ in halves] for _ in range(size)]
        for i in halves:
            for j in halves:
                upper = builder.load(place(builder, data, start, 2 * i * size + 2 * j), align=8)
                lower = builder.load(
                    place(builder, data, start, (2 * i + 1) * size + 2 * j), align=8
                )
                for lane in range(2):
                    mask = ir.Constant(ir.VectorType(ir.IntType(32), 2), [lane, lane + 2])
                    rows[2 * j + lane][i] = builder.shuffle_vector(upper, lower, mask)
        return rows

    def store(builder: Any, rows: list[list[Any]], data: Any, to: Any) -> None:
        for n, row in enumerate(rows):
            for half in halves:
                builder.store(row[half], place(builder, data, to, n * size + 2 * half), align=8)

    @_intrinsic
    def transpose(typing_context: Any, array: Any, start: Any, to: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            data = make_array(signature.args[0])(context, builder, values[0]).data
            store(builder, transposed(builder, data, values[1]), data, values[2])
            return context.get_dummy_value()

        return types.void(array, types.int64, types.int64), generate

    @_intrinsic
    def invert(typing_context: Any, array: Any, start: Any) -> Any:
        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            data = make_array(signature.args[0])(context, builder, values[0]).data
            rows = transposed(builder, data, values[1])
            one, zero = (ir.Constant(ir.DoubleType(), number) for number in (1.0, 0.0))

            def lane(n: int) -> Any:
                return ir.Constant(ir.IntType(32), n % 2)

            def both(number: Any) -> Any:
                vector = ir.Constant(pair, ir.Undefined)
                for n in range(2):
                    vector = builder.insert_element(vector, number, lane(n))
                return vector

            good = ir.Constant(ir.IntType(1), 1)
            for k in range(size):
                pivot = builder.extract_element(rows[k][k // 2], lane(k))
                # Ordered and not equal: false for NaN too.
                good = builder.and_(good, builder.fcmp_ordered("!=", pivot, zero))
                inverse = both(builder.fdiv(one, pivot))
                rows[k][k // 2] = builder.insert_element(rows[k][k // 2], one, lane(k))
                rows[k] = [builder.fmul(half, inverse) for half in rows[k]]
                for i in range(size):
                    if i == k:
                        continue
                    factor = both(builder.extract_element(rows[i][k // 2], lane(k)))
                    rows[i][k // 2] = builder.insert_element(rows[i][k // 2], zero, lane(k))
                    rows[i] = [
                        builder.fsub(half, builder.fmul(factor, pivoted))
                        for half, pivoted in zip(rows[i], rows[k], strict=True)
                    ]
            store(builder, rows, data, values[1])
            return good

        return types.boolean(array, types.int64), generate

    return transpose, invert
