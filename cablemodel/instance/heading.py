"""The vertical plane in which a line at rest hangs and lies, where nothing but its past tells it.

In still water, under a hinge, a line may turn about its tow point's vertical: nothing on a level
floor without friction, and only bristles that give way on others, keep it from turning while its
shape at rest is sought. It is turned back to where the vessel left it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel import free_hanging
from cablemodel.block import Block
from cablemodel.instance.frame import earth
from cablemodel.instance.scales import pays_out, rate_at_start
from cablemodel.kernels import layout as at

if TYPE_CHECKING:
    from cablemodel.scene import Scene

FloatArray = NDArray[np.float64]


def is_free(scene: Scene) -> bool:
    """Whether nothing but what it lies on keeps a line from turning about its tow point."""
    floor, current = scene.environment.floor, scene.environment.current
    if floor is None or floor.z is None or scene.end.kind != "free":
        return False
    if scene.vessel.connection.kind == "clamped":
        return False
    if scene.environment.water_density == 0.0:
        return not pays_out(scene)
    moves = np.any(scene.motion().evaluate(0.0)[1]) or rate_at_start(scene) != 0.0
    return not moves and (current is None or not np.any(current.velocity))


def is_level(scene: Scene) -> bool:
    """Whether the floor is the same all around."""
    floor = scene.environment.floor
    return floor is not None and floor.z is not None and not any(floor.slope)


def turn_back(
    block: Block, scene: Scene, least: float, lies: NDArray[np.bool_] | None = None
) -> bool:
    """Turn the line about its tow point's vertical to the way along which it was laid.

    What lies stays on the floor. Does nothing in a plane, or where something else turns the line.

    Args:
        least: what its end has to be away from that way [m].
        lies: which nodes do, (nodes,); on a level floor it does not matter.

    Returns whether anything changed.
    """
    nodes, dimension = int(block.ints[at.I_NODES]), int(block.ints[at.I_DIMENSION])
    if dimension != 3 or not is_free(scene):
        return False
    q = block.array(at.O_POSITION, nodes, 6)
    end = q[-1, :2] - q[0, :2]
    way = free_hanging.way_of_lying(scene, scene.motion().evaluate(0.0)[0])
    angle = math.atan2(end[0] * way[1] - end[1] * way[0], float(end @ way))
    if float(np.hypot(*end)) * abs(angle) <= least:
        return False
    floor = scene.environment.floor
    assert floor is not None
    cosine, sine = math.cos(angle), math.sin(angle)
    turn = np.array([[cosine, sine], [-sine, cosine]])  # of row vectors

    def heights() -> FloatArray:
        return np.array([floor.height(x, y) for x, y, _z in earth(block, q[:, :3]).tolist()])

    before = heights()
    q[:, :2] = q[0, :2] + (q[:, :2] - q[0, :2]) @ turn
    q[:, 3:5] = q[:, 3:5] @ turn
    if lies is not None:
        q[lies, 2] += (heights() - before)[lies]
    return True
