"""Where the parts of a system are at first: strings of masses, with weight and steady drag.

Strings pull and do not push, so the energy is convex and has one lowest place, whatever the start.
It is found by Newton's method, whose matrix is eliminated along the lines and then over the bodies:
what a row has is stored from its first column on.
"""

import math

from cablemodel.solvers.finite_element.kernels.floor.floor_surface import gap_at
from cablemodel.solvers.shared.access import (
    cable_of,
    closure_of,
    edge_of,
    first_shape_at,
    free_body_of,
    header,
    scalars,
    string_body_at,
    string_end_at,
    string_item_at,
    string_line_at,
    vector,
)
from cablemodel.solvers.shared.compile import inlined, kernel, outlined, view
from cablemodel.solvers.shared.layout import (
    FLOOR_NONE,
    JOINT_FREE,
    JOINT_HINGE,
    JOINT_NONE,
    JOINT_ROOT_FREE,
    SHAPE_WORDS,
    STRING_AT_BODY,
    STRING_BODY_WORDS,
    STRING_END_WORDS,
    STRING_HELD,
    STRING_ITEM_WORDS,
    STRING_LINE_WORDS,
    STRING_ON_LINE,
    STRING_PARTS,
)
from cablemodel.solvers.shared.numbers import NO_DIRECTION, NO_SIZE

STRETCHES = 0.3, 0.1, 0.03, 0.01, 0.004, 0.002
"""By which all forces together stretch one of them, one after the other: stiff strings let a step
turn them by little."""
STRING_ITERATIONS = 1000
"""For the lowest place of an energy, at most."""
BALANCED = 0.01
"""Of the least of all forces: what may be left of them at any place."""
SHARE_OF_DRAG = 0.3
"""Of a line's drag across, that it has on the average as it hangs."""
ASIDE_LOAD = 0.5
"""Load that draws lines aside, in units of their weight in water."""
AFLOAT = 0.02
"""Of a line's weight in air: what that is at least."""
LESS_DAMPED, MORE_DAMPED = 0.3, 4.0
"""Of the damping: the next one, after a step that lowers the energy, and after another one."""
MOST_DAMPED = 1e9
"""In force over length: damping at which no step is left."""
UPRIGHT_LINE = 0.1
"""Of a line's length: span across which it counts as upright."""
NO_WEIGHT = 1e-6
"""Of the weight in air: what is taken of cable that has none in water."""
NO_LOAD = 1e-9
"""Added to all loads together [N]: there may be none."""
SHAKEN = 1e-3
"""Of the shortest string: by what places are moved at random before the first step."""
CHORD_OF_SLOPE = 1e-3
"""Of a line's length, to either side of a node: the chord that gives its first slope."""

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


@kernel
def insert_arc(words, first, count, arc):
    """Put an arc length among those of a line, in order; returns how many there are then."""
    begin = arcs_begin(words) + first
    place = 0
    while place < count and words[begin + place] < arc:
        place += 1
    if place < count and words[begin + place] == arc:
        return count
    for n in range(count, place, -1):
        words[begin + n] = words[begin + n - 1]
    words[begin + place] = arc
    return count + 1


@kernel
def length_in(words, line):
    """Length of a line's cables [m]."""
    length = 0.0
    for item in range(int(first_shape_at(words, 0).items)):
        row = item_in(words, item)
        if row.line == line and row.body == 0.0:
            length += row.length
    return length


@kernel
def lay_masses(words):
    """Number the masses, bodies first, and lay those of lines along them at equal steps, with one
    where a branch is in the place of those within half a step of it. Returns how many there are."""
    shape = first_shape_at(words, 0)
    lines = int(shape.lines)
    count = int(shape.bodies)
    for line in range(lines):
        length = length_in(words, line)
        own = 0
        for part in range(STRING_PARTS + 1):
            arc = length if part == STRING_PARTS else part * (length / STRING_PARTS)
            alone = True
            for n in range(2 * lines):
                end = end_in(words, n)
                if end.kind == STRING_ON_LINE and end.other == line:
                    alone = alone and abs(arc - end.arc) >= 0.5 * length / STRING_PARTS
            if alone or part == 0 or part == STRING_PARTS:
                own = insert_arc(words, count, own, arc)
        for n in range(2 * lines):
            end = end_in(words, n)
            if end.kind == STRING_ON_LINE and end.other == line:
                own = insert_arc(words, count, own, end.arc)
        row = line_in(words, line)
        row.first = count
        row.count = own
        count += own
    return count


