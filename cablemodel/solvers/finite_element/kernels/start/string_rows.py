"""Rows of a first shape's words, and of the work in which it is found."""

from cablemodel.solvers.shared.access import (
    first_shape_at,
    string_body_at,
    string_end_at,
    string_item_at,
    string_line_at,
)
from cablemodel.solvers.shared.compile import inlined
from cablemodel.solvers.shared.layout import (
    SHAPE_WORDS,
    STRING_BODY_WORDS,
    STRING_END_WORDS,
    STRING_ITEM_WORDS,
    STRING_LINE_WORDS,
)

# Rows of the work, in numbers of masses.
ROW_LOAD, ROW_BASE, ROW_PLACE, ROW_TRIAL, ROW_SLOPE, ROW_STEP = 0, 3, 6, 9, 12, 15
ROW_FIRST, ROW_START, ROW_OWNER, ROW_UNKNOWN, ROW_GROUP = 18, 21, 24, 25, 26
ROW_LEFT, ROW_RIGHT, ROW_REST, ROW_SIZES, ROW_MATRIX = 27, 28, 29, 30, 31


@inlined
def line_in(words, line):
    """Row of a line."""
    return string_line_at(words, SHAPE_WORDS + STRING_LINE_WORDS * line)


@inlined
def item_in(words, item):
    """Row of a cable or a point body."""
    before = SHAPE_WORDS + STRING_LINE_WORDS * int(first_shape_at(words, 0).lines)
    return string_item_at(words, before + STRING_ITEM_WORDS * item)


@inlined
def bodies_begin(words):
    """Word at which the rows of bodies begin."""
    shape = first_shape_at(words, 0)
    items = STRING_LINE_WORDS * int(shape.lines) + STRING_ITEM_WORDS * int(shape.items)
    return SHAPE_WORDS + items


@inlined
def body_in(words, body):
    """Row of a free body."""
    return string_body_at(words, bodies_begin(words) + STRING_BODY_WORDS * body)


@inlined
def ends_begin(words):
    """Word at which the rows of ends begin."""
    return bodies_begin(words) + STRING_BODY_WORDS * int(first_shape_at(words, 0).bodies)


@inlined
def end_in(words, end):
    """Row of an end: two of each line."""
    return string_end_at(words, ends_begin(words) + STRING_END_WORDS * end)


@inlined
def random_begin(words):
    """Word at which the masses' random numbers begin."""
    return ends_begin(words) + 2 * STRING_END_WORDS * int(first_shape_at(words, 0).lines)


@inlined
def arcs_begin(words):
    """Word at which the masses' arc lengths begin."""
    return random_begin(words) + 3 * int(first_shape_at(words, 0).most)


@inlined
def places_begin(words):
    """Word at which the masses' places begin."""
    return arcs_begin(words) + int(first_shape_at(words, 0).most)
