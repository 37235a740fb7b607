"""From a scene to a block at its initial state."""

from __future__ import annotations

import contextlib
import itertools
import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import (
    DrawnStartWarning,
    SceneError,
    StaticsError,
    SweptStartWarning,
    TautLayWarning,
)
from cablemodel.scene.line import End, Initial
from cablemodel.scene.sea import sea
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.mesh import line_nodes
from cablemodel.solvers.finite_element.start import (
    firm_friction,
    held_line,
    laid_loads,
    laid_shape,
    laid_start,
    line_tables,
    sea_floor,
    tables,
    unstable_start,
    waves,
)
from cablemodel.solvers.finite_element.start.first_shape import (
    along_curve,
    bight,
    first_points,
    graded,
    place_nodes,
)
from cablemodel.solvers.finite_element.start.first_state import (
    count_from_zero,
    find_initial_state,
    solve_static,
    stand_still,
    steady_velocity,
)
from cablemodel.solvers.finite_element.start.frame import vertical_plane
from cablemodel.solvers.finite_element.start.line import Line, lay_out, spans_of
from cablemodel.solvers.finite_element.start.refinement import (
    guess_of,
    halved,
    refine_touchdown,
    refined,
    shape_of,
    spare_nodes,
)
from cablemodel.solvers.finite_element.start.refusals import refuse_unsupported
from cablemodel.solvers.finite_element.start.scales import (
    is_flexible,
    start_conditions,
    tension_scale,
)
from cablemodel.solvers.finite_element.start.search import (
    NotFoundError,
    OutOfTimeError,
    folds,
    searching,
    what_is_hard,
)
from cablemodel.solvers.finite_element.start.strategies import Strategy, described, strategies
from cablemodel.solvers.finite_element.start.winch import Winch, lengths_of, winch_of
from cablemodel.solvers.shared.layout import Header

if TYPE_CHECKING:
    from cablemodel.scene import Scene
from cablemodel.solvers.shared.numbers import PROMISE, REFINEMENT_ROUNDS

FloatArray = NDArray[np.float64]

DRAWN = 0.01
"""Of the largest tension: more where a lay lands is said."""


def build(
    scene: Scene,
    *,
    planar: bool | None = None,
    room: float = 1.0,
    near: FloatArray | None = None,
) -> Block:
    """A block at the scene's initial state, t = 0.

    ``planar``: False forces three dimensions; None and True choose a vertical plane where the
    scene lies in one. ``room``: lengths of line and drum for which there is room, in units of the
    scene's. ``near``: a polyline (n, 3) [m] from which a static start is sought first. A static
    start refines the mesh until its shape is accurate.

    Raises SceneError (not supported, inconsistent), StaticsError (no equilibrium found, or not
    within `solver.start_time_limit`).
    """
    refuse_unsupported(scene)
    first: StaticsError | None = None
    if near is None and scene.rate_at_start > 0.0 and _is_held_under_way(scene):
        near = _near_the_lay(scene, planar)
    with searching(scene) as search:
        nearest = [] if near is None else [Strategy(points=near)]
        for strategy in itertools.chain(nearest, _strategies(scene)):
            sought = (
                scene if strategy.points is None and not scene.starts_steady else _steady(scene)
            )
            built = _built_as_laid if strategy.as_laid else _built_as_lay
            search.tries(described(strategy))
            try:
                found = built(sought, planar, room, strategy)
                if laid_start.applies(sought):
                    _say_what_friction_lacks(found, sought, as_laid=strategy.as_laid)
                _say_what_is_taut(found, sought)
                flexible = any(is_flexible(sought, cable) for cable in sought.cables)
                found.header.lays_slack = int(flexible and laid_loads.lays_slack(sought))
                if _is_held_under_way(scene):
                    _refuse_what_pushes(found, scene)
                _unfold(found, scene, planar)
                return found
            except OutOfTimeError:
                points = ", or start from initial: {straight: ...} or {points: ...}"
                raise search.gives_up(what_is_hard(scene), points) from None
            except StaticsError as problem:
                if not strategy.as_laid:  # without friction it may come to rest
                    first = first or problem
    assert first is not None
    if isinstance(first, NotFoundError):
        first = search.ends_without(first, what_is_hard(scene), _advice(scene))
    raise first from None


