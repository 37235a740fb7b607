"""The ways in which a static start is sought, one after the other until one leads to a shape.

Which equilibrium is accepted is the same for all of them; they differ in where the search begins.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from cablemodel.solvers.finite_element.start import laid_shape, laid_start
from cablemodel.solvers.finite_element.start.scales import is_flexible

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from cablemodel.scene import Scene
    from cablemodel.solvers.finite_element.block import Block

    FloatArray = NDArray[np.float64]


@dataclass(frozen=True)
class Strategy:
    """How a static start is sought."""

    as_laid: bool = False
    """Friction holds what lies on the floor, see laid_start; else what has a free end slides."""
    steadier: bool = False
    """What a lay has laid slides on short bristles from the first cable of its way on."""
    lies: Block | None = None
    """What lies stays where it is in this one, at a coarser tolerance or of a stiffer cable."""
    lets_go: bool = False
    """What lies stays, but for what pulls at what hangs, see laid_start.let_go."""
    at_once: bool = False
    """A lay on its own floor only, not on floors that harden."""
    comes_up: bool = False
    """Where a lay is not found at once, its cable gets its momentum bit by bit."""
    points: FloatArray | None = None
    """From this polyline (n, 3) [m], instead of a first shape of the search's own."""
    intermediate: bool = False
    """Only the place is wanted where cable lies: whether it stays there is asked at the end."""
    patient: bool = False
    """By all of continuation: clamps are turned bit by bit, floors harden from several depths."""
    swept: bool = False
    """The first shape is that of the other extreme in a current: what hangs between two ends bows
    where it pushes, what lies is not pushed aside by it (first_shape, free_hanging)."""
    halved: bool = False
    """On elements half as long."""
    hung: bool = False
    """From where a chain hangs between two held ends, with its bodies (held_line)."""
    upright: bool = False
    """From a cable that hangs straight down to the floor on which it lies to its anchor: a catenary
    as wide as the cable bends is shorter than one that is nearly slack, and would press it."""
    bight: bool = False
    """From a catenary between two ends that are close to each other, on elements graded to it."""


def described(strategy: Strategy) -> str:
    """What a strategy does, in words."""
    words = ["with friction that holds what was laid" if strategy.as_laid else "without friction"]
    words += ["on short bristles"] * strategy.steadier
    words += ["by clamps and floors that are set bit by bit"] * strategy.patient
    words += ["from where the current draws it"] * strategy.swept
    words += ["on elements half as long"] * strategy.halved
    words += ["from where a chain hangs"] * strategy.hung
    words += ["from a cable that hangs straight down"] * strategy.upright
    words += ["from a bight"] * strategy.bight
    words += ["from the points"] * (strategy.points is not None)
    return ", ".join(words)


def strategies(scene: Scene) -> Iterator[Strategy]:
    """All strategies for a scene, the plainest first."""
    laid = laid_start.applies(scene)
    if laid:
        yield Strategy(as_laid=True)
        if laid_start.is_laid_back(scene):
            yield Strategy(as_laid=True, steadier=True)
    if scene.end.kind == "anchor" and len(scene.line) > 1 and laid_shape.surplus(scene) <= 0.0:
        yield Strategy(hung=True)
    yield Strategy()
    if scene.initial.kind != "static" or laid_shape.surplus(scene) > 0.0:
        return  # slack to an anchor has no single shape: it must not depend on where one begins
    swept = scene.environment.current is not None
    halved = any(cable.elements is None for cable in scene.cables)
    lay = scene.rate_at_start > 0.0 and scene.end.kind == "free"  # its floor hardens in each
    if (scene.environment.floor is not None and not lay) or _is_clamped(scene):
        yield Strategy(patient=True)
    if swept:
        yield Strategy(patient=True, swept=True)
    if halved:
        yield Strategy(patient=True, halved=True)
    if swept and halved:
        yield Strategy(patient=True, swept=True, halved=True)
    if scene.end.kind == "anchor":
        yield Strategy(patient=True, bight=True)
        if scene.environment.floor is not None:
            yield Strategy(upright=True)


def _is_clamped(scene: Scene) -> bool:
    """Whether an end of the line turns a cable that bends."""
    ends = [(scene.vessel.connection, scene.cables[0])]
    if scene.end.kind == "anchor":
        ends.append((scene.end.connection, scene.cables[-1]))
    return any(end.kind == "clamped" and not is_flexible(scene, cable) for end, cable in ends)
