"""A scene's line as the sections of the direct solver: flexible cable, elastica, rigid body."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.direct.kernels import layout as own

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.scene.line import Cable
from cablemodel.solvers.shared.numbers import WHOLE

FloatArray = NDArray[np.float64]

NEARLY_ALL = 1.25
"""A hybrid shorter than this many bending lengths is an elastica throughout."""
SECTION_FINEST = 0.2
"""Of the thickness (EI/w)^(1/3) of the layer at the touchdown point: the first interval there."""
SECTION_GROWTH = 1.25
"""Ratio of neighbouring intervals next to the touchdown point."""


@dataclass
class Section:
    """A part of the line with one kind of equations."""

    kind: int
    cable: Cable | None
    """None for a rigid body."""
    lengths: FloatArray
    """Unstretched lengths of its intervals (n,) [m]; one of zero for a rigid body."""
    body: int = -1
    """Row of the rigid body that it is."""
    point: int = -1
    """Row of the point body at its start."""
    hinge: bool = False
    """Whether its start is a hinge even where both sides bend."""
    follows: bool = False
    """Its mesh goes along with the touchdown point."""

    @property
    def length(self) -> float:
        """Unstretched [m]."""
        return float(self.lengths.sum())


def bends(scene: Scene, cable: Cable) -> bool:
    """Whether a cable has bending stiffness anywhere."""
    return cable.model != "cable" and scene.cable_types[cable.type].bending_stiffness > 0.0


def drum_kind(scene: Scene, cable: Cable) -> int:
    """Kind of a cable that comes off the drum: under tension, so that a hybrid is flexible."""
    return own.ELASTICA if cable.model == "elastica" and bends(scene, cable) else own.CABLE


def even(length: float, spacing: float) -> FloatArray:
    """Equal intervals no longer than the spacing."""
    count = max(1, math.ceil(length / spacing - WHOLE))
    return np.full(count, length / count)


def graded(length: float, spacing: float, finest: float) -> FloatArray:
    """Intervals that shrink towards the far end, from the spacing to the finest."""
    sizes = [min(finest, spacing)]
    while sum(sizes) < length:
        sizes.append(min(spacing, SECTION_GROWTH * sizes[-1]))
    lengths = np.array(sizes[::-1])
    return np.asarray(lengths * (length / lengths.sum()))


def sections_of(scene: Scene) -> list[Section]:
    """The sections of the scene's line, from the vessel outwards.

    Rows of bodies count the bodies of the line in order. The body at the far end, if it is a
    point, is no section's start: the caller puts it behind the last one.
    """
    spacing = scene.solver.node_spacing
    floor = scene.environment.floor is not None
    items = list(scene.line)
    found: list[Section] = []
    body = -1
    point = -1
    hinge = False
    for place, item in enumerate(items):
        if item.body is not None:
            body += 1
            if item.body.half_length > 0.0:
                hinge = _kinks(items[place - 1].cable)
                found.append(Section(own.RIGID, None, np.zeros(1), body=body, hinge=hinge))
                hinge = place + 1 < len(items) and _kinks(items[place + 1].cable)
            else:
                point = body
                neighbours = [items[k].cable for k in (place - 1, place + 1) if k < len(items)]
                hinge = any(_kinks(cable) for cable in neighbours)
            continue
        cable = item.cable
        assert cable is not None
        last = place == len(items) - 1
        parts = _parts(scene, cable, first=place == 0, last=last)
        for kind, length in parts:
            lengths = even(length, spacing)
            follows = floor and last and kind == own.ELASTICA
            if follows:
                of_type = scene.cable_types[cable.type]
                layer = (of_type.bending_stiffness / abs(of_type.submerged_weight or 1.0)) ** (
                    1.0 / 3.0
                )
                lengths = graded(length, spacing, SECTION_FINEST * layer)
            found.append(Section(kind, cable, lengths, point=point, hinge=hinge, follows=follows))
            point, hinge = -1, False
    return found


def _kinks(cable: Cable | None) -> bool:
    """Whether a cable may kink at a body; an elastica may not."""
    return cable is not None and cable.model != "elastica"


def _parts(scene: Scene, cable: Cable, *, first: bool, last: bool) -> list[tuple[int, float]]:
    """Kinds and lengths of a cable: a hybrid bends near a free or floor end, and at a clamp."""
    if not bends(scene, cable):
        return [(own.CABLE, cable.length)]
    if cable.model == "elastica" or scene.initial.kind == "straight":
        # An unstretched line has no tension anywhere: a hybrid bends throughout.
        return [(own.ELASTICA, cable.length)]
    part = scene.solver.bending_length
    at_end = last and (scene.end.kind == "free" or scene.end.connection.kind == "clamped")
    at_start = first and scene.vessel.connection.kind == "clamped"
    ends = int(at_end) + int(at_start)
    if ends == 0:
        return [(own.CABLE, cable.length)]
    if cable.length < NEARLY_ALL * part * ends:
        return [(own.ELASTICA, cable.length)]
    parts = [(own.CABLE, cable.length - part * ends)]
    if at_start:
        parts.insert(0, (own.ELASTICA, part))
    if at_end:
        parts.append((own.ELASTICA, part))
    return parts
