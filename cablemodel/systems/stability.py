"""Whether a system leaves its start by itself: it falls from it, or swings up as a wing may.

An implicit step leads back to an equilibrium that is none to stay at, and a run would follow it for
long. So small motions about the start are looked at: if stiffness holds them all and nothing feeds
them, a factorisation says so (kernels/line/inertia.py). With foils they may take energy from the
flow: slow motions, coupled by drag and lift, tell how fast (kernels/line/swinging.py; modal flutter
analysis: Bisplinghoff, Ashley and Halfman 1955, chapter 9).
"""

from __future__ import annotations

import math
import warnings
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cablemodel.errors import UnstableStartWarning
from cablemodel.solvers import library as entry
from cablemodel.solvers.finite_element.linearisation import Matrix, matrices
from cablemodel.solvers.finite_element.stability import slowest_growth
from cablemodel.solvers.shared import layout as at
from cablemodel.solvers.shared.layout import Header
from cablemodel.systems.built import Built

FloatArray = NDArray[np.float64]
Motion = NDArray[np.complex128]

ROUNDED_SWING = math.sqrt(np.finfo(float).eps)
"""Of a rate of growth: the frequency with which nothing swings."""


@dataclass(frozen=True)
class Instability:
    """How a system leaves its start, or its present motion, by itself."""

    rate: float
    """It grows by exp(rate t) [1/s]."""
    frequency: float
    """At which it swings as it grows [rad/s]; 0: it falls."""
    motion: FloatArray
    """Of places and slopes of the nodes, or turns of bodies, (nodes, 2, 3), as far as it is real:
    the largest component of a place's is 1."""
    part: str
    """The line or the body that moves most."""
    arc: float
    """And where, of a line [m]."""
    time: float
    """Of the motion [s]; 0: the start."""

    def warning(self) -> UnstableStartWarning:
        """What is to be told."""
        return UnstableStartWarning(
            self.rate, self.arc, part=self.part, frequency=self.frequency, time=self.time
        )


def warn_if_unstable(built: Built) -> bool:
    """Look at a system's start, or at its present motion; returns whether it is unstable.

    Warns:
        UnstableStartWarning: it leaves that by itself.
    """
    found = instability(built)
    if found is not None:
        warnings.warn(found.warning(), stacklevel=2)
    return found is not None


def instability(built: Built) -> Instability | None:
    """How a system leaves its start, or its present motion, by itself; None: it does not. A motion
    changes in the line's own time: what grows beside it has to swing within that, and to be a body
    that foils feed.
    """
    block = built.block
    least = slowest_growth(block)
    whole = block.image.copy()
    work = np.zeros(entry.count_leaving(block.ints, block.reals, least, np.zeros(0)))
    if entry.count_leaving(block.ints, block.reals, least, work) < 1:
        block.image[:] = whole
        return None
    mass, damping, stiffness = matrices(block)  # with what is pressed lifted
    block.image[:] = whole
    coupled = work[: 6 * built.nodes * at.MOTIONS].reshape(at.MOTIONS, -1)
    coupled = coupled[np.any(coupled != 0.0, axis=1)].T
    quick = 2.0 * math.pi / block.scalars.period if block.scalars.time > 0.0 else 0.0
    found = fastest_growth(mass, damping, stiffness, coupled, least, quick)
    if found is None:
        return None
    growth, motion = found
    motion = motion.reshape(-1, 2, 3)
    moves = np.abs(motion)
    bodies = block.array(Header.free_bodies, len(built.tree.bodies), at.FREE_WORDS)
    turns = bodies[:, at.FreeBody.size, None] * moves[built.body_nodes(), 1]
    moves = np.linalg.norm(moves[:, 0], axis=1)
    most = motion[:, 0] if moves.any() else motion  # bodies may turn where they are
    motion = motion / most.flat[np.argmax(np.abs(most))]
    moves[built.body_nodes()] += np.linalg.norm(turns, axis=1)
    part, arc = built.where(int(np.argmax(moves)))
    if block.scalars.time > 0.0:
        body = built.scene.bodies.get(part)
        if body is None or not body.foils:
            return None
    time = float(block.scalars.time)
    return Instability(growth.real, abs(growth.imag), motion.real.copy(), part, arc, time)


def is_pressed(built: Built) -> bool:
    """Whether some of a line is pressed by more than tensions may be wrong by."""
    worst = np.empty(3)
    entry.worst_of_shape(built.block.ints, built.block.reals, worst)
    return bool(worst[2] < 0.0)


def fastest_growth(
    mass: Matrix,
    damping: Matrix,
    stiffness: Matrix,
    coupled: FloatArray,
    least: float,
    quick: float = 0.0,
) -> tuple[complex, Motion] | None:
    """Of motions x exp(l t) the fastest that grows by more than a rate, and swings at a frequency
    or above, of those (n, motions) that are coupled: l [1/s] and x (n,). Two that grow alike may
    swing by the root of what rounding does: they do not swing."""
    from scipy.linalg import eig

    count = coupled.shape[1]
    m, c, k = (coupled.T @ (part @ coupled) for part in (mass, damping, stiffness))
    state = np.zeros((2 * count, 2 * count))
    state[:count, count:] = np.eye(count)
    state[count:] = -np.linalg.solve(m, np.hstack([k, c]))
    rates, vectors = eig(state)
    rates.imag[np.abs(rates.imag) <= ROUNDED_SWING * np.abs(rates)] = 0.0
    grows = np.flatnonzero((rates.real > least) & (rates.imag >= quick))
    if len(grows) == 0:
        return None
    fastest = grows[np.argmax(rates[grows].real)]
    return complex(rates[fastest]), coupled @ vectors[:count, fastest]
