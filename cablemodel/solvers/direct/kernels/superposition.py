"""The chain of slots solved as the paper solves it: by superposition of initial value problems.

At a node all solutions that meet the conditions on one side are y0 + Y z (eq. 39): a particular
solution and half as many complementary ones as there are unknowns. They are carried across an
interval by the implicit midpoint rule, each an initial value problem, and made orthonormal again
at every node, with y0 orthogonal to them: that suppresses the growing components, which would
otherwise drown the others (growth by more than 1e16 leaves nothing).

A hybrid line is integrated from both ends to the joint C and recombined there (eqs. 40 to 45); a
line of one kind from the vessel to its far end, whose conditions then give z.
"""

import math

from cablemodel.solvers.shared.compile import view
from cablemodel.solvers.shared.layout import OK, SINGULAR

from .access import own_header, partial_solutions_of, shape_of, sides_of, superposition_work
from .compile import kernel
from .layout import BLOCK, HALF, WIDTH
from .layout import SUPERPOSED as COLUMNS

SIDES = 2 * WIDTH
"""Column of the right-hand sides in a row."""
NEARLY_SINGULAR = 1e-7
"""Pivot of a transfer (its rows have entries of at most one) below which no initial value problem
is solved: the midpoint rule has a pole where h sqrt(T/EI) = 2, and at a flexible free end."""


@kernel
def orthonormalise(at, n, p, sides):
    """Make Y orthonormal (modified Gram-Schmidt) and y0 orthogonal to it; keep T and S: at, a
    PartialSolutions of n unknowns and p coefficients.

    Y_old = Y T and y0_old = y0 + Y S, so that z = T z_old + S. Returns 1 if Y has lost its rank.
    """
    Y = at.complementary
    T = at.mix
    for k in range(p):
        for j in range(k):
            T[HALF * k + j] = 0.0
        norm = 0.0
        for i in range(n):
            norm += Y[HALF * i + k] ** 2
        norm = math.sqrt(norm)
        if not norm > 1e-280:
            return 1
        T[HALF * k + k] = norm
        for i in range(n):
            Y[HALF * i + k] /= norm
        for j in range(k + 1, p):
            dot = 0.0
            for i in range(n):
                dot += Y[HALF * i + k] * Y[HALF * i + j]
            T[HALF * k + j] = dot
            for i in range(n):
                Y[HALF * i + j] -= dot * Y[HALF * i + k]
    for side in range(sides):
        y0 = view(at.particular, WIDTH * side, WIDTH)
        for k in range(p):
            dot = 0.0
            for i in range(n):
                dot += Y[HALF * i + k] * y0[i]
            at.shift[HALF * side + k] = dot
            for i in range(n):
                y0[i] -= dot * Y[HALF * i + k]
    return 0


@kernel
def source_terms(I, M, slot, matrix, near, n, p, sides, rows, work):
    """Into the work matrix: A Y in the first p columns, rhs - A y0 in columns from SIDES on."""
    for i in range(rows):
        row = view(work, COLUMNS * i, COLUMNS)
        a = view(M, matrix + BLOCK * slot + WIDTH * i, WIDTH)
        for k in range(p):
            value = 0.0
            for j in range(n):
                value += a[j] * near.complementary[HALF * j + k]
            row[k] = value
        for side in range(sides):
            value = sides_of(I, M, slot).sides[WIDTH * side + i]
            for j in range(n):
                value -= a[j] * near.particular[WIDTH * side + j]
            row[SIDES + side] = value


@kernel
def transfer(M, slot, matrix, far, n, p, sides, work):
    """Solve B delta = source for the p + sides initial value problems of an interval."""
    # B is copied next to the sources, in columns HALF ... HALF + n.
    for i in range(n):
        for j in range(n):
            work[COLUMNS * i + HALF + j] = M[matrix + BLOCK * slot + WIDTH * i + j]
    for k in range(n):
        pivot = k
        largest = abs(work[COLUMNS * k + HALF + k])
        for i in range(k + 1, n):
            size = abs(work[COLUMNS * i + HALF + k])
            if size > largest:
                largest = size
                pivot = i
        if not largest > NEARLY_SINGULAR:
            return SINGULAR
        if pivot != k:
            for j in range(COLUMNS):
                kept = work[COLUMNS * k + j]
                work[COLUMNS * k + j] = work[COLUMNS * pivot + j]
                work[COLUMNS * pivot + j] = kept
        inverse = 1.0 / work[COLUMNS * k + HALF + k]
        for i in range(k + 1, n):
            factor = work[COLUMNS * i + HALF + k] * inverse
            if factor == 0.0:
                continue
            for j in range(k + 1, n):
                work[COLUMNS * i + HALF + j] -= factor * work[COLUMNS * k + HALF + j]
            for j in range(p):
                work[COLUMNS * i + j] -= factor * work[COLUMNS * k + j]
            for j in range(sides):
                work[COLUMNS * i + SIDES + j] -= factor * work[COLUMNS * k + SIDES + j]
    for i in range(n - 1, -1, -1):
        inverse = 1.0 / work[COLUMNS * i + HALF + i]
        for k in range(p):
            value = -work[COLUMNS * i + k]
            for j in range(i + 1, n):
                value -= work[COLUMNS * i + HALF + j] * far.complementary[HALF * j + k]
            far.complementary[HALF * i + k] = value * inverse
        for side in range(sides):
            value = work[COLUMNS * i + SIDES + side]
            for j in range(i + 1, n):
                value -= work[COLUMNS * i + HALF + j] * far.particular[WIDTH * side + j]
            far.particular[WIDTH * side + i] = value * inverse
    return OK


