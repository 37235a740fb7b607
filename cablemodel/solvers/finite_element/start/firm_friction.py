"""A static start in which friction takes hold of what lies to an anchor as soon as tension asks:
kernels/start/firm_friction.py."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.start import search
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header

if TYPE_CHECKING:
    from cablemodel.scene import Scene


def applies(scene: Scene) -> bool:
    """Whether a line lies to its anchor at rest, on a floor with friction."""
    floor = scene.environment.floor
    if floor is None or floor.friction == 0.0 or scene.end.kind != "anchor":
        return False
    moves = bool(np.any(scene.motion().evaluate(0.0)[1]))
    return scene.starts_at_rest and not moves and scene.rate_at_start == 0.0


def take_hold(block: Block) -> bool:
    """Find the start that friction holds, from one that was found; whether it does. Else, as where
    bristles are short enough, nothing changes."""
    from cablemodel.solvers import library as entry

    hold = np.zeros(at.FIRM_HOLD_WORDS)
    if entry.begin_to_hold(block.ints, block.reals, hold) == at.NOTHING:
        return False
    before = block.image.copy()
    tensions = block.array(Header.tension, 2 * int(block.header.nodes)).copy()
    at_rest = np.zeros(int(block.header.dimension))
    status: int = at.OK
    try:
        while True:
            status = entry.go_on_holding(block.ints, block.reals, status, hold, tensions)
            if status != at.SEARCH:
                break
            status = search.equilibrium(block, at_rest)
    except search.OutOfTimeError:
        status = at.STATICS_FAILED
    if status != at.OK:
        block.image[:] = before
    return status == at.OK
