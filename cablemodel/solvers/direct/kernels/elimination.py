"""The chain of slots solved by elimination: Gauss with row pivoting from the vessel outwards.

Half of a node's equations come from its left. They are carried along: with the rows of the next
slot they form a matrix from which the node's own unknowns are eliminated, and what remains is the
half that the next node gets. The same rule crosses joints between different numbers of unknowns.
"""

from cablemodel.solvers.shared.compile import view
from cablemodel.solvers.shared.layout import OK, SINGULAR

from .access import eliminated_of, elimination_work, own_header, shape_of, sides_of
from .compile import kernel
from .layout import BLOCK, WIDTH
from .layout import ELIMINATED as COLUMNS


@kernel
def eliminate(I, M, slots):
    """Solve all slots. Returns the status."""
    own = own_header(I)
    sides = own.right_sides
    work = elimination_work(I, M, 0).rows
    pending = 0
    for slot in range(slots):
        shape = shape_of(I, M, slot)
        rows = shape.rows
        left = shape.left
        right = shape.right
        total = left + right + sides
        # The pending rows stand at the top of the work matrix, their unknowns are `left`.
        for i in range(pending):
            for j in range(sides):
                work[COLUMNS * i + left + right + j] = work[COLUMNS * i + left + j]
            for j in range(right):
                work[COLUMNS * i + left + j] = 0.0
        for i in range(rows):
            row = view(work, COLUMNS * (pending + i), COLUMNS)
            for j in range(left):
                row[j] = M[own.left + BLOCK * slot + WIDTH * i + j]
            for j in range(right):
                row[left + j] = M[own.right + BLOCK * slot + WIDTH * i + j]
            for j in range(sides):
                row[left + right + j] = sides_of(I, M, slot).sides[WIDTH * j + i]
        rows += pending
        for k in range(left):
            pivot = k
            largest = abs(work[COLUMNS * k + k])
            for i in range(k + 1, rows):
                size = abs(work[COLUMNS * i + k])
                if size > largest:
                    largest = size
                    pivot = i
            if not largest > 1e-300:
                return SINGULAR
            if pivot != k:
                for j in range(k, total):
                    kept = work[COLUMNS * k + j]
                    work[COLUMNS * k + j] = work[COLUMNS * pivot + j]
                    work[COLUMNS * pivot + j] = kept
            inverse = 1.0 / work[COLUMNS * k + k]
            for i in range(k + 1, rows):
                factor = work[COLUMNS * i + k] * inverse
                if factor != 0.0:
                    for j in range(k + 1, total):
                        work[COLUMNS * i + j] -= factor * work[COLUMNS * k + j]
        keep = eliminated_of(I, M, slot).rows
        for i in range(left):
            for j in range(i, total):
                keep[COLUMNS * i + j] = work[COLUMNS * i + j]
        pending = rows - left
        for i in range(pending):
            for j in range(right + sides):
                work[COLUMNS * i + j] = work[COLUMNS * (left + i) + left + j]
    # The way back: slot j gives the unknowns of node j - 1.
    for slot in range(slots - 1, 0, -1):
        shape = shape_of(I, M, slot)
        left = shape.left
        right = shape.right
        keep = eliminated_of(I, M, slot).rows
        for side in range(sides):
            here = view(M, own.delta + WIDTH * (2 * (slot - 1) + side), WIDTH)
            beyond = view(M, own.delta + WIDTH * (2 * slot + side), WIDTH)
            for i in range(left - 1, -1, -1):
                value = keep[COLUMNS * i + left + right + side]
                for j in range(right):
                    value -= keep[COLUMNS * i + left + j] * beyond[j]
                for j in range(i + 1, left):
                    value -= keep[COLUMNS * i + j] * here[j]
                here[i] = value / keep[COLUMNS * i + i]
    return OK