def _advice(scene: Scene) -> str:
    """What to do about a scene for which no start was found."""
    advice = "Check weights, ends and current"
    if scene.environment.floor is not None and scene.end.kind == "free":
        if folds(scene) and scene.environment.current is None:
            advice = "Give the cable more bending stiffness"
        advice += ", let motion, pay-out and current come up from zero after the start"
    return f"{advice}, or start from initial: {{straight: ...}} or {{points: ...}}"


def _is_held_under_way(scene: Scene) -> bool:
    """Whether a static start is asked for of a line to an anchor while its vessel moves."""
    moves = bool(np.any(laid_loads.lay_motion(scene)[0]))
    return scene.starts_at_rest and scene.end.kind == "anchor" and moves


def _near_the_lay(scene: Scene, planar: bool | None) -> FloatArray | None:
    """A first shape of a lay to an anchor, from that with a free end (n, 3) [m]; None: there is no
    such lay."""
    laid_loads.check_steady(scene)
    free = scene.model_copy(update={"end": End.model_validate("free")})
    with contextlib.suppress(StaticsError):
        return drawn_to(build(free, planar=planar), np.asarray(scene.end.position))
    return None


def drawn_to(block: Block, anchor: FloatArray) -> FloatArray:
    """The shape of a line, drawn to an anchor (3,) by more and more of it, (n, 3) [m]."""
    points, arcs = shape_of(block)
    return points + np.outer(arcs / arcs[-1], anchor - points[-1])


def promised_tension(block: Block, scene: Scene) -> float:
    """What tensions of a start may be wrong by [N]."""
    means = block.array(Header.tension, int(block.header.nodes), 2)[1:, 0]
    return PROMISE * scene.solver.tolerance * float(np.abs(means).max())


def _refuse_what_pushes(block: Block, scene: Scene) -> None:
    """Refuse a lay that would push its anchor: what lies would fold."""
    means = block.array(Header.tension, int(block.header.nodes), 2)[1:, 0]
    pressed, anchor = -float(means.min()), scene.end.position
    assert anchor is not None
    if pressed > promised_tension(block, scene):
        problem = f"what lies would push it by {pressed:.3g} N: a lay to it takes less cable"
        if scene.environment.floor is not None and np.any(laid_loads.slopes(scene, *anchor[:2])):
            problem += ", or slides down to it"
        raise SceneError.at("end.anchor", anchor, problem, "one farther away, or a free end")


def _say_what_friction_lacks(block: Block, scene: Scene, *, as_laid: bool) -> None:
    """Warn where friction does not hold what lies, and of a lay whose slope draws at it, where no
    start was found in which friction does."""
    needed = laid_start.asked_of_friction(block, scene)
    if needed > 1.0:
        warnings.warn(SweptStartWarning(needed), stacklevel=3)
    if as_laid or scene.rate_at_start <= 0.0 or not block.scalars.laid:
        return
    tension, most = _tension_at_the_touchdown(block, scene)
    if abs(tension) > DRAWN * most:
        floor = scene.environment.floor
        slopes = floor is not None and (floor.z is None or any(floor.slope))
        by = ["its own weight down the slope"] * slopes
        by += ["the current"] * (scene.environment.current is not None)
        warnings.warn(DrawnStartWarning(tension, " and ".join(by) or "its drag"), stacklevel=3)


def _say_what_is_taut(block: Block, scene: Scene) -> None:
    """Warn of a lay that pays out less than it takes."""
    rate, floor = scene.rate_at_start, scene.environment.floor
    if not laid_start.is_lay(scene) or floor is None:
        return
    needed = laid_loads.lay_rate(scene)
    if laid_loads.becomes_taut(scene):
        where = "over these ridges" if floor.z is None else "down this slope"
        warnings.warn(TautLayWarning(rate, needed, None, where), stacklevel=3)
    elif laid_loads.is_dragged(scene) and laid_start.which_lie(block, scene).any():
        tension = _tension_at_the_touchdown(block, scene)[0]
        warnings.warn(TautLayWarning(rate, needed, tension), stacklevel=3)


