"""All or nothing: what a step may change is kept until the step is done.

The image is copied in parts, and of each as much as is in use, not its capacity. Header, scalars,
the live piece of motion and the state of what is awake change in every step. The factorisation,
two thirds of the image, is kept only when it is about to be replaced, which most of the steps of a
caller at 100 Hz do not do, and cable that sleeps only when it is moved in memory or wakes. The
tables between them change in no step.
"""

from .compile import copy_words, kernel
from .layout import (
    EDGE_WORDS,
    I_ASLEEP,
    I_CAPACITY,
    I_DIMENSION,
    I_HISTORY,
    I_KEEP_MATRIX,
    I_KEEP_SLEEPERS,
    I_LEFT_OUT,
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
def copy_part(I, to, source, place, words, first, count):
    """Copy rows first ... first + count - 1, of `words` each, of an array by its header word.

    to, source: 0 for the image itself, the backup's offset for the backup.
    """
    start = I[place] + words * first
    copy_words(I, to + start, source + start, words * count)


@kernel
def copy_nodes(I, to, source, first, count):
    """Copy the state of nodes, and of the edges above them."""
    size = 2 * I[I_DIMENSION]
    copy_part(I, to, source, O_PARENT, 1, first, count)
    copy_part(I, to, source, O_JOINT, 1, first, count)
    copy_part(I, to, source, O_EDGE, EDGE_WORDS, first, count)
    copy_part(I, to, source, O_POSITION, size, first, count)
    copy_part(I, to, source, O_VELOCITY, size, first, count)
    copy_part(I, to, source, O_ACCELERATION, size, first, count)
    copy_part(I, to, source, O_TENSION, 2, first, count)
    copy_part(I, to, source, O_TENSION_RATE, 2, first, count)
    copy_part(I, to, source, O_REST, 3, first, count)


@kernel
def copy_awake(I, to, source):
    """Copy the state of what is awake, bodies and constraints."""
    awake = I[I_NODES] - I[I_ASLEEP]
    copy_nodes(I, to, source, 0, awake)
    copy_part(I, to, source, O_BODY, 1, 0, I[O_POSITION] - I[O_BODY])
    if I[I_HISTORY] != 0:
        copy_part(I, to, source, O_HISTORY, 4 * I[I_DIMENSION], 0, awake)


@kernel
def copy_matrix(I, to, source, nodes, dimension):
    """Copy the factorisation of a line of so many nodes."""
    area = 4 * dimension * dimension
    copy_part(I, to, source, O_DIAGONAL, area, 0, nodes)
    copy_part(I, to, source, O_UPPER, area, 0, nodes)
    copy_part(I, to, source, O_LOWER, area, 0, nodes)
    copy_part(I, to, source, O_GRADIENT, 8 * dimension, 0, nodes)
    copy_part(I, to, source, O_COMPLIANCE, 3, 0, nodes)


@kernel
def keep_state(I):
    """Before a step, of the whole line: keep all that it changes but for matrix and sleepers."""
    backup = I[O_BACKUP]
    copy_words(I, backup, 0, I[O_PIECES] + PIECE_WORDS)
    copy_awake(I, backup, 0)
    I[I_KEEP_MATRIX] = 1
    I[I_KEEP_SLEEPERS] = I[I_ASLEEP]


@kernel
def keep_matrix(I):
    """Before the matrix is replaced: keep it, once a step."""
    if I[I_KEEP_MATRIX] != 0:
        backup = I[O_BACKUP]
        awake = I[backup + I_NODES] - I[backup + I_ASLEEP]
        copy_matrix(I, backup, 0, awake, I[backup + I_DIMENSION])
        I[I_KEEP_MATRIX] = 0


@kernel
def keep_sleepers(I):
    """Before cable that sleeps is moved or wakes: keep its state, once a step."""
    asleep = I[I_KEEP_SLEEPERS]
    if asleep != 0:
        backup = I[O_BACKUP]
        copy_nodes(I, backup, 0, I[backup + I_NODES] - asleep, asleep)
        I[I_KEEP_SLEEPERS] = 0


@kernel
def clear_part(I, place, used, room):
    """Zero what is beyond the words in use of an array."""
    for word in range(I[place] + used, I[place] + room):
        I[word] = 0


@kernel
def clear_unused(I):
    """Zero what nodes would use that there are not: a failed step may have made some."""
    nodes = I[I_NODES]
    room = I[I_CAPACITY]
    size = 2 * I[I_DIMENSION]
    area = size * size
    clear_part(I, O_PARENT, nodes, room)
    clear_part(I, O_JOINT, nodes, room)
    clear_part(I, O_EDGE, EDGE_WORDS * nodes, EDGE_WORDS * room)
    clear_part(I, O_POSITION, size * nodes, 6 * room)
    clear_part(I, O_VELOCITY, size * nodes, 6 * room)
    clear_part(I, O_ACCELERATION, size * nodes, 6 * room)
    clear_part(I, O_TENSION, 2 * nodes, 2 * room)
    clear_part(I, O_TENSION_RATE, 2 * nodes, 2 * room)
    clear_part(I, O_REST, 3 * nodes, 3 * room)
    clear_part(I, O_HISTORY, 2 * size * nodes, 12 * room)
    clear_part(I, O_DIAGONAL, area * nodes, 36 * room)
    clear_part(I, O_UPPER, area * nodes, 36 * room)
    clear_part(I, O_LOWER, area * nodes, 36 * room)
    clear_part(I, O_GRADIENT, 4 * size * nodes, 24 * room)
    clear_part(I, O_COMPLIANCE, 3 * nodes, 3 * room)


@kernel
def give_back(I):
    """After a step that failed: the image as it was, of all that is in use."""
    made = I[I_NODES] + I[I_LEFT_OUT]
    backup = I[O_BACKUP]
    matrix_stands = I[I_KEEP_MATRIX]
    sleepers_stand = I[I_KEEP_SLEEPERS]
    copy_words(I, 0, backup, I[O_PIECES] + PIECE_WORDS)
    copy_awake(I, 0, backup)
    awake = I[I_NODES] - I[I_ASLEEP]
    if matrix_stands == 0:
        copy_matrix(I, 0, backup, awake, I[I_DIMENSION])
    if I[I_ASLEEP] != 0 and sleepers_stand == 0:
        copy_nodes(I, 0, backup, awake, I[I_ASLEEP])
    if made > I[I_NODES]:
        clear_unused(I)
