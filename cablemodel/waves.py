"""A scene's waves for the kernels: the components' table, and nodes where they are felt."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.block import Block
from cablemodel.kernels import layout as at
from cablemodel.mesh import halved_where
from cablemodel.scene.sea import Sea, sea

if TYPE_CHECKING:
    from cablemodel.scene import Scene

FloatArray = NDArray[np.float64]

RESOLUTION = 8.0
"""Steps in the shortest period that carries energy, at least."""
TALLEST = 4.0, 10.0
"""Heights of an element at the surface: in crests, or in tau L, whichever allows more. Its wet part
is known, wherever it ends; the load along it is not that of a cubic's nodes."""


def fill(block: Block, waves: Sea | None) -> None:
    """Write the components into a block."""
    if waves is None:
        return
    reals = block.reals
    reals[at.S_WAVE_RAMP] = waves.ramp
    # The shortest waves that matter: a twentieth of the energy is in shorter ones.
    fast = float(np.quantile(waves.frequency, 0.95))
    reals[at.S_WAVE_STEP] = 2.0 * math.pi / fast / RESOLUTION
    reals[at.S_WAVE_DEPTH] = min(waves.depth, 1e300)
    reals[at.S_WAVE_CREST] = float(waves.amplitude.sum())
    reals[at.S_WAVE_X : at.S_WAVE_Y + 1] = math.cos(waves.direction), math.sin(waves.direction)
    mirror = np.exp(-2.0 * waves.number * waves.depth)
    columns = block.array(at.O_WAVES, at.WAVE_WORDS, len(waves.number))
    columns[at.W_AMPLITUDE] = waves.amplitude
    columns[at.W_FREQUENCY] = waves.frequency
    columns[at.W_NUMBER] = waves.number
    columns[at.W_PHASE] = waves.phase
    columns[at.W_SPEED] = waves.amplitude * waves.frequency / (1.0 - mirror)
    columns[at.W_MIRROR] = mirror
    columns[:] = columns[:, np.argsort(waves.number, kind="stable")]


def refine(scene: Scene, nodes: list[FloatArray], points: FloatArray) -> list[FloatArray]:
    """Nodes close enough to follow the waves where the first shape is near the surface.

    nodes: arc lengths of the nodes of every cable [m]; points: the first shape, (n, 3). An element
    is at most 1/k long where waves reach (half a length deep), and not too tall at the surface.
    """
    waves = sea(scene)
    if waves is None:
        return nodes
    arc = np.concatenate([[0.0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    arc *= scene.line_length / arc[-1]
    number = 2.0 * math.pi / waves.length
    crest = 2.0 * math.sqrt(0.5 * float(np.sum(waves.amplitude**2)))  # half of hs, of a wave 1.4 a
    tallest = max(TALLEST[0] * crest, TALLEST[1] * scene.solver.tolerance * scene.line_length)

    def is_too_long(start: float, a: float, b: float) -> bool:
        ends = np.interp([start + a, start + b], arc, points[:, 2])
        if number * ends.max() < -math.pi:
            return False
        at_surface = ends.min() < crest and ends.max() > -crest
        return number * (b - a) > 1.0 or bool(at_surface and abs(ends[1] - ends[0]) > tallest)

    return halved_where(scene.cables, nodes, is_too_long)
