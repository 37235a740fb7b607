"""The linear system of a Newton step: a chain of slots, each with a left and a right matrix.

Slot 0 holds the conditions at the vessel, slot j the equations that tie node j to node j - 1 (field
equations inside a section, conditions at a joint), the last one the conditions at the far end:

    L_j x_(j-1) + R_j x_j = rhs_j,      x: change of the unknowns, each over its own scale

Rows are divided by their largest entry. Conditions at ends and joints are few: their derivatives
are taken by differences; those of the field equations are exact.
"""

from cablemodel.solvers.shared.compile import view

from .access import (
    assembly_work,
    material_row,
    own_header,
    own_scalars,
    rigid_body_of,
    section_of,
    shape_of,
    sides_of,
    strain_of,
    unknowns_of,
)
from .bodies import rigid_rows
from .compile import kernel
from .field import field_rows, set_strain
from .joints import end_rows, joint_rows, vessel_rows
from .layout import (
    BLOCK,
    CABLE,
    END_ANCHOR,
    F1,
    F2,
    F3,
    K1,
    K2,
    PHI,
    RIGID,
    THETA,
    V1,
    V2,
    V3,
    WIDTH,
)

_DIFFERENCE = 1e-7
_FULL = (1 << WIDTH) - 1
_FLEXIBLE = (1 << V1) | (1 << V2) | (1 << V3) | (1 << PHI) | (1 << THETA) | (1 << F3)
_PLANAR = (1 << V1) | (1 << V3) | (1 << PHI) | (1 << F1) | (1 << F3) | (1 << K2)
_VELOCITIES = (1 << V1) | (1 << V2) | (1 << V3)
_FORCES = (1 << F1) | (1 << F2) | (1 << F3)
_ANGLES = (1 << PHI) | (1 << THETA)
_CURVATURES = (1 << K1) | (1 << K2)


@kernel
def unknowns(I, kind):
    """Bit set of a node's unknowns in a section of that kind."""
    own = own_header(I)
    active = _FLEXIBLE if kind == CABLE else _FULL
    if own.planar != 0:
        active &= _PLANAR
    return active


@kernel
def rows_of_joint(I, left, right):
    """Bit set of the rows of joint_rows between two kinds of section."""
    own = own_header(I)
    rows = _VELOCITIES | _FORCES
    if left != CABLE or right != CABLE:
        rows |= _CURVATURES
    if left != CABLE and right != CABLE:
        rows |= _ANGLES
    if own.planar != 0:
        rows &= _PLANAR
    return rows


@kernel
def rows_of_end(I, kind, point):
    """Bit set of the rows of end_rows."""
    own = own_header(I)
    end = own.end
    if end == END_ANCHOR:
        rows = _VELOCITIES
        if kind != CABLE:
            rows |= _CURVATURES
    elif kind == CABLE:
        rows = _ANGLES | (1 << F3)
    else:
        rows = _FORCES | _CURVATURES
    if own.planar != 0:
        rows &= _PLANAR
    return rows


@kernel
def count_bits(mask):
    """How many unknowns or rows a bit set has."""
    total = 0
    for n in range(WIDTH):
        total += (mask >> n) & 1
    return total


@kernel
def residual_of(I, M, slot_kind, index, out):
    """Rows of a slot that is not an interval: 0 vessel, 1 joint, 2 far end, 3 rigid body."""
    if slot_kind == 0:
        vessel_rows(I, M, out)
    elif slot_kind == 1:
        joint_rows(I, M, index, out)
    elif slot_kind == 2:
        end_rows(I, M, out)
    else:
        section = section_of(I, M, index)
        body = rigid_body_of(I, M, section.body)
        rigid_rows(I, M, body, section.first, out)


@kernel
def differences(I, M, slot_kind, index, node, active, rows, matrix):
    """Derivatives of such a slot by the unknowns of one node, scaled by them, into a matrix."""
    own = own_header(I)
    run = own_scalars(M)
    found = assembly_work(I, M, 0)
    base = found.residual
    out = found.other_residual
    residual_of(I, M, slot_kind, index, base)
    y = view(M, own.unknowns + WIDTH * node, WIDTH)
    column = 0
    for j in range(WIDTH):
        if (active >> j) & 1 == 0:
            continue
        kept = y[j]
        scale = run.scale[j]
        step = _DIFFERENCE * max(abs(kept), scale)
        y[j] = kept + step
        step = y[j] - kept
        residual_of(I, M, slot_kind, index, out)
        y[j] = kept
        row = 0
        for i in range(WIDTH):
            if (rows >> i) & 1:
                matrix[WIDTH * row + column] = (out[i] - base[i]) * scale / step
                row += 1
        column += 1


@kernel
def scale_rows(I, M, slot, rows, left, right):
    """Divide the rows of a slot by their largest entry; the divisors are kept."""
    own = own_header(I)
    on_left = view(M, own.left + BLOCK * slot, BLOCK)
    on_right = view(M, own.right + BLOCK * slot, BLOCK)
    sides = sides_of(I, M, slot)
    for i in range(rows):
        largest = 0.0
        for j in range(left):
            largest = max(largest, abs(on_left[WIDTH * i + j]))
        for j in range(right):
            largest = max(largest, abs(on_right[WIDTH * i + j]))
        if largest == 0.0:
            largest = 1.0
        sides.scales[i] = largest
        for j in range(left):
            on_left[WIDTH * i + j] /= largest
        for j in range(right):
            on_right[WIDTH * i + j] /= largest
        sides.sides[i] /= largest


