"""Whether a system leaves its start by itself: it falls from it, or swings up as a wing may.

An implicit step leads back to an equilibrium that is none to stay at, and a run would follow it for
long. So small motions about the start are looked at: if stiffness holds them all and nothing feeds
them, a factorisation says so (kernels/line/inertia.py). With foils they may take energy from the
flow: the lowest modes of the undamped motion, coupled by drag and lift, tell how fast (modal
flutter analysis: Bisplinghoff, Ashley and Halfman 1955, chapter 9).
"""

from __future__ import annotations

import math
import warnings

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import UnstableStartWarning
from cablemodel.solvers import library as entry
from cablemodel.solvers.finite_element.linearisation import Matrix, free_motions, matrices
from cablemodel.solvers.finite_element.stability import SLOWEST, slowest_growth
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header
from cablemodel.systems.built import Built

FloatArray = NDArray[np.float64]
Motion = NDArray[np.complex128]

MODES = 60
"""What is coupled, of the undamped motion's lowest modes."""
ITERATIONS = 10
"""To a motion of the whole, at most; it takes five or none."""
ACCURACY = 1e-6
"""Of its growth."""


def warn_if_unstable(built: Built) -> bool:
    """Look at a system's start, or at its present motion; returns whether it is unstable.

    Warns:
        UnstableStartWarning: it leaves that by itself.
    """
    warning = instability(built)
    if warning is not None:
        warnings.warn(warning, stacklevel=2)
    return warning is not None


def instability(built: Built) -> UnstableStartWarning | None:
    """How a system leaves its start, or its present motion, by itself; None: it does not. A motion
    changes in the line's own time: what grows beside it has to swing within that, and to be a body
    that foils feed.
    """
    block = built.block
    least = slowest_growth(block)
    basis, _names = free_motions(block)
    kept = block.image.copy()
    growing = entry.count_growing(block.ints, block.reals, least)  # with what is pressed lifted
    if growing == 0 and block.header.foil_count == 0:
        block.image[:] = kept
        return None
    mass, damping, stiffness = (basis.T @ part @ basis for part in matrices(block))
    block.image[:] = kept
    quick = 2.0 * math.pi / block.scalars.period if block.scalars.time > 0.0 else 0.0
    found = fastest_growth(mass, damping, stiffness, least, quick)
    if found is None:
        return None
    growth, motion = found
    moves = np.abs(basis @ motion).reshape(-1, 2, 3)
    bodies = block.array(Header.free_bodies, len(built.tree.bodies), at.FREE_WORDS)
    turns = bodies[:, at.FreeBody.size, None] * moves[built.body_nodes(), 1]
    moves = np.linalg.norm(moves[:, 0], axis=1)
    moves[built.body_nodes()] += np.linalg.norm(turns, axis=1)
    part, arc = built.where(int(np.argmax(moves)))
    if block.scalars.time > 0.0:
        body = built.scene.bodies.get(part)
        if body is None or not body.foils:
            return None
    return UnstableStartWarning(
        growth.real, arc, part=part, frequency=abs(growth.imag), time=float(block.scalars.time)
    )


def allowed_tension(built: Built) -> float:
    """What tensions may be wrong by [N]."""
    state = built.block.scalars
    return 10.0 * state.tolerance * max(state.largest_tension, state.tension_scale)


def is_pressed(built: Built) -> bool:
    """Whether some of a line is pressed by more than tensions may be wrong by."""
    means = built.block.array(Header.tension, built.nodes, 2)[:, 0]
    return bool(means.min() < -allowed_tension(built))


def fastest_growth(
    mass: Matrix, damping: Matrix, stiffness: Matrix, least: float, quick: float = 0.0
) -> tuple[complex, Motion] | None:
    """Of motions x exp(l t) the fastest that grows by more than a rate, and swings at a frequency
    or above: l [1/s] and x (n,).

    The modes leave out what the others give way by: from what they find a motion of the whole is
    sought, by inverse iteration.
    """
    from scipy.linalg import eig, eigh
    from scipy.sparse.linalg import eigsh

    size = mass.shape[0]
    count = min(MODES, size)
    held, inertia = (0.5 * (part + part.T) for part in (stiffness, mass))
    if size <= 2 * count:
        _values, modes = eigh(held.toarray(), inertia.toarray(), subset_by_index=(0, count - 1))
    else:
        shift, start = -((least / SLOWEST) ** 2), np.ones(size)
        _values, modes = eigsh(held, count, inertia, sigma=shift, v0=start)
    state = np.zeros((2 * count, 2 * count))
    state[:count, count:] = np.eye(count)
    state[count:, :count] = -modes.T @ stiffness @ modes
    state[count:, count:] = -modes.T @ damping @ modes
    values, vectors = eig(state)
    found: list[tuple[complex, Motion]] = []
    for k in np.flatnonzero((values.real > least) & (values.imag >= quick)):
        motion = _motion_near(mass, damping, stiffness, values[k], modes @ vectors[:count, k])
        if motion is not None and motion[0].real > least:
            found.append(motion)
    return max(found, key=lambda pair: pair[0].real, default=None)


def _motion_near(
    mass: Matrix, damping: Matrix, stiffness: Matrix, rate: complex, motion: Motion
) -> tuple[complex, Motion] | None:
    """A motion of the whole near a growth and a shape; None: iterations lead to none."""
    from scipy.sparse.linalg import splu

    for _iteration in range(ITERATIONS):
        x = motion / np.linalg.norm(motion)
        slope = (2.0 * rate * mass + damping) @ x
        motion = splu((rate**2 * mass + rate * damping + stiffness).tocsc()).solve(slope)
        change = 1.0 / np.vdot(x, motion)
        rate = complex(rate - change)
        if abs(change) < ACCURACY * abs(rate):
            return rate, motion
    return None
