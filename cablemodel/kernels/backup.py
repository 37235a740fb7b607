"""All or nothing: what a step may change is kept until the step is done.

The image is copied in parts, and of each as much as is in use, not its capacity. Header, scalars,
the live piece of motion and the state change in every step. The factorisation, two thirds of the
image, is kept only when it is about to be replaced, which most of the steps of a caller at 100 Hz
do not do. The tables between them change in no step.
"""

from .compile import copy_words, kernel
from .layout import (
    EDGE_WORDS,
    I_DIMENSION,
    I_FACTORED,
    I_HISTORY,
    I_KEEP_MATRIX,
    I_NODES,
    O_ACCELERATION,
    O_BACKUP,
    O_BODY,
    O_COMPLIANCE,
    O_DIAGONAL,
    O_EDGE,
    O_GRADIENT,
    O_HISTORY,
    O_JOINT,
    O_LOWER,
    O_PARENT,
    O_PIECES,
    O_POSITION,
    O_REST,
    O_TENSION,
    O_TENSION_RATE,
    O_UPPER,
    O_VELOCITY,
    PIECE_WORDS,
)


@kernel
def copy_part(I, to, source, place, words):
    """Copy the first words of an array, by its header word.

    to, source: 0 for the image itself, the backup's offset for the backup.
    """
    copy_words(I, to + I[place], source + I[place], words)


@kernel
def copy_state(I, to, source):
    """Copy the state of the nodes in use, of bodies and of constraints."""
    nodes = I[I_NODES]
    size = 2 * I[I_DIMENSION] * nodes
    copy_part(I, to, source, O_PARENT, nodes)
    copy_part(I, to, source, O_JOINT, nodes)
    copy_part(I, to, source, O_EDGE, EDGE_WORDS * nodes)
    copy_part(I, to, source, O_BODY, I[O_POSITION] - I[O_BODY])
    copy_part(I, to, source, O_POSITION, size)
    copy_part(I, to, source, O_VELOCITY, size)
    copy_part(I, to, source, O_ACCELERATION, size)
    copy_part(I, to, source, O_TENSION, 2 * nodes)
    copy_part(I, to, source, O_TENSION_RATE, 2 * nodes)
    copy_part(I, to, source, O_REST, 3 * nodes)
    if I[I_HISTORY] != 0:
        copy_part(I, to, source, O_HISTORY, 2 * size)


@kernel
def copy_matrix(I, to, source, nodes, dimension):
    """Copy the factorisation of a line of so many nodes."""
    area = 4 * dimension * dimension
    copy_part(I, to, source, O_DIAGONAL, area * nodes)
    copy_part(I, to, source, O_UPPER, area * nodes)
    copy_part(I, to, source, O_LOWER, area * nodes)
    copy_part(I, to, source, O_GRADIENT, 8 * dimension * nodes)
    copy_part(I, to, source, O_COMPLIANCE, 3 * nodes)


@kernel
def keep_state(I):
    """Before a step: keep all that it may change but the matrix."""
    backup = I[O_BACKUP]
    copy_words(I, backup, 0, I[O_PIECES] + PIECE_WORDS)
    copy_state(I, backup, 0)
    I[I_KEEP_MATRIX] = I[I_FACTORED]


@kernel
def keep_matrix(I):
    """Before the matrix is replaced: keep it, once a step."""
    if I[I_KEEP_MATRIX] != 0:
        backup = I[O_BACKUP]
        copy_matrix(I, backup, 0, I[backup + I_NODES], I[backup + I_DIMENSION])
        I[I_KEEP_MATRIX] = 0


@kernel
def give_back(I):
    """After a step that failed: the image as it was, of all that is in use."""
    backup = I[O_BACKUP]
    kept = I[I_KEEP_MATRIX]
    copy_words(I, 0, backup, I[O_PIECES] + PIECE_WORDS)
    copy_state(I, 0, backup)
    if kept == 0 and I[I_FACTORED] != 0:
        copy_matrix(I, 0, backup, I[I_NODES], I[I_DIMENSION])