@kernel
def nearest_mass(words, line, arc):
    """The mass of a line that is nearest to an arc length."""
    row = line_in(words, line)
    first = int(row.first)
    found = first
    for mass in range(first, first + int(row.count)):
        off = abs(words[arcs_begin(words) + mass] - arc)
        if off < abs(words[arcs_begin(words) + found] - arc):
            found = mass
    return found


@kernel
def load_masses(words, load):
    """Weight in water and steady drag of each mass (count, 3) [N]."""
    shape = first_shape_at(words, 0)
    flow = vector()
    speed = 0.0
    for i in range(3):
        flow[i] = shape.flow[i] - shape.velocity[i]
        speed += flow[i] ** 2
    speed = math.sqrt(speed)
    for body in range(int(shape.bodies)):
        row = body_in(words, body)
        load[3 * body + 2] -= row.weight
        for i in range(3):
            load[3 * body + i] += row.drag * speed * flow[i]
    per_length = vector()
    arcs = arcs_begin(words)
    for line in range(int(shape.lines)):
        own = line_in(words, line)
        first = int(own.first)
        along = 0.0
        for item in range(int(shape.items)):
            row = item_in(words, item)
            if row.line != line:
                continue
            if row.body != 0.0:
                mass = nearest_mass(words, line, along)
                load[3 * mass + 2] -= row.weight
                for i in range(3):
                    load[3 * mass + i] += row.drag * speed * flow[i]
                continue
            air = row.mass * shape.gravity
            weight = row.weight if row.weight != 0.0 else NO_WEIGHT * air
            for i in range(3):
                per_length[i] = SHARE_OF_DRAG * row.drag * speed * flow[i]
                if shape.aside != 0.0:
                    per_length[i] += ASIDE_LOAD * max(abs(weight), AFLOAT * air) * own.way[i]
            per_length[2] -= weight
            low = along
            along += row.length
            for mass in range(first, first + int(own.count) - 1):
                part = min(along, words[arcs + mass + 1]) - max(low, words[arcs + mass])
                if part > 0.0:
                    for i in range(6):
                        load[3 * mass + i] += 0.5 * part * per_length[i % 3]


