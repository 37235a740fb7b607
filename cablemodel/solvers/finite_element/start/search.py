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
from cablemodel.solvers.finite_element.start import laid_loads, laid_start
from cablemodel.solvers.finite_element.start.scales import is_flexible
from cablemodel.solvers.finite_element.start.sea_floor import (
    contact_depth,
    touchdown_layer,
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


class NotFoundError(StaticsError):
    """An attempt that came to no rest: what makes the scene hard is said when all have failed."""


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

    def ends_without(self, problem: StaticsError, hard: str, instead: str) -> StaticsError:
        """What to raise when all has been tried.

        problem: that of the plainest attempt; hard, instead: as of `gives_up`.
        """
        why = f"What makes it hard: {hard}. " if hard else ""
        return StaticsError(f"{problem}. Tried: {'; '.join(self.tried)}. {why}{instead}")

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


def folds(scene: Scene) -> bool:
    """Whether a lay's cable bends so little that what lies may fold on the way to its start."""
    return scene.end.kind == "free" and laid_start.stiffer_layers(scene) is not None


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
        if laying and speed > 0.0:
            hard += _hard_to_lay(scene, weight, drag)
        if scene.end.kind == "free":
            hard += _hard_to_hold(scene)
        layer, depth = touchdown_layer(scene, scene.cables[-1]), contact_depth(scene)
        if folds(scene):
            hard.append(
                f"its bending stiffness spreads the touchdown over {layer:.2g} m of a line of "
                f"{scene.line_length:.4g} m only"
            )
        if layer > THICK_LAYER * depth:
            hard.append(
                f"the floor's contact layer of {depth:.2g} m is thin against the {layer:.2g} m in "
                "which the cable bends on to it (a larger solver.tolerance makes it thicker)"
            )
    if scene.environment.current is not None:
        hard.append("a current pushes the line")
    return "; ".join(hard)


def _behind(scene: Scene) -> list[tuple[float, float]]:
    """Places (x, y) [m] below the line, behind its vessel or downstream, as close as a depth table
    has them; of a plane one."""
    floor, position = scene.environment.floor, scene.motion().evaluate(0.0)[0]
    assert floor is not None
    if floor.z is not None:
        return [(float(position[0]), float(position[1]))]
    current = laid_loads.water_velocity(scene, position[2:])[0]
    way = laid_loads.behind(scene, scene.motion().evaluate(0.0)[1][:2], current[:2])
    arcs = np.linspace(0.0, scene.line_length, len(floor.grid_x) + len(floor.grid_y))
    return [(float(x), float(y)) for x, y in position[:2] + np.outer(arcs, way)]


def _hard_to_lay(scene: Scene, weight: float, drag: float) -> list[str]:
    """What of a lay under way; weight and drag of its cables at the vessel's speed [N]."""
    floor, (place, velocity) = scene.environment.floor, scene.motion().evaluate(0.0)[:2]
    assert floor is not None
    rate, hard = scene.rate_at_start, []
    if weight > 0.0:
        down = laid_loads.lay_angle(weight, drag)
        way = velocity[:2] / float(np.hypot(velocity[0], velocity[1]))
        up = max(math.atan(float(way @ laid_loads.slopes(scene, *at))) for at in _behind(scene))
        if up >= down:
            hard.append(
                f"the floor rises by {math.degrees(up):.3g} degrees along the vessel's way, and "
                f"the line comes down at {math.degrees(down):.3g}: it does not land there"
            )
    tension = weight / scene.line_length * (place[2] - floor.height(place[0], place[1]))
    for body in scene.bodies:
        if body.submerged_weight > max(tension, 0.0):
            name = f"body {body.name}" if body.name else "a body"
            hard.append(
                f"{name} weighs {body.submerged_weight:.4g} N, more than the {tension:.4g} N with "
                "which the cable hangs from the vessel: it sinks ahead of it"
            )
    if laid_loads.is_dragged(scene):
        hard.append(
            f"a pay-out of {rate:.4g} m/s falls short of the {laid_loads.lay_rate(scene):.4g} "
            "m/s of a lay without tension: what lies is dragged"
        )
    return hard


def _hard_to_hold(scene: Scene) -> list[str]:
    """What friction does not hold of a line with a free end that lies: on a slope, in a current."""
    floor, places = scene.environment.floor, _behind(scene)
    assert floor is not None
    hard = []
    steepest = max(math.hypot(*laid_loads.slopes(scene, *at)) for at in places)
    if steepest > floor.friction:
        hard.append(f"a friction of {floor.friction:g} holds nothing on a slope of {steepest:.2g}")
    velocity = scene.motion().evaluate(0.0)[1]
    flows = laid_loads.water_velocity(scene, np.array([floor.height(*at) for at in places]))
    way = np.array([*laid_loads.behind(scene, velocity[:2], flows[0, :2]), 0.0])
    along = flows @ way
    across = np.linalg.norm(flows - np.outer(along, way), axis=1)
    lies = [piece for piece in laid_loads.pieces(scene) if piece.end > piece.start][-1]
    drag = float(np.hypot(lies.normal * across**2, lies.tangential * along**2).max())
    most = floor.friction * lies.contact
    if drag > most:
        flow = float(np.linalg.norm(flows, axis=1).max())
        hard.append(
            f"a current of {flow:.3g} m/s at the floor drags at what lies there with {drag:.3g} "
            f"N/m, and friction holds {most:.3g} N/m"
        )
    return hard
