"""The lowest place of a system's strings, by Newton's method.

Its matrix is eliminated along the lines and then over the bodies: what a row has is stored from its
first column on.
"""

import math

from cablemodel.solvers.finite_element.kernels.floor.floor_surface import gap_at
from cablemodel.solvers.finite_element.kernels.start.string_rows import (
    ROW_BASE,
    ROW_FIRST,
    ROW_GROUP,
    ROW_LEFT,
    ROW_LOAD,
    ROW_MATRIX,
    ROW_OWNER,
    ROW_PLACE,
    ROW_REST,
    ROW_RIGHT,
    ROW_SIZES,
    ROW_SLOPE,
    ROW_START,
    ROW_STEP,
    ROW_TRIAL,
    ROW_UNKNOWN,
    body_in,
)
from cablemodel.solvers.shared.access import first_shape_at, header, scalars, vector
from cablemodel.solvers.shared.compile import inlined, kernel, outlined, view
from cablemodel.solvers.shared.layout import FLOOR_NONE
from cablemodel.solvers.shared.numbers import NO_DIRECTION, NO_SIZE

STRETCHES = 0.3, 0.1, 0.03, 0.01, 0.004, 0.002
"""By which all forces together stretch one of them, one after the other: stiff strings let a step
turn them by little."""
STRING_ITERATIONS = 1000
"""For the lowest place of an energy, at most."""
BALANCED = 0.01
"""Of the least of all forces: what may be left of them at any place."""
LESS_DAMPED, MORE_DAMPED = 0.3, 4.0
"""Of the damping: the next one, after a step that lowers the energy, and after another one."""
MOST_DAMPED = 1e9
"""In force over length: damping at which no step is left."""
NO_LOAD = 1e-9
"""Added to all loads together [N]: there may be none."""


@kernel
def place_of(work, most, mass, x, i):
    """A coordinate of a mass's place, from those of the unknown ones."""
    unknown = int(work[ROW_UNKNOWN * most + mass])
    place = work[ROW_BASE * most + 3 * mass + i]
    if unknown >= 0:
        place += x[3 * unknown + i]
    return place


@inlined
def add_to(matrix, first, start, row, column, value):
    """Add to an element of the matrix's lower half."""
    matrix[int(start[row]) + column - int(first[row])] += value


@inlined
def matrix_row(work, most, unknowns, unknown):
    """First row of an unknown place in the matrix: bodies come last."""
    free = int(work[ROW_SIZES * most])
    return 3 * (unknown - free if unknown >= free else unknown + unknowns - free)