@kernel
def tie_masses(words, count, owner, base):
    """Whose place each mass has, (count,), itself or another one, and what is added to it,
    (count, 3) [m]; of what is fixed, which owns itself, its place. Returns whether any is fixed.

    Owners of fixed masses are negative: -1 - themselves.
    """
    shape = first_shape_at(words, 0)
    for mass in range(count):
        owner[mass] = mass
    for body in range(int(shape.bodies)):
        row = body_in(words, body)
        if row.given == 2.0:
            owner[body] = -1 - body
            for i in range(3):
                base[3 * body + i] = row.place[i]
    for n in range(2 * int(shape.lines)):
        end = end_in(words, n)
        line = line_in(words, n // 2)
        mass = int(line.first)
        if n % 2 == 1:
            mass += int(line.count) - 1
        if end.kind == STRING_HELD:
            owner[mass] = -1 - mass
        elif end.kind == STRING_AT_BODY:
            owner[mass] = end.other
        elif end.kind == STRING_ON_LINE:
            owner[mass] = nearest_mass(words, int(end.other), end.arc)
        if end.kind == STRING_HELD or end.kind == STRING_AT_BODY:
            for i in range(3):
                base[3 * mass + i] = end.place[i]
    # Of a branch from a line's end at a body, and of what is tied to what is fixed.
    for _turn in range(2):
        for mass in range(count):
            other = int(owner[mass])
            if other >= 0 and other != mass and owner[other] != other:
                owner[mass] = owner[other]
                for i in range(3):
                    base[3 * mass + i] += base[3 * other + i]


@kernel
def group_masses(words, count, strings, work, most):
    """Number of the group of each mass that moves together, (count,); negative: held by what is
    fixed."""
    owner = view(work, ROW_OWNER * most, most)
    group = view(work, ROW_GROUP * most, most)
    for mass in range(count):
        group[mass] = mass if owner[mass] >= 0.0 else -1.0
    changes = True
    while changes:
        changes = False
        for n in range(strings + count):
            a = n - strings
            b = 0
            if n < strings:
                a = int(work[ROW_LEFT * most + n])
                b = int(work[ROW_RIGHT * most + n])
            elif owner[a] >= 0.0:
                b = int(owner[a])
            else:
                continue
            if group[a] != group[b]:
                group[a] = group[b] = min(group[a], group[b])
                changes = True


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


@kernel
def begin_places(words, count, strings, work):
    """Number the unknown places and give them values: bodies where the scene has them, what nothing
    holds there together, all else in the middle of what is fixed. Returns how many there are."""
    shape = first_shape_at(words, 0)
    most = int(shape.most)
    bodies = int(shape.bodies)
    owner = view(work, ROW_OWNER * most, most)
    base = view(work, ROW_BASE * most, 3 * most)
    group = view(work, ROW_GROUP * most, most)
    x = view(work, ROW_PLACE * most, 3 * most)
    shortest = math.inf
    for n in range(strings):
        shortest = min(shortest, work[ROW_REST * most + n])
    middle = vector()
    fixed = 0
    for mass in range(count):
        if owner[mass] == -1 - mass:
            fixed += 1
            for i in range(3):
                middle[i] += base[3 * mass + i]
    unknowns = 0
    for mass in range(count):
        if mass == bodies:
            work[ROW_SIZES * most] = unknowns
        work[ROW_UNKNOWN * most + mass] = -1.0
        if owner[mass] != mass:
            continue
        work[ROW_UNKNOWN * most + mass] = unknowns
        for i in range(3):
            start = middle[i] / max(fixed, 1)
            put = 0
            total = 0.0
            for body in range(bodies):
                row = body_in(words, body)
                if row.given == 1.0 and group[body] == group[mass] and group[mass] >= 0.0:
                    put += 1
                    total += row.place[i]
            if put > 0:
                start = total / put
            if mass < bodies and body_in(words, mass).given == 1.0:
                start = body_in(words, mass).place[i]
            # No string may have length 0.
            random = words[random_begin(words) + 3 * unknowns + i]
            x[3 * unknowns + i] = start + SHAKEN * shortest * random
        unknowns += 1
    for mass in range(count):
        if owner[mass] >= 0.0:
            work[ROW_UNKNOWN * most + mass] = work[ROW_UNKNOWN * most + int(owner[mass])]
    return unknowns


@kernel
def middle_of_fixed(words, count, work, i):
    """A coordinate of the middle of what is fixed [m]."""
    most = int(first_shape_at(words, 0).most)
    middle = 0.0
    fixed = 0
    for mass in range(count):
        if work[ROW_OWNER * most + mass] == -1 - mass:
            fixed += 1
            middle += work[ROW_BASE * most + 3 * mass + i]
    return middle / max(fixed, 1)


@kernel
def store_places(words, count, work):
    """Places of all masses into the table; what nothing holds goes where the scene puts its bodies;
    the way across each line."""
    shape = first_shape_at(words, 0)
    most = int(shape.most)
    bodies = int(shape.bodies)
    x = view(work, ROW_PLACE * most, 3 * most)
    group = view(work, ROW_GROUP * most, most)
    begin = places_begin(words)
    for mass in range(count):
        for i in range(3):
            words[begin + 3 * mass + i] = place_of(work, most, mass, x, i)
    for own in range(bodies):
        first = group[own] >= 0.0
        for body in range(own):
            first = first and group[body] != group[own]
        if not first:
            continue
        for i in range(2):
            put = 0
            bodies_of = 0
            by = 0.0
            back = 0.0
            for body in range(bodies):
                if group[body] == group[own]:
                    bodies_of += 1
                    back -= words[begin + 3 * body + i]
                    if body_in(words, body).given == 1.0:
                        put += 1
                        by += body_in(words, body).place[i] - words[begin + 3 * body + i]
            by = by / put if put > 0 else back / bodies_of + middle_of_fixed(words, count, work, i)
            for mass in range(count):
                if group[mass] == group[own]:
                    words[begin + 3 * mass + i] += by
    for line in range(int(shape.lines)):
        row = line_in(words, line)
        last = int(row.first) + int(row.count) - 1
        one = begin + 3 * int(row.first)
        other = begin + 3 * last
        x_across = -(words[other + 1] - words[one + 1])
        y_across = words[other] - words[one]
        size = math.sqrt(x_across**2 + y_across**2)
        upright = size <= UPRIGHT_LINE * words[arcs_begin(words) + last]
        row.way[0] = 1.0 if upright else x_across / size
        row.way[1] = 0.0 if upright else y_across / size
        row.way[2] = 0.0


@kernel
def find_first_shape(I, M, words, work):
    """Places of all masses of a FirstShape, and the ways across its lines. Returns how many words
    of work it needs, where there are not as many."""
    shape = first_shape_at(words, 0)
    most = int(shape.most)
    if len(work) < ROW_MATRIX * most:
        return ROW_MATRIX * most
    work[:] = 0.0
    count = lay_masses(words)
    load_masses(words, view(work, ROW_LOAD * most, 3 * most))
    tie_masses(
        words,
        count,
        view(work, ROW_OWNER * most, most),
        view(work, ROW_BASE * most, 3 * most),
    )
    strings = 0
    for line in range(int(shape.lines)):
        row = line_in(words, line)
        for mass in range(int(row.first), int(row.first) + int(row.count) - 1):
            here = arcs_begin(words) + mass
            work[ROW_LEFT * most + strings] = mass
            work[ROW_RIGHT * most + strings] = mass + 1
            work[ROW_REST * most + strings] = words[here + 1] - words[here]
            strings += 1
    group_masses(words, count, strings, work, most)
    unknowns = begin_places(words, count, strings, work)
    size = find_profile(words, count, strings, unknowns, work)
    if len(work) < ROW_MATRIX * most + 2 * size:
        return ROW_MATRIX * most + 2 * size
    work[ROW_SIZES * most + 1] = size
    if unknowns > 0:
        for stretch in STRETCHES:
            find_lowest(I, M, words, count, strings, unknowns, stretch, work)
    store_places(words, count, work)
    return 0


@kernel
def shape_at(words, line, arc, place):
    """Place (3,) at an arc length of a line, within it [m]."""
    row = line_in(words, line)
    first = int(row.first)
    arcs = arcs_begin(words)
    mass = first
    while mass < first + int(row.count) - 2 and words[arcs + mass + 1] < arc:
        mass += 1
    low = words[arcs + mass]
    share = min(1.0, max(0.0, (arc - low) / (words[arcs + mass + 1] - low)))
    for i in range(3):
        here = places_begin(words) + 3 * mass + i
        place[i] = words[here] + share * (words[here + 3] - words[here])


@kernel
def place_on_line(I, M, words, node, element, sense):
    """Place and slope of a node along the first shape. element: the node at the far end of the one
    whose end it is; sense: of the tree along the line."""
    edge = edge_of(I, M, element)
    cable = cable_of(I, M, int(edge.segment))
    line = int(cable.row)
    arc = edge.start if node != element else edge.start + edge.length
    last = line_in(words, line)
    length = words[arcs_begin(words) + int(last.first) + int(last.count) - 1]
    arc = min(length, max(0.0, sense * arc))
    q = header(I).position + 6 * node
    here = vector()
    above = vector()
    below = vector()
    shape_at(words, line, arc, here)
    shape_at(words, line, max(0.0, arc - CHORD_OF_SLOPE * length), above)
    shape_at(words, line, min(length, arc + CHORD_OF_SLOPE * length), below)
    size = 0.0
    for i in range(3):
        size += (below[i] - above[i]) ** 2
    size = max(math.sqrt(size), NO_SIZE)
    for i in range(3):
        M[q + i] = here[i]
        M[q + 3 + i] = sense * (below[i] - above[i]) / size


@kernel
def place_on_shape(I, M, words):
    """Nodes of a system along its first shape, bodies at theirs, as they are turned there."""
    head = header(I)
    for node in range(head.nodes):
        joint = I[head.joint + node]
        if joint == JOINT_FREE or joint == JOINT_ROOT_FREE:
            continue
        alone = node == 0 or joint != JOINT_NONE
        element = node + 1 if alone else node
        backward = cable_of(I, M, int(edge_of(I, M, element).segment)).backward != 0.0
        place_on_line(I, M, words, node, element, -1.0 if backward else 1.0)
    for body in range(head.free_count):
        row = free_body_of(I, M, body)
        q = head.position + 6 * int(row.node)
        for i in range(3):
            M[q + i] = words[places_begin(words) + 3 * body + i]
            for j in range(3):
                M[q + i] -= row.rotation[3 * i + j] * row.origin[j]
            M[q + 3 + i] = 0.0
    for n in range(head.closure_count):
        tie = closure_of(I, M, n)
        if tie.clamp != 0.0:
            turn = free_body_of(I, M, int(tie.body)).rotation
            for i in range(3):
                slope = head.position + 6 * int(tie.node) + 3 + i
                M[slope] = 0.0
                for j in range(3):
                    M[slope] += turn[3 * i + j] * tie.place[j]
    # Steps move what shares a place alike, but do not bring it together.
    for node in range(head.nodes):
        joint = I[head.joint + node]
        if joint == JOINT_HINGE or joint == JOINT_FREE:
            for i in range(3):
                above = head.position + 6 * I[head.parent + node]
                M[head.position + 6 * node + i] = M[above + i]
