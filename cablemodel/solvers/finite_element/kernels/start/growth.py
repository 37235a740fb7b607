"""Whether a start is one to stay at: how many small motions about it grow."""

from cablemodel.solvers.finite_element.kernels.line.inertia import count_growing
from cablemodel.solvers.finite_element.kernels.line.swinging import count_swinging, work_words
from cablemodel.solvers.shared.access import header, scalars
from cablemodel.solvers.shared.compile import copy_words, kernel


@kernel
def leaving_words(I):
    """Words that `count_leaving` needs."""
    return 1 if header(I).parts == 0 else work_words(I)


@kernel
def count_leaving(I, M, rate, work):
    """Of small motions about a state how many grow faster than a rate [1/s]: of a line alone those
    that do not swing as they grow, of a system all, but without foils only where some do not. -1:
    it cannot be told.

    The block is used up. work: room for `leaving_words`, of which those of a system become the
    motions that are coupled (`count_swinging`).
    """
    head = header(I)
    if head.parts == 0:
        return count_growing(I, M, rate)
    scalars(M).bristles_damped = 0.0  # that is for steps
    copy_words(I, head.backup, 0, head.image_words)
    found = count_growing(I, M, rate)
    if found == 0 and head.foil_count == 0:
        return 0
    copy_words(I, 0, head.backup, head.image_words)
    return count_swinging(I, M, rate, work)
