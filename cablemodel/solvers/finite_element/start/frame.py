"""The block's coordinates: a vertical plane where the scene lies in one, else space."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.scene.sea import sea
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.start.laid_loads import water_velocity
from cablemodel.solvers.shared.scene_numbers import shared_direction

if TYPE_CHECKING:
    from cablemodel.scene import Scene

FloatArray = NDArray[np.float64]


def vertical_plane(
    scene: Scene, directions: list[FloatArray], *, start: bool = False
) -> FloatArray | None:
    """Horizontal direction of the vertical plane that holds all of the scene, or None.

    start: all that acts on a static start.
    """
    motion = scene.motion()
    if start:
        candidates = [motion.evaluate(0.0)[1][:2]]
    elif not motion.is_planar():
        return None
    else:
        moving = motion.horizontal_direction()
        candidates = [] if moving is None else [np.asarray(moving, dtype=float)]
    candidates += [np.asarray(d[:2], dtype=float) for d in directions]
    floor = scene.environment.floor
    if floor is not None and floor.z is not None:
        candidates.append(np.asarray(floor.slope, dtype=float))
    elif floor is not None:
        candidates.append(np.array([1.0, 0.0]))
        if np.ptp(floor.grid_z, axis=1).any():
            return None
    current = scene.environment.current
    if current is not None:
        flows = water_velocity(scene, current.z) if start else current.velocity
        candidates += list(flows.reshape(-1, 3)[:, :2])
    water = None if start else sea(scene)
    if water is not None:
        candidates.append(np.array([math.cos(water.direction), math.sin(water.direction)]))
    plane, shared = shared_direction(candidates)
    return plane if shared else None


def earth(block: Block, points: FloatArray) -> FloatArray:
    """Points in the block's coordinates (n, dimension) in the earth's frame, (n, 3) [m]."""
    if block.header.dimension == 2:
        plane = block.scalars.plane
        points = points @ np.array([[plane[0], plane[1], 0.0], [0.0, 0.0, 1.0]])
    return np.asarray(points + block.scalars.origin, dtype=np.float64)


def local(block: Block, vector: FloatArray, *, point: bool) -> FloatArray:
    """An earth-frame point or vector in the block's coordinates, (dimension,)."""
    value = np.asarray(vector, dtype=float)
    if point:
        value = value - block.scalars.origin
    if block.header.dimension == 3:
        return value
    plane = block.scalars.plane
    return np.array([plane @ value[:2], value[2]])
