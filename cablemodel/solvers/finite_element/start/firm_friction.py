"""A static start of an anchored cable in which friction takes hold as soon as its tension asks.

Friction is a bristle of a length u. Where Coulomb's friction ends a tension, it creeps on over
sqrt(EA u / (mu w)), and is wrong by sqrt(EA u mu w) / e at most. Cable that hardly stretches feels
that at its anchor, though nothing has moved by more than u. A start has no steps to take: it is
found on bristles that are as short as tensions ask. Steps go on with longer ones, drawn by the same
shares: what a step may be wrong by would work shorter ones loose.

Bristles get shorter bit by bit, and what slips is drawn after at each length.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.start import search
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header

if TYPE_CHECKING:
    from cablemodel.scene import Scene

FloatArray = NDArray[np.float64]

SHORTER_AT_ONCE = 2.0
"""By how much bristles get shorter at a time, at most; at a fourth the tension beyond what slips
is twice as wrong."""
DRAWINGS = 4
"""In which roots are drawn after what has slipped, at each length. With one of them what lies
pulls twice as much at its anchor; from then on the elements decide."""


@dataclass(frozen=True)
class Lengths:
    """Of bristles [m]."""

    own: float
    """On which the start was found."""
    short: float
    """As tensions ask."""
    for_steps: float
    """That steps go on with."""


def applies(scene: Scene) -> bool:
    """Whether a line lies to its anchor at rest, on a floor with friction."""
    floor = scene.environment.floor
    if floor is None or floor.friction == 0.0 or scene.end.kind != "anchor":
        return False
    moves = bool(np.any(scene.motion().evaluate(0.0)[1]))
    return scene.starts_at_rest and not moves and scene.rate_at_start == 0.0


def take_hold(block: Block, lengths: Lengths) -> bool:
    """Find the start on shorter bristles, and go on with short ones; whether it was found. Nothing
    changes without an equilibrium there, nor where what slips loses more where the cable lands than
    friction takes up beyond: where all slips up to the anchor, no tension creeps.
    """
    before, tension = block.image.copy(), block.array(Header.tension, int(block.header.nodes), 2)
    crept = tension[:, 0].copy()
    try:
        status = _on_shorter(block, lengths)
        taken_up = crept - tension[:, 0]
        if status == at.OK and taken_up.max() > -taken_up.min():
            status = _on_longer(block, lengths.for_steps)
        else:
            status = int(at.STATICS_FAILED)
    except search.OutOfTimeError:
        status = int(at.STATICS_FAILED)
    if status != at.OK:
        block.image[:] = before
    return status == at.OK


def lengths_of(block: Block) -> Lengths | None:
    """Those of lines that lie to anchors, None where their own bristles are short enough."""
    from cablemodel.solvers import library as entry

    lengths = np.empty(3)
    if entry.lengths_of_bristles(block.ints, block.reals, lengths) == at.NOTHING:
        return None
    return Lengths(*lengths.tolist())


def _on_shorter(block: Block, lengths: Lengths) -> int:
    """Equilibrium on bristles that get as short as is asked; a status."""
    state = block.scalars
    length = lengths.own
    while True:
        state.bristle = length
        status = _drawn(block)
        if status != at.OK or length == lengths.short:
            return status
        length = max(lengths.short, length / SHORTER_AT_ONCE)


def _on_longer(block: Block, bristle: float) -> int:
    """The same equilibrium on longer bristles [m], drawn by the same shares; a status."""
    from cablemodel.solvers import library as entry

    entry.draw_alike(block.ints, block.reals, bristle)
    return search.equilibrium(block, np.zeros(int(block.header.dimension)))


def _drawn(block: Block) -> int:
    """Equilibrium whose roots are drawn after what slips; a status."""
    from cablemodel.solvers import library as entry

    for _ in range(DRAWINGS):
        status = search.equilibrium(block, np.zeros(int(block.header.dimension)))
        if status != at.OK:
            return status
        entry.settle(block.ints, block.reals)
    return int(at.OK)
