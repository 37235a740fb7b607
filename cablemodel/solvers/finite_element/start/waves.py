"""A scene's waves for the kernels: the components' table, and nodes where they are felt."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.scene.sea import Sea, sea
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.mesh import halved_where
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.curves import way_along
from cablemodel.solvers.shared.layout import Header, Scalars
from cablemodel.solvers.shared.numbers import TALLEST

if TYPE_CHECKING:
    from cablemodel.scene import Scene

FloatArray = NDArray[np.float64]

RESOLUTION = 8.0
"""Steps in the shortest period that carries energy, at least."""
SEA_FEWEST = 32
"""Components from which on a series for all of them is less work than their sum."""
CELL_ERROR = 10.0, 1e-2
"""What the water's acceleration may be wrong by at the corner of a cell, rms, over that of the sea:
times the tolerance, and at most. In most of a cell it is far less, as that of the velocity is."""
REACH = 0.8
"""Share of a series' argument that comes from the place in a cell, over that from the time."""
MOST_TURN = 2.5
"""Of a cell's carrier from middle to corner [rad], where the kernel's sine is right to 1e-8."""
DEAD = 16.0
"""k d beyond which nothing is left of a component."""
BISECTIONS = 12
"""Of the depth at which a layer begins."""
SEA_STAYS = 0.25
"""Of what is allowed: by how much it may change over the way within which a stage of a step keeps
the water of its first iteration."""
SEA_UNSEEN = 0.01
"""Of what is allowed: a mirror at the bottom that is less is left out."""
ENERGY_SEEN = 0.95
"""Of a sea's components, in order of their frequencies: those whose periods steps resolve."""
DEEPEST = 1e9
"""Depth in place of one that is not given [m]."""
CARRIERS = 18
"""Frequencies from the lowest to the highest component: those within are tried as carriers."""


def fill(block: Block, waves: Sea | None, tolerance: float) -> None:
    """Write the components into a block, and the cells in which they have a series."""
    if waves is None:
        return
    reals = block.reals
    state = Scalars(reals)
    state.wave_ramp = waves.ramp
    # The shortest waves that matter: a twentieth of the energy is in shorter ones.
    fast = float(np.quantile(waves.frequency, ENERGY_SEEN))
    state.wave_step = 2.0 * math.pi / fast / RESOLUTION
    state.wave_depth = min(waves.depth, 1e300)
    state.wave_crest = float(waves.amplitude.sum())
    state.wave_number = 2.0 * math.pi / waves.length
    state.wave_x = math.cos(waves.direction)
    state.wave_y = math.sin(waves.direction)
    mirror = np.exp(-2.0 * waves.number * waves.depth)
    columns = block.array(Header.waves, at.WAVE_WORDS, len(waves.number))
    columns[at.W_AMPLITUDE] = waves.amplitude
    columns[at.W_FREQUENCY] = waves.frequency
    columns[at.W_NUMBER] = waves.number
    columns[at.W_PHASE] = waves.phase
    columns[at.W_SPEED] = waves.amplitude * waves.frequency / (1.0 - mirror)
    columns[at.W_MIRROR] = mirror
    order = np.argsort(waves.number, kind="stable")
    columns[:] = columns[:, order]
    if cell_terms(waves):
        state.cell_stays = way_that_stays(waves, tolerance)
        words = block.array(Header.cell_layers, at.CELL_LAYERS, len(order) + 1, at.CELL_TERMS)
        words[:, 0, at.Layer.depth] = math.inf
        for row, layer in zip(words, layers(waves, tolerance), strict=False):
            row[0, at.Layer.depth] = layer.depth
            row[0, at.Layer.time], row[0, at.Layer.width] = layer.time, layer.width
            row[0, at.Layer.frequency], row[0, at.Layer.number] = layer.frequency, layer.number
            row[0, at.Layer.mirror] = layer.mirror
            row[1:] = layer.powers[order]


@dataclass(frozen=True)
class Layer:
    """A layer of water, and its cells of space and time in which a sea is one short series."""

    depth: float
    """Where it begins [m]."""
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
    return 0 if waves is None or len(waves.amplitude) < SEA_FEWEST else at.CELL_TERMS