@kernel
def special_slot(I, M, slot_kind, index, slot, rows, left_node, left, right_node, right, column):
    """Fill a slot of the vessel, a joint, the far end or a rigid body; see `fill_system`."""
    own = own_header(I)
    out = assembly_work(I, M, 0).other_residual
    sides = sides_of(I, M, slot)
    if column == 0:
        if left != 0:
            matrix = view(M, own.left + BLOCK * slot, BLOCK)
            differences(I, M, slot_kind, index, left_node, left, rows, matrix)
        if right != 0:
            matrix = view(M, own.right + BLOCK * slot, BLOCK)
            differences(I, M, slot_kind, index, right_node, right, rows, matrix)
    residual_of(I, M, slot_kind, index, out)
    count = 0
    for i in range(WIDTH):
        if (rows >> i) & 1:
            sides.sides[WIDTH * column + count] = -out[i]
            count += 1
    if column == 0:
        shape = shape_of(I, M, slot)
        shape.rows = count
        shape.left = count_bits(left)
        shape.right = count_bits(right)
        shape.interval = 1 if slot_kind == 3 else 0
        scale_rows(I, M, slot, count, shape.left, shape.right)
    else:
        for i in range(count):
            sides.sides[WIDTH * column + i] /= sides.scales[i]


@kernel
def interval_slot(I, M, kind, material, active, slot, column):
    """Fill the slot of an interval of a cable or an elastica; see `fill_system`."""
    own = own_header(I)
    run = own_scalars(M)
    left = slot - 1
    h = M[own.length + slot]
    found = assembly_work(I, M, 0)
    mid = found.by_middle
    dif = found.by_difference
    stretch = found.by_stretch
    stretch_s = found.by_stretch_slope
    field_rows(I, M, kind, material, left, h, found)
    sides = sides_of(I, M, slot)
    if column != 0:
        row = 0
        for i in range(WIDTH):
            if (active >> i) & 1:
                sides.sides[WIDTH * column + row] = -found.residual[i] / sides.scales[row]
                row += 1
        return
    slope_left = strain_of(I, M, left).slope
    slope_right = strain_of(I, M, slot).slope
    for i in range(WIDTH):
        # The stretch at the middle and its difference follow the tensions at both nodes.
        half = 0.5 * stretch[i]
        steep = stretch_s[i] / h
        stretch[i] = slope_left * (half - steep)
        stretch_s[i] = slope_right * (half + steep)
    on_left = view(M, own.left + BLOCK * slot, BLOCK)
    on_right = view(M, own.right + BLOCK * slot, BLOCK)
    row = 0
    for i in range(WIDTH):
        if (active >> i) & 1 == 0:
            continue
        column_at = 0
        for j in range(WIDTH):
            if (active >> j) & 1 == 0:
                continue
            half = 0.5 * mid[WIDTH * i + j]
            steep = dif[WIDTH * i + j] / h
            by_left = half - steep
            by_right = half + steep
            if j == F3:
                by_left += stretch[i]
                by_right += stretch_s[i]
            scale = run.scale[j]
            on_left[WIDTH * row + column_at] = by_left * scale
            on_right[WIDTH * row + column_at] = by_right * scale
            column_at += 1
        sides.sides[row] = -found.residual[i]
        row += 1
    shape = shape_of(I, M, slot)
    shape.rows = row
    shape.left = row
    shape.right = row
    shape.interval = 1
    scale_rows(I, M, slot, row, row, row)


@kernel
def set_strains(I, M):
    """Strains of all nodes at their tensions; none in a rigid body."""
    own = own_header(I)
    for index in range(own.section_count):
        section = section_of(I, M, index)
        first = section.first
        for node in range(first, first + section.count):
            at = strain_of(I, M, node)
            if section.kind == RIGID:
                at.strain = 0.0
                at.slope = 0.0
            else:
                tension = unknowns_of(I, M, node).f3
                set_strain(M, at, material_row(I, M, section.material), tension)


@kernel
def fill_system(I, M, column):
    """All slots at the present iterate; returns the number of slots.

    column 0: matrices and minus the residual as the first right-hand side. column 1: minus the
    residual alone, as the second one, with the matrices and row scales of an earlier call.
    """
    own = own_header(I)
    set_strains(I, M)
    sections = own.section_count
    previous = 0
    kind = 0
    node = 0
    for index in range(sections):
        section = section_of(I, M, index)
        kind = section.kind
        active = unknowns(I, kind)
        first = section.first
        node = first
        if index == 0:
            rows = _VELOCITIES
            if kind != CABLE:
                rows |= _CURVATURES
            if own.planar != 0:
                rows &= _PLANAR
            special_slot(I, M, 0, 0, 0, rows, 0, 0, 0, active, column)
        else:
            left = unknowns(I, previous)
            rows = rows_of_joint(I, previous, kind)
            special_slot(I, M, 1, index, first, rows, first - 1, left, first, active, column)
        if kind == RIGID:
            node = first + 1
            special_slot(I, M, 3, index, node, active, first, active, node, active, column)
        else:
            material = material_row(I, M, section.material)
            for node in range(first + 1, first + section.count):
                interval_slot(I, M, kind, material, active, node, column)
            node = first + section.count - 1
        previous = kind
    point = section_of(I, M, sections).point
    rows = rows_of_end(I, kind, point)
    special_slot(I, M, 2, 0, node + 1, rows, node, unknowns(I, kind), 0, 0, column)
    return node + 2