@outlined
def energy(I, M, words, count, strings, unknowns, x, stretch, work, wanted):
    """Energy of strings that pull and do not push, their loads, hulls that float and the floor,
    where all forces together stretch a string by `stretch` [N m]. wanted: its gradient and its
    Hessian, too."""
    shape = first_shape_at(words, 0)
    most = int(shape.most)
    bodies = int(shape.bodies)
    load = view(work, ROW_LOAD * most, 3 * most)
    slope = view(work, ROW_SLOPE * most, 3 * most)
    first = view(work, ROW_FIRST * most, 3 * most)
    start = view(work, ROW_START * most, 3 * most)
    matrix = view(work, ROW_MATRIX * most, int(work[ROW_SIZES * most + 1]))
    total = NO_LOAD
    shortest = math.inf
    for n in range(3 * count):
        total += abs(load[n])
    for n in range(strings):
        shortest = min(shortest, work[ROW_REST * most + n])
    if wanted:
        slope[:] = 0.0
        matrix[:] = 0.0
    value = 0.0
    d = vector()
    p = vector()
    normal = vector()
    hard = total / (STRETCHES[5] * shortest)
    for mass in range(count):
        unknown = int(work[ROW_UNKNOWN * most + mass])
        for i in range(3):
            p[i] = place_of(work, most, mass, x, i)
            value -= load[3 * mass + i] * p[i]
            if wanted and unknown >= 0:
                slope[3 * unknown + i] -= load[3 * mass + i]
        push = 0.0
        stiff = 0.0
        if mass < bodies:
            body = body_in(words, mass)
            if body.lift != 0.0:  # out of the water: by as much as its middle is above the surface
                high = 0.5 * (p[2] + body.middle) / body.half + 0.5
                dry = min(1.0, max(0.0, high))
                above = max(0.0, p[2] + body.middle - body.half)
                value += body.lift * (body.half * dry**2 + above)
                push += body.lift * dry
                if 0.0 < high < 1.0:
                    stiff += 0.5 * body.lift / body.half
        if header(I).floor_kind != FLOOR_NONE:
            for i in range(3):
                p[i] -= scalars(M).origin[i]
            # Of a slope the rise alone: it need only come near.
            sunk = -gap_at(I, M, p, normal) / max(normal[2], NO_SIZE)
            if sunk > 0.0:
                value += 0.5 * hard * sunk**2
                push -= hard * sunk
                stiff += hard
        if wanted and unknown >= 0:
            row = matrix_row(work, most, unknowns, unknown) + 2
            slope[3 * unknown + 2] += push
            add_to(matrix, first, start, row, row, stiff)
    for n in range(strings):
        left = int(work[ROW_LEFT * most + n])
        right = int(work[ROW_RIGHT * most + n])
        rest = work[ROW_REST * most + n]
        stiff = total / (stretch * rest)
        size = 0.0
        for i in range(3):
            d[i] = place_of(work, most, right, x, i) - place_of(work, most, left, x, i)
            size += d[i] ** 2
        size = max(math.sqrt(size), NO_DIRECTION)
        over = size - rest
        if over <= 0.0:
            continue
        value += 0.5 * stiff * over**2
        a = int(work[ROW_UNKNOWN * most + left])
        b = int(work[ROW_UNKNOWN * most + right])
        if not wanted or a == b:
            continue
        share = over / size
        low = -1
        high = -1
        if a >= 0:
            low = matrix_row(work, most, unknowns, a)
        if b >= 0:
            high = matrix_row(work, most, unknowns, b)
        for i in range(3):
            force = stiff * over * d[i] / size
            if a >= 0:
                slope[3 * a + i] -= force
            if b >= 0:
                slope[3 * b + i] += force
            for j in range(3):
                part = (1.0 - share) * d[i] * d[j] / size**2
                if i == j:
                    part += share
                part *= stiff
                if a >= 0 and j <= i:
                    add_to(matrix, first, start, low + i, low + j, part)
                if b >= 0 and j <= i:
                    add_to(matrix, first, start, high + i, high + j, part)
                if a >= 0 and b >= 0:
                    add_to(matrix, first, start, max(low, high) + i, min(low, high) + j, -part)
    return value


@kernel
def find_profile(words, count, strings, unknowns, work):
    """Where rows of the matrix begin, and how many words it has."""
    most = int(first_shape_at(words, 0).most)
    first = view(work, ROW_FIRST * most, 3 * most)
    start = view(work, ROW_START * most, 3 * most)
    for row in range(3 * unknowns):
        first[row] = row - row % 3
    for n in range(strings):
        a = int(work[ROW_UNKNOWN * most + int(work[ROW_LEFT * most + n])])
        b = int(work[ROW_UNKNOWN * most + int(work[ROW_RIGHT * most + n])])
        if a < 0 or b < 0:
            continue
        low = matrix_row(work, most, unknowns, a)
        high = matrix_row(work, most, unknowns, b)
        for i in range(3):
            row = max(low, high) + i
            first[row] = min(first[row], min(low, high))
    words_of = 0
    for row in range(3 * unknowns):
        start[row] = words_of
        words_of += row - int(first[row]) + 1
    return words_of


