"""A static start of an anchored cable in which friction takes hold as soon as its tension asks.

Friction is a bristle of a length u. Where Coulomb's friction ends a tension, it creeps on over
sqrt(EA u / (mu w)), and is wrong by sqrt(EA u mu w) / e at most. Cable that hardly stretches feels
that at its anchor, though nothing has moved by more than u. A start has no steps
to take: it is found on bristles that are as short as tensions ask. Steps go on with longer ones,
drawn by the same shares: what a step may be wrong by would work shorter ones loose.

Bristles get shorter bit by bit, and what slips is drawn after at each length.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.start import search
from cablemodel.solvers.finite_element.start.laid_start import shape_and_roots
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header

if TYPE_CHECKING:
    from cablemodel.scene import Scene

FloatArray = NDArray[np.float64]

FIRM = 0.1
"""Bristles of steps, at least, of those of lines that lie to no anchor: on a tenth of that, what
steps may be wrong by works friction loose."""
SHORTER_AT_ONCE = 2.0
"""By how much bristles get shorter at a time, at most; at a fourth the tension beyond what slips
is twice as wrong."""
DRAWINGS = 4
"""In which roots are drawn after what has slipped, at each length. With one of them what lies
pulls twice as much at its anchor; from then on the elements decide."""


def applies(scene: Scene) -> bool:
    """Whether a line lies to its anchor at rest, on a floor with friction."""
    floor = scene.environment.floor
    if floor is None or floor.friction == 0.0 or scene.end.kind != "anchor":
        return False
    moves = bool(np.any(scene.motion().evaluate(0.0)[1]))
    return scene.starts_at_rest and not moves and scene.rate_at_start == 0.0


def take_hold(block: Block, scene: Scene, promised: float) -> None:
    """Find the start on shorter bristles, and go on with short ones; nothing changes without an
    equilibrium there, nor where what slips loses more where the cable lands than friction takes up
    beyond: where all slips up to the anchor, no tension creeps.

    promised: what tensions may be wrong by [N].
    """
    bristle = float(block.scalars.bristle)
    of_a_metre = _pull_of_a_metre(scene)
    short = (math.e * promised) ** 2 / of_a_metre
    if short >= bristle:
        return
    before, tension = block.image.copy(), block.array(Header.tension, int(block.header.nodes), 2)
    crept = tension[:, 0].copy()
    try:
        status = _on_shorter(block, short)
        taken_up = crept - tension[:, 0]
        if status == at.OK and taken_up.max() > -taken_up.min():
            # What creeps is sqrt(promised T) then, where steps allow it.
            creeps = promised * float(np.abs(crept).max()) / of_a_metre
            status = _on_longer(block, min(bristle, max(creeps, FIRM * bristle)))
        else:
            status = int(at.STATICS_FAILED)
    except search.OutOfTimeError:
        status = int(at.STATICS_FAILED)
    if status != at.OK:
        block.image[:] = before


def _on_shorter(block: Block, short: float) -> int:
    """Equilibrium on bristles that get as short as that [m]; a status."""
    state = block.scalars
    bristle = float(state.bristle)
    for length in np.geomspace(bristle, short, 2 + int(math.log(bristle / short, SHORTER_AT_ONCE))):
        state.bristle = length
        status = _drawn(block)
        if status != at.OK:
            return status
    return int(at.OK)


def _on_longer(block: Block, bristle: float) -> int:
    """The same equilibrium on longer bristles [m], drawn by the same shares; a status."""
    shape, roots = shape_and_roots(block)
    roots[:] = shape - bristle / float(block.scalars.bristle) * (shape - roots)
    block.scalars.bristle = bristle
    return search.equilibrium(block, np.zeros(3))


def _drawn(block: Block) -> int:
    """Equilibrium whose roots are drawn after what slips; a status."""
    from cablemodel.solvers import library as entry

    for _ in range(DRAWINGS):
        status = search.equilibrium(block, np.zeros(3))
        if status != at.OK:
            return status
        entry.settle(block.ints, block.reals)
    return int(at.OK)


def _pull_of_a_metre(scene: Scene) -> float:
    """Square of the force that bristles of a metre let through, EA mu w, the largest of the line's
    cables [N2/m]."""
    floor = scene.environment.floor
    assert floor is not None
    kinds = [scene.cable_types[cable.type] for cable in scene.cables]
    return max(
        1e-300,
        *(floor.friction * kind.submerged_weight / kind.strain_coefficients[0] for kind in kinds),
    )
