"""The time that a search for a static start may take, what it has tried, and what makes it hard."""

from __future__ import annotations

import logging
import math
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import StaticsError
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.start import laid_loads
from cablemodel.solvers.finite_element.start.scales import is_flexible
from cablemodel.solvers.finite_element.start.sea_floor import (
    contact_depth,
    touchdown_layer,
    unfolding_layer,
)
from cablemodel.solvers.library import time_compiling

if TYPE_CHECKING:
    from cablemodel.scene import Scene
    from cablemodel.scene.common import CableScene

FloatArray = NDArray[np.float64]

ITERATION = 2e-6, 6e-6
"""What an iteration of Newton's method takes a node, planar and in space [s]: as much as a slow
machine needs."""
SEARCH_STEP = 48
"""Iterations that a step of all attempts of a relaxation takes at most."""
SEARCH_FEWEST = 10
"""Steps that a relaxation gets at least, while there is time."""
SHALLOW = math.radians(33.0)
"""A line that is towed or held at a smaller angle from the horizontal is named as hard."""
THICK_LAYER = 30.0
"""In depths of the contact layer: a touchdown layer beyond which a start is named as hard."""


class OutOfTimeError(Exception):
    """The time for a search has passed."""


def _clock() -> float:
    """Time [s]; it stands still while kernels are compiled, which is no search."""
    return time.monotonic() - time_compiling()


@dataclass
class Search:
    """A search for a start, since when it runs, for how long it may [s], and what it tried."""

    limit: float
    began: float = field(default_factory=_clock)
    tried: list[str] = field(default_factory=list)

    @property
    def left(self) -> float:
        """Time that is left [s]."""
        return self.began + self.limit - _clock()

    def tries(self, what: str) -> None:
        """Say what is tried now."""
        self.tried.append(what)
        logging.getLogger("cablemodel").info("start: %s", what)

    def gives_up(self, hard: str = "", instead: str = "") -> StaticsError:
        """What to raise when its time has passed.

        hard: what makes the start hard to find; instead: what else one may do than wait.
        """
        return StaticsError(
            f"no static equilibrium was found within the {self.limit:g} s of "
            f"solver.start_time_limit. Tried: {'; '.join(self.tried)}. "
            f"{f'What makes it hard: {hard}. ' if hard else ''}Give it more time{instead}"
        )


_running: ContextVar[Search | None] = ContextVar("search", default=None)
_told: ContextVar[tuple[Callable[[], None], Callable[[], None]] | None] = ContextVar(
    "told", default=None
)


@contextmanager
def told(begins: Callable[[], None], ends: Callable[[], None]) -> Iterator[None]:
    """Call a function whenever an equilibrium is sought: tables have been read and filled by then,
    and what takes long from there on is the search; and another one when the search is over."""
    token = _told.set((begins, ends))
    try:
        yield
    finally:
        _told.reset(token)


@contextmanager
def searching(scene: CableScene) -> Iterator[Search]:
    """A search within the scene's `solver.start_time_limit`."""
    search = Search(scene.solver.start_time_limit)
    token = _running.set(search)
    try:
        yield search
    finally:
        _running.reset(token)
        listens = _told.get()
        if listens is not None:
            listens[1]()


def equilibrium(block: Block, frame: FloatArray) -> int:
    """The kernels' search for an equilibrium, a status, in as many steps as there is time for.

    Raises:
        OutOfTimeError: there is none left.
    """
    from cablemodel.solvers import library as entry

    listens = _told.get()
    if listens is not None:
        listens[0]()
    search = _running.get()
    if search is None:
        return int(entry.equilibrium(block.ints, block.reals, frame))
    if search.left <= 0.0:
        raise OutOfTimeError
    most = int(block.header.maximum_steps)
    step = SEARCH_STEP * int(block.header.nodes) * ITERATION[int(block.header.dimension) - 2]
    block.header.maximum_steps = min(most, max(SEARCH_FEWEST, int(search.left / step)))
    try:
        return int(entry.equilibrium(block.ints, block.reals, frame))
    finally:
        block.header.maximum_steps = most


def what_is_hard(scene: Scene) -> str:
    """What of a scene makes its start hard to find, in words; empty where nothing stands out."""
    hard = []
    velocity = scene.motion().evaluate(0.0)[1]
    speed, rate = float(np.hypot(velocity[0], velocity[1])), scene.rate_at_start
    line, floor = laid_loads.pieces(scene), scene.environment.floor
    weight = math.fsum(p.weight * (p.end - p.start) for p in line if p.end > p.start)
    drag = math.fsum(p.normal * (p.end - p.start) for p in line if p.end > p.start) * speed**2
    laying = rate > 0.0 and floor is not None and scene.end.kind == "free"
    if speed > 0.0 and weight > 0.0 and not laying:  # lays start at any angle
        angle = laid_loads.lay_angle(weight, drag)
        if angle < SHALLOW:
            hard.append(f"the line hangs at {math.degrees(angle):.0f} degrees from the horizontal")
    ends = [("vessel", scene.vessel.connection, scene.cables[0])]
    ends.append(("end", scene.end.connection, scene.cables[-1]))
    for name, connection, cable in ends:
        if connection.kind == "clamped" and not is_flexible(scene, cable):
            hard.append(f"{name}.connection clamps a cable that bends")
    if floor is not None:
        layer, depth = touchdown_layer(scene, scene.cables[-1]), contact_depth(scene)
        if laying and layer < unfolding_layer(scene):
            hard.append(
                f"its bending stiffness spreads the touchdown over {layer:.2g} m of a line of "
                f"{scene.line_length:.4g} m only"
            )
        if layer > THICK_LAYER * depth:
            hard.append(
                f"the floor's contact layer of {depth:.2g} m is thin against the {layer:.2g} m in "
                "which the cable bends on to it (a larger solver.tolerance makes it thicker)"
            )
        steepest = math.hypot(*laid_loads.slopes(scene, *map(float, scene.vessel.position[:2])))
        if scene.end.kind == "free" and steepest > floor.friction:
            hard.append(
                f"a friction of {floor.friction:g} holds nothing on a slope of {steepest:.2g}"
            )
        if rate > 0.0 and laid_loads.is_dragged(scene):
            hard.append(
                f"a pay-out of {rate:.4g} m/s falls short of the {laid_loads.lay_rate(scene):.4g} "
                "m/s of a lay without tension: what lies is dragged"
            )
    if scene.environment.current is not None:
        hard.append("a current pushes the line")
    return "; ".join(hard)