def _tension_at_the_touchdown(block: Block, scene: Scene) -> tuple[float, float]:
    """Of a lay: tension where it lands, and the largest [N]."""
    hangs = np.flatnonzero(~laid_start.which_lie(block, scene))
    tension = block.array(Header.tension, int(block.header.nodes), 2)[:, 0]
    lands = min(int(hangs[-1]) + 2, len(tension) - 1)  # below the last place that is clear
    return float(tension[lands]), float(tension.max())


def _strategies(scene: Scene) -> Iterator[Strategy]:
    """All strategies for a scene; of points that take a steady motion, those from them last."""
    if not scene.starts_steady:
        yield from strategies(scene)
        return
    steady = _steady(scene)
    yield from strategies(steady)
    points = np.asarray(scene.initial.points, dtype=np.float64)
    if laid_start.applies(steady):
        yield Strategy(as_laid=True, points=points)
    yield Strategy(points=points)


def _steady(scene: Scene) -> Scene:
    """The scene with a static start in place of points that take a steady motion."""
    return scene.model_copy(update={"initial": Initial.model_validate("static")})


def _built_as_laid(scene: Scene, planar: bool | None, room: float, strategy: Strategy) -> Block:
    """What friction holds, from where it lies at coarser tolerances."""
    coarser = laid_start.coarser(scene)
    if coarser is None:
        return _built_as_lay(scene, planar, room, strategy)
    lies = _built_as_laid(coarser, planar, 1.0, replace(strategy, intermediate=True))
    try:
        return _built(scene, planar, room, replace(strategy, lies=lies))
    except StaticsError:
        return _built(scene, planar, room, strategy)  # anew, from the first shape


def _built_as_lay(scene: Scene, planar: bool | None, room: float, strategy: Strategy) -> Block:
    """What a lay has laid: at once; or of cable that gets its momentum bit by bit, where that is
    large; or from cable that bends less and less so; or from where it lies on a floor that is
    softer, at a coarser tolerance."""
    if laid_start.outruns_its_foot(scene):
        with contextlib.suppress(StaticsError):
            return _built(scene, planar, room, replace(strategy, at_once=True, comes_up=True))
    softer = laid_start.on_softer_floor(scene)
    try:
        return _built_from_stiffer(scene, planar, room, strategy, patient=softer is None)
    except StaticsError:
        if softer is None:
            raise
        lies = _built_as_lay(softer, planar, 1.0, replace(strategy, intermediate=True))
    return _built(scene, planar, room, replace(strategy, lies=lies, at_once=True))


def _built_from_stiffer(
    scene: Scene, planar: bool | None, room: float, strategy: Strategy, *, patient: bool
) -> Block:
    """A lay at once, or from cable that bends less and less so; patient: the stiffest of them on
    floors that harden.

    Where the layer in which a cable bends on to the floor is thin beside the line, a first shape
    is far from rest: what it lacks pushes what lies, and that folds. A stiffer one does not; where
    it lies thinner ones stay.
    """
    layers = laid_start.stiffer_layers(scene)
    if not layers:
        return _built(scene, planar, room, strategy)
    at_once = replace(strategy, at_once=True)
    try:
        return _built(scene, planar, room, at_once)
    except StaticsError:
        pass
    layer, own = layers
    step = laid_start.STEP_OF_LAYER
    stiff = partial(laid_start.stiffer, scene)
    stiffest = replace(strategy if patient else at_once, intermediate=True)
    lies = _built(stiff(layer), planar, 1.0, stiffest)
    while True:
        thinner = max(own, layer / step)
        try:
            if thinner == own:
                return _built(scene, planar, room, replace(at_once, lies=lies))
            lies = _built(
                stiff(thinner), planar, 1.0, replace(at_once, lies=lies, intermediate=True)
            )
            layer = thinner
        except StaticsError:
            step = math.sqrt(layer / thinner)
            if step < laid_start.SMALLEST_STEP_OF_LAYER:
                raise


