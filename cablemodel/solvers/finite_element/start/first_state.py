"""The state at t = 0: tensions and velocities of a given shape, or a static equilibrium."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import StaticsError
from cablemodel.scene.motion import AT_REST
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.start import (
    azimuth,
    continuation,
    laid_loads,
    laid_shape,
    laid_start,
    sea_floor,
    search,
)
from cablemodel.solvers.finite_element.start.first_shape import smoothly, stretch_of_points
from cablemodel.solvers.finite_element.start.frame import local
from cablemodel.solvers.finite_element.start.scales import sinks
from cablemodel.solvers.finite_element.start.strategies import Strategy
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.curves import hermite, way_along
from cablemodel.solvers.shared.layout import Header, Scalars

if TYPE_CHECKING:
    from cablemodel.scene import Scene

FloatArray = NDArray[np.float64]

_START_PARTS = 32
"""Of an element, whose chords are its length: of the whole line a few hundred would cut the corner
at the touchdown, by more than what is slack."""
_LEAST = 1e-4
"""Of the line's length: what lies on the floor may push so much shorter."""


def find_initial_state(block: Block, scene: Scene, strategy: Strategy) -> None:
    """The state of a block whose nodes are placed: velocities, tensions, a static shape.

    Raises:
        SceneError: a static start of an anchored cable while the vessel moves.
        StaticsError: no equilibrium was found.
    """
    from cablemodel.solvers import library as entry

    ints, reals = block.ints, block.reals
    stand_still(block, scene)
    frame = steady_velocity(block, scene)
    if scene.initial.kind != "static":
        if scene.initial.points is not None:
            entry.stretch_evenly(ints, reals, stretch_of_points(scene))
        _start_flowing(block, scene)
        entry.tension_from_stretch(ints, reals)
    else:
        if scene.end.kind == "anchor" and np.linalg.norm(frame) > AT_REST:
            laid_loads.check_steady(scene)
        try:
            solve_static(block, scene, frame, strategy)
            if _is_crushed(block, scene):
                raise StaticsError("no static equilibrium was found")
        except StaticsError:
            reason = _without_shape(scene)
            if not reason:
                raise
            raise StaticsError(
                f"no static equilibrium was found: {reason}; give initial: {{points: ...}}"
            ) from None
    if entry.stabilise(ints, reals) and scene.initial.kind == "static":
        # The new stiffness changes the forces by a little: the state must meet them.
        solve_static(block, scene, frame, strategy)
    entry.end_search(ints, reals)


def stand_still(block: Block, scene: Scene) -> None:
    """The state of a block whose nodes are placed, as they are, for a way to an equilibrium."""
    from cablemodel.solvers import library as entry

    entry.place_supports(block.ints, block.reals)
    if block.header.payout:
        block.winch.rate = scene.rate_at_start


def _is_crushed(block: Block, scene: Scene) -> bool:
    """Whether a line to an anchor takes up half of its slack by becoming shorter, which none does.

    A straight one along a level floor may: nothing in the equations pushes it aside.
    """
    slack, length = laid_shape.surplus(scene), scene.line_length
    if slack == 0.0:
        return False
    from cablemodel.solvers import library as entry

    edges = block.array(Header.edges, int(block.header.nodes), at.EDGE_WORDS)
    nodes = np.unique([0.0, *np.clip(edges[1:, at.Edge.start], 0.0, length), length])
    parts = np.arange(_START_PARTS * (len(nodes) - 1) + 1) / _START_PARTS
    stations = np.interp(parts, np.arange(len(nodes)), nodes)
    rows = np.empty((len(stations), at.STATION_WORDS))
    entry.sample(block.ints, block.reals, stations, rows.reshape(-1))
    chords = np.linalg.norm(np.diff(rows[:, at.Station.position.span], axis=0), axis=1)
    return length - float(chords.sum()) > max(0.5 * slack, _LEAST * length)


def _without_shape(scene: Scene) -> str:
    """Why a line may have no single shape at rest: what of it is slack; empty if nothing is."""
    slack = laid_shape.surplus(scene)
    if slack > 0.0:
        return (
            f"the line is {slack:g} m longer than straight down and along the floor to its anchor, "
            "and slack has no single shape at rest (a shorter line has one)"
        )
    if scene.environment.waves is not None and not sinks(scene):
        return (
            "the line floats, and what floats without tension has no single shape at rest (in a "
            "current, or behind a vessel under way, it has one)"
        )
    return ""


def steady_velocity(block: Block, scene: Scene) -> FloatArray:
    """Velocity of the frame in which a static start is at rest, (dimension,) [m/s]."""
    velocity = laid_loads.lay_motion(scene)[0]
    return np.ascontiguousarray(local(block, velocity, point=False))