@kernel
def cross(I, M, slot, matrix, far, n, p, sides, rows):
    """Carry the solutions across a joint, or start them at an end (p = 0).

    The slot's rows tie the p coefficients on the near side and the n unknowns on the far side.
    Gauss-Jordan with full pivoting leaves n / 2 of them free: the new coefficients.
    """
    scratch = superposition_work(I, M, 0)
    work = scratch.rows
    order = scratch.pivot_row
    columns = p + n
    for i in range(rows):
        for j in range(n):
            work[COLUMNS * i + p + j] = M[matrix + BLOCK * slot + WIDTH * i + j]
    for j in range(columns):
        order[j] = -1
    for step in range(rows):
        row = -1
        column = -1
        largest = 1e-280
        for i in range(step, rows):
            for j in range(columns):
                if order[j] < 0 and abs(work[COLUMNS * i + j]) > largest:
                    largest = abs(work[COLUMNS * i + j])
                    row = i
                    column = j
        if row < 0:
            return SINGULAR
        order[column] = step
        for j in range(COLUMNS):
            kept = work[COLUMNS * step + j]
            work[COLUMNS * step + j] = work[COLUMNS * row + j]
            work[COLUMNS * row + j] = kept
        inverse = 1.0 / work[COLUMNS * step + column]
        for j in range(columns):
            work[COLUMNS * step + j] *= inverse
        for j in range(sides):
            work[COLUMNS * step + SIDES + j] *= inverse
        for i in range(rows):
            factor = work[COLUMNS * i + column]
            if i == step or factor == 0.0:
                continue
            for j in range(columns):
                work[COLUMNS * i + j] -= factor * work[COLUMNS * step + j]
            for j in range(sides):
                work[COLUMNS * i + SIDES + j] -= factor * work[COLUMNS * step + SIDES + j]
    for j in range(columns):
        # Coefficients of the near side go to a and B, unknowns of the far side to y0 and Y.
        for side in range(sides):
            value = 0.0
            if order[j] >= 0:
                value = work[COLUMNS * order[j] + SIDES + side]
            if j < p:
                far.known[HALF * side + j] = value
            else:
                far.particular[WIDTH * side + j - p] = value
        k = 0
        for free in range(columns):
            if order[free] >= 0:
                continue
            value = 1.0 if free == j else 0.0
            if order[j] >= 0:
                value = -work[COLUMNS * order[j] + free]
            if j < p:
                far.cross[HALF * j + k] = value
            else:
                far.complementary[HALF * (j - p) + k] = value
            k += 1
    return OK