def _first_guess(
    scene: Scene, strategy: Strategy, scale: float
) -> tuple[laid_shape.Guess, list[FloatArray]]:
    """A first shape, and nodes that are fine enough for it. scale: a typical tension [N]."""
    hangs = hung = None
    if strategy.lies is not None:
        guess = guess_of(strategy.lies, scene)
    elif strategy.points is not None:
        guess = laid_shape.Guess(strategy.points)
    else:
        position = scene.motion().evaluate(0.0)[0]
        hung = held_line.hung(scene, position) if strategy.hung else None
        points = first_points(scene, position, swept=strategy.swept)
        hangs = bight(scene, position) if strategy.bight else None
        if hangs is not None:
            points = hangs.points
        guess = hung or laid_shape.on_floor(
            scene, points, drawn=strategy.swept, upright=strategy.upright
        )
    points = guess.points
    given = scene.initial.points
    sea_floor.check(scene, points if given is None else np.asarray(given, dtype=np.float64))
    nodes = line_nodes(spans_of(scene, scale), scene.solver.tolerance, start_conditions(scene))
    if hangs is not None:
        nodes = graded(scene, nodes, hangs.bends, hangs.layers)
    if hung is not None:
        nodes = held_line.graded(scene, nodes, hung)
    nodes = laid_shape.refine_guess(scene, nodes, guess)
    if given is not None:
        nodes = along_curve(scene, nodes, points)
    nodes = waves.refine(scene, nodes, points)
    if strategy.halved:
        nodes = halved(scene, nodes)
    return guess, nodes


def _built(
    scene: Scene,
    planar: bool | None,
    room: float,
    strategy: Strategy,
) -> Block:
    scale = tension_scale(scene)
    guess, nodes = _first_guess(scene, strategy, scale)
    find = partial(find_initial_state, scene=scene, strategy=strategy)
    build_on = partial(_build_on, scene, scale=scale, planar=planar, room=room)
    if scene.initial.kind != "static":
        return build_on(nodes, guess, find=find)

    stays = strategy.as_laid and scene.rate_at_start > 0.0 and not laid_loads.is_dragged(scene)

    def finer_block(nodes: list[FloatArray], block: Block) -> Block:
        """On more nodes, from a block; what has been laid stays where it is in that."""
        guess = guess_of(block, scene)
        if stays:
            held = partial(find, strategy=replace(strategy, lies=block))
            try:
                return build_on(nodes, guess, find=held)
            except StaticsError:
                pass  # it is laid anew
        return build_on(nodes, guess, find=find)

    def start(nodes: list[FloatArray], guess: laid_shape.Guess) -> Block:
        block = build_on(nodes, guess, find=find)
        for _round in range(REFINEMENT_ROUNDS):
            finer = refined(block, scene, nodes)
            if finer is None:
                break
            try:
                block = finer_block(finer, block)
            except StaticsError:
                if not stays:
                    raise
                break  # what has been laid is at rest on the mesh before it
            nodes = finer
        refine_touchdown(block, scene, strategy)
        if stays:
            frame = steady_velocity(block, scene)
            solve_static(block, scene, frame, replace(strategy, lets_go=True))
            count_from_zero(block)
        if firm_friction.applies(scene):
            firm_friction.take_hold(block)
            count_from_zero(block)
        return block

    stand = partial(build_on, find=partial(stand_still, scene=scene))
    ways = unstable_start.Ways(stand, start, in_place=strategy.as_laid)
    found = start(nodes, guess)
    return found if strategy.intermediate else unstable_start.left(found, scene, ways)


