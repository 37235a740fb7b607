"""From the scene of a system to a block at its initial state."""

from __future__ import annotations

import copy
import warnings
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import OverturnedStartWarning, SceneError, StaticsError
from cablemodel.scene.sea import sea
from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.start import continuation, firm_friction, sea_floor, search
from cablemodel.solvers.finite_element.start.falling import TIMES, fall
from cablemodel.solvers.finite_element.start.first_state import count_from_zero, hold_supports
from cablemodel.solvers.finite_element.start.refinement import REFINEMENT_ROUNDS
from cablemodel.solvers.finite_element.start.waves import refine_line
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header, Scalars
from cablemodel.systems.built import Built
from cablemodel.systems.clamped_guess import straight_from_clamps, turned_along_clamps
from cablemodel.systems.guess import Guess, first_guess, ways_aside
from cablemodel.systems.joined import joined
from cablemodel.systems.lays import lays, start, without
from cablemodel.systems.lines import nodes_of, steady_velocity
from cablemodel.systems.places import divided, place_nodes, refined
from cablemodel.systems.scene import SystemScene
from cablemodel.systems.stability import Instability, instability, is_pressed
from cablemodel.systems.tables import filled, hold_feet, rest_feet
from cablemodel.systems.tree import tree_of

FloatArray = NDArray[np.float64]

PARTS_ASIDE = 1, 2, 4, 8, 16, 32
"""Of each element, in turn, where lines are drawn aside: some need a sharp bend to hang in."""


def build(scene: SystemScene) -> Built:
    """A block at the system's initial state, t = 0: at rest in the frame of its vessels.

    Raises:
        SceneError: vessels that move apart at t = 0; a winch that runs while its line touches the
            floor.
        StaticsError: no equilibrium was found, or not within `solver.start_time_limit`.

    Warns:
        UnstableStartWarning: the system leaves it by itself, and no other was found.
        OverturnedStartWarning: another was, in which bodies are turned over.
    """
    with search.searching(scene) as sought:
        try:
            apart = lays(scene)
            if not apart:
                return _built(scene, sought, scene)
            rest = without(scene, apart)
            built = None if rest is None else _built(rest, sought, scene)
            starts = [(lay, start(lay, scene)) for lay in apart]
        except search.OutOfTimeError:
            raise sought.gives_up() from None
    whole = joined(scene, built, starts)
    if built is not None:
        whole.unstable, whole.friction_holds = built.unstable, built.friction_holds
    return whole


def _built(scene: SystemScene, sought: search.Search, whole: SystemScene) -> Built:
    """What starts as a system, of a whole whose floor and scales it has."""
    velocity = steady_velocity(scene)
    guess = first_guess(scene, velocity)
    sought.tries("without friction")
    built: Built | None = None
    leaves: Instability | None = None
    try:
        built = _at_rest(scene, sought, guess, velocity, whole)
        leaves = instability(built)
    except StaticsError as error:
        failure = error
    for fits, words in (
        (turned_along_clamps, "the same from bodies turned along what is clamped to them"),
        (straight_from_clamps, "the same from lines straight out of what clamps them"),
    ):
        if built is not None and leaves is None:
            break
        other_guess = fits(scene, guess)
        if other_guess is None:
            continue
        sought.tries(words)
        with suppress(StaticsError, *(() if built is None else (search.OutOfTimeError,))):
            built = _at_rest(scene, sought, other_guess, velocity, whole)
            leaves = instability(built)
    if built is None or (leaves is not None and is_pressed(built)):
        # Slack between two places one above the other is a strut, or hangs doubled in a sharp bend.
        aside = first_guess(scene, velocity, ways_aside(guess))
        aside = turned_along_clamps(scene, aside) or aside
        sought.tries("the same from lines that were drawn aside")
        for parts in PARTS_ASIDE:
            with suppress(StaticsError, *(() if built is None else (search.OutOfTimeError,))):
                other = _at_rest(scene, sought, aside, velocity, whole, parts)
                its = instability(other)
                if built is None or its is None:
                    built, leaves = other, its
                if its is None:
                    break
    if built is None:
        raise failure
    if leaves is not None:
        lasts = _lasting(scene, sought, guess, built, leaves, velocity, whole)
        if lasts is not None:
            built, leaves = lasts, None
            overturned = _overturned(built, guess)
            if overturned:
                warnings.warn(OverturnedStartWarning(overturned), stacklevel=2)
    if leaves is not None:
        warnings.warn(leaves.warning(), stacklevel=2)
    built.unstable = leaves is not None
    if not velocity.any():
        sought.tries("with friction")
        built.friction_holds = _let_friction_hold(built.block)
    _start_flowing(scene, built)
    return built


