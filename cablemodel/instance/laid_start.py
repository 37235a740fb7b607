"""A static start of cable that friction holds on the sea floor where it was laid.

A line with a free end comes to rest without friction where the floor is level and the water still:
nothing pushes what lies, and where it meets the hanging part no force is left that depends on how
the start was found. On a slope, or in a current, the same line would slide away, and fold. There it
starts as it was laid, straight behind the vessel, and friction holds it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from cablemodel import sea_floor
from cablemodel.block import Block
from cablemodel.kernels import layout as at

if TYPE_CHECKING:
    from cablemodel.scene import Scene

PASSES = 12
"""Of friction that lets go and takes hold anew, at most."""
CALM = 1e-3
"""What a pass must take of the largest compression to be worth it, in units of the largest
tension."""


def applies(scene: Scene) -> bool:
    """Whether friction holds the line's free end at the start, and something pushes what lies."""
    floor = scene.environment.floor
    if floor is None or floor.friction == 0.0:
        return False
    if scene.initial.kind != "static" or scene.end.kind != "free":
        return False
    current = scene.environment.current
    begins = 0 if current is None else max(0, int(np.searchsorted(current.t, 0.0, "right")) - 1)
    flows = current is not None and bool(np.any(current.velocity[begins]))
    return flows or floor.z is None or any(floor.slope)


def lie_still(block: Block, solve: Callable[[], int]) -> int:
    """Bring a block to equilibrium with what lies held by friction; a status.

    The first shape has not quite the length of the cable where it turns on to the floor, and
    friction would keep the compression of that: it lets go and takes hold anew where the cable is
    by then, for as long as that takes compression away. In each pass the cable gives way by the
    length of a bristle at most, so that it goes on lying where it was laid.

    Args:
        solve: equilibrium of the block as it is, a status.
    """
    sea_floor.rest_where_it_is(block)
    status = solve()
    if status != at.OK:
        return status
    tensions = block.array(at.O_TENSION, int(block.ints[at.I_NODES]), 2)
    for _ in range(PASSES):
        kept, lowest = block.image.copy(), float(np.min(tensions[1:, 0]))
        sea_floor.rest_where_it_is(block)
        gain = CALM * float(np.max(np.abs(tensions)))
        if solve() != at.OK or not np.min(tensions[1:, 0]) > lowest + gain:
            block.image[:] = kept
            break
    return at.OK
