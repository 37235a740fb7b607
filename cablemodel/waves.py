"""A scene's waves for the kernels: the components' table, and nodes where they are felt."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
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
FEWEST = 32
"""Components from which on a series for all of them is less work than their sum."""
CELL_ERROR = 10.0, 1e-2
"""What the water's acceleration may be wrong by at the corner of a cell, rms, over that of the sea:
times the tolerance, and at most. In most of a cell it is far less, as that of the velocity is."""
REACH = 0.8
"""Share of a series' argument that comes from the place in a cell, over that from the time."""
MOST_TURN = 1.25
"""Of a cell's carrier from middle to corner [rad], where the kernel's sine is right to 1e-9."""
UNSEEN = 0.01
"""Of what is allowed: a mirror at the bottom that is less is left out."""


def fill(block: Block, waves: Sea | None, tolerance: float) -> None:
    """Write the components into a block, and the cells in which they have a series."""
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
    order = np.argsort(waves.number, kind="stable")
    columns[:] = columns[:, order]
    if cell_terms(waves):
        series = cells(waves, tolerance)
        reals[at.S_CELL_TIME], reals[at.S_CELL_WIDTH] = series.time, series.width
        reals[at.S_CELL_FREQUENCY], reals[at.S_CELL_NUMBER] = series.frequency, series.number
        block.ints[at.I_CELL_MIRROR] = series.mirror
        powers = block.array(at.O_CELL_POWERS, len(waves.number), at.CELL_TERMS)
        powers[:] = series.powers[order]


@dataclass(frozen=True)
class Cells:
    """Cells of space and time in which a sea is one short series (kernels/sea_cells.py)."""

    time: float
    """Of a cell [s]."""
    width: float
    """Along the waves' way and upwards [m]."""
    frequency: float
    """Of the carrier [rad/s]."""
    number: float
    """Of the carrier [rad/m]."""
    mirror: bool
    """Whether the bottom's mirror of the waves is seen."""
    powers: FloatArray
    """(n, CELL_TERMS): factors of the components in the terms of a series."""


def cell_terms(waves: Sea | None) -> int:
    """Of the series in a sea's cells; 0: of so few components that it has none."""
    return 0 if waves is None or len(waves.amplitude) < FEWEST else at.CELL_TERMS


@lru_cache(maxsize=8)
def cells(waves: Sea, tolerance: float) -> Cells:
    """The largest cells whose series are as good as they must be (`CELL_ERROR`).

    Kept: a start asks for each of its meshes.
    """
    allowed = min(CELL_ERROR[0] * tolerance, CELL_ERROR[1])
    frequency, number = waves.frequency, waves.number
    speed = waves.amplitude * frequency / (1.0 - np.exp(-2.0 * number * waves.depth))
    at_bottom = speed * np.exp(-number * waves.depth)
    scale = np.linalg.norm(speed * frequency)

    def around(carrier: float) -> tuple[float, FloatArray, FloatArray, float]:
        """A carrier's number, what the components have more than it, and a place's way a second."""
        k = float(np.interp(carrier, frequency, number))
        faster, shorter = frequency - carrier, number - k
        return k, faster, shorter, float(REACH * np.abs(faster).max() / np.abs(shorter).max())

    def off(carrier: float, time: float) -> float:
        """Error of the acceleration over that of the sea, at a corner half a cell's time away."""
        _, faster, shorter, way = around(carrier)
        r = (np.abs(faster) + np.abs(shorter) * way) * time
        error = 0.0
        for amplitude, degree in ((speed, at.CELL_DEGREE), (at_bottom, at.MIRROR_DEGREE)):
            left = np.abs(faster) + carrier * r / (degree + 1)
            missing = np.linalg.norm(amplitude * left * r**degree) / math.factorial(degree)
            error = max(error, float(missing / scale))
        return error

    def longest(carrier: float) -> float:
        """Half of the longest time of a cell [s]."""
        k, _, _, way = around(carrier)
        most = MOST_TURN / (carrier + k * way)
        steps = most * 0.5 ** np.arange(0.0, 10.0, 0.125)
        return float(next((time for time in steps if off(carrier, time) <= allowed), steps[-1]))

    carriers = np.linspace(frequency.min(), frequency.max(), 18)[1:-1]
    time = longest(float(np.median(carriers)))
    carrier = float(min(carriers, key=lambda one: off(one, time)))
    time = longest(carrier)
    k, faster, shorter, way = around(carrier)
    powers = [
        shorter**q / math.factorial(q) * faster ** (n - q) / math.factorial(n - q)
        for n in range(at.CELL_DEGREE + 1)
        for q in range(n + 1)
    ]
    return Cells(
        time=2.0 * time,
        # A place in its corner is as far from its middle as a time gives it.
        width=math.sqrt(2.0) * way * time,
        frequency=carrier,
        number=k,
        mirror=bool(np.linalg.norm(at_bottom * frequency) > UNSEEN * allowed * scale),
        powers=np.stack(powers, axis=1),
    )


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