def _at_rest(
    scene: SystemScene,
    sought: search.Search,
    guess: Guess,
    velocity: FloatArray,
    whole: SystemScene,
    parts: int = 1,
) -> Built:
    """A block in equilibrium, on elements that are fine enough for it.

    parts: into which elements are divided from the first.

    Raises:
        StaticsError: none was found.
    """
    nodes = {name: [divided(own, parts) for own in nodes_of(scene, name)] for name in scene.lines}
    water = sea(scene)
    if water is not None:
        for name, line in scene.lines.items():
            accuracy = scene.solver.tolerance * line.length
            cables = [item.cable for item in line.items if item.cable is not None]
            nodes[name] = refine_line(water, accuracy, cables, nodes[name], guess.lines[name])
    built = _solved(scene, nodes, guess, None, velocity, whole)
    return _refined(scene, sought, guess, built, velocity, whole)


def _refined(
    scene: SystemScene,
    sought: search.Search,
    guess: Guess,
    built: Built,
    velocity: FloatArray,
    whole: SystemScene,
) -> Built:
    """The same equilibrium on elements that are fine enough for it.

    Raises:
        StaticsError: none was found.
    """
    nodes = built.tree.nodes
    for _round in range(REFINEMENT_ROUNDS):
        finer = refined(scene, nodes, built)
        if finer is None:
            break
        nodes = finer
        sought.tries("the same on finer elements")
        built = _solved(scene, nodes, guess, built, velocity, whole)
    if scene.environment.floor is not None:
        sought.tries("the same on elements that are finer at the touchdown")
        _refine_at_floor(scene, built, velocity)
    return built


def _lasting(
    scene: SystemScene,
    sought: search.Search,
    guess: Guess,
    built: Built,
    leaves: Instability,
    velocity: FloatArray,
    whole: SystemScene,
) -> Built | None:
    """A block at the equilibrium to which a system falls from one that does not last; None: it
    falls to none that does, or swings as it leaves."""
    sought.tries("where it falls to from there")
    for _time in range(TIMES):
        if leaves.frequency != 0.0:
            return None
        block = copy.deepcopy(built.block)
        state = block.scalars
        friction, state.friction = state.friction, 0.0
        try:
            fallen = fall(block, velocity.copy(), leaves.rate, leaves.motion, lambda _block: None)
            if fallen is None:
                return None
            state.friction = friction
            built = replace(built, block=fallen.block)
            _come_to_rest(scene, built, velocity)
            built = _refined(scene, sought, guess, built, velocity, whole)
        except (StaticsError, search.OutOfTimeError):
            return None
        still = instability(built)
        if still is None:
            return built
        leaves = still
    return None


def _overturned(built: Built, guess: Guess) -> list[str]:
    """Names of bodies whose vertical axis points the other way than at the first guess."""
    from scipy.spatial.transform import Rotation

    nodes = built.body_nodes()
    turns = Rotation.from_rotvec(built.block.array(Header.position, built.nodes, 6)[nodes, 3:])
    rows = built.block.array(Header.free_bodies, len(nodes), at.FREE_WORDS)
    axes = turns.as_matrix() @ rows[:, at.FreeBody.rotation.span].reshape(-1, 3, 3)
    upright = np.array([guess.axes[name] for name in built.scene.bodies])
    over = np.sum(axes[:, :, 2] * upright[:, :, 2], axis=1) < 0.0
    return [name for name, is_over in zip(built.scene.bodies, over, strict=True) if is_over]


def _let_friction_hold(block: Block) -> bool:
    """Let the floor's friction take hold of lines that lie to anchors, as of a line alone; whether
    it did. Else the start stays as it is."""
    from cablemodel.solvers import library as entry

    if block.header.floor_kind == at.FLOOR_NONE or block.scalars.friction == 0.0:
        return False
    lengths = firm_friction.lengths_of(block)
    if lengths is None:
        return False
    before = block.image.copy()
    entry.lay_to_anchors(block.ints, block.reals)
    if not firm_friction.take_hold(block, lengths):
        block.take(before)
        return False
    hold_supports(block)
    count_from_zero(block)
    if block.header.hybrid:
        entry.choose_bending(block.ints, block.reals)
    return True


def _start_flowing(scene: SystemScene, built: Built) -> None:
    """Velocities of what hangs on winches that pay out from t = 0 on."""
    from cablemodel.solvers import library as entry

    block = built.block
    for number, (name, winch) in enumerate(scene.winches.items()):
        rate = winch.rate_at_start
        if rate == 0.0:
            continue
        row = built.winch(number)
        row.rate = rate
        behind = entry.start_paying_out(block.ints, block.reals, number)
        if block.header.floor_state == at.FLOOR_TOUCHED:
            _refuse_what_touches(scene, built, name, range(int(row.node), behind))


