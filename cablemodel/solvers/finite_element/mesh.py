"""Where the nodes of a line lie: from the accuracy that is asked for, or an element count.

The rules are measured (docs/engine/mesh.md): how many elements a line needs at an accuracy, where
they must be small. A cubic element's error falls like h^4, so counts grow like tau^(-1/4).
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.shared.layout import LIGHT_DAMPING

if TYPE_CHECKING:
    from cablemodel.scene.line import Cable
from cablemodel.solvers.shared.numbers import COMMON_TOLERANCE, WHOLE

FloatArray = NDArray[np.float64]

_STEADY = 4.0
"""Elements at tau = 1e-3 of a line that starts under tension."""
_FEWEST = 4, 3
"""Of any line, at any accuracy, and of one that has nothing to bend it but its tow in a plane."""
_SWINGING = 6.0
"""The same where drag hardly damps: what swings and waves are late by adds up."""
_SLACK = 20.0
"""The same for a line that starts without tension: it folds at its ends, and cracks."""
_WHIP_IN_AIR = 14.0, 0.4
"""Where a little drag damps its waves, and the power of 1e-3 / tau that it takes. Down to
tau = 1e-4 the time steps damp what such a mesh does not resolve, and decide the error; in a vacuum
they are too short for that."""
_LAYER_GROWTH = 2.0
"""Ratio of neighbouring elements next to a bending layer."""
_NEARLY = 1.05
"""Of the size that resolves a layer: longer elements are halved. A clamp's moment is then off by
1.2 % at most at tau = 1e-3; by 3.5 % with elements of 1.4 of that size."""
MESH_FEWEST = 2
"""Elements of a cable between two bodies."""
_SIZE_PLACES = 2001
"""Places along the line at which sizes of elements are added up."""
_SHORTEST_LAYER = 1e-4
"""Of a cable: what its mesh resolves at a clamp at least."""


@dataclass(frozen=True)
class Span:
    """One cable of a line as the mesh sees it."""

    length: float
    """Unstretched [m]."""
    elements: int | None = None
    """A count that overrides the rules: equal elements, for studies."""
    layer_start: float = math.inf
    """Thickness sqrt(EI/T) of a bending layer at its end towards the vessel [m]; inf: none."""
    layer_end: float = math.inf
    """The same at its far end."""


@dataclass(frozen=True)
class Start:
    """What the whole line is like at t = 0."""

    slack: bool
    """It starts without tension."""
    damping: float
    """rho Cdn d L / m of the line, dimensionless."""
    free_end: bool
    bare: bool = False
    """One cable from a pin in still water, moved in a plane."""

    @property
    def lightly_damped(self) -> bool:
        """A whip, or a swing that goes on: drag takes little of the motion."""
        return self.damping < LIGHT_DAMPING

    @property
    def plain(self) -> bool:
        """Nothing but a tow in a plane bends it: a bare one that hangs at rest, its end free."""
        return self.bare and self.free_end and not self.slack and not self.lightly_damped


def element_count(tolerance: float, start: Start) -> int:
    """Elements of a whole line for an accuracy tau."""
    pulled = _SWINGING if start.lightly_damped else _STEADY
    at_thousandth = _SLACK if start.slack else pulled
    count = at_thousandth * math.pow(COMMON_TOLERANCE / tolerance, 0.25)
    if start.slack and start.lightly_damped and start.damping > 0.0:
        count = min(
            count, _WHIP_IN_AIR[0] * math.pow(COMMON_TOLERANCE / tolerance, _WHIP_IN_AIR[1])
        )
    return max(_FEWEST[start.plain], math.ceil(count - WHOLE))


@cache
def _share_of_elements(
    slack: bool, free_end: bool, lightly_damped: bool
) -> tuple[FloatArray, FloatArray]:
    """Fractions x of the line from the vessel, and the integral of 1 / size from 0 to each.

    Sizes are relative. A towed line bends most at its free end, a line that starts slack where it
    is held, a whip at its tip.
    """

    def size(x: float) -> float:
        if not slack:
            return math.pow(2.0, -x) if free_end else 1.0
        if lightly_damped and free_end:
            return math.pow(4.0, -x)
        return math.pow(4.0, -abs(2.0 * x - 1.0))

    x = np.linspace(0.0, 1.0, _SIZE_PLACES)
    density = np.array([1.0 / size(float(value)) for value in x])
    share = np.concatenate([[0.0], np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(x))])
    for array in (x, share):
        array.setflags(write=False)  # one serves all lines
    return x, share


def line_nodes(spans: list[Span], tolerance: float, start: Start) -> list[FloatArray]:
    """Arc lengths of the nodes of every cable [m], each from 0 to its length."""
    total = math.fsum(span.length for span in spans)
    count = element_count(tolerance, start)
    # Nodes at equal steps of the integral of 1 / size over the line.
    x, share = _share_of_elements(start.slack, start.free_end, start.lightly_damped)
    integral = count / share[-1] * share
    nodes = []
    arc = 0.0
    for span in spans:
        if span.elements is not None:
            nodes.append(np.linspace(0.0, span.length, span.elements + 1))
        else:
            first, last = np.interp([arc / total, (arc + span.length) / total], x, integral)
            n = max(MESH_FEWEST, round(last - first))
            places = np.interp(np.linspace(first, last, n + 1), integral, x) * total - arc
            places[0], places[-1] = 0.0, span.length
            nodes.append(with_layers(places, span, tolerance))
        arc += span.length
    return nodes


def with_layers(nodes: FloatArray, span: Span, tolerance: float) -> FloatArray:
    """Split the elements next to bending layers, so that sizes grow from the layer outwards."""
    smallest = 2.0 * min(1.0, math.pow(tolerance / COMMON_TOLERANCE, 0.25))
    places = list(nodes)
    for layer, at_end in ((span.layer_start, False), (span.layer_end, True)):
        if not math.isfinite(layer) or layer <= 0.0:
            continue
        target = max(layer * smallest, _SHORTEST_LAYER * span.length)
        size = abs(places[-1] - places[-2]) if at_end else places[1] - places[0]
        new = []
        while size > target * _NEARLY:
            size /= _LAYER_GROWTH
            new.append(size)
        if at_end:
            places[-1:] = [span.length - value for value in new] + [span.length]
        else:
            places[:1] = [0.0, *reversed(new)]
    return np.array(places)


def halved_where(
    cables: Sequence[Cable],
    nodes: list[FloatArray],
    is_too_long: Callable[[float, float, float], bool],
) -> list[FloatArray]:
    """Cables' nodes with elements halved, again and again, while they are too long.

    Cables of which the scene says how many elements they have stay as they are.

    Args:
        nodes: of every cable, arc lengths from 0 to its length [m].
        is_too_long: asked of the arc length at which a cable begins, and of those of an element's
            ends within the cable [m].
    """
    finer = []
    start = 0.0
    for cable, places in zip(cables, nodes, strict=True):
        new = list(places)
        while cable.elements is None:
            split = [0.5 * (a + b) for a, b in itertools.pairwise(new) if is_too_long(start, a, b)]
            if not split:
                break
            new = sorted([*new, *split])
        finer.append(np.array(new))
        start += cable.length
    return finer
