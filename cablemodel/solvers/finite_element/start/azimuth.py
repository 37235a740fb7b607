"""The vertical plane in which a line at rest hangs and lies, where nothing but its past tells it.

On a level floor without friction, in still water, under a hinge, a line at rest may turn about its
tow point's vertical, and does while its shape at rest is sought. It is turned back to where the
vessel left it.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.start import free_hanging
from cablemodel.solvers.finite_element.start.scales import pays_out
from cablemodel.solvers.shared.layout import Header

if TYPE_CHECKING:
    from cablemodel.scene import Scene


def is_free(scene: Scene) -> bool:
    """Whether nothing keeps a line from turning about its tow point, sought without friction."""
    floor, current = scene.environment.floor, scene.environment.current
    if floor is None or floor.z is None or any(floor.slope) or scene.end.kind != "free":
        return False
    if scene.vessel.connection.kind == "clamped":
        return False
    if scene.environment.water_density == 0.0:
        return not pays_out(scene)
    moves = np.any(scene.motion().evaluate(0.0)[1]) or scene.rate_at_start != 0.0
    return not moves and (current is None or not np.any(current.velocity))


def turn_back(block: Block, scene: Scene) -> None:
    """Turn a line at rest about its tow point's vertical to the way along which it was laid.

    Does nothing in a plane, or to a line that lies that way within the tolerance.
    """
    nodes, dimension = int(block.header.nodes), int(block.header.dimension)
    if dimension != 3:
        return
    q = block.array(Header.position, nodes, 6)
    end = q[-1, :2] - q[0, :2]
    way = free_hanging.way_of_lying(scene, scene.motion().evaluate(0.0)[0])
    angle = math.atan2(end[0] * way[1] - end[1] * way[0], float(end @ way))
    away = float(np.hypot(*end)) * abs(angle)
    if away <= scene.solver.tolerance * scene.line_length:
        return
    cosine, sine = math.cos(angle), math.sin(angle)
    turn = np.array([[cosine, sine], [-sine, cosine]])  # of row vectors
    q[:, :2] = q[0, :2] + (q[:, :2] - q[0, :2]) @ turn
    q[:, 3:5] = q[:, 3:5] @ turn
