"""Products with small blocks, and their inverse, as kernels that hold them in registers.

What a loop nest would leave to the optimiser's taste is written out here, in vectors of two.
"""

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic
from numba.np.arrayobj import make_array

_intrinsic: Any = intrinsic  # for callers, what it makes takes one argument less


def table_product(table: Any) -> Any:
    """Kernel f(M, to, start): row e of a result is the sum over m of table[e, m] * row m.

    Rows are of `width` words (even), one after another from `start` and from `to`; the places do
    not meet. The table's numbers become constants of the code, and the loop over a row vectors of
    two: what a loop nest leaves to the optimiser's taste is thus settled, and compiled quickly.
    """
    factors = [[float(factor) for factor in row] for row in table]

    @_intrinsic(prefer_literal=True)
    def product(typing_context: Any, array: Any, to: Any, start: Any, width: Any) -> Any:
        words = width.literal_value
        signature = types.void(array, types.int64, types.int64, width)

        def generate(context: Any, builder: Any, signature: Any, values: Any) -> Any:
            data = make_array(signature.args[0])(context, builder, values[0]).data
            pair = ir.VectorType(ir.DoubleType(), 2)

            def place(start: Any, offset: int) -> Any:
                word = builder.add(start, ir.Constant(ir.IntType(64), offset))
                return builder.bitcast(builder.gep(data, [word]), pair.as_pointer())

            for column in range(0, words, 2):
                rows = [
                    builder.load(place(values[2], words * m + column), align=8)
                    for m in range(len(factors[0]))
                ]
                for e, line in enumerate(factors):
                    total = None
                    for factor, row in zip(line, rows, strict=True):
                        if factor != 0.0:
                            term = builder.fmul(ir.Constant(pair, [factor, factor]), row)
                            total = term if total is None else builder.fadd(total, term)
                    builder.store(total, place(values[1], words * e + column), align=8)
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