@kernel
def sweep(I, M, first, last, step):
    """Partial solutions from slot `first` up to, not including, `last`; step +1 or -1."""
    own = own_header(I)
    sides = own.right_sides
    work = superposition_work(I, M, 0).rows
    near = partial_solutions_of(I, M, 0)
    n_near = 0
    slot = first
    while slot != last:
        shape = shape_of(I, M, slot)
        node = slot if step > 0 else slot - 1
        n = shape.right if step > 0 else shape.left
        towards = own.right if step > 0 else own.left
        behind = own.left if step > 0 else own.right
        far = partial_solutions_of(I, M, node)
        rows = shape.rows
        p = n_near // 2
        source_terms(I, M, slot, behind, near, n_near, p, sides, rows, work)
        if shape.interval != 0:
            status = transfer(M, slot, towards, far, n, p, sides, work)
            if status == SINGULAR:
                # Any solution will do, not only one that starts from the near side: as at a joint.
                shape.interval = 0
                source_terms(I, M, slot, behind, near, n_near, p, sides, rows, work)
        if shape.interval == 0:
            status = cross(I, M, slot, towards, far, n, p, sides, rows)
        if status != OK:
            return status
        if orthonormalise(far, n, n // 2, sides) != 0:
            return SINGULAR
        near = far
        n_near = n
        slot += step
    return OK


@kernel
def recombine(I, M, slot):
    """Coefficients z of both sides from the conditions of slot C (eqs. 43 to 45).

    They go to `solution`: WIDTH words a right-hand side, left side first.
    """
    own = own_header(I)
    sides = own.right_sides
    scratch = superposition_work(I, M, 0)
    work = scratch.rows
    shape = shape_of(I, M, slot)
    rows = shape.rows
    left = partial_solutions_of(I, M, slot - 1)
    right = partial_solutions_of(I, M, slot)
    n_left = shape.left
    n_right = shape.right
    p_left = n_left // 2
    p_right = n_right // 2
    for i in range(rows):
        row = view(work, COLUMNS * i, COLUMNS)
        a = view(M, own.left + BLOCK * slot + WIDTH * i, WIDTH)
        b = view(M, own.right + BLOCK * slot + WIDTH * i, WIDTH)
        for k in range(p_left):
            value = 0.0
            for j in range(n_left):
                value += a[j] * left.complementary[HALF * j + k]
            row[k] = value
        for k in range(p_right):
            value = 0.0
            for j in range(n_right):
                value += b[j] * right.complementary[HALF * j + k]
            row[p_left + k] = value
        for side in range(sides):
            value = sides_of(I, M, slot).sides[WIDTH * side + i]
            for j in range(n_left):
                value -= a[j] * left.particular[WIDTH * side + j]
            for j in range(n_right):
                value -= b[j] * right.particular[WIDTH * side + j]
            row[SIDES + side] = value
    for k in range(rows):
        pivot = k
        for i in range(k + 1, rows):
            if abs(work[COLUMNS * i + k]) > abs(work[COLUMNS * pivot + k]):
                pivot = i
        if not abs(work[COLUMNS * pivot + k]) > 1e-300:
            return SINGULAR
        for j in range(COLUMNS):
            kept = work[COLUMNS * k + j]
            work[COLUMNS * k + j] = work[COLUMNS * pivot + j]
            work[COLUMNS * pivot + j] = kept
        inverse = 1.0 / work[COLUMNS * k + k]
        for i in range(rows):
            factor = work[COLUMNS * i + k] * inverse
            if i == k or factor == 0.0:
                continue
            for j in range(k, rows):
                work[COLUMNS * i + j] -= factor * work[COLUMNS * k + j]
            for j in range(sides):
                work[COLUMNS * i + SIDES + j] -= factor * work[COLUMNS * k + SIDES + j]
    for side in range(sides):
        for k in range(rows):
            scratch.solution[WIDTH * side + k] = (
                work[COLUMNS * k + SIDES + side] / work[COLUMNS * k + k]
            )
    return OK


@kernel
def return_sweep(I, M, node, last, step):
    """Changes of all nodes from `node` to `last` from the `coefficients` at `node`: HALF of them
    for each of two right-hand sides, WIDTH words apart."""
    own = own_header(I)
    scratch = superposition_work(I, M, 0)
    old = scratch.before
    sides = own.right_sides
    while True:
        at = partial_solutions_of(I, M, node)
        slot = node if step < 0 else node + 1  # the slot that the sweep came through
        shape = shape_of(I, M, slot)
        n = shape.right if step < 0 else shape.left
        before = shape.left if step < 0 else shape.right
        p = n // 2
        for side in range(sides):
            c = view(scratch.coefficients, WIDTH * side, WIDTH)
            out = view(M, own.delta + WIDTH * (2 * node + side), WIDTH)
            for i in range(n):
                value = at.particular[WIDTH * side + i]
                for k in range(p):
                    value += at.complementary[HALF * i + k] * c[k]
                out[i] = value
            for k in range(p - 1, -1, -1):
                value = c[k] - at.shift[HALF * side + k]
                for j in range(k + 1, p):
                    value -= at.mix[HALF * k + j] * c[j]
                c[k] = value / at.mix[HALF * k + k]
            if shape.interval == 0 and before > 0:
                for k in range(before // 2):
                    value = at.known[HALF * side + k]
                    for j in range(p):
                        value += at.cross[HALF * k + j] * c[j]
                    old[k] = value
                for k in range(before // 2):
                    c[k] = old[k]
        if node == last:
            return
        node += step


@kernel
def superpose(I, M, slots):
    """Solve all slots. Returns the status."""
    own = own_header(I)
    sides = own.right_sides
    meeting = own.meeting
    if meeting <= 0 or meeting >= slots:
        meeting = slots - 1
    status = sweep(I, M, 0, meeting, 1)
    if status != OK:
        return status
    if meeting < slots - 1:
        status = sweep(I, M, slots - 1, meeting, -1)
        if status != OK:
            return status
    status = recombine(I, M, meeting)
    if status != OK:
        return status
    scratch = superposition_work(I, M, 0)
    z = scratch.coefficients
    shape = shape_of(I, M, meeting)
    p_left = shape.left // 2
    p_right = shape.right // 2
    if meeting < slots - 1:
        for side in range(sides):
            for k in range(p_right):
                z[WIDTH * side + k] = scratch.solution[WIDTH * side + p_left + k]
        return_sweep(I, M, meeting, slots - 2, 1)
    for side in range(sides):
        for k in range(p_left):
            z[WIDTH * side + k] = scratch.solution[WIDTH * side + k]
    return_sweep(I, M, meeting - 1, 0, -1)
    return OK
