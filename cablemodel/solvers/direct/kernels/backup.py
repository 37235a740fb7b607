"""All or nothing: what a call of `step`, and what one implicit step, gives back when it fails."""

from cablemodel.solvers.shared.access import header
from cablemodel.solvers.shared.compile import copy_words
from cablemodel.solvers.shared.layout import PIECE_WORDS

from .access import own_header, own_scalars, rigid_body_of
from .assembly import set_strains
from .compile import kernel
from .geometry import last_node, set_places
from .layout import (
    BODY_STATES,
    WIDTH,
)


@kernel
def copy_changing(I, target, source):
    """What a call of `step` may change of an image: header, scalars and the live piece of motion,
    sections, bodies and nodes. The tables of the scene change in no step."""
    own = own_header(I)
    head = header(I)
    copy_words(I, target, source, head.pieces + PIECE_WORDS)
    for part in range(3):
        if part == 0:
            first = own.sections
            after = own.materials
        elif part == 1:
            first = own.bodies
            after = own.drum
        else:
            first = own.unknowns
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
    own = own_header(I)
    run = own_scalars(M)
    count = last_node(I) + 1
    copy_words(M, own.start, own.unknowns, WIDTH * count)
    copy_words(M, own.old_length, own.length, count)
    for body in range(own.body_count):
        row = rigid_body_of(I, M, body)
        for k in range(BODY_STATES):
            row.start[k] = row.state[k]
    run.start[0] = run.flow_end
    run.start[1] = run.reaction


@kernel
def give_back_start(I, M):
    """After an implicit step that failed; the vessel has been set to the step's start.

    Strains and places follow from the unknowns: what the iterate left in them would be taken for
    the past by the next attempt.
    """
    own = own_header(I)
    run = own_scalars(M)
    count = last_node(I) + 1
    copy_words(M, own.unknowns, own.start, WIDTH * count)
    copy_words(M, own.length, own.old_length, count)
    for body in range(own.body_count):
        row = rigid_body_of(I, M, body)
        for k in range(BODY_STATES):
            row.state[k] = row.start[k]
    run.flow_end = run.start[0]
    run.reaction = run.start[1]
    set_strains(I, M)
    set_places(I, M)