def _build_on(
    scene: Scene,
    nodes: list[FloatArray],
    guess: laid_shape.Guess,
    *,
    scale: float,
    planar: bool | None,
    room: float,
    find: Callable[[Block], None],
) -> Block:
    """A block on given nodes, from a first guess of its shape.

    nodes: arc lengths of the nodes of every cable [m], each from 0 to its length. find: brings the
    block to its first state, from that shape.
    """
    from cablemodel.solvers import library as entry

    line = lay_out(scene, nodes)
    winch = winch_of(scene, line, room)
    kept = winch.extra_nodes + sea_floor.spare_nodes(scene)
    bends = spare_nodes(scene, line.nodes, room)
    block = _allocate(scene, line, winch, kept + bends)
    block.scalars.most_nodes = line.nodes + bends
    _choose_frame(block, scene, guess.points, planar)
    block.header.nodes = line.nodes
    tables.fill_settings(block, scene)
    tables.fill_motion(block, scene.motion().pieces)
    lengths = lengths_of(scene)
    entry.measure(block.ints, block.reals, lengths, tables.facts_of(scene, scale))
    tables.fill_current(block, scene)
    line_tables.fill_cables(block, scene, winch)
    line_tables.fill_edges(block, scene, line)
    tables.fill_payout(block, scene)
    line_tables.fill_bodies(block, scene, line)
    tables.fill_constraints(block, scene, line)
    entry.arrange(block.ints, block.reals, lengths)
    place_nodes(block, line, guess, scene.line_length)
    sea_floor.fill(block, scene)
    if scene.environment.floor is not None:
        block.scalars.laid = laid_loads.laid(scene)
    waves.fill(block, sea(scene), scene.solver.tolerance)
    sea_floor.place_of_rest(block, scene)
    find(block)
    return block


def _clamps(scene: Scene) -> list[FloatArray]:
    """Directions of the clamps (3,)."""
    ends = scene.vessel.connection, scene.end.connection
    return [np.asarray(end.direction, dtype=float) for end in ends if end.kind == "clamped"]


def _unfold(block: Block, scene: Scene, planar: bool | None) -> None:
    """Into space, where a start was sought in its plane and the scene leaves that. In space a lay
    that hangs in a plane folds out of it on its way to where it lies."""
    from cablemodel.solvers import library as entry

    if block.header.dimension == 3:
        return
    plane = np.array([*block.scalars.plane, 0.0])
    if planar is False or vertical_plane(scene, [plane, *_clamps(scene)]) is None:
        entry.to_three_dimensions(block.ints, block.reals)
        entry.place_supports(block.ints, block.reals)


def _allocate(scene: Scene, line: Line, winch: Winch, spare: int) -> Block:
    """A block of zeros with room for the line, and for the nodes that a run may add to it."""
    current = scene.environment.current
    water = sea(scene)
    return Block(
        capacity=line.nodes + spare,
        pieces=1 + len(scene.motion().pieces),
        depths=1 if current is None else len(current.z),
        times=1 if current is None else len(current.t),
        strain_words=sum(
            len(scene.cable_types[cable.type].strain_coefficients) for cable in winch.cables
        ),
        bodies=len(line.bodies),
        constraints=2 if scene.end.kind == "anchor" else 1,
        rates=len(scene.payout.rate),
        cables=len(winch.cables),
        floor_words=sea_floor.table_words(scene.environment.floor),
        waves=0 if water is None else len(water.amplitude),
        cell_terms=waves.cell_terms(water),
        winches=1,
        lines=1,
    )


def _choose_frame(block: Block, scene: Scene, points: FloatArray, planar: bool | None) -> None:
    """The block's coordinates: in the scene's vertical plane or in space, from the tow point."""
    position = scene.motion().evaluate(0.0)[0]
    directions = [p - position for p in points] + _clamps(scene)
    if isinstance(scene.initial.velocities, tuple):
        directions += [np.asarray(velocity, dtype=float) for velocity in scene.initial.velocities]
    plane = None if planar is False else vertical_plane(scene, directions)
    if plane is None and laid_start.is_lay(scene):
        plane = vertical_plane(scene, directions, start=True)
    block.header.dimension = 3 if plane is None else 2
    block.scalars.origin = position
    block.scalars.plane = (1.0, 0.0) if plane is None else plane