@lru_cache(maxsize=8)
def layers(waves: Sea, tolerance: float) -> tuple[Layer, ...]:
    """Layers of water whose cells last 1, 2, 4, ... times as long as those at the surface.

    Each begins where its series are as good as they must be (`CELL_ERROR`), for short waves die
    out with the depth. Kept: a start asks for each of its meshes.
    """
    allowed = min(CELL_ERROR[0] * tolerance, CELL_ERROR[1])
    frequency, number = waves.frequency, waves.number
    speed = waves.amplitude * frequency / (1.0 - np.exp(-2.0 * number * waves.depth))
    mirrored = speed * np.exp(-number * min(waves.depth, DEEPEST))
    scale = np.linalg.norm(speed * frequency)
    carriers = np.linspace(frequency.min(), frequency.max(), CARRIERS)[1:-1, None]
    carrier_numbers = np.interp(carriers, frequency, number)
    faster, shorter = frequency - carriers, number - carrier_numbers

    def ways(alive: FloatArray) -> FloatArray:
        """A place's way a second, for each carrier, (carriers, 1) [m/s]."""
        norms = [np.linalg.norm(alive * x, axis=1, keepdims=True) for x in (faster, shorter)]
        return np.asarray(REACH * norms[0] / norms[1])

    def best(depth: float, time: float) -> int | None:
        """The carrier with the least error at the corners of such cells; None: of none it is
        allowed."""
        alive = speed * np.exp(-number * depth)
        way = ways(alive)
        r = (np.abs(faster) + np.abs(shorter) * way) * (0.5 * time)
        error = np.zeros(len(carriers))
        for amplitude, degree in ((alive, at.CELL_DEGREE), (mirrored, at.MIRROR_DEGREE)):
            left = np.abs(faster) + carriers * r / (degree + 1)
            missing = np.linalg.norm(amplitude * left * r**degree, axis=1)
            error = np.maximum(error, missing / math.factorial(degree) / scale)
        turn = 0.5 * time * (carriers + carrier_numbers * way)[:, 0]
        error[turn > MOST_TURN] = np.inf
        least = int(np.argmin(error))
        return least if error[least] <= allowed else None

    def layer(depth: float, time: float, one: int, below: float) -> Layer:
        way = float(ways(speed * np.exp(-number * depth))[one, 0])
        powers = [
            shorter[one] ** q / math.factorial(q) * faster[one] ** (n - q) / math.factorial(n - q)
            for n in range(at.CELL_DEGREE + 1)
            for q in range(n + 1)
        ]
        # A place in its corner is as far from its middle as a time gives it.
        width = way * time / math.sqrt(2.0)
        at_end = mirrored * np.exp(-number * max(0.0, waves.depth - below))
        return Layer(
            # The middle of a cell may lie above the level.
            depth=depth + 0.5 * width if depth > 0.0 else 0.0,
            time=time,
            width=width,
            frequency=float(carriers[one, 0]),
            number=float(carrier_numbers[one, 0]),
            mirror=bool(np.linalg.norm(at_end * frequency) > SEA_UNSEEN * allowed * scale),
            powers=np.stack(powers, axis=1),
        )

    steps = 2.0 * MOST_TURN / frequency.min() * 0.5 ** np.arange(0.0, 12.0, 0.125)
    shortest = next((float(time) for time in steps if best(0.0, time) is not None), steps[-1])
    found = [(0.0, shortest, best(0.0, shortest) or 0)]
    deepest = min(waves.depth, DEAD / float(number.min()))
    for n in range(1, at.CELL_LAYERS):
        time = shortest * 2.0**n
        if best(deepest, time) is None:
            break
        above, depth = found[-1][0], deepest
        for _ in range(BISECTIONS):
            middle = 0.5 * (above + depth)
            above, depth = (middle, depth) if best(middle, time) is None else (above, middle)
        found.append((depth, time, best(depth, time) or 0))
    ends = [depth for depth, _, _ in found[1:]] + [waves.depth]
    return tuple(layer(*one, below) for one, below in zip(found, ends, strict=True))


def way_that_stays(waves: Sea, tolerance: float) -> float:
    """Way over which the water's acceleration changes by what a stage leaves out of it [m]."""
    allowed = min(CELL_ERROR[0] * tolerance, CELL_ERROR[1])
    acceleration = waves.amplitude * waves.frequency**2
    change = np.linalg.norm(acceleration * waves.number) / np.linalg.norm(acceleration)
    return float(SEA_STAYS * allowed / change)


def refine(scene: Scene, nodes: list[FloatArray], points: FloatArray) -> list[FloatArray]:
    """Nodes close enough to follow the waves where the first shape is near the surface.

    nodes: arc lengths of the nodes of every cable [m]; points: the first shape, (n, 3). An element
    is at most 1/k long where waves reach (half a length deep), and not too tall at the surface.
    """
    waves = sea(scene)
    if waves is None:
        return nodes
    accuracy = scene.solver.tolerance * scene.line_length
    arc = way_along(points)
    arc *= math.fsum(cable.length for cable in scene.cables) / arc[-1]
    number = 2.0 * math.pi / waves.length
    crest = 2.0 * math.sqrt(0.5 * float(np.sum(waves.amplitude**2)))  # half of hs, of a wave 1.4 a
    tallest = max(TALLEST[0] * crest, TALLEST[1] * accuracy)

    def is_too_long(start: float, a: float, b: float) -> bool:
        ends = np.interp([start + a, start + b], arc, points[:, 2])
        if number * ends.max() < -math.pi:
            return False
        at_surface = ends.min() < crest and ends.max() > -crest
        return number * (b - a) > 1.0 or bool(at_surface and abs(ends[1] - ends[0]) > tallest)

    return halved_where(scene.cables, nodes, is_too_long)