def _refuse_what_touches(scene: SystemScene, built: Built, name: str, hangs: range) -> None:
    """Refuse a winch that runs at t = 0 while some of what hangs on it, nodes, is on the floor."""
    floor = scene.environment.floor
    assert floor is not None
    places = built.block.array(Header.position, built.nodes, 6)[:, :3]
    depth = float(built.block.scalars.floor_depth)
    for node in hangs:
        x, y, z = (places[node] + built.block.scalars.origin).tolist()
        if z - floor.height(x, y) < depth:
            part, arc = built.where(node)
            where = part if part in scene.bodies else f"{part} at {arc:.4g} m"
            winch = scene.winches[name]
            problem = f"{where} touches the sea floor, and {winch.line} is tied to more"
            allowed = "0 m/s at t = 0, or a line by itself, which may end at an anchor"
            raise SceneError.at(f"winches.{name}.rate", winch.rate_at_start, problem, allowed)


def _solved(
    scene: SystemScene,
    nodes: dict[str, list[FloatArray]],
    guess: Guess,
    before: Built | None,
    velocity: FloatArray,
    whole: SystemScene,
) -> Built:
    """A block on given nodes, at rest; from another one on coarser nodes where there is one."""
    from cablemodel.solvers import library as entry

    tree = tree_of(scene, nodes)
    built = filled(scene, tree, guess, before, settings=whole)
    block = built.block
    place_nodes(scene, built, guess, before)
    sea_floor.fill(block, whole)
    block.header.sleep = 0
    entry.place_supports(block.ints, block.reals)
    _come_to_rest(scene, built, velocity)
    return built


def _come_to_rest(scene: SystemScene, built: Built, velocity: FloatArray) -> None:
    """Equilibrium of a block whose nodes are placed.

    Raises:
        StaticsError: none was found.
    """
    from cablemodel.solvers import library as entry

    block = built.block
    ints, reals = block.ints, block.reals
    head = Header(ints)
    state = Scalars(reals)
    solve = partial(search.equilibrium, block, velocity.copy())
    ways: list[Callable[[], int]] = [solve]
    if head.floor_kind:
        harder = continuation.on_hardening_floors
        ways += [partial(harder, block, solve, floors) for floors in continuation.FLOORS]
    # What is free comes to rest without friction; it holds the lines from there.
    friction, state.friction = state.friction, 0.0
    hold_feet(scene, built)
    for attempt in range(2):
        status = continuation.first_of(block, ways)
        if status != at.OK:
            line, arc = built.where(min(block.failed_node, built.nodes - 1))
            raise StaticsError(
                f"no static equilibrium of the system was found; what moved last is {line!r} at "
                f"{arc:g} m. Check weights, lengths and attachments{without_shape(scene)}"
            )
        # The new stiffness changes the forces by a little: the state must meet them.
        if attempt or not entry.stabilise(ints, reals):
            break
    state.friction = friction
    hold_supports(block)
    sea_floor.rest_where_it_is(block)
    rest_feet(scene, built)
    count_from_zero(block)
    if head.hybrid:
        entry.choose_bending(ints, reals)


def without_shape(scene: SystemScene) -> str:
    """Advice about lines that nothing gives a shape while they are slack."""
    limp = {
        name
        for name, kind in scene.cable_types.items()
        if kind.submerged_weight == 0.0 and kind.bending_stiffness == 0.0
    }
    found = [
        name
        for name, line in scene.lines.items()
        if any(item.cable is not None and item.cable.type in limp for item in line.items)
    ]
    if not found:
        return ""
    return (
        f"; cable of {' and '.join(found)} has neither weight in water nor bending stiffness, and "
        "no shape where it is slack: give it some of either"
    )


def _refine_at_floor(scene: SystemScene, built: Built, velocity: FloatArray) -> None:
    """Refine a static shape where it meets the floor, and solve again from its own shape."""
    from cablemodel.solvers import library as entry

    block = built.block
    for _turn in range(REFINEMENT_ROUNDS):
        at_rest = block.image.copy()
        while (changed := entry.refine_at_floor(block.ints, block.reals)) == at.NO_CAPACITY:
            block.take(at_rest)
            block.grow()
            at_rest = block.image.copy()
        if not changed:
            return
        try:
            _come_to_rest(scene, built, velocity)
        except StaticsError:
            block.image[:] = at_rest  # the mesh follows the floor as the run begins
            return
