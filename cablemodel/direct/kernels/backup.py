"""All or nothing: what a call of `step`, and what one implicit step, gives back when it fails."""

from cablemodel.kernels.access import header
from cablemodel.kernels.compile import copy_words
from cablemodel.kernels.layout import PIECE_WORDS

from .assembly import set_strains
from .compile import kernel
from .geometry import last_node, set_places
from .layout import (
    B_START,
    B_STATE,
    BODY_STATES,
    BODY_WORDS,
    D_BODIES,
    O_BODY,
    O_DRUM,
    O_LENGTH,
    O_MATERIAL,
    O_OLD_LENGTH,
    O_SECTION,
    O_START,
    O_Y,
    WIDTH,
    X_FLOW_END,
    X_REACTION,
    X_START,
)


@kernel
def copy_changing(I, target, source):
    """What a call of `step` may change of an image: header, scalars and the live piece of motion,
    sections, bodies and nodes. The tables of the scene change in no step."""
    head = header(I)
    copy_words(I, target, source, head.pieces + PIECE_WORDS)
    for part in range(3):
        if part == 0:
            first = I[O_SECTION]
            after = I[O_MATERIAL]
        elif part == 1:
            first = I[O_BODY]
            after = I[O_DRUM]
        else:
            first = I[O_Y]
            after = head.image_words
        copy_words(I, target + first, source + first, after - first)


@kernel
def keep_image(I):
    """Before a call of `step`."""
    head = header(I)
    copy_changing(I, head.backup, 0)


@kernel
def give_back_image(I):
    """After a call that failed. Sizes and offsets, which say where, are the same in both."""
    head = header(I)
    copy_changing(I, 0, head.backup)


@kernel
def keep_start(I, M):
    """Before an implicit step: the nodes' unknowns, what bodies remember, lengths, the end."""
    count = last_node(I) + 1
    copy_words(M, I[O_START], I[O_Y], WIDTH * count)
    copy_words(M, I[O_OLD_LENGTH], I[O_LENGTH], count)
    for body in range(I[D_BODIES]):
        row = I[O_BODY] + BODY_WORDS * body
        for k in range(BODY_STATES):
            M[row + B_START + k] = M[row + B_STATE + k]
    M[X_START] = M[X_FLOW_END]
    M[X_START + 1] = M[X_REACTION]


@kernel
def give_back_start(I, M):
    """After an implicit step that failed; the vessel has been set to the step's start.

    Strains and places follow from the unknowns: what the iterate left in them would be taken for
    the past by the next attempt.
    """
    count = last_node(I) + 1
    copy_words(M, I[O_Y], I[O_START], WIDTH * count)
    copy_words(M, I[O_LENGTH], I[O_OLD_LENGTH], count)
    for body in range(I[D_BODIES]):
        row = I[O_BODY] + BODY_WORDS * body
        for k in range(BODY_STATES):
            M[row + B_STATE + k] = M[row + B_START + k]
    M[X_FLOW_END] = M[X_START]
    M[X_REACTION] = M[X_START + 1]
    set_strains(I, M)
    set_places(I, M)
