"""All or nothing: what a step may change is kept until the step is done.

The image is copied in parts, and of each as much as is in use, not its capacity. Header, scalars,
the live piece of motion and the state of what is awake change in every step. The factorisation,
two thirds of the image, is kept only when it is about to be replaced, which most of the steps of a
caller at 100 Hz do not do, and cable that sleeps only when it is moved in memory or wakes. The
tables between them change in no step, but for the largest tensions of a system's cables.
"""

from cablemodel.solvers.shared.access import header, header_at
from cablemodel.solvers.shared.compile import copy_words, kernel
from cablemodel.solvers.shared.layout import (
    CABLE_WORDS,
    EDGE_WORDS,
    PIECE_WORDS,
)


@kernel
def copy_part(I, to, source, array, words, first, count):
    """Copy rows first ... first + count - 1, of `words` each, of the array at a word of the image.

    to, source: 0 for the image itself, the backup's offset for the backup.
    """
    start = array + words * first
    copy_words(I, to + start, source + start, words * count)


@kernel
def copy_nodes(I, to, source, first, count):
    """Copy the state of nodes, and of the edges above them."""
    head = header(I)
    size = 2 * head.dimension
    copy_part(I, to, source, head.parent, 1, first, count)
    copy_part(I, to, source, head.joint, 1, first, count)
    copy_part(I, to, source, head.edges, EDGE_WORDS, first, count)
    copy_part(I, to, source, head.position, size, first, count)
    copy_part(I, to, source, head.velocity, size, first, count)
    copy_part(I, to, source, head.acceleration, size, first, count)
    copy_part(I, to, source, head.tension, 2, first, count)
    copy_part(I, to, source, head.tension_rate, 2, first, count)
    copy_part(I, to, source, head.rest, size, first, count)


@kernel
def copy_awake(I, to, source):
    """Copy the state of what is awake, bodies and constraints."""
    head = header(I)
    awake = head.nodes - head.asleep
    copy_nodes(I, to, source, 0, awake)
    copy_part(I, to, source, head.bodies, 1, 0, head.position - head.bodies)
    if head.has_history != 0:
        copy_part(I, to, source, head.history, 4 * head.dimension, 0, awake)
    if head.parts != 0:
        copy_part(I, to, source, head.cables, CABLE_WORDS, 0, head.cable_count)


@kernel
def copy_matrix(I, to, source, nodes, dimension):
    """Copy the factorisation of a line of so many nodes."""
    head = header(I)
    area = 4 * dimension * dimension
    copy_part(I, to, source, head.diagonal, area, 0, nodes)
    copy_part(I, to, source, head.upper, area, 0, nodes)
    copy_part(I, to, source, head.lower, area, 0, nodes)
    copy_part(I, to, source, head.gradient, 8 * dimension, 0, nodes)
    copy_part(I, to, source, head.compliance, 3, 0, nodes)
    if head.closure_count != 0:
        count = 3 * head.closure_count
        copy_part(I, to, source, head.closure_work, 1, 0, count * (6 * nodes + count))


@kernel
def keep_state(I):
    """Before a step, of the whole line: keep all that it changes but for matrix and sleepers."""
    head = header(I)
    backup = head.backup
    copy_words(I, backup, 0, head.pieces + PIECE_WORDS)
    copy_awake(I, backup, 0)
    head.keep_matrix = 1
    head.keep_sleepers = head.asleep


@kernel
def keep_matrix(I):
    """Before the matrix is replaced: keep it, once a step."""
    head = header(I)
    if head.keep_matrix != 0:
        backup = head.backup
        kept = header_at(I, backup)
        awake = kept.nodes - kept.asleep
        copy_matrix(I, backup, 0, awake, kept.dimension)
        head.keep_matrix = 0


@kernel
def keep_sleepers(I):
    """Before cable that sleeps is moved or wakes: keep its state, once a step."""
    head = header(I)
    asleep = head.keep_sleepers
    if asleep != 0:
        backup = head.backup
        copy_nodes(I, backup, 0, header_at(I, backup).nodes - asleep, asleep)
        head.keep_sleepers = 0


@kernel
def clear_part(I, array, used, room):
    """Zero what is beyond the words in use of an array."""
    for word in range(array + used, array + room):
        I[word] = 0


@kernel
def clear_unused(I):
    """Zero what nodes would use that there are not: a failed step may have made some."""
    head = header(I)
    nodes = head.nodes
    room = head.capacity
    size = 2 * head.dimension
    area = size * size
    clear_part(I, head.parent, nodes, room)
    clear_part(I, head.joint, nodes, room)
    clear_part(I, head.edges, EDGE_WORDS * nodes, EDGE_WORDS * room)
    clear_part(I, head.position, size * nodes, 6 * room)
    clear_part(I, head.velocity, size * nodes, 6 * room)
    clear_part(I, head.acceleration, size * nodes, 6 * room)
    clear_part(I, head.tension, 2 * nodes, 2 * room)
    clear_part(I, head.tension_rate, 2 * nodes, 2 * room)
    clear_part(I, head.rest, size * nodes, 6 * room)
    clear_part(I, head.history, 2 * size * nodes, 12 * room)
    clear_part(I, head.diagonal, area * nodes, 36 * room)
    clear_part(I, head.upper, area * nodes, 36 * room)
    clear_part(I, head.lower, area * nodes, 36 * room)
    clear_part(I, head.gradient, 4 * size * nodes, 24 * room)
    clear_part(I, head.compliance, 3 * nodes, 3 * room)


@kernel
def give_back(I):
    """After a step that failed: the image as it was, of all that is in use."""
    head = header(I)
    made = head.nodes + head.left_out
    backup = head.backup
    matrix_stands = head.keep_matrix
    sleepers_stand = head.keep_sleepers
    copy_words(I, 0, backup, head.pieces + PIECE_WORDS)
    copy_awake(I, 0, backup)
    awake = head.nodes - head.asleep
    if matrix_stands == 0:
        copy_matrix(I, 0, backup, awake, head.dimension)
    if head.asleep != 0 and sleepers_stand == 0:
        copy_nodes(I, 0, backup, awake, head.asleep)
    if made > head.nodes:
        clear_unused(I)
