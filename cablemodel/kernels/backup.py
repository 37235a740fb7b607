"""All or nothing: what a step may change is kept until the step is done.

The image is copied in parts. Header, scalars, the live piece of motion and all from the nodes'
parents to the factorisation change in every step. The factorisation, two thirds of the image, is
kept only when it is about to be replaced, which most of the steps of a caller at 100 Hz do not do.
The tables between them change in no step.
"""

from .compile import copy_words, kernel
from .layout import (
    I_IMAGE_WORDS,
    I_KEEP_MATRIX,
    O_BACKUP,
    O_DIAGONAL,
    O_PARENT,
    O_PIECES,
    PIECE_WORDS,
)


@kernel
def keep_state(I):
    """Before a step: keep all that it may change but the matrix."""
    backup = I[O_BACKUP]
    copy_words(I, backup, 0, I[O_PIECES] + PIECE_WORDS)
    copy_words(I, backup + I[O_PARENT], I[O_PARENT], I[O_DIAGONAL] - I[O_PARENT])
    I[I_KEEP_MATRIX] = 1


@kernel
def keep_matrix(I):
    """Before the matrix is replaced: keep it, once a step."""
    if I[I_KEEP_MATRIX] != 0:
        start = I[O_DIAGONAL]
        copy_words(I, I[O_BACKUP] + start, start, I[I_IMAGE_WORDS] - start)
        I[I_KEEP_MATRIX] = 0


@kernel
def give_back(I):
    """After a step that failed: the image as it was."""
    backup = I[O_BACKUP]
    if I[I_KEEP_MATRIX] == 0:
        start = I[O_DIAGONAL]
        copy_words(I, start, backup + start, I[I_IMAGE_WORDS] - start)
    copy_words(I, I[O_PARENT], backup + I[O_PARENT], I[O_DIAGONAL] - I[O_PARENT])
    copy_words(I, 0, backup, I[O_PIECES] + PIECE_WORDS)