def solve_static(block: Block, scene: Scene, frame: FloatArray, strategy: Strategy) -> None:
    """Bring a block to equilibrium in a frame that moves with the velocity ``frame`` [m/s].

    Raises:
        StaticsError: none was found.
    """
    head = Header(block.ints)
    state = Scalars(block.reals)
    held = head.constraint_count > 1
    friction = state.friction

    winch = block.winch
    rate, through = float(winch.rate), laid_loads.lay_motion(scene)[1]

    def solve_at_once() -> int:
        if rate == 0.0:
            return search.equilibrium(block, frame)
        winch.rate = through
        try:
            return search.equilibrium(block, frame)
        finally:
            winch.rate = rate

    def solve_in_few_steps() -> int:
        return continuation.in_few_steps(block, solve_at_once)

    floors = continuation.FLOORS if strategy.patient else continuation.FLOORS[:1]
    ways: list[Callable[[], int]] = [
        solve_at_once,
        *(
            partial(continuation.on_hardening_floors, block, solve_at_once, softer)
            for softer in (floors if head.floor_kind else ())
        ),
    ]
    if rate > 0.0 and head.floor_kind and not held:
        harden = partial(continuation.on_a_floor_that_hardens, block, solve_at_once)
        ways = [solve_in_few_steps if strategy.at_once else harden]
        if strategy.comes_up:
            ways.append(partial(continuation.as_momentum_comes_up, block, solve_in_few_steps))
    solve = partial(continuation.first_of, block, ways)
    if strategy.patient:
        turning = partial(continuation.with_turned_clamps, block, solve, solve_at_once)
        solve = partial(continuation.first_of, block, [ways[0], turning, *ways[1:]])

    if strategy.as_laid:
        hold = solve_in_few_steps if rate > 0.0 else solve
        if strategy.lets_go:
            laid_start.let_go(block, scene, solve_in_few_steps, steadier=strategy.steadier)
            status = int(at.OK)
        else:
            status = laid_start.lie_still(
                block, scene, solve, hold, strategy.lies, steadier=strategy.steadier
            )
    else:
        if not held:
            # A free end comes to rest without friction; it holds the line from there.
            state.friction = 0.0
        status = solve()
        state.friction = friction
        if status == at.OK and azimuth.is_free(scene):
            azimuth.turn_back(block, scene)  # as a whole: it stays at rest
        if not held:
            sea_floor.rest_where_it_is(block)
    if status != at.OK:
        node = block.failed_node
        arc = block.array(Header.edges, int(head.nodes), at.EDGE_WORDS)[node, at.Edge.start]
        raise search.NotFoundError(
            f"no static equilibrium was found; what moved last is {arc:g} m along the cable"
        )
    hold_supports(block)


def hold_supports(block: Block) -> None:
    """Supports of a block at rest, where they are at t = 0: kernels/time/begin.py."""
    from cablemodel.solvers import library as entry

    entry.hold_supports(block.ints, block.reals)


def _start_flowing(block: Block, scene: Scene) -> None:
    """Velocities of a shape that is given: those of the scene, or those of pay-out."""
    from cablemodel.solvers import library as entry

    given = scene.initial.velocities
    if isinstance(given, tuple):
        _give_velocities(block, scene, np.asarray(given, dtype=np.float64))
    else:
        entry.start_flow(block.ints, block.reals)


def _give_velocities(block: Block, scene: Scene, velocities: FloatArray) -> None:
    """Material velocities at the nodes from those at the points of the scene, (n, 3) [m/s]."""
    points = np.asarray(scene.initial.points, dtype=np.float64)
    way, flow = way_along(smoothly(points, points)), smoothly(points, velocities)
    nodes, dimension = int(block.header.nodes), int(block.header.dimension)
    edges = block.array(Header.edges, nodes, at.EDGE_WORDS)
    arcs = edges[:, at.Edge.start] + edges[:, at.Edge.length]
    arcs[0] = 0.0
    stretch = way[-1] / arcs[-1]
    own, change = hermite(stretch * arcs, way, flow.T, np.gradient(flow, way, axis=0).T)
    v = block.array(Header.velocity, nodes, 2 * dimension)
    v[1:, :dimension] = [local(block, velocity, point=False) for velocity in own.T[1:]]
    v[:, dimension:] = [stretch * local(block, rate, point=False) for rate in change.T]


def count_from_zero(block: Block) -> None:
    """Forget what finding the start took."""
    from cablemodel.solvers import library as entry

    entry.count_from_zero(block.ints, block.reals)
