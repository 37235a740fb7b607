"""From an unstable equilibrium along the motion that grows, towards one that lasts.

Implicit steps, each from rest and so short that nothing grows faster than they last: longer ones
would lead back.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.finite_element.stability import is_held, slowest_growth
from cablemodel.solvers.finite_element.start import search
from cablemodel.solvers.shared.layout import Header, Scalars

FloatArray = NDArray[np.float64]

PUSH = 1e-3
"""How far it is pushed off, in units of the line's length, at most."""
UNSTABLE_TURN = 0.05
"""How far a slope or a body is turned by that, at most."""
UNSTABLE_SHARE = 0.7
"""The first step, in units of the time in which the motion grows by e."""
UNSTABLE_STEPS = 100
"""To the next equilibrium, at most."""
UNSTABLE_SHORTEST = 1e-4
"""Step in units of the first one, below which there is no way on."""
AT_REST = 1e-6
"""What a long step moves a line by that has come to rest, in units of its length."""
TIMES = 3
"""Equilibria that are left in turn, at most."""
FALLS_SHORTER = 0.25
"""Of a step that fails: the next one."""


@dataclass(frozen=True)
class Fallen:
    """Where a fall has led."""

    block: Block
    rests: bool
    """Long steps move it no more; else it has not got there in the steps that it may take."""


def _as_they_are(_block: Block) -> None:
    """No other elements."""


def fall(
    block: Block,
    frame: FloatArray,
    rate: float,
    motion: FloatArray,
    finer: Callable[[Block], Block | None] = _as_they_are,
) -> Fallen | None:
    """Push a block off its equilibrium, in place, and follow it; None: there is no way on.

    Args:
        frame: velocity of the frame in which it rests (dimension,) [m/s].
        rate: of the motion's growth [1/s].
        motion: of places and slopes of the nodes, (nodes, 2, dimension): 1 m where places move
            most.
        finer: the same on elements that are fine enough for it, where a step fails; None: these
            are.
    """
    length = float(block.scalars.length)
    slowest = slowest_growth(block)
    turned = float(np.linalg.norm(motion[:, 1], axis=1).max())
    places = _motion_of(block)
    places += min(PUSH * length, UNSTABLE_TURN / max(turned, 1e-300)) * motion
    dt = UNSTABLE_SHARE / rate
    shortest = UNSTABLE_SHORTEST * dt
    for _step in range(UNSTABLE_STEPS):
        while dt > shortest and not is_held(block, 1.0 / dt):
            dt *= 0.5
        before = places.copy()
        _step_from_rest(block, frame, dt)
        moved = float(np.linalg.norm(places[:, 0] - before[:, 0], axis=1).max())
        if moved == 0.0:  # it did not converge, or not without a fold
            other = finer(block)
            if other is not None:
                block, places = other, _motion_of(other)
            dt *= FALLS_SHORTER
            if dt < shortest:
                return None
        elif dt * slowest > 1.0 and moved < AT_REST * length:
            return Fallen(block, rests=True)
        elif is_held(block, 0.5 / dt):
            dt *= 2.0
    return Fallen(block, rests=False)


def _motion_of(block: Block) -> FloatArray:
    """Places and slopes of the nodes, a view (nodes, 2, dimension) [m, -]."""
    dimension = int(block.header.dimension)
    return block.array(Header.position, int(block.header.nodes), 2, dimension)


def _step_from_rest(block: Block, frame: FloatArray, dt: float) -> None:
    """One implicit step [s] with everything that depends on time as it is; or none, in place."""
    ints, reals = block.ints, block.reals
    head = Header(ints)
    state = Scalars(reals)
    kept = int(head.maximum_steps), float(state.first_step)
    head.maximum_steps, state.first_step = 1, dt
    search.equilibrium(block, frame)
    head.maximum_steps, state.first_step = kept
