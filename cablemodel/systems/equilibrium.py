"""The equilibrium in which a system starts: where it is sought, and how it is found.

A relaxation's long steps damp what grows, too, and may end where the system does not stay: a body
stands on its string, slack between two places is a strut. Such a start is sought anew from other
first shapes, then where it falls to.
"""

from __future__ import annotations

import copy
import warnings
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import OverturnedStartWarning, StaticsError
from cablemodel.solvers.finite_element.start import sea_floor, search
from cablemodel.solvers.finite_element.start.falling import TIMES, fall
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import NO_CAPACITY, OK, SEARCH, Header, Settling
from cablemodel.systems.built import Built
from cablemodel.systems.clamped_guess import straight_from_clamps, turned_along_clamps
from cablemodel.systems.guess import Guess, drawn_aside, first_guess, shape_of
from cablemodel.systems.lines import nodes_of, steady_velocity
from cablemodel.systems.places import divided
from cablemodel.systems.scene import SystemScene
from cablemodel.systems.stability import Instability, instability, is_pressed
from cablemodel.systems.tables import filled, hold_feet
from cablemodel.systems.tree import tree_of

FloatArray = NDArray[np.float64]

PARTS_ASIDE = 1, 2, 4, 8, 16, 32
"""Of each element, in turn, where lines are drawn aside: some need a sharp bend to hang in."""
FINER = (
    "",
    "the same on finer elements",
    "the same on elements that are finer at the touchdown",
)
"""What is told of a search, by its stage."""

HEELED = 0.5
"""By more than that a body's vertical axis turns in a start that is told of [rad]."""


@dataclass(frozen=True)
class Equilibria:
    """A search for one."""

    scene: SystemScene
    whole: SystemScene
    """The scene whose floor and scales it has."""
    sought: search.Search
    velocity: FloatArray
    """Of the frame in which it is at rest (3,) [m/s]."""
    guess: Guess
    """The first one of its shape."""

    @classmethod
    def of(cls, scene: SystemScene, whole: SystemScene, sought: search.Search) -> Equilibria:
        """A search of a scene that is all of a whole, or a part that starts by itself."""
        velocity = steady_velocity(scene)
        return cls(scene, whole, sought, velocity, first_guess(scene, velocity))

    def find(self) -> Built:
        """A block at an equilibrium, at one that lasts if any was found.

        Raises:
            StaticsError: none was found.

        Warns:
            UnstableStartWarning: the system leaves it by itself, and no other was found.
            OverturnedStartWarning: another was, to which bodies turn.
        """
        built, leaves = self._from_first_shapes()
        if leaves is not None:
            lasts = self._fallen(built, leaves)
            if lasts is not None:
                built, leaves = lasts, None
                overturned = _overturned(built, self.guess)
                if overturned:
                    warnings.warn(OverturnedStartWarning(overturned), stacklevel=2)
        if leaves is not None:
            warnings.warn(leaves.warning(), stacklevel=2)
        built.unstable = leaves is not None
        return built

    def _from_first_shapes(self) -> tuple[Built, Instability | None]:
        """A block at the equilibrium near a first shape, and how the system leaves it.

        Raises:
            StaticsError: none was found.
        """
        built: Built | None = None
        leaves: Instability | None = None
        self.sought.tries("without friction")
        try:
            built = self._at_rest(self.guess)
            leaves = instability(built)
        except StaticsError as error:
            failure = error
        for fits, words in (
            (turned_along_clamps, "the same from bodies turned along what is clamped to them"),
            (straight_from_clamps, "the same from lines straight out of what clamps them"),
        ):
            if built is not None and leaves is None:
                return built, None
            guess = fits(self.scene, self.guess)
            if guess is None:
                continue
            self.sought.tries(words)
            with _failures_pass(built):
                built = self._at_rest(guess)
                leaves = instability(built)
        if built is None or (leaves is not None and is_pressed(built)):
            # Slack between two places one above the other is a strut, or hangs doubled in a sharp
            # bend.
            guess = drawn_aside(self.scene, self.guess)
            guess = turned_along_clamps(self.scene, guess) or guess
            self.sought.tries("the same from lines that were drawn aside")
            for parts in PARTS_ASIDE:
                with _failures_pass(built):
                    other = self._at_rest(guess, parts)
                    its = instability(other)
                    if built is None or its is None:
                        built, leaves = other, its
                    if its is None:
                        break
        if built is None:
            raise failure
        return built, leaves

    def _at_rest(self, guess: Guess, parts: int = 1) -> Built:
        """A block in equilibrium, on elements that are fine enough for it.

        parts: into which elements are divided from the first.

        Raises:
            StaticsError: none was found.
        """
        built = placed(self.scene, self.whole, guess, parts)
        self._settle(built)
        return built

    def _fallen(self, built: Built, leaves: Instability) -> Built | None:
        """A block at the equilibrium to which the system falls from one that does not last; None:
        it falls to none that does, or swings as it leaves."""
        self.sought.tries("where it falls to from there")
        for _time in range(TIMES):
            if leaves.frequency != 0.0:
                return None
            block = copy.deepcopy(built.block)
            state = block.scalars
            friction, state.friction = state.friction, 0.0
            frame = self.velocity.copy()
            try:
                fallen = fall(block, frame, leaves.rate, leaves.motion)
                if fallen is None:
                    return None
                state.friction = friction
                built = replace(built, block=fallen.block)
                self._settle(built)
            except (StaticsError, search.OutOfTimeError):
                return None
            still = instability(built)
            if still is None:
                return built
            leaves = still
        return None

    def _settle(self, built: Built) -> None:
        """Equilibrium of a block whose nodes are placed, on elements that are fine enough for it.

        Raises:
            StaticsError: none was found.
        """
        from cablemodel.solvers import library as entry

        block = built.block
        at = Settling(np.zeros(Settling.WORDS), 0)
        kept = np.empty(2 * len(block.image))
        status: int = OK
        stage, rounds, way = 0.0, 0.0, 0.0
        while True:
            status = entry.go_on_settling(block.ints, block.reals, status, at._words, kept)
            if status == NO_CAPACITY:
                block.grow()
                kept = np.empty(2 * len(block.image))
                continue
            if status != SEARCH:
                break
            if (at.stage, at.rounds) != (stage, rounds):
                stage, rounds = at.stage, at.rounds
                self.sought.tries(FINER[int(stage)])
            if at.begins or at.way != way:
                hold_feet(self.scene, built)
            way = at.way
            status = search.equilibrium(block, self.velocity.copy())
        if status != OK:
            line, arc = built.where(min(block.failed_node, built.nodes - 1))
            advice = without_shape(self.scene) + held_by_nothing(self.scene)
            advice += branches_in_a_circle(self.scene)
            raise StaticsError(
                f"no static equilibrium of the system was found; what moved last is {line!r} "
                f"at {arc:g} m. Check weights, lengths and attachments{advice}"
            )