@outlined
def solve_strings(size, matrix, factor, first, start, damping, x):
    """Solve (matrix + damping) x = x by Cholesky's factors, in place."""
    for row in range(size):
        own = int(start[row]) - int(first[row])
        for column in range(int(first[row]), row + 1):
            other = int(start[column]) - int(first[column])
            value = matrix[own + column]
            if column == row:
                value += damping
            for k in range(max(int(first[row]), int(first[column])), column):
                value -= factor[own + k] * factor[other + k]
            if column == row:
                factor[own + row] = math.sqrt(value)
            else:
                factor[own + column] = value / factor[other + column]
    for row in range(size):
        own = int(start[row]) - int(first[row])
        for k in range(int(first[row]), row):
            x[row] -= factor[own + k] * x[k]
        x[row] /= factor[own + row]
    for row in range(size - 1, -1, -1):
        own = int(start[row]) - int(first[row])
        x[row] /= factor[own + row]
        for k in range(int(first[row]), row):
            x[k] -= factor[own + k] * x[row]


@kernel
def step_strings(words, count, unknowns, damping, work):
    """Newton's step of the unknown places, damped: what only moves together stays in the middle,
    as rounding divided by the damping would move it."""
    most = int(first_shape_at(words, 0).most)
    size = int(work[ROW_SIZES * most + 1])
    slope = view(work, ROW_SLOPE * most, 3 * most)
    step = view(work, ROW_STEP * most, 3 * most)
    trial = view(work, ROW_TRIAL * most, 3 * most)
    x = view(work, ROW_PLACE * most, 3 * most)
    for unknown in range(unknowns):
        row = matrix_row(work, most, unknowns, unknown)
        for i in range(3):
            step[row + i] = -slope[3 * unknown + i]
    solve_strings(
        3 * unknowns,
        view(work, ROW_MATRIX * most, size),
        view(work, ROW_MATRIX * most + size, size),
        view(work, ROW_FIRST * most, 3 * most),
        view(work, ROW_START * most, 3 * most),
        damping,
        step,
    )
    for unknown in range(unknowns):
        row = matrix_row(work, most, unknowns, unknown)
        for i in range(3):
            trial[3 * unknown + i] = step[row + i]
    for group in range(count):
        if work[ROW_GROUP * most + group] != group:
            continue
        for i in range(2):
            mean = 0.0
            number = 0
            for mass in range(count):
                unknown = int(work[ROW_UNKNOWN * most + mass])
                own = int(work[ROW_OWNER * most + mass]) == mass
                if work[ROW_GROUP * most + mass] == group and own:
                    mean += trial[3 * unknown + i]
                    number += 1
            for mass in range(count):
                unknown = int(work[ROW_UNKNOWN * most + mass])
                own = int(work[ROW_OWNER * most + mass]) == mass
                if work[ROW_GROUP * most + mass] == group and own:
                    trial[3 * unknown + i] -= mean / number
    for n in range(3 * unknowns):
        trial[n] += x[n]


@kernel
def find_lowest(I, M, words, count, strings, unknowns, stretch, work):
    """The lowest place of the energy, by Newton's method with Levenberg's damping."""
    shape = first_shape_at(words, 0)
    most = int(shape.most)
    load = view(work, ROW_LOAD * most, 3 * most)
    slope = view(work, ROW_SLOPE * most, 3 * most)
    x = view(work, ROW_PLACE * most, 3 * most)
    trial = view(work, ROW_TRIAL * most, 3 * most)
    total = NO_LOAD
    least = math.inf
    length = 0.0
    for mass in range(count):
        size = 0.0
        for i in range(3):
            total += abs(load[3 * mass + i])
            size += load[3 * mass + i] ** 2
        if size > 0.0:
            least = min(least, math.sqrt(size))
    least = min(least, total)
    for n in range(strings):
        length += work[ROW_REST * most + n] / strings
    damping = total / length
    value = energy(I, M, words, count, strings, unknowns, x, stretch, work, True)
    for _iteration in range(STRING_ITERATIONS):
        step_strings(words, count, unknowns, damping, work)
        lower = energy(I, M, words, count, strings, unknowns, trial, stretch, work, False)
        if lower < value:
            for n in range(3 * unknowns):
                x[n] = trial[n]
            value = energy(I, M, words, count, strings, unknowns, x, stretch, work, True)
            damping *= LESS_DAMPED
            left = 0.0
            for n in range(3 * unknowns):
                left = max(left, abs(slope[n]))
            if left < BALANCED * least:
                break
        else:
            damping *= MORE_DAMPED
            if damping > MOST_DAMPED * total / length:
                break
