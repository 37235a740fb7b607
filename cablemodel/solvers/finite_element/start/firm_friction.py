"""A static start of an anchored cable in which friction takes hold as soon as its tension asks.

Friction is a bristle of a length u: along what lies, a tension creeps on over sqrt(EA u / (mu w)),
where Coulomb's friction ends it. So the force sqrt(EA u mu w) may be wrong. Cable that hardly
stretches feels that at its anchor, though nothing has moved by more than u. A start has no steps
to take: it is found on bristles that are as short as tensions ask, and goes on with its own, drawn
by the same shares.

Bristles get shorter bit by bit, and what slips is drawn after at each length. Drawn on the shortest
alone, what slips where the cable lands would lose friction in the first step: its nodes are pressed
less than the elements between them.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.start import laid_loads, search
from cablemodel.solvers.finite_element.start.frame import earth, local
from cablemodel.solvers.finite_element.start.laid_start import (
    gaps_above,
    law_of_contact,
    shape_and_roots,
)
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


def applies(scene: Scene) -> bool:
    """Whether a line lies to its anchor at rest, on a floor with friction."""
    floor = scene.environment.floor
    if floor is None or floor.friction == 0.0 or scene.end.kind != "anchor":
        return False
    moves = bool(np.any(scene.motion().evaluate(0.0)[1]))
    return scene.starts_at_rest and not moves and scene.rate_at_start == 0.0


def take_hold(block: Block, scene: Scene, promised: float) -> None:
    """Find the start on shorter bristles; nothing changes without an equilibrium there, nor where
    what slips loses more where the cable lands than friction takes up beyond: where all slips up to
    the anchor, no tension creeps.

    promised: what tensions may be wrong by [N].
    """
    bristle = float(block.scalars.bristle)
    short = promised**2 / _pull_of_a_metre(scene)
    if short >= bristle:
        return
    before, tension = block.image.copy(), block.array(Header.tension, int(block.header.nodes), 2)
    crept = tension[:, 0].copy()
    try:
        status = _on_shorter(block, scene, short)
    except search.OutOfTimeError:
        status = int(at.STATICS_FAILED)
    taken_up = crept - tension[:, 0]
    if status != at.OK or taken_up.max() <= -taken_up.min():
        block.image[:] = before


def _on_shorter(block: Block, scene: Scene, short: float) -> int:
    """Equilibrium on bristles that get as short as that [m], then on the block's own; a status."""
    state, still = block.scalars, np.zeros(3)
    bristle = float(state.bristle)
    for length in np.geomspace(bristle, short, 2 + int(math.log(bristle / short, SHORTER_AT_ONCE))):
        state.bristle = length
        for _ in range(DRAWINGS):
            status = search.equilibrium(block, still)
            if status != at.OK:
                return status
            _settle(block, scene)
    state.bristle = bristle
    shape, roots = shape_and_roots(block)
    roots[:] = shape - bristle / short * (shape - roots)
    return search.equilibrium(block, still)


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


def _settle(block: Block, scene: Scene) -> None:
    """Draw the roots after what has slipped, as steps do (kernels/floor/floor_memory.py)."""
    shape, roots = shape_and_roots(block)
    dimension = int(block.header.dimension)
    places = shape[:, :dimension]
    ways = places - roots[:, :dimension]
    for n, (x, y, _z) in enumerate(earth(block, places).tolist()):
        across = local(block, laid_loads.out_of_floor(scene, x, y), point=False)
        ways[n] -= (ways[n] @ across) / (across @ across) * across
    presses = law_of_contact(gaps_above(block, scene, places) / float(block.scalars.floor_depth))
    most = float(block.scalars.bristle) * presses
    shares = np.minimum(1.0, most / np.maximum(np.linalg.norm(ways, axis=1), 1e-300))
    roots[:] = shape
    roots[:, :dimension] -= shares[:, None] * ways