def placed(scene: SystemScene, whole: SystemScene, guess: Guess, parts: int = 1) -> Built:
    """A block along a first shape; arguments: see Equilibria."""
    from cablemodel.solvers import library as entry

    built = _laid_out(scene, whole, guess, parts)
    block, shape = built.block, guess.table()
    while entry.place_on_shape(block.ints, block.reals, shape) == NO_CAPACITY:
        block.grow()
    entry.place_supports(block.ints, block.reals)
    return built


def _laid_out(scene: SystemScene, whole: SystemScene, guess: Guess, parts: int = 1) -> Built:
    """A block whose nodes are nowhere yet, on elements that waves have not shortened."""
    nodes = {name: [divided(own, parts) for own in nodes_of(scene, name)] for name in scene.lines}
    built = filled(scene, tree_of(scene, nodes), guess, settings=whole)
    sea_floor.fill(built.block, whole)
    built.block.header.sleep = 0
    return built


def first_along(scene: SystemScene) -> tuple[Built, FloatArray]:
    """A block for its first shape, and that as the kernels know it, whose ends know their rows of
    the block's constraints."""
    guess = first_guess(scene, steady_velocity(scene))
    built = _laid_out(scene, scene, guess)
    rows = {
        (held.line, int(held.end is scene.lines[held.line].end)): row
        for row, held in enumerate(built.tree.held)
    }
    return built, shape_of(scene, steady_velocity(scene), rows)


def _failures_pass(built: Built | None) -> suppress:
    """Go on where an attempt fails; where there is a block already also when there is no time."""
    return suppress(StaticsError, *(() if built is None else (search.OutOfTimeError,)))


def _overturned(built: Built, guess: Guess) -> dict[str, float]:
    """Bodies whose vertical axis has turned from the first guess by more than `HEELED`, and by how
    much [rad]."""
    from scipy.spatial.transform import Rotation

    nodes = built.body_nodes()
    turns = Rotation.from_rotvec(built.block.array(Header.position, built.nodes, 6)[nodes, 3:])
    rows = built.block.array(Header.free_bodies, len(nodes), at.FREE_WORDS)
    axes = turns.as_matrix() @ rows[:, at.FreeBody.rotation.span].reshape(-1, 3, 3)
    upright = np.array([guess.axes[name] for name in built.scene.bodies])
    cosines = np.sum(axes[:, :, 2] * upright[:, :, 2], axis=1)
    angles = zip(built.scene.bodies, np.arccos(np.clip(cosines, -1.0, 1.0)), strict=True)
    return {name: float(angle) for name, angle in angles if angle > HEELED}


def held_by_nothing(scene: SystemScene) -> str:
    """Advice about lines that are tied to no vessel or anchor."""
    found = [name for name in scene.lines if not scene.held_with(name)]
    if not found:
        return ""
    return f"; nothing holds {' and '.join(found)}: no vessel and no anchor is tied to them"


def branches_in_a_circle(scene: SystemScene) -> str:
    """Advice about lines each of which begins or ends on the next, and the last on the first."""
    on = {
        name: list(dict.fromkeys(end.line for end in line.ends if end.line is not None))
        for name, line in scene.lines.items()
    }
    for first in on:
        ways, seen = [[first]], {first}
        while ways:
            way = ways.pop(0)
            for other in on[way[-1]]:
                if other == first:
                    told = " on ".join([*way, other])
                    return f"; branches go in a circle, {told}: let one begin or end elsewhere"
                if other not in seen:
                    seen.add(other)
                    ways.append([*way, other])
    return ""


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
