"""The masses of a system's strings: where they are along lines, their loads, what holds them."""

import math

from cablemodel.solvers.finite_element.kernels.start.string_rows import (
    ROW_GROUP,
    ROW_LEFT,
    ROW_OWNER,
    ROW_RIGHT,
    arcs_begin,
    body_in,
    end_in,
    item_in,
    line_in,
)
from cablemodel.solvers.shared.access import first_shape_at, vector
from cablemodel.solvers.shared.compile import kernel, view
from cablemodel.solvers.shared.layout import (
    STRING_AT_BODY,
    STRING_HELD,
    STRING_ON_LINE,
    STRING_PARTS,
)

SHARE_OF_DRAG = 0.3
"""Of a line's drag across, that it has on the average as it hangs."""
ASIDE_LOAD = 0.5
"""Load that draws lines aside, in units of their weight in water."""
AFLOAT = 0.02
"""Of a line's weight in air: what that is at least."""
NO_WEIGHT = 1e-6
"""Of the weight in air: what is taken of cable that has none in water."""


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
