"""Static equilibria that are not found from the first shape: on the way over easier ones.

Each begins from the shape of the one before, and the last one is that of the scene: what is
accepted is the same as what is found at once.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

from cablemodel.solvers.finite_element.block import Block
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header
from cablemodel.solvers.shared.numbers import HARDENING, TURNED_BACK

FloatArray = NDArray[np.float64]

FLOORS = HARDENING[:4], HARDENING[4:7], HARDENING[7:]
"""Floors on which a start is tried in turn where it fails, in units of the contact layer."""
LARGEST_SOFTENING, SMALLEST_SOFTENING, CONTINUATION_SOFTEST = 10.0, 1.05, 1e4
"""Factors between the depths of two contact layers on the way of a lay, and of the softest one."""
CONTINUATION_GROWTH = 1.5
"""Of a step on a way over easier equilibria, after one that was followed."""
FEW_STEPS = 200
"""Of a relaxation on that way."""
LEAST_MOMENTUM, MORE_MOMENTUM, CONTINUATION_SMALLEST_SHARE = 0.1, 0.3, 0.02
"""Of the mass of a lay's cable: what it has at first, by how much more it gets, and the smallest
step of that where longer ones fail."""
CONTINUATION_LARGEST_TURN = 0.25
"""Of a clamp, from one equilibrium to the next [rad]."""
SMALLEST_TURN = 0.01
"""The same, where longer ones fail [rad]."""


def first_of(block: Block, ways: Sequence[Callable[[], int]]) -> int:
    """Equilibrium by the first way that finds one, each from the present guess; a status."""
    guess = block.image.copy()
    status: int = at.STATICS_FAILED
    for way in ways:
        block.image[:] = guess
        status = way()
        if status == at.OK:
            break
    return status


def continued(
    block: Block,
    solve_at: Callable[[float], int],
    *,
    done: float = 0.0,
    step: float,
    smallest: float,
    largest: float = 1.0,
) -> int:
    """Equilibria along a way to its end, 1, each from the shape of the one before; a status.

    Steps grow where they can be followed, and are halved where they cannot.

    Args:
        solve_at: equilibrium at a share of the way, a status.
        done: the share at which the block is in equilibrium.
        step: the first one; smallest: that is not halved; largest: of all.
    """
    status: int = at.OK
    while done < 1.0:
        before = block.image.copy()
        share = min(1.0, done + step)
        status = solve_at(share)
        if status == at.OK:
            done, step = share, min(CONTINUATION_GROWTH * step, largest)
        elif step > smallest:
            block.image[:] = before
            step *= 0.5
        else:
            break
    return status


def on_hardening_floors(block: Block, solve: Callable[[], int], softer: Sequence[float]) -> int:
    """Equilibrium on floors that harden, each from the shape on the one before; a status.

    Where long elements go over humps, contact on a hard floor comes and goes from one iterate to
    the next.

    Args:
        solve: equilibrium of the block as it is, a status.
        softer: the floors, in units of the contact layer.
    """
    depth = block.scalars.floor_depth
    status: int = at.OK
    for softness in softer:
        block.scalars.floor_depth = softness * depth
        status = solve()
        if status != at.OK:
            break
    block.scalars.floor_depth = depth
    return status


def in_few_steps(block: Block, solve: Callable[[], int], few: int = FEW_STEPS) -> int:
    """What ``solve`` finds in a relaxation of few steps; a status."""
    most = int(block.header.maximum_steps)
    block.header.maximum_steps = min(most, few)
    status = solve()
    block.header.maximum_steps = most
    return status


def on_a_floor_that_hardens(block: Block, solve: Callable[[], int]) -> int:
    """Equilibrium at once, or on floors that harden by as much as can be followed; a status.

    A search that leads anywhere from the shape on a slightly softer floor takes few steps, so each
    is given few, and a step in the floor's stiffness that was too long costs little.

    Args:
        solve: equilibrium of the block as it is, a status.
    """
    depth = float(block.scalars.floor_depth)
    guess = block.image.copy()
    whole = math.log(CONTINUATION_SOFTEST)

    def on(share: float) -> int:
        """As it is at 1, softest at 0."""
        block.scalars.floor_depth = depth * CONTINUATION_SOFTEST ** (1.0 - share)
        status = in_few_steps(block, solve)
        block.scalars.floor_depth = depth
        return status

    status, share, step = on(1.0), 1.0, math.log(LARGEST_SOFTENING) / whole
    while status != at.OK and share > 0.5 * step:  # a floor soft enough to begin with
        share -= step
        block.image[:] = guess
        status = on(share)
    if status != at.OK:
        return status
    smallest = math.log(SMALLEST_SOFTENING) / whole
    return continued(block, on, done=share, step=step, smallest=smallest, largest=step)


def as_momentum_comes_up(block: Block, solve: Callable[[], int]) -> int:
    """Equilibrium of cable that runs out from light to heavy, its weight as it is; a status.

    At rest mass counts by the momentum alone that the cable takes along. Above the foot of a lay
    the tension is less than that, m V^2: there a bend makes itself sharper on the way to a shape at
    rest, over more of the line the heavier it is.

    Args:
        solve: equilibrium of the block as it is, a status.
    """
    edges = block.array(Header.edges, int(block.header.nodes), at.EDGE_WORDS)
    columns = [at.Edge.mass.word, at.Edge.added_mass.word]
    whole = edges[:, columns].copy()

    def with_share(share: float) -> int:
        edges[:, columns] = share * whole
        status = solve()
        edges[:, columns] = whole
        return status

    status = with_share(LEAST_MOMENTUM)
    if status != at.OK:
        return status
    return continued(
        block,
        with_share,
        done=LEAST_MOMENTUM,
        step=MORE_MOMENTUM,
        smallest=CONTINUATION_SMALLEST_SHARE,
    )


def with_turned_clamps(
    block: Block, solve: Callable[[], int], solve_nearby: Callable[[], int]
) -> int:
    """Equilibrium of the line with its ends hinged, then clamped and turned bit by bit; a status.

    A clamp that turns a stiff line back folds it, where the line gets there at once.

    Args:
        solve: equilibrium of the block as it is, from any guess, a status.
        solve_nearby: the same from a guess that is nearly one.
    """
    nodes, dimension = int(block.header.nodes), int(block.header.dimension)
    table = block.array(Header.constraints, int(block.header.constraint_count), at.CONSTRAINT_WORDS)
    clamped = table[table[:, at.Constraint.clamped] != 0.0]  # a copy
    rows = np.flatnonzero(table[:, at.Constraint.clamped] != 0.0)
    if not len(rows):
        return at.STATICS_FAILED
    ends = clamped[:, at.Constraint.node].astype(int)
    directions = slice(at.Constraint.direction.word, at.Constraint.direction.word + dimension)
    q = block.array(Header.position, nodes, 2 * dimension)
    places, slopes = q[:, :dimension], q[:, dimension:]
    table[rows, at.Constraint.clamped] = 0.0
    for end in ends:
        # Slopes that point elsewhere than the cable goes are part of a fold already.
        inner = max(end - 1, 0)
        chord = places[inner + 1] - places[inner]
        slopes[end] = chord / np.linalg.norm(chord)
    status = solve()
    table[rows, at.Constraint.clamped] = clamped[:, at.Constraint.clamped]
    if status == at.OK:
        hinged = slopes[ends] / np.linalg.norm(slopes[ends], axis=1)[:, None]
        angle = max(
            math.acos(min(1.0, max(-1.0, float(own @ wanted))))
            for own, wanted in zip(hinged, clamped[:, directions], strict=True)
        )

        def turned_by(share: float) -> int:
            for row, end, own, wanted in zip(
                rows, ends, hinged, clamped[:, directions], strict=True
            ):
                table[row, directions] = turned(own, wanted, share)
                if table[row, at.Constraint.clamped] == at.EXACTLY:
                    slopes[end] = np.linalg.norm(slopes[end]) * table[row, directions]
            return solve_nearby()

        smallest = SMALLEST_TURN / max(angle, SMALLEST_TURN)
        step = min(1.0, CONTINUATION_LARGEST_TURN / max(angle, CONTINUATION_LARGEST_TURN))
        status = continued(block, turned_by, step=step, smallest=smallest)
    table[rows, directions] = clamped[:, directions]
    return status


def turned(start: FloatArray, end: FloatArray, share: float) -> FloatArray:
    """The unit vector at a share of the way on the sphere from one to another, (dimension,)."""
    along = float(start @ end)
    if share >= 1.0:
        return end
    aside = end - along * start
    if np.linalg.norm(aside) < TURNED_BACK:
        aside = np.zeros_like(start)
        aside[int(np.argmin(np.abs(start)))] = 1.0
        aside -= (aside @ start) * start
    aside /= np.linalg.norm(aside)
    angle = share * math.acos(min(1.0, max(-1.0, along)))
    return np.asarray(math.cos(angle) * start + math.sin(angle) * aside)
