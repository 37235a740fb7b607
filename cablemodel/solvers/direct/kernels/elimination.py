"""The chain of slots solved by elimination: Gauss with row pivoting from the vessel outwards.

Half of a node's equations come from its left. They are carried along: with the rows of the next
slot they form a matrix from which the node's own unknowns are eliminated, and what remains is the
half that the next node gets. The same rule crosses joints between different numbers of unknowns.
"""

from cablemodel.solvers.shared.layout import OK, SINGULAR

from .access import own_header
from .compile import kernel
from .layout import (
    BLOCK,
    RHS_WORDS,
    SHAPE_WORDS,
    SWEEP_WORDS,
    WIDTH,
)

COLUMNS = 2 * WIDTH + 2


@kernel
def eliminate(I, M, slots, store):
    """Solve all slots; store: word offset of slots x SWEEP_WORDS. Returns the status."""
    own = own_header(I)
    sides = own.right_sides
    work = own.work
    pending = 0
    for slot in range(slots):
        shape = own.shape + SHAPE_WORDS * slot
        rows = I[shape]
        left = I[shape + 1]
        right = I[shape + 2]
        total = left + right + sides
        # The pending rows stand at the top of the work matrix, their unknowns are `left`.
        for i in range(pending):
            for j in range(sides):
                M[work + COLUMNS * i + left + right + j] = M[work + COLUMNS * i + left + j]
            for j in range(right):
                M[work + COLUMNS * i + left + j] = 0.0
        for i in range(rows):
            row = work + COLUMNS * (pending + i)
            for j in range(left):
                M[row + j] = M[own.left + BLOCK * slot + WIDTH * i + j]
            for j in range(right):
                M[row + left + j] = M[own.right + BLOCK * slot + WIDTH * i + j]
            for j in range(sides):
                M[row + left + right + j] = M[own.rhs + RHS_WORDS * slot + WIDTH * j + i]
        rows += pending
        for k in range(left):
            pivot = k
            largest = abs(M[work + COLUMNS * k + k])
            for i in range(k + 1, rows):
                size = abs(M[work + COLUMNS * i + k])
                if size > largest:
                    largest = size
                    pivot = i
            if not largest > 1e-300:
                return SINGULAR
            if pivot != k:
                for j in range(k, total):
                    kept = M[work + COLUMNS * k + j]
                    M[work + COLUMNS * k + j] = M[work + COLUMNS * pivot + j]
                    M[work + COLUMNS * pivot + j] = kept
            inverse = 1.0 / M[work + COLUMNS * k + k]
            for i in range(k + 1, rows):
                factor = M[work + COLUMNS * i + k] * inverse
                if factor != 0.0:
                    for j in range(k + 1, total):
                        M[work + COLUMNS * i + j] -= factor * M[work + COLUMNS * k + j]
        keep = store + SWEEP_WORDS * slot
        for i in range(left):
            for j in range(i, total):
                M[keep + COLUMNS * i + j] = M[work + COLUMNS * i + j]
        pending = rows - left
        for i in range(pending):
            for j in range(right + sides):
                M[work + COLUMNS * i + j] = M[work + COLUMNS * (left + i) + left + j]
    # The way back: slot j gives the unknowns of node j - 1.
    for slot in range(slots - 1, 0, -1):
        shape = own.shape + SHAPE_WORDS * slot
        left = I[shape + 1]
        right = I[shape + 2]
        keep = store + SWEEP_WORDS * slot
        here = own.delta + 2 * WIDTH * (slot - 1)
        beyond = own.delta + 2 * WIDTH * slot
        for side in range(sides):
            for i in range(left - 1, -1, -1):
                value = M[keep + COLUMNS * i + left + right + side]
                for j in range(right):
                    value -= M[keep + COLUMNS * i + left + j] * M[beyond + WIDTH * side + j]
                for j in range(i + 1, left):
                    value -= M[keep + COLUMNS * i + j] * M[here + WIDTH * side + j]
                M[here + WIDTH * side + i] = value / M[keep + COLUMNS * i + i]
    return OK
